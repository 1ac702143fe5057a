//! The matter of a grid as textures: the host's, or uploaded from cells.

use crate::error::{PrepareError, Result};
use crate::grid_size::GridSize;
use lamplight::Cells;
use wgpu::{
    Device, Extent3d, Origin3d, Queue, TexelCopyBufferLayout, TexelCopyTextureInfo, Texture,
    TextureAspect, TextureDescriptor, TextureDimension, TextureFormat, TextureSampleType,
    TextureUsages, TextureView,
};

/// Bytes of a texel: four floats.
const TEXEL: u32 = 16;

/// The host's matter: views of whole two-dimensional textures of one size, with one layer and one mip level, in
/// any float or normalised format, with the usage `TEXTURE_BINDING`. All values are linear (an sRGB format
/// decodes by itself), finite and 0 or more; tint, opacity and albedo at most 1. Texel values are not validated;
/// out-of-range values produce incorrect light. Views are kept as long as they are lit; the host may drop its
/// own.
#[derive(Clone, Debug, PartialEq)]
pub struct Textures {
    /// Red, green, blue: emitted radiance.
    pub emission: TextureView,
    /// Red, green, blue: tint; alpha: opacity, 1 in solid cells.
    pub tint_opacity: TextureView,
    /// Red, green, blue: albedo, the fraction of light that is scattered.
    pub albedo: TextureView,
}

impl Textures {
    /// Returns columns and rows. Rejects textures that shaders cannot read.
    pub(crate) fn size(&self) -> Result<[u32; 2]> {
        let named = [
            ("emission", &self.emission),
            ("tint_opacity", &self.tint_opacity),
            ("albedo", &self.albedo),
        ];
        let format = self.tint_opacity.texture().format();
        if format.components() < 4 {
            let problem = format!("has the format {format:?}, without alpha, which is the opacity");
            return Err(PrepareError::Texture { name: "tint_opacity", problem });
        }
        let size = readable("emission", &self.emission)?;
        for (name, view) in named {
            check_size(name, readable(name, view)?, "emission", size)?;
        }
        Ok(size)
    }
}

/// Rejects a texture whose size is not that of another thing.
pub fn check_size(
    name: &'static str,
    [w, h]: [u32; 2],
    other: &str,
    [width, height]: [u32; 2],
) -> Result<()> {
    if [w, h] != [width, height] {
        let problem = format!("is {w}×{h}, but {other} is {width}×{height}");
        return Err(PrepareError::Texture { name, problem });
    }
    Ok(())
}

/// Returns columns and rows of a texture of the host's. Rejects one that the light cannot be written to.
pub fn writable(name: &'static str, view: &TextureView) -> Result<[u32; 2]> {
    let texture = view.texture();
    let wrong = |problem: String| Err(PrepareError::Texture { name, problem });
    if texture.format() != TextureFormat::Rgba16Float {
        return wrong(format!("has the format {:?}, not Rgba16Float", texture.format()));
    }
    if !texture.usage().contains(TextureUsages::STORAGE_BINDING) {
        return wrong("lacks the usage STORAGE_BINDING".into());
    }
    single(name, view)
}

/// Returns columns and rows of a texture of the host's. Rejects one that shaders cannot read.
pub fn readable(name: &'static str, view: &TextureView) -> Result<[u32; 2]> {
    let texture = view.texture();
    let wrong = |problem: String| Err(PrepareError::Texture { name, problem });
    let sampled = texture.format().sample_type(None, None);
    if !matches!(sampled, Some(TextureSampleType::Float { .. })) {
        return wrong(format!("has the format {:?}, not floats", texture.format()));
    }
    if !texture.usage().contains(TextureUsages::TEXTURE_BINDING) {
        return wrong("lacks the usage TEXTURE_BINDING".into());
    }
    single(name, view)
}

/// Returns columns and rows of a texture with a single layer and mip level. Views of some of the layers or
/// levels cannot be distinguished from views of all.
fn single(name: &'static str, view: &TextureView) -> Result<[u32; 2]> {
    let texture = view.texture();
    let wrong = |problem: String| Err(PrepareError::Texture { name, problem });
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

/// Textures that cells are uploaded to.
#[derive(Debug)]
pub struct Upload {
    pub size: GridSize,
    pub textures: Textures,
    /// The cells with their lamps drawn in, if they have any.
    drawn: Cells,
    /// Texels of the current upload.
    texels: Vec<[f32; 4]>,
}

impl Upload {
    pub fn new(device: &Device, size: GridSize) -> Result<Self> {
        let GridSize { width, height } = size;
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
        Ok(Self { size, textures, drawn: Cells::new(1, 1)?, texels: Vec::new() })
    }

    /// Uploads cells; `draw`: with their lamps as emitting discs. Allocates nothing the second time.
    pub fn write(&mut self, queue: &Queue, cells: &Cells, draw: bool) {
        let Self { textures, drawn, texels, .. } = self;
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
