//! How a number changes with the state and the parameters, to first order.

use crate::geometry::add_radius_slope;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tree::Tree;

/// The change of a number: the sum of these slopes times the changes of coordinates, frames, points and
/// parameters.
#[derive(Clone, Debug)]
pub(crate) struct Differential<const D: usize, const P: usize> {
    /// By each coordinate.
    pub coordinates: Vec<f64>,
    /// By the world twist of frames.
    pub frames: Vec<(usize, Vector<D>)>,
    /// By the world position of points; a point may be listed more than once.
    pub points: Vec<(usize, Vector<P>)>,
    /// By each parameter, with coordinates and points held.
    pub parameters: Vec<f64>,
    /// By loads of inputs, with coordinates and points held.
    pub loads: Vec<(usize, f64)>,
    /// By the reaction of each condition of ties.
    pub reactions: Vec<f64>,
    /// Whether it is the largest of several numbers, and another one equals it.
    pub tied: bool,
}

impl<const D: usize, const P: usize> Differential<D, P> {
    pub fn new(dof: usize, parameters: usize, reactions: usize) -> Self {
        let [coordinates, parameters, reactions] = [dof, parameters, reactions].map(|n| vec![0.0; n]);
        Self {
            coordinates,
            frames: vec![],
            points: vec![],
            parameters,
            loads: vec![],
            reactions,
            tied: false,
        }
    }

    pub fn clear(&mut self) {
        self.coordinates.fill(0.0);
        self.frames.clear();
        self.points.clear();
        self.parameters.fill(0.0);
        self.loads.clear();
        self.reactions.fill(0.0);
        self.tied = false;
    }

    /// Adds slopes by the points of three spheres.
    pub fn add_points<G: LieGroup<D, P>>(
        &mut self,
        tree: &Tree<G, D, P>,
        spheres: [usize; 3],
        slopes: [Vector<P>; 3],
    ) {
        self.points.extend(spheres.map(|sphere| tree.spheres[sphere].point).into_iter().zip(slopes));
    }

    /// Adds a slope by the radius of a sphere.
    pub fn add_radius<G: LieGroup<D, P>>(
        &mut self,
        tree: &Tree<G, D, P>,
        p: &[f64],
        sphere: usize,
        slope: f64,
    ) {
        add_radius_slope(tree, p, tree.spheres[sphere].radius, slope, &mut self.parameters);
    }
}

/// The largest of several numbers with its place.
#[derive(Clone, Debug)]
pub(crate) struct Largest<T> {
    value: f64,
    pub place: Option<T>,
    pub tied: bool,
}

/// Relative difference below which two numbers are tied.
const TIED: f64 = 1e-9;

/// Whether two numbers are nearly the same, neither of them zero.
pub(crate) fn is_tied(a: f64, b: f64) -> bool {
    a != 0.0 && b != 0.0 && (a - b).abs() <= TIED * a.abs()
}

impl<T> Largest<T> {
    pub fn new() -> Self {
        Self { value: f64::NEG_INFINITY, place: None, tied: false }
    }

    /// Compares with another number; `is_same` says whether a place is the one that it is at.
    pub fn offer(&mut self, value: f64, place: T, is_same: impl Fn(&T) -> bool) {
        let near = (value - self.value).abs() <= TIED * value.abs();
        let other = self.place.as_ref().is_some_and(|place| near && !is_same(place));
        self.tied = other || self.tied && value <= self.value + TIED * value.abs();
        if self.place.is_none() || value > self.value {
            (self.value, self.place) = (value, Some(place));
        }
    }
}

/// A sphere at p of radius R that is d = R + r(t) − ‖p − c(t)‖ deep in the solid around
/// c(t) = (1 − t) a + t b of radius r(t) = (1 − t) r_a + t r_b, where t maximises d.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Depth<const P: usize> {
    pub depth: f64,
    /// The spheres at p, a, b.
    pub spheres: [usize; 3],
    pub t: f64,
    /// Unit vector from c(t) to p.
    pub normal: Vector<P>,
}

impl<const P: usize> Depth<P> {
    /// Whether it is the depth of the same sphere in the same direction, as that in two joined solids is.
    pub fn is_same(&self, other: &Self) -> bool {
        self.spheres[0] == other.spheres[0] && self.normal.dot(&other.normal) > 1.0 - TIED
    }

    /// Adds a multiple of the change of d: t, where d is largest, may be held.
    pub fn add<G: LieGroup<D, P>, const D: usize>(
        &self,
        tree: &Tree<G, D, P>,
        p: &[f64],
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        let shares = [1.0, 1.0 - self.t, self.t];
        let [at_p, at_a, at_b] = [-shares[0], shares[1], shares[2]].map(|s| self.normal * (s * weight));
        out.add_points(tree, self.spheres, [at_p, at_a, at_b]);
        for (sphere, share) in self.spheres.into_iter().zip(shares) {
            out.add_radius(tree, p, sphere, share * weight);
        }
    }
}
