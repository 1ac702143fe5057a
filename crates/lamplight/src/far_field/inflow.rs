//! The light that enters a window from the world around it.

use super::levels::BlockLevel;
use super::march::{BlockRay, RayDirection, Rings, march};
use super::near::{NearCells, NearRay};
use super::read::SIDE;
use crate::{GridWindow, Inflow, Panorama, Result, Rgb, Sky};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::ops::Range;

/// Blocks that a ray from the border of a tile crosses before they become twice as large: more are sharper shadows and
/// less error, and more blocks that travel to the machine that lights a tile.
const RING: i32 = 48;
/// Strips of inflow to a block along the border, and cells from one to the next. With a single one small lights throw rays.
const PARTS: i32 = 2;
const SPACING: i32 = SIDE as i32 / PARTS;
/// Rays of a column of inflow in a strip, and those of one where these see an edge of something bright.
const RAYS: usize = 2;
const FINE_RAYS: usize = 8;
/// The steps of a sequence that covers the unit square evenly (R₂, Roberts 2018).
const R2: [f64; 2] = [0.569_840_290_998_053, 0.754_877_666_246_693];
/// Radiance is said to have an edge where it changes by more than this from ray to ray, relative to its mean.
const EDGE: f32 = 4.0;

impl Rings {
    /// Finds those of the rays that enter a window, for so many levels.
    pub fn around(window: GridWindow, count: usize) -> Self {
        let [first, end] = edges(window);
        Self::new(count, first, end, RING)
    }
}

/// A test of a cell of the window, by its place in the world: it is solid.
pub type IsSolid<'a> = &'a (dyn Fn([i32; 2]) -> bool + Sync);

/// Returns the beginning and the end of the blocks of a window, px.
fn edges(GridWindow { first, size }: GridWindow) -> [[i32; 2]; 2] {
    let first = first.map(|v| v as i32);
    [first, [0, 1].map(|a| (first[a] + size[a] as i32 + 3) / 4 * 4)]
}

/// Returns the light that enters a window, which begins at a multiple of 4, in `columns` directions, through the cells near
/// it if they are known. Rays begin where cells of the window are open: a light or a wall that the border cuts through
/// would otherwise be seen from inside.
///
/// # Errors
/// As [`Inflow::new`].
pub fn inflow(
    levels: &[BlockLevel],
    sky: &Sky,
    window: GridWindow,
    columns: usize,
    is_solid: IsSolid,
    near: Option<&NearCells>,
) -> Result<Inflow> {
    let size = window.size;
    let [first, end] = edges(window);
    let rings = Rings::around(window, levels.len());
    let blocks = [0, 1].map(|a| (end[a] - first[a]) / SIDE as i32);
    let width = TAU / columns as f64;
    let rays = Rays::of_columns(columns);
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
        let border = Border {
            levels,
            rings: &rings,
            is_solid,
            near,
            rays: &rays,
            sky: &seen,
            across,
            outward,
        };
        let sources = border.sources();
        let block = |i: i32| {
            let mut block = first.map(|v| v / SIDE as i32);
            block[along] += i;
            block[across] += if outward < 0 { -1 } else { blocks[across] };
            block
        };
        let open: Vec<_> = (0..PARTS * blocks[along])
            .map(|i| border.open_cells(block(i / PARTS), i % PARTS))
            .collect();
        let strips = (0..open.len()).into_par_iter().map(|i| {
            // Between two strips radiance is linear, so one that no light reaches counts beside one that some does.
            let beside = i.saturating_sub(1)..(i + 2).min(open.len());
            if open[beside].iter().all(Vec::is_empty) {
                return vec![[0.0; 3]; columns];
            }
            let (block, part) = (block(i as i32 / PARTS), i as i32 % PARTS);
            border.strip(block, part, &open[i], &sources)
        });
        strips.collect::<Vec<_>>()
    });
    Inflow::of_sparse_strips(size, columns, SPACING as u32, &strips)
}

/// A side of the border of a window.
struct Border<'a> {
    levels: &'a [BlockLevel],
    rings: &'a Rings,
    is_solid: IsSolid<'a>,
    near: Option<&'a NearCells<'a>>,
    rays: &'a Rays,
    /// The sky by column.
    sky: &'a [Rgb],
    /// The axis across the side, and the way outward along it: 1 or -1.
    across: usize,
    outward: i32,
}

impl Border<'_> {
    /// Returns the component of a ray's direction that leads outward.
    fn cosine(&self, ray: &RayDirection) -> f64 {
        ray.way[self.across] * f64::from(self.outward)
    }

    /// Returns for each column the one whose light it has: its own if its middle leads outward, otherwise the nearest
    /// such column, whose light grazes the border.
    fn sources(&self) -> Vec<usize> {
        let columns = self.sky.len();
        let leads_out = |column: usize| {
            let rays = &self.rays.first[column * RAYS..(column + 1) * RAYS];
            rays.iter().map(|ray| self.cosine(ray)).sum::<f64>() > 0.0
        };
        let nearest = |column: usize| {
            let mut steps = (0..columns)
                .flat_map(|d| [(column + d) % columns, (column + columns - d) % columns]);
            steps.find(|&other| leads_out(other)).unwrap_or(column)
        };
        (0..columns).map(nearest).collect()
    }

    /// Returns the numbers of the cells along the border at a part of a block that light can reach.
    fn open_cells(&self, block: [i32; 2], part: i32) -> Vec<i32> {
        let along = 1 - self.across;
        let is_open = |&number: &i32| {
            let mut cell = block.map(|v| v * SIDE as i32);
            cell[along] += number;
            cell[self.across] += if self.outward < 0 { SIDE as i32 } else { -1 };
            !(self.is_solid)(cell)
        };
        cells_of(part).filter(is_open).collect()
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

    /// Returns the radiance that comes through a part of a block at the border, by column: by the open cells there, or by all
    /// if none is open.
    fn strip(&self, block: [i32; 2], part: i32, open: &[i32], sources: &[usize]) -> Vec<Rgb> {
        let all: Vec<i32> = cells_of(part).collect();
        let open = if open.is_empty() { &all } else { open };
        let columns = sources.len();
        let along = 1 - self.across;
        let edge = block[self.across] + i32::from(self.outward < 0);
        let strip = block[along] * PARTS + part;
        // The radiance along a ray, by its number and its column.
        let trace = |ray: &RayDirection, number: usize, column: usize| -> Rgb {
            // The rays of a strip and of those beside it are spread evenly.
            let place = R2[0] * number as f64 + R2[1] * f64::from(strip);
            let place = place.fract() * open.len() as f64;
            let cell = f64::from(open[place as usize]);
            let mut from = [0.0; 2];
            from[self.across] = f64::from(edge * SIDE as i32);
            from[along] = f64::from(block[along] * SIDE as i32) + cell + place.fract();
            let [light, through] = self.seen(from, ray, block);
            std::array::from_fn(|c| light[c] + through[c] * self.sky[column][c])
        };
        // The sum of those of a column, and their number. Some of a column that grazes the border lead inward.
        let of_column = |rays: &[RayDirection], column: usize, seen: &mut dyn FnMut(usize, Rgb)| {
            let each = rays.len() / columns;
            let numbers = column * each..(column + 1) * each;
            for number in numbers.filter(|&number| self.cosine(&rays[number]) > 0.0) {
                seen(number, trace(&rays[number], number, column));
            }
        };
        let own = || (0..columns).filter(|&column| sources[column] == column);
        let mut sums = vec![RaySum::default(); columns];
        let mut brightness = vec![0.0; columns * RAYS];
        for column in own() {
            of_column(&self.rays.first, column, &mut |number, rgb| {
                sums[column].add(rgb);
                brightness[number] = rgb[0].max(rgb[1]).max(rgb[2]);
            });
        }
        let least = EDGE * brightness.iter().sum::<f32>() / brightness.len() as f32;
        let count = brightness.len();
        for column in own() {
            // With the nearest ray of each column beside it.
            let near = (0..RAYS + 2).map(|i| brightness[(column * RAYS + i + count - 1) % count]);
            let [low, high] =
                near.fold([f32::MAX, 0.0], |[low, high], v| [v.min(low), v.max(high)]);
            if high - low > least {
                of_column(&self.rays.fine, column, &mut |_, rgb| sums[column].add(rgb));
            }
        }
        sources.iter().map(|&source| sums[source].mean()).collect()
    }
}

/// Returns the cells of a part of a block along the border.
fn cells_of(part: i32) -> Range<i32> {
    part * SPACING..(part + 1) * SPACING
}

/// The directions of the rays of all columns, one column after the other.
struct Rays {
    first: Vec<RayDirection>,
    fine: Vec<RayDirection>,
}

impl Rays {
    fn of_columns(columns: usize) -> Self {
        let width = TAU / columns as f64;
        let directions = |each: usize| {
            let direction = |i: usize| {
                let spread = ((i % each) as f64 + 0.5) / each as f64 - 0.5;
                RayDirection::new(Panorama::angle(columns, i / each) + spread * width)
            };
            (0..columns * each).map(direction).collect()
        };
        Self { first: directions(RAYS), fine: directions(FINE_RAYS) }
    }
}

/// The sum of the radiance along some rays, and their number.
#[derive(Clone, Copy, Default)]
struct RaySum {
    sum: Rgb,
    count: f32,
}

impl RaySum {
    fn add(&mut self, rgb: Rgb) {
        (0..3).for_each(|c| self.sum[c] += rgb[c]);
        self.count += 1.0;
    }

    fn mean(&self) -> Rgb {
        self.sum.map(|v| v / self.count.max(1.0))
    }
}
