//! Light found on the CPU, for devices that are software themselves.

use crate::error::Result;
use crate::frame_input::{FrameInput, Lights, SceneInput};
use crate::planner::FramePlanner;
use crate::stages::matter_values::{CellValues, MatterValues};
use lamplight::{ALL_LAYERS, Cells, Light, Rgb, Settings, Solver};

/// The solver, and what it reads.
#[derive(Debug, Default)]
pub struct CpuBackend {
    solver: Option<Solver>,
    /// Compiled when a host's textures are first lit.
    values: Option<MatterValues>,
    /// The cells of the host's textures.
    cells: Option<Cells>,
    /// The light as the GPU lays it out: of all cells, then both components of its first moment.
    light: Vec<[f32; 4]>,
}

impl CpuBackend {
    /// Finds the light of a frame whose grid has `moved` since the one before.
    pub fn solve(
        &mut self,
        planner: &FramePlanner,
        input: &FrameInput,
        moved: [i32; 2],
    ) -> Result<()> {
        let settings = input.settings;
        let solver = match &mut self.solver {
            Some(solver) => {
                solver.set_settings(settings.clone())?;
                solver
            }
            none => none.insert(Solver::new(settings.clone())?),
        };
        solver.shift(moved);
        let cells = match input.scene {
            SceneInput::Cells(cells) => cells,
            SceneInput::Textures { textures, lights } => {
                let values = match &mut self.values {
                    Some(values) => values,
                    none => none.insert(MatterValues::new(planner)?),
                };
                let values = values.read(planner, textures)?;
                let [width, height] = planner.size.into();
                let fits = |cells: &Cells| [cells.width(), cells.height()] == [width, height];
                let mut cells = match self.cells.take().filter(fits) {
                    Some(cells) => cells,
                    None => Cells::new(width, height)?,
                };
                let [glows, masked] = [textures.glow.is_some(), textures.masks.is_some()];
                fill(&mut cells, &values, glows, masked);
                shine(&mut cells, settings, lights)?;
                self.cells.insert(cells)
            }
        };
        lay_out(solver.solve(cells)?, &mut self.light);
        Ok(())
    }

    /// The light of the frame that was solved last.
    pub fn light(&self) -> &[[f32; 4]] {
        &self.light
    }

    /// Drops history.
    pub fn reset(&mut self) {
        if let Some(solver) = &mut self.solver {
            solver.reset();
        }
    }
}

/// Fills cells with matter. Values out of their range, which shaders do not mind, are brought into it.
fn fill(cells: &mut Cells, values: &[CellValues], glows: bool, masked: bool) {
    cells.clear();
    let [rgb, share]: [fn(f32) -> f32; 2] = [|v| within(v, f32::MAX), |v| within(v, 1.0)];
    let write = |to: &mut [Rgb], from: fn(&CellValues) -> [f32; 4], within: fn(f32) -> f32| {
        for (to, value) in to.iter_mut().zip(values) {
            let [r, g, b, _] = from(value).map(within);
            *to = [r, g, b];
        }
    };
    write(cells.emission_mut(), |value| value.emission, rgb);
    write(cells.tint_mut(), |value| value.tint_opacity, share);
    write(cells.albedo_mut(), |value| value.albedo_layers, share);
    if glows {
        write(cells.glow_mut(), |value| value.glow, rgb);
    }
    for (to, value) in cells.opacity_mut().iter_mut().zip(values) {
        *to = share(value.tint_opacity[3]);
    }
    if masked {
        for (to, value) in cells.masks_mut().iter_mut().zip(values) {
            let layers = (share(value.albedo_layers[3]) * 255.0).round() as u8;
            // Cells cannot be in no layer, as a texture of the host's may have it.
            *to = if layers == 0 { ALL_LAYERS } else { layers };
        }
    }
}

/// Brings a number into the range from 0 to `most`; NaN is 0.
fn within(v: f32, most: f32) -> f32 {
    if v > 0.0 { v.min(most) } else { 0.0 }
}

/// Sets the lights beside the textures, in cells without lamps. Lamps that the method draws are in the textures already.
fn shine(cells: &mut Cells, settings: &Settings, lights: Lights) -> lamplight::Result<()> {
    let Lights { lamps, suns, sky, inflow } = lights;
    let method = settings.method();
    let by_rule = lamps.iter().filter(|lamp| method.lights_lamps() || method.lights_exactly(lamp));
    cells.lamps_mut().extend(by_rule.cloned());
    cells.suns_mut().clear();
    cells.suns_mut().extend_from_slice(suns);
    cells.set_sky(sky.clone());
    cells.set_inflow(inflow.cloned())
}

/// Lays light out as the GPU does.
fn lay_out(light: &Light, to: &mut Vec<[f32; 4]>) {
    let value = |&[r, g, b]: &Rgb| [r, g, b, 1.0];
    to.clear();
    to.extend(light.pixels().iter().map(value));
    for a in 0..2 {
        to.extend(light.moment().into_iter().flatten().map(|moment| value(&moment[a])));
    }
}
