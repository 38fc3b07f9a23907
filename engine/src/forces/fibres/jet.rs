//! Numbers that carry their derivatives, so that each material law is written once.

use std::ops::{Add, Mul, Neg, Sub};

/// Fibres evaluated at once.
pub(super) const WIDTH: usize = 4;

/// One number for each of some fibres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lanes(pub [f64; WIDTH]);

/// What a material law computes with; C are its constants.
pub(super) trait Number<C>:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<C, Output = Self>
    + Add<f64, Output = Self>
{
    fn recip(self) -> Self;
    fn power(self, exponent: C) -> Self;
}

/// A function of a stretch, with its first and second derivative, of some fibres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet {
    pub value: Lanes,
    pub first: Lanes,
    pub second: Lanes,
}

/// A constant and its derivative with respect to some parameter s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constant {
    pub value: f64,
    pub by_parameter: f64,
}

/// A function of a stretch and of a parameter s: first and second derivative with respect to the
/// stretch, first with respect to s, and mixed.
#[derive(Clone, Copy, Debug)]
pub(super) struct MixedJet {
    pub value: f64,
    pub first: f64,
    pub second: f64,
    pub by_parameter: f64,
    pub mixed: f64,
}

impl Lanes {
    pub const ZERO: Self = Self([0.0; WIDTH]);

    #[inline(always)]
    pub fn all(value: f64) -> Self {
        Self([value; WIDTH])
    }

    #[inline(always)]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self(self.0.map(f))
    }

    /// The sum, always in the same order.
    #[inline(always)]
    pub fn sum(self) -> f64 {
        (self.0[0] + self.0[1]) + (self.0[2] + self.0[3])
    }

    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        self.with(other, f64::min)
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl Mul<f64> for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self.map(|a| a * factor)
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl Jet {
    /// The stretch itself.
    #[inline(always)]
    pub fn variable(value: Lanes, rate: Lanes) -> Self {
        Self { value, first: rate, second: Lanes::ZERO }
    }

    /// f(self), from f and its derivatives at the value.
    #[inline(always)]
    fn chain(self, [f, f1, f2]: [Lanes; 3]) -> Self {
        let first = self.first;
        Self { value: f, first: f1 * first, second: f2 * first * first + f1 * self.second }
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
        Self {
            value: a.value * b.value,
            first: a.first * b.value + a.value * b.first,
            second: a.second * b.value + a.first * b.first * 2.0 + a.value * b.second,
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

impl Mul<Lanes> for Jet {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: Lanes) -> Self {
        Self { value: self.value * factor, first: self.first * factor, second: self.second * factor }
    }
}

impl Add<Lanes> for Jet {
    type Output = Self;
    #[inline(always)]
    fn add(self, constant: Lanes) -> Self {
        Self { value: self.value + constant, ..self }
    }
}

impl Add<f64> for Jet {
    type Output = Self;
    #[inline(always)]
    fn add(self, constant: f64) -> Self {
        Self { value: self.value.map(|v| v + constant), ..self }
    }
}

impl Number<f64> for Jet {
    #[inline(always)]
    fn recip(self) -> Self {
        let r = self.value.map(f64::recip);
        let r2 = r * r;
        self.chain([r, -r2, r2 * r * 2.0])
    }

    #[inline]
    fn power(self, exponent: f64) -> Self {
        let r = self.value.map(f64::recip);
        let f = self.value.map(|v| v.powf(exponent));
        let f1 = f * r * exponent;
        self.chain([f, f1, f1 * r * (exponent - 1.0)])
    }
}

impl MixedJet {
    /// f(self), from f and its derivatives at the value.
    fn chain(self, [f, f1, f2]: [f64; 3]) -> Self {
        Self {
            value: f,
            first: f1 * self.first,
            second: f2 * self.first * self.first + f1 * self.second,
            by_parameter: f1 * self.by_parameter,
            mixed: f2 * self.first * self.by_parameter + f1 * self.mixed,
        }
    }
}

impl Add for MixedJet {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: self.first + other.first,
            second: self.second + other.second,
            by_parameter: self.by_parameter + other.by_parameter,
            mixed: self.mixed + other.mixed,
        }
    }
}

impl Sub for MixedJet {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + other * Constant { value: -1.0, by_parameter: 0.0 }
    }
}

impl Mul for MixedJet {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self, other);
        Self {
            value: a.value * b.value,
            first: a.first * b.value + a.value * b.first,
            second: a.second * b.value + 2.0 * a.first * b.first + a.value * b.second,
            by_parameter: a.by_parameter * b.value + a.value * b.by_parameter,
            mixed: a.mixed * b.value
                + a.first * b.by_parameter
                + a.by_parameter * b.first
                + a.value * b.mixed,
        }
    }
}

impl Mul<Constant> for MixedJet {
    type Output = Self;
    fn mul(self, Constant { value, by_parameter }: Constant) -> Self {
        self * Self { value, first: 0.0, second: 0.0, by_parameter, mixed: 0.0 }
    }
}

impl Add<f64> for MixedJet {
    type Output = Self;
    fn add(self, constant: f64) -> Self {
        Self { value: self.value + constant, ..self }
    }
}

impl Number<Constant> for MixedJet {
    fn recip(self) -> Self {
        let r = self.value.recip();
        self.chain([r, -r * r, 2.0 * r * r * r])
    }

    fn power(self, Constant { value: exponent, by_parameter }: Constant) -> Self {
        let x = self.value;
        let f = x.powf(exponent);
        let mut out = self.chain([f, exponent * f / x, exponent * (exponent - 1.0) * f / (x * x)]);
        out.by_parameter += f * x.ln() * by_parameter;
        out.mixed += f / x * (1.0 + exponent * x.ln()) * self.first * by_parameter;
        out
    }
}

impl Mul<f64> for Constant {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { value: self.value * factor, by_parameter: self.by_parameter * factor }
    }
}
