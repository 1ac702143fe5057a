//! Texts: their glyphs. Backgrounds, lines under or through them and shadows do not count.

use super::gather::{Pictures, PlaceItem};
use super::{Cutoff, Kind, Map, Piece, Surroundings};
use bevy::color::ColorToComponents;
use bevy::ecs::query::QueryData;
use bevy::math::{Affine3A, Rect, Vec2, Vec3};
use bevy::prelude::LinearRgba;
use bevy::sprite::Anchor;
use bevy::text::{ComputedTextBlock, TextBounds, TextLayoutInfo};

#[derive(QueryData)]
pub struct TextMatter {
    block: &'static ComputedTextBlock,
    layout: &'static TextLayoutInfo,
    bounds: &'static TextBounds,
    anchor: &'static Anchor,
}

impl TextMatterItem<'_, '_> {
    /// Adds its pieces; glyphs of one picture and section are a body.
    pub fn cut_up(
        &self,
        place: &PlaceItem,
        substance: u32,
        pictures: &Pictures,
        areas: &[Rect],
        to: &mut Surroundings,
    ) {
        let layout = self.layout;
        let size = Vec2::new(
            self.bounds.width.unwrap_or(layout.size.x),
            self.bounds.height.unwrap_or(layout.size.y),
        );
        let top_left = (Anchor::TOP_LEFT.as_vec() - self.anchor.as_vec()) * size;
        // Glyphs are laid out in pixels of the screen, y down.
        let scale = layout.scale_factor.recip();
        let world = place.transform.affine()
            * Affine3A::from_translation(top_left.extend(0.0))
            * Affine3A::from_scale(Vec3::new(scale, -scale, 1.0));
        let z = place.transform.translation().z;
        let alike = |a: &bevy::text::PositionedGlyph, b: &bevy::text::PositionedGlyph| {
            (a.section_index, a.atlas_info.texture) == (b.section_index, b.atlas_info.texture)
        };
        for run in layout.glyphs.chunk_by(alike) {
            let image = run[0].atlas_info.texture;
            let atlas = pictures.images.as_ref().and_then(|images| images.get(image));
            let Some(atlas) = atlas.map(|image| image.size_f32()) else { continue };
            let section = self.block.entities().get(run[0].section_index).map(|s| s.entity);
            let color = section.and_then(|section| pictures.text_colors.get(section).ok());
            let color = color.map_or(LinearRgba::WHITE, |color| color.0.to_linear());
            let from = to.pieces.len();
            for glyph in run {
                let rect = glyph.atlas_info.rect;
                let world = Map::of_box(glyph.position - 0.5 * rect.size(), rect.size(), &world);
                let texels = Map::of_texels(rect, atlas).mirrored([false, true]);
                let color = color.to_f32_array();
                let piece = Piece::picture(world, texels, color, Cutoff::Blend);
                to.pieces.push(Piece { substance, ..piece });
            }
            to.close(from, Kind { image, layers: place.layers(), is_seen: true, z }, areas);
        }
    }
}
