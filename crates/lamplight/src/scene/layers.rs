//! Layers: images of the scene's size that hold one field of every cell.

use super::layer::{Layer, ScenePlace, grey, tile_names, tile_parts};
use super::pictures::Pictures;
use super::source::Source;
use crate::check;
use crate::{Cells, Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Sides of tiles, px. Smaller ones are more files than a folder should have; a larger one does not fit the store of
/// decoded images.
const TILES: std::ops::RangeInclusive<u32> = 16..=4096;

/// Images that fill the grid under the shapes. Each is a PNG, EXR, WebP or JPEG of exactly the scene's
/// size; relative paths start at the scene file's folder.
///
/// An image may be cut into tiles: squares of `tile` px, of which each is a file. The column and the row of a tile, from
/// 0, take the place of `{x}` and `{y}` in a name such as `"emission/{x}_{y}.png"`. A tile without a file is
/// transparent. The scene may then be larger than a grid.
///
/// Transparent pixels are mixed with the defaults (emission, glow, opacity and albedo 0, tint 1, the picture
/// white) by their alpha; fully transparent ones are ignored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Layers {
    /// The side of tiles, px, 16 to 4096. It is for layers whose name has `{x}` and `{y}`. Tiles at the right and at the
    /// bottom may be cut off where the scene ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 16, max = 4096))]
    pub tile: Option<u32>,
    /// Emitted radiance. An EXR is linear as it is, other images are sRGB-decoded. Without an opacity
    /// layer every cell that glows here is solid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emission: Option<PathBuf>,
    /// Multiplies the emission layer, 0 to 1e6.
    #[serde(skip_serializing_if = "is_one")]
    pub emission_scale: f32,
    /// Emission coefficient, radiance per px, decoded like `emission`. It needs no opacity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub glow: Option<PathBuf>,
    /// Multiplies the glow layer, 0 to 1e6.
    #[serde(skip_serializing_if = "is_one")]
    pub glow_scale: f32,
    /// Opacity: the grey value, 0 to 1, without sRGB decoding.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub opacity: Option<PathBuf>,
    /// Albedo, sRGB-decoded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub albedo: Option<PathBuf>,
    /// Tint: the values, 0 to 1, without sRGB decoding.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tint: Option<PathBuf>,
    /// Colour of the final picture under the light, sRGB-decoded. Default: the albedo layer, else white.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<PathBuf>,
    /// Normal map of the final picture: `n·½ + ½` per channel, without sRGB decoding, z towards the viewer; in an EXR n
    /// itself, −1 to 1. Transparent pixels are not tilted. `[display.relief]` has how it is lit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<PathBuf>,
    /// The direction of green in the normal map: up (OpenGL, most painting programs) or down (DirectX).
    #[serde(skip_serializing_if = "is_up")]
    pub normal_y: NormalY,
    /// The layers of cells that lamps and suns choose between by their mask, a bit each: the grey value, 1 to 255,
    /// without sRGB decoding. Transparent pixels are in all layers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mask: Option<PathBuf>,
}

/// The direction that the green channel of a normal map stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum NormalY {
    /// Up, as in OpenGL, Blender, Godot and Unity.
    #[default]
    Up,
    /// Down, as in DirectX and Unreal.
    Down,
}

fn is_up(value: &NormalY) -> bool {
    *value == NormalY::Up
}

fn is_one(value: &f32) -> bool {
    *value == 1.0
}

impl Default for Layers {
    fn default() -> Self {
        Self {
            tile: None,
            emission: None,
            emission_scale: 1.0,
            glow: None,
            glow_scale: 1.0,
            opacity: None,
            albedo: None,
            tint: None,
            color: None,
            normal: None,
            normal_y: NormalY::Up,
            mask: None,
        }
    }
}

impl Layers {
    /// True if there is no layer.
    pub(crate) fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Returns whether some are cut into tiles.
    pub(super) fn are_in_tiles(&self) -> bool {
        self.in_tiles().next().is_some()
    }

    /// The key of the first that is one image.
    pub(super) fn in_one_piece(&self) -> Option<&'static str> {
        self.named().find(|(_, image)| tile_parts(image) == [false; 2]).map(|(key, _)| key)
    }

    /// The images that a scene of this size reads, as it names them; of tiles all that `exist`.
    pub(super) fn images(&self, scene: [u32; 2], exist: impl Fn(&Path) -> bool) -> Vec<PathBuf> {
        let side = self.tile.unwrap_or(u32::MAX);
        let mut images = Vec::new();
        for (_, image) in self.named() {
            match tile_parts(image) {
                [false, false] => images.push(image.clone()),
                _ => images.extend(tile_names(image, side, scene).filter(|name| exist(name))),
            }
        }
        images
    }

    /// The key and the image of each layer.
    fn named(&self) -> impl Iterator<Item = (&'static str, &PathBuf)> {
        let layers = [
            ("emission", &self.emission),
            ("glow", &self.glow),
            ("opacity", &self.opacity),
            ("albedo", &self.albedo),
            ("tint", &self.tint),
            ("color", &self.color),
            ("normal", &self.normal),
            ("mask", &self.mask),
        ];
        layers.into_iter().filter_map(|(key, image)| image.as_ref().map(|image| (key, image)))
    }

    /// The key and the name of each layer in tiles.
    fn in_tiles(&self) -> impl Iterator<Item = (&'static str, &PathBuf)> {
        self.named().filter(|(_, image)| tile_parts(image) != [false; 2])
    }

    pub(crate) fn check(&self) -> Result<()> {
        check::number("layers.emission_scale", self.emission_scale, 0.0..=1e6)?;
        check::number("layers.glow_scale", self.glow_scale, 0.0..=1e6)?;
        for (key, image) in self.named() {
            check::image(format_args!("layers.{key}"), image)?;
        }
        for (key, image) in self.in_tiles() {
            let key = format!("layers.{key}");
            if tile_parts(image) != [true; 2] {
                let expected = "the name of an image, or of tiles with both {x} and {y}";
                return Err(Error::value(key, image.display(), expected));
            }
            if self.tile.is_none() {
                let problem = "is in tiles: give the side of a tile in px, such as `tile = 512`";
                return Err(Error::Key { key, problem: problem.into() });
            }
        }
        match self.tile {
            Some(side) if !TILES.contains(&side) => {
                let expected = format!("{} to {} px", TILES.start(), TILES.end());
                Err(Error::value("layers.tile", side, expected))
            }
            Some(_) if !self.are_in_tiles() => {
                let problem = "is for layers in tiles, named like \"emission/{x}_{y}.png\"";
                Err(Error::Key { key: "layers.tile".into(), problem: problem.into() })
            }
            _ => Ok(()),
        }
    }

    /// Rejects tiles of which no file exists: that is a name that is wrong.
    pub(super) fn check_tiles(&self, source: Source, scene: [u32; 2]) -> Result<()> {
        let side = self.tile.unwrap_or(u32::MAX);
        let names = |image| tile_names(image, side, scene).map(|name| source.place(&name));
        for (key, image) in self.in_tiles() {
            if names(image).any(|path| source.has(&path)) {
                continue;
            }
            let first = names(image).next().unwrap_or_default();
            let problem = format!(
                "has no tile: neither {} exists, nor one of the others of a scene of {}×{} cells",
                first.display(),
                scene[0],
                scene[1]
            );
            return Err(Error::Key { key: format!("layers.{key}"), problem });
        }
        Ok(())
    }

    /// Reads every layer into the grid of a window.
    pub(super) fn read(
        &self,
        source: Source,
        pictures: &Pictures,
        place: ScenePlace,
        cells: &mut Cells,
    ) -> Result<()> {
        let layer = |key: &str| {
            let (_, image) = self.named().find(|(name, _)| *name == key)?;
            let tile = self.tile.filter(|_| tile_parts(image) == [true; 2]);
            let key = format!("layers.{key}");
            Some(Layer { key, image, tile, place, source, pictures })
        };
        if let Some(layer) = layer("emission") {
            layer.fill_light("emission", cells.emission_mut(), self.emission_scale)?;
            if self.opacity.is_none() {
                for i in 0..cells.len() {
                    let glows = cells.emission()[i].iter().any(|&e| e > 0.0);
                    cells.opacity_mut()[i] = if glows { 1.0 } else { 0.0 };
                }
            }
        }
        if let Some(layer) = layer("glow") {
            layer.fill_light("glow", cells.glow_mut(), self.glow_scale)?;
        }
        if let Some(layer) = layer("opacity") {
            layer.fill("opacity", cells.opacity_mut(), 0.0..=1.0, |pixel, _| {
                let (rgb, alpha) = pixel.value();
                grey(rgb) * alpha
            })?;
        }
        if let Some(layer) = layer("albedo") {
            layer.fill("albedo", cells.albedo_mut(), 0.0..=1.0, |pixel, _| pixel.light())?;
            layer.paint(cells.color_mut())?;
        }
        if let Some(layer) = layer("tint") {
            layer.fill("tint", cells.tint_mut(), 0.0..=1.0, |pixel, _| {
                let (rgb, alpha) = pixel.value();
                rgb.map(|v| 1.0 - alpha + v * alpha)
            })?;
        }
        if let Some(layer) = layer("color") {
            layer.paint(cells.color_mut())?;
        }
        if let Some(layer) = layer("normal") {
            let up = if self.normal_y == NormalY::Up { 1.0 } else { -1.0 };
            layer.fill_normals(cells.normals_mut(), up)?;
        }
        if let Some(layer) = layer("mask") {
            layer.fill_masks(cells.masks_mut())?;
        }
        Ok(())
    }
}
