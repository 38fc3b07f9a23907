//! Obstacles: closed forms of a pressed link, and derivatives against differences.

use crate::systems::differences::{derivatives, of_output};
use crate::systems::{body, empty, joint, rod, strain};
use flexor_engine::equilibrium::{ContinuationOptions, Status};
use flexor_engine::lie::{LieGroup, SE2, SE3};
use flexor_engine::model::*;
use flexor_engine::strain::{BasisKind, Mode};
use flexor_engine::{Batch, Data};

const STIFFNESS: f64 = 200.0;

fn sphere(body: &str, station: Station) -> SphereDescription {
    SphereDescription { body: body.into(), station }
}

fn floor(spheres: &[&str], point: [f64; 3], normal: [f64; 3]) -> ObstacleDescription {
    ObstacleDescription {
        name: "floor".into(),
        spheres: spheres.iter().map(|name| (*name).into()).collect(),
        at: AttachmentDescription::World { world: point },
        rotation: [0.0; 3],
        surfaces: vec![SurfaceDescription::Plane { normal, distance: 0.0 }],
        stiffness: STIFFNESS,
        skins: vec![],
    }
}

/// A block that slides along z, with a sphere of radius 1 cm, pushed down on a floor at z = −2 cm.
fn block(planar: bool) -> Description {
    let mut d = empty(planar);
    let link = LinkDescription { length: 0.05, radius_base: 0.01, radius_tip: 0.01, density: 0.0 };
    let mut slider = joint(JointKind::Prismatic);
    slider.axis = [0.0, 0.0, 1.0];
    slider.stiffness = vec![50.0];
    d.bodies.push(body("block", None, [0.0; 3], slider, ShapeDescription::Link(link)));
    let spheres = vec![sphere("block", Station::Fraction(1.0))];
    d.spheres.push(SphereGroupDescription { name: "foot".into(), spheres });
    d.obstacles.push(floor(&["foot"], [0.3, 0.0, -0.02], [0.0, 0.0, 1.0]));
    d.wrenches.push(WrenchDescription {
        name: "push".into(),
        at: AttachmentDescription::Body {
            body: "block".into(),
            station: Station::Fraction(0.0),
            offset: [0.0; 3],
            surface: [0.0; 3],
        },
        force: [0.0, 0.0, -1.0],
        moment: [0.0; 3],
        frame: WrenchFrame::World,
        input: true,
        turns: false,
    });
    d
}

fn pressed_block<G: LieGroup<D, P>, const D: usize, const P: usize>() {
    let model = Model::<G, D, P>::new(&block(D == 3)).unwrap();
    let slot = model.layout().get("floor.stiffness").unwrap().start;
    let loads = [0.0, 0.4, 3.0];
    let batch = Batch {
        base: model.parameters(),
        varied: &[],
        values: &[],
        designs: 1,
        loads: &loads,
        steps: loads.len(),
        start: None,
        slips: &[],
        cancel: None,
    };
    let result = model.solve_batch(batch, ContinuationOptions::default(), 1);
    assert!(result.status.iter().all(|s| *s == Status::Converged as u8));
    // The foot touches at z = −1 cm: 50 z = −F before, 50 z − 200 (−0.01 − z) = −F beyond.
    for (q, z) in result.q.iter().zip([0.0, -0.4 / 50.0, touched_at(3.0)]) {
        assert!((q - z).abs() < 1e-12, "{q} {z}");
    }
    // dz/dk = d / (50 + k) with d = −0.01 − z.
    let depth = -0.01 - touched_at(3.0);
    let slope = |output| of_output(&model, model.parameters(), &result, output, &[slot]);
    let found = slope(("joints", 0)).by_parameters[0];
    assert!((found - depth / (50.0 + STIFFNESS)).abs() < 1e-12, "{found}");
    // And of the force on the floor, F − 50 |z|, by k and by the load.
    let found = slope(("obstacles", 0));
    let by_stiffness = 50.0 * depth / (50.0 + STIFFNESS);
    assert!((found.by_parameters[0] - by_stiffness).abs() < 1e-12, "{:?}", found.by_parameters);
    assert!((found.by_loads[0] - STIFFNESS / (50.0 + STIFFNESS)).abs() < 1e-12, "{:?}", found.by_loads);
    let mut data = Data::new(&model);
    data.evaluate(&model, &result.q[2..], &[3.0]);
    let forces = data.contact_forces(&model);
    assert_eq!(forces.len(), 1);
    assert!(forces[0].second.is_none());
    assert!((forces[0].force.norm() - STIFFNESS * depth).abs() < 1e-12);
}

/// Where a force F puts the block that touches.
fn touched_at(force: f64) -> f64 {
    (-force - STIFFNESS * 0.01) / (50.0 + STIFFNESS)
}

#[test]
fn a_pressed_block_sinks_in_by_hookes_law() {
    pressed_block::<SE2, 3, 2>();
    pressed_block::<SE3, 6, 3>();
}

/// A rod with a link at its tip, both half in a tilted half-space, whatever the state.
fn sunk(planar: bool) -> Description {
    let mut d = empty(planar);
    let modes: &[Mode] = if planar { &[Mode::BendY, Mode::ExtendX] } else { &Mode::ALL };
    let modes = modes.iter().map(|m| strain(*m, BasisKind::NodalLinear)).collect();
    let arm = rod(0.3, [0.05, 0.03], modes, 2, 2);
    let points = arm.radius.len();
    d.bodies.push(body("arm", None, [0.0; 3], joint(JointKind::Fixed), ShapeDescription::Rod(arm)));
    let link = LinkDescription { length: 0.1, radius_base: 0.04, radius_tip: 0.02, density: 0.0 };
    let hinge = joint(JointKind::Revolute);
    d.bodies.push(body("hand", Some("arm"), [0.0; 3], hinge, ShapeDescription::Link(link)));
    let spheres = (0..points).map(|k| sphere("arm", Station::Point(k))).collect();
    d.spheres.push(SphereGroupDescription { name: "arm".into(), spheres });
    let stations = [Station::Fraction(0.0), Station::Centroid, Station::Fraction(1.0)];
    let spheres = stations.map(|station| sphere("hand", station)).to_vec();
    d.spheres.push(SphereGroupDescription { name: "hand".into(), spheres });
    d.obstacles.push(floor(&["arm", "hand"], [0.0, 0.0, 0.1], [0.28, 0.0, 0.96]));
    d
}

/// A sphere, a capsule, a box and cylinders, all around the middle of what is sunk in them.
fn solids() -> Vec<SurfaceDescription> {
    let rounded = |half, radius| SurfaceDescription::Rounded { half, radius, inside: false };
    let sleeve = |half, radius| SurfaceDescription::Rounded { half, radius, inside: true };
    let flat = |x| Some(x);
    vec![
        SurfaceDescription::Plane { normal: [0.28, 0.0, 0.96], distance: 0.1 },
        rounded([flat(0.0); 3], 0.25),
        rounded([flat(0.1), flat(0.0), flat(0.0)], 0.2),
        rounded([flat(0.05), flat(0.04), flat(0.01)], 0.2),
        rounded([None, flat(0.0), flat(0.0)], 0.1),
        rounded([flat(0.0), None, flat(0.0)], 0.2),
        sleeve([flat(0.0), None, flat(0.0)], 0.02),
        sleeve([flat(0.0), flat(0.0), flat(0.04)], 0.02),
    ]
}

fn differences<G: LieGroup<D, P>, const D: usize, const P: usize>() {
    for surface in solids() {
        let mut d = sunk(D == 3);
        d.obstacles[0].surfaces = vec![surface.clone()];
        if !matches!(surface, SurfaceDescription::Plane { .. }) {
            d.obstacles[0].at = AttachmentDescription::World { world: [0.22, 0.0, 0.03] };
            d.obstacles[0].rotation = [0.0, 0.4, 0.0];
        }
        let checked = derivatives::<G, D, P>(&d, 0.05, |contacts| contacts.len() > 1);
        assert!(checked > 20, "{surface:?}");
    }
}

/// The same with an obstacle on a body that moves itself, at a place that follows its length.
fn carried<G: LieGroup<D, P>, const D: usize, const P: usize>() {
    // Within the steps of the differences nothing touches anew, and no sphere passes from a side to an end.
    let size = if D == 3 { 0.06 } else { 0.045 };
    for surface in solids() {
        let mut d = sunk(D == 3);
        let link = LinkDescription { length: 0.1, radius_base: 0.04, radius_tip: 0.02, density: 0.0 };
        let mut joint = joint(JointKind::Free);
        joint.stiffness = vec![1.0; D];
        d.bodies.push(body("cup", None, [0.1, 0.0, 0.02], joint, ShapeDescription::Link(link)));
        d.obstacles[0].surfaces = vec![surface.clone()];
        d.obstacles[0].rotation = [0.0, 0.4, 0.0];
        let offset = [0.02, 0.0, 0.01];
        d.obstacles[0].at = AttachmentDescription::Body {
            body: "cup".into(),
            station: Station::Fraction(1.0),
            offset,
            surface: [0.0, 0.0, 0.1],
        };
        let checked = derivatives::<G, D, P>(&d, size, |contacts| !contacts.is_empty());
        assert!(checked > 25, "{surface:?}");
        // On a body before those that touch it.
        let AttachmentDescription::Body { body, .. } = &mut d.obstacles[0].at else { unreachable!() };
        *body = "hand".into();
        d.obstacles[0].spheres = vec!["arm".into()];
        derivatives::<G, D, P>(&d, size, |contacts| !contacts.is_empty());
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    differences::<SE2, 3, 2>();
    differences::<SE3, 6, 3>();
}

#[test]
fn derivatives_of_obstacles_on_bodies_are_those_of_differences() {
    carried::<SE2, 3, 2>();
    carried::<SE3, 6, 3>();
}

/// The skins of both bodies instead of their spheres: flat and round ones.
fn skinned(d: &mut Description) {
    let count = |name: &str| d.spheres.iter().find(|group| group.name == name).unwrap().spheres.len();
    let skin = |name: &str, roundness: f64| {
        let weights = (0..count(name)).map(|i| 0.1 + 0.03 * i as f64).collect();
        let mut caps = vec![0.0; count(name)];
        caps[0] = 0.5;
        ObstacleSkinDescription {
            spheres: name.into(),
            weights,
            caps,
            half_width: vec![0.005; count(name)],
            half_width_multiple: vec![0.7; count(name)],
            roundness,
            crown: 2e-4,
            stiffness: 3e4,
            alignment: 0.3,
        }
    };
    let skins = vec![skin("arm", 0.0), skin("hand", 1.0)];
    d.obstacles[0].skins = skins;
    d.obstacles[0].spheres = vec![];
    d.obstacles[0].stiffness = 0.0;
}

fn differences_of_skins<G: LieGroup<D, P>, const D: usize, const P: usize>() {
    for surface in solids() {
        let mut d = sunk(D == 3);
        skinned(&mut d);
        d.obstacles[0].surfaces = vec![surface.clone()];
        d.obstacles[0].at = AttachmentDescription::World { world: [0.22, 0.0, 0.03] };
        d.obstacles[0].rotation = [0.0, 0.4, 0.0];
        let checked = derivatives::<G, D, P>(&d, 0.05, |contacts| {
            contacts.len() > 1 && contacts.iter().all(|contact| contact.pressure.is_some())
        });
        assert!(checked > 40, "{surface:?}");
        let link = LinkDescription { length: 0.1, radius_base: 0.04, radius_tip: 0.02, density: 0.0 };
        let mut joint = joint(JointKind::Free);
        joint.stiffness = vec![1.0; D];
        d.bodies.push(body("cup", None, [0.1, 0.0, 0.02], joint, ShapeDescription::Link(link)));
        d.obstacles[0].at = AttachmentDescription::Body {
            body: "cup".into(),
            station: Station::Fraction(1.0),
            offset: [0.02, 0.0, 0.01],
            surface: [0.0, 0.0, 0.1],
        };
        let size = if D == 3 { 0.06 } else { 0.045 };
        derivatives::<G, D, P>(&d, size, |contacts| !contacts.is_empty());
    }
}

#[test]
fn derivatives_of_skins_on_obstacles_are_those_of_differences() {
    differences_of_skins::<SE2, 3, 2>();
    differences_of_skins::<SE3, 6, 3>();
}

/// A round block that lies on the floor along its length, pressed down: half of the spheres at both ends and
/// the cylinder between them, as for an elastic foundation that is integrated over the whole surface.
#[test]
fn a_round_body_presses_with_the_volume_of_its_overlap() {
    let mut d = block(false);
    let count = 41;
    let stations = (0..count).map(|i| Station::Fraction(i as f64 / (count - 1) as f64));
    d.spheres[0].spheres = stations.map(|station| sphere("block", station)).collect();
    let middle = 1.0 / (count - 1) as f64;
    let mut weights = vec![middle; count];
    let mut caps = vec![0.0; count];
    for end in [0, count - 1] {
        weights[end] = 0.5 * middle;
        caps[end] = 0.5;
    }
    let k = 1e7;
    d.obstacles[0].spheres = vec![];
    d.obstacles[0].skins = vec![ObstacleSkinDescription {
        spheres: "foot".into(),
        weights,
        caps,
        half_width: vec![0.0; count],
        half_width_multiple: vec![1.0; count],
        roundness: 1.0,
        crown: 0.0,
        stiffness: k,
        alignment: 0.0,
    }];
    let model = Model::<SE3, 6, 3>::new(&d).unwrap();
    let mut data = Data::new(&model);
    let depth = 3e-4;
    data.evaluate(&model, &[-0.01 - depth], &[0.0]);
    let total: f64 = data.contact_forces(&model).iter().map(|contact| contact.force.norm()).sum();
    // Of parabolas: the segment of a disc times the length, and the cap of a sphere.
    let (radius, length) = (0.01, 0.05);
    let segment = 4.0 / 3.0 * (2.0 * radius * depth).sqrt() * depth;
    let expected = k * (segment * length + std::f64::consts::PI * radius * depth * depth);
    assert!((total - expected).abs() < 1e-12 * expected, "{total} {expected}");
    let mut forces = [0.0];
    data.obstacle_forces(&model, &mut forces);
    let [on_obstacle] = forces;
    assert!((on_obstacle - expected).abs() < 1e-12 * expected, "{on_obstacle}");
}

#[test]
fn what_makes_no_obstacle_is_refused() {
    let refused = |change: &dyn Fn(&mut ObstacleDescription)| {
        let mut d = block(true);
        change(&mut d.obstacles[0]);
        Model::<SE2, 3, 2>::new(&d).unwrap_err().to_string()
    };
    let plane = |normal| vec![SurfaceDescription::Plane { normal, distance: 0.0 }];
    let unit = refused(&|h| h.surfaces = plane([0.0, 0.0, 2.0]));
    assert!(unit.starts_with("obstacles.floor.normal: found"), "{unit}");
    let group = refused(&|h| h.spheres = vec!["hand".into()]);
    assert_eq!(group, "obstacles.floor.spheres: no sphere group is named `hand`");
    let plane = refused(&|h| h.surfaces = plane([0.0, 1.0, 0.0]));
    assert_eq!(plane, "obstacles.floor.normal: leaves the x–z plane of a planar system");
    let stiffness = refused(&|h| h.stiffness = 0.0);
    assert!(stiffness.starts_with("obstacles.floor.stiffness: found 0"), "{stiffness}");
    let round = |half, radius| vec![SurfaceDescription::Rounded { half, radius, inside: false }];
    let point = refused(&|h| h.surfaces = round([Some(0.0); 3], 0.0));
    assert!(point.starts_with("obstacles.floor.radius: found 0"), "{point}");
    let space = refused(&|h| h.surfaces = round([None; 3], 0.1));
    assert_eq!(space, "obstacles.floor.half: endless along all axes");
    let own = refused(&|h| {
        h.at = AttachmentDescription::Body {
            body: "block".into(),
            station: Station::Fraction(0.0),
            offset: [0.0; 3],
            surface: [0.0; 3],
        };
    });
    assert_eq!(own, "obstacles.floor.spheres: a sphere moves with the obstacle");
}
