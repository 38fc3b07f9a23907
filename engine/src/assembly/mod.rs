//! Π, its gradient and its Hessian at a state: forces on frames are pulled back to coordinates.
//!
//! With world twists the columns of a chain simply add, exp(Σ ζ_i + ½ Σ_{i<j} [ζ_i, ζ_j] + …), so
//! for coordinates i before j the second derivative is S_iᵀ (H̄_j + ½ M(w̄_j)) S_j, with w̄_j and H̄_j
//! the sums of wrenches and stiffness forms over all frames that j carries. A frame's own block adds
//! the curvature of its exponential and, on rods, that of the Magnus commutator.
//!
//! Columns are kept in blocks of four, one vector register wide, with unused ones zero.

mod accumulate;
mod chain;
mod motions;
mod transmission;

use crate::design::Design;
use crate::forces::state::State;
use crate::forces::terms::{CoordinateTerms, FrameTerms, Terms};
use crate::lie::LieGroup;
use crate::linalg::{LANES, Matrix, Vector};
use crate::model::{Model, States};
use accumulate::Run;
use chain::ChainSums;

/// Workspace of the assembly.
#[derive(Clone, Debug)]
pub(crate) struct Assembly<const D: usize, const P: usize> {
    /// Cached quantities of the forces.
    pub forces: States<P>,
    pub terms: Terms<D>,
    pub energy: f64,
    /// The tangent, row-major.
    pub tangent: Vec<f64>,
    /// Generalised forces, in blocks of coordinates.
    pulled: Vec<Vector<LANES>>,
    /// The wrench that each loaded frame carries, in its body frame, and its dual to dΩ.
    pub duals: Vec<[Vector<D>; 2]>,
    /// Frames whose columns were expanded.
    expanded: Vec<bool>,
    /// World columns S of each frame's own coordinates, at `model.frames[f].blocks`.
    columns: Vec<Matrix<D, LANES>>,
    /// The same columns as changes dΩ of the frame's motion.
    motions: Vec<Matrix<D, LANES>>,
    /// Curvature Q of each frame's exponential, a form on its motions.
    curvature: Vec<Matrix<D, D>>,
    /// Second derivative of each frame's Ω, a form on the strains at its collocation points.
    bracket: Vec<Matrix<D, D>>,
    run: Run<D>,
    chain: ChainSums<D>,
    /// Σ of the preceding columns, one D × dof block per body.
    prefix: Vec<f64>,
    /// Jacobians of the kept frames, one D × dof block each.
    kept: Vec<f64>,
    /// Σ of coupling forms times column Jacobians, one D × coupled block per frame.
    coupled: Vec<f64>,
}

impl<const D: usize, const P: usize> Assembly<D, P> {
    pub fn new<G: LieGroup<D, P>>(model: &Model<G, D, P>) -> Self {
        let (n, frames) = (model.dof, model.frames.len());
        let blocks = model.frames.last().map_or(0, |f| f.blocks.end);
        Self {
            forces: model.forces.states(&model.tree),
            terms: Terms {
                coordinates: CoordinateTerms::new(n),
                frames: FrameTerms::new(frames, model.forces.max_couplings::<G, D>()),
            },
            energy: 0.0,
            tangent: vec![0.0; n * n],
            pulled: model.coordinate_blocks.zeros(),
            duals: vec![[Vector::ZERO; 2]; frames],
            expanded: vec![false; frames],
            columns: vec![Matrix::ZERO; blocks],
            motions: vec![Matrix::ZERO; blocks],
            curvature: vec![Matrix::ZERO; frames],
            bracket: vec![Matrix::ZERO; frames],
            run: Run::new(model),
            chain: ChainSums::new(model),
            prefix: vec![0.0; model.bodies.len() * D * n],
            kept: vec![0.0; (model.jacobian_slot.iter().flatten().count() + model.moving.len()) * D * n],
            coupled: vec![0.0; frames * D * model.coupled.len()],
        }
    }

    /// Energy and residual (9) at a state.
    pub fn update_residual<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        at: &State<G, D, P>,
    ) {
        self.terms.coordinates.clear();
        self.terms.frames.clear();
        model.forces.add_residual(at, &design.forces, &mut self.forces, &mut self.terms);
        self.energy = self.terms.coordinates.energy + self.terms.frames.energy;
        self.pull_back(at);
    }

    /// The tangent at the state of the last [`Assembly::update_residual`]; if it has the form of a chain,
    /// without the part that [`Assembly::complete_tangent`] adds.
    pub fn update_tangent<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        at: &State<G, D, P>,
    ) {
        self.terms.frames.clear_tangent();
        self.terms.coordinates.clear_tangent(model.chain.as_ref());
        model.forces.add_tangent(at, &design.forces, &self.forces, &mut self.terms);
        self.chain.start(model, &self.terms.frames.couplings);

        self.carry_stiffness(model);
        self.expand_motions(at);
        let slots = &design.geometry.jacobian_slot;
        self.keep_jacobians(model, slots);
        let coupled = self.carry_couplings(model, slots);
        self.accumulate_tangent(model, &design.geometry, coupled);
        self.symmetrise(model);
        self.add_circulatory(model);
    }

    /// The frame's own coordinates with their world columns, for a frame that carries a load or leads to
    /// a stored Jacobian.
    pub fn columns<'a, G: LieGroup<D, P>>(
        &'a self,
        model: &'a Model<G, D, P>,
        f: usize,
    ) -> impl Iterator<Item = (usize, Vector<D>)> + 'a {
        columns_of(model, &self.columns, f)
    }

    /// Sums stiffness forms over all frames that each frame carries.
    fn carry_stiffness<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>) {
        let FrameTerms { stiffness, loaded, .. } = &mut self.terms.frames;
        for (f, frame) in model.frames.iter().enumerate().skip(1).rev() {
            if loaded[f] && frame.parent != 0 {
                let carried = stiffness[f];
                stiffness[frame.parent] += carried;
            }
        }
    }

    /// Jacobians of the frames that couplings and follower loads refer to.
    fn keep_jacobians<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>, slots: &[Option<usize>]) {
        let n = model.dof;
        self.kept.fill(0.0);
        for (frame, slot) in slots.iter().enumerate() {
            let Some(slot) = slot else { continue };
            let jacobian = &mut self.kept[slot * D * n..(slot + 1) * D * n];
            let mut f = frame;
            while f != 0 {
                for (dof, column) in columns_of(model, &self.columns, f) {
                    for d in 0..D {
                        jacobian[d * n + dof] += column[d];
                    }
                }
                f = model.frames[f].parent;
            }
        }
    }

    /// Sums X J_column of all couplings over the frames that each frame carries; `false` without any.
    fn carry_couplings<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        slots: &[Option<usize>],
    ) -> bool {
        let (n, span) = (model.dof, model.coupled.clone());
        let width = span.len();
        if self.terms.frames.couplings.is_empty() || width == 0 {
            return false;
        }
        self.coupled.fill(0.0);
        for coupling in &self.terms.frames.couplings {
            let Some(slot) = slots[coupling.column] else { continue };
            let rows = &mut self.coupled[coupling.row * D * width..(coupling.row + 1) * D * width];
            let jacobian = &self.kept[slot * D * n..(slot + 1) * D * n];
            for r in 0..D {
                for d in 0..D {
                    let x = coupling.form.0[r][d];
                    let source = &jacobian[d * n + span.start..d * n + span.end];
                    for (out, j) in rows[r * width..(r + 1) * width].iter_mut().zip(source) {
                        *out += x * j;
                    }
                }
            }
        }
        for f in (1..model.frames.len()).rev() {
            let parent = model.frames[f].parent;
            if self.terms.frames.loaded[f] && parent != 0 {
                let (head, tail) = self.coupled.split_at_mut(f * D * width);
                for (p, c) in
                    head[parent * D * width..(parent + 1) * D * width].iter_mut().zip(&tail[..D * width])
                {
                    *p += c;
                }
            }
        }
        true
    }

    /// Adds Jᵀw for a frame whose Jacobian is kept.
    pub fn add_generalised_force<G: LieGroup<D, P>>(
        &self,
        model: &Model<G, D, P>,
        frame: usize,
        wrench: &Vector<D>,
        out: &mut [f64],
    ) {
        let Some(slot) = model.jacobian_slot[frame] else { return };
        let n = model.dof;
        for d in 0..D {
            let row = &self.kept[(slot * D + d) * n..(slot * D + d + 1) * n];
            for (o, j) in out.iter_mut().zip(row) {
                *o += j * wrench[d];
            }
        }
    }

    fn symmetrise<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>) {
        let n = model.dof;
        let half = &self.terms.coordinates.half_tangent;
        if let Some(chain) = self.chain.of(model) {
            for i in 0..n {
                for &j in chain.neighbours(i) {
                    self.tangent[i * n + j] = half[i * n + j] + half[j * n + i];
                }
            }
            return;
        }
        let width = n.max(1);
        let rows = self.tangent.chunks_exact_mut(width).zip(half.chunks_exact(width));
        for (i, (out, row)) in rows.enumerate() {
            let column = half[i..].iter().step_by(n);
            out.iter_mut().zip(row).zip(column).for_each(|((out, a), b)| *out = a + b);
        }
        if model.chain.is_some() {
            // Entries off the chain are not cleared with the tangent.
            self.terms.coordinates.half_tangent.fill(0.0);
        }
    }

    /// The antisymmetric part of the tangent under loads without a potential.
    fn add_circulatory<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>) {
        let n = model.dof();
        for (frame, form) in &self.terms.frames.circulatory {
            let Some(slot) = model.jacobian_slot[*frame] else { continue };
            let jacobian = &self.kept[slot * D * n..(slot + 1) * D * n];
            let column = |j: usize| {
                let mut c = Vector::<D>::ZERO;
                for d in 0..D {
                    c[d] = jacobian[d * n + j];
                }
                c
            };
            for i in 0..n {
                let row = form.transpose_times(&column(i));
                for j in 0..n {
                    self.tangent[i * n + j] += row.dot(&column(j));
                }
            }
        }
    }
}

/// Reads a frame's coordinates and columns out of the blocks.
fn columns_of<'a, G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &'a Model<G, D, P>,
    columns: &'a [Matrix<D, LANES>],
    f: usize,
) -> impl Iterator<Item = (usize, Vector<D>)> + 'a {
    let frame = &model.frames[f];
    let dofs = &model.column_dofs[frame.columns.clone()];
    let blocks = &columns[frame.blocks.clone()];
    dofs.iter().enumerate().map(|(m, dof)| (*dof, blocks[m / LANES].column(m % LANES)))
}
