//! The render world: matter drawn on each camera's grid, lit, and multiplied with its picture.
//!
//! | when | what | file |
//! | --- | --- | --- |
//! | the end of the main world's frame | the light that enters each camera's grid from around it | `../surroundings/` |
//! | extraction | lit cameras, the scene around them, surfaces if any has normals | `extract.rs` |
//! | prepare | each camera's quads, textures and settings | `draw.rs`, `lit_view.rs`, `image_bindings.rs` |
//! | before the main pass | matter on the grid, then its light | `light.rs`, `quad_buffers.rs`, `budget.rs` |
//! | after the main pass | glow and normals on the screen, the picture × its light, then everything unlit | `compose.rs`, `unlit.rs` |

mod backend;
mod budget;
mod compose;
mod draw;
mod extract;
mod image_bindings;
mod light;
mod lit_view;
mod pipelines;
mod quad_buffers;
mod unlit;

pub use backend::LightBackend;
pub use light::ViewLightTexture;

use crate::surroundings::{self, CameraSurroundings};
use bevy::app::{App, Last, Plugin};
use bevy::core_pipeline::{Core2d, Core2dSystems};
use bevy::prelude::{ExtractSchedule, IntoScheduleConfigs};
use bevy::render::{GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems};

/// The part of [`LamplightPlugin`](crate::LamplightPlugin) in the render world.
pub(crate) struct LightRenderPlugin;

impl Plugin for LightRenderPlugin {
    fn build(&self, _: &mut App) {}

    // Plugins may be added in any order, so the render app is looked up late.
    fn finish(&self, app: &mut App) {
        let backend = app.world().get_resource::<LightBackend>().copied().unwrap_or_default();
        // There is no render app on a headless server.
        if app.get_sub_app(RenderApp).is_none() {
            return;
        }
        app.init_resource::<CameraSurroundings>().add_systems(Last, surroundings::find);
        let Some(app) = app.get_sub_app_mut(RenderApp) else { return };
        app.insert_resource(backend)
            .init_resource::<extract::ExtractedLighting>()
            .init_gpu_resource::<lit_view::LitViews>()
            .init_gpu_resource::<image_bindings::ImageBindings>()
            .init_gpu_resource::<unlit::UnlitPhases>()
            .add_systems(RenderStartup, pipelines::forget)
            .add_systems(ExtractSchedule, (extract::extract, unlit::extract))
            .add_systems(
                Render,
                (
                    (light::make_pipelines, light::prepare)
                        .chain()
                        .in_set(RenderSystems::PrepareBindGroups),
                    unlit::partition.after(RenderSystems::PhaseSort).before(RenderSystems::Prepare),
                    unlit::hold_back
                        .after(RenderSystems::PrepareBindGroups)
                        .before(RenderSystems::Render),
                    unlit::restore.in_set(RenderSystems::Cleanup),
                ),
            )
            .add_systems(
                Core2d,
                (
                    light::record.before(Core2dSystems::MainPass),
                    (compose::prepare, compose::record)
                        .chain()
                        .after(Core2dSystems::MainPass)
                        .before(Core2dSystems::EarlyPostProcess),
                ),
            );
    }
}
