//! The forces that act on a tree of bodies, one file each.
//!
//! A force is either a function of the coordinates themselves (elasticity, joint limits, chambers) or
//! of the poses of frames (contact, gravity, springs, tendons, point loads). The latter report world-frame
//! wrenches and stiffness forms, which the assembly turns into residual and tangent.

pub(crate) mod actuator;
pub(crate) mod contact;
pub(crate) mod crossing;
pub(crate) mod differential;
pub(crate) mod elasticity;
pub(crate) mod element;
pub(crate) mod fibres;
pub(crate) mod foundation;
pub(crate) mod friction;
pub(crate) mod gravity;
pub(crate) mod joint;
pub(crate) mod joint_coupling;
pub(crate) mod joint_torque;
pub(crate) mod magnitudes;
mod moments;
pub(crate) mod obstacle;
pub(crate) mod pressure;
pub(crate) mod spring;
pub(crate) mod state;
pub(crate) mod tendon;
pub(crate) mod terms;
pub(crate) mod tie;
pub(crate) mod wrench;
