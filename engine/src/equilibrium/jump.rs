//! Jumps: from the end of a branch to another equilibrium, and what kind of event that is.

use super::continuation::{Continuation, LoadStep};
use super::critical::CriticalPoint;
use super::path::{Event, EventKind, PathSink};
use super::status::Status;
use super::vector::{dot, max_norm, norm};
use crate::lie::LieGroup;
use crate::strain::gauss_legendre;

/// Points of the quadrature of [`Continuation::work_of_forces`].
const WORK_POINTS: usize = 12;

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

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'_, G, D, P> {
    /// From the end of the branch, in `start` at `from`, to a stable equilibrium at `lambda`.
    pub(super) fn jump_to_stable(
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
        self.system.load_gradient(&self.rate, &mut self.load_at_start);
        let status = self.find_stable(radius, tangent_reuse);
        if !status.is_equilibrium() {
            return status;
        }
        let fallen = (energy - self.system.data().energy()) / self.system.unit_energy();
        let stored = self.system.load_curvature(&self.rate);
        let fallen = fallen - 0.5 * (lambda - from).powi(2) * stored;
        self.change[1] = self.system.velocity(&self.rate, &mut self.velocity[1]);
        self.system.displacement(&self.start, &mut self.moved);
        if !self.has_left(lambda - from) {
            return status;
        }
        let h = lambda - from;
        let released = if self.system.is_conservative() { fallen } else { self.work_of_forces() };
        let (kind, at) = if self.load_acts_along_jump() && !self.is_unexplained(h * self.ordinary_speed()) {
            return status;
        } else if self.system.model().has_switches() && self.is_evident(released, h) {
            // With contact jumps are frequent, and many branches end in a corner.
            (Some(EventKind::Snap), lambda)
        } else {
            let ahead = self.look_back(from, lambda);
            let at = match ahead {
                Lookahead::Critical(point) => (from + point.distance).min(lambda),
                _ => lambda,
            };
            (self.classify(ahead, released, at, from, lambda), at)
        };
        if let Some(kind) = kind {
            let after = self.system.state().to_vec();
            let at = if kind == EventKind::Snap { self.load_of_snap(at, lambda, &after) } else { at };
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

    /// The work of all forces from `start` straight to the state found: without a potential there is no
    /// energy.
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

    /// Whether the load has a part along the displacement, which it has not where another branch crosses.
    fn load_acts_along_jump(&self) -> bool {
        let least = self.options.jump.evident_share * norm(&self.load_at_start) * norm(&self.moved);
        self.system.is_conservative() && dot(&self.load_at_start, &self.moved).abs() > least
    }

    /// Whether this is a snap without a look at the end of the branch: the load works along a displacement
    /// that velocities do not explain, and so much energy is released that the tangent would have to soften
    /// far more over a sub-step than it does towards a bifurcation.
    fn is_evident(&self, released: f64, h: f64) -> bool {
        let jump = self.options.jump;
        if !self.load_acts_along_jump() {
            return false;
        }
        let moved = norm(&self.moved);
        let stored = self.system.load_curvature(&self.rate);
        let work = [0, 1].map(|end| (dot(&self.load_at_start, &self.velocity[end]) + stored).abs());
        let softening = jump.evident_softening.max(jump.evident_steps * self.options.min_step);
        2.0 * released > softening * moved * moved
            && released > jump.energy_margin * 0.5 * h * h * work[0].max(work[1])
    }

    /// The load of a snap to `after`: the critical one, at `at`, if less energy is found there already than
    /// in `start`, and else that at `lambda`.
    fn load_of_snap(&mut self, at: f64, lambda: f64, after: &[f64]) -> f64 {
        self.system.set_load_between(&self.start_load, &self.rate, at);
        self.system.set_state(&self.start);
        self.system.evaluate();
        let before = self.system.data().energy();
        self.system.set_state(after);
        self.system.evaluate();
        let lower = self.system.data().energy() < before;
        self.system.set_load_between(&self.start_load, &self.rate, lambda);
        self.system.evaluate();
        if lower || !self.system.is_conservative() { at } else { lambda }
    }

    /// Whether the state moved by more than at a speed that covers `way`.
    fn is_unexplained(&self, way: f64) -> bool {
        let jump = self.options.jump;
        max_norm(&self.moved) > jump.min_displacement + jump.speed_margin * way
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
        // A corner, such as that of a joint limit, may look like a fold.
        if moved <= h * before && self.could_be_convex(released, h) {
            return None;
        }
        match ahead {
            Lookahead::Neutral { pulled: true } => None,
            Lookahead::Critical(point) if point.distance <= 2.0 * h && !point.bifurcation => {
                self.is_unexplained(h * self.ordinary_speed()).then_some(EventKind::Snap)
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
                let jumps = self.is_unexplained(h * before.max(after)) && self.releases_energy(released, h);
                jumps.then_some(EventKind::Snap)
            }
        }
    }

    /// Whether the energy released is more than the load's work on a branch over `h`, which is all that
    /// there is as long as the energy is convex; to drift along a motion that nothing holds takes none.
    fn releases_energy(&mut self, released: f64, h: f64) -> bool {
        self.system.load_gradient(&self.rate, &mut self.work);
        let stored = self.system.load_curvature(&self.rate);
        let work_rate = (dot(&self.work, &self.velocity[1]) + stored).abs();
        let work_rate = work_rate.max(self.critical.work_rate());
        released > self.options.jump.energy_margin * 0.5 * h * h * work_rate
    }

    /// Whether no more energy is released than where the energy is convex between both states: there it
    /// lies above its tangent in `start`, where the load's change over `h` is all that is not balanced.
    fn could_be_convex(&self, released: f64, h: f64) -> bool {
        let work = dot(&self.load_at_start, &self.moved) + h * self.system.load_curvature(&self.rate);
        self.system.is_conservative() && released <= h * work.abs()
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
}
