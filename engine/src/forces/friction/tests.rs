//! Residual and tangent in a step against differences of the energy, on bodies that stick and slide.

use super::FrictionDescription;
use crate::Data;
use crate::lie::{LieGroup, SE2, SE3};
use crate::model::*;
use crate::strain::{BasisKind, Mode};
use crate::systems::{body, empty, finger, joint, rod, strain};

const STENCIL: [(f64, f64); 6] =
    [(-1.0, -45.0), (1.0, 45.0), (-2.0, 9.0), (2.0, -9.0), (-3.0, -1.0), (3.0, 1.0)];

/// A rod with a link at its tip, both half in a half-space that is fixed or that a free body carries.
fn sunk(planar: bool, carried: bool) -> Description {
    let mut d = empty(planar);
    let modes: &[Mode] = if planar { &[Mode::BendY, Mode::ExtendX] } else { &Mode::ALL };
    let modes = modes.iter().map(|m| strain(*m, BasisKind::NodalLinear)).collect();
    let arm = rod(0.3, [0.05, 0.03], modes, 2, 2);
    let points = arm.radius.len();
    d.bodies.push(body("arm", None, [0.0; 3], joint(JointKind::Fixed), ShapeDescription::Rod(arm)));
    let link = LinkDescription { length: 0.1, radius_base: 0.04, radius_tip: 0.02, density: 0.0 };
    let hinge = joint(JointKind::Revolute);
    d.bodies.push(body("hand", Some("arm"), [0.0; 3], hinge, ShapeDescription::Link(link)));
    let mut free = joint(JointKind::Free);
    free.stiffness = vec![1.0; if planar { 3 } else { 6 }];
    let link = LinkDescription { length: 0.1, radius_base: 0.04, radius_tip: 0.02, density: 0.0 };
    d.bodies.push(body("cup", None, [0.1, 0.0, 0.02], free, ShapeDescription::Link(link)));
    let spheres = (0..points)
        .map(|k| SphereDescription { body: "arm".into(), station: Station::Point(k) })
        .chain([0.0, 1.0].map(|f| SphereDescription { body: "hand".into(), station: Station::Fraction(f) }))
        .collect();
    d.spheres.push(SphereGroupDescription { name: "all".into(), spheres });
    let on_cup = AttachmentDescription::Body {
        body: "cup".into(),
        station: Station::Fraction(1.0),
        offset: [0.0; 3],
        surface: [0.0; 3],
    };
    d.obstacles.push(ObstacleDescription {
        name: "floor".into(),
        spheres: vec!["all".into()],
        at: if carried { on_cup } else { AttachmentDescription::World { world: [0.0, 0.0, 0.1] } },
        rotation: [0.0; 3],
        surfaces: vec![SurfaceDescription::Plane { normal: [0.28, 0.0, 0.96], distance: 0.0 }],
        stiffness: 200.0,
        skins: vec![],
    });
    d
}

/// The same, which press with skins, the arm flat and the hand round, on a cylinder.
fn sunk_skins(planar: bool, carried: bool) -> Description {
    let mut d = sunk(planar, carried);
    let all = std::mem::take(&mut d.spheres[0].spheres);
    let (arm, hand): (Vec<_>, Vec<_>) = all.into_iter().partition(|sphere| sphere.body == "arm");
    let skin = |name: &str, points: usize, flat: bool| ObstacleSkinDescription {
        spheres: name.into(),
        weights: vec![1.0 / points as f64; points],
        caps: vec![if flat { 0.0 } else { 0.5 }; points],
        half_width: vec![if flat { 0.004 } else { 0.0 }; points],
        half_width_multiple: vec![if flat { 0.2 } else { 1.0 }; points],
        roundness: if flat { 0.0 } else { 1.0 },
        crown: if flat { 1e-4 } else { 0.0 },
        stiffness: 3e5,
        alignment: 0.7,
    };
    let floor = &mut d.obstacles[0];
    floor.skins = vec![skin("arm", arm.len(), true), skin("hand", hand.len(), false)];
    floor.spheres.clear();
    floor.stiffness = 0.0;
    let half = [Some(0.5), None, Some(0.2)];
    floor.surfaces = vec![SurfaceDescription::Rounded { half, radius: 0.05, inside: false }];
    match &mut floor.at {
        AttachmentDescription::World { world } => world[2] -= 0.25,
        AttachmentDescription::Body { offset, .. } => offset[2] -= 0.25,
    }
    d.spheres = vec![
        SphereGroupDescription { name: "arm".into(), spheres: arm },
        SphereGroupDescription { name: "hand".into(), spheres: hand },
    ];
    d
}

/// Checks a model in a step that begins in one state, at another one; returns how many points slide of all.
fn check<G: LieGroup<D, P>, const D: usize, const P: usize>(d: &Description, size: f64) -> [usize; 2] {
    let model = Model::<G, D, P>::new(d).unwrap();
    let n = model.dof();
    let load = vec![0.0; model.inputs().len()];
    let state = |shift: f64| -> Vec<f64> {
        (0..n).map(|i| size * ((1.3 * i as f64 + 1.0).sin() + shift * (0.9 * i as f64 + 2.0).cos())).collect()
    };
    let mut data = Data::new(&model);
    data.evaluate(&model, &state(0.0), &load);
    data.renew_friction(&model);
    data.begin_friction_step(&model, &[]);
    let before = data.energy();
    data.evaluate(&model, &state(0.0), &load);
    assert!((data.energy() - before).abs() < 1e-13 * before.abs(), "nothing has slipped yet");
    // The slips so far, in other places, with other normal forces.
    data.evaluate(&model, &state(0.1), &load);
    data.renew_friction(&model);
    let q = state(0.25);
    data.evaluate(&model, &q, &load);
    let forces = data.friction_forces(&model);
    let (residual, tangent) = (data.residual().to_vec(), data.tangent().to_vec());
    let largest = |v: &[f64]| v.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let h = 1e-5;
    for j in 0..n {
        let (mut slope, mut column) = (0.0, vec![0.0; n]);
        for (step, weight) in STENCIL {
            let mut moved = q.clone();
            moved[j] += step * h;
            data.evaluate_residual(&model, &moved, &load);
            slope += weight * data.energy() / (60.0 * h);
            column.iter_mut().zip(data.residual()).for_each(|(c, r)| *c += weight * r / (60.0 * h));
        }
        assert!((slope - residual[j]).abs() < 1e-7 * largest(&residual), "{j}: {slope} {}", residual[j]);
        for i in 0..n {
            let error = (column[i] - tangent[i * n + j]).abs();
            assert!(error < 1e-7 * largest(&tangent), "{i}, {j}: {} {}", column[i], tangent[i * n + j]);
        }
    }
    check_renewed(&model, &mut data, &q);
    // Many points touch for the first time.
    data.recall_friction(crate::friction::PathMemory::default());
    data.evaluate(&model, &state(-1.0), &load);
    data.renew_friction(&model);
    data.begin_friction_step(&model, &[]);
    check_renewed(&model, &mut data, &q);
    // Once more from here, with elastic slips.
    data.evaluate(&model, &q, &load);
    data.end_friction_step(&model, 1e-12);
    check_renewed(&model, &mut data, &state(0.3));
    [forces.iter().filter(|force| force.slides).count(), forces.len()]
}

/// Checks the tangent with friction renewed in each state.
fn check_renewed<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &mut Data<G, D, P>,
    q: &[f64],
) {
    let (n, load) = (model.dof(), vec![0.0; model.inputs().len()]);
    let mut renewed = |q: &[f64]| {
        data.evaluate_residual(model, q, &load);
        data.renew_friction(model);
        data.evaluate_residual(model, q, &load);
        data.residual().to_vec()
    };
    let h = 1e-6;
    let mut columns = vec![vec![0.0; n]; n];
    for (j, column) in columns.iter_mut().enumerate() {
        for (step, weight) in STENCIL {
            let mut moved = q.to_vec();
            moved[j] += step * h;
            column.iter_mut().zip(renewed(&moved)).for_each(|(c, r)| *c += weight * r / (60.0 * h));
        }
    }
    renewed(q);
    data.evaluate_tangent(model, q, &load);
    let held = data.tangent().to_vec();
    data.complete_columns(model);
    data.add_renewal(model, &mut crate::friction::RenewalWork::new(model));
    let tangent = data.tangent();
    let most = tangent.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let added = held.iter().zip(tangent).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
    // Limits that are renewed matter where a tendon slides; what contacts hold matters also where they stick.
    let slides = data.friction_forces(model).iter().any(|force| force.slides);
    let renewed = slides || model.forces.frictions.count() > 0;
    assert!(!renewed || added > 1e-6 * most, "{added} {most}");
    for (j, column) in columns.iter().enumerate() {
        for (i, change) in column.iter().enumerate() {
            let error = (change - tangent[i * n + j]).abs();
            assert!(error < 1e-6 * most, "{i}, {j}: {change} {} of {most}", tangent[i * n + j]);
        }
    }
}

/// A rod and a link with a spring tendon through guides on both and in the world.
fn laced(planar: bool, coefficient: f64) -> Description {
    let mut d = sunk(planar, true);
    d.obstacles.clear();
    let on = |body: &str, station: Station, z: f64| {
        let y = if planar { 0.0 } else { 0.4 * z };
        let offset = [0.0, y, z];
        StageDescription::Point(AttachmentDescription::Body {
            body: body.into(),
            station,
            offset,
            surface: [0.0; 3],
        })
    };
    d.tendons.push(TendonDescription {
        name: "lace".into(),
        path: vec![
            StageDescription::Point(AttachmentDescription::World { world: [-0.05, 0.0, 0.1] }),
            on("arm", Station::Point(1), 0.06),
            on("arm", Station::Point(3), 0.05),
            StageDescription::Point(AttachmentDescription::World { world: [0.2, 0.0, 0.12] }),
            on("hand", Station::Fraction(0.2), 0.05),
            on("cup", Station::Fraction(0.5), -0.03),
            on("hand", Station::Fraction(0.9), 0.03),
        ],
        tension: TensionDescription::Spring { stiffness: 400.0, slack_length: 0.3, toe: 0.02 },
        friction: Some(GuideDescription { coefficient, stiffness: 900.0 }),
    });
    d
}

#[test]
fn derivatives_in_guides_are_those_of_differences() {
    for (coefficient, slides) in [(0.02, true), (0.8, false)] {
        let [planar, spatial] = [true, false].map(|p| laced(p, coefficient));
        for [slide, all] in [check::<SE2, 3, 2>(&planar, 0.03), check::<SE3, 6, 3>(&spatial, 0.03)] {
            assert!(all == 5 && if slides { slide > 0 } else { slide < all }, "{slide} of {all} slide");
        }
    }
}

#[test]
fn derivatives_in_a_step_are_those_of_differences() {
    let rough = |mut d: Description, name: &str, coefficient: f64| {
        d.frictions.push(FrictionDescription { name: name.into(), coefficient, stiffness_ratio: 0.7 });
        d
    };
    for carried in [false, true] {
        let size = if carried { 0.03 } else { 0.05 };
        for (coefficient, slides) in [(0.01, true), (2.0, false)] {
            let [planar, spatial] = [true, false].map(|p| rough(sunk(p, carried), "floor", coefficient));
            for [slide, all] in [check::<SE2, 3, 2>(&planar, size), check::<SE3, 6, 3>(&spatial, size)] {
                assert!(all > 5 && if slides { slide > 0 } else { slide < all }, "{slide} of {all} slide");
            }
        }
    }
    for carried in [false, true] {
        let size = if carried { 0.03 } else { 0.05 };
        for (coefficient, slides) in [(0.01, true), (2.0, false)] {
            let [planar, spatial] =
                [true, false].map(|p| rough(sunk_skins(p, carried), "floor", coefficient));
            for [slide, all] in [check::<SE2, 3, 2>(&planar, size), check::<SE3, 6, 3>(&spatial, size)] {
                assert!(all > 5 && if slides { slide > 0 } else { slide < all }, "{slide} of {all} slide");
            }
        }
    }
    for (coefficient, slides) in [(0.02, true), (5.0, false)] {
        let [slide, all] = check::<SE2, 3, 2>(&rough(finger(), "contact", coefficient), 0.2);
        assert!(all > 5 && if slides { slide > 0 } else { slide < all }, "{slide} of {all} slide");
    }
}
