//! Areas or masses per length of a section, with their first moments, as polynomials of S.

/// Coefficients of a section: 1, S, S² of the area, then 1, S, S², S³ of ∫ y dA and of ∫ z dA.
pub(crate) const MOMENTS: usize = 11;

/// Area, ∫ y dA and ∫ z dA, with their derivatives with respect to S.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments {
    pub value: [f64; 3],
    pub by_radius: [f64; 3],
}

impl Moments {
    /// The moments from their coefficients.
    pub fn new(c: &[f64], s: f64) -> Self {
        let cubic = |c: &[f64]| {
            let value = c.iter().rev().fold(0.0, |sum, c| sum * s + c);
            let slope = c.iter().enumerate().skip(1).rev().fold(0.0, |sum, (k, c)| sum * s + k as f64 * c);
            [value, slope]
        };
        let all = [cubic(&c[..3]), cubic(&c[3..7]), cubic(&c[7..MOMENTS])];
        Self { value: all.map(|[value, _]| value), by_radius: all.map(|[_, slope]| slope) }
    }
}
