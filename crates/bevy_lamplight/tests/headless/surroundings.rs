//! Light from off the screen.

use crate::common::{Picture, app, begin, camera, image, picture, plain, target};
use bevy::prelude::*;
use bevy_lamplight::prelude::*;

const SIZE: [u32; 2] = [96, 64];
/// The largest jump of light in a frame while a lamp drifts in, relative to the mean light of the picture. Measured at
/// 0.008.
const JUMP: f32 = 0.01;

/// Settings with rings around a grid with a border of 32 cells.
fn with_rings(method: LightMethod, surroundings: u32) -> Lighting2d {
    let set = match method {
        LightMethod::Raymarch => vec!["raymarch.rays=256".to_owned()],
        _ => Vec::new(),
    };
    Lighting2d { method, set, surroundings, border: 32.0, ..plain() }
}

fn mean(picture: &Picture) -> f32 {
    let grey = |texel: &[f32; 4]| (texel[0] + texel[1] + texel[2]) / 3.0;
    picture.texels.iter().map(grey).sum::<f32>() / picture.texels.len() as f32
}

/// Greys of a picture at some places.
fn at<const N: usize>(picture: &Picture, places: [[u32; 2]; N]) -> [f32; N] {
    places.map(|[x, y]| picture.grey(x, y))
}

#[test]
fn lamps_and_glowing_matter_off_screen_light_it_and_walls_between_shade_it() {
    for method in [LightMethod::Cascades, LightMethod::Holographic, LightMethod::Raymarch] {
        let mut app = app();
        let image = target(&mut app, SIZE);
        let eye = camera(&mut app, &image, with_rings(method, 0));
        let lamp = app
            .world_mut()
            .spawn((PointLight2d::default(), Transform::from_xyz(300.0, 0.0, 0.0)))
            .id();
        begin(&mut app);
        let places = [[86, 32], [10, 32]];
        let alone = at(&picture(&mut app, &image, 2), places);
        assert_eq!(alone, [0.0; 2], "{method:?}");
        app.world_mut().entity_mut(eye).insert(with_rings(method, 3));
        let lit = at(&picture(&mut app, &image, 2), places);
        for (found, [x, _]) in lit.into_iter().zip(places) {
            // The lamp's own rule.
            let expected = 128.0 / (4.0 * (348.0 - (x as f32 + 0.5)));
            println!("{method:?}, {x}: {found:.4}, not {expected:.4}");
            assert!((found / expected - 1.0).abs() < 0.06, "{method:?}: {found}, not {expected}");
        }
        // A wall between them, off screen.
        let wall = LightOccluder2d::rectangle(8.0, 400.0);
        let wall = app.world_mut().spawn((wall, Transform::from_xyz(200.0, 0.0, 0.0))).id();
        let shaded = at(&picture(&mut app, &image, 2), places);
        println!("{method:?}: shaded {shaded:?}");
        assert!((0..2).all(|i| shaded[i] < 0.01 * lit[i]), "{method:?}: {shaded:?}");
        // It shades what is behind it.
        app.world_mut().entity_mut(wall).insert(Transform::from_xyz(400.0, 0.0, 0.0));
        let again = at(&picture(&mut app, &image, 2), places);
        assert!((0..2).all(|i| (again[i] / lit[i] - 1.0).abs() < 1e-3), "{method:?}: {again:?}");
        app.world_mut().entity_mut(lamp).despawn();
        let dark = at(&picture(&mut app, &image, 2), places);
        assert_eq!(dark, [0.0; 2], "{method:?}");
        // A sprite of 40 units that glows: the fraction of all directions that it fills.
        let sprite = Sprite::from_color(Color::WHITE, Vec2::splat(40.0));
        app.world_mut().spawn((sprite, Matter2d::glow(4.0), Transform::from_xyz(220.0, 0.0, 0.0)));
        let lit = at(&picture(&mut app, &image, 2), places);
        for (found, [x, _]) in lit.into_iter().zip(places) {
            let distance = 248.0 - (x as f32 + 0.5);
            let expected = 4.0 * 2.0 * (20.0 / distance).atan() / std::f32::consts::TAU;
            println!("{method:?}, {x}: {found:.4}, not {expected:.4}");
            assert!((found / expected - 1.0).abs() < 0.25, "{method:?}: {found}, not {expected}");
        }
    }
}

#[test]
fn a_gpu_has_the_light_of_the_cpu_from_off_screen() {
    let lit = |backend: LightBackend| {
        let mut app = app();
        let image = target(&mut app, SIZE);
        app.insert_resource(backend);
        camera(&mut app, &image, with_rings(LightMethod::Cascades, 2));
        // One beyond the grid, and one on its border.
        for x in [180.0, 92.0] {
            app.world_mut().spawn((PointLight2d::default(), Transform::from_xyz(x, 9.0, 0.0)));
        }
        begin(&mut app);
        at(&picture(&mut app, &image, 3), [[86, 32], [48, 10], [10, 32]])
    };
    let [gpu, cpu] = [LightBackend::Gpu, LightBackend::Cpu].map(lit);
    println!("{gpu:?}, {cpu:?}");
    assert!((0..3).all(|i| cpu[i] > 0.1 && (gpu[i] / cpu[i] - 1.0).abs() < 5e-3));
}

#[test]
fn a_camera_that_glides_sees_what_a_new_one_sees_in_its_place() {
    /// Cells that it glides each frame.
    const STEP: f32 = 7.0;
    let app = |frames: u32| {
        let mut app = app();
        let image = target(&mut app, SIZE);
        let eye = camera(&mut app, &image, with_rings(LightMethod::Holographic, 3));
        for i in 0..120u8 {
            // Evenly all around.
            let [x, y] = [0.7549, 0.5698].map(|s: f32| 900.0 * ((s * f32::from(i)).fract() - 0.5));
            let wall = LightOccluder2d::rectangle(f32::from(i % 5 + 1) * 8.0, 9.0);
            let at = Transform::from_xyz(x, y, 0.0);
            if i % 4 == 0 {
                app.world_mut().spawn((wall, Matter2d::glow(3.0), at));
            } else {
                app.world_mut().spawn((wall, at));
            }
        }
        begin(&mut app);
        let glide = |app: &mut App, frame: u32| {
            let at = Transform::from_xyz(STEP * frame as f32, 0.0, 0.0);
            app.world_mut().entity_mut(eye).insert(at);
            app.update();
        };
        (0..frames).for_each(|frame| glide(&mut app, frame));
        glide(&mut app, 12);
        picture(&mut app, &image, 2).texels
    };
    let [found, expected] = [app(12), app(0)];
    assert!(expected.iter().any(|texel| texel[0] > 0.01), "it is dark");
    assert!(found == expected);
    assert!(app(0) == expected, "not all of it is determined");
}

#[test]
fn an_image_off_screen_that_changes_is_seen() {
    let mut app = app();
    let target = target(&mut app, SIZE);
    camera(&mut app, &target, with_rings(LightMethod::Cascades, 2));
    let [white, other] = [(); 2].map(|()| image(&mut app, [1, 1], |_, _| [255; 4]));
    let sprite = Sprite { image: white.clone(), custom_size: Some(Vec2::splat(40.0)), ..default() };
    let at = Transform::from_xyz(120.0, 0.0, 0.0);
    app.world_mut().spawn((sprite, Matter2d::glow(4.0), at));
    begin(&mut app);
    let mut light = |changed: Option<(&Handle<Image>, [u8; 4])>| {
        if let Some((image, texel)) = changed {
            let mut images = app.world_mut().resource_mut::<Assets<Image>>();
            images.get_mut(image).expect("it is there").data = Some(texel.to_vec());
        }
        picture(&mut app, &target, 3).at(80, 32)
    };
    let first = light(None);
    assert!(first[0] > 0.05 && first[0] == first[1], "{first:?}");
    assert_eq!(light(Some((&other, [255, 0, 0, 255]))), first);
    let red = light(Some((&white, [255, 0, 0, 255])));
    assert!(red[0] == first[0] && red[1] == 0.0, "{red:?}");
}

#[test]
fn nothing_around_changes_nothing() {
    for method in [LightMethod::Cascades, LightMethod::Polar, LightMethod::Flood] {
        let lit = |surroundings: u32| {
            let mut app = app();
            let image = target(&mut app, SIZE);
            let eye = camera(&mut app, &image, with_rings(method, surroundings));
            app.world_mut().entity_mut(eye).insert(Sky2d::default());
            app.world_mut().spawn(PointLight2d::default());
            begin(&mut app);
            picture(&mut app, &image, 3).texels
        };
        assert!(lit(0) == lit(3), "{method:?}");
    }
}

#[test]
fn sky_and_suns_shine_past_what_is_around() {
    for glow in [false, true] {
        let lit = |surroundings: u32| {
            let mut app = app();
            let image = target(&mut app, SIZE);
            let eye = camera(&mut app, &image, with_rings(LightMethod::Cascades, surroundings));
            app.world_mut().entity_mut(eye).insert(Sky2d::default());
            app.world_mut().spawn(SunLight2d { glow, angle: 0.3, ..default() });
            let pebble = Transform::from_xyz(0.0, -300.0, 0.0);
            app.world_mut().spawn((LightOccluder2d::circle(4.0), pebble));
            begin(&mut app);
            picture(&mut app, &image, 3)
        };
        let [found, expected] = [3, 0].map(|rings| at(&lit(rings), [[10, 12], [48, 32], [80, 50]]));
        println!("glow {glow}: {found:?}, without surroundings {expected:?}");
        let near = |i: usize| (found[i] / expected[i] - 1.0).abs() < 0.02;
        assert!((0..3).all(near), "glow {glow}: {found:?}, not {expected:?}");
        assert_ne!(found, expected, "the pebble is missing");
    }
}

#[test]
fn a_lamp_that_drifts_in_from_afar_does_not_pop() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let eye = camera(&mut app, &image, with_rings(LightMethod::Holographic, 4));
    app.world_mut().entity_mut(eye).insert(AmbientLight2d { brightness: 0.02, ..default() });
    let lamp = app.world_mut().spawn(PointLight2d::default()).id();
    begin(&mut app);
    // The largest jump between three frames while the lamp moves from one place to another: how far light is from changing
    // evenly.
    let jump = |app: &mut App, from: f32, to: f32| {
        let mut frames: Vec<Picture> = Vec::new();
        let mut worst = 0.0f32;
        for x in (0..).map(|i| from - 0.5 * i as f32).take_while(|x| *x >= to) {
            let at = Transform::from_xyz(48.0 + x, 5.3, 0.0);
            app.world_mut().entity_mut(lamp).insert(at);
            frames.push(picture(app, &image, 1));
            if let [one, two, other] = &frames[..] {
                let green = |frame: &Picture, i: usize| frame.texels[i][1];
                let off =
                    |i| (green(two, i) - 0.5 * (green(one, i) + green(other, i))).abs() / mean(two);
                worst = (0..two.texels.len()).map(off).fold(worst, f32::max);
                frames.remove(0);
            }
        }
        println!("from {from} to {to}: {worst:.4}");
        worst
    };
    // Beyond the reach of all rings, through them, and over the border of the grid.
    let far = [2000.0, 1100.0, 620.0, 610.0, 400.0, 250.0, 150.0];
    let beyond = far.map(|from| jump(&mut app, from, from - 1.0)).into_iter().fold(0.0, f32::max);
    let over = jump(&mut app, 72.0, 44.0);
    assert!(beyond < JUMP && over < JUMP, "{beyond}, {over}");
    app.world_mut().entity_mut(eye).insert(with_rings(LightMethod::Holographic, 0));
    let alone = jump(&mut app, 72.0, 44.0);
    assert!(alone > 2.0 * JUMP, "the measure sees no lamp pop: {alone}");
}
