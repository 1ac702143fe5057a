//! Objects that are lights: lamps and suns, with the keys of a scene file as custom properties.

use super::properties::{self, Properties};
use super::tile_map::TileMap;
use crate::explain::explain;
use crate::scene::SceneSky;
use crate::scene::cookie;
use crate::scene::source::Source;
use crate::{Lamp, Result, Sun};
use serde_json::{Value, json};
use std::path::Path;

const LAMP: &[&str] = &[
    "color",
    "intensity",
    "range",
    "size",
    "falloff",
    "cookie",
    "height",
    "direct",
    "mask",
    "solid",
    "visible",
];
const CONE: &[&str] = &["direction", "angle", "softness", "profile"];
const SUN: &[&str] = &["direction", "angle", "color", "intensity", "elevation", "direct", "mask"];

/// A light that stands on a map.
pub(super) enum MapLight {
    Lamp(Lamp),
    Sun(Sun),
}

/// Reads an object of a class, or entity of a name, at a place in px. One that is no light is `None`.
///
/// `lamp` and `light` are lamps. One with an `angle` has a cone; its `direction` is the object's rotation, radians, if it
/// is not given. A `sun` shines from wherever it stands. Pictures are not opened.
pub(super) fn light(
    class: &str,
    position: [f32; 2],
    rotation: f32,
    own: &Properties,
) -> Result<Option<MapLight>> {
    if class.eq_ignore_ascii_case("sun") {
        let mut values = own.in_scene_notation(SUN);
        // Straight down, unless it is given.
        values.entry("direction").or_insert(json!("90deg"));
        let sun: Sun = properties::from_notation(values)?;
        sun.check(&"sun")?;
        return Ok(Some(MapLight::Sun(sun)));
    }
    if !["lamp", "light"].iter().any(|name| class.eq_ignore_ascii_case(name)) {
        return Ok(None);
    }
    let mut values = own.in_scene_notation(LAMP);
    values.insert("position".into(), json!(position));
    let mut cone = own.in_scene_notation(CONE);
    if cone.contains_key("angle") {
        cone.entry("direction").or_insert(json!(rotation));
        values.insert("cone".into(), Value::Object(cone));
    }
    let lamp: Lamp = properties::from_notation(values)?;
    lamp.check_in_scene(&"lamp")?;
    Ok(Some(MapLight::Lamp(lamp)))
}

/// Reads the property `sky` of a map: a colour, or the keys of a sky as text. A picture of it lies beside the file.
pub(super) fn read_sky(of_map: &Properties, file: &Path, map: &mut TileMap) -> Result<()> {
    let mut values = of_map.in_scene_notation(&["sky"]);
    let Some(sky) = values.remove("sky") else { return Ok(()) };
    let sky: SceneSky = serde_json::from_value(sky).map_err(|e| explain("sky", &e.to_string()))?;
    sky.check()?;
    let source = folder_of(file);
    map.files.extend(sky.image().map(|image| source.place(image)));
    map.sky = Some(sky.read(source)?);
    Ok(())
}

/// Reads the pictures of the cookies of a map's lamps, which lie beside the file.
pub(super) fn read_cookies(file: &Path, map: &mut TileMap) -> Result<()> {
    let source = folder_of(file);
    map.files.extend(map.lamps.iter().filter_map(cookie::image).map(|image| source.place(image)));
    map.lamps = cookie::with_pixels(&map.lamps, source)?;
    Ok(())
}

fn folder_of(file: &Path) -> Source<'_> {
    Source::Folder(file.parent().unwrap_or(file))
}
