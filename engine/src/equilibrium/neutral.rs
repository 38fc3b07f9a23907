//! Neutral motions of structures with ties: those along which an equilibrium goes over into others of the same
//! energy, as a closed ring of round rod rolls about its own axis.
//!
//! Along the velocity z of such a motion the energy is constant in every state, so that g·z = 0 and
//!
//! ```text
//! zᵀ H z = −g·ż:
//! ```
//!
//! at an equilibrium z is a null vector of H. Ahead of the next one its stiffness is of the size of the residual,
//! of any sign, and Newton's method would lead anywhere along the motion. Therefore neutral motions are found at
//! equilibria, followed from state to state, and given the stiffness of the structure, H + Σ z zᵀ. As no force acts
//! along them, steps are those of least length.

use super::system::System;
use super::vector::{dot, max_norm, norm};
use crate::lie::LieGroup;
use crate::linalg::Cholesky;
use crate::tolerances::{DRIFT_EIGENVALUE, OF_RESIDUAL, ZERO_EIGENVALUE};
use nalgebra::{DMatrix, DVector};

/// Largest number of neutral motions that are looked for: those of a free rigid body.
const MOST: usize = 6;
/// Inverse iterations for the direction of one.
const ITERATIONS: usize = 4;
/// Largest part of a change of load that may act along a neutral motion.
const LOADED: f64 = 1e-4;
/// Largest part of a change of load along a motion without stiffness that does not drive it.
const DRIVEN: f64 = 1e-6;

/// Their directions, of unit length and orthogonal to one another.
#[derive(Clone, Debug, Default)]
pub(super) struct NeutralMotions {
    directions: Vec<Vec<f64>>,
    cholesky: Cholesky,
}

impl NeutralMotions {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.directions.is_empty()
    }

    /// Replaces the directions of the last state, in the same basis as this matrix, by those of this one, and adds
    /// their stiffness. At a stable state those are forgotten whose own stiffness is more than that of a residual of
    /// this size.
    pub fn follow(&mut self, matrix: &mut [f64], size: f64) {
        let bare = matrix.to_vec();
        let last = self.directions.clone();
        self.orthonormalise();
        self.stiffen(matrix);
        // Null vectors of H are those of (H + Σ z zᵀ)⁻¹ Σ z zᵀ, too.
        let n = self.directions.first().map_or(0, Vec::len);
        let stable = self.factorise(matrix, n);
        let Self { directions, cholesky } = self;
        if stable {
            directions.iter_mut().for_each(|z| cholesky.solve(z));
        } else {
            let factor = DMatrix::from_row_slice(n, n, matrix).lu();
            for z in directions {
                if let Some(x) = factor.solve(&DVector::from_column_slice(z)) {
                    z.copy_from_slice(x.as_slice());
                }
            }
        }
        self.orthonormalise();
        let allowed = OF_RESIDUAL * size + DRIFT_EIGENVALUE;
        let known = self.directions.len();
        self.directions.retain(|z| stiffness(&bare, z).abs() <= allowed);
        if !stable && self.directions.len() < known {
            self.directions = last;
            self.orthonormalise();
        }
        matrix.copy_from_slice(&bare);
        self.stiffen(matrix);
    }

    /// Adds those of an equilibrium, whose residual has this size and to whose matrix the stiffness of those
    /// known is added; whether there are any. `rates` is the change of the forces with the load; the first `rank`
    /// coordinates do not move.
    pub fn find(&mut self, matrix: &mut [f64], size: f64, rates: &[f64], rank: usize) -> bool {
        let n = rates.len();
        let known = self.directions.len();
        let allowed = OF_RESIDUAL * size + ZERO_EIGENVALUE;
        while self.directions.len() < MOST.min(n) {
            let shifted: Vec<f64> = matrix
                .iter()
                .enumerate()
                .map(|(m, h)| if m % (n + 1) == 0 { h + DRIFT_EIGENVALUE.max(2.0 * allowed) } else { *h })
                .collect();
            if !self.factorise(&shifted, n) {
                break;
            }
            let mut z: Vec<f64> = (0..n).map(|i| 1.0 + 0.3 * ((i + 1) as f64 * 1.7).sin()).collect();
            z[..rank].fill(0.0);
            for _ in 0..ITERATIONS {
                self.cholesky.solve(&mut z);
                let length = norm(&z);
                z.iter_mut().for_each(|z| *z /= length);
            }
            let neutral = stiffness(matrix, &z).abs() <= allowed;
            if !(neutral && dot(&z, rates).abs() <= LOADED * norm(rates)) {
                break;
            }
            add_square(matrix, &z);
            self.directions.push(z);
        }
        self.directions.len() > known
    }

    /// Forgets all.
    pub fn forget(&mut self) {
        self.directions.clear();
    }

    /// Applies a change of basis to all directions.
    pub fn change_basis(&mut self, change: impl FnMut(&mut Vec<f64>)) {
        self.directions.iter_mut().for_each(change);
    }

    fn stiffen(&self, matrix: &mut [f64]) {
        self.directions.iter().for_each(|z| add_square(matrix, z));
    }

    fn factorise(&mut self, matrix: &[f64], n: usize) -> bool {
        let ones = vec![1.0; n];
        self.cholesky = Cholesky::new(n);
        self.cholesky.factorise(matrix, &ones, 0.0)
    }

    fn orthonormalise(&mut self) {
        let mut done: Vec<Vec<f64>> = vec![];
        for mut z in self.directions.drain(..) {
            let before = norm(&z);
            for other in &done {
                let along = dot(&z, other);
                z.iter_mut().zip(other).for_each(|(z, o)| *z -= along * o);
            }
            let length = norm(&z);
            if length > 1e-3 * before && length.is_finite() {
                z.iter_mut().for_each(|z| *z /= length);
                done.push(z);
            }
        }
        self.directions = done;
    }
}

/// zᵀ H z.
fn stiffness(matrix: &[f64], z: &[f64]) -> f64 {
    matrix.chunks(z.len()).zip(z).map(|(row, z_i)| z_i * dot(row, z)).sum()
}

/// H ← H + z zᵀ.
fn add_square(matrix: &mut [f64], z: &[f64]) {
    for (row, z_i) in matrix.chunks_mut(z.len()).zip(z) {
        row.iter_mut().zip(z).for_each(|(h, z_j)| *h += z_i * z_j);
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> System<'_, G, D, P> {
    /// Whether neutral motions are known; the current tangent has their stiffness.
    pub(super) fn has_neutral(&self) -> bool {
        self.is_projected() && !self.neutral.is_empty()
    }

    /// Follows the neutral motions known to the state whose tangent was evaluated last.
    pub(super) fn follow_neutral(&mut self) {
        let size = max_norm(&self.residual);
        if let Some(matrix) = self.factor.projected_mut() {
            matrix.follow_neutral(&mut self.neutral, size);
        }
    }

    /// Whether a motion without stiffness at the equilibrium in `start`, from which the branch has this velocity, goes
    /// with the load as it changes at `rate` over `h`: the load drives it, or makes it unstable. Forgets neutral motions,
    /// and overwrites state, load and factor.
    pub(super) fn is_adrift(&mut self, start: &[f64], velocity: &[f64], rate: &[f64], h: f64) -> bool {
        self.neutral.forget();
        self.set_state(start);
        self.evaluate();
        self.evaluate_tangent();
        let modes = self.motions_without_stiffness();
        let mut change = vec![0.0; start.len()];
        self.load_gradient(rate, &mut change);
        let size = norm(&change);
        modes.iter().any(|z| dot(z, &change).abs() > DRIVEN * size) || {
            // A motion that keeps the energy has no stiffness ahead, either, but that of the residual.
            let mut step: Vec<f64> = velocity.iter().map(|v| h * v).collect();
            for z in &modes {
                let along = dot(z, &step);
                step.iter_mut().zip(z).for_each(|(s, z)| *s -= along * z);
            }
            let load = self.load().to_vec();
            self.set_load_between(&load, rate, h);
            self.advance(&step);
            let least = OF_RESIDUAL * self.evaluate() + ZERO_EIGENVALUE;
            self.evaluate_tangent();
            let tangent = self.scaled_tangent();
            modes.iter().any(|z| stiffness(&tangent, z) < -least)
        }
    }

    /// Orthonormal null vectors of the tangent evaluated last, on the motions that ties allow.
    fn motions_without_stiffness(&mut self) -> Vec<Vec<f64>> {
        let (matrix, n) = match self.factor.projected() {
            Some(projected) => (projected.free.clone(), projected.ones.len()),
            None => (self.scaled_tangent(), self.state().len()),
        };
        let found = DMatrix::from_row_slice(n, n, &matrix).symmetric_eigen();
        let values = found.eigenvalues.iter().zip(found.eigenvectors.column_iter());
        let null = values.filter(|(value, _)| value.abs() <= DRIFT_EIGENVALUE);
        let mut modes: Vec<Vec<f64>> = null.map(|(_, z)| z.iter().copied().collect()).collect();
        if let Some(projected) = self.factor.projected() {
            modes.iter_mut().for_each(|z| projected.turn_back(z));
        }
        modes
    }

    /// Looks for neutral motions at the equilibrium evaluated last, with its tangent, as the load changes at this
    /// rate. Whether there are new ones; then the factor is that with their stiffness.
    pub(super) fn find_neutral(&mut self, rate: &[f64]) -> bool {
        if !self.is_projected() || self.has_friction() || !self.is_conservative() {
            return false;
        }
        let mut gradient = vec![0.0; self.state().len()];
        self.load_gradient(rate, &mut gradient);
        let size = max_norm(&self.residual);
        let Some(matrix) = self.factor.projected_mut() else { return false };
        let found = matrix.find_neutral(&mut self.neutral, size, &gradient);
        if found {
            self.factorise(0.0);
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix with stiffness 2 except along `z`, where it is `soft`.
    fn matrix(z: &[f64], soft: f64) -> Vec<f64> {
        let n = z.len();
        let entry = |m: usize| {
            let unit = if m % (n + 1) == 0 { 2.0 } else { 0.0 };
            unit - (2.0 - soft) * z[m / n] * z[m % n]
        };
        (0..n * n).map(entry).collect()
    }

    #[test]
    fn a_neutral_motion_is_found_followed_and_forgotten_once_it_is_stiff() {
        let mut motions = NeutralMotions::default();
        let rates = [0.8, -0.6, 0.0];
        let mut found = matrix(&[0.6, 0.8, 0.0], 1e-12);
        assert!(motions.find(&mut found, 1e-10, &rates, 0));
        assert!((stiffness(&found, &[0.6, 0.8, 0.0]) - 1.0).abs() < 1e-9);
        assert!(!motions.find(&mut found, 1e-10, &rates, 0));
        let turned = [0.6, 0.48, 0.64];
        let mut next = matrix(&turned, 1e-4);
        motions.follow(&mut next, 1e-3);
        assert!(dot(&motions.directions[0], &turned).abs() > 1.0 - 1e-6);
        assert!((stiffness(&next, &turned) - 1.0).abs() < 1e-3);
        motions.follow(&mut matrix(&turned, 1e-4), 1e-7);
        assert!(motions.is_empty());
    }

    #[test]
    fn a_soft_motion_that_the_load_drives_is_not_neutral() {
        let z = [0.6, 0.8, 0.0];
        assert!(!NeutralMotions::default().find(&mut matrix(&z, 1e-12), 1e-10, &[1.0, 0.0, 0.0], 0));
    }
}
