//! Lamps beyond a window, which may move while the world around it stands still.
//!
//! A lamp is seen as the disc that it is drawn as (`lamp_discs.rs`), behind the blocks on the way, cut off where the window
//! begins: there it is drawn into the cells. So its light does not change as it glides over the border. Columns take its
//! radiance by the weights with which they are read, so that none is lost of a lamp that is narrower than a column.

use super::levels::BlockLevel;
use super::march::{BlockRay, RayDirection, Rings, march};
use super::read::SIDE;
use crate::lamp_discs::glow_of;
use crate::panorama::column;
use crate::{BorderPlace, GridWindow, Inflow, Lamp, Result, Rgb};
use std::f64::consts::{PI, TAU};

/// Parts of a lamp, side by side, each behind a shadow of its own: more are softer edges of shadows, and take time.
const PARTS: usize = 4;
/// The least number of lines through a lamp beyond the border, and through one on it.
const LINES: usize = 8;
const LINES_ON_BORDER: usize = 64;
/// Lines per column of a wide lamp: columns between lines would be dark.
const LINES_PER_COLUMN: f64 = 2.0;

/// A lamp as it is seen, px of the world.
struct SeenLamp {
    center: [f64; 2],
    radius: f64,
    glow: Rgb,
    /// Transmittance of the way to its parts from each block along each side of the window.
    through: [Vec<[Rgb; PARTS]>; 4],
}

/// Returns the light that enters a window, which begins at a multiple of 4, with that of lamps, px of the world, added to
/// `inflow`.
///
/// # Errors
/// As [`Inflow::new`].
pub fn with_lamps(
    levels: &[BlockLevel],
    window: GridWindow,
    inflow: &Inflow,
    lamps: &[Lamp],
) -> Result<Inflow> {
    let rings = Rings::around(window, levels.len());
    let shine = |lamp: &&Lamp| !lamp.is_exact() && !lamp.is_off();
    let seen = lamps.iter().filter(shine).map(|lamp| {
        let (radius, glow) = glow_of(lamp);
        let center = lamp.position.map(f64::from);
        let through = [0, 1, 2, 3].map(|side| {
            let blocks = window.size[side % 2].div_ceil(SIDE as u32);
            let way = |block| ways(levels, &rings, window, (side, block), (center, radius));
            (0..blocks).map(way).collect()
        });
        SeenLamp { center, radius, glow, through }
    });
    let seen: Vec<SeenLamp> = seen.collect();
    let first = window.first.map(f64::from);
    Inflow::of_strips(window.size, inflow.columns(), |place, strip| {
        strip.copy_from_slice(inflow.strip(inflow.nearest_cell(place.at)));
        for lamp in &seen {
            lamp.add_to(strip, place, first);
        }
    })
}

/// Returns the side of a window that a border place lies on: top, right, bottom, left.
fn side_of(place: BorderPlace) -> usize {
    match place.outward {
        [_, y] if y < 0.0 => 0,
        [x, _] if x > 0.0 => 1,
        [_, y] if y > 0.0 => 2,
        _ => 3,
    }
}

/// Returns the transmittance of the ways from a block along a side of a window to the parts of a lamp.
fn ways(
    levels: &[BlockLevel],
    rings: &Rings,
    window: GridWindow,
    (side, number): (usize, u32),
    (center, radius): ([f64; 2], f64),
) -> [Rgb; PARTS] {
    let along = side % 2;
    let across = 1 - along;
    let outward = if side == 0 || side == 3 { -1 } else { 1 };
    let side_length = SIDE as u32;
    let mut block = window.first.map(|v| (v / side_length) as i32);
    block[along] += number as i32;
    block[across] += match outward {
        -1 => -1,
        _ => window.size[across].div_ceil(side_length) as i32,
    };
    let mut from = block.map(|v| (f64::from(v) + 0.5) * SIDE as f64);
    from[across] -= f64::from(outward) * 0.5 * SIDE as f64;
    let to = [0, 1].map(|a| center[a] - from[a]);
    let distance = to[0].hypot(to[1]);
    std::array::from_fn(|part| {
        let aside = radius * (2.0 * (part as f64 + 0.5) / PARTS as f64 - 1.0) / distance;
        let way = [to[0] - to[1] * aside, to[1] + to[0] * aside];
        let reach = way[0].hypot(way[1]);
        // What lies in the first block may lie behind the lamp.
        if way[across] * f64::from(outward) <= 0.0 || reach < SIDE as f64 {
            return [1.0; 3];
        }
        let direction = RayDirection::new(way[1].atan2(way[0]));
        let [_, through] =
            march(levels, rings, BlockRay { from, direction: &direction, block, reach });
        through
    })
}

impl SeenLamp {
    /// Adds the lamp to the strip of a border cell of a window whose first cell lies at `first`.
    fn add_to(&self, strip: &mut [Rgb], place: BorderPlace, first: [f64; 2]) {
        let at = place.at.map(f64::from);
        let outward = place.outward.map(f64::from);
        let to = [0, 1].map(|a| self.center[a] - first[a] - at[a]);
        let away = to[0] * outward[0] + to[1] * outward[1];
        if away <= -self.radius {
            return;
        }
        let through = self.through(place);
        let distance = to[0].hypot(to[1]);
        let width = TAU / strip.len() as f64;
        let mut add = |angle: f64, share: f64, part: usize| {
            let (sin, cos) = angle.sin_cos();
            if cos * outward[0] + sin * outward[1] <= 0.0 {
                return;
            }
            let at = column(strip.len(), angle);
            let past = (at - at.floor()) as f32;
            let before = (at.floor() as i64).rem_euclid(strip.len() as i64) as usize;
            let after = if before + 1 == strip.len() { 0 } else { before + 1 };
            for c in 0..3 {
                let light = self.glow[c] * through[part][c] * (share / width) as f32;
                strip[before][c] += (1.0 - past) * light;
                strip[after][c] += past * light;
            }
        };
        if distance <= self.radius {
            // The border cell lies in the lamp: it sees it all around.
            let middle = outward[1].atan2(outward[0]);
            let lines = LINES_ON_BORDER.max((LINES_PER_COLUMN * PI / width).ceil() as usize);
            for line in 0..lines {
                let past = (line as f64 + 0.5) / lines as f64;
                let angle = middle + PI * (past - 0.5);
                let (sin, cos) = angle.sin_cos();
                let ahead = to[0] * cos + to[1] * sin;
                let aside = distance.powi(2) - ahead * ahead;
                let length = ahead + (self.radius.powi(2) - aside).max(0.0).sqrt();
                add(angle, length * PI / lines as f64, line * PARTS / lines);
            }
            return;
        }
        let middle = to[1].atan2(to[0]);
        let seen = (self.radius / distance).asin();
        let least = if away < self.radius { LINES_ON_BORDER } else { LINES };
        // In the middle of the lamp they are π/2 times as far apart as on average.
        let lines = least.max((LINES_PER_COLUMN * PI * seen / width).ceil() as usize);
        // Lengths of chords, by Gauss and Chebyshev's quadrature: exact for small discs.
        for line in 1..=lines {
            let turn = PI * line as f64 / (lines + 1) as f64;
            let (sin, cos) = turn.sin_cos();
            let sine = -cos * self.radius / distance;
            let share = 2.0 * self.radius.powi(2) * PI / (lines + 1) as f64 * sin * sin
                / (distance * (1.0 - sine * sine).sqrt());
            let part = ((0.5 - 0.5 * cos) * PARTS as f64) as usize;
            add(middle + sine.clamp(-1.0, 1.0).asin(), share, part.min(PARTS - 1));
        }
    }

    /// Returns the transmittance of the ways from a border place to the parts.
    fn through(&self, place: BorderPlace) -> [Rgb; PARTS] {
        let side = side_of(place);
        let ways = &self.through[side];
        let at = (place.at[side % 2] / SIDE as f32 - 0.5).clamp(0.0, (ways.len() - 1) as f32);
        let (one, other) = (&ways[at as usize], &ways[(at as usize + 1).min(ways.len() - 1)]);
        let past = at.fract();
        std::array::from_fn(|part| {
            [0, 1, 2].map(|c| one[part][c] + (other[part][c] - one[part][c]) * past)
        })
    }
}
