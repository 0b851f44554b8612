//! NumPy arrays in, rows of numbers out, and back.
//!
//! A quantity of one craft has the shape of the quantity alone, that of N crafts an axis before it. Arrays are float64 or
//! float32, in any memory order and with any strides; lists and other array libraries go through `numpy.asarray`. Whole numbers in an
//! array of quantities are refused: a position of integers is a rounded one. Matrices of whole numbers are matrices.

use nalgebra::DMatrix;
use numpy::ndarray::{Array, ArrayViewD, IxDyn};
use numpy::{
    Element, IntoPyArray, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods, dtype,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Rows of W numbers: one for each craft, or one for all. Kept flat, so that a contiguous array is copied as it is.
#[derive(Clone)]
pub(crate) struct Quantity<const W: usize> {
    /// How long the leading axis of the argument was, where it had one.
    pub(crate) crafts: Option<usize>,
    numbers: Vec<f64>,
}

/// An array of numbers of either precision.
enum Read<'py> {
    Double(Bound<'py, PyArrayDyn<f64>>),
    Single(Bound<'py, PyArrayDyn<f32>>),
}

/// A value as an array of floating-point numbers.
fn read<'py>(name: &str, value: &Bound<'py, PyAny>) -> PyResult<Read<'py>> {
    let py = value.py();
    if let Ok(array) = value.cast::<PyUntypedArray>() {
        let kind = array.dtype();
        if kind.is_equiv_to(&dtype::<f64>(py)) {
            return Ok(Read::Double(array.cast::<PyArrayDyn<f64>>()?.clone()));
        }
        if kind.is_equiv_to(&dtype::<f32>(py)) {
            return Ok(Read::Single(array.cast::<PyArrayDyn<f32>>()?.clone()));
        }
        let message = format!("{name}: dtype {kind}; give float64 or float32 (x.astype(float))");
        return Err(PyTypeError::new_err(message));
    }
    let keywords = PyDict::new(py);
    keywords.set_item("dtype", "float64")?;
    let array = py
        .import("numpy")?
        .call_method("asarray", (value,), Some(&keywords))
        .map_err(|error| PyTypeError::new_err(format!("{name}: no array of numbers: {}", error.value(py))))?;
    Ok(Read::Double(array.cast_into::<PyArrayDyn<f64>>()?))
}

/// A readable shape, as NumPy writes it.
fn shape_text(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        more => format!("({})", more.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")),
    }
}

fn flat<T: Element + Copy + Into<f64>>(view: &ArrayViewD<'_, T>) -> Vec<f64> {
    match view.as_slice() {
        Some(contiguous) => contiguous.iter().map(|number| (*number).into()).collect(),
        None => view.iter().map(|number| (*number).into()).collect(),
    }
}

impl<const W: usize> Quantity<W> {
    /// From an argument of shape (W,) or (N, W); of () or (N,) for a quantity of one number.
    pub(crate) fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let array = read(name, value)?;
        let shape = match &array {
            Read::Double(array) => array.shape(),
            Read::Single(array) => array.shape(),
        };
        let crafts = match (W, shape) {
            (1, []) => None,
            (1, [crafts]) => Some(*crafts),
            (_, [width]) if *width == W => None,
            (_, [crafts, width]) if *width == W => Some(*crafts),
            _ => {
                let want = if W == 1 { "() or (N,)".to_owned() } else { format!("({W},) or (N, {W})") };
                return Err(PyValueError::new_err(format!("{name}: shape {}; give {want}", shape_text(shape))));
            }
        };
        let numbers = match &array {
            Read::Double(array) => flat(&array.try_readonly()?.as_array()),
            Read::Single(array) => flat(&array.try_readonly()?.as_array()),
        };
        Ok(Self { crafts, numbers })
    }

    /// The same of an argument that may be absent.
    pub(crate) fn read_or_none(name: &str, value: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Self>> {
        value.filter(|value| !value.is_none()).map(|value| Self::read(name, value)).transpose()
    }

    /// The same row for everybody.
    pub(crate) fn of(row: [f64; W]) -> Self {
        Self { crafts: None, numbers: row.to_vec() }
    }

    /// Rows of crafts, or of one.
    pub(crate) fn of_rows(crafts: Option<usize>, rows: impl Iterator<Item = [f64; W]>) -> Self {
        Self { crafts, numbers: rows.flatten().collect() }
    }

    /// A craft's row.
    #[inline]
    pub(crate) fn row(&self, craft: usize) -> [f64; W] {
        let from = if self.crafts.is_some() { craft * W } else { 0 };
        let row = &self.numbers[from..from + W];
        std::array::from_fn(|i| row[i])
    }

    /// The number of rows.
    pub(crate) fn len(&self) -> usize {
        self.crafts.unwrap_or(1)
    }

    /// All of them.
    pub(crate) fn rows(&self) -> impl Iterator<Item = [f64; W]> + '_ {
        (0..self.len()).map(|row| self.row(row))
    }

    /// As an array of the shape that it was given in, a row for all as one row.
    pub(crate) fn held<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.array(py, self.crafts)
    }

    /// As an array for so many crafts.
    pub(crate) fn array<'py>(&self, py: Python<'py>, crafts: Option<usize>) -> PyResult<Bound<'py, PyAny>> {
        let numbers = match (crafts, self.crafts) {
            (Some(crafts), None) => self.numbers.repeat(crafts),
            _ => self.numbers.clone(),
        };
        let mut shape: Vec<usize> = crafts.into_iter().collect();
        if W > 1 {
            shape.push(W);
        }
        shaped(py, &shape, numbers)
    }
}

impl Quantity<1> {
    /// Times from an argument of shape () or (N,); NaN is none.
    pub(crate) fn read_times(value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let times = Self::read("time", value)?;
        let row = times.rows().position(|[t_s]| t_s.is_nan());
        match (row, times.crafts) {
            (None, _) => Ok(times),
            (Some(_), None) => Err(PyValueError::new_err("time: nan; must be a number, s")),
            (Some(row), Some(_)) => Err(PyValueError::new_err(format!("time: nan in row {row}; must be a number, s"))),
        }
    }
}

/// Quantities that belong together: the leading axis is that of those that have one, and all of these have the same.
#[derive(Default)]
pub(crate) struct Together {
    crafts: Option<(usize, &'static str)>,
}

impl Together {
    /// Notes a quantity.
    pub(crate) fn note<const W: usize>(&mut self, name: &'static str, rows: Option<&Quantity<W>>) -> PyResult<()> {
        let Some(crafts) = rows.and_then(|rows| rows.crafts) else { return Ok(()) };
        match self.crafts {
            Some((other, of)) if other != crafts => {
                Err(PyValueError::new_err(format!("{name}: {crafts} rows, but {of} has {other}; give as many of both")))
            }
            _ => {
                self.crafts = Some((crafts, name));
                Ok(())
            }
        }
    }

    /// The common leading axis.
    pub(crate) fn crafts(&self) -> Option<usize> {
        self.crafts.map(|(crafts, _)| crafts)
    }
}

/// Rows as an array of shape (W,) or (N, W), of () or (N,) for a quantity of one number.
pub(crate) fn array<'py, T: Element + Copy, const W: usize>(
    py: Python<'py>,
    crafts: Option<usize>,
    rows: Vec<[T; W]>,
) -> PyResult<Bound<'py, PyAny>> {
    let mut shape: Vec<usize> = crafts.into_iter().collect();
    if W > 1 {
        shape.push(W);
    }
    shaped(py, &shape, rows.into_flattened())
}

/// Numbers, by rows, as an array of a shape.
pub(crate) fn shaped<'py, T: Element>(
    py: Python<'py>,
    shape: &[usize],
    numbers: Vec<T>,
) -> PyResult<Bound<'py, PyAny>> {
    let array = Array::from_shape_vec(IxDyn(shape), numbers)
        .map_err(|error| PyValueError::new_err(format!("array of {}: {error}", shape_text(shape))))?;
    Ok(array.into_pyarray(py).into_any())
}

/// A matrix argument; numbers and vectors of one are taken for a matrix of one row or column as `as_column` says.
pub(crate) fn matrix(name: &str, value: &Bound<'_, PyAny>) -> PyResult<DMatrix<f64>> {
    fn dense<T: Element + Copy + Into<f64>>(name: &str, view: &ArrayViewD<'_, T>) -> PyResult<DMatrix<f64>> {
        let (rows, columns) = match view.shape() {
            [] => (1, 1),
            [rows, columns] => (*rows, *columns),
            other => {
                return Err(PyValueError::new_err(format!(
                    "{name}: shape {}; give a matrix (rows, columns)",
                    shape_text(other)
                )));
            }
        };
        Ok(DMatrix::from_row_iterator(rows, columns, view.iter().map(|entry| (*entry).into())))
    }
    let is_whole = |array: &Bound<'_, PyUntypedArray>| matches!(array.dtype().kind(), b'i' | b'u');
    let value = match value.cast::<PyUntypedArray>() {
        Ok(array) if is_whole(array) => &array.call_method1("astype", ("float64",))?,
        _ => value,
    };
    match read(name, value)? {
        Read::Double(array) => dense(name, &array.try_readonly()?.as_array()),
        Read::Single(array) => dense(name, &array.try_readonly()?.as_array()),
    }
}

/// A matrix as an array.
pub(crate) fn from_matrix<'py>(py: Python<'py>, matrix: &DMatrix<f64>) -> PyResult<Bound<'py, PyAny>> {
    // By rows.
    shaped(py, &[matrix.nrows(), matrix.ncols()], matrix.transpose().as_slice().to_vec())
}
