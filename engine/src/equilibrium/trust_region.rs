//! Trust-region Newton: from any state to a local minimum of Π at fixed load.

use super::newton::chord_steps;
use super::options::{NewtonOptions, TrustRegionOptions};
use super::status::Status;
use super::subproblem::{Subproblem, TrustStep};
use super::system::System;
use super::vector::{dot, max_norm, norm};
use crate::lie::LieGroup;

/// Accuracy required of a minimisation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    /// Largest dimensionless residual.
    pub tolerance: f64,
    /// The tangent of the last but one state is accepted if the last step left less than this fraction of
    /// the residual.
    pub tangent_reuse: f64,
}

/// Newton's method in a trust region.
#[derive(Clone, Debug)]
pub(super) struct TrustRegion {
    options: TrustRegionOptions,
    newton: NewtonOptions,
    subproblem: Subproblem,
    /// The initial state.
    start: Vec<f64>,
    /// The state and residual that are restored after a rejected step.
    state: Vec<f64>,
    residual: Vec<f64>,
    moved: Vec<f64>,
    /// The best state of an improved step, and a correction to it.
    best: Vec<f64>,
    correction: Vec<f64>,
}

impl TrustRegion {
    pub fn new(options: TrustRegionOptions, newton: NewtonOptions, dof: usize) -> Self {
        let subproblem = Subproblem::new(options, dof);
        Self {
            options,
            newton,
            subproblem,
            start: vec![0.0; dof],
            state: vec![0.0; dof],
            residual: vec![0.0; dof],
            moved: vec![0.0; dof],
            best: vec![0.0; dof],
            correction: vec![0.0; dof],
        }
    }

    /// Minimises Π from the system's state; the energy never rises along accepted steps.
    pub fn minimize_energy<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        radius: f64,
        target: Target,
    ) -> Status {
        let status = self.descend(system, radius, target);
        if status != Status::Converged {
            // The last step may have been rejected.
            system.evaluate();
        }
        status
    }

    fn descend<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        mut radius: f64,
        target: Target,
    ) -> Status {
        let Target { tolerance, tangent_reuse } = target;
        self.start.copy_from_slice(system.state());
        let mut size = system.evaluate();
        if !size.is_finite() {
            return Status::Diverged;
        }
        system.evaluate_tangent();
        system.start_sweeps();
        let mut energy = system.energy();
        // What moves without elasticity may leave a contact, and fall on it again.
        let loose = !system.data().design.units.all_elastic();
        let (mut unrestrained, mut stiff) = (0, false);
        loop {
            if let Some(status) = system.budget.exhausted() {
                return status;
            }
            if size <= tolerance && system.factorise(0.0) && system.has_converged(size, tolerance) {
                return Status::Converged;
            }
            let Some(step) = self.subproblem.solve(system, radius, tolerance) else {
                return Status::Diverged;
            };
            let length = norm(&self.subproblem.step);
            let longest = max_norm(&self.subproblem.step);
            if step.definite && longest <= self.newton.small_step {
                system.evaluate();
                if system.is_balanced(tolerance) {
                    system.factorise(0.0);
                    return Status::Converged;
                }
                if system.is_lost_in_rounding() {
                    return Status::Stalled;
                }
            }
            if radius < self.options.min_radius {
                return Status::Stalled;
            }
            self.state.copy_from_slice(system.state());
            self.residual.copy_from_slice(system.residual());
            system.advance(&self.subproblem.step);
            let mut trial_size = system.evaluate();
            if system.is_projected() {
                trial_size = system.close(trial_size);
            }
            if let Some(part) = system.stopped_by_contact(&self.state, &self.subproblem.step) {
                self.return_from_rejected(system, loose);
                unrestrained = 0;
                radius = part.min(0.5) * length;
                continue;
            }
            let negligible = step.newton && longest <= self.newton.negligible_step;
            if negligible && !(trial_size < self.newton.progress * size) {
                // The residual is rounding, but larger than that of its terms.
                system.restore(&self.state, &self.residual);
                return Status::Stalled;
            }
            let rounding = self.options.rounding * (1.0 + energy.abs() / system.unit_energy());
            let lost = step.decrease <= rounding;
            let mut actual = self.gain(system, energy, stiff && lost);
            let poor = !(actual > self.options.poor_ratio * step.decrease);
            let mut searched = false;
            if stiff && poor {
                (trial_size, searched) = self.improve(system, step, &mut actual, energy, [lost, loose]);
            }
            let accepted = if stiff && (searched || step.definite && lost) {
                actual > 0.0
            } else {
                self.accepts(step, actual, rounding, trial_size < size)
            };
            if !(accepted && trial_size.is_finite()) {
                // The current tangent is that of the restored state.
                self.return_from_rejected(system, loose);
                stiff |= length < self.options.stiff_radius || system.is_projected();
                radius = self.options.shrinkage * length.min(radius);
                unrestrained = 0;
                continue;
            }
            unrestrained = if step.free { unrestrained + 1 } else { 0 };
            if unrestrained > self.options.max_free_steps || system.has_diverged(&self.start) {
                return Status::Unrestrained;
            }
            let ratio = if step.decrease > rounding { actual / step.decrease } else { 1.0 };
            if !searched {
                radius = self.next_radius(radius, length, ratio, stiff && loose && step.shift > 0.0);
            }
            let before = std::mem::replace(&mut size, trial_size);
            if step.newton {
                let step = &mut self.subproblem.step;
                let left = chord_steps(system, &self.newton, step, &mut size, before, tolerance);
                let reusable = left < tangent_reuse && system.is_near_tangent();
                if reusable && system.has_converged(size, tolerance) {
                    return Status::Converged;
                }
                if !size.is_finite() {
                    return Status::Diverged;
                }
            }
            energy = system.energy();
            system.evaluate_tangent();
            system.start_sweeps();
        }
    }

    /// Restores the state before a rejected step; where some coordinate is not elastic, with the forces there, to
    /// which residuals are compared.
    fn return_from_rejected<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        system: &mut System<G, D, P>,
        loose: bool,
    ) {
        system.restore(&self.state, &self.residual);
        if loose {
            system.evaluate();
        }
    }

    /// Decrease of the energy over the step; where that is lost in rounding, the work of the mean of both
    /// residuals.
    fn gain<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &System<G, D, P>,
        energy: f64,
        lost: bool,
    ) -> f64 {
        if !lost {
            return (energy - system.energy()) / system.unit_energy();
        }
        system.displacement(&self.state, &mut self.moved);
        let forces = self.residual.iter().zip(system.residual());
        -0.5 * forces.zip(&self.moved).map(|((a, b), x)| (a + b) * x).sum::<f64>()
    }

    /// Improves a step that lowers the energy too little by second-order corrections or by a line search.
    /// Leaves the best state found, and its decrease in `actual`; returns its residual and whether the line
    /// search found it.
    fn improve<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        step: TrustStep,
        actual: &mut f64,
        energy: f64,
        [lost, loose]: [bool; 2],
    ) -> (f64, bool) {
        let better = |found: f64, best: f64| found > best || !best.is_finite();
        self.best.copy_from_slice(system.state());
        let longest = self.options.max_correction * max_norm(&self.subproblem.step);
        for _ in 0..if step.part > 0.0 { self.options.max_corrections } else { 0 } {
            // Residual predicted by the quadratic model: H p = −part · g − shift · p.
            let linear = self.residual.iter().zip(&self.subproblem.step);
            let expected = linear.map(|(g, p)| (1.0 - step.part) * g - step.shift * p);
            for ((c, r), e) in self.correction.iter_mut().zip(system.residual()).zip(expected) {
                *c = e - r;
            }
            system.solve(&mut self.correction);
            if !(max_norm(&self.correction) <= longest) {
                break;
            }
            system.advance(&self.correction);
            let size = system.evaluate();
            if system.is_projected() && !system.close(size).is_finite() {
                break;
            }
            let found = self.gain(system, energy, lost);
            if !better(found, *actual) {
                break;
            }
            *actual = found;
            self.best.copy_from_slice(system.state());
        }
        let descends = (step.definite || loose && step.part > 0.0) && !system.is_projected();
        let search = descends && !(*actual > self.options.poor_ratio * step.decrease);
        if search {
            let mut at = 0.5;
            let mut low = (0.0, dot(&self.residual, &self.subproblem.step));
            let mut high: Option<(f64, f64)> = None;
            for _ in 0..self.options.max_line_search {
                system.advance_from(&self.state, &self.subproblem.step, at);
                let finite = system.evaluate().is_finite();
                let found = self.gain(system, energy, lost);
                if finite && better(found, *actual) {
                    *actual = found;
                    self.best.copy_from_slice(system.state());
                }
                // The energy decreases at first; it is lowest where its slope changes sign.
                let slope = dot(system.residual(), &self.subproblem.step);
                if finite && slope.abs() < self.options.line_search_slope * step.decrease {
                    break;
                }
                if finite && slope < 0.0 {
                    low = (at, slope);
                } else {
                    high = Some((at, if finite { slope } else { f64::INFINITY }));
                }
                at = match high {
                    None => 0.5 * (at + 1.0),
                    Some((end, _)) if low.0 == 0.0 => 0.1 * end,
                    Some((end, rise)) => {
                        let secant = (rise * low.0 - low.1 * end) / (rise - low.1);
                        let margin = 0.1 * (end - low.0);
                        let middle = 0.5 * (low.0 + end);
                        if secant.is_finite() { secant.clamp(low.0 + margin, end - margin) } else { middle }
                    }
                };
            }
        }
        system.set_state(&self.best);
        (system.evaluate(), search)
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

    /// The radius after an accepted step of this length, which the radius limited or not.
    fn next_radius(&self, radius: f64, length: f64, ratio: f64, limited: bool) -> f64 {
        let options = &self.options;
        if ratio > options.good_ratio && (limited || length > options.boundary_share * radius) {
            (options.growth * radius).min(options.max_radius)
        } else if ratio < options.poor_ratio {
            options.shrinkage * length
        } else {
            radius
        }
    }
}
