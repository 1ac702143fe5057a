//! Entities that come and go, and invalid values.

use crate::common::{add_bevy, app, begin, camera, image, picture, plain, target};
use bevy::camera::{CompositingSpace, RenderTarget};
use bevy::prelude::*;
use bevy::render::renderer::RenderDevice;
use bevy::render::{RenderApp, RenderStartup};
use bevy::window::WindowRef;
use bevy_lamplight::prelude::*;
use bevy_lamplight::render::ViewLightTexture;
use std::ops::Range;

const SIZE: [u32; 2] = [64, 48];

#[test]
fn light_follows_entities_that_are_added_changed_hidden_and_despawned() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    camera(&mut app, &image, plain());
    begin(&mut app);
    let light = |app: &mut App| picture(app, &image, 1).at(48, 24);
    assert_eq!(light(&mut app), [0.0; 3]);
    let sprite = Sprite::from_color(Color::WHITE, Vec2::splat(6.0));
    let lamp = app.world_mut().spawn((sprite, Matter2d::glow(6.0))).id();
    let first = light(&mut app);
    assert!(first[0] > 0.1 && first[0] == first[2], "{first:?}");
    app.world_mut()
        .entity_mut(lamp)
        .insert(Matter2d { emission: LinearRgba::rgb(12.0, 0.0, 0.0), ..Matter2d::glow(1.0) });
    let changed = light(&mut app);
    assert!((changed[0] / first[0] - 2.0).abs() < 0.01 && changed[2] == 0.0, "{changed:?}");
    app.world_mut().entity_mut(lamp).insert(Visibility::Hidden);
    assert_eq!(light(&mut app), [0.0; 3]);
    app.world_mut().entity_mut(lamp).insert(Visibility::Inherited);
    assert_eq!(light(&mut app), changed);
    app.world_mut().entity_mut(lamp).remove::<Matter2d>();
    assert_eq!(light(&mut app), [0.0; 3]);
    app.world_mut().entity_mut(lamp).insert(Matter2d::glow(6.0));
    assert_eq!(light(&mut app), first);
    app.world_mut().entity_mut(lamp).despawn();
    assert_eq!(light(&mut app), [0.0; 3]);
}

#[test]
fn the_first_camera_is_lit_from_its_first_frame_on() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    begin(&mut app);
    app.update();
    camera(&mut app, &image, plain());
    // There is no light, so a frame without light would show the white background.
    assert_eq!(picture(&mut app, &image, 0).at(48, 24), [0.0; 3]);
}

#[test]
fn a_picture_of_encoded_colours_is_left_as_it_is() {
    for (space, is_lit) in [
        (CompositingSpace::Linear, true),
        (CompositingSpace::Srgb, false),
        (CompositingSpace::Oklab, false),
    ] {
        let mut app = app();
        let image = target(&mut app, SIZE);
        let eye = camera(&mut app, &image, plain());
        app.world_mut().entity_mut(eye).insert(space);
        begin(&mut app);
        // Without light all is dark.
        let [red, ..] = picture(&mut app, &image, 2).at(48, 24);
        assert_eq!(red < 0.5, is_lit, "{space:?}: {red}");
    }
}

#[test]
fn a_window_of_size_zero_does_not_panic() {
    let mut app = app();
    let window = app.world_mut().spawn(Window { resolution: (64, 48).into(), ..default() }).id();
    let target = RenderTarget::Window(WindowRef::Entity(window));
    app.world_mut().spawn((Camera2d, target, plain()));
    begin(&mut app);
    for size in [(64, 48), (0, 0), (0, 48), (1, 1), (64, 0), (80, 60)] {
        let mut window = app.world_mut().get_mut::<Window>(window).expect("there is one");
        window.resolution.set_physical_resolution(size.0, size.1);
        (0..2).for_each(|_| app.update());
    }
}

#[test]
fn a_resized_target_is_lit_completely() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let eye = camera(&mut app, &image, plain());
    app.world_mut().entity_mut(eye).insert(AmbientLight2d { brightness: 0.5, ..default() });
    begin(&mut app);
    for (width, height) in [(64, 48), (200, 3), (1, 1), (90, 110)] {
        let image = target(&mut app, [width, height]);
        let other = RenderTarget::Image(image.clone().into());
        app.world_mut().entity_mut(eye).insert(other);
        let seen = picture(&mut app, &image, 2);
        assert_eq!(seen.size, [width, height]);
        let wrong = seen.texels.iter().find(|[r, ..]| (r - 0.5).abs() > 1e-3);
        assert_eq!(wrong, None, "{width}×{height}");
    }
}

#[test]
fn plugins_may_be_added_in_any_order() {
    let mut app = App::new();
    app.add_plugins(LamplightPlugin);
    add_bevy(&mut app);
    app.insert_resource(ClearColor(Color::WHITE));
    let image = target(&mut app, SIZE);
    let eye = camera(&mut app, &image, plain());
    app.world_mut().entity_mut(eye).insert(AmbientLight2d { brightness: 0.5, ..default() });
    begin(&mut app);
    let seen = picture(&mut app, &image, 3);
    assert!((seen.grey(9, 9) - 0.5).abs() < 1e-3, "{}", seen.grey(9, 9));
}

/// Light that even a software GPU finds many times a second.
fn quick() -> Lighting2d {
    Lighting2d { method: LightMethod::Holographic, quality: LightQuality::Fast, ..plain() }
}

/// GPU objects in use: buffers, textures, views, bind groups, pipelines, bytes.
fn held(app: &App) -> [isize; 6] {
    let device = app.world().resource::<RenderDevice>().wgpu_device().clone();
    let counters = device.get_internal_counters().hal;
    [
        counters.buffers.read(),
        counters.textures.read(),
        counters.texture_views.read(),
        counters.bind_groups.read(),
        counters.compute_pipelines.read() + counters.render_pipelines.read(),
        counters.buffer_memory.read() + counters.texture_memory.read(),
    ]
}

/// The minimum of [`held`] over some frames, `before` each of which the app is changed: objects are freed some frames
/// late, and copies to the GPU are held while it is busy.
fn least_held(app: &mut App, frames: Range<u32>, before: impl Fn(&mut App, u32)) -> [isize; 6] {
    frames.fold([isize::MAX; 6], |least, frame| {
        before(app, frame);
        app.update();
        let held = held(app);
        std::array::from_fn(|kind| held[kind].min(least[kind]))
    })
}

#[test]
fn gpu_objects_do_not_accumulate() {
    let mut app = app();
    app.insert_resource(LightBackend::Gpu);
    let image = target(&mut app, SIZE);
    camera(&mut app, &image, quick());
    let sprite = Sprite::from_color(Color::WHITE, Vec2::splat(6.0));
    let lamp = app.world_mut().spawn((sprite, Matter2d::glow(6.0))).id();
    app.world_mut().spawn((SpotLight2d::default(), Transform::from_xyz(5.0, 5.0, 0.0)));
    app.world_mut().spawn((PointLight2d::default(), Transform::from_xyz(-5.0, 5.0, 0.0)));
    begin(&mut app);
    let shift = |app: &mut App, frame: u32| {
        let x = 4.0 * (frame % 10) as f32 - 20.0;
        app.world_mut().entity_mut(lamp).insert(Transform::from_xyz(x, 0.0, 0.0));
    };
    least_held(&mut app, 0..10, shift);
    let early = least_held(&mut app, 10..20, shift);
    least_held(&mut app, 20..40, shift);
    let late = least_held(&mut app, 40..50, shift);
    println!("buffers, textures, views, bind groups, pipelines, bytes: {early:?}, {late:?}");
    assert!(early[0] > 10, "the counters count");
    assert!(late.iter().zip(early).all(|(late, early)| *late <= early), "{early:?}, {late:?}");
}

#[test]
fn cameras_that_pause_keep_their_light_and_later_ones_what_was_compiled() {
    let mut app = app();
    app.insert_resource(LightBackend::Gpu);
    let image = target(&mut app, SIZE);
    let eye = camera(&mut app, &image, quick());
    begin(&mut app);
    let settled = |app: &mut App| {
        least_held(app, 0..10, |_, _| {});
        least_held(app, 0..5, |_, _| {})
    };
    let lit = settled(&mut app);
    app.world_mut().get_mut::<Camera>(eye).expect("it is a camera").is_active = false;
    let paused = settled(&mut app);
    app.world_mut().entity_mut(eye).despawn();
    let gone = settled(&mut app);
    println!("lit {lit:?}, paused {paused:?}, gone {gone:?}");
    let [pipelines, bytes] = [4, 5];
    assert_eq!(paused[pipelines], lit[pipelines]);
    // But for copies on their way to the GPU.
    assert!(10 * paused[bytes] > 9 * lit[bytes] && 4 * gone[bytes] < 3 * lit[bytes]);
    // All but that of its picture.
    assert_eq!(gone[pipelines], lit[pipelines] - 1);
}

#[test]
fn light_returns_when_bevy_renders_on_another_device() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let eye = camera(&mut app, &image, plain());
    app.world_mut()
        .entity_mut(eye)
        .insert((AmbientLight2d { brightness: 0.5, ..default() }, LightTexture2d));
    begin(&mut app);
    let before = picture(&mut app, &image, 3);
    let texture = |app: &mut App| {
        let world = app.sub_app_mut(RenderApp).world_mut();
        let mut query = world.query::<&ViewLightTexture>();
        query.single(world).expect("there is one").view.clone()
    };
    let former = texture(&mut app);
    // As it does then.
    app.sub_app_mut(RenderApp).world_mut().run_schedule(RenderStartup);
    let after = picture(&mut app, &image, 5);
    assert_eq!(after.grey(9, 9), before.grey(9, 9));
    assert_ne!(texture(&mut app), former, "what the former device held is still used");
}

#[test]
fn normal_maps_cost_nothing_before_they_come_and_after_they_are_gone() {
    let mut app = app();
    app.insert_resource(LightBackend::Gpu);
    let target = target(&mut app, SIZE);
    camera(&mut app, &target, quick());
    let map = NormalMap2d::new(image(&mut app, [1, 1], |_, _| [188, 188, 255, 255]));
    let sprite = Sprite::from_color(Color::WHITE, Vec2::splat(6.0));
    app.world_mut().spawn((sprite.clone(), Matter2d::glow(6.0)));
    let mapped = app.world_mut().spawn((sprite, Transform::from_xyz(12.0, 0.0, 0.0))).id();
    begin(&mut app);
    let steady = |app: &mut App| {
        (0..10).for_each(|_| app.update());
        least_held(app, 0..10, |_, _| {})
    };
    let before = steady(&mut app);
    app.world_mut().entity_mut(mapped).insert(map);
    let with = steady(&mut app);
    assert!(with[0] > before[0] && with[2] > before[2], "{before:?}, {with:?}");
    assert!(with[5] > before[5], "{before:?}, {with:?}");
    app.world_mut().entity_mut(mapped).despawn();
    let after = steady(&mut app);
    println!(
        "buffers, textures, views, bind groups, pipelines, bytes: {before:?}, {with:?}, {after:?}"
    );
    // Pipelines are kept; views and bytes are not.
    for kind in [2, 5] {
        assert!(after[kind] <= before[kind], "{before:?}, {after:?}");
    }
}

#[test]
fn nothing_panics_without_a_camera_with_two_plugins_or_with_invalid_values() {
    let mut app = app();
    app.add_plugins(LamplightPlugin);
    begin(&mut app);
    (0..2).for_each(|_| app.update());

    let image = target(&mut app, SIZE);
    let eye = camera(&mut app, &image, plain());
    app.world_mut().entity_mut(eye).insert(AmbientLight2d { brightness: 0.5, ..default() });
    let nowhere = Transform::from_xyz(f32::NAN, 0.0, 0.0);
    let gone = app.world().resource::<AssetServer>().load::<Image>("no such picture.png");
    let sprite = Sprite::from_color(Color::WHITE, Vec2::splat(6.0));
    let infinite = Transform::from_scale(Vec3::splat(f32::INFINITY));
    let world = app.world_mut();
    world.spawn((Sprite::from_image(gone), Matter2d::glow(5.0)));
    world.spawn((Sprite::from_image(Handle::default()), Matter2d::glow(5.0), nowhere));
    world.spawn((sprite.clone(), Matter2d::wall(), infinite));
    world.spawn((sprite.clone(), Matter2d::wall(), Transform::from_scale(Vec3::ZERO)));
    world.spawn((
        sprite,
        Matter2d {
            opacity: f32::NAN,
            emission: LinearRgba::rgb(f32::NAN, -1.0, f32::INFINITY),
            ..default()
        },
        Transform::from_xyz(500.0, 0.0, 0.0),
    ));
    world.spawn((LightOccluder2d::polygon([Vec2::NAN, Vec2::ONE]), Transform::default()));
    world.spawn((LightOccluder2d::polygon([]), Transform::default()));
    world.spawn((LightOccluder2d::circle(-3.0), nowhere));
    world.spawn((LightOccluder2d::capsule(0.0, 0.0), Transform::default()));
    world.spawn((PointLight2d { radius: -1.0, ..default() }, Transform::default()));
    world.spawn((PointLight2d { intensity: f32::NAN, ..default() }, Transform::default()));
    world.spawn((PointLight2d::default(), nowhere));
    world.spawn((SpotLight2d { angle: f32::INFINITY, ..default() }, Transform::default()));
    world.spawn((SpotLight2d::default(), Transform::from_scale(Vec3::ZERO)));
    world.spawn((NormalMap2d::default(), nowhere));
    let seen = picture(&mut app, &image, 3);
    assert!(seen.texels.iter().all(|t| (t[0] - 0.5).abs() < 1e-3), "everything else is lit");

    // A camera with invalid settings or an invalid transform shows its picture unlit.
    let wrong = [
        Lighting2d { set: vec!["holographic.preset=none".into()], ..plain() },
        Lighting2d { set: vec!["no such key".into()], ..plain() },
        Lighting2d { set: vec!["method=polar".into()], ..plain() },
        Lighting2d { border: f32::INFINITY, ..plain() },
        Lighting2d { cells: CellSize::World(f32::NAN), ..plain() },
        Lighting2d { cells: CellSize::World(0.0), ..plain() },
        Lighting2d { bounces: LightBounces::Count(1000), ..plain() },
        Lighting2d { exposure: f32::NAN, ..plain() },
    ];
    for lighting in wrong {
        app.world_mut().entity_mut(eye).insert(lighting.clone());
        let seen = picture(&mut app, &image, 1);
        assert!(seen.texels.iter().all(|t| t[0] == 1.0), "{lighting:?}: {:?}", seen.texels[0]);
    }
    app.world_mut().entity_mut(eye).insert(Transform::from_xyz(1e30, -1e30, 0.0));
    picture(&mut app, &image, 1);
    // The camera recovers and is then removed.
    app.world_mut().entity_mut(eye).insert((plain(), Transform::default()));
    assert!((picture(&mut app, &image, 1).at(0, 0)[0] - 0.5).abs() < 1e-3);
    app.world_mut().entity_mut(eye).despawn();
    (0..2).for_each(|_| app.update());
}

#[test]
fn the_quality_auto_is_fast_where_light_takes_long() {
    // A hundred milliseconds and more on two cores.
    const LARGE: [u32; 2] = [1280, 960];
    let seen = |quality: LightQuality, frames: usize| {
        let mut app = app();
        app.insert_resource(LightBackend::Cpu);
        let image = target(&mut app, LARGE);
        let lighting = Lighting2d { method: LightMethod::Holographic, ..plain() };
        let eye = camera(&mut app, &image, lighting.clone().with_quality(quality));
        let sprite = Sprite::from_color(Color::WHITE, Vec2::splat(9.0));
        app.world_mut().spawn((sprite, Matter2d::glow(6.0)));
        begin(&mut app);
        let first = picture(&mut app, &image, frames).texels;
        // Another quality holds at once.
        app.world_mut().entity_mut(eye).insert(lighting);
        (first, picture(&mut app, &image, 1).texels)
    };
    let ((fast, _), (default, _)) = (seen(LightQuality::Fast, 2), seen(LightQuality::Default, 2));
    assert!(fast != default);
    let (auto, then) = seen(LightQuality::Auto, 16);
    assert!(auto == fast && then == default);
}
