//! The description of a tree of bodies, as plain data.

use crate::strain::{BasisKind, Mode};
use serde::Deserialize;

/// A body with the joint that carries it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyDescription {
    /// Unique name.
    pub name: String,
    /// The body at whose tip this one is attached; the world when absent.
    pub parent: Option<String>,
    /// Pose of the joint in the parent's tip frame.
    pub placement: PlacementDescription,
    /// The joint.
    pub joint: JointDescription,
    /// Rod or link.
    pub shape: ShapeDescription,
}

/// A constant pose.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlacementDescription {
    /// Translation [m].
    pub translation: [f64; 3],
    /// Rotation vector [rad].
    pub rotation: [f64; 3],
}

/// The kinds of joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// No freedom.
    Fixed,
    /// Rotation about `axis`.
    Revolute,
    /// Translation along `axis`.
    Prismatic,
    /// Rotation about the local y axis, then about the local z axis.
    Universal,
    /// Rotation vector.
    Spherical,
    /// Exponential coordinates of the whole group.
    Free,
}

/// A joint with stiffness, rest position and limits for each of its coordinates.
///
/// Lists may be empty: no stiffness, rest at zero, no limits.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointDescription {
    /// Kind of joint.
    pub kind: JointKind,
    /// Axis of a revolute or prismatic joint, a unit vector in the joint frame.
    #[serde(default)]
    pub axis: [f64; 3],
    /// Stiffness [N·m/rad or N/m].
    #[serde(default)]
    pub stiffness: Vec<f64>,
    /// Rest position [rad or m].
    #[serde(default)]
    pub rest: Vec<f64>,
    /// Lower limits.
    #[serde(default)]
    pub lower: Vec<Option<f64>>,
    /// Upper limits.
    #[serde(default)]
    pub upper: Vec<Option<f64>>,
    /// Stiffness beyond a limit [N·m/rad or N/m].
    #[serde(default)]
    pub limit_stiffness: f64,
    /// Width over which the limit's stiffness builds up [rad or m].
    #[serde(default)]
    pub limit_width: f64,
}

/// The two kinds of body.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShapeDescription {
    /// A Cosserat rod.
    Rod(RodDescription),
    /// A rigid link.
    Link(LinkDescription),
}

/// Cross-sections; S(X) is half the thickness along the local z axis.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Section {
    /// A disc of radius S.
    Circular,
    /// Semi-axes `ratio · S` along y and S along z.
    Elliptic {
        /// Width over thickness.
        ratio: f64,
    },
    /// Half-sides `ratio · S` along y and S along z.
    Rectangular {
        /// Width over thickness.
        ratio: f64,
    },
    /// Fibres of materials, described apart; then moduli and density of the rod are not used.
    Fibres,
}

/// A strain mode of a rod and its basis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StrainDescription {
    /// The mode.
    pub mode: Mode,
    /// Family of its basis.
    pub basis: BasisKind,
    /// Degree of the global families.
    #[serde(default)]
    pub order: usize,
}

fn one() -> usize {
    1
}

/// A Cosserat rod along its local x axis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RodDescription {
    /// Length L [m].
    pub length: f64,
    /// Cross-section.
    pub section: Section,
    /// Active strain modes.
    pub strain: Vec<StrainDescription>,
    /// Elements for piecewise bases and quadrature.
    pub elements: usize,
    /// Intervals into which the last element is divided for quadrature.
    #[serde(default = "one")]
    pub tip_intervals: usize,
    /// Gauss points per element, or interval.
    pub gauss_points: usize,
    /// Order of the Magnus step: 2 or 4.
    pub magnus_order: usize,
    /// Young's modulus [Pa].
    pub young_modulus: f64,
    /// Shear modulus [Pa].
    pub shear_modulus: f64,
    /// Density [kg/m³].
    pub density: f64,
    /// Strain ξ* of the unloaded rod: curvatures [1/m], then linear strains (1, 0, 0 when straight).
    pub reference_strain: [f64; 6],
    /// S at the sample points [m].
    pub radius: Vec<f64>,
    /// dS/dX at the sample points [m], X ∈ [0, 1].
    pub slope: Vec<f64>,
}

/// A rigid link along its local x axis, a cone frustum.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkDescription {
    /// Length [m].
    pub length: f64,
    /// Radius at the joint [m].
    pub radius_base: f64,
    /// Radius at the tip [m].
    pub radius_tip: f64,
    /// Density [kg/m³].
    pub density: f64,
}

/// A place along a body.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Station {
    /// A sample point of a rod.
    Point(usize),
    /// A fraction of a link's length.
    Fraction(f64),
    /// A fraction of a rod's length, at a sample point or between two; for the first end of a spring.
    Along(f64),
    /// The centroid of a link.
    Centroid,
}

/// A named group of spheres.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereGroupDescription {
    /// Unique name.
    pub name: String,
    /// Spheres; each takes its radius from the body at its station.
    pub spheres: Vec<SphereDescription>,
}

/// A load input that drives several forces.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SharedInputDescription {
    /// Unique name.
    pub name: String,
    /// Names of the forces, each of which is an input of its own otherwise.
    pub drives: Vec<String>,
}

/// A sphere.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereDescription {
    /// The body that carries it.
    pub body: String,
    /// Where along the body.
    pub station: Station,
}

/// One end of a spring, or the place of a point load.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, deny_unknown_fields)]
pub enum AttachmentDescription {
    /// A point fixed in the world [m].
    World {
        /// Its position.
        world: [f64; 3],
    },
    /// A point fixed in a body.
    Body {
        /// The body.
        body: String,
        /// Where along it.
        station: Station,
        /// Offset from there, in the local frame [m].
        #[serde(default)]
        offset: [f64; 3],
        /// Further offset, in multiples of the body's radius there.
        #[serde(default)]
        surface: [f64; 3],
    },
}
