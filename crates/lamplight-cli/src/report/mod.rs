//! The report of `lamplight compare`: a folder with a page and its pictures.

mod page;

use crate::contest::{Judge, Refusal, Row};
use crate::failure::{Failure, Outcome};
use crate::lighting::ms;
use crate::output;
use crate::place::Place;
use crate::stage::enlarge;
use lamplight::{Light, Method};
use lamplight_cli::plot::{self, Point, Series};
use lamplight_truth::heat;
use std::path::Path;
use std::time::Duration;

/// The file to open.
pub const PAGE: &str = "index.html";

/// What everything is compared with.
pub struct Reference {
    /// Paths a pixel.
    pub samples: u32,
    /// Cells that were traced, where not all were.
    pub cells: Option<u32>,
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
        let Self { samples, cells, standard_error, time } = self;
        let of_cells = cells.map_or_else(String::new, |count| format!(" at {count} open cells"));
        let mut words = format!(
            "reference: path tracer on the CPU, {samples} paths a pixel{of_cells}, {:.0} ms; its own standard \
             error is {:.2} % of the mean light",
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
    /// Where the methods ran.
    pub place: &'a Place,
    pub judge: &'a Judge<'a>,
    /// The light of the reference.
    pub truth: &'a Light,
    pub reference: &'a Reference,
    pub rows: &'a [Row],
    pub refusals: &'a [Refusal],
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
        ("reference.png".to_owned(), final_picture(subject.truth)?),
        (PAGE.to_owned(), page::page(subject, &error_against_time(subject)?).into_bytes()),
    ];
    for (i, row) in subject.rows.iter().enumerate() {
        let heat = heat::map(&row.light, subject.truth, row.measures.mean);
        files.push((page::picture_file(i), final_picture(&row.light)?));
        files.push((page::error_file(i), output::png(&enlarge(&heat, subject.scale)?)?));
    }
    // The page last: while it is missing, its pictures are not complete.
    files.sort_by_key(|(name, _)| name == PAGE);
    files.iter().try_for_each(|(name, bytes)| output::write(&folder.join(name), bytes))
}

/// The plot, as an SVG that takes its width from the page.
fn error_against_time(subject: &Subject) -> Outcome<String> {
    let mut series: Vec<Series> = Vec::new();
    for method in Method::ALL {
        let rows = subject.rows.iter().filter(|row| row.method == *method);
        let point = |row: &Row| Point {
            label: row.label.clone(),
            ms: ms(row.time),
            error: row.measures.relative_rmse,
            parts: Vec::new(),
        };
        let points: Vec<Point> = rows.map(point).collect();
        if !points.is_empty() {
            series.push(Series { name: method.name(), color: plot::color(*method), points });
        }
    }
    let svg = plot::plot(&series, subject.reference.standard_error)
        .map_err(|e| Failure::failed(format_args!("cannot draw the plot: {e}")))?;
    Ok(plot::scalable(&svg))
}
