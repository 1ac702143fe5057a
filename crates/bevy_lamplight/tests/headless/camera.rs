//! Cameras: light stays in place while they move, and each camera has its own.

use crate::common::{Picture, app, begin, camera, picture, plain, target};
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{RenderTarget, SubCameraView, Viewport};
use bevy::prelude::*;
use bevy::render::view::Msaa;
use bevy_lamplight::prelude::*;

const SIZE: [u32; 2] = [160, 120];
/// The largest relative change of light at a place while a camera moves.
const STEADY: f32 = 0.01;

/// A wall and a glowing sprite, which every camera sees. Returns the sprite.
fn scene(app: &mut App) -> Entity {
    let lamp = Sprite::from_color(Color::linear_rgb(1.0, 0.5, 0.25), Vec2::splat(10.0));
    let wall = Sprite::from_color(Color::WHITE, Vec2::new(4.0, 30.0));
    app.world_mut().spawn((wall, Matter2d::wall(), Transform::from_xyz(12.0, 0.0, 0.0)));
    let place = Transform::from_xyz(-15.0, 5.0, 0.0);
    app.world_mut().spawn((lamp, Matter2d::glow(10.0), place)).id()
}

/// The light at places of the world, interpolated between pixels.
fn light_at(picture: &Picture, camera: Transform, zoom: f32, places: &[Vec2]) -> Vec<f32> {
    let back = camera.to_matrix().inverse();
    let sample = |place: &Vec2| {
        let seen = back.transform_point3(place.extend(0.0)).truncate() * zoom;
        let x = seen.x + 0.5 * picture.size[0] as f32 - 0.5;
        let y = 0.5 * picture.size[1] as f32 - seen.y - 0.5;
        let (left, top) = (x.floor(), y.floor());
        let grey = |dx: f32, dy: f32| picture.grey((left + dx) as u32, (top + dy) as u32);
        let (fx, fy) = (x - left, y - top);
        grey(0.0, 0.0).lerp(grey(1.0, 0.0), fx).lerp(grey(0.0, 1.0).lerp(grey(1.0, 1.0), fx), fy)
    };
    places.iter().map(sample).collect()
}

/// Places in the open, where light varies slowly.
fn places() -> Vec<Vec2> {
    let all = (-2..=2).flat_map(|y| (-2..=2).map(move |x| Vec2::new(x as f32, y as f32) * 9.0));
    let far =
        |place: &Vec2| place.distance(Vec2::new(-15.0, 5.0)) > 14.0 && (place.x - 12.0).abs() > 8.0;
    all.filter(far).collect()
}

fn worst(before: &[f32], after: &[f32]) -> f32 {
    let changes = before.iter().zip(after).map(|(a, b)| (a - b).abs() / a);
    changes.fold(0.0, f32::max)
}

#[test]
fn light_stays_where_it_is_while_the_camera_moves_and_turns() {
    // The second method takes long on a software GPU, so it makes fewer moves.
    let moves = [
        (0.3, 0.0, 0.0),
        (17.0, 9.5, 0.0),
        (2.0, 1.0, 0.3),
        (3.7, -2.2, 0.0),
        (-21.25, 4.0, 0.0),
        (0.0, 0.0, -1.1),
    ];
    let places = places();
    assert!(places.len() > 8);
    for (method, moves) in
        [(LightMethod::Cascades, &moves[..]), (LightMethod::Holographic, &moves[..2])]
    {
        let mut app = app();
        let image = target(&mut app, SIZE);
        let smooth = Lighting2d { method, filter: LightFilter::Linear, ..plain() };
        let eye = camera(&mut app, &image, smooth);
        let lamp = scene(&mut app);
        begin(&mut app);
        let first = light_at(&picture(&mut app, &image, 3), Transform::default(), 1.0, &places);
        let mut place = Transform::default();
        for &(x, y, turn) in moves {
            place = Transform::from_xyz(x, y, 0.0).with_rotation(Quat::from_rotation_z(turn));
            app.world_mut().entity_mut(eye).insert(place);
            let seen = picture(&mut app, &image, 1);
            let moved = worst(&first, &light_at(&seen, place, 1.0, &places));
            println!("{method:?} at ({x}, {y}), turned by {turn}: {:.2} %", 100.0 * moved);
            assert!(moved < STEADY, "{method:?} at ({x}, {y}), {turn}: {moved}");
        }
        // A moved lamp changes the light.
        app.world_mut().entity_mut(lamp).insert(Transform::from_xyz(-16.0, 5.0, 0.0));
        let seen = picture(&mut app, &image, 1);
        assert!(worst(&first, &light_at(&seen, place, 1.0, &places)) > STEADY);
    }
}

#[test]
fn zoom_changes_light_only_by_the_size_of_cells() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let lighting = Lighting2d {
        cells: CellSize::Screen(1.0),
        filter: LightFilter::Linear,
        border: 64.0,
        ..plain()
    };
    let eye = camera(&mut app, &image, lighting);
    scene(&mut app);
    begin(&mut app);
    let places = places();
    let mut zoomed = |scale: f32| {
        let projection = OrthographicProjection { scale, ..OrthographicProjection::default_2d() };
        app.world_mut().entity_mut(eye).insert(Projection::Orthographic(projection));
        light_at(&picture(&mut app, &image, 2), Transform::default(), 1.0 / scale, &places)
    };
    let first = zoomed(1.0);
    for scale in [0.8, 1.3] {
        let moved = worst(&first, &zoomed(scale));
        println!("zoomed by {scale}: {:.2} %", 100.0 * moved);
        assert!(moved < STEADY, "zoomed by {scale}: {moved}");
    }
    // Cells are twice as large, and light is about the same.
    let moved = worst(&first, &zoomed(1.9));
    println!("other cells: {:.2} %", 100.0 * moved);
    assert!(moved > 0.0 && moved < 0.1, "{moved}");
}

#[test]
fn mirrored_cameras_and_sub_views_see_the_same_light() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let smooth = Lighting2d { filter: LightFilter::Linear, ..plain() };
    let eye = camera(&mut app, &image, smooth);
    scene(&mut app);
    begin(&mut app);
    let places = places();
    let first = light_at(&picture(&mut app, &image, 3), Transform::default(), 1.0, &places);
    for (x, y) in [(-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
        let place = Transform::from_scale(Vec3::new(x, y, 1.0));
        app.world_mut().entity_mut(eye).insert(place);
        let seen = picture(&mut app, &image, 2);
        let moved = worst(&first, &light_at(&seen, place, 1.0, &places));
        assert!(moved < STEADY, "mirrored by ({x}, {y}): {moved}");
    }
    // A quarter of the view, twice as large, left of the centre and above it.
    let part = SubCameraView {
        full_size: SIZE.into(),
        offset: Vec2::new(30.0, 20.0),
        size: UVec2::new(80, 60),
    };
    let part = Camera { sub_camera_view: Some(part), ..default() };
    app.world_mut().entity_mut(eye).insert((part, Transform::default()));
    let seen = picture(&mut app, &image, 2);
    let middle = Transform::from_xyz(-10.0, 10.0, 0.0);
    let moved = worst(&first, &light_at(&seen, middle, 2.0, &places));
    assert!(moved < STEADY, "a part: {moved}");
}

#[test]
fn a_camera_above_another_that_clears_to_none_lights_only_what_it_draws() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let below = camera(&mut app, &image, plain());
    app.world_mut().entity_mut(below).insert(AmbientLight2d { brightness: 0.5, ..default() });
    let above = camera(&mut app, &image, plain());
    let clear = ClearColorConfig::Custom(Color::NONE);
    let own = Camera { order: 1, clear_color: clear, ..default() };
    let layer = RenderLayers::layer(1);
    let dim = AmbientLight2d { brightness: 0.25, ..default() };
    app.world_mut().entity_mut(above).insert((own, dim, layer.clone()));
    let sprite = Sprite::from_color(Color::WHITE, Vec2::splat(20.0));
    app.world_mut().spawn((sprite, layer));
    begin(&mut app);
    let seen = picture(&mut app, &image, 3);
    let near = |found: f32, right: f32| assert!((found - right).abs() < 2e-3, "{found}, {right}");
    near(seen.grey(20, 20), 0.5);
    near(seen.grey(80, 60), 0.25);
}

#[test]
fn matter_in_the_border_lights_the_screen() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let eye = camera(&mut app, &image, Lighting2d { border: 40.0, ..plain() });
    // Just off the right edge of the screen.
    let lamp = Sprite::from_color(Color::WHITE, Vec2::splat(10.0));
    app.world_mut().spawn((lamp, Matter2d::glow(10.0), Transform::from_xyz(100.0, 0.0, 0.0)));
    begin(&mut app);
    let lit = picture(&mut app, &image, 3);
    assert!(lit.grey(150, 60) > 0.2, "{}", lit.grey(150, 60));
    // Without a border, it does not.
    app.world_mut().entity_mut(eye).insert(Lighting2d { border: 0.0, ..plain() });
    let dark = picture(&mut app, &image, 1);
    // Grid sizes are rounded up, so the lamp has to be further away.
    app.world_mut().entity_mut(eye).insert(Transform::from_xyz(-120.0, 0.0, 0.0));
    let darker = picture(&mut app, &image, 1);
    assert!(darker.grey(150, 60) < 1e-3, "{} {}", dark.grey(150, 60), darker.grey(150, 60));
}

#[test]
fn a_split_screen_has_two_lights() {
    for msaa in [Msaa::Sample4, Msaa::Off] {
        split_screen(msaa);
    }
}

fn split_screen(msaa: Msaa) {
    let mut app = app();
    let image = target(&mut app, [160, 80]);
    let half = |x: u32| Viewport {
        physical_position: UVec2::new(x, 0),
        physical_size: UVec2::splat(80),
        ..default()
    };
    let left = camera(&mut app, &image, plain());
    let right = camera(&mut app, &image, Lighting2d { exposure: 1.0, ..plain() });
    let layers = [RenderLayers::layer(1), RenderLayers::layer(2)];
    for (order, (eye, x)) in [(left, 0), (right, 80)].into_iter().enumerate() {
        let clear_color =
            if order == 0 { ClearColorConfig::Default } else { ClearColorConfig::None };
        let eye_camera =
            Camera { viewport: Some(half(x)), order: order as isize, clear_color, ..default() };
        app.world_mut().entity_mut(eye).insert((eye_camera, msaa, layers[order].clone()));
    }
    // An unlit camera above both.
    let over = Camera { order: 2, clear_color: ClearColorConfig::None, ..default() };
    let over = (Camera2d, over, msaa, RenderLayers::layer(3));
    app.world_mut().spawn((over, RenderTarget::Image(image.clone().into())));
    let label = Sprite::from_color(Color::WHITE, Vec2::splat(8.0));
    app.world_mut().spawn((label, RenderLayers::layer(3)));
    // Each sees a lamp of another colour at the same place.
    for (layer, color) in
        layers.into_iter().zip([Color::linear_rgb(1.0, 0.0, 0.0), Color::linear_rgb(0.0, 0.0, 1.0)])
    {
        let sprite = Sprite::from_color(color, Vec2::splat(8.0));
        app.world_mut().spawn((sprite, Matter2d::glow(10.0), layer));
    }
    begin(&mut app);
    let seen = picture(&mut app, &image, 3);
    let (red, blue) = (seen.at(60, 40), seen.at(140, 40));
    assert!(red[0] > 0.1 && red[2] == 0.0, "{msaa:?}: {red:?}");
    assert!(blue[2] > 0.1 && blue[0] == 0.0, "{msaa:?}: {blue:?}");
    // The right one is exposed by one more stop.
    assert!((blue[2] / red[0] - 2.0).abs() < 0.01, "{msaa:?}: {red:?}, {blue:?}");
    assert_eq!(seen.at(80, 40), [1.0; 3], "{msaa:?}");
}
