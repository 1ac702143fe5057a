//! What a device has to be made with.

use wgpu::{Adapter, Features, Limits};

/// How much is asked of a device, least first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tier {
    /// What WebGPU grants everywhere: no features, its default limits. Grids of up to 8192 px a side
    /// and 2²³ cells (for methods with four floats a cell).
    #[default]
    Web,
    /// Grids as large as the adapter can hold; workgroups with as much memory as it has, which save
    /// `holographic` some work (9 to 24 % on a software GPU) and change no bit of the light; times of
    /// stages ([`crate::Timer`]) where it can tell them.
    ///
    /// Not half floats: what is stored is packed tighter already, and light at 65504 and more, or a
    /// thousandth of what is beside it, is no rare thing. Not subgroups: no kernel hands more from thread to
    /// thread than a bit.
    Native,
}

/// Features to request of an adapter; every method and stage runs without any.
pub fn required_features(tier: Tier, adapter: &Adapter) -> Features {
    match tier {
        Tier::Web => Features::empty(),
        Tier::Native => adapter.features() & Features::TIMESTAMP_QUERY,
    }
}

/// Limits to request of an adapter.
pub fn required_limits(tier: Tier, adapter: &Adapter) -> Limits {
    let granted = Limits::default();
    let most = adapter.limits();
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
