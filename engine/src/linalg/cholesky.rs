//! Cholesky factorisation of a shifted, symmetrically scaled matrix into a reused buffer.

use super::LANES;

/// `S A S + λ I = Uᵀ U`, with `A` given by its upper triangle and `S` diagonal.
#[derive(Clone, Debug)]
pub struct Cholesky {
    n: usize,
    /// Row-major upper factor; what lies below the diagonal is never read.
    factor: Vec<f64>,
    inverse_diagonal: Vec<f64>,
}

impl Cholesky {
    /// A buffer for matrices of order `n`.
    pub fn new(n: usize) -> Self {
        Self { n, factor: vec![0.0; n * n], inverse_diagonal: vec![0.0; n] }
    }

    /// Factorises; `false` when the matrix is not (numerically) positive definite.
    pub fn factorise(&mut self, a: &[f64], scale: &[f64], shift: f64) -> bool {
        let n = self.n;
        for i in 0..n {
            let (done, rest) = self.factor.split_at_mut(i * n);
            let row = &mut rest[i..n];
            let source = &a[i * n + i..i * n + n];
            for ((r, x), s) in row.iter_mut().zip(source).zip(&scale[i..n]) {
                *r = x * s * scale[i];
            }
            let largest = row[0].abs() + shift;
            row[0] += shift;
            let mut k = 0;
            // Four rows at a time: one load and store of the target row serves four updates.
            while k + 4 <= i {
                let [a0, a1, a2, a3] = [0, 1, 2, 3].map(|j| &done[(k + j) * n + i..(k + j) * n + n]);
                let (m0, m1, m2, m3) = (a0[0], a1[0], a2[0], a3[0]);
                for ((((r, x0), x1), x2), x3) in row.iter_mut().zip(a0).zip(a1).zip(a2).zip(a3) {
                    *r -= (m0 * x0 + m1 * x1) + (m2 * x2 + m3 * x3);
                }
                k += 4;
            }
            while k < i {
                let other = &done[k * n + i..k * n + n];
                let m = other[0];
                for (r, x) in row.iter_mut().zip(other) {
                    *r -= m * x;
                }
                k += 1;
            }
            // A pivot lost to cancellation is as good as not positive; NaN fails the comparison too.
            if !(row[0] > 1e-14 * largest) {
                return false;
            }
            let pivot = row[0].sqrt();
            let inverse = 1.0 / pivot;
            self.inverse_diagonal[i] = inverse;
            for r in row.iter_mut() {
                *r *= inverse;
            }
        }
        true
    }

    /// Ratio of the smallest to the largest pivot of the last factorisation.
    pub fn pivot_ratio(&self) -> f64 {
        let largest = self.inverse_diagonal.iter().fold(0.0f64, |m, d| m.max(*d));
        let smallest = self.inverse_diagonal.iter().fold(f64::INFINITY, |m, d| m.min(*d));
        (smallest / largest).powi(2)
    }

    /// Solves `Uᵀ y = b` in place.
    pub fn solve_lower(&self, b: &mut [f64]) {
        let n = self.n;
        for i in 0..n {
            let y = b[i] * self.inverse_diagonal[i];
            b[i] = y;
            for (x, u) in b[i + 1..].iter_mut().zip(&self.factor[i * n + i + 1..i * n + n]) {
                *x -= y * u;
            }
        }
    }

    /// Solves `U x = y` in place.
    pub fn solve_upper(&self, y: &mut [f64]) {
        let n = self.n;
        for i in (0..n).rev() {
            let row = &self.factor[i * n + i + 1..i * n + n];
            y[i] = (y[i] - inner(row, &y[i + 1..])) * self.inverse_diagonal[i];
        }
    }

    /// Solves `Uᵀ U x = b` in place.
    pub fn solve(&self, b: &mut [f64]) {
        self.solve_lower(b);
        self.solve_upper(b);
    }
}

/// Inner product, with as many partial sums as a vector register holds.
#[inline]
fn inner(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_a_shifted_scaled_system() {
        let n = 7;
        let entry = |i: usize, j: usize| 1.0 / (1.0 + i.abs_diff(j) as f64) + if i == j { 0.5 } else { 0.0 };
        let a: Vec<f64> = (0..n * n).map(|m| entry(m / n, m % n)).collect();
        let scale: Vec<f64> = (0..n).map(|i| 0.5 + i as f64).collect();
        let x: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let mut b: Vec<f64> = (0..n)
            .map(|i| (0..n).map(|j| scale[i] * entry(i, j) * scale[j] * x[j]).sum::<f64>() + 0.3 * x[i])
            .collect();
        let mut factor = Cholesky::new(n);
        assert!(factor.factorise(&a, &scale, 0.3));
        factor.solve(&mut b);
        for (found, expected) in b.iter().zip(&x) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        assert!(!factor.factorise(&a, &scale, -10.0));
    }
}
