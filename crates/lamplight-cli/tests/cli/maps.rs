//! Maps of level editors in place of scenes.

use super::sandbox::Sandbox;
use image::{Rgba, RgbaImage};
use serde_json::Value;

/// A directory with `map.tmx` of 20×10 tiles of 16 px, a wall on the right and a lamp on the left, and `big.world`.
fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    RgbaImage::from_pixel(16, 16, Rgba([200, 160, 120, 255]))
        .save(sandbox.path("wall.png"))
        .unwrap();
    let row = |x: u32| if x == 15 { "1" } else { "0" };
    let cells: Vec<_> = (0..200).map(|i| row(i % 20)).collect();
    let map = format!(
        r#"<map orientation="orthogonal" width="20" height="10" tilewidth="16" tileheight="16">
        <tileset firstgid="1" name="walls" tilewidth="16" tileheight="16" tilecount="1" columns="1"><image source="wall.png"/></tileset>
        <layer name="walls" width="20" height="10"><properties><property name="light" value="walls"/></properties>
        <data encoding="csv">{}</data></layer>
        <objectgroup><object id="1" type="lamp" x="80" y="80"><point/></object></objectgroup></map>"#,
        cells.join(",")
    );
    sandbox.write("map.tmx", &map);
    sandbox.write("dark.tmx", map.replace("lamp", "chest"));
    let entry = |x: i32| {
        format!(r#"{{ "fileName": "map.tmx", "x": {x}, "y": -5, "width": 320, "height": 160 }}"#)
    };
    sandbox.write("two.world", format!(r#"{{ "maps": [{}, {}] }}"#, entry(-320), entry(0)));
    sandbox.write("far.world", format!(r#"{{ "maps": [{}, {}] }}"#, entry(0), entry(30_000)));
    sandbox
}

#[test]
fn a_map_is_rendered_and_baked() {
    let sandbox = sandbox();
    let said = sandbox.run("render map.tmx").done();
    assert!(said.contains("wrote map.png: 320×160 cells"), "{said}");
    let picture = sandbox.picture("map.png");
    let [left, right] = [100, 300].map(|x| picture.get_pixel(x, 80).0[0]);
    assert!(left > 40 && right < left / 8, "{left}, {right}");
    sandbox.run("bake two.world -o tiles --tile 160 -q --bounces 0").done();
    let manifest: Value = serde_json::from_slice(&sandbox.read("tiles/bake.json")).unwrap();
    assert_eq!(manifest["size"], serde_json::json!([640, 160]));
    assert_eq!(manifest["origin"], serde_json::json!([-320, -5]));
    sandbox.run("bake two.world -o tiles --tile 160 -q --bounces 0 --resume").done();
    sandbox.write("map.tmx", String::from_utf8(sandbox.read("map.tmx")).unwrap() + "\n");
    let again = sandbox.run("bake two.world -o tiles --tile 160 -q --bounces 0 --resume");
    again.failed(2, &["--resume", "scene"]);
    // Nor are files of the maps, which are not read before they are needed.
    sandbox.run("bake two.world -o tiles --tile 160 -q --bounces 0").done();
    RgbaImage::from_pixel(16, 16, Rgba([90; 4])).save(sandbox.path("wall.png")).unwrap();
    let again = sandbox.run("bake two.world -o tiles --tile 160 -q --bounces 0 --resume");
    again.failed(2, &["--resume", "scene"]);
    sandbox.run("probe map.tmx 80,60").done();
}

#[test]
fn maps_that_cannot_be_lit_are_explained() {
    let sandbox = sandbox();
    let run = sandbox.run("render dark.tmx --bounces 0");
    assert!(run.code == 0 && run.err.contains("nothing in the map gives light"), "{}", run.err);
    sandbox
        .run("render far.world")
        .failed(2, &["far.world", "30320×160", "lamplight bake far.world"]);
    sandbox.run("render gone.tmx").failed(2, &["gone.tmx"]);
    let map = String::from_utf8(sandbox.read("map.tmx")).unwrap();
    sandbox.write("off.tmx", map.replace("x=\"80\"", "x=\"-80\""));
    let run = sandbox.run("render off.tmx --bounces 0");
    assert!(run.err.contains("`lamp[0]` is at [-80, 80], outside the grid"), "{}", run.err);
    sandbox.run("bake map.tmx -o map.tmx").failed(2, &["it is a file, not a directory"]);
    std::fs::remove_file(sandbox.path("wall.png")).unwrap();
    sandbox.run("bake map.tmx -o tiles").failed(2, &["map.tmx", "tileset \"walls\"", "wall.png"]);
}

#[test]
fn a_project_of_ldtk_is_baked() {
    let sandbox = sandbox();
    let project = r##"{ "defs": { "tilesets": [], "layers": [
            { "uid": 1, "identifier": "Ground", "intGridValues": [{ "value": 1, "identifier": "Stone", "color": "#808080" }] }] },
        "levels": [{ "identifier": "A", "worldX": 8, "worldY": 0, "pxWid": 128, "pxHei": 64, "__bgColor": "#ffffff", "layerInstances": [
            { "__identifier": "Entities", "__cWid": 8, "__cHei": 4, "__gridSize": 16, "layerDefUid": 2, "entityInstances": [
                { "__identifier": "Lamp", "px": [24, 40] }] },
            { "__identifier": "Ground", "__cWid": 8, "__cHei": 4, "__gridSize": 16, "layerDefUid": 1,
              "intGridCsv": [0,0,0,1,0,0,0,0, 0,0,0,1,0,0,0,0, 0,0,0,1,0,0,0,0, 0,0,0,1,0,0,0,0] }] }] }"##;
    sandbox.write("game.ldtk", project);
    sandbox.run("bake game.ldtk -o tiles --tile 64 -q").done();
    let [left, right] = ["0-0", "1-0"]
        .map(|tile| sandbox.picture(&format!("tiles/{tile}.png")).get_pixel(30, 20).0[0]);
    assert!(left > 40 && right < left / 8, "{left}, {right}");
    sandbox.write("game.ldtk", project.replace("\"pxWid\": 128", "\"pxWid\": \"wide\""));
    sandbox.run("bake game.ldtk -o tiles").failed(2, &["game.ldtk", "levels[0].pxWid", "wide"]);
    let outside = project
        .replace("\"layerInstances\": [\n", "\"externalRelPath\": \"a.ldtkl\", \"layers\": [\n");
    sandbox.write("game.ldtk", outside);
    let error = sandbox.run("render game.ldtk").failed(2, &["game.ldtk: cannot read a.ldtkl"]);
    assert!(!error.contains("hint"), "{error}");
}
