//! The shadow map of a sun: parallel rays, side by side, and their lookup by pixels.
//!
//! A pixel lies `across` px along the line that the rays start from, and `along` px behind it. Its ray is lit up to
//! its first wall, as in the map of a lamp. A sun of apparent width w is seen from a pixel under the angles φ from
//! −w/2 to w/2 beside the ray; what walls hide of them is found exactly for pixels in a penumbra:
//!
//! `J = (L/2π)·∫V(φ) dφ·⟨T⟩`, and on a face `E/2 = (L/2)·∫V(φ) cosθ dφ·⟨T⟩`

use super::lit_ranges::LitRanges;
use super::penumbra::{
    EVEN, Fan, Hidden, LightPart, are_uneven, differ, hide_behind_walls, through_media_or_gap,
};
use super::shadow_map::{NEAREST_BESIDE, OUTSIDE_OF_WALL, ShadowScene};
use super::transmittance_curve::TransmittanceCurves;
use crate::grid::cast::RayHit;
use crate::grid::class::CellClass;
use crate::math::transmittance::transmittance;
use crate::{Rgb, Sun, elevation};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2};

/// Rays per px.
const DENSITY: f32 = 1.0;
/// The most by which the light reaches farther between two rays, where the cells that they hit touch: a cell's diagonal, px.
const NOTCH: f32 = 1.5;
/// Points along a face at which its light is found.
const ALONG_FACE: usize = 3;
/// Fewest distances between rays by which media before a pixel are known.
const FEWEST: usize = 3;
/// The largest bend of transmittance from the middle of the sun to its edges of which the mean is known well enough.
const GENTLE: f32 = 6.0 * EVEN;

/// The shadow map of one sun.
#[derive(Debug, Default)]
pub struct SunMap {
    sun: Sun,
    /// Unit vectors across the rays, and the way that its light travels.
    across: [f32; 2],
    travels: [f32; 2],
    /// The place of the first ray across, and of the starts of all along.
    start: [f32; 2],
    /// Length of the rays, px.
    reach: f32,
    /// tan(w/2).
    slope: f32,
    hits: Vec<RayHit>,
    ranges: LitRanges,
    curves: TransmittanceCurves,
}

/// The part of a sun that a place sees.
enum SeenOfSun {
    All,
    Nothing,
    Part(Hidden),
}

impl SunMap {
    /// Casts the rays of a sun.
    pub fn trace(&mut self, sun: &Sun, scene: ShadowScene) {
        let grid = scene.grid;
        let (sin, cos) = sun.direction.sin_cos();
        self.sun = *sun;
        (self.travels, self.across) = ([cos, sin], [-sin, cos]);
        self.slope = (0.5 * sun.angle).tan();
        let [w, h] = grid.size.map(|side| side as f32);
        let corners = [[0.0, 0.0], [w, 0.0], [0.0, h], [w, h]];
        let range = |way: [f32; 2]| {
            let at = corners.map(|[x, y]| x * way[0] + y * way[1]);
            [
                at.iter().copied().fold(f32::INFINITY, f32::min),
                at.into_iter().fold(f32::NEG_INFINITY, f32::max),
            ]
        };
        let ([left, right], [near, far]) = (range(self.across), range(self.travels));
        self.reach = far - near;
        // Rays beside the grid, so that the last is not beside the first, and all that a pixel asks for are there.
        let beside = (self.reach * self.slope * DENSITY).ceil() + 3.0;
        // Half a px on, so that the rays of a sun along an axis go through the middles of cells.
        self.start = [left - (beside - 0.5) / DENSITY, near];
        let count = ((right - left) * DENSITY + 2.0 * beside).ceil() as usize + 1;
        self.curves.clear(self.reach);
        self.hits.clear();
        for ray in 0..count {
            self.curves.next_ray();
            let across = self.start[0] + ray as f32 / DENSITY;
            let from = [0, 1].map(|a| across * self.across[a] + near * self.travels[a]);
            let curves = &mut self.curves;
            self.hits.push(grid.cast(from, self.travels, self.reach, false, |step, cell| {
                if grid.classes[cell] == CellClass::Medium {
                    curves.medium(step.span, grid.extinction[cell]);
                }
            }));
        }
        self.curves.next_ray();
        let (reach, slope, hits) = (self.reach, self.slope, &self.hits);
        let shades = |ray: usize| (reach - hits[ray].length).max(0.0) * slope * DENSITY + 1.5;
        self.ranges.find(grid, hits, |_| true, shades, shades);
    }

    /// The layers that it lights.
    pub fn mask(&self) -> u8 {
        self.sun.mask
    }

    /// The factor on the first moment of its light, by its elevation and the tangent of that of all light.
    pub fn moment_weight(&self, tangent: f32) -> f32 {
        elevation::of_sun(&self.sun, tangent)
    }

    /// Returns the place of a point: its ray, and its distance along it.
    fn place(&self, [x, y]: [f32; 2]) -> (f32, f32) {
        let across = x * self.across[0] + y * self.across[1];
        let along = x * self.travels[0] + y * self.travels[1];
        ((across - self.start[0]) * DENSITY, along - self.start[1])
    }

    fn fan(&self, pixel: [f32; 2], (at, along): (f32, f32)) -> Fan {
        let clear = self.ranges.ends[(at + 0.5) as usize][0];
        Fan {
            pixel,
            ahead: self.travels.map(|v| -v),
            distance: f32::INFINITY,
            slope: self.slope,
            half_width: along * self.slope,
            until: (along - clear + NEAREST_BESIDE).clamp(0.0, along.max(0.0)),
        }
    }

    fn seen(&self, scene: ShadowScene, pixel: [f32; 2], place: (f32, f32)) -> SeenOfSun {
        let (at, along) = place;
        let [lit, dark] = self.ranges.ends[(at + 0.5) as usize];
        // Between two rays walls come nearer, and recede into notches.
        if along < lit - NEAREST_BESIDE {
            return SeenOfSun::All;
        }
        let is_behind = along >= dark + NOTCH;
        let Some(solid) = scene.solid.filter(|_| !is_behind) else { return SeenOfSun::Nothing };
        let mut hidden = Hidden::default();
        hide_behind_walls(solid, &self.fan(pixel, place), &mut hidden);
        if hidden.parts().is_empty() { SeenOfSun::All } else { SeenOfSun::Part(hidden) }
    }

    /// Returns the mean radiance that an open cell receives, and the mean direction that it comes from.
    pub fn at(&self, scene: ShadowScene, pixel: [f32; 2]) -> (Rgb, [f32; 2]) {
        let place = self.place(pixel);
        let angle = |at: f32| (at * self.slope).atan();
        let seen = self.seen(scene, pixel, place);
        let half = 0.5 * self.sun.angle;
        // ∫dφ, ∫cosφ dφ and ∫sinφ dφ over what is seen.
        let mut seen_angle = [2.0 * half, 2.0 * half.sin(), 0.0];
        match &seen {
            SeenOfSun::Nothing => return ([0.0; 3], [0.0; 2]),
            SeenOfSun::All => {}
            SeenOfSun::Part(hidden) => {
                for part in hidden.parts() {
                    let [from, to] = part.map(angle);
                    seen_angle[0] -= to - from;
                    seen_angle[1] -= to.sin() - from.sin();
                    seen_angle[2] -= from.cos() - to.cos();
                }
            }
        }
        let [width, along, beside] = seen_angle;
        let light = self.light(scene, pixel, place, &seen, 0.5 * FRAC_1_PI * width);
        let inverse = 1.0 / width.max(f32::MIN_POSITIVE);
        let [ahead, aside] = [along, beside].map(|v| (v * inverse).clamp(-1.0, 1.0));
        let [x, y] = self.travels.map(|v| -v);
        (light, [ahead * x + aside * y, ahead * y - aside * x])
    }

    /// Returns the irradiance ÷ 2 of a face, by its middle.
    pub fn on_face(&self, scene: ShadowScene, middle: [f32; 2], normal: [f32; 2]) -> Rgb {
        let ahead = self.travels.map(|v| -v);
        let facing = normal[0] * ahead[0] + normal[1] * ahead[1];
        let turned = (normal[0] * ahead[1] - normal[1] * ahead[0]).atan2(facing);
        // ∫cosθ over the angles above the horizon, up to a point of the sun. Angles fall from −1 to 1.
        let up_to =
            |at: f32| -(turned - (at * self.slope).atan()).clamp(-FRAC_PI_2, FRAC_PI_2).sin();
        let mut sum = [0.0; 3];
        for part in 0..ALONG_FACE {
            let along = (part as f32 + 0.5) / ALONG_FACE as f32 - 0.5;
            let point =
                [0, 1].map(|a| middle[a] + OUTSIDE_OF_WALL * normal[a] + along * normal[1 - a]);
            let place = self.place(point);
            let whole = up_to(1.0) - up_to(-1.0);
            let seen = self.seen(scene, point, place);
            let received = match &seen {
                _ if whole <= 0.0 => continue,
                SeenOfSun::Nothing => continue,
                SeenOfSun::All => whole,
                SeenOfSun::Part(hidden) => {
                    let hides = |&[from, to]: &[f32; 2]| up_to(to) - up_to(from);
                    whole - hidden.parts().iter().map(hides).sum::<f32>()
                }
            };
            let light = self.light(scene, point, place, &seen, 0.5 * received / ALONG_FACE as f32);
            (0..3).for_each(|c| sum[c] += light[c]);
        }
        sum
    }

    /// Returns light of the sun's radiance, times a factor, through media.
    fn light(
        &self,
        scene: ShadowScene,
        pixel: [f32; 2],
        place: (f32, f32),
        seen: &SeenOfSun,
        factor: f32,
    ) -> Rgb {
        // Rounding may leave less than nothing.
        let factor = factor.max(0.0);
        let light = self.sun.radiance().map(|v| v * factor);
        if factor == 0.0 || self.curves.is_empty() {
            return light;
        }
        // Rays end at walls, so in a penumbra they do not know all media.
        let by_map = match seen {
            SeenOfSun::All => self.transmittance(place),
            _ => None,
        };
        let gap = || match seen {
            SeenOfSun::Part(hidden) => Some(hidden.widest_gap()),
            _ => None,
        };
        let through = by_map
            .or_else(|| {
                through_media_or_gap(scene.grid, &self.fan(pixel, place), LightPart::WHOLE, gap)
            })
            .unwrap_or_else(|| self.through(place.0, place.1));
        [0, 1, 2].map(|c| light[c] * through[c])
    }

    /// Returns the mean transmittance of media before the whole sun by the rays of the map; `None` unless the optical
    /// depths of all rays beside the pixel are a parabola.
    fn transmittance(&self, (at, along): (f32, f32)) -> Option<Rgb> {
        let beside = along.max(0.0) * self.slope * DENSITY;
        // Two rays more to either side: what lies between two is met by one of them, as cells are wider than rays are
        // apart. A wall beside the fan may end the outermost.
        let (nearest, half) = ((at + 0.5) as usize, (beside + 0.5).ceil() as usize + 1);
        let ends = |ray: usize| usize::from(self.hits[ray].length < along);
        let (first, last) = (nearest.checked_sub(half)?, nearest + half);
        let (first, last) = (first + ends(first), last - ends(last));
        if last - first < FEWEST {
            return None;
        }
        let depth = |ray: usize| self.curves.optical_depth(ray, along);
        let middle = (first + last) / 2;
        let [a, b, c] = [depth(first)?, depth(middle)?, depth(last)?];
        let [left, right] = [middle - first, last - middle].map(|rays| 1.0 / rays as f32);
        let width = 1.0 / (last - first) as f32;
        let parabola = |at: f32| {
            let off = at - middle as f32;
            [0, 1, 2].map(|k| {
                let slopes = [(b[k] - a[k]) * left, (c[k] - b[k]) * right];
                let bend = (slopes[1] - slopes[0]) * width;
                // Before the first medium it may fall below 0.
                (b[k] + off * (slopes[0] + bend * (at - first as f32))).max(0.0)
            })
        };
        let is_smooth = (first..=last).all(|ray| {
            depth(ray).is_some_and(|depth| {
                let smooth = parabola(ray as f32);
                // Transmittances differ by less than depths.
                !differ(depth, smooth, EVEN)
                    || !are_uneven(depth.map(transmittance), smooth.map(transmittance))
            })
        });
        let through = |at: f32| parabola(at).map(transmittance);
        let [left, own, right] = [at - beside, at, at + beside].map(through);
        // What changes evenly from side to side has the mean of the middle: only the bend counts.
        let bend = [0, 1, 2].map(|k| 0.5 * (left[k] + right[k]) - own[k]);
        // The mean of a parabola is a third of its bend; half of that, as media near the pixel bend less.
        (is_smooth && !differ(bend, [0.0; 3], GENTLE))
            .then(|| [0, 1, 2].map(|k| own[k] + bend[k] / 6.0))
    }

    /// Returns the transmittance of media along the rays beside a place.
    fn through(&self, at: f32, along: f32) -> Rgb {
        let at = at.clamp(0.0, self.hits.len() as f32 - 1.001);
        let (first, weight) = (at as usize, at.fract());
        let [a, b] = [first, first + 1].map(|ray| self.curves.transmittance(ray, along));
        [0, 1, 2].map(|c| a[c] + (b[c] - a[c]) * weight)
    }
}
