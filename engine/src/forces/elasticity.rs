//! Elasticity of rods: ½ qᵀ K q, with K from the section stiffness by Gauss quadrature.

use super::element::{ForceElement, ForceMemory, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::state::State;
use super::terms::Terms;
use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::section;
use crate::strain::Mode;
use crate::tree::{Rod, Tree};

/// The elasticity of all rods of the tree.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Elasticity;

/// Stiffness of a rod by mode: modulus, modulus times section factor, and the power ∓1 of the length
/// that belongs to L·κ or ε, so that K_ij = Σ (modulus · factor) S^power L^{∓1} · w φ_i φ_j.
struct ModeStiffness {
    modulus: f64,
    rigidity: f64,
    length: f64,
    power: i32,
}

fn mode_stiffness(rod: &Rod, parameters: &[f64]) -> [ModeStiffness; 6] {
    let [young, shear] = [rod.young_modulus, rod.shear_modulus].map(|i| parameters[i]);
    let length = parameters[rod.length];
    Mode::ALL.map(|mode| {
        let modulus = section::modulus(mode, young, shear);
        let factor = rod.factors.map_or(0.0, |factors| parameters[factors + section::factor_of(mode)]);
        ModeStiffness {
            modulus,
            rigidity: modulus * factor,
            // q is L·κ or ε, so the energy density per unit X is EI q²/L or EA L q².
            length: if mode.is_angular() { 1.0 / length } else { length },
            power: section::power(mode),
        }
    })
}

impl<const P: usize> ForceMemory<P> for Elasticity {
    /// Values of K on `tree.stiffness_pattern`.
    type Design = Vec<f64>;
    type State = ();
    /// For every entry of the rods' stiffness: its contribution to K_ij, divided by S.
    type Sensitivity = Vec<f64>;
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Elasticity {
    fn design(&self, tree: &Tree<G, D, P>) -> Vec<f64> {
        vec![0.0; tree.stiffness_pattern.len()]
    }

    fn state(&self, _: &Tree<G, D, P>) {}

    fn update_design(&self, tree: &Tree<G, D, P>, geometry: &Geometry<G, D, P>, stiffness: &mut Vec<f64>) {
        let p = &geometry.parameters;
        stiffness.fill(0.0);
        for rod in &tree.rods {
            let modes = mode_stiffness(rod, p);
            for entry in &rod.entries {
                let radius = p[rod.radius.start + rod.gauss[entry.gauss].point];
                let ModeStiffness { rigidity, length, power, .. } = modes[entry.mode];
                stiffness[entry.entry] += rigidity * radius.powi(power) * length * entry.value;
            }
        }
    }

    fn add_elastic_stiffness(
        &self,
        tree: &Tree<G, D, P>,
        _: &Geometry<G, D, P>,
        design: &Vec<f64>,
        stiffness: &mut [f64],
    ) {
        for (&(i, j), k) in tree.stiffness_pattern.iter().zip(design) {
            if i == j {
                stiffness[i] += k;
            }
        }
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        stiffness: &Vec<f64>,
        _: &mut (),
        Terms { coordinates: out, .. }: &mut Terms<D>,
    ) {
        let q = at.q;
        let mut energy = 0.0;
        for (&(i, j), &k) in at.tree.stiffness_pattern.iter().zip(stiffness) {
            energy += out.add_quadratic(i, j, k, q);
        }
        out.energy += energy;
    }

    fn add_tangent(&self, at: &State<G, D, P>, stiffness: &Vec<f64>, _: &(), out: &mut Terms<D>) {
        for (&(i, j), &k) in at.tree.stiffness_pattern.iter().zip(stiffness) {
            out.coordinates.add_stiffness(i, j, k);
        }
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, stiffness: &Vec<f64>, _: &(), out: &mut Magnitudes<P>) {
        for (&(i, j), &k) in at.tree.stiffness_pattern.iter().zip(stiffness) {
            out.add_quadratic(i, j, k, at.q);
        }
    }

    fn update_sensitivity(
        &self,
        at: &State<G, D, P>,
        _: &Vec<f64>,
        _: &(),
        _: &[bool],
        sections: &mut Vec<f64>,
    ) {
        let p = at.parameters();
        sections.clear();
        for rod in &at.tree.rods {
            let modes = mode_stiffness(rod, p);
            sections.extend(rod.entries.iter().map(|entry| {
                let radius = p[rod.radius.start + rod.gauss[entry.gauss].point];
                let ModeStiffness { rigidity, length, power, .. } = modes[entry.mode];
                rigidity * length * entry.value * radius.powi(power - 1)
            }));
        }
    }

    /// λᵀ K q: each factor of the terms of K in turn.
    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &Vec<f64>,
        _: &(),
        sections: &Vec<f64>,
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        let (p, q, lambda) = (at.parameters(), at.q, motion.coordinates);
        let mut sections = sections.iter();
        for rod in &at.tree.rods {
            let modes = mode_stiffness(rod, p);
            let powers = modes.each_ref().map(|mode| f64::from(mode.power));
            let mut works = [0.0; 6];
            for (entry, section) in rod.entries.iter().zip(&mut sections) {
                let (i, j) = at.tree.stiffness_pattern[entry.entry];
                let pair = if i == j { q[i] * lambda[i] } else { q[i] * lambda[j] + q[j] * lambda[i] };
                let radius = rod.radius.start + rod.gauss[entry.gauss].point;
                let work = section * pair;
                gradient[radius] += powers[entry.mode] * work;
                works[entry.mode] += p[radius] * work;
            }
            for ((mode, work), ModeStiffness { modulus, .. }) in Mode::ALL.into_iter().zip(works).zip(modes) {
                gradient[rod.length] += if mode.is_angular() { -work } else { work } / p[rod.length];
                let young = matches!(mode, Mode::BendY | Mode::BendZ | Mode::ExtendX);
                gradient[if young { rod.young_modulus } else { rod.shear_modulus }] += work / modulus;
                if let Some(factors) = rod.factors {
                    let factor = factors + section::factor_of(mode);
                    gradient[factor] += work / p[factor];
                }
            }
        }
    }
}
