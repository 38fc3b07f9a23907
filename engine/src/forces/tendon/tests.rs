//! Paths around wraps against a search over the places where they touch, and against differences.

use super::wrap::{Around, Ends};
use crate::linalg::Vector;
use proptest::prelude::*;

const R: f64 = 0.02;

fn ends<const P: usize>(ends: [[f64; P]; 2], axis: Option<[f64; P]>, side: Option<[f64; P]>) -> Ends<P> {
    let axis = axis.map(|axis| Vector(axis) * (1.0 / Vector(axis).norm()));
    Ends { ends: ends.map(Vector), axis, side: side.map(Vector), radius: R }
}

fn length<const P: usize>(e: &Ends<P>) -> f64 {
    e.around().map_or_else(|| (e.ends[0] - e.ends[1]).norm(), |around| around.length)
}

/// Gradient, Hessian and derivatives by the radius against fourth-order differences of the length.
fn check_differences<const P: usize>(e: &Ends<P>) -> Result<(), TestCaseError> {
    let Some(around) = e.around() else { return Ok(()) };
    let curvature = around.curvature();
    // The tangent to an end near the surface has the length of a square root, whose differences need steps that
    // are short beside the distance.
    let across = |x: Vector<P>| e.axis.map_or(x, |axis| x - axis * axis.dot(&x)).norm();
    let off = e.ends.map(|x| across(x) - R).into_iter().fold(f64::INFINITY, f64::min);
    let h = (0.005 * off).min(1e-6);
    // Directions to an end that close to the surface are rounded more.
    let blurred = 4.0 * f64::EPSILON * R / (off * h);
    let rounded = 1e-8f64.max(4.0 * f64::EPSILON * around.length / h);
    // Where the path lets go, or changes to the other side, it has no derivative.
    let same = |there: &Around<P>| there.way == around.way;
    let stencil = [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)];
    let scale =
        around.curvature().hessian.iter().flat_map(|m| m.0).flatten().fold(1.0, |m: f64, x| m.max(x.abs()));
    for end in 0..2 {
        for k in 0..P {
            let mut slope = 0.0;
            let mut column = [Vector::<P>::ZERO; 2];
            for (step, weight) in stencil {
                let mut moved = *e;
                moved.ends[end][k] += step * h;
                let Some(there) = moved.around().filter(same) else { return Ok(()) };
                slope += weight * there.length / (12.0 * h);
                for i in 0..2 {
                    column[i] += there.gradient[i] * (weight / (12.0 * h));
                }
            }
            prop_assert!((slope - around.gradient[end][k]).abs() < rounded, "{slope} {:?}", around.gradient);
            for i in 0..2 {
                for l in 0..P {
                    let exact = match (i, end) {
                        (0, 0) => curvature.hessian[0].0[l][k],
                        (1, 1) => curvature.hessian[2].0[l][k],
                        (0, _) => curvature.hessian[1].0[l][k],
                        _ => curvature.hessian[1].0[k][l],
                    };
                    let error = (column[i][l] - exact).abs();
                    prop_assert!(error < 1e-6 * scale + blurred, "{i}{end} {l}{k}: {} {exact}", column[i][l]);
                }
            }
        }
    }
    let (mut slope, mut turned) = (0.0, [Vector::<P>::ZERO; 2]);
    for (step, weight) in stencil {
        let moved = Ends { radius: R + step * h, ..*e };
        let Some(there) = moved.around().filter(same) else { return Ok(()) };
        slope += weight * there.length / (12.0 * h);
        (0..2).for_each(|i| turned[i] += there.gradient[i] * (weight / (12.0 * h)));
    }
    prop_assert!((slope - around.by_radius).abs() < rounded, "{slope} {}", around.by_radius);
    for i in 0..2 {
        let error = (turned[i] - curvature.gradient_by_radius[i]).norm();
        prop_assert!(error < 1e-6 * scale + blurred, "{:?} {:?}", turned, curvature.gradient_by_radius);
    }
    Ok(())
}

/// Length of the points traced.
fn traced<const P: usize>(e: &Ends<P>, around: &Around<P>) -> f64 {
    let (mut last, mut sum) = (e.ends[0], 0.0);
    around.trace(&e.ends[0], |place| {
        sum += (place - last).norm();
        last = place;
    });
    sum + (e.ends[1] - last).norm()
}

/// The least of a smooth function of two numbers around a start, by shrinking coordinate steps.
fn least(f: impl Fn(f64, f64) -> f64, mut at: [f64; 2]) -> f64 {
    let mut step = 0.3;
    let mut best = f(at[0], at[1]);
    while step > 1e-9 {
        let moves = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step], [step, step], [-step, -step]];
        let found = moves.map(|m| [at[0] + m[0], at[1] + m[1]]).map(|x| (f(x[0], x[1]), x));
        let better = found.into_iter().fold((best, at), |a, b| if b.0 < a.0 { b } else { a });
        if better.0 < best {
            (best, at) = better;
        } else {
            step *= 0.5;
        }
    }
    best
}

/// Whether the straight way from a place to a point of the surface in this direction is free.
fn sees<const P: usize>(place: [f64; P], direction: Vector<P>) -> bool {
    Vector(place).dot(&direction) >= R
}

fn place() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-0.08..0.08f64)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn derivatives_on_spheres(a in place(), b in place(), side in place(), with: bool) {
        check_differences(&ends([a, b], None, with.then_some(side)))?;
    }

    #[test]
    fn derivatives_on_cylinders(a in place(), b in place(), side in place(), axis in place(), with: bool) {
        check_differences(&ends([a, b], Some(axis), with.then_some(side)))?;
    }

    #[test]
    fn derivatives_in_the_plane(a in place(), b in place(), side in place(), with: bool) {
        let flat = |x: [f64; 3]| [x[0], x[1]];
        check_differences(&ends([flat(a), flat(b)], None, with.then_some(flat(side))))?;
    }

    #[test]
    fn derivatives_inside(a in place(), b in place(), side in prop::array::uniform3(-0.01..0.01f64), axis in place()) {
        check_differences(&ends([a, b], None, Some(side)))?;
        check_differences(&ends([a, b], Some(axis), Some(side)))?;
        check_differences(&ends([[a[0], a[1]], [b[0], b[1]]], None, Some([side[0], side[1]])))?;
    }

    /// A string around a cylinder is no longer than any other with the same turns.
    #[test]
    fn no_string_around_a_cylinder_is_shorter(a in place(), b in place()) {
        let e = ends([a, b], Some([0.0, 0.0, 1.0]), None);
        let Some(around) = e.around() else { return Ok(()) };
        let on = |angle: f64, z: f64| Vector([R * angle.cos(), R * angle.sin(), z]);
        let angles = [a, b].map(|x| x[1].atan2(x[0]));
        let turn = (angles[1] - angles[0] + 3.0 * std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        // The heights are those of a straight line on the unrolled surface, or else it is longer yet.
        let string = |u: f64, v: f64| {
            let [first, last] = [angles[0] + u, angles[0] + turn - v];
            let [p, q] = [first, last].map(|angle| Vector([angle.cos(), angle.sin(), 0.0]));
            if !sees(a, p) || !sees(b, q) {
                return f64::INFINITY;
            }
            let arc = R * (last - first).abs();
            let flat = |x: [f64; 3], t: Vector<3>| (x[0] - t[0]).hypot(x[1] - t[1]);
            let before = flat(a, on(first, 0.0));
            let whole = before + arc + flat(b, on(last, 0.0));
            let height = |s: f64| a[2] + (b[2] - a[2]) * s / whole;
            let [p, q] = [on(first, height(before)), on(last, height(before + arc))];
            (Vector(a) - p).norm() + arc.hypot(q[2] - p[2]) + (Vector(b) - q).norm()
        };
        let sign = turn.signum();
        let least = least(|u, v| string(sign * u, sign * v), [1e-3; 2]);
        prop_assert!((least - around.length).abs() < 1e-9, "{least} {}", around.length);
    }

    /// Nor is one around a sphere, between any two places on it.
    #[test]
    fn no_string_around_a_sphere_is_shorter(a in place(), b in place(), out in -0.3..0.3f64) {
        let e = ends([a, b], None, None);
        let Some(around) = e.around() else { return Ok(()) };
        let [n0, n1] = [a, b].map(|x| Vector(x) * (1.0 / Vector(x).norm()));
        let away = n1 - n0 * n0.dot(&n1);
        let t = away * (1.0 / away.norm());
        let normal = Vector([n0[1] * t[2] - n0[2] * t[1], n0[2] * t[0] - n0[0] * t[2], n0[0] * t[1] - n0[1] * t[0]]);
        let angle = away.norm().atan2(n0.dot(&n1));
        let on = |along: f64, out: f64| (n0 * along.cos() + t * along.sin()) * out.cos() + normal * out.sin();
        let string = |u: f64, v: f64, out: f64| {
            let [p, q] = [on(u, out), on(angle - v, out)];
            if !sees(a, p) || !sees(b, q) {
                return f64::INFINITY;
            }
            let arc = (p - q).norm() * 0.5;
            (Vector(a) - p * R).norm() + 2.0 * R * arc.asin() + (Vector(b) - q * R).norm()
        };
        let flat = least(|u, v| string(u, v, 0.0), [1e-3; 2]);
        prop_assert!((flat - around.length).abs() < 1e-9, "{flat} {}", around.length);
        let bowed = least(|u, v| string(u, v, out), [1e-3; 2]);
        prop_assert!(bowed > around.length - 1e-12);
    }

    /// What touches from inside is the shortest way over the rim.
    #[test]
    fn inside_it_is_the_shortest_way_over_the_rim(a in place(), b in place()) {
        let e = ends([[a[0], a[1]], [b[0], b[1]]], None, Some([0.0, 0.0]));
        let Some(around) = e.around() else { return Ok(()) };
        let over = |angle: f64| {
            let t = Vector([R * angle.cos(), R * angle.sin()]);
            (e.ends[0] - t).norm() + (e.ends[1] - t).norm()
        };
        let coarse = (0..720).map(|k| f64::from(k) * 0.5f64.to_radians());
        let start = coarse.fold(0.0, |best, x| if over(x) < over(best) { x } else { best });
        let least = least(|u, _| over(u), [start, 0.0]);
        prop_assert!((least - around.length).abs() < 1e-12, "{least} {}", around.length);
    }

    #[test]
    fn drawn_paths_are_as_long(a in place(), b in place(), side in place(), axis in place()) {
        for e in [ends([a, b], None, Some(side)), ends([a, b], Some(axis), None), ends([a, b], Some(axis), Some(side))] {
            let Some(around) = e.around() else { continue };
            let drawn = traced(&e, &around);
            prop_assert!(drawn <= around.length * (1.0 + 1e-12) && drawn > around.length * (1.0 - 1e-3), "{drawn} {}", around.length);
        }
    }
}

/// A leg that comes to touch: its length and its gradient are continuous.
#[test]
fn touching_is_smooth() {
    for axis in [None, Some([0.0, 1.0, 0.0])] {
        let at = |z: f64| ends([[-0.05, 0.0, z], [0.06, 0.01, z]], axis, Some([0.0, 0.0, 0.05]));
        // A sphere is passed at the distance of the line, which is a little oblique, from its centre.
        let touching = match axis {
            Some(_) => R,
            None => (R * R - (0.05 * 0.01f64 / 0.11f64.hypot(0.01)).powi(2)).sqrt(),
        };
        let [below, above] = [touching - 1e-9, touching + 1e-9].map(at);
        assert!(above.around().is_none());
        let around = below.around().unwrap();
        assert!((around.length - length(&above)).abs() < 1e-11);
        let along = above.ends[0] - above.ends[1];
        let along = along * (1.0 / along.norm());
        assert!((around.gradient[0] - along).norm() < 1e-6, "{:?} {along:?}", around.gradient);
        assert!((around.gradient[1] + along).norm() < 1e-6);
    }
}

/// Over a pulley of radius R, half a turn and two straight parts.
#[test]
fn half_a_turn() {
    let e = ends([[R, -0.05], [-R, -0.07]], None, Some([0.0, 0.1]));
    let expected = 0.12 + std::f64::consts::PI * R;
    assert!((e.around().unwrap().length - expected).abs() < 1e-15);
    // With both ends on one side, the long way around.
    let e = ends([[0.05, 0.001], [0.05, -0.001]], None, Some([-0.1, 0.0]));
    let around = e.around().unwrap().length;
    assert!(around > std::f64::consts::PI * R + 2.0 * 0.04, "{around}");
}
