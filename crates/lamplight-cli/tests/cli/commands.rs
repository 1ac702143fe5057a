//! All other commands, from the outside.

use super::sandbox::Sandbox;
use lamplight::Method;
use serde_json::Value;

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e} in {text}"))
}

#[test]
fn probe_prints_the_light_at_points() {
    let sandbox = Sandbox::small();
    let table = sandbox.run("probe small.toml 6.5,2.5 19.5,10 15,10").done();
    assert_eq!(table.lines().count(), 5, "{table}");
    assert!(table.lines().nth(4).unwrap().ends_with("wall"), "{table}");
    let answer = json(&sandbox.run("probe small.toml 6.5,2.5 19.5,10 15,10 --json").done());
    assert_eq!((&answer["width"], &answer["method"]), (&32.into(), &"holographic".into()));
    let points = answer["points"].as_array().unwrap();
    assert_eq!((&points[0]["x"], &points[0]["y"]), (&6.5.into(), &2.5.into()));
    let luminance = |i: usize| points[i]["luminance"].as_f64().unwrap();
    // Near the lamp it is bright; the wall's shadow is black without bounces.
    assert!(luminance(0) > 0.3, "{answer}");
    assert_eq!(luminance(1), 0.0, "{answer}");
    let red_over_blue =
        points[0]["light"][0].as_f64().unwrap() / points[0]["light"][2].as_f64().unwrap();
    // Holographic light is stored with 8 significant bits.
    assert!((red_over_blue - 2.5).abs() < 0.02, "the lamp's colour is lost: {answer}");
    assert_eq!([0, 1, 2].map(|i: usize| points[i]["solid"] == true), [false, false, true]);
}

#[test]
fn probe_agrees_with_the_picture_for_every_method() {
    let sandbox = Sandbox::small();
    let points = [[6, 2], [12, 9], [3, 17], [29, 1]];
    let asked: String = points.map(|[x, y]| format!("{x}.5,{y}.5 ")).concat();
    for method in Method::ALL {
        let name = method.name();
        sandbox
            .run(&format!("render small.toml --stage light -o {name}.exr -q --method {name}"))
            .done();
        let picture = image::load_from_memory(&sandbox.read(&format!("{name}.exr"))).unwrap();
        let picture = picture.to_rgb32f();
        let probe = sandbox.run(&format!("probe small.toml {asked} -q --json --method {name}"));
        let answer = json(&probe.done());
        for (i, [x, y]) in points.into_iter().enumerate() {
            for c in 0..3 {
                let said = answer["points"][i]["light"][c].as_f64().unwrap() as f32;
                let shown = picture.get_pixel(x, y).0[c];
                let apart = (said - shown).abs();
                assert!(apart <= 1e-5 * (1.0 + shown), "{name} at {x}, {y}: {said}, not {shown}");
            }
        }
    }
}

#[test]
fn sight_draws_what_viewers_see() {
    let sandbox = Sandbox::small();
    let said = sandbox.run("sight small.toml --from 4.5,10.5 -o seen.png --threads 1").done();
    assert!(
        said.starts_with("wrote seen.png: what one viewer sees of 32×20 cells, found in "),
        "{said}"
    );
    let grey = |file: &str, x: u32, y: u32| sandbox.picture(file).get_pixel(x, y).0[0];
    // In the open, on the wall, behind it, and through the glass.
    assert_eq!([grey("seen.png", 10, 3), grey("seen.png", 14, 10)], [255; 2]);
    assert_eq!([grey("seen.png", 20, 10), grey("seen.png", 15, 10)], [0; 2]);
    let both = "--from 4.5,10.5 --from=-3,30 --from 29.5,10.5 --scale 2 -o both.png -q";
    assert_eq!(sandbox.run(&format!("sight small.toml {both}")).done(), "");
    assert_eq!(sandbox.picture("both.png").dimensions(), (64, 40));
    assert_eq!([grey("both.png", 20, 6), grey("both.png", 58, 20)], [255; 2]);
    assert!((1..255).contains(&grey("both.png", 40, 20)), "through glass");
    let away = "--from 4.5,10.5 --direction=-180 --angle 90 -o away.exr -q";
    sandbox.run(&format!("sight small.toml {away}")).done();
    let exr = image::load_from_memory(&sandbox.read("away.exr")).unwrap().to_rgb32f();
    assert_eq!([exr.get_pixel(1, 10).0, exr.get_pixel(10, 10).0], [[1.0; 3], [0.0; 3]]);
    for (flags, says) in [
        ("--from 4,4 -o seen.jpg", "must end in .png"),
        ("--from 4 -o x.png", "two numbers with a comma"),
        ("--from 4,4 --range 0 -o x.png", "`sight[0].range` is 0, but must be"),
        ("--from 4,4 --angle 20 -o x.png", "--direction"),
        (
            "--from 4,4 --direction 400 --angle 20 -o x.png",
            "'400' for '--direction <DEGREES>': an angle is -360 to 360 degrees",
        ),
        (
            "--from 4,4 --direction 4 --angle -1 -o x.png",
            "'-1' for '--angle <DEGREES>': an angle is 0.06 to 360 degrees",
        ),
        ("--from 4,4 --backend gpu -o x.png", "on the CPU only"),
        ("--from 4,4 --scale 2 -o x.exr", "--scale is for pictures"),
    ] {
        sandbox.run(&format!("sight small.toml {flags}")).failed(2, &[says]);
    }
}

#[test]
fn stages_writes_every_picture_and_a_sheet() {
    let sandbox = Sandbox::small();
    let said = sandbox.run("stages small.toml -o a/b --scale 2").done();
    assert!(said.contains("8 pictures") && said.contains("contact-sheet.png"), "{said}");
    for stage in ["emission", "opacity", "albedo", "tint", "voronoi", "distance", "light", "final"]
    {
        let name = format!("a/b/{stage}.png");
        assert_eq!(sandbox.picture(&name).dimensions(), (64, 40), "{name}");
    }
    let sheet = sandbox.picture("a/b/contact-sheet.png");
    assert!(sheet.width() > 1000 && sheet.height() > 400, "{:?}", sheet.dimensions());
    assert_eq!(std::fs::read_dir(sandbox.path("a/b")).unwrap().count(), 9);
}

#[test]
fn bench_prints_a_line_for_each_case() {
    let sandbox = Sandbox::small();
    let said = sandbox
        .run("bench --method raymarch,polar --size 12x7,9x9 --threads 2 --bounces 0 --set raymarch.rays=4 --json")
        .done();
    let lines: Vec<Value> = said.lines().map(json).collect();
    assert_eq!(lines.len(), 4);
    assert_eq!((&lines[0]["width"], &lines[1]["height"]), (&12.into(), &9.into()));
    let methods = [Method::Raymarch, Method::Polar].into_iter().flat_map(|method| [method; 2]);
    for (line, method) in lines.iter().zip(methods) {
        assert_eq!((&line["method"], &line["backend"]), (&method.name().into(), &"cpu".into()));
        assert_eq!(line["threads"], 2);
        let number = |key: &str| line[key].as_f64().unwrap_or_else(|| panic!("{key} in {line}"));
        assert!(number("runs") >= 5.0);
        assert!(0.0 < number("min_ms") && number("min_ms") <= number("median_ms"), "{line}");
        assert!(line["stages_ms"][method.name()].as_f64().unwrap() <= number("median_ms") * 1.5);
    }
    assert!(lines[0]["yardstick_ratio"].is_null(), "nobody asked for it");
    let scene = json(&sandbox.run("bench --scene small.toml --json --method raymarch").done());
    assert_eq!((&scene["width"], &scene["scene"]), (&32.into(), &"small.toml".into()));
    let table = sandbox.run("bench --scene small.toml").done();
    assert!(table.contains("32×20") && table.contains("median ms"), "{table}");
}

#[test]
fn bench_times_the_yardstick_in_the_same_run() {
    let sandbox = Sandbox::small();
    let line = json(&sandbox.run("bench --size 64x48 --method raymarch --yardstick --json").done());
    let number = |key: &str| line[key].as_f64().unwrap_or_else(|| panic!("{key} in {line}"));
    let ratio = number("yardstick_ms") / number("median_ms");
    // Times are rounded to the microsecond.
    assert!((number("yardstick_ratio") / ratio - 1.0).abs() < 0.01, "{line}");
    let table = sandbox.run("bench --scene small.toml --yardstick").done();
    assert!(table.contains("yardstick ms") && table.contains("times faster"), "{table}");
}

#[test]
fn compare_has_a_row_for_each_preset() {
    let sandbox = Sandbox::small();
    let answer = json(&sandbox.run("compare small.toml --samples 64 --cells 50 --json").done());
    let rows = answer["rows"].as_array().unwrap();
    for method in Method::ALL {
        let refused = answer["refused"].as_array().unwrap();
        if refused.iter().any(|refusal| refusal["method"] == method.name()) {
            continue;
        }
        let of_method = rows.iter().filter(|row| row["method"] == method.name());
        let presets: Vec<_> = of_method.filter_map(|row| row["preset"].as_str()).collect();
        assert_eq!(presets, method.presets());
    }
    assert!(rows.iter().all(|row| row["flip"].is_null()), "there is no picture to compare");
    assert_eq!(answer["reference"]["cells"], 50);
    let said = sandbox
        .run("compare small.toml --methods raymarch --set raymarch.rays=5 --samples 64 --cells 50")
        .done();
    assert!(!said.contains("FLIP"), "{said}");
    for words in ["raymarch, as set", "raymarch, default", "raymarch, godot", "at 50 open cells"] {
        assert!(said.contains(words), "`{words}` is missing in {said}");
    }
}

#[test]
fn compare_measures_every_row() {
    let sandbox = Sandbox::small();
    let said = sandbox
        .run("compare small.toml --methods raymarch --sweep --samples 256 --report report")
        .done();
    for words in ["8 rays", "512 rays", "denoised", "godot", "unity", "1 frame", "64 frames"] {
        assert!(said.contains(words), "`{words}` is missing in {said}");
    }
    assert!(said.contains("its own standard error is"), "{said}");
    let page = String::from_utf8(sandbox.read("report/index.html")).unwrap();
    let pictures: Vec<_> = page.split("src=\"").skip(1).filter_map(|s| s.split_once('"')).collect();
    assert!(pictures.len() > 20);
    for (name, _) in &pictures {
        assert_eq!(sandbox.picture(&format!("report/{name}")).dimensions(), (32, 20), "{name}");
    }
    for link in ["src=\"http", "href=\"http", "url(", "<script", "@import"] {
        assert!(!page.contains(link), "the page leans on the net: {link}");
    }

    let answer = json(
        &sandbox.run("compare small.toml --methods raymarch --sweep --samples 256 --json").done(),
    );
    let rows = answer["rows"].as_array().unwrap();
    let error = |name: &str| {
        let row = rows.iter().find(|row| row["name"] == name).unwrap_or_else(|| panic!("{name}"));
        row["relative_rmse"].as_f64().unwrap()
    };
    assert!(error("raymarch, 512 rays") < 0.5 * error("raymarch, 8 rays"));
    assert!(error("raymarch, 32 rays, temporal, 64 frames") < error("raymarch, 32 rays"));
    // No method's errors are under the noise of what judges them: that is counted in.
    let own = answer["reference"]["relative_standard_error"].as_f64().unwrap();
    assert!(own > 0.0 && error("raymarch, 512 rays") > 0.5 * own, "{own}");
}

#[test]
fn compare_names_methods_that_cannot_light_the_scene() {
    let sandbox = Sandbox::new();
    sandbox.write("sky.toml", "size = [8, 8]\nsky = [1.0, 1.0, 1.0]\n");
    let said = sandbox.run("compare sky.toml --methods raymarch,polar --samples 16").done();
    assert!(said.contains("raymarch, default") && !said.contains("polar, default"), "{said}");
    assert!(said.contains("polar lights lamps only, and this scene has none"), "{said}");
}

#[test]
fn a_sun_shines_by_every_method() {
    let sandbox = Sandbox::new();
    sandbox.write("sun.toml", "size = [9, 9]\n[[sun]]\ndirection = \"90deg\"\nangle = \"1deg\"\n");
    for method in ["raymarch", "flood", "polar", "cascades", "holographic", "reference"] {
        let command = format!("probe sun.toml 4,4 --json --backend cpu --method {method}");
        let light = json(&sandbox.run(&command).done())["points"][0]["luminance"].as_f64().unwrap();
        assert!((light - 3.0 / std::f64::consts::TAU).abs() < 1e-4, "{method}: {light}");
    }
    sandbox.write("sun.toml", "size = [9, 9]\n[[sun]]\nangle = 0.1\n");
    sandbox.run("render sun.toml").failed(2, &["`sun[0].direction` is missing"]);
    sandbox.write("sun.toml", "size = [9, 9]\n[[sun]]\ndirection = 1.0\nangle = 0.9\n");
    sandbox.run("render sun.toml").failed(2, &["`sun[0].angle` is 0.9, but must be"]);
}

#[test]
fn a_spot_throws_its_beam_by_every_method() {
    let sandbox = Sandbox::new();
    let lamp = "[[lamp]]\nposition = [16.5, 8.5]\ncone = { direction = 0.0, angle = 1.0 }\n";
    sandbox.write("cone.toml", format!("size = [33, 17]\n{lamp}"));
    for method in ["raymarch", "flood", "polar", "cascades", "holographic", "reference"] {
        let at = |x: f32| {
            let command = format!("probe cone.toml {x},8.5 --json --backend cpu --method {method}");
            json(&sandbox.run(&command).done())["points"][0]["luminance"].as_f64().unwrap()
        };
        let (front, behind) = (at(26.5), at(6.5));
        assert!(front > 0.1 && behind <= 0.01 * front, "{method}: {front}, {behind} behind");
    }
}

#[test]
fn flood_keeps_light_between_frames() {
    let sandbox = Sandbox::small();
    let light = |frames: u32| {
        let command = format!("probe small.toml 22.5,1.5 --json --method flood --frames {frames}");
        json(&sandbox.run(&command).done())["points"][0]["luminance"].as_f64().unwrap()
    };
    assert!(light(8) > light(1));
}

#[test]
fn a_new_scene_can_be_lit() {
    let sandbox = Sandbox::new();
    let said = sandbox.run("new cave.toml").done();
    assert!(said.contains("lamplight render cave.toml"), "{said}");
    sandbox.run("render cave.toml --set holographic.preset=fast").done();
    assert_eq!(sandbox.picture("cave.png").dimensions(), (320, 180));
    sandbox.write("cave.toml", "mine");
    sandbox.run("new cave.toml").failed(2, &["cave.toml exists already"]);
    assert_eq!(sandbox.read("cave.toml"), b"mine");
    sandbox.run("new cave.toml --force").done();
    assert!(sandbox.read("cave.toml") != b"mine");
}

#[test]
fn info_lists_limits_and_methods() {
    let sandbox = Sandbox::new();
    let text = sandbox.run("info").done();
    assert!(text.contains(env!("CARGO_PKG_VERSION")) && text.contains("raymarch"), "{text}");
    let answer = json(&sandbox.run("info --json").done());
    assert_eq!(answer["limits"]["side"], lamplight::Cells::MAX_SIDE);
    assert!(answer["backends"]["cpu"]["threads"].as_u64().unwrap() >= 1);
}

#[test]
fn completions_manual_pages_and_schema_are_printed() {
    let sandbox = Sandbox::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = sandbox.run(&format!("completions {shell}")).done();
        assert!(script.contains("lamplight") && script.contains("render"), "{shell}");
    }
    for (command, title) in [("", "LAMPLIGHT"), ("render", "LAMPLIGHT-RENDER")] {
        let page = sandbox.run(&format!("man {command}")).done();
        assert!(page.contains(&format!(".TH {title} 1 ")), "{page}");
        for section in ["NAME", "SYNOPSIS", "\"EXIT STATUS\"", "EXAMPLES", "\"SEE ALSO\""] {
            assert!(page.contains(&format!(".SH {section}\n")), "{section} is missing in {page}");
        }
        assert!(!page.contains("EXTRA") && page.contains("143"), "{page}");
    }
    assert!(sandbox.run("man render").done().contains("exposure"));
    let schema = json(&sandbox.run("schema").done());
    assert!(schema["properties"]["lamp"].is_object(), "{schema}");
}

#[test]
fn help_is_folded_to_the_width_of_the_terminal() {
    let sandbox = Sandbox::new();
    for command in ["", "render", "compare", "stages", "probe", "sight", "new", "man"] {
        for columns in [40, 72] {
            let arguments: Vec<_> =
                [command, "--help"].into_iter().filter(|s| !s.is_empty()).collect();
            let mut command = sandbox.command(&arguments);
            let output = command.env("COLUMNS", columns.to_string()).output().unwrap();
            let help = String::from_utf8(output.stdout).unwrap();
            for line in help.lines().filter(|line| !line.starts_with("Usage:")) {
                assert!(line.chars().count() <= columns, "{columns} columns: {line}");
            }
        }
    }
}

#[test]
fn flags_of_compare_are_grouped_as_those_of_render_are() {
    let heading_of = |command: &str, flag: &str| {
        let help = Sandbox::new().run(&format!("{command} --help")).done();
        let before = help.split(&format!(" {flag}")).next().unwrap().to_owned();
        let heading = before.lines().rfind(|line| line.ends_with(':') && !line.starts_with(' '));
        heading.unwrap_or_default().to_owned()
    };
    for flag in ["--bounces", "--set", "--backend", "--threads", "--tonemap", "--scale"] {
        assert_eq!(heading_of("compare", flag), heading_of("render", flag), "{flag}");
    }
}

#[test]
fn help_names_the_defaults_that_hold() {
    let sandbox = Sandbox::new();
    for (command, expected) in [
        ("render", "`feedback` [default: the scene's, else 2]"),
        ("bench", "`feedback` [default: 0 in the built-in scene; of --scene its own, else 2]"),
    ] {
        let help = sandbox.run(&format!("{command} --help")).done();
        let words = help.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains(expected), "{words}");
    }
}

#[test]
fn help_and_version_go_to_stdout() {
    let sandbox = Sandbox::new();
    let help = sandbox.run("--help").done();
    for command in [
        "render",
        "compare",
        "stages",
        "probe",
        "sight",
        "bench",
        "info",
        "new",
        "completions",
        "man",
        "schema",
    ] {
        assert!(help.contains(&format!("  {command} ")), "{command} is missing in {help}");
    }
    assert!(sandbox.run("--version").done().contains(env!("CARGO_PKG_VERSION")));
    sandbox.run("").failed(2, &["Usage: lamplight"]);
}
