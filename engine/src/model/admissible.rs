//! Which vectors of parameters make physical sense.

use super::{Model, Shape};
use crate::lie::LieGroup;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Model<G, D, P> {
    /// Whether all parameters are finite, lengths, radii and moduli positive, and stiffnesses and
    /// densities not negative.
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
        });
        let links = self.bodies.iter().all(|b| match &b.shape {
            Shape::Rod(_) => true,
            Shape::Link(l) => {
                [l.length, l.radius_base, l.radius_tip].iter().all(|i| p[*i] > 0.0) && p[l.density] >= 0.0
            }
        });
        let joints = self.joints.iter().map(|j| j.stiffness);
        let contacts = self.contacts.iter().map(|c| c.stiffness);
        let springs = self.springs.iter().flat_map(|s| [s.stiffness, s.rest_length]);
        rods && links && joints.chain(contacts).chain(springs).all(|i| p[i] >= 0.0)
    }
}
