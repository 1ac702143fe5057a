//! The programs that run on the GPU: per shader its entry points, and the resource of each slot.
//!
//! Bind-group layouts are made from these declarations, and a test compares them with the shaders.

use wgpu::{
    BindGroupLayoutEntry, BindingType, BufferBindingType, ShaderStages, StorageTextureAccess,
    TextureFormat, TextureSampleType, TextureViewDimension,
};

/// A resource that is bound to a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// A uniform buffer.
    Uniform,
    /// An entry of a uniform buffer, selected by each dispatch.
    Step,
    /// A texture that is read texel by texel.
    Texture,
    /// A texture of half floats that is written.
    Output,
    /// A texture of floats that is written.
    Floats,
    /// A storage buffer that is read.
    Read,
    /// A storage buffer that is read and written.
    Write,
}

impl Binding {
    /// Returns whether shaders write to it.
    pub fn is_written(self) -> bool {
        matches!(self, Self::Output | Self::Floats | Self::Write)
    }

    /// The entry of a bind-group layout.
    pub fn entry(self, slot: u32, visibility: ShaderStages) -> BindGroupLayoutEntry {
        let buffer = |ty, has_dynamic_offset| BindingType::Buffer {
            ty,
            has_dynamic_offset,
            min_binding_size: None,
        };
        let written = |format| BindingType::StorageTexture {
            access: StorageTextureAccess::WriteOnly,
            format,
            view_dimension: TextureViewDimension::D2,
        };
        let ty = match self {
            Self::Uniform => buffer(BufferBindingType::Uniform, false),
            Self::Step => buffer(BufferBindingType::Uniform, true),
            Self::Read => buffer(BufferBindingType::Storage { read_only: true }, false),
            Self::Write => buffer(BufferBindingType::Storage { read_only: false }, false),
            Self::Output => written(TextureFormat::Rgba16Float),
            Self::Floats => written(TextureFormat::Rgba32Float),
            Self::Texture => BindingType::Texture {
                sample_type: TextureSampleType::Float { filterable: false },
                view_dimension: TextureViewDimension::D2,
                multisampled: false,
            },
        };
        BindGroupLayoutEntry { binding: slot, visibility, ty, count: None }
    }
}

/// Entry points of a shader that share their bindings.
#[derive(Clone, Copy, Debug)]
pub struct Program {
    /// The shader's path.
    pub shader: &'static str,
    pub entries: &'static [&'static str],
    /// The variable of each slot, from 0 on, and its resource.
    pub bindings: &'static [(&'static str, Binding)],
}

impl Program {
    /// Returns whether the program writes all workgroup memory before it reads it (a test poisons it), so that it
    /// need not be cleared. On Metal and DirectX a single thread of each workgroup would do that.
    pub fn writes_first(&self) -> bool {
        [&HOLOGRAPHIC_TRACE, &HOLOGRAPHIC_EXTEND, &HOLOGRAPHIC_MERGE, &HOLOGRAPHIC_GATHER, &WALLS]
            .iter()
            .any(|program| program.shader == self.shader)
    }
}

/// Declares programs. Slot 0 of each is `frame`; the others follow in order.
macro_rules! programs {
    ($($name:ident: $shader:literal, $entries:expr, { $($variable:ident: $binding:ident),* $(,)? })*) => {
        $(pub const $name: Program = Program {
            shader: $shader,
            entries: &$entries,
            bindings: &[
                ("frame", Binding::Uniform),
                $((stringify!($variable), Binding::$binding)),*
            ],
        };)*

        /// All programs.
        pub const ALL: &[Program] = &[$($name),*];
    };
}

programs! {
    SEED: "stages/seed", ["main"], { matter: Texture, seeds: Write }
    JUMP_FLOOD: "stages/jump_flood", ["main"], { step: Step, before: Read, nearest: Write }
    DISTANCE: "stages/distance", ["main"], { nearest: Read, distance: Write }
    MEDIUM_GRID: "stages/medium_grid", ["main", "light_media"], {
        emission: Texture, matter: Texture, source: Write, extinction: Write, scattered: Read,
        albedo: Texture,
    }
    MATTER_VALUES: "stages/matter_values", ["cover", "values"], {
        emission: Texture, matter: Texture, albedo: Texture, glow: Texture, masks: Texture,
    }
    CLASS: "stages/class", ["main"], { matter: Texture, classes: Write, used: Write }
    DIRECT: "stages/direct", ["shine_lamps", "shine_suns"], {
        lamps: Read, matter: Texture, classes: Read, suns: Read, found: Write, masks: Texture,
        cookies: Texture,
    }
    ADD_DIRECT: "stages/add_direct", ["add", "scatter"], {
        found: Read, albedo: Texture, light: Write,
    }
    SIGHT: "stages/sight", ["main"], {
        sights: Read, matter: Texture, classes: Read, visibility: Write,
    }
    GRADIENT_MOMENT: "stages/gradient_moment", ["main"], { matter: Texture, light: Write }
    EMPTY_SPACE: "stages/empty_space", ["begin", "double", "finish"], {
        step: Step, source: Read, extinction: Read, before: Read, after: Write,
    }
    INVALIDATE: "stages/invalidate", ["begin", "main"], {
        emission: Texture, matter: Texture, albedo: Texture, hashes: Write, extinction: Write,
        any_changed: Write,
    }
    FEEDBACK: "stages/feedback", ["main"], {
        albedo: Texture, source: Read, before: Read, scattered: Write,
    }
    GLOW: "stages/glow", ["main"], {
        emission: Texture, matter: Texture, albedo: Texture, glow: Texture, media_emission: Floats,
        media_matter: Floats, media_albedo: Floats,
    }
    COMPARE: "stages/compare", ["main"], {
        step: Step, next: Read, scattered: Write, changes: Write,
    }
    CONVERGENCE: "stages/convergence", ["begin", "decide"], {
        changes: Read, table: Read, groups: Write,
    }
    TEMPORAL: "stages/temporal", ["spread", "accumulate"], {
        light: Write, traced: Write, history: Write, rejected: Write, columns: Write,
        any_changed: Read, history_x: Write, history_y: Write,
    }
    DENOISE: "stages/denoise", ["begin", "blur", "finish"], {
        step: Step, matter: Texture, near: Read, traced: Read, before: Read, after: Write,
        light: Write,
    }
    WALLS: "stages/walls",
    ["show_faces", "blur_surface", "blur", "sink", "turn_faces"], {
        matter: Texture, step: Step, emission: Texture, surface: Write, irradiance: Write,
        sunk_emission: Write, light: Write, cell_flags: Write,
    }
    REPROJECT: "stages/reproject", ["aside", "back"], { words: Step, before: Read, after: Write }
    OUTPUT: "stages/output", ["main"], { light: Read, picture: Output }
    DISPLAY: "stages/display", ["cover", "show"], {
        params: Uniform, light: Read, emission: Texture, matter: Texture, color: Texture,
        color_emission: Texture, more: Texture, shown: Texture, normals: Texture,
    }
    DISPLAY_TEXTURE: "stages/display_texture", ["cover", "show"], {
        params: Uniform, light: Texture, emission: Texture, matter: Texture, color: Texture,
        color_emission: Texture, more: Texture, shown: Texture, normals: Texture,
    }

    RAYMARCH: "methods/raymarch/march", ["main", "receive"], {
        blue: Read, directions: Read, source: Read, extinction: Read, squares: Read,
        scattered: Read, step: Step, albedo: Texture, light: Write, traced: Write,
        panorama: Texture,
    }
    RAYMARCH_DISTANCE: "methods/raymarch/march_distance", ["main", "receive"], {
        blue: Read, directions: Read, source: Read, nearest: Read, distance: Read,
        scattered: Read, step: Step, albedo: Texture, light: Write, traced: Write,
        panorama: Texture,
    }

    CASCADES_MERGE: "methods/cascades/merge", ["main"], {
        paths: Read, far: Read, source: Read, extinction: Read, squares: Read, scattered: Read,
        step: Uniform, layer: Step, near: Write, panorama: Texture,
    }
    CASCADES_GATHER: "methods/cascades/gather", ["main", "receive"], {
        paths: Read, far: Read, source: Read, extinction: Read, squares: Read, scattered: Read,
        step: Uniform, layer: Step, light: Write, panorama: Texture, albedo: Texture,
        cosines: Read,
    }

    FLOOD_RAYS: "methods/flood/rays", ["lamp_rays", "matter_rays", "sky_rays"], {
        lamps: Read, matter: Texture, classes: Read, emission: Texture, albedo: Texture,
        directions: Read, cells: Write, panorama: Texture,
    }
    FLOOD_BLUR: "methods/flood/blur", ["decay", "mix_neighbours", "show"], {
        step: Step, before: Read, classes: Read, after: Write, light: Write,
    }

    POLAR_SHADOW_MAP: "methods/polar/shadow_map", ["main"], {
        lamps: Read, matter: Texture, classes: Read, distance_field: Read, hits: Write,
        curves: Write, corners: Write, used: Write,
    }
    POLAR_SHADOW_BOUNDS: "methods/polar/shadow_bounds", ["main"], {
        lamps: Read, hits: Read, classes: Read, bounds: Write,
    }
    POLAR_GATHER: "methods/polar/gather", ["main"], {
        lamps: Read, matter: Texture, classes: Read, distance_field: Read, bounds: Read,
        curves: Read, corners: Read, used: Read, light: Write, masks: Texture,
        cookies: Texture,
    }

    HOLOGRAPHIC_SLABS: "methods/holographic/slabs", ["main"], {
        sweeps: Step, emission: Texture, matter: Texture, scattered: Read, cell_bits: Write,
        irradiance: Write,
    }
    HOLOGRAPHIC_TRACE: "methods/holographic/trace", ["main"], {
        sweeps: Step, footprints: Read, cell_bits: Read, emission: Texture, matter: Texture,
        scattered: Read, made: Write, made_tints: Write,
    }
    HOLOGRAPHIC_EXTEND: "methods/holographic/extend", ["main"], {
        sweeps: Step, intervals: Read, tints: Read, made: Write, made_tints: Write,
    }
    HOLOGRAPHIC_MERGE: "methods/holographic/merge", ["main", "once"], {
        sweeps: Step, cones: Read, intervals: Read, tints: Read, radiance: Write,
        panorama: Texture,
    }
    HOLOGRAPHIC_FINISH: "methods/holographic/merge", ["finish"], {
        sweeps: Step, cones: Read, intervals: Read, tints: Read, radiance: Write,
        panorama: Texture, shown_odd: Write, shown_even: Write,
    }
    HOLOGRAPHIC_GATHER: "methods/holographic/gather", ["main"], {
        sweeps: Step, footprints: Read, cell_bits: Read, emission: Texture, matter: Texture,
        scattered: Read, cones: Read, shown_odd: Read, shown_even: Read, light: Write,
        irradiance: Write, albedo: Texture, panorama: Texture,
    }
    HOLOGRAPHIC_FACES: "methods/holographic/faces", ["scatter", "show"], {
        matter: Texture, albedo: Texture, irradiance: Read, direct: Read, scattered: Write,
        light: Write, cell_bits: Read,
    }
    HOLOGRAPHIC_FACES_COMPARED: "methods/holographic/faces", ["scatter_compared"], {
        matter: Texture, albedo: Texture, irradiance: Read, direct: Read, scattered: Write,
        light: Write, cell_bits: Read, changes: Write, step: Step,
    }
    HOLOGRAPHIC_FEEDBACK: "methods/holographic/feedback", ["main"], {
        matter: Texture, albedo: Texture, scattered: Write,
    }

    PAPER_SOURCE: "methods/holographic/paper/source", ["main", "bounce"], {
        emission: Texture, albedo: Texture, matter: Texture, light: Read, source: Write,
    }
    PAPER_SOURCE_COMPARED: "methods/holographic/paper/source", ["bounce_compared"], {
        emission: Texture, albedo: Texture, matter: Texture, light: Read, source: Write,
        changes: Write,
    }
    PAPER_TRACE: "methods/holographic/paper/trace", ["main"], {
        sweep: Step, made: Write, source: Read, matter: Texture, footprints: Read,
    }
    PAPER_EXTEND: "methods/holographic/paper/extend", ["main"], {
        sweep: Step, made: Write, shorter: Read,
    }
    PAPER_MERGE: "methods/holographic/paper/merge", ["main", "last"], {
        sweep: Step, made: Write, near: Read, longer: Read, above: Read, cones: Read,
    }
    PAPER_GATHER: "methods/holographic/paper/gather", ["main"], {
        matter: Texture, total: Read, light: Write,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shaders;
    use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
    use naga::{
        AddressSpace, GlobalVariable, ImageClass, Module, StorageAccess, StorageFormat, TypeInner,
    };

    /// The resource that a variable of a shader stands for. A step is a uniform in the shader.
    fn kind(module: &Module, variable: &GlobalVariable) -> Option<Binding> {
        match (variable.space, &module.types[variable.ty].inner) {
            (AddressSpace::Uniform, _) => Some(Binding::Uniform),
            (AddressSpace::Storage { access }, _) if access.contains(StorageAccess::STORE) => {
                Some(Binding::Write)
            }
            (AddressSpace::Storage { .. }, _) => Some(Binding::Read),
            (_, TypeInner::Image { class: ImageClass::Storage { format, .. }, .. }) => match format
            {
                StorageFormat::Rgba32Float => Some(Binding::Floats),
                _ => Some(Binding::Output),
            },
            (_, TypeInner::Image { class: ImageClass::Sampled { .. }, .. }) => {
                Some(Binding::Texture)
            }
            _ => None,
        }
    }

    fn parsed(shader: &str) -> (Module, ModuleInfo) {
        let module = naga::front::wgsl::parse_str(&shaders::text(shader)).unwrap();
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        let info = validator.validate(&module).unwrap();
        (module, info)
    }

    /// The differences between a declaration and its shader.
    fn differences(program: &Program) -> Vec<String> {
        let (module, info) = parsed(program.shader);
        let mut found = Vec::new();
        for &entry in program.entries {
            let Some(i) = module.entry_points.iter().position(|e| e.name == entry) else {
                found.push(format!("no entry point `{entry}`"));
                continue;
            };
            for (handle, variable) in module.global_variables.iter() {
                let Some(binding) = &variable.binding else { continue };
                let declared =
                    binding.group == 0 && (binding.binding as usize) < program.bindings.len();
                if !declared && !info.get_entry_point(i)[handle].is_empty() {
                    let name = variable.name.as_deref().unwrap_or_default();
                    found.push(format!("`{entry}` uses `{name}`, which is not declared"));
                }
            }
        }
        for (slot, &(name, binding)) in (0u32..).zip(program.bindings) {
            let read = module.global_variables.iter().find_map(|(_, variable)| {
                let at = variable.binding.as_ref()?;
                let name = variable.name.as_deref()?;
                (at.group == 0 && at.binding == slot).then(|| (name, kind(&module, variable)))
            });
            let declared = if binding == Binding::Step { Binding::Uniform } else { binding };
            if read != Some((name, Some(declared))) {
                found.push(format!("slot {slot} is `{name}: {binding:?}`, in the shader {read:?}"));
            }
        }
        found
    }

    #[test]
    fn every_binding_is_that_of_the_shader() {
        for program in ALL {
            assert_eq!(differences(program), [""; 0], "{}", program.shader);
        }
    }

    #[test]
    fn every_entry_point_belongs_to_a_program() {
        for program in ALL {
            let (module, _) = parsed(program.shader);
            for entry in &module.entry_points {
                let mut all = ALL.iter().filter(|other| other.shader == program.shader);
                let known = all.any(|other| other.entries.contains(&entry.name.as_str()));
                assert!(known, "{} of {}", entry.name, program.shader);
            }
        }
    }

    #[test]
    fn a_wrong_slot_is_named() {
        const FRAME: (&str, Binding) = ("frame", Binding::Uniform);
        let bindings = &[FRAME, ("seeds", Binding::Write), ("matter", Binding::Texture)];
        let found = differences(&Program { bindings, ..SEED });
        assert_eq!(found.len(), 2);
        assert!(found[0].starts_with("slot 1 is `seeds: Write`, in the shader"), "{found:?}");
        let found = differences(&Program { bindings: &[FRAME], ..SEED });
        assert_eq!(found.len(), 2);
        assert!(found[0].contains("`main` uses `"), "{found:?}");
        let bindings = &[FRAME, ("matter", Binding::Texture), ("seeds", Binding::Read)];
        assert_eq!(differences(&Program { bindings, ..SEED }).len(), 1);
        let found = differences(&Program { entries: &["begin"], ..SEED });
        assert_eq!(found, ["no entry point `begin`"]);
    }
}
