//! Loss of the GPU that draws the window, as when a driver restarts or a laptop switches GPUs. Then another
//! window opens and continues where this one was.

use crate::platform::Handover;
use crate::window::former::Former;
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

/// Detects the loss of the GPU that draws the window.
pub struct GpuGuard {
    device: Option<Device>,
    lost: Arc<AtomicBool>,
}

impl GpuGuard {
    pub fn new(context: &CreationContext) -> Self {
        let device = context.wgpu_render_state.as_ref().map(|state| state.device.clone());
        let lost = Arc::new(AtomicBool::new(false));
        if let Some(device) = &device {
            let tell = lost.clone();
            device.set_device_lost_callback(move |_, _| tell.store(true, Ordering::Release));
        }
        Self { device, lost }
    }

    /// Returns whether the GPU was lost since the last call. Call it before the window is drawn, which fails
    /// without a GPU.
    pub fn take_loss(&self) -> bool {
        if let Some(device) = &self.device {
            // Polling runs the callback; its own result is irrelevant.
            let _ = device.poll(PollType::Poll);
        }
        self.lost.swap(false, Ordering::AcqRel)
    }

    /// Destroys the device, for tests.
    pub fn lose(&self) {
        if let Some(device) = &self.device {
            device.destroy();
        }
    }
}

/// The message of the new window.
const MESSAGE: &str = "The GPU was lost; this window goes on where the other one was.";
/// The name of the files of a canvas.
const NAME: &str = "handover";

/// The state that the new window restores.
pub fn handover(
    (choice, size, seed, backend): (Choice, [u32; 2], u64, Backend),
    subject: &mut Subject,
    former: &Former,
    settings: &Settings,
    display: Display,
) -> Result<Handover> {
    let [w, h] = size;
    let arguments = vec![
        format!("--world={}", named(choice)),
        format!("--size={w}x{h}"),
        format!("--seed={seed}"),
        format!("--backend={}", named(backend)),
    ];
    let mut files = subject.scene(settings, display, NAME)?;
    let mut lines = Vec::new();
    if let Subject::World(_) = subject {
        // Opened first, so that it is the former canvas there, too.
        files = former.scene(NAME)?;
        lines.push(format!("world {}", named(choice)));
    }
    flatten("", &serde_json::to_value(settings)?, &mut lines);
    lines.push(format!("warn {MESSAGE}"));
    Ok(Handover { arguments, files, lines })
}

fn named(value: impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// Converts all settings to lines of a script.
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
    fn settings_survive_a_handover() {
        for &method in Method::ALL {
            for &preset in method.presets() {
                let mut settings = Settings { wall_depth: 2.5, ..Settings::new(method) };
                settings.bounces = Bounces::Converged;
                settings.set_preset(preset).unwrap();
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
