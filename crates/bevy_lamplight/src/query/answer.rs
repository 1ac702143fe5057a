//! The grid of light that queries read, and the system parameter that reads it.

use super::entering::EnteringLight;
use super::sight::QueriedSight;
use crate::camera_log::without_figures;
use crate::components::{LightMethod, LightQuality, Lighting2d, Viewer2d, WorldLamp};
use crate::cookies::{CookieImages, forget_changed};
use crate::lit_camera::LitCamera;
use crate::placement::{LATTICE, Placement, doubled};
use crate::quads::{ExtractedScene, Gather, GatherMasks, SceneAssets, VisibilityPropagates};
use crate::raster::{rasterize, rasterize_masks};
use crate::surroundings::{self, CameraSurroundings};
use bevy::app::{App, Last, Plugin};
use bevy::asset::AssetEvent;
use bevy::camera::visibility::{RenderLayers, VisibilityPlugin};
use bevy::color::LinearRgba;
use bevy::ecs::message::Messages;
use bevy::ecs::schedule::common_conditions::resource_exists;
use bevy::ecs::system::SystemParam;
use bevy::image::Image;
use bevy::log::{error, warn};
use bevy::math::{Rect, Vec2};
use bevy::prelude::{
    Entity, GlobalTransform, IntoScheduleConfigs, Local, Query, Reflect, ReflectResource, Res,
    ResMut, Resource,
};
use bevy::transform::TransformPlugin;
use lamplight::resample::downsample;
use lamplight::{Bounces, Cells, Lamp, Light, Settings, Sky, Solver};
use lamplight_wgpu::Camera2dView;
use std::sync::atomic::{AtomicBool, Ordering};

/// Answers [`LightQuery`] and [`SightQuery`](crate::SightQuery). It is part of [`LamplightPlugin`](crate::LamplightPlugin). On a server, where
/// nothing is drawn, it suffices together with Bevy's `TransformPlugin`.
pub struct LightQueryPlugin;

impl Plugin for LightQueryPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<LightQuerySettings>()
            .init_resource::<QueriedLight>()
            .init_resource::<QueriedSight>()
            .init_resource::<CookieImages>()
            // What has changed in a frame is sent before its last systems, which also find what enters grids.
            .add_systems(
                Last,
                (
                    forget_changed.run_if(resource_exists::<Messages<AssetEvent<Image>>>),
                    solve.after(forget_changed).after(surroundings::find),
                ),
            );
    }

    fn finish(&self, app: &mut App) {
        // A server has no `VisibilityPlugin`.
        if app.is_plugin_added::<VisibilityPlugin>() {
            app.init_resource::<VisibilityPropagates>();
        }
        if !app.is_plugin_added::<TransformPlugin>() {
            warn!(
                "without Bevy's `TransformPlugin` lamps and matter have no place for `LightQuery`"
            );
        }
    }

    fn is_unique(&self) -> bool {
        false
    }
}

/// Settings of [`LightQuery`] and [`SightQuery`](crate::SightQuery).
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
pub struct LightQuerySettings {
    /// World units per cell. Half the size costs four times as much. Walls down to half a cell wide are
    /// resolved.
    pub cell: f32,
    /// The area that can be queried. `None`: the grid of the first lit camera (by its `order`), or without one the
    /// bounds of all matter and of the ranges of all lamps. Into an area of its own, light enters from the sky alone.
    /// Areas of more than 131,072 cells get larger cells.
    pub area: Option<Rect>,
    /// Settings of the light. `None`: the preset `fast` of `holographic` with the bounces of the first lit
    /// camera, or that camera's own settings if its method is `polar` or `flood`, whose light differs. An answer is a
    /// single frame: instead of [`LightBounces::Feedback`](crate::LightBounces::Feedback) it has two bounces. What enters
    /// is what enters the camera's grid, by its own [`Lighting2d::surroundings`].
    pub lighting: Option<Lighting2d>,
    /// Layers that take part in light, if there is no lit camera. Otherwise, they are the camera's.
    #[reflect(ignore)]
    pub layers: RenderLayers,
}

impl Default for LightQuerySettings {
    fn default() -> Self {
        Self { cell: 4.0, area: None, lighting: None, layers: RenderLayers::default() }
    }
}

/// Queries the light at places of the world.
///
/// Light is computed at the end of each frame in which it was queried, and an answer is that of the last such frame: one
/// frame old if you query in every frame, and as old as the pause if you pause. The first query returns `None`.
///
/// ```
/// # use bevy::prelude::*; use bevy_lamplight::prelude::*;
/// # #[derive(Component)] struct Thief;
/// fn is_seen(light: LightQuery, thief: Single<&GlobalTransform, With<Thief>>) {
///     if light.level(thief.translation().truncate()).is_some_and(|level| level > 0.2) {
///         println!("the guards see you");
///     }
/// }
/// ```
#[derive(SystemParam)]
pub struct LightQuery<'w> {
    #[system_param(
        validation_message = "`LightQuery` needs `LamplightPlugin`, or `LightQueryPlugin` alone"
    )]
    light: Res<'w, QueriedLight>,
}

impl LightQuery<'_> {
    /// The light at a place of the world, linear. `None` outside of the known area.
    pub fn at(&self, place: Vec2) -> Option<LinearRgba> {
        let at = self.light.cell_at(place)?;
        Some(self.light.sum(|light| light.sample(at)))
    }

    /// The mean light over the open part of a box, or at its centre if its size is 0. `None` unless all of
    /// the box is in the known area.
    pub fn over(&self, area: Rect) -> Option<LinearRgba> {
        let area = Rect::from_corners(area.min, area.max);
        if area.is_empty() {
            return self.at(area.center());
        }
        let left_bottom = self.light.cell_at(area.min)?;
        let right_top = self.light.cell_at(area.max)?;
        let (min, max) = ([left_bottom[0], right_top[1]], [right_top[0], left_bottom[1]]);
        Some(self.light.sum(|light| light.over(min, max)))
    }

    /// The luminance of the light at a place. At 1, white is drawn white.
    pub fn level(&self, place: Vec2) -> Option<f32> {
        use bevy::color::Luminance;
        self.at(place).map(|light| light.luminance())
    }

    /// The known area; `None` before the first answer.
    pub fn area(&self) -> Option<Rect> {
        self.light.request();
        self.light.grid.map(|_| self.light.area)
    }
}

/// The light computed last.
#[derive(Resource, Default)]
pub struct QueriedLight {
    /// True if it was queried since then.
    is_requested: AtomicBool,
    /// The fine grid, on which matter is drawn.
    grid: Option<Placement>,
    /// The part of it whose light is known.
    area: Rect,
    light: Light,
    ambient: [f32; 3],
}

impl QueriedLight {
    /// Returns whether it was queried since the last time.
    fn take_request(&mut self) -> bool {
        std::mem::take(self.is_requested.get_mut())
    }

    fn request(&self) {
        self.is_requested.store(true, Ordering::Relaxed);
    }

    /// Converts a place of the world to cells.
    fn cell_at(&self, place: Vec2) -> Option<[f32; 2]> {
        self.request();
        let grid = self.grid.filter(|_| self.area.contains(place))?;
        let at = (place - grid.corner()) / (grid.cell * FINE_PER_CELL as f32);
        Some([at.x, -at.y])
    }

    fn sum(&self, light: impl Fn(&Light) -> [f32; 3]) -> LinearRgba {
        let own = light(&self.light);
        let [red, green, blue] = std::array::from_fn(|c| own[c] + self.ambient[c]);
        LinearRgba::rgb(red, green, blue)
    }
}

/// Buffers and solvers that are reused.
#[derive(Default)]
struct QueryState {
    scene: ExtractedScene,
    masks: ExtractedScene,
    fine: Option<Cells>,
    cells: Option<Cells>,
    solver: Option<Solver>,
    /// The grid that it solved last.
    solved: Option<Placement>,
    /// The error logged last, without its figures.
    logged: String,
}

/// The parts of the world that answers depend on.
#[derive(SystemParam)]
struct QueriedWorld<'w, 's> {
    cameras: Query<'w, 's, (Entity, LitCamera)>,
    surroundings: Option<Res<'w, CameraSurroundings>>,
    viewers: Query<'w, 's, (&'static Viewer2d, &'static GlobalTransform)>,
    gather: Gather<'w, 's>,
    gather_masks: GatherMasks<'w, 's>,
    assets: SceneAssets<'w, 's>,
}

/// Computes the light and reads the walls, as far as they were queried since the last time.
fn solve(
    settings: Res<LightQuerySettings>,
    mut known: ResMut<QueriedLight>,
    mut seen: ResMut<QueriedSight>,
    mut state: Local<QueryState>,
    world: QueriedWorld,
) {
    let QueriedWorld { cameras, surroundings, viewers, gather, gather_masks, assets } = world;
    let wanted = Wanted { light: known.take_request(), sight: seen.take_request() };
    if !wanted.light && !wanted.sight {
        return;
    }
    let lit = cameras.iter().filter_map(|(entity, camera)| {
        let placement = camera.placement().ok()??;
        Some((entity, camera, placement))
    });
    let first = lit.min_by_key(|(entity, camera, _)| (camera.order(), *entity));
    let seeing = first.map(|(entity, camera, placement)| {
        let found = surroundings.as_ref().and_then(|light| {
            Some((light.inflow(entity, &placement)?, light.are_all_solid(entity)))
        });
        (camera, (placement, found))
    });
    let (camera, placed) = seeing.unzip();
    let (placement, found) = placed.unzip();
    let own = camera.as_ref().map(|camera| camera.lighting);
    let lighting = settings.lighting.clone().unwrap_or_else(|| default_lighting(own));
    let layers = camera.as_ref().map_or(&settings.layers, |camera| camera.layers());
    let sky = camera.as_ref().map_or(Sky::BLACK, |camera| camera.sky());
    let area = settings.area.or(placement.map(|placement| placement.area()));
    // Elsewhere only the sky enters.
    let entering = match (found.flatten(), &placement, settings.area) {
        (Some((inflow, all_solid)), Some(grid), None) => {
            Some(EnteringLight { inflow, grid, all_solid })
        }
        _ => None,
    };

    let state = &mut *state;
    // Without an area, all matter counts.
    let everywhere = Rect::from_center_half_size(Vec2::ZERO, Vec2::splat(1e9));
    let areas = [area.unwrap_or(everywhere)];
    gather.gather(&areas, &mut state.scene);
    gather_masks.gather(&areas, &state.scene, &mut state.masks);
    let fields = viewers.iter().filter(|_| wanted.sight).filter_map(field_of_view);
    let bounds =
        || state.scene.bounds().into_iter().chain(fields).reduce(|all, own| all.union(own));
    let Some(area) = area.or_else(bounds) else {
        known.grid = None;
        seen.forget();
        return;
    };
    let Some(grid) = fine_grid(area, settings.cell) else {
        known.grid = None;
        seen.forget();
        let LightQuerySettings { cell, .. } = *settings;
        state.log(format!("cells of {cell} world units cannot cover {area:?}"));
        return;
    };
    known.ambient = camera.as_ref().map_or([0.0; 3], |camera| camera.ambient());
    let parameters = lighting.settings(grid.cell * FINE_PER_CELL as f32);
    let method = parameters.as_ref().ok().map(|parameters| &parameters.method);
    let takes_inflow = method.is_some_and(|method| method.takes_inflow().is_ok());
    let entering = entering.filter(|_| takes_inflow);
    let lamps = |lamp: &WorldLamp| match entering {
        Some(entering) => entering.inside(lamp, &grid),
        None => vec![lamp.on_grid(grid.corner(), grid.cell, lighting.method.lights_by_rule())],
    };
    let fine = match state.draw(&grid, &lighting, layers, &sky, &assets, lamps) {
        Ok(fine) => fine,
        Err(error) => {
            known.grid = None;
            seen.forget();
            state.log(error.to_string());
            return;
        }
    };
    if wanted.sight
        && let Err(error) = seen.read(&grid, &fine)
    {
        seen.forget();
        state.log(error.to_string());
    }
    if wanted.light {
        let found = parameters.and_then(|parameters| {
            known.light.clone_from(state.solve(&fine, &grid, parameters, entering)?);
            Ok(())
        });
        known.grid = found.is_ok().then_some(grid);
        known.area = entering.map_or(grid.area(), |light| light.grid.area());
        if let Err(error) = found {
            state.log(error.to_string());
        }
    }
    state.fine = Some(fine);
}

/// The answers that were asked for.
struct Wanted {
    light: bool,
    sight: bool,
}

/// The box around all that a viewer may see.
fn field_of_view((viewer, transform): (&Viewer2d, &GlobalTransform)) -> Option<Rect> {
    let (middle, range) = (transform.translation().truncate(), viewer.range);
    (middle.is_finite() && range.is_finite() && range > 0.0)
        .then(|| Rect::from_center_half_size(middle, Vec2::splat(range)))
}

/// The settings without any of the user: quick ones that resemble those of the camera.
fn default_lighting(camera: Option<&Lighting2d>) -> Lighting2d {
    match camera {
        Some(own) if own.method.lights_by_rule() => own.clone(),
        own => {
            let bounces = own.map_or(Lighting2d::default().bounces, |own| own.bounces);
            Lighting2d { bounces, ..Lighting2d::default() }.with_quality(LightQuality::Fast)
        }
    }
}

/// Fine cells per cell and axis. Matter is drawn on fine cells, so that thin walls stay closed.
const FINE_PER_CELL: u32 = 2;
/// Bounces instead of those over frames, because an answer is a single frame; most of the light.
const BOUNCES_INSTEAD: Bounces = Bounces::Count(2);
/// The largest number of cells of an answer.
const MAX_QUERY_CELLS: u64 = 1 << 17;
/// The fine grid over an area; `None` if the numbers make no sense.
fn fine_grid(area: Rect, cell: f32) -> Option<Placement> {
    if !(cell > 0.0 && cell.is_finite() && area.min.is_finite() && area.max.is_finite()) {
        return None;
    }
    let requested = cell / FINE_PER_CELL as f32;
    let fits = |fine: f32| {
        let [x, y] = (area.center() / fine).to_array().map(f64::from);
        let lattice = LATTICE * FINE_PER_CELL;
        let position = [x, -y];
        let own = Camera2dView { position, border: 0, lattice, ..Camera2dView::default() };
        let view = Camera2dView { step: lattice, ..own };
        let extent = (area.size() / fine).max(Vec2::ONE).to_array().map(f64::from);
        let placed = view.cover(extent).ok()?;
        let cells = placed.size.map(|side| u64::from(side / FINE_PER_CELL));
        (cells[0] * cells[1] <= MAX_QUERY_CELLS).then_some(Placement {
            cell: fine,
            requested,
            placed,
        })
    };
    doubled(requested).find_map(fits)
}

impl QueryState {
    /// Logs why there is no light, unless that was logged just before, with whatever figures.
    fn log(&mut self, error: String) {
        let text = without_figures(&error);
        if self.logged != text {
            error!("no light is known: {error}");
            self.logged = text;
        }
    }

    /// Draws the scene on fine cells.
    fn draw(
        &mut self,
        grid: &Placement,
        lighting: &Lighting2d,
        layers: &RenderLayers,
        sky: &Sky,
        assets: &SceneAssets,
        on_grid: impl Fn(&WorldLamp) -> Vec<Lamp>,
    ) -> lamplight::Result<Cells> {
        let [width, height] = grid.placed.size;
        let mut fine = match self.fine.take() {
            Some(fine) if [fine.width(), fine.height()] == grid.placed.size => fine,
            _ => Cells::new(width, height)?,
        };
        rasterize(&self.scene, grid, layers, assets, &mut fine);
        rasterize_masks(&self.masks, grid, layers, assets, &mut fine);
        fine.set_sky(sky.clone());
        let lamps = self.scene.lamps.iter().filter(|(_, own)| own.intersects(layers));
        let lamps = lamps.flat_map(|(lamp, _)| on_grid(lamp));
        fine.lamps_mut().extend(lamps.filter(|lamp| lamp.check(&"lamp").is_ok()));
        let suns = self.scene.suns.iter().filter(|(_, own)| own.intersects(layers));
        fine.suns_mut().clear();
        fine.suns_mut().extend(suns.map(|(sun, _)| *sun));
        if lighting.method == LightMethod::Polar && fine.lamps().is_empty() {
            // The method requires a lamp; this one is off.
            fine.lamps_mut().push(Lamp { intensity: 0.0, ..Lamp::default() });
        }
        Ok(fine)
    }

    /// Lights the scene that was drawn.
    fn solve(
        &mut self,
        fine: &Cells,
        grid: &Placement,
        mut settings: Settings,
        entering: Option<EnteringLight>,
    ) -> lamplight::Result<&Light> {
        let cells = match self.cells.take() {
            Some(cells) => cells,
            None => Cells::new(1, 1)?,
        };
        let cells = self.cells.insert(cells);
        downsample(fine, FINE_PER_CELL, cells)?;
        match entering {
            Some(light) => {
                light.enter(cells, grid.corner(), grid.cell * FINE_PER_CELL as f32)?;
            }
            None => cells.set_inflow(None)?,
        }
        if settings.bounces == Bounces::Feedback {
            settings.bounces = BOUNCES_INSTEAD;
        }
        let solver = solver_of(&mut self.solver, settings)?;
        // Light that spreads over frames stays in its place.
        let before = self.solved.replace(*grid);
        match before.filter(|before| before.cell == grid.cell) {
            Some(before) => {
                solver.shift([0, 1].map(|a| {
                    (grid.placed.origin[a] - before.placed.origin[a]) / FINE_PER_CELL as i32
                }))
            }
            None => solver.reset(),
        }
        solver.solve(cells)
    }
}

/// Returns the solver with these settings, or a new one.
fn solver_of(solver: &mut Option<Solver>, settings: Settings) -> lamplight::Result<&mut Solver> {
    match solver {
        Some(solver) => {
            solver.set_settings(settings)?;
            Ok(solver)
        }
        none => Ok(none.insert(Solver::new(settings)?)),
    }
}
