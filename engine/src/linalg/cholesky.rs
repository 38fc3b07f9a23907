//! Cholesky factorisation of a shifted, symmetrically scaled matrix into a reused buffer.
//!
//! The factor is kept in panels of [`LANES`] columns, each panel's rows one after another, so that
//! products of tiles and solutions stream through memory and fill the vector registers.

use super::{LANES, Matrix, Vector, fma};
use crate::tolerances::ROUNDING_FACTOR;

/// `LANES` numbers of one row.
type Row = [f64; LANES];
type Tile = [Row; LANES];

/// `S A S + λ I = Uᵀ U`, with `A` given by its upper triangle and `S` diagonal.
#[derive(Clone, Debug, Default)]
pub struct Cholesky {
    n: usize,
    /// Panel after panel, padded with the identity; only the part above the tiles on the diagonal
    /// is kept.
    panels: Vec<Row>,
    /// Inverses of the tiles on the diagonal, and their transposes.
    inverses: Vec<[Tile; 2]>,
    /// Pivots below this share of what was eliminated from them are lost in rounding.
    rounding: f64,
    /// Row at which the last factorisation ended because its pivot was zero to rounding.
    null_pivot: Option<usize>,
}

/// Rounding of a pivot of a matrix of order `n`, relative to its diagonal entry.
pub(super) fn pivot_rounding(n: usize) -> f64 {
    (ROUNDING_FACTOR * n as f64 * f64::EPSILON).max(1e-14)
}

impl Cholesky {
    /// A buffer for matrices of order `n`.
    pub fn new(n: usize) -> Self {
        let blocks = n.div_ceil(LANES);
        let row = [0.0; LANES];
        Self {
            n,
            panels: vec![row; blocks * blocks * LANES],
            inverses: vec![[[row; LANES]; 2]; blocks],
            rounding: pivot_rounding(n),
            null_pivot: None,
        }
    }

    /// Factorises; `false` when the matrix is not (numerically) positive definite.
    pub fn factorise(&mut self, a: &[f64], scale: &[f64], shift: f64) -> bool {
        let blocks = self.inverses.len();
        let rows = blocks * LANES;
        self.null_pivot = None;
        for i in 0..blocks {
            // U_ij = U_ii⁻ᵀ (A_ij − Σ_k U_kiᵀ U_kj), the diagonal tile first.
            let mut diagonal = scaled_tile(self.n, a, scale, [i, i]);
            let mut largest = [0.0; LANES];
            for r in 0..LANES {
                largest[r] = diagonal[r][r].abs() + shift;
                diagonal[r][r] += shift;
            }
            let (done, rest) = self.panels.split_at_mut((i + 1) * rows);
            let own = &mut done[i * rows..];
            subtract_products(&mut diagonal, &own[..i * LANES], &own[..i * LANES]);
            let mut inverse = [0.0; LANES];
            for r in 0..LANES {
                let (above, below) = diagonal.split_at_mut(r);
                let row = &mut below[0];
                for other in above {
                    subtract_row(row, other[r], other);
                }
                // A pivot lost to cancellation counts as not positive; NaN fails the comparison too.
                if !(row[r] > self.rounding * largest[r]) {
                    let null = row[r].abs() <= self.rounding * largest[r];
                    self.null_pivot = null.then_some(i * LANES + r);
                    return false;
                }
                inverse[r] = 1.0 / row[r].sqrt();
                row.iter_mut().for_each(|x| *x *= inverse[r]);
            }
            let own = &*own;
            let transposed = invert(&diagonal, &inverse);
            self.inverses[i] = [Matrix(transposed).transpose().0, transposed];
            for (j, panel) in (i + 1..blocks).zip(rest.chunks_exact_mut(rows)) {
                let mut tile = scaled_tile(self.n, a, scale, [i, j]);
                subtract_products(&mut tile, &own[..i * LANES], &panel[..i * LANES]);
                for (row, factors) in panel[i * LANES..][..LANES].iter_mut().zip(&transposed) {
                    *row = combine(factors, &tile);
                }
            }
        }
        true
    }

    /// The row at which the last factorisation ended because its pivot vanished, to rounding.
    pub fn null_pivot(&self) -> Option<usize> {
        self.null_pivot
    }

    /// Solves `Uᵀ y = b` in place.
    pub fn solve_lower(&self, b: &mut [f64]) {
        let rows = self.inverses.len() * LANES;
        for (i, [inverse, _]) in self.inverses.iter().enumerate() {
            let above = &self.panels[i * rows..][..i * LANES];
            let (before, rest) = b.split_at_mut(i * LANES);
            let mut y = load(rest);
            let mut even = [0.0; LANES];
            for (us, ys) in above.chunks_exact(2).zip(before.chunks_exact(2)) {
                subtract_row(&mut y, ys[0], &us[0]);
                subtract_row(&mut even, ys[1], &us[1]);
            }
            for r in 0..LANES {
                y[r] += even[r];
            }
            store(&combine(&y, inverse), rest);
        }
    }

    /// Solves `U x = y` in place.
    pub fn solve_upper(&self, y: &mut [f64]) {
        let rows = self.inverses.len() * LANES;
        for (i, [_, transposed]) in self.inverses.iter().enumerate().rev() {
            let (head, after) = y.split_at_mut(((i + 1) * LANES).min(self.n));
            let rest = &mut head[i * LANES..];
            let mut sums = [[0.0; LANES]; LANES];
            for (j, x) in (i + 1..).zip(after.chunks(LANES)) {
                let x = load(x);
                let tile = &self.panels[j * rows + i * LANES..][..LANES];
                for r in 0..LANES {
                    for lane in 0..LANES {
                        sums[r][lane] = fma(tile[r][lane], x[lane], sums[r][lane]);
                    }
                }
            }
            let mut x = load(rest);
            for r in 0..LANES {
                x[r] -= sums[r].iter().sum::<f64>();
            }
            store(&combine(&x, transposed), rest);
        }
    }

    /// Solves `Uᵀ U x = b` in place.
    pub fn solve(&self, b: &mut [f64]) {
        self.solve_lower(b);
        self.solve_upper(b);
    }
}

/// A tile of `S A S`, padded with the identity beyond order `n`.
#[inline]
fn scaled_tile(n: usize, a: &[f64], scale: &[f64], [i, j]: [usize; 2]) -> Tile {
    let mut tile = [[0.0; LANES]; LANES];
    let (top, left) = (i * LANES, j * LANES);
    if left + LANES <= n {
        let across = &scale[left..left + LANES];
        for r in 0..LANES {
            let source = &a[(top + r) * n + left..][..LANES];
            for c in 0..LANES {
                tile[r][c] = source[c] * across[c] * scale[top + r];
            }
        }
        return tile;
    }
    for r in 0..LANES {
        for c in 0..LANES {
            let (row, column) = (top + r, left + c);
            let inside = row < n && column < n;
            tile[r][c] = if inside {
                a[row * n + column] * scale[column] * scale[row]
            } else {
                f64::from(row == column)
            };
        }
    }
    tile
}

/// `tile −= Σ mᵀ u`; on its own, for the tile to stay in registers.
#[inline(never)]
fn subtract_products(tile: &mut Tile, ms: &[Row], us: &[Row]) {
    let [mut a, mut b, mut c, mut d] = *tile;
    for (m, u) in ms.iter().zip(us) {
        subtract_row(&mut a, m[0], u);
        subtract_row(&mut b, m[1], u);
        subtract_row(&mut c, m[2], u);
        subtract_row(&mut d, m[3], u);
    }
    *tile = [a, b, c, d];
}

/// The inverse of an upper triangular tile, transposed, given the inverses of its diagonal.
#[inline(always)]
fn invert(tile: &Tile, inverse: &Row) -> Tile {
    let mut v = [[0.0; LANES]; LANES];
    for c in 0..LANES {
        for r in 0..c {
            let mut sum = 0.0;
            for k in r..c {
                sum += v[k][r] * tile[k][c];
            }
            v[c][r] = -sum * inverse[c];
        }
        v[c][c] = inverse[c];
    }
    v
}

/// `Σ_k factors_k rows_k`.
#[inline(always)]
fn combine(factors: &Row, rows: &Tile) -> Row {
    Matrix(*rows).transpose_times(&Vector(*factors)).0
}

#[inline(always)]
fn subtract_row(row: &mut Row, m: f64, u: &Row) {
    for (x, u) in row.iter_mut().zip(u) {
        *x = fma(-m, *u, *x);
    }
}

/// The first numbers of `from`, padded with zeros.
#[inline(always)]
fn load(from: &[f64]) -> Row {
    match from.first_chunk() {
        Some(row) => *row,
        None => std::array::from_fn(|c| from.get(c).copied().unwrap_or(0.0)),
    }
}

#[inline(always)]
fn store(row: &Row, to: &mut [f64]) {
    match to.first_chunk_mut() {
        Some(to) => *to = *row,
        None => to.iter_mut().zip(row).for_each(|(t, x)| *t = *x),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_shifted_scaled_systems_of_any_order() {
        let entry = |i: usize, j: usize| 1.0 / (1.0 + i.abs_diff(j) as f64) + if i == j { 0.5 } else { 0.0 };
        for n in [1, 2, 3, 4, 5, 7, 8, 9, 25, 30] {
            let a: Vec<f64> = (0..n * n).map(|m| entry(m / n, m % n)).collect();
            let scale: Vec<f64> = (0..n).map(|i| 0.5 + i as f64).collect();
            let x: Vec<f64> = (0..n).map(|i| (1.0 + i as f64).sin()).collect();
            let product = |i: usize| (0..n).map(|j| scale[i] * entry(i, j) * scale[j] * x[j]).sum::<f64>();
            let mut b: Vec<f64> = (0..n).map(|i| product(i) + 0.3 * x[i]).collect();
            let mut factor = Cholesky::new(n);
            assert!(factor.factorise(&a, &scale, 0.3));
            factor.solve(&mut b);
            for (found, expected) in b.iter().zip(&x) {
                assert!((found - expected).abs() < 1e-12, "{found} {expected} of {n}");
            }
            assert!(!factor.factorise(&a, &scale, -1e3 * (n * n) as f64));
        }
    }
}
