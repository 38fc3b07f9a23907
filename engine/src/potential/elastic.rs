//! Elasticity of rods: ½ qᵀ K q, with K from the section stiffness by Gauss quadrature.

use super::CoordinateTerms;
use crate::design::Design;
use crate::lie::LieGroup;
use crate::model::Model;

pub(crate) fn add<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    q: &[f64],
    out: &mut CoordinateTerms,
) {
    let mut energy = 0.0;
    for (&(i, j), &k) in model.stiffness_pattern.iter().zip(&design.stiffness) {
        out.gradient[i] += k * q[j];
        if i == j {
            energy += 0.5 * k * q[i] * q[i];
        } else {
            energy += k * q[i] * q[j];
            out.gradient[j] += k * q[i];
        }
    }
    out.energy += energy;
}

pub(crate) fn add_tangent<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    out: &mut CoordinateTerms,
) {
    let n = model.dof;
    for (&(i, j), &k) in model.stiffness_pattern.iter().zip(&design.stiffness) {
        out.half_tangent[j * n + i] += if i == j { 0.5 * k } else { k };
    }
}
