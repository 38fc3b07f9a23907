//! A positive semidefinite tangent, with the coordinates pinned that nothing holds.
//!
//! Where a pivot vanishes, the coordinate is held fixed and the rest factorised. What elimination leaves
//! of the pinned rows, their Schur complement, is the tangent on the modes z = e_c − H⁻¹ H_c. If it
//! vanishes as well, the tangent is positive semidefinite and the modes are null; steps are those of the
//! pinned system, which solve H p = −r as long as no force acts on a null mode.

use super::vector::dot;
use crate::linalg::Cholesky;

/// What a mode's stiffness may differ from zero by, in roundings of its terms.
const ROUNDINGS: f64 = 64.0;

/// Null modes of `S A S`, and its factor without them.
#[derive(Clone, Debug)]
pub(super) struct Pinned {
    cholesky: Cholesky,
    coordinates: Vec<usize>,
    modes: Vec<Vec<f64>>,
    matrix: Vec<f64>,
}

impl Pinned {
    pub fn new(n: usize) -> Self {
        Self { cholesky: Cholesky::new(n), coordinates: vec![], modes: vec![], matrix: vec![0.0; n * n] }
    }

    /// Factorises `S A S` with as many coordinates pinned as needed, among them `first`; `false` where it
    /// is not positive semidefinite to the rounding of `size`, that of the terms of its diagonal.
    pub fn factorise(&mut self, a: &[f64], scale: &[f64], first: &[usize], sizes: &[f64]) -> bool {
        let n = scale.len();
        for i in 0..n {
            for j in 0..n {
                self.matrix[i * n + j] = a[i * n + j] * scale[i] * scale[j];
            }
        }
        let full = self.matrix.clone();
        let ones = vec![1.0; n];
        self.coordinates.clear();
        self.modes.clear();
        let mut next = first.to_vec();
        loop {
            for pinned in next {
                self.coordinates.push(pinned);
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
        for &c in &self.coordinates {
            let mut mode: Vec<f64> = full[c * n..(c + 1) * n].iter().map(|x| -x).collect();
            self.coordinates.iter().for_each(|p| mode[*p] = 0.0);
            self.cholesky.solve(&mut mode);
            mode[c] = 1.0;
            self.modes.push(mode);
        }
        let tolerance = ROUNDINGS * n as f64 * f64::EPSILON;
        let row = |i: usize| &full[i * n..(i + 1) * n];
        let size = |mode: &[f64]| -> f64 {
            let of_row = |i: usize| row(i).iter().zip(mode).map(|(h, z)| (h * z).abs()).sum::<f64>();
            let of_terms =
                |i: usize| sizes.get(i).map_or(0.0, |size| size * scale[i] * scale[i] * mode[i].abs());
            (0..n).map(|i| (of_row(i) + of_terms(i)) * mode[i].abs()).sum()
        };
        let sizes: Vec<f64> = self.modes.iter().map(|mode| size(mode)).collect();
        self.coordinates.iter().enumerate().all(|(k, &c)| {
            self.modes
                .iter()
                .zip(&sizes)
                .all(|(mode, other)| dot(row(c), mode).abs() <= tolerance * (sizes[k] * other).sqrt())
        })
    }

    /// The coordinates held fixed.
    pub fn coordinates(&self) -> &[usize] {
        &self.coordinates
    }

    /// The null modes, dimensionless.
    pub fn modes(&self) -> &[Vec<f64>] {
        &self.modes
    }

    /// Solves in place; the pinned coordinates stay where they are.
    pub fn solve(&self, b: &mut [f64]) {
        self.coordinates.iter().for_each(|c| b[*c] = 0.0);
        self.cholesky.solve(b);
    }

    /// Solves in place with a triangular factor.
    pub fn solve_lower(&self, b: &mut [f64]) {
        self.coordinates.iter().for_each(|c| b[*c] = 0.0);
        self.cholesky.solve_lower(b);
    }
}
