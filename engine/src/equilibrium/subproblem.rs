//! The trust-region subproblem: minimise gᵀp + ½ pᵀHp over ‖p‖ ≤ Δ (Moré and Sorensen, 1983).

use super::options::TrustRegionOptions;
use super::system::System;
use super::vector::{dot, norm};
use crate::lie::LieGroup;

/// Properties of a trust-region step.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrustStep {
    /// Decrease of the quadratic model, in units of the reference energy.
    pub decrease: f64,
    /// Whether the tangent was positive definite.
    pub definite: bool,
    /// Whether this is the Newton step of a positive definite tangent, whose factor is current.
    pub newton: bool,
    /// Whether a force acts along a free motion.
    pub free: bool,
    /// Ratio of the step to −(H + `shift`)⁻¹ g, where the current factor is that of H + `shift`.
    pub part: f64,
    pub shift: f64,
}

/// Solves the subproblem.
#[derive(Clone, Debug)]
pub(super) struct Subproblem {
    options: TrustRegionOptions,
    /// The step found last, dimensionless.
    pub step: Vec<f64>,
    work: Vec<f64>,
}

impl Subproblem {
    pub fn new(options: TrustRegionOptions, dof: usize) -> Self {
        Self { options, step: vec![0.0; dof], work: vec![0.0; dof] }
    }

    /// Leaves the step in `self.step`; `None` where none is found.
    pub fn solve<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        radius: f64,
        tolerance: f64,
    ) -> Option<TrustStep> {
        let mut definite = system.factorise(0.0);
        let free = definite && system.pulls_free_motion(tolerance);
        definite &= !free;
        if free {
            system.note_free_motion();
        }
        if definite {
            system.newton_step(&mut self.step);
            if norm(&self.step) <= radius {
                // Here H p = −g.
                let decrease = -0.5 * dot(system.residual(), &self.step);
                return Some(TrustStep { decrease, definite, newton: true, free, part: 1.0, shift: 0.0 });
            }
        }
        // The multiplier λ lies between these bounds, with H + λ positive definite and ‖p(λ)‖ = Δ.
        let (lowest_diagonal, size) = system.tangent_bounds();
        let steepest = norm(system.residual()) / radius;
        let mut low = if definite { 0.0 } else { (-lowest_diagonal).max(0.0) };
        // Both bounds coincide for a diagonal tangent.
        let mut high = (steepest + size).max(low * (1.0 + 2.0 * self.options.hard_case_gap));
        let mut shift = if definite {
            self.secular_update(system, 0.0, radius)
        } else {
            (self.options.first_multiplier * high).max(low)
        };
        let mut best = None;
        for _ in 0..self.options.max_factorizations {
            if !(shift > low && shift < high) {
                shift = (low * high).sqrt().max(low + 0.01 * (high - low));
            }
            if !system.factorise(shift) {
                low = low.max(shift);
                shift = 0.0;
                continue;
            }
            system.newton_step(&mut self.step);
            let length = norm(&self.step);
            if !length.is_finite() {
                return None;
            }
            if (length - radius).abs() <= self.options.radius_slack * radius {
                best = Some(shift);
                break;
            }
            if length < radius {
                if !definite && high - low < self.options.hard_case_gap * high {
                    self.add_negative_curvature(system, radius);
                    system.complete_tangent();
                    let decrease = self.model_decrease(system);
                    return Some(TrustStep { decrease, definite, newton: false, free, part: 0.0, shift });
                }
                high = shift;
                best = Some(shift);
            } else {
                low = low.max(shift);
            }
            shift = self.secular_update(system, shift, radius);
        }
        let shift = best?;
        // Here (H + λ) p = −g; p is scaled back to the boundary.
        let length = norm(&self.step);
        let part = (radius / length).min(1.0);
        let linear = dot(system.residual(), &self.step);
        let quadratic = -linear - shift * length * length;
        self.step.iter_mut().for_each(|s| *s *= part);
        let decrease = -part * (linear + 0.5 * part * quadratic);
        Some(TrustStep { decrease, definite, newton: false, free, part, shift })
    }

    /// Newton's step for 1/‖p(λ)‖ = 1/Δ.
    fn secular_update<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &System<G, D, P>,
        shift: f64,
        radius: f64,
    ) -> f64 {
        self.work.copy_from_slice(&self.step);
        system.solve_lower(&mut self.work);
        let (p, w) = (norm(&self.step), norm(&self.work));
        shift + (p / w).powi(2) * (p - radius) / radius
    }

    /// −(gᵀp + ½ pᵀHp), by a product with the tangent.
    fn model_decrease<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &System<G, D, P>,
    ) -> f64 {
        let linear = dot(system.residual(), &self.step);
        -(linear + 0.5 * system.curvature_along(&self.step, &mut self.work))
    }

    /// The hard case: moves along the eigenvector of the lowest eigenvalue to the boundary.
    fn add_negative_curvature<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &System<G, D, P>,
        radius: f64,
    ) {
        // Inverse iteration with the nearly singular factor; the start is fixed, so the sign is too.
        for (i, w) in self.work.iter_mut().enumerate() {
            *w = 1.0 + 0.1 * ((i + 1) as f64).sin();
        }
        system.keep_free(&mut self.work);
        for _ in 0..self.options.inverse_iterations {
            let length = norm(&self.work);
            self.work.iter_mut().for_each(|w| *w /= length);
            system.solve(&mut self.work);
        }
        let length = norm(&self.work);
        self.work.iter_mut().for_each(|w| *w /= length);
        let along = dot(&self.step, &self.work);
        let short = norm(&self.step);
        let reach = ((along * along + radius * radius - short * short).max(0.0)).sqrt();
        let tau = if along >= 0.0 { reach - along } else { -reach - along };
        for (s, w) in self.step.iter_mut().zip(&self.work) {
            *s += tau * w;
        }
    }
}
