//! Shapes and sprites, painted into the grid.

use super::coverage::{self, Point, Window};
use super::geometry::{Geometry, Sprite};
use super::picture::Picture;
use super::pictures::Pictures;
use super::shape::Shape;
use super::source::Source;
use super::thin_wall::ThinWall;
use crate::check::BRIGHT;
use crate::mask::ALL_LAYERS;
use crate::{Cells, Error, Matter, Result, Rgb, srgb};
use image::RgbaImage;
use std::path::Path;

/// Alpha from which a sprite without antialiasing covers a cell, and coverage from which a cell is in the layers of a
/// shape, and a solid cell is replaced by what lets light through.
const HALF: f32 = 0.5;

/// Paints a shape; `key` names it in errors.
pub(crate) fn paint(
    shape: &Shape,
    key: &str,
    source: Source,
    pictures: &Pictures,
    cells: &mut Cells,
) -> Result<()> {
    let matter = shape.matter();
    if let Geometry::Sprite(sprite) = &shape.geometry {
        let key = format!("{key}.sprite.image");
        let path = source.place(&sprite.image);
        let fits = |width, height| fits_a_grid(width, height, &path, &key);
        let picture = pictures.get(source, &path, &key, fits)?;
        return paint_sprite(shape, sprite, &picture, cells)
            .map_err(|e| e.in_file(&path).under(&key));
    }
    let color = shape.color.or(shape.albedo).unwrap_or([1.0; 3]);
    let strength = if shape.color.is_some() { 1.0 } else { shape.opacity };
    let window = Window::grid(cells.width(), cells.height());
    // White paint on a white picture needs no picture.
    let paints = strength > 0.0 && (cells.color().is_some() || color != [1.0; 3]);
    let is_wall = shape.covers_by_area() && shape.opacity >= 1.0;
    let corners = shape.geometry.outline(shape.rotation).filter(|_| is_wall).unwrap_or_default();
    let thin_wall = ThinWall::of(&corners);
    visit(shape, &window, |x, y, share| {
        let i = cells.index(x as u32, y as u32);
        let share = share_of(shape, cells, i, share);
        if share == 0.0 {
            return;
        }
        let drawn = match thin_wall {
            Some(wall) => {
                let opacity = wall.opacity(&corners, [x, y], share);
                // What it emits follows the coverage.
                let emission = matter.emission.map(|v| v * share / opacity);
                Matter { emission, ..matter }.over(cells.matter(i), opacity)
            }
            None => matter.over(cells.matter(i), share),
        };
        cells.set_matter(i, drawn);
        set_layers(shape, i, share, cells);
        if paints {
            lay(&mut cells.color_mut()[i], color, share * strength);
        }
    });
    Ok(())
}

/// Rejects an image that is larger than a grid.
fn fits_a_grid(width: u32, height: u32, path: &Path, key: &str) -> Result<()> {
    Cells::check_size(width.into(), height.into()).map_err(|_| {
        let found = format!("an image of {width}×{height} px ({})", path.display());
        let (side, all) = (Cells::MAX_SIDE, Cells::MAX_CELLS);
        Error::value(key, found, format!("at most {side} px a side, {all} px in all"))
    })
}

/// Number of cells of a grid that a shape other than a sprite covers.
pub(crate) fn covered(shape: &Shape, window: &Window) -> usize {
    let mut n = 0;
    visit(shape, window, |_, _, _| n += 1);
    n
}

/// Visits each cell that a shape other than a sprite covers, with its coverage.
fn visit(shape: &Shape, window: &Window, mut visit: impl FnMut(i64, i64, f32)) {
    match (&shape.geometry, shape.geometry.outline(shape.rotation)) {
        (Geometry::Circle(circle), _) => {
            let (center, radius) = (circle.center.map(f64::from), f64::from(circle.radius));
            if shape.covers_by_area() {
                coverage::disc_shares(center, radius, window, visit);
            } else {
                coverage::disc_centres(center, radius, window, |x, y| visit(x, y, 1.0));
            }
        }
        (_, Some(points)) if shape.covers_by_area() => {
            coverage::polygon_shares(&points, window, visit)
        }
        (_, Some(points)) => coverage::polygon_centres(&points, window, |x, y| visit(x, y, 1.0)),
        (_, None) => {}
    }
}

fn paint_sprite(
    shape: &Shape,
    sprite: &Sprite,
    picture: &Picture,
    cells: &mut Cells,
) -> Result<()> {
    let matter = shape.matter();
    let paint = shape.color.unwrap_or([1.0; 3]);
    let strength = if shape.color.is_some() { 1.0 } else { shape.opacity };
    let scale = f64::from(sprite.scale);
    let size = picture.size().map(f64::from);
    let center = sprite.center.map(f64::from);
    let (sin, cos) = f64::from(shape.rotation).sin_cos();
    let reach: Point = [
        (size[0] * cos.abs() + size[1] * sin.abs()) * scale / 2.0,
        (size[0] * sin.abs() + size[1] * cos.abs()) * scale / 2.0,
    ];
    let window = Window::grid(cells.width(), cells.height()).and(&Window::around(
        [center[0] - reach[0], center[1] - reach[1]],
        [center[0] + reach[0], center[1] + reach[1]],
    ));
    for y in window.y {
        for x in window.x.clone() {
            let texel = |[across, down]: Point| {
                let (dx, dy) = (x as f64 + across - center[0], y as f64 + down - center[1]);
                let u = (cos * dx + sin * dy) / scale + size[0] / 2.0;
                let v = (cos * dy - sin * dx) / scale + size[1] / 2.0;
                let inside = u >= 0.0 && v >= 0.0 && u < size[0] && v < size[1];
                if inside { picture.color(u as u32, v as u32) } else { ([0.0; 3], 0.0) }
            };
            let (rgb, share) = if shape.covers_by_area() {
                coverage::mean_color(texel)
            } else {
                let (rgb, alpha) = texel([0.5; 2]);
                (rgb, f32::from(u8::from(alpha >= HALF)))
            };
            let at = cells.index(x as u32, y as u32);
            let share = share_of(shape, cells, at, share);
            if share == 0.0 {
                continue;
            }
            let texel = Texel { rgb, share, paint, strength };
            cover(&matter, texel, [x as u32, y as u32], cells)?;
            set_layers(shape, at, share, cells);
        }
    }
    Ok(())
}

/// Returns the share of a cell that a shape draws on, of the share that it covers. What lets light through leaves a solid
/// cell whole or takes its place: in part it would open a wall.
fn share_of(shape: &Shape, cells: &Cells, index: usize, share: f32) -> f32 {
    if !shape.only.takes(cells, index) {
        0.0
    } else if shape.opacity < 1.0 && cells.is_solid(index) {
        f32::from(u8::from(share >= HALF))
    } else {
        share
    }
}

/// Puts a cell, of which a shape covers a share, into the layers of the shape.
fn set_layers(shape: &Shape, index: usize, share: f32, cells: &mut Cells) {
    // Cells without masks are in all layers.
    if share >= HALF && (cells.masks().is_some() || shape.mask != ALL_LAYERS) {
        cells.masks_mut()[index] = shape.mask;
    }
}

impl Shape {
    /// Draws the shape into cells, with the same rules as in a scene. The image of a sprite is read
    /// from a path relative to the current folder; [`Cells::blit`] draws images from memory.
    ///
    /// ```
    /// use lamplight::{Cells, Shape};
    /// let mut cells = Cells::new(64, 48)?;
    /// Shape::rect([30.0, 8.0], [34.0, 40.0]).albedo([0.9, 0.3, 0.2]).draw(&mut cells)?;
    /// assert!(cells.is_solid(cells.index(31, 20)));
    /// # Ok::<(), lamplight::Error>(())
    /// ```
    ///
    /// # Errors
    /// Fails if a value of the shape is out of its range or its image cannot be read.
    pub fn draw(&self, cells: &mut Cells) -> Result<()> {
        self.check("shape")?;
        let source = Source::Folder(Path::new(""));
        paint(self, "shape", source, &Pictures::default(), cells)
    }
}

impl Cells {
    /// Draws an image, one cell per px, with its upper left corner at a cell that may lie outside the
    /// grid. Alpha is coverage; the colour (sRGB) multiplies emission, glow and albedo of `matter`
    /// and becomes the cell's colour.
    ///
    /// # Errors
    /// Fails if a value of `matter` is out of its range; cells drawn before that stay.
    pub fn blit(&mut self, image: &RgbaImage, position: [i32; 2], matter: Matter) -> Result<()> {
        for (x, y, pixel) in image.enumerate_pixels() {
            let at = [i64::from(position[0]) + i64::from(x), i64::from(position[1]) + i64::from(y)];
            let [Ok(x), Ok(y)] = at.map(u32::try_from) else { continue };
            let [r, g, b, alpha] = pixel.0;
            if alpha == 0 || x >= self.width() || y >= self.height() {
                continue;
            }
            let rgb = [r, g, b].map(srgb::decode_u8);
            let share = f32::from(alpha) / 255.0;
            let texel = Texel { rgb, share, paint: [1.0; 3], strength: matter.opacity };
            cover(&matter, texel, [x, y], self)?;
        }
        Ok(())
    }
}

/// Draws a px of a picture over a cell as a sprite of the shape's matter draws it, without its colour.
pub(crate) fn cover_matter(
    shape: &Shape,
    (rgb, alpha): (Rgb, f32),
    [x, y]: [u32; 2],
    cells: &mut Cells,
) -> Result<()> {
    let i = cells.index(x, y);
    let share = if shape.covers_by_area() { alpha } else { f32::from(u8::from(alpha >= HALF)) };
    let share = share_of(shape, cells, i, share);
    if share == 0.0 {
        return Ok(());
    }
    let product = |by: Rgb| -> Rgb { std::array::from_fn(|c| rgb[c] * by[c]) };
    let matter = shape.matter();
    let [emission, glow, albedo] = [matter.emission, matter.glow, matter.albedo].map(product);
    let matter = Matter { emission, glow, albedo, ..matter };
    judge(x, y, &matter, share, [0.0; 3])?;
    cells.set_matter(i, matter.over(cells.matter(i), share));
    set_layers(shape, i, share, cells);
    Ok(())
}

/// A texel of an image that is drawn over a cell.
struct Texel {
    rgb: Rgb,
    /// The covered fraction of the cell.
    share: f32,
    /// Factor on the texel's colour.
    paint: Rgb,
    /// Factor on the coverage of the colour.
    strength: f32,
}

/// Draws a texel over a cell: its colour multiplies the light that the matter emits and reflects.
fn cover(matter: &Matter, texel: Texel, [x, y]: [u32; 2], cells: &mut Cells) -> Result<()> {
    let Texel { rgb, share, paint, strength } = texel;
    let product = |by: Rgb| -> Rgb { std::array::from_fn(|c| rgb[c] * by[c]) };
    let [emission, glow, albedo] = [matter.emission, matter.glow, matter.albedo].map(product);
    let (matter, color) = (Matter { emission, glow, albedo, ..*matter }, product(paint));
    judge(x, y, &matter, share, color)?;
    let i = cells.index(x, y);
    cells.set_matter(i, matter.over(cells.matter(i), share));
    lay(&mut cells.color_mut()[i], color, share * strength);
    Ok(())
}

/// Refuses what an EXR sprite may hold and matter may not.
fn judge(x: u32, y: u32, matter: &Matter, share: f32, color: Rgb) -> Result<()> {
    let bad = |values: &[f32], max: f32| values.iter().copied().find(|v| !(0.0..=max).contains(v));
    let error = |field, expected| move |value| Err(Error::Cell { x, y, field, value, expected });
    bad(&[share], 1.0)
        .map(error("alpha", "0 to 1"))
        .or_else(|| bad(&matter.emission, BRIGHT).map(error("emission", "0 to 1e12")))
        .or_else(|| bad(&matter.glow, BRIGHT).map(error("glow", "0 to 1e12")))
        .or_else(|| bad(&matter.albedo, 1.0).map(error("albedo", "0 to 1")))
        .or_else(|| bad(&color, 1.0).map(error("color", "0 to 1")))
        .unwrap_or(Ok(()))
}

/// Blends a colour over a picture by a fraction.
pub(crate) fn lay(picture: &mut Rgb, paint: Rgb, share: f32) {
    *picture = std::array::from_fn(|c| picture[c] * (1.0 - share) + paint[c] * share);
}
