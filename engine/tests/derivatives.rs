//! Residual against differences of Π, tangent against differences of the residual, on random states
//! of systems that between them hold every potential, basis, section and joint.

mod systems;

use flexor_engine::Data;
use flexor_engine::lie::{LieGroup, SE2, SE3};
use flexor_engine::linalg::Vector;
use flexor_engine::model::*;
use flexor_engine::strain::{BasisKind, Mode, sample_points};
use proptest::prelude::*;
use systems::{at, body, empty, joint, rod, strain};

const BASES: [BasisKind; 7] = [
    BasisKind::NodalLinear,
    BasisKind::NodalQuadratic,
    BasisKind::NodalCubic,
    BasisKind::Hermite,
    BasisKind::Monomial,
    BasisKind::Legendre,
    BasisKind::Chebyshev,
];
const SECTIONS: [Section; 3] =
    [Section::Circular, Section::Elliptic { ratio: 1.7 }, Section::Rectangular { ratio: 0.6 }];

/// Step of the differences: small against the distance of overlapping sphere centres.
const STEP: f64 = 4e-6;

/// Sixth-order central differences of energy and residual along coordinate `j`.
///
/// `None` where a contact opens or closes within the stencil: the tangent jumps there.
fn differences<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &mut Data<G, D, P>,
    q: &[f64],
    load: &[f64],
    j: usize,
) -> Option<(f64, Vec<f64>)> {
    let h = STEP;
    let mut energy = 0.0;
    let mut column = vec![0.0; q.len()];
    let mut pairs = None;
    let stencil = [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)];
    for (step, weight) in stencil.iter().flat_map(|(s, w)| [(-s, -w), (*s, *w)]) {
        let mut moved = q.to_vec();
        moved[j] += step * h;
        data.evaluate(model, &moved, load);
        let touching: Vec<_> = data.touches(model).iter().map(|t| (t.0, t.1)).collect();
        if pairs.replace(touching.clone()).is_some_and(|p| p != touching) {
            return None;
        }
        energy += weight * data.energy() / (60.0 * h);
        for (c, r) in column.iter_mut().zip(data.residual()) {
            *c += weight * r / (60.0 * h);
        }
    }
    Some((energy, column))
}

fn check<G: LieGroup<D, P>, const D: usize, const P: usize>(
    description: &Description,
    state: &[f64],
    spread: f64,
    load: &[f64],
) -> Result<(), TestCaseError> {
    let model = Model::<G, D, P>::new(description).unwrap();
    let n = model.dof();
    let load = &load[..model.inputs().len()];
    let q: Vec<f64> = (0..n).map(|i| spread * state[i % state.len()]).collect();
    let mut data = Data::new(&model);
    data.evaluate(&model, &q, load);
    let (residual, tangent) = (data.residual().to_vec(), data.tangent().to_vec());
    let size = |v: &[f64]| v.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    if model.is_conservative() {
        for i in 0..n {
            for j in 0..i {
                let (a, b) = (tangent[i * n + j], tangent[j * n + i]);
                prop_assert!((a - b).abs() <= 1e-12 * size(&tangent), "tangent not symmetric at {i}, {j}");
            }
        }
    }
    let mut checked = 0;
    for j in 0..n {
        let Some((slope, difference)) = differences(&model, &mut data, &q, load, j) else { continue };
        checked += 1;
        if model.is_conservative() {
            let error = (slope - residual[j]).abs();
            let rounding = 1e-15 * data.energy().abs() / STEP;
            prop_assert!(error <= 1e-6 * size(&residual) + rounding, "residual {j}: {slope} {}", residual[j]);
        }
        let column: Vec<f64> = (0..n).map(|i| tangent[i * n + j]).collect();
        for i in 0..n {
            let error = (difference[i] - column[i]).abs();
            let rounding = 1e-15 * size(&residual) / STEP;
            prop_assert!(
                error <= 1e-6 * size(&column) + rounding,
                "tangent {i}, {j}: {} {}",
                difference[i],
                column[i]
            );
        }
    }
    prop_assert!(2 * checked > n, "only {checked} of {n} coordinates are away from a change of contact");
    Ok(())
}

/// A tree with every joint: base link, rod, links with the remaining joints, springs, loads.
fn spatial_tree(bases: [BasisKind; 6], section: Section, magnus_order: usize, follower: bool) -> Description {
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
    let on = |body: &str, station, offset| AttachmentDescription::Body { body: body.into(), station, offset };
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
    let wrench = |name: &str, at, moment, frame, input| WrenchDescription {
        name: name.into(),
        at,
        force: [0.3, -0.2, 0.4],
        moment,
        frame,
        input,
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
    };
    d.contacts.push(contact("touch", "others", 0));
    d.contacts.push(contact("self", "arm", 2));
    d
}

/// A planar tree with prismatic, revolute and free joints and a rod with all three modes.
fn planar_tree(bases: [BasisKind; 3], section: Section, magnus_order: usize, follower: bool) -> Description {
    let mut d = systems::finger();
    let modes = [Mode::BendY, Mode::ExtendX, Mode::ShearZ];
    let mut arm =
        rod(0.1, [0.012, 0.008], modes.iter().zip(bases).map(|(m, b)| strain(*m, b)).collect(), 2, 4);
    arm.section = section;
    arm.magnus_order = magnus_order;
    arm.young_modulus = 1e5;
    arm.shear_modulus = 4e4;
    arm.density = 1000.0;
    arm.reference_strain = [0.0, 2.0, 0.0, 1.0, 0.0, 0.1];
    let points = sample_points(2, 4).len();
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
    let end = AttachmentDescription::Body {
        body: "pad".into(),
        station: Station::Fraction(1.0),
        offset: [0.0, 0.0, 0.01],
    };
    let frame = if follower { WrenchFrame::Body } else { WrenchFrame::World };
    d.wrenches.push(WrenchDescription {
        name: "w".into(),
        at: end,
        force: [0.1, 0.0, 0.3],
        moment: [0.0, 0.02, 0.0],
        frame,
        input: true,
    });
    d
}

fn basis() -> impl Strategy<Value = BasisKind> {
    prop::sample::select(BASES.to_vec())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn spatial(
        state in prop::collection::vec(-1.0..1.0f64, 97),
        bases in prop::array::uniform6(basis()),
        section in prop::sample::select(SECTIONS.to_vec()),
        order in prop::sample::select(vec![2usize, 4]),
        follower: bool,
        load in prop::collection::vec(-1.0..2.0f64, 5),
    ) {
        check::<SE3, 6, 3>(&spatial_tree(bases, section, order, follower), &state, 0.25, &load)?;
    }

    #[test]
    fn planar(
        state in prop::collection::vec(-1.0..1.0f64, 53),
        bases in prop::array::uniform3(basis()),
        section in prop::sample::select(SECTIONS.to_vec()),
        order in prop::sample::select(vec![2usize, 4]),
        follower: bool,
        load in prop::collection::vec(-1.0..2.0f64, 5),
    ) {
        check::<SE2, 3, 2>(&planar_tree(bases, section, order, follower), &state, 0.25, &load)?;
    }

    /// The whole world moved rigidly: same energy, same residual.
    #[test]
    fn frame_invariance(
        state in prop::collection::vec(-1.0..1.0f64, 97),
        bases in prop::array::uniform6(basis()),
        turn in prop::array::uniform3(-2.0..2.0f64),
        shift in prop::array::uniform3(-1.0..1.0f64),
        load in prop::collection::vec(-1.0..2.0f64, 5),
    ) {
        let fixed = spatial_tree(bases, Section::Circular, 4, true);
        let rotation = SE3::from_spatial(&shift, &turn).unwrap();
        let point = |p: [f64; 3]| rotation.act(&Vector(p)).0;
        let direction = |d: [f64; 3]| rotation.rotate(&Vector(d)).0;
        let mut moved = fixed.clone();
        moved.gravity = direction(fixed.gravity);
        for b in moved.bodies.iter_mut().filter(|b| b.parent.is_none()) {
            let place = SE3::from_spatial(&b.placement.translation, &b.placement.rotation).unwrap();
            b.placement.translation = point(b.placement.translation);
            b.placement.rotation = rotation_vector(&rotation.compose(&place).to_homogeneous());
        }
        for s in &mut moved.springs {
            for end in [&mut s.first, &mut s.second] {
                if let AttachmentDescription::World { world } = end {
                    *world = point(*world);
                }
            }
        }
        for w in moved.wrenches.iter_mut().filter(|w| w.frame == WrenchFrame::World) {
            w.force = direction(w.force);
            w.moment = direction(w.moment);
        }
        let evaluate = |d: &Description| {
            let model = Model::<SE3, 6, 3>::new(d).unwrap();
            let q: Vec<f64> = (0..model.dof()).map(|i| 0.25 * state[i % state.len()]).collect();
            let mut data = Data::new(&model);
            data.evaluate(&model, &q, &load[..model.inputs().len()]);
            (data.residual().to_vec(), data.tangent().to_vec())
        };
        let ((r, h), (moved_r, moved_h)) = (evaluate(&fixed), evaluate(&moved));
        for (a, b) in r.iter().zip(&moved_r).chain(h.iter().zip(&moved_h)) {
            prop_assert!((a - b).abs() <= 1e-9 * (1.0 + a.abs()), "{a} {b}");
        }
    }
}

/// The rotation vector of a homogeneous matrix, for angles below π.
fn rotation_vector(h: &[[f64; 4]; 4]) -> [f64; 3] {
    let axis = [h[2][1] - h[1][2], h[0][2] - h[2][0], h[1][0] - h[0][1]];
    let sine = 0.5 * axis.iter().map(|a| a * a).sum::<f64>().sqrt();
    let angle = sine.atan2(0.5 * (h[0][0] + h[1][1] + h[2][2] - 1.0));
    axis.map(|a| 0.5 * a * if sine > 1e-12 { angle / sine } else { 1.0 })
}
