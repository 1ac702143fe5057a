//! Settings as they are written: layers of tables, with presets.

use super::{Cascades, Flood, Holographic, Polar, Raymarch, Settings};
use crate::explain::explain;
use crate::{Error, Method, Result};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::borrow::Cow;

/// Settings as a file or a command line writes them: only the keys that were named.
///
/// Tables are laid over one another with [`Self::merge`]; [`Self::resolve`] makes [`Settings`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SettingsTable(Map<String, Value>);

impl JsonSchema for SettingsTable {
    fn schema_name() -> Cow<'static, str> {
        Settings::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Settings::json_schema(generator)
    }
}

impl SettingsTable {
    /// Whether nothing was named.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Sets one key, such as `raymarch.rays`, to a value. The order of keys makes no difference: a
    /// preset is where the others start from.
    pub fn set(&mut self, key: &str, value: impl Into<Value>) {
        let value = key.rsplit('.').fold(value.into(), |inner, name| {
            Value::Object(Map::from_iter([(name.to_owned(), inner)]))
        });
        if let Value::Object(table) = value {
            merge(&mut self.0, table, false);
        }
    }

    /// Sets what `key=value` says, as in `--set raymarch.rays=64`; the value is TOML, and a word
    /// without quotes is a string.
    pub fn set_from_text(&mut self, text: &str) -> Result<()> {
        let (key, value) = text
            .split_once('=')
            .filter(|(key, _)| key.split('.').all(|name| !name.trim().is_empty()))
            .ok_or_else(|| {
                Error::value(
                    "--set",
                    text,
                    "of the form key=value, such as bounces=2 or raymarch.rays=64",
                )
            })?;
        let value = value.trim();
        let parsed = toml::from_str::<Map<String, Value>>(&format!("v = {value}"))
            .ok()
            .and_then(|mut table| table.remove("v"))
            // What JSON cannot say, such as `nan`, is repeated as it was written.
            .filter(|value| !value.is_null());
        self.set(key.trim(), parsed.unwrap_or_else(|| Value::String(value.to_owned())));
        Ok(())
    }

    /// Lays another table over this one: its keys win. A preset there comes after, and so undoes,
    /// the keys of its method here.
    pub fn merge(&mut self, over: Self) {
        merge(&mut self.0, over.0, true);
    }

    /// Expands presets, refuses unknown keys and values out of range.
    pub fn resolve(&self) -> Result<Settings> {
        let mut table = self.0.clone();
        expand_preset(&mut table, "raymarch", Raymarch::PRESETS, Raymarch::preset)?;
        expand_preset(&mut table, "flood", Flood::PRESETS, Flood::preset)?;
        expand_preset(&mut table, "polar", Polar::PRESETS, Polar::preset)?;
        expand_preset(&mut table, "cascades", Cascades::PRESETS, Cascades::preset)?;
        expand_preset(&mut table, "holographic", Holographic::PRESETS, Holographic::preset)?;
        let value = Value::Object(table);
        let settings: Settings = serde_path_to_error::deserialize(&value).map_err(|e| {
            let path = e.path().to_string();
            let mut message = e.into_inner().to_string();
            let of_method = |path: &str| Method::ALL.iter().any(|m| path.starts_with(m.name()));
            if message.starts_with("unknown field") && of_method(&path) {
                message = message.replace(", expected one of ", ", expected one of `preset`, ");
            }
            explain(&path, &message)
        })?;
        settings.check()?;
        Ok(settings)
    }
}

/// Lays one table over another; `anew`: a preset there undoes what is here.
fn merge(under: &mut Map<String, Value>, over: Map<String, Value>, anew: bool) {
    if anew && over.contains_key("preset") {
        under.clear();
    }
    for (key, value) in over {
        match (under.get_mut(&key), value) {
            (Some(Value::Object(old)), Value::Object(new)) => merge(old, new, anew),
            (_, value) => {
                under.insert(key, value);
            }
        }
    }
}

/// Replaces the key `preset` of a method's table by the keys it stands for; keys written beside it
/// win.
fn expand_preset<T: Serialize>(
    table: &mut Map<String, Value>,
    method: &str,
    names: &[&str],
    preset: impl Fn(&str) -> Option<T>,
) -> Result<()> {
    let Some(Value::Object(table)) = table.get_mut(method) else { return Ok(()) };
    let Some(name) = table.remove("preset") else { return Ok(()) };
    let base = name.as_str().and_then(preset).and_then(|p| serde_json::to_value(p).ok());
    let Some(Value::Object(base)) = base else {
        let expected = format!("one of {}", names.join(", "));
        return Err(Error::value(format!("{method}.preset"), name, expected));
    };
    for (key, value) in base {
        table.entry(key).or_insert(value);
    }
    Ok(())
}

/// Adds the key `preset` to the JSON Schema of a method's table.
pub(super) fn with_preset(names: &'static [&'static str]) -> impl Fn(&mut Schema) {
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
