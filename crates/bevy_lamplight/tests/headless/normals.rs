//! Normal maps are lit by the side that they turn to the light.

use crate::common::{Picture, app, begin, camera, image, image_of, picture, plain, target};
use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::RenderLayers;
use bevy::image::{Image, TextureAtlas, TextureAtlasLayout};
use bevy::mesh::Mesh2d;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy::sprite_render::{
    ColorMaterial, MeshMaterial2d, TileData, TileOrientation, TilemapChunk, TilemapChunkTileData,
};
use bevy_lamplight::prelude::*;
use lamplight::{Bounces, Cells, Light, Matter, Method, Relief, Settings, Solver};
use lamplight_wgpu::{Camera2dView, GridPlacement};
use std::f32::consts::{FRAC_PI_2, PI, TAU};

const SIZE: [u32; 2] = [96, 72];
/// Width and height of the sprite at the world's origin.
const SIDE: u32 = 16;
/// The source of light, in the world: left, bottom, width and height.
const SOURCE: [i32; 4] = [-44, 14, 8, 8];
/// The tolerance of the GPU against [`Relief::shade`], relative to light of 1: normals and light are half floats, which
/// have eleven bits, and their products are summed.
const TOLERANCE: f32 = 2e-3;
/// Texels of tilted normals: x, y up and z.
const TILTED: [u8; 4] = [208, 158, 222, 255];
const OTHER: [u8; 4] = [88, 38, 215, 255];
/// A texel of a normal that is tilted towards the source of light.
const TOWARDS: [u8; 4] = [64, 166, 231, 255];
/// A texel of a flat normal.
const FLAT: [u8; 4] = [128, 128, 255, 255];

/// An app with a lit camera, a source of light, and what `spawn` adds.
fn scene(spawn: impl FnOnce(&mut App, Entity)) -> (App, Handle<Image>) {
    let mut app = app();
    let target = target(&mut app, SIZE);
    let eye = camera(&mut app, &target, plain());
    let [left, bottom, width, height] = SOURCE.map(|v| v as f32);
    let source = Sprite::from_color(Color::WHITE, Vec2::new(width, height));
    let at = Transform::from_xyz(left + 0.5 * width, bottom + 0.5 * height, 0.0);
    app.world_mut().spawn((source, Matter2d::glow(8.0), at));
    spawn(&mut app, eye);
    begin(&mut app);
    (app, target)
}

/// The picture of a scene.
fn seen(spawn: impl FnOnce(&mut App, Entity)) -> Picture {
    let (mut app, target) = scene(spawn);
    picture(&mut app, &target, 3)
}

/// A white sprite at the world's origin.
fn square() -> Sprite {
    Sprite::from_color(Color::WHITE, Vec2::splat(SIDE as f32))
}

/// A normal map that is the same everywhere.
fn uniform(app: &mut App, texel: [u8; 4]) -> NormalMap2d {
    NormalMap2d::new(image_of(app, [1, 1], TextureFormat::Rgba8Unorm, |_, _| texel.to_vec()))
}

/// A normal map of a ball, whose texels are those of [`square`].
fn ball(app: &mut App) -> NormalMap2d {
    let map = image_of(app, [SIDE, SIDE], TextureFormat::Rgba8Unorm, |x, y| {
        let [x, y] = [x, y].map(|v| (v as f32 + 0.5) / (0.5 * SIDE as f32) - 1.0);
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        let length = (x * x + y * y + z * z).sqrt();
        let texel = [x, -y, z].map(|v| (128.0 + 127.0 * v / length).round() as u8);
        [&texel[..], &[255]].concat()
    });
    NormalMap2d::new(map)
}

/// The normal of a texel in the world: x, y up and z.
fn normal(texel: [u8; 4]) -> Vec3 {
    let [x, y, z, _] = texel.map(|v| (f32::from(v) - 128.0) / 127.0);
    Vec3::new(x, y, z).normalize()
}

/// The light of the scene on the CPU, on the grid of a camera that is turned by an angle.
struct Expected {
    placed: GridPlacement,
    light: Light,
}

impl Expected {
    fn new(rotation: f32) -> Self {
        let view = Camera2dView {
            border: 16,
            lattice: 16,
            step: 32,
            rotation: (-rotation).into(),
            ..Camera2dView::default()
        };
        let placed = view.cover(SIZE.map(f64::from)).unwrap();
        let mut cells = Cells::new(placed.size[0], placed.size[1]).unwrap();
        let glow = Matter { emission: [8.0; 3], opacity: 1.0, ..Matter::EMPTY };
        let [left, bottom, width, height] = SOURCE;
        for (x, y) in
            (bottom..bottom + height).flat_map(|y| (left..left + width).map(move |x| (x, y)))
        {
            let at = [x - placed.origin[0], -1 - y - placed.origin[1]];
            cells.set(at[0] as u32, at[1] as u32, glow);
        }
        let bounces = Bounces::Count(0);
        let settings = Settings { bounces, moment: true, ..Settings::new(Method::Cascades) };
        let light = Solver::new(settings).unwrap().solve(&cells).unwrap().clone();
        Self { placed, light }
    }

    /// The light that a normal receives at a cell of the world, and its highlight.
    fn at(&self, x: i32, y: i32, normal: Vec3, relief: &Relief2d) -> f32 {
        let [column, row] = [x - self.placed.origin[0], -1 - y - self.placed.origin[1]];
        let i = (row as u32 * self.light.width() + column as u32) as usize;
        let normal = [normal.x, -normal.y, normal.z];
        let (light, moment) = (self.light.pixels()[i], &self.light.moment().unwrap()[i]);
        let Relief2d { elevation, specular, roughness } = *relief;
        let relief = Relief { specular, roughness };
        let (received, highlight) = relief.shade(normal, light, moment, elevation);
        received[1] + highlight[1]
    }
}

/// The largest difference of the sprite at the origin from what is expected, relative to light of 1. `to_view` takes
/// places of the world to the camera's axes.
fn worst(
    seen: &Picture,
    expected: &Expected,
    normal: Vec3,
    relief: &Relief2d,
    to_view: impl Fn(Vec2) -> Vec2,
) -> f32 {
    // Without the outermost pixels, at which a turned sprite may be a pixel larger or smaller.
    let half = SIDE as i32 / 2 - 1;
    let cells = (-half..half).flat_map(|y| (-half..half).map(move |x| (x, y)));
    cells.fold(0.0, |worst, (x, y)| {
        let at = to_view(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        let pixel = [0.5 * SIZE[0] as f32 + at.x, 0.5 * SIZE[1] as f32 - at.y].map(|v| v as u32);
        let right = expected.at(x, y, normal, relief);
        worst.max((seen.grey(pixel[0], pixel[1]) - right).abs() / right.max(1.0))
    })
}

/// The largest difference of two pictures.
fn difference(a: &Picture, b: &Picture) -> f32 {
    let pairs = a.texels.as_flattened().iter().zip(b.texels.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

fn turn(angle: f32) -> Transform {
    Transform::from_rotation(Quat::from_rotation_z(angle))
}

fn mirror(x: f32, y: f32) -> Transform {
    Transform::from_scale(Vec3::new(x, y, 1.0))
}

#[test]
fn a_flat_normal_map_changes_nothing() {
    let without = seen(|app, _| {
        app.world_mut().spawn(square());
    });
    let with = seen(|app, _| {
        let map = uniform(app, FLAT);
        app.world_mut().spawn((square(), map));
    });
    let worst = difference(&without, &with);
    assert!(worst < 1e-3, "{worst}");
    let tilted = seen(|app, _| {
        let map = uniform(app, TILTED);
        app.world_mut().spawn((square(), map));
    });
    assert!(difference(&without, &tilted) > 0.02, "a tilted one changes nothing");
}

#[test]
fn normals_turn_flip_and_scale_with_their_sprite() {
    let n = normal(TILTED);
    let same = Transform::default();
    let tall = Transform::from_scale(Vec3::new(2.0, 2.0, 1.0));
    let both = turn(FRAC_PI_2).with_scale(Vec3::new(-1.0, 1.0, 1.0));
    let flip = |x: bool, y: bool| [x, y];
    let cases = [
        ("as it is", [false; 2], same, n),
        ("a quarter turn", [false; 2], turn(FRAC_PI_2), Vec3::new(-n.y, n.x, n.z)),
        ("half a turn", [false; 2], turn(PI), Vec3::new(-n.x, -n.y, n.z)),
        ("turned back", [false; 2], turn(-FRAC_PI_2), Vec3::new(n.y, -n.x, n.z)),
        ("flipped along x", flip(true, false), same, Vec3::new(-n.x, n.y, n.z)),
        ("flipped along y", flip(false, true), same, Vec3::new(n.x, -n.y, n.z)),
        ("flipped twice", flip(true, true), mirror(-1.0, -1.0), n),
        ("of negative width", [false; 2], mirror(-1.0, 1.0), Vec3::new(-n.x, n.y, n.z)),
        ("enlarged", [false; 2], tall, n),
        ("mirrored, then turned", [false; 2], both, Vec3::new(-n.y, -n.x, n.z)),
    ];
    let expected = Expected::new(0.0);
    let relief = Relief2d::default();
    for (name, [flip_x, flip_y], transform, turned) in cases {
        let seen = seen(|app, _| {
            let map = uniform(app, TILTED);
            app.world_mut().spawn((Sprite { flip_x, flip_y, ..square() }, map, transform));
        });
        let wrong = worst(&seen, &expected, turned, &relief, |at| at);
        println!("{name}: {wrong}");
        assert!(wrong < TOLERANCE, "{name}: {wrong}");
        if turned != n {
            let other = worst(&seen, &expected, n, &relief, |at| at);
            assert!(other > 10.0 * TOLERANCE, "{name}: passes for one that is not turned");
        }
    }
}

#[test]
fn turning_or_mirroring_the_camera_does_not_change_the_lit_side() {
    let n = normal(TILTED);
    let quarter = |at: Vec2| Vec2::new(at.y, -at.x);
    let mirrored = |at: Vec2| Vec2::new(-at.x, at.y);
    type View = (f32, Transform, fn(Vec2) -> Vec2);
    let views: [View; 3] = [
        (0.0, mirror(-1.0, 1.0), mirrored),
        (FRAC_PI_2, turn(FRAC_PI_2), quarter),
        (PI, turn(PI), |at| -at),
    ];
    for (rotation, transform, to_view) in views {
        let seen = seen(|app, eye| {
            let map = uniform(app, TILTED);
            app.world_mut().entity_mut(eye).insert(transform);
            app.world_mut().spawn((square(), map));
        });
        let wrong = worst(&seen, &Expected::new(rotation), n, &Relief2d::default(), to_view);
        println!("{transform:?}: {wrong}");
        assert!(wrong < TOLERANCE, "{transform:?}: {wrong}");
    }
}

#[test]
fn a_ball_is_bright_towards_the_light_however_it_is_turned() {
    let of = |transform: Transform, flip_x: bool| {
        seen(|app, _| {
            let map = ball(app);
            app.world_mut().spawn((Sprite { flip_x, ..square() }, map, transform));
        })
    };
    let upright = of(Transform::default(), false);
    let quarter = SIDE / 4;
    let [towards, away] = [-1, 1].map(|side| {
        let at = |middle: u32, by: u32| middle.saturating_add_signed(side * by as i32);
        upright.grey(at(SIZE[0] / 2, quarter), at(SIZE[1] / 2, quarter / 2))
    });
    assert!(towards > 2.0 * away, "{towards}, {away}");
    let transforms = [
        (turn(FRAC_PI_2), false),
        (turn(PI), true),
        (mirror(-1.0, 1.0), false),
        (mirror(1.0, -1.0), true),
    ];
    for (transform, flip_x) in transforms {
        let worst = difference(&upright, &of(transform, flip_x));
        assert!(worst < TOLERANCE, "{transform:?}, {flip_x}: {worst}");
    }
}

#[test]
fn relief_sets_elevation_and_highlights() {
    let own = Relief2d { elevation: 0.6, specular: 0.7, roughness: 0.6 };
    let seen = seen(|app, eye| {
        let map = uniform(app, TOWARDS);
        app.world_mut().entity_mut(eye).insert(own);
        app.world_mut().spawn((square(), map));
    });
    let (expected, n) = (Expected::new(0.0), normal(TOWARDS));
    // Sums of highlights of up to three times the light.
    let wrong = worst(&seen, &expected, n, &own, |at| at);
    assert!(wrong < 3.0 * TOLERANCE, "{wrong}");
    for other in [Relief2d { specular: 0.0, ..own }, Relief2d { elevation: 0.8, ..own }] {
        let wrong = worst(&seen, &expected, n, &other, |at| at);
        assert!(wrong > 10.0 * TOLERANCE, "{other:?} passes: {wrong}");
    }
}

/// The tolerance of the ratio of two differences of light of about ½, each by [`TOLERANCE`].
const RATIO: f32 = 0.02;

#[test]
fn heights_of_lamps_and_elevations_of_suns_set_how_steeply_light_falls() {
    let n = normal(TOWARDS);
    let middle = |picture: &Picture| picture.grey(SIZE[0] / 2, SIZE[1] / 2 - 1);
    let lit_by = |light: &dyn Fn(&mut App)| {
        middle(&seen(|app, _| {
            let map = uniform(app, TOWARDS);
            app.world_mut().spawn((square(), map));
            light(app);
        }))
    };
    let dark = lit_by(&|_| ());
    // Light at 45°, as of all light, and at an elevation of its own.
    let check = |name: &str, [plain, own]: [f32; 2], cotangent: f32, to_light: Vec2| {
        let along = n.truncate().dot(to_light.normalize());
        let expected = (cotangent - 1.0) * along / (n.z + along);
        let found = (own - plain) / (plain - dark);
        assert!((found - expected).abs() < RATIO, "{name}: {found}, not {expected}");
    };
    let (place, height) = (Vec2::new(-20.0, 30.0), 12.0);
    let spot = |height: Option<f32>| {
        lit_by(&|app| {
            let lamp = SpotLight2d { angle: TAU, softness: 0.0, height, ..default() };
            app.world_mut().spawn((lamp, Transform::from_translation(place.extend(0.0))));
        })
    };
    let to_lamp = place - 0.5;
    check("lamp", [spot(None), spot(Some(height))], to_lamp.length() / height, to_lamp);
    let elevation = 0.3;
    let sun = |elevation: Option<f32>| {
        lit_by(&|app| {
            app.world_mut().spawn((SunLight2d { elevation, ..default() }, turn(-1.0)));
        })
    };
    let (sin, cos) = 1f32.sin_cos();
    let to_sun = Vec2::new(-cos, sin);
    check("sun", [sun(None), sun(Some(elevation))], 1.0 / elevation.tan(), to_sun);
}

#[test]
fn sprites_without_normals_are_flat_and_cover_what_lies_below() {
    let beside = || (square(), Transform::from_xyz(20.0, 0.0, 0.0));
    let above = || {
        let half = Sprite::from_color(Color::WHITE, Vec2::new(0.5, 1.0) * SIDE as f32);
        (half, Transform::from_xyz(0.25 * SIDE as f32, 0.0, 1.0))
    };
    let flat = seen(|app, _| {
        app.world_mut().spawn(square());
        app.world_mut().spawn(beside());
        app.world_mut().spawn(above());
    });
    let mapped = seen(|app, _| {
        let map = uniform(app, TILTED);
        app.world_mut().spawn((square(), map));
        app.world_mut().spawn(beside());
        app.world_mut().spawn(above());
    });
    let differs = |x: u32| (flat.grey(x, SIZE[1] / 2) - mapped.grey(x, SIZE[1] / 2)).abs();
    let middle = SIZE[0] / 2;
    assert!(differs(middle - 4) > 0.01, "the part that is not covered is tilted");
    assert!(differs(middle + 4) < 1e-3, "the other one is covered by a flat sprite");
    assert!(differs(middle + 20) < 1e-3, "the sprite beside it is flat");
    assert!(differs(middle - 12) < 1e-3, "and so is the background");
}

#[test]
fn sheets_tiles_and_meshes_have_normals_too() {
    let (n, m) = (normal(TILTED), normal(OTHER));
    let expected = Expected::new(0.0);
    let check = |name: &str, seen: &Picture, normal: Vec3| {
        let wrong = worst(seen, &expected, normal, &Relief2d::default(), |at| at);
        assert!(wrong < TOLERANCE, "{name}: {wrong}");
    };
    // Two cells beside each other, of which the right one is shown.
    let sheet = seen(|app, _| {
        let white = image(app, [2 * SIDE, SIDE], |_, _| [255; 4]);
        let map = image_of(app, [2 * SIDE, SIDE], TextureFormat::Rgba8Unorm, |x, _| {
            if x < SIDE { OTHER.to_vec() } else { TILTED.to_vec() }
        });
        let layout = TextureAtlasLayout::from_grid(UVec2::splat(SIDE), 2, 1, None, None);
        let layout = app.world_mut().resource_mut::<Assets<TextureAtlasLayout>>().add(layout);
        let sprite = Sprite::from_atlas_image(white, TextureAtlas { layout, index: 1 });
        app.world_mut().spawn((sprite, NormalMap2d::new(map)));
    });
    check("a sheet", &sheet, n);
    for (orientation, texel, right) in [
        (TileOrientation::Default, 0, n),
        (TileOrientation::Default, 1, m),
        (TileOrientation::MirrorH, 0, Vec3::new(-n.x, n.y, n.z)),
        (TileOrientation::Rotate180, 0, Vec3::new(-n.x, -n.y, n.z)),
    ] {
        let tiles = seen(|app, _| {
            let layers = |layers: [[u8; 4]; 2], format| {
                let size = Extent3d { width: 1, height: 2, depth_or_array_layers: 1 };
                let usage = RenderAssetUsages::default();
                let data = layers.concat();
                let mut image = Image::new(size, TextureDimension::D2, data, format, usage);
                image.reinterpret_stacked_2d_as_array(2).unwrap();
                image
            };
            let mut images = app.world_mut().resource_mut::<Assets<Image>>();
            let tileset = images.add(layers([[255; 4]; 2], TextureFormat::Rgba8UnormSrgb));
            let map = images.add(layers([TILTED, OTHER], TextureFormat::Rgba8Unorm));
            let tile =
                TileData { tileset_index: texel, orientation, color: Color::WHITE, visible: true };
            let chunk = TilemapChunk {
                chunk_size: UVec2::ONE,
                tile_display_size: UVec2::splat(SIDE),
                tileset,
                ..default()
            };
            let tiles = TilemapChunkTileData(vec![Some(tile)]);
            app.world_mut().spawn((chunk, tiles, NormalMap2d::new(map)));
        });
        check(&format!("a tile, {orientation:?}, {texel}"), &tiles, right);
    }
    let mesh = seen(|app, _| {
        let map = uniform(app, TILTED);
        let mesh = Mesh::from(Rectangle::from_length(SIDE as f32));
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
        let material = ColorMaterial::from_color(Color::WHITE);
        let material = app.world_mut().resource_mut::<Assets<ColorMaterial>>().add(material);
        app.world_mut().spawn((Mesh2d(mesh), MeshMaterial2d(material), map, turn(PI)));
    });
    check("a mesh", &mesh, Vec3::new(-n.x, -n.y, n.z));
}

#[test]
fn maps_of_other_formats_are_the_same_or_flat() {
    let map = |format, texel: &'static [u8], y| {
        seen(|app, _| {
            let image = image_of(app, [1, 1], format, |_, _| texel.to_vec());
            app.world_mut().spawn((square(), NormalMap2d { image, y }));
        })
    };
    let up = NormalY::Up;
    let linear = map(TextureFormat::Rgba8Unorm, &TILTED, up);
    for (name, other) in [
        ("sRGB", map(TextureFormat::Rgba8UnormSrgb, &TILTED, up)),
        ("two channels", map(TextureFormat::Rg8Unorm, &[TILTED[0], TILTED[1]], up)),
        (
            "y down",
            map(
                TextureFormat::Rgba8Unorm,
                &[TILTED[0], 255 - TILTED[1] + 1, TILTED[2], 255],
                NormalY::Down,
            ),
        ),
    ] {
        let worst = difference(&linear, &other);
        assert!(worst < TOLERANCE, "{name}: {worst}");
    }
    let flat = seen(|app, _| {
        app.world_mut().spawn(square());
    });
    assert!(difference(&flat, &linear) > 10.0 * TOLERANCE);
    let missing = seen(|app, _| {
        let image = app.world().resource::<AssetServer>().load("no such picture.png");
        app.world_mut().spawn((square(), NormalMap2d::new(image)));
    });
    let hidden = seen(|app, _| {
        let map = uniform(app, TILTED);
        app.world_mut().spawn((square(), map, RenderLayers::layer(3)));
        app.world_mut().spawn(square());
    });
    for (name, other) in [
        ("one channel", map(TextureFormat::R8Unorm, &[200], up)),
        ("signed", map(TextureFormat::Rgba8Snorm, &TILTED, up)),
        ("whole numbers", map(TextureFormat::Rgba8Uint, &TILTED, up)),
        ("missing", missing),
        ("on another layer", hidden),
    ] {
        let worst = difference(&flat, &other);
        assert!(worst < 1e-3, "{name}: {worst}");
    }
}
