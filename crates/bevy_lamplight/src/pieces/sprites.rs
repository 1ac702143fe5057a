//! Sprites: sheets, parts, flips, anchors, scaling, nine-slices and tiling, as Bevy draws them.

use super::gather::{Pictures, PlaceItem};
use super::{Cutoff, Kind, Map, Piece, Surroundings};
use bevy::color::ColorToComponents;
use bevy::ecs::query::QueryData;
use bevy::math::{Rect, Vec2};
use bevy::prelude::{LinearRgba, Sprite, SpriteImageMode};
use bevy::sprite::{Anchor, SpriteScalingMode, TextureSlice};

#[derive(QueryData)]
pub struct SpriteMatter {
    sprite: &'static Sprite,
    anchor: Option<&'static Anchor>,
}

impl SpriteMatterItem<'_, '_> {
    /// Adds its pieces; none before its picture is loaded.
    pub fn cut_up(
        &self,
        place: &PlaceItem,
        substance: u32,
        pictures: &Pictures,
        areas: &[Rect],
        to: &mut Surroundings,
    ) {
        let sprite = self.sprite;
        // A server may have no images, and then knows the size by itself or not at all.
        let image = pictures.images.as_ref().and_then(|images| images.get(&sprite.image));
        let Some(picture) = image.map(|image| image.size_f32()).or(sprite.custom_size) else {
            return;
        };
        let Some(texels) = self.texels(picture, pictures) else { return };
        let anchor = self.anchor.map_or(Vec2::ZERO, |anchor| anchor.as_vec());
        let world = place.transform.affine();
        let color = LinearRgba::from(sprite.color).to_f32_array();
        let flips = [sprite.flip_x, sprite.flip_y];
        let from = to.pieces.len();
        let mut add = |min: Vec2, size: Vec2, texels: Map| {
            let world = Map::of_box(min, size, &world);
            let piece = Piece::picture(world, texels.mirrored(flips), color, Cutoff::Blend);
            to.pieces.push(Piece { substance, ..piece });
        };
        match slices(sprite, texels) {
            None => {
                let fitted = self.fit(texels, picture);
                let corner = (fitted.size + fitted.shift) * (-anchor - 0.5);
                add(corner, fitted.size, fitted.texels);
            }
            Some(slices) => {
                let anchor = anchor * sprite.custom_size.unwrap_or(texels.size());
                let flip = Vec2::from(flips.map(|flip| if flip { -1.0 } else { 1.0 }));
                for TextureSlice { texture_rect, draw_size, offset } in slices {
                    let corner = offset * flip - anchor - 0.5 * draw_size;
                    add(corner, draw_size, Map::of_texels(texture_rect, picture));
                }
            }
        }
        let z = place.transform.translation().z;
        let kind = Kind { image: sprite.image.id(), layers: place.layers(), is_seen: true, z };
        to.close(from, kind, areas);
    }

    /// The part of the picture that is shown.
    fn texels(&self, picture: Vec2, pictures: &Pictures) -> Option<Rect> {
        let sprite = self.sprite;
        let cell = match &sprite.texture_atlas {
            None => None,
            Some(atlas) => Some(atlas.texture_rect(pictures.atlases.as_ref()?)?.as_rect()),
        };
        let texels = match (cell, sprite.rect) {
            (None, None) => Rect { min: Vec2::ZERO, max: picture },
            (Some(rect), None) | (None, Some(rect)) => rect,
            (Some(cell), Some(rect)) => Rect { min: rect.min + cell.min, max: rect.max + cell.min },
        };
        Some(texels)
    }

    /// How it is scaled.
    fn fit(&self, texels: Rect, picture: Vec2) -> Fitted {
        let size = self.sprite.custom_size.unwrap_or(texels.size());
        let whole = Fitted { size, shift: Vec2::ZERO, texels: Map::of_texels(texels, picture) };
        let SpriteImageMode::Scale(mode) = &self.sprite.image_mode else { return whole };
        // How much wider than the picture it is.
        let wider = (size.x / size.y) / (texels.width() / texels.height());
        const START: f32 = 0.0;
        const CENTER: f32 = 0.5;
        const END: f32 = 1.0;
        let (fills, along) = match mode {
            SpriteScalingMode::FillStart => (true, START),
            SpriteScalingMode::FillCenter => (true, CENTER),
            SpriteScalingMode::FillEnd => (true, END),
            SpriteScalingMode::FitStart => (false, START),
            SpriteScalingMode::FitCenter => (false, CENTER),
            SpriteScalingMode::FitEnd => (false, END),
        };
        if fills {
            // What is too much of the picture is cut off; unit squares count from the bottom.
            let (min, size) = match wider > 1.0 {
                true => (
                    Vec2::new(0.0, (1.0 - along) * (1.0 - 1.0 / wider)),
                    Vec2::new(1.0, 1.0 / wider),
                ),
                false => (Vec2::new(along * (1.0 - wider), 0.0), Vec2::new(wider, 1.0)),
            };
            return Fitted { texels: whole.texels.cut(min, size), ..whole };
        }
        let fitted = match wider > 1.0 {
            true => Vec2::new(size.x / wider, size.y),
            false => Vec2::new(size.x, size.y * wider),
        };
        let left = size - fitted;
        let shift = (1.0 - 2.0 * along) * Vec2::new(left.x, -left.y);
        Fitted { size: fitted, shift, ..whole }
    }
}

/// What of a picture is shown, how large, and how far beside its place.
struct Fitted {
    size: Vec2,
    shift: Vec2,
    texels: Map,
}

/// What it is made of, where it is cut into slices.
fn slices(sprite: &Sprite, texels: Rect) -> Option<Vec<TextureSlice>> {
    match &sprite.image_mode {
        SpriteImageMode::Sliced(slicer) => Some(slicer.compute_slices(texels, sprite.custom_size)),
        &SpriteImageMode::Tiled { tile_x, tile_y, stretch_value } => {
            let draw_size = sprite.custom_size.unwrap_or(texels.size());
            let slice = TextureSlice { texture_rect: texels, draw_size, offset: Vec2::ZERO };
            Some(slice.tiled(stretch_value, (tile_x, tile_y)))
        }
        SpriteImageMode::Auto | SpriteImageMode::Scale(_) => None,
    }
}
