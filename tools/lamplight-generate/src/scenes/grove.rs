//! A grove from above: tree tops, stones and glowing fruit, all of them discs.

use super::canvas::{Art, Canvas, Color, Layer, Paint, hash, hex, ramp, rough};
use crate::random::Random;
use std::fmt::Write;

const W: i32 = 250;
const H: i32 = 141;
const DISCS: usize = 130;
/// px that are free between two discs.
const GAP: f32 = 1.5;

/// Colour and emission (linear RGB) of what glows.
const GLOW: [[f32; 3]; 5] =
    [[1.0, 0.62, 0.2], [0.25, 0.9, 0.6], [0.95, 0.3, 0.55], [0.3, 0.55, 1.0], [1.0, 0.85, 0.45]];
/// Linear albedo of what does not.
const LEAF: [[f32; 3]; 4] =
    [[0.2, 0.55, 0.12], [0.45, 0.7, 0.15], [0.8, 0.45, 0.1], [0.6, 0.58, 0.55]];

/// The art, and the scene file with its discs.
pub fn draw() -> (Art, String) {
    let canvas = Canvas::new(W, H, |x, y| Paint::open(meadow(x, y)));
    (Art { name: "grove", canvas, layers: &[Layer::Color] }, scene_file())
}

/// The course of a path.
fn path(x: f32) -> f32 {
    70.0 + (x * 0.027).sin() * 30.0 + (x * 0.06).sin() * 9.0
}

fn meadow(x: i32, y: i32) -> Color {
    let (fx, fy) = (x as f32, y as f32);
    let off_path = (fy - path(fx)).abs() + (rough(fx, fy, 7.0, 150) - 0.5) * 7.0;
    if off_path < 6.0 {
        let pebble = hash(x, y, 151);
        return if pebble < 0.05 {
            hex(0xc8c0b0)
        } else {
            ramp(&[0x8c7658, 0xa48c68, 0xbca47c], rough(fx, fy, 9.0, 152) * 1.2, x, y)
        };
    }
    match hash(x, y, 153) {
        h if h < 0.003 => hex(0xf4f0e0),
        h if h < 0.006 => hex(0xe8a8c8),
        h if h < 0.009 => hex(0xf0d870),
        h if h < 0.05 => hex(0x86a45c),
        _ => {
            let patch = rough(fx, fy, 34.0, 154) * 0.8 + rough(fx, fy, 6.0, 155) * 0.5;
            ramp(&[0x40603c, 0x527644, 0x6a8e50, 0x86a45c], patch - 0.12, x, y)
        }
    }
}

fn scene_file() -> String {
    let mut random = Random::new(250 * 141);
    let mut number =
        |from: f32, to: f32| from + (to - from) * random.below(1 << 16) as f32 / 65_536.0;
    let mut discs: Vec<(f32, f32, f32)> = Vec::new();
    let mut text = String::from(HEAD);
    while discs.len() < DISCS {
        // Radii in steps of a half, many small, few large.
        let r = 1.0 + (number(0.0, 1.0).powi(2) * 10.0).round() / 2.0;
        let (x, y) = (number(r, W as f32 - r), number(r, H as f32 - r));
        let (x, y) = ((x * 2.0).round() / 2.0, (y * 2.0).round() / 2.0);
        let free = discs
            .iter()
            .all(|&(dx, dy, dr)| (x - dx).powi(2) + (y - dy).powi(2) > (r + dr + GAP).powi(2));
        if !free || (y - path(x)).abs() < r + 7.0 {
            continue;
        }
        let i = discs.len();
        discs.push((x, y, r));
        let look = if i.is_multiple_of(4) {
            let [r8, g8, b8] = GLOW[i / 4 % GLOW.len()].map(|c| c * (0.5 + 3.2 / r));
            format!("emission = [{r8:.2}, {g8:.2}, {b8:.2}]")
        } else {
            let [r8, g8, b8] = LEAF[i % LEAF.len()];
            format!("albedo = [{r8}, {g8}, {b8}]")
        };
        writeln!(
            text,
            "\n[[shape]]\ncircle = {{ center = [{x:.1}, {y:.1}], radius = {r:.1} }}\n{look}"
        )
        .expect("text takes any length");
    }
    text
}

const HEAD: &str = r#"# A grove from above: discs of 1 to 6 px radius, one in four of them glowing. Lights this small are
# the hardest for methods that share rays between pixels. Drawn by `cargo xtask scenes`.
size = [250, 141]
sky = [0.01, 0.015, 0.03]

[layers]
color = "grove/color.png"

[light]
bounces = 2
wall_depth = 5
raymarch = { rays = 192 }

[display]
tonemap = "vivid"
exposure = 0.6
"#;
