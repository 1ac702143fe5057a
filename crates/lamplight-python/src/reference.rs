//! `reference` and `compare`: the path tracer, and the error of light against it.

use crate::arrays::{read, view};
use crate::cells::Cells;
use crate::json::{settings, value_error, whole};
use crate::light::Light;
use crate::threads::{SHARED, Threads};
use lamplight::Rgb;
use lamplight_truth::{Estimate, PathTracer, Received};
use numpy::ndarray::Dim;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::time::{Duration, Instant};

/// The time between two looks for Ctrl-C.
const PATIENCE: Duration = Duration::from_millis(50);

/// Light of the path tracer, with its standard error. `reference` returns it.
///
/// Parameters
/// ----------
/// light : Light
/// standard_error : array_like of shape (H, W, 3)
#[pyclass(module = "lamplight2d", frozen)]
pub struct Reference {
    light: Py<Light>,
    standard_error: Vec<Rgb>,
}

#[pymethods]
impl Reference {
    #[new]
    fn new(light: Py<Light>, standard_error: &Bound<'_, PyAny>) -> PyResult<Self> {
        let [height, width] = light.get().size();
        let mut values = vec![[0.0; 3]; height * width];
        read("standard_error", standard_error, &[height, width, 3], values.as_flattened_mut())?;
        Ok(Self { light, standard_error: values })
    }

    /// The light, whose noise falls as 1/√samples or faster.
    #[getter]
    fn light(&self, py: Python<'_>) -> Py<Light> {
        self.light.clone_ref(py)
    }

    /// The standard error of every cell and channel, float32 of shape (H, W, 3), from 16 independent batches of paths.
    ///
    /// In solid cells it is that of the light on their faces: 0 if none is exposed.
    #[getter]
    fn standard_error<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let [height, width] = slf.get().light.get().size();
        let values = slf.get().standard_error.as_flattened();
        view(Dim([height, width, 3]), values, slf.clone().into_any())
    }

    /// The arguments from which a pickle makes this again.
    fn __getnewargs__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Py<Light>, Bound<'py, PyArray3<f32>>)> {
        Ok((slf.get().light(slf.py()), Self::standard_error(slf)?))
    }
}

/// Computes the light of cells by tracing paths, without the GIL. Ctrl-C stops it.
///
/// Parameters
/// ----------
/// cells : Cells
/// samples : int, optional
///     Paths per cell, rounded up to a multiple of 16.
/// threads : int, optional
///     Threads of its own, 1 to 1024; by default those of all solvers, one per core. The light is the same.
/// **settings
///     As for a solver; ``bounces``, ``wall_depth``, ``elevation`` and ``seed`` are read.
///
/// Returns
/// -------
/// Reference
///
/// Raises
/// ------
/// ValueError
///     If ``samples`` is 0, or a setting is unknown or out of its range.
#[pyfunction]
#[pyo3(signature = (cells, samples=256, *, threads=None, **settings),
       text_signature = "(cells, samples=256, *, threads=None, **settings)")]
pub fn reference(
    py: Python<'_>,
    cells: &Cells,
    samples: i128,
    threads: Option<i128>,
    settings: Option<&Bound<'_, PyDict>>,
) -> PyResult<Reference> {
    let tracer = tracer(samples, settings)?;
    let own = threads.map(Threads::new).transpose()?;
    let threads = own.as_ref().unwrap_or(&SHARED);
    let tracing = threads.run(py, || tracer.prepare(&cells.0))?.map_err(value_error)?;
    let mut received = Received::default();
    let mut count = 1;
    while received.rgb.len() < cells.0.len() {
        let first = received.rgb.len();
        let start = Instant::now();
        received.append(threads.run(py, || tracing.trace(first..first + count, &|_| {}))?);
        py.check_signals()?;
        // The next part has as many cells as fit in the time.
        count = if start.elapsed() < PATIENCE { 2 * count } else { count.div_ceil(2) };
    }
    let estimate = threads.run(py, || tracing.finish(received))?.map_err(value_error)?;
    of_estimate(py, estimate)
}

fn tracer(samples: i128, settings: Option<&Bound<'_, PyDict>>) -> PyResult<PathTracer> {
    let settings = self::settings(settings)?;
    Ok(PathTracer {
        samples: whole("samples", samples, "1 to 4294967295")?,
        bounces: settings.bounces,
        wall_depth: settings.wall_depth,
        elevation: settings.elevation,
        seed: settings.seed,
    })
}

fn of_estimate(py: Python<'_>, estimate: Estimate) -> PyResult<Reference> {
    let light = Py::new(py, Light(estimate.light))?;
    Ok(Reference { light, standard_error: estimate.standard_error })
}

/// The values of a cell in a part: light, standard error, first moment.
const VALUES: usize = 12;

/// Traces some cells in row order, for `lamplight2d.dask`: an array of shape (count, 12).
#[pyfunction]
#[pyo3(signature = (cells, first, count, samples, **settings))]
pub fn trace_part<'py>(
    py: Python<'py>,
    cells: &Cells,
    first: usize,
    count: usize,
    samples: i128,
    settings: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let tracer = tracer(samples, settings)?;
    let thread = Threads::new(1)?;
    let part = first..first.saturating_add(count);
    let trace = || Ok(tracer.prepare(&cells.0)?.trace(part, &|_| {}));
    let received: lamplight::Result<Received> = thread.run(py, trace)?;
    let Received { rgb, standard_error, moment } = received.map_err(value_error)?;
    let mut values = Vec::with_capacity(rgb.len() * VALUES);
    for ((rgb, error), moment) in rgb.iter().zip(&standard_error).zip(&moment) {
        values.extend(rgb.iter().chain(error).chain(moment.as_flattened()));
    }
    PyArray1::from_vec(py, values).reshape([rgb.len(), VALUES])
}

/// Makes the reference of all parts, one below the other in an array of shape (H·W, 12).
#[pyfunction]
#[pyo3(signature = (cells, parts, samples, **settings))]
pub fn join_parts(
    py: Python<'_>,
    cells: &Cells,
    parts: &Bound<'_, PyAny>,
    samples: i128,
    settings: Option<&Bound<'_, PyDict>>,
) -> PyResult<Reference> {
    let tracer = tracer(samples, settings)?;
    let mut values = vec![[0.0; VALUES]; cells.0.len()];
    read("parts", parts, &[cells.0.len(), VALUES], values.as_flattened_mut())?;
    let mut received = Received::default();
    for [r, g, b, er, eg, eb, xr, xg, xb, yr, yg, yb] in values {
        received.rgb.push([r, g, b]);
        received.standard_error.push([er, eg, eb]);
        received.moment.push([[xr, xg, xb], [yr, yg, yb]]);
    }
    let join = || tracer.prepare(&cells.0)?.finish(received);
    of_estimate(py, SHARED.run(py, join)?.map_err(value_error)?)
}

/// Errors of light over the open cells, each ÷ the mean of the reference. `compare` returns it.
///
/// Parameters
/// ----------
/// relative_rmse, bias, median, p99, mean : float
#[pyclass(module = "lamplight2d", frozen)]
pub struct Measures(lamplight_truth::Measures);

#[pymethods]
impl Measures {
    #[new]
    fn new(relative_rmse: f64, bias: f64, median: f64, p99: f64, mean: f64) -> Self {
        Self(lamplight_truth::Measures { relative_rmse, bias, median, p99, mean })
    }

    /// The root of the mean squared error.
    #[getter]
    fn relative_rmse(&self) -> f64 {
        self.0.relative_rmse
    }

    /// The mean error: above 0 the light is too bright.
    #[getter]
    fn bias(&self) -> f64 {
        self.0.bias
    }

    /// The median of the errors' magnitudes.
    #[getter]
    fn median(&self) -> f64 {
        self.0.median
    }

    /// The magnitude that 99 % of the errors are below.
    #[getter]
    fn p99(&self) -> f64 {
        self.0.p99
    }

    /// The mean of the reference, by which the others are divided.
    #[getter]
    fn mean(&self) -> f64 {
        self.0.mean
    }

    fn __repr__(&self) -> String {
        let lamplight_truth::Measures { relative_rmse, bias, median, p99, mean } = self.0;
        format!(
            "Measures(relative_rmse={relative_rmse:.4}, bias={bias:.4}, median={median:.4}, p99={p99:.4}, \
             mean={mean:.4})"
        )
    }

    /// The arguments from which a pickle makes these again.
    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let lamplight_truth::Measures { relative_rmse, bias, median, p99, mean } = self.0;
        PyTuple::new(py, [relative_rmse, bias, median, p99, mean])
    }
}

/// Compares light with the reference.
///
/// Parameters
/// ----------
/// light, truth : Light
///     Solid cells of ``truth`` are left out.
///
/// Returns
/// -------
/// Measures
///
/// Raises
/// ------
/// ValueError
///     If the shapes differ, or all cells of ``truth`` are solid.
#[pyfunction]
pub fn compare(py: Python<'_>, light: &Light, truth: &Light) -> PyResult<Measures> {
    if light.size() != truth.size() {
        let (found, expected) = (light.size(), truth.size());
        return Err(value_error(format!("light has the shape {found:?}; expected {expected:?}")));
    }
    let (light, truth) = (&light.0, &truth.0);
    if truth.solid().iter().all(|&solid| solid) {
        return Err(value_error("truth: all cells are solid; there is no light to compare"));
    }
    let measure = || lamplight_truth::Measures::of(light.pixels(), truth.pixels(), truth.solid());
    SHARED.run(py, measure).map(Measures)
}
