//! Quads of occluders: shapes without an image.

use super::place::{EntityPlaceItem, SceneAssets};
use super::quad::{Quad, QuadMap, QuadShape};
use super::source::{QuadSource, QuadWriter};
use crate::components::{LightOccluder2d, OccluderShape};
use bevy::asset::AssetId;
use bevy::math::Vec2;
use earcut::Earcut;

impl QuadSource for &LightOccluder2d {
    fn push_quads(&self, place: &EntityPlaceItem, _: &SceneAssets, to: &mut QuadWriter) {
        let world = place.transform.affine();
        let centered = |size: Vec2| QuadMap::of_box(-0.5 * size, size, &world);
        match &self.shape {
            OccluderShape::Rectangle { size } => {
                to.push(Quad::shape(centered(*size), QuadShape::Square).by_area());
            }
            OccluderShape::Circle { radius } => {
                let map = centered(Vec2::splat(2.0 * radius));
                to.push(Quad::shape(map, QuadShape::Circle).by_area());
            }
            OccluderShape::Capsule { radius, length } => {
                let height = 2.0 * radius + length;
                let map = centered(Vec2::new(2.0 * radius, height));
                let quad = Quad::shape(map, QuadShape::Capsule).by_area();
                to.push(Quad { param: 2.0 * radius / height, ..quad });
            }
            OccluderShape::Polygon { points } => {
                let in_world = |point: &Vec2| world.transform_point3(point.extend(0.0)).truncate();
                if !to.shows(points.iter().map(in_world)) {
                    return;
                }
                let at = |i: &u32| in_world(&points[*i as usize]);
                for [a, b, c] in triangles(points).as_chunks().0 {
                    let triangle = QuadMap::of_triangle([at(a), at(b), at(c)]);
                    to.push(Quad::shape(triangle, QuadShape::Triangle));
                }
            }
        }
        to.finish_group(place, AssetId::default(), false);
    }
}

/// Triangulates a polygon. Returns indices of its points, three per triangle.
fn triangles(points: &[Vec2]) -> Vec<u32> {
    let mut corners = Vec::new();
    if points.iter().all(|point| point.is_finite()) {
        Earcut::new().earcut(points.iter().map(|p| p.to_array()), &[], &mut corners);
    }
    corners
}
