//! `Scene`: a scene file.

use crate::cells::Cells;
use crate::json::{object, value_error};
use crate::threads::SHARED;
use crate::window::window;
use lamplight::GridWindow;
use lamplight::scene::SceneWorld;
use lamplight::world::WorldSource;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// A scene as its author writes it. `Scene.load` and `Scene.from_toml` make one.
#[pyclass(module = "lamplight2d", frozen)]
pub struct Scene {
    scene: Arc<lamplight::Scene>,
    file: Option<PathBuf>,
    /// Itself, window by window, when it is first needed.
    world: OnceLock<SceneWorld<Arc<lamplight::Scene>>>,
}

impl Scene {
    fn of(scene: lamplight::Scene, file: Option<PathBuf>) -> Self {
        Self { scene: Arc::new(scene), file, world: OnceLock::new() }
    }

    /// Draws a window.
    fn drawn(&self, window: GridWindow) -> lamplight::Result<lamplight::Cells> {
        let world = match self.world.get() {
            Some(world) => world,
            None => {
                let made = SceneWorld::new(self.scene.clone())?;
                self.world.get_or_init(|| made)
            }
        };
        world.cells(window)
    }
}

#[pymethods]
impl Scene {
    /// Reads a scene file. One that is larger than a grid is lit by `World`.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the file, or an image that it names, is missing or invalid; the text names it, and the line.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        // Its images are read later, perhaps from another working directory, and the file itself from a pickle.
        let file = std::path::absolute(path).map_err(value_error)?;
        let scene = lamplight::Scene::load_world(&file).map_err(value_error)?;
        Ok(Self::of(scene, Some(file)))
    }

    /// Reads a scene in TOML. Paths of its images are relative to the working directory.
    #[staticmethod]
    fn from_toml(text: &str) -> PyResult<Self> {
        let scene = lamplight::Scene::from_toml(text).map_err(value_error)?;
        Ok(Self::of(scene, None))
    }

    /// Writes the scene as TOML.
    fn to_toml(&self) -> PyResult<String> {
        self.scene.to_toml().map_err(value_error)
    }

    /// Rows and columns, (H, W).
    #[getter]
    fn shape(&self) -> (u32, u32) {
        let [width, height] = self.scene.size;
        (height, width)
    }

    /// Draws the scene.
    ///
    /// Returns
    /// -------
    /// Cells
    fn cells(&self, py: Python<'_>) -> PyResult<Cells> {
        SHARED.run(py, || self.scene.cells())?.map(Cells).map_err(value_error)
    }

    /// Draws a window of the scene.
    ///
    /// Parameters
    /// ----------
    /// y, x : int
    ///     Row and column of its first cell.
    /// height, width : int
    ///
    /// Returns
    /// -------
    /// Cells
    ///     With lamps relative to the window.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the window does not lie in the scene, or is larger than a grid.
    fn window(
        &self,
        py: Python<'_>,
        y: i128,
        x: i128,
        height: i128,
        width: i128,
    ) -> PyResult<Cells> {
        let window = window((y, x, height, width))?;
        SHARED.run(py, || self.drawn(window))?.map(Cells).map_err(value_error)
    }

    /// The settings in its ``[light]``, as keywords for a solver.
    #[getter]
    fn settings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        object(py, &self.scene.settings)
    }

    /// The settings in its ``[display]``, as keywords for ``Light.compose``.
    #[getter]
    fn display<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        object(py, &self.scene.display)
    }

    fn __repr__(&self) -> String {
        format!("<Scene of shape {:?}>", self.shape())
    }

    /// A scene from a file is pickled as the file's path, because its images lie beside it; others as their text.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, this) = (slf.py(), slf.get());
        let (reader, source) = match &this.file {
            Some(file) => ("load", file.into_pyobject(py)?.into_any()),
            None => ("from_toml", this.to_toml()?.into_pyobject(py)?.into_any()),
        };
        Ok((slf.get_type().getattr(reader)?, (source,).into_pyobject(py)?.into_any()))
    }
}
