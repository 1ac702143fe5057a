//! What of the surroundings a camera's grid shows, ready to be drawn.

use super::extract::ExtractedView;
use crate::pieces::{Map, Piece, Shape, Substance, Surroundings};
use bevy::asset::AssetId;
use bevy::image::Image;
use bevy::math::Vec2;
use bevy::platform::collections::HashMap;
use lamplight::{Lamp, lamp};
use std::ops::Range;

/// Pieces on the grid of a camera, in cells and y down, in the order in which they are drawn.
#[derive(Debug, Default)]
pub struct Draw {
    pub pieces: Vec<Piece>,
    pub substances: Vec<Substance>,
    pub batches: Vec<Batch>,
    /// Whether anything of it shows on the screen by itself.
    pub glows: bool,
    /// Lamps that are lit by rule.
    pub lamps: Vec<Lamp>,
    gains: Gains,
}

/// Pieces that are drawn at once.
#[derive(Debug)]
pub struct Batch {
    pub image: AssetId<Image>,
    pub pieces: Range<u32>,
    /// Whether it is seen on the screen.
    pub is_seen: bool,
}

impl Draw {
    /// Takes what a camera sees; lamps as discs, or by rule where its method does so. Spots are
    /// always lit by rule.
    pub fn take(&mut self, view: &ExtractedView, from: &Surroundings, by_rule: bool) {
        let Self { pieces, substances, batches, glows, lamps, gains } = self;
        pieces.clear();
        batches.clear();
        lamps.clear();
        substances.clone_from(&from.substances);
        *glows = false;
        let placement = &view.placement;
        let area = placement.area();
        for body in &from.bodies {
            if !body.layers.intersects(&view.layers) || !body.touches(area) {
                continue;
            }
            let own = from.pieces_of(body);
            let begin = pieces.len() as u32;
            let on_grid =
                |piece: &Piece| Piece { world: placement.on_grid(&piece.world), ..*piece };
            pieces.extend(own.iter().map(on_grid));
            *glows |= body.is_seen && from.substances[own[0].substance as usize].glows();
            let end = pieces.len() as u32;
            match batches.last_mut() {
                Some(last) if (last.image, last.is_seen) == (body.image, body.is_seen) => {
                    last.pieces.end = end;
                }
                _ => batches.push(Batch {
                    image: body.image,
                    pieces: begin..end,
                    is_seen: body.is_seen,
                }),
            }
        }
        let begin = pieces.len() as u32;
        let corner = placement.corner();
        for (lamp, layers) in &from.lamps {
            let as_rule = by_rule || lamp.cone.is_some();
            let on_grid = match as_rule {
                true => lamp.on_grid(corner, placement.cell),
                false => lamp.disc(corner, placement.cell),
            };
            if !layers.intersects(&view.layers) || on_grid.check(&"lamp").is_err() {
                continue;
            }
            if as_rule {
                lamps.push(on_grid);
                continue;
            }
            let middle = Vec2::from(on_grid.position);
            let [width, height] = placement.placed.size.map(|v| v as f32);
            let past = (middle - middle.clamp(Vec2::ZERO, Vec2::new(width, height))).abs();
            if past.max_element() > on_grid.size {
                continue;
            }
            let gain = gains.of(on_grid.position, on_grid.size);
            substances.push(Substance::lamp(on_grid.color.map(|c| c * gain)));
            let size = Vec2::splat(2.0 * on_grid.size);
            let world = Map {
                x_axis: [size.x, 0.0],
                y_axis: [0.0, size.y],
                origin: (middle - 0.5 * size).to_array(),
            };
            let substance = substances.len() as u32 - 1;
            pieces.push(Piece { substance, ..Piece::shape(world, Shape::Lamp) });
            *glows = true;
        }
        let end = pieces.len() as u32;
        if end > begin {
            batches.push(Batch { image: AssetId::default(), pieces: begin..end, is_seen: true });
        }
    }
}

/// How much brighter lamps are drawn to make up for the grid ([`lamp::gain`]), remembered by where
/// in a cell they lie: casting its rays for a thousand lamps a frame would take longer than lighting
/// them.
#[derive(Debug, Default)]
struct Gains(HashMap<(u8, u8, u32), f32>);

impl Gains {
    /// Places in a cell, along each axis, that are told apart.
    const PLACES: f32 = 32.0;
    /// More are forgotten: lamps whose size changes from frame to frame.
    const MOST: usize = 1 << 16;

    fn of(&mut self, position: [f32; 2], radius: f32) -> f32 {
        let place = position.map(|v| (v.rem_euclid(1.0) * Self::PLACES) as u8);
        if self.0.len() > Self::MOST {
            self.0.clear();
        }
        let gain = || {
            let center = place.map(|v| (f64::from(v) + 0.5) / f64::from(Self::PLACES));
            lamp::gain(center, radius.into())
        };
        *self.0.entry((place[0], place[1], radius.to_bits())).or_insert_with(gain)
    }
}
