//! The solver options: their description for Python, and conversion from Python.

use crate::error::value_error;
use flexor_engine::equilibrium::ContinuationOptions;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Default, range and meaning of each option, by name.
pub fn describe(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let described = PyDict::new(py);
    let defaults = ContinuationOptions::default().values();
    for (info, default) in ContinuationOptions::INFO.iter().zip(defaults) {
        let option = PyDict::new(py);
        option.set_item("default", default)?;
        option.set_item("minimum", info.interval.low)?;
        option.set_item("exclusive", info.interval.open)?;
        option.set_item("maximum", info.interval.high)?;
        option.set_item("integer", info.integer)?;
        option.set_item("doc", info.doc.trim())?;
        described.set_item(info.name, option)?;
    }
    Ok(described)
}

/// Reads options that were given by name.
pub fn read(given: Option<&Bound<'_, PyDict>>) -> PyResult<ContinuationOptions> {
    let mut options = ContinuationOptions::default();
    for (name, value) in given.into_iter().flatten() {
        let name: String = name.extract()?;
        if let Err(error) = options.set(&name, value.extract()?) {
            return value_error(error);
        }
    }
    Ok(options)
}
