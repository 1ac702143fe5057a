//! `lamplight bench`: the time of a frame, and of each of its stages.

use crate::args::{Backend, MachineArgs, Renderer, SettingArgs, by_name};
use crate::bench_scene::{bench_scene, bench_scene_of_lamps};
use crate::device_info::DeviceInfo;
use crate::error::{CliError, Result, warn};
use crate::frame_cost::FrameCost;
use crate::gpu::Gpu;
use crate::input::Input;
use crate::job::read_cells;
use crate::lit::ms;
use crate::memory::{self, SceneSize};
use crate::output;
use crate::progress::Progress;
use crate::stage::{FrameView, Stage};
use crate::table::table;
use crate::warnings;
use lamplight::internals::glow::Glow;
use lamplight::internals::holographic::paper::Paper;
use lamplight::{Cells, Display, Method, Settings, SettingsTable, Solver};
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::str::FromStr;
use std::time::{Duration, Instant};

/// The time for which a case is repeated, on the CPU and on the GPU, whose times vary less,
const TIME: Duration = Duration::from_secs(2);
const TIME_ON_GPU: Duration = Duration::from_secs(1);
/// its fewest runs, enough for a median,
const LEAST_RUNS: usize = 5;
/// and its most runs.
const MOST_RUNS: usize = 501;

/// The help of `--bounces`, whose default is another one here.
const BOUNCES: &str = "Times that light is reflected: a number, `converged` or `feedback` [default: 0 in the built-in \
                       scene; of --scene its own, else 2]";

/// Time methods at several sizes, stage by stage
#[derive(clap::Args, Debug)]
#[command(mut_arg("bounces", |arg| arg.help(BOUNCES)))]
pub struct BenchArgs {
    /// Methods to time, separated by commas [default: all]
    #[arg(long, value_name = "METHOD", value_delimiter = ',',
          value_parser = by_name(Method::ALL, Method::name))]
    method: Vec<Method>,
    /// Sizes of the built-in scene, such as 320x180,512x512 [default: 320x180,640x360,1280x720]. For
    /// polar it has lamps of range 64, 1000 of them at 1280x720
    #[arg(long, value_name = "WxH", value_delimiter = ',', conflicts_with = "scene")]
    size: Vec<Size>,
    /// Time this scene instead of the built-in one
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Also time the making of the picture, with K × K pixels per cell: `present_ms`
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..=64))]
    scale: Option<u32>,
    /// Also time a plain implementation of the published holographic cascades (direct light), in turns
    /// with the method, and print its time ÷ the method's: a ratio that depends little on the machine.
    /// Not for polar and flood, which light differently
    #[arg(long)]
    yardstick: bool,
    /// Run nothing, only print how much memory a frame on the GPU moves and holds
    #[arg(long)]
    cost: bool,
    /// Print one JSON object per line, one for each case
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    settings: SettingArgs,
    #[command(flatten)]
    machine: MachineArgs,
}

#[derive(Clone, Copy, Debug)]
struct Size(u32, u32);

impl FromStr for Size {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        text.split_once(['x', 'X', '×'])
            .and_then(|(w, h)| Some(Self(w.parse().ok()?, h.parse().ok()?)))
            .ok_or("a size is two whole numbers with an x between them, such as 512x512")
    }
}

pub fn run(mut args: BenchArgs) -> Result {
    if args.cost {
        if args.machine.backend == Backend::Cpu {
            let error = CliError::bad_input("--cost is for frames on the GPU");
            return Err(error.hint("leave --backend out"));
        }
        args.machine.backend = Backend::Gpu;
    }
    let gpu = (args.machine.backend == Backend::Gpu).then(Gpu::open).transpose()?;
    if gpu.is_some() && (args.yardstick || args.scale.is_some()) {
        let error = CliError::bad_input("--yardstick and --scale time the CPU");
        return Err(error.hint("leave --backend out"));
    }
    let methods = methods(&args);
    if !args.machine.quiet {
        let renderers: Vec<_> = methods.iter().copied().map(Renderer::Method).collect();
        warnings::idle_settings(&args.settings.set, &renderers).iter().for_each(|text| warn(text));
    }
    args.machine.run(|threads| {
        let (grids, scene) = grids(&args)?;
        let cases = methods.iter().flat_map(|m| grids.iter().map(move |g| (*m, g)));
        let progress =
            Progress::new("timing", (methods.len() * grids.len()) as u64, args.machine.quiet);
        let mut rows = Vec::new();
        for (method, cells) in cases {
            let (w, h) = (cells.width(), cells.height());
            progress.label(&format!("timing {} at {w}×{h}", method.name()));
            let lamps;
            let cells = if args.scene.is_none() && method.suits(cells).is_err() {
                lamps = bench_scene_of_lamps(w, h)?;
                &lamps
            } else {
                cells
            };
            let renderer = Some(Renderer::Method(method));
            let settings = args.settings.over(&scene, renderer)?.resolve()?;
            let times = match &gpu {
                Some(gpu) => time_on_gpu(gpu, cells, settings, args.cost)?,
                None => {
                    time(cells, settings, args.scale, args.yardstick && !method.lights_lamps())?
                }
            };
            progress.step();
            let case = Case { method, size: Size(w, h), threads, gpu: gpu.as_ref(), times };
            if args.json {
                output::print(case.json(&args))?;
            } else {
                rows.push(case.row(&args));
            }
        }
        drop(progress);
        if args.json {
            return Ok(());
        }
        let mut header = vec!["method", "size"];
        if !args.cost {
            header.extend(["median ms", "least ms", "runs", "ms by stage"]);
        }
        if gpu.is_some() {
            header.extend(["dispatches", "MB moved", "MB held"]);
        }
        if args.yardstick {
            header.extend(["yardstick ms", "times faster"]);
        }
        let words = if args.cost { &[0][..] } else { &[0, 5][..] };
        output::print(table(&header, words, rows))?;
        output::print(gpu.as_ref().map_or_else(DeviceInfo::cpu, Gpu::device_info))
    })
}

/// A method at a size, and its times.
struct Case<'a> {
    method: Method,
    size: Size,
    threads: usize,
    gpu: Option<&'a Gpu>,
    times: Times,
}

impl Case<'_> {
    fn json(&self, args: &BenchArgs) -> Value {
        let Self { method, size: Size(w, h), threads, gpu, times } = self;
        let backend = if gpu.is_some() { "gpu" } else { "cpu" };
        let mut line = json!({
            "method": method.name(), "backend": backend, "width": w, "height": h,
            "threads": threads, "median_ms": ms(times.median), "min_ms": ms(times.least),
            "runs": times.runs, "stages_ms": times.stages_json(),
        });
        if let (Some(gpu), Some(cost)) = (gpu, &times.cost) {
            line["adapter"] = gpu.name().into();
            line["dispatches"] = cost.dispatches().into();
            line["bytes_read"] = cost.bytes_read().into();
            line["bytes_written"] = cost.bytes_written().into();
            line["bytes_held"] = cost.bytes_held.into();
            line["kernels"] = json!(cost.kernels);
        }
        if let Some(scene) = &args.scene {
            line["scene"] = scene.display().to_string().into();
        }
        if let Some(present) = times.present {
            line["present_ms"] = ms(present).into();
        }
        if let Some(yardstick) = times.yardstick {
            line["yardstick_ms"] = ms(yardstick).into();
            line["yardstick_ratio"] = times.ratio(yardstick).into();
        }
        line
    }

    fn row(&self, args: &BenchArgs) -> Vec<String> {
        let Self { method, size: Size(w, h), times, .. } = self;
        let mut row = vec![method.name().to_owned(), format!("{w}×{h}")];
        if !args.cost {
            // Stages under a hundredth of the whole are left out.
            let stages = times.stages.iter().filter(|(_, time)| *time >= times.median / 100);
            let stages = stages.map(|&(name, time)| (name, time));
            let stages = stages.chain(times.present.map(|time| ("present", time)));
            let stages: Vec<_> = stages.map(|(n, t)| format!("{n} {:.1}", ms(t))).collect();
            row.extend([times.median, times.least].map(|time| format!("{:.2}", ms(time))));
            row.extend([times.runs.to_string(), stages.join(", ")]);
        }
        if let Some(cost) = &times.cost {
            let moved = cost.bytes_read() + cost.bytes_written();
            row.push(cost.dispatches().to_string());
            row.extend([moved, cost.bytes_held].map(|bytes| format!("{:.0}", bytes as f64 / 1e6)));
        }
        if let Some(yardstick) = times.yardstick {
            row.push(format!("{:.2}", ms(yardstick)));
            row.push(format!("{:.2}", times.ratio(yardstick)));
        } else if args.yardstick {
            row.extend(["–"; 2].map(str::to_owned));
        }
        row
    }
}

/// The cells to time, and the settings of their scene.
fn grids(args: &BenchArgs) -> Result<(Vec<Cells>, SettingsTable)> {
    if let Some(path) = &args.scene {
        let scene = Input::load(path)?;
        let settings = settings(args, &scene.settings())?;
        let needed = |size| needed(args, &settings, size);
        let (cells, _) = read_cells(&scene, path, args.machine.quiet, needed)?;
        return Ok((vec![cells], scene.settings()));
    }
    let default = [Size(320, 180), Size(640, 360), Size(1280, 720)];
    let sizes = if args.size.is_empty() { &default[..] } else { &args.size };
    let mut direct = SettingsTable::default();
    direct.set("bounces", 0);
    let settings = settings(args, &direct)?;
    let mut grids = Vec::new();
    for &Size(width, height) in sizes {
        let (w, h) = (u64::from(width), u64::from(height));
        Cells::check_size(w, h)?;
        let needed = needed(args, &settings, SceneSize::of_matter(w * h));
        memory::check(needed, format_args!("timing {width}×{height} cells"))?;
        grids.push(bench_scene(width, height)?);
    }
    Ok((grids, direct))
}

/// The settings of each method.
fn settings(args: &BenchArgs, scene: &SettingsTable) -> Result<Vec<Settings>> {
    let of_method =
        |&method| Ok(args.settings.over(scene, Some(Renderer::Method(method)))?.resolve()?);
    methods(args).iter().map(of_method).collect()
}

/// The number of bytes that the hungriest method takes.
fn needed(args: &BenchArgs, settings: &[Settings], size: SceneSize) -> u64 {
    let of_method = |settings: &Settings| {
        let renderer = Renderer::Method(settings.method());
        memory::estimate(size, renderer, settings, args.machine.backend)
    };
    let picture = args.scale.map_or(0, |scale| memory::estimate_picture(size.cells, scale));
    settings.iter().map(of_method).max().unwrap_or(0) + picture
}

/// The methods to time.
fn methods(args: &BenchArgs) -> &[Method] {
    if args.method.is_empty() { Method::ALL } else { &args.method }
}

/// The times of a case.
struct Times {
    median: Duration,
    least: Duration,
    runs: usize,
    /// The median of each stage.
    stages: Vec<(&'static str, Duration)>,
    /// The median of making the picture, with `--scale`.
    present: Option<Duration>,
    /// The median of the yardstick, with `--yardstick`.
    yardstick: Option<Duration>,
    /// The cost of a frame on the GPU.
    cost: Option<FrameCost>,
}

impl Times {
    /// The yardstick's time ÷ the method's.
    fn ratio(&self, yardstick: Duration) -> f64 {
        yardstick.as_secs_f64() / self.median.as_secs_f64()
    }

    fn stages_json(&self) -> Map<String, Value> {
        self.stages.iter().map(|&(name, time)| (name.to_owned(), ms(time).into())).collect()
    }
}

/// Times `solve` from cells in memory, except the first frame, which makes the buffers. The yardstick's
/// frames lie between the method's, so both see the same machine.
fn time(cells: &Cells, settings: Settings, scale: Option<u32>, yardstick: bool) -> Result<Times> {
    let mut solver = Solver::new(settings)?;
    solver.solve(cells)?;
    let mut drawn = cells.drawn().into_owned();
    Glow::default().to_media(&mut drawn);
    let mut plain = Paper::yardstick();
    if yardstick {
        plain.solve(&drawn);
    }
    let mut frames: Vec<Duration> = Vec::new();
    let mut plain_frames: Vec<Duration> = Vec::new();
    let mut stages = StageTimes::default();
    let start = Instant::now();
    while goes_on(&frames, start, TIME) {
        let frame = Instant::now();
        solver.solve(cells)?;
        frames.push(frame.elapsed());
        stages.add(solver.timings());
        if yardstick {
            let frame = Instant::now();
            plain.solve(&drawn);
            plain_frames.push(frame.elapsed());
        }
    }
    let mut presents = Vec::new();
    if let Some(scale) = scale {
        let view = FrameView::new(cells, &drawn, Display::default()).lit(solver.light());
        for _ in 0..LEAST_RUNS {
            let present = Instant::now();
            view.picture(Stage::Final, scale)?;
            presents.push(present.elapsed());
        }
    }
    let least = frames.iter().min().copied();
    Ok(Times {
        runs: frames.len(),
        least: least.ok_or_else(|| CliError::failed("nothing was timed"))?,
        median: median(&mut frames),
        present: scale.map(|_| median(&mut presents)),
        yardstick: yardstick.then(|| median(&mut plain_frames)),
        stages: stages.medians(),
        cost: None,
    })
}

/// Times frames on the GPU, by its own clock if it has one, except the first, which makes the buffers.
fn time_on_gpu(gpu: &Gpu, cells: &Cells, settings: Settings, only_cost: bool) -> Result<Times> {
    let (mut runs, cost) = gpu.frames(cells, settings)?;
    let mut frames: Vec<Duration> = Vec::new();
    let mut stages = StageTimes::default();
    if !only_cost {
        runs.next()?;
        let start = Instant::now();
        while goes_on(&frames, start, TIME_ON_GPU) {
            let frame = runs.again()?;
            frames.push(frame.iter().map(|(_, time)| *time).sum());
            stages.add(&frame);
        }
    }
    Ok(Times {
        runs: frames.len(),
        least: frames.iter().min().copied().unwrap_or_default(),
        median: median(&mut frames),
        stages: stages.medians(),
        present: None,
        yardstick: None,
        cost: Some(cost),
    })
}

/// True if a case needs another run.
fn goes_on(frames: &[Duration], start: Instant, time: Duration) -> bool {
    frames.len() < LEAST_RUNS || (start.elapsed() < time && frames.len() < MOST_RUNS)
}

/// The times of stages in each frame.
#[derive(Default)]
struct StageTimes(Vec<(&'static str, Vec<Duration>)>);

impl StageTimes {
    /// Adds the times of a frame.
    fn add(&mut self, frame: &[(&'static str, Duration)]) {
        for &(name, time) in frame {
            match self.0.iter_mut().find(|(known, _)| *known == name) {
                Some((_, times)) => times.push(time),
                None => self.0.push((name, vec![time])),
            }
        }
    }

    fn medians(self) -> Vec<(&'static str, Duration)> {
        self.0.into_iter().map(|(name, mut times)| (name, median(&mut times))).collect()
    }
}

fn median(times: &mut [Duration]) -> Duration {
    times.sort_unstable();
    times.get(times.len() / 2).copied().unwrap_or_default()
}
