//! `Solver`: cells to light.

use crate::arrays::writable;
use crate::cells::Cells;
use crate::json::{object, settings, value_error};
use crate::light::Light;
use crate::threads::{SHARED, Threads};
use lamplight::SettingsTable;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A solver, which keeps its buffers from frame to frame.
///
/// Parameters
/// ----------
/// threads : int, optional
///     Threads of its own, 1 to 1024; by default all solvers share a thread per core. The light is the same.
/// **settings
///     The keys of a scene file's ``[light]``: ``method="raymarch"``, ``bounces=2``, ``raymarch={"rays": 64}``.
///
/// Raises
/// ------
/// ValueError
///     If a setting is unknown or out of its range.
#[pyclass(module = "lamplight2d", frozen)]
pub struct Solver {
    pub settings: lamplight::Settings,
    /// Threads of Python that share a solver wait for each other.
    solver: Mutex<lamplight::Solver>,
    /// Threads of its own.
    own: Option<Threads>,
}

impl Solver {
    /// Solves a frame without the GIL, and takes something from its light.
    fn light<T: Send>(
        &self,
        py: Python<'_>,
        cells: &Cells,
        take: impl FnOnce(&lamplight::Light) -> T + Send,
    ) -> PyResult<T> {
        let pool = self.threads().pool()?;
        let taken = py.detach(|| {
            // Locked outside of the pool, whose threads take up other work while they wait for a part of theirs.
            let mut solver = self.locked();
            let solver = &mut *solver;
            pool.install(|| solver.solve(&cells.0).map(take))
        });
        taken.map_err(value_error)
    }

    /// The threads that compute for it.
    pub fn threads(&self) -> &Threads {
        self.own.as_ref().unwrap_or(&SHARED)
    }

    fn locked(&self) -> MutexGuard<'_, lamplight::Solver> {
        // A solve that panicked leaves buffers that the next one fills again.
        self.solver.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Solver {
    #[new]
    #[pyo3(signature = (*, threads=None, **settings), text_signature = "(*, threads=None, **settings)")]
    fn new(threads: Option<i128>, settings: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let settings = self::settings(settings)?;
        let solver = lamplight::Solver::new(settings.clone()).map_err(value_error)?;
        let own = threads.map(Threads::new).transpose()?;
        Ok(Self { settings, solver: Mutex::new(solver), own })
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
    ///     With ``out``, no light is kept beside it: it spares the memory and the time of one copy.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If ``out`` is unsuitable, or the method cannot light the cells (``polar`` without lamps).
    #[pyo3(signature = (cells, *, out=None))]
    fn solve<'py>(
        &self,
        py: Python<'py>,
        cells: &Cells,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Some(out) = out else {
            let light = self.light(py, cells, lamplight::Light::clone)?;
            return Ok(Bound::new(py, Light(light))?.into_any());
        };
        let (height, width) = cells.shape();
        let mut array = writable(&out, &[height, width, 3])?;
        let values = array.as_slice_mut().map_err(value_error)?;
        self.light(py, cells, |light| values.copy_from_slice(light.pixels().as_flattened()))?;
        drop(array);
        Ok(out)
    }

    /// Forgets the frames so far, as after a cut: the next one is the first again.
    ///
    /// Only methods that accumulate over frames have such a history: ``flood``, ``raymarch``, and those with
    /// ``bounces="feedback"``.
    fn reset(&self, py: Python<'_>) {
        py.detach(|| self.locked().reset());
    }

    /// The settings in full, as a dict of keywords for another solver.
    #[getter]
    fn settings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        object(py, &SettingsTable::from(&self.settings))
    }

    /// The number of its own threads, or None if it shares those of all solvers.
    #[getter(threads)]
    fn own_threads(&self) -> Option<usize> {
        self.own.as_ref().and_then(Threads::count)
    }

    /// A pickle holds the settings, not the buffers.
    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyAny>)> {
        let keywords = self.settings(py)?;
        keywords.set_item("threads", self.own_threads())?;
        Ok((PyTuple::empty(py), keywords))
    }
}
