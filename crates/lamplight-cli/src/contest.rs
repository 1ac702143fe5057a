//! Methods against the path tracer: what runs, and what is measured of it.
//!
//! A method joins by its name and its presets ([`Method::presets`]): each preset is a row. One that
//! cannot light the scene is named with its reason, and the others go on.

use crate::failure::{Failure, Outcome};
use crate::frames::Frames;
use crate::gpu::Gpu;
use crate::progress::Progress;
use lamplight::settings::BounceBy;
use lamplight::{Bounces, Cells, Display, Light, Method, Rgb, Settings, SettingsTable};
use lamplight_truth::Measures;
use lamplight_truth::flip::{PIXELS_PER_DEGREE, flip};
use std::time::{Duration, Instant};

/// A frame is timed for about this long,
const TIME: Duration = Duration::from_millis(600);
/// and at most so often.
const MOST_RUNS: usize = 15;
/// Rays a pixel of the sweep.
const RAYS: [u32; 4] = [8, 32, 128, 512];
/// Rays a pixel where something else is looked at.
const FEW_RAYS: u32 = 32;
/// Denoise passes where the scene names none.
const DENOISE_PASSES: u32 = 4;
/// Frames after which accumulation is looked at.
const FRAMES: [u32; 3] = [1, 8, 64];
/// Frames after which `flood`, which comes to rest over some, is looked at.
const FLOOD_FRAMES: u32 = 32;

/// Settings that take part.
pub struct Entry {
    label: String,
    preset: Option<&'static str>,
    /// The settings.
    pub settings: Settings,
    /// After which frames to measure.
    after: Vec<u32>,
}

/// How some settings did.
pub struct Row {
    /// The method.
    pub method: Method,
    /// What tells it from other rows of the method.
    pub label: String,
    /// The preset, where it is one.
    pub preset: Option<&'static str>,
    /// Frames solved before it was looked at.
    pub frames: u32,
    /// Median time of a frame.
    pub time: Duration,
    /// Its errors.
    pub measures: Measures,
    /// Mean FLIP error of the final picture, where all of the picture is judged.
    pub flip: Option<f64>,
    /// Its light.
    pub light: Light,
}

impl Row {
    /// Method and label.
    pub fn name(&self) -> String {
        format!("{}, {}", self.method.name(), self.label)
    }
}

/// A method that cannot light the scene.
pub struct Refusal {
    /// The method.
    pub method: Method,
    /// Why not.
    pub reason: String,
}

impl Refusal {
    /// A line that says so.
    pub fn words(&self) -> String {
        format!("{} cannot light this scene: {}", self.method.name(), self.reason)
    }
}

/// What came of it all; rows of a method stand together.
pub struct Contest {
    pub rows: Vec<Row>,
    pub refusals: Vec<Refusal>,
}

/// What is right, and where it is known.
pub enum Truth {
    /// All of the picture.
    Everywhere(Light),
    /// Some open cells, and their light.
    At(Vec<[u32; 2]>, Vec<Rgb>),
}

/// What the entries are judged by.
pub struct Judge<'a> {
    pub cells: &'a Cells,
    pub truth: &'a Truth,
    pub display: Display,
}

impl Judge<'_> {
    fn measures(&self, light: &Light) -> Measures {
        match self.truth {
            Truth::Everywhere(truth) => Measures::of(light.pixels(), truth.pixels(), truth.solid()),
            Truth::At(cells, truth) => {
                let seen: Vec<Rgb> = cells.iter().map(|&[x, y]| light.at(x, y)).collect();
                Measures::of(&seen, truth, &vec![false; truth.len()])
            }
        }
    }

    /// The final picture as FLIP takes it: sRGB, 0 to 1.
    fn picture(&self, light: &Light) -> Outcome<Vec<Rgb>> {
        let picture = light.compose(self.cells, &self.display)?;
        Ok(picture.pixels().map(|pixel| pixel.0.map(|v| f32::from(v) / 255.0)).collect())
    }
}

/// Runs the entries, on that GPU or the CPU.
pub fn run(judge: &Judge, entries: Vec<Entry>, gpu: Option<&Gpu>, quiet: bool) -> Outcome<Contest> {
    let progress = Progress::new("solving", entries.len() as u64, quiet);
    let picture = match judge.truth {
        Truth::Everywhere(light) => Some(judge.picture(light)?),
        Truth::At(..) => None,
    };
    let mut contest = Contest { rows: Vec::new(), refusals: Vec::new() };
    for entry in entries {
        let method = entry.settings.method;
        if !contest.refusals.iter().any(|refusal| refusal.method == method) {
            progress.say(&format!("solving: {}, {}", method.name(), entry.label));
            match lights(&entry, judge.cells, gpu) {
                Ok(solved) => contest.rows.extend(rows(entry, solved, judge, picture.as_deref())?),
                // The reference has been made from the same cells, so it is the method that cannot.
                Err(failure) => {
                    contest.refusals.push(Refusal { method, reason: failure.refusal()? });
                }
            }
        }
        progress.step();
    }
    match contest.refusals.first() {
        Some(refusal) if contest.rows.is_empty() => Err(Failure::bad_input(refusal.words())),
        _ => Ok(contest),
    }
}

/// The presets of the methods, what the scene and the flags set where that is none of them, and with
/// `sweep` more settings of each method.
pub fn entries(methods: &[Method], table: &SettingsTable, sweep: bool) -> Outcome<Vec<Entry>> {
    let mut all = Vec::new();
    for &method in methods {
        all.extend(entries_of(method, table, sweep)?);
    }
    Ok(all)
}

/// What a method is looked at with.
fn entries_of(method: Method, table: &SettingsTable, sweep: bool) -> Outcome<Vec<Entry>> {
    let mut table = table.clone();
    table.set("method", method.name());
    let as_set = table.resolve()?;
    let mut all = Vec::new();
    for &preset in method.presets() {
        let (mut table, mut whole) = (table.clone(), SettingsTable::default());
        whole.set(&format!("{}.preset", method.name()), preset);
        table.merge(whole);
        let settings = without_filters(table.resolve()?);
        all.push(Entry { preset: Some(preset), ..Entry::of(preset.to_owned(), settings) });
    }
    if sweep && method == Method::Raymarch {
        all.extend(raymarch_sweep(&as_set));
    }
    if all.iter().all(|entry| entry.settings != as_set) {
        all.insert(0, Entry::of("as set".into(), as_set));
    }
    Ok(all)
}

impl Entry {
    fn of(label: String, settings: Settings) -> Self {
        // With feedback each frame adds a bounce: what was asked for is there after that many.
        let feedback =
            settings.method == Method::Raymarch && settings.raymarch.bounce == BounceBy::Feedback;
        let bounces = match settings.bounces {
            Bounces::Count(k) if feedback => k,
            Bounces::Converged if feedback => 16,
            _ => 0,
        };
        let frames = if settings.method == Method::Flood { FLOOD_FRAMES } else { bounces + 1 };
        Self { label, preset: None, settings, after: vec![frames] }
    }
}

/// A method by itself: what makes up for noise is another row's business.
fn without_filters(mut settings: Settings) -> Settings {
    if settings.method == Method::Raymarch {
        settings.temporal.frames = 0;
        settings.denoise.passes = 0;
    }
    settings
}

/// More and more rays; the edge-aware blur; the mean over more and more frames.
fn raymarch_sweep(settings: &Settings) -> Vec<Entry> {
    let plain = without_filters(settings.clone());
    let with_rays = |rays| {
        let mut settings = plain.clone();
        settings.raymarch.rays = rays;
        settings
    };
    let mut all: Vec<Entry> =
        RAYS.iter().map(|&rays| Entry::of(format!("{rays} rays"), with_rays(rays))).collect();
    let mut denoised = with_rays(FEW_RAYS);
    denoised.denoise = settings.denoise.clone();
    if denoised.denoise.passes == 0 {
        denoised.denoise.passes = DENOISE_PASSES;
    }
    all.push(Entry::of(format!("{FEW_RAYS} rays, denoised"), denoised));
    let mut temporal = with_rays(FEW_RAYS);
    temporal.temporal.frames = FRAMES.into_iter().fold(settings.temporal.frames, u32::max);
    let label = format!("{FEW_RAYS} rays, temporal");
    all.push(Entry { after: FRAMES.into(), ..Entry::of(label, temporal) });
    all
}

/// The light after some frames, and the median time of one.
struct Solved {
    lights: Vec<(u32, Light)>,
    time: Duration,
}

/// Solves frames, keeps the light after some of them, then times more of them.
fn lights(entry: &Entry, cells: &Cells, gpu: Option<&Gpu>) -> Outcome<Solved> {
    let mut frames = Frames::new(gpu, cells, entry.settings.clone())?;
    let mut times = Vec::new();
    let mut lights = Vec::new();
    for frame in 1..=entry.after.iter().copied().max().unwrap_or(1) {
        times.push(frames.next()?);
        if entry.after.contains(&frame) {
            lights.push((frame, frames.light()?));
        }
    }
    // The first frame makes the buffers, and is no measure of the others.
    times.remove(0);
    let start = Instant::now();
    while times.is_empty() || (start.elapsed() < TIME && times.len() < MOST_RUNS) {
        times.push(frames.next()?);
    }
    times.sort_unstable();
    Ok(Solved { lights, time: times[times.len() / 2] })
}

/// Judges what was solved; FLIP where there is a picture to compare with.
fn rows(entry: Entry, solved: Solved, judge: &Judge, truth: Option<&[Rgb]>) -> Outcome<Vec<Row>> {
    let Entry { label, preset, settings, .. } = entry;
    let several = solved.lights.len() > 1;
    let row = |(frames, light): (u32, Light)| {
        let (w, h) = (light.width() as usize, light.height() as usize);
        let flip = match truth {
            Some(truth) => Some(flip(w, h, truth, &judge.picture(&light)?, PIXELS_PER_DEGREE).mean),
            None => None,
        };
        Ok(Row {
            method: settings.method,
            label: match frames {
                _ if !several => label.clone(),
                1 => format!("{label}, 1 frame"),
                n => format!("{label}, {n} frames"),
            },
            preset,
            frames,
            time: solved.time,
            measures: judge.measures(&light),
            flip,
            light,
        })
    };
    solved.lights.into_iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(changes: &[&str]) -> SettingsTable {
        let mut table = SettingsTable::default();
        changes.iter().for_each(|text| table.set_from_text(text).unwrap());
        table
    }

    fn labels(changes: &[&str], sweep: bool) -> Vec<String> {
        let entries = entries(&[Method::Raymarch], &table(changes), sweep).unwrap();
        entries.into_iter().map(|entry| entry.label).collect()
    }

    #[test]
    fn presets_take_part_and_what_is_set_where_it_is_none() {
        assert_eq!(labels(&[], false), ["default", "godot", "unity"]);
        assert_eq!(labels(&["raymarch.rays=7"], false), ["as set", "default", "godot", "unity"]);
        assert_eq!(labels(&["raymarch.preset=unity"], false), ["default", "godot", "unity"]);
        assert_eq!(labels(&["denoise.passes=2"], false), ["as set", "default", "godot", "unity"]);
        assert!(labels(&[], true).contains(&"512 rays".to_owned()));
    }

    #[test]
    fn a_preset_is_itself_whatever_is_set_beside_it() {
        let changes = ["raymarch.rays=7", "bounces=2"];
        for entry in entries(&[Method::Raymarch], &table(&changes), false).unwrap() {
            let rays = match &*entry.label {
                "as set" => 7,
                "unity" => 16,
                _ => 32,
            };
            assert_eq!(entry.settings.raymarch.rays, rays, "{}", entry.label);
            assert_eq!(entry.settings.bounces, Bounces::Count(2));
        }
    }

    #[test]
    fn a_method_that_cannot_is_named_with_its_reason() {
        let mut cells = Cells::new(4, 3).unwrap();
        let truth = Truth::Everywhere(Light::from_pixels(&cells, vec![[1.0; 3]; 12]).unwrap());
        cells.emission_mut()[7] = [-1.0; 3];
        let judge = Judge { cells: &cells, truth: &truth, display: Display::default() };
        let entries = entries(&[Method::Raymarch], &table(&[]), false).unwrap();
        let told = run(&judge, entries, None, true);
        let failure = format!("{:?}", told.map(|_| "a light").unwrap_err());
        assert!(failure.contains("raymarch cannot light this scene: cell (3, 1)"), "{failure}");
    }

    #[test]
    fn a_judge_of_some_cells_sees_no_others() {
        let cells = Cells::new(3, 1).unwrap();
        let light = |rgb| Light::from_pixels(&cells, rgb).unwrap();
        let truth = Truth::At(vec![[2, 0], [0, 0]], vec![[4.0; 3], [2.0; 3]]);
        let judge = Judge { cells: &cells, truth: &truth, display: Display::default() };
        let right = light(vec![[2.0; 3], [9.0; 3], [4.0; 3]]);
        assert_eq!(judge.measures(&right).relative_rmse, 0.0);
        let wrong = light(vec![[4.0; 3], [9.0; 3], [2.0; 3]]);
        assert!(judge.measures(&wrong).relative_rmse > 0.5);
    }
}
