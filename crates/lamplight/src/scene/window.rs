//! Scenes as worlds: any window of a scene, also of one that is larger than a grid.

use super::geometry::{Geometry, Rect};
use super::layer::ScenePlace;
use super::pictures::Pictures;
use super::{Scene, Shape};
use crate::world::WorldSource;
use crate::{Cells, Error, GridWindow, Lamp, Result, Sky, Sun};
use std::borrow::Borrow;

/// A scene of any size, drawn window by window; it may be borrowed, shared or owned.
///
/// Images are read when a window needs them: sprites, and layers in tiles. Up to [`PICTURE_BYTES`](super::PICTURE_BYTES)
/// of them are kept. Layers that are not in tiles are images of the scene's size, which are read at once.
#[derive(Debug)]
pub struct SceneWorld<S> {
    scene: S,
    /// All of it, if it has layers and none of them is in tiles.
    whole: Option<Cells>,
    pictures: Pictures,
    sky: Sky,
    suns: Vec<Sun>,
}

impl<S: Borrow<Scene>> SceneWorld<S> {
    /// Reads a scene. One with layers has to fit a grid, unless they are in tiles.
    ///
    /// # Errors
    /// As [`Scene::cells`], but for the size.
    pub fn new(source: S) -> Result<Self> {
        let scene = source.borrow();
        let [width, height] = scene.size.map(u64::from);
        let fits = Cells::check_size(width, height).is_ok();
        if let (Some(layer), false) = (scene.layers.in_one_piece(), fits) {
            let problem = format!(
                "is an image of the scene's size, which then must be one that a grid may have (at most {} a side, \
                 {} in all); cut it into tiles, named like \"{layer}/{{x}}_{{y}}.png\", or draw larger worlds with \
                 shapes and sprites",
                Cells::MAX_SIDE,
                Cells::MAX_CELLS
            );
            return Err(Error::Key { key: format!("layers.{layer}"), problem });
        }
        let in_one_piece = !scene.layers.is_empty() && !scene.layers.are_in_tiles();
        let whole = in_one_piece.then(|| scene.cells()).transpose()?;
        let pictures = Pictures::default();
        let corner = GridWindow { first: [0; 2], size: [1; 2] };
        let checked = scene.check_world().and_then(|()| {
            scene.layers.check_tiles(scene.folder(), scene.size)?;
            let bare = Scene { layers: Default::default(), ..window_of(scene, corner) };
            bare.grid(scene.folder(), &pictures, ScenePlace::whole(corner.size))
        });
        let corner = checked.map_err(|e| scene.in_its_file(e))?;
        let (sky, suns) = (corner.sky().clone(), corner.suns().to_vec());
        Ok(Self { scene: source, whole, pictures, sky, suns })
    }

    fn window(&self, window: GridWindow) -> Result<Cells> {
        let scene = self.scene.borrow();
        let place = ScenePlace { scene: scene.size, window };
        let cells = window_of(scene, window).grid(scene.folder(), &self.pictures, place);
        cells.map_err(|e| scene.in_its_file(e))
    }
}

impl<S: Borrow<Scene> + Sync> WorldSource for SceneWorld<S> {
    fn size(&self) -> [u32; 2] {
        self.scene.borrow().size
    }

    fn sky(&self) -> Sky {
        self.sky.clone()
    }

    fn suns(&self) -> Vec<Sun> {
        self.suns.clone()
    }

    fn cells(&self, window: GridWindow) -> Result<Cells> {
        window.check(self.size())?;
        match &self.whole {
            Some(whole) => WorldSource::cells(whole, window),
            None => self.window(window),
        }
    }
}

/// Returns the scene with the positions that its shapes and lamps have in a window.
fn window_of(scene: &Scene, window: GridWindow) -> Scene {
    let by = window.first.map(|v| -(v as f32));
    let shapes = scene
        .shapes
        .iter()
        .map(|shape| Shape { geometry: moved(&shape.geometry, by), ..shape.clone() });
    let lamps =
        scene.lamps.iter().map(|lamp| Lamp { position: sum(lamp.position, by), ..lamp.clone() });
    Scene { size: window.size, shapes: shapes.collect(), lamps: lamps.collect(), ..scene.clone() }
}

fn sum(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// Returns a geometry elsewhere.
fn moved(geometry: &Geometry, by: [f32; 2]) -> Geometry {
    let mut moved = geometry.clone();
    let points: Vec<&mut [f32; 2]> = match &mut moved {
        Geometry::Circle(circle) => vec![&mut circle.center],
        Geometry::Rect(Rect::Corners { min, max }) => vec![min, max],
        Geometry::Rect(Rect::Sized { center, .. }) => vec![center],
        Geometry::Polygon(polygon) => polygon.points.iter_mut().collect(),
        Geometry::Line(line) => vec![&mut line.from, &mut line.to],
        Geometry::Sprite(sprite) => vec![&mut sprite.center],
    };
    for point in points {
        *point = sum(*point, by);
    }
    moved
}
