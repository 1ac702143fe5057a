//! The light that enters a window from the world around it.

use super::levels::BlockLevel;
use super::march::{BlockRay, Rings, march};
use super::read::SIDE;
use crate::{GridWindow, Inflow, Panorama, Result, Rgb, Sky};
use rayon::prelude::*;
use std::f64::consts::{GOLDEN_RATIO, TAU};

/// Blocks that a ray from the border of a tile crosses before they become twice as large: more are sharper shadows,
/// and take time.
const RING: i32 = 24;
/// Rays of a column of inflow, for each block along the border.
const RAYS: usize = 4;

impl Rings {
    /// Finds those of the rays that enter a window, for so many levels.
    pub fn around(window: GridWindow, count: usize) -> Self {
        let [first, end] = edges(window);
        Self::new(count, first, end, RING)
    }
}

/// Returns the beginning and the end of the blocks of a window, px.
fn edges(GridWindow { first, size }: GridWindow) -> [[i32; 2]; 2] {
    let first = first.map(|v| v as i32);
    [first, [0, 1].map(|a| (first[a] + size[a] as i32 + 3) / 4 * 4)]
}

/// Returns the light that enters a window, which begins at a multiple of 4, in `columns` directions.
///
/// # Errors
/// As [`Inflow::new`].
pub fn inflow(
    levels: &[BlockLevel],
    sky: &Sky,
    window: GridWindow,
    columns: usize,
) -> Result<Inflow> {
    let size = window.size;
    let [first, end] = edges(window);
    let rings = Rings::around(window, levels.len());
    let blocks = [0, 1].map(|a| (end[a] - first[a]) / SIDE as i32);
    // By side: top, right, bottom, left.
    let strips = [0, 1, 2, 3].map(|side| {
        let along = side % 2;
        let strips = (0..blocks[along]).into_par_iter().map(|i| {
            let mut block = first.map(|v| v / SIDE as i32);
            block[along] += i;
            let across = 1 - along;
            let outward = if side == 0 || side == 3 { -1 } else { 1 };
            block[across] += if outward < 0 { -1 } else { blocks[across] };
            strip((levels, &rings, sky), block, (across, outward), columns)
        });
        strips.collect::<Vec<_>>()
    });
    Inflow::of_strips(size, columns, |place, strip| {
        let along = usize::from(place.outward[0] != 0.0);
        let side = match place.outward {
            [_, y] if y < 0.0 => 0,
            [x, _] if x > 0.0 => 1,
            [_, y] if y > 0.0 => 2,
            _ => 3,
        };
        let strips = &strips[side];
        let at = (place.at[along] / SIDE as f32 - 0.5).clamp(0.0, (strips.len() - 1) as f32);
        let before = at as usize;
        let (one, other) = (&strips[before], &strips[(before + 1).min(strips.len() - 1)]);
        let past = at - before as f32;
        for (column, rgb) in strip.iter_mut().enumerate() {
            let (one, other) = (one[column], other[column]);
            *rgb = std::array::from_fn(|c| one[c] + (other[c] - one[c]) * past);
        }
    })
}

/// Returns the radiance that comes through a block at the border of a window, which lies across an axis outward, by
/// column.
fn strip(
    (levels, rings, sky): (&[BlockLevel], &Rings, &Sky),
    block: [i32; 2],
    (across, outward): (usize, i32),
    columns: usize,
) -> Vec<Rgb> {
    let mut strip = vec![[0.0; 3]; columns];
    let edge = f64::from((block[across] + i32::from(outward < 0)) * SIDE as i32);
    let along = 1 - across;
    let cosine = |angle: f64| [angle.cos(), angle.sin()][across] * f64::from(outward);
    let width = TAU / columns as f64;
    let leads_out = |column: usize| cosine(Panorama::angle(columns, column)) > 0.0;
    for column in (0..columns).filter(|&column| leads_out(column)) {
        let middle = Panorama::angle(columns, column);
        let sky = sky.mean(middle - 0.5 * width, middle + 0.5 * width);
        for ray in 0..RAYS {
            // Multiples of the golden ratio, without the whole, are spread evenly over any number of them.
            let place = (GOLDEN_RATIO * (column * RAYS + ray) as f64).fract();
            let spread = (ray as f64 + 0.5) / RAYS as f64 - 0.5;
            let mut angle = middle + spread * width;
            if cosine(angle) <= 0.0 {
                angle = middle;
            }
            let mut from = [edge; 2];
            from[along] = (f64::from(block[along]) + place) * SIDE as f64;
            let [light, through] = march(
                levels,
                rings,
                BlockRay { from, angle, block, axis: across, reach: f64::INFINITY },
            );
            for c in 0..3 {
                strip[column][c] += (light[c] + through[c] * sky[c]) / RAYS as f32;
            }
        }
    }
    // Columns that look inward have the light that grazes the border.
    for column in (0..columns).filter(|&column| !leads_out(column)) {
        let steps =
            (1..columns).flat_map(|d| [(column + d) % columns, (column + columns - d) % columns]);
        let nearest = steps.into_iter().find(|&other| leads_out(other));
        strip[column] = nearest.map_or([0.0; 3], |other| strip[other]);
    }
    strip
}
