//! The compiled module `flexor._engine`: arrays in, arrays out, the GIL released while solving.
//!
//! Each build has its own module name: baseline, AVX2 with FMA, AVX-512, and native (the machine that
//! it was built on). `flexor._dispatch` imports the fastest that the processor supports.

mod dispatch;
mod error;
mod friction;
mod interrupt;
mod model;
mod options;
mod structure;

use flexor_engine::equilibrium::{EventKind, Stability, Status};
use flexor_engine::model::Law;
use flexor_engine::sensitivity::Regularity;
use flexor_engine::strain::Intervals;
use numpy::{AllowTypeChange, IntoPyArray, PyArray1, PyArray2, PyArrayLike1, PyArrayMethods, ToPyArray};
use pyo3::prelude::*;

/// X in [0, 1] of a rod's sample points: ends and Gauss points of elements, the last of which may be divided.
#[pyfunction]
#[pyo3(signature = (elements, gauss_points, tip_intervals=1))]
fn sample_points(
    py: Python<'_>,
    elements: usize,
    gauss_points: usize,
    tip_intervals: usize,
) -> Bound<'_, PyArray1<f64>> {
    Intervals { elements, tip: tip_intervals }.sample_points(gauss_points).to_pyarray(py)
}

/// Energy of a fibre of a material and its derivatives with respect to the stretch.
#[pyfunction]
fn fibre_energy<'py>(
    py: Python<'py>,
    law: &str,
    constants: Vec<f64>,
    wound: bool,
    stretch: PyArrayLike1<'py, f64, AllowTypeChange>,
) -> PyResult<[Bound<'py, PyArray1<f64>>; 3]> {
    let law: Law = match serde_json::from_value(law.into()) {
        Ok(law) => law,
        Err(error) => return error::value_error(error),
    };
    let found = law.fibre_energy(&constants, wound, &stretch.as_array().to_vec());
    let Some(found) = found else { return error::value_error("constants: found the wrong number") };
    Ok(found.map(|values| values.into_pyarray(py)))
}

/// Derivatives of the nominal stress of such a fibre with respect to the constants of its material.
#[pyfunction]
fn fibre_stress_slopes<'py>(
    py: Python<'py>,
    law: &str,
    constants: Vec<f64>,
    wound: bool,
    stretch: PyArrayLike1<'py, f64, AllowTypeChange>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let law: Law = match serde_json::from_value(law.into()) {
        Ok(law) => law,
        Err(error) => return error::value_error(error),
    };
    let stretch = stretch.as_array().to_vec();
    let Some(found) = law.stress_slopes(&constants, wound, &stretch) else {
        return error::value_error("constants: found the wrong number");
    };
    found.into_pyarray(py).reshape([stretch.len(), constants.len()])
}

/// The builds for x86-64-v4 and -v3 that this processor can run.
#[pyfunction]
fn cpu_runs() -> Vec<&'static str> {
    #[cfg(target_arch = "x86_64")]
    {
        let v3 = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("f16c")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("movbe");
        let v4 = v3
            && is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512cd")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        [(v4, "avx512"), (v3, "avx2")].into_iter().filter(|(runs, _)| *runs).map(|(_, name)| name).collect()
    }
    #[cfg(not(target_arch = "x86_64"))]
    Vec::new()
}

/// Defines the module under the name of a build.
macro_rules! engine {
    ($name:ident) => {
        #[pymodule]
        fn $name(module: &Bound<'_, PyModule>) -> PyResult<()> {
            fill(module)
        }
    };
}
engine!(_engine_baseline);
engine!(_engine_avx2);
engine!(_engine_avx512);
engine!(_engine_native);

fn fill(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(sample_points, module)?)?;
    module.add_function(wrap_pyfunction!(fibre_energy, module)?)?;
    module.add_function(wrap_pyfunction!(fibre_stress_slopes, module)?)?;
    module.add_function(wrap_pyfunction!(cpu_runs, module)?)?;
    module.add_function(wrap_pyfunction!(interrupt::cancel, module)?)?;
    module.add_class::<model::Model>()?;
    module.add("SOLVER_OPTIONS", options::describe(module.py())?)?;
    module.add("STATUS", Status::ALL.map(Status::name).to_vec())?;
    module.add("STABILITY", Stability::ALL.map(Stability::name).to_vec())?;
    module.add("EVENTS", EventKind::ALL.map(EventKind::name).to_vec())?;
    module.add("REGULARITY", Regularity::ALL.map(Regularity::name).to_vec())?;
    // Decides the last bits: without it, products are rounded before they are added.
    module.add("FUSED_MULTIPLY_ADD", cfg!(target_feature = "fma"))?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    Ok(())
}
