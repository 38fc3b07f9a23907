//! Whether a straight motion of the coordinates leads a sphere through a solid: in on one side and out on another.
//!
//! A descent on the energy sees contact only at the ends of its steps. A step that is longer than a body is thick
//! may end behind it, at a lower energy, with a barrier in between.

use super::state::State;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use std::ops::Range;

/// Cosine of the angle between the normals at both ends of a motion, above which the sphere stays on its side.
pub(crate) const SAME_SIDE: f64 = 0.2;
/// Smallest depth of a crossing, as a fraction of the thickness.
pub(crate) const DEEP: f64 = 0.03;
/// Depth at which a sphere has met the solid, as a fraction of the largest.
const MET: f64 = 0.1;
/// Motion of a sphere relative to the solid that cannot lead to its other side, likewise.
const SHORT: f64 = 0.05;
/// Places that are compared before the deepest one is refined, and steps of refinement.
const PLACES: usize = 8;
const REFINEMENTS: usize = 40;

/// A part of a motion that leads into a solid, as fractions of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// Where the sphere has met the solid.
    pub met: f64,
    /// Where it is deepest.
    pub deepest: f64,
}

/// A motion of all points along straight lines.
#[derive(Debug)]
pub(crate) struct Motion<'a, G, const D: usize, const P: usize> {
    /// The states at its ends.
    pub ends: [&'a State<'a, G, D, P>; 2],
    /// The state at the end of those that follow.
    pub last: Option<&'a State<'a, G, D, P>>,
    /// By how much solids are larger than they are, but for skins, which give way smoothly.
    pub margin: f64,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Motion<'_, G, D, P> {
    /// The crossing of a solid by a sphere that moves so relative to it; `at` is the depth at a place and the
    /// normal there, `thickness` the depth from which the nearest surface is that of the other side.
    pub fn crossing(
        &self,
        thickness: f64,
        way: [Vector<P>; 2],
        at: impl Fn(&Vector<P>) -> (f64, Vector<P>),
        last: impl Fn(&State<G, D, P>) -> Vector<P>,
    ) -> Option<Crossing> {
        let change = way[1] - way[0];
        if !may_change_side(thickness, change.dot(&change)) {
            return None;
        }
        let along = |share: f64| at(&(way[0] + change * share));
        self.crossing_along(thickness, change.norm(), along, |end| at(&last(end)).0)
    }

    /// The same with depth and normal by the part of the way, over which the depth changes by at most `length`, and
    /// the depth in the last state.
    pub fn crossing_along(
        &self,
        thickness: f64,
        length: f64,
        at: impl Fn(f64) -> (f64, Vector<P>),
        last: impl Fn(&State<G, D, P>) -> f64,
    ) -> Option<Crossing> {
        crossing(thickness, length, at, || self.last.map(&last))
    }
}

/// The sum of the smallest radii of two groups of spheres.
pub(crate) fn thinnest_pair<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    groups: [&Range<usize>; 2],
) -> f64 {
    let smallest =
        groups.map(|group| at.geometry.radii[group.clone()].iter().copied().fold(f64::INFINITY, f64::min));
    smallest[0] + smallest[1]
}

/// Whether a sphere may come to the other side of a solid by a motion relative to it of this length, squared.
pub(crate) fn may_change_side(thickness: f64, squared: f64) -> bool {
    squared > (SHORT * thickness).powi(2)
}

/// `last`: the depth where the motion leads if it goes on. It also leads through what it is deep in at its end
/// and is less deep in there.
fn crossing<const P: usize>(
    thickness: f64,
    length: f64,
    at: impl Fn(f64) -> (f64, Vector<P>),
    last: impl FnOnce() -> Option<f64>,
) -> Option<Crossing> {
    let (before, normal) = at(0.0);
    let (after, other) = at(1.0);
    let deep = DEEP * thickness;
    let inside = after > deep && last().is_some_and(|left| after - left.max(0.0) > deep);
    // It may touch the other side there. The depth within is at most half of that at both ends and of the length.
    let outside = before <= 0.0 && after <= deep && before + after + length > 2.0 * deep;
    if normal.dot(&other) > SAME_SIDE && !inside && !outside {
        return None;
    }
    let depth = |share: f64| at(share).0;
    let share = |place: usize| place as f64 / PLACES as f64;
    let nearest = (0..=PLACES).max_by(|a, b| depth(share(*a)).total_cmp(&depth(share(*b))))?;
    // By golden section: the distance from a convex solid is convex along a straight line.
    let (mut low, mut high) = (share(nearest.saturating_sub(1)), share((nearest + 1).min(PLACES)));
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..REFINEMENTS {
        let (a, b) = (high - ratio * (high - low), low + ratio * (high - low));
        if depth(a) > depth(b) { high = b } else { low = a }
    }
    let deepest = 0.5 * (low + high);
    let touched = if outside && !inside { after.max(0.0) } else { 0.0 };
    if !(depth(deepest) - touched > deep) {
        return None;
    }
    let shallow = before.max(0.0);
    let target = shallow + MET * (depth(deepest) - shallow).max(0.0);
    let (mut apart, mut met) = (0.0, deepest);
    for _ in 0..REFINEMENTS {
        let middle = 0.5 * (apart + met);
        if depth(middle) < target { apart = middle } else { met = middle }
    }
    Some(Crossing { met, deepest })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sphere that passes a unit circle at a distance `aside` from its middle, from `from` to `to`.
    fn passing(aside: f64, from: f64, to: f64) -> Option<Crossing> {
        let along = |share: f64| {
            let place = Vector([from + share * (to - from), aside]);
            (1.0 - place.norm(), place * (1.0 / place.norm()))
        };
        crossing(1.0, (to - from).abs(), along, || None)
    }

    #[test]
    fn a_motion_through_a_solid_meets_it_at_its_surface() {
        // At a tenth of the largest depth, 0.999.
        for (from, to) in [(-2.0, 3.0), (-2000.0, 1e6)] {
            let found = passing(1e-3, from, to).unwrap();
            let place = |share: f64| from + share * (to - from);
            let off = 1e-9 * (to - from);
            assert!((place(found.met) + (0.9001f64.powi(2) - 1e-6).sqrt()).abs() < off, "{found:?}");
            assert!(place(found.deepest).abs() < 1e-3 + off, "{found:?}");
        }
    }

    #[test]
    fn a_motion_that_ends_in_touch_with_the_other_side_leads_through() {
        // On the other side of a chord that is 0.1 deep at most.
        let half = (1.0f64 - 0.9 * 0.9).sqrt();
        assert!(passing(0.9, -2.0, half - 1e-3).is_some());
        assert_eq!(passing(0.9, -2.0, -half + 1e-3), None);
    }

    #[test]
    fn what_grazes_a_solid_or_stays_on_its_side_does_not_cross_it() {
        assert_eq!(passing(0.98, -2.0, 2.0), None);
        assert_eq!(passing(0.1, -2.0, -0.5), None);
        assert_eq!(passing(0.1, -1.0, -30.0), None);
    }
}
