//! The matter of a grid as textures: the host's, or uploaded from cells.

use crate::error::{PrepareError, Result};
use crate::grid_size::GridSize;
use lamplight::internals::display::emitted;
use lamplight::internals::lamp::show_lamps;
use lamplight::settings::MethodSettings;
use lamplight::{Cells, Rgb};
use wgpu::{
    Device, Extent3d, Origin3d, Queue, TexelCopyBufferLayout, TexelCopyTextureInfo, Texture,
    TextureAspect, TextureDescriptor, TextureDimension, TextureFormat, TextureSampleType,
    TextureUsages, TextureView,
};

/// The largest half float.
pub const MAX_HALF: f32 = 65504.0;
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
    /// Red, green, blue: the emission coefficient, radiance per px, also of cells without opacity. `None` if
    /// nothing glows. Here hosts add up their lamps: as a disc of radius R, with `2·radiance/(π·R)` times the
    /// covered fraction of each cell, a lamp blocks nothing. It is not displayed.
    pub glow: Option<TextureView>,
    /// Red: the layers of each cell, the bits of a byte in a format such as `R8Unorm`. Lamps and suns light only cells
    /// with which their mask has a layer in common. `None` if all cells are in all layers.
    pub masks: Option<TextureView>,
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
        let glow = self.glow.iter().map(|view| ("glow", view));
        let masks = self.masks.iter().map(|view| ("masks", view));
        for (name, view) in named.into_iter().chain(glow).chain(masks) {
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
pub fn writable(
    name: &'static str,
    view: &TextureView,
    (usage, usage_name): (TextureUsages, &str),
) -> Result<[u32; 2]> {
    let texture = view.texture();
    let wrong = |problem: String| Err(PrepareError::Texture { name, problem });
    if texture.format() != TextureFormat::Rgba16Float {
        return wrong(format!("has the format {:?}, not Rgba16Float", texture.format()));
    }
    if !texture.usage().contains(usage) {
        return wrong(format!("lacks the usage {usage_name}"));
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
    /// The radiance that the displayed picture shows of each cell itself, if it differs from the emission of
    /// the matter that was lit: solid lamps that are not visible, visible ones that are not solid, glow.
    pub shown: Option<TextureView>,
    /// The normals of the cells, if they have some.
    pub normals: Option<TextureView>,
    /// Made when something first glows, when `shown` is first needed, and when cells first have normals.
    spare: [Option<TextureView>; 3],
    /// Made when cells first have masks.
    spare_masks: Option<TextureView>,
    /// The cells with their lamps drawn in, and with those that are shown.
    drawn: [Cells; 2],
    /// Texels of the current upload.
    texels: Vec<[f32; 4]>,
}

impl Upload {
    pub fn new(device: &Device, size: GridSize) -> Result<Self> {
        let view = |label| texture(device, label, size, UPLOADED);
        let textures = Textures {
            emission: view("emission"),
            tint_opacity: view("tint and opacity"),
            albedo: view("albedo"),
            glow: None,
            masks: None,
        };
        let drawn = [Cells::new(1, 1)?, Cells::new(1, 1)?];
        Ok(Self {
            size,
            textures,
            shown: None,
            normals: None,
            spare: [None, None, None],
            spare_masks: None,
            drawn,
            texels: Vec::new(),
        })
    }

    /// Uploads cells, with lamps as a method reads them. Allocates nothing the second time.
    pub fn write(
        &mut self,
        device: &Device,
        queue: &Queue,
        cells: &Cells,
        method: &MethodSettings,
    ) {
        let Self { size, textures, spare, spare_masks, drawn: [drawn, seen], texels, .. } = self;
        let [glow, shown, normals] = spare;
        let lamps = cells.lamps();
        let lit = if lamps.is_empty() {
            cells
        } else {
            drawn.clone_from(cells);
            method.draw_lamps(drawn);
            drawn
        };
        let made = |view: &mut Option<TextureView>, label| {
            view.get_or_insert_with(|| texture(device, label, *size, UPLOADED)).clone()
        };
        let mut write = |view: &TextureView, contents: &mut dyn Iterator<Item = [f32; 4]>| {
            texels.clear();
            texels.extend(contents);
            write_texels(queue, view, texels);
        };
        let rgb = |[r, g, b]: Rgb| [r, g, b, 0.0];
        write(&textures.emission, &mut lit.emission().iter().copied().map(rgb));
        write(&textures.albedo, &mut lit.albedo().iter().copied().map(rgb));
        let tints = lit.tint().iter().zip(lit.opacity());
        write(&textures.tint_opacity, &mut tints.map(|(&[r, g, b], &opacity)| [r, g, b, opacity]));
        textures.glow = lit.glow().map(|values| {
            let view = made(glow, "glow");
            write(&view, &mut values.iter().copied().map(rgb));
            view
        });
        textures.masks = cells.masks().map(|masks| {
            let made = || masks_texture(device, (*size).into());
            let view = spare_masks.get_or_insert_with(made).clone();
            write_masks(queue, &view, masks);
            view
        });
        // Where lamps are solid by the method's rule, they are visible too.
        let by_flag = method.reads_glow() || method.method().lights_lamps();
        let marked = by_flag && lamps.iter().any(|lamp| lamp.solid || lamp.visible);
        self.shown = (marked || cells.glow().is_some()).then(|| {
            seen.clone_from(cells);
            show_lamps(seen);
            let view = made(shown, "emission of the picture");
            write(&view, &mut (0..seen.len()).map(|i| rgb(emitted(&seen.matter(i)))));
            view
        });
        self.normals = cells.normals().map(|values| {
            let view = made(normals, "normals");
            write(&view, &mut values.iter().copied().map(rgb));
            view
        });
    }
}

/// The usage of textures that are uploaded to.
pub const UPLOADED: TextureUsages = TextureUsages::TEXTURE_BINDING.union(TextureUsages::COPY_DST);

/// Creates a texture of four floats per cell.
pub fn texture(device: &Device, label: &str, size: GridSize, usage: TextureUsages) -> TextureView {
    texture_of(device, label, size.into(), TextureFormat::Rgba32Float, usage)
}

/// Creates a texture of a byte per cell, the cell's layers.
pub fn masks_texture(device: &Device, size: [u32; 2]) -> TextureView {
    texture_of(device, "layers", size, TextureFormat::R8Unorm, UPLOADED)
}

/// Creates a texture of four floats per column of strips: that of a panorama, or those of an inflow.
pub fn strips_texture(device: &Device, size: [u32; 2]) -> TextureView {
    texture_of(device, "strips of columns", size, TextureFormat::Rgba32Float, UPLOADED)
}

/// Creates a texture of four floats per texel of cookies.
pub fn cookies_texture(device: &Device, size: [u32; 2]) -> TextureView {
    texture_of(device, "cookies", size, TextureFormat::Rgba32Float, UPLOADED)
}

/// Writes a texture of four floats.
pub fn write_texels(queue: &Queue, view: &TextureView, texels: &[[f32; 4]]) {
    write_bytes(queue, view.texture(), bytemuck::cast_slice(texels), TEXEL);
}

/// Writes light to a texture of half floats.
pub fn write_halves(queue: &Queue, view: &TextureView, light: &[[f32; 4]]) {
    let halves: Vec<[u16; 4]> = light.iter().map(|rgba| rgba.map(half)).collect();
    write_bytes(queue, view.texture(), bytemuck::cast_slice(&halves), TEXEL / 2);
}

/// The bits of the nearest half float. Light is 0 or more; beyond the largest half it is that one.
fn half(v: f32) -> u16 {
    // The least half with all bits of its fraction, and how often the least half is in 1.
    const LEAST_NORMAL: f32 = 1.0 / 16384.0;
    const STEPS: f32 = 16_777_216.0;
    let v = v.min(MAX_HALF);
    if v < LEAST_NORMAL {
        return (v * STEPS).round_ties_even() as u16;
    }
    let bits = v.to_bits();
    // The exponent's bias is 15 in place of 127; 13 bits of the fraction are rounded off, to even.
    ((bits - (112 << 23) + 0xfff + ((bits >> 13) & 1)) >> 13) as u16
}

/// Writes the layers of all cells.
pub fn write_masks(queue: &Queue, view: &TextureView, masks: &[u8]) {
    write_bytes(queue, view.texture(), masks, 1);
}

pub fn texture_of(
    device: &Device,
    label: &str,
    [width, height]: [u32; 2],
    format: TextureFormat,
    usage: TextureUsages,
) -> TextureView {
    let texture = device.create_texture(&TextureDescriptor {
        label: Some(label),
        size: Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}

fn write_bytes(queue: &Queue, texture: &Texture, bytes: &[u8], texel: u32) {
    let target = TexelCopyTextureInfo {
        texture,
        mip_level: 0,
        origin: Origin3d::ZERO,
        aspect: TextureAspect::All,
    };
    let rows = TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(texture.width() * texel),
        rows_per_image: None,
    };
    queue.write_texture(target, bytes, rows, texture.size());
}
