//! The features and limits that a device has to be created with.

use wgpu::{Adapter, Device, DownlevelFlags, Features, Limits};

/// Levels of requirements on a device, the lowest first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Tier {
    /// The features and limits that WebGPU grants everywhere: no features, its default limits. Grids of up to 8192 px a side
    /// and 2²³ cells (for methods with four floats per cell).
    #[default]
    Web,
    /// Grids as large as the adapter supports; workgroups with as much memory as it has, which save
    /// `holographic` some work under coloured tint (6 % on a software GPU) and change no bit of the light; times of
    /// stages ([`crate::Timer`]) if it can measure them.
    ///
    /// It does not request half floats: stored values are packed tighter already, and light of 65504 and more,
    /// or of a thousandth of its neighbour, is common. It does not request subgroups: no shader passes more
    /// than a bit from thread to thread.
    Native,
}

/// Returns whether a device has compute shaders with as many storage buffers as every WebGPU device.
pub fn has_compute(device: &Device) -> bool {
    let limits = device.limits();
    let needed = Limits::default().max_storage_buffers_per_shader_stage;
    limits.max_storage_buffers_per_shader_stage >= needed
        && limits.max_compute_workgroups_per_dimension > 0
}

/// Returns the features to request of an adapter. Every method and stage runs without any.
pub fn required_features(tier: Tier, adapter: &Adapter) -> Features {
    match tier {
        Tier::Web => Features::empty(),
        Tier::Native => adapter.features() & Features::TIMESTAMP_QUERY,
    }
}

/// Returns the limits to request of an adapter. On one without compute shaders, as under WebGL 2, the CPU finds the light
/// ([`crate::Backend::Cpu`]).
pub fn required_limits(tier: Tier, adapter: &Adapter) -> Limits {
    let granted = Limits::default();
    let most = adapter.limits();
    let flags = adapter.get_downlevel_capabilities().flags;
    if !flags.contains(DownlevelFlags::COMPUTE_SHADERS) {
        return Limits::downlevel_webgl2_defaults().using_resolution(most);
    }
    match tier {
        Tier::Web => granted,
        Tier::Native => Limits {
            max_texture_dimension_2d: most.max_texture_dimension_2d,
            max_buffer_size: most.max_buffer_size,
            max_storage_buffer_binding_size: most.max_storage_buffer_binding_size,
            max_compute_workgroup_storage_size: most.max_compute_workgroup_storage_size,
            ..granted
        },
    }
}
