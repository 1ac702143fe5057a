//! Tilemap chunks, tile by tile.

use super::gather::PlaceItem;
use super::{Cutoff, Kind, Map, Piece, Surroundings};
use bevy::color::ColorToComponents;
use bevy::ecs::query::QueryData;
use bevy::math::{Affine3A, Rect, UVec2, Vec2};
use bevy::sprite_render::{TilemapChunk, TilemapChunkTileData};
use std::ops::Range;

#[derive(QueryData)]
pub struct TileMatter {
    chunk: &'static TilemapChunk,
    tiles: &'static TilemapChunkTileData,
}

impl TileMatterItem<'_, '_> {
    /// Adds the tiles that may lie in any of the areas, so that the cost does not grow with the map.
    pub fn cut_up(&self, place: &PlaceItem, substance: u32, areas: &[Rect], to: &mut Surroundings) {
        let TilemapChunk { chunk_size, tile_display_size, tileset, .. } = self.chunk;
        let world = place.transform.affine();
        let size = tile_display_size.as_vec2();
        let corner = -0.5 * chunk_size.as_vec2() * size;
        let near = near(areas, &world, corner, size, *chunk_size);
        let from = to.pieces.len();
        for (x, y) in near[1].clone().flat_map(|y| near[0].clone().map(move |x| (x, y))) {
            let tile = self.tiles.get((y * chunk_size.x + x) as usize).copied().flatten();
            let Some(tile) = tile.filter(|tile| tile.visible) else { continue };
            let min = corner + Vec2::new(x as f32, y as f32) * size;
            let turn = tile.orientation;
            let mut texels = Map::whole();
            let mut mirror = |axis: usize| {
                texels.origin[axis] = 1.0 - texels.origin[axis];
                for way in [&mut texels.x_axis, &mut texels.y_axis] {
                    way[axis] = -way[axis];
                }
            };
            // In the order in which the tilemap's own shader turns them.
            if turn.mirror_h() {
                mirror(0);
            }
            if turn.mirror_v() {
                mirror(1);
            }
            if turn.mirror_d() {
                for v in [&mut texels.x_axis, &mut texels.y_axis, &mut texels.origin] {
                    v.swap(0, 1);
                }
            }
            let color = tile.color.to_linear().to_f32_array();
            let piece =
                Piece::picture(Map::of_box(min, size, &world), texels, color, Cutoff::Blend);
            to.pieces.push(Piece { substance, layer: tile.tileset_index.into(), ..piece });
        }
        let z = place.transform.translation().z;
        let kind = Kind { image: tileset.id(), layers: place.layers(), is_seen: true, z };
        to.close(from, kind, areas);
    }
}

/// Columns and rows of tiles that may lie in any of the areas.
fn near(
    areas: &[Rect],
    world: &Affine3A,
    corner: Vec2,
    size: Vec2,
    count: UVec2,
) -> [Range<u32>; 2] {
    let back = world.inverse();
    let corners = |area: &Rect| {
        let Rect { min, max } = *area;
        [min, Vec2::new(max.x, min.y), Vec2::new(min.x, max.y), max]
    };
    let reach = areas
        .iter()
        .flat_map(corners)
        .map(|point| (back.transform_point3(point.extend(0.0)).truncate() - corner) / size)
        .fold(Rect::EMPTY, |all, point| all.union_point(point));
    // Casts keep to what there is, and make nothing of what is no number.
    [0, 1].map(|a| reach.min[a].floor() as u32..(reach.max[a].ceil() as u32).min(count[a]))
}
