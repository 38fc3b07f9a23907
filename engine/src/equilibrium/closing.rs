//! The first equilibrium of a model with ties, and stable ones near a state.
//!
//! Where ties are open at first, they are closed along a path as loads are applied along one: each second
//! place moves from where it is to where it is tied, by the motion of a rod whose strain is uniform. Without
//! that, the energy is minimised on the states in which ties are closed: each step of the trust region is one of the
//! motions that they allow, and closed again. Where that fails, it is minimised with ties as penalties and the
//! reactions held (the augmented Lagrangian), and Newton's method takes it to the state in which they are closed
//! exactly.

use super::continuation::{Continuation, LoadStep};
use super::corrector::CorrectorTolerance;
use super::path::{Event, PathSink, StepReport};
use super::status::Status;
use super::system::System;
use super::trust_region::Target;
use crate::lie::LieGroup;
use std::ops::Range;

/// Penalties are raised where a minimisation leaves more than this share of the largest gap.
const SLOW: f64 = 0.25;
/// Factor by which they are raised, and the largest one in all.
const RISE: f64 = 10.0;
const MAX_RISE: f64 = 1e3;
/// Largest number of iterations on the states in which ties are closed.
const MAX_DESCENT: usize = 500;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'_, G, D, P> {
    /// A stable equilibrium with all ties closed under a load, from the current state.
    pub(super) fn close_ties(
        &mut self,
        target: &[f64],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        let radius = self.options.trust_region.initial_radius;
        let model = self.system.model();
        let progress = model.forces.ties.progress();
        let first = self.system.state().to_vec();
        self.system.forget_reactions();
        self.system.neutral.forget();
        self.system.set_load(target);
        self.system.set_openings(0..0);
        self.system.evaluate();
        let at_rest = self.system.state().iter().all(|q| *q == 0.0);
        let turns = at_rest && model.forces.ties.turn();
        let count = model.tie_count();
        let status = if !turns && self.system.largest_gap() <= self.options.closing.nearly_closed {
            self.find_stable(radius, step.tangent_reuse)
        } else {
            self.range[progress] = 1.0;
            let start = self.system.state().to_vec();
            self.system.budget.limit((count > 1).then_some(self.options.closing.together));
            let mut status = self.close_some(0..count, target, step, sink);
            self.system.budget.limit(None);
            let failed = matches!(status, Status::Stalled | Status::Diverged | Status::IterationLimit);
            if failed && count > 1 {
                // Ties of which some follow from others cannot all be half closed.
                self.system.set_state(&start);
                for tie in 0..count {
                    status = self.close_some(tie..tie + 1, target, step, sink);
                    if !status.is_equilibrium() {
                        break;
                    }
                }
                self.system.acting = count;
            }
            status
        };
        let last = self.system.state().to_vec();
        self.why_not_closed(status, target, &[&first, &last])
    }

    /// Closes some ties from the current state, with those before them closed and those after them not acting.
    fn close_some(
        &mut self,
        ties: Range<usize>,
        target: &[f64],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        self.system.acting = ties.end;
        self.system.neutral.forget();
        let start = self.system.state().to_vec();
        let mut status = self.hold_open(ties.clone(), target);
        if matches!(status, Status::Stalled | Status::Diverged) && ties.start == 0 {
            // Places that cannot be held where they are, such as the ends of a straight rod that does not
            // stretch, are let go first.
            self.system.set_state(&start);
            self.find_untied(target, self.options.trust_region.initial_radius);
            status = self.hold_open(ties, target);
        }
        if !status.is_equilibrium() {
            return status;
        }
        self.predictor.forget_curvature();
        self.follow_segment(target, step, &mut Quiet { sink })
    }

    /// A stable equilibrium with some ties held open as they are in the current state.
    fn hold_open(&mut self, ties: Range<usize>, target: &[f64]) -> Status {
        let progress = self.system.model().forces.ties.progress();
        let mut begin = target.to_vec();
        begin[progress] = 0.0;
        self.system.set_load(target);
        self.system.set_openings(ties);
        self.system.set_load(&begin);
        self.find_stable(self.options.trust_region.initial_radius, 0.0)
    }

    /// Goes to an equilibrium without ties, if there is one nearby.
    fn find_untied(&mut self, target: &[f64], radius: f64) {
        let start = self.system.state().to_vec();
        self.system.set_load(target);
        self.system.forget_reactions();
        self.system.penalised = true;
        let found = self.find_free(radius, 0.0);
        self.system.penalised = false;
        if !found.is_equilibrium() {
            self.system.set_state(&start);
        }
    }

    /// A stable equilibrium near the current state with the ties as they are under the current load.
    pub(super) fn find_tied(&mut self, radius: f64, tangent_reuse: f64) -> Status {
        let tolerance = self.options.tolerance;
        let rough = self.options.closing.residual.max(tolerance);
        let size = self.system.evaluate();
        if size <= rough && self.close_exactly(size, tangent_reuse) {
            return Status::Converged;
        }
        let start = self.system.state().to_vec();
        let descended = self.descend_with_closed_ties(radius, tangent_reuse);
        if matches!(
            descended,
            Status::Converged | Status::Unrestrained | Status::TimeLimit | Status::Cancelled
        ) {
            return descended;
        }
        self.system.set_state(&start);
        let mut status = Status::Stalled;
        let (mut rise, mut widest) = (1.0, f64::INFINITY);
        for _ in 0..self.options.closing.max_rounds {
            self.system.evaluate();
            self.system.penalise(rise);
            let target = Target { tolerance: rough, tangent_reuse: 1.0 };
            status = self.trust_region.minimize_energy(&mut self.system, radius, target);
            self.system.end_penalties();
            if !matches!(status, Status::Converged | Status::Stalled) {
                return status;
            }
            let size = self.system.evaluate();
            let gap = self.system.largest_gap();
            if self.close_exactly(size, tangent_reuse) {
                return Status::Converged;
            }
            if gap > SLOW * widest {
                // Where the structure is unstable but for the ties, weak penalties lead back and forth.
                rise = (RISE * rise).min(MAX_RISE);
            }
            widest = gap;
            if let Some(status) = self.system.budget.exhausted() {
                return status;
            }
        }
        if status == Status::Converged { Status::Stalled } else { status }
    }

    /// Minimises the energy on the states in which the ties are closed, if they close at once: the descent is limited by
    /// what is free alone, however stiff what they hold is.
    fn descend_with_closed_ties(&mut self, radius: f64, tangent_reuse: f64) -> Status {
        let size = self.system.evaluate();
        if !self.system.close(size).is_finite() {
            return Status::NotClosed;
        }
        let most = self.system.budget.iterations() + MAX_DESCENT;
        let before = self.system.budget.limit(None);
        self.system.budget.limit(Some(before.unwrap_or(most).min(most)));
        let target = Target { tolerance: self.options.tolerance, tangent_reuse };
        let status = self.trust_region.minimize_energy(&mut self.system, radius, target);
        self.system.budget.limit(before);
        status
    }

    /// Newton's method from a state whose largest residual is `size`; `false`, with the state restored, if it
    /// does not lead to a stable equilibrium nearby.
    fn close_exactly(&mut self, size: f64, tangent_reuse: f64) -> bool {
        let start = self.system.state().to_vec();
        let residual = self.options.tolerance;
        let accuracy = CorrectorTolerance { residual, tangent_reuse, stable: false };
        let closed = self.corrector.iterate(&mut self.system, size, self.options.closing.reach, accuracy);
        if !closed {
            self.system.set_state(&start);
        }
        closed
    }
}

/// Forwards everything but events: what happens while ties are being closed is not on the path.
struct Quiet<'s, S> {
    sink: &'s mut S,
}

impl<G, S: PathSink<G, D, P>, const D: usize, const P: usize> PathSink<G, D, P> for Quiet<'_, S> {
    fn step(&mut self, index: usize, report: StepReport, system: &System<G, D, P>) {
        self.sink.step(index, report, system);
    }

    fn event(&mut self, _: Event) {}
}
