//! Continuation: following an equilibrium along a list of loads with predictor and corrector.

use super::budget::{Budget, Cancel};
use super::corrector::{Corrector, CorrectorTolerance};
use super::critical::{CriticalPoint, CriticalSearch};
use super::damped_newton::DampedNewton;
use super::options::ContinuationOptions;
use super::path::{Event, EventKind, PathSink, StepReport};
use super::predictor::Predictor;
use super::same_branch::is_same_branch;
use super::stability::{NULL, Stability};
use super::status::Status;
use super::step_control::StepControl;
use super::system::System;
use super::trust_region::{Target, TrustRegion};
use super::vector::{dot, max_norm};
use crate::lie::LieGroup;
use crate::model::Model;

/// Finds and follows equilibria; owns all memory it needs.
#[derive(Clone, Debug)]
pub struct Continuation<'m, G, const D: usize, const P: usize> {
    pub(super) system: System<'m, G, D, P>,
    pub(super) predictor: Predictor<D, P>,
    pub(super) options: ContinuationOptions,
    corrector: Corrector,
    trust_region: TrustRegion,
    damped_newton: DampedNewton,
    critical: CriticalSearch,
    /// dq/dλ (dimensionless) at both ends of a sub-step.
    pub(super) velocity: [Vec<f64>; 2],
    /// Largest change of a residual with λ, at both.
    change: [f64; 2],
    /// The state at its beginning, and the displacement over it.
    start: Vec<f64>,
    moved: Vec<f64>,
    /// The load at the beginning of the segment between two listed loads, and its change over it.
    start_load: Vec<f64>,
    rate: Vec<f64>,
    /// Difference between the largest and the smallest value of each input over the path.
    range: Vec<f64>,
    work: Vec<f64>,
}

/// What lies ahead of the end of a branch.
#[derive(Clone, Copy, Debug)]
enum Lookahead {
    /// Stability is about to be lost.
    Critical(CriticalPoint),
    /// It is not.
    Definite,
    /// Some motion is held by nothing, and
    Neutral {
        /// whether the load acts on it.
        pulled: bool,
    },
}

/// The listed load that is being approached.
#[derive(Clone, Copy, Debug)]
struct LoadStep {
    index: usize,
    /// [`CorrectorTolerance::tangent_reuse`] there: zero where the path ends, as there the tangent must be
    /// that of the very state.
    tangent_reuse: f64,
}

impl<'m, G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'m, G, D, P> {
    /// For `model`, with the model's own parameters. Solves end soon after `cancel` is requested.
    pub fn new(
        model: &'m Model<G, D, P>,
        options: ContinuationOptions,
        cancel: Option<&'m dyn Cancel>,
    ) -> Self {
        debug_assert_eq!(options.validate(), Ok(()));
        let (n, inputs) = (model.dof(), model.inputs().len());
        let zeros = || vec![0.0; n];
        Self {
            system: System::new(model, Budget::new(&options, cancel)),
            predictor: Predictor::new(model, options.predictor),
            options,
            corrector: Corrector::new(options.corrector, options.newton, n),
            trust_region: TrustRegion::new(options.trust_region, options.newton, n),
            damped_newton: DampedNewton::new(options.damped_newton, n),
            critical: CriticalSearch::new(options.critical, n),
            velocity: [zeros(), zeros()],
            change: [0.0; 2],
            start: zeros(),
            moved: zeros(),
            start_load: vec![0.0; inputs],
            rate: vec![0.0; inputs],
            range: vec![0.0; inputs],
            work: zeros(),
        }
    }

    /// Takes over a vector of parameters; `false` when they are not admissible.
    pub fn set_parameters(&mut self, parameters: &[f64]) -> bool {
        let admissible = self.system.model().is_admissible(parameters);
        if admissible {
            self.system.set_parameters(parameters);
        }
        admissible
    }

    /// Solves at `loads[0]` from the state `q0` and follows the equilibrium to each further load.
    ///
    /// Every load gets a report. After a failure the rest are [`Status::NotReached`].
    ///
    /// # Panics
    /// If a load or `q0` has the wrong length.
    pub fn follow(&mut self, loads: &[&[f64]], q0: &[f64], sink: &mut impl PathSink<G, D, P>) {
        self.set_ranges(loads);
        self.system.set_state(q0);
        self.system.measure_units(loads);
        self.predictor.forget_curvature();
        self.rate.fill(0.0);
        let mut status = Status::Converged;
        for (index, target) in loads.iter().enumerate() {
            self.system.budget.restart();
            if status.is_equilibrium() {
                let last = loads[index..].iter().all(|later| later == target);
                let tangent_reuse = if last { 0.0 } else { self.options.accuracy.tangent_reuse_at_listed };
                let step = LoadStep { index, tangent_reuse };
                status = if index == 0 {
                    self.system.set_load(target);
                    self.find_stable(self.options.trust_region.initial_radius, tangent_reuse)
                } else {
                    self.follow_segment(target, step, sink)
                };
            } else {
                status = Status::NotReached;
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
            let report = StepReport { status, q, iterations, stability, accuracy, free: &free };
            sink.step(index, report, &self.system);
        }
    }

    /// From the equilibrium at the current load to the one at `target`, in sub-steps.
    fn follow_segment(
        &mut self,
        target: &[f64],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        self.set_segment(target);
        if max_norm(&self.rate) == 0.0 {
            return Status::Converged;
        }
        let max_displacement = if !self.system.model().has_switches() {
            self.options.max_displacement
        } else {
            self.options.max_displacement_with_contact
        };
        let mut control = StepControl::new(self.options.step, self.smallest_step());
        // The factor at hand belongs to the equilibrium just found.
        self.change[0] = self.system.velocity(&self.rate, &mut self.velocity[0]);
        let mut status = Status::Converged;
        let mut lambda = 0.0;
        while lambda < 1.0 {
            self.start.copy_from_slice(self.system.state());
            let ahead = control.target() - lambda;
            let reach = self.predictor.predict(&mut self.system, &self.velocity[0], ahead, max_displacement);
            let mut next = control.propose(lambda, reach, self.predictor.branch_end());
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
                control.accept(next);
                status = Status::Converged;
            } else {
                status = self.jump_to_stable(lambda, next, step, sink);
                if !status.is_equilibrium() {
                    return status;
                }
                self.predictor.forget_curvature();
                control.restart();
            }
            if let Some(status) = self.system.budget.exhausted() {
                return status;
            }
            lambda = next;
            self.velocity.swap(0, 1);
            self.change.swap(0, 1);
        }
        status
    }

    /// How much each input varies over the path.
    fn set_ranges(&mut self, loads: &[&[f64]]) {
        for (input, range) in self.range.iter_mut().enumerate() {
            let values = loads.iter().map(|load| load[input]);
            *range = values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min);
        }
    }

    /// The smallest sub-step of the segment: that of the input which it changes most, measured by the
    /// range of that input alone, so that what another one is held at does not matter.
    fn smallest_step(&self) -> f64 {
        let steps = self.range.iter().zip(&self.rate).filter(|(_, rate)| **rate != 0.0);
        steps.map(|(range, rate)| self.options.min_step * range / rate.abs()).fold(1.0, f64::min)
    }

    /// Sets the segment from the current load to `target`. A curvature that is known holds for it if it
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
        let parallel = both * both > (1.0 - 1e-12) * before * now;
        self.predictor.rescale_curvature(if parallel { both / before } else { 0.0 });
    }

    /// Tries to move from the equilibrium in `start` over the sub-step `h` along the branch predicted. On
    /// success the state, factor, displacement and `velocity[1]` are those of the new equilibrium.
    fn correct(&mut self, h: f64, tolerance: CorrectorTolerance) -> bool {
        self.system.set_state(&self.start);
        if !self.corrector.correct(&mut self.system, &self.predictor, h, tolerance) {
            return false;
        }
        if self.system.is_lost(NULL.max(max_norm(self.system.residual()))) {
            return false;
        }
        self.change[1] = self.system.velocity(&self.rate, &mut self.velocity[1]);
        self.system.displacement(&self.start, &mut self.moved);
        let [before, after] = &self.velocity;
        let options = &self.options.same_branch;
        is_same_branch(options, &self.predictor, h, &self.moved, [before, after], &mut self.work)
    }

    /// What is asked of a sub-step of `h` that ends at `lambda`; at 1 the load is a listed one.
    fn tolerance_at(&self, lambda: f64, h: f64, step: LoadStep) -> CorrectorTolerance {
        let tolerance = self.options.tolerance;
        if lambda == 1.0 {
            return CorrectorTolerance { residual: tolerance, tangent_reuse: step.tangent_reuse };
        }
        let accuracy = &self.options.accuracy;
        let predicted = accuracy.relative_residual * h * self.rate_of_change();
        let residual = predicted.min(accuracy.max_residual).max(tolerance);
        CorrectorTolerance { residual, tangent_reuse: accuracy.tangent_reuse }
    }

    /// What residuals between the listed loads are measured by: the speed, and where the tangent may be softer
    /// than its units the change of the load as well.
    fn rate_of_change(&self) -> f64 {
        let speed = max_norm(&self.velocity[0]);
        if self.system.is_elastic() { speed } else { speed.min(self.change[0]) }
    }

    /// From the end of the branch, in `start` at `from`, to a stable equilibrium at `lambda`.
    fn jump_to_stable(
        &mut self,
        from: f64,
        lambda: f64,
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        let radius = self.options.jump.initial_radius;
        self.system.set_state(&self.start);
        let at_listed = lambda == 1.0;
        let tangent_reuse =
            if at_listed { step.tangent_reuse } else { self.options.accuracy.tangent_reuse_after_jump };
        self.system.evaluate();
        let energy = self.system.data().energy();
        let status = self.find_stable(radius, tangent_reuse);
        if !status.is_equilibrium() {
            return status;
        }
        let released = (energy - self.system.data().energy()) / self.system.unit_energy();
        self.change[1] = self.system.velocity(&self.rate, &mut self.velocity[1]);
        self.system.displacement(&self.start, &mut self.moved);
        if !self.has_left(lambda - from) {
            return status;
        }
        let ahead = self.look_back(from, lambda);
        let at = match ahead {
            Lookahead::Critical(point) => (from + point.distance).min(lambda),
            _ => lambda,
        };
        if let Some(kind) = self.classify(ahead, released, at, from, lambda) {
            let after = self.system.state().to_vec();
            self.system.set_load_between(&self.start_load, &self.rate, at);
            let (load, before) = (self.system.load(), &self.start[..]);
            sink.event(Event { step: step.index, kind, load, before, after: &after });
            self.system.set_load_between(&self.start_load, &self.rate, lambda);
        }
        status
    }

    /// Whether the state found is further away than the velocity at the end of the branch explains.
    fn has_left(&self, h: f64) -> bool {
        let jump = self.options.jump;
        let before = jump.speed_margin * h * max_norm(&self.velocity[0]);
        let explained = jump.min_displacement + jump.speed_margin * h * self.ordinary_speed();
        max_norm(&self.moved) > explained.min(before + 1e-2 * jump.min_displacement)
    }

    /// Whether stability was about to be lost at the end of the branch, in `start` at `from`; comes back to
    /// the state found at `lambda`.
    fn look_back(&mut self, from: f64, lambda: f64) -> Lookahead {
        let found = self.system.state().to_vec();
        self.system.set_load_between(&self.start_load, &self.rate, from);
        self.system.set_state(&self.start);
        let critical = self.critical.find(&mut self.system, &self.velocity[0], &self.rate, lambda - from);
        let ahead = if self.critical.is_neutral() {
            self.system.set_state(&self.start);
            self.system.set_load_between(&self.start_load, &self.rate, lambda);
            self.system.evaluate();
            Lookahead::Neutral { pulled: self.system.pulls_free_motion(self.options.tolerance) }
        } else {
            critical.map_or(Lookahead::Definite, Lookahead::Critical)
        };
        self.return_to(&found, lambda);
        ahead
    }

    /// Goes back to an equilibrium at `lambda`, with its tangent and factor.
    fn return_to(&mut self, state: &[f64], lambda: f64) {
        self.system.set_load_between(&self.start_load, &self.rate, lambda);
        self.system.set_state(state);
        self.system.evaluate();
        self.system.evaluate_tangent();
        self.system.factorise(0.0);
    }

    /// What happened between `start`, at `from`, and the stable equilibrium found at `lambda`, `moved`
    /// away, the critical load being that at `at`.
    fn classify(
        &mut self,
        ahead: Lookahead,
        released: f64,
        at: f64,
        from: f64,
        lambda: f64,
    ) -> Option<EventKind> {
        let jump = self.options.jump;
        let (moved, h) = (max_norm(&self.moved), lambda - from);
        let [before, after] = [0, 1].map(|end| max_norm(&self.velocity[end]));
        let unexplained = |speed: f64| moved > jump.min_displacement + jump.speed_margin * h * speed;
        match ahead {
            Lookahead::Neutral { pulled: true } => None,
            Lookahead::Critical(point) if point.distance <= 2.0 * h && !point.bifurcation => {
                unexplained(self.ordinary_speed()).then_some(EventKind::Snap)
            }
            Lookahead::Critical(point) if point.distance <= 2.0 * h => {
                let switched = moved > jump.speed_margin * h * before + 1e-2 * jump.min_displacement;
                if !switched {
                    None
                } else if !self.is_constant(at, from, lambda) {
                    Some(EventKind::Bifurcation)
                } else {
                    self.releases_energy(released, h).then_some(EventKind::Snap)
                }
            }
            _ => {
                let jumps = unexplained(before.max(after)) && self.releases_energy(released, h);
                jumps.then_some(EventKind::Snap)
            }
        }
    }

    /// Whether the energy released is more than the load's work on a branch over `h`, which is all that
    /// there is as long as the energy is convex; to drift along a motion that nothing holds takes none.
    /// Without a potential, whether there is no such motion.
    fn releases_energy(&mut self, released: f64, h: f64) -> bool {
        if !self.system.is_conservative() {
            return self.critical.eigenvalue() > self.options.critical.drift;
        }
        self.system.load_gradient(&self.rate, &mut self.work);
        let work_rate = dot(&self.work, &self.velocity[1]).abs().max(self.critical.work_rate());
        released > self.options.jump.energy_margin * 0.5 * h * h * work_rate
    }

    /// Whether the displacement from `start` is much the same right behind the critical load, at `at`, as at
    /// `lambda`: a jump, not a motion along a new branch.
    fn is_constant(&mut self, at: f64, from: f64, lambda: f64) -> bool {
        let jump = self.options.jump;
        let begin = if at < lambda { at } else { from };
        let found = self.system.state().to_vec();
        let moved = max_norm(&self.moved);
        let earlier = begin + jump.earlier * (lambda - begin);
        self.system.set_load_between(&self.start_load, &self.rate, earlier);
        self.system.set_state(&self.start);
        let status = self.find_stable(jump.initial_radius, 0.0);
        self.system.displacement(&self.start, &mut self.work);
        let constant = status.is_equilibrium() && max_norm(&self.work) >= jump.constant_share * moved;
        self.return_to(&found, lambda);
        constant
    }

    /// Largest speed that a branch without a fold has between the velocities at both ends.
    fn ordinary_speed(&self) -> f64 {
        let [before, after] = [0, 1].map(|end| max_norm(&self.velocity[end]));
        // Towards a fold the speed grows without bound; behind it, it does not.
        let most = self.options.jump.max_speed_ratio * after;
        if before <= most { before.max(after) } else { most }
    }

    /// A stable equilibrium near the current state at the current load.
    pub(super) fn find_stable(&mut self, radius: f64, tangent_reuse: f64) -> Status {
        let tolerance = self.options.tolerance;
        if self.system.is_conservative() {
            let target = Target { tolerance, tangent_reuse };
            self.trust_region.minimize_energy(&mut self.system, radius, target)
        } else {
            self.damped_newton.solve(&mut self.system, tolerance)
        }
    }
}
