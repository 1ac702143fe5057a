//! Meshes, triangle by triangle, with the colour and picture of a `ColorMaterial`; any other material
//! counts as white.

use super::gather::{Pictures, PlaceItem};
use super::{Cutoff, Kind, Map, Piece, Shape, Surroundings};
use bevy::asset::AssetId;
use bevy::color::ColorToComponents;
use bevy::ecs::query::QueryData;
use bevy::math::{Affine2, Rect, Vec2, Vec3, Vec4};
use bevy::mesh::{Mesh, Mesh2d, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::{Has, LinearRgba};
use bevy::sprite_render::{AlphaMode2d, ColorMaterial, MeshMaterial2d, TilemapChunk};

#[derive(QueryData)]
pub struct MeshMatter {
    mesh: &'static Mesh2d,
    material: Option<&'static MeshMaterial2d<ColorMaterial>>,
    is_tiles: Has<TilemapChunk>,
}

impl MeshMatterItem<'_, '_> {
    /// Adds its pieces; none before its mesh is loaded, or where that is kept on the GPU alone.
    pub fn cut_up(
        &self,
        place: &PlaceItem,
        substance: u32,
        pictures: &Pictures,
        areas: &[Rect],
        to: &mut Surroundings,
    ) {
        let mesh = pictures.meshes.as_ref().and_then(|meshes| meshes.get(self.mesh.id()));
        let Some(mesh) = mesh.filter(|_| !self.is_tiles) else { return };
        let materials = pictures.materials.as_ref();
        let material = self.material.and_then(|handle| materials?.get(handle.id()));
        let (color, cutoff, image, uv) = match material {
            None => (LinearRgba::WHITE, Cutoff::Opaque, AssetId::default(), Affine2::IDENTITY),
            Some(material) => {
                let cutoff = match material.alpha_mode {
                    AlphaMode2d::Opaque => Cutoff::Opaque,
                    AlphaMode2d::Mask(alpha) => Cutoff::Mask(alpha),
                    AlphaMode2d::Blend => Cutoff::Blend,
                };
                let image =
                    material.texture.as_ref().map_or(AssetId::default(), |image| image.id());
                (material.color.to_linear(), cutoff, image, material.uv_transform)
            }
        };
        let Some(vertices) = Vertices::of(mesh) else { return };
        let world = place.transform.affine();
        let from = to.pieces.len();
        vertices.triangles(|triangle| {
            let at = |i: usize| world.transform_point3(vertices.position(i)).truncate();
            let uv = |i: usize| uv.transform_point2(vertices.uv(i));
            let own = triangle.map(|i| vertices.color(i)).into_iter().sum::<Vec4>() / 3.0;
            let color = (own * Vec4::from(color.to_f32_array())).to_array();
            let (world, texels) = (triangle.map(at), triangle.map(uv));
            let (world, texels) = (Map::of_triangle(world), Map::of_triangle(texels));
            let shape = Shape::Triangle as u32;
            let piece = Piece::picture(world, texels, color, cutoff);
            to.pieces.push(Piece { substance, shape, ..piece });
        });
        let z = place.transform.translation().z;
        to.close(from, Kind { image, layers: place.layers(), is_seen: true, z }, areas);
    }
}

/// What of a mesh is looked at.
struct Vertices<'a> {
    mesh: &'a Mesh,
    positions: &'a VertexAttributeValues,
    uvs: Option<&'a VertexAttributeValues>,
    colors: Option<&'a VertexAttributeValues>,
}

impl<'a> Vertices<'a> {
    fn of(mesh: &'a Mesh) -> Option<Self> {
        let attribute = |attribute| mesh.try_attribute_option(attribute).ok().flatten();
        Some(Self {
            mesh,
            positions: attribute(Mesh::ATTRIBUTE_POSITION)?,
            uvs: attribute(Mesh::ATTRIBUTE_UV_0),
            colors: attribute(Mesh::ATTRIBUTE_COLOR),
        })
    }

    /// Visits corners of triangles whose vertices there are.
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

    fn position(&self, i: usize) -> Vec3 {
        match self.positions {
            VertexAttributeValues::Float32x3(list) => list[i].into(),
            VertexAttributeValues::Float32x2(list) => Vec2::from(list[i]).extend(0.0),
            _ => Vec3::NAN,
        }
    }

    fn uv(&self, i: usize) -> Vec2 {
        match self.uvs {
            Some(VertexAttributeValues::Float32x2(list)) if i < list.len() => list[i].into(),
            _ => Vec2::ZERO,
        }
    }

    fn color(&self, i: usize) -> Vec4 {
        match self.colors {
            Some(VertexAttributeValues::Float32x4(list)) if i < list.len() => list[i].into(),
            _ => Vec4::ONE,
        }
    }
}
