//! Walls less than two px thick, drawn by coverage so that they stay shut.
//!
//! Coverage of a thick wall leaves cells inside it that are covered whole, so nothing passes. A wall 1 px thick that
//! lies between two columns covers half of either, and `½·½` of the light would pass. So the opacity of a cell is its
//! coverage divided by the largest of those across the wall. The cell in the middle is then solid wherever the wall
//! lies, and the opacity of its neighbours changes smoothly as the wall moves. At the ends of the wall, where the
//! coverage across it adds up to less than its thickness, the opacity falls in that proportion.

use super::coverage::{self, Point, ROUNDING, Window};

/// From this thickness on, px, a wall covers a cell whole wherever it lies.
const THICK: f64 = 2.0;
/// The number of cells to either side of one that a thin wall may cover across: a wall at 45° is at most `√2·THICK`
/// long across cells.
const REACH: i64 = 3;

/// A thin rectangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct ThinWall {
    /// True if the cells across it are those above and below; else they are those to the left and right.
    upright: bool,
    /// The sum of the coverage of the cells across it.
    across: f64,
    thickness: f64,
}

impl ThinWall {
    /// Returns a rectangle, by its corners in order, as a thin wall if it is one.
    pub fn of(corners: &[Point]) -> Option<Self> {
        let &[a, b, c, _] = corners else { return None };
        let [ab, bc] = [[b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]];
        let long = if ab[0].hypot(ab[1]) < bc[0].hypot(bc[1]) { bc } else { ab };
        let length = long[0].hypot(long[1]);
        let area = (ab[0] * bc[1] - ab[1] * bc[0]).abs();
        let thickness = area / length;
        let upright = long[0].abs() >= long[1].abs();
        let steepness = long[usize::from(!upright)].abs() / length;
        (thickness < THICK).then_some(Self { upright, across: thickness / steepness, thickness })
    }

    /// Returns the opacity of a cell of which the wall, by its corners, covers a share above 0.
    pub fn opacity(&self, corners: &[Point], [x, y]: [i64; 2], share: f32) -> f32 {
        let around = |at: i64| at - REACH..at + REACH + 1;
        let across = if self.upright {
            Window { x: x..x + 1, y: around(y) }
        } else {
            Window { x: around(x), y: y..y + 1 }
        };
        let (mut most, mut sum) = (share, 0.0);
        coverage::polygon_shares(corners, &across, |_, _, share| {
            most = most.max(share);
            sum += f64::from(share);
        });
        let opacity =
            f64::from(share / most) * (sum / self.across).min(1.0) * self.thickness.min(1.0);
        if opacity > 1.0 - ROUNDING { 1.0 } else { opacity as f32 }
    }
}
