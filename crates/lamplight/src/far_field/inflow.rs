//! The light that enters a window from the world around it.

use super::levels::BlockLevel;
use super::march::{BlockRay, RayDirection, Rings, march};
use super::near::{NearCells, NearRay};
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

/// Returns the light that enters a window, which begins at a multiple of 4, in `columns` directions, through the cells near
/// it if they are known.
///
/// # Errors
/// As [`Inflow::new`].
pub fn inflow(
    levels: &[BlockLevel],
    sky: &Sky,
    window: GridWindow,
    columns: usize,
    near: Option<&NearCells>,
) -> Result<Inflow> {
    let size = window.size;
    let [first, end] = edges(window);
    let rings = Rings::around(window, levels.len());
    let blocks = [0, 1].map(|a| (end[a] - first[a]) / SIDE as i32);
    let width = TAU / columns as f64;
    let rays: Vec<RayDirection> = (0..columns * RAYS)
        .map(|i| {
            let spread = ((i % RAYS) as f64 + 0.5) / RAYS as f64 - 0.5;
            RayDirection::new(Panorama::angle(columns, i / RAYS) + spread * width)
        })
        .collect();
    let seen: Vec<Rgb> = (0..columns)
        .map(|column| {
            let middle = Panorama::angle(columns, column);
            sky.mean(middle - 0.5 * width, middle + 0.5 * width)
        })
        .collect();
    // By side: top, right, bottom, left.
    let strips = [0, 1, 2, 3].map(|side| {
        let along = side % 2;
        let across = 1 - along;
        let outward = if side == 0 || side == 3 { -1 } else { 1 };
        let border =
            Border { levels, rings: &rings, near, rays: &rays, sky: &seen, across, outward };
        let sources = border.sources();
        let strips = (0..blocks[along]).into_par_iter().map(|i| {
            let mut block = first.map(|v| v / SIDE as i32);
            block[along] += i;
            block[across] += if outward < 0 { -1 } else { blocks[across] };
            border.strip(block, &sources)
        });
        strips.collect::<Vec<_>>()
    });
    Inflow::of_sparse_strips(size, columns, SIDE as u32, &strips)
}

/// A side of the border of a window.
struct Border<'a> {
    levels: &'a [BlockLevel],
    rings: &'a Rings,
    near: Option<&'a NearCells<'a>>,
    /// Directions of all rays, column by column.
    rays: &'a [RayDirection],
    /// The sky by column.
    sky: &'a [Rgb],
    /// The axis across the side, and the way outward along it: 1 or -1.
    across: usize,
    outward: i32,
}

impl Border<'_> {
    /// Returns the component of a ray's direction that leads outward.
    fn cosine(&self, ray: usize) -> f64 {
        self.rays[ray].way[self.across] * f64::from(self.outward)
    }

    /// Returns for each column the one whose light it has: its own if its middle leads outward, otherwise the nearest
    /// such column, whose light grazes the border.
    fn sources(&self) -> Vec<usize> {
        let columns = self.sky.len();
        let leads_out = |column: usize| {
            let rays = column * RAYS..(column + 1) * RAYS;
            rays.map(|ray| self.cosine(ray)).sum::<f64>() > 0.0
        };
        let nearest = |column: usize| {
            let mut steps = (0..columns)
                .flat_map(|d| [(column + d) % columns, (column + columns - d) % columns]);
            steps.find(|&other| leads_out(other)).unwrap_or(column)
        };
        (0..columns).map(nearest).collect()
    }

    /// Returns the numbers of the cells along the border at a block that light can reach: all if none can, or if cells are
    /// not known.
    fn open_cells(&self, block: [i32; 2]) -> Vec<i32> {
        let all = 0..SIDE as i32;
        let Some(near) = self.near else { return all.collect() };
        let along = 1 - self.across;
        let is_open = |&number: &i32| {
            let mut cell = block.map(|v| v * SIDE as i32);
            cell[along] += number;
            cell[self.across] += if self.outward < 0 { SIDE as i32 } else { -1 };
            !near.is_solid(cell)
        };
        let open: Vec<i32> = all.clone().filter(is_open).collect();
        if open.is_empty() { all.collect() } else { open }
    }

    /// Returns the radiance along a ray that enters a block at the border, and the transmittance of its way.
    fn seen(&self, from: [f64; 2], direction: &RayDirection, block: [i32; 2]) -> [Rgb; 2] {
        let of_blocks = |block| {
            let ray = BlockRay { from, direction, block, reach: f64::INFINITY };
            march(self.levels, self.rings, ray)
        };
        let Some(near) = self.near else { return of_blocks(block) };
        let NearRay { light, through, block } = near.cross(from, direction.way, self.across);
        if through == [0.0; 3] {
            return [light, through];
        }
        let [behind, passed] = of_blocks(block);
        [
            std::array::from_fn(|c| light[c] + through[c] * behind[c]),
            std::array::from_fn(|c| through[c] * passed[c]),
        ]
    }

    /// Returns the radiance that comes through a block at the border, by column.
    fn strip(&self, block: [i32; 2], sources: &[usize]) -> Vec<Rgb> {
        let mut strip = vec![[0.0; 3]; sources.len()];
        let along = 1 - self.across;
        let mut from = [0.0; 2];
        let edge = block[self.across] + i32::from(self.outward < 0);
        from[self.across] = f64::from(edge * SIDE as i32);
        let open = self.open_cells(block);
        for column in (0..sources.len()).filter(|&column| sources[column] == column) {
            // Those of a column that grazes the border may lead inward.
            let rays = (column * RAYS..(column + 1) * RAYS).filter(|&ray| self.cosine(ray) > 0.0);
            let mut count = 0.0;
            for ray in rays {
                // Multiples of the golden ratio, without the whole, are spread evenly over any number of them.
                let place = (GOLDEN_RATIO * ray as f64).fract();
                let place = place * open.len() as f64;
                let cell = f64::from(open[place as usize]);
                from[along] = f64::from(block[along] * SIDE as i32) + cell + place.fract();
                let [light, through] = self.seen(from, &self.rays[ray], block);
                count += 1.0;
                for c in 0..3 {
                    strip[column][c] += light[c] + through[c] * self.sky[column][c];
                }
            }
            strip[column] = strip[column].map(|v| v / f32::max(count, 1.0));
        }
        for column in 0..sources.len() {
            strip[column] = strip[sources[column]];
        }
        strip
    }
}
