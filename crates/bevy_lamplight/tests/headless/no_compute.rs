//! Light on a device without compute shaders and storage buffers, as under WebGL 2: the CPU finds it.

use crate::common::{
    Picture, add_bevy, add_bevy_within, begin, camera, image_of, picture, plain, target,
};
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy::render::renderer::RenderDevice;
use bevy_lamplight::prelude::*;
use lamplight_wgpu::wgpu::Limits;

const SIZE: [u32; 2] = [96, 64];
/// The tolerance between pictures of the same light, relative to light of 1: half floats have eleven bits.
const TOLERANCE: f32 = 1e-3;

/// A scene with everything that is drawn on the grid or read by the picture: glow, walls, fog, lamps of each kind, light
/// layers and normals.
fn spawn(app: &mut App, intensity: f32) {
    let texel = [208, 158, 222, 255];
    let bumps = image_of(app, [1, 1], TextureFormat::Rgba8Unorm, |_, _| texel.to_vec());
    let world = app.world_mut();
    let sprite = |side: f32| Sprite::from_color(Color::WHITE, Vec2::splat(side));
    let at = |x: f32, y: f32| Transform::from_xyz(x, y, 0.0);
    world.spawn((sprite(8.0), Matter2d::glow(4.0), at(-36.0, 20.0)));
    world.spawn((
        sprite(12.0),
        Matter2d::wall(),
        at(4.0, 10.0).with_rotation(Quat::from_rotation_z(0.4)),
    ));
    world.spawn((LightOccluder2d::circle(5.0), at(20.0, -12.0)));
    world.spawn((sprite(20.0), Matter2d::fog(0.02), at(-14.3, -14.6)));
    world.spawn((sprite(16.0), NormalMap2d::new(bumps), LightMask2d(2), at(30.0, 14.0)));
    world.spawn((PointLight2d { intensity, ..default() }, at(-8.0, 2.0)));
    world.spawn((SpotLight2d { mask: 2, ..default() }, at(44.0, -4.0)));
}

/// The picture of the scene with a lamp this bright, and the number of storage buffers of the device.
fn seen(limits: Option<Limits>, intensity: f32) -> (Picture, u32) {
    let mut app = App::new();
    match limits {
        Some(limits) => add_bevy_within(&mut app, limits),
        None => add_bevy(&mut app),
    }
    app.add_plugins(LamplightPlugin)
        .insert_resource(ClearColor(Color::WHITE))
        .insert_resource(LightBackend::Cpu);
    let image = target(&mut app, SIZE);
    let lighting = Lighting2d { method: LightMethod::Holographic, surroundings: 1, ..plain() };
    let eye = camera(&mut app, &image, lighting);
    app.world_mut().entity_mut(eye).insert(LightTexture2d);
    spawn(&mut app, intensity);
    begin(&mut app);
    let buffers = app.world().resource::<RenderDevice>().limits();
    (picture(&mut app, &image, 4), buffers.max_storage_buffers_per_shader_stage)
}

/// The largest difference between two pictures, relative to light of 1.
fn difference(found: &Picture, right: &Picture) -> f32 {
    let texels = found.texels.iter().zip(&right.texels);
    let off = texels.map(|(found, right)| {
        let off = |c: usize| (found[c] - right[c]).abs() / right[c].max(1.0);
        (0..4).map(off).fold(0.0, f32::max)
    });
    off.fold(0.0, f32::max)
}

#[test]
fn a_device_without_compute_shaders_shows_the_same_picture() {
    let (right, buffers) = seen(None, 1.0);
    assert!(buffers > 0);
    let (found, buffers) = seen(Some(Limits::downlevel_webgl2_defaults()), 1.0);
    assert_eq!(buffers, 0);
    let worst = difference(&found, &right);
    println!("largest difference {worst}");
    assert!(worst <= TOLERANCE, "{worst}");
    let lit = right.texels.iter().filter(|texel| texel[0] > 0.1).count();
    assert!(lit > right.texels.len() / 4, "{lit} texels are lit");
    let (brighter, _) = seen(None, 1.02);
    assert!(difference(&brighter, &right) > TOLERANCE, "a brighter lamp passes");
}
