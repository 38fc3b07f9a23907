//! Adjoints under the constraints c(q; p) = v of conjugates that are held at given values.
//!
//! With K λ + Σ ν ∇c = ∂y/∂q and ∇cᵀ λ = 0 for each, dy/dp = ∂y/∂p − λᵀ ∂g/∂p − Σ ν ∂c/∂p at fixed loads.
//! K may be the tangent H or H + ρ ∇c ∇cᵀ.

use crate::equilibrium::System;
use crate::lie::LieGroup;
use crate::model::Model;
use nalgebra::{DMatrix, DVector};

/// The constraints at one equilibrium.
#[derive(Clone, Debug, Default)]
pub(super) struct HeldConjugates {
    /// ∂c/∂p of each, of all parameters.
    by_parameters: Vec<Vec<f64>>,
    /// K⁻ᵀ ∇c of each.
    solved: Vec<Vec<f64>>,
    /// What ties do to that: the multipliers of their conditions.
    reactions: Vec<Vec<f64>>,
    /// ∇cᵀ K⁻¹ ∇c.
    flexibility: DMatrix<f64>,
    /// ν.
    multipliers: DVector<f64>,
}

impl HeldConjugates {
    /// The constraints of the equilibrium that the system is in.
    pub fn new<G: LieGroup<D, P>, const D: usize, const P: usize>(
        model: &Model<G, D, P>,
        system: &System<G, D, P>,
    ) -> Self {
        let data = system.data();
        let Some(controls) = &data.controls else { return Self::default() };
        let geometry = &data.design.geometry;
        let by_parameters = model.controls.iter().map(|control| {
            let mut out = vec![0.0; model.parameters().len()];
            control.add_parameters(model, geometry, system.state(), 1.0, &mut out);
            out
        });
        let conditions = model.forces.ties.row_count();
        let (solved, reactions): (Vec<Vec<f64>>, Vec<Vec<f64>>) = controls
            .gradients()
            .map(|gradient| {
                let (mut z, mut reactions) = (gradient.to_vec(), vec![0.0; conditions]);
                system.solve_adjoint(&mut z, &mut reactions);
                (z, reactions)
            })
            .unzip();
        let rows: Vec<&[f64]> = controls.gradients().collect();
        let flexibility = DMatrix::from_fn(rows.len(), rows.len(), |i, j| dot(rows[i], &solved[j]));
        let multipliers = DVector::zeros(rows.len());
        Self { by_parameters: by_parameters.collect(), solved, reactions, flexibility, multipliers }
    }

    /// Removes from λ = K⁻ᵀ ∂y/∂q, and from the multipliers of ties that belong to it, the part that changes
    /// the conjugates, and adds the adjoint of the loads
    /// found, each input's with a weight.
    ///
    /// With F = ∇cᵀ K⁻¹ ∇c these change by du = F⁻¹ (∇cᵀ K⁻¹ ∂g/∂p − ∂c/∂p) dp + ρ ∂c/∂p dp.
    pub fn project<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        system: &System<G, D, P>,
        weights: &[f64],
        lambda: &mut [f64],
        reactions: &mut [f64],
    ) {
        let Some(controls) = &system.data().controls else { return };
        let wanted = model.controls.iter().map(|control| weights[control.input]);
        for ((nu, gradient), weight) in self.multipliers.iter_mut().zip(controls.gradients()).zip(wanted) {
            *nu = dot(gradient, lambda) + weight;
        }
        if !self.flexibility.clone().lu().solve_mut(&mut self.multipliers) {
            self.multipliers.fill(f64::NAN);
        }
        for (z, nu) in self.solved.iter().zip(self.multipliers.iter()) {
            lambda.iter_mut().zip(z).for_each(|(l, z)| *l -= nu * z);
        }
        for (own, nu) in self.reactions.iter().zip(self.multipliers.iter()) {
            reactions.iter_mut().zip(own).for_each(|(r, own)| *r -= nu * own);
        }
        let stiffness = model.controls.iter().zip(controls.stiffness());
        for (nu, (control, stiffness)) in self.multipliers.iter_mut().zip(stiffness) {
            *nu -= stiffness * weights[control.input];
        }
    }

    /// Sets the derivatives by the conjugates of controlled inputs, of the adjoint projected last.
    pub fn set_by_loads<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        model: &Model<G, D, P>,
        by_loads: &mut [f64],
    ) {
        for (control, nu) in model.controls.iter().zip(self.multipliers.iter()) {
            by_loads[control.input] = *nu;
        }
    }

    /// Adds Σ ν ∂c/∂p, of the adjoint projected last.
    pub fn add_parameters(&self, gradient: &mut [f64]) {
        for (by_parameters, nu) in self.by_parameters.iter().zip(self.multipliers.iter()) {
            gradient.iter_mut().zip(by_parameters).for_each(|(g, c)| *g += nu * c);
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
