//! The tiles of a world, and light that passes from one into the next.
//!
//! Tiles are solved one by one, and what lies beyond their margins is known by the far field only: so the light of two
//! neighbours differs a little at their border, by 2 % in an open world, and the eye finds any straight line. So a tile is
//! also lit in a *rim* around it, and across a border the light of one tile passes into that of the other:
//!
//! ```text
//! L = Σₖ wₖ Lₖ ,   wₖ = ramp(x)·ramp(y) ,   ramp = (½ + d/(2r)), limited to 0 … 1
//! ```
//!
//! d: the distance within tile k from the border, px (negative beyond it); r: the width of the rim. Along an axis the ramps
//! of two neighbours add up to 1, and at a corner four tiles are mixed. Where a tile ends with the world there is no ramp.

use crate::{Error, GridWindow, Light, Result};
use std::ops::Range;

/// The longest side of a world, px: a block of 4×4 cells takes five bytes, even if it is empty.
pub const MAX_SIDE: u32 = 1 << 16;

/// The widest rim, px.
const RIM: u32 = 32;

/// The tiles of a world, which pass into each other.
///
/// Light each one [with its rim](Self::with_rim) by [`FarWorld::light_in`](crate::world::FarWorld::light_in), then
/// [mix](Self::mixed) it with those [around it](Self::around). [`World::light_tiles`](crate::world::World::light_tiles) does
/// so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tiling {
    size: [u32; 2],
    side: u32,
    rim: u32,
}

/// A tile, and its light in a window: with its rim, or in a part of that.
#[derive(Clone, Copy, Debug)]
pub struct LitTile<'a> {
    /// The tile.
    pub tile: GridWindow,
    /// The window in which its light is known.
    pub window: GridWindow,
    /// The light of the window.
    pub light: &'a Light,
}

impl Tiling {
    /// Divides a world into tiles of `side` px, of which each is solved with a margin of `halo` px. The rim is half of the
    /// margin, and no more than 32 px or half of a tile.
    ///
    /// # Errors
    /// Fails if the world is empty or too large, or the side is 0.
    pub fn new(size: [u32; 2], side: u32, halo: u32) -> Result<Self> {
        check_size(size)?;
        if side == 0 {
            return Err(Error::value("side", side, "1 or more px"));
        }
        Ok(Self { size, side, rim: RIM.min(halo / 2).min(side / 2) })
    }

    /// The windows of all tiles, row by row; those at the right and at the bottom may be smaller.
    pub fn tiles(&self) -> Vec<GridWindow> {
        tiles(self.size, self.side)
    }

    /// The width of the rim, px.
    pub fn rim(&self) -> u32 {
        self.rim
    }

    /// Returns a tile with its rim.
    ///
    /// # Errors
    /// Fails if the window is none of the tiles.
    pub fn with_rim(&self, tile: GridWindow) -> Result<GridWindow> {
        self.check(tile)?;
        Ok(self.rimmed(tile))
    }

    /// Returns the tiles that light a tile, itself among them, row by row, each with the part of the tile that it lights.
    ///
    /// # Errors
    /// Fails if the window is none of the tiles.
    pub fn around(&self, tile: GridWindow) -> Result<Vec<(GridWindow, GridWindow)>> {
        self.check(tile)?;
        let GridWindow { first, size } = self.rimmed(tile);
        let [columns, rows] =
            [0, 1].map(|a| first[a] / self.side..=(first[a] + size[a] - 1) / self.side);
        let at = |column, row| self.tile([column, row]);
        let tiles = rows.flat_map(|row| columns.clone().map(move |column| at(column, row)));
        Ok(tiles.filter_map(|one| Some((one, self.rimmed(one).common(tile)?))).collect())
    }

    fn rimmed(&self, tile: GridWindow) -> GridWindow {
        expanded(tile, self.rim, self.size, 1)
    }

    /// Rejects a window that is none of the tiles.
    fn check(&self, window: GridWindow) -> Result<()> {
        window.check(self.size)?;
        if window == self.tile(window.first.map(|v| v / self.side)) {
            return Ok(());
        }
        let expected = format!("one of the tiles, which begin at multiples of {} px", self.side);
        Err(Error::value("tile", window, expected))
    }

    /// The tile in a column and a row.
    fn tile(&self, at: [u32; 2]) -> GridWindow {
        let first = at.map(|v| v * self.side);
        GridWindow { first, size: [0, 1].map(|a| self.side.min(self.size[a] - first[a])) }
    }

    /// Returns the light of a tile, from that of all tiles [around](Self::around) it, in the parts that they light. The first
    /// moment is mixed if all of them have one.
    ///
    /// # Errors
    /// Fails if the window is none of the tiles, or one around it is missing, or not known in its part.
    pub fn mixed(&self, tile: GridWindow, lights: &[LitTile]) -> Result<Light> {
        let part_of = |(one, part): (GridWindow, GridWindow)| {
            let known = lights.iter().find(|light| light.tile == one);
            let missing = || Error::value("tile", one, "one of those that are lit");
            Ok((one, part, known.ok_or_else(missing)?.part(part)?))
        };
        let around = self.around(tile)?.into_iter();
        let around = around.map(part_of).collect::<Result<Vec<_>>>()?;
        let (.., mut mixed) = part_of((tile, tile))?;
        mixed.rgb.fill([0.0; 3]);
        let has_moments = around.iter().all(|(.., part)| part.moment.is_some());
        if let Some(moment) = mixed.moment.as_mut().filter(|_| has_moments) {
            moment.fill([[0.0; 3]; 2]);
        }
        for (one, common, part) in around {
            let weights = [0, 1].map(|axis| self.weights(one, common, axis));
            let rows = common.within(tile).rows(tile.size[0]);
            add_rows(part.rgb.as_flattened(), &rows, &weights, mixed.rgb.as_flattened_mut());
            let moments = part.moment.as_ref().zip(mixed.moment.as_mut());
            if let Some((moment, to)) = moments.filter(|_| has_moments) {
                let (moment, to) = (moment.as_flattened(), to.as_flattened_mut());
                add_rows(moment.as_flattened(), &rows, &weights, to.as_flattened_mut());
            }
        }
        Ok(mixed)
    }

    /// The weight of a tile in the columns (axis 0) or rows of a window.
    fn weights(&self, tile: GridWindow, window: GridWindow, axis: usize) -> Vec<f32> {
        let [begin, end] = [tile.first[axis], tile.first[axis] + tile.size[axis]];
        let ramp = |distance: i64| {
            // In halves of a px, exactly.
            let width = 4 * i64::from(self.rim);
            (2 * distance + 1 + width / 2).clamp(0, width) as f32 / width as f32
        };
        let weight = |at: u32| {
            let [past, left] =
                [i64::from(at) - i64::from(begin), i64::from(end) - 1 - i64::from(at)];
            match (begin > 0, end < self.size[axis]) {
                _ if self.rim == 0 => 1.0,
                (true, true) => ramp(past).min(ramp(left)),
                (true, false) => ramp(past),
                (false, true) => ramp(left),
                (false, false) => 1.0,
            }
        };
        (window.first[axis]..window.first[axis] + window.size[axis]).map(weight).collect()
    }
}

impl LitTile<'_> {
    /// Returns the light of a part of the window.
    fn part(&self, part: GridWindow) -> Result<Light> {
        let Self { window, light, .. } = *self;
        let is_known = window.common(part) == Some(part);
        if !is_known || [light.width(), light.height()] != window.size {
            let found = format!("{}×{} px of {window}", light.width(), light.height());
            return Err(Error::value("light", found, format!("that of {part}")));
        }
        Ok(light.window(part.within(window)))
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

/// Returns the windows of tiles of a side of 1 px or more, row by row.
pub(crate) fn tiles(size: [u32; 2], side: u32) -> Vec<GridWindow> {
    let starts = |a: usize| (0..size[a]).step_by(side as usize);
    let window =
        |first: [u32; 2]| GridWindow { first, size: [0, 1].map(|a| side.min(size[a] - first[a])) };
    starts(1).flat_map(|y| starts(0).map(move |x| window([x, y]))).collect()
}

/// Returns a window in a world with a margin, as far as the world goes, that begins at a multiple of `aligned`.
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

/// Adds rows of values, each times the weights of its column and its row.
fn add_rows(from: &[f32], rows: &[Range<usize>], [columns, lines]: &[Vec<f32>; 2], to: &mut [f32]) {
    let channels = from.len() / (columns.len() * lines.len());
    let from = from.chunks_exact(channels * columns.len());
    for ((row, line), from) in rows.iter().zip(lines).zip(from) {
        let to = &mut to[row.start * channels..row.end * channels];
        let pixels = to.chunks_exact_mut(channels).zip(from.chunks_exact(channels));
        for ((to, from), column) in pixels.zip(columns) {
            to.iter_mut().zip(from).for_each(|(to, from)| *to += column * line * from);
        }
    }
}
