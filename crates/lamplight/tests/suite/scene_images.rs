//! Layers and sprites: the meaning of their images, and the messages for invalid images.

use image::{DynamicImage, Luma, LumaA, Rgb, Rgb32FImage, Rgba, RgbaImage};
use lamplight::{Cells, Panorama, Scene, Shape, srgb};
use std::path::Path;
use tempfile::TempDir;

/// A folder with a scene file in it.
struct Bench {
    folder: TempDir,
}

impl Bench {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn image(&self, name: &str, image: impl Into<DynamicImage>) -> &Self {
        image.into().save(self.folder.path().join(name)).unwrap();
        self
    }

    fn bytes(&self, name: &str, bytes: &[u8]) -> &Self {
        std::fs::write(self.folder.path().join(name), bytes).unwrap();
        self
    }

    fn cells(&self, scene: &str) -> Result<Cells, String> {
        let path = self.folder.path().join("scene.toml");
        std::fs::write(&path, scene).unwrap();
        let folder = format!("{}/", self.folder.path().display());
        let cells = Scene::load(&path).and_then(|scene| scene.cells());
        cells.map_err(|e| e.to_string().replace(&folder, ""))
    }
}

/// Two px, side by side.
fn pair(left: [u8; 4], right: [u8; 4]) -> RgbaImage {
    RgbaImage::from_fn(2, 1, |x, _| Rgba(if x == 0 { left } else { right }))
}

const CLEAR: [u8; 4] = [255, 255, 255, 0];

#[test]
fn layers_fill_their_fields() {
    let bench = Bench::new();
    bench
        .image("e.png", pair([255, 128, 0, 255], CLEAR))
        .image("o.png", pair([51, 51, 51, 255], [255, 255, 255, 255]))
        .image("a.png", pair([128, 255, 0, 255], CLEAR))
        .image("t.png", pair([51, 102, 255, 255], CLEAR))
        .image("c.png", pair([255, 128, 0, 255], CLEAR));
    let layers = "size = [2, 1]\n[layers]\nemission = \"e.png\"\nemission_scale = 6\nopacity = \
                  \"o.png\"\nalbedo = \"a.png\"\ntint = \"t.png\"";
    let cells = bench.cells(layers).unwrap();
    let half = srgb::decode_u8(128);
    let (left, right) = (cells.get(0, 0).unwrap(), cells.get(1, 0).unwrap());
    assert_eq!(left.emission, [6.0, half * 6.0, 0.0]);
    assert_eq!(left.opacity, 0.2);
    assert_eq!(left.albedo, [half, 1.0, 0.0]);
    assert_eq!(left.tint, [0.2, 0.4, 1.0]);
    // Fully transparent pixels of a layer are ignored.
    assert_eq!((right.emission, right.albedo, right.tint), ([0.0; 3], [0.0; 3], [1.0; 3]));
    assert_eq!(right.opacity, 1.0);
    // The picture is the albedo, unless there is a layer for it.
    assert_eq!(cells.color().unwrap(), [[half, 1.0, 0.0], [1.0; 3]]);
    let cells = bench.cells(&format!("{layers}\ncolor = \"c.png\"")).unwrap();
    assert_eq!(cells.color().unwrap(), [[1.0, half, 0.0], [1.0; 3]]);
    assert!(bench.cells("size = [2, 1]").unwrap().color().is_none());
}

#[test]
fn without_an_opacity_layer_emissive_cells_are_solid() {
    let bench = Bench::new();
    bench.image("e.png", pair([0, 0, 9, 255], CLEAR)).image("o.png", pair([0; 4], [0; 4]));
    let cells = bench.cells("size = [2, 1]\nlayers = { emission = \"e.png\" }").unwrap();
    assert_eq!(cells.opacity(), [1.0, 0.0]);
    let with = "size = [2, 1]\nlayers = { emission = \"e.png\", opacity = \"o.png\" }";
    assert_eq!(bench.cells(with).unwrap().opacity(), [0.0, 0.0]);
}

#[test]
fn grey_and_16_bit_images_are_read_to_their_full_depth() {
    let bench = Bench::new();
    let grey16 = image::ImageBuffer::from_fn(2, 1, |x, _| Luma([if x == 0 { 257u16 } else { 1 }]));
    bench.image("o.png", grey16);
    let cells = bench.cells("size = [2, 1]\nlayers = { opacity = \"o.png\" }").unwrap();
    assert_eq!(cells.opacity(), [257.0 / 65535.0, 1.0 / 65535.0]);

    let word = image::ImageBuffer::from_fn(2, 1, |x, _| Rgb([x as u16 * 30_000, 65_535, 7]));
    bench.image("e.png", word);
    let cells = bench.cells("size = [2, 1]\nlayers = { emission = \"e.png\" }").unwrap();
    let decoded = [30_000.0, 65_535.0, 7.0].map(|v: f32| srgb::decode(v / 65_535.0));
    assert_eq!(cells.emission()[1], decoded);

    let alpha = image::ImageBuffer::from_fn(2, 1, |x, _| LumaA([255u8, x as u8 * 255]));
    bench.image("o.png", alpha);
    let cells = bench.cells("size = [2, 1]\nlayers = { opacity = \"o.png\" }").unwrap();
    assert_eq!(cells.opacity(), [0.0, 1.0]);
}

#[test]
fn masks_are_bits_of_grey_and_shapes_replace_those_that_they_cover() {
    let bench = Bench::new();
    let image =
        |values: [[u8; 2]; 4]| image::ImageBuffer::from_fn(4, 1, |x, _| LumaA(values[x as usize]));
    bench.image("m.png", image([[1, 255], [6, 255], [255, 255], [2, 0]]));
    let layers = "size = [4, 1]\nlayers = { mask = \"m.png\" }";
    assert_eq!(bench.cells(layers).unwrap().masks().unwrap(), [1, 6, 255, 255]);
    // The first covers 60 % of a cell, and the next 40 % of another; the last is in all layers.
    let shapes = "\n[[shape]]\nrect = { min = [0, 0], max = [0.6, 1] }\nmask = 4\n\
                  [[shape]]\nrect = { min = [1, 0], max = [1.4, 1] }\nmask = 4\n\
                  [[shape]]\nrect = { min = [3, 0], max = [4, 1] }\nmask = 8\nopacity = 0\n";
    let shapes = |more: &str| bench.cells(&format!("{layers}{shapes}{more}"));
    assert_eq!(shapes("").unwrap().masks().unwrap(), [4, 6, 255, 8]);
    let over = "[[shape]]\nrect = { min = [0, 0], max = [4, 1] }\nopacity = 0.5\n";
    assert_eq!(shapes(over).unwrap().masks().unwrap(), [255; 4]);
    let plain = format!("size = [4, 1]\n{over}");
    assert!(bench.cells(&plain).unwrap().masks().is_none());
    let sprite = format!("{plain}sprite = {{ image = \"m.png\", center = [2, 0.5] }}\nmask = 16\n");
    let sprite = sprite.replace("rect = { min = [0, 0], max = [4, 1] }\n", "");
    assert_eq!(bench.cells(&sprite).unwrap().masks().unwrap(), [16, 16, 16, 255]);

    bench.image("m.png", image([[1, 255], [0, 255], [255, 255], [2, 255]]));
    assert_eq!(
        bench.cells(layers).unwrap_err(),
        "scene.toml: line 2: `layers.mask`: m.png: cell (1, 0): mask is 0, but must be a whole number \
         from 1 to 255"
    );
}

#[test]
fn exr_is_linear_as_it_is() {
    let bench = Bench::new();
    bench.image("e.exr", Rgb32FImage::from_fn(2, 1, |x, _| Rgb([0.25, 40.0, x as f32])));
    let scene = "size = [2, 1]\nlayers = { emission = \"e.exr\", emission_scale = 0.5 }";
    assert_eq!(bench.cells(scene).unwrap().emission(), [[0.125, 20.0, 0.0], [0.125, 20.0, 0.5]]);

    for (value, word) in [(f32::NAN, "NaN"), (-2.0, "-1"), (f32::INFINITY, "inf")] {
        let bad = |x, _| Rgb([if x == 0 { 0.0 } else { value }, 0.0, 0.0]);
        bench.image("e.exr", Rgb32FImage::from_fn(2, 1, bad));
        assert_eq!(
            bench.cells(scene).unwrap_err(),
            format!(
                "scene.toml: line 2: `layers.emission`: e.exr: cell (1, 0): emission is {word}, but must \
                 be 0 to 1e12"
            )
        );
    }
    bench.image("a.exr", Rgb32FImage::from_fn(2, 1, |_, _| Rgb([0.5, 1.5, 0.0])));
    assert_eq!(
        bench.cells("size = [2, 1]\nlayers = { albedo = \"a.exr\" }").unwrap_err(),
        "scene.toml: line 2: `layers.albedo`: a.exr: cell (0, 0): albedo is 1.5, but must be 0 to 1"
    );
    bench.image("n.exr", Rgb32FImage::from_fn(2, 1, |_, _| Rgb([f32::NAN, 0.5, 1.0])));
    assert_eq!(
        bench.cells("size = [2, 1]\nlayers = { normal = \"n.exr\" }").unwrap_err(),
        "scene.toml: line 2: `layers.normal`: n.exr: cell (0, 0): normal is NaN, but must be -1 to 1"
    );
}

#[test]
fn normals_of_an_exr_are_as_they_are() {
    let bench = Bench::new();
    let exr = |normal: [f32; 3]| {
        let pixel = |x, _| Rgb(if x == 0 { [0.0, 0.0, 1.0] } else { normal });
        bench.image("n.exr", Rgb32FImage::from_fn(2, 1, pixel));
    };
    let scene = "size = [2, 1]\nlayers = { normal = \"n.exr\" }";
    exr([-0.6, 0.0, 0.8]);
    assert_eq!(bench.cells(scene).unwrap().normals().unwrap(), [[0.0, 0.0, 1.0], [-0.6, 0.0, 0.8]]);
    // Green is up, and what was shortened by filters has unit length.
    exr([0.0, 0.3, 0.4]);
    assert_eq!(bench.cells(scene).unwrap().normals().unwrap()[1], [0.0, -0.6, 0.8]);
    for (normal, problem) in [
        ([0.0, f32::NAN, 1.0], "NaN, but must be -1 to 1"),
        ([0.0, 0.0, f32::INFINITY], "inf, but must be -1 to 1"),
        ([0.0, -1.5, 0.0], "-1.5, but must be -1 to 1"),
        ([0.0; 3], "0, but must be of a direction, such as (0, 0, 1)"),
    ] {
        exr(normal);
        assert_eq!(
            bench.cells(scene).unwrap_err(),
            format!("scene.toml: line 2: `layers.normal`: n.exr: cell (1, 0): normal is {problem}")
        );
    }
    bench.image("n.png", pair([128, 255, 128, 255], CLEAR));
    let cells = bench.cells(&scene.replace("exr", "png")).unwrap();
    assert_eq!(cells.normals().unwrap(), [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]);
}

/// Writes an EXR with one channel.
fn one_channel(bench: &Bench, name: &str, channel: &str, values: [f32; 2]) {
    use exr::prelude::*;
    let channel = AnyChannel::new(channel, FlatSamples::F32(values.to_vec()));
    let image = Image::from_channels((2, 1), AnyChannels::sort(SmallVec::from_iter([channel])));
    image.write().to_file(bench.folder.path().join(name)).unwrap();
}

#[test]
fn an_exr_of_one_channel_is_grey() {
    let bench = Bench::new();
    for channel in ["Y", "opacity"] {
        one_channel(&bench, "o.exr", channel, [0.25, 1.0]);
        let cells = bench.cells("size = [2, 1]\nlayers = { opacity = \"o.exr\" }").unwrap();
        assert_eq!(cells.opacity(), [0.25, 1.0]);
    }
    one_channel(&bench, "e.exr", "Y", [3.0, 0.0]);
    let cells = bench.cells("size = [2, 1]\nlayers = { emission = \"e.exr\" }").unwrap();
    assert_eq!(cells.emission(), [[3.0; 3], [0.0; 3]]);
    // Its size and values are checked as those of other images are.
    assert_eq!(
        bench.cells("size = [4, 4]\nlayers = { opacity = \"o.exr\" }").unwrap_err(),
        "scene.toml: line 2: `layers.opacity` is an image of 2×1 px (o.exr), but must be 4×4 px, the \
         size of the scene"
    );
    one_channel(&bench, "o.exr", "Y", [0.0, 1.5]);
    let error = bench.cells("size = [2, 1]\nlayers = { opacity = \"o.exr\" }").unwrap_err();
    assert!(error.contains("cell (1, 0): opacity is 1.5, but must be 0 to 1"), "{error}");
}

#[test]
fn webp_and_jpeg_are_read() {
    let bench = Bench::new();
    let picture = image::RgbImage::from_pixel(8, 8, Rgb([200, 100, 50]));
    for name in ["c.webp", "c.jpg"] {
        bench.image(name, picture.clone());
        let cells = bench.cells(&format!("size = [8, 8]\nlayers = {{ color = \"{name}\" }}"));
        let color = cells.unwrap().color().unwrap()[9];
        for (c, value) in [200u8, 100, 50].into_iter().enumerate() {
            // JPEG loses a few levels.
            let levels = (srgb::encode(color[c]) * 255.0 - f32::from(value)).abs();
            assert!(levels < 4.0, "{name}: {color:?}");
        }
    }
}

#[test]
fn an_image_that_is_cut_short_is_no_layer() {
    let bench = Bench::new();
    let noise = image::RgbImage::from_fn(40, 30, |x, y| Rgb([(x * 97 + y * 57) as u8, y as u8, 9]));
    for name in ["c.png", "c.jpg", "c.webp"] {
        bench.image(name, noise.clone());
    }
    bench.image("c.exr", DynamicImage::from(noise).into_rgb32f());
    // A thumbnail, which has an end of its own, and a 0xFF that fills up to a marker.
    let jpeg = std::fs::read(bench.folder.path().join("c.jpg")).unwrap();
    let thumbnail =
        [&[0xFF, 0xD8, 0xFF, 0xE1, 0, 6, 1, 1, 0xFF, 0xD9, 0xFF][..], &jpeg[2..]].concat();
    bench.bytes("t.jpg", &thumbnail);
    for name in ["c.png", "c.jpg", "t.jpg", "c.webp", "c.exr"] {
        let scene = format!("size = [40, 30]\nlayers = {{ emission = \"{name}\" }}");
        bench.cells(&scene).unwrap();
        let bytes = std::fs::read(bench.folder.path().join(name)).unwrap();
        // Other formats than JPEG show without their last bytes that all pixels are there.
        let end = if name.ends_with("jpg") { 1 } else { 16 };
        for kept in [bytes.len() / 2, bytes.len() / 4 * 3, bytes.len() - end] {
            bench.bytes(name, &bytes[..kept]);
            let error = bench.cells(&scene).err().unwrap_or_default();
            let expected = format!("scene.toml: line 2: `layers.emission`: cannot read {name}: ");
            assert!(error.starts_with(&expected), "{error}");
            let names_it = error.ends_with("the image is cut short");
            assert!(names_it || !name.ends_with("jpg"), "{kept} bytes: {error}");
        }
    }
}

/// 3×2 px: red, green, blue; then clear, half-clear white, grey.
fn sprite() -> RgbaImage {
    let row = |row: [[u8; 4]; 3]| row.into_iter().flatten();
    let bytes = row([[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]])
        .chain(row([CLEAR, [255, 255, 255, 102], [128, 128, 128, 255]]))
        .collect();
    RgbaImage::from_raw(3, 2, bytes).unwrap()
}

#[test]
fn sprites_cover_by_alpha_and_multiply_by_colour() {
    let bench = Bench::new();
    bench.image("s.png", sprite());
    let scene = "size = [5, 4]\n[[shape]]\nsprite = { image = \"s.png\", center = [2.5, 2] }\n\
                 emission = [2, 2, 2]\nalbedo = [0.5, 1, 1]";
    let cells = bench.cells(scene).unwrap();
    let at = |x, y| cells.get(x, y).unwrap();
    assert_eq!((at(1, 1).emission, at(1, 1).albedo), ([2.0, 0.0, 0.0], [0.5, 0.0, 0.0]));
    assert_eq!((at(3, 1).emission, at(3, 1).albedo), ([0.0, 0.0, 2.0], [0.0, 0.0, 1.0]));
    let opacity: Vec<f32> = (0..5).map(|x| at(x, 2).opacity).collect();
    assert_eq!(opacity, [0.0, 0.0, 0.0, 1.0, 0.0]);
    // The picture shows the image itself.
    let picture = cells.color().unwrap();
    assert_eq!(picture[cells.index(3, 2)], [srgb::decode_u8(128); 3]);
    assert_eq!(picture[cells.index(0, 0)], [1.0; 3]);

    let fog = bench.cells(&format!("{scene}\nopacity = 0.5")).unwrap();
    assert_eq!(fog.get(2, 2).unwrap().opacity, 0.4 * 0.5);
    let soft = bench.cells(&format!("{scene}\nantialias = true")).unwrap();
    let opacity: Vec<f32> = (0..5).map(|x| soft.get(x, 2).unwrap().opacity).collect();
    assert_eq!(opacity, [0.0, 0.0, 0.4, 1.0, 0.0]);
}

#[test]
fn sprites_scale_and_turn_about_their_centre() {
    let bench = Bench::new();
    bench.image("s.png", sprite());
    let draw = |size: u32, center: f32, more: &str| {
        let center = format!("center = [{center}, {center}]");
        let sprite = format!("sprite = {{ image = \"s.png\", {center}, {more}");
        bench.cells(&format!("size = [{size}, {size}]\n[[shape]]\nemission = [1, 1, 1]\n{sprite}"))
    };
    let emission = |cells: &Cells, x, y| cells.get(x, y).unwrap().emission;
    let (red, blue) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let twice = draw(8, 4.0, "scale = 2 }").unwrap();
    for (x, y) in [(1, 2), (2, 2), (1, 3), (2, 3)] {
        assert_eq!(emission(&twice, x, y), red);
    }
    assert_eq!(emission(&twice, 6, 3), blue);
    assert_eq!(twice.get(7, 3).unwrap().opacity, 0.0);
    // A quarter turn from +x towards +y: what was left is now above.
    let turned = draw(8, 4.0, &format!("scale = 2 }}\nrotation = {}", std::f64::consts::FRAC_PI_2));
    let turned = turned.unwrap();
    assert_eq!(emission(&turned, 5, 1), red);
    assert_eq!(emission(&turned, 5, 6), blue);
    // Partly and wholly outside.
    assert_eq!(emission(&draw(2, 0.0, "scale = 2 }").unwrap(), 1, 1), [srgb::decode_u8(128); 3]);
    assert!(draw(2, 90.0, "scale = 2 }").unwrap().opacity().iter().all(|&a| a == 0.0));
}

#[test]
fn sprites_made_in_code_start_at_the_current_folder() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.png");
    sprite().save(&path).unwrap();
    let cells = Scene::new(3, 2).shape(Shape::sprite(&path, [1.5, 1.0])).cells().unwrap();
    assert_eq!(cells.opacity(), [1.0, 1.0, 1.0, 0.0, 0.0, 1.0]);
    let missing = Scene::new(3, 2).shape(Shape::sprite(Path::new("no-such.png"), [1.5, 1.0]));
    let message = missing.cells().unwrap_err().to_string();
    assert!(message.starts_with("`shape[0].sprite.image`: cannot read no-such.png: No such file"));
}

/// The CRC of PNG (ISO 3309).
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            (crc >> 1) ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 }
        })
    })
}

/// A PNG that claims to be larger than it is.
fn png_claiming(width: u32, height: u32) -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    sprite().write_to(&mut png, image::ImageFormat::Png).unwrap();
    let mut png = png.into_inner();
    png[16..20].copy_from_slice(&width.to_be_bytes());
    png[20..24].copy_from_slice(&height.to_be_bytes());
    let crc = crc(&png[12..29]);
    png[29..33].copy_from_slice(&crc.to_be_bytes());
    png
}

#[test]
fn invalid_images_are_rejected_with_line_key_and_file() {
    let bench = Bench::new();
    let mut damaged = png_claiming(3, 2);
    damaged[45] ^= 0x55;
    bench
        .image("small.png", sprite())
        .bytes("huge.png", &png_claiming(60_000, 60_000))
        .bytes("short.png", &png_claiming(300, 200))
        .bytes("cut.png", &png_claiming(4, 4)[..60])
        .bytes("stub.png", &png_claiming(4, 4)[..20])
        .bytes("bad.png", &damaged)
        .bytes("text.png", b"these are no pixels")
        .bytes("note.png", b"hi\n")
        .bytes("empty.png", b"");
    std::fs::create_dir(bench.folder.path().join("folder.png")).unwrap();
    let layer = |name: &str, size: [u32; 2]| {
        bench.cells(&format!("size = {size:?}\nlayers = {{ opacity = \"{name}\" }}")).unwrap_err()
    };
    let refused = |name: &str, size: [u32; 2], expected: &str| {
        let message = layer(name, size);
        let expected = format!("scene.toml: line 2: `layers.opacity`{expected}");
        assert!(message.starts_with(&expected), "{message}\n  not\n{expected}");
    };
    refused("no.png", [4, 4], ": cannot read no.png: No such file");
    refused(
        "small.png",
        [4, 4],
        " is an image of 3×2 px (small.png), but must be 4×4 px, the size of the scene",
    );
    refused("huge.png", [4, 4], " is an image of 60000×60000 px (huge.png), but must be 4×4 px");
    refused("short.png", [300, 200], ": cannot read short.png: ");
    refused("cut.png", [4, 4], ": cannot read cut.png: ");
    refused("stub.png", [4, 4], ": cannot read stub.png: ");
    refused("bad.png", [3, 2], ": cannot read bad.png: it is not a PNG image that can be read");
    let no_image = "it is not an image; a PNG, EXR, WebP or JPEG image is needed";
    for name in ["text.png", "note.png", "empty.png"] {
        refused(name, [4, 4], &format!(": cannot read {name}: {no_image}"));
    }
    refused("folder.png", [4, 4], ": cannot read folder.png: it is not a file; a PNG, EXR");
    for name in ["short.png", "cut.png", "stub.png", "text.png", "empty.png"] {
        println!("{}", layer(name, if name == "short.png" { [300, 200] } else { [4, 4] }));
    }
    let sprite = "size = [4, 4]\n[[shape]]\nsprite = { image = \"huge.png\", center = [1, 1] }";
    assert_eq!(
        bench.cells(sprite).unwrap_err(),
        format!(
            "scene.toml: line 3: `shape[0].sprite.image` is an image of 60000×60000 px (huge.png), but must \
             be at most {} px a side, {} px in all",
            Cells::MAX_SIDE,
            Cells::MAX_CELLS
        )
    );
}

#[test]
fn a_picture_of_the_sky_is_the_mean_of_its_rows() {
    let bench = Bench::new();
    let rows = RgbaImage::from_fn(3, 2, |x, y| match (x, y) {
        (0, _) => Rgba([255, 128, 0, 255]),
        (1, 0) => Rgba([255, 255, 255, 255]),
        (2, 1) => Rgba([0, 0, 255, 255]),
        _ => Rgba(CLEAR),
    });
    bench.image("sky.png", rows);
    let bright = Rgb32FImage::from_fn(2, 1, |x, _| Rgb([x as f32 * 40.0, 0.5, 0.0]));
    bench.image("sky.exr", bright);
    let sky = |keys: &str| {
        let cells = bench.cells(&format!("size = [2, 1]\nsky = {{ {keys} }}")).unwrap();
        cells.sky().clone()
    };
    let panorama = |columns: &[[f32; 3]]| Panorama::new(columns).unwrap();
    let half = srgb::decode_u8(128);
    let expected = [[2.0, 2.0 * half, 0.0], [1.0; 3], [0.0, 0.0, 1.0]];
    assert_eq!(sky("picture = \"sky.png\", intensity = 2"), panorama(&expected).into());
    let expected = panorama(&[[0.0, 0.5, 0.0], [40.0, 0.5, 0.0]]).turned(std::f32::consts::PI);
    assert_eq!(sky("picture = \"sky.exr\", turn = \"180deg\""), expected.into());
}

#[test]
fn invalid_pictures_of_the_sky_are_rejected_with_line_key_and_file() {
    let bench = Bench::new();
    bench
        .bytes("wide.png", &png_claiming(8193, 1))
        .bytes("huge.png", &png_claiming(8000, 60_000))
        .bytes("text.png", b"these are no pixels")
        .image("negative.exr", Rgb32FImage::from_pixel(2, 2, Rgb([0.0, -1.0, 0.0])))
        .image("nan.exr", Rgb32FImage::from_pixel(2, 2, Rgb([0.0, f32::NAN, 0.0])));
    for (name, expected) in [
        ("no.png", ": cannot read no.png: No such file"),
        ("text.png", ": cannot read text.png: "),
        (
            "wide.png",
            " is an image of 8193×1 px (wide.png), but must be of at most 8192 columns and 16777216 px",
        ),
        (
            "huge.png",
            " is an image of 8000×60000 px (huge.png), but must be of at most 8192 columns",
        ),
        (
            "negative.exr",
            " is an image with a column of -1 (negative.exr), but must be of radiances from 0 to 1e12",
        ),
        ("nan.exr", " is an image with a column of NaN (nan.exr), but must be of radiances from"),
    ] {
        let scene = format!("size = [4, 4]\nsky = {{ picture = \"{name}\" }}");
        let message = bench.cells(&scene).unwrap_err();
        let expected = format!("scene.toml: line 2: `sky.picture`{expected}");
        assert!(message.starts_with(&expected), "{message}\n  not\n{expected}");
    }
}

#[test]
fn images_may_come_as_bytes() {
    let bench = Bench::new();
    bench.image("o.png", pair([51, 51, 51, 255], [255, 255, 255, 255]));
    bench.image("s.png", RgbaImage::from_pixel(1, 1, Rgba([0, 255, 0, 255])));
    let text = "size = [2, 1]\nsky = { picture = \"s.png\" }\n[layers]\nopacity = \"o.png\"\n\
                [[shape]]\nsprite = { image = \"s.png\", center = [0.5, 0.5] }\nemission = [1, 1, 1]";
    let from_disk = bench.cells(text).unwrap();
    let read = |name: &str| std::fs::read(bench.folder.path().join(name)).unwrap();
    let files = [("o.png", read("o.png")), ("s.png", read("s.png"))];
    let given = |path: &Path| {
        files.iter().find(|(name, _)| Path::new(name) == path).map(|(_, bytes)| bytes.as_slice())
    };
    let scene = Scene::from_toml(text).unwrap();
    assert_eq!(scene.cells_with(given).unwrap(), from_disk);
    // What is not given is not looked for on disk, even where it is there.
    let path = bench.folder.path().join("o.png");
    let absolute = format!("size = [2, 1]\n[layers]\nopacity = {:?}", path.display().to_string());
    let scene = Scene::from_toml(&absolute).unwrap();
    assert!(scene.cells().is_ok());
    let error = scene.cells_with(given).unwrap_err().to_string();
    assert!(error.contains("not among the files that came with the scene"), "{error}");
    let junk = |_: &Path| Some(&b"junk"[..]);
    assert!(Scene::from_toml(text).unwrap().cells_with(junk).is_err());
}
