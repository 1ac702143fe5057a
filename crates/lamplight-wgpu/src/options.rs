//! Options that affect performance, never the result.

use crate::error::CreateError;
use crate::tier::has_compute;
use wgpu::{Device, DeviceType};

/// The finder of light of [`crate::Lighting`]: with each, the host gets the same light in the same way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Backend {
    /// The CPU if the device is software, such as llvmpipe, SwiftShader or WARP; else [`Self::Fastest`].
    #[default]
    Auto,
    /// The GPU at first, and then the faster one. If the first frames take the GPU more than 8 ms, six frames are found on
    /// the CPU too, which may stall them, and it goes on alone if it takes less than half of the time. The light stays the
    /// same. Without timestamps ([`crate::required_features`]), or in browsers, the GPU stays.
    /// [`crate::Lighting::backend`] returns the present one.
    Fastest,
    /// Compute shaders on the device.
    Gpu,
    /// [`lamplight::Solver`], in [`crate::Lighting::prepare`], which then takes the whole time. It submits and waits for
    /// a copy of the host's textures, as they are at that moment: draw and submit them before, or light is a frame
    /// late. In browsers nothing can wait: the light of textures is that of the last copy that has arrived, moved along
    /// with the grid, a few frames late; it is dark before the first.
    ///
    /// Every backend is this one on a device without compute shaders or storage buffers, as under WebGL 2.
    /// [`crate::Compose`] needs no storage buffers there; [`crate::FrameInput::output`] needs the
    /// usage `COPY_DST` in place of `STORAGE_BINDING`; there is no distance field, and no sight.
    Cpu,
}

impl Backend {
    /// Returns the backend of a device: `Gpu`, `Cpu` or `Fastest`.
    pub(crate) fn on(self, device: &Device) -> Self {
        let software = || device.adapter_info().device_type == DeviceType::Cpu;
        match self {
            _ if !has_compute(device) => Self::Cpu,
            Self::Auto if software() => Self::Cpu,
            Self::Auto | Self::Fastest if cfg!(target_arch = "wasm32") => Self::Gpu,
            Self::Auto => Self::Fastest,
            chosen => chosen,
        }
    }
}

/// Creation options of [`crate::Lighting`]; the default is the fastest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LightingOptions {
    /// The finder of light.
    pub backend: Backend,
    /// `holographic`: levels per dispatch, 1 or 2. With 2, the level between stays in workgroup memory, levels move about
    /// 0.6 times as many bytes, and half as many dispatches are needed; with 1 less is computed. By default 1 on cards
    /// with memory of their own, where it takes 0.9 times as long (NVIDIA H100), and else 2.
    pub fused_levels: Option<u32>,
    /// Pipelines that frames may need after a change of bounces, of inflow, of normals, lamps or viewers are compiled by a
    /// thread in the background, once a frame has been prepared. Otherwise the frame waits that first needs them, on some
    /// drivers for a second. By default on hardware: drivers in software hold megabytes for each pipeline. Not in browsers,
    /// which have no such threads.
    pub compile_ahead: Option<bool>,
}

impl LightingOptions {
    /// The default options with a backend of your choice.
    pub fn on(backend: Backend) -> Self {
        Self { backend, ..Self::default() }
    }

    /// The most levels that fit into 16 KiB of workgroup memory.
    pub const MAX_FUSED_LEVELS: u32 = 2;

    pub(crate) fn check(self) -> Result<(), CreateError> {
        let levels = 1..=Self::MAX_FUSED_LEVELS;
        match self.fused_levels.filter(|count| !levels.contains(count)) {
            None => Ok(()),
            Some(value) => {
                Err(CreateError::Option { name: "fused_levels", value, range: "from 1 to 2" })
            }
        }
    }

    /// Returns whether pipelines are compiled in the background on a device.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn compiles_ahead(self, device: &Device) -> bool {
        let on_hardware = || device.adapter_info().device_type != DeviceType::Cpu;
        self.compile_ahead.unwrap_or_else(on_hardware)
    }

    /// Returns the levels per dispatch, on a card with memory of its own or on another device.
    pub(crate) fn fused_levels(self, is_card: bool) -> u32 {
        self.fused_levels.unwrap_or(if is_card { 1 } else { Self::MAX_FUSED_LEVELS })
    }
}
