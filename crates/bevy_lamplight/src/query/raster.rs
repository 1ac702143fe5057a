//! The rasterizer of quads on the CPU; the counterpart of shaders/quads.wgsl.

use crate::placement::Placement;
use crate::quads::{ExtractedScene, Quad, QuadMap, QuadMaterial, QuadShape, SceneAssets};
use bevy::camera::visibility::RenderLayers;
use bevy::color::ColorToComponents;
use bevy::image::Image;
use bevy::math::{Vec2, Vec4};
use lamplight::{Cells, Matter};

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
        for_each_cell(quad, grid, image, cells, |x, y, color| {
            let rgb = color.truncate().to_array();
            let product =
                |by: [f32; 3], max: f32| std::array::from_fn(|c| by[c] * rgb[c].clamp(0.0, max));
            let matter = Matter {
                emission: product(material.emission, f32::MAX),
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
        for_each_cell(quad, grid, image, cells, |x, y, color| {
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
    let area = grid.area();
    let groups = scene.groups.iter().filter(|group| group.layers.intersects(layers));
    for group in groups.filter(|group| group.touches(area)) {
        let image = assets.images.as_ref().and_then(|images| images.get(group.image));
        for quad in scene.quads_of(group) {
            draw(quad, &scene.materials[quad.material as usize], image);
        }
    }
}

/// Visits the cells that a quad covers, with its colour there; alpha is its coverage, above 0.
fn for_each_cell(
    quad: &Quad,
    grid: &Placement,
    image: Option<&Image>,
    [width, height]: [u32; 2],
    mut draw: impl FnMut(u32, u32, Vec4),
) {
    let map = grid.on_grid(&quad.world);
    let Some(back) = map.inverse() else { return };
    let bounds = map.bounds();
    // Casts saturate at the edges of the grid.
    let range = |low: f32, high: f32, end: u32| low.floor() as u32..(high.ceil() as u32).min(end);
    let columns = range(bounds.min.x, bounds.max.x, width);
    for y in range(bounds.min.y, bounds.max.y, height) {
        for x in columns.clone() {
            let center = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let color = color_at(quad, back.transform_point2(center), image);
            if color.w > 0.0 {
                draw(x, y, color);
            }
        }
    }
}

/// The colour of a quad at a point of its unit square; alpha is its coverage there.
fn color_at(quad: &Quad, unit: Vec2, image: Option<&Image>) -> Vec4 {
    if unit.min_element() < 0.0 || unit.max_element() >= 1.0 {
        return Vec4::ZERO;
    }
    let from_middle = unit - 0.5;
    let is_inside = if quad.shape == QuadShape::Circle as u32 {
        from_middle.length_squared() <= 0.25
    } else if quad.shape == QuadShape::Capsule as u32 {
        let across = 2.0 * from_middle.abs() * Vec2::new(quad.param, 1.0);
        Vec2::new(across.x, (across.y - (1.0 - quad.param)).max(0.0)).length() <= quad.param
    } else if quad.shape == QuadShape::Triangle as u32 {
        unit.element_sum() < 1.0
    } else {
        true
    };
    if !is_inside {
        return Vec4::ZERO;
    }
    let texel = image.map_or(Vec4::ONE, |image| texel(image, &quad.texels, unit, quad.layer));
    let mut color = texel * Vec4::from(quad.color);
    let is_shape =
        quad.shape == QuadShape::Circle as u32 || quad.shape == QuadShape::Capsule as u32;
    if !is_shape && quad.param < 0.0 {
        color.w = 1.0;
    } else if !is_shape && quad.param > 0.0 {
        color.w = if color.w >= quad.param { 1.0 } else { 0.0 };
    }
    color
}

/// The nearest texel; white if the image is compressed or not kept on the CPU.
fn texel(image: &Image, texels: &QuadMap, unit: Vec2, layer: u32) -> Vec4 {
    let size = image.size();
    let at = (texels.at(unit.x, unit.y) * size.as_vec2()).floor();
    let at = at.clamp(Vec2::ZERO, size.as_vec2() - 1.0).as_uvec2();
    let color = if image.texture_descriptor.size.depth_or_array_layers == 1 {
        image.get_color_at(at.x, at.y)
    } else {
        image.get_color_at_3d(at.x, at.y, layer)
    };
    color.map_or(Vec4::ONE, |color| color.to_linear().to_vec4())
}
