//! The window: what stands in it, and what a person does to it.

pub mod anew;
mod app;
mod benchmark;
mod files;
mod folded;
mod fonts;
mod halves;
mod inspect;
pub mod light;
mod panels;
mod probe;
mod resolution;
mod saving;
mod script;
mod subject;
mod view;

pub use app::App;
pub use script::Script;

use eframe::egui_wgpu::{WgpuSetup, WgpuSetupCreateNew};
use eframe::wgpu::DeviceDescriptor;
use lamplight_wgpu::{Tier, required_features, required_limits};
use light::Backend;
use std::sync::Arc;
use subject::{Choice, Subject};

/// Columns and rows to begin with.
pub const CELLS: [u32; 2] = [320, 180];

/// How the window begins.
#[derive(clap::Args, Clone, Debug)]
pub struct Start {
    /// What to begin with
    #[arg(long, value_enum, default_value_t)]
    world: Choice,
    /// Columns and rows of cells [default: 320x180; on the CPU of a web page 160x90]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// Seed of everything random in a world
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Where to find light; auto: on a hardware GPU where there is one, else on the CPU
    #[arg(long, value_enum, default_value_t)]
    pub backend: Backend,
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides.ok_or_else(|| "two whole numbers with an x between, such as 320x180".to_owned())
}

/// An error where no window can begin so.
pub fn check(start: &Start) -> anyhow::Result<()> {
    Subject::new(start.world, start.size.unwrap_or(CELLS), start.seed).map(|_| ())
}

/// What the light asks of the device that the window is drawn with.
pub fn device(limits: Tier) -> WgpuSetup {
    WgpuSetup::CreateNew(WgpuSetupCreateNew {
        device_descriptor: Arc::new(move |adapter| DeviceDescriptor {
            label: Some("lamplight sandbox"),
            // More of them only say how long things take.
            required_features: required_features(Tier::Native, adapter),
            required_limits: required_limits(limits, adapter),
            ..DeviceDescriptor::default()
        }),
        ..WgpuSetupCreateNew::without_display_handle()
    })
}

/// What went wrong, and why, each thing once: many errors tell their cause themselves.
pub fn words(why: &anyhow::Error) -> String {
    let mut said = String::new();
    for cause in why.chain().map(ToString::to_string) {
        if !said.contains(&cause) {
            said += if said.is_empty() { "" } else { ": " };
            said += &cause;
        }
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_told_once() {
        let plain = anyhow::anyhow!("no such file")
            .context("cannot read a.png")
            .context("layer: cannot read a.png");
        assert_eq!(words(&plain), "layer: cannot read a.png: no such file");
    }
}
