//! Invariants of `cascades`, and scenes with known results.

use crate::common::*;
use lamplight::settings::{Cascades, Merge};
use lamplight::{Bounces, Cells, Error, Gradient, Light, Matter, Settings, Sky};
use lamplight::{SettingsTable, Solver};

/// Sums of some thousand f32, relative.
const ROUNDING: f32 = 2e-5;

fn cascades(change: impl FnOnce(&mut Cascades)) -> Settings {
    let mut cascades = Cascades::default();
    change(&mut cascades);
    Settings::direct(cascades)
}

fn bounces(count: u32) -> Settings {
    Settings { bounces: Bounces::Count(count), ..cascades(|_| ()) }
}

/// Every way to merge, with every number of rays, and all else that changes what is computed.
fn variants() -> Vec<Settings> {
    let mut all = Vec::new();
    for merge in [Merge::Plain, Merge::BilinearFix] {
        for rays in [4, 16, 64] {
            all.push(cascades(|c| (c.merge, c.rays) = (merge, rays)));
        }
        for spacing in [0.5, 1.3, 4.0] {
            all.push(cascades(|c| (c.merge, c.spacing) = (merge, spacing)));
        }
        all.push(cascades(|c| (c.merge, c.interval, c.overlap) = (merge, 0.7, 0.3)));
    }
    all
}

/// Sizes that are small, odd, prime, of one row, and of more than one packet.
const SIZES: [[u32; 2]; 8] =
    [[1, 1], [2, 1], [1, 97], [131, 1], [3, 5], [17, 31], [64, 64], [130, 7]];

#[test]
fn under_a_uniform_sky_light_is_the_sky_at_any_size() {
    let sky = [0.3, 1.0, 700.0];
    for [w, h] in SIZES {
        let mut cells = Cells::new(w, h).unwrap();
        cells.set_sky(Sky::Uniform(sky));
        for settings in variants() {
            for pixel in solve(&settings, &cells).pixels() {
                (0..3).for_each(|c| near(pixel[c], f64::from(sky[c]), f64::from(ROUNDING)));
            }
        }
    }
}

#[test]
fn white_walls_under_a_uniform_sky_change_nothing() {
    let mut cells = Cells::new(37, 23).unwrap();
    cells.set_sky(Sky::Uniform([2.0; 3]));
    for x in 10..20 {
        cells.set(x, 11, Matter { albedo: [1.0; 3], ..WALL });
        cells.set(x, 17, Matter { opacity: 0.2, albedo: [1.0; 3], ..Matter::EMPTY });
    }
    let light = |bounces| solve(&Settings { bounces, ..cascades(|_| ()) }, &cells);
    let off =
        |light: &Light| light.pixels().iter().map(|p| (p[0] / 2.0 - 1.0).abs()).fold(0.0, f32::max);
    // Wall and fog see one another: each bounce leaves a fraction of the light to the next.
    let (direct, bounced) = (off(&light(Bounces::Count(0))), off(&light(Bounces::Count(64))));
    assert!(direct > 0.1 && bounced < 10.0 * ROUNDING, "{direct} {bounced}");
}

#[test]
fn a_sky_gradient_is_seen_whole() {
    let [zenith, horizon, ground] = [1.0, 0.25, 0.5];
    let mut cells = Cells::new(21, 34).unwrap();
    let [z, h, g] = [zenith, horizon, ground].map(|v| [v; 3]);
    cells.set_sky(Sky::Gradient(Gradient { zenith: z, horizon: h, ground: g }));
    // The mean of the sine over half a circle is 2/π.
    let share = std::f64::consts::FRAC_2_PI;
    let half = |end: f32| f64::from(horizon) + f64::from(end - horizon) * share;
    let expected = 0.5 * (half(zenith) + half(ground));
    for settings in variants() {
        for pixel in solve(&settings, &cells).pixels() {
            near(pixel[0], expected, f64::from(ROUNDING));
        }
    }
}

#[test]
fn a_furnace_has_uniform_light() {
    let (e, rho) = (0.5f64, 0.6f64);
    let wall = Matter { emission: [e as f32; 3], albedo: [rho as f32; 3], ..WALL };
    for size in [[5, 4], [33, 20], [90, 41]] {
        for k in [0, 1, 5] {
            let light = solve(&bounces(k), &room(size[0], size[1], wall));
            let expected = e * (1.0 - rho.powi(k as i32 + 1)) / (1.0 - rho);
            for y in 1..size[1] - 1 {
                for x in 1..size[0] - 1 {
                    near(light.at(x, y)[1], expected, f64::from(ROUNDING));
                }
            }
        }
    }
}

#[test]
fn no_light_enters_a_sealed_room() {
    let random = &mut fresh();
    let mut leaks = 0;
    for i in 0..40 {
        let contact = if i % 2 == 0 { Contact::Sides } else { Contact::Corners };
        let size = [20 + random.u32(..60), 20 + random.u32(..40)];
        let room_size = 10 + random.usize(..200);
        let sealed = Sealed::new(random, size, room_size, contact);
        let mut cells = grid(size[0], size[1], |x, y| {
            let i = (y * size[0] + x) as usize;
            match () {
                () if sealed.wall[i] => Matter { albedo: [0.8; 3], ..WALL },
                () if sealed.is_outside(i) => {
                    let glow = if random.f32() < 0.1 { 50.0 } else { 0.0 };
                    Matter { emission: [glow; 3], opacity: 0.1, albedo: [0.9; 3], ..Matter::EMPTY }
                }
                () => Matter::EMPTY,
            }
        });
        cells.set_sky(Sky::Uniform([10.0; 3]));
        // The border of the grid does not close a room for a ray that leaves.
        let room: Vec<usize> = sealed.room();
        let at_border = |&i: &usize| {
            let (x, y) = (i as u32 % size[0], i as u32 / size[0]);
            x == 0 || y == 0 || x == size[0] - 1 || y == size[1] - 1
        };
        if room.iter().any(at_border) {
            continue;
        }
        for rays in [4, 16] {
            let settings = Settings { bounces: Bounces::Count(2), ..cascades(|c| c.rays = rays) };
            let light = solve(&settings, &cells);
            assert!(room.iter().all(|&i| light.pixels()[i] == [0.0; 3]), "room {i}, {rays} rays");
        }
        let plain = solve(&cascades(|c| c.merge = Merge::Plain), &cells);
        leaks += usize::from(room.iter().any(|&i| plain.pixels()[i] != [0.0; 3]));
    }
    // The plain merge has no such guarantee; if it were dark too, this test could not fail.
    assert!(leaks > 0);
}

#[test]
fn a_thin_wall_is_dark_on_its_far_side() {
    let glow = Matter { emission: [5.0; 3], ..WALL };
    let white = Matter { albedo: [0.9; 3], ..WALL };
    let cells = grid(48, 33, |x, y| match (x, y) {
        (20, _) | (_, 0 | 32) | (0 | 47, _) => white,
        (6..=12, 10..=16) => glow,
        _ => Matter::EMPTY,
    });
    let light = solve(&bounces(3), &cells);
    assert!(light.at(19, 16)[0] > 0.1);
    for y in 1..32 {
        for x in 21..47 {
            assert_eq!(light.at(x, y), [0.0; 3], "{x} {y}");
        }
    }
}

/// Rotates a grid by a quarter: (x, y) becomes (height − 1 − y, x).
fn turned(cells: &Cells) -> Cells {
    let (w, h) = (cells.width(), cells.height());
    let mut turned = grid(h, w, |x, y| cells.get(y, h - 1 - x).unwrap());
    turned.set_sky(cells.sky().clone());
    turned
}

/// The most that light may change by a quarter turn: a ray that grazes a corner may go the other
/// way round it by rounding.
const TURNED: f64 = 2e-4;

#[test]
fn turning_the_scene_turns_the_light() {
    for [w, h] in [[29, 18], [40, 64], [75, 31]] {
        let cells = jumble(w, h, 3);
        for settings in variants().into_iter().map(|s| Settings { bounces: Bounces::Count(1), ..s })
        {
            let light = solve(&settings, &cells);
            let around = solve(&settings, &turned(&cells));
            let back = |wrong: u32| {
                let rgb =
                    (0..w * h).map(|i| around.at(h - 1 - i / w, (i % w + wrong) % w)).collect();
                relative_rmse(&Light::from_pixels(&cells, rgb).unwrap(), &light)
            };
            assert!(back(0) < TURNED, "{w}×{h}, {settings:?}: {}", back(0));
            assert!(back(1) > 10.0 * TURNED, "light that is off by a px passes");
        }
    }
}

#[test]
fn light_is_linear_in_emission() {
    for settings in [bounces(0), bounces(2), cascades(|c| c.merge = Merge::Plain)] {
        expect_linear_in_emission(&settings, ROUNDING);
    }
}

/// Sixteen rays see a square of 12 px at 30 px or less with about this much error, relative …
const SQUARE: f64 = 0.06;
/// … and 64 rays with this much.
const SQUARE_QUALITY: f64 = 0.03;

#[test]
fn an_emissive_square_matches_its_closed_form() {
    let cells = grid(81, 77, |x, y| match (x, y) {
        (34..46, 32..44) => GLOW,
        _ => Matter::EMPTY,
    });
    for (rays, tolerance) in [(16, SQUARE), (64, SQUARE_QUALITY)] {
        let light = solve(&cascades(|c| c.rays = rays), &cells);
        let mut worst = 0.0f64;
        for [x, y] in [[10, 38], [20, 20], [40, 52], [40, 46], [60, 60], [48, 31], [70, 38]] {
            // φ is the fraction of the circle that the corners subtend.
            let at = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            let corners = [[34.0, 32.0], [46.0, 32.0], [46.0, 44.0], [34.0, 44.0]];
            let angles = corners.map(|[cx, cy]: [f64; 2]| {
                let (dx, dy) = (cx - at[0], cy - at[1]);
                let (mx, my) = (40.0 - at[0], 38.0 - at[1]);
                (mx * dy - my * dx).atan2(mx * dx + my * dy)
            });
            let (low, high) =
                angles.iter().fold((f64::MAX, f64::MIN), |(l, h), &a| (l.min(a), h.max(a)));
            let expected = (high - low) / std::f64::consts::TAU;
            worst = worst.max((f64::from(light.at(x, y)[0]) / expected - 1.0).abs());
        }
        println!("{rays} rays: {:.2} % off at worst", 100.0 * worst);
        assert!(worst < tolerance, "{rays} rays: {worst}");
    }
}

/// The disc is drawn in cells, so its edge is off by up to half a px, and a path that bends from
/// probe to probe is longer than a straight one: more fog is seen.
const FOG: f64 = 0.02;

#[test]
fn emissive_fog_matches_its_closed_form() {
    let (sigma, e, radius) = (0.04f64, 2.0f64, 30.0f64);
    let opacity = (1.0 - (-sigma).exp()) as f32;
    let cells = grid(81, 81, |x, y| {
        let d = (f64::from(x) - 40.0).hypot(f64::from(y) - 40.0);
        if d < radius {
            Matter { emission: [e as f32; 3], opacity, ..Matter::EMPTY }
        } else {
            Matter::EMPTY
        }
    });
    let expected = e * (1.0 - (-sigma * radius).exp());
    for settings in [cascades(|_| ()), cascades(|c| c.merge = Merge::Plain)] {
        near(solve(&settings, &cells).at(40, 40)[0], expected, FOG);
    }
}

#[test]
fn glass_colours_what_lies_behind() {
    // A room of one colour behind glass all round: whatever way light comes, it crosses the glass.
    let glass = Matter { tint: [1.0, 0.5, 0.25], ..Matter::EMPTY };
    let cells = grid(41, 41, |x, y| match () {
        () if x.abs_diff(20).max(y.abs_diff(20)) >= 18 => GLOW,
        () if x.abs_diff(20).max(y.abs_diff(20)) == 10 => glass,
        () => Matter::EMPTY,
    });
    let [r, g, b] = solve(&cascades(|_| ()), &cells).at(20, 20);
    near(r, 1.0, f64::from(ROUNDING));
    // Through at least 1 px of glass and at most √2.
    for (value, tint) in [(g, 0.5f32), (b, 0.25)] {
        assert!(value < tint && value > tint.powf(std::f32::consts::SQRT_2), "{value}");
    }
}

#[test]
fn invalid_settings_are_rejected_by_name() {
    let refused = |text: &str, key: &str| {
        let mut table = SettingsTable::default();
        table.set_from_text(text).unwrap();
        let error = table.resolve().unwrap_err().to_string();
        assert!(error.contains(key), "{text}: {error}");
    };
    refused("cascades.rays=8", "4, 16 or 64");
    refused("cascades.rays=-4", "cascades.rays");
    refused("cascades.interval=0.1", "cascades.interval");
    refused("cascades.interval=1e9", "cascades.interval");
    refused("cascades.interval=nan", "cascades.interval");
    refused("cascades.spacing=0", "cascades.spacing");
    refused("cascades.overlap=1.5", "cascades.overlap");
    refused("cascades.merge=bilinear", "bilinear_fix");
    refused("cascades.preset=godot", "high");
    refused("cascades.probes=3", "probes");
    for name in Cascades::PRESETS {
        let settings = cascades(|c| *c = Cascades::preset(name).unwrap());
        assert!(Solver::new(settings).is_ok(), "{name}");
    }
    let settings = cascades(|c| c.spacing = f32::NAN);
    assert!(matches!(Solver::new(settings), Err(Error::Value { .. })));
}

#[test]
fn queries_agree_with_the_picture() {
    let light = solve(&bounces(1), &jumble(40, 30, 5));
    for [x, y] in [[3, 4], [20, 11], [39, 29]] {
        let at = [x as f32, y as f32];
        assert_eq!(light.at(x, y), light.pixels()[(y * 40 + x) as usize]);
        if !light.solid()[(y * 40 + x) as usize] {
            assert_eq!(light.over(at, [at[0] + 1.0, at[1] + 1.0]), light.at(x, y));
        }
    }
}
