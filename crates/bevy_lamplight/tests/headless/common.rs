//! Apps without a window, whose cameras draw on images that are read back.
#![allow(dead_code)]

use bevy::app::PluginsState;
use bevy::asset::RenderAssetUsages;
use bevy::camera::RenderTarget;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::gpu_readback::{Readback, ReadbackComplete};
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat, TextureUsages};
use bevy::render::settings::{WgpuLimits, WgpuSettings};
use bevy::render::view::Msaa;
use bevy::window::{ExitCondition, WindowPlugin};
use bevy::winit::WinitPlugin;
use bevy_lamplight::prelude::*;

/// Frames after which a readback from the GPU has failed.
const PATIENCE: usize = 200;

/// The picture of a camera: linear red, green, blue and alpha, row by row.
#[derive(Clone)]
pub struct Picture {
    pub size: [u32; 2],
    pub texels: Vec<[f32; 4]>,
}

impl Picture {
    pub fn at(&self, x: u32, y: u32) -> [f32; 3] {
        let [r, g, b, _] = self.texels[(y * self.size[0] + x) as usize];
        [r, g, b]
    }

    /// Mean of red, green and blue.
    pub fn grey(&self, x: u32, y: u32) -> f32 {
        self.at(x, y).iter().sum::<f32>() / 3.0
    }
}

#[derive(Resource, Default)]
struct Arrived(Option<Vec<u8>>);

/// An app with the plugin and a white background.
pub fn app() -> App {
    let mut app = headless();
    app.add_plugins(LamplightPlugin).insert_resource(ClearColor(Color::WHITE));
    app
}

/// An app that draws, without a window.
pub fn headless() -> App {
    let mut app = App::new();
    add_bevy(&mut app);
    app
}

/// Adds Bevy's plugins, without a window.
pub fn add_bevy(app: &mut App) {
    add_bevy_with(app, WgpuSettings::default());
}

/// Adds Bevy's plugins, without a window, on a device that grants no more than these limits.
pub fn add_bevy_within(app: &mut App, limits: WgpuLimits) {
    let constrained_limits = Some(limits.clone());
    add_bevy_with(app, WgpuSettings { limits, constrained_limits, ..default() });
}

fn add_bevy_with(app: &mut App, settings: WgpuSettings) {
    let window =
        WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() };
    let render = RenderPlugin {
        synchronous_pipeline_compilation: true,
        render_creation: settings.into(),
        ..default()
    };
    app.add_plugins(
        DefaultPlugins
            .set(window)
            .set(render)
            .set(ImagePlugin::default_nearest())
            .disable::<WinitPlugin>()
            .disable::<LogPlugin>()
            .disable::<PipelinedRenderingPlugin>(),
    )
    .init_resource::<Arrived>();
}

/// Finishes the setup of an app, so that it can run.
pub fn begin(app: &mut App) {
    while app.plugins_state() == PluginsState::Adding {
        std::thread::yield_now();
    }
    app.finish();
    app.cleanup();
}

/// A render target that stores unclamped linear values.
pub fn target(app: &mut App, size: [u32; 2]) -> Handle<Image> {
    target_of(app, size, TextureFormat::Rgba16Float)
}

/// A render target of a format.
pub fn target_of(app: &mut App, [width, height]: [u32; 2], format: TextureFormat) -> Handle<Image> {
    let mut image = Image::new_target_texture(width, height, format, None);
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    app.world_mut().resource_mut::<Assets<Image>>().add(image)
}

/// Settings that show the light of each cell unchanged, a cell per pixel. The method is the quickest on a
/// software GPU whose light does not change between frames.
pub fn plain() -> Lighting2d {
    Lighting2d {
        method: LightMethod::Cascades,
        bounces: LightBounces::Count(0),
        cells: CellSize::World(1.0),
        border: 16.0,
        surroundings: 0,
        wall_depth: 0.0,
        filter: LightFilter::Nearest,
        tone_map: LightToneMap::Off,
        ..default()
    }
}

/// Spawns a lit camera that draws on an image.
pub fn camera(app: &mut App, image: &Handle<Image>, lighting: Lighting2d) -> Entity {
    let target = RenderTarget::Image(image.clone().into());
    app.world_mut().spawn((Camera2d, target, Msaa::Off, lighting)).id()
}

/// The content of a target after further frames.
pub fn picture(app: &mut App, image: &Handle<Image>, frames: usize) -> Picture {
    (0..frames).for_each(|_| app.update());
    app.world_mut().resource_mut::<Arrived>().0 = None;
    let asked = app.world_mut().spawn(Readback::texture(image.clone())).id();
    app.world_mut().entity_mut(asked).observe(
        |event: On<ReadbackComplete>, mut arrived: ResMut<Arrived>| {
            arrived.0 = Some(event.data.clone());
        },
    );
    for _ in 0..PATIENCE {
        app.update();
        if app.world().resource::<Arrived>().0.is_some() {
            break;
        }
    }
    app.world_mut().entity_mut(asked).despawn();
    let bytes = app.world_mut().resource_mut::<Arrived>().0.take().expect("a picture arrives");
    let images = app.world().resource::<Assets<Image>>();
    let target = images.get(image).expect("the target is there");
    let size = target.size().to_array();
    // The GPU pads rows.
    let row = bytes.len() / size[1] as usize;
    let rows = bytes.chunks(row);
    let texels = match target.texture_descriptor.format {
        TextureFormat::Rgba16Float => {
            let texels = rows.flat_map(|row| row.as_chunks::<8>().0[..size[0] as usize].iter());
            let texel =
                |texel: &[u8; 8]| std::array::from_fn(|c| half([texel[2 * c], texel[2 * c + 1]]));
            texels.map(texel).collect()
        }
        // 8 bits per channel, as on screens.
        _ => {
            let texels = rows.flat_map(|row| row.as_chunks::<4>().0[..size[0] as usize].iter());
            texels.map(|texel| texel.map(|v| f32::from(v) / 255.0)).collect()
        }
    };
    Picture { size, texels }
}

fn half(bytes: [u8; 2]) -> f32 {
    let bits = u16::from_le_bytes(bytes);
    let (sign, exponent, fraction) = (bits >> 15, (bits >> 10) & 31, bits & 1023);
    let value = match exponent {
        0 => f32::from(fraction) * 2f32.powi(-24),
        31 => f32::INFINITY,
        e => (1.0 + f32::from(fraction) / 1024.0) * 2f32.powi(i32::from(e) - 15),
    };
    if sign == 1 { -value } else { value }
}

/// An image of `texel(x, y)` in sRGB bytes.
pub fn image(app: &mut App, size: [u32; 2], texel: impl Fn(u32, u32) -> [u8; 4]) -> Handle<Image> {
    image_of(app, size, TextureFormat::Rgba8UnormSrgb, |x, y| texel(x, y).to_vec())
}

/// An image of `texel(x, y)`, the bytes of a format.
pub fn image_of(
    app: &mut App,
    [width, height]: [u32; 2],
    format: TextureFormat,
    texel: impl Fn(u32, u32) -> Vec<u8>,
) -> Handle<Image> {
    let data = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let image = Image::new(
        Extent3d { width, height, depth_or_array_layers: 1 },
        TextureDimension::D2,
        data.flat_map(|(x, y)| texel(x, y)).collect(),
        format,
        RenderAssetUsages::default(),
    );
    app.world_mut().resource_mut::<Assets<Image>>().add(image)
}
