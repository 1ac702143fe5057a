//! The scene reader under random input: no panic, no hang. (`fuzz/` has the same for cargo-fuzz.)
//!
//! proptest prints the smallest input that fails, which is all that a repetition needs.

use lamplight::scene::SceneSky;
use lamplight::{Cookie, CookiePicture, Scene, Shape};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};
use toml::{Table, Value};

/// Longest that one of these short texts may take, a hundred times what they do take.
const PATIENCE: Duration = Duration::from_secs(5);
/// The largest grid that is made from a parsed scene.
const SMALL: u32 = 64;

const WHOLE: &str = include_str!("scene_whole.toml");
const STARTER: &str = include_str!("../../../lamplight-cli/src/starter.toml");

/// Reads a text both ways; makes a grid of it where it is a small scene; checks that what was read
/// is written and read again. Returns whether it was a scene.
fn read(text: &str) -> bool {
    let start = Instant::now();
    let mut scenes = 0;
    for scene in [Scene::from_toml(text), Scene::from_json(text)] {
        let Ok(mut scene) = scene else { continue };
        scenes += 1;
        let again = Scene::from_toml(&scene.to_toml().unwrap()).unwrap();
        assert_eq!(again, scene);
        // Random paths would read what happens to lie there.
        scene.layers = Default::default();
        if matches!(scene.sky, SceneSky::Picture(_)) {
            scene.sky = SceneSky::default();
        }
        for lamp in &mut scene.lamps {
            let is_file = |cookie: &Cookie| matches!(cookie.picture, CookiePicture::File(_));
            lamp.cookie = lamp.cookie.take().filter(|cookie| !is_file(cookie));
        }
        scene.shapes.retain(|s| !matches!(s.geometry, lamplight::scene::Geometry::Sprite(_)));
        scene.size = scene.size.map(|side| side.min(SMALL));
        let cells = scene.cells().unwrap();
        scene.warnings(&cells);
        cells.check().unwrap();
        cells.drawn().check().unwrap();
    }
    assert!(start.elapsed() < PATIENCE, "{:?}", start.elapsed());
    scenes > 0
}

/// Something that stands, or might be thought to stand, in a scene file.
fn key() -> impl Strategy<Value = String> {
    const KEYS: [&str; 36] = [
        "size",
        "sky",
        "zenith",
        "horizon",
        "ground",
        "columns",
        "picture",
        "turn",
        "layers",
        "emission",
        "emission_scale",
        "opacity",
        "albedo",
        "tint",
        "color",
        "shape",
        "circle",
        "rect",
        "polygon",
        "line",
        "center",
        "radius",
        "min",
        "max",
        "points",
        "from",
        "to",
        "width",
        "rotation",
        "antialias",
        "lamp",
        "position",
        "light",
        "raymarch",
        "rays",
        "display",
    ];
    prop_oneof![9 => prop::sample::select(&KEYS[..]).prop_map(str::to_owned), 1 => ".{0,6}"]
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -2.0..40.0,
        2 => prop::sample::select(vec![
            0.0, -0.0, 1.0, f64::NAN, f64::INFINITY, -1e300, 1e12, 1e6, 1e-30, 0.5, -1e6,
        ]),
        1 => any::<f64>(),
    ]
}

fn value() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        4 => number().prop_map(Value::Float),
        2 => (-3i64..70).prop_map(Value::Integer),
        1 => any::<i64>().prop_map(Value::Integer),
        1 => any::<bool>().prop_map(Value::Boolean),
        1 => ".{0,8}".prop_map(Value::String),
        4 => prop::collection::vec(number().prop_map(Value::Float), 2..4).prop_map(Value::Array),
    ];
    leaf.prop_recursive(4, 40, 5, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..4).prop_map(Value::Array),
            prop::collection::vec((key(), inner), 0..5)
                .prop_map(|entries| Value::Table(Table::from_iter(entries))),
        ]
    })
}

/// Replaces some values of a tree, each named by its place in a walk through it.
fn replace(node: &mut Value, place: &mut usize, changes: &mut BTreeMap<usize, Value>) {
    *place += 1;
    if let Some(value) = changes.remove(place) {
        *node = value;
        return;
    }
    match node {
        Value::Array(list) => list.iter_mut().for_each(|node| replace(node, place, changes)),
        Value::Table(table) => {
            table.iter_mut().for_each(|(_, node)| replace(node, place, changes));
        }
        _ => {}
    }
}

fn mutated(text: &'static str) -> impl Strategy<Value = String> {
    let edit = (any::<prop::sample::Index>(), 0usize..12, prop::collection::vec(any::<u8>(), 0..4));
    let edits = prop::collection::vec((edit, any::<prop::sample::Index>(), 0..3u8), 1..6);
    edits.prop_map(move |edits| {
        let mut bytes = text.as_bytes().to_vec();
        for ((at, length, new), from, kind) in edits {
            let at = at.index(bytes.len() + 1);
            let end = (at + length).min(bytes.len());
            match kind {
                0 => drop(bytes.splice(at..end, new)),
                1 => drop(bytes.drain(at..end)),
                _ => {
                    // A piece from elsewhere in the file.
                    let from = from.index(bytes.len() + 1);
                    let piece = bytes[from..(from + 4 * length).min(bytes.len())].to_vec();
                    drop(bytes.splice(at..end, piece));
                }
            }
        }
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 400,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        read(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn random_punctuation(text in "[\\[\\]{}=,.\"'#\\\\ \n\ra-c0-9+-]{0,200}") {
        read(&text);
    }

    #[test]
    fn mutated_scenes(text in prop_oneof![mutated(WHOLE), mutated(STARTER)]) {
        read(&text);
    }

    #[test]
    fn random_trees(entries in prop::collection::vec((key(), value()), 0..8)) {
        let table = Table::from_iter(entries);
        read(&toml::to_string(&table).unwrap());
        read(&serde_json::to_string(&table).unwrap());
    }

    #[test]
    fn scenes_with_values_replaced(
        mut changes in prop::collection::btree_map(2usize..140, value(), 1..4),
    ) {
        let mut scene = Value::Table(toml::from_str(WHOLE).unwrap());
        replace(&mut scene, &mut 0, &mut changes);
        read(&toml::to_string(&scene).unwrap());
    }

    #[test]
    fn shapes_of_any_numbers(
        numbers in prop::array::uniform8(any::<f32>()),
        kind in 0..4u8,
        antialias in any::<Option<bool>>(),
    ) {
        let [a, b, c, d, e, f, rotation, opacity] = numbers;
        let shape = match kind {
            0 => Shape::circle([a, b], c),
            1 => Shape::rect([a, b], [c, d]),
            2 => Shape::polygon([[a, b], [c, d], [e, f]]),
            _ => Shape::line([a, b], [c, d], e),
        };
        let shape = Shape { antialias, ..shape.rotation(rotation).opacity(opacity) };
        // Refused or drawn; what is drawn is matter.
        if let Ok(cells) = Scene::new(16, 16).shape(shape).cells() {
            cells.check().unwrap();
        }
    }
}

#[test]
fn the_fuzz_reader_accepts_valid_scenes() {
    assert!(read(WHOLE) && read(STARTER));
    assert!(!read("size = [0, 0]") && !read(""));
    assert!(!Path::new("tree.png").exists(), "paths of the scenes here lead nowhere");
}
