//! Adjoints under the conditions of ties.
//!
//! With Hᵀ α + Σ ν ∇c = ∂y/∂q and −∇cᵀ α = ∂y/∂λ for each condition, λ being its reaction,
//! dy/dp = ∂y/∂p − αᵀ ∂g/∂p − Σ ν ∂c/∂p.

use super::design_velocity::DesignVelocity;
use crate::data::Data;
use crate::equilibrium::System;
use crate::forces::tie::ReferenceRates;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::Model;

/// What the derivatives of all outputs have in common.
#[derive(Clone, Debug)]
pub(super) struct TieSensitivities<const D: usize, const P: usize> {
    /// Design velocities in the reference state.
    velocities: Vec<DesignVelocity<D, P>>,
    /// What the reference state gives, by each of these.
    rates: Vec<ReferenceRates<P>>,
    /// ∂c/∂u of all conditions, by each input.
    by_load: Vec<Vec<f64>>,
}

impl<const D: usize, const P: usize> TieSensitivities<D, P> {
    pub fn new<G: LieGroup<D, P>>(model: &Model<G, D, P>, wanted: &[usize]) -> Self {
        let velocities = if model.tie_count() > 0 { DesignVelocity::all(model, wanted) } else { vec![] };
        Self { velocities, rates: vec![], by_load: vec![] }
    }

    /// Prepares for the equilibrium that the system is in.
    pub fn visit<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>, system: &System<G, D, P>) {
        if model.tie_count() == 0 {
            return;
        }
        let data = system.data();
        let zero = vec![0.0; model.dof()];
        let mut reference = Data::new(model);
        reference.set_parameters(model, &data.design.geometry.parameters);
        reference.evaluate_residual(model, &zero, &vec![0.0; model.inputs().len()]);
        self.rates.clear();
        for velocity in &mut self.velocities {
            velocity.update(model, &reference);
            let at = reference.state(model, &zero, &[]);
            self.rates.push(model.forces.ties.reference_rates(&at, &velocity.velocities()));
        }
        let at = data.state(model, system.state(), system.load());
        let rates = |input: usize| {
            let (mut change, mut out) =
                (vec![0.0; model.inputs().len()], vec![0.0; model.forces.ties.row_count()]);
            change[input] = 1.0;
            model.forces.ties.add_rates(&at, &data.design.forces.ties, &change, &mut out);
            out
        };
        self.by_load = (0..model.inputs().len()).map(rates).collect();
    }

    /// Adds Σ ν ∂c/∂p, and to αᵀ ∂g/∂p what is due to the reference state; the virtual motion α is given by
    /// the twists of frames.
    pub fn add_parameters<G: LieGroup<D, P>>(
        &self,
        model: &Model<G, D, P>,
        system: &System<G, D, P>,
        (twists, multipliers): (&[Vector<D>], &[f64]),
        velocities: &[DesignVelocity<D, P>],
        gradient: &mut [f64],
    ) {
        let data = system.data();
        let at = data.state(model, system.state(), system.load());
        let design = &data.design.forces.ties;
        for (velocity, rates) in velocities.iter().zip(&self.rates) {
            let moving = (&velocity.velocities(), rates);
            gradient[velocity.parameter] +=
                model.forces.ties.parameter_work(&at, design, twists, multipliers, moving);
        }
    }

    /// Subtracts Σ ν ∂c/∂u from the derivatives by the loads.
    pub fn add_loads(&self, multipliers: &[f64], by_loads: &mut [f64]) {
        for (out, rates) in by_loads.iter_mut().zip(&self.by_load) {
            *out -= rates.iter().zip(multipliers).map(|(c, nu)| c * nu).sum::<f64>();
        }
    }
}
