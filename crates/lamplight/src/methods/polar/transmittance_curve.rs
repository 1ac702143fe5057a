//! Transmittance along the rays of a lamp, as a function of distance (a deep shadow map, Lokovic and
//! Veach 2000).
//!
//! Along a ray the optical depth τ is piecewise linear, with a corner wherever the medium changes. The
//! corners are kept, so that a lookup between them is exact: `T(d) = e^−τ(d)`.

use super::penumbra::{EVEN, differ};
use crate::Rgb;
use crate::math::transmittance::transmittance;

/// The least distance between corners, as a fraction of a ray's length: nearer ones are merged, so
/// that a ray keeps at most about twice as many as its inverse.
pub const FINEST: f32 = 1.0 / 256.0;
/// The distance between corners that are never merged, px.
pub const APART: f32 = 0.25;

/// A corner of the optical depth.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot {
    distance: f32,
    /// Up to this distance.
    optical_depth: Rgb,
    /// False if corners between the one before and this were merged that are not near the straight line.
    is_straight: bool,
}

/// The transmittance along all rays of a lamp, one after the other.
#[derive(Debug, Default)]
pub struct TransmittanceCurves {
    knots: Vec<Knot>,
    /// The first corner of each ray, and the end of the last.
    starts: Vec<u32>,
    /// Extinction of the last stretch.
    extinction: Rgb,
    apart: f32,
}

impl TransmittanceCurves {
    /// Returns the most bytes that a ray of `reach` px takes.
    pub fn most_bytes(reach: f32) -> usize {
        2 * (reach / apart(reach) + 2.0) as usize * size_of::<Knot>()
    }

    /// Drops all rays, for a lamp of this reach.
    pub fn clear(&mut self, reach: f32) {
        self.knots.clear();
        self.starts.clear();
        self.apart = apart(reach);
    }

    /// Starts the next ray; after the last ray, ends it.
    pub fn next_ray(&mut self) {
        self.starts.push(self.knots.len() as u32);
    }

    /// Adds a medium between two distances along the current ray.
    pub fn medium(&mut self, [from, to]: [f32; 2], extinction: Rgb) {
        let start = self.starts.last().map_or(0, |&s| s as usize);
        let depth_after =
            |before: Rgb| std::array::from_fn(|c| before[c] + extinction[c] * (to - from).max(0.0));
        let [.., before, last] = &mut self.knots[start..] else {
            self.knots.push(Knot { distance: from, optical_depth: [0.0; 3], is_straight: true });
            self.push(to, depth_after([0.0; 3]), extinction);
            return;
        };
        let depth = depth_after(last.optical_depth);
        if last.distance == from && self.extinction == extinction {
            (last.distance, last.optical_depth) = (to, depth);
            return;
        }
        if to - before.distance < self.apart {
            let line = |at: f32| {
                mix(before.optical_depth, depth, (at - before.distance) / (to - before.distance))
            };
            let is_near = |at: f32| !differ(line(at), last.optical_depth, EVEN);
            let is_straight = last.is_straight && is_near(last.distance) && is_near(from);
            *last = Knot { distance: to, optical_depth: depth, is_straight };
            // No medium goes on from here in a straight line.
            self.extinction = [f32::NAN; 3];
            return;
        }
        let known = *last;
        if known.distance < from {
            self.knots.push(Knot { distance: from, is_straight: true, ..known });
        }
        self.push(to, depth_after(known.optical_depth), extinction);
    }

    fn push(&mut self, distance: f32, optical_depth: Rgb, extinction: Rgb) {
        self.knots.push(Knot { distance, optical_depth, is_straight: true });
        self.extinction = extinction;
    }

    /// Returns whether no ray crosses a medium.
    pub fn is_empty(&self) -> bool {
        self.knots.is_empty()
    }

    /// Returns the transmittance up to a distance along a ray.
    pub fn transmittance(&self, ray: usize, distance: f32) -> Rgb {
        self.look_up(ray, distance).map_or([1.0; 3], |knot| knot.optical_depth.map(transmittance))
    }

    /// Returns the optical depth up to a distance along a ray; `None` where the ray does not know it.
    pub fn optical_depth(&self, ray: usize, distance: f32) -> Option<Rgb> {
        let Some(knot) = self.look_up(ray, distance) else { return Some([0.0; 3]) };
        knot.is_straight.then_some(knot.optical_depth)
    }

    /// Returns the place at a distance along a ray as a corner; `None` before all media.
    fn look_up(&self, ray: usize, distance: f32) -> Option<Knot> {
        let knots = &self.knots[self.starts[ray] as usize..self.starts[ray + 1] as usize];
        let after = knots.partition_point(|knot| knot.distance < distance);
        let before = knots[after.checked_sub(1)?];
        let Some(&Knot { distance: end, optical_depth, is_straight }) = knots.get(after) else {
            return Some(Knot { is_straight: true, ..before });
        };
        let part = (distance - before.distance) / (end - before.distance);
        let optical_depth = mix(before.optical_depth, optical_depth, part);
        Some(Knot { distance, optical_depth, is_straight })
    }
}

/// Returns the values at a part of the way from `a` to `b`.
fn mix(a: Rgb, b: Rgb, part: f32) -> Rgb {
    std::array::from_fn(|c| a[c] + (b[c] - a[c]) * part)
}

fn apart(reach: f32) -> f32 {
    (reach * FINEST).max(APART)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of a few f32 and the exponential's own error.
    const ROUNDING: f32 = 1e-5;

    fn near(found: Rgb, depth: f32) {
        let want = (-depth).exp();
        assert!(found.iter().all(|v| (v - want).abs() < ROUNDING), "{found:?} is not {want}");
    }

    #[test]
    fn transmittance_is_exact_within_media_and_behind() {
        let mut knots = TransmittanceCurves::default();
        knots.clear(64.0);
        knots.next_ray();
        knots.medium([3.0, 4.5], [0.2; 3]);
        knots.medium([4.5, 6.0], [0.2; 3]);
        knots.medium([6.0, 7.0], [1.0; 3]);
        knots.medium([9.0, 10.0], [0.5; 3]);
        knots.next_ray();
        knots.next_ray();
        assert_eq!(knots.knots.len(), 5, "one medium is one stretch");
        let want = [(2.0, 0.0), (4.0, 0.2), (6.0, 0.6), (6.5, 1.1), (8.0, 1.6), (9.5, 1.85)];
        for (distance, depth) in want {
            near(knots.transmittance(0, distance), depth);
        }
        near(knots.transmittance(0, 60.0), 2.1);
        assert_eq!(knots.transmittance(1, 60.0), [1.0; 3]);
    }

    #[test]
    fn a_long_ray_through_speckles_keeps_few_corners_and_all_of_its_depth() {
        let mut knots = TransmittanceCurves::default();
        let reach = 5000.0;
        knots.clear(reach);
        knots.next_ray();
        for i in 0..5000 {
            knots.medium([i as f32, i as f32 + 0.5], [1e-3 * (1 + i % 7) as f32; 3]);
        }
        knots.next_ray();
        assert!(knots.knots.len() * size_of::<Knot>() <= TransmittanceCurves::most_bytes(reach));
        let sum: f32 = (0..5000).map(|i| 0.5e-3 * (1 + i % 7) as f32).sum();
        near(knots.transmittance(0, reach), sum);
    }
}
