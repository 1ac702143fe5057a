//! `lamplight bake`: worlds in tiles.

use super::sandbox::Sandbox;
use lamplight::world::{World, WorldSettings};
use lamplight::{Light, Scene};
use serde_json::Value;

const WORLD: &str = r##"
size = [200, 120]
sky = [0.1, 0.2, 0.3]
[[shape]]
rect = { min = [0, 90], max = [200, 120] }
albedo = [0.6, 0.4, 0.2]
[[lamp]]
position = [150, 40]
color = "#ffb060"
"##;

fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("world.toml", WORLD);
    sandbox
}

#[test]
fn tiles_make_the_picture_of_the_whole() {
    let sandbox = sandbox();
    let said = sandbox.run("bake world.toml -o tiles --tile 100 --bounces 0").done();
    assert!(said.contains("wrote 4 tiles of 200×120 cells into tiles"), "{said}");
    sandbox.run("render world.toml -q --bounces 0").done();
    let whole = sandbox.picture("world.png");
    let (mut largest, mut sum) = (0, 0.0);
    for (column, row) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let tile = sandbox.picture(&format!("tiles/{column}-{row}.png"));
        assert_eq!(tile.dimensions(), (100, if row == 0 { 100 } else { 20 }));
        for (x, y, found) in tile.enumerate_pixels() {
            let expected = whole.get_pixel(100 * column + x, 100 * row + y);
            for c in 0..3 {
                let difference = found[c].abs_diff(expected[c]);
                sum += f64::from(difference) / (3.0 * 200.0 * 120.0);
                // Light that sinks into the ground knows only the tile.
                if 100 * row + y < 90 {
                    largest = largest.max(difference);
                }
            }
        }
    }
    // Of 255: the far field, and another place of the method's lattice.
    assert!(largest < 8 && sum < 1.0, "{largest}, {sum}");
    let manifest: Value = serde_json::from_slice(&sandbox.read("tiles/bake.json")).unwrap();
    assert_eq!((&manifest["columns"], &manifest["rows"]), (&2.into(), &2.into()));
    assert_eq!(manifest["settings"]["bounces"], 0);
}

#[test]
fn tiles_pass_into_each_other_as_in_the_library() {
    let sandbox = sandbox();
    sandbox.run("bake world.toml -o tiles --tile 100 --format exr -q").done();
    let scene = Scene::load(sandbox.path("world.toml")).unwrap();
    let (cells, settings) = (scene.cells().unwrap(), scene.settings.resolve().unwrap());
    let world = World::new(&cells, WorldSettings::new(settings), |_, _| ()).unwrap();
    let mut tiles = world.light_tiles(100).unwrap();
    let window = tiles.windows()[1];
    let baked = image::load_from_memory(&sandbox.read("tiles/1-0.exr")).unwrap().to_rgb32f();
    let has_light =
        |light: &Light| baked.pixels().map(|pixel| pixel.0).eq(light.pixels().iter().copied());
    assert!(has_light(&tiles.light(window).unwrap()));
    assert!(!has_light(&world.light(window).unwrap()), "a tile that is not mixed passes");
}

#[test]
fn a_run_does_not_go_on_with_other_images() {
    let sandbox = sandbox();
    let image = |grey: u8| {
        let image = image::GrayImage::from_pixel(8, 8, image::Luma([grey]));
        image.save(sandbox.path("box.png")).unwrap();
    };
    image(200);
    let sprite = "\n[[shape]]\nsprite = { image = \"box.png\", center = [60, 60] }\nopacity = 1\n";
    sandbox.write("world.toml", WORLD.to_owned() + sprite);
    let bake = "bake world.toml -o tiles --tile 128 -q --bounces 0";
    sandbox.run(bake).done();
    image(200);
    sandbox.run(&format!("{bake} --resume")).done();
    image(100);
    sandbox.run(&format!("{bake} --resume")).failed(2, &["--resume", "scene"]);
}

#[test]
fn a_run_goes_on_where_it_was_broken_off() {
    let sandbox = sandbox();
    sandbox.run("bake world.toml -o tiles --tile 100 --format exr -q").done();
    let all = ["0-0", "1-0", "0-1", "1-1"].map(|tile| format!("tiles/{tile}.exr"));
    let before = all.each_ref().map(|name| sandbox.read(name));
    std::fs::remove_file(sandbox.path(&all[1])).unwrap();
    // What is whole is kept, whatever it shows.
    sandbox.write(&all[2], &before[3]);
    let resume = "bake world.toml -o tiles --tile 100 --format exr --resume";
    let said = sandbox.run(resume).done();
    assert!(said.contains("3 of them from before"), "{said}");
    assert!(sandbox.read(&all[1]) == before[1], "the same tile has other bytes");
    assert!(sandbox.read(&all[2]) == before[3]);
    sandbox.write(&all[0], "");
    sandbox.write(&all[1], &before[1][..before[1].len() / 2]);
    sandbox.write(&all[3], &before[0]);
    let said = sandbox.run(resume).done();
    assert!(said.contains("1 of them from before"), "{said}");
    for tile in [0, 1, 3] {
        assert!(sandbox.read(&all[tile]) == before[tile], "{} is not lit again", all[tile]);
    }
    let again = "bake world.toml -o tiles --tile 100 --format exr";
    sandbox.run(&format!("{again} --resume --halo 8")).failed(2, &["halo", "leave --resume out"]);
    sandbox.run(&format!("{again} --resume --bounces 5")).failed(2, &["settings"]);
    sandbox.write("world.toml", WORLD.replace("150", "151"));
    sandbox.run(&format!("{again} --resume")).failed(2, &["scene"]);
    sandbox.write("tiles/bake.json", "{");
    sandbox.run(&format!("{again} --resume")).failed(2, &["bake.json", "hint: leave --resume out"]);
    let said = sandbox.run(&format!("{again} --json")).done();
    let summary: Value = serde_json::from_str(&said).unwrap();
    assert_eq!((&summary["tiles"], &summary["kept"]), (&4.into(), &0.into()));
    assert!(sandbox.read(&all[2]) != before[3]);
}

#[test]
fn tiles_of_a_larger_bake_are_removed() {
    let sandbox = sandbox();
    sandbox.run("bake world.toml -o tiles --tile 64 --format exr -q --bounces 0").done();
    assert!(sandbox.path("tiles/3-1.exr").is_file());
    for other in ["4-0.exr", "3-1.png", "notes.txt"] {
        sandbox.write(&format!("tiles/{other}"), "mine");
    }
    sandbox.write("world.toml", sized("[64, 64]"));
    let said = sandbox.run("bake world.toml -o tiles --tile 64 --bounces 0").done();
    assert!(said.starts_with("wrote 1 tile of 64×64 cells"), "{said}");
    let entries = std::fs::read_dir(sandbox.path("tiles")).unwrap();
    let mut left: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["0-0.png", "3-1.png", "4-0.exr", "bake.json", "notes.txt"]);
    // A manifest of anything else lists no tiles.
    sandbox.write("tiles/bake.json", r#"{ "format": "txt", "columns": 1e30, "rows": [] }"#);
    sandbox.run("bake world.toml -o tiles --tile 64 --bounces 0 -q").done();
    assert!(sandbox.path("tiles/3-1.png").is_file());
    // Nor does one of more tiles than there are in any world.
    let absurd = r#"{ "format": "png", "columns": 4000000000, "rows": 4000000000 }"#;
    sandbox.write("tiles/bake.json", absurd);
    sandbox.run("bake world.toml -o tiles --tile 64 --bounces 0 -q").done();
    assert!(sandbox.path("tiles/3-1.png").is_file());
    // One of the largest world does.
    sandbox.write("tiles/bake.json", r#"{ "format": "png", "columns": 1024, "rows": 1024 }"#);
    sandbox.run("bake world.toml -o tiles --tile 64 --bounces 0 -q").done();
    assert!(!sandbox.path("tiles/3-1.png").exists());
}

#[test]
fn the_help_offers_only_what_can_be_baked() {
    let sandbox = sandbox();
    let help = sandbox.run("bake --help").done();
    for wrong in ["--scale", "polar", "flood", "or gpu"] {
        assert!(!help.contains(wrong), "{wrong} is in {help}");
    }
    assert!(
        help.contains("auto or cpu") && help.contains("raymarch, cascades, holographic"),
        "{help}"
    );
    let error = sandbox.run("bake world.toml -o tiles --quality paper");
    let error = error.failed(2, &["holographic as its paper has it", "another quality"]);
    assert!(!error.contains("or holographic"), "{error}");
    sandbox.run("bake world.toml -o tiles --method polar").failed(2, &["'polar'", "holographic"]);
}

fn sized(size: &str) -> String {
    WORLD.replace("size = [200, 120]", &format!("size = {size}"))
}

#[test]
fn scenes_are_larger_than_a_grid() {
    let sandbox = sandbox();
    sandbox.write("world.toml", sized("[17000, 120]"));
    sandbox
        .run("render world.toml")
        .failed(2, &["17000×120", "16384", "`lamplight bake world.toml`"]);
    sandbox
        .run("bake world.toml -o tiles --tile 2048 --halo 16 --bounces 0 --quality fast -q")
        .done();
    assert_eq!(sandbox.picture("tiles/8-0.png").dimensions(), (616, 120));
    sandbox.write("world.toml", sized("[17000, 120]\nlayers.opacity = \"a.png\""));
    sandbox.run("bake world.toml -o tiles").failed(2, &["layers", "16384"]);
    sandbox.write("world.toml", sized("[70000, 120]"));
    sandbox.run("bake world.toml -o tiles").failed(2, &["70000×120", "65536"]);
}

#[test]
fn what_cannot_be_baked_is_refused() {
    let sandbox = sandbox();
    sandbox.run("bake world.toml -o tiles --backend gpu").failed(2, &["CPU", "--backend cpu"]);
    sandbox.run("bake world.toml -o tiles --scale 2").failed(2, &["--scale"]);
    sandbox.run("bake world.toml -o world.toml").failed(2, &["it is a file, not a directory"]);
    sandbox.run("bake missing.toml -o tiles").failed(2, &["missing.toml"]);
    sandbox.write("world.toml", format!("{WORLD}direct = \"exact\"\n"));
    let whole = "hint: `lamplight render world.toml` lights it in one piece";
    sandbox
        .run("bake world.toml -o a/b/c")
        .failed(2, &["world.toml: ", "(150, 40)", "shadow map", "glow", whole]);
    sandbox
        .run("bake world.toml -o a/b/c --quality paper")
        .failed(2, &["world.toml: holographic as its paper has it", whole]);
    sandbox.write("world.toml", format!("{WORLD}[light]\nmethod = \"polar\"\n"));
    sandbox
        .run("bake world.toml -o a/b/c")
        .failed(2, &["world.toml: polar knows no light", "choose raymarch", whole]);
    sandbox.write("world.toml", sized("[17000, 120]") + "[light]\nmethod = \"polar\"\n");
    let error = sandbox.run("bake world.toml -o a/b/c").failed(2, &["world.toml: polar knows"]);
    assert!(!error.contains("render"), "{error}");
    assert_eq!(sandbox.files(), ["world.toml"]);
    std::fs::create_dir_all(sandbox.path("tiles/bake.json")).unwrap();
    sandbox.run("bake world.toml -o tiles").failed(
        2,
        &["cannot write tiles/bake.json: it is a directory", "hint: remove it, or name"],
    );
}

#[test]
fn layers_in_tiles_are_read_and_never_overwritten() {
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.path("art")).unwrap();
    let wall = image::RgbaImage::from_pixel(64, 64, image::Rgba([200, 120, 60, 255]));
    wall.save(sandbox.path("art/1-0.png")).unwrap();
    let layers = "size = [128, 128]\nlayers = { tile = 64, albedo = \"art/{x}-{y}.png\" }\n";
    sandbox.write("world.toml", format!("{layers}[[lamp]]\nposition = [32, 32]\n"));
    sandbox.run("bake world.toml -o tiles --tile 64 -q --bounces 0").done();
    // The background is white but for one tile.
    let [white, painted] = ["0-0", "1-0"].map(|tile| {
        let [r, _, b] = sandbox.picture(&format!("tiles/{tile}.png")).get_pixel(32, 32).0;
        r.abs_diff(b)
    });
    assert!(white < 3 && painted > 20, "{white}, {painted}");
    let said =
        sandbox.run("bake world.toml -o art --tile 64").failed(2, &["the scene reads this file"]);
    assert!(said.contains("1-0.png"), "{said}");
    assert_eq!(sandbox.picture("art/1-0.png").get_pixel(0, 0).0, [200, 120, 60]);
    assert!(!sandbox.path("art/0-0.png").exists());
}
