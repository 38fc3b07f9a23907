//! Contact between spheres (8): d = R_f + R(X) − ‖r_c‖ > 0.

use super::super::crossing::{Crossing, Motion, SAME_SIDE};
use super::super::state::State;
use super::definition::Contact;
use super::enclosure::{self, Ball};
use super::pair::ContactPair;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use std::ops::Range;

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

/// Spheres of a group that are compared with another sphere together.
#[derive(Clone, Copy)]
struct Block<const P: usize> {
    /// Around their surfaces before the motion.
    ball: (Vector<P>, f64),
    /// The longest way of one of them.
    way: f64,
}

const BLOCKS: usize = 8;

/// The spheres of the second group that a block consists of.
fn block_range(contact: &Contact, block: usize) -> Range<usize> {
    let size = contact.second.len().div_ceil(BLOCKS).max(1);
    let start = contact.second.start + block * size;
    start..(start + size).min(contact.second.end)
}

fn places_at_ends<G: LieGroup<D, P>, const D: usize, const P: usize>(
    motion: &Motion<G, D, P>,
    sphere: usize,
) -> [Vector<P>; 2] {
    motion.ends.map(|at| *at.point(at.tree.spheres[sphere].point))
}

fn blocks<G: LieGroup<D, P>, const D: usize, const P: usize>(
    motion: &Motion<G, D, P>,
    contact: &Contact,
) -> [Block<P>; BLOCKS] {
    let radii = &motion.ends[0].geometry.radii;
    std::array::from_fn(|block| {
        let range = block_range(contact, block);
        let mut around = Block { ball: (Vector::ZERO, 0.0), way: 0.0 };
        for sphere in range.clone() {
            let [before, after] = places_at_ends(motion, sphere);
            if sphere == range.start {
                around.ball.0 = before;
            }
            around.ball.1 = around.ball.1.max((before - around.ball.0).norm() + radii[sphere]);
            around.way = around.way.max((after - before).norm());
        }
        around
    })
}

/// Whether a sphere of the first group is on another side of one of the second after a motion.
pub(crate) fn may_cross<G: LieGroup<D, P>, const D: usize, const P: usize>(
    motion: &Motion<G, D, P>,
    contact: &Contact,
) -> bool {
    let blocks = blocks(motion, contact);
    contact.first.clone().any(|first| {
        let own = places_at_ends(motion, first);
        let way = (own[1] - own[0]).norm();
        let ahead = if contact.is_self() { first + contact.skip.max(1) } else { contact.second.start };
        blocks.iter().enumerate().any(|(block, around)| {
            // Spheres further apart than they move stay on their sides, up to the angle of `SAME_SIDE`.
            let (apart, near) = (own[0] - around.ball.0, around.ball.1 + TURNING * (way + around.way));
            let range = block_range(contact, block);
            apart.dot(&apart) <= near * near
                && (range.start.max(ahead)..range.end).any(|second| {
                    let other = places_at_ends(motion, second);
                    let [before, after] = [own[0] - other[0], own[1] - other[1]];
                    let along = before.dot(&after);
                    let both = before.dot(&before) * after.dot(&after);
                    along <= 0.0 || along * along <= SAME_SIDE * SAME_SIDE * both
                })
        })
    })
}

/// 1/√(1 − `SAME_SIDE`²), rounded up.
const TURNING: f64 = 1.03;

/// Visits the pairs of spheres that a motion leads through each other.
pub(crate) fn for_each_crossing<G: LieGroup<D, P>, const D: usize, const P: usize>(
    motion: &Motion<G, D, P>,
    contact: &Contact,
    visit: &mut impl FnMut(Crossing),
) {
    let radii = &motion.ends[0].geometry.radii;
    let places = |sphere: usize| places_at_ends(motion, sphere);
    let range = |block: usize| block_range(contact, block);
    let blocks = blocks(motion, contact);
    for first in contact.first.clone() {
        let own = places(first);
        let reach = radii[first] + (own[1] - own[0]).norm();
        let ahead = if contact.is_self() { first + contact.skip.max(1) } else { contact.second.start };
        for (block, Block { ball, way }) in blocks.iter().enumerate() {
            let (apart, near) = (own[0] - ball.0, reach + ball.1 + way);
            if apart.dot(&apart) > near * near {
                continue;
            }
            for second in range(block).start.max(ahead)..range(block).end {
                let other = places(second);
                let [before, after] = [own[0] - other[0], own[1] - other[1]];
                let moved = after - before;
                let (thickness, along) = (radii[first] + radii[second], -before.dot(&moved));
                // Too far aside, or still far away at the end.
                let aside = before.dot(&before) * moved.dot(&moved) - along * along;
                let far = thickness * thickness * moved.dot(&moved);
                if along <= 0.0 || aside > far || along > moved.dot(&moved) && !motion.continues {
                    continue;
                }
                let found = motion.crossing(thickness, [before, after], |place| {
                    let (normal, distance) = direction(*place, place.norm(), thickness);
                    (thickness - distance, normal)
                });
                found.into_iter().for_each(&mut *visit);
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
