//! The first moment of light: where it comes from, beside how much there is.
//!
//! `m = (1/2π) ∫ L ω dω`, with ω the unit vector towards the place from which radiance L arrives. Its length is at
//! most the mean radiance J, channel by channel: `|m| = J` if all light comes from one direction, 0 if it comes from
//! all alike. Only that of light with an elevation of its own is weighted, and may be longer ([`crate::elevation`]). A
//! surface that is tilted by a normal n in a picture receives light by both ([`Relief`](crate::Relief)).

use crate::Rgb;
use rayon::prelude::*;

/// The first moment of light: its x and its y component, each in linear RGB.
pub type Moment = [Rgb; 2];

/// Returns the moment of light that arrives from one direction, a unit vector.
#[inline(always)]
pub fn from_direction(light: Rgb, direction: [f32; 2]) -> Moment {
    direction.map(|part| light.map(|v| v * part))
}

/// Adds one moment to another.
#[inline(always)]
pub fn add(sum: &mut Moment, other: &Moment) {
    for (sum, other) in sum.iter_mut().zip(other) {
        (0..3).for_each(|c| sum[c] += other[c]);
    }
}

/// Shortens the moment of light where it is longer than `longest` times the light: where lamps have taken light from other
/// directions than it came from.
#[inline(always)]
pub fn limit(moment: &mut Moment, light: Rgb, longest: f32) {
    for c in 0..3 {
        let (length, most) = (moment[0][c].hypot(moment[1][c]), longest * light[c]);
        if length > most {
            moment.iter_mut().for_each(|part| part[c] *= most / length);
        }
    }
}

/// Chunks of moments that are found beside others: `None` for each of them if there are no moments.
pub fn chunks(
    moments: Option<&mut [Moment]>,
    size: usize,
) -> impl IndexedParallelIterator<Item = Option<&mut [Moment]>> {
    let none = rayon::iter::repeat_n((), usize::MAX >> 1).map(|()| None);
    moments.unwrap_or_default().par_chunks_mut(size).map(Some).chain(none)
}
