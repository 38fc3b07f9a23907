//! From an equilibrium with normal forces held to one with its own.
//!
//! Newton's method goes on from there, with the tangent of the equations in which what friction holds follows from
//! the state. Where it finds no equilibrium that is stable, the structure gives way: with the renewed normal forces
//! held, it moves to the next equilibrium, and so on until it comes to rest.

use super::continuation::{Continuation, LoadStep};
use super::corrector::CorrectorTolerance;
use super::path::{Event, EventKind, PathSink};
use super::status::Status;
use super::vector::max_norm;
use crate::lie::LieGroup;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'_, G, D, P> {
    /// Continues from an equilibrium found with normal forces held to one with its own.
    pub(super) fn settle_friction(
        &mut self,
        mut status: Status,
        before: &[f64],
        target: &[f64],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        let residual = self.options.tolerance;
        let found = self.system.state().to_vec();
        let (mut smooth, mut opened) = (true, false);
        for round in 0..self.options.friction.max_rounds {
            if !status.is_equilibrium() {
                return status;
            }
            if let Some(status) = self.system.budget.exhausted() {
                return status;
            }
            let size = self.system.renew_friction();
            // With normal forces held, a contact that gives way slides on under what it has lost.
            opened |= self.system.data().has_opened();
            if self.system.has_converged(size, residual) || self.system.is_balanced(residual) {
                let from = if opened { before } else { &found };
                if (opened || !smooth) && self.crosses_a_barrier_of_friction(from) {
                    let (load, after) = (self.system.input_loads(), self.system.state());
                    sink.event(Event { step: step.index, kind: EventKind::Snap, load, before, after });
                }
                return status;
            }
            let newton = if round.count_ones() <= 1 { self.solve_renewed() } else { None };
            smooth &= newton == Some(true);
            if newton.is_some() {
                status = Status::Converged;
                self.unstable = false;
            } else {
                status = self.give_way(status, size, step);
            }
            status = self.hold(status, target, step, sink);
        }
        Status::Stalled
    }

    /// Newton's method for an equilibrium with its own normal forces, from the current state: whether it went there
    /// by full steps through states that are stable, or `None`, with the state restored, if it finds none that is.
    fn solve_renewed(&mut self) -> Option<bool> {
        let start = self.system.state().to_vec();
        let found = self.iterate_renewed();
        if found.is_none() {
            self.system.set_state(&start);
            self.system.renew_friction();
        }
        self.system.evaluate_tangent();
        self.system.factorise(0.0);
        found
    }

    fn iterate_renewed(&mut self) -> Option<bool> {
        let (tolerance, newton) = (self.options.tolerance, self.options.newton);
        let options = self.options.friction;
        let mut size = self.system.renew_friction();
        let mut step = std::mem::take(&mut self.work);
        let mut total = 0.0;
        let (mut found, mut smooth) = (None, true);
        for _ in 0..options.max_iterations {
            if !size.is_finite() || self.system.budget.exhausted().is_some() {
                break;
            }
            let stable = self.system.factorise_renewed();
            if self.system.has_converged(size, tolerance) {
                found = stable.then_some(smooth);
                break;
            }
            smooth &= stable;
            self.system.negative_residual(&mut step);
            self.system.factor.solve_renewed(&mut step);
            let length = max_norm(&step);
            if length <= newton.small_step && self.system.is_balanced(tolerance) {
                found = stable.then_some(smooth);
                break;
            }
            total += length;
            if !(total <= self.options.max_displacement_with_contact) {
                break;
            }
            match self.shorten(&step, size) {
                Some((lowered, full)) => {
                    size = lowered;
                    smooth &= full;
                }
                None => break,
            }
        }
        self.work = step;
        found
    }

    /// Halves a step until it lowers the residual; returns it then, and whether it is the whole step.
    fn shorten(&mut self, step: &[f64], before: f64) -> Option<(f64, bool)> {
        self.start.copy_from_slice(self.system.state());
        let mut fraction = 1.0;
        for _ in 0..self.options.friction.max_halvings {
            self.system.advance_from(&self.start, step, fraction);
            let size = self.system.renew_friction();
            if size < (1.0 - 0.1 * fraction) * before {
                return Some((size, fraction == 1.0));
            }
            fraction *= 0.5;
        }
        self.system.set_state(&self.start);
        None
    }

    /// Moves to the next equilibrium with normal forces held, from a state in which they were renewed and its
    /// largest residual then.
    fn give_way(&mut self, status: Status, size: f64, step: LoadStep) -> Status {
        let tolerance = CorrectorTolerance {
            residual: self.options.tolerance,
            tangent_reuse: step.tangent_reuse,
            stable: true,
        };
        self.start.copy_from_slice(self.system.state());
        let reach = self.options.max_displacement_with_contact;
        if self.corrector.iterate(&mut self.system, size, reach, tolerance) {
            if status == Status::Unstable {
                self.unstable = false;
                return Status::Converged;
            }
            return status;
        }
        self.system.set_state(&self.start);
        let found = self.find_stable_from_here(self.options.friction.radius, step.tangent_reuse);
        self.unstable = found == Status::Unstable;
        found
    }

    /// Whether stability with renewed normal forces is lost somewhere between a state and the equilibrium found.
    fn crosses_a_barrier_of_friction(&mut self, from: &[f64]) -> bool {
        let found = self.system.state().to_vec();
        let mut moved = std::mem::take(&mut self.moved);
        self.system.displacement(from, &mut moved);
        let least = self.options.jump.min_displacement;
        // A contact that gives way is left early on the way.
        let halves = std::iter::successors(Some(0.5), |part| Some(0.5 * part));
        let places = halves.take_while(|part| part * max_norm(&moved) > 0.1 * least);
        let far = max_norm(&moved) > least;
        let crosses = far
            && places.flat_map(|part| [part, 1.0 - part]).any(|part| {
                self.system.advance_from(from, &moved, part);
                self.system.renew_friction();
                !self.system.factorise_renewed()
            });
        self.moved = moved;
        if far {
            self.system.set_state(&found);
            self.system.renew_friction();
            self.system.evaluate_tangent();
            self.system.factorise(0.0);
        }
        crosses
    }
}
