//! The terms of the potential Π, one file each, and what they add to.
//!
//! A term is either a function of the coordinates themselves (elasticity, joint limits, chambers) or
//! of the poses of frames (contact, gravity, springs, point loads). The latter report world-frame
//! wrenches and stiffness forms, which the assembly turns into gradient and tangent.

pub(crate) mod actuator;
pub(crate) mod contact;
pub(crate) mod elastic;
pub(crate) mod enclosure;
pub(crate) mod gravity;
pub(crate) mod joint;
pub(crate) mod round_cone;
pub(crate) mod spring;
pub(crate) mod touch;
pub(crate) mod wrench;

use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};
use crate::model::Chain;
use touch::Touch;

/// Terms in the coordinates: energy, gradient and half of the Hessian.
///
/// The Hessian is kept as a matrix U with `∇²Π = U + Uᵀ`, so that each pair is written once.
#[derive(Clone, Debug)]
pub(crate) struct CoordinateTerms {
    pub energy: f64,
    pub gradient: Vec<f64>,
    pub half_tangent: Vec<f64>,
    /// What the points of chambers and cables keep for the tangent: curvature of each.
    curvature: Vec<f64>,
    /// The part of each point's unit tangent along each of its columns.
    along: Vec<f64>,
}

impl CoordinateTerms {
    pub fn new(dof: usize) -> Self {
        Self {
            energy: 0.0,
            gradient: vec![0.0; dof],
            half_tangent: vec![0.0; dof * dof],
            curvature: vec![],
            along: vec![],
        }
    }

    pub fn clear(&mut self) {
        self.energy = 0.0;
        self.gradient.fill(0.0);
    }

    /// Clears it, or with a chain only what does not follow from its form.
    pub fn clear_tangent(&mut self, chain: Option<&Chain>) {
        let Some(chain) = chain else { return self.half_tangent.fill(0.0) };
        let n = self.gradient.len();
        for (i, row) in self.half_tangent.chunks_exact_mut(n).enumerate() {
            chain.neighbours(i).iter().for_each(|j| row[*j] = 0.0);
        }
    }

    /// Adds `k` to the second derivative along coordinate `i`.
    #[inline]
    pub fn add_diagonal(&mut self, i: usize, k: f64) {
        let n = self.gradient.len();
        self.half_tangent[i * n + i] += 0.5 * k;
    }
}

/// A second-order interaction `ζ_rowᵀ form ζ_column` between two frames.
#[derive(Clone, Debug)]
pub(crate) struct Coupling<const D: usize> {
    pub row: usize,
    pub column: usize,
    pub form: Matrix<D, D>,
}

/// Terms in the poses of frames: energy and wrenches, and for the tangent, which follows them,
/// stiffness forms.
#[derive(Clone, Debug)]
pub(crate) struct FrameTerms<const D: usize, const P: usize> {
    pub energy: f64,
    /// Derivative with respect to each frame's world twist.
    pub wrench: Vec<Vector<D>>,
    /// Frames that carry something.
    pub loaded: Vec<bool>,
    /// What touches, with the index of its contact.
    pub touches: Vec<(usize, Touch<P>)>,
    /// Symmetric second derivative.
    pub stiffness: Vec<Matrix<D, D>>,
    pub couplings: Vec<Coupling<D>>,
}

impl<const D: usize, const P: usize> FrameTerms<D, P> {
    pub fn new(frames: usize, couplings: usize) -> Self {
        Self {
            energy: 0.0,
            wrench: vec![Vector::ZERO; frames],
            loaded: vec![false; frames],
            touches: Vec::with_capacity(couplings),
            stiffness: vec![Matrix::ZERO; frames],
            couplings: Vec::with_capacity(couplings),
        }
    }

    pub fn clear(&mut self) {
        self.energy = 0.0;
        self.wrench.fill(Vector::ZERO);
        self.loaded.fill(false);
        self.touches.clear();
    }

    pub fn clear_tangent(&mut self) {
        self.stiffness.fill(Matrix::ZERO);
        self.couplings.clear();
    }

    /// A potential of the point `p` of `frame`, with gradient `f`.
    #[inline]
    pub fn add_force<G: LieGroup<D, P>>(&mut self, frame: usize, p: &Vector<P>, f: &Vector<P>) {
        self.loaded[frame] = true;
        self.wrench[frame] += G::point_jacobian(p).transpose_times(f);
    }

    /// Its second derivative, if it has none in `p`.
    #[inline]
    pub fn add_curvature<G: LieGroup<D, P>>(&mut self, frame: usize, p: &Vector<P>, f: &Vector<P>) {
        self.stiffness[frame] += G::point_curvature(p, f);
    }

    /// The second derivative of a potential of the vector `a − b` between points of two frames:
    /// gradient `f`, and Hessian `normal n nᵀ + tangential (1 − n nᵀ)`.
    #[inline]
    pub fn add_pair<G: LieGroup<D, P>>(
        &mut self,
        frames: [usize; 2],
        points: [&Vector<P>; 2],
        f: &Vector<P>,
        n: &Vector<P>,
        [normal, tangential]: [f64; 2],
    ) {
        let [a, b] = points.map(|p| G::point_jacobian(p));
        let hessian = n.outer(n) * (normal - tangential) + Matrix::diagonal(tangential);
        let (ha, hb) = (hessian * a, hessian * b);
        let (at, bt) = (a.transpose(), b.transpose());
        self.stiffness[frames[0]] += at * ha + G::point_curvature(points[0], f);
        self.stiffness[frames[1]] += bt * hb + G::point_curvature(points[1], &-*f);
        self.couplings.push(Coupling { row: frames[0], column: frames[1], form: (at * hb) * -1.0 });
    }
}
