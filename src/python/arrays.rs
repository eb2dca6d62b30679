//! Arrays of real numbers from Python, of any library, with a given shape.

use super::error::parameter_error;
use super::value::{sequence_length, value_from, wrong_type};
use numpy::{
    Element, IntoPyArray, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods,
    PyReadonlyArray1, PyReadonlyArray2, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyInt;

/// Largest number of axes of a NumPy array.
const MOST_AXES: usize = 64;

/// The shape of an array of any library; `None` for other objects.
fn array_shape(object: &Bound<'_, PyAny>) -> Option<Vec<usize>> {
    object.getattr("shape").ok()?.extract().ok()
}

/// The shape of an array-like, judged by its first items, up to a number of axes.
///
/// # Errors
/// A `TypeError` if the first number is not real.
fn suggested_shape(object: &Bound<'_, PyAny>, name: &str, axes: usize) -> PyResult<Vec<usize>> {
    if let Some(shape) = array_shape(object) {
        let Ok(dtype) = object.getattr("dtype") else {
            return Ok(shape);
        };
        let kind = dtype
            .getattr("kind")
            .and_then(|kind| kind.extract::<char>());
        return match kind {
            // Other libraries' dtypes have no kind.
            Ok('f' | 'i' | 'u') | Err(_) => Ok(shape),
            Ok(_) => Err(wrong_dtype(name, dtype)),
        };
    }
    match sequence_length(object) {
        // A number has no axes.
        None => real_from(object, name).map(|_| Vec::new()),
        Some(length) if length == 0 || axes == 0 => Ok(vec![length]),
        Some(length) => {
            let inner = suggested_shape(&object.get_item(0)?, name, axes - 1)?;
            Ok([vec![length], inner].concat())
        }
    }
}

/// The error for an array of anything but real numbers.
fn wrong_dtype(name: &str, dtype: impl std::fmt::Display) -> PyErr {
    let message = format!("{name} must be an array of real numbers, not of dtype {dtype}");
    PyTypeError::new_err(message)
}

/// A real number from an object.
fn real_from(object: &Bound<'_, PyAny>, name: &str) -> PyResult<f64> {
    let number = value_from(object).number();
    number.ok_or_else(|| wrong_type(object, name, "a number"))
}

/// The numbers of an array-like of a given shape, row by row, and whether all are of integer type.
///
/// Sequences are read item by item. NumPy would copy them before their shape is known, and a short tuple of views or a
/// `range` may stand for more numbers than memory can hold.
struct Numbers {
    values: Vec<f64>,
    are_integers: bool,
}

impl Numbers {
    fn from_object(object: &Bound<'_, PyAny>, name: &str, expected: &[usize]) -> PyResult<Self> {
        let mut numbers = Self {
            values: Vec::with_capacity(expected.iter().product()),
            are_integers: true,
        };
        if numbers.read(object, name, expected)? {
            return Ok(numbers);
        }
        let shape = suggested_shape(object, name, MOST_AXES)?;
        Err(wrong_shape(name, &shape, &shape_text(expected)))
    }

    /// Reads an item that should have this shape; returns whether it has.
    fn read(&mut self, item: &Bound<'_, PyAny>, name: &str, shape: &[usize]) -> PyResult<bool> {
        if let Some(item_shape) = array_shape(item) {
            let has_shape = item_shape == shape;
            if has_shape {
                self.read_array(item, name)?;
            }
            return Ok(has_shape);
        }
        match (sequence_length(item), shape) {
            (None, []) => {
                self.are_integers &= item.is_instance_of::<PyInt>();
                self.values.push(real_from(item, name)?);
                Ok(true)
            }
            (None, _) if value_from(item).number().is_some() => Ok(false),
            (None, _) => Err(wrong_type(item, name, "an array of real numbers")),
            (Some(length), [expected_length, inner_shape @ ..]) if length == *expected_length => {
                for index in 0..length {
                    if !self.read(&item.get_item(index)?, name, inner_shape)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            }
            (Some(_), _) => Ok(false),
        }
    }

    /// Reads all numbers of an array.
    fn read_array(&mut self, array: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
        let py = array.py();
        let mask = array.getattr("mask");
        // On other types `mask` may be a method, which has no `any`.
        if let Ok(any) = mask.and_then(|mask| mask.call_method0("any"))
            && any.is_truthy()?
        {
            let message = format!("{name} is masked; fill its gaps first");
            return Err(parameter_error(message));
        }
        if array.hasattr("columns")? {
            return Err(wrong_type(array, name, "an array, as a table's to_numpy()"));
        }
        let asarray = numpy::get_array_module(py)?.getattr("asarray")?;
        let array = asarray.call1((array,))?.cast_into::<PyUntypedArray>()?;
        let dtype = array.dtype();
        if !matches!(dtype.kind(), b'f' | b'i' | b'u') {
            return Err(wrong_dtype(name, dtype));
        }
        self.are_integers &= dtype.kind() != b'f';
        let array = array.call_method1("astype", (numpy::dtype::<f64>(py),))?;
        let array = array.cast::<PyArrayDyn<f64>>()?.readonly();
        self.values.extend(array.as_array());
        Ok(())
    }
}

/// The numbers of an array-like of a given shape, row by row.
pub(super) fn floats(
    object: &Bound<'_, PyAny>,
    name: &str,
    expected: &[usize],
) -> PyResult<Vec<f64>> {
    Ok(Numbers::from_object(object, name, expected)?.values)
}

/// Three numbers for each boat, such as its pose.
pub(super) fn rows_from(
    object: &Bound<'_, PyAny>,
    name: &str,
    boats: usize,
) -> PyResult<Vec<[f64; 3]>> {
    let numbers = floats(object, name, &[boats, 3])?;
    let (rows, _) = numbers.as_chunks::<3>();
    Ok(rows.to_vec())
}

/// Actions of a given shape, one number per leader: rudders, or indices of levels if there are `levels`. A rudder of 1.0
/// is not level 1, so indices must be integers. Messages call the actions by `name`.
#[pyfunction]
#[pyo3(signature = (actions, shape, levels, name="actions"))]
pub(super) fn flat_actions<'py>(
    actions: &Bound<'py, PyAny>,
    shape: Vec<usize>,
    levels: Option<usize>,
    name: &str,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let Numbers {
        values,
        are_integers,
    } = Numbers::from_object(actions, name, &shape)?;
    if let Some(levels) = levels.filter(|_| !are_integers) {
        let last = levels.saturating_sub(1);
        let accepted = format!("whole numbers from 0 to {last}, the levels of the rudder");
        return Err(parameter_error(format!("{name} must be {accepted}")));
    }
    Ok(PyArray1::from_vec(actions.py(), values))
}

/// Rows times a matrix plus a bias. Each row is summed by itself and in a fixed order, so that the sums do not depend on
/// the other rows. A matrix product may round the same row differently at another index.
#[pyfunction]
pub(super) fn linear<'py>(
    rows: PyReadonlyArray2<'py, f32>,
    weight: PyReadonlyArray2<'py, f32>,
    bias: PyReadonlyArray1<'py, f32>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let shape = [rows.shape()[1], bias.len()];
    if weight.shape() != shape {
        return Err(wrong_shape("weight", weight.shape(), &shape_text(&shape)));
    }
    let weight: Vec<f64> = weight
        .as_array()
        .iter()
        .map(|&entry| entry.into())
        .collect();
    let mut sums = numpy::ndarray::Array2::<f64>::zeros((rows.shape()[0], bias.len()));
    sums += &bias.as_array().mapv(f64::from);
    for (row, mut row_sums) in rows.as_array().outer_iter().zip(sums.outer_iter_mut()) {
        for (&input, weights) in row.iter().zip(weight.chunks_exact(bias.len().max(1))) {
            for (sum, weight) in row_sums.iter_mut().zip(weights) {
                *sum += f64::from(input) * weight;
            }
        }
    }
    Ok(sums.mapv(|sum| sum as f32).into_pyarray(rows.py()))
}

/// The error for an array of another shape.
pub(super) fn wrong_shape(name: &str, shape: &[usize], expected: &str) -> PyErr {
    let shape = shape_text(shape);
    parameter_error(format!("{name} has shape {shape}, expected {expected}"))
}

/// A shape as NumPy writes it.
fn shape_text(shape: &[usize]) -> String {
    match shape {
        [length] => format!("({length},)"),
        _ => format!("{shape:?}").replace('[', "(").replace(']', ")"),
    }
}

/// Refuses an array that does not have the expected length.
pub(super) fn check_length(name: &str, length: usize, expected: usize) -> PyResult<()> {
    if length == expected {
        return Ok(());
    }
    Err(wrong_shape(name, &[length], &shape_text(&[expected])))
}

/// An array of rows from numbers in row order.
pub(super) fn rows_of<T: Element>(
    py: Python<'_>,
    numbers: Vec<T>,
    columns: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let rows = numbers.len() / columns.max(1);
    PyArray1::from_vec(py, numbers).reshape([rows, columns])
}
