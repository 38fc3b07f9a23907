//! Elasticity and limits of joints.
//!
//! Beyond a limit by `s`, the limit's stiffness builds up linearly over the width `w` and is then
//! constant: V = k s³/(6w) for s ≤ w, k (s²/2 − w s/2 + w²/6) beyond. V is twice continuously
//! differentiable, so Newton sees no jump in the tangent.

use super::CoordinateTerms;
use crate::design::Design;
use crate::lie::LieGroup;
use crate::model::{Joint, Model};

pub(crate) fn add<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    q: &[f64],
    out: &mut CoordinateTerms,
) {
    for coordinate in &model.joints {
        let (i, joint) = (coordinate.dof, &coordinate.joint);
        let k = design.parameters[coordinate.stiffness];
        let x = q[i] - joint.rest;
        let (energy, slope, _) = limit(joint, q[i]);
        out.energy += 0.5 * k * x * x + energy;
        out.gradient[i] += k * x + slope;
    }
}

pub(crate) fn add_tangent<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    q: &[f64],
    out: &mut CoordinateTerms,
) {
    for coordinate in &model.joints {
        let (_, _, curvature) = limit(&coordinate.joint, q[coordinate.dof]);
        out.add_diagonal(coordinate.dof, design.parameters[coordinate.stiffness] + curvature);
    }
}

/// Energy of the limits, its slope and its curvature.
fn limit(joint: &Joint, q: f64) -> (f64, f64, f64) {
    let (s, sign) = match (joint.lower, joint.upper) {
        (Some(lower), _) if q < lower => (lower - q, -1.0),
        (_, Some(upper)) if q > upper => (q - upper, 1.0),
        _ => return (0.0, 0.0, 0.0),
    };
    let (k, w) = (joint.limit_stiffness, joint.limit_width);
    if s <= w {
        (k * s.powi(3) / (6.0 * w), sign * k * s * s / (2.0 * w), k * s / w)
    } else {
        (k * (0.5 * s * s - 0.5 * w * s + w * w / 6.0), sign * k * (s - 0.5 * w), k)
    }
}
