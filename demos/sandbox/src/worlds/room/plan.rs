//! The plan of the house on a layout of 320×180: walls, windows, furniture, floors.

use crate::paint::{Paint, hex, mix, scale};
use crate::texture::{cloud, hash};
use lamplight::Cells;

/// Columns and rows of the plan.
pub(super) const LAYOUT: [f32; 2] = [320.0, 180.0];
/// A rectangle: left, top, right, bottom.
pub(super) type Area = [f32; 4];

const WALLS: [Area; 12] = [
    [14.0, 12.0, 306.0, 17.0],
    [14.0, 163.0, 196.0, 168.0],
    [212.0, 163.0, 306.0, 168.0],
    [14.0, 12.0, 19.0, 168.0],
    [301.0, 12.0, 306.0, 168.0],
    [112.0, 12.0, 116.0, 48.0],
    [112.0, 64.0, 116.0, 120.0],
    [112.0, 136.0, 116.0, 168.0],
    [208.0, 12.0, 212.0, 58.0],
    [208.0, 74.0, 212.0, 98.0],
    [112.0, 94.0, 246.0, 98.0],
    [262.0, 94.0, 306.0, 98.0],
];

/// Panes in the outer walls and their colours.
const WINDOWS: [(Area, u32); 11] = [
    ([14.0, 38.0, 19.0, 48.0], 0xb8d8ff),
    ([14.0, 50.0, 19.0, 60.0], 0xb8d8ff),
    ([14.0, 100.0, 19.0, 112.0], 0xb8d8ff),
    ([136.0, 12.0, 146.0, 17.0], 0xff9ab0),
    ([148.0, 12.0, 158.0, 17.0], 0xffd890),
    ([160.0, 12.0, 170.0, 17.0], 0x98f0c0),
    ([172.0, 12.0, 182.0, 17.0], 0xa0b8ff),
    ([301.0, 36.0, 306.0, 48.0], 0xb8d8ff),
    ([301.0, 50.0, 306.0, 62.0], 0xb8d8ff),
    ([301.0, 122.0, 306.0, 136.0], 0xb8d8ff),
    ([60.0, 12.0, 76.0, 17.0], 0xb8d8ff),
];

/// Doors: area when closed, and whether they slide along x.
pub(super) const DOORS: [(Area, bool); 5] = [
    ([112.5, 48.0, 115.5, 64.0], false),
    ([112.5, 120.0, 115.5, 136.0], false),
    ([208.5, 58.0, 211.5, 74.0], false),
    ([246.0, 94.5, 262.0, 97.5], true),
    ([196.0, 164.0, 212.0, 167.0], true),
];

/// Furniture and its colour.
const FURNITURE: [(Area, u32); 17] = [
    ([44.0, 76.0, 74.0, 92.0], 0xa8703c),
    ([48.0, 70.0, 55.0, 74.0], 0xc08a50),
    ([62.0, 94.0, 69.0, 98.0], 0xc08a50),
    ([19.0, 70.0, 25.0, 92.0], 0x7a5c8c),
    ([92.0, 17.0, 112.0, 22.0], 0x8a5a34),
    ([84.0, 156.0, 112.0, 163.0], 0x8a5a34),
    ([134.0, 36.0, 140.0, 42.0], 0xcfc6d8),
    ([178.0, 36.0, 184.0, 42.0], 0xcfc6d8),
    ([134.0, 70.0, 140.0, 76.0], 0xcfc6d8),
    ([178.0, 70.0, 184.0, 76.0], 0xcfc6d8),
    ([268.0, 17.0, 294.0, 40.0], 0xc8606c),
    ([271.0, 18.0, 291.0, 24.0], 0xf0e6dc),
    ([212.0, 84.0, 232.0, 94.0], 0x8a5a34),
    ([140.0, 112.0, 172.0, 120.0], 0xb07a44),
    ([140.0, 142.0, 172.0, 150.0], 0xb07a44),
    ([270.0, 146.0, 290.0, 156.0], 0xa8703c),
    ([286.0, 98.0, 301.0, 106.0], 0x8a5a34),
];

/// The hearth with glowing coals.
const HEARTH: Area = [50.0, 158.0, 70.0, 163.0];
/// Trees in the garden: centre and radius.
const TREES: [([f32; 2], f32); 9] = [
    ([5.0, 22.0], 5.0),
    ([6.0, 88.0], 6.0),
    ([4.0, 150.0], 5.0),
    ([120.0, 3.0], 4.0),
    ([236.0, 4.0], 5.0),
    ([314.0, 24.0], 5.0),
    ([315.0, 92.0], 5.5),
    ([240.0, 176.0], 5.0),
    ([150.0, 176.0], 4.5),
];

fn within(area: &Area, x: f32, y: f32) -> bool {
    (area[0]..area[2]).contains(&x) && (area[1]..area[3]).contains(&y)
}

/// Size of a brick, of a plank and of a tile.
const BRICK: [f32; 2] = [5.0, 3.0];
const PLANK: [f32; 2] = [28.0, 6.0];
const TILE: f32 = 8.0;
/// Height of bricks, planks, tiles and furniture above the joints between them.
const HEIGHT: f32 = 0.6;
/// The largest slope of a plank, to one of its sides.
const ASKEW: f32 = 0.08;

/// Draws everything static.
pub(super) fn draw(cells: &mut Cells, seed: u32) {
    let by = [cells.width() as f32 / LAYOUT[0], cells.height() as f32 / LAYOUT[1]];
    let half = by.map(|by| 0.5 / by);
    for cy in 0..cells.height() {
        for cx in 0..cells.width() {
            let (x, y) = ((cx as f32 + 0.5) / by[0], (cy as f32 + 0.5) / by[1]);
            let index = cells.index(cx, cy);
            Place { x, y, half, seed }.paint().at_scale(by[0].min(by[1])).put(cells, index);
        }
    }
}

/// The place of a cell in the plan.
struct Place {
    x: f32,
    y: f32,
    /// Half of the cell's size.
    half: [f32; 2],
    seed: u32,
}

impl Place {
    /// Tilts a surface by its mean slope over the cell.
    fn tilted(&self, paint: Paint, height: impl Fn(f32, f32) -> f32) -> Paint {
        let Self { x, y, half: [dx, dy], .. } = *self;
        let right = height(x + dx, y) - height(x - dx, y);
        let down = height(x, y + dy) - height(x, y - dy);
        paint.tilted([0.5 * right / dx, 0.5 * down / dy])
    }

    fn paint(&self) -> Paint {
        let Self { x, y, seed, .. } = *self;
        if let Some((_, color)) = WINDOWS.iter().find(|(area, _)| within(area, x, y)) {
            let tint = mix([1.0; 3], hex(*color), 0.3);
            return Paint::glass(tint).colored(hex(*color));
        }
        if within(&HEARTH, x, y) {
            let ember = hash((x / 1.5) as i32, (y / 1.5) as i32, seed);
            return Paint::wall(hex(0x301008)).glowing(scale([1.7, 0.85, 0.32], 0.5 + ember));
        }
        if WALLS.iter().any(|area| within(area, x, y)) {
            let [w, h] = BRICK;
            let tone = 0.8 + 0.25 * hash((x / w) as i32, (y / h) as i32, seed);
            let brick = Paint::wall(scale(hex(0xb09a94), tone.min(1.0)));
            return self.tilted(brick, |x, y| raised([x % w, y % h], BRICK));
        }
        if let Some((area, color)) = FURNITURE.iter().rev().find(|(area, _)| within(area, x, y)) {
            let [left, top, right, bottom] = *area;
            let edge = (x - left).min(right - x).min(y - top).min(bottom - y) < 1.0;
            let grain = 0.85 + 0.15 * hash(x as i32 / 6, y as i32, seed);
            // Furniture is lit from above, so light penetrates it, unlike walls.
            let top_side = Paint::fog(0.05, scale(hex(*color), if edge { 0.65 } else { grain }));
            let size = [right - left, bottom - top];
            return self.tilted(top_side, |x, y| raised([x - left, y - top], size));
        }
        let crown = TREES.iter().find(|(middle, radius)| {
            let rough = 0.75 + 0.5 * cloud(x / 3.0, y / 3.0, seed);
            (x - middle[0]).hypot(y - middle[1]) < radius * rough
        });
        if crown.is_some() {
            let leaves = mix(hex(0x3f8a4a), hex(0x7fb050), cloud(x / 2.0, y / 2.0, seed));
            return Paint::fog(0.12, leaves);
        }
        self.floor()
    }

    /// Floors: planks, tiles, carpet, flagstones, grass.
    fn floor(&self) -> Paint {
        let Self { x, y, seed, .. } = *self;
        let house = [19.0, 17.0, 301.0, 168.0];
        if !within(&house, x, y) {
            let tuft = hash((x / 1.5) as i32, (y / 1.5) as i32, seed);
            let path = (196.0..212.0).contains(&x) && y > 166.0;
            let grass =
                mix(hex(0x3c6a48), hex(0x6d9a5c), 0.6 * tuft + 0.4 * cloud(x / 9.0, y / 9.0, seed));
            return Paint::open(if path { scale(hex(0xa89c90), 0.8 + 0.2 * tuft) } else { grass });
        }
        match (x < 114.0, x < 210.0, y < 96.0) {
            (true, ..) => {
                let rug = within(&[36.0, 66.0, 84.0, 104.0], x, y);
                let hem = rug && !within(&[38.5, 68.5, 81.5, 101.5], x, y);
                match (rug, hem) {
                    (_, true) => Paint::open(hex(0xe0b870)),
                    (true, _) => Paint::open(hex(0x9a5c68)),
                    _ => self.planks(0x94745c, 0xd0ac84, |x, y| [x, y]),
                }
            }
            (_, true, true) => {
                let even = ((x / TILE).floor() as i32 + (y / TILE).floor() as i32) % 2 == 0;
                let tone = 0.9 + 0.1 * hash((x / TILE) as i32, (y / TILE) as i32, seed);
                let tile = scale(if even { hex(0xd8d0c8) } else { hex(0x8a94a8) }, tone);
                self.tilted(Paint::open(tile), |x, y| raised([x % TILE, y % TILE], [TILE; 2]))
            }
            (_, false, true) => {
                let weave = 0.85 + 0.15 * hash((x / 2.0) as i32, (y / 2.0) as i32, seed);
                let carpet = mix(hex(0x6a6a9a), hex(0x8c88b8), cloud(x / 14.0, y / 14.0, seed));
                Paint::open(scale(carpet, weave))
            }
            _ => self.planks(0x8a7a70, 0xc8b8a4, |x, y| [y, x]),
        }
    }

    /// Planks between two tones. `turned` gives the place along and across them.
    fn planks(&self, dark: u32, light: u32, turned: impl Fn(f32, f32) -> [f32; 2]) -> Paint {
        let seed = self.seed;
        let [x, y] = turned(self.x, self.y);
        let Board { column, row, place: [u, v] } = Board::at(x, y);
        let seam = v / PLANK[1] < 0.14 || u / PLANK[0] < 0.04;
        let tone = 0.35 * hash(column, row, seed) + 0.5 * cloud(x / 12.0, y / 2.0, seed);
        let color = scale(mix(hex(dark), hex(light), tone), if seam { 0.6 } else { 1.0 });
        self.tilted(Paint::open(color), |x, y| {
            let [x, y] = turned(x, y);
            let Board { column, row, place } = Board::at(x, y);
            let askew = ASKEW * (2.0 * hash(column, row, seed + 1) - 1.0);
            raised(place, PLANK) + askew * (place[1] - 0.5 * PLANK[1])
        })
    }
}

/// A board of a floor of planks, and a place on it.
struct Board {
    column: i32,
    row: i32,
    place: [f32; 2],
}

impl Board {
    fn at(x: f32, y: f32) -> Self {
        let [length, width] = PLANK;
        let row = (y / width).floor();
        let along = (x + 17.0 * row) / length;
        let place = [along.fract() * length, (y / width).fract() * width];
        Self { column: along.floor() as i32, row: row as i32, place }
    }
}

/// The height of a block of a size at a place on it. Its edges are round.
fn raised([u, v]: [f32; 2], [w, h]: [f32; 2]) -> f32 {
    let edge = u.min(w - u).min(v).min(h - v).clamp(0.0, 1.0);
    HEIGHT * edge * (2.0 - edge)
}
