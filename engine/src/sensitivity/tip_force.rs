//! The tip force F_t, the resultant of contact on the tip spheres, as an output.

use super::adjoint::Adjoint;
use super::local::add_radius;
use crate::data::Data;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::{Contact, Model};
use crate::potential::touch::Touch;

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
        for (_, k, touch) in tip_touches(model, data) {
            let changes = force_change(touch, k, &direction);
            for (point, change) in touch.points(model).into_iter().zip(changes) {
                let p = &data.kinematics.points[point];
                self.wrench[model.points[point].frame] += G::point_jacobian(p).transpose_times(&change);
            }
        }
        data.assembly.add_forces(model, &mut self.wrench, out);
        true
    }

    /// Adds ∂F_t/∂p, the state held, for every wanted parameter.
    pub fn add_tip_force_parameters<G: LieGroup<D, P>>(
        &self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        out: &mut [f64],
    ) {
        let Some(direction) = direction(model, data) else { return };
        let p = &data.design.parameters;
        for (contact, k, touch) in tip_touches(model, data) {
            let along = direction.dot(&touch.normal);
            out[contact.stiffness] += touch.weight * touch.overlap * along;
            if let Some(length) = contact.lengths.get(touch.first - contact.first.start) {
                out[*length] += k * touch.overlap * along / p[*length];
            }
            let turned = direction.dot(&touch.across) * touch.overlap * touch.slip / touch.distance;
            let [a, b] = touch.second;
            for (i, sphere) in [touch.first, a, b].into_iter().enumerate() {
                let weight = touch.by_radii()[i] * along + touch.slide_by_radii()[i] * turned;
                add_radius(model, p, model.spheres[sphere].radius, k * weight, out);
            }
        }
        for drift in &self.drifts {
            for (_, k, touch) in tip_touches(model, data) {
                let along = touch.motion(model, &drift.points);
                let changes = force_change(touch, k, &direction);
                out[drift.parameter] += changes.iter().zip(&along).map(|(c, d)| c.dot(d)).sum::<f64>();
            }
        }
    }
}

/// Derivatives of the force k d n along a direction with respect to the three points of a touch.
fn force_change<const P: usize>(touch: &Touch<P>, k: f64, direction: &Vector<P>) -> [Vector<P>; 3] {
    let mut changes = [Vector::ZERO; 3];
    for (i, change) in changes.iter_mut().enumerate() {
        for axis in 0..P {
            let mut motion = [Vector::ZERO; 3];
            motion[i] = Vector::unit(axis);
            let pressed = touch.normal * touch.closing(&motion) + touch.turning(&motion) * touch.overlap;
            change[axis] = k * direction.dot(&pressed);
        }
    }
    changes
}

/// Unit vector of the resultant on the tip spheres.
fn direction<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
) -> Option<Vector<P>> {
    let mut resultant = Vector::<P>::ZERO;
    for (_, k, touch) in tip_touches(model, data) {
        resultant += touch.normal * (k * touch.overlap);
    }
    let size = resultant.norm();
    (size > 0.0).then(|| resultant * (1.0 / size))
}

fn tip_touches<'a, G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &'a Model<G, D, P>,
    data: &'a Data<G, D, P>,
) -> impl Iterator<Item = (&'a Contact, f64, &'a Touch<P>)> {
    data.touching(model).filter(|(contact, _, t)| contact.tip[t.first - contact.first.start])
}
