//! Steps of a load with friction.
//!
//! In the equilibrium found with the normal forces held, these and the planes of contact are renewed, and the
//! step is solved again from there, until the renewed ones leave it an equilibrium.

use super::continuation::{Continuation, LoadStep};
use super::corrector::CorrectorTolerance;
use super::path::{Event, EventKind, PathSink, StepReport};
use super::status::Status;
use super::system::System;
use super::vector::max_norm;
use crate::forces::friction::FrictionMemory;
use crate::lie::LieGroup;
use crate::results::PathFriction;

/// Relative distance from the limit, beyond rounding, at which points that slide begin the next step.
const BEYOND_LIMIT: f64 = 1e-12;

/// What a step with friction begins with.
#[derive(Clone, Debug)]
struct StepStart<const P: usize> {
    q: Vec<f64>,
    load: Vec<f64>,
    unstable: bool,
    memory: FrictionMemory<P>,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> System<'_, G, D, P> {
    /// Whether the model has friction.
    pub(super) fn has_friction(&self) -> bool {
        self.model.friction_count() > 0
    }

    /// Begins a path in the current state, in which points have slipped like these, and others not yet.
    pub(super) fn begin_friction(&mut self, slips: &[PathFriction]) {
        self.data.recall_friction(FrictionMemory::default());
        self.renew_friction();
        slips.iter().for_each(|slip| self.data.set_slip(self.model, slip));
    }

    /// Renews what friction holds in a step in the current state.
    fn renew_friction(&mut self) {
        self.evaluate();
        self.data.renew_friction(self.model);
    }

    /// Ends a step in the current equilibrium, and factorises the tangent with which the next one begins:
    /// points that slide go on sliding or, if that leaves a motion without stiffness, stick.
    fn end_friction_step(&mut self) {
        self.evaluate();
        self.data.give_up_slip(self.model, BEYOND_LIMIT);
        self.evaluate();
        self.evaluate_tangent();
        if !self.factorise(0.0) && self.is_conservative() {
            self.data.give_up_slip(self.model, -BEYOND_LIMIT);
            self.evaluate();
            self.evaluate_tangent();
            self.factorise(0.0);
        }
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'_, G, D, P> {
    /// What the next step begins with, of a model with friction.
    fn step_start(&self) -> Option<StepStart<P>> {
        self.system.has_friction().then(|| StepStart {
            q: self.system.state().to_vec(),
            load: self.system.load().to_vec(),
            unstable: self.unstable,
            memory: self.system.data().friction_memory().clone(),
        })
    }

    /// Finds an equilibrium at the first load from the current state; with friction, where that fails in the
    /// contacts of this state, first one without.
    pub(super) fn begin_with_friction(
        &mut self,
        target: &[f64],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        if !self.system.has_friction() {
            return self.begin(target, step, sink);
        }
        let start = self.system.state().to_vec();
        let mut events = Deferred::default();
        let status = self.begin(target, step, &mut events);
        let status = self.settle_friction(status, target, step, &mut events);
        if status.is_equilibrium() || self.system.budget.exhausted().is_some() {
            events.release(step, sink);
            return status;
        }
        self.system.set_state(&start);
        self.system.data_mut().recall_friction(FrictionMemory::default());
        let mut events = Deferred::default();
        let again = self.begin(target, step, &mut events);
        let again = self.settle_friction(again, target, step, &mut events);
        if again.is_equilibrium() {
            events.release(step, sink);
            return again;
        }
        status
    }

    /// Follows the branch to a listed load; with friction, where that fails because too little holds the
    /// bodies, on the assumption that all points stick.
    pub(super) fn follow_with_friction(
        &mut self,
        target: &[f64],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        let Some(start) = self.step_start() else { return self.follow_to(target, step, sink) };
        let mut events = Deferred::default();
        let status = self.follow_to(target, step, &mut events);
        let status = self.settle_friction(status, target, step, &mut events);
        if status.is_equilibrium() || self.system.budget.exhausted().is_some() {
            events.release(step, sink);
            return status;
        }
        self.unstable = start.unstable;
        self.predictor.forget_curvature();
        self.system.restart_friction_step(start);
        let mut events = Deferred::default();
        let again = self.follow_to(target, step, &mut events);
        let again = self.settle_friction(again, target, step, &mut events);
        if again.is_equilibrium() {
            events.release(step, sink);
            return again;
        }
        status
    }

    /// Continues from an equilibrium found with normal forces held to one with its own.
    pub(super) fn settle_friction(
        &mut self,
        mut status: Status,
        target: &[f64],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        if !self.system.has_friction() {
            return status;
        }
        let reach = self.options.max_displacement_with_contact;
        let residual = self.options.tolerance;
        let tolerance = CorrectorTolerance { residual, tangent_reuse: step.tangent_reuse, least_pivots: 0.0 };
        for _ in 0..self.options.friction.max_rounds {
            if !status.is_equilibrium() {
                return status;
            }
            if let Some(status) = self.system.budget.exhausted() {
                return status;
            }
            self.start.copy_from_slice(self.system.state());
            self.system.renew_friction();
            let size = self.system.evaluate();
            if self.system.has_converged(size, residual) || self.system.is_balanced(residual) {
                return status;
            }
            if !self.corrector.iterate(&mut self.system, size, reach, tolerance) {
                self.system.set_state(&self.start);
                status = self.find_stable_from_here(self.options.friction.radius, step.tangent_reuse);
                self.unstable = status == Status::Unstable;
                self.system.displacement(&self.start, &mut self.moved);
                if status.is_equilibrium() && max_norm(&self.moved) > reach && self.crosses_a_barrier() {
                    let (load, after) = (self.system.input_loads(), self.system.state());
                    let (step, kind) = (step.index, EventKind::Snap);
                    sink.event(Event { step, kind, load, before: &self.start, after });
                }
            } else if status == Status::Unstable {
                status = Status::Converged;
                self.unstable = false;
            }
            status = self.hold(status, target, step, sink);
        }
        Status::Stalled
    }

    /// Ends a step whose equilibrium has been reported.
    pub(super) fn end_friction_step(&mut self) {
        self.system.end_friction_step();
        self.predictor.forget_curvature();
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> System<'_, G, D, P> {
    /// Begins a step again, with every point that touches sticking.
    fn restart_friction_step(&mut self, start: StepStart<P>) {
        self.set_load(&start.load);
        self.set_state(&start.q);
        self.data.recall_friction(start.memory);
        self.data.stick(self.model);
        self.evaluate();
        self.evaluate_tangent();
        self.factorise(0.0);
    }
}

/// Keeps events until it is known whether the step that they belong to is kept.
#[derive(Debug, Default)]
struct Deferred(Vec<(EventKind, [Vec<f64>; 3])>);

impl Deferred {
    fn release<G, const D: usize, const P: usize>(self, step: LoadStep, sink: &mut impl PathSink<G, D, P>) {
        for (kind, [load, before, after]) in self.0 {
            sink.event(Event { step: step.index, kind, load: &load, before: &before, after: &after });
        }
    }
}

impl<G, const D: usize, const P: usize> PathSink<G, D, P> for Deferred {
    fn step(&mut self, _: usize, _: StepReport, _: &System<G, D, P>) {}

    fn event(&mut self, event: Event) {
        let Event { kind, load, before, after, .. } = event;
        self.0.push((kind, [load, before, after].map(<[f64]>::to_vec)));
    }
}
