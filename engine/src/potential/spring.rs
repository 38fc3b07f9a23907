//! Springs and straps between two points: ½ k (‖r‖ − ℓ₀)².

use super::FrameTerms;
use crate::design::Design;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::{Model, Spring};

pub(crate) fn add<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    points: &[Vector<P>],
    out: &mut FrameTerms<D, P>,
) {
    for spring in &model.springs {
        let Some(pull) = pull(spring, design, points) else { continue };
        let [a, b] = spring.ends;
        out.energy += pull.energy;
        out.add_force::<G>(model.points[a].frame, &points[a], &pull.force);
        out.add_force::<G>(model.points[b].frame, &points[b], &-pull.force);
    }
}

pub(crate) fn add_tangent<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    points: &[Vector<P>],
    out: &mut FrameTerms<D, P>,
) {
    for spring in &model.springs {
        let Some(Pull { force, direction, hessian, .. }) = pull(spring, design, points) else { continue };
        let frames = spring.ends.map(|end| model.points[end].frame);
        out.add_pair::<G>(frames, spring.ends.map(|end| &points[end]), &force, &direction, hessian);
    }
}

/// A taut spring.
struct Pull<const P: usize> {
    energy: f64,
    /// On its second end.
    force: Vector<P>,
    direction: Vector<P>,
    /// Second derivatives along and across it.
    hessian: [f64; 2],
}

fn pull<G, const D: usize, const P: usize>(
    spring: &Spring,
    design: &Design<G, D, P>,
    points: &[Vector<P>],
) -> Option<Pull<P>> {
    let k = design.parameters[spring.stiffness];
    let rest = design.parameters[spring.rest_length];
    let [a, b] = spring.ends;
    let r = points[a] - points[b];
    let length = r.norm();
    let stretch = length - rest;
    if spring.slack && stretch <= 0.0 {
        return None;
    }
    let energy = 0.5 * k * stretch * stretch;
    Some(if rest == 0.0 || length < 1e-12 * rest {
        // Isotropic: no direction is singled out (or none is defined).
        Pull { energy, force: r * k, direction: Vector::unit(0), hessian: [k, k] }
    } else {
        let direction = r * (1.0 / length);
        let hessian = [k, k * stretch / length];
        Pull { energy, force: direction * (k * stretch), direction, hessian }
    })
}
