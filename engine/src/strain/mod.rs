//! The strain field of a rod: its modes, bases (6), quadrature and Magnus steps (4).

mod basis;
mod mode;
mod quadrature;

pub use basis::{Basis, BasisKind};
pub use mode::Mode;
pub use quadrature::{Intervals, gauss_legendre};
