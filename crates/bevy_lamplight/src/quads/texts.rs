//! Quads of texts: one per glyph. Backgrounds, underlines, strikethroughs and shadows are left out.

use super::place::{EntityPlaceItem, SceneAssets};
use super::quad::{AlphaCutoff, Quad, QuadMap};
use super::source::{QuadSource, QuadWriter};
use bevy::color::ColorToComponents;
use bevy::ecs::query::QueryData;
use bevy::math::{Affine3A, Vec2, Vec3};
use bevy::prelude::LinearRgba;
use bevy::sprite::Anchor;
use bevy::text::{ComputedTextBlock, PositionedGlyph, TextBounds, TextLayoutInfo};

/// A text that has been laid out.
#[derive(QueryData)]
pub struct TextMatter {
    block: &'static ComputedTextBlock,
    layout: &'static TextLayoutInfo,
    bounds: &'static TextBounds,
    anchor: &'static Anchor,
}

impl QuadSource for TextMatterItem<'_, '_> {
    fn push_quads(&self, place: &EntityPlaceItem, assets: &SceneAssets, to: &mut QuadWriter) {
        let layout = self.layout;
        // The layout is in physical pixels, y down; bounds are in logical ones.
        let scale = layout.scale_factor.recip();
        let size = Vec2::new(
            self.bounds.width.unwrap_or(layout.size.x * scale),
            self.bounds.height.unwrap_or(layout.size.y * scale),
        );
        let top_left = (Anchor::TOP_LEFT.as_vec() - self.anchor.as_vec()) * size;
        let world = place.transform.affine()
            * Affine3A::from_translation(top_left.extend(0.0))
            * Affine3A::from_scale(Vec3::new(scale, -scale, 1.0));
        let is_one_group = |a: &PositionedGlyph, b: &PositionedGlyph| {
            (a.section_index, a.atlas_info.texture) == (b.section_index, b.atlas_info.texture)
        };
        for run in layout.glyphs.chunk_by(is_one_group) {
            let image = run[0].atlas_info.texture;
            let atlas = assets.images.as_ref().and_then(|images| images.get(image));
            let Some(atlas) = atlas.map(|image| image.size_f32()) else { continue };
            let section = self.block.entities().get(run[0].section_index as usize);
            let color = section.and_then(|section| assets.text_colors.get(section.entity).ok());
            let color = color.map_or(LinearRgba::WHITE, |color| color.0.to_linear());
            for glyph in run {
                let rect = glyph.atlas_info.rect;
                let map = QuadMap::of_box(glyph.position - 0.5 * rect.size(), rect.size(), &world);
                let texels = QuadMap::of_texels(rect, atlas).mirrored([false, true]);
                to.push(Quad::image(map, texels, color.to_f32_array(), AlphaCutoff::Blend));
            }
            to.finish_group(place, image, true);
        }
    }
}
