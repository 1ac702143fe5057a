//! The middleware as hosts use it, and misuse it.

mod common;

use common::{cells, device};
use lamplight::settings::{BounceBy, Hit};
use lamplight::{Bounces, Cells, Method, Settings};
use lamplight_wgpu::read_back::read_back;
use lamplight_wgpu::{Error, Lighting, Stage};
use wgpu::{Device, Queue};

fn raymarch() -> Settings {
    Settings { method: Method::Raymarch, ..Settings::default() }
}

fn frame(device: &Device, queue: &Queue, lighting: &mut Lighting, cells: &Cells) -> Vec<[f32; 4]> {
    lighting.prepare(device, queue, cells).unwrap();
    let mut encoder = device.create_command_encoder(&Default::default());
    lighting.record(&mut encoder);
    queue.submit([encoder.finish()]);
    read_back(device, queue, lighting.stage(Stage::Light).unwrap()).unwrap()
}

#[test]
fn what_is_not_there_yet_is_refused_by_name() {
    let (device, queue) = device();
    let refused = |settings: Settings| {
        let error = Lighting::new(&device, &queue, settings).unwrap_err();
        assert!(matches!(error, Error::NotYet { .. }), "{error:?}");
        error.to_string()
    };
    let with = |change: fn(&mut Settings)| {
        let mut settings = raymarch();
        change(&mut settings);
        refused(settings)
    };
    assert_eq!(
        with(|s| s.method = Method::Polar),
        "the method polar is not on the GPU yet: use the CPU for it"
    );
    assert!(with(|s| s.bounces = Bounces::Converged).starts_with("`bounces` = converged"));
    let feedback = with(|s| {
        s.bounces = Bounces::Count(1);
        s.raymarch.bounce = BounceBy::Feedback;
    });
    assert!(feedback.starts_with("`raymarch.bounce` = feedback"));
    assert!(with(|s| s.raymarch.hit = Hit::Distance).starts_with("`raymarch.hit` = distance"));
    assert!(with(|s| s.raymarch.attenuation = true).starts_with("`raymarch.attenuation`"));
    assert!(with(|s| s.temporal.frames = 8).starts_with("the mean over frames"));
    assert!(with(|s| s.denoise.passes = 1).starts_with("denoising"));
}

#[test]
fn bad_settings_and_cells_are_refused_as_on_the_cpu() {
    let (device, queue) = device();
    let mut settings = raymarch();
    settings.raymarch.rays = 0;
    let error = Lighting::new(&device, &queue, settings).unwrap_err().to_string();
    assert!(error.starts_with("`raymarch.rays` is 0"), "{error}");

    let mut lighting = Lighting::new(&device, &queue, raymarch()).unwrap();
    let mut dark = Cells::new(4, 4).unwrap();
    dark.emission_mut()[5] = [f32::NAN; 3];
    let error = lighting.prepare(&device, &queue, &dark).unwrap_err().to_string();
    assert!(error.contains("cell (1, 1)"), "{error}");
}

#[test]
fn a_grid_beyond_the_devices_limits_is_refused_and_the_next_one_lit() {
    let (device, queue) = device();
    let limits = device.limits();
    let mut lighting = Lighting::new(&device, &queue, raymarch()).unwrap();
    let wide = Cells::new(limits.max_texture_dimension_2d + 1, 1).unwrap();
    let error = lighting.prepare(&device, &queue, &wide).unwrap_err().to_string();
    assert!(error.contains("px a side, but this device allows"), "{error}");
    let large = Cells::new(4096, 2049).unwrap();
    let error = lighting.prepare(&device, &queue, &large).unwrap_err().to_string();
    assert!(error.contains("bytes a buffer, but this device allows"), "{error}");
    assert!(lighting.stage(Stage::Light).is_none());
    assert_eq!(frame(&device, &queue, &mut lighting, &cells(9, 5, 1)).len(), 45);
}

#[test]
fn sizes_may_change_and_many_share_a_device() {
    let (device, queue) = device();
    let mut one = Lighting::new(&device, &queue, raymarch()).unwrap();
    let mut other = Lighting::new(&device, &queue, raymarch()).unwrap();
    for [w, h] in [[31, 17], [8, 8], [31, 17], [97, 3]] {
        let cells = cells(w, h, 2);
        let lit = frame(&device, &queue, &mut one, &cells);
        assert_eq!(lit.len(), (w * h) as usize);
        assert_eq!(lit, frame(&device, &queue, &mut other, &cells));
    }
}

#[test]
fn nothing_is_recorded_before_the_first_cells() {
    let (device, queue) = device();
    let lighting = Lighting::new(&device, &queue, raymarch()).unwrap();
    let mut encoder = device.create_command_encoder(&Default::default());
    lighting.record(&mut encoder);
    lighting.record_fields(&mut encoder);
    queue.submit([encoder.finish()]);
    assert!(lighting.stage(Stage::Light).is_none());
}
