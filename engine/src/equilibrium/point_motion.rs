//! Velocities of all points for a velocity of the coordinates.

use super::system::System;
use crate::forces::element::Velocities;
use crate::lie::LieGroup;
use crate::linalg::{LANES, Vector};
use crate::model::Model;

/// The velocities, with a workspace.
#[derive(Clone, Debug)]
pub(super) struct PointMotion<const D: usize, const P: usize> {
    pub points: Vec<Vector<P>>,
    twists: Vec<Vector<D>>,
    /// Rates of the coordinates, and the same in blocks.
    rates: Vec<f64>,
    blocks: Vec<Vector<LANES>>,
}

impl<const D: usize, const P: usize> PointMotion<D, P> {
    /// Of frames and points.
    pub fn velocities(&self) -> Velocities<'_, D, P> {
        Velocities { twists: &self.twists, points: &self.points }
    }

    pub fn new<G: LieGroup<D, P>>(model: &Model<G, D, P>) -> Self {
        Self {
            points: vec![Vector::ZERO; model.points.len()],
            twists: vec![Vector::ZERO; model.frames.len()],
            rates: vec![0.0; model.dof],
            blocks: model.coordinate_blocks.zeros(),
        }
    }

    /// For a dimensionless velocity at the state evaluated last, whose columns are complete.
    pub fn update<G: LieGroup<D, P>>(&mut self, system: &System<G, D, P>, velocity: &[f64]) {
        for (r, (v, u)) in self.rates.iter_mut().zip(velocity.iter().zip(system.units())) {
            *r = v * u;
        }
        let model = system.model();
        model.coordinate_blocks.gather(&self.rates, &mut self.blocks);
        system.data().velocities(model, &self.blocks, &mut self.twists, &mut self.points);
    }
}
