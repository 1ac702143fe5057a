//! The profile of a cone: how bright its beam is from edge to edge, by angle; a cookie is a picture by place.

use crate::{Error, Result};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserialize, Deserializer, Error as _, SeqAccess, Visitor};
use serde::ser::{Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;

/// The brightness of a cone from one edge to the other, in the direction of growing angles: 2 to 16 values of 0 to 1, evenly
/// spread and linear in between.
///
/// ```
/// use lamplight::Profile;
/// let profile = Profile::new(&[0.0, 1.0, 0.5])?;
/// assert_eq!([0.0, 0.25, 0.5, 1.0].map(|place| profile.at(place)), [0.0, 0.5, 1.0, 0.5]);
/// # Ok::<(), lamplight::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    /// The values, and 0 after them.
    values: [f32; Self::MOST],
    count: usize,
}

impl Profile {
    /// The smallest and the largest number of values.
    const FEWEST: usize = 2;
    const MOST: usize = 16;
    const EXPECTED: &'static str = "a list of 2 to 16 numbers";

    /// Creates a profile.
    ///
    /// # Errors
    /// Fails if there are too few or too many values, or one is not from 0 to 1.
    pub fn new(values: &[f32]) -> Result<Self> {
        let wrong =
            || Error::value("profile", format!("a list of {}", values.len()), Self::EXPECTED);
        let profile = Self::of(values).ok_or_else(wrong)?;
        profile.check(&"profile")?;
        Ok(profile)
    }

    /// A profile of values that are not checked; `None` if there are too few or too many.
    fn of(list: &[f32]) -> Option<Self> {
        let count = list.len();
        if !(Self::FEWEST..=Self::MOST).contains(&count) {
            return None;
        }
        let mut values = [0.0; Self::MOST];
        values[..count].copy_from_slice(list);
        Some(Self { values, count })
    }

    /// The values.
    pub fn values(&self) -> &[f32] {
        &self.values[..self.count]
    }

    /// The brightness at a place from edge (0) to edge (1).
    pub fn at(&self, place: f32) -> f32 {
        let at = place.clamp(0.0, 1.0) * (self.count - 1) as f32;
        let first = (at as usize).min(self.count - 2);
        let [a, b] = [self.values[first], self.values[first + 1]];
        a + (b - a) * (at - first as f32)
    }

    /// Rejects values out of their range.
    pub(crate) fn check(&self, key: &dyn fmt::Display) -> Result<()> {
        let mut values = self.values().iter().enumerate();
        match values.find(|(_, value)| !(0.0..=1.0).contains(*value)) {
            None => Ok(()),
            Some((i, value)) => {
                Err(Error::value(format!("{key}[{i}]"), value, "a number from 0 to 1"))
            }
        }
    }
}

impl Serialize for Profile {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.values().serialize(to)
    }
}

impl<'de> Deserialize<'de> for Profile {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct List;

        impl<'de> Visitor<'de> for List {
            type Value = Profile;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(Profile::EXPECTED)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Profile, A::Error> {
                let (mut values, mut count) = (Vec::with_capacity(Profile::MOST), 0);
                while let Some(value) = list.next_element()? {
                    count += 1;
                    // Longer lists are refused, and not kept.
                    if count <= Profile::MOST + 1 {
                        values.push(value);
                    }
                }
                Profile::of(&values).ok_or_else(|| A::Error::invalid_length(count, &self))
            }
        }

        from.deserialize_seq(List)
    }
}

impl JsonSchema for Profile {
    fn schema_name() -> Cow<'static, str> {
        "Profile".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": "array",
            "items": { "type": "number", "minimum": 0, "maximum": 1 },
            "minItems": Self::FEWEST,
            "maxItems": Self::MOST,
        })
    }
}
