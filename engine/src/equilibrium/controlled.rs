//! Inputs that are controlled by their conjugates: the listed loads are changes v of the conjugates, and
//! the loads required are found.
//!
//! Such an input acts on the conjugate c from a set point w through a stiffness; see `control.rs`. Between
//! listed loads the branch is followed in w, which differs from c by a small fraction of its change. At a
//! listed load, chord steps on state and w together solve c = v.

use super::continuation::{Continuation, LoadStep};
use super::path::{Event, PathSink, StepReport};
use super::status::Status;
use super::system::System;
use super::vector::max_norm;
use crate::lie::LieGroup;

/// Loads by input.
#[derive(Clone, Debug)]
pub(super) struct SetPoints {
    /// Next values of the inputs.
    aim: Vec<f64>,
    /// Lag w − c of each conjugate at the beginning of a segment.
    lag: Vec<f64>,
}

impl SetPoints {
    pub fn new(inputs: usize) -> Self {
        Self { aim: vec![0.0; inputs], lag: vec![0.0; inputs] }
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'_, G, D, P> {
    /// Follows the branch from the current equilibrium to a listed load.
    pub(super) fn follow_to(
        &mut self,
        target: &[f64],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        if !self.system.is_controlled() {
            return self.follow_segment(target, step, sink);
        }
        let status = if self.system.is_at(target, self.options.tolerance) {
            if self.unstable { Status::Unstable } else { Status::Converged }
        } else {
            self.follow_lagging(target, step, sink)
        };
        self.hold(status, target, step, sink)
    }

    /// Continues from an equilibrium that was found to the one with the listed conjugates.
    pub(super) fn hold(
        &mut self,
        mut status: Status,
        target: &[f64],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        if !self.system.is_controlled() {
            return status;
        }
        for _ in 0..self.options.controlled.max_rounds {
            if !status.is_equilibrium() || self.close(target, step.tangent_reuse == 0.0) {
                return status;
            }
            if let Some(status) = self.system.budget.exhausted() {
                return status;
            }
            self.predictor.forget_curvature();
            status = self.follow_lagging(target, step, sink);
            self.predictor.forget_curvature();
        }
        Status::Stalled
    }

    /// Follows the branch to the listed conjugates, on the assumption that their lag does not change.
    fn follow_lagging(
        &mut self,
        target: &[f64],
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Status {
        let mut set_points = std::mem::replace(&mut self.set_points, SetPoints::new(0));
        self.system.lag(&mut set_points.lag);
        let SetPoints { aim, lag } = &mut set_points;
        aim.iter_mut().zip(target).zip(&*lag).for_each(|((aim, target), lag)| *aim = target + lag);
        let status = self.follow_segment(aim, step, &mut Lagging { sink, lag });
        self.set_points = set_points;
        status
    }

    /// Chord steps from an equilibrium to a nearby one with the listed conjugates; `false`, with the state
    /// restored, if they do not converge.
    fn close(&mut self, target: &[f64], own_tangent: bool) -> bool {
        let tolerance = self.options.tolerance;
        let rounding = self.options.controlled.rounding;
        self.start.copy_from_slice(self.system.state());
        self.start_load.copy_from_slice(self.system.load());
        let mut last = f64::INFINITY;
        for chord in 0..self.options.controlled.max_chords {
            let size = self.system.evaluate();
            let gap = self.system.gap(target, &mut self.set_points.aim);
            let settled = chord > 1 && size.max(gap) > 0.5 * last;
            if self.system.has_converged(size, tolerance) && (gap <= tolerance || settled && gap <= rounding)
            {
                let own = chord > 0 && own_tangent;
                if own {
                    self.system.evaluate_tangent();
                }
                if !own || self.system.factorise(0.0) || !self.system.is_conservative() {
                    return true;
                }
                break;
            }
            if !size.is_finite() || settled {
                break;
            }
            last = size.max(gap);
            self.system.load_gradient(&self.set_points.aim, &mut self.work);
            for (step, residual) in self.work.iter_mut().zip(self.system.residual()) {
                *step = -*step - residual;
            }
            self.system.solve(&mut self.work);
            if !(max_norm(&self.work) <= self.options.max_displacement) {
                break;
            }
            self.system.advance(&self.work);
            self.system.add_load(&self.set_points.aim);
        }
        self.system.set_state(&self.start);
        self.system.set_load(&self.start_load);
        self.system.evaluate();
        self.system.evaluate_tangent();
        self.system.factorise(0.0);
        false
    }
}

/// Forwards events, with the conjugates of controlled inputs in place of the set points w.
struct Lagging<'s, S> {
    sink: &'s mut S,
    lag: &'s [f64],
}

impl<G, S: PathSink<G, D, P>, const D: usize, const P: usize> PathSink<G, D, P> for Lagging<'_, S> {
    fn step(&mut self, index: usize, report: StepReport, system: &System<G, D, P>) {
        self.sink.step(index, report, system);
    }

    fn event(&mut self, event: Event) {
        let load: Vec<f64> = event.load.iter().zip(self.lag).map(|(w, lag)| w - lag).collect();
        self.sink.event(Event { load: &load, ..event });
    }
}
