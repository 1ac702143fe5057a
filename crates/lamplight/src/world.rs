//! Worlds larger than a grid: lit tile by tile, without seams.
//!
//! A tile that is lit alone misses all that lies around it, and light in the plane fades only as 1/distance: with a
//! margin as wide as itself a tile of an open world is still a fifth too dark. So the world is read once, in parts,
//! into its [far field](crate::far_field), which is small enough to be held whole. Then every tile is solved with a
//! narrow margin of its own cells and with the light that enters there from everywhere else ([`Inflow`]).
//!
//! Tiles do not depend on each other: they may be solved in any order, on any machine, and again after a break, with
//! the same result to the bit.

use crate::far_field::{ALIGNMENT, FarField, MARGIN};
use crate::stages::glow::Glow;
use crate::sun_glow::SunGlow;
use crate::{
    Bounces, Cells, Direct, Error, GridWindow, Inflow, Lamp, Light, Result, Settings, Sky, Solver,
    Sun,
};

/// Side of the parts in which a world is read, px.
const PART: u32 = ALIGNMENT;

/// The longest side of a world, px: a block of 4×4 cells takes 4 bytes, even if it is empty.
pub const MAX_SIDE: u32 = 1 << 16;

/// The cells of a world, from a file, a generator, or memory.
pub trait WorldSource: Sync {
    /// Columns and rows.
    fn size(&self) -> [u32; 2];

    /// The sky around the world.
    fn sky(&self) -> Sky {
        Sky::BLACK
    }

    /// The suns of the world.
    fn suns(&self) -> Vec<Sun> {
        Vec::new()
    }

    /// Reads the matter of a window that lies in the world, and the lamps that reach into it, with positions relative
    /// to the window. The sky and the suns of the cells are not read.
    ///
    /// # Errors
    /// Fails if the source cannot read it.
    fn cells(&self, window: GridWindow) -> Result<Cells>;
}

/// Cells in memory, no larger than a grid.
impl WorldSource for Cells {
    fn size(&self) -> [u32; 2] {
        [self.width(), self.height()]
    }

    fn sky(&self) -> Sky {
        self.sky().clone()
    }

    fn suns(&self) -> Vec<Sun> {
        self.suns().to_vec()
    }

    fn cells(&self, window: GridWindow) -> Result<Cells> {
        let mut cells = self.window(window)?;
        let size = window.size.map(|side| side as f32);
        cells.lamps_mut().retain(|lamp| {
            let reach = lamp.size.max(1.0) + 1.0;
            (0..2).all(|a| (-reach..size[a] + reach).contains(&lamp.position[a]))
        });
        Ok(cells)
    }
}

/// The settings of a world.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldSettings {
    /// The settings of every tile. [`Bounces::Feedback`] means all bounces here.
    pub solver: Settings,
    /// The margin of a tile, px, in which matter is known cell by cell. More is closer to one solve of the whole at the
    /// edges of tiles, and takes time.
    pub halo: u32,
    /// Directions of the light that enters a tile. More are sharper shadows of distant lights, and take time and memory.
    pub columns: usize,
}

impl WorldSettings {
    /// The default margin of a tile, px.
    pub const HALO: u32 = 64;
    /// The default number of directions.
    pub const COLUMNS: usize = 512;

    /// Creates the settings of a world whose tiles are solved with these.
    pub fn new(solver: Settings) -> Self {
        Self { solver, halo: Self::HALO, columns: Self::COLUMNS }
    }
}

/// A world whose far field is known, ready to light its tiles.
pub struct World<'a> {
    source: &'a dyn WorldSource,
    settings: WorldSettings,
    far_field: FarField,
}

impl<'a> World<'a> {
    /// Reads a world, in parts of 512×512 cells, and finds the light that these send each other. `progress` receives the
    /// number of parts read and of all.
    ///
    /// # Errors
    /// Fails if the source fails, if a cell or a setting is invalid, if the method does not read inflow, or if there
    /// are lamps that are lit by a shadow map, which are not known beyond a tile.
    pub fn new(
        source: &'a dyn WorldSource,
        settings: WorldSettings,
        mut progress: impl FnMut(usize, usize),
    ) -> Result<Self> {
        let mut settings = settings;
        check_size(source.size())?;
        if settings.solver.bounces == Bounces::Feedback {
            settings.solver.bounces = Bounces::Converged;
        }
        settings.solver.method.takes_inflow()?;
        let method = settings.solver.method();
        let glowing: Vec<Sun> =
            source.suns().into_iter().map(|sun| Sun { direct: Direct::Glow, ..sun }).collect();
        let sky = SunGlow::default().draw(method, &source.sky(), &glowing);
        let mut far_field = FarField::new(source.size(), sky);
        let parts = tiles(source.size(), PART);
        for (number, &part) in parts.iter().enumerate() {
            progress(number, parts.len());
            let around = expanded(part, MARGIN, source.size(), 1);
            let mut cells = source.cells(around)?;
            cells.check()?;
            refuse_exact_lamps(&cells, around.first)?;
            settings.solver.method.draw_lamps(&mut cells);
            Glow::default().to_media(&mut cells);
            far_field.add(part, &cells, around.first);
        }
        far_field.merge();
        let mut world = Self { source, settings, far_field };
        world.far_field.bounces(world.settings.solver.bounces);
        progress(parts.len(), parts.len());
        Ok(world)
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.source.size()
    }

    /// The windows of all tiles of this side, px, row by row; those at the right and at the bottom may be smaller.
    pub fn tiles(&self, side: u32) -> Vec<GridWindow> {
        tiles(self.size(), side)
    }

    /// Returns the light that enters a window from the world around it, whose first cell lies at a multiple of 4.
    ///
    /// # Errors
    /// As [`Inflow::new`].
    pub fn inflow(&self, window: GridWindow) -> Result<Inflow> {
        self.far_field.inflow(window, self.settings.columns)
    }

    /// Returns an [inflow](Self::inflow) of a window with the light of lamps that are not the source's, such as moving ones.
    /// Positions are px of the world. In the window itself they light nothing: there they belong to the cells. They are
    /// shadowed by what the world is made of, and light of theirs that it scatters is not found. Lamps that are lit by a
    /// shadow map, which shine from beyond a grid, are left out.
    ///
    /// # Errors
    /// As [`Inflow::new`].
    pub fn with_lamps(
        &self,
        window: GridWindow,
        inflow: &Inflow,
        lamps: &[Lamp],
    ) -> Result<Inflow> {
        self.far_field.with_lamps(window, inflow, lamps)
    }

    /// Returns the light of a window of the world.
    ///
    /// # Errors
    /// Fails if the source does, or as [`Solver::solve`].
    pub fn light(&self, window: GridWindow) -> Result<Light> {
        let around = expanded(window, self.settings.halo, self.size(), 4);
        let mut cells = self.source.cells(around)?;
        cells.suns_mut().clear();
        cells.set_inflow(Some(self.inflow(around)?))?;
        let mut solver = Solver::new(self.settings.solver.clone())?;
        let light = solver.solve(&cells)?;
        let first = [0, 1].map(|a| window.first[a] - around.first[a]);
        Ok(light.window(GridWindow { first, ..window }))
    }
}

/// Rejects sizes of zero and sizes beyond [`MAX_SIDE`].
pub(crate) fn check_size([width, height]: [u32; 2]) -> Result<()> {
    if [width, height].iter().all(|side| (1..=MAX_SIDE).contains(side)) {
        return Ok(());
    }
    let found = format!("{width}×{height} cells");
    Err(Error::value("size", found, format!("1 to {MAX_SIDE} a side")))
}

/// Returns the windows of tiles, row by row.
fn tiles(size: [u32; 2], side: u32) -> Vec<GridWindow> {
    let starts = |a: usize| (0..size[a]).step_by(side.max(1) as usize);
    let window =
        |first: [u32; 2]| GridWindow { first, size: [0, 1].map(|a| side.min(size[a] - first[a])) };
    starts(1).flat_map(|y| starts(0).map(move |x| window([x, y]))).collect()
}

/// Returns a window with a margin, as far as the world goes, that begins at a multiple of `aligned`.
pub(crate) fn expanded(
    window: GridWindow,
    margin: u32,
    world: [u32; 2],
    aligned: u32,
) -> GridWindow {
    let GridWindow { first, size } = window;
    let begin = first.map(|v| v.saturating_sub(margin) / aligned * aligned);
    let end = [0, 1].map(|a| {
        let end = u64::from(first[a]) + u64::from(size[a]) + u64::from(margin);
        end.next_multiple_of(aligned.into()).min(world[a].into()) as u32
    });
    GridWindow { first: begin, size: [0, 1].map(|a| end[a] - begin[a]) }
}

fn refuse_exact_lamps(cells: &Cells, first: [u32; 2]) -> Result<()> {
    let Some(lamp) = cells.lamps().iter().find(|lamp| lamp.is_exact()) else { return Ok(()) };
    let [x, y] = [0, 1].map(|a| lamp.position[a] + first[a] as f32);
    Err(Error::value(
        "lamp",
        format!("one at ({x}, {y}) that is lit by a shadow map"),
        "one that glows: with `direct = \"glow\"`, no cone, cookie, height or mask, and an intensity from 0 on",
    ))
}
