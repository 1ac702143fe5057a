//! `lamplight compare`: the error and time of methods, measured against the path tracer.

use crate::args::{
    Backend, DisplayArgs, MachineArgs, Renderer, SettingArgs, by_name, wanted_bounces,
};
use crate::comparison::{self, Comparison, Entry, Evaluator, ReferenceLight, Row};
use crate::device_info::DeviceInfo;
use crate::error::{CliError, Result, warn};
use crate::gpu::Gpu;
use crate::input::Input;
use crate::job::read_cells;
use crate::json::to_json;
use crate::lit::ms;
use crate::memory::{self, SceneSize};
use crate::output;
use crate::report::{self, ReferenceStats};
use crate::solve;
use crate::table;
use crate::warnings;
use lamplight::{Bounces, Cells, Method, Rgb, Settings};
use lamplight_truth::scenes::open_cells;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Compare methods with the path tracer: errors and times, one row per preset
#[derive(clap::Args, Debug)]
pub struct CompareArgs {
    /// The scene file (TOML or JSON), or a map (.tmx, .world, .ldtk)
    scene: PathBuf,
    /// Methods to compare, separated by commas [default: all]
    #[arg(long, value_name = "METHOD", value_delimiter = ',',
          value_parser = by_name(Method::ALL, Method::name))]
    methods: Vec<Method>,
    /// Paths per pixel of the reference
    #[arg(long, value_name = "N", default_value_t = 4096,
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    samples: u32,
    /// Compare more settings of each method than its presets, such as more and more rays
    #[arg(long)]
    sweep: bool,
    /// Compare at N random open cells only, which is quicker
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
    settings: SettingArgs,
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    display: DisplayArgs,
}

pub fn run(args: CompareArgs) -> Result {
    let methods = if args.methods.is_empty() { Method::ALL } else { &args.methods };
    args.machine.run(|threads| {
        let quiet = args.machine.quiet;
        let scene = Input::load(&args.scene)?;
        let table = args.settings.over(&scene.settings(), Some(Renderer::Reference))?;
        let settings = table.resolve()?;
        let display = args.display.resolve(scene.display())?;
        let entries = comparison::entries(methods, &table, args.settings.quality, args.sweep)?;
        let (cells, outputs) = read_cells(&scene, &args.scene, quiet, |size| {
            needed(&args, &entries, &settings, size)
        })?;
        if (0..cells.len()).all(|i| cells.is_solid(i)) {
            let error = CliError::bad_input("every cell is solid: there is no light to compare");
            return Err(error.hint("methods are compared by the light of open cells"));
        }
        if !quiet {
            let bounces = wanted_bounces(&table, &settings);
            warn_of_what_is_ignored(&args, methods, &cells, &settings, bounces);
        }
        let gpu = Gpu::choose(args.machine.backend)?;
        let device = gpu.as_ref().map_or_else(DeviceInfo::cpu, Gpu::device_info);
        if let Some(folder) = &args.report {
            report::check(folder, entries.iter().map(Entry::rows).sum(), &outputs)?;
        }
        let (truth, reference) = trace_reference(&args, &cells, &settings)?;
        let evaluator = Evaluator { cells: &cells, truth: &truth, display };
        let Comparison { rows, refusals } =
            comparison::run(&evaluator, entries, gpu.as_ref(), quiet)?;

        let name = args.scene.file_name().unwrap_or_default().to_string_lossy();
        let bounces = to_json(&settings.bounces)?;
        let bounces = bounces.as_str().map_or_else(|| bounces.to_string(), str::to_owned);
        if let (Some(folder), ReferenceLight::Everywhere(truth)) = (&args.report, &truth) {
            let subject = report::Subject {
                name: &name,
                bounces: &bounces,
                device: &device,
                evaluator: &evaluator,
                truth: &truth.light,
                reference: &reference,
                rows: &rows,
                refusals: &refusals,
                scale: args.display.scale,
            };
            report::write(folder, &subject, &outputs)?;
        }
        if args.json {
            let mut answer = json!({
                "scene": args.scene.display().to_string(),
                "width": cells.width(), "height": cells.height(),
                "bounces": settings.bounces, "backend": device.backend(), "threads": threads,
                "reference": { "samples": reference.samples, "cells": args.cells,
                               "ms": ms(reference.time),
                               "relative_standard_error": reference.standard_error },
                "rows": rows.iter().map(row_json).collect::<Vec<_>>(),
                "refused": refusals.iter().map(|refusal| json!({
                    "method": refusal.method.name(), "reason": refusal.reason,
                })).collect::<Vec<_>>(),
            });
            if let DeviceInfo::Gpu { adapter, .. } = device {
                answer["adapter"] = adapter.into();
            }
            return output::print(answer);
        }
        output::print(format_args!(
            "{name}: {}×{} cells, bounces {bounces}, {device}\n",
            cells.width(),
            cells.height(),
        ))?;
        output::print(rows_table(&rows))?;
        for refusal in &refusals {
            output::print(format_args!("{}", refusal.sentence()))?;
        }
        output::print(format_args!("\n{}", reference.sentences(&rows)))?;
        if let Some(clock) = device.clock() {
            output::print(format_args!("times: per frame, {clock}."))?;
        }
        match &args.report {
            Some(folder) if !quiet => {
                output::print(format_args!("wrote {}", folder.join(report::PAGE).display()))
            }
            _ => Ok(()),
        }
    })
}

/// The number of bytes that the hungriest entry takes, or the reference.
fn needed(args: &CompareArgs, entries: &[Entry], settings: &Settings, size: SceneSize) -> u64 {
    let of_method = |entry: &Entry| {
        let renderer = Renderer::Method(entry.settings.method());
        memory::estimate(size, renderer, &entry.settings, args.machine.backend)
    };
    let of_reference = memory::estimate(size, Renderer::Reference, settings, Backend::Cpu);
    let rows = entries.iter().map(Entry::rows).sum();
    entries.iter().map(of_method).fold(of_reference, u64::max)
        + memory::estimate_rows(size.cells, rows)
        + memory::estimate_picture(size.cells, args.display.scale)
}

fn warn_of_what_is_ignored(
    args: &CompareArgs,
    methods: &[Method],
    cells: &Cells,
    settings: &Settings,
    bounces: Option<Bounces>,
) {
    for &method in methods.iter().filter(|method| method.suits(cells).is_ok()) {
        let renderer = Renderer::Method(method);
        if let Some(text) = warnings::left_out(renderer, cells, settings, bounces) {
            warn(&text);
        }
    }
    let renderers: Vec<_> = methods.iter().copied().map(Renderer::Method).collect();
    warnings::idle_settings(&args.settings.set, &renderers).iter().for_each(|text| warn(text));
    warnings::preset_rows(&args.settings.set).iter().for_each(|text| warn(text));
    if args.report.is_none() && args.display.scale > 1 {
        warn("`--scale` changes nothing without `--report`: no picture is written");
    }
    if args.cells.is_some() && args.display.tonemap.is_some() {
        warn("`--tonemap` changes nothing with `--cells`: no picture is made");
    }
    if args.cells.is_some() && args.display.exposure.is_some() {
        warn("`--exposure` changes nothing with `--cells`: no picture is made");
    }
}

/// Traces the whole picture, or some cells of it.
fn trace_reference(
    args: &CompareArgs,
    cells: &Cells,
    settings: &Settings,
) -> Result<(ReferenceLight, ReferenceStats)> {
    let samples = args.samples;
    let Some(count) = args.cells else {
        let (estimate, time) = solve::trace(cells, settings, samples, args.machine.quiet)?;
        let standard_error = solve::relative_standard_error(&estimate);
        return Ok((
            ReferenceLight::Everywhere(estimate),
            ReferenceStats { samples, cells: None, standard_error, time },
        ));
    };
    let at = open_cells(cells, count as usize, settings.seed);
    if at.is_empty() {
        return Err(CliError::bad_input("the scene has no open cell to compare at"));
    }
    let (seen, time) = solve::trace_at(cells, settings, samples, &at)?;
    let standard_error = solve::relative_error_of(seen.iter().copied());
    let light: Vec<Rgb> = seen.into_iter().map(|(light, _)| light).collect();
    Ok((
        ReferenceLight::At(at, light),
        ReferenceStats { samples, cells: Some(count), standard_error, time },
    ))
}

fn rows_table(rows: &[Row]) -> String {
    let grain = rows.iter().any(|row| row.grain.is_some());
    let flip = rows.iter().any(|row| row.flip.is_some());
    let mut header = vec!["", "rel. RMSE %", "bias %", "p99 %"];
    if grain {
        header.push("grain %");
    }
    if flip {
        header.push("FLIP");
    }
    header.push("ms per frame");
    let percent = |v: f64| format!("{:.2}", v * 100.0);
    let cells = rows.iter().map(|row| {
        let m = &row.measures;
        let bias = format!("{:+.2}", m.bias * 100.0);
        let mut cells = vec![row.name(), percent(m.relative_rmse), bias, percent(m.p99)];
        if grain {
            cells.push(row.grain.map_or_else(String::new, percent));
        }
        if flip {
            cells.push(row.flip.map_or_else(String::new, |flip| format!("{flip:.4}")));
        }
        cells.push(format!("{:.1}", ms(row.time)));
        cells
    });
    table::table(&header, &[0], cells)
}

fn row_json(row: &Row) -> Value {
    let m = &row.measures;
    json!({
        "name": row.name(), "method": row.method.name(), "preset": row.preset, "frames": row.frames,
        "relative_rmse": m.relative_rmse, "bias": m.bias, "median": m.median, "p99": m.p99,
        "grain": row.grain, "flip": row.flip, "ms": ms(row.time),
    })
}
