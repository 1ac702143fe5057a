//! Maps of Tiled: the cells that they stand for, however they are written, and the messages for bad files.

use crate::common::*;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use image::{Rgba, RgbaImage, imageops};
use lamplight::maps::MapWorld;
use lamplight::settings::Holographic;
use lamplight::world::{World, WorldSettings, WorldSource};
use lamplight::{Cells, Error, GridWindow, Settings, srgb};
use std::fs;
use std::io::Write;
use tempfile::TempDir;

/// A folder with `tiles.png`: eight tiles of 4×4 px in two rows, of random colours, the last one clear.
struct Folder(TempDir);

const TILES: u32 = 8;

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        let random = &mut seeded(5);
        let tiles = RgbaImage::from_fn(16, 8, |x, y| {
            let alpha = if x >= 12 && y >= 4 { 0 } else { 255 };
            Rgba([random.u8(..), random.u8(..), random.u8(..), alpha])
        });
        folder.image("tiles.png", &tiles);
        folder
    }

    fn image(&self, name: &str, image: &RgbaImage) {
        image.save(self.0.path().join(name)).unwrap();
    }

    fn write(&self, name: &str, text: impl AsRef<str>) -> &Self {
        fs::write(self.0.path().join(name), text.as_ref()).unwrap();
        self
    }

    fn open(&self, name: &str) -> Result<MapWorld, Error> {
        MapWorld::open(self.0.path().join(name))
    }

    fn cells(&self, name: &str) -> Cells {
        self.open(name).unwrap().all_cells().unwrap()
    }

    /// The message for a file, whether it is found when it is opened or when it is drawn.
    fn error(&self, name: &str) -> String {
        let drawn = self.open(name).and_then(|map| map.all_cells());
        let folder = format!("{}{}", self.0.path().display(), std::path::MAIN_SEPARATOR);
        let Err(error) = drawn else {
            panic!("it is read:\n{}", fs::read_to_string(self.0.path().join(name)).unwrap());
        };
        error.to_string().replace(&folder, "")
    }

    fn tile(&self, number: u32) -> RgbaImage {
        let tiles = image::open(self.0.path().join("tiles.png")).unwrap().to_rgba8();
        imageops::crop_imm(&tiles, 4 * (number % 4), 4 * (number / 4), 4, 4).to_image()
    }
}

const TILESET: &str = r#"<tileset firstgid="1" name="art" tilewidth="4" tileheight="4" tilecount="8" columns="4">
<image source="tiles.png" width="16" height="8"/></tileset>"#;

/// A map of cells of 4×4 px.
fn map(width: u32, height: u32, body: impl AsRef<str>) -> String {
    map_with("", width, height, body)
}

fn map_with(more: &str, width: u32, height: u32, body: impl AsRef<str>) -> String {
    let body = body.as_ref();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<map version=\"1.10\" orientation=\"orthogonal\" width=\"{width}\" \
         height=\"{height}\" tilewidth=\"4\" tileheight=\"4\" {more}>{body}</map>"
    )
}

fn csv(gids: &[u32]) -> String {
    gids.iter().map(u32::to_string).collect::<Vec<_>>().join(",")
}

/// A layer of a row of tiles.
fn layer(name: &str, more: &str, gids: &[u32]) -> String {
    let width = gids.len();
    format!(
        "<layer name=\"{name}\" width=\"{width}\" height=\"1\">{more}<data encoding=\"csv\">{}</data></layer>",
        csv(gids)
    )
}

fn properties(pairs: &[(&str, &str)]) -> String {
    let property =
        |(name, value): &(&str, &str)| format!("<property name=\"{name}\" value=\"{value}\"/>");
    format!("<properties>{}</properties>", pairs.iter().map(property).collect::<String>())
}

fn linear(pixel: &Rgba<u8>) -> [f32; 3] {
    [0, 1, 2].map(|c| srgb::decode_u8(pixel[c]))
}

/// Asserts that a map shows an image at a column of tiles.
#[track_caller]
fn shows(cells: &Cells, column: u32, image: &RgbaImage) {
    let color = cells.color().unwrap();
    for (x, y, pixel) in image.enumerate_pixels() {
        let found = color[cells.index(4 * column + x, y)];
        assert_eq!(found, linear(pixel), "px ({x}, {y}) of column {column}");
    }
}

#[test]
fn tiles_are_flipped_as_tiled_flips_them() {
    const H: u32 = 1 << 31;
    const V: u32 = 1 << 30;
    const D: u32 = 1 << 29;
    let folder = Folder::new();
    let gids = [2, 2 | H, 2 | V, 2 | H | V, 2 | D | H, 2 | D | V, 2 | D, 2 | D | H | V];
    folder.write("a.tmx", map(8, 1, TILESET.to_owned() + &layer("a", "", &gids)));
    let cells = folder.cells("a.tmx");
    let tile = &folder.tile(1);
    let expected = [
        tile.clone(),
        imageops::flip_horizontal(tile),
        imageops::flip_vertical(tile),
        imageops::rotate180(tile),
        imageops::rotate90(tile),
        imageops::rotate270(tile),
        imageops::flip_horizontal(&imageops::rotate90(tile)),
        imageops::flip_horizontal(&imageops::rotate270(tile)),
    ];
    for (column, image) in (0..).zip(&expected) {
        shows(&cells, column, image);
    }
    assert!(cells.opacity().iter().all(|&opacity| opacity == 0.0));
}

#[test]
fn properties_give_how_tiles_act_on_light() {
    let folder = Folder::new();
    let tileset = TILESET.replace(
        "</tileset>",
        &format!(
            "<tile id=\"2\">{}</tile>\
             <tile id=\"3\"><objectgroup><object id=\"1\" x=\"0\" y=\"0\" width=\"4\" height=\"4\"/></objectgroup></tile>\
             </tileset>",
            properties(&[("light", "emitters"), ("emission", "6")])
        ),
    );
    let walls = properties(&[("light", "walls")]);
    let body = tileset
        + &layer("ground", "", &[1, 1, 4, 1, 1, 1])
        + "<group name=\"solid\">"
        + &walls
        + &layer("walls", "", &[2, 3, 0, 8, 0, 0])
        + "</group>"
        + &layer(
            "glass",
            &properties(&[("opacity", "0"), ("tint", "#ff0000ff")]),
            &[0, 0, 0, 0, 1, 0],
        )
        + &layer("hidden", "", &[0, 0, 0, 0, 0, 2]).replace("<layer", "<layer visible=\"0\"");
    folder.write("a.tmx", map(6, 1, body));
    let cells = folder.cells("a.tmx");
    let at = |column: u32, tile: u32| {
        let matter = cells.get(4 * column + 1, 2).unwrap();
        (matter, linear(folder.tile(tile).get_pixel(1, 2)))
    };
    let (wall, color) = at(0, 1);
    assert_eq!((wall.opacity, wall.albedo, wall.emission), (1.0, color, [0.0; 3]));
    let (light, color) = at(1, 2);
    assert_eq!((light.opacity, light.emission), (1.0, color.map(|v| 6.0 * v)));
    // A shape for collisions, in a layer that says nothing.
    let (wall, color) = at(2, 3);
    assert_eq!((wall.opacity, wall.albedo), (1.0, color));
    // The picture of a wall is clear here, and a hidden layer is not there.
    for column in [3, 5] {
        assert_eq!(at(column, 0).0.opacity, 0.0);
        shows(&cells, column, &folder.tile(0));
    }
    let (glass, _) = at(4, 0);
    assert_eq!((glass.opacity, glass.tint), (0.0, [0.0, 0.0, 1.0]));
}

#[test]
fn a_game_may_have_properties_of_the_same_names() {
    let folder = Folder::new();
    let own = properties(&[("light", "7"), ("material", "dirt")]);
    folder.write("a.tmx", map(1, 1, TILESET.to_owned() + &layer("a", &own, &[1])));
    assert!(folder.error("a.tmx").contains("layer \"a\""));
    let class = "<property name=\"lamplight\" type=\"class\">".to_owned()
        + &properties(&[("light", "walls")])
        + "</property>";
    let prefixed = "<property name=\"lamplight.light\" value=\"walls\"/>".to_owned();
    for meant in [class, prefixed] {
        let both = own.replace("</properties>", &(meant + "</properties>"));
        folder.write("a.tmx", map(1, 1, TILESET.to_owned() + &layer("a", &both, &[1])));
        assert_eq!(folder.cells("a.tmx").opacity(), [1.0; 16]);
    }
}

#[test]
fn objects_are_lamps_and_suns() {
    let folder = Folder::new();
    let lamp = properties(&[("color", "#ffff8000"), ("intensity", "30"), ("size", "2.5")]);
    let body = format!(
        "{}<objectgroup offsetx=\"2\"><object id=\"1\" type=\"lamp\" x=\"6\" y=\"3\">{lamp}<point/></object>\
         <object id=\"2\" class=\"Light\" x=\"10\" y=\"0\" width=\"4\" height=\"2\"/>\
         <object id=\"3\" type=\"chest\" x=\"1\" y=\"1\"/>\
         <object id=\"4\" template=\"spot.tx\" x=\"12\" y=\"2\" rotation=\"90\"/>\
         <object id=\"5\" type=\"sun\" x=\"0\" y=\"0\">{}</object></objectgroup>",
        properties(&[("sky", "[0.1, 0.2, 0.3]")]),
        properties(&[("direction", "100deg"), ("intensity", "2")]),
    );
    folder.write("a.tmx", map(8, 2, body)).write(
        "spot.tx",
        format!(
            "<template><object type=\"lamp\">{}</object></template>",
            properties(&[("angle", "60deg")])
        ),
    );
    let world = folder.open("a.tmx").unwrap();
    let cells = world.all_cells().unwrap();
    let [first, second, spot] = cells.lamps() else { panic!("{:?}", cells.lamps()) };
    assert_eq!((first.position, first.intensity, first.size), ([8.0, 3.0], 30.0, 2.5));
    assert_eq!(first.color, [0xff, 0x80, 0].map(srgb::decode_u8));
    assert_eq!(second.position, [14.0, 1.0]);
    let cone = spot.cone.unwrap();
    assert!(
        (cone.direction - std::f32::consts::FRAC_PI_2).abs() < 1e-6 && spot.position == [14.0, 2.0]
    );
    assert_eq!((world.suns().len(), world.suns()[0].intensity), (1, 2.0));
    assert_eq!(world.sky(), lamplight::Sky::Uniform([0.1, 0.2, 0.3]));
}

#[test]
fn lamps_have_cookies_and_profiles() {
    let folder = Folder::new();
    folder.image("leaves.png", &RgbaImage::from_fn(2, 1, |x, _| Rgba([255 * x as u8, 0, 0, 255])));
    let as_text = r#"{&quot;picture&quot;: &quot;leaves.png&quot;, &quot;size&quot;: 20}"#;
    let own = properties(&[("cookie", as_text), ("angle", "60deg"), ("profile", "[0.2, 1]")]);
    let as_class = "<properties><property name=\"cookie\" type=\"class\">".to_owned()
        + &properties(&[("picture", "leaves.png"), ("turn", "90deg")]).replace(
            "</properties>",
            "<property name=\"size\" type=\"float\" value=\"8\"/></properties>",
        )
        + "</property></properties>";
    let objects = |own: &str, other: &str| {
        format!(
            "<objectgroup><object id=\"1\" type=\"lamp\" x=\"4\" y=\"4\">{own}<point/></object>\
             <object id=\"2\" type=\"lamp\" x=\"9\" y=\"4\">{other}<point/></object></objectgroup>"
        )
    };
    folder.write("a.tmx", map(4, 2, objects(&own, &as_class)));
    let cells = folder.cells("a.tmx");
    let [first, second] = cells.lamps() else { panic!("{:?}", cells.lamps()) };
    let [cookie, turned] = [first, second].map(|lamp| lamp.cookie.as_ref().unwrap());
    assert_eq!((cookie.at([5.0, 0.0]), cookie.at([-5.0, 0.0])), ([1.0, 0.0, 0.0], [0.0; 3]));
    assert!(turned.at([0.0, 2.0])[0] > 0.99);
    assert!(turned.pixels().unwrap().shares(cookie.pixels().unwrap()));
    assert!(first.cone.unwrap().profile.is_some());
    assert!(
        folder.open("a.tmx").unwrap().files().unwrap().iter().any(|f| f.ends_with("leaves.png"))
    );
    folder.write("a.tmx", map(4, 2, objects(&own.replace("leaves", "twigs"), "")));
    let error = folder.error("a.tmx");
    assert!(error.contains("twigs.png") && error.contains("a.tmx"), "{error}");
}

#[test]
fn lamps_beyond_the_border_reach_as_far_as_their_range() {
    let folder = Folder::new();
    let lamp = |x: i32, more: &[(&str, &str)]| {
        let own = properties(more);
        format!("<object id=\"1\" type=\"lamp\" x=\"{x}\" y=\"4\">{own}<point/></object>")
    };
    let spot = [("angle", "60deg"), ("range", "40"), ("size", "1")];
    let body = format!(
        "<objectgroup>{}{}{}</objectgroup>",
        lamp(-20, &spot),
        lamp(-60, &spot),
        lamp(-30, &[("size", "1")])
    );
    folder.write("a.tmx", map(8, 2, body));
    let world = folder.open("a.tmx").unwrap();
    let at = |cells: &Cells| cells.lamps().iter().map(|lamp| lamp.position[0]).collect::<Vec<_>>();
    let all = world.all_cells().unwrap();
    assert_eq!(at(&all), [-20.0, -60.0, -30.0]);
    for source in [&world as &dyn WorldSource, &all] {
        let window = source.cells(GridWindow { first: [16, 0], size: [16, 8] }).unwrap();
        assert_eq!(at(&window), [-36.0, -46.0]);
    }
    // A spot that lights the border is refused like any other.
    let made = World::new(&world, WorldSettings::new(Settings::default()), |_, _| ());
    let error = made.map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("(-20, 4)"), "{error}");
}

#[test]
fn tiles_that_are_objects_have_the_class_and_the_properties_of_their_tile() {
    let folder = Folder::new();
    let torch = properties(&[("intensity", "30"), ("size", "2")]);
    let tileset = TILESET
        .replace("</tileset>", &format!("<tile id=\"2\" type=\"lamp\">{torch}</tile></tileset>"));
    let own = properties(&[("size", "5")]);
    let body = format!(
        "{tileset}<objectgroup><object id=\"1\" gid=\"{}\" x=\"4\" y=\"4\" width=\"4\" height=\"4\">{own}</object>\
         <object id=\"2\" gid=\"3\" type=\"chest\" x=\"8\" y=\"4\" width=\"4\" height=\"4\"/>\
         <object id=\"3\" gid=\"1\" x=\"8\" y=\"4\" width=\"4\" height=\"4\"/></objectgroup>",
        3u32 | 1 << 31
    );
    let cells = folder.write("a.tmx", map(4, 2, body)).cells("a.tmx");
    let [lamp] = cells.lamps() else { panic!("{:?}", cells.lamps()) };
    assert_eq!((lamp.position, lamp.intensity, lamp.size), ([6.0, 2.0], 30.0, 5.0));
}

#[test]
fn objects_turn_about_their_place() {
    let folder = Folder::new();
    let cone = properties(&[("angle", "60deg")]);
    let body = format!(
        "{TILESET}<objectgroup>\
         <object id=\"1\" type=\"lamp\" x=\"10\" y=\"6\" width=\"4\" height=\"2\" rotation=\"90\"/>\
         <object id=\"2\" type=\"lamp\" gid=\"1\" x=\"10\" y=\"6\" width=\"4\" height=\"4\" rotation=\"-90\"/>\
         <object id=\"3\" type=\"lamp\" x=\"2\" y=\"3\" rotation=\"450\">{cone}<point/></object></objectgroup>"
    );
    let cells = folder.write("a.tmx", map(8, 4, body)).cells("a.tmx");
    let [rect, tile, spot] = cells.lamps() else { panic!("{:?}", cells.lamps()) };
    for (lamp, expected) in [(rect, [9.0, 8.0]), (tile, [8.0, 4.0]), (spot, [2.0, 3.0])] {
        let off = [0, 1].map(|a| (lamp.position[a] - expected[a]).abs());
        assert!(off[0].max(off[1]) < 1e-5, "{:?} {expected:?}", lamp.position);
    }
    let direction = spot.cone.unwrap().direction;
    assert!((direction - std::f32::consts::FRAC_PI_2).abs() < 1e-6, "{direction}");
}

#[test]
fn tiles_that_are_objects_stand_as_their_tileset_says() {
    let folder = Folder::new();
    let aligned = |alignment: &str| {
        let alignment = format!("name=\"art\" objectalignment=\"{alignment}\"");
        TILESET.replacen("name=\"art\"", &alignment, 1)
    };
    let object = "<objectgroup><object id=\"1\" type=\"lamp\" gid=\"3\" x=\"10\" y=\"6\" width=\"4\" height=\"2\"/>\
                  </objectgroup>";
    for (alignment, center) in [
        ("unspecified", [12.0, 5.0]),
        ("bottomleft", [12.0, 5.0]),
        ("center", [10.0, 6.0]),
        ("topright", [8.0, 7.0]),
        ("bottom", [10.0, 5.0]),
    ] {
        folder.write("a.tmx", map(8, 4, aligned(alignment) + object));
        assert_eq!(folder.cells("a.tmx").lamps()[0].position, center, "{alignment}");
    }
    let error = folder.write("a.tmx", map(8, 4, aligned("middle") + object)).error("a.tmx");
    assert!(error.contains("`objectalignment` is middle"), "{error}");
}

#[test]
fn all_encodings_are_the_same_cells() {
    let folder = Folder::new();
    let gids = [1, 2 | 1 << 31, 0, 7, 5, 3 | 1 << 29];
    let bytes: Vec<u8> = gids.iter().flat_map(|gid: &u32| gid.to_le_bytes()).collect();
    let zlib = |bytes: &[u8]| {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    };
    let gzip = |bytes: &[u8]| {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    };
    let elements: String = gids.iter().map(|gid| format!("<tile gid=\"{gid}\"/>")).collect();
    let base64 = |compression: &str, bytes: &[u8]| {
        let text = STANDARD.encode(bytes);
        format!("<data encoding=\"base64\"{compression}>\n  {text}\n</data>")
    };
    let written = [
        format!("<data encoding=\"csv\">\n{}\n</data>", csv(&gids)),
        base64("", &bytes),
        base64(" compression=\"zlib\"", &zlib(&bytes)),
        base64(" compression=\"gzip\"", &gzip(&bytes)),
        format!("<data>{elements}</data>"),
    ];
    let cells = written.map(|data| {
        let layer = format!("{TILESET}<layer name=\"a\" width=\"3\" height=\"2\">{data}</layer>");
        folder.write("a.tmx", map(3, 2, layer));
        folder.cells("a.tmx")
    });
    assert!(cells.iter().all(|other| *other == cells[0]));
    shows(&cells[0], 0, &folder.tile(0));
    // As an infinite map that begins left of its origin, as old files without what can be found out, and with the tileset
    // in a file of its own.
    let chunk = |x: i32, gids: &[u32]| {
        format!(
            "<chunk x=\"{x}\" y=\"-1\" width=\"{}\" height=\"2\">{}</chunk>",
            gids.len() / 2,
            csv(gids)
        )
    };
    let chunks = chunk(-2, &[gids[0], gids[1], gids[3], gids[4]]) + &chunk(0, &[gids[2], gids[5]]);
    let layer = format!(
        "<layer name=\"a\" width=\"3\" height=\"2\"><data encoding=\"csv\">{chunks}</data></layer>"
    );
    let set = TILESET
        .replace(" tilecount=\"8\" columns=\"4\"", "")
        .replace(" width=\"16\" height=\"8\"", "");
    folder.write("set.tsx", set.replace(" firstgid=\"1\"", ""));
    let outside = "<tileset firstgid=\"1\" source=\"set.tsx\"/>".to_owned();
    folder.write("a.tmx", map_with("infinite=\"1\"", 3, 2, outside + &layer));
    let world = folder.open("a.tmx").unwrap();
    assert_eq!(world.origin(), [-8, -4]);
    assert!(world.all_cells().unwrap() == cells[0]);
}

/// Two maps side by side, `two.world`, and the same as one, `one.tmx`.
fn two_maps() -> Folder {
    let folder = Folder::new();
    let random = &mut seeded(7);
    let rows: Vec<Vec<u32>> = (0..20)
        .map(|_| (0..40).map(|_| random.u32(0..4 * TILES).saturating_sub(3 * TILES)).collect())
        .collect();
    let lamps = [[30.0, 20.0], [79.0, 40.0], [130.0, 60.0]];
    let part = |columns: std::ops::Range<usize>| {
        let gids: Vec<u32> =
            rows.iter().flat_map(|row| row[columns.clone()].iter().copied()).collect();
        let width = columns.len();
        let left = 4.0 * columns.start as f32;
        let range = properties(&[("range", "4")]);
        let objects: String = lamps
            .iter()
            .filter(|lamp| columns.contains(&((lamp[0] / 4.0) as usize)))
            .map(|[x, y]| {
                format!("<object type=\"lamp\" x=\"{}\" y=\"{y}\">{range}</object>", x - left)
            })
            .collect();
        let walls = properties(&[("light", "walls")]);
        let body = format!(
            "{TILESET}<layer name=\"a\" width=\"{width}\" height=\"20\">{walls}<data encoding=\"csv\">{}</data></layer>\
             <objectgroup>{objects}</objectgroup>",
            csv(&gids)
        );
        map(width as u32, 20, body)
    };
    folder
        .write("one.tmx", part(0..40))
        .write("left.tmx", part(0..20))
        .write("right.tmx", part(20..40));
    let world = r#"{ "type": "world", "maps": [
        { "fileName": "right.tmx", "x": 70, "y": -7, "width": 80, "height": 80 },
        { "fileName": "left.tmx", "x": -10, "y": -7 } ] }"#;
    folder.write("two.world", world);
    folder
}

#[test]
fn a_window_across_two_maps_is_that_of_the_whole() {
    let folder = two_maps();
    let one = folder.cells("one.tmx");
    let two = folder.open("two.world").unwrap();
    assert_eq!((two.size(), two.origin()), ([160, 80], [-10, -7]));
    for (first, size) in [([70, 3], [33, 50]), ([3, 5], [20, 9]), ([0, 0], [160, 80])] {
        let window = GridWindow { first, size };
        let [found, expected] =
            [two.cells(window), WorldSource::cells(&one, window)].map(Result::unwrap);
        let mut lamps = [found.lamps().to_vec(), expected.lamps().to_vec()];
        lamps
            .iter_mut()
            .for_each(|lamps| lamps.sort_by(|a, b| a.position[0].total_cmp(&b.position[0])));
        assert!(
            lamps[0] == lamps[1] && !lamps[0].is_empty() == (size[0] > 20),
            "{window:?}: {lamps:?}"
        );
        assert!(found.opacity() == expected.opacity() && found.albedo() == expected.albedo());
        assert!(found.color() == expected.color());
    }
}

#[test]
fn a_map_has_the_light_of_its_cells() {
    let folder = two_maps();
    let settings =
        || WorldSettings { halo: 16, ..WorldSettings::new(Settings::new(Holographic::default())) };
    let two = folder.open("two.world").unwrap();
    let cells = two.all_cells().unwrap();
    let from_files = World::new(&two, settings(), |_, _| ()).unwrap();
    let from_memory = World::new(&cells, settings(), |_, _| ()).unwrap();
    let mut brightest = 0.0f32;
    for window in from_files.tiles(64).unwrap() {
        let [files, memory] = [&from_files, &from_memory].map(|world| world.light(window).unwrap());
        assert!(files.pixels() == memory.pixels(), "{window:?}");
        brightest = files.pixels().as_flattened().iter().fold(brightest, |most, &v| most.max(v));
    }
    assert!(brightest > 0.1, "{brightest}");
}

#[test]
fn maps_are_read_when_a_window_needs_them() {
    let folder = two_maps();
    folder.write("left.tmx", "no map");
    let world = r#"{ "maps": [{ "fileName": "right.tmx", "x": 2000, "y": 0, "width": 80, "height": 80 },
        { "fileName": "left.tmx", "x": 0, "y": 0, "width": 80, "height": 80 }] }"#;
    let two = folder.write("far.world", world).open("far.world").unwrap();
    let window = |x: u32| GridWindow { first: [x, 0], size: [60, 60] };
    assert!(two.cells(window(2010)).is_ok());
    // A lamp there would reach this far.
    assert!(two.cells(window(500)).is_err());
    let between = two.cells(window(1000)).unwrap();
    assert!(between.opacity().iter().all(|&v| v == 0.0) && between.color().unwrap()[0] == [0.0; 3]);
}

#[test]
fn larger_tiles_stand_on_their_cell_and_images_may_be_one_per_tile() {
    let folder = Folder::new();
    let tree = RgbaImage::from_fn(6, 7, |x, y| Rgba([20 * x as u8, 30 * y as u8, 9, 255]));
    folder.image("tree.png", &tree);
    let set = "<tileset firstgid=\"5\" name=\"trees\" tilewidth=\"6\" tileheight=\"7\"><tile id=\"3\"><image \
               source=\"tree.png\"/></tile></tileset>";
    let layer = format!(
        "<layer name=\"a\" width=\"3\" height=\"3\"><data encoding=\"csv\">{}</data></layer>",
        csv(&[0, 0, 0, 0, 8, 0, 0, 0, 0])
    );
    folder.write("a.tmx", map_with("backgroundcolor=\"#336699\"", 3, 3, set.to_owned() + &layer));
    let world = folder.open("a.tmx").unwrap();
    let cells = world.all_cells().unwrap();
    let expected = |x: u32, y: u32| match (x.checked_sub(4), y.checked_sub(1)) {
        (Some(u), Some(v)) if u < 6 && v < 7 => linear(tree.get_pixel(u, v)),
        _ => [0x33, 0x66, 0x99].map(srgb::decode_u8),
    };
    for (x, y) in (0..12).flat_map(|y| (0..12).map(move |x| (x, y))) {
        assert_eq!(cells.color().unwrap()[cells.index(x, y)], expected(x, y), "({x}, {y})");
    }
    // A window that does not have the tile's cell has what reaches into it.
    let window = GridWindow { first: [8, 0], size: [4, 4] };
    assert_eq!(world.cells(window).unwrap().color(), cells.window(window).unwrap().color());
}

#[test]
fn the_example_of_the_guide_is_lit_as_it_says() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/maps/tavern.tmx");
    let cells = MapWorld::open(path).unwrap().all_cells().unwrap();
    let at = |column: u32, row: u32| cells.get(16 * column + 7, 16 * row + 5).unwrap();
    assert_eq!((at(0, 0).opacity, at(4, 5).opacity, at(12, 3).opacity), (1.0, 0.0, 0.0));
    assert!(at(4, 5).glow[0] > 1.0 && at(12, 3).tint[0] < 1.0 && at(0, 0).albedo[0] > 0.1);
    assert_eq!((cells.lamps().len(), cells.sky().is_black()), (1, false));
}

#[test]
fn errors_name_the_file_the_line_and_the_remedy() {
    let folder = Folder::new();
    let of = |text: String| {
        folder.write("a.tmx", text);
        folder.error("a.tmx")
    };
    let whole = |more: &str, gids: &[u32]| {
        map(gids.len() as u32, 1, TILESET.to_owned() + &layer("floor", more, gids))
    };
    let good = whole("", &[1, 2]);
    let cases: [(String, &[&str]); 15] = [
        ("no map".into(), &["a.tmx", "not XML"]),
        ("<tileset/>".into(), &["a.tmx", "<tileset>", "must be <map>"]),
        (good.replace("orthogonal", "isometric"), &["a.tmx", "line 2", "isometric", "orthogonal"]),
        (
            good.replace(" tilewidth=\"4\" tileheight=\"4\" >", ">"),
            &["line 2", "map.tilewidth", "missing"],
        ),
        (
            good.replace("height=\"1\" tilewidth", "height=\"-1\" tilewidth"),
            &["map.height", "\"-1\"", "whole number"],
        ),
        (good.replacen("width=\"2\"", "width=\"70000\"", 1), &["line 2", "280000×4", "65536"]),
        (good.replace("1,2", "1,2,3"), &["line 3", "3 cells", "2, for 2×1"]),
        (good.replace("1,2", "1,x"), &["line 3", "`data`", "commas"]),
        (
            good.replace("\"csv\"", "\"base64\" compression=\"zstd\""),
            &["zstd", "Tile Layer Format"],
        ),
        (good.replace("\"csv\"", "\"base64\" compression=\"zlib\""), &["data", "Base64"]),
        (good.replace("1,2", "1,99"), &["layer \"floor\"", "number 99", "no tileset"]),
        (good.replace("tiles.png", "gone.png"), &["a.tmx", "tileset \"art\"", "gone.png"]),
        (
            good.replace("columns=\"4\"", "columns=\"2\"").replace("1,2", "1,7"),
            &["tileset \"art\"", "16×8 px", "tiles.png"],
        ),
        (
            whole(&properties(&[("light", "wall")]), &[1]),
            &["line 3", "layer \"floor\"", "`light`", "walls"],
        ),
        (
            map(
                1,
                1,
                format!(
                    "<objectgroup><object id=\"7\" type=\"lamp\">{}</object></objectgroup>",
                    properties(&[("size", "0")])
                ),
            ),
            &["a.tmx", "object 7", "lamp.size", "0.05"],
        ),
    ];
    for (text, words) in cases {
        let message = of(text);
        assert!(
            words.iter().all(|words| message.contains(words)),
            "{message}\nlacks one of {words:?}"
        );
    }
    for (name, text, words) in [
        ("a.world", "{", "not a world of Tiled"),
        ("a.world", "[[]]", "line 1: `world` is a list, but must be a table"),
        (
            "a.world",
            "{ \"maps\": [{ \"fileName\": \"a.tmx\", \"x\": 0.5 }] }",
            "a.world: it is not a world of Tiled: line 1: `maps[0].x` is 0.5, but must be a whole number",
        ),
        ("a.world", "{ \"maps\": [] }", "has no map"),
        ("a.world", "{ \"patterns\": [{}] }", "list them under `maps`"),
        (
            "a.world",
            "{ \"maps\": [{ \"fileName\": \"gone.tmx\" }] }",
            "a.world: cannot read gone.tmx: ",
        ),
        ("a.map", "", ".tmx"),
    ] {
        folder.write(name, text);
        let message = folder.error(name);
        assert!(message.contains(name) || message.contains("gone"), "{message}");
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn files_cut_short_or_changed_anywhere_are_errors_and_no_panic() {
    let folder = Folder::new();
    let text =
        map(2, 1, TILESET.to_owned() + &layer("a", &properties(&[("emission", "6")]), &[1, 2]));
    let random = &mut seeded(11);
    for length in 0..text.len() {
        folder.write("a.tmx", &text[..length]);
        assert!(folder.open("a.tmx").is_err(), "{length}");
    }
    // An infinite map with a tileset whose columns have to be found out, and deep groups.
    let groups = "<group>".repeat(100_000);
    folder.write("a.tmx", map(2, 1, groups.clone() + &groups.replace('<', "</")));
    assert!(folder.error("a.tmx").contains("64 groups"));
    let chunks = "<chunk x=\"-2\" y=\"0\" width=\"2\" height=\"1\">1,2</chunk>";
    let infinite = text
        .replace("height=\"1\" tilewidth", "height=\"1\" infinite=\"1\" tilewidth")
        .replace("1,2", chunks)
        .replace("tilecount=\"8\" columns=\"4\"", "margin=\"0\" spacing=\"0\" tilecount=\"8\"");
    let texts = [text.clone(), infinite];
    for (text, number) in
        texts.iter().flat_map(|text| numbers(text).into_iter().map(move |at| (text, at)))
    {
        for other in
            ["0", "1", "-1", "65537", "1048577", "4294967295", "18446744073709551615", "1e30", "x"]
        {
            let changed = [&text[..number.start], other, &text[number.end..]].concat();
            folder.write("a.tmx", &changed);
            draw(&folder);
        }
    }
    for _ in 0..2000 {
        let mut bytes = text.clone().into_bytes();
        let at = random.usize(..bytes.len());
        bytes[at] = random.u8(32..127);
        folder.write("a.tmx", String::from_utf8(bytes).unwrap());
        draw(&folder);
    }
}

/// Opens the file and draws a corner of it, whatever comes of it.
fn draw(folder: &Folder) {
    let corner = GridWindow { first: [0, 0], size: [1, 1] };
    let _ = folder.open("a.tmx").and_then(|map| map.cells(corner));
}

#[test]
fn all_files_of_a_world_are_known_before_its_maps_are_drawn() {
    let folder = Folder::new();
    let tileset = TILESET.replacen(" firstgid=\"1\"", "", 1);
    folder
        .write("art.tsx", tileset)
        .write("spot.tx", "<template><object type=\"lamp\"/></template>");
    let body = "<tileset firstgid=\"1\" source=\"art.tsx\"/><objectgroup>\
                <object id=\"1\" template=\"spot.tx\" x=\"1\" y=\"1\"/></objectgroup>";
    folder.write("a.tmx", map(2, 1, "")).write("b.tmx", map(2, 1, body));
    let entry = |name: &str, x: u32| {
        format!(r#"{{ "fileName": "{name}.tmx", "x": {x}, "y": 0, "width": 8, "height": 4 }}"#)
    };
    folder.write("w.world", format!(r#"{{ "maps": [{}, {}] }}"#, entry("a", 0), entry("b", 8)));
    let files = folder.open("w.world").unwrap().files().unwrap();
    let names: Vec<_> = files.iter().map(|file| file.file_name().unwrap()).collect();
    assert_eq!(names, ["w.world", "a.tmx", "b.tmx", "art.tsx", "spot.tx", "tiles.png"]);
}
