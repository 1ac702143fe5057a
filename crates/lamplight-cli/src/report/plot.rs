//! The plot of error against time, both logarithmic.

use crate::contest::{Row, Series};
use crate::failure::{Failure, Outcome};
use crate::lighting::ms;
use plotters::prelude::*;

/// Size of the plot, px; it scales with the page.
pub const SIZE: (u32, u32) = (960, 540);
const INK: RGBColor = RGBColor(214, 211, 204);
const GRID: RGBColor = RGBColor(52, 52, 60);
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

/// An SVG of relative RMSE over ms a frame; series with several rows are lines.
pub fn plot(rows: &[Row]) -> Outcome<String> {
    let mut svg = String::new();
    draw(&mut svg, rows).map_err(|e| Failure::failed(format_args!("cannot draw the plot: {e}")))?;
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
    if high > 0.0 { low / 1.6..high * 2.2 } else { 1.0..10.0 }
}

fn draw(svg: &mut String, rows: &[Row]) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    let x = range(rows.iter().map(|row| place(row).0));
    let y = range(rows.iter().map(|row| place(row).1));
    let mut chart = ChartBuilder::on(&root)
        .margin(16)
        .x_label_area_size(48)
        .y_label_area_size(64)
        .build_cartesian_2d(x.log_scale(), y.log_scale())?;
    chart
        .configure_mesh()
        .x_desc("ms a frame")
        .y_desc("relative RMSE, %")
        .label_style((FONT, 15).into_font().color(&INK))
        .axis_desc_style((FONT, 16).into_font().color(&INK))
        .axis_style(INK)
        .bold_line_style(GRID)
        .light_line_style(GRID.mix(0.4))
        .x_label_formatter(&|v| tick(*v))
        .y_label_formatter(&|v| tick(*v))
        .draw()?;
    let mut series: Vec<Series> = Vec::new();
    for row in rows {
        if !series.contains(&row.series) {
            series.push(row.series);
        }
    }
    for series in series {
        let style = color(series);
        let members: Vec<&Row> = rows.iter().filter(|row| row.series == series).collect();
        if matches!(series, Series::Rays | Series::Temporal) {
            let line = members.iter().map(|row| place(row));
            chart.draw_series(LineSeries::new(line, style.stroke_width(2)))?;
        }
        chart.draw_series(members.iter().map(|row| {
            let (_, words) = row.name.split_once(", ").unwrap_or(("", &row.name));
            EmptyElement::at(place(row))
                + Circle::new((0, 0), 5, style.filled())
                + Text::new(words.to_owned(), (9, -16), (FONT, 14).into_font().color(&style))
        }))?;
    }
    root.present()?;
    Ok(())
}

/// A number without digits that say nothing.
fn tick(v: f64) -> String {
    if v >= 1.0 { format!("{v:.0}") } else { format!("{v:.2}").trim_end_matches('0').to_owned() }
}
