//! The last hop: from pixels to the plane ahead, exactly.
//!
//! Next to small lights the lattice of planes and rays is too coarse, and its steps would show as
//! stars and crosses. So merging stops at level m, and every pixel looks to the next plane itself:
//! through each cone it sends a ray, traced exactly over the L = 1 … 2ᵐ px to the plane, and adds
//! `A·r + t·R_m(X, y + L·slope)`, R_m linear between the two rows.
//!
//! Where one of those two rows is in matter and the ray is not, its light is that of the matter's
//! own surface and would make it look up to a px fatter, so rows count by what their cells let
//! through.

use super::cones::{Cones, angle, slope};
use super::interval::LANES;
use super::march::{march, meet, of_vector};
use super::slabs::Slabs;
use super::stencil::{Step, stencil};
use fearless_simd::{f32x16, prelude::*, u8x64};

/// Rows that are looked at together: a word of bits.
pub const TILE: usize = 64;

/// Vectors in a tile.
pub const VECTORS: usize = TILE / LANES;

/// Share of light under which a cell counts as closed.
const CLOSED: f32 = 1e-6;

/// One ray of a pixel.
#[derive(Debug)]
struct Ray {
    cone: usize,
    /// Angle it stands for, and its share of the cone's light.
    angle: f32,
    share: f32,
    /// Rows from the start to the row before its end on the plane; how far past it.
    row: isize,
    past: f32,
    /// Cosines to the normals of the faces that it lights: ahead, towards higher rows.
    cosines: [f32; 2],
    steps: Vec<Step>,
    /// The cells that it crosses and those whose light it takes; of the latter the lower one.
    cells: Vec<isize>,
    end: isize,
}

/// The rays of a pixel for every distance to the plane.
#[derive(Debug, Default)]
pub struct Hop {
    level: u32,
    made_for: (u32, u32, isize),
    /// By slabs to the plane, less 1.
    rays: Vec<Vec<Ray>>,
}

/// Light on the tile's pixels, and on faces that look ahead, to higher rows and to lower rows.
pub type Tile<S> = [[[f32x16<S>; VECTORS]; 3]; 4];

impl Hop {
    /// Aims the rays, `count` a cone over at most `2^level` px, the way that the slabs go.
    pub fn aim(&mut self, slabs: &Slabs, level: u32, count: u32) {
        let now = (level, count, slabs.step());
        if self.made_for != now {
            self.made_for = now;
            self.level = level;
            self.rays = (1..=1 << level).map(|ahead| rays(level, count, ahead, now.2)).collect();
        }
    }

    /// Most rows that a ray strays.
    pub fn reach(level: u32) -> usize {
        (1 << level) + 1
    }

    /// Light of 64 pixels of a slab from the plane ahead. `lit`: bits of pixels; vectors without
    /// any are passed over. `faces`: bits of pixels whose faces count too.
    #[inline(always)]
    pub fn light<S: Simd, const K: usize>(
        &self,
        simd: S,
        slabs: &Slabs,
        cones: &Cones,
        [slab, plane]: [usize; 2],
        row: usize,
        [lit, faces]: [u64; 2],
    ) -> Tile<S> {
        let zero = f32x16::splat(simd, 0.0);
        let mut tile = [[[zero; VECTORS]; 3]; 4];
        let ahead = (plane << self.level) - slab;
        let start = slabs.start(slab) + row;
        let empty = is_empty(simd, slabs, start, ahead);
        for ray in &self.rays[ahead - 1] {
            let far = cones.at(plane, ray.cone);
            let at = (cones.pad() + row).wrapping_add_signed(ray.row);
            let mut light = far.between(simd, at, ray.past, ray.share);
            if !empty {
                let met = meet(simd, &slabs.kinds, start, &ray.cells);
                for v in (0..VECTORS).filter(|_| met.matter & lit != 0) {
                    let first = v * LANES;
                    let Some(kinds) = met.kinds(first) else { continue };
                    let near = march::<S, K>(simd, slabs, start + first, &ray.steps, kinds);
                    let pass = &slabs.pass[0][start.wrapping_add_signed(ray.end) + first..];
                    let low_share = f32x16::from_slice(simd, &pass[..LANES]) * (1.0 - ray.past);
                    let high_share = f32x16::from_slice(simd, &pass[1..][..LANES]) * ray.past;
                    let share =
                        f32x16::splat(simd, ray.share) / (low_share + high_share).max(CLOSED);
                    let low = far.load(simd, at + first);
                    let high = far.load(simd, at + first + 1);
                    for c in 0..3 {
                        let far = (low[c] * low_share + high[c] * high_share) * share;
                        light[c][v] = near.light[c] * ray.angle + near.through[c % K] * far;
                    }
                }
            }
            for c in 0..3 {
                for v in 0..VECTORS {
                    tile[0][c][v] += light[c][v];
                }
            }
            if faces != 0 {
                let [ahead, across] = ray.cosines;
                let side = if across > 0.0 { 2 } else { 3 };
                for v in (0..VECTORS).filter(|v| of_vector(faces, v * LANES)) {
                    for c in 0..3 {
                        tile[1][c][v] += light[c][v] * ahead;
                        tile[side][c][v] += light[c][v] * across.abs();
                    }
                }
            }
        }
        tile
    }
}

/// Whether 64 pixels have no matter between them and the plane.
#[inline(always)]
fn is_empty<S: Simd>(simd: S, slabs: &Slabs, start: usize, ahead: usize) -> bool {
    let mut met = u8x64::splat(simd, 0);
    for slab in 0..=ahead {
        let start = start.wrapping_add_signed(slab as isize * slabs.step());
        let around = &slabs.kinds[start - ahead - 1..start + TILE + ahead + 1];
        met |= u8x64::from_slice(simd, &around[..TILE]);
        met |= u8x64::from_slice(simd, &around[around.len() - TILE..]);
    }
    met.simd_gt(0).to_bitmask() == 0
}

/// The rays to a plane `ahead` slabs on, `stride` cells from one slab to the next.
fn rays(level: u32, count: u32, ahead: usize, stride: isize) -> Vec<Ray> {
    let cones = 4 << level;
    let mut rays = Vec::new();
    for cone in 0..cones {
        let from = slope(level + 1, cone).atan();
        let angle = angle(level + 1, cone) / f64::from(count);
        for i in 0..count {
            let theta = from + (f64::from(i) + 0.5) * angle;
            let slope = theta.tan();
            let shift = slope * ahead as f64;
            let row = shift.floor() as isize;
            let end = ahead as isize * stride + row;
            let steps: Vec<_> =
                stencil(ahead, slope, 0.0).iter().map(|c| c.place(stride)).collect();
            let mut cells: Vec<_> = steps.iter().map(|step| step.offset).collect();
            cells.extend([end, end + 1]);
            cells.sort_unstable();
            cells.dedup();
            rays.push(Ray {
                cone,
                angle: angle as f32,
                share: 1.0 / count as f32,
                row,
                past: (shift - shift.floor()) as f32,
                cosines: [theta.cos() as f32, theta.sin() as f32],
                steps,
                cells,
                end,
            });
        }
    }
    rays
}
