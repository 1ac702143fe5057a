//! One frame, from cells to light, top to bottom.

use crate::clock::Clock;
use crate::filters::denoise::Denoiser;
use crate::filters::estimate::Estimate;
use crate::filters::temporal::TemporalMean;
use crate::methods::cascades::Cascades;
use crate::methods::flood::FloodSolver;
use crate::methods::holographic::Holographic;
use crate::methods::polar::PolarSolver;
use crate::methods::raymarch::{Input, RaymarchSolver, window};
use crate::settings::{self, Bounces, Hit, Method, MethodSettings, Traversal, Variant};
use crate::stages::bounce::{FrameBounces, KnownSurfaces, Surfaces};
use crate::stages::direct::{self, DirectLight};
use crate::stages::glow::Glow;
use crate::stages::gradient_moment::gradient_moment;
use crate::stages::walls::Walls;
use crate::stages::{distance::distance, jump_flood, seed::seed};
use crate::sun_glow::SunGlow;
use crate::{Cells, GridWindow, Inflow, Lamp, Light, Result, Settings, elevation};
use fearless_simd::Level;
use std::time::Duration;

/// A method with its buffers and its history.
///
/// Solving again with the same size does not allocate. A solver runs on the rayon pool in which it is
/// called.
#[derive(Debug)]
pub struct Solver {
    pub(crate) settings: Settings,
    frame: u32,
    pub(crate) cells: Cells,
    direct: DirectLight,
    sun_glow: SunGlow,
    glow: Glow,
    fields: Fields,
    pub(crate) raymarch: RaymarchSolver,
    flood: FloodSolver,
    pub(crate) polar: PolarSolver,
    pub(crate) cascades: Cascades,
    pub(crate) holographic: Holographic,
    estimate: Estimate,
    temporal: TemporalMean,
    denoise: Denoiser,
    walls: Walls,
    light: Light,
    clock: Clock,
    /// The cells by which the next grid has moved.
    moved: [i32; 2],
}

/// The fields that the stages before the methods compute.
#[derive(Debug, Default)]
struct Fields {
    seeds: Vec<u32>,
    nearest: Vec<u32>,
    scratch: Vec<u32>,
    distance: Vec<f32>,
    energy: Vec<f32>,
    /// True if the fields belong to the cells of the last frame.
    measured: bool,
}

/// The intermediates of the last frame, with one entry per cell in row order.
#[derive(Clone, Copy, Debug)]
pub struct Stages<'a> {
    /// The grid that the method read: with lamps drawn in, except for `polar` and `flood`.
    pub cells: &'a Cells,
    /// Seed map: the position of each occupied cell as `y << 16 | x`, and `u32::MAX` in empty cells.
    pub seeds: &'a [u32],
    /// Voronoi map: the position of the nearest occupied cell, packed in the same way.
    pub nearest: &'a [u32],
    /// Distance in px to the nearest occupied cell.
    pub distance: &'a [f32],
    /// The colourless energy of `flood`; empty for other methods.
    pub energy: &'a [f32],
}

impl Solver {
    /// Creates a solver.
    ///
    /// # Errors
    /// Fails if a setting is out of its range.
    pub fn new(settings: Settings) -> Result<Self> {
        settings.check()?;
        Ok(Self {
            settings,
            frame: 0,
            cells: Cells::new(1, 1)?,
            direct: DirectLight::default(),
            sun_glow: SunGlow::default(),
            glow: Glow::default(),
            fields: Fields::default(),
            raymarch: RaymarchSolver::default(),
            flood: FloodSolver::default(),
            polar: PolarSolver::default(),
            cascades: Cascades::default(),
            holographic: Holographic::default(),
            estimate: Estimate::default(),
            temporal: TemporalMean::default(),
            denoise: Denoiser::default(),
            walls: Walls::default(),
            light: Light::default(),
            clock: Clock::default(),
            moved: [0; 2],
        })
    }

    /// The current settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes the settings from the next frame on. Buffers are kept. History goes on if only the seed, `elevation`,
    /// `wall_depth` or `moment` changes, and that of feedback with the settings of the same method too: what surfaces
    /// reflected does not vanish. (The mean of `raymarch` begins anew when there are moments or none any more.) Otherwise
    /// it is reset, because it was computed with other settings.
    ///
    /// # Errors
    /// Fails, and changes nothing, if a setting is out of its range.
    pub fn set_settings(&mut self, settings: Settings) -> Result<()> {
        settings.check()?;
        if !self.settings.is_continued_by(&settings) {
            self.reset();
        }
        self.settings = settings;
        Ok(())
    }

    /// Solves one frame. Each call is the next frame: noise advances, history and feedback
    /// accumulate.
    ///
    /// # Errors
    /// Fails if a cell, a lamp or the sky is invalid, or if the method cannot light the scene
    /// (`polar` without lamps). The light of the last frame then stays.
    pub fn solve(&mut self, cells: &Cells) -> Result<&Light> {
        self.solve_known(cells, None)
    }

    /// Like [`Self::solve`], of a part of a world whose surfaces send light that is `known`. If its next bounce is wanted,
    /// that is in [`Self::surfaces`], and no light is found.
    pub(crate) fn solve_known(
        &mut self,
        cells: &Cells,
        known: Option<KnownSurfaces>,
    ) -> Result<&Light> {
        self.clock.start();
        cells.check()?;
        let method = self.settings.method();
        method.suits(cells)?;
        self.cells.clone_from(cells);
        self.settings.method.draw_lamps(&mut self.cells);
        self.cells.set_sky(self.sun_glow.draw(method, cells.sky(), cells.suns()));
        self.cells.suns_mut().retain(|sun| method.shines_exactly(sun));
        let with_moment = self.settings.moment || cells.normals().is_some();
        self.light.moment = with_moment.then(|| self.light.moment.take().unwrap_or_default());
        self.light.elevation = self.settings.elevation;
        self.clock.lap("cells");
        self.direct.clear();
        let Self { polar, cells, direct, clock, settings, .. } = self;
        let exact = |lamp: &&Lamp| method.lights_exactly(lamp);
        direct.lamps.extend(cells.lamps().iter().filter(exact).cloned());
        // `polar` finds the light of suns by itself.
        if method != Method::Polar && !(direct.lamps.is_empty() && cells.suns().is_empty()) {
            polar.solve_direct(cells, with_moment.then_some(settings.elevation), direct);
            clock.lap("direct");
        }
        let glows = self.settings.method.reads_glow();
        if glows {
            self.glow.to_media(&mut self.cells);
        }
        self.fields.measured = false;
        self.clock.lap("cells");

        // Cloned, a few bytes, so that a method can borrow the rest of the solver.
        let Settings { method, bounces, .. } = self.settings.clone();
        let moved = std::mem::take(&mut self.moved);
        let bounces = if known.is_some() { Bounces::Count(0) } else { method.bounces(bounces) };
        let bounces = FrameBounces { bounces, moved, known };
        match &method {
            MethodSettings::Raymarch(settings) => self.raymarch(settings, bounces),
            MethodSettings::Polar(settings) => self.polar(settings),
            MethodSettings::Flood(settings) => {
                let Self { flood, cells, light, clock, .. } = self;
                flood.solve(cells, settings, moved, &mut light.rgb, clock);
                self.gradient_moment();
            }
            MethodSettings::Cascades(settings) => {
                let Self { cascades, cells, direct, light, clock, .. } = self;
                cascades.solve(cells, settings, bounces, direct, light, clock);
            }
            MethodSettings::Holographic(settings) => {
                let Self { holographic, cells, direct, light, clock, .. } = self;
                holographic.solve(cells, settings, bounces, direct, light, clock);
                if settings.variant == Variant::Paper {
                    self.gradient_moment();
                }
            }
        }

        if glows {
            self.glow.restore(&mut self.cells);
        }
        if known.is_some_and(|known| known.bounce) {
            return Ok(&self.light);
        }
        if let Some(moment) = &mut self.light.moment {
            self.direct.add_moment_to(moment);
        }
        self.direct.add_to(&mut self.light.rgb);
        if self.cells.lamps().iter().any(Lamp::takes_light) {
            let (lamps, suns) = (self.cells.lamps(), self.cells.suns());
            let longest = elevation::longest_moment(lamps, suns, self.settings.elevation);
            direct::clamp(&mut self.light.rgb, self.light.moment.as_deref_mut(), longest);
        }
        self.light.width = self.cells.width();
        self.light.height = self.cells.height();
        self.light.solid.clear();
        self.light.solid.extend(self.cells.opacity().iter().map(|&opacity| opacity >= 1.0));
        let depth = self.settings.wall_depth;
        if let Some(moment) = &mut self.light.moment {
            self.walls.sink_moment(&self.cells, depth, &self.light.rgb, moment);
        }
        self.walls.sink(&self.cells, depth, &mut self.light.rgb);
        self.clock.lap("walls");
        self.frame = self.frame.wrapping_add(1);
        Ok(&self.light)
    }

    fn raymarch(&mut self, settings: &settings::Raymarch, bounces: FrameBounces) {
        if settings.hit == Hit::Distance {
            self.measure();
        }
        let accumulates = settings.temporal.history_length > 1;
        let changed =
            if accumulates { self.temporal.mark(&settings.temporal, &self.cells) } else { &[] };
        let seed = self.settings.seed;
        let input = Input {
            settings,
            bounces,
            seed,
            cells: &self.cells,
            direct: &self.direct,
            distance: &self.fields.distance,
            nearest: &self.fields.nearest,
            changed,
            frame: self.frame,
        };
        let Self { light, estimate, .. } = self;
        estimate.moment =
            light.moment.is_some().then(|| estimate.moment.take().unwrap_or_default());
        self.raymarch.solve(input, &mut self.estimate, &mut self.clock);
        if bounces.known.is_some_and(|known| known.bounce) {
            return;
        }

        if accumulates {
            let feedback = bounces.bounces == Bounces::Feedback;
            let width = self.cells.width();
            self.temporal.accumulate(&settings.temporal, width, feedback, &mut self.estimate);
            self.clock.lap("temporal");
        }
        if settings.denoise.passes > 0 {
            self.denoise.denoise(&settings.denoise, &self.cells, &mut self.estimate);
            self.clock.lap("denoise");
        }
        self.light.rgb.clone_from(&self.estimate.light);
        self.light.moment.clone_from(&self.estimate.moment);
    }

    fn polar(&mut self, settings: &settings::Polar) {
        if settings.traversal == Traversal::Distance {
            self.measure();
        }
        let Self { polar, cells, fields, light, clock, .. } = self;
        polar.solve(cells, &fields.distance, settings, light, clock);
    }

    /// Estimates the first moment for methods that find no light by direction.
    fn gradient_moment(&mut self) {
        let Self { cells, light, .. } = self;
        if let Some(moment) = &mut light.moment {
            gradient_moment(cells, &light.rgb, moment);
        }
    }

    /// Seed map, jump flood, distance field.
    fn measure(&mut self) {
        let (cells, fields) = (&self.cells, &mut self.fields);
        let (w, h) = (cells.width(), cells.height());
        seed(cells, self.settings.seed_threshold(), &mut fields.seeds);
        self.clock.lap("seed");
        fields.nearest.clone_from(&fields.seeds);
        jump_flood::jump_flood(w, h, 0, &mut fields.nearest, &mut fields.scratch);
        jump_flood::settle(w, h, &mut fields.nearest, &mut fields.scratch);
        self.clock.lap("jump_flood");
        distance(w, &fields.nearest, &mut fields.distance);
        self.clock.lap("distance");
        fields.measured = true;
    }

    /// The light of the last frame; empty before the first one.
    pub fn light(&self) -> &Light {
        &self.light
    }

    /// The intermediates of the last frame. Those that the frame did not need are computed now.
    pub fn stages(&mut self) -> Stages<'_> {
        if !self.fields.measured {
            // It is not part of the frame's time.
            let clock = std::mem::take(&mut self.clock);
            self.measure();
            self.clock = clock;
        }
        self.fields.energy.clear();
        if self.settings.method() == Method::Flood {
            self.flood.energy(&mut self.fields.energy);
        }
        let Fields { seeds, nearest, distance, energy, .. } = &self.fields;
        Stages { cells: &self.cells, seeds, nearest, distance, energy }
    }

    /// The light that enters a window of the last frame's grid from the rest of it, in `columns` directions: what
    /// [`Cells::set_inflow`] takes for a grid of the window's cells, so that it has the same light alone.
    ///
    /// Lamps that are lit by their shadow maps, and suns, are not part of it: they stay lamps and suns.
    ///
    /// # Errors
    /// Fails if the window does not lie in the grid, or as [`Inflow::new`].
    pub fn inflow(&mut self, window: GridWindow, columns: usize) -> Result<Inflow> {
        window.check([self.cells.width(), self.cells.height()])?;
        let glows = self.settings.method.reads_glow();
        if glows {
            self.glow.to_media(&mut self.cells);
        }
        let (of_method, cells) = (self.surfaces(), &self.cells);
        let mut dark = Surfaces::default();
        let surfaces = match of_method.filter(|surfaces| surfaces.are_of(cells)) {
            Some(surfaces) => surfaces,
            None => {
                dark.collect(cells, 0.0);
                &dark
            }
        };
        let neutral = settings::Raymarch::default();
        let matter = self.settings.method.as_raymarch().unwrap_or(&neutral);
        let inflow = window::inflow(Level::new(), cells, matter, surfaces, window, columns);
        if glows {
            self.glow.restore(&mut self.cells);
        }
        inflow
    }

    /// The surfaces of the last frame, if the method has any.
    pub(crate) fn surfaces(&self) -> Option<&Surfaces> {
        match self.settings.method() {
            Method::Raymarch => Some(self.raymarch.surfaces()),
            Method::Cascades => Some(self.cascades.surfaces()),
            Method::Holographic => Some(self.holographic.surfaces()),
            _ => None,
        }
    }

    /// The time that each stage of the last frame took, in order.
    pub fn timings(&self) -> &[(&'static str, Duration)] {
        &self.clock.laps
    }

    /// Tells that the grid of the next frame lies elsewhere in your world: its first cell is the one that the frame
    /// before had `by` cells from its first one, to the right and down. The light that surfaces reflect from frame to
    /// frame ([`Bounces::Feedback`]) and the energy of `flood` stay in the world; the mean over frames of `raymarch` starts
    /// anew.
    pub fn shift(&mut self, by: [i32; 2]) {
        if by != [0; 2] {
            self.moved = [0, 1].map(|a| self.moved[a].saturating_add(by[a]));
            self.temporal.reset();
        }
    }

    /// Discards all history, as after a cut or a jump of the camera.
    pub fn reset(&mut self) {
        self.frame = 0;
        self.raymarch.reset();
        self.flood.reset();
        self.temporal.reset();
        self.cascades.reset();
        self.holographic.reset();
    }
}
