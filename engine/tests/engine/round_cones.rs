//! Contact with round cones, against closed forms and against what must not matter.

use crate::systems::{body, empty, joint};
use crate::trees::solids;
use flexor_engine::Data;
use flexor_engine::lie::{SE2, SE3};
use flexor_engine::model::*;
use proptest::prelude::*;

const STIFFNESS: f64 = 500.0;

fn link(length: f64, radius_base: f64, radius_tip: f64) -> ShapeDescription {
    ShapeDescription::Link(LinkDescription { length, radius_base, radius_tip, density: 0.0 })
}

fn group(name: &str, spheres: Vec<(&str, f64)>) -> SphereGroupDescription {
    let sphere =
        |(body, f): (&str, f64)| SphereDescription { body: body.into(), station: Station::Fraction(f) };
    SphereGroupDescription { name: name.into(), spheres: spheres.into_iter().map(sphere).collect() }
}

/// A free ball of radius 1 cm before the group "limb", made of these round cones.
fn ball_before(planar: bool, limb: Vec<(&str, f64)>, cones: Vec<([usize; 2], bool)>) -> Description {
    let mut d = empty(planar);
    d.bodies.push(body("ball", None, [0.0; 3], joint(JointKind::Free), link(0.01, 0.01, 0.01)));
    d.spheres.push(group("ball", vec![("ball", 0.0)]));
    d.spheres.push(group("limb", limb));
    let cone = |(ends, joined)| RoundConeDescription { ends, joined };
    d.contacts.push(ContactDescription {
        name: "touch".into(),
        first: "ball".into(),
        second: "limb".into(),
        stiffness: STIFFNESS,
        skip: 0,
        tip_spheres: vec![],
        cones: cones.into_iter().map(cone).collect(),
        weights: vec![],
        per_length: false,
    });
    d
}

/// Energy and residual with the ball's centre at (x, z) of a planar system.
fn at(description: &Description, x: f64, z: f64) -> (f64, Vec<f64>, usize) {
    let model = Model::<SE2, 3, 2>::new(description).unwrap();
    let mut q = vec![0.0; model.dof()];
    (q[1], q[2]) = (x, z);
    let mut data = Data::new(&model);
    data.evaluate(&model, &q, &[]);
    (data.energy(), data.residual().to_vec(), data.contact_forces(&model).len())
}

fn one_link(radii: [f64; 2]) -> Description {
    let mut d = ball_before(true, vec![("limb", 0.0), ("limb", 1.0)], vec![([0, 1], false)]);
    d.bodies.push(body("limb", None, [0.0; 3], joint(JointKind::Fixed), link(0.05, radii[0], radii[1])));
    d
}

/// The side of a cone of half-angle α is a plane seen from a ball: d = R + r_a − z cos α − x sin α.
#[test]
fn on_the_side_the_overlap_is_linear() {
    let d = one_link([0.02, 0.012]);
    let (sine, cosine) = (0.008 / 0.05, (1.0f64 - (0.008 / 0.05f64).powi(2)).sqrt());
    for x in [0.01, 0.02, 0.03, 0.045] {
        let overlap = 0.1 * x;
        let z = (0.01 + 0.02 - overlap - x * sine) / cosine;
        let (energy, residual, touching) = at(&d, x, z);
        assert_eq!(touching, 1);
        assert!((energy - 0.5 * STIFFNESS * overlap * overlap).abs() < 1e-15);
        assert!((residual[1] + STIFFNESS * overlap * sine).abs() < 1e-12);
        assert!((residual[2] + STIFFNESS * overlap * cosine).abs() < 1e-12);
    }
}

/// Two ends at one place, or one that holds the other, are a sphere.
#[test]
fn without_a_side_it_is_a_sphere() {
    let mut sphere = one_link([0.02, 0.012]);
    sphere.contacts[0].cones.clear();
    sphere.spheres[1].spheres.truncate(1);
    let mut same = one_link([0.02, 0.012]);
    same.contacts[0].cones[0].ends = [0, 0];
    let mut inside = one_link([0.02, 0.012]);
    inside.bodies[1].shape = link(0.005, 0.02, 0.012);
    for (x, z) in [(0.001, 0.025), (-0.01, 0.02), (0.02, -0.015), (0.0, 0.0), (0.04, 0.0)] {
        let expected = at(&sphere, x, z);
        for other in [&same, &inside] {
            let (energy, residual, touching) = at(other, x, z);
            assert_eq!(touching, expected.2);
            assert!((energy - expected.0).abs() < 1e-12, "{x} {z}: {energy} {}", expected.0);
            for (a, b) in residual.iter().zip(&expected.1) {
                assert!((a - b).abs() < 1e-9);
            }
        }
    }
}

/// A limb of two links, bent by `angle` at the joint between them.
fn two_links(angle: f64, radii: [f64; 3]) -> Description {
    let ends = vec![("limb", 0.0), ("limb", 1.0), ("end", 0.0), ("end", 1.0)];
    let mut d = ball_before(true, ends, vec![([0, 1], false), ([2, 3], true)]);
    d.bodies.push(body("limb", None, [0.0; 3], joint(JointKind::Fixed), link(0.03, radii[0], radii[1])));
    d.bodies.push(body(
        "end",
        Some("limb"),
        [0.0; 3],
        joint(JointKind::Fixed),
        link(0.02, radii[1], radii[2]),
    ));
    d.bodies[2].placement.rotation = [0.0, angle, 0.0];
    d
}

/// A straight link that is cut in two is felt as before, everywhere along it.
#[test]
fn a_cut_is_not_felt() {
    let whole = one_link([0.02, 0.015]);
    let cut = two_links(0.0, [0.02, 0.017, 0.015]);
    for i in 0..=100 {
        let x = -0.02 + 0.09 * f64::from(i) / 100.0;
        let (one, two) = (at(&whole, x, 0.024), at(&cut, x, 0.024));
        assert!((one.0 - two.0).abs() < 1e-14, "{x}: {} {}", one.0, two.0);
        assert_eq!(one.2, two.2, "{x}");
        for (a, b) in one.1.iter().zip(&two.1) {
            assert!((a - b).abs() < 1e-12, "{x}: {a} {b}");
        }
    }
}

/// The ball goes round the outside of a bent joint and through the hollow inside it; the force on it
/// never jumps, and outside it is that of one sphere.
#[test]
fn the_force_along_a_bent_chain_is_continuous() {
    for (angle, outside) in [(0.6, true), (-0.6, false)] {
        let bent = two_links(angle, [0.02, 0.017, 0.015]);
        let mut before: Option<Vec<f64>> = None;
        let steps = 4_000;
        for i in 0..=steps {
            let turn = 0.9 * angle * f64::from(i) / f64::from(steps);
            let x = 0.03 + 0.03 * (-0.02 / 0.03 + turn / angle).sin();
            let z = if outside { 0.025 - 0.006 * turn } else { 0.025 };
            let (energy, residual, touching) = at(&bent, x, z);
            assert!(energy >= 0.0);
            assert!(!outside || touching <= 1);
            if let Some(before) = before {
                let jump = before.iter().zip(&residual).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(jump < 3.0 * STIFFNESS * 0.04 / f64::from(steps), "{angle} {x}: {jump}");
            }
            before = Some(residual);
        }
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let refused = |change: fn(&mut ContactDescription)| {
        let mut d = one_link([0.02, 0.015]);
        change(&mut d.contacts[0]);
        Model::<SE2, 3, 2>::new(&d).unwrap_err().to_string()
    };
    let found = refused(|c| c.cones[0].ends = [0, 2]);
    assert!(found.contains("contacts.touch.cones") && found.contains("found index 2"), "{found}");
    let found = refused(|c| c.cones[0].joined = true);
    assert!(found.contains("none before it"), "{found}");
    let found = refused(|c| c.weights = vec![1.0, 2.0]);
    assert!(found.contains("contacts.touch.weights"), "{found}");
    let found = refused(|c| c.weights = vec![-1.0]);
    assert!(found.contains("contacts.touch.weights"), "{found}");
    let found = refused(|c| {
        c.cones.clear();
        c.per_length = true;
    });
    assert!(found.contains("only contact with round cones"), "{found}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Each force acts along the line from the middle of the overlap to the sphere's centre.
    #[test]
    fn forces_are_where_the_overlap_is(state in prop::collection::vec(-0.15..0.15f64, 41)) {
        let model = Model::<SE3, 6, 3>::new(&solids()).unwrap();
        let q: Vec<f64> = (0..model.dof()).map(|i| state[i % state.len()]).collect();
        let mut data = Data::new(&model);
        data.evaluate(&model, &q, &[]);
        let touches = data.contact_forces(&model);
        prop_assume!(touches.iter().any(|t| t.second.is_some_and(|[a, b]| a != b)));
        let spheres: Vec<_> = data.spheres(&model).collect();
        for t in &touches {
            let (centre, radius) = spheres[t.first];
            let arm = centre - t.point;
            prop_assert!(t.depth > 0.0 && t.force.norm() > 0.0);
            prop_assert!((arm.norm() - (radius - 0.5 * t.depth).abs()).abs() < 1e-12);
            let parallel = arm.dot(&t.force).abs() - arm.norm() * t.force.norm();
            prop_assert!(parallel.abs() < 1e-9, "{parallel}");
        }
    }
}
