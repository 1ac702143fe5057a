//! `lamplight compare`: the methods against the path tracer.

use crate::args::{Machine, SettingFlags, Show, by_name};
use crate::contest::{self, Contest, Judge, Row, Truth};
use crate::failure::{Failure, Outcome};
use crate::gpu::Gpu;
use crate::lighting::{self, ms};
use crate::output;
use crate::place::Place;
use crate::report::{self, Reference};
use crate::table;
use lamplight::{Cells, Method, Rgb, Settings};
use lamplight_truth::scenes::open_cells;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Judge methods by the path tracer: a row for each preset, its errors and the time it takes
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The scene file (TOML or JSON)
    scene: PathBuf,
    /// Methods to judge, with commas between them [default: all]
    #[arg(long, value_name = "METHOD", value_delimiter = ',',
          value_parser = by_name(Method::ALL, Method::name))]
    methods: Vec<Method>,
    /// Paths a pixel of the reference
    #[arg(long, value_name = "N", default_value_t = 4096,
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    samples: u32,
    /// Judge more settings of each method beside its presets, such as more and more rays
    #[arg(long)]
    sweep: bool,
    /// Judge by so many open cells, picked at random, and not by all: quicker
    #[arg(long, value_name = "N", conflicts_with = "report",
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    cells: Option<u32>,
    /// Write a page with pictures, error maps and a plot into this directory
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    settings: SettingFlags,
    #[command(flatten)]
    machine: Machine,
    #[command(flatten)]
    show: Show,
}

pub fn run(args: Args) -> Outcome {
    let methods = if args.methods.is_empty() { Method::ALL } else { &args.methods };
    args.machine.run(|threads| {
        let quiet = args.machine.quiet;
        let (scene, cells) = lighting::open(&args.scene, quiet)?;
        let table_of_scene = args.settings.over(&scene.light)?;
        let settings = table_of_scene.resolve()?;
        let display = args.show.display(scene.display)?;
        let entries = contest::entries(methods, &table_of_scene, args.sweep)?;
        let gpu = Gpu::choose(args.machine.backend)?;
        let place = gpu.as_ref().map_or_else(Place::cpu, Gpu::place);
        if let Some(folder) = &args.report {
            output::make_directory(folder)?;
        }
        let (truth, reference) = truth(&args, &cells, &settings)?;
        let judge = Judge { cells: &cells, truth: &truth, display };
        let Contest { rows, refusals } = contest::run(&judge, entries, gpu.as_ref(), quiet)?;

        let name = args.scene.file_name().unwrap_or_default().to_string_lossy();
        let bounces = lighting::to_json(&settings.bounces)?;
        let bounces = bounces.as_str().map_or_else(|| bounces.to_string(), str::to_owned);
        if let (Some(folder), Truth::Everywhere(light)) = (&args.report, &truth) {
            let subject = report::Subject {
                name: &name,
                bounces: &bounces,
                place: &place,
                judge: &judge,
                truth: light,
                reference: &reference,
                rows: &rows,
                refusals: &refusals,
                scale: args.show.scale,
            };
            report::write(folder, &subject)?;
        }
        if args.json {
            let mut answer = json!({
                "scene": args.scene, "width": cells.width(), "height": cells.height(),
                "bounces": settings.bounces, "backend": place.backend(), "threads": threads,
                "reference": { "samples": reference.samples, "cells": args.cells,
                               "ms": ms(reference.time),
                               "relative_standard_error": reference.standard_error },
                "rows": rows.iter().map(row_json).collect::<Vec<_>>(),
                "refused": refusals.iter().map(|refusal| json!({
                    "method": refusal.method.name(), "reason": refusal.reason,
                })).collect::<Vec<_>>(),
            });
            if let Place::Gpu { adapter, .. } = place {
                answer["adapter"] = adapter.into();
            }
            return output::print(answer);
        }
        output::print(format_args!(
            "{name}: {}×{} cells, bounces {bounces}, {place}\n",
            cells.width(),
            cells.height(),
        ))?;
        let header = ["", "rel. RMSE %", "bias %", "p99 %", "FLIP", "ms a frame"];
        output::print(table::table(&header, &[0], rows.iter().map(row_cells)))?;
        for refusal in &refusals {
            output::print(format_args!("{}", refusal.words()))?;
        }
        output::print(format_args!("\n{}", reference.words(&rows)))?;
        if let Some(clock) = place.clock() {
            output::print(format_args!("times: of a frame {clock}."))?;
        }
        match &args.report {
            Some(folder) if !quiet => {
                output::print(format_args!("wrote {}", folder.join(report::PAGE).display()))
            }
            _ => Ok(()),
        }
    })
}

/// Traces the whole picture, or some cells of it.
fn truth(args: &Args, cells: &Cells, settings: &Settings) -> Outcome<(Truth, Reference)> {
    let samples = args.samples;
    let Some(count) = args.cells else {
        let (estimate, time) = lighting::trace(cells, settings, samples, args.machine.quiet)?;
        let standard_error = lighting::relative_standard_error(&estimate);
        return Ok((
            Truth::Everywhere(estimate.light),
            Reference { samples, cells: None, standard_error, time },
        ));
    };
    let at = open_cells(cells, count as usize, settings.seed);
    if at.is_empty() {
        return Err(Failure::bad_input("the scene has no open cell to judge by"));
    }
    let (seen, time) = lighting::trace_at(cells, settings, samples, &at)?;
    let standard_error = lighting::relative_error_of(seen.iter().copied());
    let light: Vec<Rgb> = seen.into_iter().map(|(light, _)| light).collect();
    Ok((Truth::At(at, light), Reference { samples, cells: Some(count), standard_error, time }))
}

fn row_cells(row: &Row) -> Vec<String> {
    let percent = |v: f64| format!("{:.2}", v * 100.0);
    let m = &row.measures;
    vec![
        row.name(),
        percent(m.relative_rmse),
        format!("{:+.2}", m.bias * 100.0),
        percent(m.p99),
        row.flip.map_or_else(String::new, |flip| format!("{flip:.4}")),
        format!("{:.1}", ms(row.time)),
    ]
}

fn row_json(row: &Row) -> Value {
    let m = &row.measures;
    json!({
        "name": row.name(), "method": row.method.name(), "preset": row.preset, "frames": row.frames,
        "relative_rmse": m.relative_rmse, "bias": m.bias, "median": m.median, "p99": m.p99,
        "flip": row.flip, "ms": ms(row.time),
    })
}
