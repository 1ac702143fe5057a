//! `--backend gpu`: the same light, computed on a GPU. Needs at least a software one.

use super::sandbox::Sandbox;
use serde_json::Value;

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// The largest difference between the light of the GPU and of the CPU, relative to the latter or, in
/// the dark, to its mean.
fn apart(sandbox: &Sandbox, flags: &str) -> f32 {
    let light = |backend: &str| {
        let name = format!("{backend}.exr");
        let run =
            format!("render small.toml -q --stage light --backend {backend} -o {name} {flags}");
        sandbox.run(&run).done();
        floats(sandbox, &name)
    };
    let (cpu, gpu) = (light("cpu"), light("gpu"));
    let mean = cpu.iter().sum::<f32>() / cpu.len() as f32;
    let apart = cpu.iter().zip(&gpu).map(|(a, b)| (a - b).abs() / a.max(mean));
    apart.fold(0.0, f32::max)
}

fn floats(sandbox: &Sandbox, name: &str) -> Vec<f32> {
    image::load_from_memory(&sandbox.read(name)).unwrap().to_rgb32f().into_raw()
}

#[test]
fn render_names_the_gpu_and_matches_the_cpu() {
    let sandbox = Sandbox::small();
    let worst = apart(&sandbox, "--method raymarch --set wall_depth=3");
    assert!(worst < 1e-3, "{worst}");
    let said = sandbox.run("render small.toml --backend gpu --method raymarch").done();
    assert!(said.contains("lit by raymarch in ") && said.contains(" ms on the GPU ("), "{said}");
    let report = sandbox.run("render small.toml --backend gpu --method raymarch --json").done();
    let report = json(&report);
    assert_eq!(report["backend"], "gpu");
    let stages = report["stages_ms"].as_object().unwrap();
    let is_named = |stage: &String| stage.starts_with("raymarch") || stage == "gpu";
    assert!(stages.keys().any(is_named), "{report}");
}

#[test]
fn spots_and_suns_match_the_cpu() {
    let sandbox = Sandbox::new();
    let spot = "[[lamp]]\nposition = [20.5, 8.5]\ncone = { direction = 1.8, angle = 1.0 }\n";
    let sun = "[[sun]]\ndirection = 1.0\nangle = 0.1\n";
    let wall = "[[shape]]\nrect = { min = [10, 20], max = [25, 24] }\nopacity = 1.0\nalbedo = [0.6, 0.6, 0.6]\n";
    for (name, lights) in [("spot", spot), ("sun", sun)] {
        sandbox.write("small.toml", format!("size = [40, 30]\n{lights}{wall}"));
        for method in ["raymarch", "cascades", "holographic", "polar", "flood"] {
            let worst = apart(&sandbox, &format!("--method {method}"));
            assert!(worst < 2e-3, "{name}, {method}: {worst}");
        }
        assert!(floats(&sandbox, "gpu.exr").iter().any(|&v| v > 0.1), "{name} is dark");
    }
}

#[test]
fn render_averages_frames() {
    let sandbox = Sandbox::small();
    let few = "--method raymarch --set raymarch.rays=4";
    let worst = apart(&sandbox, &format!("{few} --frames 5"));
    assert!(worst < 1e-3, "{worst}");
    let mean = floats(&sandbox, "gpu.exr");
    apart(&sandbox, few);
    assert!(mean != floats(&sandbox, "gpu.exr"), "five frames look like one");
}

#[test]
fn render_shows_the_fields_that_it_measured() {
    let sandbox = Sandbox::small();
    let backend_of = |flags: &str, backend: &str| {
        let flags = format!("render small.toml --json --backend {backend} {flags}");
        json(&sandbox.run(&flags).done())["backend"].clone()
    };
    for backend in ["cpu", "gpu"] {
        // Glass is occupied, and rays that go by distances leave fields of their own behind.
        let flags = "--method raymarch --set raymarch.hit=distance";
        assert_eq!(
            backend_of(&format!("{flags} --stage voronoi -o {backend}.png"), backend),
            backend
        );
        assert_eq!(backend_of(&format!("--stage distance -o {backend}.exr"), backend), backend);
    }
    assert!(sandbox.read("cpu.png") == sandbox.read("gpu.png"), "the jump floods differ");
    let (cpu, gpu) = (floats(&sandbox, "cpu.exr"), floats(&sandbox, "gpu.exr"));
    assert!(cpu.iter().any(|&px| px > 4.0));
    for (right, seen) in cpu.iter().zip(&gpu) {
        assert!((seen - right).abs() <= 1e-6 * right, "{seen} px, not {right}");
    }
    assert_eq!(backend_of("--stage emission", "gpu"), "cpu", "there is nothing to compute");
}

#[test]
fn stages_match_those_of_the_cpu() {
    let sandbox = Sandbox::small();
    sandbox.write("dot.toml", "size = [1, 1]\nsky = [1.0, 1.0, 1.0]\n");
    sandbox.write("empty.toml", "size = [20, 9]\nsky = [1.0, 0.5, 0.2]\n");
    for name in ["small", "dot", "empty"] {
        for (backend, place) in [("cpu", "computed on the CPU, "), ("gpu", "computed on the GPU (")]
        {
            let flags = format!("stages {name}.toml --method raymarch --backend {backend}");
            let said = sandbox.run(&format!("{flags} -o {name}-{backend}")).done();
            assert!(said.contains("8 pictures") && said.contains(place), "{said}");
            assert_eq!(
                std::fs::read_dir(sandbox.path(format!("{name}-{backend}"))).unwrap().count(),
                9
            );
        }
        for stage in ["emission", "opacity", "albedo", "tint", "voronoi"] {
            let bytes = |backend: &str| sandbox.read(&format!("{name}-{backend}/{stage}.png"));
            assert!(bytes("cpu") == bytes("gpu"), "{stage} of {name} differs");
        }
        // Rounding may move a colour by a level or two, and a contour line by a cell.
        for (stage, percent) in [("distance", 1), ("light", 0), ("final", 0)] {
            let picture = |backend: &str| {
                sandbox.picture(&format!("{name}-{backend}/{stage}.png")).into_raw()
            };
            let (cpu, gpu) = (picture("cpu"), picture("gpu"));
            let off = cpu.iter().zip(&gpu).filter(|(a, b)| a.abs_diff(**b) > 2).count();
            assert!(off <= cpu.len() * percent / 100, "{stage} of {name}: {off} are off");
        }
    }
}

#[test]
fn compare_measures_the_light_of_the_gpu() {
    let sandbox = Sandbox::small();
    // Of the sweep, some rows are the mean over frames: each has to be the frame of its number.
    let compare = |backend: &str| {
        let flags = "compare small.toml --methods raymarch,polar --sweep --samples 64 --json";
        json(&sandbox.run(&format!("{flags} --backend {backend}")).done())
    };
    let (cpu, gpu) = (compare("cpu"), compare("gpu"));
    assert_eq!((&cpu["backend"], &gpu["backend"]), (&"cpu".into(), &"gpu".into()));
    assert!(cpu["adapter"].is_null() && gpu["adapter"].is_string(), "{gpu}");
    let rows = |answer: &Value| answer["rows"].as_array().unwrap().clone();
    assert_eq!(rows(&cpu).len(), rows(&gpu).len());
    for (cpu, gpu) in rows(&cpu).iter().zip(&rows(&gpu)) {
        assert_eq!(cpu["name"], gpu["name"]);
        assert!(gpu["ms"].as_f64() > Some(0.0), "{gpu}");
        for measure in ["relative_rmse", "bias", "p99", "flip"] {
            let [right, seen] = [cpu, gpu].map(|row| row[measure].as_f64().unwrap());
            let name = &cpu["name"];
            assert!((seen - right).abs() < 1e-3, "{measure} of {name}: {seen}, not {right}");
        }
    }
}

#[test]
fn compare_names_the_gpu() {
    let sandbox = Sandbox::small();
    let flags = "--methods raymarch,cascades --samples 16 --bounces converged --report report";
    let said = sandbox.run(&format!("compare small.toml --backend gpu {flags}")).done();
    for words in [
        "bounces converged, on the GPU (",
        "raymarch, default",
        "cascades, default",
        "reference: path tracer on the CPU",
        "times: per frame, ",
    ] {
        assert!(said.contains(words), "`{words}` is missing in {said}");
    }
    let page = String::from_utf8(sandbox.read("report/index.html")).unwrap();
    for words in ["on the GPU (", " s on the CPU. ", "Times are medians per frame, "] {
        assert!(page.contains(words), "`{words}` is missing in the page");
    }
}

#[test]
fn probe_matches_the_cpu() {
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
fn bench_times_frames_and_prints_their_cost() {
    let bench = |flags: &str| {
        let flags = format!("bench --backend gpu --method polar --size 32x24 --json {flags}");
        json(&Sandbox::new().run(&flags).done())
    };
    let timed = bench("");
    assert_eq!(timed["backend"], "gpu");
    assert!(timed["median_ms"].as_f64() > Some(0.0) && timed["runs"].as_u64() >= Some(5));
    let counted = bench("--cost");
    assert_eq!(counted["runs"], 0);
    for key in ["dispatches", "bytes_read", "bytes_written", "bytes_held"] {
        assert!(
            counted[key].as_u64() > Some(0) && counted[key] == timed[key],
            "{key}: {counted} {timed}"
        );
    }
}

#[test]
fn a_table_of_costs_has_no_columns_of_times() {
    let table = Sandbox::new().run("bench --cost --method polar --size 32x24").done();
    assert!(table.contains("dispatches") && table.contains("MB held"), "{table}");
    assert!(!table.contains("median") && !table.contains("runs"), "{table}");
}

#[test]
fn info_lists_the_gpu() {
    let answer = json(&Sandbox::new().run("info --json").done());
    assert!(!answer["adapters"].as_array().unwrap().is_empty());
    let methods = ["raymarch", "flood", "polar", "cascades", "holographic"];
    assert_eq!(answer["backends"]["gpu"]["methods"], Value::from(methods.to_vec()));
    let adapter = &answer["adapters"][0];
    assert_eq!(adapter["tier"], "native");
    assert!(adapter["times_stages"].is_boolean() && adapter["side"].as_u64() >= Some(8192));
}
