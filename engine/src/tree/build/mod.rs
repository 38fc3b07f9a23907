//! Builds the tree of bodies from their validated descriptions.

mod attachments;
mod bodies;
mod rod;

use super::blocks::CoordinateBlocks;
use super::description::{BodyDescription, SphereGroupDescription};
use super::{Frame, Layout, ModelError, Motion, Tree};
use crate::lie::LieGroup;
use std::ops::Range;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Tree<G, D, P> {
    /// Builds the tree, without forces.
    pub fn new(bodies: &[BodyDescription], spheres: &[SphereGroupDescription]) -> Result<Self, ModelError> {
        let mut tree = Self {
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
            moving: vec![],
            sphere_groups: vec![],
            jacobian_slot: vec![],
            leads_to_kept: vec![],
            coupled: 0..0,
            layout: Layout::default(),
            parameters: vec![],
            coordinates: vec![],
            inputs: vec![],
            shared_inputs: vec![],
            frame_names: vec!["world".into()],
            group: std::marker::PhantomData,
        };
        if bodies.is_empty() {
            return Err(ModelError::new("bodies", "a system needs at least one body"));
        }
        for body in bodies {
            tree.add_body(body)?;
        }
        tree.find_runs();
        tree.jacobian_slot = vec![None; tree.frames.len()];
        tree.leads_to_kept = vec![false; tree.frames.len()];
        tree.add_spheres(spheres)?;
        Ok(tree)
    }

    /// Appends a parameter slot with its SI unit, `None` where its numbers have several.
    pub(crate) fn slot(
        &mut self,
        name: String,
        unit: impl Into<Option<&'static str>>,
        defaults: &[f64],
    ) -> Range<usize> {
        self.layout.push(&mut self.parameters, name, unit.into(), defaults)
    }

    /// The index of the load input of a force: one that it shares with others, or a new one of its name.
    pub(crate) fn input(&mut self, force: &str) -> usize {
        let shared = self.shared_inputs.iter().find(|input| input.drives.iter().any(|name| name == force));
        let name = shared.map_or(force, |input| &input.name).to_owned();
        self.inputs.iter().position(|input| *input == name).unwrap_or_else(|| {
            self.inputs.push(name);
            self.inputs.len() - 1
        })
    }

    /// Keeps the Jacobian of `frame`, on whose coordinates a coupling between bodies will depend.
    pub(crate) fn keep_jacobian(&mut self, frame: usize) {
        if frame != 0 && self.jacobian_slot[frame].is_none() {
            let next = self.jacobian_slot.iter().flatten().count();
            self.jacobian_slot[frame] = Some(next);
            self.lead_to(frame);
        }
    }

    /// Keeps the Jacobian of the frame of a point, which depends on the design and is on the way to `last`.
    pub(crate) fn keep_moving_jacobian(&mut self, point: usize, last: usize) {
        self.moving.push(point);
        self.lead_to(last);
    }

    fn lead_to(&mut self, frame: usize) {
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
