//! Steps of a search that lead through a body are shortened, so that contact is met and not passed over.
//!
//! A step leads through a body if a sphere enters it on one side and is beyond its middle at the end
//! ([`Crossing`]), and if the forces along the step oppose it somewhere in between: otherwise contact is too weak
//! to stop the motion, and the descent goes through.

use super::system::System;
use super::vector::dot;
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
    /// Parts of the step at which forces were evaluated; they did not oppose it.
    yielding: Vec<f64>,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Sweep<G, D, P> {
    pub fn new(model: &Model<G, D, P>) -> Self {
        let poses = [Kinematics::new(&model.tree), Kinematics::new(&model.tree)];
        let n = model.dof();
        Self { poses, start: vec![f64::NAN; n], crossings: vec![], state: vec![0.0; n], yielding: vec![] }
    }
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

    /// The same for a step along which the load changes to its current value at a rate for so long.
    pub(super) fn stopped_while_loaded(
        &mut self,
        start: &[f64],
        step: &[f64],
        change: Option<(&[f64], f64)>,
    ) -> Option<f64> {
        if !self.may_have_crossed(start, step) {
            return None;
        }
        let mut sweep = self.sweep.take()?;
        self.find_crossings(&mut sweep, start, step);
        let mut stopped = None;
        if !sweep.crossings.is_empty() {
            sweep.crossings.sort_by(|a, b| a.met.total_cmp(&b.met));
            sweep.state.copy_from_slice(self.state());
            let load = self.load().to_vec();
            let Sweep { crossings, yielding, .. } = &mut *sweep;
            yielding.clear();
            let opposed_at = |system: &mut Self, part: f64| {
                if let Some((rate, h)) = change {
                    system.set_load_between(&load, rate, (part - 1.0) * h);
                }
                system.advance_from(start, step, part);
                system.evaluate();
                dot(system.residual(), step) > 0.0
            };
            let opposed = |at: &&Crossing| opposes(at, yielding, |part| opposed_at(self, part));
            stopped = crossings.iter().find(opposed).map(|at| at.met);
            self.set_load(&load);
            self.set_state(&sweep.state);
            self.evaluate();
        }
        self.sweep = Some(sweep);
        stopped
    }

    /// Whether a step from `start` to the state evaluated last may lead through a body. Less than half a turn leads
    /// to another side of it.
    fn may_have_crossed(&self, start: &[f64], step: &[f64]) -> bool {
        let Some(sweep) = &self.sweep else { return false };
        self.rotation(step) > std::f64::consts::PI
            || sweep.start != start
            || self.data.may_cross(self.model(), [&sweep.poses[0], &self.data.kinematics])
    }

    fn find_crossings(&self, sweep: &mut Sweep<G, D, P>, start: &[f64], step: &[f64]) {
        let Sweep { poses, start: known, crossings, state, .. } = sweep;
        crossings.clear();
        let (model, geometry) = (self.model(), &self.data.design.geometry);
        if known != start {
            poses[0].update(&model.tree, geometry, start);
            known.copy_from_slice(start);
        }
        let pieces = self.pieces(poses, start, step, state);
        if pieces == 1.0 {
            let ends = [&poses[0], &self.data.kinematics];
            self.data.for_each_crossing(model, ends, None, |at| crossings.push(at));
            return;
        }
        known.fill(f64::NAN);
        let share = 1.0 / pieces;
        for piece in 0..pieces as usize {
            let begin = piece as f64 * share;
            self.part_of_step(start, step, begin + share, state);
            poses[1].update(&model.tree, geometry, state);
            let last = (piece + 1 < pieces as usize).then_some(&self.data.kinematics);
            self.data.for_each_crossing(model, [&poses[0], &poses[1]], last, |at| {
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
        start: &[f64],
        step: &[f64],
        state: &mut [f64],
    ) -> f64 {
        let rotation = self.rotation(step);
        if rotation <= STRAIGHT {
            return 1.0;
        }
        let thinnest = self.data.thinnest(self.model());
        if thinnest == 0.0 {
            return (rotation / STRAIGHT).ceil().min(MAX_PIECES);
        }
        self.part_of_step(start, step, 0.5, state);
        let [first, halfway] = poses;
        halfway.update(&self.model().tree, &self.data.design.geometry, state);
        let ends = first.points.iter().zip(&self.data.kinematics.points);
        let off =
            ends.zip(&halfway.points).map(|((a, b), p)| (*p - (*a + *b) * 0.5).norm()).fold(0.0, f64::max);
        let pieces = (off / (DEEP * thinnest)).sqrt().max(rotation / MAX_ROTATION);
        pieces.ceil().clamp(1.0, MAX_PIECES)
    }

    /// The coordinates after part of a dimensionless step.
    fn part_of_step(&self, start: &[f64], step: &[f64], part: f64, out: &mut [f64]) {
        for ((q, t), (s, u)) in out.iter_mut().zip(start).zip(step.iter().zip(self.units())) {
            *q = t + part * s * u;
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
