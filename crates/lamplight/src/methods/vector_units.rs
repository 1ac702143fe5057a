//! Tests that a method gives the same light on every available vector unit.

use crate::{Cells, Lamp, Matter, Rgb, Sky};
use fearless_simd::{Level, Simd};

/// Walls that emit and reflect, fog, stained glass, a sky and two lamps.
pub fn cells() -> Cells {
    let mut cells = Cells::new(61, 37).unwrap();
    for i in 0..cells.len() {
        let matter = match i % 61 {
            20..24 if i % 7 < 5 => Matter { opacity: 1.0, albedo: [0.7; 3], ..Matter::EMPTY },
            35..45 => Matter { opacity: 0.03, albedo: [0.5; 3], ..Matter::EMPTY },
            50 => Matter { tint: [0.9, 0.3, 0.1], ..Matter::EMPTY },
            8..13 if i / 61 % 16 < 4 => {
                Matter { emission: [3.0, 2.0, 1.0], opacity: 1.0, ..Matter::EMPTY }
            }
            _ => Matter::EMPTY,
        };
        cells.set_matter(i, matter);
    }
    cells.set_sky(Sky::Uniform([0.1, 0.2, 0.3]));
    for x in [15.3, 31.8] {
        cells.lamps_mut().push(Lamp { position: [x, 18.1], ..Lamp::default() });
    }
    cells
}

/// Holds the light of lesser units to that of the best; `tolerance` is relative, 0 for the same
/// bytes.
#[track_caller]
pub fn agree(tolerance: f32, solve: impl Fn(Level) -> Vec<Rgb>) {
    let best = Level::new();
    let light = solve(best);
    let mean = light.iter().flatten().sum::<f32>() / (3 * light.len()) as f32;
    assert!(mean > 0.0);
    // The other units that `dispatch_wide!` compiles for.
    let lesser = [best.as_sse2().map(Simd::level), best.as_avx2().map(Simd::level)];
    for level in lesser.into_iter().flatten() {
        let other = solve(level);
        let pairs = light.iter().flatten().zip(other.iter().flatten());
        let worst = pairs.map(|(a, b)| (a - b).abs() / (a.abs() + mean)).fold(0.0, f32::max);
        println!("{level:?} is {worst} from {best:?}");
        assert!(worst <= tolerance, "{level:?} is {worst} from {best:?}");
    }
}
