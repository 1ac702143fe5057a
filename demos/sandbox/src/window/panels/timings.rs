//! A chart of the times of recent frames, by stage.

use eframe::egui::{Color32, RichText, Stroke, Ui};
use egui_plot::{Bar, BarChart, HLine, Line, Plot, PlotPoints};
use lamplight_sandbox::pace::FRAME;
use std::collections::VecDeque;
use std::time::Duration;

/// Frames in the chart.
const FRAMES: usize = 120;

/// Times of recent frames.
#[derive(Default)]
pub struct Timings {
    frames: VecDeque<Vec<(&'static str, Duration)>>,
    /// ms between frames.
    pace: VecDeque<f64>,
}

impl Timings {
    /// Adds a frame that came `seconds` after the previous one.
    pub fn push(&mut self, stages: &[(&'static str, Duration)], seconds: f64) {
        // The new frame reuses the allocation of the dropped one.
        let mut room = if self.frames.len() < FRAMES {
            Vec::new()
        } else {
            self.frames.pop_front().unwrap_or_default()
        };
        room.clear();
        room.extend_from_slice(stages);
        self.frames.push_back(room);
        if self.pace.len() == FRAMES {
            self.pace.pop_front();
        }
        self.pace.push_back(1e3 * seconds);
    }

    pub fn frames_per_second(&self) -> f64 {
        let sum: f64 = self.pace.iter().sum();
        if sum > 0.0 { 1e3 * self.pace.len() as f64 / sum } else { 0.0 }
    }

    /// Seconds of light in the last frame, if known.
    pub fn light(&self) -> Option<f64> {
        let stages = self.frames.back().filter(|stages| !stages.is_empty())?;
        Some(stages.iter().map(|(_, time)| time.as_secs_f64()).sum())
    }

    /// Shows stacked bars, the newest at the right.
    pub fn show(&self, ui: &mut Ui) {
        let mut names: Vec<&'static str> = Vec::new();
        for (name, _) in self.frames.iter().flatten() {
            if !names.contains(name) {
                names.push(name);
            }
        }
        let mut charts: Vec<BarChart> = Vec::new();
        for (number, name) in names.iter().enumerate() {
            let bars = self.frames.iter().enumerate().map(|(frame, stages)| {
                let time =
                    stages.iter().find(|(stage, _)| stage == name).map_or(0.0, |(_, t)| ms(*t));
                Bar::new(frame as f64, time).width(1.0).stroke(Stroke::NONE)
            });
            let below: Vec<&BarChart> = charts.iter().collect();
            let color = color(number);
            let chart = BarChart::new(*name, bars.map(|bar| bar.fill(color)).collect())
                .id(name)
                .color(color)
                .stack_on(&below);
            charts.push(chart);
        }
        ui.horizontal_wrapped(|ui| {
            for (number, name) in names.iter().enumerate() {
                ui.label(RichText::new(*name).small().color(color(number)));
            }
        });
        history("timings", 140.0)
            .show(ui, |plot| charts.into_iter().for_each(|chart| plot.bar_chart(chart)));
        let slowest = self.pace.iter().copied().fold(0.0, f64::max);
        ui.small(format!("between frames, at most {slowest:.0} ms; the line is 1/60 s"));
        history("pace", 70.0).show(ui, |plot| {
            let points = self.pace.iter().enumerate().map(|(i, &ms)| [i as f64, ms]);
            plot.line(Line::new("ms", points.collect::<PlotPoints>()).color(color(1)));
            plot.hline(HLine::new("1/60 s", 1e3 * FRAME).color(Color32::GRAY));
        });
    }
}

/// A fixed plot of recent frames.
fn history(name: &str, height: f32) -> Plot<'_> {
    Plot::new(name)
        .height(height)
        .show_x(false)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_axes([false, true])
        .include_y(0.0)
        .include_x(0.0)
        .include_x(FRAMES as f64)
        .y_axis_label("ms")
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// A palette that is distinct for colour-blind people, too (Okabe, Ito 2008).
fn color(number: usize) -> Color32 {
    const COLORS: [[u8; 3]; 7] = [
        [230, 159, 0],
        [86, 180, 233],
        [0, 158, 115],
        [240, 228, 66],
        [0, 114, 178],
        [213, 94, 0],
        [204, 121, 167],
    ];
    let [r, g, b] = COLORS[number % COLORS.len()];
    Color32::from_rgb(r, g, b)
}
