//! The report of `lamplight compare`: a folder with a page and its pictures.

mod page;
mod subject;

pub use subject::{ReferenceStats, Subject};

use crate::comparison::Row;
use crate::error::{CliError, Result};
use crate::lit::ms;
use crate::output::{self, OutputFiles};
use crate::plot::{self, Point, Series};
use crate::stage::enlarge;
use lamplight::{Light, Method};
use lamplight_truth::heat;
use std::path::Path;

/// The file to open.
pub const PAGE: &str = "index.html";

/// Rejects a folder in which a report with `rows` rows cannot be written.
pub fn check(folder: &Path, rows: usize, outputs: &OutputFiles) -> Result {
    let pictures = (0..rows).flat_map(|i| [page::picture_file(i), page::error_file(i)]);
    outputs.check_directory(folder, pictures.chain([page::REFERENCE, PAGE].map(str::to_owned)))
}

/// Writes the page and its pictures into a directory, which it makes if need be, and removes the pictures of the report
/// that was there before.
pub fn write(folder: &Path, subject: &Subject, outputs: &OutputFiles) -> Result {
    let final_picture = |light: &Light| -> Result<Vec<u8>> {
        let picture = light.compose(subject.evaluator.cells, &subject.evaluator.display)?;
        output::png(&enlarge(&picture, subject.scale)?)
    };
    let mut files = vec![
        (page::REFERENCE.to_owned(), final_picture(subject.truth)?),
        (PAGE.to_owned(), page::page(subject, &error_against_time(subject)?).into_bytes()),
    ];
    for (i, row) in subject.rows.iter().enumerate() {
        let heat = heat::map(&row.light, subject.truth, row.measures.mean);
        files.push((page::picture_file(i), final_picture(&row.light)?));
        files.push((page::error_file(i), output::png(&enlarge(&heat, subject.scale)?)?));
    }
    output::make_directory(folder)?;
    // A page that is not a report names no files to remove.
    let before = std::fs::read_to_string(folder.join(PAGE)).unwrap_or_default();
    let stale = page::pictures_of(&before);
    // The page comes last: while it is missing, its pictures are not complete.
    files.sort_by_key(|(name, _)| name == PAGE);
    files.iter().try_for_each(|(name, bytes)| outputs.write(&folder.join(name), bytes))?;
    let written = |name: &String| files.iter().any(|(file, _)| file == name);
    stale
        .iter()
        .filter(|name| !written(name))
        .try_for_each(|name| outputs.remove(&folder.join(name)))
}

/// The plot of error against time, as an SVG as wide as the page.
fn error_against_time(subject: &Subject) -> Result<String> {
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
        .map_err(|e| CliError::failed(format_args!("cannot draw the plot: {e}")))?;
    Ok(plot::scalable(&svg))
}
