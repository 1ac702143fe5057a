//! Composition after the main pass and before bloom and tone mapping: the camera's picture times its
//! light, then everything unlit.

use super::extract::ExtractedLighting;
use super::image_bindings::ImageBindings;
use super::light::attachment;
use super::lit_view::LitViews;
use super::pipelines::{Pipelines, QuadPass};
use super::unlit::UnlitPhases;
use crate::components::LightFilter;
use bevy::core_pipeline::core_2d::CORE_2D_DEPTH_FORMAT;
use bevy::log::error_once;
use bevy::prelude::{Entity, Res, ResMut, World};
use bevy::render::camera::ExtractedCamera;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::RenderPassDescriptor;
use bevy::render::renderer::{RenderContext, RenderDevice, ViewQuery};
use bevy::render::view::{ExtractedView, Msaa, ViewDepthStencilTexture, ViewTarget};
use lamplight_wgpu::wgpu::util::TextureBlitter;
use lamplight_wgpu::wgpu::{
    Color as Clear, CommandEncoder, LoadOp, Operations, RenderPass,
    RenderPassDepthStencilAttachment, StoreOp, TextureView,
};
use lamplight_wgpu::{Color, ComposeParams, Filter, Target};

/// Draws emitted light and normals, and prepares the composition.
pub fn prepare(
    view: ViewQuery<(Entity, &ExtractedCamera, &ViewTarget, &Msaa)>,
    extracted: Res<ExtractedLighting>,
    mut lit_views: ResMut<LitViews>,
    images: Res<ImageBindings>,
    pipelines: Option<Res<Pipelines>>,
    device: Res<RenderDevice>,
    mut context: RenderContext,
) {
    let (entity, camera, target, msaa) = view.into_inner();
    let view = extracted.views.iter().find(|view| view.entity == entity);
    let LitViews { views: lit_views, log, .. } = &mut *lit_views;
    let lit = lit_views.get_mut(&entity).filter(|lit| lit.is_lit);
    let (Some(lit), Some(view), Some(pipelines)) = (lit, view, pipelines) else { return };
    let device = device.wgpu_device();
    if let Some(glow) = &lit.glow {
        let mut pass = screen_pass(context.command_encoder(), camera, "lamplight glow", glow);
        for batches in [&lit.draw.batches, &lit.draw.lamp_batches] {
            lit.quads.draw(&mut pass, (device, &pipelines), QuadPass::Glow, batches, &images);
        }
    }
    if let Some(normals) = &lit.normals {
        let mut pass = screen_pass(context.command_encoder(), camera, "lamplight normals", normals);
        let batches = &lit.draw.surface_batches;
        lit.quads.draw_normals(&mut pass, (device, &pipelines), batches, &images);
    }
    let params = ComposeParams {
        display: view.display(),
        filter: match view.lighting.filter {
            LightFilter::Linear => Filter::Linear,
            LightFilter::Nearest => Filter::Nearest,
        },
        color: Color::Target(target.main_texture_view()),
        emission: lit.glow.as_ref(),
        more: None,
        normals: lit.normals.as_ref(),
        visible: Some(view.placement.placed.visible),
    };
    let drawn_on = Target {
        format: target.main_texture_format(),
        samples: msaa.samples(),
        depth: Some(CORE_2D_DEPTH_FORMAT),
    };
    // A multisampled target preserves the parts of other cameras by itself.
    let has_neighbours = camera.viewport.is_some() && drawn_on.samples == 1;
    lit.neighbours = has_neighbours.then(|| match lit.neighbours.take() {
        Some((format, blitter)) if format == drawn_on.format => (format, blitter),
        _ => (drawn_on.format, TextureBlitter::new(device, drawn_on.format)),
    });
    if let Err(error) = lit.compose.prepare(&lit.lighting, drawn_on, &params) {
        log.error(view.camera, error);
        lit.is_lit = false;
    }
}

/// Begins a pass on a cleared texture as large as the target, over the camera's part of it.
fn screen_pass<'e>(
    encoder: &'e mut CommandEncoder,
    camera: &ExtractedCamera,
    label: &str,
    view: &TextureView,
) -> RenderPass<'e> {
    let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(attachment(view, LoadOp::Clear(Clear::TRANSPARENT)))],
        ..RenderPassDescriptor::default()
    });
    if let Some(viewport) = &camera.viewport {
        let [x, y] = viewport.physical_position.to_array().map(|v| v as f32);
        let [width, height] = viewport.physical_size.to_array().map(|v| v as f32);
        pass.set_viewport(x, y, width, height, 0.0, 1.0);
    }
    pass
}

/// Draws the lit picture, and everything unlit over it.
pub fn record(
    world: &World,
    view: ViewQuery<(
        Entity,
        &ExtractedCamera,
        &ExtractedView,
        &ViewTarget,
        &ViewDepthStencilTexture,
    )>,
    lit_views: Res<LitViews>,
    unlit: Res<UnlitPhases>,
    device: Res<RenderDevice>,
    mut context: RenderContext,
) {
    let (entity, camera, view, target, depth) = view.into_inner();
    let Some(lit) = lit_views.views.get(&entity).filter(|lit| lit.is_lit) else { return };
    let diagnostics = context.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let swapped = target.post_process_write();
    if let Some((_, blitter)) = &lit.neighbours {
        let (from, to) = (swapped.source, swapped.destination);
        blitter.copy(device.wgpu_device(), context.command_encoder(), from, to);
    }
    let attachments = [Some(target.get_color_attachment())];
    let mut pass = context.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("lamplight compose"),
        color_attachments: &attachments,
        // Everything unlit lies above everything lit.
        depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
            depth_ops: Some(Operations { load: LoadOp::Clear(0.0), store: StoreOp::Store }),
            ..depth.get_attachment(StoreOp::Store)
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = diagnostics.pass_span(&mut pass, "lamplight compose");
    if let Some(viewport) = &camera.viewport {
        pass.set_camera_viewport(viewport);
    }
    if let Err(error) = lit.compose.draw(pass.wgpu_pass()) {
        error_once!("{error}");
    }
    unlit.draw(view.retained_view_entity, &mut pass, world, entity);
    span.end(&mut pass);
}
