//! A lost device, as on laptops and in browsers, causes no panic.

mod common;
#[path = "common/textures.rs"]
mod textures;

use common::{cells, device_of, frame, lighting};
use lamplight::{Bounces, Lamp, Method, Settings, Sky};
use lamplight_wgpu::error::ReadBackError;
use lamplight_wgpu::read_back::read_back;
use lamplight_wgpu::{
    Backend, Compose, ComposeParams, FrameInput, Lighting, LightingOptions, Lights, Stage,
    Textures, Tier, Timer,
};
use textures::{texture, view};
use wgpu::{TextureFormat, TextureUsages};

#[test]
fn a_lost_device_does_nothing_and_returns_errors_when_results_are_read() {
    let (device, queue) = device_of(Tier::Native);
    let settings = Settings::direct(Method::Raymarch);
    let options = LightingOptions::on(Backend::Gpu);
    let mut lit = lighting(&device, &queue);
    let mut compose = Compose::new(&device, &queue).unwrap();
    let mut timer = Timer::new(&device, &queue);
    frame(&device, &queue, &mut lit, &settings, &cells(31, 17, 1));
    let format = TextureFormat::Rgba8Unorm;
    let target = texture(&device, [31, 17], format, TextureUsages::RENDER_ATTACHMENT);

    let usage = TextureUsages::TEXTURE_BINDING;
    let matter = || view(&texture(&device, [50, 30], format, usage));
    let (emission, tint_opacity, albedo) = (matter(), matter(), matter());
    let textures = Textures { emission, tint_opacity, albedo, glow: None, masks: None };

    device.destroy();
    // The size it had, and another; other settings; a device that was lost from the start.
    for [w, h] in [[31, 17], [40, 20]] {
        let cells = cells(w, h, 2);
        let input = FrameInput::of_cells(&settings, &cells);
        let _ = lit.prepare(&FrameInput { distance_field: w == 31, ..input });
        let mut encoder = device.create_command_encoder(&Default::default());
        let _ = lit.record(&mut encoder);
        if let Some(timer) = &mut timer {
            let _ = lit.record_timed(&mut encoder, timer);
        }
        let _ = compose.prepare(&lit, format, &ComposeParams::default());
        let _ = compose.record(&mut encoder, &view(&target));
        queue.submit([encoder.finish()]);
        if let Some(timer) = &mut timer {
            let _ = timer.wait();
            assert!(timer.read().is_empty());
        }
        if let Some(light) = lit.stage(Stage::Light) {
            let read = read_back::<[f32; 4]>(&device, &queue, light);
            assert!(
                matches!(read, Err(ReadBackError::Failed(_) | ReadBackError::Device(_))),
                "{read:?}"
            );
        }
    }
    for &method in Method::ALL {
        for bounces in [Bounces::Count(1), Bounces::Converged] {
            let other = Settings { method: method.into(), bounces, ..settings.clone() };
            let mut cells = cells(33, 21, 3);
            cells.lamps_mut().push(Lamp { position: [9.0, 9.0], ..Lamp::default() });
            let _ = lit.precompile(&other);
            let _ = lit.prepare(&FrameInput::of_cells(&other, &cells));
            // As after the size of a window changed.
            let sky = Sky::default();
            let _ = lit.prepare(&FrameInput::of_textures(
                &other,
                &textures,
                Lights { sky: &sky, ..Lights::default() },
            ));
            let _ = lit.record(&mut device.create_command_encoder(&Default::default()));
        }
    }
    let _ = Lighting::new(&device, &queue, &options);
    let _ = Compose::new(&device, &queue);
    let _ = Timer::new(&device, &queue);

    // Another device starts afresh.
    let (device, queue) = device_of(Tier::Web);
    let mut lit = lighting(&device, &queue);
    let light = frame(&device, &queue, &mut lit, &settings, &cells(31, 17, 1));
    assert_eq!(light.len(), 31 * 17);
}
