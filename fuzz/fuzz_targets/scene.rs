//! The scene reader on any bytes: no panic, no hang, and what was read is written and read again.
//!
//! Needs a nightly compiler and cargo-fuzz (`cargo install cargo-fuzz`). From the root:
//!
//! ```sh
//! mkdir -p fuzz/corpus/scene
//! cp scenes/*.toml crates/lamplight/tests/suite/scene_whole.toml fuzz/corpus/scene/
//! cargo +nightly fuzz run scene -- -timeout=10 -max_len=65536
//! ```
//!
//! Every finding becomes a case in `crates/lamplight/tests/suite/scene_fuzz.rs`.

#![no_main]

use lamplight::scene::{Geometry, SceneSky};
use lamplight::{Cookie, CookiePicture, Scene};
use libfuzzer_sys::fuzz_target;

/// Largest grid that is made of what was read.
const SMALL: u32 = 64;

fuzz_target!(|text: &str| {
    for scene in [Scene::from_toml(text), Scene::from_json(text)] {
        let Ok(mut scene) = scene else { continue };
        let written = scene.to_toml().expect("what was read can be written");
        assert_eq!(Scene::from_toml(&written).expect("what was written can be read"), scene);
        // Random paths would read what happens to lie there.
        scene.layers = Default::default();
        if matches!(scene.sky, SceneSky::Picture(_)) {
            scene.sky = SceneSky::default();
        }
        for lamp in &mut scene.lamps {
            let is_file = |cookie: &Cookie| matches!(cookie.picture, CookiePicture::File(_));
            lamp.cookie = lamp.cookie.take().filter(|cookie| !is_file(cookie));
        }
        scene.shapes.retain(|shape| !matches!(shape.geometry, Geometry::Sprite(_)));
        scene.size = scene.size.map(|side| side.min(SMALL));
        let cells = scene.cells().expect("a checked scene makes a grid");
        cells.check().expect("of matter");
        cells.drawn().check().expect("and so do its lamps");
    }
});
