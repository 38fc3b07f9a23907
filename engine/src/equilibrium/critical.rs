//! Loads at which a branch loses stability, from the lowest eigenvalue of the tangent.
//!
//! Let φ be the eigenvector of the lowest eigenvalue μ and b the direction of the load. If b has a
//! component along φ, the velocity φᵀb/μ is unbounded and the branch turns back at a limit point; otherwise
//! another branch crosses. Along the branch dμ/dλ = A/μ + B, where A/μ is due to the motion along φ and B
//! to all other motion: μ² is linear in the load towards a limit point, μ towards a bifurcation, and μ
//! vanishes after ∫ μ dμ/(−A − Bμ).

use super::options::CriticalOptions;
use super::system::System;
use super::vector::{dot, norm};
use crate::lie::LieGroup;
use crate::tolerances::ZERO_EIGENVALUE;

/// The search for critical points, with its memory.
#[derive(Clone, Debug)]
pub(super) struct CriticalSearch {
    options: CriticalOptions,
    mode: Vec<f64>,
    left: Vec<f64>,
    load: Vec<f64>,
    step: Vec<f64>,
    work: Vec<f64>,
}

impl CriticalSearch {
    pub fn new(options: CriticalOptions, dof: usize) -> Self {
        let zeros = || vec![0.0; dof];
        Self { options, mode: zeros(), left: zeros(), load: zeros(), step: zeros(), work: zeros() }
    }

    /// Distance from the current equilibrium to the loss of stability as the load changes at `rate` over
    /// `h`; `None` where there is none, zero where it is lost already. Overwrites state and load.
    pub fn find<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        velocity: &[f64],
        rate: &[f64],
        h: f64,
    ) -> Option<f64> {
        system.evaluate();
        system.evaluate_tangent();
        // Between the listed loads the state is approximate.
        if system.factorise(0.0) && !system.is_singular() {
            for _ in 0..self.options.refinements {
                system.newton_step(&mut self.step);
                system.advance(&self.step);
                system.evaluate();
            }
            system.evaluate_tangent();
        }
        let (start, load) = (system.state().to_vec(), system.load().to_vec());
        system.load_gradient(rate, &mut self.load);
        let tied = system.is_projected();
        self.mode.fill(0.0);
        let definite = system.factorise(0.0) || system.factorise(ZERO_EIGENVALUE);
        if !definite || system.is_singular() {
            return Some(0.0);
        }
        let lowest = self.find_mode(system)?;
        if lowest.abs() <= ZERO_EIGENVALUE {
            return Some(0.0);
        }
        let small = (self.options.difference / norm(velocity)).min(self.options.step_share * h);
        let tangent_after = |step: &[f64], change: f64, load_change: f64, system: &mut System<G, D, P>| {
            system.set_load_between(&load, rate, load_change);
            system.advance_from(&start, step, change);
            system.evaluate();
            system.evaluate_tangent();
            system.scaled_tangent()
        };
        // A central difference: a straight step violates a stiff constraint to second order.
        let rate_of_tangent = |step: &[f64], change: f64, load_change: f64, system: &mut System<G, D, P>| {
            let [mut ahead, behind] =
                [1.0, -1.0].map(|sign| tangent_after(step, sign * change, sign * load_change, system));
            ahead.iter_mut().zip(behind).for_each(|(a, b)| *a = (*a - b) / (2.0 * change));
            ahead
        };
        let tangent = system.scaled_tangent();
        if tied {
            // The force on the free motions, with that of the motion which ties prescribe: −H velocity.
            for (b, row) in self.load.iter_mut().zip(tangent.chunks(velocity.len())) {
                *b = -dot(row, velocity);
            }
        }
        let change = rate_of_tangent(velocity, small, small, system);
        // Far from it the lowest eigenvalue may be one of many, and not the first to vanish.
        let fall = -form(&self.left, &change, &self.mode) / dot(&self.left, &self.mode);
        if !(lowest < 4.0 * h * fall) {
            self.find_first_to_vanish(system, &change);
        }
        let scale = dot(&self.left, &self.mode);
        let eigenvalue = form(&self.left, &tangent, &self.mode) / scale;
        let total = form(&self.left, &change, &self.mode) / scale;
        let along = dot(&self.left, &self.load) / dot(&self.left, &self.mode);
        let share = dot(&self.left, &self.load).abs() / (norm(&self.left) * norm(&self.load));
        // Component along the mode of the motion over an infinitesimal change of load.
        let part = -along / eigenvalue;
        self.step.iter_mut().zip(&self.mode).for_each(|(s, m)| *s = part * m);
        let by_mode = if share > 1e-12 {
            let small = self.options.difference / norm(&self.step).max(f64::MIN_POSITIVE);
            form(&self.left, &rate_of_tangent(&self.step, small, 0.0, system), &self.mode) / scale
        } else {
            0.0
        };
        distance(eigenvalue, by_mode * eigenvalue, total - by_mode)
    }

    /// The mode along which stability is lost, normalised; zero where it was lost already.
    pub fn mode(&self) -> &[f64] {
        &self.mode
    }

    /// Replaces the mode of the lowest eigenvalue by that of the eigenvalue which vanishes first, by power
    /// iteration with −H⁻¹ dH/dλ and the current factor; if no eigenvalue decreases, the mode is kept.
    fn find_first_to_vanish<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &System<G, D, P>,
        change: &[f64],
    ) {
        let n = self.mode.len();
        let (mode, left) = (self.mode.clone(), self.left.clone());
        let mut inverse_distance = 0.0;
        for _ in 0..self.options.power_iterations {
            for i in 0..n {
                self.work[i] = -dot(&change[i * n..(i + 1) * n], &self.mode);
            }
            system.keep_free(&mut self.work);
            system.solve(&mut self.work);
            inverse_distance = dot(&self.mode, &self.work);
            let length = norm(&self.work);
            self.mode.iter_mut().zip(&self.work).for_each(|(m, w)| *m = w / length);
            if !system.is_conservative() {
                self.work.fill(0.0);
                for (row, l) in change.chunks(n).zip(&self.left) {
                    self.work.iter_mut().zip(row).for_each(|(w, c)| *w -= c * l);
                }
                system.keep_free(&mut self.work);
                system.solve_transposed_dimensionless(&mut self.work);
                let length = norm(&self.work);
                self.left.iter_mut().zip(&self.work).for_each(|(m, w)| *m = w / length);
            }
        }
        if !(inverse_distance > 0.0 && inverse_distance.is_finite()) {
            self.mode = mode;
            self.left = left;
        } else if system.is_conservative() {
            self.left.copy_from_slice(&self.mode);
        }
    }

    /// The lowest eigenvalue and its right and left eigenvectors, by inverse iteration with the factor at
    /// hand.
    fn find_mode<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &System<G, D, P>,
    ) -> Option<f64> {
        for (i, (m, l)) in self.mode.iter_mut().zip(&mut self.left).enumerate() {
            *m = 1.0 + 0.3 * ((i + 1) as f64 * 1.7).sin();
            *l = *m;
        }
        system.keep_free(&mut self.mode);
        system.keep_free(&mut self.left);
        let mut eigenvalue = f64::NAN;
        for _ in 0..self.options.inverse_iterations {
            let length = norm(&self.mode);
            self.mode.iter_mut().for_each(|m| *m /= length);
            self.work.copy_from_slice(&self.mode);
            system.solve(&mut self.mode);
            eigenvalue = 1.0 / dot(&self.work, &self.mode);
            if !system.is_conservative() {
                let length = norm(&self.left);
                self.left.iter_mut().for_each(|m| *m /= length);
                system.solve_transposed_dimensionless(&mut self.left);
            }
        }
        let length = norm(&self.mode);
        self.mode.iter_mut().for_each(|m| *m /= length);
        if system.is_conservative() {
            self.left.copy_from_slice(&self.mode);
        }
        eigenvalue.is_finite().then_some(eigenvalue)
    }
}

/// aᵀ M b.
fn form(a: &[f64], matrix: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(matrix.chunks(b.len())).map(|(a, row)| a * dot(row, b)).sum()
}

/// Distance after which μ vanishes if it changes at the rate a/μ + b; `None` if it does not.
fn distance(eigenvalue: f64, a: f64, b: f64) -> Option<f64> {
    // Intervals of the midpoint rule.
    const PIECES: usize = 32;
    let width = eigenvalue / PIECES as f64;
    let mut sum = 0.0;
    for k in 0..PIECES {
        let mu = (k as f64 + 0.5) * width;
        let rate = a + b * mu;
        if !(rate < 0.0) {
            return None;
        }
        sum -= mu * width / rate;
    }
    sum.is_finite().then_some(sum)
}

#[cfg(test)]
mod tests {
    use super::distance;

    #[test]
    fn a_fold_is_twice_as_near_as_a_bifurcation_of_the_same_slope() {
        assert!((distance(0.3, -0.3 * 2.0, 0.0).unwrap() - 0.075).abs() < 1e-12);
        assert!((distance(0.3, 0.0, -2.0).unwrap() - 0.15).abs() < 1e-12);
        assert_eq!(distance(0.3, 0.0, 1.0), None);
    }
}
