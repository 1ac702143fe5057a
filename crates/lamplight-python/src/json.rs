//! Dictionaries to and from the notation of scene files, whose reader is the library's own.

use lamplight::{Display, Error, Scene, Settings, SettingsTable};
use pyo3::exceptions::{PyAttributeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyList};
use serde::Serialize;

/// A `ValueError` with the library's text.
pub fn value_error(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Like [`value_error`], without the line number, which means nothing in a dictionary.
pub fn without_line(error: Error) -> PyErr {
    match error {
        Error::AtLine { source, .. } => value_error(source),
        other => value_error(other),
    }
}

/// A Python object as JSON. Arrays and numbers of numpy become lists and numbers.
pub fn write(value: &Bound<'_, PyAny>) -> PyResult<String> {
    let py = value.py();
    let options = PyDict::new(py);
    options
        .set_item("default", py.import("operator")?.call_method1("methodcaller", ("tolist",))?)?;
    // JSON has no NaN and no infinity.
    options.set_item("allow_nan", false)?;
    let json = py.import("json")?;
    let text = json.call_method("dumps", (value,), Some(&options));
    let text = text.map_err(|error| {
        if error.is_instance_of::<PyAttributeError>(py) {
            let value = error.value(py).getattr("obj").and_then(|value| value.get_type().name());
            let kind = value.map_or_else(|_| "value".to_owned(), |name| name.to_string());
            return PyTypeError::new_err(format!(
                "a {kind} is given; expected a number, text, a list, a dict or an array"
            ));
        }
        if !error.is_instance_of::<PyValueError>(py) {
            return error;
        }
        // Python's error does not say where; its own notation has these numbers, so that they can be searched for.
        let found = options.del_item("allow_nan").and_then(|()| {
            let text = json.call_method("dumps", (value,), Some(&options))?;
            not_finite(&json.call_method1("loads", (text,))?, "")
        });
        match found {
            Ok(Some((key, value))) => value_error(Error::value(key, value, "finite")),
            _ => error,
        }
    });
    text?.extract()
}

/// The key of the first number that is NaN or infinite, under a key, and that number.
fn not_finite(value: &Bound<'_, PyAny>, key: &str) -> PyResult<Option<(String, f64)>> {
    if let Ok(table) = value.cast::<PyDict>() {
        for (name, value) in table {
            let dot = if key.is_empty() { "" } else { "." };
            let found = not_finite(&value, &format!("{key}{dot}{name}"))?;
            if found.is_some() {
                return Ok(found);
            }
        }
    } else if let Ok(list) = value.cast::<PyList>() {
        for (i, value) in list.iter().enumerate() {
            let found = not_finite(&value, &format!("{key}[{i}]"))?;
            if found.is_some() {
                return Ok(found);
            }
        }
    } else if value.is_instance_of::<PyFloat>() {
        let number: f64 = value.extract()?;
        return Ok((!number.is_finite()).then(|| (key.to_owned(), number)));
    }
    Ok(None)
}

/// A value of the library as Python objects.
pub fn object<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(value_error)?;
    py.import("json")?.call_method1("loads", (text,))
}

/// Settings from keywords: the keys of a scene file's `[light]`.
pub fn settings(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Settings> {
    let text = keywords.map_or(Ok("{}".to_owned()), |keywords| write(keywords))?;
    let table: SettingsTable = serde_json::from_str(&text).map_err(value_error)?;
    table.resolve().map_err(value_error)
}

/// A display from keywords: the keys of a scene file's `[display]`.
pub fn display(py: Python<'_>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Display> {
    let scene = PyDict::new(py);
    scene.set_item("size", (1, 1))?;
    scene.set_item("display", keywords.map_or_else(|| PyDict::new(py), Clone::clone))?;
    Ok(Scene::from_json(&write(&scene)?).map_err(without_line)?.display)
}

/// A whole number from Python, of which none is too large or too small for a message of the library.
pub fn whole<T: TryFrom<i128>>(name: &str, value: i128, expected: &str) -> PyResult<T> {
    T::try_from(value).map_err(|_| value_error(Error::value(name, value, expected)))
}
