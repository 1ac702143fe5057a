//! The lattice of a quadrant: its levels, planes and directions, and the cells that its rays cross.
//!
//! Planes of level n lie 2ⁿ slabs apart. From each row of a plane the rays `v_n(k) = (2ⁿ, k − 2ⁿ)`,
//! k = 0 … 2ⁿ⁺¹, lead to the next plane ("dense" directions: their far ends are 1 px apart). Cone i of
//! a level lies between the rays i and i + 1; two cones beyond each edge of the quadrant come before and
//! after these.
//!
//! From every row of a slab a ray of one direction crosses the same cells relative to its start, over
//! the same lengths, so they are found once for all rows.

use crate::grid::traverse::{Ray, traverse};
use crate::settings;
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::{ControlFlow, Range};

/// Width over which the rays of a bundle are spread, px. Slightly less than 1: a ray through the
/// corner of cells would have to choose a side.
pub(super) const BUNDLE_WIDTH: f64 = 0.999;

/// Returns the number of points of the lattice along a side of the grid, if they lie `2^spacing_level` px apart.
pub fn points(side: usize, spacing_level: u32) -> usize {
    side.div_ceil(1 << spacing_level)
}

/// Returns the number of planes of a level in a lattice `depth` points deep.
pub fn planes(depth: usize, level: u32) -> usize {
    depth.div_ceil(1 << level)
}

/// Returns the number of rays from each row of a plane of a level.
pub const fn rays(level: u32) -> usize {
    (2 << level) + 1
}

/// Returns the first level of which one ray spans the grid; at least one level is below it.
pub fn levels(depth: usize, first: u32) -> u32 {
    depth.next_power_of_two().trailing_zeros().max(first + 1)
}

/// Returns the lowest level whose intervals are extended to even rays over bent paths too: that of intervals of 16 px.
pub const fn bent(spacing_level: u32) -> u32 {
    4 - spacing_level
}

/// Cones beyond each edge of the quadrant.
pub const BEYOND: usize = 2;

/// Returns the number of cones of a level, with those beyond the edges of the quadrant.
pub const fn cones(level: u32) -> usize {
    (2 << level) + 2 * BEYOND
}

/// Returns the slope of the lower edge of a cone of a level.
pub fn slope(level: u32, cone: usize) -> f64 {
    (cone as f64 - BEYOND as f64) / f64::from(1u32 << level) - 1.0
}

/// Returns the directions between which a cone of a level lies in the quadrant, radians from the axis.
pub fn edges(level: u32, cone: usize) -> [f64; 2] {
    [cone, cone + 1].map(|cone| slope(level, cone).clamp(-1.0, 1.0).atan())
}

/// Returns the two angles of the grid, radians from +x towards +y, that edges in a quadrant lie at. Slabs are columns
/// of the grid if they lie `along_x`, otherwise rows; light comes from higher ones unless they are `reversed`.
pub fn on_grid(along_x: bool, reversed: bool, [from, to]: [f64; 2]) -> [f64; 2] {
    let ahead = if along_x { 0.0 } else { FRAC_PI_2 } + if reversed { PI } else { 0.0 };
    // Higher rows are clockwise of what is ahead, or the other way round.
    if along_x == reversed { [ahead - to, ahead - from] } else { [ahead + from, ahead + to] }
}

/// Returns the angles of the cones of a level as far as they lie in the quadrant, radians.
pub fn angles(level: u32) -> Vec<f64> {
    let angle = |cone| {
        let [from, to] = edges(level, cone);
        to - from
    };
    (0..cones(level)).map(angle).collect()
}

/// Replaces the light of the cones of a level by that of half cones of the level below: the sums of two
/// halves are the cones of the level below ([`cones_of_halves`]).
pub fn halves(cones: &mut [f64]) {
    let mut before = 0.0;
    for i in 0..cones.len() {
        let (own, after) = (cones[i], cones.get(i + 1).copied().unwrap_or(0.0));
        cones[i] = 0.25 * before + 0.5 * own + 0.25 * after;
        before = own;
    }
}

/// Replaces the light of the half cones of a level by that of its cones.
pub fn cones_of_halves(halves: &mut Vec<f64>) {
    let count = halves.len() / 2;
    for i in 0..count {
        halves[i] = halves[2 * i] + halves[2 * i + 1];
    }
    halves.truncate(count);
    halves.insert(0, 0.0);
    halves.push(0.0);
}

/// The face by which a ray of the quadrant enters a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Face {
    /// From the slab before.
    Front,
    /// From the row before, towards higher rows.
    Low,
    /// From the row after, towards lower rows.
    High,
}

/// A cell that a ray crosses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Slabs from the start.
    pub slab: usize,
    /// Rows from the start.
    pub row: isize,
    /// Length of the ray within the cell, px.
    pub length: f32,
    /// The face by which the ray enters.
    pub face: Face,
}

impl Crossing {
    /// Returns the offset of the cell from the first one, if `stride` is that from slab to slab.
    pub(super) fn offset(&self, stride: isize) -> isize {
        self.slab as isize * stride + self.row
    }
}

/// Returns the cells that a ray crosses, in order. It leads from the centre of a slab, `offset` px
/// from the centre of a row, to the centre of the slab `slabs` further on; `slope` is in rows per slab.
///
/// Callers keep rays off the corners of cells.
pub fn footprint(slabs: usize, slope: f64, offset: f64) -> Vec<Crossing> {
    let px_per_slab = slope.hypot(1.0);
    let from = [0.5, offset + 0.5];
    let ray = Ray { from, cell: [0, from[1].floor() as i32], direction: [1.0, slope] };
    let mut crossings = Vec::new();
    let _ = traverse(ray, [0.0, slabs as f64], |step| {
        let face = match step.along {
            [false, true] if slope > 0.0 => Face::Low,
            [false, true] => Face::High,
            _ => Face::Front,
        };
        let length = ((step.span[1] - step.span[0]) * px_per_slab) as f32;
        let [slab, row] = step.cell;
        crossings.push(Crossing { slab: slab as usize, row: row as isize, length, face });
        ControlFlow::<()>::Continue(())
    });
    crossings
}

/// Returns the footprints of a bundle: ray `ray` of a level as `width` parallel rays, spread over the
/// px across it, if points of the lattice lie `2^spacing_level` px apart.
pub fn bundle([level, spacing_level]: [u32; 2], ray: usize, width: u32) -> Vec<Vec<Crossing>> {
    let length = 1usize << (level + spacing_level);
    let slope = ray as f64 / f64::from(1u32 << level) - 1.0;
    let across = |i: u32| BUNDLE_WIDTH * ((f64::from(i) + 0.5) / f64::from(width) - 0.5);
    (0..width).map(|i| footprint(length, slope, across(i))).collect()
}

/// The longest rays of the final gather, px, by `spacing_level`. Masks of footprints have room for 31 rows to either side. A
/// ray also reads the rows beside its end, more of them where points lie farther apart, and the outermost cones rise by more
/// rows than they are long.
const LONGEST: [usize; 3] = [30, 29, 25];

/// The geometry of the final gather.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GatherGeometry {
    /// Planes that pixels gather from lie `2^level` px apart.
    pub level: u32,
    /// Points of the lattice lie `2^spacing_level` px apart.
    pub spacing_level: u32,
    /// The minimum distance from a pixel to its plane, px; the maximum is `2^level − 1` more.
    pub min_length: usize,
    /// Rays through a cone in which something emits light, or where it [splits at matter](Self::splits_at_matter).
    pub rays: u32,
}

impl GatherGeometry {
    /// Returns the geometry that settings ask for.
    pub fn new(settings: &settings::Holographic) -> Self {
        let spacing_level = settings.lattice_spacing.ilog2();
        // Planes lie no closer than points.
        let level = settings.gather_level.max(spacing_level);
        let most = (1 << level).min(LONGEST[spacing_level as usize] + 1 - (1 << level));
        let min_length = most.min(settings.gather_length as usize);
        Self { level, spacing_level, min_length, rays: settings.gather_rays }
    }

    /// Returns the level of the lattice whose planes pixels gather from: its first.
    pub fn first(&self) -> u32 {
        self.level - self.spacing_level
    }

    /// Returns whether several rays replace that along the middle of the two cones beside the axis wherever there is matter,
    /// and not only where something emits light. A wall along the axis shuts such a cone in part if there are few, and the
    /// one ray would be stopped in some columns and in others not: dashes along the wall.
    pub fn splits_at_matter(&self) -> bool {
        self.spacing_level > 1
    }

    /// Returns the maximum distance from a pixel to its plane, px.
    pub fn max_length(&self) -> usize {
        (1 << self.level) + self.min_length - 1
    }

    /// Returns the slabs whose pixels gather from a plane.
    pub fn slabs(&self, plane: usize, depth: usize) -> Range<usize> {
        let at = plane << self.level;
        at.saturating_sub(self.max_length())..(at + 1).saturating_sub(self.min_length).min(depth)
    }

    /// Returns the farthest plane that any slab gathers from.
    pub fn last_plane(&self, depth: usize) -> usize {
        (depth - 1 + self.max_length()) >> self.level
    }

    /// Returns the cones through which pixels gather from a plane `distance` slabs ahead.
    pub fn cones(&self, distance: usize) -> Vec<ConeRays> {
        let fine = self.first() + 1;
        let angles = angles(fine);
        let cone = |number: usize| {
            let [from, to] = [number, number + 1].map(|cone| slope(fine, cone).atan());
            let (middle, angle) = (0.5 * (from + to), angles[number]);
            // Cones beyond the edges of the quadrant find nothing on the way.
            let across = |i| angle * ((f64::from(i) + 0.5) / f64::from(self.rays) - 0.5);
            let places = std::iter::once(0.0).chain((0..self.rays).map(across));
            let ray = |place: f64| GatherRay::new(distance, (middle + place).tan());
            let cosines = [middle.cos() as f32, middle.sin() as f32];
            // Those beyond the edges of the quadrant come before, as many as after.
            let is_beside_axis = [number, number + 1].contains(&(angles.len() / 2));
            let splits_at_matter = self.splits_at_matter() && is_beside_axis;
            let rays = places.map(ray).collect();
            ConeRays { number, angle: angle as f32, cosines, splits_at_matter, rays }
        };
        // The outermost have no light.
        (1..cones(fine) - 1).map(cone).collect()
    }
}

/// The rays that a pixel sends through one cone.
#[derive(Clone, Debug)]
pub struct ConeRays {
    /// Index of the cone.
    pub number: usize,
    /// Angle of the cone within the quadrant, radians.
    pub angle: f32,
    /// Cosines between the middle of the cone and the axis, and the direction of higher rows.
    pub cosines: [f32; 2],
    /// [`GatherGeometry::splits_at_matter`], and it is beside the axis.
    pub splits_at_matter: bool,
    /// The ray along the middle, then those that replace it.
    pub rays: Vec<GatherRay>,
}

/// A ray from a pixel to the plane.
#[derive(Clone, Debug)]
pub struct GatherRay {
    /// The cells that it crosses.
    pub crossings: Vec<Crossing>,
    /// Rows from the start to the row nearest to its end on the plane.
    pub row: isize,
    /// Rows from there to the end, −½ to ½.
    pub past: f32,
}

impl GatherRay {
    fn new(distance: usize, slope: f64) -> Self {
        let rise = slope * distance as f64;
        let row = rise.round();
        let crossings = footprint(distance, slope, 0.0);
        Self { crossings, row: row as isize, past: (rise - row) as f32 }
    }

    /// Returns the weights of the rows before, at and after the nearest one in the light at its end: a
    /// quadratic B-spline. It blurs by ½ px wherever the ray ends, while linear interpolation would
    /// blur more between two rows than at one, and this draws stripes.
    pub fn weights(&self) -> [f32; 3] {
        let [before, after] = [0.5 - self.past, 0.5 + self.past];
        [0.5 * before * before, 0.75 - self.past * self.past, 0.5 * after * after]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cones_of_a_level_fill_the_quadrant() {
        for level in 0..10 {
            let sum: f64 = angles(level).iter().sum();
            assert!((sum - FRAC_PI_2).abs() < 1e-12, "level {level}: {sum}");
        }
    }

    #[test]
    fn halves_keep_the_sum_and_the_mean_direction() {
        let level = 3;
        let count = cones(level);
        for cone in BEYOND..count - BEYOND {
            let mut merged = vec![0.0; count];
            merged[cone] = 1.0;
            halves(&mut merged);
            cones_of_halves(&mut merged);
            assert_eq!(merged.len(), cones(level - 1));
            assert_eq!([merged[0], merged[merged.len() - 1]], [0.0; 2]);
            assert!((merged.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let middle = |level, cone| 0.5 * (slope(level, cone) + slope(level, cone + 1));
            let mean: f64 = (0..merged.len()).map(|i| merged[i] * middle(level - 1, i)).sum();
            assert!((mean - middle(level, cone)).abs() < 1e-12, "cone {cone}: {mean}");
        }
    }

    #[test]
    fn a_footprint_is_the_cells_under_the_ray_in_order() {
        for (slabs, slope, offset) in
            [(1, 0.0, 0.0), (3, 0.31, 0.0), (8, -0.97, 0.44), (8, 0.999, -0.49), (5, -0.125, 0.061)]
        {
            let crossings = footprint(slabs, slope, offset);
            let stretch = slope.hypot(1.0);
            let mut along = 0.0;
            for crossing in &crossings {
                let length = f64::from(crossing.length);
                let middle = (along + 0.5 * length) / stretch;
                along += length;
                assert_eq!((middle + 0.5).floor() as usize, crossing.slab);
                assert_eq!((offset + slope * middle + 0.5).floor() as isize, crossing.row);
            }
            assert!((along - slabs as f64 * stretch).abs() < 1e-5, "{along} px of {slabs}");
            assert_eq!(crossings[0].face, Face::Front);
            for pair in crossings.windows(2) {
                let step = (pair[1].slab - pair[0].slab, pair[1].row - pair[0].row);
                let face = match step {
                    (1, 0) => Face::Front,
                    (0, 1) => Face::Low,
                    (0, -1) => Face::High,
                    _ => panic!("a ray jumps by {step:?}"),
                };
                assert_eq!(pair[1].face, face);
            }
        }
    }
}
