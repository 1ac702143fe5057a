//! Properties where LDtk has a place for them: fields, data and tags of tiles, and documentation of layers.
//!
//! - Fields of entities and levels are properties. Their names count in any case.
//! - The custom data of a tile is TOML (`light = "walls"`) or JSON; a tag of an enum whose value is named like a role
//!   (`walls`) is `light`.
//! - The documentation of a layer may end with a part in TOML that begins with the line `[lamplight]`: properties of its
//!   tiles, and those of values of the IntGrid under their names, such as `ground = "walls"`.

use super::json::{EnumTag, Field, TileData};
use crate::maps::properties::Properties;
use crate::maps::tile_matter::TileMatter;
use crate::scene::Material;
use crate::{Error, Result};
use serde_json::{Map, Value};

/// The line from which on the documentation of a layer is for lamplight.
const MARK: &str = "[lamplight]";

/// The notes of a layer.
#[derive(Default)]
pub(super) struct LayerNotes {
    /// The properties of its tiles.
    pub tiles: Properties,
    own: Map<String, Value>,
}

impl LayerNotes {
    /// Reads the documentation of a layer.
    pub fn of(doc: &str) -> Result<Self> {
        let mut lines = doc.lines().skip_while(|line| line.trim() != MARK);
        if lines.next().is_none() {
            return Ok(Self::default());
        }
        let text: Vec<_> = lines.collect();
        let own: Map<String, Value> = toml::from_str(&text.join("\n")).map_err(|e| {
            let problem = format!("is not TOML after {MARK}: {}", e.message());
            Error::Key { key: "doc".into(), problem }
        })?;
        let mut tiles = Properties::default();
        own.iter().for_each(|(name, value)| tiles.set(name, value.clone()));
        Ok(Self { tiles, own })
    }

    /// The properties of a value of the IntGrid: from the notes, or from its own name. None if it is no matter.
    pub fn of_value(&self, name: &str) -> Option<Properties> {
        let mut properties = Properties::default();
        match self.own.get(name) {
            Some(Value::Object(values)) => {
                values.iter().for_each(|(name, value)| properties.set(name, value.clone()));
            }
            Some(Value::String(word)) => name_to_property(word, &mut properties),
            // So that a role that does not exist is an error.
            Some(other) => properties.set("light", other.clone()),
            None => {
                let name = name.to_ascii_lowercase();
                let known = TileMatter::ROLES.contains(&&*name) || material(&name).is_some();
                if !known {
                    return None;
                }
                name_to_property(&name, &mut properties);
            }
        }
        Some(properties)
    }
}

/// Sets the material of this name, or else the role.
fn name_to_property(name: &str, properties: &mut Properties) {
    let key = if material(name).is_some() { "material" } else { "light" };
    properties.set(key, name.into());
}

fn material(name: &str) -> Option<Material> {
    Material::ALL.iter().copied().find(|material| material.name() == name)
}

/// Reads fields as properties.
pub(super) fn of_fields(fields: &[Field]) -> Properties {
    let mut properties = Properties::default();
    for field in fields.iter().filter(|field| !field.value.is_null()) {
        let is_enum = field.kind.starts_with("LocalEnum") || field.kind.starts_with("ExternEnum");
        let value = match &field.value {
            Value::String(word) if is_enum => word.to_ascii_lowercase().into(),
            value => value.clone(),
        };
        properties.set(&field.identifier.to_ascii_lowercase(), value);
    }
    properties.for_lamplight()
}

/// Reads the custom data of a tile. Data in another notation is the game's own.
pub(super) fn of_tile_data(data: &TileData) -> Properties {
    let values: Option<Map<String, Value>> =
        serde_json::from_str(&data.data).ok().or_else(|| toml::from_str(&data.data).ok());
    let mut properties = Properties::default();
    values.iter().flatten().for_each(|(name, value)| properties.set(name, value.clone()));
    properties.for_lamplight()
}

/// Reads a tag of tiles. One that is no role is the game's own.
pub(super) fn of_tag(tag: &EnumTag) -> Option<Properties> {
    let name = tag.enum_value_id.to_ascii_lowercase();
    TileMatter::ROLES.contains(&&*name).then(|| {
        let mut properties = Properties::default();
        properties.set("light", name.into());
        properties
    })
}
