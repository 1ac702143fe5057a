//! The plot of error against time, both logarithmic, as an SVG.

use lamplight::Method;
use plotters::prelude::*;
use std::error::Error;
use std::ops::Range;

/// Size of the plot, px.
pub const SIZE: (u32, u32) = (960, 540);
const PAPER: RGBColor = RGBColor(27, 27, 32);
const INK: RGBColor = RGBColor(214, 211, 204);
const GRID: RGBColor = RGBColor(52, 52, 60);
/// Size of the labels, px.
const LABEL: i32 = 14;
/// Width of a character ÷ its size: fonts differ from screen to screen, this is enough for most.
const CHARACTER: f64 = 0.55;
const FONT: &str = "system-ui, sans-serif";
/// Radii of a point and of the small ones that it is the mean of, px.
const POINT: i32 = 5;
const PART: i32 = 2;

/// Okabe and Ito's palette (2008), which colour-blind people can tell apart, on dark.
const PALETTE: [RGBColor; 6] = [
    RGBColor(86, 180, 233),
    RGBColor(0, 178, 128),
    RGBColor(230, 159, 0),
    RGBColor(214, 130, 180),
    RGBColor(240, 228, 66),
    RGBColor(213, 94, 0),
];

/// The points of a method, one for each of its settings.
#[derive(Clone, Debug)]
pub struct Series {
    /// The method's name.
    pub name: &'static str,
    /// Red, green, blue.
    pub color: [u8; 3],
    /// Its settings, with their times and errors.
    pub points: Vec<Point>,
}

/// The time and the error of some settings.
#[derive(Clone, Debug)]
pub struct Point {
    /// The name of the settings.
    pub label: String,
    /// Time of a frame, ms.
    pub ms: f64,
    /// Relative RMSE; 1 is 100 %.
    pub error: f64,
    /// Times and errors that the point is the mean of, if it is one.
    pub parts: Vec<(f64, f64)>,
}

/// The colour of a method, the same in every plot and table.
pub fn color(method: Method) -> [u8; 3] {
    let index = Method::ALL.iter().position(|&m| m == method).unwrap_or_default();
    let RGBColor(r, g, b) = PALETTE[index % PALETTE.len()];
    [r, g, b]
}

/// Draws relative RMSE over ms per frame as an SVG.
///
/// A line, the frontier, connects the settings of a method that no other of them beats in both; all are
/// labelled. A dashed line marks `noise`, the reference's own relative error, if it is above 0: no
/// method can be measured to be better.
pub fn plot(series: &[Series], noise: f64) -> Result<String, Box<dyn Error>> {
    let mut svg = String::new();
    draw(&mut svg, series, noise * 100.0)?;
    Ok(svg)
}

/// Removes the size of an SVG by [`plot`], so it takes that of the page around it.
pub fn scalable(svg: &str) -> String {
    svg.replacen(
        &format!("width=\"{}\" height=\"{}\" ", SIZE.0, SIZE.1),
        "role=\"img\" aria-label=\"error against time\" ",
        1,
    )
}

/// The points that no other is both faster and better than, from the fastest to the best.
pub fn frontier(points: &[Point]) -> Vec<&Point> {
    let mut sorted: Vec<&Point> = points.iter().collect();
    sorted.sort_by(|a, b| a.ms.total_cmp(&b.ms).then(a.error.total_cmp(&b.error)));
    let mut frontier: Vec<&Point> = Vec::new();
    for point in sorted {
        if point.error < frontier.last().map_or(f64::INFINITY, |best| best.error) {
            frontier.push(point);
        }
    }
    frontier
}

/// Time and error in percent. Values that a logarithmic axis lacks are moved to its end.
fn place((ms, error): (f64, f64)) -> (f64, f64) {
    let error = error * 100.0;
    (ms.max(1e-3), if error.is_finite() { error.max(1e-3) } else { 1e3 })
}

fn middle(point: &Point) -> (f64, f64) {
    place((point.ms, point.error))
}

/// A range that holds all values, with a margin.
fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) =
        values.fold((f64::INFINITY, 0.0f64), |(low, high), v| (low.min(v), high.max(v)));
    if high > 0.0 { low / 1.5..high * 1.8 } else { 1.0..10.0 }
}

fn draw(svg: &mut String, series: &[Series], noise: f64) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&PAPER)?;
    let all = || series.iter().flat_map(|s| &s.points);
    let places: Vec<_> = all()
        .flat_map(|point| point.parts.iter().copied().chain([(point.ms, point.error)]))
        .map(place)
        .collect();
    let x = range(places.iter().map(|p| p.0));
    let y = range(places.iter().map(|p| p.1).chain([noise]).filter(|&v| v > 0.0));
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
        .x_desc("ms per frame")
        .y_desc("relative RMSE, %")
        .label_style((FONT, 15).into_font().color(&INK))
        .axis_desc_style((FONT, 16).into_font().color(&INK))
        .axis_style(INK)
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .x_label_formatter(&|v| tick(*v))
        .y_label_formatter(&|v| tick(*v))
        .draw()?;
    if noise > 0.0 {
        let dashes = DashedLineSeries::new([(x.start, noise), (x.end, noise)], 5, 5, INK.into());
        chart.draw_series(dashes)?;
    }
    for Series { color, points, .. } in series {
        let color = ink(*color);
        let parts = points.iter().flat_map(|point| &point.parts);
        let faint = color.mix(0.45).filled();
        chart.draw_series(parts.map(|&part| Circle::new(place(part), PART, faint)))?;
        let line = frontier(points).into_iter().map(middle);
        chart.draw_series(LineSeries::new(line, color.stroke_width(2)))?;
        let point = |point| Circle::new(middle(point), POINT, color.filled());
        chart.draw_series(points.iter().map(point))?;
    }

    let write = |words: &str, at: (i32, i32), color: RGBColor| {
        let style = (FONT, LABEL).into_font().color(&color);
        root.draw(&Text::new(words.to_owned(), at, style))
    };
    let mut labels = Labels::default();
    let widest = series.iter().map(|s| width(s.name)).max().unwrap_or_default();
    for (line, Series { name, color, .. }) in (0i32..).zip(series) {
        let at = (SIZE.0 as i32 - 28 - widest, 24 + line * (LABEL + 4));
        // Not a circle, which would look like a point of the plot.
        let swatch = [(at.0 - 18, at.1 + 3), (at.0 - 6, at.1 + LABEL - 3)];
        root.draw(&Rectangle::new(swatch, ink(*color).filled()))?;
        write(name, at, ink(*color))?;
        labels.taken.push([at.0 - 20, at.1 - 2, at.0 + widest, at.1 + LABEL + 2]);
    }
    for point in all() {
        let (x, y) = chart.backend_coord(&middle(point));
        labels.taken.push([x - POINT, y - POINT, x + POINT, y + POINT]);
    }
    if noise > 0.0 {
        let words = "noise of the reference";
        let at = labels.place(chart.backend_coord(&(x.start, noise)), words);
        write(words, at, INK)?;
    }
    for Series { color, points, .. } in series {
        for point in points {
            let at = labels.place(chart.backend_coord(&middle(point)), &point.label);
            write(&point.label, at, ink(*color))?;
        }
    }
    root.present()?;
    Ok(())
}

fn ink([r, g, b]: [u8; 3]) -> RGBColor {
    RGBColor(r, g, b)
}

/// Width of a label, px.
fn width(words: &str) -> i32 {
    (words.chars().count() as f64 * f64::from(LABEL) * CHARACTER) as i32
}

/// Places labels beside their points without covering another label or point.
#[derive(Default)]
struct Labels {
    /// Left, top, right, bottom of the occupied rectangles, px.
    taken: Vec<[i32; 4]>,
}

impl Labels {
    /// The top left corner for a label of the point at `(x, y)`.
    fn place(&mut self, (x, y): (i32, i32), words: &str) -> (i32, i32) {
        let width = width(words);
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

/// The labelled values of a logarithmic axis: 1, 2 and 5 times each power of ten.
fn ticks(range: &Range<f64>) -> Vec<f64> {
    let powers = range.start.log10().floor() as i32..=range.end.log10().ceil() as i32;
    let all = powers.flat_map(|power| [1.0, 2.0, 5.0].map(|v| v * 10f64.powi(power)));
    all.filter(|v| range.contains(v)).collect()
}

/// A number without trailing zeros.
fn tick(v: f64) -> String {
    if v >= 1.0 { format!("{v:.0}") } else { format!("{v:.3}").trim_end_matches('0').to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(label: &str, ms: f64, error: f64) -> Point {
        Point { label: label.to_owned(), ms, error, parts: Vec::new() }
    }

    #[test]
    fn the_frontier_has_the_points_that_no_other_beats() {
        let points = [
            point("slow and bad", 9.0, 0.5),
            point("good", 8.0, 0.01),
            point("fast", 1.0, 0.3),
            point("as fast, worse", 1.0, 0.4),
            point("between", 4.0, 0.1),
            point("broken", 2.0, f64::NAN),
        ];
        let names: Vec<_> = frontier(&points).iter().map(|p| p.label.clone()).collect();
        assert_eq!(names, ["fast", "between", "good"]);
    }

    #[test]
    fn every_series_is_named_and_every_point_labelled() {
        let series = [
            Series { name: "one", color: [1, 2, 3], points: vec![point("first", 1.0, 0.1)] },
            Series {
                name: "two",
                color: [4, 5, 6],
                points: vec![point("second", 0.0, 0.0), point("third", 3.0, f64::INFINITY)],
            },
        ];
        let svg = plot(&series, 0.01).unwrap();
        for words in ["one", "two", "first", "second", "third", "noise of the reference"] {
            assert!(svg.contains(words), "{words} is missing");
        }
        assert!(!plot(&series, 0.0).unwrap().contains("noise"));
        let page = scalable(&svg);
        let (tag, _) = page.split_once('>').unwrap();
        assert!(tag.contains("role=\"img\"") && !tag.contains(" width="), "{tag}");
        assert!(plot(&[], 0.0).is_ok());
    }
}
