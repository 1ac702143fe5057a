//! The last hop: from pixels to the plane ahead, exactly.
//!
//! Next to small lights the lattice of planes and rays is too coarse, and its steps would show as
//! stars and crosses. So merging stops at level m, and every pixel looks to the next plane itself:
//! through each cone it sends a ray, traced exactly over the L = 1 … 2ᵐ px to the plane, and adds
//! `A·r + t·R_m(X, y + L·slope)`, R_m linear between the two rows.
//!
//! Where one of the rows is in matter and the ray is not, its light is that of the matter's own
//! surface and would make it look up to a px fatter, so rows count by what their cells let
//! through.

use super::cones::{Cones, Far, angle, slope};
use super::interval::LANES;
use super::march::{Kinds, Met, march, meet, of_vector};
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
    /// Rows from the start to the row before its end on the plane.
    row: isize,
    /// Shares of that row and of the next in the light there.
    shares: [f32; 2],
    /// Where that row's cell of the plane is.
    end: isize,
    steps: Vec<Step>,
}

impl Ray {
    /// The row from which the ray ends on the one side of the grid's edge and would take part of
    /// its light from the other, and which of its two shares that is: it has left the grid, perhaps
    /// over the end of a wall, and is not to come in again.
    #[inline(always)]
    fn strays(&self, rows: usize) -> (isize, usize) {
        match self.shares[1] < 0.5 {
            true => (-1 - self.row, 1),
            false => (rows as isize - 1 - self.row, 0),
        }
    }
}

/// A cone, as a pixel at a distance from the plane looks through it.
#[derive(Debug)]
struct Cone {
    number: usize,
    angle: f32,
    /// Cosines to the normals of the faces that it lights: ahead, towards higher rows.
    cosines: [f32; 2],
    /// The ray along its middle.
    middle: Ray,
    /// Several rays, for where something glows.
    fan: Vec<Ray>,
    /// The cells that any of them crosses, and those of the plane whose light it takes.
    cells: Vec<isize>,
}

/// How pixels look ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Look {
    /// Planes lie `2^level` px apart.
    pub level: u32,
    /// Px to the plane at least; at most `2^level − 1` more.
    pub least: usize,
    /// Rays through a cone in which something glows.
    pub rays: u32,
}

impl Look {
    /// Px to the plane at most.
    pub fn most(&self) -> usize {
        (1 << self.level) + self.least - 1
    }

    /// The slabs that look to a plane.
    pub fn slabs(&self, plane: usize, depth: usize) -> std::ops::Range<usize> {
        let at = plane << self.level;
        at.saturating_sub(self.most())..(at + 1).saturating_sub(self.least).min(depth)
    }

    /// The farthest plane that any slab looks to.
    pub fn last(&self, depth: usize) -> usize {
        (depth - 1 + self.most()) >> self.level
    }
}

/// The rays of a pixel for every distance to the plane.
#[derive(Debug, Default)]
pub struct Hop {
    look: Look,
    stride: isize,
    /// Ahead and, for reversed slabs, back; by px to the plane, less the least.
    cones: [Vec<Vec<Cone>>; 2],
}

/// Light on the tile's pixels, and on faces that look ahead, to higher rows and to lower rows.
pub type Tile<S> = [[[f32x16<S>; VECTORS]; 3]; 4];

impl Hop {
    /// Aims the rays both ways that the slabs may go.
    pub fn aim(&mut self, slabs: &Slabs, look: Look) {
        let stride = slabs.stride as isize;
        if (self.look, self.stride) != (look, stride) {
            (self.look, self.stride) = (look, stride);
            self.cones = [stride, -stride].map(|stride| {
                (look.least..=look.most()).map(|ahead| cones(look, ahead, stride)).collect()
            });
        }
    }

    /// Light of 64 pixels of a slab from the plane ahead. `lit`: bits of pixels that count;
    /// `faces`: of those whose faces count too.
    #[inline(always)]
    pub fn light<S: Simd, const K: usize>(
        &self,
        simd: S,
        slabs: &Slabs,
        light: &Cones,
        [slab, plane]: [usize; 2],
        row: usize,
        [lit, faces]: [u64; 2],
    ) -> Tile<S> {
        let zero = f32x16::splat(simd, 0.0);
        let mut tile = [[[zero; VECTORS]; 3]; 4];
        let ahead = (plane << self.look.level) - slab;
        let start = slabs.start(slab) + row;
        let empty = is_empty(simd, slabs, start, ahead);
        for cone in &self.cones[slabs.reversed as usize][ahead - self.look.least] {
            let far = light.at(cone.number);
            let middle = &cone.middle;
            let strays = middle.strays(slabs.rows).0 - row as isize;
            let at = (light.pad() + row).wrapping_add_signed(middle.row);
            let met =
                if empty { Met::NOTHING } else { meet(simd, &slabs.kinds, start, &cone.cells) };
            if (met.matter & lit) | faces == 0 && !(0..TILE as isize).contains(&strays) {
                far.add(simd, at, &middle.shares, &mut tile[0]);
                continue;
            }
            let pad = light.pad();
            let mut light = [[zero; VECTORS]; 3];
            far.add(simd, at, &middle.shares, &mut light);
            for v in 0..VECTORS {
                let first = v * LANES;
                let alone = (first..first + LANES).contains(&(strays as usize));
                let kinds = met.kinds(first).or(alone.then_some(Kinds::NONE));
                let Some(kinds) = kinds else { continue };
                let rays = match kinds.glowing {
                    true => &cone.fan,
                    false => std::slice::from_ref(&cone.middle),
                };
                let mut sum = [zero; 3];
                for ray in rays {
                    let from = [start + first, row + first, pad];
                    let one = look::<S, K>(simd, slabs, from, (ray, kinds, cone.angle), &far);
                    for c in 0..3 {
                        sum[c] += one[c];
                    }
                }
                let share = 1.0 / rays.len() as f32;
                for c in 0..3 {
                    light[c][v] = sum[c] * share;
                }
            }
            for c in 0..3 {
                for v in 0..VECTORS {
                    tile[0][c][v] += light[c][v];
                }
            }
            if faces != 0 {
                let [ahead, across] = cone.cosines;
                let side = if across > 0.0 { 2 } else { 3 };
                for v in (0..VECTORS).filter(|v| of_vector(faces, v * LANES)) {
                    for c in 0..3 {
                        tile[1][c][v] = light[c][v].mul_add(ahead, tile[1][c][v]);
                        tile[side][c][v] = light[c][v].mul_add(across.abs(), tile[side][c][v]);
                    }
                }
            }
        }
        tile
    }
}

/// Light along a ray from sixteen pixels, as if it filled its cone.
#[inline(always)]
fn look<S: Simd, const K: usize>(
    simd: S,
    slabs: &Slabs,
    [start, row, pad]: [usize; 3],
    (ray, kinds, angle): (&Ray, Kinds, f32),
    far: &Far,
) -> [f32x16<S>; 3] {
    let near = march::<S, K>(simd, slabs, start, &ray.steps, kinds);
    let pass = &slabs.pass[0][start.wrapping_add_signed(ray.end)..];
    let at = (pad + row).wrapping_add_signed(ray.row);
    let (strays, lost) = ray.strays(slabs.rows);
    let lane = (strays - row as isize) as usize;
    let (mut all, mut far_light) = (f32x16::splat(simd, CLOSED), [f32x16::splat(simd, 0.0); 3]);
    for (i, &share) in ray.shares.iter().enumerate() {
        let mut share = f32x16::from_slice(simd, &pass[i..][..LANES]) * share;
        if i == lost && lane < LANES {
            let mut shares = [0.0; LANES];
            share.store_slice(&mut shares);
            shares[lane] = 0.0;
            share = f32x16::from_slice(simd, &shares);
        }
        let light = far.load(simd, at + i);
        for c in 0..3 {
            far_light[c] = share.mul_add(light[c], far_light[c]);
        }
        all += share;
    }
    let share = f32x16::splat(simd, 1.0) / all;
    let mut light = near.light;
    for c in 0..3 {
        let far = near.through[c % K] * (far_light[c] * share);
        light[c] = near.light[c].mul_add(angle, far);
    }
    light
}

/// Whether 64 pixels have no matter between them and the plane.
#[inline(always)]
fn is_empty<S: Simd>(simd: S, slabs: &Slabs, start: usize, ahead: usize) -> bool {
    let mut met = u8x64::splat(simd, 0);
    for slab in 0..=ahead {
        let start = start.wrapping_add_signed(slab as isize * slabs.step());
        // Two words of a tile cover what rays of up to 31 px can stray to.
        let around = &slabs.kinds[start - ahead - 1..start + TILE + ahead + 1];
        met |= u8x64::from_slice(simd, &around[..TILE]);
        met |= u8x64::from_slice(simd, &around[around.len() - TILE..]);
    }
    met.simd_gt(0).to_bitmask() == 0
}

/// The cones of pixels `ahead` slabs before a plane, `stride` cells from one slab to the next.
fn cones(look: Look, ahead: usize, stride: isize) -> Vec<Cone> {
    let fine = look.level + 1;
    let cone = |number| {
        let from = slope(fine, number).atan();
        let angle = angle(fine, number);
        let ray = |share: f64| ray(ahead, (from + share * angle).tan(), stride);
        let count = look.rays;
        let fan: Vec<_> =
            (0..count).map(|i| ray((f64::from(i) + 0.5) / f64::from(count))).collect();
        let middle = ray(0.5);
        let rays = || fan.iter().chain([&middle]);
        let mut cells: Vec<_> = rays().flat_map(|ray| &ray.steps).map(|s| s.offset).collect();
        cells.extend(rays().flat_map(|ray| [ray.end, ray.end + 1]));
        cells.sort_unstable();
        cells.dedup();
        let theta = from + 0.5 * angle;
        let cosines = [theta.cos() as f32, theta.sin() as f32];
        Cone { number, angle: angle as f32, cosines, middle, fan, cells }
    };
    (0..2 << fine).map(cone).collect()
}

/// A ray from a pixel to the plane `ahead` slabs on.
fn ray(ahead: usize, slope: f64, stride: isize) -> Ray {
    let shift = slope * ahead as f64;
    let row = shift.floor();
    let past = (shift - row) as f32;
    Ray {
        row: row as isize,
        shares: [1.0 - past, past],
        end: ahead as isize * stride + row as isize,
        steps: stencil(ahead, slope, 0.0).iter().map(|c| c.place(stride)).collect(),
    }
}
