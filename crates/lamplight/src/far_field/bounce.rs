//! The light that blocks reflect and scatter.

use super::block::{Bearing, LEAST_SURFACE, PackedRgb, Sent};
use super::levels::BlockLevel;
use super::march::{BlockRay, Rings, march};
use super::read::{LOOKS, NEAR, Reflection, SIDE, face, look_angle};
use crate::stages::faces::Faces;
use crate::{Rgb, Sky};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Blocks that they cross before those become twice as large.
const RING: i32 = 5;

/// A smallest block that reflects or scatters.
#[derive(Debug)]
pub struct Reflector {
    /// Its place among all blocks, and among those with a record.
    pub place: u32,
    pub record: u32,
    pub reflection: Box<Reflection>,
}

/// The light around a block: irradiance of faces by normal as E/2, and mean radiance.
struct Around {
    faces: Faces,
    mean: Rgb,
}

/// Returns what the smallest blocks that reflect or scatter send of what all blocks have sent before.
pub fn reflected(levels: &[BlockLevel], sky: &Sky, reflectors: &[Reflector]) -> Vec<Sent> {
    let reflectors = reflectors.par_iter();
    let sent = |reflector: &Reflector| {
        let around = light_around(levels, sky, reflector);
        let block = &levels[0].blocks[reflector.record as usize];
        std::array::from_fn(|slot| match block.in_slot(slot) {
            None => PackedRgb::HIDDEN,
            Some([_, stopped]) => PackedRgb::new(sent(reflector, &around, slot, stopped)),
        })
    };
    reflectors.map(sent).collect()
}

/// Returns what a block that stops this sends of the light around it.
fn sent(reflector: &Reflector, around: &Around, slot: usize, stopped: Rgb) -> Rgb {
    let mut sum = [0.0; 3];
    for axis in 0..2 {
        let share = reflector.reflection.walls[slot][axis].unpack();
        let light = around.faces[face(slot, axis)];
        (0..3).for_each(|c| sum[c] += share[c] * light[c]);
    }
    if let Some(media) = &reflector.reflection.media {
        let share = media[slot].unpack();
        (0..3).for_each(|c| sum[c] += share[c] * around.mean[c]);
    }
    [0, 1, 2].map(|c| sum[c] * stopped[c])
}

/// Finds the light around a block by rays in all directions.
fn light_around(levels: &[BlockLevel], sky: &Sky, reflector: &Reflector) -> Around {
    let Reflection { media, open, sees, .. } = &*reflector.reflection;
    let columns = levels[0].size[0];
    let at = [reflector.place as i32 % columns, reflector.place as i32 / columns];
    let first = at.map(|v| v * SIDE as i32);
    let rings = Rings::new(levels.len(), first, first.map(|v| v + SIDE as i32), RING);
    // Neighbours look in directions between.
    let mut random = reflector.place.wrapping_mul(0x9e37_79b9);
    let mut next = || {
        random = (random ^ random >> 15).wrapping_mul(0x2c1b_3c6d);
        f64::from(random >> 8) / f64::from(1 << 24)
    };
    let turn = next();
    let mut around = Around { faces: Faces::default(), mean: [0.0; 3] };
    for (look, sees) in sees.iter().enumerate() {
        let angle = look_angle(look as f64 + turn);
        let [from, to] = [turn - 0.5, turn + 0.5].map(|v| look_angle(look as f64 + v));
        let sky = sky.mean(from, to);
        let with_sky = |[light, through]: [Rgb; 2]| -> Rgb {
            std::array::from_fn(|c| light[c] + through[c] * sky[c])
        };
        let Some(ray) = leaving(first, at, angle, next(), *open) else { continue };
        let way = [angle.cos(), angle.sin()];
        // What hides the rest is in the block itself, or behind it.
        let own = &levels[0].blocks[reflector.record as usize];
        let [sent, stopped] = own.crossed(&Bearing::new(angle), ray.axis).unwrap_or([[0.0; 3]; 2]);
        let near = march(levels, &rings, BlockRay { reach: NEAR, ..ray });
        let surface: Rgb = std::array::from_fn(|c| {
            let hidden = 1.0 - (1.0 - stopped[c]) * near[1][c];
            let light = sent[c] + (1.0 - stopped[c]) * near[0][c];
            if hidden > LEAST_SURFACE { light / hidden } else { 0.0 }
        });
        let from = [0, 1].map(|a| f64::from(first[a]) + 0.5 * SIDE as f64 + NEAR * way[a]);
        let block = from.map(|v| (v / SIDE as f64).floor() as i32);
        let axis = usize::from(way[1].abs() > way[0].abs());
        let far = with_sky(march(levels, &rings, BlockRay { from, block, axis, ..ray }));
        for axis in 0..2 {
            let face = 2 * axis + usize::from(way[axis] > 0.0);
            let weight = (PI / LOOKS as f64 * way[axis].abs()) as f32;
            let sees = f32::from(sees[axis]) / 255.0;
            for c in 0..3 {
                around.faces[face][c] += weight * (sees * far[c] + (1.0 - sees) * surface[c]);
            }
        }
        if media.is_some() {
            let seen = with_sky(march(levels, &rings, ray));
            (0..3).for_each(|c| around.mean[c] += seen[c] / LOOKS as f32);
        }
    }
    around
}

/// Returns a ray that leaves a block in a direction into an open cell: the one at a fraction of all of these.
fn leaving(
    first: [i32; 2],
    block: [i32; 2],
    angle: f64,
    place: f64,
    open: u16,
) -> Option<BlockRay> {
    let way = [angle.cos(), angle.sin()];
    let side = |axis: usize| 2 * axis + usize::from(way[axis] > 0.0);
    let is_open = |axis: usize, along: usize| open >> (side(axis) * SIDE + along) & 1 == 1;
    let widths = [0, 1].map(|axis| {
        let count = (0..SIDE).filter(|&along| is_open(axis, along)).count();
        count as f64 * way[axis].abs()
    });
    let at = place * (widths[0] + widths[1]);
    let axis = usize::from(at >= widths[0]);
    if widths[axis] == 0.0 {
        return None;
    }
    // In open cells of the side.
    let past = if axis == 0 { at } else { at - widths[0] } / way[axis].abs();
    let along = (0..SIDE).filter(|&along| is_open(axis, along)).nth(past as usize)?;
    let mut from = first.map(f64::from);
    from[axis] += if way[axis] > 0.0 { SIDE as f64 } else { 0.0 };
    from[1 - axis] += along as f64 + past.fract();
    let mut next = block;
    next[axis] += if way[axis] > 0.0 { 1 } else { -1 };
    Some(BlockRay { from, angle, block: next, axis, reach: f64::INFINITY })
}
