//! Colours and angles as authors write them.
//!
//! A colour is a list of three linear values, or `"#ff8800"` as painting programs show it, which is decoded
//! from sRGB. An angle is a number of radians, or degrees as text, `"30deg"`.

use crate::exact::Exact;
use crate::{Rgb, srgb};
use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Unexpected, Visitor};
use std::fmt;

/// A colour in a file: linear RGB, or sRGB as `"#rrggbb"`.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "it describes the notation in the schema")]
pub(crate) enum Color {
    /// Linear RGB.
    Linear([f32; 3]),
    /// sRGB, as painting programs show it: `"#ff8800"` or `"#f80"`.
    Hex(#[schemars(regex(pattern = "^#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})$"))] String),
}

/// An angle in a file: radians, or degrees as `"30deg"`.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "it describes the notation in the schema")]
pub(crate) enum Angle {
    /// Radians.
    Radians(f32),
    /// Degrees, such as `"30deg"`.
    Degrees(#[schemars(regex(pattern = "deg$"))] String),
}

/// Returns whether an angle is the one that files leave out.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
pub(crate) fn is_zero(angle: &f32) -> bool {
    *angle == 0.0
}

/// A colour that is read in either notation.
struct Read(Rgb);

impl<'de> Deserialize<'de> for Read {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(ColorVisitor).map(Self)
    }
}

struct ColorVisitor;

impl<'de> Visitor<'de> for ColorVisitor {
    type Value = Rgb;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list of 3 numbers, linear RGB, or a colour such as \"#ff8800\"")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Rgb, A::Error> {
        Exact::deserialize(SeqAccessDeserializer::new(list)).map(|exact| exact.0)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Rgb, E> {
        hex(text).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
    }
}

/// Decodes `#rrggbb` or `#rgb`.
pub(crate) fn hex(text: &str) -> Option<Rgb> {
    let digits = text.strip_prefix('#')?.as_bytes();
    let value = |at: usize| char::from(*digits.get(at)?).to_digit(16).map(|v| v as u8);
    let channel = |c: usize| match digits.len() {
        3 => value(c).map(|v| 17 * v),
        6 => Some(16 * value(2 * c)? + value(2 * c + 1)?),
        _ => None,
    };
    Some([channel(0)?, channel(1)?, channel(2)?].map(srgb::decode_u8))
}

/// Deserializes a colour, for `#[serde(deserialize_with)]`.
pub(crate) fn color<'de, D: Deserializer<'de>>(from: D) -> Result<Rgb, D::Error> {
    Read::deserialize(from).map(|read| read.0)
}

/// Deserializes an optional colour.
pub(crate) fn optional_color<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Rgb>, D::Error> {
    Ok(Option::<Read>::deserialize(from)?.map(|read| read.0))
}

/// Deserializes a list of colours.
pub(crate) fn colors<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Rgb>, D::Error> {
    Ok(Vec::<Read>::deserialize(from)?.into_iter().map(|read| read.0).collect())
}

/// Deserializes an angle.
pub(crate) fn angle<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    from.deserialize_any(AngleVisitor)
}

/// An angle that is read in either notation.
struct ReadAngle(f32);

impl<'de> Deserialize<'de> for ReadAngle {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        angle(from).map(Self)
    }
}

/// Deserializes an optional angle.
pub(crate) fn optional_angle<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f32>, D::Error> {
    Ok(Option::<ReadAngle>::deserialize(from)?.map(|read| read.0))
}

struct AngleVisitor;

impl Visitor<'_> for AngleVisitor {
    type Value = f32;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number of radians, or degrees such as \"30deg\"")
    }

    fn visit_f64<E: Error>(self, radians: f64) -> Result<f32, E> {
        Ok(radians as f32)
    }

    fn visit_i64<E: Error>(self, radians: i64) -> Result<f32, E> {
        Ok(radians as f32)
    }

    fn visit_u64<E: Error>(self, radians: u64) -> Result<f32, E> {
        Ok(radians as f32)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<f32, E> {
        let degrees = text.strip_suffix("deg").and_then(|number| number.trim().parse::<f32>().ok());
        let degrees = degrees.ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))?;
        Ok(degrees.to_radians())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Deserialize)]
    struct File {
        #[serde(default, deserialize_with = "color")]
        color: Rgb,
        #[serde(default, deserialize_with = "angle")]
        angle: f32,
    }

    fn read(text: &str) -> Result<File, String> {
        toml::from_str(text).map_err(|e| e.message().to_owned())
    }

    #[test]
    fn colours_are_lists_or_hex() {
        assert_eq!(read("color = [1, 0.5, 0]").unwrap().color, [1.0, 0.5, 0.0]);
        let [r, g, b] = read("color = '#ff8000'").unwrap().color;
        assert!(r == 1.0 && (g - 0.2158).abs() < 1e-3 && b == 0.0);
        assert_eq!(read("color = '#f80'").unwrap().color, hex("#ff8800").unwrap());
        for bad in ["'ff8800'", "'#ff88'", "'#gg0000'", "'#'", "'#é0000'", "[1, 2]", "3"] {
            let message = read(&format!("color = {bad}")).err().unwrap();
            assert!(message.contains("3"), "{bad}: {message}");
        }
    }

    #[test]
    fn angles_are_radians_or_degrees() {
        assert_eq!(read("angle = 1.5").unwrap().angle, 1.5);
        assert_eq!(read("angle = -2").unwrap().angle, -2.0);
        assert_eq!(read("angle = '90deg'").unwrap().angle, std::f32::consts::FRAC_PI_2);
        for bad in ["'90'", "'deg'", "'xdeg'", "[1]"] {
            assert!(read(&format!("angle = {bad}")).err().unwrap().contains("deg"), "{bad}");
        }
    }
}
