//! Intervals of rays: the radiance that an interval adds, and its transmittance.

use crate::Rgb;
use std::fmt::Debug;

/// A transmittance: the same for all channels (`f32`) or one per channel ([`Rgb`]), which takes half as
/// much memory again and is needed only if something tints.
pub trait Transmittance: Copy + Debug + PartialEq + Send + Sync {
    /// Full transmittance.
    const ALL: Self;
    /// None.
    const NONE: Self;
    /// Returns the transmittance by channel.
    fn rgb(self) -> Rgb;
    /// Creates it from one per channel; if only one is stored, the first.
    fn from_rgb(rgb: Rgb) -> Self;
    /// Returns that of two intervals one after the other.
    fn times(self, behind: Self) -> Self;
    /// Returns the mean of two.
    fn mean(self, other: Self) -> Self;
}

impl Transmittance for f32 {
    const ALL: Self = 1.0;
    const NONE: Self = 0.0;

    #[inline]
    fn rgb(self) -> Rgb {
        [self; 3]
    }

    #[inline]
    fn from_rgb(rgb: Rgb) -> Self {
        rgb[0]
    }

    #[inline]
    fn times(self, behind: Self) -> Self {
        self * behind
    }

    #[inline]
    fn mean(self, other: Self) -> Self {
        0.5 * self + 0.5 * other
    }
}

impl Transmittance for Rgb {
    const ALL: Self = [1.0; 3];
    const NONE: Self = [0.0; 3];

    #[inline]
    fn rgb(self) -> Rgb {
        self
    }

    #[inline]
    fn from_rgb(rgb: Rgb) -> Self {
        rgb
    }

    #[inline]
    fn times(self, behind: Self) -> Self {
        [self[0] * behind[0], self[1] * behind[1], self[2] * behind[2]]
    }

    #[inline]
    fn mean(self, other: Self) -> Self {
        [self[0].mean(other[0]), self[1].mean(other[1]), self[2].mean(other[2])]
    }
}

/// An interval of a ray, ⟨r, t⟩.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval<T> {
    /// r: radiance of the interval at its near end.
    pub light: Rgb,
    /// t: transmittance from its far end to its near one.
    pub transmittance: T,
}

impl<T: Transmittance> Interval<T> {
    /// Empty space, ⟨0, 1⟩.
    pub const EMPTY: Self = Self { light: [0.0; 3], transmittance: T::ALL };

    /// Returns ⊕, front to back: `⟨r_a + t_a·r_b, t_a·t_b⟩`.
    #[inline]
    #[must_use]
    pub fn then(self, behind: Self) -> Self {
        Self {
            light: self.before(behind.light),
            transmittance: self.transmittance.times(behind.transmittance),
        }
    }

    /// Returns the radiance at the near end if `light` enters at the far end: `r + t·light`.
    #[inline]
    pub fn before(self, light: Rgb) -> Rgb {
        let transmittance = self.transmittance.rgb();
        std::array::from_fn(|c| self.light[c] + transmittance[c] * light[c])
    }

    /// Returns the mean of two, of r and t separately.
    #[inline]
    #[must_use]
    pub fn mean(self, other: Self) -> Self {
        Self {
            light: std::array::from_fn(|c| self.light[c].mean(other.light[c])),
            transmittance: self.transmittance.mean(other.transmittance),
        }
    }
}
