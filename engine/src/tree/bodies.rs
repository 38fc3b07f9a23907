//! Bodies, joints and rods of the tree.

use std::ops::Range;

/// A body of the tree.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Body<const P: usize> {
    pub name: String,
    /// Index in `geometry.rigid` of its placement.
    pub placement: usize,
    /// Parameters of the placement.
    pub translation: Range<usize>,
    pub rotation: Range<usize>,
    /// The frame after the joint: X = 0.
    pub base_frame: usize,
    /// The frame at which children are attached.
    pub tip_frame: usize,
    pub shape: Shape,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Shape {
    /// Index in `tree.rods`.
    Rod(usize),
    Link(Link),
}

/// A rigid link: the positions of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Link {
    /// Index in `geometry.rigid` of the step from joint to tip.
    pub tip: usize,
    pub length: usize,
    pub radius_base: usize,
    pub radius_tip: usize,
    pub density: usize,
}

/// A coordinate of a joint: the positions of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JointCoordinate {
    pub dof: usize,
    /// Whether it is an angle.
    pub angular: bool,
    pub stiffness: usize,
    pub rest: usize,
    pub limits: Option<JointLimits>,
}

/// Limits of a coordinate of a joint: the positions of their parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointLimits {
    pub lower: Option<usize>,
    pub upper: Option<usize>,
    pub stiffness: usize,
    pub width: usize,
}

/// A rod: bases at its Gauss points and the positions of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rod {
    /// The first of four parameters that hold the factors of its section; none of fibres.
    pub factors: Option<usize>,
    /// Parameters holding its strain in the reference state, by mode.
    pub reference_strain: Range<usize>,
    pub dofs: Range<usize>,
    /// Sample points X.
    pub x: Vec<f64>,
    pub gauss: Vec<GaussPoint>,
    /// Contributions to the stiffness.
    pub entries: Vec<SectionEntry>,
    /// Order of the Magnus step: 2 or 4.
    pub magnus_order: usize,
    pub length: usize,
    pub radius: Range<usize>,
    pub slope: Range<usize>,
    pub young_modulus: usize,
    pub shear_modulus: usize,
    pub density: usize,
    /// Of a section of fibres, at each Gauss point: parameter holding the first coefficient of the mass
    /// per length and its moments.
    pub masses: Vec<usize>,
    /// Coordinates of angular modes; the rest are linear strains.
    pub angular: Vec<bool>,
}

/// A Gauss point of a rod.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GaussPoint {
    /// Index of its sample point.
    pub point: usize,
    pub weight: f64,
    /// Basis functions: (coordinate, mode index, value).
    pub columns: Vec<(usize, usize, f64)>,
}

/// `weight · φ_i φ_j` of one Gauss point and mode, into one entry of the stiffness.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SectionEntry {
    pub gauss: usize,
    pub mode: usize,
    /// Index in `tree.stiffness_pattern`.
    pub entry: usize,
    pub value: f64,
}
