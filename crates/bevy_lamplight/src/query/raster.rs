//! Pieces drawn into cells on the CPU, as shaders/pieces.wgsl draws them on the GPU.

use crate::pieces::{Map, Pictures, Piece, Shape, Substance, Surroundings};
use crate::placement::Placement;
use bevy::camera::visibility::RenderLayers;
use bevy::color::ColorToComponents;
use bevy::image::Image;
use bevy::math::{Vec2, Vec4};
use lamplight::{Cells, Matter};

/// Draws what is on some layers; lamps are not among it. The grid is emptied first.
pub fn rasterize(
    from: &Surroundings,
    grid: &Placement,
    layers: &RenderLayers,
    pictures: &Pictures,
    to: &mut Cells,
) {
    to.clear();
    let area = grid.area();
    let bodies = from.bodies.iter().filter(|body| body.layers.intersects(layers));
    for body in bodies.filter(|body| body.touches(area)) {
        let picture = pictures.images.as_ref().and_then(|images| images.get(body.image));
        for piece in from.pieces_of(body) {
            let substance = from.substances[piece.substance as usize];
            draw(piece, &substance, grid, picture, to);
        }
    }
}

fn draw(
    piece: &Piece,
    substance: &Substance,
    grid: &Placement,
    picture: Option<&Image>,
    to: &mut Cells,
) {
    let map = grid.on_grid(&piece.world);
    let Some(back) = map.inverse() else { return };
    let bounds = map.bounds();
    // Casts keep to the grid.
    let range = |low: f32, high: f32, most: u32| low.floor() as u32..(high.ceil() as u32).min(most);
    let columns = range(bounds.min.x, bounds.max.x, to.width());
    let (opacity, tint) = substance.over(grid.cell);
    for y in range(bounds.min.y, bounds.max.y, to.height()) {
        for x in columns.clone() {
            let center = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let unit = back.transform_point2(center);
            let color = shown(piece, unit, picture);
            if color.w <= 0.0 {
                continue;
            }
            let rgb = color.truncate().to_array();
            let product =
                |by: [f32; 3], most: f32| std::array::from_fn(|c| by[c] * rgb[c].clamp(0.0, most));
            let matter = Matter {
                emission: product(substance.emission, f32::MAX),
                opacity,
                tint,
                albedo: product(substance.albedo, 1.0),
            };
            let i = (y * to.width() + x) as usize;
            to.set(x, y, matter.over(to.matter(i), color.w.min(1.0)));
        }
    }
}

/// Colour of a piece at a place of its unit square, and the share that it covers there.
fn shown(piece: &Piece, unit: Vec2, picture: Option<&Image>) -> Vec4 {
    if unit.min_element() < 0.0 || unit.max_element() >= 1.0 {
        return Vec4::ZERO;
    }
    let from_middle = unit - 0.5;
    let is_inside = if piece.shape == Shape::Circle as u32 {
        from_middle.length_squared() <= 0.25
    } else if piece.shape == Shape::Capsule as u32 {
        let across = 2.0 * from_middle.abs() * Vec2::new(piece.param, 1.0);
        Vec2::new(across.x, (across.y - (1.0 - piece.param)).max(0.0)).length() <= piece.param
    } else if piece.shape == Shape::Triangle as u32 {
        unit.element_sum() < 1.0
    } else {
        true
    };
    if !is_inside {
        return Vec4::ZERO;
    }
    let texel = picture.map_or(Vec4::ONE, |image| texel(image, &piece.texels, unit, piece.layer));
    let mut color = texel * Vec4::from(piece.color);
    let is_shape = piece.shape == Shape::Circle as u32 || piece.shape == Shape::Capsule as u32;
    if !is_shape && piece.param < 0.0 {
        color.w = 1.0;
    } else if !is_shape && piece.param > 0.0 {
        color.w = if color.w >= piece.param { 1.0 } else { 0.0 };
    }
    color
}

/// The nearest texel; white where the picture is not kept on the CPU, or is compressed.
fn texel(image: &Image, texels: &Map, unit: Vec2, layer: u32) -> Vec4 {
    let size = image.size();
    let at = (texels.at(unit.x, unit.y) * size.as_vec2()).floor();
    let at = at.clamp(Vec2::ZERO, size.as_vec2() - 1.0).as_uvec2();
    let color = match image.texture_descriptor.size.depth_or_array_layers {
        1 => image.get_color_at(at.x, at.y),
        _ => image.get_color_at_3d(at.x, at.y, layer),
    };
    color.map_or(Vec4::ONE, |color| color.to_linear().to_vec4())
}
