//! Matter around a grid, on coarse cells.

use super::{Piece, for_each_cell, groups_on, image_of};
use crate::placement::Placement;
use crate::quads::{ExtractedScene, Quad, QuadGroup, QuadMap, SceneAssets, is_within, overlaps};
use bevy::asset::AssetId;
use bevy::camera::visibility::RenderLayers;
use bevy::image::Image;
use bevy::math::{Rect, Vec2};
use bevy::platform::hash::FixedHasher;
use lamplight::{Cells, Matter};
use std::hash::{BuildHasher, Hash, Hasher};

/// Draws matter on coarse cells, but for what lies within an area. Solid matter that is thinner than a cell is drawn as
/// wide as one, so that it stays shut, and emits less. Its albedo is left out.
pub fn rasterize_around(
    scene: &ExtractedScene,
    grid: &Placement,
    area: Rect,
    layers: &RenderLayers,
    assets: &SceneAssets,
    to: &mut Cells,
) {
    to.clear();
    let cells = [to.width(), to.height()];
    for (group, quad) in quads_around(scene, grid, area, layers) {
        let Some(image) = image_of(group, assets) else { continue };
        let material = &scene.materials[quad.material as usize];
        let (opacity, tint) = material.over(grid.cell);
        let glows = material.glows();
        let (map, gain) = match grid.on_grid(&quad.world) {
            map if opacity == 1.0 => at_least_a_cell(map),
            map => (map, 1.0),
        };
        let piece = Piece { quad, image, by_area: quad.is_by_area(material), is_colored: glows };
        for_each_cell(&piece, &map, cells, |x, y, color| {
            let rgb = color.truncate().to_array();
            let emission =
                std::array::from_fn(|c| gain * material.emission[c] * rgb[c].clamp(0.0, f32::MAX));
            let matter = Matter { emission, opacity, tint, ..Matter::EMPTY };
            let i = (y * to.width() + x) as usize;
            to.set(x, y, matter.over(to.matter(i), color.w.min(1.0)));
        });
    }
}

/// Returns a number that differs if what [`rasterize_around`] draws does, but for the texels of images.
pub fn digest_around(
    scene: &ExtractedScene,
    grid: &Placement,
    area: Rect,
    layers: &RenderLayers,
) -> u64 {
    let mut digest = FixedHasher.build_hasher();
    for (group, quad) in quads_around(scene, grid, area, layers) {
        group.image.hash(&mut digest);
        // Indices of materials depend on entities that are not drawn.
        digest.write(bytemuck::bytes_of(&Quad { material: 0, ..*quad }));
        digest.write(bytemuck::bytes_of(&scene.materials[quad.material as usize]));
    }
    digest.finish()
}

/// Returns a number that differs if the matter of a scene does, but for the texels of images.
pub fn digest_of(scene: &ExtractedScene) -> u64 {
    let mut digest = FixedHasher.build_hasher();
    for group in &scene.groups {
        group.image.hash(&mut digest);
        digest.write(bytemuck::cast_slice(scene.quads_of(group)));
    }
    digest.write(bytemuck::cast_slice(&scene.materials));
    digest.finish()
}

/// Returns the images that [`rasterize_around`] reads.
pub fn images_around<'a>(
    scene: &'a ExtractedScene,
    grid: &Placement,
    area: Rect,
    layers: &'a RenderLayers,
) -> impl Iterator<Item = AssetId<Image>> {
    quads_around(scene, grid, area, layers).map(|(group, _)| group.image)
}

/// The quads that may lie on a grid, and not all within an area, from the bottom to the top.
fn quads_around<'a>(
    scene: &'a ExtractedScene,
    grid: &Placement,
    area: Rect,
    layers: &'a RenderLayers,
) -> impl Iterator<Item = (&'a QuadGroup, &'a Quad)> {
    // Matter may be drawn as wide as a cell.
    let all = grid.area().inflate(grid.cell);
    let on_grid = groups_on(scene, all, layers);
    let quads =
        on_grid.flat_map(move |group| scene.quads_of(group).iter().map(move |quad| (group, quad)));
    quads.filter(move |(_, quad)| {
        let bounds = quad.world.bounds();
        overlaps(bounds, all) && !is_within(bounds, area)
    })
}

/// Stretches a map whose image is narrower than a cell. Returns the factor by which it then emits less, so that its light is
/// the same: the mean width of a convex shape is its circumference / π (Cauchy 1832).
fn at_least_a_cell(map: QuadMap) -> (QuadMap, f32) {
    let middle = map.at(0.5, 0.5);
    let axes = [Vec2::from(map.x_axis), Vec2::from(map.y_axis)];
    let wide = axes.map(|axis| axis / axis.length().clamp(1e-6, 1.0));
    let circumference = |axes: [Vec2; 2]| axes[0].length() + axes[1].length();
    let gain = (circumference(axes) / circumference(wide).max(1e-6)).min(1.0);
    let origin = middle - 0.5 * (wide[0] + wide[1]);
    let [x_axis, y_axis] = wide.map(|axis| axis.to_array());
    (QuadMap { x_axis, y_axis, origin: origin.to_array() }, gain)
}
