//! Small worlds that advance in fixed steps and are drawn into cells.

pub mod bodies;
pub mod room;
pub mod sand;
mod world;

pub use world::{Input, STEP, World};

use lamplight::{Error, Result};

/// A kind of world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WorldKind {
    /// Rigid bodies that bounce and carry light.
    Bodies,
    /// Falling sand.
    Sand,
    /// A small house at night, seen from above.
    Room,
}

impl WorldKind {
    /// Every world, in the order of lists.
    pub const ALL: &'static [Self] = &[Self::Bodies, Self::Sand, Self::Room];
    /// Smallest columns and rows.
    pub const MIN: [u32; 2] = [96, 54];
    /// Largest columns and rows.
    pub const MAX: [u32; 2] = [1920, 1080];

    /// The name in lists and flags.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bodies => "bodies",
            Self::Sand => "sand",
            Self::Room => "room",
        }
    }

    /// Builds the world. The same size and seed give the same world.
    pub fn make(self, size: [u32; 2], seed: u64) -> Result<Box<dyn World>> {
        let fits = |i: usize| (Self::MIN[i]..=Self::MAX[i]).contains(&size[i]);
        if !(fits(0) && fits(1)) {
            let ([w, h], [low, flat], [wide, high]) = (size, Self::MIN, Self::MAX);
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
