//! Scene files: what is read, what is written, and what each mistake is answered with.

use crate::common::solve;
use lamplight::Gradient;
use lamplight::scene::{Layers, Material, NormalY, SkyPicture};
use lamplight::{
    Bounces, Cone, Cookie, Direct, Display, Falloff, Lamp, Matter, Method, Panorama, Profile,
    Relief, Scene, Settings, SettingsTable, Shape, Sky, Sun, ToneMap,
};
use std::collections::BTreeSet;
use std::path::Path;
use std::time::{Duration, Instant};

/// The time limit for rejecting any text of 10 MB: a person would wait that long. (It takes
/// about a second on one slow core.)
const PATIENCE: Duration = Duration::from_secs(10);

/// Every key of the format at a value that is not its default.
const WHOLE: &str = include_str!("scene_whole.toml");

fn whole() -> Scene {
    let mut scene = Scene::new(32, 18)
        .sky(Sky::Gradient(Gradient {
            zenith: [0.1, 0.2, 0.4],
            horizon: [0.3, 0.3, 0.3],
            ground: [0.0, 0.0, 0.1],
        }))
        .shape(
            Shape::circle([16.0, 9.0], 1.2)
                .rotation(0.5)
                .antialias(true)
                .only_open()
                .emission([4.0, 3.2, 2.0])
                .glow([0.5, 0.25, 0.0])
                .opacity(0.5)
                .albedo([0.8, 0.7, 0.6])
                .tint([1.0, 0.5, 0.25])
                .color([0.1, 0.2, 0.3])
                .mask(3),
        )
        .shape(Shape::rect([1.0, 2.0], [3.0, 4.0]))
        .shape(Shape::polygon([[1.0, 2.0], [3.0, 4.0], [5.0, 0.5]]))
        .shape(Shape::line([1.0, 2.0], [3.0, 4.0], 1.5))
        .shape(Shape::sprite("tree.png", [5.0, 6.0]))
        .lamp(Lamp {
            position: [4.5, 3.5],
            color: [1.0, 0.85, 0.6],
            intensity: 4.0,
            range: 64.0,
            size: 1.5,
            falloff: Falloff::Smooth,
            cone: Some(Cone {
                direction: 1.5,
                angle: 0.75,
                softness: 0.25,
                profile: Some(Profile::new(&[0.25, 1.0, 0.5]).unwrap()),
            }),
            cookie: Some(Cookie { turn: 0.5, ..Cookie::new("leaves.png", 24.0) }),
            height: Some(18.0),
            direct: Direct::Exact,
            mask: 5,
            solid: true,
            visible: true,
        })
        .sun(Sun {
            direction: 60f32.to_radians(),
            angle: 0.03,
            color: [1.0, 0.9, 0.8],
            intensity: 2.0,
            elevation: Some(30f32.to_radians()),
            direct: Direct::Glow,
            mask: 6,
        });
    scene.layers = Layers {
        tile: Some(64),
        emission: Some("emission/{x}_{y}.png".into()),
        emission_scale: 6.0,
        glow: Some("glow.png".into()),
        glow_scale: 0.5,
        opacity: Some("opacity.png".into()),
        albedo: Some("albedo.png".into()),
        tint: Some("tint.png".into()),
        color: Some("background.exr".into()),
        normal: Some("normal.png".into()),
        normal_y: NormalY::Down,
        mask: Some("layers.png".into()),
    };
    scene.settings.set("method", "raymarch");
    scene.settings.set("bounces", "converged");
    scene.settings.set("elevation", 0.5);
    scene.settings.set("raymarch.preset", "unity");
    scene.settings.set("raymarch.rays", 64);
    scene.display = Display {
        tonemap: ToneMap::Agx,
        exposure: -1.5,
        ambient: [0.1, 0.2, 0.3],
        relief: Relief { specular: 0.25, roughness: 0.75 },
    };
    scene
}

#[test]
fn every_key_is_read() {
    let scene = Scene::from_toml(WHOLE).unwrap();
    assert_eq!(scene, whole());
    let settings = scene.resolve_settings().unwrap();
    assert_eq!((settings.bounces, settings.elevation), (Bounces::Converged, 0.5));
    let raymarch = settings.method.as_raymarch().unwrap();
    assert_eq!((raymarch.rays, raymarch.steps), (64, 16));
}

#[test]
fn written_scenes_are_read_back() {
    let columns = Panorama::new(&[[0.5, 0.25, 0.0], [2.0, 3.0, 4.0]]).unwrap().turned(0.5);
    let picture = SkyPicture { intensity: 2.5, turn: -1.5, ..SkyPicture::new("sky.png") };
    let small = Scene::new(1, 1);
    let skies = [small.clone().sky(columns), small.clone().sky(picture)];
    for scene in skies.into_iter().chain([whole(), small]) {
        assert_eq!(Scene::from_toml(&scene.to_toml().unwrap()).unwrap(), scene);
        assert_eq!(Scene::from_json(&scene.to_json().unwrap()).unwrap(), scene);
    }
    let centred = "size = [9, 9]\n[[shape]]\nrect = { center = [4.1, 4.2], size = [1.3, 2] }";
    let scene = Scene::from_toml(centred).unwrap();
    assert_eq!(Scene::from_toml(&scene.to_toml().unwrap()).unwrap(), scene);
}

#[test]
fn a_panorama_is_a_list_of_colours() {
    let text = "size = [1, 1]\nsky = { columns = [\"#f00\", [0, 2, 0]], turn = \"90deg\" }";
    let cells = Scene::from_toml(text).unwrap().cells().unwrap();
    let columns = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    let turned = Panorama::new(&columns).unwrap().turned(std::f32::consts::FRAC_PI_2);
    assert_eq!(*cells.sky(), Sky::Panorama(turned));
}

#[test]
fn a_shape_that_glows_is_not_solid_unless_it_says_so() {
    let shape = |keys: &str| {
        let circle = "circle = { center = [4, 4], radius = 2 }";
        let text = format!("size = [8, 8]\n[[shape]]\n{circle}\n{keys}\n");
        let scene = Scene::from_toml(&text).unwrap();
        let cells = scene.cells().unwrap();
        (cells.get(4, 4).unwrap(), scene.warnings(&cells))
    };
    let (fire, warnings) = shape("glow = [1, 0.5, 0]");
    assert_eq!((fire.glow, fire.opacity), ([1.0, 0.5, 0.0], 0.0));
    assert_eq!(warnings, Vec::<String>::new());
    assert_eq!(shape("glow = [1, 0.5, 0]\nopacity = 0.25").0.opacity, 0.25);
    let (wall, warnings) = shape("glow = [1, 0.5, 0]\nopacity = 1");
    assert_eq!(wall.opacity, 1.0);
    assert!(warnings[0].starts_with("12 solid cells have glow"), "{warnings:?}");
    assert_eq!(shape("").0.opacity, 1.0);
}

/// The shape of a file with these keys.
fn shape(keys: &str) -> Shape {
    let circle = "circle = { center = [4, 4], radius = 2 }";
    let mut scene =
        Scene::from_toml(&format!("size = [8, 8]\n[[shape]]\n{circle}\n{keys}\n")).unwrap();
    scene.shapes.remove(0)
}

#[test]
fn every_material_is_read_by_its_name_and_gives_its_matter() {
    for &material in Material::ALL {
        let name = material.name();
        let read = shape(&format!("material = '{name}'"));
        assert_eq!(read, Shape::circle([4.0, 4.0], 2.0).material(material), "{name}");
        assert_eq!((read.matter(), read.color), (material.matter(), material.color()), "{name}");
        let scene = Scene::new(8, 8).shape(read);
        let cells = scene.cells().unwrap();
        cells.check().unwrap();
        assert_eq!(scene.warnings(&cells), Vec::<String>::new(), "{name}");
        assert_eq!(cells.get(4, 4), Some(material.matter()), "{name}");
        assert_eq!(Scene::from_toml(&scene.to_toml().unwrap()).unwrap(), scene, "{name}");
    }
    let names: BTreeSet<_> = Material::ALL.iter().map(|material| material.name()).collect();
    assert_eq!(names.len(), Material::ALL.len());
    let schema = Scene::schema();
    let listed = schema["$defs"]["Material"]["oneOf"].as_array().unwrap().iter();
    assert_eq!(listed.map(|one| one["const"].as_str().unwrap()).collect::<BTreeSet<_>>(), names);
}

#[test]
fn the_keys_of_a_shape_win_over_its_material() {
    let water = Material::Water.matter();
    let given = |keys: &str| shape(&format!("material = 'water'\n{keys}")).matter();
    assert_eq!(given("emission = [1, 2, 3]"), Matter { emission: [1.0, 2.0, 3.0], ..water });
    // Without a material, glow makes the opacity 0.
    assert_eq!(given("glow = [1, 2, 3]"), Matter { glow: [1.0, 2.0, 3.0], ..water });
    assert_eq!(given("opacity = 0"), Matter { opacity: 0.0, ..water });
    assert_eq!(given("tint = [1, 1, 1]"), Matter { tint: [1.0; 3], ..water });
    assert_eq!(given("albedo = [0, 0, 0]"), Matter { albedo: [0.0; 3], ..water });
    // A value that is given is kept even where it is the default of a shape without a material.
    assert_eq!(shape("material = 'fire'\nglow = [0, 0, 0]").glow, [0.0; 3]);
    assert_eq!(shape("material = 'lava'\nemission = [0, 0, 0]").emission, [0.0; 3]);
    // The colour is the shape's own, else the albedo's, else the material's.
    assert_eq!(shape("material = 'leaves'").color, Material::Leaves.color());
    let red = [0.75, 0.25, 0.125];
    let autumn = shape("material = 'leaves'\nalbedo = [0.75, 0.25, 0.125]");
    assert_eq!((autumn.albedo, autumn.color), (Some(red), Some(red)));
    let painted = shape("material = 'leaves'\nalbedo = [0, 0, 0]\ncolor = [0.75, 0.25, 0.125]");
    assert_eq!(painted.color, Some(red));
    assert_eq!(shape("material = 'stone'\nalbedo = [0.75, 0.25, 0.125]").color, None);
}

#[test]
fn the_media_lie_between_walls_if_only_in_the_open() {
    for material in [Material::Fog, Material::Water, Material::Glass, Material::Smoke] {
        let rect = || Shape::rect([0.0, 0.0], [8.0, 8.0]);
        let wall = Shape::rect([2.0, 2.0], [4.0, 4.0]).material(Material::Brick);
        let scene = Scene::new(8, 8).shape(wall).shape(rect().material(material).only_open());
        let cells = scene.cells().unwrap();
        assert_eq!(cells.get(3, 3), Some(Material::Brick.matter()), "{}", material.name());
        assert_eq!(cells.get(0, 0), Some(material.matter()), "{}", material.name());
    }
}

#[test]
fn fog_only_in_the_open_keeps_walls_and_lights() {
    let shapes = |only: &str| {
        let text = format!(
            "size = [8, 8]\n[[shape]]\ncircle = {{ center = [4, 4], radius = 2 }}\n\
             emission = '#ff8800'\n[[shape]]\nrect = {{ min = [0, 0], max = [8, 8] }}\n\
             opacity = 0.25\n{only}\n"
        );
        Scene::from_toml(&text).unwrap().cells().unwrap()
    };
    let everywhere = shapes("");
    assert!((0..64).all(|i| everywhere.opacity()[i] == 0.25));
    let open = shapes("only = 'open'");
    assert_eq!(open.get(0, 0).unwrap().opacity, 0.25);
    let light = open.get(4, 4).unwrap();
    assert_eq!((light.opacity, light.emission[0], light.emission[2]), (1.0, 1.0, 0.0));
}

#[test]
fn angles_are_read_in_degrees_and_colours_of_0_to_255_are_doubted() {
    let text = "size = [8, 8]\n[[shape]]\nrect = { min = [2, 2], max = [6, 4] }\n\
                rotation = '90deg'\n[[lamp]]\nposition = [1, 1]\ncolor = [255, 128, 0]\n\
                cone = { direction = '-90deg', angle = '60deg' }\n";
    let scene = Scene::from_toml(text).unwrap();
    let cells = scene.cells().unwrap();
    assert!(cells.is_solid(cells.index(3, 1)) && !cells.is_solid(cells.index(2, 2)));
    let cone = scene.lamps[0].cone.unwrap();
    assert_eq!([cone.direction, cone.angle], [-90f32, 60.0].map(f32::to_radians));
    let warnings = scene.warnings(&cells);
    assert!(warnings[0].contains("`lamp[0].color` = [255, 128, 0]"), "{warnings:?}");
}

#[test]
fn the_starter_scene_makes_a_grid() {
    let starter = include_str!("../../../lamplight-cli/src/starter.toml");
    let scene = Scene::from_toml(starter).unwrap();
    let cells = scene.cells().unwrap();
    cells.check().unwrap();
    assert_eq!((cells.width(), cells.height(), cells.lamps().len()), (320, 180, 2));
    assert_eq!(scene.warnings(&cells), Vec::<String>::new());
}

/// An invalid text and its message.
type Mistake = (&'static str, &'static str);

const TOML_MISTAKES: &[Mistake] = &[
    ("", "line 1: `size` is missing"),
    ("size = [4, 4", "line 1, column 13: unclosed array, expected `]`"),
    ("size = [4, 4]\nsize = [3, 3]", "line 2, column 1: duplicate key"),
    ("size = [4, 4, 4]", "line 1: `size` is a list of 3, but must be a list of 2 numbers"),
    ("size = 4", "line 1: `size` is 4, but must be a list of 2 numbers"),
    ("size = [4.5, 4]", "line 1: `size[0]` is 4.5, but must be a whole number of 0 or more"),
    ("size = [-4, 4]", "line 1: `size[0]` is -4, but must be a whole number of 0 or more"),
    ("size = [5000000000, 4]", "line 1: `size[0]` is 5000000000, but must be smaller"),
    (
        "size = [99999999999999999999, 4]",
        "line 1: `size[0]` is 99999999999999999999, but must be smaller",
    ),
    (
        "size = [0, 4]",
        "line 1: a grid of 0×4 cells is refused: each side must be 1 to 16384, and the product at",
    ),
    (
        "\nsize = [40000, 40000]",
        "line 2: a grid of 40000×40000 cells is refused: each side must be 1 to 16384, and the",
    ),
    (
        "size = [4, 4]\nskyy = 3",
        "line 2: `skyy` is not a known key; did you mean `sky`? (known here: size, sky, layers, \
         shape, lamp, sun, light, display, $schema)",
    ),
    (
        "size = [4, 4]\nsky = \"blue\"",
        "line 2: `sky` is \"blue\", but must be a colour, [r, g, b] or \"#rrggbb\", or { zenith, \
         horizon, ground }, { columns } or { picture }",
    ),
    ("size = [4, 4]\nsky = { zenith = [0, 0, 0] }", "line 2: `sky.horizon` is missing"),
    (
        "size = [4, 4]\nsky = { picure = \"a.png\" }",
        "line 2: `sky.picure` is not a known key; did you mean `picture`? (known here: zenith, horizon, \
         ground, columns, picture, intensity, turn)",
    ),
    (
        "size = [4, 4]\nsky = { picture = \"a.png\", zenith = [0, 0, 0] }",
        "line 2: `sky` is a mixture of several, but must be { zenith, horizon, ground }, { columns, turn } \
         or { picture, intensity, turn }",
    ),
    (
        "size = [4, 4]\nsky = { picture = \"a.png\", intensity = -1 }",
        "line 2: `sky.intensity` is -1, but must be a number from 0 to 1000000",
    ),
    (
        "size = [4, 4]\nsky = { picture = \"a.png\", turn = 90 }",
        "line 2: `sky.turn` is 90, but must be a number from -6.2832 to 6.2832",
    ),
    (
        "size = [4, 4]\nsky = { columns = [] }",
        "line 2: `sky.columns` is a list of 0, but must be a list of 1 to 8192 colours",
    ),
    (
        "size = [4, 4]\nsky = { columns = [[0, 0, 0], [0, -1, 0]] }",
        "line 2: `sky.columns[1]` is [0, -1, 0], but must be three radiances from 0 to 1e12",
    ),
    (
        "size = [4, 4]\nsky = [0, -1, 0]",
        "line 2: `sky` is -1, but must be a radiance from 0 to 1e12",
    ),
    (
        "size = [4, 4]\n[layers]\nemision = \"a.png\"",
        "line 3: `layers.emision` is not a known key; did you mean `emission`? (known here: tile, \
         emission, emission_scale, glow, glow_scale, opacity, albedo, tint, color, normal, normal_y, mask)",
    ),
    (
        "size = [4, 4]\n[layers]\nemission = 3",
        "line 3: `layers.emission` is 3, but must be a text in quotes",
    ),
    (
        "size = [4, 4]\n[layers]\nemission_scale = -2",
        "line 3: `layers.emission_scale` is -2, but must be a number from 0 to 1000000",
    ),
    (
        "size = [4, 4]\n[[shape]]\nopacity = 1",
        "line 2: `shape[0]` is without a geometry, but must be exactly one of circle, rect, \
         polygon, line, sprite",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, 2], radius = 1 }\nrect = { min = [1, \
         1], max = [2, 2] }",
        "line 2: `shape[0]` is circle and rect, but must be exactly one of circle, rect, polygon, \
         line, sprite",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, 2], radios = 3 }",
        "line 3: `shape[0].circle.radios` is not a known key; did you mean `radius`? (known here: \
         center, radius)",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, 2] }",
        "line 3: `shape[0].circle.radius` is missing",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, 2], radius = \"big\" }",
        "line 3: `shape[0].circle.radius` is \"big\", but must be a number",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, 2], radius = nan }",
        "line 3: `shape[0].circle.radius` is NaN, but must be more than 0 and at most 1000000 px",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, inf], radius = 1 }",
        "line 3: `shape[0].circle.center` is [1, inf], but must be two numbers from -1000000 to \
         1000000",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, 2, 3], radius = 1 }",
        "line 3: `shape[0].circle.center` is a list of 3, but must be a list of 2 numbers",
    ),
    (
        "size = [4, 4]\n[[shape]]\nrect = { min = [1, 2], size = [1, 1] }",
        "line 3: `shape[0].rect` is min and size, but must be either min and max, or center and \
         size",
    ),
    (
        "size = [4, 4]\n[[shape]]\nrect = { min = [1, 2], max = [1, 3] }",
        "line 3: `shape[0].rect.max` is [1, 3], but must be greater than `min` [1, 2] in x and y",
    ),
    (
        "size = [4, 4]\n[[shape]]\nrect = { center = [1, 2], size = [1, 0] }",
        "line 3: `shape[0].rect.size[1]` is 0, but must be more than 0 and at most 1000000 px",
    ),
    (
        "size = [4, 4]\n[[shape]]\npolygon = { points = [[1, 2], [3, 4]] }",
        "line 3: `shape[0].polygon.points` is a list of 2 points, but must be a list of 3 to 10000 \
         points",
    ),
    (
        "size = [4, 4]\n[[shape]]\npolygon = { points = [[1, 1], [2, 2], [3, 3]] }",
        "line 3: `shape[0].polygon.points` is all on one line, but must be corners that enclose an \
         area",
    ),
    (
        "size = [4, 4]\n[[shape]]\npolygon = { points = [[1, 1], [2, 2],\n[3, 3, 3]] }",
        "line 4: `shape[0].polygon.points[2]` is a list of 3, but must be a list of 2 numbers",
    ),
    (
        "size = [4, 4]\n[[shape]]\nline = { from = [1, 1], to = [1, 1], width = 1 }",
        "line 3: `shape[0].line.to` is [1, 1], but must be another point than `from`",
    ),
    (
        "size = [4, 4]\n[[shape]]\nline = { from = [1, 1], to = [2, 1], width = 0 }",
        "line 3: `shape[0].line.width` is 0, but must be more than 0 and at most 1000000 px",
    ),
    (
        "size = [4, 4]\n[[shape]]\nsprite = { image = \"a.png\", center = [1, 1], scale = 0 }",
        "line 3: `shape[0].sprite.scale` is 0, but must be a number from 0.001 to 1000",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, 2], radius = 1 }\nopacity = 1.5",
        "line 4: `shape[0].opacity` is 1.5, but must be a number from 0 to 1",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, 2], radius = 1 }\nalbedo = [1, 1, 2]",
        "line 4: `shape[0].albedo` is [1, 1, 2], but must be three numbers from 0 to 1",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, 2], radius = 1 }\nemission = [-1, 0, 0]",
        "line 4: `shape[0].emission` is [-1, 0, 0], but must be three numbers from 0 to 1e12",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, 2], radius = 1 }\nemission = [0.5, 0.5]",
        "line 4: `shape[0].emission` is a list of 2, but must be a list of 3 numbers",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, 2], radius = 1 }\nmaterial = \"glas\"",
        "line 4: `shape[0].material` is \"glas\", but must be one of stone, brick, wood, plaster, \
         metal, earth, sand, grass, snow, glass, ice, water, leaves, fog, smoke, fire, lava; did you \
         mean \"glass\"?",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, 2], radius = 1 }\nmaterial = 3",
        "line 4: `shape[0].material` is not a text in quotes",
    ),
    ("size = [4, 4]\n[[lamp]]\nsize = 1", "line 2: `lamp[0].position` is missing"),
    ("size = [4, 4]\n[lamp]\nsize = 1", "line 2: `lamp` is a table, but must be a list"),
    (
        "size = [4, 4]\n[[lamp]]\nposition = [1, 1]\nsize = 0",
        "line 4: `lamp[0].size` is 0, but must be a number from 0.05 to 512",
    ),
    (
        "size = [4, 4]\n[[lamp]]\nposition = [1, 1]\nmask = 256",
        "line 4: `lamp[0].mask` is 256, but must be a whole number from 1 to 255",
    ),
    (
        "size = [4, 4]\n[[lamp]]\nposition = [1, 1]\nmask = 0",
        "line 4: `lamp[0].mask` is 0, but must be a whole number from 1 to 255",
    ),
    (
        "size = [4, 4]\n[[sun]]\ndirection = 1\nmask = -1",
        "line 4: `sun[0].mask` is -1, but must be a whole number from 1 to 255",
    ),
    (
        "size = [4, 4]\n[[shape]]\ncircle = { center = [1, 2], radius = 1 }\nmask = 0",
        "line 4: `shape[0].mask` is 0, but must be a whole number from 1 to 255",
    ),
    (
        "size = [4, 4]\n[[lamp]]\nposition = [1, 1]\nfalloff = \"cubic\"",
        "line 4: `lamp[0].falloff` is \"cubic\", but must be one of linear, smooth, inverse",
    ),
    (
        "size = [4, 4]\n[light]\nwall_dept = 3",
        "line 3: `light.wall_dept` is not a known key; did you mean `wall_depth`? (known here: ",
    ),
    (
        "size = [4, 4]\n[light]\nbounces = -3",
        "line 3: `light.bounces` is -3, but must be a whole number from 0 to 256, \"converged\" or \"feedback\"",
    ),
    (
        "size = [4, 4]\n[light.raymarch]\nrays = 0",
        "line 3: `light.raymarch.rays` is 0, but must be from 1 to 65536",
    ),
    (
        "size = [4, 4]\n[light]\nwall_depth = nan",
        "line 3: `light.wall_depth` is nan, but must be a finite number",
    ),
    // Tables by the order of their fields.
    (
        "size = [4, 4]\n[[shape]]\ncircle = [[5, 5], 3]",
        "line 3: `shape[0].circle` is a list, but must be a table",
    ),
    (
        "size = [4, 4]\n[light]\nmethod = \"polar\"\npolar = [2]",
        "line 4: `light.polar` is a list, but must be a table",
    ),
    (
        "size = [4, 4]\n[display]\nrelief = [1, 2, 3]",
        "line 3: `display.relief` is a list, but must be a table",
    ),
    // Images without a name.
    (
        "size = [4, 4]\n[layers]\nopacity = \"\"",
        "line 3: `layers.opacity` is empty, but must be the path of an image",
    ),
    (
        "size = [4, 4]\nsky = { picture = \"\" }",
        "line 2: `sky.picture` is empty, but must be the path of an image",
    ),
    (
        "size = [4, 4]\n[[shape]]\nsprite = { image = \"\", center = [1, 1] }",
        "line 3: `shape[0].sprite.image` is empty, but must be the path of an image",
    ),
    (
        "size = [4, 4]\n[[lamp]]\nposition = [1, 1]\ncookie = { picture = \"\", size = 3 }",
        "line 4: `lamp[0].cookie.picture` is empty, but must be the path of an image",
    ),
    // Names that are like no other.
    ("size = [4, 4]\nskies = 1", "line 2: `skies` is not a known key (known here: size, sky,"),
    ("size = [4, 4]\n[light]\nfoo = 1", "line 3: `light.foo` is not a known key (known here: "),
    (
        "size = [4, 4]\n[display]\ntonemap = \"filmic\"",
        "line 3: `display.tonemap` is \"filmic\", but must be one of none, reinhard, aces, agx, vivid",
    ),
    (
        "size = [4, 4]\n[display]\nexposure = 99",
        "line 3: `display.exposure` is 99, but must be a number of stops from -32 to 32",
    ),
    (
        "size = [4, 4]\n[display]\nambient = [0, -0.1, 0]",
        "line 3: `display.ambient` is [0, -0.1, 0], but must be three numbers from 0 to 1e12",
    ),
];

const JSON_MISTAKES: &[Mistake] = &[
    ("", "line 1, column 0: EOF while parsing a value"),
    ("{\"size\": [4, 4],}", "line 1, column 17: trailing comma"),
    ("{\"size\": [4, 4]} x", "line 1, column 18: trailing characters"),
    ("null", "line 1: `scene` is null, but must be a table"),
    ("[[32, 32]]", "line 1: `scene` is a list, but must be a table"),
    (
        "{\"size\": [32, 32],\n\"lamp\": [[[5, 5]]]}",
        "line 2: `lamp[0]` is a list, but must be a table",
    ),
    (
        "{\"size\": [32, 32], \"light\": {\"raymarch\": [64]}}",
        "`light.raymarch` is a list, but must be a table",
    ),
    (
        "{\"size\": [32, 32], \"shape\": [{\"rect\": [[1, 1], [2, 2]]}]}",
        "line 1: `shape[0].rect` is a list, but must be a table",
    ),
    ("{\"size\": [4, 4],\n\"size\": [4, 4]}", "line 2: `size` is there twice"),
    ("{\"size\": [4, 4, 4]}", "line 1: `size` is a list of 3, but must be a list of 2 numbers"),
    (
        "{\"size\": [4, 4],\n\"shape\": [{\"circle\": {\"center\": [1, 1], \"radius\": \"a\"}}]}",
        "line 2: `shape[0].circle.radius` is \"a\", but must be a number",
    ),
    (
        "{\"size\": [4, 4], \"shape\": [{\"circle\": {\"center\": [1, 1], \"radius\": 1e300}}]}",
        "`shape[0].circle.radius` is inf, but must be more than 0 and at most 1000000 px",
    ),
    (
        "{\"size\": [4, 4], \"light\": {\"wall_depth\": null}}",
        "`light.wall_depth` is null, NaN or infinite, but must be a number",
    ),
    (
        "{\"size\": [4, 4], \"light\": {\"bounces\": 1.5}}",
        "`light.bounces` is 1.5, but must be a whole number from 0 to 256, \"converged\" or \"feedback\"",
    ),
];

#[test]
fn errors_name_line_key_value_and_valid_values() {
    let check = |(text, expected): &Mistake, read: fn(&str) -> lamplight::Result<Scene>| {
        let message = read(text).expect_err(text).to_string();
        assert!(message.starts_with(expected), "for {text:?}:\n  {message}\n  not\n  {expected}");
    };
    TOML_MISTAKES.iter().for_each(|mistake| check(mistake, Scene::from_toml));
    JSON_MISTAKES.iter().for_each(|mistake| check(mistake, Scene::from_json));
}

#[test]
fn the_schema_that_an_editor_uses_may_be_named() {
    let scene = Scene::from_json("{\"$schema\": \"scene.schema.json\", \"size\": [4, 3]}").unwrap();
    assert_eq!(scene, Scene::new(4, 3));
    assert!(!scene.to_json().unwrap().contains("$schema"));
    assert!(Scene::schema()["properties"].get("$schema").is_some());
    let nested = "{\"size\": [4, 3], \"layers\": {\"$schema\": \"scene.schema.json\"}}";
    let error = Scene::from_json(nested).unwrap_err().to_string();
    assert!(error.contains("`layers.$schema` is not a known key"), "{error}");
}

#[test]
fn scenes_made_in_code_are_checked_too() {
    let refused = |scene: Scene| scene.cells().unwrap_err().to_string();
    assert_eq!(
        refused(Scene::new(9, 9).shape(Shape::circle([1.0, 1.0], -1.0))),
        "`shape[0].circle.radius` is -1, but must be more than 0 and at most 1000000 px"
    );
    assert!(refused(Scene::new(16_384, 2049)).starts_with("a grid of 16384×2049 cells is refused"));
    let mut scene = Scene::new(9, 9);
    scene.settings.set("raymarch.rays", 0);
    let expected = "`light.raymarch.rays` is 0, but must be from 1 to 65536";
    assert_eq!(refused(scene.clone()), expected);
    assert_eq!(scene.resolve_settings().unwrap_err().to_string(), expected);
}

fn load(name: &str, bytes: impl AsRef<[u8]>) -> Result<Scene, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let folder = folder.path().display().to_string();
    Scene::load(&path).map_err(|e| e.to_string().replace(&format!("{folder}/"), ""))
}

#[test]
fn the_extension_or_the_first_character_selects_the_format() {
    let (toml, json) = ("size = [4, 3]", "  {\"size\": [4, 3]}");
    for (name, text) in [("a.toml", toml), ("a.json", json), ("a.TOML", toml)] {
        assert_eq!(load(name, text).unwrap().size, [4, 3], "{name}");
    }
    for name in ["scene", "a.txt"] {
        assert_eq!(load(name, toml).unwrap().size, [4, 3]);
        assert_eq!(load(name, json).unwrap().size, [4, 3]);
    }
    assert!(load("a.toml", json).unwrap_err().starts_with("a.toml: line 1, column 3: "));
    assert_eq!(load("mark.toml", format!("\u{feff}{toml}")).unwrap().size, [4, 3]);
}

#[test]
fn files_that_are_no_scenes_are_named() {
    let missing = Scene::load(Path::new("no-such-scene.toml")).unwrap_err().to_string();
    assert!(missing.starts_with("cannot read no-such-scene.toml: No such file"), "{missing}");
    let folder = tempfile::tempdir().unwrap();
    let message = Scene::load(folder.path()).unwrap_err().to_string();
    assert!(
        message.ends_with("it is a folder; a scene file (TOML or JSON) is needed"),
        "{message}"
    );
    assert_eq!(
        load("a.toml", b"size = [4, 4] # \xff\xfe").unwrap_err(),
        "cannot read a.toml: it is not text in UTF-8 (byte 16); a scene is TOML or JSON"
    );
    assert_eq!(
        load("a.toml", vec![b'#'; (16 << 20) + 1]).unwrap_err(),
        "cannot read a.toml: it is longer than 16 MiB, the most a scene file may be"
    );
    assert_eq!(
        load("a.toml", "size = [4, 4]\n[[lamp]]\n").unwrap_err(),
        "a.toml: line 2: `lamp[0].position` is missing"
    );
    assert!(load("a.json", "{\"size\": [0, 4]}").unwrap_err().starts_with("a.json: a grid of 0×4"));
}

#[test]
fn deep_nesting_is_rejected_at_once() {
    const LONG: usize = 10_000_000;
    const SHORT: usize = 500_000;
    let long = ["[", "{", "a.", "{\"a\":"].map(|piece| piece.repeat(LONG / piece.len()));
    let short = ["[", "{", "[[", "a=[", "a={a=", "[a.", "[{", "\"", "\n[a]", "a=1\n"];
    let short = short.into_iter().flat_map(|piece| {
        let nest = piece.repeat(SHORT / piece.len());
        [format!("a = {nest}"), format!("{{\"a\": {nest}"), nest]
    });
    for text in long.into_iter().chain(short) {
        let (start, begin) = (Instant::now(), text.get(..12).unwrap_or_default());
        let toml = Scene::from_toml(&text).unwrap_err().to_string();
        let json = Scene::from_json(&text).unwrap_err().to_string();
        println!("{begin:?}, {} bytes: {:?}", text.len(), start.elapsed());
        assert!(start.elapsed() < PATIENCE, "{begin:?} took {:?}", start.elapsed());
        // A message is for people: it does not repeat the file.
        assert!(toml.len() < 500 && json.len() < 500, "{begin:?}: {toml} {json}");
    }
}

#[test]
fn the_schema_has_every_key_and_no_other() {
    let schema = Scene::schema();
    let scene = serde_json::to_value(whole()).unwrap();
    let keys = |value: &serde_json::Value| -> Vec<String> {
        let mut keys: Vec<String> = value.as_object().unwrap().keys().cloned().collect();
        keys.sort();
        keys
    };
    let mut known = keys(&scene);
    // It is read, and not written.
    known.insert(0, "$schema".to_owned());
    assert_eq!(keys(&schema["properties"]), known);
    assert_eq!(schema["additionalProperties"], false);
    assert_eq!(schema["required"], serde_json::json!(["size"]));
    let definitions = &schema["$defs"];
    assert_eq!(keys(&definitions["Lamp"]["properties"]), keys(&scene["lamp"][0]));
    assert_eq!(keys(&definitions["Sun"]["properties"]), keys(&scene["sun"][0]));
    assert_eq!(keys(&definitions["Layers"]["properties"]), keys(&scene["layers"]));
    let mut shapes: Vec<String> =
        scene["shape"].as_array().unwrap().iter().flat_map(keys).collect();
    // A material is read, and written as the values that it stands for.
    shapes.push("material".to_owned());
    shapes.sort();
    shapes.dedup();
    assert_eq!(keys(&definitions["Shape"]["properties"]), shapes);
    assert_eq!(definitions["Shape"]["oneOf"].as_array().unwrap().len(), 5);
}

#[test]
fn the_schema_has_every_setting_and_its_range() {
    let schema = Scene::schema();
    // Settings are written with the tables of their own method.
    let mut defaults = serde_json::to_value(Settings::default()).unwrap();
    for &method in Method::ALL {
        let written = serde_json::to_value(Settings::new(method)).unwrap();
        for (key, value) in written.as_object().unwrap() {
            defaults.as_object_mut().unwrap().entry(key).or_insert(value.clone());
        }
    }
    let check = |key: &str, name: &str, value: f64| {
        let whole = (value.fract() == 0.0).then_some(value as i64);
        let value = whole.map_or(serde_json::json!(value), |whole| serde_json::json!(whole));
        let mut table = defaults.clone();
        match name {
            "" => table[key] = value,
            name => table[name][key] = value,
        }
        serde_json::from_value::<SettingsTable>(table).unwrap().resolve().is_ok()
    };
    let mut ranges = 0;
    let tables = defaults.as_object().unwrap().iter().filter(|(_, value)| value.is_object());
    let tables = tables.map(|(name, table)| (name.as_str(), table));
    for (name, table) in tables.chain([("", &defaults)]) {
        let type_name = if name.is_empty() { "settings" } else { name };
        let type_name = type_name[..1].to_uppercase() + &type_name[1..];
        let mut properties = schema["$defs"][&type_name]["properties"].as_object().unwrap().clone();
        let preset = properties.remove("preset");
        assert_eq!(preset.is_some(), Method::ALL.iter().any(|method| method.name() == name));
        // A setting that is left open is not written.
        let written = properties.iter().filter(|(key, property)| {
            property.get("default").is_some() || table[key.as_str()].is_object()
        });
        let written: BTreeSet<_> = written.map(|(key, _)| key).collect();
        assert_eq!(written, table.as_object().unwrap().keys().collect(), "{type_name}");
        for (key, property) in &properties {
            let [Some(low), Some(high)] =
                ["minimum", "maximum"].map(|bound| property[bound].as_f64())
            else {
                continue;
            };
            ranges += 1;
            let whole = property["type"] == "integer";
            let step = if whole { 1.0 } else { 1e-3 * high.max(1.0) };
            for (value, fits) in
                [(low, true), (high, true), (low - step, false), (high + step, false)]
            {
                assert_eq!(check(key, name, value), fits, "{name}.{key} = {value}");
            }
        }
    }
    assert!(ranges > 20, "{ranges}");
}

#[test]
fn warnings_name_likely_mistakes() {
    let mut scene = Scene::new(8, 8)
        .shape(Shape::rect([2.0, 3.0], [4.0, 5.0]).emission([1.0; 3]).opacity(0.0))
        .shape(Shape::circle([2.0, 2.0], 0.3))
        .shape(Shape::circle([90.0, 2.0], 3.0))
        .shape(Shape::rect([5.0, 5.0], [6.0, 6.0]).emission([1.0; 3]))
        .lamp(Lamp { position: [9.5, 4.0], ..Lamp::default() });
    let cells = scene.cells().unwrap();
    let warnings = scene.warnings(&cells);
    assert_eq!(warnings.len(), 4, "{warnings:?}");
    assert!(warnings[0].starts_with("`shape[1]` covers no cell"));
    assert!(warnings[1].starts_with("`shape[2]` covers no cell"));
    assert!(warnings[2].starts_with("`lamp[0]` is at [9.5, 4], outside the grid of 8×8"));
    assert!(warnings[3].starts_with("4 cells, the first at (2, 3), have emission but neither"));

    scene.shapes.drain(..3);
    scene.lamps.clear();
    assert!(scene.warnings(&scene.cells().unwrap()).is_empty());
}

#[test]
fn many_warnings_of_a_kind_are_one() {
    let mut scene = Scene::new(8, 8);
    for i in 0..400 {
        let position = [9.5 + i as f32, 4.0];
        scene.lamps.push(Lamp { position, color: [255.0; 3], ..Lamp::default() });
        scene.shapes.push(Shape::circle([90.0, 2.0], 3.0));
    }
    let warnings = scene.warnings(&scene.cells().unwrap());
    let begins = ["`shape[0]` covers no cell", "`lamp[0].color` =", "`lamp[0]` is at [9.5, 4]"];
    assert_eq!(warnings.len(), begins.len(), "{warnings:?}");
    for (warning, begin) in warnings.iter().zip(begins) {
        assert!(
            warning.starts_with(begin) && warning.ends_with("(the first of 400 such)"),
            "{warning}"
        );
    }
}

#[test]
fn a_lamp_of_a_shadow_map_shines_from_its_centre() {
    let warns = |x: f32, direct: Direct| {
        let wall = Shape::rect([20.0, 0.0], [24.0, 40.0]);
        let lamp = Lamp { position: [x, 20.5], size: 4.0, direct, ..Lamp::default() };
        let scene = Scene::new(40, 40).shape(wall).lamp(lamp);
        let cells = scene.cells().unwrap();
        let light = solve(&Settings::direct(Method::Cascades), &cells);
        let is_dark = light.pixels().iter().all(|rgb| rgb[1] == 0.0);
        let warnings = scene.warnings(&cells);
        assert_eq!(warnings.len(), usize::from(is_dark), "{x}, {direct:?}: {warnings:?}");
        is_dark
    };
    assert!(warns(20.5, Direct::Exact) && warns(23.5, Direct::Exact));
    assert!(!warns(19.5, Direct::Exact) && !warns(20.5, Direct::Glow));
}
