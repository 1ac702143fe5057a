//! The light that solid cells show.

use crate::common::*;
use lamplight::internals::Walls;
use lamplight::{Bounces, Cells, Light, Matter, Rgb, Sky};

/// Sums of some f32 in another order, relative.
const ROUNDING: f64 = 1e-5;

/// The light of walls whose faces receive `irradiance` (E/2) at their middle, by their normal.
fn sunk(
    cells: &Cells,
    depth: f32,
    irradiance: impl Fn([f32; 2], [i32; 2]) -> f32,
) -> Vec<Vec<f32>> {
    let mut light = faces(cells, irradiance);
    Walls::default().sink(cells, depth, &mut light);
    light.chunks(cells.width() as usize).map(|row| row.iter().map(|v| v[0]).collect()).collect()
}

/// The mean over the faces of each cell.
fn faces(cells: &Cells, irradiance: impl Fn([f32; 2], [i32; 2]) -> f32) -> Vec<Rgb> {
    let [w, h] = [cells.width() as i32, cells.height() as i32];
    let open = |[x, y]: [i32; 2]| {
        let inside = (0..w).contains(&x) && (0..h).contains(&y);
        inside && !cells.is_solid((y * w + x) as usize)
    };
    let of_cell = |i: i32| {
        let at = [i % w, i / w];
        let sides = [[-1, 0], [1, 0], [0, -1], [0, 1]];
        let sides = sides.into_iter().filter(|side| open([at[0] + side[0], at[1] + side[1]]));
        let middle = |side: [i32; 2]| [0, 1].map(|a| at[a] as f32 + 0.5 + 0.5 * side[a] as f32);
        let received: Vec<f32> = sides.map(|side| irradiance(middle(side), side)).collect();
        let mean = received.iter().sum::<f32>() / received.len().max(1) as f32;
        if open(at) { [0.0; 3] } else { [mean; 3] }
    };
    (0..w * h).map(of_cell).collect()
}

fn solid(width: u32, height: u32, is_solid: impl Fn(u32, u32) -> bool) -> Cells {
    grid(width, height, |x, y| if is_solid(x, y) { WALL } else { Matter::EMPTY })
}

/// A block of 11×11 solid cells under a sky of 0.5; `x` cells deep is cell (5 + x, 10).
fn block(wall: Matter, depth: f32) -> Light {
    let mut cells = grid(21, 21, |x, y| {
        let solid = (5..16).contains(&x) && (5..16).contains(&y);
        if solid { wall } else { Matter::EMPTY }
    });
    cells.set_sky(Sky::Uniform([0.5; 3]));
    solve(&settings(|s| s.wall_depth = depth), &cells)
}

#[test]
fn walls_show_their_faces_only_when_the_depth_is_0() {
    let light = block(WALL, 0.0);
    assert_eq!(light.at(5, 10), [0.5; 3]);
    assert_eq!(light.at(10, 15), [0.5; 3]);
    for (x, y) in (6..15).flat_map(|x| (6..15).map(move |y| (x, y))) {
        assert_eq!(light.at(x, y), [0.0; 3], "({x}, {y})");
    }
    // And each of them its own: light does not spread along the surface either.
    let stripes = sunk(&solid(9, 9, |_, y| y > 4), 0.0, |[x, _], _| x.floor() % 2.0);
    assert_eq!(stripes[5], [0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
}

/// The error of the depth that follows from blurs at octaves, in px and relative.
const OCTAVES: [f32; 2] = [0.3, 0.06];

#[test]
fn light_fades_into_a_straight_wall_over_the_depth() {
    let cells = solid(256, 300, |_, y| y >= 150);
    for depth in [1.0, 4.0, 8.0, 20.0, 64.0f32] {
        let light = sunk(&cells, depth, |_, _| 0.5);
        let light: Vec<f32> = light[150..].iter().map(|row| row[100]).collect();
        assert!((light[0] - 0.5).abs() < 1e-6, "even faces do not change");
        let mut worst: f32 = 0.0;
        for k in 1..light.len() {
            let (before, here) = (light[k - 1], light[k]);
            let left = (1.0 - k as f32 / (depth + 1.0)).max(0.0);
            let expected = left * left * (3.0 - 2.0 * left);
            let off = (here / 0.5 - expected).abs();
            worst = worst.max(off);
            // The fade falls by at most 1.5 ÷ its length per px.
            let allowed = (OCTAVES[0] + OCTAVES[1] * k as f32) * 1.5 / (depth + 1.0);
            assert!(off < allowed, "depth {depth}, {k} px in: {here}, not {}", 0.5 * expected);
            assert!(here < before || here == 0.0, "depth {depth}, {k} px in");
        }
        println!("depth {depth}: {worst:.3} off");
        assert_eq!(light[2 + (1.2 * depth) as usize], 0.0, "depth {depth}");
    }
}

/// The largest second difference along rows and columns, over cells that are at least `margin` px inside a
/// box.
fn sharpest_ridge(light: &[Vec<f32>], [min, max]: [usize; 2], margin: usize) -> f32 {
    let inside = min + margin..max - margin;
    let at = |x: usize, y: usize| {
        let across = light[y][x - 1] - 2.0 * light[y][x] + light[y][x + 1];
        let down = light[y - 1][x] - 2.0 * light[y][x] + light[y + 1][x];
        across.abs().max(down.abs())
    };
    inside.clone().flat_map(|y| inside.clone().map(move |x| at(x, y))).fold(0.0, f32::max)
}

/// The sharpest ridge, as a fraction of that of a hip roof.
const RIDGE: f32 = 1.0 / 3.0;

#[test]
fn a_box_has_no_ridges() {
    const BOX: [usize; 2] = [20, 77];
    let inside = |v: u32| (BOX[0]..BOX[1]).contains(&(v as usize));
    let cells = solid(97, 97, |x, y| inside(x) && inside(y));
    // All sides alike, or one bright.
    for others in [1.0, 0.2f32] {
        let side = |normal: [i32; 2]| if normal == [-1, 0] { 1.0 } else { others };
        let light = sunk(&cells, 20.0, |_, normal| side(normal));
        // The light of the nearest side: a hip roof.
        let roof = |x: usize, y: usize| {
            let sides = [
                (x - BOX[0], [-1, 0]),
                (BOX[1] - 1 - x, [1, 0]),
                (y - BOX[0], [0, -1]),
                (BOX[1] - 1 - y, [0, 1]),
            ];
            let (behind, normal) = sides.into_iter().min_by_key(|(behind, _)| *behind).unwrap();
            side(normal) * (1.0 - behind as f32 / 21.0).max(0.0)
        };
        let mut hip_roof = light.clone();
        for (x, y) in (BOX[0]..BOX[1]).flat_map(|x| (BOX[0]..BOX[1]).map(move |y| (x, y))) {
            hip_roof[y][x] = roof(x, y);
        }
        let (found, roof) = (sharpest_ridge(&light, BOX, 5), sharpest_ridge(&hip_roof, BOX, 5));
        println!("sides of {others}: ridges of {found:.4}, a hip roof {roof:.4}");
        assert!(found < RIDGE * roof, "sides of {others}: {found}");
    }
}

/// The largest difference between a cell and the mean of the four beside it, in a row that follows the
/// surface `below` px under it, ÷ the mean.
fn zebra(light: &[Vec<f32>], surface: &[usize], below: usize) -> f32 {
    let row: Vec<f32> = (20..100).map(|x| light[surface[x] + below][x]).collect();
    let mean = row.iter().sum::<f32>() / row.len() as f32;
    let stripe = |w: &[f32]| (w[2] - (w[0] + w[1] + w[3] + w[4]) / 4.0).abs();
    row.windows(5).map(stripe).fold(0.0, f32::max) / mean
}

/// The strongest stripe: the steps of the slope are 1 or 2 px long.
const STRIPE: f32 = 0.12;

#[test]
fn a_slope_has_no_stripes() {
    let height = |x: u32| 80.0 - 30f32.to_radians().tan() * (x as f32 + 0.5);
    let cells = solid(120, 120, |x, y| y as f32 + 0.5 > height(x));
    // Steps are lit from above and dark on their other face.
    let lit = |_: [f32; 2], normal: [i32; 2]| if normal == [0, -1] { 1.0 } else { 0.0 };
    let surface: Vec<usize> =
        (0..120).map(|x| (0..120).find(|y| cells.is_solid(y * 120 + x)).unwrap()).collect();
    let light = sunk(&cells, 20.0, lit);
    for below in 0..12 {
        let stripe = zebra(&light, &surface, below);
        println!("{below} px below: stripes of {stripe:.3}");
        assert!(stripe < STRIPE, "{below} px below: {stripe}");
    }
    let faces = faces(&cells, lit);
    let faces: Vec<Vec<f32>> =
        faces.chunks(120).map(|row| row.iter().map(|v| v[0]).collect()).collect();
    assert!(zebra(&faces, &surface, 0) > 4.0 * STRIPE, "the light of single faces passes");
}

#[test]
fn shadows_on_a_wall_are_blurred_by_two_px() {
    let light = sunk(&solid(64, 40, |_, y| y > 20), 20.0, |[x, _], _| f32::from(x > 32.0));
    assert_eq!((light[21][29], light[21][34]), (0.0, 1.0));
    let at = |y: usize| (light[y][26], light[y][37]);
    let (dark, lit) = at(25);
    assert!(dark > 0.0 && lit < 1.0, "and a wider one inside");
}

#[test]
fn the_dark_side_of_a_wall_stays_dark() {
    for thickness in 2..12 {
        let cells = solid(64, 40, |x, _| (20..20 + thickness).contains(&x));
        let light = sunk(&cells, 20.0, |_, normal| f32::from(normal[0] < 0));
        for row in &light {
            let wall = &row[20..20 + thickness as usize];
            assert!((wall[0] - 1.0).abs() < 1e-6 && wall[wall.len() - 1] == 0.0, "{wall:?}");
            assert!(wall.is_sorted_by(|a, b| a > b), "{wall:?}");
        }
    }
    // One px has both sides.
    let light = sunk(&solid(64, 40, |x, _| x == 20), 20.0, |_, normal| f32::from(normal[0] < 0));
    assert!((light[9][20] - 0.5).abs() < 1e-6);
}

/// The largest difference to the mirrored light, as a fraction of the light on faces: the grids of the
/// pyramid begin on the left.
const MIRRORED: f32 = 0.03;

#[test]
fn a_symmetric_scene_has_symmetric_light() {
    for width in [64, 97, 150u32] {
        let middle = |x: u32| x.abs_diff(width - 1 - x);
        let cells = solid(width, 80, |x, y| y > 50 || y > 20 && middle(x) < 41 || middle(x) < 3);
        let light = sunk(&cells, 20.0, |_, normal| if normal[1] < 0 { 1.0 } else { 0.4 });
        let mut worst: f32 = 0.0;
        for row in &light {
            for (a, b) in row.iter().zip(row.iter().rev()) {
                worst = worst.max((a - b).abs());
            }
        }
        println!("{width} px wide: {worst:.4}");
        assert!(worst < MIRRORED, "{width} px wide: {worst}");
    }
}

#[test]
fn emission_is_added_to_the_light_on_walls() {
    let glow = Matter { emission: [0.0, 0.25, 8.0], ..WALL };
    for depth in [0.0, 3.0] {
        let (dark, light) = (block(WALL, depth), block(glow, depth));
        for i in (0..21 * 21).filter(|&i| dark.solid()[i]) {
            assert_eq!(light.pixels()[i][0], dark.pixels()[i][0], "cell {i}");
            for (c, emission) in [(1, 0.25), (2, 8.0)] {
                let expected = f64::from(dark.pixels()[i][c]) + emission;
                near(light.pixels()[i][c], expected, ROUNDING);
            }
        }
    }
}

/// The scene of a bug report: the floor under a strip of light was black.
#[test]
fn a_strip_of_light_lights_the_floor_under_it() {
    let strip = Matter { emission: [4.0, 3.0, 1.0], ..WALL };
    let floor = Matter { albedo: [0.6; 3], ..WALL };
    let cells = grid(160, 90, |x, y| match (x, y) {
        (60..100, 59) => strip,
        (_, 60..) => floor,
        _ => Matter::EMPTY,
    });
    let settings = settings(|s| {
        (s.bounces, s.wall_depth) = (Bounces::Count(2), 20.0);
        raymarch_of(s).rays = 64;
    });
    let light = solve(&settings, &cells);
    let [red, green, _] = light.at(80, 62);
    assert!(red > 2.0 && red < 4.0 && green > 1.5, "{red} {green}");
    let column: Vec<f32> = (59..90).map(|y| light.at(80, y)[0]).collect();
    assert!(column.is_sorted_by(|a, b| a > b || *b == 0.0), "{column:?}");
    assert!(column[20] < 0.4 && column[26] == 0.0, "{column:?}");
    // The strip itself shows its emission.
    assert!(light.at(80, 59)[0] >= 4.0 && light.at(80, 59)[0] < 4.1);
}

/// The part of the emission that sinks into a cell under a face, which sinks into the one with the face too.
const WITH_FACE: f32 = 0.6;

#[test]
fn beside_a_strip_of_light_the_surface_of_the_floor_is_no_dark_line() {
    let strip = Matter { emission: [1.0; 3], ..WALL };
    let cells = grid(160, 90, |x, y| match (x, y) {
        (60..100, 59) => strip,
        (_, 60..) => WALL,
        _ => Matter::EMPTY,
    });
    let light = sunk(&cells, 20.0, |_, _| 0.0);
    for x in 40..60 {
        let [face, below] = [light[60][x], light[61][x]];
        assert!(face > WITH_FACE * below && below > 0.0, "column {x}: {face}, {below} below");
        assert!(light[60][x + 1] > face, "column {x} is as bright as the next");
    }
}

#[test]
fn a_single_cell_of_light_glows_in_a_wall() {
    // In its surface, and without a face.
    for (y, reach) in [(20, 5), (30, 3)] {
        let cells = grid(64, 64, |x, to_y| match (x, to_y) {
            (_, ..20) => Matter::EMPTY,
            (x, to_y) if [x, to_y] == [32, y] => GLOW,
            _ => WALL,
        });
        let light = sunk(&cells, 20.0, |_, _| 0.0);
        let column: Vec<f32> = light[y as usize..].iter().map(|row| row[32]).collect();
        assert_eq!(column[0], 1.0);
        assert!(column.is_sorted_by(|a, b| a > b || *b == 0.0), "{column:?}");
        assert!(column[1] > 0.2 && column[reach] > 0.02 && column[15] < 0.02, "{column:?}");
    }
}

#[test]
fn a_grid_full_of_walls_shows_its_emission() {
    let full = |emission: fn(u32) -> Rgb| {
        let cells = grid(5, 4, |x, _| Matter { emission: emission(x), ..WALL });
        solve(&settings(|s| s.wall_depth = 8.0), &cells)
    };
    let brighter = full(|x| [x as f32, 2.0, 0.0]);
    for (x, y) in (0..5).flat_map(|x| (0..4).map(move |y| (x, y))) {
        let [red, green, blue] = brighter.at(x, y);
        assert!(red >= x as f32 && red <= 4.0 && blue == 0.0, "({x}, {y}): {red}");
        near(green, 2.0, ROUNDING);
    }
    assert!(full(|_| [0.0; 3]).pixels().iter().all(|light| *light == [0.0; 3]));
}

#[test]
fn every_size_and_depth_is_finite() {
    let mut walls = Walls::default();
    for [width, height] in [[1, 1], [1, 9], [9, 1], [2, 3], [33, 17], [64, 65], [5, 5]] {
        for depth in [64.0, 0.0, 0.1, 7.0] {
            let cells = jumble(width, height, 5);
            let mut light = faces(&cells, |_, _| 0.5);
            let bright = cells.emission().as_flattened().iter().fold(0.5, |a: f32, b| a + b);
            walls.sink(&cells, depth, &mut light);
            let mut fresh = faces(&cells, |_, _| 0.5);
            Walls::default().sink(&cells, depth, &mut fresh);
            assert_eq!(light, fresh, "{width}×{height}, depth {depth}: buffers of another size");
            assert!(light.as_flattened().iter().all(|v| (0.0..=bright).contains(v)));
        }
    }
}
