//! What is around a camera: every picture and shape of matter as small, flat pieces, and lamps.
//!
//! Sprites, glyphs, slices, tiles, triangles of meshes and occluders all become [`Piece`]s, of which
//! the render world draws matter ([`crate::render`]) and the CPU answers questions
//! ([`crate::query`]): both see the same.

mod gather;
mod meshes;
mod occluders;
mod piece;
mod sprites;
mod substance;
mod texts;
mod tiles;

pub use gather::{Gather, Pictures, VisibilityPropagates};
pub use piece::{Cutoff, Map, Piece, Shape};
pub use substance::Substance;

use crate::components::WorldLamp;
use bevy::asset::AssetId;
use bevy::camera::visibility::RenderLayers;
use bevy::image::Image;
use bevy::math::{Rect, Vec2};
use std::ops::Range;

/// All that takes part in light, in world units.
#[derive(Debug, Default)]
pub struct Surroundings {
    /// Pieces, body after body.
    pub pieces: Vec<Piece>,
    /// What they are made of.
    pub substances: Vec<Substance>,
    /// In the order in which they cover one another: later ones lie on top.
    pub bodies: Vec<Body>,
    /// Lamps that are on.
    pub lamps: Vec<(WorldLamp, RenderLayers)>,
}

/// Pieces that show one picture, of one entity.
#[derive(Debug)]
pub struct Body {
    /// Where they lie among [`Surroundings::pieces`].
    pub pieces: Range<u32>,
    /// The picture.
    pub image: AssetId<Image>,
    /// Who sees it.
    pub layers: RenderLayers,
    /// Whether it is seen on the screen; occluders are not.
    pub is_seen: bool,
    z: f32,
    bounds: Rect,
}

impl Body {
    /// Whether any of it may lie in a part of the world.
    pub fn touches(&self, area: Rect) -> bool {
        let (own, other) = (self.bounds, area);
        own.min.cmple(other.max).all() && other.min.cmple(own.max).all()
    }
}

/// How a body is drawn.
pub struct Kind {
    pub image: AssetId<Image>,
    pub layers: RenderLayers,
    pub is_seen: bool,
    pub z: f32,
}

impl Surroundings {
    /// Forgets all, and keeps the room.
    pub fn clear(&mut self) {
        self.pieces.clear();
        self.substances.clear();
        self.bodies.clear();
        self.lamps.clear();
    }

    /// The pieces of a body.
    pub fn pieces_of(&self, body: &Body) -> &[Piece] {
        &self.pieces[body.pieces.start as usize..body.pieces.end as usize]
    }

    /// Notes what a body is made of, and gives its number.
    fn add_substance(&mut self, substance: Substance) -> u32 {
        self.substances.push(substance);
        self.substances.len() as u32 - 1
    }

    /// Makes a body of the pieces added since there were `from`; drops them where they lie in none of
    /// the areas, or nowhere.
    fn close(&mut self, from: usize, kind: Kind, areas: &[Rect]) {
        let Kind { image, layers, is_seen, z } = kind;
        let pieces = &self.pieces[from..];
        let corners = pieces.iter().flat_map(|piece| piece.world.corners());
        let bounds = corners.fold(Rect::EMPTY, |all, corner| all.union_point(corner));
        let body = Body {
            pieces: from as u32..self.pieces.len() as u32,
            image,
            layers,
            is_seen,
            z,
            bounds,
        };
        let is_somewhere = pieces.iter().all(Piece::is_finite) && !z.is_nan();
        if !is_somewhere || pieces.is_empty() || !areas.iter().any(|&area| body.touches(area)) {
            self.pieces.truncate(from);
            return;
        }
        self.bodies.push(body);
    }

    /// What bodies and the ranges of lamps cover; none where there is nothing.
    pub fn bounds(&self) -> Option<Rect> {
        let bodies = self.bodies.iter().map(|body| body.bounds);
        let lamps = self
            .lamps
            .iter()
            .map(|(lamp, _)| Rect::from_center_half_size(lamp.position, Vec2::splat(lamp.range)));
        bodies.chain(lamps).reduce(|all, own| all.union(own))
    }

    /// Puts bodies in the order in which they cover one another.
    fn sort(&mut self) {
        self.bodies.sort_by(|a, b| a.z.total_cmp(&b.z));
    }
}
