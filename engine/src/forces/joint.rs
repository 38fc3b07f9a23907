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
use crate::tree::{JointCoordinate, JointLimits, Tree};

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
        let p = at.parameters();
        for joint in &at.tree.joints {
            let (i, k) = (joint.dof, p[joint.stiffness]);
            let x = at.q[i] - p[joint.rest];
            let (mut energy, mut slope) = (0.0, 0.0);
            if let Some(beyond) = beyond(joint, at) {
                (energy, slope) = (beyond.energy(), beyond.slope());
            }
            out.energy += 0.5 * k * x * x + energy;
            out.gradient[i] += k * x + slope;
        }
    }

    fn add_tangent(&self, at: &State<G, D, P>, _: &(), _: &(), out: &mut Terms<D>) {
        for joint in &at.tree.joints {
            let curvature = beyond(joint, at).map_or(0.0, |beyond| beyond.curvature());
            out.coordinates.add_diagonal(joint.dof, at.parameters()[joint.stiffness] + curvature);
        }
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, _: &(), _: &(), out: &mut Magnitudes<P>) {
        let p = at.parameters();
        for joint in &at.tree.joints {
            out.add(joint.dof, p[joint.stiffness] * (at.q[joint.dof] - p[joint.rest]));
            out.add(joint.dof, beyond(joint, at).map_or(0.0, |beyond| beyond.slope()));
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
        let p = at.parameters();
        for joint in &at.tree.joints {
            let moved = motion.coordinates[joint.dof];
            gradient[joint.stiffness] += (at.q[joint.dof] - p[joint.rest]) * moved;
            gradient[joint.rest] -= p[joint.stiffness] * moved;
            if let Some((beyond, limits)) = beyond(joint, at).zip(joint.limits) {
                gradient[beyond.limit] -= beyond.curvature() * moved;
                gradient[limits.stiffness] += beyond.slope() / beyond.stiffness * moved;
                gradient[limits.width] += beyond.slope_by_width() * moved;
            }
        }
    }
}

/// How a coordinate is beyond one of its limits.
#[inline]
fn beyond<G: LieGroup<D, P>, const D: usize, const P: usize>(
    joint: &JointCoordinate,
    at: &State<G, D, P>,
) -> Option<Beyond> {
    joint.limits.as_ref().and_then(|limits| Beyond::of(limits, at.parameters(), at.q[joint.dof]))
}

/// A coordinate beyond a limit.
struct Beyond {
    /// Parameter holding the limit.
    limit: usize,
    /// Direction in which it is beyond.
    sign: f64,
    /// By how much.
    distance: f64,
    stiffness: f64,
    width: f64,
}

impl Beyond {
    /// None between the limits.
    #[inline]
    fn of(limits: &JointLimits, p: &[f64], q: f64) -> Option<Self> {
        let (limit, sign, distance) = match (limits.lower, limits.upper) {
            (Some(lower), _) if q < p[lower] => (lower, -1.0, p[lower] - q),
            (_, Some(upper)) if q > p[upper] => (upper, 1.0, q - p[upper]),
            _ => return None,
        };
        Some(Self { limit, sign, distance, stiffness: p[limits.stiffness], width: p[limits.width] })
    }

    /// Widths beyond where it stiffens again.
    fn far(&self) -> f64 {
        (self.distance - STIFFENING_WIDTHS * self.width).max(0.0) / self.width
    }

    fn energy(&self) -> f64 {
        let Self { distance: s, stiffness: k, width: w, .. } = *self;
        if s <= w {
            return k * s.powi(3) / (6.0 * w);
        }
        k * (0.5 * s * s - 0.5 * w * s + w * w / 6.0) + k * w * w * self.far().powi(4) / 12.0
    }

    /// The derivative of the energy by the coordinate.
    fn slope(&self) -> f64 {
        let Self { distance: s, stiffness: k, width: w, sign, .. } = *self;
        let size =
            if s <= w { k * s * s / (2.0 * w) } else { k * (s - 0.5 * w) + k * w * self.far().powi(3) / 3.0 };
        sign * size
    }

    fn curvature(&self) -> f64 {
        let Self { distance: s, stiffness: k, width: w, .. } = *self;
        if s <= w { k * s / w } else { k + k * self.far().powi(2) }
    }

    /// The derivative of the slope by the width.
    fn slope_by_width(&self) -> f64 {
        let Self { distance: s, stiffness: k, width: w, sign, .. } = *self;
        if s <= w {
            return -sign * k * s * s / (2.0 * w * w);
        }
        let far = self.far();
        sign * k * (far.powi(3) / 3.0 - far * far * s / w - 0.5)
    }
}

/// Widths beyond a limit after which it stiffens again.
const STIFFENING_WIDTHS: f64 = 10.0;
