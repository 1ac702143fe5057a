//! Drawing light × colour, exposed and tone mapped, on the host's target.

use crate::camera::VisibleRect;
use crate::draw_program::Target;
use crate::error::{CreateError, PrepareError, RecordError, Result};
use crate::error_scope::with_error_scope;
use crate::stages::display::{ComposeUniforms, Drawn, Shading, encodes, tonemap_number};
use crate::{Lighting, matter};
use lamplight::Display;
use std::collections::HashMap;
use wgpu::{
    BindGroup, BindingResource, Buffer, BufferDescriptor, BufferUsages, Color as Clear,
    CommandEncoder, Device, LoadOp, Operations, Queue, RenderPass, RenderPassColorAttachment,
    RenderPassDescriptor, RenderPipeline, StoreOp, TextureFormat, TextureView,
};

/// The filter for a target whose pixels are smaller than the grid's cells, or lie between them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Filter {
    /// Each pixel shows the cell it lies in, as `--scale` of the command line does.
    #[default]
    Nearest,
    /// Each pixel shows the bilinear mean of the four nearest cells: smooth, and light follows a camera that
    /// moves by fractions of a cell. Four times the reads.
    Linear,
}

/// The colour that the light falls on: views of two-dimensional textures in any float or normalised format,
/// with the usage `TEXTURE_BINDING`. Linear, an sRGB format decodes by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Color<'a> {
    /// White: the light alone.
    #[default]
    White,
    /// One texel per cell, as large as the grid; filtered with the light.
    Cells(&'a TextureView),
    /// A picture that covers the visible part, of any size: the host's own frame at the target's
    /// resolution. Each pixel takes the texel it lies in.
    View(&'a TextureView),
    /// A picture as large as the target: each pixel takes its own texel, and its alpha. The host's own
    /// frame, whatever part of the target is drawn on.
    Target(&'a TextureView),
}

/// The parameters of the compose pass.
#[derive(Clone, Copy, Debug, Default)]
pub struct ComposeParams<'a> {
    /// Ambient light, relief, exposure and tone map.
    pub display: Display,
    /// Filter between cells.
    pub filter: Filter,
    /// The colour that the light falls on.
    pub color: Color<'a>,
    /// Emission of the colour itself, `colour × (light + emission)`, instead of that of cells: a picture as
    /// large as the target, as [`Color::Target`]. Emitters then have edges as fine as the target's pixels.
    pub emission: Option<&'a TextureView>,
    /// Light in addition to the grid's, one texel per cell: the output of another [`Lighting`]
    /// ([`crate::FrameInput::output`]).
    pub more: Option<&'a TextureView>,
    /// The normals of the colour, in a picture that lies as `color` does: on cells if that is [`Color::White`] or
    /// [`Color::Cells`]. Unit vectors with x along the grid's rows, y down its columns (also where `visible` is
    /// rotated) and z towards the viewer, in a format with a sign such as `Rgba8Snorm`; a texel of length 0 is not
    /// tilted. Without it those of the cells that were lit count. `ambient` is the same on every normal.
    /// The light needs its first moment ([`lamplight::Settings::moment`]).
    pub normals: Option<&'a TextureView>,
    /// The part of the grid that fills the target's viewport, as [`crate::Camera2dView::place`] returns it;
    /// `None`: all of it.
    pub visible: Option<VisibleRect>,
}

/// Draws the light of a [`Lighting`] on the host's targets, with the same pixels as the library's
/// [`lamplight::Light::compose`] up to rounding (one 8-bit step).
///
/// The target's format decides about sRGB: formats that encode by themselves (`…UnormSrgb`) receive linear
/// light, other normalised ones encoded light. Float formats receive linear tone-mapped light: 0 to 1, or
/// without a tone map the full range, for a host that has its own.
///
/// A pipeline is compiled for each kind of target, of parameters and of tone map when it is first used. One `Compose`
/// shows one frame at a time: a split screen needs one per part.
///
/// ```no_run
/// # use lamplight_wgpu::{Compose, ComposeParams, Error, Lighting, wgpu};
/// # fn show(lighting: &Lighting, compose: &mut Compose, encoder: &mut wgpu::CommandEncoder,
/// #         screen: &wgpu::TextureView) -> Result<(), Error> {
/// // After `lighting.prepare` and `lighting.record`:
/// compose.prepare(lighting, screen.texture().format(), &ComposeParams::default())?;
/// compose.record(encoder, screen)?; // or `compose.draw(&mut pass)` in a pass of the host's
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Compose {
    device: Device,
    queue: Queue,
    shading: Shading,
    uniforms: Buffer,
    pipelines: HashMap<Drawn, RenderPipeline>,
    pipeline: Option<RenderPipeline>,
    bound: Option<BoundGroup>,
}

/// A bind group and its resources.
#[derive(Debug)]
struct BoundGroup {
    resources: [Resource; 9],
    group: BindGroup,
}

/// A resource that is bound as long as it stays the same.
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
    pub fn new(device: &Device, queue: &Queue) -> Result<Self, CreateError> {
        let uniforms = BufferDescriptor {
            label: Some("compose uniforms"),
            size: size_of::<ComposeUniforms>() as u64,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        };
        with_error_scope(device, || {
            Ok(Self {
                device: device.clone(),
                queue: queue.clone(),
                shading: Shading::new(device),
                uniforms: device.create_buffer(&uniforms),
                pipelines: HashMap::new(),
                pipeline: None,
                bound: None,
            })
        })
    }

    /// Prepares to draw the light recorded last on a target: a format, or a [`Target`] if the host's pass has
    /// depth or several samples.
    ///
    /// # Errors
    /// [`PrepareError::NothingLit`] before the first frame of `lighting`, and others if the target or the
    /// parameters are invalid.
    pub fn prepare(
        &mut self,
        lighting: &Lighting,
        target: impl Into<Target>,
        params: &ComposeParams,
    ) -> Result<()> {
        params.display.check()?;
        let target = target.into();
        let Some(encodes) = encodes(target.format) else {
            let problem =
                format!("has the format {:?}, which no picture is drawn to", target.format);
            return Err(PrepareError::Texture { name: "target", problem });
        };
        let lit = lighting.compose_inputs().ok_or(PrepareError::NothingLit)?;
        // Bound where nothing is read.
        let nothing = &lit.textures.albedo;
        let (color_from, color) = match params.color {
            Color::White => (0, nothing),
            Color::Cells(view) => (1, view),
            Color::View(view) => (2, view),
            Color::Target(view) => (3, view),
        };
        let of_cells = |name, view: &TextureView| {
            matter::check_size(name, matter::readable(name, view)?, "the grid", lit.size)
        };
        if let Color::Cells(color) = params.color {
            of_cells("color", color)?;
        } else {
            matter::readable("color", color)?;
        }
        if let Some(emission) = params.emission {
            matter::readable("emission", emission)?;
        }
        if let Some(more) = params.more {
            of_cells("more", more)?;
        }
        let (normals, normals_of) = match (params.normals, params.color) {
            (Some(normals), Color::White | Color::Cells(_)) => {
                of_cells("normals", normals)?;
                (Some(normals), 1)
            }
            (Some(normals), Color::View(_) | Color::Target(_)) => {
                matter::readable("normals", normals)?;
                (Some(normals), 2)
            }
            (None, _) => (lit.normals, 1),
        };
        let normals = normals.filter(|_| lit.elevation.is_some());
        if params.normals.is_some() && lit.elevation.is_none() {
            let problem = "need the first moment of light: set `Settings::moment`".to_owned();
            return Err(PrepareError::Texture { name: "normals", problem });
        }
        let drawn = Drawn {
            target,
            encodes,
            tonemap: tonemap_number(params.display.tonemap)?,
            is_filtered: params.filter == Filter::Linear,
            color_from,
            color_emits: params.emission.is_some(),
            more_light: params.more.is_some(),
            has_shown: lit.shown.is_some(),
            normals: if normals.is_some() { normals_of } else { 0 },
            shines: params.display.relief.specular != 0.0,
        };
        let mut uniforms = ComposeUniforms::new(&params.display, lit.elevation, lit.size);
        if matches!(target.format, TextureFormat::Rgba16Float | TextureFormat::Rg11b10Ufloat) {
            uniforms.keep_finite();
        }
        if let Some(VisibleRect { corner, right, down }) = params.visible {
            (uniforms.corner, uniforms.right, uniforms.down) = (corner, right, down);
        }
        self.queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&uniforms));

        if !self.pipelines.contains_key(&drawn) {
            let compile = || Ok(self.shading.pipeline(&self.device, drawn));
            let compiled = with_error_scope::<_, PrepareError>(&self.device, compile)?;
            self.pipelines.insert(drawn, compiled);
        }
        self.pipeline = self.pipelines.get(&drawn).cloned();
        let resources = [
            Resource::Buffer(lit.frame.clone()),
            match lit.light_texture {
                Some(light) => Resource::View(light.clone()),
                None => Resource::Buffer(lit.light.clone()),
            },
            Resource::View(lit.textures.emission.clone()),
            Resource::View(lit.textures.tint_opacity.clone()),
            Resource::View(color.clone()),
            Resource::View(params.emission.unwrap_or(nothing).clone()),
            Resource::View(params.more.unwrap_or(nothing).clone()),
            Resource::View(lit.shown.unwrap_or(nothing).clone()),
            Resource::View(normals.unwrap_or(nothing).clone()),
        ];
        if self.bound.as_ref().is_none_or(|bound| bound.resources != resources) {
            let bind = || Ok(self.bind(&resources));
            let group = with_error_scope::<_, PrepareError>(&self.device, bind)?;
            self.bound = Some(BoundGroup { resources, group });
        }
        Ok(())
    }

    fn bind(&self, [frame, rest @ ..]: &[Resource; 9]) -> BindGroup {
        let uniforms = self.uniforms.as_entire_binding();
        let all = [frame.binding(), uniforms].into_iter().chain(rest.iter().map(Resource::binding));
        self.shading.bind(&self.device, all)
    }

    /// Draws over the viewport of the host's pass.
    ///
    /// # Errors
    /// Returns [`RecordError::NotPrepared`] before the first successful [`Self::prepare`].
    pub fn draw(&self, pass: &mut RenderPass) -> Result<(), RecordError> {
        let (Some(pipeline), Some(bound)) = (&self.pipeline, &self.bound) else {
            return Err(RecordError::NotPrepared);
        };
        pass.push_debug_group("lamplight display");
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &bound.group, &[]);
        pass.draw(0..3, 0..1);
        pass.pop_debug_group();
        Ok(())
    }

    /// Draws over all of a view, in a pass of its own. The view is cleared first.
    ///
    /// # Errors
    /// Returns [`RecordError::NotPrepared`] before the first successful [`Self::prepare`].
    pub fn record(
        &self,
        encoder: &mut CommandEncoder,
        view: &TextureView,
    ) -> Result<(), RecordError> {
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
        self.draw(&mut pass)
    }
}
