//! Methods against the path tracer: what runs, and what is measured of it.

use crate::failure::{Failure, Outcome};
use crate::progress::Progress;
use lamplight::settings::{BounceBy, Flood, Polar, Raymarch};
use lamplight::{Bounces, Cells, Display, Light, Method, Rgb, Settings, Solver};
use lamplight_truth::Measures;
use lamplight_truth::flip::{PIXELS_PER_DEGREE, flip};
use std::time::{Duration, Instant};

/// A frame is timed for about this long,
const TIME: Duration = Duration::from_millis(600);
/// and at most so often.
const MOST_RUNS: usize = 15;
/// Rays a pixel of the plain entries.
const RAYS: [u32; 4] = [8, 32, 128, 512];
/// Rays a pixel where something else is looked at.
const FEW_RAYS: u32 = 32;
/// Denoise passes where the scene names none.
const DENOISE_PASSES: u32 = 4;
/// Frames after which accumulation is looked at.
const FRAMES: [u32; 3] = [1, 8, 64];
/// Frames after which `flood`, which keeps energy from frame to frame, is looked at.
const FLOOD_FRAMES: [u32; 2] = [1, 32];

/// Entries that belong together: a line in the plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Series {
    /// The settings of scene and flags, as they are.
    AsSet,
    /// More and more rays.
    Rays,
    /// Rays, then the edge-aware blur.
    Denoise,
    /// The presets of the seeds.
    Preset,
    /// Accumulation over more and more frames.
    Temporal,
}

/// Something that takes part.
struct Entry {
    name: String,
    series: Series,
    settings: Settings,
    /// After which frames to measure.
    after: Vec<u32>,
}

/// How an entry did.
pub struct Row {
    /// What it is.
    pub name: String,
    /// The method it runs.
    pub method: Method,
    /// What it belongs to.
    pub series: Series,
    /// Frames solved before it was looked at.
    pub frames: u32,
    /// Median time of a frame.
    pub time: Duration,
    /// Its errors.
    pub measures: Measures,
    /// Mean FLIP error of the final picture.
    pub flip: f64,
    /// Its light.
    pub light: Light,
}

/// What the entries are judged by.
pub struct Judge<'a> {
    pub cells: &'a Cells,
    pub truth: &'a Light,
    pub display: Display,
}

/// Runs every entry of the methods.
pub fn run(
    judge: &Judge,
    methods: &[Method],
    settings: &Settings,
    quiet: bool,
) -> Outcome<Vec<Row>> {
    let entries: Vec<Entry> = methods.iter().flat_map(|&m| entries(m, settings)).collect();
    let progress = Progress::new("solving", entries.len() as u64, quiet);
    let picture = srgb_pixels(judge.truth, judge)?;
    let mut rows = Vec::new();
    for entry in entries {
        progress.say(&format!("solving: {}", entry.name));
        rows.extend(measure(entry, judge, &picture)?);
        progress.step();
    }
    Ok(rows)
}

/// What a method is looked at with.
fn entries(method: Method, settings: &Settings) -> Vec<Entry> {
    match method {
        Method::Raymarch => raymarch_entries(&Settings { method, ..settings.clone() }),
        Method::Flood => {
            preset_entries(&Settings { method, ..settings.clone() }, &FLOOD_FRAMES, |s, name| {
                Some(Settings { flood: Flood::preset(name)?, ..s })
            })
        }
        Method::Polar => {
            preset_entries(&Settings { method, ..settings.clone() }, &[1], |s, name| {
                Some(Settings { polar: Polar::preset(name)?, ..s })
            })
        }
    }
}

/// The settings as they are, and every preset.
fn preset_entries(
    settings: &Settings,
    after: &[u32],
    with: impl Fn(Settings, &str) -> Option<Settings>,
) -> Vec<Entry> {
    let method = settings.method;
    let entry =
        |name: String, series, settings| Entry { name, series, settings, after: after.into() };
    let preset = |&name: &&str| {
        let settings = with(settings.clone(), name)?;
        Some(entry(format!("{}, preset {name}", method.name()), Series::Preset, settings))
    };
    let mut all: Vec<Entry> = method.presets().iter().filter_map(preset).collect();
    if all.iter().all(|entry| entry.settings != *settings) {
        let name = format!("{}, as set", method.name());
        all.insert(0, entry(name, Series::AsSet, settings.clone()));
    }
    all
}

fn raymarch_entries(settings: &Settings) -> Vec<Entry> {
    let entry = |name: String, series, settings: Settings| {
        // With feedback each frame adds a bounce: what was asked for is there after that many.
        let bounces = match settings.bounces {
            Bounces::Count(k) if settings.raymarch.bounce == BounceBy::Feedback => k,
            Bounces::Converged if settings.raymarch.bounce == BounceBy::Feedback => 16,
            _ => 0,
        };
        Entry { name, series, settings, after: vec![bounces + 1] }
    };
    let mut plain = settings.clone();
    plain.temporal.frames = 0;
    plain.denoise.passes = 0;
    let with_rays = |rays| {
        let mut settings = plain.clone();
        settings.raymarch.rays = rays;
        settings
    };

    let mut all = Vec::new();
    for rays in RAYS {
        all.push(entry(format!("raymarch, {rays} rays"), Series::Rays, with_rays(rays)));
    }
    let mut denoised = with_rays(FEW_RAYS);
    denoised.denoise = settings.denoise.clone();
    if denoised.denoise.passes == 0 {
        denoised.denoise.passes = DENOISE_PASSES;
    }
    all.push(entry(format!("raymarch, {FEW_RAYS} rays, denoised"), Series::Denoise, denoised));
    for name in Raymarch::PRESETS.iter().filter(|&&name| name != "default") {
        if let Some(raymarch) = Raymarch::preset(name) {
            let settings = Settings { raymarch, ..plain.clone() };
            all.push(entry(format!("raymarch, preset {name}"), Series::Preset, settings));
        }
    }
    let mut temporal = with_rays(FEW_RAYS);
    temporal.temporal.frames = FRAMES.into_iter().fold(settings.temporal.frames, u32::max);
    let name = format!("raymarch, {FEW_RAYS} rays, temporal");
    all.push(Entry { name, series: Series::Temporal, settings: temporal, after: FRAMES.into() });
    if all.iter().all(|entry| entry.settings != *settings) {
        all.insert(0, entry("raymarch, as set".into(), Series::AsSet, settings.clone()));
    }
    all
}

/// Solves frames, looks at the light after some of them, then times more of them.
fn measure(entry: Entry, judge: &Judge, truth_picture: &[Rgb]) -> Outcome<Vec<Row>> {
    let Entry { name, series, settings, after } = entry;
    let method = settings.method;
    let mut solver = Solver::new(settings)?;
    let mut times = Vec::new();
    let mut lights = Vec::new();
    for frame in 1..=after.iter().copied().max().unwrap_or(1) {
        let light = timed(&mut solver, judge.cells, &mut times)?;
        if after.contains(&frame) {
            lights.push((frame, light.clone()));
        }
    }
    // The first frame makes the buffers, and is no measure of the others.
    times.remove(0);
    let start = Instant::now();
    while times.is_empty() || (start.elapsed() < TIME && times.len() < MOST_RUNS) {
        timed(&mut solver, judge.cells, &mut times)?;
    }
    times.sort_unstable();
    let time = times[times.len() / 2];

    let several = lights.len() > 1;
    let row = |(frames, light): (u32, Light)| {
        let (w, h) = (light.width() as usize, light.height() as usize);
        let picture = srgb_pixels(&light, judge)?;
        let measures = Measures::of(light.pixels(), judge.truth.pixels(), judge.truth.solid());
        Ok(Row {
            name: match frames {
                _ if !several => name.clone(),
                1 => format!("{name}, 1 frame"),
                n => format!("{name}, {n} frames"),
            },
            method,
            series,
            frames,
            time,
            measures,
            flip: flip(w, h, truth_picture, &picture, PIXELS_PER_DEGREE).mean,
            light,
        })
    };
    lights.into_iter().map(row).collect()
}

fn timed<'s>(
    solver: &'s mut Solver,
    cells: &Cells,
    times: &mut Vec<Duration>,
) -> Result<&'s Light, Failure> {
    let start = Instant::now();
    let light = solver.solve(cells)?;
    times.push(start.elapsed());
    Ok(light)
}

/// The final picture as FLIP takes it: sRGB, 0 to 1.
fn srgb_pixels(light: &Light, judge: &Judge) -> Outcome<Vec<Rgb>> {
    let picture = light.compose(judge.cells, &judge.display)?;
    Ok(picture.pixels().map(|pixel| pixel.0.map(|v| f32::from(v) / 255.0)).collect())
}
