//! Joints of arbitrary rotation beyond half a turn: their coordinates, a rotation vector, are singular at a full
//! turn. The vector of the same rotation the other way round is taken in time.

use super::system::System;
use crate::lie::LieGroup;
use crate::tree::Motion;
use std::f64::consts::{PI, TAU};

/// Length of a rotation vector from which its other one is taken [rad].
const TURN_BACK: f64 = 1.25 * PI;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> System<'_, G, D, P> {
    /// Replaces rotation vectors beyond [`TURN_BACK`] on which no stiffness acts; whether there were any.
    pub(super) fn turn_back_rotations(&mut self) -> bool {
        let model = self.model();
        let mut q = self.state().to_vec();
        for frame in &model.frames {
            let Motion::Joint(columns) = &frame.motion else { continue };
            let dofs: Vec<usize> = model.joint_columns[columns.clone()].iter().map(|c| c.dof).collect();
            let free = |dof: &usize| {
                let parameters = &self.data().design.geometry.parameters;
                let of_joint = model.joints.iter().find(|joint| joint.dof == *dof);
                of_joint
                    .is_some_and(|of| of.angular && of.limits.is_none() && parameters[of.stiffness] == 0.0)
            };
            let angle = dofs.iter().map(|dof| q[*dof] * q[*dof]).sum::<f64>().sqrt();
            if dofs.len() == 3 && angle > TURN_BACK && dofs.iter().all(free) {
                dofs.iter().for_each(|dof| q[*dof] *= 1.0 - TAU / angle);
            }
        }
        let turned = q != self.state();
        if turned {
            self.set_state(&q);
        }
        turned
    }
}
