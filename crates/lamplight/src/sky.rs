//! The sky: the boundary radiance of the grid.

use crate::exact::Exact;
use crate::{Error, Result, Rgb, notation};
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// Radiance beyond the grid, by direction.
///
/// In a file either one colour, `sky = [0.1, 0.1, 0.2]`, or a gradient,
/// `sky = { zenith = […], horizon = […], ground = […] }`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Sky {
    /// One linear RGB radiance from all directions.
    Uniform(#[schemars(with = "notation::Color")] Rgb),
    /// A gradient over the elevation of the direction.
    Gradient(Gradient),
}

/// A sky that changes with elevation: `zenith` straight up (−y), `horizon` to the sides,
/// `ground` straight down; linear in the sine of the elevation between them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gradient {
    /// Linear RGB radiance from straight up.
    #[serde(deserialize_with = "notation::color")]
    #[schemars(with = "notation::Color")]
    pub zenith: Rgb,
    /// Linear RGB radiance from the sides.
    #[serde(deserialize_with = "notation::color")]
    #[schemars(with = "notation::Color")]
    pub horizon: Rgb,
    /// Linear RGB radiance from straight down.
    #[serde(deserialize_with = "notation::color")]
    #[schemars(with = "notation::Color")]
    pub ground: Rgb,
}

impl Sky {
    /// No light from outside.
    pub const BLACK: Self = Self::Uniform([0.0; 3]);

    /// The radiance along a ray whose unit direction has the y component `dy` (y points down).
    #[inline]
    pub fn radiance(&self, dy: f32) -> Rgb {
        match self {
            Self::Uniform(rgb) => *rgb,
            Self::Gradient(g) => {
                let (end, weight) = if dy < 0.0 { (g.zenith, -dy) } else { (g.ground, dy) };
                std::array::from_fn(|c| g.horizon[c] + (end[c] - g.horizon[c]) * weight)
            }
        }
    }

    /// Returns whether the sky is black in all directions.
    pub fn is_black(&self) -> bool {
        self.ends().into_iter().flatten().all(|v| v == 0.0)
    }

    /// Rejects NaN, infinite and negative radiance.
    pub fn check(&self) -> Result<()> {
        match self.ends().into_iter().flatten().find(|v| !v.is_finite() || *v < 0.0) {
            Some(v) => Err(Error::value("sky", v, "a finite radiance of 0 or more")),
            None => Ok(()),
        }
    }

    fn ends(&self) -> [Rgb; 3] {
        match *self {
            Self::Uniform(rgb) => [rgb; 3],
            Self::Gradient(g) => [g.zenith, g.horizon, g.ground],
        }
    }
}

/// Written by hand, so that errors name the form and the colour that are wrong.
impl<'de> Deserialize<'de> for Sky {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Either;

        impl<'de> Visitor<'de> for Either {
            type Value = Sky;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a colour, [r, g, b] or \"#rrggbb\", or { zenith, horizon, ground }")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Sky, A::Error> {
                let Exact(rgb) = Exact::deserialize(SeqAccessDeserializer::new(list))?;
                Ok(Sky::Uniform(rgb))
            }

            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Sky, E> {
                let wrong = || E::invalid_value(serde::de::Unexpected::Str(text), &self);
                notation::hex(text).map(Sky::Uniform).ok_or_else(wrong)
            }

            fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<Sky, A::Error> {
                Gradient::deserialize(MapAccessDeserializer::new(table)).map(Sky::Gradient)
            }
        }

        from.deserialize_any(Either)
    }
}

impl From<Rgb> for Sky {
    fn from(radiance: Rgb) -> Self {
        Self::Uniform(radiance)
    }
}

impl From<Gradient> for Sky {
    fn from(gradient: Gradient) -> Self {
        Self::Gradient(gradient)
    }
}

impl Default for Sky {
    fn default() -> Self {
        Self::BLACK
    }
}
