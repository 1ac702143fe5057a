//! The middleware: a host creates it once, and prepares and records it every frame.

mod checked_scene;
mod frame_lights;
mod plan;
mod prepared_frame;
mod stage_pipelines;

#[cfg(not(target_arch = "wasm32"))]
use crate::ahead::Ahead;
use crate::compiler::Compiler;
use crate::cost::Cost;
use crate::cpu_backend::{CAN_WAIT, CpuBackend};
use crate::error::{CreateError, PrepareError, ReadBackError, RecordError, Result};
use crate::error_scope::with_error_scope;
use crate::frame_input::{FrameInput, Lights, SceneInput};
use crate::frame_plan::{FramePlan, PlanIds, TextureSource};
use crate::grid_size::GridSize;
use crate::inflow::InflowTexture;
use crate::matter::{Textures, Upload};
use crate::methods::Method;
use crate::options::{Backend, LightingOptions};
use crate::panorama::PanoramaTexture;
use crate::pipeline_cache::PipelineCache;
use crate::planner::{FramePlanner, Grid};
use crate::read_back::read_back;
use crate::shared::Shared;
use crate::stage::Stage;
use crate::timing::Timer;
use crate::trial::{Trial, TrialStep};
use crate::uniforms::{FrameUniforms, GridPosition, History};
use checked_scene::{CheckedScene, check_without_compute};
use frame_lights::FrameLights;
use lamplight::internals::temporal::shine_alike;
use lamplight::{ALL_LAYERS, Lamp, Settings, Sky, Sun};
use plan::PlanSources;
use prepared_frame::PreparedFrame;
use stage_pipelines::{NeededStages, StagePipelines};
use std::sync::{Arc, PoisonError};
use std::time::Duration;
use wgpu::{Buffer, CommandEncoder, ComputePassDescriptor, Device, Queue, TextureView};

/// Finds light on the host's device, or beside it ([`Backend`]).
///
/// Each frame, [`Self::prepare`] it from a [`FrameInput`], then [`Self::record`] it. Pipelines are compiled when
/// they are first used, by [`Self::precompile`], or in the background ([`LightingOptions::compile_ahead`]), and
/// buffers are created when the size of the grid changes; in the steady state nothing is created. Any number of
/// instances can share a device, and those made by [`Self::beside`] their pipelines too; each stays with the device
/// and the queue it was created with.
///
/// If the device rejects something that is created, such as a binding to a texture of another device, the error
/// is returned as [`crate::error::DeviceError`]. In a browser, which reports it only later, it goes to the host's
/// handler of uncaptured errors. So do errors that appear only when something is used, in every frame: a queue
/// of another device, a texture that was destroyed. A texture of another [`wgpu::Instance`] is not detected.
/// A lost device does nothing: frames are prepared and recorded as if it were there, and [`crate::read_back`]
/// returns an error.
#[derive(Debug)]
pub struct Lighting {
    options: LightingOptions,
    /// Set if the CPU finds the light.
    cpu: Option<CpuBackend>,
    /// Set while the faster backend is not known.
    trial: Option<Trial>,
    shared: Shared,
    pipelines: PipelineCache,
    stages: StagePipelines,
    upload: Option<Upload>,
    lights: FrameLights,
    frame: Option<PreparedFrame>,
    /// Frames prepared since the last reset.
    number: u32,
    before: Option<FrameBefore>,
    plan_ids: PlanIds,
    /// The pipelines that the last frame had to compile.
    compiled: usize,
    /// Set if pipelines are compiled ahead.
    #[cfg(not(target_arch = "wasm32"))]
    ahead: Option<Ahead>,
}

/// The light of a prepared frame, and the matter that it falls on: the inputs of the compose pass.
pub struct ComposeInputs<'a> {
    pub size: [u32; 2],
    pub textures: &'a Textures,
    /// Emission in place of the textures'.
    pub shown: Option<&'a TextureView>,
    pub light: &'a Buffer,
    /// The light as a texture, in its place, on a device without storage buffers.
    pub light_texture: Option<&'a TextureView>,
    pub frame: &'a Buffer,
    /// The elevation of light, if its first moment is behind it.
    pub elevation: Option<f32>,
    /// The normals of the cells, if they have some.
    pub normals: Option<&'a TextureView>,
}

/// The frame that history comes from.
#[derive(Debug)]
struct FrameBefore {
    size: GridSize,
    origin: [i32; 2],
    sky: Sky,
    /// Exact ones.
    lamps: Vec<Lamp>,
    suns: Vec<Sun>,
    has_inflow: bool,
}

impl FrameBefore {
    /// In the memory of the one before.
    fn new(before: Option<Self>, size: GridSize, origin: [i32; 2], lights: Lights) -> Self {
        let kept = before.map(|before| (before.lamps, before.suns));
        let (mut lamps, mut suns) = kept.unwrap_or_default();
        lamps.clear();
        lamps.extend(lights.lamps.iter().filter(|lamp| lamp.is_exact()).cloned());
        suns.clear();
        suns.extend_from_slice(lights.suns);
        let has_inflow = lights.inflow.is_some();
        Self { size, origin, sky: lights.sky.clone(), lamps, suns, has_inflow }
    }
}

impl Lighting {
    /// Creates what all methods share. Pipelines are compiled when they are first used, or ahead.
    pub fn new(
        device: &Device,
        queue: &Queue,
        options: &LightingOptions,
    ) -> Result<Self, CreateError> {
        Self::with_compiler(Compiler::new(device), queue, options)
    }

    /// Another instance on the same device, as for the other half of a split screen. They share the pipelines that either
    /// of them compiles, and nothing else.
    pub fn beside(&self, options: &LightingOptions) -> Result<Self, CreateError> {
        let Shared { compiler, queue, .. } = &self.shared;
        Self::with_compiler(compiler.share(), queue, options)
    }

    fn with_compiler(
        compiler: Compiler,
        queue: &Queue,
        options: &LightingOptions,
    ) -> Result<Self, CreateError> {
        options.check()?;
        let device = &compiler.device.clone();
        let backend = options.backend.on(device);
        with_error_scope(device, || {
            let shared = Shared::new(compiler, queue);
            let fastest = backend == Backend::Fastest;
            Ok(Self {
                options: *options,
                cpu: (backend == Backend::Cpu).then(|| CpuBackend::new(CAN_WAIT)),
                trial: fastest.then(|| Trial::new(device, queue)).flatten(),
                pipelines: PipelineCache::default(),
                stages: StagePipelines::new(&shared.compiler),
                shared,
                upload: None,
                lights: FrameLights::default(),
                frame: None,
                number: 0,
                before: None,
                plan_ids: PlanIds::default(),
                compiled: 0,
                #[cfg(not(target_arch = "wasm32"))]
                ahead: options.compiles_ahead(device).then(Ahead::default),
            })
        })
    }

    /// Compiles the pipelines of a method with its settings, for frames without inflow. Those of the last sixteen settings
    /// are cached.
    ///
    /// The first frame may still compile what other frames share: the light of walls, and if there are any, suns and exact
    /// lamps, sight and the distance field. Cells with normals are lit with `moment`, so set that here too.
    ///
    /// It waits for all of them. Changes to settings or the scene that were not precompiled are compiled in the
    /// background ([`LightingOptions::compile_ahead`]).
    pub fn precompile(&mut self, settings: &Settings) -> Result<(), CreateError> {
        settings.check()?;
        let Shared { compiler, queue, .. } = &self.shared;
        if self.cpu.is_none() {
            self.pipelines.method::<CreateError>(compiler, queue, settings, false)?;
            let method = |compiler: &_| Method::new(compiler, queue, settings, false);
            let (_, programs) = compiler.programs_of(method)?;
            for program in programs {
                (0..program.entries()).try_for_each(|entry| program.compile_ahead(entry))?;
            }
        }
        Ok(())
    }

    /// Prepares the next frame, to be recorded and submitted: noise advances, history and feedback accumulate.
    ///
    /// Changing the seed, the sky, lamps, the elevation of light, or the contents of cells or textures is free. (A
    /// panorama or an inflow is uploaded when it has changed, and planned for if it has another number of columns, or if
    /// the frame before had none; cookies are uploaded when there is one that no lamp had before, and planned for when
    /// they need more room.) Other texture views of the same size are bound again, and history goes on. Another size or
    /// `wall_depth` reallocates buffers; any other change of settings compiles those pipelines that no frame has used
    /// yet, unless that is done ahead.
    ///
    /// # Errors
    /// If the input is invalid or the device cannot light it. The frame before then stays prepared.
    pub fn prepare(&mut self, input: &FrameInput) -> Result<()> {
        input.settings.check()?;
        let normals = matches!(input.scene, SceneInput::Cells(cells) if cells.normals().is_some());
        let moment = input.settings.moment || normals;
        let settings = Settings { moment, ..input.settings.clone() };
        let input = &FrameInput { settings: &settings, ..*input };
        // The upload is taken out of `self`, so that its textures can be borrowed beside it.
        let mut upload = self.upload.take();
        let waits = self.shared.compiler.waits();
        let prepared = CheckedScene::new(&self.shared, input, &mut upload)
            .and_then(|scene| self.prepare_scene(input, &scene));
        self.upload = upload;
        self.compiled = self.shared.compiler.waits() - waits;
        if prepared.is_err()
            && let Some(frame) = &mut self.frame
        {
            // History was moved when the frame was recorded.
            (frame.moved, frame.resize) = (false, None);
        }
        if let Err(PrepareError::Device(_)) = prepared {
            // Pipelines may be invalid.
            self.shared.compiler.forget();
        }
        prepared
    }

    fn prepare_scene(&mut self, input: &FrameInput, scene: &CheckedScene) -> Result<()> {
        let CheckedScene { grid, lights, .. } = scene;
        if !self.shared.has_compute {
            check_without_compute(input)?;
        }
        let Lights { lamps, suns, sky, inflow } = *lights;
        let sky = &self.lights.sun_glow.draw(input.settings.method(), sky, suns);
        // The CPU has its own copy.
        let inflow = inflow.filter(|_| self.cpu.is_none());
        let lights = Lights { lamps, suns, sky, inflow };
        let (history, moved) = self.history(input, grid.size, lights);
        if let Some(cpu) = &mut self.cpu {
            let planner = FramePlanner::new(&self.shared, input.settings, self.options, *grid);
            cpu.solve(&planner, input)?;
        }
        let method = self.method(input.settings, inflow.is_some())?;
        let method = method.as_deref();
        self.lights.set(&self.shared.device, method, input, grid.size, lights)?;
        let needed = self.needed_stages(input);
        self.stages.compile(&self.shared.compiler, input.settings, needed)?;
        let sources = self.plan_sources();
        let fresh = match self.frame.as_ref().filter(|frame| self.serves(frame, input, grid)) {
            Some(_) => None,
            None => Some(sources.frame(method, input.settings, grid, self.before.is_some())?),
        };
        let Some(frame) = fresh.as_ref().or(self.frame.as_ref()) else { return Ok(()) };
        let size_before = self.before.as_ref().map_or(grid.size, |before| before.size);
        // History of another size has been moved with the plan.
        let moves = moved != [0; 2] && size_before == grid.size;
        let extras = sources.extras(frame, input, moves)?;
        let position = GridPosition {
            size: grid.size.into(),
            origin: input.origin,
            moved,
            size_before: size_before.into(),
        };
        let uniforms = FrameUniforms::new(position, lights, input.settings, self.number, history)?;

        // Nothing fails from here on.
        let is_fresh = fresh.is_some();
        self.frame = fresh.or(self.frame.take());
        let Some(frame) = &mut self.frame else { return Ok(()) };
        if !is_fresh {
            frame.resize = None;
        }
        frame.show(input, scene);
        frame.moved = moves;
        frame.add(extras);
        let queue = &self.shared.queue;
        queue.write_buffer(&self.shared.frame, 0, bytemuck::bytes_of(&uniforms));
        self.lights.write(queue, frame, lights);
        if let Some(cpu) = &self.cpu {
            frame.write_light(queue, cpu.light());
        }
        #[cfg(not(target_arch = "wasm32"))]
        if let (Some(ahead), None) = (&mut self.ahead, &self.cpu) {
            ahead.follow(&self.shared.compiler, queue, input.settings, inflow.is_some());
        }
        let before = self.before.take();
        self.before = Some(FrameBefore::new(before, grid.size, input.origin, lights));
        self.number = self.number.wrapping_add(1);
        self.try_backends(input, *grid);
        Ok(())
    }

    /// Returns the method that finds light on the GPU, if it does.
    fn method(&mut self, settings: &Settings, inflow: bool) -> Result<Option<Arc<Method>>> {
        let Shared { queue, compiler, .. } = &self.shared;
        let by_gpu = self.cpu.is_none();
        by_gpu.then(|| self.pipelines.method(compiler, queue, settings, inflow)).transpose()
    }

    /// The stages that the next frame needs.
    fn needed_stages(&self, input: &FrameInput) -> NeededStages {
        let by_gpu = self.cpu.is_none();
        // Plans keep the room that lights once had, and shine the ones that return into it.
        let had_direct = self.frame.as_ref().is_some_and(|frame| frame.capacity.has_direct());
        NeededStages {
            distance: input.distance_field,
            sight: !input.sights.is_empty(),
            direct: by_gpu && (self.lights.needed().has_direct() || had_direct),
            moment: by_gpu && input.settings.moment,
        }
    }

    fn plan_sources(&self) -> PlanSources<'_> {
        let Self { shared, options, stages, lights, frame, .. } = self;
        PlanSources { shared, options: *options, stages, lights, before: frame.as_ref() }
    }

    /// Returns whether a plan serves the next frame.
    fn serves(&self, frame: &PreparedFrame, input: &FrameInput, grid: &Grid) -> bool {
        frame.serves(grid, input.settings, self.lights.needed())
            && frame.by_cpu == self.cpu.is_some()
            && frame.strips.as_ref() == self.lights.strips()
            && frame.cookies == self.lights.cookies.view
    }

    /// Goes on with the trial of both backends, if there is one: finds a frame on the CPU too, or chooses what finds the
    /// next frame's light.
    fn try_backends(&mut self, input: &FrameInput, grid: Grid) {
        // Browsers have no trials, and their page no room for one.
        if cfg!(target_arch = "wasm32") {
            return;
        }
        let Some(mut trial) = self.trial.take() else { return };
        match trial.next() {
            TrialStep::TimeGpu => {}
            TrialStep::TimeCpu => {
                let planner = FramePlanner::new(&self.shared, input.settings, self.options, grid);
                // Frames that the CPU cannot light stay with the GPU.
                if trial.cpu.solve(&planner, input).is_err() {
                    return;
                }
                trial.add_cpu(trial.cpu.timings().iter().map(|(_, time)| *time).sum());
            }
            TrialStep::Choose(Backend::Cpu) => {
                self.cpu = Some(trial.cpu);
                return;
            }
            TrialStep::Choose(_) => return,
        }
        self.trial = Some(trial);
    }

    /// Returns the history of the next frame, and by how many cells the grid has moved.
    fn history(&self, input: &FrameInput, size: GridSize, lights: Lights) -> (History, [i32; 2]) {
        let Some(before) = &self.before else { return (History::None, [0; 2]) };
        let raymarch = input.settings.method.as_raymarch();
        let rejects = raymarch.is_none_or(|raymarch| raymarch.temporal.reject);
        let shine_alike = || {
            before.has_inflow == lights.inflow.is_some()
                && shine_alike([&before.lamps, lights.lamps], [&before.suns, lights.suns])
        };
        let is_lit_alike = before.sky == *lights.sky && (raymarch.is_none() || shine_alike());
        let indirect_only = (rejects && !is_lit_alike) || before.size != size;
        let history = if indirect_only { History::IndirectOnly } else { History::Full };
        (history, [0, 1].map(|a| input.origin[a].saturating_sub(before.origin[a])))
    }

    /// Drops history: the next frame starts as after a cut, or after a jump of the camera.
    pub fn reset(&mut self) {
        self.number = 0;
        self.before = None;
        let trial = self.trial.as_mut().map(|trial| &mut trial.cpu);
        self.cpu.iter_mut().chain(trial).for_each(CpuBackend::reset);
    }

    /// The number of pipelines that [`Self::prepare`] had to compile last: none in the steady state, nor after a change
    /// that was compiled ahead. Those that an instance [beside](Self::beside) it compiled meanwhile count too.
    pub fn compiled(&self) -> usize {
        self.compiled
    }

    /// Waits until the pipelines that frames may need next are compiled ([`LightingOptions::compile_ahead`]), as behind a
    /// loading screen.
    pub fn wait_for_pipelines(&mut self) {
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(ahead) = &mut self.ahead {
            ahead.wait();
        }
    }

    /// Returns what will find the light of the next frame that is prepared: `Gpu` or `Cpu`. With [`Backend::Fastest`] it may
    /// change in the first frames.
    pub fn backend(&self) -> Backend {
        if self.cpu.is_some() { Backend::Cpu } else { Backend::Gpu }
    }

    /// The time that each stage of the frame prepared last took on the CPU, in order; empty if the CPU found no light in it.
    pub fn timings_on_cpu(&self) -> &[(&'static str, Duration)] {
        let is_by_cpu = self.frame.as_ref().is_some_and(|frame| frame.by_cpu);
        self.cpu.as_ref().filter(|_| is_by_cpu).map_or(&[], CpuBackend::timings)
    }

    /// Records the frame that was prepared last into `encoder`. Does not submit or wait.
    ///
    /// # Errors
    /// Returns [`RecordError::NotPrepared`] if no frame has been prepared.
    pub fn record(&self, encoder: &mut CommandEncoder) -> Result<(), RecordError> {
        let frame = self.prepared()?;
        if let Some(timer) = self.trial.as_ref().and_then(Trial::timer) {
            let mut timer = timer.lock().unwrap_or_else(PoisonError::into_inner);
            timer.record(encoder, frame.dispatches());
            return Ok(());
        }
        if frame.dispatches().next().is_none() {
            // The CPU's light is there already, and the device may have no compute passes.
            return Ok(());
        }
        let descriptor = ComputePassDescriptor { label: Some("lamplight"), timestamp_writes: None };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        frame.dispatches().for_each(|dispatch| dispatch.record(&mut pass));
        Ok(())
    }

    /// Like [`Self::record`], and times each stage, which is a pass of its own then. With [`Backend::Fastest`] the first
    /// frames are timed for its choice instead.
    pub fn record_timed(
        &self,
        encoder: &mut CommandEncoder,
        timer: &mut Timer,
    ) -> Result<(), RecordError> {
        if self.trial.as_ref().and_then(Trial::timer).is_some() {
            return self.record(encoder);
        }
        timer.record(encoder, self.prepared()?.dispatches());
        Ok(())
    }

    fn prepared(&self) -> Result<&PreparedFrame, RecordError> {
        self.frame.as_ref().ok_or(RecordError::NotPrepared)
    }

    /// The settings of the frame prepared last, with `moment` if its cells have normals; `None` before the first.
    pub fn settings(&self) -> Option<&Settings> {
        self.frame.as_ref().map(|frame| &frame.settings)
    }

    /// The buffer of a stage's result, row by row. `None` if the frame prepared last does not make it.
    pub fn stage(&self, stage: Stage) -> Option<&Buffer> {
        let PreparedFrame { passes, fields, records_fields, sight, records_sight, .. } =
            self.frame.as_ref()?;
        if stage == Stage::Sight {
            return sight.as_ref().filter(|_| *records_sight).map(|sight| &sight.visibility);
        }
        let fields = fields.iter().filter(|_| *records_fields);
        let mut stages = fields.flat_map(|fields| &fields.stages).chain(&passes.stages);
        stages.find(|(name, _)| *name == stage).map(|(_, buffer)| buffer)
    }

    /// The inputs of the compose pass; `None` before the first frame.
    pub(crate) fn compose_inputs(&self) -> Option<ComposeInputs<'_>> {
        let PreparedFrame {
            size, textures, shown, normals, light, light_texture, settings, ..
        } = self.frame.as_ref()?;
        let light_texture = light_texture.as_ref();
        let (size, shown, frame) = ((*size).into(), shown.as_ref(), &self.shared.frame);
        let elevation = settings.moment.then_some(settings.elevation);
        let normals = normals.as_ref();
        Some(ComposeInputs {
            size,
            textures,
            shown,
            light,
            light_texture,
            frame,
            elevation,
            normals,
        })
    }

    /// The cost of the frame prepared last; `None` before the first.
    pub fn cost(&self) -> Option<Cost> {
        let frame = self.frame.as_ref()?;
        let sight = frame.sight.as_ref().map_or(0, |sight| sight.memory);
        Some(Cost::new(frame.dispatches(), frame.memory + sight))
    }

    /// The frame prepared last as data, for engines that run it on a device of their own ([`crate::frame_plan`]).
    ///
    /// It waits for copies of the buffers that it lists with their contents. Ask for it after [`Self::prepare`], before
    /// the host writes anything to its textures.
    ///
    /// # Errors
    /// If no frame has been prepared, or as [`read_back`].
    pub fn frame_plan(&mut self) -> Result<FramePlan, ReadBackError> {
        let Self { frame, plan_ids, shared, lights, .. } = self;
        let FrameLights { cookies, panorama, inflow, .. } = lights;
        let frame = frame.as_ref().ok_or(ReadBackError::NothingLit)?;
        let bytes =
            |texels: &[[f32; 4]]| TextureSource::Texels(bytemuck::cast_slice(texels).to_vec());
        let of = |view: &Option<TextureView>, asked: &TextureView| view.as_ref() == Some(asked);
        let source = |view: &TextureView| {
            let Textures { emission, tint_opacity, albedo, glow, masks } = &frame.textures;
            Some(match view {
                view if view == emission => TextureSource::Emission,
                view if view == tint_opacity => TextureSource::TintOpacity,
                view if view == albedo => TextureSource::Albedo,
                view if of(glow, view) => TextureSource::Glow,
                view if of(masks, view) => TextureSource::Masks,
                view if of(&frame.strips, view) => {
                    let panorama = panorama.as_ref().map(PanoramaTexture::texels);
                    bytes(&inflow.as_ref().map(InflowTexture::texels).or(panorama)?)
                }
                view if of(&frame.cookies, view) => bytes(&cookies.texels()),
                view if *view == shared.all_layers => TextureSource::Texels(vec![ALL_LAYERS]),
                view if *view == shared.no_panorama => bytes(&[[0.0; 4]]),
                view if *view == shared.no_cookies => bytes(&[[0.0; 4]]),
                view if frame.output.as_ref().is_some_and(|output| output.picture == *view) => {
                    TextureSource::Output
                }
                _ => return None,
            })
        };
        let contents = |buffer: &Buffer| read_back(&shared.device, &shared.queue, buffer);
        FramePlan::new(frame.dispatches(), &frame.light, plan_ids, source, contents)
    }

    /// The host's device and queue.
    pub(crate) fn device(&self) -> (&Device, &Queue) {
        (&self.shared.device, &self.shared.queue)
    }
}
