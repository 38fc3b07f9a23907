//! The factorised tangent of a state, with or without a potential behind it.

use super::general::GeneralFactor;
use crate::lie::LieGroup;
use crate::linalg::Cholesky;
use crate::model::Model;

/// `S A S + λ` in factors.
#[derive(Clone, Debug, Default)]
pub(super) struct Factor {
    /// Of a symmetric tangent.
    pub cholesky: Cholesky,
    /// For loads without a potential, whose tangent is not symmetric.
    general: Option<GeneralFactor>,
}

impl Factor {
    pub fn new<G: LieGroup<D, P>, const D: usize, const P: usize>(model: &Model<G, D, P>) -> Self {
        let n = model.dof();
        let general = (!model.is_conservative()).then(|| GeneralFactor::new(n));
        Self { cholesky: Cholesky::new(n), general }
    }

    /// Whether the tangent is the second derivative of a potential.
    pub fn is_symmetric(&self) -> bool {
        self.general.is_none()
    }

    /// Factorises `S A S + shift`; `false` when it is not positive definite or, without a potential,
    /// when the determinant of `S A S` is not positive.
    pub fn factorise(&mut self, a: &[f64], scale: &[f64], shift: f64) -> bool {
        match &mut self.general {
            None => self.cholesky.factorise(a, scale, shift),
            Some(general) => general.factorise(a, scale),
        }
    }

    /// Solves in place.
    pub fn solve(&self, b: &mut [f64]) {
        match &self.general {
            None => self.cholesky.solve(b),
            Some(general) => general.solve(b),
        }
    }

    /// Solves with the transposed matrix, in place.
    pub fn solve_transposed(&self, b: &mut [f64]) {
        match &self.general {
            None => self.cholesky.solve(b),
            Some(general) => general.solve_transposed(b),
        }
    }

    /// Ratio of the smallest to the largest pivot.
    pub fn pivot_ratio(&self) -> f64 {
        match &self.general {
            None => self.cholesky.pivot_ratio(),
            Some(general) => general.pivot_ratio(),
        }
    }
}
