//! Static equilibrium (9) with contact, followed along the load.
//!
//! [`System`] holds one state and the equations of equilibrium there. [`Continuation`] follows a stable
//! equilibrium, a local minimum of Π, as the load changes:
//!
//! - the predictor extrapolates the branch through the changes of contact ahead;
//! - the corrector solves the residual from there, and the result is tested to lie on the same branch;
//! - where the branch ends, the trust region finds the next minimum of the energy (for loads without a
//!   potential: damped Newton on the residual) and the jump is reported as an event.
//!
//! Branches that turn back in the load, stable or not, are followed by arc length: [`Bordered`] solves
//! for equilibria under constraint equations, of which the length of a step is one.
//!
//! [`ContinuationOptions`] has the tolerances and limits of a solve.

mod arc_length;
mod bent_step;
mod bordered;
mod bordered_matrix;
#[cfg(test)]
mod bordered_tests;
mod branch_end;
mod budget;
mod closing;
mod contact_changes;
mod continuation;
mod controlled;
mod corrector;
mod critical;
mod damped_newton;
mod factor;
mod friction;
mod general;
mod jump;
mod load_steps;
mod mixed_newton;
mod neutral;
mod newton;
mod option_info;
mod options;
mod passage;
mod path;
mod planes;
mod point_motion;
mod predictor;
mod projection;
mod rotation_vectors;
mod same_branch;
mod semidefinite;
mod settling;
mod singular;
mod smallest_gap;
mod stability;
mod status;
mod step_control;
mod subproblem;
mod sweep;
mod system;
#[cfg(test)]
mod tests;
mod tied;
mod trust_region;
mod vector;

pub use bordered::{Border, Bordered, BorderedTarget, Constraint, Hyperplane, Multiplier, Prescribed};
pub use budget::Cancel;
pub use continuation::Continuation;
pub(crate) use friction::FrictionSubstep;
pub use option_info::{Interval, OptionError, OptionInfo};
pub use options::*;
pub use path::{Event, EventKind, PathSink, StepReport};
pub use stability::Stability;
pub use status::Status;
pub use system::{Accuracy, System};
