//! One design: quantities that depend on the parameters but not on the state.

use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::model::{Designs, Model};

/// Quantities derived from the parameters, refilled in place for each design.
#[derive(Clone, Debug)]
pub(crate) struct Design<G, const D: usize, const P: usize> {
    pub geometry: Geometry<G, D, P>,
    /// Derived quantities of each force.
    pub forces: Designs<P>,
    /// √K_ii-scaling: a coordinate times its scale has the elastic energy of one unit.
    pub scale: Vec<f64>,
    /// The smallest elastic stiffness of an angular coordinate [N·m/rad]: the unit of energy.
    pub reference_stiffness: f64,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Design<G, D, P> {
    pub fn new(model: &Model<G, D, P>) -> Self {
        let mut design = Self {
            geometry: Geometry::new(&model.tree),
            forces: model.forces.designs(&model.tree),
            scale: vec![1.0; model.dof()],
            reference_stiffness: 1.0,
        };
        design.update(model);
        design
    }

    /// Sets the parameters, without allocating.
    pub fn set_parameters(&mut self, model: &Model<G, D, P>, parameters: &[f64]) {
        self.geometry.parameters.copy_from_slice(parameters);
        self.update(model);
    }

    fn update(&mut self, model: &Model<G, D, P>) {
        self.geometry.update(&model.tree);
        model.forces.update_designs(&model.tree, &self.geometry, &mut self.forces);
        self.set_scale(model);
    }

    fn set_scale(&mut self, model: &Model<G, D, P>) {
        self.scale.fill(0.0);
        model.forces.add_elastic_stiffness(&model.tree, &self.geometry, &self.forces, &mut self.scale);
        let angular_rods = model.rods.iter().flat_map(|r| r.dofs.clone().zip(&r.angular));
        let angular_joints = model.joints.iter().map(|j| (j.dof, &j.joint.angular));
        let angular = angular_rods.chain(angular_joints).filter(|(_, angular)| **angular);
        let smallest = angular.map(|(i, _)| self.scale[i]).filter(|k| *k > 0.0).fold(f64::INFINITY, f64::min);
        self.reference_stiffness = if smallest.is_finite() { smallest } else { 1.0 };
        for k in &mut self.scale {
            // A coordinate without elasticity borrows the reference: only its scaling depends on it.
            *k = 1.0 / if *k > 0.0 { *k } else { self.reference_stiffness }.sqrt();
        }
    }
}
