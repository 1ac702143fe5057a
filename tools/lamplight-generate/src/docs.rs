//! The pictures and figures in the documents: all of them made here, none typed by hand.
//!
//! Figures stand between `<!-- begin NAME: cargo xtask docs -->` and `<!-- end NAME -->`.

use crate::frontier::{self, Scene};
use crate::generated::{self, Mode, root};
use crate::{lone_lamps, relief, scenes, tradeoff};
use anyhow::{Context, Result, ensure};
use clap::ValueEnum;
use lamplight::{Method, ToneMap};
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::process::Command;

/// The scene that `compare` judges, by direct light: the reference is sharp enough within a minute.
const JUDGED: &str = "cave";
/// Paths a pixel of the reference.
const SAMPLES: &str = "4096";
/// Picture pixels per cell of a scene.
const SCALE: &str = "2";

/// Pictures of [`scenes::BY_RULE`], and how each is made.
const THEATRE: [(&str, &[&str]); 4] = [
    ("theatre", &["--method", "polar"]),
    ("theatre-gamemaker", &["--method", "polar", "--set", "polar.preset=gamemaker"]),
    ("theatre-flood", &["--method", "flood", "--frames", "16"]),
    ("theatre-flood-seed", &["--method", "flood", "--frames", "16", "--set", "flood.preset=seed"]),
];
/// Picture pixels per cell of a recipe.
const COOKBOOK_SCALE: &str = "3";
/// Sizes at which their cost is measured.
const POLAR_SIZES: &str = "320x180,640x360,1280x720";
const FLOOD_SIZES: &str = "64x64,128x128,320x180";
const CASCADES_SIZES: &str = "128x128,256x256,320x180,512x512";
const HOLOGRAPHIC_SIZES: &str = "128x128,256x256,320x180,512x512,1024x1024,2048x2048";

/// A part of the documents: all pictures, or the figures of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Part {
    Pictures,
    Readme,
    Holographic,
    Cascades,
    Polar,
    Flood,
    Methods,
    Raymarch,
    Gpu,
}

/// Makes a part.
pub fn run(part: Part) -> Result<()> {
    let machine = machine()?;
    let discs = "walls and 36 glowing discs";
    match part {
        Part::Pictures => {
            fs::create_dir_all(root().join("docs/pictures"))?;
            pictures()
        }
        Part::Readme => insert("docs/README.md", "times", &times(&machine)?),
        Part::Holographic => {
            let page = "docs/holographic.md";
            let costs = costs(Method::Holographic, HOLOGRAPHIC_SIZES, discs, &machine)?;
            insert(page, "costs", &costs)?;
            insert(page, "errors", &errors(&["holographic"], &machine)?)?;
            let yardstick = |set: &str| {
                let bench = ["bench", "--method", "holographic", "--json", "--yardstick"];
                let case = ["--size", tradeoff::SIZE, "--set", set];
                let said = lamplight(&[&bench[..], &case].concat())?;
                number(&serde_json::from_str(&said)?, "yardstick_ratio")
            };
            insert(page, "tradeoff", &tradeoff::table(yardstick)?)
        }
        Part::Cascades => {
            let page = "docs/cascades.md";
            insert(page, "costs", &costs(Method::Cascades, CASCADES_SIZES, discs, &machine)?)?;
            insert(page, "errors", &errors(&["cascades"], &machine)?)
        }
        Part::Polar => {
            let lamps = "one of range 64 to 922 cells: 1000 at 1280×720";
            insert("docs/polar.md", "costs", &costs(Method::Polar, POLAR_SIZES, lamps, &machine)?)
        }
        Part::Flood => {
            insert("docs/flood.md", "costs", &costs(Method::Flood, FLOOD_SIZES, discs, &machine)?)
        }
        Part::Methods => {
            methods(&machine)?;
            insert("docs/methods.md", "ripples", &lone_lamps::table()?)
        }
        Part::Raymarch => {
            insert("docs/raymarch.md", "errors", &errors(&["raymarch", "--sweep"], &machine)?)
        }
        Part::Gpu => gpu(),
    }
}

/// Sizes at which frames on the GPU are accounted for, and timed where there is a hardware one.
const GPU_SIZES: &str = "512x512,1024x1024,1920x1080";

/// The page on the GPU: what frames move and hold, and what they take on a hardware one.
fn gpu() -> Result<()> {
    let info: Value = serde_json::from_str(&lamplight(&["info", "--json"])?)?;
    let adapters = info["adapters"].as_array().context("`info --json` lists adapters")?;
    let hardware = adapters.iter().any(|adapter| adapter["kind"] != "software");
    // Cards go about it with fewer dispatches, so costs are those of a GPU in software. Without a hardware one the times of
    // the last that was at hand stay.
    let (name, cost) = if hardware { ("times", false) } else { ("costs", true) };
    insert("docs/performance.md", name, &gpu_table(cost)?)?;
    insert("docs/sandbox.md", "budget", &budget()?)
}

/// ms of light in a frame of the sandbox, `lamplight_sandbox::pace::BUDGET`.
const BUDGET: f64 = 12.0;

/// The sandbox's time for light, divided among passes by the bytes that they move.
fn budget() -> Result<String> {
    let arguments = ["bench", "--backend", "gpu", "--method", "holographic", "--json", "--cost"];
    let case = ["--size", "640x360", "--set", "holographic.preset=fast"];
    let said: Value = serde_json::from_str(&lamplight(&[&arguments[..], &case].concat())?)?;
    let kernels = said["kernels"].as_array().context("`bench --cost` lists kernels")?;
    let bytes = |kernel: &Value| {
        anyhow::Ok(number(kernel, "bytes_read")? + number(kernel, "bytes_written")?)
    };
    let total: f64 = kernels.iter().map(bytes).sum::<Result<f64>>()?;
    let mut table =
        String::from("| pass | dispatches | MB moved | ms |\n| --- | ---: | ---: | ---: |\n");
    for kernel in kernels {
        let name = |key: &str| kernel[key].as_str().unwrap_or_default();
        let (moved, runs) = (bytes(kernel)?, number(kernel, "dispatches")?);
        let ms = BUDGET * moved / total;
        writeln!(
            table,
            "| `{}`, `{}` | {runs} | {:.1} | {ms:.2} |",
            name("shader"),
            name("entry"),
            moved / 1e6
        )?;
    }
    let speed = total / BUDGET / 1e6;
    writeln!(table, "| all | | {:.0} | {BUDGET} |\n\nThis needs {speed:.0} GB/s.", total / 1e6)?;
    Ok(table)
}

/// Bytes that a frame of each method and preset moves and holds on the GPU, or its time.
fn gpu_table(cost: bool) -> Result<String> {
    let mut table = String::from(if cost {
        "| preset | cells | dispatches | MB read | MB written | MB held |\n\
         | --- | --- | --- | --- | --- | --- |\n"
    } else {
        "| preset | cells | dispatches | ms per frame | GB/s | ms by stage |\n\
         | --- | --- | ---: | ---: | ---: | --- |\n"
    });
    let mut adapter = String::new();
    for method in Method::ALL {
        for preset in method.presets() {
            println!("bench {}, {preset}, on the GPU", method.name());
            let set = format!("{}.preset={preset}", method.name());
            let name = method.name();
            let mut arguments = vec!["bench", "--backend", "gpu", "--method", name, "--json"];
            arguments.extend(["--size", GPU_SIZES, "--set", &set]);
            arguments.extend(cost.then_some("--cost"));
            for line in lamplight(&arguments)?.lines() {
                let case: Value = serde_json::from_str(line)?;
                let (width, height) = (number(&case, "width")?, number(&case, "height")?);
                write!(table, "| `{name}`, `{preset}` | {width}×{height} |")?;
                write!(table, " {} |", number(&case, "dispatches")?)?;
                if cost {
                    for key in ["bytes_read", "bytes_written", "bytes_held"] {
                        write!(table, " {:.0} |", number(&case, key)? / 1e6)?;
                    }
                } else {
                    let stages = case["stages_ms"].as_object().context("a case has stages")?;
                    let ms = number(&case, "median_ms")?;
                    let stages = stages.iter().filter_map(|(stage, time)| {
                        // A stage's own name is enough, and what takes a fiftieth at least.
                        let own = stage.rsplit_once('/').map_or(stage.as_str(), |(_, own)| own);
                        let time = time.as_f64().filter(|&time| time >= 0.02 * ms)?;
                        Some(format!("{own} {time:.2}"))
                    });
                    let stages = stages.collect::<Vec<_>>().join(", ");
                    let moved = number(&case, "bytes_read")? + number(&case, "bytes_written")?;
                    write!(table, " {ms:.2} | {:.0} | {stages} |", moved / ms / 1e6)?;
                }
                table.push('\n');
                case["adapter"].as_str().unwrap_or_default().clone_into(&mut adapter);
            }
        }
    }
    if !cost {
        writeln!(
            table,
            "\nMedian of the frames of a second on an {adapter}, by its own clock, stage by stage. GB/s are the bytes \
             that the frame moves there by its time."
        )?;
    }
    Ok(table)
}

/// The page that sets all methods side by side.
fn methods(machine: &str) -> Result<()> {
    let mut judged = Vec::new();
    for name in scenes::NAMES {
        println!("compare {name}");
        let flags = ["--bounces", "0", "--cells", frontier::CELLS, "--samples", frontier::SAMPLES];
        let said = lamplight(
            &[&["compare", &file(name), "--backend", "cpu", "--json"], &flags[..]].concat(),
        )?;
        judged.push(Scene::read(name, &said)?);
    }
    let plot = frontier::svg(&judged)?;
    generated::bytes(Mode::Write, "docs/pictures/methods.svg", plot.as_bytes(), "docs")?;
    let table = format!(
        "{}\nRelative RMSE of direct light at {} open cells per scene, picked at random, against {} paths \
         per cell; `mean` and `per frame` are geometric means over the scenes. Median times {machine}.\n",
        frontier::table(&judged)?,
        frontier::CELLS,
        frontier::SAMPLES,
    );
    insert("docs/methods.md", "methods", &table)
}

/// Time per frame of a method in the built-in scene, by preset and size.
fn costs(method: Method, sizes: &str, scene: &str, machine: &str) -> Result<String> {
    let by_yardstick = method == Method::Holographic;
    let mut table = String::from("| preset | cells | per frame |");
    if by_yardstick {
        table += " ns per cell and level | times faster |\n| --- | --- | --- | --- | --- |\n";
    } else {
        table += "\n| --- | --- | --- |\n";
    }
    for preset in method.presets() {
        println!("time {}, {preset}", method.name());
        let set = format!("{}.preset={preset}", method.name());
        let mut arguments =
            vec!["bench", "--method", method.name(), "--size", sizes, "--set", &set, "--json"];
        if by_yardstick {
            arguments.push("--yardstick");
        }
        for line in lamplight(&arguments)?.lines() {
            let case: Value = serde_json::from_str(line)?;
            let (width, height) = (number(&case, "width")?, number(&case, "height")?);
            let median = number(&case, "median_ms")?;
            write!(table, "| `{preset}` | {width}×{height} | {median:.1} ms |")?;
            if by_yardstick {
                let growth = 1e6 * median / (width * height * width.max(height).log2());
                write!(table, " {growth:.1} | {:.1} |", number(&case, "yardstick_ratio")?)?;
            }
            table.push('\n');
        }
    }
    writeln!(table, "\nMedian of several frames of the scene of `bench` ({scene}) {machine}.")?;
    if by_yardstick {
        writeln!(
            table,
            "`times faster`: than a plain implementation of the published cascades, timed in turns \
             (`bench --yardstick`). Levels: log₂ of the longer side."
        )?;
    }
    Ok(table)
}

fn pictures() -> Result<()> {
    for name in scenes::NAMES.into_iter().chain([scenes::RELIEF]) {
        println!("render {name}");
        let output = format!("docs/pictures/{name}.png");
        lamplight(&["render", &file(name), "--scale", SCALE, "-o", &output])?;
    }
    for (name, method) in THEATRE {
        println!("render {name}");
        let output = format!("docs/pictures/{name}.png");
        let picture = ["--scale", SCALE, "-o", &output];
        lamplight(&[&["render", &file(scenes::BY_RULE)], method, &picture[..]].concat())?;
    }
    for name in recipes()? {
        println!("render {name}");
        let (scene, output) =
            (format!("scenes/cookbook/{name}.toml"), format!("docs/pictures/cookbook-{name}.png"));
        lamplight(&["render", &scene, "--scale", COOKBOOK_SCALE, "-o", &output])?;
    }
    let map = ["render", "scenes/maps/tavern.tmx", "--scale", SCALE];
    lamplight(&[&map[..], &["-o", "docs/pictures/map-tavern.png"]].concat())?;
    for &map in ToneMap::ALL {
        let output = format!("docs/pictures/tonemap-{}.png", map.name());
        lamplight(&["render", &file("night_street"), "--tonemap", map.name(), "-o", &output])?;
    }
    let light = ["--stage", "light", "--scale", SCALE, "-o", "docs/pictures/cave-light.png"];
    lamplight(&[&["render", &file("cave")], &light[..]].concat())?;
    for (name, preset, output) in [
        ("cascades", "default", "docs/pictures/grove-cascades.png"),
        ("cascades", "plain", "docs/pictures/grove-cascades-plain.png"),
        ("holographic", "default", "docs/pictures/grove-holographic.png"),
        ("holographic", "paper", "docs/pictures/grove-holographic-paper.png"),
    ] {
        let preset = format!("{name}.preset={preset}");
        let direct = ["--bounces", "0", "--stage", "light", "--scale", SCALE, "-o", output];
        let scene = file("grove");
        let method = ["render", &scene, "--method", name, "--set", &preset];
        lamplight(&[&method, &direct[..]].concat())?;
    }
    relief::pictures()?;
    let folder = tempfile::tempdir()?;
    let path = folder.path().to_str().context("the temporary folder's name is text")?;
    lamplight(&["stages", &file("cave"), "--backend", "cpu", "-o", path])?;
    let sheet = image::open(folder.path().join("contact-sheet.png"))?;
    generated::picture(Mode::Write, "docs/pictures/cave-stages.png", &sheet, "docs")
}

/// The recipes of docs/cookbook.md, by name.
fn recipes() -> Result<Vec<String>> {
    let files = fs::read_dir(root().join("scenes/cookbook"))?;
    let mut names = files
        .map(|file| Ok(file?.path().file_stem().unwrap_or_default().to_string_lossy().into_owned()))
        .collect::<Result<Vec<_>>>()?;
    names.sort();
    Ok(names)
}

fn times(machine: &str) -> Result<String> {
    let mut table = String::from(
        "| scene | cells | method | bounces | per frame |\n| --- | --- | --- | --- | --- |\n",
    );
    for name in scenes::NAMES {
        println!("time {name}");
        let scene = lamplight::Scene::load(root().join(file(name)))?;
        let settings = scene.resolve_settings()?;
        let method = settings.method().name();
        let bench = ["bench", "--method", method, "--scene", &file(name), "--json"];
        let case: Value = serde_json::from_str(&lamplight(&bench)?)?;
        writeln!(
            table,
            "| [{name}](../scenes/{name}.toml) | {}×{} | {} | {} | {:.0} ms |",
            scene.size[0],
            scene.size[1],
            method,
            settings.bounces.limit(),
            number(&case, "median_ms")?
        )?;
    }
    writeln!(table, "\nMedian of several frames {machine}.")?;
    Ok(table)
}

fn errors(method: &[&str], machine: &str) -> Result<String> {
    println!("compare {JUDGED} by {}", method[0]);
    let direct = ["--bounces", "0", "--samples", SAMPLES, "--json"];
    let scene = file(JUDGED);
    let compare = ["compare", &scene, "--backend", "cpu", "--methods"];
    let said = lamplight(&[&compare[..], method, &direct].concat())?;
    let judged: Value = serde_json::from_str(&said)?;
    let percent = |row: &Value, key: &str| Ok::<_, anyhow::Error>(number(row, key)? * 100.0);
    let mut table = String::from(
        "| settings | relative RMSE | bias | 99th percentile | grain | FLIP | per frame |\n\
         | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for row in judged["rows"].as_array().context("compare has rows")? {
        writeln!(
            table,
            "| {} | {:.1} % | {:+.2} % | {:.1} % | {:.2} % | {:.3} | {:.0} ms |",
            row["name"].as_str().context("a row has a name")?,
            percent(row, "relative_rmse")?,
            percent(row, "bias")?,
            percent(row, "p99")?,
            percent(row, "grain")?,
            number(row, "flip")?,
            number(row, "ms")?
        )?;
    }
    writeln!(
        table,
        "\n`{JUDGED}`, direct light, against {SAMPLES} paths per pixel, whose own standard error is \
         {:.1} %; times {machine}.",
        percent(&judged["reference"], "relative_standard_error")?
    )?;
    Ok(table)
}

/// The machine that the figures were measured on.
fn machine() -> Result<String> {
    let info: Value = serde_json::from_str(&lamplight(&["info", "--json"])?)?;
    let cpu = &info["backends"]["cpu"];
    let features: Vec<&str> =
        cpu["features"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    Ok(format!("on {} threads of a CPU with {}", cpu["threads"], features.join(", ")))
}

fn number(value: &Value, key: &str) -> Result<f64> {
    value[key].as_f64().with_context(|| format!("`{key}` is a number in {value}"))
}

fn file(scene: &str) -> String {
    format!("scenes/{scene}.toml")
}

/// Runs the command line in the root; what it prints.
fn lamplight(arguments: &[&str]) -> Result<String> {
    let this = std::env::current_exe()?;
    let target = this.ancestors().nth(2).context("Cargo builds into a folder for each profile")?;
    let program = target.join("release").join(format!("lamplight{}", std::env::consts::EXE_SUFFIX));
    let output = Command::new(program).args(arguments).current_dir(root()).output()?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "lamplight {} failed: {said}", arguments.join(" "));
    Ok(String::from_utf8(output.stdout)?)
}

/// Puts text between the marks of a block.
fn insert(path: &str, name: &str, text: &str) -> Result<()> {
    generated::block(Mode::Write, path, name, text, "docs")
}
