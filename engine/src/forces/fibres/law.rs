//! Material laws: energy per volume of an incompressible material in a fibre stretched by λ.
//!
//! A fibre that is free contracts sideways alike; one that is wound has the hoop stretch h that the
//! winding imposes, and the third stretch is 1/(λh). With the section that a winding of radius R keeps
//! and the incompressible wall inside it, h² = ϱ − (ϱ − 1)/λ at the radius r, ϱ = (R/r)².

use super::evaluation::Energies;
use super::jet::{Constant, Jet, MixedJet, Number};
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

    /// w of fibres that are not linear, given their stretches in `out`, those in the reference state and,
    /// if they are wound, ϱ.
    pub(super) fn evaluate(self, c: &[f64], stretch: &[f64], ratio: Option<&Vec<f64>>, out: &mut Energies) {
        // Each law and number of constants has loops of its own, which can be vectorised.
        match (self, c.len()) {
            (Law::Linear, _) => each(Law::Linear, c, stretch, ratio, out),
            (Law::NeoHookean, _) => each(Law::NeoHookean, c, stretch, ratio, out),
            (Law::Yeoh, _) => each(Law::Yeoh, c, stretch, ratio, out),
            (Law::MooneyRivlin, _) => each(Law::MooneyRivlin, c, stretch, ratio, out),
            (Law::Ogden, 2) => each(Law::Ogden, &[c[0], c[1]], stretch, ratio, out),
            (Law::Ogden, 4) => each(Law::Ogden, &[c[0], c[1], c[2], c[3]], stretch, ratio, out),
            (Law::Ogden, _) => each(Law::Ogden, c, stretch, ratio, out),
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
        self.energy(constants, stretch, ratio.map(|ratio| ratio - (ratio + -1.0) * stretch.recip()))
    }

    /// w, given the square of the hoop stretch of a wound fibre.
    #[inline(always)]
    fn energy<C: LawConstant, N: Number<C>>(self, c: &[C], stretch: N, hoop: Option<N>) -> N {
        let axial = stretch * stretch;
        let first = || match hoop {
            None => axial + stretch.recip() + stretch.recip() + -3.0,
            Some(hoop) => axial + hoop + (axial * hoop).recip() + -3.0,
        };
        match self {
            // Linear fibres are summed up once for a design.
            Law::Linear => (stretch + -1.0) * (stretch + -1.0) * (c[0] * 0.5),
            Law::NeoHookean => first() * (c[0] * 0.5),
            Law::Yeoh => {
                let i = first();
                let square = i * i;
                i * c[0] + square * c[1] + square * i * c[2]
            }
            Law::MooneyRivlin => {
                let second = match hoop {
                    None => stretch + stretch + axial.recip() + -3.0,
                    Some(hoop) => axial.recip() + hoop.recip() + axial * hoop + -3.0,
                };
                first() * c[0] + second * c[1]
            }
            Law::Ogden => {
                let along = stretch.ln();
                let across = match hoop {
                    None => along * C::from(-0.5),
                    Some(hoop) => hoop.ln() * C::from(0.5),
                };
                let mut sum = stretch * C::from(0.0);
                for pair in c.chunks_exact(2) {
                    let powers = N::powers(along, across, pair[1]);
                    sum = sum + (powers + -3.0) * C::ogden_factor(pair[0], pair[1]);
                }
                sum
            }
        }
    }
}

/// Evaluates w of each fibre.
#[inline(always)]
fn each(law: Law, c: &[f64], rate: &[f64], ratio: Option<&Vec<f64>>, out: &mut Energies) {
    let n = rate.len();
    let x = &out.stretch[..n];
    let (value, first, second) = (&mut out.value[..n], &mut out.first[..n], &mut out.second[..n]);
    match ratio.map(|ratio| &ratio[..n]) {
        None => {
            for i in 0..n {
                let stretch = Jet { value: x[i], first: rate[i], second: 0.0 };
                let w = law.energy(c, stretch, None);
                (value[i], first[i], second[i]) = (w.value, w.first, w.second);
            }
        }
        Some(ratio) => {
            for i in 0..n {
                let stretch = Jet { value: x[i], first: rate[i], second: 0.0 };
                let hoop = stretch.recip() * (1.0 - ratio[i]) + ratio[i];
                let w = law.energy(c, stretch, Some(hoop));
                (value[i], first[i], second[i]) = (w.value, w.first, w.second);
            }
        }
    }
}

/// Arithmetic of a law's constants.
pub(super) trait LawConstant: Copy + From<f64> + Mul<f64, Output = Self> {
    /// μ/α.
    fn ogden_factor(modulus: Self, exponent: Self) -> Self;
}

impl LawConstant for f64 {
    #[inline(always)]
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
