//! Lamps light the layers of their mask, on the GPU as in queries, and nothing is spent without masks.

use crate::common::{Picture, app, begin, camera, picture, plain, target};
use bevy::prelude::*;
use bevy_lamplight::prelude::*;

const SIZE: [u32; 2] = [96, 64];
/// The tolerance between pictures that differ in nothing that is compared: half floats have eleven bits.
const TOLERANCE: f32 = 2e-3;
/// The tolerance of a query's cells, four times as wide as those of the picture.
const QUERY: f32 = 0.08;
/// Places in the world: on the left half, on the right half, and on a box of matter in it.
const LEFT: Vec2 = Vec2::new(-24.0, 9.0);
const RIGHT: Vec2 = Vec2::new(24.0, 17.0);
const ON_FOG: Vec2 = Vec2::new(20.0, -16.0);

#[derive(Resource, Default)]
struct Answers([Option<LinearRgba>; 3]);

fn query(light: LightQuery, mut answers: ResMut<Answers>) {
    answers.0 = [LEFT, RIGHT, ON_FOG].map(|place| light.at(place));
}

/// A backdrop in two halves, in the layers 2 and 4, and thin fog over the right one, in all layers.
fn seen(method: LightMethod, spawn: impl FnOnce(&mut World)) -> (Picture, [f32; 3]) {
    let mut app = app();
    let image = target(&mut app, SIZE);
    camera(&mut app, &image, Lighting2d { method, ..plain() });
    for (layer, x) in [(2, -50.0), (4, 50.0)] {
        let half = Sprite::from_color(Color::WHITE, Vec2::new(100.0, 200.0));
        app.world_mut().spawn((half, LightMask2d(layer), Transform::from_xyz(x, 0.0, -1.0)));
    }
    let fog = Sprite::from_color(Color::WHITE, Vec2::splat(16.0));
    let fog = (fog, Matter2d::fog(1e-4), Transform::from_xyz(ON_FOG.x, ON_FOG.y, 0.0));
    app.world_mut().spawn(fog);
    spawn(app.world_mut());
    app.init_resource::<Answers>().add_systems(Update, query);
    begin(&mut app);
    let seen = picture(&mut app, &image, 3);
    let answers = app.world().resource::<Answers>().0;
    (seen, answers.map(|answer| answer.expect("on the screen").green))
}

fn at(seen: &Picture, place: Vec2) -> f32 {
    seen.grey((place.x + 48.0) as u32, (32.0 - place.y) as u32)
}

fn lamp(mask: u8) -> impl FnOnce(&mut World) {
    move |world| {
        let light = PointLight2d { range: 100.0, mask, ..default() };
        world.spawn((light, Transform::from_xyz(0.0, 0.0, 0.0)));
    }
}

#[test]
fn a_lamp_lights_its_layers_as_brightly_as_without_a_mask() {
    for method in [LightMethod::Cascades, LightMethod::Polar] {
        let (unmasked, _) = seen(method, lamp(u8::MAX));
        let (masked, answers) = seen(method, lamp(2));
        for (name, place, lit) in
            [("left", LEFT, true), ("right", RIGHT, false), ("fog", ON_FOG, true)]
        {
            let (with, without) = (at(&masked, place), at(&unmasked, place));
            println!("{method:?}, {name}: {with}, {without} without a mask");
            assert!(without > 0.3, "{method:?}, {name}: {without}");
            if lit {
                // The disc of other lamps is drawn on cells.
                assert!((with / without - 1.0).abs() < 0.05, "{method:?}, {name}: {with}");
            } else {
                assert_eq!(with, 0.0, "{method:?}, {name}");
            }
        }
        for (answer, place) in answers.into_iter().zip([LEFT, RIGHT, ON_FOG]) {
            let right = at(&masked, place);
            println!("{method:?}: the query {answer}, the picture {right}");
            assert!((answer - right).abs() <= QUERY * right, "{method:?}: {answer}, not {right}");
        }
    }
}

#[test]
fn suns_and_spots_light_their_layers_and_no_layer_is_off() {
    let (sun, answers) = seen(LightMethod::Cascades, |world| {
        world.spawn(SunLight2d { mask: 4, ..default() });
    });
    let open = SunLight2d::default().intensity / std::f32::consts::TAU;
    assert_eq!([at(&sun, LEFT), answers[0]], [0.0; 2]);
    for light in [at(&sun, RIGHT), answers[1]] {
        assert!((light / open - 1.0).abs() < 1e-2, "{light}, not {open}");
    }
    let spot = |mask| {
        let angle = std::f32::consts::TAU;
        let spot = SpotLight2d { range: 100.0, angle, softness: 0.0, mask, ..default() };
        seen(LightMethod::Cascades, |world| {
            world.spawn(spot);
        })
    };
    let (other, _) = spot(8);
    assert_eq!([LEFT, RIGHT].map(|place| at(&other, place)), [0.0; 2]);
    assert!(at(&other, ON_FOG) > 0.5, "matter without a mask is in all layers");
    let (off, _) = spot(0);
    assert!(off.texels.iter().all(|texel| texel[..3] == [0.0; 3]));
}

#[test]
fn a_mask_of_no_layer_is_that_of_all() {
    let light = |mask| {
        seen(LightMethod::Cascades, move |world| {
            lamp(2)(world);
            let sprite = Sprite::from_color(Color::WHITE, Vec2::splat(8.0));
            let place = Transform::from_translation(RIGHT.extend(1.0));
            world.spawn((sprite, LightMask2d(mask), place));
        })
    };
    let (none, all, other) = (light(0), light(u8::MAX), light(4));
    assert!(at(&none.0, RIGHT) > 0.3);
    assert!((at(&none.0, RIGHT) - at(&all.0, RIGHT)).abs() < TOLERANCE);
    assert_eq!(none.1, all.1);
    assert_eq!(at(&other.0, RIGHT), 0.0);
}
