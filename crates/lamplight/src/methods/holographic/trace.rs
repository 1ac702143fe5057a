//! Exact intervals: rays of one direction from neighbouring rows, through the cells that they cross.
//!
//! Sixteen at once, as vectors of transmittance, through participating media. Through solids, which
//! either pass or end a ray, 64 at once, one bit per ray.

use super::interval::{LANES, PAD, RowIntervals, words};
use super::lattice::{Crossing, Face};
use super::point_rows::{PointRows, RowSums};
use super::row_bits::{TILE, VECTORS, any_in_vector, mask, whole_vectors};
use super::slabs::{EMISSIVE, MEDIUM, PRIMARY, SMALL, SOLID_EXTINCTION, Slabs};
use crate::math::transmittance::attenuation_lanes;
use fearless_simd::{f32x16, prelude::*, u8x64};

/// Light of a tile by channel.
pub type TileLight<S> = [[f32x16<S>; VECTORS]; 3];

/// A cell that a ray crosses, with its offset for slabs of a known stride.
#[derive(Clone, Copy, Debug)]
pub struct CellStep {
    /// Offset from the cell in which the ray starts.
    pub offset: isize,
    /// Index of the cell in [`BundleSet::cells`].
    pub cell: usize,
    /// Length of the ray within the cell, px.
    pub length: f32,
    /// The face by which the ray enters.
    pub face: Face,
}

/// The rays of a bundle to be made.
pub struct BundleRays {
    pub footprints: Vec<Vec<Crossing>>,
    /// Offsets of other cells whose class matters.
    pub others: Vec<isize>,
}

/// Rays that are traced together.
#[derive(Debug)]
pub struct Bundle {
    pub rays: Vec<Vec<CellStep>>,
    /// Indices in [`BundleSet::cells`] of the cells that they cross.
    pub cells: Vec<usize>,
}

/// Bundles of rays that start from the same cell.
#[derive(Debug, Default)]
pub struct BundleSet {
    pub bundles: Vec<Bundle>,
    /// Offsets from the start of all cells that any of them crosses, in ascending order.
    pub cells: Vec<isize>,
}

impl BundleSet {
    /// Makes bundles for slabs that are `stride` cells apart.
    pub fn new(bundles: &[BundleRays], stride: isize) -> Self {
        let offsets = |rays: &BundleRays| -> Vec<isize> {
            let crossed = rays.footprints.iter().flatten().map(|crossing| crossing.offset(stride));
            crossed.chain(rays.others.iter().copied()).collect()
        };
        let mut set = Self { bundles: Vec::new(), cells: sorted(bundles.iter().flat_map(offsets)) };
        let step = |crossing: &Crossing| {
            let offset = crossing.offset(stride);
            let cell = set.index(offset);
            CellStep { offset, cell, length: crossing.length, face: crossing.face }
        };
        let bundle = |rays: &BundleRays| Bundle {
            rays: rays.footprints.iter().map(|ray| ray.iter().map(step).collect()).collect(),
            cells: sorted(offsets(rays).into_iter().map(|offset| set.index(offset))),
        };
        set.bundles = bundles.iter().map(bundle).collect();
        set
    }

    /// Returns the index of the cell at an offset.
    pub fn index(&self, offset: isize) -> usize {
        self.cells.partition_point(|&cell| cell < offset)
    }

    /// Returns the offsets of the cells of a bundle.
    pub fn offsets(&self, bundle: usize) -> impl Iterator<Item = isize> {
        self.bundles[bundle].cells.iter().map(|&cell| self.cells[cell])
    }
}

/// Returns the values in order, each once.
fn sorted<T: Ord>(values: impl Iterator<Item = T>) -> Vec<T> {
    let mut values: Vec<T> = values.collect();
    values.sort_unstable();
    values.dedup();
    values
}

/// Bit masks over the 64 rows of a tile for one of the cells that its rays cross.
#[derive(Clone, Copy, Debug, Default)]
pub struct CellBits {
    /// Rows in which the cell is solid.
    pub solid: u64,
    /// Rows in which it has outgoing radiance.
    pub emissive: u64,
    /// Rows in which it emits light of its own.
    pub primary: u64,
}

/// 64 rows of a slab from which rays start.
#[derive(Clone, Copy)]
pub struct Tile<'a> {
    /// The first row.
    pub row: usize,
    /// Its place in [`Slabs`].
    pub start: usize,
    /// The cells that rays cross ([`read_cells`]). Read only if all matter there is solid.
    pub cells: &'a [CellBits],
}

/// Rays of a tile through solids.
#[derive(Clone, Copy)]
pub struct SolidRays {
    /// Bit mask of the rays that have met nothing so far.
    pub open: u64,
    /// Weight of the light that rays find; none if they cross nothing with outgoing radiance.
    pub weight: Option<f32>,
}

/// The stored intervals of one ray: all rows.
struct StoredRay<'a> {
    words: &'a mut [u32],
    /// From one word of an interval to the next.
    stride: usize,
    /// The number of rows that share a point, and the bit mask of those from which light counts, if several do.
    shared: Option<(usize, u64)>,
}

/// The output of tracing a tile.
pub struct TracedPlane<'a> {
    /// The intervals of a plane, bundle by bundle.
    pub intervals: &'a mut [u32],
    /// From one word of an interval to the next.
    pub stride: usize,
    /// A bit mask per bundle: the rows from which it may meet a small source, in tiles of points.
    pub small: &'a mut [u64],
    /// The level that is traced, and `2^level` px from point to point.
    pub levels: [u32; 2],
}

/// Traces the bundles of a level from 64 rows of a slab. `cells` is scratch space for one entry per cell of the
/// bundles.
#[inline(always)]
pub fn trace_tile<S: Simd, const K: usize>(
    simd: S,
    slabs: &Slabs,
    [slab, row]: [usize; 2],
    set: &BundleSet,
    cells: &mut [CellBits],
    to: TracedPlane,
) {
    let TracedPlane { intervals, stride, small, levels } = to;
    let start = slabs.start(slab) + row;
    let near = classes_at(simd, &slabs.classes, start, set.cells.iter().copied());
    if near.matter != 0 {
        read_cells(simd, &slabs.classes, start, &set.cells, cells);
    }
    let tile = Tile { row, start, cells };
    let is_shared = levels[1] > 0;
    let shared = is_shared.then(|| PointRows::new(slabs, [slab, row], levels, near.matter == 0));
    for (i, words) in intervals.chunks_exact_mut(words(K) * stride).enumerate() {
        let bundle = &set.bundles[i];
        let crossed = match (near.matter, near.medium) {
            (0, _) => TileClasses::EMPTY,
            (_, 0) => classes_of(tile.cells, &bundle.cells),
            _ => classes_at(simd, &slabs.classes, start, set.offsets(i)),
        };
        if near.small != 0 {
            let bits = classes_at(simd, &slabs.classes, start, set.offsets(i)).small;
            small[i] |= match &shared {
                None => bits,
                Some(shared) => shared.any(bits) << (row / shared.count() % TILE),
            };
        }
        let shared = shared.map(|shared| (shared.count(), shared.of_ray(i)));
        let to = StoredRay { words, stride, shared };
        trace_bundle::<S, K>(simd, slabs, tile, bundle, crossed, to);
    }
}

/// Traces a bundle: the mean over its rays.
#[inline(always)]
fn trace_bundle<S: Simd, const K: usize>(
    simd: S,
    slabs: &Slabs,
    tile: Tile,
    bundle: &Bundle,
    crossed: TileClasses,
    to: StoredRay,
) {
    let weight = 1.0 / bundle.rays.len() as f32;
    let zero = f32x16::splat(simd, 0.0);
    let mut light = [[zero; VECTORS]; 3];
    let mut transmittance = [[zero; VECTORS]; K];
    if crossed.medium == 0 && crossed.matter != 0 {
        let rays = SolidRays {
            open: whole_vectors(crossed.matter),
            weight: (crossed.emissive != 0).then_some(weight),
        };
        for steps in &bundle.rays {
            let open = march_solid(simd, slabs, tile, steps, rays, &mut light);
            for v in 0..VECTORS {
                let past = mask(simd, open, v).select(f32x16::splat(simd, weight), zero);
                for k in 0..K {
                    transmittance[k][v] += past;
                }
            }
        }
    }
    // Those of the vectors before that share points with it.
    let mut sums = [RowSums::<S, K>::none(simd); 2];
    let per_point = to.shared.map_or(1, |(count, _)| count);
    for v in 0..VECTORS.min((slabs.rows - tile.row).next_multiple_of(per_point * LANES) / LANES) {
        let first = v * LANES;
        let mut intervals = RowIntervals::<S, K>::empty(simd);
        if let Some(classes) = crossed.of_vector(first) {
            for k in 0..K {
                intervals.transmittance[k] = transmittance[k][v];
            }
            for c in 0..3 {
                intervals.light[c] = light[c][v];
            }
            if crossed.medium != 0 {
                for steps in &bundle.rays {
                    let one = march::<S, K>(simd, slabs, tile.start + first, steps, classes);
                    for c in 0..3 {
                        intervals.light[c] = one.light[c].mul_add(weight, intervals.light[c]);
                    }
                    for k in 0..K {
                        intervals.transmittance[k] =
                            one.transmittance[k].mul_add(weight, intervals.transmittance[k]);
                    }
                }
            }
        }
        let Some((count, rows)) = to.shared else {
            intervals.store(to.words, to.stride, PAD + tile.row + first);
            continue;
        };
        let mut sum = RowSums::of(simd, intervals, rows, v);
        // Two vectors of rows become one, and two of these again if four rows share a point.
        let mut level = 0;
        while v >> level & 1 == 1 && 2 << level <= count {
            sum = sums[level].halved(sum);
            level += 1;
        }
        if 1 << level < count {
            sums[level] = sum;
        } else {
            let at = (tile.row + first + LANES) / count - LANES;
            sum.mean(simd).store(to.words, to.stride, PAD + at);
        }
    }
}

/// Returns the intervals of a ray from sixteen cells of a slab, which crosses only matter of `classes`.
#[inline(always)]
pub fn march<S: Simd, const K: usize>(
    simd: S,
    slabs: &Slabs,
    start: usize,
    steps: &[CellStep],
    classes: VectorClasses,
) -> RowIntervals<S, K> {
    let mut passed = RowIntervals::<S, K>::empty(simd);
    for step in steps {
        let at = start.wrapping_add_signed(step.offset);
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        let (mut transmittance, mut absorptance) = ([one; K], [one; K]);
        for k in 0..K {
            if classes.medium {
                let extinction = load(simd, &slabs.extinction[k], at);
                let (t, absorbed) = attenuation_lanes(extinction * step.length);
                // Even the corner of a solid stops a ray, over a length of 0 px.
                let open = extinction.simd_lt(SOLID_EXTINCTION);
                (transmittance[k], absorptance[k]) =
                    (open.select(t, zero), open.select(absorbed, one));
            } else {
                transmittance[k] = load(simd, &slabs.transmittance[k], at);
            }
        }
        if classes.emissive {
            for c in 0..3 {
                let mut source = slabs.outgoing(simd, at, step.face, c);
                if classes.medium {
                    source *= absorptance[c % K];
                }
                passed.light[c] = passed.transmittance[c % K].mul_add(source, passed.light[c]);
            }
        }
        for k in 0..K {
            passed.transmittance[k] *= transmittance[k];
        }
    }
    passed
}

/// Traces rays of a tile through solids: adds the weighted light that they find, and returns the bit
/// mask of those that met nothing.
#[inline(always)]
pub fn march_solid<S: Simd>(
    simd: S,
    slabs: &Slabs,
    tile: Tile,
    steps: &[CellStep],
    rays: SolidRays,
    light: &mut TileLight<S>,
) -> u64 {
    let mut open = rays.open;
    for step in steps {
        let CellBits { solid, emissive, .. } = tile.cells[step.cell];
        let hit = open & emissive;
        open &= !solid;
        if hit == 0 {
            continue;
        }
        let Some(weight) = rays.weight else { continue };
        let at = tile.start.wrapping_add_signed(step.offset);
        for v in 0..VECTORS {
            if !any_in_vector(hit, v * LANES) {
                continue;
            }
            let hit = mask(simd, hit, v);
            for c in 0..3 {
                let source = slabs.outgoing(simd, at + v * LANES, step.face, c);
                light[c][v] = hit.select(source.mul_add(weight, light[c][v]), light[c][v]);
            }
        }
    }
    open
}

/// Reads the matter of the cells at these offsets from 64 rows, all of it solid.
#[inline(always)]
pub fn read_cells<S: Simd>(
    simd: S,
    classes: &[u8],
    start: usize,
    offsets: &[isize],
    cells: &mut [CellBits],
) {
    for (&offset, bits) in offsets.iter().zip(cells) {
        let at = start.wrapping_add_signed(offset);
        let classes = u8x64::from_slice(simd, &classes[at..at + TILE]);
        let [emissive, primary] =
            [EMISSIVE, PRIMARY].map(|class| (classes & class).simd_gt(0).to_bitmask());
        *bits = CellBits { solid: classes.simd_gt(0).to_bitmask(), emissive, primary };
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, from: &[f32], at: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &from[at..at + LANES])
}

/// Classes of the matter that sixteen rays cross.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VectorClasses {
    /// Some is a participating medium, in which lengths matter.
    pub medium: bool,
    /// Some has outgoing radiance.
    pub emissive: bool,
}

impl VectorClasses {
    /// Neither media nor outgoing radiance.
    pub const NONE: Self = Self { medium: false, emissive: false };
}

/// Classes of the matter that each of 64 rays crosses, as bit masks.
#[derive(Clone, Copy, Debug)]
pub struct TileClasses {
    pub matter: u64,
    pub medium: u64,
    pub emissive: u64,
    pub small: u64,
    pub primary: u64,
}

impl TileClasses {
    /// No matter.
    pub const EMPTY: Self = Self { matter: 0, medium: 0, emissive: 0, small: 0, primary: 0 };

    /// Returns the classes that sixteen rays cross, counted from ray `first`; none if they cross no
    /// matter.
    #[inline(always)]
    pub fn of_vector(&self, first: usize) -> Option<VectorClasses> {
        if !any_in_vector(self.matter, first) {
            return None;
        }
        Some(VectorClasses {
            medium: any_in_vector(self.medium, first),
            emissive: any_in_vector(self.emissive, first),
        })
    }

    /// Returns the masks of the class bits that 64 rays have collected.
    #[inline(always)]
    pub fn from_bits<S: Simd>(bits: u8x64<S>) -> Self {
        let matter = bits.simd_gt(0).to_bitmask();
        if matter == 0 {
            return Self::EMPTY;
        }
        let [medium, emissive, small, primary] =
            [MEDIUM, EMISSIVE, SMALL, PRIMARY].map(|class| (bits & class).simd_gt(0).to_bitmask());
        Self { matter, medium, emissive, small, primary }
    }
}

/// Returns the classes that 64 rays cross in the cells at these offsets.
#[inline(always)]
pub fn classes_at<S: Simd>(
    simd: S,
    classes: &[u8],
    start: usize,
    offsets: impl Iterator<Item = isize>,
) -> TileClasses {
    let mut bits = u8x64::splat(simd, 0);
    for offset in offsets {
        let at = start.wrapping_add_signed(offset);
        bits |= u8x64::from_slice(simd, &classes[at..at + TILE]);
    }
    TileClasses::from_bits(bits)
}

/// Returns the classes that 64 rays cross in some of the cells, if all matter is solid; not whether a source
/// is small.
#[inline(always)]
pub fn classes_of(cells: &[CellBits], crossed: &[usize]) -> TileClasses {
    let [mut matter, mut emissive, mut primary] = [0; 3];
    for &cell in crossed {
        matter |= cells[cell].solid;
        emissive |= cells[cell].emissive;
        primary |= cells[cell].primary;
    }
    TileClasses { matter, medium: 0, emissive, small: 0, primary }
}
