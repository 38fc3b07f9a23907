//! Factorisation of a positive semidefinite tangent, with its null space.
//!
//! Where a pivot vanishes, the coordinate is held fixed ("pinned") and the others are factorised. The Schur
//! complement of the pinned coordinates is the tangent on the modes z = e_c − H⁻¹ H_c; if it vanishes, H is
//! positive semidefinite and the modes span its null space. The solution of the pinned system solves
//! H p = −r if no force acts on a null mode.

use super::vector::dot;
use crate::linalg::Cholesky;

/// A mode is null if its stiffness is below this multiple of the rounding of its terms.
const ROUNDINGS: f64 = 64.0;

/// Null modes of `S A S`, and the factor of the other coordinates.
#[derive(Clone, Debug)]
pub(super) struct SemidefiniteFactor {
    cholesky: Cholesky,
    pinned: Vec<usize>,
    null_modes: Vec<Vec<f64>>,
    matrix: Vec<f64>,
}

impl SemidefiniteFactor {
    pub fn new(n: usize) -> Self {
        Self { cholesky: Cholesky::new(n), pinned: vec![], null_modes: vec![], matrix: vec![0.0; n * n] }
    }

    /// Factorises `S A S` with as many coordinates pinned as needed, among them `first`; `false` where it
    /// is not positive semidefinite to rounding. `sizes` are the magnitudes of the terms of its diagonal.
    pub fn factorise(&mut self, a: &[f64], scale: &[f64], first: &[usize], sizes: &[f64]) -> bool {
        let n = scale.len();
        for i in 0..n {
            for j in 0..n {
                self.matrix[i * n + j] = a[i * n + j] * scale[i] * scale[j];
            }
        }
        let full = self.matrix.clone();
        let ones = vec![1.0; n];
        self.pinned.clear();
        self.null_modes.clear();
        let mut next = first.to_vec();
        loop {
            for pinned in next {
                self.pinned.push(pinned);
                for i in 0..n {
                    self.matrix[pinned * n + i] = 0.0;
                    self.matrix[i * n + pinned] = 0.0;
                }
                self.matrix[pinned * n + pinned] = 1.0;
            }
            if self.cholesky.factorise(&self.matrix, &ones, 0.0) {
                break;
            }
            match self.cholesky.null_pivot() {
                Some(other) if other < n => next = vec![other],
                _ => return false,
            }
        }
        for &c in &self.pinned {
            let mut mode: Vec<f64> = full[c * n..(c + 1) * n].iter().map(|x| -x).collect();
            self.pinned.iter().for_each(|p| mode[*p] = 0.0);
            self.cholesky.solve(&mut mode);
            mode[c] = 1.0;
            self.null_modes.push(mode);
        }
        let tolerance = ROUNDINGS * n as f64 * f64::EPSILON;
        let row = |i: usize| &full[i * n..(i + 1) * n];
        let size = |mode: &[f64]| -> f64 {
            let of_row = |i: usize| row(i).iter().zip(mode).map(|(h, z)| (h * z).abs()).sum::<f64>();
            let of_terms =
                |i: usize| sizes.get(i).map_or(0.0, |size| size * scale[i] * scale[i] * mode[i].abs());
            (0..n).map(|i| (of_row(i) + of_terms(i)) * mode[i].abs()).sum()
        };
        let sizes: Vec<f64> = self.null_modes.iter().map(|mode| size(mode)).collect();
        self.pinned.iter().enumerate().all(|(k, &c)| {
            self.null_modes
                .iter()
                .zip(&sizes)
                .all(|(mode, other)| dot(row(c), mode).abs() <= tolerance * (sizes[k] * other).sqrt())
        })
    }

    /// The pinned coordinates.
    pub fn pinned(&self) -> &[usize] {
        &self.pinned
    }

    /// The null modes, dimensionless.
    pub fn null_modes(&self) -> &[Vec<f64>] {
        &self.null_modes
    }

    /// Solves in place; zero in the pinned coordinates.
    pub fn solve(&self, b: &mut [f64]) {
        self.pinned.iter().for_each(|c| b[*c] = 0.0);
        self.cholesky.solve(b);
    }

    /// Solves in place with a triangular factor.
    pub fn solve_lower(&self, b: &mut [f64]) {
        self.pinned.iter().for_each(|c| b[*c] = 0.0);
        self.cholesky.solve_lower(b);
    }
}
