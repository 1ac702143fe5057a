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
use super::march::{cell, march, of_vector};
use super::slabs::Slabs;
use super::stencil::{Crossing, stencil};
use fearless_simd::{f32x16, prelude::*};

/// Rows that are looked at together: a word of bits.
pub const TILE: usize = 64;

/// Vectors in a tile.
const VECTORS: usize = TILE / LANES;

/// Share of light under which a cell counts as closed.
const CLOSED: f32 = 1e-6;

/// One ray of a pixel.
#[derive(Debug)]
struct Ray {
    cone: usize,
    /// Angle it stands for, and its share of the cone's light.
    angle: f32,
    share: f32,
    /// Slabs to the plane; rows from the start to the row before its end there; how far past it.
    ahead: usize,
    row: isize,
    past: f32,
    /// Cosines to the normals of the faces that it lights: ahead, towards higher rows.
    cosines: [f32; 2],
    crossings: Vec<Crossing>,
}

/// The rays of a pixel for every distance to the plane.
#[derive(Debug, Default)]
pub struct Hop {
    level: u32,
    count: u32,
    /// By slabs to the plane, less 1.
    rays: Vec<Vec<Ray>>,
}

/// Light on the tile's pixels, and on faces that look ahead, to higher rows and to lower rows.
pub type Tile<S> = [[[f32x16<S>; VECTORS]; 3]; 4];

impl Hop {
    /// Makes the rays: `count` a cone, over at most `2^level` px.
    pub fn prepare(&mut self, level: u32, count: u32) {
        if (self.level, self.count) != (level, count) {
            (self.level, self.count) = (level, count);
            self.rays = (1..=1 << level).map(|ahead| rays(level, count, ahead)).collect();
        }
    }

    /// Most rows that a ray strays.
    pub fn reach(level: u32) -> usize {
        (1 << level) + 1
    }

    /// Light of 64 pixels of a slab from the plane `ahead` slabs on. `lit`: bits of pixels; vectors
    /// without any are passed over. `faces`: bits of pixels whose faces count too.
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
        for ray in &self.rays[ahead - 1] {
            let far = cones.at(plane, ray.cone);
            let low_end = cell(slabs, slab, row, ray.ahead, ray.row);
            let [mut matter, mut fraction] = [0; 2];
            for crossing in &ray.crossings {
                let at = cell(slabs, slab, row, crossing.slab, crossing.row);
                let [m, f] = slabs.bits(at);
                matter |= m;
                fraction |= f;
            }
            matter |= slabs.bits(low_end)[0] | slabs.bits(low_end + 1)[0];
            let [ahead, across] = ray.cosines;
            let side = if across > 0.0 { 2 } else { 3 };
            let shares = [(1.0 - ray.past) * ray.share, ray.past * ray.share];
            for v in 0..VECTORS {
                let first = v * LANES;
                if !of_vector(lit, first) {
                    continue;
                }
                let at = (cones.pad() + row + first).wrapping_add_signed(ray.row);
                let (low, high) = (far.load(simd, at), far.load(simd, at + 1));
                let mut light = [zero; 3];
                if of_vector(matter, first) {
                    let fraction = of_vector(fraction, first);
                    let crossings = &ray.crossings;
                    let near = march::<S, K>(simd, slabs, slab, row + first, crossings, fraction);
                    let pass = &slabs.pass[0][low_end + first..];
                    let low_share = f32x16::from_slice(simd, &pass[..LANES]) * (1.0 - ray.past);
                    let high_share = f32x16::from_slice(simd, &pass[1..][..LANES]) * ray.past;
                    let share =
                        f32x16::splat(simd, ray.share) / (low_share + high_share).max(CLOSED);
                    for c in 0..3 {
                        let far = (low[c] * low_share + high[c] * high_share) * share;
                        light[c] = near.light[c] * ray.angle + near.through[c % K] * far;
                    }
                } else {
                    for c in 0..3 {
                        light[c] = low[c] * shares[0] + high[c] * shares[1];
                    }
                }
                for c in 0..3 {
                    tile[0][c][v] += light[c];
                }
                if of_vector(faces, first) {
                    for c in 0..3 {
                        tile[1][c][v] += light[c] * ahead;
                        tile[side][c][v] += light[c] * across.abs();
                    }
                }
            }
        }
        tile
    }
}

/// The rays to a plane `ahead` slabs on.
fn rays(level: u32, count: u32, ahead: usize) -> Vec<Ray> {
    let cones = 4 << level;
    let mut rays = Vec::new();
    for cone in 0..cones {
        let from = slope(level + 1, cone).atan();
        let angle = angle(level + 1, cone) / f64::from(count);
        for i in 0..count {
            let theta = from + (f64::from(i) + 0.5) * angle;
            let slope = theta.tan();
            let end = slope * ahead as f64;
            rays.push(Ray {
                cone,
                angle: angle as f32,
                share: 1.0 / count as f32,
                ahead,
                row: end.floor() as isize,
                past: (end - end.floor()) as f32,
                cosines: [theta.cos() as f32, theta.sin() as f32],
                crossings: stencil(ahead, slope, 0.0),
            });
        }
    }
    rays
}
