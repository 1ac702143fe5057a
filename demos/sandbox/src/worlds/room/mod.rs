//! A small house at night in top view: a walker, lanterns to carry, doors, windows, and a meter of the
//! walker's brightness.

mod plan;

use super::world::{Input, World, copy, fits};
use crate::figure::Figure;
use crate::look::Look;
use crate::paint::{Paint, hex, scale};
use lamplight::{Cells, Display, Lamp, Light, Matter, Rgb, Sky, srgb};
use plan::{DOORS, LAYOUT};

/// Radius of the walker, px of the plan.
const RADIUS: f32 = 3.2;
/// Speed of the walker, px of the plan per step.
const PACE: f32 = 1.0;
/// Reach of the walker for doors and lanterns, px of the plan.
const REACH: f32 = 12.0;
/// Fraction of its way that a door slides per step.
const SLIDE: f32 = 0.05;
/// Luminance at which [`Room::lit`] is one half.
pub const HALF_LIT: f32 = 0.35;

/// A lantern, on the floor or carried.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lantern {
    /// Position in cells. A carried lantern moves with the walker.
    at: [f32; 2],
    color: Rgb,
    on: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Door {
    /// Area when closed, in cells: left, top, right, bottom.
    area: [f32; 4],
    along_x: bool,
    /// 0 (closed) to 1 (open).
    open: f32,
    opens: bool,
}

/// The house.
#[derive(Clone, Debug)]
pub struct Room {
    size: [u32; 2],
    still: Cells,
    /// True for each cell that is a wall, a pane or furniture.
    solid: Vec<bool>,
    walker: [f32; 2],
    facing: [f32; 2],
    lanterns: Vec<Lantern>,
    carried: Option<usize>,
    doors: Vec<Door>,
    steps: u32,
}

impl Room {
    /// The initial house, with a lantern in hand. The seed determines textures.
    ///
    /// # Panics
    /// If `size` is not a size of a grid; [`super::WorldKind::make`] checks that.
    pub fn new(size: [u32; 2], seed: u64) -> Self {
        let mut still = Cells::new(size[0], size[1]).expect("a size that was checked");
        plan::draw(&mut still, seed as u32);
        still.set_sky(Sky::Uniform([0.2, 0.3, 0.52]));
        let solid = (0..still.len()).map(|i| still.matter(i) != Matter::EMPTY).collect();
        let by = [size[0] as f32 / LAYOUT[0], size[1] as f32 / LAYOUT[1]];
        let lantern = |x: f32, y: f32, color: u32, on| Lantern {
            at: [x * by[0], y * by[1]],
            color: hex(color),
            on,
        };
        let door = |&([left, top, right, bottom], along_x): &([f32; 4], bool)| Door {
            area: [left * by[0], top * by[1], right * by[0], bottom * by[1]],
            along_x,
            open: 0.0,
            opens: false,
        };
        let mut room = Self {
            size,
            still,
            solid,
            walker: [90.0 * by[0], 56.0 * by[1]],
            facing: [1.0, 0.0],
            lanterns: vec![
                lantern(90.0, 56.0, 0xffdcb0, true),
                lantern(159.0, 55.0, 0xffc8cc, true),
                lantern(238.0, 30.0, 0xccdcff, true),
                lantern(156.0, 131.0, 0xffd4a0, true),
                lantern(280.0, 116.0, 0xc0ffdc, false),
            ],
            carried: Some(0),
            doors: DOORS.iter().map(door).collect(),
            steps: 0,
        };
        for i in [0, 4] {
            (room.doors[i].open, room.doors[i].opens) = (1.0, true);
        }
        room.carry();
        room
    }

    /// Brightness of the walker, 0 (dark) to 1: `L / (L + `[`HALF_LIT`]`)` of the
    /// luminance L of the mean light over the open cells around the walker.
    pub fn lit(&self, light: &Light) -> f32 {
        let reach = (RADIUS + 1.5) * self.unit();
        let [x, y] = self.walker;
        let mean = light.over([x - reach, y - reach], [x + reach, y + reach]);
        let luminance = srgb::luminance(mean).max(0.0);
        luminance / (luminance + HALF_LIT)
    }

    /// Position of the walker, in cells.
    pub fn walker(&self) -> [f32; 2] {
        self.walker
    }

    /// Returns true if the walker carries a lantern.
    pub fn carries(&self) -> bool {
        self.carried.is_some()
    }

    /// The number of doors that are open or opening.
    pub fn open_doors(&self) -> usize {
        self.doors.iter().filter(|door| door.opens).count()
    }

    /// Cells per px of the plan, along the smaller axis.
    fn unit(&self) -> f32 {
        (self.size[0] as f32 / LAYOUT[0]).min(self.size[1] as f32 / LAYOUT[1])
    }

    /// Returns true if a cell is a wall, furniture or a door, or lies outside of the grid.
    pub fn blocked(&self, x: i32, y: i32) -> bool {
        let inside = (0..self.size[0] as i32).contains(&x) && (0..self.size[1] as i32).contains(&y);
        if !inside {
            return true;
        }
        let index = y as usize * self.size[0] as usize + x as usize;
        if self.solid[index] {
            return true;
        }
        let at = [x as f32 + 0.5, y as f32 + 0.5];
        self.doors.iter().any(|door| within(&door.leaf(), at, 0.0))
    }

    /// Returns true if the walker fits at a point.
    fn free(&self, [x, y]: [f32; 2]) -> bool {
        let radius = RADIUS * self.unit();
        let span = |v: f32| (v - radius).floor() as i32..=(v + radius).floor() as i32;
        !span(y).any(|cy| {
            span(x).any(|cx| {
                let (dx, dy) = (cx as f32 + 0.5 - x, cy as f32 + 0.5 - y);
                dx * dx + dy * dy <= radius * radius && self.blocked(cx, cy)
            })
        })
    }

    /// Moves by half a cell at a time, along one axis and then the other, so that the walker slides along walls
    /// and never passes them.
    fn walk(&mut self, direction: [f32; 2]) {
        let length = direction[0].hypot(direction[1]);
        if !(length > 0.01 && length.is_finite()) {
            return;
        }
        self.facing = direction.map(|v| v / length);
        let way = PACE * self.unit() * length.min(1.0);
        let parts = (way / 0.5).ceil().max(1.0);
        for _ in 0..parts as u32 {
            for axis in 0..2 {
                let mut next = self.walker;
                next[axis] += self.facing[axis] * way / parts;
                if self.free(next) {
                    self.walker = next;
                }
            }
        }
    }

    /// Holds the carried lantern in front of the walker, or closer at a wall.
    fn carry(&mut self) {
        let Some(held) = self.carried else { return };
        let reach = |px: f32| {
            let px = px * self.unit();
            [self.walker[0] + self.facing[0] * px, self.walker[1] + self.facing[1] * px]
        };
        let clear = |at: &[f32; 2]| {
            [[-2.0, 0.0], [2.0, 0.0], [0.0, -2.0], [0.0, 2.0]].iter().all(|d| {
                let at = [at[0] + d[0] * self.unit(), at[1] + d[1] * self.unit()];
                !self.blocked(at[0].floor() as i32, at[1].floor() as i32)
            })
        };
        let at = [5.5, 4.0, 2.0].map(reach).into_iter().find(clear).unwrap_or(self.walker);
        self.lanterns[held].at = at;
    }

    /// Opens or closes the nearest door in reach. Without one, puts down or picks up a lantern.
    fn act(&mut self) {
        let reach = REACH * self.unit();
        let from_door = |door: &Door| {
            let [left, top, right, bottom] = door.area;
            apart(self.walker, [0.5 * (left + right), 0.5 * (top + bottom)])
        };
        let by_door = |a: &usize, b: &usize| {
            from_door(&self.doors[*a]).total_cmp(&from_door(&self.doors[*b]))
        };
        if let Some(i) = (0..self.doors.len()).min_by(by_door)
            && from_door(&self.doors[i]) < reach
        {
            self.doors[i].opens ^= true;
        } else if self.carried.is_none() {
            self.carried = self.nearest_lantern();
        } else {
            self.carried = None;
        }
    }

    fn nearest_lantern(&self) -> Option<usize> {
        let away = |i: usize| apart(self.walker, self.lanterns[i].at);
        let nearest = (0..self.lanterns.len()).min_by(|a, b| away(*a).total_cmp(&away(*b)))?;
        (away(nearest) < REACH * self.unit()).then_some(nearest)
    }

    fn slide_doors(&mut self) {
        let room = RADIUS * self.unit() + 1.0;
        for door in &mut self.doors {
            if door.opens {
                door.open = (door.open + SLIDE).min(1.0);
            } else if !within(&door.area, self.walker, room) {
                // A door does not close on the walker.
                door.open = (door.open - SLIDE).max(0.0);
            }
        }
    }
}

impl Door {
    /// The closed part. A door slides into the wall at its left or upper end.
    fn leaf(&self) -> [f32; 4] {
        let [left, top, right, bottom] = self.area;
        if self.along_x {
            [left, top, right - (right - left) * self.open, bottom]
        } else {
            [left, top, right, bottom - (bottom - top) * self.open]
        }
    }
}

fn within(area: &[f32; 4], [x, y]: [f32; 2], room: f32) -> bool {
    x > area[0] - room && x < area[2] + room && y > area[1] - room && y < area[3] + room
}

fn apart(a: [f32; 2], b: [f32; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

impl World for Room {
    fn size(&self) -> [u32; 2] {
        self.size
    }

    fn step(&mut self, input: &Input) {
        self.steps = self.steps.wrapping_add(1);
        if input.action {
            self.act();
        }
        if input.switch
            && let Some(i) = self.carried.or_else(|| self.nearest_lantern())
        {
            self.lanterns[i].on ^= true;
        }
        self.slide_doors();
        self.walk(input.direction);
        self.carry();
    }

    fn draw(&self, cells: &mut Cells) {
        if !fits(self.size, cells) {
            return;
        }
        copy(&self.still, cells);
        let unit = self.unit();
        for door in &self.doors {
            let [left, top, right, bottom] = door.leaf();
            for y in top.floor() as i32..bottom.ceil() as i32 {
                for x in left.floor() as i32..right.ceil() as i32 {
                    if within(&door.leaf(), [x as f32 + 0.5, y as f32 + 0.5], 0.0) {
                        Paint::wall(hex(0xc08048)).lay(cells, x, y, 1.0);
                    }
                }
            }
        }
        // The walker absorbs only part of the light, which gives a soft shadow.
        self.disc(
            cells,
            self.walker,
            RADIUS,
            Paint::fog(0.3, hex(0x8a4a6a)).colored(hex(0xd05a78)),
        );
        let head = [0, 1].map(|i| self.walker[i] + 0.6 * unit * self.facing[i]);
        self.disc(cells, head, 1.7, Paint::fog(0.3, hex(0xc09070)).colored(hex(0xf0c8a0)));
        cells.lamps_mut().clear();
        for (i, lantern) in self.lanterns.iter().enumerate() {
            if lantern.on {
                // Flames flicker.
                let t = self.steps as f32 / 60.0 * 6.0 + i as f32 * 2.1;
                let flicker = 1.0 + 0.05 * t.sin() + 0.03 * (2.7 * t).sin();
                cells.lamps_mut().push(Lamp {
                    position: lantern.at,
                    color: lantern.color,
                    intensity: 8.0 * flicker,
                    size: 1.6 * unit,
                    range: 130.0 * unit,
                    ..Lamp::default()
                });
            } else {
                self.disc(cells, lantern.at, 1.6, Paint::fog(0.4, scale(lantern.color, 0.7)));
            }
        }
    }

    fn help(&self) -> &'static str {
        "Walk with the arrow keys or WASD. Space opens doors, takes or puts down a lantern; F lights \
         it or puts it out."
    }

    fn look(&self) -> Look {
        Look {
            wall_depth: 5.0,
            display: Display { exposure: 0.8, ..Display::default() },
            ..Look::default()
        }
        .at_scale(self.unit())
    }

    fn has_player(&self) -> bool {
        true
    }

    fn lit(&self, light: &Light) -> Option<f32> {
        Some(Self::lit(self, light))
    }
}

impl Room {
    fn disc(&self, cells: &mut Cells, at: [f32; 2], radius: f32, paint: Paint) {
        let radius = radius * self.unit();
        Figure::Ball(radius).draw(cells, at, 0.0, |_, _| paint.at_scale(self.unit()));
    }
}
