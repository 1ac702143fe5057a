//! Debug views show the intermediates of methods unchanged.

use crate::common::*;
use lamplight::image::{Rgb, RgbImage};
use lamplight::settings::{Hit, Raymarch};
use lamplight::{Bounces, Cells, Display, Lamp, Matter, Method, Settings, Sky, Solver};

fn solved(cells: &Cells, settings: Settings) -> Solver {
    let mut solver = Solver::new(settings).unwrap();
    solver.solve(cells).unwrap();
    solver
}

fn by(method: Method) -> Settings {
    Settings { bounces: Bounces::Count(0), ..Settings::direct(method) }
}

/// A room with fog, glass, glowing matter and a lamp.
fn room(width: u32, height: u32) -> Cells {
    let mut cells = Cells::new(width, height).unwrap();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        match (7 * x + 3 * y) % 41 {
            0 => cells.set(x, y, Matter { opacity: 1.0, ..Matter::default() }),
            1 => {
                cells.set(x, y, Matter { opacity: 0.2, tint: [1.0, 0.5, 0.5], ..Matter::default() })
            }
            2 => cells.set(
                x,
                y,
                Matter { opacity: 1.0, emission: [2.0, 1.0, 0.5], ..Matter::default() },
            ),
            _ => {}
        }
    }
    let position = [0.4 * width as f32, 0.6 * height as f32];
    cells.lamps_mut().push(Lamp { position, ..LAMP });
    cells
}

#[test]
fn every_method_has_debug_views_at_every_size() {
    for [w, h] in [[1, 1], [1, 37], [53, 1], [2, 3], [61, 47], [130, 70]] {
        let cells = room(w, h);
        for &method in Method::ALL {
            let mut solver = Solver::new(by(method)).unwrap();
            assert_eq!(solver.debug_view_count(), 0, "{method:?} before a frame");
            solver.solve(&cells).unwrap();
            let light = solver.light().clone();
            let count = solver.debug_view_count();
            assert!(count > 0 || w < 53 || h == 1, "{method:?} at {w}×{h}");
            for number in 0..count {
                let inside = solver.debug_view(number, &Display::PLAIN).unwrap();
                let first = inside.picture.get_pixel(0, 0);
                let flat = inside.picture.pixels().all(|pixel| pixel == first);
                assert!(!flat || w * h < 1000, "{method:?} {} at {w}×{h}", inside.name);
            }
            assert!(solver.debug_view(count, &Display::PLAIN).is_none());
            assert_eq!(solver.light(), &light, "looking changes no light");
        }
    }
}

#[test]
fn variants_without_intermediates_have_no_debug_views() {
    let settings = Settings::direct(Raymarch { hit: Hit::Distance, ..Raymarch::default() });
    assert_eq!(solved(&room(40, 30), settings).debug_view_count(), 0);
}

#[test]
fn empty_space_skips_are_longest_in_the_open() {
    let mut cells = Cells::new(40, 20).unwrap();
    cells.set(10, 10, Matter { opacity: 1.0, ..Matter::default() });
    let mut solver = solved(&cells, by(Method::Raymarch));
    let picture = solver.debug_view(0, &Display::PLAIN).unwrap().picture;
    let sum = |x, y| picture.get_pixel(x, y).0.iter().map(|&v| u32::from(v)).sum::<u32>();
    // To the right and down: 20 px from the corner right of the wall, 9 above and left of it.
    assert!(sum(11, 0) > sum(2, 2), "{} and {}", sum(11, 0), sum(2, 2));
    assert_eq!(picture.get_pixel(10, 10), &Rgb([24, 24, 28]));
}

#[test]
fn ray_textures_end_at_walls() {
    let mut cells = Cells::new(80, 80).unwrap();
    (0..80).for_each(|y| cells.set(60, y, Matter { opacity: 1.0, ..Matter::default() }));
    let lamp = Lamp { position: [40.0, 40.0], range: 40.0, intensity: 100.0, ..LAMP };
    cells.lamps_mut().push(lamp);
    let picture = solved(&cells, by(Method::Polar)).debug_view(0, &Display::PLAIN).unwrap().picture;
    // 20 of 40 px to the wall on the right, none on the left; the last row of a strip stays dark.
    let lit = |column| (0..40).filter(|&y| picture.get_pixel(column, y).0 != [0; 3]).count();
    assert_eq!([lit(0), lit(picture.width() / 2)], [20, 40]);
    assert_eq!(picture.get_pixel(0, 40).0, [0; 3]);
}

#[test]
fn cascades_under_an_even_sky_see_it_everywhere() {
    let sky = Sky::Uniform([0.5; 3]);
    let mut cells = Cells::new(64, 48).unwrap();
    cells.set_sky(sky);
    let mut solver = solved(&cells, by(Method::Cascades));
    let expected = Display::PLAIN.encode([0.5; 3]);
    let differs = |picture: &RgbImage| picture.pixels().filter(|pixel| pixel.0 != expected).count();
    for number in 0..solver.debug_view_count() {
        let picture = solver.debug_view(number, &Display::PLAIN).unwrap().picture;
        assert_eq!(differs(&picture), 0, "cascade {number}");
    }
    cells.set(30, 20, Matter { opacity: 1.0, ..Matter::default() });
    solver.solve(&cells).unwrap();
    let picture = solver.debug_view(0, &Display::PLAIN).unwrap().picture;
    assert!(differs(&picture) > 10, "a wall is seen");
}

#[test]
fn intervals_carry_the_light_of_the_wall_they_hit() {
    let mut cells = Cells::new(64, 32).unwrap();
    let wall = Matter { opacity: 1.0, emission: [1.0, 0.0, 0.0], ..Matter::default() };
    (0..32).for_each(|y| cells.set(33, y, wall));
    let mut solver = solved(&cells, by(Method::Holographic));
    let first = solver.settings().method.as_holographic().unwrap().gather_level;
    let picture = solver.debug_view(0, &Display::PLAIN).unwrap().picture;
    let (apart, rays) = (1u32 << first, (2u32 << first) + 1);
    // The straight ray of the plane in front of the wall, and of the one behind it.
    let straight = |plane: u32| picture.get_pixel((plane - 1) * (rays + 1) + rays / 2, 16).0;
    let before = 32 / apart;
    assert_eq!(straight(before)[0], 255, "{:?}", straight(before));
    let clear = Display::PLAIN.encode([0.01, 0.02, 0.06]);
    assert_eq!(straight(before + 2), clear);
}
