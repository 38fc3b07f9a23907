//! Damped Newton on the residual, for loads that have no potential to descend.

use super::general::is_stable;
use super::solver::{Solver, largest, norm};
use super::status::Status;
use crate::lie::LieGroup;
use crate::model::Model;

/// Halvings of one step.
const HALVINGS: usize = 30;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Solver<G, D, P> {
    /// Solves the residual from `self.q`; its norm never rises along accepted steps.
    pub(super) fn relax(&mut self, model: &Model<G, D, P>) -> Status {
        let first = self.iterations;
        let mut size = self.evaluate(model);
        loop {
            if !size.is_finite() {
                return Status::Diverged;
            }
            self.evaluate_tangent(model);
            self.factorise(0.0);
            if size <= self.options.tolerance {
                let stable = is_stable(self.data.tangent(), &self.data.design.scale);
                return if stable { Status::Converged } else { Status::Unstable };
            }
            if self.iterations - first > self.options.max_iterations {
                return Status::IterationLimit;
            }
            self.newton_step();
            if !norm(&self.step).is_finite() {
                return Status::Diverged;
            }
            // One radian at a time: further out the linear model means nothing.
            let mut fraction = (1.0 / largest(&self.step)).min(1.0);
            let before = norm(&self.residual);
            self.trial.copy_from_slice(&self.q);
            let mut lowered = false;
            for _ in 0..HALVINGS {
                let (trial, step) = (self.trial.iter(), self.step.iter().zip(&self.unit));
                for ((q, t), (s, u)) in self.q.iter_mut().zip(trial).zip(step) {
                    *q = t + fraction * s * u;
                }
                size = self.evaluate(model);
                if size.is_finite() && norm(&self.residual) < before {
                    lowered = true;
                    break;
                }
                fraction *= 0.5;
            }
            if !lowered {
                return Status::Stalled;
            }
        }
    }
}
