//! The bordered tangent and its factors.
//!
//! With one border and a symmetric tangent H,
//!
//! ```text
//! [ H   b ]
//! [ cᵀ  d ]
//! ```
//!
//! is solved by block elimination with H + σ c cᵀ in place of H: σ c times the last row, added to the others,
//! leaves the solution as it is. Where H alone is singular or indefinite along c, as at and beyond a limit
//! point, this matrix is positive definite. All other cases are factorised as a whole.

use super::vector::dot;
use crate::linalg::Cholesky;
use crate::tolerances::ROUNDING_FACTOR;
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// A square matrix with borders, all dimensionless.
#[derive(Clone, Debug)]
pub(super) struct BorderedMatrix {
    /// H, row by row.
    pub tangent: Vec<f64>,
    /// The borders' columns b,
    pub columns: Vec<Vec<f64>>,
    /// their rows c,
    pub rows: Vec<Vec<f64>>,
    /// and d.
    pub corners: Vec<f64>,
    factors: Factors,
    cholesky: Cholesky,
    /// H + σ c cᵀ, σ c and (H + σ c cᵀ)⁻¹ (b + σ d c).
    augmented: Vec<f64>,
    penalty: Vec<f64>,
    eliminated: Vec<f64>,
    /// Scale of [`Cholesky`].
    ones: Vec<f64>,
}

#[derive(Clone, Debug)]
enum Factors {
    /// d − cᵀ (H + σ c cᵀ)⁻¹ (b + σ d c), the last pivot.
    Eliminated(f64),
    Whole(Box<LU<f64, Dyn, Dyn>>),
}

impl BorderedMatrix {
    pub fn new(n: usize, borders: usize) -> Self {
        let vectors = vec![vec![0.0; n]; borders];
        Self {
            tangent: vec![0.0; n * n],
            columns: vectors.clone(),
            rows: vectors,
            corners: vec![0.0; borders],
            factors: Factors::Eliminated(0.0),
            cholesky: Cholesky::new(n),
            augmented: vec![0.0; n * n],
            penalty: vec![0.0; n],
            eliminated: vec![0.0; n],
            ones: vec![1.0; n],
        }
    }

    /// Decouples a coordinate from all others.
    pub fn pin(&mut self, coordinate: usize) {
        let n = self.ones.len();
        for i in 0..n {
            self.tangent[coordinate * n + i] = 0.0;
            self.tangent[i * n + coordinate] = 0.0;
        }
        self.tangent[coordinate * n + coordinate] = 1.0;
        self.columns.iter_mut().chain(&mut self.rows).for_each(|border| border[coordinate] = 0.0);
    }

    pub fn factorise(&mut self, symmetric: bool) {
        let one = self.rows.len() == 1 && !self.tangent.is_empty();
        let last = if symmetric && one { self.eliminate() } else { None };
        self.factors = last.map_or_else(|| Factors::Whole(Box::new(self.whole().lu())), Factors::Eliminated);
    }

    /// Factorises the augmented tangent; `None` where it is not positive definite or the whole matrix is
    /// singular to rounding.
    fn eliminate(&mut self) -> Option<f64> {
        let n = self.ones.len();
        let (row, corner) = (&self.rows[0], self.corners[0]);
        let square = dot(row, row);
        let trace: f64 = self.tangent.iter().step_by(n + 1).sum();
        let weight = if square > 0.0 { trace / (n as f64 * square) } else { 0.0 };
        self.penalty.iter_mut().zip(row).for_each(|(p, c)| *p = weight * c);
        self.augmented.copy_from_slice(&self.tangent);
        for (augmented, p) in self.augmented.chunks_exact_mut(n).zip(&self.penalty) {
            augmented.iter_mut().zip(row).for_each(|(a, c)| *a += p * c);
        }
        if !self.cholesky.factorise(&self.augmented, &self.ones, 0.0) {
            return None;
        }
        for ((e, b), p) in self.eliminated.iter_mut().zip(&self.columns[0]).zip(&self.penalty) {
            *e = b + corner * p;
        }
        self.cholesky.solve(&mut self.eliminated);
        let products = row.iter().zip(&self.eliminated).map(|(c, e)| c * e);
        let (sum, size) = products.fold((0.0, 0.0), |(sum, size), x| (sum + x, size + x.abs()));
        let last = corner - sum;
        let rounding = ROUNDING_FACTOR * n as f64 * f64::EPSILON * (corner.abs() + size);
        (last.abs() > rounding).then_some(last)
    }

    fn whole(&self) -> DMatrix<f64> {
        let (n, borders) = (self.ones.len(), self.rows.len());
        DMatrix::from_fn(n + borders, n + borders, |i, j| match (i < n, j < n) {
            (true, true) => self.tangent[i * n + j],
            (true, false) => self.columns[j - n][i],
            (false, true) => self.rows[i - n][j],
            (false, false) if i == j => self.corners[i - n],
            (false, false) => 0.0,
        })
    }

    /// Solves in place; `false` where the matrix is singular.
    pub fn solve(&self, b: &mut [f64]) -> bool {
        match &self.factors {
            Factors::Whole(lu) => solve_with(b, |x| lu.solve_mut(x)),
            Factors::Eliminated(last) => {
                let Some((multiplier, state)) = b.split_last_mut() else { return false };
                let bound = *multiplier;
                state.iter_mut().zip(&self.penalty).for_each(|(x, p)| *x += bound * p);
                self.cholesky.solve(state);
                *multiplier = (bound - dot(&self.rows[0], state)) / last;
                let mu = *multiplier;
                state.iter_mut().zip(&self.eliminated).for_each(|(x, e)| *x -= mu * e);
                b.iter().all(|x| x.is_finite())
            }
        }
    }

    /// Solves with the transposed matrix in place; `false` where it is singular.
    pub fn solve_transposed(&self, b: &mut [f64]) -> bool {
        match &self.factors {
            Factors::Whole(lu) => solve_with(b, |x| {
                // P A = L U, so Aᵀ = Uᵀ Lᵀ P.
                let (l, u) = (lu.l(), lu.u());
                let solved = u.tr_solve_upper_triangular_mut(x) && l.tr_solve_lower_triangular_mut(x);
                lu.p().inv_permute_rows(x);
                solved
            }),
            Factors::Eliminated(last) => {
                let Some((multiplier, state)) = b.split_last_mut() else { return false };
                // For H + σ c cᵀ the multiplier is ν − σ c·x.
                let nu = (*multiplier - dot(&self.eliminated, state)) / last;
                state.iter_mut().zip(&self.rows[0]).for_each(|(x, c)| *x -= nu * c);
                self.cholesky.solve(state);
                *multiplier = nu + dot(&self.penalty, state);
                b.iter().all(|x| x.is_finite())
            }
        }
    }
}

fn solve_with(b: &mut [f64], solve: impl Fn(&mut DVector<f64>) -> bool) -> bool {
    let mut x = DVector::from_column_slice(b);
    let solved = solve(&mut x);
    b.copy_from_slice(x.as_slice());
    solved && b.iter().all(|x| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tangent with one eigenvalue `lowest` along its row and positive ones across.
    fn example(n: usize, lowest: f64, corner: f64) -> BorderedMatrix {
        let wave = |i: usize, k: usize| ((i + 1) as f64 * (0.7 + 0.31 * k as f64)).sin();
        let mut row: Vec<f64> = (0..n).map(|i| wave(i, 0)).collect();
        let length = dot(&row, &row).sqrt();
        row.iter_mut().for_each(|c| *c /= length);
        let mut matrix = BorderedMatrix::new(n, 1);
        let factors = DMatrix::from_fn(n, n, |i, k| wave(i, k + 1));
        let across = DMatrix::from_fn(n, n, |i, j| f64::from(i == j) - row[i] * row[j]);
        let positive = &across * (&factors * factors.transpose() + DMatrix::identity(n, n)) * &across;
        for i in 0..n {
            for j in 0..n {
                matrix.tangent[i * n + j] = positive[(i, j)] + lowest * row[i] * row[j];
            }
            matrix.columns[0][i] = 1.0 + wave(i, 7);
            matrix.rows[0][i] = 3.0 * row[i];
        }
        matrix.corners[0] = corner;
        matrix
    }

    #[test]
    fn elimination_solves_singular_and_indefinite_tangents_as_the_whole_matrix_does() {
        for (lowest, corner) in [(1.0, 0.0), (0.0, 0.0), (-0.3, 0.0), (0.0, 0.4), (-0.2, -1.5)] {
            let n = 11;
            let mut matrix = example(n, lowest, corner);
            matrix.factorise(true);
            assert!(matches!(matrix.factors, Factors::Eliminated(_)), "{lowest} {corner}");
            let whole = matrix.whole();
            let b = DVector::from_fn(n + 1, |i, _| (1.1 * i as f64).cos());
            for transposed in [false, true] {
                let mut x = b.clone();
                let (solved, product) = if transposed {
                    (matrix.solve_transposed(x.as_mut_slice()), whole.transpose() * &x)
                } else {
                    (matrix.solve(x.as_mut_slice()), &whole * &x)
                };
                assert!(solved);
                let error = (product - &b).amax();
                assert!(error < 1e-11 * x.amax().max(1.0), "{error} {lowest} {corner} {transposed}");
            }
        }
    }

    #[test]
    fn what_cannot_be_eliminated_is_factorised_as_a_whole() {
        for (lowest, symmetric) in [(-1e4, true), (1.0, false)] {
            let mut matrix = example(7, lowest, 0.0);
            matrix.factorise(symmetric);
            assert!(matches!(matrix.factors, Factors::Whole(_)));
            let mut x = DVector::from_element(8, 1.0);
            assert!(matrix.solve(x.as_mut_slice()));
            let whole = matrix.whole();
            let error = (&whole * &x).add_scalar(-1.0).amax();
            assert!(error < 1e-13 * whole.amax() * x.amax(), "{error}");
        }
    }
}
