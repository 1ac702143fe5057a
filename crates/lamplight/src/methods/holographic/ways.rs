//! The ways of rays through the grid, the same from every pixel: beams of the lattice, and what
//! pixels look along in the last hop.

use super::cones::{angle, slope};
use super::stencil::stencil;
use crate::settings::Holographic;

pub use super::slabs::Face;
pub use super::stencil::Crossing;

/// Keeps the rays of a beam off the corners of cells.
pub(super) const OFF_CORNERS: f64 = 0.999;

/// How pixels look ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Look {
    /// Planes lie `2^level` px apart.
    pub level: u32,
    /// Px to the plane at least; at most `2^level − 1` more.
    pub least: usize,
    /// Rays through a cone in which something glows.
    pub rays: u32,
}

impl Look {
    /// As settings have it.
    pub fn new(settings: &Holographic) -> Self {
        let least = settings.least.min(1 << settings.hop) as usize;
        Self { level: settings.hop, least, rays: settings.rays }
    }

    /// Px to the plane at most.
    pub fn most(&self) -> usize {
        (1 << self.level) + self.least - 1
    }

    /// The slabs that look to a plane.
    pub fn slabs(&self, plane: usize, depth: usize) -> std::ops::Range<usize> {
        let at = plane << self.level;
        at.saturating_sub(self.most())..(at + 1).saturating_sub(self.least).min(depth)
    }

    /// The farthest plane that any slab looks to.
    pub fn last(&self, depth: usize) -> usize {
        (depth - 1 + self.most()) >> self.level
    }

    /// The cones through which pixels `ahead` slabs before a plane look.
    pub fn cones(&self, ahead: usize) -> Vec<ConeWays> {
        let fine = self.level + 1;
        let cone = |number| {
            let (from, angle) = (slope(fine, number).atan(), angle(fine, number));
            let fan = (0..self.rays).map(|i| (f64::from(i) + 0.5) / f64::from(self.rays));
            let ways = std::iter::once(0.5).chain(fan);
            let ways = ways.map(|share| Way::new(ahead, (from + share * angle).tan())).collect();
            let middle = from + 0.5 * angle;
            let cosines = [middle.cos() as f32, middle.sin() as f32];
            ConeWays { angle: angle as f32, cosines, ways }
        };
        (0..2usize << fine).map(cone).collect()
    }
}

/// A cone, as a pixel at some distance from the plane looks through it.
#[derive(Clone, Debug)]
pub struct ConeWays {
    /// In radians.
    pub angle: f32,
    /// Cosines of its middle to the axis and to the direction of higher rows.
    pub cosines: [f32; 2],
    /// The way along its middle, then those of the fan for where something glows.
    pub ways: Vec<Way>,
}

/// A way from a pixel to the plane.
#[derive(Clone, Debug)]
pub struct Way {
    /// The cells that it crosses.
    pub crossings: Vec<Crossing>,
    /// Rows from the start to the row before its end on the plane.
    pub row: isize,
    /// Shares of that row and of the next in the light there.
    pub shares: [f32; 2],
}

impl Way {
    fn new(ahead: usize, slope: f64) -> Self {
        let shift = slope * ahead as f64;
        let past = (shift - shift.floor()) as f32;
        let crossings = stencil(ahead, slope, 0.0);
        Self { crossings, row: shift.floor() as isize, shares: [1.0 - past, past] }
    }
}

/// The parallel rays of a beam: ray `ray` of a level, spread over `width` places across a px.
pub fn beam(level: u32, ray: usize, width: u32) -> Vec<Vec<Crossing>> {
    let length = 1usize << level;
    let slope = ray as f64 / length as f64 - 1.0;
    let across = |i: u32| OFF_CORNERS * ((f64::from(i) + 0.5) / f64::from(width) - 0.5);
    (0..width).map(|i| stencil(length, slope, across(i))).collect()
}
