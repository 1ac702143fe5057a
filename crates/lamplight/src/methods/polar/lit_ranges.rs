//! Lit ranges: for each ray of a shadow map the distance up to which pixels see the whole light, and that from which
//! on they see nothing of it. Only pixels in between need a closer look.

use crate::grid::cast::RayHit;
use crate::grid::medium_grid::MediumGrid;

/// The ranges of all rays of a light, side by side; the last ray is beside the first.
#[derive(Debug, Default)]
pub struct LitRanges {
    /// The distance up to which a pixel is fully lit, and that from which it is fully dark. The
    /// first ray is repeated at the end.
    pub ends: Vec<[f32; 2]>,
    /// True if the cells that this ray and the next hit touch: one wall, without a gap.
    pub joined: Vec<bool>,
    /// The number of rays to either side that matter between the ends.
    pub window: Vec<u8>,
}

/// Returns the neighbour of one of n rays round the circle, forwards or backwards.
#[inline(always)]
pub fn beside(ray: usize, n: usize, forward: bool) -> usize {
    if forward {
        if ray + 1 == n { 0 } else { ray + 1 }
    } else if ray == 0 {
        n - 1
    } else {
        ray - 1
    }
}

impl LitRanges {
    /// Sets ranges without penumbrae: each ray is lit up to its wall.
    pub fn sharp(&mut self, hits: &[RayHit]) {
        self.ends.clear();
        self.ends.extend(hits.iter().map(|hit| [hit.length; 2]));
        self.ends.push(self.ends[0]);
    }

    /// Finds the ranges of the rays that `is_used` says. The wall of a ray, used or not, shades pixels on up to
    /// `shades(ray)` rays to either side, and those behind it are dark if there is no gap on `covers(ray)` rays.
    pub fn find(
        &mut self,
        grid: &MediumGrid,
        hits: &[RayHit],
        is_used: impl Fn(usize) -> bool,
        shades: impl Fn(usize) -> f32,
        covers: impl Fn(usize) -> f32,
    ) {
        let n = hits.len();
        self.sharp(hits);
        self.joined.clear();
        let touch = |i: usize| grid.touch(hits[i].cell, hits[beside(i, n, true)].cell);
        self.joined.extend((0..n).map(touch));
        self.window.clear();
        self.window.resize(n, 0);
        for (ray, hit) in hits.iter().enumerate() {
            if *hit != RayHit::NONE {
                self.shade(ray, hit.length, shades(ray));
            }
            if is_used(ray) {
                self.ends[ray][1] = self.dark_from(hits, ray, &covers);
            }
        }
        self.ends[n] = self.ends[0];
    }

    /// Propagates a ray's hit to its neighbours.
    fn shade(&mut self, ray: usize, length: f32, rays: f32) {
        let n = self.window.len();
        let reach = (rays as usize).min((n - 1) / 2);
        // Runs of rays, counted from one turn before the first.
        let (from, middle, to) = (ray + n - reach, ray + n, ray + n + reach + 1);
        for turn in [0, n, 2 * n] {
            for i in from.max(turn)..to.min(turn + n) {
                let [lit, _] = &mut self.ends[i - turn];
                *lit = lit.min(length);
                let window = &mut self.window[i - turn];
                *window = (*window).max(i.abs_diff(middle).min(u8::MAX.into()) as u8);
            }
        }
    }

    /// Returns the distance from which a pixel on a ray sees nothing of the light: walls without a gap to either
    /// side, as far as the penumbra reaches.
    fn dark_from(&self, hits: &[RayHit], ray: usize, covers: impl Fn(usize) -> f32) -> f32 {
        let n = hits.len();
        let mut far = hits[ray].length;
        for forward in [true, false] {
            let mut i = ray;
            for k in 0.. {
                if hits[i] == RayHit::NONE || k >= n {
                    return f32::INFINITY;
                }
                far = far.max(hits[i].length);
                if k as f32 >= covers(i) {
                    break;
                }
                let next = beside(i, n, forward);
                if !self.joined[if forward { i } else { next }] {
                    return f32::INFINITY;
                }
                i = next;
            }
        }
        far
    }
}
