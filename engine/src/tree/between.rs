//! A place between two sample points of a rod, whose fraction of the length is a parameter.
//!
//! With t from one sample point to the next, h apart, its position is that of the cubic Hermite polynomial
//! through both with the tangents of their frames: w₀ (r₀ + a₀ x̂₀) + w₁ (r₁ + a₁ x̂₁) with w₁ = t² (3 − 2t),
//! w₀ = 1 − w₁, a₀ = hL t/(1 + 2t) and a₁ = −hL (1 − t)/(3 − 2t). It passes through the sample points, and its
//! slope by the fraction is continuous there.

use super::Rod;

/// A place on a rod and the parameter that holds its fraction of the length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Between {
    /// Index in `tree.rods`.
    pub rod: usize,
    pub slot: usize,
}

/// Where such a place is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval {
    /// The sample point before it.
    pub before: usize,
    h: f64,
    t: f64,
}

impl Between {
    /// The interval between sample points in which the place is.
    pub fn interval(&self, rods: &[Rod], parameters: &[f64]) -> Interval {
        let (x, at) = (&rods[self.rod].x, parameters[self.slot]);
        let before = x.partition_point(|x| *x <= at).clamp(1, x.len() - 1) - 1;
        let h = x[before + 1] - x[before];
        Interval { before, h, t: ((at - x[before]) / h).clamp(0.0, 1.0) }
    }
}

impl Interval {
    /// w₁, the share of the sample point after the place, and its derivative by the fraction.
    pub fn share(&self) -> [f64; 2] {
        let Self { h, t, .. } = *self;
        [t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / h]
    }

    /// a₀ or a₁ over L, by side, and its derivative by the fraction.
    pub fn arm(&self, side: usize) -> [f64; 2] {
        let Self { h, t, .. } = *self;
        let bottom = if side == 0 { 1.0 + 2.0 * t } else { 3.0 - 2.0 * t };
        let top = if side == 0 { t } else { t - 1.0 };
        [h * top / bottom, 1.0 / (bottom * bottom)]
    }
}
