//! The appearance of solid cells: light sinks in from their faces, and emission shows on top.
//!
//! A wall is lit on its faces only, and its inside would be black. So a cell inside shows the mean of
//! E/2 over the faces around it, weighted by their distance r (Shepard 1968), and faded by its depth d:
//!
//! `light = fade(d) · Σ l·r⁻³·E/2 / Σ l·r⁻³`
//!
//! Here l is the length of surface that a cell with a face stands for. Close behind a face that face alone
//! counts; further in, the mean is over a longer part of the surface. So shadows on a wall are sharp at its
//! surface and soft inside. The sum of weights measures the depth as well: behind a straight wall it is
//! 1.12/(d² + 2.7). The depth that follows from it has no ridges where two faces are equally near. It is a
//! little less at a corner, and about half of the distance in the middle between two faces.
//!
//! r⁻³ is, nearly, a sum over octaves of blurs, each of twice the width and half the weight of the one
//! before. A pyramid ([`super::pyramid`]) sums them at a cost that hardly depends on the depth. Near a
//! border of the grid, the surface continues beyond it.
//!
//! Cells with a face show the mean over faces within 2 px that look the same way: the steps of a slope look
//! even, and no light comes through from the other side of a wall of 2 px or more.
//!
//! The emission of solid cells sinks in by the rule of the inside, into cells with a face too: beside a strip
//! of light they are as bright as what lies under them. In cells without a face it starts where they touch cells
//! that do not emit. A cell that emits by itself shows the brighter of the two.
//!
//! The first moment sinks in with the light. On a face it has the direction of that in the open cell before it, and
//! the light of the face: `m = (E/2)·m_before/J_before`.
//!
//! This is presentation, not transport: no ray ever sees it.

use super::faces::NORMALS;
use super::pyramid::{BlurSum, Pyramid};
use crate::srgb::luminance;
use crate::{Cells, Moment, Rgb, Settings};
use rayon::prelude::*;

/// The weight of an octave relative to the one before: 2^(2 − p) for weights r^(−p) in the plane.
pub const OCTAVE: f32 = 0.5;
/// The sum of weights behind a long straight wall, times d² + [`SOFTENING`].
pub const STRAIGHT: f32 = 1.12;
/// The square of the width of the narrowest blur, px: weights hardly grow at smaller distances.
pub const SOFTENING: f32 = 2.7;
/// Weights in the mean along the surface, by the distance along an axis.
pub const ALONG: [f32; 3] = [6.0, 4.0, 1.0];

/// Faces per task, at least.
const TASK: usize = 512;

/// The flag of solid cells beside those of their open sides: left, right, upper, lower.
const SOLID: u8 = 16;

/// Returns the number of octaves over which light sinks to a depth. Octaves wider than the depth still add to
/// the sum of weights.
pub fn octaves(depth: f32) -> u32 {
    let depth = depth.min(Settings::MAX_WALL_DEPTH);
    if depth > 0.0 { (depth + 1.0).log2().ceil() as u32 + 2 } else { 0 }
}

/// Buffers for [`Walls::sink`], kept between frames.
#[derive(Debug, Default)]
pub struct Walls {
    /// 1 in solid cells, 0 in others.
    solid: Vec<u8>,
    /// [`SOLID`] and the open sides of solid cells, 0 in others.
    sides: Vec<u8>,
    faces: Vec<WallFace>,
    /// Cells without an open side that emit beside one that does not.
    buried: Vec<Buried>,
    irradiance: Pyramid,
    emission: Pyramid,
    /// One component of a first moment.
    component: Vec<Rgb>,
}

/// A solid cell with an open side.
#[derive(Clone, Copy, Debug)]
struct WallFace {
    position: [usize; 2],
    index: usize,
    shown: Rgb,
}

/// A cell inside a wall from which emission sinks in.
#[derive(Clone, Copy, Debug)]
struct Buried {
    position: [usize; 2],
    index: usize,
    /// Sides towards cells that do not emit.
    sides: u32,
}

impl Walls {
    /// Completes `light` in solid cells. Those with a face, a side that touches an open cell, must hold the
    /// mean light of their faces; the others are overwritten. Light fades inwards over `depth` px, and
    /// emission is added.
    pub fn sink(&mut self, cells: &Cells, depth: f32, light: &mut [Rgb]) {
        self.find_sides(cells);
        self.carry_inwards(cells, depth, cells.emission(), light);
    }

    /// Completes the first moment in solid cells, by `light` before it has sunk in.
    pub fn sink_moment(&mut self, cells: &Cells, depth: f32, light: &[Rgb], moment: &mut [Moment]) {
        self.find_sides(cells);
        let width = cells.width() as usize;
        for face in &self.faces {
            let sides = self.sides[face.index];
            let open = NORMALS.iter().enumerate().filter(|(side, _)| sides >> side & 1 == 1);
            let (mut direction, mut count) = ([0.0; 2], 0.0);
            for (_, [dx, dy]) in open {
                let before = face.index.wrapping_add_signed((dy * width as i32 + dx) as isize);
                let inverse = 1.0 / luminance(light[before]).max(f32::MIN_POSITIVE);
                (0..2).for_each(|a| direction[a] += luminance(moment[before][a]) * inverse);
                count += 1.0;
            }
            let arrives = light[face.index];
            moment[face.index] = direction.map(|way| arrives.map(|v| v * way / count));
        }
        let mut component = std::mem::take(&mut self.component);
        for a in 0..2 {
            component.clear();
            component.extend(moment.iter().map(|moment| moment[a]));
            self.carry_inwards(cells, depth, &[], &mut component);
            for (moment, component) in moment.iter_mut().zip(&component) {
                moment[a] = *component;
            }
        }
        self.component = component;
    }

    /// Spreads the values of faces inwards, and emission, if there is any.
    fn carry_inwards(&mut self, cells: &Cells, depth: f32, emitted: &[Rgb], light: &mut [Rgb]) {
        let width = cells.width() as usize;
        self.sum(cells, depth, emitted, light);
        let own = |i: usize| emitted.get(i).copied().unwrap_or_default();
        let Self { sides, faces, irradiance, emission, .. } = self;
        let size = [width, cells.height() as usize];
        let surface = Surface { size, sides, shared: depth.min(1.0) };
        faces.par_iter_mut().with_min_len(TASK).for_each(|face| {
            let [x, y] = face.position;
            let glow = emission.row(y).map_or([0.0; 3], |mut row| row.at(x).mean());
            let glow = glow.map(|v| v * surface.shared);
            let arrives = surface.mean(face, light);
            face.shown = with_emission(arrives, glow, own(face.index));
        });
        let fade = DepthFade::over(depth);
        let rows = light.par_chunks_mut(width).zip(sides.par_chunks(width));
        rows.enumerate().for_each(|(y, (light, sides))| {
            let inside = solid_cells(sides).filter(|(_, sides)| *sides == SOLID);
            let (mut irradiance, mut emission) = (irradiance.row(y), emission.row(y));
            for (x, _) in inside {
                let arrives = irradiance.as_mut().map_or([0.0; 3], |row| fade.mean(row.at(x)));
                let glow = emission.as_mut().map_or([0.0; 3], |row| fade.mean(row.at(x)));
                light[x] = with_emission(arrives, glow, own(y * width + x));
            }
        });
        for face in &*faces {
            light[face.index] = face.shown;
        }
    }

    /// Finds the open sides of solid cells, and lists cells that have some. What lies beyond the grid is not
    /// open.
    fn find_sides(&mut self, cells: &Cells) {
        let Self { solid, sides, faces, buried, .. } = self;
        let width = cells.width() as usize;
        let emits = |i: usize| cells.emission()[i] != [0.0; 3];
        solid.clear();
        solid.extend(cells.opacity().iter().map(|&opacity| u8::from(opacity >= 1.0)));
        sides.resize(solid.len(), 0);
        faces.clear();
        buried.clear();
        for (y, sides) in sides.chunks_mut(width).enumerate() {
            let row = |y: usize| solid.get(y * width..(y + 1) * width);
            let here = row(y).unwrap_or_default();
            let above = y.checked_sub(1).and_then(row).unwrap_or(here);
            let below = row(y + 1).unwrap_or(here);
            // Whole rows at a time, which compiles to vector instructions.
            for (x, side) in sides.iter_mut().enumerate() {
                *side = here[x] * (SOLID | (1 - above[x]) << 2 | (1 - below[x]) << 3);
            }
            for ((side, here), left) in sides[1..].iter_mut().zip(&here[1..]).zip(here) {
                *side |= here * (1 - left);
            }
            for ((side, here), right) in sides.iter_mut().zip(here).zip(&here[1..]) {
                *side |= (here * (1 - right)) << 1;
            }
            for (x, side) in solid_cells(sides) {
                let (position, index) = ([x, y], y * width + x);
                if side > SOLID {
                    faces.push(WallFace { position, index, shown: [0.0; 3] });
                } else if emits(index) {
                    let sides = u32::from(x > 0 && !emits(index - 1))
                        + u32::from(x + 1 < width && !emits(index + 1))
                        + u32::from(y > 0 && !emits(index - width))
                        + u32::from(index + width < cells.len() && !emits(index + width));
                    if sides > 0 {
                        buried.push(Buried { position, index, sides });
                    }
                }
            }
        }
    }

    /// Sums irradiance and emission over the surface.
    fn sum(&mut self, cells: &Cells, depth: f32, emitted: &[Rgb], light: &[Rgb]) {
        let Self { sides, faces, buried, irradiance, emission, .. } = self;
        let size = [cells.width(), cells.height()].map(|n| n as usize);
        let octaves = octaves(depth);
        irradiance.clear(size, octaves);
        let length_of = |face: &WallFace| length((sides[face.index] & !SOLID).count_ones());
        for face in &*faces {
            irradiance.add(face.position, BlurSum::of(length_of(face), light[face.index]));
        }
        let glowing = || faces.iter().filter(|face| emitted[face.index] != [0.0; 3]);
        let dark = emitted.is_empty() || (buried.is_empty() && glowing().next().is_none());
        if dark {
            emission.clear(size, 0);
        } else {
            emission.clear(size, octaves);
            emission.copy_weights(irradiance);
            for face in glowing() {
                let glow = BlurSum::of(length_of(face), emitted[face.index]);
                emission.add(face.position, glow.without_weight());
            }
            for cell in buried {
                let glow = emitted[cell.index];
                emission.add(cell.position, BlurSum::of(length(cell.sides), glow));
            }
        }
        rayon::join(|| irradiance.sum_octaves(OCTAVE), || emission.sum_octaves(OCTAVE));
    }
}

/// Places and values of those that are not 0. Fast over runs of 0.
fn solid_cells(sides: &[u8]) -> impl Iterator<Item = (usize, u8)> {
    const CHUNK: usize = 16;
    let chunks = sides.chunks(CHUNK).enumerate();
    let chunks = chunks.filter(|(_, chunk)| chunk.iter().fold(0, |all, side| all | side) != 0);
    let cells = chunks.flat_map(|(i, chunk)| (i * CHUNK..).zip(chunk.iter().copied()));
    cells.filter(|(_, side)| *side != 0)
}

/// The length of surface that a cell stands for: two sides that meet stand for the diagonal between them.
fn length(sides: u32) -> f32 {
    (sides as f32).sqrt()
}

/// Adds emission to light that arrives: the cell's own or what sinks in, whichever is brighter.
fn with_emission(arrives: Rgb, glow: Rgb, own: Rgb) -> Rgb {
    [0, 1, 2].map(|c| arrives[c] + if glow[c] > own[c] { glow[c] } else { own[c] })
}

/// The cells with a face.
struct Surface<'a> {
    size: [usize; 2],
    sides: &'a [u8],
    /// The share of another cell that counts: a depth below 1 px leaves cells more to themselves.
    shared: f32,
}

impl Surface<'_> {
    /// Returns the mean light of a cell with a face and those nearby that face the same way.
    fn mean(&self, face: &WallFace, light: &[Rgb]) -> Rgb {
        let ([x, y], [width, height]) = (face.position, self.size);
        let own = self.sides[face.index] & !SOLID;
        if self.shared == 0.0 {
            return light[face.index];
        }
        let mut sum = BlurSum::default();
        for to_y in y.saturating_sub(2)..(y + 3).min(height) {
            for to_x in x.saturating_sub(2)..(x + 3).min(width) {
                let to = to_y * width + to_x;
                let sides = self.sides[to] & !SOLID;
                if own & sides != 0 {
                    let share = if to == face.index { 1.0 } else { self.shared };
                    let along = ALONG[to_x.abs_diff(x)] * ALONG[to_y.abs_diff(y)];
                    sum.add(share, BlurSum::of(sides.count_ones() as f32 * along, light[to]));
                }
            }
        }
        sum.mean()
    }
}

/// The fade of light over a depth.
struct DepthFade {
    /// The depth at which nothing is left.
    end: f32,
    /// The weight there.
    least: f32,
}

impl DepthFade {
    fn over(depth: f32) -> Self {
        let end = depth + 1.0;
        Self { end, least: STRAIGHT / (end * end + SOFTENING) }
    }

    /// Returns the mean of a sum, faded by the depth that follows from its weight.
    fn mean(&self, sum: BlurSum) -> Rgb {
        if sum.weight() <= self.least {
            return [0.0; 3];
        }
        let per_weight = 1.0 / sum.weight();
        // Cells without a face lie at least 1 px behind one.
        let behind = (STRAIGHT * per_weight - SOFTENING).max(1.0).sqrt();
        let left = (1.0 - behind / self.end).max(0.0);
        sum.scaled(left * left * (3.0 - 2.0 * left) * per_weight)
    }
}
