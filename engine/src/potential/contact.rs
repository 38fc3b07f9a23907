//! Which spheres touch which (8): d = R_f + R(X) − ‖r_c‖ > 0.

use super::enclosure;
use super::touch::Touch;
use crate::design::Design;
use crate::kinematics::Kinematics;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::{Contact, Model};

/// Visits the pairs of spheres of a contact that touch or lack less than `margin` of it, in the order
/// of the first group.
#[inline]
pub(crate) fn for_each_near<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    kinematics: &Kinematics<G, D, P>,
    contact: &Contact,
    margin: f64,
    mut visit: impl FnMut(Touch<P>),
) {
    let points = &kinematics.points;
    let balls = &kinematics.balls[contact.balls.clone()];
    for first in contact.first.clone() {
        let (p, radius) = (points[model.spheres[first].point], design.radii[first]);
        // A pair of a group with itself counts once.
        let second = if contact.is_self() {
            first + contact.skip.max(1)..contact.second.end
        } else {
            contact.second.clone()
        };
        let mut test = |second: usize| {
            let r = p - points[model.spheres[second].point];
            let reach = radius + design.radii[second];
            let (squared, near) = (r.dot(&r), reach + margin);
            if squared < near * near {
                let distance = squared.sqrt();
                // Coincident centres push nowhere in particular; any fixed direction will do.
                let normal =
                    if distance > 1e-12 * reach { r * (1.0 / distance) } else { Vector::unit(P - 1) };
                let distance = distance.max(1e-12 * reach);
                visit(Touch::of_spheres([first, second], normal, reach, distance, 1.0));
            }
        };
        if balls.is_empty() {
            second.for_each(test);
            continue;
        }
        for (k, ball) in balls.iter().enumerate() {
            let (r, near) = (p - ball.centre, radius + ball.radius + margin);
            let block = enclosure::block(contact, k);
            if r.dot(&r) < near * near && block.end > second.start {
                (block.start.max(second.start)..block.end).for_each(&mut test);
            }
        }
    }
}
