//! Functions of two numbers with their first and second derivatives.

use super::elementary;
use super::jet::Number;
use crate::linalg::fma;
use std::ops::{Add, Mul, Sub};

/// A function of a and b.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Jet2 {
    pub value: f64,
    /// By a and b.
    pub first: [f64; 2],
    /// By a twice, by both, by b twice.
    pub second: [f64; 3],
}

/// The pairs of variables of the second derivatives.
const PAIRS: [(usize, usize); 3] = [(0, 0), (0, 1), (1, 1)];

impl Jet2 {
    /// f(self), from f and its derivatives at the value.
    #[inline(always)]
    fn chain(self, [f, f1, f2]: [f64; 3]) -> Self {
        let d = self.first;
        let second = |k: usize| fma(f2 * d[PAIRS[k].0], d[PAIRS[k].1], f1 * self.second[k]);
        Self { value: f, first: [f1 * d[0], f1 * d[1]], second: [second(0), second(1), second(2)] }
    }
}

impl Add for Jet2 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: std::array::from_fn(|k| self.first[k] + other.first[k]),
            second: std::array::from_fn(|k| self.second[k] + other.second[k]),
        }
    }
}

impl Sub for Jet2 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl Mul for Jet2 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self, other);
        let second = |k: usize| {
            let (i, j) = PAIRS[k];
            let cross = fma(a.first[i], b.first[j], a.first[j] * b.first[i]);
            fma(a.second[k], b.value, fma(a.value, b.second[k], cross))
        };
        Self {
            value: a.value * b.value,
            first: std::array::from_fn(|i| fma(a.first[i], b.value, a.value * b.first[i])),
            second: std::array::from_fn(second),
        }
    }
}

impl Mul<f64> for Jet2 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            first: self.first.map(|d| d * factor),
            second: self.second.map(|d| d * factor),
        }
    }
}

impl Add<f64> for Jet2 {
    type Output = Self;
    #[inline(always)]
    fn add(self, constant: f64) -> Self {
        Self { value: self.value + constant, ..self }
    }
}

impl Number<f64> for Jet2 {
    #[inline(always)]
    fn recip(self) -> Self {
        let r = self.value.recip();
        self.chain([r, -r * r, 2.0 * r * r * r])
    }

    #[inline(always)]
    fn ln(self) -> Self {
        let r = self.value.recip();
        self.chain([elementary::ln(self.value), r, -r * r])
    }

    #[inline(always)]
    fn exp(self) -> Self {
        self.chain([elementary::exp(self.value); 3])
    }
}
