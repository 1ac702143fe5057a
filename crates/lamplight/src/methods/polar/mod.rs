//! `polar`: a one-dimensional polar shadow map per lamp, looked up by every pixel (Griffis,
//! "Polar-Ray Traced Lighting").
//!
//! Pass A ([`shadow_map`]): a lamp that reaches R px casts `⌈2πR⌉` rays and keeps the length of each.
//! Pass B ([`gather`]): a pixel within R finds its ray by atan2. If the pixel is nearer than the ray is
//! long, it receives `color · intensity · falloff(d)`.
//!
//! Beyond the source: exact ray lengths, edges that are linear between rays or as soft as the lamp's
//! size makes them, media that absorb and tint ([`transmittance_curve`]), cones, blend modes, and lit
//! walls.
//!
//! Settings: `density` (rays per px of the circle), `traversal`, `shadow_filter`, `translucent`, `blend`, `falloff`.
//!
//! Cost: per lamp `2πR` rays of at most R px and `πR²` lookups, for any scene. Known
//! failures: it finds no light from emissive matter, the sky or bounces; a lamp inside a wall lights
//! nothing; walls behind the nearest one throw no penumbra of their own.

mod angle;
mod debug_view;
mod gather;
mod lit_ranges;
pub mod penumbra;
mod sampling;
pub mod shadow_map;
pub mod solid_bits;
mod sun_map;
mod transmittance_curve;

pub use shadow_map::{NARROWEST, NEAREST, WIDEST, rays};
pub use transmittance_curve::{APART, FINEST};

use crate::clock::Clock;
use crate::grid::medium_grid::{MediumGrid, Reading};
use crate::settings::Polar;
use crate::stages::direct::DirectLight;
use crate::stages::faces::Faces;
use crate::{Cells, Lamp, Light};
use fearless_simd::Level;
use gather::LightPlanes;

use rayon::prelude::*;
use shadow_map::{ShadowMap, ShadowScene};
use solid_bits::SolidBits;
use sun_map::SunMap;

/// Memory for the shadow maps of a group of lamps, bytes.
const MOST_BYTES: usize = 128 << 20;

/// The method with its buffers.
#[derive(Debug)]
pub struct PolarSolver {
    level: Level,
    grid: MediumGrid,
    solid: SolidBits,
    /// Shadow maps of a group of lamps; more than its lamps if a larger group came before.
    shadow_maps: Vec<ShadowMap>,
    sun_map: SunMap,
    /// The light of suns on faces, in the method itself.
    faces: Vec<Faces>,
    /// The lamps in their order, in the method itself.
    lamps: Vec<Lamp>,
    /// The number of lamps in the last group of the last frame.
    last: usize,
    planes: LightPlanes,
}

/// The lamps and cells of a frame, and what to find of their light.
#[derive(Clone, Copy)]
struct LampInput<'a> {
    cells: &'a Cells,
    lamps: &'a [Lamp],
    /// The distance field; empty unless `traversal = "distance"`.
    distance: &'a [f32],
    settings: &'a Polar,
    /// True for exact penumbrae, and for light on faces.
    exact: bool,
    /// The elevation of all light, if the first moment is found too.
    moment: Option<f32>,
}

impl Default for PolarSolver {
    fn default() -> Self {
        Self::on(Level::new())
    }
}

impl PolarSolver {
    /// Runs at the given SIMD level. The result is identical at every level.
    fn on(level: Level) -> Self {
        Self {
            level,
            grid: MediumGrid::default(),
            solid: SolidBits::default(),
            shadow_maps: Vec::new(),
            sun_map: SunMap::default(),
            faces: Vec::new(),
            lamps: Vec::new(),
            last: 0,
            planes: LightPlanes::default(),
        }
    }

    /// Lights the cells with their lamps, which are not drawn in, and their suns. `distance` is the distance field,
    /// empty unless `traversal = "distance"`.
    pub(crate) fn solve(
        &mut self,
        cells: &Cells,
        distance: &[f32],
        settings: &Polar,
        light: &mut Light,
        clock: &mut Clock,
    ) {
        let (mut faces, mut lamps) =
            (std::mem::take(&mut self.faces), std::mem::take(&mut self.lamps));
        lamps.clear();
        lamps.extend_from_slice(cells.lamps());
        // Those that take light away take it from all others, however these blend.
        lamps.sort_by_key(Lamp::takes_light);
        let moment = light.moment.is_some().then_some(light.elevation);
        let input = LampInput { cells, lamps: &lamps, distance, settings, exact: false, moment };
        self.add(input, &mut faces, clock);
        (self.faces, self.lamps) = (faces, lamps);
        self.planes.write(&mut light.rgb);
        if let Some(moment) = &mut light.moment {
            self.planes.write_moments(moment);
        }
        clock.lap("polar");
    }

    /// Finds the direct light of the lamps of `direct` and of the suns with exact penumbrae, on cells and on faces, and
    /// its first moment if it is asked for by the elevation of all light.
    pub fn solve_direct(&mut self, cells: &Cells, moment: Option<f32>, direct: &mut DirectLight) {
        let settings = &Polar::default();
        let DirectLight { lamps, light, moment: moments, faces } = direct;
        let input = LampInput { cells, lamps, distance: &[], settings, exact: true, moment };
        self.add(input, faces, &mut Clock::default());
        self.planes.write(light);
        self.planes.write_moments(moments);
    }

    /// Adds lamps and the suns of the cells. Only suns light `faces`, and lamps if they are `exact`.
    fn add(&mut self, input: LampInput, faces: &mut Vec<Faces>, clock: &mut Clock) {
        let LampInput { cells, lamps, distance, settings, exact, moment } = input;
        self.grid.read(cells, Reading { translucent: settings.translucent, ..Reading::default() });
        self.planes.clear(cells, moment);
        faces.clear();
        if exact || !cells.suns().is_empty() {
            self.solid.read(&self.grid);
            faces.resize(self.planes.walls(), Faces::default());
        }
        clock.lap("ground");
        self.last = 0;
        let (level, grid, solid) = (self.level, &self.grid, &self.solid);
        let masks = cells.masks();
        let scene = ShadowScene { grid, solid: exact.then_some(solid), masks };
        let mut lamps = lamps;
        while !lamps.is_empty() {
            let bytes = |lamp| ShadowMap::most_bytes(lamp, grid, settings);
            let mut sum = 0usize;
            let fit = lamps.iter().take_while(|&lamp| {
                sum = sum.saturating_add(bytes(lamp));
                sum <= MOST_BYTES
            });
            let (group, rest) = lamps.split_at(fit.count().max(1));
            if self.shadow_maps.len() < group.len() {
                self.shadow_maps.resize_with(group.len(), ShadowMap::default);
            }
            self.last = group.len();
            let shadow_maps = &mut self.shadow_maps[..group.len()];
            shadow_maps.par_iter_mut().zip(group).for_each(|(shadow_map, lamp)| {
                shadow_map.trace(level, lamp, scene, distance, settings);
            });
            clock.lap("rays");
            self.planes.light(level, scene, shadow_maps, settings);
            if exact {
                self.planes.light_faces(scene, shadow_maps, settings, faces);
            }
            clock.lap("polar");
            lamps = rest;
        }
        let scene = ShadowScene { solid: Some(solid), ..scene };
        for sun in cells.suns() {
            self.sun_map.trace(sun, scene);
            self.planes.shine(scene, &self.sun_map, faces);
            clock.lap("suns");
        }
        self.planes.add_faces(faces);
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::super::vector_units::{agree, cells};
    use super::*;

    #[test]
    fn every_vector_unit_gives_the_same_bytes() {
        let (cells, settings) = (cells(), Polar::default());
        agree(0.0, |level| {
            let mut light = Light::default();
            PolarSolver::on(level).solve(&cells, &[], &settings, &mut light, &mut Clock::default());
            light.rgb
        });
    }
}
