//! The middleware: a host creates it once, and prepares and records it every frame.

#[cfg(not(target_arch = "wasm32"))]
use crate::ahead::Ahead;
use crate::compiler::Compiler;
use crate::cookies::CookieAtlas;
use crate::cost::Cost;
use crate::cpu_backend::{CAN_WAIT, CpuBackend};
use crate::error::{CreateError, PrepareError, ReadBackError, RecordError, Result};
use crate::error_scope::with_error_scope;
use crate::frame_input::{FrameInput, Lights, SceneInput};
use crate::frame_plan::{FramePlan, PlanIds, TextureSource};
use crate::grid_size::GridSize;
use crate::hints::SceneHints;
use crate::inflow::InflowTexture;
use crate::lamps::{Capacity, LampList};
use crate::matter::{self, Textures, Upload};
use crate::methods::Method;
use crate::options::{Backend, LightingOptions};
use crate::panorama::PanoramaTexture;
use crate::pass_list::PassList;
use crate::pipeline::Dispatch;
use crate::pipeline_cache::{PipelineCache, share_pipelines};
use crate::planner::{FramePlanner, Grid, HistoryBuffer};
use crate::read_back::read_back;
use crate::shared::Shared;
use crate::stage::Stage;
use crate::stages::direct::{Direct, DirectLights, LightBuffers};
use crate::stages::distance::DistancePipelines;
use crate::stages::glow::Glow;
use crate::stages::output::Output;
use crate::stages::reproject::Reproject;
use crate::stages::sight::{SightList, SightPass, SightPipelines};
use crate::stages::walls::{MomentWalls, Walls};
use crate::timing::Timer;
use crate::trial::{Trial, TrialStep};
use crate::uniforms::{FrameUniforms, GridPosition, History};
use lamplight::internals::sky::SunGlow;
use lamplight::internals::temporal::shine_alike;
use lamplight::{ALL_LAYERS, Inflow, Lamp, Settings, Sky, Sun};
use std::sync::PoisonError;
use std::time::Duration;
use wgpu::{
    Buffer, CommandEncoder, ComputePassDescriptor, Device, Queue, TextureUsages, TextureView,
};

/// Finds light on the host's device, or beside it ([`Backend`]).
///
/// Each frame, [`Self::prepare`] it from a [`FrameInput`], then [`Self::record`] it. Pipelines are compiled when
/// they are first used, by [`Self::precompile`], or in the background ([`LightingOptions::compile_ahead`]), and buffers are created when the size of the grid
/// changes; in the steady state nothing is created. Any number of instances can share a device, and those made by
/// [`Self::beside`] their pipelines too; each stays with the device and the queue it was created with.
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
    glow: Glow,
    walls: Walls,
    /// Compiled when the first moment is first asked for.
    moment_walls: Option<MomentWalls>,
    reproject: Reproject,
    output: Output,
    /// Compiled when they are first needed.
    distance: Option<DistancePipelines>,
    /// Compiled when a sun or an exact lamp first shines.
    direct: Option<Direct>,
    /// Compiled when there is first a viewer.
    sight: Option<SightPipelines>,
    upload: Option<Upload>,
    lamps: LampList,
    sun_glow: SunGlow,
    direct_lights: DirectLights,
    sights: SightList,
    /// The sky, if it is a panorama.
    panorama: Option<PanoramaTexture>,
    /// The light that enters in its place, if it differs from place to place.
    inflow: Option<InflowTexture>,
    cookies: CookieAtlas,
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

/// A plan, and the resources that it was made for.
#[derive(Debug)]
struct PreparedFrame {
    settings: Settings,
    size: GridSize,
    textures: Textures,
    /// The emission of the displayed picture, if it is not that of the textures.
    shown: Option<TextureView>,
    normals: Option<TextureView>,
    /// The sky, if it is a panorama, or the inflow in its place.
    strips: Option<TextureView>,
    /// The cookies of lamps, if there are any.
    cookies: Option<TextureView>,
    hints: SceneHints,
    capacity: Capacity,
    /// True if its light comes from the CPU.
    by_cpu: bool,
    light: Buffer,
    /// Its values in rows as long as the grid's, on a device without storage buffers.
    light_texture: Option<TextureView>,
    passes: PassList,
    /// The buffers of suns and exact lamps, written before each frame.
    direct: Option<LightBuffers>,
    /// Bytes of all buffers.
    memory: u64,
    history: Vec<HistoryBuffer>,
    /// Moves history along with the grid; planned when the grid first moves.
    reproject: Option<Vec<Dispatch>>,
    /// True if the grid has moved since the frame before.
    moved: bool,
    /// Takes scattered radiance over from a grid of another size; recorded in the first frame only.
    resize: Option<Dispatch>,
    /// The distance field that the input asks for.
    fields: Option<PassList>,
    /// True if it is recorded in this frame.
    records_fields: bool,
    /// The sight of viewers.
    sight: Option<SightPass>,
    /// True if it is recorded in this frame.
    records_sight: bool,
    output: Option<OutputPass>,
}

/// Writing the light to a texture of the host's.
#[derive(Clone, Debug)]
struct OutputPass {
    picture: TextureView,
    /// None on a device without compute shaders, where the texture is written before each frame.
    dispatch: Option<Dispatch>,
}

/// The additions of a frame to its plan.
struct Extras {
    output: Option<OutputPass>,
    /// Planned now for the first time.
    fields: Option<PassList>,
    reproject: Option<Vec<Dispatch>>,
    /// Planned now for the first time, or for more viewers.
    sight: Option<SightPass>,
    /// Bytes of their buffers, without those of sight.
    memory: u64,
}

/// The scene of an input, checked.
struct CheckedScene<'a> {
    grid: Grid<'a>,
    shown: Option<&'a TextureView>,
    normals: Option<&'a TextureView>,
    lights: Lights<'a>,
}

impl PreparedFrame {
    /// The dispatches of a frame, in order.
    fn dispatches(&self) -> impl Iterator<Item = &Dispatch> + Clone {
        let reproject = self.reproject.iter().flatten().filter(|_| self.moved);
        let fields = self.fields.iter().filter(|_| self.records_fields);
        let fields = fields.flat_map(|fields| &fields.dispatches);
        let sight = self.sight.iter().filter(|_| self.records_sight);
        let sight = sight.flat_map(|sight| &sight.dispatches);
        let output = self.output.iter().filter_map(|output| output.dispatch.as_ref());
        self.resize
            .iter()
            .chain(reproject)
            .chain(fields)
            .chain(sight)
            .chain(&self.passes.dispatches)
            .chain(output)
    }

    /// Returns whether the plan serves a grid under these settings.
    fn serves(&self, grid: &Grid, settings: &Settings, needed: Capacity) -> bool {
        self.textures == *grid.textures
            && self.hints.serves(grid.hints)
            && self.capacity.holds(needed)
            && share_pipelines(&self.settings, settings)
            && self.settings.wall_depth == settings.wall_depth
    }

    fn grid(&self) -> Grid<'_> {
        Grid { size: self.size, textures: &self.textures, hints: self.hints }
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
                glow: Glow::new(&shared.compiler),
                walls: Walls::new(&shared.compiler),
                moment_walls: None,
                reproject: Reproject::new(&shared.compiler),
                output: Output::new(&shared.compiler),
                shared,
                distance: None,
                direct: None,
                sight: None,
                upload: None,
                lamps: LampList::default(),
                sun_glow: SunGlow::default(),
                direct_lights: DirectLights::default(),
                sights: SightList::default(),
                panorama: None,
                inflow: None,
                cookies: CookieAtlas::default(),
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
    /// the frame before had none; cookies are uploaded when there is one that no lamp had before, and planned for when they need more room.) Other texture
    /// views of the same size are bound again, and history goes on. Another size or `wall_depth` reallocates buffers;
    /// any other change of settings compiles those pipelines that no frame has used yet, unless that is done ahead.
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
        let prepared =
            self.check(input, &mut upload).and_then(|scene| self.prepare_scene(input, &scene));
        self.upload = upload;
        self.compiled = self.shared.compiler.waits() - waits;
        if let Err(PrepareError::Device(_)) = prepared {
            // Pipelines may be invalid.
            self.shared.compiler.forget();
        }
        prepared
    }

    /// Checks the scene of an input, and uploads its cells.
    fn check<'a>(
        &self,
        input: &FrameInput<'a>,
        upload: &'a mut Option<Upload>,
    ) -> Result<CheckedScene<'a>> {
        let Shared { device, queue, .. } = &self.shared;
        match input.scene {
            SceneInput::Cells(cells) => {
                cells.check()?;
                let method = input.settings.method();
                method.suits(cells)?;
                let size = GridSize::new(device, [cells.width(), cells.height()])?;
                let uploaded = match upload.take().filter(|upload| upload.size == size) {
                    Some(uploaded) => uploaded,
                    None => with_error_scope(device, || Upload::new(device, size))?,
                };
                let upload = upload.insert(uploaded);
                upload.write(device, queue, cells, &input.settings.method);
                let hints =
                    SceneHints::of(cells, input.settings.method.bounces(input.settings.bounces));
                let grid = Grid { size, textures: &upload.textures, hints };
                let (shown, normals) = (upload.shown.as_ref(), upload.normals.as_ref());
                let (lamps, suns, sky) = (cells.lamps(), cells.suns(), cells.sky());
                let lights = Lights { lamps, suns, sky, inflow: cells.inflow() };
                check_inflow(lights, input.settings, size)?;
                Ok(CheckedScene { grid, shown, normals, lights })
            }
            SceneInput::Textures { textures, lights } => {
                let Lights { lamps, suns, sky, .. } = lights;
                sky.check()?;
                for (i, sun) in suns.iter().enumerate() {
                    sun.check(&format_args!("sun[{i}]"))?;
                }
                for (i, lamp) in lamps.iter().enumerate() {
                    lamp.check(&format_args!("lamp[{i}]"))?;
                }
                let size = GridSize::new(device, textures.size()?)?;
                check_inflow(lights, input.settings, size)?;
                let grid = Grid { size, textures, hints: SceneHints::UNKNOWN };
                Ok(CheckedScene { grid, shown: None, normals: None, lights })
            }
        }
    }

    fn prepare_scene(&mut self, input: &FrameInput, scene: &CheckedScene) -> Result<()> {
        let CheckedScene { grid, shown, normals, lights } = scene;
        if !self.shared.has_compute {
            check_without_compute(input)?;
        }
        let Lights { lamps, suns, sky, inflow } = *lights;
        let sky = &self.sun_glow.draw(input.settings.method(), sky, suns);
        // The CPU has its own copy.
        let inflow = inflow.filter(|_| self.cpu.is_none());
        let lights = Lights { lamps, suns, sky, inflow };
        let (history, moved) = self.history(input, grid.size, lights);
        if let Some(cpu) = &mut self.cpu {
            let planner = FramePlanner::new(&self.shared, input.settings, self.options, *grid);
            cpu.solve(&planner, input)?;
        }
        self.keep_panorama(if inflow.is_some() { &Sky::BLACK } else { sky })?;
        self.keep_inflow(inflow, input.settings)?;
        let Shared { device, queue, compiler, .. } = &self.shared;
        let method = match self.cpu {
            None => {
                let (pipelines, settings) = (&mut self.pipelines, input.settings);
                let enters = inflow.is_some();
                Some(pipelines.method::<PrepareError>(compiler, queue, settings, enters)?)
            }
            Some(_) => None,
        };
        if input.distance_field && self.distance.is_none() {
            let compile = || Ok(DistancePipelines::new(&self.shared.compiler));
            self.distance = Some(with_error_scope::<_, PrepareError>(device, compile)?);
        }
        self.sights.set(input.sights)?;
        if !self.sights.is_empty() && self.sight.is_none() {
            let compile = || Ok(SightPipelines::new(&self.shared.compiler));
            self.sight = Some(with_error_scope::<_, PrepareError>(device, compile)?);
        }
        let size = grid.size.into();
        if let Some(method) = &method {
            self.cookies.set(device, grid.size, lamps)?;
            method.set_lamps(lamps, &self.cookies, size, &mut self.lamps)?;
            self.direct_lights.set(input.settings, lamps, &self.cookies, suns, size)?;
        }
        let needed = self.needed();
        self.lamps.more_follows = needed.has_direct();
        let moment = input.settings.moment;
        let compiled = self.direct.as_ref().is_some_and(|direct| direct.serves(input.settings));
        // Plans keep the room that lights once had, and shine the ones that return into it.
        let had_direct = self.frame.as_ref().is_some_and(|frame| frame.capacity.has_direct());
        if method.is_some() && (needed.has_direct() || had_direct) && !compiled {
            let compile = || Ok(Direct::new(&self.shared.compiler, input.settings));
            self.direct = Some(with_error_scope::<_, PrepareError>(device, compile)?);
        }
        if moment && self.moment_walls.is_none() && method.is_some() {
            let compile = || Ok(MomentWalls::new(&self.shared.compiler));
            self.moment_walls = Some(with_error_scope::<_, PrepareError>(device, compile)?);
        }
        let serves = |frame: &PreparedFrame| {
            frame.serves(grid, input.settings, needed)
                && frame.by_cpu == self.cpu.is_some()
                && frame.strips.as_ref() == self.strips()
                && frame.cookies == self.cookies.view
        };
        let fresh = if self.frame.as_ref().is_some_and(serves) {
            None
        } else {
            Some(self.plan(method.as_deref(), input.settings, grid)?)
        };
        let Some(frame) = fresh.as_ref().or(self.frame.as_ref()) else { return Ok(()) };
        let size_before = self.before.as_ref().map_or(grid.size, |before| before.size);
        // History of another size has been moved with the plan.
        let moves = moved != [0; 2] && size_before == grid.size;
        let extras = self.plan_extras(frame, input, moves)?;
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
        frame.settings.clone_from(input.settings);
        frame.shown = shown.cloned();
        frame.normals = normals.cloned();
        frame.moved = moves;
        frame.records_fields = input.distance_field;
        frame.output = extras.output;
        frame.fields = extras.fields.or(frame.fields.take());
        frame.sight = extras.sight.or(frame.sight.take());
        frame.records_sight = !self.sights.is_empty();
        frame.reproject = extras.reproject.or(frame.reproject.take());
        frame.memory += extras.memory;
        if let Some(lamps) = &frame.passes.lamps {
            self.lamps.write(queue, lamps);
        }
        if let Some(buffers) = &frame.direct {
            self.direct_lights.write(queue, buffers);
        }
        if let Some(sight) = frame.sight.as_ref().filter(|_| frame.records_sight) {
            self.sights.write(queue, sight);
        }
        if let Some(cones) = &mut frame.passes.sky {
            cones.write(queue, sky);
        }
        if let Some(panorama) = &mut self.panorama {
            panorama.write(queue, sky);
        }
        if let (Some(texture), Some(inflow)) = (&mut self.inflow, inflow) {
            texture.write(queue, inflow);
        }
        self.cookies.write(queue);
        if let Some(cpu) = &self.cpu {
            queue.write_buffer(&frame.light, 0, bytemuck::cast_slice(cpu.light()));
            if let Some(texture) = &frame.light_texture {
                matter::write_texels(queue, texture, cpu.light());
                if let Some(output) = &frame.output {
                    let light = &cpu.light()[..grid.size.cells() as usize];
                    matter::write_halves(queue, &output.picture, light);
                }
            }
        }
        queue.write_buffer(&self.shared.frame, 0, bytemuck::bytes_of(&uniforms));
        #[cfg(not(target_arch = "wasm32"))]
        if let (Some(ahead), None) = (&mut self.ahead, &self.cpu) {
            ahead.follow(&self.shared.compiler, queue, input.settings, inflow.is_some());
        }
        let (size, origin, sky) = (grid.size, input.origin, Sky::clone(sky));
        let has_inflow = inflow.is_some();
        let kept = self.before.take().map(|before| (before.lamps, before.suns));
        let (mut kept_lamps, mut kept_suns) = kept.unwrap_or_default();
        kept_lamps.clear();
        kept_lamps.extend(lamps.iter().filter(|lamp| lamp.is_exact()).cloned());
        kept_suns.clear();
        kept_suns.extend_from_slice(suns);
        let (lamps, suns) = (kept_lamps, kept_suns);
        self.before = Some(FrameBefore { size, origin, sky, lamps, suns, has_inflow });
        self.number = self.number.wrapping_add(1);
        self.try_backends(input, *grid);
        Ok(())
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

    /// Keeps a texture for a sky that is a panorama.
    fn keep_panorama(&mut self, sky: &Sky) -> Result<()> {
        let device = &self.shared.device;
        self.panorama = match (sky, self.panorama.take()) {
            (Sky::Panorama(panorama), Some(kept)) if kept.holds(panorama) => Some(kept),
            (Sky::Panorama(panorama), _) => {
                let create = || Ok(PanoramaTexture::new(device, panorama));
                Some(with_error_scope::<_, PrepareError>(device, create)?)
            }
            _ => None,
        };
        Ok(())
    }

    /// Keeps a texture for the inflow, as the method reads it.
    fn keep_inflow(&mut self, inflow: Option<&Inflow>, settings: &Settings) -> Result<()> {
        let device = &self.shared.device;
        let holographic = settings.method.as_holographic();
        let spacing = holographic.map_or(1, |settings| settings.lattice_spacing);
        self.inflow = match (inflow, self.inflow.take()) {
            (Some(inflow), Some(kept)) if kept.holds(inflow, spacing) => Some(kept),
            (Some(inflow), _) => {
                Some(with_error_scope(device, || InflowTexture::new(device, inflow, spacing))?)
            }
            _ => None,
        };
        Ok(())
    }

    /// The panorama, or the inflow in its place.
    fn strips(&self) -> Option<&TextureView> {
        let panorama = self.panorama.as_ref().map(|panorama| &panorama.view);
        self.inflow.as_ref().map(|inflow| &inflow.view).or(panorama)
    }

    /// The capacity that the lights of the next frame need.
    fn needed(&self) -> Capacity {
        let Capacity { exact_lamps, suns, .. } = self.direct_lights.needed();
        Capacity { exact_lamps, suns, ..self.lamps.needed() }
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

    /// Plans a frame. While the size is the same, history continues, and the light stays where it is: until the
    /// next frame it can still be shown.
    fn plan(
        &self,
        method: Option<&Method>,
        settings: &Settings,
        grid: &Grid,
    ) -> Result<PreparedFrame> {
        let before = self.frame.as_ref();
        let resized = before.filter(|frame| self.before.is_some() && frame.size != grid.size);
        let strips = self.strips();
        let capacity = before.map_or(Capacity::default(), |frame| frame.capacity);
        let before = before.filter(|frame| frame.size == grid.size);
        with_error_scope(&self.shared.device, || {
            let planner = FramePlanner::new(&self.shared, settings, self.options, *grid)
                .with_capacity(capacity, self.needed())?
                .with_strips(strips, self.inflow.as_ref().map(InflowTexture::columns))
                .with_cookies(self.cookies.view.as_ref())
                .after(before.map_or(&[], |frame| &frame.history));
            let light = match before {
                Some(frame) if frame.settings.moment == settings.moment => {
                    planner.counted(frame.light.clone())
                }
                _ => planner.buffer::<[f32; 4]>("light", planner.light_values())?,
            };
            let same = before.filter(|frame| frame.light == light);
            let light_texture = match same.and_then(|frame| frame.light_texture.as_ref()) {
                Some(texture) => Some(texture.clone()),
                None if self.shared.has_compute => None,
                None => Some(light_texture(&planner)?),
            };
            let has_direct = method.is_some() && planner.capacity.has_direct();
            let direct = self.direct.as_ref().filter(|_| has_direct);
            let direct = direct.map(|direct| direct.plan(&planner)).transpose()?;
            let (found, direct, shine) = match direct {
                Some((found, buffers, dispatches)) => (Some(found), Some(buffers), dispatches),
                None => (None, None, Vec::new()),
            };
            let planner = planner.with_direct(found);
            let reads_glow = method.is_some() && settings.method.reads_glow();
            let glow = grid.textures.glow.as_ref().filter(|_| reads_glow);
            let media = glow.map(|glow| self.glow.plan(&planner, glow));
            let planner = match &media {
                Some((media, _)) => planner.with_textures(media),
                None => planner,
            };
            let mut passes = match method {
                Some(method) => method.plan(&planner, &light)?,
                // The CPU's, which is written before each frame.
                None => PassList::new(Vec::new(), vec![(Stage::Light, light.clone())]),
            };
            let media = media.iter().map(|(_, dispatch)| dispatch.clone());
            passes.dispatches.splice(0..0, shine.into_iter().chain(media));
            if method.is_some() {
                if let Some(walls) = self.moment_walls.as_ref().filter(|_| settings.moment) {
                    passes.dispatches.extend(walls.plan(&planner, &light)?);
                }
                passes.dispatches.extend(self.walls.plan(&planner, &light)?);
            }
            if let Some(lamps) = &passes.lamps {
                // Written here too, so that a lost device is reported.
                self.lamps.write(&self.shared.queue, lamps);
            }
            if let Some(buffers) = &direct {
                self.direct_lights.write(&self.shared.queue, buffers);
            }
            // It is bound to the light of the plan before.
            let output = before.filter(|frame| frame.light == light);
            let output = output.and_then(|frame| frame.output.clone());
            let history = planner.history_planned();
            let resize = resized.and_then(|frame| {
                let before = (frame.size, &frame.history[..]);
                self.reproject.plan_resized(&planner, before, &history)
            });
            Ok(PreparedFrame {
                settings: settings.clone(),
                size: grid.size,
                textures: grid.textures.clone(),
                shown: None,
                normals: None,
                strips: strips.cloned(),
                cookies: self.cookies.view.clone(),
                hints: grid.hints,
                capacity: planner.capacity,
                by_cpu: method.is_none(),
                memory: planner.memory(),
                history,
                resize,
                light,
                light_texture,
                passes,
                direct,
                reproject: None,
                moved: false,
                fields: None,
                records_fields: false,
                sight: None,
                records_sight: false,
                output,
            })
        })
    }

    /// Plans what the input asks for beside the light.
    fn plan_extras(
        &self,
        frame: &PreparedFrame,
        input: &FrameInput,
        moves: bool,
    ) -> Result<Extras> {
        let device = &self.shared.device;
        let planner = FramePlanner::new(&self.shared, input.settings, self.options, frame.grid());
        let known = |picture: &TextureView| {
            frame.output.clone().filter(|output| output.picture == *picture)
        };
        let output = match input.output {
            None => None,
            Some(picture) => match known(picture) {
                Some(output) => Some(output),
                None => Some(self.plan_output(&planner, &frame.light, picture)?),
            },
        };
        let wanted = self.distance.as_ref();
        let wanted = wanted.filter(|_| input.distance_field && frame.fields.is_none());
        let fields = wanted.map(|distance| with_error_scope(device, || distance.plan(&planner)));
        let reproject = (moves && frame.reproject.is_none())
            .then(|| with_error_scope(device, || self.reproject.plan(&planner, &frame.history)));
        Ok(Extras {
            output,
            fields: fields.transpose()?.map(|field| field.passes),
            reproject: reproject.transpose()?,
            sight: self.plan_sight(frame, input.settings)?,
            memory: planner.memory(),
        })
    }

    /// Plans the sight of viewers, if there are any and the frame has no room for them.
    fn plan_sight(&self, frame: &PreparedFrame, settings: &Settings) -> Result<Option<SightPass>> {
        let holds = frame.sight.as_ref().is_some_and(|sight| sight.holds(&self.sights));
        let Some(pipelines) = self.sight.as_ref().filter(|_| !self.sights.is_empty() && !holds)
        else {
            return Ok(None);
        };
        let before = self.frame.as_ref().filter(|before| before.size == frame.size);
        let before = before.and_then(|before| before.sight.as_ref());
        let planner = FramePlanner::new(&self.shared, settings, self.options, frame.grid());
        let plan = || pipelines.plan(&planner, &self.sights, before);
        with_error_scope(&self.shared.device, plan).map(Some)
    }

    fn plan_output(
        &self,
        planner: &FramePlanner,
        light: &Buffer,
        picture: &TextureView,
    ) -> Result<OutputPass> {
        let has_compute = self.shared.has_compute;
        let usage = if has_compute {
            (TextureUsages::STORAGE_BINDING, "STORAGE_BINDING")
        } else {
            (TextureUsages::COPY_DST, "COPY_DST")
        };
        let size = matter::writable("output", picture, usage)?;
        matter::check_size("output", size, "the grid", planner.size.into())?;
        with_error_scope(&self.shared.device, || {
            let dispatch = has_compute.then(|| self.output.plan(planner, light, picture));
            Ok(OutputPass { picture: picture.clone(), dispatch })
        })
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
        let Self { frame, plan_ids, shared, cookies, panorama, inflow, .. } = self;
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

/// Rejects what a device without compute shaders cannot do.
fn check_without_compute(input: &FrameInput) -> Result<()> {
    let wanted =
        [(input.distance_field, "the distance field"), (!input.sights.is_empty(), "sight")];
    match wanted.into_iter().find(|(is_wanted, _)| *is_wanted) {
        Some((_, what)) => Err(PrepareError::NoCompute { what }),
        None => Ok(()),
    }
}

/// Creates a texture for the values of light, in rows as long as the grid's.
fn light_texture(planner: &FramePlanner) -> Result<TextureView> {
    let GridSize { width, height } = planner.size;
    let values = planner.light_values() / planner.cells();
    let size = GridSize::new(planner.device, [width, height * values as u32])?;
    Ok(matter::texture(planner.device, "light", size, matter::UPLOADED))
}

/// Rejects an inflow that the method does not read, or of a grid of another size.
fn check_inflow(lights: Lights, settings: &Settings, size: GridSize) -> lamplight::Result<()> {
    match lights.inflow {
        Some(inflow) => settings.method.takes_inflow().and_then(|()| inflow.check(size.into())),
        None => Ok(()),
    }
}
