//! The radiance of panoramas by direction, by code of its own.

use lamplight::{Panorama, Sky};
use std::f64::consts::TAU;

/// Returns the radiance that a ray of this direction sees (y points down).
pub(crate) fn radiance(sky: &Sky, direction: [f64; 2]) -> [f64; 3] {
    match sky {
        Sky::Panorama(panorama) => strip(panorama, direction),
        sky => sky.radiance(direction.map(|d| d as f32)).map(f64::from),
    }
}

/// Two columns have weight: 1 in the middle of a column, falling to 0 at the middles of its neighbours.
fn strip(panorama: &Panorama, [x, y]: [f64; 2]) -> [f64; 3] {
    let columns = panorama.columns();
    let count = columns.len() as f64;
    // The part of the circle, clockwise on the screen, from straight down to the direction.
    let clockwise = ((-x).atan2(y) - f64::from(panorama.turn())) / TAU;
    let place = clockwise.rem_euclid(1.0) * count - 0.5;
    let mut light = [0.0; 3];
    for column in [place.floor(), place.floor() + 1.0] {
        let weight = 1.0 - (place - column).abs();
        let rgb = columns[column.rem_euclid(count) as usize];
        (0..3).for_each(|c| light[c] += weight * f64::from(rgb[c]));
    }
    light
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_is_seen_down_left_up_right() {
        // The middles of four columns are at the lower left, the upper left, the upper right, the lower right.
        let columns = [[1.0; 3], [2.0; 3], [3.0; 3], [4.0; 3]];
        let panorama = Panorama::new(&columns).unwrap();
        let seen = |panorama: &Panorama, direction| strip(panorama, direction)[0];
        let diagonals = [[-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]];
        for (i, direction) in diagonals.into_iter().enumerate() {
            let expected = f64::from(columns[i][0]);
            assert!((seen(&panorama, direction) - expected).abs() < 1e-12, "{direction:?}");
            // A quarter turn brings what was in the column before.
            let turned = panorama.clone().turned(std::f32::consts::FRAC_PI_2);
            let before = f64::from(columns[(i + 3) % 4][0]);
            assert!((seen(&turned, direction) - before).abs() < 1e-6, "{direction:?} turned");
        }
        // Straight up, between two columns.
        assert!((seen(&panorama, [0.0, -1.0]) - 2.5).abs() < 1e-12);
        // Across the ends.
        assert!((seen(&panorama, [0.0, 1.0]) - 2.5).abs() < 1e-12);
    }
}
