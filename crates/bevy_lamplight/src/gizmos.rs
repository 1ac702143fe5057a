//! Gizmos: outlines of lamps and their ranges, of what viewers may see, of occluders, and of each camera's lit grid.

use crate::components::{LightOccluder2d, OccluderShape, PointLight2d, SpotLight2d, Viewer2d};
use crate::lit_camera::LitCamera;
use bevy::app::{App, Plugin, PostUpdate};
use bevy::color::{Alpha, Color};
use bevy::gizmos::AppGizmoBuilder;
use bevy::gizmos::config::GizmoConfigGroup;
use bevy::gizmos::gizmos::Gizmos;
use bevy::math::{Isometry2d, Vec2, Vec3};
use bevy::prelude::{GlobalTransform, IntoScheduleConfigs, Query, Reflect};
use bevy::transform::TransformSystems;
use std::f32::consts::TAU;

/// Draws outlines of lamps, spots, viewers, occluders and the lit grids of cameras, unlit and above the picture.
/// The configuration of [`LightGizmos`] enables them and sets their line width.
pub struct LamplightGizmosPlugin;

impl Plugin for LamplightGizmosPlugin {
    fn build(&self, app: &mut App) {
        app.init_gizmo_group::<LightGizmos>()
            .add_systems(PostUpdate, draw.after(TransformSystems::Propagate));
    }

    fn is_unique(&self) -> bool {
        false
    }
}

/// The configuration group of these gizmos ([`bevy::gizmos::config::GizmoConfigStore`]).
#[derive(Default, Reflect, GizmoConfigGroup)]
pub struct LightGizmos;

const OCCLUDER: Color = Color::linear_rgb(1.0, 0.25, 0.1);
const VIEWER: Color = Color::linear_rgb(0.2, 1.0, 0.2);
const BORDER: Color = Color::linear_rgb(0.1, 0.8, 1.0);
/// Alpha of ranges, which cover much of the screen.
const FAINT: f32 = 0.35;

fn draw(
    mut gizmos: Gizmos<LightGizmos>,
    points: Query<(&PointLight2d, &GlobalTransform)>,
    spots: Query<(&SpotLight2d, &GlobalTransform)>,
    viewers: Query<(&Viewer2d, &GlobalTransform)>,
    occluders: Query<(&LightOccluder2d, &GlobalTransform)>,
    cameras: Query<LitCamera>,
) {
    for (lamp, transform) in &points {
        let middle = transform.translation().truncate();
        if middle.is_finite() {
            gizmos.circle_2d(middle, lamp.radius, lamp.color);
            gizmos.circle_2d(middle, lamp.range, lamp.color.with_alpha(FAINT));
        }
    }
    for (lamp, transform) in &spots {
        if let Some(outline) = sector(transform, lamp.range, lamp.angle) {
            gizmos.circle_2d(transform.translation().truncate(), lamp.radius, lamp.color);
            gizmos.linestrip_2d(outline, lamp.color.with_alpha(FAINT));
        }
    }
    for (viewer, transform) in &viewers {
        let middle = transform.translation().truncate();
        if viewer.angle >= TAU && middle.is_finite() {
            gizmos.circle_2d(middle, viewer.range, VIEWER.with_alpha(FAINT));
        } else if let Some(outline) = sector(transform, viewer.range, viewer.angle) {
            gizmos.linestrip_2d(outline, VIEWER.with_alpha(FAINT));
        }
    }
    for (occluder, transform) in &occluders {
        let outline = outline(&occluder.shape).into_iter();
        let at = |point: Vec2| transform.transform_point(point.extend(0.0)).truncate();
        let outline: Vec<_> = outline.map(at).filter(|point| point.is_finite()).collect();
        let closed = outline.iter().chain(outline.first());
        gizmos.linestrip_2d(closed.copied(), OCCLUDER);
    }
    for placement in cameras.iter().filter_map(|camera| camera.placement().ok().flatten()) {
        let area = placement.area();
        gizmos.rect_2d(Isometry2d::from_translation(area.center()), area.size(), BORDER);
    }
}

/// The outline of the sector of a circle around an entity's own x axis; `None` if the numbers make no sense.
fn sector(transform: &GlobalTransform, radius: f32, angle: f32) -> Option<Vec<Vec2>> {
    /// Segments of either half of the arc.
    const HALF: i32 = 8;
    let middle = transform.translation().truncate();
    let ahead = transform.affine().transform_vector3(Vec3::X).truncate().to_angle();
    let edge = |i: i32| {
        let side = i as f32 / HALF as f32;
        middle + radius * Vec2::from_angle(ahead + side * 0.5 * angle)
    };
    let is_sector = middle.is_finite() && ahead.is_finite() && angle.is_finite();
    is_sector
        .then(|| [middle].into_iter().chain((-HALF..=HALF).map(edge)).chain([middle]).collect())
}

/// The outline of a shape, in the entity's own units.
fn outline(shape: &OccluderShape) -> Vec<Vec2> {
    /// Segments of a circle.
    const AROUND: usize = 32;
    let arc = |middle: Vec2, radius: f32, from: usize, to: usize| {
        (from..=to).map(move |i| {
            let angle = i as f32 / AROUND as f32 * TAU;
            middle + radius * Vec2::from_angle(angle)
        })
    };
    match shape {
        OccluderShape::Rectangle { size } => {
            let half = 0.5 * *size;
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| half * Vec2::new(x, y))
                .into()
        }
        OccluderShape::Circle { radius } => arc(Vec2::ZERO, *radius, 0, AROUND).collect(),
        OccluderShape::Capsule { radius, length } => {
            let end = Vec2::new(0.0, 0.5 * length);
            let top = arc(end, *radius, 0, AROUND / 2);
            top.chain(arc(-end, *radius, AROUND / 2, AROUND)).collect()
        }
        OccluderShape::Polygon { points } => points.clone(),
    }
}
