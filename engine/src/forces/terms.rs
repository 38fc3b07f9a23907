//! Accumulators for the forces: terms in the coordinates and terms in the poses of frames.

use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};
use crate::tree::Chain;

/// Energy, residual and tangent of all forces.
#[derive(Clone, Debug)]
pub(crate) struct Terms<const D: usize> {
    pub coordinates: CoordinateTerms,
    pub frames: FrameTerms<D>,
}

/// Terms in the coordinates: energy, gradient and half of the Hessian.
///
/// The Hessian is kept as a matrix U with `∇²Π = U + Uᵀ`, so that each pair is written once.
#[derive(Clone, Debug)]
pub(crate) struct CoordinateTerms {
    pub energy: f64,
    pub gradient: Vec<f64>,
    pub half_tangent: Vec<f64>,
}

impl CoordinateTerms {
    pub fn new(dof: usize) -> Self {
        Self { energy: 0.0, gradient: vec![0.0; dof], half_tangent: vec![0.0; dof * dof] }
    }

    pub fn clear(&mut self) {
        self.energy = 0.0;
        self.gradient.fill(0.0);
    }

    /// Clears the tangent: with a chain only where coordinates are neighbours, as forces in the
    /// coordinates are local to them.
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

    /// Adds an entry K_ij, i ≤ j, of the stiffness of neighbours to the tangent.
    #[inline]
    pub fn add_stiffness(&mut self, i: usize, j: usize, k: f64) {
        let n = self.gradient.len();
        self.half_tangent[j * n + i] += if i == j { 0.5 * k } else { k };
    }

    /// Adds the forces of an entry K_ij, i ≤ j, to the gradient; returns its part of ½ qᵀKq.
    #[inline]
    pub fn add_quadratic(&mut self, i: usize, j: usize, k: f64, q: &[f64]) -> f64 {
        self.gradient[i] += k * q[j];
        if i == j {
            0.5 * k * q[i] * q[i]
        } else {
            self.gradient[j] += k * q[i];
            k * q[i] * q[j]
        }
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
pub(crate) struct FrameTerms<const D: usize> {
    pub energy: f64,
    /// Derivative with respect to each frame's world twist.
    pub wrench: Vec<Vector<D>>,
    /// Frames that carry a load.
    pub loaded: Vec<bool>,
    /// Symmetric second derivative.
    pub stiffness: Vec<Matrix<D, D>>,
    pub couplings: Vec<Coupling<D>>,
    /// Antisymmetric second derivatives, of forces without a potential, on frames whose Jacobian is
    /// kept: form J dq is the change of the wrench.
    pub circulatory: Vec<(usize, Matrix<D, D>)>,
}

impl<const D: usize> FrameTerms<D> {
    pub fn new(frames: usize, couplings: usize) -> Self {
        Self {
            energy: 0.0,
            wrench: vec![Vector::ZERO; frames],
            loaded: vec![false; frames],
            stiffness: vec![Matrix::ZERO; frames],
            couplings: Vec::with_capacity(couplings),
            circulatory: Vec::with_capacity(couplings),
        }
    }

    pub fn clear(&mut self) {
        self.energy = 0.0;
        self.wrench.fill(Vector::ZERO);
        self.loaded.fill(false);
    }

    pub fn clear_tangent(&mut self) {
        self.stiffness.fill(Matrix::ZERO);
        self.couplings.clear();
        self.circulatory.clear();
    }

    /// A potential of the point `p` of `frame`, with gradient `f`.
    #[inline]
    pub fn add_force<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        frame: usize,
        p: &Vector<P>,
        f: &Vector<P>,
    ) {
        self.loaded[frame] = true;
        self.wrench[frame] += G::point_jacobian(p).transpose_times(f);
    }

    /// Its second derivative, if it has none in `p`.
    #[inline]
    pub fn add_curvature<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        frame: usize,
        p: &Vector<P>,
        f: &Vector<P>,
    ) {
        self.stiffness[frame] += G::point_curvature(p, f);
    }

    /// The second derivative of a potential of the vector `a − b` between points of two frames:
    /// gradient `f`, and Hessian `normal n nᵀ + tangential (1 − n nᵀ)`.
    #[inline]
    pub fn add_pair<G: LieGroup<D, P>, const P: usize>(
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

    /// The second derivative of a potential of a sum of points, each given by its frame, its place and its
    /// weight; the Jacobians of all but the first frame are kept. Gradient and Hessian as above.
    pub fn add_weighted<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        arms: &[(usize, Vector<P>, f64)],
        f: &Vector<P>,
        n: &Vector<P>,
        [normal, tangential]: [f64; 2],
    ) {
        let hessian = n.outer(n) * (normal - tangential) + Matrix::diagonal(tangential);
        for (i, (row, p, weight)) in arms.iter().enumerate() {
            let held = G::point_jacobian(p).transpose() * hessian * *weight;
            self.stiffness[*row] +=
                held * G::point_jacobian(p) * *weight + G::point_curvature(p, &(*f * *weight));
            for (column, other, share) in &arms[i + 1..] {
                let form = held * G::point_jacobian(other) * *share;
                self.couplings.push(Coupling { row: *row, column: *column, form });
            }
        }
    }

    /// The second derivative of a potential of the place that a point `p` of the first frame has in the second
    /// one, with gradient `f` in the world; `form` is its Hessian by the world twist of `p`.
    #[inline]
    pub fn add_carried<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        [first, second]: [usize; 2],
        p: &Vector<P>,
        f: &Vector<P>,
        form: Matrix<D, D>,
    ) {
        let relative = form + G::point_curvature(p, f);
        self.stiffness[first] += relative;
        self.stiffness[second] += relative;
        // exp(−ζ₂) exp(ζ₁) = exp(ζ₁ − ζ₂ + ½ [ζ₁, ζ₂] + …).
        let bracket = G::bracket_form(&G::point_jacobian(p).transpose_times(f));
        self.couplings.push(Coupling { row: first, column: second, form: bracket * 0.5 - relative });
    }
}
