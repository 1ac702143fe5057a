//! The room of the bodies on a layout of 320×180: walls, ledges, backdrop, and the bodies.

use crate::figure::Figure;
use crate::paint::{Paint, hex, mix, scale};
use crate::random::Random;
use crate::texture::{cloud, hash};
use lamplight::srgb::luminance;
use lamplight::{Cells, Gradient, Rgb, Sky};

/// Columns and rows of the layout.
pub(super) const LAYOUT: [f32; 2] = [320.0, 180.0];
/// Thickness of walls, layout px.
pub(super) const WALL: f32 = 7.0;
/// Ledges: centre, half size, angle.
pub(super) const LEDGES: [([f32; 2], [f32; 2], f32); 4] = [
    ([52.0, 92.0], [40.0, 3.0], 0.10),
    ([262.0, 80.0], [46.0, 3.0], -0.12),
    ([160.0, 128.0], [34.0, 3.0], 0.0),
    ([27.0, 146.0], [18.0, 3.0], 0.25),
];
/// Lanterns: hook, length of the chain, colour.
pub(super) const LANTERNS: [([f32; 2], f32, u32); 3] =
    [([92.0, 7.0], 34.0, 0xffb45a), ([164.0, 7.0], 52.0, 0xff7a90), ([238.0, 7.0], 26.0, 0x6ac8ff)];
/// The paddle: centre, half length of its arms.
pub(super) const PADDLE: ([f32; 2], f32) = ([262.0, 146.0], 24.0);

/// Thickness of the glass around glowing bodies, px.
const SHELL: f32 = 1.8;
/// Panes in the ceiling: left and right end.
const SKYLIGHTS: [[f32; 2]; 3] = [[24.0, 70.0], [112.0, 148.0], [196.0, 222.0]];

/// The material of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum BodyMaterial {
    /// Painted wood.
    Wood(Rgb),
    /// A light in a shell of coloured glass.
    Glow(Rgb),
    /// Coloured glass.
    Glass(Rgb),
}

impl BodyMaterial {
    /// The paint at a point in the body's own frame, at a depth inside it. Both are in cells; `unit` is cells
    /// per layout px.
    pub(super) fn paint(self, local: [f32; 2], deep: f32, unit: f32) -> Paint {
        self.layout_paint(local.map(|v| v / unit), deep / unit).at_scale(unit)
    }

    fn layout_paint(self, [x, y]: [f32; 2], deep: f32) -> Paint {
        match self {
            Self::Wood(color) => {
                let grain = 0.8 + 0.2 * hash(y.floor() as i32, (x / 5.0).floor() as i32, 3);
                let edge = if deep < 1.3 { 0.6 } else { 1.0 };
                // Not fully opaque, so that light penetrates and no side of a crate is black.
                Paint::fog(0.2, scale(color, grain * edge))
            }
            Self::Glow(radiance) => {
                // A bright core in a shell of coloured glass.
                if deep > SHELL {
                    return Paint::glow(mix(radiance, [luminance(radiance); 3], 0.35));
                }
                let brightest = radiance.into_iter().fold(1e-3, f32::max);
                let hue = scale(radiance, 1.0 / brightest);
                let mut shell = Paint::fog(0.2, hue).glowing(scale(hue, 2.2));
                shell.matter.tint = mix([1.0; 3], hue, 0.25);
                shell
            }
            Self::Glass(tint) => {
                let rim = if deep < 1.2 { 0.7 } else { 1.0 };
                Paint::glass(tint).colored(scale(mix(tint, [1.0; 3], 0.25), rim))
            }
        }
    }
}

/// A body before it is added to the room.
pub(super) struct Actor {
    pub at: [f32; 2],
    pub figure: Figure,
    pub stuff: BodyMaterial,
}

/// All loose bodies, in layout px.
pub(super) fn actors(random: &mut Random) -> Vec<Actor> {
    let mut actors = Vec::new();
    let mut put = |at: [f32; 2], figure, stuff| actors.push(Actor { at, figure, stuff });
    let wood = [0xd97b4a, 0xe0b15a, 0x5fa3a8, 0xb8596b, 0x8c7bc4, 0xd8cbb0].map(hex);
    for (i, &color) in wood.iter().enumerate() {
        let half = random.range(6.0, 9.5);
        let x = 26.0 + 50.0 * i as f32 + random.range(-8.0, 8.0);
        let high = random.range(0.8, 1.2) * half;
        put([x, random.range(20.0, 60.0)], Figure::Box([half, high]), BodyMaterial::Wood(color));
    }
    for (x, y, length, color) in [
        (60.0, 70.0, 26.0, 0xb98a5a),
        (150.0, 112.0, 34.0, 0xa8743f),
        (280.0, 60.0, 22.0, 0xc29a6a),
    ] {
        put([x, y], Figure::Box([length, 2.5]), BodyMaterial::Wood(hex(color)));
    }
    for (x, y, radius, color, bright) in [
        (38.0, 60.0, 5.0, 0xffa040, 5.0),
        (120.0, 30.0, 4.0, 0x40d8ff, 5.0),
        (190.0, 90.0, 5.5, 0xff6078, 4.5),
        (220.0, 40.0, 3.5, 0xffd070, 5.0),
        (300.0, 40.0, 4.5, 0xa880ff, 5.0),
        (90.0, 140.0, 4.0, 0x70ffb0, 4.0),
    ] {
        put([x, y], Figure::Ball(radius), BodyMaterial::Glow(scale(hex(color), bright)));
    }
    for (x, y, half, color) in [
        (140.0, 40.0, [3.0, 15.0], 0xffa8a0),
        (210.0, 110.0, [12.0, 4.0], 0xa0c8ff),
        (70.0, 150.0, [4.0, 13.0], 0xa8ffd0),
        (296.0, 60.0, [8.0, 8.0], 0xffe0a0),
    ] {
        put([x, y], Figure::Box(half), BodyMaterial::Glass(mix([1.0; 3], hex(color), 0.35)));
    }
    for (x, y, radius, color) in [(104.0, 60.0, 7.0, 0xcfd4dc), (250.0, 50.0, 8.0, 0x7c8cb0)] {
        put([x, y], Figure::Ball(radius), BodyMaterial::Wood(hex(color)));
    }
    actors
}

/// Draws everything static: backdrop, walls, ledges.
pub(super) fn backdrop(cells: &mut Cells, seed: u32) {
    let size = [cells.width() as f32, cells.height() as f32];
    let by = [size[0] / LAYOUT[0], size[1] / LAYOUT[1]];
    for cy in 0..cells.height() as i32 {
        for cx in 0..cells.width() as i32 {
            let (x, y) = ((cx as f32 + 0.5) / by[0], (cy as f32 + 0.5) / by[1]);
            let inside = (x.min(LAYOUT[0] - x)).min(y.min(LAYOUT[1] - y)) > WALL;
            let pane = y < WALL && SKYLIGHTS.iter().any(|p| (p[0]..p[1]).contains(&x));
            let paint = match (inside, pane) {
                (true, _) => Paint::open(panel(x, y, seed)),
                (_, true) => Paint::glass([0.97, 0.99, 1.0]).colored(hex(0x6a86a8)).at_scale(by[1]),
                _ => brick(x, y, seed),
            };
            paint.put(cells, (cy as u32 * cells.width() + cx as u32) as usize);
        }
    }
    cells.set_sky(Sky::Gradient(Gradient {
        zenith: [1.5, 1.9, 2.8],
        horizon: [0.5, 0.7, 1.2],
        ground: [0.0; 3],
    }));
    for (at, half, angle) in LEDGES {
        let unit = by[0].min(by[1]);
        let figure = Figure::Box(half.map(|v| v * unit));
        let stuff = BodyMaterial::Wood(hex(0x9c8fa0));
        figure.draw(cells, [at[0] * by[0], at[1] * by[1]], angle, |local, deep| {
            stuff.paint(local, deep, unit)
        });
    }
}

/// Wooden panels, dark enough for colours to stand out.
fn panel(x: f32, y: f32, seed: u32) -> Rgb {
    let (column, within) = ((x / 26.0).floor(), (x / 26.0).fract());
    let base = mix(hex(0x8f8a9c), hex(0xa0929a), hash(column as i32, 1, seed));
    let grain = 0.62 + 0.45 * cloud(x / 3.0, y / 40.0, seed);
    let seam = if within < 0.05 { 0.55 } else { 1.0 };
    let rail = if (y - 118.0).abs() < 1.6 { 1.35 } else { 1.0 };
    let lower = if y > 119.6 { 0.9 } else { 1.0 };
    scale(base, (grain * seam * rail * lower).min(1.2)).map(|v| v.min(1.0))
}

fn brick(x: f32, y: f32, seed: u32) -> Paint {
    let row = (y / 4.0).floor();
    let shifted = x + if row as i32 % 2 == 0 { 0.0 } else { 5.0 };
    let mortar = (y / 4.0).fract() < 0.2 || (shifted / 10.0).fract() < 0.1;
    let tone = 0.75 + 0.35 * hash((shifted / 10.0).floor() as i32, row as i32, seed);
    Paint::wall(scale(if mortar { hex(0x5c5560) } else { hex(0x9a7a78) }, tone.min(1.0)))
}
