//! A layer's image, or its images in tiles, read as far as a window shows them.
//!
//! Tiles are squares of one side, which begin at the upper left corner of the scene. A name such as `sea/{x}_{y}.png`
//! stands for all of them: `{x}` is the column of a tile and `{y}` its row, from 0. A tile without a file is empty.

use super::picture::Picture;
use super::pictures::Pictures;
use super::source::Source;
use crate::check::BRIGHT;
use crate::mask::{self, ALL_LAYERS};
use crate::relief::{self, Normal};
use crate::{Error, GridWindow, Result, Rgb, srgb};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The parts of a name that stand for the column and the row of a tile.
const COLUMN_AND_ROW: [&str; 2] = ["{x}", "{y}"];

/// Returns whether a name has a part for the column and one for the row of a tile.
pub(super) fn tile_parts(image: &Path) -> [bool; 2] {
    let name = image.to_string_lossy();
    COLUMN_AND_ROW.map(|part| name.contains(part))
}

/// Returns the name of a tile.
fn tile_name(image: &Path, tile: [u32; 2]) -> PathBuf {
    let name = image.to_string_lossy().into_owned();
    let parts = COLUMN_AND_ROW.iter().zip(tile);
    parts.fold(name, |name, (part, number)| name.replace(part, &number.to_string())).into()
}

/// Returns the names of all tiles that cover a scene, row by row.
pub(super) fn tile_names(
    image: &Path,
    side: u32,
    scene: [u32; 2],
) -> impl Iterator<Item = PathBuf> {
    let [columns, rows] = scene.map(|length| length.div_ceil(side));
    let tiles = (0..rows).flat_map(move |row| (0..columns).map(move |column| [column, row]));
    tiles.map(move |tile| tile_name(image, tile))
}

/// The window of a scene that is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScenePlace {
    /// Columns and rows of the scene.
    pub scene: [u32; 2],
    pub window: GridWindow,
}

impl ScenePlace {
    /// The whole of a scene.
    pub fn whole(scene: [u32; 2]) -> Self {
        Self { scene, window: GridWindow { first: [0; 2], size: scene } }
    }
}

/// A layer in a window of its scene.
pub(super) struct Layer<'a, 's> {
    pub key: String,
    pub image: &'a Path,
    /// The side of its tiles, if it has some.
    pub tile: Option<u32>,
    pub place: ScenePlace,
    pub source: Source<'s>,
    pub pictures: &'a Pictures,
}

/// A pixel of an image.
#[derive(Clone, Copy)]
pub(super) struct Pixel<'a> {
    picture: &'a Picture,
    x: u32,
    y: u32,
}

impl Pixel<'_> {
    /// The linear colour, and the alpha.
    pub fn color(&self) -> (Rgb, f32) {
        self.picture.color(self.x, self.y)
    }

    /// The values as they are, and the alpha.
    pub fn value(&self) -> (Rgb, f32) {
        self.picture.value(self.x, self.y)
    }

    /// The linear colour, black as far as it is transparent.
    pub fn light(&self) -> Rgb {
        let (rgb, alpha) = self.color();
        rgb.map(|v| v * alpha)
    }

    /// Returns whether the values are linear: those of an EXR.
    fn is_linear(&self) -> bool {
        matches!(self.picture, Picture::Float(_))
    }

    fn error(&self, field: &'static str, value: f32, expected: &'static str) -> Error {
        Error::Cell { x: self.x, y: self.y, field, value, expected }
    }
}

impl Layer<'_, '_> {
    /// Sets one field of every cell from its pixel and its value before; rejects values that an EXR can hold and the field
    /// cannot. Cells of missing tiles are left as they are.
    pub fn fill<T: Channels>(
        &self,
        field: &'static str,
        cells: &mut [T],
        range: RangeInclusive<f32>,
        value: impl Fn(Pixel, &T) -> T,
    ) -> Result<()> {
        self.visit(|i, pixel| {
            cells[i] = value(pixel, &cells[i]);
            match cells[i].channels().iter().find(|v| !range.contains(v)) {
                Some(&value) => {
                    let expected = if *range.end() == 1.0 { "0 to 1" } else { "0 to 1e12" };
                    Err(pixel.error(field, value, expected))
                }
                None => Ok(()),
            }
        })
    }

    /// Sets the light of every cell, times `scale`.
    pub fn fill_light(&self, field: &'static str, cells: &mut [Rgb], scale: f32) -> Result<()> {
        self.fill(field, cells, 0.0..=BRIGHT, |pixel, _| pixel.light().map(|v| v * scale))
    }

    /// Sets the mask of every cell; rejects cells in no layer.
    pub fn fill_masks(&self, masks: &mut [u8]) -> Result<()> {
        self.visit(|i, pixel| {
            let (rgb, alpha) = pixel.value();
            let value = if alpha == 0.0 { 1.0 } else { grey(rgb) };
            if !(0.0..=1.0).contains(&value) {
                return Err(pixel.error("mask", value, "0 to 1"));
            }
            masks[i] = (value * f32::from(ALL_LAYERS)).round() as u8;
            if masks[i] == 0 {
                return Err(pixel.error("mask", 0.0, mask::EXPECTED));
            }
            Ok(())
        })
    }

    /// Sets the normal of every cell from an image in which green stands for `up`, −1 if it stands for down. Components are
    /// encoded, except in an EXR. Transparent pixels are not tilted.
    pub fn fill_normals(&self, normals: &mut [Normal], up: f32) -> Result<()> {
        self.visit(|i, pixel| {
            let (values, alpha) = pixel.value();
            if alpha == 0.0 {
                return Ok(());
            }
            let direction = if pixel.is_linear() { values } else { relief::decode(values) };
            if let Some(&value) = direction.iter().find(|v| !(-1.0..=1.0).contains(*v)) {
                return Err(pixel.error("normal", value, "-1 to 1"));
            }
            if direction == [0.0; 3] && pixel.is_linear() {
                return Err(pixel.error("normal", 0.0, "of a direction, such as (0, 0, 1)"));
            }
            let [x, y, z] = relief::unit(direction);
            normals[i] = [x, -up * y, z];
            Ok(())
        })
    }

    /// Lays the image over the picture under the light.
    pub fn paint(&self, color: &mut [Rgb]) -> Result<()> {
        self.fill("color", color, 0.0..=1.0, |pixel, below| {
            let (rgb, alpha) = pixel.color();
            std::array::from_fn(|c| below[c] * (1.0 - alpha) + rgb[c] * alpha)
        })
    }

    /// Visits the pixel of every cell of the window, with the cell's index. Each image is opened once.
    fn visit(&self, mut visit: impl FnMut(usize, Pixel) -> Result<()>) -> Result<()> {
        let ScenePlace { scene, window } = self.place;
        let side = self.tile.map_or(scene, |side| [side; 2]);
        let end = [0, 1].map(|a| window.first[a] + window.size[a]);
        let tiles = |a: usize| window.first[a] / side[a]..end[a].div_ceil(side[a]);
        for tile in tiles(1).flat_map(|row| tiles(0).map(move |column| [column, row])) {
            let first = [0, 1].map(|a| tile[a] * side[a]);
            let Some((path, picture)) = self.open(tile, first)? else { continue };
            let cells = |a: usize| {
                let picture_end = first[a].saturating_add(side[a]);
                first[a].max(window.first[a])..picture_end.min(end[a])
            };
            for y in cells(1) {
                let row = (y - window.first[1]) as usize * window.size[0] as usize;
                for x in cells(0) {
                    let pixel = Pixel { picture: &picture, x: x - first[0], y: y - first[1] };
                    visit(row + (x - window.first[0]) as usize, pixel)
                        .map_err(|e| e.in_file(&path).under(&self.key))?;
                }
            }
        }
        Ok(())
    }

    /// Reads the image of a tile, if there is one, or the only one.
    fn open(&self, tile: [u32; 2], first: [u32; 2]) -> Result<Option<(PathBuf, Arc<Picture>)>> {
        let name = self.tile.map(|_| tile_name(self.image, tile));
        let path = self.source.place(name.as_deref().unwrap_or(self.image));
        if self.tile.is_some() && !self.source.has(&path) {
            return Ok(None);
        }
        let rest = [0, 1].map(|a| self.place.scene[a] - first[a]);
        let (fits, expected) = match self.tile {
            // The last ones may be cut off where the scene ends.
            Some(side) => {
                (vec![[side; 2], rest.map(|v| v.min(side))], format!("the `tile` {side}"))
            }
            None => (vec![rest], "the size of the scene".to_owned()),
        };
        let exact = |width, height| {
            if fits.contains(&[width, height]) {
                return Ok(());
            }
            let expected = format!("{}×{} px, {expected}", fits[0][0], fits[0][1]);
            let found = format!("an image of {width}×{height} px ({})", path.display());
            Err(Error::value(&self.key, found, expected))
        };
        let picture = self.pictures.get(self.source, &path, &self.key, exact)?;
        Ok(Some((path, picture)))
    }
}

/// One value or three.
pub(super) trait Channels {
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
pub(super) fn grey(rgb: Rgb) -> f32 {
    if rgb == [rgb[0]; 3] { rgb[0] } else { srgb::luminance(rgb) }
}
