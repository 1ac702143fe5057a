//! The first moment of light by its gradient, for methods that find no light by direction: `flood`, and the variant
//! `paper` of `holographic`.
//!
//! Light comes from where it is brighter. How much of it does so, the gradient does not tell: that of a small light at
//! distance d falls off as 1/d, so `|∇J|/J = 1/d`, and under an even sky it is 0. So the share of light with a
//! direction is taken to be
//!
//! `m = J·∇J/(|∇J| + J/d₀)`
//!
//! with d₀ = [`HALF`], the distance at which half of a small light's moment is found. An estimate, for pictures only.

use crate::srgb::luminance;
use crate::{Cells, Moment, Rgb};
use rayon::prelude::*;

/// The distance of a small light at which half of its moment is found, px.
pub const HALF: f32 = 128.0;

/// Estimates the first moment of open cells; 0 in solid ones.
pub fn gradient_moment(cells: &Cells, light: &[Rgb], moment: &mut Vec<Moment>) {
    let (width, height) = (cells.width() as usize, cells.height() as usize);
    moment.resize(cells.len(), Moment::default());
    moment.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        for (x, moment) in row.iter_mut().enumerate() {
            let i = y * width + x;
            *moment = Moment::default();
            if cells.is_solid(i) {
                continue;
            }
            // Beside a wall or the border, the slope of the other side alone.
            let slope = |before: Option<usize>, after: Option<usize>| {
                let open = |j: Option<usize>| j.filter(|&j| !cells.is_solid(j));
                let (before, after) = (open(before), open(after));
                let px = f32::from(u8::from(before.is_some()) + u8::from(after.is_some())).max(1.0);
                let at = |j: Option<usize>| luminance(light[j.unwrap_or(i)]);
                (at(after) - at(before)) / px
            };
            let gradient = [
                slope((x > 0).then(|| i - 1), (x + 1 < width).then(|| i + 1)),
                slope((y > 0).then(|| i - width), (y + 1 < height).then(|| i + width)),
            ];
            let flat = luminance(light[i]) / HALF;
            let whole = (gradient[0].hypot(gradient[1]) + flat).max(f32::MIN_POSITIVE);
            *moment = gradient.map(|slope| light[i].map(|v| v * slope / whole));
        }
    });
}
