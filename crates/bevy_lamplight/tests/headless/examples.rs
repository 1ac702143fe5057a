//! The examples run, and draw their pictures.
//!
//! `LAMPLIGHT_DRAW=1` redraws the pictures (`cargo xtask docs --bevy`).

use crate::common::{Picture, begin, headless, picture, target_of};
use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::{PollType, TextureFormat};
use bevy::render::renderer::RenderDevice;
use bevy::time::TimeUpdateStrategy;
use bevy_lamplight::prelude::LightBackend;
use std::path::Path;
use std::time::{Duration, Instant};

#[path = "../../examples/dungeon.rs"]
mod dungeon;
#[path = "../../examples/hello.rs"]
mod hello;
#[path = "../../examples/many_lights.rs"]
mod many_lights;
#[path = "../../examples/neon_street.rs"]
mod neon_street;
#[path = "../../examples/split_screen.rs"]
mod split_screen;
#[path = "../../examples/stealth.rs"]
mod stealth;

const SIZE: [u32; 2] = [640, 360];
/// The largest mean difference to the picture, of 255. GPUs differ in rounding; there is no noise. A strip of floor that is
/// black instead of lit comes to 0.5.
const TOLERANCE: f32 = 0.3;

/// Lets the cameras of an example draw on an image.
fn draw_on_image(app: &mut App) -> Handle<Image> {
    let image = target_of(app, SIZE, TextureFormat::Rgba8UnormSrgb);
    let target = RenderTarget::Image(image.clone().into());
    app.add_systems(
        PostStartup,
        move |mut commands: Commands, cameras: Query<Entity, With<Camera2d>>| {
            for camera in &cameras {
                commands.entity(camera).insert(target.clone());
            }
        },
    );
    image
}

/// The picture of an example after a few frames of 16 ms.
fn shown(example: fn(&mut App)) -> Picture {
    let mut app = headless();
    app.add_plugins(example);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(16)));
    let image = draw_on_image(&mut app);
    begin(&mut app);
    // A lit frame takes seconds on a software GPU, so cameras are off until everything is loaded.
    let light = |app: &mut App, is_active| {
        let mut cameras = app.world_mut().query::<&mut Camera>();
        cameras.iter_mut(app.world_mut()).for_each(|mut camera| camera.is_active = is_active);
    };
    app.update();
    light(&mut app, false);
    (0..4).for_each(|_| app.update());
    light(&mut app, true);
    (0..2).for_each(|_| app.update());
    light(&mut app, false);
    picture(&mut app, &image, 0)
}

/// Milliseconds per frame of an example, from its begin until the adapter has finished it: the median of frames after
/// those in which everything is loaded and the finder of light is chosen.
fn frame_time(example: fn(&mut App)) -> f64 {
    let mut app = headless();
    app.insert_resource(LightBackend::Auto).add_plugins(example);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(16)));
    draw_on_image(&mut app);
    begin(&mut app);
    (0..10).for_each(|_| app.update());
    let mut times: Vec<f64> = (0..31)
        .map(|_| {
            let start = Instant::now();
            app.update();
            let device = app.sub_app(RenderApp).world().resource::<RenderDevice>();
            device.poll(PollType::wait_indefinitely()).unwrap();
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// The figures of docs/bevy-performance.md.
#[test]
#[ignore = "measures: cargo test --release -p bevy_lamplight --test headless -- --ignored --nocapture times"]
fn times_of_frames() {
    println!("hello: {:.1} ms per frame", frame_time(hello::example));
    println!("dungeon: {:.1} ms per frame", frame_time(dungeon::example));
    println!("neon_street: {:.1} ms per frame", frame_time(neon_street::example));
}

/// Mean over all pixels and channels, of 255.
fn difference(a: &[u8], b: &[u8]) -> f32 {
    assert_eq!(a.len(), b.len());
    let sum: u64 = a.iter().zip(b).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f32 / a.len() as f32
}

fn check(name: &str, example: fn(&mut App)) {
    let seen = shown(example);
    let bytes: Vec<u8> = seen
        .texels
        .iter()
        .flat_map(|&[r, g, b, _]| [r, g, b].map(|v| (255.0 * v).round() as u8))
        .collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("pictures");
    let path = folder.join(name).with_extension("png");
    if std::env::var_os("LAMPLIGHT_DRAW").is_some() {
        std::fs::create_dir_all(&folder).unwrap();
        image::RgbImage::from_raw(SIZE[0], SIZE[1], bytes).unwrap().save(&path).unwrap();
        return;
    }
    let right = image::open(&path).expect("the example's picture").into_rgb8();
    assert_eq!([right.width(), right.height()], SIZE);
    let off = difference(&bytes, right.as_raw());
    println!("{name}: {off:.3} of 255");
    assert!(off < TOLERANCE, "{name} differs from its picture by {off} of 255");
    // The mirrored picture is rejected.
    let mirrored = image::imageops::flip_horizontal(&right);
    assert!(difference(&bytes, mirrored.as_raw()) > 2.0 * TOLERANCE, "{name}");
}

#[test]
fn hello_shows_its_picture() {
    check("hello", hello::example);
}

#[test]
fn dungeon_shows_its_picture() {
    check("dungeon", dungeon::example);
}

#[test]
fn neon_street_shows_its_picture() {
    check("neon_street", neon_street::example);
}

#[test]
fn stealth_shows_its_picture() {
    check("stealth", stealth::example);
}

#[test]
fn many_lights_shows_its_picture() {
    check("many_lights", many_lights::example);
}

#[test]
fn split_screen_shows_its_picture() {
    check("split_screen", split_screen::example);
}
