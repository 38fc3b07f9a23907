//! Following an equilibrium along a list of loads.

use super::branch::Goal;
use super::solver::{Solver, largest};
use super::status::Status;
use crate::lie::LieGroup;
use crate::model::Model;

/// What happened to a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum EventKind {
    /// The branch ended; the system fell to another equilibrium.
    Snap = 0,
}

impl EventKind {
    /// All kinds, by code.
    pub const ALL: [EventKind; 1] = [EventKind::Snap];

    /// The name used in results and records.
    pub fn name(self) -> &'static str {
        match self {
            EventKind::Snap => "snap",
        }
    }
}

/// An event between two load steps.
#[derive(Clone, Debug)]
pub struct Event<'a> {
    /// Index of the load step being approached.
    pub step: usize,
    /// What happened.
    pub kind: EventKind,
    /// Load at which it happened.
    pub load: &'a [f64],
    /// State before.
    pub before: &'a [f64],
    /// State after.
    pub after: &'a [f64],
}

/// The state at one of the listed loads.
#[derive(Clone, Copy, Debug)]
pub struct StepReport<'a> {
    /// How the step ended.
    pub status: Status,
    /// State; meaningful for equilibria only.
    pub q: &'a [f64],
    /// Iterations (evaluations of the tangent) used for this step.
    pub iterations: usize,
    /// Largest dimensionless residual.
    pub residual: f64,
}

/// Receives the results of a path as they come.
pub trait PathSink<G, const D: usize, const P: usize> {
    /// A listed load has been dealt with; the solver still holds the state.
    fn step(&mut self, index: usize, report: StepReport, solver: &Solver<G, D, P>);
    /// The branch ended on the way.
    fn event(&mut self, event: Event);
}

/// Dimensionless residual that suffices between the listed loads: a fraction of the predicted move,
const LOOSE: f64 = 0.03;
/// and at most this.
const LOOSEST: f64 = 0.1;
/// [`Goal::keep`] between the listed loads, after a fall between them and at those that are followed by
/// others.
const KEEP_BETWEEN: f64 = 0.3;
const KEEP_AFTER_FALL: f64 = 0.1;
const KEEP_AT_LISTED: f64 = 0.03;
/// Longest sub-step (dimensionless norm over all coordinates): several full turns of a rod.
const LONGEST: f64 = 30.0;
/// The same where there is contact.
const LONGEST_WITH_CONTACT: f64 = 4.0;
/// Where the branch is seen to end, the next sub-step goes so far towards it.
const AIM: f64 = 0.75;
/// Trust radius of the first step down from the end of a branch.
const FIRST_RADIUS: f64 = 0.3;
/// A displacement below this (dimensionless) across the smallest sub-step is no jump.
const SMALLEST_JUMP: f64 = 1e-3;

/// One of the listed loads.
#[derive(Clone, Copy, Debug)]
struct Listed {
    index: usize,
    /// [`Goal::keep`] here: zero where the path ends, as there the tangent must be that of the very
    /// state.
    keep: f64,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Solver<G, D, P> {
    /// Solves at `loads[0]` from the state `q0` and follows the equilibrium to each further load.
    ///
    /// Every load gets a report. After a failure the rest are [`Status::NotReached`].
    ///
    /// # Panics
    /// If a load or `q0` has the wrong length.
    pub fn follow(
        &mut self,
        model: &Model<G, D, P>,
        loads: &[&[f64]],
        q0: &[f64],
        sink: &mut impl PathSink<G, D, P>,
    ) {
        let reach = loads.iter().flat_map(|l| l.iter()).fold(0.0f64, |m, u| m.max(u.abs()));
        self.q.copy_from_slice(q0);
        self.prediction.forget_bend();
        self.rate.fill(0.0);
        let mut status = Status::Converged;
        for (index, target) in loads.iter().enumerate() {
            let before = self.iterations;
            if status.is_equilibrium() {
                let last = loads[index..].iter().all(|later| later == target);
                let listed = Listed { index, keep: if last { 0.0 } else { KEEP_AT_LISTED } };
                status = if index == 0 {
                    self.load.copy_from_slice(target);
                    self.settle(model, 1.0, listed.keep)
                } else {
                    self.follow_segment(model, target, listed, reach, sink)
                };
            } else {
                status = Status::NotReached;
            }
            let residual = largest(&self.residual);
            let report = StepReport { status, q: &self.q, iterations: self.iterations - before, residual };
            sink.step(index, report, self);
        }
    }

    /// From the equilibrium at `self.load` to the one at `target`.
    fn follow_segment(
        &mut self,
        model: &Model<G, D, P>,
        target: &[f64],
        listed: Listed,
        reach: f64,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        self.start_load.copy_from_slice(&self.load);
        let mut rate = std::mem::take(&mut self.rate);
        let (mut before, mut now, mut both) = (0.0, 0.0, 0.0);
        for ((r, t), s) in rate.iter_mut().zip(target).zip(&self.start_load) {
            let last = std::mem::replace(r, t - s);
            before += last * last;
            now += *r * *r;
            both += last * *r;
        }
        let parallel = both * both > (1.0 - 1e-12) * before * now;
        self.prediction.rescale_bend(if parallel { both / before } else { 0.0 });
        let span = rate.iter().fold(0.0f64, |m, r| m.max(r.abs()));
        let status = if span == 0.0 {
            Status::Converged
        } else {
            let smallest = (self.options.min_step * reach / span).min(1.0);
            self.advance_along(model, &rate, smallest, listed, sink)
        };
        self.rate = rate;
        status
    }

    fn advance_along(
        &mut self,
        model: &Model<G, D, P>,
        rate: &[f64],
        smallest: f64,
        listed: Listed,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        let first = self.iterations;
        let longest = if model.has_switches() { LONGEST_WITH_CONTACT } else { LONGEST };
        // The factor at hand belongs to the equilibrium just found.
        self.set_velocity(model, rate, 0);
        let mut lambda = 0.0;
        let mut last = Status::Converged;
        // The nearest load that could not be reached in one sub-step.
        let mut barrier = f64::INFINITY;
        let mut end_seen = None;
        while lambda < 1.0 {
            self.start.copy_from_slice(&self.q);
            let target = barrier.min(1.0);
            let reach = self.predict(model, target - lambda, longest);
            let end = self.estimate_end(lambda, &mut end_seen);
            let mut h = (target - lambda).min(AIM * end);
            while h > reach && h > smallest {
                h *= 0.5;
                barrier = lambda + 2.0 * h;
            }
            let h = h.max(smallest);
            let mut next = if lambda + h < target { lambda + h } else { target };
            let followed = loop {
                self.set_load(rate, next);
                let goal = self.goal_at(next, next - lambda, listed);
                if self.follow_branch(model, rate, next - lambda, goal) {
                    break true;
                }
                if self.iterations - first > self.options.max_iterations {
                    return Status::IterationLimit;
                }
                if next - lambda <= 1.5 * smallest {
                    break false;
                }
                barrier = next;
                next = lambda + (0.5 * (next - lambda)).max(smallest);
            };
            if followed {
                self.learn_bend(next - lambda);
                last = Status::Converged;
                if next >= barrier {
                    barrier = f64::INFINITY;
                }
            } else {
                last = self.fall(model, rate, [lambda, next], listed, sink);
                if !last.is_equilibrium() {
                    return last;
                }
                self.prediction.forget_bend();
                barrier = f64::INFINITY;
                end_seen = None;
            }
            if self.iterations - first > self.options.max_iterations {
                return Status::IterationLimit;
            }
            lambda = next;
            self.velocity.swap(0, 1);
        }
        last
    }

    /// Descends from the end of the branch between two loads, the later of which is set.
    fn fall(
        &mut self,
        model: &Model<G, D, P>,
        rate: &[f64],
        [before, after]: [f64; 2],
        listed: Listed,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        self.q.copy_from_slice(&self.start);
        let keep = if after == 1.0 { listed.keep } else { KEEP_AFTER_FALL };
        let status = self.settle(model, FIRST_RADIUS, keep);
        if status.is_equilibrium() {
            self.set_velocity(model, rate, 1);
            if self.displacement() > SMALLEST_JUMP + 1.5 * (after - before) * self.ordinary_speed() {
                let (load, before, after) = (&self.load[..], &self.start[..], &self.q[..]);
                sink.event(Event { step: listed.index, kind: EventKind::Snap, load, before, after });
            }
        }
        status
    }

    /// How far ahead of `lambda` the branch ends; infinite when no end is in sight.
    ///
    /// Towards a fold the first-order estimate lags behind: two of them are extrapolated.
    fn estimate_end(&self, lambda: f64, seen: &mut Option<(f64, f64)>) -> f64 {
        let distance = self.prediction.branch_end;
        let before = std::mem::replace(seen, distance.is_finite().then_some((lambda, distance)));
        match before {
            Some((at, far)) if distance < far => distance.min(distance * (lambda - at) / (far - distance)),
            _ => distance,
        }
    }

    /// What is asked of a sub-step of `h` that ends at `lambda`; at 1 the load is a listed one.
    fn goal_at(&self, lambda: f64, h: f64, listed: Listed) -> Goal {
        let tolerance = self.options.tolerance;
        if lambda == 1.0 {
            Goal { tolerance, keep: listed.keep }
        } else {
            let loose = (LOOSE * h * largest(&self.velocity[0])).min(LOOSEST).max(tolerance);
            Goal { tolerance: loose, keep: KEEP_BETWEEN }
        }
    }

    fn set_load(&mut self, rate: &[f64], lambda: f64) {
        for ((u, s), r) in self.load.iter_mut().zip(&self.start_load).zip(rate) {
            *u = s + lambda * r;
        }
    }

    /// Largest speed that a branch without a fold has between the velocities at hand.
    fn ordinary_speed(&self) -> f64 {
        let [before, after] = [0, 1].map(|end| largest(&self.velocity[end]));
        // Towards a fold the speed grows without bound; behind it, it does not.
        if before <= 4.0 * after { before.max(after) } else { 4.0 * after }
    }

    /// Largest dimensionless move since `self.start`.
    fn displacement(&self) -> f64 {
        let moved = self.q.iter().zip(&self.start).zip(&self.unit).map(|((q, s), u)| ((q - s) / u).abs());
        moved.fold(0.0, f64::max)
    }
}
