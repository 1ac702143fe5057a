//! The initial cave of the falling-sand world, on a layout of 320×180.

use super::element::Element;
use super::{Grain, LAYOUT, Sand};
use crate::paint::{hex, mix};
use crate::random::Random;
use crate::texture::{cloud, hash, noise};
use lamplight::{Gradient, Sky};

/// Left and right edge of the opening above the lake.
const SHAFT: [f32; 2] = [66.0, 98.0];
/// Surface rows of the lake and the lava.
const LAKE: f32 = 144.0;
const LAVA: f32 = 150.0;
/// Points of the floor, from left to right.
const FLOOR: [[f32; 2]; 15] = [
    [0.0, 108.0],
    [14.0, 122.0],
    [22.0, 150.0],
    [58.0, 168.0],
    [92.0, 162.0],
    [112.0, 139.0],
    [128.0, 136.0],
    [196.0, 139.0],
    [216.0, 136.0],
    [228.0, 160.0],
    [256.0, 171.0],
    [286.0, 164.0],
    [298.0, 140.0],
    [308.0, 116.0],
    [320.0, 104.0],
];
/// Shelves: centre, top, half width, thickness.
const SHELVES: [[f32; 4]; 3] =
    [[14.0, 82.0, 36.0, 12.0], [150.0, 80.0, 20.0, 8.0], [300.0, 72.0, 44.0, 13.0]];
/// Crystals: foot, tip, width, colour (0 cyan, 1 violet).
const CRYSTALS: [([f32; 2], [f32; 2], f32, u8); 9] = [
    ([8.0, 80.0], [14.0, 62.0], 4.0, 0),
    ([14.0, 81.0], [23.0, 69.0], 3.0, 0),
    ([4.0, 80.0], [3.0, 68.0], 3.0, 0),
    ([146.0, 80.0], [142.0, 64.0], 3.5, 1),
    ([150.0, 80.0], [152.0, 58.0], 4.5, 1),
    ([155.0, 80.0], [162.0, 67.0], 3.0, 1),
    ([40.0, 166.0], [35.0, 152.0], 4.0, 0),
    ([46.0, 167.0], [49.0, 149.0], 4.0, 0),
    ([52.0, 168.0], [60.0, 157.0], 3.0, 0),
];

impl Sand {
    /// A cave with a lake, a dune, crystals and lava.
    ///
    /// # Panics
    /// If `size` is not a size of a grid; [`crate::worlds::WorldKind::make`] checks that.
    pub fn new(size: [u32; 2], seed: u64) -> Self {
        let mut sand = Self::empty(size, seed);
        compose(&mut sand, seed as u32);
        sand
    }
}

/// Fills an empty world.
fn compose(sand: &mut Sand, seed: u32) {
    let scale = [sand.width as f32 / LAYOUT[0], sand.height as f32 / LAYOUT[1]];
    let mut layout = Layout { sand, seed, scale, random: Random::new(u64::from(seed) + 1) };
    layout.rock_and_pools();
    layout.crystals();
    layout.glass();
    layout.bowl();
    layout.plants();
    layout.drips();
    layout.sand.sky = evening();
}

struct Layout<'a> {
    sand: &'a mut Sand,
    seed: u32,
    /// Cells per layout px.
    scale: [f32; 2],
    random: Random,
}

impl Layout<'_> {
    /// The row of the ceiling.
    fn ceiling(&self, x: f32) -> f32 {
        let broad = 24.0 + 18.0 * (noise(x / 34.0, 0.5, self.seed) - 0.5);
        let teeth = (noise(x / 7.0, 7.5, self.seed) - 0.55).max(0.0) * 50.0;
        let dome = 16.0 * ((x - 165.0) / 150.0).powi(2);
        let shaft = ((x - SHAFT[0]).min(SHAFT[1] - x) / 5.0).clamp(0.0, 1.0);
        (broad + teeth + dome) * (1.0 - shaft) - 4.0 * shaft
    }

    fn floor(&self, x: f32) -> f32 {
        let next = FLOOR.iter().position(|at| at[0] > x).unwrap_or(FLOOR.len() - 1).max(1);
        let ([x0, y0], [x1, y1]) = (FLOOR[next - 1], FLOOR[next]);
        let t = ((x - x0) / (x1 - x0)).clamp(0.0, 1.0);
        let rough = 4.0 * (noise(x / 9.0, 3.5, self.seed) - 0.5);
        y0 + (y1 - y0) * t * t * (3.0 - 2.0 * t) + rough
    }

    fn shelf(&self, x: f32, y: f32) -> bool {
        SHELVES.iter().any(|&[middle, top, half, thick]| {
            let u = (x - middle) / half;
            let rough = 6.0 * (noise(x / 6.0, top, self.seed) - 0.5);
            u.abs() < 1.0 && y >= top && y < top + (thick + rough) * (1.0 - u * u)
        })
    }

    /// Height of the dune above row 140.
    fn dune(x: f32) -> f32 {
        let heap =
            |middle: f32, height: f32, wide: f32| height * (-((x - middle) / wide).powi(2)).exp();
        heap(170.0, 25.0, 23.0) + heap(145.0, 9.0, 12.0) + heap(199.0, 8.0, 10.0)
    }

    fn rock_and_pools(&mut self) {
        for cy in 0..self.sand.height {
            for cx in 0..self.sand.width {
                let (x, y) = ((cx as f32 + 0.5) / self.scale[0], (cy as f32 + 0.5) / self.scale[1]);
                let floor = self.floor(x);
                let rim = x.min(LAYOUT[0] - x).min(LAYOUT[1] - y) < 3.0;
                let element = if rim || y < self.ceiling(x) || y > floor || self.shelf(x, y) {
                    Element::Stone
                } else if x < 124.0 && y > LAKE {
                    Element::Water
                } else if x > 212.0 && y > LAVA {
                    Element::Lava
                } else if y > 140.0 - Self::dune(x) && (126.0..210.0).contains(&x) {
                    Element::Sand
                } else {
                    Element::Empty
                };
                // Strata: slanted bands of rock.
                let band = cloud(x / 26.0 + y / 60.0, y / 7.0, self.seed + 9);
                let grit = hash(cx, cy, self.seed) * 1.6;
                let shade = match element {
                    Element::Stone => band * 9.0 - 1.5 + grit,
                    Element::Sand => band * 6.0 + grit,
                    Element::Lava => (cloud(x / 9.0, y / 6.0, self.seed + 5) * 24.0) % 8.0,
                    _ => hash(cx, cy, self.seed) * 8.0,
                };
                let shade = shade.clamp(0.0, 7.0) as u8;
                self.sand.set(cx, cy, Grain { element, shade, ..Grain::default() });
                self.sand.backdrop[(cy * self.sand.width + cx) as usize] = self.wall(x, y);
            }
        }
    }

    /// The colour of the back wall: cool above the lake, warm towards the lava, with cracks.
    fn wall(&self, x: f32, y: f32) -> [f32; 3] {
        let warm = ((x - 90.0) / 170.0).clamp(0.0, 1.0);
        let base = mix(hex(0x9a9cae), hex(0xa8988c), warm);
        let large = cloud(x / 40.0, y / 24.0, self.seed + 21);
        let crack = (noise(x / 11.0, y / 8.0, self.seed + 33) - 0.5).abs();
        let depth = 0.35 + 0.75 * large - if crack < 0.03 { 0.14 } else { 0.0 };
        // Posterized, which suits cells better than smooth shading.
        base.map(|v| v * ((depth * 9.0).round() / 9.0).clamp(0.15, 1.0))
    }

    /// Draws a slanted bar of an element.
    fn bar(&mut self, from: [f32; 2], to: [f32; 2], width: f32, element: Element, shade: u8) {
        let [sx, sy] = self.scale;
        let (a, b) = ([from[0] * sx, from[1] * sy], [to[0] * sx, to[1] * sy]);
        let half = 0.5 * width * sx.min(sy);
        let along = [b[0] - a[0], b[1] - a[1]];
        let length = along[0].hypot(along[1]).max(1e-3);
        for cy in 0..self.sand.height {
            for cx in 0..self.sand.width {
                let p = [cx as f32 + 0.5 - a[0], cy as f32 + 0.5 - a[1]];
                let t = (p[0] * along[0] + p[1] * along[1]) / (length * length);
                let off = (p[0] * along[1] - p[1] * along[0]).abs() / length;
                // Crystals taper to a point; bars do not.
                let taper =
                    if element == Element::Crystal { (1.25 * (1.0 - t)).min(1.0) } else { 1.0 };
                if (0.0..=1.0).contains(&t) && off <= (half * taper).max(0.3) {
                    self.put(cx, cy, element, shade + (off / half.max(1.0) * -1.9 + 2.9) as u8);
                }
            }
        }
    }

    fn put(&mut self, x: i32, y: i32, element: Element, shade: u8) {
        self.sand.place(x, y, element);
        if let Some(grain) = self.sand.at(x, y) {
            self.sand.set(x, y, Grain { shade, ..grain });
        }
    }

    fn crystals(&mut self) {
        for (foot, tip, width, color) in CRYSTALS {
            self.bar(foot, tip, width, Element::Crystal, 4 * color);
        }
    }

    /// Draws coloured panes in a wooden frame, between the lava and the dune.
    fn glass(&mut self) {
        let [sx, sy] = self.scale;
        for cy in (104.0 * sy) as i32..(138.0 * sy) as i32 {
            for cx in (209.0 * sx) as i32..(213.0 * sx).ceil() as i32 {
                let pane = (cy as f32 / sy - 104.0) / 34.0 * 4.0;
                let edge = pane.fract() < 0.12;
                let element = if edge { Element::Wood } else { Element::Glass };
                let shade = if edge { 5 } else { [3, 2, 1, 0][(pane as usize).min(3)] };
                self.put(cx, cy, element, shade);
            }
        }
    }

    /// Draws a bowl of burning oil on the right shelf.
    fn bowl(&mut self) {
        let [sx, sy] = self.scale;
        for cy in (62.0 * sy) as i32..(72.0 * sy) as i32 + 1 {
            for cx in (272.0 * sx) as i32..(300.0 * sx) as i32 {
                let u = (cx as f32 / sx - 286.0) / 13.0;
                let depth = (cy as f32 / sy - 62.0) / 10.0;
                let out = u * u + depth * depth;
                let element = if out > 1.0 {
                    continue;
                } else if out > 0.55 {
                    Element::Stone
                } else if depth < 0.25 {
                    continue;
                } else {
                    Element::Oil
                };
                self.put(cx, cy, element, 4);
                if let (Element::Oil, true, Some(oil)) =
                    (element, depth < 0.4, self.sand.at(cx, cy))
                {
                    self.sand.set(cx, cy, Grain { life: 255, ..oil });
                }
            }
        }
    }

    /// Plants vines on the ceiling and shelves, and reeds on the banks of the lake.
    fn plants(&mut self) {
        let unit = self.scale[0].min(self.scale[1]);
        for cx in 0..self.sand.width {
            let x = cx as f32 / self.scale[0];
            let here = noise(x / 5.0, 11.5, self.seed);
            if !(here > 0.52 && (6.0..206.0).contains(&x)) {
                continue;
            }
            if hash(cx, 1, self.seed) < 0.45 / unit {
                let length = (here * here * 34.0 * unit) as i32;
                self.hang(cx, (self.ceiling(x) * self.scale[1]) as i32, length);
            }
            for [middle, top, half, _] in SHELVES {
                if (x - middle).abs() < half * 0.9 && hash(cx, 2, self.seed) < 0.4 / unit {
                    let length = (here * 22.0 * unit) as i32;
                    self.hang(cx, (top * self.scale[1]) as i32 + 1, length);
                }
            }
        }
        for cx in 0..self.sand.width {
            let x = cx as f32 / self.scale[0];
            let bank = x < 26.0 || (104.0..134.0).contains(&x);
            if bank && hash(cx, 3, self.seed) < 0.75 {
                let tall = (self.random.range(1.0, 9.0) * unit) as i32;
                let ground = (self.floor(x) * self.scale[1]) as i32;
                for k in 0..tall {
                    self.sprout(cx, ground - k, k);
                }
            }
        }
    }

    /// Plants a vine downwards from the first free cell below (x, y).
    fn hang(&mut self, x: i32, y: i32, length: i32) {
        let from = (y..y + 40).find(|&y| self.sand.element(x, y) == Some(Element::Empty));
        let Some(from) = from else { return };
        for k in 0..length {
            if !self.sprout(x, from + k, k) {
                return;
            }
        }
    }

    /// Adds a leaf whose shade depends on `k`. Returns whether the cell was free.
    fn sprout(&mut self, x: i32, y: i32, k: i32) -> bool {
        let free = matches!(self.sand.element(x, y), Some(Element::Empty | Element::Water));
        if free {
            self.put(x, y, Element::Plant, (k % 4 + 3) as u8);
        }
        free
    }

    fn drips(&mut self) {
        for x in [30.0, 52.0, 112.0] {
            let cx = (x * self.scale[0]) as i32;
            let open = |cy: &i32| self.sand.element(cx, *cy) == Some(Element::Empty);
            if let Some(cy) = (0..self.sand.height / 2).find(open) {
                self.sand.drips.push([cx, cy]);
            }
        }
    }
}

/// The evening above the cave.
fn evening() -> Sky {
    Sky::Gradient(Gradient {
        zenith: [5.0, 5.6, 6.4],
        horizon: [2.4, 2.4, 2.6],
        ground: [0.0, 0.0, 0.0],
    })
}
