//! Passive torques of joints that are no linear springs: published curves, tables, stiffness that sets in at
//! an angle.

mod curve;

pub use curve::TorqueCurve;

use super::element::{ForceElement, ForceMemory, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::state::State;
use super::terms::Terms;
use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::tree::{ModelError, Tree};
use serde::Deserialize;
use std::ops::Range;

/// A torque on one coordinate of a joint.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointTorqueDescription {
    /// Unique name.
    pub name: String,
    /// The body with the joint.
    pub body: String,
    /// The coordinate, such as `theta`.
    pub coordinate: String,
    /// The torque.
    pub curve: TorqueCurve,
}

#[derive(Clone, Debug, PartialEq)]
struct JointTorque {
    dof: usize,
    curve: TorqueCurve,
    /// Parameters that hold the curve's numbers.
    numbers: Range<usize>,
}

/// All such torques.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JointTorques(Vec<JointTorque>);

impl JointTorques {
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        torques: &[JointTorqueDescription],
    ) -> Result<Self, ModelError> {
        let mut built = vec![];
        for torque in torques {
            let field = |f: &str| format!("torques.{}.{f}", torque.name);
            let dof = tree.joint_coordinate(&field("coordinate"), &torque.body, &torque.coordinate)?;
            if let Some(problem) = torque.curve.problem() {
                return Err(ModelError::new(field("curve"), problem));
            }
            let start = tree.parameters.len();
            for (what, unit, values) in torque.curve.numbers() {
                tree.slot(format!("{}.{what}", torque.name), unit, &values);
            }
            let numbers = start..tree.parameters.len();
            built.push(JointTorque { dof, curve: torque.curve.without_numbers(), numbers });
        }
        Ok(Self(built))
    }
}

impl<const P: usize> ForceMemory<P> for JointTorques {
    type Design = ();
    type State = ();
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for JointTorques {
    fn design(&self, _: &Tree<G, D, P>) {}

    fn state(&self, _: &Tree<G, D, P>) {}

    fn add_elastic_stiffness(
        &self,
        _: &Tree<G, D, P>,
        geometry: &Geometry<G, D, P>,
        _: &(),
        stiffness: &mut [f64],
    ) {
        for torque in &self.0 {
            let at_rest = torque.curve.at(&geometry.parameters[torque.numbers.clone()], 0.0);
            stiffness[torque.dof] += at_rest.stiffness.max(0.0);
        }
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        _: &(),
        _: &mut (),
        Terms { coordinates: out, .. }: &mut Terms<D>,
    ) {
        for torque in &self.0 {
            let found = torque.curve.at(&at.parameters()[torque.numbers.clone()], at.q[torque.dof]);
            out.energy += found.energy;
            out.gradient[torque.dof] += found.torque;
        }
    }

    fn add_tangent(&self, at: &State<G, D, P>, _: &(), _: &(), out: &mut Terms<D>) {
        for torque in &self.0 {
            let found = torque.curve.at(&at.parameters()[torque.numbers.clone()], at.q[torque.dof]);
            out.coordinates.add_diagonal(torque.dof, found.stiffness);
        }
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, _: &(), _: &(), out: &mut Magnitudes<P>) {
        for torque in &self.0 {
            let found = torque.curve.at(&at.parameters()[torque.numbers.clone()], at.q[torque.dof]);
            out.add(torque.dof, found.torque);
        }
    }

    fn is_admissible(&self, parameters: &[f64]) -> bool {
        self.0.iter().all(|torque| torque.curve.is_admissible(&parameters[torque.numbers.clone()]))
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        _: &(),
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        for torque in &self.0 {
            let (numbers, factor) = (torque.numbers.clone(), motion.coordinates[torque.dof]);
            let p = &at.parameters()[numbers.clone()];
            torque.curve.add_slopes(p, at.q[torque.dof], factor, &mut gradient[numbers]);
        }
    }
}
