//! `lamplight compare`: the methods against the path tracer.

use crate::args::{Machine, SettingFlags, Show, by_name, threads_in_words};
use crate::contest::{self, Judge, Row};
use crate::failure::Outcome;
use crate::lighting::{self, ms};
use crate::output;
use crate::report::{self, Reference};
use crate::table::table;
use lamplight::Method;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Judge methods by the path tracer: errors, and the time they take
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The scene file (TOML or JSON)
    scene: PathBuf,
    /// Methods to judge, with commas between them [default: all that can light the scene]
    #[arg(long, value_name = "METHOD", value_delimiter = ',',
          value_parser = by_name(Method::ALL, Method::name))]
    methods: Vec<Method>,
    /// Paths a pixel of the reference
    #[arg(long, value_name = "N", default_value_t = 4096,
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    samples: u32,
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
    let backend = args.machine.backend.choose()?;
    args.machine.run(|threads| {
        let quiet = args.machine.quiet;
        let (scene, cells) = lighting::open(&args.scene, quiet)?;
        let methods = if args.methods.is_empty() {
            Method::ALL.iter().copied().filter(|method| method.suits(&cells).is_ok()).collect()
        } else {
            args.methods.clone()
        };
        methods.iter().try_for_each(|method| method.suits(&cells))?;
        let settings = args.settings.over(&scene.light)?.resolve()?;
        let display = args.show.display(scene.display)?;
        if let Some(folder) = &args.report {
            output::make_directory(folder)?;
        }
        let (estimate, time) = lighting::trace(&cells, &settings, args.samples, quiet)?;
        let judge = Judge { cells: &cells, truth: &estimate.light, display };
        let rows = contest::run(&judge, &methods, &settings, quiet)?;
        let reference = Reference {
            samples: args.samples,
            standard_error: lighting::relative_standard_error(&estimate),
            time,
        };

        let name = args.scene.file_name().unwrap_or_default().to_string_lossy();
        let bounces = lighting::to_json(&settings.bounces)?;
        let bounces = bounces.as_str().map_or_else(|| bounces.to_string(), str::to_owned);
        if let Some(folder) = &args.report {
            report::write(
                folder,
                &report::Subject {
                    name: &name,
                    bounces: &bounces,
                    threads,
                    judge: &judge,
                    reference: &reference,
                    rows: &rows,
                    scale: args.show.scale,
                },
            )?;
        }
        if args.json {
            return output::print(json!({
                "scene": args.scene, "width": cells.width(), "height": cells.height(),
                "bounces": settings.bounces, "backend": backend, "threads": threads,
                "reference": { "samples": reference.samples, "ms": ms(reference.time),
                               "relative_standard_error": reference.standard_error },
                "rows": rows.iter().map(row_json).collect::<Vec<_>>(),
            }));
        }
        output::print(format_args!(
            "{name}: {}×{} cells, bounces {bounces}, on the CPU with {}\n",
            cells.width(),
            cells.height(),
            threads_in_words(threads),
        ))?;
        let header = ["", "rel. RMSE %", "bias %", "p99 %", "FLIP", "ms a frame"];
        output::print(table(&header, &[0], rows.iter().map(row_cells)))?;
        output::print(format_args!("\n{}", reference.words(&rows)))?;
        match &args.report {
            Some(folder) if !quiet => {
                output::print(format_args!("wrote {}", folder.join(report::PAGE).display()))
            }
            _ => Ok(()),
        }
    })
}

fn row_cells(row: &Row) -> Vec<String> {
    let percent = |v: f64| format!("{:.2}", v * 100.0);
    let m = &row.measures;
    vec![
        row.name.clone(),
        percent(m.relative_rmse),
        format!("{:+.2}", m.bias * 100.0),
        percent(m.p99),
        format!("{:.4}", row.flip),
        format!("{:.1}", ms(row.time)),
    ]
}

fn row_json(row: &Row) -> Value {
    let m = &row.measures;
    json!({
        "name": row.name, "method": row.method.name(), "frames": row.frames,
        "relative_rmse": m.relative_rmse, "bias": m.bias, "median": m.median, "p99": m.p99,
        "flip": row.flip, "ms": ms(row.time),
    })
}
