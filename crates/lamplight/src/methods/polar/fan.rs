//! Pass A: the fan of rays of one lamp, and what a pixel reads from it.
//!
//! Ray i leaves at the angle 2πi/count and keeps how far it comes. A pixel at distance d is lit by a
//! ray that comes farther. For soft edges the neighbours count too: in the plane of angle and 1/r
//! the lines from a pixel to the points of a lamp of radius s are straight, so a wall met at
//! distance ℓ, Δ radians beside the pixel, hides the point at `β = Δ / (s·(1/ℓ − 1/d))` of the way
//! from the lamp's middle to its rim. (The angles are taken for small: their sine for themselves.)
//! The share of β from −1 to 1 that no ray hides is the share of the lamp that is seen.

use super::knots::Knots;
use crate::settings::{Edges, Polar, Walk};
use crate::stages::circle;
use crate::stages::ground::{Ground, Hit, Kind, LANES};
use crate::{Lamp, Rgb};
use fearless_simd::{Level, dispatch};
use rayon::prelude::*;
use std::f32::consts::TAU;

/// Fewest rays of a lamp.
const FEWEST: f32 = 8.0;
/// Most rays of a lamp: reached by ranges over 40 000 px only.
const MOST: f32 = (1 << 18) as f32;
/// Penumbrae are at most so many rays wide to either side, so that a pixel's cost is bounded.
pub const WIDEST: f32 = 64.0;
/// Penumbrae are at least so many rays wide, which makes an edge linear between two rays.
pub const NARROWEST: f32 = 0.5;
/// px under which a wall is not nearer, so that 1/length is finite.
pub const NEAREST: f32 = 1e-3;
/// Rays that a thread walks at a time.
const TOGETHER: usize = 128;

/// The rays of one lamp.
#[derive(Debug, Default)]
pub struct Fan {
    pub lamp: Lamp,
    /// px that its light comes within the grid.
    pub reach: f32,
    pub count: usize,
    /// What rays that were walked together met; `None` for those that have to be walked alone.
    walked: Vec<Option<Hit>>,
    hits: Vec<Hit>,
    /// 1/length of each ray, 0 where it met nothing.
    inverse: Vec<f32>,
    /// Whether this ray and the next hit what touches: a wall, without a gap between them.
    joined: Vec<bool>,
    /// A pixel nearer than the first is fully lit, one from the second on fully dark; one ray more
    /// at the end, the first again.
    pub bounds: Vec<[f32; 2]>,
    /// How many rays to either side have a say between the bounds.
    window: Vec<u8>,
    /// Share of the cone at each ray, with two rays more; empty without a cone.
    pub cone: Vec<f32>,
    pub knots: Knots,
    /// Rays over radians.
    per_radian: f32,
    /// Radius of the lamp in rays × px, 0 for edges that are not soft.
    spread: f32,
}

/// How far the rays of a lamp go within a grid of so many columns and rows, px, and how many there are.
pub fn rays(lamp: &Lamp, [width, height]: [u32; 2], settings: &Polar) -> (f32, usize) {
    let [x, y] = lamp.position;
    let farthest =
        x.abs().max((width as f32 - x).abs()).hypot(y.abs().max((height as f32 - y).abs()));
    // A px more: the circle has to reach past the farthest corner's centre.
    let reach = lamp.range.min(farthest + 1.0);
    let count = (TAU * reach * settings.density).ceil().clamp(FEWEST, MOST);
    (reach, count as usize)
}

/// The next of n rays in a circle, forwards or backwards.
#[inline(always)]
fn beside(ray: usize, n: usize, forward: bool) -> usize {
    match forward {
        true if ray + 1 == n => 0,
        true => ray + 1,
        false if ray == 0 => n - 1,
        false => ray - 1,
    }
}

impl Fan {
    /// px that a ray comes.
    pub fn length(&self, ray: usize) -> f32 {
        self.hits[ray].length
    }

    /// Bytes that the fan of a lamp may take.
    pub fn most_bytes(lamp: &Lamp, ground: &Ground, settings: &Polar) -> usize {
        const RAY: usize = size_of::<Hit>()
            + size_of::<Option<Hit>>()
            + size_of::<[f32; 4]>()
            + size_of::<[u8; 2]>();
        let (reach, count) = rays(lamp, ground.size(), settings);
        let media = if ground.has_media() { Knots::most_bytes(reach) } else { 0 };
        count.saturating_mul(RAY + media)
    }

    /// Walks the rays of a lamp.
    pub fn trace(
        &mut self,
        level: Level,
        lamp: &Lamp,
        ground: &Ground,
        distance: &[f32],
        settings: &Polar,
    ) {
        self.lamp = Lamp { falloff: settings.falloff.unwrap_or(lamp.falloff), ..*lamp };
        (self.reach, self.count) = rays(lamp, ground.size(), settings);
        self.per_radian = self.count as f32 / TAU;
        let size = if settings.edges == Edges::Soft { lamp.size } else { 0.0 };
        self.spread = size * self.per_radian;
        let (count, reach) = (self.count, self.reach);
        let angle = |ray: usize| circle::angle(ray as u32, count as u32);
        let direction = |ray: usize| circle::direction(ray as u32, count as u32);

        self.cone.clear();
        if let Some(cone) = lamp.cone {
            self.cone.extend((0..count + 2).map(|ray| cone.share(angle(ray % count))));
        }
        let cone = &self.cone;
        let dark = |ray: usize| cone.get(ray) == Some(&0.0);
        self.walked.resize(count, None);
        let together = settings.walk == Walk::Edge;
        self.walked.par_chunks_mut(TOGETHER).enumerate().for_each(|(chunk, hits)| {
            let first = chunk * TOGETHER;
            for (i, hits) in hits.chunks_mut(LANES).enumerate() {
                let first = first + i * LANES;
                if !together {
                    hits.fill(None);
                } else if !(first..first + hits.len()).all(dark) {
                    let directions = std::array::from_fn(|l| direction(first + l));
                    let walked = dispatch!(level, simd => {
                        ground.walk_together(simd, lamp.position, &directions, reach)
                    });
                    hits.copy_from_slice(&walked[..hits.len()]);
                }
            }
        });
        self.knots.clear(reach);
        self.hits.clear();
        for (ray, walked) in self.walked.iter().enumerate() {
            self.knots.next_ray();
            let (from, way, knots) = (lamp.position, direction(ray), &mut self.knots);
            let medium = |span, cell: usize| {
                if ground.kinds()[cell] == Kind::Medium {
                    knots.medium(span, ground.log(cell));
                }
            };
            self.hits.push(match (walked, settings.walk) {
                _ if dark(ray) => Hit::NONE,
                (Some(hit), _) => *hit,
                (None, Walk::Edge) => ground.walk(from, way, reach, false, medium),
                (None, Walk::Step) => ground.sample(from, way, reach, |_| 1.0, medium),
                (None, Walk::Distance) => {
                    let leap = |cell| ground.leap(distance, cell);
                    ground.sample(from, way, reach, leap, medium)
                }
            });
        }
        self.knots.next_ray();
        self.inverse.clear();
        self.inverse.extend(self.hits.iter().map(|hit| 1.0 / hit.length.max(NEAREST)));
        self.bound(ground, settings.edges);
    }

    /// Works out between which distances a pixel on each ray has to look closer.
    fn bound(&mut self, ground: &Ground, edges: Edges) {
        let n = self.count;
        self.bounds.clear();
        self.bounds.extend(self.hits.iter().map(|hit| [hit.length; 2]));
        if edges != Edges::Nearest {
            self.joined.clear();
            let cell = |ray: usize| self.hits[ray].cell;
            self.joined.extend((0..n).map(|i| ground.touch(cell(i), cell(beside(i, n, true)))));
            self.window.clear();
            self.window.resize(n, 0);
            for ray in 0..n {
                if self.inverse[ray] > 0.0 {
                    self.shade(ray);
                }
                self.bounds[ray][1] = self.dark_from(ray);
            }
        }
        self.bounds.push(self.bounds[0]);
    }

    /// Half width, in rays, of the penumbra that a ray's wall throws at 1/d.
    #[inline(always)]
    fn width(&self, ray: usize, inverse: f32) -> f32 {
        (self.spread * (self.inverse[ray] - inverse)).clamp(NARROWEST, WIDEST)
    }

    /// Where the penumbra of this ray's wall is widest.
    fn widest(&self, ray: usize) -> f32 {
        self.width(ray, 1.0 / self.reach)
    }

    /// Tells the neighbours of a ray of its wall.
    fn shade(&mut self, ray: usize) {
        let n = self.count;
        // Half a ray for the pixel beside its ray, half for the width of the ray itself.
        let reach = ((self.widest(ray) + 1.0) as usize).min((n - 1) / 2);
        let length = self.hits[ray].length;
        let mut i = (ray + n - reach) % n;
        for k in 0..=2 * reach {
            self.bounds[i][0] = self.bounds[i][0].min(length);
            self.window[i] = self.window[i].max(k.abs_diff(reach) as u8);
            i = beside(i, n, true);
        }
    }

    /// The distance from which a pixel on a ray sees nothing of the lamp: walls without a gap to
    /// either side, as far as its penumbra reaches.
    fn dark_from(&self, ray: usize) -> f32 {
        let n = self.count;
        let mut far = self.hits[ray].length;
        for forward in [true, false] {
            let mut i = ray;
            for k in 0.. {
                if self.inverse[i] == 0.0 {
                    return f32::INFINITY;
                }
                far = far.max(self.hits[i].length);
                if k as f32 >= self.widest(i) {
                    break;
                }
                let next = beside(i, n, forward);
                if !self.joined[if forward { i } else { next }] {
                    return f32::INFINITY;
                }
                i = next;
            }
        }
        far
    }

    /// Share of the lamp that a pixel sees; `off` is its place beside the lamp, `at` its angle in
    /// rays, 0 to `count`.
    pub fn seen(&self, ground: &Ground, off: [f32; 2], at: f32) -> f32 {
        let distance = off[0].hypot(off[1]);
        let [lit, dark] = self.bounds[(at + 0.5) as usize];
        match () {
            () if distance < lit => 1.0,
            () if distance >= dark => 0.0,
            () => self.partly_seen(ground, off, at),
        }
    }

    /// The same for a pixel between its ray's bounds.
    pub fn partly_seen(&self, ground: &Ground, off: [f32; 2], at: f32) -> f32 {
        let n = self.count;
        let nearest = (at + 0.5) as usize;
        let own = if nearest >= n { nearest - n } else { nearest };
        let inverse = 1.0 / off[0].hypot(off[1]);
        let beside_ray = nearest as f32 - at;
        let shadowed = self.inverse[own] > inverse;
        let mut seen = 0.0;
        for forward in [true, false] {
            let mut gap = |from: f32, to: f32| {
                let width = to.min(1.0) - from;
                // Who is in the shadow of the lamp's middle has to look whether the light that gets
                // past its wall is not stopped by another that the lamp's middle does not see.
                if width > 0.0
                    && (!shadowed || self.arrives(ground, off, from + 0.5 * width, forward))
                {
                    seen += width;
                }
            };
            // β up to which is settled.
            let mut done = 0.0f32;
            let mut wall = false;
            let (mut i, mut before) = (own, own);
            for k in 0..=self.window[own] {
                let link = if forward { before } else { i };
                if self.inverse[i] > inverse {
                    let width = self.width(i, inverse);
                    let middle = if forward { beside_ray } else { -beside_ray } + f32::from(k);
                    if !(wall && self.joined[link]) {
                        gap(done, (middle - 0.5) / width);
                    }
                    done = done.max((middle + 0.5) / width);
                    if done >= 1.0 {
                        break;
                    }
                    wall = true;
                } else {
                    wall = false;
                }
                (before, i) = (i, beside(i, n, forward));
            }
            gap(done, 1.0);
        }
        0.5 * seen
    }

    /// Whether nothing stands between a pixel's side and the part β of the lamp, or between that and
    /// the lamp's middle: a lamp reaches neither through the wall that it stands at nor round the
    /// grid.
    fn arrives(&self, ground: &Ground, off: [f32; 2], part: f32, forward: bool) -> bool {
        let turn = if forward { 1.0 } else { -1.0 } / off[0].hypot(off[1]);
        let aside = [-off[1] * turn, off[0] * turn];
        let middle = self.lamp.position;
        let part = part * self.spread / self.per_radian;
        let part = std::array::from_fn(|a| middle[a] + part * aside[a]);
        // Half a px aside is within the pixel, whatever the direction.
        let from = std::array::from_fn(|a| middle[a] + off[a] + 0.5 * aside[a]);
        let round = ground.contains(middle) && !ground.contains(part);
        !round && ground.sees(from, part) && ground.sees(middle, part)
    }

    /// Share of light that fog and glass let through to a pixel.
    pub fn through(&self, at: f32, distance: f32, edges: Edges) -> Rgb {
        let ray = |i: usize| {
            self.knots.through(if i >= self.count { i - self.count } else { i }, distance)
        };
        if edges == Edges::Nearest {
            return ray((at + 0.5) as usize);
        }
        let first = at as usize;
        let (a, b, share) = (ray(first), ray(first + 1), at - first as f32);
        std::array::from_fn(|c| a[c] + (b[c] - a[c]) * share)
    }

    /// Share of the cone at a pixel.
    pub fn in_cone(&self, at: f32, edges: Edges) -> f32 {
        if self.cone.is_empty() {
            return 1.0;
        }
        if edges == Edges::Nearest {
            return self.cone[(at + 0.5) as usize];
        }
        let first = at as usize;
        self.cone[first] + (self.cone[first + 1] - self.cone[first]) * (at - first as f32)
    }

    /// The angle of a place beside the lamp, in rays, 0 to `count`.
    pub fn at(&self, [dx, dy]: [f32; 2]) -> f32 {
        let at = dy.atan2(dx) * self.per_radian;
        if at < 0.0 { at + self.count as f32 } else { at }
    }

    /// Rays over radians.
    pub fn per_radian(&self) -> f32 {
        self.per_radian
    }
}
