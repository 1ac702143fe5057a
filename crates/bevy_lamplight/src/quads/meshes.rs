//! Quads of meshes: one per triangle, with the colour and image of a `ColorMaterial`. Any other
//! material counts as white.

use super::place::{EntityPlaceItem, SceneAssets};
use super::quad::{AlphaCutoff, Quad, QuadMap, QuadShape};
use super::source::{QuadSource, QuadWriter};
use bevy::asset::AssetId;
use bevy::color::ColorToComponents;
use bevy::ecs::query::QueryData;
use bevy::math::{Affine2, Vec2, Vec3, Vec3A, Vec4};
use bevy::mesh::{Mesh, Mesh2d, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::{Has, LinearRgba, Sprite};
use bevy::sprite_render::{AlphaMode2d, ColorMaterial, MeshMaterial2d, TilemapChunk};

/// A mesh and its material.
#[derive(QueryData)]
pub struct MeshMatter {
    mesh: &'static Mesh2d,
    material: Option<&'static MeshMaterial2d<ColorMaterial>>,
    is_tiles: Has<TilemapChunk>,
    is_sprite: Has<Sprite>,
}

impl QuadSource for MeshMatterItem<'_, '_> {
    fn push_quads(&self, place: &EntityPlaceItem, assets: &SceneAssets, to: &mut QuadWriter) {
        // Bevy draws tiles and sprites as meshes, too.
        if self.is_tiles || self.is_sprite {
            return;
        }
        let mesh = assets.meshes.as_ref().and_then(|meshes| meshes.get(self.mesh.id()));
        let Some(vertices) = mesh.and_then(Vertices::new) else { return };
        let world = place.transform.affine();
        let at = |i: usize| world.transform_point3(vertices.position(i)).truncate();
        if !to.shows((0..vertices.positions.len()).map(at)) {
            return;
        }
        let materials = assets.materials.as_ref();
        let material = self.material.and_then(|handle| materials?.get(handle.id()));
        let (color, cutoff, image, uv) = match material {
            None => (LinearRgba::WHITE, AlphaCutoff::Opaque, AssetId::default(), Affine2::IDENTITY),
            Some(material) => {
                let cutoff = match material.alpha_mode {
                    AlphaMode2d::Opaque => AlphaCutoff::Opaque,
                    AlphaMode2d::Mask(alpha) => AlphaCutoff::Mask(alpha),
                    AlphaMode2d::Blend => AlphaCutoff::Blend,
                };
                let image =
                    material.texture.as_ref().map_or(AssetId::default(), |image| image.id());
                (material.color.to_linear(), cutoff, image, material.uv_transform)
            }
        };
        vertices.triangles(|triangle| {
            let uv = |i: usize| uv.transform_point2(vertices.uv(i));
            let own = triangle.map(|i| vertices.color(i)).into_iter().sum::<Vec4>() / 3.0;
            let color = (own * Vec4::from(color.to_f32_array())).to_array();
            let map = QuadMap::of_triangle(triangle.map(at));
            let texels = QuadMap::of_triangle(triangle.map(uv));
            let quad = Quad::image(map, texels, color, cutoff);
            to.push(Quad { shape: QuadShape::Triangle as u32, ..quad });
        });
        to.finish_group(place, image, true);
    }
}

/// The attributes of a mesh that quads are made of.
struct Vertices<'a> {
    mesh: &'a Mesh,
    positions: &'a VertexAttributeValues,
    uvs: Option<&'a VertexAttributeValues>,
    colors: Option<&'a VertexAttributeValues>,
}

impl<'a> Vertices<'a> {
    /// `None` if the mesh has no positions, or is kept on the GPU only.
    fn new(mesh: &'a Mesh) -> Option<Self> {
        let attribute = |attribute| mesh.try_attribute_option(attribute).ok().flatten();
        Some(Self {
            mesh,
            positions: attribute(Mesh::ATTRIBUTE_POSITION)?,
            uvs: attribute(Mesh::ATTRIBUTE_UV_0),
            colors: attribute(Mesh::ATTRIBUTE_COLOR),
        })
    }

    /// Visits the vertices of each triangle, if all of them exist.
    fn triangles(&self, mut visit: impl FnMut([usize; 3])) {
        let indices = self.mesh.try_indices_option().ok().flatten();
        let count = indices.map_or(self.positions.len(), |indices| indices.len());
        let index = |i: usize| match indices {
            None => i,
            Some(bevy::mesh::Indices::U16(list)) => list[i].into(),
            Some(bevy::mesh::Indices::U32(list)) => list[i] as usize,
        };
        let mut visit = |corners: [usize; 3]| {
            let triangle = corners.map(index);
            if triangle.iter().all(|&i| i < self.positions.len()) {
                visit(triangle);
            }
        };
        match self.mesh.primitive_topology() {
            PrimitiveTopology::TriangleList => {
                (0..count / 3).for_each(|i| visit([3 * i, 3 * i + 1, 3 * i + 2]));
            }
            PrimitiveTopology::TriangleStrip => {
                (0..count.saturating_sub(2)).for_each(|i| visit([i, i + 1, i + 2]));
            }
            // Lines and points have no area.
            _ => {}
        }
    }

    /// The position of a vertex; NaN where its format has no meaning.
    fn position(&self, i: usize) -> Vec3 {
        match (self.positions, self.mesh.final_aabb) {
            (VertexAttributeValues::Float32x3(list), _) => list[i].into(),
            (VertexAttributeValues::Float32x2(list), _) => Vec2::from(list[i]).extend(0.0),
            (VertexAttributeValues::Snorm16x4(list), Some(bounds)) => {
                // From −1 to 1 across the bounds.
                let [x, y, z, _] = list[i].map(|v| (f32::from(v) / 32_767.0).max(-1.0));
                let part = 0.5 + 0.5 * Vec3A::new(x, y, z);
                (bounds.min + part * (bounds.max - bounds.min)).into()
            }
            _ => Vec3::NAN,
        }
    }

    /// The texture coordinates of a vertex.
    fn uv(&self, i: usize) -> Vec2 {
        match (self.uvs, self.mesh.final_uv_ranges[0]) {
            (Some(VertexAttributeValues::Float32x2(list)), _) if i < list.len() => list[i].into(),
            (Some(VertexAttributeValues::Unorm16x2(list)), Some(range)) if i < list.len() => {
                let part = Vec2::from(list[i].map(|v| f32::from(v) / 65_535.0));
                range.min + part * (range.max - range.min)
            }
            _ => Vec2::ZERO,
        }
    }

    /// The colour of a vertex.
    fn color(&self, i: usize) -> Vec4 {
        match self.colors {
            Some(VertexAttributeValues::Float32x4(list)) if i < list.len() => list[i].into(),
            Some(VertexAttributeValues::Float16x4(list)) if i < list.len() => {
                list[i].map(|v| v.to_f32()).into()
            }
            Some(VertexAttributeValues::Unorm8x4(list)) if i < list.len() => {
                list[i].map(|v| f32::from(v) / 255.0).into()
            }
            Some(VertexAttributeValues::Unorm16x4(list)) if i < list.len() => {
                list[i].map(|v| f32::from(v) / 65_535.0).into()
            }
            _ => Vec4::ONE,
        }
    }
}
