//! A church in the morning: the sun stands outside, every pane throws its own colour.

use super::canvas::{Art, Canvas, Color, Layer, Paint, hash, hex, mix, ramp, rough};

const W: i32 = 320;
const H: i32 = 200;
/// Columns of the window wall.
const WALL: std::ops::Range<i32> = 53..61;
/// Columns of the glass in it.
const GLASS: std::ops::Range<i32> = 55..59;
const FLOOR: i32 = 176;

const STONE: &[u32] = &[0x6f675f, 0x8f857a, 0xaea392, 0xcdc2ad];
const FAR_STONE: &[u32] = &[0x77706e, 0x8e8782, 0xa69e96, 0xbdb5aa];
const WOOD: &[u32] = &[0x5b3a24, 0x7c5231, 0xa0713f];
const STONE_ALBEDO: Color = hex(0xb8ae9e);
/// Transmittance of a pane per px; the glass is 4 px thick.
const PANES: [Color; 6] = [
    [252, 148, 128],
    [254, 214, 120],
    [140, 236, 158],
    [130, 196, 255],
    [172, 142, 255],
    [255, 150, 214],
];

pub fn draw() -> Art {
    let mut canvas =
        Canvas::new(W, H, |x, y| if x < WALL.start { outside(x, y) } else { nave(x, y) });
    garden(&mut canvas);
    windows(&mut canvas);
    furnish(&mut canvas);
    Art {
        name: "stained_glass",
        canvas,
        layers: &[Layer::Color, Layer::Albedo, Layer::Emission, Layer::Opacity, Layer::Tint],
    }
}

fn outside(x: i32, y: i32) -> Paint {
    let cloud = rough(x as f32, y as f32 * 2.5, 24.0, 41);
    let sky = ramp(&[0x3c68a0, 0x5880ac, 0x7c9cb8], y as f32 / 150.0, x, y);
    Paint::open(if cloud > 0.6 { mix(sky, [190; 3], 0.5) } else { sky })
}

/// The vault is an arch, the floor is flat, the east end is a wall.
fn nave(x: i32, y: i32) -> Paint {
    let (fx, fy) = (x as f32 + 0.5, y as f32 + 0.5);
    let bay = (fx - 60.0) / 62.0;
    let rib = bay.fract() - 0.5;
    let vault = 12.0 + rib * rib * 44.0;
    if y >= FLOOR || fy < vault || x >= W - 10 || WALL.contains(&x) {
        return masonry(x, y);
    }
    // Behind: columns between the bays, arches over the side aisle, a gallery.
    let column = (rib.abs() - 0.5).abs() * 62.0;
    let gallery = (84..88).contains(&y);
    let aisle = (rib * 2.0).powi(2) * 20.0 + 96.0 < fy;
    let light = rough(fx, fy, 18.0, 42) * 0.5;
    if column < 5.0 {
        let round = 1.0 - (column / 5.0).powi(2);
        let ring = y == 80 || y == 92 || y > FLOOR - 5;
        return Paint::open(ramp(
            STONE,
            0.25 + round * 0.5 + light * 0.4 + f32::from(ring) * 0.2,
            x,
            y,
        ));
    }
    let tone = match (gallery, aisle && fy < 168.0) {
        (true, _) => 0.9,
        (_, true) => 0.05 + light * 0.35,
        _ => 0.3 + light,
    };
    let joint = y % 9 == 0 || (x + y / 9 * 7) % 17 == 0;
    let tone = if joint && !gallery { tone - 0.14 } else { tone };
    Paint::open(ramp(FAR_STONE, tone, x, y))
}

fn masonry(x: i32, y: i32) -> Paint {
    let row = y / 7;
    let joint = y % 7 == 0 || (x + row * 5) % 12 == 0;
    let block = hash((x + row * 5) / 12, row, 43);
    let tone = if joint { 0.15 } else { 0.45 + block * 0.35 + (hash(x, y, 44) - 0.5) * 0.2 };
    Paint::solid(ramp(STONE, tone, x, y)).albedo(STONE_ALBEDO)
}

fn garden(canvas: &mut Canvas) {
    canvas.disc(15.0, 58.0, 7.0, Paint::solid(hex(0xfff6d8)).glow([255, 240, 204]));
    for x in 0..WALL.start {
        let top = 160 + (rough(x as f32, 0.0, 20.0, 45) * 12.0) as i32;
        for y in top..H {
            let green = ramp(
                &[0x24421f, 0x355c28, 0x587c36],
                rough(x as f32, y as f32, 5.0, 46) * 1.2 - (y - top) as f32 * 0.02,
                x,
                y,
            );
            canvas.set(x, y, Paint::solid(green));
        }
    }
    for i in 0..14 {
        let (x, y) = (2.0 + hash(i, 0, 47) * 40.0, 163.0 + hash(i, 1, 47) * 10.0);
        let petal = [0xffffff, 0xffd35a, 0xf48fb1][i as usize % 3];
        canvas.disc(x, y, 1.0, Paint::solid(hex(petal)));
    }
}

/// A tall window of ten panes between lead lines.
fn windows(canvas: &mut Canvas) {
    const PANE: i32 = 12;
    for y in 28..28 + 10 * PANE + 1 {
        let (pane, row) = ((y - 28) / PANE, (y - 28) % PANE);
        let tint = PANES[pane as usize % PANES.len()];
        for x in WALL {
            let paint = if !GLASS.contains(&x) {
                Paint::open(hex(0xb8ae9e))
            } else if row == 0 {
                Paint::solid(hex(0x4a4540))
            } else {
                Paint { opacity: 2, tint, albedo: tint, ..Paint::open(mix(tint, [255; 3], 0.2)) }
            };
            canvas.set(x, y, paint);
        }
    }
}

fn furnish(canvas: &mut Canvas) {
    let wood =
        |x: i32, y: i32, tone: f32| Paint::solid(ramp(WOOD, tone, x, y)).albedo(hex(0x9a7048));
    // Pews.
    for x in (86..236).step_by(22) {
        for y in FLOOR - 13..FLOOR {
            for dx in 0..3 {
                canvas.set(x + dx, y, wood(x + dx, y, 0.9 - dx as f32 * 0.3));
            }
        }
        for dx in 3..12 {
            canvas.set(x + dx, FLOOR - 6, wood(x + dx, 0, 0.8));
            canvas.set(x + dx, FLOOR - 5, wood(x + dx, 0, 0.3));
        }
        (FLOOR - 5..FLOOR).for_each(|y| canvas.set(x + 10, y, wood(x, y, 0.5)));
    }
    // The altar on its steps, with two candles.
    for step in 0..3 {
        for x in 248 + step * 9..W - 10 {
            for y in FLOOR - 4 * (step + 1)..FLOOR - 4 * step {
                canvas.set(x, y, masonry(x, y));
            }
        }
    }
    for x in 278..304 {
        for y in 150..FLOOR - 12 {
            let cloth = y < 156 || (x - 278) % 13 < 2;
            let color = if y == 150 || cloth { hex(0xf4ecd8) } else { hex(0xa8323c) };
            // Cloth: light sinks in.
            canvas.set(x, y, Paint { opacity: 24, albedo: color, ..Paint::open(color) });
        }
    }
    for x in [282, 299] {
        canvas.rect(x - 1, 143, 2, 7, Paint::solid(hex(0xf2ead4)));
    }
    canvas.rect(290, 136, 2, 14, Paint::solid(hex(0xd9b14a)));
    canvas.rect(287, 140, 8, 2, Paint::solid(hex(0xd9b14a)));
    // A chandelier's ring and chain; its flames are lamps.
    for x in [122, 184] {
        (24..62).for_each(|y| {
            canvas.set(x, y, Paint::open(hex(if y % 2 == 0 { 0x6b5b3e } else { 0x8d7850 })))
        });
        for dx in -9..=9 {
            canvas.set(x + dx, 62, Paint::solid(hex(0xc79c46)));
        }
    }
}
