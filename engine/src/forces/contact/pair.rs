//! A pair in contact and its derivatives.
//!
//! Its energy is ½ k w d₊² with d = R + r(t) − ‖p − c(t)‖: a sphere at p of radius R overlaps the solid
//! around c(t) = (1 − t) a + t b with r(t) = (1 − t) r_a + t r_b by d, where t maximises d.
//! For two spheres a = b. First derivatives hold t (it is a maximum); second derivatives follow it.

use super::super::state::Law;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tolerances::COINCIDENT;
use crate::tree::Tree;

/// A sphere of the first group that overlaps a sphere or round cone of the second.
#[derive(Clone, Debug)]
pub(crate) struct ContactPair<const P: usize> {
    pub first: usize,
    /// The spheres at its ends between which the solid is touched; one twice if it is touched there.
    pub second: [usize; 2],
    pub t: f64,
    /// Unit vector from c(t) to p.
    pub normal: Vector<P>,
    pub overlap: f64,
    /// ‖p − c(t)‖.
    pub distance: f64,
    /// The part of b − a across the normal.
    pub across: Vector<P>,
    /// `distance / |across|²` where t moves with the points, zero where it does not.
    pub slip: f64,
    /// Multiple of k.
    pub weight: f64,
}

/// The force of a pair as an unknown of its own, see [`Law`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct KeptForce {
    first: usize,
    second: [usize; 2],
    force: f64,
}

impl KeptForce {
    pub fn new<const P: usize>(pair: &ContactPair<P>, force: f64) -> Self {
        Self { first: pair.first, second: pair.second, force }
    }
}

/// Changes of the three points of a pair: p, a, b.
pub(crate) type Motion<const P: usize> = [Vector<P>; 3];

impl<const P: usize> ContactPair<P> {
    /// Spheres whose centres are `distance` apart, the sum of their radii being `reach`.
    #[inline]
    pub fn of_spheres(
        [first, second]: [usize; 2],
        normal: Vector<P>,
        reach: f64,
        distance: f64,
        weight: f64,
    ) -> Self {
        Self {
            first,
            second: [second; 2],
            t: 0.0,
            normal,
            overlap: reach - distance,
            distance,
            across: Vector::ZERO,
            slip: 0.0,
            weight,
        }
    }

    /// Whether a force of this pair is kept, possibly at another point of the same solid.
    pub fn is_among<'a>(&self, mut kept: impl Iterator<Item = &'a KeptForce>) -> bool {
        kept.any(|force| self.has(force))
    }

    /// Applies the kept force, if the law says so; `k` is the stiffness. `false` if the pair does not act.
    pub fn take_force<'a>(
        &mut self,
        law: Law,
        k: f64,
        mut kept: impl Iterator<Item = &'a KeptForce>,
    ) -> bool {
        let found = kept.find(|force| self.has(force));
        if found.is_none() && self.overlap <= 0.0 {
            return false;
        }
        if law == Law::Kept && k != 0.0 {
            self.overlap = found.map_or(0.0, |kept| kept.force / k);
        }
        true
    }

    fn has(&self, kept: &KeptForce) -> bool {
        self.first == kept.first
            && (self.weight < 0.0) == (kept.force < 0.0)
            && self.second.iter().any(|end| kept.second.contains(end))
    }

    /// Indices of the points p, a, b.
    #[inline]
    pub fn points<G: LieGroup<D, P>, const D: usize>(&self, tree: &Tree<G, D, P>) -> [usize; 3] {
        [self.first, self.second[0], self.second[1]].map(|s| tree.spheres[s].point)
    }

    /// The values at p, a, b.
    #[inline]
    pub fn motion<G: LieGroup<D, P>, const D: usize>(
        &self,
        tree: &Tree<G, D, P>,
        of_points: &[Vector<P>],
    ) -> Motion<P> {
        self.points(tree).map(|i| of_points[i])
    }

    /// The velocity of p relative to the material at c(t).
    #[inline]
    pub fn relative(&self, [p, a, b]: &Motion<P>) -> Vector<P> {
        *p - *a * (1.0 - self.t) - *b * self.t
    }

    /// The distance that determines the curvature across the normal. For concentric spheres it is bounded,
    /// so that the curvature is as negative as nearby and they separate in any possible direction.
    #[inline]
    pub fn curvature_radius(&self) -> f64 {
        self.distance.max(COINCIDENT * (self.distance + self.overlap))
    }

    /// The change of d.
    #[inline]
    pub fn closing(&self, motion: &Motion<P>) -> f64 {
        -self.normal.dot(&self.relative(motion))
    }

    /// The mixed derivative of ‖p − c(t)‖ − r(t) with respect to t and along the motion.
    #[inline]
    pub fn slide(&self, motion: &Motion<P>) -> f64 {
        let turning = self.normal.dot(&(motion[2] - motion[1]));
        -self.across.dot(&self.relative(motion)) / self.distance - turning
    }

    /// The change of the unit vector from c(t) to p.
    #[inline]
    pub fn turning(&self, motion: &Motion<P>) -> Vector<P> {
        let moved = self.relative(motion);
        let sideways = moved - self.normal * self.normal.dot(&moved);
        (sideways + self.across * (self.slide(motion) * self.slip)) * (1.0 / self.distance)
    }

    /// The second derivative of d along two motions.
    #[inline]
    pub fn curvature(&self, one: &Motion<P>, other: &Motion<P>) -> f64 {
        let (x, y) = (self.relative(one), self.relative(other));
        let sideways = x.dot(&y) - self.normal.dot(&x) * self.normal.dot(&y);
        self.slide(one) * self.slide(other) * self.slip - sideways / self.distance
    }

    /// Derivatives of d with respect to the radii at p, a, b.
    #[inline]
    pub fn by_radii(&self) -> [f64; 3] {
        [1.0, 1.0 - self.t, self.t]
    }

    /// What the radii at p, a, b add to [`ContactPair::slide`].
    #[inline]
    pub fn slide_by_radii(&self) -> [f64; 3] {
        [0.0, 1.0, -1.0]
    }
}
