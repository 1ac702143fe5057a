//! Programs in SPIR-V, for engines that take no WGSL.

use crate::frame_plan::PlannedProgram;
use naga::ShaderStage;
use naga::back::pipeline_constants::process_overrides;
use naga::back::spv;
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// The reason why a program cannot be translated, which is a fault of this crate.
#[derive(Debug, thiserror::Error)]
#[error("{shader}: {why}")]
pub struct SpirvError {
    shader: &'static str,
    why: String,
}

impl PlannedProgram {
    /// Translates the program to SPIR-V 1.3, the version of Vulkan 1.1, with its constants in place and the entry
    /// point's own name. Slots are bindings of descriptor set 0. Accesses beyond the end of a resource are brought into
    /// it, as in WGSL.
    ///
    /// # Errors
    /// If the program is not valid, which is a fault of this crate.
    pub fn spirv(&self) -> Result<Vec<u32>, SpirvError> {
        let failed = |why: String| SpirvError { shader: self.shader, why };
        let module = naga::front::wgsl::parse_str(&self.wgsl)
            .map_err(|error| failed(error.emit_to_string(&self.wgsl)))?;
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        let info = validator.validate(&module).map_err(|error| failed(error.to_string()))?;
        let entry = (ShaderStage::Compute, self.entry);
        let constants = self.constants.iter().cloned().collect();
        let (module, info) = process_overrides(&module, &info, Some(entry), &constants)
            .map_err(|error| failed(error.to_string()))?;
        let restrict = BoundsCheckPolicy::Restrict;
        let options = spv::Options {
            lang_version: (1, 3),
            flags: spv::WriterFlags::empty(),
            bounds_check_policies: BoundsCheckPolicies {
                index: restrict,
                buffer: restrict,
                image_load: restrict,
                binding_array: BoundsCheckPolicy::Unchecked,
            },
            zero_initialize_workgroup_memory: if self.clears_workgroup_memory {
                spv::ZeroInitializeWorkgroupMemoryMode::Polyfill
            } else {
                spv::ZeroInitializeWorkgroupMemoryMode::None
            },
            // Loops end (shader_module.rs).
            force_loop_bounding: false,
            ..spv::Options::default()
        };
        let pipeline = spv::PipelineOptions {
            shader_stage: ShaderStage::Compute,
            entry_point: self.entry.to_owned(),
        };
        spv::write_vec(&module, &info, &options, Some(&pipeline))
            .map_err(|error| failed(error.to_string()))
    }
}
