//! From a scene file to light, for every command that needs it.

use crate::args::{Answer, Backend, Lighting};
use crate::failure::Failure;
use crate::failure::{Outcome, warn};
use crate::gpu::Gpu;
use crate::place::Place;
use crate::progress::Progress;
use crate::stage::Fields;
use lamplight::settings::BounceBy;
use lamplight::{Bounces, Cells, Light, Rgb, Scene, Settings, Solver};
use lamplight_truth::{Estimate, PathTracer};
use serde_json::{Map, Value, json};
use std::path::Path;
use std::time::{Duration, Instant};

/// Paths a pixel of the reference where nothing is said.
const SAMPLES: u32 = 256;

/// Reads a scene; says on stderr what may not be as its author meant it, unless quiet.
pub fn open(path: &Path, quiet: bool) -> Outcome<(Scene, Cells)> {
    let scene = Scene::load(path)?;
    let cells = scene.cells().map_err(|e| e.in_file(path))?;
    if !quiet {
        scene.warnings(&cells).iter().for_each(|text| warn(text));
    }
    Ok((scene, cells))
}

/// Light, and how it came about.
pub struct Lit {
    /// The light.
    pub light: Light,
    /// Who answered.
    pub answer: Answer,
    /// Where.
    pub place: Place,
    /// Time of each stage, summed over the frames.
    pub stages: Vec<(&'static str, Duration)>,
    /// Time of all.
    pub total: Duration,
    /// Frames solved.
    pub frames: u32,
    /// What it was told, for `--json`.
    pub settings: Value,
}

impl Lit {
    /// Milliseconds by stage, for `--json`.
    pub fn stages_json(&self) -> Map<String, Value> {
        self.stages.iter().map(|&(name, time)| (name.to_owned(), ms(time).into())).collect()
    }
}

/// A time in milliseconds, to the microsecond.
pub fn ms(time: Duration) -> f64 {
    time.as_micros() as f64 / 1000.0
}

/// The GPU that the flags put these settings on; none: the CPU is to do it.
pub fn gpu(flags: &Lighting, settings: &Settings) -> Outcome<Option<Gpu>> {
    match (flags.answer(settings), flags.machine.backend) {
        (Answer::By(_), backend) => Gpu::choose(backend),
        (Answer::Reference, Backend::Gpu) => {
            Err(Failure::bad_input("the reference has no GPU backend so far")
                .hint("leave --backend out, or say --backend cpu"))
        }
        (Answer::Reference, _) => Ok(None),
    }
}

/// Lights cells as the flags say, on that GPU or the CPU.
pub fn light(
    cells: &Cells,
    flags: &Lighting,
    gpu: Option<&Gpu>,
    settings: Settings,
) -> Outcome<Lit> {
    let answer = flags.answer(&settings);
    let cones = cells.lamps().iter().any(|lamp| lamp.cone.is_some());
    if cones && !answer.lights_lamps() && !flags.machine.quiet {
        warn(&format!(
            "{} draws lamps as discs that glow all round: cones are not seen",
            answer.name()
        ));
    }
    if !flags.machine.quiet {
        flags.idle(answer).iter().for_each(|text| warn(text));
    }
    match answer {
        Answer::By(_) => {
            let settings = averaged(settings, flags.frames);
            match gpu {
                Some(gpu) => gpu.solve(cells, settings, flags.frames),
                None => solve(cells, settings, flags.frames, flags.machine.quiet),
            }
        }
        Answer::Reference => {
            reference(cells, &settings, flags.samples.unwrap_or(SAMPLES), flags.machine.quiet)
        }
    }
}

/// Settings whose last frame is the mean of so many, where these show the same light with other noise.
fn averaged(mut settings: Settings, frames: u32) -> Settings {
    // Frames that each add a bounce are not to be averaged: the first ones are darker.
    let growing =
        settings.raymarch.bounce == BounceBy::Feedback && settings.bounces != Bounces::Count(0);
    if frames > 1 && settings.temporal.frames <= 1 && !growing {
        settings.temporal.frames = frames;
    }
    settings
}

/// Solves some frames on the CPU, for the light of the last.
fn solve(cells: &Cells, settings: Settings, frames: u32, quiet: bool) -> Outcome<Lit> {
    let answer = Answer::By(settings.method);
    let told = to_json(&settings)?;
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
    let place = Place::cpu();
    Ok(Lit { light, answer, place, stages, total, frames, settings: told })
}

/// Finds the nearest occupied cell of each cell, and how far it is, on that GPU or the CPU.
pub fn fields(cells: &Cells, gpu: Option<&Gpu>, settings: &Settings) -> Outcome<Fields> {
    let settings = settings.fields_only();
    if let Some(gpu) = gpu {
        return gpu.fields(cells, settings);
    }
    let mut solver = Solver::new(settings)?;
    solver.solve(cells)?;
    let stages = solver.stages();
    let (nearest, distance) = (stages.nearest.to_vec(), stages.distance.to_vec());
    Ok(Fields { nearest, distance, place: Place::cpu() })
}

/// Runs the path tracer.
pub fn reference(cells: &Cells, settings: &Settings, samples: u32, quiet: bool) -> Outcome<Lit> {
    let (estimate, total) = trace(cells, settings, samples, quiet)?;
    let error = relative_standard_error(&estimate);
    let told = json!({
        "bounces": settings.bounces, "wall_depth": settings.wall_depth,
        "seed": settings.seed, "samples": samples, "relative_standard_error": error,
    });
    Ok(Lit {
        light: estimate.light,
        answer: Answer::Reference,
        place: Place::cpu(),
        stages: vec![("reference", total)],
        total,
        frames: 1,
        settings: told,
    })
}

/// The path tracer's estimate of every cell, and the time it took.
pub fn trace(
    cells: &Cells,
    settings: &Settings,
    samples: u32,
    quiet: bool,
) -> Outcome<(Estimate, Duration)> {
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
) -> Outcome<(Vec<(Rgb, Rgb)>, Duration)> {
    let start = Instant::now();
    Ok((tracer(settings, samples).at(cells, at)?, start.elapsed()))
}

fn tracer(settings: &Settings, samples: u32) -> PathTracer {
    PathTracer {
        samples,
        bounces: settings.bounces,
        wall_depth: settings.wall_depth,
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

/// The same over any means and their standard errors.
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

/// A value as JSON.
pub fn to_json(value: &impl serde::Serialize) -> Outcome<Value> {
    serde_json::to_value(value).map_err(Failure::failed)
}
