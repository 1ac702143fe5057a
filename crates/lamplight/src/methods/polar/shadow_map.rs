//! Pass A: the polar shadow map of one lamp, and its lookup by pixels.
//!
//! Ray i leaves at the angle 2πi/count; the map keeps its length ℓ to the first wall. A pixel at
//! distance d is lit by a ray longer than d. For soft edges the neighbours of the ray count too: in
//! the plane of angle and 1/r the lines from a pixel to the points of a lamp of radius s are straight,
//! so a wall at distance ℓ, Δ radians beside the pixel, hides the point at
//! `β = Δ / (s·(1/ℓ − 1/d))`, as a fraction of the way from the lamp's center to its rim (small
//! angles: sin Δ ≈ Δ). The fraction of β from −1 to 1 that no ray hides is the visible fraction of the
//! lamp.
//!
//! A ray stands for all directions within half a ray, but a wall that a lamp grazes is much nearer at one end of
//! them than at the other. So a wall does not count as a flat step at ℓ: of the lamp, the face that the ray hits
//! hides no more from a pixel in front of that face than lies behind the face ([`HitFace`]). It takes the place
//! of the bias of other shadow maps, and needs no constant.
//!
//! Known failure: walls behind the nearest one throw no penumbra of their own. Maps for other methods find
//! penumbrae by all solid cells instead (`penumbra.rs`).

use super::lit_ranges::{LitRanges, beside};
use super::penumbra::{
    LampDisc, SeenPart, are_uneven, mean_cosine, through_media_to_lamp, visible,
};
use super::sampling::{clear_px, sample};
use super::solid_bits::SolidBits;
use super::transmittance_curve::TransmittanceCurves;
use crate::grid::cast::{LANES, RayHit};
use crate::grid::class::CellClass;
use crate::grid::medium_grid::MediumGrid;
use crate::grid::traverse::Real;
use crate::math::circle;
use crate::settings::{Polar, ShadowFilter, Traversal};
use crate::simd::dispatch;
use crate::{Cookie, Lamp, Rgb, cookie, elevation};
use fearless_simd::{Level, f32x16, prelude::*};
use rayon::prelude::*;
use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

/// Fewest rays of a lamp.
const FEWEST: f32 = 8.0;
/// Most rays of a lamp: reached by ranges over 40 000 px only.
const MOST: f32 = (1 << 18) as f32;
/// The largest half width of a penumbra, in rays: it bounds the cost of a pixel.
pub const WIDEST: f32 = 64.0;
/// The smallest half width of a penumbra, in rays: it makes edges linear between two rays.
pub const NARROWEST: f32 = 0.5;
/// The smallest distance of a wall, px, so that 1/length is finite.
pub const NEAREST: f32 = 1e-3;
/// The distance by which a wall may be nearer than the rays beside it say, px: half a cell's diagonal.
pub const NEAREST_BESIDE: f32 = 0.75;
/// Points along a face at which exact light is found, and their number where the lamp is near, where a cone's edge
/// may cross the face.
const ALONG_FACE: [usize; 2] = [3, 12];
/// The distance from which on a lamp is far, px.
const FAR: f32 = 16.0;
/// Distance of these points from the wall, px: in the open for rounding's sake.
pub const OUTSIDE_OF_WALL: f32 = 1e-3;
/// Angles beside a pixel at which media are compared with those in front of it, in radii of the lamp as seen from
/// the pixel.
const PARTS: [f32; 5] = [0.5, 1.0, 2.0, 4.0, 8.0];
/// The largest of these angles, radians.
const FARTHEST: f32 = 1.5;
/// Size of a lamp up to which it is as far from a pixel as its centre, as a fraction of that distance.
const SMALL: f32 = 0.1;
/// Rays beside a cone up to which pixels may still be in it: they look up the nearest, or the two beside them.
const BESIDE: f32 = 1.5;
/// A bound of the rounding of a cosine.
const ROUNDING: f32 = 1e-6;
/// Rays that a thread casts at a time.
const TOGETHER: usize = 128;

/// The shadow map of one lamp.
#[derive(Debug, Default)]
pub struct ShadowMap {
    pub lamp: Lamp,
    /// The length of its rays, px: its range, within the grid.
    pub reach: f32,
    pub count: usize,
    /// The hits of rays that were cast together; `None` for those that have to be cast alone.
    together: Vec<Option<RayHit>>,
    hits: Vec<RayHit>,
    /// 1/length of each ray, 0 if it hits nothing.
    inverse: Vec<f32>,
    /// The faces that rays hit; empty if penumbrae are exact, or edges are stairs.
    faces: Vec<HitFace>,
    pub ranges: LitRanges,
    /// Intensity of the lamp's cone at each ray, with two rays more; empty without a cone.
    pub cone: Vec<f32>,
    /// The direction of the lamp's cone, and the cosine of the angle beside it from which on nothing is in it; without
    /// a cone, nothing is beside it.
    beam: ([f32; 2], f32),
    /// The axis of the lamp's cookie.
    axis: [f32; 2],
    pub curves: TransmittanceCurves,
    /// Rays per radian.
    per_radian: f32,
    /// Radius of the lamp in rays × px, 0 unless edges are soft.
    spread: f32,
    /// True if penumbrae are exact: thrown by all solid cells, not only by those that rays hit.
    exact: bool,
}

/// The line on which the face lies that a ray hits.
#[derive(Clone, Copy, Debug, Default)]
struct HitFace {
    /// 0 for a face that looks to the left or the right, 1 for one that looks up or down.
    axis: usize,
    /// The place of the line along the axis, from the lamp's center, px; 0 if the ray starts in the wall, or hits
    /// nothing.
    place: f32,
}

impl HitFace {
    /// Returns the face through which a ray enters the cell that it hits.
    fn of(grid: &MediumGrid, hit: RayHit, from: [f32; 2], direction: [f32; 2]) -> Self {
        if hit == RayHit::NONE {
            return Self::default();
        }
        let cell = grid.cell(hit.cell as usize);
        let inverse = direction.map(Real::inverse);
        let place = [0, 1].map(|a| (cell[a] + i32::from(inverse[a] < 0.0)) as f32 - from[a]);
        let reached = [0, 1].map(|a| place[a] * inverse[a]);
        let last = usize::from(reached[1] > reached[0]);
        let mut before = cell;
        before[last] -= if inverse[last] < 0.0 { -1 } else { 1 };
        // Through a corner, a ray may enter beside another solid cell.
        let is_open = grid.class(before) != CellClass::Solid;
        let axis = if is_open { last } else { 1 - last };
        Self { axis, place: if reached[axis] > 0.0 { place[axis] } else { 0.0 } }
    }

    /// Returns whether the face lies behind a pixel at `off`, as seen from the lamp's center.
    fn is_behind(self, off: [f32; 2]) -> bool {
        (self.place - off[self.axis]) * self.place > 0.0
    }

    /// Returns the part β of the lamp from which on the face may hide it from a pixel at `off`; `rim` is the part
    /// β = 1.
    fn hides_from(self, off: [f32; 2], rim: [f32; 2]) -> f32 {
        if self.is_behind(off) {
            1.0 / (rim[self.axis] / self.place).max(f32::MIN_POSITIVE)
        } else {
            0.0
        }
    }
}

/// The scene of shadow maps.
#[derive(Clone, Copy)]
pub struct ShadowScene<'a> {
    pub grid: &'a MediumGrid,
    /// The solid cells, for penumbrae that are exact.
    pub solid: Option<&'a SolidBits>,
    /// The layers of every cell; `None` if all are in all.
    pub masks: Option<&'a [u8]>,
}

impl ShadowScene<'_> {
    /// Returns whether light of this mask lights a cell.
    #[inline(always)]
    pub fn lights(&self, mask: u8, cell: usize) -> bool {
        self.masks.is_none_or(|masks| masks.get(cell).is_none_or(|own| own & mask != 0))
    }
}

/// Returns the length of a lamp's rays in a grid of columns and rows, px, and their number.
pub fn rays(lamp: &Lamp, [width, height]: [u32; 2], settings: &Polar) -> (f32, usize) {
    let [x, y] = lamp.position;
    let farthest =
        x.abs().max((width as f32 - x).abs()).hypot(y.abs().max((height as f32 - y).abs()));
    let range = lamp.cookie.as_ref().map_or(lamp.range, |cookie| cookie.reach().min(lamp.range));
    // A px more: the circle has to reach past the farthest corner's centre.
    let reach = range.min(farthest + 1.0);
    let count = (TAU * reach * settings.density).ceil().clamp(FEWEST, MOST);
    (reach, count as usize)
}

impl ShadowMap {
    /// Returns the length of a ray, px.
    pub fn length(&self, ray: usize) -> f32 {
        self.hits[ray].length
    }

    /// Returns the bytes that the map of a lamp may take.
    pub fn most_bytes(lamp: &Lamp, grid: &MediumGrid, settings: &Polar) -> usize {
        const RAY: usize = size_of::<RayHit>()
            + size_of::<Option<RayHit>>()
            + size_of::<HitFace>()
            + size_of::<[f32; 4]>()
            + size_of::<[u8; 2]>();
        let (reach, count) = rays(lamp, grid.size.map(|side| side as u32), settings);
        let media = if grid.has_media() { TransmittanceCurves::most_bytes(reach) } else { 0 };
        count.saturating_mul(RAY + media)
    }

    /// Casts the rays of a lamp.
    pub fn trace(
        &mut self,
        level: Level,
        lamp: &Lamp,
        scene: ShadowScene,
        distance: &[f32],
        settings: &Polar,
    ) {
        let ShadowScene { grid, solid, .. } = scene;
        self.exact = solid.is_some();
        self.lamp = Lamp { falloff: settings.falloff.unwrap_or(lamp.falloff), ..lamp.clone() };
        self.axis = lamp.cookie.as_ref().map_or([0.0; 2], cookie::axis);
        (self.reach, self.count) = rays(lamp, grid.size.map(|side| side as u32), settings);
        self.per_radian = self.count as f32 / TAU;
        let size = if settings.shadow_filter == ShadowFilter::Soft { lamp.size } else { 0.0 };
        self.spread = size * self.per_radian;
        self.beam = lamp.cone.map_or(([0.0; 2], -1.0), |cone| {
            let beside = (0.5 * cone.angle + BESIDE / self.per_radian).min(PI);
            let (sine, cosine) = cone.direction.sin_cos();
            ([cosine, sine], beside.cos() - ROUNDING)
        });
        let (count, reach) = (self.count, self.reach);
        let angle = |ray: usize| circle::angle(ray as u32, count as u32);
        let direction = |ray: usize| circle::direction(ray as u32, count as u32);

        self.cone.clear();
        if let Some(cone) = lamp.cone {
            self.cone.extend((0..count + 2).map(|ray| cone.share(angle(ray % count))));
        }
        let (cone, exact) = (&self.cone, self.exact);
        // Exact penumbrae are also thrown by walls and media beside the cone, but only by those near the lamp.
        let dark = |ray: usize| cone.get(ray) == Some(&0.0) && !exact;
        let length = |ray: usize| match lamp.cone {
            Some(cone) if !grid.has_media() => match cone.outside(angle(ray)) {
                ..=0.0 => reach,
                beside => (lamp.size / beside.min(FRAC_PI_2).sin() + 1.0).min(reach),
            },
            _ => reach,
        };
        self.together.resize(count, None);
        let by_edges = settings.traversal == Traversal::Edge;
        self.together.par_chunks_mut(TOGETHER).enumerate().for_each(|(chunk, hits)| {
            let first = chunk * TOGETHER;
            for (i, hits) in hits.chunks_mut(LANES).enumerate() {
                let first = first + i * LANES;
                if !by_edges {
                    hits.fill(None);
                } else if !(first..first + hits.len()).all(dark) {
                    let directions = std::array::from_fn(|l| direction(first + l));
                    let longest = (first..first + hits.len()).map(length).fold(0.0, f32::max);
                    let cast = dispatch!(level, simd => {
                        grid.cast_lanes(simd, lamp.position, &directions, longest)
                    });
                    hits.copy_from_slice(&cast[..hits.len()]);
                }
            }
        });
        self.curves.clear(reach);
        self.hits.clear();
        for (ray, together) in self.together.iter().enumerate() {
            self.curves.next_ray();
            let (from, way, curves) = (lamp.position, direction(ray), &mut self.curves);
            let mut medium = |span, cell: usize| {
                if grid.classes[cell] == CellClass::Medium {
                    curves.medium(span, grid.extinction[cell]);
                }
            };
            self.hits.push(match (together, settings.traversal) {
                _ if dark(ray) => RayHit::NONE,
                (Some(hit), _) => *hit,
                (None, Traversal::Edge) => {
                    grid.cast(from, way, reach, false, |step, cell| medium(step.span, cell))
                }
                (None, Traversal::Step) => sample(grid, from, way, reach, |_| 1.0, medium),
                (None, Traversal::Distance) => {
                    sample(grid, from, way, reach, |cell| clear_px(distance[cell]), medium)
                }
            });
        }
        self.curves.next_ray();
        self.inverse.clear();
        self.inverse.extend(self.hits.iter().map(|hit| 1.0 / hit.length.max(NEAREST)));
        self.faces.clear();
        if !self.exact && settings.shadow_filter != ShadowFilter::Nearest {
            let face = |(ray, &hit)| HitFace::of(grid, hit, lamp.position, direction(ray));
            self.faces.extend(self.hits.iter().enumerate().map(face));
        }
        let mut ranges = std::mem::take(&mut self.ranges);
        if settings.shadow_filter == ShadowFilter::Nearest {
            ranges.sharp(&self.hits);
        } else {
            let covers = |ray| if self.exact { self.shaded(ray) } else { self.widest(ray) };
            // Pixels look up the ray nearest to them.
            let is_used = |ray| {
                let ([x, y], cosine) = self.beam;
                let [dx, dy] = direction(ray);
                dx * x + dy * y >= cosine
            };
            ranges.find(grid, &self.hits, is_used, |ray| self.shaded(ray), covers);
            // A wall within the lamp hides a part of it from pixels in front of that wall, too.
            let nearest = self.hits.iter().fold(reach, |nearest, hit| nearest.min(hit.length));
            if self.exact && nearest < lamp.size {
                ranges.ends.iter_mut().for_each(|[lit, _]| *lit = 0.0);
            }
        }
        self.ranges = ranges;
    }

    /// Returns the half width, in rays, of the penumbra that a ray's wall throws at 1/d.
    #[inline(always)]
    fn width(&self, ray: usize, inverse: f32) -> f32 {
        (self.spread * (self.inverse[ray] - inverse)).clamp(NARROWEST, WIDEST)
    }

    /// Returns the largest half width of the penumbra of a ray's wall.
    fn widest(&self, ray: usize) -> f32 {
        self.width(ray, 1.0 / self.reach)
    }

    /// Returns the number of rays to either side whose pixels a ray's wall may shade.
    fn shaded(&self, ray: usize) -> f32 {
        if !self.exact {
            // Half a ray for the pixel beside its ray, half for the width of the ray itself.
            return self.widest(ray) + 1.0;
        }
        // Of a wall at ℓ, beside a pixel at d: `sin Δ = s·(1/ℓ − cos Δ/d)`.
        let sine = (self.lamp.size * self.inverse[ray]).min(1.0);
        let cosine = (1.0 - sine * sine).sqrt();
        let sine = sine - self.lamp.size * cosine / self.reach;
        // A wall that touches the lamp is seen from all sides.
        if cosine == 0.0 { self.count as f32 } else { sine.asin() * self.per_radian + 1.5 }
    }

    /// Returns the visible fraction of the lamp for a pixel at `off` from it, `at` its angle in rays,
    /// 0 to `count`.
    pub fn seen(&self, scene: ShadowScene, off: [f32; 2], at: f32) -> f32 {
        let distance = off[0].hypot(off[1]);
        let [lit, dark] = self.ranges.ends[(at + 0.5) as usize];
        if distance < lit {
            1.0
        } else if distance >= dark {
            0.0
        } else {
            self.partly_seen(scene, off, at).fraction
        }
    }

    /// Returns the light that arrives at a face of a wall at `off`, as fractions of the lamp's radiance and without
    /// media: irradiance ÷ 2. It is the same in all channels unless the lamp has a cookie.
    pub fn on_face(
        &self,
        scene: ShadowScene,
        off: [f32; 2],
        normal: [f32; 2],
        shadow_filter: ShadowFilter,
    ) -> Rgb {
        let lamp = &self.lamp;
        let place = |out: f32, along: f32| -> [f32; 2] {
            std::array::from_fn(|a| off[a] + out * normal[a] + along * normal[1 - a])
        };
        let Some(solid) = scene.solid else {
            let (face, before) = (place(0.5, 0.0), place(1.0, 0.0));
            let distance = face[0].hypot(face[1]);
            let cosine =
                -(normal[0] * face[0] + normal[1] * face[1]) / distance.max(f32::MIN_POSITIVE);
            let arrives = PI * cosine * lamp.falloff.at(distance, lamp);
            if arrives <= 0.0 {
                return [0.0; 3];
            }
            let at = self.at(before);
            let arrives = arrives * self.seen(scene, before, at) * self.in_cone(at, shadow_filter);
            return self.in_cookie(face).map_or([arrives; 3], |rgb| rgb.map(|v| v * arrives));
        };
        let parts = ALONG_FACE[usize::from(off[0].hypot(off[1]) < FAR)];
        let point = |part| {
            let along = (part as f32 + 0.5) / parts as f32 - 0.5;
            place(0.5 + OUTSIDE_OF_WALL, along)
        };
        let arrives_at = |at: [f32; 2]| {
            let angle = self.at(at);
            let share = self.in_cone(angle, shadow_filter);
            let falls = share * lamp.falloff.at(at[0].hypot(at[1]), lamp);
            if falls > 0.0 {
                falls * mean_cosine(solid, scene.grid, self.disc(angle), at, normal)
            } else {
                0.0
            }
        };
        let per_part = PI / parts as f32;
        if lamp.cookie.is_none() {
            return [per_part * (0..parts).map(|part| arrives_at(point(part))).sum::<f32>(); 3];
        }
        let mut sum = [0.0; 3];
        for at in (0..parts).map(point) {
            let factors = self.in_cookie(at).filter(|rgb| *rgb != [0.0; 3]);
            if let Some(rgb) = factors {
                let arrives = arrives_at(at);
                (0..3).for_each(|c| sum[c] += arrives * rgb[c]);
            }
        }
        sum.map(|v| per_part * v)
    }

    /// Returns the factors of the lamp's cookie at a place at `off`, if it has one.
    fn in_cookie(&self, off: [f32; 2]) -> Option<Rgb> {
        Some(self.lamp.cookie.as_ref()?.pixels()?.at(off, self.axis))
    }

    /// Returns the factors of the lamp's cookie at sixteen places, by channel, if it has one; 0 where `weight` is 0.
    #[inline(always)]
    pub fn in_cookie_lanes<S: Simd>(
        &self,
        off: [f32x16<S>; 2],
        weight: f32x16<S>,
    ) -> Option<[[f32; LANES]; 3]> {
        let pixels = self.lamp.cookie.as_ref().and_then(Cookie::pixels)?;
        let ([dx, dy], weight) = (off.map(|v| v.to_array()), weight.to_array());
        let mut lanes = [[0.0; LANES]; 3];
        for l in (0..LANES).filter(|&l| weight[l] > 0.0) {
            let rgb = pixels.at([dx[l], dy[l]], self.axis);
            (0..3).for_each(|c| lanes[c][l] = rgb[c]);
        }
        Some(lanes)
    }

    /// Returns the lamp as a pixel at the angle `at` sees it.
    fn disc(&self, at: f32) -> LampDisc {
        // Walls may lie between two rays.
        let clear = (self.ranges.ends[(at + 0.5) as usize][0] - NEAREST_BESIDE).max(0.0);
        LampDisc { center: self.lamp.position, radius: self.lamp.size, clear }
    }

    /// Like [`Self::seen`], for a pixel between the bounds of its ray.
    pub fn partly_seen(&self, scene: ShadowScene, off: [f32; 2], at: f32) -> SeenPart {
        let ShadowScene { grid, solid, .. } = scene;
        if let Some(solid) = solid {
            return visible(solid, grid, self.disc(at), off);
        }
        let n = self.count;
        let nearest = (at + 0.5) as usize;
        let own = if nearest >= n { nearest - n } else { nearest };
        let inverse = 1.0 / off[0].hypot(off[1]);
        let beside_ray = nearest as f32 - at;
        // What a ray beside a face misses may still stand between.
        let shadowed = self.inverse[own] > inverse
            && !(self.faces[own].is_behind(off) && grid.sees(self.place(off), self.lamp.position));
        let (mut seen, mut places) = (0.0, 0.0);
        for forward in [true, false] {
            let side = if forward { 0.5 } else { -0.5 };
            let sign = if forward { inverse } else { -inverse };
            let aside = [-off[1] * sign, off[0] * sign];
            let rim = aside.map(|v| self.spread / self.per_radian * v);
            let mut gap = |from: f32, to: f32| {
                let width = to.min(1.0) - from;
                // A pixel in the shadow of the lamp's center may still see part of the disc past the
                // wall: check for a second wall, which the center cannot see.
                if width > 0.0 && (!shadowed || self.arrives(grid, off, aside, from + 0.5 * width))
                {
                    seen += width;
                    places += side * width * (2.0 * from + width);
                }
            };
            // β up to which the fraction is known.
            let mut done = 0.0f32;
            let mut wall = false;
            let (mut i, mut before) = (own, own);
            for k in 0..=self.ranges.window[own] {
                let link = if forward { before } else { i };
                let goes_on = wall && self.ranges.joined[link];
                wall = false;
                if self.inverse[i] > inverse {
                    let width = self.width(i, inverse);
                    let middle = if forward { beside_ray } else { -beside_ray } + f32::from(k);
                    let hides_from = self.faces[i].hides_from(off, rim);
                    // A wall beside the pixel goes on past a corner, too.
                    wall = hides_from < 1.0 || (goes_on && middle >= 1.0);
                    if wall {
                        if !goes_on {
                            gap(done, ((middle - 0.5) / width).max(hides_from));
                        }
                        done = done.max((middle + 0.5) / width).max(hides_from);
                        if done >= 1.0 {
                            break;
                        }
                    }
                }
                (before, i) = (i, beside(i, n, forward));
            }
            gap(done, 1.0);
        }
        let middle = if seen > 0.0 { places / seen } else { 0.0 };
        SeenPart { fraction: 0.5 * seen, middle }
    }

    /// Returns the place of a pixel at `off` from the lamp.
    fn place(&self, off: [f32; 2]) -> [f32; 2] {
        std::array::from_fn(|a| self.lamp.position[a] + off[a])
    }

    /// Returns whether no wall stands between a pixel's side and the part β of the lamp, or between
    /// that part and the lamp's center: a lamp reaches neither through the wall that it stands at nor
    /// round the grid. `aside` is the unit vector to that side.
    fn arrives(&self, grid: &MediumGrid, off: [f32; 2], aside: [f32; 2], part: f32) -> bool {
        let (center, pixel) = (self.lamp.position, self.place(off));
        let part = part * self.spread / self.per_radian;
        let part = std::array::from_fn(|a| center[a] + part * aside[a]);
        // Half a px to the side is within the pixel in every direction.
        let from = std::array::from_fn(|a| pixel[a] + 0.5 * aside[a]);
        let round = grid.contains(center) && !grid.contains(part);
        !round && grid.sees(from, part) && grid.sees(center, part)
    }

    /// Returns the mean direction from a pixel at `off` towards a part of the lamp, by the middle of that part; shorter
    /// than 1, as directions to a disc differ, and weighted by the elevation of the lamp's light; `tangent` is that of the
    /// elevation of all light.
    pub fn direction(&self, off: [f32; 2], middle: f32, tangent: f32) -> [f32; 2] {
        let distance = off[0].hypot(off[1]);
        if distance == 0.0 {
            return [0.0; 2];
        }
        // Over the disc: ⟨cos φ⟩ = ⟨1/√(1 + β²k²)⟩ = asinh(k)/k, β even from −1 to 1.
        let k = self.lamp.size / distance;
        let mean_cosine = if k < SMALL { 1.0 - k * k / 6.0 } else { k.asinh() / k };
        let part = middle * k;
        let way = [-off[0] - part * off[1], -off[1] + part * off[0]];
        let length = way[0].hypot(way[1]);
        let weight = mean_cosine * elevation::of_lamp(&self.lamp, distance, tangent);
        way.map(|v| v / length * weight)
    }

    /// Returns the transmittance of media up to a pixel at `off` from the lamp, `at` its angle in rays.
    pub fn transmittance(
        &self,
        scene: ShadowScene,
        off: [f32; 2],
        at: f32,
        shadow_filter: ShadowFilter,
    ) -> Rgb {
        let distance = off[0].hypot(off[1]);
        let through = self.through(at, distance, shadow_filter);
        if !self.exact || distance == 0.0 {
            return through;
        }
        let n = self.count as f32;
        let farther = distance.max(self.lamp.size);
        let seen_under = self.lamp.size / farther;
        let differs = |angle: f32, up_to: f32| {
            let middle = self.through(at, up_to, shadow_filter);
            [-angle, angle].into_iter().any(|angle| {
                let at = (at + angle * self.per_radian).rem_euclid(n).min(n - 1.0);
                are_uneven(self.through(at, up_to, shadow_filter), middle)
            })
        };
        // Right beside the lamp only up to where a ray leaves the triangle between lamp and pixel.
        let beside = self.lamp.size / (FARTHEST.sin() + seen_under * FARTHEST.cos());
        // Rays end at walls, so in a penumbra they do not know all media.
        let is_known = [at as usize, at as usize + 1]
            .iter()
            .all(|ray| self.curves.optical_depth(ray % self.count, distance).is_some());
        let varies = !is_known
            || distance >= self.ranges.ends[(at + 0.5) as usize][0]
            || PARTS.iter().any(|part| differs((part * seen_under).min(FARTHEST), farther))
            || differs(FARTHEST, beside);
        if !varies {
            // The way to the rim of the lamp is longer: by ½·(√(1 + k²) + asinh(k)/k) in the mean.
            let k = self.lamp.size / distance.max(f32::MIN_POSITIVE);
            let longer = 0.5 * (k.hypot(1.0) + k.asinh() / k);
            return if k < SMALL { through } else { through.map(|t| t.powf(longer)) };
        }
        let found = scene
            .solid
            .and_then(|solid| through_media_to_lamp(solid, scene.grid, self.disc(at), off));
        found.unwrap_or(through)
    }

    /// Returns the transmittance of media along the rays of an angle.
    fn through(&self, at: f32, distance: f32, shadow_filter: ShadowFilter) -> Rgb {
        let ray = |i: usize| {
            self.curves.transmittance(if i >= self.count { i - self.count } else { i }, distance)
        };
        if shadow_filter == ShadowFilter::Nearest {
            return ray((at + 0.5) as usize);
        }
        let first = at as usize;
        let (a, b, weight) = (ray(first), ray(first + 1), at - first as f32);
        std::array::from_fn(|c| a[c] + (b[c] - a[c]) * weight)
    }

    /// Returns whether the lamp does not shine all round.
    pub fn has_cone(&self) -> bool {
        self.lamp.cone.is_some()
    }

    /// Returns whether one of sixteen pixels may be in the cone.
    #[inline(always)]
    pub fn may_be_in_cone<S: Simd>(&self, [dx, dy]: [f32x16<S>; 2], distance: f32x16<S>) -> bool {
        let ([x, y], cosine) = self.beam;
        let along = dx * x + dy * y;
        along.simd_ge(distance * cosine).to_bitmask() != 0
    }

    /// Returns the intensity of the cone at a pixel.
    pub fn in_cone(&self, at: f32, shadow_filter: ShadowFilter) -> f32 {
        let Some(cone) = self.lamp.cone else { return 1.0 };
        if self.exact {
            return cone.share(at / self.per_radian);
        }
        if shadow_filter == ShadowFilter::Nearest {
            return self.cone[(at + 0.5) as usize];
        }
        let first = at as usize;
        self.cone[first] + (self.cone[first + 1] - self.cone[first]) * (at - first as f32)
    }

    /// [`Self::in_cone`] for sixteen pixels.
    #[inline(always)]
    pub fn in_cone_lanes<S: Simd>(
        &self,
        simd: S,
        at: f32x16<S>,
        shadow_filter: ShadowFilter,
    ) -> f32x16<S> {
        let even = self.lamp.cone.filter(|cone| cone.profile.is_none());
        let (Some(cone), true) = (even, self.exact) else {
            return f32x16::from_fn(simd, |l| self.in_cone(at[l], shadow_filter));
        };
        let half = 0.5 * cone.angle;
        let turned = (at * (1.0 / self.per_radian) - cone.direction.rem_euclid(TAU)).abs();
        let inside = -turned.min(-turned + TAU) + half;
        let soft = cone.softness * half;
        let t = (inside * (1.0 / soft.max(f32::EPSILON))).max(0.0).min(1.0);
        // As in [`Cone::share`]: the edge itself is inside.
        inside.simd_ge(soft).select(f32x16::splat(simd, 1.0), t * t * (t * -2.0 + 3.0))
    }

    /// Returns whether a wall in one of these rows may be in reach.
    pub fn reaches_rows(&self, rows: &Range<usize>) -> bool {
        let (y, reach) = (self.lamp.position[1], self.reach + 1.0);
        y + reach >= rows.start as f32 && y - reach <= rows.end as f32
    }

    /// Returns the offset of a wall from the lamp; `None` if no face of it is in reach.
    pub fn reaches(&self, center: [f32; 2]) -> Option<[f32; 2]> {
        let off: [f32; 2] = std::array::from_fn(|a| center[a] - self.lamp.position[a]);
        // A face lies up to a px from its cell's center, and so does the cell before it.
        let reach = self.reach + 1.0;
        (off[0].abs() <= reach && off[0] * off[0] + off[1] * off[1] <= reach * reach).then_some(off)
    }

    /// Returns the angle of an offset from the lamp, in rays, 0 to `count`.
    pub fn at(&self, [dx, dy]: [f32; 2]) -> f32 {
        let at = dy.atan2(dx) * self.per_radian;
        if at < 0.0 { at + self.count as f32 } else { at }
    }

    /// Returns the number of rays per radian.
    pub fn per_radian(&self) -> f32 {
        self.per_radian
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::medium_grid::Reading;
    use crate::{Cells, Cone};

    #[test]
    fn no_pixel_of_a_cone_is_passed_over() {
        let seed = fastrand::u64(..);
        println!("seed {seed}");
        let mut random = fastrand::Rng::with_seed(seed);
        let mut grid = MediumGrid::default();
        grid.read(&Cells::new(2048, 8).unwrap(), Reading::default());
        let mut solid = SolidBits::default();
        solid.read(&grid);
        for _ in 0..200 {
            let angle = random.choice([1e-3, 0.02, 1.0, 3.0, 6.0, 6.25, TAU]).unwrap();
            let any = random.f32() * TAU;
            let direction = random.choice([0.0, 1e-4, PI, any]).unwrap();
            let cone = Some(Cone { direction, angle, softness: 0.0, profile: None });
            let lamp = Lamp { position: [4.5, 4.5], range: 2048.0, cone, ..Lamp::default() };
            let exact = random.bool().then_some(&solid);
            let scene = ShadowScene { grid: &grid, solid: exact, masks: None };
            let mut map = ShadowMap::default();
            let level = Level::new();
            map.trace(level, &lamp, scene, &[], &Polar::default());
            for _ in 0..200 {
                let any = random.f32() - 0.5;
                let beside = random.choice([0.0, 0.499, 0.5, 0.501, any]).unwrap();
                let (sine, cosine) = (direction + beside * angle).sin_cos();
                let off: [_; LANES] = std::array::from_fn(|_| {
                    let distance = 2000.0 * random.f32();
                    [distance * cosine, distance * sine]
                });
                let [lights, passes] = dispatch!(level, simd => {
                    let offs = [0, 1].map(|a| f32x16::from_fn(simd, |l| off[l][a]));
                    let distance = (offs[0] * offs[0] + offs[1] * offs[1]).sqrt();
                    let at = f32x16::from_fn(simd, |l| map.at(off[l]));
                    let share = map.in_cone_lanes(simd, at, ShadowFilter::Soft);
                    [share.simd_gt(0.0).to_bitmask() != 0, !map.may_be_in_cone(offs, distance)]
                });
                assert!(!(lights && passes), "{cone:?} is passed over at {off:?}");
            }
        }
    }
}
