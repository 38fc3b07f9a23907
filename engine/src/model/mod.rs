//! The model: a tree of bodies and the forces that act on it, without what changes from design to design.

mod components;
pub(crate) mod description;
mod forces;
mod structure;

pub use crate::tree::{Layout, ModelError};
pub(crate) use components::Components;
pub use description::*;
pub(crate) use forces::{Designs, Forces, Sensitivities, States};
pub use structure::{JointStructure, Structure};

use crate::control::Control;
use crate::lie::LieGroup;
use crate::tree::{Chain, Tree};
use std::ops::Deref;

/// A hybrid soft-rigid system, ready to be solved; built once and shared.
#[derive(Clone, Debug, PartialEq)]
pub struct Model<G, const D: usize, const P: usize> {
    pub(crate) tree: Tree<G, D, P>,
    pub(crate) forces: Forces<P>,
    pub(crate) components: Components,
    /// Inputs that are controlled by their conjugates.
    pub(crate) controls: Vec<Control>,
    /// How the tangent of many coordinates is factorised.
    pub(crate) chain: Option<Chain>,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Model<G, D, P> {
    /// Builds the model.
    ///
    /// # Errors
    /// [`ModelError`] names the first invalid field and the allowed values.
    pub fn new(description: &Description) -> Result<Self, ModelError> {
        if description.planar != (D == 3) {
            return Err(ModelError::new("planar", "a planar system needs SE(2), a spatial one SE(3)"));
        }
        let mut tree = Tree::new(&description.bodies, &description.spheres)?;
        tree.shared_inputs.clone_from(&description.shared_inputs);
        let forces = Forces::build(&mut tree, description)?;
        let controls = Control::all(description, &tree.inputs)?;
        // A control couples all coordinates of its rod, a tie those of a loop.
        let chained = forces.is_conservative::<G, D>() && controls.is_empty() && forces.ties.count() == 0;
        let chain = Chain::of(&tree).filter(|chain| chained && chain.is_efficient());
        let components = Components::of(&tree, description);
        Ok(Self { tree, forces, components, controls, chain })
    }

    /// Number of generalised coordinates.
    pub fn dof(&self) -> usize {
        self.tree.dof
    }

    /// Names of the coordinates, such as `exosuit.bend_y[3]` or `ph_1.theta`.
    ///
    /// Rod coordinates of angular modes are L·κ (dimensionless), those of linear modes are strains.
    pub fn coordinates(&self) -> &[String] {
        &self.tree.coordinates
    }

    /// Names of the load inputs: actuators, tendons, scaled wrenches, ties.
    pub fn inputs(&self) -> &[String] {
        &self.tree.inputs
    }

    /// Names of the frames, the world first.
    pub fn frame_names(&self) -> &[String] {
        &self.tree.frame_names
    }

    /// The flat vector of continuous numbers as described.
    pub fn parameters(&self) -> &[f64] {
        &self.tree.parameters
    }

    /// Names and ranges of the parameters.
    pub fn layout(&self) -> &Layout {
        &self.tree.layout
    }

    /// Number of spheres, all groups.
    pub fn sphere_count(&self) -> usize {
        self.tree.spheres.len()
    }

    /// Number of rods.
    pub fn rod_count(&self) -> usize {
        self.tree.rods.len()
    }

    /// Number of pressurised cavities.
    pub fn pressure_count(&self) -> usize {
        self.forces.pressures.count()
    }

    /// Number of materials of sections of fibres.
    pub fn material_count(&self) -> usize {
        self.forces.fibres.material_count()
    }

    /// Number of springs.
    pub fn spring_count(&self) -> usize {
        self.forces.springs.count()
    }

    /// Number of straps around links.
    pub fn loop_count(&self) -> usize {
        self.forces.loops.count()
    }

    /// Number of obstacles.
    pub fn obstacle_count(&self) -> usize {
        self.forces.obstacles.count()
    }

    /// Number of ties.
    pub fn tie_count(&self) -> usize {
        self.forces.ties.count()
    }

    /// Number of tendons.
    pub fn tendon_count(&self) -> usize {
        self.forces.tendons.count()
    }

    /// Number of contacts and tendons with friction.
    pub fn friction_count(&self) -> usize {
        self.forces.frictions.count() + self.forces.tendons.rough_count()
    }

    /// Number of loads in a solve: those of the inputs and, with ties, the progress of closing them.
    pub(crate) fn load_count(&self) -> usize {
        self.inputs().len() + usize::from(self.tie_count() > 0)
    }

    /// Whether every load derives from a potential, so that the tangent is symmetric.
    pub fn is_conservative(&self) -> bool {
        self.forces.is_conservative::<G, D>()
    }

    /// Whether some forces switch on and off.
    pub(crate) fn has_switches(&self) -> bool {
        self.forces.have_switches::<G, D>()
    }

    /// Whether there are bodies that may meet others or obstacles.
    pub(crate) fn has_solids(&self) -> bool {
        self.forces.have_solids::<G, D>()
    }

    /// Whether there are springs.
    pub(crate) fn has_springs(&self) -> bool {
        self.forces.springs.count() > 0
    }

    /// Whether all parameters are finite, lengths, radii and moduli positive, and stiffnesses and
    /// densities not negative.
    pub fn is_admissible(&self, parameters: &[f64]) -> bool {
        self.tree.is_admissible(parameters) && self.forces.are_admissible::<G, D>(parameters)
    }
}

/// A model is a tree of bodies, with forces on it.
impl<G, const D: usize, const P: usize> Deref for Model<G, D, P> {
    type Target = Tree<G, D, P>;

    fn deref(&self) -> &Self::Target {
        &self.tree
    }
}
