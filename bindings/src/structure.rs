//! The structure of a model as Python data.

use flexor_engine::model::JointStructure;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ops::Range;

/// A joint coordinate.
pub fn joint<'py>(py: Python<'py>, joint: &JointStructure) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    out.set_item("name", &joint.name)?;
    out.set_item("body", &joint.body)?;
    out.set_item("kind", joint.kind.name())?;
    out.set_item("coordinate", joint.coordinate)?;
    out.set_item("axis", joint.axis)?;
    out.set_item("unit", if joint.angular { "rad" } else { "m" })?;
    Ok(out)
}

/// Ranges (start, stop) by name, in order.
pub fn ranges<'py>(py: Python<'py>, named: &[(String, Range<usize>)]) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    for (name, range) in named {
        out.set_item(name, (range.start, range.end))?;
    }
    Ok(out)
}
