//! Damped Newton on the residual, for loads that have no potential to minimise.

use super::general::is_stable;
use super::options::DampedNewtonOptions;
use super::status::Status;
use super::system::System;
use super::vector::{max_norm, norm};
use crate::lie::LieGroup;

/// Newton's method with halved steps.
#[derive(Clone, Debug)]
pub(super) struct DampedNewton {
    options: DampedNewtonOptions,
    step: Vec<f64>,
    start: Vec<f64>,
}

impl DampedNewton {
    pub fn new(options: DampedNewtonOptions, dof: usize) -> Self {
        Self { options, step: vec![0.0; dof], start: vec![0.0; dof] }
    }

    /// Solves the residual from the system's state; its norm never rises along accepted steps.
    pub fn solve<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        tolerance: f64,
        max_iterations: usize,
    ) -> Status {
        let first = system.iterations();
        let mut size = system.evaluate();
        loop {
            if !size.is_finite() {
                return Status::Diverged;
            }
            system.evaluate_tangent();
            system.factorise(0.0);
            if size <= tolerance {
                let data = system.data();
                let stable = is_stable(data.tangent(), &data.design.scale);
                return if stable { Status::Converged } else { Status::Unstable };
            }
            if system.iterations() - first > max_iterations {
                return Status::IterationLimit;
            }
            system.newton_step(&mut self.step);
            if !norm(&self.step).is_finite() {
                return Status::Diverged;
            }
            match self.search(system) {
                Some(lowered) => size = lowered,
                None => return Status::Stalled,
            }
        }
    }

    /// Halves the step until it lowers the norm of the residual; returns the largest residual then.
    fn search<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
    ) -> Option<f64> {
        // Further out the linear model means nothing.
        let mut fraction = (self.options.max_step / max_norm(&self.step)).min(1.0);
        let before = norm(system.residual());
        self.start.copy_from_slice(system.state());
        for _ in 0..self.options.max_halvings {
            system.advance_from(&self.start, &self.step, fraction);
            let size = system.evaluate();
            if size.is_finite() && norm(system.residual()) < before {
                return Some(size);
            }
            fraction *= 0.5;
        }
        None
    }
}
