//! The subject of the picture: a canvas or a world.

use crate::platform;
use anyhow::Result;
use lamplight::{Cells, Display, Settings};
use lamplight_sandbox::canvas::Canvas;
use lamplight_sandbox::clock::Clock;
use lamplight_sandbox::look::Look;
use lamplight_sandbox::worlds::{Input, World, WorldKind};

/// A choice of subject.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Choice {
    #[default]
    Paint,
    Bodies,
    Sand,
    Room,
}

impl Choice {
    pub const ALL: [Self; 4] = [Self::Paint, Self::Bodies, Self::Sand, Self::Room];

    /// The name on its button.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paint => "Paint",
            Self::Bodies => "Bodies",
            Self::Sand => "Sand",
            Self::Room => "Room",
        }
    }
}

/// The current subject.
pub enum Subject {
    Canvas(Box<Canvas>),
    World(Box<Playing>),
}

/// A running world.
pub struct Playing {
    pub world: Box<dyn World>,
    clock: Clock,
    cells: Cells,
    pub paused: bool,
}

impl Playing {
    /// Advances it by `seconds`.
    pub fn play(&mut self, seconds: f64, input: &Input) {
        if !self.paused {
            self.clock.play(self.world.as_mut(), seconds, input);
        }
        self.world.draw(&mut self.cells);
    }
}

impl Subject {
    pub fn new(choice: Choice, size: [u32; 2], seed: u64) -> Result<Self> {
        let kind = match choice {
            Choice::Paint => return Ok(Self::Canvas(Box::new(Canvas::welcome(size)?))),
            Choice::Bodies => WorldKind::Bodies,
            Choice::Sand => WorldKind::Sand,
            Choice::Room => WorldKind::Room,
        };
        let world = kind.make(size, seed)?;
        let mut cells = Cells::new(size[0], size[1])?;
        world.draw(&mut cells);
        let playing = Playing { world, clock: Clock::default(), cells, paused: false };
        Ok(Self::World(Box::new(playing)))
    }

    pub fn cells(&self) -> &Cells {
        match self {
            Self::Canvas(canvas) => canvas.cells(),
            Self::World(playing) => &playing.cells,
        }
    }

    pub fn size(&self) -> [u32; 2] {
        [self.cells().width(), self.cells().height()]
    }

    pub fn look(&self) -> Look {
        match self {
            Self::Canvas(canvas) => canvas.look(),
            Self::World(playing) => playing.world.look(),
        }
    }

    /// The files of a canvas as a scene with these settings; empty for worlds.
    pub fn scene(
        &mut self,
        settings: &Settings,
        display: Display,
        name: &str,
    ) -> Result<Vec<platform::File>> {
        let Self::Canvas(canvas) = self else { return Ok(Vec::new()) };
        canvas.set_look(Look::of(settings, display));
        Ok(canvas.save(name)?)
    }

    /// Returns true if it shows the brightness of a player.
    pub fn has_meter(&self) -> bool {
        matches!(self, Self::World(playing) if playing.world.has_player())
    }

    /// One line of instructions.
    pub fn help(&self) -> &'static str {
        match self {
            Self::Canvas(_) => {
                "Paint with the mouse; the right button erases. Lamps can be dragged. Drop pictures and scenes here."
            }
            Self::World(playing) => playing.world.help(),
        }
    }
}
