//! A street after the rain, full of signs.

use super::canvas::{Art, Canvas, Color, Layer, Paint, hash, hex, mix, ramp, rough, scale};

const W: i32 = 320;
const H: i32 = 180;
/// The row at which the houses end and the wet street begins.
const KERB: i32 = 148;

/// A house: left edge, width, top, colour, storeys' height, seed of its windows.
const HOUSES: [(i32, i32, i32, u32); 8] = [
    (0, 38, 34, 0x8a5a5a),
    (38, 46, 14, 0x5f6f8e),
    (84, 34, 52, 0x8d7a5c),
    (118, 52, 24, 0x6b5a80),
    (170, 30, 64, 0x5a8080),
    (200, 48, 8, 0x7c6a6a),
    (248, 32, 46, 0x60708a),
    (280, 40, 28, 0x8a6a55),
];

pub fn draw() -> Art {
    let mut canvas = Canvas::new(W, H, |x, y| Paint::open(sky(x, y)));
    for (i, house) in HOUSES.into_iter().enumerate() {
        facade(&mut canvas, i as i32, house);
    }
    street(&mut canvas);
    shops(&mut canvas);
    signs(&mut canvas);
    street_lamps(&mut canvas);
    car(&mut canvas, 214);
    cat(&mut canvas);
    Art {
        name: "night_street",
        canvas,
        layers: &[Layer::Color, Layer::Albedo, Layer::Emission, Layer::Opacity],
    }
}

fn sky(x: i32, y: i32) -> Color {
    let haze = ramp(&[0x2a2c55, 0x3d3868, 0x5e4878, 0x865a80], y as f32 / 110.0, x, y);
    if hash(x, y, 80) < 0.004 * (1.0 - y as f32 / 90.0) { hex(0xfff2d8) } else { haze }
}

fn facade(canvas: &mut Canvas, house: i32, (left, width, top, color): (i32, i32, i32, u32)) {
    let wall = hex(color);
    let dark = scale(wall, 0.62);
    for y in top..KERB {
        for x in left..left + width {
            let edge = x == left || x == left + width - 1;
            let brick = y % 3 == 0 || (x + y / 3 % 2 * 3) % 6 == 0;
            let worn = 0.9 + (rough(x as f32, y as f32, 12.0, 81) - 0.5) * 0.35;
            let tone = if edge {
                0.7
            } else if brick {
                worn * 0.85
            } else {
                worn
            };
            canvas.set(x, y, Paint::open(scale(wall, tone)));
        }
    }
    // Cornice: a real ledge that shades what is under it.
    for x in left - 1..left + width + 1 {
        canvas.set(x, top, Paint::solid(scale(wall, 1.25)));
        canvas.set(x, top + 1, Paint::solid(dark));
    }
    let columns = (width - 6) / 9;
    let margin = (width - columns * 9 + 3) / 2;
    for row in 0..(KERB - 30 - top) / 13 {
        for column in 0..columns {
            let (x, y) = (left + margin + column * 9, top + 7 + row * 13);
            window(canvas, x, y, hash(column, row + house * 31, 82), dark);
        }
    }
}

fn window(canvas: &mut Canvas, x: i32, y: i32, luck: f32, frame: Color) {
    canvas.rect(x - 1, y - 1, 8, 9, Paint::open(frame));
    let pane = match luck {
        l if l < 0.2 => Some((hex(0xffd890), hex(0xc08a40))),
        l if l < 0.27 => Some((hex(0xd8e8ff), hex(0x6a8ac0))),
        l if l < 0.31 => Some((hex(0xffa8c8), hex(0xb04878))),
        _ => None,
    };
    for dy in 0..7 {
        for dx in 0..6 {
            let paint = match pane {
                Some((color, glow)) => {
                    let curtain = if !(1..=4).contains(&dx) { 0.55 } else { 1.0 };
                    Paint { opacity: 26, ..Paint::open(color).glow(scale(glow, curtain)) }
                }
                None => Paint::open(if dx + dy == 5 || dx + dy == 6 {
                    hex(0x7c88a8)
                } else {
                    hex(0x454c68)
                }),
            };
            canvas.set(x + dx, y + dy, paint);
        }
        canvas.set(x + 3, y + dy, Paint::open(frame));
    }
    canvas.rect(x - 1, y + 7, 8, 1, Paint::solid(scale(frame, 1.5)));
}

/// Asphalt under a film of water: light sinks in and comes back.
fn street(canvas: &mut Canvas) {
    for y in KERB..H {
        for x in 0..W {
            let deep = y - KERB;
            let pavement = deep < 5;
            let puddle = rough(x as f32, y as f32 * 3.0, 40.0, 83) > 0.52;
            let grain = (hash(x, y, 84) - 0.5) * 0.3;
            let color = if pavement {
                ramp(
                    &[0x6a6672, 0x85808a, 0xa09aa2],
                    0.5 + grain + if x % 12 == 0 || deep == 4 { -0.5 } else { 0.1 },
                    x,
                    y,
                )
            } else if puddle {
                ramp(&[0xa8b4d0, 0xc4cee4], 0.4 + grain * 2.0, x, y)
            } else {
                ramp(&[0x6c6a7e, 0x807e92, 0x9a98a6], 0.5 + grain, x, y)
            };
            let opacity = if pavement { 6 } else { 4 + (deep / 5) as u8 };
            canvas.set(x, y, Paint { opacity, albedo: hex(0xe8ecf4), ..Paint::open(color) });
        }
    }
    for x in (6..W).step_by(34) {
        for dx in 0..16 {
            canvas.recolor(x + dx, 166, hex(0xc8c4b0));
        }
    }
}

fn shops(canvas: &mut Canvas) {
    for (i, (left, width, _, color)) in HOUSES.into_iter().enumerate() {
        let stripe = [0xd84a4a, 0x3f8fb8, 0x4a9a5a, 0xd8a040][i % 4];
        let (from, to) = (left + 3, left + width - 3);
        // A shop window that glows a little, and a door.
        for y in 124..KERB {
            for x in from + 9..to {
                let shelf = y % 8 == 0;
                let thing = hash(x / 2, y / 3, 85 + i as u32);
                let color = mix(
                    hex(0xf0d8a8),
                    hex([0xb85a4a, 0x5a8ab0, 0x7aa860][(thing * 3.0) as usize]),
                    if thing > 0.55 { 0.7 } else { 0.1 },
                );
                let paint = Paint::open(if shelf { hex(0x8a6a4a) } else { color });
                let lit = i % 3 != 1;
                canvas.set(
                    x,
                    y,
                    if lit {
                        Paint { opacity: 20, ..paint.glow(hex(0x4c3c24)) }
                    } else {
                        Paint::open(scale(color, 0.5))
                    },
                );
            }
            for x in from..from + 7 {
                let panel = x == from || x == from + 6 || (y - 124) % 11 == 0;
                canvas.set(x, y, Paint::open(if panel { hex(0x54382a) } else { hex(0x7d5236) }));
            }
            canvas.set(from + 5, 136, Paint::open(hex(0xe8c860)));
        }
        canvas.rect(left + 1, 122, width - 2, 2, Paint::open(scale(hex(color), 0.5)));
        // An awning.
        for dx in 0..to - from - 8 {
            for dy in 0..4 {
                let cloth = if dx / 3 % 2 == 0 { hex(stripe) } else { hex(0xf0e8dc) };
                canvas.set(
                    from + 9 + dx,
                    121 + dy,
                    Paint::solid(scale(cloth, 1.0 - dy as f32 * 0.1)),
                );
            }
        }
    }
}

/// Letters of 3×5.
fn letter(c: char) -> [&'static str; 5] {
    match c {
        'A' => [".#.", "#.#", "###", "#.#", "#.#"],
        'B' => ["##.", "#.#", "##.", "#.#", "##."],
        'C' => [".##", "#..", "#..", "#..", ".##"],
        'D' => ["##.", "#.#", "#.#", "#.#", "##."],
        'E' => ["###", "#..", "##.", "#..", "###"],
        'F' => ["###", "#..", "##.", "#..", "#.."],
        'G' => [".##", "#..", "#.#", "#.#", ".##"],
        'H' => ["#.#", "#.#", "###", "#.#", "#.#"],
        'I' => ["###", ".#.", ".#.", ".#.", "###"],
        'J' => ["..#", "..#", "..#", "#.#", ".#."],
        'K' => ["#.#", "#.#", "##.", "#.#", "#.#"],
        'L' => ["#..", "#..", "#..", "#..", "###"],
        'M' => ["#.#", "###", "###", "#.#", "#.#"],
        'N' => ["##.", "#.#", "#.#", "#.#", "#.#"],
        'O' => ["###", "#.#", "#.#", "#.#", "###"],
        'P' => ["##.", "#.#", "##.", "#..", "#.."],
        'R' => ["##.", "#.#", "##.", "#.#", "#.#"],
        'S' => [".##", "#..", ".#.", "..#", "##."],
        'T' => ["###", ".#.", ".#.", ".#.", ".#."],
        'U' => ["#.#", "#.#", "#.#", "#.#", "###"],
        'Z' => ["###", "..#", ".#.", "#..", "###"],
        '2' => ["##.", "..#", ".#.", "#..", "###"],
        '4' => ["#.#", "#.#", "###", "..#", "..#"],
        _ => ["...", "...", "...", "...", "..."],
    }
}

const RED: u32 = 0xff3a4a;
const PINK: u32 = 0xff4ac0;
const BLUE: u32 = 0x3a7aff;
const CYAN: u32 = 0x30e0f0;
const GREEN: u32 = 0x40f070;
const AMBER: u32 = 0xffa030;
const VIOLET: u32 = 0x9a50ff;

fn signs(canvas: &mut Canvas) {
    for (text, x, y, down, code) in [
        ("HOTEL", 74, 30, true, RED),
        ("RAMEN", 10, 110, false, AMBER),
        ("BAR", 52, 109, false, PINK),
        ("NOODLES", 3, 52, true, CYAN),
        ("CAFE", 93, 109, false, GREEN),
        ("CINEMA", 130, 109, false, BLUE),
        ("JAZZ", 160, 46, true, VIOLET),
        ("OPEN", 177, 110, false, RED),
        ("24H", 213, 109, false, CYAN),
        ("ARCADE", 239, 26, true, PINK),
        ("SUSHI", 253, 109, false, RED),
        ("BOOKS", 288, 109, false, AMBER),
        ("TEA", 311, 54, true, GREEN),
        ("LUNA", 204, 20, false, VIOLET),
    ] {
        let count = text.len() as i32;
        let (w, h) = if down { (7, count * 6 + 3) } else { (count * 4 + 3, 9) };
        let tube = hex(code);
        let box_color = mix(hex(0x2a2838), tube, 0.12);
        canvas.rect(x, y, w, h, Paint::open(box_color));
        for i in 0..w.max(h) {
            for (ex, ey) in [(x + i, y), (x + i, y + h - 1), (x, y + i), (x + w - 1, y + i)] {
                if ex < x + w && ey < y + h {
                    canvas.set(ex, ey, Paint::open(mix(hex(0x5a566a), tube, 0.3)));
                }
            }
        }
        for (i, c) in (0..).zip(text.chars()) {
            let (lx, ly) = if down { (x + 2, y + 2 + i * 6) } else { (x + 2 + i * 4, y + 2) };
            canvas.sprite(lx, ly, &letter(c), |c| {
                (c == '#').then(|| Paint::solid(mix(tube, [255; 3], 0.35)).glow(tube))
            });
        }
    }
    // Pictures in tubes: a bowl, a moon, an arrow.
    let neon = |code: u32| {
        move |c: char| {
            (c == '#').then(|| Paint::solid(mix(hex(code), [255; 3], 0.35)).glow(hex(code)))
        }
    };
    canvas.sprite(
        16,
        94,
        &[
            "..#.#.#..",
            ".#.#.#...",
            ".........",
            "#########",
            "#.......#",
            ".#.....#.",
            "..#####..",
        ],
        neon(AMBER),
    );
    canvas.sprite(
        132,
        70,
        &["...###", ".##...", "#.....", "#.....", ".##...", "...###"],
        neon(CYAN),
    );
    canvas.sprite(
        100,
        92,
        &[
            ".#.#.....",
            "..#.#....",
            "#######..",
            "#.....###",
            "#.....#.#",
            "#.....###",
            ".#####...",
        ],
        neon(GREEN),
    );
    canvas.sprite(
        262,
        90,
        &["..######..", ".#......##", "#.#.....#.", ".#......##", "..######.."],
        neon(RED),
    );
}

fn street_lamps(canvas: &mut Canvas) {
    for x in [66, 196, 308] {
        for y in 118..KERB + 2 {
            canvas.set(x, y, Paint::open(hex(0x4c4a58)));
        }
        canvas.rect(x - 4, 117, 5, 1, Paint::open(hex(0x4c4a58)));
    }
}

fn car(canvas: &mut Canvas, x: i32) {
    let rows = [
        "........wwwwwwww..........",
        ".......wggggwgggw.........",
        "......wgggggwggggw........",
        "..rrrrrrrrrrrrrrrrrrrrr...",
        "Trrrrrrrrrrrrrrrrrrrrrrrh.",
        "TrrrkkkrrrrrrrrrrrkkkrrrH.",
        ".dddkkkkddddddddddkkkkddd.",
        "....kkk...........kkk.....",
    ];
    canvas.sprite(x, KERB + 4, &rows, |c| {
        let solid = |code| Paint::solid(hex(code));
        Some(match c {
            'w' => solid(0xf0c84a),
            'g' => Paint { opacity: 60, ..Paint::open(hex(0x9ac8e0)) },
            'r' => solid(0xe8b83a),
            'd' => solid(0xa87828),
            'k' => solid(0x3a3840),
            'h' | 'H' => solid(0xfffbe8).glow(hex(0xfff0c0)),
            'T' => solid(0xff5a4a).glow(hex(0xd01a1a)),
            _ => return None,
        })
    });
}

fn cat(canvas: &mut Canvas) {
    canvas.sprite(112, 46, &["#.#...", "###..#", "####.#", ".#####", ".#.##."], |c| {
        (c == '#').then(|| Paint::solid(hex(0x5a5060)))
    });
}
