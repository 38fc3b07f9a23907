//! Point loads: forces and moments, fixed in the world or following their body.
//!
//! A dead force has the potential −f·p. For the rest the generalised force is −Jᵀw all the same, and
//! the tangent gains the antisymmetric part ∓½ Jᵀ M(w) J that no potential can give.

use super::FrameTerms;
use crate::design::Design;
use crate::kinematics::Kinematics;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::{Model, Wrench};
use crate::strain::Mode;

pub(crate) fn add<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    kinematics: &Kinematics<G, D, P>,
    load: &[f64],
    out: &mut FrameTerms<D, P>,
) {
    for wrench in &model.wrenches {
        let size = wrench.input.map_or(1.0, |i| load[i]);
        let p = &kinematics.points[wrench.point];
        if wrench.follower {
            out.wrench[wrench.frame] -= world_wrench(wrench, design, kinematics) * size;
            out.loaded[wrench.frame] = true;
        } else {
            let force = wrench.force * size;
            out.energy -= force.dot(p);
            out.add_force::<G>(wrench.frame, p, &-force);
            out.wrench[wrench.frame] -= moment::<G, D, P>(wrench) * size;
            if P == 2 && wrench.moment[1] != 0.0 {
                out.energy -= size * wrench.moment[1] * kinematics.planar_angle(model, wrench.frame);
            }
        }
    }
}

/// The symmetric part of the tangent.
pub(crate) fn add_tangent<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    points: &[Vector<P>],
    load: &[f64],
    out: &mut FrameTerms<D, P>,
) {
    for wrench in model.wrenches.iter().filter(|w| !w.follower) {
        let size = wrench.input.map_or(1.0, |i| load[i]);
        out.add_curvature::<G>(wrench.frame, &points[wrench.point], &(wrench.force * -size));
    }
}

/// The part of a wrench whose tangent has an antisymmetric half, and the sign of that half.
pub(crate) fn circulatory<G: LieGroup<D, P>, const D: usize, const P: usize>(
    wrench: &Wrench<P>,
    design: &Design<G, D, P>,
    kinematics: &Kinematics<G, D, P>,
) -> (Vector<D>, f64) {
    if wrench.follower {
        (world_wrench(wrench, design, kinematics), -0.5)
    } else {
        (moment::<G, D, P>(wrench), 0.5)
    }
}

/// World wrench per unit of load; the sign convention is that of an applied load.
pub(crate) fn world_wrench<G: LieGroup<D, P>, const D: usize, const P: usize>(
    wrench: &Wrench<P>,
    design: &Design<G, D, P>,
    kinematics: &Kinematics<G, D, P>,
) -> Vector<D> {
    let p = &kinematics.points[wrench.point];
    if !wrench.follower {
        return G::point_jacobian(p).transpose_times(&wrench.force) + moment::<G, D, P>(wrench);
    }
    let pose = &kinematics.pose[wrench.frame];
    let local = &design.points[wrench.point];
    let body = G::point_jacobian(local).transpose_times(&wrench.force) + moment::<G, D, P>(wrench);
    pose.inverse().adjoint().transpose_times(&body)
}

fn moment<G: LieGroup<D, P>, const D: usize, const P: usize>(wrench: &Wrench<P>) -> Vector<D> {
    let mut w = Vector::ZERO;
    for mode in [Mode::TwistX, Mode::BendY, Mode::BendZ] {
        if let Some(axis) = G::axis(mode) {
            w[axis] = wrench.moment[mode.index()];
        }
    }
    w
}
