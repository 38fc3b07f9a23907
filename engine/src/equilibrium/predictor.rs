//! The predictor: a first-order extrapolation of the branch from an equilibrium, piecewise straight between
//! changes of contact.
//!
//! The curvature between changes is taken from the last sub-step.
//!
//! A contact that closes adds k g gᵀ to the tangent, g being the gradient of its overlap, and one that
//! opens subtracts it; by the Sherman–Morrison formula the velocity changes by a multiple of H⁻¹ g.
//! Where the updated tangent is not positive definite, the branch ends.

use super::contact_changes::ContactChanges;
use super::factor::Factor;
use super::options::PredictorOptions;
use super::system::System;
use super::vector::{dot, norm};
use crate::lie::LieGroup;
use crate::model::Model;

/// A rank-one change of the inverse tangent, H⁻¹ − factor · w (gᵀ H⁻¹).
#[derive(Clone, Debug)]
struct Update {
    gradient: Vec<f64>,
    /// w = H⁻¹ g, with the changes before it.
    solved: Vec<f64>,
    factor: f64,
}

/// A straight segment of the prediction.
#[derive(Clone, Debug)]
struct Piece {
    /// Its end.
    end: f64,
    velocity: Vec<f64>,
}

/// The pieces ahead of an equilibrium. Displacements, velocities and curvatures are dimensionless.
#[derive(Clone, Debug)]
pub(super) struct Predictor<const D: usize, const P: usize> {
    options: PredictorOptions,
    /// The tangent where the pieces begin.
    factor: Factor<D>,
    pieces: Vec<Piece>,
    count: usize,
    /// d²q/dλ² on each piece; zero where it is not known.
    curvature: Vec<f64>,
    branch_end: f64,
    updates: Vec<Update>,
    contacts: ContactChanges<D, P>,
    work: Vec<f64>,
}

impl<const D: usize, const P: usize> Predictor<D, P> {
    pub fn new<G: LieGroup<D, P>>(model: &Model<G, D, P>, options: PredictorOptions) -> Self {
        let n = model.dof;
        let changes = if model.has_switches() { options.max_contact_changes } else { 0 };
        let piece = Piece { end: 0.0, velocity: vec![0.0; n] };
        let update = Update { gradient: vec![0.0; n], solved: vec![0.0; n], factor: 0.0 };
        Self {
            options,
            factor: Factor::new(model),
            pieces: vec![piece; changes + 1],
            count: 1,
            curvature: vec![0.0; n],
            branch_end: f64::INFINITY,
            updates: vec![update; changes],
            contacts: ContactChanges::new(model),
            work: vec![0.0; n],
        }
    }

    /// Predicts the branch from the equilibrium evaluated last, over at most `h` and at most a displacement
    /// of norm `longest`, and takes its factor from the system. Returns the distance covered.
    pub fn predict<G: LieGroup<D, P>>(
        &mut self,
        system: &mut System<G, D, P>,
        velocity: &[f64],
        h: f64,
        longest: f64,
    ) -> f64 {
        system.swap_factor(&mut self.factor);
        self.branch_end = f64::INFINITY;
        self.count = 1;
        self.pieces[0].velocity.copy_from_slice(velocity);
        let mut speed = norm(velocity);
        let mut limit = h.min(longest / speed);
        if system.model().has_switches() {
            system.complete_columns();
            self.contacts.start(system, velocity, limit, &self.options);
        }
        let mut start = 0.0;
        let mut left = longest;
        while let Some((next, pair)) = self.contacts.next(start, limit) {
            let last = self.count - 1;
            self.pieces[last].end = next;
            left -= (next - start) * speed;
            if last == self.updates.len() {
                break;
            }
            self.contacts.advance(next - start);
            start = next;
            if !self.change_contact(system, pair) {
                self.branch_end = next;
                break;
            }
            let velocity = &self.pieces[last + 1].velocity;
            self.contacts.set_velocity(system, velocity);
            speed = norm(velocity);
            limit = h.min(start + left / speed);
        }
        limit
    }

    /// Predicts a Newton step from the state evaluated last as if the residual decreased in proportion along
    /// it. Returns whether contacts change on the way and the tangent stays positive definite.
    pub fn follow_step<G: LieGroup<D, P>>(&mut self, system: &mut System<G, D, P>, step: &[f64]) -> bool {
        self.predict(system, step, 1.0, f64::INFINITY);
        system.swap_factor(&mut self.factor);
        self.count > 1 && self.branch_end.is_infinite()
    }

    /// Starts the piece that follows the change of a pair; `false` when the branch ends there.
    fn change_contact<G: LieGroup<D, P>>(&mut self, system: &System<G, D, P>, pair: usize) -> bool {
        let Self { factor: start, pieces, count, updates, contacts, .. } = self;
        let (before, rest) = updates.split_at_mut(*count - 1);
        let Update { gradient, solved, factor } = &mut rest[0];
        let stiffness = contacts.switch(system, pair, gradient);
        solved.copy_from_slice(gradient);
        solve_updated(start, before, solved);
        let left = 1.0 + stiffness * dot(gradient, solved);
        if !(left > 0.0) {
            return false;
        }
        *factor = stiffness / left;
        let (done, next) = pieces.split_at_mut(*count);
        let velocity = &done[*count - 1].velocity;
        let turn = *factor * dot(gradient, velocity);
        for (next, (v, w)) in next[0].velocity.iter_mut().zip(velocity.iter().zip(&*solved)) {
            *next = v - turn * w;
        }
        *count += 1;
        true
    }

    /// Distance to the end of the branch; infinite if none is predicted.
    pub fn branch_end(&self) -> f64 {
        self.branch_end
    }

    /// The displacement after `h`.
    pub fn displacement(&self, h: f64, out: &mut [f64]) {
        out.iter_mut().zip(&self.curvature).for_each(|(x, a)| *x = 0.5 * h * h * a);
        let mut start = 0.0;
        for (i, piece) in self.pieces[..self.count].iter().enumerate() {
            let end = if i + 1 == self.count { h } else { piece.end.min(h) };
            out.iter_mut().zip(&piece.velocity).for_each(|(x, v)| *x += (end - start) * v);
            if end >= h {
                break;
            }
            start = end;
        }
    }

    /// The velocity after `h`.
    pub fn velocity(&self, h: f64) -> impl Iterator<Item = f64> {
        self.pieces[self.changes(h)].velocity.iter().zip(&self.curvature).map(move |(v, a)| v + h * a)
    }

    /// Solves H x = b in place with the tangent predicted after `h`.
    pub fn solve(&self, h: f64, b: &mut [f64]) {
        solve_updated(&self.factor, &self.updates[..self.changes(h)], b);
    }

    /// Number of changes of contact before `h`.
    fn changes(&self, h: f64) -> usize {
        self.pieces[..self.count - 1].partition_point(|piece| piece.end < h)
    }

    /// Takes the curvature from the error of the straight prediction over the last sub-step of `h`, over
    /// which the state moved by `moved` and after which it has this velocity.
    pub fn learn_curvature(&mut self, h: f64, moved: &[f64], velocity: &[f64]) {
        self.forget_curvature();
        let mut straight = std::mem::take(&mut self.work);
        self.displacement(h, &mut straight);
        let last = self.changes(h);
        let (mut turned, mut missed, mut both, mut speed) = (0.0, 0.0, 0.0, 0.0);
        let displacements = moved.iter().zip(&straight);
        let velocities = velocity.iter().zip(&self.pieces[last].velocity);
        for (a, ((m, d), (v, expected))) in self.curvature.iter_mut().zip(displacements.zip(velocities)) {
            let (turn, miss) = (h * (v - expected), m - d);
            turned += turn * turn;
            missed += miss * miss;
            both += turn * miss;
            speed += v * v;
            *a = turn / (h * h);
        }
        self.work = straight;
        let options = &self.options;
        let steady = (both / turned - 0.5).abs() < options.curvature_ratio
            && both > options.curvature_cosine * (turned * missed).sqrt();
        if !(steady && turned.sqrt() < options.max_curvature * h * speed.sqrt()) {
            self.forget_curvature();
        }
    }

    /// Discards the curvature.
    pub fn forget_curvature(&mut self) {
        self.curvature.fill(0.0);
    }

    /// Rescales the curvature for a load that continues `ratio` times as fast; zero if its direction
    /// changes.
    pub fn rescale_curvature(&mut self, ratio: f64) {
        self.curvature.iter_mut().for_each(|a| *a *= ratio * ratio);
    }

    #[cfg(test)]
    pub fn curvature(&self) -> &[f64] {
        &self.curvature
    }

    /// The ends of the pieces except the last.
    #[cfg(test)]
    pub fn change_points(&self) -> Vec<f64> {
        self.pieces[..self.count - 1].iter().map(|piece| piece.end).collect()
    }
}

fn solve_updated<const D: usize>(start: &Factor<D>, updates: &[Update], b: &mut [f64]) {
    start.solve(b);
    for update in updates {
        let along = update.factor * dot(&update.gradient, b);
        b.iter_mut().zip(&update.solved).for_each(|(x, w)| *x -= along * w);
    }
}
