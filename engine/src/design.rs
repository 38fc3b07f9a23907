//! One design: quantities that depend on the parameters but not on the state.

use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::model::{Designs, Model};
use crate::units::Units;

/// Quantities derived from the parameters, refilled in place for each design.
#[derive(Clone, Debug)]
pub(crate) struct Design<G, const D: usize, const P: usize> {
    pub geometry: Geometry<G, D, P>,
    /// Derived quantities of each force.
    pub forces: Designs<P>,
    pub units: Units,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Design<G, D, P> {
    pub fn new(model: &Model<G, D, P>) -> Self {
        let mut design = Self {
            geometry: Geometry::new(&model.tree),
            forces: model.forces.designs(&model.tree),
            units: Units::new(model),
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
        let Self { geometry, forces, units } = self;
        units.update(model, geometry, |stiffness| {
            model.forces.add_elastic_stiffness(&model.tree, geometry, forces, stiffness);
        });
    }
}
