//! Arrays in and out: casts of what comes in, read-only views of what goes out.

use crate::json::value_error;
use numpy::ndarray::{ArrayView, Dimension};
use numpy::{
    BorrowError, Element, PyArray, PyArrayDyn, PyArrayMethods, PyReadwriteArrayDyn,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Copies an array of numbers into `into`, which has the given shape. Float32 in C order is copied as it is; other
/// numbers and layouts are cast.
pub fn read(
    name: &str,
    value: &Bound<'_, PyAny>,
    shape: &[usize],
    into: &mut [f32],
) -> PyResult<()> {
    cast(name, value, shape, "same_kind", into)
}

/// Copies an array of bytes. Only booleans are cast: of other integers bits could be lost.
pub fn read_bytes(
    name: &str,
    value: &Bound<'_, PyAny>,
    shape: &[usize],
    into: &mut [u8],
) -> PyResult<()> {
    cast(name, value, shape, "safe", into)
}

/// Copies an array, cast by one of numpy's rules.
fn cast<T: Element + Copy>(
    name: &str,
    value: &Bound<'_, PyAny>,
    shape: &[usize],
    rule: &str,
    into: &mut [T],
) -> PyResult<()> {
    let py = value.py();
    let numpy = py.import("numpy")?;
    let options = PyDict::new(py);
    options.set_item("order", "C")?;
    options.set_item("casting", rule)?;
    options.set_item("copy", false)?;
    let array = numpy.call_method1("asarray", (value,));
    let array = array
        .and_then(|array| array.call_method("astype", (numpy::dtype::<T>(py),), Some(&options)));
    let array = array.map_err(|error| unsuitable(py, name, error))?;
    // Arrays over received bytes, as from a pickle that came in frames, may lie at odd addresses.
    let array = numpy.call_method1("require", (array, py.None(), ["C", "A"]))?;
    let array = array.cast::<PyArrayDyn<T>>()?;
    check_shape(name, array.shape(), shape)?;
    let array = array.try_readonly().map_err(|_| in_use(name))?;
    into.copy_from_slice(array.as_slice().map_err(value_error)?);
    Ok(())
}

/// The error of an array that could not be read. Only those about its values get its name: Ctrl-C during the reading of a
/// file, or what that file raises, is what the caller waits for.
fn unsuitable(py: Python<'_>, name: &str, error: PyErr) -> PyErr {
    if !error.is_instance_of::<PyTypeError>(py) && !error.is_instance_of::<PyValueError>(py) {
        return error;
    }
    let named = value_error(format!("{name}: {}", error.value(py)));
    named.set_cause(py, Some(error));
    named
}

/// The shape of an array, or of what can become one.
pub fn shape(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<usize>> {
    let py = value.py();
    let shape = py.import("numpy")?.call_method1("shape", (value,));
    shape.map_err(|error| unsuitable(py, name, error))?.extract()
}

/// The array that the caller gave to be filled: float32 in C order, writable, of the given shape.
pub fn writable<'py>(
    out: &Bound<'py, PyAny>,
    shape: &[usize],
) -> PyResult<PyReadwriteArrayDyn<'py, f32>> {
    let expected =
        || format!("out: a writable float32 array in C order of shape {shape:?} is needed");
    let array = out.cast::<PyArrayDyn<f32>>().map_err(|_| value_error(expected()))?;
    check_shape("out", array.shape(), shape)?;
    // A slice of an array in Fortran order exists too, in another order.
    if !array.is_c_contiguous() {
        return Err(value_error(expected()));
    }
    let mut array = array.try_readwrite().map_err(|error| match error {
        BorrowError::AlreadyBorrowed => in_use("out"),
        _ => value_error(expected()),
    })?;
    // It may be misaligned.
    array.as_slice_mut().map_err(|_| value_error(expected()))?;
    Ok(array)
}

/// The error of an array into which a solver writes now, without the GIL.
fn in_use(name: &str) -> PyErr {
    value_error(format!(
        "{name}: another thread solves into this array; wait for it, or use an array per thread"
    ))
}

fn check_shape(name: &str, found: &[usize], expected: &[usize]) -> PyResult<()> {
    if found == expected {
        return Ok(());
    }
    Err(value_error(format!("{name} has the shape {found:?}; expected {expected:?}")))
}

/// A read-only view of memory that `owner` keeps: `owner` must never change or free it.
pub fn view<'py, T: Element, D: Dimension>(
    shape: D,
    values: &[T],
    owner: Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray<T, D>>> {
    let array = ArrayView::from_shape(shape, values).map_err(value_error)?;
    // SAFETY: classes of this module are frozen, never change their arrays, and live as long as the view, whose base
    // they are; the view cannot be made writable, because its base offers no writable memory.
    #[allow(unsafe_code)]
    let view = unsafe { PyArray::borrow_from_array(&array, owner) };
    view.call_method1("setflags", (false,))?;
    Ok(view)
}
