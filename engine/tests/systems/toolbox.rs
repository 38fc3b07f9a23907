//! The toolbox's exponential: `Equilibrium` cuts it after Ω̂³/6 when θ ≤ 1e-2 (its `FwdKinematics` does not).

use flexor_engine::lie::{LieGroup, Stumpff};
use flexor_engine::linalg::{Matrix, Vector};
use flexor_engine::strain::Mode;

/// `G` with that exponential; everything else is `G`'s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toolbox<G>(G);

impl<G: LieGroup<D, P>, const D: usize, const P: usize> LieGroup<D, P> for Toolbox<G> {
    const IDENTITY: Self = Self(G::IDENTITY);
    const AXES: [Mode; D] = G::AXES;

    fn exp(omega: &Vector<D>, c: &Stumpff) -> Self {
        let mut c = *c;
        if c.x.sqrt() <= 1e-2 {
            [c.c[0], c.c[1], c.c[2], c.c[3]] = [1.0 - c.x / 2.0, 1.0 - c.x / 6.0, 1.0 / 2.0, 1.0 / 6.0];
        }
        Self(G::exp(omega, &c))
    }

    fn angle_squared(omega: &Vector<D>) -> f64 {
        G::angle_squared(omega)
    }
    fn tangent(omega: &Vector<D>, c: &Stumpff) -> Matrix<D, D> {
        G::tangent(omega, c)
    }
    fn tangent_curvature(omega: &Vector<D>, w: &Vector<D>, c: &Stumpff) -> Matrix<D, D> {
        G::tangent_curvature(omega, w, c)
    }
    fn compose(&self, right: &Self) -> Self {
        Self(self.0.compose(&right.0))
    }
    fn inverse(&self) -> Self {
        Self(self.0.inverse())
    }
    fn adjoint(&self) -> Matrix<D, D> {
        self.0.adjoint()
    }
    fn ad(a: &Vector<D>) -> Matrix<D, D> {
        G::ad(a)
    }
    fn bracket_form(w: &Vector<D>) -> Matrix<D, D> {
        G::bracket_form(w)
    }
    fn position(&self) -> Vector<P> {
        self.0.position()
    }
    fn act(&self, point: &Vector<P>) -> Vector<P> {
        self.0.act(point)
    }
    fn rotate(&self, direction: &Vector<P>) -> Vector<P> {
        self.0.rotate(direction)
    }
    fn point_jacobian(p: &Vector<P>) -> Matrix<P, D> {
        G::point_jacobian(p)
    }
    fn point_curvature(p: &Vector<P>, f: &Vector<P>) -> Matrix<D, D> {
        G::point_curvature(p, f)
    }
    fn from_spatial(translation: &[f64; 3], rotation: &[f64; 3]) -> Option<Self> {
        G::from_spatial(translation, rotation).map(Self)
    }
    fn to_homogeneous(&self) -> [[f64; 4]; 4] {
        self.0.to_homogeneous()
    }
    fn point_from_spatial(p: &[f64; 3]) -> Option<Vector<P>> {
        G::point_from_spatial(p)
    }
    fn point_to_spatial(p: &Vector<P>) -> [f64; 3] {
        G::point_to_spatial(p)
    }
}
