//! Exact derivatives of an equilibrium with respect to the model's parameters.
//!
//! At a stable equilibrium g(q; p) = ∇Π = 0, so an output y(q; p) changes with a parameter by
//! dy/dp = ∂y/∂p − λᵀ ∂g/∂p with H λ = ∂y/∂q: one solve with the factor at hand for each output,
//! whatever the number of parameters. λ is a virtual motion of the system, and λᵀ∂g/∂p is the change
//! of the virtual work that the forces do on it.

mod adjoint;
mod design_velocity;
mod held;
mod regularity;
mod tip_force;

pub use adjoint::Adjoint;
pub use regularity::Regularity;
