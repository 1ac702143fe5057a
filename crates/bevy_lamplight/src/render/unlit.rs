//! Draw calls of [`Unlit2d`](crate::Unlit2d) entities and gizmos, held back from the main pass and
//! drawn over the lit picture.

use super::extract::ExtractedLighting;
use super::lit_view::LitViews;
use crate::components::Unlit2d;
use bevy::core_pipeline::core_2d::Transparent2d;
use bevy::log::error_once;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::{Entity, Query, Res, ResMut, Resource, With, World};
use bevy::render::Extract;
use bevy::render::render_phase::{
    PhaseItem, PhaseItemExtraIndex, SortedRenderPhase, TrackedRenderPass, ViewSortedRenderPhases,
};
use bevy::render::sync_world::MainEntity;
use bevy::render::view::{ExtractedView, RetainedViewEntity};

/// Unlit entities, and the draw calls held back for each view.
#[derive(Resource, Default)]
pub struct UnlitPhases {
    entities: HashSet<Entity>,
    phases: HashMap<RetainedViewEntity, SortedRenderPhase<Transparent2d>>,
}

/// The key of the marker item between lit and unlit draw calls, which belongs to no entity.
fn marker() -> (Entity, MainEntity) {
    (Entity::PLACEHOLDER, Entity::PLACEHOLDER.into())
}

/// Extracts unlit entities.
pub fn extract(mut unlit: ResMut<UnlitPhases>, marked: Extract<Query<Entity, With<Unlit2d>>>) {
    unlit.entities.clear();
    unlit.entities.extend(&marked);
}

/// Sorts unlit draw calls behind the others, with a marker between them that keeps Bevy from batching
/// across the boundary.
pub fn partition(
    unlit: Res<UnlitPhases>,
    extracted: Res<ExtractedLighting>,
    views: Query<&ExtractedView>,
    mut phases: ResMut<ViewSortedRenderPhases<Transparent2d>>,
) {
    for view in extracted.views.iter().filter_map(|view| views.get(view.entity).ok()) {
        let Some(phase) = phases.get_mut(&view.retained_view_entity) else { continue };
        let is_unlit = |item: &Transparent2d| {
            // Gizmos have an infinite z.
            item.sort_key.0 == f32::INFINITY || unlit.entities.contains(&item.main_entity().id())
        };
        let Some(first) = phase.items.values().find(|item| is_unlit(item)) else { continue };
        let item = Transparent2d {
            entity: marker(),
            batch_range: 0..0,
            extra_index: PhaseItemExtraIndex::None,
            extracted_index: usize::MAX,
            ..*first
        };
        // The sort is stable.
        phase.items.sort_by_key(|_, item| is_unlit(item));
        let lit = phase.items.values().take_while(|item| !is_unlit(item)).count();
        phase.items.shift_insert(lit, marker(), item);
    }
}

/// Removes unlit draw calls from the main pass of cameras that are lit in this frame.
pub fn hold_back(
    mut unlit: ResMut<UnlitPhases>,
    extracted: Res<ExtractedLighting>,
    lit_views: Res<LitViews>,
    views: Query<&ExtractedView>,
    mut phases: ResMut<ViewSortedRenderPhases<Transparent2d>>,
) {
    for entity in extracted.views.iter().map(|view| view.entity) {
        let Ok(ExtractedView { retained_view_entity: view, .. }) = views.get(entity) else {
            continue;
        };
        let Some(phase) = phases.get_mut(view) else { continue };
        let Some(at) = phase.items.get_index_of(&marker()) else { continue };
        if lit_views.views.get(&entity).is_some_and(|lit| lit.is_lit) {
            let items = phase.items.split_off(at);
            let kept = SortedRenderPhase { items, transient_items: Vec::new() };
            unlit.phases.insert(*view, kept);
        } else {
            phase.items.shift_remove(&marker());
        }
    }
}

/// Returns the draw calls to the camera's phase, which Bevy keeps across frames.
pub fn restore(
    mut unlit: ResMut<UnlitPhases>,
    mut phases: ResMut<ViewSortedRenderPhases<Transparent2d>>,
) {
    for (view, mut kept) in unlit.phases.drain() {
        kept.items.shift_remove(&marker());
        if let Some(phase) = phases.get_mut(&view) {
            phase.items.append(&mut kept.items);
        }
    }
}

impl UnlitPhases {
    /// Draws the held-back draw calls of a view.
    pub fn draw<'w>(
        &self,
        view: RetainedViewEntity,
        pass: &mut TrackedRenderPass<'w>,
        world: &'w World,
        entity: Entity,
    ) {
        let Some(phase) = self.phases.get(&view) else { return };
        if let Err(error) = phase.render(pass, world, entity) {
            error_once!("unlit entities are not drawn: {error:?}");
        }
    }
}
