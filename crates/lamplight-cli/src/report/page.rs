//! The page of the report: HTML with its style inside, pictures beside it.

use super::subject::{ReferenceStats, Subject};
use crate::comparison::{Refusal, Row};
use crate::lit::ms;
use crate::plot;
use lamplight_truth::heat;
use std::fmt::Write;

/// The mark of a page that this program made.
const GENERATOR: &str = "<meta name=\"generator\" content=\"lamplight compare\">";
/// The file name of the reference picture.
pub const REFERENCE: &str = "reference.png";

/// The pictures of rows that a page shows, if this program made it.
pub fn pictures_of(page: &str) -> Vec<String> {
    if !page.contains(GENERATOR) {
        return Vec::new();
    }
    let of_row = |name: &&str| {
        let number = name.strip_suffix("-error.png").or_else(|| name.strip_suffix(".png"));
        number.is_some_and(|n| n.len() >= 2 && n.bytes().all(|digit| digit.is_ascii_digit()))
    };
    let sources = page.split("src=\"").skip(1).filter_map(|rest| rest.split('"').next());
    sources.filter(of_row).map(str::to_owned).collect()
}

/// The file name of the final picture of a row.
pub fn picture_file(row: usize) -> String {
    format!("{row:02}.png")
}

/// The file name of the error map of a row.
pub fn error_file(row: usize) -> String {
    format!("{row:02}-error.png")
}

/// The page of a report; `plot` is an SVG.
pub fn page(subject: &Subject, plot: &str) -> String {
    let Subject { name, bounces, device, evaluator, reference, rows, refusals, .. } = subject;
    let name = escape(name);
    let (w, h) = (evaluator.cells.width(), evaluator.cells.height());
    let ReferenceStats { samples, standard_error, time, .. } = reference;
    format!(
        r#"<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
{GENERATOR}
<title>{name} · lamplight compare</title>
<style>
{style}</style>
</head>
<body>
<main>
<h1>{name}</h1>
<p class="dim">{w}×{h} cells · bounces: {bounces} · {device} · lamplight {version}</p>
<figure class="hero">
<img src="{REFERENCE}" width="{w}" height="{h}" alt="The reference picture of {name}">
<figcaption>The reference: a path tracer with {samples} paths per pixel, {seconds:.1} s on the CPU. Its own
standard error is {own:.2} % of the mean light.</figcaption>
</figure>

<h2>Errors and times</h2>
<div class="scroll">
<table>
<thead><tr><th></th><th>rel. RMSE</th><th></th><th>bias</th><th>p99</th>
<th>grain</th><th>FLIP</th><th>ms per frame</th></tr></thead>
<tbody>
{table}</tbody>
</table>
</div>
{refused}<p class="dim">Errors are those of the open cells ÷ the mean of the reference. A positive bias is too
bright; 99 of 100 values are off by less than p99; grain is the fine structure in even light, such as noise and
stripes; FLIP compares the final pictures as an eye
does, 0 to 1. Times are medians per frame{clock}.</p>

<h2>Error against time</h2>
<div class="plot">
{plot}
</div>
<p class="dim">Both axes are logarithmic: lower left is better. A line connects the settings of a method that no
other of them beats in both. Points near the dashed line may be better than they look: use more
<code>--samples</code> to see.</p>

<h2>Pictures and their errors</h2>
<p>Hold the pointer over a picture to see the reference in its place. Beside it, the size of each
cell's error ÷ the mean light:</p>
<div class="legend" style="--wall: {wall}"><span>{least} %</span>
<div class="scale" style="background: linear-gradient(90deg, {gradient})"></div>
<span>100 % and more</span><span class="wall">walls, not compared</span></div>
{cards}</main>
</body>
</html>
"#,
        style = include_str!("page.css"),
        bounces = escape(bounces),
        device = escape(&device.to_string()),
        clock = device.clock().map_or_else(String::new, |clock| format!(", {clock}")),
        version = env!("CARGO_PKG_VERSION"),
        seconds = time.as_secs_f64(),
        own = standard_error * 100.0,
        table = table(rows),
        refused = refused(refusals),
        wall = css(heat::WALL),
        least = heat::LEAST * 100.0,
        gradient = gradient(),
        cards = cards(rows, w, h),
    )
}

fn table(rows: &[Row]) -> String {
    let worst = rows.iter().map(|row| row.measures.relative_rmse).fold(0.0, f64::max);
    let mut html = String::new();
    for (i, row) in rows.iter().enumerate() {
        let m = &row.measures;
        let _ = writeln!(
            html,
            "<tr><td><a href=\"#row{i}\">{}</a></td><td>{:.2} %</td>\
             <td class=\"bar\"><i style=\"width: {:.1}%; background: {}\"></i></td>\
             <td>{:+.2} %</td><td>{:.2} %</td><td>{}</td><td>{}</td><td>{:.1}</td></tr>",
            escape(&row.name()),
            m.relative_rmse * 100.0,
            if worst > 0.0 { (m.relative_rmse / worst * 100.0).max(0.5) } else { 0.5 },
            css(plot::color(row.method)),
            m.bias * 100.0,
            m.p99 * 100.0,
            row.grain.map_or_else(String::new, |grain| format!("{:.2} %", grain * 100.0)),
            row.flip.map_or_else(String::new, |flip| format!("{flip:.4}")),
            ms(row.time),
        );
    }
    html
}

fn cards(rows: &[Row], w: u32, h: u32) -> String {
    let mut html = String::new();
    for (i, row) in rows.iter().enumerate() {
        let name = escape(&row.name());
        let _ = writeln!(
            html,
            "<section class=\"card\" id=\"row{i}\">\n\
             <h3>{name}<span>{:.2} % rel. RMSE · {:.1} ms per frame</span></h3>\n\
             <div class=\"pair\">\n\
             <span class=\"flip\" tabindex=\"0\">\
             <img src=\"{}\" width=\"{w}\" height=\"{h}\" alt=\"{name}\" loading=\"lazy\">\
             <img src=\"{REFERENCE}\" width=\"{w}\" height=\"{h}\" alt=\"\"></span>\n\
             <img src=\"{}\" width=\"{w}\" height=\"{h}\" alt=\"errors of {name}\" loading=\"lazy\">\n\
             </div>\n</section>",
            row.measures.relative_rmse * 100.0,
            ms(row.time),
            picture_file(i),
            error_file(i),
        );
    }
    html
}

/// Methods that could not light the scene.
fn refused(refusals: &[Refusal]) -> String {
    let line = |refusal: &Refusal| format!("<p>{}</p>\n", escape(&refusal.sentence()));
    refusals.iter().map(line).collect()
}

fn css([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The scale of the error maps as stops of a CSS gradient.
fn gradient() -> String {
    const STOPS: i32 = 16;
    let stop = |i: i32| css(heat::color(heat::LEAST.powf(1.0 - f64::from(i) / f64::from(STOPS))));
    (0..=STOPS).map(stop).collect::<Vec<_>>().join(", ")
}

/// A text with the characters escaped that have a meaning in HTML.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pictures_of_rows_on_a_page_of_ours_are_named() {
        let pictures = "<img src=\"00.png\"><img src=\"11-error.png\"><img src=\"reference.png\">\
                        <img src=\"../12.png\"><img src=\"cat.png\"><img src=\"1.png\">";
        assert_eq!(pictures_of(&format!("{GENERATOR}{pictures}")), ["00.png", "11-error.png"]);
        assert!(pictures_of(pictures).is_empty());
    }

    #[test]
    fn names_cannot_write_html() {
        assert_eq!(escape("<b> & \"c\""), "&lt;b&gt; &amp; &quot;c&quot;");
    }
}
