//! Continuation by arc length: a branch is followed through its limit points, stable or not.
//!
//! Between two listed loads the load is u₀ + μ du with μ unknown. From a point of the branch, the next
//! one is computed on the hyperplane normal to the tangent, one step ahead; see [`Bordered`]. Squared
//! lengths are ‖x‖² + w² μ², with x the dimensionless coordinates and w the displacement that the initial
//! velocity gives for the whole change of load, so that neither depends on the units of the other.

use super::bordered::{Border, Bordered, BorderedTarget, Hyperplane, Multiplier, Prescribed, weighted_dot};
use super::continuation::{Continuation, LoadStep};
use super::options::{ArcLengthOptions, ContinuationOptions};
use super::passage::{LARGEST_FALL, NEAREST};
use super::path::{PathSink, StepReport};
use super::singular::{Gradients, RelativeRates};
use super::stability::Stability;
use super::status::Status;
use super::system::System;
use super::vector::norm;
use crate::lie::LieGroup;
use crate::tolerances::PARALLEL;

/// Distance from its beginning, by the length of a step, at which a branch is closed.
const CLOSED: f64 = 1e-5;

/// A point of the branch.
#[derive(Clone, Debug)]
struct Point {
    q: Vec<f64>,
    multiplier: f64,
    /// Unit vector along the branch: dimensionless coordinates, then the multiplier.
    tangent: Vec<f64>,
}

/// A straight segment of the loads, starting at u₀.
struct Run<'a> {
    start: Vec<f64>,
    /// du, to the last load.
    rate: Vec<f64>,
    /// Positions of the listed loads on it, the last one at 1.
    listed: Vec<f64>,
    target: &'a [f64],
}

/// Follows one run.
struct ArcLength<'s, 'm, G, const D: usize, const P: usize> {
    system: &'s mut System<'m, G, D, P>,
    bordered: Bordered,
    options: ArcLengthOptions,
    target: BorderedTarget,
    rate: &'s [f64],
    /// w.
    weight: f64,
    plane: Hyperplane,
    /// With ties, the gradients of their conditions at the point reached, and the relative rates at which
    /// singular values of these change with the distance along the branch. Driven motions are unknown here, so
    /// that dead centres, where they turn back, are no singular configurations.
    gradients: Gradients,
    rates: RelativeRates,
}

impl<'m, G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'m, G, D, P> {
    /// Solves at `loads[0]` from the state `q0` and follows the branch by arc length to the last load.
    ///
    /// Every point of the branch gets a report at the load found there: the points needed to follow the
    /// branch, limit points, and all points at listed loads. A start that is an equilibrium is kept even if
    /// it is not stable. After a failure there is one more report, for the load that was not reached.
    ///
    /// # Panics
    /// If a load or `q0` has the wrong length.
    pub fn follow_arc(&mut self, loads: &[&[f64]], q0: &[f64], sink: &mut impl PathSink<G, D, P>) {
        let closed = self.with_closed_ties(loads);
        let closed: Vec<&[f64]> = closed.iter().map(Vec::as_slice).collect();
        let loads = if closed.is_empty() { loads } else { &closed };
        let Some(first) = loads.first() else { return };
        let mut reports =
            Reports { tolerance: self.options.tolerance, index: 0, iterations: 0, reached: None, sink };
        self.system.budget.restart();
        self.system.set_state(q0);
        self.system.measure_units(loads);
        self.system.set_load(first);
        let found = if self.system.has_ties() {
            self.set_ranges(loads);
            let step = LoadStep { index: 0, tangent_reuse: 0.0 };
            match self.close_ties(first, step, reports.sink) {
                Status::Converged => Ok(self.system.stability()),
                Status::Unstable => Ok(Stability::Unstable),
                status => Err(status),
            }
        } else {
            self.start_branch(q0)
        };
        reports.report(&mut self.system, found);
        if found.is_err() {
            return;
        }
        for run in runs(loads) {
            let mut arc = ArcLength::new(&mut self.system, &self.options, &run);
            if let Err(status) = arc.follow(&run, &mut reports) {
                if status == Status::Singular {
                    reports.reached = Some(self.system.input_loads().to_vec());
                }
                self.system.set_load(run.target);
                reports.report(&mut self.system, Err(status));
                return;
            }
        }
    }

    /// An equilibrium at the current load: `q0` itself, regardless of its stability, or a stable one
    /// nearby.
    fn start_branch(&mut self, q0: &[f64]) -> Result<Stability, Status> {
        self.system.set_state(q0);
        if self.system.evaluate() <= self.options.arc_length.start_residual {
            let load = self.system.load().to_vec();
            let mut bordered = Bordered::new(q0.len(), load.len(), 0);
            bordered.set_base_load(&load);
            self.system.evaluate_tangent();
            self.system.factorise(0.0);
            bordered.pin(self.system.pinned());
            if bordered.solve(&mut self.system, &[], target(&self.options)) {
                return Ok(stability(&mut self.system));
            }
            self.system.set_state(q0);
        }
        match self.find_stable(self.options.trust_region.initial_radius, 0.0) {
            Status::Converged => Ok(self.system.stability()),
            Status::Unstable => Ok(Stability::Unstable),
            status => Err(status),
        }
    }
}

fn target(options: &ContinuationOptions) -> BorderedTarget {
    BorderedTarget {
        tolerance: options.tolerance,
        small_step: options.arc_length.small_step,
        max_iterations: options.arc_length.max_iterations,
    }
}

/// Stability of the current equilibrium under its load.
fn stability<G: LieGroup<D, P>, const D: usize, const P: usize>(system: &mut System<G, D, P>) -> Stability {
    let definite = system.factorise(0.0);
    if definite || !system.is_conservative() { system.stability() } else { Stability::Unstable }
}

/// Splits listed loads into straight runs.
fn runs<'a>(loads: &[&'a [f64]]) -> Vec<Run<'a>> {
    let difference = |a: &[f64], b: &[f64]| -> Vec<f64> { b.iter().zip(a).map(|(b, a)| b - a).collect() };
    let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
    let mut runs: Vec<Run> = vec![];
    for pair in loads.windows(2) {
        let [before, after] = [pair[0], pair[1]];
        let change = difference(before, after);
        if length(&change) == 0.0 {
            continue;
        }
        if let Some(run) = runs.last_mut() {
            let along = run.rate.iter().zip(&change).map(|(a, b)| a * b).sum::<f64>();
            if along > 0.0 && along * along > (1.0 - PARALLEL) * length(&run.rate) * length(&change) {
                let whole = difference(&run.start, after);
                run.listed.push(length(&whole).sqrt());
                (run.rate, run.target) = (whole, after);
                continue;
            }
        }
        let listed = vec![0.0, length(&change).sqrt()];
        runs.push(Run { start: before.to_vec(), rate: change, listed, target: after });
    }
    for run in &mut runs {
        let whole = run.listed[run.listed.len() - 1];
        run.listed.iter_mut().for_each(|l| *l /= whole);
    }
    runs
}

/// Forwards points to the sink.
struct Reports<'s, S> {
    /// Largest residual of a point.
    tolerance: f64,
    index: usize,
    iterations: usize,
    /// The load at which a branch ends in a singular configuration.
    reached: Option<Vec<f64>>,
    sink: &'s mut S,
}

impl<S> Reports<'_, S> {
    fn report<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        found: Result<Stability, Status>,
    ) where
        S: PathSink<G, D, P>,
    {
        let iterations = system.budget.iterations() - self.iterations;
        let (status, stability) = match found {
            Ok(Stability::Unstable) => (Status::Unstable, Stability::Unstable),
            Ok(stability) => (Status::Converged, stability),
            Err(status) => (status, Stability::Unknown),
        };
        if found.is_ok() {
            system.is_balanced(self.tolerance);
        }
        let free = if stability == Stability::Neutral { system.free_coordinates() } else { vec![] };
        let (q, accuracy) = (system.state(), system.accuracy());
        let reached = self.reached.as_deref();
        let report = StepReport { status, q, iterations, stability, accuracy, reached, free: &free };
        self.sink.step(self.index, report, system);
        self.index += 1;
        self.iterations = system.budget.iterations();
    }
}

impl<'s, 'm, G: LieGroup<D, P>, const D: usize, const P: usize> ArcLength<'s, 'm, G, D, P> {
    /// Starts at the current equilibrium of the system, the beginning of the run.
    fn new(system: &'s mut System<'m, G, D, P>, options: &ContinuationOptions, run: &'s Run) -> Self {
        let (n, inputs) = (system.state().len(), system.load().len());
        let mut bordered = Bordered::new(n, inputs, 1);
        bordered.set_base_load(&run.start);
        bordered.pin(system.pinned());
        Self {
            system,
            bordered,
            options: options.arc_length,
            target: target(options),
            rate: &run.rate,
            weight: 1.0,
            plane: Hyperplane { origin: vec![0.0; n], normal: vec![0.0; n], ..Hyperplane::default() },
            gradients: Gradients::default(),
            rates: RelativeRates::default(),
        }
    }

    /// Follows the run to its last load.
    fn follow<S: PathSink<G, D, P>>(&mut self, run: &Run, reports: &mut Reports<S>) -> Result<(), Status> {
        self.system.budget.restart();
        reports.iterations = 0;
        let first = self.first_point();
        let mut here = first.clone();
        // The step whose load would be the first listed one.
        let begin = run.listed[1] / here.tangent[here.q.len()];
        let mut length = begin;
        self.look_ahead(&here)?;
        loop {
            if let Some(status) = self.system.budget.exhausted() {
                return Err(status);
            }
            let Some(next) = self.step(&here, length, begin) else {
                length *= 0.5;
                let close = length * self.rates.fall > LARGEST_FALL;
                if !(length > self.options.min_step * begin || close) {
                    return Err(Status::Stalled);
                }
                continue;
            };
            if let Some(limit) = self.limit_point(&here, &next, length) {
                if self.report_listed(run, &here, &limit, reports)? {
                    return Ok(());
                }
                self.go_to(&limit);
                // There the tangent is singular.
                reports.report(self.system, Ok(Stability::Unstable));
                if self.report_listed(run, &limit, &next, reports)? {
                    return Ok(());
                }
            } else if self.report_listed(run, &here, &next, reports)? {
                return Ok(());
            }
            self.go_to(&next);
            let stability = stability(self.system);
            reports.report(self.system, Ok(stability));
            if here.q != first.q && self.passes(&here, &next, length, &first) {
                return Err(Status::ClosedBranch);
            }
            length *= (self.options.turn / self.angle(&here, &next)).clamp(0.5, 2.0);
            here = next;
            self.look_ahead(&here)?;
        }
    }

    /// Whether the branch passes a point between two others, in the direction that it has there.
    fn passes(&mut self, here: &Point, next: &Point, length: f64, point: &Point) -> bool {
        let away = self.chord(here, point);
        let along = weighted_dot(&away, &here.tangent, self.weight);
        let far = weighted_dot(&away, &away, self.weight).sqrt();
        if !(0.0..length).contains(&along) || far > self.options.max_reach * length {
            return false;
        }
        let guess = self.cubic(here, next).at(along / length);
        let Some(found) = self.solve_at(here, along, &guess) else { return false };
        let gap = self.chord(&found, point);
        let same = weighted_dot(&gap, &gap, self.weight).sqrt() <= CLOSED * length;
        self.go_to(next);
        same && self.angle(&found, point) < std::f64::consts::FRAC_PI_2
    }

    /// Displacement from one point to another, with that of the multiplier.
    fn chord(&self, from: &Point, to: &Point) -> Vec<f64> {
        let moved = from.q.iter().zip(&to.q).zip(self.system.units()).map(|((a, b), u)| (b - a) / u);
        moved.chain([to.multiplier - from.multiplier]).collect()
    }

    /// The point at the beginning of the run, directed towards its end.
    fn first_point(&mut self) -> Point {
        let n = self.system.state().len();
        let q = self.system.state().to_vec();
        self.bordered.multipliers[0] = 0.0;
        let border = Border { constraint: &Prescribed(0.0), multiplier: Multiplier::Load(self.rate) };
        self.bordered.solve(self.system, &[border], self.target);
        let mut tangent = vec![0.0; n + 1];
        tangent[n] = 1.0;
        self.bordered.solve_step(&mut tangent);
        let moved = norm(&tangent[..n]);
        self.weight = if moved.is_finite() && moved > 0.0 { moved } else { 1.0 };
        self.normalise(&mut tangent);
        Point { q, multiplier: 0.0, tangent }
    }

    /// Takes what is known of ties at the current point of the branch; fails in a singular configuration.
    fn look_ahead(&mut self, here: &Point) -> Result<(), Status> {
        if self.system.has_ties() {
            self.rates = self.rates_at(here);
            if self.rates.speed < NEAREST * self.rates.fall {
                self.gradients.take(self.system);
                let shares = self.gradients.weakest();
                self.system.set_weakest(shares);
                return Err(Status::Singular);
            }
        }
        Ok(())
    }

    fn rates_at(&mut self, here: &Point) -> RelativeRates {
        let (velocity, load) = here.tangent.split_at(here.q.len());
        let rate: Vec<f64> = self.rate.iter().map(|r| r * load[0]).collect();
        self.system.singular_rates(&rate, velocity, true)
    }

    /// The point of the branch one step ahead; `None` where none on the same branch is found.
    fn step(&mut self, here: &Point, length: f64, begin: f64) -> Option<Point> {
        if length * self.rates.fall > LARGEST_FALL {
            return None;
        }
        let ahead: Vec<f64> = here.tangent.iter().map(|t| length * t).collect();
        let next = self.solve_at(here, length, &ahead)?;
        if self.system.has_ties() && !(length * self.rates_at(&next).rise <= LARGEST_FALL) {
            return None;
        }
        let turn = self.angle(here, &next);
        // At a corner the branch turns by the same angle for any step.
        (turn <= self.options.max_turn || length <= self.options.corner_step * begin).then_some(next)
    }

    /// The point on the plane `distance` along the tangent of `here`, solved from an initial guess `ahead`
    /// of it.
    fn solve_at(&mut self, here: &Point, distance: f64, ahead: &[f64]) -> Option<Point> {
        let n = here.q.len();
        let units = self.system.units();
        for (normal, (t, u)) in self.plane.normal.iter_mut().zip(here.tangent.iter().zip(units)) {
            *normal = t / u;
        }
        self.plane.along_multiplier = self.weight * self.weight * here.tangent[n];
        self.plane.origin.copy_from_slice(&here.q);
        self.plane.multiplier = here.multiplier;
        self.plane.distance = distance;
        self.system.advance_from(&here.q, &ahead[..n], 1.0);
        self.bordered.multipliers[0] = here.multiplier + ahead[n];
        let border = Border { constraint: &self.plane, multiplier: Multiplier::Load(self.rate) };
        if !self.bordered.solve(self.system, &[border], self.target) {
            return None;
        }
        let mut tangent = vec![0.0; n + 1];
        tangent[n] = 1.0;
        if !self.bordered.solve_step(&mut tangent) {
            return None;
        }
        self.normalise(&mut tangent);
        let multiplier = self.bordered.multipliers[0];
        let mut moved = vec![0.0; n + 1];
        self.system.displacement(&here.q, &mut moved[..n]);
        moved[n] = multiplier - here.multiplier;
        let reach = weighted_dot(&moved, &moved, self.weight).sqrt();
        // A deviation larger than the step: another branch.
        let found = Point { q: self.system.state().to_vec(), multiplier, tangent };
        (reach <= self.options.max_reach * distance).then_some(found)
    }

    fn normalise(&self, tangent: &mut [f64]) {
        let length = weighted_dot(tangent, tangent, self.weight).sqrt();
        tangent.iter_mut().for_each(|t| *t /= length);
    }

    /// Angle between the tangents of the branch at two points.
    fn angle(&self, here: &Point, next: &Point) -> f64 {
        // Between unit vectors, exact for small angles.
        let gap: Vec<f64> = here.tangent.iter().zip(&next.tangent).map(|(a, b)| a - b).collect();
        2.0 * (0.5 * weighted_dot(&gap, &gap, self.weight).sqrt()).min(1.0).asin()
    }

    /// The limit point on a step of this length, if there is one.
    fn limit_point(&mut self, here: &Point, next: &Point, length: f64) -> Option<Point> {
        let (along, weight) = (here.q.len(), self.weight);
        if here.tangent[along] * next.tangent[along] >= 0.0 {
            return None;
        }
        self.locate(here, next, length, |point| weight * point.tangent[along])
    }

    /// Where on a step a function changes its sign (regula falsi, Illinois).
    fn locate(
        &mut self,
        here: &Point,
        next: &Point,
        length: f64,
        f: impl Fn(&Point) -> f64,
    ) -> Option<Point> {
        let (mut low, mut high) = (0.0, length);
        let (mut f_low, mut f_high) = (f(here), f(next));
        let cubic = self.cubic(here, next);
        let (mut last, mut found) = (0.0, None);
        for _ in 0..self.options.max_locating {
            let at = (low * f_high - high * f_low) / (f_high - f_low);
            // At the dead centre itself, to rounding, a driven motion has no rate: what is close has to do.
            let Some(point) = self.solve_at(here, at, &cubic.at(at / length)) else { break };
            let value = f(&point);
            found = Some(point);
            if value.abs() <= self.options.located || high - low <= self.options.located * length {
                break;
            }
            let twice = if last * value > 0.0 { 0.5 } else { 1.0 };
            if value * f_low > 0.0 {
                (low, f_low) = (at, value);
                f_high *= twice;
            } else {
                (high, f_high) = (at, value);
                f_low *= twice;
            }
            last = value;
        }
        found
    }

    /// The cubic from one point to another with the tangents there.
    fn cubic(&self, from: &Point, to: &Point) -> Cubic {
        let chord = self.chord(from, to);
        let length = weighted_dot(&chord, &chord, self.weight).sqrt();
        let slope = |p: &Point| p.tangent.iter().map(|t| length * t).collect();
        Cubic { slopes: [slope(from), slope(to)], chord }
    }

    /// Reports the equilibria at listed loads between two points; whether the last load is reached.
    fn report_listed<S: PathSink<G, D, P>>(
        &mut self,
        run: &Run,
        from: &Point,
        to: &Point,
        reports: &mut Reports<S>,
    ) -> Result<bool, Status> {
        let (a, b) = (from.multiplier, to.multiplier);
        let first = run.listed.partition_point(|l| *l <= a.min(b));
        let last = run.listed.partition_point(|l| *l < a.max(b) || b == 1.0);
        let mut between = run.listed[first..last.max(first)].to_vec();
        if b < a {
            between.reverse();
        }
        for listed in between {
            if let Some(status) = self.system.budget.exhausted() {
                return Err(status);
            }
            let found = self.solve_listed(run, from, to, listed);
            if found {
                let stability = stability(self.system);
                reports.report(self.system, Ok(stability));
            }
            if listed == 1.0 {
                return if found { Ok(true) } else { Err(Status::Stalled) };
            }
        }
        Ok(false)
    }

    /// Solves at a listed load, from the cubic between two points of the branch.
    fn solve_listed(&mut self, run: &Run, from: &Point, to: &Point, listed: f64) -> bool {
        let n = from.q.len();
        let cubic = self.cubic(from, to);
        let (mut low, mut high) = (0.0, 1.0);
        while high - low > self.options.located {
            let middle = 0.5 * (low + high);
            let short = (from.multiplier + cubic.component(middle, n) < listed) == (cubic.chord[n] > 0.0);
            if short { low = middle } else { high = middle }
        }
        self.system.advance_from(&from.q, &cubic.at(low)[..n], 1.0);
        self.bordered.multipliers[0] = listed;
        let border = Border { constraint: &Prescribed(listed), multiplier: Multiplier::Load(self.rate) };
        let found = self.bordered.solve(self.system, &[border], self.target);
        if found && listed == 1.0 {
            // Exactly the listed load.
            self.system.set_load(run.target);
        }
        found
    }

    /// Restores a point that was solved.
    fn go_to(&mut self, point: &Point) {
        if self.system.state() != point.q {
            self.system.set_state(&point.q);
            self.bordered.multipliers[0] = point.multiplier;
            let border = Border { constraint: &self.plane, multiplier: Multiplier::Load(self.rate) };
            self.bordered.visit(self.system, &[border]);
        }
    }
}

/// A cubic from one point to another, as the displacement from the first.
struct Cubic {
    chord: Vec<f64>,
    slopes: [Vec<f64>; 2],
}

impl Cubic {
    fn component(&self, s: f64, i: usize) -> f64 {
        let (s2, s3) = (s * s, s * s * s);
        let [first, last] = &self.slopes;
        (3.0 * s2 - 2.0 * s3) * self.chord[i] + (s - 2.0 * s2 + s3) * first[i] + (s3 - s2) * last[i]
    }

    fn at(&self, s: f64) -> Vec<f64> {
        (0..self.chord.len()).map(|i| self.component(s, i)).collect()
    }
}
