//! Trees that between them hold every joint, basis, section and potential.

use super::systems::{at, body, empty, finger, joint, rod, strain};
use flexor_engine::model::*;
use flexor_engine::strain::{BasisKind, Intervals, Mode};
use proptest::prelude::*;

/// Any basis.
pub fn basis() -> impl Strategy<Value = BasisKind> {
    prop::sample::select(BASES.to_vec())
}

/// Any tree of `spatial_tree`, touched as spheres or as round cones.
pub fn spatial_trees() -> impl Strategy<Value = Description> {
    let section = prop::sample::select(SECTIONS.to_vec());
    let order = prop::sample::select(vec![2usize, 4]);
    (prop::array::uniform6(basis()), section, order, any::<bool>(), any::<bool>()).prop_map(
        |(bases, section, order, follower, cones)| {
            let tree = spatial_tree(bases, section, order, follower);
            if cones { with_round_cones(tree) } else { tree }
        },
    )
}

/// Any tree of `planar_tree`, touched as spheres or as round cones.
pub fn planar_trees() -> impl Strategy<Value = Description> {
    let section = prop::sample::select(SECTIONS.to_vec());
    let order = prop::sample::select(vec![2usize, 4]);
    (prop::array::uniform3(basis()), section, order, any::<bool>(), any::<bool>()).prop_map(
        |(bases, section, order, follower, cones)| {
            let tree = planar_tree(bases, section, order, follower);
            if cones { with_round_cones(tree) } else { tree }
        },
    )
}

/// All bases.
pub const BASES: [BasisKind; 7] = [
    BasisKind::NodalLinear,
    BasisKind::NodalQuadratic,
    BasisKind::NodalCubic,
    BasisKind::Hermite,
    BasisKind::Monomial,
    BasisKind::Legendre,
    BasisKind::Chebyshev,
];
/// All sections.
pub const SECTIONS: [Section; 3] =
    [Section::Circular, Section::Elliptic { ratio: 1.7 }, Section::Rectangular { ratio: 0.6 }];

/// A tree with every joint: base link, rod, links with the remaining joints, springs, loads.
pub fn spatial_tree(
    bases: [BasisKind; 6],
    section: Section,
    magnus_order: usize,
    follower: bool,
) -> Description {
    let modes = Mode::ALL.iter().zip(bases).map(|(m, b)| strain(*m, b)).collect();
    let mut arm = rod(0.3, [0.02, 0.012], modes, 2, 4);
    arm.section = section;
    arm.magnus_order = magnus_order;
    arm.density = 1200.0;
    arm.young_modulus = 3e4;
    arm.shear_modulus = 1e4;
    arm.reference_strain = [0.3, -0.5, 0.2, 1.0, 0.05, -0.02];
    let points = arm.radius.len();
    let mut d = empty(false);
    d.gravity = [0.3, -0.2, -9.81];
    let link = |length| {
        ShapeDescription::Link(LinkDescription {
            length,
            radius_base: 0.02,
            radius_tip: 0.015,
            density: 800.0,
        })
    };
    let hinge = |kind, n: usize| {
        let mut j = joint(kind);
        j.stiffness = (0..n).map(|i| 0.3 + 0.1 * i as f64).collect();
        j.rest = vec![0.1; n];
        j.lower = vec![Some(-0.2); n];
        j.upper = vec![Some(0.3); n];
        j.limit_width = 0.5;
        j
    };
    let mut revolute = hinge(JointKind::Revolute, 1);
    revolute.axis = [0.6, 0.0, 0.8];
    let mut prismatic = hinge(JointKind::Prismatic, 1);
    prismatic.axis = [0.0, 0.6, 0.8];
    let turned = |mut b: BodyDescription| {
        b.placement.rotation = [0.2, -0.4, 0.3];
        b
    };
    d.bodies.push(turned(body("base", None, [0.01, 0.02, 0.0], revolute, link(0.05))));
    d.bodies.push(body(
        "arm",
        Some("base"),
        [0.0, 0.0, 0.01],
        hinge(JointKind::Universal, 2),
        ShapeDescription::Rod(arm),
    ));
    d.bodies.push(turned(body("hand", Some("arm"), [0.0; 3], hinge(JointKind::Spherical, 3), link(0.04))));
    d.bodies.push(body("thumb", Some("hand"), [0.0, 0.01, 0.0], prismatic, link(0.03)));
    d.bodies.push(body("ball", None, [0.3, 0.0, 0.05], hinge(JointKind::Free, 6), link(0.05)));
    let on = |body: &str, station, offset| AttachmentDescription::Body {
        body: body.into(),
        station,
        offset,
        surface: [0.1, 0.3, -0.5],
    };
    let spring = |name: &str, first, second, slack| SpringDescription {
        name: name.into(),
        first,
        second,
        stiffness: 12.0,
        rest_length: 0.05,
        slack,
    };
    d.springs.push(spring(
        "s1",
        on("thumb", Station::Fraction(0.7), [0.0, 0.01, 0.0]),
        on("ball", Station::Centroid, [0.0, 0.0, 0.01]),
        false,
    ));
    d.springs.push(spring(
        "s2",
        on("arm", Station::Point(5), [0.0, 0.01, 0.0]),
        AttachmentDescription::World { world: [0.1, 0.2, 0.3] },
        true,
    ));
    d.springs.push(spring(
        "s3",
        on("hand", Station::Centroid, [0.0; 3]),
        on("arm", Station::Point(3), [0.0, 0.0, 0.01]),
        false,
    ));
    for (name, fraction, target) in [("s4", 0.437, "ball"), ("s5", 0.81, "base")] {
        let first = on("arm", Station::Along(fraction), [0.0, 0.01, 0.002]);
        let second = on(target, Station::Fraction(0.2), [0.0, 0.0, 0.01]);
        d.springs.push(spring(name, first, second, name == "s4"));
    }
    let [exponential, table, ..] = torque_curves();
    d.joint_torques.push(torque("base_torque", ("base", "theta"), exponential));
    d.joint_torques.push(torque("thumb_force", ("thumb", "d"), table));
    d.joint_couplings.push(coupled(["base", "thumb"], ["theta", "d"]));
    let wrench = |name: &str, at, moment, frame, input| WrenchDescription {
        name: name.into(),
        at,
        force: [0.3, -0.2, 0.4],
        moment,
        frame,
        input,
        turns: false,
    };
    d.wrenches.push(wrench(
        "dead",
        on("thumb", Station::Fraction(1.0), [0.0, 0.0, 0.02]),
        [0.0; 3],
        WrenchFrame::World,
        true,
    ));
    if follower {
        d.wrenches.push(wrench(
            "moment",
            on("hand", Station::Centroid, [0.0; 3]),
            [0.02, -0.03, 0.01],
            WrenchFrame::World,
            true,
        ));
        d.wrenches.push(wrench(
            "follower",
            on("arm", Station::Point(8), [0.0, 0.01, 0.0]),
            [0.01, 0.02, -0.01],
            WrenchFrame::Body,
            true,
        ));
    }
    d.actuators.push(ActuatorDescription {
        name: "chamber".into(),
        kind: ActuatorKind::Chamber,
        rod: "arm".into(),
        path: vec![[0.002, -0.001]; points],
        path_slope: vec![[0.001, 0.0]; points],
        lever: [0.3, 0.8],
    });
    d.actuators.push(ActuatorDescription {
        name: "cable".into(),
        kind: ActuatorKind::Cable,
        lever: [-0.5, 0.0],
        ..d.actuators[0].clone()
    });
    let sphere = |body: &str, station| SphereDescription { body: body.into(), station };
    let suit = (0..points).map(|k| sphere("arm", Station::Point(k))).collect();
    let others = vec![
        sphere("ball", Station::Centroid),
        sphere("thumb", Station::Fraction(0.5)),
        sphere("base", Station::Fraction(0.2)),
    ];
    d.spheres.push(SphereGroupDescription { name: "arm".into(), spheres: suit });
    d.spheres.push(SphereGroupDescription { name: "others".into(), spheres: others });
    let contact = |name: &str, second: &str, skip| ContactDescription {
        name: name.into(),
        first: "arm".into(),
        second: second.into(),
        stiffness: 40.0,
        skip,
        tip_spheres: vec![],
        cones: vec![],
        weights: vec![],
        per_length: false,
    };
    d.contacts.push(contact("touch", "others", 0));
    d.contacts.push(contact("self", "arm", 2));
    d
}

/// A passive torque of each kind, those of a threshold in both directions.
pub fn torque_curves() -> [TorqueCurve; 4] {
    let threshold =
        |angle, direction| TorqueCurve::Threshold { angle, stiffness: 0.8, width: 0.07, direction };
    [
        TorqueCurve::DoubleExponential { moments: [0.2, 0.3, -0.05], rates: [4.0, 3.0], angles: [0.1, -0.2] },
        TorqueCurve::Table {
            angles: vec![-0.153, -0.021, 0.087, 0.191],
            torques: vec![-0.3, 0.02, 0.03, 0.2],
            slopes: vec![2.0, 0.2, 0.3, 1.5],
        },
        threshold(0.0523, 1.0),
        threshold(-0.0317, -1.0),
    ]
}

fn torque(name: &str, (body, coordinate): (&str, &str), curve: TorqueCurve) -> JointTorqueDescription {
    JointTorqueDescription { name: name.into(), body: body.into(), coordinate: coordinate.into(), curve }
}

fn coupled(bodies: [&str; 2], coordinates: [&str; 2]) -> JointCouplingDescription {
    JointCouplingDescription {
        name: "coupling".into(),
        bodies: bodies.map(Into::into),
        coordinates: coordinates.map(Into::into),
        ratio: 0.67,
        offset: 0.02,
        stiffness: 0.4,
    }
}

/// A planar tree with prismatic, revolute and free joints and a rod with all three modes.
pub fn planar_tree(
    bases: [BasisKind; 3],
    section: Section,
    magnus_order: usize,
    follower: bool,
) -> Description {
    let mut d = finger();
    let modes = [Mode::BendY, Mode::ExtendX, Mode::ShearZ];
    let mut arm =
        rod(0.1, [0.012, 0.008], modes.iter().zip(bases).map(|(m, b)| strain(*m, b)).collect(), 2, 4);
    arm.section = section;
    arm.magnus_order = magnus_order;
    arm.young_modulus = 1e5;
    arm.shear_modulus = 4e4;
    arm.density = 1000.0;
    arm.reference_strain = [0.0, 2.0, 0.0, 1.0, 0.0, 0.1];
    let points = Intervals { elements: 2, tip: 1 }.sample_points(4).len();
    d.gravity = [1.0, 0.0, -9.81];
    let mut slider = joint(JointKind::Prismatic);
    slider.axis = [0.6, 0.0, 0.8];
    slider.stiffness = vec![20.0];
    d.bodies[0] = body("exosuit", None, [0.0, 0.0, 0.03], slider, ShapeDescription::Rod(arm));
    d.bodies[0].placement = PlacementDescription { rotation: [0.0, 0.1, 0.0], ..at([0.0, 0.0, 0.03]) };
    let mut free = joint(JointKind::Free);
    free.stiffness = vec![0.1, 10.0, 10.0];
    let link = LinkDescription { length: 0.02, radius_base: 0.01, radius_tip: 0.012, density: 500.0 };
    d.bodies.push(body("pad", Some("exosuit"), [0.0, 0.0, 0.0], free, ShapeDescription::Link(link)));
    for (i, b) in d.bodies.iter_mut().enumerate().skip(1) {
        if b.joint.kind == JointKind::Revolute {
            b.joint.lower = vec![Some(-0.1)];
            b.joint.upper = vec![Some(0.1 * i as f64)];
            b.joint.limit_width = 0.5;
        }
    }
    d.spheres[0].spheres = (0..points)
        .map(|k| SphereDescription { body: "exosuit".into(), station: Station::Point(k) })
        .collect();
    d.spheres[0].spheres.push(SphereDescription { body: "pad".into(), station: Station::Centroid });
    d.contacts[0].tip_spheres.clear();
    d.actuators[0].path = vec![[0.0, 0.001]; points];
    d.actuators[0].path_slope = vec![[0.0; 2]; points];
    for (i, curve) in torque_curves().into_iter().enumerate() {
        d.joint_torques.push(torque(&format!("torque_{i}"), (["ph_1", "ph_2"][i % 2], "theta"), curve));
    }
    d.joint_couplings.push(coupled(["ph_2", "ph_1"], ["theta"; 2]));
    let end = AttachmentDescription::Body {
        body: "pad".into(),
        station: Station::Fraction(1.0),
        offset: [0.0, 0.0, 0.01],
        surface: [0.0, 0.0, 0.4],
    };
    let frame = if follower { WrenchFrame::Body } else { WrenchFrame::World };
    let on_rod = |fraction| AttachmentDescription::Body {
        body: "exosuit".into(),
        station: Station::Along(fraction),
        offset: [0.0, 0.0, 0.001],
        surface: [0.0, 0.0, -1.0],
    };
    for (name, fraction, second) in [
        ("between", 0.377, AttachmentDescription::World { world: [0.03, 0.0, -0.02] }),
        ("to pad", 0.92, end.clone()),
    ] {
        d.springs.push(SpringDescription {
            name: name.into(),
            first: on_rod(fraction),
            second,
            stiffness: 15.0,
            rest_length: 0.01,
            slack: name == "between",
        });
    }
    d.wrenches.push(WrenchDescription {
        name: "w".into(),
        at: end,
        force: [0.1, 0.0, 0.3],
        moment: [0.0, 0.02, 0.0],
        frame,
        input: true,
        turns: false,
    });
    d
}

/// The same system with round cones instead of spheres in every contact's second group: one for each
/// link, joined where links follow one another, and a chain for each rod.
pub fn with_round_cones(mut d: Description) -> Description {
    let parents: Vec<_> = d.bodies.iter().map(|b| (b.name.clone(), b.parent.clone())).collect();
    for group in &mut d.spheres {
        if group.name == "arm" {
            continue;
        }
        let mut bodies: Vec<String> = vec![];
        for sphere in group.spheres.iter().filter(|s| !matches!(s.station, Station::Point(_))) {
            if !bodies.contains(&sphere.body) {
                bodies.push(sphere.body.clone());
            }
        }
        let end = |body: &String, f| SphereDescription { body: body.clone(), station: Station::Fraction(f) };
        if group.name == "finger" || group.name == "others" {
            group.spheres = bodies.iter().flat_map(|b| [end(b, 0.0), end(b, 1.0)]).collect();
        }
    }
    for contact in &mut d.contacts {
        let group = |name: &String| d.spheres.iter().find(|g| g.name == *name).unwrap();
        let (first, second) = (group(&contact.first), group(&contact.second));
        if second.name == "arm" {
            let chain = |i: usize| RoundConeDescription { ends: [i - 1, i], joined: i > 1 };
            contact.cones = (1..second.spheres.len()).map(chain).collect();
        } else {
            let bodies: Vec<_> = second.spheres.iter().step_by(2).map(|s| s.body.clone()).collect();
            let link = |i: usize| RoundConeDescription {
                ends: [2 * i, 2 * i + 1],
                joined: i > 0
                    && parents.iter().any(|(n, p)| *n == bodies[i] && p.as_ref() == Some(&bodies[i - 1])),
            };
            contact.cones = (0..bodies.len()).map(link).collect();
        }
        contact.weights = (0..first.spheres.len()).map(|i| 20.0 + i as f64).collect();
        contact.per_length = true;
        contact.tip_spheres = vec![first.spheres.len() - 1, 3];
    }
    d
}

/// Bulky bodies that are deep in one another whatever their state: a ball's spheres in a chain of two
/// links and a rod, the rod's spheres in the ball.
pub fn solids() -> Description {
    let mut d = empty(false);
    let modes = Mode::ALL.map(|m| strain(m, BasisKind::NodalLinear)).to_vec();
    let mut arm = rod(0.5, [0.2, 0.1], modes, 2, 2);
    arm.young_modulus = 1e4;
    arm.shear_modulus = 4e3;
    let points = arm.radius.len();
    let link = |length, radius_base, radius_tip| {
        ShapeDescription::Link(LinkDescription { length, radius_base, radius_tip, density: 0.0 })
    };
    let hinge = |kind, n: usize| {
        let mut hinge = joint(kind);
        hinge.stiffness = vec![1.0; n];
        hinge
    };
    let [spherical, universal] = [(JointKind::Spherical, 3), (JointKind::Universal, 2)];
    d.bodies.push(body("fore", None, [0.0; 3], hinge(spherical.0, 3), link(0.4, 0.25, 0.15)));
    d.bodies.push(body("hand", Some("fore"), [0.0; 3], hinge(universal.0, 2), link(0.3, 0.15, 0.2)));
    d.bodies.push(body("arm", Some("hand"), [0.0; 3], joint(JointKind::Fixed), ShapeDescription::Rod(arm)));
    d.bodies.push(body("ball", None, [0.0, 0.1, 0.3], hinge(JointKind::Free, 6), link(0.8, 0.2, 0.3)));
    let sphere = |body: &str, station| SphereDescription { body: body.into(), station };
    let ends = |body: &str| [0.0, 1.0].map(|f| sphere(body, Station::Fraction(f)));
    let mut chain = [ends("fore"), ends("hand")].concat();
    chain.extend((0..points).map(|k| sphere("arm", Station::Point(k))));
    let spheres = [0.0, 0.3, 0.6, 1.0].map(|f| sphere("ball", Station::Fraction(f)));
    let group = |name: &str, spheres| SphereGroupDescription { name: name.into(), spheres };
    d.spheres.push(group("chain", chain));
    d.spheres.push(group("ball", spheres.to_vec()));
    let cone = |i: usize, j: usize| RoundConeDescription { ends: [i, j], joined: i > 0 };
    let mut cones = vec![cone(0, 1), cone(2, 3)];
    cones.extend((4..3 + points).map(|i| cone(i, i + 1)));
    let contact = |name: &str, first: &str, second: &str, cones| ContactDescription {
        name: name.into(),
        first: first.into(),
        second: second.into(),
        stiffness: 30.0,
        skip: 0,
        tip_spheres: vec![1, 2],
        cones,
        weights: vec![],
        per_length: false,
    };
    d.contacts.push(contact("pressed", "ball", "chain", cones));
    d.contacts.push(contact("pressing", "chain", "ball", vec![cone(0, 3)]));
    d.contacts[1].weights = (0..4 + points).map(|i| 0.5 + 0.1 * i as f64).collect();
    d.contacts[1].per_length = true;
    d
}
