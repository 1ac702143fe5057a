//! `FarWorld`: the far field of a world, from parts that are read anywhere, and the light of its tiles.
//!
//! The cells come from Python: `lamplight2d.World` reads them window by window, here or on another machine.

use crate::cells::Cells;
use crate::json::{object, value_error, whole, without_line, write};
use crate::light::Light;
use crate::solver::Solver;
use crate::window::{PyWindow, of_window, rows_and_columns, window};
use lamplight::world::{FarPart, WorldSettings, lamps_within};
use lamplight::{Error, Lamp, Panorama, Scene};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::{PyBytes, PyDict};
use serde::Serialize;

/// The far field of a world, for `lamplight2d.World` and `lamplight2d.dask`.
///
/// Parameters
/// ----------
/// shape : tuple of int
/// around : Cells
///     Their sky and their suns are those of the world.
/// solver : Solver
/// halo, columns : int
/// blocks : bytes, optional
///     What `blocks` has returned, of all or for one tile.
#[pyclass(module = "lamplight2d._core", frozen)]
pub struct FarWorld {
    world: lamplight::world::FarWorld,
    around: Py<Cells>,
    solver: Py<Solver>,
    settings: WorldSettings,
    has_blocks: bool,
}

/// The arguments from which a pickle makes a far world again.
type Arguments<'py> = ((u32, u32), Py<Cells>, Py<Solver>, u32, usize, Option<Bound<'py, PyBytes>>);

#[pymethods]
impl FarWorld {
    #[new]
    #[pyo3(signature = (shape, around, solver, halo, columns, blocks=None))]
    fn new(
        py: Python<'_>,
        shape: &Bound<'_, PyAny>,
        around: Py<Cells>,
        solver: Py<Solver>,
        halo: i128,
        columns: i128,
        blocks: Option<PyBackedBytes>,
    ) -> PyResult<Self> {
        let most = Panorama::MAX_COLUMNS;
        if !(1..=most as i128).contains(&columns) {
            return Err(value_error(Error::value("columns", columns, format!("1 to {most}"))));
        }
        let settings = WorldSettings {
            solver: solver.get().settings.clone(),
            halo: whole("halo", halo, "0 or more")?,
            columns: columns as usize,
        };
        let [height, width] = rows_and_columns(shape)?;
        let size = [width, height];
        let (sky, suns) = (around.get().0.sky(), around.get().0.suns());
        let has_blocks = blocks.is_some();
        let world = py.detach(|| match blocks {
            None => lamplight::world::FarWorld::new(size, sky, suns, settings.clone())
                .map_err(value_error),
            Some(blocks) => {
                let damaged = |_| value_error("blocks is damaged; expected what `blocks` returns");
                let blocks = postcard::from_bytes(&blocks).map_err(damaged)?;
                lamplight::world::FarWorld::of_blocks(size, sky, suns, settings.clone(), blocks)
                    .map_err(value_error)
            }
        })?;
        Ok(Self { world, around, solver, settings, has_blocks })
    }

    /// Rows and columns, (H, W).
    #[getter]
    fn shape(&self) -> (u32, u32) {
        let [width, height] = self.world.size();
        (height, width)
    }

    /// The parts in which the world is read, each with the window of the cells that it needs.
    fn parts(&self) -> PyResult<Vec<(PyWindow, PyWindow)>> {
        let parts = self.world.parts().into_iter();
        let around = |part| self.world.around_part(part).map_err(value_error);
        parts.map(|part| Ok((of_window(part), of_window(around(part)?)))).collect()
    }

    /// Reads a part from its cells.
    fn read<'py>(
        &self,
        py: Python<'py>,
        part: PyWindow,
        cells: &Cells,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let part = window(part)?;
        self.packed_part(py, || self.world.read(part, cells.0.clone()))
    }

    /// True if a finished one lacks a bounce.
    #[getter]
    fn goes_on(&self) -> bool {
        self.has_blocks && self.world.goes_on()
    }

    /// Finds one bounce more of a part, from the cells around it as a tile.
    fn bounce<'py>(
        &self,
        py: Python<'py>,
        part: PyWindow,
        cells: &Cells,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let part = window(part)?;
        self.packed_part(py, || self.world.bounce(part, cells.0.clone()))
    }

    /// Returns the far world of all parts, in their order, which may be read while they are asked for; of a finished one,
    /// that of their next bounce.
    fn finished(&self, py: Python<'_>, parts: &Bound<'_, PyAny>) -> PyResult<Self> {
        let mut far = self.with(py, None)?;
        if self.has_blocks {
            far.world = self.world.after();
        }
        for part in parts.try_iter()? {
            let part: PyBackedBytes = part?.extract()?;
            let world = &mut far.world;
            py.detach(|| {
                let damaged = |_| value_error("a part is damaged; expected what `read` returns");
                let part: FarPart = postcard::from_bytes(&part).map_err(damaged)?;
                world.add(part).map_err(value_error)
            })?;
        }
        let world = &mut far.world;
        self.solver.get().threads().run(py, || world.finish())?;
        far.has_blocks = true;
        Ok(far)
    }

    /// Returns the window of cells that light a tile. It is refused here if it is no grid, before anybody reads its cells.
    fn around_tile(&self, tile: PyWindow) -> PyResult<PyWindow> {
        let tile = window(tile)?;
        let around = self.world.around_tile(tile).map_err(value_error)?;
        let [width, height] = around.size.map(u64::from);
        lamplight::Cells::check_size(width, height).map_err(|error| {
            let [width, height] = tile.size;
            value_error(format!("a tile of {width}×{height} cells with its halo: {error}"))
        })?;
        Ok(of_window(around))
    }

    /// Returns its blocks, or those of them that light a tile.
    #[pyo3(signature = (tile=None))]
    fn blocks<'py>(
        &self,
        py: Python<'py>,
        tile: Option<PyWindow>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let tile = tile.map(window).transpose()?;
        let blocks = py.detach(|| packed(&self.world.blocks(tile).map_err(value_error)?))?;
        Ok(PyBytes::new(py, &blocks))
    }

    /// Returns the far world that has these blocks.
    fn with_blocks(&self, py: Python<'_>, blocks: PyBackedBytes) -> PyResult<Self> {
        self.with(py, Some(blocks))
    }

    /// Returns the light of a tile from its cells, or of a window around it.
    #[pyo3(signature = (tile, cells, around=None))]
    fn light(
        &self,
        py: Python<'_>,
        tile: PyWindow,
        cells: &Cells,
        around: Option<PyWindow>,
    ) -> PyResult<Light> {
        let (lit, tile) = (window(around.unwrap_or(tile))?, window(tile)?);
        let light = || self.world.light_in(lit, tile, cells.0.clone());
        self.solver.get().threads().run(py, light)?.map(Light).map_err(value_error)
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<Arguments<'py>> {
        let blocks = if self.has_blocks { Some(self.blocks(py, None)?) } else { None };
        let WorldSettings { halo, columns, .. } = self.settings;
        let (around, solver) = (self.around.clone_ref(py), self.solver.clone_ref(py));
        Ok((self.shape(), around, solver, halo, columns, blocks))
    }
}

impl FarWorld {
    /// Finds something of a part, in a few bytes.
    fn packed_part<'py>(
        &self,
        py: Python<'py>,
        find: impl FnOnce() -> lamplight::Result<FarPart> + Send,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let found = || find().map(|part| packed(&part));
        let found = self.solver.get().threads().run(py, found)?;
        Ok(PyBytes::new(py, &found.map_err(value_error)??))
    }

    /// The far world of the same source and settings with other blocks.
    fn with(&self, py: Python<'_>, blocks: Option<PyBackedBytes>) -> PyResult<Self> {
        let shape = self.shape().into_pyobject(py)?;
        let (around, solver) = (self.around.clone_ref(py), self.solver.clone_ref(py));
        let WorldSettings { halo, columns, .. } = self.settings;
        Self::new(py, shape.as_any(), around, solver, halo.into(), columns as i128, blocks)
    }
}

/// A value in a few bytes.
fn packed(value: &impl Serialize) -> PyResult<Vec<u8>> {
    postcard::to_stdvec(value).map_err(value_error)
}

/// The lamps of a world, for `lamplight2d.World`.
///
/// Parameters
/// ----------
/// lamps : list of dict
#[pyclass(module = "lamplight2d._core", frozen)]
pub struct Lamps(Vec<Lamp>);

#[pymethods]
impl Lamps {
    #[new]
    fn new(lamps: &Bound<'_, PyAny>) -> PyResult<Self> {
        let scene = PyDict::new(lamps.py());
        scene.set_item("size", (1, 1))?;
        scene.set_item("lamp", lamps)?;
        let scene = Scene::from_json(&write(&scene)?).map_err(without_line)?;
        Ok(Self(scene.lamps))
    }

    /// Returns those that reach into a window, a dict each, with positions relative to it.
    fn within<'py>(&self, py: Python<'py>, within: PyWindow) -> PyResult<Bound<'py, PyAny>> {
        object(py, &lamps_within(&self.0, window(within)?))
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>,)> {
        Ok((object(py, &self.0)?,))
    }
}
