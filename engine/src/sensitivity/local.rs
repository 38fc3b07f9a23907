//! Parameters that act where they are: moduli, stiffnesses, radii, levers, densities.

use super::adjoint::Adjoint;
use crate::data::Data;
use crate::design::{dot, link_fraction, thread_arm};
use crate::lie::LieGroup;
use crate::model::{Mass, Model, Rod, Shape, SphereRadius};
use crate::section;
use crate::strain::Mode;

/// A Gauss point of a chamber or cable in the state at hand.
#[derive(Clone, Debug)]
pub(super) struct Thread {
    /// (y, z) of the path in the cross-section.
    offset: [f64; 2],
    /// τ̂ and |τ|.
    unit: [f64; 3],
    norm: f64,
    /// −u w.
    tension: f64,
    /// Derivatives of τ with respect to the offset and to L.
    by_offset: [[f64; 3]; 2],
    by_length: [f64; 3],
}

const SIDES: [[f64; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];

fn moduli(rod: &Rod, parameters: &[f64]) -> [f64; 6] {
    let [young, shear] = [rod.young_modulus, rod.shear_modulus].map(|i| parameters[i]);
    Mode::ALL.map(|mode| section::modulus(mode, young, shear))
}

/// Adds what coordinates make of the normalised strains at a Gauss point, mode by mode.
fn add_strain(strain: &mut [f64; 6], columns: &[(usize, usize, f64)], length: f64, coordinates: &[f64]) {
    for &(dof, mode, phi) in columns {
        strain[mode] += coordinates[dof] * if mode < 3 { phi } else { phi * length };
    }
}

/// What strains make of a path's tangent at `offset`; if `lateral`, only what the offset has to do with.
fn along<G: LieGroup<D, P>, const D: usize, const P: usize>(
    strain: &[f64; 6],
    offset: [f64; 2],
    lateral: bool,
) -> [f64; 3] {
    let mut t = [0.0; 3];
    for mode in G::AXES {
        if lateral && !mode.is_angular() {
            continue;
        }
        let arm = thread_arm(mode, offset);
        for i in 0..3 {
            t[i] += strain[mode.index()] * arm[i];
        }
    }
    t
}

impl<const D: usize, const P: usize> Adjoint<D, P> {
    pub(super) fn add_local<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        q: &[f64],
        lambda: &[f64],
    ) {
        self.add_elastic(model, data, q, lambda);
        self.add_actuators(model, data, lambda);
        self.add_contacts(model, data);
        self.add_springs(model, data);
        self.add_masses(model, data);
        for joint in &model.joints {
            self.gradient[joint.stiffness] += (q[joint.dof] - joint.joint.rest) * lambda[joint.dof];
        }
    }

    /// K_ij = Σ modulus · factor · S^power · L^{∓1} · w φ_i φ_j: each term, divided by S.
    pub(super) fn update_sections<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
    ) {
        let p = &data.design.parameters;
        self.sections.clear();
        for rod in &model.rods {
            let (length, factors) = (p[rod.length], section::factors(rod.section));
            let moduli = moduli(rod, p);
            self.sections.extend(rod.entries.iter().map(|entry| {
                let at = rod.radius.start + rod.gauss[entry.gauss].point;
                let mode = Mode::ALL[entry.mode];
                let scale = if mode.is_angular() { 1.0 / length } else { length };
                let power = p[at].powi(section::power(mode) - 1);
                moduli[entry.mode] * factors[entry.mode] * scale * entry.value * power
            }));
        }
    }

    /// λᵀ K q: each factor of the terms of K in turn.
    fn add_elastic<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        q: &[f64],
        lambda: &[f64],
    ) {
        let p = &data.design.parameters;
        let mut sections = self.sections.iter();
        for rod in &model.rods {
            let powers = Mode::ALL.map(|mode| f64::from(section::power(mode)));
            let mut works = [0.0; 6];
            for (entry, section) in rod.entries.iter().zip(&mut sections) {
                let (i, j) = model.stiffness_pattern[entry.entry];
                let pair = if i == j { q[i] * lambda[i] } else { q[i] * lambda[j] + q[j] * lambda[i] };
                let at = rod.radius.start + rod.gauss[entry.gauss].point;
                let work = section * pair;
                self.gradient[at] += powers[entry.mode] * work;
                works[entry.mode] += p[at] * work;
            }
            for ((mode, work), modulus) in Mode::ALL.into_iter().zip(works).zip(moduli(rod, p)) {
                self.gradient[rod.length] += if mode.is_angular() { -work } else { work } / p[rod.length];
                let young = matches!(mode, Mode::BendY | Mode::BendZ | Mode::ExtendX);
                self.gradient[if young { rod.young_modulus } else { rod.shear_modulus }] += work / modulus;
            }
        }
    }

    /// −u ℓ: how the path's tangent τ and its arms change with S, S′, the lever and L.
    fn add_actuators<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        lambda: &[f64],
    ) {
        let p = &data.design.parameters;
        let mut threads = self.threads.iter();
        for actuator in &model.actuators {
            let rod = &model.rods[actuator.rod];
            let length = p[rod.length];
            for (gauss, thread) in rod.gauss.iter().zip(threads.by_ref().take(actuator.tendon.len())) {
                let Thread { offset, unit, norm, tension, by_offset, by_length } = thread;
                let (at, slope) = (rod.radius.start + gauss.point, rod.slope.start + gauss.point);
                let mut strain = [0.0; 6];
                add_strain(&mut strain, &gauss.columns, length, lambda);
                let v = along::<G, D, P>(&strain, *offset, false);
                // d(τ̂·v) for a change (dτ, dv).
                let work = |dtau: [f64; 3], dv: [f64; 3]| {
                    tension * ((dot(&dtau, &v) - dot(&dtau, unit) * dot(unit, &v)) / norm + dot(unit, &dv))
                };
                for i in 0..2 {
                    let mut slide = [0.0; 3];
                    slide[i + 1] = 1.0;
                    let by_offset = work(by_offset[i], along::<G, D, P>(&strain, SIDES[i], true));
                    let by_slope = work(slide, [0.0; 3]);
                    let lever = p[actuator.lever + i];
                    self.gradient[at] += lever * by_offset;
                    self.gradient[slope] += lever * by_slope;
                    self.gradient[actuator.lever + i] += p[at] * by_offset + p[slope] * by_slope;
                }
                for mode in G::AXES {
                    let m = mode.index();
                    strain[m] = if mode.is_angular() { 0.0 } else { strain[m] / length };
                }
                self.gradient[rod.length] += work(*by_length, along::<G, D, P>(&strain, *offset, false));
            }
        }
    }

    /// What the actuators' Gauss points contribute to every output.
    pub(super) fn update_threads<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        q: &[f64],
        load: &[f64],
    ) {
        let p = &data.design.parameters;
        self.threads.clear();
        for (a, actuator) in model.actuators.iter().enumerate() {
            let rod = &model.rods[actuator.rod];
            let length = p[rod.length];
            for (tendon, gauss) in actuator.tendon.iter().zip(&rod.gauss) {
                let (at, slope) = (rod.radius.start + gauss.point, rod.slope.start + gauss.point);
                let offset = [0, 1].map(|i| tendon.offset[i] + p[actuator.lever + i] * p[at]);
                // Normalised strains of the state, mode by mode.
                let mut strain = [0.0; 6];
                for mode in G::AXES {
                    strain[mode.index()] = length * rod.reference_strain[mode.index()];
                }
                add_strain(&mut strain, &gauss.columns, length, q);
                let mut tau = along::<G, D, P>(&strain, offset, false);
                for i in 0..2 {
                    tau[i + 1] += tendon.slope[i] + p[actuator.lever + i] * p[slope];
                }
                let norm = dot(&tau, &tau).sqrt();
                let by_offset = SIDES.map(|side| along::<G, D, P>(&strain, side, true));
                // L scales linear strains and the whole reference strain.
                for mode in G::AXES {
                    let m = mode.index();
                    strain[m] = if mode.is_angular() { rod.reference_strain[m] } else { strain[m] / length };
                }
                self.threads.push(Thread {
                    offset,
                    unit: tau.map(|t| t / norm),
                    norm,
                    tension: -actuator.sign * load[a] * gauss.weight,
                    by_offset,
                    by_length: along::<G, D, P>(&strain, offset, false),
                });
            }
        }
    }

    fn add_contacts<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>, data: &Data<G, D, P>) {
        let p = &data.design.parameters;
        let (velocity, gradient) = (&self.velocity, &mut self.gradient);
        for (contact, k, touch) in data.touching(model) {
            let velocity = touch.motion(model, velocity);
            let (approach, slide) = (touch.closing(&velocity), touch.slide(&velocity));
            gradient[contact.stiffness] += touch.weight * touch.overlap * approach;
            if let Some(length) = contact.lengths.get(touch.first - contact.first.start) {
                gradient[*length] += k * touch.overlap * approach / p[*length];
            }
            let by_slip = touch.overlap * touch.slip * slide;
            let [a, b] = touch.second;
            for (i, sphere) in [touch.first, a, b].into_iter().enumerate() {
                let weight = touch.by_radii()[i] * approach + touch.slide_by_radii()[i] * by_slip;
                add_radius(model, p, model.spheres[sphere].radius, k * weight, gradient);
            }
        }
    }

    fn add_springs<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>, data: &Data<G, D, P>) {
        let p = &data.design.parameters;
        for spring in &model.springs {
            let [a, b] = spring.ends;
            let r = data.kinematics.points[a] - data.kinematics.points[b];
            let stretch = r.norm() - p[spring.rest_length];
            if (spring.slack && stretch <= 0.0) || r.norm() == 0.0 {
                continue;
            }
            let apart = (r * (1.0 / r.norm())).dot(&(self.velocity[a] - self.velocity[b]));
            self.gradient[spring.stiffness] += stretch * apart;
            self.gradient[spring.rest_length] -= p[spring.stiffness] * apart;
        }
    }

    /// Weights: −m g·v with m ∝ ρ S² L for rods, ρ L (a² + ab + b²) for links.
    fn add_masses<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>, data: &Data<G, D, P>) {
        let p = &data.design.parameters;
        let values = data.design.masses.iter().zip(&data.design.volumes);
        for (mass, (m, volume)) in model.masses.iter().zip(values) {
            let work = -model.gravity.dot(&self.velocity[mass.point()]);
            let mut relative = |i: usize, power: f64| self.gradient[i] += power * m * work / p[i];
            match mass {
                Mass::Rod(_, r, g) => {
                    let rod = &model.rods[*r];
                    relative(rod.radius.start + rod.gauss[*g].point, 2.0);
                    relative(rod.length, 1.0);
                    self.gradient[rod.density] += volume * work;
                }
                Mass::Link(_, b) => {
                    let Shape::Link(link) = &model.bodies[*b].shape else { continue };
                    relative(link.length, 1.0);
                    self.gradient[link.density] += volume * work;
                    let (a, b) = (p[link.radius_base], p[link.radius_tip]);
                    let sum = a * a + a * b + b * b;
                    self.gradient[link.radius_base] += m * work * (2.0 * a + b) / sum;
                    self.gradient[link.radius_tip] += m * work * (a + 2.0 * b) / sum;
                }
            }
        }
    }
}

/// Adds `weight · dR/dp` of a sphere's radius R.
pub(super) fn add_radius<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    parameters: &[f64],
    radius: SphereRadius,
    weight: f64,
    gradient: &mut [f64],
) {
    match radius {
        SphereRadius::Parameter(k) => gradient[k] += weight,
        SphereRadius::Link(body, place) => {
            let Shape::Link(link) = &model.bodies[body].shape else { return };
            let (_, f) = link_fraction(model, parameters, place);
            gradient[link.radius_base] += weight * (1.0 - f);
            gradient[link.radius_tip] += weight * f;
            // The centroid's fraction depends on the radii too.
            let taper = parameters[link.radius_tip] - parameters[link.radius_base];
            let [by_base, by_tip] = super::motion::fraction_slope(parameters, link, place);
            gradient[link.radius_base] += weight * taper * by_base;
            gradient[link.radius_tip] += weight * taper * by_tip;
        }
    }
}
