//! Lighting before the main pass: matter on each camera's grid, then its light. Where the CPU finds the light, both
//! happen while the frame is prepared.

use super::backend::LightBackend;
use super::draw::DrawList;
use super::extract::ExtractedLighting;
use super::image_bindings::ImageBindings;
use super::lit_view::{CameraTarget, LitView, LitViews};
use super::pipelines::{Pipelines, QuadPass};
use crate::placement::{MAX_CELLS, Placement};
use bevy::ecs::system::SystemParam;
use bevy::log::error_once;
use bevy::platform::collections::hash_map::Entry;
use bevy::prelude::{Commands, Component, Entity, Query, Res, ResMut, With};
use bevy::render::camera::ExtractedCamera;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_asset::RenderAssets;
use bevy::render::renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery};
use bevy::render::texture::GpuImage;
use bevy::render::view::ResolvedCompositingSpace;
use lamplight_wgpu::wgpu::{
    self, Color, CommandEncoder, LoadOp, Operations, RenderPassColorAttachment,
    RenderPassDescriptor, StoreOp, TextureView,
};
use lamplight_wgpu::{Backend, VisibleRect};

/// The light of a camera with [`LightTexture2d`](crate::LightTexture2d), on its entity in the render
/// world: linear RGB and 1 per cell, `Rgba16Float`.
///
/// The component exists from `RenderSystems::PrepareBindGroups` on, and the texture holds the frame's
/// light once the passes before the main pass have run.
#[derive(Component, Clone, Debug)]
pub struct ViewLightTexture {
    /// The texture.
    pub view: TextureView,
    /// The part that the camera sees, in cells.
    pub window: VisibleRect,
    /// World units per cell.
    pub cell: f32,
    /// The place in the world of its top left corner.
    pub corner: bevy::math::Vec2,
}

/// The resources of Bevy that drawing needs.
#[derive(SystemParam)]
pub struct RenderResources<'w> {
    device: Res<'w, RenderDevice>,
    queue: Res<'w, RenderQueue>,
    images: Res<'w, RenderAssets<GpuImage>>,
    pipelines: Option<Res<'w, Pipelines>>,
    backend: Res<'w, LightBackend>,
}

/// Makes the pipelines for the first lit camera, in its first frame.
pub fn make_pipelines(
    mut commands: Commands,
    device: Res<RenderDevice>,
    extracted: Res<ExtractedLighting>,
    pipelines: Option<Res<Pipelines>>,
) {
    if pipelines.is_none() && !extracted.views.is_empty() {
        commands.insert_resource(Pipelines::new(device.wgpu_device()));
    }
}

/// Prepares the light of every camera.
pub fn prepare(
    mut commands: Commands,
    resources: RenderResources,
    extracted: Res<ExtractedLighting>,
    mut lit_views: ResMut<LitViews>,
    mut bindings: ResMut<ImageBindings>,
    cameras: Query<(&ExtractedCamera, Option<&ResolvedCompositingSpace>)>,
    textures: Query<Entity, With<ViewLightTexture>>,
) {
    let RenderResources { device, queue, images, pipelines, backend } = resources;
    let (device, queue): (_, &wgpu::Queue) = (device.wgpu_device(), &queue);
    for entity in &textures {
        commands.entity(entity).remove::<ViewLightTexture>();
    }
    let LitViews { views: lit_views, compiled, log } = &mut *lit_views;
    lit_views.retain(|entity, _| extracted.cameras.contains(entity));
    lit_views.values_mut().for_each(|lit| lit.is_lit = false);
    for &(camera, error) in &extracted.failed {
        log.error(camera, error);
    }
    bindings.sweep(&images);
    let Some(pipelines) = pipelines else { return };
    for view in &extracted.views {
        let Ok((camera, compositing)) = cameras.get(view.entity) else { continue };
        let (Some(size), Some(viewport)) =
            (camera.physical_target_size, camera.physical_viewport_size)
        else {
            continue;
        };
        let Placement { cell, requested, .. } = view.placement;
        if cell > requested {
            log.warn(
                view.camera,
                format_args!(
                    "its cells have {cell} world units instead of {requested}: there would be more than \
                     {MAX_CELLS} of them. Larger cells (`CellSize`) or a smaller `border` spare this"
                ),
            );
        }
        if ResolvedCompositingSpace::space(compositing).is_some() {
            let message =
                "light multiplies linear colours: its `CompositingSpace` has to be `Linear`";
            log.error(view.camera, message);
            continue;
        }
        let target = CameraTarget { size: size.to_array(), viewport: viewport.to_array() };
        // Nothing is made for values that are errors.
        if let Err(error) = view.display().check() {
            log.error(view.camera, error);
            continue;
        }
        let lit = match lit_views.entry(view.entity) {
            Entry::Occupied(lit) => lit.into_mut(),
            Entry::Vacant(place) => {
                match LitView::new(device, queue, *backend, &pipelines, view, compiled) {
                    Ok(lit) => place.insert(lit),
                    Err(error) => {
                        log.error(view.camera, error);
                        continue;
                    }
                }
            }
        };
        let mut prepare = || {
            lit.prepare_matter(device, queue, &pipelines, view, &extracted, target)?;
            let DrawList { batches, lamp_batches, surface_batches, mask_batches, .. } = &lit.draw;
            let all = [batches, lamp_batches, surface_batches, mask_batches];
            for batch in all.into_iter().flatten() {
                for image in std::iter::once(batch.image).chain(batch.normals) {
                    bindings.bind(device, &pipelines, image, &images);
                }
            }
            lit.is_drawn = lit.lighting.backend() == Backend::Cpu;
            if lit.is_drawn {
                let mut encoder = device.create_command_encoder(&Default::default());
                draw_matter(lit, &pipelines, &bindings, device, &mut encoder);
                queue.submit([encoder.finish()]);
            }
            lit.prepare_light(view)
        };
        // On an error the camera's picture stays as it is.
        if let Err(error) = prepare() {
            log.error(view.camera, error);
            continue;
        }
        lit.is_lit = true;
        if let Some(texture) = &lit.texture {
            let placement = &view.placement;
            commands.entity(view.entity).insert(ViewLightTexture {
                view: texture.clone(),
                window: placement.placed.visible,
                cell: placement.cell,
                corner: placement.corner(),
            });
        }
    }
}

/// Draws matter and records its light.
pub fn record(
    view: ViewQuery<Entity>,
    mut lit_views: ResMut<LitViews>,
    images: Res<ImageBindings>,
    pipelines: Option<Res<Pipelines>>,
    device: Res<RenderDevice>,
    mut context: RenderContext,
) {
    let lit = lit_views.views.get_mut(&view.into_inner()).filter(|lit| lit.is_lit);
    let (Some(lit), Some(pipelines)) = (lit, pipelines) else { return };
    let diagnostics = context.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let encoder = context.command_encoder();
    if !lit.is_drawn {
        let span = diagnostics.time_span(encoder, "lamplight matter");
        draw_matter(lit, &pipelines, &images, device.wgpu_device(), encoder);
        span.end(encoder);
    }
    let span = diagnostics.time_span(encoder, "lamplight light");
    if let Err(error) = lit.budget.record(&lit.lighting, encoder) {
        error_once!("{error}");
    }
    span.end(encoder);
}

/// Draws the matter on the grid, and its light layers.
fn draw_matter(
    lit: &LitView,
    pipelines: &Pipelines,
    images: &ImageBindings,
    device: &wgpu::Device,
    encoder: &mut CommandEncoder,
) {
    let grid = &lit.grid;
    let with = (device, pipelines);
    // Empty space: nothing emits, scatters or absorbs.
    let [emission, albedo, tint, opacity] = &grid.sums;
    let sums = [
        (emission, Color::TRANSPARENT),
        (albedo, Color::TRANSPARENT),
        (tint, Color::WHITE),
        (opacity, Color::TRANSPARENT),
    ]
    .map(|(view, color)| Some(attachment(view, LoadOp::Clear(color))));
    let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
        label: Some("lamplight matter"),
        color_attachments: &sums,
        ..RenderPassDescriptor::default()
    });
    lit.quads.draw(&mut pass, with, QuadPass::Matter, &lit.draw.batches, images);
    drop(pass);
    if let Some(lamps) = &grid.lamps {
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some("lamplight lamps"),
            color_attachments: &[Some(attachment(lamps, LoadOp::Clear(Color::TRANSPARENT)))],
            ..RenderPassDescriptor::default()
        });
        let batches = &lit.draw.lamp_batches;
        lit.quads.draw(&mut pass, with, QuadPass::Lamps, batches, images);
    }
    let matter = grid
        .matter
        .each_ref()
        .map(|view| Some(attachment(view, LoadOp::Clear(Color::TRANSPARENT))));
    let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
        label: Some("lamplight resolve"),
        color_attachments: &matter,
        ..RenderPassDescriptor::default()
    });
    pass.set_pipeline(&pipelines.resolve);
    pass.set_bind_group(0, &grid.sums_group, &[]);
    pass.draw(0..3, 0..1);
    drop(pass);
    draw_masks(lit, pipelines, images, device, encoder);
}

/// Draws the light layers of cells. What has none is in all of them.
fn draw_masks(
    lit: &LitView,
    pipelines: &Pipelines,
    images: &ImageBindings,
    device: &wgpu::Device,
    encoder: &mut CommandEncoder,
) {
    let Some(masks) = &lit.grid.masks else { return };
    let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
        label: Some("lamplight masks"),
        color_attachments: &[Some(attachment(masks, LoadOp::Clear(Color::WHITE)))],
        ..RenderPassDescriptor::default()
    });
    let batches = &lit.draw.mask_batches;
    lit.quads.draw(&mut pass, (device, pipelines), QuadPass::Masks, batches, images);
}

/// A colour attachment that is stored.
pub fn attachment(view: &TextureView, load: LoadOp<Color>) -> RenderPassColorAttachment<'_> {
    RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: Operations { load, store: StoreOp::Store },
    }
}
