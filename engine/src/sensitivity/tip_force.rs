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
    out.fill(0.0);
    let Some(direction) = data.tip_direction(model) else { return false };
    wrench.fill(Vector::ZERO);
    for_each_change(model, data, &direction, |points, changes| {
        for (point, change) in points.into_iter().zip(changes) {
            let jacobian = G::point_jacobian(&data.kinematics.points[point]);
            wrench[model.points[point].frame] += jacobian.transpose_times(&change);
        }
    });
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
    let Some(direction) = data.tip_direction(model) else { return };
    let (at, states) = (data.state(model, &[], &[]), &data.assembly.forces);
    model.forces.contacts.add_tip_force_parameters(&at, &states.contacts, &direction, out);
    model.forces.foundations.add_tip_force_parameters(&at, &states.foundations, &direction, out);
    for_each_change(model, data, &direction, |points, changes| {
        for design_velocity in design_velocities {
            let along = points.map(|point| design_velocity.velocities().points[point]);
            out[design_velocity.parameter] += changes.iter().zip(&along).map(|(c, d)| c.dot(d)).sum::<f64>();
        }
    });
}

/// Visits the contacts of the tip: their points p, a, b and the derivatives of F_t with respect to these.
fn for_each_change<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
    direction: &Vector<P>,
    mut visit: impl FnMut([usize; 3], [Vector<P>; 3]),
) {
    let (p, states) = (&data.design.geometry.parameters, &data.assembly.forces);
    for (_, k, pair) in model.forces.contacts.tip_pairs(p, &states.contacts) {
        visit(pair.points(&model.tree), force_change(pair, k, direction));
    }
    model.forces.foundations.for_each_tip_change(&model.tree, &states.foundations, direction, visit);
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
