//! Memory: an estimate of what lighting a scene takes, against what this process can get.
//!
//! An allocation that fails ends a Rust program at once. So the need is estimated before anything
//! that grows with the scene is allocated, and a scene that cannot fit is rejected with both figures.

use crate::args::{Backend, Renderer};
use crate::available_memory::available;
use crate::error::{CliError, Result};
use lamplight::scene::PICTURE_BYTES;
use lamplight::settings::{MethodSettings, Variant};
use lamplight::world::{Tiling, WorldSettings};
use lamplight::{Bounces, Lamp, Scene, Settings};
use std::collections::HashSet;

/// Bytes that do not grow with the scene: the program, its threads and tables.
const BASE: u64 = 48 << 20;
/// Bytes per cell of what the GPU does not hold: the scene, its copies, the light and the picture.
const SCENE: u64 = 185;
/// Bytes per cell of the method that takes most.
const MOST: u64 = 1200;
/// Bytes per cell of normals: in the scene, and in its copies.
const NORMALS: u64 = 45;
/// Bytes per pixel of a cookie: as decoded, and as the library keeps it.
const COOKIE: u64 = 40;
/// Bytes per cell of the direct light of suns and of lamps that are exact.
const EXACT: u64 = 50;
/// Bytes per cell of the first moment of light that the GPU found: as it arrives, and as the library keeps it.
const MOMENT_READ: u64 = 60;
/// Bytes per cell of a tile with inflow, beside those of the method: border rows, and the copy that the source made.
const INFLOW: u64 = 500;
/// Bytes per cell of light that is kept, and of its first moment.
const KEPT: [u64; 2] = [13, 24];
/// Bytes of the pixels of a world's images per cell, at most: those of eight layers.
const PIXELS: u64 = 8 * 4;
/// Bytes per cell of a world in its far field, and in that of the next bounce, if two fifths of its blocks hold matter.
const FAR_FIELD: u64 = 48;
/// Bytes per cell of the light of a row, kept until all rows are compared.
const ROW: u64 = 16;
/// Bytes per cell of FLIP.
const FLIP: u64 = 80;

/// Properties of a scene that decide how much memory it takes.
#[derive(Clone, Copy, Debug)]
pub struct SceneSize {
    pub cells: u64,
    /// True if the cells have normals.
    normals: bool,
    /// True if a lamp or a sun is lit by a shadow map.
    exact: bool,
    /// Pixels of the images of cookies.
    cookies: u64,
}

impl SceneSize {
    /// The size of matter alone.
    pub fn of_matter(cells: u64) -> Self {
        Self { cells, normals: false, exact: false, cookies: 0 }
    }

    /// The size of a scene.
    pub fn of(scene: &Scene) -> Self {
        let [width, height] = scene.size.map(u64::from);
        Self {
            cells: width * height,
            normals: scene.layers.normal.is_some(),
            exact: !scene.suns.is_empty() || scene.lamps.iter().any(Lamp::is_exact),
            cookies: pixels_of_cookies(scene),
        }
    }
}

/// The number of pixels of the images of a scene's cookies, each image once. Images that cannot be read count
/// nothing: reading the scene says so.
fn pixels_of_cookies(scene: &Scene) -> u64 {
    let images: HashSet<_> = scene.cookies().collect();
    let sizes = images.iter().filter_map(|image| image::image_dimensions(image).ok());
    sizes.map(|(width, height)| u64::from(width) * u64::from(height)).sum()
}

/// The number of bytes that lighting a scene takes in main memory, rounded up.
pub fn estimate(size: SceneSize, renderer: Renderer, settings: &Settings, backend: Backend) -> u64 {
    let SceneSize { cells, normals, exact, cookies } = size;
    let moment = normals || settings.moment;
    let if_so = |asked: bool, bytes: u64| if asked { bytes } else { 0 };
    let per_cell = match renderer {
        Renderer::Method(_) if backend == Backend::Gpu => SCENE + if_so(moment, MOMENT_READ),
        Renderer::Method(_) => {
            of_method(settings) + if_so(moment, of_moment(settings)) + if_so(exact, EXACT)
        }
        // It always finds the moment.
        Renderer::Reference => SCENE + MOMENT_READ,
    };
    let of_cells = cells.saturating_mul(per_cell + if_so(normals, NORMALS));
    BASE + of_cells.saturating_add(cookies.saturating_mul(COOKIE))
}

/// The number of bytes that lighting a world tile by tile takes, and the images that it keeps.
pub fn estimate_world([width, height]: [u32; 2], tile: u32, settings: &WorldSettings) -> u64 {
    let cells = u64::from(width) * u64::from(height);
    let solved = u64::from(tile + 2 * settings.halo).pow(2);
    // Two rows of tiles and one around, with their rims.
    let [columns, rows] = [width, height].map(|side| u64::from(side.div_ceil(tile)));
    let tiles = (2 * columns + 3).min(columns * rows);
    let rim = Tiling::new([width, height], tile, settings.halo).map_or(0, |tiling| tiling.rim());
    let kept = tiles * u64::from(tile + 2 * rim).pow(2);
    let of_kept: u64 = KEPT.iter().sum();
    BASE + PICTURE_BYTES.min(cells.saturating_mul(PIXELS))
        + solved.saturating_mul(of_method(&settings.solver) + INFLOW)
        + kept.saturating_mul(of_kept)
        + cells.saturating_mul(FAR_FIELD)
}

/// The number of bytes that a comparison of some rows needs in addition to lighting.
pub fn estimate_rows(cells: u64, rows: usize) -> u64 {
    cells.saturating_mul(FLIP + ROW * (1 + rows as u64))
}

/// The number of bytes that a picture with `scale` × `scale` pixels per cell takes, and its file.
pub fn estimate_picture(cells: u64, scale: u32) -> u64 {
    if scale == 1 { 0 } else { cells.saturating_mul(6 * u64::from(scale).pow(2)) }
}

/// Bytes per cell of lighting by a method on the CPU: the peak of `render` at 1024×768 (resident
/// memory), and a tenth more. `tests/cli/memory.rs` checks that they are not far too large.
fn of_method(settings: &Settings) -> u64 {
    let bounces = settings.bounces != Bounces::Count(0);
    match &settings.method {
        MethodSettings::Raymarch(raymarch) => {
            let history = if raymarch.temporal.history_length > 1 { 80 } else { 0 };
            let denoised = if raymarch.denoise.passes > 0 { 45 } else { 0 };
            245 + history + denoised
        }
        MethodSettings::Flood(_) => 245,
        MethodSettings::Polar(_) => 215,
        MethodSettings::Cascades(_) => 225,
        MethodSettings::Holographic(own) if own.variant == Variant::Paper => MOST,
        MethodSettings::Holographic(_) => 400 + if bounces { 120 } else { 0 },
        // Not measured yet.
        _ => MOST,
    }
}

/// Bytes per cell of the first moment of light that a method finds on the CPU, measured as those of the method.
fn of_moment(settings: &Settings) -> u64 {
    match &settings.method {
        MethodSettings::Raymarch(_) => 165,
        MethodSettings::Flood(_) => 65,
        MethodSettings::Polar(_) => 90,
        MethodSettings::Cascades(_) => 80,
        _ => 115,
    }
}

/// Refuses work that takes more memory than this process can get.
pub fn check(needed: u64, what: impl std::fmt::Display) -> Result {
    match available() {
        Some(available) if needed > available => Err(CliError::failed(format_args!(
            "{what} takes about {} of memory, and {} can be had",
            in_words(needed),
            in_words(available)
        ))
        .hint("light a smaller scene, or raise the limit (`ulimit -v`)")),
        _ => Ok(()),
    }
}

/// A number of bytes in MB or GB.
fn in_words(bytes: u64) -> String {
    match bytes as f64 / 1e6 {
        mb if mb < 1000.0 => format!("{mb:.0} MB"),
        mb => format!("{:.1} GB", mb / 1000.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_worded_for_people() {
        assert_eq!(in_words(52_000_000), "52 MB");
        assert_eq!(in_words(5_230_000_000), "5.2 GB");
    }

    #[test]
    fn what_cannot_fit_is_refused_with_both_figures() {
        assert!(check(0, "nothing").is_ok());
        if available().is_some() {
            let error = format!("{:?}", check(1 << 60, "this").unwrap_err());
            assert!(error.contains("this takes about 1152921504.6 GB of memory, and "), "{error}");
        }
    }
}
