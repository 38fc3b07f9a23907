//! Derivatives of the fibres' virtual work: λᵀ∂g/∂p = Σ w L A (∂w/∂a â + ∂w/∂b b̂), with â and b̂ the changes
//! of a and b under the virtual ε, θ_y and θ_z.

use super::description::{Fibre, FibreDerivatives, symmetric};
use super::jet::{Constant, Jet, MixedJet};
use super::stretches::{Free, Hooped, Logarithmic};
use super::wall::{Wall, Walls};
use super::{FibreSection, FibreSections, Law, NUMBERS, Series, length_power, numbers, strains};
use crate::forces::state::State;
use crate::lie::LieGroup;
use crate::linalg::Vector;

/// What is linear in the virtual ε, θ_y and θ_z of a Gauss point, in the work of a unit of torsional stiffness and in
/// that of shear.
type Slope = Vector<5>;

/// Slopes of the work at one fibre by the constants of its material.
#[derive(Clone, Copy, Debug)]
struct MaterialSlopes {
    /// What its energy's derivatives by a constant make of virtual a and b, as slopes.
    virtual_: [Slope; 2],
    /// By its shear modulus.
    modulus: Slope,
}

/// Slopes of the work at one Gauss point.
#[derive(Clone, Copy, Debug)]
struct PointSlopes {
    /// The strains there.
    strain: [f64; 6],
    length: Slope,
    radius: Slope,
    /// By the multiple of the torsional stiffness, per work of a unit.
    torsion: f64,
    /// Of the fibres in series.
    shear: f64,
    /// Whether a stiffness that is given matters.
    is_stiff: bool,
}

/// What is wanted of a section.
#[derive(Clone, Debug)]
struct Wanted {
    stiffness: bool,
    fibres: Vec<bool>,
}

/// The slopes of all Gauss points and fibres, Gauss point after Gauss point, and the derivatives of the energy by a and
/// b with respect to the constants of their materials, where these are wanted.
#[derive(Clone, Debug, Default)]
pub(crate) struct FibreSensitivity {
    points: Vec<PointSlopes>,
    fibres: Vec<FibreDerivatives<Slope>>,
    of_materials: Vec<MaterialSlopes>,
    by_constant: Vec<[f64; 2]>,
    /// For each material, whether a constant is wanted; for each section of each rod.
    materials: Vec<bool>,
    sections: Vec<Vec<Wanted>>,
    /// Constants of one fibre, with derivatives.
    seeded: Vec<Constant>,
    /// The fibres of a Gauss point.
    walls: Walls,
}

/// The energy of a fibre, w.
struct FibreEnergy {
    /// By a and b.
    first: [f64; 2],
    /// By a twice, by both, by b twice.
    second: [f64; 3],
    /// `first` by P.
    by_ratio: [f64; 2],
}

impl FibreSections {
    /// Notes which parameters are wanted, the same for all states.
    fn note_wanted(&self, wanted: &[bool], out: &mut FibreSensitivity) {
        let any = |range: std::ops::Range<usize>| wanted[range].contains(&true);
        out.materials.extend(self.materials.iter().map(|material| any(material.constants.clone())));
        out.sections.extend(self.rods.iter().map(|rod| {
            let of_section = |section: &FibreSection| {
                let first = |index: usize| section.fibres + NUMBERS * index;
                let fibres = (0..section.materials.len()).map(|index| any(first(index)..first(index + 1)));
                Wanted { stiffness: any(section.rigidity..section.rigidity + 21), fibres: fibres.collect() }
            };
            rod.sections.iter().map(of_section).collect()
        }));
    }

    pub(super) fn update<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        wanted: &[bool],
        out: &mut FibreSensitivity,
    ) {
        if out.materials.is_empty() {
            self.note_wanted(wanted, out);
        }
        let p = at.parameters();
        out.points.clear();
        out.fibres.clear();
        out.of_materials.clear();
        out.by_constant.clear();
        for (r, fibre_rod) in self.rods.iter().enumerate() {
            let rod = &at.tree.rods[fibre_rod.rod];
            let length = p[rod.length];
            for (gauss, section_index) in rod.gauss.iter().zip(&fibre_rod.of_gauss) {
                let section = &fibre_rod.sections[*section_index];
                let strain = strains(&gauss.columns, at.q);
                let s = p[rod.radius.start + gauss.point];
                let series = self.shear_in_series(section, p, s);
                let given = &p[section.rigidity..section.rigidity + 21];
                let mut point = PointSlopes {
                    strain,
                    length: SHEAR * (series.stiffness() / length),
                    radius: Slope::ZERO,
                    torsion: 0.0,
                    shear: series.stiffness(),
                    is_stiff: out.sections[r][*section_index].stiffness || given.iter().any(|k| *k != 0.0),
                };
                let mut walls = std::mem::take(&mut out.walls);
                walls.clear();
                for (m, n) in numbers(section, p) {
                    let fibre = self.materials[m].fibre(n, s);
                    walls.push(fibre.stretches([strain[3], strain[1], strain[2]], length), fibre.ratio);
                }
                for ((m, n), wall) in numbers(section, p).zip(walls.places()) {
                    let fibre = self.materials[m].fibre(n, s);
                    let energy = self.energy(m, p, wall);
                    if out.materials[m] {
                        self.add_by_constants(m, p, wall, out);
                    }
                    let place = (section, series, gauss.weight, length);
                    let (by, of_material) = self.slopes(m, p, fibre, &energy, place, &mut point);
                    point.radius += by.by_radius(n, s);
                    out.fibres.push(by);
                    if out.materials[m] {
                        out.of_materials.push(of_material);
                    }
                }
                out.walls = walls;
                out.points.push(point);
            }
        }
    }

    /// The slopes of a fibre; adds to those of its Gauss point.
    fn slopes(
        &self,
        material: usize,
        p: &[f64],
        fibre: Fibre,
        energy: &FibreEnergy,
        (section, series, weight, length): (&FibreSection, Series, f64, f64),
        point: &mut PointSlopes,
    ) -> (FibreDerivatives<Slope>, MaterialSlopes) {
        let Fibre { y, z, area, stretch, centre, .. } = fibre;
        let FibreEnergy { first, second: [aa, ab, bb], by_ratio } = *energy;
        let material = &self.materials[material];
        let g = material.law.shear_modulus(&p[material.constants.clone()]);
        let (torsion, polar) = (p[section.torsion], y * y + z * z);
        let rate = weight * stretch;
        // L â and L b̂, times w; a and b but for what extension makes of a.
        let bend = [point.strain[1] / length, point.strain[2] / length];
        let along = |[y, z]: [f64; 2]| BEND_Y * z + BEND_Z * -y;
        let bent = |[y, z]: [f64; 2]| stretch * (bend[0] * z - bend[1] * y);
        let arm = fibre.arm();
        let (virtual_a, virtual_b) = ((AXIAL * length + along(centre)) * rate, along(arm) * rate);
        let (by_a, by_b) = (bent(centre), bent(arm));
        let force_a = (virtual_a * aa + virtual_b * ab) * area;
        let force_b = (virtual_a * ab + virtual_b * bb) * area;
        let work = virtual_a * first[0] + virtual_b * first[1];
        point.torsion += g * area * polar;
        point.length = point.length + AXIAL * (area * rate * first[0])
            - (force_a * by_a + force_b * by_b) * length.recip()
            - TWIST * (g * area * torsion * polar / length);
        let [series_by_area, series_by_modulus] = series.slopes(area, g);
        // By the centre and by the arm.
        let [of_centre, of_arm] = [(force_a, first[0]), (force_b, first[1])].map(|(f, d)| {
            let (f, d) = (f * stretch, area * rate * d);
            [f * -bend[1] - BEND_Z * d, f * bend[0] + BEND_Y * d]
        });
        let shifted = [of_centre[0] - of_arm[0], of_centre[1] - of_arm[1]];
        let (of_place, centre) =
            if material.moves() { (of_arm, shifted) } else { (of_centre, [Slope::ZERO; 2]) };
        let polar_by = TWIST * (torsion * g * area * 2.0);
        let total = stretch * (1.0 + point.strain[3]) + by_a;
        let by = FibreDerivatives {
            place: [of_place[0] + polar_by * y, of_place[1] + polar_by * z],
            centre,
            area: work + TWIST * (g * torsion * polar) + SHEAR * series_by_area,
            stretch: (work * area + force_a * total + force_b * by_b) * stretch.recip(),
            ratio: (virtual_a * by_ratio[0] + virtual_b * by_ratio[1]) * area,
        };
        let modulus = TWIST * (area * torsion * polar) + SHEAR * series_by_modulus;
        (by, MaterialSlopes { virtual_: [virtual_a * area, virtual_b * area], modulus })
    }

    /// The energy of a fibre.
    fn energy(&self, material: usize, p: &[f64], wall: Wall) -> FibreEnergy {
        let material = &self.materials[material];
        let constants = &p[material.constants.clone()];
        if material.moves() {
            let w = material.law.energy(constants, Logarithmic { along: wall.stretch(), hoop: wall.hoop });
            let (first, second) = wall.chained(w.first, w.second);
            return FibreEnergy { first, second, by_ratio: wall.by_ratio(w.first, w.second) };
        }
        let stretch = Jet { value: wall.stretch(), first: 1.0, second: 0.0 };
        let w = match material.law {
            Law::Linear => Law::Linear.energy(&Law::modulus(constants, material.wound)[..1], Free(stretch)),
            law => law.energy(constants, Free(stretch)),
        };
        FibreEnergy { first: [w.first, 0.0], second: [w.second, 0.0, 0.0], by_ratio: [0.0; 2] }
    }

    /// Appends the derivatives of `FibreEnergy::first` by the constants of the fibre's material.
    fn add_by_constants(&self, material: usize, p: &[f64], wall: Wall, out: &mut FibreSensitivity) {
        let material = &self.materials[material];
        let constants = &p[material.constants.clone()];
        if material.law == Law::Linear {
            let [_, by_modulus @ ..] = Law::modulus(constants, material.wound);
            out.by_constant.extend(by_modulus.map(|by| [by * (wall.stretch() - 1.0), 0.0]));
            return;
        }
        for k in 0..constants.len() {
            out.seeded.clear();
            out.seeded.extend(Constant::seeded(constants, k));
            out.by_constant.push(if material.moves() {
                let [along, hoop] = wall.jets().map(MixedJet::from);
                material.law.energy(&out.seeded, Hooped::new(along, hoop)).by_parameter.first
            } else {
                let stretch = Jet { value: wall.stretch(), first: 1.0, second: 0.0 };
                [material.law.energy(&out.seeded, Free(MixedJet::from(stretch))).by_parameter.first, 0.0]
            });
        }
    }

    pub(super) fn add_work<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        sensitivity: &FibreSensitivity,
        lambda: &[f64],
        gradient: &mut [f64],
    ) {
        let p = at.parameters();
        let FibreSensitivity { points, fibres, of_materials, by_constant, materials, sections, .. } =
            sensitivity;
        let (mut points, mut fibres) = (points.iter(), fibres.iter());
        let (mut of_materials, mut by_constant) = (of_materials.iter(), by_constant.iter());
        for (fibre_rod, wanted) in self.rods.iter().zip(sections) {
            let rod = &at.tree.rods[fibre_rod.rod];
            let length = p[rod.length];
            for (gauss, index) in rod.gauss.iter().zip(&fibre_rod.of_gauss) {
                let Some(point) = points.next() else { return };
                let (section, wanted) = (&fibre_rod.sections[*index], &wanted[*index]);
                let (radius, w) = (rod.radius.start + gauss.point, gauss.weight);
                let virtual_ = strains(&gauss.columns, lambda);
                let pair = |i: usize, j: usize| {
                    let power = 1 + length_power(i) + length_power(j);
                    (w * point.strain[i] * virtual_[j] * length.powi(power), f64::from(power) / length)
                };
                if point.is_stiff {
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
                }
                let (twist, along_y, along_z) = (pair(0, 0).0, pair(4, 4).0, pair(5, 5).0);
                let shear = p[section.shear] * along_y + p[section.shear + 1] * along_z;
                let motion = Vector([virtual_[3], virtual_[1], virtual_[2], twist, shear]);
                gradient[section.torsion] += point.torsion * twist;
                gradient[section.shear] += point.shear * along_y;
                gradient[section.shear + 1] += point.shear * along_z;
                gradient[rod.length] += point.length.dot(&motion);
                gradient[radius] += point.radius.dot(&motion);
                for (index, (m, n)) in numbers(section, p).enumerate() {
                    let Some(by) = fibres.next() else { return };
                    if wanted.fibres[index] {
                        let first = section.fibres + NUMBERS * index;
                        let by = by.map(|slope| slope.dot(&motion));
                        by.add_by_numbers(n, p[radius], &mut gradient[first..first + NUMBERS]);
                    }
                    if !materials[m] {
                        continue;
                    }
                    let Some(MaterialSlopes { virtual_, modulus }) = of_materials.next() else { return };
                    let material = &self.materials[m];
                    let constants = &p[material.constants.clone()];
                    let (by_modulus, [a, b]) =
                        (modulus.dot(&motion), virtual_.map(|slope| slope.dot(&motion)));
                    for (k, [by_a, by_b]) in material.constants.clone().zip(by_constant.by_ref()) {
                        let of_shear = material.law.shear_modulus_by(constants, k - material.constants.start);
                        gradient[k] += by_a * a + by_b * b + by_modulus * of_shear;
                    }
                }
            }
        }
    }
}

const AXIAL: Slope = Vector([1.0, 0.0, 0.0, 0.0, 0.0]);
const BEND_Y: Slope = Vector([0.0, 1.0, 0.0, 0.0, 0.0]);
const BEND_Z: Slope = Vector([0.0, 0.0, 1.0, 0.0, 0.0]);
const TWIST: Slope = Vector([0.0, 0.0, 0.0, 1.0, 0.0]);
const SHEAR: Slope = Vector([0.0, 0.0, 0.0, 0.0, 1.0]);
