//! Jacobian products: rates of the coordinates to twists of frames, wrenches to generalised forces.

use super::Assembly;
use crate::forces::state::State;
use crate::lie::LieGroup;
use crate::linalg::{LANES, Vector};
use crate::model::Model;

impl<const D: usize, const P: usize> Assembly<D, P> {
    /// Expands the columns of the frames without load, which the tangent does not need.
    pub fn complete_columns<G: LieGroup<D, P>>(&mut self, at: &State<G, D, P>) {
        for (f, frame) in at.tree.frames.iter().enumerate().skip(1) {
            if !self.expanded[f] && !frame.blocks.is_empty() {
                self.expand_motion(at, f);
            }
        }
    }

    /// World twist of every frame while the coordinates change at `rates`, in blocks.
    pub fn twists<G: LieGroup<D, P>>(
        &self,
        model: &Model<G, D, P>,
        rates: &[Vector<LANES>],
        twist: &mut [Vector<D>],
    ) {
        for (f, frame) in model.frames.iter().enumerate().skip(1) {
            let mut sum = twist[frame.parent];
            let columns = &self.columns[frame.blocks.clone()];
            for (x, block) in rates[frame.coordinates.clone()].iter().zip(columns) {
                sum += *block * *x;
            }
            twist[f] = sum;
        }
    }

    /// Adds the generalised force of world wrenches on all frames. On return each wrench is the sum over
    /// all frames that its frame carries.
    pub fn add_forces<G: LieGroup<D, P>>(
        &self,
        model: &Model<G, D, P>,
        wrench: &mut [Vector<D>],
        out: &mut [f64],
    ) {
        for (f, frame) in model.frames.iter().enumerate().skip(1).rev() {
            let carried = wrench[f];
            if carried == Vector::ZERO {
                continue;
            }
            wrench[frame.parent] += carried;
            let dofs = &model.column_dofs[frame.columns.clone()];
            for (dofs, block) in dofs.chunks(LANES).zip(&self.columns[frame.blocks.clone()]) {
                let pulled = block.transpose_times(&carried);
                dofs.iter().enumerate().for_each(|(lane, dof)| out[*dof] += pulled[lane]);
            }
        }
    }
}
