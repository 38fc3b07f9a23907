//! Ties along a path: no singular configuration is passed unnoticed, and a path that ends because ties cannot
//! be closed says so.

use super::continuation::Continuation;
use super::singular::{Gradients, RelativeRates};
use super::status::Status;
use super::step_control::StepControl;
use crate::lie::LieGroup;
use std::f64::consts::FRAC_PI_4;

/// Factor of the smallest sub-step where a singular configuration has to be told from one that is passed by,
/// and how often it may be applied.
const REFINEMENT: f64 = 1e-4;
const REFINEMENTS: usize = 3;
/// Distance, in natural units of the coordinates, from which a state cannot be told from a singular
/// configuration ahead: errors of equilibria move it there.
pub(super) const NEAREST: f64 = 1e-6;
/// Distance likewise at which a sub-step that fails does so because of it.
const NEAR: f64 = 1e-4;

/// Largest fraction of a singular value that may vanish over a sub-step, at the rates at its ends.
pub(super) const LARGEST_FALL: f64 = 0.5;
/// A sub-step that fails does so because of a singular configuration if more than this fraction of a singular
/// value would vanish over it.
const NOTICED_FALL: f64 = 0.2;

/// Driven motion beyond a singular configuration, in radians or lengths of the longest body, over which it is
/// tried whether ties can be closed.
const BEYOND: f64 = 1e-3;
/// Number of places on the way to a load where the gaps of ties are compared.
const PLACES: usize = 16;

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
    /// Relative rates at which singular values of the gradients change there.
    rates: RelativeRates,
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

    /// Begins a sub-step at the current equilibrium; the status of the path if it ends there.
    pub(super) fn start_passage(&mut self) -> Option<Status> {
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
            self.passage.rates = self.system.singular_rates(&self.rate, &self.velocity[0], false);
            if self.passage.rates.speed < NEAREST * self.passage.rates.fall {
                self.start.copy_from_slice(self.system.state());
                return Some(self.end_as_singular());
            }
        }
        None
    }

    /// Whether the state found at the end of a sub-step lies on this side of all singular configurations.
    pub(super) fn stays_regular(&mut self) -> bool {
        self.passage.crossed = self.passage.watched && !self.passage.gradients.lead_to(&self.system);
        !self.passage.crossed
    }

    /// Whether velocities and singular values at both ends of a sub-step of `h` show that no other branch
    /// crosses the path on it.
    pub(super) fn meets_no_branch(&mut self, h: f64) -> bool {
        if !self.passage.watched {
            return true;
        }
        let rise = self.system.singular_rates(&self.rate, &self.velocity[1], false).rise;
        self.passage.crossed = !(h * self.passage.rates.fall.max(rise) <= LARGEST_FALL);
        !self.passage.crossed && (self.system.model().has_switches() || self.has_no_corner(h))
    }

    fn has_no_corner(&self, h: f64) -> bool {
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
    pub(super) fn meets_singular(&self, h: f64) -> bool {
        let Passage { watched, crossed, rates, .. } = &self.passage;
        let RelativeRates { speed, fall, .. } = rates;
        *watched && (*crossed || h * fall > NOTICED_FALL || *speed < NEAR * fall)
    }

    /// Whether what was found in place of a sub-step of `h`, without an event, may be beyond a singular
    /// configuration.
    pub(super) fn may_have_passed(&mut self, h: f64) -> bool {
        if !self.passage.watched {
            return false;
        }
        let rise = self.system.singular_rates(&self.rate, &self.velocity[0], false).rise;
        let far = h * self.passage.rates.fall.max(rise) > LARGEST_FALL;
        far || !self.passage.gradients.lead_to(&self.system)
    }

    /// Where the smallest sub-step passes a singular configuration, tries still smaller ones; if it does even
    /// so, goes back to the last equilibrium: the path ends.
    pub(super) fn ends_at_singular(&mut self, lambda: f64, control: &mut StepControl) -> Option<Status> {
        self.system.set_load_between(&self.start_load, &self.rate, lambda);
        self.system.set_state(&self.start);
        self.system.evaluate();
        if control.refine(REFINEMENT, REFINEMENTS) {
            self.system.evaluate_tangent();
            self.system.factorise(0.0);
            self.change[0] = self.system.velocity(&self.rate, &mut self.velocity[0]);
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

    /// The longest sub-step from here, as a fraction of the segment, that stays short of all singular
    /// configurations and over which a driven rotation cannot be mistaken for another one.
    pub(super) fn longest_passage(&self) -> f64 {
        if !self.passage.watched {
            return f64::INFINITY;
        }
        let drives = self.system.model().forces.ties.drives().filter(|(_, angular)| *angular);
        let rate = drives.map(|(input, _)| self.rate[input].abs()).fold(0.0, f64::max);
        let RelativeRates { fall, rise, .. } = self.passage.rates;
        (FRAC_PI_4 / rate).min(LARGEST_FALL / fall).min(LARGEST_FALL / (1.0 - LARGEST_FALL) / rise)
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
    ///
    /// A path that ends in a singular configuration could not be closed if it cannot be just beyond it,
    /// whatever the load that it was to reach; if it can be there again, the state is the one on the way in which
    /// gaps are largest.
    pub(super) fn why_not_closed(&mut self, status: Status, target: &[f64], from: &[&[f64]]) -> Status {
        let ended = matches!(
            status,
            Status::Stalled
                | Status::Diverged
                | Status::IterationLimit
                | Status::Unrestrained
                | Status::Singular
        );
        if !ended || !self.system.has_ties() {
            return status;
        }
        let (state, load) = (self.system.state().to_vec(), self.system.load().to_vec());
        self.system.penalised = false;
        self.system.set_openings(0..0);
        let blocked = status == Status::Singular && self.is_blocked(target);
        let tolerance = self.options.tolerance;
        if status != Status::Singular || blocked {
            let reached = if self.passage.reached.is_empty() { target } else { &self.passage.reached };
            let turns = self.system.model().forces.ties.drives().filter(|(_, angular)| *angular);
            let turn = turns.map(|(input, _)| (target[input] - reached[input]).abs()).fold(0.0, f64::max);
            // A condition on an angle also holds at the opposite one.
            let turned = (turn / FRAC_PI_4).ceil().max(1.0) as usize;
            let stages = if blocked { turned.max(PLACES) } else { turned };
            let reached = reached.to_vec();
            let rate: Vec<f64> = target.iter().zip(&reached).map(|(t, r)| t - r).collect();
            let (mut closest, mut widest): (Option<Gap>, Option<Gap>) = (None, None);
            for start in from {
                self.system.set_state(start);
                for stage in 1..=stages {
                    let lambda = stage as f64 / stages as f64;
                    self.system.set_load_between(&reached, &rate, lambda);
                    let size = self.system.close_as_far_as_possible(tolerance);
                    let gap = Gap { size, lambda, state: self.system.state().to_vec() };
                    let last = stage == stages;
                    if last && size.is_finite() && closest.as_ref().is_none_or(|least| size < least.size) {
                        closest = Some(gap);
                    } else if blocked && size.is_finite() && widest.as_ref().is_none_or(|w| size > w.size) {
                        widest = Some(gap);
                    }
                }
            }
            let open = |gap: &Gap| gap.size > tolerance;
            if let Some(gap) = closest.filter(open).or(widest.filter(open)) {
                self.system.set_load_between(&reached, &rate, gap.lambda);
                if gap.lambda == 1.0 {
                    self.system.set_load(target);
                }
                self.system.set_state(&gap.state);
                self.system.evaluate();
                return Status::NotClosed;
            }
        }
        self.system.set_state(&state);
        self.system.set_load(&load);
        self.system.evaluate();
        status
    }

    /// Whether ties cannot be closed just beyond the singular configuration in which the path to a load ends.
    fn is_blocked(&mut self, target: &[f64]) -> bool {
        let Passage { reached, .. } = &self.passage;
        if reached.is_empty() {
            return false;
        }
        let (reached, length) = (reached.clone(), self.system.longest_body());
        let drives = self.system.model().forces.ties.drives();
        let size = |(input, angular): (usize, bool)| {
            let unit = if angular { 1.0 } else { length };
            ((target[input] - reached[input]) / unit).abs()
        };
        let left = drives.map(size).fold(0.0, f64::max);
        if left == 0.0 {
            return false;
        }
        let share = (BEYOND / left).min(1.0);
        let rate: Vec<f64> = target.iter().zip(&reached).map(|(t, r)| t - r).collect();
        let start = self.start.clone();
        // On along the path as well, on whose other side ties may be closed.
        let natural = &self.system.data().design.units.natural;
        let speeds = self.velocity[0].iter().zip(self.system.units()).zip(natural);
        let speeds: Vec<f64> = speeds.map(|((v, unit), u)| v * unit / u).collect();
        let speed = speeds.iter().map(|v| v * v).sum::<f64>().sqrt();
        let ahead: Vec<f64> = speeds.iter().map(|v| v * BEYOND / speed.max(f64::MIN_POSITIVE)).collect();
        self.system.set_load_between(&reached, &rate, share);
        let mut blocked = true;
        for step in [0.0, 0.1, 1.0, 10.0] {
            self.system.set_state(&start);
            let moved: Vec<f64> = ahead.iter().map(|x| x * step).collect();
            self.system.move_naturally(&moved);
            blocked &=
                !(self.system.close_as_far_as_possible(self.options.tolerance) <= self.options.tolerance);
        }
        blocked
    }
}

/// The gaps of ties on the way to a load.
struct Gap {
    size: f64,
    /// How far on the way.
    lambda: f64,
    state: Vec<f64>,
}
