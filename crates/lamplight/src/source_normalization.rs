//! The source normalization of lamps: the factor by which the disc drawn on the grid is brightened, so
//! that as much light leaves it as leaves the ideal disc, wherever between the cells its center lies.
//!
//! The light that leaves a convex body of emitted radiance L_e is L_e × its mean width over all
//! directions, which is its perimeter ÷ π (Cauchy 1841): for a disc, 2·radius. A disc drawn by coverage
//! is a little wider, since the cells on its edge emit over their whole area: a ray that crosses `s` px
//! of a cell of coverage a meets `1 − (1 − a)^s` of it. The excess depends on the position of the
//! center, by up to ±10 % for radii under one px. The mean width is found by casting a fixed set of
//! rays through the drawn coverage, and the emission is scaled by its inverse.

use crate::grid::traverse::{enter, traverse};
use crate::scene::coverage::{self, Point, Window};
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::LazyLock;

/// Number of rays, and their generator: a Fibonacci lattice over direction and offset, two consecutive
/// Fibonacci numbers, which spread evenly over both.
const RAYS: usize = 377;
const GENERATOR: usize = 233;
/// The largest radius for which rays are cast; beyond it the width hardly depends on the position.
const CAST_TO: f64 = 8.0;
/// Side of a patch of cells that holds such a disc at any position.
const SIDE: usize = 2 * CAST_TO as usize + 2;
/// Width beyond 2·radius of larger discs, `a + b·ln(radius)`: rays that graze the edge meet more
/// partial cells the flatter it is. Fitted to radii of 3 to 8 px; the position adds ±0.1 px.
const EXCESS: (f64, f64) = (0.295, 0.238);
/// The optical depth at which a ray counts as stopped.
const OPAQUE_DEPTH: f32 = 20.0;

/// One ray of the fixed set.
#[derive(Clone, Copy, Debug)]
struct LatticeRay {
    /// Unit vector; no component is 0.
    direction: Point,
    /// Position across the patch, 0 to 1.
    offset: f64,
}

static LATTICE: LazyLock<[LatticeRay; RAYS]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let (sin, cos) = ((i as f64 + 0.5) * PI / RAYS as f64).sin_cos();
        let offset = ((i * GENERATOR % RAYS) as f64 + 0.5) / RAYS as f64;
        LatticeRay { direction: [cos, sin], offset }
    })
});

/// Returns the factor by which a lamp's disc is drawn brighter, so that as much light leaves it as leaves
/// the ideal disc: the mean width of the ideal disc over all directions (Cauchy 1841) ÷ that of the disc
/// as drawn by coverage. `center` and `radius` in px; of the center, only the position within its cell
/// matters. For hosts that draw lamps into textures of their own. Costs 377 rays through the drawn disc.
pub fn gain(center: Point, radius: f64) -> f32 {
    let ideal = 2.0 * radius;
    let drawn = if radius > CAST_TO {
        ideal + EXCESS.0 + EXCESS.1 * radius.ln()
    } else {
        Patch::of(center, radius).mean_width()
    };
    (ideal / drawn) as f32
}

/// A disc drawn by coverage.
#[derive(Debug)]
struct Patch {
    /// Extinction per px, by row.
    extinction: [[f32; SIDE]; SIDE],
    columns: usize,
    rows: usize,
    /// The disc's centre within the patch.
    center: Point,
    radius: f64,
}

impl Patch {
    fn of(center: Point, radius: f64) -> Self {
        let window = Window::around(center.map(|v| v - radius), center.map(|v| v + radius));
        let (left, top) = (window.x.start, window.y.start);
        let mut extinction = [[0.0; SIDE]; SIDE];
        coverage::disc_shares(center, radius, &window, |x, y, share| {
            let depth = -(1.0 - share).ln();
            extinction[(y - top) as usize][(x - left) as usize] = depth.min(2.0 * OPAQUE_DEPTH);
        });
        Self {
            extinction,
            columns: (window.x.end - left) as usize,
            rows: (window.y.end - top) as usize,
            center: [center[0] - left as f64, center[1] - top as f64],
            radius,
        }
    }

    fn mean_width(&self) -> f64 {
        // Half the directions suffice: a ray and its reverse meet the same cells.
        LATTICE.iter().map(|ray| self.width_at(ray)).sum::<f64>() / RAYS as f64
    }

    /// Returns the fraction of a ray that the disc stops, times the span over which its offset runs.
    fn width_at(&self, ray: &LatticeRay) -> f64 {
        let [cos, sin] = ray.direction;
        let (w, h) = (self.columns as f64, self.rows as f64);
        let [cx, cy] = self.center;
        // The span across the ray of the patch and of the cells that can touch the disc.
        let across = |x: f64, y: f64| (y - cy) * cos - (x - cx) * sin;
        let corners = [across(0.0, 0.0), across(w, 0.0), across(0.0, h), across(w, h)];
        let reach = self.radius + std::f64::consts::SQRT_2;
        let low = corners.into_iter().fold(f64::MAX, f64::min).max(-reach);
        let high = corners.into_iter().fold(f64::MIN, f64::max).min(reach);
        let offset = low + ray.offset * (high - low);
        let through = [cx - offset * sin, cy + offset * cos];
        (high - low) * f64::from(1.0 - (-self.optical_depth(through, ray.direction)).exp())
    }

    /// Returns the optical depth along a line, up to about [`OPAQUE_DEPTH`].
    fn optical_depth(&self, through: Point, direction: Point) -> f32 {
        // From outside the patch in every direction.
        let from = std::array::from_fn(|a| through[a] - 2.0 * SIDE as f64 * direction[a]);
        let size = [self.columns as i32, self.rows as i32];
        let Some((ray, span)) = enter(size, from, direction) else { return 0.0 };
        let mut sum = 0.0;
        let _ = traverse(ray, span, |step| {
            let [x, y] = step.cell.map(|v| v as usize);
            sum += self.extinction[y][x] * (step.span[1] - step.span[0]).max(0.0) as f32;
            if sum > OPAQUE_DEPTH { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        sum
    }
}
