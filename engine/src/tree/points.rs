//! Material points: sphere centres, masses, points of attachment.

use super::Between;
use crate::linalg::Vector;

/// A point fixed in a frame; its local position may depend on the design.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Point<const P: usize> {
    /// Between sample points it depends on the design, and this is the rod's base.
    pub frame: usize,
    pub place: Place,
    /// The first of three parameters that hold a further part of the local position.
    pub offset: Option<usize>,
    /// Multiple of the body's radius there that is added.
    pub surface: Option<(SphereRadius, Vector<P>)>,
}

/// The design-dependent part of a point's local position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place {
    /// Nothing.
    Frame,
    /// A fraction of the link's length along x (body index).
    Fraction(usize, f64),
    /// The centroid of the link (body index).
    Centroid(usize),
    /// A fraction of the link's length along x (body index), which is this parameter.
    Along(usize, usize),
    /// A place between sample points, as carried by the one before it (0) or after it (1).
    Between(Between, usize),
}

/// A contact sphere.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sphere {
    pub point: usize,
    pub radius: SphereRadius,
}

impl Sphere {
    /// Whether it is on a rod, and not on a link.
    pub fn is_on_rod(&self) -> bool {
        !matches!(self.radius, SphereRadius::Link(..))
    }
}

/// The source of a sphere's radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SphereRadius {
    /// This parameter.
    Parameter(usize),
    /// The link's radius at the sphere's place.
    Link(usize, Place),
    /// The rod's radius at the sample point before (0) or after (1) a place.
    Between(Between, usize),
}
