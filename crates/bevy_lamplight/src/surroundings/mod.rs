//! Light that enters the grid of a camera from around it: matter and lamps beyond the grid, found on the CPU at the end of
//! each frame of the main world.
//!
//! Matter is drawn on rings of coarse cells from the same quads as on the grid, lamps are seen as the discs that they are
//! ([`RingSurroundings`]). Only what has changed is found anew: a ring whose matter has moved is drawn, and while a camera
//! glides the outer ones mostly stay; lamps that move cost less. A scene in which nothing moves, or with nothing beyond
//! the grid, costs its comparison with the last frame.

mod rings;

use crate::camera_log::CameraLog;
use crate::components::Lighting2d;
use crate::lit_camera::{LitCamera, LitCameraItem};
use crate::placement::Placement;
use crate::quads::{ExtractedScene, Gather, SceneAssets};
use bevy::asset::AssetEvent;
use bevy::ecs::message::MessageReader;
use bevy::image::Image;
use bevy::math::Rect;
use bevy::platform::collections::HashMap;
use bevy::prelude::{Entity, Local, Query, ResMut, Resource};
use lamplight::surroundings::{LampPart, RingSurroundings, part_lamp};
use lamplight::{Inflow, Lamp, Method, Sky, Sun};
use rings::{CameraRings, GridPlace};

/// The surroundings of lit cameras.
#[derive(Resource, Default)]
pub struct CameraSurroundings(HashMap<Entity, ViewSurroundings>);

impl CameraSurroundings {
    /// The light that enters the grid of a camera; `None` if it is that of the sky.
    pub fn inflow(&self, camera: Entity, placement: &Placement) -> Option<&Inflow> {
        let view = self.0.get(&camera)?;
        let inflow = view.inflow.as_ref()?;
        (view.rings.as_ref()?.grid() == GridPlace::of(placement)).then_some(inflow)
    }

    /// Returns whether the method of a camera draws all lamps as solid discs, which are not parted ([`is_parted`]).
    pub fn are_all_solid(&self, camera: Entity) -> bool {
        self.0.get(&camera).is_some_and(|view| view.all_solid)
    }
}

/// The surroundings of one camera.
#[derive(Default)]
struct ViewSurroundings {
    lighting: Option<Lighting2d>,
    /// True if the method of the camera knows light from beyond the grid.
    takes_inflow: bool,
    /// True if the method draws all lamps as solid discs.
    all_solid: bool,
    rings: Option<CameraRings>,
    sky: Sky,
    /// Suns that are part of the sky.
    suns: Vec<Sun>,
    /// The scene around the grid.
    scene: ExtractedScene,
    /// Lamps beyond the grid, and those of the last frame.
    lamps: Vec<Lamp>,
    lamps_before: Vec<Lamp>,
    /// The light of sky and matter.
    still: Option<Inflow>,
    inflow: Option<Inflow>,
}

/// Returns whether a lamp that glides over the border of the grid fades from the grid into its surroundings. Those that are
/// seen, or stop light, stay in their place and are cut.
pub fn is_parted(lamp: &Lamp, all_solid: bool) -> bool {
    !(all_solid || lamp.solid || lamp.visible)
}

/// Finds the light that enters the grid of every camera.
pub fn find(
    mut surroundings: ResMut<CameraSurroundings>,
    mut events: MessageReader<AssetEvent<Image>>,
    mut log: Local<CameraLog>,
    cameras: Query<(Entity, LitCamera)>,
    gather: Gather,
    assets: SceneAssets,
) {
    let CameraSurroundings(views) = &mut *surroundings;
    views.retain(|&camera, _| cameras.contains(camera));
    for event in events.read() {
        if let AssetEvent::Added { id } | AssetEvent::Modified { id } | AssetEvent::Removed { id } =
            event
        {
            let rings = views.values_mut().filter_map(|view| view.rings.as_mut());
            rings.for_each(|rings| rings.forget(*id));
        }
    }
    for (entity, camera) in &cameras {
        let Ok(Some(placement)) = camera.placement() else { continue };
        if camera.lighting.surroundings == 0 {
            views.remove(&entity);
            continue;
        }
        let view = views.entry(entity).or_default();
        if let Err(error) = view.find(&camera, &placement, &gather, &assets) {
            (view.still, view.inflow) = (None, None);
            log.no_inflow(entity, error);
        }
    }
}

impl ViewSurroundings {
    fn find(
        &mut self,
        camera: &LitCameraItem,
        placement: &Placement,
        gather: &Gather,
        assets: &SceneAssets,
    ) -> lamplight::Result<()> {
        let Lighting2d { surroundings, .. } = *camera.lighting;
        let mut changed = false;
        if self.lighting.as_ref() != Some(camera.lighting) {
            self.lighting = Some(camera.lighting.clone());
            // Settings that are errors are reported where they are used.
            let settings = camera.lighting.settings(placement.cell).ok();
            let method = settings.map(|settings| settings.method);
            self.takes_inflow = method.as_ref().is_some_and(|method| method.takes_inflow().is_ok());
            self.all_solid = method.is_some_and(|method| !method.reads_glow());
        }
        if !self.takes_inflow {
            self.inflow = None;
            return Ok(());
        }
        let grid = GridPlace::of(placement);
        let count = (surroundings as usize).min(RingSurroundings::MOST_RINGS);
        match &mut self.rings {
            Some(rings) if (rings.grid(), rings.light().rings()) == (grid, count) => {}
            Some(rings) => {
                rings.place(grid, count)?;
                changed = true;
            }
            None => self.rings = Some(CameraRings::new(grid, count)?),
        }
        let Some(rings) = &mut self.rings else { return Ok(()) };
        let (area, around) = (placement.area(), rings.area());
        gather.gather(&[around], &mut self.scene);
        self.scene
            .groups
            .retain(|group| group.layers.intersects(camera.layers()) && !group.is_within(area));
        let sky = camera.sky();
        let method = Method::from(camera.lighting.method);
        let suns = self.scene.suns.iter().filter(|(sun, layers)| {
            layers.intersects(camera.layers()) && !method.shines_exactly(sun)
        });
        let suns = suns.map(|(sun, _)| *sun);
        if self.sky != sky || !suns.clone().eq(self.suns.iter().copied()) {
            self.sky = sky;
            self.suns.clear();
            self.suns.extend(suns);
            changed = true;
        }
        std::mem::swap(&mut self.lamps, &mut self.lamps_before);
        self.lamps.clear();
        let lamps = lamps_beyond(&self.scene, camera, placement, around, self.all_solid);
        self.lamps.extend(lamps);
        let is_empty = self.scene.groups.is_empty() && self.lamps.is_empty();
        if is_empty && self.inflow.is_none() {
            // Light that enters is the sky's. Once some has been found, frames keep their pipelines for it.
            self.still = None;
            return Ok(());
        }
        changed |= rings.draw(&self.scene, area, camera.layers(), assets)? > 0;
        if changed || self.still.is_none() {
            self.still =
                Some(rings.light().inflow(&self.sky, &self.suns, RingSurroundings::COLUMNS)?);
            self.inflow = None;
        }
        let Some(still) = &self.still else { return Ok(()) };
        if self.inflow.is_none() || self.lamps != self.lamps_before {
            self.inflow = Some(match &self.lamps[..] {
                [] => still.clone(),
                lamps => rings.light().with_lamps(still, lamps)?,
            });
        }
        Ok(())
    }
}

/// Returns the lamps beyond a grid, px of it: those that are drawn as matter, not those that are lit by their own shadows.
fn lamps_beyond<'a>(
    scene: &'a ExtractedScene,
    camera: &'a LitCameraItem,
    placement: &'a Placement,
    around: Rect,
    all_solid: bool,
) -> impl Iterator<Item = Lamp> + 'a {
    let area = placement.area();
    let near = scene.lamps.iter().filter(move |(lamp, layers)| {
        // Grids resolve no smaller radius; parts of a lamp lie up to three radii away.
        let radius = lamp.radius.max(2.0 * placement.cell);
        let is_inside = area.inflate(-4.0 * radius).contains(lamp.position);
        !is_inside && around.contains(lamp.position) && layers.intersects(camera.layers())
    });
    let on_grid =
        near.map(move |(lamp, _)| lamp.on_grid(placement.corner(), placement.cell, false));
    let drawn = on_grid.filter(|lamp| lamp.check(&"lamp").is_ok() && !lamp.is_exact());
    drawn.flat_map(move |lamp| {
        let whole = (!is_parted(&lamp, all_solid)).then(|| lamp.clone());
        let parts = part_lamp(&lamp, placement.placed.size);
        let parts = parts.filter(|(_, part)| *part == LampPart::Beyond).map(|(lamp, _)| lamp);
        let count = if whole.is_some() { 0 } else { usize::MAX };
        whole.into_iter().chain(parts.take(count))
    })
}
