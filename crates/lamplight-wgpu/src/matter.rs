//! The grid of matter as pictures on the GPU: the host's, or uploaded from cells.

use crate::{Error, Result};
use lamplight::Cells;
use wgpu::{
    Device, Extent3d, Origin3d, Queue, TexelCopyBufferLayout, TexelCopyTextureInfo, Texture,
    TextureAspect, TextureDescriptor, TextureDimension, TextureFormat, TextureSampleType,
    TextureUsages, TextureView,
};

/// Bytes of a texel: four floats.
const TEXEL: u32 = 16;

/// What the host's matter is made of: views of whole two-dimensional textures of one size, with one
/// layer and one mip level, in any float or normalised format, with the usage `TEXTURE_BINDING`. All
/// values are linear (an sRGB format decodes by itself), 0 or more and finite; tint, opacity and albedo
/// 1 at most. Nobody looks at each texel: values beyond give light as wrong as they are. Views are kept as
/// long as they are lit; the host may drop its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Textures {
    /// Red, green, blue: radiance that cells give off.
    pub emission: TextureView,
    /// Red, green, blue: tint; alpha: opacity, 1 in a solid wall.
    pub tint_opacity: TextureView,
    /// Red, green, blue: share of light that is sent on.
    pub albedo: TextureView,
}

impl Textures {
    /// Columns and rows; refuses what shaders could not read.
    pub(crate) fn size(&self) -> Result<[u32; 2]> {
        let named = [
            ("emission", &self.emission),
            ("tint_opacity", &self.tint_opacity),
            ("albedo", &self.albedo),
        ];
        let format = self.tint_opacity.texture().format();
        if format.components() < 4 {
            let problem = format!("has the format {format:?}, without alpha, which is the opacity");
            return Err(Error::Texture { name: "tint_opacity", problem });
        }
        let [width, height] = readable("emission", &self.emission)?;
        for (name, view) in named {
            let [w, h] = readable(name, view)?;
            if [w, h] != [width, height] {
                let problem = format!("is {w}×{h}, but emission is {width}×{height}");
                return Err(Error::Texture { name, problem });
            }
        }
        Ok([width, height])
    }
}

/// Columns and rows of a picture of the host's; refuses one that shaders could not read.
pub fn readable(name: &'static str, view: &TextureView) -> Result<[u32; 2]> {
    let texture = view.texture();
    let wrong = |problem: String| Err(Error::Texture { name, problem });
    let sampled = texture.format().sample_type(None, None);
    if !matches!(sampled, Some(TextureSampleType::Float { .. })) {
        return wrong(format!("has the format {:?}, not floats", texture.format()));
    }
    if !texture.usage().contains(TextureUsages::TEXTURE_BINDING) {
        return wrong("lacks the usage TEXTURE_BINDING".into());
    }
    single(name, view)
}

/// Columns and rows of a picture that is one and no more: views of some of its layers or mip levels
/// cannot be told from views of all.
pub fn single(name: &'static str, view: &TextureView) -> Result<[u32; 2]> {
    let texture = view.texture();
    let wrong = |problem: String| Err(Error::Texture { name, problem });
    if texture.dimension() != TextureDimension::D2
        || texture.depth_or_array_layers() != 1
        || texture.sample_count() != 1
    {
        return wrong("is not one two-dimensional picture".into());
    }
    if texture.mip_level_count() != 1 {
        return wrong(format!("has {} mip levels, not one", texture.mip_level_count()));
    }
    Ok([texture.width(), texture.height()])
}

/// Pictures of its own, that cells are uploaded to.
#[derive(Debug)]
pub struct Upload {
    pub textures: Textures,
    /// The cells with their lamps drawn in, where they have some.
    drawn: Cells,
    /// Texels on their way.
    texels: Vec<[f32; 4]>,
}

impl Upload {
    pub fn new(device: &Device, [width, height]: [u32; 2]) -> Result<Self> {
        let view = |label| {
            let texture = device.create_texture(&TextureDescriptor {
                label: Some(label),
                size: Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: TextureDimension::D2,
                format: TextureFormat::Rgba32Float,
                usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
                view_formats: &[],
            });
            texture.create_view(&Default::default())
        };
        let textures = Textures {
            emission: view("emission"),
            tint_opacity: view("tint and opacity"),
            albedo: view("albedo"),
        };
        Ok(Self { textures, drawn: Cells::new(1, 1)?, texels: Vec::new() })
    }

    /// Takes the cells over; `draw`: with their lamps as glowing discs. The second time it allocates
    /// nothing.
    pub fn write(&mut self, queue: &Queue, cells: &Cells, draw: bool) {
        let Self { textures, drawn, texels } = self;
        let cells = if cells.lamps().is_empty() || !draw {
            cells
        } else {
            drawn.clone_from(cells);
            drawn.draw_lamps();
            drawn
        };
        for (view, rgb) in
            [(&textures.emission, cells.emission()), (&textures.albedo, cells.albedo())]
        {
            texels.clear();
            texels.extend(rgb.iter().map(|&[r, g, b]| [r, g, b, 0.0]));
            write(queue, view.texture(), texels);
        }
        texels.clear();
        let tints = cells.tint().iter().zip(cells.opacity());
        texels.extend(tints.map(|(&[r, g, b], &opacity)| [r, g, b, opacity]));
        write(queue, textures.tint_opacity.texture(), texels);
    }
}

fn write(queue: &Queue, texture: &Texture, texels: &[[f32; 4]]) {
    let target = TexelCopyTextureInfo {
        texture,
        mip_level: 0,
        origin: Origin3d::ZERO,
        aspect: TextureAspect::All,
    };
    let rows = TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(texture.width() * TEXEL),
        rows_per_image: None,
    };
    queue.write_texture(target, bytemuck::cast_slice(texels), rows, texture.size());
}
