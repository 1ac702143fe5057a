//! Lamps to light cells with.

use crate::common::Sampler;
use lamplight::{Cone, Falloff, Lamp};

/// Random lamps, in the grid and a little beyond, some with a cone.
pub fn lamps(width: u32, height: u32, count: u32, seed: u64) -> Vec<Lamp> {
    let mut sampler = Sampler::new(seed);
    let falloffs = [Falloff::Linear, Falloff::Smooth, Falloff::Inverse];
    let lamp = |i| {
        let [x, y] = [width, height].map(|side| (1.2 * sampler.unit() - 0.1) * side as f32);
        let cone = Cone {
            direction: 6.0 * sampler.unit() - 3.0,
            angle: 0.2 + 4.0 * sampler.unit(),
            softness: [0.0, 0.5, 1.0][sampler.below(3) as usize],
        };
        Lamp {
            // Every third in the middle of a cell, every third on a corner: there rays meet ties.
            position: match i % 3 {
                0 => [x, y],
                1 => [x.floor() + 0.5, y.floor() + 0.5],
                _ => [x.floor(), y.floor()],
            },
            color: std::array::from_fn(|_| sampler.unit()),
            intensity: 3.0 * sampler.unit(),
            range: 1.0 + 90.0 * sampler.unit(),
            size: 0.05 + 4.0 * sampler.unit(),
            falloff: falloffs[sampler.below(3) as usize],
            cone: (sampler.below(3) == 0).then_some(cone),
        }
    };
    (0..count).map(lamp).collect()
}
