//! Pass B: every pixel in reach of a lamp looks its ray up.
//!
//! The picture is cut into bands of rows. A band takes the lamps one after the other, in their
//! order, so no two threads write the same pixel and the sum does not depend on their number.

use super::angle::atan2;
use super::fan::Fan;
use crate::settings::{Blend, Edges, Polar};
use crate::stages::bounce::{NORMALS, Surfaces, Wall};
use crate::stages::ground::{Ground, LANES};
use crate::{Cells, Falloff, Lamp, Rgb};
use fearless_simd::{Level, dispatch, f32x16, i32x16, prelude::*};
use rayon::prelude::*;
use std::f32::consts::{FRAC_1_PI, PI};
use std::ops::Range;

/// Rows of a band.
const BAND: usize = 16;

/// The picture: a plane a channel, rows padded to whole vectors. Open cells hold their light, solid
/// cells the mean light of their faces.
#[derive(Debug, Default)]
pub struct Canvas {
    width: usize,
    stride: usize,
    planes: [Vec<f32>; 3],
    /// 1 in open cells, 0 in solid ones and in the padding.
    open: Vec<f32>,
    /// Solid cells with a face in the open.
    surfaces: Surfaces,
}

/// A band of the picture on its way.
struct Band<'a> {
    rows: Range<usize>,
    planes: [&'a mut [f32]; 3],
    open: &'a [f32],
    walls: &'a [Wall],
    ground: &'a Ground,
    width: usize,
    stride: usize,
}

impl Canvas {
    /// Makes it black, for these cells.
    pub fn clear(&mut self, cells: &Cells) {
        self.width = cells.width() as usize;
        self.stride = self.width.next_multiple_of(LANES);
        let n = self.stride * cells.height() as usize;
        for plane in &mut self.planes {
            plane.clear();
            plane.resize(n, 0.0);
        }
        self.open.resize(n, 0.0);
        let w = self.width;
        self.open.par_chunks_mut(self.stride).enumerate().for_each(|(y, row)| {
            row[w..].fill(0.0);
            for (x, open) in row[..w].iter_mut().enumerate() {
                *open = f32::from(!cells.is_solid(y * w + x));
            }
        });
        self.surfaces.collect(cells, 0.0);
    }

    /// Lights it with lamps.
    pub fn light(&mut self, level: Level, ground: &Ground, fans: &[Fan], settings: &Polar) {
        let (width, stride) = (self.width, self.stride);
        let [red, green, blue] = &mut self.planes;
        let walls = &self.surfaces.walls;
        let bands = red
            .par_chunks_mut(BAND * stride)
            .zip(green.par_chunks_mut(BAND * stride))
            .zip(blue.par_chunks_mut(BAND * stride))
            .zip(self.open.par_chunks(BAND * stride))
            .enumerate();
        bands.for_each(|(band, (((red, green), blue), open))| {
            let rows = band * BAND..band * BAND + open.len() / stride;
            let wall = |y: usize| walls.partition_point(|wall| (wall.cell as usize) < y * width);
            let walls = &walls[wall(rows.start)..wall(rows.end)];
            let mut band =
                Band { rows, planes: [red, green, blue], open, walls, width, stride, ground };
            for fan in fans {
                dispatch!(level, simd => band.add(simd, fan, settings));
                band.add_to_walls(fan, settings);
            }
        });
    }

    /// Writes it in row order.
    pub fn write(&self, light: &mut Vec<Rgb>) {
        let rows = self.open.len() / self.stride;
        light.resize(rows * self.width, [0.0; 3]);
        light.par_chunks_mut(self.width).enumerate().for_each(|(y, row)| {
            let [red, green, blue] = self.planes.each_ref().map(|plane| &plane[y * self.stride..]);
            for (x, rgb) in row.iter_mut().enumerate() {
                *rgb = [red[x], green[x], blue[x]];
            }
        });
    }
}

impl Band<'_> {
    /// Adds a lamp to the open cells.
    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, fan: &Fan, settings: &Polar) {
        let [x, y] = fan.lamp.position;
        let reach = fan.reach;
        let rows = self.rows.clone();
        let lane = f32x16::from_fn(simd, |l| l as f32);
        // A px more on all sides: rounding must not cut the rim.
        let from = (y - reach - 1.5).max(rows.start as f32) as usize;
        let to = ((y + reach + 1.5).max(0.0) as usize).min(rows.end);
        for row in from..to {
            let dy = row as f32 + 0.5 - y;
            let half = (reach * reach - dy * dy).max(0.0).sqrt() + 1.5;
            let first = (x - half).max(0.0) as usize / LANES * LANES;
            let last = ((x + half).max(0.0) as usize).min(self.width);
            for chunk in (first..last).step_by(LANES) {
                let place = (row - rows.start) * self.stride + chunk;
                let open = f32x16::from_slice(simd, &self.open[place..place + LANES]);
                if open.simd_gt(0.0).to_bitmask() != 0 {
                    let dx = lane + (chunk as f32 + 0.5 - x);
                    let off = [dx, f32x16::splat(simd, dy)];
                    self.add_chunk(simd, fan, settings, place, off, open);
                }
            }
        }
    }

    #[inline(always)]
    fn add_chunk<S: Simd>(
        &mut self,
        simd: S,
        fan: &Fan,
        settings: &Polar,
        place: usize,
        [dx, dy]: [f32x16<S>; 2],
        open: f32x16<S>,
    ) {
        let distance = (dx * dx + dy * dy).sqrt();
        let mut share = falloff(&fan.lamp, distance) * open;
        if share.simd_gt(0.0).to_bitmask() == 0 {
            return;
        }
        let at = atan2(dy, dx) * fan.per_radian();
        let at = at.simd_lt(0.0).select(at + fan.count as f32, at);
        let nearest = (at + 0.5).to_int::<i32x16<S>>().to_array();
        let mut bounds = [[0.0; LANES]; 2];
        for l in 0..LANES {
            [bounds[0][l], bounds[1][l]] = fan.bounds[nearest[l] as usize];
        }
        let [lit, dark] = bounds.map(|b| f32x16::load_array(simd, b));
        let (lit, dark) = (distance.simd_lt(lit), distance.simd_ge(dark));
        let mut partly = (share.simd_gt(0.0) & !lit & !dark).to_bitmask();
        share = (!lit & dark).select(open * 0.0, share);
        if partly != 0 {
            let mut shares = share.to_array();
            while partly != 0 {
                let l = partly.trailing_zeros() as usize;
                partly &= partly - 1;
                shares[l] *= fan.partly_seen(self.ground, [dx[l], dy[l]], at[l]);
            }
            share = f32x16::load_array(simd, shares);
        }
        let left = share.simd_gt(0.0).to_bitmask();
        if left == 0 {
            return;
        }
        if !fan.cone.is_empty() {
            share *= f32x16::from_fn(simd, |l| fan.in_cone(at[l], settings.edges));
        }
        let mut through = [share; 3];
        if !fan.knots.is_empty() {
            let mut lanes = through.map(|v| v.to_array());
            for l in (0..LANES).filter(|l| left >> l & 1 == 1) {
                let t = fan.through(at[l], distance[l], settings.edges);
                (0..3).for_each(|c| lanes[c][l] *= t[c]);
            }
            through = lanes.map(|v| f32x16::load_array(simd, v));
        }
        for c in 0..3 {
            let plane = &mut self.planes[c][place..place + LANES];
            let old = f32x16::from_slice(simd, plane);
            let new = through[c] * (fan.lamp.color[c] * fan.lamp.intensity);
            let sum = match settings.blend {
                Blend::Add => old + new,
                Blend::Max => old.max(new),
                Blend::Screen => {
                    let new = new.min(1.0);
                    old + new - old * new
                }
            };
            sum.store_slice(plane);
        }
    }

    /// Adds a lamp to the solid cells whose faces it lights.
    fn add_to_walls(&mut self, fan: &Fan, settings: &Polar) {
        let [x, y] = fan.lamp.position;
        // A face lies up to a px from its cell's centre, and the place before it too.
        let reach = fan.reach + 1.0;
        let row = |y: f32| {
            self.walls.partition_point(|wall| ((wall.cell as usize / self.width) as f32) < y)
        };
        for wall in &self.walls[row(y - reach - 1.0)..row(y + reach + 1.0)] {
            let cell = wall.cell as usize;
            let (column, row) = (cell % self.width, cell / self.width);
            let off = [column as f32 + 0.5 - x, row as f32 + 0.5 - y];
            if off[0].abs() > reach || off[0] * off[0] + off[1] * off[1] > reach * reach {
                continue;
            }
            let new = on_wall(fan, self.ground, wall, off, settings.edges);
            let place = (row - self.rows.start) * self.stride + column;
            for c in 0..3 {
                let value = &mut self.planes[c][place];
                *value = match settings.blend {
                    Blend::Add => *value + new[c],
                    Blend::Max => value.max(new[c]),
                    Blend::Screen => *value + new[c].min(1.0) * (1.0 - *value),
                };
            }
        }
    }
}

/// What the exposed faces of a wall receive from a lamp, on the mean.
///
/// Light of fluence φ from one direction is `½∫L cosθ dθ = π·φ·cosθ` on a face. Whether it arrives is
/// asked at the centre of the open cell before the face: at the face itself every ray ends.
fn on_wall(fan: &Fan, ground: &Ground, wall: &Wall, off: [f32; 2], edges: Edges) -> Rgb {
    let (mut sum, mut faces) = ([0.0; 3], 0.0);
    for (normal, _) in NORMALS.iter().zip(wall.exposed).filter(|(_, exposed)| *exposed) {
        faces += 1.0;
        let normal = normal.map(|n| n as f32);
        let face: [f32; 2] = std::array::from_fn(|a| off[a] + 0.5 * normal[a]);
        let before: [f32; 2] = std::array::from_fn(|a| off[a] + normal[a]);
        let distance = face[0].hypot(face[1]);
        let cos = -(normal[0] * face[0] + normal[1] * face[1]) / distance.max(f32::MIN_POSITIVE);
        let arrives = PI * cos * fan.lamp.falloff.at(distance, &fan.lamp);
        if arrives <= 0.0 {
            continue;
        }
        let (at, distance) = (fan.at(before), before[0].hypot(before[1]));
        let share = arrives * fan.seen(ground, before, at) * fan.in_cone(at, edges);
        if share > 0.0 {
            let through =
                if fan.knots.is_empty() { [1.0; 3] } else { fan.through(at, distance, edges) };
            (0..3).for_each(|c| sum[c] += share * through[c]);
        }
    }
    let strength = fan.lamp.intensity / faces;
    std::array::from_fn(|c| sum[c] * strength * fan.lamp.color[c])
}

/// [`Falloff::at`] for sixteen distances.
#[inline(always)]
fn falloff<S: Simd>(lamp: &Lamp, distance: f32x16<S>) -> f32x16<S> {
    let u = distance * (1.0 / lamp.range);
    match lamp.falloff {
        Falloff::Linear => (-u + 1.0).max(0.0),
        Falloff::Smooth => {
            let v = (-(u * u) + 1.0).max(0.0);
            v * v
        }
        Falloff::Inverse => {
            let square = u * u;
            let window = (-(square * square) + 1.0).max(0.0);
            let simd = distance.token();
            let sine = f32x16::splat(simd, lamp.size) / distance.max(lamp.size);
            let seen = atan2(sine, (-(sine * sine) + 1.0).max(0.0).sqrt()) * FRAC_1_PI;
            seen * window * window
        }
    }
}
