//! One sub-step along a branch: predictor, Newton corrector, and the test that it is the same branch.

use super::descent::NEGLIGIBLE_STEP;
use super::solver::{Solver, largest, norm};
use crate::lie::LieGroup;
use crate::model::Model;

/// Chord steps with the tangent foreseen, each of which must leave less than this of the residual
const FORESEEN: usize = 2;
const USEFUL: f64 = 0.3;
/// and all of which go no further than this, as a multiple of the predictor;
const CLOSE: f64 = 0.3;
/// where one of them would go this far, the prediction is given up.
const ASTRAY: f64 = 1.4;
/// Corrector iterations of one sub-step: more are rarely needed unless another branch attracts.
const CORRECTIONS: usize = 7;
/// How far the corrector may go, as a multiple of the predictor.
const WANDER: f64 = 0.7;
/// and this (dimensionless) in any case.
const SLIGHT: f64 = 1e-3;
/// Chord steps are taken while each leaves less than this of the residual
const CONTRACTION: f64 = 0.1;
/// and this many more of them, at the same rate, would do.
const CHORDS: i32 = 3;
/// Shares of the displacement and of the velocity by which the prediction may be missed
const NEAR: f64 = 0.3;
const ALIKE: f64 = 0.7;
/// where the velocity turns, over one sub-step, by more than this: it could hide a jump.
const LARGEST_BEND: f64 = 2.5;

/// When a corrector is done.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    /// Dimensionless residual that suffices.
    pub tolerance: f64,
    /// Where the last step left less than this of the residual, its tangent does for the state it led
    /// to: H⁻¹ times their difference is of this size along the step.
    pub keep: f64,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Solver<G, D, P> {
    /// dq/dλ of the equilibrium for the load rate `rate`, dimensionless, into `velocity[which]`.
    ///
    /// Needs the factor of the tangent at the equilibrium evaluated last.
    pub(super) fn set_velocity(&mut self, model: &Model<G, D, P>, rate: &[f64], which: usize) {
        self.work.fill(0.0);
        self.data.add_load_gradient(model, &self.q, rate, &mut self.work);
        let unit_energy = self.data.design.reference_stiffness;
        for (v, (w, unit)) in self.velocity[which].iter_mut().zip(self.work.iter().zip(&self.unit)) {
            *v = -w * unit / unit_energy;
        }
        self.factor.solve(&mut self.velocity[which]);
    }

    /// Tries to move from the equilibrium in `start` by `h` along the load rate, as far as predicted. On
    /// success the state, factor and `velocity[1]` are those of the new equilibrium.
    pub(super) fn follow_branch(&mut self, model: &Model<G, D, P>, rate: &[f64], h: f64, goal: Goal) -> bool {
        self.prediction.displacement(h, &mut self.step);
        self.q.copy_from_slice(&self.start);
        Self::advance(&mut self.q, &self.step, &self.unit);
        let reach = largest(&self.step);
        let Some((size, went)) = self.approach(model, h, reach, goal.tolerance) else { return false };
        if !self.correct(model, size, WANDER * reach - went, goal) {
            return false;
        }
        self.set_velocity(model, rate, 1);
        self.is_consistent(h)
    }

    /// Chord steps from the predicted state, with the tangent foreseen there; the residual that they
    /// leave and how far they went, or `None` where the prediction is far off.
    fn approach(&mut self, model: &Model<G, D, P>, h: f64, reach: f64, tolerance: f64) -> Option<(f64, f64)> {
        let mut size = self.evaluate(model);
        let mut went = 0.0;
        for _ in 0..FORESEEN {
            if size <= tolerance {
                break;
            }
            self.set_step_against_residual();
            self.prediction.solve(h, &mut self.step);
            let length = largest(&self.step);
            if !(length <= ASTRAY * reach + SLIGHT) {
                return None;
            }
            if went + length > CLOSE * reach + SLIGHT {
                break;
            }
            went += length;
            Self::advance(&mut self.q, &self.step, &self.unit);
            let before = std::mem::replace(&mut size, self.evaluate(model));
            if !(size < USEFUL * before) {
                break;
            }
        }
        Some((size, went))
    }

    /// Newton's method with full steps from a state whose residual has this size; fails as soon as the
    /// tangent is not positive definite, and when it goes further than `reach`.
    fn correct(&mut self, model: &Model<G, D, P>, mut size: f64, reach: f64, goal: Goal) -> bool {
        let mut previous = f64::INFINITY;
        let mut wandered = 0.0;
        for _ in 0..CORRECTIONS {
            if !size.is_finite() {
                return false;
            }
            self.evaluate_tangent(model);
            if !self.factorise(0.0) {
                return false;
            }
            if size <= goal.tolerance {
                return true;
            }
            self.newton_step();
            let length = largest(&self.step);
            if length <= NEGLIGIBLE_STEP {
                return true;
            }
            // A corrector that wanders off does not belong to the predictor's branch.
            wandered += length;
            if wandered > reach + SLIGHT || length > 2.0 * previous {
                return false;
            }
            previous = length;
            Self::advance(&mut self.q, &self.step, &self.unit);
            let before = std::mem::replace(&mut size, self.evaluate(model));
            let contraction = self.chord_steps(model, &mut size, before, goal.tolerance);
            if size <= goal.tolerance && contraction < goal.keep {
                return true;
            }
        }
        false
    }

    /// Chord steps with the tangent at hand, while each leaves little of the residual and a few more
    /// will do. The residual was `before` ahead of the last step and is left at `size`; returns what
    /// share of it the last step left.
    pub(super) fn chord_steps(
        &mut self,
        model: &Model<G, D, P>,
        size: &mut f64,
        before: f64,
        tolerance: f64,
    ) -> f64 {
        let mut contraction = *size / before;
        while *size > tolerance && contraction < CONTRACTION && *size * contraction.powi(CHORDS) <= tolerance
        {
            self.newton_step();
            Self::advance(&mut self.q, &self.step, &self.unit);
            let before = std::mem::replace(size, self.evaluate(model));
            contraction = *size / before;
        }
        contraction
    }

    /// Whether the displacement agrees with what was predicted, or with the velocities at both ends.
    ///
    /// On one branch with a change of contact the path is nearly two straight pieces, so the
    /// displacement lies between the two tangents; a jump to another branch does not.
    fn is_consistent(&mut self, h: f64) -> bool {
        self.prediction.displacement(h, &mut self.work);
        let (mut missed, mut turned, mut moved) = (0.0, 0.0, 0.0);
        let (mut error, mut bend, mut reach, mut speed) = (0.0, 0.0, 0.0, 0.0);
        let [v0, v1] = &self.velocity;
        let expected = self.prediction.velocity(h).zip(&self.work);
        let states = self.q.iter().zip(&self.start).zip(&self.unit);
        for (((q, s), u), ((a, b), (v, d))) in states.zip(v0.iter().zip(v1).zip(expected)) {
            let went = (q - s) / u;
            missed += (went - d).powi(2);
            moved += went.powi(2);
            turned += (b - v).powi(2);
            speed += v.powi(2);
            error += (went - 0.5 * h * (a + b)).powi(2);
            bend += (h * (b - a)).powi(2);
            reach += (0.5 * h * (a.abs() + b.abs())).powi(2);
        }
        let as_predicted = missed.sqrt() <= NEAR * moved.sqrt() && turned.sqrt() <= ALIKE * speed.sqrt();
        let between_tangents = bend.sqrt() <= LARGEST_BEND
            && error.sqrt() <= 0.6 * bend.sqrt() + 0.05 * reach.sqrt() + 1e-9
            && norm(v1).is_finite();
        as_predicted || between_tangents
    }
}
