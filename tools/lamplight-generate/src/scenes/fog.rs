//! A park on a foggy night.

use super::canvas::{Art, Canvas, Color, Layer, Paint, hash, hex, mix, ramp, rough};

const W: i32 = 256;
const H: i32 = 144;
const FOG_ALBEDO: Color = hex(0xfafafa);
const BARK: &[u32] = &[0x4a4048, 0x66585a, 0x8a7768];
const GRASS: &[u32] = &[0x34503c, 0x4c7047, 0x739a58];

pub fn draw() -> Art {
    let mut canvas = Canvas::new(W, H, |x, y| fog(x, y, backdrop(x, y)));
    ground(&mut canvas);
    for (x, width, top) in [(34, 7, 0), (112, 5, 8), (214, 8, 2)] {
        tree(&mut canvas, x, width, top);
    }
    for x in LAMPS {
        post(&mut canvas, x);
    }
    bench(&mut canvas, 128);
    stroller(&mut canvas, 186);
    Art { name: "fog", canvas, layers: &[Layer::Color, Layer::Albedo, Layer::Opacity] }
}

/// Places of the lamp posts; the scene file puts the lamps 5 px under their roofs.
const LAMPS: [i32; 4] = [12, 74, 152, 242];

/// Fog lies thick over the ground and thins out upwards, in banks.
fn fog(x: i32, y: i32, color: Color) -> Paint {
    let (fx, fy) = (x as f32, y as f32);
    let height = ((fy - 16.0) / 104.0).clamp(0.0, 1.0);
    let bank = rough(fx, fy * 2.4, 60.0, 61);
    let thick = 1.0 + height * 2.5 + (bank - 0.35).max(0.0) * 9.0 * height;
    Paint { opacity: thick.round() as u8, albedo: FOG_ALBEDO, ..Paint::open(color) }
}

/// Rows of far trees, each paler than the one before it.
fn backdrop(x: i32, y: i32) -> Color {
    let (fx, fy) = (x as f32, y as f32);
    let mut color = ramp(&[0x5468a0, 0x6880b0, 0x8898bc, 0xa8a8b4], fy / 125.0, x, y);
    for (layer, shade) in [(0, 0x6c7e9c), (1, 0x5a6c8a), (2, 0x4a5c78)] {
        let depth = layer as f32;
        let spacing = 17.0 + depth * 12.0;
        let place = fx + depth * 37.0;
        let trunk = (place / spacing).floor();
        let lean = (hash(trunk as i32, layer, 62) - 0.5) * spacing * 0.5;
        let from_trunk = (place - (trunk + 0.5) * spacing - lean).abs();
        let crown = 50.0 - depth * 10.0 + hash(trunk as i32, layer, 63) * 26.0;
        let leaves = rough(fx, fy, 16.0 + depth * 4.0, 64 + layer as u32);
        let spread = spacing * 0.55 * (1.0 - ((fy - crown) / 30.0).powi(2)).max(0.0).sqrt();
        let in_crown = from_trunk < spread * (0.5 + leaves);
        let in_trunk = from_trunk < 1.0 + depth * 0.7 && fy > crown;
        if in_crown || in_trunk {
            color = hex(shade);
        }
    }
    color
}

fn top_of_ground(x: i32) -> i32 {
    122 + (rough(x as f32, 0.0, 70.0, 66) * 7.0) as i32
}

fn ground(canvas: &mut Canvas) {
    for x in 0..W {
        let top = top_of_ground(x);
        for y in top..H {
            let path = y > top + 3 && y < top + 11;
            let rough = rough(x as f32, y as f32, 6.0, 67);
            let color = if path {
                ramp(
                    &[0x7d7468, 0x9a9080, 0xb8ad98],
                    rough * 1.2 + (hash(x, y, 68) - 0.5) * 0.4,
                    x,
                    y,
                )
            } else {
                ramp(GRASS, rough * 1.3 - (y - top) as f32 * 0.02, x, y)
            };
            canvas.set(x, y, Paint::solid(color));
        }
        if hash(x, 0, 69) < 0.5 {
            canvas.set(x, top - 1, fog(x, top - 1, hex(GRASS[2])));
        }
        // Fallen leaves.
        if hash(x, 1, 69) < 0.12 {
            canvas.set(x, top, Paint::solid(hex(0xc8843c)));
        }
    }
}

fn tree(canvas: &mut Canvas, x: i32, width: i32, top: i32) {
    let foot = top_of_ground(x) + 1;
    for y in 0..foot {
        let flare = ((y - foot + 12).max(0) / 4).pow(2) / 2;
        let half = width / 2 + flare;
        let bend = (rough(0.0, y as f32, 40.0, x as u32) * 8.0) as i32 - 4;
        for dx in -half..=half {
            let tone = 0.5 - dx as f32 / width as f32 * 0.6
                + (rough((x + dx) as f32 * 2.0, y as f32 * 0.4, 4.0, 70) - 0.5);
            canvas.set(x + dx + bend, y, Paint::solid(ramp(BARK, tone, x + dx, y)));
        }
    }
    // Leaves let some light through.
    let (cx, cy) = (x as f32, top as f32 + 14.0);
    for y in 0..56 {
        for dx in -34..=34 {
            let (fx, fy) = ((x + dx) as f32, y as f32);
            let far = ((fx - cx) / 31.0).powi(2) + ((fy - cy) / 25.0).powi(2);
            let leaf = rough(fx, fy, 9.0, 71);
            if far + (0.5 - leaf) * 1.6 < 0.75 && !canvas.is_solid(x + dx, y) {
                let color =
                    ramp(&[0x4c5c42, 0x76803f, 0xb89a48, 0xe0b458], leaf * 1.5 - 0.3, x + dx, y);
                let opacity = 8 + (leaf * 14.0) as u8;
                canvas.set(
                    x + dx,
                    y,
                    Paint { opacity, albedo: mix(color, [255; 3], 0.4), ..Paint::open(color) },
                );
            }
        }
    }
}

fn post(canvas: &mut Canvas, x: i32) {
    let foot = top_of_ground(x);
    let iron = |x, y| fog(x, y, hex(0x3e444e));
    for y in 73..foot {
        canvas.set(x, y, iron(x, y));
    }
    for (dx, y) in [(-1, foot - 1), (1, foot - 1), (-1, foot - 2), (1, foot - 2), (-1, 96), (1, 96)]
    {
        canvas.set(x + dx, y, iron(x + dx, y));
    }
    canvas.sprite(x - 3, 63, &["...i...", "..iii..", ".iiiii."], |c| {
        (c == 'i').then(|| fog(x, 64, hex(0x3e444e)))
    });
    canvas
        .sprite(x - 2, 71, &["i...i", ".iii."], |c| (c == 'i').then(|| fog(x, 72, hex(0x3e444e))));
}

fn bench(canvas: &mut Canvas, x: i32) {
    let y = top_of_ground(x + 8) - 8;
    canvas.sprite(
        x,
        y,
        &[
            "wwwwwwwwwwwwwwww",
            ".i............i.",
            "wwwwwwwwwwwwwwww",
            ".i............i.",
            "wwwwwwwwwwwwwwww",
            "wwwwwwwwwwwwwwww",
            ".i............i.",
            ".i............i.",
            ".i............i.",
        ],
        |c| match c {
            'w' => Some(gauze(hex(0xb8804e))),
            'i' => Some(gauze(hex(0x4a4e58))),
            _ => None,
        },
    );
}

/// Somebody under an umbrella, and a dog.
fn stroller(canvas: &mut Canvas, x: i32) {
    let foot = top_of_ground(x + 6) + 1;
    canvas.sprite(
        x,
        foot - 20,
        &[
            ".....r.......",
            "...rrRrr.....",
            ".rrrRRRrrr...",
            "rrrRRRRRrrr..",
            "r..r.i.r..r..",
            ".....i.......",
            "...hhi.......",
            "...ffi.......",
            "...ffi.......",
            "..ccci.......",
            "..cccc.......",
            "..cccf.......",
            "..ccc..l.....",
            "..ccc...l....",
            "..ccc....l.dd",
            "..ccc.....ddd",
            "..p.p.d.dddd.",
            "..p.p.ddddd..",
            "..p.p.d...d..",
            "..k.k.d...d..",
        ],
        |c| {
            let code = match c {
                'r' => 0xd8434e,
                'R' => 0xf0727a,
                'i' => 0x5a5a66,
                'h' => 0x5a3826,
                'f' => 0xe8b890,
                'c' => 0xd8b04c,
                'l' => 0x8a6a5a,
                'd' => 0xa87850,
                'p' => 0x4c5a80,
                'k' => 0x3a3038,
                _ => return None,
            };
            Some(gauze(hex(code)))
        },
    );
}

/// Thin enough that light gets behind it: small things keep their colours.
fn gauze(color: Color) -> Paint {
    Paint { opacity: 36, albedo: color, ..Paint::open(color) }
}
