//! Two players and two cameras with different light settings:
//! `cargo run --release -p bevy_lamplight --example split_screen`.

use bevy::camera::{CameraUpdateSystems, ScalingMode, Viewport};
use bevy::prelude::*;
use bevy_lamplight::prelude::*;

fn main() {
    App::new().add_plugins((DefaultPlugins, example)).run();
}

/// The example as a plugin.
pub fn example(app: &mut App) {
    app.add_plugins(LamplightPlugin)
        .insert_resource(ClearColor(Color::srgb(0.45, 0.5, 0.5)))
        .add_systems(Startup, setup)
        .add_systems(Update, walk)
        .add_systems(PostUpdate, share_the_screen.before(CameraUpdateSystems));
}

/// The index of a player, a camera and their half of the screen.
#[derive(Component)]
struct Half(u32);

fn setup(mut commands: Commands) {
    let lightings = [
        (Lighting2d::default(), AmbientLight2d { brightness: 0.03, ..default() }),
        // The other player has night vision with large pixels.
        (
            Lighting2d {
                cells: CellSize::World(4.0),
                filter: LightFilter::Nearest,
                exposure: 1.0,
                ..default()
            },
            AmbientLight2d { color: Color::srgb(0.3, 1.0, 0.4), brightness: 0.12 },
        ),
    ];
    let lamps = [Color::srgb(1.0, 0.7, 0.35), Color::srgb(0.5, 0.7, 1.0)];
    for (number, lighting) in (0..).zip(lightings) {
        let player = commands
            .spawn((
                Sprite::from_color(lamps[number as usize], Vec2::splat(10.0)),
                PointLight2d { color: lamps[number as usize], range: 160.0, ..default() },
                Half(number),
                Transform::default(),
            ))
            .id();
        let clear_color = match number {
            0 => ClearColorConfig::Default,
            _ => ClearColorConfig::None,
        };
        let camera = commands
            .spawn((
                Camera2d,
                Camera { order: number as isize, clear_color, ..default() },
                Projection::Orthographic(OrthographicProjection {
                    scaling_mode: ScalingMode::FixedVertical { viewport_height: 360.0 },
                    ..OrthographicProjection::default_2d()
                }),
                lighting,
                Half(number),
            ))
            .id();
        commands.entity(player).add_child(camera);
    }
    for i in 0..48 {
        let (x, y) = ((i % 8) as f32, (i / 8) as f32);
        let place = Vec2::new(x * 90.0 - 315.0, y * 80.0 - 200.0 + 30.0 * (x * 1.7).sin());
        let color = Color::hsl(40.0 * x + 15.0 * y, 0.4, 0.6);
        let block = Sprite::from_color(color, Vec2::new(26.0, 18.0 + 5.0 * (i % 4) as f32));
        commands.spawn((block, Matter2d::wall(), Transform::from_translation(place.extend(1.0))));
    }
}

fn walk(time: Res<Time>, mut players: Query<(&Half, &mut Transform), With<PointLight2d>>) {
    for (half, mut transform) in &mut players {
        let angle = 0.3 * time.elapsed_secs() + 2.6 * half.0 as f32 + 0.4;
        let (sin, cos) = angle.sin_cos();
        transform.translation = Vec3::new(200.0 * cos, 110.0 * sin, 2.0);
    }
}

/// Gives each camera its half of the render target.
fn share_the_screen(mut cameras: Query<(&Half, &mut Camera)>) {
    for (half, mut camera) in &mut cameras {
        let Some(size) = camera.physical_target_size() else { continue };
        let width = (size.x / 2).max(1);
        let viewport = Viewport {
            physical_position: UVec2::new(half.0 * width, 0),
            physical_size: UVec2::new(width, size.y.max(1)),
            ..default()
        };
        let is_same = camera.viewport.as_ref().is_some_and(|old| {
            old.physical_size == viewport.physical_size
                && old.physical_position == viewport.physical_position
        });
        if !is_same {
            camera.viewport = Some(viewport);
        }
    }
}
