//! `Solver`: cells to light.

use crate::arrays::write;
use crate::cells::Cells;
use crate::json::{object, settings, value_error};
use crate::light::Light;
use lamplight::SettingsTable;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::{Mutex, PoisonError};

/// A solver, which keeps its buffers from frame to frame.
///
/// Parameters
/// ----------
/// threads : int, optional
///     Threads of its own; by default it shares a pool with a thread per core. The light is the same.
/// **settings
///     The keys of a scene file's ``[light]``: ``method="raymarch"``, ``bounces=2``, ``raymarch={"rays": 64}``.
#[pyclass(module = "lamplight2d", frozen)]
pub struct Solver {
    settings: lamplight::Settings,
    /// Threads of Python that share a solver wait for each other.
    solver: Mutex<lamplight::Solver>,
    threads: Option<usize>,
    /// None: the pool that all solvers share, with a thread per core.
    pool: Option<ThreadPool>,
}

#[pymethods]
impl Solver {
    #[new]
    #[pyo3(signature = (*, threads=None, **settings), text_signature = "(*, threads=None, **settings)")]
    fn new(threads: Option<usize>, settings: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let settings = self::settings(settings)?;
        let solver = lamplight::Solver::new(settings.clone()).map_err(value_error)?;
        let pool = threads.map(|n| ThreadPoolBuilder::new().num_threads(n).build()).transpose();
        Ok(Self { settings, solver: Mutex::new(solver), threads, pool: pool.map_err(value_error)? })
    }

    /// Computes the light of cells, without the GIL.
    ///
    /// Parameters
    /// ----------
    /// cells : Cells
    /// out : ndarray, optional
    ///     A writable float32 array in C order of shape (H, W, 3), which receives the light and is returned.
    ///
    /// Returns
    /// -------
    /// Light or ndarray
    #[pyo3(signature = (cells, *, out=None))]
    fn solve<'py>(
        &self,
        py: Python<'py>,
        cells: &Cells,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let light = py.detach(|| {
            // A solve that panicked leaves buffers that the next one fills again.
            let mut guard = self.solver.lock().unwrap_or_else(PoisonError::into_inner);
            let solver = &mut *guard;
            let mut solve = || solver.solve(&cells.0).cloned();
            match &self.pool {
                Some(pool) => pool.install(solve),
                None => solve(),
            }
        });
        let light = light.map_err(value_error)?;
        let Some(out) = out else { return Ok(Bound::new(py, Light(light))?.into_any()) };
        let (height, width) = cells.shape();
        write(&out, &[height, width, 3], light.pixels().as_flattened())?;
        Ok(out)
    }

    #[getter]
    fn settings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        object(py, &SettingsTable::from(&self.settings))
    }

    #[getter]
    fn threads(&self) -> Option<usize> {
        self.threads
    }

    /// A pickle holds the settings, not the buffers.
    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyAny>)> {
        let keywords = self.settings(py)?;
        keywords.set_item("threads", self.threads)?;
        Ok((PyTuple::empty(py), keywords))
    }
}
