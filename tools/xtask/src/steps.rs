//! Steps of a long chore, each with its name before it begins and its time after.

use anyhow::{Context, Result};
use std::io::Write;
use std::time::{Duration, Instant};

/// The steps so far, and their times.
pub struct Steps {
    begin: Instant,
    times: Vec<(String, Duration)>,
}

impl Steps {
    pub fn new() -> Self {
        Self { begin: Instant::now(), times: Vec::new() }
    }

    /// Runs a step.
    pub fn step(&mut self, name: &str, work: impl FnOnce() -> Result<()>) -> Result<()> {
        println!("== {name}");
        // What the step's programs print comes after it, even in a file.
        std::io::stdout().flush()?;
        let begin = Instant::now();
        work().with_context(|| {
            format!("{name}: failed after {:.1} s", begin.elapsed().as_secs_f64())
        })?;
        let time = begin.elapsed();
        println!("== {name}: passed in {:.1} s", time.as_secs_f64());
        self.times.push((name.to_owned(), time));
        Ok(())
    }

    /// Prints the time of every step.
    pub fn finish(self) {
        println!("== all passed in {:.1} s", self.begin.elapsed().as_secs_f64());
        for (name, time) in self.times {
            println!("{:>8.1} s  {name}", time.as_secs_f64());
        }
    }
}
