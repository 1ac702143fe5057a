//! `Scene`: a scene file.

use crate::cells::Cells;
use crate::json::{object, value_error};
use crate::threads::SHARED;
use pyo3::prelude::*;
use std::path::PathBuf;

/// A scene as its author writes it. `Scene.load` and `Scene.from_toml` make one.
#[pyclass(module = "lamplight2d", frozen)]
pub struct Scene {
    scene: lamplight::Scene,
    file: Option<PathBuf>,
}

#[pymethods]
impl Scene {
    /// Reads a scene file.
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
        let scene = lamplight::Scene::load(&path).map_err(value_error)?;
        // It is also read again elsewhere, from a pickle.
        let file = std::path::absolute(path).map_err(value_error)?;
        Ok(Self { scene, file: Some(file) })
    }

    /// Reads a scene in TOML. Paths of its images are relative to the working directory.
    #[staticmethod]
    fn from_toml(text: &str) -> PyResult<Self> {
        let scene = lamplight::Scene::from_toml(text).map_err(value_error)?;
        Ok(Self { scene, file: None })
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
