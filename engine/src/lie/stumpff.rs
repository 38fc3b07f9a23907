//! Stumpff functions, the scalar coefficients of every closed form on SE(2) and SE(3).

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
const SERIES: [[f64; 2]; 12] = {
    let mut ratios = [[0.0; 2]; 12];
    let mut j = 1;
    while j < 12 {
        let m = 2.0 * j as f64;
        ratios[j] = [1.0 / ((m + 5.0) * (m + 6.0)), 1.0 / ((m + 6.0) * (m + 7.0))];
        j += 1;
    }
    ratios
};

impl Stumpff {
    /// Evaluates all eight functions at `x ≥ 0` to machine precision.
    #[inline]
    pub fn new(x: f64) -> Self {
        let mut c = [0.0; 8];
        if x < 4.0 {
            // Series for the two highest, then c_k = 1/k! − x c_{k+2}, which loses nothing here.
            let terms = if x < 0.1 { 5 } else { 12 };
            let (mut even, mut odd) = (1.0, 1.0);
            for [e, o] in SERIES[1..terms].iter().rev() {
                even = 1.0 - x * even * e;
                odd = 1.0 - x * odd * o;
            }
            c[6] = even * INVERSE_FACTORIAL[6];
            c[7] = odd * INVERSE_FACTORIAL[7];
            for k in (0..6).rev() {
                c[k] = INVERSE_FACTORIAL[k] - x * c[k + 2];
            }
        } else {
            let theta = x.sqrt();
            let (sin, cos) = theta.sin_cos();
            c[0] = cos;
            c[1] = sin / theta;
            for k in 0..6 {
                c[k + 2] = (INVERSE_FACTORIAL[k] - c[k]) / x;
            }
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
