//! Stumpff functions, the scalar coefficients of every closed form on SE(2) and SE(3).

use crate::linalg::{LANES, fma};

/// `c_k(x) = Σ_j (−x)^j / (2j + k)!` for `k = 0…7`, with `x` the squared rotation angle:
/// `c₀ = cos θ`, `c₁ = sin θ/θ`, `c₂ = (1 − cos θ)/θ²`, `c₃ = (θ − sin θ)/θ³`, …
#[derive(Clone, Copy, Debug)]
pub struct Stumpff {
    /// The argument `x = θ²`.
    pub x: f64,
    /// `c₀ … c₇`.
    pub c: [f64; 8],
}

const INVERSE_FACTORIAL: [f64; 8] =
    [1.0, 1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0];

/// Ratios of successive terms of the series of c₆ and c₇.
const SERIES: [[f64; 2]; 10] = {
    let mut ratios = [[0.0; 2]; 10];
    let mut j = 1;
    while j < 10 {
        let m = 2.0 * j as f64;
        ratios[j] = [1.0 / ((m + 5.0) * (m + 6.0)), 1.0 / ((m + 6.0) * (m + 7.0))];
        j += 1;
    }
    ratios
};

/// Largest argument for which the series is accurate with all its terms.
const MAX_SERIES: f64 = 4.0;
/// Largest argument for which the series is accurate with `SHORT_TERMS` terms.
const MAX_SHORT_SERIES: f64 = 0.1;
const SHORT_TERMS: usize = 5;

impl Stumpff {
    /// Evaluates all eight functions at `x ≥ 0` to machine precision.
    #[inline]
    pub fn new(x: f64) -> Self {
        if x >= MAX_SERIES {
            return Self::by_angle(x);
        }
        let mut one = [Self { x, c: [0.0; 8] }];
        Self::by_series(&mut one, [x]);
        one[0]
    }

    /// As [`Stumpff::new`], at up to [`LANES`] arguments, side by side.
    #[inline]
    pub fn fill(out: &mut [Self], x: [f64; LANES]) {
        if x.iter().all(|x| *x < MAX_SERIES) {
            Self::by_series(out, x);
        } else {
            out.iter_mut().zip(x).for_each(|(out, x)| *out = Self::new(x));
        }
    }

    /// Series for the two highest, then c_k = 1/k! − x c_{k+2}, which is accurate for small x.
    #[inline(always)]
    fn by_series<const N: usize>(out: &mut [Self], x: [f64; N]) {
        let terms = if x.iter().all(|x| *x < MAX_SHORT_SERIES) { SHORT_TERMS } else { SERIES.len() };
        let [mut even, mut odd] = [[1.0; N]; 2];
        for [e, o] in SERIES[1..terms].iter().rev() {
            for i in 0..N {
                even[i] = fma(-x[i] * e, even[i], 1.0);
                odd[i] = fma(-x[i] * o, odd[i], 1.0);
            }
        }
        let mut c = [[0.0; N]; 8];
        c[6] = even.map(|s| s * INVERSE_FACTORIAL[6]);
        c[7] = odd.map(|s| s * INVERSE_FACTORIAL[7]);
        for k in (0..6).rev() {
            for i in 0..N {
                c[k][i] = fma(-x[i], c[k + 2][i], INVERSE_FACTORIAL[k]);
            }
        }
        for (i, out) in out.iter_mut().enumerate() {
            *out = Self { x: x[i], c: std::array::from_fn(|k| c[k][i]) };
        }
    }

    fn by_angle(x: f64) -> Self {
        let theta = x.sqrt();
        let (sin, cos) = theta.sin_cos();
        let mut c = [0.0; 8];
        c[0] = cos;
        c[1] = sin / theta;
        for k in 0..6 {
            c[k + 2] = (INVERSE_FACTORIAL[k] - c[k]) / x;
        }
        Self { x, c }
    }

    /// `dc_k/dx`, for `k ≤ 5`.
    #[inline]
    pub fn first(&self, k: usize) -> f64 {
        0.5 * (k as f64 * self.c[k + 2] - self.c[k + 1])
    }

    /// `d²c_k/dx²`, for `k ≤ 3`.
    #[inline]
    pub fn second(&self, k: usize) -> f64 {
        0.5 * (k as f64 * self.first(k + 2) - self.first(k + 1))
    }
}
