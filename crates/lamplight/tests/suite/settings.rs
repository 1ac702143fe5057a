//! Settings: defaults, presets, layers, text, and every refusal's message.

use crate::common::raymarch_of;
use lamplight::settings::{
    Blend, Denoise, Fade, Flood, Hit, Holographic, MethodSettings, Noise, Polar, Raymarch,
    ShadowFilter, Spacing, Sweeps, Temporal, Traversal,
};
use lamplight::{Bounces, Cells, Falloff, Light, Method, Quality, Settings, SettingsTable, Solver};
use serde_json::{Value, json};

/// A table with these texts set one after the other, as flags do.
fn flags(texts: &[&str]) -> SettingsTable {
    let mut table = SettingsTable::default();
    texts.iter().for_each(|text| table.set_from_text(text).unwrap());
    table
}

fn resolved(texts: &[&str]) -> Settings {
    flags(texts).resolve().unwrap()
}

/// A table's settings of one method, whichever the table chooses.
fn of(method: Method, table: &SettingsTable) -> MethodSettings {
    let mut table = table.clone();
    table.set("method", method.name());
    table.resolve().unwrap().method
}

fn raymarch(table: &SettingsTable) -> Raymarch {
    of(Method::Raymarch, table).as_raymarch().unwrap().clone()
}

fn file(text: &str) -> SettingsTable {
    toml::from_str(text).unwrap()
}

#[test]
fn defaults_light_a_room() {
    let defaults = SettingsTable::default();
    assert!(defaults.is_empty());
    let settings = defaults.resolve().unwrap();
    assert_eq!(settings, Settings::default());
    settings.check().unwrap();
    assert_eq!(settings.method(), Method::Holographic);
    assert_eq!(settings.bounces, Bounces::Count(2));
    assert_eq!(settings.wall_depth, 24.0);
    let r = raymarch(&defaults);
    assert_eq!(r, Raymarch::default());
    assert_eq!(r.temporal, Temporal { history_length: 0, reject: true });
    assert_eq!(r.denoise, Denoise { passes: 4, strength: 2.0 });
    assert_eq!((r.rays, r.hit, r.noise, r.spacing), (32, Hit::Edge, Noise::Blue, Spacing::Even));
    assert!(!r.attenuation);
    // The defaults of Bigos (2020).
    assert_eq!((r.emission_multiplier, r.emission_range, r.emission_dropoff), (1.0, 2.0, 2.0));
}

#[test]
fn presets_have_the_numbers_of_their_sources() {
    let godot = raymarch(&flags(&["raymarch.preset=godot"]));
    assert_eq!(godot, Raymarch::preset("godot").unwrap());
    assert_eq!((godot.rays, godot.steps), (32, 128));
    assert_eq!((godot.hit, godot.hit_distance, godot.least_step), (Hit::Distance, 0.5, 1.0));
    assert_eq!((godot.spacing, godot.noise), (Spacing::Golden, Noise::White));
    let unity = raymarch(&flags(&["raymarch.preset=unity"]));
    assert_eq!((unity.rays, unity.steps), (16, 16));
    assert_eq!((unity.hit, unity.hit_distance, unity.spacing), (Hit::Distance, 0.8, Spacing::Even));
    assert_eq!(raymarch(&flags(&["raymarch.preset=default"])), Raymarch::default());
    // The sources have no blur; one that is asked for comes anyway.
    assert_eq!((godot.denoise.passes, unity.denoise.passes), (0, 0));
    let blurred = raymarch(&flags(&["raymarch.preset=godot", "denoise.passes=3"]));
    assert_eq!(blurred.denoise, Denoise { passes: 3, ..Denoise::default() });
    assert!(Raymarch::PRESETS.iter().all(|name| Raymarch::preset(name).is_some()));
    assert_eq!(Raymarch::preset("unreal"), None);
}

#[test]
fn presets_of_polar_and_flood_have_the_numbers_of_their_sources() {
    let p = Polar::preset("gamemaker").unwrap();
    let table = flags(&["polar.preset=gamemaker"]);
    assert_eq!(of(Method::Polar, &table), p.clone().into());
    assert_eq!(
        (p.traversal, p.shadow_filter, p.blend),
        (Traversal::Step, ShadowFilter::Nearest, Blend::Add)
    );
    assert_eq!((p.density, p.translucent, p.falloff), (1.0, false, Some(Falloff::Linear)));
    let f = Flood::preset("seed").unwrap();
    assert_eq!(of(Method::Flood, &flags(&["flood.preset=seed"])), f.clone().into());
    assert_eq!((f.rays, f.matter_rays, f.bounce_rays, f.rounds), (16, 16, 8, 20));
    assert_eq!((f.decay, f.sweeps, f.fade), (0.125, Sweeps::Seed, Fade::Seed));
    for method in Method::ALL {
        for preset in method.presets() {
            resolved(&[&format!("{}.preset={preset}", method.name())]);
        }
    }
}

#[test]
fn keys_beside_a_preset_win_in_any_order() {
    for texts in
        [["raymarch.preset=godot", "raymarch.rays=7"], ["raymarch.rays=7", "raymarch.preset=godot"]]
    {
        let mut table: Value = json!({ "raymarch": {} });
        for text in texts {
            let (key, value) = text.split_once('=').unwrap();
            let value = value.parse().map_or(json!(value), |n: u32| json!(n));
            table["raymarch"][key.trim_start_matches("raymarch.")] = value;
        }
        let table: SettingsTable = serde_json::from_value(table).unwrap();
        let r = raymarch(&table);
        assert_eq!(r, Raymarch { rays: 7, ..Raymarch::preset("godot").unwrap() });
    }
}

#[test]
fn flags_win_over_the_file_key_by_key() {
    let mut table =
        file("bounces = 2\n[raymarch]\nrays = 8\nnoise = 'white'\n[temporal]\nhistory_length = 9");
    table.merge(flags(&["raymarch.rays=64", "denoise.passes=3"]));
    assert_eq!(table.resolve().unwrap().bounces, Bounces::Count(2));
    let r = raymarch(&table);
    assert_eq!((r.rays, r.noise), (64, Noise::White));
    assert_eq!((r.temporal.history_length, r.denoise.passes), (9, 3));
    // In the other order the number of the file applies.
    let mut table = flags(&["raymarch.rays=64"]);
    table.merge(file("[raymarch]\nrays = 8"));
    assert_eq!(raymarch(&table).rays, 8);
}

#[test]
fn a_preset_that_comes_later_undoes_its_methods_keys_and_no_others() {
    let mut table = file("bounces = 2\n[raymarch]\nrays = 8\nsteps = 5");
    table.merge(flags(&["raymarch.preset=unity", "raymarch.rays=9"]));
    assert_eq!(table.resolve().unwrap().bounces, Bounces::Count(2));
    assert_eq!(raymarch(&table), Raymarch { rays: 9, ..Raymarch::preset("unity").unwrap() });
    // A preset in the file stays beneath the flags.
    let mut table = file("[raymarch]\npreset = 'unity'");
    table.merge(flags(&["raymarch.steps=99"]));
    let unity = Raymarch::preset("unity").unwrap();
    assert_eq!(raymarch(&table), Raymarch { steps: 99, ..unity });
}

#[test]
fn flags_beside_a_preset_win_in_any_order() {
    for texts in
        [["raymarch.preset=godot", "raymarch.rays=7"], ["raymarch.rays=7", "raymarch.preset=godot"]]
    {
        let r = raymarch(&flags(&texts));
        assert_eq!(r, Raymarch { rays: 7, ..Raymarch::preset("godot").unwrap() });
    }
}

#[test]
fn text_is_read_as_numbers_words_and_booleans() {
    let settings = resolved(&[
        "method=raymarch",
        "bounces = 3",
        "wall_depth=2.5",
        "elevation=30deg",
        "seed=12345678901",
        "temporal.history_length=64",
        "temporal.reject=false",
        "denoise.strength=1",
        "raymarch.hit=distance",
        "raymarch.noise=\"golden\"",
        " raymarch.emission_range = 1e-2 ",
        "raymarch.attenuation = true",
    ]);
    assert_eq!(settings.bounces, Bounces::Count(3));
    assert_eq!((settings.wall_depth, settings.seed), (2.5, 12_345_678_901));
    assert_eq!(settings.elevation, 30f32.to_radians());
    let r = settings.method.as_raymarch().unwrap();
    assert_eq!(r.temporal, Temporal { history_length: 64, reject: false });
    assert_eq!(r.denoise.strength, 1.0);
    assert_eq!((r.hit, r.noise, r.emission_range), (Hit::Distance, Noise::Golden, 0.01));
    assert!(r.attenuation);
    assert_eq!(resolved(&["bounces=converged"]).bounces, Bounces::Converged);
    assert_eq!(resolved(&["bounces=feedback"]).bounces, Bounces::Feedback);
    assert_eq!(resolved(&["bounces=3", "bounces=4"]).bounces, Bounces::Count(4));
}

#[test]
fn invalid_setting_text_is_rejected() {
    for text in ["", "rays", "=5", ".=5", "raymarch.=5", ".rays=5", "raymarch..rays=5", " =5"] {
        let error = SettingsTable::default().set_from_text(text).unwrap_err().to_string();
        let expected = format!(
            "`setting` is {text}, but must be of the form key=value, such as bounces=2 or raymarch.rays=64"
        );
        assert_eq!(error, expected);
    }
}

/// Every setting with a range, with values just outside of it and the message.
const OUT_OF_RANGE: [(&str, &str, &str, &str); 20] = [
    ("wall_depth", "-0.5", "64.5", "from 0 to 64"),
    ("elevation", "0.04", "1.6", "from 0.05 to 1.5"),
    ("temporal.history_length", "-1", "4097", "from 0 to 4096"),
    ("denoise.passes", "-1", "7", "from 0 to 6"),
    ("denoise.strength", "-0.1", "16.5", "from 0 to 16"),
    ("raymarch.rays", "0", "65537", "from 1 to 65536"),
    ("raymarch.steps", "0", "65537", "from 1 to 65536"),
    ("raymarch.hit_distance", "0.001", "4.5", "from 0.01 to 4"),
    ("raymarch.least_step", "0.01", "8.5", "from 0.1 to 8"),
    ("raymarch.emission_multiplier", "-1", "1000.5", "from 0 to 1000"),
    ("raymarch.emission_range", "0", "1001", "from 0.001 to 1000"),
    ("raymarch.emission_dropoff", "-1", "16.5", "from 0 to 16"),
    ("raymarch.threshold", "-0.1", "1", "from 0 to 0.999"),
    ("flood.rays", "0", "4097", "from 1 to 4096"),
    ("flood.matter_rays", "-1", "4097", "from 0 to 4096"),
    ("flood.bounce_rays", "-1", "65", "from 0 to 64"),
    ("flood.rounds", "-1", "1025", "from 0 to 1024"),
    ("flood.decay", "-0.1", "1000001", "from 0 to 1000000"),
    ("polar.density", "0.2", "8.5", "from 0.25 to 8"),
    ("bounces", "-1", "257", "a whole number from 0 to 256, \"converged\" or \"feedback\""),
];

#[test]
fn values_out_of_range_are_rejected_by_key() {
    for (key, low, high, expected) in OUT_OF_RANGE {
        for value in [low, high] {
            let error = flags(&[&format!("{key}={value}")]).resolve().unwrap_err().to_string();
            // Whole numbers below 0 are of the wrong kind already.
            let whole = "a whole number of 0 or more";
            let right = [expected, whole].map(|e| format!("`{key}` is {value}, but must be {e}"));
            assert!(right.contains(&error), "{error}");
            assert!(value == "-1" || error == right[0], "{error}");
        }
    }
}

#[test]
fn the_ends_of_the_ranges_are_allowed() {
    for (key, _, _, expected) in OUT_OF_RANGE {
        let ends = expected.trim_start_matches("a whole number ").trim_start_matches("from ");
        let (low, high) = ends.split_once(" to ").unwrap();
        for value in [low, high.split(',').next().unwrap()] {
            flags(&[&format!("{key}={value}")]).resolve().unwrap();
        }
    }
}

#[test]
fn unknown_keys_and_values_are_rejected_with_the_valid_ones() {
    let cases = [
        ("glow=5", "`glow` is not a known key (known here: quality, method, bounces, "),
        (
            "ray=5",
            "`ray` is not a known key; did you mean `raymarch`? (known here: quality, method, ",
        ),
        ("raymarch.ray=5", "`raymarch.ray` is not a known key; did you mean `rays`? (known here: "),
        ("tempral.frames=5", "`tempral` is not a known key; did you mean `temporal`?"),
        (
            "denoise.pases=1",
            "`denoise.pases` is not a known key; did you mean `passes`? (known here: passes, strength)",
        ),
        ("method=magic", "`method` is \"magic\", but must be one of raymarch, flood, polar"),
        ("method=5", "`method` is "),
        (
            "bounces=often",
            "`bounces` is \"often\", but must be a whole number from 0 to 256, \"converged\" or \"feedback\"",
        ),
        ("bounces=1.5", "`bounces` is 1.5, but must be a whole number from 0 to 256"),
        (
            "raymarch.rays=many",
            "`raymarch.rays` is \"many\", but must be a whole number of 0 or more",
        ),
        ("raymarch.rays=1.5", "`raymarch.rays` is 1.5, but must be a whole number"),
        ("raymarch.rays=[1, 2]", "`raymarch.rays` is a list, but must be a whole number"),
        ("raymarch.rays.x=1", "`raymarch.rays` is a table, but must be a whole number"),
        ("raymarch=5", "`raymarch` is 5, but must be a table"),
        ("raymarch=[5]", "`raymarch` is a list, but must be a table"),
        ("foo=5", "`foo` is not a known key (known here: quality, method, "),
        (
            "raymarch.noise=pink",
            "`raymarch.noise` is \"pink\", but must be one of white, blue, golden",
        ),
        ("raymarch.hit=edgy", "`raymarch.hit` is \"edgy\", but must be edge or distance"),
        (
            "raymarch.attenuation=yes",
            "`raymarch.attenuation` is \"yes\", but must be true or false",
        ),
        ("temporal.reject=0", "`temporal.reject` is 0, but must be true or false"),
        ("wall_depth=deep", "`wall_depth` is \"deep\", but must be a number"),
        ("wall_depth=nan", "`wall_depth` is "),
        ("wall_depth=inf", "`wall_depth` is "),
        ("elevation=steep", "`elevation` is "),
        ("seed=-1", "`seed` is -1, but must be a whole number of 0 or more"),
        (
            "raymarch.preset=unreal",
            "`raymarch.preset` is \"unreal\", but must be one of default, fast, high, godot, unity",
        ),
        // A setting of another method.
        ("polar.rays=64", "`polar.rays` is not a known key"),
        ("flood.blend=max", "`flood.blend` is not a known key"),
        (
            "polar.traversal=run",
            "`polar.traversal` is \"run\", but must be one of edge, step, distance",
        ),
        (
            "polar.shadow_filter=round",
            "`polar.shadow_filter` is \"round\", but must be one of soft, linear, nearest",
        ),
        ("polar.blend=over", "`polar.blend` is \"over\", but must be one of add, max, screen"),
        ("polar.falloff=flat", "`polar.falloff` is \"flat\", but must be one of linear, smooth"),
        ("flood.sweeps=odd", "`flood.sweeps` is \"odd\", but must be even or seed"),
        ("flood.fade=out", "`flood.fade` is \"out\", but must be lamp or seed"),
        ("flood.preset=x", "`flood.preset` is \"x\", but must be one of default, fast, high, seed"),
        (
            "polar.preset=x",
            "`polar.preset` is \"x\", but must be one of default, fast, high, gamemaker",
        ),
        (
            "raymarch.preset=5",
            "`raymarch.preset` is 5, but must be one of default, fast, high, godot, unity",
        ),
    ];
    for (text, message) in cases {
        let error = flags(&[text]).resolve().unwrap_err().to_string();
        assert!(error.starts_with(message), "{text}: {error}");
    }
}

#[test]
fn invalid_settings_are_rejected_in_code_too() {
    for (key, change) in [
        ("wall_depth", (|s| s.wall_depth = f32::NAN) as fn(&mut Settings)),
        ("bounces", |s| s.bounces = Bounces::Count(257)),
        ("raymarch.least_step", |s| raymarch_of(s).least_step = f32::INFINITY),
        ("raymarch.rays", |s| raymarch_of(s).rays = 0),
        ("denoise.strength", |s| raymarch_of(s).denoise.strength = -1.0),
        ("temporal.history_length", |s| raymarch_of(s).temporal.history_length = 5000),
    ] {
        let mut settings = Settings::new(Method::Raymarch);
        change(&mut settings);
        let error = Solver::new(settings).unwrap_err().to_string();
        assert!(error.starts_with(&format!("`{key}` is ")), "{error}");
    }
}

#[test]
fn settings_survive_json_and_toml() {
    for method in Method::ALL {
        let mut odd = resolved(&[
            &format!("method={}", method.name()),
            "seed=9007199254740993",
            "temporal.history_length=8",
            "denoise.passes=2",
            "raymarch.preset=unity",
            "raymarch.hit_distance=0.7",
            "raymarch.emission_range=0.333333",
            "polar.preset=gamemaker",
            "flood.preset=seed",
            "cascades.preset=plain",
            "holographic.preset=fast",
        ]);
        assert_ne!(odd.method, MethodSettings::from(*method));
        for bounces in [Bounces::Converged, Bounces::Count(0), Bounces::Count(256)] {
            odd.bounces = bounces;
            for settings in [&odd, &Settings { bounces, ..Settings::new(*method) }] {
                let json = serde_json::to_string(settings).unwrap();
                assert_eq!(&serde_json::from_str::<Settings>(&json).unwrap(), settings, "{json}");
                assert_eq!(&SettingsTable::from(settings).resolve().unwrap(), settings);
                let text = toml::to_string(settings).unwrap();
                assert_eq!(&file(&text).resolve().unwrap(), settings, "{text}");
            }
        }
        assert_eq!(serde_json::to_value(&odd).unwrap()["bounces"], json!(256));
        odd.bounces = Bounces::Converged;
        assert_eq!(serde_json::to_value(&odd).unwrap()["bounces"], json!("converged"));
    }
}

#[test]
fn a_table_of_another_method_is_checked_and_left_out() {
    let table = flags(&["method=polar", "raymarch.rays=7"]);
    assert_eq!(table.resolve().unwrap(), Settings::new(Method::Polar));
    let error = flags(&["method=polar", "raymarch.rays=0"]).resolve().unwrap_err().to_string();
    assert!(error.starts_with("`raymarch.rays` is 0"), "{error}");
}

#[test]
fn bounces_are_read_from_words() {
    assert_eq!("0".parse::<Bounces>().unwrap(), Bounces::Count(0));
    assert_eq!("256".parse::<Bounces>().unwrap(), Bounces::Count(256));
    assert_eq!("converged".parse::<Bounces>().unwrap(), Bounces::Converged);
    assert_eq!("feedback".parse::<Bounces>().unwrap(), Bounces::Feedback);
    for bad in ["257", "-1", "", "Converged", "1.0"] {
        let error = bad.parse::<Bounces>().unwrap_err().to_string();
        let expected = "a whole number from 0 to 256, `converged` or `feedback`";
        assert_eq!(error, format!("`bounces` is {bad}, but must be {expected}"));
    }
    assert_eq!((Bounces::Count(7).limit(), Bounces::Converged.limit()), (7, Bounces::MAX));
}

#[test]
fn a_quality_is_a_preset_of_every_method() {
    for &quality in Quality::ALL {
        assert_eq!(quality.name().parse::<Quality>().unwrap(), quality);
        let by_key = flags(&[&format!("quality={}", quality.name())]);
        for &method in Method::ALL {
            let mut by_call = Settings::new(method);
            by_call.set_quality(quality).unwrap();
            let preset = format!("{}.preset={}", method.name(), quality.preset(method));
            let by_preset = resolved(&[&format!("method={}", method.name()), &preset]);
            assert_eq!(by_call, by_preset, "{method:?} {quality:?}");
            assert_eq!(of(method, &by_key), by_call.method);
        }
    }
    assert_eq!(resolved(&["quality=default"]), Settings::default());
    assert_ne!(resolved(&["quality=fast"]), resolved(&["quality=high"]));
}

#[test]
fn keys_and_presets_win_over_the_quality_of_their_layer() {
    let table = flags(&["quality=high", "holographic.gather_rays=9", "polar.preset=gamemaker"]);
    let high = Holographic::preset("high").unwrap();
    let expected = Holographic { gather_rays: 9, ..high };
    assert_eq!(of(Method::Holographic, &table), expected.into());
    assert_eq!(of(Method::Polar, &table), Polar::preset("gamemaker").unwrap().into());
    // A quality in a later layer undoes the methods' keys of the layers below, and no others.
    let mut layers = flags(&["bounces=3", "holographic.gather_rays=9", "quality=high"]);
    layers.merge(flags(&["quality=fast"]));
    let expected = resolved(&["bounces=3", "quality=fast"]);
    assert_eq!(layers.resolve().unwrap(), expected);
}

#[test]
fn an_unknown_quality_is_rejected_with_the_valid_ones() {
    for text in ["quality=ultra", "quality=3"] {
        let error = flags(&[text]).resolve().unwrap_err().to_string();
        assert!(error.contains("coarse, fast, default, high, paper"), "{error}");
    }
    let error = Settings::default().set_preset("best").unwrap_err().to_string();
    assert!(error.contains("holographic.preset") && error.contains("high"), "{error}");
}

#[test]
fn new_settings_take_effect_with_the_next_frame() {
    let mut cells = Cells::new(24, 16).unwrap();
    cells.lamps_mut().push(lamplight::Lamp { position: [6.5, 8.5], ..Default::default() });
    let first = Settings::new(Method::Cascades);
    let then = Settings::new(Method::Holographic);
    let mut solver = Solver::new(first).unwrap();
    solver.solve(&cells).unwrap();
    solver.set_settings(then.clone()).unwrap();
    let light = solver.solve(&cells).unwrap().clone();
    assert_eq!(&light, Solver::new(then.clone()).unwrap().solve(&cells).unwrap());
    let wrong = Settings { wall_depth: -1.0, ..then.clone() };
    assert!(solver.set_settings(wrong).is_err());
    assert_eq!(solver.settings(), &then);
}

#[test]
fn history_goes_on_if_the_settings_that_it_depends_on_stay() {
    let mut cells = Cells::new(40, 30).unwrap();
    for i in (0..40).map(|x| 4 * 40 + x) {
        let wall = lamplight::Matter { opacity: 1.0, albedo: [0.9; 3], ..lamplight::Matter::EMPTY };
        cells.set_matter(i, wall);
    }
    let glow = lamplight::Matter { opacity: 1.0, emission: [9.0; 3], ..lamplight::Matter::EMPTY };
    cells.set_matter(15 * 40 + 20, glow);
    let feedback =
        |method: MethodSettings| Settings { bounces: Bounces::Feedback, ..Settings::new(method) };
    let lit = |frames: &[Settings]| {
        let mut solver = Solver::new(frames[0].clone()).unwrap();
        frames.iter().for_each(|settings| {
            solver.set_settings(settings.clone()).unwrap();
            solver.solve(&cells).unwrap();
        });
        solver.light().clone()
    };
    let mean = |light: &Light| light.pixels().iter().map(|[r, ..]| f64::from(*r)).sum::<f64>();
    for method in [Method::Holographic, Method::Cascades] {
        let own = feedback(method.into());
        let direct = mean(&lit(std::slice::from_ref(&own)));
        let settled = mean(&lit(&vec![own.clone(); 8]));
        assert!(settled > 1.05 * direct, "{method:?}: bounces are {settled} of {direct}");
        let then = |changed: Settings| {
            let mut frames = vec![own.clone(); 8];
            frames.push(changed);
            mean(&lit(&frames))
        };
        let elevated = then(Settings { elevation: 0.3, ..own.clone() });
        assert!((elevated / settled - 1.0).abs() < 0.01, "{method:?}: {elevated} of {settled}");
        let moment = then(Settings { moment: true, ..own.clone() });
        assert!((moment / settled - 1.0).abs() < 0.01, "{method:?}: {moment} of {settled}");
        let mut fast = own.clone();
        fast.set_preset("fast").unwrap();
        let [alone, own_settled] = [1, 8].map(|frames| mean(&lit(&vec![fast.clone(); frames])));
        // What surfaces reflected by other settings differs a little.
        let bounced = (then(fast) - alone) / (own_settled - alone);
        assert!((0.8..1.2).contains(&bounced), "{method:?}: {bounced} of its bounces");
        // Another method has nothing to continue.
        let other = if method == Method::Cascades { Method::Holographic } else { Method::Cascades };
        let other = feedback(other.into());
        assert_eq!(then(other.clone()), mean(&lit(&[other])), "{method:?}");
    }
}

#[test]
fn a_table_knows_its_keys() {
    let table = flags(&["bounces=1", "raymarch.denoise.passes=2"]);
    for key in ["bounces", "raymarch", "raymarch.denoise", "raymarch.denoise.passes"] {
        assert!(table.contains(key), "{key}");
    }
    for key in ["", ".", "seed", "bounces.x", "raymarch.rays", "raymarch.", "raymarch.denoise.x"] {
        assert!(!table.contains(key), "{key}");
    }
}
