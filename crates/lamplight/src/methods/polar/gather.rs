//! Pass B: every pixel in reach of a lamp looks up its ray in the shadow map.
//!
//! The picture is cut into bands of rows. A band adds the lamps one after the other, in order, so no
//! two threads write the same pixel and the sum does not depend on their number.

use super::angle::atan2;
use super::shadow_map::{ShadowMap, ShadowScene};
use super::sun_map::SunMap;
use crate::grid::cast::LANES;
use crate::mask::ALL_LAYERS;
use crate::settings::{Blend, Polar, ShadowFilter};
use crate::simd::dispatch;
use crate::stages::bounce::{Surfaces, Wall, mean_over_faces};
use crate::stages::faces::{Faces, NORMALS};
use crate::{Cells, Falloff, Lamp, Moment, Rgb, elevation, moment};
use fearless_simd::{Level, f32x16, i32x16, prelude::*};
use rayon::prelude::*;
use std::f32::consts::FRAC_1_PI;
use std::ops::Range;

/// Rows of a band.
const BAND: usize = 16;
/// Walls whose faces are lit together. Lamps that reach none of their rows are passed over.
const WALLS: usize = 64;

/// The light found so far: one plane per channel, rows padded to whole vectors. Open cells hold their
/// mean radiance, solid cells the mean over their faces.
#[derive(Debug, Default)]
pub struct LightPlanes {
    width: usize,
    stride: usize,
    planes: [Vec<f32>; 3],
    /// First moments, in rows as long; empty if they were not asked for.
    moments: Vec<Moment>,
    /// The tangent of the elevation of all light.
    tangent: f32,
    /// 1 in open cells, 0 in solid ones and in the padding.
    open: Vec<f32>,
    /// Solid cells with a face in the open.
    surfaces: Surfaces,
}

/// A band of rows.
struct Band<'a> {
    rows: Range<usize>,
    planes: [&'a mut [f32]; 3],
    moments: Option<&'a mut [Moment]>,
    tangent: f32,
    open: &'a [f32],
    walls: &'a [Wall],
    scene: ShadowScene<'a>,
    width: usize,
    stride: usize,
}

impl LightPlanes {
    /// Sets all light to 0, for these cells, and all first moments if they are asked for by the elevation of all light.
    pub fn clear(&mut self, cells: &Cells, moments: Option<f32>) {
        self.width = cells.width() as usize;
        self.stride = self.width.next_multiple_of(LANES);
        let n = self.stride * cells.height() as usize;
        for plane in &mut self.planes {
            plane.clear();
            plane.resize(n, 0.0);
        }
        self.moments.clear();
        self.moments.resize(if moments.is_some() { n } else { 0 }, Moment::default());
        self.tangent = moments.unwrap_or(elevation::DEFAULT).tan();
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

    /// Adds lamps.
    pub fn light(
        &mut self,
        level: Level,
        scene: ShadowScene,
        shadow_maps: &[ShadowMap],
        settings: &Polar,
    ) {
        let (width, stride, tangent) = (self.width, self.stride, self.tangent);
        let [red, green, blue] = &mut self.planes;
        let walls = &self.surfaces.walls;
        let bands = red
            .par_chunks_mut(BAND * stride)
            .zip(green.par_chunks_mut(BAND * stride))
            .zip(blue.par_chunks_mut(BAND * stride))
            .zip(self.open.par_chunks(BAND * stride))
            .zip(moment::chunks(optional(&mut self.moments), BAND * stride))
            .enumerate();
        bands.for_each(|(band, ((((red, green), blue), open), moments))| {
            let rows = band * BAND..band * BAND + open.len() / stride;
            let wall = |y: usize| walls.partition_point(|wall| (wall.cell as usize) < y * width);
            let walls = &walls[wall(rows.start)..wall(rows.end)];
            let planes = [red, green, blue];
            let mut band =
                Band { rows, planes, moments, tangent, open, walls, width, stride, scene };
            for shadow_map in shadow_maps {
                dispatch!(level, simd => band.add(simd, shadow_map, settings));
                // Exact light on walls is found by face.
                if scene.solid.is_none() {
                    band.add_to_walls(shadow_map, settings);
                }
            }
        });
    }

    /// Adds lamps to the irradiance ÷ 2 of the exposed faces of walls.
    pub fn light_faces(
        &self,
        scene: ShadowScene,
        shadow_maps: &[ShadowMap],
        settings: &Polar,
        faces: &mut [Faces],
    ) {
        let groups = faces.par_chunks_mut(WALLS).zip(self.surfaces.walls.par_chunks(WALLS));
        groups.for_each(|(faces, walls)| {
            let row = |wall: usize| walls[wall].cell as usize / self.width;
            let rows = row(0)..row(walls.len() - 1) + 1;
            for shadow_map in shadow_maps.iter().filter(|map| map.reaches_rows(&rows)) {
                for (faces, wall) in faces.iter_mut().zip(walls) {
                    self.light_wall(scene, shadow_map, settings, wall, faces);
                }
            }
        });
    }

    /// Adds a lamp to the irradiance ÷ 2 of the exposed faces of a wall.
    fn light_wall(
        &self,
        scene: ShadowScene,
        shadow_map: &ShadowMap,
        settings: &Polar,
        wall: &Wall,
        faces: &mut Faces,
    ) {
        let cell = wall.cell as usize;
        let center = [cell % self.width, cell / self.width].map(|v| v as f32 + 0.5);
        let Some(off) = shadow_map.reaches(center) else { return };
        if !scene.lights(shadow_map.lamp.mask, cell) {
            return;
        }
        for (face, sum) in faces.iter_mut().enumerate().filter(|(f, _)| wall.exposed[*f]) {
            let arrives = on_face(shadow_map, scene, off, face, settings.shadow_filter);
            (0..3).for_each(|c| sum[c] += arrives[c]);
        }
    }

    /// The number of solid cells with a face in the open.
    pub fn walls(&self) -> usize {
        self.surfaces.walls.len()
    }

    /// Adds a sun to the open cells, and to the irradiance ÷ 2 of the exposed faces of walls. Suns add up, however
    /// lamps blend.
    pub fn shine(&mut self, scene: ShadowScene, sun_map: &SunMap, faces: &mut [Faces]) {
        let (width, stride) = (self.width, self.stride);
        let weight = sun_map.moment_weight(self.tangent);
        let [red, green, blue] = &mut self.planes;
        let rows = red.par_chunks_mut(stride).zip(green.par_chunks_mut(stride));
        let rows = rows.zip(blue.par_chunks_mut(stride)).zip(self.open.par_chunks(stride));
        let rows = rows.zip(moment::chunks(optional(&mut self.moments), stride));
        rows.enumerate().for_each(|(y, ((((red, green), blue), open), mut moments))| {
            let lights = |x: usize| open[x] > 0.0 && scene.lights(sun_map.mask(), y * width + x);
            for x in (0..width).filter(|&x| lights(x)) {
                let (light, direction) = sun_map.at(scene, [x as f32 + 0.5, y as f32 + 0.5]);
                (red[x], green[x], blue[x]) =
                    (red[x] + light[0], green[x] + light[1], blue[x] + light[2]);
                if let Some(moments) = &mut moments {
                    let direction = direction.map(|v| weight * v);
                    moment::add(&mut moments[x], &moment::from_direction(light, direction));
                }
            }
        });
        let walls = faces.par_iter_mut().zip(&self.surfaces.walls);
        let lit = walls.filter(|(_, wall)| scene.lights(sun_map.mask(), wall.cell as usize));
        lit.for_each(|(faces, wall)| {
            let cell = wall.cell as usize;
            let center = [cell % width, cell / width].map(|v| v as f32 + 0.5);
            for (face, sum) in faces.iter_mut().enumerate().filter(|(f, _)| wall.exposed[*f]) {
                let normal = NORMALS[face].map(|n| n as f32);
                let middle = [0, 1].map(|a| center[a] + 0.5 * normal[a]);
                let arrives = sun_map.on_face(scene, middle, normal);
                (0..3).for_each(|c| sum[c] += arrives[c]);
            }
        });
    }

    /// Adds the light of the faces of walls to their cells: the mean over their exposed faces.
    pub fn add_faces(&mut self, faces: &[Faces]) {
        for (wall, faces) in self.surfaces.walls.iter().zip(faces) {
            let (x, y) = (wall.cell as usize % self.width, wall.cell as usize / self.width);
            let mean = mean_over_faces(wall, faces);
            (0..3).for_each(|c| self.planes[c][y * self.stride + x] += mean[c]);
        }
    }

    /// Writes the first moments in row order.
    pub fn write_moments(&self, moments: &mut Vec<Moment>) {
        moments.clear();
        let rows = self.moments.chunks(self.stride).map(|row| &row[..self.width]);
        rows.for_each(|row| moments.extend_from_slice(row));
    }

    /// Writes the light in row order.
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
    fn add<S: Simd>(&mut self, simd: S, shadow_map: &ShadowMap, settings: &Polar) {
        let [x, y] = shadow_map.lamp.position;
        let reach = shadow_map.reach;
        let rows = self.rows.clone();
        let lane = f32x16::from_fn(simd, |l| l as f32);
        let mask = shadow_map.lamp.mask;
        let is_masked = mask != ALL_LAYERS && self.scene.masks.is_some();
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
                let mut open = f32x16::from_slice(simd, &self.open[place..place + LANES]);
                if is_masked {
                    let first = row * self.width + chunk;
                    let lights = |l: usize| f32::from(u8::from(self.scene.lights(mask, first + l)));
                    open *= f32x16::from_fn(simd, lights);
                }
                if open.simd_gt(0.0).to_bitmask() != 0 {
                    let dx = lane + (chunk as f32 + 0.5 - x);
                    let off = [dx, f32x16::splat(simd, dy)];
                    self.add_chunk(simd, shadow_map, settings, place, off, open);
                }
            }
        }
    }

    #[inline(always)]
    fn add_chunk<S: Simd>(
        &mut self,
        simd: S,
        shadow_map: &ShadowMap,
        settings: &Polar,
        place: usize,
        [dx, dy]: [f32x16<S>; 2],
        open: f32x16<S>,
    ) {
        let distance = (dx * dx + dy * dy).sqrt();
        if shadow_map.has_cone() && !shadow_map.may_be_in_cone([dx, dy], distance) {
            return;
        }
        let mut weight = falloff(&shadow_map.lamp, distance) * open;
        if weight.simd_gt(0.0).to_bitmask() == 0 {
            return;
        }
        let at = atan2(dy, dx) * shadow_map.per_radian();
        let at = at.simd_lt(0.0).select(at + shadow_map.count as f32, at);
        if shadow_map.has_cone() {
            weight *= shadow_map.in_cone_lanes(simd, at, settings.shadow_filter);
            if weight.simd_gt(0.0).to_bitmask() == 0 {
                return;
            }
        }
        let cookie = shadow_map.in_cookie_lanes([dx, dy], weight);
        if let Some([red, green, blue]) = cookie {
            // What the lamp is seen of where the picture is black is not worth finding.
            let weights = weight.to_array();
            let lit = |l: usize| red[l] > 0.0 || green[l] > 0.0 || blue[l] > 0.0;
            weight = f32x16::from_fn(simd, |l| if lit(l) { weights[l] } else { 0.0 });
            if weight.simd_gt(0.0).to_bitmask() == 0 {
                return;
            }
        }
        let nearest = (at + 0.5).to_int::<i32x16<S>>().to_array();
        let mut bounds = [[0.0; LANES]; 2];
        for l in 0..LANES {
            [bounds[0][l], bounds[1][l]] = shadow_map.ranges.ends[nearest[l] as usize];
        }
        let [lit, dark] = bounds.map(|b| f32x16::load_array(simd, b));
        let (lit, dark) = (distance.simd_lt(lit), distance.simd_ge(dark));
        let mut middles = [0.0; LANES];
        let mut partly = (weight.simd_gt(0.0) & !lit & !dark).to_bitmask();
        weight = (!lit & dark).select(open * 0.0, weight);
        if partly != 0 {
            let mut weights = weight.to_array();
            while partly != 0 {
                let l = partly.trailing_zeros() as usize;
                partly &= partly - 1;
                let seen = shadow_map.partly_seen(self.scene, [dx[l], dy[l]], at[l]);
                weights[l] *= seen.fraction;
                middles[l] = seen.middle;
            }
            weight = f32x16::load_array(simd, weights);
        }
        let left = weight.simd_gt(0.0).to_bitmask();
        if left == 0 {
            return;
        }
        let mut through = [weight; 3];
        if !shadow_map.curves.is_empty() {
            let mut lanes = through.map(|v| v.to_array());
            for l in (0..LANES).filter(|l| left >> l & 1 == 1) {
                let off = [dx[l], dy[l]];
                let t = shadow_map.transmittance(self.scene, off, at[l], settings.shadow_filter);
                (0..3).for_each(|c| lanes[c][l] *= t[c]);
            }
            through = lanes.map(|v| f32x16::load_array(simd, v));
        }
        if let Some(cookie) = cookie {
            for (through, factors) in through.iter_mut().zip(cookie) {
                *through *= f32x16::load_array(simd, factors);
            }
        }
        let color = shadow_map.lamp.radiance();
        let blend = blend_of(&shadow_map.lamp, settings);
        if let Some(moments) = &mut self.moments {
            for l in (0..LANES).filter(|l| left >> l & 1 == 1) {
                let off = [dx[l], dy[l]];
                let direction = shadow_map.direction(off, middles[l], self.tangent);
                let moment = &mut moments[place + l];
                for c in 0..3 {
                    let (old, new) = (self.planes[c][place + l], through[c][l] * color[c]);
                    // The shares of the light before and of the lamp in the light that stays.
                    let [kept, taken] = match blend {
                        Blend::Add => [1.0, new],
                        Blend::Max if new > old => [0.0, new],
                        Blend::Max => [1.0, 0.0],
                        Blend::Screen => [1.0 - new.min(1.0), new.min(1.0)],
                    };
                    for (part, way) in moment.iter_mut().zip(direction) {
                        part[c] = kept * part[c] + taken * way;
                    }
                }
            }
        }
        for c in 0..3 {
            let plane = &mut self.planes[c][place..place + LANES];
            let old = f32x16::from_slice(simd, plane);
            let new = through[c] * color[c];
            let sum = match blend {
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
    fn add_to_walls(&mut self, shadow_map: &ShadowMap, settings: &Polar) {
        let (y, reach) = (shadow_map.lamp.position[1], shadow_map.reach + 1.0);
        let row = |y: f32| {
            self.walls.partition_point(|wall| ((wall.cell as usize / self.width) as f32) < y)
        };
        for wall in &self.walls[row(y - reach - 1.0)..row(y + reach + 1.0)] {
            let cell = wall.cell as usize;
            if !self.scene.lights(shadow_map.lamp.mask, cell) {
                continue;
            }
            let (column, row) = (cell % self.width, cell / self.width);
            let center = [column as f32 + 0.5, row as f32 + 0.5];
            let Some(off) = shadow_map.reaches(center) else { continue };
            let new = on_wall(shadow_map, self.scene, wall, off, settings.shadow_filter);
            let place = (row - self.rows.start) * self.stride + column;
            for c in 0..3 {
                let value = &mut self.planes[c][place];
                *value = match blend_of(&shadow_map.lamp, settings) {
                    Blend::Add => *value + new[c],
                    Blend::Max => value.max(new[c]),
                    Blend::Screen => *value + new[c].min(1.0) * (1.0 - *value),
                };
            }
        }
    }
}

/// Returns the mean irradiance, ÷ 2, of the exposed faces of a wall from a lamp.
fn on_wall(
    shadow_map: &ShadowMap,
    scene: ShadowScene,
    wall: &Wall,
    off: [f32; 2],
    shadow_filter: ShadowFilter,
) -> Rgb {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for face in (0..4).filter(|&face| wall.exposed[face]) {
        let arrives = on_face(shadow_map, scene, off, face, shadow_filter);
        (0..3).for_each(|c| sum[c] += arrives[c]);
        count += 1.0;
    }
    sum.map(|v| v / count)
}

/// Returns the irradiance, ÷ 2, of a face of a wall at `off` from a lamp.
///
/// Light of mean radiance J from one direction gives a face `½∫L cosθ dθ = π·J·cosθ`. Visibility is
/// looked up at the center of the open cell before the face: at the face itself every ray ends.
fn on_face(
    shadow_map: &ShadowMap,
    scene: ShadowScene,
    off: [f32; 2],
    face: usize,
    shadow_filter: ShadowFilter,
) -> Rgb {
    let normal = NORMALS[face].map(|n| n as f32);
    let weight = shadow_map.on_face(scene, off, normal, shadow_filter);
    if weight.iter().all(|&v| v <= 0.0) {
        return [0.0; 3];
    }
    let (lamp, before) = (&shadow_map.lamp, std::array::from_fn(|a| off[a] + normal[a]));
    let at = shadow_map.at(before);
    let through = if shadow_map.curves.is_empty() {
        [1.0; 3]
    } else {
        shadow_map.transmittance(scene, before, at, shadow_filter)
    };
    std::array::from_fn(|c| weight[c] * through[c] * lamp.intensity * lamp.color[c])
}

/// Returns the way in which the light of a lamp combines with that of those before.
fn blend_of(lamp: &Lamp, settings: &Polar) -> Blend {
    // Light is taken from the sum, whatever the sum is made of.
    if lamp.takes_light() { Blend::Add } else { settings.blend }
}

/// None for no moments.
fn optional(moments: &mut [Moment]) -> Option<&mut [Moment]> {
    (!moments.is_empty()).then_some(moments)
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
