//! A dungeon from above: rooms on an irregular grid, 4-px walls, 8-px doors, dozens of small lamps.

use super::canvas::{Art, Canvas, Color, Layer, Paint, hash, hex, ramp, rough};
use crate::random::Random;
use std::fmt::Write;

const W: i32 = 512;
const H: i32 = 288;
const WALL: i32 = 4;
const DOOR: i32 = 8;
/// Walls between rooms, from one edge of the grid to the other: rooms are what lies between.
const COLUMNS: [i32; 13] = [0, 34, 86, 118, 164, 206, 262, 296, 340, 388, 420, 470, W - WALL];
const ROWS: [i32; 8] = [0, 38, 74, 122, 160, 204, 244, H - WALL];

/// The kind of a room.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Hall,
    Cellar,
    Garden,
    Library,
    Pool,
}

struct Room {
    x: i32,
    y: i32,
    w: i32,
    h: i32,
    kind: Kind,
}

/// The art, and the scene file with its lamps.
pub fn draw() -> (Art, String) {
    let mut random = Random::new(512 * 288);
    let rooms = rooms(&mut random);
    let mut canvas = Canvas::new(W, H, |x, y| Paint::solid(brick(x, y)));
    for room in &rooms {
        for y in room.y..room.y + room.h {
            for x in room.x..room.x + room.w {
                canvas.set(x, y, Paint::open(floor(room, x, y)));
            }
        }
    }
    doors(&mut canvas, &mut random);
    rooms.iter().for_each(|room| furnish(&mut canvas, room, &mut random));
    let file = scene_file(&rooms, &canvas, &mut random);
    let layers = &[Layer::Color, Layer::Albedo, Layer::Opacity];
    (Art { name: "dungeon", canvas, layers }, file)
}

fn rooms(random: &mut Random) -> Vec<Room> {
    let mut rooms = Vec::new();
    for (top, bottom) in ROWS.iter().zip(&ROWS[1..]) {
        for (left, right) in COLUMNS.iter().zip(&COLUMNS[1..]) {
            let kinds = [
                Kind::Hall,
                Kind::Hall,
                Kind::Cellar,
                Kind::Cellar,
                Kind::Garden,
                Kind::Library,
                Kind::Pool,
            ];
            let kind = kinds[random.below(kinds.len())];
            let (x, y) = (left + WALL, top + WALL);
            rooms.push(Room { x, y, w: right - x, h: bottom - y, kind });
        }
    }
    rooms
}

/// Enough doors that every room can be reached, and some more.
fn doors(canvas: &mut Canvas, random: &mut Random) {
    let (columns, rows) = (COLUMNS.len() - 1, ROWS.len() - 1);
    let mut group: Vec<usize> = (0..columns * rows).collect();
    let mut walls: Vec<(usize, usize)> = Vec::new();
    for room in 0..columns * rows {
        if room % columns + 1 < columns {
            walls.push((room, room + 1));
        }
        if room / columns + 1 < rows {
            walls.push((room, room + columns));
        }
    }
    for i in (1..walls.len()).rev() {
        walls.swap(i, random.below(i + 1));
    }
    for (a, b) in walls {
        let joins = group[a] != group[b];
        if !joins && random.below(5) > 0 {
            continue;
        }
        let (old, new) = (group[b], group[a]);
        group.iter_mut().filter(|g| **g == old).for_each(|g| *g = new);
        let (column, row) = (b % columns, b / columns);
        let place = |from: i32, to: i32, random: &mut Random| {
            from + WALL + 3 + random.below((to - from - WALL - DOOR - 6) as usize) as i32
        };
        let (x, y, w, h) = if b == a + 1 {
            (COLUMNS[column], place(ROWS[row], ROWS[row + 1], random), WALL, DOOR)
        } else {
            (place(COLUMNS[column], COLUMNS[column + 1], random), ROWS[row], DOOR, WALL)
        };
        for dy in 0..h {
            for dx in 0..w {
                let plank = if w == WALL { dy } else { dx } % 4 == 0;
                canvas.set(
                    x + dx,
                    y + dy,
                    Paint::open(hex(if plank { 0x6a4c36 } else { 0x94704c })),
                );
            }
        }
    }
}

fn brick(x: i32, y: i32) -> Color {
    let row = y / 2;
    let joint = (x + row % 2 * 3) % 6 == 0;
    let tone = if joint { 0.1 } else { 0.35 + hash((x + row % 2 * 3) / 6, row, 110) * 0.65 };
    ramp(&[0x6c6672, 0x8c8488, 0xaca29c, 0xc4baa8], tone, x, y)
}

fn floor(room: &Room, x: i32, y: i32) -> Color {
    let (u, v) = (x - room.x, y - room.y);
    let worn = rough(x as f32, y as f32, 12.0, 111) - 0.5;
    match room.kind {
        Kind::Hall => {
            let joint = u % 8 == 7 || v % 8 == 7;
            let tone = 0.45 + hash(u / 8 + room.x, v / 8 + room.y, 112) * 0.35 + worn * 0.5;
            let border = u.min(v).min(room.w - 1 - u).min(room.h - 1 - v) == 3;
            if border && room.w > 34 {
                return hex(0xb08a58);
            }
            ramp(
                &[0x60586a, 0x7c7480, 0x9a9096, 0xb4aaa8],
                if joint { tone - 0.3 } else { tone },
                x,
                y,
            )
        }
        Kind::Cellar => {
            let crack = worn.abs() < 0.018;
            ramp(&[0x5a544e, 0x786e62, 0x94887a], if crack { 0.0 } else { 0.55 + worn * 1.4 }, x, y)
        }
        Kind::Garden => {
            let grass = rough(x as f32, y as f32, 5.0, 113);
            match hash(x, y, 114) {
                h if h < 0.012 => hex(0xf4a8c0),
                h if h < 0.024 => hex(0xf8e08a),
                _ => ramp(&[0x4a6a3c, 0x648a46, 0x88a854], grass * 1.2 - 0.05, x, y),
            }
        }
        Kind::Library => {
            let board = v / 4;
            let joint = v % 4 == 3 || (u + board * 7) % 18 == 0;
            let tone = 0.4 + hash((u + board * 7) / 18, board + room.y, 115) * 0.5;
            ramp(
                &[0x5c3e2c, 0x7c5638, 0x9c7048, 0xb88a5c],
                if joint { 0.1 } else { tone + worn * 0.3 },
                x,
                y,
            )
        }
        Kind::Pool => {
            let edge = u.min(v).min(room.w - 1 - u).min(room.h - 1 - v);
            let water = rough(x as f32 * 0.7, y as f32 * 1.6, 9.0, 116);
            if edge < 6 {
                ramp(&[0x8a8e9a, 0xaab0b8], if (u + v) % 5 == 0 { 0.1 } else { 0.8 }, x, y)
            } else if (water - 0.5).abs() < 0.03 {
                hex(0xbce8ec)
            } else {
                ramp(&[0x3c7490, 0x4c8ea4, 0x6cacb8], water * 1.1, x, y)
            }
        }
    }
}

/// A few solid things against the walls of a room.
fn furnish(canvas: &mut Canvas, room: &Room, random: &mut Random) {
    let crate_box = ["abbba", "bcdcb", "bdcdb", "bcdcb", "abbba"];
    let barrel = [".bbb.", "bcccb", "bcdcb", "bcccb", ".bbb."];
    let shelf = ["aaaaaaaaaa", "aRGBYRBGRa", "aRGBYRBGRa", "aaaaaaaaaa"];
    let column = [".ss.", "sttS", "stSS", ".SS."];
    let bush = [".gg.", "gHgg", "ggHg", ".gg."];
    let (shape, count): (&[&str], _) = match room.kind {
        Kind::Hall if room.w > 34 && room.h > 28 => (&column, 4),
        Kind::Hall => (&column, 0),
        Kind::Cellar => (if random.below(2) == 0 { &crate_box } else { &barrel }, 3),
        Kind::Garden => (&bush, 3),
        Kind::Library => (&shelf, 3),
        Kind::Pool => (&column, 0),
    };
    let (w, h) = (shape[0].len() as i32, shape.len() as i32);
    for i in 0..count {
        let (x, y) = match room.kind {
            Kind::Hall => (
                if i % 2 == 0 { room.x + 8 } else { room.x + room.w - 8 - w },
                if i < 2 { room.y + 7 } else { room.y + room.h - 7 - h },
            ),
            _ => (
                room.x + 3 + random.below((room.w - w - 6) as usize) as i32,
                room.y + 3 + random.below((room.h - h - 6) as usize) as i32,
            ),
        };
        if is_taken(canvas, x, y, w, h) {
            continue;
        }
        canvas.sprite(x, y, shape, |c| {
            let code = match c {
                'a' => 0x6a4a32,
                'b' => 0x8c6440,
                'c' => 0xac8050,
                'd' => 0xc89c68,
                'R' => 0xb84a44,
                'G' => 0x5a9a5c,
                'B' => 0x4c7cb0,
                'Y' => 0xd8b450,
                's' => 0xb8b0a8,
                't' => 0xdcd4c8,
                'S' => 0x908880,
                'g' => 0x4c7a3c,
                'H' => 0x78a850,
                _ => return None,
            };
            Some(Paint::solid(hex(code)))
        });
    }
}

/// Returns true if something stands in a box.
fn is_taken(canvas: &Canvas, x: i32, y: i32, w: i32, h: i32) -> bool {
    (y..y + h).any(|y| (x..x + w).any(|x| canvas.is_solid(x, y)))
}

fn scene_file(rooms: &[Room], canvas: &Canvas, random: &mut Random) -> String {
    const FIRE: [&str; 3] = ["[1.0, 0.62, 0.26]", "[1.0, 0.74, 0.42]", "[1.0, 0.52, 0.2]"];
    const MAGIC: [&str; 4] =
        ["[0.3, 0.6, 1.0]", "[0.62, 0.36, 1.0]", "[0.3, 1.0, 0.55]", "[1.0, 0.32, 0.5]"];
    let mut text = String::from(HEAD);
    for room in rooms {
        // One room in seven is dark: what light they have comes through doors.
        if random.below(7) == 0 {
            continue;
        }
        let magic = random.below(4) == 0;
        let color = if magic { MAGIC[random.below(4)] } else { FIRE[random.below(3)] };
        let size = [1.5, 2.0, 2.5, 3.0][random.below(4)];
        let spot = (0..40).map(|_| {
            let x = room.x + 6 + random.below((room.w - 12) as usize) as i32;
            let y = room.y + 6 + random.below((room.h - 12) as usize) as i32;
            (x, y)
        });
        let mut clear = spot.filter(|&(x, y)| {
            (-4..=4).all(|dy| (-4..=4).all(|dx| !canvas.is_solid(x + dx, y + dy)))
        });
        let Some((x, y)) = clear.next() else { continue };
        let intensity = (16.0_f32 / size).round();
        write!(
            text,
            "\n[[lamp]]\nposition = [{x}.5, {y}.5]\ncolor = {color}\nintensity = {intensity:.1}\nrange = 64\nsize = {size:.1}\n"
        )
        .expect("text takes any length");
    }
    text
}

const HEAD: &str = r#"# A dungeon: small lamps behind 4-px walls and 8-px doors, where methods that cannot resolve a few
# px are seen to fail. Drawn, lamps included, by `cargo xtask scenes`.
size = [512, 288]

[layers]
opacity = "dungeon/opacity.png"
albedo = "dungeon/albedo.png"
color = "dungeon/color.png"

[light]
bounces = 3
wall_depth = 3
raymarch = { rays = 128 }

[display]
tonemap = "vivid"
exposure = 0.6
"#;
