//! Rays that look at the grid from time to time, as the source does: not a traversal.
//!
//! With `traversal = "step"` and `traversal = "distance"` a ray reads the cell under each of its samples, a px
//! or a clear distance apart. It passes corners of cells unseen and ends up to a px too late.

use crate::grid::cast::RayHit;
use crate::grid::class::CellClass;
use crate::grid::medium_grid::MediumGrid;
use crate::grid::traverse::enter;
use crate::stages::distance::MARGIN;

/// Returns how far a sample is from the next one by the distance field: px that are clear in every
/// direction, at least 1.
pub fn clear_px(distance: f32) -> f32 {
    (distance - MARGIN).max(1.0)
}

/// Follows a ray by samples, the first at its start, each `advance(cell)` px from the one before.
/// `visit` receives each open sample: from where to where, and the index of the cell.
pub fn sample(
    grid: &MediumGrid,
    from: [f32; 2],
    direction: [f32; 2],
    reach: f32,
    advance: impl Fn(usize) -> f32,
    mut visit: impl FnMut([f32; 2], usize),
) -> RayHit {
    let Some((_, [start, leave])) = enter(grid.size, from, direction) else {
        return RayHit::NONE;
    };
    let (mut at, reach) = (start.ceil(), reach.min(leave));
    while at < reach {
        let cell = std::array::from_fn(|a| {
            ((from[a] + direction[a] * at).floor() as i32).clamp(0, grid.size[a] - 1)
        });
        let index = grid.index(cell);
        if grid.classes[index] == CellClass::Solid {
            return RayHit { length: at, cell: index as u32 };
        }
        let next = at + advance(index);
        visit([at, next.min(reach)], index);
        at = next;
    }
    RayHit::NONE
}
