//! The shaders: plain WGSL files, put one after the other where they share code.
//!
//! A host that wants its own pipeline can load the same files in the same order.

/// What all of them begin with.
const FRAME: &str = include_str!("../shaders/frame.wgsl");

/// A shader and the files that it consists of.
pub struct Shader {
    pub name: &'static str,
    files: &'static [&'static str],
}

impl Shader {
    /// Its whole text.
    pub fn text(&self) -> String {
        std::iter::once(&FRAME).chain(self.files).copied().collect::<Vec<_>>().join("\n")
    }
}

macro_rules! shader {
    ($name:literal $(, $file:literal)*) => {
        Shader {
            name: $name,
            files: &[
                $(include_str!(concat!("../shaders/", $file, ".wgsl")),)*
                include_str!(concat!("../shaders/", $name, ".wgsl")),
            ],
        }
    };
}

pub const SEED: Shader = shader!("seed");
pub const JUMP_FLOOD: Shader = shader!("jump_flood");
pub const DISTANCE: Shader = shader!("distance");
pub const OPTICS: Shader = shader!("optics");
pub const CLEARANCE: Shader = shader!("clearance");
pub const RAYMARCH: Shader = shader!("raymarch", "noise", "surfaces", "march_edge");
pub const RAYMARCH_DISTANCE: Shader = shader!("raymarch", "noise", "surfaces", "march_distance");
pub const WALLS: Shader = shader!("walls");
pub const OUTPUT: Shader = shader!("output");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Frame;
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    const ALL: [Shader; 9] =
        [SEED, JUMP_FLOOD, DISTANCE, OPTICS, CLEARANCE, RAYMARCH, RAYMARCH_DISTANCE, WALLS, OUTPUT];

    fn parsed(shader: &Shader) -> naga::Module {
        naga::front::wgsl::parse_str(&shader.text())
            .unwrap_or_else(|e| panic!("{}: {}", shader.name, e.emit_to_string(&shader.text())))
    }

    #[test]
    fn every_shader_is_valid_without_any_extension() {
        for shader in &ALL {
            let module = parsed(shader);
            let valid = Validator::new(ValidationFlags::all(), Capabilities::empty())
                .subgroup_stages(naga::valid::ShaderStages::empty())
                .validate(&module);
            assert!(valid.is_ok(), "{}: {:?}", shader.name, valid.err());
        }
    }

    #[test]
    fn the_frame_is_laid_out_as_the_shaders_read_it() {
        let module = parsed(&SEED);
        let (_, frame) = module
            .types
            .iter()
            .find(|(_, ty)| ty.name.as_deref() == Some("Frame"))
            .expect("frame.wgsl declares Frame");
        let naga::TypeInner::Struct { members, span } = &frame.inner else { panic!("no struct") };
        let read: Vec<_> =
            members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize)).collect();
        assert_eq!(read, Frame::OFFSETS);
        assert_eq!(*span as usize, size_of::<Frame>());
    }
}
