//! A dungeon of tiles with doors and a thousand torches. The arrow keys move, and the space bar opens
//! and closes doors: `cargo run --release -p bevy_lamplight --example dungeon`.

use bevy::asset::RenderAssetUsages;
use bevy::camera::ScalingMode;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy::sprite_render::{TileData, TilemapChunk, TilemapChunkTileData};
use bevy_lamplight::prelude::*;

fn main() {
    let pixels = ImagePlugin::default_nearest();
    App::new().add_plugins((DefaultPlugins.set(pixels), example)).run();
}

/// The example as a plugin.
pub fn example(app: &mut App) {
    app.add_plugins(LamplightPlugin)
        .insert_resource(ClearColor(Color::BLACK))
        .add_systems(Startup, setup)
        .add_systems(Update, (walk, open));
}

/// World units per tile.
const TILE: u32 = 16;
/// Columns and rows of tiles.
const MAP: UVec2 = UVec2::new(201, 121);
/// Tiles from one wall to the next.
const ROOM: u32 = 10;
const TORCHES: usize = 1000;

#[derive(Component)]
struct Hero;

#[derive(Component)]
struct Door;

/// The kind of a tile.
#[derive(Clone, Copy, PartialEq)]
enum Tile {
    Floor,
    Wall,
    Door,
}

/// A grid of rooms. Most have a door to the next one, some have pillars.
fn tile(at: UVec2) -> Tile {
    let within = at % ROOM;
    let room = at / ROOM;
    let mix = (room.x * 31 + room.y * 17 + room.x * room.y * 7) % 11;
    let middle = ROOM / 2;
    let on_wall = [within.x == 0, within.y == 0];
    let at_edge = at.x == 0 || at.y == 0 || at.x == MAP.x - 1 || at.y == MAP.y - 1;
    match on_wall {
        _ if at_edge => Tile::Wall,
        [true, false] if within.y == middle && mix != 3 => Tile::Door,
        [false, true] if within.x.abs_diff(middle) < 2 && mix != 5 => Tile::Floor,
        [true, _] | [_, true] => Tile::Wall,
        _ if mix % 3 == 1 && within % 3 == UVec2::ZERO => Tile::Wall,
        _ => Tile::Floor,
    }
}

/// The centre of a tile in the world.
fn middle(at: UVec2) -> Vec2 {
    (at.as_vec2() + 0.5 - 0.5 * MAP.as_vec2()) * TILE as f32
}

/// Two layers: bricks and flagstones.
fn tileset() -> Image {
    let texel = |layer: u32, x: u32, y: u32| {
        let brick = y % 8 == 7 || (x + if y % 16 < 8 { 0 } else { 8 }) % 16 == 15;
        let stone = x == 0 || y == 0;
        let grain = ((x * 13 + y * 29 + x * y) % 7) as u8 * 3;
        let rgb: [u8; 3] = match (layer, brick, stone) {
            (0, true, _) => [70, 60, 60],
            (0, false, _) => [150, 110, 95],
            (_, _, true) => [85, 85, 90],
            _ => [130, 128, 125],
        };
        let [r, g, b] = rgb.map(|v| v.saturating_sub(grain));
        [r, g, b, 255]
    };
    let texels = (0..2 * TILE).flat_map(|y| (0..TILE).map(move |x| (x, y)));
    let data = texels.flat_map(|(x, y)| texel(y / TILE, x, y % TILE)).collect();
    let mut image = Image::new(
        Extent3d { width: TILE, height: 2 * TILE, depth_or_array_layers: 1 },
        TextureDimension::D2,
        data,
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::default(),
    );
    image.reinterpret_stacked_2d_as_array(2).expect("two tiles, one over the other");
    image
}

fn setup(mut commands: Commands, mut images: ResMut<Assets<Image>>) {
    let tileset = images.add(tileset());
    let tiles = || (0..MAP.y).flat_map(|y| (0..MAP.x).map(move |x| UVec2::new(x, y)));
    let layer = |index, shows: fn(Tile) -> bool| {
        let tiles = tiles().map(|at| shows(tile(at)).then(|| TileData::from_tileset_index(index)));
        let chunk = TilemapChunk {
            chunk_size: MAP,
            tile_display_size: UVec2::splat(TILE),
            tileset: tileset.clone(),
            ..default()
        };
        (chunk, TilemapChunkTileData(tiles.collect()))
    };
    commands.spawn((layer(1, |tile| tile != Tile::Wall), Transform::from_xyz(0.0, 0.0, -1.0)));
    commands.spawn((layer(0, |tile| tile == Tile::Wall), Matter2d::wall()));
    for at in tiles().filter(|&at| tile(at) == Tile::Door) {
        let door = Sprite::from_color(Color::srgb(0.5, 0.3, 0.15), Vec2::new(6.0, TILE as f32));
        let place = Transform::from_translation(middle(at).extend(1.0));
        // Every other door is open.
        let is_open = (at.x / ROOM + at.y / ROOM).is_multiple_of(2);
        let visibility = if is_open { Visibility::Hidden } else { Visibility::Inherited };
        commands.spawn((door, Matter2d::wall(), Door, place, visibility));
    }
    // Torches near walls.
    let places = tiles().filter(|&at| {
        tile(at) == Tile::Floor
            && [2, ROOM - 2].contains(&(at.x % ROOM))
            && [2, ROOM - 2].contains(&(at.y % ROOM))
    });
    for (i, at) in places.take(TORCHES).enumerate() {
        let warmth = 0.45 + 0.2 * (i % 5) as f32 / 5.0;
        let torch = PointLight2d {
            color: Color::srgb(1.0, warmth, 0.2),
            intensity: 0.35,
            range: 90.0,
            radius: 2.0,
            ..default()
        };
        commands.spawn((torch, Transform::from_translation(middle(at).extend(2.0))));
    }
    let start = middle(UVec2::new(104, 63));
    commands
        .spawn((
            Sprite::from_color(Color::srgb(0.4, 0.7, 1.0), Vec2::splat(10.0)),
            PointLight2d { color: Color::srgb(0.7, 0.85, 1.0), intensity: 0.8, ..default() },
            Hero,
            Transform::from_translation(start.extend(3.0)),
        ))
        .with_child((
            Camera2d,
            Projection::Orthographic(OrthographicProjection {
                scaling_mode: ScalingMode::FixedVertical { viewport_height: 360.0 },
                ..OrthographicProjection::default_2d()
            }),
            Lighting2d { wall_depth: 10.0, ..default() },
            AmbientLight2d { color: Color::srgb(0.5, 0.6, 1.0), brightness: 0.01 },
        ));
}

type DoorQuery = (&'static Transform, &'static Visibility);

fn walk(
    time: Res<Time>,
    keys: Option<Res<ButtonInput<KeyCode>>>,
    doors: Query<DoorQuery, (With<Door>, Without<Hero>)>,
    mut hero: Single<&mut Transform, With<Hero>>,
) {
    let Some(keys) = keys else { return };
    let along = |more, less| f32::from(keys.pressed(more)) - f32::from(keys.pressed(less));
    let direction = Vec2::new(
        along(KeyCode::ArrowRight, KeyCode::ArrowLeft),
        along(KeyCode::ArrowUp, KeyCode::ArrowDown),
    );
    let step = 90.0 * time.delta_secs() * direction.normalize_or_zero();
    // One axis at a time, so that the hero slides along walls.
    for step in [step * Vec2::X, step * Vec2::Y] {
        let next = hero.translation.truncate() + step;
        let at = (next / TILE as f32 + 0.5 * MAP.as_vec2()).as_uvec2();
        let is_shut = doors.iter().any(|(door, visibility)| {
            *visibility != Visibility::Hidden
                && door.translation.truncate().distance(next) < 0.7 * TILE as f32
        });
        if tile(at) != Tile::Wall && !is_shut {
            hero.translation += step.extend(0.0);
        }
    }
}

/// Opens or closes the doors within reach.
fn open(
    keys: Option<Res<ButtonInput<KeyCode>>>,
    hero: Single<&Transform, With<Hero>>,
    mut doors: Query<(&Transform, &mut Visibility), With<Door>>,
) {
    if !keys.is_some_and(|keys| keys.just_pressed(KeyCode::Space)) {
        return;
    }
    for (door, mut visibility) in &mut doors {
        if door.translation.truncate().distance(hero.translation.truncate()) < 2.5 * TILE as f32 {
            *visibility = match *visibility {
                Visibility::Hidden => Visibility::Inherited,
                _ => Visibility::Hidden,
            };
        }
    }
}
