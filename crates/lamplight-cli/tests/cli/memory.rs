//! Memory: a scene that does not fit is refused, and no allocation fails.

use super::sandbox::{Run, Sandbox};

/// Runs the command with an address space of `kilobytes`.
fn limited(sandbox: &Sandbox, kilobytes: u64, arguments: &str) -> Run {
    let binary = env!("CARGO_BIN_EXE_lamplight");
    let script = format!("ulimit -v {kilobytes} && exec {binary} {arguments}");
    let mut command = std::process::Command::new("sh");
    command.args(["-c", &script]).current_dir(sandbox.path("."));
    command.output().expect("a shell").into()
}

#[test]
#[cfg(target_os = "linux")]
fn a_scene_that_is_too_large_is_refused_with_the_bytes_it_takes() {
    let sandbox = Sandbox::new();
    sandbox.write("large.toml", "size = [4096, 4096]\n[[lamp]]\nposition = [9, 9]\n");
    for method in ["holographic", "cascades", "raymarch", "polar", "flood", "reference"] {
        let arguments = format!("render large.toml --threads 1 --method {method}");
        limited(&sandbox, 2_000_000, &arguments).failed(
            1,
            &[
                "error: lighting large.toml (4096×4096 cells) takes about",
                "GB",
                "can be had",
                "hint: ",
            ],
        );
    }
    limited(&sandbox, 2_000_000, "bench --size 4096x4096 --threads 1").failed(1, &["takes about"]);
    limited(&sandbox, 2_000_000, "compare large.toml --threads 1").failed(1, &["takes about"]);
    assert_eq!(sandbox.files(), ["large.toml"]);
}

/// Cookies count by the size of their images, however small the grid is.
#[test]
#[cfg(target_os = "linux")]
fn a_cookie_that_is_too_large_is_refused() {
    let sandbox = Sandbox::new();
    for (name, side) in [("small.png", 32), ("large.png", 2048)] {
        image::GrayImage::new(side, side).save(sandbox.path(name)).unwrap();
    }
    for (picture, code) in [("small.png", 0), ("large.png", 1)] {
        let cookie = format!("cookie = {{ picture = \"{picture}\", size = 20 }}");
        let lamps = format!("[[lamp]]\nposition = [9, 9]\n{cookie}\n").repeat(2);
        sandbox.write("s.toml", format!("size = [32, 32]\n{lamps}"));
        let run = limited(&sandbox, 300_000, "render s.toml -q --backend cpu --threads 1 -o o.exr");
        assert_eq!(run.code, code, "{picture}: {}", run.err);
    }
}

/// A scene of 1024×768 cells with some of everything that takes memory.
fn write_scene(sandbox: &Sandbox) {
    let shapes = "[[shape]]\nrect = { min = [9, 9], max = [300, 40] }\nalbedo = [0.5, 0.5, 0.5]\n\
                  color = [0.1, 0.2, 0.3]\n[[lamp]]\nposition = [600, 500]\n";
    sandbox.write("s.toml", format!("size = [1024, 768]\n{shapes}"));
}

/// Under every limit the scene is lit or refused: no allocation fails on the way.
#[test]
#[cfg(target_os = "linux")]
fn no_limit_ends_in_an_abort() {
    let sandbox = Sandbox::new();
    write_scene(&sandbox);
    for flags in [
        "--method holographic --bounces 1",
        "--method holographic --bounces 1 --set moment=true",
        "--method polar",
        "--method cascades",
    ] {
        let codes = (120..1000).step_by(160).map(|megabytes| {
            let arguments = format!("render s.toml -q --backend cpu --threads 2 {flags} -o o.exr");
            let run = limited(&sandbox, megabytes * 1024, &arguments);
            assert!(
                matches!(run.code, 0 | 1),
                "{flags}, {megabytes} MB: {}: {}",
                run.code,
                run.err
            );
            run.code
        });
        let codes: Vec<_> = codes.collect();
        assert!(codes.contains(&0) && codes.contains(&1), "{flags}: {codes:?}");
    }
}

/// The estimate is not far too large: what takes up to 768 MB is not refused with that much.
#[test]
#[cfg(target_os = "linux")]
fn the_estimate_leaves_room_for_what_fits() {
    let sandbox = Sandbox::new();
    write_scene(&sandbox);
    for flags in [
        "--method holographic",
        "--method holographic --quality high --bounces 1",
        "--method cascades --bounces 1",
        "--method cascades --quality high",
        "--method raymarch --set raymarch.rays=2 --bounces 1 --set denoise.passes=2 --frames 2",
        "--method raymarch --set raymarch.rays=2 --set raymarch.hit=distance",
        "--method raymarch --set raymarch.rays=2 --set denoise.passes=2 --set moment=true",
        "--method polar",
        "--method flood --set flood.rounds=1",
        "--method reference --samples 1",
    ] {
        let arguments = format!("render s.toml -q --backend cpu --threads 2 {flags} -o o.exr");
        limited(&sandbox, 768 * 1024, &arguments).done();
    }
}
