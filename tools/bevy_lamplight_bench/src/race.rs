//! Contenders side by side, scene by scene.

use crate::contender::Contender;
use crate::headless::{Adapter, Frame};
use crate::worker::{Failure, Job, Worker};
use anyhow::{Result, ensure};
use serde::Serialize;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// The time limit of a frame.
const FRAME: Duration = Duration::from_secs(30);
/// The limit for building an app and for its first frame, in which pipelines are compiled.
const BEGIN: Duration = Duration::from_secs(45);
/// Seconds after which a contender draws no further frames before it is measured, or while it is.
const BEFORE: f64 = 5.0;
const MEASURED: f64 = 6.0;
/// Frames before those that are measured: textures and buffers come to their sizes.
const WARM_UP: usize = 3;

/// The parameters of a comparison.
pub struct Race {
    pub contenders: Vec<Contender>,
    /// Frames measured of each, where there is time.
    pub frames: usize,
    /// The folder for a picture of each, if any.
    pub pictures: Option<PathBuf>,
}

/// Number of lamps and occluders.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Counts {
    pub lamps: u32,
    pub occluders: u32,
}

/// The outcome of a contender in one scene.
#[derive(Debug, Serialize)]
pub struct Entry {
    pub contender: Contender,
    pub outcome: Outcome,
}

/// The times of a contender, or its failure.
#[derive(Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Median frame, and all that were measured.
    Measured { median: Frame, frames: Vec<Frame> },
    /// It drew no frame.
    Failed(Failure),
}

/// A contender on the track.
struct Runner {
    contender: Contender,
    worker: Option<Worker>,
    frames: Vec<Frame>,
    failure: Option<Failure>,
}

impl Race {
    /// Measures all contenders in one scene, in turns: a frame each, then the next of each, so that
    /// other load on the machine affects all of them.
    pub fn run(&self, counts: Counts, adapter: &mut Option<Adapter>) -> Result<Vec<Entry>> {
        let begin = Instant::now();
        let mut runners = Vec::new();
        for &contender in &self.contenders {
            runners.push(self.start(contender, counts, adapter)?);
        }
        for _ in 0..self.frames {
            for runner in &mut runners {
                runner.step()?;
            }
        }
        if let Some(folder) = &self.pictures {
            let Counts { lamps, occluders } = counts;
            for runner in &mut runners {
                let name = format!("{:?}-{lamps}-{occluders}.png", runner.contender);
                runner.picture(folder.join(name.to_lowercase()))?;
            }
        }
        let entries: Vec<_> = runners.into_iter().map(Runner::entry).collect();
        for entry in &entries {
            eprintln!("    {:?}: {}", entry.contender, entry.outcome.time());
        }
        eprintln!("    in {:.0} s", begin.elapsed().as_secs_f64());
        Ok(entries)
    }

    fn start(
        &self,
        contender: Contender,
        Counts { lamps, occluders }: Counts,
        adapter: &mut Option<Adapter>,
    ) -> Result<Runner> {
        let job = Job { contender, lamps, occluders };
        let mut runner = Runner { contender, worker: None, frames: Vec::new(), failure: None };
        match Worker::start(&job, BEGIN)? {
            Ok(worker) => {
                let first = adapter.get_or_insert_with(|| worker.adapter.clone());
                ensure!(*first == worker.adapter, "{contender:?} draws with another adapter");
                runner.worker = Some(worker);
            }
            Err(failure) => runner.failure = Some(failure),
        }
        let mut spent = 0.0;
        for frame in 0..WARM_UP {
            let Some(worker) = &mut runner.worker else { break };
            match worker.frame(if frame == 0 { BEGIN } else { FRAME })? {
                Ok(Frame { all, .. }) => spent += all / 1e3,
                Err(failure) => runner.fail(failure),
            }
            if spent > BEFORE {
                break;
            }
        }
        Ok(runner)
    }
}

impl Runner {
    fn step(&mut self) -> Result<()> {
        let spent: f64 = self.frames.iter().map(|frame| frame.all / 1e3).sum();
        let Some(worker) = self.worker.as_mut().filter(|_| spent < MEASURED) else {
            return Ok(());
        };
        match worker.frame(FRAME)? {
            Ok(frame) => self.frames.push(frame),
            Err(failure) => self.fail(failure),
        }
        Ok(())
    }

    fn picture(&mut self, path: PathBuf) -> Result<()> {
        let Some(worker) = &mut self.worker else { return Ok(()) };
        if let Err(failure) = worker.picture(path, BEGIN)? {
            eprintln!("    {:?} gives no picture: {failure:?}", self.contender);
        }
        Ok(())
    }

    /// Ends it: one that failed gets no second chance.
    fn fail(&mut self, failure: Failure) {
        self.failure = Some(failure);
        self.worker = None;
    }

    fn entry(self) -> Entry {
        let outcome = match self.failure {
            Some(failure) => Outcome::Failed(failure),
            None => {
                let median = Frame {
                    all: median(self.frames.iter().map(|frame| frame.all)),
                    cpu: median(self.frames.iter().map(|frame| frame.cpu)),
                    work: median(self.frames.iter().map(|frame| frame.work)),
                };
                Outcome::Measured { median, frames: self.frames }
            }
        };
        Entry { contender: self.contender, outcome }
    }
}

impl Outcome {
    /// For people: milliseconds, those of the CPU in brackets.
    pub fn time(&self) -> String {
        self.in_words(|Frame { all, cpu, .. }| {
            format!("{} ({})", milliseconds(*all), milliseconds(*cpu))
        })
    }

    /// For people: milliseconds of work.
    pub fn work(&self) -> String {
        self.in_words(|frame| milliseconds(frame.work))
    }

    fn in_words(&self, of: impl Fn(&Frame) -> String) -> String {
        match self {
            Self::Measured { median, .. } => of(median),
            Self::Failed(Failure::TooSlow(limit)) => format!("> {limit:.0} s"),
            Self::Failed(Failure::Died) => "panics".to_owned(),
        }
    }
}

fn milliseconds(value: f64) -> String {
    if value < 99.5 { format!("{value:.1}") } else { format!("{value:.0}") }
}

/// The middle value; of an even number the mean of the two. NaN of none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => values[middle],
        _ => 0.5 * (values[middle - 1] + values[middle]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median([9.0, 1.0, 2.0].into_iter()), 2.0);
        assert_eq!(median([4.0, 1.0, 2.0, 9.0].into_iter()), 3.0);
    }

    #[test]
    fn milliseconds_have_three_digits() {
        let texts = [0.04, 9.96, 99.44, 99.5, 1234.4].map(milliseconds);
        assert_eq!(texts, ["0.0", "10.0", "99.4", "100", "1234"]);
    }
}
