//! The traversal of the grid: which cells a ray crosses, in order, and over which distances.
//!
//! Amanatides and Woo (1987, "A Fast Voxel Traversal Algorithm for Ray Tracing"): the ray keeps the
//! distance to the next vertical and to the next horizontal edge, and crosses the nearer one.
//! Distances are computed from the origin of the ray, `(edge − from) / direction`, and never summed
//! up, so that they are exact to one rounding however long the ray is.
//!
//! **Corner rule.** A ray through the exact corner of four cells goes straight on into the opposite
//! cell, unless both cells beside the corner block it: walls that touch only by a corner hold light
//! back, and a single corner does not. [`Step::blocked`] applies the rule. (Packets that skip
//! empty space go by way of one of the two cells instead, see [`super::packet`].)
//!
//! The path tracer that judges the methods has its own traversal on purpose.

use std::ops::{Add, ControlFlow, Mul, Sub};

/// A ray with the cell in which it starts; the direction need not be a unit vector, distances are
/// then in units of its length. With vectors as `T`, sixteen rays.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ray<T, C = T> {
    /// Origin, px.
    pub from: [T; 2],
    /// Cell in which the ray starts: rounding may put `from` next to it.
    pub cell: [C; 2],
    pub direction: [T; 2],
}

/// A visit to a cell.
#[derive(Clone, Copy, Debug)]
pub struct Step<F> {
    pub cell: [i32; 2],
    /// Distances at which the ray enters and leaves the cell.
    pub span: [F; 2],
    /// True for each axis along which the ray steps into the cell: neither if it starts there, both if
    /// it comes through a corner.
    pub along: [bool; 2],
    /// Signs of the direction.
    sign: [i32; 2],
}

impl<F> Step<F> {
    /// Returns whether the ray starts in the cell.
    #[inline(always)]
    pub fn is_start(&self) -> bool {
        self.along == [false; 2]
    }

    /// Returns the cells beside the corner through which the ray comes: the one a column on and the
    /// one a row on.
    #[inline(always)]
    pub fn corner(&self) -> Option<[[i32; 2]; 2]> {
        let ([x, y], [right, down]) = (self.cell, self.sign);
        (self.along[0] & self.along[1]).then_some([[x, y - down], [x - right, y]])
    }

    /// Returns the cell that blocks the ray at the corner through which it comes, if both cells
    /// beside it do.
    #[inline(always)]
    pub fn blocked(&self, blocks: impl Fn([i32; 2]) -> bool) -> Option<[i32; 2]> {
        let beside = self.corner()?;
        beside.into_iter().all(blocks).then_some(beside[0])
    }
}

/// A floating-point number.
pub trait Real:
    Copy + PartialOrd + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    const ZERO: Self;
    const INFINITY: Self;
    fn of(cell: i32) -> Self;
    fn floor_cell(self) -> i32;
    /// Returns `1 / self`, never infinite, so that no edge is 0·∞ px away.
    fn inverse(self) -> Self;
    /// Returns the smaller number; not for NaN, which costs two more instructions.
    fn min_of(self, other: Self) -> Self;
    fn max_of(self, other: Self) -> Self;
}

macro_rules! real {
    ($float:ident) => {
        impl Real for $float {
            const ZERO: Self = 0.0;
            const INFINITY: Self = $float::INFINITY;
            #[inline(always)]
            fn of(cell: i32) -> Self {
                cell as $float
            }
            #[inline(always)]
            fn floor_cell(self) -> i32 {
                self.floor() as i32
            }
            #[inline(always)]
            fn inverse(self) -> Self {
                1.0 / self.abs().max($float::MIN_POSITIVE).copysign(self)
            }
            #[inline(always)]
            fn min_of(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max_of(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
        }
    };
}
real!(f32);
real!(f64);

/// Clips a ray to a grid: returns it with the first cell that it crosses, and the distances at
/// which it enters (0 if it starts inside) and leaves. `None` if it misses.
#[inline(always)]
pub fn enter<F: Real>(
    size: [i32; 2],
    from: [F; 2],
    direction: [F; 2],
) -> Option<(Ray<F, i32>, [F; 2])> {
    let (mut enter, mut leave) = (F::ZERO, F::INFINITY);
    for a in 0..2 {
        let inverse = direction[a].inverse();
        let low = (F::ZERO - from[a]) * inverse;
        let high = (F::of(size[a]) - from[a]) * inverse;
        enter = enter.max_of(low.min_of(high));
        leave = leave.min_of(low.max_of(high));
    }
    let at = |a: usize| (from[a] + direction[a] * enter).floor_cell();
    // Rounding may put the entry just outside.
    let cell = std::array::from_fn(|a| at(a).clamp(0, size[a] - 1));
    (enter < leave).then_some((Ray { from, cell, direction }, [enter, leave]))
}

/// Visits the cells along a ray between two distances, in order, until `visit` breaks.
#[inline(always)]
pub fn traverse<F: Real, B>(
    ray: Ray<F, i32>,
    [mut at, reach]: [F; 2],
    mut visit: impl FnMut(Step<F>) -> ControlFlow<B>,
) -> ControlFlow<B> {
    let Ray { from, mut cell, direction } = ray;
    let inverse = direction.map(F::inverse);
    let ahead = inverse.map(|v| i32::from(v > F::ZERO));
    let sign = ahead.map(|a| 2 * a - 1);
    let mut edge: [F; 2] = std::array::from_fn(|a| F::of(cell[a] + ahead[a]));
    let mut next: [F; 2] = std::array::from_fn(|a| (edge[a] - from[a]) * inverse[a]);
    let mut along = [false; 2];
    loop {
        let leave = next[0].min_of(next[1]);
        visit(Step { cell, span: [at, leave.min_of(reach)], along, sign })?;
        if leave >= reach {
            return ControlFlow::Continue(());
        }
        // Without branches: which edge comes next is as good as random.
        along = [next[0] <= next[1], next[1] <= next[0]];
        for a in 0..2 {
            let step = sign[a] * i32::from(along[a]);
            cell[a] += step;
            edge[a] = edge[a] + F::of(step);
            next[a] = (edge[a] - from[a]) * inverse[a];
        }
        at = leave;
    }
}
