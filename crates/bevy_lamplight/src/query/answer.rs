//! The grid that answers, and the system parameter that asks.

use super::raster::rasterize;
use crate::components::{LightMethod, Lighting2d};
use crate::lit_camera::LitCamera;
use crate::pieces::{Gather, Pictures, Surroundings, VisibilityPropagates};
use crate::placement::{LATTICE, Placement, doubled};
use bevy::app::{App, Plugin, PostUpdate};
use bevy::camera::visibility::{RenderLayers, VisibilityPlugin, VisibilitySystems};
use bevy::color::LinearRgba;
use bevy::ecs::system::SystemParam;
use bevy::log::{error, warn};
use bevy::math::{Rect, Vec2};
use bevy::prelude::{
    IntoScheduleConfigs, Local, Query, Reflect, ReflectResource, Res, ResMut, Resource,
};
use bevy::transform::{TransformPlugin, TransformSystems};
use lamplight::coarse::coarsen;
use lamplight::{Cells, Lamp, Light, Method, Settings, Sky, Solver};
use lamplight_wgpu::View;
use std::sync::atomic::{AtomicBool, Ordering};

/// Answers [`LightQuery`]; part of [`LamplightPlugin`](crate::LamplightPlugin), and enough by itself
/// with Bevy's `TransformPlugin` where nothing is drawn, as on a server.
pub struct LightQueryPlugin;

impl Plugin for LightQueryPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<LightQuerySettings>().init_resource::<Answer>().add_systems(
            PostUpdate,
            solve.after(TransformSystems::Propagate).after(VisibilitySystems::VisibilityPropagate),
        );
    }

    fn finish(&self, app: &mut App) {
        // A server has none.
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

/// How the light that [`LightQuery`] asks about is found.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
pub struct LightQuerySettings {
    /// World units a cell. Half of it costs four times as much. Walls are seen down to half of it.
    pub cell: f32,
    /// What can be asked about. None: what the first lit camera sees, with its border; where there
    /// is no lit camera, all that takes part in light and as much again as lamps reach. Areas of
    /// more than 131,072 cells get larger cells.
    pub area: Option<Rect>,
    /// How light is found. None: by `holographic`'s preset `fast`, with as many bounces as the first
    /// lit camera has; by `polar` or `flood` where that does, which are light of other kinds.
    pub lighting: Option<Lighting2d>,
    /// Sees what is on these layers; those of the first lit camera where there is one.
    #[reflect(ignore)]
    pub layers: RenderLayers,
}

impl Default for LightQuerySettings {
    fn default() -> Self {
        Self { cell: 4.0, area: None, lighting: None, layers: RenderLayers::default() }
    }
}

/// Asks how much light arrives at a place. The first time in a while nothing is known yet: light is
/// found at the end of every frame in which somebody asked, and is one frame old.
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
    answer: Res<'w, Answer>,
}

impl LightQuery<'_> {
    /// Light that arrives at a place of the world, linear; none where it is not known.
    pub fn at(&self, place: Vec2) -> Option<LinearRgba> {
        let at = self.answer.place(place)?;
        Some(self.answer.sum(|light| light.sample(at)))
    }

    /// Mean light that arrives in the open part of a box, at its middle where it has no size; none where
    /// it is not known all over.
    pub fn over(&self, area: Rect) -> Option<LinearRgba> {
        let area = Rect::from_corners(area.min, area.max);
        if area.is_empty() {
            return self.at(area.center());
        }
        let left_bottom = self.answer.place(area.min)?;
        let right_top = self.answer.place(area.max)?;
        let (min, max) = ([left_bottom[0], right_top[1]], [right_top[0], left_bottom[1]]);
        Some(self.answer.sum(|light| light.over(min, max)))
    }

    /// Luminance at a place: 1 is where white is shown white.
    pub fn level(&self, place: Vec2) -> Option<f32> {
        use bevy::color::Luminance;
        self.at(place).map(|light| light.luminance())
    }

    /// What can be asked about; none before the first answer.
    pub fn area(&self) -> Option<Rect> {
        self.answer.ask();
        Some(self.answer.grid?.area())
    }
}

/// The light last found.
#[derive(Resource, Default)]
pub struct Answer {
    asked: AtomicBool,
    /// The fine one, on which matter is drawn.
    grid: Option<Placement>,
    light: Light,
    /// Of spots, where the method does not light them itself.
    spots: Option<Light>,
    ambient: [f32; 3],
}

impl Answer {
    fn ask(&self) {
        self.asked.store(true, Ordering::Relaxed);
    }

    /// A place of the world, in cells.
    fn place(&self, place: Vec2) -> Option<[f32; 2]> {
        self.ask();
        let grid = self.grid.filter(|grid| grid.area().contains(place))?;
        let at = (place - grid.corner()) / (grid.cell * FINER as f32);
        Some([at.x, -at.y])
    }

    fn sum(&self, light: impl Fn(&Light) -> [f32; 3]) -> LinearRgba {
        let spots = self.spots.as_ref().map_or([0.0; 3], &light);
        let own = light(&self.light);
        let [red, green, blue] = std::array::from_fn(|c| own[c] + spots[c] + self.ambient[c]);
        LinearRgba::rgb(red, green, blue)
    }
}

/// What is kept from answer to answer.
#[derive(Default)]
struct Bench {
    surroundings: Surroundings,
    fine: Option<Cells>,
    cells: Option<Cells>,
    lamps: Vec<Lamp>,
    solver: Option<Solver>,
    spots: Option<Solver>,
    /// The problem last told.
    told: String,
}

/// Finds the light where somebody asked since it was last found.
fn solve(
    settings: Res<LightQuerySettings>,
    mut answer: ResMut<Answer>,
    mut bench: Local<Bench>,
    cameras: Query<LitCamera>,
    gather: Gather,
    pictures: Pictures,
) {
    if !answer.asked.swap(false, Ordering::Relaxed) {
        return;
    }
    let (seen, camera) =
        cameras.iter().find_map(|camera| Some((camera.placement().ok()??, camera))).unzip();
    let own = camera.as_ref().map(|camera| camera.lighting);
    let lighting = settings.lighting.clone().unwrap_or_else(|| quick(own));
    let layers = camera.as_ref().map_or(&settings.layers, |camera| camera.layers());
    let sky = camera.as_ref().map_or(Sky::BLACK, |camera| camera.sky());
    let seen = seen.map(|placement| placement.area());
    let area = settings.area.or(seen);

    let bench = &mut *bench;
    // All there is, where nothing says what matters.
    let everywhere = Rect::from_center_half_size(Vec2::ZERO, Vec2::splat(1e9));
    gather.gather(&[area.unwrap_or(everywhere)], &mut bench.surroundings);
    let Some(area) = area.or_else(|| bench.surroundings.bounds()) else {
        answer.grid = None;
        return;
    };
    let Some(grid) = place(area, settings.cell) else {
        answer.grid = None;
        let LightQuerySettings { cell, .. } = *settings;
        bench.tell(format!("cells of {cell} world units cannot cover {area:?}"));
        return;
    };
    answer.ambient = camera.as_ref().map_or([0.0; 3], |camera| camera.ambient());
    match bench.solve(&grid, &lighting, layers, sky, &pictures) {
        Ok((light, spots)) => {
            answer.light.clone_from(light);
            answer.spots = spots.cloned();
            answer.grid = Some(grid);
        }
        Err(problem) => {
            answer.grid = None;
            bench.tell(problem.to_string());
        }
    }
}

/// How light is found where nobody says: as the camera's is, and soon.
fn quick(camera: Option<&Lighting2d>) -> Lighting2d {
    match camera {
        Some(own) if own.method.lights_lamps() => own.clone(),
        own => {
            let bounces = own.map_or(Lighting2d::default().bounces, |own| own.bounces);
            Lighting2d { bounces, ..Lighting2d::default() }.with_preset("fast")
        }
    }
}

/// So much finer is matter drawn, so that walls thinner than a cell stay shut.
const FINER: u32 = 2;
/// Most cells of an answer.
const MOST_CELLS: u64 = 1 << 17;
/// The fine grid over an area.
fn place(area: Rect, cell: f32) -> Option<Placement> {
    if !(cell > 0.0 && cell.is_finite() && area.min.is_finite() && area.max.is_finite()) {
        return None;
    }
    let asked = cell / FINER as f32;
    let fits = |fine: f32| {
        let [x, y] = (area.center() / fine).to_array().map(f64::from);
        let lattice = LATTICE * FINER;
        let view = View { position: [x, -y], border: 0, lattice, step: lattice, ..View::default() };
        let extent = (area.size() / fine).max(Vec2::ONE).to_array().map(f64::from);
        let placed = view.cover(extent).ok()?;
        let cells = placed.size.map(|side| u64::from(side / FINER));
        (cells[0] * cells[1] <= MOST_CELLS).then_some(Placement { cell: fine, asked, placed })
    };
    doubled(asked).find_map(fits)
}

impl Bench {
    /// Says why nothing is known; once is enough.
    fn tell(&mut self, problem: String) {
        if self.told != problem {
            error!("no light is known: {problem}");
            self.told = problem;
        }
    }

    fn solve(
        &mut self,
        grid: &Placement,
        lighting: &Lighting2d,
        layers: &RenderLayers,
        sky: Sky,
        pictures: &Pictures,
    ) -> lamplight::Result<(&Light, Option<&Light>)> {
        let by_rule = lighting.method.lights_lamps();
        let [width, height] = grid.placed.size;
        let fine = match self.fine.take() {
            Some(fine) if [fine.width(), fine.height()] == grid.placed.size => fine,
            _ => Cells::new(width, height)?,
        };
        let fine = self.fine.insert(fine);
        rasterize(&self.surroundings, grid, layers, pictures, fine);
        fine.set_sky(sky);
        // Spots are lit by rule whatever the method.
        self.lamps.clear();
        let lamps = self.surroundings.lamps.iter().filter(|(_, own)| own.intersects(layers));
        for (lamp, _) in lamps {
            let is_spot = lamp.cone.is_some();
            let on_grid = match by_rule || is_spot {
                true => lamp.on_grid(grid.corner(), grid.cell),
                false => lamp.disc(grid.corner(), grid.cell),
            };
            if on_grid.check(&"lamp").is_err() {
                continue;
            }
            match is_spot && !by_rule {
                true => self.lamps.push(on_grid),
                false => fine.lamps_mut().push(on_grid),
            }
        }
        if lighting.method == LightMethod::Polar && fine.lamps().is_empty() {
            // It refuses a scene without lamps; this one is off.
            fine.lamps_mut().push(Lamp { intensity: 0.0, ..Lamp::default() });
        }
        let cells = match self.cells.take() {
            Some(cells) => cells,
            None => Cells::new(1, 1)?,
        };
        let cells = self.cells.insert(cells);
        coarsen(fine, FINER, cells)?;
        let settings = lighting.settings(grid.cell * FINER as f32)?;
        let light = solved(&mut self.solver, settings, cells)?;
        if self.lamps.is_empty() {
            return Ok((light, None));
        }
        // The same matter, with no lamps but spots.
        fine.lamps_mut().clear();
        fine.lamps_mut().append(&mut self.lamps);
        fine.set_sky(Sky::BLACK);
        coarsen(fine, FINER, cells)?;
        let settings = Settings { method: Method::Polar, ..Settings::default() };
        Ok((light, Some(solved(&mut self.spots, settings, cells)?)))
    }
}

/// Solves with a solver that is kept while its settings stay.
fn solved<'a>(
    solver: &'a mut Option<Solver>,
    settings: Settings,
    cells: &Cells,
) -> lamplight::Result<&'a Light> {
    let own = match solver.take() {
        Some(own) if *own.settings() == settings => own,
        _ => Solver::new(settings)?,
    };
    let own = solver.insert(own);
    own.solve(cells)
}
