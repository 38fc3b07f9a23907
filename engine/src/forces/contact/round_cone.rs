//! Contact of spheres with round cones, the convex hulls of two spheres: ½ k w max(d, 0)².
//!
//! Consecutive round cones share a sphere; their energies are added and that of the shared sphere is
//! subtracted, so that a bent chain is touched as one solid. Every term has a
//! continuous gradient.

use super::super::crossing::{Crossing, Motion};
use super::super::state::State;
use super::definition::{Contact, RoundCone};
use super::pair::ContactPair;
use super::sphere::direction;
use crate::lie::LieGroup;
use crate::linalg::Vector;

/// The point of a round cone's axis whose sphere comes closest to a point.
#[derive(Clone, Debug)]
pub(crate) struct Closest<const P: usize> {
    pub t: f64,
    /// Its position on the extended axis; `None` if one end's sphere contains the other.
    pub unbounded: Option<f64>,
    pub normal: Vector<P>,
    pub distance: f64,
    pub across: Vector<P>,
    pub slip: f64,
    pub radius: f64,
}

/// A round cone where it is, with what does not depend on the point near it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedCone<const P: usize> {
    pub start: Vector<P>,
    pub axis: Vector<P>,
    pub radii: [f64; 2],
    taper: f64,
    largest: f64,
    /// ‖axis‖², and its inverse.
    squared: f64,
    inverse: f64,
    /// ‖axis‖² less the taper's square; not positive if one end's sphere contains the other.
    across_squared: f64,
    /// The closest point is further towards the thicker end than the foot of the perpendicular, by this
    /// multiple of the distance from the axis.
    shift: f64,
}

impl<const P: usize> PlacedCone<P> {
    #[inline]
    pub fn new(ends: [&Vector<P>; 2], radii: [f64; 2]) -> Self {
        let axis = *ends[1] - *ends[0];
        let taper = radii[1] - radii[0];
        let squared = axis.dot(&axis);
        let across_squared = squared - taper * taper;
        Self {
            start: *ends[0],
            axis,
            radii,
            taper,
            largest: radii[0].max(radii[1]),
            squared,
            inverse: 1.0 / squared,
            across_squared,
            shift: taper / (squared * across_squared).sqrt(),
        }
    }

    /// Whether a point is further than `reach` from the surface, without a root or a division; nearer ones
    /// may be.
    #[inline]
    pub fn is_far(&self, p: &Vector<P>, reach: f64) -> bool {
        let from = *p - self.start;
        let (along, squared, limit) = (from.dot(&self.axis), self.squared, (reach + self.largest).powi(2));
        if along <= 0.0 {
            from.dot(&from) > limit
        } else if along >= squared {
            let beyond = from - self.axis;
            beyond.dot(&beyond) > limit
        } else {
            from.dot(&from) * squared - along * along > limit * squared
        }
    }

    /// Minimises ‖p − c(t)‖ − r(t), which is convex in t.
    #[inline]
    pub fn closest(&self, p: &Vector<P>) -> Closest<P> {
        let Self { axis, taper, .. } = *self;
        let from = *p - self.start;
        let unbounded = (self.across_squared > 0.0).then(|| {
            let foot = from.dot(&axis) * self.inverse;
            foot + self.shift * (from - axis * foot).norm()
        });
        let t = unbounded.unwrap_or(if taper > 0.0 { 1.0 } else { 0.0 }).clamp(0.0, 1.0);
        let r = from - axis * t;
        let radius = self.radii[0] + t * taper;
        let distance = r.norm();
        let inside = distance <= 1e-12 * radius;
        let (normal, distance) = direction(r, distance, radius);
        let slides = !inside && unbounded == Some(t) && t > 0.0 && t < 1.0;
        let across = axis - normal * normal.dot(&axis);
        let slip = if slides { distance / self.across_squared } else { 0.0 };
        Closest { t, unbounded, normal, distance, across, slip, radius }
    }
}

/// Visits what the first group's spheres touch, or lack less than `margin` of touching: round cones,
/// and, with negative weight, the spheres that two of them share.
#[inline]
pub(crate) fn for_each_near<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    contact: &Contact,
    margin: f64,
    mut visit: impl FnMut(ContactPair<P>),
) {
    let centre = |sphere: usize| at.point(at.tree.spheres[sphere].point);
    for first in contact.first.clone() {
        let (p, own) = (centre(first), at.geometry.radii[first]);
        let weight = contact.weight(at.parameters(), first);
        if weight == 0.0 {
            continue;
        }
        for (c, cone) in contact.cones.iter().enumerate() {
            if !counts(contact, first, cone) {
                continue;
            }
            let ends = cone.ends.map(centre);
            let radii = cone.ends.map(|s| at.geometry.radii[s]);
            let placed = PlacedCone::new(ends, radii);
            if placed.is_far(p, own + margin) {
                continue;
            }
            let found = placed.closest(p);
            let reach = own + found.radius;
            if found.distance >= reach + margin {
                continue;
            }
            let second = match found.t {
                _ if found.slip > 0.0 => cone.ends,
                t if t < 0.5 => [cone.ends[0]; 2],
                _ => [cone.ends[1]; 2],
            };
            let Closest { t, normal, distance, across, slip, .. } = found;
            let overlap = reach - distance;
            visit(ContactPair { first, second, t, normal, overlap, distance, across, slip, weight });
            if !cone.joined || !counts(contact, first, &contact.cones[c - 1]) {
                continue;
            }
            let r = *p - *ends[0];
            let (squared, reach) = (r.dot(&r), own + radii[0]);
            let near = reach + margin;
            if squared < near * near {
                let (normal, distance) = direction(r, squared.sqrt(), radii[0]);
                let pair = [first, cone.ends[0]];
                visit(ContactPair::of_spheres(pair, normal, reach, distance, -weight));
            }
        }
    }
}

/// Visits the spheres of the first group that a motion leads through a round cone.
pub(crate) fn for_each_crossing<G: LieGroup<D, P>, const D: usize, const P: usize>(
    motion: &Motion<G, D, P>,
    contact: &Contact,
    visit: &mut impl FnMut(Crossing),
) {
    for first in contact.first.clone() {
        if contact.weight(motion.ends[0].parameters(), first) > 0.0 {
            let cones = contact.cones.iter().filter(|cone| counts(contact, first, cone));
            cones.filter_map(|cone| crossing_of_cone(motion, first, cone)).for_each(&mut *visit);
        }
    }
}

/// The crossing of a round cone by a sphere, if a motion leads through it.
pub(crate) fn crossing_of_cone<G: LieGroup<D, P>, const D: usize, const P: usize>(
    motion: &Motion<G, D, P>,
    sphere: usize,
    cone: &RoundCone,
) -> Option<Crossing> {
    let (spheres, radii) = (&motion.ends[0].tree.spheres, &motion.ends[0].geometry.radii);
    let radii_of_cone = cone.ends.map(|end| radii[end]);
    let thickness = radii[sphere] + radii_of_cone[0].max(radii_of_cone[1]);
    // Of the sphere and of the second end, relative to the first end.
    let [before, after] = motion.ends.map(|at| {
        let [p, a, b] = [sphere, cone.ends[0], cone.ends[1]].map(|s| *at.point(spheres[s].point));
        [p - a, b - a]
    });
    let reach = radii[sphere] + (after[0] - before[0]).norm() + (after[1] - before[1]).norm();
    if PlacedCone::new([&Vector::ZERO, &before[1]], radii_of_cone).is_far(&before[0], reach) {
        return None;
    }
    let moves = Motion::<G, D, P>::moves_enough;
    let ways = [[before[0], after[0]], [before[0] - before[1], after[0] - after[1]]];
    if !ways.iter().any(|way| moves(thickness, way)) {
        return None;
    }
    let place = |share: f64, i: usize| before[i] + (after[i] - before[i]) * share;
    motion.crossing_along(thickness, |share| {
        let cone = PlacedCone::new([&Vector::ZERO, &place(share, 1)], radii_of_cone);
        let found = cone.closest(&place(share, 0));
        (radii[sphere] + found.radius - found.distance, found.normal)
    })
}

/// Whether a sphere and a round cone form a pair: in self-contact, only if the cone is far enough ahead.
#[inline]
pub(crate) fn counts(contact: &Contact, first: usize, cone: &RoundCone) -> bool {
    !contact.is_self() || cone.ends[0].min(cone.ends[1]) >= first + contact.skip.max(1)
}
