//! `reference` and `compare`: the path tracer, and the error of light against it.

use crate::arrays::view;
use crate::cells::Cells;
use crate::json::{settings, value_error};
use crate::light::Light;
use lamplight::Rgb;
use lamplight_truth::PathTracer;
use numpy::PyArray3;
use numpy::ndarray::Dim;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Light of the path tracer, with its standard error.
#[pyclass(module = "lamplight2d", frozen)]
pub struct Reference {
    light: Py<Light>,
    shape: (usize, usize),
    standard_error: Vec<Rgb>,
}

#[pymethods]
impl Reference {
    #[getter]
    fn light(&self, py: Python<'_>) -> Py<Light> {
        self.light.clone_ref(py)
    }

    #[getter]
    fn standard_error<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let (height, width) = slf.get().shape;
        view(
            Dim([height, width, 3]),
            slf.get().standard_error.as_flattened(),
            slf.clone().into_any(),
        )
    }
}

/// Computes the light of cells by tracing paths, without the GIL. Ctrl-C takes effect at its end.
///
/// Parameters
/// ----------
/// cells : Cells
/// samples : int, optional
///     Paths per cell, rounded up to a multiple of 16.
/// **settings
///     As for a solver; ``bounces``, ``wall_depth``, ``elevation`` and ``seed`` are read.
///
/// Returns
/// -------
/// Reference
#[pyfunction]
#[pyo3(signature = (cells, samples=256, **settings), text_signature = "(cells, samples=256, **settings)")]
pub fn reference(
    py: Python<'_>,
    cells: &Cells,
    samples: u32,
    settings: Option<&Bound<'_, PyDict>>,
) -> PyResult<Reference> {
    let settings = self::settings(settings)?;
    let tracer = PathTracer {
        samples,
        bounces: settings.bounces,
        wall_depth: settings.wall_depth,
        elevation: settings.elevation,
        seed: settings.seed,
    };
    let estimate = py.detach(|| tracer.render(&cells.0, &|_| {})).map_err(value_error)?;
    let light = Py::new(py, Light(estimate.light))?;
    Ok(Reference { light, shape: cells.shape(), standard_error: estimate.standard_error })
}

/// Errors of light over the open cells, each ÷ the mean of the reference.
#[pyclass(module = "lamplight2d", frozen, get_all)]
pub struct Measures {
    relative_rmse: f64,
    bias: f64,
    median: f64,
    p99: f64,
    mean: f64,
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
#[pyfunction]
pub fn compare(py: Python<'_>, light: &Light, truth: &Light) -> PyResult<Measures> {
    if light.size() != truth.size() {
        let (found, expected) = (light.size(), truth.size());
        return Err(value_error(format!("light has the shape {found:?}; expected {expected:?}")));
    }
    let (light, truth) = (&light.0, &truth.0);
    let measure = || lamplight_truth::Measures::of(light.pixels(), truth.pixels(), truth.solid());
    let lamplight_truth::Measures { relative_rmse, bias, median, p99, mean } = py.detach(measure);
    Ok(Measures { relative_rmse, bias, median, p99, mean })
}
