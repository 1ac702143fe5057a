//! Random scenes of the kinds on which methods are compared.
//!
//! Each kind is hard in its own way. A seed picks a member of the kind, and the same seed gives the same
//! cells to the bit. A figure for a single seed may be a figure about that seed, so measure several. Radiance is of the order of 1; walls have some albedo, so that bounces show.

use crate::random::Random;
use lamplight::{Cells, Gradient, Lamp, Matter, Rgb, Sky};

/// The number of discs in a grove.
const GROVE_DISCS: usize = 130;
/// The least distance between two randomly placed things, px.
const GAP: f64 = 1.5;
/// The thickness of the dungeon's walls, px.
const WALL: u32 = 4;
/// The width of its doors, px.
const DOOR: u32 = 8;
/// The least distance between a door and the end of its wall, px.
const JAMB: u32 = 3;
/// The sides of the dungeon's rooms, px.
const ROOM: [u32; 2] = [28, 54];

/// A grove from above, 250×141: 130 discs of 1 to 6 px radius (most of them small) that do not
/// touch; one in four glows, the others emit nothing and have some albedo.
/// Cells are covered when their centre is. Most of the error of methods that share rays between
/// pixels is within a few px of the glowing discs and in the stripes that they cast.
pub fn grove(seed: u64) -> Cells {
    let mut random = random(seed);
    let mut cells = empty(250, 141);
    let mut placed = Placed::default();
    for i in 0..GROVE_DISCS {
        let radius = 1.0 + 5.0 * random.unit().powi(2);
        let center = placed.find(&mut random, &cells, radius);
        let matter = if i.is_multiple_of(4) {
            glow(color(&mut random), 0.5 + 3.2 / radius as f32)
        } else {
            wall(color(&mut random).map(|c| 0.7 * c))
        };
        disc(&mut cells, center, radius, matter);
    }
    cells
}

/// A dungeon from above, 512×288: rooms between walls of 4 px, doors of 8 px so that every room can
/// be reached, and in two rooms of five a light of 1.5 to 3 px radius, half of them [`Lamp`]s (drawn
/// by coverage), half discs of solid cells. The hardest of all: small lights, dark rooms lit
/// through doors.
pub fn dungeon(seed: u64) -> Cells {
    let mut random = random(seed);
    let (width, height) = (512, 288);
    let (columns, rows) = (lines(&mut random, width), lines(&mut random, height));
    let mut cells = empty(width, height);
    for i in 0..cells.len() {
        let on = |lines: &[u32], v: u32| lines.iter().any(|&from| (from..from + WALL).contains(&v));
        if on(&columns, i as u32 % width) || on(&rows, i as u32 / width) {
            cells.set_matter(i, wall([0.55, 0.5, 0.45]));
        }
    }
    let rooms = [columns.len() - 1, rows.len() - 1];
    doors(&mut cells, &mut random, &columns, &rows, rooms);
    for (top, bottom) in rows.iter().zip(&rows[1..]) {
        for (left, right) in columns.iter().zip(&columns[1..]) {
            let size = 1.5 + 1.5 * random.unit();
            let [dark, by_share] = [0.6, 0.5].map(|share| random.unit() < share);
            let color = color(&mut random);
            let margin = size + GAP;
            let mut place = |from: u32, to: u32| {
                let (from, to) = (f64::from(from + WALL) + margin, f64::from(to) - margin);
                from + (to - from) * random.unit()
            };
            let position = [place(*left, *right), place(*top, *bottom)];
            if dark {
                continue;
            }
            if by_share {
                let (position, size) = (position.map(|v| v as f32), size as f32);
                let lamp = Lamp { position, color, intensity: 4.0, size, ..Lamp::default() };
                cells.lamps_mut().push(lamp);
            } else {
                disc(&mut cells, position, size, glow(color, 4.0));
            }
        }
    }
    cells
}

/// Large emitters, 256×256: ten glowing discs and boxes of 4 to 16 px radius or half side, and
/// fourteen walls of at least 4 px between them. The easiest kind, like the scenes of published figures.
pub fn large_emitters(seed: u64) -> Cells {
    let mut random = random(seed);
    let mut cells = empty(256, 256);
    let mut placed = Placed::default();
    for i in 0..24 {
        let lamp = i < 10;
        let radius = 4.0 + 12.0 * random.unit();
        let center = placed.find(&mut random, &cells, radius * if i % 2 == 0 { 1.0 } else { 1.5 });
        let matter = if lamp {
            glow(color(&mut random), 1.0 + 2.0 * random.unit() as f32)
        } else {
            wall(color(&mut random).map(|c| 0.7 * c))
        };
        if i % 2 == 0 {
            disc(&mut cells, center, radius, matter);
        } else {
            let [long, short] = [radius, if lamp { 4f64.max(0.5 * radius) } else { 2.0 }];
            let half = if random.unit() < 0.5 { [long, short] } else { [short, long] };
            let near = |p: [f64; 2]| (0..2).all(|a| (p[a] - center[a]).abs() <= half[a]);
            fill(&mut cells, near, matter);
        }
    }
    cells
}

/// Fog, glass and sky, 240×160: a thin mist that absorbs blue first in one half, banks of denser fog
/// that glow a little, coloured panes, walls, and a few emitters of 4 px and more under a sky that
/// changes with direction. Cells scatter (albedo) and tint, so that every rule of transmittance
/// matters.
pub fn weather(seed: u64) -> Cells {
    let mut random = random(seed);
    let mut cells = empty(240, 160);
    cells.set_sky(Sky::Gradient(Gradient {
        zenith: [0.2, 0.3, 0.6],
        horizon: [0.5, 0.35, 0.2],
        ground: [0.05, 0.04, 0.03],
    }));
    let mist =
        Matter { opacity: 0.006, tint: [1.0, 0.999, 0.995], albedo: [0.5; 3], ..Matter::EMPTY };
    fill(&mut cells, |[x, _]| x < 120.0, mist);
    for _ in 0..6 {
        let center = [240.0 * random.unit(), 160.0 * random.unit()];
        let bank = Matter {
            emission: color(&mut random).map(|c| 0.1 * c),
            opacity: 0.02 + 0.04 * random.unit() as f32,
            albedo: [0.4; 3],
            ..Matter::EMPTY
        };
        let radius = 10.0 + 20.0 * random.unit();
        disc(&mut cells, center, radius, bank);
    }
    let mut placed = Placed::default();
    for i in 0..18 {
        let radius = 4.0 + 4.0 * random.unit();
        let center = placed.find(&mut random, &cells, radius * 1.5);
        let color = color(&mut random);
        let matter = match i % 3 {
            0 => glow(color, 2.0),
            1 => wall([0.5; 3]),
            _ => Matter { tint: color.map(|c| 0.3 + 0.7 * c), ..Matter::EMPTY },
        };
        match i % 3 {
            0 => disc(&mut cells, center, radius, matter),
            _ => {
                let half = if random.unit() < 0.5 { [1.5 * radius, 1.0] } else { [1.0, radius] };
                let near = |p: [f64; 2]| (0..2).all(|a| (p[a] - center[a]).abs() <= half[a]);
                fill(&mut cells, near, matter);
            }
        }
    }
    cells
}

/// A grid of odd sides with only a glowing disc in it, of radiance 1 and `radius` px, around the centre
/// of its middle cell, with `reach` empty px around it. Its light should be the same in all directions
/// except for the corners of its cells.
pub fn ring(radius: f64, reach: u32) -> Cells {
    let side = 2 * (radius.ceil() as u32 + reach) + 1;
    let mut cells = empty(side, side);
    disc(&mut cells, [f64::from(side) / 2.0; 2], radius, glow([1.0; 3], 1.0));
    cells
}

/// The cells whose centre lies within half a px of a circle of `radius` px around the centre of the
/// grid of [`ring`], by angle.
pub fn around_ring(cells: &Cells, radius: f64) -> Vec<[u32; 2]> {
    let middle = [cells.width(), cells.height()].map(|side| f64::from(side) / 2.0);
    let offset =
        |[x, y]: [u32; 2]| [f64::from(x) + 0.5 - middle[0], f64::from(y) + 0.5 - middle[1]];
    let mut around: Vec<[u32; 2]> = (0..cells.height())
        .flat_map(|y| (0..cells.width()).map(move |x| [x, y]))
        .filter(|&at| {
            let [dx, dy] = offset(at);
            (dx.hypot(dy) - radius).abs() <= 0.5
        })
        .collect();
    let angle = |&at: &[u32; 2]| {
        let [dx, dy] = offset(at);
        dy.atan2(dx)
    };
    around.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    around
}

/// `count` random open cells, with lamps drawn in, or none if all cells are solid. A cell may occur
/// twice.
pub fn open_cells(cells: &Cells, count: usize, seed: u64) -> Vec<[u32; 2]> {
    let drawn = cells.drawn();
    let open: Vec<usize> = (0..drawn.len()).filter(|&i| !drawn.is_solid(i)).collect();
    let mut random = random(seed);
    let width = drawn.width() as usize;
    let mut look = || {
        let i = open[(random.unit() * open.len() as f64) as usize];
        [(i % width) as u32, (i / width) as u32]
    };
    if open.is_empty() { Vec::new() } else { (0..count).map(|_| look()).collect() }
}

fn random(seed: u64) -> Random {
    Random::new(seed, 0, 0)
}

fn empty(width: u32, height: u32) -> Cells {
    Cells::new(width, height).expect("the sizes here are grids")
}

fn glow(color: Rgb, strength: f32) -> Matter {
    Matter { emission: color.map(|c| c * strength), opacity: 1.0, ..Matter::EMPTY }
}

fn wall(albedo: Rgb) -> Matter {
    Matter { opacity: 1.0, albedo, ..Matter::EMPTY }
}

/// A colour of any hue, its strongest channel 1 and its weakest at least 0.2.
fn color(random: &mut Random) -> Rgb {
    let rgb: [f64; 3] = std::array::from_fn(|_| random.unit());
    let (low, high) = (rgb[0].min(rgb[1]).min(rgb[2]), rgb[0].max(rgb[1]).max(rgb[2]));
    rgb.map(|v| (0.2 + 0.8 * (v - low) / (high - low).max(1e-9)) as f32)
}

/// Sets matter in the cells whose centre is inside.
fn fill(cells: &mut Cells, inside: impl Fn([f64; 2]) -> bool, matter: Matter) {
    for y in 0..cells.height() {
        for x in 0..cells.width() {
            if inside([x, y].map(|v| f64::from(v) + 0.5)) {
                cells.set(x, y, matter);
            }
        }
    }
}

fn disc(cells: &mut Cells, [cx, cy]: [f64; 2], radius: f64, matter: Matter) {
    fill(cells, |[x, y]| (x - cx).hypot(y - cy) <= radius, matter);
}

/// Round things that do not touch.
#[derive(Default)]
struct Placed(Vec<([f64; 2], f64)>);

impl Placed {
    /// A random free place, wholly inside the grid.
    fn find(&mut self, random: &mut Random, cells: &Cells, radius: f64) -> [f64; 2] {
        let sides = [cells.width(), cells.height()].map(f64::from);
        loop {
            let center = sides.map(|side| radius + (side - 2.0 * radius) * random.unit());
            let free = self.0.iter().all(|(other, r)| {
                (center[0] - other[0]).hypot(center[1] - other[1]) > radius + r + GAP
            });
            if free {
                self.0.push((center, radius));
                return center;
            }
        }
    }
}

/// The positions of the dungeon's walls along an axis: at both edges and between rooms.
fn lines(random: &mut Random, side: u32) -> Vec<u32> {
    let [least, most] = ROOM;
    let mut lines = vec![0];
    let mut at = 0;
    // A remainder too small for two rooms is the last room.
    while side - at > 2 * (least + WALL) + WALL {
        let longest = most.min(side - at - (least + WALL) - 2 * WALL);
        at += WALL + least + (random.unit() * f64::from(longest - least + 1)) as u32;
        lines.push(at);
    }
    lines.push(side - WALL);
    lines
}

/// Cuts doors: enough to reach every room, and one in five of the others.
fn doors(
    cells: &mut Cells,
    random: &mut Random,
    columns: &[u32],
    rows: &[u32],
    [across, down]: [usize; 2],
) {
    let mut walls: Vec<(usize, usize)> = Vec::new();
    for room in 0..across * down {
        if room % across + 1 < across {
            walls.push((room, room + 1));
        }
        if room / across + 1 < down {
            walls.push((room, room + across));
        }
    }
    for i in (1..walls.len()).rev() {
        walls.swap(i, (random.unit() * (i + 1) as f64) as usize);
    }
    let mut group: Vec<usize> = (0..across * down).collect();
    for (a, b) in walls {
        let joins = group[a] != group[b];
        if !joins && random.unit() >= 0.2 {
            continue;
        }
        let (old, new) = (group[b], group[a]);
        group.iter_mut().filter(|g| **g == old).for_each(|g| *g = new);
        let (column, row) = (b % across, b / across);
        let mut along = |lines: &[u32], i: usize| {
            let from = lines[i] + WALL + JAMB;
            let to = lines[i + 1] - JAMB - DOOR;
            from + (random.unit() * f64::from(to - from + 1)) as u32
        };
        let (x, y, w, h) = if b == a + 1 {
            (columns[column], along(rows, row), WALL, DOOR)
        } else {
            (along(columns, column), rows[row], DOOR, WALL)
        };
        for y in y..y + h {
            for x in x..x + w {
                cells.set(x, y, Matter::EMPTY);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEEDS: std::ops::Range<u64> = 0..8;

    #[test]
    fn every_seed_is_a_scene_of_its_own_and_the_same_each_time() {
        for make in [grove, dungeon, large_emitters, weather] {
            for seed in SEEDS {
                let cells = make(seed);
                cells.check().unwrap();
                assert!(cells == make(seed), "seed {seed} is another scene the second time");
                assert!(cells != make(seed + 1), "seeds {seed} and the next are the same scene");
            }
        }
    }

    #[test]
    fn a_dungeon_has_rooms_that_are_reached_and_lamps_in_the_open() {
        for seed in SEEDS {
            let cells = dungeon(seed);
            let (w, h) = (cells.width() as usize, cells.height() as usize);
            let start = (0..cells.len()).find(|&i| !cells.is_solid(i)).unwrap();
            let mut reached = vec![false; cells.len()];
            let mut front = vec![start];
            while let Some(i) = front.pop() {
                if !cells.is_solid(i) && !std::mem::replace(&mut reached[i], true) {
                    // The outer walls have no gap, so every open cell has four neighbours.
                    let (x, y) = (i % w, i / w);
                    assert!(x > 0 && y > 0 && x + 1 < w && y + 1 < h, "seed {seed}: a hole");
                    front.extend([i - 1, i + 1, i - w, i + w]);
                }
            }
            let cut_off = (0..cells.len()).any(|i| !cells.is_solid(i) && !reached[i]);
            assert!(!cut_off, "seed {seed}: a room has no door");
            let discs = cells.emission().iter().filter(|e| **e != [0.0; 3]).count();
            assert!(cells.lamps().len() > 5 && discs > 50, "seed {seed}: hardly any light");
            for lamp in cells.lamps() {
                assert!((1.5..=3.0).contains(&lamp.size), "{lamp:?}");
                let [x, y] = lamp.position.map(|v| v as u32);
                assert!(!cells.is_solid(cells.index(x, y)), "seed {seed}: {lamp:?} in a wall");
            }
        }
    }

    #[test]
    fn the_looks_lie_on_the_ring_and_in_the_open() {
        let cells = ring(4.0, 30);
        assert_eq!((cells.width(), cells.height()), (69, 69));
        let looks = around_ring(&cells, 12.0);
        assert!(looks.len() > 60, "{} looks", looks.len());
        for [x, y] in looks {
            let d = (f64::from(x) - 34.0).hypot(f64::from(y) - 34.0);
            assert!((11.5..=12.5).contains(&d), "({x}, {y}) is {d} px off");
        }
        let cells = grove(1);
        let looks = open_cells(&cells, 500, 2);
        assert!(
            looks.len() == 500 && looks.iter().all(|&[x, y]| !cells.is_solid(cells.index(x, y)))
        );
    }
}
