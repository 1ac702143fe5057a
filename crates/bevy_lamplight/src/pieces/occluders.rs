//! Shapes without a picture.

use super::gather::PlaceItem;
use super::{Kind, Map, Piece, Shape, Surroundings};
use crate::components::{LightOccluder2d, OccluderShape};
use bevy::asset::AssetId;
use bevy::math::{Rect, Vec2};
use earcut::Earcut;

/// Adds an occluder's pieces.
pub fn cut_up(
    occluder: &LightOccluder2d,
    place: &PlaceItem,
    substance: u32,
    areas: &[Rect],
    to: &mut Surroundings,
) {
    let world = place.transform.affine();
    let from = to.pieces.len();
    let mut add = |piece: Piece| to.pieces.push(Piece { substance, ..piece });
    let around = |size: Vec2| Map::of_box(-0.5 * size, size, &world);
    match &occluder.shape {
        OccluderShape::Rectangle { size } => add(Piece::shape(around(*size), Shape::Square)),
        OccluderShape::Circle { radius } => {
            add(Piece::shape(around(Vec2::splat(2.0 * radius)), Shape::Circle));
        }
        OccluderShape::Capsule { radius, length } => {
            let height = 2.0 * radius + length;
            let piece = Piece::shape(around(Vec2::new(2.0 * radius, height)), Shape::Capsule);
            add(Piece { param: 2.0 * radius / height, ..piece });
        }
        OccluderShape::Polygon { points } => {
            let at = |i: &u32| world.transform_point3(points[*i as usize].extend(0.0)).truncate();
            for [a, b, c] in triangles(points).as_chunks().0 {
                let triangle = Map::of_triangle([at(a), at(b), at(c)]);
                add(Piece::shape(triangle, Shape::Triangle));
            }
        }
    }
    let z = place.transform.translation().z;
    let kind = Kind { image: AssetId::default(), layers: place.layers(), is_seen: false, z };
    to.close(from, kind, areas);
}

/// Numbers of corners, three a triangle.
fn triangles(points: &[Vec2]) -> Vec<u32> {
    let mut corners = Vec::new();
    if points.iter().all(|point| point.is_finite()) {
        Earcut::new().earcut(points.iter().map(|p| p.to_array()), &[], &mut corners);
    }
    corners
}
