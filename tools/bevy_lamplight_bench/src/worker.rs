//! One contender and one scene in a process of their own, and the protocol with it.
//!
//! A process, because a frame that takes too long can only be ended with its process, and because a
//! plugin that panics takes nobody else with it.

use crate::contender::Contender;
use crate::headless::{Adapter, Frame};
use crate::scene::Scene;
use crate::stage;
use anyhow::{Context, Result};
use clap::ValueEnum;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// The scene and the contender of a worker.
#[derive(Clone, Debug, clap::Args)]
pub struct Job {
    /// The contender that lights it
    pub contender: Contender,
    /// The number of lamps
    pub lamps: u32,
    /// The number of occluders
    pub occluders: u32,
}

/// A request to a worker, one line of JSON each.
#[derive(Serialize, Deserialize)]
enum Ask {
    Frame,
    Picture(PathBuf),
}

/// An answer of a worker, one line of JSON each: first `Ready`, then one per request.
#[derive(Serialize, Deserialize)]
enum Answer {
    Ready(Adapter),
    Frame(Frame),
    Saved,
}

/// Runs a job until the requests end.
pub fn work(job: &Job) -> Result<()> {
    let mut headless = stage::set(job.contender, &Scene::new(job.lamps, job.occluders));
    write_line(std::io::stdout(), &Answer::Ready(headless.adapter()))?;
    for line in std::io::stdin().lines() {
        let answer = match serde_json::from_str(&line?)? {
            Ask::Frame => Answer::Frame(headless.frame()?),
            Ask::Picture(path) => {
                headless.save(&path)?;
                Answer::Saved
            }
        };
        write_line(std::io::stdout(), &answer)?;
    }
    Ok(())
}

/// A worker's process, ended when this is dropped.
pub struct Worker {
    process: Child,
    asks: ChildStdin,
    answers: Receiver<Answer>,
    /// Its graphics adapter.
    pub adapter: Adapter,
}

/// The reason why a worker gave no answer.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Failure {
    /// It took longer than this many seconds.
    TooSlow(f64),
    /// Its process ended.
    Died,
}

impl Worker {
    /// Starts the process and waits until its app is built.
    pub fn start(job: &Job, limit: Duration) -> Result<Result<Self, Failure>> {
        let name = job.contender.to_possible_value().context("a contender has a name")?;
        let mut process = Command::new(std::env::current_exe()?)
            .args(["work", name.get_name()])
            .args([job.lamps.to_string(), job.occluders.to_string()])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .context("starting a worker")?;
        let asks = process.stdin.take().context("a worker has an input")?;
        let answers = read_lines(process.stdout.take().context("a worker has an output")?);
        let ready = wait(&answers, limit);
        let adapter = match ready {
            Ok(Answer::Ready(adapter)) => adapter,
            Ok(_) => anyhow::bail!("a worker answers before it is ready"),
            Err(failure) => {
                end(&mut process);
                return Ok(Err(failure));
            }
        };
        Ok(Ok(Self { process, asks, answers, adapter }))
    }

    /// Has it draw a frame.
    pub fn frame(&mut self, limit: Duration) -> Result<Result<Frame, Failure>> {
        match self.ask(&Ask::Frame, limit)? {
            Ok(Answer::Frame(frame)) => Ok(Ok(frame)),
            Ok(_) => anyhow::bail!("a worker answers something else than a frame"),
            Err(failure) => Ok(Err(failure)),
        }
    }

    /// Has it write a picture.
    pub fn picture(&mut self, path: PathBuf, limit: Duration) -> Result<Result<(), Failure>> {
        Ok(self.ask(&Ask::Picture(path), limit)?.map(|_| ()))
    }

    fn ask(&mut self, ask: &Ask, limit: Duration) -> Result<Result<Answer, Failure>> {
        // A pipe without a reader: the process has ended, and reading the answer reports that.
        let _ = write_line(&mut self.asks, ask);
        Ok(wait(&self.answers, limit))
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        end(&mut self.process);
    }
}

fn wait(answers: &Receiver<Answer>, limit: Duration) -> Result<Answer, Failure> {
    answers.recv_timeout(limit).map_err(|error| match error {
        RecvTimeoutError::Timeout => Failure::TooSlow(limit.as_secs_f64()),
        RecvTimeoutError::Disconnected => Failure::Died,
    })
}

/// Ends a process that may have ended already.
fn end(process: &mut Child) {
    let _ = process.kill();
    let _ = process.wait();
}

fn write_line(mut to: impl Write, value: &impl Serialize) -> Result<()> {
    writeln!(to, "{}", serde_json::to_string(value)?)?;
    Ok(to.flush()?)
}

/// Lines of JSON as they come; closed when the process ends or says anything else.
fn read_lines<T: DeserializeOwned + Send + 'static>(
    from: impl std::io::Read + Send + 'static,
) -> Receiver<T> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        for line in BufReader::new(from).lines() {
            let Some(value) = line.ok().and_then(|line| serde_json::from_str(&line).ok()) else {
                break;
            };
            if sender.send(value).is_err() {
                break;
            }
        }
    });
    receiver
}
