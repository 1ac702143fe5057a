//! The one kind of thing that matter is drawn from.

use bevy::math::{Affine2, Affine3A, Rect, Vec2, Vec4};
use bytemuck::{Pod, Zeroable};

/// What of its unit square a piece covers; the numbers of shaders/pieces.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Shape {
    /// All of it.
    Square = 0,
    /// The circle inside it.
    Circle = 1,
    /// A capsule that stands upright in it; its end circles have a radius of [`Piece::param`] halves
    /// of the height.
    Capsule = 2,
    /// The half below the diagonal from (1, 0) to (0, 1).
    Triangle = 3,
    /// A lamp's disc, by the share of each cell that it covers.
    Lamp = 4,
}

/// Where a piece of a picture counts; as [`Piece::param`] of squares and triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cutoff {
    /// By its alpha.
    Blend,
    /// All of it, whatever its alpha.
    Opaque,
    /// Where alpha is at least so much.
    Mask(f32),
}

impl Cutoff {
    fn param(self) -> f32 {
        match self {
            Self::Blend => 0.0,
            Self::Opaque => -1.0,
            Self::Mask(alpha) => alpha.max(f32::MIN_POSITIVE),
        }
    }
}

/// Where a unit square comes to lie: `origin + x · x_axis + y · y_axis`, x and y from 0 to 1.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Map {
    pub x_axis: [f32; 2],
    pub y_axis: [f32; 2],
    pub origin: [f32; 2],
}

impl Map {
    /// A box of an entity's own units, in the world.
    pub fn of_box(min: Vec2, size: Vec2, world: &Affine3A) -> Self {
        let along = |v: Vec2| world.transform_vector3(v.extend(0.0)).truncate().to_array();
        Self {
            x_axis: along(Vec2::new(size.x, 0.0)),
            y_axis: along(Vec2::new(0.0, size.y)),
            origin: world.transform_point3(min.extend(0.0)).truncate().to_array(),
        }
    }

    /// A triangle's corners: those of (0, 0), (1, 0) and (0, 1).
    pub fn of_triangle([a, b, c]: [Vec2; 3]) -> Self {
        Self { x_axis: (b - a).to_array(), y_axis: (c - a).to_array(), origin: a.to_array() }
    }

    /// Texels of a picture's rectangle, upright, as shares of the picture.
    pub fn of_texels(texels: Rect, picture: Vec2) -> Self {
        let (min, size) = (texels.min / picture, texels.size() / picture);
        Self { x_axis: [size.x, 0.0], y_axis: [0.0, -size.y], origin: [min.x, min.y + size.y] }
    }

    /// All of a picture, upright.
    pub fn whole() -> Self {
        Self::of_texels(Rect::new(0.0, 0.0, 1.0, 1.0), Vec2::ONE)
    }

    /// The same, mirrored along x or y.
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

    /// The same, of the part of the unit square that begins at `min`.
    pub fn cut(mut self, min: Vec2, size: Vec2) -> Self {
        for c in 0..2 {
            self.origin[c] += min.x * self.x_axis[c] + min.y * self.y_axis[c];
            self.x_axis[c] *= size.x;
            self.y_axis[c] *= size.y;
        }
        self
    }

    /// Where a point of the unit square lies.
    pub fn at(&self, x: f32, y: f32) -> Vec2 {
        Vec2::from(self.origin) + x * Vec2::from(self.x_axis) + y * Vec2::from(self.y_axis)
    }

    /// Where the corners of the unit square lie.
    pub fn corners(&self) -> [Vec2; 4] {
        [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| self.at(x, y))
    }

    /// The box round it.
    pub fn bounds(&self) -> Rect {
        self.corners().into_iter().fold(Rect::EMPTY, |all, corner| all.union_point(corner))
    }

    /// The way back, where there is one.
    pub fn inverse(&self) -> Option<Affine2> {
        let affine = Affine2::from_cols(self.x_axis.into(), self.y_axis.into(), self.origin.into());
        (affine.matrix2.determinant().abs() > f32::MIN_POSITIVE).then(|| affine.inverse())
    }
}

/// A flat piece of matter: part of a picture, or a shape. `Piece` of shaders/pieces.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Piece {
    /// In the world.
    pub world: Map,
    /// On the picture, 0 to 1, y down.
    pub texels: Map,
    /// Multiplies the picture, linear.
    pub color: [f32; 4],
    /// Number of its [`super::Substance`].
    pub substance: u32,
    /// A [`Shape`].
    pub shape: u32,
    /// Layer of the picture.
    pub layer: u32,
    /// What the shape or the [`Cutoff`] needs besides.
    pub param: f32,
}

impl Piece {
    /// Part of a picture.
    pub fn picture(world: Map, texels: Map, color: [f32; 4], cutoff: Cutoff) -> Self {
        let shape = Shape::Square as u32;
        Self { world, texels, color, substance: 0, shape, layer: 0, param: cutoff.param() }
    }

    /// A shape without a picture.
    pub fn shape(world: Map, shape: Shape) -> Self {
        let piece = Self::picture(world, Map::whole(), Vec4::ONE.to_array(), Cutoff::Blend);
        Self { shape: shape as u32, ..piece }
    }

    /// Whether it is anywhere.
    pub fn is_finite(&self) -> bool {
        let Self { world, texels, color, .. } = self;
        world.corners().iter().all(|corner| corner.is_finite())
            && bytemuck::cast_slice::<Map, f32>(&[*world, *texels]).iter().all(|v| v.is_finite())
            && color.iter().all(|v| v.is_finite())
    }
}
