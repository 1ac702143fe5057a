//! Lists of a fixed length, read strictly.
//!
//! serde's own arrays stop reading when they are full, and not every format rejects the rest: in
//! TOML `center = [1, 2, 3]` would be read as a point.

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// Exactly `N` values.
pub(crate) struct Exact<T, const N: usize>(pub [T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for Exact<T, N> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Strict<T, const N: usize>(PhantomData<T>);

        impl<'de, T: Deserialize<'de>, const N: usize> Visitor<'de> for Strict<T, N> {
            type Value = Exact<T, N>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                write!(f, "a list of {N} numbers")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
                let mut values = Vec::with_capacity(N);
                let mut found = 0;
                while let Some(value) = list.next_element()? {
                    found += 1;
                    if found <= N {
                        values.push(value);
                    }
                }
                match values.try_into() {
                    Ok(values) if found == N => Ok(Exact(values)),
                    _ => Err(A::Error::invalid_length(found, &self)),
                }
            }
        }

        from.deserialize_seq(Strict(PhantomData))
    }
}

/// Deserializes a point or a colour, for `#[serde(deserialize_with)]`.
pub(crate) fn one<'de, D, T, const N: usize>(from: D) -> Result<[T; N], D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    Exact::deserialize(from).map(|exact| exact.0)
}

/// Deserializes an optional point or colour.
pub(crate) fn option<'de, D, T, const N: usize>(from: D) -> Result<Option<[T; N]>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    Ok(Option::<Exact<T, N>>::deserialize(from)?.map(|exact| exact.0))
}

/// Deserializes a list of points.
pub(crate) fn list<'de, D, T, const N: usize>(from: D) -> Result<Vec<[T; N]>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    Ok(Vec::<Exact<T, N>>::deserialize(from)?.into_iter().map(|exact| exact.0).collect())
}
