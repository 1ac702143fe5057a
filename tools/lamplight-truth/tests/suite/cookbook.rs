//! The recipes of `docs/cookbook.md`: the page shows each scene as it is, and each scene gives the light that its
//! recipe promises.

use lamplight::scene::{Material, SceneSky};
use lamplight::{Direct, Light, Rgb, Scene, Shape, Sky, Solver};
use std::fs;
use std::path::{Path, PathBuf};

const RECIPES: [&str; 14] = [
    "dusk",
    "fireflies",
    "flashlight",
    "fog",
    "forest",
    "lantern",
    "lava",
    "leaves",
    "neon",
    "skyline",
    "sunbeams",
    "torch",
    "water",
    "window",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The light of a recipe with its own settings; `change` may change the scene first.
fn light(name: &str, change: impl FnOnce(&mut Scene)) -> Light {
    let mut scene = Scene::load(root().join(format!("scenes/cookbook/{name}.toml"))).unwrap();
    change(&mut scene);
    let cells = scene.cells().unwrap();
    assert_eq!(scene.warnings(&cells), Vec::<String>::new(), "{name}");
    Solver::new(scene.resolve_settings().unwrap()).unwrap().solve(&cells).unwrap().clone()
}

fn sum(rgb: Rgb) -> f32 {
    rgb.iter().sum()
}

/// Returns whether a page has a scene as a block of TOML, to the letter.
fn shows(page: &str, scene: &str) -> bool {
    page.contains(&format!("```toml\n{scene}```"))
}

#[test]
fn the_page_shows_every_recipe() {
    let folder = root().join("scenes/cookbook");
    let files = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let mut names: Vec<String> =
        files.map(|path| path.file_stem().unwrap().to_string_lossy().into_owned()).collect();
    names.sort();
    assert_eq!(names, RECIPES);
    let page = fs::read_to_string(root().join("docs/cookbook.md")).unwrap();
    for name in RECIPES {
        let scene = fs::read_to_string(folder.join(format!("{name}.toml"))).unwrap();
        assert!(shows(&page, &scene), "docs/cookbook.md does not show {name}.toml as it is");
        assert!(
            !shows(&page, &scene.replacen("size", "Size", 1)),
            "{name}: a change is not noticed"
        );
    }
}

#[test]
fn a_torch_is_orange_and_casts_a_shadow_that_is_not_black() {
    let light = light("torch", |_| ());
    let [red, green, blue] = light.at(80, 62);
    assert!(red > 2.0 * green && green > 2.0 * blue, "{red} {green} {blue}");
    let shadow = sum(light.at(128, 62));
    assert!(shadow > 0.0 && shadow < 0.2 * sum(light.at(80, 62)), "{shadow}");
}

#[test]
fn a_thicker_flame_is_a_brighter_light() {
    let wall = |radius| {
        let light = light("torch", |scene| {
            scene.sky = Sky::BLACK.into();
            *scene.shapes.last_mut().unwrap() =
                Shape::circle([48.0, 44.0], radius).antialias(true).material(Material::Fire);
        });
        sum(light.at(90, 44))
    };
    let ratio = wall(4.0) / wall(2.0);
    // The light grows as the area, less the little that the flame absorbs of its own.
    assert!((3.7..4.0).contains(&ratio), "{ratio}");
}

#[test]
fn a_flashlight_shows_its_beam_and_lights_the_cave_by_what_it_meets() {
    let (whole, black) = (
        light("flashlight", |_| ()),
        light("flashlight", |scene| {
            scene.shapes.iter_mut().for_each(|shape| {
                shape.albedo = Some([0.0; 3]);
            })
        }),
    );
    let (beam, beside) = ([90, 56], [20, 40]);
    let at = |light: &Light, [x, y]: [u32; 2]| sum(light.at(x, y));
    assert!(at(&whole, beam) > 4.0 * at(&whole, beside), "no beam");
    assert!(at(&whole, beside) > 0.05 && at(&black, beside) == 0.0, "no light from the rock");
}

#[test]
fn a_window_lights_the_room_and_its_pane_absorbs_blue() {
    let tinted = light("window", |_| ());
    let clear = light("window", |scene| {
        scene.shapes.retain(|shape| shape.tint == [1.0; 3]);
    });
    let (tinted, clear) = (tinted.at(80, 45), clear.at(80, 45));
    assert!(sum(tinted) > 0.5, "{tinted:?}");
    assert!(tinted[2] < 0.8 * clear[2] && tinted[0] > 0.8 * clear[0], "{tinted:?} {clear:?}");
}

#[test]
fn neon_tubes_light_in_their_own_colours() {
    let light = light("neon", |_| ());
    let (pink, blue) = (light.at(20, 34), light.at(140, 34));
    assert!(pink[0] > 1.5 * pink[2] && pink[2] > 3.0 * pink[1], "{pink:?}");
    assert!(blue[2] > 3.0 * blue[0], "{blue:?}");
}

#[test]
fn fog_scatters_the_light_of_the_lamp_into_the_shadow() {
    let fog = light("fog", |_| ());
    let smoke = light("fog", |scene| scene.shapes.last_mut().unwrap().albedo = None);
    let clear = light("fog", |scene| {
        scene.shapes.pop();
    });
    // The lamp is orange, the sky is blue.
    let orange = |light: &Light| light.at(106, 48)[0] / light.at(106, 48)[2];
    assert!(orange(&fog) > 1.2 * orange(&clear), "{} {}", orange(&fog), orange(&clear));
    assert!(sum(fog.at(20, 50)) > 1.2 * sum(smoke.at(20, 50)));
    assert!(sum(smoke.at(20, 50)) < 0.9 * sum(clear.at(20, 50)));
}

#[test]
fn at_dusk_the_sun_casts_a_shadow_in_the_light_of_the_sky() {
    let light = light("dusk", |_| ());
    let (lit, shadow) = (light.at(56, 62), light.at(140, 62));
    assert!(shadow[0] < 0.5 * lit[0], "{lit:?} {shadow:?}");
    assert!(shadow[2] / shadow[0] > 1.5 * lit[2] / lit[0], "{lit:?} {shadow:?}");
}

#[test]
fn in_a_skyline_walls_to_the_west_are_warm_and_walls_to_the_east_blue() {
    let dusk = light("skyline", |_| ());
    // Before the west and the east wall of the tower.
    let (west, east) = (dusk.at(115, 30), dusk.at(133, 30));
    assert!(west[0] > 1.5 * west[2] && east[2] > 1.5 * east[0], "{west:?} {east:?}");
    let dawn = light("skyline", |scene| {
        let SceneSky::Radiance(Sky::Panorama(panorama)) = &scene.sky else { panic!("no panorama") };
        scene.sky = panorama.clone().turned(0.5 * std::f32::consts::PI).into();
    });
    // Turned from the west to above, the glow reaches the street between the houses.
    assert!(sum(dawn.at(74, 76)) > 2.0 * sum(dusk.at(74, 76)));
}

#[test]
fn a_lantern_lays_its_panes_on_the_floor() {
    let lantern = light("lantern", |_| ());
    let plain = light("lantern", |scene| {
        (scene.lamps[0].cookie, scene.lamps[0].direct) = (None, Direct::Exact);
    });
    // The middles of a red, a blue and a green pane.
    let [red, blue, green] = [[124, 51], [118, 20], [103, 26]].map(|[x, y]| lantern.at(x, y));
    assert!(red[0] > 4.0 * red[1] && red[0] > 4.0 * red[2], "{red:?}");
    assert!(blue[2] > 4.0 * blue[0] && blue[2] > 4.0 * blue[1], "{blue:?}");
    assert!(green[1] > 2.0 * green[0] && green[1] > 2.0 * green[2], "{green:?}");
    // Of the lead between the panes only what walls send on is seen.
    let (lead, without) = (lantern.at(95, 47), plain.at(95, 47));
    assert!(sum(lead) < 0.4 * sum(without), "{lead:?} {without:?}");
    // Turned by half of the angle between two petals, red and blue change places.
    let turned = light("lantern", |scene| {
        let cookie = scene.lamps[0].cookie.as_mut().unwrap();
        cookie.turn += 0.25 * std::f32::consts::PI;
    });
    let [x, y] = [124, 51];
    assert!(turned.at(x, y)[2] > turned.at(x, y)[0], "{:?}", turned.at(x, y));
}

#[test]
fn water_absorbs_red_first() {
    let light = light("water", |_| ());
    let red = |y| light.at(80, y)[0] / light.at(80, y)[2];
    assert!(red(76) < 0.5 * red(30), "{} {}", red(30), red(76));
    assert!(light.at(80, 76)[2] > 0.5 * light.at(80, 30)[2]);
}

#[test]
fn the_shade_of_leaves_is_green() {
    let light = light("leaves", |_| ());
    let (shade, open) = (light.at(60, 62), light.at(8, 62));
    assert!(sum(shade) < 0.7 * sum(open), "{shade:?} {open:?}");
    assert!(shade[1] > 1.1 * shade[0] && shade[1] > 1.3 * shade[2], "{shade:?}");
}

#[test]
fn lava_lights_its_cave_without_a_lamp() {
    let cave = light("lava", |scene| assert!(scene.lamps.is_empty()));
    let cold = light("lava", |scene| {
        scene.shapes.iter_mut().for_each(|shape| shape.emission = [0.0; 3]);
    });
    let [red, green, blue] = cave.at(100, 50);
    assert!(red > 3.0 * green && green > blue, "{red} {green} {blue}");
    assert!(sum(cave.at(100, 50)) > 20.0 * sum(cold.at(100, 50)));
    // Under the hole in the roof, the sky shows.
    let [red, _, blue] = cave.at(30, 4);
    assert!(blue > red, "{red} {blue}");
}

#[test]
fn each_firefly_lights_only_what_is_near() {
    let wood = light("fireflies", |_| ());
    let moonlit = light("fireflies", |scene| scene.lamps.clear());
    let near = wood.at(123, 62);
    assert!(near[1] > near[0] && near[0] > 2.0 * near[2], "{near:?}");
    assert!(sum(near) > 3.0 * sum(wood.at(127, 24)), "{near:?} {:?}", wood.at(127, 24));
    let moon = moonlit.at(4, 40);
    assert!(moon[2] > 1.5 * moon[1] && moon[1] > 1.5 * moon[0], "{moon:?}");
}

#[test]
fn a_sun_between_trunks_makes_beams_that_run_side_by_side() {
    let light = light("forest", |_| ());
    // Along the direction of the sun, 52° down: in a beam, and in the shadow of the second trunk.
    let along = |x: f32, px: f32| {
        let (sin, cos) = 52.0f32.to_radians().sin_cos();
        sum(light.at((x + px * cos) as u32, (20.0 + px * sin) as u32))
    };
    for px in [0.0, 10.0, 20.0] {
        let (beam, shadow) = (along(80.0, px), along(63.0, px));
        assert!(beam > 1.5 * shadow, "{px}: {beam} {shadow}");
    }
}

#[test]
fn sunbeams_are_bright_in_the_dark_and_thick_fog_swallows_them() {
    let thin = light("sunbeams", |_| ());
    let thick = light("sunbeams", |scene| scene.shapes[0].opacity *= 10.0);
    // The second beam, and the dark above it.
    let (beam, dark) = (sum(thin.at(70, 58)), sum(thin.at(70, 42)));
    assert!(beam > 4.0 * dark, "{beam} {dark}");
    assert!(sum(thick.at(70, 58)) < 0.4 * beam, "{:?}", thick.at(70, 58));
}
