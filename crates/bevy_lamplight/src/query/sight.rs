//! The walls and media that queries of sight look through, and the system parameter that asks.

use crate::components::Viewer2d;
use crate::placement::Placement;
use bevy::ecs::system::SystemParam;
use bevy::math::Vec2;
use bevy::prelude::{GlobalTransform, Res, Resource};
use lamplight::{Cells, SightSolver};
use std::sync::atomic::{AtomicBool, Ordering};

/// Queries what viewers see ([`Viewer2d`]).
///
/// A query takes microseconds. Walls and media are read at the end of each frame with a query of sight, so they are
/// one frame old, and the first query returns `None`. Their cells are half as wide as those of
/// [`LightQuerySettings`](crate::LightQuerySettings), which has the area and layers, too.
///
/// ```
/// # use bevy::prelude::*; use bevy_lamplight::prelude::*;
/// # #[derive(Component)] struct Thief;
/// fn is_seen(
///     sight: SightQuery,
///     guards: Query<(&Viewer2d, &GlobalTransform)>,
///     thief: Single<&GlobalTransform, With<Thief>>,
/// ) {
///     let place = thief.translation().truncate();
///     for (eyes, at) in &guards {
///         if sight.visibility(eyes, at, place).is_some_and(|seen| seen > 0.5) {
///             println!("halt!");
///         }
///     }
/// }
/// ```
#[derive(SystemParam)]
pub struct SightQuery<'w> {
    #[system_param(
        validation_message = "`SightQuery` needs `LamplightPlugin`, or `LightQueryPlugin` alone"
    )]
    sight: Res<'w, QueriedSight>,
}

impl SightQuery<'_> {
    /// The fraction of a place that a viewer sees, 0 to 1: what walls leave of its eye, through fog and glass, within
    /// its field of view and range ([`lamplight::Sight`]). A place in a wall is seen as well as the wall there. `None`
    /// outside of the known area.
    pub fn visibility(
        &self,
        viewer: &Viewer2d,
        transform: &GlobalTransform,
        place: Vec2,
    ) -> Option<f32> {
        self.sight.is_requested.store(true, Ordering::Relaxed);
        let grid = self.sight.grid.filter(|grid| grid.area().contains(place))?;
        let (corner, cell) = (grid.corner(), grid.cell);
        let at = (place - corner) / cell;
        let Some(sight) = viewer.sight(transform, corner, cell) else { return Some(0.0) };
        self.sight.solver.visibility(&sight, [at.x, -at.y]).ok()
    }
}

/// The scene that was read last.
#[derive(Resource, Default)]
pub struct QueriedSight {
    /// True if it was queried since then.
    is_requested: AtomicBool,
    grid: Option<Placement>,
    solver: SightSolver,
}

impl QueriedSight {
    /// Returns whether it was queried since the last time.
    pub fn take_request(&mut self) -> bool {
        std::mem::take(self.is_requested.get_mut())
    }

    /// Reads a scene.
    pub fn read(&mut self, grid: &Placement, cells: &Cells) -> lamplight::Result<()> {
        self.solver.read(cells)?;
        self.grid = Some(*grid);
        Ok(())
    }

    /// Forgets the scene.
    pub fn forget(&mut self) {
        self.grid = None;
    }
}
