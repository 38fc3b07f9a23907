//! Tests of the engine as its users see it, in one binary: the engine's generic code is compiled once.

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

#[path = "../systems/mod.rs"]
mod systems;
#[path = "../systems/toolbox.rs"]
mod toolbox;
#[path = "../systems/trees.rs"]
mod trees;
