//! Systems shared by the engine's tests.

#![allow(dead_code)]

pub mod differences;

use flexor_engine::model::*;
use flexor_engine::strain::{BasisKind, Intervals, Mode};

pub fn strain(mode: Mode, basis: BasisKind) -> StrainDescription {
    StrainDescription { mode, basis, order: 2 }
}

pub fn joint(kind: JointKind) -> JointDescription {
    JointDescription {
        kind,
        axis: [0.0, 1.0, 0.0],
        stiffness: vec![],
        rest: vec![],
        lower: vec![],
        upper: vec![],
        limit_stiffness: 10.0,
        limit_width: 0.0175,
    }
}

pub fn at(translation: [f64; 3]) -> PlacementDescription {
    PlacementDescription { translation, rotation: [0.0; 3] }
}

/// A rod whose radius varies linearly.
pub fn rod(
    length: f64,
    radius: [f64; 2],
    strain: Vec<StrainDescription>,
    elements: usize,
    gauss: usize,
) -> RodDescription {
    let x = Intervals { elements, tip: 1 }.sample_points(gauss);
    RodDescription {
        length,
        section: Section::Circular,
        strain,
        elements,
        tip_intervals: 1,
        gauss_points: gauss,
        magnus_order: 4,
        young_modulus: 1e6,
        shear_modulus: 1e6 / 3.0,
        density: 0.0,
        reference_strain: [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
        radius: x.iter().map(|x| radius[0] + x * (radius[1] - radius[0])).collect(),
        slope: vec![radius[1] - radius[0]; x.len()],
    }
}

pub fn empty(planar: bool) -> Description {
    Description { planar, ..Description::default() }
}

pub fn body(
    name: &str,
    parent: Option<&str>,
    place: [f64; 3],
    joint: JointDescription,
    shape: ShapeDescription,
) -> BodyDescription {
    BodyDescription { name: name.into(), parent: parent.map(Into::into), placement: at(place), joint, shape }
}

/// The finger and exosuit of `tests/reference/sorosim_finger.json`.
pub fn finger() -> Description {
    let modes = [Mode::BendY, Mode::ExtendX].map(|m| strain(m, BasisKind::NodalLinear)).to_vec();
    let exosuit = rod(0.1, [0.0116, 0.008], modes, 10, 3);
    let points = exosuit.radius.len();
    let mut description = empty(true);
    let shape = ShapeDescription::Rod(exosuit);
    description.bodies.push(body("exosuit", None, [0.0, 0.0, 0.0332], joint(JointKind::Fixed), shape));
    let links = [
        ("ph_1", None, 0.045, [0.0216, 0.0139], Some(0.04)),
        ("ph_2", Some("ph_1"), 0.0253, [0.0139, 0.0102], Some(0.03)),
        ("ph_3", Some("ph_2"), 0.0236, [0.0102, 0.0087], Some(0.02)),
        ("tip", Some("ph_3"), 0.001, [0.0087, 0.008], None),
    ];
    for (name, parent, length, [radius_base, radius_tip], stiffness) in links {
        let mut hinge = joint(if stiffness.is_some() { JointKind::Revolute } else { JointKind::Fixed });
        hinge.stiffness = stiffness.into_iter().collect();
        let link = LinkDescription { length, radius_base, radius_tip, density: 0.0 };
        description.bodies.push(body(name, parent, [0.0; 3], hinge, ShapeDescription::Link(link)));
    }
    let sphere = |body: &str, station| SphereDescription { body: body.into(), station };
    let suit = std::iter::once(0).chain(0..points).map(|k| sphere("exosuit", Station::Point(k))).collect();
    let finger = links
        .iter()
        .flat_map(|(name, ..)| [sphere(name, Station::Fraction(0.0)), sphere(name, Station::Centroid)])
        .collect();
    description.spheres.push(SphereGroupDescription { name: "exosuit".into(), spheres: suit });
    description.spheres.push(SphereGroupDescription { name: "finger".into(), spheres: finger });
    description.contacts.push(ContactDescription {
        name: "contact".into(),
        first: "exosuit".into(),
        second: "finger".into(),
        stiffness: 1000.0,
        skip: 0,
        tip_spheres: vec![41],
        cones: vec![],
        weights: vec![],
        per_length: false,
    });
    description.actuators.push(ActuatorDescription {
        name: "chamber".into(),
        kind: ActuatorKind::Chamber,
        rod: "exosuit".into(),
        path: vec![[0.0; 2]; points],
        path_slope: vec![[0.0; 2]; points],
        lever: [0.0, 1.0],
    });
    description
}

/// The same system with as thick a rod of so many elements all along.
pub fn refined(mut d: Description, elements: usize) -> Description {
    for body in &mut d.bodies {
        if let ShapeDescription::Rod(rod) = &mut body.shape {
            rod.elements = elements;
            let count = Intervals { elements, tip: rod.tip_intervals }.sample_points(rod.gauss_points).len();
            rod.radius = vec![rod.radius[0]; count];
            rod.slope = vec![0.0; count];
            for actuator in &mut d.actuators {
                actuator.path = vec![actuator.path[0]; count];
                actuator.path_slope = vec![actuator.path_slope[0]; count];
            }
        }
    }
    d
}

/// The spatial rod of `tests/reference/sorosim_spatial.json`.
pub fn tendon_rod() -> Description {
    let modes = Mode::ALL.map(|m| strain(m, BasisKind::NodalQuadratic)).to_vec();
    let mut arm = rod(0.25, [0.012, 0.006], modes, 3, 4);
    arm.young_modulus = 2e5;
    arm.shear_modulus = 2e5 / 3.0;
    arm.density = 1000.0;
    let x = Intervals { elements: 3, tip: 1 }.sample_points(4);
    let mut description = empty(false);
    description.gravity = [0.0, 0.0, -9.81];
    description.bodies.push(body("arm", None, [0.0; 3], joint(JointKind::Fixed), ShapeDescription::Rod(arm)));
    description.actuators.push(ActuatorDescription {
        name: "tendon".into(),
        kind: ActuatorKind::Cable,
        rod: "arm".into(),
        path: x.iter().map(|x| [0.004 * (2.0 * x).cos(), 0.004 * (2.0 * x).sin()]).collect(),
        path_slope: x.iter().map(|x| [-0.008 * (2.0 * x).sin(), 0.008 * (2.0 * x).cos()]).collect(),
        lever: [0.0, 0.0],
    });
    description
}
