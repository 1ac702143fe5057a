//! Times of stages.

mod common;

use common::{cells, device, device_of, frame, lighting};
use lamplight::{Bounces, Method, Settings};
use lamplight_wgpu::error::RecordError;
use lamplight_wgpu::read_back::read_back;
use lamplight_wgpu::{FrameInput, Stage, Tier, Timer};
use std::time::{Duration, Instant};
use wgpu::{Device, Features, Queue};

fn raymarch() -> Settings {
    Settings::direct(Method::Raymarch)
}

/// A device with timestamps; `None` if the GPU has none.
fn clock() -> Option<(Device, Queue, Timer)> {
    let (device, queue) = device_of(Tier::Native);
    let timer = Timer::new(&device, &queue);
    assert_eq!(timer.is_some(), device.features().contains(Features::TIMESTAMP_QUERY));
    if timer.is_none() {
        println!("this GPU has no timestamps: nothing is tested");
    }
    Some((device, queue, timer?))
}

#[test]
fn without_the_feature_there_is_no_timer() {
    let (device, queue) = device();
    assert!(Timer::new(&device, &queue).is_none());
}

#[test]
fn every_stage_is_timed_and_the_light_is_the_same() {
    let Some((device, queue, mut timer)) = clock() else { return };
    let cells = cells(96, 64, 3);
    let settings = raymarch();
    let mut plain = lighting(&device, &queue);
    let right = frame(&device, &queue, &mut plain, &settings, &cells);

    let mut lighting = lighting(&device, &queue);
    assert!(timer.read().is_empty());
    lighting.prepare(&FrameInput::of_cells(&settings, &cells)).unwrap();
    let start = Instant::now();
    let mut encoder = device.create_command_encoder(&Default::default());
    lighting.record_timed(&mut encoder, &mut timer).unwrap();
    queue.submit([encoder.finish()]);
    let times = timer.wait().unwrap();
    let taken = start.elapsed();

    println!("{times:?} of {taken:?}");
    let names: Vec<_> = times.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["medium_grid", "empty_space", "raymarch/march", "walls"]);
    let sum: Duration = times.iter().map(|(_, time)| *time).sum();
    assert!(sum > Duration::ZERO && sum <= taken, "{sum:?} of {taken:?}");
    let light: Vec<[f32; 4]> =
        read_back(&device, &queue, lighting.stage(Stage::Light).unwrap()).unwrap();
    assert_eq!(light, right);
}

#[test]
fn reading_never_waits_and_dropped_frames_do_no_harm() {
    let Some((device, queue, mut timer)) = clock() else { return };
    let cells = cells(31, 17, 3);
    let settings = raymarch();
    let mut lighting = lighting(&device, &queue);
    let mut encoder = device.create_command_encoder(&Default::default());
    let early = lighting.record_timed(&mut encoder, &mut timer);
    assert_eq!(early, Err(RecordError::NotPrepared));
    queue.submit([encoder.finish()]);
    assert!(timer.wait().unwrap().is_empty(), "times of nothing");

    for number in 0..40 {
        lighting.prepare(&FrameInput::of_cells(&settings, &cells)).unwrap();
        let mut encoder = device.create_command_encoder(&Default::default());
        lighting.record_timed(&mut encoder, &mut timer).unwrap();
        // Some frames are dropped instead of submitted.
        if number % 3 != 0 {
            queue.submit([encoder.finish()]);
        }
        if number % 10 > 5 {
            timer.read();
        }
    }
    assert_eq!(timer.wait().unwrap().len(), 4);
}

#[test]
fn more_stretches_than_there_are_clocks_for_are_timed_as_one() {
    let Some((device, queue, mut timer)) = clock() else { return };
    let settings = Settings { bounces: Bounces::Count(120), ..raymarch() };
    let mut lighting = lighting(&device, &queue);
    lighting.prepare(&FrameInput::of_cells(&settings, &cells(9, 5, 3))).unwrap();
    let mut encoder = device.create_command_encoder(&Default::default());
    lighting.record_timed(&mut encoder, &mut timer).unwrap();
    queue.submit([encoder.finish()]);
    let names: Vec<_> = timer.wait().unwrap().iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["medium_grid", "empty_space", "raymarch/march", "rest"]);
}
