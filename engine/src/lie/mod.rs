//! The Lie groups in which bodies move: SE(2) for planar systems, SE(3) for spatial ones.
//!
//! Conventions: twists and wrenches are ordered [angular; linear]; the planar group lives in the
//! x–z plane with positive rotation about +y. With `Ω` in the algebra, `T(Ω)` is the body tangent
//! operator, `exp(Ω)⁻¹ d exp(Ω) = T(Ω) dΩ`.

mod se2;
mod se3;
mod stumpff;

pub use se2::SE2;
pub use se3::SE3;
pub use stumpff::Stumpff;

use crate::linalg::{Matrix, Vector};
use crate::strain::Mode;

/// A matrix Lie group of rigid motions with twists in `R^D` and points in `R^P`.
///
/// The world-frame ("spatial") forms below expand a function of the perturbed pose `exp(ζ) g` to
/// second order in the spatial twist `ζ`; in that frame the twists of a kinematic chain simply add.
pub trait LieGroup<const D: usize, const P: usize>:
    PartialEq + Copy + Send + Sync + std::fmt::Debug + 'static
{
    /// The neutral element.
    const IDENTITY: Self;
    /// The strain mode behind each twist component.
    const AXES: [Mode; D];

    /// Squared rotation angle of `Ω`, the argument of its [`Stumpff`] functions.
    fn angle_squared(omega: &Vector<D>) -> f64;
    /// `exp(Ω)`, given the Stumpff functions of `Ω`.
    fn exp(omega: &Vector<D>, c: &Stumpff) -> Self;
    /// `T(Ω)`, the body tangent operator of the exponential.
    fn tangent(omega: &Vector<D>, c: &Stumpff) -> Matrix<D, D>;
    /// The symmetric form `Q` with `exp(Ω)⁻¹ exp(Ω + δ) = exp(T δ + ½ s₂(δ) + …)`, `w·s₂(δ) = δᵀ Q δ`.
    fn tangent_curvature(omega: &Vector<D>, w: &Vector<D>, c: &Stumpff) -> Matrix<D, D>;

    /// `self · right`.
    fn compose(&self, right: &Self) -> Self;
    /// The inverse motion.
    fn inverse(&self) -> Self;
    /// `Ad_g`: body twists to world twists.
    fn adjoint(&self) -> Matrix<D, D>;
    /// `ad_a`, with `ad_a b = [a, b]`.
    fn ad(a: &Vector<D>) -> Matrix<D, D>;
    /// The antisymmetric form `M(w)` with `aᵀ M b = w·[a, b]`.
    fn bracket_form(w: &Vector<D>) -> Matrix<D, D>;

    /// Position of the frame's origin.
    fn position(&self) -> Vector<P>;
    /// World position of a point fixed in the frame.
    fn act(&self, point: &Vector<P>) -> Vector<P>;
    /// World direction of a direction fixed in the frame.
    fn rotate(&self, direction: &Vector<P>) -> Vector<P>;
    /// World velocity of the world point `p` under a world twist, as a matrix.
    fn point_jacobian(p: &Vector<P>) -> Matrix<P, D>;
    /// The symmetric form `C` of the second-order motion of `p`: `f·δ²p = ½ ζᵀ C ζ`.
    fn point_curvature(p: &Vector<P>, f: &Vector<P>) -> Matrix<D, D>;

    /// From a translation and a rotation vector in space; `None` if it is not in the group.
    fn from_spatial(translation: &[f64; 3], rotation: &[f64; 3]) -> Option<Self>;
    /// The 4 × 4 homogeneous matrix, row-major.
    fn to_homogeneous(&self) -> [[f64; 4]; 4];
    /// A point or direction in space as one of this group's; `None` when it leaves the plane.
    fn point_from_spatial(p: &[f64; 3]) -> Option<Vector<P>>;
    /// A point of this group in space.
    fn point_to_spatial(p: &Vector<P>) -> [f64; 3];

    /// `[a, b]`.
    #[inline(always)]
    fn bracket(a: &Vector<D>, b: &Vector<D>) -> Vector<D> {
        Self::ad(a) * *b
    }
    /// The product of an operator that leaves translations translations, as `Ad`, `ad` and `T`, with columns.
    #[inline(always)]
    fn operate<const C: usize>(operator: &Matrix<D, D>, columns: &Matrix<D, C>) -> Matrix<D, C> {
        *operator * *columns
    }
    /// The transpose of such an operator times a wrench.
    #[inline(always)]
    fn operate_dual(operator: &Matrix<D, D>, wrench: &Vector<D>) -> Vector<D> {
        operator.transpose_times(wrench)
    }
    /// The product of a form that vanishes for two translations, as `M(w)` and the curvature of the exponential,
    /// with columns.
    #[inline(always)]
    fn apply_form<const C: usize>(form: &Matrix<D, D>, columns: &Matrix<D, C>) -> Matrix<D, C> {
        *form * *columns
    }
    /// The twist component that `mode` drives, if the group has it.
    fn axis(mode: Mode) -> Option<usize> {
        Self::AXES.iter().position(|m| *m == mode)
    }
    /// `exp(Ω)` on its own.
    fn exponential(omega: &Vector<D>) -> Self {
        Self::exp(omega, &Stumpff::new(Self::angle_squared(omega)))
    }
}

#[cfg(test)]
mod tests;
