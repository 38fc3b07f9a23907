//! Contact of spheres with round cones, the convex hulls of two spheres: ½ k w max(d, 0)².
//!
//! Consecutive round cones share a sphere; their energies are added and that of the shared sphere is
//! subtracted, so that a bent chain is touched as one solid. Every term has a
//! continuous gradient.

use super::super::crossing::{Crossing, Motion, may_change_side};
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
    for first in contact.first.clone() {
        let (p, own) = (at.centre(first), at.geometry.radii[first]);
        let weight = contact.weight(at.parameters(), first);
        if weight == 0.0 {
            continue;
        }
        for (c, cone) in contact.cones.iter().enumerate() {
            if !counts(contact, first, cone) {
                continue;
            }
            let ends = cone.ends.map(|end| at.centre(end));
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
    for cone in &contact.cones {
        let moving = MovingCone::new(motion, cone.ends);
        for first in contact.first.clone() {
            if counts(contact, first, cone) && contact.weight(motion.ends[0].parameters(), first) > 0.0 {
                moving.crossing(first).into_iter().for_each(&mut *visit);
            }
        }
    }
}

/// A round cone that moves.
#[derive(Debug)]
pub(crate) struct MovingCone<'a, G, const D: usize, const P: usize> {
    motion: &'a Motion<'a, G, D, P>,
    ends: [usize; 2],
    start: PlacedCone<P>,
    /// Of its ends.
    ways: [Vector<P>; 2],
}

impl<'a, G: LieGroup<D, P>, const D: usize, const P: usize> MovingCone<'a, G, D, P> {
    pub fn new(motion: &'a Motion<'a, G, D, P>, ends: [usize; 2]) -> Self {
        let [from, to] = motion.ends;
        let [a, b] = ends.map(|end| from.centre(end));
        let ways = ends.map(|end| *to.centre(end) - *from.centre(end));
        Self { motion, ends, start: PlacedCone::new([a, b], ends.map(|end| from.geometry.radii[end])), ways }
    }

    /// Its crossing by a sphere, if the motion leads through it.
    #[inline]
    pub fn crossing(&self, sphere: usize) -> Option<Crossing> {
        let [from, to] = self.motion.ends;
        let (own, p) = (from.geometry.radii[sphere] + self.motion.margin, from.centre(sphere));
        let moved = *to.centre(sphere) - *p;
        let ways = self.ways.map(|way| moved - way);
        let thickness = own + self.start.largest;
        // The depth changes by at most the longer of both.
        let squared = ways[0].dot(&ways[0]).max(ways[1].dot(&ways[1]));
        if !may_change_side(thickness, squared) {
            return None;
        }
        let length = squared.sqrt();
        if self.start.is_far(p, own + length) {
            return None;
        }
        let depth = |cone: PlacedCone<P>, p: Vector<P>| {
            let found = cone.closest(&p);
            (own + found.radius - found.distance, found.normal)
        };
        let along = |share: f64| {
            // Relative to the first end.
            let axis = self.start.axis + (self.ways[1] - self.ways[0]) * share;
            depth(
                PlacedCone::new([&Vector::ZERO, &axis], self.start.radii),
                *p - self.start.start + ways[0] * share,
            )
        };
        self.motion.crossing_along(thickness, length, along, |end| {
            let cone =
                PlacedCone::new(self.ends.map(|end_of_axis| end.centre(end_of_axis)), self.start.radii);
            depth(cone, *end.centre(sphere)).0
        })
    }
}

/// Whether a sphere and a round cone form a pair: in self-contact, only if the cone is far enough ahead.
#[inline]
pub(crate) fn counts(contact: &Contact, first: usize, cone: &RoundCone) -> bool {
    !contact.is_self() || cone.ends[0].min(cone.ends[1]) >= first + contact.skip.max(1)
}
