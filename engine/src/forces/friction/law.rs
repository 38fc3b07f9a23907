//! Coulomb friction of one point for one step of the load: a spring that carries no more than a limit.
//!
//! The potential is Huber's, ½ k |s|² up to the elastic slip |s| = F/k and F |s| − F²/2k beyond, with the
//! stiffness k and the limit F = μN held. It is convex and its gradient continuous; beyond the limit the
//! force is F along s. What lies beyond, F (|s| − F/k), is dissipated at the end of the step, when the
//! elastic slip is set back to the limit.

use crate::linalg::{Matrix, Vector};

/// The law of a point with this stiffness k [N/m] and limit F [N].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Law {
    pub stiffness: f64,
    pub limit: f64,
}

impl Law {
    /// Whether the force at this slip is the limit.
    #[inline]
    pub fn slides(&self, slip: f64) -> bool {
        self.stiffness * slip > self.limit
    }

    /// The potential [J].
    #[inline]
    pub fn energy(&self, slip: f64) -> f64 {
        self.elastic_energy(slip) + self.dissipation(slip)
    }

    /// The part of it that is stored.
    #[inline]
    pub fn elastic_energy(&self, slip: f64) -> f64 {
        let elastic = if self.slides(slip) { self.limit / self.stiffness } else { slip };
        0.5 * self.stiffness * elastic * elastic
    }

    /// The part of it that is dissipated as the step ends.
    #[inline]
    pub fn dissipation(&self, slip: f64) -> f64 {
        if self.slides(slip) { self.limit * (slip - self.limit / self.stiffness) } else { 0.0 }
    }

    /// Ratio of the force to the slip, the stiffness across the slip.
    #[inline]
    pub fn secant(&self, slip: f64) -> f64 {
        if self.slides(slip) { self.limit / slip } else { self.stiffness }
    }

    /// Hessian for a slip in the plane across a unit normal.
    pub fn hessian<const P: usize>(&self, slip: &Vector<P>, normal: &Vector<P>) -> Matrix<P, P> {
        let size = slip.norm();
        let plane = Matrix::diagonal(1.0) - normal.outer(normal);
        if self.slides(size) {
            let along = *slip * (1.0 / size);
            (plane - along.outer(&along)) * self.secant(size)
        } else {
            plane * self.stiffness
        }
    }

    /// The part of the slip that is elastic. `excess` relative to the limit decides on which side of it the
    /// rounded result is.
    pub fn returned<const P: usize>(&self, slip: Vector<P>, excess: f64) -> Vector<P> {
        let size = slip.norm();
        if self.slides(size) { slip * (self.limit / (self.stiffness * size) * (1.0 + excess)) } else { slip }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: Law = Law { stiffness: 700.0, limit: 1.3 };

    #[test]
    fn derivatives_are_those_of_the_potential() {
        let normal = Vector([0.6, 0.0, 0.8]);
        let basis = [Vector([0.8, 0.0, -0.6]), Vector([0.0, 1.0, 0.0])];
        for size in [3e-4, 1.7e-3, 2.1e-3, 9e-3] {
            let at = |a: f64, b: f64| basis[0] * (0.6 * size + a) + basis[1] * (0.8 * size + b);
            let slip = at(0.0, 0.0);
            let h = 1e-3 * size;
            let energy = |a: f64, b: f64| LAW.energy(at(a, b).norm());
            let force = |a: f64, b: f64| at(a, b) * LAW.secant(at(a, b).norm());
            let slopes = [(energy(h, 0.0) - energy(-h, 0.0)), (energy(0.0, h) - energy(0.0, -h))];
            let hessian = LAW.hessian(&slip, &normal);
            assert!((hessian * normal).norm() < 1e-12 * LAW.stiffness);
            for (i, axis) in basis.iter().enumerate() {
                assert!((slopes[i] / (2.0 * h) - force(0.0, 0.0).dot(axis)).abs() < 1e-5 * LAW.limit);
                let ends = [1.0, -1.0].map(|sign| {
                    let step = [0, 1].map(|j| if j == i { sign * h } else { 0.0 });
                    force(step[0], step[1])
                });
                let change = (ends[0] - ends[1]) * (1.0 / (2.0 * h));
                assert!((change - hessian * *axis).norm() < 1e-5 * LAW.stiffness, "{size}");
            }
        }
    }

    #[test]
    fn a_step_stores_or_dissipates_its_potential() {
        for size in [1e-3, 1.85e-3, 1.86e-3, 5e-3] {
            let slip = Vector([0.6 * size, 0.8 * size]);
            let kept = LAW.returned(slip, 0.0);
            let stored = 0.5 * LAW.stiffness * kept.dot(&kept);
            assert!((LAW.energy(size) - stored - LAW.dissipation(size)).abs() < 1e-15);
            assert!(LAW.dissipation(size) >= 0.0);
            // The force does not change as the slip is set back.
            let before = slip * LAW.secant(size);
            assert!((before - kept * LAW.secant(kept.norm())).norm() < 1e-12);
        }
    }
}
