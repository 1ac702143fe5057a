//! Light queries agree with the picture.

use crate::common::{app, begin, camera, picture, plain, target};
use bevy::prelude::*;
use bevy_lamplight::prelude::*;

const SIZE: [u32; 2] = [320, 200];
/// The README's bound on the median relative error. Where there is hardly any light, errors are relative
/// to a quarter of the mean.
const MEDIAN: f32 = 0.08;
/// The README's bound on the 95th percentile.
const PERCENTILE_95: f32 = 0.3;

#[derive(Resource)]
struct Places(Vec<Vec2>);

#[derive(Resource, Default)]
struct Answers(Vec<Option<LinearRgba>>, Option<f32>, Option<LinearRgba>);

fn query(light: LightQuery, places: Res<Places>, mut answers: ResMut<Answers>) {
    answers.0 = places.0.iter().map(|&place| light.at(place)).collect();
    answers.1 = light.level(places.0[0]);
    answers.2 = light.over(Rect::from_center_half_size(places.0[0], Vec2::splat(6.0)));
    // Corners may be in any order, and a box of size 0 is a place.
    let turned = Rect { min: places.0[0] + 6.0, max: places.0[0] - 6.0 };
    assert_eq!(light.over(turned), answers.2);
    assert_eq!(light.over(Rect { min: places.0[0], max: places.0[0] }), answers.0[0]);
}

/// A yard with walls, a glowing sign, lamps and a spot.
fn yard(world: &mut World) {
    let wall = |x, y, width, height| {
        let sprite = Sprite::from_color(Color::WHITE, Vec2::new(width, height));
        (sprite, Matter2d::wall(), Transform::from_xyz(x, y, 0.0))
    };
    world.spawn(wall(-60.0, 20.0, 6.0, 90.0));
    world.spawn(wall(40.0, -30.0, 80.0, 12.0));
    world.spawn((LightOccluder2d::circle(14.0), Transform::from_xyz(70.0, 50.0, 0.0)));
    let sign = Sprite::from_color(Color::linear_rgb(1.0, 0.2, 0.4), Vec2::new(40.0, 8.0));
    world.spawn((sign, Matter2d::glow(6.0), Transform::from_xyz(-10.0, 80.0, 0.0)));
    world.spawn((
        PointLight2d { range: 200.0, ..default() },
        Transform::from_xyz(-110.0, -40.0, 0.0),
    ));
    let turn = Quat::from_rotation_z(-0.4);
    world.spawn((SpotLight2d::default(), Transform::from_xyz(0.0, 20.0, 0.0).with_rotation(turn)));
}

fn places() -> Vec<Vec2> {
    let all =
        (-9..=9).flat_map(|x| (-5..=5).map(move |y| Vec2::new(x as f32, y as f32) * 16.0 + 3.0));
    let at_right = (-5..=5).map(|y| Vec2::new(157.0, y as f32 * 16.0 + 3.0));
    let at_bottom = (-9..=9).map(|x| Vec2::new(x as f32 * 16.0 + 3.0, -97.0));
    let all = all.chain(at_right).chain(at_bottom);
    // Places near matter are left out, because there the light depends on the exact position of edges.
    let boxes = [
        (-60.0, 20.0, 6.0, 90.0),
        (40.0, -30.0, 80.0, 12.0),
        (70.0, 50.0, 28.0, 28.0),
        (-10.0, 80.0, 40.0, 8.0),
        (-110.0, -40.0, 8.0, 8.0),
        (0.0, 20.0, 8.0, 8.0),
    ];
    all.filter(|place| {
        boxes.iter().all(|&(x, y, width, height)| {
            let off = (*place - Vec2::new(x, y)).abs() - 0.5 * Vec2::new(width, height);
            off.max_element() > 10.0
        })
    })
    .collect()
}

/// Median and 95th percentile of the errors of answers in a yard, against its picture; with lamps beyond the grid and on its
/// border if surroundings are lit.
fn errors_in_a_yard(surroundings: u32) -> [f32; 2] {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let lighting = Lighting2d {
        surroundings,
        cells: CellSize::World(2.0),
        filter: LightFilter::Linear,
        bounces: LightBounces::Count(1),
        method: LightMethod::Holographic,
        ..plain()
    };
    let eye = camera(&mut app, &image, lighting);
    app.world_mut().entity_mut(eye).insert(AmbientLight2d { brightness: 0.02, ..default() });
    yard(app.world_mut());
    if surroundings > 0 {
        // Beyond a side, on the border, beyond a side and a corner.
        for place in [[-260.0, 60.0], [178.0, -70.0], [90.0, 240.0], [300.0, -180.0]] {
            let lamp = PointLight2d { range: 300.0, ..default() };
            app.world_mut().spawn((lamp, Transform::from_xyz(place[0], place[1], 0.0)));
        }
    }
    app.insert_resource(Places(places())).init_resource::<Answers>().add_systems(Update, query);
    begin(&mut app);
    let seen = picture(&mut app, &image, 3);
    let answers = std::mem::take(&mut *app.world_mut().resource_mut::<Answers>());
    let grey = |x: u32, y: u32| seen.grey(x, y);
    let usual = (0..SIZE[1])
        .flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)))
        .map(|(x, y)| grey(x, y))
        .sum::<f32>()
        / (SIZE[0] * SIZE[1]) as f32;
    let mut off: Vec<f32> = places()
        .iter()
        .zip(&answers.0)
        .map(|(place, answer)| {
            let answer = answer.expect("the place is on the screen");
            let answer = (answer.red + answer.green + answer.blue) / 3.0;
            let right = grey((place.x + 160.0) as u32, (100.0 - place.y) as u32);
            (answer - right).abs() / right.max(0.25 * usual)
        })
        .collect();
    off.sort_by(f32::total_cmp);
    let (median, high) = (off[off.len() / 2], off[off.len() * 19 / 20]);
    println!(
        "{} places: median {:.1} %, 95th percentile {:.1} %",
        off.len(),
        100.0 * median,
        100.0 * high
    );
    let first = answers.0[0].expect("known");
    assert!((answers.1.expect("known") - first.luminance()).abs() < 1e-6);
    assert!((answers.2.expect("known").green / first.green - 1.0).abs() < 0.2);
    [median, high]
}

#[test]
fn answers_agree_with_the_picture() {
    let [median, high] = errors_in_a_yard(0);
    assert!(median < MEDIAN && high < PERCENTILE_95, "{median}, {high}");
}

#[test]
fn answers_have_light_from_off_screen() {
    let [median, high] = errors_in_a_yard(3);
    assert!(median < MEDIAN && high < PERCENTILE_95, "{median}, {high}");
}

#[test]
fn queries_work_on_a_server_without_a_gpu() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, LightQueryPlugin));
    app.insert_resource(Places(vec![
        Vec2::new(32.0, 0.0),
        Vec2::new(-32.0, 0.0),
        Vec2::splat(9e9),
    ]));
    app.init_resource::<Answers>().add_systems(Update, query);
    app.world_mut().spawn(PointLight2d::default());
    app.world_mut().spawn((
        // Black, so that it does not reflect.
        Sprite::from_color(Color::BLACK, Vec2::new(8.0, 40.0)),
        Matter2d::wall(),
        Transform::from_xyz(-16.0, 0.0, 0.0),
    ));
    begin(&mut app);
    app.update();
    assert!(app.world().resource::<Answers>().0[0].is_none(), "nothing was queried before");
    app.update();
    let answers = app.world().resource::<Answers>();
    let level = answers.0[0].expect("within the lamp's range").green;
    // The lamp's formula: its intensity at a quarter of its range, within the error of a coarse grid.
    assert!((level - 1.0).abs() < 0.15, "{level}");
    assert!(answers.0[1].expect("within it too").green < 0.1, "behind the wall");
    assert!(answers.0[2].is_none(), "far away");
}

#[test]
fn queries_answer_for_the_camera_of_the_lowest_order() {
    let mut app = app();
    app.insert_resource(Places(vec![Vec2::ZERO])).init_resource::<Answers>();
    app.add_systems(Update, query);
    let seen = [0.5, 0.25].map(|brightness| {
        let image = target(&mut app, [32, 32]);
        let entity = camera(&mut app, &image, plain());
        app.world_mut().entity_mut(entity).insert(AmbientLight2d { brightness, ..default() });
        (entity, brightness)
    });
    begin(&mut app);
    for (first, second) in [(0, 1), (1, 0)] {
        for (order, number) in [first, second].into_iter().enumerate() {
            let mut camera = app.world_mut().entity_mut(seen[number].0);
            camera.get_mut::<Camera>().unwrap().order = order as isize;
        }
        (0..3).for_each(|_| app.update());
        let found = app.world().resource::<Answers>().0[0].expect("both see it");
        assert!((found.green - seen[first].1).abs() < 1e-3, "{found:?}");
    }
}

#[test]
fn an_empty_scene_has_no_answer() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, LightQueryPlugin));
    app.insert_resource(Places(vec![Vec2::ZERO]))
        .init_resource::<Answers>()
        .add_systems(Update, query);
    for settings in [
        LightQuerySettings::default(),
        LightQuerySettings {
            cell: f32::NAN,
            area: Some(Rect::new(0.0, 0.0, 9.0, 9.0)),
            ..default()
        },
    ] {
        app.insert_resource(settings);
        (0..3).for_each(|_| app.update());
        assert!(app.world().resource::<Answers>().0[0].is_none());
    }
    // An empty area is dark.
    let area = Some(Rect::new(-10.0, -10.0, 10.0, 10.0));
    app.insert_resource(LightQuerySettings { area, ..default() });
    (0..3).for_each(|_| app.update());
    assert_eq!(app.world().resource::<Answers>().0[0], Some(LinearRgba::BLACK));
}
