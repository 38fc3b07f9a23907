//! Points with friction: arrays for Python, and the slips with which a path starts.

use crate::error::value_error;
use flexor_engine::PathFriction;
use numpy::{AllowTypeChange, IntoPyArray, PyArrayLike2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Columns of the table of slips: friction, sphere, other, and the slip.
const COLUMNS: usize = 6;

/// A row for each point with friction, by name of the column.
pub fn rows<'py>(py: Python<'py>, points: &[PathFriction]) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    let indices =
        |pick: fn(&PathFriction) -> usize| points.iter().map(pick).collect::<Vec<_>>().into_pyarray(py);
    out.set_item("design", indices(|p| p.design))?;
    out.set_item("step", indices(|p| p.step))?;
    out.set_item("friction", indices(|p| p.friction))?;
    out.set_item("sphere", indices(|p| p.sphere))?;
    out.set_item("other", indices(|p| p.other))?;
    let vectors = |pick: fn(&PathFriction) -> [f64; 3]| {
        let flat: Vec<f64> = points.iter().flat_map(pick).collect();
        flat.into_pyarray(py).reshape([points.len(), 3])
    };
    out.set_item("place", vectors(|p| p.place)?)?;
    out.set_item("force", vectors(|p| p.force)?)?;
    out.set_item("slip", vectors(|p| p.slip)?)?;
    out.set_item("limit", points.iter().map(|p| p.limit).collect::<Vec<_>>().into_pyarray(py))?;
    out.set_item("slides", points.iter().map(|p| p.slides).collect::<Vec<_>>().into_pyarray(py))?;
    Ok(out)
}

/// Reads the slips with which a path starts.
pub fn slips(given: Option<PyArrayLike2<'_, f64, AllowTypeChange>>) -> PyResult<Vec<PathFriction>> {
    let Some(given) = given else { return Ok(vec![]) };
    let table = given.as_array();
    if table.ncols() != COLUMNS {
        return value_error(format!("slips: found {} columns, expected {COLUMNS}", table.ncols()));
    }
    let row = |row: numpy::ndarray::ArrayView1<'_, f64>| PathFriction {
        design: 0,
        step: 0,
        friction: row[0] as usize,
        sphere: row[1] as usize,
        other: row[2] as usize,
        place: [0.0; 3],
        force: [0.0; 3],
        limit: 0.0,
        slip: [row[3], row[4], row[5]],
        slides: false,
    };
    Ok(table.rows().into_iter().map(row).collect())
}
