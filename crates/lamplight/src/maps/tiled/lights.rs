//! Objects that are lights, with what they have from their template (`.tx`).

use super::tilesets::{BOTTOM_LEFT, TileKind, Tilesets};
use super::xml::{at_line, attribute, child, children, class, number, properties, with_root};
use crate::Result;
use crate::maps::map_file::beside;
use crate::maps::objects::{self, MapLight};
use crate::maps::properties::{Properties, of};
use crate::maps::tile_map::{CellTile, TileMap};
use roxmltree::Node;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// A reader of objects, which reads each template once.
pub(super) struct Lights<'a> {
    file: &'a Path,
    tilesets: &'a Tilesets,
    templates: HashMap<PathBuf, Object>,
}

/// The parts of an object that lights need; what it lacks comes from its template.
#[derive(Clone, Default)]
struct Object {
    class: Option<String>,
    size: [Option<f32>; 2],
    rotation: Option<f32>,
    is_tile: bool,
    properties: Properties,
}

impl Object {
    fn of(node: Node) -> Result<Self> {
        Ok(Self {
            class: class(node),
            size: [number(node, "width")?, number(node, "height")?],
            rotation: number(node, "rotation")?,
            is_tile: node.has_attribute("gid"),
            properties: properties(node),
        })
    }

    fn over(self, template: &Self) -> Self {
        Self {
            class: self.class.or_else(|| template.class.clone()),
            size: [0, 1].map(|a| self.size[a].or(template.size[a])),
            rotation: self.rotation.or(template.rotation),
            is_tile: self.is_tile || template.is_tile,
            properties: self.properties.over(&template.properties),
        }
    }
}

impl<'a> Lights<'a> {
    pub fn new(file: &'a Path, tilesets: &'a Tilesets) -> Self {
        Self { file, tilesets, templates: HashMap::new() }
    }

    /// Reads the lights of an object layer into a map.
    pub fn read(&mut self, group: Node, offset: [i32; 2], map: &mut TileMap) -> Result<()> {
        for node in children(group, "object") {
            let visible = node.attribute("visible") != Some("0");
            let mut object = Object::of(node)?;
            if let Some(template) = node.attribute("template") {
                map.files.push(beside(self.file, template));
                object = object.over(self.template(node, template)?);
            }
            let tile = tile_of(node)?;
            if let Some(kind) = tile.and_then(|tile| self.kind(tile, map)) {
                object.class = object.class.or_else(|| kind.class.clone());
                object.properties = object.properties.over(&kind.properties);
            }
            let (Some(class), true) = (&object.class, visible) else { continue };
            let [width, height] = object.size.map(|length| length.unwrap_or(0.0));
            // Tiles stand on their place; shapes hang from it.
            let anchor = match tile {
                Some(tile) => self.tilesets.anchor(tile),
                None if object.is_tile => BOTTOM_LEFT,
                None => [0.0; 2],
            };
            let corner = [number(node, "x")?, number(node, "y")?].map(Option::unwrap_or_default);
            // Tiled turns objects clockwise about their place, by any number of turns.
            let rotation = (object.rotation.unwrap_or(0.0) % 360.0).to_radians();
            let (sin, cos) = rotation.sin_cos();
            let [across, along] = [(0.5 - anchor[0]) * width, (0.5 - anchor[1]) * height];
            let center =
                [corner[0] + cos * across - sin * along, corner[1] + sin * across + cos * along];
            let position = [0, 1].map(|a| center[a] + offset[a] as f32);
            let light = objects::light(class, position, rotation, &object.properties);
            match light.map_err(|e| at_line(node, of(&named(node), e)))? {
                Some(MapLight::Lamp(lamp)) => map.lamps.push(lamp),
                Some(MapLight::Sun(sun)) => map.suns.push(sun),
                None => {}
            }
        }
        Ok(())
    }

    fn kind(&self, tile: u32, map: &TileMap) -> Option<&TileKind> {
        map.tile(tile).map(|tile| &self.tilesets.kinds[tile.properties as usize])
    }

    fn template(&mut self, node: Node, name: &str) -> Result<&Object> {
        let path = beside(self.file, name);
        if !self.templates.contains_key(&path) {
            let read = with_root(&path, "template", |root| match child(root, "object") {
                Some(object) => Object::of(object),
                None => Ok(Object::default()),
            });
            let object = read.map_err(|e| at_line(node, of(&format!("template {name}"), e)))?;
            self.templates.insert(path.clone(), object);
        }
        Ok(&self.templates[&path])
    }
}

/// Returns the number of an object's tile. That of a template counts by the tilesets of the template, which are not read.
fn tile_of(node: Node) -> Result<Option<u32>> {
    Ok(attribute(node, "gid")?.and_then(|bits| CellTile::of_bits(bits).number()))
}

fn named(node: Node) -> String {
    match node.attribute("name").filter(|name| !name.is_empty()) {
        Some(name) => format!("object \"{name}\""),
        None => format!("object {}", node.attribute("id").unwrap_or_default()),
    }
}
