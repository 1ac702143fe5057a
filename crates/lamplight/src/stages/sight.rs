//! Visibility from viewers: how much of each cell, or of a point, they see.
//!
//! A place sees as much of an eye as the eye sees of the place. So an eye is a lamp, and what it sees is what that lamp
//! would light: by a shadow map and exact penumbrae for a whole field, and by a single fan of rays for a point
//! ([`polar`](crate::methods::polar)). [`Sight`] has the formula.
//!
//! - A solid cell is as visible as the best seen of its exposed faces, each by its middle, so the walls of a room that is
//!   seen are seen. The solid cell in the inner corner of a room, which has no face, counts by that corner. Deeper in
//!   a wall nothing is seen.
//! - Of several viewers each cell has the visibility to the one who sees it best: a party sees the union.
//! - Lamps hide nothing, not even solid ones; [`Cells::drawn`] makes these matter.
//! - Between two places in the open, where neither is in a penumbra of the other, visibility is mutual but for cones and
//!   ranges: never does one see the other whole and is not seen at all.
//!
//! Cost: a field takes `2πR` rays and `πR²` lookups per viewer of range R, a query the columns of cells between the point
//! and the eye. Limit: in the field, gaps narrower than the rays lie apart (1 px at the range) may be closed.

use super::faces::NORMALS;
use crate::grid::class::CellClass;
use crate::grid::medium_grid::{MediumGrid, Reading};
use crate::methods::polar::penumbra::{
    LampDisc, through_media_to_lamp, through_media_to_wall, visible,
};
use crate::methods::polar::shadow_map::{OUTSIDE_OF_WALL, ShadowMap, ShadowScene};
use crate::methods::polar::solid_bits::SolidBits;
use crate::settings::Polar;
use crate::srgb::luminance;
use crate::{Cells, Result, Rgb, Sight, check};
use fearless_simd::Level;
use rayon::prelude::*;

/// The directions from a cell to those that it touches by a corner only.
const DIAGONALS: [[i32; 2]; 4] = [[-1, -1], [1, -1], [-1, 1], [1, 1]];

/// A solver for visibility, with the scene that it was last given and its buffers.
///
/// ```
/// use lamplight::{Cells, Cone, Matter, Sight, SightSolver};
///
/// # fn main() -> lamplight::Result<()> {
/// let mut cells = Cells::new(64, 48)?;
/// for y in 10..48 {
///     cells.set(32, y, Matter { opacity: 1.0, ..Matter::EMPTY });
/// }
/// let mut sight = SightSolver::default();
/// sight.read(&cells)?;
/// let cone = Cone { direction: 0.0, angle: 2.0, softness: 0.2, profile: None };
/// let guard = Sight { position: [10.5, 30.5], cone: Some(cone), ..Sight::default() };
/// assert_eq!(sight.visibility(&guard, [25.0, 30.5])?, 1.0);
/// assert_eq!(sight.visibility(&guard, [50.0, 30.5])?, 0.0, "behind the wall");
/// let seen = sight.field(&[guard])?;
/// assert_eq!(seen[30 * 64 + 25], 1.0);
/// # Ok(())
/// # }
/// ```
///
/// A field of the same size and with no larger ranges than before allocates nothing.
#[derive(Debug, Default)]
pub struct SightSolver {
    scenery: Scenery,
    shadow_map: ShadowMap,
    seen: Vec<f32>,
}

impl SightSolver {
    /// Reads the walls and media of cells, which all calls see until the next one of this. Before the first, nothing is
    /// seen.
    ///
    /// # Errors
    /// Fails if a cell is invalid ([`Cells::check`]). The scene before then stays.
    pub fn read(&mut self, cells: &Cells) -> Result<()> {
        cells.check()?;
        self.scenery.grid.read(cells, Reading::default());
        self.scenery.solid.read(&self.scenery.grid);
        Ok(())
    }

    /// Returns the visibility of every cell, by its centre, in row order, 0 to 1: the largest of all viewers.
    ///
    /// # Errors
    /// Fails if a viewer is invalid.
    pub fn field(&mut self, sights: &[Sight]) -> Result<&[f32]> {
        for (i, sight) in sights.iter().enumerate() {
            sight.check(&format_args!("sight[{i}]"))?;
        }
        let Self { scenery, shadow_map, seen } = self;
        seen.clear();
        seen.resize(scenery.grid.classes.len(), 0.0);
        let settings = Polar::default();
        let sights = if seen.is_empty() { &[] } else { sights };
        for sight in sights.iter().filter(|sight| !scenery.is_blind(sight)) {
            shadow_map.trace(Level::new(), &sight.lamp(), scenery.shadows(), &[], &settings);
            scenery.add(sight, shadow_map, seen);
        }
        Ok(seen)
    }

    /// Returns the visibility of a point, 0 to 1; beyond the grid nothing is seen. In a solid cell every point has the
    /// visibility of the cell.
    ///
    /// # Errors
    /// Fails if the viewer is invalid, or the point no point ([`f32::NAN`], or more than a million px away).
    pub fn visibility(&self, sight: &Sight, point: [f32; 2]) -> Result<f32> {
        sight.check(&"sight")?;
        check::point("point", point)?;
        let Self { scenery, .. } = self;
        if !scenery.grid.contains(point) || scenery.is_blind(sight) {
            return Ok(0.0);
        }
        let eye = LampDisc { center: sight.position, radius: sight.size, clear: 0.0 };
        let cell = point.map(|v| v as i32);
        Ok(if scenery.grid.class(cell) == CellClass::Solid {
            scenery.of_wall(sight, &eye, cell)
        } else {
            scenery.at(sight, &eye, Place::new(sight, point, false))
        })
    }
}

/// A place in the open.
#[derive(Clone, Copy)]
struct Place {
    /// Its offset from the eye.
    off: [f32; 2],
    /// True if it is on a wall.
    is_on_wall: bool,
}

impl Place {
    fn new(sight: &Sight, [x, y]: [f32; 2], is_on_wall: bool) -> Self {
        Self { off: [x - sight.position[0], y - sight.position[1]], is_on_wall }
    }
}

/// An eye, as places see it.
trait Eye {
    /// Returns the fraction of it that walls do not hide.
    fn seen(&self, scene: ShadowScene, place: Place) -> f32;

    /// Returns the mean transmittance of media before the part that is seen.
    fn through(&self, scene: ShadowScene, place: Place) -> Rgb;
}

/// By the shadow map of the eye, for many places.
impl Eye for ShadowMap {
    fn seen(&self, scene: ShadowScene, Place { off, is_on_wall }: Place) -> f32 {
        let at = self.at(off);
        // The rays of the map end at walls, some before the face in question.
        if is_on_wall {
            self.partly_seen(scene, off, at).fraction
        } else {
            self.seen(scene, off, at)
        }
    }

    fn through(&self, scene: ShadowScene, place: Place) -> Rgb {
        let filter = Polar::default().shadow_filter;
        self.transmittance(scene, place.off, self.at(place.off), filter)
    }
}

/// From one place.
impl Eye for LampDisc {
    fn seen(&self, scene: ShadowScene, place: Place) -> f32 {
        scene.solid.map_or(0.0, |solid| visible(solid, scene.grid, *self, place.off).fraction)
    }

    fn through(&self, scene: ShadowScene, place: Place) -> Rgb {
        if place.off == [0.0; 2] {
            return [1.0; 3];
        }
        let found = scene
            .solid
            .and_then(|solid| through_media_to_lamp(solid, scene.grid, *self, place.off));
        found.unwrap_or_else(|| through_media_to_wall(scene.grid, &self.fan(place.off)))
    }
}

/// The walls and media of a scene.
#[derive(Debug, Default)]
struct Scenery {
    grid: MediumGrid,
    solid: SolidBits,
}

impl Scenery {
    fn shadows(&self) -> ShadowScene<'_> {
        ShadowScene { grid: &self.grid, solid: Some(&self.solid), masks: None }
    }

    /// Returns whether an eye is inside a wall.
    fn is_blind(&self, sight: &Sight) -> bool {
        self.grid.class(sight.position.map(|v| v.floor() as i32)) == CellClass::Solid
    }

    /// Adds what a viewer sees to what others see.
    fn add(&self, sight: &Sight, shadow_map: &ShadowMap, seen: &mut [f32]) {
        let width = self.grid.size[0] as usize;
        let ([x, y], reach) = (sight.position, shadow_map.reach + 1.0);
        seen.par_chunks_mut(width).enumerate().for_each(|(row, seen)| {
            let dy = row as f32 + 0.5 - y;
            // One px more on all sides, for faces and for rounding.
            let half = (reach * reach - dy * dy).max(0.0).sqrt() + 1.0;
            if dy.abs() > reach {
                return;
            }
            let from = ((x - half).max(0.0) as usize).min(width);
            let to = ((x + half).max(0.0) as usize).min(width);
            for (column, seen) in (from..to).zip(&mut seen[from..to]) {
                let cell = [column as i32, row as i32];
                let visibility = if self.grid.class(cell) == CellClass::Solid {
                    self.of_wall(sight, shadow_map, cell)
                } else {
                    let center = cell.map(|v| v as f32 + 0.5);
                    self.at(sight, shadow_map, Place::new(sight, center, false))
                };
                *seen = seen.max(visibility);
            }
        });
    }

    /// Returns the visibility of a place in the open.
    fn at(&self, sight: &Sight, eye: &impl Eye, place: Place) -> f32 {
        let share = sight.share(place.off);
        if share == 0.0 {
            return 0.0;
        }
        // Rounding may find more than all of an eye that reaches over the border.
        let seen = share * eye.seen(self.shadows(), place).min(1.0);
        if seen == 0.0 || !self.grid.has_media() {
            return seen;
        }
        seen * luminance(eye.through(self.shadows(), place))
    }

    /// Returns the visibility of a solid cell: of the best seen of its faces, or of its corners if it has no face.
    fn of_wall(&self, sight: &Sight, eye: &impl Eye, cell: [i32; 2]) -> f32 {
        let is_open = |&[x, y]: &[i32; 2]| self.grid.class([cell[0] + x, cell[1] + y]).is_open();
        let has_face = NORMALS.iter().any(is_open);
        let ways = if has_face { NORMALS } else { DIAGONALS };
        let visibility = |way: [i32; 2]| {
            let way = way.map(|v| v as f32);
            let point = [0, 1].map(|a| cell[a] as f32 + 0.5 + (0.5 + OUTSIDE_OF_WALL) * way[a]);
            let place = Place::new(sight, point, true);
            // No part of an eye behind a face is seen from there.
            let behind = place.off[0] * way[0] + place.off[1] * way[1];
            if behind < sight.size * way[0].hypot(way[1]) {
                self.at(sight, eye, place)
            } else {
                0.0
            }
        };
        ways.into_iter().filter(is_open).map(visibility).fold(0.0, f32::max)
    }
}
