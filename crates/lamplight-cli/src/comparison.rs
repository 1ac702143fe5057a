//! Methods compared with the path tracer: which settings run, and what is measured.
//!
//! A method joins by its name and its presets ([`Method::presets`]): each preset is a row. One that
//! cannot light the scene is named with its reason, and the others go on.

use crate::error::{CliError, Result};
use crate::frames::Frames;
use crate::gpu::Gpu;
use crate::progress::Progress;
use lamplight::settings::{Denoise, MethodSettings, Raymarch, Temporal};
use lamplight::{Bounces, Cells, Display, Light, Method, Quality, Rgb, Settings, SettingsTable};
use lamplight_truth::flip::{PIXELS_PER_DEGREE, flip};
use lamplight_truth::grain::grain;
use lamplight_truth::{Estimate, Measures};
use std::time::{Duration, Instant};

/// The time for which a frame is repeated,
const TIME: Duration = Duration::from_millis(600);
/// and its most runs.
const MOST_RUNS: usize = 15;
/// Rays per pixel in the sweep.
const RAYS: [u32; 4] = [8, 32, 128, 512];
/// Rays per pixel while other settings vary.
const FEW_RAYS: u32 = 32;
/// Denoise passes if the scene sets none.
const DENOISE_PASSES: u32 = 4;
/// Frames after which accumulation is measured.
const FRAMES: [u32; 3] = [1, 8, 64];
/// Frames after which `flood` is measured: it comes to rest over some.
const FLOOD_FRAMES: u32 = 32;
/// Frames after which bounces by feedback are measured: each frame adds one.
pub const FEEDBACK_FRAMES: u32 = 16;

/// Settings to compare.
pub struct Entry {
    label: String,
    preset: Option<&'static str>,
    pub settings: Settings,
    /// The frames after which to measure.
    after: Vec<u32>,
}

/// The errors and the time of some settings.
pub struct Row {
    pub method: Method,
    /// The name of the row among those of its method.
    pub label: String,
    /// The preset, if the settings are one.
    pub preset: Option<&'static str>,
    /// The number of frames solved before measuring.
    pub frames: u32,
    /// The median time of a frame.
    pub time: Duration,
    pub measures: Measures,
    /// The fine structure in even light, if all of it is compared and some is lit.
    pub grain: Option<f64>,
    /// The mean FLIP error of the final picture, if all of it is compared.
    pub flip: Option<f64>,
    pub light: Light,
}

impl Row {
    /// The method and the label.
    pub fn name(&self) -> String {
        format!("{}, {}", self.method.name(), self.label)
    }
}

/// A method that cannot light the scene.
pub struct Refusal {
    pub method: Method,
    pub reason: String,
}

impl Refusal {
    /// The refusal as a sentence.
    pub fn sentence(&self) -> String {
        format!("{} cannot light this scene: {}", self.method.name(), self.reason)
    }
}

/// The result of a comparison; rows of a method are adjacent.
pub struct Comparison {
    pub rows: Vec<Row>,
    pub refusals: Vec<Refusal>,
}

/// The light of the reference.
pub enum ReferenceLight {
    /// At every cell.
    Everywhere(Estimate),
    /// At some open cells.
    At(Vec<[u32; 2]>, Vec<Rgb>),
}

/// The measures of light against the reference.
pub struct Evaluator<'a> {
    pub cells: &'a Cells,
    pub truth: &'a ReferenceLight,
    pub display: Display,
}

impl Evaluator<'_> {
    fn measures(&self, light: &Light) -> Measures {
        match self.truth {
            ReferenceLight::Everywhere(Estimate { light: truth, .. }) => {
                Measures::of(light.pixels(), truth.pixels(), truth.solid())
            }
            ReferenceLight::At(cells, truth) => {
                let seen: Vec<Rgb> = cells.iter().map(|&[x, y]| light.at(x, y)).collect();
                Measures::of(&seen, truth, &vec![false; truth.len()])
            }
        }
    }

    fn grain(&self, light: &Light) -> Option<f64> {
        match self.truth {
            ReferenceLight::Everywhere(truth) => grain(light, &truth.light, &truth.standard_error),
            ReferenceLight::At(..) => None,
        }
    }

    /// The final picture in the form that FLIP takes: sRGB, 0 to 1.
    fn picture(&self, light: &Light) -> Result<Vec<Rgb>> {
        let picture = light.compose(self.cells, &self.display)?;
        Ok(picture.pixels().map(|pixel| pixel.0.map(|v| f32::from(v) / 255.0)).collect())
    }
}

/// Runs the entries on `gpu` or, without one, on the CPU.
pub fn run(
    evaluator: &Evaluator,
    entries: Vec<Entry>,
    gpu: Option<&Gpu>,
    quiet: bool,
) -> Result<Comparison> {
    let progress = Progress::new("solving", entries.len() as u64, quiet);
    let picture = match evaluator.truth {
        ReferenceLight::Everywhere(truth) => Some(evaluator.picture(&truth.light)?),
        ReferenceLight::At(..) => None,
    };
    let mut comparison = Comparison { rows: Vec::new(), refusals: Vec::new() };
    for entry in entries {
        let method = entry.settings.method();
        if !comparison.refusals.iter().any(|refusal| refusal.method == method) {
            progress.label(&format!("solving: {}, {}", method.name(), entry.label));
            match lights(&entry, evaluator.cells, gpu) {
                Ok(solved) => {
                    comparison.rows.extend(rows(entry, solved, evaluator, picture.as_deref())?);
                }
                // The reference was made from the same cells, so the method is at fault.
                Err(error) => {
                    comparison.refusals.push(Refusal { method, reason: error.refusal()? });
                }
            }
        }
        progress.step();
    }
    match comparison.refusals.first() {
        Some(refusal) if comparison.rows.is_empty() => Err(CliError::bad_input(refusal.sentence())),
        _ => Ok(comparison),
    }
}

/// The entries of some methods: all presets, or only those of `quality`; the settings of the scene and
/// the flags if they equal no preset; with `sweep` more settings of each method.
pub fn entries(
    methods: &[Method],
    table: &SettingsTable,
    quality: Option<Quality>,
    sweep: bool,
) -> Result<Vec<Entry>> {
    let mut all = Vec::new();
    for &method in methods {
        match quality {
            Some(quality) => all.push(preset_entry(method, quality.preset(method), table)?),
            None => all.extend(entries_of(method, table, sweep)?),
        }
    }
    Ok(all)
}

fn entries_of(method: Method, table: &SettingsTable, sweep: bool) -> Result<Vec<Entry>> {
    let mut all = Vec::new();
    for &preset in method.presets() {
        all.push(preset_entry(method, preset, table)?);
    }
    let mut table = table.clone();
    table.set("method", method.name());
    let as_set = table.resolve()?;
    if sweep && method == Method::Raymarch {
        all.extend(raymarch_sweep(&as_set));
    }
    if all.iter().all(|entry| entry.settings != as_set) {
        all.insert(0, Entry::new("as set".into(), as_set));
    }
    Ok(all)
}

/// A preset of a method, with the settings that do not belong to the method.
fn preset_entry(method: Method, preset: &'static str, table: &SettingsTable) -> Result<Entry> {
    let (mut table, mut whole) = (table.clone(), SettingsTable::default());
    whole.set("method", method.name());
    whole.set(&format!("{}.preset", method.name()), preset);
    table.merge(whole);
    let mut settings = table.resolve()?;
    // The filters that the scene sets have rows of their own.
    if let (MethodSettings::Raymarch(raymarch), Some(own)) =
        (&mut settings.method, Raymarch::preset(preset))
    {
        (raymarch.temporal, raymarch.denoise) = (own.temporal, own.denoise);
    }
    Ok(Entry { preset: Some(preset), ..Entry::new(preset.to_owned(), settings) })
}

impl Entry {
    /// The number of rows that the entry makes.
    pub fn rows(&self) -> usize {
        self.after.len()
    }

    fn new(label: String, settings: Settings) -> Self {
        let frames = match settings.method() {
            Method::Flood => FLOOD_FRAMES,
            _ if settings.bounces == Bounces::Feedback => FEEDBACK_FRAMES,
            _ => 1,
        };
        Self { label, preset: None, settings, after: vec![frames] }
    }
}

/// More and more rays, the edge-aware blur, and the mean over more and more frames.
fn raymarch_sweep(settings: &Settings) -> Vec<Entry> {
    let MethodSettings::Raymarch(raymarch) = &settings.method else { return Vec::new() };
    let with = |rays, temporal: Temporal, denoise: Denoise| {
        let raymarch = Raymarch { rays, temporal, denoise, ..raymarch.clone() };
        Settings { method: raymarch.into(), ..settings.clone() }
    };
    let (temporal, denoise) = (
        Temporal { history_length: 0, ..raymarch.temporal },
        Denoise { passes: 0, ..raymarch.denoise },
    );
    let with_rays = |rays| with(rays, temporal.clone(), denoise.clone());
    let mut all: Vec<Entry> =
        RAYS.iter().map(|&rays| Entry::new(format!("{rays} rays"), with_rays(rays))).collect();
    let passes = match raymarch.denoise.passes {
        0 => DENOISE_PASSES,
        passes => passes,
    };
    let blur = Denoise { passes, ..raymarch.denoise };
    let denoised = with(FEW_RAYS, temporal.clone(), blur);
    all.push(Entry::new(format!("{FEW_RAYS} rays, denoised"), denoised));
    let history_length = FRAMES.into_iter().fold(raymarch.temporal.history_length, u32::max);
    let averaged = with(FEW_RAYS, Temporal { history_length, ..raymarch.temporal }, denoise);
    let label = format!("{FEW_RAYS} rays, temporal");
    all.push(Entry { after: FRAMES.into(), ..Entry::new(label, averaged) });
    all
}

/// The light after some frames, and the median time of one.
struct Solved {
    lights: Vec<(u32, Light)>,
    time: Duration,
}

/// Solves frames, keeps the light after some of them, then times more of them.
fn lights(entry: &Entry, cells: &Cells, gpu: Option<&Gpu>) -> Result<Solved> {
    let mut frames = Frames::new(gpu, cells, entry.settings.clone())?;
    let mut times = Vec::new();
    let mut lights = Vec::new();
    for frame in 1..=entry.after.iter().copied().max().unwrap_or(1) {
        times.push(frames.next()?);
        if entry.after.contains(&frame) {
            lights.push((frame, frames.light()?));
        }
    }
    // The first frame makes the buffers, which takes longer.
    times.remove(0);
    let start = Instant::now();
    while times.is_empty() || (start.elapsed() < TIME && times.len() < MOST_RUNS) {
        times.push(frames.next()?);
    }
    times.sort_unstable();
    Ok(Solved { lights, time: times[times.len() / 2] })
}

/// Measures what was solved, with FLIP if there is a picture to compare with.
fn rows(
    entry: Entry,
    solved: Solved,
    evaluator: &Evaluator,
    truth: Option<&[Rgb]>,
) -> Result<Vec<Row>> {
    let Entry { label, preset, settings, .. } = entry;
    let several = solved.lights.len() > 1;
    let row = |(frames, light): (u32, Light)| {
        let (w, h) = (light.width() as usize, light.height() as usize);
        let flip = match truth {
            Some(truth) => {
                Some(flip(w, h, truth, &evaluator.picture(&light)?, PIXELS_PER_DEGREE).mean)
            }
            None => None,
        };
        Ok(Row {
            method: settings.method(),
            label: match frames {
                _ if !several => label.clone(),
                1 => format!("{label}, 1 frame"),
                n => format!("{label}, {n} frames"),
            },
            preset,
            frames,
            time: solved.time,
            measures: evaluator.measures(&light),
            grain: evaluator.grain(&light),
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
        let entries = entries(&[Method::Raymarch], &table(changes), None, sweep).unwrap();
        entries.into_iter().map(|entry| entry.label).collect()
    }

    #[test]
    fn presets_are_compared_and_settings_that_are_none() {
        assert_eq!(labels(&[], false), ["default", "fast", "high", "godot", "unity"]);
        assert_eq!(
            labels(&["raymarch.rays=7"], false),
            ["as set", "default", "fast", "high", "godot", "unity"]
        );
        assert_eq!(
            labels(&["raymarch.preset=unity"], false),
            ["default", "fast", "high", "godot", "unity"]
        );
        assert_eq!(
            labels(&["denoise.passes=2"], false),
            ["as set", "default", "fast", "high", "godot", "unity"]
        );
        assert!(labels(&[], true).contains(&"512 rays".to_owned()));
    }

    #[test]
    fn a_preset_ignores_settings_of_its_method() {
        let changes = ["raymarch.rays=7", "bounces=2"];
        for entry in entries(&[Method::Raymarch], &table(&changes), None, false).unwrap() {
            let rays = match &*entry.label {
                "as set" => 7,
                "fast" | "unity" => 16,
                "high" => 128,
                _ => 32,
            };
            let MethodSettings::Raymarch(raymarch) = &entry.settings.method else { panic!() };
            assert_eq!(raymarch.rays, rays, "{}", entry.label);
            assert_eq!(entry.settings.bounces, Bounces::Count(2));
        }
    }

    #[test]
    fn a_method_that_cannot_light_the_scene_is_named_with_its_reason() {
        let cells = Cells::new(4, 3).unwrap();
        let truth = ReferenceLight::Everywhere(Estimate {
            light: Light::from_pixels(&cells, vec![[1.0; 3]; 12]).unwrap(),
            standard_error: vec![[0.0; 3]; 12],
        });
        let evaluator = Evaluator { cells: &cells, truth: &truth, display: Display::default() };
        let entries = entries(&[Method::Polar], &table(&[]), None, false).unwrap();
        let result = run(&evaluator, entries, None, true);
        let failure = format!("{:?}", result.map(|_| "a light").unwrap_err());
        assert!(
            failure.contains("polar cannot light this scene: polar lights lamps only"),
            "{failure}"
        );
    }

    #[test]
    fn an_evaluator_of_some_cells_ignores_the_others() {
        let cells = Cells::new(3, 1).unwrap();
        let light = |rgb| Light::from_pixels(&cells, rgb).unwrap();
        let truth = ReferenceLight::At(vec![[2, 0], [0, 0]], vec![[4.0; 3], [2.0; 3]]);
        let evaluator = Evaluator { cells: &cells, truth: &truth, display: Display::default() };
        let right = light(vec![[2.0; 3], [9.0; 3], [4.0; 3]]);
        assert_eq!(evaluator.measures(&right).relative_rmse, 0.0);
        let wrong = light(vec![[4.0; 3], [9.0; 3], [2.0; 3]]);
        assert!(evaluator.measures(&wrong).relative_rmse > 0.5);
    }
}
