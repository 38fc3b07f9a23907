//! Equilibrium under conditions c(q) = 0 whose reactions are unknown: ties.
//!
//! With the gradients of the conditions factorised, Jᵀ = Q [R; 0], Q = [Y Z], the equations are
//!
//! ```text
//! r = Y R⁻ᵀ c + Z Zᵀ ∇Π = 0,   λ = R⁻¹ Yᵀ ∇Π.
//! ```
//!
//! The first part of r is the shortest motion that opens the ties by c. The matrix of Newton's method,
//! with H the second derivative of Π − λᵀc, is in the basis Q
//!
//! ```text
//! T = [   1       0   ]
//!     [ Zᵀ H Y  Zᵀ H Z ]
//! ```
//!
//! An equilibrium is stable if Zᵀ H Z is positive definite: if Π is a minimum on the motions that the ties
//! allow. Conditions whose gradients depend on those before them are redundant: they are left out, and only
//! have to hold.

use super::neutral::NeutralMotions;
use super::vector::dot;

/// The factorised gradients of the conditions, dimensionless.
#[derive(Clone, Debug, Default)]
pub(super) struct Projection {
    /// Householder vectors of unit length, one for each condition that is kept.
    mirrors: Vec<Vec<f64>>,
    /// Columns of R.
    columns: Vec<Vec<f64>>,
    /// The conditions that are kept.
    kept: Vec<usize>,
    /// The others.
    redundant: Vec<usize>,
    row: Vec<f64>,
}

impl Projection {
    /// Factorises the gradients of conditions, given with their indices, in coordinates of these units.
    ///
    /// A condition depends on those before it if at most the fraction `least` of its gradient is independent.
    pub fn factorise<'a>(
        &mut self,
        gradients: impl Iterator<Item = (usize, &'a [f64])>,
        units: &[f64],
        least: impl Fn(usize, &[f64]) -> f64,
    ) {
        self.kept.clear();
        self.redundant.clear();
        for (k, gradient) in gradients {
            self.row.clear();
            self.row.extend(gradient.iter().zip(units).map(|(g, u)| g * u));
            let length = dot(&self.row, &self.row).sqrt();
            let rank = self.kept.len();
            reflect(&self.mirrors[..rank], &mut self.row);
            let rest = dot(&self.row[rank..], &self.row[rank..]).sqrt();
            if !(rest > least(k, gradient) * length) {
                self.redundant.push(k);
                continue;
            }
            if self.mirrors.len() == rank {
                self.mirrors.push(vec![]);
                self.columns.push(vec![]);
            }
            let corner = -rest.copysign(self.row[rank]);
            let (mirror, column) = (&mut self.mirrors[rank], &mut self.columns[rank]);
            column.clear();
            column.extend_from_slice(&self.row[..rank]);
            column.push(corner);
            mirror.clear();
            mirror.extend_from_slice(&self.row);
            mirror[..rank].fill(0.0);
            mirror[rank] -= corner;
            let size = dot(mirror, mirror).sqrt();
            mirror.iter_mut().for_each(|m| *m /= size);
            self.kept.push(k);
        }
    }

    /// Number of independent conditions.
    pub fn rank(&self) -> usize {
        self.kept.len()
    }

    /// The conditions that are kept, in order.
    pub fn kept(&self) -> &[usize] {
        &self.kept
    }

    /// The conditions that depend on those before them.
    pub fn redundant(&self) -> &[usize] {
        &self.redundant
    }

    /// b ← Qᵀ b.
    pub fn turn(&self, b: &mut [f64]) {
        reflect(&self.mirrors[..self.rank()], b);
    }

    /// b ← Q b.
    pub fn turn_back(&self, b: &mut [f64]) {
        for mirror in self.mirrors[..self.rank()].iter().rev() {
            mirror_at(mirror, b);
        }
    }

    /// A ← Qᵀ A Q, row by row.
    pub fn turn_matrix(&self, a: &mut [f64], work: &mut [f64]) {
        for mirror in &self.mirrors[..self.rank()] {
            mirror_rows_and_columns(mirror, a, work);
        }
    }

    /// A ← Q A Qᵀ.
    pub fn turn_matrix_back(&self, a: &mut [f64], work: &mut [f64]) {
        for mirror in self.mirrors[..self.rank()].iter().rev() {
            mirror_rows_and_columns(mirror, a, work);
        }
    }

    /// b ← R⁻¹ b.
    pub fn solve(&self, b: &mut [f64]) {
        for k in (0..self.rank()).rev() {
            let column = &self.columns[k];
            b[k] /= column[k];
            let x = b[k];
            b[..k].iter_mut().zip(column).for_each(|(b, r)| *b -= r * x);
        }
    }

    /// b ← R⁻ᵀ b.
    pub fn solve_transposed(&self, b: &mut [f64]) {
        for k in 0..self.rank() {
            let column = &self.columns[k];
            b[k] = (b[k] - dot(&column[..k], &b[..k])) / column[k];
        }
    }
}

fn reflect(mirrors: &[Vec<f64>], b: &mut [f64]) {
    mirrors.iter().for_each(|mirror| mirror_at(mirror, b));
}

/// b ← (1 − 2 v vᵀ) b.
fn mirror_at(v: &[f64], b: &mut [f64]) {
    let along = 2.0 * dot(v, b);
    b.iter_mut().zip(v).for_each(|(b, v)| *b -= along * v);
}

/// A ← (1 − 2 v vᵀ) A (1 − 2 v vᵀ).
fn mirror_rows_and_columns(v: &[f64], a: &mut [f64], work: &mut [f64]) {
    let n = v.len();
    work.fill(0.0);
    for (row, v) in a.chunks(n).zip(v) {
        work.iter_mut().zip(row).for_each(|(w, a)| *w += 2.0 * v * a);
    }
    for (row, s) in a.chunks_mut(n).zip(v) {
        row.iter_mut().zip(&*work).for_each(|(a, w)| *a -= s * w);
        mirror_at(v, row);
    }
}

/// The matrix T of a state, in the basis Q.
#[derive(Clone, Debug, Default)]
pub(super) struct ProjectedMatrix {
    projection: Projection,
    n: usize,
    /// Qᵀ H Q.
    turned: Vec<f64>,
    /// Zᵀ H Z, bordered by the identity to order n, of which Factor makes its factors.
    pub free: Vec<f64>,
    pub ones: Vec<f64>,
    work: Vec<f64>,
}

impl ProjectedMatrix {
    /// Takes the dimensionless H.
    pub fn update(&mut self, projection: &Projection, tangent: &[f64], scale: &[f64]) {
        self.projection.clone_from(projection);
        let (n, rank) = (scale.len(), projection.rank());
        self.n = n;
        self.ones.resize(n, 1.0);
        self.work.resize(n, 0.0);
        self.turned.clear();
        for (row, s) in tangent.chunks(n.max(1)).zip(scale) {
            self.turned.extend(row.iter().zip(scale).map(|(h, t)| h * s * t));
        }
        let largest = self.turned.iter().fold(0.0f64, |m, h| m.max(h.abs()));
        projection.turn_matrix(&mut self.turned, &mut self.work);
        self.free.clear();
        self.free.resize(n * n, 0.0);
        let rounding = crate::tolerances::ROUNDING_FACTOR * n as f64 * f64::EPSILON * largest;
        for i in 0..n {
            if i < rank {
                self.free[i * n + i] = 1.0;
                continue;
            }
            let row = &self.turned[i * n + rank..(i + 1) * n];
            // A motion without stiffness, but for rounding.
            if row.iter().all(|h| h.abs() <= rounding) {
                continue;
            }
            self.free[i * n + rank..(i + 1) * n].copy_from_slice(row);
        }
        for i in rank..n {
            if (rank..n).all(|j| self.free[i * n + j] == 0.0) {
                (rank..n).for_each(|j| self.free[j * n + i] = 0.0);
            }
        }
    }

    /// Follows neutral motions to this state, whose residual has this size.
    pub fn follow_neutral(&mut self, neutral: &mut NeutralMotions, size: f64) {
        if !neutral.is_empty() {
            self.change_neutral(neutral, |neutral, free, _| neutral.follow(free, size));
        }
    }

    /// Finds neutral motions at an equilibrium whose residual has this size; whether some were not known.
    /// `load_gradient` is the change of the residual with the load.
    pub fn find_neutral(&mut self, neutral: &mut NeutralMotions, size: f64, load_gradient: &[f64]) -> bool {
        let mut rates = vec![];
        self.solve(&mut load_gradient.to_vec(), |b| rates.extend_from_slice(b));
        self.change_neutral(neutral, |neutral, free, rank| neutral.find(free, size, &rates, rank))
    }

    /// Changes neutral motions in the basis Q, and the stiffness that they have in the matrices.
    fn change_neutral<T>(
        &mut self,
        neutral: &mut NeutralMotions,
        change: impl FnOnce(&mut NeutralMotions, &mut [f64], usize) -> T,
    ) -> T {
        let Self { projection, n, turned, free, .. } = self;
        let (n, rank) = (*n, projection.rank());
        neutral.change_basis(|z| {
            projection.turn(z);
            z[..rank].fill(0.0);
        });
        let found = change(neutral, free, rank);
        for i in rank..n {
            turned[i * n + rank..(i + 1) * n].copy_from_slice(&free[i * n + rank..(i + 1) * n]);
        }
        neutral.change_basis(|z| projection.turn_back(z));
        found
    }

    /// T itself, in the dimensionless coordinates.
    pub fn matrix(&self) -> Vec<f64> {
        let (n, rank) = (self.n, self.projection.rank());
        let mut matrix = self.turned.clone();
        for i in 0..rank {
            matrix[i * n..(i + 1) * n].fill(0.0);
            matrix[i * n + i] = 1.0;
        }
        self.projection.turn_matrix_back(&mut matrix, &mut vec![0.0; n]);
        matrix
    }

    /// Z Zᵀ H Z Zᵀ.
    pub fn free_matrix(&self) -> Vec<f64> {
        let (n, rank) = (self.n, self.projection.rank());
        let mut matrix = self.turned.clone();
        for i in 0..n {
            for j in (0..n).filter(|j| i < rank || *j < rank) {
                matrix[i * n + j] = 0.0;
            }
        }
        self.projection.turn_matrix_back(&mut matrix, &mut vec![0.0; n]);
        matrix
    }

    /// b ← Qᵀ b on the motions that the conditions allow, zero on the others.
    pub fn turn_free(&self, b: &mut [f64]) {
        self.projection.turn(b);
        b[..self.projection.rank()].fill(0.0);
    }

    /// Smallest diagonal entry of Zᵀ H Z, and the largest absolute row sum, a bound on its eigenvalues.
    pub fn bounds(&self) -> (f64, f64) {
        let (n, rank) = (self.n, self.projection.rank());
        let rows = || (rank..n).map(|i| &self.free[i * n..(i + 1) * n]);
        let lowest = rows().zip(rank..).map(|(row, i)| row[i]).fold(f64::INFINITY, f64::min);
        let largest = rows().map(|row| row.iter().map(|h| h.abs()).sum::<f64>()).fold(0.0, f64::max);
        (lowest, largest)
    }

    /// Solves T x = b in place; `inner` solves with [`ProjectedMatrix::free`].
    pub fn solve(&self, b: &mut [f64], inner: impl FnOnce(&mut [f64])) {
        let (n, rank) = (self.n, self.projection.rank());
        self.projection.turn(b);
        let held = b[..rank].to_vec();
        for i in rank..n {
            b[i] -= dot(&self.turned[i * n..i * n + rank], &held);
        }
        inner(b);
        b[..rank].copy_from_slice(&held);
        self.projection.turn_back(b);
    }

    /// Solves Tᵀ x = b in place; `inner` solves with the transposed [`ProjectedMatrix::free`].
    pub fn solve_transposed(&self, b: &mut [f64], inner: impl FnOnce(&mut [f64])) {
        let (n, rank) = (self.n, self.projection.rank());
        self.projection.turn(b);
        let held = b[..rank].to_vec();
        b[..rank].fill(0.0);
        inner(b);
        for j in 0..rank {
            b[j] = held[j] - (rank..n).map(|i| self.turned[i * n + j] * b[i]).sum::<f64>();
        }
        self.projection.turn_back(b);
    }

    /// Solves for the adjoint of an output, in place:
    ///
    /// ```text
    /// Hᵀ α + Jᵀ ν = b,   −J α = d,
    /// ```
    ///
    /// with b and d the derivatives of the output by the state and by the reactions; then they hold α and ν
    /// (zero for redundant conditions). `inner` solves with the transposed [`ProjectedMatrix::free`].
    pub fn solve_adjoint(&self, b: &mut [f64], d: &mut [f64], inner: impl FnOnce(&mut [f64])) {
        let (n, rank, projection) = (self.n, self.projection.rank(), &self.projection);
        let mut held: Vec<f64> = projection.kept().iter().map(|k| -d[*k]).collect();
        projection.solve_transposed(&mut held);
        projection.turn(b);
        let mut forces = b[..rank].to_vec();
        b[..rank].copy_from_slice(&held);
        let transposed = |i: usize, x: &[f64], first: usize| {
            x.iter().enumerate().map(|(j, x)| self.turned[(first + j) * n + i] * x).sum::<f64>()
        };
        for i in rank..n {
            b[i] -= transposed(i, &held, 0);
        }
        b[..rank].fill(0.0);
        inner(b);
        b[..rank].copy_from_slice(&held);
        for (i, force) in forces.iter_mut().enumerate() {
            *force -= transposed(i, b, 0);
        }
        projection.solve(&mut forces);
        d.fill(0.0);
        projection.kept().iter().zip(forces).for_each(|(k, force)| d[*k] = force);
        projection.turn_back(b);
    }

    /// Turns vectors of the basis Q into coordinates.
    pub fn turn_back(&self, b: &mut [f64]) {
        self.projection.turn_back(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tolerances::DEPENDENT;

    /// Numbers without a pattern.
    fn wave(i: usize, j: usize) -> f64 {
        (1.7 * i as f64 + 0.9 * (j * j) as f64 + 0.3).sin()
    }

    #[test]
    fn a_projected_step_keeps_the_conditions_and_balances_free_forces() {
        let n = 6;
        let gradients: Vec<Vec<f64>> = (0..2).map(|k| (0..n).map(|i| wave(i, k)).collect()).collect();
        // A third condition that follows from the others.
        let sum: Vec<f64> = (0..n).map(|i| gradients[0][i] - 2.0 * gradients[1][i]).collect();
        let rows = [&gradients[0][..], &sum, &gradients[1]];
        let mut projection = Projection::default();
        projection.factorise(rows.into_iter().enumerate(), &vec![1.0; n], |_, _| DEPENDENT);
        assert_eq!((projection.kept(), projection.redundant()), (&[0, 1][..], &[2][..]));
        let h: Vec<f64> = (0..n * n)
            .map(|m| if m % (n + 1) == 0 { 8.0 } else { wave(m / n, 3) * wave(m % n, 3) })
            .collect();
        let mut matrix = ProjectedMatrix::default();
        matrix.update(&projection, &h, &vec![1.0; n]);
        let free = nalgebra::DMatrix::from_row_slice(n, n, &matrix.free);
        let inner = |b: &mut [f64]| {
            let x = free.clone().lu().solve(&nalgebra::DVector::from_column_slice(b)).unwrap();
            b.copy_from_slice(x.as_slice());
        };
        let whole = nalgebra::DMatrix::from_row_slice(n, n, &matrix.matrix());
        let b: Vec<f64> = (0..n).map(|i| wave(i, 7)).collect();
        let mut x = b.clone();
        matrix.solve(&mut x, inner);
        let product = &whole * nalgebra::DVector::from_column_slice(&x);
        for (p, b) in product.iter().zip(&b) {
            assert!((p - b).abs() < 1e-12, "{p} {b}");
        }
        let mut y = b.clone();
        matrix.solve_transposed(&mut y, inner);
        let product = whole.transpose() * nalgebra::DVector::from_column_slice(&y);
        for (p, b) in product.iter().zip(&b) {
            assert!((p - b).abs() < 1e-12, "{p} {b}");
        }
        let (mut alpha, mut nu) = (b.clone(), vec![0.4, -0.2, 0.0]);
        matrix.solve_adjoint(&mut alpha, &mut nu, inner);
        assert!((-dot(rows[0], &alpha) - 0.4).abs() < 1e-12 && (-dot(rows[1], &alpha) + 0.2).abs() < 1e-12);
        for i in 0..n {
            let force: f64 = (0..n).map(|j| h[j * n + i] * alpha[j]).sum();
            let total = force + nu[0] * rows[0][i] + nu[1] * rows[1][i];
            assert!((total - b[i]).abs() < 1e-12, "{total} {}", b[i]);
        }
    }
}
