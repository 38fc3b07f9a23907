//! Contact of a point of a rod with a round cone: its potential and the derivatives of its force.
//!
//! The round cone is fixed in one body, so that the potential Φ(p) = w L e(d, t) is a field in that
//! body's frame: d = S + r(t) − ‖p − c(t)‖ with t where this is largest, and e depends on t through
//! curvature and stiffness, which go from one end of the cone to the other as 3t² − 2t³ and so have no
//! kink where cones are joined.

use super::super::contact::Closest;
use super::definition::Foundation;
use super::strip::Strip;
use crate::linalg::{Matrix, Vector};

/// Indices of [`Explicit`].
pub(super) const SURFACE: usize = 0;
pub(super) const RADII: [usize; 2] = [1, 2];
pub(super) const STIFFNESS: [usize; 2] = [3, 4];
pub(super) const WIDTH: usize = 5;

/// Changes of S, of the radii and the stiffnesses at both ends, and of the half-width at given S.
pub(super) type Explicit = [f64; 6];

/// A change of the points p, a, b and of the parameters of the potential.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Change<const P: usize> {
    /// Motion of p relative to c(t) with t held.
    pub relative: Vector<P>,
    /// Change of the axis b − a.
    pub axis: Vector<P>,
    pub explicit: Explicit,
}

/// A point of a rod near a round cone, with the closest point of the cone's axis.
#[derive(Clone, Debug)]
pub(crate) struct ConeCandidate<const P: usize> {
    /// Index of the foundation, sphere of the point, index of the cone.
    pub foundation: usize,
    pub first: usize,
    pub cone: usize,
    /// Length of the rod times share; negative for the first end of the cone alone.
    pub weight: f64,
    /// S, and the radii at both ends of the cone.
    pub surface: f64,
    pub radii: [f64; 2],
    pub axis: Vector<P>,
    pub depth: f64,
    pub found: Closest<P>,
}

/// A point of a rod in contact with a round cone, or tied to it by a strap.
#[derive(Clone, Debug)]
pub(crate) struct ConeContact<const P: usize> {
    /// Index of its foundation.
    pub foundation: usize,
    /// Spheres of p, and of the ends of the cone.
    pub first: usize,
    pub ends: [usize; 2],
    /// The cone; its first end alone where `weight` is negative.
    pub cone: usize,
    /// Multiple of the energy per length: length of the rod times share.
    pub weight: f64,
    pub depth: f64,
    pub t: f64,
    pub normal: Vector<P>,
    pub distance: f64,
    /// The part of the axis across the normal over its square, the gradient of t; zero where t is held.
    slide: Vector<P>,
    /// The axis, its part along the normal, and the change of the radius along it.
    axis: Vector<P>,
    along: f64,
    /// `distance / |across|²`; zero where t is held.
    slip: f64,
    /// Stiffness at t and its first two derivatives.
    k: [f64; 3],
    strip: Strip,
    section: Section,
}

/// Curvature across and half-width.
#[derive(Clone, Copy, Debug)]
struct Section {
    /// S, roundness and crown of the rod.
    surface: f64,
    roundness: f64,
    crown: f64,
    width: f64,
    width_by_surface: f64,
    /// Radius of the cone, its slope along t, share of its second end and that share's slope.
    radius: f64,
    radius_slope: f64,
    share: f64,
    share_slope: f64,
    alignment: f64,
    /// First two derivatives of the curvature along t.
    along: [f64; 2],
}

impl<const P: usize> ConeContact<P> {
    /// The contact of a candidate, at its depth.
    pub fn new(foundation: &Foundation, parameters: &[f64], candidate: &ConeCandidate<P>) -> Self {
        let ConeCandidate { first, surface, depth, axis, radii: [start, stop], ref found, .. } = *candidate;
        let cone = &foundation.cones[candidate.cone];
        let point = first - foundation.first.start;
        let [constant, multiple] = foundation.width(parameters, point);
        let stiffness = foundation.stiffness_at(cone).map(|i| parameters[i]);
        let t = found.t;
        let share = t * t * (3.0 - 2.0 * t);
        let slides = found.slip > 0.0;
        let (slope, bend) = if slides { (6.0 * t * (1.0 - t), 6.0 - 12.0 * t) } else { (0.0, 0.0) };
        let change = stiffness[1] - stiffness[0];
        let taper = stop - start;
        let mut section = Section {
            surface,
            roundness: foundation.roundness,
            crown: foundation.crown,
            width: constant + multiple * surface,
            width_by_surface: multiple,
            radius: start + share * taper,
            radius_slope: slope * taper,
            share,
            share_slope: slope,
            alignment: foundation.alignment,
            along: [0.0; 2],
        };
        let (r, c) = (section.radius, section.alignment);
        let turn = section.radius_slope;
        section.along = [-c / (r * r) * turn, c / (r * r) * (2.0 * turn * turn / r - bend * taper)];
        let scale = if slides { found.slip / found.distance } else { 0.0 };
        Self {
            foundation: candidate.foundation,
            first,
            ends: cone.ends,
            cone: candidate.cone,
            weight: candidate.weight,
            depth,
            t,
            normal: found.normal,
            distance: found.distance,
            slide: found.across * scale,
            axis,
            along: found.normal.dot(&axis),
            slip: found.slip,
            k: [stiffness[0] + share * change, slope * change, bend * change],
            strip: Strip::new(depth, section.curvature(), section.width),
            section,
        }
    }

    /// A taut strap of stiffness k around the cone.
    pub fn of_loop(candidate: &ConeCandidate<P>, ends: [usize; 2], k: f64, stretch: f64) -> Self {
        let found = &candidate.found;
        let scale = if found.slip > 0.0 { found.slip / found.distance } else { 0.0 };
        Self {
            foundation: candidate.foundation,
            first: candidate.first,
            ends,
            cone: candidate.cone,
            weight: 1.0,
            depth: candidate.depth,
            t: found.t,
            normal: found.normal,
            distance: found.distance,
            slide: found.across * scale,
            axis: candidate.axis,
            along: found.normal.dot(&candidate.axis),
            slip: found.slip,
            k: [k, 0.0, 0.0],
            strip: Strip::pulled(stretch),
            section: Section::NONE,
        }
    }

    /// Its energy [J].
    #[inline]
    pub fn energy(&self) -> f64 {
        self.weight * self.k[0] * self.strip.energy
    }

    /// Contact pressure in the middle of the strip [Pa].
    #[inline]
    pub fn pressure(&self) -> f64 {
        self.k[0] * self.depth
    }

    /// Stiffness of the point along the normal [N/m].
    #[inline]
    pub fn stiffness(&self) -> f64 {
        self.weight * self.k[0] * self.strip.depth_depth
    }

    /// Magnitude of the normal force [N].
    #[inline]
    pub fn normal_force(&self) -> f64 {
        self.weight * self.k[0] * self.strip.by_depth
    }

    /// Derivatives of the energy per length with respect to depth and t.
    #[inline]
    fn slopes(&self) -> [f64; 2] {
        let (s, [k, slope, _]) = (&self.strip, self.k);
        [k * s.by_depth, k * s.by_curvature * self.section.along[0] + slope * s.energy]
    }

    /// The gradient of the potential with respect to p.
    #[inline]
    pub fn gradient(&self) -> Vector<P> {
        let [by_depth, by_t] = self.slopes();
        (self.slide * by_t - self.normal * by_depth) * self.weight
    }

    /// The Hessian of the potential with respect to p: [`ConeContact::change_of_gradient`] for motions of p
    /// alone.
    pub fn hessian(&self) -> Matrix<P, P> {
        let (s, n, g) = (&self.strip, &self.normal, &self.slide);
        let ([k, k_t, k_tt], [kappa_t, kappa_tt]) = (self.k, self.section.along);
        let [by_depth, by_t] = self.slopes();
        let depth_t = k * s.depth_curvature * kappa_t + k_t * s.by_depth;
        let t_t = k * (s.curvature_curvature * kappa_t * kappa_t + s.by_curvature * kappa_tt)
            + 2.0 * k_t * s.by_curvature * kappa_t
            + k_tt * s.energy;
        // ∇d = −n, ∇t = g, and for a motion of p, n changes by (1 − n nᵀ − a gᵀ)/‖p − c‖.
        let across = self.axis - *n * self.along;
        let tangential = Matrix::diagonal(1.0) - n.outer(n);
        let bending = (tangential - across.outer(g)) * (by_depth / self.distance);
        let mixed = n.outer(g) + g.outer(n);
        let mut hessian = n.outer(n) * (k * s.depth_depth) - mixed * depth_t + g.outer(g) * t_t - bending;
        if by_t != 0.0 {
            let squared = across.dot(&across);
            let turned = across * (2.0 * self.along) + *n * squared;
            let carried = across * self.along - *n * squared;
            let twist = n.outer(&across) + across.outer(n) + tangential * self.along + carried.outer(g)
                - g.outer(&turned);
            hessian -= twist * (by_t * self.slip / (self.distance * self.distance));
        }
        hessian * self.weight
    }

    /// The changes of depth and t.
    #[inline]
    fn rates(&self, Change { relative, axis, explicit }: &Change<P>) -> [f64; 2] {
        let n = &self.normal;
        let [a, b] = RADII.map(|i| explicit[i]);
        let across = self.axis - *n * self.along;
        let depth = explicit[SURFACE] + (1.0 - self.t) * a + self.t * b - n.dot(relative);
        let slide = -n.dot(axis) - across.dot(relative) / self.distance + a - b;
        [depth, -slide * self.slip]
    }

    /// The change of the stiffness at t.
    #[inline]
    fn change_of_stiffness(&self, t: f64, explicit: &Explicit) -> f64 {
        let [start, stop] = STIFFNESS.map(|i| explicit[i]);
        self.k[1] * t + start + self.section.share * (stop - start)
    }

    /// The change of the depth.
    pub fn change_of_depth(&self, change: &Change<P>) -> f64 {
        self.rates(change)[0]
    }

    /// The change of the normal.
    pub fn change_of_normal(&self, change: &Change<P>) -> Vector<P> {
        let [_, t] = self.rates(change);
        let sideways = change.relative - self.normal * self.normal.dot(&change.relative);
        (sideways - (self.axis - self.normal * self.along) * t) * (1.0 / self.distance)
    }

    /// The change of [`ConeContact::stiffness`], its weight held.
    pub fn change_of_stiffness_of_point(&self, change: &Change<P>) -> f64 {
        let (section, explicit) = (&self.section, &change.explicit);
        let [depth, t] = self.rates(change);
        let width = section.width_by_surface * explicit[SURFACE] + explicit[WIDTH];
        let radii = RADII.map(|i| explicit[i]);
        let [kappa, _] = section.change_of_curvature(explicit[SURFACE], radii, width);
        let [by_depth, by_curvature, by_width] =
            Strip::slopes_of_stiffness(self.depth, section.curvature(), section.width);
        let strip = by_depth * depth + by_curvature * (kappa + section.along[0] * t) + by_width * width;
        let stiffness = self.change_of_stiffness(t, explicit);
        self.weight * (self.k[0] * strip + stiffness * self.strip.depth_depth)
    }

    /// The change of [`ConeContact::pressure`].
    pub fn change_of_pressure(&self, change: &Change<P>) -> f64 {
        let [depth, t] = self.rates(change);
        self.k[0] * depth + self.change_of_stiffness(t, &change.explicit) * self.depth
    }

    /// Tension of a loop, a force that pulls.
    pub fn tension(&self) -> f64 {
        -self.normal_force()
    }

    /// The change of [`ConeContact::tension`] of a loop.
    pub fn change_of_tension(&self, change: &Change<P>) -> f64 {
        let [depth, t] = self.rates(change);
        let stiffness = self.change_of_stiffness(t, &change.explicit);
        -self.weight * (self.k[0] * depth + stiffness * self.strip.by_depth)
    }

    /// The change of [`ConeContact::gradient`], its weight held.
    pub fn change_of_gradient(&self, change: &Change<P>) -> Vector<P> {
        let (s, section, n) = (&self.strip, &self.section, &self.normal);
        let [k, k_t, k_tt] = self.k;
        let [kappa_t, kappa_tt] = section.along;
        let [by_depth, by_t] = self.slopes();
        let Change { relative, axis, explicit } = change;

        // Explicit changes at fixed depth and t.
        let [a, b] = RADII.map(|i| explicit[i]);
        let width = section.width_by_surface * explicit[SURFACE] + explicit[WIDTH];
        let [kappa, kappa_slope] = section.change_of_curvature(explicit[SURFACE], [a, b], width);
        let [start, stop] = STIFFNESS.map(|i| explicit[i]);
        let (dk, dk_t) = (start + section.share * (stop - start), section.share_slope * (stop - start));
        let held_depth = dk * s.by_depth + k * (s.depth_curvature * kappa + s.depth_width * width);
        let held_t = dk * s.by_curvature * kappa_t
            + k * (s.curvature_curvature * kappa + s.curvature_width * width) * kappa_t
            + k * s.by_curvature * kappa_slope
            + dk_t * s.energy
            + k_t * (s.by_curvature * kappa + s.by_width * width);

        // The change of depth and t, and of their gradients.
        let [depth, t] = self.rates(change);
        let away = n.dot(relative);
        let sideways = *relative - *n * away;
        let across = self.axis - *n * self.along;
        let of_normal = (sideways - across * t) * (1.0 / self.distance);
        let mut of_slide = Vector::ZERO;
        if self.slip > 0.0 {
            let squared = across.dot(&across);
            let per = 1.0 / (self.distance * self.distance);
            let turned = (2.0 * self.distance * across.dot(axis)
                - 2.0 * self.along * across.dot(relative)
                - squared * away)
                * per;
            let tilted = *axis - *n * n.dot(axis);
            let mixed = tilted * (-1.0 / self.distance)
                + (*n * across.dot(relative) + across * away + sideways * self.along) * per;
            let carried = (across * self.along - *n * squared) * (per * t);
            of_slide = (mixed + carried + self.slide * turned) * -self.slip;
        }

        let depth_t = k * s.depth_curvature * kappa_t + k_t * s.by_depth;
        let t_t = k * (s.curvature_curvature * kappa_t * kappa_t + s.by_curvature * kappa_tt)
            + 2.0 * k_t * s.by_curvature * kappa_t
            + k_tt * s.energy;
        let on_normal = k * s.depth_depth * depth + depth_t * t + held_depth;
        let on_slide = depth_t * depth + t_t * t + held_t;
        (self.slide * on_slide + of_slide * by_t - *n * on_normal - of_normal * by_depth) * self.weight
    }
}

impl Section {
    /// Placeholder for potentials that do not depend on it.
    const NONE: Self = Self {
        surface: 1.0,
        roundness: 0.0,
        crown: 0.0,
        width: 1.0,
        width_by_surface: 0.0,
        radius: 1.0,
        radius_slope: 0.0,
        share: 0.0,
        share_slope: 0.0,
        alignment: 0.0,
        along: [0.0; 2],
    };

    #[inline]
    fn curvature(&self) -> f64 {
        let crown = if self.roundness > 0.0 { 0.0 } else { 2.0 * self.crown / (self.width * self.width) };
        self.roundness / self.surface + self.alignment / self.radius + crown
    }

    /// Changes of the curvature and of its slope along t, with S, the radii and the half-width.
    fn change_of_curvature(&self, surface: f64, [a, b]: [f64; 2], width: f64) -> [f64; 2] {
        let (r, c) = (self.radius, self.alignment);
        let radius = a + self.share * (b - a);
        let crown = if self.roundness > 0.0 { 0.0 } else { -4.0 * self.crown / self.width.powi(3) };
        let value =
            -self.roundness / (self.surface * self.surface) * surface - c / (r * r) * radius + crown * width;
        let slope = c / (r * r) * (2.0 * self.radius_slope / r * radius - self.share_slope * (b - a));
        [value, slope]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hessian_is_the_change_of_the_gradient_for_motions_of_the_point() {
        for (t, slip) in [(0.4, 0.7), (0.0, 0.0)] {
            let normal = Vector([0.6, 0.0, 0.8]);
            let axis = Vector([0.3, 1.1, -0.2]);
            let along = normal.dot(&axis);
            let across = axis - normal * along;
            let distance = 0.9;
            let section = Section { along: [3.0, -7.0], ..Section::NONE };
            let contact = ConeContact {
                foundation: 0,
                first: 0,
                ends: [1, 2],
                cone: 0,
                weight: 0.3,
                depth: 0.02,
                t,
                normal,
                distance,
                slide: across * (slip / distance),
                axis,
                along,
                slip,
                k: [5.0, 2.0, -4.0],
                strip: Strip::new(0.02, 30.0, 0.5),
                section,
            };
            let hessian = contact.hessian();
            for i in 0..3 {
                let relative = Vector::unit(i);
                let change = Change { relative, axis: Vector::ZERO, explicit: [0.0; 6] };
                let column = contact.change_of_gradient(&change);
                let error = (hessian.column(i) - column).norm();
                assert!(error < 1e-13 * column.norm(), "{error} {i} {t}");
            }
        }
    }
}
