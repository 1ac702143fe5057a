//! The shaders: WGSL files that import one another, and their expansion to plain WGSL.
//!
//! A line `#import shared/uniforms` in a file stands for the file `shaders/shared/uniforms.wgsl`. Each file is
//! included once, after the files that it imports. Comments are left out when this is compiled, because a web page has to
//! be small; their lines stay, so that errors name the right ones.

use crate::inflow::STRIPS;
use crate::programs;
use lamplight::srgb;

macro_rules! files {
    ($($path:literal)*) => {
        &[$(($path, {
            const TEXT: &[u8] = include_str!(concat!("../shaders/", $path, ".wgsl")).as_bytes();
            const LENGTH: usize = code::<{ TEXT.len() }>(TEXT).1;
            const CODE: &[u8; LENGTH] = &code(TEXT).0;
            match std::str::from_utf8(CODE) {
                Ok(code) => code,
                Err(_) => panic!("a shader is no UTF-8"),
            }
        })),*]
    };
}

/// Returns whether a comment begins at a place of a text, with nothing but spaces before it in its line.
const fn is_comment(text: &[u8], at: usize) -> bool {
    let mut before = at;
    while before > 0 && text[before - 1] == b' ' {
        before -= 1;
    }
    let starts = text[at] == b'/' && at + 1 < text.len() && text[at + 1] == b'/';
    starts && (before == 0 || text[before - 1] == b'\n')
}

/// Returns a text without the comments that have lines of their own, and its length. Zeros follow it up to
/// `SIZE`.
const fn code<const SIZE: usize>(text: &[u8]) -> ([u8; SIZE], usize) {
    let mut code = [0; SIZE];
    let (mut at, mut length) = (0, 0);
    while at < text.len() {
        if is_comment(text, at) {
            while at < text.len() && text[at] != b'\n' {
                at += 1;
            }
        } else {
            code[length] = text[at];
            at += 1;
            length += 1;
        }
    }
    (code, length)
}

/// All files by path, without `.wgsl`.
const FILES: &[(&str, &str)] = files! {
    "methods/cascades/gather"
    "methods/cascades/interval"
    "methods/cascades/merge"
    "methods/cascades/probe"
    "methods/flood/blur"
    "methods/flood/rays"
    "methods/holographic/bend"
    "methods/holographic/border"
    "methods/holographic/extend"
    "methods/holographic/faces"
    "methods/holographic/feedback"
    "methods/holographic/fetch_interval"
    "methods/holographic/footprint"
    "methods/holographic/gather"
    "methods/holographic/interval"
    "methods/holographic/light_pair"
    "methods/holographic/merge"
    "methods/holographic/packed_rgb"
    "methods/holographic/paper/extend"
    "methods/holographic/paper/gather"
    "methods/holographic/paper/interval"
    "methods/holographic/paper/load"
    "methods/holographic/paper/merge"
    "methods/holographic/paper/source"
    "methods/holographic/paper/trace"
    "methods/holographic/point_rows"
    "methods/holographic/prefilter"
    "methods/holographic/quadrant"
    "methods/holographic/sky"
    "methods/holographic/slabs"
    "methods/holographic/store_interval"
    "methods/holographic/sweep"
    "methods/holographic/trace"
    "methods/polar/gather"
    "methods/polar/lookup"
    "methods/polar/penumbra"
    "methods/polar/shadow_bounds"
    "methods/polar/shadow_map"
    "methods/polar/shadow_ray"
    "methods/polar/transmittance_curve"
    "methods/raymarch/accumulate"
    "methods/raymarch/gather"
    "methods/raymarch/march"
    "methods/raymarch/march_distance"
    "shared/absorptance"
    "shared/angle"
    "shared/change"
    "shared/circle"
    "shared/class"
    "shared/class_at"
    "shared/cone"
    "shared/cookie"
    "shared/direction"
    "shared/display"
    "shared/ends"
    "shared/hit"
    "shared/inflow"
    "shared/interval"
    "shared/lamps"
    "shared/layers"
    "shared/luminance"
    "shared/moment"
    "shared/noise"
    "shared/normal"
    "shared/packet"
    "shared/pcg"
    "shared/reaching"
    "shared/receive"
    "shared/scatter"
    "shared/sky"
    "shared/solid"
    "shared/surfaces"
    "shared/towards"
    "shared/transmittance"
    "shared/traverse"
    "shared/uniforms"
    "stages/add_direct"
    "stages/class"
    "stages/compare"
    "stages/convergence"
    "stages/denoise"
    "stages/direct"
    "stages/display"
    "stages/display_texture"
    "stages/distance"
    "stages/empty_space"
    "stages/feedback"
    "stages/glow"
    "stages/gradient_moment"
    "stages/invalidate"
    "stages/jump_flood"
    "stages/matter_values"
    "stages/medium_grid"
    "stages/output"
    "stages/reproject"
    "stages/seed"
    "stages/sight"
    "stages/temporal"
    "stages/walls"
};

/// The reason why a shader cannot be expanded.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
enum ImportError {
    #[error("the shader `{0}` does not exist; it is imported by: {1}")]
    Unknown(String, String),
    #[error("these shaders import each other: {0}")]
    Cycle(String),
}

/// The expansion of one shader.
struct Expansion<'a> {
    files: &'a [(&'a str, &'a str)],
    included: Vec<&'a str>,
    /// The files that are being expanded, each imported by the one before.
    open: Vec<&'a str>,
    text: String,
}

impl<'a> Expansion<'a> {
    fn include(&mut self, path: &'a str) -> Result<(), ImportError> {
        if self.open.contains(&path) {
            return Err(ImportError::Cycle([&self.open[..], &[path]].concat().join(" → ")));
        }
        if self.included.contains(&path) {
            return Ok(());
        }
        let file = self.files.iter().find(|(known, _)| *known == path);
        let unknown = || ImportError::Unknown(path.into(), self.open.join(" → "));
        let &(_, source) = file.ok_or_else(unknown)?;
        self.open.push(path);
        for line in source.lines() {
            if let Some(import) = line.strip_prefix("#import ") {
                self.include(import)?;
            }
        }
        self.open.pop();
        self.included.push(path);
        for line in source.lines().filter(|line| !line.starts_with("#import ")) {
            self.text.push_str(line);
            self.text.push('\n');
        }
        Ok(())
    }
}

fn expand<'a>(files: &'a [(&'a str, &'a str)], path: &'a str) -> Result<String, ImportError> {
    let mut expansion =
        Expansion { files, included: Vec::new(), open: Vec::new(), text: String::new() };
    expansion.include(path)?;
    Ok(expansion.text)
}

/// The plain WGSL of a shader.
///
/// A test expands all of them. A shader that cannot be expanded would fail to compile, with the reason as its
/// text.
pub fn text(path: &str) -> String {
    expand(FILES, path).unwrap_or_else(|error| error.to_string())
}

/// The name of a shader in timings and debug groups: its path below `stages` or `methods`.
pub fn label(path: &'static str) -> &'static str {
    path.split_once('/').map_or(path, |(_, below)| below)
}

/// The plain WGSL of all shaders by name, for hosts that want pipelines of their own, and for checks.
pub fn shaders() -> impl Iterator<Item = (&'static str, String)> {
    let mut paths: Vec<_> = programs::ALL.iter().map(|program| program.shader).collect();
    paths.sort_unstable();
    paths.dedup();
    paths.into_iter().map(|path| (label(path), text(path)))
}

/// The constant of shaders/shared/moment.wgsl: true if the first moment of light is found.
pub fn moment(found: bool) -> (&'static str, f64) {
    ("MOMENT", f64::from(found))
}

/// The constants of shaders/shared/sky.wgsl. `enters`: light enters by place on the border, in place of the sky.
pub fn inflow(enters: bool) -> [(&'static str, f64); 2] {
    let strips = if enters { STRIPS } else { 1 };
    [("INFLOW", f64::from(enters)), ("STRIPS", strips as f64)]
}

/// The constants of shaders/shared/luminance.wgsl.
pub const LUMINANCE: [(&str, f64); 3] = [
    ("LUMINANCE_RED", srgb::LUMINANCE[0] as f64),
    ("LUMINANCE_GREEN", srgb::LUMINANCE[1] as f64),
    ("LUMINANCE_BLUE", srgb::LUMINANCE[2] as f64),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu_struct::Layout;
    use crate::lamps::Lamp;
    use crate::methods::cascades::ladder::{Layer, Path};
    use crate::methods::holographic::sweep::Sweep;
    use crate::stages::direct::Sun;
    use crate::stages::display::ComposeUniforms;
    use crate::stages::sight::Sight;
    use crate::uniforms::FrameUniforms;
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    #[test]
    fn comments_are_left_out_and_their_lines_stay() {
        const TEXT: &[u8] = b"// One.\nfn f() {\n    // Two.\n    return 4 / 2; // Three.\n}\n//";
        const LENGTH: usize = code::<{ TEXT.len() }>(TEXT).1;
        const CODE: &[u8] = &code::<LENGTH>(TEXT).0;
        let expected = b"\nfn f() {\n    \n    return 4 / 2; // Three.\n}\n";
        assert_eq!(std::str::from_utf8(CODE), std::str::from_utf8(expected));
    }

    #[test]
    fn every_file_of_the_tree_is_listed() {
        fn walk(folder: &std::path::Path, paths: &mut Vec<String>) {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    walk(&path, paths);
                } else {
                    paths.push(path.with_extension("").display().to_string());
                }
            }
        }
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/");
        let mut paths = Vec::new();
        walk(root.as_ref(), &mut paths);
        let mut paths: Vec<_> =
            paths.iter().map(|path| path.strip_prefix(root).unwrap().replace('\\', "/")).collect();
        paths.sort_unstable();
        assert_eq!(FILES.iter().map(|(path, _)| *path).collect::<Vec<_>>(), paths);
    }

    #[test]
    fn every_shader_is_expanded_to_valid_wgsl_without_any_extension() {
        for (path, _) in FILES {
            assert_eq!(expand(FILES, path).err(), None);
        }
        for (name, text) in shaders() {
            let module = naga::front::wgsl::parse_str(&text)
                .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&text)));
            let valid = Validator::new(ValidationFlags::all(), Capabilities::empty())
                .subgroup_stages(naga::valid::ShaderStages::empty())
                .validate(&module);
            assert!(valid.is_ok(), "{name}: {:?}", valid.err());
        }
    }

    #[test]
    fn every_file_is_part_of_a_shader() {
        let mut used = Vec::new();
        for program in programs::ALL {
            let (open, text) = (Vec::new(), String::new());
            let mut expansion = Expansion { files: FILES, included: used, open, text };
            expansion.include(program.shader).unwrap();
            used = expansion.included;
        }
        let paths = FILES.iter().map(|(path, _)| *path);
        let unused: Vec<_> = paths.filter(|path| !used.contains(path)).collect();
        assert_eq!(unused, [""; 0]);
    }

    #[test]
    fn imports_come_first_and_once() {
        let files = [
            ("a", "#import b\n#import c\na\n"),
            ("b", "#import c\nb\n"),
            ("c", "c\n"),
            ("d", "d\n"),
        ];
        assert_eq!(expand(&files, "a").unwrap(), "c\nb\na\n");
    }

    #[test]
    fn unknown_imports_and_cycles_are_errors() {
        let files = [
            ("a", "#import b\n"),
            ("b", "#import c\n"),
            ("d", "#import e\n"),
            ("e", "#import d\n"),
        ];
        let error = |path| expand(&files, path).unwrap_err().to_string();
        assert_eq!(error("a"), "the shader `c` does not exist; it is imported by: a → b");
        assert_eq!(error("d"), "these shaders import each other: d → e → d");
    }

    /// The differences between a struct in Rust and the struct of its name in a shader.
    fn differences(layout: &Layout, shader: &str) -> Vec<String> {
        let module = naga::front::wgsl::parse_str(&text(shader)).unwrap();
        let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(layout.name));
        let Some(naga::TypeInner::Struct { members, span }) = found.map(|(_, ty)| &ty.inner) else {
            return vec![format!("{shader} declares no {}", layout.name)];
        };
        let read = members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize));
        let read: Vec<_> = read.chain([("(end)", *span as usize)]).collect();
        let fields = layout.fields.iter().copied().chain([("(end)", layout.size)]);
        let written: Vec<_> = fields.filter(|(name, _)| !name.starts_with("padding")).collect();
        let missing = written.iter().filter(|field| !read.contains(field));
        let missing = missing.map(|(name, at)| format!("`{name}` at {at} only in Rust"));
        let more = read.iter().filter(|field| !written.contains(field));
        let more = more.map(|(name, at)| format!("`{name}` at {at} only in {shader}"));
        missing.chain(more).collect()
    }

    #[test]
    fn structs_have_the_layout_that_shaders_read() {
        for (layout, shader) in [
            (FrameUniforms::LAYOUT, programs::SEED.shader),
            (Path::LAYOUT, programs::CASCADES_MERGE.shader),
            (Layer::LAYOUT, programs::CASCADES_MERGE.shader),
            (Sweep::LAYOUT, programs::HOLOGRAPHIC_TRACE.shader),
            (Lamp::LAYOUT, programs::POLAR_GATHER.shader),
            (Sun::LAYOUT, programs::DIRECT.shader),
            (Sight::LAYOUT, programs::SIGHT.shader),
            (ComposeUniforms::LAYOUT, programs::DISPLAY.shader),
        ] {
            assert_eq!(differences(&layout, shader), [""; 0], "{}", layout.name);
        }
    }

    #[test]
    fn a_field_in_another_place_is_found() {
        let mut fields = Lamp::LAYOUT.fields.to_vec();
        fields[2].1 -= 4;
        let layout = Layout { fields: &fields, ..Lamp::LAYOUT };
        assert_eq!(
            differences(&layout, programs::POLAR_GATHER.shader),
            ["`range` at 8 only in Rust", "`range` at 12 only in methods/polar/gather"]
        );
    }
}
