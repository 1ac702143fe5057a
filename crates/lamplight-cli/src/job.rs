//! A render job: everything that lighting a scene takes, resolved before anything runs.

use crate::args::{Backend, DisplayArgs, LightingArgs, Renderer};
use crate::error::{CliError, Result, warn};
use crate::gpu::Gpu;
use crate::input::Input;
use crate::lit::Lit;
use crate::memory::{self, SceneSize};
use crate::output::OutputFiles;
use crate::solve;
use crate::stage::{Fields, check_scale};
use crate::warnings;
use lamplight::settings::MethodSettings;
use lamplight::{Bounces, Cells, Display, Settings};
use std::path::Path;

/// Paths per pixel of the reference, unless a flag sets them.
const SAMPLES: u32 = 256;

/// A scene with its settings, its display and the device to light it on.
pub struct RenderJob {
    pub cells: Cells,
    pub display: Display,
    /// Writes files, but never over those of the scene.
    pub outputs: OutputFiles,
    settings: Settings,
    renderer: Renderer,
    /// The GPU to compute on; without one the CPU computes.
    gpu: Option<Gpu>,
    frames: u32,
    samples: u32,
    quiet: bool,
}

impl RenderJob {
    /// Reads a scene and decides how to light it. A job that `computes` nothing opens no GPU.
    pub fn resolve(
        path: &Path,
        lighting: &LightingArgs,
        display: &DisplayArgs,
        computes: bool,
    ) -> Result<Self> {
        let quiet = lighting.machine.quiet;
        let scene = Input::load(path)?;
        let (renderer, mut settings, bounces) = lighting.resolve(&scene.settings())?;
        average(&mut settings, lighting.frames);
        let scale = display.scale;
        check_scale(scene.size(), scale)?;
        let display = display.resolve(scene.display())?;
        if renderer == Renderer::Reference && lighting.machine.backend == Backend::Gpu {
            return Err(CliError::bad_input("the reference has no GPU backend so far")
                .hint("leave --backend out, or say --backend cpu"));
        }
        let (cells, outputs) = read_cells(&scene, path, quiet, |size| {
            memory::estimate(size, renderer, &settings, lighting.machine.backend)
                + memory::estimate_picture(size.cells, scale)
        })?;
        if computes && !quiet {
            warn_of_what_is_ignored(lighting, renderer, &cells, &settings, bounces);
        }
        let gpu = match renderer {
            Renderer::Method(_) if computes => Gpu::choose(lighting.machine.backend)?,
            _ => None,
        };
        Ok(Self {
            cells,
            display,
            outputs,
            settings,
            renderer,
            gpu,
            frames: lighting.frames,
            samples: lighting.samples.unwrap_or(SAMPLES),
            quiet,
        })
    }

    /// Lights the scene.
    pub fn light(&self) -> Result<Lit> {
        let Self { cells, settings, frames, quiet, .. } = self;
        match (self.renderer, &self.gpu) {
            (Renderer::Reference, _) => solve::reference(cells, settings, self.samples, *quiet),
            (Renderer::Method(_), Some(gpu)) => gpu.solve(cells, settings.clone(), *frames),
            (Renderer::Method(_), None) => solve::solve(cells, settings.clone(), *frames, *quiet),
        }
    }

    /// The cells with their lamps drawn in.
    pub fn drawn(&self) -> Cells {
        let mut drawn = self.cells.clone();
        self.settings.method.draw_lamps(&mut drawn);
        // Those that the method lights by rule.
        drawn.draw_lamps();
        drawn
    }

    /// Finds the nearest occupied cell of each cell, and the distance to it.
    pub fn fields(&self, drawn: &Cells) -> Result<Fields> {
        match &self.gpu {
            Some(gpu) => gpu.fields(drawn, self.settings.fields_only()),
            None => solve::fields(drawn, &self.settings),
        }
    }
}

/// Makes the cells of a scene, if `bytes_needed` for its size can be allocated. Prints the scene's
/// warnings unless `quiet`.
pub fn read_cells(
    scene: &Input,
    path: &Path,
    quiet: bool,
    bytes_needed: impl FnOnce(SceneSize) -> u64,
) -> Result<(Cells, OutputFiles)> {
    let [width, height] = scene.size();
    let needed = bytes_needed(scene.scene_size());
    memory::check(needed, format_args!("lighting {} ({width}×{height} cells)", path.display()))?;
    let cells = scene.cells()?;
    if !quiet {
        scene.warnings(&cells).iter().for_each(|text| warn(text));
    }
    Ok((cells, OutputFiles::protecting(scene.files()?)))
}

fn warn_of_what_is_ignored(
    flags: &LightingArgs,
    renderer: Renderer,
    cells: &Cells,
    settings: &Settings,
    bounces: Option<Bounces>,
) {
    let suited = !matches!(renderer, Renderer::Method(method) if method.suits(cells).is_err());
    if let (Some(text), true) = (warnings::left_out(renderer, cells, settings, bounces), suited) {
        warn(&text);
    }
    if let Some(text) = warnings::missing_bounces(renderer, settings, flags.frames) {
        warn(&text);
    }
    warnings::idle_lighting_flags(flags, renderer, settings).iter().for_each(|text| warn(text));
}

/// Lets the last of some frames be their mean, if they show the same light with other noise.
fn average(settings: &mut Settings, frames: u32) {
    let MethodSettings::Raymarch(raymarch) = &mut settings.method else { return };
    // Frames that each add a bounce are not to be averaged: the first ones are darker.
    let growing = settings.bounces == Bounces::Feedback;
    if frames > 1 && raymarch.temporal.history_length <= 1 && !growing {
        raymarch.temporal.history_length = frames;
    }
}
