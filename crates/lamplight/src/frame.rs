//! One frame, from cells to light, top to bottom.

use crate::clock::Clock;
use crate::methods::cascades::Cascades;
use crate::methods::flood::Flood;
use crate::methods::holographic::Holographic;
use crate::methods::polar::Polar;
use crate::methods::raymarch::{Input, Raymarch};
use crate::settings::{BounceBy, Bounces, Hit, Method, Walk};
use crate::stages::denoise::Denoise;
use crate::stages::temporal::Temporal;
use crate::stages::traced::Traced;
use crate::stages::walls::Walls;
use crate::stages::{distance::distance, jump_flood, seed::seed};
use crate::{Cells, Light, Result, Settings};
use std::time::Duration;

/// Runs a method; keeps its buffers between frames, so that solving again with the same size
/// allocates nothing. Runs on the rayon pool it is called in.
#[derive(Debug)]
pub struct Solver {
    pub(crate) settings: Settings,
    frame: u32,
    pub(crate) cells: Cells,
    fields: Fields,
    pub(crate) raymarch: Raymarch,
    flood: Flood,
    pub(crate) polar: Polar,
    pub(crate) cascades: Cascades,
    pub(crate) holographic: Holographic,
    traced: Traced,
    temporal: Temporal,
    denoise: Denoise,
    walls: Walls,
    light: Light,
    clock: Clock,
}

/// What the stages before the methods leave behind.
#[derive(Debug, Default)]
struct Fields {
    seeds: Vec<u32>,
    nearest: Vec<u32>,
    scratch: Vec<u32>,
    distance: Vec<f32>,
    energy: Vec<f32>,
    /// Whether they belong to the cells of the last frame.
    measured: bool,
}

/// A look at the intermediates of the last frame; each has one entry a cell, in row order.
#[derive(Clone, Copy, Debug)]
pub struct Stages<'a> {
    /// The grid, with its lamps drawn in where the method sees them so.
    pub cells: &'a Cells,
    /// Seed map: the own position of occupied cells, packed ([`crate::stages::seed`]).
    pub seeds: &'a [u32],
    /// Voronoi map: the nearest occupied cell, packed.
    pub nearest: &'a [u32],
    /// px to the nearest occupied cell.
    pub distance: &'a [f32],
    /// `flood`: the source's energy, which knows no colour; empty for other methods.
    pub energy: &'a [f32],
}

impl Solver {
    /// A solver with checked settings.
    pub fn new(settings: Settings) -> Result<Self> {
        settings.check()?;
        Ok(Self {
            settings,
            frame: 0,
            cells: Cells::new(1, 1)?,
            fields: Fields::default(),
            raymarch: Raymarch::default(),
            flood: Flood::default(),
            polar: Polar::default(),
            cascades: Cascades::default(),
            holographic: Holographic::default(),
            traced: Traced::default(),
            temporal: Temporal::default(),
            denoise: Denoise::default(),
            walls: Walls::default(),
            light: Light::default(),
            clock: Clock::default(),
        })
    }

    /// The settings it was made with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Solves one frame. Each call is the next frame: noise moves on, history and feedback grow.
    pub fn solve(&mut self, cells: &Cells) -> Result<&Light> {
        self.clock.start();
        cells.check()?;
        self.settings.method.suits(cells)?;
        self.cells.clone_from(cells);
        if !self.settings.method.lights_lamps() {
            self.cells.draw_lamps();
        }
        self.fields.measured = false;
        self.clock.lap("cells");

        match self.settings.method {
            Method::Raymarch => self.raymarch(),
            Method::Flood => self.flood(),
            Method::Polar => self.polar(),
            Method::Cascades => {
                let Self { cells, settings, light, clock, .. } = self;
                self.cascades.solve(cells, settings, &mut light.rgb, clock);
            }
            Method::Holographic => self.holographic.solve(
                &self.cells,
                &self.settings,
                &mut self.light.rgb,
                &mut self.clock,
            ),
        }

        self.light.width = self.cells.width();
        self.light.height = self.cells.height();
        self.light.solid.clear();
        self.light.solid.extend(self.cells.opacity().iter().map(|&opacity| opacity >= 1.0));
        self.walls.sink(&self.cells, self.settings.wall_depth, &mut self.light.rgb);
        self.clock.lap("walls");
        self.frame = self.frame.wrapping_add(1);
        Ok(&self.light)
    }

    fn raymarch(&mut self) {
        if self.settings.raymarch.hit == Hit::Distance {
            self.measure();
        }
        let settings = &self.settings;
        let accumulates = settings.temporal.frames > 1;
        let changed =
            if accumulates { self.temporal.mark(&settings.temporal, &self.cells) } else { &[] };
        let input = Input {
            cells: &self.cells,
            distance: &self.fields.distance,
            nearest: &self.fields.nearest,
            changed,
            frame: self.frame,
        };
        self.raymarch.solve(input, settings, &mut self.traced, &mut self.clock);

        if accumulates {
            let feedback = settings.bounces != Bounces::Count(0)
                && settings.raymarch.bounce == BounceBy::Feedback;
            let width = self.cells.width();
            self.temporal.accumulate(&settings.temporal, width, feedback, &mut self.traced);
            self.clock.lap("temporal");
        }
        if settings.denoise.passes > 0 {
            self.denoise.denoise(&settings.denoise, &self.cells, &mut self.traced);
            self.clock.lap("denoise");
        }
        self.light.rgb.clone_from(&self.traced.light);
    }

    fn flood(&mut self) {
        self.flood.solve(&self.cells, &self.settings.flood, &mut self.light.rgb, &mut self.clock);
    }

    fn polar(&mut self) {
        if self.settings.polar.walk == Walk::Distance {
            self.measure();
        }
        let (fields, settings) = (&self.fields, &self.settings.polar);
        let rgb = &mut self.light.rgb;
        self.polar.solve(&self.cells, &fields.distance, settings, rgb, &mut self.clock);
    }

    /// Seed map, jump flood, distance field.
    fn measure(&mut self) {
        let (cells, fields) = (&self.cells, &mut self.fields);
        let (w, h) = (cells.width(), cells.height());
        seed(cells, self.settings.raymarch.threshold, &mut fields.seeds);
        self.clock.lap("seed");
        fields.nearest.clone_from(&fields.seeds);
        jump_flood::jump_flood(w, h, 0, &mut fields.nearest, &mut fields.scratch);
        jump_flood::settle(w, h, &mut fields.nearest, &mut fields.scratch);
        self.clock.lap("jump_flood");
        distance(w, &fields.nearest, &mut fields.distance);
        self.clock.lap("distance");
        fields.measured = true;
    }

    /// The light of the last frame.
    pub fn light(&self) -> &Light {
        &self.light
    }

    /// The intermediates of the last frame; those that it did not need are made now.
    pub fn stages(&mut self) -> Stages<'_> {
        if !self.fields.measured {
            self.measure();
        }
        self.fields.energy.clear();
        if self.settings.method == Method::Flood {
            self.flood.energy(&mut self.fields.energy);
        }
        let Fields { seeds, nearest, distance, energy, .. } = &self.fields;
        Stages { cells: &self.cells, seeds, nearest, distance, energy }
    }

    /// What each stage of the last frame took.
    pub fn timings(&self) -> &[(&'static str, Duration)] {
        &self.clock.laps
    }

    /// Forgets the frames before: the next one starts afresh, as after a cut or a jump of the view.
    pub fn reset(&mut self) {
        self.frame = 0;
        self.raymarch = Raymarch::default();
        self.flood = Flood::default();
        self.temporal = Temporal::default();
    }
}
