//! Continuation: following an equilibrium along a list of loads with predictor and corrector.

use super::budget::{Budget, Cancel};
use super::controlled::SetPoints;
use super::corrector::{Corrector, CorrectorTolerance};
use super::critical::CriticalSearch;
use super::damped_newton::DampedNewton;
use super::friction::FrictionSubstep;
use super::options::ContinuationOptions;
use super::passage::Passage;
use super::path::{Event, PathSink, StepReport};
use super::predictor::Predictor;
use super::same_branch::is_same_branch;
use super::stability::Stability;
use super::status::Status;
use super::step_control::StepControl;
use super::sweep::PathMotion;
use super::system::System;
use super::trust_region::{Target, TrustRegion};
use super::vector::max_norm;
use crate::lie::LieGroup;
use crate::model::Model;
use crate::results::PathFriction;
use crate::tolerances::{PARALLEL, ZERO_EIGENVALUE};

/// Finds and follows equilibria; owns all memory it needs.
#[derive(Clone, Debug)]
pub struct Continuation<'m, G, const D: usize, const P: usize> {
    pub(super) system: System<'m, G, D, P>,
    pub(super) predictor: Predictor<D, P>,
    pub(super) options: ContinuationOptions,
    pub(super) corrector: Corrector<D, P>,
    pub(super) trust_region: TrustRegion,
    pub(super) damped_newton: DampedNewton,
    pub(super) critical: CriticalSearch,
    /// dq/dλ (dimensionless) at both ends of a sub-step.
    pub(super) velocity: [Vec<f64>; 2],
    /// Largest change of a residual with λ, at both.
    pub(super) change: [f64; 2],
    /// The state at its beginning, and the displacement over it.
    pub(super) start: Vec<f64>,
    /// Number of contacts and slack springs that act there.
    switched_on: usize,
    pub(super) moved: Vec<f64>,
    /// The load at the beginning of the segment between two listed loads, and its change over it.
    pub(super) start_load: Vec<f64>,
    pub(super) rate: Vec<f64>,
    /// Difference between the largest and the smallest value of each input over the path.
    pub(super) range: Vec<f64>,
    /// The energy in `start` under the load of the current jump, and its gradient, the residual.
    pub(super) energy: f64,
    pub(super) slope: Vec<f64>,
    /// Whether the equilibrium found last is unstable.
    pub(super) unstable: bool,
    /// Whether every listed equilibrium so far has had a motion without stiffness.
    pub(super) never_held: bool,
    pub(super) work: Vec<f64>,
    pub(super) set_points: SetPoints,
    /// What is known of ties along the path.
    pub(super) passage: Passage,
    /// Slips that points with friction have in the state in which paths begin; none has slipped if empty.
    pub(super) start_slips: Vec<PathFriction>,
    /// Loads between the listed ones at which friction settled along the path followed last.
    pub(crate) friction_substeps: Vec<FrictionSubstep<P>>,
}

/// The listed load that is being approached.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoadStep {
    pub index: usize,
    /// [`CorrectorTolerance::tangent_reuse`] there: zero where the path ends, as the tangent there must be
    /// that of the final state.
    pub tangent_reuse: f64,
}

impl<'m, G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'m, G, D, P> {
    /// For `model`, with the model's own parameters. Solves end soon after `cancel` is requested.
    pub fn new(
        model: &'m Model<G, D, P>,
        options: ContinuationOptions,
        cancel: Option<&'m dyn Cancel>,
    ) -> Self {
        debug_assert_eq!(options.validate(), Ok(()));
        let (n, inputs) = (model.dof(), model.load_count());
        let zeros = || vec![0.0; n];
        Self {
            system: System::new(model, Budget::new(&options, cancel), options.mixed.stiffness),
            predictor: Predictor::new(model, options.predictor),
            options,
            corrector: Corrector::new(model, &options),
            trust_region: TrustRegion::new(options.trust_region, options.newton, n),
            damped_newton: DampedNewton::new(options.damped_newton, n),
            critical: CriticalSearch::new(options.critical, n),
            velocity: [zeros(), zeros()],
            change: [0.0; 2],
            start: zeros(),
            switched_on: 0,
            moved: zeros(),
            start_load: vec![0.0; inputs],
            rate: vec![0.0; inputs],
            range: vec![0.0; inputs],
            energy: 0.0,
            slope: zeros(),
            unstable: false,
            never_held: false,
            work: zeros(),
            set_points: SetPoints::new(inputs),
            passage: Passage::default(),
            start_slips: vec![],
            friction_substeps: vec![],
        }
    }

    /// Lets paths begin with the slips that points with friction had in a step of another one.
    pub fn start_with(&mut self, slips: &[PathFriction]) {
        self.start_slips = slips.to_vec();
    }

    /// Takes over a vector of parameters; `false` when they are not admissible.
    pub fn set_parameters(&mut self, parameters: &[f64]) -> bool {
        let admissible = self.system.model().is_admissible(parameters);
        if admissible {
            self.system.set_parameters(parameters);
        }
        admissible && self.system.can_be_controlled()
    }

    /// Solves at `loads[0]` from the state `q0` and follows the equilibrium to each further load.
    ///
    /// Every load gets a report. After a failure the rest are [`Status::NotReached`].
    ///
    /// # Panics
    /// If a load or `q0` has the wrong length.
    pub fn follow(&mut self, loads: &[&[f64]], q0: &[f64], sink: &mut impl PathSink<G, D, P>) {
        let closed = self.with_closed_ties(loads);
        let closed: Vec<&[f64]> = closed.iter().map(Vec::as_slice).collect();
        let loads = if closed.is_empty() { loads } else { &closed };
        self.set_ranges(loads);
        self.friction_substeps.clear();
        self.system.set_state(q0);
        if self.system.has_friction() {
            self.system.begin_friction(&self.start_slips);
        }
        self.system.measure_units(loads);
        self.predictor.forget_curvature();
        self.rate.fill(0.0);
        let mut status = Status::Converged;
        for (index, target) in loads.iter().enumerate() {
            self.system.budget.restart();
            let mut held = false;
            if status.is_equilibrium() {
                let last = loads[index..].iter().all(|later| later == target);
                let tangent_reuse = if last { 0.0 } else { self.options.accuracy.tangent_reuse_at_listed };
                let step = LoadStep { index, tangent_reuse };
                status = if index == 0 {
                    self.begin_with_friction(target, step, sink)
                } else if self.system.has_friction() && *target == loads[index - 1] {
                    held = true;
                    if self.unstable { Status::Unstable } else { Status::Converged }
                } else {
                    let status = self.follow_with_friction([loads[index - 1], target], step, sink);
                    self.why_ended(status, target)
                };
            } else {
                status = Status::NotReached;
            }
            if status == Status::Stalled {
                self.system.measure_accuracy(self.options.tolerance);
            }
            let iterations = self.system.budget.iterations();
            let stability = match status {
                Status::Converged => self.system.stability(),
                Status::Unstable => Stability::Unstable,
                _ => Stability::Unknown,
            };
            let free = self.system.free_coordinates();
            let accuracy = self.system.accuracy();
            let q = self.system.state();
            let reached = self.reached_load(status);
            let report = StepReport { status, q, iterations, stability, accuracy, reached, free: &free };
            sink.step(index, report, &self.system);
            if status.is_equilibrium() && self.system.has_friction() && !held {
                self.end_friction_step();
            }
        }
    }

    /// Finds an equilibrium at the first load from the current state.
    pub(super) fn begin(
        &mut self,
        target: &[f64],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        self.begin_passage();
        self.never_held = false;
        self.system.set_load(target);
        let radius = self.options.trust_region.initial_radius;
        let found = if self.system.has_ties() {
            let closed = self.close_ties(target, step, sink);
            self.start_regular(closed)
        } else {
            self.find_first(radius, step.tangent_reuse)
        };
        self.passage.watched = self.system.has_ties();
        self.never_held = true;
        let status = self.hold(found, target, step, sink);
        self.unstable = status == Status::Unstable;
        status
    }

    /// From the equilibrium at the current load to the one at `target`, in sub-steps.
    pub(super) fn follow_segment(
        &mut self,
        target: &[f64],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        self.set_segment(target);
        if max_norm(&self.rate) == 0.0 {
            return if self.unstable { Status::Unstable } else { Status::Converged };
        }
        let max_displacement = if self.is_sprung() {
            self.options.max_displacement_with_springs
        } else if self.system.model().has_switches() {
            self.options.max_displacement_with_contact
        } else {
            self.options.max_displacement
        };
        let min_step = (self.options.min_step * self.span()).min(1.0);
        let end_distance = self.options.locate.end_distance * self.span();
        let mut control = StepControl::new(self.options.step, min_step, end_distance);
        let mut lambda = match self.settle(min_step, step) {
            Ok(reached) => reached,
            Err(status) => return status,
        };
        // The factor at hand belongs to the equilibrium just found.
        self.system.find_neutral(&self.rate);
        self.change[0] = self.system.velocity(&self.rate, &mut self.velocity[0]);
        self.unstable = false;
        while lambda < 1.0 {
            if let Some(status) = self.start_passage() {
                return status;
            }
            self.start.copy_from_slice(self.system.state());
            self.switched_on = self.system.switched_on();
            self.system.start_sweeps();
            let ahead = (control.target() - lambda).min(self.longest_passage());
            let reach = self.predictor.predict(&mut self.system, &self.velocity[0], ahead, max_displacement);
            let to_end = self.predictor.branch_end();
            if control.is_at_end(to_end) && !control.ignores_ends() {
                let next = (lambda + min_step).min(1.0);
                self.move_to_predicted_end(to_end);
                lambda = match self.leave_limit_point(lambda, lambda + to_end, next, step, sink, &mut control)
                {
                    Ok(lambda) => lambda,
                    Err(status) => return status,
                };
                self.restart(&mut control);
                continue;
            }
            let mut next = control.propose(lambda, reach, to_end);
            let followed = loop {
                self.system.set_load_between(&self.start_load, &self.rate, next);
                if self.correct(next - lambda, self.tolerance_at(next, next - lambda, step)) {
                    break true;
                }
                if let Some(status) = self.system.budget.exhausted() {
                    return status;
                }
                match control.shorten(lambda, next) {
                    Some(shorter) => next = shorter,
                    None => break false,
                }
            };
            if followed {
                self.predictor.learn_curvature(next - lambda, &self.moved, &self.velocity[1]);
                control.accept(lambda, next);
                self.unstable = false;
                lambda = next;
                self.swap_ends();
            } else if self.meets_singular(next - lambda) {
                if let Some(status) = self.ends_at_singular(lambda, &mut control) {
                    return status;
                }
            } else {
                let before = self.passage.watched.then(|| self.start.clone());
                let mut heard = Heard { sink, events: 0 };
                let reached = match self.pass_branch_end(lambda, next, step, &mut heard, &mut control) {
                    Ok(lambda) => lambda,
                    Err(status) => return status,
                };
                let silent = heard.events == 0;
                match before.filter(|_| silent && self.may_have_passed(reached - lambda)) {
                    Some(before) => {
                        self.start = before;
                        if let Some(status) = self.ends_at_singular(lambda, &mut control) {
                            return status;
                        }
                    }
                    None => lambda = reached,
                }
            }
            if let Some(status) = self.system.budget.exhausted() {
                return status;
            }
        }
        if self.unstable { Status::Unstable } else { Status::Converged }
    }

    /// Moves `start` to the predicted end of the branch, so that the energy released from there is that of
    /// the jump alone.
    fn move_to_predicted_end(&mut self, to_end: f64) {
        self.predictor.displacement(to_end, &mut self.work);
        self.system.advance_from(&self.start, &self.work, 1.0);
        self.start.copy_from_slice(self.system.state());
    }

    /// Restarts prediction and step control at the current equilibrium, on another branch.
    pub(super) fn restart(&mut self, control: &mut StepControl) {
        if self.system.find_neutral(&self.rate) {
            self.arrive();
        }
        self.predictor.forget_curvature();
        control.restart();
        self.swap_ends();
    }

    /// The end of a sub-step becomes the beginning of the next.
    pub(super) fn swap_ends(&mut self) {
        self.velocity.swap(0, 1);
        self.change.swap(0, 1);
    }

    /// Takes velocity and displacement at the current equilibrium, with its factor.
    pub(super) fn arrive(&mut self) {
        self.change[1] = self.system.velocity(&self.rate, &mut self.velocity[1]);
        self.system.displacement(&self.start, &mut self.moved);
    }

    /// With ties, the loads with these closed; otherwise none.
    pub(super) fn with_closed_ties(&self, loads: &[&[f64]]) -> Vec<Vec<f64>> {
        if !self.system.has_ties() {
            return vec![];
        }
        loads.iter().map(|load| load.iter().copied().chain([1.0]).collect()).collect()
    }

    /// How much each input varies over the path.
    pub(super) fn set_ranges(&mut self, loads: &[&[f64]]) {
        for (input, range) in self.range.iter_mut().enumerate() {
            let values = loads.iter().map(|load| load[input]);
            *range = values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min);
        }
    }

    /// The range of the loads over the path as a multiple of the segment, for the input that changes most
    /// relative to its own range; constant inputs have no influence.
    pub(super) fn span(&self) -> f64 {
        let ranges = self.range.iter().zip(&self.rate).filter(|(_, rate)| **rate != 0.0);
        ranges.map(|(range, rate)| range / rate.abs()).fold(f64::INFINITY, f64::min)
    }

    /// Accuracy of the loads of limit points, as a fraction of the segment.
    pub(super) fn located(&self) -> f64 {
        self.options.locate.located * self.span()
    }

    /// Sets the segment from the current load to `target`. A known curvature is kept if the segment
    /// continues the last one in the same direction.
    fn set_segment(&mut self, target: &[f64]) {
        self.start_load.copy_from_slice(self.system.load());
        let (mut before, mut now, mut both) = (0.0, 0.0, 0.0);
        for ((r, t), s) in self.rate.iter_mut().zip(target).zip(&self.start_load) {
            let last = std::mem::replace(r, t - s);
            before += last * last;
            now += *r * *r;
            both += last * *r;
        }
        let parallel = both * both > (1.0 - PARALLEL) * before * now;
        self.predictor.rescale_curvature(if parallel { both / before } else { 0.0 });
    }

    /// Tries to move from the equilibrium in `start` over the sub-step `h` along the branch predicted. On
    /// success the state, factor, displacement and `velocity[1]` are those of the new equilibrium.
    fn correct(&mut self, h: f64, tolerance: CorrectorTolerance) -> bool {
        self.passage.crossed = false;
        self.system.set_state(&self.start);
        if !self.corrector.correct(&mut self.system, &self.predictor, h, tolerance) {
            return false;
        }
        if self.system.is_lost(ZERO_EIGENVALUE.max(max_norm(self.system.residual()))) {
            return false;
        }
        if !self.stays_regular() {
            return false;
        }
        self.arrive();
        let [before, after] = &self.velocity;
        let options = &self.options.same_branch;
        let longest =
            if self.system.switched_on() == self.switched_on { f64::INFINITY } else { options.longest_bend };
        let motion = PathMotion { rate: &self.rate, duration: h, velocities: [before, after] };
        is_same_branch(options, &self.predictor, h, &self.moved, [before, after], longest, &mut self.work)
            && self.system.stopped_while_loaded(&self.start, &self.moved, Some(motion)).is_none()
            && self.meets_no_branch(h)
    }

    /// Whether springs without contact make the tangent change fast with the state.
    fn is_sprung(&self) -> bool {
        let model = self.system.model();
        model.has_springs() && !model.has_switches()
    }

    /// The accuracy required of a sub-step of `h` that ends at `lambda`; at 1 the load is a listed one.
    fn tolerance_at(&self, lambda: f64, h: f64, step: LoadStep) -> CorrectorTolerance {
        if lambda == 1.0 {
            let tolerance = self.options.tolerance;
            let tangent_reuse = if self.is_sprung() { 0.0 } else { step.tangent_reuse };
            return CorrectorTolerance { residual: tolerance, tangent_reuse, stable: true };
        }
        let tangent_reuse = if self.is_sprung() { 0.0 } else { self.options.accuracy.tangent_reuse };
        CorrectorTolerance { residual: self.residual_between(h), tangent_reuse, stable: false }
    }

    /// The largest residual allowed after a sub-step of `h` that ends between the listed loads.
    pub(super) fn residual_between(&self, h: f64) -> f64 {
        let accuracy = &self.options.accuracy;
        // The end of a branch is located from the state before it.
        let ends = self.predictor.branch_end().is_finite();
        let share = if ends { accuracy.residual_near_end } else { accuracy.relative_residual };
        let allowed = (share * h * self.rate_of_change()).min(accuracy.max_residual);
        // Loops may move with next to no stiffness though each coordinate has its own.
        let loops = if self.system.has_ties() { self.options.closing.residual_share } else { 1.0 };
        (allowed * loops).max(self.options.tolerance)
    }

    /// The scale of residuals between the listed loads: the speed or, where the structure is softer than its
    /// units, as a column that buckles, the change of the load.
    pub(super) fn rate_of_change(&self) -> f64 {
        max_norm(&self.velocity[0]).min(self.change[0])
    }

    /// A stable equilibrium near the current state at the current load.
    pub(super) fn find_stable(&mut self, radius: f64, tangent_reuse: f64) -> Status {
        if self.system.is_stiff() {
            self.find_by_softening(radius);
        }
        self.find_stable_from_here(radius, tangent_reuse)
    }

    /// Goes to a stable equilibrium with softened terms, and from there close to one with their actual
    /// stiffness; if that fails, keeps the initial state unless the energy has become lower.
    fn find_by_softening(&mut self, radius: f64) {
        let start = self.system.state().to_vec();
        self.system.soften();
        let softer = self.find_stable_from_here(radius, 1.0);
        self.corrector.mixed.start(&mut self.system);
        let state = self.system.state().to_vec();
        self.system.harden();
        if softer != Status::Converged {
            let reached = self.system.evaluate();
            self.system.set_state(&start);
            if self.system.is_conservative() && reached < self.system.evaluate() {
                self.system.set_state(&state);
            }
        } else if self.corrector.mixed.approach(&mut self.system, self.options.mixed.reach).is_none() {
            self.system.set_state(&state);
        }
    }

    pub(super) fn find_stable_from_here(&mut self, radius: f64, tangent_reuse: f64) -> Status {
        if self.system.is_conservative() && self.system.has_ties() {
            self.find_tied(radius, tangent_reuse)
        } else {
            self.find_free(radius, tangent_reuse)
        }
    }

    /// The same without regard to ties.
    pub(super) fn find_free(&mut self, radius: f64, tangent_reuse: f64) -> Status {
        let tolerance = self.options.tolerance;
        if self.system.is_conservative() {
            let target = Target { tolerance, tangent_reuse };
            self.trust_region.minimize_energy(&mut self.system, radius, target)
        } else {
            self.damped_newton.solve(&mut self.system, tolerance)
        }
    }
}

/// Forwards everything, and counts events.
struct Heard<'s, S> {
    sink: &'s mut S,
    events: usize,
}

impl<G, S: PathSink<G, D, P>, const D: usize, const P: usize> PathSink<G, D, P> for Heard<'_, S> {
    fn step(&mut self, index: usize, report: StepReport, system: &System<G, D, P>) {
        self.sink.step(index, report, system);
    }

    fn event(&mut self, event: Event) {
        self.events += 1;
        self.sink.event(event);
    }
}
