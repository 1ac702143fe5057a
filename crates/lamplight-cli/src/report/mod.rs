//! The report of `lamplight compare`: a folder with a page and its pictures.

mod heat;
mod page;
mod plot;

use crate::contest::{Judge, Row};
use crate::failure::Outcome;
use crate::lighting::ms;
use crate::output;
use crate::stage::enlarge;
use lamplight::Light;
use std::path::Path;
use std::time::Duration;

/// The file to open.
pub const PAGE: &str = "index.html";

/// What everything is compared with.
pub struct Reference {
    /// Paths a pixel.
    pub samples: u32,
    /// Its own standard error, relative as the relative RMSE is.
    pub standard_error: f64,
    /// What it took.
    pub time: Duration,
}

impl Reference {
    /// A measured error holds the reference's own, which adds in squares: up to this share of the
    /// error it changes it by 2 %.
    const TRUSTED_SHARE: f64 = 0.2;

    /// What it is, and which rows it can judge.
    pub fn words(&self, rows: &[Row]) -> String {
        let Self { samples, standard_error, time } = self;
        let mut words = format!(
            "reference: path tracer, {samples} paths a pixel, {:.0} ms; its own standard error is \
             {:.2} % of the mean light",
            ms(*time),
            standard_error * 100.0
        );
        let least = rows.iter().map(|row| row.measures.relative_rmse).fold(f64::INFINITY, f64::min);
        if least * Self::TRUSTED_SHARE < *standard_error {
            words += &format!(
                ".\nThat is more than a fifth of the least error above, so that errors under \
                 {:.1} % look larger than they are; more --samples bring it down, four times as \
                 many to about half",
                standard_error / Self::TRUSTED_SHARE * 100.0,
            );
        }
        words + "."
    }
}

/// What a report is about.
pub struct Subject<'a> {
    pub name: &'a str,
    pub bounces: &'a str,
    pub threads: usize,
    pub judge: &'a Judge<'a>,
    pub reference: &'a Reference,
    pub rows: &'a [Row],
    /// Pictures show each cell so large.
    pub scale: u32,
}

/// Writes the page and its pictures into a directory.
pub fn write(folder: &Path, subject: &Subject) -> Outcome {
    let final_picture = |light: &Light| -> Outcome<Vec<u8>> {
        let picture = light.compose(subject.judge.cells, &subject.judge.display)?;
        output::png(&enlarge(&picture, subject.scale)?)
    };
    let mut files = vec![
        ("reference.png".to_owned(), final_picture(subject.judge.truth)?),
        (
            PAGE.to_owned(),
            page::page(subject, &plot::plot(subject.rows, subject.reference.standard_error)?)
                .into_bytes(),
        ),
    ];
    for (i, row) in subject.rows.iter().enumerate() {
        let heat = heat::map(&row.light, subject.judge.truth, row.measures.mean);
        files.push((page::picture_file(i), final_picture(&row.light)?));
        files.push((page::error_file(i), output::png(&enlarge(&heat, subject.scale)?)?));
    }
    // The page last: while it is missing, its pictures are not complete.
    files.sort_by_key(|(name, _)| name == PAGE);
    files.iter().try_for_each(|(name, bytes)| output::write(&folder.join(name), bytes))
}
