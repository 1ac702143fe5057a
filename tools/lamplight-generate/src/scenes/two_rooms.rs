//! The floors of two rooms seen from above; walls, furniture and lamps are shapes in the scene file.

use super::canvas::{Art, Canvas, Color, Layer, Paint, hash, hex, mix, ramp, rough};

const W: i32 = 256;
const H: i32 = 144;
/// Left of it is the living room, right of it the bath.
const PARTITION: i32 = 136;

pub fn draw() -> Art {
    let mut canvas = Canvas::new(W, H, |x, y| {
        Paint::open(if x < PARTITION { parquet(x, y) } else { tiles(x, y) })
    });
    rug(&mut canvas);
    mat(&mut canvas);
    Art { name: "two_rooms", canvas, layers: &[Layer::Color] }
}

/// Herringbone: boards of 4×12 px, turned in every other square of 12 px.
fn parquet(x: i32, y: i32) -> Color {
    let turned = (x / 12 + y / 12) % 2 == 0;
    let (along, across) = if turned { (y, x) } else { (x, y) };
    let joint = across % 4 == 3 || along % 12 == 11;
    let board = hash(across / 4, along / 12 + i32::from(turned) * 99, 140);
    let grain = rough(along as f32 * 0.25, across as f32 * 2.0, 4.0, 141);
    let tone = if joint { 0.05 } else { 0.3 + board * 0.45 + (grain - 0.5) * 0.5 };
    ramp(&[0x8a5e3c, 0xa87a4c, 0xc49460, 0xd8ae78], tone, x, y)
}

fn tiles(x: i32, y: i32) -> Color {
    let joint = x % 10 == 5 || y % 10 == 4;
    let dark = ((x + 5) / 10 + (y + 6) / 10) % 2 == 0;
    let shine = hash((x + 5) / 10, (y + 6) / 10, 142) * 0.4
        + (rough(x as f32, y as f32, 8.0, 143) - 0.5) * 0.3;
    if joint {
        hex(0xa8a8b0)
    } else if dark {
        ramp(&[0x9ab0bc, 0xb0c4cc], 0.3 + shine, x, y)
    } else {
        ramp(&[0xdcdcd8, 0xf2f0ea], 0.3 + shine, x, y)
    }
}

fn rug(canvas: &mut Canvas) {
    for y in 46..104i32 {
        for x in 34..104i32 {
            let (u, v) = ((x - 69).abs(), (y - 75).abs());
            let edge = (35 - u).min(29 - v);
            let diamond = u * 2 / 3 + v;
            let wool = (hash(x, y, 144) - 0.5) * 0.12;
            let base = match (edge, diamond) {
                (..=1, _) => hex(0xe8d8b8),
                (2..=4, _) => hex(0x3c5c88),
                (5, _) => hex(0xe8d8b8),
                (_, 16..=18) => hex(0xe8c878),
                (_, ..16) => hex(0x4c74a0),
                _ => hex(0xa84848),
            };
            let star = edge > 5 && (x / 3 + y / 3) % 4 == 0 && diamond > 20;
            let color = if star { hex(0xd88060) } else { base };
            canvas.recolor(x, y, mix(color, [0; 3], 0.06 + wool));
        }
    }
}

fn mat(canvas: &mut Canvas) {
    for y in 98..116 {
        for x in 176..206 {
            let stripe = (x - 176) / 3 % 2 == 0;
            canvas.recolor(x, y, hex(if stripe { 0x6cb0b0 } else { 0xe8f0ec }));
        }
    }
}
