//! Regular and random grids, and differences between two lights.

// Each test program uses its own part of this.
#![allow(dead_code)]

use fastrand::Rng;
use lamplight::settings::{Denoise, Raymarch};
use lamplight::{Cells, Falloff, Lamp, Light, Matter, Method, Rgb, Settings, Sky, Solver};

/// A black wall.
pub const WALL: Matter = Matter { opacity: 1.0, ..Matter::EMPTY };
/// A black wall that glows with radiance 1.
pub const GLOW: Matter = Matter { emission: [1.0; 3], ..WALL };

/// A lamp of radiance 1 at the corner; the methods that light by rule let it fade to the range in a straight
/// line.
pub const LAMP: Lamp = Lamp {
    position: [0.0; 2],
    color: [1.0; 3],
    intensity: 1.0,
    range: 128.0,
    size: 2.0,
    falloff: Falloff::Linear,
    cone: None,
    cookie: None,
    height: None,
    direct: lamplight::Direct::Glow,
    mask: lamplight::ALL_LAYERS,
    solid: false,
    visible: false,
};

/// Settings of `raymarch` without the blur.
pub fn unfiltered(raymarch: Raymarch) -> Raymarch {
    Raymarch { denoise: Denoise { passes: 0, ..raymarch.denoise }, ..raymarch }
}

/// A random number generator with this seed, printed so that a failure can be repeated.
pub fn seeded(seed: u64) -> Rng {
    println!("seed {seed}");
    Rng::with_seed(seed)
}

/// A random number generator with a new seed in each run, printed so that a failure can be repeated.
pub fn fresh() -> Rng {
    seeded(fastrand::u64(..))
}

/// A random value in [0, 1) per channel.
pub fn rgb(random: &mut Rng) -> Rgb {
    [random.f32(), random.f32(), random.f32()]
}

/// A grid whose cells are given by `matter`.
pub fn grid(width: u32, height: u32, mut matter: impl FnMut(u32, u32) -> Matter) -> Cells {
    let mut cells = Cells::new(width, height).unwrap();
    for y in 0..height {
        for x in 0..width {
            cells.set(x, y, matter(x, y));
        }
    }
    cells
}

/// An empty room with a wall of one kind all round.
pub fn room(width: u32, height: u32, wall: Matter) -> Cells {
    grid(width, height, |x, y| {
        let edge = x == 0 || y == 0 || x == width - 1 || y == height - 1;
        if edge { wall } else { Matter::EMPTY }
    })
}

/// Walls, fog, glass and lights, in no order, under a dim sky.
pub fn jumble(width: u32, height: u32, seed: u64) -> Cells {
    let random = &mut seeded(seed);
    let mut cells = grid(width, height, |_, _| {
        let glow = if random.f32() < 0.3 { rgb(random) } else { [0.0; 3] };
        let (albedo, tint, kind) = (rgb(random), rgb(random), random.f32());
        match kind {
            k if k < 0.15 => Matter { emission: glow, albedo, ..WALL },
            k if k < 0.25 => {
                Matter { emission: glow, opacity: random.f32(), albedo, tint, ..Matter::EMPTY }
            }
            k if k < 0.3 => Matter { tint, ..Matter::EMPTY },
            _ => Matter::EMPTY,
        }
    });
    cells.set_sky(Sky::Uniform([0.125, 0.0625, 0.25]));
    cells
}

/// The grid with other emission, under the sky of [`jumble`] times `sky`.
pub fn relit(cells: &Cells, emission: impl Fn(usize, Rgb) -> Rgb, sky: f32) -> Cells {
    let mut cells = cells.clone();
    for (i, e) in cells.emission_mut().iter_mut().enumerate() {
        *e = emission(i, *e);
    }
    cells.set_sky(Sky::Uniform([0.125, 0.0625, 0.25].map(|v| v * sky)));
    cells
}

/// Panics unless a value is the expected one, within a relative tolerance.
#[track_caller]
pub fn near(value: f32, expected: f64, tolerance: f64) {
    let off = (f64::from(value) / expected - 1.0).abs();
    assert!(off <= tolerance, "{value} is not {expected}: {off} off, {tolerance} allowed");
}

/// Settings of `raymarch` for direct light that differ from the defaults in a few keys.
pub fn settings(change: impl FnOnce(&mut Settings)) -> Settings {
    let mut settings = Settings::direct(Method::Raymarch);
    change(&mut settings);
    settings
}

/// The settings of `raymarch`, to be changed.
pub fn raymarch_of(settings: &mut Settings) -> &mut Raymarch {
    settings.method.as_raymarch_mut().expect("settings of raymarch")
}

/// The first frame of a new solver.
pub fn solve(settings: &Settings, cells: &Cells) -> Light {
    Solver::new(settings.clone()).unwrap().solve(cells).unwrap().clone()
}

/// Panics unless light is proportional to emission, and in open cells the light of two parts of the emission
/// adds up to that of all, within `rounding`, relative. Walls show the brighter of two emissions.
pub fn expect_linear_in_emission(settings: &Settings, rounding: f32) {
    for seed in 1..4 {
        let cells = jumble(31, 22, seed);
        let once = solve(settings, &cells);
        for factor in [0.25, 8.0] {
            let bright = relit(&cells, |_, e| e.map(|v| factor * v), factor);
            let expected: Vec<Rgb> = once.pixels().iter().map(|p| p.map(|v| factor * v)).collect();
            assert!(solve(settings, &bright).pixels() == expected, "seed {seed}, {factor}");
        }
        let part = |keep: usize, sky: f32| {
            let some = |i: usize, e: Rgb| if i % 2 == keep { e } else { [0.0; 3] };
            solve(settings, &relit(&cells, some, sky))
        };
        let (even, odd) = (part(0, 1.0), part(1, 0.0));
        let open = |(i, _): &(usize, &Rgb)| !cells.is_solid(*i);
        for (i, all) in once.pixels().iter().enumerate().filter(open) {
            for c in 0..3 {
                let sum = even.pixels()[i][c] + odd.pixels()[i][c];
                assert!((sum - all[c]).abs() <= rounding * all[c], "cell {i}: {sum}, {all:?}");
                // Light never darkens.
                assert!(even.pixels()[i][c] <= all[c] * (1.0 + rounding), "cell {i}");
            }
        }
    }
}

/// Root of the mean squared difference over open cells and channels ÷ the mean of `truth` there.
pub fn relative_rmse(light: &Light, truth: &Light) -> f64 {
    let (mut squares, mut sum) = (0.0, 0.0);
    let mut count = 0;
    for i in (0..truth.pixels().len()).filter(|&i| !truth.solid()[i]) {
        for c in 0..3 {
            let (a, b) = (f64::from(light.pixels()[i][c]), f64::from(truth.pixels()[i][c]));
            squares += (a - b).powi(2);
            sum += b;
            count += 1;
        }
    }
    (squares / f64::from(count)).sqrt() / (sum / f64::from(count))
}

/// Rotates a grid by a quarter: (x, y) becomes (height − 1 − y, x).
pub fn turned(cells: &Cells) -> Cells {
    let (w, h) = (cells.width(), cells.height());
    let mut turned = grid(h, w, |x, y| cells.get(y, h - 1 - x).unwrap());
    turned.set_sky(cells.sky().clone());
    turned
}

/// Every bit of a picture.
pub fn bits(light: &Light) -> Vec<u32> {
    light.pixels().as_flattened().iter().map(|v| v.to_bits()).collect()
}

/// The contact between neighbouring cells of the wall around a room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// Each cell of the wall touches the next by a side.
    Sides,
    /// By a side or by a corner only.
    Corners,
}

/// A room of random shape in empty space, closed by a wall one cell thick.
pub struct Sealed {
    pub width: u32,
    /// Cells of the room, joined by their sides.
    pub inside: Vec<bool>,
    /// Cells of the wall round it; the border of the grid closes it too.
    pub wall: Vec<bool>,
}

impl Sealed {
    /// A room of `size` cells or as many as there are.
    pub fn new(random: &mut Rng, [width, height]: [u32; 2], size: usize, contact: Contact) -> Self {
        let n = (width * height) as usize;
        let mut inside = vec![false; n];
        let mut front = vec![random.usize(..n)];
        let mut left = size.min(n);
        while left > 0 {
            let cell = front.swap_remove(random.usize(..front.len()));
            if !inside[cell] {
                inside[cell] = true;
                left -= 1;
                front.extend(around(width, height, cell, Contact::Sides).filter(|&i| !inside[i]));
            }
        }
        // A wall that holds by its sides also needs the cells across the room's corners.
        let reach = match contact {
            Contact::Sides => Contact::Corners,
            Contact::Corners => Contact::Sides,
        };
        let touches = |i| around(width, height, i, reach).any(|j| inside[j]);
        let wall = (0..n).map(|i| !inside[i] && touches(i)).collect();
        Self { width, inside, wall }
    }

    /// The grid with only its wall, of this matter.
    pub fn grid(&self, wall: Matter) -> Cells {
        let height = self.wall.len() as u32 / self.width;
        let cell = |x, y| (y * self.width + x) as usize;
        grid(self.width, height, |x, y| if self.wall[cell(x, y)] { wall } else { Matter::EMPTY })
    }

    /// Indices of the cells of the room.
    pub fn room(&self) -> Vec<usize> {
        (0..self.inside.len()).filter(|&i| self.inside[i]).collect()
    }

    /// Returns a random cell of each side of the wall that has any, with all cells of the other side.
    pub fn sides(&self, random: &mut Rng) -> Vec<(usize, Vec<usize>)> {
        let outside: Vec<usize> = (0..self.inside.len()).filter(|&i| self.is_outside(i)).collect();
        let sides = [(self.room(), outside.clone()), (outside, self.room())];
        let some = sides.into_iter().filter(|(cells, _)| !cells.is_empty());
        some.map(|(cells, others)| (cells[random.usize(..cells.len())], others)).collect()
    }

    pub fn is_outside(&self, i: usize) -> bool {
        !self.inside[i] && !self.wall[i]
    }
}

/// Neighbours of a cell by its sides, or by sides and corners.
pub fn around(
    width: u32,
    height: u32,
    cell: usize,
    contact: Contact,
) -> impl Iterator<Item = usize> {
    let (w, h) = (width as i64, height as i64);
    let (x, y) = (cell as i64 % w, cell as i64 / w);
    (-1..=1).flat_map(move |dy| (-1..=1).map(move |dx| (dx, dy))).filter_map(move |(dx, dy)| {
        let steps = i64::abs(dx) + i64::abs(dy);
        let near = steps == 1 || steps == 2 && contact == Contact::Corners;
        let (x, y) = (x + dx, y + dy);
        let inside = (0..w).contains(&x) && (0..h).contains(&y);
        (near && inside).then_some((y * w + x) as usize)
    })
}

/// The places of the whole numbers in a text.
pub fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let mut found: Vec<std::ops::Range<usize>> = Vec::new();
    for (at, _) in text.bytes().enumerate().filter(|(_, byte)| byte.is_ascii_digit()) {
        match found.last_mut() {
            Some(last) if last.end == at => last.end = at + 1,
            _ => found.push(at..at + 1),
        }
    }
    found
}
