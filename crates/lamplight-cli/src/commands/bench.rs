//! `lamplight bench`: how long a frame takes, and which stage takes it.

use crate::args::{Backend, Machine, SettingFlags, by_name};
use crate::failure::{Failure, Outcome};
use crate::gpu::Gpu;
use crate::lighting::{self, ms};
use crate::output;
use crate::place::Place;
use crate::progress::Progress;
use crate::room::{lamp_room, room};
use crate::stage::{Stage, View};
use crate::table::table;
use lamplight::methods::holographic::paper::Paper;
use lamplight::{Cells, Display, Method, Settings, SettingsTable, Solver};
use lamplight_wgpu::{Cost, KernelCost};
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::str::FromStr;
use std::time::{Duration, Instant};

/// A case is timed for about this long,
const TIME: Duration = Duration::from_secs(2);
/// but at least so often, so that there is a median,
const LEAST_RUNS: usize = 5;
/// and at most so often.
const MOST_RUNS: usize = 501;

/// Time methods over sizes, per stage
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Methods to time, with commas between them [default: all]
    #[arg(long, value_name = "METHOD", value_delimiter = ',',
          value_parser = by_name(Method::ALL, Method::name))]
    method: Vec<Method>,
    /// Sizes of the built-in scene, such as 320x180,512x512 [default: 320x180,640x360,1280x720];
    /// for polar it has lamps of range 64, 1000 of them at 1280x720
    #[arg(long, value_name = "WxH", value_delimiter = ',', conflicts_with = "scene")]
    size: Vec<Size>,
    /// Time this scene instead of the built-in one
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Time making the picture too, each cell as K × K pixels: `present_ms`, beside the time to solve
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..=64))]
    scale: Option<u32>,
    /// Time a plain implementation of the published holographic cascades (direct light) in turns with
    /// the method, and give its time ÷ the method's: a ratio that depends little on the machine. For
    /// methods that see what it sees: not polar and flood
    #[arg(long)]
    yardstick: bool,
    /// With --backend gpu: run nothing, and only say what a frame would move and hold
    #[arg(long)]
    cost: bool,
    /// Print one JSON object a line, one for each case
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    settings: SettingFlags,
    #[command(flatten)]
    machine: Machine,
}

/// What all runs of a kernel take, for `--json`.
fn kernel_json(kernel: &KernelCost) -> Value {
    let KernelCost { shader, entry, dispatches, traffic } = *kernel;
    json!({
        "shader": shader, "entry": entry, "dispatches": dispatches,
        "bytes_read": traffic.read, "bytes_written": traffic.written,
    })
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

pub fn run(args: Args) -> Outcome {
    let gpu = (args.machine.backend == Backend::Gpu).then(Gpu::best).transpose()?;
    if gpu.is_none() && args.cost {
        let error = Failure::bad_input("--cost says what a frame takes on the GPU");
        return Err(error.hint("say --backend gpu too"));
    }
    if gpu.is_some() && (args.yardstick || args.scale.is_some()) {
        let error = Failure::bad_input("--yardstick and --scale time the CPU");
        return Err(error.hint("leave --backend out"));
    }
    let backend = if gpu.is_some() { "gpu" } else { "cpu" };
    let methods = if args.method.is_empty() { Method::ALL } else { &args.method };
    args.machine.run(|threads| {
        let (grids, scene) = grids(&args)?;
        let table_of_scene = args.settings.over(&scene)?;
        let cases = methods.iter().flat_map(|m| grids.iter().map(move |g| (*m, g)));
        let progress =
            Progress::new("timing", (methods.len() * grids.len()) as u64, args.machine.quiet);
        let mut rows = Vec::new();
        for (method, cells) in cases {
            let (w, h) = (cells.width(), cells.height());
            progress.say(&format!("timing {} at {w}×{h}", method.name()));
            let mut settings = table_of_scene.clone();
            settings.set("method", method.name());
            let lamps;
            let cells = if args.scene.is_none() && method.suits(cells).is_err() {
                lamps = lamp_room(w, h)?;
                &lamps
            } else {
                cells
            };
            let settings = settings.resolve()?;
            let times = match &gpu {
                Some(gpu) => time_on_gpu(gpu, cells, settings, args.cost)?,
                None => {
                    time(cells, settings, args.scale, args.yardstick && !method.lights_lamps())?
                }
            };
            progress.step();
            if args.json {
                let mut line = json!({
                    "method": method.name(), "backend": backend, "width": w, "height": h,
                    "threads": threads, "median_ms": ms(times.median), "min_ms": ms(times.least),
                    "runs": times.runs, "stages_ms": times.stages_json(),
                });
                if let (Some(gpu), Some(cost)) = (&gpu, &times.cost) {
                    line["adapter"] = gpu.name().into();
                    line["dispatches"] = cost.dispatches().into();
                    line["bytes_read"] = cost.traffic().read.into();
                    line["bytes_written"] = cost.traffic().written.into();
                    line["bytes_held"] = cost.memory.into();
                    line["kernels"] = cost.kernels.iter().map(kernel_json).collect();
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
                output::print(line)?;
                continue;
            }
            let stages = times.stages.iter().filter(|(_, time)| *time >= times.median / 100);
            let stages = stages.map(|&(name, time)| (name, time));
            let stages = stages.chain(times.present.map(|time| ("present", time)));
            let stages: Vec<_> = stages.map(|(n, t)| format!("{n} {:.1}", ms(t))).collect();
            let mut row = vec![
                method.name().to_owned(),
                format!("{w}×{h}"),
                format!("{:.2}", ms(times.median)),
                format!("{:.2}", ms(times.least)),
                times.runs.to_string(),
                stages.join(", "),
            ];
            if let Some(cost) = &times.cost {
                let moved = cost.traffic().read + cost.traffic().written;
                row.push(cost.dispatches().to_string());
                row.extend([moved, cost.memory].map(|bytes| format!("{:.0}", bytes as f64 / 1e6)));
            }
            if let Some(yardstick) = times.yardstick {
                row.push(format!("{:.2}", ms(yardstick)));
                row.push(format!("{:.2}", times.ratio(yardstick)));
            } else if args.yardstick {
                row.extend(["–"; 2].map(str::to_owned));
            }
            rows.push(row);
        }
        drop(progress);
        if args.json {
            return Ok(());
        }
        let mut header = vec!["method", "size", "median ms", "least ms", "runs", "ms by stage"];
        if gpu.is_some() {
            header.extend(["dispatches", "MB moved", "MB held"]);
        }
        if args.yardstick {
            header.extend(["yardstick ms", "times faster"]);
        }
        output::print(table(&header, &[0, 5], rows))?;
        output::print(gpu.as_ref().map_or_else(Place::cpu, Gpu::place))
    })
}

/// What to time, and the settings that come with it.
fn grids(args: &Args) -> Outcome<(Vec<Cells>, SettingsTable)> {
    if let Some(path) = &args.scene {
        let (scene, cells) = lighting::open(path, args.machine.quiet)?;
        return Ok((vec![cells], scene.light));
    }
    let default = [Size(320, 180), Size(640, 360), Size(1280, 720)];
    let sizes = if args.size.is_empty() { &default[..] } else { &args.size };
    let grids = sizes.iter().map(|&Size(w, h)| room(w, h)).collect::<Outcome<_>>()?;
    Ok((grids, SettingsTable::default()))
}

/// What the runs of a case took.
struct Times {
    median: Duration,
    least: Duration,
    runs: usize,
    /// Median of each stage.
    stages: Vec<(&'static str, Duration)>,
    /// Median of making the picture, where asked for.
    present: Option<Duration>,
    /// Median of the yardstick, where asked for.
    yardstick: Option<Duration>,
    /// What a frame takes on the GPU.
    cost: Option<Cost>,
}

impl Times {
    /// How many times as long the yardstick takes.
    fn ratio(&self, yardstick: Duration) -> f64 {
        yardstick.as_secs_f64() / self.median.as_secs_f64()
    }

    fn stages_json(&self) -> Map<String, Value> {
        self.stages.iter().map(|&(name, time)| (name.to_owned(), ms(time).into())).collect()
    }
}

/// Times `solve` from cells in memory; the first frame, which makes the buffers, does not count. The
/// yardstick's frames lie between the method's, so that both see the same machine.
fn time(cells: &Cells, settings: Settings, scale: Option<u32>, yardstick: bool) -> Outcome<Times> {
    let mut solver = Solver::new(settings)?;
    solver.solve(cells)?;
    let drawn = cells.drawn();
    let mut plain = Paper::yardstick();
    if yardstick {
        plain.solve(&drawn);
    }
    let mut frames: Vec<Duration> = Vec::new();
    let mut plain_frames: Vec<Duration> = Vec::new();
    let mut stages = Stages::default();
    let start = Instant::now();
    while goes_on(&frames, start) {
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
        let view = View::new(&drawn, Display::default()).lit(solver.light());
        for _ in 0..LEAST_RUNS {
            let present = Instant::now();
            view.picture(Stage::Final, scale)?;
            presents.push(present.elapsed());
        }
    }
    let least = frames.iter().min().copied();
    Ok(Times {
        runs: frames.len(),
        least: least.ok_or_else(|| Failure::failed("nothing was timed"))?,
        median: median(&mut frames),
        present: scale.map(|_| median(&mut presents)),
        yardstick: yardstick.then(|| median(&mut plain_frames)),
        stages: stages.medians(),
        cost: None,
    })
}

/// Times frames on the GPU, by its own clock where it has one; the first, which makes the buffers, does
/// not count.
fn time_on_gpu(gpu: &Gpu, cells: &Cells, settings: Settings, only_cost: bool) -> Outcome<Times> {
    let (mut runs, cost) = gpu.frames(cells, settings)?;
    let mut frames: Vec<Duration> = Vec::new();
    let mut stages = Stages::default();
    if !only_cost {
        runs.next()?;
        let start = Instant::now();
        while goes_on(&frames, start) {
            let frame = runs.next()?;
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

/// Whether a case is to be timed once more.
fn goes_on(frames: &[Duration], start: Instant) -> bool {
    frames.len() < LEAST_RUNS || (start.elapsed() < TIME && frames.len() < MOST_RUNS)
}

/// What stages took in each frame.
#[derive(Default)]
struct Stages(Vec<(&'static str, Vec<Duration>)>);

impl Stages {
    /// Takes over a frame.
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
