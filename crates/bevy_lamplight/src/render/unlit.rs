//! What is drawn over the lit picture: the camera's own draw calls of what is
//! [`Unlit2d`](crate::Unlit2d), and gizmos, kept back until then.

use super::extract::Extracted;
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

/// What is not lit.
#[derive(Resource, Default)]
pub struct Unlit {
    entities: HashSet<Entity>,
    phases: HashMap<RetainedViewEntity, SortedRenderPhase<Transparent2d>>,
}

/// The mark between lit and unlit, which is of no entity.
fn mark() -> (Entity, MainEntity) {
    (Entity::PLACEHOLDER, Entity::PLACEHOLDER.into())
}

pub fn extract(mut unlit: ResMut<Unlit>, marked: Extract<Query<Entity, With<Unlit2d>>>) {
    unlit.entities.clear();
    unlit.entities.extend(&marked);
}

/// Sorts what is not lit behind the rest, with a mark between them that keeps sprites on either side
/// from being drawn at once.
pub fn set_apart(
    unlit: Res<Unlit>,
    extracted: Res<Extracted>,
    views: Query<&ExtractedView>,
    mut phases: ResMut<ViewSortedRenderPhases<Transparent2d>>,
) {
    for view in extracted.views.iter().filter_map(|view| views.get(view.entity).ok()) {
        let Some(phase) = phases.get_mut(&view.retained_view_entity) else { continue };
        let is_unlit = |item: &Transparent2d| {
            // Gizmos lie infinitely high.
            item.sort_key.0 == f32::INFINITY || unlit.entities.contains(&item.main_entity().id())
        };
        let Some(first) = phase.items.values().find(|item| is_unlit(item)) else { continue };
        let item = Transparent2d {
            entity: mark(),
            batch_range: 0..0,
            extra_index: PhaseItemExtraIndex::None,
            extracted_index: usize::MAX,
            ..*first
        };
        // Sorting keeps the order among its kind.
        phase.items.sort_by_key(|_, item| is_unlit(item));
        let lit = phase.items.values().take_while(|item| !is_unlit(item)).count();
        phase.items.shift_insert(lit, mark(), item);
    }
}

/// Takes what is not lit out of the main pass.
pub fn take_out(
    mut unlit: ResMut<Unlit>,
    mut phases: ResMut<ViewSortedRenderPhases<Transparent2d>>,
) {
    for (&view, phase) in phases.iter_mut() {
        let Some(at) = phase.items.get_index_of(&mark()) else { continue };
        let items = phase.items.split_off(at);
        let kept = SortedRenderPhase { items, transient_items: Vec::new() };
        unlit.phases.insert(view, kept);
    }
}

/// Gives it back: what stays from frame to frame stays in the camera's phase.
pub fn put_back(
    mut unlit: ResMut<Unlit>,
    mut phases: ResMut<ViewSortedRenderPhases<Transparent2d>>,
) {
    for (view, mut kept) in unlit.phases.drain() {
        kept.items.shift_remove(&mark());
        if let Some(phase) = phases.get_mut(&view) {
            phase.items.append(&mut kept.items);
        }
    }
}

impl Unlit {
    /// Draws what a camera keeps back.
    pub fn draw<'w>(
        &self,
        view: RetainedViewEntity,
        pass: &mut TrackedRenderPass<'w>,
        world: &'w World,
        entity: Entity,
    ) {
        let Some(phase) = self.phases.get(&view) else { return };
        if let Err(problem) = phase.render(pass, world, entity) {
            error_once!("what is not lit is not drawn: {problem:?}");
        }
    }
}
