//! Worlds larger than a grid: lit tile by tile, without seams.
//!
//! A tile that is lit alone misses all that lies around it, and light in the plane fades only as 1/distance: with a
//! margin as wide as itself a tile of an open world is still a fifth too dark. So the world is read once, in parts,
//! into its [far field](crate::far_field), which is small enough to be held whole. Then every tile is solved with a
//! narrow margin of its own cells and with the light that enters there from everywhere else ([`Inflow`]).
//!
//! Bounces go around all parts one after the other: each part is solved for what its surfaces send on, and from that
//! come the far field of the next bounce and, at last, the light of tiles. So every bounce has the light of the bounce
//! before from everywhere, as in one solve of the whole.
//!
//! Tiles do not depend on each other: they may be solved in any order, on any machine, and again after a break, with
//! the same result to the bit.

use crate::far_field::{ALIGNMENT, FarField, PartLight};
use crate::stages::bounce::{CONVERGED, KnownSurfaces, SurfaceLight};
use crate::stages::glow::Glow;
use crate::sun_glow::SunGlow;
use crate::{
    Bounces, Cells, Direct, Error, GridWindow, Inflow, Light, Result, Settings, Sky, Solver, Sun,
};

/// Side of the parts in which a world is read and its surfaces are lit, px.
const PART: u32 = 2 * ALIGNMENT;

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

/// A world whose far field is known, and what its surfaces send on: ready to light its tiles.
pub struct World<'a> {
    source: &'a dyn WorldSource,
    settings: WorldSettings,
    sky: Sky,
    far_field: FarField,
    /// Radiance that surfaces send on, part by part; nothing without bounces.
    surfaces: Vec<PartLight>,
}

impl<'a> World<'a> {
    /// Reads a world, in parts of 1024×1024 cells, and once more for every bounce. `progress` receives the number of
    /// parts read, and of all that may have to be.
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
        let bounces = &mut settings.solver.bounces;
        if *bounces == Bounces::Feedback {
            *bounces = Bounces::Converged;
        }
        let bounces = *bounces;
        settings.solver.method.takes_inflow()?;
        let method = settings.solver.method();
        let glowing: Vec<Sun> =
            source.suns().into_iter().map(|sun| Sun { direct: Direct::Glow, ..sun }).collect();
        let sky = SunGlow::default().draw(method, &source.sky(), &glowing);
        let far_field = FarField::new(source.size(), sky.clone());
        let mut world = Self { source, settings, sky, far_field, surfaces: Vec::new() };
        let parts = tiles(world.size(), PART);
        let most = parts.len() * (1 + bounces.limit() as usize);
        let mut done = 0;
        let mut next = || {
            progress(done, most);
            done += 1;
        };
        world.read(&parts, &mut next)?;
        for _ in 0..bounces.limit() {
            let change = world.bounce(&parts, &mut next)?;
            if change == 0.0 || bounces == Bounces::Converged && change < CONVERGED {
                break;
            }
        }
        progress(most, most);
        Ok(world)
    }

    /// Reads all parts into the far field.
    fn read(&mut self, parts: &[GridWindow], mut next: impl FnMut()) -> Result<()> {
        let mut far_field = FarField::new(self.size(), self.sky.clone());
        for &part in parts {
            next();
            let around = expanded(part, 1, self.size(), 1);
            let cells = self.source.cells(around)?;
            cells.check()?;
            refuse_exact_lamps(&cells, around.first)?;
            add(&mut far_field, &self.settings, (part, around), cells, &SurfaceLight::default());
        }
        far_field.merge();
        self.far_field = far_field;
        Ok(())
    }

    /// Finds what surfaces send on one bounce later, and the far field with it. Returns the change, relative to all that
    /// they send.
    fn bounce(&mut self, parts: &[GridWindow], mut next: impl FnMut()) -> Result<f32> {
        let mut found = Vec::with_capacity(parts.len());
        let mut far_field = FarField::new(self.size(), self.sky.clone());
        let mut solver = Solver::new(self.settings.solver.clone())?;
        let (mut sum, mut change) = (0.0, 0.0);
        for (number, &part) in parts.iter().enumerate() {
            next();
            let (cells, around) = self.surroundings(part)?;
            let light = self.surface_light(around);
            solver.solve_known(&cells, Some(KnownSurfaces { light: &light, bounce: true }))?;
            let Some(surfaces) = solver.surfaces() else { continue };
            let of_part = PartLight::of(surfaces, around.size[0], around.first, part);
            let [sent, changed] = of_part.change(self.surfaces.get(number));
            sum += sent;
            change += changed;
            let mut light = SurfaceLight::default();
            of_part.add_to(&mut light, around);
            add(&mut far_field, &self.settings, (part, around), cells, &light);
            found.push(of_part);
        }
        far_field.merge();
        (self.surfaces, self.far_field) = (found, far_field);
        Ok(if sum == 0.0 { 0.0 } else { (change / sum) as f32 })
    }

    /// Returns the cells of a window with its halo, with all light that enters, and the window that they fill.
    fn surroundings(&self, window: GridWindow) -> Result<(Cells, GridWindow)> {
        let around = expanded(window, self.settings.halo, self.size(), 4);
        let mut cells = self.source.cells(around)?;
        cells.suns_mut().clear();
        cells.set_inflow(Some(self.inflow(around)?))?;
        Ok((cells, around))
    }

    /// Returns what the surfaces in a window send on.
    fn surface_light(&self, window: GridWindow) -> SurfaceLight {
        let mut light = SurfaceLight::default();
        self.surfaces.iter().for_each(|part| part.add_to(&mut light, window));
        light
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

    /// Returns the light of a window of the world.
    ///
    /// # Errors
    /// Fails if the source does, or as [`Solver::solve`].
    pub fn light(&self, window: GridWindow) -> Result<Light> {
        let (cells, around) = self.surroundings(window)?;
        let light = self.surface_light(around);
        let mut solver = Solver::new(self.settings.solver.clone())?;
        let light =
            solver.solve_known(&cells, Some(KnownSurfaces { light: &light, bounce: false }))?;
        let first = [0, 1].map(|a| window.first[a] - around.first[a]);
        Ok(light.window(GridWindow { first, ..window }))
    }
}

/// Adds a part, of a window around it, to the far field.
fn add(
    far_field: &mut FarField,
    settings: &WorldSettings,
    (part, around): (GridWindow, GridWindow),
    mut cells: Cells,
    light: &SurfaceLight,
) {
    settings.solver.method.draw_lamps(&mut cells);
    Glow::default().to_media(&mut cells);
    far_field.add(part, &cells, light, around.first);
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
fn expanded(window: GridWindow, margin: u32, world: [u32; 2], aligned: u32) -> GridWindow {
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
