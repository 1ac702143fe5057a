//! The spatio-temporal blue-noise texture.
//!
//! Void and cluster (Ulichney 1993) over a stack of slices, one a frame. Two chosen pixels repel
//! each other by a Gaussian of their distance when they lie in the same slice, by a Gaussian of
//! their distance in time when they lie at the same place, and not at all otherwise (Wolfe,
//! Morrical, Akenine-Möller, Ramamoorthi 2022). Both distances go round: the texture tiles in
//! space and in time. So every slice is blue over space and every pixel is blue over time.
//!
//! Energies are whole numbers, so that every machine makes the same texture.

use crate::generated::{self, Mode};
use crate::random::Random;
use anyhow::Result;

/// Side of a slice, px. The reader in `math/noise.rs` fails to compile with any other length.
const SIDE: usize = 64;
/// Slices.
const FRAMES: usize = 16;
const SLICE: usize = SIDE * SIDE;
const COUNT: usize = SLICE * FRAMES;
/// Standard deviation of both Gaussians, px and frames (Ulichney's 1.5 clumps; Wolfe et al. 1.9).
const SIGMA: f64 = 1.9;
/// The energy of two pixels at distance 0.
const UNIT: f64 = (1 << 24) as f64;
/// One pixel in this many belongs to the pattern that the ranking starts from.
const SPARSENESS: usize = 10;
const SEED: u64 = 1993;

pub fn run(mode: Mode) -> Result<()> {
    // A grey PGM: a picture for viewers, and bytes at a fixed offset for the program.
    let mut file = format!("P5\n{SIDE} {}\n255\n", SIDE * FRAMES).into_bytes();
    file.extend(values(&ranks()));
    generated::bytes(mode, "crates/lamplight/src/math/blue_noise.pgm", &file, "noise")
}

/// Ranks over the whole stack, made into equally frequent bytes in each slice.
fn values(ranks: &[u32]) -> Vec<u8> {
    let mut values = vec![0; COUNT];
    for (slice, values) in ranks.chunks(SLICE).zip(values.chunks_mut(SLICE)) {
        let mut order: Vec<usize> = (0..SLICE).collect();
        order.sort_by_key(|&i| slice[i]);
        for (rank, i) in order.into_iter().enumerate() {
            values[i] = (rank * 256 / SLICE) as u8;
        }
    }
    values
}

fn ranks() -> Vec<u32> {
    let mut start = Pattern::new();
    let mut random = Random::new(SEED);
    while start.chosen < COUNT / SPARSENESS {
        let i = random.below(COUNT);
        if !start.on[i] {
            start.flip(i);
        }
    }
    // Move the pixel in the tightest cluster to the largest void until it would move back.
    loop {
        let cluster = start.tightest_cluster();
        start.flip(cluster);
        let void = start.largest_void();
        start.flip(void);
        if void == cluster {
            break;
        }
    }
    let mut ranks = vec![0; COUNT];
    let mut down = start.clone();
    while down.chosen > 0 {
        let cluster = down.tightest_cluster();
        down.flip(cluster);
        ranks[cluster] = down.chosen as u32;
    }
    // Past one half Ulichney fills the tightest cluster of unchosen pixels: as all energies add up
    // to the same everywhere, that is the largest void of the chosen ones too.
    let mut up = start;
    while up.chosen < COUNT {
        let void = up.largest_void();
        ranks[void] = up.chosen as u32;
        up.flip(void);
    }
    ranks
}

#[derive(Clone)]
struct Pattern {
    on: Vec<bool>,
    chosen: usize,
    /// Sum of the chosen pixels' repulsion at each pixel.
    energy: Vec<u32>,
    space: Vec<u32>,
    time: Vec<u32>,
}

impl Pattern {
    fn new() -> Self {
        let gauss =
            |d2: usize| (UNIT * (-(d2 as f64) / (2.0 * SIGMA * SIGMA)).exp()).round() as u32;
        let round = |d: usize, n: usize| d.min(n - d).pow(2);
        let space = (0..SLICE).map(|i| gauss(round(i % SIDE, SIDE) + round(i / SIDE, SIDE)));
        // The pixel itself is counted once, by `space`.
        let time = (0..FRAMES).map(|t| if t == 0 { 0 } else { gauss(round(t, FRAMES)) });
        Self {
            on: vec![false; COUNT],
            chosen: 0,
            energy: vec![0; COUNT],
            space: space.collect(),
            time: time.collect(),
        }
    }

    /// Chooses a pixel, or gives it back.
    fn flip(&mut self, i: usize) {
        let add = !self.on[i];
        self.on[i] = add;
        self.chosen = if add { self.chosen + 1 } else { self.chosen - 1 };
        let change = |energy: &mut u32, by: u32| {
            *energy = if add { *energy + by } else { *energy - by };
        };
        let (frame, place) = (i / SLICE, i % SLICE);
        let (x, y) = (place % SIDE, place / SIDE);
        for row in 0..SIDE {
            let kernel = &self.space[(row + SIDE - y) % SIDE * SIDE..][..SIDE];
            let line = &mut self.energy[frame * SLICE + row * SIDE..][..SIDE];
            let (left, right) = line.split_at_mut(x);
            right.iter_mut().zip(kernel).for_each(|(e, k)| change(e, *k));
            left.iter_mut().zip(&kernel[SIDE - x..]).for_each(|(e, k)| change(e, *k));
        }
        for t in 0..FRAMES {
            let by = self.time[(t + FRAMES - frame) % FRAMES];
            change(&mut self.energy[t * SLICE + place], by);
        }
    }

    fn tightest_cluster(&self) -> usize {
        let chosen = (0..COUNT).filter(|&i| self.on[i]);
        chosen.max_by_key(|&i| self.energy[i]).expect("a pixel is chosen")
    }

    fn largest_void(&self) -> usize {
        let free = (0..COUNT).filter(|&i| !self.on[i]);
        free.min_by_key(|&i| self.energy[i]).expect("a pixel is free")
    }
}
