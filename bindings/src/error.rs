//! Errors that Python sees.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A `ValueError` of one sentence.
pub(crate) fn value_error<T>(sentence: impl std::fmt::Display) -> PyResult<T> {
    Err(PyValueError::new_err(sentence.to_string()))
}
