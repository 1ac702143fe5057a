//! Panoramas: skies that are a strip of radiance over the angle of the direction.

use crate::check::BRIGHT;
use crate::{Error, Result, Rgb, notation};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

/// A sky that differs all the way round: columns of radiance, evenly spread over the circle.
///
/// The strip is the circle, cut straight down and unrolled: from left to right its columns are seen straight down, to
/// the left, straight up (in the middle), to the right, and straight down again. Column k of n is seen at the angle
/// `π/2 + 2π·(k + ½)/n + turn`, radians from +x towards +y (y points down). Radiance is linear in the angle between the
/// middles of neighbouring columns, and so between the last one and the first.
///
/// A clone shares the columns. Memory grows with their number, and so does the time of rays that see many of them.
///
/// ```
/// use lamplight::{Panorama, Sky};
/// // Straight down, left, up and right are between these four columns.
/// let (night, fire) = ([0.0, 0.0, 0.1], [4.0, 1.0, 0.2]);
/// let sunset = Panorama::new(&[night, night, night, fire])?;
/// assert_eq!(sunset.radiance([0.5f32.sqrt(), 0.5f32.sqrt()]), fire);
/// // A quarter turn later, it is the sky of the lower left.
/// let later = Sky::from(sunset.turned(std::f32::consts::FRAC_PI_2));
/// assert!(later.radiance([-1.0, 1.0])[0] > 3.9);
/// # Ok::<(), lamplight::Error>(())
/// ```
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields, description = "A sky that differs all the way round.")]
pub struct Panorama {
    /// Linear RGB radiance from straight down, left, up, right to down again: 1 to 8192 columns.
    #[serde(serialize_with = "list")]
    #[schemars(with = "Vec<notation::Color>", length(min = 1, max = 8192))]
    columns: Arc<[Rgb]>,
    /// The angle by which the sky is turned, radians from +x towards +y.
    #[serde(skip_serializing_if = "notation::is_zero")]
    #[schemars(default, with = "notation::Angle")]
    turn: f32,
}

fn list<S: Serializer>(columns: &Arc<[Rgb]>, to: S) -> Result<S::Ok, S::Error> {
    columns[..].serialize(to)
}

impl Panorama {
    /// The largest number of columns: the width of the smallest texture that every GPU has.
    pub const MAX_COLUMNS: usize = 8192;
    pub(crate) const EXPECTED: &'static str = "a list of 1 to 8192 colours";

    /// Creates a panorama from its columns, linear RGB.
    ///
    /// # Errors
    /// Fails if there is no column or there are more than [`Self::MAX_COLUMNS`], or a radiance is not from 0 to 1e12.
    pub fn new(columns: &[Rgb]) -> Result<Self> {
        let wrong =
            || Error::value("sky.columns", format!("a list of {}", columns.len()), Self::EXPECTED);
        let panorama = Self::of(columns).ok_or_else(wrong)?;
        panorama.check()?;
        Ok(panorama)
    }

    /// A panorama of values that are not checked; `None` if there are too few or too many.
    pub(crate) fn of(columns: &[Rgb]) -> Option<Self> {
        let fits = (1..=Self::MAX_COLUMNS).contains(&columns.len());
        fits.then(|| Self { columns: columns.into(), turn: 0.0 })
    }

    /// Turns the sky as a whole to this angle, radians from +x towards +y: clockwise on the screen. Whole turns are left
    /// out.
    #[must_use]
    pub fn turned(self, turn: f32) -> Self {
        Self { turn: (f64::from(turn) % TAU) as f32, ..self }
    }

    /// The columns.
    pub fn columns(&self) -> &[Rgb] {
        &self.columns
    }

    /// The angle by which the sky is turned, radians.
    pub fn turn(&self) -> f32 {
        self.turn
    }

    /// The radiance along a ray of this direction, of any length.
    #[inline]
    pub fn radiance(&self, [x, y]: [f32; 2]) -> Rgb {
        let at = place(self, f64::from(y.atan2(x)));
        radiance_of_columns(&self.columns, at).map(|v| v as f32)
    }

    /// The mean radiance between two angles, radians from +x towards +y, the first below the second. It is exact, and
    /// takes time by the number of columns between the angles.
    pub fn mean(&self, from: f64, to: f64) -> Rgb {
        let [from, to] = [from, to].map(|angle| place(self, angle));
        mean_of_columns(&self.columns, from, to).map(|v| v as f32)
    }

    /// The angle of the middle of a column of a strip of this many, radians from +x towards +y.
    pub(crate) fn angle(count: usize, column: usize) -> f64 {
        FRAC_PI_2 + TAU * (column as f64 + 0.5) / count as f64
    }

    pub(crate) fn check(&self) -> Result<()> {
        if !self.turn.is_finite() {
            return Err(Error::value("sky.turn", self.turn, "a finite angle"));
        }
        let wrong = |rgb: &Rgb| !rgb.iter().all(|v| (0.0..=BRIGHT).contains(v));
        match self.columns.iter().position(wrong) {
            None => Ok(()),
            Some(column) => {
                let [r, g, b] = self.columns[column];
                let expected = "three radiances from 0 to 1e12";
                Err(Error::value(
                    format!("sky.columns[{column}]"),
                    format!("[{r}, {g}, {b}]"),
                    expected,
                ))
            }
        }
    }
}

/// Returns the place of an angle on the strip, in columns from the middle of the first.
pub fn place(panorama: &Panorama, angle: f64) -> f64 {
    column(panorama.columns.len(), angle - f64::from(panorama.turn))
}

/// Returns the place of an angle on a strip of `count` columns, in columns from the middle of the first.
pub fn column(count: usize, angle: f64) -> f64 {
    (angle - FRAC_PI_2) / TAU * count as f64 - 0.5
}

/// Returns the radiance at a place on a strip.
#[inline]
pub(crate) fn radiance_of_columns(columns: &[Rgb], at: f64) -> [f64; 3] {
    let column = at.floor();
    between(columns, column, at - column)
}

/// Returns the mean radiance between two places on a strip.
pub(crate) fn mean_of_columns(columns: &[Rgb], from: f64, to: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for StripPart { column, length, past } in strip_parts(from, to) {
        let middle = between(columns, column, past);
        (0..3).for_each(|c| sum[c] += length * middle[c]);
    }
    sum.map(|v| v / (to - from))
}

/// A part of a strip between the middles of two columns. Radiance is linear there: its mean is that in the middle.
pub(crate) struct StripPart {
    /// The first of the columns, which may lie on another turn around the circle.
    pub column: f64,
    /// The length of the part, in columns.
    pub length: f64,
    /// The place of its middle, in columns from the first.
    pub past: f64,
}

/// Returns the parts of a strip between two places.
pub(crate) fn strip_parts(from: f64, to: f64) -> impl Iterator<Item = StripPart> {
    let columns = std::iter::successors(Some(from.floor()), |column| Some(column + 1.0));
    columns.take_while(move |column| *column < to).map(move |column| {
        let [start, end] = [from.max(column) - column, to.min(column + 1.0) - column];
        StripPart { column, length: end - start, past: 0.5 * (start + end) }
    })
}

/// Returns the radiance between a column and the next, at a fraction of the way.
#[inline]
fn between(columns: &[Rgb], column: f64, past: f64) -> [f64; 3] {
    let first = (column as i64).rem_euclid(columns.len() as i64) as usize;
    let next = if first + 1 == columns.len() { 0 } else { first + 1 };
    let (a, b) = (&columns[first], &columns[next]);
    let mixed = |c: usize| f64::from(a[c]) + (f64::from(b[c]) - f64::from(a[c])) * past;
    // Not by the functions of arrays, which debug builds call one by one.
    [mixed(0), mixed(1), mixed(2)]
}

impl PartialEq for Panorama {
    fn eq(&self, other: &Self) -> bool {
        // Most are clones of each other.
        let same = Arc::ptr_eq(&self.columns, &other.columns) || self.columns == other.columns;
        same && self.turn == other.turn
    }
}
