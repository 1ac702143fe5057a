//! The light of a scene, and how it was found.

use crate::args::Renderer;
use crate::device_info::DeviceInfo;
use lamplight::Light;
use serde_json::{Map, Value};
use std::time::Duration;

/// The light of a scene, and how it was found.
pub struct Lit {
    pub light: Light,
    pub renderer: Renderer,
    pub device: DeviceInfo,
    /// The time of each stage, summed over the frames.
    pub stages: Vec<(&'static str, Duration)>,
    /// The time of all.
    pub total: Duration,
    /// The number of frames solved.
    pub frames: u32,
    /// The settings, for `--json`.
    pub settings: Value,
}

impl Lit {
    /// Milliseconds by stage, for `--json`.
    pub fn stages_json(&self) -> Map<String, Value> {
        self.stages.iter().map(|&(name, time)| (name.to_owned(), ms(time).into())).collect()
    }
}

/// A time in milliseconds, to the microsecond.
pub fn ms(time: Duration) -> f64 {
    time.as_micros() as f64 / 1000.0
}
