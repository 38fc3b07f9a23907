//! Every closed form is compared with an independent definition: power series of the adjoint
//! representation, or finite differences.

use super::{LieGroup, SE2, SE3, Stumpff};
use crate::linalg::{Matrix, Vector};
use proptest::prelude::*;

fn close<const R: usize, const C: usize>(a: &Matrix<R, C>, b: &Matrix<R, C>, tolerance: f64) {
    let size = b.0.iter().flatten().fold(1.0, |m: f64, x| m.max(x.abs()));
    for (x, y) in a.0.iter().flatten().zip(b.0.iter().flatten()) {
        assert!((x - y).abs() <= tolerance * size, "{a:?}\n{b:?}");
    }
}

/// Σ_k (sign)^k ad^k / (k + offset)!
fn series<G: LieGroup<D, P>, const D: usize, const P: usize>(
    omega: &Vector<D>,
    sign: f64,
    offset: usize,
) -> Matrix<D, D> {
    let ad = G::ad(omega) * sign;
    let mut term = Matrix::<D, D>::identity();
    for k in 1..=offset {
        term = term * (1.0 / k as f64);
    }
    let mut sum = term;
    for k in 1..60 {
        term = (term * ad) * (1.0 / (k + offset) as f64);
        sum += term;
    }
    sum
}

fn check<G: LieGroup<D, P>, const D: usize, const P: usize>(omega: [f64; D], w: [f64; D], d: [f64; D]) {
    let (omega, w, d) = (Vector(omega), Vector(w), Vector(d));
    let c = Stumpff::new(G::angle_squared(&omega));
    let g = G::exp(&omega, &c);
    close(&g.adjoint(), &series::<G, D, P>(&omega, 1.0, 0), 1e-12);
    close(&G::tangent(&omega, &c), &series::<G, D, P>(&omega, -1.0, 1), 1e-12);
    close(&g.compose(&g.inverse()).adjoint(), &Matrix::identity(), 1e-13);

    // w·(T(Ω + hδ)δ) differentiated in h is δᵀ Q δ.
    let h = 1e-5;
    let power = |s: f64| {
        let o = omega + d * s;
        w.dot(&(G::tangent(&o, &Stumpff::new(G::angle_squared(&o))) * d))
    };
    let difference = (power(h) - power(-h)) / (2.0 * h);
    let exact = d.dot(&(G::tangent_curvature(&omega, &w, &c) * d));
    assert!((difference - exact).abs() < 1e-7 * (1.0 + exact.abs()), "{difference} {exact}");

    let bracket = G::ad(&omega) * d;
    assert!((w.dot(&bracket) - omega.dot(&(G::bracket_form(&w) * d))).abs() < 1e-13 * (1.0 + w.norm()));

    // Products without what vanishes.
    let column = |v: &Vector<D>| Matrix::<D, 1>(v.0.map(|x| [x]));
    close(&column(&G::bracket(&omega, &d)), &column(&bracket), 1e-14);
    for operator in [g.adjoint(), G::tangent(&omega, &c), G::ad(&omega)] {
        close(&G::operate(&operator, &column(&d)), &column(&(operator * d)), 1e-14);
        close(&column(&G::operate_dual(&operator, &w)), &column(&operator.transpose_times(&w)), 1e-14);
    }
    for form in [G::bracket_form(&w), G::bracket_form(&w).transpose(), G::tangent_curvature(&omega, &w, &c)] {
        close(&G::apply_form(&form, &column(&d)), &column(&(form * d)), 1e-14);
    }

    // Motion of a point: p(s) = exp(sδ) p.
    let mut p = Vector::<P>::ZERO;
    let mut f = Vector::<P>::ZERO;
    for i in 0..P {
        p[i] = omega[i];
        f[i] = w[i];
    }
    let along = |s: f64| f.dot(&G::exponential(&(d * s)).act(&p));
    let velocity = f.dot(&(G::point_jacobian(&p) * d));
    let curvature = d.dot(&(G::point_curvature(&p, &f) * d));
    let h = 1e-4;
    assert!(((along(h) - along(-h)) / (2.0 * h) - velocity).abs() < 1e-6 * (1.0 + velocity.abs()));
    let second = (along(h) + along(-h) - 2.0 * along(0.0)) / (h * h);
    assert!((second - curvature).abs() < 1e-5 * (1.0 + curvature.abs()), "{second} {curvature}");
}

proptest! {
    #[test]
    fn planar_forms(o in prop::array::uniform3(-3.0..3.0), w in prop::array::uniform3(-2.0..2.0), d in prop::array::uniform3(-1.0..1.0)) {
        check::<SE2, 3, 2>(o, w, d);
        check::<SE2, 3, 2>(o.map(|x| x * 0.01), w, d);
    }

    #[test]
    fn spatial_forms(o in prop::array::uniform6(-2.0..2.0), w in prop::array::uniform6(-2.0..2.0), d in prop::array::uniform6(-1.0..1.0)) {
        check::<SE3, 6, 3>(o, w, d);
        check::<SE3, 6, 3>(o.map(|x| x * 0.01), w, d);
    }

    #[test]
    fn planar_is_spatial_restricted(o in prop::array::uniform3(-3.0..3.0), w in prop::array::uniform3(-2.0..2.0)) {
        let lift = |t: [f64; 3]| Vector([0.0, t[0], 0.0, t[1], 0.0, t[2]]);
        let c = Stumpff::new(o[0] * o[0]);
        let planar = SE2::exp(&Vector(o), &c).to_homogeneous();
        let spatial = SE3::exp(&lift(o), &c).to_homogeneous();
        for (a, b) in planar.iter().flatten().zip(spatial.iter().flatten()) {
            prop_assert!((a - b).abs() < 1e-14);
        }
        let q2 = SE2::tangent_curvature(&Vector(o), &Vector(w), &c);
        let q3 = SE3::tangent_curvature(&lift(o), &lift(w), &c);
        for (i, a) in [1, 3, 5].into_iter().enumerate() {
            for (j, b) in [1, 3, 5].into_iter().enumerate() {
                prop_assert!((q2.0[i][j] - q3.0[a][b]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn stumpff_recurrence_holds_across_branches(x in 0.0..40.0f64) {
        let s = Stumpff::new(x);
        let theta = x.sqrt();
        prop_assert!((s.c[0] - theta.cos()).abs() < 1e-14);
        prop_assert!((s.c[1] * theta - theta.sin()).abs() < 1e-14);
        for k in 2..8 {
            // Direct series in higher precision would be the same numbers: use the integral form
            // c_k = ∫₀¹ (1−t)^{k−1}/(k−1)! · cos(θ t)-kind kernels, by Gauss–Legendre quadrature.
            let rule = crate::strain::gauss_legendre(24);
            let factorial: f64 = (1..k).map(|m| m as f64).product();
            let integral: f64 = rule.iter().map(|(t, w)| w * (1.0 - t).powi(k as i32 - 1) / factorial * (theta * t).cos()).sum();
            prop_assert!((s.c[k] - integral).abs() < 1e-13, "k = {k}: {} {integral}", s.c[k]);
        }
    }
}
