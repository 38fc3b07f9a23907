//! The state of a model at which its forces are evaluated.

use crate::geometry::Geometry;
use crate::kinematics::Kinematics;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tree::Tree;

/// Force law of stiff terms: springs and contacts.
///
/// The mixed Newton method treats their forces λ as unknowns, with k d = λ at the solution: a stiff contact
/// then limits the steps no more than a soft one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Law {
    /// The actual law.
    #[default]
    Actual,
    /// Terms with a kept force act in both directions.
    TwoSided,
    /// The forces are the kept ones, regardless of the distances.
    Kept,
}

/// A state under load.
#[derive(Debug)]
pub(crate) struct State<'a, G, const D: usize, const P: usize> {
    pub tree: &'a Tree<G, D, P>,
    pub geometry: &'a Geometry<G, D, P>,
    pub kinematics: &'a Kinematics<G, D, P>,
    pub q: &'a [f64],
    pub load: &'a [f64],
    pub law: Law,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> State<'_, G, D, P> {
    /// The parameters of the design.
    #[inline]
    pub fn parameters(&self) -> &[f64] {
        &self.geometry.parameters
    }

    /// World position of a point.
    #[inline]
    pub fn point(&self, point: usize) -> &Vector<P> {
        &self.kinematics.points[point]
    }

    /// World position of the centre of a sphere.
    #[inline]
    pub fn centre(&self, sphere: usize) -> &Vector<P> {
        self.point(self.tree.spheres[sphere].point)
    }

    /// The frame that carries a point.
    #[inline]
    pub fn frame(&self, point: usize) -> usize {
        self.geometry.frames[point]
    }
}
