//! Planar rigid motions in the x–z plane, positive rotation about +y.

use super::{LieGroup, Stumpff};
use crate::linalg::{Matrix, Vector, fma};
use crate::strain::Mode;

/// A planar pose: rotation `(cos, sin)` and position `(x, z)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SE2 {
    cos: f64,
    sin: f64,
    position: Vector<2>,
}

/// `e_y × v`, the quarter turn of this plane.
#[inline]
fn turn(v: [f64; 2]) -> [f64; 2] {
    [v[1], -v[0]]
}

/// Σ of multiples of rows.
#[inline(always)]
fn combine<const C: usize>([(a, first), (b, second), (c, third)]: [(f64, &Vector<C>); 3]) -> [f64; C] {
    std::array::from_fn(|i| fma(c, third[i], fma(b, second[i], a * first[i])))
}

impl LieGroup<3, 2> for SE2 {
    const IDENTITY: Self = Self { cos: 1.0, sin: 0.0, position: Vector::ZERO };
    const AXES: [Mode; 3] = [Mode::BendY, Mode::ExtendX, Mode::ShearZ];

    #[inline]
    fn angle_squared(omega: &Vector<3>) -> f64 {
        omega[0] * omega[0]
    }

    #[inline]
    fn exp(omega: &Vector<3>, c: &Stumpff) -> Self {
        let (w, v) = (omega[0], [omega[1], omega[2]]);
        let jv = turn(v);
        let (along, across) = (c.c[1], w * c.c[2]);
        Self {
            cos: c.c[0],
            sin: w * c.c[1],
            position: Vector([fma(along, v[0], across * jv[0]), fma(along, v[1], across * jv[1])]),
        }
    }

    #[inline]
    fn tangent(omega: &Vector<3>, c: &Stumpff) -> Matrix<3, 3> {
        let (w, v) = (omega[0], [omega[1], omega[2]]);
        let jv = turn(v);
        let (diagonal, off) = (c.c[1], w * c.c[2]);
        Matrix([
            [1.0, 0.0, 0.0],
            [c.c[2] * jv[0] + c.c[3] * w * v[0], diagonal, -off],
            [c.c[2] * jv[1] + c.c[3] * w * v[1], off, diagonal],
        ])
    }

    #[inline]
    fn tangent_curvature(omega: &Vector<3>, force: &Vector<3>, c: &Stumpff) -> Matrix<3, 3> {
        let (w, v) = (omega[0], [omega[1], omega[2]]);
        let f = [force[1], force[2]];
        let fv = f[0] * v[0] + f[1] * v[1];
        let f_cross_v = f[1] * v[0] - f[0] * v[1];
        let (d2, d3) = (c.first(2), c.first(3));
        let ww = c.c[3] * fv + w * (2.0 * d3 * fv * w - 2.0 * d2 * f_cross_v);
        // f × ω in this plane is −w (e_y × f).
        let jf = turn(f);
        let a = -(c.c[3] + 2.0 * c.x * d3);
        let b = 2.0 * d2 * w;
        let g = [0.5 * w * (a * f[0] + b * jf[0]), 0.5 * w * (a * f[1] + b * jf[1])];
        Matrix([[ww, g[0], g[1]], [g[0], 0.0, 0.0], [g[1], 0.0, 0.0]])
    }

    #[inline]
    fn compose(&self, right: &Self) -> Self {
        Self {
            cos: fma(self.cos, right.cos, -(self.sin * right.sin)),
            sin: fma(self.sin, right.cos, self.cos * right.sin),
            position: self.act(&right.position),
        }
    }

    fn inverse(&self) -> Self {
        let transposed = Self { cos: self.cos, sin: -self.sin, position: Vector::ZERO };
        Self { position: -transposed.rotate(&self.position), ..transposed }
    }

    #[inline]
    fn adjoint(&self) -> Matrix<3, 3> {
        let jp = turn(self.position.0);
        Matrix([[1.0, 0.0, 0.0], [-jp[0], self.cos, self.sin], [-jp[1], -self.sin, self.cos]])
    }

    #[inline]
    fn ad(a: &Vector<3>) -> Matrix<3, 3> {
        let jv = turn([a[1], a[2]]);
        Matrix([[0.0, 0.0, 0.0], [-jv[0], 0.0, a[0]], [-jv[1], -a[0], 0.0]])
    }

    #[inline]
    fn bracket(a: &Vector<3>, b: &Vector<3>) -> Vector<3> {
        let jv = turn([a[1], a[2]]);
        Vector([0.0, fma(a[0], b[2], -jv[0] * b[0]), fma(-a[0], b[1], -jv[1] * b[0])])
    }

    #[inline]
    fn bracket_form(w: &Vector<3>) -> Matrix<3, 3> {
        let (fx, fz) = (w[1], w[2]);
        Matrix([[0.0, -fz, fx], [fz, 0.0, 0.0], [-fx, 0.0, 0.0]])
    }

    #[inline(always)]
    fn operate<const C: usize>(operator: &Matrix<3, 3>, columns: &Matrix<3, C>) -> Matrix<3, C> {
        let [[a, ..], x, z] = operator.0;
        let [turn, along, across] = columns.0.map(Vector);
        let linear = |[b, c, d]: [f64; 3]| combine([(b, &turn), (c, &along), (d, &across)]);
        Matrix([(turn * a).0, linear(x), linear(z)])
    }

    #[inline(always)]
    fn operate_dual(operator: &Matrix<3, 3>, wrench: &Vector<3>) -> Vector<3> {
        let [[a, ..], [b, c, d], [e, f, g]] = operator.0;
        let [moment, x, z] = wrench.0;
        Vector([fma(z, e, fma(x, b, moment * a)), fma(z, f, x * c), fma(z, g, x * d)])
    }

    #[inline(always)]
    fn apply_form<const C: usize>(form: &Matrix<3, 3>, columns: &Matrix<3, C>) -> Matrix<3, C> {
        let [[a, b, c], [x, ..], [z, ..]] = form.0;
        let [turn, along, across] = columns.0.map(Vector);
        Matrix([combine([(a, &turn), (b, &along), (c, &across)]), (turn * x).0, (turn * z).0])
    }

    #[inline]
    fn position(&self) -> Vector<2> {
        self.position
    }

    #[inline]
    fn act(&self, point: &Vector<2>) -> Vector<2> {
        self.rotate(point) + self.position
    }

    #[inline]
    fn rotate(&self, d: &Vector<2>) -> Vector<2> {
        Vector([fma(self.cos, d[0], self.sin * d[1]), fma(self.cos, d[1], -(self.sin * d[0]))])
    }

    #[inline]
    fn point_jacobian(p: &Vector<2>) -> Matrix<2, 3> {
        let jp = turn(p.0);
        Matrix([[jp[0], 1.0, 0.0], [jp[1], 0.0, 1.0]])
    }

    #[inline]
    fn point_curvature(p: &Vector<2>, f: &Vector<2>) -> Matrix<3, 3> {
        let (x, z) = (-0.5 * f[1], 0.5 * f[0]);
        Matrix([[-f.dot(p), x, z], [x, 0.0, 0.0], [z, 0.0, 0.0]])
    }

    fn from_spatial(translation: &[f64; 3], rotation: &[f64; 3]) -> Option<Self> {
        let position = Self::point_from_spatial(translation)?;
        if rotation[0] != 0.0 || rotation[2] != 0.0 {
            return None;
        }
        let (sin, cos) = rotation[1].sin_cos();
        Some(Self { cos, sin, position })
    }

    fn to_homogeneous(&self) -> [[f64; 4]; 4] {
        let (c, s, p) = (self.cos, self.sin, &self.position);
        [[c, 0.0, s, p[0]], [0.0, 1.0, 0.0, 0.0], [-s, 0.0, c, p[1]], [0.0, 0.0, 0.0, 1.0]]
    }

    fn point_from_spatial(p: &[f64; 3]) -> Option<Vector<2>> {
        (p[1] == 0.0).then_some(Vector([p[0], p[2]]))
    }

    fn point_to_spatial(p: &Vector<2>) -> [f64; 3] {
        [p[0], 0.0, p[1]]
    }
}
