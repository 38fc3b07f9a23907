//! Material laws: energy per volume of an incompressible material in a fibre stretched by λ.
//!
//! A fibre that is free contracts sideways alike; one that is wound has the hoop stretch h that the
//! winding imposes (see `wall.rs`; one in a flat wall), and the third stretch is 1/(λh).

use super::arcs::ArcEnergies;
use super::evaluation::Energies;
use super::jet::{Constant, Jet, Number};
use super::stretches::{Free, Kept, Logarithmic, Stretches};
use serde::Deserialize;
use std::ops::{Add, Mul};

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

    /// w of fibres that are not linear, given their stretches in `out` and those in the reference state.
    pub(super) fn evaluate(self, c: &[f64], stretch: &[f64], wound: bool, out: &mut Energies) {
        // Each law and number of constants has loops of its own, which can be vectorised.
        match (self, c.len()) {
            (Law::Linear, _) => each(Law::Linear, c, stretch, wound, out),
            (Law::NeoHookean, _) => each(Law::NeoHookean, c, stretch, wound, out),
            (Law::Yeoh, _) => each(Law::Yeoh, c, stretch, wound, out),
            (Law::MooneyRivlin, _) => each(Law::MooneyRivlin, c, stretch, wound, out),
            (Law::Ogden, 2) => each(Law::Ogden, &[c[0], c[1]], stretch, wound, out),
            (Law::Ogden, 4) => each(Law::Ogden, &[c[0], c[1], c[2], c[3]], stretch, wound, out),
            (Law::Ogden, _) => each(Law::Ogden, c, stretch, wound, out),
        }
    }

    /// w of fibres in curved walls, given their stretches in `out`.
    pub(super) fn evaluate_arcs(self, c: &[f64], out: &mut ArcEnergies) {
        match (self, c.len()) {
            (Law::Linear, _) => each_arc(Law::Linear, c, out),
            (Law::NeoHookean, _) => each_arc(Law::NeoHookean, c, out),
            (Law::Yeoh, _) => each_arc(Law::Yeoh, c, out),
            (Law::MooneyRivlin, _) => each_arc(Law::MooneyRivlin, c, out),
            (Law::Ogden, 2) => each_arc(Law::Ogden, &[c[0], c[1]], out),
            (Law::Ogden, 4) => each_arc(Law::Ogden, &[c[0], c[1], c[2], c[3]], out),
            (Law::Ogden, _) => each_arc(Law::Ogden, c, out),
        }
    }

    /// w of a fibre. Constants of a linear one are its modulus.
    #[inline(always)]
    pub(super) fn energy<C: LawConstant, N: Number<C>>(self, c: &[C], of: impl Stretches<C, N>) -> N {
        match self {
            // Linear fibres are summed up once for a design.
            Law::Linear => of.strain() * of.strain() * (c[0] * 0.5),
            Law::NeoHookean => of.squares() * (c[0] * 0.5),
            Law::Yeoh => {
                let i = of.squares();
                let square = i * i;
                i * c[0] + square * c[1] + square * i * c[2]
            }
            Law::MooneyRivlin => of.squares() * c[0] + of.inverse_squares() * c[1],
            Law::Ogden => {
                let mut sum = of.strain() * C::from(0.0);
                for pair in c.chunks_exact(2) {
                    sum = sum + of.powers(pair[1]) * C::ogden_factor(pair[0], pair[1]);
                }
                sum
            }
        }
    }
}

/// Evaluates w of each fibre.
#[inline(always)]
fn each(law: Law, c: &[f64], rate: &[f64], wound: bool, out: &mut Energies) {
    // Each has a loop of its own.
    if wound { each_with(law, c, rate, Kept, out) } else { each_with(law, c, rate, Free, out) }
}

#[inline(always)]
fn each_with<S: Stretches<f64, Jet>>(
    law: Law,
    c: &[f64],
    rate: &[f64],
    of: impl Fn(Jet) -> S,
    out: &mut Energies,
) {
    let n = rate.len();
    let x = &out.stretch[..n];
    let (value, first, second) = (&mut out.value[..n], &mut out.first[..n], &mut out.second[..n]);
    for i in 0..n {
        let w = law.energy(c, of(Jet { value: x[i], first: rate[i], second: 0.0 }));
        (value[i], first[i], second[i]) = (w.value, w.first, w.second);
    }
}

/// Evaluates w of each fibre of curved walls.
#[inline(always)]
fn each_arc(law: Law, c: &[f64], out: &mut ArcEnergies) {
    let n = out.along.len();
    let (along, hoop) = (&out.along[..n], &out.hoop[..n]);
    let (value, [u, v]) = (&mut out.value[..n], out.first.each_mut().map(|d| &mut d[..n]));
    let [uu, uv, vv] = out.second.each_mut().map(|d| &mut d[..n]);
    for i in 0..n {
        let w = law.energy(c, Logarithmic { along: along[i], hoop: hoop[i] });
        (value[i], u[i], v[i]) = (w.value, w.first[0], w.first[1]);
        [uu[i], uv[i], vv[i]] = w.second;
    }
}

/// Arithmetic of a law's constants.
pub(super) trait LawConstant: Copy + From<f64> + Add<Output = Self> + Mul<f64, Output = Self> {
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
