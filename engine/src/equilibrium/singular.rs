//! Singular configurations: states in which the conditions of ties depend on one another though they do not
//! nearby, as at the dead centre of a crank or at a change point of a four-bar linkage. Reactions have no
//! bound there, and the motion may go on in more than one way.
//!
//! Between two states of one branch the gradients J of the conditions turn continuously. With Q a basis of
//! the rows of J₀ the sign of
//!
//! ```text
//! det((J₁ Q)ᵀ J₀ Q)
//! ```
//!
//! is that of the scalar product of the r-th compounds of both, r being the rank: rows that follow from
//! others do no harm, and neither do the units of rows and columns. It becomes negative where a singular
//! configuration is passed on the same branch. On the way to the other branch that crosses it there, it does
//! not: the determinant vanishes, but returns with the sign that it had. What shows both is the rate at which
//! the singular values σ of J change along the path,
//!
//! ```text
//! dσ/dλ = uᵀ (dJ/dλ) v.
//! ```
//!
//! A sub-step h has to be short of where one would vanish, seen from either of its ends: h |dσ/dλ| < σ.

use super::projection::Projection;
use super::system::System;
use crate::lie::LieGroup;
use crate::tolerances::{DEPENDENT, RANK, RANK_NEARBY};
use nalgebra::{DMatrix, DVector};

/// Dimensionless displacement to the nearby state whose rank is compared.
const NEARBY: f64 = 1e-3;
/// Singular values up to this count as zero on the way there.
const ROUGH: f64 = 1e-5;
/// Displacement over which changes of singular values are taken.
const DIFFERENCE: f64 = 1e-5;

/// The gradients of the conditions at a state, dimensionless: by the length of the longest body or one
/// radian, and by natural units of the coordinates.
#[derive(Clone, Debug, Default)]
pub(super) struct Gradients {
    rows: DMatrix<f64>,
    /// Number of independent conditions, and of vectors of the basis.
    independent: usize,
    rank: usize,
    /// J Q.
    own: DMatrix<f64>,
    /// Q, by rows.
    basis: Vec<Vec<f64>>,
}

impl Gradients {
    /// Takes those of the state evaluated last.
    pub fn take<G: LieGroup<D, P>, const D: usize, const P: usize>(&mut self, system: &System<G, D, P>) {
        self.rows = system.scaled_gradients();
        let n = self.rows.ncols();
        self.independent = system.projection.rank();
        let mut projection = Projection::default();
        let rows: Vec<Vec<f64>> = self.rows.row_iter().map(|row| row.iter().copied().collect()).collect();
        let kept = system.projection.kept().iter().map(|k| (*k, &rows[*k][..]));
        projection.factorise(kept, &vec![1.0; n], |_, _| DEPENDENT);
        self.rank = projection.rank();
        self.basis.resize(self.rank, vec![]);
        for (i, q) in self.basis.iter_mut().enumerate() {
            q.clear();
            q.resize(n, 0.0);
            q[i] = 1.0;
            projection.turn_back(q);
        }
        self.own = self.along_basis(&self.rows);
    }

    fn along_basis(&self, rows: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(rows.nrows(), self.rank, |k, i| {
            rows.row(k).iter().zip(&self.basis[i]).map(|(g, q)| g * q).sum()
        })
    }

    /// Whether no singular configuration lies between their state and the one evaluated last.
    pub fn lead_to<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        system: &System<G, D, P>,
    ) -> bool {
        if system.projection.rank() != self.independent {
            return false;
        }
        let there = self.along_basis(&system.scaled_gradients());
        let factors = (there.transpose() * &self.own).lu();
        let negative = factors.u().diagonal().iter().filter(|pivot| **pivot < 0.0).count();
        let sign = if negative % 2 == 0 { 1.0 } else { -1.0 };
        sign * factors.p().determinant::<f64>() > 0.0
    }

    /// The share of each condition in the combination whose gradient vanishes first.
    pub fn weakest(&self) -> Vec<f64> {
        let svd = self.rows.clone().svd(true, false);
        let mut order: Vec<usize> = (0..svd.singular_values.len()).collect();
        order.sort_by(|i, j| svd.singular_values[*j].total_cmp(&svd.singular_values[*i]));
        match (svd.u, order.get(self.rank.wrapping_sub(1))) {
            (Some(u), Some(last)) => u.column(*last).iter().map(|x| x * x).collect(),
            _ => vec![0.0; self.rows.nrows()],
        }
    }
}

/// Number of singular values of a matrix above a bound.
fn rank(matrix: &DMatrix<f64>, bound: f64) -> usize {
    matrix.singular_values().iter().filter(|s| **s > bound).count()
}

/// Largest relative rates at which singular values change along a path.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RelativeRates {
    /// Of the state, in natural units of its coordinates.
    pub speed: f64,
    /// Of one that falls.
    pub fall: f64,
    /// Of one that rises.
    pub rise: f64,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> System<'_, G, D, P> {
    /// The relative rates of change of the singular values of the independent conditions at the equilibrium
    /// evaluated last, for this rate of the load and velocity of the state, which is dimensionless: of their
    /// derivatives by the state, and by driven motions if these are free.
    pub(super) fn singular_rates(&mut self, rate: &[f64], velocity: &[f64], free: bool) -> RelativeRates {
        let mut found = RelativeRates::default();
        let drives = if free { self.driven_motions() } else { vec![] };
        let gradients = |system: &Self| system.extended_gradients(&drives);
        let here = gradients(self);
        let natural = &self.data.design.units.natural;
        let speeds = velocity.iter().zip(&self.unit).zip(natural).map(|((v, unit), u)| v * unit / u);
        let speed = speeds.map(|v| v * v).sum::<f64>().sqrt();
        if !(speed > 0.0 && speed.is_finite()) {
            return found;
        }
        found.speed = speed;
        let back = -DIFFERENCE / speed;
        let moved = self.state().iter().zip(velocity).zip(&self.unit).map(|((q, v), u)| q + back * v * u);
        let applied = self.data.ties.as_ref().map_or(vec![], |ties| ties.applied().to_vec());
        let load: Vec<f64> = applied.iter().zip(rate).map(|(u, r)| u + back * r).collect();
        let moved: Vec<f64> = moved.collect();
        let (model, state) = (self.model, self.state().to_vec());
        self.data.move_ties(model, &moved, &load);
        let change = (&here - gradients(self)) / -back;
        self.data.move_ties(model, &state, &applied);
        let svd = here.svd(true, true);
        let (Some(u), Some(v)) = (&svd.u, &svd.v_t) else { return found };
        let mut order: Vec<usize> = (0..svd.singular_values.len()).collect();
        order.sort_by(|i, j| svd.singular_values[*j].total_cmp(&svd.singular_values[*i]));
        for i in order.into_iter().take(self.projection.rank()) {
            let rate = (u.column(i).transpose() * &change * v.row(i).transpose())[0] / svd.singular_values[i];
            found.fall = found.fall.max(-rate);
            found.rise = found.rise.max(rate);
        }
        found
    }

    /// ∇c of each condition at the state evaluated last, by the length of the longest body or one radian,
    /// and by natural units of the coordinates.
    pub(super) fn scaled_gradients(&self) -> DMatrix<f64> {
        let Some(ties) = &self.data().ties else { return DMatrix::zeros(0, 0) };
        let natural = &self.data().design.units.natural;
        let length = self.longest_body();
        let mut rows = DMatrix::zeros(self.model().forces.ties.row_count(), natural.len());
        for (k, gradient) in ties.gradients().take(rows.nrows()).enumerate() {
            let unit = if self.model().forces.ties.row(k).1 { 1.0 } else { length };
            gradient.iter().zip(natural).enumerate().for_each(|(j, (g, u))| rows[(k, j)] = g * u / unit);
        }
        rows
    }

    /// c of each condition likewise.
    pub(super) fn scaled_conditions(&self) -> DVector<f64> {
        let Some(ties) = &self.data().ties else { return DVector::zeros(0) };
        let length = self.longest_body();
        let values = ties.values().iter().enumerate();
        let scaled = values.map(|(k, c)| if self.model().forces.ties.row(k).1 { *c } else { c / length });
        DVector::from_vec(scaled.collect())
    }

    /// Moves the state by natural units of the coordinates.
    pub(super) fn move_naturally(&mut self, step: &[f64]) {
        let moved: Vec<f64> = {
            let natural = &self.data().design.units.natural;
            self.state().iter().zip(step).zip(natural).map(|((q, s), u)| q + s * u).collect()
        };
        self.set_state(&moved);
    }

    /// Derivatives of the conditions with the driven motions, one column each, for one radian or the length
    /// of the longest body.
    fn drive_columns(&self, drives: &[(usize, f64)]) -> DMatrix<f64> {
        let ties = &self.model().forces.ties;
        let length = self.longest_body();
        let applied = self.data.ties.as_ref().map_or(self.load(), |ties| ties.applied());
        let at = self.data().state(self.model(), self.state(), applied);
        let mut columns = DMatrix::zeros(ties.row_count(), drives.len());
        for (column, (input, unit)) in drives.iter().enumerate() {
            let mut change = vec![0.0; self.load().len()];
            change[*input] = *unit;
            let mut rates = vec![0.0; ties.row_count()];
            ties.add_rates(&at, &self.data().design.forces.ties, &change, &mut rates);
            for (k, rate) in rates.into_iter().enumerate() {
                columns[(k, column)] = rate / if ties.row(k).1 { 1.0 } else { length };
            }
        }
        columns
    }

    /// The inputs of driven motions with the unit of each: one radian or the length of the longest body.
    fn driven_motions(&self) -> Vec<(usize, f64)> {
        let length = self.longest_body();
        let drives = self.model().forces.ties.drives();
        drives.map(|(input, angular)| (input, if angular { 1.0 } else { length })).collect()
    }

    /// Derivatives of the conditions by the state and by these driven motions.
    fn extended_gradients(&self, drives: &[(usize, f64)]) -> DMatrix<f64> {
        let rows = self.scaled_gradients();
        if drives.is_empty() {
            return rows;
        }
        let (n, columns) = (rows.ncols(), self.drive_columns(drives));
        let entry = |k, j| if j < n { rows[(k, j)] } else { columns[(k, j - n)] };
        DMatrix::from_fn(rows.nrows(), n + drives.len(), entry)
    }

    /// Whether the conditions are dependent at the current equilibrium but not at states nearby, to which
    /// ties may be driven. The state is kept.
    pub(super) fn is_singular_configuration(&mut self) -> bool {
        self.evaluate();
        let here = self.scaled_gradients();
        let (m, n) = (here.nrows(), here.ncols());
        let own_rank = rank(&here, RANK);
        if own_rank == m {
            return false;
        }
        let drives = self.driven_motions();
        let extended = |system: &Self| system.extended_gradients(&drives);
        let moved = |system: &mut Self, step: &DVector<f64>| {
            system.move_naturally(&step.as_slice()[..n]);
            let mut load = system.load().to_vec();
            drives.iter().zip(&step.as_slice()[n..]).for_each(|((input, unit), s)| load[*input] += s * unit);
            system.set_load(&load);
            system.evaluate();
        };
        // A motion that the conditions allow to first order, without a pattern.
        let whole = extended(self);
        let mut step = DVector::from_fn(n + drives.len(), |i, _| 1.0 + 0.5 * ((i + 1) as f64 * 1.7).sin());
        if let Ok(inverse) = whole.clone().pseudo_inverse(RANK) {
            step -= inverse * (whole * &step);
        }
        let length = step.norm();
        if !(length > RANK) {
            // Nothing moves: a structure with more conditions than it needs.
            return false;
        }
        let (state, load) = (self.state().to_vec(), self.load().to_vec());
        moved(self, &(step * (NEARBY / length)));
        if let Ok(inverse) = extended(self).pseudo_inverse(ROUGH) {
            let back = inverse * -self.scaled_conditions();
            moved(self, &back);
        }
        // Conditions that follow from others in all states do so there, too.
        let singular = rank(&self.scaled_gradients(), RANK_NEARBY) > own_rank;
        self.set_state(&state);
        self.set_load(&load);
        self.evaluate();
        self.evaluate_tangent();
        self.factorise(0.0);
        singular
    }
}
