//! The deep sea, 211×127: two primes, so that nothing about the size is even.

use super::canvas::{Art, Canvas, Color, Layer, Paint, hash, hex, mix, ramp, rough, scale};

const W: i32 = 211;
const H: i32 = 127;

const SAND: &[u32] = &[0x8a7a68, 0xaa9678, 0xccb892];
const ROCK: &[u32] = &[0x545068, 0x6e6a80, 0x8e8a98, 0xb0a8a8];

pub fn draw() -> Art {
    let mut canvas = Canvas::new(W, H, |x, y| {
        let open = y < bottom(x) && !cliff(x, y);
        if open { sea(backdrop(x, y)) } else { Paint::solid(rock(x, y)) }
    });
    for (x, height, color) in [
        (38, 34, 0x6c9a4c),
        (45, 24, 0x8ab05a),
        (132, 28, 0x5c9a60),
        (140, 40, 0x7aa850),
        (147, 22, 0x6c9a4c),
    ] {
        kelp(&mut canvas, x, height, hex(color));
    }
    corals(&mut canvas);
    for (x, y, size, code) in [
        (58, 30, 8.0, 0xff6ad0),
        (92, 14, 5.0, 0x8a7aff),
        (112, 44, 6.0, 0x40d8ff),
        (30, 58, 4.0, 0x8a7aff),
    ] {
        jellyfish(&mut canvas, x, y, size, hex(code));
    }
    fish(&mut canvas);
    angler(&mut canvas, 18, 84);
    submarine(&mut canvas, 142, 24);
    chest(&mut canvas, 100);
    Art {
        name: "odd",
        canvas,
        layers: &[Layer::Color, Layer::Albedo, Layer::Emission, Layer::Opacity, Layer::Tint],
    }
}

/// Water: a little is absorbed, red first, a little is scattered.
fn sea(color: Color) -> Paint {
    Paint { opacity: 1, tint: [251, 253, 254], albedo: hex(0xc0f0ff), ..Paint::open(color) }
}

fn bottom(x: i32) -> i32 {
    113 - (rough(x as f32, 0.0, 36.0, 121) * 14.0) as i32
}

fn cliff(x: i32, y: i32) -> bool {
    let (fx, fy) = (x as f32, y as f32);
    let ragged = (rough(fx, fy, 14.0, 122) - 0.5) * 16.0;
    let left = 2.0 + ((fy - 40.0) / 13.0).powi(2) * 0.5;
    let right = 10.0 + ((fy - 30.0) / 9.0).max(0.0).powi(2) * 0.45;
    let arch = ((fx - 176.0) / 34.0).powi(2) + ((fy - 106.0) / 30.0).powi(2);
    let hole = ((fx - 178.0) / 21.0).powi(2) + ((fy - 110.0) / 20.0).powi(2);
    let wall = fx + ragged < left || fx - ragged > W as f32 - right;
    (wall || arch + ragged * 0.02 < 1.0) && hole + ragged * 0.02 > 1.0
}

fn backdrop(x: i32, y: i32) -> Color {
    let (fx, fy) = (x as f32, y as f32);
    let far = 88.0 - rough(fx, 5.0, 44.0, 123) * 44.0;
    let nearer = 108.0 - rough(fx, 8.0, 28.0, 124) * 40.0;
    if fy > nearer {
        ramp(&[0x44688a, 0x527a98], rough(fx, fy, 9.0, 125), x, y)
    } else if fy > far {
        ramp(&[0x5282a4, 0x6090ae], rough(fx, fy, 12.0, 126), x, y)
    } else {
        let beam = rough(fx + fy * 0.45, 0.0, 22.0, 127) * 0.3;
        ramp(&[0x8cb8c8, 0x78a8bc, 0x6898b0, 0x5c8aa8], fy / 90.0 + 0.15 - beam, x, y)
    }
}

fn rock(x: i32, y: i32) -> Color {
    let (fx, fy) = (x as f32, y as f32);
    if y >= bottom(x) {
        let drift = rough(fx, fy * 3.0, 12.0, 128);
        return ramp(
            SAND,
            drift * 1.4 - (y - bottom(x)) as f32 * 0.04 + (hash(x, y, 129) - 0.5) * 0.2,
            x,
            y,
        );
    }
    let slope = rough(fx, fy + 1.5, 9.0, 130) - rough(fx, fy - 1.5, 9.0, 130);
    ramp(ROCK, 0.5 + slope * 1.6, x, y)
}

fn kelp(canvas: &mut Canvas, x: i32, height: i32, color: Color) {
    let foot = bottom(x);
    for i in 0..height {
        let sway = ((i as f32 * 0.24 + x as f32).sin() * (1.0 + i as f32 * 0.06)).round() as i32;
        let frond = |shade: f32| Paint { opacity: 120, ..sea(scale(color, shade)) }.albedo(color);
        canvas.set(x + sway, foot - i, frond(0.8));
        let side = if i % 6 < 3 { 1 } else { -1 };
        if i % 3 != 2 {
            canvas.set(x + sway + side, foot - i, frond(1.1));
            canvas.set(x + sway + side * 2, foot - i - 1, frond(1.25));
        }
    }
}

fn corals(canvas: &mut Canvas) {
    let fan = ["#..#..#", ".#.#.#.", "#.###.#", ".#.#.#.", "..###..", "...#..."];
    let brain = ["..###..", ".#o#o#.", "#o#o#o#", "##o#o##"];
    let tubes = ["o...o..", "#.o.#.o", "#.#.#.#", "#.#.#.#", "#######"];
    for (x, rows, code, glow) in [
        (54, &fan[..], 0xf07a8a, 0),
        (66, &brain, 0xe8a05c, 0),
        (78, &tubes, 0xb87ae0, 0x8a3af0),
        (120, &fan, 0xf0b060, 0),
        (170, &tubes, 0x60d8b0, 0x18c890),
        (184, &brain, 0xe87aa8, 0),
    ] {
        let foot = bottom(x + 3) + 1;
        canvas.sprite(x, foot - rows.len() as i32, rows, |c| {
            let tip = Paint::solid(mix(hex(code), [255; 3], 0.5)).glow(hex(glow));
            match c {
                '#' => Some(Paint::solid(hex(code))),
                'o' => Some(tip),
                _ => None,
            }
        });
    }
}

fn jellyfish(canvas: &mut Canvas, x: i32, y: i32, size: f32, glow: Color) {
    let flesh = |share: f32, opacity: u8| {
        Paint { opacity, tint: [255; 3], ..sea(mix(glow, [255; 3], 0.35)) }.glow(scale(glow, share))
    };
    canvas.ellipse(x as f32 + 0.5, y as f32, size, size * 0.8, |u, v| {
        let rim = u * u + v * v > 0.6;
        flesh(if rim { 0.9 } else { 0.6 }, if rim { 150 } else { 60 })
    });
    // Below the middle of the bell there is water and arms.
    for dy in 1..=size as i32 {
        for dx in -(size as i32)..=size as i32 {
            if canvas.get(x + dx, y + dy).is_some_and(|p| p.emission != [0; 3]) {
                canvas.set(x + dx, y + dy, sea(backdrop(x + dx, y + dy)));
            }
        }
    }
    let mut arm = -(size as i32) + 1;
    while arm < size as i32 {
        let length = size as i32 * 2 + (hash(x, arm, 131) * size) as i32;
        for i in 1..length {
            let sway = ((i as f32 * 0.5 + arm as f32).sin() * 1.3).round() as i32;
            canvas.set(x + arm + sway, y + i, flesh(0.5 * (1.0 - i as f32 / length as f32), 70));
        }
        arm += 3;
    }
}

fn fish(canvas: &mut Canvas) {
    let swimmer = ["#..##.", "#####o", "#.###."];
    for (x, y, code) in [
        (70, 62, 0xf8b048),
        (79, 66, 0xf8b048),
        (74, 71, 0xf8b048),
        (84, 60, 0xf8b048),
        (120, 20, 0xe86a6a),
        (126, 25, 0xe86a6a),
        (40, 22, 0x68c8d8),
        (154, 70, 0xe8e070),
        (148, 76, 0xe8e070),
    ] {
        canvas.sprite(x, y, &swimmer, |c| match c {
            '#' => Some(Paint::solid(hex(code))),
            'o' => Some(Paint::solid(hex(0x303848))),
            _ => None,
        });
    }
}

fn angler(canvas: &mut Canvas, x: i32, y: i32) {
    let rows = [
        "......bbb.....",
        ".....b...b....",
        "....b.....l...",
        "...bbbb..lLl..",
        "..bbbbbb..l...",
        "b.bbbbowb.....",
        "bbbbbbbbbt....",
        "bbbbbbbtkk....",
        "b.bbbbbkkt....",
        "...bbbbbbt....",
        "....bfbb......",
        "....ff........",
    ];
    canvas.sprite(x, y, &rows, |c| {
        Some(match c {
            'b' => Paint::solid(hex(0x6a5a70)),
            'f' => Paint::solid(hex(0x8a7284)),
            'o' => Paint::solid(hex(0x202028)),
            'w' => Paint::solid(hex(0xffffff)),
            't' => Paint::solid(hex(0xf0f0e0)),
            'k' => Paint::solid(hex(0x402838)),
            'l' => Paint::solid(hex(0xd8fff0)).glow(hex(0x60f0c0)),
            'L' => Paint::solid(hex(0xffffff)).glow(hex(0xd0fff0)),
            _ => return None,
        })
    });
}

fn submarine(canvas: &mut Canvas, x: i32, y: i32) {
    let rows = [
        "............ddd.............",
        "............d...............",
        "..........yyyyy.............",
        "..........yyyyy.............",
        "....yyyyyyyyyyyyyyyyyy......",
        "d.yyyyyyyyyyyyyyyyyyyyyyy...",
        "dyyyyyppyyyyppyyyyppyyyyyyh.",
        "DyyyyppppyyppppyyppppyyyyyhH",
        "DyyyyppppyyppppyyppppyyyyyhH",
        "doooooppooooppooooppooooooh.",
        "d.ooooooooooooooooooooooo...",
        "....dddddddddddddddddd......",
    ];
    canvas.sprite(x, y, &rows, |c| {
        Some(match c {
            'y' => Paint::solid(hex(0xf0c040)),
            'o' => Paint::solid(hex(0xc88a30)),
            'd' => Paint::solid(hex(0x7a7680)),
            'D' => Paint::solid(hex(0xa8a4ac)),
            'p' => Paint::solid(hex(0xffe8b0)).glow(hex(0xf0a850)),
            'h' => Paint::solid(hex(0xf4f4ff)).glow(hex(0xb0c8ff)),
            'H' => Paint::solid(hex(0xffffff)).glow(hex(0xf0f6ff)),
            _ => return None,
        })
    });
}

fn chest(canvas: &mut Canvas, x: i32) {
    let rows = [
        "..bbbbbbb..",
        ".bwwwwwwwb.",
        ".bbbbbbbbb.",
        "...g.gg....",
        ".gGgGggGgg.",
        "bbbbbybbbbb",
        "bwwwwywwwwb",
        "bwwwwwwwwwb",
        "bbbbbbbbbbb",
    ];
    let foot = bottom(x + 5) + 2;
    canvas.sprite(x, foot - 9, &rows, |c| {
        Some(match c {
            'b' => Paint::solid(hex(0x7a5236)),
            'w' => Paint::solid(hex(0xa8764a)),
            'y' => Paint::solid(hex(0xf0d060)),
            'g' => Paint::solid(hex(0xffd860)).glow(hex(0xe0901c)),
            'G' => Paint::solid(hex(0xfff4b0)).glow(hex(0xffd060)),
            _ => return None,
        })
    });
}
