//! After the main pass: the camera's picture × its light, then what is not lit, before bloom and tone
//! map.

use super::extract::Extracted;
use super::light::attachment;
use super::lit_view::LitViews;
use super::pictures::PictureBindings;
use super::stage::{On, Pipelines};
use super::unlit::Unlit;
use crate::components::LightFilter;
use bevy::core_pipeline::core_2d::CORE_2D_DEPTH_FORMAT;
use bevy::prelude::{Entity, Res, ResMut, World};
use bevy::render::camera::ExtractedCamera;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::RenderPassDescriptor;
use bevy::render::renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery};
use bevy::render::view::{ExtractedView, Msaa, ViewDepthTexture, ViewTarget};
use lamplight::Display;
use lamplight_wgpu::wgpu::util::TextureBlitter;
use lamplight_wgpu::wgpu::{
    self, Color as Clear, LoadOp, Operations, RenderPassDepthStencilAttachment, StoreOp,
};
use lamplight_wgpu::{Color, Filter, Shown, Target};

/// Draws what glows, and binds what is about to be lit.
pub fn prepare(
    view: ViewQuery<(Entity, &ExtractedCamera, &ViewTarget, &Msaa)>,
    extracted: Res<Extracted>,
    mut lit_views: ResMut<LitViews>,
    pictures: Res<PictureBindings>,
    pipelines: Option<Res<Pipelines>>,
    (device, queue): (Res<RenderDevice>, Res<RenderQueue>),
    mut context: RenderContext,
) {
    let (entity, camera, target, msaa) = view.into_inner();
    let own = extracted.views.iter().find(|view| view.entity == entity);
    let (Some(lit), Some(own), Some(pipelines)) =
        (lit_views.views.get_mut(&entity), own, pipelines)
    else {
        return;
    };
    if let Some(glow) = &lit.glow {
        let mut pass = context.command_encoder().begin_render_pass(&RenderPassDescriptor {
            label: Some("lamplight glow"),
            color_attachments: &[Some(attachment(glow, LoadOp::Clear(Clear::TRANSPARENT)))],
            ..RenderPassDescriptor::default()
        });
        if let Some(viewport) = &camera.viewport {
            let [x, y] = viewport.physical_position.to_array().map(|v| v as f32);
            let [width, height] = viewport.physical_size.to_array().map(|v| v as f32);
            pass.set_viewport(x, y, width, height, 0.0, 1.0);
        }
        lit.staged.draw(&mut pass, &pipelines.glow, &lit.draw, &pictures, On::Screen);
    }
    let shown = Shown {
        display: Display { tonemap: own.tone_map, exposure: own.lighting.exposure },
        filter: match own.lighting.filter {
            LightFilter::Linear => Filter::Linear,
            LightFilter::Nearest => Filter::Nearest,
        },
        color: Color::Target(target.main_texture_view()),
        glow: lit.glow.as_ref(),
        more: lit.spots.as_ref().map(|spots| &spots.light),
        ambient: own.ambient,
        window: Some(own.placement.placed.window),
    };
    let drawn_on = Target {
        format: target.main_texture_format(),
        samples: msaa.samples(),
        depth: Some(CORE_2D_DEPTH_FORMAT),
    };
    let (device, queue): (_, &wgpu::Queue) = (device.wgpu_device(), &queue.0);
    // Several samples keep it themselves.
    let keeps = camera.viewport.is_some() && drawn_on.samples == 1;
    lit.around = keeps.then(|| match lit.around.take() {
        Some((format, blitter)) if format == drawn_on.format => (format, blitter),
        _ => (drawn_on.format, TextureBlitter::new(device, drawn_on.format)),
    });
    if let Err(problem) = lit.compose.prepare(device, queue, &lit.lighting, drawn_on, &shown) {
        lit_views.told.problem(own.camera, problem);
        lit_views.views.remove(&entity);
    }
}

/// Draws the lit picture, and what is not lit over it.
pub fn record(
    world: &World,
    view: ViewQuery<(Entity, &ExtractedCamera, &ExtractedView, &ViewTarget, &ViewDepthTexture)>,
    lit_views: Res<LitViews>,
    unlit: Res<Unlit>,
    device: Res<RenderDevice>,
    mut context: RenderContext,
) {
    let (entity, camera, view, target, depth) = view.into_inner();
    let Some(lit) = lit_views.views.get(&entity) else { return };
    let diagnostics = context.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let swapped = target.post_process_write();
    if let Some((_, blitter)) = &lit.around {
        let (from, to) = (swapped.source, swapped.destination);
        blitter.copy(device.wgpu_device(), context.command_encoder(), from, to);
    }
    let attachments = [Some(target.get_color_attachment())];
    let mut pass = context.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("lamplight compose"),
        color_attachments: &attachments,
        // What is not lit lies above all that is.
        depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
            view: depth.view(),
            depth_ops: Some(Operations { load: LoadOp::Clear(0.0), store: StoreOp::Store }),
            stencil_ops: None,
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = diagnostics.pass_span(&mut pass, "lamplight compose");
    if let Some(viewport) = &camera.viewport {
        pass.set_camera_viewport(viewport);
    }
    lit.compose.draw(pass.wgpu_pass());
    unlit.draw(view.retained_view_entity, &mut pass, world, entity);
    span.end(&mut pass);
}
