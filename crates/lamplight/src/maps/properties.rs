//! Custom properties, as authors add them in an editor, in the notation of scene files.

use crate::explain::explain;
use crate::{Error, Result};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

/// Keys whose value is a colour. A number is a grey.
const COLORS: &[&str] = &["emission", "glow", "albedo", "tint", "color", "sky"];

/// Custom properties by name. Those that nobody here knows are the game's own.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Properties(Map<String, Value>);

impl Properties {
    /// Adds a property. One that was not set, an empty text, is left out.
    pub fn set(&mut self, name: &str, value: Value) {
        if value != Value::String(String::new()) {
            self.0.insert(name.to_owned(), value);
        }
    }

    /// Returns the ones that are meant for lamplight: if names begin with `lamplight.` or `lamplight_`, or one is a class of
    /// that name, only these. So a game may have a `material` of its own.
    pub fn for_lamplight(self) -> Self {
        let mut meant = Map::new();
        for (name, value) in &self.0 {
            match (name.strip_prefix("lamplight"), value) {
                (Some(""), Value::Object(values)) => meant.extend(values.clone()),
                (Some(rest), _) if rest.starts_with(['.', '_']) => {
                    meant.insert(rest[1..].to_owned(), value.clone());
                }
                _ => {}
            }
        }
        if meant.is_empty() { self } else { Self(meant) }
    }

    pub fn get(&self, name: &str) -> Option<&Value> {
        self.0.get(name)
    }

    /// Returns whether one of these is set.
    pub fn has_any(&self, names: &[&str]) -> bool {
        names.iter().any(|name| self.0.contains_key(*name))
    }

    /// Returns these properties over others, which count where these are not set.
    pub fn over(&self, below: &Self) -> Self {
        let mut all = below.0.clone();
        all.extend(self.0.clone());
        Self(all)
    }

    /// Returns those with these names, in the notation of scene files.
    pub fn in_scene_notation(&self, names: &[&str]) -> Map<String, Value> {
        let known = names.iter().filter_map(|name| Some((name, self.0.get(*name)?)));
        known.map(|(name, value)| ((*name).to_owned(), in_notation(name, value))).collect()
    }
}

/// Returns a value in the notation of scene files. Editors have no lists, so these come as text.
fn in_notation(name: &str, value: &Value) -> Value {
    let value = match value {
        Value::String(text) => of_text(text.trim()),
        value => value.clone(),
    };
    match value {
        Value::Number(grey) if COLORS.contains(&name) => [grey.clone(), grey.clone(), grey].into(),
        value => value,
    }
}

fn of_text(text: &str) -> Value {
    // Colours of Tiled have their alpha in front.
    if let Some(digits) = text.strip_prefix('#').filter(|digits| digits.len() == 8)
        && digits.is_ascii()
    {
        return format!("#{}", &digits[2..]).into();
    }
    let is_list = text.starts_with(['[', '{']);
    let value = serde_json::from_str(text).ok();
    value.filter(|value: &Value| is_list || value.is_number()).unwrap_or_else(|| text.into())
}

/// Reads a part of a scene from values in its notation.
pub(super) fn from_notation<T: DeserializeOwned>(values: Map<String, Value>) -> Result<T> {
    serde_path_to_error::deserialize(Value::Object(values)).map_err(|e| {
        let key = e.path().to_string();
        explain(&key, &e.into_inner().to_string())
    })
}

/// Adds the layer, tileset or object to an error of one of its properties.
pub(super) fn of(what: &str, error: Error) -> Error {
    Error::Under { key: what.to_owned(), source: Box::new(error) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn of_values(values: Value) -> Properties {
        let Value::Object(values) = values else { panic!("{values}") };
        Properties(values)
    }

    #[test]
    fn names_with_a_prefix_leave_the_others_to_the_game() {
        let all = |values| of_values(values).for_lamplight();
        let own = json!({ "material": "dirt", "light": true });
        assert_eq!(all(own.clone()), of_values(own));
        let walls = of_values(json!({ "light": "walls" }));
        assert_eq!(all(json!({ "material": "dirt", "lamplight.light": "walls" })), walls);
        assert_eq!(all(json!({ "material": "dirt", "lamplight_light": "walls" })), walls);
        assert_eq!(all(json!({ "light": 3, "lamplight": { "light": "walls" } })), walls);
    }

    #[test]
    fn editors_write_what_scene_files_do() {
        let cases = [
            ("emission", json!(6), json!([6, 6, 6])),
            ("emission", json!("6.5"), json!([6.5, 6.5, 6.5])),
            ("emission", json!("#ffff8000"), json!("#ff8000")),
            ("emission", json!("#ff8000"), json!("#ff8000")),
            ("albedo", json!("[1, 0.5, 0]"), json!([1, 0.5, 0])),
            ("opacity", json!(" 0.5"), json!(0.5)),
            ("material", json!("stone"), json!("stone")),
            ("angle", json!("30deg"), json!("30deg")),
            ("solid", json!(true), json!(true)),
        ];
        for (name, value, expected) in cases {
            let mut properties = Properties::default();
            properties.set(name, value);
            assert_eq!(properties.in_scene_notation(&[name])[name], expected);
        }
    }
}
