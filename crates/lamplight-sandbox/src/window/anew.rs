//! The GPU that draws the window may be lost: a driver restarts, a laptop changes over to the other one. What
//! is left then is to open another window, which goes on where this one was.

use crate::platform;
use crate::window::light::Backend;
use crate::window::subject::{Choice, Subject};
use anyhow::Result;
use clap::ValueEnum;
use eframe::CreationContext;
use eframe::wgpu::{Device, PollType};
use lamplight::{Display, Settings};
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The GPU that draws the window, which may be lost.
pub struct Guard {
    device: Option<Device>,
    lost: Arc<AtomicBool>,
}

impl Guard {
    pub fn new(context: &CreationContext) -> Self {
        let device = context.wgpu_render_state.as_ref().map(|state| state.device.clone());
        let lost = Arc::new(AtomicBool::new(false));
        if let Some(device) = &device {
            let tell = lost.clone();
            device.set_device_lost_callback(move |_, _| tell.store(true, Ordering::Release));
        }
        Self { device, lost }
    }

    /// Whether it was lost since this was asked last. To be asked before the window is drawn, which would
    /// break without it.
    pub fn take_loss(&self) -> bool {
        if let Some(device) = &self.device {
            // Who asks the device is told what became of it; how this went says nothing more.
            let _ = device.poll(PollType::Poll);
        }
        self.lost.swap(false, Ordering::AcqRel)
    }

    /// Takes the GPU away, as a driver that restarts does: for tests.
    pub fn lose(&self) {
        if let Some(device) = &self.device {
            device.destroy();
        }
    }
}

/// What the new window says.
const WORDS: &str = "The GPU was lost; this window goes on where the other one was.";
/// What a canvas is saved as on the way.
const NAME: &str = "anew";

/// What the new window is told.
pub struct Anew {
    /// Its arguments.
    pub arguments: Vec<String>,
    /// The canvas as a scene, which comes first, and its images; empty for worlds, which begin anew.
    pub files: Vec<platform::File>,
    /// What it does at once, as a script does.
    pub lines: Vec<String>,
}

impl Anew {
    pub fn new(
        (choice, size, seed, backend): (Choice, [u32; 2], u64, Backend),
        subject: &mut Subject,
        settings: &Settings,
        display: Display,
    ) -> Result<Self> {
        let [w, h] = size;
        let arguments = vec![
            format!("--world={}", named(choice)),
            format!("--size={w}x{h}"),
            format!("--seed={seed}"),
            format!("--backend={}", named(backend)),
        ];
        let files = subject.scene(settings, display, NAME)?;
        let mut lines = Vec::new();
        flatten("", &serde_json::to_value(settings)?, &mut lines);
        lines.push(format!("warn {WORDS}"));
        Ok(Self { arguments, files, lines })
    }
}

fn named(value: impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// All settings as lines of a script.
fn flatten(key: &str, value: &Value, lines: &mut Vec<String>) {
    match value {
        Value::Object(table) => {
            for (name, value) in table {
                let dot = if key.is_empty() { "" } else { "." };
                flatten(&format!("{key}{dot}{name}"), value, lines);
            }
        }
        // Not set.
        Value::Null => {}
        _ => lines.push(format!("set {key}={value}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lamplight::{Bounces, Method, SettingsTable};

    #[test]
    fn settings_come_through() {
        for &method in Method::ALL {
            for &preset in method.presets() {
                let mut settings = Settings { method, wall_depth: 2.5, ..Settings::default() };
                settings.bounces = Bounces::Converged;
                settings.lay_preset(preset);
                let mut lines = Vec::new();
                flatten("", &serde_json::to_value(&settings).unwrap(), &mut lines);
                let mut table = SettingsTable::default();
                for line in lines {
                    table.set_from_text(line.strip_prefix("set ").unwrap()).unwrap();
                }
                assert_eq!(table.resolve().unwrap(), settings, "{preset}");
            }
        }
    }
}
