//! The compiled module `flexor._engine`: arrays in, arrays out, the GIL released while solving.
//!
//! One library, three names: a build for every processor, one for AVX2 and FMA, one for the machine
//! it was built on. `flexor._dispatch` imports the one that fits.

mod dispatch;
mod model;

use flexor_engine::equilibrium::{EventKind, Status};
use flexor_engine::sensitivity::Regularity;
use numpy::{PyArray1, ToPyArray};
use pyo3::prelude::*;

/// X in [0, 1] of a rod's sample points: element ends and Gauss points, increasing.
#[pyfunction]
fn sample_points(py: Python<'_>, elements: usize, gauss_points: usize) -> Bound<'_, PyArray1<f64>> {
    flexor_engine::strain::sample_points(elements, gauss_points).to_pyarray(py)
}

/// Whether this processor has what x86-64-v3 asks for, for which `_engine_avx2` is compiled.
#[pyfunction]
fn cpu_has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    return is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("fma")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("f16c")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("movbe");
    #[cfg(not(target_arch = "x86_64"))]
    false
}

/// Defines the module under the name that a build of it is installed by.
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
engine!(_engine_native);

fn fill(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(sample_points, module)?)?;
    module.add_function(wrap_pyfunction!(cpu_has_avx2, module)?)?;
    module.add_class::<model::Model>()?;
    module.add("STATUS", Status::ALL.map(Status::name).to_vec())?;
    module.add("EVENTS", EventKind::ALL.map(EventKind::name).to_vec())?;
    module.add("REGULARITY", Regularity::ALL.map(Regularity::name).to_vec())?;
    // Decides the last bits: without it, products are rounded before they are added.
    module.add("FUSED_MULTIPLY_ADD", cfg!(target_feature = "fma"))?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    Ok(())
}
