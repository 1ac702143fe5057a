//! Layers in tiles: the same cells as those of one image.

use crate::common::*;
use image::{DynamicImage, Rgba, RgbaImage, imageops};
use lamplight::scene::SceneWorld;
use lamplight::settings::Holographic;
use lamplight::world::{World, WorldSettings, WorldSource};
use lamplight::{Cells, GridWindow, Scene, Settings};
use std::fs;
use tempfile::TempDir;

const SIZE: [u32; 2] = [150, 100];
const LAYERS: [&str; 8] =
    ["emission", "glow", "opacity", "albedo", "tint", "color", "normal", "mask"];

/// A folder with a scene of all layers twice: `whole.toml` in one piece, and `tiles.toml` in tiles of 64 px.
fn folder(seed: u64) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let random = &mut seeded(seed);
    let mut scenes = ["", "tile = 64\n"].map(|tile| format!("size = {SIZE:?}\n[layers]\n{tile}"));
    for layer in LAYERS {
        let image = RgbaImage::from_fn(SIZE[0], SIZE[1], |x, y| {
            // The tile in the middle of the first row is empty.
            let empty = (64..128).contains(&x) && y < 64;
            let alpha =
                if empty { 0 } else { random.u8(..).max(if layer == "mask" { 255 } else { 0 }) };
            Rgba([random.u8(1..), random.u8(1..), random.u8(1..), alpha])
        });
        let path = folder.path();
        image.save(path.join(format!("{layer}.png"))).unwrap();
        fs::create_dir(path.join(layer)).unwrap();
        for (x, y) in [(0, 0), (2, 0), (0, 1), (1, 1), (2, 1)] {
            let [width, height] = [64.min(SIZE[0] - 64 * x), 64.min(SIZE[1] - 64 * y)];
            let tile = imageops::crop_imm(&image, 64 * x, 64 * y, width, height).to_image();
            tile.save(path.join(format!("{layer}/{x}_{y}.png"))).unwrap();
        }
        scenes[0] += &format!("{layer} = \"{layer}.png\"\n");
        scenes[1] += &format!("{layer} = \"{layer}/{{x}}_{{y}}.png\"\n");
    }
    for (name, scene) in ["whole", "tiles"].iter().zip(scenes) {
        let shapes = "[[shape]]\nrect = { min = [60, 20], max = [70, 80] }\nalbedo = \"#f08030\"\n\
                      [[lamp]]\nposition = [20, 20]\n";
        fs::write(folder.path().join(format!("{name}.toml")), scene + shapes).unwrap();
    }
    folder
}

fn scene(folder: &TempDir, name: &str) -> Scene {
    Scene::load_world(folder.path().join(format!("{name}.toml"))).unwrap()
}

fn grid_window(first: [u32; 2], size: [u32; 2]) -> GridWindow {
    GridWindow { first, size }
}

#[test]
fn tiles_are_the_cells_of_the_whole_image() {
    let folder = folder(1);
    let [whole, tiles] = ["whole", "tiles"].map(|name| scene(&folder, name));
    let cells = whole.cells().unwrap();
    assert!(cells == tiles.cells().unwrap());
    // Windows in one tile, across several, and all of it.
    let world = SceneWorld::new(&tiles).unwrap();
    for (first, size) in
        [([3, 5], [20, 30]), ([60, 60], [10, 10]), ([63, 0], [66, 100]), ([0, 0], SIZE)]
    {
        let window = grid_window(first, size);
        assert!(world.cells(window).unwrap() == cells.window(window).unwrap(), "{window:?}");
    }
    // Another tile is other cells.
    fs::copy(folder.path().join("albedo/0_0.png"), folder.path().join("albedo/1_0.png")).unwrap();
    assert!(cells != tiles.cells().unwrap());
}

#[test]
fn a_world_in_files_has_the_light_of_the_same_cells() {
    let folder = folder(2);
    let tiles = scene(&folder, "tiles");
    let cells: Cells = scene(&folder, "whole").cells().unwrap();
    let settings =
        || WorldSettings { halo: 16, ..WorldSettings::new(Settings::new(Holographic::default())) };
    let source = SceneWorld::new(&tiles).unwrap();
    let from_files = World::new(&source, settings(), |_, _| ()).unwrap();
    let from_memory = World::new(&cells, settings(), |_, _| ()).unwrap();
    for window in from_files.tiles(64).unwrap() {
        let [files, memory] = [&from_files, &from_memory].map(|world| world.light(window).unwrap());
        assert!(files.pixels() == memory.pixels(), "{window:?}");
    }
}

#[test]
fn a_tile_is_read_when_a_window_needs_it() {
    let folder = folder(3);
    let tiles = scene(&folder, "tiles");
    fs::write(folder.path().join("tint/2_1.png"), "no image").unwrap();
    let world = SceneWorld::new(&tiles).unwrap();
    assert!(world.cells(grid_window([0, 0], [128, 100])).is_ok());
    let error = world.cells(grid_window([100, 60], [50, 10])).unwrap_err().to_string();
    assert!(error.contains("tint/2_1.png") && error.contains("`layers.tint`"), "{error}");
    assert!(tiles.files().iter().any(|file| file.ends_with("tint/2_1.png")));
    assert!(!tiles.files().iter().any(|file| file.ends_with("tint/1_0.png")));
}

#[test]
fn worlds_in_tiles_are_larger_than_a_grid() {
    let folder = tempfile::tempdir().unwrap();
    let text = "size = [20000, 20000]\nlayers = { tile = 100, opacity = \"{y}/{x}.png\" }";
    fs::write(folder.path().join("scene.toml"), text).unwrap();
    fs::create_dir(folder.path().join("199")).unwrap();
    let wall = DynamicImage::ImageLuma8(image::GrayImage::from_pixel(100, 100, image::Luma([255])));
    wall.save(folder.path().join("199/198.png")).unwrap();
    let tiles = scene(&folder, "scene");
    let world = SceneWorld::new(&tiles).unwrap();
    let cells = world.cells(grid_window([19_750, 19_850], [100, 100])).unwrap();
    let expected =
        grid(100, 100, |x, y| if x >= 50 && y >= 50 { WALL } else { Default::default() });
    assert!(cells.opacity() == expected.opacity());
}

#[test]
fn errors_say_what_tiles_have_to_be() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    RgbaImage::new(64, 50).save(path.join("0_0.png")).unwrap();
    let error = |layers: &str| {
        fs::write(path.join("scene.toml"), format!("size = [150, 100]\n[layers]\n{layers}"))
            .unwrap();
        let cells = Scene::load(path.join("scene.toml")).and_then(|scene| scene.cells());
        cells.unwrap_err().to_string()
    };
    let tiles = "albedo = \"{x}_{y}.png\"";
    let cases: [(String, &[&str]); 7] = [
        (tiles.into(), &["line 3", "`layers.albedo` is in tiles", "tile = 512"]),
        ("tile = 64\nalbedo = \"{x}.png\"".into(), &["line 4", "is {x}.png", "both {x} and {y}"]),
        (
            "tile = 64\nalbedo = \"a.png\"".into(),
            &["line 3", "`layers.tile`", "emission/{x}_{y}.png"],
        ),
        (format!("tile = 9\n{tiles}"), &["line 3", "`layers.tile` is 9", "16 to 4096"]),
        (format!("tile = \"a\"\n{tiles}"), &["line 3", "`layers.tile`"]),
        (format!("tile = 64\n{tiles}"), &["64×50 px", "0_0.png", "64×64 px, the `tile` 64"]),
        (
            "tile = 64\nalbedo = \"{y}-{x}.png\"".into(),
            &["line 4", "no tile", "0-0.png", "150×100"],
        ),
    ];
    for (layers, words) in cases {
        let message = error(&layers);
        assert!(words.iter().all(|words| message.contains(words)), "{layers}: {message}");
    }
}
