//! Static equilibrium (9) with contact, followed along the load.
//!
//! A stable equilibrium is a local minimum of Π. [`Solver`] finds one by trust-region Newton with the
//! exact tangent and follows it as the load grows; where its branch ends it descends to the next one
//! and records an event. Coordinates are made dimensionless by their elastic stiffness: one unit of
//! any of them stores the elastic energy of one radian of the softest angular coordinate.

mod branch;
mod descent;
mod factor;
mod general;
mod path;
mod prediction;
mod relaxation;
mod solver;
mod status;
mod subproblem;

pub use path::{Event, EventKind, PathSink, StepReport};
pub use solver::{Options, Solver};
pub use status::Status;
