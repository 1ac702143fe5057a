//! Stay in the shadows: the lamps of guards sweep a yard, and a light query decides whether they see
//! you. The arrow keys move: `cargo run --release -p bevy_lamplight --example stealth`.

use bevy::camera::ScalingMode;
use bevy::prelude::*;
use bevy_lamplight::prelude::*;

fn main() {
    App::new().add_plugins((DefaultPlugins, example)).run();
}

/// The example as a plugin.
pub fn example(app: &mut App) {
    app.add_plugins(LamplightPlugin)
        .insert_resource(ClearColor(Color::srgb(0.42, 0.48, 0.4)))
        .add_systems(Startup, setup)
        .add_systems(Update, (walk, sweep, update_verdict).chain());
}

#[derive(Component)]
struct Thief;

/// Turns back and forth.
#[derive(Component)]
struct Guard {
    towards: f32,
    speed: f32,
}

#[derive(Component)]
struct Verdict;

fn setup(mut commands: Commands) {
    commands.spawn((
        Camera2d,
        Projection::Orthographic(OrthographicProjection {
            scaling_mode: ScalingMode::FixedVertical { viewport_height: 360.0 },
            ..OrthographicProjection::default_2d()
        }),
        Lighting2d::default(),
        AmbientLight2d { color: Color::srgb(0.5, 0.6, 1.0), brightness: 0.2 },
    ));
    for (x, y, width, height) in [
        (-120.0, 60.0, 60.0, 60.0),
        (-40.0, -90.0, 110.0, 30.0),
        (90.0, 40.0, 30.0, 130.0),
        (190.0, -80.0, 70.0, 40.0),
        (-230.0, -60.0, 40.0, 80.0),
        (0.0, 150.0, 80.0, 30.0),
    ] {
        let crate_ = Sprite::from_color(Color::srgb(0.55, 0.4, 0.25), Vec2::new(width, height));
        commands.spawn((crate_, Matter2d::wall(), Transform::from_xyz(x, y, 1.0)));
    }
    let lamp = SpotLight2d {
        color: Color::srgb(1.0, 0.9, 0.6),
        intensity: 2.0,
        range: 330.0,
        angle: 0.7,
        softness: 0.4,
        ..default()
    };
    for (x, y, towards, speed) in
        [(-290.0, 150.0, -0.6, 0.5), (290.0, -160.0, 2.6, 0.4), (40.0, -20.0, 2.2, 0.7)]
    {
        let guard = Sprite::from_color(Color::srgb(0.9, 0.3, 0.25), Vec2::splat(10.0));
        let place = Transform::from_xyz(x, y, 2.0).with_rotation(Quat::from_rotation_z(towards));
        commands.spawn((guard, lamp.clone(), Guard { towards, speed }, place));
    }
    let thief = Sprite::from_color(Color::srgb(0.35, 0.85, 1.0), Vec2::splat(12.0));
    commands.spawn((thief, Thief, Transform::from_xyz(-60.0, 0.0, 2.0)));
    let text = (Text2d::new(""), TextFont::from_font_size(18.0));
    commands.spawn((text, Verdict, Unlit2d, Transform::from_xyz(0.0, -165.0, 9.0)));
}

fn walk(
    time: Res<Time>,
    keys: Option<Res<ButtonInput<KeyCode>>>,
    mut thief: Single<&mut Transform, With<Thief>>,
) {
    let Some(keys) = keys else { return };
    let along = |more, less| f32::from(keys.pressed(more)) - f32::from(keys.pressed(less));
    let direction = Vec2::new(
        along(KeyCode::ArrowRight, KeyCode::ArrowLeft),
        along(KeyCode::ArrowUp, KeyCode::ArrowDown),
    );
    thief.translation += (120.0 * time.delta_secs() * direction.normalize_or_zero()).extend(0.0);
}

fn sweep(time: Res<Time>, mut guards: Query<(&Guard, &mut Transform)>) {
    for (guard, mut transform) in &mut guards {
        let turned = guard.towards + 0.6 * (guard.speed * time.elapsed_secs()).sin();
        transform.rotation = Quat::from_rotation_z(turned);
    }
}

/// The luminance above which guards see somebody.
const VISIBLE: f32 = 0.25;

fn update_verdict(
    light: LightQuery,
    thief: Single<&GlobalTransform, With<Thief>>,
    verdict: Single<(&mut Text2d, &mut TextColor), With<Verdict>>,
) {
    let around = Rect::from_center_half_size(thief.translation().truncate(), Vec2::splat(6.0));
    let Some(level) = light.over(around).map(|light| light.luminance()) else { return };
    let (mut text, mut color) = verdict.into_inner();
    let word = if level > VISIBLE { "seen" } else { "hidden" };
    text.0 = format!("{word}: light {level:.2}");
    color.0 =
        if level > VISIBLE { Color::srgb(1.0, 0.35, 0.3) } else { Color::srgb(0.5, 1.0, 0.6) };
}
