//! Interactions between points: contacts, springs, point loads.

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
}

impl Contact {
    pub fn is_self(&self) -> bool {
        self.first == self.second
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
