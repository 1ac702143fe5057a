//! Warnings about input without effect and about ignored input.

use super::sandbox::Sandbox;

/// Checks that a command prints these warnings and no others, and none with `--quiet`.
#[track_caller]
fn warns(sandbox: &Sandbox, arguments: &str, warnings: &[&str]) {
    let err = sandbox.run(arguments).err;
    let lines: Vec<_> = err.lines().collect();
    let expected: Vec<_> = warnings.iter().map(|text| format!("warning: {text}")).collect();
    assert_eq!(lines, expected, "{arguments}");
    assert_eq!(sandbox.run(&format!("{arguments} --quiet")).err, "", "{arguments}");
}

#[test]
fn flags_without_effect_are_named() {
    let sandbox = Sandbox::small();
    let probe = |flags: &str, warnings: &[&str]| {
        warns(&sandbox, &format!("probe small.toml 22.5,1.5 {flags}"), warnings);
    };
    probe(
        "--method polar --set raymarch.rays=3",
        &["`--set raymarch.rays=3` changes nothing: light is found by polar"],
    );
    probe(
        "--samples 9",
        &["`--samples` changes nothing: it is for the reference, not holographic"],
    );
    probe(
        "--method flood --bounces 2",
        &["`--bounces` changes nothing: flood lights by a rule of its own"],
    );
    probe(
        "--frames 3",
        &["`--frames` changes nothing: with holographic every frame is the same as the first"],
    );
    probe("--seed 3", &["`--seed` changes nothing: holographic uses no random numbers"]);
    probe(
        "--method raymarch --set temporal.history_length=8",
        &["`--set temporal.history_length=8` changes nothing without `--frames`"],
    );
    probe(
        "--method cascades --set denoise.passes=2",
        &["`--set denoise.passes=2` changes nothing: cascades has no noise to remove"],
    );
    probe(
        "--method reference --samples 9 --quality high",
        &["`--quality` changes nothing: the reference has `--samples`"],
    );
    for flags in [
        "--method polar --set polar.density=2",
        "--method reference --samples 9 --seed 2",
        "--bounces 2",
        "--method raymarch --seed 2 --frames 2 --set temporal.reject=false",
        "--method raymarch --set denoise.passes=1",
        "--method flood --frames 2",
    ] {
        probe(flags, &[]);
    }
}

#[test]
fn settings_of_methods_that_are_not_run_are_named() {
    let sandbox = Sandbox::small();
    let compare = "compare small.toml --samples 1 --cells 2 --methods";
    warns(
        &sandbox,
        &format!("{compare} polar,cascades --set raymarch.rays=4 --set polar.density=2"),
        &["`--set raymarch.rays=4` changes nothing: light is found by polar and cascades"],
    );
    warns(
        &sandbox,
        &format!("{compare} polar,cascades --set denoise.passes=2"),
        &["`--set denoise.passes=2` changes nothing: polar and cascades have no noise to remove"],
    );
    warns(
        &sandbox,
        "bench --size 8x8 --method polar --set raymarch.rays=4",
        &["`--set raymarch.rays=4` changes nothing: light is found by polar"],
    );
}

#[test]
fn display_flags_without_effect_are_named() {
    let sandbox = Sandbox::small();
    let render = |flags: &str, warnings: &[&str]| {
        warns(&sandbox, &format!("render small.toml -o {flags}"), warnings);
    };
    render("a.exr --exposure 1", &[]);
    render("a.exr --tonemap agx", &["`--tonemap` changes nothing: an .exr holds linear light"]);
    let light = "an .exr of the stage light holds plain values";
    render(
        "a.exr --stage light --exposure 1 --tonemap agx",
        &[
            &format!("`--tonemap` changes nothing: {light}"),
            &format!("`--exposure` changes nothing: {light}"),
        ],
    );
    render("a.png --stage light --exposure 1 --tonemap agx", &[]);
    render(
        "a.png --stage opacity --exposure 1",
        &["`--exposure` changes nothing: the stage opacity shows no light"],
    );
    let compare = "compare small.toml --methods polar --samples 1";
    warns(
        &sandbox,
        &format!("{compare} --scale 2"),
        &["`--scale` changes nothing without `--report`: no picture is written"],
    );
    for set in ["quality=fast", "polar.preset=high"] {
        let sentence =
            "changes nothing: every preset has a row; `--quality` keeps those of one level";
        warns(&sandbox, &format!("{compare} --set {set}"), &[&format!("`--set {set}` {sentence}")]);
    }
    warns(
        &sandbox,
        &format!("{compare} --cells 3 --exposure 1"),
        &["`--exposure` changes nothing with `--cells`: no picture is made"],
    );
}

#[test]
fn polar_names_what_it_leaves_out() {
    let sandbox = Sandbox::new();
    let lamp = "[[lamp]]\nposition = [8.5, 8.5]\n";
    let glow = "[[shape]]\nrect = { min = [1, 1], max = [2, 2] }\nemission = [1, 0, 0]\n";
    let wall = "[[shape]]\nrect = { min = [14, 1], max = [15, 2] }\nalbedo = [1, 0, 0]\n";
    sandbox.write("all.toml", format!("size = [17, 17]\nsky = [1, 1, 1]\n{glow}{wall}{lamp}"));
    sandbox.write("glow.toml", format!("size = [17, 17]\n{glow}{lamp}"));
    sandbox.write("lamp.toml", format!("size = [17, 17]\n{lamp}"));
    sandbox.write("wall.toml", format!("size = [17, 17]\n{wall}{lamp}"));
    let all = "polar lights by lamps only: it leaves out glowing matter and the sky";
    warns(&sandbox, "probe all.toml 2,5 --method polar", &[all]);
    warns(&sandbox, "render all.toml --method polar", &[all]);
    warns(&sandbox, "stages all.toml -o out --method polar", &[all]);
    warns(&sandbox, "compare all.toml --methods polar,cascades --samples 1 --cells 2", &[all]);
    let glow = "polar lights by lamps only: it leaves out glowing matter";
    warns(&sandbox, "probe glow.toml 2,5 --method polar", &[glow]);
    // Bounces that nobody asks for are not missed.
    warns(&sandbox, "probe wall.toml 2,5 --method polar", &[]);
    let bounces = "polar lights by lamps only: it leaves out all bounces";
    warns(&sandbox, "probe wall.toml 2,5 --method polar --bounces converged", &[bounces]);
    let bounces = "polar lights by lamps only: it leaves out the 2 bounces";
    warns(&sandbox, "probe wall.toml 2,5 --method polar --set bounces=2", &[bounces]);
    let both =
        "polar lights by lamps only: it leaves out glowing matter, the sky and the 2 bounces";
    warns(&sandbox, "render all.toml --method polar --bounces 2", &[both]);
    let own = format!("size = [17, 17]\n{wall}{lamp}[light]\nmethod = \"polar\"\nbounces = 1\n");
    sandbox.write("own.toml", own);
    let bounce = "polar lights by lamps only: it leaves out the bounce";
    warns(&sandbox, "probe own.toml 2,5", &[bounce]);
    warns(&sandbox, "compare own.toml --methods polar --samples 1 --cells 2", &[bounce]);
    sandbox.write(
        "inside.toml",
        format!("size = [17, 17]\n{wall}{}", lamp.replace("8.5, 8.5", "14.5, 1.5")),
    );
    let inside = "polar lights by lamps only: it leaves out lamps whose centre is inside a wall";
    warns(&sandbox, "probe inside.toml 2,5 --method polar --bounces 0", &[inside]);
    assert!(
        sandbox
            .run("probe inside.toml 2,5 --method polar -q")
            .done()
            .contains("0.000   0.000   0.000")
    );
    warns(&sandbox, "probe inside.toml 2,5", &[]);
    warns(&sandbox, "probe lamp.toml 2,5 --method polar", &[]);
    warns(&sandbox, "probe wall.toml 2,5 --method polar --bounces 0", &[]);
    warns(&sandbox, "probe all.toml 2,5 --method flood", &[]);
    warns(&sandbox, "render all.toml --method polar --stage opacity", &[]);
}

#[test]
fn a_lamp_inside_a_wall_is_named() {
    let sandbox = Sandbox::new();
    let scene = |at: &str| {
        let wall = "[[shape]]\nrect = { min = [0, 0], max = [20, 12] }\n";
        format!("size = [20, 20]\n{wall}[[lamp]]\nposition = {at}\nsize = 2\n")
    };
    sandbox.write("inside.toml", scene("[10.5, 5.5]"));
    sandbox.write("border.toml", scene("[0, 0]"));
    sandbox.write("beside.toml", scene("[10.5, 10.5]"));
    let inside = |at| format!("`lamp[0]` at {at} is inside a wall, which its light does not leave");
    warns(&sandbox, "probe inside.toml 5,15", &[&inside("[10.5, 5.5]")]);
    warns(&sandbox, "probe border.toml 5,15", &[&inside("[0, 0]")]);
    warns(&sandbox, "probe beside.toml 5,15", &[]);
}

#[test]
fn a_viewer_inside_a_wall_is_named() {
    let sandbox = Sandbox::small();
    let sight = |from: &str| format!("sight small.toml {from} -o seen.png");
    let blind = "`--from 15,10` is inside a wall, from where nothing is seen";
    warns(&sandbox, &sight("--from 4,4 --from 15,10"), &[blind]);
    sandbox.run(&sight("--from 4,4 --from=-15,10 --from 15,90")).done();
    let far = "`--from -15,10` is 10 px or more, the `--range`, away from the 32×20 scene, from where nothing is \
               seen";
    warns(&sandbox, &sight("--from 4,4 --from=-15,10 --from 41,10 --range 10"), &[far]);
}

/// Mesa asks for the display server's folder when GPUs are listed, and prints an error without it.
#[test]
fn messages_of_drivers_are_not_printed() {
    let sandbox = Sandbox::small();
    for arguments in [&["render", "small.toml"][..], &["info"], &["probe", "small.toml", "1,1"]] {
        let mut command = sandbox.command(arguments);
        command.env_remove("XDG_RUNTIME_DIR");
        let output = command.output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), err.as_str()), (Some(0), ""), "{arguments:?}");
    }
    // Errors of lamplight itself are printed.
    let mut command = sandbox.command(&["render", "nope.toml"]);
    command.env_remove("XDG_RUNTIME_DIR");
    let err = String::from_utf8(command.output().unwrap().stderr).unwrap();
    assert!(err.starts_with("error: cannot read nope.toml"), "{err}");
}
