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

use super::cones::{Cones, Far};
use super::interval::{Interval, LANES};
use super::march::{
    Kinds, Light, Met, TILE, VECTORS, kinds_of, march, march_solid, mask, meet, meet_solid,
    of_vector, solid, whole_vectors,
};
use super::slabs::Slabs;
use super::stencil::{Fan, Rays, Step};
use super::ways::{ConeWays, Look, Way};
use fearless_simd::{f32x16, prelude::*, u8x64};

/// Share of light under which a cell counts as closed.
pub const CLOSED: f32 = 1e-6;

/// Where one ray of a pixel ends.
#[derive(Clone, Copy, Debug)]
struct Ray {
    /// Rows from the start to the row before its end on the plane.
    row: isize,
    /// Shares of that row and of the next in the light there.
    shares: [f32; 2],
    /// Which of the view's cells is that row's on the plane; the next row's comes next.
    end: usize,
}

impl Ray {
    /// Of 64 rows that from which the ray ends on the one side of the grid's edge and would take
    /// part of its light from the other, as a bit, and which of its two shares that is: it has left
    /// the grid, perhaps over the end of a wall, and is not to come in again.
    #[inline(always)]
    fn strays(&self, rows: usize, first: usize) -> (u64, usize) {
        let (row, share) = match self.shares[1] < 0.5 {
            true => (-1 - self.row, 1),
            false => (rows as isize - 1 - self.row, 0),
        };
        match row - first as isize {
            row @ 0..64 => (1 << row, share),
            _ => (0, share),
        }
    }
}

/// A cone, as a pixel at a distance from the plane looks through it.
#[derive(Debug)]
pub struct Cone {
    number: usize,
    pub angle: f32,
    /// Cosines of its middle to the axis and to the direction of higher rows.
    pub cosines: [f32; 2],
    /// Where its rays end: first that along its middle, then several for where something glows.
    ends: Vec<Ray>,
}

/// The cones through which pixels at a distance from the plane look.
#[derive(Debug, Default)]
struct View {
    cones: Vec<Cone>,
    /// The ways of their rays, cone by cone, and the cells of the plane whose light they take.
    fan: Fan,
}

/// Which of the rays of a cone are sent: several where something glows, else one.
#[inline(always)]
fn sent(glowing: bool, cone: &Cone) -> std::ops::Range<usize> {
    if glowing { 1..cone.ends.len() } else { 0..1 }
}

/// The rays of a pixel for every distance to the plane.
#[derive(Debug, Default)]
pub struct Hop {
    look: Look,
    stride: isize,
    /// Ahead and, for reversed slabs, back; by px to the plane, less the least.
    views: [Vec<View>; 2],
    /// Where the cells of a view are solid, and glow.
    solid: Vec<[u64; 2]>,
    /// Light of a tile through all cones up to one, cone by cone, by channel.
    sums: Vec<[[f32; TILE]; 3]>,
}

impl Hop {
    /// Aims the rays both ways that the slabs may go.
    pub fn aim(&mut self, slabs: &Slabs, look: Look) {
        let stride = slabs.stride as isize;
        if (self.look, self.stride) != (look, stride) {
            (self.look, self.stride) = (look, stride);
            self.views = [stride, -stride].map(|stride| {
                (look.least..=look.most()).map(|ahead| view(look, ahead, stride)).collect()
            });
            let cells = self.views.iter().flatten().map(|view| view.fan.cells.len());
            self.solid.resize(cells.max().unwrap_or(0), [0; 2]);
            self.sums.resize(4 << look.level, [[0.0; TILE]; 3]);
        }
    }

    /// Light of 64 pixels of a slab from the plane ahead. `lit`: bits of pixels that count;
    /// `faces`: of those whose faces count too ([`Self::sums`]).
    #[inline(always)]
    pub fn light<S: Simd, const K: usize>(
        &mut self,
        simd: S,
        slabs: &Slabs,
        light: &Cones,
        [slab, plane]: [usize; 2],
        row: usize,
        [lit, faces]: [u64; 2],
    ) -> Light<S> {
        let mut sum = [[f32x16::splat(simd, 0.0); VECTORS]; 3];
        let ahead = (plane << self.look.level) - slab;
        let start = slabs.start(slab) + row;
        let near = near(simd, slabs, start, ahead);
        let View { cones, fan } = &self.views[slabs.reversed as usize][ahead - self.look.least];
        let bits = &mut self.solid[..fan.cells.len()];
        // Far from the edges no ray strays.
        let reach = self.look.most() + 2;
        let inside = row >= reach && row + TILE + reach <= slabs.rows;
        if near.matter == 0 && !inside {
            bits.fill([0; 2]);
        } else if near.matter != 0 && near.fraction == 0 {
            solid(simd, &slabs.kinds, start, &fan.cells, bits);
        }
        for (i, (cone, sums)) in cones.iter().zip(&mut self.sums).enumerate() {
            let bundle = &fan.bundles[i];
            let far = light.at(cone.number);
            let [middle, ..] = &cone.ends[..] else { continue };
            let met = match (near.matter, near.fraction) {
                (0, _) => Met::NOTHING,
                (_, 0) => meet_solid(bits, &bundle.cells),
                _ => meet(simd, &slabs.kinds, start, fan.offsets(i)),
            };
            let strays = if inside { 0 } else { middle.strays(slabs.rows, row).0 };
            let busy = whole_vectors(met.matter & lit | strays);
            let at = (light.pad() + row).wrapping_add_signed(middle.row);
            far.add(simd, at, &middle.shares, !busy, &mut sum);
            // Pixel by pixel, so that the light of one does not depend on what its neighbours see.
            let looks = [(false, busy & lit & !met.glowing), (true, busy & lit & met.glowing)];
            for (glowing, lit) in looks.into_iter().filter(|(_, lit)| *lit != 0) {
                let sent = sent(glowing, cone);
                let share = 1.0 / sent.len() as f32;
                for (end, steps) in cone.ends[sent.clone()].iter().zip(&bundle.rays[sent]) {
                    if near.fraction == 0 {
                        let source = glowing.then_some(share * cone.angle);
                        let from = ([start, row, light.pad()], &bits[..]);
                        let ray = (end, &steps[1..], lit);
                        look_solid(simd, slabs, from, ray, (source, share), &far, &mut sum);
                        continue;
                    }
                    for v in (0..VECTORS).filter(|v| of_vector(lit, v * LANES)) {
                        let first = v * LANES;
                        let kinds = met.kinds(first).unwrap_or(Kinds::NONE);
                        let near = march::<S, K>(simd, slabs, start + first, steps, kinds);
                        let place = fan.cells[end.end];
                        let from = ([start, row, light.pad()], v, place);
                        let one = look::<S, K>(simd, slabs, from, (end, near, cone.angle), &far);
                        let share = mask(simd, lit, v)
                            .select(f32x16::splat(simd, share), f32x16::splat(simd, 0.0));
                        for c in 0..3 {
                            sum[c][v] = one[c].mul_add(share, sum[c][v]);
                        }
                    }
                }
            }
            for v in (0..VECTORS).filter(|v| of_vector(faces, v * LANES)) {
                for c in 0..3 {
                    sum[c][v].store_slice(&mut sums[c][v * LANES..][..LANES]);
                }
            }
        }
        sum
    }

    /// The cones of the tile that [`Self::light`] was last given, with the light of its pixels
    /// through all cones up to each. Their angles are the same from any distance.
    pub fn sums(&self) -> impl Iterator<Item = (&Cone, &[[f32; TILE]; 3])> {
        self.views[0][0].cones.iter().zip(&self.sums)
    }
}

/// Adds the light along a ray to those of 64 pixels that are given as bits, through matter that is
/// solid only: the `source` share of what glows, a `share` of what comes from beyond.
#[inline(always)]
fn look_solid<S: Simd>(
    simd: S,
    slabs: &Slabs,
    ([start, row, pad], solid): ([usize; 3], &[[u64; 2]]),
    (end, steps, lit): (&Ray, &[Step], u64),
    (source, share): (Option<f32>, f32),
    far: &Far,
    light: &mut Light<S>,
) {
    let open = march_solid(simd, slabs, (start, solid), steps, (lit, source), light);
    if open == 0 {
        return;
    }
    let (strays, lost) = end.strays(slabs.rows, row);
    let mut rows = [open & !solid[end.end][0], open & !solid[end.end + 1][0]];
    rows[lost] &= !strays;
    let at = (pad + row).wrapping_add_signed(end.row);
    far.add_where(simd, at, &end.shares, rows, share, light);
}

/// Light along a ray from the sixteen pixels of a vector, as if it filled its cone.
#[inline(always)]
fn look<S: Simd, const K: usize>(
    simd: S,
    slabs: &Slabs,
    ([start, row, pad], v, place): ([usize; 3], usize, isize),
    (end, near, angle): (&Ray, Interval<S, K>, f32),
    far: &Far,
) -> [f32x16<S>; 3] {
    let zero = f32x16::splat(simd, 0.0);
    let pass = &slabs.pass[0][(start + v * LANES).wrapping_add_signed(place)..];
    let at = (pad + row + v * LANES).wrapping_add_signed(end.row);
    let (strays, lost) = end.strays(slabs.rows, row);
    let (mut all, mut far_light) = (f32x16::splat(simd, CLOSED), [zero; 3]);
    for (i, &share) in end.shares.iter().enumerate() {
        let mut share = f32x16::from_slice(simd, &pass[i..][..LANES]) * share;
        if i == lost {
            share = mask(simd, strays, v).select(zero, share);
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

/// What lies between 64 pixels and the plane; which of them is near it is not told.
#[inline(always)]
fn near<S: Simd>(simd: S, slabs: &Slabs, start: usize, ahead: usize) -> Met {
    let mut met = u8x64::splat(simd, 0);
    for slab in 0..=ahead {
        let start = start.wrapping_add_signed(slab as isize * slabs.step());
        // Two words of a tile cover what rays of up to 31 px can stray to.
        let around = &slabs.kinds[start - ahead - 1..start + TILE + ahead + 1];
        met |= u8x64::from_slice(simd, &around[..TILE]);
        met |= u8x64::from_slice(simd, &around[around.len() - TILE..]);
    }
    kinds_of(met)
}

/// The view of pixels `ahead` slabs before a plane, `stride` cells from one slab to the next.
fn view(look: Look, ahead: usize, stride: isize) -> View {
    let cones = look.cones(ahead);
    let place = |way: &Way| ahead as isize * stride + way.row;
    let rays = |cone: &ConeWays| Rays {
        ways: cone.ways.iter().map(|way| way.crossings.clone()).collect(),
        others: cone.ways.iter().flat_map(|way| [place(way), place(way) + 1]).collect(),
    };
    let fan = Fan::new(&cones.iter().map(rays).collect::<Vec<_>>(), stride);
    let end = |way: &Way| Ray { row: way.row, shares: way.shares, end: fan.place(place(way)) };
    let cone = |(number, cone): (usize, &ConeWays)| {
        let ends = cone.ways.iter().map(end).collect();
        Cone { number, angle: cone.angle, cosines: cone.cosines, ends }
    };
    View { cones: cones.iter().enumerate().map(cone).collect(), fan }
}
