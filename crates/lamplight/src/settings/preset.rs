//! Presets: their key in the JSON Schema, and the error for an unknown one.

use crate::Error;
use schemars::Schema;
use serde_json::{Value, json};
use std::fmt::Display;

/// The error for a preset that a method does not have.
pub fn no_preset(method: &str, name: impl Display, names: &[&str]) -> Error {
    Error::value(format!("{method}.preset"), name, format!("one of {}", names.join(", ")))
}

/// Adds the key `preset` to the JSON Schema of a method's table.
pub fn with_preset(names: &'static [&'static str]) -> impl Fn(&mut Schema) {
    move |schema| {
        let properties = schema.ensure_object().entry("properties").or_insert_with(|| json!({}));
        if let Value::Object(properties) = properties {
            let preset = json!({
                "description": "Starting point that the other keys change.",
                "enum": names,
            });
            properties.shift_insert(0, "preset".to_owned(), preset);
        }
    }
}
