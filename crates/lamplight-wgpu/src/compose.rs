//! Drawing what is seen: light × colour, exposed and tone mapped, on the host's target.

use crate::guarded::guarded;
use crate::stages::display::{Look, Shading, Target, encodes};
use crate::view::Window;
use crate::{Error, Lighting, Result, matter};
use lamplight::{Display, Rgb};
use std::collections::HashMap;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, Buffer, BufferDescriptor,
    BufferUsages, Color as Clear, CommandEncoder, Device, LoadOp, Operations, Queue, RenderPass,
    RenderPassColorAttachment, RenderPassDescriptor, RenderPipeline, StoreOp, TextureFormat,
    TextureView,
};

/// How light is shown on a target that has more pixels than the grid has cells, or that lies between
/// them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// Each pixel shows the cell it lies in, as `--scale` of the command line does.
    #[default]
    Nearest,
    /// Each pixel shows the mean of the four cells whose centres are nearest, by how near they are:
    /// smooth, and light follows a camera that moves by fractions of a cell. Four times the reads.
    Linear,
}

/// What the light falls on: views of two-dimensional textures in any float or normalised format, with
/// the usage `TEXTURE_BINDING`. Linear, an sRGB format decodes by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Color<'a> {
    /// White: the light alone.
    #[default]
    White,
    /// A texel a cell, as large as the grid; filtered with the light.
    Cells(&'a TextureView),
    /// A picture that covers what is seen, of any size: the host's own frame at the target's
    /// resolution. Each pixel takes the texel it lies in.
    View(&'a TextureView),
    /// A picture as large as the target: each pixel takes its own texel, and its alpha. The host's own
    /// frame, whatever part of the target is drawn on.
    Target(&'a TextureView),
}

/// How a frame is shown.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shown<'a> {
    /// Exposure and tone map.
    pub display: Display,
    /// Between cells.
    pub filter: Filter,
    /// What the light falls on.
    pub color: Color<'a>,
    /// Radiance with which the colour itself glows, `colour × (light + glow)`, instead of what cells give
    /// off: a picture as large as the target, as [`Color::Target`]. Glowing things then have edges as
    /// fine as the target's pixels.
    pub glow: Option<&'a TextureView>,
    /// Light that arrives besides the grid's, a texel a cell: what another [`Lighting`] wrote to a texture
    /// ([`Lighting::write_to`]).
    pub more: Option<&'a TextureView>,
    /// Light that arrives everywhere, in walls too; finite and 0 or more.
    pub ambient: Rgb,
    /// The part of the grid that fills the target's viewport, as [`crate::View::place`] gives it;
    /// none: all of it.
    pub window: Option<Window>,
}

/// Draws the light of a [`Lighting`] on the host's targets, with the same pixels as the library's
/// [`lamplight::Light::compose`] but for rounding (one 8-bit step).
///
/// What is drawn on decides about sRGB: formats that encode by themselves (`…UnormSrgb`) are given
/// linear light, other normalised ones encoded light, floats the tone-mapped light, linear: 0 to 1, or
/// without a tone map all that there is, for a host that has its own.
///
/// A pipeline is built for each kind of target when it is first seen. One `Compose` shows one frame
/// at a time: a split screen takes one for each part.
///
/// ```no_run
/// # use lamplight_wgpu::{Compose, Lighting, Result, Shown, wgpu};
/// # fn show(device: &wgpu::Device, queue: &wgpu::Queue, lighting: &Lighting, compose: &mut Compose,
/// #         encoder: &mut wgpu::CommandEncoder, screen: &wgpu::TextureView) -> Result<()> {
/// // After `lighting.prepare` and `lighting.record`:
/// compose.prepare(device, queue, lighting, screen.texture().format(), &Shown::default())?;
/// compose.record(encoder, screen); // or `compose.draw(&mut pass)` in a pass of the host's
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Compose {
    shading: Shading,
    look: Buffer,
    pipelines: HashMap<Target, RenderPipeline>,
    pipeline: Option<RenderPipeline>,
    bound: Option<Bound>,
}

/// What is bound, and to what.
#[derive(Debug)]
struct Bound {
    resources: [Resource; 7],
    group: BindGroup,
}

/// Bound as long as it stays the same.
#[derive(Clone, Debug, PartialEq)]
enum Resource {
    Buffer(Buffer),
    View(TextureView),
}

impl Resource {
    fn binding(&self) -> BindingResource<'_> {
        match self {
            Self::Buffer(buffer) => buffer.as_entire_binding(),
            Self::View(view) => BindingResource::TextureView(view),
        }
    }
}

impl Compose {
    /// Compiles the shader.
    pub fn new(device: &Device) -> Result<Self> {
        let look = BufferDescriptor {
            label: Some("look"),
            size: size_of::<Look>() as u64,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        };
        guarded(device, || {
            Ok(Self {
                shading: Shading::new(device),
                look: device.create_buffer(&look),
                pipelines: HashMap::new(),
                pipeline: None,
                bound: None,
            })
        })
    }

    /// Makes ready to draw the light last recorded on such a target: a format, or a [`Target`] where
    /// the host's pass has depth or several samples. Before the first frame of `lighting` there is
    /// nothing to draw, which is no error.
    pub fn prepare(
        &mut self,
        device: &Device,
        queue: &Queue,
        lighting: &Lighting,
        target: impl Into<Target>,
        shown: &Shown,
    ) -> Result<()> {
        shown.display.check()?;
        let target = target.into();
        let Some(encode) = encodes(target.format) else {
            let problem =
                format!("has the format {:?}, which no picture is drawn to", target.format);
            return Err(Error::Texture { name: "target", problem });
        };
        let Some(lit) = lighting.lit() else {
            self.bound = None;
            return Ok(());
        };
        // Never read.
        let nothing = &lit.textures.albedo;
        let (color_from, color) = match shown.color {
            Color::White => (0, nothing),
            Color::Cells(view) => (1, view),
            Color::View(view) => (2, view),
            Color::Target(view) => (3, view),
        };
        let of_cells = |name, view: &TextureView| match matter::readable(name, view)? {
            size if size == lit.size => Ok(()),
            [w, h] => {
                let [width, height] = lit.size;
                let problem = format!("is {w}×{h}, but the grid is {width}×{height}");
                Err(Error::Texture { name, problem })
            }
        };
        match color_from {
            1 => of_cells("color", color)?,
            _ => {
                matter::readable("color", color)?;
            }
        }
        if let Some(glow) = shown.glow {
            matter::readable("glow", glow)?;
        }
        if let Some(more) = shown.more {
            of_cells("more", more)?;
        }
        if !shown.ambient.iter().all(|v| v.is_finite() && *v >= 0.0) {
            let [r, g, b] = shown.ambient;
            let found = format!("[{r}, {g}, {b}]");
            return Err(lamplight::Error::value("ambient", found, "finite and 0 or more").into());
        }
        let mut look = Look::new(&shown.display, lit.size);
        if matches!(target.format, TextureFormat::Rgba16Float | TextureFormat::Rg11b10Ufloat) {
            look.keep_finite();
        }
        look.filter_light = (shown.filter == Filter::Linear).into();
        look.color_from = color_from;
        look.keep_alpha = (color_from == 3).into();
        look.color_glows = shown.glow.is_some().into();
        look.more_light = shown.more.is_some().into();
        look.ambient = shown.ambient;
        if let Some(window) = shown.window {
            (look.corner, look.right, look.down) = (window.corner, window.right, window.down);
        }
        queue.write_buffer(&self.look, 0, bytemuck::bytes_of(&look));

        if !self.pipelines.contains_key(&target) {
            let made = guarded(device, || Ok(self.shading.pipeline(device, target, encode)))?;
            self.pipelines.insert(target, made);
        }
        self.pipeline = self.pipelines.get(&target).cloned();
        let resources = [
            Resource::Buffer(lit.frame.clone()),
            Resource::Buffer(lit.light.clone()),
            Resource::View(lit.textures.emission.clone()),
            Resource::View(lit.textures.tint_opacity.clone()),
            Resource::View(color.clone()),
            Resource::View(shown.glow.unwrap_or(nothing).clone()),
            Resource::View(shown.more.unwrap_or(nothing).clone()),
        ];
        if self.bound.as_ref().is_none_or(|bound| bound.resources != resources) {
            let group = guarded(device, || Ok(self.bind(device, &resources)))?;
            self.bound = Some(Bound { resources, group });
        }
        Ok(())
    }

    fn bind(&self, device: &Device, [frame, rest @ ..]: &[Resource; 7]) -> BindGroup {
        let look = self.look.as_entire_binding();
        let all = [frame.binding(), look].into_iter().chain(rest.iter().map(Resource::binding));
        let entries: Vec<_> = (0..)
            .zip(all)
            .map(|(binding, resource)| BindGroupEntry { binding, resource })
            .collect();
        device.create_bind_group(&BindGroupDescriptor {
            label: Some("display"),
            layout: &self.shading.layout,
            entries: &entries,
        })
    }

    /// Draws over the viewport of the host's pass; nothing before the first [`Self::prepare`].
    pub fn draw(&self, pass: &mut RenderPass) {
        let (Some(pipeline), Some(bound)) = (&self.pipeline, &self.bound) else { return };
        pass.push_debug_group("lamplight display");
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &bound.group, &[]);
        pass.draw(0..3, 0..1);
        pass.pop_debug_group();
    }

    /// Draws over all of a view, in a pass of its own; black before the first [`Self::prepare`].
    pub fn record(&self, encoder: &mut CommandEncoder, view: &TextureView) {
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some("lamplight display"),
            color_attachments: &[Some(RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: Operations { load: LoadOp::Clear(Clear::BLACK), store: StoreOp::Store },
            })],
            ..RenderPassDescriptor::default()
        });
        self.draw(&mut pass);
    }
}
