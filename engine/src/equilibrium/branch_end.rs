//! Location of the end of a branch between an equilibrium and a sub-step that could not be made.
//!
//! States of the branch are computed on hyperplanes n·(q − q₀) = s, with n the velocity at the last
//! equilibrium and the load unknown, so that [`Bordered`] finds them on both sides of a limit point: a
//! maximum of the load, smooth or in a corner. Where the tangent loses its definiteness while the load still
//! rises, there is a branch point.

use super::bordered::{Border, Bordered, BorderedTarget, Hyperplane, Multiplier, Prescribed};
use super::continuation::Continuation;
use super::jump::NEGLIGIBLE_PROGRESS;
use super::planes::{BranchAhead, PlaneSolver, Point, is_stable};
use super::point_motion::PointMotion;
use super::vector::norm;
use crate::lie::LieGroup;

/// Part of the distance between two states within which a corner is close to the first.
const CLOSE: f64 = 1e-2;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'_, G, D, P> {
    /// Finds what happens to the branch between the equilibrium in `start`, at `from`, and `failed`, which no
    /// sub-step reached.
    pub(super) fn locate_branch_end(&mut self, from: f64, failed: f64) -> BranchAhead {
        let n = self.start.len();
        let speed = norm(&self.velocity[0]);
        let options = self.options.locate;
        let direction = self.velocity[0].clone();
        let mut bordered = Bordered::new(n, self.rate.len(), 1);
        bordered.set_base_load(&self.start_load);
        if !self.system.data().design.units.all_elastic() {
            // What is free must not slide to the planes in place of the rest.
            self.restore_at(&self.start.clone(), from);
            bordered.pin(self.system.pinned());
        }
        let target = BorderedTarget {
            tolerance: self.options.tolerance.max(options.residual),
            small_step: self.options.arc_length.small_step,
            max_iterations: options.max_iterations,
        };
        let rate = self.rate.clone();
        if !((failed - from) * speed > options.corner) {
            // Where the state hardly changes, the load is prescribed instead of the displacement.
            let constraint = Prescribed(failed);
            bordered.multipliers[0] = failed;
            self.system.set_state(&self.start);
            let border = Border { constraint: &constraint, multiplier: Multiplier::Load(&rate) };
            let exact = BorderedTarget { tolerance: self.options.tolerance, ..target };
            if bordered.solve(&mut self.system, &[border], exact) {
                self.system.displacement(&self.start, &mut self.moved);
                if norm(&self.moved) <= options.corner {
                    return if is_stable(&mut self.system) {
                        BranchAhead::Continues(failed)
                    } else {
                        BranchAhead::BranchPoint
                    };
                }
            }
        }
        if !(speed > options.still && speed.is_finite()) {
            return if self.loses_stability_at_rest(failed) {
                BranchAhead::BranchPoint
            } else {
                BranchAhead::Unknown
            };
        }
        let motion = PointMotion::new(self.system.model());
        let (plane, mixed) = (Hyperplane::default(), self.options.mixed);
        let mut planes = PlaneSolver { bordered, motion, mixed, plane, rate: &rate, options, target };
        let (q, slope) = (self.start.clone(), 1.0);
        let mut low = Point { at: 0.0, load: from, slope, q, direction, stable: true };
        planes.set_origin(&self.system, &mut low);
        // A state from which the branch is followed further need not be exact, only close enough that its load
        // is that of the branch where it is nearly level.
        let near_end = self.options.accuracy.residual_near_end * (failed - from) * self.rate_of_change();
        let rough = BorderedTarget { tolerance: near_end.max(target.tolerance), ..target };
        let mut exact = false;
        // Whether the load falls at once, as where the ends of a compressed spring pass each other.
        let mut falls = false;
        let mut reach = ((failed - from) * speed).max(options.corner).min(options.longest);
        // Number of states on the way.
        let mut marched = 0;
        let high = loop {
            if self.system.budget.exhausted().is_some() {
                return BranchAhead::Unknown;
            }
            if !(reach > options.shortest) {
                // The load falls at once or no state nearby is followed: the branch may end in a corner.
                if falls || exact {
                    self.system.set_state(&low.q);
                    return BranchAhead::LimitPoint(low.load);
                }
                return BranchAhead::Unknown;
            }
            match planes.solve(&mut self.system, &low, reach, if exact { target } else { rough }) {
                Some(mut point) if point.is_followed() => {
                    let farthest = (2.0 * failed - from).min(1.0);
                    if point.load > farthest {
                        reach *= 0.9 * (farthest - low.load).max(0.0) / (point.load - low.load);
                        continue;
                    }
                    if point.load > from.max(low.load) && point.load < 1.0 {
                        marched += 1;
                        let far = point.load - from >= NEGLIGIBLE_PROGRESS * (failed - from);
                        if far || marched >= options.max_points {
                            return BranchAhead::Continues(point.load);
                        }
                        planes.set_origin(&self.system, &mut point);
                        low = point;
                        reach = (2.0 * reach).min(options.longest);
                        continue;
                    }
                    if exact && point.load < low.load {
                        falls = true;
                        reach *= options.shrinkage;
                        continue;
                    }
                    if exact {
                        planes.set_origin(&self.system, &mut point);
                        low = point;
                        reach = (2.0 * reach).min(options.longest);
                        continue;
                    }
                }
                Some(point) if exact => break point,
                Some(point) => {
                    let high = planes.solve(&mut self.system, &point, point.at, target);
                    low = match planes.refine(&mut self.system, &low) {
                        Ok(refined) => refined,
                        Err(ahead) => return ahead,
                    };
                    if let Some(high) = high.filter(|high| !high.is_followed()) {
                        break high;
                    }
                    planes.set_origin(&self.system, &mut low);
                    exact = true;
                    continue;
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
            planes.set_origin(&self.system, &mut refined);
            (low, exact) = (refined, true);
        };
        if high.slope > 0.0 {
            // In a corner, stability is lost at once.
            if exact && (high.load - low.load).abs() <= options.beyond * self.span() {
                self.system.set_state(&low.q);
                return BranchAhead::LimitPoint(low.load);
            }
            return BranchAhead::BranchPoint;
        }
        self.locate_limit_point(&mut planes, low, high)
    }

    /// Whether the state in `start` is an equilibrium at `failed` too, but no stable one.
    fn loses_stability_at_rest(&mut self, failed: f64) -> bool {
        self.system.set_load_between(&self.start_load, &self.rate, failed);
        self.system.set_state(&self.start);
        let size = self.system.evaluate();
        self.system.evaluate_tangent();
        size <= self.options.locate.residual && !is_stable(&mut self.system)
    }

    /// Locates the limit point between a point where the load rises and one where it falls.
    fn locate_limit_point(
        &mut self,
        planes: &mut PlaneSolver<D, P>,
        mut low: Point,
        mut high: Point,
    ) -> BranchAhead {
        let tolerance = self.located();
        let (mut last, mut k) = (high.at, 0);
        // Part of the way to the next state, less where none was found.
        let mut part = 1.0;
        for _ in 0..self.options.locate.max_points {
            if self.system.budget.exhausted().is_some() {
                return BranchAhead::Unknown;
            }
            let span = high.at - low.at;
            // The load where the tangents meet is an upper bound on a concave branch.
            let meet = (high.load - low.load - high.slope * span) / (low.slope - high.slope);
            let best = low.load.max(high.load);
            let above = is_above(&low, &high);
            let concave = !above && 0.0 < meet && meet < span;
            let rise = low.slope * if concave { meet } else { span };
            let risen = !above && low.load + rise - best <= tolerance;
            // The load may fall faster close to a corner than where it is known to fall.
            let close = meet > CLOSE * span || low.slope * span <= tolerance;
            if risen && close {
                break;
            }
            let top = cubic_maximum(&low, &high);
            let ahead = match k % 3 {
                _ if !concave => 0.5 * span,
                _ if risen => 2.0 * CLOSE * span,
                0 => top,
                1 => meet,
                // As far beyond a corner as the last point was ahead of it.
                _ => 2.0 * meet - (last - low.at),
            };
            let at = low.at + part * ahead.clamp(1e-3 * span, 0.999 * span);
            let near = if at - low.at < high.at - at { &low } else { &high };
            let steepness = low.slope.min(-high.slope);
            let Some(point) = planes.solve(&mut self.system, near, at, planes.target) else {
                part *= self.options.locate.shrinkage;
                continue;
            };
            part = 1.0;
            last = at;
            let smooth = point.slope.abs() < 0.1 * steepness;
            k = if smooth { 0 } else { k + 1 };
            // The remaining rise of a parabola.
            let settled = smooth && point.slope.powi(2) * span <= tolerance * (low.slope - high.slope);
            if point.is_followed() {
                low = point;
            } else if point.slope > 0.0 {
                return BranchAhead::BranchPoint;
            } else {
                high = point;
            }
            if settled {
                break;
            }
        }
        let best = if low.load >= high.load || is_above(&low, &high) { low } else { high };
        self.system.set_state(&best.q);
        BranchAhead::LimitPoint(best.load)
    }
}

/// Whether the load at the second point is larger than the slope at the first explains: it is on another branch, or the
/// load rises faster in between.
fn is_above(low: &Point, high: &Point) -> bool {
    high.load > low.load + low.slope * (high.at - low.at)
}

/// Distance from the first point to the maximum of the cubic Hermite interpolant of the load.
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
