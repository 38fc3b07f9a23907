//! Derivatives along a path: how friction in a step changes with its state, with parameters, and with what the
//! step began with.

use super::super::element::Velocities;
use super::super::state::State;
use super::change::{PointChange, PointMotion, StartChange};
use super::pressed::{Direction, Merged, PressedChange};
use super::{FrictionMemory, Frictions};
use crate::lie::LieGroup;
use crate::linalg::Vector;

/// Distance from the limit, relative to it, at which a point may stick or slide.
const AT_LIMIT: f64 = 1e-7;

/// How a point changes in a direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointSlope<const P: usize> {
    /// Motion of the place of contact.
    pub place: Vector<P>,
    pub change: PointChange<P>,
}

/// How the points of a step change.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrictionSlopes<const P: usize> {
    /// With each coordinate.
    pub by_coordinates: Vec<Vec<PointSlope<P>>>,
    /// With each wanted parameter.
    pub by_parameters: Vec<Vec<PointSlope<P>>>,
    /// Each with what it began with: the slip along each axis, the stiffness, and the place along each axis.
    pub by_start: Vec<Vec<PointChange<P>>>,
}

/// The derivatives of a number by what a point has at the end of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointAdjoint<const P: usize> {
    /// By the elastic slip, in the axes of the second frame.
    pub slip: Vector<P>,
    /// By the tangential stiffness.
    pub stiffness: f64,
}

impl<const P: usize> PointAdjoint<P> {
    const ZERO: Self = Self { slip: Vector::ZERO, stiffness: 0.0 };

    fn of(&self, change: &PointChange<P>) -> f64 {
        self.slip.dot(&change.slip) + self.stiffness * change.stiffness
    }
}

impl<const P: usize> FrictionSlopes<P> {
    /// Adds the derivatives by each coordinate of what points have at the end of the step.
    pub fn add_by_coordinates(&self, points: &[PointAdjoint<P>], out: &mut [f64]) {
        for (out, slopes) in out.iter_mut().zip(&self.by_coordinates) {
            *out += points.iter().zip(slopes).map(|(point, slope)| point.of(&slope.change)).sum::<f64>();
        }
    }
}

impl Frictions {
    /// How points change in a direction, in the state in which they were renewed.
    pub fn slopes<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &FrictionMemory<P>,
        direction: &Direction<D, P>,
        pressed: &[PressedChange<P>],
    ) -> Vec<PointSlope<P>> {
        let each = memory.points.iter().map(|point| {
            let pressed = pressed[point.pressed];
            let Merged { friction, whole: presses, .. } = &memory.pressed[point.pressed];
            let friction = &self.0[*friction];
            let jacobian = G::point_jacobian(&presses.place);
            let [first, second] = point.frames;
            let twists = &direction.velocities.twists;
            let normal = presses.force * (1.0 / presses.force.norm());
            let motion = PointMotion {
                over: [first, second].map(|frame| pressed.place - jacobian * twists[frame]),
                turn: direction.velocities.shifted::<G>(second, &normal),
                pressed,
                ratio: direction.of(friction.ratio),
                coefficient: direction.of(friction.coefficient),
                start: StartChange::ZERO,
            };
            let constants = friction.constants(at.parameters());
            let mut change = point.change(at, &memory.start, constants, presses, &motion);
            change.gradient += direction.velocities.shifted::<G>(second, &point.at(at).gradient);
            PointSlope { place: pressed.place, change }
        });
        each.collect()
    }

    /// How points change with what they began with.
    pub fn slopes_by_start<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &FrictionMemory<P>,
    ) -> Vec<Vec<PointChange<P>>> {
        let starts = (0..2 * P + 1).map(|i| match i {
            i if i < P => StartChange { slip: Vector::unit(i), ..StartChange::ZERO },
            i if i == P => StartChange { stiffness: 1.0, ..StartChange::ZERO },
            i => StartChange { then: Vector::unit(i - P - 1), ..StartChange::ZERO },
        });
        let starts: Vec<StartChange<P>> = starts.collect();
        let each = memory.points.iter().map(|point| {
            let Merged { friction, whole: presses, .. } = &memory.pressed[point.pressed];
            let friction = &self.0[*friction];
            let constants = friction.constants(at.parameters());
            let change = |start: &StartChange<P>| {
                let still = PointMotion {
                    over: [Vector::ZERO; 2],
                    turn: Vector::ZERO,
                    pressed: PressedChange::ZERO,
                    ratio: 0.0,
                    coefficient: 0.0,
                    start: *start,
                };
                point.change(at, &memory.start, constants, presses, &still)
            };
            starts.iter().map(change).collect()
        });
        each.collect()
    }

    /// For each direction, the change of what points have at the end of the step, less that of the work of
    /// friction on a virtual motion.
    pub fn add_slopes<G: LieGroup<D, P>, const D: usize, const P: usize>(
        at: &State<G, D, P>,
        memory: &FrictionMemory<P>,
        slopes: &[Vec<PointSlope<P>>],
        points: &[PointAdjoint<P>],
        motion: &Velocities<D, P>,
        out: &mut [f64],
    ) {
        for (i, point) in memory.points.iter().enumerate() {
            let own = points.get(i).copied().unwrap_or(PointAdjoint::ZERO);
            let now = point.at(at);
            let place = &memory.pressed[point.pressed].whole.place;
            let [first, second] = point.frames;
            let jacobian = G::point_jacobian(place);
            let relative = jacobian * (motion.twists[first] - motion.twists[second]);
            for (out, slopes) in out.iter_mut().zip(slopes) {
                let PointSlope { place, change } = &slopes[i];
                let shifted = motion.shifted::<G>(first, place) - motion.shifted::<G>(second, place);
                *out += own.of(change) - change.gradient.dot(&relative) - now.gradient.dot(&shifted);
            }
        }
    }

    /// Passes the derivatives by what a step began with on to the step before: those by what points had at its
    /// end, and those by the place of frames, as wrenches on them.
    pub fn pass_on<G: LieGroup<D, P>, const D: usize, const P: usize>(
        memory: &FrictionMemory<P>,
        slopes: &FrictionSlopes<P>,
        points: &[PointAdjoint<P>],
        motion: &Velocities<D, P>,
        frames: &mut Vec<(usize, Vector<D>)>,
    ) -> Vec<PointAdjoint<P>> {
        let start = &memory.start;
        let mut before = vec![PointAdjoint::ZERO; start.points.len()];
        for (i, (point, changes)) in memory.points.iter().zip(&slopes.by_start).enumerate() {
            let own = points.get(i).copied().unwrap_or(PointAdjoint::ZERO);
            let [first, second] = point.frames;
            let jacobian = G::point_jacobian(&memory.pressed[point.pressed].whole.place);
            let relative = jacobian * (motion.twists[first] - motion.twists[second]);
            let slope = |i: usize| own.of(&changes[i]) - changes[i].gradient.dot(&relative);
            let axes = |from: usize| Vector::<P>(std::array::from_fn(|axis| slope(from + axis)));
            let place = start.frames[first].act(&point.place);
            let push = start.frames[second].rotate(&axes(P + 1));
            let wrench = G::point_jacobian(&place).transpose_times(&push);
            frames.push((first, wrench));
            frames.push((second, -wrench));
            let Some(index) = point.begun else { continue };
            let begun = &start.points[index];
            before[index].stiffness += slope(P);
            let by_slip = start.frames[second].rotate(&axes(0));
            before[index].slip += start.frames[begun.frame].rotate_back(&by_slip);
            if begun.frame != second {
                let slip = start.frames[begun.frame].rotate(&begun.slip);
                let turning = G::point_jacobian(&slip) - G::point_jacobian(&Vector::ZERO);
                let moment = turning.transpose_times(&by_slip);
                frames.push((begun.frame, moment));
                frames.push((second, -moment));
            }
        }
        before
    }

    /// Whether a point is at its limit, where its derivatives are one-sided.
    pub fn is_about_to_slide<G: LieGroup<D, P>, const D: usize, const P: usize>(
        at: &State<G, D, P>,
        memory: &FrictionMemory<P>,
    ) -> bool {
        memory.points.iter().any(|point| {
            let beyond = point.law.stiffness * point.size(at) - point.law.limit;
            point.law.limit > 0.0 && beyond.abs() < AT_LIMIT * point.law.limit
        })
    }

    /// Whether frames are where a step began.
    pub fn begins_at<G: LieGroup<D, P>, const D: usize, const P: usize>(
        at: &State<G, D, P>,
        memory: &FrictionMemory<P>,
    ) -> bool {
        let mut here = super::Start::default();
        here.place(at);
        here.frames == memory.start.frames
    }
}
