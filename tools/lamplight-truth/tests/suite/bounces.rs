//! Light reflected by walls and scattered by fog, against closed forms and a dense solve.

use crate::common::*;
use lamplight::{Bounces, Cells, Matter, Sky};
use lamplight_truth::closed_forms::*;
use std::f64::consts::TAU;

const RHO: [f32; 3] = [0.25, 0.5, 0.9];

/// A closed room of odd shape: walls all round, a pillar and a nook.
fn room(wall: Matter, air: Matter) -> Cells {
    grid(23, 17, |x, y| {
        let border = x == 0 || y == 0 || x == 22 || y == 16;
        let pillar = inside([x, y], [8, 5], [11, 9]) || inside([x, y], [16, 1], [17, 12]);
        if border || pillar { wall } else { air }
    })
}

/// The compared cells: in the open, in the nook behind the partition, beside a wall,
/// and on a wall.
const PLACES: [[u32; 2]; 4] = [[4, 8], [19, 2], [1, 1], [0, 8]];

#[test]
fn a_furnace_is_the_same_everywhere_at_every_bounce() {
    let wall = Matter { emission: [1.0, 2.0, 0.5], albedo: RHO, ..WALL };
    let cells = room(wall, Matter::EMPTY);
    for k in [0, 1, 2, 7] {
        let expected = [0, 1, 2]
            .map(|c| furnace_mean_radiance(wall.emission[c].into(), RHO[c].into(), Some(k)));
        for at in PLACES {
            expect_rgb(&tracer(20_000, Bounces::Count(k)), &cells, at, expected, 0.05);
        }
    }
}

/// The specification's bound.
const FURNACE: f64 = 0.005;

#[test]
fn a_converged_furnace_is_right_to_half_a_percent() {
    let wall = Matter { emission: [1.0, 2.0, 0.5], albedo: RHO, ..WALL };
    let cells = room(wall, Matter::EMPTY);
    let all = tracer(1_000_000, Bounces::Converged).at(&cells, &PLACES).unwrap();
    for (at, estimate) in PLACES.iter().zip(all) {
        for c in 0..3 {
            let expected = furnace_mean_radiance(wall.emission[c].into(), RHO[c].into(), None);
            let off = f64::from(estimate.0[c]) / expected - 1.0;
            assert!(off.abs() < FURNACE, "{at:?}, channel {c}: {off:+.5}");
        }
    }
}

#[test]
fn white_walls_end() {
    let wall = Matter { emission: [0.5; 3], albedo: [1.0; 3], ..WALL };
    let cells = room(wall, Matter::EMPTY);
    // All paths are alike, to the last bit.
    let light = |bounces| tracer(64, bounces).at(&cells, &[[4, 8]]).unwrap()[0];
    assert_eq!(light(Bounces::Count(12)), ([6.5; 3], [0.0; 3]));
    let most = 0.5 * (Bounces::MAX + 1) as f32;
    assert_eq!(light(Bounces::Converged), ([most; 3], [0.0; 3]));
}

#[test]
fn a_fog_furnace_has_no_fog_in_it() {
    // Walls and coloured fog with the same E and ρ: light is the same everywhere, whatever the
    // fog's thickness. That takes every weight of scattering being right.
    let emission = [0.75, 0.5, 0.1];
    let wall = Matter { emission, albedo: RHO, ..WALL };
    let fog =
        Matter { emission, albedo: RHO, opacity: 0.125, tint: [1.0, 0.75, 0.5], ..Matter::EMPTY };
    let cells = room(wall, fog);
    for k in [0, 1, 3] {
        let expected =
            [0, 1, 2].map(|c| furnace_mean_radiance(emission[c].into(), RHO[c].into(), Some(k)));
        for at in PLACES {
            expect_rgb(&tracer(40_000, Bounces::Count(k)), &cells, at, expected, 0.05);
        }
    }
    let expected =
        [0, 1, 2].map(|c| furnace_mean_radiance(emission[c].into(), RHO[c].into(), None));
    for at in PLACES {
        expect_rgb(&tracer(100_000, Bounces::Converged), &cells, at, expected, 0.05);
    }
}

#[test]
fn a_floor_reflects_the_sky_once() {
    // A floor under a uniform sky receives all of it, whatever lies below it.
    let wall = Matter { albedo: RHO, emission: [0.0, 0.0, 0.125], ..WALL };
    let mut cells =
        grid(41, 20, |x, y| if inside([x, y], [3, 15], [38, 18]) { wall } else { Matter::EMPTY });
    cells.set_sky(Sky::Uniform([0.5; 3]));
    for at in [[20, 14], [0, 19], [30, 2]] {
        let seen = rect_mean_radiance(1.0, centre(at), [3.0, 15.0], [38.0, 18.0]);
        let expected = [0, 1, 2].map(|c| {
            let outgoing = f64::from(wall.emission[c]) + f64::from(RHO[c]) * 0.5;
            (1.0 - seen) * 0.5 + seen * outgoing
        });
        // A convex thing never lights itself: one bounce is all there is.
        for bounces in [Bounces::Count(1), Bounces::Converged] {
            expect_rgb(&tracer(40_000, bounces), &cells, at, expected, 0.02);
        }
    }
}

#[test]
fn a_floor_reflects_the_light_of_a_strip() {
    // A strip of light above a floor; a cell beside them sees the strip and the floor lit by it.
    let floor = Matter { albedo: RHO, ..WALL };
    let cells = grid(81, 31, |x, y| match (x, y) {
        (35..45, 3) => GLOW,
        (_, 30) => floor,
        _ => Matter::EMPTY,
    });
    // B at x on the floor: the sines to the ends of the strip's outline, which shows one end.
    let received = |x: f64| {
        let (left, right) =
            (if x < 35.0 { 27.0 } else { 26.0 }, if x > 45.0 { 27.0 } else { 26.0 });
        let sin = |to: f64, up: f64| (to - x) / (to - x).hypot(up);
        0.5 * (sin(45.0, right) - sin(35.0, left))
    };
    for at in [[20, 20], [70, 27], [40, 12]] {
        let [x, y] = centre(at);
        let angle = |to: f64| ((to - x) / (30.0 - y)).atan();
        let lit = integral(angle(0.0), angle(81.0), |a| received(x + (30.0 - y) * a.tan())) / TAU;
        let strip = rect_mean_radiance(1.0, [x, y], [35.0, 3.0], [45.0, 4.0]);
        let expected = RHO.map(|rho| strip + f64::from(rho) * lit);
        expect_rgb(&tracer(400_000, Bounces::Count(1)), &cells, at, expected, 0.03);
        assert!(expected[2] > 1.2 * strip, "the floor shows");
    }
}

/// A disc of r = 10 drawn in cells subtends up to 8 % more than its radius.
const MORE: f64 = 1.08;

/// Albedo of a staircase of faces in place of a slope of 45°: each face sees the next step with
/// 1 − 1/√2 of its view, and light that it reflects there may be reflected again. Flat parts of the ring keep
/// the albedo itself, so the drawn ring lies in between.
fn staircase(a: f64) -> f64 {
    let out = std::f64::consts::FRAC_1_SQRT_2;
    a * out / (1.0 - a * (1.0 - out))
}

#[test]
fn a_disc_in_a_diffuse_ring() {
    let (r1, ring, a, middle) = (10.0, 50.0, 0.7, 54.5);
    let matter = Matter { albedo: [0.7; 3], ..WALL };
    let cells = grid(109, 109, |x, y| {
        let [x, y] = centre([x, y]);
        let d = (x - middle).hypot(y - middle);
        if d < r1 {
            GLOW
        } else if d > ring {
            matter
        } else {
            Matter::EMPTY
        }
    });
    for at in [[54 + 20, 54], [54, 54 - 30], [54 - 26, 54 + 26]] {
        let [x, y] = centre(at);
        let d = (x - middle).hypot(y - middle);
        let (mean, error) = tracer(100_000, Bounces::Converged).at(&cells, &[at]).unwrap()[0];
        let least = ring_mean_radiance(1.0, r1, ring, staircase(a), d);
        let most = ring_mean_radiance(1.0, MORE * r1, ring, a, d);
        let mean = f64::from(mean[0]);
        assert!(f64::from(error[0]) < 0.005 * mean);
        assert!((least..most).contains(&mean), "{at:?}: {mean} is not in {least} to {most}");
    }
}

/// Radiance from one direction at a point of a grid without walls, by cutting the ray at every grid
/// line: no code shared with the path tracer. `source` is S of each cell.
fn along_ray(
    cells: &Cells,
    source: &[[f64; 3]],
    origin: [f64; 2],
    direction: [f64; 2],
    sky: f64,
) -> [f64; 3] {
    let sides = [cells.width(), cells.height()];
    let mut cuts = vec![0.0];
    for axis in 0..2 {
        cuts.extend(
            (0..=sides[axis])
                .map(|line| (f64::from(line) - origin[axis]) / direction[axis])
                .filter(|&t| t > 0.0 && t < 1e3),
        );
    }
    cuts.sort_by(f64::total_cmp);
    let (mut light, mut weight) = ([0.0; 3], [1.0; 3]);
    for pair in cuts.windows(2) {
        let middle = (pair[0] + pair[1]) / 2.0;
        let [x, y] = [0, 1].map(|a| (origin[a] + middle * direction[a]).floor());
        if x < 0.0 || y < 0.0 || x >= f64::from(sides[0]) || y >= f64::from(sides[1]) {
            break;
        }
        let i = cells.index(x as u32, y as u32);
        for c in 0..3 {
            let px = (1.0 - f64::from(cells.opacity()[i])) * f64::from(cells.tint()[i][c]);
            let length = pair[1] - pair[0];
            let t = px.powf(length);
            light[c] += weight[c] * (1.0 - t) * source[i][c];
            let glow = cells.glow().map_or(0.0, |glow| f64::from(glow[i][c]));
            light[c] += weight[c] * glow * if px == 1.0 { length } else { (t - 1.0) / px.ln() };
            weight[c] *= t;
        }
    }
    [0, 1, 2].map(|c| light[c] + weight[c] * sky)
}

/// Mean radiance of every cell after `bounces`, by iterating S = E + ρJ over the cells with evenly spaced
/// directions: the definition of scattering, taken literally.
fn solve(cells: &Cells, bounces: u32, sky: f64) -> Vec<[f64; 3]> {
    const DIRECTIONS: u32 = 4000;
    let mut mean_radiance = vec![[0.0; 3]; cells.len()];
    for k in 0..=bounces {
        let source: Vec<[f64; 3]> = (0..cells.len())
            .map(|i| {
                let m = cells.matter(i);
                [0, 1, 2].map(|c| {
                    let scattered =
                        if k > 0 { f64::from(m.albedo[c]) * mean_radiance[i][c] } else { 0.0 };
                    f64::from(m.emission[c]) + scattered
                })
            })
            .collect();
        for y in 0..cells.height() {
            for x in 0..cells.width() {
                let mut sum = [0.0; 3];
                for d in 0..DIRECTIONS {
                    let (sin, cos) = ((f64::from(d) + 0.5) / f64::from(DIRECTIONS) * TAU).sin_cos();
                    let light = along_ray(cells, &source, centre([x, y]), [cos, sin], sky);
                    (0..3).for_each(|c| sum[c] += light[c] / f64::from(DIRECTIONS));
                }
                mean_radiance[cells.index(x, y)] = sum;
            }
        }
    }
    mean_radiance
}

#[test]
fn fog_scatters_from_the_centre_of_its_cells() {
    // Coloured fog of one kind in the left part (crossed in squares), of many in the right one
    // (crossed cell by cell), a bright cell of fog, and an empty column that glows; under a sky.
    let mut cells = grid(9, 7, |x, y| match (x, y) {
        (5, _) => Matter { glow: [0.2, 0.0, 0.1], ..Matter::EMPTY },
        (0..5, y) => Matter {
            opacity: 0.25,
            // Below, red is stopped at once, and scattered.
            tint: [if y < 4 { 1.0 } else { 0.0 }, 0.75, 0.25],
            albedo: [0.9, 0.6, 0.8],
            emission: [0.0, 0.1, 0.05],
            glow: [0.3, 0.0, 0.1],
        },
        (7, 3) => Matter { opacity: 0.75, emission: [4.0, 2.0, 1.0], ..Matter::EMPTY },
        _ => Matter {
            opacity: 0.02 * (x + 9 * y) as f32 / 4.0,
            tint: [0.5, 1.0, 0.9],
            albedo: [0.25 + 0.1 * (y as f32), 1.0, 0.5],
            ..Matter::EMPTY
        },
    });
    cells.set_sky(Sky::Uniform([0.25; 3]));
    let places = [[0, 0], [2, 3], [4, 6], [5, 2], [7, 3], [8, 0]];
    for k in [0, 1, 3] {
        let solved = solve(&cells, k, 0.25);
        for at in places {
            let expected = solved[cells.index(at[0], at[1])];
            expect_rgb(&tracer(200_000, Bounces::Count(k)), &cells, at, expected, 0.05);
        }
    }
    // The comparison notices one bounce more.
    let (three, four) = (solve(&cells, 3, 0.25), solve(&cells, 4, 0.25));
    let at = cells.index(2, 3);
    let estimate = tracer(200_000, Bounces::Count(3)).at(&cells, &[[2, 3]]).unwrap()[0];
    assert_eq!(judge(estimate, 200_000, three[at], 0.05), Ok(()));
    assert!(judge(estimate, 200_000, four[at], 0.05).is_err());
}
