//! Material laws: energy per volume of an incompressible material in a fibre stretched by λ.
//!
//! A fibre that is free contracts sideways alike; one that is wound has the hoop stretch h that the
//! winding imposes, and the third stretch is 1/(λh). With the section that a winding of radius R keeps
//! and the incompressible wall inside it, h² = ϱ − (ϱ − 1)/λ at the radius r, ϱ = (R/r)².

use super::jet::{Constant, Jet, Lanes, MixedJet, Number};
use serde::Deserialize;
use std::ops::Mul;

/// The strain energy functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// E/2 (λ − 1)²; constants E, ν. Wound: E/(1 − ν²) in place of E.
    Linear,
    /// μ/2 (I₁ − 3); constant μ.
    NeoHookean,
    /// Σ cᵢ (I₁ − 3)ⁱ; constants c₁, c₂, c₃.
    Yeoh,
    /// c₁₀ (I₁ − 3) + c₀₁ (I₂ − 3); constants c₁₀, c₀₁.
    MooneyRivlin,
    /// Σ μᵢ/αᵢ (λ₁^αᵢ + λ₂^αᵢ + λ₃^αᵢ − 3); constants μ₁, α₁, μ₂, α₂, …
    Ogden,
}

/// Squares of the hoop stretch and of the stretch through the thickness.
struct Sides<N> {
    hoop: N,
    thickness: N,
}

impl Law {
    /// Whether these are as many constants as it has.
    pub(super) fn accepts(self, count: usize) -> bool {
        match self {
            Law::NeoHookean => count == 1,
            Law::Linear | Law::MooneyRivlin => count == 2,
            Law::Yeoh => count == 3,
            Law::Ogden => count > 0 && count % 2 == 0,
        }
    }

    /// Whether a fibre resists small stretches.
    pub(super) fn is_admissible(self, constants: &[f64]) -> bool {
        let sound = match self {
            Law::Linear => constants[1] > -1.0 && constants[1] <= 0.5,
            Law::Ogden => constants.iter().skip(1).step_by(2).all(|exponent| *exponent != 0.0),
            _ => true,
        };
        sound && self.shear_modulus(constants) > 0.0
    }

    /// Shear modulus of small strains [Pa].
    pub(super) fn shear_modulus(self, c: &[f64]) -> f64 {
        match self {
            Law::Linear => 0.5 * c[0] / (1.0 + c[1]),
            Law::NeoHookean => c[0],
            Law::Yeoh => 2.0 * c[0],
            Law::MooneyRivlin => 2.0 * (c[0] + c[1]),
            Law::Ogden => c.chunks_exact(2).map(|pair| 0.5 * pair[0] * pair[1]).sum(),
        }
    }

    /// Its derivative with respect to a constant.
    pub(super) fn shear_modulus_by(self, c: &[f64], k: usize) -> f64 {
        match (self, k) {
            (Law::Linear, 0) => 0.5 / (1.0 + c[1]),
            (Law::Linear, _) => -0.5 * c[0] / (1.0 + c[1]).powi(2),
            (Law::NeoHookean, _) => 1.0,
            (Law::Yeoh, 0) | (Law::MooneyRivlin, _) => 2.0,
            (Law::Yeoh, _) => 0.0,
            (Law::Ogden, k) => 0.5 * if k % 2 == 0 { c[k + 1] } else { c[k - 1] },
        }
    }

    /// The modulus of a linear fibre and its derivatives with respect to E and ν.
    pub(super) fn modulus(c: &[f64], wound: bool) -> [f64; 3] {
        if !wound {
            return [c[0], 1.0, 0.0];
        }
        let held = 1.0 - c[1] * c[1];
        [c[0] / held, 1.0 / held, 2.0 * c[0] * c[1] / (held * held)]
    }

    /// w of some fibres that are not linear, and the smallest number that has to be positive for them to
    /// exist.
    #[inline]
    pub(super) fn fibres(self, constants: &[f64], stretch: Jet, ratio: Option<Lanes>) -> (Jet, Lanes) {
        match ratio {
            None => (self.energy(constants, stretch, None), stretch.value),
            Some(ratio) => {
                let hoop = stretch.recip() * ratio.map(|r| 1.0 - r) + ratio;
                let sides = Sides { hoop, thickness: (stretch * stretch * hoop).recip() };
                (self.energy(constants, stretch, Some(sides)), stretch.value.min(hoop.value))
            }
        }
    }

    /// w of one fibre with its derivatives with respect to the stretch and a parameter, which the
    /// constants, the stretch and ϱ may depend on. Constants of a linear fibre are its modulus.
    pub(super) fn fibre(
        self,
        constants: &[Constant],
        stretch: MixedJet,
        ratio: Option<MixedJet>,
    ) -> MixedJet {
        if self == Law::Linear {
            let strain = stretch + -1.0;
            return strain * strain * (constants[0] * 0.5);
        }
        let sides = ratio.map(|ratio| {
            let hoop = ratio - (ratio + -1.0) * stretch.recip();
            Sides { hoop, thickness: (stretch * stretch * hoop).recip() }
        });
        self.energy(constants, stretch, sides)
    }

    #[inline(always)]
    fn energy<C: LawConstant, N: Number<C>>(self, c: &[C], stretch: N, sides: Option<Sides<N>>) -> N {
        let axial = stretch * stretch;
        let first = |sides: &Option<Sides<N>>| match sides {
            None => axial + stretch.recip() + stretch.recip() + -3.0,
            Some(Sides { hoop, thickness }) => axial + *hoop + *thickness + -3.0,
        };
        match self {
            // Linear fibres are summed up once for a design.
            Law::Linear => (stretch + -1.0) * (stretch + -1.0) * (c[0] * 0.5),
            Law::NeoHookean => first(&sides) * (c[0] * 0.5),
            Law::Yeoh => {
                let i = first(&sides);
                let square = i * i;
                i * c[0] + square * c[1] + square * i * c[2]
            }
            Law::MooneyRivlin => {
                let second = match &sides {
                    None => stretch + stretch + axial.recip() + -3.0,
                    Some(Sides { hoop, thickness }) => {
                        axial.recip() + hoop.recip() + thickness.recip() + -3.0
                    }
                };
                first(&sides) * c[0] + second * c[1]
            }
            Law::Ogden => {
                let term = |pair: &[C]| {
                    let half = pair[1] * 0.5;
                    let powers = match &sides {
                        None => {
                            let side = stretch.recip().power(half);
                            stretch.power(pair[1]) + side + side + -3.0
                        }
                        Some(Sides { hoop, thickness }) => {
                            stretch.power(pair[1]) + hoop.power(half) + thickness.power(half) + -3.0
                        }
                    };
                    powers * C::ogden_factor(pair[0], pair[1])
                };
                let mut pairs = c.chunks_exact(2);
                let sum = pairs.next().map(term);
                pairs.fold(sum.unwrap_or(stretch * (c[0] * 0.0)), |sum, pair| sum + term(pair))
            }
        }
    }
}

/// Arithmetic of a law's constants.
pub(super) trait LawConstant: Copy + Mul<f64, Output = Self> {
    /// μ/α.
    fn ogden_factor(modulus: Self, exponent: Self) -> Self;
}

impl LawConstant for f64 {
    fn ogden_factor(modulus: f64, exponent: f64) -> f64 {
        modulus / exponent
    }
}

impl LawConstant for Constant {
    fn ogden_factor(m: Constant, a: Constant) -> Constant {
        let value = f64::ogden_factor(m.value, a.value);
        let by_parameter = (m.by_parameter - value * a.by_parameter) / a.value;
        Constant { value, by_parameter }
    }
}
