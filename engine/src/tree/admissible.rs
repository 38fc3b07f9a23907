//! Admissibility of the parameters of bodies.

use super::{Shape, Tree};
use crate::lie::LieGroup;
use crate::tolerances::MAX_PLACEMENT_ROTATION;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Tree<G, D, P> {
    /// Whether all parameters are finite and those of the bodies admissible.
    pub fn is_admissible(&self, parameters: &[f64]) -> bool {
        let p = parameters;
        if p.len() != self.parameters.len() || !p.iter().all(|x| x.is_finite()) {
            return false;
        }
        let rods = self.rods.iter().all(|r| {
            let one = [r.length, r.young_modulus, r.shear_modulus];
            one.iter().all(|i| p[*i] > 0.0)
                && p[r.radius.clone()].iter().all(|s| *s > 0.0)
                && p[r.density] >= 0.0
                && r.factors.is_none_or(|factors| p[factors..factors + 4].iter().all(|x| *x > 0.0))
        });
        let links = self.bodies.iter().all(|b| match &b.shape {
            Shape::Rod(_) => true,
            Shape::Link(l) => {
                [l.length, l.radius_base, l.radius_tip].iter().all(|i| p[*i] > 0.0) && p[l.density] >= 0.0
            }
        });
        let placements = self
            .bodies
            .iter()
            .all(|b| p[b.rotation.clone()].iter().all(|angle| angle.abs() <= MAX_PLACEMENT_ROTATION));
        let joints = self.joints.iter().all(|j| {
            let limits = j.limits.is_none_or(|limits| {
                let ends = limits.lower.zip(limits.upper);
                p[limits.stiffness] > 0.0
                    && p[limits.width] > 0.0
                    && ends.is_none_or(|(lower, upper)| p[lower] < p[upper])
            });
            p[j.stiffness] >= 0.0 && limits
        });
        rods && links && placements && joints
    }
}
