//! Hints for what users often try.

use super::sandbox::Sandbox;
use serde_json::Value;

/// Arguments, and parts of stderr in their order.
const CASES: &[(&str, &[&str])] = &[
    (
        "render small.toml --preset high",
        &["'--preset'", "tip: use '--quality fast'", "holographic.preset"],
    ),
    ("probe small.toml 1,1 --preset high", &["'--preset'", "tip: use '--quality fast'"]),
    (
        "render small.toml --set preset=quality",
        &["`preset`", "hint: use `--quality`", "holographic.preset"],
    ),
    ("render small.toml --set light.preset=quality", &["`preset`", "hint: use `--quality`"]),
    ("render small.toml --set exposure=1", &["`exposure`", "hint: use `--exposure 1`"]),
    ("render small.toml --set display.exposure=-1", &["hint: use `--exposure -1`"]),
    ("render small.toml --set display.tonemap=agx", &["hint: use `--tonemap agx`"]),
    (
        "render preset.toml",
        &["preset.toml: line 3", "`light.preset`", "did you mean `holographic.preset`?"],
    ),
    ("render -", &["cannot read -", "hint: name a file"]),
    ("render nope.png", &["cannot read nope.png", "hint: `lamplight new nope.toml`"]),
    ("new -", &["not -", "hint: try `lamplight new scene.toml`"]),
    ("probe small.toml 32,5", &["hint: x runs from 0 to below 32, y from 0 to below 20"]),
    ("probe small.toml -5,-5", &["the point -5,-5 lies outside", "hint: x and y start at 0"]),
    ("probe small.toml 1,1 -0.5,3", &["the point -0.5,3 lies outside"]),
    ("probe small.toml 3,-1", &["the point 3,-1 lies outside the 32×20 scene"]),
    ("probe small.toml 1,1 --exposure 1", &["'--exposure'", "tip: probe prints linear light"]),
    ("render small.toml other.toml", &["'other.toml'", "tip: one scene at a time"]),
    (
        "render small.toml --qualty fast",
        &["'--qualty'", "tip: a similar argument exists: '--quality'"],
    ),
    ("render small.toml --quality best", &["'best'", "coarse, fast, default, high, paper"]),
];

#[test]
fn are_given() {
    let sandbox = Sandbox::small();
    sandbox.write("preset.toml", "size = [4, 4]\n[light]\npreset = \"quality\"\n");
    let mut wrong = Vec::new();
    for (arguments, says) in CASES {
        let run = sandbox.run(arguments);
        if std::panic::catch_unwind(|| run.failed(2, says)).is_err() {
            wrong.push(*arguments);
        }
    }
    assert!(wrong.is_empty(), "see above for {wrong:#?}");
}

#[test]
fn settings_are_taken_as_scene_files_name_them() {
    let sandbox = Sandbox::small();
    let settings = |flags: &str| {
        let out = sandbox.run(&format!("render small.toml --json {flags}")).done();
        serde_json::from_str::<Value>(&out).unwrap()["settings"].clone()
    };
    assert_eq!(settings("--set light.bounces=1")["bounces"], 1);
    let holographic = |flags: &str| settings(flags)["holographic"].clone();
    let (high, preset) =
        (holographic("--quality high"), holographic("--set holographic.preset=high"));
    assert_eq!(high, preset);
    assert_eq!(high, holographic("--set quality=high"));
    assert_ne!(high, holographic("--quality fast"));
    assert_eq!(settings("--method polar --quality high")["polar"]["density"], 2.0);
    assert_eq!(settings("--quality default"), settings(""));
    // A key beside it, and a preset that is named, win.
    assert_eq!(settings("--quality high --set wall_depth=3")["wall_depth"], 3.0);
    assert_eq!(holographic("--quality fast --set holographic.preset=high"), preset);
}

#[test]
fn a_quality_picks_the_row_of_a_comparison() {
    let sandbox = Sandbox::small();
    let flags = "--samples 1 --cells 9 --json --methods holographic,cascades --quality high";
    let out = sandbox.run(&format!("compare small.toml {flags}")).done();
    let answer: Value = serde_json::from_str(&out).unwrap();
    let rows: Vec<_> = answer["rows"].as_array().unwrap().iter().map(|row| &row["name"]).collect();
    assert_eq!(
        rows,
        ["cascades, high", "holographic, high"].map(Value::from).iter().rev().collect::<Vec<_>>()
    );
}
