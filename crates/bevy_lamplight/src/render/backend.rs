//! The choice between GPU and CPU.

use bevy::prelude::Resource;
use lamplight_wgpu::Backend;

/// The finder of light for all cameras. Insert it before the app runs:
///
/// ```
/// # use bevy::prelude::*; use bevy_lamplight::prelude::*;
/// # fn plugin(app: &mut App) {
/// app.insert_resource(LightBackend::Cpu);
/// # }
/// ```
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LightBackend {
    /// The CPU where the GPU is software, as in virtual machines. Else the GPU, unless the first frames take it more than
    /// 8 ms and the CPU less than half as long. In browsers a GPU of hardware always finds it. Without compute
    /// shaders, as under WebGL 2, the CPU does.
    #[default]
    Auto,
    /// The GPU, whatever it is.
    Gpu,
    /// The CPU. Every frame waits until matter is drawn, and for the light. In browsers, where nothing can wait, light is a
    /// few frames late.
    Cpu,
}

impl From<LightBackend> for Backend {
    fn from(backend: LightBackend) -> Self {
        match backend {
            LightBackend::Auto => Self::Auto,
            LightBackend::Gpu => Self::Gpu,
            LightBackend::Cpu => Self::Cpu,
        }
    }
}
