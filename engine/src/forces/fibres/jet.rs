//! Numbers that carry their derivatives, so that each material law is written once.

use super::elementary;
use crate::linalg::fma;
use std::ops::{Add, Mul, Sub};

/// What a material law computes with; C are its constants.
pub(super) trait Number<C: Copy>:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<C, Output = Self>
    + Add<f64, Output = Self>
{
    fn recip(self) -> Self;
    fn ln(self) -> Self;
    fn exp(self) -> Self;

    /// λ₁ᵅ + λ₂ᵅ + λ₃ᵅ of stretches whose product is one, given the logarithms of two.
    #[inline(always)]
    fn powers(first: Self, second: Self, exponent: C) -> Self {
        let (a, b) = ((first * exponent).exp(), (second * exponent).exp());
        a + b + (a * b).recip()
    }
}

/// A function of a stretch, with its first and second derivative.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Jet {
    pub value: f64,
    pub first: f64,
    pub second: f64,
}

/// A constant and its derivative with respect to some parameter s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constant {
    pub value: f64,
    pub by_parameter: f64,
}

/// A function of stretches and its derivative with respect to a parameter s.
#[derive(Clone, Copy, Debug)]
pub(super) struct MixedJet<T> {
    pub value: T,
    pub by_parameter: T,
}

impl Jet {
    /// f(self), from f and its derivatives at the value.
    #[inline(always)]
    fn chain(self, [f, f1, f2]: [f64; 3]) -> Self {
        let first = self.first;
        Self { value: f, first: f1 * first, second: fma(f2 * first, first, f1 * self.second) }
    }
}

impl Add for Jet {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: self.first + other.first,
            second: self.second + other.second,
        }
    }
}

impl Sub for Jet {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl Mul for Jet {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self, other);
        let second = fma(2.0 * a.first, b.first, a.value * b.second);
        Self {
            value: a.value * b.value,
            first: fma(a.first, b.value, a.value * b.first),
            second: fma(a.second, b.value, second),
        }
    }
}

impl Mul<f64> for Jet {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        Self { value: self.value * factor, first: self.first * factor, second: self.second * factor }
    }
}

impl Add<f64> for Jet {
    type Output = Self;
    #[inline(always)]
    fn add(self, constant: f64) -> Self {
        Self { value: self.value + constant, ..self }
    }
}

impl Number<f64> for Jet {
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

    /// As by its definition, with fewer operations.
    #[inline(always)]
    fn powers(first: Self, second: Self, exponent: f64) -> Self {
        let [a, b] = [first, second].map(|x| elementary::exp(x.value * exponent));
        let c = (a * b).recip();
        let third = (first + second) * -1.0;
        let slope = fma(a, first.first, fma(b, second.first, c * third.first));
        let bend = |x: Self| fma(exponent * x.first, x.first, x.second);
        let second = fma(a, bend(first), fma(b, bend(second), c * bend(third)));
        Self { value: a + b + c, first: exponent * slope, second: exponent * second }
    }
}

impl<T: Default> From<T> for MixedJet<T> {
    /// A function that does not depend on the parameter.
    fn from(value: T) -> Self {
        Self { value, by_parameter: T::default() }
    }
}

impl<T: Number<f64>> Add for MixedJet<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, by_parameter: self.by_parameter + other.by_parameter }
    }
}

impl<T: Number<f64>> Sub for MixedJet<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + other * Constant::from(-1.0)
    }
}

impl<T: Number<f64>> Mul for MixedJet<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            by_parameter: self.by_parameter * other.value + self.value * other.by_parameter,
        }
    }
}

impl<T: Number<f64>> Mul<Constant> for MixedJet<T> {
    type Output = Self;
    fn mul(self, Constant { value, by_parameter }: Constant) -> Self {
        Self {
            value: self.value * value,
            by_parameter: self.by_parameter * value + self.value * by_parameter,
        }
    }
}

impl<T: Number<f64>> Add<f64> for MixedJet<T> {
    type Output = Self;
    fn add(self, constant: f64) -> Self {
        Self { value: self.value + constant, ..self }
    }
}

impl<T: Number<f64>> Number<Constant> for MixedJet<T> {
    fn recip(self) -> Self {
        let r = self.value.recip();
        Self { value: r, by_parameter: r * r * self.by_parameter * -1.0 }
    }

    fn ln(self) -> Self {
        Self { value: self.value.ln(), by_parameter: self.value.recip() * self.by_parameter }
    }

    fn exp(self) -> Self {
        let value = self.value.exp();
        Self { value, by_parameter: value * self.by_parameter }
    }
}

impl Constant {
    /// The constants of a law, with respect to the one of index `k`.
    pub fn seeded(constants: &[f64], k: usize) -> impl Iterator<Item = Self> + '_ {
        let seed = move |(i, value): (usize, &f64)| Self {
            value: *value,
            by_parameter: f64::from(u8::from(i == k)),
        };
        constants.iter().enumerate().map(seed)
    }
}

impl Mul<f64> for Constant {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { value: self.value * factor, by_parameter: self.by_parameter * factor }
    }
}

impl Add for Constant {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, by_parameter: self.by_parameter + other.by_parameter }
    }
}

impl From<f64> for Constant {
    fn from(value: f64) -> Self {
        Self { value, by_parameter: 0.0 }
    }
}
