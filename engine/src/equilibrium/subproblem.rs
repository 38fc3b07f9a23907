//! The trust-region subproblem: minimise gᵀp + ½ pᵀHp over ‖p‖ ≤ Δ (Moré and Sorensen, 1983).

use super::solver::{Solver, dot, norm};
use crate::lie::LieGroup;
use crate::model::Model;

/// Factorisations allowed for one step.
const ATTEMPTS: usize = 30;
/// A step is long enough if it lacks no more than this share of the radius.
const SLACK: f64 = 0.25;
/// The first multiplier tried with an indefinite tangent, as a share of its upper bound.
const FIRST: f64 = 1e-2;

/// A step of the trust region.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrustStep {
    /// Decrease of the quadratic model, in units of the reference energy.
    pub decrease: f64,
    /// Whether the tangent was positive definite.
    pub definite: bool,
    /// Whether this is Newton's step, with a positive definite tangent, whose factor is at hand.
    pub inside: bool,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Solver<G, D, P> {
    /// Leaves the step in `self.step`; `None` where none is found.
    pub(super) fn trust_region_step(&mut self, model: &Model<G, D, P>, radius: f64) -> Option<TrustStep> {
        let definite = self.factorise(0.0);
        if definite {
            self.newton_step();
            if norm(&self.step) <= radius {
                // Here H p = −g.
                let decrease = -0.5 * dot(&self.residual, &self.step);
                return Some(TrustStep { decrease, definite, inside: true });
            }
        }
        // The multiplier λ lies between these bounds, with H + λ positive definite and ‖p(λ)‖ = Δ.
        let (lowest_diagonal, size) = self.tangent_bounds(model);
        let steepest = norm(&self.residual) / radius;
        let mut low = if definite { 0.0 } else { (-lowest_diagonal).max(0.0) };
        let mut high = steepest + size;
        let mut shift = if definite { self.secular_update(0.0, radius) } else { (FIRST * high).max(low) };
        let mut best = None;
        for _ in 0..ATTEMPTS {
            if !(shift > low && shift < high) {
                shift = (low * high).sqrt().max(low + 0.01 * (high - low));
            }
            if !self.factorise(shift) {
                low = low.max(shift);
                shift = 0.0;
                continue;
            }
            self.newton_step();
            let length = norm(&self.step);
            if !length.is_finite() {
                return None;
            }
            if (length - radius).abs() <= SLACK * radius {
                best = Some(shift);
                break;
            }
            if length < radius {
                if !definite && high - low < 1e-3 * high {
                    self.add_negative_curvature(radius);
                    self.data.complete_tangent(model);
                    let decrease = self.model_decrease();
                    return Some(TrustStep { decrease, definite, inside: false });
                }
                high = shift;
                best = Some(shift);
            } else {
                low = low.max(shift);
            }
            shift = self.secular_update(shift, radius);
        }
        let shift = best?;
        // Here (H + λ) p = −g; of p only this part is taken.
        let length = norm(&self.step);
        let part = (radius / length).min(1.0);
        let linear = dot(&self.residual, &self.step);
        let quadratic = -linear - shift * length * length;
        self.step.iter_mut().for_each(|s| *s *= part);
        let decrease = -part * (linear + 0.5 * part * quadratic);
        Some(TrustStep { decrease, definite, inside: false })
    }

    /// Newton's step for 1/‖p(λ)‖ = 1/Δ.
    fn secular_update(&mut self, shift: f64, radius: f64) -> f64 {
        self.work.copy_from_slice(&self.step);
        self.factor.solve_lower(&mut self.work);
        let (p, w) = (norm(&self.step), norm(&self.work));
        shift + (p / w).powi(2) * (p - radius) / radius
    }

    /// −(gᵀp + ½ pᵀHp), by a product with the tangent.
    fn model_decrease(&mut self) -> f64 {
        let n = self.step.len();
        let tangent = self.data.tangent();
        let unit_energy = self.data.design.reference_stiffness;
        for (w, (s, u)) in self.work.iter_mut().zip(self.step.iter().zip(&self.unit)) {
            *w = s * u;
        }
        let mut quadratic = 0.0;
        for i in 0..n {
            quadratic += dot(&tangent[i * n..(i + 1) * n], &self.work) * self.work[i];
        }
        let linear = dot(&self.residual, &self.step);
        -(linear + 0.5 * quadratic / unit_energy)
    }

    /// Smallest diagonal entry of the dimensionless tangent, and a bound to its eigenvalues: the largest
    /// absolute row sum, or for a chain Frobenius' norm.
    fn tangent_bounds(&self, model: &Model<G, D, P>) -> (f64, f64) {
        let n = self.step.len();
        let (tangent, scale) = (self.data.tangent(), &self.data.design.scale);
        let diagonal = (0..n).map(|i| tangent[i * n + i] * scale[i] * scale[i]);
        let lowest = diagonal.fold(f64::INFINITY, f64::min);
        let row_sum = |i: usize| {
            let row = &tangent[i * n..(i + 1) * n];
            row.iter().zip(scale).map(|(h, s)| (h * s).abs()).sum::<f64>() * scale[i]
        };
        let norm = self.data.assembly.chain_norm(model, scale);
        (lowest, norm.unwrap_or_else(|| (0..n).map(row_sum).fold(0.0, f64::max)))
    }

    /// The hard case: follows the eigenvector of the lowest eigenvalue to the boundary.
    fn add_negative_curvature(&mut self, radius: f64) {
        // Inverse iteration with the nearly singular factor; the start is fixed, so the sign is too.
        for (i, w) in self.work.iter_mut().enumerate() {
            *w = 1.0 + 0.1 * ((i + 1) as f64).sin();
        }
        for _ in 0..4 {
            let length = norm(&self.work);
            self.work.iter_mut().for_each(|w| *w /= length);
            self.factor.solve(&mut self.work);
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
