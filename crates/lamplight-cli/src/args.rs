//! Flags that several commands share.

use crate::available_memory;
use crate::error::{CliError, Result};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use lamplight::{Bounces, Display, Method, Quality, Settings, SettingsTable, ToneMap};
use std::str::FromStr;

/// A method of the engine, or the path tracer that methods are compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Renderer {
    /// A method of the engine.
    Method(Method),
    /// The path tracer.
    Reference,
}

impl Renderer {
    const ALL: &'static [Self] = &{
        let mut all = [Self::Reference; Method::ALL.len() + 1];
        let mut i = 0;
        while i < Method::ALL.len() {
            all[i] = Self::Method(Method::ALL[i]);
            i += 1;
        }
        all
    };

    /// The name in flags and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Method(method) => method.name(),
            Self::Reference => "reference",
        }
    }
}

/// The device that computes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Backend {
    /// A hardware GPU if this machine has one, else the CPU.
    #[default]
    Auto,
    /// The CPU.
    Cpu,
    /// The GPU, or an error.
    Gpu,
}

/// A parser for values that go by name; `--help` and errors list the names.
pub fn by_name<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(all.iter().map(|&value| name(value))).try_map(move |text| {
        all.iter().copied().find(|&value| name(value) == text).ok_or("not a known name")
    })
}

/// A point of a scene, px.
#[derive(Clone, Copy, Debug)]
pub struct Position(pub [f32; 2]);

impl FromStr for Position {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = |text: &str| text.trim().parse().ok().filter(|v: &f32| v.is_finite());
        text.split_once(',')
            .and_then(|(x, y)| Some(Self([number(x)?, number(y)?])))
            .ok_or("a point is two numbers with a comma between them, such as 160,90")
    }
}

/// Flags of how a scene is lit: method, settings, device.
#[derive(Args, Debug)]
#[command(next_help_heading = "Lighting")]
pub struct LightingArgs {
    /// The method that computes the light [default: the scene's method, else holographic]
    #[arg(long, value_name = "METHOD", value_parser = by_name(Renderer::ALL, Renderer::name))]
    pub method: Option<Renderer>,
    #[command(flatten)]
    pub settings: SettingArgs,
    /// Solve N frames in a row; noise averages out over them
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub frames: u32,
    /// Paths per pixel, with `--method reference` [default: 256]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub samples: Option<u32>,
    #[command(flatten)]
    pub machine: MachineArgs,
}

impl LightingArgs {
    /// The renderer and the settings that a scene and the flags result in, and the bounces that they ask for.
    pub fn resolve(&self, scene: &SettingsTable) -> Result<(Renderer, Settings, Option<Bounces>)> {
        let table = self.settings.over(scene, self.method)?;
        let settings = table.resolve()?;
        let bounces = wanted_bounces(&table, &settings);
        Ok((self.method.unwrap_or(Renderer::Method(settings.method())), settings, bounces))
    }
}

/// The bounces of settings, unless the table that they come from leaves them to the default.
pub fn wanted_bounces(table: &SettingsTable, settings: &Settings) -> Option<Bounces> {
    table.contains("bounces").then_some(settings.bounces)
}

/// Flags that change settings.
#[derive(Args, Debug)]
#[command(next_help_heading = "Lighting")]
pub struct SettingArgs {
    /// The level of quality, which selects the method's preset. It replaces all settings of methods in
    /// the scene [default: the scene's quality, else default]
    #[arg(long, value_name = "QUALITY", value_parser = by_name(Quality::ALL, Quality::name))]
    pub quality: Option<Quality>,
    /// Times that light is reflected: a number, `converged` or `feedback` [default: the scene's, else 2]
    #[arg(long, value_name = "N")]
    pub bounces: Option<Bounces>,
    /// Seed for all random numbers; the same seed gives the same bytes [default: 0]
    #[arg(long, value_name = "N", value_parser = seed)]
    pub seed: Option<u64>,
    /// Change any setting, such as `holographic.preset=fast` or `wall_depth=4`. Repeat it for more,
    /// in any order. A preset replaces all that the scene sets for its method
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

/// Parses a seed; the errors of `u64` do not name its range.
fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("a seed is a whole number from 0 to {}", u64::MAX))
}

impl SettingArgs {
    /// The settings of a scene with those of the flags over them, for `renderer` or, without one,
    /// the method that they name.
    pub fn over(&self, scene: &SettingsTable, renderer: Option<Renderer>) -> Result<SettingsTable> {
        let mut flags = self.table()?;
        if let Some(Renderer::Method(method)) = renderer {
            flags.set("method", method.name());
        }
        if let Some(quality) = self.quality {
            flags.set("quality", quality.name());
        }
        let mut table = scene.clone();
        table.merge(flags);
        Ok(table)
    }

    /// The settings of the flags alone, except `--quality`.
    fn table(&self) -> Result<SettingsTable> {
        let mut flags = SettingsTable::default();
        for text in &self.set {
            // As in `[light]`; its keys stand at the root here.
            let text = text.strip_prefix("light.").unwrap_or(text);
            if let Some(error) = misplaced(text) {
                return Err(error);
            }
            flags
                .set_from_text(text)
                .map_err(|error| CliError::bad_input(format_args!("--set: {error}")))?;
        }
        if let Some(bounces) = self.bounces {
            flags.set("bounces", bounces);
        }
        if let Some(seed) = self.seed {
            flags.set("seed", seed);
        }
        Ok(flags)
    }
}

/// The error for `--set` of a key that stands elsewhere.
fn misplaced(text: &str) -> Option<CliError> {
    let (key, value) = text.split_once('=')?;
    let hint = match key.trim() {
        "preset" => "use `--quality`, or name the method: `--set holographic.preset=fast`".into(),
        "exposure" | "display.exposure" => format!("use `--exposure {value}`"),
        "tonemap" | "display.tonemap" => format!("use `--tonemap {value}`"),
        "frames" => format!("use `--frames {value}`"),
        "samples" => format!("use `--samples {value}`"),
        _ => return None,
    };
    let message = format!("`--set {text}`: `{}` is not a setting of the light", key.trim());
    Some(CliError::bad_input(message).hint(hint))
}

/// The help of `--backend` of commands that compute on the CPU.
pub const ON_THE_CPU: &str = "The device that computes: auto or cpu; both are the CPU so far";

/// Flags of the device, and of how much is printed meanwhile.
#[derive(Args, Debug)]
#[command(next_help_heading = "Lighting")]
pub struct MachineArgs {
    /// The device that computes
    #[arg(
        long,
        value_name = "BACKEND",
        value_enum,
        default_value_t,
        hide_possible_values = true,
        help = "The device that computes: auto, cpu or gpu; auto uses a hardware GPU if there is \
                  one, else the CPU"
    )]
    pub backend: Backend,
    /// Threads to compute with; the result does not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print no progress bar, no warnings and no summary
    #[arg(long, short)]
    pub quiet: bool,
}

impl MachineArgs {
    /// Runs work on the number of threads that the flags name, and passes it that number.
    pub fn run<T: Send>(&self, work: impl FnOnce(usize) -> Result<T> + Send) -> Result<T> {
        let threads = self.threads.map_or(0, usize::from);
        available_memory::threads_are_about_to_start();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|e| CliError::failed(format_args!("cannot start the threads: {e}")))?;
        pool.install(|| work(rayon::current_num_threads()))
    }
}

/// Flags of how light is shown.
#[derive(Args, Debug)]
#[command(next_help_heading = "Display")]
pub struct DisplayArgs {
    /// Tone map: the curve that brings light to the screen [default: the scene's, else vivid]
    #[arg(long, value_name = "CURVE", value_parser = by_name(ToneMap::ALL, ToneMap::name))]
    pub tonemap: Option<ToneMap>,
    /// Exposure in stops: 1 doubles the light, -1 halves it [default: the scene's, else 0]
    #[arg(long, value_name = "STOPS")]
    pub exposure: Option<f32>,
    /// Show each cell as K×K pixels
    #[arg(long, value_name = "K", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(1..=64))]
    pub scale: u32,
}

/// No flags given.
impl Default for DisplayArgs {
    fn default() -> Self {
        Self { tonemap: None, exposure: None, scale: 1 }
    }
}

impl DisplayArgs {
    /// The display that a scene and the flags result in.
    pub fn resolve(&self, scene: Display) -> Result<Display> {
        let display = Display {
            tonemap: self.tonemap.unwrap_or(scene.tonemap),
            exposure: self.exposure.unwrap_or(scene.exposure),
            ..scene
        };
        display.check()?;
        Ok(display)
    }
}
