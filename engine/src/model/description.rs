//! The description of a model, as plain data: the input of [`Model::new`](super::Model::new).
//!
//! SI units throughout. Bodies are named; a parent is an earlier body or the world.

pub use crate::forces::actuator::{ActuatorDescription, ActuatorKind};
pub use crate::forces::contact::{ContactDescription, RoundConeDescription};
pub use crate::forces::fibres::{
    FibreDescription, FibreRodDescription, FibreSectionDescription, Law, MaterialDescription,
};
pub use crate::forces::foundation::{FoundationDescription, StrapLoopDescription};
pub use crate::forces::friction::FrictionDescription;
pub use crate::forces::joint_coupling::JointCouplingDescription;
pub use crate::forces::joint_torque::{JointTorqueDescription, TorqueCurve};
pub use crate::forces::obstacle::{ObstacleDescription, ObstacleSkinDescription, SurfaceDescription};
pub use crate::forces::pressure::PressureDescription;
pub use crate::forces::spring::SpringDescription;
pub use crate::forces::tendon::{
    GuideDescription, MuscleCurve, StageDescription, TendonDescription, TensionDescription, WrapDescription,
};
pub use crate::forces::tie::{TieDescription, TieDrive, TieKind};
pub use crate::forces::wrench::{WrenchDescription, WrenchFrame};
pub use crate::tree::description::*;

use serde::Deserialize;

/// A whole system.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Description {
    /// Whether the system lives in the x–z plane.
    pub planar: bool,
    /// Gravitational acceleration [m/s²].
    pub gravity: [f64; 3],
    /// Whether there may be gravity though there is none here.
    #[serde(default)]
    pub weighs: bool,
    /// Bodies, parents before children.
    pub bodies: Vec<BodyDescription>,
    /// Named groups of spheres.
    #[serde(default)]
    pub spheres: Vec<SphereGroupDescription>,
    /// Contacts between groups.
    #[serde(default)]
    pub contacts: Vec<ContactDescription>,
    /// Contacts of rods with links through elastic foundations.
    #[serde(default)]
    pub foundations: Vec<FoundationDescription>,
    /// Straps around links.
    #[serde(default)]
    pub loops: Vec<StrapLoopDescription>,
    /// What spheres press on.
    #[serde(default)]
    pub obstacles: Vec<ObstacleDescription>,
    /// Friction in contacts, in foundations and on obstacles.
    #[serde(default)]
    pub frictions: Vec<FrictionDescription>,
    /// Chambers and cables.
    #[serde(default)]
    pub actuators: Vec<ActuatorDescription>,
    /// Materials of sections of fibres.
    #[serde(default)]
    pub materials: Vec<MaterialDescription>,
    /// Rods whose sections are fibres.
    #[serde(default)]
    pub fibres: Vec<FibreRodDescription>,
    /// Cavities under pressure.
    #[serde(default)]
    pub pressures: Vec<PressureDescription>,
    /// Load inputs that drive several forces.
    #[serde(default)]
    pub shared_inputs: Vec<SharedInputDescription>,
    /// Names of the chambers and cables controlled by their length and of the pressures controlled by the
    /// volume of their cavity: their loads are changes of these from the reference state.
    #[serde(default)]
    pub controls: Vec<String>,
    /// Passive torques of joints.
    #[serde(default)]
    pub joint_torques: Vec<JointTorqueDescription>,
    /// Joints that move together.
    #[serde(default)]
    pub joint_couplings: Vec<JointCouplingDescription>,
    /// Springs and straps.
    #[serde(default)]
    pub springs: Vec<SpringDescription>,
    /// Tendons across bodies.
    #[serde(default)]
    pub tendons: Vec<TendonDescription>,
    /// What tendons wrap around.
    #[serde(default)]
    pub wraps: Vec<WrapDescription>,
    /// Point loads.
    #[serde(default)]
    pub wrenches: Vec<WrenchDescription>,
    /// Joints that close loops.
    #[serde(default)]
    pub ties: Vec<TieDescription>,
}
