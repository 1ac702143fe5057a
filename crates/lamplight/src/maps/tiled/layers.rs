//! Layers and groups of them.

use super::layer_data;
use super::lights::Lights;
use super::tilesets::TileKind;
use super::xml::{at_line, attribute, child, color, number, pixels, properties, required};
use crate::maps::properties::{Properties, of};
use crate::maps::tile_map::{Places, TileLayer, TileMap};
use crate::maps::tile_matter::TileMatter;
use crate::{Error, Result, Rgb};
use roxmltree::Node;

/// The deepest nesting of groups.
const DEEPEST: u32 = 64;

/// The attributes that a layer has from the groups around it.
#[derive(Clone)]
pub(super) struct Inherited {
    offset: [i32; 2],
    opacity: f32,
    tint: Rgb,
    visible: bool,
    properties: Properties,
    depth: u32,
}

impl Default for Inherited {
    fn default() -> Self {
        Self {
            offset: [0, 0],
            opacity: 1.0,
            tint: [1.0; 3],
            visible: true,
            properties: Properties::default(),
            depth: 0,
        }
    }
}

impl Inherited {
    /// Adds what a layer or a group has itself.
    fn with(&self, node: Node) -> Result<Self> {
        let own = [pixels(node, "offsetx")?, pixels(node, "offsety")?];
        let tint = color(node, "tintcolor")?.unwrap_or([1.0; 3]);
        let visible = attribute::<u32>(node, "visible")?.unwrap_or(1) != 0;
        Ok(Self {
            offset: [0, 1].map(|a| self.offset[a].saturating_add(own[a])),
            opacity: self.opacity * number(node, "opacity")?.unwrap_or(1.0).clamp(0.0, 1.0),
            tint: std::array::from_fn(|c| self.tint[c] * tint[c]),
            visible: self.visible && visible,
            properties: properties(node).over(&self.properties),
            depth: self.depth + 1,
        })
    }
}

/// The layers of a map that is being read.
pub(super) struct LayerReader<'a> {
    pub map: &'a mut TileMap,
    /// The kinds of tiles.
    pub kinds: &'a [TileKind],
    pub cell: [u32; 2],
    pub infinite: bool,
    pub lights: Lights<'a>,
}

impl LayerReader<'_> {
    /// Reads the layers in a map or a group, the lowest first.
    pub fn read(&mut self, node: Node, around: &Inherited) -> Result<()> {
        if around.depth > DEEPEST {
            let problem = format!("is nested deeper than {DEEPEST} groups");
            return Err(at_line(node, Error::Key { key: "group".into(), problem }));
        }
        for child in node.children().filter(Node::is_element) {
            match child.tag_name().name() {
                "group" => self.read(child, &around.with(child)?)?,
                "layer" => self.tile_layer(child, &around.with(child)?)?,
                "objectgroup" => {
                    let own = around.with(child)?;
                    if own.visible {
                        self.lights.read(child, own.offset, self.map)?;
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn tile_layer(&mut self, node: Node, own: &Inherited) -> Result<()> {
        let name = format!("layer \"{}\"", node.attribute("name").unwrap_or_default());
        let matter =
            |kind: &TileKind| TileMatter::of(&kind.properties, &own.properties, own.visible);
        let matter = self.kinds.iter().map(matter).collect::<Result<_>>();
        let matter = matter.map_err(|e| at_line(node, of(&name, e)))?;
        let size = [required(node, "width")?, required(node, "height")?];
        let chunks = match child(node, "data") {
            Some(data) => layer_data::read(data, size, self.infinite)?,
            None => Vec::new(),
        };
        self.map.layers.push(TileLayer {
            name,
            offset: own.offset,
            opacity: own.opacity,
            tint: own.tint,
            matter,
            places: Places::Grid { cell: self.cell, chunks },
        });
        Ok(())
    }
}
