//! The recipes of `docs/cookbook.md`: the page shows each scene as it is, and each scene gives the light that its
//! recipe promises.

use lamplight::{Light, Rgb, Scene, Solver};
use std::fs;
use std::path::{Path, PathBuf};

const RECIPES: [&str; 7] = ["dusk", "fog", "leaves", "neon", "torch", "water", "window"];

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
    let smoke = light("fog", |scene| scene.shapes[0].albedo = None);
    let clear = light("fog", |scene| {
        scene.shapes.remove(0);
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
