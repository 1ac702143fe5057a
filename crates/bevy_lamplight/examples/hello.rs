//! Lit in one line: `cargo run --release -p bevy_lamplight --example hello`.

use bevy::prelude::*;
use bevy_lamplight::prelude::*;

fn main() {
    App::new().add_plugins((DefaultPlugins, example)).run();
}

/// The example as a plugin.
pub fn example(app: &mut App) {
    app.add_plugins(LamplightPlugin)
        .insert_resource(ClearColor(Color::srgb(0.55, 0.5, 0.45)))
        .add_systems(Startup, setup);
}

fn setup(mut commands: Commands) {
    commands.spawn((Camera2d, Lighting2d::default()));

    let warm = Color::srgb(1.0, 0.75, 0.4);
    let lamp = PointLight2d { color: warm, intensity: 2.5, range: 150.0, ..default() };
    commands.spawn((lamp, Transform::from_xyz(-180.0, 60.0, 0.0)));

    let neon = Sprite::from_color(Color::srgb(0.3, 0.5, 1.0), Vec2::new(120.0, 8.0));
    commands.spawn((neon, Matter2d::glow(12.0), Transform::from_xyz(170.0, 120.0, 0.0)));

    let wall = Sprite::from_color(Color::srgb(0.8, 0.35, 0.3), Vec2::new(50.0, 90.0));
    commands.spawn((wall, Matter2d::wall(), Transform::from_xyz(0.0, -20.0, 0.0)));
}
