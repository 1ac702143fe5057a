//! The window: what stands in it, and what a person does to it.

mod app;
mod benchmark;
mod files;
mod halves;
mod inspect;
mod light;
mod panels;
mod probe;
mod resolution;
mod saving;
mod script;
mod subject;
mod view;

use anyhow::Context;
use app::App;
use clap::Parser;
use eframe::egui::ViewportBuilder;
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use eframe::wgpu::DeviceDescriptor;
use lamplight_wgpu::{Tier, required_features, required_limits};
use light::Backend;
use std::path::PathBuf;
use std::sync::Arc;
use subject::Choice;

/// Paint with light, and play in worlds that are lit as they move
#[derive(Parser, Debug)]
#[command(version)]
pub struct Args {
    /// What to begin with
    #[arg(long, value_enum, default_value_t)]
    world: Choice,
    /// Columns and rows of cells, such as 320x180
    #[arg(long, value_name = "WxH", default_value = "320x180", value_parser = size)]
    size: [u32; 2],
    /// Seed of everything random in a world
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Where to find light; auto: on a hardware GPU where there is one, else on the CPU
    #[arg(long, value_enum, default_value_t)]
    backend: Backend,
    /// Play what a file says instead of waiting for a person (`docs/sandbox.md`), then close
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides.ok_or_else(|| "two whole numbers with an x between, such as 320x180".to_owned())
}

/// Opens the window; comes back when it is closed.
pub fn open(args: Args) -> anyhow::Result<()> {
    let script = args.script.as_deref().map(script::Script::open).transpose()?;
    let options = eframe::NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("lamplight sandbox")
            .with_inner_size([1480.0, 810.0])
            .with_min_inner_size([480.0, 320.0]),
        wgpu_options: WgpuConfiguration {
            wgpu_setup: WgpuSetup::CreateNew(device()),
            ..WgpuConfiguration::default()
        },
        ..eframe::NativeOptions::default()
    };
    let begin =
        move |context: &eframe::CreationContext| -> eframe::Result<Box<dyn eframe::App>, _> {
            Ok(Box::new(App::new(context, &args, script)?) as Box<dyn eframe::App>)
        };
    eframe::run_native("lamplight-sandbox", options, Box::new(begin))
        .map_err(|e| anyhow::anyhow!("{e}"))
        .context("the window cannot be opened")
}

/// What the light asks of the device that the window is drawn with.
fn device() -> WgpuSetupCreateNew {
    WgpuSetupCreateNew {
        device_descriptor: Arc::new(|adapter| DeviceDescriptor {
            label: Some("lamplight sandbox"),
            required_features: required_features(Tier::Native, adapter),
            required_limits: required_limits(Tier::Native, adapter),
            ..DeviceDescriptor::default()
        }),
        ..WgpuSetupCreateNew::without_display_handle()
    }
}
