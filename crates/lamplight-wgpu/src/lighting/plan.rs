//! Plans frames: their dispatches, and the resources that these are bound to.

use super::frame_lights::FrameLights;
use super::prepared_frame::{Extras, OutputPass, PreparedFrame};
use super::stage_pipelines::StagePipelines;
use crate::error::Result;
use crate::error_scope::with_error_scope;
use crate::frame_input::FrameInput;
use crate::grid_size::GridSize;
use crate::inflow::InflowTexture;
use crate::lamps::Capacity;
use crate::matter;
use crate::methods::Method;
use crate::options::LightingOptions;
use crate::pass_list::PassList;
use crate::planner::{FramePlanner, Grid};
use crate::shared::Shared;
use crate::stage::Stage;
use crate::stages::sight::SightPass;
use lamplight::Settings;
use wgpu::{Buffer, TextureUsages, TextureView};

/// The sources of a plan.
pub struct PlanSources<'a> {
    pub shared: &'a Shared,
    pub options: LightingOptions,
    pub stages: &'a StagePipelines,
    pub lights: &'a FrameLights,
    /// The frame before.
    pub before: Option<&'a PreparedFrame>,
}

impl PlanSources<'_> {
    /// Plans a frame. While the size is the same, history continues, and the light stays where it is: until the
    /// next frame it can still be shown.
    ///
    /// `continues`: there is history, which is taken over by a grid of another size too.
    pub fn frame(
        &self,
        method: Option<&Method>,
        settings: &Settings,
        grid: &Grid,
        continues: bool,
    ) -> Result<PreparedFrame> {
        let Self { shared, options, stages, lights, before } = *self;
        let resized = before.filter(|frame| continues && frame.size != grid.size);
        let strips = lights.strips();
        let capacity = before.map_or(Capacity::default(), |frame| frame.capacity);
        let before = before.filter(|frame| frame.size == grid.size);
        with_error_scope(&shared.device, || {
            let planner = FramePlanner::new(shared, settings, options, *grid)
                .with_capacity(capacity, lights.needed())?
                .with_strips(strips, lights.inflow.as_ref().map(InflowTexture::columns))
                .with_cookies(lights.cookies.view.as_ref())
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
                None if shared.has_compute => None,
                None => Some(light_texture(&planner)?),
            };
            let has_direct = method.is_some() && planner.capacity.has_direct();
            let direct = stages.direct.as_ref().filter(|_| has_direct);
            let direct = direct.map(|direct| direct.plan(&planner)).transpose()?;
            let (found, direct, shine) = match direct {
                Some((found, buffers, dispatches)) => (Some(found), Some(buffers), dispatches),
                None => (None, None, Vec::new()),
            };
            let planner = planner.with_direct(found);
            let reads_glow = method.is_some() && settings.method.reads_glow();
            let glow = grid.textures.glow.as_ref().filter(|_| reads_glow);
            let media = glow.map(|glow| stages.glow.plan(&planner, glow));
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
                if let Some(walls) = stages.moment_walls.as_ref().filter(|_| settings.moment) {
                    passes.dispatches.extend(walls.plan(&planner, &light)?);
                }
                passes.dispatches.extend(stages.walls.plan(&planner, &light)?);
            }
            if let Some(lamps) = &passes.lamps {
                // Written here too, so that a lost device is reported.
                lights.lamps.write(&shared.queue, lamps);
            }
            if let Some(buffers) = &direct {
                lights.direct_lights.write(&shared.queue, buffers);
            }
            // It is bound to the light of the plan before.
            let output = before.filter(|frame| frame.light == light);
            let output = output.and_then(|frame| frame.output.clone());
            let history = planner.history_planned();
            let resize = resized.and_then(|frame| {
                let before = (frame.size, &frame.history[..]);
                stages.reproject.plan_resized(&planner, before, &history)
            });
            Ok(PreparedFrame {
                settings: settings.clone(),
                size: grid.size,
                textures: grid.textures.clone(),
                shown: None,
                normals: None,
                strips: strips.cloned(),
                cookies: lights.cookies.view.clone(),
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
    pub fn extras(&self, frame: &PreparedFrame, input: &FrameInput, moves: bool) -> Result<Extras> {
        let device = &self.shared.device;
        let planner = FramePlanner::new(self.shared, input.settings, self.options, frame.grid());
        let known = |picture: &TextureView| {
            frame.output.clone().filter(|output| output.picture == *picture)
        };
        let output = match input.output {
            None => None,
            Some(picture) => match known(picture) {
                Some(output) => Some(output),
                None => Some(self.output(&planner, &frame.light, picture)?),
            },
        };
        let wanted = self.stages.distance.as_ref();
        let wanted = wanted.filter(|_| input.distance_field && frame.fields.is_none());
        let fields = wanted.map(|distance| with_error_scope(device, || distance.plan(&planner)));
        let reproject = (moves && frame.reproject.is_none()).then(|| {
            with_error_scope(device, || self.stages.reproject.plan(&planner, &frame.history))
        });
        Ok(Extras {
            output,
            fields: fields.transpose()?.map(|field| field.passes),
            reproject: reproject.transpose()?,
            sight: self.sight(frame, input.settings)?,
            memory: planner.memory(),
        })
    }

    /// Plans the sight of viewers, if there are any and the frame has no room for them.
    fn sight(&self, frame: &PreparedFrame, settings: &Settings) -> Result<Option<SightPass>> {
        let sights = &self.lights.sights;
        let holds = frame.sight.as_ref().is_some_and(|sight| sight.holds(sights));
        let Some(pipelines) = self.stages.sight.as_ref().filter(|_| !sights.is_empty() && !holds)
        else {
            return Ok(None);
        };
        let before = self.before.filter(|before| before.size == frame.size);
        let before = before.and_then(|before| before.sight.as_ref());
        let planner = FramePlanner::new(self.shared, settings, self.options, frame.grid());
        let plan = || pipelines.plan(&planner, sights, before);
        with_error_scope(&self.shared.device, plan).map(Some)
    }

    fn output(
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
            let dispatch = has_compute.then(|| self.stages.output.plan(planner, light, picture));
            Ok(OutputPass { picture: picture.clone(), dispatch })
        })
    }
}

/// Creates a texture for the values of light, in rows as long as the grid's.
fn light_texture(planner: &FramePlanner) -> Result<TextureView> {
    let GridSize { width, height } = planner.size;
    let values = planner.light_values() / planner.cells();
    let size = GridSize::new(planner.device, [width, height * values as u32])?;
    Ok(matter::texture(planner.device, "light", size, matter::UPLOADED))
}
