//! The canvas: undo and redo to the bit, bounded history, files in and out.

#[allow(dead_code)]
mod common;

use common::{hash, range, seeded};
use fastrand::Rng;
use image::{ImageFormat, RgbaImage};
use lamplight::{Cells, Lamp, Scene, Sky, UP};
use lamplight_sandbox::canvas::{As, Brush, Canvas, Stuff, Tool, plain_name};
use std::io::Cursor;

const SIZE: [u32; 2] = [48, 32];

fn stuff(rng: &mut Rng) -> Stuff {
    let rgb = [0, 1, 2].map(|_| range(rng, -0.2, 1.4));
    match rng.usize(..6) {
        0 => Stuff::Wall(rgb),
        1 => Stuff::Glass(rgb),
        2 => Stuff::Fog(range(rng, -0.5, 1.5), rgb),
        3 => Stuff::Glow(rgb.map(|v| v * 20.0)),
        4 => Stuff::Backdrop(rgb),
        _ => Stuff::Erase,
    }
}

/// An edit by rng, of those that there are.
fn edit(canvas: &mut Canvas, rng: &mut Rng) {
    let at = |rng: &mut Rng| [range(rng, -10.0, 58.0), range(rng, -10.0, 42.0)];
    let brush = Brush { stuff: stuff(rng), radius: range(rng, 0.0, 6.0) };
    match rng.usize(..9) {
        0 => {
            let points: Vec<_> = (0..rng.usize(..6)).map(|_| at(rng)).collect();
            canvas.stroke(brush, &points);
        }
        1 => canvas.line(brush, at(rng), at(rng)),
        2 => canvas.rectangle(brush, at(rng), at(rng), rng.bool()),
        3 => canvas.fill(brush.stuff, at(rng)),
        4 => drop(canvas.add_lamp(Lamp { position: at(rng), ..Lamp::default() })),
        5 if !canvas.lamps().is_empty() => {
            let lamp = rng.usize(..canvas.lamps().len());
            canvas.begin();
            (0..4).for_each(|_| canvas.move_lamp(lamp, at(rng)).unwrap());
            canvas.end();
        }
        6 if !canvas.lamps().is_empty() => {
            canvas.remove_lamp(rng.usize(..canvas.lamps().len())).unwrap();
        }
        7 => canvas.set_sky(Sky::Uniform([range(rng, 0.0, 1.0); 3])).unwrap(),
        _ if rng.usize(..8) == 0 => canvas.clear(),
        _ => canvas.stroke(brush, &[at(rng)]),
    }
}

/// Everything that an edit may change, to the bit.
fn state(canvas: &Canvas) -> (u64, Sky, Vec<Lamp>, u64) {
    // Erasing all brings the backdrop to light.
    let mut bare = canvas.clone();
    bare.clear();
    (
        hash(canvas.cells()),
        canvas.cells().sky().clone(),
        canvas.lamps().to_vec(),
        hash(bare.cells()),
    )
}

#[test]
fn undo_and_redo_go_back_and_forth_to_the_bit() {
    let mut rng = seeded("undo_and_redo_go_back_and_forth_to_the_bit");
    for _ in 0..6 {
        let mut canvas = Canvas::new(SIZE).unwrap();
        let mut states = vec![state(&canvas)];
        for _ in 0..60 {
            edit(&mut canvas, &mut rng);
            canvas.cells().check().unwrap();
            if state(&canvas) != *states.last().unwrap() {
                states.push(state(&canvas));
            }
            assert_eq!(canvas.history_depth(), [states.len() - 1, 0], "an edit is one entry");
        }
        assert!(states.len() > 20, "hardly any edit changed anything");
        for _ in 0..3 {
            for before in states.iter().rev().skip(1) {
                assert!(canvas.undo());
                assert!(state(&canvas) == *before, "undo");
            }
            assert!(!canvas.undo());
            for after in &states[1..] {
                assert!(canvas.redo());
                assert!(state(&canvas) == *after, "redo");
            }
            assert!(!canvas.redo());
        }
        // A new edit forgets what was undone.
        canvas.undo();
        canvas.set_sky(Sky::Uniform([7.0; 3])).unwrap();
        assert!(!canvas.redo());
    }
}

#[test]
fn the_comparison_sees_every_field() {
    let canvas = Canvas::new(SIZE).unwrap();
    let changes: [fn(&mut Canvas); 4] = [
        |c| c.fill(Stuff::Backdrop([0.1; 3]), [1.0, 1.0]),
        |c| c.stroke(Brush { stuff: Stuff::Fog(0.001, [0.5; 3]), radius: 0.5 }, &[[3.0, 3.0]]),
        |c| drop(c.add_lamp(Lamp::default())),
        |c| c.set_sky(Sky::Uniform([1e-9; 3])).unwrap(),
    ];
    for (i, change) in changes.iter().enumerate() {
        let mut other = canvas.clone();
        change(&mut other);
        assert!(state(&other) != state(&canvas), "change {i}");
    }
}

#[test]
fn history_stays_within_its_bound() {
    let mut rng = seeded("history_stays_within_its_bound");
    let mut canvas = Canvas::new(SIZE).unwrap();
    const LIMIT: usize = 20_000;
    canvas.set_history_limit(LIMIT);
    let mut most = 0;
    for _ in 0..400 {
        match rng.usize(..5) {
            0 => drop(canvas.undo()),
            1 => drop(canvas.redo()),
            _ => edit(&mut canvas, &mut rng),
        }
        most = most.max(canvas.history_bytes());
        assert!(canvas.history_bytes() <= LIMIT, "{}", canvas.history_bytes());
    }
    assert!(most > LIMIT / 2, "the bound was never near: {most}");
    canvas.set_history_limit(0);
    assert_eq!((canvas.history_bytes(), canvas.history_depth()), (0, [0, 0]));
    // Whole edits fit where nothing else is said, and cost little where cells are alike.
    let mut large = Canvas::new([640, 360]).unwrap();
    large.fill(Stuff::Glow([3.0, 2.0, 1.0]), [5.0, 5.0]);
    assert!(large.undo() && large.redo());
    assert!(large.history_bytes() < 1000, "{}", large.history_bytes());
}

#[test]
fn tools_paint_the_cells_that_they_should() {
    let mut canvas = Canvas::new([12, 8]).unwrap();
    let brush = Brush { stuff: Stuff::Wall([0.5; 3]), radius: 0.5 };
    let solid = |canvas: &Canvas| canvas.cells().opacity().iter().filter(|&&o| o == 1.0).count();
    canvas.stroke(brush, &[[2.2, 3.9]]);
    assert_eq!((solid(&canvas), canvas.cells().get(2, 3).unwrap().opacity), (1, 1.0));
    canvas.undo();
    canvas.line(brush, [0.0, 0.0], [11.9, 5.0]);
    assert_eq!(solid(&canvas), 12, "a thin line has a cell a column");
    canvas.undo();
    canvas.rectangle(brush, [9.5, 6.5], [2.5, 1.5], true);
    assert_eq!(solid(&canvas), 8 * 6);
    canvas.undo();
    canvas.rectangle(brush, [2.5, 1.5], [9.5, 6.5], false);
    assert_eq!(solid(&canvas), 8 * 6 - 6 * 4);
    canvas.fill(Stuff::Wall([0.9, 0.1, 0.1]), [5.5, 3.5]);
    assert_eq!(solid(&canvas), 8 * 6, "the fill stays in the outline");
    assert_eq!(canvas.history_depth()[0], 2);
    // A rectangle that is dragged leaves only its last form; given up, it leaves nothing.
    let before = hash(canvas.cells());
    canvas.press(Tool::Rectangle { filled: true }, brush, [0.0, 0.0]);
    canvas.drag([11.0, 7.0]);
    canvas.drag([0.5, 0.5]);
    canvas.release();
    assert_eq!(solid(&canvas), 8 * 6 + 1);
    canvas.undo();
    canvas.press(Tool::Free, brush, [0.0, 0.0]);
    canvas.drag([11.0, 7.0]);
    canvas.cancel();
    assert_eq!(hash(canvas.cells()), before);
    // Coordinates that are not numbers paint nothing.
    canvas.stroke(brush, &[[f32::NAN, 1.0], [f32::INFINITY, 2.0], [1e30, -1e30]]);
    canvas.fill(Stuff::Erase, [-0.5, 3.0]);
    canvas.fill(Stuff::Erase, [3.0, 8.0]);
    assert_eq!(hash(canvas.cells()), before);
}

#[test]
fn lamps_are_found_checked_and_bounded() {
    let mut canvas = Canvas::new(SIZE).unwrap();
    canvas.add_lamp(Lamp { position: [10.0, 10.0], ..Lamp::default() }).unwrap();
    canvas.add_lamp(Lamp { position: [13.0, 10.0], ..Lamp::default() }).unwrap();
    assert_eq!(canvas.lamp_at([12.5, 10.0]), Some(1));
    assert_eq!(canvas.lamp_at([30.0, 10.0]), None);
    assert_eq!(canvas.lamp_at([f32::NAN, 10.0]), None);
    let bad = canvas.move_lamp(0, [f32::NAN, 0.0]).unwrap_err().to_string();
    assert!(bad.contains("lamp[0].position"), "{bad}");
    assert_eq!(canvas.move_lamp(2, [0.0; 2]).unwrap_err().to_string(), "there is no lamp 2");
    assert_eq!(canvas.remove_lamp(9).unwrap_err().to_string(), "there is no lamp 9");
    for _ in 2..Canvas::MAX_LAMPS {
        canvas.add_lamp(Lamp::default()).unwrap();
    }
    let error = canvas.add_lamp(Lamp::default()).unwrap_err().to_string();
    assert_eq!(error, "1025 lamps are too many: a canvas has at most 1024");
}

fn png(image: &RgbaImage) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A PNG whose header has this size, without pixels.
fn bomb(width: u32, height: u32) -> Vec<u8> {
    let mut head = b"IHDR".to_vec();
    head.extend(width.to_be_bytes());
    head.extend(height.to_be_bytes());
    head.extend([8, 6, 0, 0, 0]);
    let crc = !head.iter().fold(!0u32, |crc, &byte| {
        (0..8).fold(
            crc ^ u32::from(byte),
            |c, _| if c & 1 == 1 { c >> 1 ^ 0xedb8_8320 } else { c >> 1 },
        )
    });
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    bytes.extend(head);
    bytes.extend(crc.to_be_bytes());
    bytes.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e\0\0\0\0IEND\xae\x42\x60\x82");
    bytes
}

#[test]
fn images_are_scaled_down_with_a_word_and_junk_is_refused() {
    let mut rng = seeded("images_are_scaled_down_with_a_word_and_junk_is_refused");
    let mut canvas = Canvas::new(SIZE).unwrap();
    let large = RgbaImage::from_pixel(200, 100, image::Rgba([255, 0, 0, 255]));
    let word = canvas.place_image(&png(&large), As::Glow(4.0)).unwrap().unwrap();
    assert!(word.contains("200×100") && word.contains("48×24"), "{word}");
    let glowing = canvas.cells().emission().iter().filter(|e| **e == [4.0, 0.0, 0.0]).count();
    assert_eq!(glowing, 48 * 24);
    canvas.undo();
    let before = hash(canvas.cells());

    for (width, height) in [(10_000, 10_000), (4097, 4096), (u32::MAX >> 1, 1 << 20)] {
        let error = canvas.place_image(&bomb(width, height), As::Wall).unwrap_err().to_string();
        assert!(error.contains("px at most") || error.contains("cannot be read"), "{error}");
    }
    let error = canvas.place_image(&bomb(10_000, 10_000), As::Wall).unwrap_err().to_string();
    assert_eq!(error, "an image of 10000×10000 px is refused: it may have 16777216 px at most");

    let good = png(&large);
    assert!(canvas.place_image(&good[..good.len() / 2], As::Wall).is_err(), "cut short");
    for bytes in [&b""[..], b"junk", b"\x89PNG\r\n\x1a\n", b"GIF89a\x01\0\x01\0\0\0\0"] {
        let error = canvas.place_image(bytes, As::Wall).unwrap_err().to_string();
        assert!(error.contains("a PNG is needed"), "{error}");
    }
    assert_eq!(hash(canvas.cells()), before, "what is refused paints nothing");
    for _ in 0..300 {
        let mut bytes = good.clone();
        for _ in 0..=rng.usize(..6) {
            let at = rng.usize(..bytes.len());
            bytes[at] = rng.u8(..);
        }
        let _ = canvas.place_image(&bytes, As::Glass);
    }
}

#[test]
fn what_is_saved_and_read_again_is_the_same() {
    let mut rng = seeded("what_is_saved_and_read_again_is_the_same");
    let folder = tempfile::tempdir().unwrap();
    let mut saved = vec![Canvas::welcome([160, 90]).unwrap(), Canvas::new(SIZE).unwrap()];
    for _ in 0..8 {
        let mut canvas = Canvas::new(SIZE).unwrap();
        (0..40).for_each(|_| edit(&mut canvas, &mut rng));
        saved.push(canvas);
    }
    for (i, canvas) in saved.iter().enumerate() {
        let files = canvas.save(&format!("my ../picture{i}")).unwrap();
        assert_eq!(files[0].0, format!("mypicture{i}.toml"));
        let text = String::from_utf8(files[0].1.clone()).unwrap();
        let again = Canvas::from_scene(&text, &files[1..]).unwrap();
        assert!(again.cells() == canvas.cells(), "{i}: from bytes");
        assert_eq!(again.look(), canvas.look(), "{i}");

        for (name, bytes) in &files {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        }
        let scene = Scene::load(folder.path().join(&files[0].0)).unwrap();
        let cells = scene.cells().unwrap();
        assert!(cells == *canvas.cells(), "{i}: from files");
        // And another canvas is not the same.
        assert!(cells != *saved[(i + 1) % saved.len()].cells(), "{i}");
    }
}

/// A scene with normals, masks and a sun, as its author wrote it.
fn lit_by_a_sun() -> Canvas {
    let map = RgbaImage::from_fn(6, 4, |x, y| {
        image::Rgba([88 + x as u8 * 20, 128, 200, 255 - y as u8 % 2])
    });
    let masks = RgbaImage::from_fn(6, 4, |x, _| {
        let mask = 1 + x as u8;
        image::Rgba([mask, mask, mask, 255])
    });
    let text = "size = [6, 4]\n[layers]\nnormal = \"n.png\"\nmask = \"m.png\"\n[[sun]]\ndirection = \"30deg\"";
    let files = [("n.png".to_owned(), png(&map)), ("m.png".to_owned(), png(&masks))];
    Canvas::from_scene(text, &files).unwrap()
}

#[test]
fn suns_masks_and_normals_are_saved() {
    /// Rounding of the encoding in a file and of the length.
    const ROUNDING: f32 = 1e-6;
    let canvas = lit_by_a_sun();
    let cells = canvas.cells();
    let files = canvas.save("a").unwrap();
    let again = Canvas::from_scene(str::from_utf8(&files[0].1).unwrap(), &files[1..]).unwrap();
    assert_eq!((again.cells().suns(), again.cells().masks()), (cells.suns(), cells.masks()));
    assert_eq!(cells.suns().len(), 1);
    assert!(cells.masks().unwrap().contains(&6));
    let apart = |canvas: &Canvas| {
        let [a, b] = [canvas.cells(), cells].map(|cells| cells.normals().unwrap().as_flattened());
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    assert!(apart(&again) < ROUNDING, "{}", apart(&again));
    let mut other = again.clone();
    other.stroke(Brush { stuff: Stuff::Wall([0.5; 3]), radius: 0.5 }, &[[1.0, 1.0]]);
    assert!(apart(&other) > ROUNDING, "a flat wall passes for a tilted one");
}

#[test]
fn walls_are_flat_and_erasing_them_brings_the_normals_back() {
    let mut canvas = lit_by_a_sun();
    let before = canvas.cells().normals().unwrap().to_vec();
    let paint =
        |canvas: &mut Canvas, stuff| canvas.stroke(Brush { stuff, radius: 9.0 }, &[[3.0, 2.0]]);
    paint(&mut canvas, Stuff::Wall([0.5; 3]));
    assert_eq!(canvas.cells().normals().unwrap(), [UP; 24]);
    for stuff in [Stuff::Erase, Stuff::Glass([0.5; 3]), Stuff::Fog(0.1, [0.5; 3])] {
        paint(&mut canvas, stuff);
        assert_eq!(canvas.cells().normals().unwrap(), before, "{stuff:?}");
    }
    (0..4).for_each(|_| assert!(canvas.undo()));
    assert_eq!(canvas.cells().normals().unwrap(), before);
}

#[test]
fn names_of_files_are_valid_on_every_system() {
    for (given, name) in [
        ("../a b.c", "abc"),
        ("", "canvas"),
        ("ü", "canvas"),
        ("con", "con_"),
        ("Lpt1", "Lpt1_"),
        ("com", "com"),
        ("console", "console"),
    ] {
        assert_eq!(plain_name(given), name);
    }
}

#[test]
fn what_eight_bits_say_is_saved_as_png() {
    let mut canvas = Canvas::new(SIZE).unwrap();
    canvas.fill(Stuff::Backdrop([1.0, 0.0, 0.0]), [0.0, 0.0]);
    canvas.stroke(Brush { stuff: Stuff::Wall([0.0, 1.0, 0.0]), radius: 3.0 }, &[[9.0, 9.0]]);
    let names = |canvas: &Canvas| {
        canvas.save("a").unwrap().into_iter().map(|(name, _)| name).collect::<Vec<_>>()
    };
    assert_eq!(names(&canvas), ["a.toml", "a-opacity.png", "a-albedo.png", "a-color.png"]);
    canvas.stroke(Brush { stuff: Stuff::Glow([9.0, 1.0, 0.5]), radius: 1.0 }, &[[20.0, 9.0]]);
    assert!(names(&canvas).contains(&"a-emission.exr".to_owned()));
}

#[test]
fn scenes_that_are_not_are_refused() {
    let refuse = |text: &str, files: &[(String, Vec<u8>)]| {
        Canvas::from_scene(text, files).err().map(|e| e.to_string()).unwrap_or_default()
    };
    assert!(refuse("not a scene", &[]).contains("line 1"));
    assert!(
        refuse("size = [16000, 1000]", &[]).contains("cells are too many: a canvas has at most")
    );
    assert!(refuse("size = [99999999, 3]", &[]).contains("refused"));
    let large = Scene::new(4096, 4096);
    let refused = Canvas::of_scene(&large, |_| panic!("16 million cells are drawn first"));
    assert!(refused.unwrap_err().to_string().contains("cells are too many: a canvas has at most"));
    let layers = "size = [4, 4]\n[layers]\nopacity = \"o.png\"";
    assert!(refuse(layers, &[]).contains("not among the files"), "{}", refuse(layers, &[]));
    let absolute = "size = [4, 4]\n[layers]\nopacity = \"/etc/hostname\"";
    assert!(refuse(absolute, &[]).contains("not among the files"), "nothing is read from disk");
    let small = png(&RgbaImage::new(2, 2));
    assert!(refuse(layers, &[("o.png".into(), small)]).contains("4×4 px"));
    assert!(refuse(layers, &[("o.png".into(), b"junk".to_vec())]).contains("o.png"));
    assert!(Canvas::from_scene("{\"size\": [4, 4]}", &[]).is_ok());
    let shape = "size = [8, 8]\n[[shape]]\ncircle = { center = [4, 4], radius = 2 }";
    let canvas = Canvas::from_scene(shape, &[]).unwrap();
    assert_eq!(canvas.cells().get(4, 4).unwrap().opacity, 1.0);
}

#[test]
fn sizes_beyond_a_canvas_are_refused() {
    for size in [[0, 5], [4000, 3000], [u32::MAX, 1]] {
        assert!(Canvas::new(size).is_err(), "{size:?}");
        assert!(Canvas::welcome(size).is_err(), "{size:?}");
    }
    for size in [[1, 1], [1, 300], [320, 180], [97, 61]] {
        let canvas = Canvas::welcome(size).unwrap();
        canvas.cells().check().unwrap();
        assert_eq!(
            canvas.cells(),
            Canvas::of(Cells::clone(canvas.cells()), canvas.look()).unwrap().cells()
        );
    }
}
