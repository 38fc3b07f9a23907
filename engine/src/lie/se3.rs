//! Rigid motions in space.
//!
//! se(3) is so(3) over the dual numbers ω + εv, so each lower-left block below is the derivative of
//! the so(3) expression at ω in the direction v.

use super::{LieGroup, Stumpff};
use crate::linalg::{Matrix, Vector};
use crate::strain::Mode;

type V3 = Vector<3>;
type M3 = Matrix<3, 3>;

/// A spatial pose: rotation matrix and position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SE3 {
    rotation: M3,
    position: V3,
}

#[inline]
fn hat(a: &V3) -> M3 {
    Matrix([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
}

#[inline]
fn cross(a: &V3, b: &V3) -> V3 {
    Vector([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
}

#[inline]
fn split(t: &Vector<6>) -> (V3, V3) {
    (Vector([t[0], t[1], t[2]]), Vector([t[3], t[4], t[5]]))
}

#[inline]
fn blocks(a: &M3, b: &M3, c: &M3, d: &M3) -> Matrix<6, 6> {
    let mut m = Matrix::ZERO;
    for r in 0..3 {
        for k in 0..3 {
            m.0[r][k] = a.0[r][k];
            m.0[r][k + 3] = b.0[r][k];
            m.0[r + 3][k] = c.0[r][k];
            m.0[r + 3][k + 3] = d.0[r][k];
        }
    }
    m
}

#[inline]
fn symmetric_outer(a: &V3, b: &V3) -> M3 {
    (a.outer(b) + b.outer(a)) * 0.5
}

/// The symmetric form of `f·(J'(ω)[a] a)`, with `J` the body tangent operator of SO(3).
///
/// It is `α I + sym(ω gᵀ)`; returns `(α, g)`.
#[inline]
fn so3_curvature(w: &V3, f: &V3, c: &Stumpff) -> (f64, V3) {
    let (d2, d3) = (c.first(2), c.first(3));
    let fw = f.dot(w);
    let g = *f * -(c.c[3] + 2.0 * c.x * d3) - cross(f, w) * (2.0 * d2) + *w * (2.0 * d3 * fw);
    (c.c[3] * fw, g)
}

impl LieGroup<6, 3> for SE3 {
    const IDENTITY: Self = Self {
        rotation: Matrix([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        position: Vector::ZERO,
    };
    const AXES: [Mode; 6] =
        [Mode::TwistX, Mode::BendY, Mode::BendZ, Mode::ExtendX, Mode::ShearY, Mode::ShearZ];

    #[inline]
    fn angle_squared(omega: &Vector<6>) -> f64 {
        omega[0] * omega[0] + omega[1] * omega[1] + omega[2] * omega[2]
    }

    #[inline]
    fn exp(omega: &Vector<6>, c: &Stumpff) -> Self {
        let (w, v) = split(omega);
        let wh = hat(&w);
        let wh2 = wh * wh;
        let position = v + cross(&w, &v) * c.c[2] + (wh2 * v) * c.c[3];
        Self { rotation: Matrix::identity() + wh * c.c[1] + wh2 * c.c[2], position }
    }

    #[inline]
    fn tangent(omega: &Vector<6>, c: &Stumpff) -> Matrix<6, 6> {
        let (w, v) = split(omega);
        let (wh, vh) = (hat(&w), hat(&v));
        let wh2 = wh * wh;
        let wv = 2.0 * w.dot(&v);
        let j = M3::identity() - wh * c.c[2] + wh2 * c.c[3];
        let dj =
            (wh * vh + vh * wh) * c.c[3] - vh * c.c[2] - wh * (c.first(2) * wv) + wh2 * (c.first(3) * wv);
        blocks(&j, &M3::ZERO, &dj, &j)
    }

    #[inline]
    fn tangent_curvature(omega: &Vector<6>, wrench: &Vector<6>, c: &Stumpff) -> Matrix<6, 6> {
        let (w, v) = split(omega);
        let (m, f) = split(wrench);
        let (alpha_m, g_m) = so3_curvature(&w, &m, c);
        let (alpha_f, g_f) = so3_curvature(&w, &f, c);

        // Derivative of the force's form in the direction v.
        let (d2, d3) = (c.first(2), c.first(3));
        let (dd2, dd3) = (c.second(2), c.second(3));
        let (fw, fv, dx) = (f.dot(&w), f.dot(&v), 2.0 * w.dot(&v));
        let d_alpha = d3 * dx * fw + c.c[3] * fv;
        let d_g = f * (-dx * (3.0 * d3 + 2.0 * c.x * dd3))
            - (cross(&f, &w) * (dd2 * dx) + cross(&f, &v) * d2) * 2.0
            + w * (2.0 * (dd3 * dx * fw + d3 * fv))
            + v * (2.0 * d3 * fw);

        let angular =
            M3::diagonal(alpha_m + d_alpha) + symmetric_outer(&w, &(g_m + d_g)) + symmetric_outer(&v, &g_f);
        let mixed = M3::diagonal(alpha_f) + symmetric_outer(&w, &g_f);
        blocks(&angular, &mixed, &mixed, &M3::ZERO)
    }

    #[inline]
    fn compose(&self, right: &Self) -> Self {
        Self { rotation: self.rotation * right.rotation, position: self.act(&right.position) }
    }

    fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, position: -(rotation * self.position) }
    }

    #[inline]
    fn adjoint(&self) -> Matrix<6, 6> {
        let lower = hat(&self.position) * self.rotation;
        blocks(&self.rotation, &M3::ZERO, &lower, &self.rotation)
    }

    #[inline]
    fn ad(a: &Vector<6>) -> Matrix<6, 6> {
        let (w, v) = split(a);
        let wh = hat(&w);
        blocks(&wh, &M3::ZERO, &hat(&v), &wh)
    }

    #[inline]
    fn bracket_form(w: &Vector<6>) -> Matrix<6, 6> {
        let (m, f) = split(w);
        let fh = hat(&-f);
        blocks(&hat(&-m), &fh, &fh, &M3::ZERO)
    }

    #[inline]
    fn position(&self) -> V3 {
        self.position
    }

    #[inline]
    fn act(&self, point: &V3) -> V3 {
        self.rotation * *point + self.position
    }

    #[inline]
    fn rotate(&self, direction: &V3) -> V3 {
        self.rotation * *direction
    }

    #[inline]
    fn point_jacobian(p: &V3) -> Matrix<3, 6> {
        let ph = hat(&-*p);
        let mut a = Matrix::ZERO;
        for r in 0..3 {
            for k in 0..3 {
                a.0[r][k] = ph.0[r][k];
            }
            a.0[r][r + 3] = 1.0;
        }
        a
    }

    #[inline]
    fn point_curvature(p: &V3, f: &V3) -> Matrix<6, 6> {
        // f·(ω×(ω×p)) = (f·ω)(ω·p) − (f·p)|ω|², and f·(ω×v) = −ωᵀ f̂ v.
        let angular = symmetric_outer(f, p) - M3::diagonal(f.dot(p));
        let mixed = hat(f) * -0.5;
        blocks(&angular, &mixed, &mixed.transpose(), &M3::ZERO)
    }

    fn from_spatial(translation: &[f64; 3], rotation: &[f64; 3]) -> Option<Self> {
        let turn = Self::exponential(&Vector([rotation[0], rotation[1], rotation[2], 0.0, 0.0, 0.0]));
        Some(Self { rotation: turn.rotation, position: Vector(*translation) })
    }

    fn to_homogeneous(&self) -> [[f64; 4]; 4] {
        let mut h = [[0.0; 4]; 4];
        for r in 0..3 {
            h[r][..3].copy_from_slice(&self.rotation.0[r]);
            h[r][3] = self.position[r];
        }
        h[3][3] = 1.0;
        h
    }

    fn point_from_spatial(p: &[f64; 3]) -> Option<V3> {
        Some(Vector(*p))
    }

    fn point_to_spatial(p: &V3) -> [f64; 3] {
        p.0
    }
}
