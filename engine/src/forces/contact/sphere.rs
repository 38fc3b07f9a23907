//! Contact between spheres (8): d = R_f + R(X) − ‖r_c‖ > 0.

use super::super::state::State;
use super::definition::Contact;
use super::enclosure::{self, Ball};
use super::pair::ContactPair;
use crate::lie::LieGroup;
use crate::linalg::Vector;

/// Visits the pairs of spheres of a contact whose gap is below `margin`, in the order of the first
/// group.
#[inline]
pub(crate) fn for_each_near<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    balls: &[Ball<P>],
    contact: &Contact,
    margin: f64,
    mut visit: impl FnMut(ContactPair<P>),
) {
    let (points, spheres) = (&at.kinematics.points, &at.tree.spheres);
    let balls = &balls[contact.balls.clone()];
    let centres = contact.second_centres(spheres, points);
    let radii = &at.geometry.radii[contact.second.clone()];
    for first in contact.first.clone() {
        let (p, radius) = (points[spheres[first].point], at.geometry.radii[first]);
        // A pair of a group with itself counts once.
        let ahead = if contact.is_self() {
            (first + contact.skip.max(1) - contact.second.start).min(centres.len())
        } else {
            0
        };
        // Without balls all spheres form one block.
        for k in 0..balls.len().max(1) {
            let block = match balls.get(k) {
                None => ahead..centres.len(),
                Some(ball) => {
                    let (r, near) = (p - ball.centre, radius + ball.radius + margin);
                    if r.dot(&r) >= near * near {
                        continue;
                    }
                    let block = enclosure::block(centres.len(), k);
                    block.start.max(ahead).min(block.end)..block.end
                }
            };
            for ((i, centre), other) in block.clone().zip(&centres[block.clone()]).zip(&radii[block]) {
                let r = p - *centre;
                let reach = radius + other;
                let (squared, near) = (r.dot(&r), reach + margin);
                if squared < near * near {
                    let distance = squared.sqrt();
                    let (normal, distance) = direction(r, distance, reach);
                    let pair = [first, contact.second.start + i];
                    visit(ContactPair::of_spheres(pair, normal, reach, distance, 1.0));
                }
            }
        }
    }
}

/// Unit vector along r and its length; the direction is arbitrary for concentric spheres.
#[inline]
pub(crate) fn direction<const P: usize>(r: Vector<P>, length: f64, size: f64) -> (Vector<P>, f64) {
    let smallest = 1e-12 * size;
    let normal = if length > smallest { r * (1.0 / length) } else { Vector::unit(P - 1) };
    (normal, length.max(smallest))
}
