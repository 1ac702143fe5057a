//! What frames take, stage by stage, over the last seconds.

use eframe::egui::{Color32, Id, RichText, Stroke, Ui};
use egui_plot::{Bar, BarChart, Plot};
use std::collections::VecDeque;
use std::time::Duration;

/// Frames that are remembered.
const FRAMES: usize = 120;

/// Stages of the last frames, and how fast frames follow each other.
#[derive(Default)]
pub struct Timings {
    frames: VecDeque<Vec<(&'static str, Duration)>>,
    /// Seconds from frame to frame, a running mean.
    pace: f64,
}

impl Timings {
    /// Remembers a frame, so many seconds after the one before.
    pub fn push(&mut self, stages: &[(&'static str, Duration)], seconds: f64) {
        // What is dropped gives its room to what comes.
        let mut room = if self.frames.len() < FRAMES {
            Vec::new()
        } else {
            self.frames.pop_front().unwrap_or_default()
        };
        room.clear();
        room.extend_from_slice(stages);
        self.frames.push_back(room);
        self.pace =
            if self.pace == 0.0 { seconds } else { self.pace + 0.05 * (seconds - self.pace) };
    }

    pub fn frames_a_second(&self) -> f64 {
        if self.pace > 0.0 { 1.0 / self.pace } else { 0.0 }
    }

    /// Milliseconds of the last frame's light.
    pub fn last(&self) -> f64 {
        self.frames.back().map_or(0.0, |stages| stages.iter().map(|(_, time)| ms(*time)).sum())
    }

    /// Stacked, the newest at the right.
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
                .id(Id::new(name))
                .color(color)
                .stack_on(&below);
            charts.push(chart);
        }
        ui.horizontal_wrapped(|ui| {
            for (number, name) in names.iter().enumerate() {
                ui.label(RichText::new(format!("■ {name}")).small().color(color(number)));
            }
        });
        Plot::new("timings")
            .height(140.0)
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
            .show(ui, |plot| charts.into_iter().for_each(|chart| plot.bar_chart(chart)));
    }
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// Well apart on dark ground, and for most eyes (Okabe, Ito 2008).
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
