//! How the friction of a point changes to first order in the state in which it was renewed.
//!
//! What is held in a step is a function of that state. So beside the tangent of the potential there is the change
//! of the limit with the normal force, of the stiffness, and of place and plane of contact. It has no potential.

use super::super::element::Velocities;
use super::super::state::State;
use super::point::{FrictionPoint, carried, softening, touched_share};
use super::pressed::{Merged, Pressed, PressedChange};
use super::start::Start;
use super::{FrictionMemory, Frictions};
use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};

/// What changes at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointMotion<const P: usize> {
    /// How the place of contact moves over the first and over the second body, in the world.
    pub over: [Vector<P>; 2],
    /// How the normal turns with the second body.
    pub turn: Vector<P>,
    pub pressed: PressedChange<P>,
    /// Of the ratio of the stiffnesses, and of the coefficient of friction.
    pub ratio: f64,
    pub coefficient: f64,
    pub start: StartChange<P>,
}

/// What changes of the beginning of the step, in the axes of the second frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StartChange<const P: usize> {
    /// Where the point of the first body was.
    pub then: Vector<P>,
    pub slip: Vector<P>,
    pub stiffness: f64,
}

impl<const P: usize> StartChange<P> {
    pub const ZERO: Self = Self { then: Vector::ZERO, slip: Vector::ZERO, stiffness: 0.0 };
}

/// How a point changes, but for turning with the second body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointChange<const P: usize> {
    /// Of the gradient, in the world.
    pub gradient: Vector<P>,
    /// Of the elastic slip with which the next step begins, in the axes of the second frame.
    pub slip: Vector<P>,
    /// Of the tangential stiffness.
    pub stiffness: f64,
}

impl<const P: usize> FrictionPoint<P> {
    /// The change for a motion, in the state in which the point was renewed.
    pub fn change<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        start: &Start<P>,
        (ratio, coefficient): (f64, f64),
        pressed: &Pressed<P>,
        motion: &PointMotion<P>,
    ) -> PointChange<P> {
        let [first, second] = self.frames.map(|frame| &at.kinematics.pose[frame]);
        let ([first, back], n) = ([first.inverse(), second.inverse()], &self.normal);
        let size = pressed.force.norm();
        let normal = pressed.force * (1.0 / size);
        let pressing = normal.dot(&motion.pressed.force);
        let turned = (motion.pressed.force - normal * pressing) * (1.0 / size) - motion.turn;
        let turned = back.rotate(&turned);
        let stiffness = ratio * motion.pressed.stiffness + motion.ratio * pressed.stiffness;
        let limit = coefficient * pressing + motion.coefficient * size;

        let [by_first, by_second] = &motion.over;
        let frames = self.frames.map(|frame| &start.frames[frame]);
        let then = frames[1].undo(&frames[0].act(&self.place));
        let then_moved = frames[1].rotate_back(&frames[0].rotate(&first.rotate(by_first)));
        let moved = back.act(&pressed.place) - then;
        let moving = back.rotate(by_second) - then_moved - motion.start.then;
        let flat = |v: &Vector<P>| *v - *n * n.dot(v);
        // Of the projection of the motion on the plane.
        let mut slipped = flat(&moving) - turned * n.dot(&moved) - *n * turned.dot(&moved);
        let slip;
        if let Some(begun) = self.begun.map(|index| &start.points[index]) {
            let before = start.slip_in(begun, self.frames[1]);
            let kept = softening(begun, self.law.stiffness);
            let carry = change_of_carried(&before, n, &motion.start.slip, &turned);
            slipped += carry * kept;
            let carried = carried(&before, n);
            if kept < 1.0 {
                let change = motion.start.stiffness - kept * stiffness;
                slipped += carried * (change / self.law.stiffness);
            }
            slip = carried * kept + flat(&moved);
        } else {
            let share = touched_share(n, &moved, pressed.depth);
            slipped = slipped * share;
            if share < 1.0 {
                let closing = -n.dot(&moved);
                let faster = -(turned.dot(&moved) + n.dot(&moving));
                slipped += flat(&moved) * ((motion.pressed.depth - share * faster) / closing);
            }
            slip = flat(&moved) * share;
        }
        let law = self.law;
        let length = slip.norm();
        let (force, kept) = if law.slides(length) {
            let along = slip * (1.0 / length);
            let turning = (slipped - along * along.dot(&slipped)) * (law.limit / length);
            let elastic = (limit - law.limit * stiffness / law.stiffness) / law.stiffness;
            (along * limit + turning, along * elastic + turning * (1.0 / law.stiffness))
        } else {
            (slip * stiffness + slipped * law.stiffness, slipped)
        };
        PointChange { gradient: second.rotate(&force), slip: kept, stiffness }
    }
}

/// The change of [`carried`] with the slip and the normal.
fn change_of_carried<const P: usize>(
    slip: &Vector<P>,
    normal: &Vector<P>,
    slipped: &Vector<P>,
    turned: &Vector<P>,
) -> Vector<P> {
    let across = Matrix::<P, P>::diagonal(1.0) - normal.outer(normal);
    let (flat, length) = (across * *slip, slip.norm());
    let size = flat.norm();
    if size == 0.0 {
        return across * *slipped;
    }
    let change = across * *slipped - *turned * normal.dot(slip) - *normal * turned.dot(slip);
    let longer = slip.dot(slipped) / length;
    change * (length / size) + flat * (longer / size - length * flat.dot(&change) / size.powi(3))
}

impl Frictions {
    /// Adds the wrenches on frames by which friction changes beside its tangent in a step, for a motion in the
    /// state in which it was renewed, with the changes of what presses.
    pub fn add_renewal<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &FrictionMemory<P>,
        velocities: &Velocities<D, P>,
        pressed: &[PressedChange<P>],
        wrench: &mut [Vector<D>],
    ) {
        for point in &memory.points {
            let change = pressed[point.pressed];
            let Merged { friction, whole: presses, .. } = &memory.pressed[point.pressed];
            let friction = &self.0[*friction];
            let [first, second] = point.frames;
            let jacobian = G::point_jacobian(&presses.place);
            let over = [first, second].map(|frame| change.place - jacobian * velocities.twists[frame]);
            let normal = presses.force * (1.0 / presses.force.norm());
            let motion = PointMotion {
                over,
                turn: velocities.shifted::<G>(second, &normal),
                pressed: change,
                ratio: 0.0,
                coefficient: 0.0,
                start: StartChange::ZERO,
            };
            let constants = friction.constants(at.parameters());
            let changed = point.change(at, &memory.start, constants, presses, &motion);
            let now = point.at(at);
            // In a step the point moves with the first body.
            let held = point.law.hessian(&now.slip, &now.normal) * (over[1] - over[0]);
            let shift = G::point_jacobian(&over[0]) - G::point_jacobian(&Vector::ZERO);
            let total =
                jacobian.transpose_times(&(changed.gradient - held)) + shift.transpose_times(&now.gradient);
            wrench[first] += total;
            wrench[second] -= total;
        }
    }

    /// What presses changes by this, from the changes of contacts in the order in which they are visited.
    pub fn merge_changes<const P: usize>(
        memory: &FrictionMemory<P>,
        changes: &mut Vec<PressedChange<P>>,
        list: impl FnOnce(&mut dyn FnMut(PressedChange<P>)),
    ) {
        changes.clear();
        changes.resize(memory.pressed.len(), PressedChange::ZERO);
        let mut contacts = memory.contacts.iter();
        list(&mut |change| {
            if let Some((index, part)) = contacts.next() {
                memory.pressed[*index].add_change(part, &change, &mut changes[*index]);
            }
        });
    }
}
