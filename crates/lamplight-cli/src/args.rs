//! Flags that several commands share.

use crate::failure::{Failure, Outcome};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use lamplight::{Bounces, Display, Method, Settings, SettingsTable, ToneMap};

/// Who answers: one of the engine's methods, or the path tracer that judges them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// A method of the engine.
    By(Method),
    /// The path tracer.
    Reference,
}

impl Answer {
    const ALL: &'static [Self] = &{
        let mut all = [Self::Reference; Method::ALL.len() + 1];
        let mut i = 0;
        while i < Method::ALL.len() {
            all[i] = Self::By(Method::ALL[i]);
            i += 1;
        }
        all
    };

    /// Whether it lights lamps by a rule of its own, and does not draw them.
    pub fn lights_lamps(self) -> bool {
        matches!(self, Self::By(method) if method.lights_lamps())
    }

    /// The name in flags and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::By(method) => method.name(),
            Self::Reference => "reference",
        }
    }
}

/// What computes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Backend {
    /// A hardware GPU where this build and machine have one, else the CPU.
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

/// How to light: method, settings, machine.
#[derive(Args, Debug)]
#[command(next_help_heading = "Lighting")]
pub struct Lighting {
    /// How light is found [default: what the scene says, else holographic]
    #[arg(long, value_name = "METHOD", value_parser = by_name(Answer::ALL, Answer::name))]
    pub method: Option<Answer>,
    #[command(flatten)]
    pub settings: SettingFlags,
    /// Frames to solve one after another: noise averages out over them
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub frames: u32,
    /// Paths a pixel, with `--method reference` [default: 256]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub samples: Option<u32>,
    #[command(flatten)]
    pub machine: Machine,
}

impl Lighting {
    /// The settings that a scene and the flags make together.
    pub fn resolve(&self, scene: &SettingsTable) -> Outcome<Settings> {
        let mut table = self.settings.over(scene)?;
        if let Some(Answer::By(method)) = self.method {
            table.set("method", method.name());
        }
        Ok(table.resolve()?)
    }

    /// Flags that are without effect on who answers, one sentence each.
    pub fn idle(&self, answer: Answer) -> Vec<String> {
        let name = answer.name();
        let mut idle = Vec::new();
        for text in &self.settings.set {
            let of = text.split(['.', '=']).next().unwrap_or_default().trim();
            if of != name && Method::ALL.iter().any(|method| method.name() == of) {
                idle.push(format!("`--set {text}` changes nothing: light is found by {name}"));
            }
        }
        if self.samples.is_some() && answer != Answer::Reference {
            idle.push(format!("--samples changes nothing: it is for the reference, not {name}"));
        }
        let bounces = self.settings.bounces.is_some_and(|bounces| bounces != Bounces::Count(0));
        if bounces && answer.lights_lamps() {
            idle.push(format!("--bounces changes nothing: {name} lights by a rule of its own"));
        }
        idle
    }

    /// Who answers.
    pub fn answer(&self, settings: &Settings) -> Answer {
        self.method.unwrap_or(Answer::By(settings.method))
    }
}

/// Flags that change settings.
#[derive(Args, Debug)]
pub struct SettingFlags {
    /// How often light is sent on: a number, or `converged` [default: what the scene says, else 0]
    #[arg(long, value_name = "N")]
    pub bounces: Option<Bounces>,
    /// Seed of everything random: the same seed gives the same bytes [default: 0]
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Change any setting, such as `holographic.preset=fast` or `wall_depth=4`; may be repeated, in
    /// any order. A preset replaces what the scene sets of its method
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

impl SettingFlags {
    /// The settings of a scene with those of the flags over them.
    pub fn over(&self, scene: &SettingsTable) -> Outcome<SettingsTable> {
        let mut flags = SettingsTable::default();
        for text in &self.set {
            flags.set_from_text(text)?;
        }
        if let Some(bounces) = self.bounces {
            match bounces {
                Bounces::Count(k) => flags.set("bounces", k),
                Bounces::Converged => flags.set("bounces", "converged"),
            }
        }
        if let Some(seed) = self.seed {
            flags.set("seed", seed);
        }
        let mut table = scene.clone();
        table.merge(flags);
        Ok(table)
    }
}

/// What computes, and how much it says meanwhile.
#[derive(Args, Debug)]
pub struct Machine {
    /// What computes; `auto` takes a hardware GPU when there is one, else the CPU
    #[arg(
        long,
        value_name = "BACKEND",
        value_enum,
        default_value_t,
        hide_possible_values = true,
        help = "What computes: auto, cpu or gpu; auto takes a hardware GPU when there is one, \
                  else the CPU"
    )]
    pub backend: Backend,
    /// Threads to compute with; the result does not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// No progress bar, no warnings, no report of what was done
    #[arg(long, short)]
    pub quiet: bool,
}

impl Machine {
    /// Runs work on as many threads as were asked for; gives it their number.
    pub fn run<T: Send>(&self, work: impl FnOnce(usize) -> Outcome<T> + Send) -> Outcome<T> {
        let threads = self.threads.map_or(0, usize::from);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|e| Failure::failed(format_args!("cannot start the threads: {e}")))?;
        pool.install(|| work(rayon::current_num_threads()))
    }
}

/// So many threads, in words.
pub fn threads_in_words(threads: usize) -> String {
    format!("{threads} thread{}", if threads == 1 { "" } else { "s" })
}

/// How light is shown.
#[derive(Args, Debug)]
#[command(next_help_heading = "Display")]
pub struct Show {
    /// How bright light is brought to the screen [default: what the scene says, else aces]
    #[arg(long, value_name = "CURVE", value_parser = by_name(ToneMap::ALL, ToneMap::name))]
    pub tonemap: Option<ToneMap>,
    /// Exposure in stops: 1 doubles the light, -1 halves it [default: what the scene says, else 0]
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true)]
    pub exposure: Option<f32>,
    /// Show each cell as K×K pixels
    #[arg(long, value_name = "K", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(1..=64))]
    pub scale: u32,
}

impl Show {
    /// The display that a scene and the flags make together.
    pub fn display(&self, scene: Display) -> Outcome<Display> {
        let display = Display {
            tonemap: self.tonemap.unwrap_or(scene.tonemap),
            exposure: self.exposure.unwrap_or(scene.exposure),
        };
        display.check()?;
        Ok(display)
    }
}
