//! `--backend gpu`: the same light, found elsewhere. Needs a GPU, a software one at least.

use super::sandbox::Sandbox;
use serde_json::Value;

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn render_says_where_it_was_lit_and_shows_the_same() {
    let sandbox = Sandbox::small();
    let flags = "--method raymarch --stage light --set wall_depth=3";
    sandbox.run(&format!("render small.toml --backend cpu {flags} -o cpu.exr")).done();
    let said = sandbox.run(&format!("render small.toml --backend gpu {flags} -o gpu.exr")).done();
    assert!(said.contains("lit by raymarch in ") && said.contains(" ms on the GPU ("), "{said}");
    let light = |name: &str| image::load_from_memory(&sandbox.read(name)).unwrap().to_rgb32f();
    let (cpu, gpu) = (light("cpu.exr"), light("gpu.exr"));
    let mean = cpu.iter().sum::<f32>() / cpu.len() as f32;
    let worst = cpu.iter().zip(gpu.iter()).map(|(a, b)| (a - b).abs() / a.max(mean));
    let worst = worst.fold(0.0, f32::max);
    assert!(worst < 1e-3, "{worst}");
    let told = sandbox.run("render small.toml --backend gpu --method raymarch --json").done();
    let told = json(&told);
    assert_eq!(told["backend"], "gpu");
    let stages = told["stages_ms"].as_object().unwrap();
    assert!(stages.contains_key("raymarch") || stages.contains_key("gpu"), "{told}");
}

#[test]
fn probe_asks_the_gpu() {
    let sandbox = Sandbox::small();
    let probe = |backend: &str| {
        let flags = format!("probe small.toml 9.5,10.5 --method raymarch --backend {backend}");
        json(&sandbox.run(&format!("{flags} --json")).done())
    };
    let (gpu, cpu) = (probe("gpu"), probe("cpu"));
    assert_eq!((&gpu["backend"], &cpu["backend"]), (&"gpu".into(), &"cpu".into()));
    let light = |answer: &Value| answer["points"][0]["luminance"].as_f64().unwrap();
    assert!((light(&gpu) / light(&cpu) - 1.0).abs() < 1e-3, "{gpu} {cpu}");
}

#[test]
fn bench_times_it_and_says_what_frames_take() {
    let bench = |flags: &str| {
        let flags = format!("bench --backend gpu --method polar --size 32x24 --json {flags}");
        json(&Sandbox::new().run(&flags).done())
    };
    let timed = bench("");
    assert_eq!(timed["backend"], "gpu");
    assert!(timed["median_ms"].as_f64() > Some(0.0) && timed["runs"].as_u64() >= Some(5));
    let told = bench("--cost");
    assert_eq!(told["runs"], 0);
    for key in ["dispatches", "bytes_read", "bytes_written", "bytes_held"] {
        assert!(told[key].as_u64() > Some(0) && told[key] == timed[key], "{key}: {told} {timed}");
    }
}

#[test]
fn info_lists_it() {
    let answer = json(&Sandbox::new().run("info --json").done());
    assert!(!answer["adapters"].as_array().unwrap().is_empty());
    let methods = ["raymarch", "flood", "polar", "cascades", "holographic"];
    assert_eq!(answer["backends"]["gpu"]["methods"], Value::from(methods.to_vec()));
    let adapter = &answer["adapters"][0];
    assert_eq!(adapter["tier"], "native");
    assert!(adapter["times_stages"].is_boolean() && adapter["side"].as_u64() >= Some(8192));
}
