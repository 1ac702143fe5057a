//! Quads of sprites: atlases, parts, flips, anchors, scaling, nine slices and tiling, as Bevy draws
//! them.

use super::place::{EntityPlaceItem, SceneAssets};
use super::quad::{AlphaCutoff, Quad, QuadMap};
use super::source::{QuadSource, QuadWriter};
use super::sprite_layout::SpriteLayout;
use bevy::color::ColorToComponents;
use bevy::ecs::query::QueryData;
use bevy::math::{Rect, Vec2};
use bevy::prelude::{LinearRgba, Sprite};
use bevy::sprite::{Anchor, SpriteAlphaMode};

/// A sprite and its anchor.
#[derive(QueryData)]
pub struct SpriteMatter {
    sprite: &'static Sprite,
    anchor: Option<&'static Anchor>,
}

impl QuadSource for SpriteMatterItem<'_, '_> {
    fn push_quads(&self, place: &EntityPlaceItem, assets: &SceneAssets, to: &mut QuadWriter) {
        let sprite = self.sprite;
        // An app without images, such as a server, relies on the sprite's own size.
        let image = assets.images.as_ref().and_then(|images| images.get(&sprite.image));
        let Some(image) = image.map(|image| image.size_f32()).or(sprite.custom_size) else {
            return;
        };
        let Some(texels) = self.texels(image, assets) else { return };
        let cutoff = match sprite.alpha_mode {
            SpriteAlphaMode::Opaque => AlphaCutoff::Opaque,
            SpriteAlphaMode::Mask(alpha) => AlphaCutoff::Mask(alpha),
            SpriteAlphaMode::Blend => AlphaCutoff::Blend,
        };
        let layout = SpriteLayout::new(sprite, texels.size());
        let anchor = self.anchor.map_or(Vec2::ZERO, |anchor| anchor.as_vec());
        let corner = layout.shift - layout.size * (anchor + 0.5);
        let world = place.transform.affine();
        let color = LinearRgba::from(sprite.color).to_f32_array();
        for slice in &layout.slices {
            // Slices count from the top, the world from the bottom.
            let (mut min, size) = (slice.quad.min, slice.quad.size());
            if !sprite.flip_y {
                min.y = 1.0 - slice.quad.max.y;
            }
            if sprite.flip_x {
                min.x = 1.0 - slice.quad.max.x;
            }
            let map = QuadMap::of_box(corner + min * layout.size, size * layout.size, &world);
            let part = Rect {
                min: texels.min + slice.texels.min * texels.size(),
                max: texels.min + slice.texels.max * texels.size(),
            };
            let shown = QuadMap::of_texels(part, image).mirrored([sprite.flip_x, sprite.flip_y]);
            let quad = Quad::image(map, shown, color, cutoff);
            to.push(if layout.slices.len() == 1 { quad.by_area() } else { quad });
        }
        to.finish_group(place, sprite.image.id(), true);
    }
}

impl SpriteMatterItem<'_, '_> {
    /// The rectangle of the image that the sprite shows, in pixels.
    fn texels(&self, image: Vec2, assets: &SceneAssets) -> Option<Rect> {
        let sprite = self.sprite;
        let cell = match &sprite.texture_atlas {
            None => None,
            Some(atlas) => Some(atlas.texture_rect(assets.atlases.as_ref()?)?.as_rect()),
        };
        let texels = match (cell, sprite.rect) {
            (None, None) => Rect { min: Vec2::ZERO, max: image },
            (Some(rect), None) | (None, Some(rect)) => rect,
            (Some(cell), Some(rect)) => Rect { min: rect.min + cell.min, max: rect.max + cell.min },
        };
        Some(texels)
    }
}
