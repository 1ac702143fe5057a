//! Blocks of cells: the light that each sends and stops, by direction.

use super::paths::{Across, DIRECTIONS, Entry, PER_DIRECTION, SLOTS, Strips, direction, slot};
use crate::Rgb;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A block: the means over its paths, by slot.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct FarBlock {
    /// Radiance that it sends, as seen in this direction.
    #[serde(with = "slots")]
    pub sent: [PackedRgb; SLOTS],
    /// Fraction of light that it stops.
    #[serde(with = "slots")]
    pub stopped: [PackedRgb; SLOTS],
}

/// Colours by slot, as they are serialized: a bit per slot that says whether its colour is not 0, then those colours.
mod slots {
    use super::{PackedRgb, SLOTS};
    use serde::{Deserializer, Serializer, de::Error};
    use std::borrow::Cow;

    const BITS: usize = SLOTS.div_ceil(8);
    const COLOUR: usize = size_of::<PackedRgb>();

    pub fn serialize<S: Serializer>(slots: &[PackedRgb; SLOTS], to: S) -> Result<S::Ok, S::Error> {
        let mut bytes = [0; BITS + COLOUR * SLOTS];
        let mut end = BITS;
        for (slot, &PackedRgb(colour)) in slots.iter().enumerate() {
            // Without a branch: a 0 is written too, and overwritten by the next colour.
            let kept = usize::from(colour != 0);
            bytes[slot / 8] |= (kept as u8) << (slot % 8);
            bytes[end..][..COLOUR].copy_from_slice(&colour.to_le_bytes());
            end += COLOUR * kept;
        }
        serde_bytes::serialize(&bytes[..end], to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<[PackedRgb; SLOTS], D::Error> {
        let bytes: Cow<'de, [u8]> = serde_bytes::deserialize(from)?;
        let damaged = || D::Error::custom("a block is damaged");
        let (bits, colours) = bytes.split_first_chunk::<BITS>().ok_or_else(damaged)?;
        let is_kept = |slot: &usize| bits[slot / 8] >> (slot % 8) & 1 == 1;
        let kept = (0..SLOTS).filter(is_kept);
        if colours.len() != COLOUR * kept.clone().count() {
            return Err(damaged());
        }
        let mut slots = [PackedRgb(0); SLOTS];
        for (slot, colour) in kept.zip(colours.as_chunks().0) {
            slots[slot] = u32::from_le_bytes(*colour).try_into().map_err(D::Error::custom)?;
        }
        Ok(slots)
    }
}

impl FarBlock {
    /// Nothing.
    pub const CLEAR: Self = Self { sent: [PackedRgb(0); SLOTS], stopped: [PackedRgb(0); SLOTS] };

    /// One that no ray enters.
    pub const HIDDEN: Self = Self { sent: [PackedRgb::HIDDEN; SLOTS], ..Self::CLEAR };

    /// Returns whether no light passes along x, or none along y.
    pub fn is_shut(&self) -> bool {
        let is_opaque = |number: usize| {
            (0..PER_DIRECTION).all(|part| {
                let found = self.in_slot(slot(number, part));
                found.is_none_or(|[_, stopped]| stopped.into_iter().all(|stopped| stopped >= 1.0))
            })
        };
        let [half, quarter] = [DIRECTIONS / 2, DIRECTIONS / 4];
        is_opaque(0) && is_opaque(half) || is_opaque(quarter) && is_opaque(half + quarter)
    }

    /// Returns what a ray sees that enters here: the radiance that is added on the way, and the fraction of light that is
    /// stopped; `None` if no ray comes in this way from open space.
    #[inline]
    pub fn crossed(&self, bearing: &Bearing, entry: Entry) -> Option<[Rgb; 2]> {
        let seen =
            |i: usize| self.in_slot(slot(bearing.directions[i], bearing.strips[i].number(entry)));
        let [mut sent, mut stopped] = match [seen(0), seen(1)] {
            [None, None] => return None,
            [Some(only), None] | [None, Some(only)] => return Some(only),
            [Some([sent, stopped]), Some(high)] => {
                let between = |low: Rgb, high: Rgb| -> Rgb {
                    std::array::from_fn(|c| low[c] + (high[c] - low[c]) * bearing.past)
                };
                [between(sent, high[0]), between(stopped, high[1])]
            }
        };
        for c in 0..3 {
            let share = 1.0 - bearing.excess * (1.0 - stopped[c]);
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

/// The directions between which that of a ray lies.
#[derive(Clone, Copy, Debug)]
pub struct Bearing {
    directions: [usize; 2],
    strips: [Strips; 2],
    /// The weight of the second one.
    past: f32,
    /// The fraction by which a mean between them is too large for matter of small parts: what such matter stops, seen
    /// by all rays together, is the same in every direction, and a block looks wider from a direction between two others
    /// than from these in the mean.
    excess: f32,
}

impl Bearing {
    /// Returns that of a direction by its angle, radians from +x towards +y.
    pub fn new(angle: f64) -> Self {
        let at = (angle / TAU).rem_euclid(1.0) * DIRECTIONS as f64;
        let low = at as usize % DIRECTIONS;
        let directions = [low, (low + 1) % DIRECTIONS];
        let past = at - at.floor();
        let (sin, cos) = angle.sin_cos();
        let across = directions.map(|number| Across::new(direction(number)));
        let [low, high] = across.map(|across| across.width);
        let width = Across::new([cos, sin]).width;
        let excess = 1.0 - 1.0 / (width * ((1.0 - past) / low + past / high));
        Self {
            directions,
            strips: across.map(|across| Strips::new(&across)),
            past: past as f32,
            excess: excess.clamp(0.0, 0.1) as f32,
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
    use serde_json::{Value, from_value, to_value};

    #[test]
    fn blocks_travel_whole_or_not_at_all() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut colour = || match random.u8(0..4) {
            0 => PackedRgb::HIDDEN,
            1 => PackedRgb::new([0; 3].map(|_| random.f32())),
            _ => PackedRgb(0),
        };
        let mixed = FarBlock {
            sent: std::array::from_fn(|_| colour()),
            stopped: std::array::from_fn(|_| colour()),
        };
        for block in [FarBlock::CLEAR, FarBlock::HIDDEN, mixed] {
            let found: FarBlock = from_value(to_value(block).unwrap()).unwrap();
            assert_eq!((found.sent, found.stopped), (block.sent, block.stopped));
        }
        let damages: [fn(&mut Vec<Value>); 4] = [
            // One byte fewer, and more; a slot more; a colour whose exponent is too low.
            |bytes| bytes.truncate(bytes.len() - 1),
            |bytes| bytes.push(Value::from(0)),
            |bytes| bytes[0] = Value::from(bytes[0].as_u64().unwrap() ^ 1),
            |bytes| *bytes.last_mut().unwrap() = Value::from(8),
        ];
        for (number, damage) in damages.into_iter().enumerate() {
            let mut damaged = to_value(mixed).unwrap();
            let Value::Array(bytes) = &mut damaged["sent"] else { panic!("expected bytes") };
            damage(bytes);
            assert!(from_value::<FarBlock>(damaged).is_err(), "damage {number}");
        }
    }

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
