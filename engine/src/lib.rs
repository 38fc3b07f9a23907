//! Statics of hybrid soft-rigid systems: Cosserat rods with the Geometric Variable Strain
//! parameterisation, rigid links, joints, pneumatic chambers, cables and sphere contact.
//!
//! A [`model::Model`] is built once from a [`model::Description`] and shared; a [`Data`] is the
//! workspace of one thread: it holds a design (a vector of parameters), a state, and the energy,
//! residual and tangent there.

mod assembly;
mod batch;
mod branch;
mod control;
mod data;
mod design;
pub mod equilibrium;
mod forces;
mod friction;
mod geometry;
mod kinematics;
pub mod lie;
pub mod linalg;
pub mod model;
mod results;
mod section;
pub mod sensitivity;
pub mod strain;
mod ties;
mod tolerances;
mod tree;
mod units;

pub use batch::{Batch, Pieces};
pub use branch::Branch;
pub use data::Data;
pub use forces::contact::ContactSummary;
pub use forces::element::ContactForce;
pub use forces::friction::FrictionForce;
pub use results::{PathEvent, PathFriction, PathResults};

// All tests are in one binary, so that the generic code is compiled once.
#[cfg(test)]
extern crate self as flexor_engine;
#[cfg(test)]
#[path = "../tests/engine/mod.rs"]
mod engine;
#[cfg(test)]
#[path = "../tests/systems/mod.rs"]
mod systems;
#[cfg(test)]
#[path = "../tests/systems/toolbox.rs"]
mod toolbox;
#[cfg(test)]
#[allow(dead_code)]
#[path = "../tests/systems/trees.rs"]
mod trees;
