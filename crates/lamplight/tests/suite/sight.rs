//! Visibility from viewers, as a query and as a field.

use crate::common::{WALL, grid, rgb, seeded};
use lamplight::srgb::luminance;
use lamplight::{Cells, Cone, Error, Lamp, Matter, Profile, Sight, SightSolver};

/// The largest error of a closed form: the eye is a segment across the line of sight instead of a disc, and rays through
/// media are cast to a few of its points.
const EXACT: f32 = 0.01;

fn solver(cells: &Cells) -> SightSolver {
    let mut solver = SightSolver::default();
    solver.read(cells).unwrap();
    solver
}

fn eye(position: [f32; 2]) -> Sight {
    Sight { position, fade: 0.0, ..Sight::default() }
}

/// The visibility of a point.
fn seen(cells: &Cells, sight: &Sight, point: [f32; 2]) -> f32 {
    solver(cells).visibility(sight, point).unwrap()
}

fn empty(width: u32, height: u32) -> Cells {
    Cells::new(width, height).unwrap()
}

/// A wall with an opening: a closed room of 20×20 px in the middle of a grid.
fn room() -> Cells {
    let in_room = |v: u32| (20..40).contains(&v);
    let in_wall = |v: u32| (18..42).contains(&v);
    grid(61, 61, |x, y| {
        let walls = in_wall(x) && in_wall(y) && !(in_room(x) && in_room(y));
        if walls { WALL } else { Matter::EMPTY }
    })
}

#[test]
fn behind_the_edge_of_a_wall_the_eye_sets_as_by_similar_triangles() {
    let cells = grid(160, 120, |x, y| if x == 60 && y < 50 { WALL } else { Matter::EMPTY });
    let sight = Sight { size: 4.0, ..eye([20.3, 50.2]) };
    let mut solver = solver(&cells);
    let mut partly = 0;
    for y in 30..70 {
        let point = [120.5, y as f32 + 0.5];
        // Past a corner of the wall, down to the line of the eye's centre; the lower of both corners hides more.
        let lowest = [60.0, 61.0].map(|corner| {
            point[1] + (50.0 - point[1]) * (point[0] - sight.position[0]) / (point[0] - corner)
        });
        let hidden = lowest[0].max(lowest[1]) - (sight.position[1] - sight.size);
        let right = 1.0 - (hidden / (2.0 * sight.size)).clamp(0.0, 1.0);
        partly += u32::from(right > 0.05 && right < 0.95);
        let query = solver.visibility(&sight, point).unwrap();
        let field = solver.field(&[sight]).unwrap()[y * 160 + 120];
        for found in [query, field] {
            assert!((found - right).abs() < EXACT, "{y}: {found}, not {right}");
        }
    }
    assert!(partly > 5, "{partly}");
}

#[test]
fn a_sealed_room_is_never_seen_from_outside() {
    let cells = room();
    let mut solver = solver(&cells);
    let random = &mut seeded(1);
    let inside = |i: usize| (20..40).contains(&(i % 61)) && (20..40).contains(&(i / 61));
    for _ in 0..60 {
        let position = [random.f32() * 81.0 - 10.0, random.f32() * 81.0 - 10.0];
        let sight = Sight { size: 0.05 + 6.0 * random.f32(), ..eye(position) };
        let within = position.map(|v| (18.0..42.0).contains(&v)) == [true; 2];
        if within {
            continue;
        }
        let field = solver.field(&[sight]).unwrap();
        assert!(field.iter().enumerate().all(|(i, &v)| v == 0.0 || !inside(i)), "{sight:?}");
        assert!(field.iter().any(|&v| v > 0.0), "{sight:?}");
        let point = [20.0 + 20.0 * random.f32(), 20.0 + 20.0 * random.f32()];
        assert_eq!(solver.visibility(&sight, point).unwrap(), 0.0, "{sight:?} sees {point:?}");
    }
}

#[test]
fn the_walls_of_a_room_are_seen_from_inside_with_their_corners_and_no_deeper() {
    let mut solver = solver(&room());
    let field = solver.field(&[eye([29.5, 31.2])]).unwrap().to_vec();
    for y in 18..42 {
        for x in 18..42 {
            let [deep, seen] = [field[y * 61 + x] == 0.0, field[y * 61 + x] > 0.99];
            let outer = [x, y].iter().any(|v| [18, 41].contains(v));
            assert!(if outer { deep } else { seen }, "({x}, {y}): {}", field[y * 61 + x]);
        }
    }
    assert!(field.iter().enumerate().all(|(i, &v)| v == 0.0 || (19..41).contains(&(i % 61))));
}

#[test]
fn several_viewers_see_the_union() {
    let cells = grid(90, 60, |x, y| if x == 45 && y > 10 { WALL } else { Matter::EMPTY });
    let mut solver = solver(&cells);
    let party = [eye([20.5, 40.5]), eye([70.2, 33.3])];
    let [one, other] = party.map(|sight| solver.field(&[sight]).unwrap().to_vec());
    let both = solver.field(&party).unwrap();
    let best = one.iter().zip(&other).map(|(a, b)| a.max(*b));
    assert!(best.eq(both.iter().copied()));
    let sees = |field: &[f32], x: usize| field[45 * 90 + x] > 0.5;
    assert!(sees(&one, 10) && !sees(&one, 80) && sees(&other, 80) && !sees(&other, 10));
    assert!(solver.field(&[]).unwrap().iter().all(|&v| v == 0.0));
}

#[test]
fn a_cone_ends_at_its_edges_and_fades_before_them() {
    let cells = empty(200, 200);
    let cone = Cone { direction: 1.0, angle: 1.0, softness: 0.4, profile: None };
    let sight = Sight { cone: Some(cone), ..eye([100.5, 100.5]) };
    for (beside, right) in [(0.0, 1.0), (0.29, 1.0), (0.4, 0.5), (0.51, 0.0), (2.0, 0.0)] {
        for side in [-1.0, 1.0] {
            let (sin, cos) = (cone.direction + side * beside).sin_cos();
            let found = seen(&cells, &sight, [100.5 + 60.0 * cos, 100.5 + 60.0 * sin]);
            assert!((found - right).abs() < EXACT, "{beside}: {found}");
        }
    }
    let away = Sight { cone: Some(Cone { direction: 3.0, ..cone }), ..sight };
    assert_eq!(seen(&cells, &away, away.position), 1.0, "the place of the eye itself");
}

#[test]
fn sight_ends_at_the_range_and_fades_before_it() {
    let cells = empty(200, 50);
    let hard = Sight { range: 80.0, ..eye([20.5, 25.5]) };
    let soft = Sight { fade: 0.25, ..hard };
    for (sight, distance, right) in [
        (hard, 79.9, 1.0),
        (hard, 80.1, 0.0),
        (soft, 59.9, 1.0),
        (soft, 70.0, 0.5),
        (soft, 80.1, 0.0),
    ] {
        let found = seen(&cells, &sight, [20.5 + distance, 25.5]);
        assert!((found - right).abs() < EXACT, "{distance}: {found}");
    }
}

#[test]
fn fog_and_glass_dim_sight_by_their_transmittance() {
    let fog = Matter { opacity: 0.03, ..Matter::EMPTY };
    let glass = Matter { tint: [0.9, 0.6, 0.3], ..Matter::EMPTY };
    let fogged = 0.97f32.powi(25);
    let tinted = [0.9f32, 0.6, 0.3].map(|t| t.powi(3));
    for (matter, columns, right) in [(fog, 40..65, fogged), (glass, 40..43, luminance(tinted))] {
        let cells = grid(120, 41, |x, _| if columns.contains(&x) { matter } else { Matter::EMPTY });
        let sight = eye([10.5, 20.5]);
        let mut solver = solver(&cells);
        let query = solver.visibility(&sight, [100.5, 20.5]).unwrap();
        let field = solver.field(&[sight]).unwrap()[20 * 120 + 100];
        assert!((query - right).abs() < EXACT * right, "{query}, not {right}");
        assert!((field - right).abs() < EXACT * right, "{field}, not {right}");
    }
}

#[test]
fn a_viewer_in_a_wall_sees_nothing() {
    let mut solver = solver(&room());
    let sight = eye([19.2, 30.5]);
    assert!(solver.field(&[sight]).unwrap().iter().all(|&v| v == 0.0));
    assert_eq!(solver.visibility(&sight, [21.5, 30.5]).unwrap(), 0.0);
    let other = eye([21.5, 30.5]);
    let alone = solver.field(&[other]).unwrap().to_vec();
    assert_eq!(solver.field(&[sight, other]).unwrap(), alone);
}

#[test]
fn lamps_hide_nothing_unless_they_are_drawn_in() {
    let mut cells = empty(80, 21);
    cells.lamps_mut().push(Lamp {
        position: [40.5, 10.5],
        size: 4.0,
        solid: true,
        ..Lamp::default()
    });
    let sight = eye([10.5, 10.5]);
    assert_eq!(seen(&cells, &sight, [70.5, 10.5]), 1.0);
    assert_eq!(seen(&cells.drawn(), &sight, [70.5, 10.5]), 0.0);
}

/// Random walls, and media if `media`.
fn random(seed: u64, media: bool) -> Cells {
    let random = &mut seeded(seed);
    let mut cells = empty(97, 61);
    for _ in 0..50 {
        let matter = match random.u32(..4) {
            0 if media => Matter { opacity: 0.1 * random.f32(), ..Matter::EMPTY },
            1 if media => Matter { tint: rgb(random), ..Matter::EMPTY },
            _ => WALL,
        };
        let [x, y] = [random.u32(..97), random.u32(..61)];
        let [w, h] = [1 + random.u32(..8), 1 + random.u32(..4)];
        (y..(y + h).min(61))
            .for_each(|y| (x..(x + w).min(97)).for_each(|x| cells.set(x, y, matter)));
    }
    cells
}

/// The largest difference of the field from queries: the field interpolates media between rays.
const AGREE: f32 = 1e-3;
/// The fraction of cells that may differ by more: media that change between two rays, and rays that miss a corner.
const TIES: f32 = 2e-3;

#[test]
fn query_and_field_agree() {
    for (seed, media) in [(1, false), (2, false), (3, true), (4, true)] {
        let cells = random(seed, media);
        let mut solver = solver(&cells);
        let cone = Cone { direction: 0.3, angle: 2.5, softness: 0.5, profile: None };
        let mut partly = 0;
        for sight in [
            eye([40.2, 30.7]),
            Sight { size: 3.5, fade: 0.4, range: 50.0, ..eye([20.1, 15.4]) },
            Sight { size: 0.3, cone: Some(cone), ..eye([60.5, 41.5]) },
            eye([-9.5, 70.0]),
        ] {
            let field = solver.field(&[sight]).unwrap().to_vec();
            let query = |i: usize| {
                let center = [i % 97, i / 97].map(|v| v as f32 + 0.5);
                solver.visibility(&sight, center).unwrap()
            };
            let off: Vec<f32> =
                field.iter().enumerate().map(|(i, v)| (v - query(i)).abs()).collect();
            let worst = off.iter().copied().fold(0.0, f32::max);
            let ties = off.iter().filter(|&&off| off > AGREE).count();
            println!("{seed}, {sight:?}: {worst}, {ties} ties");
            assert!(ties as f32 <= TIES * off.len() as f32, "{seed}, {sight:?}: {ties}");
            partly += field.iter().filter(|v| (0.01..0.99).contains(*v)).count();
        }
        assert!(partly > 200, "{partly} cells are seen in part");
    }
}

#[test]
fn sight_is_mutual_but_for_penumbrae() {
    let cells = random(5, false);
    let solver = solver(&cells);
    let random = &mut seeded(6);
    let (mut whole, mut nothing) = (0, 0);
    for _ in 0..2000 {
        let mut point = || [97.0 * random.f32(), 61.0 * random.f32()];
        let [a, b] = [point(), point()];
        let in_wall = |p: [f32; 2]| cells.is_solid(cells.index(p[0] as u32, p[1] as u32));
        if in_wall(a) || in_wall(b) {
            continue;
        }
        let there = solver.visibility(&eye(a), b).unwrap();
        let back = solver.visibility(&eye(b), a).unwrap();
        whole += u32::from(there == 1.0);
        nothing += u32::from(there == 0.0);
        assert!((there == 1.0 && back > 0.0) || there < 1.0, "{a:?}, {b:?}: {there}, {back}");
        assert!((there == 0.0 && back < 1.0) || there > 0.0, "{a:?}, {b:?}: {there}, {back}");
    }
    assert!(whole > 100 && nothing > 100, "{whole} {nothing}");
}

#[test]
fn invalid_viewers_and_points_are_errors_that_name_them() {
    let mut solver = solver(&empty(9, 7));
    let key = |result: Result<f32, Error>| match result {
        Err(Error::Value { key, .. }) => key,
        other => panic!("{other:?}"),
    };
    let good = eye([4.5, 3.5]);
    let cone = Cone { direction: f32::NAN, angle: 1.0, softness: 0.0, profile: None };
    let profile = Some(Profile::new(&[0.0, 1.0]).unwrap());
    let uneven = Cone { direction: 0.0, profile, ..cone };
    for (sight, named) in [
        (Sight { position: [f32::NAN, 1.0], ..good }, "position"),
        (Sight { position: [1.0, f32::INFINITY], ..good }, "position"),
        (Sight { size: 0.0, ..good }, "size"),
        (Sight { range: f32::NAN, ..good }, "range"),
        (Sight { fade: 1.5, ..good }, "fade"),
        (Sight { cone: Some(cone), ..good }, "cone.direction"),
        (Sight { cone: Some(uneven), ..good }, "cone.profile"),
    ] {
        assert_eq!(key(solver.visibility(&sight, [1.0; 2])), format!("sight.{named}"));
        let field = solver.field(&[good, sight]).map(|field| field[0]);
        assert_eq!(key(field), format!("sight[1].{named}"));
    }
    assert_eq!(key(solver.visibility(&good, [f32::NAN, 0.0])), "point");
    for outside in [[-0.1, 3.0], [9.0, 3.0], [4.0, 7.0], [-1e6, 1e6]] {
        assert_eq!(solver.visibility(&good, outside).unwrap(), 0.0, "{outside:?}");
    }
}

#[test]
fn extreme_viewers_see_finite_amounts() {
    let cells = random(7, true);
    let mut solver = solver(&cells);
    for position in [[1e6, -1e6], [0.0, 0.0], [97.0, 61.0], [48.0, 30.0], [48.5, 30.5]] {
        for (size, range) in [(0.05, 1.0), (512.0, 1e5), (0.05, 1e5), (512.0, 1.0)] {
            let sight = Sight { size, range, ..eye(position) };
            let field = solver.field(&[sight]).unwrap();
            assert!(field.iter().all(|v| (0.0..=1.0).contains(v)), "{sight:?}");
            let point = solver.visibility(&sight, [0.0; 2]).unwrap();
            assert!((0.0..=1.0).contains(&point), "{sight:?}");
        }
    }
}

#[test]
fn without_cells_nothing_is_seen() {
    let mut solver = SightSolver::default();
    assert_eq!(solver.field(&[eye([1.0; 2])]).unwrap(), [0.0; 0]);
    assert_eq!(solver.visibility(&eye([1.0; 2]), [2.0; 2]).unwrap(), 0.0);
    fn is_send(_: impl Send + Sync) {}
    is_send(solver);
}
