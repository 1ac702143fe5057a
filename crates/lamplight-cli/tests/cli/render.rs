//! `lamplight render`: its files and its output.

use super::sandbox::Sandbox;
use lamplight::{Scene, Settings, Solver};
use serde_json::Value;

#[test]
fn writes_a_picture_and_one_line() {
    let sandbox = Sandbox::small();
    let said = sandbox.run("render small.toml --threads 1").done();
    assert!(said.starts_with("wrote small.png: 32×20 cells lit by holographic in "), "{said}");
    assert!(said.ends_with(" ms on the CPU, 1 thread\n") && said.lines().count() == 1, "{said}");
    assert_eq!(sandbox.files(), ["small.png", "small.toml"]);
    let picture = sandbox.picture("small.png");
    assert_eq!(picture.dimensions(), (32, 20));
    // Bright at the lamp, dark behind the wall.
    assert!(picture.get_pixel(6, 10).0.iter().all(|&v| v > 200));
    assert!(picture.get_pixel(19, 10).0.iter().all(|&v| v < 100));
}

#[test]
fn quiet_prints_nothing_and_json_everything() {
    let sandbox = Sandbox::small();
    assert_eq!(sandbox.run("render small.toml --quiet").done(), "");
    let said = sandbox
        .run("render small.toml --json --threads 2 --bounces 1 --method raymarch --set raymarch.rays=7 -o x.png")
        .done();
    assert_eq!(said.lines().count(), 1, "{said}");
    let json: Value = serde_json::from_str(&said).unwrap();
    for (key, value) in [
        ("width", Value::from(32)),
        ("height", 20.into()),
        ("method", "raymarch".into()),
        ("backend", "cpu".into()),
        ("threads", 2.into()),
        ("output", "x.png".into()),
        ("stage", "final".into()),
    ] {
        assert_eq!(json[key], value, "{key}");
    }
    assert_eq!(json["settings"]["raymarch"]["rays"], 7);
    assert_eq!(json["settings"]["bounces"], 1);
    assert!(json["stages_ms"]["raymarch"].as_f64().unwrap() > 0.0);
}

#[test]
fn flags_win_over_the_scene() {
    let sandbox = Sandbox::small();
    let scene = String::from_utf8(sandbox.read("small.toml")).unwrap();
    sandbox.write(
        "set.toml",
        scene.replace("bounces = 0", "bounces = 2")
            + "method = \"raymarch\"\nraymarch.rays = 3\nseed = 5\n",
    );
    let settings = |flags: &str| {
        let said = sandbox.run(&format!("render set.toml --json {flags}")).done();
        serde_json::from_str::<Value>(&said).unwrap()["settings"].clone()
    };
    let as_written = settings("");
    assert_eq!((&as_written["bounces"], &as_written["seed"]), (&2.into(), &5.into()));
    assert_eq!(as_written["raymarch"]["rays"], 3);
    let changed = settings("--bounces converged --seed 9 --set raymarch.preset=unity");
    assert_eq!((&changed["bounces"], &changed["seed"]), (&"converged".into(), &9.into()));
    assert_eq!(changed["raymarch"]["rays"], 16);
}

/// The file has every float that the library finds, unchanged.
#[test]
fn exr_of_light_is_the_light_of_the_library() {
    let sandbox = Sandbox::small();
    sandbox.run("render small.toml --stage light -o light.exr --exposure 3 --threads 1 -q").done();
    let scene = Scene::load(sandbox.path("small.toml")).unwrap();
    let mut solver = Solver::new(scene.resolve_settings().unwrap()).unwrap();
    let light = solver.solve(&scene.cells().unwrap()).unwrap();
    let file = image::load_from_memory(&sandbox.read("light.exr")).unwrap().to_rgb32f();
    assert_eq!(file.dimensions(), (32, 20));
    let bits = |v: &f32| v.to_bits();
    let (found, expected) = (file.iter().map(bits), light.pixels().as_flattened().iter().map(bits));
    assert!(found.eq(expected));
}

/// The channels beside those of the light are its first moment.
#[test]
fn exr_of_light_holds_the_first_moment_if_it_was_found() {
    use exr::prelude::{FlatSamples, read_first_flat_layer_from_file};
    let sandbox = Sandbox::small();
    sandbox.run("render small.toml --stage light -o l.exr --set moment=true --threads 1 -q").done();
    let scene = Scene::load(sandbox.path("small.toml")).unwrap();
    let settings = scene.resolve_settings().unwrap();
    let mut solver = Solver::new(Settings { moment: true, ..settings }).unwrap();
    let light = solver.solve(&scene.cells().unwrap()).unwrap();
    let file = read_first_flat_layer_from_file(sandbox.path("l.exr")).unwrap();
    let channels = file.layer_data.channel_data.list;
    let moment = light.moment().unwrap();
    for (axis, name) in ["moment.x", "moment.y"].into_iter().enumerate() {
        for (c, suffix) in ["R", "G", "B"].into_iter().enumerate() {
            let name = format!("{name}.{suffix}");
            let channel = channels.iter().find(|channel| channel.name.to_string() == name);
            let FlatSamples::F32(found) = &channel.expect(&name).sample_data else { panic!() };
            assert!(found.iter().eq(moment.iter().map(|moment| &moment[axis][c])), "{name}");
        }
    }
    assert_eq!(channels.len(), 9);
}

#[test]
fn the_same_bytes_with_any_number_of_threads() {
    let sandbox = Sandbox::small();
    let bytes = |flags: &str| {
        sandbox
            .run(&format!("render small.toml --bounces 1 --stage light -o l.exr {flags}"))
            .done();
        sandbox.read("l.exr")
    };
    for method in ["raymarch", "cascades", "holographic"] {
        let one = bytes(&format!("--method {method} --threads 1"));
        let more = bytes(&format!("--method {method} --threads 3"));
        assert!(one == more, "threads change the light of {method}");
    }
    let one = bytes("--method raymarch --threads 1");
    assert!(one == bytes("--method raymarch --seed 0"), "another run changes the result");
    assert!(one != bytes("--method raymarch --seed 1"), "the comparison sees no difference");
}

#[test]
fn every_stage_is_a_picture() {
    let sandbox = Sandbox::small();
    let mut pictures = Vec::new();
    for stage in ["emission", "opacity", "albedo", "tint", "voronoi", "distance", "light", "final"]
    {
        sandbox.run(&format!("render small.toml --stage {stage} -o {stage}.png --scale 3")).done();
        let picture = sandbox.picture(&format!("{stage}.png"));
        assert_eq!(picture.dimensions(), (96, 60), "{stage}");
        let corner = *picture.get_pixel(0, 0);
        assert!(picture.pixels().any(|p| *p != corner), "{stage} shows nothing");
        assert!(!pictures.contains(&picture), "{stage} looks like another stage");
        pictures.push(picture);
    }
    // A cell of the wall is white in `opacity`, its 3×3 pixels alike; open space is black.
    let opacity = sandbox.picture("opacity.png");
    assert!((45..48).all(|x| (24..27).all(|y| opacity.get_pixel(x, y).0 == [255; 3])));
    assert_eq!(opacity.get_pixel(30, 0).0, [0; 3]);
    assert_eq!(sandbox.picture("tint.png").get_pixel(75, 30).0, [128, 230, 128]);
}

#[test]
fn the_reference_shows_the_same_scene() {
    let sandbox = Sandbox::small();
    let said = sandbox.run("render small.toml --method reference --samples 1024 --json").done();
    let json: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(
        (&json["method"], &json["settings"]["samples"]),
        (&"reference".into(), &1024.into())
    );
    assert!(json["settings"]["relative_standard_error"].as_f64().unwrap() > 0.0);
    let reference = sandbox.picture("small.png");
    sandbox.run("render small.toml -o ray.png --method raymarch --set raymarch.rays=512").done();
    let ray = sandbox.picture("ray.png");
    let mean = |p: &image::RgbImage| p.iter().map(|&v| f64::from(v)).sum::<f64>() / 1920.0;
    // Noise of 1024 paths moves the mean of a tone-mapped picture by less than a level of 256 or two.
    assert!((mean(&reference) - mean(&ray)).abs() < 2.0, "{} {}", mean(&reference), mean(&ray));
}

/// The mean of many frames is nearer to the truth than one frame.
#[test]
fn frames_average_the_noise_out() {
    let sandbox = Sandbox::small();
    let light = |flags: &str| {
        sandbox.run(&format!("render small.toml --stage light -o l.exr {flags}")).done();
        image::load_from_memory(&sandbox.read("l.exr")).unwrap().to_rgb32f()
    };
    let truth = light("--method raymarch --set raymarch.rays=4096");
    let error = |flags: &str| {
        let found = light(flags);
        found.iter().zip(truth.iter()).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt()
    };
    let (one, many) = (
        error("--method raymarch --set raymarch.rays=8"),
        error("--method raymarch --set raymarch.rays=8 --frames 16"),
    );
    // Independent noise would fall to a quarter.
    assert!(many < 0.5 * one, "the error of one frame is {one}, of sixteen {many}");
}

#[test]
fn exposure_and_tone_map_change_the_picture() {
    let sandbox = Sandbox::small();
    let mean = |flags: &str| {
        sandbox.run(&format!("render small.toml -o p.png {flags}")).done();
        sandbox.picture("p.png").iter().map(|&v| u64::from(v)).sum::<u64>()
    };
    let plain = mean("");
    assert!(mean("--exposure 1") > plain);
    assert!(mean("--exposure -1.5") < plain);
    let curves = ["none", "reinhard", "aces"].map(|curve| mean(&format!("--tonemap {curve}")));
    assert!(curves.iter().all(|&sum| sum != plain), "{curves:?} {plain}");
    assert_eq!(mean("--tonemap vivid"), plain);
}
