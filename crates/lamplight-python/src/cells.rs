//! `Cells`: the grid of matter, from arrays.

use crate::arrays::{read, read_bytes, view};
use crate::json::{object, value_error, without_line, write};
use crate::threads::SHARED;
use crate::window::{PyWindow, rows_and_columns, window};
use lamplight::world::WorldSource;
use lamplight::{Error, GridWindow, Rgb};
use numpy::ndarray::{Dim, Ix2, Ix3};
use numpy::{PyArray2, PyArray3};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// The grid of matter, lamps, suns and sky. It is copied from arrays, and never changes.
///
/// Float32 in C order is copied as it is. Other layouts, float64, integers and booleans are cast to float32 by their
/// value (an image of 0 to 255 has to be decoded first); complex numbers and text are refused.
///
/// Parameters
/// ----------
/// shape : tuple of int
///     Rows and columns, (H, W). Row 0 is the top one.
/// emission, glow, tint, albedo, color, normals : array_like of shape (H, W, 3), optional
///     Linear RGB; normals are unit vectors with x to the right, y down and z towards the viewer.
/// opacity : array_like of shape (H, W), optional
///     The fraction of light absorbed per px; 1 is solid.
/// masks : array_like of uint8 of shape (H, W), optional
///     The layers of every cell, a bit each.
/// lamps, suns : list of dict, optional
///     With the keys of a scene file: ``{"position": [8, 8], "color": "#ff8800"}``.
/// sky : list or dict, optional
///     A colour, a gradient or a panorama, as in a scene file.
///
/// Raises
/// ------
/// ValueError
///     If a shape is wrong, or a value is NaN or out of range; the text names the cell and what would be right.
#[pyclass(module = "lamplight2d", frozen)]
pub struct Cells(pub lamplight::Cells);

#[pymethods]
impl Cells {
    #[new]
    #[pyo3(signature = (shape, **fields), text_signature = "(shape, *, emission=None, glow=None, opacity=None, \
        tint=None, albedo=None, color=None, normals=None, masks=None, lamps=None, suns=None, sky=None)")]
    fn new(shape: &Bound<'_, PyAny>, fields: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::of_fields(shape.py(), rows_and_columns(shape)?, fields, [0, 0])
    }

    /// Rows and columns, (H, W).
    #[getter]
    pub fn shape(&self) -> (usize, usize) {
        (self.0.height() as usize, self.0.width() as usize)
    }

    /// Emitted radiance of matter, linear RGB, float32 of shape (H, W, 3).
    #[getter]
    fn emission<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        rgb(slf, slf.get().0.emission())
    }

    /// Radiance added per px, which needs no opacity, linear RGB, float32 of shape (H, W, 3), or None.
    #[getter]
    fn glow<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyArray3<f32>>>> {
        slf.get().0.glow().map(|glow| rgb(slf, glow)).transpose()
    }

    /// The fraction of light absorbed per px, 0 to 1, float32 of shape (H, W); 1 is solid.
    #[getter]
    fn opacity<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        view(
            Dim(<[usize; 2]>::from(slf.get().shape())),
            slf.get().0.opacity(),
            slf.clone().into_any(),
        )
    }

    /// The colour filter per px, 0 to 1, float32 of shape (H, W, 3); 1 transmits everything.
    #[getter]
    fn tint<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        rgb(slf, slf.get().0.tint())
    }

    /// The reflectance of solid cells, and the scattering albedo of others, 0 to 1, float32 of shape (H, W, 3).
    #[getter]
    fn albedo<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        rgb(slf, slf.get().0.albedo())
    }

    /// The colour that a picture shows, linear RGB, float32 of shape (H, W, 3), or None: white.
    #[getter]
    fn color<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyArray3<f32>>>> {
        slf.get().0.color().map(|color| rgb(slf, color)).transpose()
    }

    /// Unit vectors, x to the right, y down, z towards the viewer, float32 of shape (H, W, 3), or None.
    #[getter]
    fn normals<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyArray3<f32>>>> {
        slf.get().0.normals().map(|normals| rgb(slf, normals)).transpose()
    }

    /// The layers of every cell, a bit each, uint8 of shape (H, W), or None: all layers.
    #[getter]
    fn masks<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyArray2<u8>>>> {
        let this = slf.get();
        let masks = this.0.masks();
        masks
            .map(|masks| {
                view::<_, Ix2>(Dim(<[usize; 2]>::from(this.shape())), masks, slf.clone().into_any())
            })
            .transpose()
    }

    /// The lamps, a dict each, with the keys of a scene file.
    #[getter]
    fn lamps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        object(py, &self.0.lamps())
    }

    /// The suns, a dict each, with the keys of a scene file.
    #[getter]
    fn suns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        object(py, &self.0.suns())
    }

    /// The radiance from beyond the grid, as in a scene file.
    #[getter]
    fn sky<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        object(py, self.0.sky())
    }

    /// Returns the cells of a window, with the lamps that reach into it.
    ///
    /// Parameters
    /// ----------
    /// y, x : int
    ///     Row and column of its first cell.
    /// height, width : int
    ///
    /// Returns
    /// -------
    /// Cells
    ///     With lamps relative to the window, and with the same suns and sky.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the window does not lie in the grid.
    fn window(
        &self,
        py: Python<'_>,
        y: i128,
        x: i128,
        height: i128,
        width: i128,
    ) -> PyResult<Self> {
        let window = window((y, x, height, width))?;
        let cells = SHARED.run(py, || WorldSource::cells(&self.0, window))?;
        cells.map(Self).map_err(value_error)
    }

    /// The names of the fields that are arrays.
    #[classattr]
    #[pyo3(name = "FIELDS")]
    fn fields(py: Python<'_>) -> PyResult<Bound<'_, PyTuple>> {
        PyTuple::new(py, &FIELDS[..ARRAYS])
    }

    fn __repr__(&self) -> String {
        format!("<Cells of shape {:?}>", self.shape())
    }

    /// The arguments from which a pickle makes these cells again.
    fn __getnewargs_ex__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
        let py = slf.py();
        let fields = PyDict::new(py);
        for name in FIELDS {
            fields.set_item(name, slf.getattr(name)?)?;
        }
        Ok((PyTuple::new(py, [slf.get().shape()])?, fields))
    }
}

impl Cells {
    /// Cells from keywords. In errors `first` is added to the place of a cell, x and y.
    fn of_fields(
        py: Python<'_>,
        [height, width]: [u32; 2],
        fields: Option<&Bound<'_, PyDict>>,
        first: [u32; 2],
    ) -> PyResult<Self> {
        let scene = PyDict::new(py);
        scene.set_item("size", (width, height))?;
        let mut arrays = Vec::new();
        for (name, value) in fields.into_iter().flatten().filter(|(_, value)| !value.is_none()) {
            let name: String = name.extract()?;
            match name.as_str() {
                "lamps" => scene.set_item("lamp", value)?,
                "suns" => scene.set_item("sun", value)?,
                "sky" => scene.set_item("sky", value)?,
                _ => arrays.push((name, value)),
            }
        }
        let scene = lamplight::Scene::from_json(&write(&scene)?).map_err(without_line)?;
        let mut cells = scene.cells().map_err(value_error)?;
        for (name, value) in arrays {
            set(&mut cells, &name, &value)?;
        }
        SHARED.run(py, || cells.check())?.map_err(|error| value_error(moved(error, first)))?;
        Ok(Self(cells))
    }
}

/// Returns an error in which a cell has its place in a world, of which `first` is the window's first cell.
fn moved(error: Error, [left, top]: [u32; 2]) -> Error {
    match error {
        Error::Cell { x, y, field, value, expected } => Error::Cell {
            x: x.saturating_add(left),
            y: y.saturating_add(top),
            field,
            value,
            expected,
        },
        other => other,
    }
}

/// Makes the cells of a window of a world, for `lamplight2d.World`: errors name cells of the world.
#[pyfunction]
#[pyo3(signature = (within, **fields))]
pub fn cells_within(
    py: Python<'_>,
    within: PyWindow,
    fields: Option<&Bound<'_, PyDict>>,
) -> PyResult<Cells> {
    let GridWindow { first, size: [width, height] } = window(within)?;
    Cells::of_fields(py, [height, width], fields, first)
}

/// Every field, by the name of its keyword; the first ones are arrays.
const FIELDS: [&str; 11] = [
    "emission", "glow", "opacity", "tint", "albedo", "color", "normals", "masks", "lamps", "suns",
    "sky",
];

/// The number of fields that are arrays.
const ARRAYS: usize = 8;

/// Fills a field from an array.
fn set(cells: &mut lamplight::Cells, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    let (height, width) = (cells.height() as usize, cells.width() as usize);
    let rgb = match name {
        "opacity" => return read(name, value, &[height, width], cells.opacity_mut()),
        "masks" => return read_bytes(name, value, &[height, width], cells.masks_mut()),
        "emission" => cells.emission_mut(),
        "glow" => cells.glow_mut(),
        "tint" => cells.tint_mut(),
        "albedo" => cells.albedo_mut(),
        "color" => cells.color_mut(),
        "normals" => cells.normals_mut(),
        _ => {
            let expected = format!("one of {}", FIELDS.join(", "));
            return Err(PyTypeError::new_err(Error::value("field", name, expected).to_string()));
        }
    };
    read(name, value, &[height, width, 3], rgb.as_flattened_mut())
}

fn rgb<'py>(cells: &Bound<'py, Cells>, values: &[Rgb]) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let (height, width) = cells.get().shape();
    view::<_, Ix3>(Dim([height, width, 3]), values.as_flattened(), cells.clone().into_any())
}
