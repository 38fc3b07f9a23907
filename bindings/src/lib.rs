//! The compiled module `flexor._engine`: arrays in, arrays out, the GIL released while solving.

mod dispatch;
mod model;
mod options;
mod structure;

use flexor_engine::equilibrium::{EventKind, Status};
use flexor_engine::sensitivity::Regularity;
use numpy::{PyArray1, ToPyArray};
use pyo3::prelude::*;

/// X in [0, 1] of a rod's sample points: element ends and Gauss points, increasing.
#[pyfunction]
fn sample_points(py: Python<'_>, elements: usize, gauss_points: usize) -> Bound<'_, PyArray1<f64>> {
    flexor_engine::strain::sample_points(elements, gauss_points).to_pyarray(py)
}

#[pymodule]
fn _engine(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(sample_points, module)?)?;
    module.add_class::<model::Model>()?;
    module.add("SOLVER_OPTIONS", options::describe(module.py())?)?;
    module.add("STATUS", Status::ALL.map(Status::name).to_vec())?;
    module.add("EVENTS", EventKind::ALL.map(EventKind::name).to_vec())?;
    module.add("REGULARITY", Regularity::ALL.map(Regularity::name).to_vec())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    Ok(())
}
