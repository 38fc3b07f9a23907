//! States of a branch on parallel hyperplanes n·(q − q₀) = s, the load unknown.

use super::bordered::{Border, Bordered, BorderedTarget, Hyperplane, Multiplier};
use super::options::{LocateOptions, MixedOptions};
use super::point_motion::PointMotion;
use super::sweep::PathMotion;
use super::system::System;
use super::vector::norm;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tolerances::ZERO_EIGENVALUE;

/// The branch ahead of an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum BranchAhead {
    /// The branch continues; the system holds its equilibrium at this λ.
    Continues(f64),
    /// A limit point at this λ; the system holds its state.
    LimitPoint(f64),
    /// A branch point: stability is lost while the load rises.
    BranchPoint,
    /// No state of the branch was found.
    Unknown,
}

/// A state of the branch.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// Position s of its plane.
    pub at: f64,
    /// λ and dλ/ds.
    pub load: f64,
    pub slope: f64,
    pub q: Vec<f64>,
    /// dq/ds, dimensionless.
    pub direction: Vec<f64>,
    pub stable: bool,
}

impl Point {
    /// Whether the state is stable and the load rises.
    pub fn is_followed(&self) -> bool {
        self.stable && self.slope > 0.0
    }
}

/// Solves for states of the branch on parallel planes.
pub(super) struct PlaneSolver<'a, const D: usize, const P: usize> {
    pub bordered: Bordered,
    pub motion: PointMotion<D, P>,
    pub mixed: MixedOptions,
    pub plane: Hyperplane,
    pub rate: &'a [f64],
    pub options: LocateOptions,
    pub target: BorderedTarget,
}

impl<const D: usize, const P: usize> PlaneSolver<'_, D, P> {
    /// Takes a point for the origin of the planes, and its direction, normalised, for their normal.
    pub fn set_origin<G: LieGroup<D, P>>(&mut self, system: &System<G, D, P>, point: &mut Point) {
        let length = norm(&point.direction);
        point.direction.iter_mut().for_each(|d| *d /= length);
        point.slope /= length;
        point.at = 0.0;
        self.plane.normal = point.direction.iter().zip(system.units()).map(|(d, u)| d / u).collect();
        self.plane.origin.clone_from(&point.q);
    }

    /// The exact state near an approximate one, as those between the listed loads are; where the load does
    /// not rise there, what that means for the branch.
    pub fn refine<G: LieGroup<D, P>>(
        &mut self,
        system: &mut System<G, D, P>,
        near: &Point,
    ) -> Result<Point, BranchAhead> {
        let point = self.solve(system, near, near.at, self.target).ok_or(BranchAhead::Unknown)?;
        let mut moved = vec![0.0; near.q.len()];
        system.displacement(&near.q, &mut moved);
        match norm(&moved) <= self.options.refinement {
            true if point.is_followed() => Ok(point),
            true if point.slope <= 0.0 => Err(BranchAhead::LimitPoint(point.load)),
            _ => Err(BranchAhead::Unknown),
        }
    }

    /// The state on the plane at `at`, solved from a point nearby; `None` where none is found near the line
    /// along that point's direction.
    pub fn solve<G: LieGroup<D, P>>(
        &mut self,
        system: &mut System<G, D, P>,
        near: &Point,
        at: f64,
        target: BorderedTarget,
    ) -> Option<Point> {
        self.plane.distance = at;
        let point = self.solve_straight(system, near, at, target);
        let stiff = system.model().has_switches() || system.model().has_springs();
        if point.is_some() || !stiff || system.is_projected() || system.budget.exhausted().is_some() {
            return point;
        }
        self.solve_mixed(system, near, at, target)
    }

    /// The same from a straight step.
    fn solve_straight<G: LieGroup<D, P>>(
        &mut self,
        system: &mut System<G, D, P>,
        near: &Point,
        at: f64,
        target: BorderedTarget,
    ) -> Option<Point> {
        self.predict(system, near, at);
        let border = Border { constraint: &self.plane, multiplier: Multiplier::Load(self.rate) };
        if !self.bordered.solve(system, &[border], target) {
            return None;
        }
        self.point_found(system, near, at)
    }

    /// The same with the forces of stiff terms as unknowns: a straight step changes their distances to second order.
    fn solve_mixed<G: LieGroup<D, P>>(
        &mut self,
        system: &mut System<G, D, P>,
        near: &Point,
        at: f64,
        target: BorderedTarget,
    ) -> Option<Point> {
        system.set_state(&near.q);
        self.bordered.multipliers[0] = near.load;
        let border = Border { constraint: &self.plane, multiplier: Multiplier::Load(self.rate) };
        self.bordered.visit(system, &[border]);
        self.motion.points.fill(Vector::ZERO);
        system.keep_forces(&self.motion.velocities());
        self.predict(system, near, at);
        let border = Border { constraint: &self.plane, multiplier: Multiplier::Load(self.rate) };
        if !self.bordered.approach(system, &[border], &mut self.motion, self.mixed)
            || !self.bordered.solve(system, &[border], target)
        {
            return None;
        }
        self.point_found(system, near, at)
    }

    /// Goes along a point's direction to the plane at `at`.
    fn predict<G: LieGroup<D, P>>(&mut self, system: &mut System<G, D, P>, near: &Point, at: f64) {
        let step = at - near.at;
        system.advance_from(&near.q, &near.direction, step);
        self.bordered.multipliers[0] = near.load + step * near.slope;
    }

    /// The state solved for on the plane at `at`; `None` if it is far from the line along a point's direction.
    fn point_found<G: LieGroup<D, P>>(
        &mut self,
        system: &mut System<G, D, P>,
        near: &Point,
        at: f64,
    ) -> Option<Point> {
        let (n, step) = (near.q.len(), at - near.at);
        let mut direction = vec![0.0; n + 1];
        direction[n] = 1.0;
        if !self.bordered.solve_step(&mut direction) {
            return None;
        }
        let slope = direction.pop()?;
        let mut aside = vec![0.0; n];
        system.displacement(&near.q, &mut aside);
        aside.iter_mut().zip(&near.direction).for_each(|(a, d)| *a -= step * d);
        let length = step.abs() * norm(&near.direction);
        let turn = if length > self.options.corner { self.options.turn } else { self.options.corner_turn };
        if step != 0.0 && norm(&aside) > turn * length {
            return None;
        }
        let stable = is_stable(system);
        let load = self.bordered.multipliers[0];
        let point = Point { at, load, slope, q: system.state().to_vec(), direction, stable };
        (step == 0.0 || self.is_next(system, near, &point)).then_some(point)
    }

    /// Whether a point may be joined to one before it by a branch on which both are followed: the load rises all the way,
    /// and no body is passed through.
    fn is_next<G: LieGroup<D, P>>(&self, system: &mut System<G, D, P>, near: &Point, point: &Point) -> bool {
        if !(near.is_followed() && point.is_followed()) {
            return true;
        }
        let rise = (point.load - near.load) / (point.at - near.at);
        let (least, most) = (near.slope.min(point.slope), near.slope.max(point.slope));
        let margin = self.options.slope_margin * most;
        if !(least - margin <= rise && rise <= most + margin) {
            return false;
        }
        let mut moved = vec![0.0; near.q.len()];
        system.displacement(&near.q, &mut moved);
        let velocities = [&near.direction[..], &point.direction];
        let motion = PathMotion { rate: self.rate, duration: point.load - near.load, velocities };
        system.stopped_while_loaded(&near.q, &moved, Some(motion)).is_none()
    }
}

/// Whether the current equilibrium is statically stable.
pub(super) fn is_stable<G: LieGroup<D, P>, const D: usize, const P: usize>(
    system: &mut System<G, D, P>,
) -> bool {
    let definite = system.factorise(0.0) || system.is_conservative() && system.factorise(ZERO_EIGENVALUE);
    definite && !system.is_lost(ZERO_EIGENVALUE)
}
