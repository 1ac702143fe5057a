//! Small worlds that move on by fixed steps and are drawn into cells.

pub mod bodies;
pub mod room;
pub mod sand;

use crate::look::Look;
use lamplight::{Cells, Error, Result};

/// What a world is told in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Input {
    /// Where the pointer is, in cells from the top left; `None` outside the picture.
    pub pointer: Option<[f32; 2]>,
    /// Whether the pointer is held down.
    pub pressed: bool,
    /// Whether it was pressed since the last step.
    pub just_pressed: bool,
    /// Whether it was let go since the last step.
    pub just_released: bool,
    /// Which of [`World::brushes`].
    pub brush: usize,
    /// Radius of the brush, px; a world takes what it can of it.
    pub radius: f32,
    /// Direction keys: −1, 0 or 1 to the right and down.
    pub direction: [f32; 2],
    /// Whether the key for doing something (Space) was struck since the last step.
    pub action: bool,
    /// Whether the key for switching something (F) was struck since the last step.
    pub switch: bool,
}

impl Input {
    /// The same without what is told once.
    #[must_use]
    pub fn held(&self) -> Self {
        Self { just_pressed: false, just_released: false, action: false, switch: false, ..*self }
    }

    /// The same, with what was told once before and has reached no step yet.
    #[must_use]
    pub fn after(&self, before: &Self) -> Self {
        Self {
            just_pressed: self.just_pressed || before.just_pressed,
            just_released: self.just_released || before.just_released,
            action: self.action || before.action,
            switch: self.switch || before.switch,
            ..*self
        }
    }
}

/// A world that is played.
pub trait World {
    /// Columns and rows.
    fn size(&self) -> [u32; 2];

    /// One step of [`crate::clock::Clock::STEP`] seconds.
    fn step(&mut self, input: &Input);

    /// Draws all matter, lamps and the sky into cells of the world's size, over whatever they held;
    /// cells of another size are left as they are. Allocates nothing from the second time on.
    fn draw(&self, cells: &mut Cells);

    /// How it is played, in a line.
    fn help(&self) -> &'static str;

    /// What [`Input::brush`] chooses from; empty where it means nothing.
    fn brushes(&self) -> &'static [&'static str] {
        &[]
    }

    /// How it asks to be lit and shown.
    fn look(&self) -> Look;

    /// Whether it has a player, whom [`World::lit`] looks at.
    fn has_player(&self) -> bool {
        false
    }

    /// How brightly the player is lit, 0 to 1, in worlds that have one ([`room::Room::lit`]).
    fn lit(&self, _light: &lamplight::Light) -> Option<f32> {
        None
    }
}

/// The worlds there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Rigid bodies that bounce and carry light.
    Bodies,
    /// Falling sand.
    Sand,
    /// A small house at night, seen from above.
    Room,
}

impl Kind {
    /// Every world, in the order in which lists show them.
    pub const ALL: &'static [Self] = &[Self::Bodies, Self::Sand, Self::Room];
    /// Smallest columns and rows: below, nobody sees what is going on.
    pub const LEAST: [u32; 2] = [96, 54];
    /// Most columns and rows: above, no machine keeps up.
    pub const MOST: [u32; 2] = [1920, 1080];

    /// The name in lists and flags.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bodies => "bodies",
            Self::Sand => "sand",
            Self::Room => "room",
        }
    }

    /// Builds the world. The same size and seed give the same one.
    pub fn make(self, size: [u32; 2], seed: u64) -> Result<Box<dyn World>> {
        let fits = |i: usize| (Self::LEAST[i]..=Self::MOST[i]).contains(&size[i]);
        if !(fits(0) && fits(1)) {
            let ([w, h], [low, flat], [wide, high]) = (size, Self::LEAST, Self::MOST);
            let expected = format!("from {low}×{flat} to {wide}×{high} cells");
            return Err(Error::value("size", format!("{w}×{h}"), expected));
        }
        Ok(match self {
            Self::Bodies => Box::new(bodies::Bodies::new(size, seed)),
            Self::Sand => Box::new(sand::Sand::new(size, seed)),
            Self::Room => Box::new(room::Room::new(size, seed)),
        })
    }
}

/// Whether cells have a world's size.
fn fits(size: [u32; 2], cells: &Cells) -> bool {
    size == [cells.width(), cells.height()]
}

/// Copies everything but the lamps, into buffers at hand.
fn copy(from: &Cells, to: &mut Cells) {
    to.emission_mut().copy_from_slice(from.emission());
    to.opacity_mut().copy_from_slice(from.opacity());
    to.tint_mut().copy_from_slice(from.tint());
    to.albedo_mut().copy_from_slice(from.albedo());
    if let Some(color) = from.color() {
        to.color_mut().copy_from_slice(color);
    }
    to.set_sky(from.sky());
}
