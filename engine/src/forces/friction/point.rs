//! One point at which bodies rub: what is held in a step, and its kinematics.

use super::super::state::State;
use super::law::Law;
use super::pressed::Pressed;
use super::start::{Begun, Start};
use crate::lie::LieGroup;
use crate::linalg::Vector;

/// Identifies a point from step to step: friction, sphere of the first body, and second body.
pub(crate) type Key = [usize; 3];

/// A point of the first body that rubs on the second.
///
/// In a step it is a material point of the first body, and the plane in which it slips is fixed in the second.
/// Its slip is that with which the step began plus its motion in that plane since.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrictionPoint<const P: usize> {
    pub key: Key,
    /// Index of what presses there.
    pub pressed: usize,
    /// Frames of the first and the second body.
    pub frames: [usize; 2],
    /// In the axes of the first frame.
    pub place: Vector<P>,
    /// Where it was in the axes of the second when the slip was `slip`.
    pub base: Vector<P>,
    pub slip: Vector<P>,
    /// Unit vector towards the first body, in the axes of the second frame.
    pub normal: Vector<P>,
    pub law: Law,
    /// Index of that with which it began the step, unless it touches for the first time.
    pub begun: Option<usize>,
}

/// A point in a state, in the world.
pub(crate) struct Slipped<const P: usize> {
    pub place: Vector<P>,
    pub normal: Vector<P>,
    pub slip: Vector<P>,
    /// Derivative of the potential by the place of the first body's point; the force on it is the opposite.
    pub gradient: Vector<P>,
}

impl<const P: usize> FrictionPoint<P> {
    /// A point at which bodies press on each other now, with what the step began with. A point that touches
    /// for the first time slips from where it touched, as far as the step is straight.
    pub fn new<G: LieGroup<D, P>, const D: usize>(
        at: &State<G, D, P>,
        (key, index): (Key, usize),
        pressed: &Pressed<P>,
        law: Law,
        (start, begun): (&Start<P>, Option<usize>),
    ) -> Self {
        let frames = pressed.frames;
        let [first, second] = frames.map(|frame| at.kinematics.pose[frame].inverse());
        let normal = second.rotate(&(pressed.force * (1.0 / pressed.force.norm())));
        let (place, now) = (first.act(&pressed.place), second.act(&pressed.place));
        let then = start.frames[frames[1]].undo(&start.frames[frames[0]].act(&place));
        let (base, slip) = match begun.map(|index| &start.points[index]) {
            Some(begun) => {
                let slip = carried(&start.slip_in(begun, frames[1]), &normal);
                (then, slip * softening(begun, law.stiffness))
            }
            None => {
                let moved = now - then;
                (now - moved * touched_share(&normal, &moved, pressed.depth), Vector::ZERO)
            }
        };
        Self { key, pressed: index, frames, place, base, slip, normal, law, begun }
    }

    /// The slip in the axes of the second frame, with the place in the world.
    #[inline]
    fn slipped<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>) -> (Vector<P>, Vector<P>) {
        let [first, second] = self.frames.map(|frame| &at.kinematics.pose[frame]);
        let place = first.act(&self.place);
        let moved = second.inverse().act(&place) - self.base;
        (place, self.slip + moved - self.normal * self.normal.dot(&moved))
    }

    #[inline]
    pub fn at<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>) -> Slipped<P> {
        let (place, slip) = self.slipped(at);
        let second = &at.kinematics.pose[self.frames[1]];
        let (slip, normal) = (second.rotate(&slip), second.rotate(&self.normal));
        Slipped { place, normal, slip, gradient: slip * self.law.secant(slip.norm()) }
    }

    /// Size of the slip.
    #[inline]
    pub fn size<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>) -> f64 {
        self.slipped(at).1.norm()
    }

    /// Energy lost as the stiffness changed since the step began; none where the slip only turned.
    pub fn relaxed(&self, start: &Start<P>) -> f64 {
        let Some(begun) = self.begun.map(|index| &start.points[index]) else { return 0.0 };
        let kept = softening(begun, self.law.stiffness);
        begun.energy() - 0.5 * self.law.stiffness * kept * kept * begun.slip.dot(&begun.slip)
    }

    /// Sets the slip, given in the world.
    pub fn set_slip<G: LieGroup<D, P>, const D: usize>(&mut self, at: &State<G, D, P>, slip: Vector<P>) {
        let slip = at.kinematics.pose[self.frames[1]].inverse().rotate(&slip);
        self.slip = slip - self.normal * self.normal.dot(&slip);
    }

    /// Gives up the slip beyond the limit; see [`Law::returned`].
    pub fn set_back<G: LieGroup<D, P>, const D: usize>(&mut self, at: &State<G, D, P>, excess: f64) {
        let (place, slip) = self.slipped(at);
        self.base = at.kinematics.pose[self.frames[1]].inverse().act(&place);
        self.slip = self.law.returned(slip, excess);
    }

    /// What it begins the next step with.
    pub fn begin(&self) -> Begun<P> {
        Begun { key: self.key, slip: self.slip, frame: self.frames[1], stiffness: self.law.stiffness }
    }
}

/// A slip turned into the plane across a normal, its length kept.
pub(super) fn carried<const P: usize>(slip: &Vector<P>, normal: &Vector<P>) -> Vector<P> {
    let flat = *slip - *normal * normal.dot(slip);
    let size = flat.norm();
    if size > 0.0 { flat * (slip.norm() / size) } else { Vector::ZERO }
}

/// What becomes of a slip as the stiffness changes: a stiffer contact has the same force, a softer one the
/// same slip. Neither adds energy.
pub(super) fn softening<const P: usize>(begun: &Begun<P>, stiffness: f64) -> f64 {
    (begun.stiffness / stiffness).min(1.0)
}

/// The share of a step's motion after a point touched that did not before, its overlap being `depth` now.
pub(super) fn touched_share<const P: usize>(normal: &Vector<P>, moved: &Vector<P>, depth: f64) -> f64 {
    let closing = -normal.dot(moved);
    if closing > depth { depth / closing } else { 1.0 }
}
