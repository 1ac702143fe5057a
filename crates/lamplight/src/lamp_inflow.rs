//! Lamps beyond the border of a grid, in the light that enters it.
//!
//! A lamp is seen as the disc that it is drawn as (`lamp_discs.rs`), cut off where the grid begins: there it is drawn into
//! the cells. Columns take its radiance by the weights with which they are read, so that none is lost of a lamp that is
//! narrower than a column.

use crate::inflow::place_on_side;
use crate::lamp_discs::glow_of;
use crate::panorama::column;
use crate::{BorderPlace, Inflow, Lamp, Result, Rgb};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Parts of a lamp, side by side, each behind a shadow of its own: more are softer edges of shadows, and take time.
const PARTS: usize = 4;
/// The least number of lines through a lamp beyond the border, and through one on it.
const LINES: usize = 8;
const LINES_ON_BORDER: usize = 64;
/// Lines per column of a wide lamp: columns between lines would be dark.
const LINES_PER_COLUMN: f64 = 2.0;

/// A lamp as it is seen, px of the grid.
struct SeenLamp {
    center: [f64; 2],
    radius: f64,
    glow: Rgb,
    /// Transmittance of the way to its parts from places along each side; none of a side that it is behind.
    through: [Vec<[Rgb; PARTS]>; 4],
}

/// A line through a lamp: its offset from the middle by the radius, and its share of the area.
#[derive(Clone, Copy, Default)]
struct LampLine {
    offset: f64,
    share: f64,
    part: usize,
}

/// Returns an inflow with the light of lamps, px of the grid, added. `through` returns the transmittance of the way from a
/// place on the border to another beyond it; it is asked `spacing` px apart.
///
/// # Errors
/// As [`Inflow::new`].
pub fn with_lamps(
    inflow: &Inflow,
    lamps: &[Lamp],
    spacing: u32,
    through: impl Fn(BorderPlace, [f64; 2]) -> Rgb + Sync,
) -> Result<Inflow> {
    let size = inflow.size();
    let shine = |lamp: &&Lamp| !lamp.is_exact() && !lamp.is_off();
    let lamps: Vec<&Lamp> = lamps.iter().filter(shine).collect();
    let seen = lamps.into_par_iter().map(|lamp| {
        let (radius, glow) = glow_of(lamp);
        let center = lamp.position.map(f64::from);
        let through = [0, 1, 2, 3].map(|side| {
            let places = size[side % 2].div_ceil(spacing);
            let length = size[side % 2] as f32;
            let place = |number: u32| {
                let along = ((number as f32 + 0.5) * spacing as f32).min(length);
                place_on_side(size, side, along)
            };
            let (_, away) = seen_from(place(0), center);
            if away <= -radius {
                return Vec::new();
            }
            let ways = |number| ways(place(number), (center, radius), &through);
            (0..places).map(ways).collect()
        });
        SeenLamp { center, radius, glow, through }
    });
    let seen: Vec<SeenLamp> = seen.collect();
    let lines: [LampLine; LINES] = std::array::from_fn(|i| LampLine::new(i + 1, LINES));
    Inflow::of_strips(size, inflow.columns(), |place, strip| {
        strip.copy_from_slice(inflow.strip(inflow.nearest_cell(place.at)));
        for lamp in &seen {
            lamp.add_to(strip, place, spacing, &lines);
        }
    })
}

/// Returns the way from a border place to a point, and its length across the border.
fn seen_from(place: BorderPlace, point: [f64; 2]) -> ([f64; 2], f64) {
    let to = [0, 1].map(|a| point[a] - f64::from(place.at[a]));
    let away = to[0] * f64::from(place.outward[0]) + to[1] * f64::from(place.outward[1]);
    (to, away)
}

/// Returns the transmittance of the ways from a place to the parts of a lamp.
fn ways(
    place: BorderPlace,
    (center, radius): ([f64; 2], f64),
    through: impl Fn(BorderPlace, [f64; 2]) -> Rgb,
) -> [Rgb; PARTS] {
    let (to, _) = seen_from(place, center);
    let distance = to[0].hypot(to[1]).max(1e-6);
    std::array::from_fn(|part| {
        let aside = radius * (2.0 * (part as f64 + 0.5) / PARTS as f64 - 1.0) / distance;
        let point = [center[0] - to[1] * aside, center[1] + to[0] * aside];
        match seen_from(place, point) {
            (_, away) if away <= 0.0 => [1.0; 3],
            _ => through(place, point),
        }
    })
}

impl LampLine {
    /// Returns one of so many, numbered from 1, by Gauss and Chebyshev's quadrature: exact for small discs.
    fn new(number: usize, count: usize) -> Self {
        let (sin, cos) = (PI * number as f64 / (count + 1) as f64).sin_cos();
        let part = ((0.5 - 0.5 * cos) * PARTS as f64) as usize;
        let share = 2.0 * PI / (count + 1) as f64 * sin * sin;
        Self { offset: -cos, share, part: part.min(PARTS - 1) }
    }
}

impl SeenLamp {
    /// Adds the lamp to the strip of a border cell.
    fn add_to(
        &self,
        strip: &mut [Rgb],
        place: BorderPlace,
        spacing: u32,
        least: &[LampLine; LINES],
    ) {
        let (to, away) = seen_from(place, self.center);
        if away <= -self.radius {
            return;
        }
        let Some(through) = self.through(place, spacing) else { return };
        let outward = place.outward.map(f64::from);
        let distance = to[0].hypot(to[1]);
        let columns = strip.len();
        let width = TAU / columns as f64;
        let cut = away < self.radius;
        let mut add = |angle: f64, share: f64, part: usize| {
            if cut {
                let (sin, cos) = angle.sin_cos();
                if cos * outward[0] + sin * outward[1] <= 0.0 {
                    return;
                }
            }
            let at = column(columns, angle);
            let past = (at - at.floor()) as f32;
            let before = (at.floor() as i64).rem_euclid(columns as i64) as usize;
            let after = if before + 1 == columns { 0 } else { before + 1 };
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
        let ratio = self.radius / distance;
        let mut add_line = |line: LampLine| {
            let sine = (line.offset * ratio).clamp(-1.0, 1.0);
            let share = line.share * self.radius * ratio / (1.0 - sine * sine).sqrt();
            add(middle + sine.asin(), share, line.part);
        };
        // In the middle of the lamp they are π/2 times as far apart as on average.
        let wide = (LINES_PER_COLUMN * PI * ratio.asin() / width).ceil() as usize;
        let lines = wide.max(if cut { LINES_ON_BORDER } else { LINES });
        if lines == LINES {
            least.iter().copied().for_each(add_line);
        } else {
            (1..=lines).map(|i| LampLine::new(i, lines)).for_each(&mut add_line);
        }
    }

    /// Returns the transmittance of the ways from a border place to the parts; `None` if no light comes through.
    fn through(&self, place: BorderPlace, spacing: u32) -> Option<[Rgb; PARTS]> {
        let side = place.side();
        let ways = &self.through[side];
        let last = ways.len().checked_sub(1)?;
        let at = (place.at[side % 2] / spacing as f32 - 0.5).clamp(0.0, last as f32);
        let (one, other) = (&ways[at as usize], &ways[(at as usize + 1).min(last)]);
        let is_dark = |ways: &[Rgb; PARTS]| *ways == [[0.0; 3]; PARTS];
        if is_dark(one) && is_dark(other) {
            return None;
        }
        let past = at.fract();
        Some(std::array::from_fn(|part| {
            [0, 1, 2].map(|c| one[part][c] + (other[part][c] - one[part][c]) * past)
        }))
    }
}
