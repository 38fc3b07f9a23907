//! The tip force F_t, the resultant of contact on the tip spheres, as an output.

use super::adjoint::Adjoint;
use super::local::add_radius;
use crate::data::Data;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::Model;
use crate::potential::contact::{Touch, for_each_touch};

impl<const D: usize, const P: usize> Adjoint<D, P> {
    /// ∂F_t/∂q into `out`; `false` when nothing touches the tip, where F_t has no derivative.
    pub fn tip_force_gradient<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        out: &mut [f64],
    ) -> bool {
        out.fill(0.0);
        let Some(direction) = direction(model, data) else { return false };
        self.wrench.fill(Vector::ZERO);
        each_tip_touch(model, data, |touch, k| {
            let [a, b] = [touch.first, touch.second].map(|s| model.spheres[s].point);
            let pull = stiffness_times(&touch, k, &direction) * -1.0;
            for (point, sign) in [(a, 1.0), (b, -1.0)] {
                let p = &data.kinematics.points[point];
                self.wrench[model.points[point].frame] +=
                    G::point_jacobian(p).transpose_times(&(pull * sign));
            }
        });
        for (f, frame) in model.frames.iter().enumerate().skip(1).rev() {
            let wrench = self.wrench[f];
            self.wrench[frame.parent] += wrench;
            for (dof, column) in data.assembly.columns(frame.columns.clone()) {
                out[*dof] += wrench.dot(column);
            }
        }
        true
    }

    /// Adds ∂F_t/∂p, the state held, for every wanted parameter.
    pub fn add_tip_force_parameters<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        q: &[f64],
        out: &mut [f64],
    ) {
        let Some(direction) = direction(model, data) else { return };
        each_tip_touch(model, data, |touch, k| {
            let along = direction.dot(&touch.normal);
            for contact in &model.contacts {
                if contact.first.contains(&touch.first) {
                    out[contact.stiffness] += touch.overlap * along;
                }
            }
            for sphere in [touch.first, touch.second] {
                let radius = model.spheres[sphere].radius;
                add_radius(model, &data.design.parameters, radius, k * along, out);
            }
        });
        for m in 0..self.motions.len() {
            let parameter = self.motions[m];
            self.drift_along(model, data, q, parameter.kind);
            each_tip_touch(model, data, |touch, k| {
                let [a, b] = [touch.first, touch.second].map(|s| model.spheres[s].point);
                let pull = stiffness_times(&touch, k, &direction);
                out[parameter.index] -= pull.dot(&(self.drift[a] - self.drift[b]));
            });
        }
    }
}

/// The contact Hessian k n nᵀ − (k d/‖r‖)(1 − n nᵀ) times a direction.
fn stiffness_times<const P: usize>(touch: &Touch<P>, k: f64, direction: &Vector<P>) -> Vector<P> {
    let along = touch.normal * touch.normal.dot(direction);
    (along - (*direction - along) * (touch.overlap / touch.distance)) * k
}

/// Unit vector of the resultant on the tip spheres.
fn direction<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
) -> Option<Vector<P>> {
    let mut resultant = Vector::<P>::ZERO;
    each_tip_touch(model, data, |touch, k| resultant += touch.normal * (k * touch.overlap));
    let size = resultant.norm();
    (size > 0.0).then(|| resultant * (1.0 / size))
}

fn each_tip_touch<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
    mut visit: impl FnMut(Touch<P>, f64),
) {
    for contact in &model.contacts {
        let k = data.design.parameters[contact.stiffness];
        for_each_touch(model, &data.design, &data.kinematics.points, contact, |touch| {
            if contact.tip[touch.first - contact.first.start] {
                visit(touch, k);
            }
        });
    }
}
