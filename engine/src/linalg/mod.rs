//! Linear algebra of the hot loops: fixed-size blocks for twists, dense factorisations without allocation.

mod chain;
mod cholesky;
mod fixed;

pub use chain::{ChainCholesky, ChainMatrix};
pub use cholesky::Cholesky;
pub(crate) use fixed::fma;
pub use fixed::{LANES, Matrix, Vector};
