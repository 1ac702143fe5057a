//! The layout of a sprite: the parts of its picture, and the part of its quad that each one fills.
//!
//! The formulas are those of Bevy's `sprite_mesh_material.rs` and `sprite_mesh/functions.wesl`, which
//! evaluate them per pixel.

use bevy::math::{Rect, Vec2};
use bevy::prelude::{Sprite, SpriteImageMode};
use bevy::sprite::{SliceScaleMode, SpriteScalingMode, TextureSlicer};

/// A sprite's quad and the slices that cover it.
#[derive(Debug, PartialEq)]
pub struct SpriteLayout {
    /// Width and height of the quad, in the entity's units.
    pub size: Vec2,
    /// Offset of the quad from where its anchor puts it.
    pub shift: Vec2,
    /// Slices, which do not overlap.
    pub slices: Vec<SpriteSlice>,
}

/// A part of a picture that is stretched over a part of a quad. Both are fractions, with y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpriteSlice {
    /// Part of the quad.
    pub quad: Rect,
    /// Part of the shown rectangle of the picture.
    pub texels: Rect,
}

/// The whole of a quad or picture.
const WHOLE: Rect = Rect { min: Vec2::ZERO, max: Vec2::ONE };
/// Most slices of a sprite. Beyond, its picture is stretched instead of tiled.
const MAX_SLICES: usize = 1 << 14;

impl SpriteLayout {
    /// The layout of a sprite that shows `texels` pixels of its picture.
    pub fn new(sprite: &Sprite, texels: Vec2) -> Self {
        let whole = |size| Self {
            size,
            shift: Vec2::ZERO,
            slices: vec![SpriteSlice { quad: WHOLE, texels: WHOLE }],
        };
        // Without a custom size every sprite has its picture's size, whatever its mode.
        let Some(size) = sprite.custom_size else { return whole(texels) };
        match &sprite.image_mode {
            SpriteImageMode::Auto => whole(size),
            SpriteImageMode::Scale(mode) => scaled(*mode, size, texels),
            SpriteImageMode::Tiled { tile_x, tile_y, stretch_value } => {
                let tile = *stretch_value * texels / size;
                let bands = [(*tile_x, tile.x), (*tile_y, tile.y)].map(|(is_tiled, tile)| {
                    let band = Band { quad: [0.0, 1.0], texels: [0.0, 1.0] };
                    if is_tiled { band.tiled(tile) } else { Some(vec![band]) }
                });
                tiles(bands).map_or_else(|| whole(size), |slices| Self { slices, ..whole(size) })
            }
            mode if mode.slice_border_out_of_bounds(texels) => whole(size),
            SpriteImageMode::Sliced(slicer) => nine_slices(slicer, size, texels)
                .map_or_else(|| whole(size), |slices| Self { slices, ..whole(size) }),
        }
    }
}

/// The layout of a picture that keeps its aspect ratio: a larger picture is cut off, a smaller one
/// leaves a part of the sprite empty.
fn scaled(mode: SpriteScalingMode, size: Vec2, texels: Vec2) -> SpriteLayout {
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
    let ratios = size / texels;
    if fills {
        let shown = size / (texels * ratios.max_element());
        let min = along * (1.0 - shown);
        let slice = SpriteSlice { quad: WHOLE, texels: Rect { min, max: min + shown } };
        return SpriteLayout { size, shift: Vec2::ZERO, slices: vec![slice] };
    }
    let fitted = texels * ratios.min_element();
    let shift = (size - fitted) * Vec2::new(along - 0.5, 0.5 - along);
    SpriteLayout { size: fitted, shift, slices: vec![SpriteSlice { quad: WHOLE, texels: WHOLE }] }
}

/// Nine slices: corners that keep their size, sides and a centre that are stretched or tiled.
fn nine_slices(slicer: &TextureSlicer, size: Vec2, texels: Vec2) -> Option<Vec<SpriteSlice>> {
    let min_inset = slicer.border.min_inset / texels;
    let max_inset = slicer.border.max_inset / texels;
    let ratios = size / texels;
    let corner = ratios.min_element().min(slicer.max_corner_scale).max(f32::EPSILON);
    let scale = ratios / corner;
    let (min_quad, max_quad) = (min_inset / scale, max_inset / scale);
    let inner = 1.0 - min_inset - max_inset;
    let tile = texels * inner / (size * (1.0 - min_quad - max_quad));
    let middle = |mode: SliceScaleMode, axis: usize| {
        let band = Band {
            quad: [min_quad[axis], 1.0 - max_quad[axis]],
            texels: [min_inset[axis], 1.0 - max_inset[axis]],
        };
        match mode {
            SliceScaleMode::Stretch => Some(vec![band]),
            SliceScaleMode::Tile { stretch_value } => band.tiled(stretch_value * tile[axis]),
        }
    };
    let ends = |axis: usize| {
        vec![
            Band { quad: [0.0, min_quad[axis]], texels: [0.0, min_inset[axis]] },
            Band { quad: [1.0 - max_quad[axis], 1.0], texels: [1.0 - max_inset[axis], 1.0] },
        ]
    };
    let (sides, center) = (slicer.sides_scale_mode, slicer.center_scale_mode);
    let mut slices = tiles([Some(ends(0)), Some(ends(1))])?;
    slices.extend(tiles([middle(sides, 0), Some(ends(1))])?);
    slices.extend(tiles([Some(ends(0)), middle(sides, 1)])?);
    slices.extend(tiles([middle(center, 0), middle(center, 1)])?);
    slices.retain(|slice| !slice.quad.is_empty());
    Some(slices)
}

/// A range along one axis of a quad, and the range of the picture that it shows.
#[derive(Clone, Copy)]
struct Band {
    quad: [f32; 2],
    texels: [f32; 2],
}

impl Band {
    /// Repeats the picture along the band. `tile` is the length of one repetition as a fraction of the
    /// band; the last one is cut off. `None` if there would be too many.
    fn tiled(self, tile: f32) -> Option<Vec<Self>> {
        let count = (1.0 / tile).ceil();
        if !(tile > 0.0 && count <= MAX_SLICES as f32) {
            return None;
        }
        let at = |[from, to]: [f32; 2], part: f32| from + part * (to - from);
        let repetition = |i: u32| {
            let begin = i as f32 * tile;
            let end = (begin + tile).min(1.0);
            Self {
                quad: [at(self.quad, begin), at(self.quad, end)],
                texels: [self.texels[0], at(self.texels, (end - begin) / tile)],
            }
        };
        Some((0..count as u32).map(repetition).collect())
    }
}

/// The slices of every column and row.
fn tiles([columns, rows]: [Option<Vec<Band>>; 2]) -> Option<Vec<SpriteSlice>> {
    let (columns, rows) = (columns?, rows?);
    if columns.len() * rows.len() > MAX_SLICES {
        return None;
    }
    let rect =
        |x: [f32; 2], y: [f32; 2]| Rect { min: Vec2::new(x[0], y[0]), max: Vec2::new(x[1], y[1]) };
    let slices = rows.iter().flat_map(|row| {
        columns.iter().map(|column| SpriteSlice {
            quad: rect(column.quad, row.quad),
            texels: rect(column.texels, row.texels),
        })
    });
    Some(slices.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::sprite::BorderRect;

    fn layout(image_mode: SpriteImageMode, size: Vec2, texels: Vec2) -> SpriteLayout {
        let sprite = Sprite { image_mode, custom_size: Some(size), ..Sprite::default() };
        SpriteLayout::new(&sprite, texels)
    }

    fn rect(x0: f32, y0: f32, x1: f32, y1: f32) -> Rect {
        Rect { min: Vec2::new(x0, y0), max: Vec2::new(x1, y1) }
    }

    #[test]
    fn a_sprite_without_a_size_has_the_size_of_its_picture() {
        let tiled = SpriteImageMode::Tiled { tile_x: true, tile_y: true, stretch_value: 0.1 };
        let sprite = Sprite { image_mode: tiled, ..Sprite::default() };
        let whole = SpriteSlice { quad: WHOLE, texels: WHOLE };
        let size = Vec2::new(3.0, 5.0);
        let expected = SpriteLayout { size, shift: Vec2::ZERO, slices: vec![whole] };
        assert_eq!(SpriteLayout::new(&sprite, size), expected);
    }

    #[test]
    fn filling_cuts_off_and_fitting_leaves_empty() {
        let (size, texels) = (Vec2::new(40.0, 10.0), Vec2::new(20.0, 10.0));
        let fill = layout(SpriteImageMode::Scale(SpriteScalingMode::FillEnd), size, texels);
        assert_eq!(fill.size, size);
        assert_eq!(fill.slices[0].texels, rect(0.0, 0.5, 1.0, 1.0));
        let fit = layout(SpriteImageMode::Scale(SpriteScalingMode::FitStart), size, texels);
        assert_eq!((fit.size, fit.shift), (Vec2::new(20.0, 10.0), Vec2::new(-10.0, 0.0)));
    }

    #[test]
    fn tiles_begin_at_the_top_left_and_the_last_ones_are_cut_off() {
        let mode = SpriteImageMode::Tiled { tile_x: true, tile_y: false, stretch_value: 1.0 };
        let slices = layout(mode, Vec2::new(10.0, 7.0), Vec2::splat(4.0)).slices;
        let expected = [
            SpriteSlice { quad: rect(0.0, 0.0, 0.4, 1.0), texels: WHOLE },
            SpriteSlice { quad: rect(0.4, 0.0, 0.8, 1.0), texels: WHOLE },
            SpriteSlice { quad: rect(0.8, 0.0, 1.0, 1.0), texels: rect(0.0, 0.0, 0.5, 1.0) },
        ];
        assert_eq!(slices.len(), expected.len());
        for (slice, expected) in slices.iter().zip(&expected) {
            let near =
                |a: Rect, b: Rect| a.min.abs_diff_eq(b.min, 1e-6) && a.max.abs_diff_eq(b.max, 1e-6);
            assert!(near(slice.quad, expected.quad), "{slice:?}, not {expected:?}");
            assert!(near(slice.texels, expected.texels), "{slice:?}, not {expected:?}");
        }
    }

    #[test]
    fn nine_slices_cover_the_quad_once() {
        let tile = SliceScaleMode::Tile { stretch_value: 0.5 };
        let slicer = TextureSlicer {
            border: BorderRect::all(4.0),
            center_scale_mode: tile,
            sides_scale_mode: tile,
            max_corner_scale: 1.0,
        };
        let slices =
            layout(SpriteImageMode::Sliced(slicer), Vec2::new(50.0, 30.0), Vec2::splat(16.0))
                .slices;
        let area: f32 = slices.iter().map(|slice| slice.quad.size().element_product()).sum();
        assert!((area - 1.0).abs() < 1e-5, "{area}");
        // Corners keep their size: 4 of 50 × 30 units.
        let corner = slices.iter().find(|slice| slice.quad.min == Vec2::ZERO).unwrap();
        assert_eq!(corner.texels, rect(0.0, 0.0, 0.25, 0.25));
        assert!(corner.quad.max.abs_diff_eq(Vec2::new(4.0 / 50.0, 4.0 / 30.0), 1e-6));
    }

    #[test]
    fn too_many_tiles_become_one() {
        let mode = SpriteImageMode::Tiled { tile_x: true, tile_y: true, stretch_value: 1.0 };
        assert_eq!(layout(mode, Vec2::splat(1e4), Vec2::ONE).slices.len(), 1);
        for stretch_value in [0.0, -1.0, f32::NAN] {
            let mode = SpriteImageMode::Tiled { tile_x: true, tile_y: true, stretch_value };
            assert_eq!(layout(mode, Vec2::splat(8.0), Vec2::ONE).slices.len(), 1);
        }
    }
}
