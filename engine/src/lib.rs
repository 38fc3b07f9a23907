//! Statics of hybrid soft-rigid systems.
pub mod lie;
pub mod linalg;
pub mod strain;
