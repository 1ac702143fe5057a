//! Before the main pass: matter on each camera's grid, and its light.

use super::extract::Extracted;
use super::lit_view::{LitView, LitViews, Target};
use super::pictures::PictureBindings;
use super::stage::{On, Pipelines};
use crate::placement::{MOST_CELLS, Placement};
use bevy::ecs::system::SystemParam;
use bevy::prelude::{Commands, Component, Entity, Query, Res, ResMut, With};
use bevy::render::camera::ExtractedCamera;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_asset::RenderAssets;
use bevy::render::renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery};
use bevy::render::texture::GpuImage;
use lamplight_wgpu::Window;
use lamplight_wgpu::wgpu::{
    self, Color, CommandEncoder, LoadOp, Operations, RenderPassColorAttachment,
    RenderPassDescriptor, StoreOp, TextureView,
};

/// The light of a camera, on its entity in the render world, from the preparation of bind groups on
/// ([`LightTexture2d`](crate::LightTexture2d)): linear RGB and 1 a cell, `Rgba16Float`. It holds the
/// frame's light once the passes before the main pass have run; of spots only where the method lights
/// lamps by rule.
#[derive(Component, Clone, Debug)]
pub struct ViewLightTexture {
    /// The texture.
    pub view: TextureView,
    /// What of it is seen, in cells.
    pub window: Window,
    /// World units a cell.
    pub cell: f32,
    /// The place in the world of its left and top.
    pub corner: bevy::math::Vec2,
}

/// What every device with compute shaders has.
const STORAGE_BUFFERS: u32 = 8;

/// What drawing needs of the engine.
#[derive(SystemParam)]
pub struct Engine<'w> {
    device: Res<'w, RenderDevice>,
    queue: Res<'w, RenderQueue>,
    images: Res<'w, RenderAssets<GpuImage>>,
    pipelines: Option<Res<'w, Pipelines>>,
}

/// Makes ready what is recorded later.
pub fn prepare(
    mut commands: Commands,
    engine: Engine,
    extracted: Res<Extracted>,
    mut lit_views: ResMut<LitViews>,
    mut pictures: ResMut<PictureBindings>,
    cameras: Query<&ExtractedCamera>,
    textures: Query<Entity, With<ViewLightTexture>>,
) {
    let Engine { device, queue, images, pipelines } = engine;
    let (device, queue): (_, &wgpu::Queue) = (device.wgpu_device(), &queue.0);
    for entity in &textures {
        commands.entity(entity).remove::<ViewLightTexture>();
    }
    let LitViews { views: lit_views, told } = &mut *lit_views;
    lit_views.retain(|&entity, _| extracted.views.iter().any(|view| view.entity == entity));
    for &(camera, why) in &extracted.misplaced {
        told.problem(camera, why);
    }
    if extracted.views.is_empty() {
        return;
    }
    if device.limits().max_storage_buffers_per_shader_stage < STORAGE_BUFFERS {
        for view in &extracted.views {
            told.problem(view.camera, "this device has no compute shaders, as under WebGL 2");
        }
        return;
    }
    let Some(pipelines) = pipelines else {
        commands.insert_resource(Pipelines::new(device));
        return;
    };
    pictures.sweep(&images);
    for view in &extracted.views {
        let Ok(camera) = cameras.get(view.entity) else { continue };
        let (Some(size), Some(viewport)) =
            (camera.physical_target_size, camera.physical_viewport_size)
        else {
            continue;
        };
        let Placement { cell, asked, .. } = view.placement;
        if cell > asked {
            told.advice(
                view.camera,
                format_args!(
                    "its cells have {cell} world units instead of {asked}: there would be more than \
                     {MOST_CELLS} of them. Larger cells (`CellSize`) or a smaller `border` spare this"
                ),
            );
        }
        let target = Target { size: size.to_array(), viewport: viewport.to_array() };
        let known = lit_views.remove(&view.entity);
        let prepared = match known {
            Some(known) => Ok(known),
            None => LitView::new(device, queue, &pipelines, view),
        }
        .and_then(|mut lit| {
            lit.prepare(device, queue, &pipelines, view, &extracted.surroundings, target)?;
            Ok(lit)
        });
        match prepared {
            Ok(lit) => {
                for batch in &lit.draw.batches {
                    pictures.bind(device, &pipelines, batch.image, &images);
                }
                if let Some(texture) = &lit.texture {
                    let placement = &view.placement;
                    commands.entity(view.entity).insert(ViewLightTexture {
                        view: texture.clone(),
                        window: placement.placed.window,
                        cell: placement.cell,
                        corner: placement.corner(),
                    });
                }
                lit_views.insert(view.entity, lit);
            }
            // The camera's picture stays as it is.
            Err(problem) => told.problem(view.camera, problem),
        }
    }
}

/// Draws matter and records its light.
pub fn record(
    view: ViewQuery<Entity>,
    mut lit_views: ResMut<LitViews>,
    pictures: Res<PictureBindings>,
    pipelines: Option<Res<Pipelines>>,
    mut context: RenderContext,
) {
    let (Some(lit), Some(pipelines)) = (lit_views.views.get_mut(&view.into_inner()), pipelines)
    else {
        return;
    };
    let diagnostics = context.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let encoder = context.command_encoder();
    let span = diagnostics.time_span(encoder, "lamplight matter");
    draw_matter(lit, &pipelines, &pictures, encoder);
    span.end(encoder);
    let span = diagnostics.time_span(encoder, "lamplight light");
    lit.budget.record(&lit.lighting, encoder);
    if let Some(spots) = &lit.spots {
        spots.lighting.record(encoder);
    }
    span.end(encoder);
}

fn draw_matter(
    lit: &LitView,
    pipelines: &Pipelines,
    pictures: &PictureBindings,
    encoder: &mut CommandEncoder,
) {
    let grid = &lit.grid;
    // Nothing, but that tint lets all through.
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
    lit.staged.draw(&mut pass, &pipelines.matter, &lit.draw, pictures, On::Grid);
    drop(pass);
    let matter = grid
        .matter
        .each_ref()
        .map(|view| Some(attachment(view, LoadOp::Clear(Color::TRANSPARENT))));
    let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
        label: Some("lamplight settle"),
        color_attachments: &matter,
        ..RenderPassDescriptor::default()
    });
    pass.set_pipeline(&pipelines.settle);
    pass.set_bind_group(0, &grid.sums_group, &[]);
    pass.draw(0..3, 0..1);
}

/// All of a texture, drawn on.
pub fn attachment(view: &TextureView, load: LoadOp<Color>) -> RenderPassColorAttachment<'_> {
    RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: Operations { load, store: StoreOp::Store },
    }
}
