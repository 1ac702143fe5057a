//! Open country at sunset: hills, a lake, trees, a camp with a fire.

use super::canvas::{Art, Canvas, Color, Layer, Paint, hash, hex, mix, ramp, rough};

const W: i32 = 320;
const H: i32 = 180;
/// The lake lies between these columns, its surface at this row.
const LAKE: std::ops::Range<i32> = 26..118;
const SURFACE: i32 = 154;

const GRASS: &[u32] = &[0x4a6638, 0x6a8a3e, 0x94ab4c, 0xc0c462];
const SOIL: &[u32] = &[0x5a4438, 0x745846, 0x8e6e54];
const BARK: &[u32] = &[0x5a4034, 0x7c5a40, 0x9c7850];
const LEAVES: &[u32] = &[0x3c5c38, 0x55793c, 0x7d9a46, 0xb0b452];
const FIR: &[u32] = &[0x2c4c40, 0x3f6648, 0x5c8250];

pub fn draw() -> Art {
    let mut canvas = Canvas::new(W, H, |x, y| {
        if y > ground(x) { Paint::solid(soil(x, y)) } else { Paint::open(view(x, y)) }
    });
    lake(&mut canvas);
    grass(&mut canvas);
    for (x, size) in [(138, 30), (151, 22), (283, 38), (302, 30), (314, 22), (8, 26)] {
        fir(&mut canvas, x, size);
    }
    for (x, height, crown) in [(187, 44, 21.0), (20, 34, 15.0)] {
        broadleaf(&mut canvas, x, height, crown);
    }
    tent(&mut canvas, 252);
    camp(&mut canvas, 222);
    Art {
        name: "landscape",
        canvas,
        layers: &[Layer::Color, Layer::Albedo, Layer::Emission, Layer::Opacity, Layer::Tint],
    }
}

fn ground(x: i32) -> i32 {
    let fx = x as f32;
    let hills = 144.0 + 7.0 * (fx * 0.021 + 0.6).cos() + rough(fx, 0.0, 60.0, 91) * 14.0;
    let flat = 159.0;
    // Level ground for the camp.
    let camp = (1.0 - ((fx - 232.0) / 52.0).powi(2)).max(0.0).sqrt();
    let bowl = (1.0 - ((fx - 72.0) / 48.0).powi(2)).max(0.0).sqrt() * 34.0;
    (hills + (flat - hills) * camp + bowl) as i32
}

/// Sky, sun, clouds and far hills.
fn view(x: i32, y: i32) -> Color {
    let (fx, fy) = (x as f32, y as f32);
    let ridge = |base: f32, height: f32, size: f32, seed: u32| {
        base - (rough(fx, seed as f32 * 9.0, size, seed) - 0.3) * height
    };
    if fy > ridge(142.0, 26.0, 46.0, 92) {
        return ramp(&[0x5c6a6c, 0x6c7a70, 0x84907a], rough(fx, fy, 8.0, 93), x, y);
    }
    if fy > ridge(130.0, 52.0, 70.0, 94) {
        return ramp(&[0x7c7894, 0x8c86a0], rough(fx, fy, 12.0, 95), x, y);
    }
    let peak = 108.0
        - (1.0 - ((fx - 96.0) / 74.0).abs()).max(0.0) * 52.0
        - (1.0 - ((fx - 236.0) / 60.0).abs()).max(0.0) * 36.0
        - (rough(fx, 3.0, 18.0, 96) - 0.5) * 16.0;
    if fy > peak {
        let snow = fy < 66.0 + rough(fx, fy * 0.6, 9.0, 97) * 18.0;
        return if snow {
            hex(0xf6dcd8)
        } else {
            ramp(&[0x9a8cae, 0xac9cb6], rough(fx, fy, 14.0, 98), x, y)
        };
    }
    let sky = ramp(&[0x6478b8, 0x8088c0, 0xa89ac4, 0xd8a8b4, 0xf6bc9c, 0xffd6a0], fy / 112.0, x, y);
    let cloud = rough(fx, fy * 4.5, 64.0, 99);
    let shine = cloud + (fy - 60.0) * 0.001;
    let sun = ((fx - 164.0).powi(2) + (fy - 96.0).powi(2)).sqrt();
    if sun < 9.0 {
        return hex(0xfff6d0);
    }
    let sky = if sun < 13.0 { mix(sky, hex(0xffe8b0), 0.6) } else { sky };
    if shine > 0.66 {
        mix(sky, hex(0xffe4d4), 0.75)
    } else if shine > 0.59 {
        mix(sky, hex(0xf8cfc4), 0.5)
    } else {
        sky
    }
}

fn soil(x: i32, y: i32) -> Color {
    let stone = rough(x as f32, y as f32, 7.0, 100) > 0.66;
    if stone { hex(0xa09488) } else { ramp(SOIL, rough(x as f32, y as f32, 10.0, 101) * 1.3, x, y) }
}

fn lake(canvas: &mut Canvas) {
    canvas.repaint(|x, y, paint| {
        if paint.opacity != 0 || y < SURFACE || !LAKE.contains(&x) {
            return paint;
        }
        // What stands above, upside down and torn by ripples.
        let ripple = ((rough(x as f32 * 0.6, y as f32 * 3.0, 8.0, 102) - 0.5) * 7.0) as i32;
        let mirrored = view(x + ripple, 2 * SURFACE - y - 24);
        let glint = y == SURFACE || rough(x as f32, y as f32 * 5.0, 20.0, 103) > 0.66;
        let color = mix(mirrored, if glint { hex(0xffe8d0) } else { hex(0x6c98b4) }, 0.4);
        Paint { opacity: 3, tint: [246, 252, 254], albedo: hex(0xb0dce8), ..Paint::open(color) }
    });
}

fn grass(canvas: &mut Canvas) {
    for x in 0..W {
        let top = ground(x) + 1;
        let under_water = LAKE.contains(&x) && top > SURFACE;
        for i in 0..4 {
            let tone = 0.85 - i as f32 * 0.25 + (hash(x, i, 104) - 0.5) * 0.3;
            let color = if under_water { hex(0xc8b088) } else { ramp(GRASS, tone, x, top + i) };
            if i < 2 || hash(x, i, 105) < 0.6 {
                canvas.set(x, top + i, Paint::solid(color));
            }
        }
        if !under_water && hash(x, 0, 106) < 0.4 {
            let flower = hash(x, 1, 106);
            let color = match flower {
                f if f < 0.08 => hex(0xfff0f0),
                f if f < 0.14 => hex(0xf8a0b8),
                _ => hex(GRASS[3]),
            };
            canvas.set(x, top - 1, Paint::open(color));
        }
    }
    // Reeds.
    for x in (28..42).chain(104..116) {
        if hash(x, 2, 106) < 0.5 {
            let height = 4 + (hash(x, 3, 106) * 6.0) as i32;
            for i in 0..height {
                canvas.set(
                    x,
                    SURFACE + 2 - i,
                    Paint::open(hex(if i > height - 3 { 0x8a6238 } else { 0x7c9448 })),
                );
            }
        }
    }
}

/// Leaves let some light through.
fn leaf(color: Color) -> Paint {
    Paint { opacity: 22, ..Paint::open(color) }.albedo(mix(color, [255; 3], 0.3))
}

fn fir(canvas: &mut Canvas, x: i32, size: i32) {
    let foot = ground(x) + 1;
    canvas.rect(x - 1, foot - 5, 2, 5, Paint::solid(hex(BARK[1])));
    for i in 0..size {
        let y = foot - 4 - size + i;
        let tier = i % 7;
        let half = (i - tier / 2) * 10 / 30 + tier / 2;
        for dx in -half..=half {
            let tone = 0.55 - dx as f32 / (half as f32 + 1.0) * 0.4 - f32::from(tier == 0) * 0.3
                + (hash(x + dx, y, 107) - 0.5) * 0.3;
            canvas.set(x + dx, y, leaf(ramp(FIR, tone, x + dx, y)));
        }
    }
}

fn broadleaf(canvas: &mut Canvas, x: i32, height: i32, crown: f32) {
    let foot = ground(x) + 2;
    for i in 0..height {
        let half = if i < 4 { 3 - i / 2 } else { 1 };
        for dx in -half..=half {
            canvas.set(
                x + dx,
                foot - i,
                Paint::solid(ramp(BARK, 0.6 - dx as f32 * 0.25, x + dx, i)),
            );
        }
    }
    let (cx, cy) = (x as f32, (foot - height) as f32);
    for y in 0..H {
        for px in x - 40..x + 40 {
            let (fx, fy) = (px as f32, y as f32);
            let far = ((fx - cx) / crown).powi(2) + ((fy - cy) / (crown * 0.72)).powi(2);
            let clump = rough(fx, fy, 9.0, 108);
            if far + (0.5 - clump) * 0.9 < 0.9 {
                let tone = 0.55 - (fy - cy) / crown * 0.35 + (clump - 0.5) * 1.1;
                canvas.set(px, y, leaf(ramp(LEAVES, tone, px, y)));
            }
        }
    }
}

fn tent(canvas: &mut Canvas, x: i32) {
    let foot = ground(x) + 1;
    for i in 0..20 {
        let half = i * 3 / 4;
        let y = foot - 20 + i;
        for dx in -half..=half {
            let door = dx.abs() < i / 4 && i > 4;
            let seam = dx == -i / 4 || dx == i / 4;
            let paint = if door {
                Paint::open(hex(0x6a4a3a))
            } else if dx.abs() >= half || seam {
                Paint { opacity: 60, ..Paint::open(hex(0xd07848)) }.albedo(hex(0xd07848))
            } else {
                // Canvas glows through.
                Paint { opacity: 16, tint: [255, 238, 210], ..Paint::open(hex(0xe88a4c)) }
                    .albedo(hex(0xe8a070))
            };
            canvas.set(x + dx, y, paint);
        }
    }
}

/// A fire, logs to sit on, somebody with a guitar.
fn camp(canvas: &mut Canvas, x: i32) {
    let foot = ground(x) + 1;
    let rows = [
        "....y......",
        "...yy...y..",
        "...yoy.....",
        "..yoooy....",
        "..yowoo.y..",
        ".oowwwoo...",
        ".oowwwwo...",
        "..rowwor...",
        "bb.rrrr.bb.",
        ".bbbbbbbb..",
        "ssbbssbbsss",
    ];
    canvas.sprite(x - 5, foot - 11, &rows, |c| {
        let flame = |color, glow| Paint { opacity: 150, ..Paint::open(hex(color)) }.glow(hex(glow));
        Some(match c {
            'y' => flame(0xffb040, 0xd86a10),
            'o' => flame(0xffc860, 0xf08a20),
            'w' => flame(0xfff4c0, 0xffc050),
            'r' => flame(0xf06030, 0xc03a08),
            'b' => Paint::solid(hex(0x6a4630)),
            's' => Paint::solid(hex(0x9a948c)),
            _ => return None,
        })
    });
    let friend = [
        "..hhh...", "..hff...", "..fff...", ".ccccgg.", ".cccgGg.", "nncfgGg.", ".ccccgg.",
        ".ppppp..", "..pp.pp.", "lllllpp.", "lLlllkk.",
    ];
    let foot = ground(x - 20) + 1;
    canvas.sprite(x - 24, foot - 11, &friend, |c| {
        let code = match c {
            'h' => 0x6a4028,
            'f' => 0xecb890,
            'c' => 0x4a80a8,
            'g' => 0xc88a48,
            'G' => 0x7a4a28,
            'n' => 0x9a6a40,
            'p' => 0x5a5878,
            'k' => 0x4a3830,
            'l' => 0x8a6040,
            'L' => 0xc8a070,
            _ => return None,
        };
        Some(Paint { opacity: 40, ..Paint::open(hex(code)) }.albedo(hex(code)))
    });
}
