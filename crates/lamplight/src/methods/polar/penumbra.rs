//! The visible part of a light, exactly: what no solid cell hides of it.
//!
//! From a pixel the disc of radius R of a lamp at distance d is taken for the segment through its centre, across the
//! line of sight; its point β lies β·R beside the centre, β from −1 to 1. A sun of angle w is such a segment at
//! infinity, with `R/d = tan(w/2)`. A corner of a cell, `a` px ahead of the pixel and `s` px beside the line of
//! sight, hides what lies behind it at `β = s·d/(a·R)`. So a cell hides the interval between its outermost corners,
//! and what is left of −1 to 1 after all cells in the triangle between pixel and segment is seen.
//!
//! Parts of the segment of a lamp that the lamp's centre does not see lie behind a wall or beyond the border of the grid.
//! They are dark, so that no light goes round the walls, and the part that the centre sees stands for the whole: a lamp
//! beside a wall is as bright as one in the open.

use super::solid_bits::{BLOCK, SolidBits};
use crate::Rgb;
use crate::grid::cast::RayHit;
use crate::grid::class::CellClass;
use crate::grid::medium_grid::MediumGrid;
use crate::math::transmittance::transmittance;

/// Intervals that are this near in β belong to one wall: cells that touch share a corner, but for rounding.
const TOUCHING: f32 = 1e-4;
/// Distance ahead of the pixel from which on cells are in its way, px.
const AHEAD: f32 = 1e-6;
/// β of corners beside and behind the pixel: far outside of the disc.
const OUTSIDE: f32 = 1e6;
/// The smallest part of a lamp, −1 to 1, that may stand for the whole.
const SMALLEST_PART: f32 = 1e-3;
/// Steps from the middle of a lamp to its rim in which the part is told apart before which media count.
const STEPS: f32 = 256.0;
/// Points across the lamp at which cosines are taken.
const POINTS: usize = 16;
/// Fewest and most points across a light to which rays are cast through media, one per px.
const RAYS: [usize; 2] = [8, 48];
/// Half the width of a fan that five rays do not leave a pane of 2 px between them, px.
const NARROW: f32 = 4.0;
/// Rays in place of one where media differ from those before a point beside it.
const FINER: usize = 4;
/// The difference of transmittance from which on they differ.
const DIFFERENT: f32 = 0.05;
/// The difference of transmittance up to which media are even.
pub const EVEN: f32 = 0.003;
/// Most gaps between walls that are told apart.
const GAPS: usize = 16;

/// The hidden parts of a light, −1 to 1.
#[derive(Default)]
pub struct Hidden {
    parts: [[f32; 2]; GAPS],
    count: usize,
    /// The part of a lamp that its centre sees. The rest is hidden, too.
    stands: LightPart,
}

impl Hidden {
    /// Hides an interval.
    #[inline(always)]
    fn add(&mut self, from: f32, to: f32) {
        let (mut from, mut to) = (from.max(-1.0), to.min(1.0));
        if from >= to {
            return;
        }
        let mut kept = 0;
        for k in 0..self.count {
            let [a, b] = self.parts[k];
            // Where there is no room for one more, it joins the last.
            let full = k + 1 == GAPS;
            if full || (a <= to + TOUCHING && b >= from - TOUCHING) {
                (from, to) = (from.min(a), to.max(b));
            } else {
                self.parts[kept] = [a, b];
                kept += 1;
            }
        }
        self.parts[kept] = [from, to];
        self.count = kept + 1;
    }

    /// Returns whether a point is hidden.
    fn holds(&self, point: f32) -> bool {
        self.parts().iter().any(|&[a, b]| (a..b).contains(&point))
    }

    /// The hidden intervals.
    pub fn parts(&self) -> &[[f32; 2]] {
        &self.parts[..self.count]
    }

    /// Returns the middle of the widest part that is seen.
    pub fn widest_gap(&self) -> f32 {
        let ends = std::iter::once(-1.0).chain(self.parts().iter().map(|part| part[1]));
        let gaps = ends.map(|from| {
            let ahead = self.parts().iter().filter(|part| part[1] > from);
            [from, ahead.fold(1.0, |to: f32, part| to.min(part[0]))]
        });
        let widest = gaps.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
        widest.map_or(0.0, |[from, to]| 0.5 * (from + to))
    }

    /// Returns whether nothing is seen.
    fn is_all(&self) -> bool {
        self.count == 1 && self.parts[0] == [-1.0, 1.0]
    }

    /// Returns the part that is seen, as a fraction of what stands for the whole.
    fn rest(&self) -> SeenPart {
        let hidden: f32 = self.parts().iter().map(|[a, b]| b - a).sum();
        let seen = (1.0 - 0.5 * hidden).max(0.0);
        // The middle of all is 0, so what is hidden and what is seen are in balance.
        let moment: f32 = self.parts().iter().map(|[a, b]| 0.25 * (b * b - a * a)).sum();
        let middle = if seen > 0.0 { -moment / seen - self.stands.middle } else { 0.0 };
        let middle = middle.clamp(-1.0, 1.0);
        SeenPart { fraction: seen / self.stands.half, middle }
    }
}

/// The part of a light that a pixel sees.
#[derive(Clone, Copy, Debug, Default)]
pub struct SeenPart {
    pub fraction: f32,
    /// The mean place of the part across the light, −1 to 1.
    pub middle: f32,
}

/// A part of a light that stands for the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightPart {
    middle: f32,
    /// Half of its width: 1 for all of the light.
    half: f32,
}

impl Default for LightPart {
    fn default() -> Self {
        Self::WHOLE
    }
}

impl LightPart {
    /// All of a light.
    pub const WHOLE: Self = Self { middle: 0.0, half: 1.0 };

    /// The part up to two ends, before and after the middle of the light.
    fn between([before, after]: [f32; 2]) -> Self {
        Self { middle: 0.5 * (after - before), half: 0.5 * (before + after) }
    }

    /// Returns the place across the light of a point across the part, −1 to 1 both.
    fn at(self, point: f32) -> f32 {
        self.middle + self.half * point
    }
}

/// The rays from a pixel to all points of a light.
#[derive(Clone, Copy)]
pub struct Fan {
    pub pixel: [f32; 2],
    /// The direction of the middle of the light.
    pub ahead: [f32; 2],
    /// The distance of the light, px; infinite for a sun.
    pub distance: f32,
    /// Half the width of the fan per px ahead.
    pub slope: f32,
    /// Half the width of the fan at its end, at the light or at the border of the grid, px.
    pub half_width: f32,
    /// The distance ahead up to which walls may be in the way, px.
    pub until: f32,
}

/// A lamp, as seen by pixels.
#[derive(Clone, Copy)]
pub struct LampDisc {
    pub center: [f32; 2],
    pub radius: f32,
    /// Distance from the centre up to which no wall is in the way, px.
    pub clear: f32,
}

impl LampDisc {
    /// Returns the rays to it from a pixel at `off`.
    pub fn fan(&self, off: [f32; 2]) -> Fan {
        let Self { center, radius, clear } = *self;
        let distance = off[0].hypot(off[1]);
        // Without the part of the triangle that no wall reaches.
        let before = (clear * clear - radius * radius).max(0.0).sqrt().min(distance);
        Fan {
            pixel: [center[0] + off[0], center[1] + off[1]],
            ahead: off.map(|v| -v / distance),
            distance,
            slope: radius / distance,
            half_width: radius,
            until: distance - before,
        }
    }
}

/// Returns the part of a lamp that a pixel sees at `off` from it, in an open cell.
pub fn visible(solid: &SolidBits, grid: &MediumGrid, lamp: LampDisc, off: [f32; 2]) -> SeenPart {
    hidden(solid, grid, lamp, off).rest()
}

/// Returns the mean of `cos θ` over a lamp as a point of a face sees it, at `off` from the lamp, just outside of the
/// wall: 0 where the lamp is hidden or below the horizon.
pub fn mean_cosine(
    solid: &SolidBits,
    grid: &MediumGrid,
    lamp: LampDisc,
    off: [f32; 2],
    normal: [f32; 2],
) -> f32 {
    let hidden = hidden(solid, grid, lamp, off);
    let distance = off[0].hypot(off[1]);
    let cosine = |point: f32| {
        let part = point * lamp.radius / distance;
        let way = [-off[0] - part * off[1], -off[1] + part * off[0]];
        (normal[0] * way[0] + normal[1] * way[1]) / way[0].hypot(way[1])
    };
    let points = (0..POINTS).map(|number| hidden.stands.at(point(number, POINTS)));
    let seen = points.filter(|&point| !hidden.holds(point));
    seen.map(|point| cosine(point).max(0.0)).sum::<f32>() / POINTS as f32
}

/// One of `count` points across a lamp, −1 to 1.
fn point(number: usize, count: usize) -> f32 {
    (2 * number + 1) as f32 / count as f32 - 1.0
}

/// Returns the distance after which a ray from inside leaves the grid, px.
fn leaves(grid: &MediumGrid, from: [f32; 2], way: [f32; 2]) -> f32 {
    let along = |a: usize| {
        let border = if way[a] > 0.0 { grid.size[a] as f32 } else { 0.0 };
        if way[a] == 0.0 { f32::INFINITY } else { (border - from[a]) / way[a] }
    };
    along(0).min(along(1))
}

/// Rounds down, to no less than 0.
#[inline(always)]
fn whole(v: f32) -> usize {
    // By 32 bits: to round to 64 takes several times as long.
    v.max(0.0) as i32 as usize
}

/// Returns the ends of what the centre of a lamp sees of it, before and after itself on the line across the line of sight
/// to `off`, 0 to 1.
fn seen_by_center(grid: &MediumGrid, lamp: LampDisc, off: [f32; 2]) -> [f32; 2] {
    let LampDisc { center, radius, clear } = lamp;
    let to_border = [0, 1].map(|a| center[a].min(grid.size[a] as f32 - center[a]));
    let to_border = to_border[0].min(to_border[1]);
    if clear >= radius && !(0.0..radius).contains(&to_border) {
        return [1.0; 2];
    }
    let distance = off[0].hypot(off[1]);
    let across = [-off[1] / distance, off[0] / distance];
    let ways = [-1.0, 1.0].map(|sign| across.map(|v| sign * v));
    let mut inside = [1.0; 2];
    if to_border >= 0.0 {
        inside = ways.map(|way| (leaves(grid, center, way) / radius).min(1.0));
    }
    // A lamp at a corner of the grid may have no part inside.
    if inside[0] + inside[1] <= SMALLEST_PART {
        inside = [1.0; 2];
    }
    let walls = ways.map(|way| grid.cast(center, way, radius, false, |_, _| ()).length / radius);
    [0, 1].map(|side| inside[side].min(walls[side]))
}

/// Returns what solid cells hide of a lamp.
fn hidden(solid: &SolidBits, grid: &MediumGrid, lamp: LampDisc, off: [f32; 2]) -> Hidden {
    let mut hidden = Hidden::default();
    if off == [0.0; 2] {
        return hidden;
    }
    let ends = seen_by_center(grid, lamp, off);
    // Nothing stands for a lamp whose centre is in a wall.
    if ends[0] + ends[1] > SMALLEST_PART {
        hidden.stands = LightPart::between(ends);
    }
    for (sign, end) in [-1.0, 1.0].into_iter().zip(ends) {
        if end < 1.0 {
            hidden.add((sign * end).min(sign), (sign * end).max(sign));
        }
    }
    hide_behind_walls(solid, &lamp.fan(off), &mut hidden);
    hidden
}

/// Adds what solid cells hide of a light.
pub fn hide_behind_walls(solid: &SolidBits, fan: &Fan, hidden: &mut Hidden) {
    let &Fan { distance, slope, until, .. } = fan;
    // Columns, or rows, from the pixel on.
    let axis = usize::from(fan.ahead[1].abs() > fan.ahead[0].abs());
    let order = |v: [f32; 2]| [v[axis], v[1 - axis]];
    let (pixel, ahead) = (order(fan.pixel), order(fan.ahead));
    let beside = order([fan.ahead[1], -fan.ahead[0]]);
    let end = |side: f32| [0, 1].map(|a| pixel[a] + until * (ahead[a] + side * beside[a]));
    let ends = [end(-slope), end(slope)];
    let far = ends.map(|end| end[0]);
    let lines = [far[0].min(far[1]).min(pixel[0]), far[0].max(far[1]).max(pixel[0])];
    let slopes = ends.map(|end| {
        let along = end[0] - pixel[0];
        // A side of the triangle that runs across the lines meets one of them only.
        if along.abs() < 1e-3 { 0.0 } else { (end[1] - pixel[1]) / along }
    });
    let minor = ends.map(|end| end[1]);
    let bounds = [minor[0].min(minor[1]).min(pixel[1]), minor[0].max(minor[1]).max(pixel[1])];
    // One cell too many costs less than to round up.
    let first = whole(lines[0]);
    let last = (whole(lines[1]) + 1).min(solid.size[axis]);
    let scale = 1.0 / slope;
    // Between the sides of the triangle, within some lines.
    let span = |first: usize, end: usize| {
        let (mut from, mut to) = (f32::INFINITY, f32::NEG_INFINITY);
        for edge in [first, end].map(|edge| (edge as f32).clamp(lines[0], lines[1])) {
            for slope in slopes {
                let at = pixel[1] + slope * (edge - pixel[0]);
                (from, to) = (from.min(at), to.max(at));
            }
        }
        // Steep sides leave the triangle beyond its corners.
        if slope > 0.5 {
            (from, to) = (bounds[0], bounds[1]);
        }
        let from = whole(from.clamp(bounds[0], bounds[1]));
        let to = (whole(to.clamp(bounds[0], bounds[1])) + 1).min(solid.size[1 - axis]);
        (from, to)
    };
    let mut next = first;
    while next < last {
        let line = next;
        if line == first || line.is_multiple_of(BLOCK) {
            let end = (line / BLOCK * BLOCK + BLOCK).min(last);
            let (from, to) = span(line, end);
            if solid.is_block_empty(axis, line / BLOCK, from, to) {
                next = end;
                continue;
            }
        }
        next += 1;
        let (from, to) = span(line, line + 1);
        solid.runs(axis, line, from, to, |from, to| {
            let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
            let mut hide = |at: f32| (least, most) = (least.min(at), most.max(at));
            let [left, right] = [line as f32, line as f32 + 1.0].map(|v| v - pixel[0]);
            let [low, high] = [from as f32, to as f32].map(|v| v - pixel[1]);
            // Px ahead of the pixel, and beside the line of sight.
            let corners = [[left, low], [right, low], [right, high], [left, high]]
                .map(|[x, y]| [x * ahead[0] + y * ahead[1], x * beside[0] + y * beside[1]]);
            // What touches the light from behind hides nothing of it.
            if corners.iter().all(|&[ahead, _]| ahead >= distance) {
                return;
            }
            let mut before = corners[3];
            for corner in corners {
                let ([a, s], [b, t]) = (corner, before);
                let crossing = |at: f32| s + (t - s) * (at - a) / (b - a);
                if (a > AHEAD) != (b > AHEAD) {
                    // The cell goes on beside the pixel, to this side.
                    hide(OUTSIDE.copysign(crossing(AHEAD)));
                }
                if (a > distance) != (b > distance) {
                    hide(crossing(distance) * scale / distance);
                }
                if a > AHEAD && a <= distance {
                    hide(s * scale / a);
                }
                before = corner;
            }
            hidden.add(least, most);
        });
        if hidden.is_all() {
            break;
        }
    }
}

/// Returns whether two values differ by more than `most` in any channel.
pub fn differ(a: Rgb, b: Rgb, most: f32) -> bool {
    (0..3).any(|c| (a[c] - b[c]).abs() > most)
}

/// Returns whether two transmittances are those of uneven media. Square roots are compared: through dense media that are
/// uneven most rays are dark, but one between them may be bright.
pub fn are_uneven(a: Rgb, b: Rgb) -> bool {
    differ(a.map(f32::sqrt), b.map(f32::sqrt), 0.5 * EVEN)
}

/// Returns the mean transmittance of media between a pixel and the points that it sees of a `part` of a light; `None` if
/// it sees none.
fn through_media(grid: &MediumGrid, fan: &Fan, part: LightPart) -> Option<Rgb> {
    let [fewest, most] = RAYS;
    let rays = ((2.0 * fan.half_width) as usize).clamp(fewest, most);
    let through =
        |number: usize, count: usize| through_media_to(grid, fan, part.at(point(number, count)));
    if fan.half_width <= NARROW
        && let Some(smooth) = through_smooth_media(grid, fan, part)
    {
        return Some(smooth);
    }
    let differ =
        |a: Option<Rgb>, b: Option<Rgb>| a.zip(b).is_some_and(|(a, b)| differ(a, b, DIFFERENT));
    let (mut sum, mut count) = ([0.0; 3], 0);
    let mut add = |seen: Option<Rgb>, weight: usize| {
        let Some(seen) = seen else { return };
        (0..3).for_each(|c| sum[c] += seen[c] * weight as f32);
        count += weight;
    };
    let (mut before, mut own) = (None, through(0, rays));
    for number in 0..rays {
        let after = if number + 1 < rays { through(number + 1, rays) } else { None };
        if differ(own, before) || differ(own, after) {
            let first = FINER * number;
            (first..first + FINER).for_each(|finer| add(through(finer, FINER * rays), 1));
        } else {
            add(own, FINER);
        }
        (before, own) = (own, after);
    }
    (count > 0).then(|| sum.map(|v| v / count as f32))
}

/// Returns the mean transmittance by five rays and Simpson's rule, if the light is seen whole and that is enough.
fn through_smooth_media(grid: &MediumGrid, fan: &Fan, part: LightPart) -> Option<Rgb> {
    let mut rays = [[0.0; 3]; 5];
    for (number, ray) in rays.iter_mut().enumerate() {
        *ray = through_media_to(grid, fan, part.at(0.5 * number as f32 - 1.0))?;
    }
    let [a, b, c, d, e] = rays;
    let coarse = [0, 1, 2].map(|k| (a[k] + 4.0 * c[k] + e[k]) / 6.0);
    let fine = [0, 1, 2].map(|k| (a[k] + 4.0 * (b[k] + d[k]) + 2.0 * c[k] + e[k]) / 12.0);
    (!differ(coarse, fine, EVEN)).then_some(fine)
}

/// Like [`through_media`]; where no ray arrives, by one through the `gap` between walls.
pub fn through_media_or_gap(
    grid: &MediumGrid,
    fan: &Fan,
    part: LightPart,
    gap: impl FnOnce() -> Option<f32>,
) -> Option<Rgb> {
    through_media(grid, fan, part).or_else(|| through_media_to(grid, fan, gap()?))
}

/// Like [`through_media_or_gap`], of a lamp and the widest gap before it.
pub fn through_media_to_lamp(
    solid: &SolidBits,
    grid: &MediumGrid,
    lamp: LampDisc,
    off: [f32; 2],
) -> Option<Rgb> {
    let gap = || Some(hidden(solid, grid, lamp, off).widest_gap());
    // Rounded, so that rounding elsewhere does not move rays from one medium to another.
    let ends = seen_by_center(grid, lamp, off).map(|end| (end * STEPS + 0.5).floor() / STEPS);
    let part = LightPart::between(ends);
    through_media_or_gap(grid, &lamp.fan(off), part, gap)
}

/// Returns the transmittance of media between a pixel and the point `at` across a light, −1 to 1; `None` behind a
/// wall.
fn through_media_to(grid: &MediumGrid, fan: &Fan, at: f32) -> Option<Rgb> {
    let Fan { pixel, ahead, distance, slope, .. } = *fan;
    let part = at * slope;
    let way = [ahead[0] + part * ahead[1], ahead[1] - part * ahead[0]];
    let length = way[0].hypot(way[1]);
    let (hit, through) = along_ray(grid, pixel, way.map(|v| v / length), distance * length);
    (hit == RayHit::NONE).then_some(through)
}

/// Returns the transmittance of media from the middle of a lamp up to the wall before a pixel that sees the lamp only
/// past that wall.
pub fn through_media_to_wall(grid: &MediumGrid, fan: &Fan) -> Rgb {
    let Fan { pixel, ahead, distance, .. } = *fan;
    let center = [0, 1].map(|a| pixel[a] + distance * ahead[a]);
    along_ray(grid, center, ahead.map(|v| -v), distance).1
}

/// Returns the end of a ray, and the transmittance of media up to it.
fn along_ray(grid: &MediumGrid, from: [f32; 2], way: [f32; 2], reach: f32) -> (RayHit, Rgb) {
    let mut depth = [0.0; 3];
    let hit = grid.cast(from, way, reach, false, |step, cell| {
        if grid.classes[cell] == CellClass::Medium {
            let px = step.span[1] - step.span[0];
            (0..3).for_each(|c| depth[c] += grid.extinction[cell][c] * px);
        }
    });
    (hit, depth.map(transmittance))
}
