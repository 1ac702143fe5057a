//! The plot of error against time, both logarithmic.

use crate::contest::{Row, Series};
use crate::failure::{Failure, Outcome};
use crate::lighting::ms;
use plotters::prelude::*;

/// Size of the plot, px; it scales with the page.
pub const SIZE: (u32, u32) = (960, 540);
const INK: RGBColor = RGBColor(214, 211, 204);
const GRID: RGBColor = RGBColor(52, 52, 60);
/// Size of the labels, px.
const LABEL: i32 = 14;
const FONT: &str = "system-ui, sans-serif";

/// Colour of a series: Okabe and Ito's palette (2008), which colour-blind people can tell apart.
pub fn color(series: Series) -> RGBColor {
    match series {
        Series::AsSet => RGBColor(240, 228, 66),
        Series::Rays => RGBColor(86, 180, 233),
        Series::Denoise => RGBColor(0, 178, 128),
        Series::Preset => RGBColor(230, 159, 0),
        Series::Temporal => RGBColor(214, 130, 180),
    }
}

/// An SVG of relative RMSE over ms a frame; series with several rows are lines. A dashed line is at
/// `noise`, the reference's own relative error: no row can be seen to be better.
pub fn plot(rows: &[Row], noise: f64) -> Outcome<String> {
    let mut svg = String::new();
    draw(&mut svg, rows, noise * 100.0)
        .map_err(|e| Failure::failed(format_args!("cannot draw the plot: {e}")))?;
    // The page gives it its width.
    Ok(svg.replacen(
        &format!("width=\"{}\" height=\"{}\" ", SIZE.0, SIZE.1),
        "role=\"img\" aria-label=\"error against time\" ",
        1,
    ))
}

/// Time and error of a row; what cannot be on a logarithmic axis sits at its end.
fn place(row: &Row) -> (f64, f64) {
    let error = row.measures.relative_rmse * 100.0;
    (ms(row.time).max(1e-3), if error.is_finite() { error.max(1e-3) } else { 1e3 })
}

/// A range that holds all values, with room beside them.
fn range(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (low, high) =
        values.fold((f64::INFINITY, 0.0f64), |(low, high), v| (low.min(v), high.max(v)));
    if high > 0.0 { low / 1.5..high * 1.8 } else { 1.0..10.0 }
}

fn draw(svg: &mut String, rows: &[Row], noise: f64) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    let x = range(rows.iter().map(|row| place(row).0));
    let y = range(rows.iter().map(|row| place(row).1).chain([noise]).filter(|&v| v > 0.0));
    let (times, errors) = (ticks(&x), ticks(&y));
    let mut chart = ChartBuilder::on(&root)
        .margin(16)
        .x_label_area_size(48)
        .y_label_area_size(64)
        .build_cartesian_2d(
            x.clone().log_scale().with_key_points(times),
            y.log_scale().with_key_points(errors),
        )?;
    chart
        .configure_mesh()
        .x_desc("ms a frame")
        .y_desc("relative RMSE, %")
        .label_style((FONT, 15).into_font().color(&INK))
        .axis_desc_style((FONT, 16).into_font().color(&INK))
        .axis_style(INK)
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .x_label_formatter(&|v| tick(*v))
        .y_label_formatter(&|v| tick(*v))
        .draw()?;
    let mut series: Vec<Series> = Vec::new();
    for row in rows {
        if !series.contains(&row.series) {
            series.push(row.series);
        }
    }
    let dashes = DashedLineSeries::new([(x.start, noise), (x.end, noise)], 5, 5, INK.into());
    if noise > 0.0 {
        chart.draw_series(dashes)?;
    }
    for &series in &series {
        let members = rows.iter().filter(|row| row.series == series).map(place);
        if matches!(series, Series::Rays | Series::Temporal) {
            chart.draw_series(LineSeries::new(members.clone(), color(series).stroke_width(2)))?;
        }
        chart.draw_series(members.map(|at| Circle::new(at, 5, color(series).filled())))?;
    }
    let mut labels = Labels::default();
    if noise > 0.0 {
        let (left, y) = chart.backend_coord(&(x.start, noise));
        let (words, style) = ("noise of the reference", (FONT, LABEL).into_font().color(&INK));
        root.draw(&Text::new(words, labels.place((left, y), words), style))?;
    }
    for row in rows {
        labels.taken.push(Labels::around(chart.backend_coord(&place(row)), 5));
    }
    for row in rows {
        let words = row.name.split_once(", ").map_or(&*row.name, |(_, words)| words);
        let at = labels.place(chart.backend_coord(&place(row)), words);
        let style = (FONT, LABEL).into_font().color(&color(row.series));
        root.draw(&Text::new(words.to_owned(), at, style))?;
    }
    root.present()?;
    Ok(())
}

/// Places labels beside their points so that they cover neither each other nor a point.
#[derive(Default)]
struct Labels {
    /// Left, top, right, bottom of what is taken, px.
    taken: Vec<[i32; 4]>,
}

impl Labels {
    fn around((x, y): (i32, i32), reach: i32) -> [i32; 4] {
        [x - reach, y - reach, x + reach, y + reach]
    }

    /// The top left corner for a label of the point at `(x, y)`.
    fn place(&mut self, (x, y): (i32, i32), words: &str) -> (i32, i32) {
        // Fonts differ from screen to screen: 0.55 em a character is wide enough for most.
        let width = (words.chars().count() as f64 * f64::from(LABEL) * 0.55) as i32;
        let (right, left) = (x + 9, x - 9 - width);
        let beside = (0..8).flat_map(|line| {
            let (up, down) = (y - 16 - line * LABEL, y + 2 + line * LABEL);
            [(right, up), (right, down), (left, up), (left, down)]
        });
        let fits = |&(x, y): &(i32, i32)| {
            let inside = x >= 72 && x + width <= SIZE.0 as i32 && y >= 8;
            inside
                && self.taken.iter().all(|[left, top, right, bottom]| {
                    x > *right || x + width < *left || y > *bottom || y + LABEL < *top
                })
        };
        let at = beside.into_iter().find(fits).unwrap_or((right, y - 16));
        self.taken.push([at.0, at.1, at.0 + width, at.1 + LABEL]);
        at
    }
}

/// What is named on a logarithmic axis: 1, 2 and 5 times each power of ten.
fn ticks(range: &std::ops::Range<f64>) -> Vec<f64> {
    let powers = range.start.log10().floor() as i32..=range.end.log10().ceil() as i32;
    let all = powers.flat_map(|power| [1.0, 2.0, 5.0].map(|v| v * 10f64.powi(power)));
    all.filter(|v| range.contains(v)).collect()
}

/// A number without digits that say nothing.
fn tick(v: f64) -> String {
    if v >= 1.0 { format!("{v:.0}") } else { format!("{v:.3}").trim_end_matches('0').to_owned() }
}
