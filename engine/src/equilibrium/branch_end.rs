//! The end of a branch, located between an equilibrium and a sub-step that could not be made.
//!
//! The branch is followed by its own displacement: on planes n·x = s across the velocity at the last
//! equilibrium the load is unknown, so that [`Bordered`] finds states on both sides of a limit point. There
//! the load is largest, smoothly or in a corner, and the branch ends. Where the tangent loses its
//! definiteness while the load still rises, another branch crosses.

use super::bordered::{Border, Bordered, BorderedTarget, Hyperplane, Multiplier, Prescribed};
use super::continuation::Continuation;
use super::options::LocateOptions;
use super::system::System;
use super::vector::norm;
use crate::lie::LieGroup;
use crate::tolerances::ZERO_EIGENVALUE;

/// What was found ahead of an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ahead {
    /// The branch goes on; the system holds its equilibrium here.
    Further(f64),
    /// The load is largest here; the system holds the state.
    Limit(f64),
    /// Stability is lost while the load rises.
    Crossing,
    /// No state of the branch was found.
    Unknown,
}

/// A state of the branch.
#[derive(Clone, Debug)]
struct Point {
    /// Where its plane is,
    at: f64,
    /// its load, and the load's derivative.
    load: f64,
    slope: f64,
    q: Vec<f64>,
    /// Derivative of the coordinates.
    direction: Vec<f64>,
    stable: bool,
}

impl Point {
    /// Whether the branch is stable and its load rises.
    fn rises(&self) -> bool {
        self.stable && self.slope > 0.0
    }
}

/// Solves for states of the branch.
struct Planes<'a> {
    bordered: Bordered,
    plane: Hyperplane,
    rate: &'a [f64],
    options: LocateOptions,
    target: BorderedTarget,
}

impl Planes<'_> {
    /// Measures displacements from a point, along its direction, which becomes a unit vector.
    fn cross<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &System<G, D, P>,
        point: &mut Point,
    ) {
        let length = norm(&point.direction);
        point.direction.iter_mut().for_each(|d| *d /= length);
        point.slope /= length;
        point.at = 0.0;
        self.plane.normal = point.direction.iter().zip(system.units()).map(|(d, u)| d / u).collect();
        self.plane.origin.clone_from(&point.q);
    }

    /// A state that is exact, for one that is approximate as between the listed loads; what it is, if the load
    /// does not rise there.
    fn refine<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        near: &Point,
    ) -> Result<Point, Ahead> {
        let point = self.solve(system, near, near.at).ok_or(Ahead::Unknown)?;
        let mut moved = vec![0.0; near.q.len()];
        system.displacement(&near.q, &mut moved);
        match norm(&moved) <= self.options.refinement {
            true if point.rises() => Ok(point),
            true if point.slope <= 0.0 => Err(Ahead::Limit(point.load)),
            _ => Err(Ahead::Unknown),
        }
    }

    /// The state on the plane at `at`, sought from a point nearby; `None` where none is found that lies ahead
    /// of that point.
    fn solve<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        near: &Point,
        at: f64,
    ) -> Option<Point> {
        let (n, step) = (near.q.len(), at - near.at);
        self.plane.distance = at;
        system.advance_from(&near.q, &near.direction, step);
        self.bordered.multipliers[0] = near.load + step * near.slope;
        let border = Border { constraint: &self.plane, multiplier: Multiplier::Load(self.rate) };
        if !self.bordered.solve(system, &[border], self.target) {
            return None;
        }
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
        Some(Point { at, load, slope, q: system.state().to_vec(), direction, stable })
    }
}

/// Whether no motion grows by itself from the equilibrium at hand.
fn is_stable<G: LieGroup<D, P>, const D: usize, const P: usize>(system: &mut System<G, D, P>) -> bool {
    let definite = system.factorise(0.0) || system.is_conservative() && system.factorise(ZERO_EIGENVALUE);
    definite && !system.is_lost(ZERO_EIGENVALUE)
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'_, G, D, P> {
    /// What lies between the equilibrium in `start`, at `from`, and `failed`, to which no sub-step led.
    pub(super) fn look_ahead(&mut self, from: f64, failed: f64) -> Ahead {
        let n = self.start.len();
        let speed = norm(&self.velocity[0]);
        let options = self.options.locate;
        let direction = self.velocity[0].clone();
        let mut bordered = Bordered::new(n, self.rate.len(), 1);
        bordered.set_base_load(&self.start_load);
        let target = BorderedTarget {
            tolerance: self.options.tolerance.max(options.residual),
            small_step: self.options.arc_length.small_step,
            max_iterations: options.max_iterations,
        };
        let rate = self.rate.clone();
        if !((failed - from) * speed > options.corner) {
            // The state hardly changes: the load is as good a measure of the way.
            let constraint = Prescribed(failed);
            bordered.multipliers[0] = failed;
            self.system.set_state(&self.start);
            let border = Border { constraint: &constraint, multiplier: Multiplier::Load(&rate) };
            if bordered.solve(&mut self.system, &[border], target) {
                self.system.displacement(&self.start, &mut self.moved);
                if norm(&self.moved) <= options.corner {
                    return if is_stable(&mut self.system) {
                        Ahead::Further(failed)
                    } else {
                        Ahead::Crossing
                    };
                }
            }
        }
        if !(speed > 0.0 && speed.is_finite()) {
            return Ahead::Unknown;
        }
        let mut planes = Planes { bordered, plane: Hyperplane::default(), rate: &rate, options, target };
        let (q, slope) = (self.start.clone(), 1.0);
        let mut low = Point { at: 0.0, load: from, slope, q, direction, stable: true };
        planes.cross(&self.system, &mut low);
        let mut exact = false;
        let mut reach = ((failed - from) * speed).max(options.corner).min(options.longest);
        let high = loop {
            if self.system.budget.exhausted().is_some() || !(reach > options.shortest) {
                return Ahead::Unknown;
            }
            match planes.solve(&mut self.system, &low, reach) {
                Some(mut point) if point.rises() => {
                    if point.load > 1.0 {
                        reach *= 0.9 * (1.0 - low.load).max(0.0) / (point.load - low.load);
                        continue;
                    }
                    if point.load > from.max(low.load) {
                        return Ahead::Further(point.load);
                    }
                    if exact {
                        planes.cross(&self.system, &mut point);
                        low = point;
                        reach = (2.0 * reach).min(options.longest);
                        continue;
                    }
                }
                Some(point) => {
                    if !exact {
                        low = match planes.refine(&mut self.system, &low) {
                            Ok(refined) => refined,
                            Err(ahead) => return ahead,
                        };
                    }
                    break point;
                }
                None if exact => {
                    reach *= options.shrinkage;
                    continue;
                }
                None => {}
            }
            let mut refined = match planes.refine(&mut self.system, &low) {
                Ok(refined) => refined,
                Err(ahead) => return ahead,
            };
            planes.cross(&self.system, &mut refined);
            (low, exact) = (refined, true);
        };
        if high.slope > 0.0 {
            return Ahead::Crossing;
        }
        self.limit_point(&mut planes, low, high)
    }

    /// The largest load between a point where it rises and one where it falls.
    fn limit_point(&mut self, planes: &mut Planes, mut low: Point, mut high: Point) -> Ahead {
        let tolerance = self.located();
        let (mut last, mut k) = (high.at, 0);
        for _ in 0..self.options.locate.max_points {
            let span = high.at - low.at;
            // Where the tangents meet the load is at least as high as anywhere on a concave branch.
            let meet = (high.load - low.load - high.slope * span) / (low.slope - high.slope);
            let best = low.load.max(high.load);
            if low.load + low.slope * meet - best <= tolerance {
                break;
            }
            let top = cubic_maximum(&low, &high);
            let ahead = match k % 3 {
                0 => top,
                1 => meet,
                // Beyond a corner, as far as the last point is ahead of it.
                _ => 2.0 * meet - (last - low.at),
            };
            let at = low.at + ahead.clamp(1e-3 * span, 0.999 * span);
            let near = if at - low.at < high.at - at { &low } else { &high };
            let steepness = low.slope.min(-high.slope);
            let Some(point) = planes.solve(&mut self.system, near, at) else { break };
            last = at;
            let smooth = point.slope.abs() < 0.1 * steepness;
            k = if smooth { 0 } else { k + 1 };
            // What is left to the top of a parabola.
            let settled = smooth && point.slope.powi(2) * span <= tolerance * (low.slope - high.slope);
            if point.rises() {
                low = point;
            } else if point.slope > 0.0 {
                return Ahead::Crossing;
            } else {
                high = point;
            }
            if settled {
                break;
            }
        }
        let best = if low.load >= high.load { low } else { high };
        self.system.set_state(&best.q);
        Ahead::Limit(best.load)
    }
}

/// Where the cubic with the loads and slopes of two points is largest, ahead of the first.
fn cubic_maximum(low: &Point, high: &Point) -> f64 {
    let span = high.at - low.at;
    let mean = (high.load - low.load) / span;
    let bend = 3.0 * mean - 2.0 * low.slope - high.slope;
    let third = low.slope + high.slope - 2.0 * mean;
    // low.slope + 2 bend t + 3 third t² = 0, t in [0, 1].
    let root = (bend * bend - 3.0 * third * low.slope).max(0.0).sqrt();
    span * low.slope / (root - bend)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_largest_where_its_slope_vanishes() {
        let point = |at: f64| Point {
            at,
            load: 3.0 * at - at.powi(3),
            slope: 3.0 - 3.0 * at * at,
            q: vec![],
            direction: vec![],
            stable: true,
        };
        let found = cubic_maximum(&point(0.2), &point(1.3));
        assert!((found - 0.8).abs() < 1e-12, "{found}");
    }
}
