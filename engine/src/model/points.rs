//! Material points: sphere centres, masses, ends of springs.

use crate::linalg::Vector;

/// A point fixed in a frame; its local position may depend on the design.
#[derive(Clone, Debug)]
pub(crate) struct Point<const P: usize> {
    pub frame: usize,
    pub place: Place,
    /// Constant part of the local position.
    pub offset: Vector<P>,
}

/// What the design adds to a point's local position.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Place {
    /// Nothing.
    Frame,
    /// A fraction of the link's length along x (body index).
    Fraction(usize, f64),
    /// The centroid of the link (body index).
    Centroid(usize),
}

/// A contact sphere.
#[derive(Clone, Debug)]
pub(crate) struct Sphere {
    pub point: usize,
    pub radius: SphereRadius,
}

/// Where a sphere's radius comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SphereRadius {
    /// This parameter.
    Parameter(usize),
    /// The link's radius at the sphere's place.
    Link(usize, Place),
}

/// A point mass of a rod's Gauss point or a link's centroid.
#[derive(Clone, Debug)]
pub(crate) enum Mass {
    /// (point, rod, Gauss point)
    Rod(usize, usize, usize),
    /// (point, body)
    Link(usize, usize),
}

impl Mass {
    pub fn point(&self) -> usize {
        match self {
            Mass::Rod(point, ..) | Mass::Link(point, _) => *point,
        }
    }
}
