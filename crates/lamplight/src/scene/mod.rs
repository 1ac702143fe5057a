//! Scenes as authors write them: layers, shapes, lamps and a sky, in a file or in code.

pub(crate) mod cookie;
pub(crate) mod coverage;
mod file;
mod geometry;
mod layer;
mod layers;
mod material;
pub(crate) mod picture;
pub(crate) mod pictures;
pub(crate) mod raster;
mod shape;
mod sky;
pub(crate) mod source;
mod thin_wall;
mod window;

pub use geometry::{Circle, Geometry, Line, Polygon, Rect, Sprite};
pub use layers::{Layers, NormalY};
pub use material::Material;
pub use pictures::PICTURE_BYTES;
pub use shape::{Only, Shape};
pub use sky::{SceneSky, SkyPicture};
pub use window::SceneWorld;

use crate::{Cells, Display, Lamp, Result, Settings, SettingsTable, Sun, exact, tiling};
use coverage::Window;
use layer::ScenePlace;
use pictures::Pictures;
use schemars::JsonSchema;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use source::Source;
use std::path::{Path, PathBuf};

/// A scene as its author writes it; [`Scene::cells`] makes the grid that methods read.
///
/// ```
/// use lamplight::{Lamp, Scene, Shape};
/// let mut scene = Scene::new(64, 48)
///     .shape(Shape::rect([30.0, 8.0], [34.0, 40.0]).albedo([0.9, 0.3, 0.2]))
///     .lamp(Lamp { position: [16.0, 24.0], intensity: 4.0, ..Lamp::default() });
/// scene.settings.set("bounces", 2);
/// let cells = scene.cells()?;
/// assert_eq!(cells.width(), 64);
/// assert_eq!(scene, Scene::from_toml(&scene.to_toml()?)?);
/// # Ok::<(), lamplight::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Columns and rows of the grid, each from 1.
    #[serde(deserialize_with = "exact::one")]
    pub size: [u32; 2],
    /// Linear RGB radiance that comes from beyond the grid: one colour, a gradient, or a panorama.
    #[serde(default, skip_serializing_if = "SceneSky::is_default")]
    pub sky: SceneSky,
    /// Images that fill the grid under the shapes.
    #[serde(default, skip_serializing_if = "Layers::is_empty")]
    pub layers: Layers,
    /// Shapes, drawn over the layers in this order.
    #[serde(default, rename = "shape", skip_serializing_if = "Vec::is_empty")]
    pub shapes: Vec<Shape>,
    /// Lamps.
    #[serde(default, rename = "lamp", skip_serializing_if = "Vec::is_empty")]
    pub lamps: Vec<Lamp>,
    /// Suns: parallel light from beyond the grid.
    #[serde(default, rename = "sun", skip_serializing_if = "Vec::is_empty")]
    pub suns: Vec<Sun>,
    /// The scene's own settings; those of the command line override them.
    #[serde(default, rename = "light", skip_serializing_if = "SettingsTable::is_empty")]
    pub settings: SettingsTable,
    /// The conversion of light to the final picture.
    #[serde(default)]
    pub display: Display,
    /// The address of the JSON Schema, for editors. It has no effect.
    #[serde(rename = "$schema", default, skip_serializing)]
    #[schemars(with = "String")]
    schema: IgnoredAny,
    /// The file it was read from; relative paths start at its folder.
    #[serde(skip)]
    file: PathBuf,
}

impl Scene {
    /// An empty scene under a black sky. Its size is checked by [`Scene::cells`].
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            size: [width, height],
            sky: SceneSky::default(),
            layers: Layers::default(),
            shapes: Vec::new(),
            lamps: Vec::new(),
            suns: Vec::new(),
            settings: SettingsTable::default(),
            display: Display::default(),
            schema: IgnoredAny,
            file: PathBuf::new(),
        }
    }

    /// Sets the sky: a colour, a gradient, a panorama, a picture of one, or a [`crate::Sky`].
    #[must_use]
    pub fn sky(self, sky: impl Into<SceneSky>) -> Self {
        Self { sky: sky.into(), ..self }
    }

    /// Adds a shape over the others.
    #[must_use]
    pub fn shape(mut self, shape: Shape) -> Self {
        self.shapes.push(shape);
        self
    }

    /// Adds a lamp.
    #[must_use]
    pub fn lamp(mut self, lamp: Lamp) -> Self {
        self.lamps.push(lamp);
        self
    }

    /// Adds a sun.
    #[must_use]
    pub fn sun(mut self, sun: Sun) -> Self {
        self.suns.push(sun);
        self
    }

    /// The grid: layers, then sprites and shapes in order, and the lamps beside them.
    ///
    /// Nothing that grows with the size is allocated before the size is found good.
    pub fn cells(&self) -> Result<Cells> {
        self.whole(self.folder()).map_err(|e| self.in_its_file(e))
    }

    /// Like [`Self::cells`], with the bytes of images from `files`, by the paths in the scene. Nothing is
    /// read from disk, as in a browser or for untrusted scenes.
    pub fn cells_with<'a>(&self, files: impl Fn(&Path) -> Option<&'a [u8]>) -> Result<Cells> {
        self.whole(Source::Given(&|path: &Path| files(path))).map_err(|e| self.in_its_file(e))
    }

    /// The folder in which relative paths start.
    fn folder(&self) -> Source<'_> {
        Source::Folder(self.file.parent().unwrap_or(&self.file))
    }

    fn whole(&self, source: Source) -> Result<Cells> {
        self.check()?;
        self.layers.check_tiles(source, self.size)?;
        self.grid(source, &Pictures::default(), ScenePlace::whole(self.size))
    }

    /// The grid of a window, from which shapes and lamps have their positions. Layers are at their place in the scene.
    fn grid(&self, source: Source, pictures: &Pictures, place: ScenePlace) -> Result<Cells> {
        let [width, height] = place.window.size;
        let mut cells = Cells::new(width, height)?;
        cells.set_sky(self.sky.read(source)?);
        self.layers.read(source, pictures, place, &mut cells)?;
        for (i, shape) in self.shapes.iter().enumerate() {
            raster::paint(shape, &format!("shape[{i}]"), source, pictures, &mut cells)?;
        }
        *cells.lamps_mut() = cookie::with_pixels(&self.lamps, source)?;
        cells.suns_mut().clone_from(&self.suns);
        Ok(cells)
    }

    /// The files that the scene reads: its own, if it came from one, and its images, of tiles those that exist.
    pub fn files(&self) -> Vec<PathBuf> {
        let folder = self.file.parent().unwrap_or(&self.file);
        let own = Some(&self.file).filter(|file| !file.as_os_str().is_empty());
        let sprites = self.shapes.iter().filter_map(|shape| match &shape.geometry {
            Geometry::Sprite(sprite) => Some(&sprite.image),
            _ => None,
        });
        let layers = self.layers.images(self.size, |image| folder.join(image).exists());
        let images = self.sky.image().into_iter().chain(&layers).chain(sprites);
        let images = images.map(|image| folder.join(image));
        own.cloned().into_iter().chain(images).chain(self.cookies()).collect()
    }

    /// The images of the lamps' cookies, lamp by lamp.
    pub fn cookies(&self) -> impl Iterator<Item = PathBuf> {
        let folder = self.file.parent().unwrap_or(&self.file);
        self.lamps.iter().filter_map(cookie::image).map(|image| folder.join(image))
    }

    /// Resolves and checks the scene's settings.
    ///
    /// # Errors
    /// Fails if a key is unknown or a value is out of its range.
    pub fn resolve_settings(&self) -> Result<Settings> {
        self.own_settings().map_err(|e| self.in_its_file(e))
    }

    fn own_settings(&self) -> Result<Settings> {
        self.settings.resolve().map_err(|e| e.under("light"))
    }

    /// Refuses values that no scene has. Images are not opened.
    fn check(&self) -> Result<()> {
        let [width, height] = self.size.map(u64::from);
        Cells::check_size(width, height)?;
        self.check_contents()
    }

    /// Like [`Self::check`], of a scene that may be larger than a grid.
    fn check_world(&self) -> Result<()> {
        tiling::check_size(self.size)?;
        self.check_contents()
    }

    fn check_contents(&self) -> Result<()> {
        self.sky.check()?;
        self.layers.check()?;
        for (i, shape) in self.shapes.iter().enumerate() {
            shape.check(&format!("shape[{i}]"))?;
        }
        for (i, lamp) in self.lamps.iter().enumerate() {
            lamp.check_in_scene(&format_args!("lamp[{i}]"))?;
        }
        for (i, sun) in self.suns.iter().enumerate() {
            sun.check(&format_args!("sun[{i}]"))?;
        }
        self.display.check().map_err(|e| e.under("display"))?;
        self.own_settings().map(|_| ())
    }

    /// JSON Schema (2020-12) of scene files, for editors.
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(Scene).to_value()
    }

    /// Warnings about input that is valid and probably a mistake, one sentence each: matter that glows
    /// and emits no light, shapes and lamps that are not visible.
    pub fn warnings(&self, cells: &Cells) -> Vec<String> {
        let window = Window::grid(cells.width(), cells.height());
        let unseen = |(i, shape): (usize, &Shape)| {
            let is_sprite = matches!(shape.geometry, Geometry::Sprite(_));
            (!is_sprite && raster::covered(shape, &window) == 0).then(|| {
                format!(
                    "`shape[{i}]` covers no cell: it lies outside the grid or, without antialiasing, \
                     between the centres of cells"
                )
            })
        };
        let mut warnings = first_of_many(self.shapes.iter().enumerate().filter_map(unseen));
        let [width, height] = [cells.width(), cells.height()].map(|n| n as f32);
        let [mut bright, mut outside, mut walled_in] = [const { Vec::new() }; 3];
        for (i, lamp) in cells.lamps().iter().enumerate() {
            if lamp.color.iter().any(|&c| c >= EIGHT_BIT) {
                let [r, g, b] = lamp.color;
                bright.push(format!(
                    "`lamp[{i}].color` = [{r}, {g}, {b}] is far above 1, like a colour of 0 to 255: write \
                     \"#rrggbb\", or linear values up to 1 and an `intensity`"
                ));
            }
            let [x, y] = lamp.position;
            if !((0.0..=width).contains(&x) && (0.0..=height).contains(&y)) {
                // Lit by a shadow map, it lights from there as well.
                if !lamp.is_exact() {
                    outside.push(format!(
                        "`lamp[{i}]` is at [{x}, {y}], outside the grid of {width}×{height}: polar \
                         and flood light from there, the others see what of its disc lies inside"
                    ));
                }
            } else if is_walled_in(lamp, cells) {
                walled_in.push(format!(
                    "`lamp[{i}]` at [{x}, {y}] is inside a wall, which its light does not leave"
                ));
            }
        }
        warnings.extend([bright, outside, walled_in].into_iter().flat_map(first_of_many));
        let mut idle = (0..cells.len()).filter(|&i| {
            let matter = cells.matter(i);
            matter.emission.iter().any(|&e| e > 0.0)
                && matter.opacity == 0.0
                && matter.tint == [1.0; 3]
        });
        if let Some(first) = idle.next() {
            let (n, width) = (1 + idle.count(), cells.width() as usize);
            warnings.push(format!(
                "{n} cells, the first at ({}, {}), have emission but neither opacity nor tint: \
                 what absorbs no light gives off none (`glow` needs no opacity)",
                first % width,
                first / width
            ));
        }
        let solid = |i: usize| cells.is_solid(i) && cells.matter(i).glow != [0.0; 3];
        let glowing = cells.glow().map_or(0, |glow| (0..glow.len()).filter(|&i| solid(i)).count());
        if glowing > 0 {
            warnings.push(format!(
                "{glowing} solid cells have glow, which does not leave them: use emission, or an opacity \
                 below 1"
            ));
        }
        warnings
    }
}

/// A channel of a lamp's colour from which on it is probably meant as one of 0 to 255.
const EIGHT_BIT: f32 = 32.0;

/// The most warnings of a kind that are listed one by one.
const LISTED: usize = 4;

/// Returns the warnings of a kind, of many the first.
fn first_of_many(found: impl IntoIterator<Item = String>) -> Vec<String> {
    let mut found: Vec<_> = found.into_iter().collect();
    let count = found.len();
    if count > LISTED {
        found.truncate(1);
        found[0] += &format!(" (the first of {count} such)");
    }
    found
}

/// True if the light of a lamp in the grid does not leave a wall: every cell that its disc covers or touches is solid or,
/// if it is lit by a shadow map, the one at its centre.
fn is_walled_in(lamp: &Lamp, cells: &Cells) -> bool {
    if lamp.is_exact() {
        let [x, y] = lamp.position.map(|v| v as u32);
        return cells.get(x, y).is_some_and(|matter| matter.opacity >= 1.0);
    }
    let (center, reach) = (lamp.position.map(f64::from), f64::from(lamp.size) + 1.0);
    let window = Window::grid(cells.width(), cells.height());
    let mut solid = true;
    coverage::disc_centres(center, reach, &window, |x, y| {
        solid &= cells.is_solid(cells.index(x as u32, y as u32));
    });
    solid
}
