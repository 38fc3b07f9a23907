//! What presses bodies on each other, and how it changes to first order.

use super::super::element::Velocities;
use crate::linalg::Vector;

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
    /// Overlap [m].
    pub depth: f64,
}

impl<const P: usize> Pressed<P> {
    /// Size of the normal force; negative if it is one that others count twice.
    pub fn size(&self) -> f64 {
        self.force.norm().copysign(self.stiffness)
    }
}

/// Several contacts of a sphere with a body that count as one, such as those with joined round cones: with the sum
/// of their forces and stiffnesses, at their mean place by force.
#[derive(Clone, Debug)]
pub(crate) struct Merged<const P: usize> {
    /// Index of the friction.
    pub friction: usize,
    pub whole: Pressed<P>,
    /// Sum of the sizes of their forces.
    size: f64,
}

impl<const P: usize> Merged<P> {
    pub fn new(friction: usize, first: &Pressed<P>) -> Self {
        let size = first.size();
        Self { friction, whole: first.clone(), size }
    }

    /// Adds a contact.
    pub fn add(&mut self, more: &Pressed<P>) {
        let (whole, size) = (&mut self.whole, more.size());
        let total = self.size + size;
        let share = if total == 0.0 { 0.0 } else { size / total };
        whole.place += (more.place - whole.place) * share;
        whole.depth += (more.depth - whole.depth) * share;
        whole.force += more.force;
        whole.stiffness += more.stiffness;
        self.size = total;
    }

    /// Whether bodies press on each other there.
    pub fn presses(&self) -> bool {
        self.whole.force.norm() > 0.0 && self.whole.stiffness > 0.0 && self.size > 0.0
    }

    /// Adds the change of one of its contacts to that of the whole.
    pub fn add_change(&self, part: &Pressed<P>, change: &PressedChange<P>, out: &mut PressedChange<P>) {
        let size = part.size();
        let larger = if size == 0.0 { 0.0 } else { part.force.dot(&change.force) / size };
        let share = 1.0 / self.size;
        out.place += ((part.place - self.whole.place) * larger + change.place * size) * share;
        out.depth += ((part.depth - self.whole.depth) * larger + change.depth * size) * share;
        out.force += change.force;
        out.stiffness += change.stiffness;
    }
}

/// Its change: of place, force, stiffness and overlap.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PressedChange<const P: usize> {
    pub place: Vector<P>,
    pub force: Vector<P>,
    pub stiffness: f64,
    pub depth: f64,
}

impl<const P: usize> PressedChange<P> {
    pub const ZERO: Self = Self { place: Vector::ZERO, force: Vector::ZERO, stiffness: 0.0, depth: 0.0 };
}

/// A direction in which a state changes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Direction<'a, const D: usize, const P: usize> {
    /// How frames and points move.
    pub velocities: Velocities<'a, D, P>,
    /// The parameter that changes, at the rate 1.
    pub parameter: Option<usize>,
}

impl<const D: usize, const P: usize> Direction<'_, D, P> {
    /// Rate of a parameter.
    #[inline]
    pub fn of(&self, parameter: usize) -> f64 {
        if self.parameter == Some(parameter) { 1.0 } else { 0.0 }
    }
}
