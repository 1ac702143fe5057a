//! Any number of lamps that drift between pillars, with frame times:
//! `cargo run --release -p bevy_lamplight --example many_lights -- 5000`.

use bevy::diagnostic::{FrameTimeDiagnosticsPlugin, LogDiagnosticsPlugin};
use bevy::prelude::*;
use bevy_lamplight::prelude::*;
use std::f32::consts::TAU;

fn main() -> AppExit {
    let mut lamps = LampCount::default();
    if let Some(text) = std::env::args().nth(1) {
        let Ok(count) = text.parse() else {
            eprintln!("error: the number of lamps is {text}, but must be a whole number");
            return AppExit::error();
        };
        lamps = LampCount(count);
    }
    App::new()
        .insert_resource(lamps)
        .add_plugins((DefaultPlugins, example))
        .add_plugins((FrameTimeDiagnosticsPlugin::default(), LogDiagnosticsPlugin::default()))
        .run()
}

/// The example as a plugin.
pub fn example(app: &mut App) {
    app.add_plugins(LamplightPlugin)
        .init_resource::<LampCount>()
        .insert_resource(ClearColor(Color::srgb(0.5, 0.5, 0.55)))
        .add_systems(Startup, setup)
        .add_systems(Update, drift);
}

/// The number of lamps.
#[derive(Resource)]
struct LampCount(u32);

impl Default for LampCount {
    fn default() -> Self {
        Self(500)
    }
}

/// Half of the area that lamps drift in.
const REACH: Vec2 = Vec2::new(310.0, 170.0);

/// The orbit of a lamp.
#[derive(Component)]
struct Drift {
    middle: Vec2,
    radius: f32,
    speed: f32,
    phase: f32,
}

/// Pseudorandom numbers from 0 to 1, the same in every run.
fn random() -> impl FnMut() -> f32 {
    let mut state = 12345u32;
    move || {
        state = state.wrapping_mul(747796405).wrapping_add(2891336453);
        (state >> 8) as f32 / (1 << 24) as f32
    }
}

fn setup(mut commands: Commands, lamps: Res<LampCount>) {
    commands.spawn((
        Camera2d,
        Lighting2d { cells: CellSize::World(2.0), ..default() },
        AmbientLight2d { brightness: 0.02, ..default() },
    ));
    let mut random = random();
    for _ in 0..lamps.0 {
        let lamp = PointLight2d {
            color: Color::hsl(360.0 * random(), 0.9, 0.6),
            // The total light does not depend on the number of lamps.
            intensity: 12.0 / lamps.0 as f32,
            range: 100.0,
            radius: 3.0,
            ..default()
        };
        let drift = Drift {
            middle: REACH * (2.0 * Vec2::new(random(), random()) - 1.0),
            radius: 40.0 * random(),
            speed: 2.0 * random() - 1.0,
            phase: TAU * random(),
        };
        commands.spawn((lamp, drift));
    }
    for i in 0..60 {
        let place = Vec2::new((i % 10) as f32 - 4.5, (i / 10) as f32 - 2.5) * Vec2::new(62.0, 58.0);
        let pillar = Sprite::from_color(Color::srgb(0.6, 0.55, 0.5), Vec2::splat(12.0));
        commands.spawn((pillar, Matter2d::wall(), Transform::from_translation(place.extend(1.0))));
    }
}

fn drift(time: Res<Time>, mut lamps: Query<(&Drift, &mut Transform)>) {
    for (drift, mut transform) in &mut lamps {
        let angle = drift.phase + drift.speed * time.elapsed_secs();
        let place = drift.middle + drift.radius * Vec2::from_angle(angle);
        transform.translation = place.extend(0.0);
    }
}
