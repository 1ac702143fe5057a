//! A cave: crystals, mushrooms and a lava pool, under a shaft that lets the evening in.

use super::canvas::{Art, Canvas, Color, Layer, Paint, hash, hex, mix, ramp, rough};

const W: i32 = 320;
const H: i32 = 180;

const ROCK: &[u32] = &[0x2e2a3c, 0x433d52, 0x5f5668, 0x80737c, 0xa79891];
const BACK: &[u32] = &[0x3c3a55, 0x4d4b69, 0x62607f, 0x7d7b97];
const MOSS: &[u32] = &[0x3c5a3a, 0x5c8347, 0x8fb35a];
const WOOD: &[u32] = &[0x5a3d2b, 0x7d5738, 0xa77a4a];
/// Albedo of rock.
const ROCK_ALBEDO: Color = hex(0xb0a8a4);

pub fn draw() -> Art {
    let mut canvas = Canvas::new(W, H, |x, y| {
        if is_rock(x, y) { Paint::solid(hex(ROCK[1])) } else { Paint::open(backdrop(x, y)) }
    });
    texture_rock(&mut canvas);
    grow_moss(&mut canvas);
    lava(&mut canvas);
    water(&mut canvas);
    bridge(&mut canvas);
    crystals(&mut canvas);
    mushrooms(&mut canvas);
    lanterns(&mut canvas);
    explorer(&mut canvas);
    Art {
        name: "cave",
        canvas,
        layers: &[Layer::Color, Layer::Albedo, Layer::Emission, Layer::Opacity, Layer::Tint],
    }
}

/// Caverns are ellipses with ragged edges and a floor; spikes and ledges stand in them.
fn is_rock(x: i32, y: i32) -> bool {
    let (fx, fy) = (x as f32 + 0.5, y as f32 + 0.5);
    let ragged = (rough(fx, fy, 26.0, 1) - 0.5) * 0.8;
    let inside = |cx: f32, cy: f32, rx: f32, ry: f32| {
        ((fx - cx) / rx).powi(2) + ((fy - cy) / ry).powi(2) + ragged < 1.0
    };
    let shaft = (fx - 214.0 - (fy * 0.12).sin() * 5.0 + ragged * 14.0).abs() < 14.0 && fy < 70.0;
    let open = inside(112.0, 84.0, 108.0, 70.0)
        || inside(40.0, 118.0, 44.0, 38.0)
        || inside(226.0, 96.0, 80.0, 62.0)
        || inside(274.0, 140.0, 48.0, 42.0)
        || shaft;
    let ledge = inside(10.0, 86.0, 34.0, 7.0)
        || inside(304.0, 76.0, 44.0, 8.0)
        || inside(208.0, 112.0, 15.0, 5.0);
    let pillar = (fx - 130.0 + ragged * 12.0).abs() < 5.0 + ((fy - 84.0) / 16.0).powi(2);
    !open || ledge || pillar && fy < 60.0 || spike(fx, fy) || fy > floor(fx)
}

/// Stalactites and stalagmites: (x, end, half width, length), hanging where the length is positive.
fn spike(x: f32, y: f32) -> bool {
    const SPIKES: [(f32, f32, f32, f32); 11] = [
        (62.0, 52.0, 6.0, 34.0),
        (71.0, 40.0, 4.0, 24.0),
        (92.0, 34.0, 4.0, 22.0),
        (154.0, 42.0, 5.0, 28.0),
        (184.0, 58.0, 7.0, 36.0),
        (193.0, 46.0, 4.0, 22.0),
        (244.0, 62.0, 6.0, 32.0),
        (289.0, 96.0, 4.0, 20.0),
        (118.0, 122.0, 5.0, -24.0),
        (176.0, 116.0, 6.0, -28.0),
        (12.0, 118.0, 4.0, -20.0),
    ];
    SPIKES.iter().any(|&(at, end, half, length)| {
        let share = (end - y) / length;
        let wobble = (rough(x, y, 5.0, 2) - 0.5) * 2.5;
        share > 0.0 && share < 1.3 && (x - at + wobble).abs() < half * share.powf(1.3)
    })
}

fn floor(x: f32) -> f32 {
    let steps = (rough(x, 0.5, 40.0, 9) * 4.0).floor() * 3.0;
    let pit = if (232.0..306.0).contains(&x) { 30.0 } else { 0.0 };
    let basin = (14.0 - ((x - 88.0) / 7.5).powi(2)).max(0.0);
    134.0 + steps + rough(x, 3.5, 9.0, 5) * 4.0 + pit + basin
}

fn backdrop(x: i32, y: i32) -> Color {
    let (fx, fy) = (x as f32, y as f32);
    let strata = rough(fx, fy * 2.2 + rough(fx, fy, 50.0, 3) * 30.0, 34.0, 4);
    let cracks = (rough(fx, fy, 22.0, 6) - 0.5).abs();
    let tone = strata * 1.25 - 0.05 - if cracks < 0.012 { 0.35 } else { 0.0 };
    ramp(BACK, tone, x, y)
}

fn texture_rock(canvas: &mut Canvas) {
    let depth = canvas.distance(|p| p.opacity == 0);
    canvas.repaint(|x, y, paint| {
        if paint.opacity == 0 {
            return paint;
        }
        let (fx, fy) = (x as f32, y as f32);
        let deep = depth[(y * W + x) as usize];
        // Facets: noise lit from above, with a bright rim where rock meets air.
        let slope = rough(fx, fy + 1.5, 11.0, 7) - rough(fx, fy - 1.5, 11.0, 7);
        let rim = (2.6 - deep).max(0.0) * 0.16;
        let tone = 0.5 + slope * 1.7 + rim + (hash(x, y, 8) - 0.5) * 0.08;
        Paint::solid(ramp(ROCK, tone, x, y)).albedo(ROCK_ALBEDO)
    });
}

/// Moss on ledges, vines under them.
fn grow_moss(canvas: &mut Canvas) {
    for y in 1..H {
        for x in 0..W {
            let patch = rough(x as f32, y as f32, 30.0, 12);
            let ledge = canvas.is_solid(x, y) && !canvas.is_solid(x, y - 1);
            if ledge && patch > 0.42 {
                let green = |v: f32| Paint::solid(ramp(MOSS, v, x, y));
                canvas.set(x, y, green(0.9));
                canvas.set(x, y + 1, green(0.5));
                if hash(x, y, 13) < 0.45 {
                    canvas.set(x, y + 2, green(0.2));
                }
                let blade = hash(x, y, 14);
                if blade < 0.35 {
                    canvas.set(x, y - 1, Paint::open(hex(MOSS[2])));
                    if blade < 0.1 {
                        canvas.set(x, y - 2, Paint::open(hex(MOSS[1])));
                    }
                }
            }
            let ceiling = !canvas.is_solid(x, y) && canvas.is_solid(x, y - 1) && y < 90;
            if ceiling && hash(x, 0, 15) < 0.07 {
                for i in 0..(4.0 + hash(x, 1, 15) * 15.0) as i32 {
                    let leaf = hash(x, i, 16) < 0.35;
                    let green = hex(MOSS[if leaf { 2 } else { 1 }]);
                    canvas.set(x, y + i, Paint::open(green));
                    if leaf {
                        canvas.set(x + 1 - 2 * (i % 2), y + i, Paint::open(hex(MOSS[0])));
                    }
                }
            }
        }
    }
}

fn lava(canvas: &mut Canvas) {
    const TOP: i32 = 158;
    canvas.repaint(|x, y, paint| {
        let wave = ((x as f32 * 0.21).sin() * 1.4) as i32;
        if paint.opacity != 0 || y < TOP + wave || x < 222 {
            return paint;
        }
        let flow = rough(x as f32, y as f32 * 2.0, 14.0, 20);
        let heat = if y < TOP + wave + 2 { 0.95 } else { (flow - 0.3) * 1.8 };
        let glow = ramp(&[0x4a1206, 0x9a2a08, 0xe0560c, 0xffa828], heat, x, y);
        Paint::solid(mix(glow, [255; 3], 0.2)).glow(glow).albedo([40, 16, 8])
    });
}

/// A pool: light sinks into it, red first.
fn water(canvas: &mut Canvas) {
    canvas.repaint(|x, y, paint| {
        if paint.opacity != 0 || y < 143 || !(60..118).contains(&x) {
            return paint;
        }
        let surface = y < 144;
        let color = if surface {
            hex(0xbfe6ee)
        } else {
            ramp(&[0x4f8fa0, 0x67a9b4], rough(x as f32, y as f32 * 4.0, 12.0, 30), x, y)
        };
        Paint { opacity: 6, tint: [222, 244, 250], albedo: hex(0x9fd0e0), ..Paint::open(color) }
    });
}

fn bridge(canvas: &mut Canvas) {
    for x in 226..312 {
        let sag = ((x - 266) * (x - 266)) / 420;
        let y = 138 + 3 - sag;
        if canvas.is_solid(x, y) {
            continue;
        }
        let plank = x % 5;
        let tone = [0.9, 0.6, 0.7, 0.5][plank.min(3) as usize];
        if plank < 4 {
            canvas.set(x, y, Paint::solid(ramp(WOOD, tone, x, y)));
            canvas.set(x, y + 1, Paint::solid(ramp(WOOD, tone - 0.4, x, y)));
        }
        canvas.set(x, y - 7, Paint::open(hex(WOOD[1])));
        if plank == 0 {
            (1..7).for_each(|i| canvas.set(x, y - i, Paint::open(hex(WOOD[0]))));
        }
    }
}

/// A shard from its foot along (dx, dy): a light and a dark facet, an edge between them.
fn shard(canvas: &mut Canvas, foot: (f32, f32), tip: (f32, f32), width: f32, colors: [u32; 3]) {
    let (x, y) = foot;
    let (dx, dy) = tip;
    let length = (dx * dx + dy * dy).sqrt();
    let (nx, ny) = (-dy / length * width, dx / length * width);
    let (sx, sy) = (x + dx * 0.72, y + dy * 0.72);
    let [dark, light, edge] = colors.map(|c| Paint::solid(hex(c)).glow(hex(c)));
    let end = (x + dx, y + dy);
    canvas.polygon(&[(x - nx * 0.7, y - ny * 0.7), (sx - nx, sy - ny), end, (x, y)], |_, _| light);
    canvas.polygon(&[(x + nx * 0.7, y + ny * 0.7), (sx + nx, sy + ny), end, (x, y)], |_, _| dark);
    canvas.line((x as i32, y as i32), (end.0 as i32, end.1 as i32), edge);
}

const CYAN: [u32; 3] = [0x1474a8, 0x2fb4dc, 0x9cecff];
const VIOLET: [u32; 3] = [0x5f22b8, 0x9c4fec, 0xdcaeff];
const ROSE: [u32; 3] = [0xa81c62, 0xec4f96, 0xffb4d6];

fn crystals(canvas: &mut Canvas) {
    for (x, y, tips, colors) in [
        (32.0, 145.0, [(-11.0, -19.0), (-2.0, -33.0), (9.0, -18.0), (15.0, -8.0)], CYAN),
        (152.0, 145.0, [(-9.0, -12.0), (-3.0, -26.0), (8.0, -30.0), (14.0, -12.0)], VIOLET),
        (107.0, 17.0, [(-9.0, 9.0), (-3.0, 24.0), (7.0, 17.0), (12.0, 8.0)], ROSE),
        (0.0, 92.0, [(12.0, -14.0), (20.0, -6.0), (9.0, -20.0), (4.0, -12.0)], CYAN),
        (281.0, 71.0, [(-9.0, -8.0), (-3.0, -17.0), (5.0, -13.0), (10.0, -5.0)], ROSE),
    ] {
        for (i, &(dx, dy)) in tips.iter().enumerate() {
            let foot = (x + (i as f32 - 1.5) * 2.5, y);
            shard(canvas, foot, (dx, dy), 2.4 + (i % 2) as f32 * 0.9, colors);
        }
    }
}

fn mushrooms(canvas: &mut Canvas) {
    const BIG: [&str; 9] = [
        "...ccccc...",
        ".ccclcccdc.",
        "ccclccccddc",
        "clccccccccd",
        ".ugugugugu.",
        "....sst....",
        "....sst....",
        "....sst....",
        "...ssstt...",
    ];
    const SMALL: [&str; 5] = [".ccc.", "clccd", "ugugu", "..s..", "..s.."];
    let paint = |c: char| {
        let cap = hex(0x2fae8a);
        Some(match c {
            'c' => Paint::solid(hex(0x4fc9a2)).glow(cap),
            'l' => Paint::solid(hex(0xc6ffe4)).glow(hex(0x7df0c4)),
            'd' => Paint::solid(hex(0x2f8f7c)).glow(hex(0x1f7a62)),
            'u' => Paint::solid(hex(0xd9f7df)).glow(hex(0x9ef5c8)),
            'g' => Paint::solid(hex(0x9fdcb8)).glow(hex(0x55c79a)),
            's' => Paint::solid(hex(0xd8cfae)),
            't' => Paint::solid(hex(0xa89c7e)),
            _ => return None,
        })
    };
    for (x, rows) in [
        (47, &BIG[..]),
        (61, &SMALL),
        (128, &SMALL),
        (190, &BIG),
        (204, &SMALL),
        (138, &SMALL),
        (18, &SMALL),
    ] {
        let middle = x + rows[0].len() as i32 / 2;
        let ground = (125..H).find(|&y| canvas.is_solid(middle, y)).unwrap_or(H);
        canvas.sprite(x, ground - rows.len() as i32, rows, paint);
    }
}

/// Lanterns on chains; their flames are `[[lamp]]`s in the scene file.
fn lanterns(canvas: &mut Canvas) {
    for (x, bottom) in [(76, 82), (168, 72), (266, 98)] {
        let mut y = bottom;
        while y > 0 && !canvas.is_solid(x, y) {
            let link = if y % 3 == 0 { 0x8a7f86 } else { 0x5c5562 };
            canvas.set(x, y, Paint::open(hex(link)));
            y -= 1;
        }
        canvas.sprite(
            x - 3,
            bottom,
            &["..iii..", ".i...i.", "i.....i", "i.....i", "i.....i", ".i...i.", "..iii.."],
            |c| (c == 'i').then(|| Paint::open(hex(0x77685a))),
        );
    }
}

fn explorer(canvas: &mut Canvas) {
    const ROWS: [&str; 12] = [
        "..yyy...", ".yyyyy..", "..fff...", "..fff...", ".bbbbb..", "bbbbbbaa", "b.bbb..a",
        "..bbb...", "..ppp...", "..p.p...", "..p.p...", ".kk.kk..",
    ];
    let ground = (120..H).find(|&y| canvas.is_solid(218, y)).unwrap_or(H);
    canvas.sprite(214, ground - 12, &ROWS, |c| {
        let color = match c {
            'y' => 0xe8c24a,
            'f' => 0xe6b48c,
            'b' => 0xb5483c,
            'a' => 0xd98f6a,
            'p' => 0x4b5a86,
            'k' => 0x4a352a,
            _ => return None,
        };
        Some(Paint::open(hex(color)))
    });
}
