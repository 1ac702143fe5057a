//! What is the same for every frame: the ways of rays, and the cones.

use lamplight::methods::holographic::ways::{Crossing, Look, beam};
use lamplight::methods::holographic::{angle, rays, slope};

/// Rows to either side that a mask covers.
const ASIDE: isize = 32;

/// The ways of beams and of the last hop, as shaders/ways.wgsl reads them.
#[derive(Debug, Default)]
pub struct Ways {
    pub words: Vec<u32>,
    /// Where beams, and the list of views, begin.
    pub beams: u32,
    pub views: u32,
}

impl Ways {
    pub fn new(look: Look, width: u32) -> Self {
        let mut ways = Self::default();
        ways.beams(look.level, width);
        ways.views(look);
        ways
    }

    /// Beam by beam: a mask, then where the crossings of each ray begin and their number.
    fn beams(&mut self, level: u32, width: u32) {
        let beams: Vec<_> = (0..rays(level)).map(|ray| beam(level, ray, width)).collect();
        let mut records = Vec::new();
        for rays in &beams {
            let cells = rays.iter().flatten().map(|crossing| (crossing.slab, crossing.row));
            records.extend(mask((1 << level) + 1, cells));
            for ray in rays {
                records.extend([self.crossings(ray), ray.len() as u32]);
            }
        }
        self.beams = self.words.len() as u32;
        self.words.extend(records);
    }

    /// For every distance to the plane its cones: angle, cosines; rays: crossings, end; a mask.
    fn views(&mut self, look: Look) {
        let mut begins = Vec::new();
        for ahead in look.least..=look.most() {
            let mut records = Vec::new();
            for cone in look.cones(ahead) {
                let [along, across] = cone.cosines;
                records.extend([cone.angle, along, across, 0.0].map(f32::to_bits));
                for way in &cone.ways {
                    let first = self.crossings(&way.crossings);
                    let count = way.crossings.len() as u32;
                    let past = way.shares[1].to_bits();
                    records.extend([first, count, way.row as i32 as u32, past]);
                }
                let crossed = cone.ways.iter().flat_map(|way| &way.crossings);
                let crossed = crossed.map(|crossing| (crossing.slab, crossing.row));
                let ends =
                    cone.ways.iter().flat_map(|way| [(ahead, way.row), (ahead, way.row + 1)]);
                records.extend(mask(ahead + 1, crossed.chain(ends)));
            }
            begins.push(self.words.len() as u32);
            self.words.extend(records);
        }
        self.views = self.words.len() as u32;
        self.words.extend(begins);
    }

    /// Appends crossings; returns where they begin.
    fn crossings(&mut self, crossings: &[Crossing]) -> u32 {
        let first = self.words.len() as u32;
        for crossing in crossings {
            let row = (crossing.row + 128) as u32;
            let cell = crossing.slab as u32 | row << 8 | (crossing.face as u32) << 16;
            self.words.extend([cell, crossing.length.to_bits()]);
        }
        first
    }
}

/// Bits of cells by slab: rows from −32 to −1, and from 0 to 31.
fn mask(slabs: usize, cells: impl Iterator<Item = (usize, isize)>) -> Vec<u32> {
    let mut words = vec![0; 2 * slabs];
    for (slab, row) in cells {
        let bit = (row + ASIDE) as usize;
        words[2 * slab + bit / 32] |= 1 << (bit % 32);
    }
    words
}

/// Of each cone of levels `first` to `end`, level by level from where it is returned: ∫ dθ, ∫ |sin θ| dθ
/// where the sine is negative, and where it is positive, ∫ cos θ dθ; as sums over the cones of the last
/// level, as the CPU has them.
pub fn cones(first: u32, end: u32) -> (Vec<u32>, Vec<[f32; 4]>) {
    let top: Vec<[f64; 4]> = (0..2usize << end)
        .map(|cone| {
            let (from, angle) = (slope(end, cone).atan(), angle(end, cone));
            let middle = from + 0.5 * angle;
            let up = (-middle.sin()).max(0.0) * angle;
            let down = middle.sin().max(0.0) * angle;
            [angle, up, down, middle.cos() * angle]
        })
        .collect();
    let (mut begins, mut cones) = (Vec::new(), Vec::new());
    for level in first..=end {
        begins.push(cones.len() as u32);
        for parts in top.chunks_exact(1 << (end - level)) {
            cones.push(std::array::from_fn(|i| {
                parts.iter().map(|part| part[i]).sum::<f64>() as f32
            }));
        }
    }
    (begins, cones)
}
