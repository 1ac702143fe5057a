//! Shader modules without the counters that wgpu adds to loops.

#![allow(unsafe_code)]

use wgpu::{Device, ShaderModule, ShaderModuleDescriptor, ShaderRuntimeChecks, ShaderSource};

/// Every check of what a shader does, except that its loops end.
const CHECKS: ShaderRuntimeChecks =
    ShaderRuntimeChecks { force_loop_bounding: false, ..ShaderRuntimeChecks::checked() };

/// Compiles the text of one of the crate's own shaders. To make sure that loops end, wgpu would count the rounds of each,
/// and drivers then unroll none: on an NVIDIA H200 `holographic` took 14 % longer for that, `flood` 43 %.
pub fn shader_module(device: &Device, label: &'static str, text: String) -> ShaderModule {
    let source = ShaderSource::Wgsl(text.into());
    let descriptor = ShaderModuleDescriptor { label: Some(label), source };
    // SAFETY: all loops of the crate's shaders run over a counted range, clear a bit of a word each round, or end after
    // a number of steps. Memory is checked as ever.
    unsafe { device.create_shader_module_trusted(descriptor, CHECKS) }
}
