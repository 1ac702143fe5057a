//! The light of the sky in the cones of all quadrants, as shaders/methods/holographic/sky.wgsl reads it.

use super::border::views_at_border;
use crate::error::Result;
use crate::planner::FramePlanner;
use lamplight::internals::holographic::lattice::{self, on_grid};
use lamplight::internals::holographic::paper::edges;
use lamplight::internals::sky::sines;
use lamplight::{Panorama, Sky};
use wgpu::{Buffer, BufferUsages, Queue};

/// The values of a cone that a shader reads: weights of a gradient, or the light of a panorama.
pub type ConeEntry = [f32; 4];

/// The cones of all levels of both axes in one list.
#[derive(Debug)]
pub struct ConeTable {
    levels: ConeLevels,
    /// The first entry of each level, by axis.
    pub begins: [Vec<u32>; 2],
    weights: Vec<ConeEntry>,
}

/// The levels of a table.
#[derive(Clone, Copy, Debug)]
enum ConeLevels {
    /// Those above the first, up to the last of each axis.
    Bundles { first: u32, ends: [u32; 2] },
    /// Those from 1 to the last, for both axes.
    Paper { end: u32 },
}

impl ConeLevels {
    /// Returns where each level of an axis begins, and `integrals` between the edges of each cone.
    fn of(
        self,
        axis: usize,
        integrals: impl Fn([f64; 2]) -> [f64; 4],
    ) -> (Vec<u32>, Vec<ConeEntry>) {
        let levels = match self {
            Self::Bundles { first, ends } => bundles(first, ends[axis], integrals),
            Self::Paper { end } => paper(end, integrals),
        };
        let (mut begins, mut cones) = (Vec::new(), Vec::new());
        for level in levels {
            begins.push(cones.len() as u32);
            cones.extend(level.into_iter().map(|cone| cone.map(|part| part as f32)));
        }
        (begins, cones)
    }
}

/// Returns `integrals` over the angle of each cone of the levels `first + 1` to `end`, or of each half cone of those
/// above the first two levels. As on the CPU, they are made from those between the edges of the last level.
fn bundles(first: u32, end: u32, integrals: impl Fn([f64; 2]) -> [f64; 4]) -> Vec<Vec<[f64; 4]>> {
    let mut parts: [Vec<f64>; 4] = Default::default();
    for cone in 0..lattice::cones(end) {
        let integrals = integrals(lattice::edges(end, cone));
        parts.iter_mut().zip(integrals).for_each(|(part, integral)| part.push(integral));
    }
    let mut levels = Vec::new();
    for level in (first + 1..=end).rev() {
        let halved = level > first + 1;
        if halved {
            parts.iter_mut().for_each(|part| lattice::halves(part));
        }
        let cone = |cone: usize| [0, 1, 2, 3].map(|i| parts[i][cone]);
        levels.push((0..parts[0].len()).map(cone).collect());
        if halved {
            parts.iter_mut().for_each(lattice::cones_of_halves);
        }
    }
    levels.reverse();
    levels
}

/// Returns `integrals` over the angle of each cone of the levels 1 to `end` of the published cascades.
fn paper(end: u32, integrals: impl Fn([f64; 2]) -> [f64; 4]) -> Vec<Vec<[f64; 4]>> {
    let cones = |level: u32| (0..1 << level).map(move |j| edges(level, j, 0));
    (1..=end).map(|level| cones(level).map(&integrals).collect()).collect()
}

/// Returns the angle between two edges, and the weights of a gradient: ∫ dθ, ∫ |sin θ| dθ where the sine is negative, and
/// where it is positive, ∫ cos θ dθ.
fn gradient([from, to]: [f64; 2]) -> [f64; 4] {
    let [up, down] = sines(from, to);
    [to - from, up, down, to.sin() - from.sin()]
}

impl ConeTable {
    /// The cones of bundles: of the levels above `first`, up to the last of each axis.
    pub fn of_bundles(first: u32, ends: [u32; 2]) -> Self {
        let levels = ConeLevels::Bundles { first, ends };
        let [(begins, mut weights), (mut others, more)] =
            [0, 1].map(|axis| levels.of(axis, gradient));
        others.iter_mut().for_each(|begin| *begin += weights.len() as u32);
        weights.extend(more);
        Self { levels, begins: [begins, others], weights }
    }

    /// The cones of the published cascades, of the levels 1 to `end`.
    pub fn of_paper(end: u32) -> Self {
        let levels = ConeLevels::Paper { end };
        let (begins, weights) = levels.of(0, gradient);
        Self { levels, begins: [begins.clone(), begins], weights }
    }

    /// The number of cones.
    pub fn entries(&self) -> u32 {
        self.weights.len() as u32
    }

    /// Returns the distance from a cone's entry, of a table of so many, to the light of the sky in it.
    pub fn light_of(entries: u32, axis: u32, reversed: u32) -> u32 {
        (1 + 2 * axis + reversed) * entries
    }

    /// Creates the buffer, with room for the light of a panorama if the sky is one. With inflow it has what cones see
    /// instead.
    pub fn buffer(&self, planner: &FramePlanner) -> Result<Buffer> {
        let mut entries = self.weights.clone();
        if planner.has_panorama() {
            entries.resize(5 * self.weights.len(), [0.0; 4]);
        }
        if let (Some(columns), ConeLevels::Bundles { first, ends }) =
            (planner.inflow_columns, self.levels)
        {
            entries.extend(views_at_border(first, ends, columns as usize, entries.len()));
        }
        planner.filled("cones", BufferUsages::STORAGE, bytemuck::cast_slice(&entries))
    }

    /// The light of a panorama in the cones of all quadrants.
    fn light(&self, panorama: &Panorama) -> Vec<ConeEntry> {
        let mut entries = vec![[0.0; 4]; 4 * self.weights.len()];
        for axis in [0, 1] {
            for reversed in [false, true] {
                let (_, light) = self.levels.of(axis, |edges| {
                    let [from, to] = on_grid(axis == 0, reversed, edges);
                    // Cones beyond the quadrant have no angle.
                    if from == to {
                        return [0.0; 4];
                    }
                    let [r, g, b] = panorama.mean(from, to).map(|v| f64::from(v) * (to - from));
                    [r, g, b, 0.0]
                });
                let table = (2 * axis + usize::from(reversed)) * self.weights.len();
                let begin = table + self.begins[axis][0] as usize;
                entries[begin..][..light.len()].copy_from_slice(&light);
            }
        }
        entries
    }
}

/// The part of the buffer that depends on the sky.
#[derive(Debug)]
pub struct ConeSky {
    table: ConeTable,
    buffer: Buffer,
    written: Option<Panorama>,
}

impl ConeSky {
    pub fn new(table: ConeTable, buffer: Buffer) -> Self {
        Self { table, buffer, written: None }
    }

    /// Writes the light of a sky that is a panorama, unless the buffer has it already.
    pub fn write(&mut self, queue: &Queue, sky: &Sky) {
        let Sky::Panorama(panorama) = sky else { return };
        if self.written.as_ref() != Some(panorama) {
            let light = self.table.light(panorama);
            let after = size_of_val(&self.table.weights[..]) as u64;
            queue.write_buffer(&self.buffer, after, bytemuck::cast_slice(&light));
            self.written = Some(panorama.clone());
        }
    }
}
