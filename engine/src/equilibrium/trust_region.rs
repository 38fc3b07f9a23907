//! Trust-region Newton: from any state to a local minimum of Π at fixed load.

use super::newton::chord_steps;
use super::options::{NewtonOptions, TrustRegionOptions};
use super::status::Status;
use super::subproblem::{Subproblem, TrustStep};
use super::system::System;
use super::vector::{max_norm, norm};
use crate::lie::LieGroup;

/// What a minimisation has to reach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    /// Dimensionless residual that suffices.
    pub tolerance: f64,
    /// The tangent may be that of the last state but one where the last step left less than this share of
    /// the residual.
    pub tangent_reuse: f64,
}

/// Newton's method in a trust region.
#[derive(Clone, Debug)]
pub(super) struct TrustRegion {
    options: TrustRegionOptions,
    newton: NewtonOptions,
    subproblem: Subproblem,
    /// The state and residual that a rejected step goes back to.
    state: Vec<f64>,
    residual: Vec<f64>,
}

impl TrustRegion {
    pub fn new(options: TrustRegionOptions, newton: NewtonOptions, dof: usize) -> Self {
        let subproblem = Subproblem::new(options, dof);
        Self { options, newton, subproblem, state: vec![0.0; dof], residual: vec![0.0; dof] }
    }

    /// Minimises Π from the system's state; the energy never rises along accepted steps.
    pub fn minimize_energy<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        mut radius: f64,
        target: Target,
    ) -> Status {
        let Target { tolerance, tangent_reuse } = target;
        let mut size = system.evaluate();
        if !size.is_finite() {
            return Status::Diverged;
        }
        system.evaluate_tangent();
        let mut energy = system.data().energy();
        let (mut rejected, mut unrestrained) = (false, 0);
        let status = loop {
            if let Some(status) = system.budget.exhausted() {
                break status;
            }
            if size <= tolerance && system.factorise(0.0) && system.has_converged(size, tolerance) {
                break Status::Converged;
            }
            let Some(step) = self.subproblem.solve(system, radius, tolerance) else { break Status::Diverged };
            let length = norm(&self.subproblem.step);
            let longest = max_norm(&self.subproblem.step);
            if step.definite && longest <= self.newton.small_step && system.is_balanced(tolerance) {
                system.factorise(0.0);
                break Status::Converged;
            }
            if radius < self.options.min_radius {
                break Status::Stalled;
            }
            self.state.copy_from_slice(system.state());
            self.residual.copy_from_slice(system.residual());
            system.advance(&self.subproblem.step);
            let trial_size = system.evaluate();
            let negligible = step.newton && longest <= self.newton.negligible_step;
            if negligible && !(trial_size < self.newton.progress * size) {
                // What is left is rounding, but more than its terms account for.
                system.restore(&self.state, &self.residual);
                break Status::Stalled;
            }
            let actual = (energy - system.data().energy()) / system.unit_energy();
            let rounding = self.options.rounding * (1.0 + energy.abs() / system.unit_energy());
            rejected = !(self.accepts(step, actual, rounding, trial_size < size) && trial_size.is_finite());
            if rejected {
                // The tangent at hand is still that of the state gone back to.
                system.restore(&self.state, &self.residual);
                radius = self.options.shrinkage * length.min(radius);
                unrestrained = 0;
                continue;
            }
            unrestrained = if step.free { unrestrained + 1 } else { 0 };
            if unrestrained > self.options.max_free_steps {
                break Status::Unrestrained;
            }
            let ratio = if step.decrease > rounding { actual / step.decrease } else { 1.0 };
            radius = self.next_radius(radius, length, ratio);
            let before = std::mem::replace(&mut size, trial_size);
            if step.newton {
                let step = &mut self.subproblem.step;
                let left = chord_steps(system, &self.newton, step, &mut size, before, tolerance);
                if left < tangent_reuse && system.has_converged(size, tolerance) {
                    break Status::Converged;
                }
                if !size.is_finite() {
                    break Status::Diverged;
                }
            }
            energy = system.data().energy();
            system.evaluate_tangent();
        };
        if rejected {
            system.evaluate();
        }
        status
    }

    /// Whether a step is accepted that lowered the energy by `actual`.
    ///
    /// Close to the minimum the energy is lost in rounding: there the residual decides.
    fn accepts(&self, step: TrustStep, actual: f64, rounding: f64, residual_lower: bool) -> bool {
        if step.decrease > rounding {
            actual > self.options.acceptance_ratio * step.decrease
        } else {
            residual_lower || (!step.definite && actual >= -rounding)
        }
    }

    fn next_radius(&self, radius: f64, length: f64, ratio: f64) -> f64 {
        let options = &self.options;
        if ratio > options.good_ratio && length > options.boundary_share * radius {
            (options.growth * radius).min(options.max_radius)
        } else if ratio < options.poor_ratio {
            options.shrinkage * length
        } else {
            radius
        }
    }
}
