//! Derivatives of the fibres' virtual work: λᵀ∂g/∂p = Σ w A w′(λ) b·ê, with b = (L, z, −y) and ê the
//! virtual ε, θ_y and θ_z.

use super::description::{Fibre, symmetric};
use super::jet::{Constant, MixedJet};
use super::{FibreSections, Law, NUMBERS, length_power, numbers, strains};
use crate::forces::state::State;
use crate::lie::LieGroup;

/// A fibre in the current state.
#[derive(Clone, Copy, Debug)]
struct FibreForce {
    fibre: Fibre,
    /// 1 + ε + κ_y z − κ_z y.
    stretch: f64,
    /// w′ and its derivatives with respect to that, to the stretch in the reference state and to ϱ.
    force: f64,
    slope: f64,
    by_stretch: f64,
    by_ratio: f64,
}

/// All fibres, Gauss point after Gauss point, and the derivatives of w′ with respect to the constants of
/// their materials.
#[derive(Clone, Debug, Default)]
pub(crate) struct FibreSensitivity {
    fibres: Vec<FibreForce>,
    by_constant: Vec<f64>,
    /// Constants of one fibre, with derivatives.
    seeded: Vec<Constant>,
}

impl FibreSections {
    pub(super) fn update<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        out: &mut FibreSensitivity,
    ) {
        let p = at.parameters();
        out.fibres.clear();
        out.by_constant.clear();
        for fibre_rod in &self.rods {
            let rod = &at.tree.rods[fibre_rod.rod];
            let length = p[rod.length];
            for (gauss, section) in rod.gauss.iter().zip(&fibre_rod.of_gauss) {
                let strain = strains(&gauss.columns, at.q);
                let s = p[rod.radius.start + gauss.point];
                for (m, n) in numbers(&fibre_rod.sections[*section], p) {
                    let fibre = Fibre::new(n, s);
                    let bent = (strain[1] * fibre.z - strain[2] * fibre.y) / length;
                    self.push(m, p, fibre, 1.0 + strain[3] + bent, out);
                }
            }
        }
    }

    fn push(&self, material: usize, p: &[f64], fibre: Fibre, stretch: f64, out: &mut FibreSensitivity) {
        let material = &self.materials[material];
        let constants = &p[material.constants.clone()];
        let linear = material.law == Law::Linear;
        let modulus = if linear { Law::modulus(constants, material.wound) } else { [0.0; 3] };
        let FibreSensitivity { fibres, by_constant, seeded } = out;
        let mut evaluate = |seed: Seed| {
            let is = |other: Seed| if seed == other { 1.0 } else { 0.0 };
            let constant = |k: usize, value: f64| Constant { value, by_parameter: is(Seed::Constant(k)) };
            seeded.clear();
            if linear {
                let slope = if let Seed::Constant(k) = seed { modulus[k + 1] } else { 0.0 };
                seeded.push(Constant { value: modulus[0], by_parameter: slope });
            } else {
                seeded.extend(constants.iter().enumerate().map(|(k, c)| constant(k, *c)));
            }
            let by_stretch = is(Seed::Stretch);
            let total = MixedJet {
                value: fibre.stretch * stretch,
                first: fibre.stretch,
                second: 0.0,
                by_parameter: by_stretch * stretch,
                mixed: by_stretch,
            };
            let ratio = MixedJet {
                value: fibre.ratio,
                first: 0.0,
                second: 0.0,
                by_parameter: is(Seed::Ratio),
                mixed: 0.0,
            };
            material.law.fibre(seeded, total, (material.wound && !linear).then_some(ratio))
        };
        let by_stretch = evaluate(Seed::Stretch);
        let by_ratio = if material.wound && !linear { evaluate(Seed::Ratio).mixed } else { 0.0 };
        fibres.push(FibreForce {
            fibre,
            stretch,
            force: by_stretch.first,
            slope: by_stretch.second,
            by_stretch: by_stretch.mixed,
            by_ratio,
        });
        by_constant.extend((0..constants.len()).map(|k| evaluate(Seed::Constant(k)).mixed));
    }

    pub(super) fn add_work<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        sensitivity: &FibreSensitivity,
        lambda: &[f64],
        gradient: &mut [f64],
    ) {
        let p = at.parameters();
        let (mut fibres, mut by_constant) = (sensitivity.fibres.iter(), sensitivity.by_constant.iter());
        for fibre_rod in &self.rods {
            let rod = &at.tree.rods[fibre_rod.rod];
            let length = p[rod.length];
            for (gauss, section) in rod.gauss.iter().zip(&fibre_rod.of_gauss) {
                let section = &fibre_rod.sections[*section];
                let radius = rod.radius.start + gauss.point;
                let w = gauss.weight;
                let real = strains(&gauss.columns, at.q);
                let virtual_ = strains(&gauss.columns, lambda);
                let pair = |i: usize, j: usize| {
                    let power = 1 + length_power(i) + length_power(j);
                    (w * real[i] * virtual_[j] * length.powi(power), f64::from(power) / length)
                };
                // The stiffness that is given.
                let rigidity = symmetric(&p[section.rigidity..section.rigidity + 21]).0;
                let mut k = section.rigidity;
                for i in 0..6 {
                    for j in i..6 {
                        let ((one, by_length), (other, _)) = (pair(i, j), pair(j, i));
                        let work = if i == j { one } else { one + other };
                        gradient[k] += work;
                        gradient[rod.length] += rigidity[i][j] * work * by_length;
                        k += 1;
                    }
                }
                // Torsion and shear of the fibres.
                let ((twist, twist_by_length), torsion) = (pair(0, 0), p[section.torsion]);
                let shear = pair(4, 4).0 + pair(5, 5).0;
                let shear_by_length = pair(4, 4).1;
                let ([axial, bend_y, bend_z], [cy, cz]) =
                    ([virtual_[3], virtual_[1], virtual_[2]], [real[1] / length, real[2] / length]);
                for (index, (m, n)) in numbers(section, p).enumerate() {
                    let Some(force) = fibres.next() else { return };
                    let FibreForce { fibre, stretch, force, slope, by_stretch, by_ratio } = *force;
                    let Fibre { y, z, area, .. } = fibre;
                    let material = &self.materials[m];
                    let constants = &p[material.constants.clone()];
                    let g = material.law.shear_modulus(constants);
                    let polar = y * y + z * z;
                    let arm = length * axial + z * bend_y - y * bend_z;
                    let lever = w * area * arm;
                    gradient[section.torsion] += twist * g * area * polar;
                    let bent = stretch - 1.0 - real[3];
                    gradient[rod.length] += w * area * force * axial - lever * slope * bent / length
                        + g * area * (torsion * twist * polar * twist_by_length + shear * shear_by_length);
                    let sideways = [
                        -lever * slope * cz - w * area * force * bend_z
                            + torsion * twist * g * area * 2.0 * y,
                        lever * slope * cy + w * area * force * bend_y + torsion * twist * g * area * 2.0 * z,
                    ];
                    let derivatives = [
                        sideways[0],
                        sideways[1],
                        w * force * arm + g * (torsion * twist * polar + shear),
                        lever * by_stretch,
                        lever * by_ratio,
                    ];
                    let first = section.fibres + NUMBERS * index;
                    let out = &mut gradient[first..first + NUMBERS];
                    let by_radius = Fibre::add_derivatives(n, p[radius], derivatives, out);
                    gradient[radius] += by_radius;
                    let by_shear = area * (torsion * twist * polar + shear);
                    for (k, by_constant) in material.constants.clone().zip(by_constant.by_ref()) {
                        let of_shear = material.law.shear_modulus_by(constants, k - material.constants.start);
                        gradient[k] += lever * by_constant + by_shear * of_shear;
                    }
                }
            }
        }
    }
}

/// The parameter that a derivative is with respect to.
#[derive(Clone, Copy, PartialEq)]
enum Seed {
    Stretch,
    Ratio,
    Constant(usize),
}
