//! Steps of a search that lead through a body are shortened, so that contact is met and not passed over.
//!
//! A step leads through a body if a sphere enters it on one side and is beyond its middle at the end
//! ([`Crossing`]), and if the forces along the step oppose it somewhere in between: otherwise contact is too weak
//! to stop the motion, and the descent goes through.
//!
//! Between two equilibria of a path the motion is taken to be a cubic that leaves and arrives in the directions of the
//! velocities there: the straight line may pass beside a body that the path meets.

use super::system::System;
use super::vector::{dot, norm};
use crate::forces::crossing::{Crossing, DEEP};
use crate::kinematics::Kinematics;
use crate::lie::LieGroup;
use crate::model::Model;

/// Rotation [rad] over which points are taken to move along straight lines, however thin bodies are: an arc of this
/// angle is higher than its chord by a thousandth of its radius.
const STRAIGHT: f64 = 0.1;
/// Largest rotation [rad] in one piece of a step.
const MAX_ROTATION: f64 = 1.0;
/// Largest number of pieces of a step.
const MAX_PIECES: f64 = 256.0;
/// Places between meeting a body and its middle at which forces are evaluated.
const PLACES: usize = 3;
/// The path may be off the straight line by more than the cubic is, by this factor.
const NEAR: f64 = 1.5;
/// Places nearer to each other than this fraction of the way into a body are one.
const SAME_PLACE: f64 = 0.2;

/// A workspace.
#[derive(Clone, Debug)]
pub(super) struct Sweep<G, const D: usize, const P: usize> {
    /// The first is that of `start`.
    poses: [Kinematics<G, D, P>; 2],
    /// Not a number where it is not known.
    start: Vec<f64>,
    crossings: Vec<Crossing>,
    state: Vec<f64>,
    /// How much the motion turns at the beginning and at the end, from the straight step; zero if it is straight.
    bends: [Vec<f64>; 2],
    /// How near to the straight line bodies have to be for the path to meet them; zero where that is negligible.
    margin: f64,
    /// Parts of the step at which forces were evaluated; they did not oppose it.
    yielding: Vec<f64>,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Sweep<G, D, P> {
    pub fn new(model: &Model<G, D, P>) -> Self {
        let poses = [Kinematics::new(&model.tree), Kinematics::new(&model.tree)];
        let n = model.dof();
        let zeros = || vec![0.0; n];
        let (start, bends) = (vec![f64::NAN; n], [zeros(), zeros()]);
        Self { poses, start, crossings: vec![], state: zeros(), bends, margin: 0.0, yielding: vec![] }
    }
}

/// How load and state change over a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathMotion<'a> {
    /// The rate of the load.
    pub rate: &'a [f64],
    /// The time over which it changes to its current value.
    pub duration: f64,
    /// The velocities of the dimensionless coordinates at both ends.
    pub velocities: [&'a [f64]; 2],
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> System<'_, G, D, P> {
    /// Keeps where everything is in the state evaluated last, from which steps will start.
    pub(super) fn start_sweeps(&mut self) {
        if let Some(mut sweep) = self.sweep.take() {
            sweep.poses[0].copy_places(&self.data.kinematics);
            sweep.start.copy_from_slice(self.state());
            self.sweep = Some(sweep);
        }
    }

    /// The part of a dimensionless step from `start` to the state evaluated last after which it has met a body
    /// that it leads through against the forces; `None`, with the state at its end, if there is none.
    pub(super) fn stopped_by_contact(&mut self, start: &[f64], step: &[f64]) -> Option<f64> {
        self.stopped_while_loaded(start, step, None)
    }

    /// The same for a step along which the load changes, with the velocities at its ends.
    pub(super) fn stopped_while_loaded(
        &mut self,
        start: &[f64],
        step: &[f64],
        motion: Option<PathMotion>,
    ) -> Option<f64> {
        if !self.may_have_crossed(start, step) {
            return None;
        }
        let mut sweep = self.sweep.take()?;
        sweep.bend(step, motion);
        self.find_crossings(&mut sweep, start, step);
        let mut stopped = None;
        if !sweep.crossings.is_empty() {
            sweep.crossings.sort_by(|a, b| a.met.total_cmp(&b.met));
            sweep.state.copy_from_slice(self.state());
            let load = self.load().to_vec();
            let Sweep { crossings, yielding, bends, .. } = &mut *sweep;
            let mut along = step.to_vec();
            yielding.clear();
            let mut opposed_at = |system: &mut Self, part: f64| {
                if let Some(PathMotion { rate, duration, .. }) = motion {
                    system.set_load_between(&load, rate, (part - 1.0) * duration);
                }
                let [place, direction] = [bent_place, bent_direction].map(|bent| bent(part));
                displace(step, bends, [part, place[0], place[1]], &mut along);
                system.advance_from(start, &along, 1.0);
                system.evaluate();
                displace(step, bends, [1.0, direction[0], direction[1]], &mut along);
                dot(system.residual(), &along) > 0.0
            };
            let opposed = |at: &&Crossing| opposes(at, yielding, |part| opposed_at(self, part));
            stopped = crossings.iter().find(opposed).map(|at| at.met);
            self.set_load(&load);
            self.set_state(&sweep.state);
            self.evaluate();
        }
        if stopped.is_none() && motion.is_some() && self.passes_near(&mut sweep, start) {
            stopped = Some(0.5);
        }
        self.sweep = Some(sweep);
        stopped
    }

    /// Whether the step from `start` to the state evaluated last comes as near to a body as it may be off the way of
    /// the path, by how much that bends.
    fn passes_near(&self, sweep: &mut Sweep<G, D, P>, start: &[f64]) -> bool {
        if sweep.margin == 0.0 {
            return false;
        }
        self.place_start(sweep, start);
        let ends = [&sweep.poses[0], &self.data.kinematics];
        let mut near = false;
        self.data.for_each_crossing(self.model(), ends, None, sweep.margin, |_| near = true);
        near
    }

    /// Whether a step from `start` to the state evaluated last may lead through a body. Less than half a turn leads
    /// to another side of it.
    fn may_have_crossed(&self, start: &[f64], step: &[f64]) -> bool {
        let Some(sweep) = &self.sweep else { return false };
        self.rotation(step) > std::f64::consts::PI
            || sweep.start != start
            || self.data.may_cross(self.model(), [&sweep.poses[0], &self.data.kinematics])
    }

    /// Takes the poses at the start of a step, unless they are known.
    fn place_start(&self, Sweep { poses, start: known, .. }: &mut Sweep<G, D, P>, start: &[f64]) {
        if known != start {
            poses[0].update(&self.model().tree, &self.data.design.geometry, start);
            known.copy_from_slice(start);
        }
    }

    fn find_crossings(&self, sweep: &mut Sweep<G, D, P>, start: &[f64], step: &[f64]) {
        self.place_start(sweep, start);
        let Sweep { poses, start: known, crossings, state, bends, margin, .. } = sweep;
        crossings.clear();
        let (model, geometry) = (self.model(), &self.data.design.geometry);
        let way = Way { start, step, bends };
        let pieces = self.pieces(poses, way, state, margin);
        if pieces == 1.0 {
            let ends = [&poses[0], &self.data.kinematics];
            self.data.for_each_crossing(model, ends, None, 0.0, |at| crossings.push(at));
            return;
        }
        known.fill(f64::NAN);
        let share = 1.0 / pieces;
        for piece in 0..pieces as usize {
            let begin = piece as f64 * share;
            self.part_of_step(way, begin + share, state);
            poses[1].update(&model.tree, geometry, state);
            let last = (piece + 1 < pieces as usize).then_some(&self.data.kinematics);
            self.data.for_each_crossing(model, [&poses[0], &poses[1]], last, 0.0, |at| {
                let [met, deepest] = [at.met, at.deepest].map(|part| begin + part * share);
                crossings.push(Crossing { met, deepest });
            });
            poses.swap(0, 1);
        }
    }

    /// Number of pieces in which points move along straight lines, up to a small part of the thickness of bodies:
    /// how far they are from the chord halfway decreases with the square of the number.
    fn pieces(
        &self,
        poses: &mut [Kinematics<G, D, P>; 2],
        way: Way,
        state: &mut [f64],
        margin: &mut f64,
    ) -> f64 {
        *margin = 0.0;
        let rotation =
            [way.step, &way.bends[0], &way.bends[1]].map(|each| self.rotation(each)).iter().sum::<f64>();
        if rotation <= STRAIGHT {
            return 1.0;
        }
        let thinnest = self.data.thinnest(self.model());
        if thinnest == 0.0 {
            return (rotation / STRAIGHT).ceil().min(MAX_PIECES);
        }
        self.part_of_step(way, 0.5, state);
        let [first, halfway] = poses;
        halfway.update(&self.model().tree, &self.data.design.geometry, state);
        let ends = first.points.iter().zip(&self.data.kinematics.points);
        let off =
            ends.zip(&halfway.points).map(|((a, b), p)| (*p - (*a + *b) * 0.5).norm()).fold(0.0, f64::max);
        if NEAR * off > DEEP * thinnest {
            *margin = NEAR * off;
        }
        let pieces = (off / (DEEP * thinnest)).sqrt().max(rotation / MAX_ROTATION);
        pieces.ceil().clamp(1.0, MAX_PIECES)
    }

    /// The coordinates after part of a dimensionless step.
    fn part_of_step(&self, Way { start, step, bends }: Way, part: f64, out: &mut [f64]) {
        let [first, second] = bent_place(part);
        displace(step, bends, [part, first, second], out);
        for ((q, t), u) in out.iter_mut().zip(start).zip(self.units()) {
            *q = t + *q * u;
        }
    }

    /// A bound on the rotation of any frame over a dimensionless step [rad].
    fn rotation(&self, step: &[f64]) -> f64 {
        let model = self.model();
        let size = |i: usize| (step[i] * self.units()[i]).abs();
        let joints = model.joints.iter().filter(|joint| joint.angular).map(|joint| size(joint.dof));
        let rods = model.rods.iter().map(|rod| {
            let angles = rod.dofs.clone().zip(&rod.angular).filter(|(_, angular)| **angular);
            angles.map(|(dof, _)| size(dof)).fold(0.0, f64::max)
        });
        joints.sum::<f64>() + rods.sum::<f64>()
    }
}

/// A step from a state.
#[derive(Clone, Copy)]
struct Way<'a> {
    start: &'a [f64],
    step: &'a [f64],
    bends: &'a [Vec<f64>; 2],
}

impl<G, const D: usize, const P: usize> Sweep<G, D, P> {
    /// Lets the motion over a step be the cubic in the directions of the velocities at its ends, or straight.
    fn bend(&mut self, step: &[f64], motion: Option<PathMotion>) {
        let length = norm(step);
        for (end, bend) in self.bends.iter_mut().enumerate() {
            bend.fill(0.0);
            if let Some(velocity) = motion.map(|motion| motion.velocities[end]) {
                let share = length / norm(velocity);
                if share.is_finite() {
                    bend.iter_mut().zip(velocity.iter().zip(step)).for_each(|(b, (v, s))| *b = share * v - s);
                }
            }
        }
    }
}

/// Shares of both bends in the place after part of a step: s (1 − s) ((1 − s) a − s b) on the cubic.
fn bent_place(s: f64) -> [f64; 2] {
    [s * (1.0 - s) * (1.0 - s), -s * s * (1.0 - s)]
}

/// The same in the direction of the motion there.
fn bent_direction(s: f64) -> [f64; 2] {
    [(1.0 - s) * (1.0 - 3.0 * s), s * (3.0 * s - 2.0)]
}

/// A sum of the step and both bends.
fn displace(step: &[f64], [first, second]: &[Vec<f64>; 2], [c, a, b]: [f64; 3], out: &mut [f64]) {
    for ((x, s), (f, g)) in out.iter_mut().zip(step).zip(first.iter().zip(second)) {
        *x = c * s + a * f + b * g;
    }
}

/// Whether forces oppose a step on the way into a body, elsewhere than at places where they are known to yield.
fn opposes(crossing: &Crossing, yielding: &mut Vec<f64>, mut opposed_at: impl FnMut(f64) -> bool) -> bool {
    let way = crossing.deepest - crossing.met;
    (0..=PLACES).any(|place| {
        let at = crossing.met + way * place as f64 / PLACES as f64;
        if yielding.iter().any(|known| (at - known).abs() <= SAME_PLACE * way) {
            return false;
        }
        let opposed = opposed_at(at);
        if !opposed {
            yielding.push(at);
        }
        opposed
    })
}
