//! Ties at one state: the residual on the motions that they allow, and the reactions.

use super::general::lowest;
use super::projection::ProjectedMatrix;
use super::system::System;
use super::vector::max_norm;
use crate::lie::LieGroup;
use crate::tolerances::{DEPENDENT, INDEPENDENT, REDUNDANT_GAP};
use crate::tree::Shape;

/// Stiffness of the penalties of ties, in units of that of the body itself.
const PENALTY: f64 = 1e3;
/// Dimensionless motion below which ties are closed.
const CLOSED: f64 = 1e-9;
/// Largest number of steps that close them again, and the part that each leaves of the motion.
const CLOSING_STEPS: usize = 8;
const CLOSING_PROGRESS: f64 = 0.5;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> System<'_, G, D, P> {
    /// Whether the model has ties.
    pub(super) fn has_ties(&self) -> bool {
        self.data().ties.is_some()
    }

    /// Whether the equations are those on the motions that ties allow.
    pub(super) fn is_projected(&self) -> bool {
        self.has_ties() && !self.penalised
    }

    /// Replaces the dimensionless gradient of Π by the residual under the conditions of ties, and finds
    /// their reactions.
    pub(super) fn project_residual(&mut self) {
        let (model, energy) = (self.model(), self.unit_energy());
        let places = model.forces.ties.reactions();
        let length = self.longest_body();
        let System { data, projection, residual, free_residual, unit, acting, independent, .. } = self;
        data.update_ties(model);
        let natural = &data.design.units.natural;
        let Some(ties) = &mut data.ties else { return };
        let acts = |k: usize| model.forces.ties.row(k).0 < *acting;
        let was = |k: usize| independent.is_empty() || independent.contains(&k);
        let least = |k: usize, gradient: &[f64]| {
            let zero = DEPENDENT * if model.forces.ties.row(k).1 { 1.0 } else { length };
            let vanishes = gradient.iter().zip(natural).all(|(g, u)| (g * u).abs() <= zero);
            match was(k) {
                _ if vanishes => f64::INFINITY,
                true => DEPENDENT,
                false => INDEPENDENT,
            }
        };
        let rows = || ties.gradients().enumerate().filter(|(k, _)| acts(*k));
        let first = rows().filter(|(k, _)| was(*k));
        projection.factorise(first.chain(rows().filter(|(k, _)| !was(*k))), unit, least);
        let rank = projection.rank();
        projection.turn(residual);
        let mut reactions = residual[..rank].to_vec();
        projection.solve(&mut reactions);
        let mut opening: Vec<f64> = projection.kept().iter().map(|k| ties.values()[*k]).collect();
        projection.solve_transposed(&mut opening);
        free_residual.clear();
        free_residual.extend_from_slice(residual);
        free_residual[..rank].fill(0.0);
        residual[..rank].copy_from_slice(&opening);
        projection.turn_back(residual);
        projection.turn_back(free_residual);
        let values = ties.values().to_vec();
        let found = ties.numbers(places);
        let before = found.to_vec();
        (0..found.len()).filter(|k| !projection.kept().contains(k)).for_each(|k| found[k] = 0.0);
        for (k, change) in projection.kept().iter().zip(reactions) {
            found[*k] += change * energy;
        }
        let changes = found.iter().zip(before).zip(values);
        self.reaction_energy = -changes.map(|((after, before), c)| (after - before) * c).sum::<f64>();
    }

    /// Turns the derivative of the gradient of Π along a change of load into that of the residual.
    pub(super) fn project_load_gradient(&self, rate: &[f64], out: &mut [f64]) {
        let data = self.data();
        let ties = &self.model().forces.ties;
        let mut rates = vec![0.0; ties.row_count()];
        let at = data.state(self.model(), self.state(), self.load());
        ties.add_rates(&at, &data.design.forces.ties, rate, &mut rates);
        let projection = &self.projection;
        let mut opening: Vec<f64> = projection.kept().iter().map(|k| rates[*k]).collect();
        projection.solve_transposed(&mut opening);
        projection.turn(out);
        out[..opening.len()].copy_from_slice(&opening);
        projection.turn_back(out);
    }

    /// Derivative of the gradient of Π along a change of load, dimensionless, without what ties make of it.
    pub(super) fn force_gradient(&self, rate: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.data().add_load_gradient(self.model(), self.state(), rate, out);
        let energy = self.unit_energy();
        out.iter_mut().zip(self.units()).for_each(|(v, unit)| *v *= unit / energy);
    }

    /// The dimensionless gradient of the energy at the state evaluated last, without what ties hold.
    pub(super) fn forces(&self) -> &[f64] {
        if self.is_projected() { &self.free_residual } else { self.residual() }
    }

    /// Removes from a vector what ties do not allow.
    pub(super) fn keep_free(&self, b: &mut [f64]) {
        if self.is_projected() {
            self.projection.turn(b);
            b[..self.projection.rank()].fill(0.0);
            self.projection.turn_back(b);
        }
    }

    /// Π [J], with the reactions found last times the openings of their ties subtracted.
    pub(super) fn energy(&self) -> f64 {
        self.data().energy() + if self.is_projected() { self.reaction_energy } else { 0.0 }
    }

    /// The matrix of Newton's method under ties, dimensionless.
    pub(super) fn projected_matrix(&self) -> Option<Vec<f64>> {
        self.factor.projected().map(ProjectedMatrix::matrix)
    }

    /// The lowest real part of the eigenvalues of the current tangent, and the direction of the lowest real
    /// one if that is negative.
    pub(super) fn lowest_eigenvalue(&self) -> Option<(f64, Option<Vec<f64>>)> {
        let Some(projected) = self.factor.projected() else {
            return lowest(self.data().tangent(), &self.data().design.units.scale);
        };
        // Beside these eigenvalues, the whole matrix has ones alone.
        let (low, direction) = lowest(&projected.free, &projected.ones)?;
        let turned = direction.map(|mut direction| {
            projected.turn_back(&mut direction);
            direction
        });
        Some((low, turned))
    }

    /// Whether the motion that closes the ties at the state evaluated last is below the tolerance.
    pub(super) fn is_closed(&self, tolerance: f64) -> bool {
        let moved = self.residual().iter().zip(&self.free_residual);
        moved.map(|(r, free)| (r - free).abs()).fold(0.0, f64::max) <= tolerance
    }

    /// The largest force on coordinates that ties couple to this one, in its unit.
    pub(super) fn shared_unit(&self, coordinate: usize) -> f64 {
        let Some(ties) = &self.data().ties else { return 0.0 };
        if ties.gradients().all(|gradient| gradient[coordinate] == 0.0) {
            return 0.0;
        }
        let units = &self.data().design.units;
        let coupled = |j: &usize| ties.gradients().any(|gradient| gradient[*j] != 0.0);
        let energy = |j: usize| self.magnitudes.coordinates[j].max(units.elastic_force(j)) * self.units()[j];
        // Where nothing acts on what the ties hold, forces there are rounding of what acts elsewhere.
        let of = &self.model().components.of_coordinate;
        let largest =
            |of: &dyn Fn(&usize) -> bool| (0..self.units().len()).filter(of).map(energy).fold(0.0, f64::max);
        let beside = largest(&|j| of[*j] == of[coordinate]);
        let largest = largest(&coupled).max(f64::EPSILON * beside);
        largest / self.units()[coordinate]
    }

    /// Whether the conditions that depend on others hold at the state evaluated last.
    pub(super) fn redundant_conditions_hold(&self) -> bool {
        self.projection.redundant().iter().all(|k| self.relative_gap(*k) <= REDUNDANT_GAP)
    }

    /// Closes the ties from the state evaluated last by the shortest motions, whose residual is `size`; returns that of
    /// the state found, which is not a number if they do not close.
    pub(super) fn close(&mut self, mut size: f64) -> f64 {
        let mut last = f64::INFINITY;
        let mut step = vec![0.0; self.state().len()];
        for _ in 0..CLOSING_STEPS {
            if self.is_closed(CLOSED) {
                return if self.redundant_conditions_hold() { size } else { f64::NAN };
            }
            let opening = self.residual().iter().zip(&self.free_residual);
            step.iter_mut().zip(opening).for_each(|(s, (r, free))| *s = free - r);
            let length = max_norm(&step);
            if !(length < CLOSING_PROGRESS * last) {
                break;
            }
            last = length;
            self.advance(&step);
            size = self.evaluate();
        }
        f64::NAN
    }

    /// The largest violation of a condition at the state evaluated last: relative to the length of the longest
    /// body, or in radians.
    pub(super) fn largest_gap(&self) -> f64 {
        let ties = &self.model().forces.ties;
        let acting = (0..ties.row_count()).filter(|k| ties.row(*k).0 < self.acting);
        acting.map(|k| self.relative_gap(k)).fold(0.0, f64::max)
    }

    fn relative_gap(&self, condition: usize) -> f64 {
        let Some(ties) = &self.data().ties else { return 0.0 };
        let gap = ties.values()[condition].abs();
        if self.model().forces.ties.row(condition).1 { gap } else { gap / self.longest_body() }
    }

    /// Length of the longest body.
    pub(super) fn longest_body(&self) -> f64 {
        let parameters = &self.data().design.geometry.parameters;
        let lengths = self.model().bodies.iter().map(|body| match &body.shape {
            Shape::Rod(rod) => parameters[self.model().rods[*rod].length],
            Shape::Link(link) => parameters[link.length],
        });
        lengths.fold(0.0, f64::max)
    }

    /// Lets ties act by penalties from now on, `rise` times the usual ones, with the reactions found last.
    pub(super) fn penalise(&mut self, rise: f64) {
        let energy = self.unit_energy();
        let places = self.model().forces.ties.penalties();
        let length = self.longest_body();
        let System { data, unit, .. } = self;
        let Some(ties) = &mut data.ties else { return };
        let elastic = &data.design.units.elastic;
        let size = |gradient: &[f64]| {
            let squares = || gradient.iter().zip(&*unit).map(|(g, u)| (g * u).powi(2));
            // What coordinates without elasticity move says nothing about stiffness.
            let held: f64 = squares().zip(elastic).filter(|(_, elastic)| **elastic).map(|(s, _)| s).sum();
            if held > 0.0 { held } else { squares().sum() }
        };
        // What nothing moves has a gradient of rounding, and no penalty.
        let model = self.model;
        let natural = &data.design.units.natural;
        let moves = |k: usize, gradient: &[f64]| {
            let zero = DEPENDENT * if model.forces.ties.row(k).1 { 1.0 } else { length };
            gradient.iter().zip(natural).any(|(g, u)| (g * u).abs() > zero)
        };
        let sizes = ties.gradients().enumerate();
        let sizes: Vec<f64> = sizes.map(|(k, g)| if moves(k, g) { size(g) } else { 0.0 }).collect();
        for (k, (penalty, size)) in ties.numbers(places).iter_mut().zip(sizes).enumerate() {
            let acts = self.model.forces.ties.row(k).0 < self.acting;
            *penalty = if acts && size > 0.0 { rise * PENALTY * energy / size } else { 0.0 };
        }
        self.penalised = true;
    }

    /// Lets ties act exactly again.
    pub(super) fn end_penalties(&mut self) {
        let places = self.model().forces.ties.penalties();
        if let Some(ties) = &mut self.data_mut().ties {
            ties.numbers(places).fill(0.0);
        }
        self.penalised = false;
    }

    /// Opens some ties as far as they are in the current state, and closes the others.
    pub(super) fn set_openings(&mut self, open: std::ops::Range<usize>) {
        let model = self.model();
        let ties = &model.forces.ties;
        self.evaluate();
        let mut design = self.data().design.forces.ties.clone();
        ties.close(&mut design);
        let at = self.data().state(model, self.state(), self.load());
        ties.open(&at, &mut design, open);
        self.data_mut().design.forces.ties = design;
    }

    /// Forgets all reactions.
    pub(super) fn forget_reactions(&mut self) {
        let places = self.model().forces.ties.reactions();
        if let Some(ties) = &mut self.data_mut().ties {
            ties.numbers(places).fill(0.0);
        }
    }

    /// Solves for the adjoint of an output in actual coordinates, in place: its derivatives by the state
    /// and by the reactions of ties become α and ν with
    ///
    /// ```text
    /// dy/dp = ∂y/∂p − αᵀ ∂g/∂p − νᵀ ∂c/∂p.
    /// ```
    pub(crate) fn solve_adjoint(&self, by_state: &mut [f64], by_reactions: &mut [f64]) {
        let (scale, root) = (&self.data().design.units.scale, self.unit_energy().sqrt());
        by_state.iter_mut().zip(scale).for_each(|(b, s)| *b *= s);
        by_reactions.iter_mut().for_each(|d| *d *= root);
        self.factor.solve_adjoint(by_state, by_reactions);
        by_state.iter_mut().zip(scale).for_each(|(b, s)| *b *= s);
        by_reactions.iter_mut().for_each(|d| *d *= root);
    }

    /// From now on, prefers conditions that are independent at the state evaluated last.
    pub(super) fn keep_independent(&mut self) {
        self.independent.clear();
        self.independent.extend_from_slice(self.projection.kept());
    }

    /// The share of each tie in what becomes dependent in a singular configuration.
    pub(crate) fn singular_shares(&self, out: &mut [f64]) {
        out.fill(0.0);
        for (k, share) in self.weakest().iter().enumerate() {
            out[self.model().forces.ties.row(k).0] += share;
        }
    }

    /// Number of redundant conditions of each tie at the state evaluated last.
    pub(crate) fn count_redundant(&self, out: &mut [f64]) {
        out.fill(0.0);
        for k in self.projection.redundant() {
            out[self.model().forces.ties.row(*k).0] += 1.0;
        }
    }
}
