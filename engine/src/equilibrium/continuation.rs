//! Continuation: following an equilibrium along a list of loads with predictor and corrector.

use super::corrector::{Corrector, CorrectorTolerance};
use super::damped_newton::DampedNewton;
use super::options::ContinuationOptions;
use super::path::{Event, EventKind, PathSink, StepReport};
use super::predictor::Predictor;
use super::same_branch::is_same_branch;
use super::status::Status;
use super::step_control::StepControl;
use super::system::System;
use super::trust_region::{Target, TrustRegion};
use super::vector::max_norm;
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
    /// dq/dλ (dimensionless) at both ends of a sub-step.
    pub(super) velocity: [Vec<f64>; 2],
    /// The state at its beginning, and the displacement over it.
    start: Vec<f64>,
    moved: Vec<f64>,
    /// The load at the beginning of the segment between two listed loads, and its change over it.
    start_load: Vec<f64>,
    rate: Vec<f64>,
    work: Vec<f64>,
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
    /// For `model`, with the model's own parameters.
    pub fn new(model: &'m Model<G, D, P>, options: ContinuationOptions) -> Self {
        debug_assert_eq!(options.validate(), Ok(()));
        let (n, inputs) = (model.dof(), model.inputs().len());
        let zeros = || vec![0.0; n];
        Self {
            system: System::new(model),
            predictor: Predictor::new(model, options.predictor),
            options,
            corrector: Corrector::new(options.corrector, options.newton, n),
            trust_region: TrustRegion::new(options.trust_region, options.newton, n),
            damped_newton: DampedNewton::new(options.damped_newton, n),
            velocity: [zeros(), zeros()],
            start: zeros(),
            moved: zeros(),
            start_load: vec![0.0; inputs],
            rate: vec![0.0; inputs],
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
        let largest_load = loads.iter().flat_map(|l| l.iter()).fold(0.0f64, |m, u| m.max(u.abs()));
        self.system.set_state(q0);
        self.predictor.forget_curvature();
        self.rate.fill(0.0);
        let mut status = Status::Converged;
        for (index, target) in loads.iter().enumerate() {
            let before = self.system.iterations();
            if status.is_equilibrium() {
                let last = loads[index..].iter().all(|later| later == target);
                let tangent_reuse = if last { 0.0 } else { self.options.accuracy.tangent_reuse_at_listed };
                let step = LoadStep { index, tangent_reuse };
                status = if index == 0 {
                    self.system.set_load(target);
                    self.find_stable(self.options.trust_region.initial_radius, tangent_reuse)
                } else {
                    self.follow_segment(target, step, largest_load, sink)
                };
            } else {
                status = Status::NotReached;
            }
            let iterations = self.system.iterations() - before;
            let residual = max_norm(self.system.residual());
            let report = StepReport { status, q: self.system.state(), iterations, residual };
            sink.step(index, report, &self.system);
        }
    }

    /// From the equilibrium at the current load to the one at `target`, in sub-steps.
    fn follow_segment(
        &mut self,
        target: &[f64],
        step: LoadStep,
        largest_load: f64,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        self.set_segment(target);
        let span = max_norm(&self.rate);
        if span == 0.0 {
            return Status::Converged;
        }
        let first = self.system.iterations();
        let max_displacement = if !self.system.model().has_switches() {
            self.options.max_displacement
        } else {
            self.options.max_displacement_with_contact
        };
        let smallest = (self.options.min_step * largest_load / span).min(1.0);
        let mut control = StepControl::new(self.options.step, smallest);
        // The factor at hand belongs to the equilibrium just found.
        self.system.velocity(&self.rate, &mut self.velocity[0]);
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
                if self.system.iterations() - first > self.options.max_iterations {
                    return Status::IterationLimit;
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
                status = self.jump_to_stable(next, next - lambda, step, sink);
                if !status.is_equilibrium() {
                    return status;
                }
                self.predictor.forget_curvature();
                control.restart();
            }
            if self.system.iterations() - first > self.options.max_iterations {
                return Status::IterationLimit;
            }
            lambda = next;
            self.velocity.swap(0, 1);
        }
        status
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
        self.system.velocity(&self.rate, &mut self.velocity[1]);
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
        let predicted = accuracy.relative_residual * h * max_norm(&self.velocity[0]);
        let residual = predicted.min(accuracy.max_residual).max(tolerance);
        CorrectorTolerance { residual, tangent_reuse: accuracy.tangent_reuse }
    }

    /// From the end of the branch, in `start`, to a stable equilibrium at `lambda`, a sub-step `h` later.
    /// It is a snap if that lies further away than the velocities at both ends explain.
    fn jump_to_stable(
        &mut self,
        lambda: f64,
        h: f64,
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        let jump = self.options.jump;
        self.system.set_state(&self.start);
        let at_listed = lambda == 1.0;
        let tangent_reuse =
            if at_listed { step.tangent_reuse } else { self.options.accuracy.tangent_reuse_after_jump };
        let status = self.find_stable(jump.initial_radius, tangent_reuse);
        if status.is_equilibrium() {
            self.system.velocity(&self.rate, &mut self.velocity[1]);
            self.system.displacement(&self.start, &mut self.moved);
            let explained = jump.speed_margin * h * self.ordinary_speed();
            if max_norm(&self.moved) > jump.min_displacement + explained {
                let (load, before, after) = (self.system.load(), &self.start[..], self.system.state());
                sink.event(Event { step: step.index, kind: EventKind::Snap, load, before, after });
            }
        }
        status
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
        let (tolerance, max_iterations) = (self.options.tolerance, self.options.max_iterations);
        if self.system.is_conservative() {
            let target = Target { tolerance, tangent_reuse, max_iterations };
            self.trust_region.minimize_energy(&mut self.system, radius, target)
        } else {
            self.damped_newton.solve(&mut self.system, tolerance, max_iterations)
        }
    }
}
