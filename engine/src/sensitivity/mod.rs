//! Exact derivatives of an equilibrium with respect to the model's parameters.
//!
//! At a stable equilibrium g(q; p) = ∇Π = 0, so an output y(q; p) changes with a parameter by
//! dy/dp = ∂y/∂p − λᵀ ∂g/∂p with H λ = ∂y/∂q: one solve with the current factor for each output,
//! regardless of the number of parameters. λ is a virtual motion of the system, and λᵀ∂g/∂p is the change
//! of the virtual work that the forces do on it.

mod adjoint;
mod design_velocity;
mod held;
mod history;
mod known;
mod output;
mod regularity;
mod ties;

pub use adjoint::Adjoint;
use adjoint::Carried;
pub use history::{HistoryDerivatives, HistoryPart};
pub use known::{Derivatives, KnownEquilibria};
pub use output::output_groups;
pub use regularity::Regularity;
