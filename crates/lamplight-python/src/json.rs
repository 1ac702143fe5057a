//! Dictionaries to and from the notation of scene files, whose reader is the library's own.

use lamplight::{Error, Settings, SettingsTable};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::Display;

/// A `ValueError` with the library's text.
pub fn value_error(error: impl Display) -> PyErr {
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
    // JSON has no NaN and no infinity: a ValueError.
    options.set_item("allow_nan", false)?;
    py.import("json")?.call_method("dumps", (value,), Some(&options))?.extract()
}

/// A value of the library as Python objects.
pub fn object<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(value_error)?;
    py.import("json")?.call_method1("loads", (text,))
}

/// A value of the library from keywords.
pub fn from_keywords<T: DeserializeOwned>(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<T> {
    let text = keywords.map_or(Ok("{}".to_owned()), |keywords| write(keywords))?;
    serde_json::from_str(&text).map_err(value_error)
}

/// Settings from keywords: the keys of a scene file's `[light]`.
pub fn settings(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Settings> {
    from_keywords::<SettingsTable>(keywords)?.resolve().map_err(value_error)
}
