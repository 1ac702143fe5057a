//! The shaders: plain WGSL files, put one after the other where they share code.
//!
//! A host that wants its own pipeline can load the same files in the same order.

use lamplight::srgb;

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
pub const OPTICS: Shader = shader!("optics", "transmittance");
pub const CLEARANCE: Shader = shader!("clearance");
pub const CHANGES: Shader = shader!("changes", "pcg");
pub const RAYMARCH: Shader = shader!(
    "raymarch",
    "pcg",
    "noise",
    "luminance",
    "gather",
    "faces",
    "sky",
    "surfaces",
    "packet",
    "march_edge"
);
pub const RAYMARCH_DISTANCE: Shader = shader!(
    "raymarch",
    "pcg",
    "noise",
    "luminance",
    "gather",
    "faces",
    "sky",
    "surfaces",
    "march_distance"
);
pub const FEEDBACK: Shader = shader!("feedback");
pub const COMPARE: Shader = shader!("compare", "found");
pub const CONVERGENCE: Shader = shader!("convergence", "found");
pub const TEMPORAL: Shader = shader!("temporal");
pub const DENOISE: Shader = shader!("denoise", "luminance");
pub const GROUND: Shader = shader!("ground");
pub const FLOOD_RAYS: Shader =
    shader!("flood_rays", "lamps", "angle", "kinds", "walk", "sky", "transmittance");
pub const FLOOD: Shader = shader!("flood", "kinds", "faces");
pub const POLAR_RAYS: Shader = shader!(
    "polar_rays",
    "lamps",
    "angle",
    "kinds",
    "walk",
    "circle",
    "transmittance",
    "knots",
    "fan"
);
pub const POLAR_BOUNDS: Shader = shader!("polar_bounds", "lamps", "angle");
pub const POLAR: Shader = shader!(
    "polar",
    "lamps",
    "angle",
    "kinds",
    "walk",
    "circle",
    "transmittance",
    "knots",
    "fan",
    "faces",
    "lookup"
);
pub const SLABS: Shader = shader!("slabs", "sweep", "packed_rgb");
pub const TRACE: Shader =
    shader!("trace", "sweep", "packed_rgb", "interval", "packed_interval", "transmittance", "ways");
pub const EXTEND: Shader = shader!("extend", "sweep", "interval", "packed_interval");
pub const CONES: Shader = shader!("cones", "sweep", "packed_rgb", "interval", "packed_interval");
pub const HOP: Shader = shader!("hop", "sweep", "packed_rgb", "interval", "transmittance", "ways");
pub const REFLECT: Shader = shader!("reflect", "found", "faces", "packed_rgb", "solid");
pub const CASCADES_FILL: Shader = shader!(
    "cascades/fill",
    "faces",
    "sky",
    "surfaces",
    "interval",
    "packet",
    "cascades/interval",
    "cascades/merge"
);
pub const CASCADES_GATHER: Shader = shader!(
    "cascades/gather",
    "faces",
    "sky",
    "surfaces",
    "interval",
    "packet",
    "cascades/interval",
    "cascades/merge"
);
pub const PAPER_SOURCE: Shader = shader!("paper_source", "faces", "found");
pub const PAPER_TRACE: Shader =
    shader!("paper_trace", "sweep", "interval", "paper_interval", "transmittance");
pub const PAPER_EXTEND: Shader =
    shader!("paper_extend", "sweep", "interval", "paper_interval", "paper_load");
pub const PAPER_MERGE: Shader =
    shader!("paper_merge", "sweep", "interval", "paper_interval", "paper_load");
pub const PAPER_GATHER: Shader = shader!("paper_gather");
pub const WALLS: Shader = shader!("walls", "solid");
pub const CARRY: Shader = shader!("carry");
pub const OUTPUT: Shader = shader!("output");
pub const DISPLAY: Shader = shader!("display");

const ALL: &[Shader] = &[
    SEED,
    JUMP_FLOOD,
    DISTANCE,
    OPTICS,
    CHANGES,
    CLEARANCE,
    RAYMARCH,
    RAYMARCH_DISTANCE,
    FEEDBACK,
    COMPARE,
    CONVERGENCE,
    TEMPORAL,
    DENOISE,
    GROUND,
    FLOOD_RAYS,
    FLOOD,
    POLAR_RAYS,
    POLAR_BOUNDS,
    POLAR,
    CASCADES_FILL,
    CASCADES_GATHER,
    SLABS,
    TRACE,
    EXTEND,
    CONES,
    HOP,
    REFLECT,
    PAPER_SOURCE,
    PAPER_TRACE,
    PAPER_EXTEND,
    PAPER_MERGE,
    PAPER_GATHER,
    WALLS,
    CARRY,
    OUTPUT,
    DISPLAY,
];

/// The texts of all shaders, by name, for hosts that want pipelines of their own, and for who checks them.
pub fn shaders() -> impl Iterator<Item = (&'static str, String)> {
    ALL.iter().map(|shader| (shader.name, shader.text()))
}

/// What shaders/luminance.wgsl is told.
pub const LUMINANCE: [(&str, f64); 3] = [
    ("LUMINANCE_RED", srgb::LUMINANCE[0] as f64),
    ("LUMINANCE_GREEN", srgb::LUMINANCE[1] as f64),
    ("LUMINANCE_BLUE", srgb::LUMINANCE[2] as f64),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Frame;
    use crate::lamps::Lamp;
    use crate::methods::cascades::ladder::{Layer, Path};
    use crate::methods::holographic::sweep::Sweep;
    use crate::stages::display::Look;
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    fn parsed(shader: &Shader) -> naga::Module {
        naga::front::wgsl::parse_str(&shader.text())
            .unwrap_or_else(|e| panic!("{}: {}", shader.name, e.emit_to_string(&shader.text())))
    }

    #[test]
    fn every_shader_is_valid_without_any_extension() {
        for shader in ALL {
            let module = parsed(shader);
            let valid = Validator::new(ValidationFlags::all(), Capabilities::empty())
                .subgroup_stages(naga::valid::ShaderStages::empty())
                .validate(&module);
            assert!(valid.is_ok(), "{}: {:?}", shader.name, valid.err());
        }
    }

    /// Whether a structure is laid out in a shader as it is here: names and places of all fields, and
    /// the size.
    #[track_caller]
    fn laid_out(shader: &Shader, name: &str, fields: &[(&str, usize)], size: usize) {
        let module = parsed(shader);
        let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
        let Some(naga::TypeInner::Struct { members, span }) = found.map(|(_, ty)| &ty.inner) else {
            panic!("{} declares no {name}", shader.name)
        };
        let read: Vec<_> =
            members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize)).collect();
        assert_eq!(read, fields);
        assert_eq!(*span as usize, size);
    }

    #[test]
    fn structures_are_laid_out_as_the_shaders_read_them() {
        laid_out(&SEED, "Frame", &Frame::OFFSETS, size_of::<Frame>());
        laid_out(&CASCADES_FILL, "Path", &Path::OFFSETS, size_of::<Path>());
        laid_out(&CASCADES_FILL, "Layer", &Layer::OFFSETS, size_of::<Layer>());
        laid_out(&TRACE, "Sweep", &Sweep::OFFSETS, size_of::<Sweep>());
        laid_out(&POLAR, "Lamp", &Lamp::OFFSETS, size_of::<Lamp>());
        laid_out(&DISPLAY, "Look", &Look::OFFSETS, size_of::<Look>());
    }
}
