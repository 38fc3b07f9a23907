//! Factorisation of an unsymmetric tangent, as follower loads make it.

use nalgebra::{DMatrix, Dyn, LU};

/// `S A S = P⁻¹ L U`, beside the symmetric part of `A`.
#[derive(Clone, Debug)]
pub(super) struct GeneralFactor {
    lu: LU<f64, Dyn, Dyn>,
    symmetric: Vec<f64>,
}

impl GeneralFactor {
    pub fn new(n: usize) -> Self {
        Self { lu: DMatrix::identity(n, n).lu(), symmetric: vec![0.0; n * n] }
    }

    /// Factorises `S A S`; returns the symmetric part of `A`.
    pub fn factorise(&mut self, a: &[f64], scale: &[f64]) -> &[f64] {
        let n = scale.len();
        self.lu = DMatrix::from_fn(n, n, |i, j| a[i * n + j] * scale[i] * scale[j]).lu();
        for i in 0..n {
            for j in 0..n {
                self.symmetric[i * n + j] = 0.5 * (a[i * n + j] + a[j * n + i]);
            }
        }
        &self.symmetric
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
