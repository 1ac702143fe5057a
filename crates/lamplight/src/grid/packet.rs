//! Sixteen rays at once through empty space and media.
//!
//! Rays spend most of their length in empty cells and media. A packet advances its rays in
//! lockstep, from square to square of the same matter ([`super::empty_space`]), until each has left
//! the grid, come to a solid cell or gone its maximum distance; what happens there is up to the
//! method. Rays of neighbouring cells in about the same direction stay together, so few of them idle.
//! The vector units are chosen at run time; no fused multiply-add is used, so the results are the
//! same to the bit on every one.
//!
//! It visits the cells of [`super::traverse`], held to it by a test, with two differences that make
//! it fast: positions are updated from edge to edge, so that lengths are exact to a few roundings of
//! the position, and a ray through the exact corner of four cells goes by way of the cell above or
//! below, and ends there if that is solid.

use super::class::CellClass;
use super::empty_space::{MATTER, quadrant, side};
use super::medium_grid::MediumGrid;
use super::traverse::Ray;
use crate::math::transmittance::{OPAQUE_TRANSMITTANCE, attenuation_lanes};
use crate::simd::floor;
use fearless_simd::{f32x16, i32x16, mask32x16, prelude::*};

/// Rays in a packet.
pub const LANES: usize = 16;

/// One value a ray.
pub type Lanes<T> = [T; LANES];

/// Slope under which a ray never crosses an edge of an axis.
pub const NEVER: f32 = 1e-12;

// Cell indices are computed in f32, which holds whole numbers up to 2^24 exactly.
const _: () = assert!(crate::Cells::MAX_CELLS <= 1 << 24);

/// The ends of sixteen rays.
#[derive(Clone, Copy, Debug)]
pub struct Stopped {
    pub at: [Lanes<f32>; 2],
    pub cell: [Lanes<f32>; 2],
    pub direction: [Lanes<f32>; 2],
    pub travelled: Lanes<f32>,
    /// Radiance gathered in media, and the transmittance of the way, by channel.
    pub light: [Lanes<f32>; 3],
    pub transmittance: [Lanes<f32>; 3],
    /// Bit masks of rays: those that left the grid,
    escaped: u64,
    /// whose steps ran out or whose transmittance is nil,
    step_limit: u64,
    /// that went their maximum distance,
    max_distance: u64,
    /// whose last step went along x.
    by_x: u64,
}

/// The reason why a ray ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// It left the grid.
    Escaped,
    /// It ran out of steps or of transmittance.
    StepLimit,
    /// It went its maximum distance.
    MaxDistance,
    /// It entered a cell that stops it by a step along this axis.
    Hit(usize),
}

impl Stopped {
    /// Returns the rays that ended at a cell that stops them, as a bit mask.
    #[inline(always)]
    pub fn hits(&self) -> u64 {
        !(self.escaped | self.step_limit | self.max_distance) & u64::from(u16::MAX)
    }

    /// Returns the reason why a ray ended.
    #[inline(always)]
    pub fn termination(&self, lane: usize) -> Termination {
        let is = |mask: u64| mask >> lane & 1 == 1;
        if is(self.escaped) {
            Termination::Escaped
        } else if is(self.step_limit) {
            Termination::StepLimit
        } else if is(self.max_distance) {
            Termination::MaxDistance
        } else {
            Termination::Hit(!is(self.by_x) as usize)
        }
    }
}

/// Marches rays that start inside the grid until each has stopped or made `steps`.
#[inline(always)]
pub fn march<S: Simd>(simd: S, grid: &MediumGrid, ray: Ray<f32x16<S>>, steps: u32) -> Stopped {
    let anywhere = f32x16::splat(simd, f32::INFINITY);
    march_up_to::<S, false>(simd, grid, ray, anywhere, steps)
}

/// Marches rays that start inside the grid until each has stopped, gone `reach` px or made `steps`.
#[inline(always)]
pub fn march_within<S: Simd>(
    simd: S,
    grid: &MediumGrid,
    ray: Ray<f32x16<S>>,
    reach: f32x16<S>,
    steps: u32,
) -> Stopped {
    march_up_to::<S, true>(simd, grid, ray, reach, steps)
}

/// `ENDS` is known at compile time: without a maximum distance a step costs less.
#[inline(always)]
fn march_up_to<S: Simd, const ENDS: bool>(
    simd: S,
    grid: &MediumGrid,
    ray: Ray<f32x16<S>>,
    reach: f32x16<S>,
    steps: u32,
) -> Stopped {
    // Written out by axis, not by closures: those are not always compiled for the vector unit.
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let size = grid.size.map(|v| v as f32);
    let Ray { from: mut at, mut cell, direction: way } = ray;
    let never = f32x16::splat(simd, NEVER);
    let inverse = [
        one / way[0].abs().simd_lt(NEVER).select(never, way[0]),
        one / way[1].abs().simd_lt(NEVER).select(never, way[1]),
    ];
    let back = [way[0].simd_lt(0.0), way[1].simd_lt(0.0)];
    let sign = [back[0].select(-one, one), back[1].select(-one, one)];
    // An edge has the coordinate of the cell behind it, seen from the left or from above.
    let beyond = [back[0].select(one, zero), back[1].select(one, zero)];
    let plane = back[0].select(one, zero) + back[1].select(one + one, zero);
    let plane = plane.to_int::<i32x16<S>>() * (grid.classes.len() as i32);

    let mut travelled = zero;
    let mut by_x = mask32x16::splat(simd, false);
    let mut inside = mask32x16::splat(simd, true);
    let (mut square, mut index) = look_up(simd, grid, plane, cell);
    let mut going = square.simd_gt(0.0);
    let (mut spent, mut reached) = (by_x, by_x);
    let (mut light, mut through) = ([zero; 3], [one; 3]);
    for _ in 0..steps {
        let matter = going & square.simd_ge(f32::from(MATTER));
        let side = matter.select(square - f32::from(MATTER), square);
        let next = [cell[0] + sign[0] * side, cell[1] + sign[1] * side];
        let edge = [next[0] + beyond[0], next[1] + beyond[1]];
        let tx = (edge[0] - at[0]) * inverse[0];
        let ty = (edge[1] - at[1]) * inverse[1];
        let x_first = tx.simd_lt(ty);
        let mut t = tx.min(ty);
        let mut crosses = [going & x_first, going & !x_first];
        if ENDS {
            let left = reach - travelled;
            let ends = going & t.simd_ge(left);
            t = t.min(left);
            crosses = [crosses[0] & !ends, crosses[1] & !ends];
            reached |= ends;
        }
        for a in 0..2 {
            // Along the axis that it crosses a ray lands exactly on the edge; along the other it
            // stays within the square in spite of rounding.
            let along = at[a] + way[a] * t;
            let last = next[a] - sign[a];
            let within = floor(along).max(cell[a].min(last)).min(cell[a].max(last));
            at[a] = going.select(crosses[a].select(edge[a], along), at[a]);
            cell[a] = going.select(crosses[a].select(next[a], within), cell[a]);
        }
        if matter.to_bitmask() != 0 {
            let length = matter.select(t.max(0.0), zero);
            cross(grid, &index, length, &mut light, &mut through);
            let most = through[0].max(through[1]).max(through[2]);
            spent |= going & most.simd_lt(OPAQUE_TRANSMITTANCE);
        }
        travelled = going.select(travelled + t, travelled);
        by_x = crosses[0] | (!going & by_x);
        let in_x = cell[0].simd_ge(0.0) & cell[0].simd_lt(size[0]);
        let in_y = cell[1].simd_ge(0.0) & cell[1].simd_lt(size[1]);
        inside = in_x & in_y;
        let safe = [inside.select(cell[0], zero), inside.select(cell[1], zero)];
        (square, index) = look_up(simd, grid, plane, safe);
        going = going & inside & !spent & !reached & square.simd_gt(0.0);
        if going.to_bitmask() == 0 {
            break;
        }
    }
    Stopped {
        at: [at[0].to_array(), at[1].to_array()],
        cell: [cell[0].to_array(), cell[1].to_array()],
        direction: [way[0].to_array(), way[1].to_array()],
        travelled: travelled.to_array(),
        escaped: !inside.to_bitmask(),
        light: [light[0].to_array(), light[1].to_array(), light[2].to_array()],
        transmittance: [through[0].to_array(), through[1].to_array(), through[2].to_array()],
        step_limit: (going | spent).to_bitmask(),
        max_distance: reached.to_bitmask(),
        by_x: by_x.to_bitmask(),
    }
}

/// Continues one ray of a packet by the same steps, from a cell that stopped it and that the method
/// lets it pass. `cross` receives the index of each cell from which a square opens and the px that
/// the ray goes within that square, and returns whether the ray goes on. Returns the reason why it
/// ended, and the cell.
#[inline(always)]
pub fn march_alone(
    grid: &MediumGrid,
    ray: Ray<f32, i32>,
    steps: u32,
    mut cross: impl FnMut(usize, f32) -> bool,
) -> (Termination, [i32; 2]) {
    let Ray { from: mut at, mut cell, direction } = ray;
    let squares = grid.empty_space.plane(quadrant(direction));
    let inverse = direction.map(|d| 1.0 / if d.abs() < NEVER { NEVER } else { d });
    let sign = direction.map(|d| if d < 0.0 { -1 } else { 1 });
    let beyond = direction.map(|d| (d < 0.0) as i32);
    for _ in 0..steps {
        let index = grid.index(cell);
        let side = side(squares[index]).max(1);
        let next: [i32; 2] = std::array::from_fn(|a| cell[a] + sign[a] * side);
        let edge: [f32; 2] = std::array::from_fn(|a| (next[a] + beyond[a]) as f32);
        let t: [f32; 2] = std::array::from_fn(|a| (edge[a] - at[a]) * inverse[a]);
        let axis = (t[0] >= t[1]) as usize;
        let length = t[axis].max(0.0);
        if !cross(index, length) {
            return (Termination::StepLimit, cell);
        }
        // Along the other axis the ray stays within the square in spite of rounding.
        let other = 1 - axis;
        let last = next[other] - sign[other];
        let along = at[other] + direction[other] * length;
        (at[axis], at[other]) = (edge[axis], along);
        let (low, high) = (cell[other].min(last), cell[other].max(last));
        cell[other] = (along.floor() as i32).clamp(low, high);
        cell[axis] = next[axis];
        if !grid.holds(cell) {
            return (Termination::Escaped, cell);
        }
        if grid.classes[grid.index(cell)] == CellClass::Solid {
            return (Termination::Hit(axis), cell);
        }
    }
    (Termination::StepLimit, cell)
}

/// Returns the squares that sixteen rays stand in, and the indices of their cells.
#[inline(always)]
fn look_up<S: Simd>(
    simd: S,
    grid: &MediumGrid,
    plane: i32x16<S>,
    cell: [f32x16<S>; 2],
) -> (f32x16<S>, Lanes<i32>) {
    let index = (cell[1] * grid.size[0] as f32 + cell[0]).to_int::<i32x16<S>>();
    let place = (index + plane).to_array();
    let squares =
        i32x16::from_fn(simd, |l| i32::from(grid.empty_space.squares()[place[l] as usize]));
    (squares.to_float(), index.to_array())
}

/// Crosses media, 0 px of them in lanes that are elsewhere.
#[inline(always)]
fn cross<S: Simd>(
    grid: &MediumGrid,
    index: &Lanes<i32>,
    length: f32x16<S>,
    light: &mut [f32x16<S>; 3],
    through: &mut [f32x16<S>; 3],
) {
    let simd = length.token();
    let (mut t, mut absorbed) = (length, length);
    for c in 0..3 {
        if c == 0 || grid.tints {
            let extinction = f32x16::from_fn(simd, |l| grid.extinction[index[l] as usize][c]);
            (t, absorbed) = attenuation_lanes(extinction * length);
        }
        let source = f32x16::from_fn(simd, |l| grid.source[index[l] as usize][c]);
        light[c] += through[c] * (absorbed * source);
        through[c] *= t;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::medium_grid::Reading;
    use crate::grid::traverse::traverse;
    use crate::math::transmittance::transmittance;
    use crate::simd::dispatch;
    use crate::{Cells, Matter};
    use fastrand::Rng;
    use fearless_simd::Level;
    use std::ops::ControlFlow;

    const SIZE: u32 = 48;
    /// Rounding of positions up to [`SIZE`], over a few dozen edges, px and fraction of light.
    const TOLERANCE: f32 = 2e-4;
    /// Rays that pass a corner nearer than this, px, may go by either side.
    const CORNER: f32 = 1e-3;

    /// The end of one ray.
    #[derive(Clone, Copy, Debug)]
    struct End {
        termination: Termination,
        cell: [i32; 2],
        travelled: f32,
        light: f32,
        transmittance: f32,
    }

    impl End {
        fn agrees(&self, other: &Self) -> bool {
            let near = |a: f32, b: f32| (a - b).abs() <= TOLERANCE * (1.0 + a.abs());
            let hit = matches!(self.termination, Termination::Hit(_));
            // Squares extend beyond the edge, and so do packets.
            let escaped = self.termination == Termination::Escaped;
            self.termination == other.termination
                && (!hit || self.cell == other.cell)
                && (escaped || near(self.travelled, other.travelled))
                && near(self.light, other.light)
                && near(self.transmittance, other.transmittance)
        }
    }

    fn grid(random: &mut Rng) -> MediumGrid {
        let mut cells = Cells::new(SIZE, SIZE - 7).unwrap();
        for i in 0..cells.len() {
            let fog = Matter { opacity: 0.1, emission: [0.5; 3], ..Matter::EMPTY };
            match random.f32() {
                x if x < 0.02 => cells.set_matter(i, Matter { opacity: 1.0, ..Matter::EMPTY }),
                x if x < 0.05 || (500..700).contains(&i) => cells.set_matter(i, fog),
                _ => (),
            }
        }
        let mut grid = MediumGrid::default();
        grid.read(&cells, Reading::default());
        grid.read_emission(&cells, 1.0);
        grid.measure_empty_space(|_, _| false);
        grid
    }

    /// Follows the ray cell by cell; `None` if it passes too near to a corner.
    fn alone(grid: &MediumGrid, ray: Ray<f32, i32>, reach: f32) -> Option<End> {
        let mut end = End {
            termination: Termination::MaxDistance,
            cell: ray.cell,
            travelled: 0.0,
            light: 0.0,
            transmittance: 1.0,
        };
        let mut near_corner = false;
        let _ = traverse(ray, [0.0, reach], |step| {
            end.cell = step.cell;
            let axis = usize::from(step.along[1]);
            near_corner |= step.span[1] - step.span[0] < CORNER;
            match grid.class(step.cell) {
                CellClass::Solid => end.termination = Termination::Hit(axis),
                CellClass::Outside => end.termination = Termination::Escaped,
                class => {
                    let length = step.span[1] - step.span[0];
                    end.travelled += length;
                    if class == CellClass::Medium {
                        let i = grid.index(step.cell);
                        let t = transmittance(grid.extinction[i][0] * length);
                        end.light += end.transmittance * (1.0 - t) * grid.source[i][0];
                        end.transmittance *= t;
                    }
                    return ControlFlow::Continue(());
                }
            }
            ControlFlow::Break(())
        });
        (!near_corner).then_some(end)
    }

    fn together(grid: &MediumGrid, rays: &[Ray<f32, i32>; LANES], reach: f32) -> [End; LANES] {
        let stopped = dispatch!(Level::new(), simd => {
            let load = |v: &dyn Fn(usize) -> f32| f32x16::from_fn(simd, v);
            let ray = Ray {
                from: std::array::from_fn(|a| load(&|l| rays[l].from[a])),
                cell: std::array::from_fn(|a| load(&|l| rays[l].cell[a] as f32)),
                direction: std::array::from_fn(|a| load(&|l| rays[l].direction[a])),
            };
            march_within(simd, grid, ray, f32x16::splat(simd, reach), u32::MAX)
        });
        std::array::from_fn(|l| End {
            termination: stopped.termination(l),
            cell: std::array::from_fn(|a| stopped.cell[a][l] as i32),
            travelled: stopped.travelled[l],
            light: stopped.light[0][l],
            transmittance: stopped.transmittance[0][l],
        })
    }

    #[test]
    fn a_packet_goes_where_each_of_its_rays_goes_alone() {
        let mut random = Rng::new();
        println!("seed {}", random.get_seed());
        let (mut compared, mut rejected) = (0, 0);
        for _ in 0..20 {
            let grid = grid(&mut random);
            for _ in 0..40 {
                let open = |random: &mut Rng| loop {
                    let at = [SIZE, SIZE - 7].map(|side| random.f32() * side as f32);
                    let cell = at.map(|v| v as i32);
                    if grid.class(cell).is_open() {
                        let (sin, cos) = (random.f32() * std::f32::consts::TAU).sin_cos();
                        return Ray { from: at, cell, direction: [cos, sin] };
                    }
                };
                let rays: [_; LANES] = std::array::from_fn(|_| open(&mut random));
                let reach = 60.0 * random.f32();
                for (ray, end) in rays.into_iter().zip(together(&grid, &rays, reach)) {
                    let Some(wanted) = alone(&grid, ray, reach) else { continue };
                    assert!(end.agrees(&wanted), "{ray:?} up to {reach}: {end:?}, not {wanted:?}");
                    compared += 1;
                    // Half a px less.
                    let short = alone(&grid, ray, reach - 0.5);
                    rejected += u32::from(short.is_some_and(|short| !end.agrees(&short)));
                }
            }
        }
        println!("{compared} rays compared, {rejected} perturbed ones rejected");
        assert!(compared > 10_000 && rejected > 1_000);
    }
}
