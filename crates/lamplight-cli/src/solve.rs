//! Light found on the CPU: by a method of the engine, or by the path tracer.

use crate::args::Renderer;
use crate::device_info::DeviceInfo;
use crate::error::Result;
use crate::json::to_json;
use crate::lit::Lit;
use crate::progress::Progress;
use crate::stage::Fields;
use lamplight::{Cells, Rgb, Settings, Solver};
use lamplight_truth::{Estimate, PathTracer};
use serde_json::json;
use std::time::{Duration, Instant};

/// Solves some frames on the CPU and returns the light of the last.
pub fn solve(cells: &Cells, settings: Settings, frames: u32, quiet: bool) -> Result<Lit> {
    let renderer = Renderer::Method(settings.method());
    let settings_json = to_json(&settings)?;
    let mut solver = Solver::new(settings)?;
    let mut stages: Vec<(&'static str, Duration)> = Vec::new();
    let start = Instant::now();
    let progress = Progress::new("lighting", frames.into(), quiet || frames == 1);
    for _ in 0..frames {
        solver.solve(cells)?;
        for &(name, time) in solver.timings() {
            match stages.iter_mut().find(|(known, _)| *known == name) {
                Some((_, sum)) => *sum += time,
                None => stages.push((name, time)),
            }
        }
        progress.step();
    }
    let light = solver.light().clone();
    let total = start.elapsed();
    let device = DeviceInfo::cpu();
    Ok(Lit { light, renderer, device, stages, total, frames, settings: settings_json })
}

/// Finds the nearest occupied cell of each cell, and the distance to it, on the CPU.
pub fn fields(cells: &Cells, settings: &Settings) -> Result<Fields> {
    let mut solver = Solver::new(settings.fields_only())?;
    solver.solve(cells)?;
    let stages = solver.stages();
    let (nearest, distance) = (stages.nearest.to_vec(), stages.distance.to_vec());
    Ok(Fields { nearest, distance, device: DeviceInfo::cpu() })
}

/// Runs the path tracer.
pub fn reference(cells: &Cells, settings: &Settings, samples: u32, quiet: bool) -> Result<Lit> {
    let (estimate, total) = trace(cells, settings, samples, quiet)?;
    let error = relative_standard_error(&estimate);
    let settings_json = json!({
        "bounces": settings.bounces, "wall_depth": settings.wall_depth,
        "seed": settings.seed, "samples": samples, "relative_standard_error": error,
    });
    Ok(Lit {
        light: estimate.light,
        renderer: Renderer::Reference,
        device: DeviceInfo::cpu(),
        stages: vec![("reference", total)],
        total,
        frames: 1,
        settings: settings_json,
    })
}

/// The path tracer's estimate of every cell, and the time it took.
pub fn trace(
    cells: &Cells,
    settings: &Settings,
    samples: u32,
    quiet: bool,
) -> Result<(Estimate, Duration)> {
    let tracer = tracer(settings, samples);
    let progress = Progress::new("tracing the reference", 1000, quiet);
    let start = Instant::now();
    let estimate = tracer.render(cells, &|share| progress.at((share * 1000.0) as u64))?;
    Ok((estimate, start.elapsed()))
}

/// Means and standard errors of a few cells, and the time they took.
pub fn trace_at(
    cells: &Cells,
    settings: &Settings,
    samples: u32,
    at: &[[u32; 2]],
) -> Result<(Vec<(Rgb, Rgb)>, Duration)> {
    let start = Instant::now();
    Ok((tracer(settings, samples).at(cells, at)?, start.elapsed()))
}

fn tracer(settings: &Settings, samples: u32) -> PathTracer {
    PathTracer {
        samples,
        bounces: settings.bounces,
        wall_depth: settings.wall_depth,
        elevation: settings.elevation,
        seed: settings.seed,
    }
}

/// The reference's own error: the root mean square of its standard error over the open cells,
/// relative to their mean light, as the relative RMSE of a method is.
pub fn relative_standard_error(estimate: &Estimate) -> f64 {
    let cells = estimate.standard_error.iter().zip(estimate.light.pixels());
    let open = cells.zip(estimate.light.solid()).filter(|&(_, solid)| !solid);
    relative_error_of(open.map(|((error, light), _)| (*light, *error)))
}

/// Returns the relative standard error over pairs of mean and standard error.
pub fn relative_error_of(cells: impl Iterator<Item = (Rgb, Rgb)>) -> f64 {
    let (mut squares, mut sum, mut count) = (0.0, 0.0, 0.0);
    for (light, error) in cells {
        for c in 0..3 {
            squares += f64::from(error[c]).powi(2);
            sum += f64::from(light[c]);
            count += 1.0;
        }
    }
    if sum > 0.0 { (squares / count).sqrt() / (sum / count) } else { 0.0 }
}
