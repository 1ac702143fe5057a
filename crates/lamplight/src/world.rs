//! Worlds larger than a grid: lit tile by tile, without seams.
//!
//! A tile that is lit alone misses all that lies around it, and light in the plane fades only as 1/distance: with a
//! margin as wide as itself a tile of an open world is still a fifth too dark. So the world is read once, in parts,
//! into its far field, which is small enough to be held whole. Then every tile is solved with a
//! narrow margin of its own cells and with the light that enters there from everywhere else ([`Inflow`]).
//!
//! Bounces go around all parts one after the other: each part is solved for what its surfaces send on, and from that
//! come the far field of the next bounce and, at last, the light of tiles. So every bounce has the light of the bounce
//! before from everywhere, as in one solve of the whole.
//!
//! Tiles are solved independently of each other: in any order, on any machine, and again after a break, with the same
//! result to the bit. Then the light of each passes into that of its neighbours ([`Tiling`]).

use crate::far_field::{ALIGNMENT, BounceState, FarField, NearCells, PartLight};
pub use crate::far_field::{FarBlocks, FarPart};
use crate::grid::class::CellClass;
use crate::settings::Raymarch;
use crate::stages::bounce::{CONVERGED, KnownSurfaces, SurfaceLight};
use crate::stages::glow::Glow;
use crate::sun_glow::SunGlow;
pub use crate::tiling::{LitTile, MAX_SIDE, Tiling};
use crate::tiling::{check_size, expanded, tiles};
use crate::{
    Bounces, Cells, Direct, Error, GridWindow, Inflow, Lamp, Light, Panorama, Result, Settings,
    Sky, Solver, Sun,
};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::sync::{Mutex, PoisonError};

/// The least distance from a tile up to which rays cross cells, px; beyond it they cross blocks of the far field.
const NEAR: u32 = 64;

/// Side of the parts in which a world is read and its surfaces are lit, px.
const PART: u32 = 2 * ALIGNMENT;

/// The cells of a world, from a file, a generator, or memory.
pub trait WorldSource: Sync {
    /// Columns and rows.
    fn size(&self) -> [u32; 2];

    /// The sky around the world.
    fn sky(&self) -> Sky {
        Sky::BLACK
    }

    /// The suns of the world, which are part of its sky whatever their [`Sun::direct`] is. Those with an elevation or a mask
    /// are refused.
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
        *cells.lamps_mut() = lamps_within(self.lamps(), window);
        Ok(cells)
    }
}

/// A borrowed source.
impl<S: WorldSource + ?Sized> WorldSource for &S {
    fn size(&self) -> [u32; 2] {
        (**self).size()
    }

    fn sky(&self) -> Sky {
        (**self).sky()
    }

    fn suns(&self) -> Vec<Sun> {
        (**self).suns()
    }

    fn cells(&self, window: GridWindow) -> Result<Cells> {
        (**self).cells(window)
    }
}

/// Returns the lamps that reach into a window, with positions relative to it: by their discs, or by their range, as all do in
/// `polar` and `flood`, and lamps that are lit by a shadow map in every method.
pub fn lamps_within(lamps: &[Lamp], window: GridWindow) -> Vec<Lamp> {
    let [first, size] = [window.first, window.size].map(|of| of.map(|v| v as f32));
    let relative = |lamp: &Lamp| [0, 1].map(|a| lamp.position[a] - first[a]);
    let reaches = |lamp: &&Lamp| {
        let reach = lamp.range.max(lamp.size.max(1.0) + 1.0);
        (0..2).all(|a| (-reach..size[a] + reach).contains(&relative(lamp)[a]))
    };
    let within = lamps.iter().filter(reaches);
    within.map(|lamp| Lamp { position: relative(lamp), ..lamp.clone() }).collect()
}

/// The settings of a world.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldSettings {
    /// The settings of every tile. [`Bounces::Feedback`] means all bounces here.
    pub solver: Settings,
    /// The margin of a tile, px, that is solved with it. More is closer to one solve of the whole at the edges of tiles,
    /// and takes time. With less than 64 px, what lies between is crossed cell by cell by the rays that enter. Half of it, up
    /// to 32 px, is the rim in which tiles pass into each other: with a margin below 2 px they have seams.
    pub halo: u32,
    /// Directions of the light that enters a tile, 1 to [`Panorama::MAX_COLUMNS`]. More are sharper shadows of distant lights, and take time and memory.
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
    far: FarWorld,
}

impl<'a> World<'a> {
    /// Reads a world, in parts of 1024×1024 cells, and once more for every bounce. `progress` receives the number of
    /// parts read, and of all that may have to be.
    ///
    /// # Errors
    /// Fails if the source fails, or as [`FarWorld::new`] and [`FarWorld::read`].
    pub fn new(
        source: &'a dyn WorldSource,
        settings: WorldSettings,
        mut progress: impl FnMut(usize, usize),
    ) -> Result<Self> {
        let most = 1 + settings.solver.bounces.limit() as usize;
        let mut far = FarWorld::new(source.size(), &source.sky(), &source.suns(), settings)?;
        let parts = far.parts();
        let mut done = 0;
        let mut next = || {
            progress(done, most * parts.len());
            done += 1;
        };
        let around: Vec<_> = parts.iter().map(|&part| far.with_margin(part, 1, 1)).collect();
        read_ahead(source, &around, |number, cells| {
            next();
            far.add(far.read(parts[number], cells)?)
        })?;
        far.finish();
        while far.goes_on() {
            let mut after = far.after();
            let around: Vec<_> = parts.iter().map(|&part| far.near(part)).collect();
            read_ahead(source, &around, |number, cells| {
                next();
                after.add(far.bounce(parts[number], cells)?)
            })?;
            after.finish();
            far = after;
        }
        progress(most * parts.len(), most * parts.len());
        Ok(Self { source, far })
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.far.size()
    }

    /// Returns the windows of all tiles of this side, px, row by row; those at the right and at the bottom may be smaller.
    ///
    /// # Errors
    /// Fails if the side is 0.
    pub fn tiles(&self, side: u32) -> Result<Vec<GridWindow>> {
        Ok(Tiling::new(self.size(), side, self.far.settings.halo)?.tiles())
    }

    /// Returns the light that enters a window from the world around it, whose first cell lies at a multiple of 4.
    ///
    /// # Errors
    /// Fails if the window does not lie in the world, or as [`Inflow::new`].
    pub fn inflow(&self, window: GridWindow) -> Result<Inflow> {
        self.far.inflow(window)
    }

    /// Returns an [inflow](Self::inflow) of a window with the light of lamps that are not the source's, such as moving ones.
    /// Positions are px of the world. In the window itself they light nothing: there they belong to the cells. They are
    /// shadowed by what the world is made of, and light of theirs that it scatters is not found. Lamps that are lit by a
    /// shadow map, which shine from beyond a grid, are left out.
    ///
    /// # Errors
    /// Fails if the window does not lie in the world, or as [`Inflow::new`].
    pub fn with_lamps(
        &self,
        window: GridWindow,
        inflow: &Inflow,
        lamps: &[Lamp],
    ) -> Result<Inflow> {
        window.check(self.size())?;
        self.far.far_field.with_lamps(window, inflow, lamps)
    }

    /// Returns the light of a window of the world. Windows beside each other differ a little along their border:
    /// [`Self::light_tiles`] has no seams.
    ///
    /// # Errors
    /// Fails if the window does not lie in the world, if the source fails, or as [`Solver::solve`].
    pub fn light(&self, window: GridWindow) -> Result<Light> {
        self.far.light(window, self.source.cells(self.far.around_tile(window)?)?)
    }

    /// Returns the tiles of this side, px, whose light passes from each into the next ([`Tiling`]), to be lit one by one.
    ///
    /// # Errors
    /// Fails if the side is 0.
    pub fn light_tiles(&self, side: u32) -> Result<LitTiles<'_>> {
        let tiling = Tiling::new(self.size(), side, self.far.settings.halo)?;
        let columns = self.size()[0].div_ceil(side) as usize;
        Ok(LitTiles { world: self, tiling, known: BTreeMap::new(), capacity: 2 * columns + 3 })
    }
}

/// The tiles of a world without seams. Two rows of them are in memory: lit row by row, none is solved twice.
pub struct LitTiles<'a> {
    world: &'a World<'a>,
    tiling: Tiling,
    /// The light of tiles with their rims, by row and column of their first cells.
    known: BTreeMap<[u32; 2], Light>,
    /// Two rows of tiles, and those around one.
    capacity: usize,
}

impl LitTiles<'_> {
    /// The windows of all tiles, row by row; those at the right and at the bottom may be smaller.
    pub fn windows(&self) -> Vec<GridWindow> {
        self.tiling.tiles()
    }

    /// Returns the light of a tile, the same in any order.
    ///
    /// # Errors
    /// Fails if the window is none of the tiles, if the source fails, or as [`Solver::solve`].
    pub fn light(&mut self, tile: GridWindow) -> Result<Light> {
        let Self { world, tiling, .. } = *self;
        let place = |tile: GridWindow| [tile.first[1], tile.first[0]];
        let around = tiling.around(tile)?.into_iter();
        let around = around.map(|(one, _)| Ok((one, tiling.with_rim(one)?)));
        let around = around.collect::<Result<Vec<_>>>()?;
        for &(one, rim) in &around {
            if self.known.contains_key(&place(one)) {
                continue;
            }
            if self.known.len() == self.capacity {
                // Row by row, the first is needed no more.
                let needed = |at: &[u32; 2]| around.iter().any(|(one, _)| place(*one) == *at);
                if let Some(first) = self.known.keys().copied().find(|at| !needed(at)) {
                    self.known.remove(&first);
                }
            }
            let cells = world.source.cells(world.far.near(one))?;
            let light = world.far.light_in(rim, one, cells)?;
            self.known.insert(place(one), light);
        }
        let lights = around.iter().filter_map(|&(tile, window)| {
            let light = self.known.get(&place(tile))?;
            Some(LitTile { tile, window, light })
        });
        tiling.mixed(tile, &lights.collect::<Vec<_>>())
    }
}

/// The far field of a world without its cells, for programs that read and light it on several machines.
///
/// Each reads some of the [`parts`](Self::parts). One [adds](Self::add) what they have read, in the order of the parts,
/// and [finishes](Self::finish). As long as it [goes on](Self::goes_on), each finds the next [bounce](Self::bounce) of
/// some parts, and these are added to the one [after](Self::after) it. Then any lights tiles from the cells there and
/// from the [blocks](Self::blocks) that the tile needs. The light is that of [`World::light`], to the bit; for tiles without
/// seams, light each [with its rim](Self::light_in), and [mix](Tiling::mixed) it with those around it.
#[derive(Debug)]
pub struct FarWorld {
    size: [u32; 2],
    settings: WorldSettings,
    sky: Sky,
    far_field: FarField,
    /// Radiance that surfaces send on, part by part.
    surfaces: Vec<PartLight>,
    state: BounceState,
    solvers: IdleSolvers,
}

/// Solvers that have solved a part or a tile. The next one does not allocate its buffers again.
#[derive(Debug, Default)]
struct IdleSolvers(Mutex<Vec<Solver>>);

impl IdleSolvers {
    /// Returns a solver without history.
    fn take(&self, settings: &Settings) -> Result<Solver> {
        let idle = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let Some(mut solver) = idle else { return Solver::new(settings.clone()) };
        solver.reset();
        Ok(solver)
    }

    fn put_back(&self, solver: Solver) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(solver);
    }

    /// Returns all that are idle.
    fn take_all(&self) -> Self {
        let mut idle = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        Self(Mutex::new(std::mem::take(&mut *idle)))
    }
}

impl FarWorld {
    /// Creates that of a world of which nothing has been read.
    ///
    /// # Errors
    /// Fails if the world is empty or too large, a setting, the sky or a sun is invalid, a sun has an elevation or a mask, or
    /// the method does not read inflow, or is `raymarch` with an emission multiplier, a threshold or attenuation.
    pub fn new(size: [u32; 2], sky: &Sky, suns: &[Sun], settings: WorldSettings) -> Result<Self> {
        let (settings, sky) = prepare(size, sky, suns, settings)?;
        let far_field = FarField::new(size, sky.clone());
        let state = BounceState::default();
        let solvers = IdleSolvers::default();
        Ok(Self { size, settings, sky, far_field, surfaces: Vec::new(), state, solvers })
    }

    /// Creates a finished one from its blocks, or one that lights a tile from the blocks for that.
    ///
    /// # Errors
    /// As [`Self::new`], and if they are those of a world of another size.
    pub fn of_blocks(
        size: [u32; 2],
        sky: &Sky,
        suns: &[Sun],
        settings: WorldSettings,
        blocks: FarBlocks,
    ) -> Result<Self> {
        let (settings, sky) = prepare(size, sky, suns, settings)?;
        let FarBlocks { levels, surfaces, state } = blocks;
        for part in &surfaces {
            check_part(part.window(), size)?;
            if !part.is_sound() {
                return Err(Error::value("blocks", "damaged", "those of this world"));
            }
        }
        let far_field = FarField::of_levels(size, sky.clone(), levels)?;
        let solvers = IdleSolvers::default();
        Ok(Self { size, settings, sky, far_field, surfaces, state, solvers })
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The windows of the parts in which it is read, row by row.
    pub fn parts(&self) -> Vec<GridWindow> {
        tiles(self.size, PART)
    }

    /// Returns the window of cells that are read for a part.
    ///
    /// # Errors
    /// Fails if the window is none of the parts.
    pub fn around_part(&self, part: GridWindow) -> Result<GridWindow> {
        check_part(part, self.size)?;
        Ok(self.with_margin(part, 1, 1))
    }

    /// Returns the window of cells that light a tile, or find the next bounce of a part.
    ///
    /// # Errors
    /// Fails if the tile does not lie in the world.
    pub fn around_tile(&self, tile: GridWindow) -> Result<GridWindow> {
        tile.check(self.size)?;
        Ok(self.near(tile))
    }

    /// The window of cells that light a tile in the world.
    fn near(&self, tile: GridWindow) -> GridWindow {
        self.with_margin(tile, self.settings.halo.max(NEAR), 4)
    }

    /// The window of cells in which a tile in the world is solved.
    fn solved(&self, tile: GridWindow) -> GridWindow {
        self.with_margin(tile, self.settings.halo, 4)
    }

    fn with_margin(&self, window: GridWindow, margin: u32, aligned: u32) -> GridWindow {
        expanded(window, margin, self.size, aligned)
    }

    /// Reads a part from the cells [around](Self::around_part) it.
    ///
    /// # Errors
    /// Fails if the window is none of the parts, a cell is invalid, or there are lamps that are lit by a shadow map,
    /// which are not known beyond a tile.
    pub fn read(&self, part: GridWindow, cells: Cells) -> Result<FarPart> {
        let around = self.around_part(part)?;
        check_cells(&cells, around)?;
        cells.check()?;
        refuse_exact_lamps(&cells, around.first)?;
        Ok(self.far_part(part, cells, around, PartLight::none(part)))
    }

    /// Finds one bounce more of a part of a finished one, from the cells [around](Self::around_tile) it.
    ///
    /// # Errors
    /// Fails if the window is none of the parts, the cells are not those around it, or as [`Solver::solve`].
    pub fn bounce(&self, part: GridWindow, cells: Cells) -> Result<FarPart> {
        check_part(part, self.size)?;
        let solved = self.solved(part);
        // Surfaces send on light from a half circle, in which edges of shadows blur: half the directions do.
        let cells = self.lit_from_afar(part, cells, self.settings.columns.div_ceil(2))?;
        let light = self.surface_light(solved);
        let mut solver = self.solvers.take(&self.settings.solver)?;
        solver.solve_known(&cells, Some(KnownSurfaces { light: &light, bounce: true }))?;
        let light = match solver.surfaces() {
            Some(surfaces) => PartLight::of(surfaces, solved, part),
            None => PartLight::none(part),
        };
        self.solvers.put_back(solver);
        Ok(self.far_part(part, cells, solved, light))
    }

    /// Adds what was read of a part, or its next bounce.
    ///
    /// # Errors
    /// Fails, and changes nothing, if it was read of another world, was damaged on its way, or has been added.
    pub fn add(&mut self, part: FarPart) -> Result<()> {
        let window = part.window();
        check_part(window, self.size)?;
        if self.surfaces.iter().any(|added| added.window() == window) {
            return Err(Error::value("part", window, "one that has not been added yet"));
        }
        let (light, [sent, changed]) = self.far_field.insert(part)?;
        self.state.sent += sent;
        self.state.changed += changed;
        self.surfaces.push(light);
        Ok(())
    }

    /// Makes the larger blocks, when all parts have been added.
    pub fn finish(&mut self) {
        self.far_field.merge();
    }

    /// Returns whether a finished one lacks a bounce.
    pub fn goes_on(&self) -> bool {
        let BounceState { bounces, sent, changed } = self.state;
        let wanted = self.settings.solver.bounces;
        let least = if wanted == Bounces::Converged { f64::from(CONVERGED) } else { 0.0 };
        bounces < wanted.limit() && (bounces == 0 || changed > least * sent)
    }

    /// Returns an empty one, for the next bounce of all parts of this.
    pub fn after(&self) -> Self {
        Self {
            size: self.size,
            settings: self.settings.clone(),
            sky: self.sky.clone(),
            far_field: FarField::new(self.size, self.sky.clone()),
            surfaces: Vec::new(),
            state: BounceState { bounces: self.state.bounces + 1, ..BounceState::default() },
            solvers: self.solvers.take_all(),
        }
    }

    /// Returns the blocks of a finished one: all, or those that light a tile.
    ///
    /// # Errors
    /// Fails if the tile does not lie in the world.
    pub fn blocks(&self, tile: Option<GridWindow>) -> Result<FarBlocks> {
        let around = tile.map(|tile| self.around_tile(tile)).transpose()?;
        let solved = tile.map(|tile| self.solved(tile));
        let surfaces = self.surfaces.iter();
        let surfaces = match around {
            Some(around) => surfaces.filter_map(|part| part.within(around)).collect(),
            None => surfaces.cloned().collect(),
        };
        Ok(FarBlocks { levels: self.far_field.levels(solved), surfaces, state: self.state })
    }

    /// Returns the light that enters a window from the world around it, whose first cell lies at a multiple of 4.
    ///
    /// # Errors
    /// Fails if the window does not lie in the world, or as [`Inflow::new`].
    pub fn inflow(&self, window: GridWindow) -> Result<Inflow> {
        window.check(self.size)?;
        self.far_field.inflow(window, self.settings.columns, &|_| false, None)
    }

    /// Returns the light of a tile, from the cells [around](Self::around_tile) it.
    ///
    /// # Errors
    /// Fails if the tile does not lie in the world, the cells are not those around it, or as [`Solver::solve`].
    pub fn light(&self, tile: GridWindow, cells: Cells) -> Result<Light> {
        self.light_in(tile, tile, cells)
    }

    /// Returns the light of a window around a tile, such as [its rim](Tiling::with_rim), that lies in the margin with which the
    /// tile is solved, from the cells [around](Self::around_tile) the tile.
    ///
    /// # Errors
    /// As [`Self::light`], and if the window lies elsewhere.
    pub fn light_in(&self, window: GridWindow, tile: GridWindow, cells: Cells) -> Result<Light> {
        tile.check(self.size)?;
        window.check(self.size)?;
        let solved = self.solved(tile);
        if solved.common(window) != Some(window) {
            return Err(Error::value("window", window, format!("within {solved}")));
        }
        let cells = self.lit_from_afar(tile, cells, self.settings.columns)?;
        let light = self.surface_light(solved);
        let mut solver = self.solvers.take(&self.settings.solver)?;
        let known = KnownSurfaces { light: &light, bounce: false };
        let light = solver.solve_known(&cells, Some(known))?.window(window.within(solved));
        self.solvers.put_back(solver);
        Ok(light)
    }

    /// Reads a part from the cells of a window around it, whose surfaces send this on.
    fn far_part(
        &self,
        part: GridWindow,
        mut cells: Cells,
        around: GridWindow,
        light: PartLight,
    ) -> FarPart {
        self.settings.solver.method.draw_lamps(&mut cells);
        Glow::default().to_media(&mut cells);
        let mut sent = SurfaceLight::default();
        light.add_to(&mut sent, around);
        let before = self.surfaces.iter().find(|before| before.window() == part);
        let change = light.change(before);
        FarPart::read(part, &cells, &sent, around.first, light, change)
    }

    /// Returns the cells in which a tile is solved, of those around it, with all light that enters, in so many directions.
    fn lit_from_afar(&self, tile: GridWindow, mut cells: Cells, columns: usize) -> Result<Cells> {
        let [around, solved] = [self.near(tile), self.solved(tile)];
        check_cells(&cells, around)?;
        let (mut lit, wide) = if around == solved {
            (cells, None)
        } else {
            let lit = WorldSource::cells(&cells, solved.within(around))?;
            self.settings.solver.method.draw_lamps(&mut cells);
            Glow::default().to_media(&mut cells);
            (lit, Some(cells))
        };
        let near = wide.as_ref();
        let near = near.map(|cells| NearCells::new(cells, around, &self.surface_light(around)));
        let is_solid = |cell: [i32; 2]| {
            let [x, y] = [0, 1].map(|a| cell[a] as u32 - solved.first[a]);
            let is_inside = x < lit.width() && y < lit.height();
            is_inside && CellClass::of(&lit, lit.index(x, y), 0.0) == CellClass::Solid
        };
        let inflow = self.far_field.inflow(solved, columns, &is_solid, near.as_ref())?;
        lit.suns_mut().clear();
        lit.set_inflow(Some(inflow))?;
        Ok(lit)
    }

    /// Returns what the surfaces in a window send on.
    fn surface_light(&self, window: GridWindow) -> SurfaceLight {
        let mut light = SurfaceLight::default();
        self.surfaces.iter().for_each(|part| part.add_to(&mut light, window));
        light
    }
}

/// Checks what a world is lit by, and draws its suns into its sky.
fn prepare(
    size: [u32; 2],
    sky: &Sky,
    suns: &[Sun],
    mut settings: WorldSettings,
) -> Result<(WorldSettings, Sky)> {
    check_size(size)?;
    settings.solver.check()?;
    let most = Panorama::MAX_COLUMNS;
    if !(1..=most).contains(&settings.columns) {
        return Err(Error::value("columns", settings.columns, format!("1 to {most}")));
    }
    sky.check()?;
    suns.iter().enumerate().try_for_each(|(i, sun)| sun.check(&format_args!("sun[{i}]")))?;
    if settings.solver.bounces == Bounces::Feedback {
        settings.solver.bounces = Bounces::Converged;
    }
    settings.solver.method.takes_inflow()?;
    settings.solver.method.as_raymarch().map_or(Ok(()), lights_as_the_far_field)?;
    let glowing = suns.iter().enumerate().map(|(i, sun)| glowing(i, sun));
    let glowing = glowing.collect::<Result<Vec<_>>>()?;
    let sky = SunGlow::default().draw(settings.solver.method(), sky, &glowing);
    Ok((settings, sky))
}

/// Rejects settings by which tiles would have other light of what lies in them than of what lies beyond.
fn lights_as_the_far_field(raymarch: &Raymarch) -> Result<()> {
    let Raymarch { emission_multiplier, threshold, attenuation, .. } = *raymarch;
    let refused = |key: &str, value: &dyn Display, expected: &str| {
        let expected = format!("{expected} in a world: what lies beyond a tile is seen without it");
        Err(Error::value(format!("raymarch.{key}"), value, expected))
    };
    if emission_multiplier != 1.0 {
        return refused("emission_multiplier", &emission_multiplier, "1");
    }
    if threshold != 0.0 {
        return refused("threshold", &threshold, "0");
    }
    if attenuation {
        return refused("attenuation", &attenuation, "false");
    }
    Ok(())
}

/// Returns a sun as part of the sky.
fn glowing(number: usize, sun: &Sun) -> Result<Sun> {
    let sun = Sun { direct: Direct::Glow, ..*sun };
    if !sun.is_exact() {
        return Ok(sun);
    }
    // The sky has neither.
    let key = if sun.elevation.is_some() { "elevation" } else { "mask" };
    let expected = "left out: suns of a world are part of its sky";
    Err(Error::value(format!("sun[{number}].{key}"), "given", expected))
}

/// Calls `work` with the number and the cells of each window in turn, and reads those of the next one meanwhile.
fn read_ahead(
    source: &dyn WorldSource,
    windows: &[GridWindow],
    mut work: impl FnMut(usize, Cells) -> Result<()>,
) -> Result<()> {
    let read = |number: usize| windows.get(number).map(|&window| source.cells(window));
    let mut ahead = read(0);
    for number in 0.. {
        let Some(cells) = ahead.take().transpose()? else { break };
        rayon::in_place_scope(|scope| {
            scope.spawn(|_| ahead = read(number + 1));
            work(number, cells)
        })?;
    }
    Ok(())
}

/// Rejects a window that is none of the parts of a world.
fn check_part(part: GridWindow, world: [u32; 2]) -> Result<()> {
    part.check(world)?;
    let whole = [0, 1].map(|a| PART.min(world[a] - part.first[a]));
    if part.first.iter().all(|v| v % PART == 0) && part.size == whole {
        return Ok(());
    }
    let expected = format!("one of the parts, which begin at multiples of {PART} px");
    Err(Error::value("part", part, expected))
}

/// Rejects cells that are not those of a window.
fn check_cells(cells: &Cells, window: GridWindow) -> Result<()> {
    let found = [cells.width(), cells.height()];
    if found == window.size {
        return Ok(());
    }
    let [found, expected] = [found, window.size].map(|[w, h]| format!("{w}×{h} cells"));
    Err(Error::value("cells", found, format!("{expected}, those from {:?} on", window.first)))
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
