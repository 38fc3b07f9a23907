//! Elasticity and limits of joints.
//!
//! Beyond a limit by `s`, the limit's stiffness builds up linearly over the width `w` and is then
//! constant: V = k s³/(6w) for s ≤ w, k (s²/2 − w s/2 + w²/6) beyond. Far beyond, by d more than ten
//! widths, it stiffens again by k d⁴/(12 w²), so that no load passes a limit by much. V is twice
//! continuously differentiable, so Newton sees no jump in the tangent, and a limit is no switch.

use super::element::{ForceElement, ForceMemory, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::state::State;
use super::terms::Terms;
use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::tree::{Joint, JointCoordinate, Tree};

/// Springs and limits of all joints of the tree.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Joints;

impl<const P: usize> ForceMemory<P> for Joints {
    type Design = ();
    type State = ();
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Joints {
    fn design(&self, _: &Tree<G, D, P>) {}

    fn state(&self, _: &Tree<G, D, P>) {}

    fn add_elastic_stiffness(
        &self,
        tree: &Tree<G, D, P>,
        geometry: &Geometry<G, D, P>,
        _: &(),
        stiffness: &mut [f64],
    ) {
        for joint in &tree.joints {
            stiffness[joint.dof] += geometry.parameters[joint.stiffness];
        }
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        _: &(),
        _: &mut (),
        Terms { coordinates: out, .. }: &mut Terms<D>,
    ) {
        for coordinate in &at.tree.joints {
            let (i, joint) = (coordinate.dof, &coordinate.joint);
            let k = at.parameters()[coordinate.stiffness];
            let x = at.q[i] - joint.rest;
            let (energy, slope, _) = limit(joint, at.q[i]);
            out.energy += 0.5 * k * x * x + energy;
            out.gradient[i] += k * x + slope;
        }
    }

    fn add_tangent(&self, at: &State<G, D, P>, _: &(), _: &(), out: &mut Terms<D>) {
        for coordinate in &at.tree.joints {
            let (_, _, curvature) = limit(&coordinate.joint, at.q[coordinate.dof]);
            out.coordinates.add_diagonal(coordinate.dof, at.parameters()[coordinate.stiffness] + curvature);
        }
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, _: &(), _: &(), out: &mut Magnitudes<P>) {
        for JointCoordinate { dof, joint, stiffness } in &at.tree.joints {
            out.add(*dof, at.parameters()[*stiffness] * (at.q[*dof] - joint.rest));
            out.add(*dof, limit(joint, at.q[*dof]).1);
        }
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        _: &(),
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        for joint in &at.tree.joints {
            gradient[joint.stiffness] += (at.q[joint.dof] - joint.joint.rest) * motion.coordinates[joint.dof];
        }
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
        let far = (s - STIFFENING_WIDTHS * w).max(0.0) / w;
        let energy = k * (0.5 * s * s - 0.5 * w * s + w * w / 6.0) + k * w * w * far.powi(4) / 12.0;
        let slope = k * (s - 0.5 * w) + k * w * far.powi(3) / 3.0;
        (energy, sign * slope, k + k * far * far)
    }
}

/// Widths beyond a limit after which it stiffens again.
const STIFFENING_WIDTHS: f64 = 10.0;
