//! The rasterizer of quads on the CPU; the counterpart of shaders/quads.wgsl.

mod around;

pub use around::{digest_around, digest_of, images_around, rasterize_around};

use crate::components::BRIGHTEST;
use crate::placement::Placement;
use crate::quads::{
    ExtractedScene, Quad, QuadGroup, QuadMap, QuadMaterial, QuadShape, SceneAssets,
};
use bevy::asset::AssetId;
use bevy::camera::visibility::RenderLayers;
use bevy::color::{Alpha, Color, ColorToComponents};
use bevy::image::Image;
use bevy::log::warn_once;
use bevy::math::{Mat2, Rect, Vec2, Vec4};
use lamplight::{Cells, Matter};

/// The last place of a side of the unit square.
const LAST: f32 = 1.0 - 0.5 * f32::EPSILON;
/// Coverage below this counts as none, and above 1 minus this as full: a trace of fog would turn a wall into a medium.
const ROUNDING: f32 = 1e-4;

/// Clears the cells and draws all matter on the layers. Lamps are not drawn.
pub fn rasterize(
    scene: &ExtractedScene,
    grid: &Placement,
    layers: &RenderLayers,
    assets: &SceneAssets,
    to: &mut Cells,
) {
    to.clear();
    let cells = [to.width(), to.height()];
    for_each_quad(scene, grid, layers, assets, |quad, material, image| {
        let (opacity, tint) = material.over(grid.cell);
        let piece = Piece { quad, image, by_area: quad.is_by_area(material), is_colored: true };
        for_each_cell(&piece, &grid.on_grid(&quad.world), cells, |x, y, color| {
            let rgb = color.truncate().to_array();
            let product =
                |by: [f32; 3], max: f32| std::array::from_fn(|c| by[c] * rgb[c].clamp(0.0, max));
            let matter = Matter {
                emission: product(material.emission, f32::MAX).map(|v: f32| v.min(BRIGHTEST)),
                opacity,
                tint,
                albedo: product(material.albedo, 1.0),
                ..Matter::EMPTY
            };
            let i = (y * to.width() + x) as usize;
            to.set(x, y, matter.over(to.matter(i), color.w.min(1.0)));
        });
    });
}

/// Draws the light layers of cells, of each from whatever covers half of it or more.
pub fn rasterize_masks(
    scene: &ExtractedScene,
    grid: &Placement,
    layers: &RenderLayers,
    assets: &SceneAssets,
    to: &mut Cells,
) {
    let cells @ [width, _] = [to.width(), to.height()];
    for_each_quad(scene, grid, layers, assets, |quad, material, image| {
        let masks = to.masks_mut();
        let piece = Piece { quad, image, by_area: quad.is_by_area(material), is_colored: true };
        for_each_cell(&piece, &grid.on_grid(&quad.world), cells, |x, y, color| {
            if color.w >= 0.5 {
                masks[(y * width + x) as usize] = material.bits as u8;
            }
        });
    });
}

/// Visits the quads on the layers that may lie on the grid, from the bottom to the top, with their material and image.
fn for_each_quad(
    scene: &ExtractedScene,
    grid: &Placement,
    layers: &RenderLayers,
    assets: &SceneAssets,
    mut draw: impl FnMut(&Quad, &QuadMaterial, Option<&Image>),
) {
    for group in groups_on(scene, grid.area(), layers) {
        let Some(image) = image_of(group, assets) else { continue };
        for quad in scene.quads_of(group) {
            draw(quad, &scene.materials[quad.material as usize], image);
        }
    }
}

/// The groups on the layers that may overlap an area, from the bottom to the top.
fn groups_on<'a>(
    scene: &'a ExtractedScene,
    area: Rect,
    layers: &'a RenderLayers,
) -> impl Iterator<Item = &'a QuadGroup> {
    scene.groups.iter().filter(move |own| own.layers.intersects(layers) && own.touches(area))
}

/// The image that a group shows, or none if it is plain; `None` while it is not loaded. An app without images takes all
/// quads as plain.
fn image_of<'a>(group: &QuadGroup, assets: &'a SceneAssets) -> Option<Option<&'a Image>> {
    let Some(images) = assets.images.as_ref() else { return Some(None) };
    match images.get(group.image) {
        None if group.image == AssetId::default() => Some(None),
        image => image.map(Some),
    }
}

/// A quad to be drawn, and its image.
struct Piece<'a> {
    quad: &'a Quad,
    image: Option<&'a Image>,
    /// True if it covers cells by the fraction of their area.
    by_area: bool,
    /// False if only its coverage counts.
    is_colored: bool,
}

/// Visits the cells that a quad covers by its map onto them, with its colour there; alpha is its coverage, above 0.
fn for_each_cell(
    piece: &Piece,
    map: &QuadMap,
    [width, height]: [u32; 2],
    mut draw: impl FnMut(u32, u32, Vec4),
) {
    let Some(back) = map.inverse() else { return };
    let step = back.matrix2;
    let bounds = map.bounds().inflate(if piece.by_area { 1.0 } else { 0.0 });
    // Casts saturate at the edges of the grid.
    let range = |low: f32, high: f32, end: u32| low.floor() as u32..(high.ceil() as u32).min(end);
    let columns = range(bounds.min.x, bounds.max.x, width);
    for y in range(bounds.min.y, bounds.max.y, height) {
        for x in columns.clone() {
            let center = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let color = piece.color_at(back.transform_point2(center), step);
            if color.w > 0.0 {
                draw(x, y, color);
            }
        }
    }
}

impl Piece<'_> {
    /// The colour at a point of the unit square; alpha is the coverage of the cell there, whose steps to the right and
    /// down are the columns of `step`.
    fn color_at(&self, unit: Vec2, step: Mat2) -> Vec4 {
        let Self { quad, image, by_area, is_colored } = *self;
        let is_round = quad.is(QuadShape::Circle) || quad.is(QuadShape::Capsule);
        let coverage = if by_area {
            match self.area(unit, step) {
                area if area < ROUNDING => 0.0,
                area if area > 1.0 - ROUNDING => 1.0,
                area => area,
            }
        } else {
            let is_inside = unit.min_element() >= 0.0
                && unit.max_element() < 1.0
                && (!is_round || self.depth(unit) >= 0.0)
                && (!quad.is(QuadShape::Triangle) || unit.element_sum() < 1.0);
            f32::from(u8::from(is_inside))
        };
        if coverage <= 0.0 {
            return Vec4::ZERO;
        }
        // Beyond the edge its nearest texel counts.
        let unit = unit.clamp(Vec2::ZERO, Vec2::splat(LAST));
        let texel = image.map_or(Vec4::ONE, |image| {
            texel(image, &quad.texels, unit, quad.layer).map_or(Vec4::ONE, |color| {
                if is_colored {
                    color.to_linear().to_vec4()
                } else {
                    Vec4::ONE.with_w(color.alpha())
                }
            })
        });
        let mut color = texel * Vec4::from(quad.color);
        if !is_round && quad.param < 0.0 {
            color.w = 1.0;
        } else if !is_round && quad.param > 0.0 {
            color.w = if color.w >= quad.param { 1.0 } else { 0.0 };
        }
        color.w *= coverage;
        color
    }

    /// The depth of a point of the unit square inside a circle or an upright capsule; below 0 outside. The unit is
    /// arbitrary.
    fn depth(&self, unit: Vec2) -> f32 {
        if self.quad.is(QuadShape::Circle) {
            return 0.5 - (unit - 0.5).length();
        }
        let param = self.quad.param;
        let across = 2.0 * (unit - 0.5).abs() * Vec2::new(param, 1.0);
        param - Vec2::new(across.x, (across.y - (1.0 - param)).max(0.0)).length()
    }

    /// The fraction of a cell that the quad covers by its area: exact for upright squares, elsewhere as if the edge were
    /// straight and faced the cell.
    fn area(&self, unit: Vec2, step: Mat2) -> f32 {
        if self.quad.is(QuadShape::Square) {
            let overlap = |at: f32, width: f32| {
                let covered = (at + 0.5 * width).min(1.0) - (at - 0.5 * width).max(0.0);
                covered.max(0.0) / width.max(1e-12)
            };
            let width = [step.row(0).length(), step.row(1).length()];
            return overlap(unit.x, width[0]) * overlap(unit.y, width[1]);
        }
        let slope = |step: Vec2| self.depth(unit + 0.5 * step) - self.depth(unit - 0.5 * step);
        let slope = Vec2::new(slope(step.x_axis), slope(step.y_axis));
        (0.5 + self.depth(unit) / slope.length().max(1e-12)).clamp(0.0, 1.0)
    }
}

/// The nearest texel; `None` if the image is compressed or not kept on the CPU.
fn texel(image: &Image, texels: &QuadMap, unit: Vec2, layer: u32) -> Option<Color> {
    let size = image.size();
    let at = (texels.at(unit.x, unit.y) * size.as_vec2()).floor();
    let at = at.clamp(Vec2::ZERO, size.as_vec2() - 1.0).as_uvec2();
    let color = if image.texture_descriptor.size.depth_or_array_layers == 1 {
        image.get_color_at(at.x, at.y)
    } else {
        image.get_color_at_3d(at.x, at.y, layer)
    };
    if color.is_err() {
        warn_once!(
            "images that are compressed, or kept on the GPU alone, are opaque to `LightQuery`, and to light from off \
             screen: the CPU cannot read them"
        );
    }
    color.ok()
}
