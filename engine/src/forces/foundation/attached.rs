//! Forces, tangent and derivatives of a potential that depends on a rod's point in the frame of a link.

use super::super::element::{Velocities, VirtualMotion};
use super::super::magnitudes::Magnitudes;
use super::super::state::State;
use super::super::terms::{Coupling, FrameTerms};
use super::cone_contact::{Change, ConeContact};
use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};
use crate::tree::Tree;

/// Indices of the points p, a, b.
#[inline]
pub(super) fn points<G: LieGroup<D, P>, const D: usize, const P: usize>(
    contact: &ConeContact<P>,
    tree: &Tree<G, D, P>,
) -> [usize; 3] {
    [contact.first, contact.ends[0], contact.ends[1]].map(|sphere| tree.spheres[sphere].point)
}

/// A motion of the points p, a, b.
#[inline]
pub(super) fn moved<const P: usize>(contact: &ConeContact<P>, [p, a, b]: &[Vector<P>; 3]) -> Change<P> {
    let relative = *p - *a * (1.0 - contact.t) - *b * contact.t;
    Change { relative, axis: *b - *a, explicit: [0.0; 6] }
}

/// Slopes by the points p, a, b of what changes with them in a given way.
pub(super) fn by_points<const P: usize>(
    contact: &ConeContact<P>,
    change: impl Fn(&Change<P>) -> f64,
) -> [Vector<P>; 3] {
    let mut slopes = [Vector::ZERO; 3];
    for (i, slope) in slopes.iter_mut().enumerate() {
        for axis in 0..P {
            let mut motion = [Vector::ZERO; 3];
            motion[i] = Vector::unit(axis);
            slope[axis] = change(&moved(contact, &motion));
        }
    }
    slopes
}

/// Its slopes by the quantities in [`Change::explicit`].
pub(super) fn by_explicit<T, const P: usize>(change: impl Fn(&Change<P>) -> T) -> [T; 6] {
    std::array::from_fn(|i| {
        let mut explicit = [0.0; 6];
        explicit[i] = 1.0;
        change(&Change { relative: Vector::ZERO, axis: Vector::ZERO, explicit })
    })
}

/// Frames of the rod's point and of the link.
#[inline]
fn frames<G: LieGroup<D, P>, const D: usize, const P: usize>(
    contact: &ConeContact<P>,
    at: &State<G, D, P>,
) -> [usize; 2] {
    let [p, a, _] = points(contact, at.tree);
    [at.frame(p), at.frame(a)]
}

/// The virtual velocity of the rod's point relative to the link.
#[inline]
pub(super) fn relative<G: LieGroup<D, P>, const D: usize, const P: usize>(
    contact: &ConeContact<P>,
    at: &State<G, D, P>,
    motion: &VirtualMotion<D, P>,
) -> Vector<P> {
    let [p, ..] = points(contact, at.tree);
    let [_, link] = frames(contact, at);
    motion.velocities.points[p] - G::point_jacobian(at.point(p)) * motion.velocities.twists[link]
}

/// Adds energy and forces, which act at the rod's point on both bodies.
pub(super) fn add_residual<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    contact: &ConeContact<P>,
    out: &mut FrameTerms<D>,
) {
    let [p, ..] = points(contact, at.tree);
    let [rod, link] = frames(contact, at);
    let force = contact.gradient();
    out.energy += contact.energy();
    out.add_force::<G, P>(rod, at.point(p), &force);
    out.add_force::<G, P>(link, at.point(p), &-force);
}

/// Adds the second derivative.
pub(super) fn add_tangent<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    contact: &ConeContact<P>,
    out: &mut FrameTerms<D>,
) {
    let origin = G::point_jacobian(&Vector::ZERO);
    let [p, ..] = points(contact, at.tree);
    let [rod, link] = frames(contact, at);
    let (p, force) = (at.point(p), contact.gradient());
    let mut turned = Matrix::<P, D>::ZERO;
    for axis in 0..P {
        // The field turns with the link: −f·(ω × v).
        turned.0[axis] = (G::point_jacobian(&Vector::unit(axis)) - origin).transpose_times(&force).0;
    }
    let jacobian = G::point_jacobian(p);
    let back = jacobian.transpose();
    let pulled = back * (contact.hessian() * jacobian);
    let form = pulled + G::point_curvature(p, &force);
    out.stiffness[rod] += form;
    out.stiffness[link] += form;
    out.couplings.push(Coupling { row: rod, column: link, form: (pulled + back * turned) * -1.0 });
}

/// Adds the magnitudes of the forces.
pub(super) fn add_magnitudes<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    contact: &ConeContact<P>,
    out: &mut Magnitudes<P>,
) {
    let [p, a, b] = points(contact, at.tree);
    let (k, force) = (contact.stiffness(), contact.normal_force());
    let places = at.point(p).norm() + at.point(a).norm() + contact.depth.abs() + contact.distance;
    for (point, share) in [(p, 1.0), (a, 1.0 - contact.t), (b, contact.t)] {
        out.add_of_distance(at, point, force * share, [k * share, places]);
    }
}

/// The change of the virtual work as frames and points move.
pub(super) fn geometric_work<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    contact: &ConeContact<P>,
    motion: &VirtualMotion<D, P>,
    velocities: &Velocities<D, P>,
) -> f64 {
    let change = points(contact, at.tree).map(|point| velocities.points[point]);
    let turned = contact.change_of_gradient(&moved(contact, &change));
    let shifted = frames(contact, at).map(|frame| motion.velocities.shifted::<G>(frame, &change[0]));
    turned.dot(&relative(contact, at, motion)) + contact.gradient().dot(&(shifted[0] - shifted[1]))
}
