//! Progress bars: on a terminal, never in a pipe, never with `--quiet`.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::Duration;

/// A progress bar on stderr, cleared when dropped.
pub struct Progress(ProgressBar);

impl Progress {
    /// A bar with a label in front of it.
    pub fn new(what: &str, steps: u64, quiet: bool) -> Self {
        // Nothing is drawn if stderr is not a terminal.
        let target =
            if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(steps), target);
        let style =
            ProgressStyle::with_template("{msg} {wide_bar:.yellow/dim} {percent:>3} % {eta:>4}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(what.to_owned());
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar)
    }

    /// Changes the label.
    pub fn label(&self, what: &str) {
        self.0.set_message(what.to_owned());
    }

    /// Advances by one step.
    pub fn step(&self) {
        self.0.inc(1);
    }

    /// Sets the number of finished steps, and of all.
    pub fn of(&self, step: u64, steps: u64) {
        self.0.set_length(steps);
        self.0.set_position(step);
    }

    /// Sets the number of finished steps.
    pub fn at(&self, step: u64) {
        self.0.set_position(step);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
