//! A single fibre of a material, for stress–stretch curves and fits.

use super::evaluation::Energies;
use super::jet::{Constant, Jet, MixedJet};
use super::law::Law;
use super::stretches::{Free, Kept};

impl Law {
    /// Derivatives of the nominal stress w′ of such a fibre with respect to each constant, row by row of the
    /// stretches; `None` likewise.
    pub fn stress_slopes(self, constants: &[f64], wound: bool, stretch: &[f64]) -> Option<Vec<f64>> {
        if !self.accepts(constants.len()) {
            return None;
        }
        let slope = |k: usize, stretch: f64| {
            if self == Law::Linear {
                return Self::modulus(constants, wound)[k + 1] * (stretch - 1.0);
            }
            let seeded: Vec<Constant> = Constant::seeded(constants, k).collect();
            let stretch = MixedJet::from(Jet { value: stretch, first: 1.0, second: 0.0 });
            let w =
                if wound { self.energy(&seeded, Kept(stretch)) } else { self.energy(&seeded, Free(stretch)) };
            w.by_parameter.first
        };
        Some(
            stretch
                .iter()
                .flat_map(|x| (0..constants.len()).map(|k| slope(k, *x)).collect::<Vec<_>>())
                .collect(),
        )
    }

    /// Energy per volume [J/m³] and its first and second derivative with respect to the stretch [Pa], of a
    /// fibre that contracts freely or, if `wound`, keeps its hoop stretch at one.
    ///
    /// NaN where a law other than the linear one is given a stretch that is not positive. `None` if the law
    /// has another number of constants.
    pub fn fibre_energy(self, constants: &[f64], wound: bool, stretch: &[f64]) -> Option<[Vec<f64>; 3]> {
        if !self.accepts(constants.len()) {
            return None;
        }
        let n = stretch.len();
        let modulus = (self == Law::Linear).then(|| [Self::modulus(constants, wound)[0]]);
        let constants = modulus.as_ref().map_or(constants, |modulus| &modulus[..]);
        let mut out = Energies { stretch: stretch.to_vec(), ..Energies::default() };
        for values in [&mut out.value, &mut out.first, &mut out.second] {
            values.resize(n, 0.0);
        }
        self.evaluate(constants, &vec![1.0; n], wound, &mut out);
        for i in (0..n).filter(|i| self != Law::Linear && !(stretch[*i] > 0.0)) {
            (out.value[i], out.first[i], out.second[i]) = (f64::NAN, f64::NAN, f64::NAN);
        }
        Some([out.value, out.first, out.second])
    }
}
