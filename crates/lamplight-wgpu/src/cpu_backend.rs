//! Light found on the CPU, for devices that are software themselves, or have no compute shaders.

use crate::error::Result;
use crate::frame_input::{FrameInput, Lights, SceneInput};
use crate::grid_size::GridSize;
use crate::matter::Textures;
use crate::planner::FramePlanner;
use crate::stages::matter_values::{GridValues, MatterValues};
use lamplight::internals::BRIGHT;
use lamplight::{ALL_LAYERS, Cells, Light, Rgb, Settings, Solver};
use std::time::Duration;

/// The solver, and what it reads.
#[derive(Debug)]
pub struct CpuBackend {
    solver: Option<Solver>,
    /// True if a frame waits for the matter of the host's textures. Otherwise it shows the light of that which has arrived,
    /// as in browsers, where nothing can wait.
    waits: bool,
    /// Compiled when a host's textures are first lit.
    values: Option<MatterValues>,
    request: Option<Request>,
    /// The place of the grid whose light was found last, if that is known.
    solved: Option<[i32; 2]>,
    /// True if the last frame found light of its own.
    has_found: bool,
    /// The light as the GPU lays it out: of all cells, then both components of its first moment.
    light: Vec<[f32; 4]>,
}

/// The frame whose matter was requested.
#[derive(Debug)]
struct Request {
    /// Its cells, with its lights.
    cells: Cells,
    settings: Settings,
    origin: [i32; 2],
}

/// True where a frame can wait for the GPU.
pub const CAN_WAIT: bool = cfg!(not(target_arch = "wasm32"));

impl CpuBackend {
    /// Creates one that waits for the matter of the host's textures, or not.
    pub fn new(waits: bool) -> Self {
        Self {
            solver: None,
            waits,
            values: None,
            request: None,
            solved: None,
            has_found: false,
            light: Vec::new(),
        }
    }

    /// Finds the light of a frame.
    pub fn solve(&mut self, planner: &FramePlanner, input: &FrameInput) -> Result<()> {
        self.has_found = false;
        match input.scene {
            SceneInput::Cells(cells) => self.find(input.settings, cells, input.origin)?,
            SceneInput::Textures { textures, lights } => {
                let mut values = match self.values.take() {
                    Some(values) => values,
                    None => MatterValues::new(planner)?,
                };
                let found = self.light_textures(planner, input, &mut values, (textures, lights));
                self.values = Some(values);
                found?;
            }
        }
        let light = self.solver.as_ref().map(Solver::light).filter(|light| light.width() > 0);
        let place = self.solved.unwrap_or(input.origin);
        let moved = [0, 1].map(|a| input.origin[a].saturating_sub(place[a]));
        lay_out(light, moved, planner.size.into(), &mut self.light);
        self.light.resize(planner.light_values() as usize, [0.0; 4]);
        Ok(())
    }

    /// Finds the light of a host's textures.
    fn light_textures(
        &mut self,
        planner: &FramePlanner,
        input: &FrameInput,
        values: &mut MatterValues,
        (textures, lights): (&Textures, Lights),
    ) -> Result<()> {
        let request = |backend: &mut Self, values: &mut MatterValues| -> Result<()> {
            backend.request = Some(backend.prepare(planner.size, input, textures, lights)?);
            values.request(planner, textures)
        };
        if self.waits {
            request(self, values)?;
        }
        let mut made = self.request.take();
        let has_arrived = values.read(self.waits, |values| {
            if let Some(Request { cells, .. }) = &mut made {
                fill(cells, values);
            }
        });
        let found = match (&has_arrived, &made) {
            (Ok(true), Some(Request { cells, settings, origin })) => {
                self.find(settings, cells, *origin)
            }
            _ => Ok(()),
        };
        self.request = made;
        has_arrived?;
        found?;
        if !self.waits && !values.is_requested() {
            request(self, values)?;
        }
        Ok(())
    }

    /// Prepares the cells of a frame, without their matter.
    fn prepare(
        &mut self,
        size: GridSize,
        input: &FrameInput,
        textures: &Textures,
        lights: Lights,
    ) -> Result<Request> {
        let [width, height] = size.into();
        let known = self.request.take().map(|request| request.cells);
        let known = known.filter(|cells| [cells.width(), cells.height()] == [width, height]);
        let mut cells = match known {
            Some(cells) => cells,
            None => Cells::new(width, height)?,
        };
        cells.clear();
        if textures.glow.is_some() {
            cells.glow_mut();
        }
        if textures.masks.is_some() {
            cells.masks_mut();
        }
        shine(&mut cells, input.settings, lights)?;
        input.settings.method().suits(&cells)?;
        Ok(Request { cells, settings: input.settings.clone(), origin: input.origin })
    }

    /// Finds the light of cells, whose grid lies at `origin`.
    fn find(&mut self, settings: &Settings, cells: &Cells, origin: [i32; 2]) -> Result<()> {
        let solver = match &mut self.solver {
            Some(solver) => {
                solver.set_settings(settings.clone())?;
                solver
            }
            none => none.insert(Solver::new(settings.clone())?),
        };
        let before = self.solved.unwrap_or(origin);
        let moved = [0, 1].map(|a| origin[a].saturating_sub(before[a]));
        solver.shift(moved);
        if let Err(error) = solver.solve(cells) {
            solver.shift(moved.map(i32::saturating_neg));
            return Err(error.into());
        }
        self.solved = Some(origin);
        self.has_found = true;
        Ok(())
    }

    /// The light of the frame that was prepared last.
    pub fn light(&self) -> &[[f32; 4]] {
        &self.light
    }

    /// The times of the stages of the last frame; none if it found no light of its own.
    pub fn timings(&self) -> &[(&'static str, Duration)] {
        let solver = self.solver.as_ref().filter(|_| self.has_found);
        solver.map_or(&[], Solver::timings)
    }

    /// Drops history. Until matter arrives, the light that was found last stays where it is.
    pub fn reset(&mut self) {
        if let Some(solver) = &mut self.solver {
            solver.reset();
        }
        if let Some(values) = &mut self.values {
            values.forget();
        }
        self.solved = None;
    }
}

/// Fills cells with matter. Values out of their range, which shaders do not mind, are brought into it.
fn fill(cells: &mut Cells, values: &GridValues) {
    let [rgb, share]: [fn(f32) -> f32; 2] = [|v| within(v, BRIGHT), |v| within(v, 1.0)];
    let write = |to: &mut [Rgb], part: usize, within: fn(f32) -> f32| {
        for (to, value) in to.iter_mut().zip(values.part(part)) {
            let [r, g, b, _] = value.map(within);
            *to = [r, g, b];
        }
    };
    write(cells.emission_mut(), GridValues::EMISSION, rgb);
    write(cells.tint_mut(), GridValues::TINT_OPACITY, share);
    write(cells.albedo_mut(), GridValues::ALBEDO_LAYERS, share);
    if cells.glow().is_some() {
        write(cells.glow_mut(), GridValues::GLOW, rgb);
    }
    for (to, [.., opacity]) in
        cells.opacity_mut().iter_mut().zip(values.part(GridValues::TINT_OPACITY))
    {
        *to = share(opacity);
    }
    if cells.masks().is_some() {
        let of_cells = values.part(GridValues::ALBEDO_LAYERS);
        for (to, [.., layers]) in cells.masks_mut().iter_mut().zip(of_cells) {
            let layers = (share(layers) * 255.0).round() as u8;
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

/// Lays light out as the GPU does, for a grid of this size that has moved by so many cells since; cells beyond the border of
/// that light show what it is there. Without light they are dark.
fn lay_out(light: Option<&Light>, moved: [i32; 2], size: [u32; 2], to: &mut Vec<[f32; 4]>) {
    to.clear();
    let Some(light) = light else { return };
    let value = |&[r, g, b]: &Rgb| [r, g, b, 1.0];
    let found = [light.width(), light.height()];
    if found == size && moved == [0; 2] {
        to.extend(light.pixels().iter().map(value));
        for a in 0..2 {
            to.extend(light.moment().into_iter().flatten().map(|moment| value(&moment[a])));
        }
        return;
    }
    let place = |at: u32, a: usize| {
        (i64::from(at) + i64::from(moved[a])).clamp(0, i64::from(found[a]) - 1) as usize
    };
    let columns: Vec<usize> = (0..size[0]).map(|x| place(x, 0)).collect();
    let rows = (0..size[1]).map(|y| place(y, 1) * found[0] as usize);
    let cells = || rows.clone().flat_map(|row| columns.iter().map(move |column| row + column));
    to.extend(cells().map(|cell| value(&light.pixels()[cell])));
    if let Some(moment) = light.moment() {
        for a in 0..2 {
            to.extend(cells().map(|cell| value(&moment[cell][a])));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiler::Compiler;
    use crate::hints::SceneHints;
    use crate::matter::Upload;
    use crate::options::LightingOptions;
    use crate::planner::Grid;
    use crate::shared::Shared;
    use lamplight::{Matter, Method};
    use wgpu::{Instance, InstanceDescriptor, PollType};

    const SIZE: [u32; 2] = [37, 23];

    #[test]
    fn light_that_is_late_is_shown_where_it_belongs() {
        let instance = Instance::new(InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&Default::default()))
            .expect("no GPU; on Debian: apt-get install mesa-vulkan-drivers");
        let device = adapter.request_device(&Default::default());
        let (device, queue) = pollster::block_on(device).unwrap();
        let settings = Settings { moment: true, ..Settings::new(Method::Holographic) };
        let mut cells = Cells::new(SIZE[0], SIZE[1]).unwrap();
        let lamp = Matter { emission: [4.0, 2.0, 1.0], opacity: 1.0, ..Matter::EMPTY };
        cells.set(9, 7, lamp);
        let size = GridSize::new(&device, SIZE).unwrap();
        let mut upload = Upload::new(&device, size).unwrap();
        upload.write(&device, &queue, &cells, &settings.method);
        let shared = Shared::new(Compiler::new(&device), &queue);
        let grid = Grid { size, textures: &upload.textures, hints: SceneHints::UNKNOWN };
        let planner = FramePlanner::new(&shared, &settings, LightingOptions::default(), grid);
        let input = FrameInput::of_textures(&settings, &upload.textures, Lights::default());

        let mut prompt = CpuBackend::new(true);
        prompt.solve(&planner, &input).unwrap();
        let right = prompt.light;
        assert!(right[0][0] > 0.0, "it is dark");
        let mut late = CpuBackend::new(false);
        late.solve(&planner, &input).unwrap();
        assert!(late.light == vec![[0.0; 4]; right.len()], "nothing has arrived");
        device.poll(PollType::wait_indefinitely()).unwrap();
        late.solve(&planner, &input).unwrap();
        assert!(late.light == right);
        assert!(!late.timings().is_empty());
        // The grid moves, and what arrives is still that of a place before.
        for origin in [[3, -2], [5, -4], [-7, 9]] {
            late.solve(&planner, &FrameInput { origin, ..input }).unwrap();
            let solved = late.solved.unwrap();
            assert_ne!(solved, origin, "it has not been late");
            let moved = [0, 1].map(|a| origin[a] - solved[a]);
            for (i, found) in late.light.iter().enumerate() {
                let [columns, rows] = SIZE.map(|side| side as i32);
                let (part, at) = (i as i32 / (columns * rows), i as i32 % (columns * rows));
                let x = (at % columns + moved[0]).clamp(0, columns - 1);
                let y = (at / columns + moved[1]).clamp(0, rows - 1);
                let expected = right[((part * rows + y) * columns + x) as usize];
                assert_eq!(*found, expected, "{moved:?}, {part}, {x}, {y}");
            }
        }
        // After a cut the light stays, as it is, and what was requested before is not found any more.
        late.reset();
        device.poll(PollType::wait_indefinitely()).unwrap();
        late.solve(&planner, &FrameInput { origin: [900, 900], ..input }).unwrap();
        assert!(late.light == right && late.timings().is_empty());
        // A grid of another size is dark at no time.
        let other = GridSize::new(&device, [20, 30]).unwrap();
        let mut upload = Upload::new(&device, other).unwrap();
        upload.write(&device, &queue, &Cells::new(20, 30).unwrap(), &settings.method);
        let grid = Grid { size: other, textures: &upload.textures, hints: SceneHints::UNKNOWN };
        let planner = FramePlanner::new(&shared, &settings, LightingOptions::default(), grid);
        let input = FrameInput::of_textures(&settings, &upload.textures, Lights::default());
        late.solve(&planner, &input).unwrap();
        assert_eq!(late.light.len(), 3 * 600);
        assert!(late.light[0] == right[0], "it has lost its light");
    }
}
