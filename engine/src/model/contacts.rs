//! Interactions between points: contacts, springs, point loads.

use super::Sphere;
use crate::linalg::Vector;
use std::ops::Range;

/// Contact between two groups of spheres.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    /// Spheres of the first group.
    pub first: Range<usize>,
    /// Spheres of the second group.
    pub second: Range<usize>,
    /// For self-contact, the smallest index distance that counts.
    pub skip: usize,
    /// Which spheres of the first group form its tip.
    pub tip: Vec<bool>,
    /// Parameter holding k.
    pub stiffness: usize,
    /// What the spheres of the first group touch, when it is not the second group's spheres.
    pub cones: Vec<RoundCone>,
    /// Shares of k of the first group's spheres; empty: one each.
    pub weights: Vec<f64>,
    /// Parameters holding the lengths that multiply the shares; empty when k is not per length.
    pub lengths: Vec<usize>,
    /// Of the second group's spheres in blocks, where these are many.
    pub balls: Range<usize>,
}

/// The convex hull of two spheres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoundCone {
    pub ends: [usize; 2],
    /// Whether its first end is that where the one before it ends.
    pub joined: bool,
}

impl Contact {
    pub fn is_self(&self) -> bool {
        self.first == self.second
    }

    /// The centres of the second group's spheres: these are points one after another.
    #[inline]
    pub fn second_centres<'a, const P: usize>(
        &self,
        spheres: &[Sphere],
        points: &'a [Vector<P>],
    ) -> &'a [Vector<P>] {
        let start = spheres.get(self.second.start).map_or(0, |s| s.point);
        &points[start..start + self.second.len()]
    }

    /// What multiplies k for a sphere of the first group.
    #[inline]
    pub fn weight(&self, parameters: &[f64], first: usize) -> f64 {
        let i = first - self.first.start;
        let share = self.weights.get(i).copied().unwrap_or(1.0);
        share * self.lengths.get(i).map_or(1.0, |l| parameters[*l])
    }
}

/// A linear spring between two points.
#[derive(Clone, Debug)]
pub(crate) struct Spring {
    pub ends: [usize; 2],
    pub stiffness: usize,
    pub rest_length: usize,
    pub slack: bool,
}

/// A force and moment at a point.
#[derive(Clone, Debug)]
pub(crate) struct Wrench<const P: usize> {
    pub point: usize,
    pub force: Vector<P>,
    /// Only the components that the group can turn about.
    pub moment: [f64; 3],
    pub follower: bool,
    /// Load input that scales it.
    pub input: Option<usize>,
    /// Slot of the kept Jacobian of its frame.
    pub frame: usize,
}

impl<const P: usize> Wrench<P> {
    /// A dead force has a potential; followers have none, and a dead moment only in the plane.
    pub fn is_conservative(&self) -> bool {
        !self.follower && (P == 2 || self.moment == [0.0; 3])
    }
}
