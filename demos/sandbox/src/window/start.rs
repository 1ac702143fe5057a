//! Start options and the device of the window.

use crate::platform::CELLS;
use crate::window::light::Backend;
use crate::window::subject::{Choice, Subject};
use eframe::egui_wgpu::{WgpuSetup, WgpuSetupCreateNew};
use eframe::wgpu::DeviceDescriptor;
use lamplight_wgpu::{Tier, required_features, required_limits};
use std::sync::Arc;

/// Options with which the window starts.
#[derive(clap::Args, Clone, Debug)]
pub struct Start {
    /// The world to begin with
    #[arg(long, value_enum, default_value_t)]
    pub world: Choice,
    /// Columns and rows of cells [default: 320x180; on the CPU of a web page 160x90]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Seed of everything random in a world
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// The device that computes light; auto: a hardware GPU if there is one, unless the CPU takes less than half of the
    /// time of its first frames
    #[arg(long, value_enum, default_value_t)]
    pub backend: Backend,
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides.ok_or_else(|| "two whole numbers with an x between, such as 320x180".to_owned())
}

/// Fails if the window cannot start with these options.
pub fn check(start: &Start) -> anyhow::Result<()> {
    Subject::new(start.world, start.size.unwrap_or(CELLS), start.seed).map(|_| ())
}

/// The device of the window, with the features and limits that lighting needs.
pub fn device(limits: Tier) -> WgpuSetup {
    WgpuSetup::CreateNew(WgpuSetupCreateNew {
        device_descriptor: Arc::new(move |adapter| DeviceDescriptor {
            label: Some("lamplight sandbox"),
            // Features beyond the tier only enable timestamps.
            required_features: required_features(Tier::Native, adapter),
            required_limits: required_limits(limits, adapter),
            ..DeviceDescriptor::default()
        }),
        ..WgpuSetupCreateNew::without_display_handle()
    })
}
