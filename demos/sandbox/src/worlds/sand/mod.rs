//! Falling sand: elements that fall, flow, rise, burn, grow and emit light.
//!
//! A cell is four bytes. A pass visits every cell once, in place. Randomness depends only on the seed.

mod element;
mod rules;
mod scene;

pub use element::{Element, Flow, Nature};

use super::world::{Input, World, fits};
use crate::look::Look;
use crate::paint::Paint;
use crate::random::Random;
use element::{BURNING, LOOKS};
use lamplight::{Cells, Display, Rgb, Sky};

/// One cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
struct Grain {
    element: Element,
    /// Remaining passes (for flammable elements, once they burn), or remaining shoots of a plant.
    life: u8,
    /// Index of its look.
    shade: u8,
    /// The pass in which it last moved.
    stamp: u8,
}

/// A falling-sand world.
#[derive(Clone, Debug)]
pub struct Sand {
    width: i32,
    height: i32,
    grains: Vec<Grain>,
    /// Colours behind air.
    backdrop: Vec<Rgb>,
    paints: Vec<[Paint; LOOKS]>,
    random: Random,
    tick: u8,
    steps: u32,
    /// Cells below the ceiling from which water drips.
    drips: Vec<[i32; 2]>,
    pointer: Option<[f32; 2]>,
    sky: Sky,
}

/// Passes per step; grains fall a cell per pass.
const PASSES: u32 = 2;
/// Mean number of steps between drops of a drip.
const DRIPS: u32 = 50;
/// Shoots of a new plant.
const SHOOTS: u8 = 40;
/// Columns and rows of the layout of the first cave.
const LAYOUT: [f32; 2] = [320.0, 180.0];

/// Cells per layout px, along the smaller axis.
fn unit([width, height]: [u32; 2]) -> f32 {
    (width as f32 / LAYOUT[0]).min(height as f32 / LAYOUT[1])
}

impl Sand {
    /// A world of air.
    ///
    /// # Panics
    /// If `size` is not a size of a grid.
    pub fn empty([width, height]: [u32; 2], seed: u64) -> Self {
        assert!(Cells::check_size(width.into(), height.into()).is_ok(), "{width}×{height}");
        let n = width as usize * height as usize;
        let unit = unit([width, height]);
        let looks = |e: Element| std::array::from_fn(|look| e.paint(look).at_scale(unit));
        Self {
            width: width as i32,
            height: height as i32,
            grains: vec![Grain::default(); n],
            backdrop: vec![[0.35, 0.33, 0.45]; n],
            paints: Element::ALL.map(looks).to_vec(),
            random: Random::new(seed),
            tick: 0,
            steps: 0,
            drips: Vec::new(),
            pointer: None,
            sky: Sky::BLACK,
        }
    }

    /// The element of cell (x, y); `None` outside of the grid.
    pub fn element(&self, x: i32, y: i32) -> Option<Element> {
        self.at(x, y).map(|grain| grain.element)
    }

    /// The number of cells of an element.
    pub fn count(&self, element: Element) -> usize {
        self.grains.iter().filter(|grain| grain.element == element).count()
    }

    /// Pours an element over a disc: flowing elements into half of the free cells, solid ones into all. `Empty`
    /// clears.
    pub fn pour(&mut self, [x, y]: [f32; 2], radius: f32, element: Element) {
        let radius = radius.clamp(0.5, 64.0);
        let far = self.width.max(self.height) as f32;
        if !(x.abs() <= far && y.abs() <= far) {
            return;
        }
        let rows = (y - radius).floor() as i32..=(y + radius).ceil() as i32;
        for cy in rows {
            for cx in (x - radius).floor() as i32..=(x + radius).ceil() as i32 {
                let (dx, dy) = (cx as f32 + 0.5 - x, cy as f32 + 0.5 - y);
                let Some(there) = self.element(cx, cy) else { continue };
                let takes = match element {
                    Element::Empty => true,
                    _ if element.pours() => there == Element::Empty && self.random.once_in(2),
                    _ => there != element,
                };
                if dx * dx + dy * dy <= radius * radius && takes {
                    self.place(cx, cy, element);
                }
            }
        }
    }

    fn unit(&self) -> f32 {
        unit([self.width as u32, self.height as u32])
    }

    #[inline]
    fn at(&self, x: i32, y: i32) -> Option<Grain> {
        let inside = (0..self.width).contains(&x) && (0..self.height).contains(&y);
        inside.then(|| self.grains[(y * self.width + x) as usize])
    }

    fn set(&mut self, x: i32, y: i32, grain: Grain) {
        if (0..self.width).contains(&x) && (0..self.height).contains(&y) {
            self.grains[(y * self.width + x) as usize] = grain;
        }
    }

    /// Places a new grain.
    fn place(&mut self, x: i32, y: i32, element: Element) {
        let chance = self.random.bits();
        let life = match element {
            Element::Plant => SHOOTS,
            Element::Oil | Element::Wood => 0,
            _ => {
                let full = u32::from(element.nature().life);
                (full - (full / 2 * (chance >> 8 & 255)) / 256) as u8
            }
        };
        let shade = (chance as usize % LOOKS) as u8;
        self.set(x, y, Grain { element, life, shade, stamp: self.tick });
    }

    /// The index of the current look of a grain.
    #[inline]
    fn look_of(&self, grain: Grain) -> usize {
        match grain.element {
            // Elements that age look like their age.
            Element::Fire | Element::Smoke | Element::Steam => {
                let full = usize::from(grain.element.nature().life);
                (usize::from(grain.life) * LOOKS / (full + 1)).min(LOOKS - 1)
            }
            // Lava pulsates through its variants.
            Element::Lava => {
                let phase = (usize::from(grain.shade) * 2 + self.steps as usize / 12) % (2 * LOOKS);
                if phase < LOOKS { phase } else { 2 * LOOKS - 1 - phase }
            }
            Element::Oil | Element::Wood if grain.life > 0 => BURNING,
            Element::Oil | Element::Wood => usize::from(grain.shade) % BURNING,
            _ => usize::from(grain.shade) % LOOKS,
        }
    }
}

impl World for Sand {
    fn size(&self) -> [u32; 2] {
        [self.width as u32, self.height as u32]
    }

    fn step(&mut self, input: &Input) {
        if let (true, Some(to)) = (input.pressed || input.just_pressed, input.pointer) {
            let element = Element::ALL.get(input.brush).copied().unwrap_or_default();
            // Fast strokes have no gaps.
            let from = if input.just_pressed { to } else { self.pointer.unwrap_or(to) };
            let radius = if input.radius.is_finite() { input.radius } else { 1.0 };
            let apart = (to[0] - from[0]).hypot(to[1] - from[1]);
            let dabs = (apart / radius.clamp(1.0, 64.0)).clamp(1.0, 256.0) as u32;
            for k in 1..=dabs {
                let t = k as f32 / dabs as f32;
                let at = |i: usize| from[i] + (to[i] - from[i]) * t;
                self.pour([at(0), at(1)], radius, element);
            }
            self.pointer = Some(to);
        } else {
            self.pointer = None;
        }
        for i in 0..self.drips.len() {
            let [x, y] = self.drips[i];
            if self.random.once_in(DRIPS) && self.element(x, y) == Some(Element::Empty) {
                self.place(x, y, Element::Water);
            }
        }
        (0..PASSES).for_each(|_| self.move_all());
        self.steps = self.steps.wrapping_add(1);
    }

    fn draw(&self, cells: &mut Cells) {
        if !fits(self.size(), cells) {
            return;
        }
        for (i, &grain) in self.grains.iter().enumerate() {
            let paint = &self.paints[grain.element as usize][self.look_of(grain)];
            cells.set_matter(i, paint.matter);
        }
        let color = cells.color_mut();
        for ((color, &grain), &backdrop) in color.iter_mut().zip(&self.grains).zip(&self.backdrop) {
            *color = match grain.element {
                Element::Empty => backdrop,
                // The backdrop is visible through thin elements.
                Element::Smoke | Element::Steam => {
                    let paint = &self.paints[grain.element as usize][0];
                    std::array::from_fn(|c| 0.8 * backdrop[c] + 0.2 * paint.color[c])
                }
                _ => self.paints[grain.element as usize][self.look_of(grain)].color,
            };
        }
        cells.lamps_mut().clear();
        cells.set_sky(self.sky.clone());
    }

    fn help(&self) -> &'static str {
        "Choose an element and pour it with the pointer; see what it does to the others."
    }

    fn brushes(&self) -> &'static [&'static str] {
        &Element::NAMES
    }

    fn look(&self) -> Look {
        Look {
            wall_depth: 44.0,
            display: Display { exposure: 1.0, ..Display::default() },
            ..Look::default()
        }
        .at_scale(self.unit())
    }
}
