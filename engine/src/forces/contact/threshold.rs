//! Detection of contacts that are about to open or close.

use super::super::state::State;
use super::definition::Contact;
use super::round_cone::{PlacedCone, counts};
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tolerances::SWITCHING_DISTANCE;

/// Whether any pair of spheres that can move relative to each other is about to close or open.
pub(crate) fn of_spheres<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    contact: &Contact,
    moves: &impl Fn(&[usize], &Vector<P>) -> bool,
) -> bool {
    let (points, radii) = (&at.kinematics.points, &at.geometry.radii);
    for first in contact.first.clone() {
        let a = at.tree.spheres[first].point;
        let start = if contact.is_self() { first + contact.skip.max(1) } else { contact.second.start };
        for second in start..contact.second.end {
            let b = at.tree.spheres[second].point;
            let reach = radii[first] + radii[second];
            let r = points[a] - points[b];
            let distance = r.norm();
            let near = (distance - reach).abs() < SWITCHING_DISTANCE * reach && distance > 0.0;
            if near && moves(&[a, b], &(r * (1.0 / distance))) {
                return true;
            }
        }
    }
    false
}

/// As [`of_spheres`] for spheres against round cones, and whether a sphere in contact is about to pass
/// from a cone's side to its end.
pub(crate) fn of_round_cones<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    contact: &Contact,
    moves: &impl Fn(&[usize], &Vector<P>) -> bool,
) -> bool {
    let (points, radii) = (&at.kinematics.points, &at.geometry.radii);
    for first in contact.first.clone() {
        if contact.weight(at.parameters(), first) == 0.0 {
            continue;
        }
        let p = at.tree.spheres[first].point;
        for cone in contact.cones.iter().filter(|c| counts(contact, first, c)) {
            let [a, b] = cone.ends.map(|s| at.tree.spheres[s].point);
            let placed = PlacedCone::new([&points[a], &points[b]], cone.ends.map(|s| radii[s]));
            let found = placed.closest(&points[p]);
            let reach = radii[first] + found.radius;
            let gap = found.distance - reach;
            let touched: &[usize] = match found.t {
                t if t <= 0.0 => &[p, a],
                t if t >= 1.0 => &[p, b],
                _ => &[p, a, b],
            };
            if gap.abs() < SWITCHING_DISTANCE * reach && moves(touched, &found.normal) {
                return true;
            }
            let passing = |t: f64| t.abs().min((t - 1.0).abs()) < SWITCHING_DISTANCE;
            let passes = gap < 0.0 && found.unbounded.is_some_and(passing);
            if passes && (moves(&[p, a, b], &placed.axis) || moves(&[p, a, b], &found.normal)) {
                return true;
            }
        }
    }
    false
}
