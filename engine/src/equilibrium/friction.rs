//! Steps of a load with friction.
//!
//! With the normal forces and planes of contact held with which a step begins, the branch is followed to the listed
//! load; from there friction [settles](super::settling). A step that fails is tried in other ways, and then in halves.

use super::continuation::{Continuation, LoadStep};
use super::path::{Event, EventKind, PathSink, StepReport};
use super::status::Status;
use super::system::System;
use crate::friction::PathMemory;
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
    memory: PathMemory<P>,
}

/// A load between two listed ones at which friction had to settle.
#[derive(Clone, Debug)]
pub(crate) struct FrictionSubstep<const P: usize> {
    /// Index of the listed load that is approached.
    pub step: usize,
    /// How much of the way from the one before.
    pub share: f64,
    pub q: Vec<f64>,
    pub applied: Vec<f64>,
    pub memory: PathMemory<P>,
}

/// How a step is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Attempt {
    /// With what friction holds in the state in which it begins.
    Plain,
    /// At first with all points that touch, or rest on what they may touch, sticking.
    Sticking,
    /// From an equilibrium without friction.
    Smooth,
    /// From there, none of its points having slipped.
    Unslipped,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> System<'_, G, D, P> {
    /// Whether the model has friction.
    pub(super) fn has_friction(&self) -> bool {
        self.model.friction_count() > 0
    }

    /// Begins a path in the current state, in which points have slipped like these, and others not yet.
    pub(super) fn begin_friction(&mut self, slips: &[PathFriction]) {
        self.data.recall_friction(PathMemory::default());
        self.renew_friction();
        self.data.begin_friction_step(self.model, slips);
    }

    /// Renews what friction holds in a step in the current state, and returns the largest residual there.
    pub(super) fn renew_friction(&mut self) -> f64 {
        self.evaluate();
        self.data.renew_friction(self.model);
        self.evaluate()
    }

    /// Factorises the tangent of the current state, in which friction was renewed, with the change of what is
    /// renewed; whether its determinant is positive.
    pub(super) fn factorise_renewed(&mut self) -> bool {
        self.evaluate_tangent();
        self.data.complete_tangent(self.model);
        self.data.complete_columns(self.model);
        if let Some(work) = &mut self.renewal {
            self.data.add_renewal(self.model, work);
        }
        let projection = self.is_projected().then_some(&self.projection);
        self.factor.project(&self.data, projection);
        self.factor.factorise_renewed(&self.data)
    }

    /// Goes to an equilibrium of a path, with what friction held there, and factorises its tangent with friction
    /// renewed, for adjoints; `false` if that cannot be.
    pub(crate) fn revisit_step(&mut self, q: &[f64], applied: &[f64], memory: &PathMemory<P>) -> bool {
        self.data.recall_friction(memory.clone());
        let found = self.revisit(q, applied);
        self.factor.solve_adjoints_renewed();
        self.factorise_renewed() && found
    }

    /// Goes to where a path starts; whether its first step with friction begins there.
    pub(crate) fn revisit_start(&mut self, q: &[f64], first: &PathMemory<P>) -> bool {
        self.data.recall_friction(PathMemory::default());
        self.set_state(q);
        self.evaluate();
        self.data.begins_here(self.model, first)
    }

    /// Ends a step in the current equilibrium, and factorises the tangent with which the next one begins:
    /// points that slide go on sliding or, if that leaves a motion without stiffness, stick.
    fn end_friction_step(&mut self) {
        for excess in [BEYOND_LIMIT, -BEYOND_LIMIT] {
            self.evaluate();
            self.data.end_friction_step(self.model, excess);
            self.evaluate();
            self.evaluate_tangent();
            if self.factorise(0.0) || !self.is_conservative() {
                return;
            }
        }
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'_, G, D, P> {
    /// Finds an equilibrium at the first load of a path from the current state.
    pub(super) fn begin_with_friction(
        &mut self,
        target: &[f64],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        if !self.system.has_friction() {
            return self.begin(target, step, sink);
        }
        let attempts = [Attempt::Plain, Attempt::Sticking, Attempt::Smooth, Attempt::Unslipped];
        let mut events = Deferred::default();
        let status = self.try_in_turn(&attempts, target, step, &mut events);
        events.release(step, sink);
        status
    }

    /// Follows the branch from one listed load to the next.
    pub(super) fn follow_with_friction(
        &mut self,
        [from, target]: [&[f64]; 2],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        if !self.system.has_friction() {
            return self.follow_to(target, step, sink);
        }
        let (start, mut events) = (self.step_start(), Deferred::default());
        let status = self.follow_in_parts([from, target], [0.0, 1.0], step, &mut events);
        if status.is_equilibrium() && events.happen_at(target) {
            self.locate_events(start, [from, target], step, &mut events);
        }
        events.release(step, sink);
        status
    }

    /// Locates an event that settling friction met at the end of a step, by halves of the step: a motion that shorter
    /// steps make without an event is none. The equilibrium found remains.
    fn locate_events(
        &mut self,
        mut start: StepStart<P>,
        [from, target]: [&[f64]; 2],
        step: LoadStep,
        events: &mut Deferred,
    ) {
        let (found, substeps) = (self.step_start(), self.friction_substeps.len());
        let load = |share: f64| -> Vec<f64> {
            from.iter().zip(target).map(|(a, b)| (1.0 - share) * a + share * b).collect()
        };
        let attempts = [Attempt::Plain, Attempt::Sticking];
        let (mut begin, mut end) = (0.0, 1.0);
        let mut located = Some(Deferred::default());
        for _ in 0..self.options.friction.max_halvings_of_load {
            let middle = 0.5 * (begin + end);
            self.go_back(&start);
            let mut heard = Deferred::default();
            if !self.try_in_turn(&attempts, &load(middle), step, &mut heard).is_equilibrium() {
                located = None;
                break;
            }
            if heard.0.is_empty() {
                self.end_friction_step();
                (start, begin) = (self.step_start(), middle);
                if !self.try_in_turn(&attempts, &load(end), step, &mut heard).is_equilibrium() {
                    located = None;
                    break;
                }
            } else {
                end = middle;
            }
            let none = heard.0.is_empty();
            located = Some(heard);
            if none {
                break;
            }
        }
        self.friction_substeps.truncate(substeps);
        self.go_back(&found);
        let (size, tolerance) = (self.system.renew_friction(), self.options.tolerance);
        let _ = self.system.has_converged(size, tolerance) || self.system.is_balanced(tolerance);
        if let Some(located) = located {
            events.0.retain(|(_, [at, ..])| at[..] != target[..at.len()]);
            events.0.extend(located.0);
        }
    }

    /// Follows the branch in one step or, if friction does not settle, in two, and so on.
    fn follow_in_parts(
        &mut self,
        [from, target]: [&[f64]; 2],
        [begin, end]: [f64; 2],
        step: LoadStep,
        events: &mut Deferred,
    ) -> Status {
        let start = self.step_start();
        let status = self.try_in_turn(&[Attempt::Plain, Attempt::Sticking], target, step, events);
        let smallest = 0.5f64.powi(self.options.friction.max_halvings_of_load as i32);
        if status != Status::Stalled || end - begin <= smallest || self.system.budget.exhausted().is_some() {
            return status;
        }
        self.go_back(&start);
        let (known, substeps) = (events.0.len(), self.friction_substeps.len());
        let middle: Vec<f64> = from.iter().zip(target).map(|(a, b)| 0.5 * (a + b)).collect();
        let share = 0.5 * (begin + end);
        let mut again = self.follow_in_parts([from, &middle], [begin, share], step, events);
        if again.is_equilibrium() {
            self.friction_substeps.push(FrictionSubstep {
                step: step.index,
                share,
                q: self.system.state().to_vec(),
                applied: self.system.applied_load().to_vec(),
                memory: self.system.data().friction_memory(),
            });
            self.end_friction_step();
            again = self.follow_in_parts([&middle, target], [share, end], step, events);
        }
        if again.is_equilibrium() {
            return again;
        }
        events.0.truncate(known);
        self.friction_substeps.truncate(substeps);
        status
    }

    /// What the next step begins with.
    fn step_start(&self) -> StepStart<P> {
        StepStart {
            q: self.system.state().to_vec(),
            load: self.system.load().to_vec(),
            unstable: self.unstable,
            memory: self.system.data().friction_memory(),
        }
    }

    /// Goes to a listed load in one of these ways, the first that succeeds; otherwise, what the first came to.
    fn try_in_turn(
        &mut self,
        attempts: &[Attempt],
        target: &[f64],
        step: LoadStep,
        sink: &mut Deferred,
    ) -> Status {
        let start = self.step_start();
        let mut first = None;
        for attempt in attempts {
            if first.is_some() {
                self.go_back(&start);
            }
            let known = sink.0.len();
            let status = self.attempt(*attempt, &start, target, step, sink);
            if status.is_equilibrium() || self.system.budget.exhausted().is_some() {
                return status;
            }
            sink.0.truncate(known);
            first.get_or_insert(status);
        }
        first.unwrap_or(Status::Stalled)
    }

    fn attempt(
        &mut self,
        attempt: Attempt,
        start: &StepStart<P>,
        target: &[f64],
        step: LoadStep,
        events: &mut Deferred,
    ) -> Status {
        match attempt {
            Attempt::Plain => {}
            Attempt::Sticking => self.system.stick(),
            Attempt::Smooth | Attempt::Unslipped => {
                self.system.data_mut().recall_friction(PathMemory::default());
            }
        }
        let status = if step.index == 0 {
            self.begin(target, step, events)
        } else {
            self.follow_to(target, step, events)
        };
        if attempt == Attempt::Smooth {
            self.system.data_mut().recall_friction(start.memory.clone());
        }
        self.settle_friction(status, &start.q, target, step, events)
    }

    /// Goes back to where a step began.
    fn go_back(&mut self, start: &StepStart<P>) {
        self.unstable = start.unstable;
        self.predictor.forget_curvature();
        self.system.set_load(&start.load);
        self.system.set_state(&start.q);
        self.system.data_mut().recall_friction(start.memory.clone());
        self.system.evaluate();
        self.system.evaluate_tangent();
        self.system.factorise(0.0);
    }

    /// Ends a step whose equilibrium has been reported.
    pub(super) fn end_friction_step(&mut self) {
        self.system.end_friction_step();
        self.predictor.forget_curvature();
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> System<'_, G, D, P> {
    /// Lets every point that touches stick.
    fn stick(&mut self) {
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
    /// Whether one of them is at a load.
    fn happen_at(&self, load: &[f64]) -> bool {
        self.0.iter().any(|(_, [at, ..])| at[..] == load[..at.len()])
    }

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
