//! Newton steps that are bent where contacts change.
//!
//! A step with the tangent of an open contact goes deep into it, and the steps back converge slowly, as the
//! force of a contact grows faster than its depth.

use super::options::PredictorOptions;
use super::predictor::Predictor;
use super::system::System;
use crate::lie::LieGroup;
use crate::model::Model;

/// The workspace of a step.
#[derive(Clone, Debug)]
pub(super) struct BentStep<const D: usize, const P: usize> {
    predictor: Predictor<D, P>,
    start: Vec<f64>,
    bent: Vec<f64>,
}

impl<const D: usize, const P: usize> BentStep<D, P> {
    pub fn new<G: LieGroup<D, P>>(model: &Model<G, D, P>, options: PredictorOptions) -> Self {
        let zeros = || vec![0.0; model.dof];
        Self { predictor: Predictor::new(model, options), start: zeros(), bent: zeros() }
    }

    /// Takes a Newton step, where the residual is `before`; with its bent form if only that lowers the
    /// residual, which then replaces `step`. Returns the residual.
    pub fn advance<G: LieGroup<D, P>>(
        &mut self,
        system: &mut System<G, D, P>,
        step: &mut [f64],
        before: f64,
    ) -> f64 {
        if !system.model().has_switches() {
            system.advance(step);
            return system.evaluate();
        }
        self.start.copy_from_slice(system.state());
        system.advance(step);
        let straight = system.evaluate();
        if straight < before {
            return straight;
        }
        system.set_state(&self.start);
        system.evaluate();
        let changes = self.predictor.follow_step(system, step);
        if changes {
            self.predictor.displacement(1.0, &mut self.bent);
            system.advance(&self.bent);
            let bent = system.evaluate();
            if bent < straight || !straight.is_finite() {
                step.copy_from_slice(&self.bent);
                return bent;
            }
        }
        system.advance_from(&self.start, step, 1.0);
        system.evaluate()
    }
}
