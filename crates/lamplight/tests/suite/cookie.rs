//! Cookies: where a lamp's picture lies, what it multiplies, and how scenes have it.

use crate::common::{jumble, rgb, seeded};
use image::{DynamicImage, Rgb32FImage, Rgba, RgbaImage};
use lamplight::resample::downsample;
use lamplight::settings::{Blend, MethodSettings, Polar};
use lamplight::{
    Bounces, Cells, Cone, Cookie, CookiePicture, CookiePixels, Direct, Lamp, Light, Matter, Method,
    Rgb, Scene, Settings, Solver, srgb,
};
use std::f32::consts::{FRAC_PI_2, TAU};
use std::path::Path;

const RED: Rgb = [1.0, 0.0, 0.0];
const GREEN: Rgb = [0.0, 1.0, 0.0];
const BLUE: Rgb = [0.0, 0.0, 1.0];
const WHITE: Rgb = [1.0; 3];
/// Rounding of products in another order.
const ROUNDING: f32 = 1e-6;

fn methods() -> Vec<(String, MethodSettings)> {
    let methods =
        [Method::Raymarch, Method::Cascades, Method::Holographic, Method::Flood, Method::Polar];
    let blends = [Blend::Max, Blend::Screen];
    let blended = blends.map(|blend| {
        (format!("polar, {blend:?}"), MethodSettings::from(Polar { blend, ..Polar::default() }))
    });
    methods
        .map(|method| (format!("{method:?}"), method.into()))
        .into_iter()
        .chain(blended)
        .collect()
}

fn light_with(method: &MethodSettings, cells: &Cells, bounces: u32) -> Light {
    let bounces = Bounces::Count(bounces);
    let settings = Settings { bounces, ..Settings::direct(method.clone()) };
    Solver::new(settings).unwrap().solve(cells).unwrap().clone()
}

/// A lamp that is exact in every method: its height changes no light.
fn lamp(position: [f32; 2]) -> Lamp {
    Lamp { position, height: Some(10.0), ..Lamp::default() }
}

fn lit_by(lamp: Lamp, mut cells: Cells) -> Cells {
    cells.lamps_mut().push(lamp);
    cells
}

fn quadrants() -> CookiePixels {
    CookiePixels::new([2, 2], &[RED, GREEN, BLUE, WHITE]).unwrap()
}

#[test]
fn a_picture_lies_as_it_is_drawn_and_turns_clockwise() {
    // Offsets of the middles of the texels: upper left, upper right, lower left, lower right.
    let corners = [[-10.0, -10.0], [10.0, -10.0], [-10.0, 10.0], [10.0, 10.0]];
    for (turn, colors) in [
        (0.0, [RED, GREEN, BLUE, WHITE]),
        (FRAC_PI_2, [BLUE, RED, WHITE, GREEN]),
        (2.0 * FRAC_PI_2, [WHITE, BLUE, GREEN, RED]),
        (-FRAC_PI_2, [GREEN, WHITE, RED, BLUE]),
    ] {
        let cookie = Cookie { turn, ..Cookie::new(quadrants(), 40.0) };
        // In the middle of a cell: so are the four places.
        let lamp = Lamp { cookie: Some(cookie.clone()), ..lamp([50.5, 40.5]) };
        let cells = lit_by(lamp, Cells::new(101, 81).unwrap());
        for (name, method) in methods() {
            let light = light_with(&method, &cells, 0);
            for ([dx, dy], color) in corners.into_iter().zip(colors) {
                let found = cookie.at([dx, dy]);
                assert!((0..3).all(|c| (found[c] - color[c]).abs() < 1e-5), "{turn}: {found:?}");
                let [r, g, b] = light.at((50.0 + dx) as u32, (40.0 + dy) as u32);
                let most = r.max(g).max(b);
                let shares = [r, g, b].map(|v| v / most);
                let near = (0..3).all(|c| (shares[c] - color[c]).abs() < 1e-4);
                assert!(
                    most > 0.1 && near,
                    "{name}, {turn}, ({dx}, {dy}): {shares:?}, not {color:?}"
                );
            }
        }
    }
}

#[test]
fn size_is_the_width_and_texels_are_square() {
    // Four columns, two rows.
    let pixels = CookiePixels::new([4, 2], &[WHITE; 8]).unwrap();
    let cookie = Cookie { turn: 0.0, ..Cookie::new(pixels, 80.0) };
    // Within the middles of the outer texels 1, half a texel further ½, another half 0.
    for (offset, value) in [
        ([0.0, 0.0], 1.0),
        ([29.9, 9.9], 1.0),
        ([-40.0, 0.0], 0.5),
        ([40.0, 0.0], 0.5),
        ([0.0, 20.0], 0.5),
        ([0.0, -20.0], 0.5),
        ([40.0, 20.0], 0.25),
        ([50.1, 0.0], 0.0),
        ([0.0, 30.1], 0.0),
        ([0.0, -30.1], 0.0),
        ([-1e30, 0.0], 0.0),
        ([f32::NAN, 0.0], 0.0),
    ] {
        let [found, ..] = cookie.at(offset);
        assert!((found - value).abs() < 1e-5, "{offset:?}: {found}, not {value}");
    }
}

#[test]
fn a_white_picture_changes_nothing_inside_and_all_outside() {
    let seed = 11;
    let scene = || {
        let mut cells = jumble(90, 70, seed);
        for y in 28..44 {
            (36..54).for_each(|x| cells.set(x, y, Matter::EMPTY));
        }
        cells.set_sky(lamplight::Sky::BLACK);
        cells
    };
    let white = CookiePixels::new([64, 64], &[WHITE; 64 * 64]).unwrap();
    let plain = lit_by(lamp([45.3, 36.1]), scene());
    let far = Cookie::new(white.clone(), 4000.0);
    let all = lit_by(Lamp { cookie: Some(far), ..lamp([45.3, 36.1]) }, scene());
    for (name, method) in methods() {
        for bounces in [0, 2] {
            let plain = light_with(&method, &plain, bounces);
            let found = light_with(&method, &all, bounces);
            let largest = plain.pixels().as_flattened().iter().copied().fold(0.0, f32::max);
            for (found, plain) in found.pixels().iter().zip(plain.pixels()) {
                let near = |c: usize| (found[c] - plain[c]).abs() <= ROUNDING * largest;
                assert!((0..3).all(near), "{name}, {bounces}: {found:?}, not {plain:?}");
            }
        }
    }
    // Without anything around, it is dark from half a texel beyond the edge on.
    let near = Cookie { turn: 0.7, ..Cookie::new(white, 40.0) };
    let open = Cells::new(90, 70).unwrap();
    let cells = lit_by(Lamp { cookie: Some(near.clone()), ..lamp([45.3, 36.1]) }, open.clone());
    let plain = lit_by(lamp([45.3, 36.1]), open);
    for (name, method) in methods() {
        let (plain, light) = (light_with(&method, &plain, 0), light_with(&method, &cells, 0));
        let mut counts = [0; 2];
        for (x, y) in (0..70).flat_map(|y| (0..90).map(move |x| (x, y))) {
            let offset = [x as f32 + 0.5 - 45.3, y as f32 + 0.5 - 36.1];
            let (found, plain) = (light.at(x, y)[1], plain.at(x, y)[1]);
            match near.at(offset)[1] {
                0.0 => {
                    assert_eq!(found, 0.0, "{name}, ({x}, {y})");
                    counts[0] += 1;
                }
                1.0 => {
                    assert!((found / plain - 1.0).abs() < 10.0 * ROUNDING, "{name}, ({x}, {y})");
                    counts[1] += 1;
                }
                _ => {}
            }
        }
        assert!(counts.iter().all(|&n| n > 1000), "{name}: {counts:?}");
    }
}

#[test]
fn pictures_multiply_the_light_of_every_kind_of_lamp() {
    let random = &mut seeded(12);
    for number in 0..6 {
        let size = [random.u32(1..9), random.u32(1..9)];
        let pixels: Vec<Rgb> =
            (0..size[0] * size[1]).map(|_| rgb(random).map(|v| 2.0 * v)).collect();
        let pixels = CookiePixels::new(size, &pixels).unwrap();
        let turn = random.f32() * TAU;
        let cookie = Cookie { turn, ..Cookie::new(pixels, 10.0 + 60.0 * random.f32()) };
        let position = [20.0 + 50.0 * random.f32(), 20.0 + 30.0 * random.f32()];
        let cone = Cone { direction: turn, angle: 2.5, softness: 0.4, profile: None };
        let plain = Lamp {
            color: rgb(random),
            cone: (number % 2 == 0).then_some(cone),
            intensity: if number == 3 { -4.0 } else { 4.0 },
            mask: if number == 4 { 2 } else { 255 },
            ..lamp(position)
        };
        // Light of which enough is left to be taken.
        let other = Lamp { direct: Direct::Exact, intensity: 1e3, ..lamp([40.2, 30.3]) };
        let cells = |lamp: Option<Lamp>| {
            let mut cells = Cells::new(89, 67).unwrap();
            cells
                .masks_mut()
                .iter_mut()
                .enumerate()
                .for_each(|(i, own)| *own = 1 + (i / 7 % 3) as u8);
            cells.lamps_mut().push(other.clone());
            cells.lamps_mut().extend(lamp);
            cells
        };
        let with = cells(Some(Lamp { cookie: Some(cookie.clone()), ..plain.clone() }));
        let (without, alone) = (cells(Some(plain)), cells(None));
        // `polar` has a cone by rays, of which a lamp that reaches less far has fewer.
        let rays = if number % 2 == 0 { 4 } else { 5 };
        for (name, method) in methods().into_iter().take(rays) {
            let [with, without, alone] =
                [&with, &without, &alone].map(|c| light_with(&method, c, 0));
            let mut changed = 0;
            for (x, y) in (0..67).flat_map(|y| (0..89).map(move |x| (x, y))) {
                let offset = [x as f32 + 0.5 - position[0], y as f32 + 0.5 - position[1]];
                let factors = cookie.at(offset);
                let [found, plain, alone] = [&with, &without, &alone].map(|light| light.at(x, y));
                for c in 0..3 {
                    let right = alone[c] + (plain[c] - alone[c]) * factors[c];
                    // Single precision of the sum with the bright lamp.
                    let off = (found[c] - right).abs();
                    assert!(
                        off <= 2e-5 * (1.0 + alone[c]),
                        "{name}, {number}, ({x}, {y}): {found:?}"
                    );
                    changed += usize::from((found[c] - plain[c]).abs() > 1e-4 * (1.0 + alone[c]));
                }
            }
            assert!(changed > 100, "{name}, {number}: the picture changes {changed} values");
        }
    }
}

#[test]
fn what_walls_send_on_is_multiplied_too() {
    // Red light on the left, blue light on the right, in a white room.
    let pixels = CookiePixels::new([2, 1], &[RED, BLUE]).unwrap();
    let wall = Matter { opacity: 1.0, albedo: [0.8; 3], ..Matter::EMPTY };
    let room = crate::common::room(81, 41, wall);
    let cookie = Some(Cookie::new(pixels, 80.0));
    let cells = lit_by(Lamp { cookie, ..lamp([40.5, 20.5]) }, room);
    for (name, method) in methods().into_iter().take(3) {
        let [direct, bounced] = [0, 2].map(|bounces| light_with(&method, &cells, bounces));
        let more = |x: u32, c: usize| bounced.at(x, 20)[c] - direct.at(x, 20)[c];
        assert!(more(8, 0) > 2.0 * more(8, 2) && more(72, 2) > 2.0 * more(72, 0), "{name}");
        assert!(more(8, 0) > 1e-3, "{name}: {}", more(8, 0));
        // The picture ends on the left, but red light is sent on to the right.
        assert!(direct.at(64, 20)[0] == 0.0 && bounced.at(64, 20)[0] > 0.0, "{name}");
    }
}

#[test]
fn a_coarser_grid_has_smaller_pictures() {
    let cookie = Some(Cookie::new(quadrants(), 40.0));
    let cells = lit_by(Lamp { cookie, ..lamp([50.0, 40.0]) }, Cells::new(100, 80).unwrap());
    let mut coarse = Cells::new(1, 1).unwrap();
    downsample(&cells, 4, &mut coarse).unwrap();
    assert_eq!(coarse.lamps()[0].cookie.as_ref().unwrap().size, 10.0);
}

#[test]
fn invalid_pixels_are_rejected() {
    for (size, pixels, message) in [
        ([0, 1], vec![], "`cookie.picture` is a picture of 0×1 px, but must be of at least"),
        ([2049, 1], vec![WHITE; 2049], "`cookie.picture` is a picture of 2049×1 px"),
        ([2, 2], vec![WHITE; 3], "`cookie.picture` is 3 pixels, but must be 2×2 pixels"),
        ([1, 1], vec![[0.0, -1.0, 0.0]], "`cookie.picture` is a picture with [0, -1, 0]"),
        ([1, 1], vec![[0.0, 0.0, f32::NAN]], "`cookie.picture` is a picture with [0, 0, NaN]"),
        ([1, 1], vec![[2e6, 0.0, 0.0]], "`cookie.picture` is a picture with [2000000, 0, 0]"),
    ] {
        let error = CookiePixels::new(size, &pixels).unwrap_err().to_string();
        assert!(error.starts_with(message), "{error}");
    }
    let check = |cookie: Cookie| {
        let lamp = Lamp { cookie: Some(cookie), ..Lamp::default() };
        lit_by(lamp, Cells::new(4, 4).unwrap()).check().unwrap_err().to_string()
    };
    let good = Cookie::new(quadrants(), 10.0);
    for (cookie, message) in [
        (
            Cookie { size: 0.0, ..good.clone() },
            "`lamp[0].cookie.size` is 0, but must be a number from 0.1 to 100000",
        ),
        (Cookie { size: f32::NAN, ..good.clone() }, "`lamp[0].cookie.size` is NaN"),
        (Cookie { size: 1e9, ..good.clone() }, "`lamp[0].cookie.size` is 1000000000"),
        (Cookie { turn: 90.0, ..good.clone() }, "`lamp[0].cookie.turn` is 90, but must be"),
        (
            Cookie::new("leaves.png", 10.0),
            "`lamp[0].cookie.picture` is \"leaves.png\", but must be pixels: a picture by its path belongs",
        ),
    ] {
        let error = check(cookie);
        assert!(error.starts_with(message), "{error}");
    }
    let lamp = Lamp { cookie: Some(good), ..Lamp::default() };
    lit_by(lamp, Cells::new(4, 4).unwrap()).check().unwrap();
}

fn scene(cookie: &str) -> String {
    format!("size = [8, 8]\n[[lamp]]\nposition = [4.0, 4.0]\ncookie = {cookie}\n")
}

#[test]
fn scene_files_have_pictures_by_path_and_as_rows() {
    let by_path = scene("{ picture = \"a/leaves.png\", size = 120, turn = \"90deg\" }");
    let by_path = Scene::from_toml(&by_path).unwrap();
    let cookie = by_path.lamps[0].cookie.clone().unwrap();
    assert_eq!(cookie, Cookie { turn: FRAC_PI_2, ..Cookie::new("a/leaves.png", 120.0) });
    assert_eq!(by_path.files(), [Path::new("a/leaves.png")]);
    let rows = scene("{ picture = [[\"#f00\", \"#0f0\"], [[0, 0, 1], \"#ffffff\"]], size = 40 }");
    let rows = Scene::from_toml(&rows).unwrap();
    assert_eq!(rows.lamps[0].cookie, Some(Cookie::new(quadrants(), 40.0)));
    assert!(rows.files().is_empty());
    for scene in [&by_path, &rows] {
        assert_eq!(Scene::from_toml(&scene.to_toml().unwrap()).unwrap(), *scene);
        assert_eq!(Scene::from_json(&scene.to_json().unwrap()).unwrap(), *scene);
    }
    let plain = Scene::new(8, 8).lamp(Lamp::default());
    assert!(!plain.to_toml().unwrap().contains("cookie"));
    for (cookie, message) in [
        ("{ size = 4 }", "`lamp[0].cookie.picture` is missing"),
        ("{ picture = \"a.png\" }", "`lamp[0].cookie.size` is missing"),
        ("{ picture = \"a.png\", size = 0 }", "`lamp[0].cookie.size` is 0, but must be"),
        ("{ picture = \"a.png\", size = nan }", "`lamp[0].cookie.size` is NaN"),
        ("{ picture = \"a.png\", size = 1e9 }", "`lamp[0].cookie.size` is 1000000000"),
        (
            "{ picture = \"a.png\", size = 4, angle = 1 }",
            "`lamp[0].cookie.angle` is not a known key",
        ),
        ("{ picture = 3, size = 4 }", "`lamp[0].cookie.picture` is 3, but must be the path"),
        ("{ picture = [], size = 4 }", "`lamp[0].cookie.picture` is a list of 0, but must be"),
        (
            "{ picture = [[]], size = 4 }",
            "`lamp[0].cookie.picture` is rows of which number 0 has 0",
        ),
        (
            "{ picture = [[\"#fff\"], [\"#fff\", \"#fff\"]], size = 4 }",
            "`lamp[0].cookie.picture` is rows of which number 1 has 2, but must be the path of an image, \
             or 1 to 2048 rows",
        ),
        (
            "{ picture = [[\"#fff\", [0, -1, 0]]], size = 4 }",
            "`lamp[0].cookie.picture` is rows with [0, -1, 0], but must be colours of 0 to 1e6",
        ),
        (
            "{ picture = [[\"red\"]], size = 4 }",
            "`lamp[0].cookie.picture[0][0]` is \"red\", but must be a list of 3 numbers",
        ),
    ] {
        let error = Scene::from_toml(&scene(cookie)).and_then(|scene| scene.cells()).unwrap_err();
        let error = error.to_string();
        let found = error.find(message);
        assert!(found.is_some(), "{cookie}: {error}");
    }
}

#[test]
fn images_are_decoded_once_per_file_times_alpha() {
    let folder = tempfile::tempdir().unwrap();
    let save = |name: &str, image: DynamicImage| image.save(folder.path().join(name)).unwrap();
    let bytes = RgbaImage::from_fn(2, 1, |x, _| {
        Rgba(if x == 0 { [255, 128, 0, 255] } else { [255, 255, 255, 51] })
    });
    save("a.png", bytes.into());
    let floats = Rgb32FImage::from_fn(1, 2, |_, y| image::Rgb([0.5, 3.0, y as f32]));
    save("b.exr", floats.into());
    save("wide.png", RgbaImage::new(2049, 1).into());
    let bright = Rgb32FImage::from_fn(1, 1, |_, _| image::Rgb([0.5, -3.0, 0.0]));
    save("bright.exr", bright.into());
    std::fs::write(folder.path().join("text.png"), "not a picture").unwrap();
    let load = |pictures: &[&str]| {
        let lamp = |picture: &&str| {
            format!(
                "[[lamp]]\nposition = [4, 4]\ncookie = {{ picture = \"{picture}\", size = 4 }}\n"
            )
        };
        let lamps: String = pictures.iter().map(lamp).collect();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, format!("size = [8, 8]\n{lamps}")).unwrap();
        let cells = Scene::load(&path).and_then(|scene| scene.cells());
        cells.map_err(|e| e.to_string().replace(&format!("{}/", folder.path().display()), ""))
    };
    let cells = load(&["a.png", "b.exr", "a.png"]).unwrap();
    let pixels: Vec<CookiePixels> = cells
        .lamps()
        .iter()
        .map(|lamp| match &lamp.cookie.as_ref().unwrap().picture {
            CookiePicture::Pixels(pixels) => pixels.clone(),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(pixels[0].size(), [2, 1]);
    let half = srgb::decode_u8(128);
    assert_eq!(pixels[0].pixels(), [[1.0, half, 0.0], [0.2; 3]]);
    assert_eq!(
        (pixels[1].size(), pixels[1].pixels()),
        ([1, 2], &[[0.5, 3.0, 0.0], [0.5, 3.0, 1.0]][..])
    );
    assert!(pixels[0].shares(&pixels[2]) && !pixels[0].shares(&pixels[1]));
    // The last of two lamps is named.
    for (name, problem) in [
        ("none.png", "none.png"),
        ("text.png", "text.png"),
        ("wide.png", "an image of 2049×1 px (wide.png), but must be of at most 2048×2048 px"),
        (
            "bright.exr",
            "an image with [0.5, -3, 0] at (0, 0) (bright.exr), but must be of values from 0",
        ),
    ] {
        let error = load(&["a.png", name]).unwrap_err();
        assert!(error.contains("`lamp[1].cookie.picture`") && error.contains(problem), "{error}");
    }
}
