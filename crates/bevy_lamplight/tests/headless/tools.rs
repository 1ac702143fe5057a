//! Tone maps, gizmos and diagnostics.

use crate::common::{app, begin, camera, picture, plain, target};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::diagnostic::DiagnosticsStore;
use bevy::prelude::*;
use bevy::render::diagnostic::RenderDiagnosticsPlugin;
use bevy_lamplight::prelude::*;

const SIZE: [u32; 2] = [64, 48];

#[test]
fn light_above_one_is_tone_mapped_once() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let eye = camera(&mut app, &image, plain());
    app.world_mut().entity_mut(eye).insert(AmbientLight2d { brightness: 3.0, ..default() });
    begin(&mut app);
    let mut shown = |tone_map, own| {
        let lighting = Lighting2d { tone_map, ..plain() };
        app.world_mut().entity_mut(eye).insert((lighting, own));
        picture(&mut app, &image, 2).grey(30, 20)
    };
    let near = |found: f32, right: f32| assert!((found - right).abs() < 2e-3, "{found}, {right}");
    near(shown(LightToneMap::Off, Tonemapping::None), 3.0);
    near(shown(LightToneMap::Reinhard, Tonemapping::None), 0.75);
    let aces = shown(LightToneMap::Aces, Tonemapping::None);
    assert!(aces > 0.8 && aces <= 1.0, "{aces}");
    let vivid = shown(LightToneMap::Vivid, Tonemapping::None);
    assert!(vivid > 0.5 && vivid < aces, "{vivid}");
    near(shown(LightToneMap::Camera, Tonemapping::None), vivid);
    // Bevy's own tone map applies, and not both.
    near(shown(LightToneMap::Camera, Tonemapping::Reinhard), 0.75);
}

#[test]
fn gizmos_outline_occluders_and_are_not_lit() {
    let mut app = app();
    app.add_plugins((LamplightGizmosPlugin, LamplightGizmosPlugin));
    let image = target(&mut app, SIZE);
    camera(&mut app, &image, plain());
    let occluder = LightOccluder2d::rectangle(20.0, 12.0);
    let shape = app.world_mut().spawn((occluder, Transform::default())).id();
    begin(&mut app);
    let reddish = |app: &mut App| {
        let seen = picture(app, &image, 3);
        seen.texels.iter().filter(|[r, g, ..]| *r > 0.3 && *r > 2.0 * g).count()
    };
    // The outline of a box of 20 × 12, two pixels wide, in the dark.
    let drawn = reddish(&mut app);
    assert!((40..200).contains(&drawn), "{drawn}");
    app.world_mut().entity_mut(shape).despawn();
    assert_eq!(reddish(&mut app), 0);
}

#[test]
fn every_pass_is_in_the_diagnostics() {
    let mut app = app();
    // The CPU finds light before passes are recorded.
    app.insert_resource(LightBackend::Gpu).add_plugins(RenderDiagnosticsPlugin);
    let image = target(&mut app, SIZE);
    camera(&mut app, &image, plain());
    begin(&mut app);
    (0..12).for_each(|_| app.update());
    let store = app.world().resource::<DiagnosticsStore>();
    let paths: Vec<_> = store.iter().map(|diagnostic| diagnostic.path().to_string()).collect();
    for pass in ["lamplight matter", "lamplight light", "lamplight compose"] {
        let is_there = paths.iter().any(|path| path.contains(pass));
        assert!(is_there, "{pass} is not among {paths:?}");
    }
}
