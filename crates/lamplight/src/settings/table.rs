//! Settings as written in files and flags: layers of tables, with presets.

use super::file::SettingsFile;
use super::preset::no_preset;
use super::{Cascades, Flood, Holographic, Method, Polar, Quality, Raymarch, Settings};
use crate::explain::explain;
use crate::keyed::Keyed;
use crate::{Error, Result};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::borrow::Cow;

/// Settings as a file or a command line writes them: only the keys that are given.
///
/// [`Self::merge`] lays one table over another; [`Self::resolve`] returns [`Settings`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SettingsTable(Map<String, Value>);

/// The keys that stand for these settings, without those of other methods.
impl From<&Settings> for SettingsTable {
    fn from(settings: &Settings) -> Self {
        match serde_json::to_value(settings) {
            Ok(Value::Object(table)) => Self(table),
            // A struct of numbers and words is always an object.
            _ => Self::default(),
        }
    }
}

impl JsonSchema for SettingsTable {
    fn schema_name() -> Cow<'static, str> {
        SettingsFile::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = SettingsFile::json_schema(generator);
        let quality = generator.subschema_for::<Quality>();
        if let Some(Value::Object(properties)) = schema.ensure_object().get_mut("properties") {
            properties.insert("quality".to_owned(), quality.to_value());
        }
        schema
    }
}

impl SettingsTable {
    /// Returns whether the table has no keys.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns whether the table sets a key, such as `raymarch.rays`.
    pub fn contains(&self, key: &str) -> bool {
        let mut names = key.split('.');
        let first = names.next().and_then(|name| self.0.get(name));
        names.fold(first, |value, name| value?.get(name)).is_some()
    }

    /// Sets one key, such as `raymarch.rays`, to a value. The order of keys makes no difference: a
    /// preset sets the starting values, and the other keys override it.
    pub fn set(&mut self, key: &str, value: impl Into<Value>) {
        let value = key.rsplit('.').fold(value.into(), |inner, name| {
            Value::Object(Map::from_iter([(name.to_owned(), inner)]))
        });
        if let Value::Object(table) = value {
            merge(&mut self.0, table, false);
        }
    }

    /// Sets a key from text of the form `key=value`, such as `raymarch.rays=64`; the value is TOML,
    /// and a word without quotes is a string.
    pub fn set_from_text(&mut self, text: &str) -> Result<()> {
        let (key, value) = text
            .split_once('=')
            .filter(|(key, _)| key.split('.').all(|name| !name.trim().is_empty()))
            .ok_or_else(|| {
                let expected = "of the form key=value, such as bounces=2 or raymarch.rays=64";
                Error::value("setting", text, expected)
            })?;
        let value = value.trim();
        let parsed = toml::from_str::<Map<String, Value>>(&format!("v = {value}"))
            .ok()
            .and_then(|mut table| table.remove("v"))
            // A value that JSON cannot express, such as `nan`, stays as it was written.
            .filter(|value| !value.is_null());
        self.set(key.trim(), parsed.unwrap_or_else(|| Value::String(value.to_owned())));
        Ok(())
    }

    /// Lays another table over this one: its keys win. A preset in it removes the keys of its method
    /// in this table, and a quality those of all methods.
    pub fn merge(&mut self, over: Self) {
        if over.0.contains_key("quality") {
            self.0.retain(|key, _| Method::ALL.iter().all(|method| method.name() != key));
        }
        merge(&mut self.0, over.0, true);
    }

    /// Expands presets, and rejects unknown keys and values out of range.
    ///
    /// # Errors
    /// Returns the first key that is unknown or whose value is wrong, with what would be right.
    pub fn resolve(&self) -> Result<Settings> {
        let mut table = self.0.clone();
        if let Some(quality) = table.remove("quality") {
            let name = quality.as_str().map_or_else(|| quality.to_string(), str::to_owned);
            apply_quality(&mut table, name.parse()?);
        }
        expand_denoise(&mut table);
        expand_preset(&mut table, "raymarch", Raymarch::PRESETS, Raymarch::preset)?;
        expand_preset(&mut table, "flood", Flood::PRESETS, Flood::preset)?;
        expand_preset(&mut table, "polar", Polar::PRESETS, Polar::preset)?;
        expand_preset(&mut table, "cascades", Cascades::PRESETS, Cascades::preset)?;
        expand_preset(&mut table, "holographic", Holographic::PRESETS, Holographic::preset)?;
        let table = Value::Object(table);
        let keyed = Keyed(&table);
        let settings: SettingsFile = serde_path_to_error::deserialize(keyed).map_err(|e| {
            let path = e.path().to_string();
            let mut message = e.into_inner().to_string();
            let of_method = |path: &str| Method::ALL.iter().any(|m| path.starts_with(m.name()));
            if message.starts_with("unknown field") {
                let added = if of_method(&path) { "preset" } else { "quality" };
                message = message
                    .replace(", expected one of ", &format!(", expected one of `{added}`, "));
            }
            explain(&path, &message)
        })?;
        Settings::from_file(settings)
    }
}

/// Gives every method that has no preset of its own the one of a quality level.
fn apply_quality(table: &mut Map<String, Value>, quality: Quality) {
    for method in Method::ALL {
        let settings = table.entry(method.name()).or_insert_with(|| Value::Object(Map::new()));
        // Anything but a table is an error that serde reports with its key.
        if let Value::Object(settings) = settings {
            settings.entry("preset").or_insert_with(|| quality.preset(*method).into());
        }
    }
}

/// Lays one table over another; if `preset_clears`, a preset in `over` removes the keys of `under`.
fn merge(under: &mut Map<String, Value>, over: Map<String, Value>, preset_clears: bool) {
    if preset_clears && over.contains_key("preset") {
        under.clear();
    }
    for (key, value) in over {
        match (under.get_mut(&key), value) {
            (Some(Value::Object(old)), Value::Object(new)) => merge(old, new, preset_clears),
            (_, value) => {
                under.insert(key, value);
            }
        }
    }
}

/// Adds the blur of the preset of `raymarch`, which has a table of its own.
fn expand_denoise(table: &mut Map<String, Value>) {
    let name = table.get("raymarch").and_then(|raymarch| raymarch.get("preset"));
    let preset = name.and_then(Value::as_str).and_then(Raymarch::preset);
    let Some(Ok(Value::Object(base))) = preset.map(|p| serde_json::to_value(p.denoise)) else {
        return;
    };
    let denoise = table.entry("denoise").or_insert_with(|| Value::Object(Map::new()));
    // Anything but a table is an error that serde reports with its key.
    if let Value::Object(denoise) = denoise {
        fill(denoise, base);
    }
}

/// Adds the keys of `base` that `table` lacks.
fn fill(table: &mut Map<String, Value>, base: Map<String, Value>) {
    for (key, value) in base {
        table.entry(key).or_insert(value);
    }
}

/// Replaces the key `preset` of a method's table by the keys it stands for; keys beside it win.
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
        return Err(no_preset(method, &name, names));
    };
    fill(table, base);
    Ok(())
}
