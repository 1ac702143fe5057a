//! Questions about light.

use crate::common::*;
use lamplight::{Cells, Light, Matter, Rgb};

/// Sums of a few f32 in another order.
const ROUNDING: f32 = 1e-6;

/// 4×3 cells; light `[x, y, 1]` in cell (x, y), and a wall at (2, 1).
fn ramp() -> Light {
    let cells = grid(4, 3, |x, y| if [x, y] == [2, 1] { WALL } else { Matter::EMPTY });
    let rgb = (0..12).map(|i| [(i % 4) as f32, (i / 4) as f32, 1.0]).collect();
    Light::from_pixels(&cells, rgb).unwrap()
}

#[track_caller]
fn near(a: Rgb, b: Rgb) {
    let off = (0..3).any(|c| (a[c] - b[c]).abs() > ROUNDING * b[c].abs().max(1.0));
    assert!(!off, "{a:?} is not {b:?}");
}

#[test]
fn at_reads_cells_and_is_black_outside() {
    let light = ramp();
    assert_eq!((light.width(), light.height()), (4, 3));
    assert_eq!(light.at(3, 2), [3.0, 2.0, 1.0]);
    assert_eq!(light.at(2, 1), [2.0, 1.0, 1.0]);
    for (x, y) in [(4, 0), (0, 3), (u32::MAX, u32::MAX)] {
        assert_eq!(light.at(x, y), [0.0; 3]);
    }
}

#[test]
fn sample_is_linear_between_centres() {
    let light = ramp();
    assert_eq!(light.sample([0.5, 0.5]), [0.0, 0.0, 1.0]);
    near(light.sample([1.25, 0.5]), [0.75, 0.0, 1.0]);
    near(light.sample([1.0, 1.75]), [0.5, 1.25, 1.0]);
}

#[test]
fn sample_reads_only_open_cells_outside_walls_and_only_walls_inside() {
    let light = ramp();
    // Between (1, 1) and the wall (2, 1): only the open cell counts.
    near(light.sample([1.9, 1.5]), [1.0, 1.0, 1.0]);
    // Between four cells, the wall one of them: the mean of three.
    near(light.sample([2.0, 1.0 - 1e-6]), [4.0 / 3.0, 1.0 / 3.0, 1.0]);
    for inside in [[2.1, 1.1], [2.9, 1.5], [2.5, 1.99]] {
        near(light.sample(inside), [2.0, 1.0, 1.0]);
    }
}

#[test]
fn sample_does_not_look_past_the_corner_where_two_walls_touch() {
    for wall in [0, 1] {
        let cells = grid(2, 2, |x, y| if (x + y) % 2 == wall { WALL } else { Matter::EMPTY });
        let rgb = (0..4).map(|i| [i as f32; 3]).collect();
        let light = Light::from_pixels(&cells, rgb).unwrap();
        for cell in 0..4u32 {
            let [x, y] = [cell % 2, cell / 2];
            let beside_corner = [x as f32 * 0.02 + 0.99, y as f32 * 0.02 + 0.99];
            assert_eq!(light.sample(beside_corner), light.at(x, y), "cell {cell}");
        }
    }
}

#[test]
fn sample_outside_is_the_border_and_takes_any_number() {
    let light = ramp();
    assert_eq!(light.sample([-5.0, -1.0]), [0.0, 0.0, 1.0]);
    assert_eq!(light.sample([1e9, 99.0]), [3.0, 2.0, 1.0]);
    assert_eq!(light.sample([f32::MAX, f32::MAX]), [3.0, 2.0, 1.0]);
    assert_eq!(light.sample([f32::MIN, f32::MAX]), [0.0, 2.0, 1.0]);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(light.sample([bad, 1.0]), [0.0; 3]);
        assert_eq!(light.sample([1.0, bad]), [0.0; 3]);
    }
    assert_eq!(Light::default().sample([0.5, 0.5]), [0.0; 3]);
}

#[test]
fn over_is_the_mean_by_area_of_open_cells() {
    let light = ramp();
    near(light.over([0.0, 0.0], [1.0, 1.0]), [0.0, 0.0, 1.0]);
    near(light.over([0.0, 0.0], [2.0, 1.0]), [0.5, 0.0, 1.0]);
    // A quarter of one cell, three quarters of the next.
    near(light.over([0.75, 0.0], [1.75, 1.0]), [0.75, 0.0, 1.0]);
    // The wall and one open cell.
    near(light.over([1.0, 1.0], [3.0, 2.0]), [1.0, 1.0, 1.0]);
    // All of it, the wall left out, also from far outside.
    let all = [16.0 / 11.0, 11.0 / 11.0, 1.0];
    near(light.over([0.0, 0.0], [4.0, 3.0]), all);
    near(light.over([f32::NEG_INFINITY; 2], [f32::INFINITY; 2]), all);
}

#[test]
fn over_many_cells_is_as_exact_as_over_few() {
    let light = Light::in_the_open([2048, 2048], vec![[0.1; 3]; 2048 * 2048]).unwrap();
    near(light.over([0.0; 2], [2048.0; 2]), [0.1; 3]);
}

#[test]
fn over_is_black_without_open_cells() {
    let light = ramp();
    let nothing = [
        ([2.0, 1.0], [3.0, 2.0]),
        ([1.0, 1.0], [1.0, 1.0]),
        ([3.0, 2.0], [1.0, 1.0]),
        ([-9.0, -9.0], [-1.0, -1.0]),
        ([4.0, 3.0], [9.0, 9.0]),
        ([1e30, 1e30], [f32::MAX, f32::MAX]),
        ([0.0, 0.0], [f32::NAN, f32::NAN]),
    ];
    for (min, max) in nothing {
        assert_eq!(light.over(min, max), [0.0; 3], "{min:?} to {max:?}");
    }
    // NaN is not a radius; it must not panic.
    light.over([f32::NAN; 2], [2.0, 2.0]);
    assert_eq!(Light::default().over([0.0; 2], [9.0; 2]), [0.0; 3]);
}

#[test]
fn from_pixels_rejects_a_wrong_number_of_pixels() {
    let cells = grid(4, 3, |_, _| Matter::EMPTY);
    assert!(Light::from_pixels(&cells, vec![[0.0; 3]; 11]).is_err());
    assert!(Light::from_pixels(&cells, vec![[0.0; 3]; 12]).is_ok());
    assert!(Light::in_the_open([4, 3], vec![[0.0; 3]; 11]).is_err());
    assert!(Light::in_the_open([4, 0], Vec::new()).is_err());
}

#[test]
fn light_in_the_open_is_that_of_empty_cells() {
    let cells = grid(4, 3, |_, _| Matter::EMPTY);
    let rgb: Vec<_> = (0..12u8).map(|i| [f32::from(i); 3]).collect();
    let found = Light::in_the_open([4, 3], rgb.clone()).unwrap();
    assert_eq!(found, Light::from_pixels(&cells, rgb.clone()).unwrap());
    let walled = grid(4, 3, |x, _| if x == 0 { WALL } else { Matter::EMPTY });
    assert_ne!(found, Light::from_pixels(&walled, rgb).unwrap());
}

#[test]
fn nearest_open_light_of_a_wall() {
    // A wall of 3×3 cells in a grid of 7×5, and light that names its cell.
    let mut cells = Cells::new(7, 5).unwrap();
    for (x, y) in (2..5).flat_map(|x| (1..4).map(move |y| (x, y))) {
        cells.set(x, y, Matter { opacity: 1.0, ..Matter::EMPTY });
    }
    let rgb = (0..cells.len()).map(|i| [i as f32 + 1.0; 3]).collect();
    let light = Light::from_pixels(&cells, rgb).unwrap();
    let cell = |x: u32, y: u32| Some(light.at(x, y));
    assert_eq!(light.sample_open([2.2, 2.5]), cell(1, 2), "left of the wall");
    assert_eq!(light.sample_open([4.9, 2.5]), cell(5, 2), "right of the wall");
    assert_eq!(light.sample_open([3.5, 1.2]), cell(3, 0), "above the wall");
    assert_eq!(light.sample_open([1.5, 2.5]), Some(light.sample([1.5, 2.5])), "in the open");
    assert_eq!(light.sample_open([f32::NAN, 0.0]), None);
    // By brute force, from points all over the wall.
    for k in 0..100 {
        let at = [2.01 + 2.98 * (k % 10) as f32 / 9.0, 1.01 + 2.98 * (k / 10) as f32 / 9.0];
        let distance = |&i: &usize| {
            let centre = [(i % 7) as f32 + 0.5, (i / 7) as f32 + 0.5];
            (0..2).map(|a| (centre[a] - at[a]).powi(2)).sum::<f32>()
        };
        let open = (0..cells.len()).filter(|&i| !cells.is_solid(i));
        let least = open.map(|i| distance(&i)).fold(f32::MAX, f32::min);
        let found = light.sample_open(at).unwrap()[0] as usize - 1;
        assert!(!cells.is_solid(found) && distance(&found) == least, "{at:?}: cell {found}");
    }
    for x in 0..7 {
        (0..5).for_each(|y| cells.set(x, y, Matter { opacity: 1.0, ..Matter::EMPTY }));
    }
    let shut = Light::from_pixels(&cells, vec![[1.0; 3]; 35]).unwrap();
    assert_eq!(shut.sample_open([3.5, 2.5]), None, "no open cell");
}
