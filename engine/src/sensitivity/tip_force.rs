//! The tip force F_t, the resultant of contact on the tip spheres, as an output.

use super::design_velocity::DesignVelocity;
use crate::data::Data;
use crate::forces::contact::ContactPair;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::Model;

/// ∂F_t/∂q into `out`; `false` when nothing touches the tip, where F_t has no derivative.
pub(super) fn set_gradient<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
    wrench: &mut [Vector<D>],
    out: &mut [f64],
) -> bool {
    let (contacts, state) = (&model.forces.contacts, &data.assembly.forces.contacts);
    let p = &data.design.geometry.parameters;
    out.fill(0.0);
    let Some(direction) = contacts.tip_direction(p, state) else { return false };
    wrench.fill(Vector::ZERO);
    for (_, k, pair) in contacts.tip_pairs(p, state) {
        for (point, change) in pair.points(&model.tree).into_iter().zip(force_change(pair, k, &direction)) {
            let jacobian = G::point_jacobian(&data.kinematics.points[point]);
            wrench[model.points[point].frame] += jacobian.transpose_times(&change);
        }
    }
    data.assembly.add_forces(model, wrench, out);
    true
}

/// Adds ∂F_t/∂p at fixed state.
pub(super) fn add_parameters<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
    design_velocities: &[DesignVelocity<D, P>],
    out: &mut [f64],
) {
    let (contacts, state) = (&model.forces.contacts, &data.assembly.forces.contacts);
    let p = &data.design.geometry.parameters;
    let Some(direction) = contacts.tip_direction(p, state) else { return };
    contacts.add_tip_force_parameters(&data.state(model, &[], &[]), state, &direction, out);
    for design_velocity in design_velocities {
        for (_, k, pair) in contacts.tip_pairs(p, state) {
            let along = pair.motion(&model.tree, design_velocity.velocities().points);
            let changes = force_change(pair, k, &direction);
            out[design_velocity.parameter] += changes.iter().zip(&along).map(|(c, d)| c.dot(d)).sum::<f64>();
        }
    }
}

/// Derivatives of the force k d n along a direction with respect to the three points of a pair.
fn force_change<const P: usize>(pair: &ContactPair<P>, k: f64, direction: &Vector<P>) -> [Vector<P>; 3] {
    let mut changes = [Vector::ZERO; 3];
    for (i, change) in changes.iter_mut().enumerate() {
        for axis in 0..P {
            let mut motion = [Vector::ZERO; 3];
            motion[i] = Vector::unit(axis);
            let pressed = pair.normal * pair.closing(&motion) + pair.turning(&motion) * pair.overlap;
            change[axis] = k * direction.dot(&pressed);
        }
    }
    changes
}
