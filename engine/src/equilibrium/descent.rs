//! Trust-region Newton: from any state down to a local minimum of Π at fixed load.

use super::solver::{Solver, largest, norm};
use super::status::Status;
use super::subproblem::TrustStep;
use crate::lie::LieGroup;
use crate::model::Model;

/// Dimensionless radii: one unit is one radian of the softest angular coordinate.
const LARGEST_RADIUS: f64 = 4.0;
/// A step that reaches the radius, and at least this share of the decrease foretold, widens it so many
/// times;
const GOOD: f64 = 0.75;
const WIDEN: f64 = 2.0;
/// one that reaches less than this share, or is turned back, narrows it to so much of its length.
const POOR: f64 = 0.25;
const NARROW: f64 = 0.4;
/// Below this, a Newton step no longer changes the state.
pub(super) const NEGLIGIBLE_STEP: f64 = 1e-11;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Solver<G, D, P> {
    /// Minimises Π from `self.q` under `self.load`; the energy never rises along accepted steps. The
    /// tangent may be that of the last state but one where the last step left less than `keep` of the
    /// residual.
    pub(super) fn descend(&mut self, model: &Model<G, D, P>, mut radius: f64, keep: f64) -> Status {
        let first = self.iterations;
        let tolerance = self.options.tolerance;
        let mut size = self.evaluate(model);
        if !size.is_finite() {
            return Status::Diverged;
        }
        self.evaluate_tangent(model);
        let mut energy = self.data.energy();
        let mut turned_back = false;
        let status = loop {
            if self.iterations - first > self.options.max_iterations {
                break Status::IterationLimit;
            }
            if size <= tolerance && self.factorise(0.0) {
                break Status::Converged;
            }
            let Some(step) = self.trust_region_step(model, radius) else { break Status::Diverged };
            let TrustStep { decrease, definite, inside } = step;
            let length = norm(&self.step);
            if definite && largest(&self.step) <= NEGLIGIBLE_STEP {
                break Status::Converged;
            }
            if radius < 1e-13 {
                break Status::Stalled;
            }
            self.trial.copy_from_slice(&self.q);
            self.trial_residual.copy_from_slice(&self.residual);
            Self::advance(&mut self.q, &self.step, &self.unit);
            let trial_size = self.evaluate(model);
            let trial_energy = self.data.energy();
            let unit_energy = self.data.design.reference_stiffness;
            let actual = (energy - trial_energy) / unit_energy;
            // Close to the minimum the energy is lost in rounding: there the residual decides.
            let noise = 1e-13 * (1.0 + energy.abs() / unit_energy);
            let accepted = if decrease > noise {
                actual > 1e-4 * decrease
            } else {
                trial_size < size || (!definite && actual >= -noise)
            };
            let ratio = if decrease > noise { actual / decrease } else { 1.0 };
            turned_back = !(accepted && trial_size.is_finite());
            if !turned_back {
                if ratio > GOOD && length > 0.8 * radius {
                    radius = (WIDEN * radius).min(LARGEST_RADIUS);
                } else if ratio < POOR {
                    radius = NARROW * length;
                }
                let before = std::mem::replace(&mut size, trial_size);
                if inside {
                    let contraction = self.chord_steps(model, &mut size, before, tolerance);
                    if size <= tolerance && contraction < keep {
                        break Status::Converged;
                    }
                    if !size.is_finite() {
                        break Status::Diverged;
                    }
                }
                energy = self.data.energy();
                self.evaluate_tangent(model);
            } else {
                // The tangent at hand is still that of the state gone back to.
                self.q.copy_from_slice(&self.trial);
                self.residual.copy_from_slice(&self.trial_residual);
                radius = NARROW * length.min(radius);
            }
        };
        if turned_back {
            self.evaluate(model);
        }
        status
    }
}
