//! A cellar of bricks, with a normal map: every brick has edges that catch the light of the lamp beside it.

use super::canvas::{Art, Canvas, Color, Layer, Paint, hash, hex, ramp, rough};
use lamplight::normal_of_slope;

const W: i32 = 320;
const H: i32 = 180;
const FLOOR: i32 = 156;
/// Left edges of the pillars, and their width.
const PILLARS: [i32; 2] = [96, 236];
const PILLAR: i32 = 18;
/// Size of a brick, with its joint.
const BRICK: [i32; 2] = [20, 9];
/// Centres and radii of the barrels.
const BARRELS: [[f32; 3]; 3] = [[154.0, 142.5, 13.5], [183.0, 142.5, 13.5], [168.5, 119.0, 13.5]];

const CLAY: &[u32] = &[0x6e3a2c, 0x8f4d39, 0xa9614a, 0xbf785c];
const MORTAR: Color = hex(0x8b8379);
const STONE: &[u32] = &[0x6d6a68, 0x8a8683, 0xa7a29c];
const OAK: &[u32] = &[0x5b3b22, 0x7d5430, 0xa27440];

pub fn draw() -> Art {
    let mut canvas = Canvas::new(W, H, |x, y| {
        let paint = if y >= FLOOR {
            Paint::solid(stone(x, y, [40, 12])).albedo(hex(0xa7a29c))
        } else {
            Paint::open(brick(x, y))
        };
        tilted(paint, x, y, if y >= FLOOR { slabs } else { bricks })
    });
    for left in PILLARS {
        for y in 0..FLOOR {
            for x in left..left + PILLAR {
                let paint = Paint::solid(stone(x, y, [PILLAR, 22])).albedo(hex(0xa7a29c));
                canvas.set(x, y, tilted(paint, x, y, |x, y| pillar(x - left as f32, y)));
            }
        }
    }
    for [x, y, r] in BARRELS {
        canvas.ellipse(x, y, r, r, |u, v| {
            let (px, py) = (x + u * r, y + v * r);
            let hoop = (u.hypot(v) - 0.82).abs() < 0.07;
            let color = if hoop {
                hex(0x5d6166)
            } else {
                ramp(OAK, 0.5 + 0.4 * (hash(px as i32 / 4, 3, 61) - 0.5), px as i32, py as i32)
            };
            let height = move |px: f32, py: f32| {
                let from = ((px - x) / r).hypot((py - y) / r).min(1.0);
                let plank = if (px / 4.0).fract() < 0.2 { -0.5 } else { 0.0 };
                7.0 * (1.0 - from * from).sqrt() + plank
            };
            tilted(Paint::solid(color).albedo(hex(0x9c6f42)), px as i32, py as i32, height)
        });
    }
    // The hook and the chain of the lantern.
    (14..58).filter(|y| y % 3 != 0).for_each(|y| canvas.recolor(48, y, hex(0x2e2b29)));
    Art {
        name: "cellar",
        canvas,
        layers: &[Layer::Color, Layer::Albedo, Layer::Opacity, Layer::Normal],
    }
}

/// The place within a brick or slab of a size, joints on its upper and left edge, and which one it is.
fn course(x: i32, y: i32, [w, h]: [i32; 2]) -> ([i32; 2], [i32; 2]) {
    let row = y.div_euclid(h);
    let x = x + row % 2 * w / 2;
    ([x.rem_euclid(w), y.rem_euclid(h)], [x.div_euclid(w), row])
}

fn brick(x: i32, y: i32) -> Color {
    let ([u, v], [i, j]) = course(x, y, BRICK);
    if u == 0 || v == 0 {
        return MORTAR;
    }
    let tone = 0.25 + 0.5 * hash(i, j, 62) + 0.25 * (rough(x as f32, y as f32, 6.0, 63) - 0.5);
    ramp(CLAY, tone, x, y)
}

fn stone(x: i32, y: i32, size: [i32; 2]) -> Color {
    let ([u, v], [i, j]) = course(x, y, size);
    let joint = if u == 0 || v == 0 { 0.3 } else { 0.0 };
    ramp(STONE, 0.4 + 0.4 * hash(i, j, 64) - joint + 0.2 * rough(x as f32, y as f32, 8.0, 65), x, y)
}

/// Height of the wall, px: bricks with round edges, each a little askew.
fn bricks(x: f32, y: f32) -> f32 {
    cushions(x, y, BRICK, 2.2) + 0.8 * rough(x, y, 5.0, 66)
}

fn slabs(x: f32, y: f32) -> f32 {
    cushions(x, y - FLOOR as f32, [40, 12], 1.6) + 0.6 * rough(x, y, 7.0, 67)
}

/// A round pillar of drums.
fn pillar(x: f32, y: f32) -> f32 {
    let across = (2.0 * x / PILLAR as f32 - 1.0).clamp(-1.0, 1.0);
    let joint = if y.rem_euclid(22.0) < 1.0 { -0.8 } else { 0.0 };
    7.0 * (1.0 - 0.95 * across * across).sqrt() + joint + 0.5 * rough(x, y, 6.0, 68)
}

fn cushions(x: f32, y: f32, size: [i32; 2], edge: f32) -> f32 {
    let ([u, v], [i, j]) = course(x.floor() as i32, y.floor() as i32, size);
    let (u, v) = (u as f32 + x.fract(), v as f32 + y.fract());
    let [w, h] = size.map(|side| side as f32);
    let inside = (u - 1.0).min(w - u).min(v - 1.0).min(h - v).clamp(0.0, edge) / edge;
    let askew = |seed| 0.16 * (hash(i, j, seed) - 0.5);
    1.8 * inside * (2.0 - inside) + askew(69) * (u - 0.5 * w) + askew(70) * (v - 0.5 * h)
}

/// Paint with the normal of a height field, as a normal map has it: y up.
fn tilted(paint: Paint, x: i32, y: i32, height: impl Fn(f32, f32) -> f32) -> Paint {
    const BESIDE: f32 = 0.5;
    let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
    let slope =
        |dx: f32, dy: f32| (height(x + dx, y + dy) - height(x - dx, y - dy)) / (2.0 * BESIDE);
    let normal = normal_of_slope([slope(BESIDE, 0.0), -slope(0.0, BESIDE)]);
    Paint { normal: normal.map(|v| (127.0 * v + 128.0).round() as u8), ..paint }
}
