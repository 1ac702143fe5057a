//! Unlit entities, and the light texture for passes of users.

use crate::common::{app, begin, camera, picture, plain, target};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::view::Msaa;
use bevy_lamplight::prelude::*;
use bevy_lamplight::render::ViewLightTexture;

const SIZE: [u32; 2] = [64, 48];

#[test]
fn unlit_sprites_keep_their_colours_above_everything_lit() {
    for msaa in [Msaa::Off, Msaa::Sample4] {
        let mut app = app();
        let image = target(&mut app, SIZE);
        let eye = camera(&mut app, &image, plain());
        app.world_mut().entity_mut(eye).insert(msaa);
        let color = |r, g, b| Color::linear_rgb(r, g, b);
        let at = |x, z| Transform::from_xyz(x, 0.0, z);
        let square = |color| Sprite::from_color(color, Vec2::splat(12.0));
        app.world_mut().spawn((square(color(1.0, 0.0, 0.0)), Unlit2d, at(-16.0, -5.0)));
        app.world_mut().spawn((square(color(0.0, 1.0, 0.0)), at(-16.0, 3.0)));
        app.world_mut().spawn((square(color(0.0, 0.0, 1.0)), at(16.0, 0.0)));
        // A translucent sprite above another unlit one.
        app.world_mut().spawn((
            square(color(0.0, 0.5, 0.0).with_alpha(0.5)),
            Unlit2d,
            at(-12.0, 8.0),
        ));
        begin(&mut app);
        // Several frames, because held-back draw calls have to return to their phase.
        for _ in 0..2 {
            let seen = picture(&mut app, &image, 3);
            let near = |found: [f32; 3], right: [f32; 3]| {
                assert!((0..3).all(|c| (found[c] - right[c]).abs() < 2e-3), "{found:?}, {right:?}");
            };
            near(seen.at(11, 24), [1.0, 0.0, 0.0]);
            near(seen.at(18, 24), [0.5, 0.25, 0.0]);
            near(seen.at(48, 24), [0.0; 3]);
            near(seen.at(2, 2), [0.0; 3]);
        }
    }
}

#[test]
fn what_is_unlit_is_drawn_while_the_camera_cannot_be_lit() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let broken = Lighting2d { set: vec!["no such key".to_owned()], ..plain() };
    let eye = camera(&mut app, &image, broken);
    let red = Sprite::from_color(Color::linear_rgb(1.0, 0.0, 0.0), Vec2::splat(12.0));
    app.world_mut().spawn((red, Unlit2d));
    begin(&mut app);
    let mut seen = |lighting: Lighting2d| {
        app.world_mut().entity_mut(eye).insert(lighting);
        let seen = picture(&mut app, &image, 3);
        [seen.at(32, 24), seen.at(2, 2)]
    };
    let (red, white, black) = ([1.0, 0.0, 0.0], [1.0; 3], [0.0; 3]);
    // The first is wrong from the start, the last for its display alone.
    let broken = Lighting2d { set: vec!["no such key".to_owned()], ..plain() };
    assert_eq!(seen(broken), [red, white], "the picture stays as it is");
    assert_eq!(seen(plain()), [red, black]);
    assert_eq!(seen(Lighting2d { exposure: 40.0, ..plain() }), [red, white]);
    assert_eq!(seen(plain()), [red, black]);
}

#[test]
fn the_light_texture_exists_while_the_camera_has_its_component() {
    let mut app = app();
    let image = target(&mut app, SIZE);
    let eye = camera(&mut app, &image, plain());
    app.world_mut().entity_mut(eye).insert(LightTexture2d);
    begin(&mut app);
    let found = |app: &mut App| {
        (0..3).for_each(|_| app.update());
        let world = app.sub_app_mut(RenderApp).world_mut();
        let mut query = world.query::<&ViewLightTexture>();
        query.iter(world).next().cloned()
    };
    let texture = found(&mut app).expect("the camera has its light");
    assert_eq!(texture.window.right, [64.0, 0.0]);
    assert!(texture.view.texture().width() >= 64 + 32);
    app.world_mut().entity_mut(eye).remove::<LightTexture2d>();
    assert!(found(&mut app).is_none());
}
