//! Textures in, a picture out, without a window:
//! `cargo run --release -p lamplight-wgpu --example headless`, which writes headless.png.

use lamplight::image::RgbImage;
use lamplight::settings::Raymarch;
use lamplight::{Bounces, Settings, Sky};
use lamplight_wgpu::read_back::read_back;
use lamplight_wgpu::wgpu::{
    Device, DeviceDescriptor, Extent3d, Instance, InstanceDescriptor, Queue, TexelCopyBufferLayout,
    TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, TextureView,
};
use lamplight_wgpu::{FrameInput, Lighting, LightingOptions, Lights, Stage, Textures};
use pollster::block_on;
use std::{error::Error, process::ExitCode};

const SIZE: [u32; 2] = [320, 180];

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    // A host has these already.
    let instance = Instance::new(InstanceDescriptor::new_without_display_handle());
    let adapter = block_on(instance.request_adapter(&Default::default()))?;
    println!("lighting on {}", adapter.get_info().name);
    let (device, queue) = block_on(adapter.request_device(&DeviceDescriptor::default()))?;

    // The host draws these: emitted radiance, tint and opacity, albedo.
    let textures =
        Textures {
            emission: texture(&device, &queue, |x, y| {
                if lamp(x, y) { [255, 190, 110, 255] } else { [0; 4] }
            }),
            tint_opacity: texture(&device, &queue, |x, y| {
                if lamp(x, y) || pillar(x, y) {
                    [255; 4]
                } else if (150.0..153.0).contains(&x) {
                    [90, 220, 255, 0]
                } else {
                    [255, 255, 255, 0]
                }
            }),
            albedo: texture(&device, &queue, |x, _| {
                if x < 160.0 { [220, 90, 60, 255] } else { [80, 140, 220, 255] }
            }),
            glow: None,
            masks: None,
        };

    let raymarch = Raymarch { rays: 256, emission_multiplier: 6.0, ..Raymarch::default() };
    let settings =
        Settings { bounces: Bounces::Count(2), wall_depth: 4.0, ..Settings::new(raymarch) };
    let mut lighting = Lighting::new(&device, &queue, &LightingOptions::default())?;
    let sky = Sky::Uniform([0.01, 0.01, 0.03]);
    lighting.prepare(&FrameInput::of_textures(
        &settings,
        &textures,
        Lights { sky: &sky, ..Lights::default() },
    ))?;
    let mut encoder = device.create_command_encoder(&Default::default());
    lighting.record(&mut encoder)?;
    queue.submit([encoder.finish()]);

    let light = lighting.stage(Stage::Light).ok_or("nothing was lit")?;
    let light: Vec<[f32; 4]> = read_back(&device, &queue, light)?;
    let shown = |v: f32| ((v / (1.0 + v)).powf(1.0 / 2.2) * 255.0) as u8;
    let pixels = light.iter().flat_map(|&[r, g, b, _]| [r, g, b].map(shown)).collect();
    RgbImage::from_raw(SIZE[0], SIZE[1], pixels)
        .ok_or("of another size")?
        .save("headless.png")
        .map_err(|error| format!("cannot write headless.png: {error}"))?;
    println!("wrote headless.png");
    Ok(())
}

fn lamp(x: f32, y: f32) -> bool {
    [[70.0, 60.0], [230.0, 110.0]].iter().any(|[a, b]| (x - a).hypot(y - b) < 4.0)
}

fn pillar(x: f32, y: f32) -> bool {
    ((x % 40.0) - 20.0).hypot((y % 45.0) - 22.0) < 6.0
}

/// A texture with eight bits per channel, as in games.
fn texture(device: &Device, queue: &Queue, texel: impl Fn(f32, f32) -> [u8; 4]) -> TextureView {
    let [width, height] = SIZE;
    let texture = device.create_texture(&TextureDescriptor {
        label: None,
        size: Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format: TextureFormat::Rgba8Unorm,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let centre = |i: u32| ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
    let texels: Vec<[u8; 4]> = (0..width * height).map(centre).map(|(x, y)| texel(x, y)).collect();
    let rows =
        TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
    queue.write_texture(texture.as_image_copy(), texels.as_flattened(), rows, texture.size());
    texture.create_view(&Default::default())
}
