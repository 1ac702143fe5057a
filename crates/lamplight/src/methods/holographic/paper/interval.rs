//! What a stretch of a ray adds, and what it lets through.

use crate::Rgb;
use std::fmt::Debug;

/// Share of light that gets through, the same for all channels (`f32`) or one each ([`Rgb`]), which
/// costs half as much memory again and is needed only where something tints.
pub trait Through: Copy + Debug + PartialEq + Send + Sync {
    /// Everything gets through.
    const ALL: Self;
    /// Nothing does.
    const NONE: Self;
    /// The share by channel.
    fn rgb(self) -> Rgb;
    /// From shares by channel; where only one is kept, the first.
    fn from_rgb(rgb: Rgb) -> Self;
    /// Both one after the other.
    fn times(self, behind: Self) -> Self;
    /// The mean of two.
    fn mean(self, other: Self) -> Self;
}

impl Through for f32 {
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

impl Through for Rgb {
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

/// A stretch of a ray, ⟨r, t⟩.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval<T> {
    /// r: radiance that the stretch sends to its near end.
    pub light: Rgb,
    /// t: share of what comes in at its far end that reaches the near one.
    pub through: T,
}

impl<T: Through> Interval<T> {
    /// Empty space, ⟨0, 1⟩.
    pub const EMPTY: Self = Self { light: [0.0; 3], through: T::ALL };

    /// ⊕, front to back: `⟨r_a + t_a·r_b, t_a·t_b⟩`.
    #[inline]
    #[must_use]
    pub fn then(self, behind: Self) -> Self {
        Self { light: self.before(behind.light), through: self.through.times(behind.through) }
    }

    /// What arrives when `light` comes in at the far end: `r + t·light`.
    #[inline]
    pub fn before(self, light: Rgb) -> Rgb {
        let through = self.through.rgb();
        std::array::from_fn(|c| self.light[c] + through[c] * light[c])
    }

    /// The mean of two, r and t apart.
    #[inline]
    #[must_use]
    pub fn mean(self, other: Self) -> Self {
        Self {
            light: std::array::from_fn(|c| self.light[c].mean(other.light[c])),
            through: self.through.mean(other.through),
        }
    }
}
