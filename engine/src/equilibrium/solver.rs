//! The solver of one thread: workspace, scaling and the evaluation of a state.

use super::factor::Factor;
use super::prediction::Prediction;
use super::status::Status;
use crate::Data;
use crate::lie::LieGroup;
use crate::model::Model;

/// Tolerances and limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Largest dimensionless residual of an equilibrium.
    pub tolerance: f64,
    /// Iterations allowed for one load step, all its sub-steps together.
    pub max_iterations: usize,
    /// Smallest sub-step along the load, as a fraction of the largest load of the path.
    pub min_step: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { tolerance: 1e-9, max_iterations: 20_000, min_step: 1e-3 }
    }
}

/// Finds and follows equilibria; owns all memory it needs.
#[derive(Clone, Debug)]
pub struct Solver<G, const D: usize, const P: usize> {
    pub(super) data: Data<G, D, P>,
    pub(super) options: Options,
    /// The tangent factorised last.
    pub(super) factor: Factor<D>,
    /// The current state and load.
    pub(super) q: Vec<f64>,
    pub(super) load: Vec<f64>,
    /// From dimensionless to actual coordinates.
    pub(super) unit: Vec<f64>,
    /// Dimensionless residual at the current state.
    pub(super) residual: Vec<f64>,
    /// A dimensionless step.
    pub(super) step: Vec<f64>,
    pub(super) trial: Vec<f64>,
    pub(super) trial_residual: Vec<f64>,
    /// Scratch of the linear solves.
    pub(super) work: Vec<f64>,
    /// dq/dλ (dimensionless) at both ends of a sub-step.
    pub(super) velocity: [Vec<f64>; 2],
    pub(super) prediction: Prediction<D, P>,
    pub(super) start: Vec<f64>,
    pub(super) start_load: Vec<f64>,
    /// Change of the load over the current segment.
    pub(super) rate: Vec<f64>,
    pub(super) iterations: usize,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Solver<G, D, P> {
    /// A solver for `model`, holding the model's own parameters.
    pub fn new(model: &Model<G, D, P>, options: Options) -> Self {
        let (n, inputs) = (model.dof(), model.inputs().len());
        let zeros = || vec![0.0; n];
        let mut solver = Self {
            data: Data::new(model),
            options,
            factor: Factor::new(model),
            q: zeros(),
            load: vec![0.0; inputs],
            unit: zeros(),
            residual: zeros(),
            step: zeros(),
            trial: zeros(),
            trial_residual: zeros(),
            work: zeros(),
            velocity: [zeros(), zeros()],
            prediction: Prediction::new(model),
            start: zeros(),
            start_load: vec![0.0; inputs],
            rate: vec![0.0; inputs],
            iterations: 0,
        };
        solver.set_units();
        solver
    }

    /// Takes over a vector of parameters; `false` when they are not admissible.
    pub fn set_parameters(&mut self, model: &Model<G, D, P>, parameters: &[f64]) -> bool {
        if !model.is_admissible(parameters) {
            return false;
        }
        self.data.set_parameters(model, parameters);
        self.set_units();
        true
    }

    fn set_units(&mut self) {
        let root = self.data.design.reference_stiffness.sqrt();
        for (unit, scale) in self.unit.iter_mut().zip(&self.data.design.scale) {
            *unit = scale * root;
        }
    }

    /// The workspace, at the state evaluated last.
    pub fn data(&self) -> &Data<G, D, P> {
        &self.data
    }

    /// The current load.
    pub fn load(&self) -> &[f64] {
        &self.load
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

    /// The current state.
    pub fn state(&self) -> &[f64] {
        &self.q
    }

    /// Evaluates Π and the residual at the current state; returns the largest dimensionless
    /// residual, NaN or infinite when the state is out of reach.
    pub(super) fn evaluate(&mut self, model: &Model<G, D, P>) -> f64 {
        self.data.evaluate_residual(model, &self.q, &self.load);
        let unit_energy = self.data.design.reference_stiffness;
        let mut largest = 0.0f64;
        for ((r, g), unit) in self.residual.iter_mut().zip(self.data.residual()).zip(&self.unit) {
            *r = g * unit / unit_energy;
            // `max` would drop a NaN.
            largest = if r.abs() <= largest { largest } else { r.abs() };
        }
        if self.data.energy().is_finite() { largest } else { f64::NAN }
    }

    /// Evaluates the tangent at the current state, after its residual: an iteration.
    pub(super) fn evaluate_tangent(&mut self, model: &Model<G, D, P>) {
        self.data.evaluate_near_tangent(model, &self.q, &self.load);
        self.iterations += 1;
    }

    /// Factorises the dimensionless tangent plus `shift`; `false` when it is not positive definite or,
    /// without a potential, when its determinant is not positive.
    pub(super) fn factorise(&mut self, shift: f64) -> bool {
        self.factor.factorise(&self.data, shift)
    }

    /// p = −H⁻¹ r, with the factor at hand.
    pub(super) fn newton_step(&mut self) {
        self.set_step_against_residual();
        self.factor.solve(&mut self.step);
    }

    pub(super) fn set_step_against_residual(&mut self) {
        self.step.iter_mut().zip(&self.residual).for_each(|(s, r)| *s = -r);
    }

    /// The nearest equilibrium below the current state; `keep` is that of
    /// [`Goal`](super::branch::Goal).
    pub(super) fn settle(&mut self, model: &Model<G, D, P>, radius: f64, keep: f64) -> Status {
        if self.factor.is_symmetric() { self.descend(model, radius, keep) } else { self.relax(model) }
    }

    /// Adds the dimensionless `step` to `q`.
    pub(super) fn advance(q: &mut [f64], step: &[f64], unit: &[f64]) {
        for ((q, s), u) in q.iter_mut().zip(step).zip(unit) {
            *q += s * u;
        }
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

pub(super) fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |m, x| if x.abs() <= m { m } else { x.abs() })
}
