//! Shapes cover cells by exact fractions of their area, or by their centres.

use lamplight::{Cells, Scene, Shape};
use proptest::prelude::*;

const SIDE: u32 = 24;
/// Points of the supersampled coverage along each axis.
const FINE: u32 = 40;
/// Coverage against 40×40 points: an edge crosses about 2·40 of the 1600 little squares, each right
/// by half on average; 3 % is beyond what that gives.
const TOLERANCE: f32 = 0.03;

/// The inside of a shape, by definitions that are independent of the rasteriser.
#[derive(Clone, Debug)]
enum Inside {
    Circle {
        center: [f64; 2],
        radius: f64,
    },
    /// Turned by `rotation` about the centre.
    Rect {
        center: [f64; 2],
        half: [f64; 2],
        rotation: f64,
    },
    /// On the same side of every edge.
    Convex {
        points: Vec<[f64; 2]>,
    },
}

impl Inside {
    fn holds(&self, [x, y]: [f64; 2]) -> bool {
        match self {
            Self::Circle { center, radius } => (x - center[0]).hypot(y - center[1]) <= *radius,
            Self::Rect { center, half, rotation } => {
                let (sin, cos) = rotation.sin_cos();
                let (dx, dy) = (x - center[0], y - center[1]);
                (cos * dx + sin * dy).abs() <= half[0] && (cos * dy - sin * dx).abs() <= half[1]
            }
            Self::Convex { points } => {
                let side = |i: usize| {
                    let (a, b) = (points[i], points[(i + 1) % points.len()]);
                    (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])
                };
                (0..points.len()).all(|i| side(i) >= 0.0)
            }
        }
    }

    fn coverage(&self, x: u32, y: u32) -> f32 {
        let at = |cell: u32, k: u32| f64::from(cell) + (f64::from(k) + 0.5) / f64::from(FINE);
        let points = (0..FINE).flat_map(|j| (0..FINE).map(move |i| (i, j)));
        let inside = points.filter(|&(i, j)| self.holds([at(x, i), at(y, j)])).count();
        inside as f32 / (FINE * FINE) as f32
    }
}

fn cells(shape: Shape) -> Cells {
    Scene::new(SIDE, SIDE).shape(shape).cells().unwrap()
}

/// The coverage of cells by a shape. It is drawn as fog: thin walls have more opacity than coverage.
fn coverage(shape: Shape) -> Vec<f32> {
    cells(shape.opacity(0.5)).opacity().iter().map(|opacity| 2.0 * opacity).collect()
}

/// Largest difference of the drawn coverage from the supersampled one.
fn worst_coverage(shape: &Shape, inside: &Inside) -> f32 {
    let drawn = coverage(shape.clone());
    let all = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    drawn.iter().zip(all).map(|(c, (x, y))| (c - inside.coverage(x, y)).abs()).fold(0.0, f32::max)
}

/// Cells whose centre is inside by one and not by the other; centres within a hair of the edge
/// belong to either.
fn wrong_centres(shape: &Shape, inside: &Inside) -> usize {
    const HAIR: f64 = 1e-4;
    let cells = cells(shape.clone());
    let all = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    all.filter(|&(x, y)| {
        let [cx, cy] = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        let near = [[0.0, 0.0], [HAIR, HAIR], [-HAIR, HAIR], [HAIR, -HAIR], [-HAIR, -HAIR]];
        let inside = near.map(|[dx, dy]| inside.holds([cx + dx, cy + dy]));
        let covered = cells.get(x, y).unwrap().opacity == 1.0;
        inside.iter().all(|&i| i != covered)
    })
    .count()
}

fn circle() -> impl Strategy<Value = (Shape, Inside)> {
    let center = [-4.0f32..28.0, -4.0f32..28.0];
    (center, 0.05f32..14.0).prop_map(|(center, radius)| {
        let inside = Inside::Circle { center: center.map(f64::from), radius: f64::from(radius) };
        (Shape::circle(center, radius), inside)
    })
}

fn rect() -> impl Strategy<Value = (Shape, Inside)> {
    let parts = ([-4.0f32..28.0, -4.0f32..28.0], [0.1f32..20.0, 0.1f32..20.0], -4.0f32..4.0);
    parts.prop_map(|([x, y], [w, h], rotation)| {
        let (min, max) = ([x - w / 2.0, y - h / 2.0], [x + w / 2.0, y + h / 2.0]);
        let wide = |a: f32, b: f32| (f64::from(a) + f64::from(b)) / 2.0;
        let inside = Inside::Rect {
            center: [wide(min[0], max[0]), wide(min[1], max[1])],
            half: [0, 1].map(|i| (f64::from(max[i]) - f64::from(min[i])) / 2.0),
            rotation: f64::from(rotation),
        };
        (Shape::rect(min, max).rotation(rotation), inside)
    })
}

fn line() -> impl Strategy<Value = (Shape, Inside)> {
    let point = || [-4.0f32..28.0, -4.0f32..28.0];
    (point(), point(), 0.1f32..6.0).prop_map(|(from, to, width)| {
        let (a, b) = (from.map(f64::from), to.map(f64::from));
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let inside = Inside::Rect {
            center: [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0],
            half: [dx.hypot(dy) / 2.0, f64::from(width) / 2.0],
            rotation: dy.atan2(dx),
        };
        (Shape::line(from, to, width), inside)
    })
}

fn polygon() -> impl Strategy<Value = (Shape, Inside)> {
    // Corners of a circle's inscribed polygon are convex, whatever their angles.
    let parts = (circle(), proptest::collection::btree_set(0u32..360, 3..12), any::<bool>());
    parts.prop_filter_map("no area", |((_, disc), angles, reversed)| {
        let Inside::Circle { center, radius } = disc else { return None };
        let mut points: Vec<[f32; 2]> = angles
            .iter()
            .map(|&a| f64::from(a).to_radians().sin_cos())
            .map(|(sin, cos)| [center[0] + radius * cos, center[1] + radius * sin])
            .map(|p| p.map(|v| v as f32))
            .collect();
        let inside = Inside::Convex { points: points.iter().map(|p| p.map(f64::from)).collect() };
        if reversed {
            points.reverse();
        }
        Some((Shape::polygon(points), inside))
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 48,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn coverage_agrees_with_supersampling(
        (shape, inside) in prop_oneof![circle(), rect(), line(), polygon()],
    ) {
        let worst = worst_coverage(&shape, &inside);
        prop_assert!(worst < TOLERANCE, "off by {worst}");
    }

    #[test]
    fn without_antialiasing_centres_decide(
        (shape, inside) in prop_oneof![circle(), rect(), line(), polygon()],
    ) {
        prop_assert_eq!(wrong_centres(&shape, &inside), 0);
    }
}

#[test]
fn the_comparison_rejects_a_shape_moved_by_a_tenth() {
    let inside = Inside::Circle { center: [12.0, 12.0], radius: 5.0 };
    assert!(worst_coverage(&Shape::circle([12.0, 12.0], 5.0), &inside) < TOLERANCE);
    assert!(worst_coverage(&Shape::circle([12.1, 12.0], 5.0), &inside) > TOLERANCE);
    assert_eq!(wrong_centres(&Shape::circle([12.0, 12.0], 5.0), &inside), 0);
    assert!(wrong_centres(&Shape::circle([12.6, 12.0], 5.0), &inside) > 0);
}

#[test]
fn areas_are_exact() {
    // To single precision of a sum of some hundred shares.
    const EXACT: f64 = 1e-5;
    let area = |shape: Shape| -> f64 { coverage(shape).into_iter().map(f64::from).sum() };
    let close = |shape: Shape, expected: f64| {
        let found = area(shape);
        assert!((found / expected - 1.0).abs() < EXACT, "{found} for {expected}");
    };
    let pi = std::f64::consts::PI;
    close(Shape::circle([11.3, 12.7], 8.25), pi * 8.25 * 8.25);
    close(Shape::circle([11.5, 12.5], 0.125), pi * 0.125 * 0.125);
    close(Shape::circle([0.0, 12.0], 4.0), pi * 8.0);
    close(Shape::rect([3.25, 4.5], [9.75, 5.0]), 3.25);
    close(Shape::rect([7.0, 7.0], [17.0, 15.0]).rotation(0.7), 80.0);
    close(Shape::line([3.0, 4.0], [19.0, 16.0], 1.5), 30.0);
    // An L, which is not convex.
    let l = [[2.5, 2.5], [6.0, 2.5], [6.0, 10.0], [12.0, 10.0], [12.0, 14.5], [2.5, 14.5]];
    close(Shape::polygon(l), 3.5 * 12.0 + 6.0 * 4.5);
    // Larger than the grid on every side.
    close(Shape::rect([-1e6, -1e6], [1e6, 1e6]).rotation(0.3), f64::from(SIDE * SIDE));
    close(Shape::circle([12.0, 12.0], 1e6), f64::from(SIDE * SIDE));
}

#[test]
fn rectangles_that_share_an_edge_tile_the_grid() {
    for edge in [3.0, 3.5, 3.7] {
        let scene = Scene::new(8, 8)
            .shape(Shape::rect([0.0, 0.0], [edge, 8.0]).albedo([0.25; 3]))
            .shape(Shape::rect([edge, 0.0], [8.0, 8.0]).albedo([0.5; 3]));
        let cells = scene.cells().unwrap();
        assert!(cells.opacity().iter().all(|&a| a == 1.0));
        let left = cells.albedo().iter().filter(|a| a[0] == 0.25).count();
        assert_eq!(left, 8 * (f64::from(edge) - 0.5f64).ceil() as usize, "edge at {edge}");
    }
}

#[test]
fn shapes_lie_over_one_another_in_order() {
    let red = Shape::rect([0.0, 0.0], [8.0, 8.0]).albedo([0.5, 0.0, 0.0]);
    let lamp =
        Shape::rect([2.0, 2.0], [4.5, 4.0]).emission([2.0; 3]).color([0.1; 3]).antialias(true);
    let cells = Scene::new(8, 8).shape(red).shape(lamp).cells().unwrap();
    let half = cells.get(4, 3).unwrap();
    assert_eq!(half.opacity, 1.0);
    assert_eq!(half.emission, [1.0; 3]);
    assert_eq!(half.albedo, [0.25, 0.0, 0.0]);
    assert_eq!(cells.color().unwrap()[cells.index(3, 3)], [0.1; 3]);
    assert_eq!(cells.color().unwrap()[cells.index(6, 6)], [0.5, 0.0, 0.0]);
}

#[test]
fn white_over_white_is_not_whiter() {
    for i in 0..256 {
        let fog =
            |x: f32| Shape::circle([x, 4.0], 2.5).albedo([1.0; 3]).opacity(0.7).antialias(true);
        let (below, above) = (fog(4.1), fog(4.0 + i as f32 / 256.0));
        Scene::new(8, 8).shape(below).shape(above).cells().unwrap().check().unwrap();
    }
}

#[test]
fn colour_is_painted_by_the_opacity_of_a_shape() {
    let whole = |shape: Shape| {
        let cells = Scene::new(1, 1).shape(shape).cells().unwrap();
        cells.color().map_or([1.0; 3], |c| c[0])
    };
    let square = Shape::rect([0.0, 0.0], [1.0, 1.0]);
    assert_eq!(whole(square.clone()), [1.0; 3]);
    assert_eq!(whole(square.clone().albedo([0.5; 3])), [0.5; 3]);
    assert_eq!(whole(square.clone().albedo([0.0; 3]).opacity(0.25)), [0.75; 3]);
    assert_eq!(whole(square.clone().albedo([0.0; 3]).opacity(0.0)), [1.0; 3]);
    assert_eq!(whole(square.opacity(0.0).color([0.5; 3])), [0.5; 3]);
}

fn by_area(shape: Shape) -> Cells {
    cells(shape.antialias(true))
}

/// The light that passes a wall at one place across it: the product of what its cells let through.
fn leak(cells: &Cells, across: impl Iterator<Item = (u32, u32)>) -> f32 {
    across.map(|(x, y)| 1.0 - cells.get(x, y).unwrap().opacity).product()
}

#[test]
fn thin_walls_are_shut_wherever_they_lie() {
    for step in 0..=20 {
        let at = 10.0 + step as f32 / 20.0;
        for thickness in [1.0, 1.3, 1.9] {
            let flat = by_area(Shape::rect([0.0, at], [24.0, at + thickness]));
            let upright = by_area(Shape::rect([at, 0.0], [at + thickness, 24.0]));
            for k in 0..SIDE {
                assert_eq!(leak(&flat, (0..SIDE).map(|y| (k, y))), 0.0, "{at} {thickness} {k}");
                assert_eq!(leak(&upright, (0..SIDE).map(|x| (x, k))), 0.0, "{at} {thickness} {k}");
            }
            // Slanted, from border to border.
            for rise in [-9.0, -4.0, 2.5, 8.0] {
                let line = Shape::line([-4.0, at - rise], [28.0, at + rise], thickness);
                let slanted = by_area(line);
                for x in 0..SIDE {
                    let leak = leak(&slanted, (0..SIDE).map(|y| (x, y)));
                    assert_eq!(leak, 0.0, "{at} {thickness} {rise} {x}");
                }
            }
        }
    }
}

#[test]
fn thin_walls_change_smoothly_as_they_move() {
    // A coverage changes by no more than the wall moves, 0.0142 px, and the ratio of two, the larger of which is at
    // least a half, by no more than four times that.
    const STEP: f32 = 0.0567;
    let wall = |offset: f32| {
        let at = [4.3 + offset, 9.0 + offset];
        by_area(Shape::rect(at, [at[0] + 12.0, at[1] + 1.0]).rotation(0.2))
    };
    let changes = |moved: f32| {
        let largest = |from: f32| {
            let (a, b) = (wall(from), wall(from + moved));
            a.opacity().iter().zip(b.opacity()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        (0..100).map(|k| largest(k as f32 / 100.0)).fold(0.0, f32::max)
    };
    assert!(changes(0.01) < STEP, "{}", changes(0.01));
    assert!(changes(0.1) > STEP, "the measure sees no motion");
}

#[test]
fn thin_walls_emit_by_their_area() {
    for at in [8.0, 8.25, 8.5, 8.9] {
        let cells = by_area(Shape::rect([4.0, at], [20.0, at + 1.0]).emission([3.0; 3]));
        let emitted: f32 =
            cells.opacity().iter().zip(cells.emission()).map(|(o, e)| o * e[0]).sum();
        assert!((emitted - 48.0).abs() < 1e-3, "{at}: {emitted}");
    }
}

#[test]
fn fog_does_not_open_walls_in_part() {
    let wall = Shape::rect([0.0, 8.0], [24.0, 9.0]).albedo([0.5; 3]);
    for (bottom, opacity) in [(8.4, 1.0), (8.6, 0.25)] {
        let fog = Shape::rect([4.0, 2.0], [20.0, bottom]).opacity(0.25);
        let cells = Scene::new(SIDE, SIDE).shape(wall.clone()).shape(fog).cells().unwrap();
        assert_eq!(cells.get(10, 8).unwrap().opacity, opacity, "{bottom}");
        assert_eq!(cells.get(22, 8).unwrap().opacity, 1.0);
    }
}
