//! The render world: matter drawn on each camera's grid, lit, and laid over its picture.
//!
//! | when | what | file |
//! | --- | --- | --- |
//! | extraction | lit cameras, and what is around them | `extract.rs` |
//! | prepare | each camera's pieces, textures and settings | `draw.rs`, `lit_view.rs`, `pictures.rs` |
//! | before the main pass | matter on the grid, then its light | `light.rs`, `stage.rs`, `budget.rs` |
//! | after the main pass | the picture × its light, then what is not lit | `compose.rs`, `unlit.rs` |

mod budget;
mod compose;
mod draw;
mod extract;
mod light;
mod lit_view;
mod pictures;
mod stage;
mod unlit;

pub use light::ViewLightTexture;

use bevy::app::{App, Plugin};
use bevy::core_pipeline::{Core2d, Core2dSystems};
use bevy::prelude::{ExtractSchedule, IntoScheduleConfigs};
use bevy::render::{Render, RenderApp, RenderSystems};

/// What [`LamplightPlugin`](crate::LamplightPlugin) does in the render world.
pub(crate) struct LightRenderPlugin;

impl Plugin for LightRenderPlugin {
    fn build(&self, _: &mut App) {}

    // Whatever order plugins are added in.
    fn finish(&self, app: &mut App) {
        // A server has none.
        let Some(app) = app.get_sub_app_mut(RenderApp) else { return };
        app.init_resource::<extract::Extracted>()
            .init_resource::<lit_view::LitViews>()
            .init_resource::<pictures::PictureBindings>()
            .init_resource::<unlit::Unlit>()
            .add_systems(ExtractSchedule, (extract::extract, unlit::extract))
            .add_systems(
                Render,
                (
                    light::prepare.in_set(RenderSystems::PrepareBindGroups),
                    unlit::set_apart.after(RenderSystems::PhaseSort).before(RenderSystems::Prepare),
                    unlit::take_out
                        .after(RenderSystems::PrepareBindGroups)
                        .before(RenderSystems::Render),
                    unlit::put_back.in_set(RenderSystems::Cleanup),
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
