//! Windows of a grid or a world, as Python has them.

use crate::json::{value_error, whole};
use lamplight::{Error, GridWindow};
use pyo3::prelude::*;

/// Rows and columns as Python has them.
pub fn rows_and_columns(shape: &Bound<'_, PyAny>) -> PyResult<[u32; 2]> {
    let sides = shape.extract::<[i128; 2]>().map(|sides| sides.map(u32::try_from));
    match sides {
        Ok([Ok(height), Ok(width)]) => Ok([height, width]),
        // No sequence, of another length, not of whole numbers, below 0, or larger than any grid.
        _ => {
            let found = shape.repr()?.to_string();
            Err(value_error(Error::value("shape", found, "two whole numbers, rows and columns")))
        }
    }
}

/// A window as Python has it: y, x, height, width.
pub type PyWindow = (i128, i128, i128, i128);

/// A window of whole numbers, of which none is too large.
pub fn window((y, x, height, width): PyWindow) -> PyResult<GridWindow> {
    let side = |name: &str, v: i128| whole(name, v, "0 or more, and lie in the world");
    Ok(GridWindow {
        first: [side("x", x)?, side("y", y)?],
        size: [side("width", width)?, side("height", height)?],
    })
}

/// A window for Python.
pub fn of_window(GridWindow { first, size }: GridWindow) -> PyWindow {
    (first[1].into(), first[0].into(), size[1].into(), size[0].into())
}
