//! Scenes as worlds: any window of a scene, also of one that is larger than a grid.

use super::geometry::{Geometry, Rect};
use super::{Scene, Shape};
use crate::world::WorldSource;
use crate::{Cells, Error, GridWindow, Lamp, Result, Sky, Sun};
use std::borrow::Borrow;

/// A scene of any size, drawn window by window; it may be borrowed, shared or owned.
#[derive(Debug)]
pub struct SceneWorld<S> {
    scene: S,
    /// All of it, if it has layers, which are images of its size.
    whole: Option<Cells>,
    sky: Sky,
    suns: Vec<Sun>,
}

impl<S: Borrow<Scene>> SceneWorld<S> {
    /// Reads a scene. One with layers has to fit a grid.
    ///
    /// # Errors
    /// As [`Scene::cells`], but for the size.
    pub fn new(source: S) -> Result<Self> {
        let scene = source.borrow();
        let [width, height] = scene.size.map(u64::from);
        let fits = Cells::check_size(width, height).is_ok();
        if !scene.layers.is_empty() && !fits {
            let problem = format!(
                "are images of the scene's size, which then must be one that a grid may have (at most {} a side, \
                 {} in all); draw larger worlds with shapes and sprites",
                Cells::MAX_SIDE,
                Cells::MAX_CELLS
            );
            return Err(Error::Key { key: "layers".into(), problem });
        }
        let whole = (!scene.layers.is_empty()).then(|| scene.cells()).transpose()?;
        let corner = window_of(scene, GridWindow { first: [0; 2], size: [1; 2] }).cells()?;
        let (sky, suns) = (corner.sky().clone(), corner.suns().to_vec());
        Ok(Self { scene: source, whole, sky, suns })
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
            None => window_of(self.scene.borrow(), window).cells(),
        }
    }
}

/// Returns the scene as seen from a window, without layers.
fn window_of(scene: &Scene, window: GridWindow) -> Scene {
    let by = window.first.map(|v| -(v as f32));
    let shapes = scene
        .shapes
        .iter()
        .map(|shape| Shape { geometry: moved(&shape.geometry, by), ..shape.clone() });
    let lamps =
        scene.lamps.iter().map(|lamp| Lamp { position: sum(lamp.position, by), ..lamp.clone() });
    Scene {
        size: window.size,
        shapes: shapes.collect(),
        lamps: lamps.collect(),
        layers: Default::default(),
        ..scene.clone()
    }
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
