//! An app without a window, whose camera draws on an image, one frame at a time.

use crate::scene::VIEW;
use anyhow::{Context, Result};
use bevy::app::PluginsState;
use bevy::camera::RenderTarget;
use bevy::log::{Level, LogPlugin};
use bevy::prelude::{
    App, Assets, Bundle, Camera2d, DefaultPlugins, Handle, Image, IntoScheduleConfigs, Msaa, On,
    PluginGroup, ResMut, Resource, World, default,
};
use bevy::render::gpu_readback::{Readback, ReadbackComplete};
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{PollType, TextureFormat, TextureUsages};
use bevy::render::renderer::{RenderAdapterInfo, RenderDevice, RenderGraph, RenderGraphSystems};
use bevy::render::{RenderApp, RenderPlugin};
use bevy::window::{ExitCondition, WindowPlugin};
use bevy::winit::WinitPlugin;
use cpu_time::ProcessTime;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Instant;

/// The times of a frame, milliseconds.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Frame {
    /// From the start of the frame until the GPU had finished.
    pub all: f64,
    /// From the start of the frame until its commands were recorded: the work of the CPU.
    pub cpu: f64,
    /// CPU time of all threads of the process. With a software GPU this is all work of the frame, and it
    /// does not grow if other programs use the CPU.
    pub work: f64,
}

/// The graphics adapter that draws frames.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Adapter {
    pub name: String,
    pub driver: String,
    pub backend: String,
    pub kind: String,
}

/// The time at which the commands of the last frame were recorded. The end of their submission would be
/// too late: a software driver returns from it only when it has run them.
#[derive(Resource)]
struct Recorded(Instant);

/// The last picture of the camera.
#[derive(Resource, Default)]
struct Drawn(Option<Vec<u8>>);

/// An app that draws on an image.
pub struct Headless {
    app: App,
    target: Handle<Image>,
}

impl Headless {
    /// An app with Bevy's plugins, in which `build` adds a contender's.
    pub fn new(build: impl FnOnce(&mut App)) -> Self {
        let mut app = App::new();
        let window = WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..default()
        };
        let render = RenderPlugin { synchronous_pipeline_compilation: true, ..default() };
        let log = LogPlugin { level: Level::ERROR, ..default() };
        app.add_plugins(
            DefaultPlugins
                .set(window)
                .set(render)
                .set(log)
                .disable::<WinitPlugin>()
                // A frame is measured from its begin to its end, not two at a time.
                .disable::<PipelinedRenderingPlugin>(),
        );
        app.init_resource::<Drawn>();
        build(&mut app);
        let record = |mut record: ResMut<Recorded>| record.0 = Instant::now();
        let record = record.after(RenderGraphSystems::Render).before(RenderGraphSystems::Submit);
        app.sub_app_mut(RenderApp)
            .insert_resource(Recorded(Instant::now()))
            .add_systems(RenderGraph, record);
        while app.plugins_state() == PluginsState::Adding {
            std::thread::yield_now();
        }
        app.finish();
        app.cleanup();

        let [width, height] = VIEW;
        let format = TextureFormat::Rgba8UnormSrgb;
        let mut image = Image::new_target_texture(width, height, format, None);
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        let target = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        Self { app, target }
    }

    /// The world, to put a scene in.
    pub fn world(&mut self) -> &mut World {
        self.app.world_mut()
    }

    /// The components of a camera that draws on the image. There is no multisampling: light does not need
    /// it, and it is slow on a software GPU.
    pub fn camera(&self) -> impl Bundle + use<> {
        (Camera2d, Msaa::Off, RenderTarget::Image(self.target.clone().into()))
    }

    /// Draws a frame and waits for it.
    pub fn frame(&mut self) -> Result<Frame> {
        let (begin, work) = (Instant::now(), ProcessTime::now());
        self.app.update();
        let world = self.app.sub_app(RenderApp).world();
        let device = world.resource::<RenderDevice>();
        device.poll(PollType::wait_indefinitely()).context("waiting for the GPU")?;
        let all = begin.elapsed();
        let cpu = world.resource::<Recorded>().0.duration_since(begin);
        let [all, cpu, work] =
            [all, cpu, work.elapsed()].map(|duration| duration.as_secs_f64() * 1e3);
        Ok(Frame { all, cpu, work })
    }

    /// The graphics adapter.
    pub fn adapter(&self) -> Adapter {
        let info = self.app.sub_app(RenderApp).world().resource::<RenderAdapterInfo>();
        Adapter {
            name: info.name.clone(),
            driver: format!("{} {}", info.driver, info.driver_info),
            backend: info.backend.to_string(),
            kind: format!("{:?}", info.device_type),
        }
    }

    /// Writes what the camera draws as a PNG.
    pub fn save(&mut self, path: &Path) -> Result<()> {
        /// Frames after which what was asked of the GPU has arrived.
        const PATIENCE: usize = 20;
        let target = Readback::texture(self.target.clone());
        let asked = self.world().spawn(target).id();
        self.world().entity_mut(asked).observe(
            |event: On<ReadbackComplete>, mut drawn: ResMut<Drawn>| {
                drawn.0 = Some(event.data.clone());
            },
        );
        for _ in 0..PATIENCE {
            self.frame()?;
            if let Some(texels) = self.world().resource_mut::<Drawn>().0.take() {
                self.world().despawn(asked);
                let rgb = texels.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]);
                let [width, height] = VIEW;
                return image::RgbImage::from_raw(width, height, rgb.collect())
                    .context("the picture has another size than the target")?
                    .save(path)
                    .with_context(|| format!("writing {}", path.display()));
            }
        }
        anyhow::bail!("no picture came back from the GPU in {PATIENCE} frames")
    }
}
