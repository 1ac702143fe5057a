//! `cascades`: radiance cascades (Sannikov 2023), a hierarchy of probes without noise.
//!
//! What is near changes from px to px, but a few directions do; what is far changes slowly over
//! space, but needs many directions. So cascade c has probes `2^c` px apart with `rays·4^c` rays,
//! each of which looks only at its interval, from `L₀(4^c − 1)/3` px on for `L₀·4^c` px. From the
//! last to the first each cascade takes what lies beyond its own interval from the four probes of the
//! next one around: `L = r + t·L_next`. The last one ends in the sky.
//!
//! A cone of the nearest cascade needs only what lies within it, so cones are worked out one after
//! the other, from far to near, and memory is that of two cascades in one cone. Of each cascade the
//! mean over four rays is kept, which is all that the next nearer one reads.
//!
//! The nearest cascade has its probes where light is wanted: at the centres of open cells, and on
//! the faces of walls, weighted with the cosine.
//!
//! Cost: cells × rays × cascades, four times that with the bilinear fix, whatever the scene.

mod gather;
mod inside;
mod interval;
mod ladder;
mod merge;

use crate::clock::Clock;
use crate::settings::{self, Bounces, Settings};
use crate::stages::bounce::{CONVERGED, Surfaces, mean_over_faces};
use crate::stages::optics::{Optics, Reading};
use crate::stages::packet::LANES;
use crate::{Cells, Rgb};
use fearless_simd::{Level, dispatch, f32x16, prelude::*};
pub use gather::BEFORE;
use gather::OnFaces;
use interval::{Field, Room};
pub use ladder::{BRANCHES, Cascade, Lattice, Path, cascades, cosine, mean_sine};
use merge::{Caster, Far, PADDING, Points, Ray};
use rayon::prelude::*;

/// Probes that are worked out in one go on one thread.
const BLOCK: usize = 32 * LANES;
/// Columns of probes from which on packets keep to one row.
const WIDE: usize = 4 * LANES;

/// The method with its buffers.
#[derive(Debug)]
pub struct Cascades {
    level: Level,
    optics: Optics,
    surfaces: Surfaces,
    room: Room,
    cascades: Vec<Cascade>,
    /// What the cascade at hand gathers, and what the next one has gathered.
    near: Vec<f32>,
    far: Vec<f32>,
    faces: OnFaces,
    fog: Vec<Rgb>,
}

impl Default for Cascades {
    fn default() -> Self {
        Self::on(Level::new())
    }
}

impl Cascades {
    /// On these vector units; which ones makes no difference but to the time.
    fn on(level: Level) -> Self {
        Self {
            level,
            optics: Optics::default(),
            surfaces: Surfaces::default(),
            room: Room::default(),
            cascades: Vec::new(),
            near: Vec::new(),
            far: Vec::new(),
            faces: OnFaces::default(),
            fog: Vec::new(),
        }
    }

    /// Solves one frame: fluence in open cells, the mean over the faces of walls.
    pub(crate) fn solve(
        &mut self,
        cells: &Cells,
        settings: &Settings,
        light: &mut Vec<Rgb>,
        clock: &mut Clock,
    ) {
        self.optics.prepare(cells, Reading::default(), &[]);
        self.surfaces.collect(cells, 0.0);
        self.faces.collect(&self.surfaces);
        self.room.measure(&self.optics);
        let size = [cells.width(), cells.height()];
        cascades(size, &settings.cascades, &mut self.cascades);
        clock.lap("clearance");

        if settings.bounces != Bounces::Count(0) && self.surfaces.reflect() {
            for _ in 0..settings.bounces.limit() {
                self.receive(cells, settings);
                let (faces, fog) = (self.faces.walls.iter(), self.fog.iter());
                let change = self.surfaces.send_on(cells, faces, fog);
                self.optics.light_fog(cells, Reading::default(), &self.surfaces);
                if settings.bounces == Bounces::Converged && change < CONVERGED {
                    break;
                }
            }
            clock.lap("bounce");
        }

        self.gather(cells, settings, light);
        clock.lap("cascades");
    }

    /// Gathers what the surfaces that reflect receive.
    fn receive(&mut self, cells: &Cells, settings: &Settings) {
        let mut fog = std::mem::take(&mut self.fog);
        fog.clear();
        fog.resize(self.surfaces.fog.len(), Rgb::default());
        let wanted = |level, caster: &Caster, cone| {
            let some = &caster.field.surfaces.fog;
            gather::add_to_some(level, caster, cells, some, cone, &mut fog);
        };
        self.each_cone(cells, settings, wanted, |_, _, _| ());
        self.fog = fog;
    }

    /// The last gather: what every cell receives.
    fn gather(&mut self, cells: &Cells, settings: &Settings, light: &mut Vec<Rgb>) {
        light.clear();
        light.resize(cells.len(), Rgb::default());
        let wanted = |level, caster: &Caster, cone| {
            gather::add_to_cells(level, caster, cells, cone, light);
        };
        self.each_cone(cells, settings, wanted, |_, _, _| ());
        for i in (0..cells.len()).filter(|&i| cells.is_solid(i)) {
            light[i] = self.surfaces.slot(i).map_or(Rgb::default(), |slot| {
                mean_over_faces(&self.surfaces.walls[slot], &self.faces.walls[slot])
            });
        }
    }

    /// Works out all cones of the nearest cascade, one after the other, for the faces of walls and
    /// for whoever else is `wanted` to have light; `filled` is shown what each further cascade gathers
    /// for the cones from one on.
    fn each_cone(
        &mut self,
        cells: &Cells,
        settings: &Settings,
        mut wanted: impl FnMut(Level, &Caster, u32),
        mut filled: impl FnMut(&Cascade, u32, &[f32]),
    ) {
        self.faces.darken();
        let Self { level, optics, surfaces, room, cascades, near, far, faces, .. } = self;
        let field = Field { optics, surfaces, room };
        let Some((nearest, further)) = cascades.split_first() else { return };
        for cone in 0..nearest.rays {
            let mut beyond: Option<(&Cascade, u32)> = None;
            let mut cones = BRANCHES.pow(further.len() as u32);
            for cascade in further.iter().rev() {
                // The cones of the next nearer cascade that lie in this one.
                cones /= BRANCHES;
                let first = cone * cones;
                let caster = caster(field, settings, cascade, beyond, far);
                let values = 3 * cones as usize * cascade.lattice.len();
                near.resize(values + PADDING, 0.0);
                fill(*level, &caster, first, &mut near[..values]);
                filled(cascade, first, &near[..values]);
                std::mem::swap(near, far);
                beyond = Some((cascade, first));
            }
            let caster = caster(field, settings, nearest, beyond, far);
            wanted(*level, &caster, cone);
            faces.add(*level, &caster, cells, cone);
        }
        faces.sort(surfaces);
    }
}

fn caster<'a>(
    field: Field<'a>,
    settings: &Settings,
    cascade: &'a Cascade,
    beyond: Option<(&'a Cascade, u32)>,
    light: &'a [f32],
) -> Caster<'a> {
    let far = beyond.map(|(cascade, first)| Far { cascade, light, first });
    let settings::Cascades { merge, overlap, .. } = settings.cascades;
    Caster { field, merge, overlap, cascade, far }
}

/// Fills what a cascade gathers, cone by cone from `first` on.
fn fill(level: Level, caster: &Caster, first: u32, light: &mut [f32]) {
    let lattice = &caster.cascade.lattice;
    light.par_chunks_mut(3 * lattice.len()).enumerate().for_each(|(cone, planes)| {
        let rays = caster.rays(first + cone as u32);
        let (red, rest) = planes.split_at_mut(lattice.len());
        let (green, blue) = rest.split_at_mut(lattice.len());
        let columns = lattice.count[0] as usize;
        // Wide rows go packet by packet, so that what lies beyond is read in one piece; packets
        // of narrow ones would be half empty.
        let in_row = columns >= WIDE && caster.far.is_some();
        let block = if in_row { columns } else { BLOCK };
        red.par_chunks_mut(block)
            .zip(green.par_chunks_mut(block))
            .zip(blue.par_chunks_mut(block))
            .enumerate()
            .for_each(|(i, ((red, green), blue))| {
                let probes = Probes { first: i * block, in_row };
                dispatch!(level, simd => {
                    fill_block(simd, caster, probes, &rays, [red, green, blue]);
                });
            });
    });
}

/// Probes one after the other.
#[derive(Clone, Copy)]
struct Probes {
    first: usize,
    in_row: bool,
}

#[inline(always)]
fn fill_block<S: Simd>(
    simd: S,
    caster: &Caster,
    probes: Probes,
    rays: &[Ray],
    light: [&mut [f32]; 3],
) {
    let lattice = &caster.cascade.lattice;
    let columns = lattice.count[0] as usize;
    let count = light[0].len();
    for packet in (0..count).step_by(LANES) {
        let first = probes.first + packet;
        let [column, row] = if probes.in_row {
            let column = f32x16::from_fn(simd, |l| (first % columns + l) as f32);
            [column, f32x16::splat(simd, (first / columns) as f32)]
        } else {
            let place = |l: usize| (first + l).min(lattice.len() - 1);
            [
                f32x16::from_fn(simd, |l| (place(l) % columns) as f32),
                f32x16::from_fn(simd, |l| (place(l) / columns) as f32),
            ]
        };
        let at = [lattice.position(0, column), lattice.position(1, row)];
        let seen = caster.see(simd, Points { at, in_row: probes.in_row, normal: None }, rays);
        let end = count.min(packet + LANES);
        for c in 0..3 {
            light[c][packet..end].copy_from_slice(&seen[c].to_array()[..end - packet]);
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
            let mut settings = Settings { bounces: Bounces::Count(1), ..Settings::default() };
            settings.cascades.merge = merge;
            agree(0.0, |level| {
                let mut light = Vec::new();
                Cascades::on(level).solve(&cells, &settings, &mut light, &mut Clock::default());
                light
            });
        }
    }
}
