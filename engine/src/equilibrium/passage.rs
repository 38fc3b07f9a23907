//! Ties along a path: no singular configuration is passed unnoticed, and a path that ends because ties cannot
//! be closed says so.

use super::continuation::Continuation;
use super::singular::Gradients;
use super::status::Status;
use super::step_control::StepControl;
use crate::lie::LieGroup;
use std::f64::consts::FRAC_PI_4;

/// Factor of the smallest sub-step where a singular configuration has to be told from one that is passed by.
const REFINEMENT: f64 = 1e-4;

/// Largest change of the velocity over a sub-step, as a fraction of the larger one: where branches cross, the
/// velocity would turn at once.
const MAX_TURN: f64 = 0.5;
/// A change of this displacement over a sub-step is allowed in any case.
const KINK: f64 = 1e-4;

/// What is known of ties along a path.
#[derive(Clone, Debug, Default)]
pub(super) struct Passage {
    /// The gradients of their conditions at the beginning of a sub-step.
    gradients: Gradients,
    /// Whether those at its end are compared with them: not while ties are being closed.
    pub watched: bool,
    /// Whether the last sub-step was rejected as a singular configuration lies on it.
    pub crossed: bool,
    /// The load of the last equilibrium.
    pub reached: Vec<f64>,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'_, G, D, P> {
    /// Begins a path, whose ties are still to be closed.
    pub(super) fn begin_passage(&mut self) {
        self.passage.watched = false;
        self.passage.reached.clear();
        self.system.independent.clear();
    }

    /// Begins a sub-step at the current equilibrium.
    pub(super) fn start_passage(&mut self) {
        if self.passage.watched {
            if self.system.turn_back_rotations() {
                self.system.evaluate();
                self.system.evaluate_tangent();
                self.system.factorise(0.0);
                self.change[0] = self.system.velocity(&self.rate, &mut self.velocity[0]);
                self.predictor.forget_curvature();
            }
            self.system.keep_independent();
            self.passage.gradients.take(&self.system);
            self.passage.reached.clear();
            self.passage.reached.extend_from_slice(self.system.load());
        }
    }

    /// Whether the state found at the end of a sub-step lies on this side of all singular configurations.
    pub(super) fn stays_regular(&mut self) -> bool {
        self.passage.crossed = self.passage.watched && !self.passage.gradients.lead_to(&self.system);
        !self.passage.crossed
    }

    /// Whether the velocities at both ends of a sub-step of `h` show that the path has no corner on it.
    pub(super) fn has_no_corner(&self, h: f64) -> bool {
        let model = self.system.model();
        if !self.passage.watched || model.has_switches() {
            return true;
        }
        let natural = &self.system.data().design.units.natural;
        let [before, after] = &self.velocity;
        let (mut turn, mut one, mut other) = (0.0, 0.0, 0.0);
        for (((a, b), unit), u) in before.iter().zip(after).zip(self.system.units()).zip(natural) {
            let (a, b) = (a * unit / u, b * unit / u);
            turn += (b - a) * (b - a);
            one += a * a;
            other += b * b;
        }
        let turn = turn.sqrt();
        turn <= MAX_TURN * f64::max(one, other).sqrt() || h * turn <= KINK
    }

    /// Whether a sub-step of `h` failed because of a singular configuration.
    pub(super) fn meets_singular(&mut self, h: f64) -> bool {
        if !self.passage.watched || self.passage.crossed {
            return self.passage.crossed;
        }
        let ahead: Vec<f64> = self.velocity[0].iter().map(|v| h * v).collect();
        self.system.set_load(&self.passage.reached);
        self.system.set_state(&self.start);
        self.passage.gradients.vanish_ahead(&mut self.system, &ahead)
    }

    /// Where the smallest sub-step passes a singular configuration, tries still smaller ones; if it does even
    /// so, goes back to the last equilibrium: the path ends.
    pub(super) fn ends_at_singular(&mut self, lambda: f64, control: &mut StepControl) -> Option<Status> {
        self.system.set_load_between(&self.start_load, &self.rate, lambda);
        self.system.set_state(&self.start);
        self.system.evaluate();
        if control.refine(REFINEMENT) {
            self.system.evaluate_tangent();
            self.system.factorise(0.0);
            return None;
        }
        Some(self.end_as_singular())
    }

    /// The status of a path that ends in the current state, a singular configuration.
    pub(super) fn end_as_singular(&mut self) -> Status {
        let shares = self.passage.gradients.weakest();
        self.system.set_weakest(shares);
        Status::Singular
    }

    /// The longest sub-step, as a fraction of the segment, over which a driven rotation cannot be mistaken for
    /// another one.
    pub(super) fn longest_turn(&self) -> f64 {
        if !self.passage.watched {
            return f64::INFINITY;
        }
        let drives = self.system.model().forces.ties.drives().filter(|(_, angular)| *angular);
        let rate = drives.map(|(input, _)| self.rate[input].abs()).fold(0.0, f64::max);
        FRAC_PI_4 / rate
    }

    /// The first state, an equilibrium, unless it is a singular configuration.
    pub(super) fn start_regular(&mut self, status: Status) -> Status {
        if !status.is_equilibrium() || !self.system.has_ties() || !self.system.is_singular_configuration() {
            return status;
        }
        self.passage.gradients.take(&self.system);
        self.passage.reached.clear();
        self.end_as_singular()
    }

    /// The load of the last equilibrium of a path that ended because of its ties.
    pub(super) fn reached_load(&self, status: Status) -> Option<&[f64]> {
        let ended = matches!(status, Status::NotClosed | Status::Singular);
        let inputs = self.system.input_loads().len();
        self.passage.reached.get(..inputs).filter(|_| ended)
    }

    /// The status of a path that ends on the way to a load.
    pub(super) fn why_ended(&mut self, status: Status, target: &[f64]) -> Status {
        if !self.system.has_ties() {
            return status;
        }
        let [before, now] = [self.start.clone(), self.system.state().to_vec()];
        self.why_not_closed(status, target, &[&before, &now])
    }

    /// The status of a search that ended without an equilibrium under a load: whether ties cannot be closed
    /// there, starting from any of these states. If so, the state is the one in which gaps are smallest.
    pub(super) fn why_not_closed(&mut self, status: Status, target: &[f64], from: &[&[f64]]) -> Status {
        let ended =
            matches!(status, Status::Stalled | Status::Diverged | Status::IterationLimit | Status::Singular);
        if !ended || !self.system.has_ties() {
            return status;
        }
        let (state, load) = (self.system.state().to_vec(), self.system.load().to_vec());
        self.system.penalised = false;
        self.system.set_openings(0..0);
        let reached = if self.passage.reached.is_empty() { target } else { &self.passage.reached };
        let turns = self.system.model().forces.ties.drives().filter(|(_, angular)| *angular);
        let turn = turns.map(|(input, _)| (target[input] - reached[input]).abs()).fold(0.0, f64::max);
        // A condition on an angle also holds at the opposite one.
        let stages = (turn / FRAC_PI_4).ceil().max(1.0) as usize;
        let rate: Vec<f64> = target.iter().zip(reached).map(|(t, r)| t - r).collect();
        let reached = reached.to_vec();
        let mut closest: Option<(f64, Vec<f64>)> = None;
        for start in from {
            self.system.set_state(start);
            let mut gap = 0.0;
            for stage in 1..=stages {
                self.system.set_load_between(&reached, &rate, stage as f64 / stages as f64);
                gap = self.system.close_as_far_as_possible(self.options.tolerance);
            }
            if gap.is_finite() && closest.as_ref().is_none_or(|(least, _)| gap < *least) {
                closest = Some((gap, self.system.state().to_vec()));
            }
        }
        if let Some((_, nearest)) = closest.filter(|(gap, _)| *gap > self.options.tolerance) {
            self.system.set_load(target);
            self.system.set_state(&nearest);
            self.system.evaluate();
            return Status::NotClosed;
        }
        self.system.set_state(&state);
        self.system.set_load(&load);
        self.system.evaluate();
        status
    }
}
