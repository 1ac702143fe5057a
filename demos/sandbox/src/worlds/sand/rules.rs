//! The rules of motion and interaction, one cell at a time.

use super::element::{Element, Flow};
use super::{Grain, Sand};

/// Offsets of the four neighbours.
const BESIDE: [[i32; 2]; 4] = [[0, 1], [1, 0], [0, -1], [-1, 0]];

/// Mean number of passes until sand beside lava melts.
const MELTS: u32 = 90;
/// Mean number of passes between sparks of a cell of lava.
const SPARKS: u32 = 2400;
/// Mean number of passes until a plant beside water grows.
const DRINKS: u32 = 160;
/// Mean number of passes between moves of lava, unless it falls.
const LAVA_CREEPS: u32 = 4;
/// Mean number of passes until a burning cell emits a flame into a free neighbour.
const FLAMES: u32 = 5;
/// The largest number of plants around a cell that a plant grows into, which keeps plants sparse.
const CROWDED: usize = 3;

impl Sand {
    /// Runs one pass over all cells, from the bottom row up and with alternating directions. Grains fall by a
    /// cell, without drift to either side.
    pub(super) fn move_all(&mut self) {
        self.tick = self.tick.wrapping_add(1);
        let (w, h) = (self.width, self.height);
        for y in (0..h).rev() {
            let backwards = (self.tick as i32 ^ y) & 1 == 0;
            for k in 0..w {
                let x = if backwards { w - 1 - k } else { k };
                let grain = self.grains[(y * w + x) as usize];
                let rests = RESTS[grain.element as usize] && grain.life == 0;
                if rests || grain.stamp == self.tick {
                    continue;
                }
                self.move_one(x, y, grain);
            }
        }
    }

    fn move_one(&mut self, x: i32, y: i32, mut grain: Grain) {
        let nature = grain.element.nature();
        if nature.life > 0 && grain.life > 0 {
            // Randomness separates the ends of lifetimes that began together.
            let one_in = if nature.burns > 0 { 4 } else { 2 };
            grain.life -= u8::from(self.random.once_in(one_in));
            if grain.life == 0 {
                return self.ends(x, y, grain.element);
            }
            self.set(x, y, grain);
        }
        if self.acts(x, y, grain) {
            return;
        }
        match nature.flow {
            Flow::Fixed => {}
            Flow::Powder => {
                self.falls(x, y, grain);
            }
            Flow::Liquid(reach) => {
                let drops = self.element(x, y + 1) == Some(Element::Empty);
                let thick = grain.element == Element::Lava && !drops;
                if thick && !self.random.once_in(LAVA_CREEPS) {
                    return;
                }
                if !self.falls(x, y, grain) {
                    self.spreads(x, y, grain, reach);
                }
            }
            Flow::Gas => self.rises(x, y, grain),
        }
    }

    /// Moves a grain down or diagonally down, through lighter elements that flow.
    fn falls(&mut self, x: i32, y: i32, grain: Grain) -> bool {
        let side = if self.random.bits() & 1 == 0 { 1 } else { -1 };
        // Diagonally only past a free side, so that nothing passes through a slanted wall.
        self.swaps(x, y, x, y + 1, grain)
            || (self.passes(x + side, y, grain) && self.swaps(x, y, x + side, y + 1, grain))
            || (self.passes(x - side, y, grain) && self.swaps(x, y, x - side, y + 1, grain))
    }

    fn spreads(&mut self, x: i32, y: i32, grain: Grain, reach: i32) {
        let side = if self.random.bits() & 1 == 0 { 1 } else { -1 };
        let mut to = x;
        for step in 1..=reach {
            let next = x + side * step;
            if !self.passes(next, y, grain) {
                break;
            }
            to = next;
            if self.passes(next, y + 1, grain) {
                break;
            }
        }
        if to != x {
            self.swaps(x, y, to, y, grain);
        }
    }

    fn rises(&mut self, x: i32, y: i32, grain: Grain) {
        let chance = self.random.bits();
        let side = [-1, 0, 0, 1][(chance & 3) as usize];
        if chance & 12 == 0 {
            return; // occasionally it does not move
        }
        if !self.floats(x, y, x + side, y - 1, grain) && !self.floats(x, y, x, y - 1, grain) {
            let side = if chance & 16 == 0 { 1 } else { -1 };
            self.floats(x, y, x + side, y, grain);
        }
    }

    /// Returns true if a grain can sink into a cell.
    #[inline]
    fn passes(&self, x: i32, y: i32, grain: Grain) -> bool {
        let Some(there) = self.at(x, y) else { return false };
        let nature = there.element.nature();
        let fluid = there.element == Element::Empty || nature.flow != Flow::Fixed;
        fluid && nature.density < grain.element.nature().density
    }

    #[inline]
    fn swaps(&mut self, x: i32, y: i32, to_x: i32, to_y: i32, grain: Grain) -> bool {
        self.passes(to_x, to_y, grain) && {
            self.exchange(x, y, to_x, to_y, grain);
            true
        }
    }

    fn floats(&mut self, x: i32, y: i32, to_x: i32, to_y: i32, grain: Grain) -> bool {
        // Up through air and liquids, which take its place.
        let free = self.at(to_x, to_y).is_some_and(|there| {
            there.element == Element::Empty
                || matches!(there.element.nature().flow, Flow::Liquid(_))
                    && to_y < y
                    && there.element != Element::Lava
        });
        if free {
            self.exchange(x, y, to_x, to_y, grain);
        }
        free
    }

    fn exchange(&mut self, x: i32, y: i32, to_x: i32, to_y: i32, grain: Grain) {
        let (from, to) = ((y * self.width + x) as usize, (to_y * self.width + to_x) as usize);
        self.grains[from] = self.grains[to];
        self.grains[to] = Grain { stamp: self.tick, ..grain };
    }

    /// Replaces a grain at the end of its lifetime.
    fn ends(&mut self, x: i32, y: i32, element: Element) {
        let next = match element {
            Element::Fire | Element::Oil | Element::Wood if self.random.once_in(3) => {
                Element::Smoke
            }
            Element::Steam if self.random.once_in(3) => Element::Water,
            _ => Element::Empty,
        };
        self.place(x, y, next);
    }

    /// Applies a grain to a random neighbour. Returns whether the grain was replaced.
    fn acts(&mut self, x: i32, y: i32, grain: Grain) -> bool {
        let [dx, dy] = BESIDE[(self.random.bits() & 3) as usize];
        let (nx, ny) = (x + dx, y + dy);
        let Some(there) = self.at(nx, ny) else { return false };
        let burns = there.element.nature().burns;
        match (grain.element, there.element) {
            (Element::Lava, Element::Water) => {
                self.place(x, y, Element::Stone);
                self.place(nx, ny, Element::Steam);
                return true;
            }
            (Element::Lava, Element::Sand) if self.random.once_in(MELTS) => {
                self.place(nx, ny, Element::Glass);
            }
            (Element::Lava, Element::Empty) if dy < 0 && self.random.once_in(SPARKS) => {
                self.place(nx, ny, Element::Fire);
            }
            (Element::Fire, Element::Water) => {
                self.place(x, y, Element::Steam);
                return true;
            }
            (Element::Lava | Element::Fire, _) if burns > 0 && self.random.once_in(burns) => {
                self.ignites(nx, ny, there);
            }
            (Element::Oil | Element::Wood, _) if grain.life > 0 => {
                if there.element == Element::Empty && dy <= 0 && self.random.once_in(FLAMES) {
                    self.place(nx, ny, Element::Fire);
                } else if burns > 0 && there.life == 0 && self.random.once_in(burns) {
                    self.ignites(nx, ny, there);
                }
            }
            (Element::Plant, Element::Water) if grain.life > 0 && self.random.once_in(DRINKS) => {
                self.drinks([x, y], [nx, ny], grain);
            }
            _ => {}
        }
        false
    }

    /// Ignites a cell. Plants become fire at once; oil and wood burn for a while.
    fn ignites(&mut self, x: i32, y: i32, there: Grain) {
        if there.element == Element::Plant {
            self.place(x, y, Element::Fire);
        } else if there.life == 0 {
            self.set(x, y, Grain { life: there.element.nature().life, ..there });
        }
    }

    /// Lets a plant absorb a cell of water, if it has space to grow.
    fn drinks(&mut self, [x, y]: [i32; 2], [nx, ny]: [i32; 2], grain: Grain) {
        // The shoot may have replaced the water.
        if self.grows(x, y, grain) && self.element(nx, ny) == Some(Element::Water) {
            self.place(nx, ny, Element::Empty);
        }
    }

    /// Adds a shoot to a plant, upwards or diagonally, with a shorter life. Returns whether there was space.
    fn grows(&mut self, x: i32, y: i32, grain: Grain) -> bool {
        let chance = self.random.bits();
        let side = (chance % 3) as i32 - 1;
        for reach in 1..=24 {
            // The first free cell along the stem.
            let (nx, ny) = (x + if reach == 1 { side } else { 0 }, y - reach);
            match self.at(nx, ny).map(|there| there.element) {
                Some(Element::Plant) => {}
                Some(Element::Empty | Element::Water) => {
                    let room = self.plants_round(nx, ny) <= CROWDED;
                    if room {
                        self.place(nx, ny, Element::Plant);
                        let shoot = self.at(nx, ny).unwrap_or_default();
                        self.set(nx, ny, Grain { life: grain.life - 1, ..shoot });
                    }
                    return room;
                }
                _ => return false,
            }
        }
        false
    }

    fn plants_round(&self, x: i32, y: i32) -> usize {
        let round = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
        round.filter(|&(x, y)| self.at(x, y).is_some_and(|g| g.element == Element::Plant)).count()
    }
}

/// True for each element that neither moves nor acts by itself.
const RESTS: [bool; 13] = {
    let mut rests = [false; 13];
    let mut i = 0;
    while i < rests.len() {
        let element = Element::ALL[i];
        rests[i] =
            matches!(element.nature().flow, Flow::Fixed) && !matches!(element, Element::Plant);
        i += 1;
    }
    rests
};
