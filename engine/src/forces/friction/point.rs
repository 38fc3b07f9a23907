//! One point at which bodies rub: what it remembers, and its kinematics in a step.

use super::super::state::State;
use super::law::Law;
use crate::lie::LieGroup;
use crate::linalg::Vector;

/// Identifies a point from step to step: friction, sphere of the first body, and second body.
pub(crate) type Key = [usize; 3];

/// Two bodies that press on each other in a state.
#[derive(Clone, Debug)]
pub(crate) struct Pressed<const P: usize> {
    /// The sphere of the first body.
    pub sphere: usize,
    /// What it touches: a body, or a surface of an obstacle.
    pub other: usize,
    /// Frames that carry both.
    pub frames: [usize; 2],
    /// Where [m].
    pub place: Vector<P>,
    /// Normal force on the first [N].
    pub force: Vector<P>,
    /// Normal stiffness [N/m].
    pub stiffness: f64,
}

/// A point of the first body that rubs on the second.
///
/// In a step it is a material point of the first body, and the plane in which it slips is fixed in the second;
/// its slip is the elastic slip with which the step began plus its motion in that plane since.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrictionPoint<const P: usize> {
    pub key: Key,
    /// Frames of the first and the second body.
    pub frames: [usize; 2],
    /// In the axes of the first frame.
    place: Vector<P>,
    /// Where it was in the axes of the second when the slip was `slip`.
    base: Vector<P>,
    pub slip: Vector<P>,
    /// Unit vector towards the first body, in the axes of the second frame.
    pub normal: Vector<P>,
    pub law: Law,
    /// Whether the bodies touch in the state in which it was renewed.
    pub touches: bool,
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
    /// A point that has not slipped.
    pub fn new<G: LieGroup<D, P>, const D: usize>(
        at: &State<G, D, P>,
        key: Key,
        pressed: &Pressed<P>,
        law: Law,
    ) -> Self {
        let [place, base, normal] = fixed(at, pressed);
        let frames = pressed.frames;
        Self { key, frames, place, base, slip: Vector::ZERO, normal, law, touches: true }
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

    /// Takes the slip so far for that of a point at which the bodies press on each other now. The slip turns
    /// with the plane: it is carried along the shortest rotation of the normal.
    pub fn renew<G: LieGroup<D, P>, const D: usize>(
        &mut self,
        at: &State<G, D, P>,
        pressed: &Pressed<P>,
        law: Law,
    ) {
        let Slipped { slip, normal, .. } = self.at(at);
        let to = pressed.force * (1.0 / pressed.force.norm());
        let turned = slip - (normal + to) * (to.dot(&slip) / (1.0 + normal.dot(&to)).max(f64::EPSILON));
        // A stiffer contact has the same force, a softer one the same slip: neither adds energy.
        let softer = (self.law.stiffness / law.stiffness).min(1.0);
        [self.place, self.base, self.normal] = fixed(at, pressed);
        self.frames = pressed.frames;
        self.slip = at.kinematics.pose[self.frames[1]].inverse().rotate(&(turned * softer));
        (self.law, self.touches) = (law, true);
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
}

/// Place in the axes of the first frame, place and normal in those of the second.
fn fixed<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    pressed: &Pressed<P>,
) -> [Vector<P>; 3] {
    let [first, second] = pressed.frames.map(|frame| at.kinematics.pose[frame].inverse());
    let normal = pressed.force * (1.0 / pressed.force.norm());
    [first.act(&pressed.place), second.act(&pressed.place), second.rotate(&normal)]
}
