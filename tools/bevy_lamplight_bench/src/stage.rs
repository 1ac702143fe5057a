//! The scene in each plugin's own components.

use crate::contender::Contender;
use crate::headless::Headless;
use crate::scene::{RANGE, SIDE, Scene, VIEW};
use bevy::prelude::*;

/// Light that is everywhere, where a plugin asks for it.
const AMBIENT: f32 = 0.1;

/// An app that shows a scene, lit by a contender.
pub fn set(contender: Contender, scene: &Scene) -> Headless {
    let mut headless = Headless::new(|app| add_plugin(contender, app));
    let camera = headless.camera();
    let world = headless.world();
    let size = VIEW.map(|v| v as f32).into();
    world.spawn((Sprite::from_color(Color::WHITE, size), Transform::from_xyz(0.0, 0.0, -1.0)));
    match contender {
        Contender::Unlit => {
            world.spawn(camera);
            let place = |world: &mut World, at| {
                world.spawn((at, Visibility::default()));
            };
            spawn(world, scene, place, place);
        }
        Contender::Holographic => lamplight(world, camera, scene, default()),
        Contender::HolographicFast => {
            lamplight(
                world,
                camera,
                scene,
                bevy_lamplight::Lighting2d::default()
                    .with_quality(bevy_lamplight::LightQuality::Fast),
            );
        }
        Contender::Cascades => {
            let method = bevy_lamplight::LightMethod::Cascades;
            lamplight(world, camera, scene, bevy_lamplight::Lighting2d { method, ..default() });
        }
        Contender::Light2d => light_2d(world, camera, scene),
    }
    headless
}

fn add_plugin(contender: Contender, app: &mut App) {
    match contender {
        Contender::Unlit => {}
        Contender::Holographic | Contender::HolographicFast | Contender::Cascades => {
            app.add_plugins(bevy_lamplight::LamplightPlugin);
        }
        Contender::Light2d => {
            app.add_plugins(bevy_light_2d::plugin::Light2dPlugin);
        }
    }
}

/// Spawns each lamp and each occluder where it is.
fn spawn(
    world: &mut World,
    scene: &Scene,
    lamp: impl Fn(&mut World, Transform),
    occluder: impl Fn(&mut World, Transform),
) {
    let at = |place: &Vec2| Transform::from_translation(place.extend(0.0));
    scene.lamps.iter().for_each(|place| lamp(world, at(place)));
    scene.occluders.iter().for_each(|place| occluder(world, at(place)));
}

fn lamplight(
    world: &mut World,
    camera: impl Bundle,
    scene: &Scene,
    lighting: bevy_lamplight::Lighting2d,
) {
    use bevy_lamplight::{AmbientLight2d, LightOccluder2d, PointLight2d};
    world.spawn((camera, lighting, AmbientLight2d { brightness: AMBIENT, ..default() }));
    let lamp = |world: &mut World, at| {
        world.spawn((PointLight2d { range: RANGE, ..default() }, at));
    };
    let occluder = |world: &mut World, at| {
        world.spawn((LightOccluder2d::rectangle(SIDE, SIDE), at));
    };
    spawn(world, scene, lamp, occluder);
}

fn light_2d(world: &mut World, camera: impl Bundle, scene: &Scene) {
    use bevy_light_2d::light::{AmbientLight2d, Light2d, PointLight2d};
    use bevy_light_2d::occluder::{LightOccluder2d, LightOccluder2dShape};
    let ambient_light = AmbientLight2d { brightness: AMBIENT, ..default() };
    world.spawn((camera, Light2d { ambient_light, ..default() }));
    let lamp = |world: &mut World, at| {
        world.spawn((PointLight2d { radius: RANGE, cast_shadows: true, ..default() }, at));
    };
    let occluder = |world: &mut World, at| {
        let shape = LightOccluder2dShape::Rectangle { half_size: Vec2::splat(0.5 * SIDE) };
        world.spawn((LightOccluder2d { shape }, at));
    };
    spawn(world, scene, lamp, occluder);
}
