//! A benchmark of all methods and presets on the current scene.

use eframe::egui::{Grid, ProgressBar, Ui};
use lamplight::settings::MethodSettings;
use lamplight::{Method, Settings};
use std::fmt::Write as _;
use std::time::Duration;

/// Frames that do not count: pipelines are compiled, and GPU timestamps lag behind.
const WARM_UP: u32 = 8;
/// The largest number of frames that count.
const FRAMES: u32 = 24;
/// The largest time per method, s.
const MAX_TIME: f64 = 4.0;

/// A run over all methods.
#[derive(Default)]
pub struct Benchmark {
    /// Remaining settings; the current ones are last.
    left: Vec<(Settings, &'static str)>,
    total: usize,
    frames: u32,
    spent: f64,
    times: Vec<f64>,
    rows: Vec<Row>,
    /// A description of the scene.
    pub subject: String,
}

/// The result of one preset.
struct Row {
    method: &'static str,
    preset: &'static str,
    /// ms per frame; `None` if the method cannot light the scene.
    median: Option<f64>,
    least: f64,
}

impl Benchmark {
    /// Starts with all methods and presets. Bounces and wall depth are those of the settings.
    pub fn begin(&mut self, settings: &Settings, subject: String) {
        let presets = |&method: &Method| method.presets().iter().map(move |&name| (method, name));
        let with = |(method, preset)| {
            let method = MethodSettings::preset(method, preset).ok()?;
            Some((Settings { method, ..settings.clone() }, preset))
        };
        let left: Vec<_> = Method::ALL.iter().flat_map(presets).filter_map(with).rev().collect();
        *self = Self { total: left.len(), left, subject, ..Self::default() };
    }

    /// The settings of the next frame; `None` if the benchmark is over.
    pub fn settings(&self) -> Option<&Settings> {
        self.left.last().map(|(settings, _)| settings)
    }

    /// Counts a frame. Its time is the sum of `stages`, or without them `passed`, the seconds since the
    /// previous frame.
    pub fn lit(&mut self, stages: &[(&'static str, Duration)], passed: f64) {
        self.frames += 1;
        if self.frames > WARM_UP {
            let seconds = match stages {
                [] => passed,
                _ => stages.iter().map(|(_, time)| time.as_secs_f64()).sum(),
            };
            self.times.push(1e3 * seconds);
        }
        self.spent += passed;
        let counted = self.times.len();
        if counted >= FRAMES as usize || counted >= 3 && self.spent > MAX_TIME {
            self.times.sort_by(f64::total_cmp);
            self.note(Some(self.times[counted / 2]));
        }
    }

    /// Records that the current method cannot light the scene.
    pub fn refused(&mut self) {
        self.note(None);
    }

    fn note(&mut self, median: Option<f64>) {
        let Some((settings, preset)) = self.left.pop() else { return };
        let least = self.times.first().copied().unwrap_or_default();
        self.rows.push(Row { method: settings.method().name(), preset, median, least });
        (self.frames, self.spent) = (0, 0.0);
        self.times.clear();
    }

    /// Returns true if the benchmark has been started.
    pub fn is_on(&self) -> bool {
        self.total > 0
    }

    /// Shows the table. Returns `false` if the user closes it.
    pub fn show(&self, ui: &mut Ui) -> bool {
        let done = self.total - self.left.len();
        if !self.left.is_empty() {
            ui.add(ProgressBar::new(done as f32 / self.total as f32).show_percentage());
        }
        ui.label(&self.subject);
        Grid::new("benchmark").striped(true).num_columns(4).show(ui, |ui| {
            for title in ["method", "preset", "median ms", "least ms"] {
                ui.strong(title);
            }
            ui.end_row();
            for row in &self.rows {
                row.words().into_iter().for_each(|word| {
                    ui.label(word);
                });
                ui.end_row();
            }
        });
        ui.horizontal(|ui| {
            if ui.button("Copy").on_hover_text("As a Markdown table").clicked() {
                ui.ctx().copy_text(self.markdown());
            }
            !ui.button("Close").clicked()
        })
        .inner
    }

    /// The table as Markdown.
    pub fn markdown(&self) -> String {
        let mut text = format!("{}\n\n| method | preset | median ms | least ms |\n", self.subject);
        text += "| --- | --- | ---: | ---: |\n";
        for row in &self.rows {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "| {} |", row.words().join(" | "));
        }
        text
    }
}

impl Row {
    fn words(&self) -> [String; 4] {
        let ms = |time: f64| format!("{time:.2}");
        let [median, least] = match self.median {
            Some(median) => [ms(median), ms(self.least)],
            None => ["cannot light this".to_owned(), String::new()],
        };
        [self.method.to_owned(), self.preset.to_owned(), median, least]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_is_measured() {
        let mut benchmark = Benchmark::default();
        assert!(!benchmark.is_on() && benchmark.settings().is_none());
        benchmark.begin(&Settings::default(), "a room".to_owned());
        let mut frames = 0;
        while let Some(settings) = benchmark.settings() {
            match settings.method() {
                Method::Polar => benchmark.refused(),
                // The first frames take ten times as long and do not count.
                _ => {
                    let ms = if benchmark.frames < WARM_UP { 30 } else { 3 };
                    benchmark.lit(&[("light", Duration::from_millis(ms))], 0.01);
                }
            }
            frames += 1;
            assert!(frames < 10_000, "it never ends");
        }
        let text = benchmark.markdown();
        let rows: usize = Method::ALL.iter().map(|method| method.presets().len()).sum();
        assert_eq!(text.lines().count(), rows + 4, "{text}");
        assert!(text.contains("| holographic | fast | 3.00 | 3.00 |"), "{text}");
        assert!(text.contains("| polar | default | cannot light this |"), "{text}");
    }
}
