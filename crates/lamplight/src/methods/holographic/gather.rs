//! The final gather: from pixels to the plane ahead, exactly.
//!
//! Next to small lights the lattice of planes and rays is too coarse, and its steps would show as
//! stars and crosses. So merging stops at level m, and every pixel gathers from the next plane
//! itself: through each cone it sends a ray, traced exactly over the L px to the plane, and adds
//! `A·r + t·R_m(X, y + L·slope)`, with R_m a quadratic B-spline over three rows.
//!
//! If one of these rows is in matter and the ray is not, its light is the outgoing radiance of the
//! matter, which would look up to a px too wide. So rows count by the transmittance of their cells.

use super::interval::{LANES, RowIntervals};
use super::lattice::{ConeRays, GatherGeometry, GatherRay, cones};
use super::merge::{ConeLight, MergedLight, WEIGHT_EPSILON};
use super::row_bits::{TILE, VECTORS, any_in_vector, bit, mask, whole_vectors};
use super::slabs::Slabs;
use super::trace::{
    BundleRays, BundleSet, CellBits, CellStep, SolidRays, Tile, TileClasses, TileLight,
    VectorClasses, classes_at, classes_of, march, march_solid, read_cells,
};
use fearless_simd::{f32x16, prelude::*, u8x64};
use std::ops::Range;

/// The end of a ray on the plane.
#[derive(Clone, Copy, Debug)]
struct RayEnd {
    /// Rows from the start to the row nearest to the end.
    row: isize,
    /// Weights of the rows before, at and after it in the light there.
    weights: [f32; 3],
    /// Index of the first of their cells in [`BundleSet::cells`]; the others follow.
    cell: usize,
}

impl RayEnd {
    /// Returns, for the 64 rows from `first` on, the bits of those from which the ray ends beyond the
    /// grid's edge, but next to a row of the grid: the row after, and the row before its end. Such a ray
    /// has left the grid, perhaps over the end of a wall, and must not re-enter.
    #[inline(always)]
    fn at_edges(&self, rows: usize, first: usize) -> RowsAtEdges {
        RowsAtEdges {
            before: bit(rows as isize - self.row - first as isize),
            after: bit(-1 - self.row - first as isize),
        }
    }
}

/// Bit masks of pixels whose ray must not take light from one of the rows at its end.
#[derive(Clone, Copy)]
struct RowsAtEdges {
    before: u64,
    after: u64,
}

/// A cone of the final gather.
#[derive(Debug)]
pub struct GatherCone {
    number: usize,
    /// Angle, radians.
    pub angle: f32,
    /// Cosines between its middle and the axis, and the direction of higher rows.
    pub cosines: [f32; 2],
    /// Their differences from those of the next cone, or from 0 after the last: light through all cones up to
    /// each, times these, adds up to the first moment.
    turns: [f32; 2],
    /// Several rays replace that along its middle wherever there is matter, and not only where something emits light.
    splits_at_matter: bool,
    /// The ends of its rays: first that along the middle, then those that replace it.
    ends: Vec<RayEnd>,
}

impl GatherCone {
    /// Returns the rays to send: that along the middle, or those that replace it.
    #[inline(always)]
    fn rays(&self, several: bool) -> Range<usize> {
        if several { 1..self.ends.len() } else { 0..1 }
    }
}

/// The cones of pixels at one distance from the plane.
#[derive(Debug, Default)]
struct GatherTable {
    cones: Vec<GatherCone>,
    /// A bundle per cone, with the cells of the plane that rays take light from.
    bundles: BundleSet,
    /// Rows to either side that rays cross or take light from.
    reach: usize,
}

impl GatherTable {
    /// Makes the table of pixels `distance` slabs before a plane, for slabs that are `stride` apart.
    fn new(geometry: GatherGeometry, distance: usize, stride: isize) -> Self {
        let cones = geometry.cones(distance);
        let end_offset = |ray: &GatherRay| distance as isize * stride + ray.row - 1;
        let rays = |cone: &ConeRays| BundleRays {
            footprints: cone.rays.iter().map(|ray| ray.crossings.clone()).collect(),
            others: cone
                .rays
                .iter()
                .flat_map(|ray| (0..3).map(move |row| end_offset(ray) + row))
                .collect(),
        };
        let bundles = BundleSet::new(&cones.iter().map(rays).collect::<Vec<_>>(), stride);
        let end = |ray: &GatherRay| RayEnd {
            row: ray.row,
            weights: ray.weights(),
            cell: bundles.index(end_offset(ray)),
        };
        let cone = |(i, cone): (usize, &ConeRays)| {
            let next = cones.get(i + 1).map_or([0.0; 2], |next| next.cosines);
            GatherCone {
                number: cone.number,
                angle: cone.angle,
                cosines: cone.cosines,
                splits_at_matter: cone.splits_at_matter,
                turns: [0, 1].map(|a| cone.cosines[a] - next[a]),
                ends: cone.rays.iter().map(end).collect(),
            }
        };
        // A ray takes light from the rows beside its end too.
        let rows = cones.iter().flat_map(|cone| &cone.rays).map(|ray| ray.row.unsigned_abs() + 1);
        let reach = rows.max().unwrap_or(0);
        Self { cones: cones.iter().enumerate().map(cone).collect(), bundles, reach }
    }
}

/// The pixels of a gather: 64 rows of a slab.
#[derive(Clone, Copy)]
pub struct GatherTile {
    pub slab: usize,
    pub row: usize,
    /// The plane to gather from.
    pub plane: usize,
    /// Bit masks of the pixels to light, and of those with irradiance on faces to find
    /// ([`FinalGather::sums`]).
    pub lit: u64,
    pub faces: u64,
}

/// The rays of pixels, for every distance to the plane.
#[derive(Debug, Default)]
pub struct FinalGather {
    geometry: GatherGeometry,
    stride: isize,
    /// For slabs in order and in reverse, by distance from the minimum on.
    tables: [Vec<GatherTable>; 2],
    /// The cells that the rays of a tile cross.
    cells: Vec<CellBits>,
    /// Light of a tile through all cones up to one, cone by cone, by channel.
    sums: Vec<[[f32; TILE]; 3]>,
}

impl FinalGather {
    /// Prepares the rays for both orders of the slabs.
    pub fn prepare(&mut self, slabs: &Slabs, geometry: GatherGeometry) {
        let stride = slabs.stride as isize;
        if (self.geometry, self.stride) != (geometry, stride) {
            (self.geometry, self.stride) = (geometry, stride);
            self.tables = [stride, -stride].map(|stride| {
                (geometry.min_length..=geometry.max_length())
                    .map(|distance| GatherTable::new(geometry, distance, stride))
                    .collect()
            });
            let cells = self.tables.iter().flatten().map(|table| table.bundles.cells.len());
            self.cells.resize(cells.max().unwrap_or(0), CellBits::default());
            self.sums.resize(cones(geometry.first() + 1), [[0.0; TILE]; 3]);
        }
    }

    /// Returns ∫ L dω of 64 pixels over the quadrant. Adds ∫ L ω dω to `moment`, along the axis and across it.
    #[inline(always)]
    pub fn light<S: Simd, const K: usize>(
        &mut self,
        simd: S,
        slabs: &Slabs,
        plane_light: &MergedLight,
        pixels: GatherTile,
        mut moment: Option<&mut [TileLight<S>; 2]>,
    ) -> TileLight<S> {
        let GatherTile { slab, row, plane, lit, faces } = pixels;
        let mut sum = [[f32x16::splat(simd, 0.0); VECTORS]; 3];
        let distance = (plane << self.geometry.level) - slab;
        let start = slabs.start(slab) + row;
        let GatherTable { cones, bundles, reach } =
            &self.tables[slabs.reversed as usize][distance - self.geometry.min_length];
        let near = classes_ahead(simd, slabs, start, [distance, *reach]);
        let cells = &mut self.cells[..bundles.cells.len()];
        // Far from the edges no ray leaves the grid.
        let inside = row >= *reach && row + TILE + reach <= slabs.rows;
        if near.matter == 0 && !inside {
            cells.fill(CellBits::default());
        } else if near.matter != 0 && near.medium == 0 {
            read_cells(simd, &slabs.classes, start, &bundles.cells, cells);
        }
        let tile = Tile { row, start, cells };
        let pad = plane_light.pad();
        for (i, (cone, sums)) in cones.iter().zip(&mut self.sums).enumerate() {
            let bundle = &bundles.bundles[i];
            let far = plane_light.cone(cone.number);
            let [middle, ..] = &cone.ends[..] else { continue };
            let crossed = match (near.matter, near.medium) {
                (0, _) => TileClasses::EMPTY,
                (_, 0) => classes_of(tile.cells, &bundle.cells),
                _ => classes_at(simd, &slabs.classes, start, bundles.offsets(i)),
            };
            let RowsAtEdges { before, after } = middle.at_edges(slabs.rows, row);
            let at_edge = if inside { 0 } else { before | after };
            let busy = whole_vectors(crossed.matter & lit | at_edge);
            let at = (pad + row).wrapping_add_signed(middle.row);
            far.add(simd, at, &middle.weights, !busy, &mut sum);
            // Decided per pixel, so that the light of one does not depend on its neighbours.
            let busy = busy & lit;
            let several = if cone.splits_at_matter { crossed.matter } else { crossed.primary };
            let groups = [(false, busy & !several), (true, busy & several)];
            for (several, lit) in groups.into_iter().filter(|(_, lit)| *lit != 0) {
                let rays = cone.rays(several);
                let weight = 1.0 / rays.len() as f32;
                let angle = cone.angle;
                for (end, steps) in cone.ends[rays.clone()].iter().zip(&bundle.rays[rays]) {
                    let behind = Behind { end, weight, angle, pad, light: &far };
                    if near.medium == 0 {
                        let finds_light = crossed.emissive & lit != 0;
                        let weight = finds_light.then_some(weight * angle);
                        let rays = SolidRays { open: lit, weight };
                        gather_solid(simd, slabs, tile, &steps[1..], rays, behind, &mut sum);
                        continue;
                    }
                    for v in (0..VECTORS).filter(|v| any_in_vector(lit, v * LANES)) {
                        let first = v * LANES;
                        let classes = crossed.of_vector(first).unwrap_or(VectorClasses::NONE);
                        let near = march::<S, K>(simd, slabs, start + first, steps, classes);
                        let offset = bundles.cells[end.cell];
                        let one = gather_medium(simd, slabs, tile, v, near, offset, behind);
                        let weight = mask(simd, lit, v)
                            .select(f32x16::splat(simd, weight), f32x16::splat(simd, 0.0));
                        for c in 0..3 {
                            sum[c][v] = one[c].mul_add(weight, sum[c][v]);
                        }
                    }
                }
            }
            for v in (0..VECTORS).filter(|v| any_in_vector(faces, v * LANES)) {
                for c in 0..3 {
                    sum[c][v].store_slice(&mut sums[c][v * LANES..][..LANES]);
                }
            }
            if let Some(moment) = &mut moment {
                for (moment, turn) in moment.iter_mut().zip(cone.turns) {
                    for c in 0..3 {
                        for v in 0..VECTORS {
                            moment[c][v] = sum[c][v].mul_add(turn, moment[c][v]);
                        }
                    }
                }
            }
        }
        sum
    }

    /// Returns the cones of the tile that [`Self::light`] lit last, each with the light of its pixels
    /// through all cones up to that one. Their angles are the same at any distance.
    pub fn sums(&self) -> impl Iterator<Item = (&GatherCone, &[[f32; TILE]; 3])> {
        self.tables[0][0].cones.iter().zip(&self.sums)
    }
}

/// The light behind a ray, on the plane.
#[derive(Clone, Copy)]
struct Behind<'a> {
    end: &'a RayEnd,
    /// Weight of the ray's light.
    weight: f32,
    /// Angle of its cone.
    angle: f32,
    /// Rows of `light` before those of the grid.
    pad: usize,
    light: &'a ConeLight<'a>,
}

/// Adds the light along a ray of a tile through solids.
#[inline(always)]
fn gather_solid<S: Simd>(
    simd: S,
    slabs: &Slabs,
    tile: Tile,
    steps: &[CellStep],
    rays: SolidRays,
    behind: Behind,
    light: &mut TileLight<S>,
) {
    let open = march_solid(simd, slabs, tile, steps, rays, light);
    if open == 0 {
        return;
    }
    let Behind { end, weight, pad, light: far, .. } = behind;
    let at_edges = end.at_edges(slabs.rows, tile.row);
    let [before, own, after] = [0, 1, 2].map(|row| open & !tile.cells[end.cell + row].solid);
    let rows = [before & !at_edges.before, own, after & !at_edges.after];
    let at = (pad + tile.row).wrapping_add_signed(end.row);
    far.add_open(simd, at, &end.weights, rows, weight, light);
}

/// Returns the light along a ray from the sixteen pixels of a vector, as if the ray filled its cone.
/// `near` are its intervals, `offset` that of the cell at its end.
#[inline(always)]
fn gather_medium<S: Simd, const K: usize>(
    simd: S,
    slabs: &Slabs,
    tile: Tile,
    vector: usize,
    near: RowIntervals<S, K>,
    offset: isize,
    behind: Behind,
) -> [f32x16<S>; 3] {
    let zero = f32x16::splat(simd, 0.0);
    let Behind { end, angle, pad, light: far, .. } = behind;
    let first = vector * LANES;
    let transmittance = &slabs.transmittance[0][(tile.start + first).wrapping_add_signed(offset)..];
    let at = (pad + tile.row + first).wrapping_add_signed(end.row);
    let at_edges = end.at_edges(slabs.rows, tile.row);
    let dropped = [at_edges.before, 0, at_edges.after];
    let (mut sum, mut far_light) = (f32x16::splat(simd, WEIGHT_EPSILON), [zero; 3]);
    for (i, &weight) in end.weights.iter().enumerate() {
        let mut weight = f32x16::from_slice(simd, &transmittance[i..][..LANES]) * weight;
        if any_in_vector(dropped[i], first) {
            weight = mask(simd, dropped[i], vector).select(zero, weight);
        }
        let light = far.load(simd, at + i - 1);
        for c in 0..3 {
            far_light[c] = weight.mul_add(light[c], far_light[c]);
        }
        sum += weight;
    }
    let norm = f32x16::splat(simd, 1.0) / sum;
    let mut light = near.light;
    for c in 0..3 {
        let far = near.transmittance[c % K] * (far_light[c] * norm);
        light[c] = near.light[c].mul_add(angle, far);
    }
    light
}

/// Returns a superset of the classes between 64 pixels and the plane, `distance` slabs ahead and up to `reach` rows aside:
/// which of the pixels they belong to is not resolved.
#[inline(always)]
fn classes_ahead<S: Simd>(
    simd: S,
    slabs: &Slabs,
    start: usize,
    [distance, reach]: [usize; 2],
) -> TileClasses {
    let mut bits = u8x64::splat(simd, 0);
    for slab in 0..=distance {
        let start = start.wrapping_add_signed(slab as isize * slabs.step());
        // Two words of a tile cover all rows, of which there are at most 31 to either side ([`super::lattice`]).
        let around = &slabs.classes[start - reach..start + TILE + reach];
        bits |= u8x64::from_slice(simd, &around[..TILE]);
        bits |= u8x64::from_slice(simd, &around[around.len() - TILE..]);
    }
    TileClasses::from_bits(bits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Holographic;
    use crate::{Cells, Matter, Settings, Solver};

    /// The light of a room above a wall that is one row thick, with light below. The room's last rows belong to a tile that
    /// ends at most 32 rows above the wall.
    fn light_above(method: &Holographic, wall: u32) -> f32 {
        let mut cells = Cells::new(16, 4 * TILE as u32).unwrap();
        let solid = Matter { opacity: 1.0, ..Matter::default() };
        for x in 0..cells.width() {
            cells.set(x, wall, solid);
            cells.set(x, wall + 4, Matter { emission: [1.0; 3], ..solid });
        }
        let mut solver = Solver::new(Settings::direct(method.clone())).unwrap();
        let light = solver.solve(&cells).unwrap();
        let room = (0..wall).flat_map(|y| (0..16).map(move |x| [x, y]));
        room.map(|[x, y]| light.at(x, y)[0]).fold(0.0, f32::max)
    }

    #[test]
    fn pixels_do_not_see_through_a_wall_beyond_their_tile() {
        for lattice_spacing in [1, 2, 4] {
            for gather_level in 1..=4 {
                let method =
                    Holographic { lattice_spacing, gather_level, ..Holographic::default() };
                for wall in 2 * TILE as u32..2 * TILE as u32 + 32 {
                    let light = light_above(&method, wall);
                    assert_eq!(light, 0.0, "{lattice_spacing}, {gather_level}, wall at {wall}");
                }
            }
        }
    }
}
