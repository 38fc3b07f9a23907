//! The three stretches of an incompressible fibre, of which material laws take sums of powers.

use super::elementary;
use super::jet::Number;
use super::jet2::Jet2;
use super::law::LawConstant;
use std::marker::PhantomData;

/// Sums over the stretches λ₁, λ₂, λ₃ of a fibre.
pub(super) trait Stretches<C, N> {
    /// λ₁ − 1, along the fibre.
    fn strain(&self) -> N;
    /// I₁ − 3 = Σ λᵢ² − 3.
    fn squares(&self) -> N;
    /// I₂ − 3 = Σ λᵢ⁻² − 3.
    fn inverse_squares(&self) -> N;
    /// Σ λᵢᵅ − 3.
    fn powers(&self, exponent: C) -> N;
}

/// A fibre that contracts sideways alike.
#[derive(Clone, Copy, Debug)]
pub(super) struct Free<N>(pub N);

/// A fibre whose hoop stretch is one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept<N>(pub N);

/// A fibre of a curved wall: stretches along it and across.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hooped<C, N> {
    along: N,
    hoop: N,
    logarithms: [N; 2],
    constants: PhantomData<C>,
}

/// The same; what it makes are functions of the logarithms of both.
#[derive(Clone, Copy, Debug)]
pub(super) struct Logarithmic {
    pub along: f64,
    pub hoop: f64,
}

impl<C: LawConstant, N: Number<C>> Stretches<C, N> for Free<N> {
    #[inline(always)]
    fn strain(&self) -> N {
        self.0 + -1.0
    }

    #[inline(always)]
    fn squares(&self) -> N {
        self.0 * self.0 + self.0.recip() + self.0.recip() + -3.0
    }

    #[inline(always)]
    fn inverse_squares(&self) -> N {
        self.0 + self.0 + (self.0 * self.0).recip() + -3.0
    }

    #[inline(always)]
    fn powers(&self, exponent: C) -> N {
        let along = self.0.ln();
        N::powers(along, along * C::from(-0.5), exponent) + -3.0
    }
}

impl<C: LawConstant, N: Number<C>> Stretches<C, N> for Kept<N> {
    #[inline(always)]
    fn strain(&self) -> N {
        self.0 + -1.0
    }

    #[inline(always)]
    fn squares(&self) -> N {
        let square = self.0 * self.0;
        square + square.recip() + -2.0
    }

    #[inline(always)]
    fn inverse_squares(&self) -> N {
        <Self as Stretches<C, N>>::squares(self)
    }

    #[inline(always)]
    fn powers(&self, exponent: C) -> N {
        let power = (self.0.ln() * exponent).exp();
        power + power.recip() + -2.0
    }
}

impl<C, N: Number<C>> Hooped<C, N>
where
    C: Copy,
{
    pub fn new(along: N, hoop: N) -> Self {
        Self { along, hoop, logarithms: [along.ln(), hoop.ln()], constants: PhantomData }
    }
}

impl<C: LawConstant, N: Number<C>> Stretches<C, N> for Hooped<C, N> {
    fn strain(&self) -> N {
        self.along + -1.0
    }

    fn squares(&self) -> N {
        let (along, hoop) = (self.along * self.along, self.hoop * self.hoop);
        along + hoop + (along * hoop).recip() + -3.0
    }

    fn inverse_squares(&self) -> N {
        let (along, hoop) = (self.along * self.along, self.hoop * self.hoop);
        along.recip() + hoop.recip() + along * hoop + -3.0
    }

    fn powers(&self, exponent: C) -> N {
        N::powers(self.logarithms[0], self.logarithms[1], exponent) + -3.0
    }
}

impl Logarithmic {
    /// Σ λᵢᵅ − 3, given λ₁ᵅ and λ₂ᵅ.
    #[inline(always)]
    fn sum(along: f64, hoop: f64, exponent: f64) -> Jet2 {
        let third = (along * hoop).recip();
        let square = exponent * exponent;
        Jet2 {
            value: along + hoop + third - 3.0,
            first: [exponent * (along - third), exponent * (hoop - third)],
            second: [square * (along + third), square * third, square * (hoop + third)],
        }
    }
}

impl Stretches<f64, Jet2> for Logarithmic {
    #[inline(always)]
    fn strain(&self) -> Jet2 {
        let along = self.along;
        Jet2 { value: along - 1.0, first: [along, 0.0], second: [along, 0.0, 0.0] }
    }

    #[inline(always)]
    fn squares(&self) -> Jet2 {
        Self::sum(self.along * self.along, self.hoop * self.hoop, 2.0)
    }

    #[inline(always)]
    fn inverse_squares(&self) -> Jet2 {
        let (along, hoop) = (self.along.recip(), self.hoop.recip());
        Self::sum(along * along, hoop * hoop, -2.0)
    }

    #[inline(always)]
    fn powers(&self, exponent: f64) -> Jet2 {
        let [along, hoop] = [self.along, self.hoop].map(|x| elementary::exp(exponent * elementary::ln(x)));
        Self::sum(along, hoop, exponent)
    }
}
