//! Layers: images of the scene's size that hold one field of every cell.

use super::picture::Picture;
use super::source::Source;
use crate::check;
use crate::mask::{self, ALL_LAYERS};
use crate::relief::{self, UP};
use crate::{Cells, Error, Result, Rgb};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// Images that fill the grid under the shapes. Each is a PNG, EXR, WebP or JPEG of exactly the scene's
/// size; relative paths start at the scene file's folder.
///
/// Transparent pixels are mixed with the defaults (emission, glow, opacity and albedo 0, tint 1, the picture
/// white) by their alpha; fully transparent ones are ignored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Layers {
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
    /// Normal map of the final picture: `n·½ + ½` per channel, without sRGB decoding, z towards the viewer. Transparent
    /// pixels are not tilted. `[display.relief]` has how it is lit.
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

    /// The images, as the scene names them.
    pub(crate) fn images(&self) -> impl Iterator<Item = &PathBuf> {
        let Self { emission, glow, opacity, albedo, tint, color, normal, mask, .. } = self;
        [emission, glow, opacity, albedo, tint, color, normal, mask].into_iter().flatten()
    }

    pub(crate) fn check(&self) -> Result<()> {
        check::number("layers.emission_scale", self.emission_scale, 0.0..=1e6)?;
        check::number("layers.glow_scale", self.glow_scale, 0.0..=1e6)
    }

    /// Reads every layer into the grid.
    pub(crate) fn read(&self, source: Source, cells: &mut Cells) -> Result<()> {
        let size = [cells.width(), cells.height()];
        let open = |key, path: &Option<PathBuf>| {
            path.as_ref().map(|path| Layer::open(key, source, path, size)).transpose()
        };
        if let Some(layer) = open("emission", &self.emission)? {
            layer.fill_light("emission", cells.emission_mut(), self.emission_scale)?;
            if self.opacity.is_none() {
                for i in 0..cells.len() {
                    let glows = cells.emission()[i].iter().any(|&e| e > 0.0);
                    cells.opacity_mut()[i] = if glows { 1.0 } else { 0.0 };
                }
            }
        }
        if let Some(layer) = open("glow", &self.glow)? {
            layer.fill_light("glow", cells.glow_mut(), self.glow_scale)?;
        }
        if let Some(layer) = open("opacity", &self.opacity)? {
            layer.fill("opacity", cells.opacity_mut(), 0.0..=1.0, |x, y| {
                let (rgb, alpha) = layer.picture.value(x, y);
                grey(rgb) * alpha
            })?;
        }
        if let Some(layer) = open("albedo", &self.albedo)? {
            layer.fill("albedo", cells.albedo_mut(), 0.0..=1.0, |x, y| {
                let (rgb, alpha) = layer.picture.color(x, y);
                rgb.map(|v| v * alpha)
            })?;
            layer.paint(cells.color_mut())?;
        }
        if let Some(layer) = open("tint", &self.tint)? {
            layer.fill("tint", cells.tint_mut(), 0.0..=1.0, |x, y| {
                let (rgb, alpha) = layer.picture.value(x, y);
                rgb.map(|v| 1.0 - alpha + v * alpha)
            })?;
        }
        if let Some(layer) = open("color", &self.color)? {
            layer.paint(cells.color_mut())?;
        }
        if let Some(layer) = open("normal", &self.normal)? {
            let sign = if self.normal_y == NormalY::Up { 1.0 } else { -1.0 };
            layer.fill("normal", cells.normals_mut(), -1.0..=1.0, |x, y| {
                let (rgb, alpha) = layer.picture.value(x, y);
                if alpha == 0.0 {
                    return UP;
                }
                let [x, y, z] = relief::decode(rgb);
                [x, sign * y, z]
            })?;
        }
        if let Some(layer) = open("mask", &self.mask)? {
            layer.fill_masks(cells.masks_mut())?;
        }
        Ok(())
    }
}

/// The image of a layer, with its key and path for errors.
struct Layer {
    key: String,
    path: PathBuf,
    picture: Picture,
}

impl Layer {
    fn open(key: &str, source: Source, path: &Path, size: [u32; 2]) -> Result<Self> {
        let key = format!("layers.{key}");
        let path = source.place(path);
        let exact = |width, height| {
            if [width, height] == size {
                return Ok(());
            }
            let expected = format!("{}×{} px, the size of the scene", size[0], size[1]);
            let found = format!("an image of {width}×{height} px ({})", path.display());
            Err(Error::value(&key, found, expected))
        };
        let picture = Picture::open(source, &path, &key, exact)?;
        Ok(Self { picture, key, path })
    }

    /// Sets one field of every cell; rejects values that an EXR can hold and the field cannot.
    fn fill<T: Channels>(
        &self,
        field: &'static str,
        cells: &mut [T],
        range: RangeInclusive<f32>,
        value: impl Fn(u32, u32) -> T,
    ) -> Result<()> {
        let [width, _] = self.picture.size();
        for (i, cell) in cells.iter_mut().enumerate() {
            let (x, y) = ((i % width as usize) as u32, (i / width as usize) as u32);
            *cell = value(x, y);
            if let Some(&value) = cell.channels().iter().find(|v| !range.contains(v)) {
                let expected = if *range.end() == 1.0 { "0 to 1" } else { "0 to 1e12" };
                let error = Error::Cell { x, y, field, value, expected };
                return Err(error.in_file(&self.path).under(&self.key));
            }
        }
        Ok(())
    }

    /// Sets the light of every cell, times `scale`.
    fn fill_light(&self, field: &'static str, cells: &mut [Rgb], scale: f32) -> Result<()> {
        self.fill(field, cells, 0.0..=check::BRIGHT, |x, y| {
            let (rgb, alpha) = self.picture.color(x, y);
            rgb.map(|v| v * alpha * scale)
        })
    }

    /// Sets the mask of every cell; rejects cells in no layer.
    fn fill_masks(&self, masks: &mut [u8]) -> Result<()> {
        let mut values = vec![0.0; masks.len()];
        self.fill("mask", &mut values, 0.0..=1.0, |x, y| {
            let (rgb, alpha) = self.picture.value(x, y);
            if alpha == 0.0 { 1.0 } else { grey(rgb) }
        })?;
        let [width, _] = self.picture.size();
        for (i, (mask, value)) in (0..).zip(masks.iter_mut().zip(values)) {
            *mask = (value * f32::from(ALL_LAYERS)).round() as u8;
            if *mask == 0 {
                let (x, y, expected) = (i % width, i / width, mask::EXPECTED);
                let error = Error::Cell { x, y, field: "mask", value: 0.0, expected };
                return Err(error.in_file(&self.path).under(&self.key));
            }
        }
        Ok(())
    }

    /// Lays the image over the picture under the light.
    fn paint(&self, color: &mut [Rgb]) -> Result<()> {
        let under = color.to_vec();
        let [width, _] = self.picture.size();
        self.fill("color", color, 0.0..=1.0, |x, y| {
            let (rgb, alpha) = self.picture.color(x, y);
            let below = under[y as usize * width as usize + x as usize];
            std::array::from_fn(|c| below[c] * (1.0 - alpha) + rgb[c] * alpha)
        })
    }
}

/// One value or three.
trait Channels {
    fn channels(&self) -> &[f32];
}

impl Channels for f32 {
    fn channels(&self) -> &[f32] {
        std::slice::from_ref(self)
    }
}

impl Channels for Rgb {
    fn channels(&self) -> &[f32] {
        self
    }
}

/// The luma (Rec. 709) of a colour; grey stays exactly as it is.
fn grey(rgb: Rgb) -> f32 {
    if rgb == [rgb[0]; 3] { rgb[0] } else { crate::srgb::luminance(rgb) }
}
