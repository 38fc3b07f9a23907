//! Derivatives of the fibres' virtual work: λᵀ∂g/∂p = Σ w L A (∂w/∂a â + ∂w/∂b b̂), with â and b̂ the changes
//! of a and b under the virtual ε, θ_y and θ_z.

use super::description::{Fibre, FibreDerivatives, symmetric};
use super::jet::{Constant, Jet, MixedJet};
use super::stretches::{Free, Hooped};
use super::wall::Wall;
use super::{FibreSections, Law, NUMBERS, length_power, numbers, strains};
use crate::forces::state::State;
use crate::lie::LieGroup;

/// A fibre in the current state. One that does not move with a wall (see `wall.rs`) is its own centre.
#[derive(Clone, Copy, Debug)]
struct FibreForce {
    fibre: Fibre,
    moves: bool,
    /// w by a and b.
    first: [f64; 2],
    /// By a twice, by both, by b twice.
    second: [f64; 3],
    /// `first` by P.
    by_ratio: [f64; 2],
}

/// All fibres, Gauss point after Gauss point, and the derivatives of their `first` with respect to the
/// constants of their materials, where these are wanted.
#[derive(Clone, Debug, Default)]
pub(crate) struct FibreSensitivity {
    fibres: Vec<FibreForce>,
    by_constant: Vec<[f64; 2]>,
    /// For each material, whether a constant is wanted.
    wanted: Vec<bool>,
    /// Constants of one fibre, with derivatives.
    seeded: Vec<Constant>,
}

impl FibreSections {
    pub(super) fn update<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        wanted: &[bool],
        out: &mut FibreSensitivity,
    ) {
        let p = at.parameters();
        out.wanted.clear();
        out.wanted
            .extend(self.materials.iter().map(|material| wanted[material.constants.clone()].contains(&true)));
        out.fibres.clear();
        out.by_constant.clear();
        for fibre_rod in &self.rods {
            let rod = &at.tree.rods[fibre_rod.rod];
            let length = p[rod.length];
            for (gauss, section) in rod.gauss.iter().zip(&fibre_rod.of_gauss) {
                let strain = strains(&gauss.columns, at.q);
                let s = p[rod.radius.start + gauss.point];
                for (m, n) in numbers(&fibre_rod.sections[*section], p) {
                    let fibre = self.materials[m].fibre(n, s);
                    let wall = fibre.wall([strain[3], strain[1], strain[2]], length);
                    self.push(m, p, fibre, wall, out);
                }
            }
        }
    }

    /// Appends a fibre.
    fn push(&self, material: usize, p: &[f64], fibre: Fibre, wall: Wall, out: &mut FibreSensitivity) {
        let by_constants = out.wanted[material];
        let material = &self.materials[material];
        let constants = &p[material.constants.clone()];
        let moves = material.moves();
        let linear = material.law == Law::Linear;
        let modulus = if linear { Law::modulus(constants, material.wound) } else { [0.0; 3] };
        let FibreSensitivity { fibres, by_constant, seeded, .. } = out;
        let mut evaluate = |seed: Seed| {
            seeded.clear();
            if linear {
                let by_parameter = if let Seed::Constant(k) = seed { modulus[k + 1] } else { 0.0 };
                seeded.push(Constant { value: modulus[0], by_parameter });
            } else {
                let by = |k: usize| f64::from(u8::from(seed == Seed::Constant(k)));
                let all = constants.iter().enumerate();
                seeded.extend(all.map(|(k, value)| Constant { value: *value, by_parameter: by(k) }));
            }
            if moves {
                let [stretch, hoop] = wall.mixed(seed == Seed::Ratio);
                return material.law.energy(seeded, Hooped::new(stretch, hoop));
            }
            let stretch = Jet { value: wall.stretch(), first: 1.0, second: 0.0 };
            let stretch = MixedJet { value: stretch, by_parameter: Jet::default() };
            let w = material.law.energy(seeded, Free(stretch));
            MixedJet { value: w.value.into(), by_parameter: w.by_parameter.into() }
        };
        let by_ratio = evaluate(Seed::Ratio);
        fibres.push(FibreForce {
            fibre,
            moves,
            first: by_ratio.value.first,
            second: by_ratio.value.second,
            by_ratio: by_ratio.by_parameter.first,
        });
        let count = if by_constants { constants.len() } else { 0 };
        by_constant.extend((0..count).map(|k| evaluate(Seed::Constant(k)).by_parameter.first));
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
                let (along_y, along_z) = (pair(4, 4).0, pair(5, 5).0);
                let shear = p[section.shear] * along_y + p[section.shear + 1] * along_z;
                let shear_by_length = pair(4, 4).1;
                let series = self.shear_in_series(section, p, p[radius]);
                let stiffness = series.stiffness();
                gradient[section.shear] += along_y * stiffness;
                gradient[section.shear + 1] += along_z * stiffness;
                gradient[rod.length] += stiffness * shear * shear_by_length;
                let [axial, bend_y, bend_z] = [virtual_[3], virtual_[1], virtual_[2]];
                let bend = [real[1] / length, real[2] / length];
                for (index, (m, n)) in numbers(section, p).enumerate() {
                    let Some(force) = fibres.next() else { return };
                    let FibreForce { fibre, moves, first, second: [aa, ab, bb], by_ratio } = *force;
                    let Fibre { y, z, area, stretch, centre, .. } = fibre;
                    let material = &self.materials[m];
                    let constants = &p[material.constants.clone()];
                    let g = material.law.shear_modulus(constants);
                    let polar = y * y + z * z;
                    let rate = w * stretch;
                    // L â and L b̂, times w; a and b but for what extension makes of a.
                    let along = |[y, z]: [f64; 2]| z * bend_y - y * bend_z;
                    let bent = |[y, z]: [f64; 2]| stretch * (bend[0] * z - bend[1] * y);
                    let arm = fibre.arm();
                    let (virtual_a, virtual_b) = (rate * (length * axial + along(centre)), rate * along(arm));
                    let (by_a, by_b) = (bent(centre), bent(arm));
                    let force_a = area * (aa * virtual_a + ab * virtual_b);
                    let force_b = area * (ab * virtual_a + bb * virtual_b);
                    let work = first[0] * virtual_a + first[1] * virtual_b;
                    gradient[section.torsion] += twist * g * area * polar;
                    gradient[rod.length] += area * rate * first[0] * axial
                        - (force_a * by_a + force_b * by_b) / length
                        + g * area * torsion * twist * polar * twist_by_length;
                    let [series_by_area, series_by_modulus] = series.slopes(area, g);
                    // By the centre and by the arm.
                    let [of_centre, of_arm] = [(force_a, first[0]), (force_b, first[1])].map(|(f, d)| {
                        let (f, d) = (f * stretch, area * rate * d);
                        [-f * bend[1] - d * bend_z, f * bend[0] + d * bend_y]
                    });
                    let shifted = [of_centre[0] - of_arm[0], of_centre[1] - of_arm[1]];
                    let (of_place, centre) = if moves { (of_arm, shifted) } else { (of_centre, [0.0; 2]) };
                    let polar_by = torsion * twist * g * area * 2.0;
                    let total = stretch * (1.0 + real[3]) + by_a;
                    let derivatives = FibreDerivatives {
                        place: [of_place[0] + polar_by * y, of_place[1] + polar_by * z],
                        centre,
                        area: work + g * torsion * twist * polar + series_by_area * shear,
                        stretch: (area * work + force_a * total + force_b * by_b) / stretch,
                        ratio: area * (by_ratio[0] * virtual_a + by_ratio[1] * virtual_b),
                    };
                    let numbers_of = section.fibres + NUMBERS * index;
                    let out = &mut gradient[numbers_of..numbers_of + NUMBERS];
                    let by_radius = Fibre::add_derivatives(n, p[radius], derivatives, out);
                    gradient[radius] += by_radius;
                    if !sensitivity.wanted[m] {
                        continue;
                    }
                    let by_shear = area * torsion * twist * polar + series_by_modulus * shear;
                    for (k, by_constant) in material.constants.clone().zip(by_constant.by_ref()) {
                        let of_shear = material.law.shear_modulus_by(constants, k - material.constants.start);
                        let [by_a, by_b] = by_constant;
                        gradient[k] += area * (by_a * virtual_a + by_b * virtual_b) + by_shear * of_shear;
                    }
                }
            }
        }
    }
}

/// The parameter that a derivative is with respect to.
#[derive(Clone, Copy, PartialEq)]
enum Seed {
    Ratio,
    Constant(usize),
}
