//! `Light`: the result, with queries and pictures.

use crate::arrays::{self, read, view};
use crate::cells::Cells;
use crate::json::{self, value_error};
use crate::threads::SHARED;
use lamplight::{Moment, Settings};
use numpy::ndarray::Dim;
use numpy::{PyArray2, PyArray3, PyArray4, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// The mean radiance at every cell, linear RGB. A solver returns it; light from elsewhere is wrapped by the constructor.
///
/// Its arrays are read-only views, without a copy.
///
/// Parameters
/// ----------
/// rgb : array_like of shape (H, W, 3)
/// solid : array_like of bool of shape (H, W), optional
/// moment : array_like of shape (H, W, 2, 3), optional
///     The x and the y component of the first moment.
/// elevation : float, optional
///     The elevation at which light with a ``moment`` arrives at tilted surfaces, radians, in the range of a solver's.
///
/// Raises
/// ------
/// ValueError
///     If a shape is wrong, or the elevation is out of its range. Light may have any values.
#[pyclass(module = "lamplight2d", frozen)]
pub struct Light(pub lamplight::Light);

impl Light {
    pub fn size(&self) -> [usize; 2] {
        [self.0.height() as usize, self.0.width() as usize]
    }
}

#[pymethods]
impl Light {
    #[new]
    #[pyo3(signature = (rgb, *, solid=None, moment=None, elevation=Settings::ELEVATION))]
    fn new(
        rgb: &Bound<'_, PyAny>,
        solid: Option<&Bound<'_, PyAny>>,
        moment: Option<&Bound<'_, PyAny>>,
        elevation: f32,
    ) -> PyResult<Self> {
        // The range of a solver's.
        Settings { elevation, ..Settings::default() }.check().map_err(value_error)?;
        let shape = arrays::shape("rgb", rgb)?;
        let [height, width, 3] = shape[..] else {
            return Err(value_error(format!(
                "rgb has the shape {shape:?}; expected [height, width, 3]"
            )));
        };
        let side = |v: usize| u32::try_from(v).unwrap_or(u32::MAX);
        let size = [side(width), side(height)];
        lamplight::Cells::check_size(size[0].into(), size[1].into()).map_err(value_error)?;
        let mut values = vec![[0.0; 3]; width * height];
        read("rgb", rgb, &shape, values.as_flattened_mut())?;
        let light = match solid {
            None => lamplight::Light::in_the_open(size, values),
            Some(solid) => {
                let mut cells = lamplight::Cells::new(size[0], size[1]).map_err(value_error)?;
                read("solid", solid, &[height, width], cells.opacity_mut())?;
                lamplight::Light::from_pixels(&cells, values)
            }
        };
        let mut light = light.map_err(value_error)?;
        if let Some(moment) = moment {
            let mut values = vec![Moment::default(); width * height];
            let flat = values.as_flattened_mut().as_flattened_mut();
            read("moment", moment, &[height, width, 2, 3], flat)?;
            light = light.with_moment(values, elevation).map_err(value_error)?;
        }
        Ok(Self(light))
    }

    /// Rows and columns, (H, W).
    #[getter]
    fn shape(&self) -> (usize, usize) {
        self.size().into()
    }

    /// The mean radiance that arrives at every cell, linear RGB, float32 of shape (H, W, 3). In solid cells it is the
    /// light that sinks in from their faces.
    #[getter]
    fn rgb<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let [height, width] = slf.get().size();
        view(Dim([height, width, 3]), slf.get().0.pixels().as_flattened(), slf.clone().into_any())
    }

    /// The first moment of the light, float32 of shape (H, W, 2, 3): its x and its y component. None unless the solver
    /// has ``moment=True`` or the cells have normals.
    #[getter]
    fn moment<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyArray4<f32>>>> {
        let [height, width] = slf.get().size();
        let moment = slf.get().0.moment().map(|moment| moment.as_flattened().as_flattened());
        moment
            .map(|flat| view(Dim([height, width, 2, 3]), flat, slf.clone().into_any()))
            .transpose()
    }

    /// The solid cells, bool of shape (H, W).
    #[getter]
    fn solid<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        view(Dim(slf.get().size()), slf.get().0.solid(), slf.clone().into_any())
    }

    /// The elevation above the plane at which light arrives at tilted surfaces, radians.
    #[getter]
    fn elevation(&self) -> f32 {
        self.0.elevation()
    }

    /// The light at points, interpolated between the nearest cell centres.
    ///
    /// Parameters
    /// ----------
    /// points : array_like of shape (N, 2)
    ///     x and y, px.
    ///
    /// Returns
    /// -------
    /// ndarray of shape (N, 3)
    fn sample<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let py = points.py();
        let shape = arrays::shape("points", points)?;
        let [count, 2] = shape[..] else {
            return Err(value_error(format!("points has the shape {shape:?}; expected [N, 2]")));
        };
        let mut positions = vec![[0.0; 2]; count];
        read("points", points, &shape, positions.as_flattened_mut())?;
        let light: Vec<f32> =
            positions.into_iter().flat_map(|position| self.0.sample(position)).collect();
        numpy::PyArray1::from_vec(py, light).reshape([count, 3])
    }

    /// The final picture: colour × light, exposed and tone mapped.
    ///
    /// Parameters
    /// ----------
    /// cells : Cells
    ///     Their colour and their emission are shown.
    /// **display
    ///     The keys of a scene file's ``[display]``: ``tonemap="aces"``, ``exposure=1``.
    ///
    /// Returns
    /// -------
    /// ndarray of uint8 of shape (H, W, 3)
    ///     sRGB.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the cells have another shape, or a key is unknown or its value out of range.
    #[pyo3(signature = (cells, **display), text_signature = "($self, cells, **display)")]
    fn compose<'py>(
        &self,
        py: Python<'py>,
        cells: &Cells,
        display: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let display = json::display(py, display)?;
        let picture =
            SHARED.run(py, || self.0.compose(&cells.0, &display))?.map_err(value_error)?;
        let [height, width] = self.size();
        numpy::PyArray1::from_vec(py, picture.into_raw()).reshape([height, width, 3])
    }

    fn __repr__(&self) -> String {
        format!("<Light of shape {:?}>", self.shape())
    }

    /// The arguments from which a pickle makes this light again.
    fn __getnewargs_ex__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
        let fields = PyDict::new(slf.py());
        for name in ["solid", "moment", "elevation"] {
            fields.set_item(name, slf.getattr(name)?)?;
        }
        Ok((PyTuple::new(slf.py(), [Self::rgb(slf)?])?, fields))
    }
}
