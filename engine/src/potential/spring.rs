//! Springs and straps between two points: ½ k (‖r‖ − ℓ₀)².

use super::FrameTerms;
use crate::design::Design;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::Model;

pub(crate) fn add<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    points: &[Vector<P>],
    out: &mut FrameTerms<D>,
) {
    for spring in &model.springs {
        let k = design.parameters[spring.stiffness];
        let rest = design.parameters[spring.rest_length];
        let [a, b] = spring.ends;
        let r = points[a] - points[b];
        let length = r.norm();
        let stretch = length - rest;
        if spring.slack && stretch <= 0.0 {
            continue;
        }
        out.energy += 0.5 * k * stretch * stretch;
        let frames = [model.points[a].frame, model.points[b].frame];
        let ends = [&points[a], &points[b]];
        if rest == 0.0 || length < 1e-12 * rest {
            // Isotropic: no direction is singled out (or none is defined).
            out.add_pair::<G, P>(frames, ends, &(r * k), &Vector::unit(0), k, k);
        } else {
            let n = r * (1.0 / length);
            out.add_pair::<G, P>(frames, ends, &(n * (k * stretch)), &n, k, k * stretch / length);
        }
    }
}
