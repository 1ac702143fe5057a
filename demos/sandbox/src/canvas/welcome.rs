//! The initial picture of a canvas: a rose window above hills and a lake.

use super::{Canvas, Result};
use crate::look::Look;
use crate::paint::{Paint, hex, mix, scale};
use crate::texture::{cloud, hash, noise};
use lamplight::{Cells, Display, Gradient, Lamp, Rgb, Sky};
use std::f32::consts::TAU;

/// Columns and rows of the layout.
const LAYOUT: [f32; 2] = [320.0, 180.0];
/// The middle of the rose.
const ROSE: [f32; 2] = [160.0, 66.0];
/// Radii of the rose: its centre, and the inner and outer end of its petals.
const HEART: f32 = 5.0;
const PETALS: [f32; 2] = [13.0, 25.0];
/// Colours of the petals.
const HUES: [u32; 12] = [
    0xff5a5a, 0xff8a4a, 0xffc24a, 0xf4f06a, 0xa4f070, 0x5ae8a0, 0x5ae0e8, 0x5aa8ff, 0x7a7aff,
    0xb06aff, 0xf06af0, 0xff5aa4,
];
/// The row of the surface of the lake.
const LAKE: f32 = 146.0;
/// Paper lanterns in the air and on the lake: position, radius, colour.
const LANTERNS: [([f32; 2], f32, u32); 12] = [
    ([36.0, 62.0], 4.0, 0xffb060),
    ([64.0, 92.0], 3.0, 0xff8a6a),
    ([84.0, 40.0], 2.6, 0xffc878),
    ([238.0, 44.0], 2.6, 0xff9ab0),
    ([262.0, 88.0], 3.4, 0xffa858),
    ([288.0, 58.0], 4.2, 0xff7a8a),
    ([112.0, 112.0], 2.4, 0xffd080),
    ([66.0, 164.0], 2.2, 0xffb070),
    ([118.0, 155.0], 1.7, 0xff9a80),
    ([173.0, 168.0], 2.6, 0xffc070),
    ([208.0, 154.0], 1.6, 0xffa890),
    ([258.0, 166.0], 2.3, 0xffb884),
];

impl Canvas {
    /// The initial picture in any size of a canvas.
    pub fn welcome(size: [u32; 2]) -> Result<Self> {
        Self::check_size(size)?;
        let mut cells = Cells::new(size[0], size[1])?;
        let unit = (size[0] as f32 / LAYOUT[0]).min(size[1] as f32 / LAYOUT[1]);
        // The layout is centred and continues beyond its edges.
        let place = |[x, y]: [f32; 2]| {
            [(x - 160.0) * unit + 0.5 * size[0] as f32, (y - 90.0) * unit + 0.5 * size[1] as f32]
        };
        let corner = place([0.0, 0.0]);
        for cy in 0..size[1] {
            for cx in 0..size[0] {
                let x = (cx as f32 + 0.5 - corner[0]) / unit;
                let y = (cy as f32 + 0.5 - corner[1]) / unit;
                let index = cells.index(cx, cy);
                at(x, y).at_scale(unit).put(&mut cells, index);
            }
        }
        for ([x, y], radius, color) in LANTERNS {
            cells.lamps_mut().push(Lamp {
                position: place([x, y]),
                color: hex(color),
                intensity: 2.3,
                size: (radius * unit).max(0.05),
                range: (140.0 * unit).max(1.0),
                ..Lamp::default()
            });
        }
        cells.set_sky(Sky::Gradient(Gradient {
            zenith: [0.05, 0.07, 0.2],
            horizon: [0.16, 0.1, 0.26],
            ground: [0.02, 0.02, 0.05],
        }));
        let display = Display { exposure: 0.9, ..Display::default() };
        Self::of(cells, Look { wall_depth: 64.0, display, ..Look::default() }.at_scale(unit))
    }
}

fn at(x: f32, y: f32) -> Paint {
    let sky = sky(x, y);
    if let Some(paint) = rose(x, y, sky) {
        return paint;
    }
    let away = (x - 160.0).abs();
    if y > LAKE && away < 82.0 + 1.4 * (y - LAKE) + 6.0 * noise(y / 5.0, 4.0, 31) {
        return water(x, y);
    }
    if y > ridge(x) {
        // Hills fade from violet to the green of the banks.
        let near = ((y - 140.0) / 30.0).clamp(0.0, 1.0);
        let band = cloud(x / 18.0, y / 6.0, 40);
        let far = mix(hex(0x5a5080), hex(0x9a86b4), band);
        return Paint::wall(mix(far, mix(hex(0x3f6a64), hex(0x7ab08a), band), near));
    }
    Paint::open(sky)
}

/// The row of the ridge: high at the sides, low at the lake in the middle.
fn ridge(x: f32) -> f32 {
    let away = ((x - 160.0).abs() / 160.0).min(1.4);
    let hills = 74.0 * (away - 0.3).max(0.0) * (0.6 + 0.8 * noise(x / 40.0, 3.0, 6));
    LAKE + 3.0 - hills + 4.0 * (noise(x / 7.0, 1.0, 1) - 0.5) * away.min(0.5)
}

fn sky(x: f32, y: f32) -> Rgb {
    let height = (1.0 - y / 150.0).clamp(0.0, 1.0);
    let base = mix(hex(0xb8a0c8), hex(0x5f78b8), height);
    // Slanted brush strokes in a few tones.
    let tone = 0.62 + 0.5 * cloud(x / 60.0 + y / 90.0, y / 9.0, 17);
    scale(base, ((tone * 10.0).round() / 10.0).min(1.0))
}

fn water(x: f32, y: f32) -> Paint {
    let ripple = noise(x / 16.0, y * 1.3, 23);
    let color = mix(hex(0x3f6a9c), hex(0xa4cce4), ripple);
    let mut paint = Paint::fog(0.004, hex(0x8ab4cc));
    paint.matter.tint = [0.985, 0.992, 0.997];
    paint.colored(color)
}

/// The rose: a glowing centre, dark tracery, a ring of coloured glass, beads of stone.
fn rose(x: f32, y: f32, sky: Rgb) -> Option<Paint> {
    let (dx, dy) = (x - ROSE[0], y - ROSE[1]);
    let radius = dx.hypot(dy);
    let turn = (dy.atan2(dx) / TAU + 1.0).fract();
    if radius < HEART {
        let core = 1.0 - radius / HEART;
        return Some(Paint::glow(mix([7.6, 5.6, 3.0], [9.5, 7.6, 5.0], core)));
    }
    let petal = turn * HUES.len() as f32;
    let (which, across) = (petal as usize % HUES.len(), (petal.fract() - 0.5).abs());
    let lead = 0.5 - across < 0.75 / (radius * TAU / HUES.len() as f32);
    if radius < PETALS[0] {
        return Some(Paint::open(scale(sky, 0.35)));
    }
    if (PETALS[0]..PETALS[1]).contains(&radius) {
        let rim = PETALS[1] - radius < 1.0 || radius - PETALS[0] < 1.0;
        // The ends of petals are round.
        let round = radius > PETALS[1] - 12.0 * across * across;
        if lead || rim || round {
            return if round {
                None
            } else {
                Some(Paint::glass([0.9; 3]).colored(scale(sky, 0.4)))
            };
        }
        let tint = mix([1.0; 3], hex(HUES[which]), 0.28);
        return Some(Paint::glass(tint).colored(hex(HUES[which])));
    }
    // Beads catch the colours and cast shadows outwards.
    for (ring, beads, size) in [(40.0, 12.0, 1.7), (58.0, 24.0, 1.3), (78.0, 24.0, 1.6)] {
        let shift = if ring == 58.0 { 0.0 } else { 0.5 };
        let angle = ((turn * beads - shift).round() + shift) / beads * TAU;
        let (bx, by) = (ring * angle.cos(), ring * angle.sin());
        let grow = 1.0 + 0.3 * hash((angle * 100.0) as i32, ring as i32, 3);
        if (dx - bx).hypot(dy - by) < size * grow && y < 128.0 {
            return Some(Paint::wall(hex(0xe8e0e8)));
        }
    }
    None
}
