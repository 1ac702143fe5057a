//! The world around a moving view.
//!
//! A view that is lit alone misses what lies beyond its border: lamps pop in as they enter it. With a [`World`] around it,
//! read once, and the lamps that move in that world, it needs a margin of a few cells. Where everything may move, the matter
//! around it is drawn anew, coarser the farther away it is ([`RingSurroundings`]).

mod parted;
mod rings;

pub use parted::{LEAST_RADIUS_BEYOND, LampPart, part_lamp};
pub use rings::{RingSurroundings, RingWindow};

use crate::tiling::expanded;
use crate::world::World;
use crate::{Error, GridWindow, Inflow, Lamp, Result};

/// The surroundings of a view in a world that stands still, with lamps that may move.
///
/// Every frame, the view's cells are lit in the [`window`](Self::window) with a margin, with the lamps in it and the
/// [`inflow`](Self::inflow) there, by a [`Solver`](crate::Solver) or on a GPU. Lamps on the border of the window should be
/// [parted](part_lamp): the cells have the parts inside, and the inflow those beyond.
///
/// Cost: while the window is the same, a copy of the inflow, and some lines through each lamp from every border cell.
/// Another window takes as long as the inflow of a tile of [`World`].
///
/// Known failures: large blocks that are matter in part shadow lamps behind them evenly; a view at the edge of the world has
/// no margin there.
pub struct Surroundings<'a> {
    world: &'a World<'a>,
    margin: u32,
    /// The light of the world in the last window.
    known: Option<(GridWindow, Inflow)>,
}

impl<'a> Surroundings<'a> {
    /// The default margin, px.
    pub const MARGIN: u32 = 32;

    /// Creates the surroundings of a view in a world, with a margin around the view, px. More is closer to the light of
    /// the whole at the edges of the view.
    pub fn new(world: &'a World<'a>, margin: u32) -> Self {
        Self { world, margin, known: None }
    }

    /// Returns the window to be lit for a view of the world: with the margin, as far as the world goes, from a multiple of
    /// four cells on.
    ///
    /// # Errors
    /// Fails if the view does not lie in the world.
    pub fn window(&self, view: GridWindow) -> Result<GridWindow> {
        view.check(self.world.size())?;
        Ok(expanded(view, self.margin, self.world.size(), 4))
    }

    /// Returns the light that enters a [`window`](Self::window), with that of the lamps that move in the world
    /// ([`World::with_lamps`]).
    ///
    /// # Errors
    /// Fails if the window does not lie in the world, or begins elsewhere than at a multiple of four cells, or as
    /// [`Inflow::new`].
    pub fn inflow(&mut self, window: GridWindow, lamps: &[Lamp]) -> Result<Inflow> {
        window.check(self.world.size())?;
        if window.first.iter().any(|v| v % 4 != 0) {
            let found = format!("one from {:?} on", window.first);
            return Err(Error::value("window", found, "one that begins at multiples of 4"));
        }
        let still = match self.known.take() {
            Some((known, inflow)) if known == window => inflow,
            _ => self.world.inflow(window)?,
        };
        let (_, still) = self.known.insert((window, still));
        if lamps.is_empty() {
            return Ok(still.clone());
        }
        self.world.with_lamps(window, still, lamps)
    }
}
