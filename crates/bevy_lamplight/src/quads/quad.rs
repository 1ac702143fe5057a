//! The primitive that matter is drawn from.

use super::material::QuadMaterial;
use bevy::math::{Affine2, Affine3A, Rect, Vec2, Vec4};
use bytemuck::{Pod, Zeroable};

/// The part of the unit square that a quad covers. The numbers are those of shaders/quads.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum QuadShape {
    /// All of it.
    Square = 0,
    /// The inscribed circle.
    Circle = 1,
    /// An upright capsule. The radius of its caps is [`Quad::param`] times half of its height.
    Capsule = 2,
    /// The half below the diagonal from (1, 0) to (0, 1).
    Triangle = 3,
    /// The disc of a lamp, weighted by the fraction of each cell that it covers.
    Lamp = 4,
}

/// The bit of [`Quad::shape`] by which a square, circle or capsule covers cells by the fraction of their area, if its
/// material lets light through: that of fog and glass then changes evenly as they move.
const BY_AREA: u32 = 8;

/// Conversion of an image's alpha to coverage; the [`Quad::param`] of squares and triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaCutoff {
    /// Alpha is coverage.
    Blend,
    /// Everything is covered.
    Opaque,
    /// Everything of at least this alpha is covered.
    Mask(f32),
}

impl AlphaCutoff {
    fn param(self) -> f32 {
        match self {
            Self::Blend => 0.0,
            Self::Opaque => -1.0,
            Self::Mask(alpha) => alpha.max(f32::MIN_POSITIVE),
        }
    }
}

/// An affine map of the unit square: `origin + x · x_axis + y · y_axis`, x and y from 0 to 1.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct QuadMap {
    pub x_axis: [f32; 2],
    pub y_axis: [f32; 2],
    pub origin: [f32; 2],
}

impl QuadMap {
    /// Onto a box in an entity's own units, in the world.
    pub fn of_box(min: Vec2, size: Vec2, world: &Affine3A) -> Self {
        let along = |v: Vec2| world.transform_vector3(v.extend(0.0)).truncate().to_array();
        Self {
            x_axis: along(Vec2::new(size.x, 0.0)),
            y_axis: along(Vec2::new(0.0, size.y)),
            origin: world.transform_point3(min.extend(0.0)).truncate().to_array(),
        }
    }

    /// Takes (0, 0), (1, 0) and (0, 1) to the corners of a triangle.
    pub fn of_triangle([a, b, c]: [Vec2; 3]) -> Self {
        Self { x_axis: (b - a).to_array(), y_axis: (c - a).to_array(), origin: a.to_array() }
    }

    /// Onto a rectangle of an image, upright, in fractions of the image.
    pub fn of_texels(texels: Rect, image: Vec2) -> Self {
        let (min, size) = (texels.min / image, texels.size() / image);
        Self { x_axis: [size.x, 0.0], y_axis: [0.0, -size.y], origin: [min.x, min.y + size.y] }
    }

    /// Onto all of an image, upright.
    pub fn whole() -> Self {
        Self::of_texels(Rect::new(0.0, 0.0, 1.0, 1.0), Vec2::ONE)
    }

    /// Mirrors the unit square along x or y first.
    pub fn mirrored(mut self, [x, y]: [bool; 2]) -> Self {
        let axes = [&mut self.x_axis, &mut self.y_axis];
        for (axis, mirror) in axes.into_iter().zip([x, y]) {
            if mirror {
                (0..2).for_each(|c| self.origin[c] += axis[c]);
                *axis = axis.map(|v| -v);
            }
        }
        self
    }

    /// The image of a point of the unit square.
    pub fn at(&self, x: f32, y: f32) -> Vec2 {
        Vec2::from(self.origin) + x * Vec2::from(self.x_axis) + y * Vec2::from(self.y_axis)
    }

    /// The images of the corners of the unit square.
    pub fn corners(&self) -> [Vec2; 4] {
        [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| self.at(x, y))
    }

    /// The bounding box of the image of the unit square.
    pub fn bounds(&self) -> Rect {
        self.corners().into_iter().fold(Rect::EMPTY, |all, corner| all.union_point(corner))
    }

    /// The inverse map, if there is one.
    pub fn inverse(&self) -> Option<Affine2> {
        let affine = Affine2::from_cols(self.x_axis.into(), self.y_axis.into(), self.origin.into());
        (affine.matrix2.determinant().abs() > f32::MIN_POSITIVE).then(|| affine.inverse())
    }
}

/// A flat piece of matter: part of an image, or a shape. On the GPU an instance of shaders/quads.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Quad {
    /// Its place in the world.
    pub world: QuadMap,
    /// Its part of the image, 0 to 1, y down.
    pub texels: QuadMap,
    /// Linear colour that multiplies the image.
    pub color: [f32; 4],
    /// Index of its [`super::QuadMaterial`].
    pub material: u32,
    /// A [`QuadShape`], and bits.
    pub shape: u32,
    /// Layer of the image.
    pub layer: u32,
    /// Parameter of the shape, or of the [`AlphaCutoff`].
    pub param: f32,
}

impl Quad {
    /// Part of an image.
    pub fn image(world: QuadMap, texels: QuadMap, color: [f32; 4], cutoff: AlphaCutoff) -> Self {
        let shape = QuadShape::Square as u32;
        Self { world, texels, color, material: 0, shape, layer: 0, param: cutoff.param() }
    }

    /// A shape without an image.
    pub fn shape(world: QuadMap, shape: QuadShape) -> Self {
        let white = Vec4::ONE.to_array();
        let quad = Self::image(world, QuadMap::whole(), white, AlphaCutoff::Blend);
        Self { shape: shape as u32, ..quad }
    }

    /// Covers cells by area if its material lets light through. Only for what lies side by side with no other quad: a
    /// cell on the common edge of two would be covered by less than both together.
    #[must_use]
    pub fn by_area(self) -> Self {
        Self { shape: self.shape | BY_AREA, ..self }
    }

    /// Returns whether cells are covered by area.
    pub fn is_by_area(&self, material: &QuadMaterial) -> bool {
        self.shape & BY_AREA != 0 && material.opacity < 1.0
    }

    /// Returns whether its shape is this one.
    pub fn is(&self, shape: QuadShape) -> bool {
        self.shape & !BY_AREA == shape as u32
    }

    /// Returns whether all of its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let Self { world, texels, color, .. } = self;
        world.corners().iter().all(|corner| corner.is_finite())
            && bytemuck::cast_slice::<QuadMap, f32>(&[*world, *texels])
                .iter()
                .all(|v| v.is_finite())
            && color.iter().all(|v| v.is_finite())
    }
}
