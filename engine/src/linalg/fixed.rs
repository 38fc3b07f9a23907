//! Fixed-size vectors and matrices, small enough to live in registers.

use std::ops::{Add, AddAssign, Index, IndexMut, Mul, Neg, Sub, SubAssign};

/// Columns in a block: the numbers that a vector register holds.
pub const LANES: usize = 4;

/// `a b + c`, rounded once where the machine can.
#[inline(always)]
pub(crate) fn fma(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_feature = "fma") { a.mul_add(b, c) } else { a * b + c }
}

/// A column of `N` numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<const N: usize>(pub [f64; N]);

/// A row-major `R` × `C` block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix<const R: usize, const C: usize>(pub [[f64; C]; R]);

impl<const N: usize> Vector<N> {
    /// All zeros.
    pub const ZERO: Self = Self([0.0; N]);

    /// The `i`-th unit vector.
    pub fn unit(i: usize) -> Self {
        let mut e = Self::ZERO;
        e[i] = 1.0;
        e
    }

    /// Inner product.
    #[inline]
    pub fn dot(&self, other: &Self) -> f64 {
        let mut sum = self[0] * other[0];
        for i in 1..N {
            sum = fma(self[i], other[i], sum);
        }
        sum
    }

    #[inline]
    fn add_multiple(&mut self, s: f64, other: &[f64; N]) {
        for i in 0..N {
            self[i] = fma(s, other[i], self[i]);
        }
    }

    /// Euclidean norm.
    #[inline]
    pub fn norm(&self) -> f64 {
        self.dot(self).sqrt()
    }
}

impl<const R: usize, const C: usize> Matrix<R, C> {
    /// All zeros.
    pub const ZERO: Self = Self([[0.0; C]; R]);

    /// Column `c`.
    #[inline]
    pub fn column(&self, c: usize) -> Vector<R> {
        let mut v = Vector::ZERO;
        for r in 0..R {
            v[r] = self.0[r][c];
        }
        v
    }

    /// Overwrites column `c`.
    #[inline]
    pub fn set_column(&mut self, c: usize, v: &Vector<R>) {
        for r in 0..R {
            self.0[r][c] = v[r];
        }
    }

    /// Transpose.
    #[inline]
    pub fn transpose(&self) -> Matrix<C, R> {
        let mut t = Matrix::ZERO;
        for r in 0..R {
            for c in 0..C {
                t.0[c][r] = self.0[r][c];
            }
        }
        t
    }

    /// `selfᵀ v`.
    #[inline]
    pub fn transpose_times(&self, v: &Vector<R>) -> Vector<C> {
        let mut out = Vector(self.0[0]) * v[0];
        for r in 1..R {
            out.add_multiple(v[r], &self.0[r]);
        }
        out
    }
}

impl<const R: usize, const C: usize> Matrix<R, C> {
    /// `selfᵀ other`.
    #[inline]
    pub fn transpose_times_matrix<const K: usize>(&self, other: &Matrix<R, K>) -> Matrix<C, K> {
        Matrix(std::array::from_fn(|c| {
            let mut row = Vector(other.0[0]) * self.0[0][c];
            for r in 1..R {
                row.add_multiple(self.0[r][c], &other.0[r]);
            }
            row.0
        }))
    }
}

impl<const N: usize> Matrix<N, N> {
    /// The identity.
    pub fn identity() -> Self {
        Self::diagonal(1.0)
    }

    /// `s` times the identity.
    #[inline]
    pub fn diagonal(s: f64) -> Self {
        let mut m = Self::ZERO;
        for i in 0..N {
            m.0[i][i] = s;
        }
        m
    }
}

/// The outer product `a bᵀ`.
impl<const R: usize> Vector<R> {
    /// `self otherᵀ`.
    #[inline]
    pub fn outer<const C: usize>(&self, other: &Vector<C>) -> Matrix<R, C> {
        let mut m = Matrix::ZERO;
        for r in 0..R {
            for c in 0..C {
                m.0[r][c] = self[r] * other[c];
            }
        }
        m
    }
}

impl<const N: usize> Index<usize> for Vector<N> {
    type Output = f64;
    #[inline]
    fn index(&self, i: usize) -> &f64 {
        &self.0[i]
    }
}

impl<const N: usize> IndexMut<usize> for Vector<N> {
    #[inline]
    fn index_mut(&mut self, i: usize) -> &mut f64 {
        &mut self.0[i]
    }
}

macro_rules! elementwise {
    ($trait:ident, $method:ident, $assign_trait:ident, $assign:ident, $op:tt) => {
        impl<const N: usize> $assign_trait for Vector<N> {
            #[inline]
            fn $assign(&mut self, other: Self) {
                for i in 0..N {
                    self.0[i] $op other.0[i];
                }
            }
        }
        impl<const N: usize> $trait for Vector<N> {
            type Output = Self;
            #[inline]
            fn $method(mut self, other: Self) -> Self {
                $assign_trait::$assign(&mut self, other);
                self
            }
        }
        impl<const R: usize, const C: usize> $assign_trait for Matrix<R, C> {
            #[inline]
            fn $assign(&mut self, other: Self) {
                for r in 0..R {
                    for c in 0..C {
                        self.0[r][c] $op other.0[r][c];
                    }
                }
            }
        }
        impl<const R: usize, const C: usize> $trait for Matrix<R, C> {
            type Output = Self;
            #[inline]
            fn $method(mut self, other: Self) -> Self {
                $assign_trait::$assign(&mut self, other);
                self
            }
        }
    };
}
elementwise!(Add, add, AddAssign, add_assign, +=);
elementwise!(Sub, sub, SubAssign, sub_assign, -=);

impl<const N: usize> Neg for Vector<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl<const N: usize> Mul<f64> for Vector<N> {
    type Output = Self;
    #[inline]
    fn mul(mut self, s: f64) -> Self {
        for x in &mut self.0 {
            *x *= s;
        }
        self
    }
}

impl<const R: usize, const C: usize> Mul<f64> for Matrix<R, C> {
    type Output = Self;
    #[inline]
    fn mul(mut self, s: f64) -> Self {
        for row in &mut self.0 {
            for x in row {
                *x *= s;
            }
        }
        self
    }
}

impl<const R: usize, const C: usize> Mul<Vector<C>> for Matrix<R, C> {
    type Output = Vector<R>;
    #[inline]
    fn mul(self, v: Vector<C>) -> Vector<R> {
        Vector(self.0.map(|row| Vector(row).dot(&v)))
    }
}

impl<const R: usize, const K: usize, const C: usize> Mul<Matrix<K, C>> for Matrix<R, K> {
    type Output = Matrix<R, C>;
    #[inline]
    fn mul(self, other: Matrix<K, C>) -> Matrix<R, C> {
        Matrix(self.0.map(|factors| {
            let mut row = Vector(other.0[0]) * factors[0];
            for k in 1..K {
                row.add_multiple(factors[k], &other.0[k]);
            }
            row.0
        }))
    }
}
