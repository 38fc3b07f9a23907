//! Factorisation of an unsymmetric tangent, as follower loads make it.

use nalgebra::{DMatrix, Dyn, LU, Schur};

/// `P S A S = L U`.
#[derive(Clone, Debug)]
pub(super) struct GeneralFactor {
    lu: LU<f64, Dyn, Dyn>,
}

impl GeneralFactor {
    pub fn new(n: usize) -> Self {
        Self { lu: DMatrix::identity(n, n).lu() }
    }

    /// Factorises `S A S`; whether its determinant is positive.
    ///
    /// Along a path from a stable state the determinant changes sign where stability is lost by
    /// divergence, whether the tangent is symmetric or not.
    pub fn factorise(&mut self, a: &[f64], scale: &[f64]) -> bool {
        self.lu = scaled(a, scale).lu();
        self.lu.determinant() > 0.0
    }

    /// Solves in place; a singular matrix gives NaN, which every caller takes as failure.
    pub fn solve(&self, b: &mut [f64]) {
        let mut x = nalgebra::DVector::from_column_slice(b);
        if self.lu.solve_mut(&mut x) {
            b.copy_from_slice(x.as_slice());
        } else {
            b.fill(f64::NAN);
        }
    }

    /// Ratio of the smallest to the largest pivot of the last factorisation.
    pub fn pivot_ratio(&self) -> f64 {
        let pivots = self.lu.u().diagonal().abs();
        pivots.min() / pivots.max()
    }

    /// Solves with the transposed matrix, in place.
    pub fn solve_transposed(&self, b: &mut [f64]) {
        // P A = L U, so Aᵀ = Uᵀ Lᵀ P.
        let mut x = nalgebra::DVector::from_column_slice(b);
        let (l, u) = (self.lu.l(), self.lu.u());
        let solved = u.tr_solve_upper_triangular_mut(&mut x) && l.tr_solve_lower_triangular_mut(&mut x);
        self.lu.p().inv_permute_rows(&mut x);
        b.copy_from_slice(x.as_slice());
        if !solved {
            b.fill(f64::NAN);
        }
    }
}

/// Deflation thresholds of the QR iteration, tried in turn: at machine precision it can cycle.
const DEFLATION: [f64; 3] = [f64::EPSILON, 1e-13, 1e-10];
/// Its sweeps, per row.
const SWEEPS: usize = 30;

/// Whether every eigenvalue of `S A S` has a positive real part: no motion grows by itself.
///
/// `false` also when the eigenvalues cannot be found.
pub(super) fn is_stable(a: &[f64], scale: &[f64]) -> bool {
    let matrix = scaled(a, scale);
    if !matrix.iter().all(|x| x.is_finite()) {
        return false;
    }
    let schur = |eps: &f64| Schur::try_new(matrix.clone(), *eps, SWEEPS * scale.len());
    let found = DEFLATION.iter().find_map(schur);
    found.is_some_and(|schur| schur.complex_eigenvalues().iter().all(|e| e.re > 0.0))
}

fn scaled(a: &[f64], scale: &[f64]) -> DMatrix<f64> {
    let n = scale.len();
    DMatrix::from_fn(n, n, |i, j| a[i * n + j] * scale[i] * scale[j])
}
