//! Gravity on the masses of rods (at Gauss points) and links (at centroids): −m g·r.

use super::FrameTerms;
use crate::design::Design;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::Model;

pub(crate) fn add<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    points: &[Vector<P>],
    out: &mut FrameTerms<D, P>,
) {
    for (mass, m) in model.masses.iter().zip(&design.masses) {
        let p = &points[mass.point()];
        let weight = model.gravity * -*m;
        out.energy += weight.dot(p);
        out.add_force::<G>(model.points[mass.point()].frame, p, &weight);
    }
}

pub(crate) fn add_tangent<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    points: &[Vector<P>],
    out: &mut FrameTerms<D, P>,
) {
    for (mass, m) in model.masses.iter().zip(&design.masses) {
        let point = mass.point();
        out.add_curvature::<G>(model.points[point].frame, &points[point], &(model.gravity * -*m));
    }
}
