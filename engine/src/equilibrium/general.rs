//! Factorisation and eigenvalues of the unsymmetric tangent of follower loads.

use super::stability::Stability;
use crate::linalg::Cholesky;
use crate::tolerances::{REAL_EIGENVALUE, ROUNDING_FACTOR};
use nalgebra::{Complex, DMatrix, DVector, Dyn, LU, Schur};

/// `P (S A S + λ) = L U`.
#[derive(Clone, Debug)]
pub(super) struct GeneralFactor {
    lu: LU<f64, Dyn, Dyn>,
    /// Where the matrix is singular, its pseudoinverse.
    pseudoinverse: Option<DMatrix<f64>>,
    symmetric: Cholesky,
}

impl GeneralFactor {
    pub fn new(n: usize) -> Self {
        Self { lu: DMatrix::identity(n, n).lu(), pseudoinverse: None, symmetric: Cholesky::new(n) }
    }

    /// Factorises `S A S + λ`; whether its determinant is positive or, to rounding, zero.
    pub fn factorise(&mut self, a: &[f64], scale: &[f64], shift: f64) -> bool {
        let mut matrix = scaled(a, scale);
        for i in 0..scale.len() {
            matrix[(i, i)] += shift;
        }
        self.pseudoinverse = None;
        self.lu = matrix.clone().lu();
        let pivots = self.lu.u().diagonal().abs();
        let rounding = ROUNDING_FACTOR * scale.len() as f64 * f64::EPSILON;
        if pivots.min() <= rounding * pivots.max() && matrix.iter().all(|x| x.is_finite()) {
            let cutoff = rounding * matrix.norm();
            self.pseudoinverse = matrix.pseudo_inverse(cutoff.max(f64::MIN_POSITIVE)).ok();
            return self.pseudoinverse.is_some();
        }
        self.lu.determinant() > 0.0
    }

    /// Whether the matrix factorised last is singular, to rounding.
    pub fn is_singular(&self) -> bool {
        self.pseudoinverse.is_some()
    }

    /// Solves in place; a singular matrix by its pseudoinverse.
    pub fn solve(&self, b: &mut [f64]) {
        let mut x = DVector::from_column_slice(b);
        if let Some(inverse) = &self.pseudoinverse {
            b.copy_from_slice((inverse * x).as_slice());
        } else if self.lu.solve_mut(&mut x) {
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
        let mut x = DVector::from_column_slice(b);
        if let Some(inverse) = &self.pseudoinverse {
            b.copy_from_slice((inverse.transpose() * x).as_slice());
            return;
        }
        let (l, u) = (self.lu.l(), self.lu.u());
        let solved = u.tr_solve_upper_triangular_mut(&mut x) && l.tr_solve_lower_triangular_mut(&mut x);
        self.lu.p().inv_permute_rows(&mut x);
        b.copy_from_slice(x.as_slice());
        if !solved {
            b.fill(f64::NAN);
        }
    }

    /// The static stability of `S A S`.
    ///
    /// A positive definite symmetric part is sufficient and cheap to test; otherwise the eigenvalues
    /// decide. Static stability is lost where the matrix becomes singular, so that one or several real
    /// eigenvalues turn negative. Rounding splits equal ones into complex pairs. The real parts of a pair
    /// may change their sign with the units of the coordinates, as with masses: a pair counts as stable
    /// or unstable only if it is so in these units and with the matrix equilibrated. It does not count as
    /// stable if there are units in which it is not, those in which one or two coordinates outweigh the rest.
    pub fn stability(&mut self, a: &[f64], scale: &[f64], slack: f64) -> Stability {
        let n = scale.len();
        let half: Vec<f64> = (0..n * n).map(|m| 0.5 * (a[m] + a[(m % n) * n + m / n])).collect();
        if self.symmetric.factorise(&half, scale, -slack) {
            return Stability::Stable;
        }
        let mut matrix = scaled(a, scale);
        let here = in_units(&matrix, slack);
        if here == Stability::Unstable && matrix.determinant() < 0.0 {
            return here;
        }
        equilibrate(&mut matrix, slack);
        let grows = |s: Stability| matches!(s, Stability::Unstable | Stability::FlutterUndecided);
        let equilibrated = in_units(&matrix, slack);
        match here {
            Stability::Stable | Stability::Neutral
                if grows(equilibrated) || has_negative_minor(&matrix, slack) =>
            {
                Stability::FlutterUndecided
            }
            Stability::Unstable if equilibrated != here => Stability::FlutterUndecided,
            _ => here,
        }
    }
}

/// The stability of a matrix by its eigenvalues.
fn in_units(matrix: &DMatrix<f64>, slack: f64) -> Stability {
    let Some(eigenvalues) = eigenvalues(matrix) else { return Stability::Unknown };
    let real = real_to(matrix);
    if eigenvalues.iter().any(|e| e.re < -slack && e.im.abs() <= real) {
        Stability::Unstable
    } else if eigenvalues.iter().any(|e| e.re < -slack) {
        Stability::FlutterUndecided
    } else if eigenvalues.iter().any(|e| e.re <= slack) {
        Stability::Neutral
    } else {
        Stability::Stable
    }
}

/// Whether a principal minor of one or two coordinates is negative, in any units: an eigenvalue is, in those in
/// which these coordinates outweigh the others.
fn has_negative_minor(equilibrated: &DMatrix<f64>, slack: f64) -> bool {
    let a = equilibrated;
    let negative = |i: usize, j: usize| a[(i, i)] * a[(j, j)] - a[(i, j)] * a[(j, i)] < -slack;
    (0..a.nrows()).any(|i| a[(i, i)] < -slack || (0..i).any(|j| negative(i, j)))
}

/// Scales coordinates until the largest entry of each row and its column is one, but for those that
/// are zero to `slack` (Ruiz).
fn equilibrate(matrix: &mut DMatrix<f64>, slack: f64) {
    let n = matrix.nrows();
    for _ in 0..EQUILIBRATIONS {
        for i in 0..n {
            let largest = matrix.row(i).amax().max(matrix.column(i).amax());
            if largest > slack {
                let factor = 1.0 / largest.sqrt();
                matrix.row_mut(i).scale_mut(factor);
                matrix.column_mut(i).scale_mut(factor);
            }
        }
    }
}

/// Iterations of the equilibration, which converges linearly.
const EQUILIBRATIONS: usize = 10;

/// Deflation thresholds of the QR iteration, tried in order: at machine precision it can cycle.
const DEFLATION: [f64; 3] = [f64::EPSILON, 1e-14, 1e-13];
/// Sweeps of the QR iteration per row.
const SWEEPS: usize = 30;

/// Largest imaginary part that counts as zero.
fn real_to(matrix: &DMatrix<f64>) -> f64 {
    REAL_EIGENVALUE * matrix.norm() / (matrix.nrows() as f64).sqrt()
}

/// Eigenvalues of a matrix, by QR iteration; where it cycles, of a similar one.
fn eigenvalues(matrix: &DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    if !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    let n = matrix.nrows();
    let schur = |matrix: &DMatrix<f64>| {
        let tried = |eps: &f64| Schur::try_new(matrix.clone(), *eps, SWEEPS * n);
        DEFLATION.iter().find_map(tried).map(|schur| schur.complex_eigenvalues().iter().copied().collect())
    };
    schur(matrix).or_else(|| {
        (1..=3).find_map(|turn| {
            let mirror =
                DVector::from_fn(n, |i, _| ((i + 1) as f64 * 1.3 * f64::from(turn)).sin()).normalize();
            let reflection = DMatrix::identity(n, n) - &mirror * mirror.transpose() * 2.0;
            schur(&(&reflection * matrix * &reflection))
        })
    })
}

/// The lowest real part of the eigenvalues of `S A S`, and the direction of the lowest real eigenvalue
/// if that is negative: of unit length and a fixed sign.
pub(super) fn lowest(a: &[f64], scale: &[f64]) -> Option<(f64, Option<Vec<f64>>)> {
    let matrix = scaled(a, scale);
    let n = scale.len();
    let found = eigenvalues(&matrix)?;
    let low = found.iter().map(|e| e.re).fold(f64::INFINITY, f64::min);
    let real = real_to(&matrix);
    let negative = found.iter().filter(|e| e.im.abs() <= real).map(|e| e.re).fold(0.0, f64::min);
    let direction = (negative < 0.0).then(|| {
        let near = negative - 1e-10 * matrix.norm();
        let factor = (matrix - DMatrix::identity(n, n) * near).lu();
        let mut x = DVector::from_fn(n, |i, _| 1.0 + 0.1 * ((i + 1) as f64).sin());
        for _ in 0..4 {
            x.normalize_mut();
            factor.solve_mut(&mut x);
        }
        x.normalize_mut();
        x.as_slice().to_vec()
    });
    Some((low, direction.filter(|x| x.iter().all(|x| x.is_finite()))))
}

fn scaled(a: &[f64], scale: &[f64]) -> DMatrix<f64> {
    let n = scale.len();
    DMatrix::from_fn(n, n, |i, j| a[i * n + j] * scale[i] * scale[j])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_whose_sign_hangs_on_the_units_is_never_stable() {
        // Trace < 0 where the first coordinate outweighs the second, > 0 in the other units.
        let a = [-0.95, 1.0, -0.17, 0.05];
        for (unit, expected) in [
            (0.01, Stability::Unstable),
            (1.0, Stability::Unstable),
            (10.0, Stability::FlutterUndecided),
            (100.0, Stability::FlutterUndecided),
        ] {
            assert_eq!(GeneralFactor::new(2).stability(&a, &[1.0, unit], 1e-9), expected, "{unit}");
        }
        let held = [0.95, 1.0, -0.17, 0.05];
        for unit in [0.01, 1.0, 100.0] {
            assert_eq!(GeneralFactor::new(2).stability(&held, &[1.0, unit], 1e-9), Stability::Stable);
        }
    }
}
