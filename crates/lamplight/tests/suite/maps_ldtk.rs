//! Projects of LDtk: the cells that their levels stand for, and the messages for bad files.

use crate::common::*;
use image::{Rgba, RgbaImage, imageops};
use lamplight::maps::MapWorld;
use lamplight::scene::Material;
use lamplight::settings::Holographic;
use lamplight::world::{World, WorldSettings, WorldSource};
use lamplight::{Cells, Error, Falloff, GridWindow, Settings, srgb};
use serde_json::{Value, json};
use std::fs;
use tempfile::TempDir;

/// A folder with `tiles.png`: four tiles of 4×4 px in a row, of random colours.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let random = &mut seeded(9);
        let tiles = RgbaImage::from_fn(16, 4, |_, _| {
            Rgba([random.u8(..), random.u8(..), random.u8(..), 255])
        });
        tiles.save(folder.path().join("tiles.png")).unwrap();
        Self(folder)
    }

    fn write(&self, name: &str, value: &Value) -> &Self {
        self.write_text(name, &value.to_string())
    }

    fn write_text(&self, name: &str, text: &str) -> &Self {
        fs::write(self.0.path().join(name), text).unwrap();
        self
    }

    fn open(&self, name: &str) -> Result<MapWorld, Error> {
        MapWorld::open(self.0.path().join(name))
    }

    fn cells(&self, name: &str) -> Cells {
        self.open(name).unwrap().all_cells().unwrap()
    }

    fn error(&self, name: &str) -> String {
        let Err(error) = self.open(name).and_then(|map| map.all_cells()) else {
            panic!("it is read");
        };
        error.to_string()
    }

    fn tile(&self, number: u32) -> RgbaImage {
        let tiles = image::open(self.0.path().join("tiles.png")).unwrap().to_rgba8();
        imageops::crop_imm(&tiles, 4 * number, 0, 4, 4).to_image()
    }
}

/// A project with one tileset, tile 2 of which emits, and an IntGrid with tiles.
fn project(levels: Vec<Value>) -> Value {
    json!({
        "jsonVersion": "1.5.3", "worldLayout": "Free", "worlds": [], "levels": levels,
        "defs": {
            "tilesets": [{
                "uid": 7, "identifier": "Art", "relPath": "tiles.png", "pxWid": 16, "pxHei": 4, "tileGridSize": 4,
                "spacing": 0, "padding": 0, "enumTags": [{ "enumValueId": "Walls", "tileIds": [3] }],
                "customData": [{ "tileId": 2, "data": "light = \"emitters\"\nemission = 6" }, { "tileId": 0, "data": "a chest" }],
            }, { "uid": 8, "identifier": "Icons", "relPath": null, "pxWid": 64, "pxHei": 64, "tileGridSize": 16 }],
            "layers": [{
                "uid": 1, "identifier": "Ground", "doc": "What one walks on.\n[lamplight]\nground = \"walls\"\nmist = { material = \"fog\" }",
                "intGridValues": [
                    { "value": 1, "identifier": "ground", "color": "#808080" }, { "value": 2, "identifier": "Water", "color": "#0000ff" },
                    { "value": 3, "identifier": "ladder", "color": "#ff0000" }, { "value": 5, "identifier": "mist", "color": "#ffffff" },
                ],
            }, { "uid": 2, "identifier": "Tiles", "intGridValues": [] }, { "uid": 3, "identifier": "Entities", "intGridValues": [] }],
        },
    })
}

fn level(name: &str, first: [i32; 2], size: [u32; 2], layers: Value) -> Value {
    json!({
        "identifier": name, "worldX": first[0], "worldY": first[1], "worldDepth": 0, "pxWid": size[0], "pxHei": size[1],
        "__bgColor": "#336699", "externalRelPath": null, "fieldInstances": [], "layerInstances": layers,
    })
}

/// A layer of cells of 4×4 px, with more fields.
fn layer(uid: u32, size: [u32; 2], more: Value) -> Value {
    let mut layer = json!({
        "__identifier": format!("Layer{uid}"), "__type": "Tiles", "__cWid": size[0], "__cHei": size[1], "__gridSize": 4,
        "__opacity": 1, "__pxTotalOffsetX": 0, "__pxTotalOffsetY": 0, "__tilesetDefUid": null, "layerDefUid": uid,
        "visible": true, "intGridCsv": [], "gridTiles": [], "autoLayerTiles": [], "entityInstances": [],
    });
    for (key, value) in more.as_object().unwrap() {
        layer[key] = value.clone();
    }
    layer
}

fn tile(x: i32, y: i32, t: u32, f: u32) -> Value {
    json!({ "px": [x, y], "src": [4 * t, 0], "f": f, "t": t, "d": [0], "a": 1 })
}

fn linear(pixel: &Rgba<u8>) -> [f32; 3] {
    [0, 1, 2].map(|c| srgb::decode_u8(pixel[c]))
}

#[test]
fn tiles_are_painted_in_order_flipped_and_act_by_their_data() {
    let folder = Folder::new();
    let tiles = json!([
        tile(0, 0, 0, 0),
        tile(4, 0, 1, 1),
        tile(8, 0, 1, 2),
        tile(12, 0, 1, 3),
        tile(16, 0, 2, 0),
        tile(20, 0, 3, 0)
    ]);
    let under = layer(2, [6, 1], json!({ "__tilesetDefUid": 7, "gridTiles": [tile(0, 0, 3, 0)] }));
    let over = layer(
        2,
        [6, 1],
        json!({ "__tilesetDefUid": 7, "gridTiles": tiles, "__pxTotalOffsetX": 2 }),
    );
    folder.write("a.ldtk", &project(vec![level("A", [0, 0], [28, 4], json!([over, under]))]));
    let cells = folder.cells("a.ldtk");
    let expected = |x: u32, y: u32| {
        let picture = match x.checked_sub(2).map(|x| x / 4) {
            // The lower layer is not moved.
            None => return linear(folder.tile(3).get_pixel(x, y)),
            Some(0) => folder.tile(0),
            Some(1) => imageops::flip_horizontal(&folder.tile(1)),
            Some(2) => imageops::flip_vertical(&folder.tile(1)),
            Some(3) => imageops::rotate180(&folder.tile(1)),
            Some(4) => folder.tile(2),
            Some(5) => folder.tile(3),
            Some(_) => return [0x33, 0x66, 0x99].map(srgb::decode_u8),
        };
        linear(picture.get_pixel((x - 2) % 4, y))
    };
    for (x, y) in (0..4).flat_map(|y| (0..28).map(move |x| (x, y))) {
        assert_eq!(cells.color().unwrap()[cells.index(x, y)], expected(x, y), "({x}, {y})");
    }
    let light = cells.get(19, 1).unwrap();
    assert_eq!((light.opacity, light.emission), (1.0, expected(19, 1).map(|v| 6.0 * v)));
    let wall = cells.get(23, 2).unwrap();
    assert_eq!((wall.opacity, wall.albedo), (1.0, expected(23, 2)));
    assert_eq!(cells.get(10, 0).unwrap().opacity, 0.0);
}

#[test]
fn values_of_an_int_grid_are_matter_by_their_name_or_a_note() {
    let folder = Folder::new();
    let grid = json!({ "__tilesetDefUid": 7, "intGridCsv": [1, 2, 3, 5, 9, 0], "autoLayerTiles": [tile(0, 0, 1, 0)] });
    folder.write(
        "a.ldtk",
        &project(vec![level("A", [0, 0], [24, 4], json!([layer(1, [6, 1], grid.clone())]))]),
    );
    let cells = folder.cells("a.ldtk");
    let at = |column: u32| cells.get(4 * column + 2, 1).unwrap();
    assert_eq!((at(0).opacity, at(0).albedo), (1.0, linear(folder.tile(1).get_pixel(2, 1))));
    assert_eq!([at(1), at(3)], [Material::Water.matter(), Material::Fog.matter()]);
    for column in [2, 4, 5] {
        assert_eq!(at(column).opacity, 0.0);
    }
    let background = [0x33, 0x66, 0x99].map(srgb::decode_u8);
    assert_eq!(cells.color().unwrap()[cells.index(9, 1)], background);
    // Without tiles, values are painted.
    let mut plain = grid;
    plain["__tilesetDefUid"] = Value::Null;
    folder.write(
        "b.ldtk",
        &project(vec![level("A", [0, 0], [24, 4], json!([layer(1, [6, 1], plain)]))]),
    );
    let cells = folder.cells("b.ldtk");
    assert_eq!(cells.color().unwrap()[cells.index(9, 1)], [1.0, 0.0, 0.0]);
}

#[test]
fn entities_are_lamps_and_suns() {
    let folder = Folder::new();
    let field = |name: &str, kind: &str, value: Value| json!({ "__identifier": name, "__type": kind, "__value": value });
    let entities = json!([
        { "__identifier": "Lamp", "__pivot": [0.5, 1], "px": [10, 8], "width": 4, "height": 6, "fieldInstances": [
            field("Color", "Color", json!("#FF8000")), field("intensity", "Float", json!(30)), field("Range", "Int", json!(null)),
            field("falloff", "LocalEnum.Falloff", json!("Linear")), field("loot", "Array<Int>", json!([1, 2])),
        ]},
        { "__identifier": "Sun", "__pivot": [0, 0], "px": [0, 0], "width": 4, "height": 4, "fieldInstances": [field("direction", "String", json!("60deg"))] },
        { "__identifier": "Player", "__pivot": [0, 0], "px": [0, 0], "width": 4, "height": 4, "fieldInstances": [] },
    ]);
    let mut room = level(
        "A",
        [0, 0],
        [24, 16],
        json!([layer(3, [6, 4], json!({ "entityInstances": entities }))]),
    );
    room["fieldInstances"] = json!([field("Sky", "Color", json!("#204060"))]);
    let world = folder.write("a.ldtk", &project(vec![room])).open("a.ldtk").unwrap();
    let cells = world.all_cells().unwrap();
    let [lamp] = cells.lamps() else { panic!("{:?}", cells.lamps()) };
    assert_eq!((lamp.position, lamp.intensity, lamp.range), ([10.0, 5.0], 30.0, 256.0));
    assert_eq!((lamp.color, lamp.falloff), ([0xff, 0x80, 0].map(srgb::decode_u8), Falloff::Linear));
    assert_eq!(world.suns()[0].direction, 60f32.to_radians());
    assert_eq!(world.sky(), lamplight::Sky::Uniform([0x20, 0x40, 0x60].map(srgb::decode_u8)));
}

/// Two levels of 80×80 px side by side, inside of `in.ldtk`, in files of `out.ldtk`, and in a row in `row.ldtk`; and the
/// same as one level, `one.ldtk`.
fn two_levels() -> Folder {
    let folder = Folder::new();
    let random = &mut seeded(13);
    let values: Vec<u32> = (0..800).map(|_| random.u32(0..12).saturating_sub(9)).collect();
    let part = |columns: std::ops::Range<usize>| {
        let size = [columns.len() as u32, 20];
        let csv: Vec<u32> =
            values.chunks(40).flat_map(|row| row[columns.clone()].iter().copied()).collect();
        let tiles: Vec<Value> = (0..)
            .zip(&csv)
            .filter(|(_, value)| **value == 1)
            .map(|(i, _)| tile(4 * (i % size[0] as i32), 4 * (i / size[0] as i32), 1, 0))
            .collect();
        let lamp = |x: f32| json!({ "__identifier": "Lamp", "px": [x, 40], "fieldInstances": [] });
        let lamps: Vec<Value> = [30.0f32, 79.0, 130.0]
            .iter()
            .filter(|x| columns.contains(&((**x / 4.0) as usize)))
            .map(|x| lamp(x - 4.0 * columns.start as f32))
            .collect();
        json!([
            layer(3, size, json!({ "entityInstances": lamps })),
            layer(
                1,
                size,
                json!({ "__tilesetDefUid": 7, "intGridCsv": csv, "autoLayerTiles": tiles })
            ),
        ])
    };
    let size = [80, 80];
    let levels =
        [level("Right", [90, -3], size, part(20..40)), level("Left", [10, -3], size, part(0..20))];
    folder.write("one.ldtk", &project(vec![level("A", [0, 0], [160, 80], part(0..40))]));
    folder.write("in.ldtk", &project(levels.to_vec()));
    let mut outside = levels.to_vec();
    for (level, name) in outside.iter_mut().zip(["r.ldtkl", "l.ldtkl"]) {
        folder.write(name, level);
        level["externalRelPath"] = name.into();
        level["layerInstances"] = Value::Null;
    }
    folder.write("out.ldtk", &project(outside));
    let mut row = project(vec![levels[1].clone(), levels[0].clone()]);
    row["worldLayout"] = "LinearHorizontal".into();
    folder.write("row.ldtk", &row);
    folder
}

#[test]
fn levels_in_files_or_not_are_the_cells_of_the_whole() {
    let folder = two_levels();
    let one = folder.cells("one.ldtk");
    for (name, origin) in [("in.ldtk", [10, -3]), ("out.ldtk", [10, -3]), ("row.ldtk", [0, 0])] {
        let two = folder.open(name).unwrap();
        assert_eq!((two.size(), two.origin()), ([160, 80], origin));
        for (first, size) in [([70, 3], [33, 50]), ([3, 5], [20, 9]), ([0, 0], [160, 80])] {
            let window = GridWindow { first, size };
            let mut found = two.cells(window).unwrap();
            let mut expected = WorldSource::cells(&one, window).unwrap();
            for cells in [&mut found, &mut expected] {
                cells.lamps_mut().sort_by(|a, b| a.position[0].total_cmp(&b.position[0]));
            }
            assert!(found == expected, "{name} {window:?}");
        }
    }
}

#[test]
fn levels_have_the_light_of_their_cells() {
    let folder = two_levels();
    let settings =
        || WorldSettings { halo: 16, ..WorldSettings::new(Settings::new(Holographic::default())) };
    let two = folder.open("out.ldtk").unwrap();
    let cells = two.all_cells().unwrap();
    let from_files = World::new(&two, settings(), |_, _| ()).unwrap();
    let from_memory = World::new(&cells, settings(), |_, _| ()).unwrap();
    for window in from_files.tiles(64).unwrap() {
        let [files, memory] = [&from_files, &from_memory].map(|world| world.light(window).unwrap());
        assert!(files.pixels() == memory.pixels(), "{window:?}");
        assert!(files.pixels().as_flattened().iter().any(|&v| v > 0.0));
    }
}

#[test]
fn errors_name_the_file_the_level_and_the_layer() {
    let folder = two_levels();
    let good = fs::read_to_string(folder.0.path().join("in.ldtk")).unwrap();
    let cases: [(String, &[&str]); 11] = [
        ("{".into(), &["a.ldtk", "not a project of LDtk"]),
        ("{}".into(), &["a.ldtk", "defs"]),
        (
            "[]".into(),
            &[
                "a.ldtk: it is not a project of LDtk: line 1: `project` is a list, but must be a table",
            ],
        ),
        (
            good.replacen("\"worldX\":", "\"worldX\":0.5,\"x\":", 1),
            &["`levels[0].worldX` is 0.5, but must be a whole number from -2147483648 to "],
        ),
        (good.replacen("\"pxWid\":80", "\"pxWid\":-80", 1), &["levels[0]", "-80"]),
        (
            good.replacen("\"pxWid\":80", "\"pxWid\":800000", 1),
            &["level \"Right\"", "800000×80", "65536"],
        ),
        (
            good.replacen(
                "\"Layer1\",\"__type\":\"Tiles\",\"__cWid\":20",
                "\"Layer1\",\"__type\":\"Tiles\",\"__cWid\":21",
                1,
            ),
            &["level \"Right\"", "layer \"Layer1\"", "400 values", "420"],
        ),
        (good.replace("\"t\":1", "\"t\":4"), &["layer \"Layer1\"", "`tile` is 4", "below 4"]),
        (
            good.replace("ground = \\\"walls\\\"", "ground = \\\"wall\\\""),
            &["value \"ground\"", "`light`", "walls"],
        ),
        (
            good.replace("ground = \\\"walls\\\"", "ground = walls"),
            &["layer \"Layer1\"", "[lamplight]"],
        ),
        (good.replace("tiles.png", "gone.png"), &["tileset \"Art\"", "gone.png"]),
    ];
    for (text, words) in cases {
        folder.write_text("a.ldtk", &text);
        let message = folder.error("a.ldtk");
        assert!(
            words.iter().all(|words| message.contains(words)),
            "{message}\nlacks one of {words:?}"
        );
    }
    fs::remove_file(folder.0.path().join("l.ldtkl")).unwrap();
    let error = folder.error("out.ldtk");
    assert!(error.contains("out.ldtk: cannot read ") && error.contains("l.ldtkl: "), "{error}");
    folder.write("a.ldtk", &project(vec![]));
    assert!(folder.error("a.ldtk").contains("has no level"));
}

#[test]
fn files_cut_short_or_changed_anywhere_are_errors_and_no_panic() {
    let folder = Folder::new();
    let grid =
        json!({ "__tilesetDefUid": 7, "intGridCsv": [1, 2], "autoLayerTiles": [tile(0, 0, 1, 0)] });
    let text =
        project(vec![level("A", [0, 0], [8, 4], json!([layer(1, [2, 1], grid)]))]).to_string();
    let random = &mut seeded(15);
    for length in (0..text.len()).step_by(7) {
        folder.write_text("a.ldtk", &text[..length]);
        assert!(folder.open("a.ldtk").is_err(), "{length}");
    }
    for number in numbers(&text) {
        for other in
            ["0", "1", "-1", "65537", "1048577", "4294967295", "18446744073709551615", "1e30", "x"]
        {
            let changed = [&text[..number.start], other, &text[number.end..]].concat();
            folder.write_text("a.ldtk", &changed);
            draw(&folder);
        }
    }
    for _ in 0..2000 {
        let mut bytes = text.clone().into_bytes();
        let at = random.usize(..bytes.len());
        bytes[at] = random.u8(32..127);
        folder.write_text("a.ldtk", std::str::from_utf8(&bytes).unwrap());
        draw(&folder);
    }
}

/// Opens the file and draws a corner of it, whatever comes of it.
fn draw(folder: &Folder) {
    let corner = GridWindow { first: [0, 0], size: [1, 1] };
    let _ = folder.open("a.ldtk").and_then(|map| map.cells(corner));
}
