//! `cascades`: radiance cascades (Sannikov 2023), a hierarchy of probes without noise.
//!
//! Near light changes from px to px but needs few directions. Far light changes slowly over space but
//! needs many directions. So cascade c has probes `2^c` px apart with `rays·4^c` rays, each of which
//! covers only its interval, from `ℓ₀(4^c − 1)/3` px on for `ℓ₀·4^c` px. From the last to the first,
//! each cascade takes the light beyond its own interval from the four surrounding probes of the next
//! one: `L = r + t·L_next`. Behind the last one lies the sky.
//!
//! A cone of the nearest cascade depends only on the directions within it. So cones are solved one
//! after the other, from far to near, and memory is that of two cascades in one cone. Of each cascade
//! the mean over four rays is kept, which is all that the next nearer one reads.
//!
//! The nearest cascade has its probes where light is needed: at the centres of open cells, and on
//! the faces of walls, weighted with the cosine.
//!
//! Settings: [`crate::settings::Cascades`].
//!
//! Cost: cells × rays × cascades, four times that with the bilinear fix, for any scene.

mod debug_view;
mod gather;
mod interval;
mod ladder;
mod merge;

use crate::clock::Clock;
use crate::grid::medium_grid::{MediumGrid, Reading};
use crate::grid::packet::LANES;
use crate::settings::{self, Bounces};
use crate::simd::dispatch;
use crate::stages::bounce::{FrameBounces, Surfaces, mean_over_faces, solve_bounces};
use crate::stages::direct::DirectLight;
use crate::{Cells, Light, Moment, Rgb};
use fearless_simd::{Level, f32x16, prelude::*};
pub use gather::BEFORE;
use gather::FaceGather;
use interval::{EmptyRadius, TracedScene};
pub use ladder::{BRANCHES, Cascade, cascades, cosine, mean_sine};
use merge::{FartherCascade, LIGHT, PADDING, ProbeRay, ProbeTracer, ReceiverPoints, WITH_MOMENT};
use rayon::prelude::*;

/// Probes that one thread solves at a time.
const BLOCK: usize = 32 * LANES;
/// Columns of probes from which packets stay within one row.
const WIDE: usize = 4 * LANES;

/// The method with its buffers.
#[derive(Debug)]
pub struct Cascades {
    level: Level,
    grid: MediumGrid,
    surfaces: Surfaces,
    /// Those of the frame before, for feedback.
    before: Surfaces,
    empty_radius: EmptyRadius,
    cascades: Vec<Cascade>,
    /// Light of the cascade that is solved, and of the next one.
    near: Vec<f32>,
    far: Vec<f32>,
    faces: FaceGather,
    /// Mean radiance in media that scatter.
    media: Vec<Rgb>,
}

impl Default for Cascades {
    fn default() -> Self {
        Self::on(Level::new())
    }
}

impl Cascades {
    /// Returns the surfaces of the last frame, with the light that they send on.
    pub(crate) fn surfaces(&self) -> &Surfaces {
        &self.surfaces
    }

    /// Creates the method for a vector unit. Units differ in time, not in light.
    fn on(level: Level) -> Self {
        Self {
            level,
            grid: MediumGrid::default(),
            surfaces: Surfaces::default(),
            before: Surfaces::default(),
            empty_radius: EmptyRadius::default(),
            cascades: Vec::new(),
            near: Vec::new(),
            far: Vec::new(),
            faces: FaceGather::default(),
            media: Vec::new(),
        }
    }

    /// Solves one frame: mean radiance in open cells, the mean over the faces in walls.
    pub(crate) fn solve(
        &mut self,
        cells: &Cells,
        settings: &settings::Cascades,
        FrameBounces { bounces, moved, known }: FrameBounces,
        direct: &DirectLight,
        light: &mut Light,
        clock: &mut Clock,
    ) {
        self.grid.read(cells, Reading::default());
        self.grid.read_emission(cells, 1.0);
        self.grid.measure_empty_space(|_, _| false);
        if bounces == Bounces::Feedback {
            std::mem::swap(&mut self.surfaces, &mut self.before);
        }
        self.surfaces.collect(cells, 0.0);
        self.faces.collect(&self.surfaces);
        self.empty_radius.measure(&self.grid);
        let size = [cells.width(), cells.height()];
        cascades(size, settings, &mut self.cascades);
        clock.lap("clearance");

        if let Some(known) = known {
            self.surfaces.send(known.light);
            self.scatter(cells);
            if known.bounce {
                self.gather_surfaces(cells, settings);
                self.reflect_and_scatter(cells, direct);
                clock.lap("bounce");
                return;
            }
        }
        let bounces_at_all = bounces != Bounces::Count(0) && self.surfaces.reflects_or_scatters();
        let feedback = bounces_at_all && bounces == Bounces::Feedback;
        if feedback {
            self.surfaces.take_over(&self.before, moved);
            self.scatter(cells);
        } else if bounces_at_all {
            solve_bounces(bounces, || {
                self.gather_surfaces(cells, settings);
                let change = self.reflect_and_scatter(cells, direct);
                self.scatter(cells);
                change
            });
            clock.lap("bounce");
        }

        self.gather_cells(cells, settings, light);
        clock.lap("cascades");
        if feedback {
            self.media.clear();
            self.media.extend(self.surfaces.media.iter().map(|&i| light.rgb[i as usize]));
            self.reflect_and_scatter(cells, direct);
            clock.lap("bounce");
        }
    }

    /// Drops what surfaces reflected in the frame before.
    pub(crate) fn reset(&mut self) {
        self.surfaces.clear();
    }

    /// Turns the light at surfaces into the radiance that they reflect or scatter. Returns the largest change
    /// relative to the mean.
    fn reflect_and_scatter(&mut self, cells: &Cells, direct: &DirectLight) -> f32 {
        let (faces, media) = (self.faces.walls.iter(), self.media.iter());
        self.surfaces.reflect_and_scatter(cells, direct, faces, media)
    }

    /// Gives media the light that they scatter.
    fn scatter(&mut self, cells: &Cells) {
        if self.surfaces.scatter_into(cells, 1.0, &mut self.grid) {
            self.grid.measure_empty_space(|_, _| false);
        }
    }

    /// Gathers the light at surfaces: irradiance of faces, mean radiance in media.
    fn gather_surfaces(&mut self, cells: &Cells, settings: &settings::Cascades) {
        let mut media = std::mem::take(&mut self.media);
        media.clear();
        media.resize(self.surfaces.media.len(), Rgb::default());
        let gather = |level, tracer: &ProbeTracer, cone| {
            let selected = &tracer.scene.surfaces.media;
            gather::add_to_selected(level, tracer, cells, selected, cone, &mut media);
        };
        self.each_cone::<LIGHT>(cells, settings, gather, |_, _, _| ());
        self.media = media;
    }

    /// Gathers the light of every cell.
    fn gather_cells(&mut self, cells: &Cells, settings: &settings::Cascades, light: &mut Light) {
        light.rgb.clear();
        light.rgb.resize(cells.len(), Rgb::default());
        let with_moment = light.moment.is_some();
        if let Some(moment) = &mut light.moment {
            moment.clear();
            moment.resize(cells.len(), Moment::default());
        }
        let gather = |level, tracer: &ProbeTracer, cone| {
            gather::add_to_cells(level, tracer, cells, cone, light);
        };
        if with_moment {
            self.each_cone::<WITH_MOMENT>(cells, settings, gather, |_, _, _| ());
        } else {
            self.each_cone::<LIGHT>(cells, settings, gather, |_, _, _| ());
        }
        for i in (0..cells.len()).filter(|&i| cells.is_solid(i)) {
            light.rgb[i] = self.surfaces.slot(i).map_or(Rgb::default(), |slot| {
                mean_over_faces(&self.surfaces.walls[slot], &self.faces.walls[slot])
            });
        }
    }

    /// Solves all cones of the nearest cascade, one after the other, for the faces of walls and for the
    /// receivers of `gather`. `filled` is called with each farther cascade, the index of its first cone
    /// and its light, N values per probe.
    fn each_cone<const N: usize>(
        &mut self,
        cells: &Cells,
        settings: &settings::Cascades,
        mut gather: impl FnMut(Level, &ProbeTracer, u32),
        mut filled: impl FnMut(&Cascade, u32, &[f32]),
    ) {
        self.faces.clear();
        let Self { level, grid, surfaces, empty_radius, cascades, near, far, faces, .. } = self;
        let scene = TracedScene { grid, surfaces, empty_radius };
        let Some((nearest, farther)) = cascades.split_first() else { return };
        for cone in 0..nearest.rays {
            let mut beyond: Option<(&Cascade, u32)> = None;
            let mut cones = BRANCHES.pow(farther.len() as u32);
            for cascade in farther.iter().rev() {
                // The cones of the next nearer cascade that lie in this cone.
                cones /= BRANCHES;
                let first = cone * cones;
                let tracer = tracer::<N>(scene, settings, cascade, beyond, far);
                let values = N * cones as usize * cascade.lattice.len();
                near.resize(values + PADDING, 0.0);
                fill::<N>(*level, &tracer, first, &mut near[..values]);
                filled(cascade, first, &near[..values]);
                std::mem::swap(near, far);
                beyond = Some((cascade, first));
            }
            let tracer = tracer::<N>(scene, settings, nearest, beyond, far);
            gather(*level, &tracer, cone);
            faces.add(*level, &tracer, cells, cone);
        }
        faces.sort(surfaces);
    }
}

fn tracer<'a, const N: usize>(
    scene: TracedScene<'a>,
    settings: &settings::Cascades,
    cascade: &'a Cascade,
    beyond: Option<(&'a Cascade, u32)>,
    light: &'a [f32],
) -> ProbeTracer<'a> {
    let farther =
        beyond.map(|(cascade, first)| FartherCascade { cascade, light, first, values: N });
    let settings::Cascades { merge, overlap, .. } = *settings;
    ProbeTracer { scene, merge, overlap, cascade, farther }
}

/// Fills the light of a cascade, cone by cone from `first` on.
fn fill<const N: usize>(level: Level, tracer: &ProbeTracer, first: u32, light: &mut [f32]) {
    let lattice = &tracer.cascade.lattice;
    let cones = light.par_chunks_mut(N * lattice.len()).enumerate();
    cones.for_each(|(cone, planes)| {
        let rays = tracer.rays(first + cone as u32);
        let columns = lattice.count[0] as usize;
        // Packets of wide rows stay within a row, so that the light of the next cascade is contiguous;
        // those of narrow rows would be half empty.
        let in_row = columns >= WIDE && tracer.farther.is_some();
        let block = if in_row { columns } else { BLOCK };
        let mut planes = planes.chunks_mut(lattice.len());
        let planes: [&mut [f32]; N] = std::array::from_fn(|_| planes.next().unwrap_or_default());
        fill_blocks(level, tracer, ProbeRange { first: 0, in_row }, &rays, block, planes);
    });
}

/// Fills probes in parallel, `block` at a time.
fn fill_blocks<const N: usize>(
    level: Level,
    tracer: &ProbeTracer,
    probes: ProbeRange,
    rays: &[ProbeRay],
    block: usize,
    light: [&mut [f32]; N],
) {
    let blocks = light[0].len().div_ceil(block);
    if blocks <= 1 {
        dispatch!(level, simd => fill_block(simd, tracer, probes, rays, light));
        return;
    }
    let middle = blocks / 2 * block;
    let mut after: [&mut [f32]; N] = std::array::from_fn(|_| <&mut [f32]>::default());
    let mut rest = after.iter_mut();
    let before = light.map(|plane| {
        let (before, behind) = plane.split_at_mut(middle);
        if let Some(rest) = rest.next() {
            *rest = behind;
        }
        before
    });
    let next = ProbeRange { first: probes.first + middle, ..probes };
    rayon::join(
        || fill_blocks(level, tracer, probes, rays, block, before),
        || fill_blocks(level, tracer, next, rays, block, after),
    );
}

/// Consecutive probes.
#[derive(Clone, Copy)]
struct ProbeRange {
    first: usize,
    in_row: bool,
}

#[inline(always)]
fn fill_block<S: Simd, const N: usize>(
    simd: S,
    tracer: &ProbeTracer,
    probes: ProbeRange,
    rays: &[ProbeRay],
    light: [&mut [f32]; N],
) {
    let lattice = &tracer.cascade.lattice;
    let columns = lattice.count[0] as usize;
    let count = light[0].len();
    for packet in (0..count).step_by(LANES) {
        let first = probes.first + packet;
        let [column, row] = if probes.in_row {
            let column = f32x16::from_fn(simd, |l| (first % columns + l) as f32);
            [column, f32x16::splat(simd, (first / columns) as f32)]
        } else {
            let index = |l: usize| (first + l).min(lattice.len() - 1);
            [
                f32x16::from_fn(simd, |l| (index(l) % columns) as f32),
                f32x16::from_fn(simd, |l| (index(l) / columns) as f32),
            ]
        };
        let at = [lattice.position(0, column), lattice.position(1, row)];
        let points = ReceiverPoints { at, in_row: probes.in_row, normal: None };
        let found: [f32x16<S>; N] = tracer.radiance(simd, points, rays);
        let end = count.min(packet + LANES);
        for v in 0..N {
            light[v][packet..end].copy_from_slice(&found[v].to_array()[..end - packet]);
        }
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::super::vector_units::{agree, cells};
    use super::*;
    use crate::settings::Merge;

    #[test]
    fn every_vector_unit_gives_the_same_bytes() {
        let cells = cells().drawn().into_owned();
        for merge in [Merge::Plain, Merge::BilinearFix] {
            let settings = settings::Cascades { merge, ..settings::Cascades::default() };
            agree(0.0, |level| {
                let mut light = Light::default();
                let (bounces, direct) =
                    (FrameBounces::here(Bounces::Count(1)), DirectLight::default());
                let mut clock = Clock::default();
                Cascades::on(level)
                    .solve(&cells, &settings, bounces, &direct, &mut light, &mut clock);
                light.rgb
            });
        }
    }
}
