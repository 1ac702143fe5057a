//! A device that goes away, as laptops' and browsers' do, is no reason to panic.

mod common;
#[path = "common/textures.rs"]
mod textures;

use common::{cells, device_of, frame};
use lamplight::{Bounces, Lamp, Method, Settings, Sky};
use lamplight_wgpu::read_back::read_back;
use lamplight_wgpu::{Compose, Error, Lighting, Shown, Stage, Textures, Tier, Timer};
use textures::{texture, view};
use wgpu::{TextureFormat, TextureUsages};

#[test]
fn a_lost_device_does_nothing_and_gives_errors_where_something_was_asked_for() {
    let (device, queue) = device_of(Tier::Native);
    let settings = Settings { method: Method::Raymarch, ..Settings::default() };
    let mut lighting = Lighting::new(&device, &queue, settings.clone()).unwrap();
    let mut compose = Compose::new(&device).unwrap();
    let mut timer = Timer::new(&device, &queue);
    frame(&device, &queue, &mut lighting, &cells(31, 17, 1));
    let format = TextureFormat::Rgba8Unorm;
    let target = texture(&device, [31, 17], format, TextureUsages::RENDER_ATTACHMENT);

    let usage = TextureUsages::TEXTURE_BINDING;
    let matter = || view(&texture(&device, [50, 30], format, usage));
    let (emission, tint_opacity, albedo) = (matter(), matter(), matter());
    let textures = Textures { emission, tint_opacity, albedo };

    device.destroy();
    // The size it had, and another; other settings; a device that was lost from the start.
    for [w, h] in [[31, 17], [40, 20]] {
        let _ = lighting.prepare(&device, &queue, &cells(w, h, 2));
        let mut encoder = device.create_command_encoder(&Default::default());
        lighting.record(&mut encoder);
        let _ = lighting.record_fields(&device, &mut encoder);
        if let Some(timer) = &mut timer {
            lighting.record_timed(&mut encoder, timer);
        }
        let _ = compose.prepare(&device, &queue, &lighting, format, &Shown::default());
        compose.record(&mut encoder, &view(&target));
        queue.submit([encoder.finish()]);
        if let Some(timer) = &mut timer {
            let _ = timer.wait(&device);
            assert!(timer.read().is_empty());
        }
        if let Some(light) = lighting.stage(Stage::Light) {
            let read = read_back::<[f32; 4]>(&device, &queue, light);
            assert!(matches!(read, Err(Error::ReadBack(_) | Error::Device(_))), "{read:?}");
        }
    }
    for &method in Method::ALL {
        for bounces in [Bounces::Count(1), Bounces::Converged] {
            let other = Settings { method, bounces, ..settings.clone() };
            let _ = lighting.set_settings(&device, &queue, other);
            let mut cells = cells(33, 21, 3);
            cells.lamps_mut().push(Lamp { position: [9.0, 9.0], ..Lamp::default() });
            let _ = lighting.prepare(&device, &queue, &cells);
            // As after a window's change of size.
            let _ = lighting.prepare_textures(&device, &queue, &textures, Sky::default());
            lighting.record(&mut device.create_command_encoder(&Default::default()));
        }
    }
    let _ = Lighting::new(&device, &queue, settings.clone());
    let _ = Compose::new(&device);
    let _ = Timer::new(&device, &queue);

    // Another device starts afresh.
    let (device, queue) = device_of(Tier::Web);
    let mut lighting = Lighting::new(&device, &queue, settings).unwrap();
    assert_eq!(frame(&device, &queue, &mut lighting, &cells(31, 17, 1)).len(), 31 * 17);
}
