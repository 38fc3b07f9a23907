//! Logarithm and exponential without branches, so that loops over fibres are vectorised.

use crate::linalg::fma;

/// Coefficients of (atanh s − s)/s³ in s² for |s| ≤ (√2 − 1)/(√2 + 1), and of (eʳ − 1 − r)/r² for
/// |r| ≤ ln 2 / 2: Chebyshev interpolation, with errors below 1e-19.
const ATANH: [f64; 8] = [
    0.3333333333333333,
    0.2000000000000044,
    0.14285714285401807,
    0.1111111119585696,
    0.0909089782006641,
    0.07693119851409672,
    0.06634386569265721,
    0.06543313074575988,
];
const EXP: [f64; 11] = [
    0.5,
    0.1666666666666667,
    0.04166666666666667,
    0.008333333333326141,
    0.0013888888888883752,
    0.00019841269874800493,
    2.4801587325533363e-05,
    2.7557255425746435e-06,
    2.7557273661348637e-07,
    2.5105206373957107e-08,
    2.0914679376584005e-09,
];
/// ln 2 in two parts, of which multiples by integers up to 2¹⁰ of the first are exact.
const LN_2: [f64; 2] = [0.6931471804855391, 7.440617110012397e-11];
/// Its sum with a small number has the nearest integer in its last bits.
const ROUND: f64 = 6755399441055744.0; // 1.5 · 2⁵²
const TWO_52: f64 = 4503599627370496.0;
const EXPONENT_BITS: u32 = 52;
const BIAS: u64 = 1023 << EXPONENT_BITS;

/// The natural logarithm of a positive normal number, to two units in the last place.
#[inline(always)]
pub(super) fn ln(x: f64) -> f64 {
    // x = 2ᵏ m with √½ < m < √2.
    let least = f64::to_bits(std::f64::consts::FRAC_1_SQRT_2);
    let biased = x.to_bits().wrapping_sub(least).wrapping_add(BIAS) >> EXPONENT_BITS;
    // The integer as a number: conversions of 64 bits are not vectorised.
    let k = f64::from_bits(biased | f64::to_bits(TWO_52)) - (TWO_52 + 1023.0);
    let m = f64::from_bits(x.to_bits().wrapping_sub(biased << EXPONENT_BITS).wrapping_add(BIAS));
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    fma(k, LN_2[0], fma(k, LN_2[1], 2.0 * fma(s * square, polynomial(&ATANH, square), s)))
}

/// eˣ, to two units in the last place; |x| beyond 700 counts as 700.
#[inline(always)]
pub(super) fn exp(x: f64) -> f64 {
    let x = x.clamp(-700.0, 700.0);
    let rounded = fma(x, std::f64::consts::LOG2_E, ROUND);
    let k = rounded - ROUND;
    let r = fma(-k, LN_2[1], fma(-k, LN_2[0], x));
    let scale = f64::from_bits((rounded.to_bits() << EXPONENT_BITS).wrapping_add(BIAS));
    scale * (1.0 + fma(r * r, polynomial(&EXP, r), r))
}

/// Σ cᵢ xⁱ.
#[inline(always)]
fn polynomial<const N: usize>(c: &[f64; N], x: f64) -> f64 {
    c[..N - 1].iter().rev().fold(c[N - 1], |sum, c| fma(sum, x, *c))
}

#[cfg(test)]
mod tests {
    #[test]
    fn logarithm_and_exponential_are_those_of_the_library() {
        assert_eq!(super::ln(1.0), 0.0);
        assert_eq!(super::exp(0.0), 1.0);
        for k in -4000..4000 {
            let x = 0.173 * f64::from(k);
            let (exp, expected) = (super::exp(x), x.exp());
            assert!((exp - expected).abs() <= 5e-16 * expected, "exp {x}: {exp} {expected}");
            for y in [expected, 1.0 + 2e-4 * x.abs(), 1.0 / (1.0 + 1e-3 * x.abs())] {
                let (ln, expected) = (super::ln(y), y.ln());
                assert!((ln - expected).abs() <= 5e-16 * expected.abs(), "ln {y}: {ln} {expected}");
            }
        }
    }
}
