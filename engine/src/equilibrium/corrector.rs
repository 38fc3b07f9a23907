//! The corrector of one sub-step: Newton's method from the predicted state.

use super::bent_step::BentStep;
use super::mixed_newton::{Approach, MixedNewton};
use super::newton::chord_steps;
use super::options::{ContinuationOptions, CorrectorOptions, NewtonOptions};
use super::predictor::Predictor;
use super::system::System;
use super::vector::max_norm;
use crate::lie::LieGroup;
use crate::model::Model;
use crate::tolerances::ZERO_EIGENVALUE;

/// When a corrector is done.
#[derive(Clone, Copy, Debug)]
pub(super) struct CorrectorTolerance {
    /// Largest dimensionless residual.
    pub residual: f64,
    /// The tangent of the last step is reused for the final state if that step reduced the residual to less
    /// than this fraction and no contact changed.
    pub tangent_reuse: f64,
    /// Whether it is reused only if it shows that the final state is stable: a soft structure may have become
    /// unstable.
    pub stable: bool,
}

/// Newton's method with full steps; fails where it seems to converge to another branch.
#[derive(Clone, Debug)]
pub(super) struct Corrector<const D: usize, const P: usize> {
    options: CorrectorOptions,
    newton: NewtonOptions,
    step: Vec<f64>,
    bent_step: BentStep<D, P>,
    pub mixed: MixedNewton<D, P>,
}

impl<const D: usize, const P: usize> Corrector<D, P> {
    pub fn new<G: LieGroup<D, P>>(model: &Model<G, D, P>, options: &ContinuationOptions) -> Self {
        Self {
            options: options.corrector,
            newton: options.newton,
            step: vec![0.0; model.dof()],
            bent_step: BentStep::new(model, options.predictor),
            mixed: MixedNewton::new(model, options.mixed, options.newton),
        }
    }

    /// Solves for the equilibrium under the system's load from the state predicted `h` ahead of the current
    /// one. On success the current tangent is positive definite and that of the solution.
    pub fn correct<G: LieGroup<D, P>>(
        &mut self,
        system: &mut System<G, D, P>,
        predictor: &Predictor<D, P>,
        h: f64,
        tolerance: CorrectorTolerance,
    ) -> bool {
        predictor.displacement(h, &mut self.step);
        let predicted = max_norm(&self.step);
        let reach = self.options.max_correction * predicted;
        let approach = if system.is_stiff() {
            self.mixed.start(system);
            system.advance(&self.step);
            self.mixed.approach(system, reach + self.options.free_correction)
        } else {
            system.advance(&self.step);
            self.predicted_chords(system, predictor, h, predicted, tolerance.residual)
        };
        approach
            .is_some_and(|Approach { size, length }| self.iterate(system, size, reach - length, tolerance))
    }

    /// Chord steps from the predicted state with the predicted tangent; `None` where the length of one shows
    /// that the prediction is wrong.
    fn predicted_chords<G: LieGroup<D, P>>(
        &mut self,
        system: &mut System<G, D, P>,
        predictor: &Predictor<D, P>,
        h: f64,
        predicted: f64,
        tolerance: f64,
    ) -> Option<Approach> {
        let options = &self.options;
        let mut size = system.evaluate();
        let mut total = 0.0;
        for _ in 0..options.max_predicted_chords {
            if size <= tolerance {
                break;
            }
            system.negative_residual(&mut self.step);
            predictor.solve(h, &mut self.step);
            let length = max_norm(&self.step);
            if !(length <= options.rejection_ratio * predicted + options.free_correction) {
                return None;
            }
            if total + length > options.predicted_chord_reach * predicted + options.free_correction {
                break;
            }
            total += length;
            system.advance(&self.step);
            let before = std::mem::replace(&mut size, system.evaluate());
            if !(size < options.predicted_chord_contraction * before) {
                break;
            }
        }
        Some(Approach { size, length: total })
    }

    /// Newton's method with full steps from a state whose largest residual is `size`; fails if a tangent is
    /// not positive definite or the steps add up to more than `reach`.
    pub(super) fn iterate<G: LieGroup<D, P>>(
        &mut self,
        system: &mut System<G, D, P>,
        mut size: f64,
        reach: f64,
        tolerance: CorrectorTolerance,
    ) -> bool {
        let mut previous = f64::INFINITY;
        let mut total = 0.0;
        for _ in 0..self.options.max_iterations {
            if !size.is_finite() {
                return false;
            }
            system.evaluate_tangent();
            // Along a neutral motion, as that of a buckled round column about its axis, the computed stiffness
            // is of the size of the residual.
            let most = tolerance.residual.min(self.options.soft_residual);
            let definite = system.factorise(0.0);
            let neutral = self.options.neutral_residual.min(tolerance.residual);
            if !(definite || size <= most && system.factorise(size.max(neutral) + ZERO_EIGENVALUE)) {
                return false;
            }
            let accurate = definite || size <= neutral;
            if accurate && system.has_converged(size, tolerance.residual) {
                return true;
            }
            system.newton_step(&mut self.step);
            let length = max_norm(&self.step);
            if accurate && length <= self.newton.small_step && system.is_balanced(tolerance.residual) {
                return true;
            }
            total += length;
            let too_far = total > reach + self.options.free_correction;
            if too_far || length > self.options.max_step_growth * previous {
                return false;
            }
            previous = length;
            let before = size;
            size = self.bent_step.advance(system, &mut self.step, before);
            if length <= self.newton.negligible_step && !(size < self.newton.progress * before) {
                return false;
            }
            let left =
                chord_steps(system, &self.newton, &mut self.step, &mut size, before, tolerance.residual);
            let reusable = left < tolerance.tangent_reuse && system.is_near_tangent();
            let converged = reusable && system.has_converged(size, tolerance.residual);
            if converged && (!tolerance.stable || system.shows_stability()) {
                return true;
            }
        }
        false
    }
}
