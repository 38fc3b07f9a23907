//! Contact of spheres with round cones, the convex hulls of two spheres: ½ k w max(d, 0)².
//!
//! Consecutive round cones share a sphere; their energies are added and that of the shared sphere is
//! subtracted, so that a bent chain is touched as one solid. Every term has a
//! continuous gradient.

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

/// Minimises ‖p − c(t)‖ − r(t), which is convex in t.
#[inline]
pub(crate) fn closest<const P: usize>(p: &Vector<P>, ends: [&Vector<P>; 2], radii: [f64; 2]) -> Closest<P> {
    let axis = *ends[1] - *ends[0];
    let from = *p - *ends[0];
    let taper = radii[1] - radii[0];
    let squared = axis.dot(&axis);
    let across_squared = squared - taper * taper;
    let unbounded = (across_squared > 0.0).then(|| {
        // The foot of the perpendicular, shifted towards the thicker end.
        let foot = from.dot(&axis) / squared;
        foot + taper * (from - axis * foot).norm() / (squared * across_squared).sqrt()
    });
    let t = unbounded.unwrap_or(if taper > 0.0 { 1.0 } else { 0.0 }).clamp(0.0, 1.0);
    let r = from - axis * t;
    let radius = radii[0] + t * taper;
    let distance = r.norm();
    let inside = distance <= 1e-12 * radius;
    let (normal, distance) = direction(r, distance, radius);
    let slides = !inside && unbounded == Some(t) && t > 0.0 && t < 1.0;
    let across = axis - normal * normal.dot(&axis);
    let slip = if slides { distance / across_squared } else { 0.0 };
    Closest { t, unbounded, normal, distance, across, slip, radius }
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
            if is_far(p, ends, own + radii[0].max(radii[1]) + margin) {
                continue;
            }
            let found = closest(p, ends, radii);
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

/// Whether a sphere and a round cone form a pair: in self-contact, only if the cone is far enough ahead.
#[inline]
pub(crate) fn counts(contact: &Contact, first: usize, cone: &RoundCone) -> bool {
    !contact.is_self() || cone.ends[0].min(cone.ends[1]) >= first + contact.skip.max(1)
}

/// Whether a point is further than `reach` from the axis, without a root or a division.
#[inline]
pub(crate) fn is_far<const P: usize>(p: &Vector<P>, ends: [&Vector<P>; 2], reach: f64) -> bool {
    let (axis, from) = (*ends[1] - *ends[0], *p - *ends[0]);
    let (along, squared, limit) = (from.dot(&axis), axis.dot(&axis), reach * reach);
    if along <= 0.0 {
        from.dot(&from) > limit
    } else if along >= squared {
        let beyond = *p - *ends[1];
        beyond.dot(&beyond) > limit
    } else {
        from.dot(&from) * squared - along * along > limit * squared
    }
}
