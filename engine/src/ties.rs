//! The ties of a model at a state: their conditions c, the gradients of these and the loads that the force
//! element is given.
//!
//! The solver finds the reactions λ at which every c vanishes, see `equilibrium/projection.rs`.

use crate::design::Design;
use crate::forces::state::{Law, State};
use crate::forces::tie::TIE_NUMBERS;
use crate::kinematics::Kinematics;
use crate::lie::LieGroup;
use crate::model::Model;

/// The conditions of all ties.
#[derive(Clone, Debug)]
pub(crate) struct TieConditions {
    dof: usize,
    /// The loads of all inputs, the progress of closing, reactions and penalties.
    applied: Vec<f64>,
    /// c at the state whose conditions were evaluated last.
    value: Vec<f64>,
    /// ∇c of each there, row by row.
    gradient: Vec<f64>,
}

impl TieConditions {
    pub fn new<G: LieGroup<D, P>, const D: usize, const P: usize>(model: &Model<G, D, P>) -> Self {
        let ties = &model.forces.ties;
        let mut applied = vec![0.0; ties.penalties().end];
        applied[ties.progress()] = 1.0;
        let count = ties.row_count();
        Self { dof: model.dof(), applied, value: vec![0.0; count], gradient: vec![0.0; count * model.dof()] }
    }

    /// Sets the loads of inputs, and the progress of closing if it is among them.
    pub fn apply(&mut self, load: &[f64]) -> &[f64] {
        self.applied[..load.len()].copy_from_slice(load);
        &self.applied
    }

    /// The loads set last, with progress, reactions and penalties.
    pub fn applied(&self) -> &[f64] {
        &self.applied
    }

    /// Reactions or penalties, by their places among the loads.
    pub fn numbers(&mut self, places: std::ops::Range<usize>) -> &mut [f64] {
        &mut self.applied[places]
    }

    /// Evaluates conditions and gradients at a state.
    pub fn update<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        kinematics: &Kinematics<G, D, P>,
    ) {
        let Self { dof, applied, value, gradient } = self;
        let (tree, geometry) = (&model.tree, &design.geometry);
        let at = State { tree, geometry, kinematics, q: &[], load: applied, law: Law::Actual };
        let ties = &model.forces.ties;
        gradient.fill(0.0);
        for tie in 0..ties.count() {
            for (row, found) in ties.values(&at, &design.forces.ties, tie) {
                value[row] = found.value;
                let out = &mut gradient[row * *dof..(row + 1) * *dof];
                let [a, b] = ties.frames(&at, row);
                kinematics.add_generalised_force(tree, geometry, b, &found.slope, out);
                kinematics.add_generalised_force(tree, geometry, a, &-found.slope, out);
            }
        }
    }

    /// c of each condition.
    pub fn values(&self) -> &[f64] {
        &self.value
    }

    /// ∇c of each condition.
    pub fn gradients(&self) -> impl Iterator<Item = &[f64]> {
        self.gradient.chunks(self.dof.max(1))
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> crate::Data<G, D, P> {
    /// What each tie does to its second place at the state evaluated last, seven numbers: the force on it
    /// [N] and the moment on it about its place [N·m], in the world, and the force or moment that drives it.
    pub fn tie_loads(&self, model: &Model<G, D, P>, out: &mut [f64]) {
        debug_assert_eq!(out.len(), TIE_NUMBERS * model.tie_count());
        if out.is_empty() {
            return;
        }
        model.forces.ties.loads(&self.state(model, &[], &[]), &self.design.forces.ties, out);
    }

    /// How far each tie is from being closed at the state evaluated last, two numbers: a distance [m] and an
    /// angle [rad].
    pub fn tie_gaps(&self, model: &Model<G, D, P>, out: &mut [f64]) {
        if out.is_empty() {
            return;
        }
        model.forces.ties.gaps(&self.state(model, &[], &[]), &self.design.forces.ties, out);
    }
}
