//! Equilibria under loads that have no potential to minimise: damped Newton on the residual, and where
//! that fails or ends in an unstable state, the overdamped motion that follows.

use super::options::DampedNewtonOptions;
use super::stability::Stability;
use super::status::Status;
use super::system::System;
use super::vector::{max_norm, norm};
use crate::lie::LieGroup;
use crate::tolerances::ZERO_EIGENVALUE;

/// Newton's method with halved steps.
#[derive(Clone, Debug)]
pub(super) struct DampedNewton {
    options: DampedNewtonOptions,
    step: Vec<f64>,
    start: Vec<f64>,
    /// A part of the step.
    scaled: Vec<f64>,
    /// Whether the search shortened the step accepted last.
    shortened: bool,
}

impl DampedNewton {
    pub fn new(options: DampedNewtonOptions, dof: usize) -> Self {
        Self {
            options,
            step: vec![0.0; dof],
            start: vec![0.0; dof],
            scaled: vec![0.0; dof],
            shortened: false,
        }
    }

    /// An equilibrium near the system's state, a statically stable one if there is any.
    pub fn solve<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        tolerance: f64,
    ) -> Status {
        let start = system.state().to_vec();
        let found = self.solve_residual(system, tolerance, self.options.max_steps);
        let lost = match found {
            Status::Converged => system.stability() == Stability::Unstable,
            _ => true,
        };
        if !lost {
            return found;
        }
        let fallback = system.state().to_vec();
        if found != Status::Converged {
            system.set_state(&start);
        }
        let relaxed = self.relax(system, tolerance);
        if relaxed == Status::Converged && system.stability() != Stability::Unstable {
            return relaxed;
        }
        if found != Status::Converged {
            return if relaxed == Status::Unrestrained { relaxed } else { found };
        }
        system.set_state(&fallback);
        system.evaluate();
        system.evaluate_tangent();
        system.factorise(0.0);
        Status::Unstable
    }

    /// Whether a few steps lead to an equilibrium that is not statically unstable.
    pub fn correct<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        tolerance: f64,
    ) -> bool {
        let found = self.solve_residual(system, tolerance, self.options.max_correction);
        found == Status::Converged && system.stability() != Stability::Unstable
    }

    /// Solves the residual from the system's state; its norm never rises along accepted steps.
    ///
    /// It may have a minimum above zero, where the tangent is singular. Steps towards that become ever shorter, so
    /// that the method is given up where they make no progress.
    fn solve_residual<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        tolerance: f64,
        max_steps: usize,
    ) -> Status {
        let mut size = system.evaluate();
        let mut creeping = 0;
        for _ in 0..=max_steps {
            if !size.is_finite() {
                return Status::Diverged;
            }
            system.evaluate_tangent();
            system.factorise(0.0);
            if system.has_converged(size, tolerance) {
                return Status::Converged;
            }
            if let Some(status) = system.budget.exhausted() {
                return status;
            }
            system.newton_step(&mut self.step);
            if !norm(&self.step).is_finite() {
                return Status::Diverged;
            }
            let before = norm(system.residual());
            let lowered = self.search(system);
            let left = norm(system.residual()) / before;
            creeping = if self.shortened && left > 1.0 - self.options.progress { creeping + 1 } else { 0 };
            match lowered {
                Some(lowered) if creeping <= self.options.max_creeping => size = lowered,
                _ => return self.why_stalled(system, tolerance),
            }
        }
        Status::Stalled
    }

    /// The status where a step from `start`, to which the system returns, has not lowered the residual enough.
    fn why_stalled<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        system: &mut System<G, D, P>,
        tolerance: f64,
    ) -> Status {
        system.set_state(&self.start);
        system.evaluate();
        if system.is_balanced(tolerance) {
            Status::Converged
        } else if system.is_singular() {
            Status::Unrestrained
        } else {
            Status::Stalled
        }
    }

    /// Halves the step until it lowers the norm of the residual; returns the largest residual then.
    fn search<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
    ) -> Option<f64> {
        // The linear model is not valid further away.
        let mut fraction = (self.options.max_step / max_norm(&self.step)).min(1.0);
        let longest = fraction;
        let before = norm(system.residual());
        self.start.copy_from_slice(system.state());
        for _ in 0..self.options.max_halvings {
            system.advance_from(&self.start, &self.step, fraction);
            let size = system.evaluate();
            if size.is_finite() && norm(system.residual()) < before {
                self.scaled.iter_mut().zip(&self.step).for_each(|(x, s)| *x = fraction * s);
                match system.stopped_by_contact(&self.start, &self.scaled) {
                    None => {
                        self.shortened = fraction < longest;
                        return Some(size);
                    }
                    Some(part) => fraction *= part.min(0.5),
                }
            } else {
                fraction *= 0.5;
            }
        }
        None
    }

    /// Follows dq/dt = −g by implicit Euler steps (H + σ) p = −g, of increasing length; from an
    /// unstable equilibrium in the direction of the eigenvalue that is negative.
    fn relax<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        tolerance: f64,
    ) -> Status {
        let origin = system.state().to_vec();
        let mut size = system.evaluate();
        let mut shift = f64::INFINITY;
        let mut unrestrained = 0;
        for iteration in 0..self.options.max_relaxation {
            if !size.is_finite() {
                return Status::Diverged;
            }
            if let Some(status) = system.budget.exhausted() {
                return status;
            }
            system.evaluate_tangent();
            let Some((low, direction)) = system.lowest_eigenvalue() else { return Status::Stalled };
            system.factorise(0.0);
            if system.has_converged(size, tolerance) {
                match direction.filter(|_| iteration == 0) {
                    None => return Status::Converged,
                    Some(mut direction) => {
                        direction.iter_mut().for_each(|x| *x *= self.options.perturbation);
                        system.advance(&direction);
                        size = system.evaluate();
                        continue;
                    }
                }
            }
            shift = if low < 0.0 { -2.0 * low } else { (0.25 * shift).min(low) };
            if low >= 0.0 && shift < 1e-2 * low {
                shift = 0.0;
            }
            // Along a motion without stiffness the force leads on until something stops it.
            let free = system.is_singular() || !(low.abs() > ZERO_EIGENVALUE);
            unrestrained = if free { unrestrained + 1 } else { 0 };
            if unrestrained > self.options.max_free_steps {
                return Status::Unrestrained;
            }
            if free {
                shift = norm(system.residual()) / self.options.max_step;
            }
            loop {
                system.factorise(shift);
                system.newton_step(&mut self.step);
                if max_norm(&self.step) <= self.options.max_step {
                    break;
                }
                shift = (4.0 * shift).max(1e-3);
                if !shift.is_finite() {
                    return Status::Diverged;
                }
            }
            self.start.copy_from_slice(system.state());
            system.advance(&self.step);
            size = system.evaluate();
            if let Some(part) = system.stopped_by_contact(&self.start, &self.step) {
                system.advance_from(&self.start, &self.step, part);
                size = system.evaluate();
                // The stiffness of the contact holds near the surface only.
                shift = f64::INFINITY;
            }
            if system.has_diverged(&origin) {
                return Status::Unrestrained;
            }
        }
        Status::Stalled
    }
}
