//! The stand-in for `gpu` in a build without the feature: there is never a GPU.

use crate::args::Backend;
use crate::device_info::{AdapterInfo, DeviceInfo};
use crate::error::{CliError, Result};
use crate::frame_cost::FrameCost;
use crate::lit::Lit;
use crate::stage::Fields;
use lamplight::{Cells, Light, Method, Settings};
use std::convert::Infallible;
use std::marker::PhantomData;
use std::time::Duration;

pub use self::{NoFrames as GpuFrames, NoGpu as Gpu};

/// An open device: none can be made.
pub struct NoGpu(Infallible);

impl NoGpu {
    /// The GPU to light scenes on, or none if the CPU does.
    pub fn choose(backend: Backend) -> Result<Option<Self>> {
        match backend {
            Backend::Cpu | Backend::Auto => Ok(None),
            Backend::Gpu => Self::open().map(Some),
        }
    }

    /// The error that this build has none.
    pub fn open() -> Result<Self> {
        Err(CliError::failed("this build of lamplight has no GPU support").hint(
            "`cargo install lamplight-cli` builds the command with it; --backend cpu needs none",
        ))
    }

    pub fn name(&self) -> &str {
        match self.0 {}
    }

    pub fn device_info(&self) -> DeviceInfo {
        match self.0 {}
    }

    pub fn frames<'a>(&'a self, _: &'a Cells, _: Settings) -> Result<(NoFrames<'a>, FrameCost)> {
        match self.0 {}
    }

    pub fn solve(&self, _: &Cells, _: Settings, _: u32) -> Result<Lit> {
        match self.0 {}
    }

    pub fn fields(&self, _: &Cells, _: Settings) -> Result<Fields> {
        match self.0 {}
    }
}

/// Frames of the same cells on it.
pub struct NoFrames<'a>(Infallible, PhantomData<&'a NoGpu>);

impl NoFrames<'_> {
    pub fn next(&mut self) -> Result<Vec<(&'static str, Duration)>> {
        match self.0 {}
    }

    pub fn again(&mut self) -> Result<Vec<(&'static str, Duration)>> {
        match self.0 {}
    }

    pub fn light(&self) -> Result<Light> {
        match self.0 {}
    }
}

/// The methods that it runs.
pub const METHODS: &[Method] = &[];

/// All GPUs.
pub fn adapters() -> Vec<AdapterInfo> {
    Vec::new()
}
