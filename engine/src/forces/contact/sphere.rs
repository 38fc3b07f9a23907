//! Contact between spheres (8): d = R_f + R(X) − ‖r_c‖ > 0.

use super::super::crossing::{Crossing, Motion, SAME_SIDE};
use super::super::state::State;
use super::definition::Contact;
use super::enclosure::{self, BLOCK_SIZE, Ball};
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

/// Whether one of the pairs of spheres that may touch, or come to other sides, along a motion passes a test, given
/// the spheres and the place of the first relative to the second at both ends.
fn any_pair_near<G: LieGroup<D, P>, const D: usize, const P: usize>(
    motion: &Motion<G, D, P>,
    contact: &Contact,
    mut test: impl FnMut([usize; 2], [Vector<P>; 2]) -> bool,
) -> bool {
    let [before, after] = motion.ends;
    let (spheres, radii) = (&before.tree.spheres, &before.geometry.radii[contact.second.clone()]);
    let [from, to] = motion.ends.map(|at| contact.second_centres(spheres, &at.kinematics.points));
    (0..radii.len().div_ceil(BLOCK_SIZE)).any(|k| {
        let block = enclosure::block(radii.len(), k);
        let ball = Ball::around(&from[block.clone()], &radii[block.clone()]);
        let way = block.clone().map(|i| longest(to[i] - from[i])).fold(0.0, f64::max);
        contact.first.clone().any(|first| {
            let own = [before, after].map(|at| *at.centre(first));
            let ways = way + longest(own[1] - own[0]);
            let near = ball.radius + before.geometry.radii[first] + TURNING * ways;
            let apart = own[0] - ball.centre;
            // A pair of a group with itself counts once.
            let ahead =
                if contact.is_self() { first + contact.skip.max(1) - contact.second.start } else { 0 };
            apart.dot(&apart) <= near * near
                && (block.start.max(ahead)..block.end)
                    .any(|i| test([first, contact.second.start + i], [own[0] - from[i], own[1] - to[i]]))
        })
    })
}

/// An upper bound on the length of a vector, without a root.
fn longest<const P: usize>(moved: Vector<P>) -> f64 {
    moved.0.iter().map(|x| x.abs()).sum()
}

/// Spheres further apart than this multiple of their ways stay on their sides, up to the angle of `SAME_SIDE`:
/// 1/√(1 − `SAME_SIDE`²), rounded up.
const TURNING: f64 = 1.03;

/// Whether a sphere of the first group is on another side of one of the second after a motion.
pub(crate) fn may_cross<G: LieGroup<D, P>, const D: usize, const P: usize>(
    motion: &Motion<G, D, P>,
    contact: &Contact,
) -> bool {
    any_pair_near(motion, contact, |_, [before, after]| {
        let along = before.dot(&after);
        let both = before.dot(&before) * after.dot(&after);
        along <= 0.0 || along * along <= SAME_SIDE * SAME_SIDE * both
    })
}

/// Visits the pairs of spheres that a motion leads through each other.
pub(crate) fn for_each_crossing<G: LieGroup<D, P>, const D: usize, const P: usize>(
    motion: &Motion<G, D, P>,
    contact: &Contact,
    visit: &mut impl FnMut(Crossing),
) {
    let radii = &motion.ends[0].geometry.radii;
    any_pair_near(motion, contact, |[first, second], [before, after]| {
        let moved = after - before;
        let (thickness, along) = (radii[first] + radii[second], -before.dot(&moved));
        // Too far aside, or still far away at the end.
        let aside = before.dot(&before) * moved.dot(&moved) - along * along;
        let far = thickness * thickness * moved.dot(&moved);
        if along > 0.0 && aside <= far && (along <= moved.dot(&moved) || motion.last.is_some()) {
            let depth = |place: &Vector<P>| {
                let (normal, distance) = direction(*place, place.norm(), thickness);
                (thickness - distance, normal)
            };
            let last = |end: &State<G, D, P>| {
                let [own, other] = [first, second].map(|sphere| *end.centre(sphere));
                own - other
            };
            let found = motion.crossing(thickness, [before, after], depth, last);
            found.into_iter().for_each(&mut *visit);
        }
        false
    });
}

/// Unit vector along r and its length; the direction is arbitrary for concentric spheres.
#[inline]
pub(crate) fn direction<const P: usize>(r: Vector<P>, length: f64, size: f64) -> (Vector<P>, f64) {
    let smallest = 1e-12 * size;
    let normal = if length > smallest { r * (1.0 / length) } else { Vector::unit(P - 1) };
    (normal, length.max(smallest))
}
