//! From a description to a model, checking everything on the way.

mod interactions;
mod rod;
mod tree;

use super::blocks::CoordinateBlocks;
use super::error::finite;
use super::{Chain, Description, Frame, Layout, Model, ModelError, Motion};
use crate::lie::LieGroup;
use std::ops::Range;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Model<G, D, P> {
    /// Builds the model.
    ///
    /// # Errors
    /// [`ModelError`] names the first field that makes no sense and says what is allowed.
    pub fn new(description: &Description) -> Result<Self, ModelError> {
        if description.planar != (D == 3) {
            return Err(ModelError::new("planar", "a planar system needs SE(2), a spatial one SE(3)"));
        }
        finite("gravity", &description.gravity)?;
        let gravity = G::point_from_spatial(&description.gravity)
            .ok_or_else(|| ModelError::new("gravity", "a planar system has no gravity along y"))?;
        let mut model = Self {
            dof: 0,
            frames: vec![Frame {
                parent: 0,
                body: usize::MAX,
                motion: Motion::Rigid(0),
                path: 0..0,
                columns: 0..0,
                blocks: 0..0,
                coordinates: 0..0,
                run_end: 1,
            }],
            steps: vec![],
            strain_columns: vec![],
            joint_columns: vec![],
            column_dofs: vec![],
            coordinate_blocks: CoordinateBlocks::default(),
            bodies: vec![],
            rods: vec![],
            joints: vec![],
            stiffness_pattern: vec![],
            points: vec![],
            spheres: vec![],
            masses: vec![],
            contacts: vec![],
            actuators: vec![],
            springs: vec![],
            wrenches: vec![],
            jacobian_slot: vec![],
            leads_to_kept: vec![],
            coupled: 0..0,
            chain: None,
            gravity,
            layout: Layout::default(),
            parameters: vec![],
            coordinates: vec![],
            inputs: vec![],
            frame_names: vec!["world".into()],
            group: std::marker::PhantomData,
        };
        if description.bodies.is_empty() {
            return Err(ModelError::new("bodies", "a system needs at least one body"));
        }
        for body in &description.bodies {
            model.add_body(body)?;
        }
        model.find_runs();
        model.add_masses();
        model.jacobian_slot = vec![None; model.frames.len()];
        model.leads_to_kept = vec![false; model.frames.len()];
        let groups = model.add_spheres(&description.spheres)?;
        for contact in &description.contacts {
            model.add_contact(contact, &groups)?;
        }
        for actuator in &description.actuators {
            model.add_actuator(actuator)?;
        }
        for spring in &description.springs {
            model.add_spring(spring)?;
        }
        for wrench in &description.wrenches {
            model.add_wrench(wrench)?;
        }
        model.chain = Chain::of(&model).filter(|chain| chain.pays() && model.is_conservative());
        Ok(model)
    }

    /// Appends a parameter slot.
    fn slot(&mut self, name: String, defaults: &[f64]) -> Range<usize> {
        self.layout.push(&mut self.parameters, name, defaults)
    }

    /// Keeps the Jacobian of `frame`, on whose coordinates a coupling between bodies will depend.
    fn keep_jacobian(&mut self, frame: usize) {
        if frame != 0 && self.jacobian_slot[frame].is_none() {
            let next = self.jacobian_slot.iter().flatten().count();
            self.jacobian_slot[frame] = Some(next);
            let mut f = frame;
            while f != 0 {
                self.leads_to_kept[f] = true;
                f = self.frames[f].parent;
            }
            let path = self.frames[frame].path.clone();
            if !path.is_empty() {
                let union = |a: &Range<usize>| a.start.min(path.start)..a.end.max(path.end);
                self.coupled = if self.coupled.is_empty() { path.clone() } else { union(&self.coupled) };
            }
        }
    }
}
