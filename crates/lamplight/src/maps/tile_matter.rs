//! Matter of tiles, by the custom properties of their layer and their own.
//!
//! `light` is the short way: `background` (the default) only paints, `walls` also block and reflect light in the colours
//! of their picture, `emitters` shine in them, and `none` is not drawn at all. The keys of a shape in a scene file
//! (`material`, `emission`, `glow`, `opacity`, `albedo`, `tint`, `only`, `mask`) are the exact way; either alone or both.
//! A tile's own properties win over those of its layer, one by one.
//!
//! As for a sprite, the colour of a picture multiplies emission, glow and albedo, and its alpha is coverage. Unlike for a
//! sprite the albedo is white if it is not given, so tiles reflect the light that their picture shows.

use super::properties::{self, Properties};
use crate::scene::Shape;
use crate::{Error, Result};
use serde_json::{Map, Value, json};

/// The properties of matter, which are keys of a shape.
const MATTER: &[&str] =
    &["material", "emission", "glow", "opacity", "albedo", "tint", "only", "mask"];

/// The emission of emitters, times the colour of their picture: a tile of 16 px lights a room.
const EMITTERS: [f32; 3] = [4.0; 3];

/// The effect of a tile on the picture and on light.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TileMatter {
    /// True if the picture is painted.
    pub paints: bool,
    /// The matter that it lays over what was there, as a shape has it; its geometry means nothing.
    pub matter: Option<Shape>,
}

impl TileMatter {
    /// The values of `light`.
    pub const ROLES: &[&str] = &["background", "walls", "emitters", "none"];

    const NONE: Self = Self { paints: false, matter: None };

    /// Reads the properties of a tile over those of its layer. A layer that is hidden in the editor is not painted, and
    /// acts on light only if it has a property for that, as collision layers do.
    pub fn of(tile: &Properties, layer: &Properties, visible: bool) -> Result<Self> {
        if !visible && !layer.has_any(&["light"]) && !layer.has_any(MATTER) {
            return Ok(Self::NONE);
        }
        let all = tile.over(layer);
        let role = match all.get("light") {
            None => None,
            Some(Value::String(role)) => Some(role.trim()),
            Some(_) => Some(""),
        };
        let has_material = all.has_any(&["material"]);
        let mut values = match role {
            Some("none") => return Ok(Self::NONE),
            Some("background") => Map::new(),
            Some("walls") => object(json!({ "opacity": 1 })),
            Some("emitters") => object(json!({ "opacity": 1, "emission": EMITTERS })),
            None if all.has_any(MATTER) => Map::new(),
            None => return Ok(Self { paints: visible, matter: None }),
            Some(_) => {
                let found = all.get("light").cloned().unwrap_or_default();
                return Err(Error::value("light", found, "background, walls, emitters or none"));
            }
        };
        if has_material {
            values.remove("opacity");
        } else {
            values.insert("albedo".into(), json!([1, 1, 1]));
        }
        if role == Some("background") {
            return Ok(Self { paints: visible, matter: None });
        }
        values.extend(all.in_scene_notation(MATTER));
        values.insert("rect".into(), json!({ "min": [0, 0], "max": [1, 1] }));
        let shape: Shape = properties::from_notation(values)?;
        shape.check("tile")?;
        Ok(Self { paints: visible, matter: Some(shape) })
    }
}

fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;

    fn light(tile: Value, layer: Value) -> Result<TileMatter> {
        let [tile, layer] = [tile, layer].map(|values| {
            let mut properties = Properties::default();
            object(values).into_iter().for_each(|(name, value)| properties.set(&name, value));
            properties
        });
        TileMatter::of(&tile, &layer, true)
    }

    fn matter(tile: Value, layer: Value) -> Option<Shape> {
        light(tile, layer).unwrap().matter
    }

    #[test]
    fn layers_have_a_role_and_tiles_their_own() {
        let none = || json!({});
        assert_eq!(matter(none(), none()), None);
        assert_eq!(matter(none(), json!({ "light": "background", "hp": 3 })), None);
        let walls = matter(none(), json!({ "light": "walls" })).unwrap();
        assert_eq!((walls.opacity, walls.albedo), (1.0, Some([1.0; 3])));
        let torch =
            matter(json!({ "light": "emitters", "emission": 9 }), json!({ "light": "walls" }));
        assert_eq!(torch.unwrap().emission, [9.0; 3]);
        let window =
            matter(json!({ "opacity": 0, "tint": "[1, 0.5, 0]" }), json!({ "light": "walls" }));
        assert_eq!(window.map(|w| (w.opacity, w.tint)), Some((0.0, [1.0, 0.5, 0.0])));
        let water = matter(none(), json!({ "light": "walls", "material": "water" })).unwrap();
        assert_eq!(water.matter(), Material::Water.matter());
        assert_eq!(light(none(), json!({ "light": "none" })).unwrap(), TileMatter::NONE);
    }

    #[test]
    fn hidden_layers_act_if_they_are_meant_to() {
        let mut walls = Properties::default();
        walls.set("light", "walls".into());
        let none = Properties::default();
        let hidden = TileMatter::of(&none, &walls, false).unwrap();
        assert!(!hidden.paints && hidden.matter.is_some());
        assert_eq!(TileMatter::of(&walls, &none, false).unwrap(), TileMatter::NONE);
    }

    #[test]
    fn errors_name_the_property() {
        let message = |layer| light(json!({}), layer).unwrap_err().to_string();
        let text = message(json!({ "light": "wall" }));
        assert_eq!(text, "`light` is \"wall\", but must be background, walls, emitters or none");
        assert!(message(json!({ "opacity": 3 })).contains("`tile.opacity` is 3"));
        let text = message(json!({ "material": "stne" }));
        assert!(text.contains("material") && text.contains("did you mean \"stone\""), "{text}");
        assert!(message(json!({ "emission": "red" })).contains("emission"));
    }
}
