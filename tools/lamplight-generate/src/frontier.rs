//! Error against time of every method and preset over the example scenes: the plot and the tables of
//! docs/methods.md.

use anyhow::{Context, Result, anyhow};
use lamplight::Method;
use lamplight_cli::plot::{self, Point, Series};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write;

/// Open cells that a scene is judged by, picked at random.
pub const CELLS: &str = "2000";
/// Paths a cell of the reference.
pub const SAMPLES: &str = "16384";

/// Times and errors of the presets in a scene.
pub struct Scene {
    name: &'static str,
    /// The reference's own relative error.
    own: f64,
    /// For each method that could, its presets: time in ms and relative RMSE.
    rows: Vec<(Method, String, f64, f64)>,
    /// Methods that could not light it.
    refused: BTreeSet<&'static str>,
}

impl Scene {
    /// Reads the output of `lamplight compare --json` for a scene.
    pub fn read(name: &'static str, said: &str) -> Result<Self> {
        let said: Value = serde_json::from_str(said)?;
        let number =
            |value: &Value| value.as_f64().with_context(|| format!("no number in {name}: {value}"));
        let method = |row: &Value| {
            let known = Method::ALL.iter().copied();
            known.clone().find(|m| row["method"] == m.name()).context("an unknown method")
        };
        let list = |key: &str| said[key].as_array().with_context(|| format!("{name}: no {key}"));
        let mut rows = Vec::new();
        for row in list("rows")? {
            if let Some(preset) = row["preset"].as_str() {
                let error = number(&row["relative_rmse"])?;
                rows.push((method(row)?, preset.to_owned(), number(&row["ms"])?, error));
            }
        }
        let refused = list("refused")?.iter().map(|row| Ok(method(row)?.name()));
        Ok(Self {
            name,
            own: number(&said["reference"]["relative_standard_error"])?,
            rows,
            refused: refused.collect::<Result<_>>()?,
        })
    }

    fn row(&self, method: Method, preset: &str) -> Option<(f64, f64)> {
        let row = self.rows.iter().find(|row| row.0 == method && row.1 == preset);
        row.map(|&(_, _, ms, error)| (ms, error))
    }
}

/// The plot: a point for each preset, the geometric mean over the scenes that it can light, and a
/// small one for each of these.
pub fn svg(scenes: &[Scene]) -> Result<String> {
    let mut series = Vec::new();
    for &method in Method::ALL {
        let mut points = Vec::new();
        for &preset in method.presets() {
            let parts = parts(scenes, method, preset);
            if let Some((ms, error)) = mean(&parts) {
                let label = match scenes.len() {
                    all if parts.len() < all => format!("{preset}, {} scenes", parts.len()),
                    _ => preset.to_owned(),
                };
                points.push(Point { label, ms, error, parts });
            }
        }
        if !points.is_empty() {
            series.push(Series { name: method.name(), color: plot::color(method), points });
        }
    }
    let own: Vec<(f64, f64)> = scenes.iter().map(|scene| (1.0, scene.own)).collect();
    let noise = mean(&own).map_or(0.0, |(_, own)| own);
    plot::plot(&series, noise).map_err(|e| anyhow!("cannot draw the plot: {e}"))
}

/// Errors by scene; and the means that the plot shows.
pub fn table(scenes: &[Scene]) -> Result<String> {
    let mut text = String::from("| method | preset |");
    scenes.iter().for_each(|scene| text += &format!(" {} |", scene.name));
    text += " mean | per frame |\n| --- | --- |";
    text += &" --- |".repeat(scenes.len() + 2);
    text.push('\n');
    let percent = |v: f64| format!("{:.1} %", 100.0 * v);
    for &method in Method::ALL {
        for &preset in method.presets() {
            write!(text, "| {} | {preset} |", method.name())?;
            for scene in scenes {
                let error = scene.row(method, preset).map(|(_, error)| percent(error));
                write!(text, " {} |", error.as_deref().unwrap_or("–"))?;
            }
            match mean(&parts(scenes, method, preset)) {
                Some((ms, error)) => writeln!(text, " {} | {ms:.1} ms |", percent(error))?,
                None => writeln!(text, " – | – |")?,
            }
        }
    }
    write!(text, "| *reference's own* | |")?;
    scenes.iter().for_each(|scene| text += &format!(" {:.2} % |", 100.0 * scene.own));
    text += " | |\n";
    let refused: BTreeSet<_> = scenes.iter().flat_map(|scene| &scene.refused).copied().collect();
    for method in refused {
        let cannot = scenes.iter().filter(|scene| scene.refused.contains(method));
        let names: Vec<_> = cannot.map(|scene| scene.name).collect();
        writeln!(text, "\n`{method}` cannot light {}.", names.join(", "))?;
    }
    Ok(text)
}

/// Time and error of a preset in the scenes that it can light.
fn parts(scenes: &[Scene], method: Method, preset: &str) -> Vec<(f64, f64)> {
    scenes.iter().filter_map(|scene| scene.row(method, preset)).collect()
}

/// Geometric means of both; none of nothing.
fn mean(parts: &[(f64, f64)]) -> Option<(f64, f64)> {
    let n = parts.len() as f64;
    let of = |part: fn(&(f64, f64)) -> f64| {
        // Logarithms of 0 are cut off: an error of nothing at all is no error of a mean.
        (parts.iter().map(|p| part(p).max(1e-9).ln()).sum::<f64>() / n).exp()
    };
    (!parts.is_empty()).then(|| (of(|p| p.0), of(|p| p.1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An output of `compare`: one time and one error for all presets of a method.
    fn said(ms: f64, error: f64) -> String {
        let rows: Vec<Value> = Method::Raymarch
            .presets()
            .iter()
            .map(|preset| {
                serde_json::json!({ "method": "raymarch", "preset": preset, "ms": ms,
                                    "relative_rmse": error })
            })
            .chain([serde_json::json!({ "method": "raymarch", "preset": null })])
            .collect();
        serde_json::json!({ "rows": rows, "refused": [],
                            "reference": { "relative_standard_error": 0.005 } })
        .to_string()
    }

    #[test]
    fn means_are_geometric_and_every_preset_is_shown() {
        let scenes = [("a", 1.0, 0.01), ("b", 100.0, 0.04)]
            .map(|(name, ms, error)| Scene::read(name, &said(ms, error)).unwrap());
        let table = table(&scenes).unwrap();
        assert!(
            table.contains("| raymarch | default | 1.0 % | 4.0 % | 2.0 % | 10.0 ms |"),
            "{table}"
        );
        let svg = svg(&scenes).unwrap();
        for preset in Method::Raymarch.presets() {
            assert!(table.contains(preset) && svg.contains(preset), "{preset}");
        }
    }

    #[test]
    fn a_method_that_cannot_light_a_scene_is_named() {
        let mut scene = Scene::read("a", &said(1.0, 0.1)).unwrap();
        scene.rows.clear();
        scene.refused.insert("raymarch");
        let table = table(&[scene]).unwrap();
        assert!(table.contains("| raymarch | default | – | – | – |"), "{table}");
        assert!(table.contains("`raymarch` cannot light a."), "{table}");
        assert!(Scene::read("a", "{}").is_err());
    }
}
