//! `Map`: a file of a level editor.

use crate::cells::Cells;
use crate::json::value_error;
use crate::threads::SHARED;
use crate::window::window;
use lamplight::maps::MapWorld;
use lamplight::world::WorldSource;
use pyo3::prelude::*;
use std::path::PathBuf;

/// A map of Tiled (``.tmx``), a world of its maps (``.world``), or a project of LDtk (``.ldtk``). `Map.load` makes one.
///
/// Matter, lamps and suns are told by tiles, layers and objects, as docs/maps.md says.
#[pyclass(module = "lamplight2d", frozen)]
pub struct Map {
    world: MapWorld,
    file: PathBuf,
}

impl Map {
    /// The cells of a window, with the sky and the suns of all.
    fn drawn(&self, window: lamplight::GridWindow) -> lamplight::Result<lamplight::Cells> {
        let mut cells = self.world.cells(window)?;
        cells.set_sky(self.world.sky());
        *cells.suns_mut() = self.world.suns();
        Ok(cells)
    }
}

#[pymethods]
impl Map {
    /// Returns whether the ending of a path is one of those that are read.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    #[staticmethod]
    fn reads(path: PathBuf) -> bool {
        MapWorld::reads(path)
    }

    /// Opens a file. Of a world, the first map is read, for its sky and its suns; others when they are needed.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a file is missing or invalid; the text names it.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        // Maps are read when they are needed, perhaps from another working directory, and the file itself from a pickle.
        let file = std::path::absolute(path).map_err(value_error)?;
        let world = MapWorld::open(&file).map_err(value_error)?;
        Ok(Self { world, file })
    }

    /// Rows and columns, (H, W).
    #[getter]
    fn shape(&self) -> (u32, u32) {
        let [width, height] = self.world.size();
        (height, width)
    }

    /// Row and column of its first cell in the coordinates of the editor, px.
    #[getter]
    fn origin(&self) -> (i32, i32) {
        let [x, y] = self.world.origin();
        (y, x)
    }

    /// Draws all of it.
    ///
    /// Returns
    /// -------
    /// Cells
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If it is larger than a grid, or a file is missing or invalid.
    fn cells(&self, py: Python<'_>) -> PyResult<Cells> {
        SHARED.run(py, || self.world.all_cells())?.map(Cells).map_err(value_error)
    }

    /// Draws a window.
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
    ///     With the lamps that reach into the window, relative to it.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the window does not lie in the map or is larger than a grid, or a file is missing or invalid.
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

    fn __repr__(&self) -> String {
        format!("<Map of shape {:?}>", self.shape())
    }

    /// A pickle holds the path: maps are read again from their files.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (PathBuf,))> {
        Ok((slf.get_type().getattr("load")?, (slf.get().file.clone(),)))
    }
}
