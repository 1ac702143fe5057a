//! Quads of tilemap chunks: one per tile.

use super::place::{EntityPlaceItem, SceneAssets};
use super::quad::{AlphaCutoff, Quad, QuadMap};
use super::source::{QuadSource, QuadWriter};
use bevy::color::{Color, ColorToPacked};
use bevy::ecs::query::QueryData;
use bevy::math::{Affine3A, Rect, UVec2, Vec2};
use bevy::sprite_render::{AlphaMode2d, TileOrientation, TilemapChunk, TilemapChunkTileData};
use std::ops::Range;

/// A tilemap chunk and its tiles.
#[derive(QueryData)]
pub struct TileMatter {
    chunk: &'static TilemapChunk,
    tiles: &'static TilemapChunkTileData,
}

impl QuadSource for TileMatterItem<'_, '_> {
    /// Adds only tiles that may overlap the areas, so that the cost does not grow with the map.
    fn push_quads(&self, place: &EntityPlaceItem, _: &SceneAssets, to: &mut QuadWriter) {
        let TilemapChunk { chunk_size, tile_display_size, tileset, alpha_mode } = self.chunk;
        let cutoff = match alpha_mode {
            AlphaMode2d::Blend => AlphaCutoff::Blend,
            // Drawn whole whatever the cutoff, but for what the tilemap's own shader discards.
            AlphaMode2d::Opaque | AlphaMode2d::Mask(_) => AlphaCutoff::Mask(DISCARDED),
        };
        let world = place.transform.affine();
        let size = tile_display_size.as_vec2();
        let corner = -0.5 * chunk_size.as_vec2() * size;
        let [columns, rows] = overlapping(to.areas, &world, corner, size, *chunk_size);
        for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
            let tile = self.tiles.get((y * chunk_size.x + x) as usize).copied().flatten();
            let Some(tile) = tile.filter(|tile| tile.visible) else { continue };
            let min = corner + Vec2::new(x as f32, y as f32) * size;
            let map = QuadMap::of_box(min, size, &world);
            let quad = Quad::image(map, texels(tile.orientation), factor(tile.color), cutoff);
            to.push(Quad { layer: tile.tileset_index.into(), ..quad });
        }
        to.finish_group(place, tileset.id(), true);
    }
}

/// The alpha below which the tilemap's shader draws nothing.
const DISCARDED: f32 = 0.001;

/// The factor of a tile's colour. The tilemap's shader takes the bytes of the encoded colour as they are.
fn factor(color: Color) -> [f32; 4] {
    color.to_srgba().to_u8_array().map(|v| f32::from(v) / 255.0)
}

/// All of a tile's image, in one of the eight orientations.
fn texels(orientation: TileOrientation) -> QuadMap {
    let mut texels = QuadMap::whole();
    let mut mirror = |axis: usize| {
        texels.origin[axis] = 1.0 - texels.origin[axis];
        for along in [&mut texels.x_axis, &mut texels.y_axis] {
            along[axis] = -along[axis];
        }
    };
    // In the order of the tilemap's own shader.
    if orientation.mirror_h() {
        mirror(0);
    }
    if orientation.mirror_v() {
        mirror(1);
    }
    if orientation.mirror_d() {
        for v in [&mut texels.x_axis, &mut texels.y_axis, &mut texels.origin] {
            v.swap(0, 1);
        }
    }
    texels
}

/// Columns and rows of tiles that may overlap any of the areas.
fn overlapping(
    areas: &[Rect],
    world: &Affine3A,
    corner: Vec2,
    size: Vec2,
    count: UVec2,
) -> [Range<u32>; 2] {
    // In tiles from the first on.
    let Some(back) = QuadMap::of_box(corner, size, world).inverse() else { return [0..0, 0..0] };
    let corners = |area: &Rect| {
        let Rect { min, max } = *area;
        [min, Vec2::new(max.x, min.y), Vec2::new(min.x, max.y), max]
    };
    let reach = areas
        .iter()
        .flat_map(corners)
        .map(|point| back.transform_point2(point))
        .fold(Rect::EMPTY, |all, point| all.union_point(point));
    // Casts saturate, and turn NaN into 0.
    [0, 1].map(|a| reach.min[a].floor() as u32..(reach.max[a].ceil() as u32).min(count[a]))
}
