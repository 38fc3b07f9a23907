//! Beyond the end of a branch: the next stable equilibrium, and the kind of event that leads to it.

use super::continuation::{Continuation, LoadStep};
use super::path::{Event, EventKind, PathSink};
use super::planes::{BranchAhead, is_stable};
use super::status::Status;
use super::step_control::StepControl;
use super::vector::{dot, max_norm, norm};
use crate::lie::LieGroup;
use crate::strain::gauss_legendre;

/// Quadrature points of [`Continuation::work_of_forces`].
const WORK_POINTS: usize = 12;
/// Quadrature points of [`Continuation::crosses_a_barrier`].
const BARRIER_POINTS: usize = 6;
/// Part of the distance to a critical load over which it is approached before it is extrapolated again.
const APPROACH: f64 = 0.9;
/// A branch that continues over less than this part of a sub-step hardly does.
pub(super) const NEGLIGIBLE_PROGRESS: f64 = 0.25;
/// Largest number of Newton steps to an equilibrium on the way.
const REFINEMENTS: usize = 8;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'_, G, D, P> {
    /// Goes from the equilibrium in `start`, at `from`, from which the smallest sub-step, to `failed`, could
    /// not be made, to the nearest stable equilibrium beyond; returns its λ.
    pub(super) fn pass_branch_end(
        &mut self,
        from: f64,
        failed: f64,
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
        control: &mut StepControl,
    ) -> Result<f64, Status> {
        let ahead =
            if control.ignores_ends() { BranchAhead::Unknown } else { self.locate_branch_end(from, failed) };
        let reached = match ahead {
            BranchAhead::Continues(lambda) => {
                self.arrive();
                self.predictor.forget_curvature();
                let near = max_norm(&self.moved) <= 10.0 * self.options.jump.min_displacement;
                if lambda - from < NEGLIGIBLE_PROGRESS * (failed - from) && near {
                    control.record_negligible_jump();
                }
                control.accept(from, lambda);
                self.swap_ends();
                return Ok(lambda);
            }
            // A limit point further back, or not before the next listed load, belongs to another branch.
            BranchAhead::LimitPoint(at) if (2.0 * from - failed..=1.0).contains(&at) => {
                self.start.copy_from_slice(self.system.state());
                self.leave_limit_point(from, at, failed, step, sink, control)?
            }
            BranchAhead::BranchPoint => {
                // The tangent before the last step may be that of the branch which has become unstable.
                self.find_stable_at(failed, 0.0)?;
                if let Some((mut kind, at)) = self.classify_branch_point(from, failed) {
                    if self.leave_continuously(failed) {
                        kind = EventKind::Bifurcation;
                    }
                    self.report(kind, at, failed, step, sink);
                }
                failed
            }
            BranchAhead::LimitPoint(_) | BranchAhead::Unknown => self.jump(from, failed, step, sink)?,
        };
        self.restart(control);
        Ok(reached)
    }

    /// Goes from the limit point in `start`, at `at`, to a stable equilibrium just beyond; if the state hardly
    /// changes, to one at `next`.
    pub(super) fn leave_limit_point(
        &mut self,
        from: f64,
        at: f64,
        next: f64,
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
        control: &mut StepControl,
    ) -> Result<f64, Status> {
        // As the state at `from` is approximate, the limit point may lie before it.
        let lambda = (at + self.options.locate.beyond * self.span()).max(from).min(1.0);
        self.find_stable_at(lambda, self.tangent_reuse_at(lambda, step))?;
        if self.moves_noticeably() && self.releases_energy(lambda - at) {
            self.report(EventKind::Snap, at, lambda, step, sink);
            return Ok(lambda);
        }
        control.record_negligible_jump();
        // The branch goes on in the state found: the limit point was not resolved.
        if lambda > from {
            return Ok(lambda);
        }
        self.jump(from, next, step, sink)
    }

    /// Whether the displacement from `start` is that of a jump: of the coordinates or, as beside long bodies, of the
    /// ends of a spring.
    fn moves_noticeably(&self) -> bool {
        let least = self.options.jump.min_displacement;
        let states = [&self.start[..], self.system.state()];
        max_norm(&self.moved) > least || self.system.data().spring_motion(self.system.model(), states) > least
    }

    /// Where a motion had no stiffness since the path began and goes with the load at once, goes from the equilibrium at
    /// hand to a stable one after the smallest sub-step. There a path of stable equilibria begins; no branch ends, so
    /// that this is no event. Returns its λ, or zero.
    pub(super) fn settle(&mut self, min_step: f64, step: LoadStep) -> Result<f64, Status> {
        self.never_held = self.never_held && self.system.is_conservative() && self.system.may_drift();
        if !self.never_held {
            return Ok(0.0);
        }
        self.start.copy_from_slice(self.system.state());
        self.system.velocity(&self.rate, &mut self.velocity[0]);
        let adrift = self.system.is_adrift(&self.start, &self.velocity[0], &self.rate, min_step);
        if !adrift {
            let start = self.start.clone();
            self.restore_at(&start, 0.0);
            return Ok(0.0);
        }
        self.find_stable_at(min_step, self.tangent_reuse_at(min_step, step))?;
        Ok(min_step)
    }

    /// Goes from the state in `start`, at `from`, to a stable equilibrium at `next`.
    fn jump(
        &mut self,
        from: f64,
        next: f64,
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) -> Result<f64, Status> {
        self.find_stable_at(next, self.tangent_reuse_at(next, step))?;
        if self.has_jumped(next - from) {
            self.report(EventKind::Snap, next, next, step, sink);
        }
        Ok(next)
    }

    /// The share of the residual below which the tangent is reused after a jump to `lambda`.
    fn tangent_reuse_at(&self, lambda: f64, step: LoadStep) -> f64 {
        if lambda == 1.0 { step.tangent_reuse } else { self.options.accuracy.tangent_reuse_after_jump }
    }

    /// Finds a stable equilibrium at `lambda` from `start`.
    fn find_stable_at(&mut self, lambda: f64, tangent_reuse: f64) -> Result<(), Status> {
        self.system.set_load_between(&self.start_load, &self.rate, lambda);
        self.system.set_state(&self.start);
        self.system.evaluate();
        self.energy = self.system.energy();
        self.slope.copy_from_slice(self.system.forces());
        let status = self.find_stable(self.options.trust_region.initial_radius, tangent_reuse);
        self.unstable = status == Status::Unstable;
        if !status.is_equilibrium() {
            return Err(status);
        }
        self.arrive();
        Ok(())
    }

    /// Reports an event at `at` that led from `start` to the equilibrium at hand, at `lambda`.
    fn report(
        &mut self,
        kind: EventKind,
        at: f64,
        lambda: f64,
        step: LoadStep,
        sink: &mut impl PathSink<G, D, P>,
    ) {
        self.system.set_load_between(&self.start_load, &self.rate, at);
        let (load, before, after) = (self.system.input_loads(), &self.start[..], self.system.state());
        sink.event(Event { step: step.index, kind, load, before, after });
        self.system.set_load_between(&self.start_load, &self.rate, lambda);
    }

    /// Whether the state found, over `h`, cannot be on the branch of `start`.
    fn has_jumped(&mut self, h: f64) -> bool {
        let jump = self.options.jump;
        let speed = max_norm(&self.velocity[0]).max(max_norm(&self.velocity[1]));
        let explained = jump.min_displacement + jump.speed_margin * h * speed;
        // Without a potential, the work of a drift along a neutral motion depends on its path.
        let drift = !self.system.is_conservative() && self.system.may_drift();
        !drift && max_norm(&self.moved) > explained && self.releases_energy(h)
    }

    /// Whether more energy is released from `start` to the state found, over `h`, than a convex energy would
    /// release, which lies above its tangent in `start`.
    fn releases_energy(&mut self, h: f64) -> bool {
        let released = if self.system.is_conservative() {
            (self.energy - self.system.energy()) / self.system.unit_energy()
        } else {
            self.work_of_forces()
        };
        let released = released - self.options.jump.min_energy;
        self.system.force_gradient(&self.rate, &mut self.work);
        // Energy that the controls themselves store over `h`.
        let stored = h * self.system.load_curvature(&self.rate);
        let work = (dot(&self.work, &self.moved) + stored).abs();
        if released - 0.5 * h * stored <= h * work {
            return false;
        }
        // The state in `start` is approximate, if only by the change of load. Its branch may have ended in the
        // state found, as a buckled branch does where the load falls.
        released > -dot(&self.slope, &self.moved) || self.crosses_a_barrier()
    }

    /// Whether stability is lost somewhere between `start` and the state found.
    pub(super) fn crosses_a_barrier(&mut self) -> bool {
        let found = self.system.state().to_vec();
        let points = gauss_legendre(BARRIER_POINTS);
        let crosses = points.into_iter().rev().any(|(place, _)| {
            self.system.advance_from(&self.start, &self.moved, 0.5 * (1.0 + place));
            self.system.evaluate();
            self.system.evaluate_tangent();
            !is_stable(&mut self.system)
        });
        self.restore(&found);
        crosses
    }

    /// The work of all forces along the straight line from `start` to the state found.
    fn work_of_forces(&mut self) -> f64 {
        let found = self.system.state().to_vec();
        let mut work = 0.0;
        for (place, weight) in gauss_legendre(WORK_POINTS) {
            self.system.advance_from(&self.start, &self.moved, 0.5 * (1.0 + place));
            self.system.evaluate();
            work -= 0.5 * weight * dot(self.system.residual(), &self.moved);
        }
        self.system.set_state(&found);
        self.system.evaluate();
        work
    }

    /// The kind of event at a branch point between `start`, at `from`, and the stable equilibrium found at
    /// `lambda`, and its λ; `None` if the state hardly changes.
    fn classify_branch_point(&mut self, from: f64, lambda: f64) -> Option<(EventKind, f64)> {
        let jump = self.options.jump;
        let h = lambda - from;
        let before = h * max_norm(&self.velocity[0]);
        if max_norm(&self.moved) <= jump.speed_margin * before + 1e-2 * jump.min_displacement {
            return None;
        }
        let found = self.system.state().to_vec();
        self.system.set_load_between(&self.start_load, &self.rate, from);
        self.system.set_state(&self.start);
        let at = self.critical_load(from, h).map_or(lambda, |at| at.min(lambda));
        self.restore_at(&found, lambda);
        let kind = if self.displacement_is_constant(at, from, lambda) {
            EventKind::Snap
        } else {
            EventKind::Bifurcation
        };
        Some((kind, at))
    }

    /// λ of the loss of stability ahead of the current equilibrium, near `from`, within `h`: extrapolated from there,
    /// and again from closer by. Overwrites state and load.
    fn critical_load(&mut self, from: f64, h: f64) -> Option<f64> {
        let mut velocity = self.velocity[0].clone();
        let mut distance = self.critical.find(&mut self.system, &velocity, &self.rate, h)?;
        let mut at = from;
        for _ in 0..self.options.critical.approaches {
            let near = APPROACH * distance;
            let place: Vec<f64> = velocity.iter().map(|v| v * near).collect();
            let start = if at == from { self.start.clone() } else { self.work.clone() };
            self.system.advance_from(&start, &place, 1.0);
            self.system.set_load_between(&self.start_load, &self.rate, at + near);
            if !self.refine_equilibrium() {
                break;
            }
            self.work.copy_from_slice(self.system.state());
            self.system.velocity(&self.rate, &mut velocity);
            let Some(again) = self.critical.find(&mut self.system, &velocity, &self.rate, h - near) else {
                break;
            };
            // Far from where it was expected, another mode was found.
            if !((again + near - distance).abs() < (1.0 - APPROACH) * distance) {
                break;
            }
            (at, distance) = (at + near, again);
        }
        Some(at + distance)
    }

    /// Newton's method for the equilibrium nearby; `false` if it does not lead to a stable one.
    fn refine_equilibrium(&mut self) -> bool {
        let mut step = vec![0.0; self.start.len()];
        let mut last = f64::INFINITY;
        for _ in 0..REFINEMENTS {
            self.system.evaluate();
            self.system.evaluate_tangent();
            if !self.system.factorise(0.0) || self.system.is_singular() {
                return false;
            }
            self.system.newton_step(&mut step);
            let length = max_norm(&step);
            if !(length < 0.5 * last) {
                break;
            }
            last = length;
            self.system.advance(&step);
        }
        last < self.options.newton.small_step
    }

    /// Goes to a nearby equilibrium at `lambda` instead of the one found, where there is one: from an
    /// asymmetric branch point, a stable branch leaves to one side only.
    fn leave_continuously(&mut self, lambda: f64) -> bool {
        let (found, far) = (self.system.state().to_vec(), self.moved.clone());
        let radius = self.options.jump.departure;
        let mode = match self.critical.mode() {
            mode if norm(mode) > 0.0 => mode,
            _ => &far,
        };
        let step = radius / norm(mode);
        let sides = [-step, step].map(|step| mode.iter().map(|m| step * m).collect::<Vec<_>>());
        for side in sides {
            self.system.advance_from(&self.start, &side, 1.0);
            let status = self.find_stable(radius, 0.0);
            self.system.displacement(&self.start, &mut self.moved);
            if status.is_equilibrium() && norm(&self.moved) < self.options.jump.nearness * norm(&far) {
                self.arrive();
                return true;
            }
        }
        self.restore_at(&found, lambda);
        self.arrive();
        false
    }

    /// Restores an equilibrium at `lambda`, with its tangent and factor.
    pub(super) fn restore_at(&mut self, state: &[f64], lambda: f64) {
        self.system.set_load_between(&self.start_load, &self.rate, lambda);
        self.restore(state);
    }

    /// Restores an equilibrium at the current load, likewise.
    fn restore(&mut self, state: &[f64]) {
        self.system.set_state(state);
        self.system.evaluate();
        self.system.evaluate_tangent();
        self.system.factorise(0.0);
    }

    /// Whether the displacement from `start` just beyond the critical load, at `at`, is nearly that at
    /// `lambda`: then it is a jump, not a motion along the new branch.
    fn displacement_is_constant(&mut self, at: f64, from: f64, lambda: f64) -> bool {
        let jump = self.options.jump;
        let begin = if at < lambda { at } else { from };
        let found = self.system.state().to_vec();
        let moved = max_norm(&self.moved);
        let earlier = begin + jump.earlier * (lambda - begin);
        self.system.set_load_between(&self.start_load, &self.rate, earlier);
        self.system.set_state(&self.start);
        let status = self.find_stable(self.options.trust_region.initial_radius, 0.0);
        self.system.displacement(&self.start, &mut self.work);
        let constant = status.is_equilibrium() && max_norm(&self.work) >= jump.constant_share * moved;
        self.restore_at(&found, lambda);
        constant
    }
}
