//! Matter covers exactly the pixels that Bevy draws.

use crate::common::{Picture, app, begin, camera, image, picture, plain, target};
use bevy::asset::RenderAssetUsages;
use bevy::camera::RenderTarget;
use bevy::image::{Image, TextureAtlas, TextureAtlasLayout};
use bevy::mesh::{Mesh, Mesh2d, MeshCompressionArgs};
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy::sprite::{
    Anchor, BorderRect, SliceScaleMode, SpriteAlphaMode, SpriteImageMode, SpriteScalingMode,
    TextureSlicer,
};
use bevy::sprite_render::{
    AlphaMode2d, ColorMaterial, MeshMaterial2d, TileData, TileOrientation, TilemapChunk,
    TilemapChunkTileData,
};
use bevy_lamplight::prelude::*;

const SIZE: [u32; 2] = [96, 72];

/// Two pictures of an entity: as Bevy draws it in ambient light of 1, and as a source of light in the
/// dark.
///
/// With an emission of 1, the screen shows `colour × (light + 1)`. So both pictures have the same colours
/// at the same pixels, except for the light that parts of the entity receive from each other.
fn drawn_and_glowing(spawn: impl Fn(&mut App) -> Entity) -> [Picture; 2] {
    let mut app = app();
    app.insert_resource(ClearColor(Color::BLACK));
    let target = target(&mut app, SIZE);
    let eye = camera(&mut app, &target, plain());
    let entity = spawn(&mut app);
    app.world_mut().entity_mut(eye).insert(AmbientLight2d { brightness: 1.0, ..default() });
    begin(&mut app);
    let drawn = picture(&mut app, &target, 4);
    app.world_mut().entity_mut(eye).remove::<AmbientLight2d>();
    app.world_mut().entity_mut(entity).insert(Matter2d::glow(1.0));
    [drawn, picture(&mut app, &target, 2)]
}

/// The largest fraction by which an entity lights itself: parts of a shape that is not convex see each
/// other, and a rotated edge is a staircase.
const SELF_LIT: f32 = 1.0;
/// Like [`SELF_LIT`], for an upright box. It is convex, so this is the error of the method.
const CONVEX: f32 = 0.03;

/// Counts the pixels at which the pictures differ: both have to be black at the same pixels, and elsewhere
/// the second may be brighter by a fraction of `self_lit`.
fn mismatches([drawn, glowing]: &[Picture; 2], self_lit: f32) -> usize {
    let mut mismatches = 0;
    for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
        let (drawn, glowing) = (drawn.at(x, y), glowing.at(x, y));
        let matches = |c: usize| {
            let near = 2e-3 * drawn[c].max(1.0);
            (drawn[c] - near..=drawn[c] * (1.0 + self_lit) + near).contains(&glowing[c])
        };
        let same_coverage = (drawn == [0.0; 3]) == (glowing == [0.0; 3]);
        mismatches += usize::from(!same_coverage || !(0..3).all(matches));
    }
    mismatches
}

/// Counts the pixels that are not black.
fn covered(picture: &Picture) -> usize {
    picture.texels.iter().filter(|[r, g, b, _]| r + g + b > 0.0).count()
}

/// An image of 16 × 8 pixels without symmetry and without black.
fn sheet(app: &mut App) -> Handle<Image> {
    image(app, [16, 8], |x, y| {
        [60 + 10 * x as u8, 90 + 20 * y as u8, if x < 8 { 255 } else { 70 }, 255]
    })
}

/// An image with transparent corners.
fn cross(app: &mut App) -> Handle<Image> {
    image(app, [12, 12], |x, y| {
        let inside = (4..8).contains(&x) || (5..7).contains(&y);
        [200, 20 * y as u8, 10 * x as u8, if inside { 255 } else { 0 }]
    })
}

#[test]
fn sprites_are_matter_where_they_are_drawn() {
    type Change = (&'static str, fn(&mut Sprite), Anchor, Transform);
    let plain_transform = Transform::from_xyz(0.0, 0.0, 0.0);
    let turned = Transform::from_xyz(5.0, -3.0, 1.0)
        .with_rotation(Quat::from_rotation_z(0.5))
        .with_scale(Vec3::new(2.0, 3.0, 1.0));
    let large = |sprite: &mut Sprite| sprite.custom_size = Some(Vec2::new(40.0, 30.0));
    let changes: [Change; 12] = [
        ("as it is", |_| {}, Anchor::CENTER, plain_transform),
        ("mirrored", |s| s.flip_x = true, Anchor::CENTER, plain_transform),
        ("upside down", |s| s.flip_y = true, Anchor::CENTER, turned),
        ("by its corner", large, Anchor::BOTTOM_LEFT, turned),
        ("in part", |s| s.rect = Some(Rect::new(2.0, 1.0, 9.0, 7.0)), Anchor::TOP_RIGHT, turned),
        ("enlarged", large, Anchor(Vec2::new(0.1, -0.3)), plain_transform),
        (
            "filling",
            |s| {
                s.custom_size = Some(Vec2::new(30.0, 30.0));
                s.image_mode = SpriteImageMode::Scale(SpriteScalingMode::FillStart);
            },
            Anchor::CENTER,
            plain_transform,
        ),
        (
            "filling to the end",
            |s| {
                s.custom_size = Some(Vec2::new(50.0, 10.0));
                s.image_mode = SpriteImageMode::Scale(SpriteScalingMode::FillEnd);
            },
            Anchor::CENTER,
            plain_transform,
        ),
        (
            "fitting",
            |s| {
                s.custom_size = Some(Vec2::new(30.0, 40.0));
                s.image_mode = SpriteImageMode::Scale(SpriteScalingMode::FitStart);
            },
            Anchor::CENTER,
            plain_transform,
        ),
        (
            "fitting to the end",
            |s| {
                s.custom_size = Some(Vec2::new(60.0, 20.0));
                s.image_mode = SpriteImageMode::Scale(SpriteScalingMode::FitEnd);
            },
            Anchor::CENTER,
            plain_transform,
        ),
        (
            "in nine slices",
            |s| {
                s.custom_size = Some(Vec2::new(50.0, 40.0));
                s.image_mode = SpriteImageMode::Sliced(TextureSlicer {
                    border: BorderRect::all(3.0),
                    center_scale_mode: SliceScaleMode::Tile { stretch_value: 1.0 },
                    ..default()
                });
            },
            Anchor::CENTER,
            plain_transform,
        ),
        (
            "tiled and mirrored",
            |s| {
                s.custom_size = Some(Vec2::new(40.0, 20.0));
                s.flip_x = true;
                s.image_mode =
                    SpriteImageMode::Tiled { tile_x: true, tile_y: true, stretch_value: 1.0 };
            },
            Anchor::BOTTOM_CENTER,
            plain_transform,
        ),
    ];
    for (name, change, anchor, transform) in changes {
        let pictures = drawn_and_glowing(|app| {
            let image = sheet(app);
            let mut sprite = Sprite { image, color: Color::linear_rgb(0.9, 1.0, 0.7), ..default() };
            change(&mut sprite);
            app.world_mut().spawn((sprite, anchor, transform)).id()
        });
        assert!(covered(&pictures[0]) > 30, "{name}: {} are drawn", covered(&pictures[0]));
        let self_lit = if transform == turned { SELF_LIT } else { CONVEX };
        assert_eq!(mismatches(&pictures, self_lit), 0, "{name}");
    }
}

#[test]
fn a_sprite_in_another_place_is_rejected() {
    let [drawn, _] = drawn_and_glowing(|app| {
        let image = sheet(app);
        app.world_mut().spawn(Sprite::from_image(image)).id()
    });
    let [_, glowing] = drawn_and_glowing(|app| {
        let image = sheet(app);
        app.world_mut().spawn((Sprite::from_image(image), Transform::from_xyz(1.0, 0.0, 0.0))).id()
    });
    assert!(mismatches(&[drawn, glowing], SELF_LIT) > 10);
}

#[test]
fn alpha_atlases_texts_and_meshes_are_matter_where_they_are_drawn() {
    let by_alpha = drawn_and_glowing(|app| {
        let image = cross(app);
        app.world_mut().spawn(Sprite::from_image(image)).id()
    });
    let of_an_atlas = drawn_and_glowing(|app| {
        let image = sheet(app);
        let layout = TextureAtlasLayout::from_grid(UVec2::splat(4), 4, 2, None, None);
        let layout = app.world_mut().resource_mut::<Assets<TextureAtlasLayout>>().add(layout);
        let sprite = Sprite::from_atlas_image(image, TextureAtlas { layout, index: 6 });
        app.world_mut().spawn((sprite, Transform::from_scale(Vec3::splat(6.0)))).id()
    });
    let text = drawn_and_glowing(|app| {
        let color = TextColor(Color::linear_rgb(1.0, 0.5, 0.25));
        app.world_mut().spawn((Text2d::new("Lamp"), color)).id()
    });
    let by_cutoff = |alpha_mode: SpriteAlphaMode| {
        drawn_and_glowing(|app| {
            let image = image(app, [12, 12], |x, y| [200, 20 * y as u8, 90, 20 * x as u8 + 10]);
            let sprite = Sprite { image, alpha_mode, ..default() };
            app.world_mut().spawn(sprite).id()
        })
    };
    let polygon = |is_compressed: bool| {
        drawn_and_glowing(|app| {
            let mut mesh = Mesh::from(RegularPolygon::new(24.0, 5));
            if is_compressed {
                mesh = mesh.compressed_mesh(&MeshCompressionArgs::regular()).unwrap();
            }
            let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
            let texture = Some(cross(app));
            let color = Color::linear_rgb(0.5, 1.0, 1.0);
            let material =
                ColorMaterial { color, texture, alpha_mode: AlphaMode2d::Mask(0.5), ..default() };
            let material = app.world_mut().resource_mut::<Assets<ColorMaterial>>().add(material);
            app.world_mut().spawn((Mesh2d(mesh), MeshMaterial2d(material))).id()
        })
    };
    for (name, pictures) in [
        ("alpha", by_alpha),
        ("mask", by_cutoff(SpriteAlphaMode::Mask(0.5))),
        ("opaque", by_cutoff(SpriteAlphaMode::Opaque)),
        ("atlas", of_an_atlas),
        ("text", text),
        ("mesh", polygon(false)),
        ("compressed mesh", polygon(true)),
    ] {
        assert!(covered(&pictures[0]) > 30, "{name}: {} are drawn", covered(&pictures[0]));
        // At soft edges of glyphs, coverage is applied twice.
        let max = if name == "text" { covered(&pictures[0]) / 2 } else { 0 };
        assert!(
            mismatches(&pictures, SELF_LIT) <= max,
            "{name}: {}",
            mismatches(&pictures, SELF_LIT)
        );
    }
}

#[test]
fn tiles_are_matter_where_they_are_drawn_in_every_orientation() {
    let pictures = drawn_and_glowing(|app| {
        // Two tiles, one above the other, with a transparent corner.
        let texel = |x: u32, y: u32| match (x < 2 && y % 4 < 2, y < 4) {
            (true, _) => [0, 0, 0, 0],
            (_, true) => [250, 40 + 40 * x as u8, 100, 255],
            (_, false) => [20, 200, 20 * y as u8, 255],
        };
        let data = (0..8).flat_map(|y| (0..4).flat_map(move |x| texel(x, y))).collect();
        let mut tileset = Image::new(
            Extent3d { width: 4, height: 8, depth_or_array_layers: 1 },
            TextureDimension::D2,
            data,
            TextureFormat::Rgba8UnormSrgb,
            RenderAssetUsages::default(),
        );
        tileset.reinterpret_stacked_2d_as_array(2).unwrap();
        let tileset = app.world_mut().resource_mut::<Assets<Image>>().add(tileset);
        let orientations = [
            TileOrientation::Default,
            TileOrientation::Rotate90,
            TileOrientation::Rotate180,
            TileOrientation::Rotate270,
            TileOrientation::MirrorH,
            TileOrientation::MirrorHRotate90,
            TileOrientation::MirrorHRotate180,
            TileOrientation::MirrorHRotate270,
        ];
        let tiles = (0..12)
            .map(|i| {
                (i % 5 != 4).then(|| TileData {
                    tileset_index: i % 2,
                    orientation: orientations[usize::from(i) % 8],
                    color: Color::linear_rgb(1.0, 1.0, 0.8),
                    visible: i != 7,
                })
            })
            .collect();
        let chunk = TilemapChunk {
            chunk_size: UVec2::new(4, 3),
            tile_display_size: UVec2::splat(16),
            tileset,
            ..default()
        };
        app.world_mut().spawn((chunk, TilemapChunkTileData(tiles))).id()
    });
    assert!(covered(&pictures[0]) > 500, "{}", covered(&pictures[0]));
    assert_eq!(mismatches(&pictures, SELF_LIT), 0);
}

#[test]
fn tiles_are_matter_as_their_own_shader_draws_them() {
    // One tile of half-transparent texels, tinted: opaque chunks draw it whole, and take the tint as it is encoded.
    for (alpha_mode, alpha, is_drawn_whole) in [
        (AlphaMode2d::Opaque, 128, true),
        (AlphaMode2d::Mask(0.9), 128, true),
        (AlphaMode2d::Blend, 255, true),
        (AlphaMode2d::Opaque, 0, false),
    ] {
        for flat in [1.0, 0.0] {
            let pictures = drawn_and_glowing(|app| {
                let mut tileset = Image::new(
                    Extent3d { width: 4, height: 8, depth_or_array_layers: 1 },
                    TextureDimension::D2,
                    [250, 180, 100, alpha].repeat(32),
                    TextureFormat::Rgba8UnormSrgb,
                    RenderAssetUsages::default(),
                );
                tileset.reinterpret_stacked_2d_as_array(2).unwrap();
                let tileset = app.world_mut().resource_mut::<Assets<Image>>().add(tileset);
                let chunk = TilemapChunk {
                    chunk_size: UVec2::ONE,
                    tile_display_size: UVec2::splat(16),
                    tileset,
                    alpha_mode,
                };
                let color = Color::srgb(0.5, 0.75, 1.0);
                let tile = TileData { color, ..TileData::from_tileset_index(0) };
                let scale = Transform::from_scale(Vec3::new(1.0, 1.0, flat));
                let tiles = TilemapChunkTileData(vec![Some(tile)]);
                app.world_mut().spawn((chunk, tiles, scale)).id()
            });
            let name = format!("{alpha_mode:?}, alpha {alpha}, {flat} in z");
            assert_eq!(covered(&pictures[0]), if is_drawn_whole { 256 } else { 0 }, "{name}");
            assert_eq!(mismatches(&pictures, CONVEX), 0, "{name}");
        }
    }
}

#[test]
fn texts_are_matter_where_they_are_drawn_on_displays_of_high_density() {
    let pictures = drawn_and_glowing(|app| {
        // Two pixels per unit, and a cell per pixel.
        let world = app.world_mut();
        let (mut target, mut lighting) =
            world.query::<(&mut RenderTarget, &mut Lighting2d)>().single_mut(world).unwrap();
        if let RenderTarget::Image(image) = &mut *target {
            image.scale_factor = 2.0;
        }
        lighting.cells = CellSize::World(0.5);
        world.spawn((Text2d::new("Lamp"), TextFont::from_font_size(10.0))).id()
    });
    let drawn = covered(&pictures[0]);
    assert!(drawn > 60, "{drawn} are drawn");
    // At soft edges of glyphs, coverage is applied twice.
    let found = mismatches(&pictures, SELF_LIT);
    assert!(found <= drawn / 2, "{found} of {drawn}");
}

/// The light behind an occluder, with it and without it.
fn beyond(occluder: LightOccluder2d, transform: Transform) -> (f32, f32) {
    let lights = [true, false].map(|blocks| {
        let mut app = app();
        let target = target(&mut app, SIZE);
        camera(&mut app, &target, plain());
        app.world_mut().spawn((PointLight2d::default(), Transform::from_xyz(-30.0, 0.0, 0.0)));
        if blocks {
            app.world_mut().spawn((occluder.clone(), transform));
        }
        begin(&mut app);
        picture(&mut app, &target, 3).grey(78, 36)
    });
    (lights[0], lights[1])
}

#[test]
fn every_shape_of_occluder_blocks_light() {
    let here = Transform::default();
    let turned = Transform::from_rotation(Quat::from_rotation_z(1.2));
    let triangle = [Vec2::new(-6.0, -14.0), Vec2::new(6.0, -14.0), Vec2::new(0.0, 16.0)];
    // A horseshoe that is open to the right: not convex.
    let horseshoe = [(8, 12), (-4, 12), (-4, -12), (8, -12), (8, -8), (0, -8), (0, 8), (8, 8)]
        .map(|(x, y)| Vec2::new(x as f32, y as f32));
    for (shape, transform) in [
        (LightOccluder2d::rectangle(4.0, 24.0), here),
        (LightOccluder2d::circle(12.0), here),
        (LightOccluder2d::capsule(5.0, 16.0), here),
        (LightOccluder2d::capsule(10.0, 16.0), turned),
        (LightOccluder2d::polygon(triangle), here),
        (LightOccluder2d::polygon(horseshoe), here),
    ] {
        let (with, without) = beyond(shape.clone(), transform);
        assert!(without > 0.1 && with < 0.05 * without, "{shape:?}: {with} of {without}");
    }
    // An occluder beside the path does not block.
    let (with, without) = beyond(LightOccluder2d::circle(5.0), Transform::from_xyz(0.0, 25.0, 0.0));
    assert!(with > 0.9 * without, "beside it: {with} of {without}");
}

/// The largest unevenness of light, which falls off exponentially in fog.
const EVEN: f32 = 0.02;

#[test]
fn the_light_of_glow_and_fog_changes_evenly_as_they_move_by_parts_of_a_px() {
    type Spawn = fn(&mut App) -> Entity;
    // Fog before a lamp, and a flame that glows a little in every px.
    let fog: Spawn = |app| {
        app.world_mut().spawn((PointLight2d::default(), Transform::from_xyz(-40.0, 0.0, 0.0)));
        let sprite = Sprite::from_color(Color::WHITE, Vec2::new(9.0, 24.0));
        app.world_mut().spawn((sprite, Matter2d::fog(0.1))).id()
    };
    let fire: Spawn = |app| {
        let matter = Matter2d { opacity: 0.05, ..Matter2d::glow(8.0) };
        app.world_mut().spawn((LightOccluder2d::circle(4.0), matter)).id()
    };
    for (name, spawn) in [("fog", fog), ("fire", fire)] {
        let mut app = app();
        let target = target(&mut app, SIZE);
        camera(&mut app, &target, plain());
        let entity = spawn(&mut app);
        begin(&mut app);
        let pictures: Vec<Picture> = (0..=4)
            .map(|step| {
                let place = Transform::from_xyz(0.25 * step as f32, 0.125 * step as f32, 0.0);
                app.world_mut().entity_mut(entity).insert(place);
                picture(&mut app, &target, 3)
            })
            .collect();
        let (mut off, mut change) = (0f32, 0f32);
        for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
            // Not what covers the shape, nor the lamp.
            if (28..68).contains(&x) && (16..56).contains(&y) || x < 16 {
                continue;
            }
            let [from, to] = [0, 4].map(|step| pictures[step].grey(x, y));
            change = change.max((to / from - 1.0).abs());
            for (step, picture) in pictures.iter().enumerate() {
                let even = from + (to - from) * 0.25 * step as f32;
                off = off.max((picture.grey(x, y) / even - 1.0).abs());
            }
        }
        println!("{name}: {off:.4} off an even change of up to {change:.4}");
        assert!(off < EVEN, "{name}: {off}");
        assert!(change > 2.0 * off, "{name}: light hardly changes");
    }
}

#[test]
fn fog_that_touches_a_wall_leaves_it_solid() {
    for backend in [LightBackend::Cpu, LightBackend::Gpu] {
        let mut app = app();
        app.insert_resource(backend);
        let target = target(&mut app, SIZE);
        camera(&mut app, &target, Lighting2d { wall_depth: 8.0, ..plain() });
        app.world_mut().spawn((PointLight2d::default(), Transform::from_xyz(-20.0, 20.0, 0.0)));
        let floor = Sprite::from_color(Color::WHITE, Vec2::new(96.0, 20.0));
        app.world_mut().spawn((floor, Matter2d::wall(), Transform::from_xyz(0.0, -20.0, 0.0)));
        begin(&mut app);
        // The first row of the floor, under the middle of the fog.
        let place = [68, 46];
        let clear = picture(&mut app, &target, 3).grey(place[0], place[1]);
        assert!(clear > 0.1, "{clear}");
        let fog = app.world_mut().spawn(Matter2d::fog(0.01)).id();
        for height in [7.0f32, 11.0, 19.0, 22.0, 33.0, 37.0] {
            // From the floor up, of a size that f32 has to round.
            let scale = Vec3::new(20.0 / 7.0, height / 7.0, 1.0);
            let at = Transform::from_xyz(20.0, -10.0 + 0.5 * height, 1.0).with_scale(scale);
            let steam = Sprite::from_color(Color::srgba(1.0, 1.0, 1.0, 0.5), Vec2::splat(7.0));
            app.world_mut().entity_mut(fog).insert((steam, at));
            let through = picture(&mut app, &target, 3).grey(place[0], place[1]);
            println!("{backend:?}, {height} units of fog: {through:.3} of {clear:.3}");
            assert!(through > 0.6 * clear, "{backend:?}, {height}: {through}, {clear} without");
        }
    }
}
