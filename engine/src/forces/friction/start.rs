//! What a step with friction begins with: where frames are, and the slips so far.

use super::super::state::State;
use super::point::Key;
use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};

/// Where a frame is as a step begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placement<const P: usize> {
    rotation: Matrix<P, P>,
    translation: Vector<P>,
}

impl<const P: usize> Placement<P> {
    pub fn of<G: LieGroup<D, P>, const D: usize>(pose: &G) -> Self {
        let mut rotation = Matrix::ZERO;
        for axis in 0..P {
            rotation.set_column(axis, &pose.rotate(&Vector::unit(axis)));
        }
        Self { rotation, translation: pose.position() }
    }

    pub fn act(&self, point: &Vector<P>) -> Vector<P> {
        self.rotation * *point + self.translation
    }

    pub fn rotate(&self, direction: &Vector<P>) -> Vector<P> {
        self.rotation * *direction
    }

    /// A point of the world in the frame.
    pub fn undo(&self, point: &Vector<P>) -> Vector<P> {
        self.rotation.transpose_times(&(*point - self.translation))
    }

    /// A direction of the world in the frame.
    pub fn rotate_back(&self, direction: &Vector<P>) -> Vector<P> {
        self.rotation.transpose_times(direction)
    }
}

/// The elastic slip with which a point begins a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Begun<const P: usize> {
    pub key: Key,
    /// In the axes of this frame.
    pub slip: Vector<P>,
    pub frame: usize,
    /// Tangential stiffness [N/m].
    pub stiffness: f64,
}

impl<const P: usize> Begun<P> {
    /// Energy that it stores [J].
    pub fn energy(&self) -> f64 {
        0.5 * self.stiffness * self.slip.dot(&self.slip)
    }
}

/// Where everything is as a step begins.
#[derive(Clone, Debug, Default)]
pub(crate) struct Start<const P: usize> {
    pub frames: Vec<Placement<P>>,
    pub points: Vec<Begun<P>>,
}

impl<const P: usize> Start<P> {
    /// Takes the frames from a state.
    pub fn place<G: LieGroup<D, P>, const D: usize>(&mut self, at: &State<G, D, P>) {
        self.frames.clear();
        self.frames.extend(at.kinematics.pose.iter().map(Placement::of));
    }

    /// The slip with which a point begins in the axes of another frame.
    pub fn slip_in(&self, begun: &Begun<P>, frame: usize) -> Vector<P> {
        if frame == begun.frame {
            return begun.slip;
        }
        self.frames[frame].rotate_back(&self.frames[begun.frame].rotate(&begun.slip))
    }
}
