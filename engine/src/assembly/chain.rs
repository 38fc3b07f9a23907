//! The tangent of a chain in semiseparable form, which a recursion over the nodes factorises.

use super::Assembly;
use crate::forces::terms::Coupling;
use crate::lie::LieGroup;
use crate::linalg::{ChainMatrix, Matrix, Vector};
use crate::model::Model;
use crate::tree::Chain;

/// For each coordinate of the chain, sums over the runs that move with it.
#[derive(Clone, Debug)]
pub(super) struct ChainSums<const D: usize> {
    /// Whether the tangent has the form.
    holds: bool,
    /// Whether the full tangent has been written out from these sums.
    complete: bool,
    /// c = Σ S, the twist of everything beyond the coordinate's runs.
    columns: Vec<Vector<D>>,
    /// m = Σ (H̄ + ½ M(w̄)) S, its generalised force per twist of everything before its runs.
    rows: Vec<Vector<D>>,
}

impl<const D: usize> ChainSums<D> {
    pub fn new<G: LieGroup<D, P>, const P: usize>(model: &Model<G, D, P>) -> Self {
        let zeros = vec![Vector::ZERO; if model.chain.is_some() { model.dof } else { 0 }];
        Self { holds: false, complete: false, columns: zeros.clone(), rows: zeros }
    }

    /// Clears the sums if the tangent has this form, that is, if no force couples two frames of the chain.
    pub fn start<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        couplings: &[Coupling<D>],
    ) {
        let Some(chain) = &model.chain else { return };
        self.holds = !couplings.iter().any(|c| chain.moved[c.row] && chain.moved[c.column]);
        self.complete = false;
        self.columns.fill(Vector::ZERO);
        self.rows.fill(Vector::ZERO);
    }

    /// The chain, if the tangent has this form.
    #[inline]
    pub fn of<'a, G: LieGroup<D, P>, const P: usize>(&self, model: &'a Model<G, D, P>) -> Option<&'a Chain> {
        model.chain.as_ref().filter(|_| self.holds)
    }

    #[inline]
    pub fn add(&mut self, dof: usize, column: Vector<D>, row: Vector<D>) {
        self.columns[dof] += column;
        self.rows[dof] += row;
    }
}

impl<const D: usize, const P: usize> Assembly<D, P> {
    /// The input of the factorisation as a chain, if the tangent has that form.
    pub fn chain_matrix<'a>(&'a self, scale: &'a [f64]) -> Option<ChainMatrix<'a, D>> {
        let ChainSums { holds, columns, rows, .. } = &self.chain;
        holds.then_some(ChainMatrix { full: &self.tangent, before: columns, beyond: rows, scale })
    }

    /// Frobenius norm of the scaled tangent, if it has the form of a chain.
    pub fn chain_norm<G: LieGroup<D, P>>(&self, model: &Model<G, D, P>, scale: &[f64]) -> Option<f64> {
        let chain = self.chain.of(model)?;
        let ChainSums { columns, rows, .. } = &self.chain;
        let mut sum = 0.0;
        for (i, row) in self.tangent.chunks_exact(model.dof).enumerate() {
            let near = chain.neighbours(i).iter().map(|j| (row[*j] * scale[*j] * scale[i]).powi(2));
            sum += near.sum::<f64>();
        }
        // Σ c cᵀ over all nodes that meet those of m through a twist alone.
        let mut before = Matrix::<D, D>::ZERO;
        for nodes in chain.starts.windows(4) {
            for i in &chain.order[nodes[0]..nodes[1]] {
                let c = columns[*i] * scale[*i];
                before += c.outer(&c);
            }
            for j in &chain.order[nodes[2]..nodes[3]] {
                let m = rows[*j] * scale[*j];
                sum += 2.0 * m.dot(&(before * m));
            }
        }
        Some(sum.sqrt())
    }

    /// Writes out the full tangent.
    pub fn complete_tangent<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>) {
        let Some(chain) = self.chain.of(model).filter(|_| !self.chain.complete) else { return };
        let nodes = chain.starts.len() - 1;
        for k in 0..nodes {
            let far = chain.starts[(k + 2).min(nodes)]..chain.starts[nodes];
            for &i in &chain.order[chain.starts[k]..chain.starts[k + 1]] {
                let column = self.chain.columns[i];
                for &j in &chain.order[far.clone()] {
                    let value = column.dot(&self.chain.rows[j]);
                    self.tangent[i * model.dof + j] = value;
                    self.tangent[j * model.dof + i] = value;
                }
            }
        }
        self.chain.complete = true;
    }
}
