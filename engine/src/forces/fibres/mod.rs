//! FibreSections of material fibres: Σ ∫ W(ε, κ) dX with W = Σ A w(λ) and λ = 1 + ε + κ_y z − κ_z y, and
//! linear stiffness of torsion, shear and whatever else is given.
//!
//! With θ = Lκ, the fibre at (y, z) adds w L A w′(λ) (1, z/L, −y/L) to the forces conjugate to ε, θ_y and
//! θ_z at a Gauss point of weight w. Fibres of linear materials are summed up once for each design. In
//! curved walls that are wound, fibres move as the wall thins (`wall.rs`), and w depends on ε and κ by two
//! numbers.

mod arcs;
mod axial;
mod description;
mod elementary;
mod evaluation;
mod jet;
mod jet2;
mod law;
mod sensitivity;
mod single;
mod stretches;
mod wall;

use super::differential::{Differential, Largest};
use super::element::{ForceElement, ForceMemory, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::state::State;
use super::terms::Terms;
use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::strain::Mode;
use crate::tree::{ModelError, Tree};
use arcs::{ArcEnergies, Arcs};
use axial::{AxialStrains, PointForce, axial};
use description::{Fibre, FibreDerivatives, FibreRod, FibreSection, Material, NUMBERS, symmetric};
pub use description::{FibreDescription, FibreRodDescription, FibreSectionDescription, MaterialDescription};
use evaluation::{Energies, Fibres};
pub use law::Law;
pub(crate) use sensitivity::FibreSensitivity;
use wall::Walls;

/// All rods with sections of fibres.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FibreSections {
    materials: Vec<Material>,
    rods: Vec<FibreRod>,
    strains: AxialStrains,
}

/// Where a fibre is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FibrePlace {
    /// Its rod, with the indices of the sample point and of the Gauss point there.
    pub rod: usize,
    pub point: usize,
    gauss: usize,
    /// Parameter that holds its first number.
    first: usize,
}

/// What a design makes of the sections.
#[derive(Clone, Debug, Default)]
pub(crate) struct FibreDesign {
    /// Linear stiffness, rod after rod on its pattern.
    stiffness: Vec<f64>,
    /// Forces of linear fibres in the reference state, by coordinate, and their energy.
    force: Vec<f64>,
    energy: f64,
    /// Where other fibres are as well: forces of linear ones in the reference state, and their derivative.
    points: Vec<PointForce>,
    /// Other fibres, by material: in curved walls that are wound, and elsewhere.
    arcs: Vec<Arcs>,
    fibres: Vec<Fibres>,
}

/// What a state makes of the fibres that are not linear.
#[derive(Clone, Debug, Default)]
pub(crate) struct FibreState {
    /// ε, θ_y and θ_z at each Gauss point.
    strains: Vec<[f64; 3]>,
    energies: Energies,
    arc_energies: ArcEnergies,
    points: Vec<PointForce>,
}

/// Fibres of one material with their energies.
enum Evaluated<'a> {
    Fibres(&'a Fibres, &'a Energies),
    Arcs(&'a Arcs, &'a ArcEnergies),
}

/// The power of L that makes a strain of a coordinate's mode.
fn length_power(mode: usize) -> i32 {
    if Mode::ALL[mode].is_angular() { -1 } else { 0 }
}

/// Σ φ q by mode.
fn strains(columns: &[(usize, usize, f64)], q: &[f64]) -> [f64; 6] {
    let mut sum = [0.0; 6];
    columns.iter().for_each(|(dof, mode, phi)| sum[*mode] += phi * q[*dof]);
    sum
}

impl FibreSections {
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        materials: &[MaterialDescription],
        rods: &[FibreRodDescription],
    ) -> Result<Self, ModelError> {
        let materials = description::materials(tree, materials)?;
        let rods = rods.iter().map(|rod| description::rod(tree, rod, &materials));
        let rods = rods.collect::<Result<Vec<_>, _>>()?;
        let described = |r: usize| rods.iter().filter(|rod| rod.rod == r).count();
        for (r, rod) in tree.rods.iter().enumerate() {
            let needed = usize::from(rod.factors.is_none());
            if described(r) != needed {
                return Err(ModelError::new("fibres", "each rod of fibres needs its sections once"));
            }
        }
        let strains = AxialStrains::new(&rods, &tree.rods);
        Ok(Self { materials, rods, strains })
    }

    pub fn material_count(&self) -> usize {
        self.materials.len()
    }

    /// Visits the stretch of each fibre, with its material.
    #[inline]
    pub fn for_each_stretch<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        tree: &Tree<G, D, P>,
        p: &[f64],
        q: &[f64],
        mut visit: impl FnMut(usize, FibrePlace, f64),
    ) {
        let (mut materials, mut walls) = (vec![], Walls::default());
        for fibre_rod in &self.rods {
            let rod = &tree.rods[fibre_rod.rod];
            let length = p[rod.length];
            for (g, (gauss, section)) in rod.gauss.iter().zip(&fibre_rod.of_gauss).enumerate() {
                let strain = strains(&gauss.columns, q);
                let strain = [strain[3], strain[1], strain[2]];
                let s = p[rod.radius.start + gauss.point];
                let section = &fibre_rod.sections[*section];
                materials.clear();
                walls.clear();
                for (m, n) in numbers(section, p) {
                    let fibre = self.materials[m].fibre(n, s);
                    materials.push(m);
                    walls.push(fibre.stretches(strain, length), fibre.ratio);
                }
                for (index, (m, stretch)) in materials.iter().zip(walls.stretches()).enumerate() {
                    let first = section.fibres + NUMBERS * index;
                    let place = FibrePlace { rod: fibre_rod.rod, point: gauss.point, gauss: g, first };
                    visit(*m, place, *stretch);
                }
            }
        }
    }

    /// Adds a multiple of the change of the least (`sign` −1) or greatest (1) stretch of a material's fibres.
    pub fn add_stretch<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        material: usize,
        sign: f64,
        at: &State<G, D, P>,
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        let (p, tree) = (at.parameters(), at.tree);
        let mut largest = Largest::new();
        self.for_each_stretch(tree, p, at.q, |m, place, stretch| {
            if m == material {
                // Mirror images of a fibre are stretched alike.
                let mirrored = |other: &(FibrePlace, f64)| {
                    let same = |k: usize| p[place.first + k].abs() == p[other.0.first + k].abs();
                    (place.rod, place.gauss) == (other.0.rod, other.0.gauss) && (0..NUMBERS).all(same)
                };
                largest.offer(sign * stretch, (place, stretch), mirrored);
            }
        });
        let Some((place, _)) = largest.place else { return };
        out.tied |= largest.tied;
        let rod = &tree.rods[place.rod];
        let (gauss, length) = (&rod.gauss[place.gauss], p[rod.length]);
        let radius = rod.radius.start + place.point;
        let numbers = &p[place.first..place.first + NUMBERS];
        let fibre = self.materials[material].fibre(numbers, p[radius]);
        let strain = strains(&gauss.columns, at.q);
        let bend = [strain[1] / length, strain[2] / length];
        // By a and b, and by P (see `wall.rs`).
        let (by, by_ratio) = if self.materials[material].moves() {
            fibre.wall([strain[3], strain[1], strain[2]], length).stretch_slopes()
        } else {
            ([1.0; 2], 0.0)
        };
        let arm = fibre.arm();
        let [y, z] = [0, 1].map(|k| by[0] * fibre.centre[k] + by[1] * arm[k]);
        let slope = weight * fibre.stretch;
        for (dof, mode, phi) in &gauss.columns {
            let arm = match mode {
                1 => z / length,
                2 => -y / length,
                3 => by[0],
                _ => 0.0,
            };
            out.coordinates[*dof] += slope * phi * arm;
        }
        let bent = bend[0] * z - bend[1] * y;
        out.parameters[rod.length] -= slope * bent / length;
        let by_place = [-slope * bend[1], slope * bend[0]];
        let by = FibreDerivatives {
            place: by_place.map(|d| d * by[1]),
            centre: by_place.map(|d| d * (by[0] - by[1])),
            stretch: weight * (by[0] * (1.0 + strain[3]) + bent),
            ratio: weight * by_ratio,
            area: 0.0,
        };
        out.parameters[radius] += by.by_radius(numbers, p[radius]);
        by.add_by_numbers(numbers, p[radius], &mut out.parameters[place.first..place.first + NUMBERS]);
    }

    /// Evaluates the fibres that are not linear under the strains of the state, and visits them by material;
    /// returns whether all of them exist.
    fn for_each_material<const P: usize>(
        &self,
        p: &[f64],
        design: &FibreDesign,
        state: &mut FibreState,
        mut visit: impl FnMut(Evaluated),
    ) -> bool {
        let FibreState { strains, energies, arc_energies, .. } = state;
        let mut sound = true;
        for ((material, fibres), arcs) in self.materials.iter().zip(&design.fibres).zip(&design.arcs) {
            let constants = &p[material.constants.clone()];
            if !fibres.is_empty() {
                sound &= fibres.evaluate(material.law, constants, material.wound, strains, energies);
                visit(Evaluated::Fibres(fibres, energies));
            }
            if !arcs.is_empty() {
                sound &= arcs.evaluate::<P>(material.law, constants, strains, arc_energies);
                visit(Evaluated::Arcs(arcs, arc_energies));
            }
        }
        sound
    }

    /// Forces at the Gauss points; returns the energy, which is not a number where a fibre vanishes.
    fn evaluate<const P: usize>(
        &self,
        p: &[f64],
        q: &[f64],
        design: &FibreDesign,
        state: &mut FibreState,
    ) -> f64 {
        self.strains.strains(q, &mut state.strains);
        let mut points = std::mem::take(&mut state.points);
        points.clone_from(&design.points);
        let mut total = points.iter_mut().zip(&state.strains).map(|(point, e)| point.strain(e)).sum();
        let sound = self.for_each_material::<P>(p, design, state, |evaluated| {
            total += match evaluated {
                Evaluated::Fibres(fibres, energies) => fibres.add_forces::<P>(energies, &mut points),
                Evaluated::Arcs(arcs, energies) => arcs.add_forces::<P>(energies, &mut points),
            };
        });
        state.points = points;
        if sound { total } else { f64::NAN }
    }

    /// Visits the linear stiffness of each pair of coordinates.
    fn for_each_linear(&self, stiffness: &[f64], mut visit: impl FnMut(usize, usize, f64)) {
        let pattern = self.rods.iter().flat_map(|rod| &rod.pattern);
        pattern.zip(stiffness).for_each(|((i, j), k)| visit(*i, *j, *k));
    }
}

/// Forces conjugate to ε, θ_y, θ_z and their derivative, of those per length in the order of the modes.
fn at_point(matrix: &[[f64; 6]; 6], force: &[f64; 6], scale: f64, length: f64) -> PointForce {
    let mut point = PointForce::default();
    let axial = |mode: usize| axial(mode).map(|m| (m, length.powi(length_power(mode))));
    for (mode, (m, one)) in (0..6).filter_map(|mode| Some((mode, axial(mode)?))) {
        point.force[m] = scale * one * force[mode];
        for (other, (n, two)) in (0..6).filter_map(|mode| Some((mode, axial(mode)?))) {
            point.tangent[m][n] = scale * one * two * matrix[mode][other];
        }
    }
    point
}

/// The numbers of a section's fibres, in the order of their materials.
fn numbers<'a>(section: &'a FibreSection, p: &'a [f64]) -> impl Iterator<Item = (usize, &'a [f64])> + 'a {
    let all = &p[section.fibres..section.fibres + NUMBERS * section.materials.len()];
    section.materials.iter().copied().zip(all.chunks_exact(NUMBERS))
}

impl<const P: usize> ForceMemory<P> for FibreSections {
    type Design = FibreDesign;
    type State = FibreState;
    type Sensitivity = FibreSensitivity;
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for FibreSections {
    fn design(&self, _: &Tree<G, D, P>) -> FibreDesign {
        FibreDesign::default()
    }

    fn state(&self, _: &Tree<G, D, P>) -> FibreState {
        FibreState::default()
    }

    fn is_admissible(&self, p: &[f64]) -> bool {
        let sound = |section: &FibreSection, s: f64| {
            let clear = |c: &[f64]| c[0] + c[1] * s >= 0.0;
            let fibre = |n: &[f64]| n[7] > 0.0 && Fibre::new(n, s).area >= 0.0 && n[10] + n[11] * s > 0.0;
            p[section.clearances.clone()].chunks_exact(2).all(clear)
                && p[section.mass] + s * (p[section.mass + 1] + s * p[section.mass + 2]) >= 0.0
                && numbers(section, p).all(|(_, n)| fibre(n))
        };
        self.materials.iter().all(|m| m.law.is_admissible(&p[m.constants.clone()]))
            && self.rods.iter().all(|rod| {
                rod.of_gauss.iter().zip(&rod.radii).all(|(section, s)| sound(&rod.sections[*section], p[*s]))
            })
    }

    fn update_design(&self, tree: &Tree<G, D, P>, geometry: &Geometry<G, D, P>, design: &mut FibreDesign) {
        let p = &geometry.parameters;
        let FibreDesign { stiffness, force, energy, points, arcs, fibres } = design;
        points.clear();
        fibres.resize_with(self.materials.len(), Fibres::default);
        fibres.iter_mut().for_each(Fibres::clear);
        arcs.resize_with(self.materials.len(), Arcs::default);
        arcs.iter_mut().for_each(Arcs::clear);
        stiffness.clear();
        force.clear();
        force.resize(if self.rods.is_empty() { 0 } else { tree.dof }, 0.0);
        *energy = 0.0;
        for fibre_rod in &self.rods {
            let rod = &tree.rods[fibre_rod.rod];
            let length = p[rod.length];
            let first = stiffness.len();
            stiffness.resize(first + fibre_rod.pattern.len(), 0.0);
            let stiffness = &mut stiffness[first..];
            for (g, gauss) in rod.gauss.iter().enumerate() {
                let section = &fibre_rod.sections[fibre_rod.of_gauss[g]];
                let s = p[rod.radius.start + gauss.point];
                let scale = gauss.weight * length;
                for (m, n) in numbers(section, p).filter(|(m, _)| self.materials[*m].law != Law::Linear) {
                    let fibre = self.materials[m].fibre(n, s);
                    if self.materials[m].moves() && !fibre.is_flat() {
                        arcs[m].push(points.len(), &fibre, length, scale);
                    } else {
                        fibres[m].push(points.len(), &fibre, length, scale);
                    }
                }
                let (matrix, residual, own) = self.linear(section, p, s);
                *energy += scale * own;
                if fibre_rod.linear {
                    for (dof, mode, phi) in &gauss.columns {
                        force[*dof] += scale * phi * residual[*mode] * length.powi(length_power(*mode));
                    }
                } else {
                    points.push(at_point(&matrix, &residual, scale, length));
                }
                for (a, b, entry) in &fibre_rod.pairs[g] {
                    let ((_, m, phi), (_, n, other)) = (gauss.columns[*a], gauss.columns[*b]);
                    let power = length_power(m) + length_power(n);
                    stiffness[*entry] += scale * phi * other * matrix[m][n] * length.powi(power);
                }
            }
        }
    }

    fn add_elastic_stiffness(
        &self,
        tree: &Tree<G, D, P>,
        geometry: &Geometry<G, D, P>,
        design: &FibreDesign,
        stiffness: &mut [f64],
    ) {
        let mut diagonal = |i: usize, j: usize, k: f64| {
            if i == j {
                stiffness[i] += k
            }
        };
        self.for_each_linear(&design.stiffness, &mut diagonal);
        let mut state = FibreState::default();
        self.evaluate::<P>(&geometry.parameters, &vec![0.0; tree.dof], design, &mut state);
        self.strains.for_each_pair(&state.points, diagonal);
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        design: &FibreDesign,
        state: &mut FibreState,
        Terms { coordinates: out, .. }: &mut Terms<D>,
    ) {
        if self.rods.is_empty() {
            return;
        }
        let mut energy = design.energy;
        for ((gradient, force), q) in out.gradient.iter_mut().zip(&design.force).zip(at.q) {
            *gradient += force;
            energy += force * q;
        }
        let q = at.q;
        self.for_each_linear(&design.stiffness, |i, j, k| energy += out.add_quadratic(i, j, k, q));
        energy += self.evaluate::<P>(at.parameters(), q, design, state);
        self.strains.for_each_force(|point| &state.points[point].force, |i, force| out.gradient[i] += force);
        out.energy += energy;
    }

    fn add_tangent(&self, _: &State<G, D, P>, design: &FibreDesign, state: &FibreState, out: &mut Terms<D>) {
        let mut add = |i: usize, j: usize, k: f64| out.coordinates.add_stiffness(i, j, k);
        self.for_each_linear(&design.stiffness, &mut add);
        self.strains.for_each_pair(&state.points, add);
    }

    fn add_magnitudes(
        &self,
        at: &State<G, D, P>,
        design: &FibreDesign,
        _: &FibreState,
        out: &mut Magnitudes<P>,
    ) {
        design.force.iter().enumerate().for_each(|(i, force)| out.add(i, *force));
        self.for_each_linear(&design.stiffness, |i, j, k| out.add_quadratic(i, j, k, at.q));
        let (mut points, mut state) = (vec![[0.0; 3]; self.strains.points], FibreState::default());
        self.strains.strains(at.q, &mut state.strains);
        self.for_each_material::<P>(at.parameters(), design, &mut state, |evaluated| match evaluated {
            Evaluated::Fibres(fibres, energies) => fibres.add_magnitudes(energies, &mut points),
            Evaluated::Arcs(arcs, energies) => arcs.add_magnitudes(energies, &mut points),
        });
        for ((sum, linear), e) in points.iter_mut().zip(&design.points).zip(&state.strains) {
            for (m, sum) in sum.iter_mut().enumerate() {
                *sum += linear.force[m].abs();
                *sum += (0..3).map(|n| (linear.tangent[m][n] * e[n]).abs()).sum::<f64>();
            }
        }
        self.strains.for_each_force(|point| &points[point], |i, force| out.add(i, force));
    }

    fn update_sensitivity(
        &self,
        at: &State<G, D, P>,
        _: &FibreDesign,
        _: &FibreState,
        wanted: &[bool],
        fibres: &mut FibreSensitivity,
    ) {
        self.update(at, wanted, fibres);
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &FibreDesign,
        _: &FibreState,
        fibres: &FibreSensitivity,
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        self.add_work(at, fibres, motion.coordinates, gradient);
    }
}

/// Fibres that shear in series.
#[derive(Clone, Copy, Debug, Default)]
struct Series {
    /// Σ A and Σ A/G.
    area: f64,
    compliance: f64,
}

impl Series {
    /// (Σ A)²/Σ A/G, zero without fibres.
    fn stiffness(self) -> f64 {
        if self.area > 0.0 { self.area * self.area / self.compliance } else { 0.0 }
    }

    /// Its derivatives by area and modulus of a fibre.
    fn slopes(self, area: f64, modulus: f64) -> [f64; 2] {
        if !(self.area > 0.0) {
            return [0.0; 2];
        }
        let mean = self.area / self.compliance;
        [mean * (2.0 - mean / modulus), area * (mean / modulus).powi(2)]
    }
}

impl FibreSections {
    fn shear_in_series(&self, section: &FibreSection, p: &[f64], s: f64) -> Series {
        let mut series = Series::default();
        for (m, n) in numbers(section, p) {
            let material = &self.materials[m];
            let area = Fibre::new(n, s).area;
            series.area += area;
            series.compliance += area / material.law.shear_modulus(&p[material.constants.clone()]);
        }
        series
    }

    /// Stiffness matrix, forces in the reference state and energy per length of what is linear, in the
    /// order of the modes.
    fn linear(&self, section: &FibreSection, p: &[f64], s: f64) -> ([[f64; 6]; 6], [f64; 6], f64) {
        let mut matrix = symmetric(&p[section.rigidity..section.rigidity + 21]).0;
        let (mut force, mut energy) = ([0.0; 6], 0.0);
        let series = self.shear_in_series(section, p, s).stiffness();
        matrix[4][4] += p[section.shear] * series;
        matrix[5][5] += p[section.shear + 1] * series;
        for (m, n) in numbers(section, p) {
            let (material, fibre) = (&self.materials[m], Fibre::new(n, s));
            let constants = &p[material.constants.clone()];
            let shear = material.law.shear_modulus(constants) * fibre.area;
            let polar = fibre.y * fibre.y + fibre.z * fibre.z;
            matrix[0][0] += p[section.torsion] * shear * polar;
            if material.law == Law::Linear {
                let axial = Law::modulus(constants, material.wound)[0] * fibre.area * fibre.stretch;
                let arms = [(3, 1.0), (1, fibre.z), (2, -fibre.y)];
                for (a, arm) in arms {
                    force[a] += axial * (fibre.stretch - 1.0) * arm;
                    for (b, other) in arms {
                        matrix[a][b] += axial * fibre.stretch * arm * other;
                    }
                }
                energy += 0.5 * axial / fibre.stretch * (fibre.stretch - 1.0).powi(2);
            }
        }
        (matrix, force, energy)
    }
}
