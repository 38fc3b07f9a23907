//! The equations of equilibrium at one state of one design: residual, tangent and factor, in
//! dimensionless coordinates.

use super::factor::Factor;
use super::vector::dot;
use crate::Data;
use crate::lie::LieGroup;
use crate::model::Model;

/// A model with a design, a load and a state, and the equations of equilibrium there.
///
/// Coordinates are made dimensionless by their elastic stiffness: one unit of any of them stores the
/// elastic energy of one radian of the softest angular coordinate, which is the unit of energy. Steps,
/// residuals and velocities are in these units.
#[derive(Clone, Debug)]
pub struct System<'m, G, const D: usize, const P: usize> {
    model: &'m Model<G, D, P>,
    data: Data<G, D, P>,
    /// The tangent factorised last.
    factor: Factor<D>,
    q: Vec<f64>,
    load: Vec<f64>,
    /// From dimensionless to actual coordinates.
    unit: Vec<f64>,
    /// Dimensionless residual at the state evaluated last.
    residual: Vec<f64>,
    iterations: usize,
}

impl<'m, G: LieGroup<D, P>, const D: usize, const P: usize> System<'m, G, D, P> {
    pub(super) fn new(model: &'m Model<G, D, P>) -> Self {
        let n = model.dof();
        let mut system = Self {
            model,
            data: Data::new(model),
            factor: Factor::new(model),
            q: vec![0.0; n],
            load: vec![0.0; model.inputs().len()],
            unit: vec![0.0; n],
            residual: vec![0.0; n],
            iterations: 0,
        };
        system.set_units();
        system
    }

    pub(super) fn set_parameters(&mut self, parameters: &[f64]) {
        self.data.set_parameters(self.model, parameters);
        self.set_units();
    }

    fn set_units(&mut self) {
        let root = self.data.design.reference_stiffness.sqrt();
        for (unit, scale) in self.unit.iter_mut().zip(&self.data.design.scale) {
            *unit = scale * root;
        }
    }

    /// The model.
    pub fn model(&self) -> &'m Model<G, D, P> {
        self.model
    }

    /// The workspace, at the state evaluated last.
    pub fn data(&self) -> &Data<G, D, P> {
        &self.data
    }

    /// The current load.
    pub fn load(&self) -> &[f64] {
        &self.load
    }

    /// The current state.
    pub fn state(&self) -> &[f64] {
        &self.q
    }

    /// Tangents evaluated so far.
    pub(super) fn iterations(&self) -> usize {
        self.iterations
    }

    /// Dimensionless residual at the state evaluated last.
    pub(super) fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// What one unit of each dimensionless coordinate is.
    pub(super) fn units(&self) -> &[f64] {
        &self.unit
    }

    /// Energy in units of the reference energy.
    pub(super) fn unit_energy(&self) -> f64 {
        self.data.design.reference_stiffness
    }

    /// Whether the forces derive from a potential.
    pub(super) fn is_conservative(&self) -> bool {
        self.factor.is_symmetric()
    }

    pub(super) fn set_state(&mut self, q: &[f64]) {
        self.q.copy_from_slice(q);
    }

    /// Goes back to a state whose residual is known.
    pub(super) fn restore(&mut self, q: &[f64], residual: &[f64]) {
        self.q.copy_from_slice(q);
        self.residual.copy_from_slice(residual);
    }

    pub(super) fn set_load(&mut self, load: &[f64]) {
        self.load.copy_from_slice(load);
    }

    /// Sets the load `start + fraction · rate`.
    pub(super) fn set_load_between(&mut self, start: &[f64], rate: &[f64], fraction: f64) {
        for ((u, s), r) in self.load.iter_mut().zip(start).zip(rate) {
            *u = s + fraction * r;
        }
    }

    /// Moves the state by a dimensionless step.
    pub(super) fn advance(&mut self, step: &[f64]) {
        for ((q, s), u) in self.q.iter_mut().zip(step).zip(&self.unit) {
            *q += s * u;
        }
    }

    /// Moves to `start` plus a fraction of a dimensionless step.
    pub(super) fn advance_from(&mut self, start: &[f64], step: &[f64], fraction: f64) {
        for ((q, t), (s, u)) in self.q.iter_mut().zip(start).zip(step.iter().zip(&self.unit)) {
            *q = t + fraction * s * u;
        }
    }

    /// The dimensionless displacement from the state `start`.
    pub(super) fn displacement(&self, start: &[f64], out: &mut [f64]) {
        for (d, ((q, s), u)) in out.iter_mut().zip(self.q.iter().zip(start).zip(&self.unit)) {
            *d = (q - s) / u;
        }
    }

    /// Evaluates Π and the residual at the current state; returns the largest dimensionless
    /// residual, NaN or infinite when the state is out of reach.
    pub(super) fn evaluate(&mut self) -> f64 {
        self.data.evaluate_residual(self.model, &self.q, &self.load);
        let unit_energy = self.unit_energy();
        let mut largest = 0.0f64;
        for ((r, g), unit) in self.residual.iter_mut().zip(self.data.residual()).zip(&self.unit) {
            *r = g * unit / unit_energy;
            // `max` would drop a NaN.
            largest = if r.abs() <= largest { largest } else { r.abs() };
        }
        if self.data.energy().is_finite() { largest } else { f64::NAN }
    }

    /// Evaluates the tangent at the current state, after its residual: an iteration.
    pub(super) fn evaluate_tangent(&mut self) {
        self.data.evaluate_near_tangent(self.model, &self.q, &self.load);
        self.iterations += 1;
    }

    /// Factorises the dimensionless tangent plus `shift`; `false` when it is not positive definite or,
    /// without a potential, when its determinant is not positive.
    pub(super) fn factorise(&mut self, shift: f64) -> bool {
        self.factor.factorise(&self.data, shift)
    }

    /// Solves in place with the factor at hand.
    pub(super) fn solve(&self, b: &mut [f64]) {
        self.factor.solve(b);
    }

    /// Solves in place with a triangular factor, as [`Factor::solve_lower`].
    pub(super) fn solve_lower(&self, b: &mut [f64]) {
        self.factor.solve_lower(b);
    }

    /// Exchanges the factor at hand for another one of this model.
    pub(super) fn swap_factor(&mut self, other: &mut Factor<D>) {
        std::mem::swap(&mut self.factor, other);
    }

    /// p = −r.
    pub(super) fn negative_residual(&self, step: &mut [f64]) {
        step.iter_mut().zip(&self.residual).for_each(|(s, r)| *s = -r);
    }

    /// p = −H⁻¹ r, with the factor at hand.
    pub(super) fn newton_step(&self, step: &mut [f64]) {
        self.negative_residual(step);
        self.factor.solve(step);
    }

    /// The derivative of the dimensionless residual along the load rate `rate`, at the equilibrium evaluated
    /// last with its tangent.
    pub(super) fn load_column(&self, rate: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.data.add_load_gradient(self.model, &self.q, rate, out);
        let unit_energy = self.unit_energy();
        for (v, unit) in out.iter_mut().zip(&self.unit) {
            *v = *v * unit / unit_energy;
        }
    }

    /// dq/dλ of the equilibrium for the load rate `rate`, dimensionless.
    ///
    /// Needs the factor of the tangent at the equilibrium evaluated last.
    pub(super) fn velocity(&self, rate: &[f64], out: &mut [f64]) {
        self.load_column(rate, out);
        out.iter_mut().for_each(|v| *v = -*v);
        self.factor.solve(out);
    }

    /// pᵀHp in units of the reference energy, by a product with the tangent; `work` is scratch.
    pub(super) fn curvature_along(&self, step: &[f64], work: &mut [f64]) -> f64 {
        let n = step.len();
        let tangent = self.data.tangent();
        for (w, (s, u)) in work.iter_mut().zip(step.iter().zip(&self.unit)) {
            *w = s * u;
        }
        let mut quadratic = 0.0;
        for i in 0..n {
            quadratic += dot(&tangent[i * n..(i + 1) * n], work) * work[i];
        }
        quadratic / self.unit_energy()
    }

    /// Smallest diagonal entry of the dimensionless tangent, and a bound to its eigenvalues: the largest
    /// absolute row sum, or for a chain Frobenius' norm.
    pub(super) fn tangent_bounds(&self) -> (f64, f64) {
        let n = self.q.len();
        let (tangent, scale) = (self.data.tangent(), &self.data.design.scale);
        let diagonal = (0..n).map(|i| tangent[i * n + i] * scale[i] * scale[i]);
        let lowest = diagonal.fold(f64::INFINITY, f64::min);
        let row_sum = |i: usize| {
            let row = &tangent[i * n..(i + 1) * n];
            row.iter().zip(scale).map(|(h, s)| (h * s).abs()).sum::<f64>() * scale[i]
        };
        let norm = self.data.assembly.chain_norm(self.model, scale);
        (lowest, norm.unwrap_or_else(|| (0..n).map(row_sum).fold(0.0, f64::max)))
    }

    /// Completes a tangent of which only what its factorisation needs was evaluated.
    pub(super) fn complete_tangent(&mut self) {
        self.data.complete_tangent(self.model);
    }

    /// Makes the velocities of all frames available.
    pub(super) fn complete_columns(&mut self) {
        self.data.complete_columns(self.model);
    }

    /// Solves Hᵀ x = b in place, in actual coordinates, with the factor of the equilibrium at hand.
    pub(crate) fn solve_transposed(&self, b: &mut [f64]) {
        let scale = &self.data.design.scale;
        b.iter_mut().zip(scale).for_each(|(b, s)| *b *= s);
        self.factor.solve_transposed(b);
        b.iter_mut().zip(scale).for_each(|(b, s)| *b *= s);
    }

    /// Ratio of the smallest to the largest pivot of the factor at hand.
    pub(crate) fn pivot_ratio(&self) -> f64 {
        self.factor.pivot_ratio()
    }
}
