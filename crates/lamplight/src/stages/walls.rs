//! The appearance of solid cells: light fades from the faces inwards, and emission is added.
//!
//! A wall is lit on its faces only, and its inside would be black. So the light of the face
//! cells is spread inwards over `depth` px: a cell k px behind a face shows
//! `max(0, 1 − k/(depth + 1))` of the mean light of the cells before it. This is presentation, not
//! transport: no ray ever sees it.

use crate::{Cells, Rgb};

/// Buffers for [`Walls::sink`], kept between frames.
#[derive(Debug, Default)]
pub struct Walls {
    /// The cells of the last completed ring.
    front: Vec<u32>,
    next: Vec<u32>,
    solid: Vec<u32>,
    /// 0 if not reached, otherwise 1 + the ring.
    ring: Vec<u8>,
}

impl Walls {
    /// Completes `light` in solid cells. Solid cells that touch an open one must hold the mean light of
    /// their faces; the others are overwritten. Light fades inwards over `depth` px, and emission is
    /// added.
    pub fn sink(&mut self, cells: &Cells, depth: f32, light: &mut [Rgb]) {
        self.ring.clear();
        self.ring.resize(cells.len(), 0);
        self.front.clear();
        self.solid.clear();
        cells.for_each_solid(|i| {
            self.solid.push(i as u32);
            if neighbours(cells, i).any(|n| !cells.is_solid(n)) {
                self.ring[i] = 1;
                self.front.push(i as u32);
            } else {
                light[i] = [0.0; 3];
            }
        });
        for step in 1..=depth.ceil() as u8 {
            self.next_ring(cells, step + 1, light);
            std::mem::swap(&mut self.front, &mut self.next);
        }
        for i in self.solid.iter().map(|&i| i as usize) {
            let behind = self.ring[i].saturating_sub(1) as f32;
            let fade = (1.0 - behind / (depth + 1.0)).max(0.0);
            let emission = cells.emission()[i];
            light[i] = std::array::from_fn(|c| light[i][c] * fade + emission[c]);
        }
    }

    /// Sets cells that touch the front by a side or a corner to the mean of the rings before them.
    fn next_ring(&mut self, cells: &Cells, ring: u8, light: &mut [Rgb]) {
        self.next.clear();
        for &i in &self.front {
            for n in around(cells, i as usize) {
                if self.ring[n] == 0 && cells.is_solid(n) {
                    self.ring[n] = ring;
                    self.next.push(n as u32);
                }
            }
        }
        for &i in &self.next {
            let (mut sum, mut weight) = ([0.0; 3], 0.0);
            for n in around(cells, i as usize) {
                if (1..ring).contains(&self.ring[n]) {
                    (0..3).for_each(|c| sum[c] += light[n][c]);
                    weight += 1.0;
                }
            }
            light[i as usize] = sum.map(|v: f32| v / weight);
        }
    }
}

/// Indices of the cells that share a side with cell `i`.
fn neighbours(cells: &Cells, i: usize) -> impl Iterator<Item = usize> {
    offsets(cells, i, [[-1, 0], [1, 0], [0, -1], [0, 1]])
}

/// Indices of the cells that share a side or a corner with cell `i`.
fn around(cells: &Cells, i: usize) -> impl Iterator<Item = usize> {
    offsets(cells, i, [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]])
}

fn offsets<const N: usize>(
    cells: &Cells,
    i: usize,
    offsets: [[i64; 2]; N],
) -> impl Iterator<Item = usize> {
    let (w, h) = (cells.width() as i64, cells.height() as i64);
    let (x, y) = (i as i64 % w, i as i64 / w);
    offsets.into_iter().filter_map(move |[dx, dy]| {
        let (x, y) = (x + dx, y + dy);
        ((0..w).contains(&x) && (0..h).contains(&y)).then_some((y * w + x) as usize)
    })
}
