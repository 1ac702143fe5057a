//! `Tiling`: the tiles of a world, whose light passes from one into the next.

use crate::json::{value_error, whole};
use crate::light::Light;
use crate::window::{PyWindow, of_window, window};
use lamplight::world::LitTile;
use pyo3::prelude::*;

/// The tiles of a world, for `lamplight2d.World` and `lamplight2d.dask`.
///
/// Parameters
/// ----------
/// shape : tuple of int
/// side, halo : int
#[pyclass(module = "lamplight2d._core", frozen)]
pub struct Tiling {
    tiling: lamplight::world::Tiling,
    arguments: ((u32, u32), u32, u32),
}

#[pymethods]
impl Tiling {
    #[new]
    fn new(shape: (u32, u32), side: i128, halo: u32) -> PyResult<Self> {
        let side = whole("side", side, "1 or more px")?;
        let (height, width) = shape;
        let tiling = lamplight::world::Tiling::new([width, height], side, halo);
        Ok(Self { tiling: tiling.map_err(value_error)?, arguments: (shape, side, halo) })
    }

    /// The windows of all tiles, row by row.
    fn tiles(&self) -> Vec<PyWindow> {
        self.tiling.tiles().into_iter().map(of_window).collect()
    }

    /// The width of the rim, px.
    #[getter]
    fn rim(&self) -> u32 {
        self.tiling.rim()
    }

    /// Returns a tile with its rim.
    fn with_rim(&self, tile: PyWindow) -> PyResult<PyWindow> {
        self.tiling.with_rim(window(tile)?).map(of_window).map_err(value_error)
    }

    /// Returns the tiles that light a tile, each with the part of it that it lights.
    fn around(&self, tile: PyWindow) -> PyResult<Vec<(PyWindow, PyWindow)>> {
        let around = self.tiling.around(window(tile)?).map_err(value_error)?.into_iter();
        Ok(around.map(|(tile, part)| (of_window(tile), of_window(part))).collect())
    }

    /// Returns the light of a tile, from tiles around it, windows in which their light is known, and that light.
    fn mixed(
        &self,
        tile: PyWindow,
        lights: Vec<(PyWindow, PyWindow, Py<Light>)>,
    ) -> PyResult<Light> {
        let known = lights
            .iter()
            .map(|(tile, part, light)| Ok((window(*tile)?, window(*part)?, light.get())))
            .collect::<PyResult<Vec<_>>>()?;
        let lights: Vec<_> = known
            .iter()
            .map(|&(tile, window, light)| LitTile { tile, window, light: &light.0 })
            .collect();
        self.tiling.mixed(window(tile)?, &lights).map(Light).map_err(value_error)
    }

    fn __getnewargs__(&self) -> ((u32, u32), u32, u32) {
        self.arguments
    }
}
