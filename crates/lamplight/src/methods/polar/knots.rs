//! Fog and glass along the rays of a lamp: what gets through, as a function of distance.
//!
//! Along a ray the logarithm of the transmittance is a polyline, straight within one matter. Its
//! knots are kept, so that a lookup between them is exact: `T(d) = e^(τ(d))`.

use crate::Rgb;
use crate::stages::transmittance::exp_negative;

/// A ray keeps at most about twice so many knots: nearer ones than this share of its reach melt
/// together.
pub const FINEST: f32 = 1.0 / 256.0;
/// px between knots that are always kept apart.
pub const APART: f32 = 0.25;

/// A corner of the polyline.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot {
    distance: f32,
    /// Natural logarithm of the transmittance up to here.
    log: Rgb,
}

/// The polylines of all rays of a lamp, one after the other.
#[derive(Debug, Default)]
pub struct Knots {
    knots: Vec<Knot>,
    /// First knot of each ray, and the end of the last.
    starts: Vec<u32>,
    /// The matter of the last stretch.
    matter: Rgb,
    apart: f32,
}

impl Knots {
    /// Bytes that a ray of a reach takes at most.
    pub fn most_bytes(reach: f32) -> usize {
        2 * (reach / apart(reach) + 2.0) as usize * size_of::<Knot>()
    }

    /// Starts over, for a lamp of this reach.
    pub fn clear(&mut self, reach: f32) {
        self.knots.clear();
        self.starts.clear();
        self.apart = apart(reach);
    }

    /// Starts the next ray; after the last ray, ends it.
    pub fn next_ray(&mut self) {
        self.starts.push(self.knots.len() as u32);
    }

    /// The ray at hand crosses matter between two distances.
    pub fn medium(&mut self, [from, to]: [f32; 2], log: Rgb) {
        let start = self.starts.last().map_or(0, |&s| s as usize);
        let through =
            |before: Rgb| std::array::from_fn(|c| before[c] + log[c] * (to - from).max(0.0));
        let [.., before, last] = &mut self.knots[start..] else {
            self.knots.push(Knot { distance: from, log: [0.0; 3] });
            self.push(to, through([0.0; 3]), log);
            return;
        };
        let same = last.distance == from && self.matter == log;
        if same || to - before.distance < self.apart {
            (last.distance, last.log) = (to, through(last.log));
            return;
        }
        let known = *last;
        if known.distance < from {
            self.knots.push(Knot { distance: from, ..known });
        }
        self.push(to, through(known.log), log);
    }

    fn push(&mut self, distance: f32, log: Rgb, matter: Rgb) {
        self.knots.push(Knot { distance, log });
        self.matter = matter;
    }

    /// Whether any ray crosses fog or glass.
    pub fn is_empty(&self) -> bool {
        self.knots.is_empty()
    }

    /// Share of light that gets through to a distance along a ray.
    pub fn through(&self, ray: usize, distance: f32) -> Rgb {
        let knots = &self.knots[self.starts[ray] as usize..self.starts[ray + 1] as usize];
        let after = knots.partition_point(|knot| knot.distance < distance);
        let log = match (after.checked_sub(1).map(|i| &knots[i]), knots.get(after)) {
            (None, _) => return [1.0; 3],
            (Some(last), None) => last.log,
            (Some(a), Some(b)) => {
                let share = (distance - a.distance) / (b.distance - a.distance);
                std::array::from_fn(|c| a.log[c] + (b.log[c] - a.log[c]) * share)
            }
        };
        log.map(exp_negative)
    }
}

fn apart(reach: f32) -> f32 {
    (reach * FINEST).max(APART)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of a few f32 and the exponential's own error.
    const ROUNDING: f32 = 1e-5;

    fn near(found: Rgb, log: f32) {
        let want = log.exp();
        assert!(found.iter().all(|v| (v - want).abs() < ROUNDING), "{found:?} is not {want}");
    }

    #[test]
    fn what_gets_through_is_exact_within_matter_and_behind() {
        let mut knots = Knots::default();
        knots.clear(64.0);
        knots.next_ray();
        knots.medium([3.0, 4.5], [-0.2; 3]);
        knots.medium([4.5, 6.0], [-0.2; 3]);
        knots.medium([6.0, 7.0], [-1.0; 3]);
        knots.medium([9.0, 10.0], [-0.5; 3]);
        knots.next_ray();
        knots.next_ray();
        assert_eq!(knots.knots.len(), 5, "one matter is one stretch");
        let want = [(2.0, 0.0), (4.0, -0.2), (6.0, -0.6), (6.5, -1.1), (8.0, -1.6), (9.5, -1.85)];
        for (distance, log) in want {
            near(knots.through(0, distance), log);
        }
        near(knots.through(0, 60.0), -2.1);
        assert_eq!(knots.through(1, 60.0), [1.0; 3]);
    }

    #[test]
    fn a_long_ray_through_speckles_keeps_few_knots_and_all_of_its_matter() {
        let mut knots = Knots::default();
        let reach = 5000.0;
        knots.clear(reach);
        knots.next_ray();
        for i in 0..5000 {
            knots.medium([i as f32, i as f32 + 0.5], [-1e-3 * (1 + i % 7) as f32; 3]);
        }
        knots.next_ray();
        assert!(knots.knots.len() * size_of::<Knot>() <= Knots::most_bytes(reach));
        let sum: f32 = (0..5000).map(|i| -0.5e-3 * (1 + i % 7) as f32).sum();
        near(knots.through(0, reach), sum);
    }
}
