//! Where the branch goes from an equilibrium, to first order: straight from one change of contact to
//! the next.
//!
//! What bends it between them is taken to go on as over the last sub-step.
//!
//! A contact that closes adds k g gᵀ to the tangent, g being the gradient of its overlap, and one that
//! opens takes it away; by Sherman and Morrison's formula the velocity turns by a multiple of H⁻¹ g.
//! Where what is left is no longer positive definite, the branch ends.

use super::factor::Factor;
use super::solver::{Solver, dot, norm};
use crate::forces::element::Switch;
use crate::lie::LieGroup;
use crate::linalg::{LANES, Vector};
use crate::model::Model;

/// Changes of contact that are followed.
const CHANGES: usize = 5;
/// Pairs are watched that would meet if they came this many times faster than they do,
const SURPRISE: f64 = 2.0;
/// and at this share of the fastest point's speed more.
const DRIFT: f64 = 0.1;
/// The last sub-step shows a bend where it missed the displacement by half the velocity's turn, to
/// within this,
const EVEN: f64 = 0.25;
/// along it (cosine),
const ALONG: f64 = 0.8;
/// and did not turn by more than this share of the speed.
const BENT: f64 = 0.3;

/// A sphere that touches another body or may come to.
#[derive(Clone, Debug)]
struct Pair<const P: usize> {
    /// Points p, a, b; the contact is at (1 − t) a + t b.
    points: [usize; 3],
    t: f64,
    normal: Vector<P>,
    /// Overlap, negative while they are apart, and its rate.
    depth: f64,
    rate: f64,
    stiffness: f64,
    touching: bool,
    /// Whether it has changed already; once is enough for a first-order view.
    changed: bool,
}

/// A rank-one change of the inverse tangent, H⁻¹ − factor · w (gᵀ H⁻¹).
#[derive(Clone, Debug)]
struct Update {
    gradient: Vec<f64>,
    /// w = H⁻¹ g, with the changes before it.
    solved: Vec<f64>,
    factor: f64,
}

/// One straight piece.
#[derive(Clone, Debug)]
struct Piece {
    /// Where it ends.
    end: f64,
    velocity: Vec<f64>,
}

/// The pieces ahead and the memory to find them, which grows to what the model needs.
#[derive(Clone, Debug, Default)]
pub(super) struct Prediction<const D: usize, const P: usize> {
    /// The tangent where they begin.
    factor: Factor<D>,
    pieces: Vec<Piece>,
    count: usize,
    /// d²q/dλ² (dimensionless) on each piece; zero where it is not known.
    bend: Vec<f64>,
    /// Where the branch ends; infinite when no end is in sight.
    pub branch_end: f64,
    updates: Vec<Update>,
    pairs: Vec<Pair<P>>,
    twist: Vec<Vector<D>>,
    wrench: Vec<Vector<D>>,
    /// Velocities of all points.
    points: Vec<Vector<P>>,
    /// Actual rates of the coordinates, and the same in blocks.
    rates: Vec<f64>,
    blocks: Vec<Vector<LANES>>,
}

impl<const D: usize, const P: usize> Prediction<D, P> {
    pub fn new<G: LieGroup<D, P>>(model: &Model<G, D, P>) -> Self {
        let n = model.dof;
        let changes = if model.has_switches() { CHANGES } else { 0 };
        let piece = Piece { end: 0.0, velocity: vec![0.0; n] };
        let update = Update { gradient: vec![0.0; n], solved: vec![0.0; n], factor: 0.0 };
        Self {
            factor: Factor::new(model),
            pieces: vec![piece; changes + 1],
            count: 0,
            bend: vec![0.0; n],
            branch_end: f64::INFINITY,
            updates: vec![update; changes],
            pairs: vec![],
            twist: vec![Vector::ZERO; model.frames.len()],
            wrench: vec![Vector::ZERO; model.frames.len()],
            points: vec![Vector::ZERO; model.points.len()],
            rates: vec![0.0; n],
            blocks: model.coordinate_blocks.zeros(),
        }
    }

    /// The displacement (dimensionless) after `h`.
    pub fn displacement(&self, h: f64, out: &mut [f64]) {
        out.iter_mut().zip(&self.bend).for_each(|(x, a)| *x = 0.5 * h * h * a);
        let mut start = 0.0;
        for (i, piece) in self.pieces[..self.count].iter().enumerate() {
            let end = if i + 1 == self.count { h } else { piece.end.min(h) };
            out.iter_mut().zip(&piece.velocity).for_each(|(x, v)| *x += (end - start) * v);
            if end >= h {
                break;
            }
            start = end;
        }
    }

    /// The velocity (dimensionless) after `h`.
    pub fn velocity(&self, h: f64) -> impl Iterator<Item = f64> {
        self.pieces[self.changes(h)].velocity.iter().zip(&self.bend).map(move |(v, a)| v + h * a)
    }

    /// Nothing is known of how the branch bends.
    pub fn forget_bend(&mut self) {
        self.bend.fill(0.0);
    }

    /// The load goes on `ratio` times as fast, or elsewhere if that is zero.
    pub fn rescale_bend(&mut self, ratio: f64) {
        self.bend.iter_mut().for_each(|a| *a *= ratio * ratio);
    }

    /// Solves H x = b in place, with the tangent as it will be after `h`.
    pub fn solve(&self, h: f64, b: &mut [f64]) {
        solve_updated(&self.factor, &self.updates[..self.changes(h)], b);
    }

    /// How many changes of contact come before `h`.
    fn changes(&self, h: f64) -> usize {
        self.pieces[..self.count - 1].partition_point(|piece| piece.end < h)
    }
}

fn solve_updated<const D: usize>(start: &Factor<D>, updates: &[Update], b: &mut [f64]) {
    start.solve(b);
    for update in updates {
        let along = update.factor * dot(&update.gradient, b);
        b.iter_mut().zip(&update.solved).for_each(|(x, w)| *x -= along * w);
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Solver<G, D, P> {
    /// Predicts the branch from the equilibrium evaluated last, whose factor is at hand and is taken
    /// over, and whose velocity is `velocity[0]`, over at most `h` and at most a displacement of norm
    /// `longest`. Returns how far that is.
    pub(super) fn predict(&mut self, model: &Model<G, D, P>, h: f64, longest: f64) -> f64 {
        let mut ahead = std::mem::take(&mut self.prediction);
        std::mem::swap(&mut ahead.factor, &mut self.factor);
        ahead.branch_end = f64::INFINITY;
        ahead.count = 1;
        ahead.pieces[0].velocity.copy_from_slice(&self.velocity[0]);
        let mut speed = norm(&self.velocity[0]);
        let mut limit = h.min(longest / speed);
        if model.has_switches() {
            self.data.complete_columns(model);
            self.move_points(model, &mut ahead);
            self.find_pairs(model, &mut ahead, limit);
        }
        let mut start = 0.0;
        let mut left = longest;
        while let Some((next, i)) = ahead.next_change(start, limit) {
            let last = ahead.count - 1;
            ahead.pieces[last].end = next;
            left -= (next - start) * speed;
            if last == CHANGES {
                break;
            }
            ahead.pairs.iter_mut().for_each(|p| p.depth += (next - start) * p.rate);
            start = next;
            if !self.change_contact(model, &mut ahead, i) {
                ahead.branch_end = next;
                break;
            }
            self.move_points(model, &mut ahead);
            ahead.update_rates();
            speed = norm(&ahead.pieces[last + 1].velocity);
            limit = h.min(start + left / speed);
        }
        self.prediction = ahead;
        limit
    }

    /// Takes the bend from what the prediction without it missed over the sub-step of `h` just done.
    pub(super) fn learn_bend(&mut self, h: f64) {
        self.prediction.forget_bend();
        self.prediction.displacement(h, &mut self.work);
        let last = self.prediction.changes(h);
        let Prediction { pieces, bend, .. } = &mut self.prediction;
        let (mut turned, mut missed, mut both, mut speed) = (0.0, 0.0, 0.0, 0.0);
        let states = self.q.iter().zip(&self.start).zip(&self.unit).zip(&self.work);
        let velocities = self.velocity[1].iter().zip(&pieces[last].velocity);
        for (a, ((((q, s), u), d), (v, expected))) in bend.iter_mut().zip(states.zip(velocities)) {
            let (turn, miss) = (h * (v - expected), (q - s) / u - d);
            turned += turn * turn;
            missed += miss * miss;
            both += turn * miss;
            speed += v * v;
            *a = turn / (h * h);
        }
        let steady = (both / turned - 0.5).abs() < EVEN && both > ALONG * (turned * missed).sqrt();
        if !(steady && turned.sqrt() < BENT * h * speed.sqrt()) {
            self.prediction.forget_bend();
        }
    }

    /// Velocities of the points along the last piece.
    fn move_points(&self, model: &Model<G, D, P>, ahead: &mut Prediction<D, P>) {
        let velocity = &ahead.pieces[ahead.count - 1].velocity;
        for (r, (v, u)) in ahead.rates.iter_mut().zip(velocity.iter().zip(&self.unit)) {
            *r = v * u;
        }
        model.coordinate_blocks.gather(&ahead.rates, &mut ahead.blocks);
        self.data.velocities(model, &ahead.blocks, &mut ahead.twist, &mut ahead.points);
    }

    fn find_pairs(&self, model: &Model<G, D, P>, ahead: &mut Prediction<D, P>, h: f64) {
        ahead.pairs.clear();
        let squares = model.spheres.iter().map(|s| ahead.points[s.point].dot(&ahead.points[s.point]));
        let fastest = squares.fold(0.0, f64::max).sqrt();
        // Nothing that is further apart meets at this speed; what the changes speed up may be missed.
        let margin = fastest * h;
        self.data.for_each_switch(model, &self.q, &self.load, margin, |switch| {
            if switch.stiffness.is_sign_negative() {
                // The sphere that two round cones share: one of them is enough.
                if ahead.pairs.last().is_some_and(|last| last.points == switch.points) {
                    ahead.pairs.pop();
                }
                return;
            }
            let rate = switch.rate(&ahead.points);
            let Switch { points, t, normal, depth, stiffness } = switch;
            // Far off, and not even slowly on its way.
            if -depth > (SURPRISE * rate.max(0.0) + DRIFT * fastest) * h {
                return;
            }
            let (touching, changed) = (depth > 0.0, false);
            ahead.pairs.push(Pair { points, t, normal, depth, rate, stiffness, touching, changed });
        });
    }

    /// Starts the piece that follows the change of pair `i`; `false` when the branch ends there.
    fn change_contact(&self, model: &Model<G, D, P>, ahead: &mut Prediction<D, P>, i: usize) -> bool {
        let Prediction { factor: start, pieces, count, updates, pairs, wrench, .. } = ahead;
        let pair = &mut pairs[i];
        let stiffness = if pair.touching { -pair.stiffness } else { pair.stiffness };
        pair.touching = !pair.touching;
        pair.changed = true;
        let (before, rest) = updates.split_at_mut(*count - 1);
        let Update { gradient, solved, factor } = &mut rest[0];
        wrench.fill(Vector::ZERO);
        for (point, share) in pair.points.into_iter().zip([-1.0, 1.0 - pair.t, pair.t]) {
            let jacobian = G::point_jacobian(&self.data.kinematics.points[point]);
            wrench[model.points[point].frame] += jacobian.transpose_times(&pair.normal) * share;
        }
        gradient.fill(0.0);
        self.data.assembly.add_forces(model, wrench, gradient);
        gradient.iter_mut().zip(&self.data.design.scale).for_each(|(g, s)| *g *= s);
        solved.copy_from_slice(gradient);
        solve_updated(start, before, solved);
        let left = 1.0 + stiffness * dot(gradient, solved);
        if !(left > 0.0) {
            return false;
        }
        *factor = stiffness / left;
        let (done, next) = pieces.split_at_mut(*count);
        let velocity = &done[*count - 1].velocity;
        let turn = *factor * dot(gradient, velocity);
        for (next, (v, w)) in next[0].velocity.iter_mut().zip(velocity.iter().zip(&*solved)) {
            *next = v - turn * w;
        }
        *count += 1;
        true
    }
}

impl<const D: usize, const P: usize> Prediction<D, P> {
    /// When the next pair changes, not later than `limit`, and which.
    fn next_change(&self, start: f64, limit: f64) -> Option<(f64, usize)> {
        let mut first = None;
        let mut nearest = limit - start;
        for (i, pair) in self.pairs.iter().enumerate() {
            let (way, speed) =
                if pair.touching { (pair.depth, -pair.rate) } else { (-pair.depth, pair.rate) };
            if speed > 0.0 && !pair.changed && way < nearest * speed {
                nearest = (way / speed).max(0.0);
                first = Some(i);
            }
        }
        first.map(|i| (start + nearest, i))
    }

    fn update_rates(&mut self) {
        for pair in &mut self.pairs {
            let [p, a, b] = pair.points.map(|i| self.points[i]);
            pair.rate = -pair.normal.dot(&(p - a * (1.0 - pair.t) - b * pair.t));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::{Options, Status};
    use crate::lie::SE2;
    use crate::systems::finger;

    type Planar = Solver<SE2, 3, 2>;

    /// Goes to the equilibrium at `load` nearest to the state at hand; returns what touches.
    fn go_to(solver: &mut Planar, model: &Model<SE2, 3, 2>, load: f64) -> Vec<(usize, Option<[usize; 2]>)> {
        solver.load[0] = load;
        assert_eq!(solver.settle(model, 0.1, 0.0), Status::Converged);
        solver.set_velocity(model, &[1.0], 0);
        let of = |force: crate::ContactForce<2>| (force.first, force.second);
        solver.data().contact_forces(model).into_iter().map(of).collect()
    }

    #[test]
    fn the_velocity_behind_a_change_of_contact_is_foreseen() {
        let model = Model::<SE2, 3, 2>::new(&finger()).unwrap();
        let mut solver = Planar::new(&model, Options::default());
        let (mut closed, mut opened) = (0, 0);
        let mut touching = go_to(&mut solver, &model, 0.0);
        for k in 1..=800 {
            let (mut low, mut high) = (0.01 * (k - 1) as f64, 0.01 * k as f64);
            let mut before = solver.clone();
            let found = go_to(&mut solver, &model, high);
            let changed = touching.len().abs_diff(found.len());
            if changed == 1 {
                let mut after = solver.clone();
                while high - low > 1e-7 {
                    let middle = 0.5 * (low + high);
                    let mut between = before.clone();
                    if go_to(&mut between, &model, middle) == touching {
                        (low, before) = (middle, between);
                    } else {
                        (high, after) = (middle, between);
                    }
                }
                let [old, new] = [&before, &after].map(|s| s.velocity[0].clone());
                let turn = old.iter().zip(&new).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
                assert!(turn > 1e-3 * norm(&old), "the change shows");
                before.predict(&model, 1e-5, 4.0);
                let ahead = &before.prediction;
                assert_eq!(ahead.count, 2, "one change at {low} N");
                assert!(ahead.pieces[0].end < 1e-6, "the change is {} N ahead", ahead.pieces[0].end);
                let expected: Vec<f64> = ahead.velocity(1e-5).collect();
                let error = expected.iter().zip(&new).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
                assert!(error < 1e-3 * turn, "{error} of {turn} at {low} N");
                let mut moved = vec![0.0; model.dof()];
                ahead.displacement(1e-5, &mut moved);
                let short = ahead.pieces[0].end;
                for ((m, v), w) in moved.iter().zip(&old).zip(&expected) {
                    assert!((m - (short * v + (1e-5 - short) * w)).abs() < 1e-12);
                }
                if found.len() > touching.len() { closed += 1 } else { opened += 1 }
            }
            touching = found;
        }
        assert!(closed >= 2 && opened >= 1, "{closed} contacts closed, {opened} opened");
    }

    #[test]
    fn a_bend_is_learnt_and_goes_on() {
        let model = Model::<SE2, 3, 2>::new(&finger()).unwrap();
        let mut solver = Planar::new(&model, Options::default());
        let h = 0.02;
        let (mut bent, mut straight, mut seen) = (0.0, 0.0, 0);
        let mut touching = go_to(&mut solver, &model, 0.0);
        for k in 1..=400 {
            solver.start = solver.q.clone();
            solver.predict(&model, h, 4.0);
            let found = go_to(&mut solver, &model, h * k as f64);
            solver.velocity[1] = solver.velocity[0].clone();
            solver.learn_bend(h);
            let mut next = solver.clone();
            let known = norm(&solver.prediction.bend) > 0.0;
            if go_to(&mut next, &model, h * (k + 1) as f64) == found && found == touching && known {
                let mut ahead = solver.clone();
                ahead.predict(&model, h, 4.0);
                let missed = |ahead: &Planar| {
                    let mut moved = vec![0.0; model.dof()];
                    ahead.prediction.displacement(h, &mut moved);
                    let states = next.q.iter().zip(&solver.q).zip(&solver.unit);
                    states.zip(moved).map(|(((n, q), u), d)| ((n - q) / u - d).powi(2)).sum::<f64>().sqrt()
                };
                bent += missed(&ahead);
                ahead.prediction.rescale_bend(0.0);
                straight += missed(&ahead);
                seen += 1;
            }
            touching = found;
        }
        assert!(seen > 200, "only {seen} steps are smooth");
        assert!(bent < 0.1 * straight, "{bent} of {straight}");
    }
}
