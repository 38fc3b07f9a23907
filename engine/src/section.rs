//! Section stiffness: each of GJ, EI_y, EI_z, EA, GA, GA is `modulus · factor · S^power`.

use crate::strain::Mode;
use crate::tree::description::Section;
use std::f64::consts::PI;

/// The factors of S⁴ in torsion and in bending about y and z, and that of S² of the area; none of fibres.
pub(crate) fn factors(section: Section) -> Option<[f64; 4]> {
    Some(match section {
        Section::Circular => [PI / 2.0, PI / 4.0, PI / 4.0, PI],
        Section::Elliptic { ratio: r } => {
            [PI * r.powi(3) / (r * r + 1.0), PI / 4.0 * r, PI / 4.0 * r.powi(3), PI * r]
        }
        Section::Rectangular { ratio: r } => {
            [rectangle_torsion(r), 4.0 / 3.0 * r, 4.0 / 3.0 * r.powi(3), 4.0 * r]
        }
        Section::Fibres => return None,
    })
}

/// Which factor is that of the area.
pub(crate) const AREA: usize = 3;

/// Which factor a mode has: linear ones that of the area.
pub(crate) fn factor_of(mode: Mode) -> usize {
    mode.index().min(AREA)
}

/// Saint-Venant torsion constant of a rectangle with half-sides 1 and `r`, by its series.
fn rectangle_torsion(r: f64) -> f64 {
    let (long, short) = (2.0 * r.max(1.0), 2.0 * r.min(1.0));
    let series: f64 = (0..200)
        .map(|n| 2.0 * f64::from(n) + 1.0)
        .map(|m| (m * PI * long / (2.0 * short)).tanh() / m.powi(5))
        .sum();
    long * short.powi(3) / 3.0 * (1.0 - 192.0 * short / (PI.powi(5) * long) * series)
}

/// The power of S.
pub(crate) fn power(mode: Mode) -> i32 {
    if mode.is_angular() { 4 } else { 2 }
}

/// Young's modulus for bending and extension, the shear modulus for torsion and shear.
pub(crate) fn modulus(mode: Mode, young: f64, shear: f64) -> f64 {
    match mode {
        Mode::BendY | Mode::BendZ | Mode::ExtendX => young,
        Mode::TwistX | Mode::ShearY | Mode::ShearZ => shear,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ellipse_of_ratio_one_is_a_circle() {
        let circle = factors(Section::Circular).unwrap();
        for (a, b) in factors(Section::Elliptic { ratio: 1.0 }).unwrap().iter().zip(circle) {
            assert!((a - b).abs() < 1e-14);
        }
    }

    #[test]
    fn torsion_of_a_square_and_of_a_strip() {
        // Timoshenko & Goodier: J = 0.1406 a⁴ for a square of side a, → a b³/3 for a thin strip.
        assert!((rectangle_torsion(1.0) / 16.0 - 0.140_577).abs() < 1e-6);
        let strip = rectangle_torsion(1000.0) / (2000.0 * 8.0 / 3.0);
        assert!((strip - 1.0).abs() < 1e-3);
    }
}
