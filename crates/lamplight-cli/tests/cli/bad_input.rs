//! Mistakes of users, and the errors that they get.

use super::sandbox::{Run, Sandbox};

/// Arguments, exit code, and parts of stderr in their order.
type Case = (&'static str, i32, &'static [&'static str]);

const CASES: &[Case] = &[
    // The scene.
    ("render nope.toml", 2, &["error: cannot read nope.toml", "hint: `lamplight new nope.toml`"]),
    ("render folder", 2, &["error: cannot read folder", "a scene file"]),
    ("render not.toml", 2, &["error:", "not.toml", "line 1"]),
    ("render huge.toml", 2, &["error: huge.toml", "40000×40000", "16384"]),
    ("render typo.toml", 2, &["error: typo.toml", "lamps"]),
    ("probe nope.toml 1,1", 2, &["cannot read nope.toml", "hint"]),
    ("compare nope.toml", 2, &["cannot read nope.toml", "hint"]),
    ("stages nope.toml -o there", 2, &["cannot read nope.toml", "hint"]),
    ("bench --scene nope.toml", 2, &["cannot read nope.toml", "hint"]),
    // The output.
    ("render small.toml -o x.jpg", 2, &["x.jpg", ".png", ".exr"]),
    ("render small.toml -o x", 2, &["name x", ".png"]),
    ("render small.toml -o folder", 2, &["name folder", ".png"]),
    ("render small.toml -o folder.png", 2, &["folder.png", "is a directory", "hint: name a file"]),
    ("render small.toml -o nowhere/x.png", 2, &["nowhere/x.png", "no directory nowhere"]),
    ("render small.toml -o small.toml/x.png", 2, &["small.toml is not a directory"]),
    ("stages small.toml -o small.toml", 2, &["small.toml", "a file, not a directory"]),
    ("compare small.toml --report small.toml", 2, &["small.toml", "a file, not a directory"]),
    // Outputs that cannot be written are found before the work, which fails.
    (
        "render dark.toml --method polar -o small.toml/x.png",
        2,
        &["cannot write small.toml/x.png: small.toml is not a directory"],
    ),
    (
        "stages dark.toml --method polar -o small.toml/x",
        2,
        &["cannot write into small.toml/x: small.toml is a file, not a directory"],
    ),
    (
        "compare dark.toml --methods polar --report small.toml/x/y",
        2,
        &["cannot write into small.toml/x/y: small.toml is a file, not a directory"],
    ),
    (
        "bake dark.toml --quality paper -o small.toml/x",
        2,
        &["cannot write into small.toml/x: small.toml is a file, not a directory"],
    ),
    (
        "stages dark.toml --method polar -o full",
        2,
        &["cannot write full/light.png: it is a directory", "hint: remove it, or name another"],
    ),
    ("compare dark.toml --methods polar --report there", 2, &["polar lights lamps only"]),
    ("render small.toml --stage voronoi -o x.exr", 2, &["voronoi", "hint: ", ".png"]),
    ("render small.toml --scale 2 -o x.exr", 2, &["--scale", ".png"]),
    ("render wide.toml --scale 64", 2, &["--scale 64", "million pixels"]),
    // Flags.
    ("render", 2, &["<SCENE>"]),
    ("frobnicate", 2, &["unrecognized subcommand 'frobnicate'"]),
    ("render small.toml --method polr", 2, &["'polr'", "--method", "raymarch, ", "reference"]),
    (
        "render small.toml --backend gpu --method reference",
        2,
        &["the reference has no GPU", "hint: "],
    ),
    (
        "stages small.toml -o there --backend gpu --method reference",
        2,
        &["the reference has no GPU", "hint: "],
    ),
    ("bench --cost --backend cpu", 2, &["--cost", "hint: leave --backend out"]),
    ("compare small.toml --backend vulkan", 2, &["'vulkan'", "--backend", "auto, cpu, gpu"]),
    ("render small.toml --bounces -1", 2, &["'-1'", "--bounces", "0 to 256"]),
    ("render small.toml --seed -1", 2, &["'-1'", "--seed", "from 0 to 18446744073709551615"]),
    ("render small.toml --threads -1", 2, &["-1", "--threads", "1..=1024"]),
    ("render small.toml --bounces many", 2, &["many", "0 to 256", "converged"]),
    ("render small.toml --threads 0", 2, &["'0'", "--threads", "1..=1024"]),
    ("render small.toml --frames 0", 2, &["'0'", "--frames"]),
    ("render small.toml --tonemap filmic", 2, &["'filmic'", "none, reinhard, aces, agx, vivid"]),
    ("render small.toml --exposure nan", 2, &["exposure", "NaN", "from -32 to 32"]),
    ("render small.toml --exposure 99", 2, &["exposure", "99", "from -32 to 32"]),
    ("render small.toml --set raymarch.ray=3", 2, &["raymarch.ray", "`rays`"]),
    ("render small.toml --set raymarch.rays", 2, &["--set", "raymarch.rays", "form key=value"]),
    ("render small.toml --set raymarch.rays=0", 2, &["raymarch.rays", "0", "from 1 to 65536"]),
    ("render small.toml --set raymarch.rays=nan", 2, &["raymarch.rays", "nan", "a whole number"]),
    ("render small.toml --set holographic.x=1", 2, &["holographic.x", "known here: preset, "]),
    ("render small.toml --set raymarch.rays=many", 2, &["raymarch.rays", "many"]),
    ("render small.toml --set raymarch.preset=godo", 2, &["raymarch.preset", "godo", "unity"]),
    ("render small.toml --set polar.rays=64", 2, &["polar.rays", "not a known key", "density"]),
    ("render small.toml --set polar.density=9", 2, &["polar.density", "9", "from 0.25 to 8"]),
    ("render small.toml --set flood.rounds=1025", 2, &["flood.rounds", "1025", "from 0 to 1024"]),
    ("render dark.toml --method polar", 2, &["polar lights lamps only", "add a [[lamp]]"]),
    ("probe dark.toml 1,1 --method polar", 2, &["polar lights lamps only"]),
    ("stages dark.toml -o there --method polar", 2, &["polar lights lamps only"]),
    ("compare dark.toml --methods polar", 2, &["polar lights lamps only"]),
    ("compare solid.toml", 2, &["every cell is solid", "hint: "]),
    ("bench --scene dark.toml --method polar", 2, &["polar lights lamps only"]),
    ("compare small.toml --methods raymarch,magic", 2, &["'magic'", "raymarch"]),
    ("compare small.toml --samples 0", 2, &["'0'", "--samples"]),
    ("probe small.toml", 2, &["<X,Y>"]),
    ("probe small.toml 3", 2, &["'3'", "such as 160,90"]),
    (
        "probe small.toml 32,5",
        2,
        &["32,5", "outside the 32×20 scene", "hint: x runs from 0 to below 32"],
    ),
    ("bench --size 512", 2, &["'512'", "such as 512x512"]),
    ("bench --size 40000x40000", 2, &["40000×40000", "16384"]),
    ("bench --size 0x5", 2, &["0×5", "1 to 16384"]),
    ("bench --size 8x8 --scene small.toml", 2, &["--size", "cannot be used with", "--scene"]),
    ("new small.toml", 2, &["small.toml exists already", "hint: --force"]),
    ("new x.png", 2, &["x.png", "hint: try `lamplight new x.toml`"]),
    ("new nowhere/x.toml", 2, &["no directory nowhere"]),
    ("completions tcsh", 2, &["'tcsh'", "bash"]),
    ("man nothing", 2, &["no command `nothing`", "hint: `lamplight help`"]),
];

#[test]
fn bad_input_is_explained_and_leaves_no_files() {
    let sandbox = Sandbox::small();
    sandbox.write("not.toml", "this is no scene\n");
    sandbox.write("huge.toml", "size = [40000, 40000]\n");
    sandbox.write("dark.toml", "size = [8, 8]\n");
    sandbox
        .write("solid.toml", "size = [4, 4]\n[[shape]]\nrect = { min = [0, 0], max = [4, 4] }\n");
    sandbox.write("wide.toml", "size = [1000, 1000]\n");
    sandbox.write("typo.toml", "size = [4, 4]\n[[lamps]]\n");
    for folder in ["folder", "folder.png", "full/light.png"] {
        std::fs::create_dir_all(sandbox.path(folder)).unwrap();
    }
    let before = sandbox.files();
    let mut wrong = Vec::new();
    for (arguments, code, says) in CASES {
        let run = sandbox.run(arguments);
        let result = std::panic::catch_unwind(|| run.failed(*code, says));
        if result.is_err() {
            wrong.push(*arguments);
        }
        assert_eq!(sandbox.files(), before, "`lamplight {arguments}` left files");
    }
    assert!(wrong.is_empty(), "see above for {wrong:#?}");
}

#[test]
fn backend_gpu_fails_without_a_gpu() {
    let sandbox = Sandbox::small();
    for arguments in [
        "render small.toml --stage voronoi",
        "render small.toml --stage distance",
        "render small.toml --stage light",
        "stages small.toml -o there",
        "compare small.toml --samples 1",
        "probe small.toml 1,1",
        "bench --size 8x8",
    ] {
        let arguments: Vec<_> = arguments.split(' ').chain(["--backend", "gpu"]).collect();
        // OpenGL is none of those that are looked for.
        let run = sandbox.command(&arguments).env("WGPU_BACKEND", "gl").output().unwrap();
        Run::from(run).failed(1, &["error: there is no GPU here", "hint: ", "--backend cpu"]);
    }
    assert_eq!(sandbox.files(), ["small.toml"]);
}

/// A directory that no one can write to, the superuser included.
#[test]
#[cfg(target_os = "linux")]
fn an_unwritable_output_is_a_failure() {
    let sandbox = Sandbox::small();
    // It is found before the work, which fails.
    sandbox.write("dark.toml", "size = [8, 8]\n");
    let cannot = |arguments: &str, says: &str| {
        let flag = if arguments.starts_with("compare") { "--methods" } else { "--method" };
        let run = sandbox.run(&format!("{arguments} {flag} polar"));
        run.failed(1, &[&format!("error: cannot {says}: no file can be made there")]);
    };
    cannot("render dark.toml -o /proc/x.png", "write /proc/x.png");
    cannot("stages dark.toml -o /proc/x", "make the directory /proc/x");
    cannot("stages dark.toml -o /proc", "write into /proc");
    cannot("compare dark.toml --report /proc/x", "make the directory /proc/x");
    sandbox.run("new /proc/x.toml").failed(1, &["error: cannot write /proc/x.toml"]);
}

#[test]
fn the_cost_of_frames_is_that_on_the_gpu() {
    let sandbox = Sandbox::new();
    let cost = ["bench", "--cost", "--size", "8x8", "--method", "polar"];
    // Where there is none.
    let run = sandbox.command(&cost).env("WGPU_BACKEND", "gl").output().unwrap();
    Run::from(run).failed(1, &["error: there is no GPU here"]);
}

#[test]
fn errors_are_coloured_only_on_request() {
    let sandbox = Sandbox::new();
    let colored = |variables: &[(&str, &str)]| {
        let mut command = sandbox.command(&["render", "nope.toml"]);
        command.envs(variables.iter().copied());
        command.output().unwrap().stderr.contains(&0x1b)
    };
    assert!(!colored(&[]), "stderr is no terminal here");
    assert!(colored(&[("CLICOLOR_FORCE", "1")]));
    assert!(!colored(&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]));
}
