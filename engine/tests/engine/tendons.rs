//! Tendons: derivatives on random states, closed forms and bad input.

use crate::systems::differences::derivatives;
use crate::systems::{body, empty, joint, rod, strain};
use flexor_engine::Data;
use flexor_engine::lie::{LieGroup, SE2, SE3};
use flexor_engine::model::*;
use flexor_engine::strain::{BasisKind, Mode};

const THELEN: MuscleCurve = MuscleCurve::Thelen { width: 0.45, passive_shape: 5.0, passive_strain: 0.6 };

fn on(body: &str, station: Station, offset: [f64; 3]) -> AttachmentDescription {
    AttachmentDescription::Body { body: body.into(), station, offset, surface: [0.0; 3] }
}

fn tip(body: &str, offset: [f64; 3]) -> StageDescription {
    StageDescription::Point(on(body, Station::Fraction(0.7), offset))
}

fn around(name: &str, side: Option<AttachmentDescription>) -> StageDescription {
    StageDescription::Wrap { name: name.into(), side }
}

/// A rod, a link at its tip and a free link, with three tendons over wraps on each and in the world.
fn laced(planar: bool) -> Description {
    let mut d = empty(planar);
    let modes: &[Mode] = if planar { &[Mode::BendY, Mode::ExtendX] } else { &Mode::ALL };
    let modes = modes.iter().map(|m| strain(*m, BasisKind::NodalLinear)).collect();
    let arm = rod(0.2, [0.03, 0.02], modes, 2, 2);
    d.bodies.push(body("arm", None, [0.0; 3], joint(JointKind::Fixed), ShapeDescription::Rod(arm)));
    let link = |length| {
        let shape = LinkDescription { length, radius_base: 0.02, radius_tip: 0.015, density: 0.0 };
        ShapeDescription::Link(shape)
    };
    let mut hinge = joint(JointKind::Revolute);
    hinge.stiffness = vec![0.5];
    d.bodies.push(body("hand", Some("arm"), [0.0; 3], hinge.clone(), link(0.1)));
    let mut free = joint(JointKind::Free);
    free.stiffness = vec![1.0; if planar { 3 } else { 6 }];
    d.bodies.push(body("cup", None, [0.35, 0.0, 0.05], free, link(0.05)));
    let y = |y: f64| if planar { 0.0 } else { y };
    let wrap = |name: &str, at, axis, radius| WrapDescription { name: name.into(), at, axis, radius };
    let across = Some([0.0, 1.0, 0.0]);
    let oblique = if planar { across } else { Some([0.0, 0.96, 0.28]) };
    d.wraps = vec![
        wrap("knuckle", on("hand", Station::Fraction(0.0), [0.0, y(0.004), 0.0]), oblique, 0.02),
        wrap("ball", on("cup", Station::Fraction(0.3), [0.0, y(-0.004), 0.002]), None, 0.025),
        wrap("post", AttachmentDescription::World { world: [0.15, y(0.01), 0.06] }, across, 0.012),
        wrap("ring", on("hand", Station::Fraction(0.5), [0.0, y(0.002), -0.03]), None, 0.01),
    ];
    let world = |world| StageDescription::Point(AttachmentDescription::World { world });
    let rod_point = |k, offset| StageDescription::Point(on("arm", Station::Point(k), offset));
    let muscle = TensionDescription::Muscle {
        max_force: 30.0,
        optimal_length: 0.25,
        tendon_slack_length: 0.25,
        curve: THELEN,
    };
    let spring = TensionDescription::Spring { stiffness: 900.0, slack_length: 0.11, toe: 0.2 };
    let tendon =
        |name: &str, path, tension| TendonDescription { name: name.into(), path, tension, friction: None };
    let above = on("hand", Station::Fraction(0.0), [0.0, 0.0, 0.1]);
    d.tendons = vec![
        tendon(
            "flexor",
            vec![
                rod_point(2, [0.0, y(0.005), 0.015]),
                around("knuckle", Some(above)),
                tip("hand", [0.0, y(-0.003), -0.01]),
                around("ball", None),
                tip("cup", [0.06, y(0.01), 0.003]),
                StageDescription::Branch(2.0),
                tip("hand", [0.0, y(-0.003), -0.01]),
                world([0.3, y(0.1), 0.2]),
            ],
            muscle,
        ),
        tendon(
            "string",
            vec![
                world([0.05, y(0.02), 0.075]),
                around("post", Some(AttachmentDescription::World { world: [0.15, 0.0, 0.09] })),
                rod_point(4, [0.0, y(-0.01), 0.05]),
                around("ring", Some(on("hand", Station::Fraction(0.5), [0.0, 0.0, -0.03]))),
                tip("hand", [0.05, y(0.01), 0.03]),
            ],
            spring,
        ),
        tendon(
            "cable",
            vec![world([0.0, y(0.1), 0.1]), tip("cup", [0.0, y(0.02), 0.0])],
            TensionDescription::Cable {},
        ),
    ];
    d
}

fn differences<G: LieGroup<D, P>, const D: usize, const P: usize>(sizes: &[f64]) {
    let model = Model::<G, D, P>::new(&laced(D == 3)).unwrap();
    let mut data = Data::new(&model);
    for size in sizes {
        let q: Vec<f64> = (0..model.dof()).map(|i| size * (1.3 * i as f64 + 1.0).sin()).collect();
        data.evaluate(&model, &q, &[0.7; 2]);
        // A path around anything has more places than points.
        let points = [7, 5, 2];
        for (branches, points) in data.tendon_paths(&model).iter().zip(points).take(2) {
            assert!(branches.iter().map(Vec::len).sum::<usize>() > points + 1, "not around anything");
        }
        assert!(
            data.tendon_tensions(&model, &[0.7; 2]).iter().all(|t| (0.0..300.0).contains(t)),
            "{:?}",
            data.tendon_tensions(&model, &[0.7; 2])
        );
        let checked = derivatives::<G, D, P>(&laced(D == 3), *size, |_| true);
        assert!(checked > 50, "{checked}");
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    differences::<SE2, 3, 2>(&[0.0, 0.04, -0.05]);
    differences::<SE3, 6, 3>(&[0.0, 0.04, -0.05]);
}

/// The moment arm over a round joint is its radius, whatever the angle, as long as the tendon touches.
#[test]
fn the_moment_arm_over_a_pulley_is_its_radius() {
    let mut d = empty(true);
    let link = |length| {
        let shape = LinkDescription { length, radius_base: 0.01, radius_tip: 0.01, density: 0.0 };
        ShapeDescription::Link(shape)
    };
    let mut hinge = joint(JointKind::Revolute);
    hinge.stiffness = vec![0.1];
    d.bodies.push(body("upper", None, [0.0; 3], joint(JointKind::Fixed), link(0.1)));
    d.bodies.push(body("lower", Some("upper"), [0.0; 3], hinge, link(0.1)));
    let pulley = on("lower", Station::Fraction(0.0), [0.0; 3]);
    d.wraps.push(WrapDescription {
        name: "pulley".into(),
        at: pulley,
        axis: Some([0.0, 1.0, 0.0]),
        radius: 0.015,
    });
    let dorsal = on("lower", Station::Fraction(0.0), [0.0, 0.0, 0.1]);
    let path = vec![
        StageDescription::Point(on("upper", Station::Fraction(0.2), [0.0, 0.0, 0.005])),
        around("pulley", Some(dorsal)),
        StageDescription::Point(on("lower", Station::Fraction(0.8), [0.0, 0.0, 0.005])),
    ];
    d.tendons.push(TendonDescription {
        name: "extensor".into(),
        path,
        tension: TensionDescription::Cable {},
        friction: None,
    });
    let model = Model::<SE2, 3, 2>::new(&d).unwrap();
    let mut data = Data::new(&model);
    for angle in [0.3, 1.0, 2.0] {
        data.evaluate(&model, &[angle], &[5.0]);
        assert!((data.tendon_arms(&model)[0] + 0.015).abs() < 1e-15);
        assert!((data.residual()[0] - (0.1 * angle + 5.0 * 0.015)).abs() < 1e-14);
    }
    // Bent the other way it is free, and the arm that of a straight line.
    data.evaluate(&model, &[-1.2], &[5.0]);
    let [p, q] = [[-0.08, 0.005], [0.08f64, 0.005f64]];
    let (s, c) = (-1.2f64).sin_cos();
    let q = [c * q[0] + s * q[1], -s * q[0] + c * q[1]];
    let r = [q[0] - p[0], q[1] - p[1]];
    let arm = -(r[0] * q[1] - r[1] * q[0]) / r[0].hypot(r[1]);
    assert!((data.tendon_arms(&model)[0] - arm).abs() < 1e-14);
}

#[test]
fn what_makes_no_tendon_is_refused() {
    let refused = |change: &dyn Fn(&mut Description)| {
        let mut d = laced(true);
        change(&mut d);
        Model::<SE2, 3, 2>::new(&d).unwrap_err().to_string()
    };
    let wrap = refused(&|d| d.tendons[0].path[1] = around("elbow", None));
    assert_eq!(wrap, "tendons.flexor.path[1]: no wrap is named `elbow`");
    let first = refused(&|d| d.tendons[1].path.drain(..1).for_each(drop));
    assert_eq!(first, "tendons.string.path[0]: a wrap has a point before and after it");
    let end = refused(&|d| d.tendons[2].path.truncate(1));
    assert_eq!(end, "tendons.cable.path: a path goes from a point to another one");
    let axis = refused(&|d| d.wraps[0].axis = Some([1.0, 0.0, 0.0]));
    assert_eq!(axis, "wraps.knuckle.axis: a cylinder of a planar system is across the x–z plane");
    let axis = refused(&|d| d.wraps[0].axis = Some([0.0, 2.0, 0.0]));
    assert!(axis.starts_with("wraps.knuckle.axis: found"), "{axis}");
    let radius = refused(&|d| d.wraps[0].radius = 0.0);
    assert!(radius.starts_with("wraps.knuckle.radius: found 0"), "{radius}");
    let branch = refused(&|d| d.tendons[0].path[5] = StageDescription::Branch(0.0));
    assert!(branch.starts_with("tendons.flexor.path[5]: found 0"), "{branch}");
    let toe = refused(&|d| {
        d.tendons[1].tension = TensionDescription::Spring { stiffness: 1.0, slack_length: 0.1, toe: 0.0 }
    });
    assert!(toe.starts_with("tendons.string.toe: found 0"), "{toe}");
}
