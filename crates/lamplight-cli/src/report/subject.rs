//! The subject of a report: what was compared with which reference.

use crate::comparison::{Evaluator, Refusal, Row};
use crate::device_info::DeviceInfo;
use crate::lit::ms;
use lamplight::Light;
use std::time::Duration;

/// The path tracer's own error and time.
pub struct ReferenceStats {
    /// Paths per pixel.
    pub samples: u32,
    /// The number of traced cells, unless all are.
    pub cells: Option<u32>,
    /// The standard error, relative to the mean light as the relative RMSE is.
    pub standard_error: f64,
    pub time: Duration,
}

impl ReferenceStats {
    /// The fraction of a measured error that the reference's own may have. It adds in squares, so
    /// that it changes the measured error by 2 % at most.
    const TRUSTED_FRACTION: f64 = 0.2;

    /// A description of the reference, and of the rows that it is too noisy for.
    pub fn sentences(&self, rows: &[Row]) -> String {
        let Self { samples, cells, standard_error, time } = self;
        let of_cells = cells.map_or_else(String::new, |count| format!(" at {count} open cells"));
        let mut sentences = format!(
            "reference: path tracer on the CPU, {samples} paths per pixel{of_cells}, {:.0} ms; its own \
             standard error is {:.2} % of the mean light.",
            ms(*time),
            standard_error * 100.0
        );
        let least = rows.iter().map(|row| row.measures.relative_rmse).fold(f64::INFINITY, f64::min);
        if least * Self::TRUSTED_FRACTION < *standard_error {
            sentences += &format!(
                "\nNoise in the reference inflates errors below {:.1} %. Use more --samples: four times \
                 as many halve the noise.",
                standard_error / Self::TRUSTED_FRACTION * 100.0,
            );
        }
        sentences
    }
}

/// The subject of a report.
pub struct Subject<'a> {
    pub name: &'a str,
    pub bounces: &'a str,
    /// The device that the methods ran on.
    pub device: &'a DeviceInfo,
    pub evaluator: &'a Evaluator<'a>,
    /// The light of the reference.
    pub truth: &'a Light,
    pub reference: &'a ReferenceStats,
    pub rows: &'a [Row],
    pub refusals: &'a [Refusal],
    /// The pixels along each side of a cell in pictures.
    pub scale: u32,
}
