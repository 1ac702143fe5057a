//! Lamps, spots, ambient light and sky.

use crate::common::{app, begin, camera, picture, plain, target};
use bevy::prelude::*;
use bevy_lamplight::prelude::*;

const SIZE: [u32; 2] = [160, 120];

#[test]
fn light_at_a_quarter_of_the_range_equals_the_intensity_at_any_subcell_position() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let rays = vec!["raymarch.rays=128".to_owned()];
    camera(&mut app, &image, Lighting2d { method: LightMethod::Raymarch, set: rays, ..plain() });
    let light =
        PointLight2d { color: Color::linear_rgb(1.0, 0.5, 0.0), intensity: 0.75, ..default() };
    let lamp = app.world_mut().spawn((light, Transform::default())).id();
    begin(&mut app);
    for (x, y) in [(0.0, 0.0), (0.3, 0.7), (0.5, 0.5), (0.9, 0.1)] {
        app.world_mut().entity_mut(lamp).insert(Transform::from_xyz(x, y, 0.0));
        let seen = picture(&mut app, &image, 2);
        // Means over rings at a quarter and at 0.44 of the range of 128.
        for (distance, right) in [(32.0, 0.75), (56.0, 0.75 * 32.0 / 56.0)] {
            let mut sum = [0.0f32; 3];
            const AROUND: usize = 24;
            for i in 0..AROUND {
                let angle = i as f32 / AROUND as f32 * std::f32::consts::TAU;
                let px = 80.0 + x + distance * angle.cos();
                let py = 60.0 - y + distance * angle.sin();
                let at = seen.at(px as u32, (py as u32).min(SIZE[1] - 1));
                (0..3).for_each(|c| sum[c] += at[c] / AROUND as f32);
            }
            println!("({x}, {y}), {distance} away: {sum:?}, {right}");
            assert!((sum[0] / right - 1.0).abs() < 0.05, "{sum:?}, not {right}");
            assert!((sum[1] / sum[0] - 0.5).abs() < 0.01 && sum[2] == 0.0, "{sum:?}");
        }
    }
}

#[test]
fn small_lamps_give_as_much_light_as_large_ones() {
    let mut app = app();
    let image = target(&mut app, [96, 64]);
    let eye = camera(&mut app, &image, plain());
    let lamp = app.world_mut().spawn(Transform::from_xyz(0.3, 0.7, 0.0)).id();
    begin(&mut app);
    for method in [LightMethod::Cascades, LightMethod::Holographic] {
        app.world_mut().entity_mut(eye).insert(Lighting2d { method, ..plain() });
        for radius in [4.0, 2.0, 0.5, 1e-3, 0.0] {
            let light = PointLight2d { range: 60.0, radius, ..default() };
            app.world_mut().entity_mut(lamp).insert(light);
            let seen = picture(&mut app, &image, 2);
            // At a quarter of the range.
            let around = [(15, 0), (-15, 0), (0, 15), (0, -15)];
            let light = around.map(|(x, y)| seen.grey((48 + x) as u32, (31 + y) as u32));
            let mean = light.iter().sum::<f32>() / 4.0;
            println!("{method:?}, radius {radius}: {mean} of {light:?}");
            assert!((mean - 1.0).abs() < 0.1, "{method:?}, radius {radius}: {light:?}");
        }
    }
}

#[test]
fn a_spot_lights_its_cone_and_walls_block_it() {
    for method in [LightMethod::Cascades, LightMethod::Polar] {
        let mut app = app();
        let image = target(&mut app, SIZE);
        camera(&mut app, &image, Lighting2d { method, ..plain() });
        let spot = SpotLight2d { range: 100.0, angle: 0.8, softness: 0.2, ..default() };
        // Towards the upper left, where there is a wall.
        let turn = Quat::from_rotation_z(2.5);
        app.world_mut().spawn((spot, Transform::from_rotation(turn)));
        let wall = LightOccluder2d::rectangle(4.0, 40.0);
        app.world_mut().spawn((wall, Transform::from_xyz(-50.0, 36.0, 0.0)));
        begin(&mut app);
        let seen = picture(&mut app, &image, 3);
        let at = |distance: f32, angle: f32| {
            let (sin, cos) = angle.sin_cos();
            seen.grey((80.0 + distance * cos) as u32, (60.0 - distance * sin) as u32)
        };
        // Linear falloff.
        assert!((at(30.0, 2.5) - 0.7).abs() < 0.05, "{method:?}: {}", at(30.0, 2.5));
        assert!(at(30.0, 2.5 + 0.6) < 1e-3, "beside the cone");
        assert!(at(30.0, 2.5 - std::f32::consts::PI) < 1e-3, "behind");
        assert!(at(72.0, 2.5) < 1e-3, "in the shadow: {}", at(72.0, 2.5));
    }
}

#[test]
fn a_profile_shapes_the_beam_counterclockwise() {
    const VALUES: [f32; 3] = [0.1, 1.0, 0.4];
    let (angle, turn) = (1.2, 0.3);
    for (profile, scale, right) in [
        (VALUES.to_vec(), 1.0, VALUES),
        // Mirrored by the entity's transform.
        (VALUES.to_vec(), -1.0, [VALUES[2], VALUES[1], VALUES[0]]),
        (vec![0.1, f32::NAN, 7.0], 1.0, [0.1, 0.0, 1.0]),
        // Too short a list is ignored.
        (vec![0.5], 1.0, [1.0; 3]),
    ] {
        let mut app = app();
        let image = target(&mut app, SIZE);
        camera(&mut app, &image, plain());
        let spot = SpotLight2d {
            range: 100.0,
            angle,
            softness: 0.0,
            profile: profile.clone(),
            ..default()
        };
        let transform = Transform::from_rotation(Quat::from_rotation_z(turn))
            .with_scale(Vec3::new(1.0, scale, 1.0));
        app.world_mut().spawn((spot, transform));
        let places = [-0.25f32, 0.0, 0.25].map(|part| {
            let place = 50.0 * Vec2::from_angle(turn + part * angle);
            (place.floor() + 0.5, part)
        });
        app.insert_resource(Places(places.map(|(place, _)| place)));
        app.init_resource::<Answers>().add_systems(Update, query);
        begin(&mut app);
        let seen = picture(&mut app, &image, 3);
        let answers = app.world().resource::<Answers>().0;
        for ((place, _), answer) in places.into_iter().zip(answers) {
            // Linear between the values and with the distance.
            let at = ((place.to_angle() - turn) / angle + 0.5) * 2.0;
            let (first, part) = (at.floor(), at.fract());
            let [low, high] = [first, first + 1.0].map(|i| right[(i as usize).min(2)]);
            let expected = (low + (high - low) * part) * (1.0 - place.length() / 100.0);
            let found = seen.grey((80.0 + place.x) as u32, (60.0 - place.y) as u32);
            println!("{profile:?}, {scale}: {found}, the query {answer}, not {expected}");
            assert!((found - expected).abs() < 2e-3, "{profile:?}: {found}, not {expected}");
            // A query interpolates between cells of 4 world units.
            assert!((answer - found).abs() < 0.03, "{profile:?}: the query {answer}, not {found}");
        }
    }
}

/// Places to query the light at.
#[derive(Resource)]
struct Places([Vec2; 3]);

#[derive(Resource, Default)]
struct Answers([f32; 3]);

fn query(light: LightQuery, places: Res<Places>, mut answers: ResMut<Answers>) {
    let green = |place| light.at(place).map_or(f32::NAN, |light| light.green);
    answers.0 = places.0.map(green);
}

#[test]
fn negative_lamps_take_light_away_down_to_black() {
    for method in [LightMethod::Cascades, LightMethod::Polar] {
        let light = |intensity: f32| {
            let mut app = app();
            let image = target(&mut app, SIZE);
            let lighting = Lighting2d { method, quality: LightQuality::Fast, ..plain() };
            let eye = camera(&mut app, &image, lighting);
            let ambient = AmbientLight2d { brightness: 0.0, ..default() };
            app.world_mut().entity_mut(eye).insert(ambient);
            let spot = |intensity| SpotLight2d {
                intensity,
                range: 100.0,
                angle: std::f32::consts::TAU,
                softness: 0.0,
                ..default()
            };
            app.world_mut().spawn(spot(0.5));
            // Takes twice as much of red as of green, on the right.
            let color = Color::linear_rgb(1.0, 0.5, 0.0);
            let shade = SpotLight2d { color, angle: 1.0, ..spot(intensity) };
            app.world_mut().spawn(shade);
            let places = [Vec2::new(40.5, 0.5), Vec2::new(-40.5, 0.5), Vec2::new(60.5, 0.5)];
            app.insert_resource(Places(places));
            app.init_resource::<Answers>().add_systems(Update, query);
            begin(&mut app);
            let seen = picture(&mut app, &image, 3);
            let answers = app.world().resource::<Answers>().0;
            for (place, answer) in places.into_iter().zip(answers) {
                let [_, green, _] = seen.at((80.0 + place.x) as u32, (60.0 - place.y) as u32);
                println!("{method:?}, {intensity}: the query {answer}, the picture {green}");
                assert!((answer - green).abs() < 0.02, "{method:?}: {answer}, not {green}");
            }
            [seen.at(120, 59), seen.at(39, 59)]
        };
        let [right, left] = light(0.0);
        for (intensity, red, green) in [(-0.25, 0.5, 0.75), (-1.0, 0.0, 0.0)] {
            let [taken, other] = light(intensity);
            let expected = [red * right[0], green * right[1], right[2]];
            let near = |c: usize| (taken[c] - expected[c]).abs() < 2e-3;
            assert!((0..3).all(near), "{method:?}, {intensity}: {taken:?}, not {expected:?}");
            assert_eq!(other, left, "behind the cone");
        }
    }
}

#[test]
fn a_negative_lamp_takes_what_a_positive_one_adds() {
    let mut app = app();
    let image = target(&mut app, [96, 64]);
    camera(&mut app, &image, plain());
    let light = PointLight2d { range: 200.0, ..default() };
    app.world_mut().spawn(light);
    let other = app.world_mut().spawn(PointLight2d { intensity: -0.5, ..light }).id();
    begin(&mut app);
    let taken = picture(&mut app, &image, 3);
    app.world_mut().entity_mut(other).despawn();
    let full = picture(&mut app, &image, 3);
    for (x, y) in [(20, 30), (70, 40), (48, 12)] {
        let left = taken.grey(x, y) / full.grey(x, y);
        // One is drawn on cells, and the other is not.
        assert!((left - 0.5).abs() < 0.03, "{left} is left");
    }
}

#[test]
fn walls_reflect_the_light_of_a_spot() {
    let lit = |bounces: u32| {
        let mut app = app();
        let image = target(&mut app, SIZE);
        let bounces = LightBounces::Count(bounces);
        camera(&mut app, &image, Lighting2d { bounces, ..plain() });
        let spot = SpotLight2d { range: 100.0, angle: 0.6, ..default() };
        app.world_mut().spawn((spot, Transform::default()));
        // A white wall in the beam, to the right.
        let wall = Sprite::from_color(Color::WHITE, Vec2::new(8.0, 100.0));
        app.world_mut().spawn((wall, Matter2d::wall(), Transform::from_xyz(40.0, 0.0, 0.0)));
        begin(&mut app);
        let seen = picture(&mut app, &image, 3);
        // Above the beam, and behind the lamp.
        [seen.grey(105, 25), seen.grey(50, 60)]
    };
    assert_eq!(lit(0), [0.0; 2]);
    let bounced = lit(1);
    assert!(bounced[0] > 0.02 && bounced[1] > 0.005, "{bounced:?}");
}

#[test]
fn a_sun_lights_the_open_and_walls_throw_its_shadow() {
    for method in [LightMethod::Cascades, LightMethod::Polar, LightMethod::Flood] {
        let mut app = app();
        let image = target(&mut app, SIZE);
        camera(&mut app, &image, Lighting2d { method, ..plain() });
        // Down to the right, by 45 degrees.
        let turn = Quat::from_rotation_z(-std::f32::consts::FRAC_PI_4);
        let sun =
            SunLight2d { intensity: 3.0, color: Color::linear_rgb(1.0, 0.5, 0.0), ..default() };
        app.world_mut().spawn((sun, Transform::from_rotation(turn)));
        let wall = LightOccluder2d::rectangle(20.0, 20.0);
        app.world_mut().spawn((wall, Transform::from_xyz(0.0, 20.0, 0.0)));
        begin(&mut app);
        let seen = picture(&mut app, &image, 3);
        // L·w/2π for the irradiance of 3 head on.
        let open = 3.0 / std::f32::consts::TAU;
        let [red, green, blue] = seen.at(30, 60);
        assert!((red / open - 1.0).abs() < 1e-3 && (green / red - 0.5).abs() < 1e-3, "{red}");
        assert_eq!(blue, 0.0);
        assert_eq!(seen.at(105, 65), [0.0; 3], "{method:?}: in the shadow");
    }
}

#[test]
fn ambient_light_is_everywhere_and_the_sky_comes_from_outside() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let eye = camera(&mut app, &image, plain());
    // A lid that hides the sky from everything below it.
    let lid = LightOccluder2d::rectangle(400.0, 8.0);
    app.world_mut().spawn((lid, Transform::default()));
    begin(&mut app);
    let ambient = AmbientLight2d { color: Color::linear_rgb(0.5, 1.0, 0.25), brightness: 0.4 };
    app.world_mut().entity_mut(eye).insert(ambient);
    let seen = picture(&mut app, &image, 3);
    for (x, y) in [(3, 3), (80, 60), (100, 110)] {
        let found = seen.at(x, y);
        let right = [0.2, 0.4, 0.1];
        assert!((0..3).all(|c| (found[c] - right[c]).abs() < 1e-3), "{found:?}");
    }
    app.world_mut().entity_mut(eye).remove::<AmbientLight2d>().insert(Sky2d {
        zenith: Color::linear_rgb(1.0, 1.0, 1.0),
        horizon: Color::BLACK,
        ground: Color::BLACK,
        brightness: 2.0,
    });
    let seen = picture(&mut app, &image, 2);
    let (above, below) = (seen.grey(80, 10), seen.grey(80, 110));
    assert!(above > 0.5 && below < 0.1 * above, "{above}, {below}");
}

#[test]
fn a_panorama_lights_the_side_that_it_is_bright_on() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let eye = camera(&mut app, &image, plain());
    // A wall that divides the picture.
    let wall = LightOccluder2d::rectangle(8.0, 400.0);
    app.world_mut().spawn((wall, Transform::default()));
    // Light from the left, at most 34° up or down: what passes above the wall has left the grid.
    let columns =
        (0..16).map(|k| if k == 3 || k == 4 { Color::WHITE } else { Color::BLACK }).collect();
    let sky = Panorama2d { columns, brightness: 2.0, ..Panorama2d::default() };
    app.world_mut().entity_mut(eye).insert(sky.clone());
    begin(&mut app);
    let seen = picture(&mut app, &image, 2);
    let (left, right) = (seen.grey(20, 60), seen.grey(140, 60));
    assert!(left > 0.1 && right < 0.1 * left, "{left}, {right}");
    let turned = Panorama2d { turn: std::f32::consts::PI, ..sky };
    app.world_mut().entity_mut(eye).insert(turned);
    let seen = picture(&mut app, &image, 2);
    let (left, right) = (seen.grey(20, 60), seen.grey(140, 60));
    assert!(right > 0.1 && left < 0.1 * right, "{left}, {right}");
}

#[test]
fn a_cookie_turns_flips_and_grows_with_its_lamp_and_changes_with_its_image() {
    const RED: [u8; 4] = [255, 0, 0, 255];
    const GREEN: [u8; 4] = [0, 255, 0, 255];
    const BLUE: [u8; 4] = [0, 0, 255, 255];
    const WHITE: [u8; 4] = [255; 4];
    let drawn = [RED, GREEN, BLUE, WHITE];
    let mut app = app();
    let image = target(&mut app, SIZE);
    camera(&mut app, &image, plain());
    let texel = move |x: u32, y: u32| drawn[(2 * y + x) as usize];
    let picture_of_four = crate::common::image(&mut app, [2, 2], texel);
    let cookie = LightCookie2d { image: picture_of_four.clone(), size: 40.0 };
    let light = PointLight2d { range: 100.0, ..default() };
    let lamp = app.world_mut().spawn((light, cookie)).id();
    begin(&mut app);
    // The colours at the upper left, upper right, lower left and lower right.
    let mut check = |transform: Transform, right: [[u8; 4]; 4], name: &str| {
        // The middle of a pixel.
        let transform = transform.with_translation(Vec3::new(0.5, -0.5, 0.0));
        app.world_mut().entity_mut(lamp).insert(transform);
        let seen = picture(&mut app, &image, 2);
        let away = 10.0 * transform.scale.x.abs();
        for ([dx, dy], right) in
            [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].into_iter().zip(right)
        {
            let rgb = seen.at((80.0 + away * dx) as u32, (60.0 + away * dy) as u32);
            let most = rgb.into_iter().fold(0.0, f32::max);
            println!("{name}, ({dx}, {dy}): {rgb:?}");
            let near = |c: usize| (rgb[c] / most - f32::from(right[c]) / 255.0).abs() < 5e-3;
            assert!(most > 0.1 && (0..3).all(near), "{name}, ({dx}, {dy}): {rgb:?}, not {right:?}");
        }
        // Outside the picture.
        assert_eq!(seen.at((80.0 + 3.5 * away) as u32, 60), [0.0; 3], "{name}");
    };
    let turned = Transform::from_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2));
    check(Transform::default(), [RED, GREEN, BLUE, WHITE], "as it is");
    check(turned, [GREEN, WHITE, RED, BLUE], "a quarter turn counterclockwise");
    let scaled = |x, y| Transform::from_scale(Vec3::new(x, y, 1.0));
    check(scaled(-1.0, 1.0), [GREEN, RED, WHITE, BLUE], "mirrored");
    check(scaled(1.0, -1.0), [BLUE, WHITE, RED, GREEN], "upside down");
    check(scaled(1.5, 1.5), [RED, GREEN, BLUE, WHITE], "larger");
    let data = [BLUE, BLUE, GREEN, GREEN].concat();
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    images.get_mut(&picture_of_four).unwrap().data = Some(data);
    // The change is sent at the end of a frame.
    app.update();
    let seen = picture(&mut app, &image, 2);
    let rgb = seen.at(65, 45);
    assert!(rgb[2] > 0.1 && rgb[0] < 5e-3 * rgb[2], "the changed image: {rgb:?}");
    // Dark while there is no image.
    app.world_mut().resource_mut::<Assets<Image>>().remove(&picture_of_four);
    app.update();
    assert_eq!(picture(&mut app, &image, 2).at(65, 45), [0.0; 3]);
}
