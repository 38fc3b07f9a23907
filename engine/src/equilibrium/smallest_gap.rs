//! The smallest gaps of ties that cannot be closed: a question of kinematics alone.

use super::system::System;
use crate::lie::LieGroup;
use nalgebra::{DMatrix, DVector};

/// Weight of conditions that cannot be met, relative to those that can.
const OPEN: f64 = 1e-4;
/// Weight of the conditions that are being met.
const CLOSING: f64 = 1e-2;
/// Largest number of steps for each group of conditions.
const STEPS: usize = 200;
/// Dimensionless step that ends the search.
const SMALL: f64 = 1e-10;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> System<'_, G, D, P> {
    /// Goes to the state near the current one in which ties, those first in the model before others, are
    /// closed as far as they can be under the current load; returns the largest gap left, relative to the
    /// longest body or in radians.
    pub(super) fn close_as_far_as_possible(&mut self, tolerance: f64) -> f64 {
        let ties = &self.model().forces.ties;
        let mut weights = vec![0.0; ties.row_count()];
        self.acting = ties.count();
        for tie in 0..ties.count() {
            // What drives a tie comes after what it holds.
            let rows = ties.rows(tie);
            let held = rows.end - usize::from(ties.is_driven(tie));
            for rows in [rows.start..held, held..rows.end] {
                weights[rows.clone()].fill(CLOSING);
                self.minimise_gaps(&weights);
                let conditions = self.scaled_conditions();
                let gap = rows.clone().map(|k| conditions[k].abs()).fold(0.0, f64::max);
                weights[rows].fill(if gap <= tolerance { 1.0 } else { OPEN });
            }
        }
        self.minimise_gaps(&weights);
        self.largest_gap()
    }

    /// Levenberg's and Marquardt's method for the weighted squares of the conditions.
    fn minimise_gaps(&mut self, weight: &[f64]) {
        let weighted = |system: &Self| {
            let mut c = system.scaled_conditions();
            c.iter_mut().zip(weight).for_each(|(c, w)| *c *= w);
            c
        };
        self.evaluate();
        let mut values = weighted(self);
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            let mut rows = self.scaled_gradients();
            rows.row_iter_mut().zip(weight).for_each(|(mut row, w)| row *= *w);
            let normal = &rows * rows.transpose();
            let size = normal.trace().max(f64::MIN_POSITIVE);
            let start = self.state().to_vec();
            let mut moved = None;
            while damping < 1e12 {
                let m = normal.nrows();
                let matrix = &normal + DMatrix::identity(m, m) * (damping * size);
                let Some(factors) = matrix.cholesky() else {
                    damping *= 10.0;
                    continue;
                };
                let step: DVector<f64> = rows.transpose() * -factors.solve(&values);
                self.move_naturally(step.as_slice());
                self.evaluate();
                let found = weighted(self);
                if found.norm_squared() < values.norm_squared() {
                    values = found;
                    damping = (damping * 0.1).max(1e-14);
                    moved = Some(step.amax());
                    break;
                }
                self.set_state(&start);
                damping *= 10.0;
            }
            if !moved.is_some_and(|step| step > SMALL) {
                break;
            }
        }
        self.evaluate();
    }
}
