//! Blocks of cells: the light that each sends and stops, by direction.

use super::paths::{DIRECTIONS, SLOTS, direction, is_missing, slot};
use crate::Rgb;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Radiance that a block sends, by slot.
pub type Sent = [PackedRgb; SLOTS];

/// A block: the means over its paths, by slot.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct FarBlock {
    /// Radiance that it sends, as seen in this direction.
    pub sent: Sent,
    /// Fraction of light that it stops.
    pub stopped: [PackedRgb; SLOTS],
}

impl FarBlock {
    /// Nothing.
    pub const CLEAR: Self = Self { sent: [PackedRgb(0); SLOTS], stopped: [PackedRgb(0); SLOTS] };

    /// One that no ray enters.
    pub const HIDDEN: Self = Self { sent: [PackedRgb::HIDDEN; SLOTS], ..Self::CLEAR };

    /// Returns whether no light passes along x, or none along y.
    pub fn is_shut(&self) -> bool {
        let is_opaque = |number: usize, axis: usize| {
            let found = self.in_slot(slot(number, axis));
            found.is_none_or(|[_, stopped]| stopped.into_iter().all(|stopped| stopped >= 1.0))
        };
        let half = DIRECTIONS / 2;
        let quarter = DIRECTIONS / 4;
        is_opaque(0, 0) && is_opaque(half, 0)
            || is_opaque(quarter, 1) && is_opaque(half + quarter, 1)
    }

    /// Returns what a ray sees that enters along an axis: the radiance that is added on the way, and the fraction of
    /// light that is stopped; `None` if no ray comes in this way from open space.
    #[inline]
    pub fn crossed(&self, bearing: &Bearing, axis: usize) -> Option<[Rgb; 2]> {
        let Bearing { low, high, past, excess } = *bearing;
        let [low, high] = match [low[axis], high[axis]] {
            [low, high] if self.sent[low] == PackedRgb::HIDDEN => [high, high],
            [low, high] if self.sent[high] == PackedRgb::HIDDEN => [low, low],
            both => both,
        };
        let [mut sent, mut stopped] = self.in_slot(low)?;
        if low != high {
            let [sent_high, stopped_high] = self.in_slot(high)?;
            for c in 0..3 {
                sent[c] += (sent_high[c] - sent[c]) * past;
                stopped[c] += (stopped_high[c] - stopped[c]) * past;
            }
        }
        for c in 0..3 {
            let share = 1.0 - excess[axis] * (1.0 - stopped[c]);
            sent[c] *= share;
            stopped[c] *= share;
        }
        Some([sent, stopped])
    }

    /// Returns what is sent and what is stopped in a slot, unless no ray comes in this way.
    #[inline]
    pub fn in_slot(&self, slot: usize) -> Option<[Rgb; 2]> {
        let is_open = self.sent[slot] != PackedRgb::HIDDEN;
        is_open.then(|| [self.sent[slot].unpack(), self.stopped[slot].unpack()])
    }
}

/// The fraction of light from which on what stops it counts as a surface; what glows or is thin does not.
pub const LEAST_SURFACE: f32 = 1.0 / 16.0;

/// A ray on its way through blocks.
#[derive(Clone, Copy, Debug)]
pub struct BlockRayState {
    pub light: Rgb,
    pub through: Rgb,
    /// The mean radiance of what stopped light in the last block.
    surface: Rgb,
}

impl BlockRayState {
    /// A ray that has met nothing.
    pub const START: Self = Self { light: [0.0; 3], through: [1.0; 3], surface: [0.0; 3] };

    /// Crosses a block; `None` if no ray comes into it from open space. What is left of the ray then belongs to the
    /// surface through which it went, because a block does not know where.
    #[inline]
    pub fn cross(&mut self, block: Option<[Rgb; 2]>) {
        let [sent, stopped] = block.unwrap_or([self.surface, [1.0; 3]]);
        for c in 0..3 {
            self.light[c] += self.through[c] * sent[c];
            self.through[c] *= 1.0 - stopped[c];
            if stopped[c] > LEAST_SURFACE {
                self.surface[c] = sent[c] / stopped[c];
            }
        }
    }
}

/// The slots between which the direction of a ray lies, by the axis along which it enters a block.
#[derive(Clone, Copy, Debug)]
pub struct Bearing {
    low: [usize; 2],
    high: [usize; 2],
    /// The weight of the higher one.
    past: f32,
    /// The fraction by which a mean between them is too large for matter of small parts: what such matter stops, seen
    /// by all rays together, is the same in every direction, and the side by which they enter looks narrower from one
    /// between two others than from these in the mean.
    excess: [f32; 2],
}

impl Bearing {
    /// Returns that of a direction by its angle, radians from +x towards +y.
    pub fn new(angle: f64) -> Self {
        let at = (angle / TAU).rem_euclid(1.0) * DIRECTIONS as f64;
        let low = at as usize % DIRECTIONS;
        let high = (low + 1) % DIRECTIONS;
        let pick = |axis: usize| match (is_missing(low, axis), is_missing(high, axis)) {
            (true, _) => (high, high),
            (_, true) => (low, low),
            _ => (low, high),
        };
        let sides = [pick(0), pick(1)];
        let past = at - at.floor();
        let (sin, cos) = angle.sin_cos();
        let excess = |axis: usize| {
            let [low, high] = [low, high].map(|number| direction(number)[axis].abs());
            let width = [cos, sin][axis].abs().max(1e-6);
            (1.0 - ((1.0 - past) * low + past * high) / width).clamp(0.0, 0.1) as f32
        };
        Self {
            low: [0, 1].map(|axis| slot(sides[axis].0, axis)),
            high: [0, 1].map(|axis| slot(sides[axis].1, axis)),
            past: past as f32,
            excess: [0, 1].map(excess),
        }
    }
}

/// A colour in four bytes: three mantissas and a common exponent (Ward 1991), with 1 exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "u32", into = "u32")]
pub struct PackedRgb(u32);

impl From<PackedRgb> for u32 {
    fn from(packed: PackedRgb) -> Self {
        packed.0
    }
}

impl TryFrom<u32> for PackedRgb {
    type Error = &'static str;

    fn try_from(bits: u32) -> Result<Self, Self::Error> {
        // The exponent of a mantissa of 8 bits.
        if bits == 0 || bits >> 24 > 8 { Ok(Self(bits)) } else { Err("a colour is damaged") }
    }
}

/// The least exponent that is kept; smaller values are 0.
const LEAST: i32 = -100;

impl PackedRgb {
    /// In place of a colour: no ray comes in this way.
    pub const HIDDEN: Self = Self(u32::MAX);

    /// Rounds a colour of values from 0 on to 1/256 of its largest.
    #[inline]
    pub fn new(rgb: Rgb) -> Self {
        let largest = rgb[0].max(rgb[1]).max(rgb[2]);
        let exponent_of = |v: f32| (v.to_bits() >> 23) as i32 - 126;
        let mut exponent = exponent_of(largest);
        if exponent < LEAST {
            return Self(0);
        }
        let scale = |exponent: i32| f32::from_bits(((8 - exponent + 127) as u32) << 23);
        if largest * scale(exponent) + 0.5 >= 256.0 {
            exponent += 1;
        }
        let scale = scale(exponent.min(127));
        let [r, g, b] = rgb.map(|v| ((v * scale + 0.5) as u32).min(255));
        Self(((exponent + 127) as u32) << 24 | r << 16 | g << 8 | b)
    }

    #[inline]
    pub fn unpack(self) -> Rgb {
        let Self(bits) = self;
        if bits == 0 {
            return [0.0; 3];
        }
        let scale = f32::from_bits(((bits >> 24) - 8) << 23);
        [bits >> 16 & 255, bits >> 8 & 255, bits & 255].map(|v| v as f32 * scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_colours_are_those_that_were_packed() {
        let mut random = fastrand::Rng::with_seed(5);
        for rgb in [[0.0; 3], [1.0; 3], [1.0, 0.5, 0.0], [65536.0, 0.0, 3.0], [0.999_999; 3]] {
            assert_eq!(PackedRgb::new(PackedRgb::new(rgb).unpack()), PackedRgb::new(rgb));
        }
        assert_eq!(PackedRgb::new([1.0; 3]).unpack(), [1.0; 3]);
        for _ in 0..10_000 {
            let size = 10f32.powf(random.f32() * 60.0 - 29.0);
            let rgb = [0; 3].map(|_| random.f32() * size);
            let largest = rgb.into_iter().fold(0.0, f32::max);
            let found = PackedRgb::new(rgb).unpack();
            assert!(
                (0..3).all(|c| (found[c] - rgb[c]).abs() <= largest / 255.0),
                "{rgb:?}, {found:?}"
            );
        }
    }
}
