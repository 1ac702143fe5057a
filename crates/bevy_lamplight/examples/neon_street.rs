//! A wet street at night, lit by its signs, in HDR and with bloom:
//! `cargo run --release -p bevy_lamplight --example neon_street`.

use bevy::camera::ScalingMode;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::post_process::bloom::Bloom;
use bevy::prelude::*;
use bevy_lamplight::prelude::*;

fn main() {
    App::new().add_plugins((DefaultPlugins, example)).run();
}

/// The example as a plugin.
pub fn example(app: &mut App) {
    app.add_plugins(LamplightPlugin)
        .insert_resource(ClearColor(Color::srgb(0.4, 0.42, 0.5)))
        .add_systems(Startup, setup)
        .add_systems(Update, (flicker, drive));
}

/// A sign that flickers.
#[derive(Component)]
struct Flicker;

#[derive(Component)]
struct Car;

fn setup(mut commands: Commands) {
    commands.spawn((
        Camera2d,
        Projection::Orthographic(OrthographicProjection {
            scaling_mode: ScalingMode::FixedVertical { viewport_height: 360.0 },
            ..OrthographicProjection::default_2d()
        }),
        Lighting2d { bounces: LightBounces::Count(2), wall_depth: 24.0, ..default() },
        AmbientLight2d { color: Color::srgb(0.4, 0.5, 1.0), brightness: 0.02 },
        Sky2d {
            zenith: Color::linear_rgb(0.010, 0.016, 0.05),
            horizon: Color::linear_rgb(0.03, 0.02, 0.05),
            ground: Color::BLACK,
            brightness: 1.0,
        },
        Bloom::NATURAL,
        Tonemapping::AcesFitted,
    ));
    let block = |color, x: f32, y: f32, width: f32, height: f32, z: f32| {
        let sprite = Sprite::from_color(color, Vec2::new(width, height));
        (sprite, Transform::from_xyz(x, y, z))
    };
    // The street, which reflects much of the light.
    let wet = Matter2d { albedo: LinearRgba::rgb(0.95, 0.95, 0.95), ..Matter2d::wall() };
    commands.spawn((block(Color::srgb(0.5, 0.5, 0.55), 0.0, -160.0, 1400.0, 60.0, 1.0), wet));
    // Lit facades and their windows.
    for (i, (x, width, height)) in [
        (-262.0, 116.0, 190.0),
        (-140.0, 104.0, 130.0),
        (-8.0, 130.0, 230.0),
        (130.0, 120.0, 150.0),
        (262.0, 116.0, 250.0),
    ]
    .into_iter()
    .enumerate()
    {
        let brick = Color::srgb(0.62 - 0.06 * i as f32, 0.45, 0.4 + 0.06 * i as f32);
        let y = -130.0 + 0.5 * height;
        commands.spawn(block(brick, x, y, width, height, 0.0));
        for n in 0..9 {
            let (column, row) = ((n % 3) as f32 - 1.0, (n / 3) as f32);
            let at = (x + column * 0.3 * width, y + 0.5 * height - 20.0 - row * 34.0);
            let window = |color| block(color, at.0, at.1, 14.0, 18.0, 2.0);
            if (n * 7 + i * 5) % 4 == 0 && row < 2.0 {
                commands.spawn((window(Color::srgb(1.0, 0.8, 0.5)), Matter2d::glow(1.6)));
            } else {
                commands.spawn(window(Color::srgb(0.12, 0.13, 0.18)));
            }
        }
    }
    // Awnings that cast shadows.
    for x in [-200.0, 190.0] {
        commands
            .spawn((block(Color::srgb(0.5, 0.2, 0.2), x, -70.0, 50.0, 5.0, 3.0), Matter2d::wall()));
    }
    // Signs: texts and sprites that emit their own colours.
    for (text, size, color, x, y, strength) in [
        ("NOODLES", 36.0, Color::srgb(1.0, 0.15, 0.45), -8.0, -15.0, 5.0),
        ("open all night", 20.0, Color::srgb(0.2, 0.9, 1.0), -8.0, -50.0, 4.0),
        ("HOTEL", 30.0, Color::srgb(0.4, 1.0, 0.35), 262.0, 140.0, 4.0),
    ] {
        let sign = (Text2d::new(text), TextFont::from_font_size(size), TextColor(color));
        let glow = Matter2d { opacity: 0.6, ..Matter2d::glow(strength) };
        let mut sign = commands.spawn((sign, glow, Transform::from_xyz(x, y, 3.0)));
        if text == "HOTEL" {
            sign.insert(Flicker);
        }
    }
    let tube =
        |color, x, y, width, height| (block(color, x, y, width, height, 3.0), Matter2d::glow(6.0));
    commands.spawn(tube(Color::srgb(1.0, 0.55, 0.1), -80.0, -70.0, 3.0, 90.0));
    commands.spawn(tube(Color::srgb(0.45, 0.3, 1.0), 64.0, -40.0, 3.0, 120.0));
    // A car with a headlight.
    let car = block(Color::srgb(0.6, 0.1, 0.12), 0.0, -122.0, 56.0, 14.0, 4.0);
    let lamp = SpotLight2d {
        color: Color::srgb(1.0, 0.95, 0.8),
        intensity: 3.0,
        range: 240.0,
        angle: 0.5,
        ..default()
    };
    commands
        .spawn((car, Matter2d::wall(), Car))
        .with_child((lamp, Transform::from_xyz(30.0, 0.0, 0.0)));
    // Steam over a drain.
    let steam = Sprite::from_color(Color::srgba(1.0, 1.0, 1.0, 0.5), Vec2::new(40.0, 110.0));
    commands.spawn((steam, Matter2d::fog(0.01), Transform::from_xyz(110.0, -75.0, 5.0)));
}

fn flicker(time: Res<Time>, mut signs: Query<&mut Matter2d, With<Flicker>>) {
    let beat = (time.elapsed_secs() * 9.0) as u32;
    let is_out = matches!(beat % 23, 5 | 7 | 8);
    for mut matter in &mut signs {
        *matter = Matter2d { opacity: 0.6, ..Matter2d::glow(if is_out { 0.2 } else { 5.0 }) };
    }
}

fn drive(time: Res<Time>, mut car: Single<&mut Transform, With<Car>>) {
    car.translation.x = (60.0 * time.elapsed_secs() + 260.0).rem_euclid(900.0) - 450.0;
}
