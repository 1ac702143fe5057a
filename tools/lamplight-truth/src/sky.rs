//! The radiance of panoramas by direction, and of inflow by place and direction, by code of its own.

use lamplight::{Cells, Inflow, Rgb, Sky};
use std::f64::consts::TAU;

/// Returns the radiance that a ray sees which starts in the grid and leaves it (y points down).
pub(crate) fn entering(cells: &Cells, origin: [f64; 2], direction: [f64; 2]) -> [f64; 3] {
    match cells.inflow() {
        Some(inflow) => at_border(inflow, origin, direction),
        None => radiance(cells.sky(), direction),
    }
}

fn radiance(sky: &Sky, direction: [f64; 2]) -> [f64; 3] {
    match sky {
        Sky::Panorama(panorama) => strip(panorama.columns(), f64::from(panorama.turn()), direction),
        sky => sky.radiance(direction.map(|d| d as f32)).map(f64::from),
    }
}

/// Two cells of the side through which the ray leaves have weight: 1 in the middle of a cell, falling to 0 at the
/// middles of its neighbours; half a cell before its end a side is even.
fn at_border(inflow: &Inflow, origin: [f64; 2], direction: [f64; 2]) -> [f64; 3] {
    let size = inflow.size().map(f64::from);
    let length = |a: usize| match direction[a] {
        0.0 => f64::INFINITY,
        d => (if d > 0.0 { size[a] } else { 0.0 } - origin[a]) / d,
    };
    // Through the left or right side, or through the top or bottom.
    let across = usize::from(length(1) < length(0));
    let far = direction[across] > 0.0;
    let along = origin[1 - across] + length(across) * direction[1 - across];
    let [columns, rows] = inflow.size().map(|side| side as usize);
    let (first, count) = match (across, far) {
        (1, false) => (0, columns),
        (0, true) => (columns, rows),
        (1, true) => (columns + rows, columns),
        _ => (2 * columns + rows, rows),
    };
    let place = (along - 0.5).clamp(0.0, count as f64 - 1.0);
    let mut light = [0.0; 3];
    for cell in [place.floor(), place.ceil()] {
        // The same cell twice counts half each.
        let weight = if place == place.floor() { 0.5 } else { 1.0 - (place - cell).abs() };
        let rgb = strip(inflow.strip(first + cell as usize), 0.0, direction);
        (0..3).for_each(|c| light[c] += weight * rgb[c]);
    }
    light
}

/// Two columns have weight: 1 in the middle of a column, falling to 0 at the middles of its neighbours.
fn strip(columns: &[Rgb], turn: f64, [x, y]: [f64; 2]) -> [f64; 3] {
    let count = columns.len() as f64;
    // The part of the circle, clockwise on the screen, from straight down to the direction.
    let clockwise = ((-x).atan2(y) - turn) / TAU;
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
    use lamplight::Panorama;

    #[test]
    fn a_strip_is_seen_down_left_up_right() {
        // The middles of four columns are at the lower left, the upper left, the upper right, the lower right.
        let columns = [[1.0; 3], [2.0; 3], [3.0; 3], [4.0; 3]];
        let panorama = Panorama::new(&columns).unwrap();
        let seen = |panorama: &Panorama, direction| {
            strip(panorama.columns(), f64::from(panorama.turn()), direction)[0]
        };
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

    #[test]
    fn inflow_is_read_where_a_ray_leaves() {
        let value = |[x, y]: [f32; 2], angle: f64| [x, y, 2.0 + angle.cos() as f32];
        let inflow = Inflow::new([7, 5], 720, |place, angle| value(place.at, angle)).unwrap();
        let origin = [3.0f64, 2.0];
        for step in 0..64 {
            let angle = TAU * (f64::from(step) + 0.3) / 64.0;
            let found = at_border(&inflow, origin, [angle.cos(), angle.sin()]);
            let reach = [7.0f64, 5.0].iter().zip(origin).zip([angle.cos(), angle.sin()]);
            let reach = reach.map(|((size, o), d)| (if d > 0.0 { size - o } else { -o }) / d);
            let length = reach.fold(f64::INFINITY, f64::min);
            // Beside corners the side is even.
            let inside = |at: f64, size: f64| at.clamp(0.5, size - 0.5);
            let [x, y] = [origin[0] + length * angle.cos(), origin[1] + length * angle.sin()];
            let leaves = |at: f64, size: f64| at.min(size - at).abs() < 1e-9;
            let expected = [
                if leaves(x, 7.0) { x } else { inside(x, 7.0) },
                if leaves(y, 5.0) { y } else { inside(y, 5.0) },
            ];
            for a in 0..2 {
                assert!((found[a] - expected[a]).abs() < 1e-5, "{angle}: {found:?}, {expected:?}");
            }
            assert!((found[2] - 2.0 - angle.cos()).abs() < 1e-4, "{angle}: {found:?}");
        }
    }
}
