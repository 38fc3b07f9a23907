//! The tree of bodies: topology, strain bases and indices, all independent of the design.
//!
//! Each frame follows from its parent by one motion: a rigid offset, a joint, or a Magnus step along a
//! rod; the recursion of the paper's (4)–(7) is one loop over frames. Continuous numbers (lengths,
//! radii, moduli, stiffnesses, poses) are kept apart, as one flat vector of parameters named by a
//! [`Layout`].

mod admissible;
mod between;
mod blocks;
mod bodies;
mod build;
mod chain;
pub mod description;
mod error;
mod layout;
mod points;

pub use error::ModelError;
pub use layout::Layout;

pub(crate) use between::Between;
pub(crate) use blocks::CoordinateBlocks;
pub(crate) use bodies::{Body, GaussPoint, JointCoordinate, JointLimits, Link, Rod, SectionEntry, Shape};
pub(crate) use chain::Chain;
pub(crate) use error::{finite, not_negative, positive};
pub(crate) use points::{Place, Point, Sphere, SphereRadius};

use crate::linalg::Vector;
use description::SharedInputDescription;
use std::ops::Range;

/// A frame and the motion that leads to it from its parent.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Frame {
    pub parent: usize,
    pub body: usize,
    pub motion: Motion,
    /// Coordinates are `path.start..path.end` at most on the way from the world to this frame.
    pub path: Range<usize>,
    /// Its own coordinates, in `column_dofs`.
    pub columns: Range<usize>,
    /// Its own coordinates' places in the stores of column blocks.
    pub blocks: Range<usize>,
    /// Their values' places in the blocks of coordinates.
    pub coordinates: Range<usize>,
    /// One past the last of the following frames that move with the same coordinates.
    pub run_end: usize,
}

/// The motion of a frame relative to its parent.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Motion {
    /// By the pose `design.rigid[i]`.
    Rigid(usize),
    /// By `exp(Σ b_c q_c)` over these joint columns.
    Joint(Range<usize>),
    /// By the Magnus step `steps[i]`.
    Strain(usize),
}

/// A joint coordinate and its constant twist.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JointColumn<const D: usize> {
    pub dof: usize,
    pub twist: Vector<D>,
}

/// A rod coordinate as seen by one Magnus step: its axis and its basis function at the step's
/// collocation points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StrainColumn {
    pub dof: usize,
    pub axis: usize,
    pub phi: [f64; 2],
}

/// A Magnus step over ΔX = `h`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MagnusStep {
    pub rod: usize,
    pub h: f64,
    pub columns: Range<usize>,
}

/// The bodies of a model, joined in a tree of frames, and the points on them that forces act on.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree<G, const D: usize, const P: usize> {
    pub(crate) dof: usize,
    /// `frames[0]` is the world; parents come before children.
    pub(crate) frames: Vec<Frame>,
    pub(crate) steps: Vec<MagnusStep>,
    pub(crate) strain_columns: Vec<StrainColumn>,
    pub(crate) joint_columns: Vec<JointColumn<D>>,
    /// Coordinates of each frame's own motion, frame after frame.
    pub(crate) column_dofs: Vec<usize>,
    pub(crate) coordinate_blocks: CoordinateBlocks,
    pub(crate) bodies: Vec<Body<P>>,
    pub(crate) rods: Vec<Rod>,
    pub(crate) joints: Vec<JointCoordinate>,
    /// Sparsity of the rods' stiffness: index pairs `i ≤ j`.
    pub(crate) stiffness_pattern: Vec<(usize, usize)>,
    pub(crate) points: Vec<Point<P>>,
    pub(crate) spheres: Vec<Sphere>,
    /// Points after places between sample points, whose frames depend on the design and whose Jacobians are kept.
    pub(crate) moving: Vec<usize>,
    /// Groups of spheres by name.
    pub(crate) sphere_groups: Vec<(String, Range<usize>)>,
    /// Frames whose Jacobian is kept, with their slot in the store.
    pub(crate) jacobian_slot: Vec<Option<usize>>,
    /// Frames on the way to a kept one.
    pub(crate) leads_to_kept: Vec<bool>,
    /// Coordinates on which the kept frames depend.
    pub(crate) coupled: Range<usize>,
    pub(crate) layout: Layout,
    pub(crate) parameters: Vec<f64>,
    pub(crate) coordinates: Vec<String>,
    pub(crate) inputs: Vec<String>,
    /// Inputs each of which drives several forces.
    pub(crate) shared_inputs: Vec<SharedInputDescription>,
    pub(crate) frame_names: Vec<String>,
    pub(crate) group: std::marker::PhantomData<G>,
}
