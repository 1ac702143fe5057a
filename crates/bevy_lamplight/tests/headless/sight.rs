//! Queries of sight agree with the library's on the same cells.

use crate::common::begin;
use bevy::prelude::*;
use bevy_lamplight::prelude::*;

#[derive(Resource)]
struct Places(Vec<Vec2>);

/// The visibility of each place to each viewer.
#[derive(Resource, Default)]
struct Answers(Vec<Option<f32>>);

fn query(
    sight: SightQuery,
    places: Res<Places>,
    viewers: Query<(&Viewer2d, &GlobalTransform)>,
    mut answers: ResMut<Answers>,
) {
    let all = places.0.iter().flat_map(|place| viewers.iter().map(move |viewer| (place, viewer)));
    answers.0 = all.map(|(place, (eyes, at))| sight.visibility(eyes, at, *place)).collect();
}

/// The answers about places, with a viewer at the world's origin and a wall to its right.
fn answers(viewer: Viewer2d, transform: Transform, places: &[Vec2]) -> Vec<Option<f32>> {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, LightQueryPlugin));
    app.insert_resource(Places(places.into())).init_resource::<Answers>();
    app.add_systems(Update, query);
    app.world_mut().spawn((viewer, transform));
    let wall = LightOccluder2d::rectangle(8.0, 40.0);
    app.world_mut().spawn((wall, Transform::from_xyz(40.0, 0.0, 0.0)));
    let fog = (LightOccluder2d::rectangle(20.0, 40.0), Matter2d::fog(0.05));
    app.world_mut().spawn((fog, Transform::from_xyz(-40.0, 0.0, 0.0)));
    begin(&mut app);
    app.update();
    let before = &app.world().resource::<Answers>().0;
    assert!(before.iter().all(Option::is_none), "nothing was queried before");
    app.update();
    std::mem::take(&mut app.world_mut().resource_mut::<Answers>().0)
}

#[test]
fn walls_hide_and_fog_dims() {
    let viewer = Viewer2d { range: 100.0, fade: 0.0, ..default() };
    let places = [
        Vec2::new(20.0, 0.0),
        Vec2::new(60.0, 0.0),
        Vec2::new(60.0, 50.0),
        Vec2::new(-60.0, 0.0),
        Vec2::new(0.0, 99.0),
        Vec2::new(9.0, -99.8),
        Vec2::new(37.0, 0.0),
        Vec2::splat(9e9),
    ];
    let seen = answers(viewer, Transform::default(), &places);
    println!("{seen:?}");
    assert_eq!(seen[0], Some(1.0), "in the open");
    assert_eq!(seen[1], Some(0.0), "behind the wall");
    assert_eq!(seen[2], Some(1.0), "beside the wall");
    let fog = 0.95f32.powi(20);
    assert!((seen[3].unwrap() / fog - 1.0).abs() < 0.01, "through fog: {:?}, not {fog}", seen[3]);
    assert_eq!(seen[4], Some(1.0), "within the range");
    assert_eq!(seen[5], Some(0.0), "beyond it");
    assert!(seen[6].unwrap() > 0.9, "the wall itself");
    assert_eq!(seen[7], None, "beyond the known area");
}

#[test]
fn sight_is_known_where_the_settings_of_light_are_wrong() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, LightQueryPlugin));
    let broken = Lighting2d { set: vec!["no such key".to_owned()], ..default() };
    app.insert_resource(LightQuerySettings { lighting: Some(broken), ..default() });
    app.insert_resource(Places(vec![Vec2::X])).init_resource::<Answers>();
    app.add_systems(Update, (query, |light: LightQuery| assert_eq!(light.at(Vec2::X), None)));
    app.world_mut().spawn((Viewer2d::default(), Transform::default()));
    begin(&mut app);
    (0..3).for_each(|_| app.update());
    assert_eq!(app.world().resource::<Answers>().0, [Some(1.0)]);
}

#[test]
fn viewers_look_along_their_x_axis_within_their_angle() {
    // Straight up, over a quarter turn.
    let turn = Transform::from_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2));
    let angle = std::f32::consts::FRAC_PI_2;
    let viewer = Viewer2d { range: 100.0, fade: 0.5, angle, softness: 0.0, ..default() };
    let places = [Vec2::Y, Vec2::NEG_Y, Vec2::X, Vec2::NEG_X].map(|place| 20.0 * place);
    let seen = answers(viewer, turn, &places);
    assert_eq!(seen, [1.0, 0.0, 0.0, 0.0].map(Some));
    // Halfway through the part of the range in which sight fades.
    let seen = answers(viewer, turn, &[Vec2::new(0.0, 75.0)]);
    assert!((seen[0].unwrap() - 0.5).abs() < 1e-3, "{seen:?}");
    // Two edges of the cone.
    let edges = [0.6f32, 0.95].map(|part| Vec2::from_angle(angle + 0.5 * part * angle) * 30.0);
    let soft = Viewer2d { softness: 0.2, ..viewer };
    let seen = answers(soft, turn, &edges);
    assert!(seen[0] == Some(1.0) && (0.01..0.99).contains(&seen[1].unwrap()), "{seen:?}");
    for off in [
        Viewer2d { range: 0.0, ..viewer },
        Viewer2d { angle: -1.0, ..viewer },
        Viewer2d { range: f32::NAN, ..viewer },
        Viewer2d { angle: f32::NAN, ..viewer },
        Viewer2d { fade: f32::NAN, ..viewer },
    ] {
        assert_eq!(answers(off, turn, &places[..1]), [Some(0.0)], "{off:?}");
    }
}
