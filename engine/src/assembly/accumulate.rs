//! Accumulation of the tangent: outward along the tree, each column is paired with all preceding ones.

use super::Assembly;
use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::linalg::{LANES, Matrix, Vector, fma};
use crate::model::Model;
use crate::tree::Chain;

/// Sums over one run of frames with the same coordinates, in blocks of columns.
#[derive(Clone, Debug)]
pub(super) struct Run<const D: usize> {
    /// Σ S.
    columns: Vec<Matrix<D, LANES>>,
    /// Σ (H̄ + ½ M(w̄)) S.
    rows: Vec<Matrix<D, LANES>>,
    /// The run's columns with one another.
    own: Vec<Matrix<LANES, LANES>>,
    /// The run's columns with the other side of couplings.
    coupled: Vec<Vector<LANES>>,
}

impl<const D: usize> Run<D> {
    pub fn new<G: LieGroup<D, P>, const P: usize>(model: &Model<G, D, P>) -> Self {
        let widest = model.frames.iter().map(|f| f.blocks.len()).max().unwrap_or(0);
        Self {
            columns: vec![Matrix::ZERO; widest],
            rows: vec![Matrix::ZERO; widest],
            own: vec![Matrix::ZERO; widest * widest],
            coupled: vec![Vector::ZERO; widest * model.coupled.len()],
        }
    }

    fn clear(&mut self, blocks: usize, width: usize) {
        self.columns[..blocks].fill(Matrix::ZERO);
        self.rows[..blocks].fill(Matrix::ZERO);
        self.own[..blocks * blocks].fill(Matrix::ZERO);
        self.coupled[..blocks * width].fill(Vector::ZERO);
    }
}

impl<const D: usize, const P: usize> Assembly<D, P> {
    /// The frames of one rod element move with the same coordinates. The rows of such a run are summed and
    /// paired once with the preceding columns; its own columns are paired among themselves.
    pub(super) fn accumulate_tangent<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        geometry: &Geometry<G, D, P>,
        coupled: bool,
    ) {
        let size = D * model.dof;
        let mut f = 1;
        while f < model.frames.len() {
            let frame = &model.frames[f];
            if !self.terms.frames.loaded[f] {
                f += 1;
                continue;
            }
            let parent = &model.frames[frame.parent];
            if frame.parent == 0 {
                self.prefix[frame.body * size..][..size].fill(0.0);
            } else if parent.body != frame.body {
                self.prefix.copy_within(parent.body * size..(parent.body + 1) * size, frame.body * size);
            }
            let end = frame.run_end;
            if !frame.blocks.is_empty() {
                self.sum_run(model, geometry, f..end, coupled);
                match self.chain.of(model) {
                    None => self.pair_run(model, f, |_, path, row, y, before| {
                        add_products(&mut row[path.clone()], y, before.map(|b| &b[path.clone()]));
                    }),
                    Some(chain) => self.pair_run_of_chain(model, chain, f),
                }
            }
            f = end;
        }
    }

    /// Sums over the frames of a run and pairs their columns with one another.
    #[inline]
    fn sum_run<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        geometry: &Geometry<G, D, P>,
        frames: std::ops::Range<usize>,
        coupled: bool,
    ) {
        let width = model.coupled.len();
        let count = model.frames[frames.start].blocks.len();
        let unloaded = frames.clone().find(|f| !self.terms.frames.loaded[*f]);
        let frames = frames.start..unloaded.unwrap_or(frames.end);
        self.run.clear(count, width);
        if count == 1 {
            self.sum_block(model, geometry, frames.clone());
        } else {
            self.sum_blocks(model, geometry, frames.clone());
        }
        if coupled {
            self.couple_run(model, frames);
        }
    }

    /// As above, for a run with one block of columns (the usual case), whose sums stay in registers.
    #[inline]
    fn sum_block<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        geometry: &Geometry<G, D, P>,
        frames: std::ops::Range<usize>,
    ) {
        let (mut columns, mut rows, mut own) = (Matrix::ZERO, Matrix::ZERO, Matrix::ZERO);
        for f in frames {
            let block = model.frames[f].blocks.start;
            let (column, motion) = (&self.columns[block], &self.motions[block]);
            let [phi1, phi2] = &geometry.strain_maps[block];
            let [row, curved, bracketed] = self.forms::<G>(f, column, motion, phi1);
            own += pair([&row, &curved, &bracketed], [&(columns + *column * 0.5), motion, phi2]);
            rows += row;
            columns += *column;
        }
        let run = &mut self.run;
        (run.columns[0], run.rows[0], run.own[0]) = (columns, rows, own);
    }

    #[inline]
    fn sum_blocks<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        geometry: &Geometry<G, D, P>,
        frames: std::ops::Range<usize>,
    ) {
        for f in frames {
            let own = model.frames[f].blocks.clone();
            let columns = &self.columns[own.clone()];
            let motions = &self.motions[own.clone()];
            let maps = &geometry.strain_maps[own];
            for (i, [phi1, _]) in maps.iter().enumerate() {
                let [row, curved, bracketed] = self.forms::<G>(f, &columns[i], &motions[i], phi1);
                self.run.rows[i] += row;
                for (j, [_, phi2]) in maps.iter().enumerate() {
                    let before = self.run.columns[j] + columns[j] * 0.5;
                    self.run.own[i * maps.len() + j] +=
                        pair([&row, &curved, &bracketed], [&before, &motions[j], phi2]);
                }
            }
            for (sum, column) in self.run.columns.iter_mut().zip(columns) {
                *sum += *column;
            }
        }
    }

    /// Products of a frame's forms with a block: (H̄ + ½ M(w̄)) S, Q dΩ/dq, and Fᵀ dξ₁/dq, the half of the
    /// bracket's form dξ₁ᵀ F dξ₂ that U keeps.
    #[inline(always)]
    fn forms<G: LieGroup<D, P>>(
        &self,
        f: usize,
        column: &Matrix<D, LANES>,
        motion: &Matrix<D, LANES>,
        phi1: &Matrix<D, LANES>,
    ) -> [Matrix<D, LANES>; 3] {
        let form = self.terms.frames.stiffness[f] + G::bracket_form(&self.terms.frames.wrench[f]) * 0.5;
        let [curvature, bracket] = [&self.curvature[f], &self.bracket[f].transpose()];
        [form * *column, G::apply_form(curvature, motion), G::apply_form(bracket, phi1)]
    }

    /// Adds the products of the coupling forms carried by the frames of a run with its columns.
    #[inline]
    fn couple_run<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>, frames: std::ops::Range<usize>) {
        let width = model.coupled.len();
        for f in frames {
            let carried = &self.coupled[f * D * width..(f + 1) * D * width];
            let columns = &self.columns[model.frames[f].blocks.clone()];
            for (column, sums) in columns.iter().zip(self.run.coupled.chunks_exact_mut(width)) {
                for (column, carried) in column.0.iter().zip(carried.chunks_exact(width)) {
                    for (sum, z) in sums.iter_mut().zip(carried) {
                        *sum += Vector(*column) * *z;
                    }
                }
            }
        }
    }

    /// Pairs the run that starts at frame `f` with the preceding columns on its path: for each of its
    /// coordinates, `add` is given the path, the coordinate's row of the tangent, its twist and the columns.
    #[inline(always)]
    fn pair_run<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        f: usize,
        add: impl Fn(usize, &std::ops::Range<usize>, &mut [f64], [f64; D], [&[f64]; D]),
    ) {
        let (n, span) = (model.dof, model.coupled.clone());
        let width = span.len();
        let first = &model.frames[f];
        let path = model.frames[first.parent].path.clone();
        let prefix = &mut self.prefix[first.body * D * n..(first.body + 1) * D * n];
        let dofs = &model.column_dofs[first.columns.clone()];
        let count = first.blocks.len();
        let run = &self.run;
        for (m, dof) in dofs.iter().enumerate() {
            let (block, lane) = (m / LANES, m % LANES);
            let row = &mut self.terms.coordinates.half_tangent[dof * n..(dof + 1) * n];
            let y: [f64; D] = std::array::from_fn(|d| run.rows[block].0[d][lane]);
            let before: [&[f64]; D] = std::array::from_fn(|d| &prefix[d * n..(d + 1) * n]);
            add(*dof, &path, row, y, before);
            for (l, other) in dofs.iter().enumerate() {
                row[*other] += run.own[block * count + l / LANES].0[lane][l % LANES];
            }
            for (r, z) in row[span.clone()].iter_mut().zip(&run.coupled[block * width..(block + 1) * width]) {
                *r += z[lane];
            }
        }
        for (m, dof) in dofs.iter().enumerate() {
            for d in 0..D {
                prefix[d * n + dof] += run.columns[m / LANES].0[d][m % LANES];
            }
        }
    }

    /// The same for a chain, with neighbouring nodes only.
    #[inline(never)]
    fn pair_run_of_chain<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>, chain: &Chain, f: usize) {
        self.pair_run(model, f, |dof, path, row, y, before| {
            for &i in chain.neighbours(dof).iter().filter(|i| path.contains(i)) {
                for d in 0..D {
                    row[i] = fma(y[d], before[d][i], row[i]);
                }
            }
        });
        for (m, dof) in model.column_dofs[model.frames[f].columns.clone()].iter().enumerate() {
            let [column, row] =
                [&self.run.columns, &self.run.rows].map(|sums| sums[m / LANES].column(m % LANES));
            self.chain.add(*dof, column, row);
        }
    }
}

/// row += Σ y_d columns_d.
#[inline(always)]
fn add_products<const D: usize>(row: &mut [f64], y: [f64; D], columns: [&[f64]; D]) {
    // Slices of one length are indexed without checks.
    let columns = columns.map(|column| &column[..row.len()]);
    for i in 0..row.len() {
        for d in 0..D {
            row[i] = fma(y[d], columns[d][i], row[i]);
        }
    }
}

/// Σ rowsᵀ columns.
#[inline(always)]
fn pair<const D: usize>(
    rows: [&Matrix<D, LANES>; 3],
    columns: [&Matrix<D, LANES>; 3],
) -> Matrix<LANES, LANES> {
    rows[0].transpose_times_matrix(columns[0])
        + rows[1].transpose_times_matrix(columns[1])
        + rows[2].transpose_times_matrix(columns[2])
}
