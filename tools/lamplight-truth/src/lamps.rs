//! The direct light of suns, of lamps with a cone and of others that are not drawn: sampled, one point of each at a
//! time.
//!
//! A lamp of radius R is a disc of radiance L that is seen under the angle 2·asin(R/d). Its falloff f(d) says what
//! of L is mean radiance at distance d where nothing is in between, and its cone how much of that goes where the
//! receiver is, seen from the lamp's centre; a cookie multiplies it by the picture at the receiver. A point at β·R beside
//! the centre, across the line of sight, stands for the disc, with β even from −1 to 1 as far as the centre sees:
//!
//! `J = L·f(d)·cone(φ)·⟨T(β)⟩`, and on a face `E/2 = ½∫L cosθ dω = π·L·f(d)·cone(φ)·⟨cosθ(β)·T(β)⟩`
//!
//! Parts of the disc that its centre does not see are dark: they lie behind a wall or, of a lamp inside, beyond the border
//! of the grid. Those that it sees stand for the whole.

use crate::traverse::{Event, Grid, Traversal};
use lamplight::{Lamp, Sun};
use std::f64::consts::{FRAC_1_PI, PI};

/// The cotangent of the lowest elevation of light.
const MAX_COTANGENT: f64 = 20.0;
/// The smallest part of a lamp, in its radii, that may stand for the whole.
const SMALLEST_PART: f64 = 1e-3;

/// A place that receives light.
pub struct Vertex {
    /// The open cell that it lies in, or on the border of.
    pub cell: [i32; 2],
    pub point: [f64; 2],
    /// The normal of a face; none in the open.
    pub normal: Option<[f64; 2]>,
    /// The layers of what receives: of the cell, or of the solid cell that has the face.
    pub mask: u8,
}

impl Vertex {
    /// The centre of a cell.
    pub fn centre(cell: [i32; 2], mask: u8) -> Self {
        Self { cell, point: cell.map(|v| f64::from(v) + 0.5), normal: None, mask }
    }
}

/// Calls `receive` with the light of one point of each lamp and of each sun, that at `point` (0 to 1) across it: J, or
/// E/2 on a face; with the direction towards it; and with the cotangent of its elevation above the plane, if it has one of
/// its own.
pub fn direct(
    lamps: &[Lamp],
    suns: &[Sun],
    grid: &Grid,
    at: &Vertex,
    point: f64,
    mut receive: impl FnMut([f64; 3], [f64; 2], Option<f64>),
) {
    for sun in suns.iter().filter(|sun| sun.mask & at.mask != 0) {
        let width = f64::from(sun.angle);
        let (sin, cos) = (f64::from(sun.direction) + (point - 0.5) * width).sin_cos();
        let to = [-cos, -sin];
        let cosine = at.normal.map(|n| n[0] * to[0] + n[1] * to[1]);
        let weight = width * cosine.map_or(0.5 * FRAC_1_PI, |cosine| 0.5 * cosine);
        if weight <= 0.0 {
            continue;
        }
        let Some(through) = to_sky(grid, at.cell, at.point, to) else { continue };
        let radiance = sun.radiance();
        let light = [0, 1, 2].map(|c| weight * through[c] * f64::from(radiance[c]));
        receive(light, to, sun.elevation.map(|own| 1.0 / f64::from(own).tan()));
    }
    for lamp in lamps.iter().filter(|lamp| lamp.mask & at.mask != 0) {
        let centre = lamp.position.map(f64::from);
        let off = [0, 1].map(|a| at.point[a] - centre[a]);
        let distance = off[0].hypot(off[1]);
        let share = lamp.cone.map_or(1.0, |cone| cone.share(off[1].atan2(off[0]) as f32));
        let falls = f64::from(share * lamp.falloff.at(distance as f32, lamp));
        let picture = lamp.cookie.as_ref().map(|cookie| cookie.at(off.map(|v| v as f32)));
        if falls == 0.0 || picture == Some([0.0; 3]) {
            continue;
        }
        let radiance = lamp.color.map(|c| f64::from(c) * f64::from(lamp.intensity));
        let factors = picture.unwrap_or([1.0; 3]).map(f64::from);
        if distance == 0.0 {
            // The centre itself has light from all around.
            receive([0, 1, 2].map(|c| falls * radiance[c] * factors[c]), [0.0; 2], None);
            continue;
        }
        let across = [-off[1] / distance, off[0] / distance];
        let Some([from, to]) = seen_by_centre(grid, centre, across, lamp.size.into()) else {
            continue;
        };
        let beside = from + point * (to - from);
        let part = [0, 1].map(|a| centre[a] + beside * across[a]);
        let to = [0, 1].map(|a| part[a] - at.point[a]);
        let length = to[0].hypot(to[1]);
        let cos = at.normal.map(|n| (n[0] * to[0] + n[1] * to[1]) / length);
        let weight = falls * cos.map_or(1.0, |cos| PI * cos);
        if weight <= 0.0 {
            continue;
        }
        if let Some(through) = transmittance(grid, at.cell, at.point, to) {
            let light = [0, 1, 2].map(|c| weight * through[c] * radiance[c] * factors[c]);
            let own = lamp.height.map(|height| (distance / f64::from(height)).min(MAX_COTANGENT));
            receive(light, to.map(|v| v / length), own);
        }
    }
}

/// The part of a lamp that its centre sees, px along the line `across` it; `None` if its centre is in a wall.
fn seen_by_centre(
    grid: &Grid,
    centre: [f64; 2],
    across: [f64; 2],
    radius: f64,
) -> Option<[f64; 2]> {
    let ways = [-1.0, 1.0].map(|sign| across.map(|v| sign * v));
    let mut ends = [radius; 2];
    if grid.contains(centre) {
        ends = ways.map(|way| radius.min(grid.to_border(centre, way)));
    }
    // A lamp at a corner of the grid may have no part inside.
    if ends[0] + ends[1] <= SMALLEST_PART * radius {
        ends = [radius; 2];
    }
    let cell = centre.map(|v| v.floor() as i32);
    for (end, way) in ends.iter_mut().zip(ways) {
        *end = end.min(to_wall(grid, cell, centre, way));
    }
    (ends[0] + ends[1] > SMALLEST_PART * radius).then_some([-ends[0], ends[1]])
}

/// The distance to the first wall, px; infinite if there is none.
fn to_wall(grid: &Grid, cell: [i32; 2], from: [f64; 2], way: [f64; 2]) -> f64 {
    let mut walk = Traversal::new(grid, cell, from, way);
    loop {
        match walk.next() {
            Event::Wall { point, .. } => return (point[0] - from[0]).hypot(point[1] - from[1]),
            Event::Medium(_) => {}
            Event::Sky => return f64::INFINITY,
        }
    }
}

/// The transmittance from a point in `cell` along a vector; `None` behind a wall.
fn transmittance(grid: &Grid, cell: [i32; 2], from: [f64; 2], to: [f64; 2]) -> Option<[f64; 3]> {
    let length = to[0].hypot(to[1]);
    if length == 0.0 {
        return Some([1.0; 3]);
    }
    along(grid, cell, from, to.map(|v| v / length), length)
}

/// The transmittance from a point in `cell` up to the sky; `None` behind a wall.
fn to_sky(grid: &Grid, cell: [i32; 2], from: [f64; 2], way: [f64; 2]) -> Option<[f64; 3]> {
    along(grid, cell, from, way, f64::INFINITY)
}

fn along(
    grid: &Grid,
    cell: [i32; 2],
    from: [f64; 2],
    way: [f64; 2],
    length: f64,
) -> Option<[f64; 3]> {
    let mut walk = Traversal::new(grid, cell, from, way);
    let mut depth = [0.0; 3];
    loop {
        match walk.next() {
            Event::Wall { point, .. } => {
                let reached = (point[0] - from[0]).hypot(point[1] - from[1]);
                if reached < length {
                    return None;
                }
                break;
            }
            Event::Medium(stretch) if stretch.entry < length => {
                let px = stretch.length.min(length - stretch.entry);
                let extinction = grid.extinction[stretch.extinction];
                (0..3).for_each(|c| depth[c] += extinction[c] * px);
            }
            Event::Sky | Event::Medium(_) => break,
        }
    }
    Some(depth.map(|d| (-d).exp()))
}
