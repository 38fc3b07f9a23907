//! Cholesky factorisation of a matrix that is full, but of low rank off its band.
//!
//! Coordinates are grouped in nodes. Blocks of neighbouring nodes are arbitrary; beyond them
//! A_ij = c_i · m_j for i before j, with c and m of length R. Elimination preserves that form:
//! L_ji = Y_i · m_j, so that the cost of a node does not depend on the number of nodes that follow. For
//! neighbours it is Y_i · m_j + E_ji. The coordinates of a border, at the end, may be coupled to all
//! others.

use super::cholesky::pivot_rounding;
use super::{Matrix, Vector};
use std::ops::Range;

/// `S A S + λ I = L Lᵀ`, with `S` diagonal.
#[derive(Clone, Debug)]
pub struct ChainCholesky<const R: usize> {
    /// The coordinates in the order in which they are eliminated.
    order: Vec<usize>,
    nodes: Vec<Node>,
    /// The start of each column of L in `numbers`.
    columns: Vec<usize>,
    /// Column after column: the rows of its own node, E, and the rows of the border.
    numbers: Vec<f64>,
    /// Reciprocals of the diagonal of L.
    inverse: Vec<f64>,
    /// As in [`Cholesky`](super::Cholesky).
    rounding: f64,
    null_pivot: Option<usize>,
    y: Vec<Vector<R>>,
    m: Vec<Vector<R>>,
    /// For each row j, Σ L_jk Y_k over the preceding nodes.
    gone: Vec<Vector<R>>,
    /// For each row j, Σ E_jk Y_k over the node just before it.
    near: Vec<Vector<R>>,
}

/// Places, in the order of elimination, of a node's coordinates and of those of the next.
#[derive(Clone, Debug)]
struct Node {
    own: Range<usize>,
    next: Range<usize>,
}

/// A matrix A with its c and m, all by coordinate, and S.
#[derive(Clone, Copy, Debug)]
pub struct ChainMatrix<'a, const R: usize> {
    /// A, row-major.
    pub full: &'a [f64],
    /// c.
    pub before: &'a [Vector<R>],
    /// m.
    pub beyond: &'a [Vector<R>],
    /// S.
    pub scale: &'a [f64],
}

impl<const R: usize> ChainMatrix<'_, R> {
    #[inline]
    fn scaled(&self, i: usize, j: usize) -> f64 {
        self.full[i * self.scale.len() + j] * self.scale[i] * self.scale[j]
    }
}

impl<const R: usize> ChainCholesky<R> {
    /// A buffer for coordinates in this `order`, node after node; `starts` gives the start of each node
    /// and, last, of the border.
    pub fn new(order: &[usize], starts: &[usize]) -> Self {
        let n = order.len();
        let (mut nodes, mut columns, mut size) = (vec![], vec![], 0);
        for (k, own) in starts.windows(2).enumerate() {
            let end = starts.get(k + 2).copied().unwrap_or(own[1]);
            nodes.push(Node { own: own[0]..own[1], next: own[1]..end });
            let border = n - starts[starts.len() - 1];
            for _ in own[0]..own[1] {
                columns.push(size);
                size += end - own[0] + border;
            }
        }
        let border = columns.len()..n;
        for _ in border.clone() {
            columns.push(size);
            size += border.len();
        }
        nodes.push(Node { own: border, next: n..n });
        let zeros = vec![Vector::ZERO; n];
        Self {
            order: order.to_vec(),
            nodes,
            columns,
            numbers: vec![0.0; size],
            inverse: vec![0.0; n],
            rounding: pivot_rounding(n),
            null_pivot: None,
            y: zeros.clone(),
            m: zeros.clone(),
            gone: zeros.clone(),
            near: zeros,
        }
    }

    /// Factorises; `false` when the matrix is not (numerically) positive definite.
    pub fn factorise(&mut self, a: ChainMatrix<R>, shift: f64) -> bool {
        let last = self.nodes.len() - 1;
        self.null_pivot = None;
        let border = self.nodes[last].own.clone();
        for (m, i) in self.m[..border.start].iter_mut().zip(&self.order) {
            *m = a.beyond[*i] * a.scale[*i];
        }
        self.gone[border.clone()].fill(Vector::ZERO);
        // Σ Y Yᵀ over the nodes done.
        let mut carried = Matrix::<R, R>::ZERO;
        for k in 0..last {
            let Node { own, next } = self.nodes[k].clone();
            let before = if k == 0 { 0..0 } else { self.nodes[k - 1].own.clone() };
            self.sum_up(&before, &own, &carried);
            for p in own.clone() {
                self.fill_column(a, &before, &own, &next, &border, p);
            }
            if !self.eliminate(a, &own, shift) {
                return false;
            }
            for p in own.clone() {
                carried += self.y[p].outer(&self.y[p]);
                let tail = &self.numbers[self.columns[p] + own.len() + next.len()..];
                for (gone, l) in self.gone[border.clone()].iter_mut().zip(tail) {
                    *gone += self.y[p] * *l;
                }
            }
        }
        self.fill_border(a, &border);
        self.eliminate(a, &border, shift)
    }

    /// The contributions of the preceding nodes to the rows of a node.
    fn sum_up(&mut self, before: &Range<usize>, own: &Range<usize>, carried: &Matrix<R, R>) {
        for r in own.clone() {
            let mut near = Vector::ZERO;
            for k in before.clone() {
                near += self.y[k] * self.numbers[self.columns[k] + r - before.start];
            }
            self.near[r] = near;
            self.gone[r] = *carried * self.m[r] + near;
        }
    }

    /// Column `p` of the Schur complement after elimination of the preceding nodes.
    #[inline]
    fn fill_column(
        &mut self,
        a: ChainMatrix<R>,
        before: &Range<usize>,
        own: &Range<usize>,
        next: &Range<usize>,
        border: &Range<usize>,
        p: usize,
    ) {
        let i = self.order[p];
        let (m, gone, c) = (self.m[p], self.gone[p], a.before[i] * a.scale[i]);
        let (earlier, rest) = self.numbers.split_at_mut(self.columns[p]);
        let from = |k: usize, r: usize| earlier[self.columns[k] + r - before.start];
        for r in p..own.end {
            let mut left = a.scaled(i, self.order[r]) - self.m[r].dot(&gone) - self.near[r].dot(&m);
            for k in before.clone() {
                left -= from(k, r) * from(k, p);
            }
            rest[r - own.start] = left;
        }
        for r in next.clone() {
            rest[r - own.start] = a.scaled(i, self.order[r]) - self.m[r].dot(&c);
        }
        // In a column the border follows the next node.
        for (b, r) in border.clone().enumerate() {
            let mut left = a.scaled(i, self.order[r]) - self.gone[r].dot(&m);
            for k in before.clone() {
                left -= from(k, own.end + b) * from(k, p);
            }
            rest[next.end - own.start + b] = left;
        }
        self.y[p] = c - gone;
    }

    /// The border's columns of the Schur complement after elimination of all nodes.
    fn fill_border(&mut self, a: ChainMatrix<R>, border: &Range<usize>) {
        let Some(start) = self.columns.get(border.start) else { return };
        let (chain, left) = self.numbers.split_at_mut(*start);
        let size = border.len();
        for (p, column) in left.chunks_exact_mut(size).enumerate() {
            for (r, x) in column.iter_mut().enumerate().skip(p) {
                *x = a.scaled(self.order[border.start + p], self.order[border.start + r]);
            }
        }
        for end in &self.columns[1..=border.start] {
            let tail = &chain[end - size..*end];
            for (p, column) in left.chunks_exact_mut(size).enumerate() {
                for (x, l) in column[p..].iter_mut().zip(&tail[p..]) {
                    *x -= tail[p] * l;
                }
            }
        }
    }

    /// Turns the columns of one node, filled, into those of L.
    #[inline]
    fn eliminate(&mut self, a: ChainMatrix<R>, own: &Range<usize>, shift: f64) -> bool {
        for p in own.clone() {
            let row = p - own.start;
            let end = self.columns.get(p + 1).copied().unwrap_or(self.numbers.len());
            let (earlier, rest) = self.numbers.split_at_mut(self.columns[p]);
            let column = &mut rest[row..end - self.columns[p]];
            column[0] += shift;
            for k in own.start..p {
                let other = &earlier[self.columns[k] + row..][..column.len()];
                let along = other[0];
                column.iter_mut().zip(other).for_each(|(x, l)| *x -= along * l);
                let y = self.y[k];
                self.y[p] -= y * along;
            }
            let i = self.order[p];
            // A pivot lost to cancellation counts as not positive; NaN fails the comparison too.
            let lost = self.rounding * (a.scaled(i, i).abs() + shift);
            if !(column[0] > lost) {
                self.null_pivot = (column[0].abs() <= lost).then_some(i);
                return false;
            }
            let inverse = 1.0 / column[0].sqrt();
            column.iter_mut().for_each(|x| *x *= inverse);
            self.y[p] = self.y[p] * inverse;
            self.inverse[p] = inverse;
        }
        true
    }

    /// The coordinate at which the last factorisation ended because its pivot vanished, to rounding.
    pub fn null_pivot(&self) -> Option<usize> {
        self.null_pivot
    }

    /// Solves `L y = b` in place.
    pub fn solve_lower(&self, b: &mut [f64]) {
        let border = self.nodes[self.nodes.len() - 1].own.clone();
        // Σ Y y over the nodes done.
        let mut gone = Vector::ZERO;
        for Node { own, next } in &self.nodes {
            let so_far = gone;
            for p in own.clone() {
                b[self.order[p]] -= self.m[p].dot(&so_far);
            }
            for p in own.clone() {
                let y = b[self.order[p]] * self.inverse[p];
                b[self.order[p]] = y;
                gone += self.y[p] * y;
                let near = &self.order[p + 1..next.end];
                let far = if own.start == border.start { &[] } else { &self.order[border.clone()] };
                let column = &self.numbers[self.columns[p] + p + 1 - own.start..];
                for (i, l) in near.iter().chain(far).zip(column) {
                    b[*i] -= l * y;
                }
            }
        }
    }

    /// Solves `Lᵀ x = y` in place.
    pub fn solve_upper(&self, y: &mut [f64]) {
        let border = self.nodes[self.nodes.len() - 1].own.clone();
        // Σ m x over the nodes done.
        let mut done = Vector::ZERO;
        for Node { own, next } in self.nodes.iter().rev() {
            let so_far = done;
            for p in own.clone().rev() {
                let near = &self.order[p + 1..next.end];
                let far = if own.start == border.start { &[] } else { &self.order[border.clone()] };
                let column = &self.numbers[self.columns[p] + p + 1 - own.start..];
                let mut left = y[self.order[p]] - self.y[p].dot(&so_far);
                for (i, l) in near.iter().chain(far).zip(column) {
                    left -= l * y[*i];
                }
                let x = left * self.inverse[p];
                y[self.order[p]] = x;
                done += self.m[p] * x;
            }
        }
    }

    /// Solves `L Lᵀ x = b` in place.
    pub fn solve(&self, b: &mut [f64]) {
        self.solve_lower(b);
        self.solve_upper(b);
    }
}
