//! From light to the displayed picture: exposure, tone map, encoding.

use crate::draw_program::{DrawProgram, Target};
use crate::error::unsupported;
use crate::gpu_struct::gpu_struct;
use crate::matter::MAX_HALF;
use crate::tier::has_compute;
use crate::{programs, shaders};
use lamplight::internals::display::{
    ACES, ACES_LUMA, ACES_WHITE, AGX_CONTRAST, AGX_GAMMA, AGX_INSET, AGX_OUTSET, AGX_PLAIN,
    AGX_STOPS, AGX_VIVID, BRIGHTEST, LEAST_LIGHT,
};
use lamplight::srgb::LUMINANCE;
use lamplight::{Display, Relief, Rgb, ToneMap, srgb};
use wgpu::{BindGroup, BindingResource, Device, RenderPipeline, TextureFormat};

gpu_struct! {
    /// `ComposeUniforms` of shaders/stages/display.wgsl, where the fields are explained.
    pub struct ComposeUniforms {
        pub corner: [f32; 2],
        pub right: [f32; 2],
        pub down: [f32; 2],
        gain: f32,
        brightest: f32,
        luma: Rgb,
        aces_end: f32,
        ambient: Rgb,
        aces_white: f32,
        aces: [f32; 4],
        stops: [f32; 2],
        cotangent: f32,
        specular: f32,
        inset: [[f32; 4]; 3],
        outset: [[f32; 4]; 3],
        contrast: [[f32; 4]; 2],
        look: Rgb,
        exponent: f32,
    }
}

/// The picture that a pipeline draws, and its target. The numbers are those of shaders/shared/display.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Drawn {
    pub target: Target,
    pub encodes: bool,
    pub tonemap: u32,
    pub is_filtered: bool,
    pub color_from: u32,
    pub color_emits: bool,
    pub more_light: bool,
    pub has_shown: bool,
    pub normals: u32,
    pub shines: bool,
}

impl ComposeUniforms {
    /// The uniforms that show a whole grid of this size. Without an elevation of its light there are no normals.
    pub fn new(display: &Display, elevation: Option<f32>, size: [u32; 2]) -> Self {
        let [a, b, c, d, e] = ACES;
        let (luma, look) = match display.tonemap {
            ToneMap::Aces => (ACES_LUMA, AGX_PLAIN),
            ToneMap::Vivid => (LUMINANCE, AGX_VIVID),
            _ => (LUMINANCE, AGX_PLAIN),
        };
        let cotangent = elevation.map_or(0.0, |elevation| elevation.cos() / elevation.sin());
        let Relief { specular, .. } = display.relief;
        let [x6, x5, x4, x3, x2, x1, x0] = AGX_CONTRAST;
        Self {
            corner: [0.0; 2],
            right: [size[0] as f32, 0.0],
            down: [0.0, size[1] as f32],
            gain: display.gain(),
            brightest: BRIGHTEST,
            luma,
            aces_end: e,
            ambient: display.ambient,
            aces_white: ACES_WHITE,
            aces: [a, b, c, d],
            stops: AGX_STOPS,
            cotangent,
            specular,
            inset: columns(&AGX_INSET),
            outset: columns(&AGX_OUTSET),
            contrast: [[x6, x5, x4, x3], [x2, x1, x0, AGX_GAMMA]],
            look,
            exponent: display.relief.exponent(),
        }
    }

    /// Caps radiance at the largest half float, where every tone map is flat.
    pub fn keep_finite(&mut self) {
        self.brightest = MAX_HALF;
    }
}

/// Returns the number of a tone map in the shader.
pub fn tonemap_number(tonemap: ToneMap) -> Result<u32, lamplight::Error> {
    Ok(match tonemap {
        ToneMap::None => 0,
        ToneMap::Reinhard => 1,
        ToneMap::Aces => 2,
        ToneMap::Agx | ToneMap::Vivid => 3,
        other => return Err(unsupported("tonemap", other)),
    })
}

/// The columns of a matrix given by rows, padded as in uniforms.
fn columns(rows: &[Rgb; 3]) -> [[f32; 4]; 3] {
    std::array::from_fn(|c| [rows[0][c], rows[1][c], rows[2][c], 0.0])
}

/// Returns whether shaders have to encode for a format, because it stores display values and does not encode
/// itself. `None`: a format that pictures cannot be drawn to.
pub fn encodes(format: TextureFormat) -> Option<bool> {
    use TextureFormat::{
        Bgra8Unorm, Bgra8UnormSrgb, Rg11b10Ufloat, Rgb10a2Unorm, Rgba8Unorm, Rgba8UnormSrgb,
        Rgba16Float, Rgba32Float,
    };
    match format {
        Rgba8Unorm | Bgra8Unorm | Rgb10a2Unorm => Some(true),
        Rgba8UnormSrgb | Bgra8UnormSrgb | Rgba16Float | Rgba32Float | Rg11b10Ufloat => Some(false),
        _ => None,
    }
}

/// The program that draws pictures.
#[derive(Debug)]
pub struct Shading(DrawProgram);

impl Shading {
    pub fn new(device: &Device) -> Self {
        let with_buffers = has_compute(device);
        let program = if with_buffers { programs::DISPLAY } else { programs::DISPLAY_TEXTURE };
        Self(DrawProgram::new(device, program))
    }

    /// Binds resources to its slots.
    pub fn bind<'a>(
        &self,
        device: &Device,
        resources: impl IntoIterator<Item = BindingResource<'a>>,
    ) -> BindGroup {
        self.0.bind(device, resources)
    }

    /// Creates the pipeline that draws this.
    pub fn pipeline(&self, device: &Device, drawn: Drawn) -> RenderPipeline {
        let numbers = [
            ("TONEMAP", f64::from(drawn.tonemap)),
            ("FILTERED", f64::from(drawn.is_filtered)),
            ("COLOR_FROM", f64::from(drawn.color_from)),
            ("COLOR_EMITS", f64::from(drawn.color_emits)),
            ("MORE_LIGHT", f64::from(drawn.more_light)),
            ("HAS_SHOWN", f64::from(drawn.has_shown)),
            ("NORMALS", f64::from(drawn.normals)),
            ("SHINES", f64::from(drawn.shines)),
            ("ENCODE", f64::from(drawn.encodes)),
            ("STRAIGHT", f64::from(srgb::STRAIGHT)),
            ("SLOPE", f64::from(srgb::SLOPE)),
            ("OFFSET", f64::from(srgb::OFFSET)),
            ("GAMMA", f64::from(srgb::GAMMA)),
            ("LEAST_LIGHT", f64::from(LEAST_LIGHT)),
        ];
        let constants = [&numbers[..], &shaders::LUMINANCE].concat();
        self.0.pipeline(device, drawn.target, &constants)
    }
}
