//! Tests of the engine as its users see it.

mod change_points;
mod derivatives;
mod fibres;
mod follower;
mod foundation;
mod friction;
mod invariants;
mod limits;
mod loads;
mod obstacles;
mod round_cones;
mod sensitivity;
mod tendons;
mod toolbox_reference;
mod toolbox_statics;
