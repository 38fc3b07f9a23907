//! Friction: closed forms of a block on a floor, loops and dead loads.

use crate::systems::{body, empty, joint};
use flexor_engine::equilibrium::{ContinuationOptions, Status};
use flexor_engine::lie::{LieGroup, SE2, SE3};
use flexor_engine::model::*;
use flexor_engine::{Batch, PathResults};

const STIFFNESS: f64 = 2e4;
const RATIO: f64 = 0.5;
const MU: f64 = 0.4;
const SPRING: f64 = 300.0;

/// A block that slides along x against a spring and along z, with one foot on a floor at z = 0, pushed by forces
/// in both directions.
fn block(planar: bool, spring: f64) -> Description {
    let mut d = empty(planar);
    let link = |length| LinkDescription { length, radius_base: 0.01, radius_tip: 0.01, density: 0.0 };
    let slider = |axis, stiffness: f64| {
        let mut slider = joint(JointKind::Prismatic);
        (slider.axis, slider.stiffness) = (axis, vec![stiffness]);
        slider
    };
    let shape = |length| ShapeDescription::Link(link(length));
    d.bodies.push(body("carriage", None, [0.0; 3], slider([0.0, 0.0, 1.0], 1e-3), shape(0.01)));
    d.bodies.push(body("block", Some("carriage"), [0.0; 3], slider([1.0, 0.0, 0.0], spring), shape(0.01)));
    d.bodies[1].placement.translation = [-0.01, 0.0, 0.01];
    let foot = SphereDescription { body: "block".into(), station: Station::Fraction(0.0) };
    d.spheres.push(SphereGroupDescription { name: "foot".into(), spheres: vec![foot] });
    d.obstacles.push(ObstacleDescription {
        name: "floor".into(),
        spheres: vec!["foot".into()],
        at: AttachmentDescription::World { world: [0.0; 3] },
        rotation: [0.0; 3],
        surfaces: vec![SurfaceDescription::Plane { normal: [0.0, 0.0, 1.0], distance: 0.0 }],
        stiffness: STIFFNESS,
        skins: vec![],
    });
    d.frictions.push(FrictionDescription { name: "floor".into(), coefficient: MU, stiffness_ratio: RATIO });
    for (name, force) in [("press", [0.0, 0.0, -1.0]), ("pull", [1.0, 0.0, 0.0])] {
        d.wrenches.push(WrenchDescription {
            name: name.into(),
            at: AttachmentDescription::Body {
                body: "block".into(),
                station: Station::Fraction(0.0),
                offset: [0.0; 3],
                surface: [0.0; 3],
            },
            force,
            moment: [0.0; 3],
            frame: WrenchFrame::World,
            input: true,
            turns: false,
        });
    }
    d
}

fn follow<G: LieGroup<D, P>, const D: usize, const P: usize>(
    d: &Description,
    loads: &[[f64; 2]],
) -> PathResults {
    let model = Model::<G, D, P>::new(d).unwrap();
    let batch = Batch {
        base: model.parameters(),
        varied: &[],
        values: &[],
        designs: 1,
        loads: loads.as_flattened(),
        steps: loads.len(),
        start: None,
        slips: &[],
        cancel: None,
    };
    model.solve_batch(batch, ContinuationOptions::default(), 1)
}

/// Places of the block along x.
fn places(found: &PathResults) -> Vec<f64> {
    assert!(found.status.iter().all(|s| *s == Status::Converged as u8), "{:?}", found.status);
    found.q.chunks(2).map(|q| q[1]).collect()
}

/// Sticks elastically up to μN, then slides; on the way back it first sticks again.
fn loop_of_a_block<G: LieGroup<D, P>, const D: usize, const P: usize>() {
    let press = 5.0;
    let pulls = [0.0, 1.0, 1.9, 3.0, 5.0, 4.0, 0.5, -3.0, -5.0, 0.0, 5.0];
    let loads: Vec<[f64; 2]> = std::iter::once([0.0, 0.0]).chain(pulls.map(|pull| [press, pull])).collect();
    let found = follow::<G, D, P>(&block(D == 3, SPRING), &loads);
    let k = RATIO * STIFFNESS;
    // The soft spring along z carries next to nothing.
    let normal = |pull: usize| {
        let z = found.q[2 * (pull + 1)];
        -STIFFNESS * z
    };
    let (mut x, mut slip) = (0.0, 0.0f64);
    let mut dissipated = 0.0;
    let places = places(&found);
    for (i, pull) in pulls.into_iter().enumerate() {
        let limit = MU * normal(i);
        assert!((normal(i) - press).abs() < 1e-6 * press);
        // F = K x + k (x − a) sticking with the anchor a = x − slip.
        let anchor = x - slip;
        let stuck = (pull + k * anchor) / (SPRING + k);
        let (next, next_slip) = if k * (stuck - anchor).abs() <= limit {
            (stuck, stuck - anchor)
        } else {
            let sign = (stuck - anchor).signum();
            let next = (pull - sign * limit) / SPRING;
            dissipated += limit * ((next - sign * limit / k) - anchor).abs();
            (next, sign * limit / k)
        };
        (x, slip) = (next, next_slip);
        assert!((places[i + 1] - x).abs() < 1e-9 * (1.0 + x.abs()), "{pull}: {} {x}", places[i + 1]);
        assert!(
            (found.dissipated[i + 1] - dissipated).abs() < 1e-8,
            "{} {dissipated}",
            found.dissipated[i + 1]
        );
        let of_step: Vec<_> = found.frictions.iter().filter(|f| f.step == i + 1).collect();
        assert_eq!(of_step.len(), 1);
        assert!((of_step[0].force[0] + k * slip).abs() < 1e-6, "{:?} {}", of_step[0], k * slip);
        assert_eq!(of_step[0].slides, k * slip.abs() > limit * (1.0 - 1e-6), "{pull}");
    }
    assert!(dissipated > 1e-3);
}

#[test]
fn a_block_sticks_slides_and_sticks_again() {
    loop_of_a_block::<SE2, 3, 2>();
    loop_of_a_block::<SE3, 6, 3>();
}

#[test]
fn a_block_on_a_slope_stays_while_the_tangent_is_below_the_coefficient() {
    let weight = 5.0;
    for planar in [true, false] {
        let slope = |angle: f64| [weight * angle.cos(), weight * angle.sin()];
        for (angle, stays) in [(0.9 * MU.atan(), true), (0.999 * MU.atan(), true), (1.001 * MU.atan(), false)]
        {
            let count = 20;
            let loads: Vec<[f64; 2]> =
                (0..=count).map(|i| slope(angle * f64::from(i) / f64::from(count))).collect();
            let d = block(planar, 0.0);
            let found =
                if planar { follow::<SE2, 3, 2>(&d, &loads) } else { follow::<SE3, 6, 3>(&d, &loads) };
            let last = *found.status.last().unwrap();
            assert_eq!(last == Status::Converged as u8, stays, "{angle}: {:?}", found.status);
            if stays {
                let x = found.q[found.q.len() - 1];
                let exact = weight * angle.sin() / (RATIO * STIFFNESS);
                assert!((x - exact).abs() < 1e-9 * exact, "{x} {exact}");
            }
        }
    }
}

#[test]
fn a_load_that_is_held_moves_nothing() {
    let mut loads = vec![[0.0, 0.0], [5.0, 0.0], [5.0, 3.0], [5.0, 4.0], [5.0, 2.5]];
    loads.extend(vec![[5.0, 2.5]; 1000]);
    let found = follow::<SE2, 3, 2>(&block(true, SPRING), &loads);
    let states: Vec<&[f64]> = found.q.chunks(2).collect();
    assert!(states[5..].iter().all(|q| q == &states[4]));
    assert!(found.dissipated[5..].iter().all(|e| *e == found.dissipated[4]));
    // Nor does a load that rises and falls by next to nothing a thousand times.
    let mut loads = loads[..5].to_vec();
    loads.extend((0..1000).map(|i| [5.0, 2.5 + 1e-4 * f64::from(i % 2)]));
    let moved = follow::<SE2, 3, 2>(&block(true, SPRING), &loads);
    let last = &moved.q[moved.q.len() - 4..moved.q.len() - 2];
    assert!((last[1] - states[4][1]).abs() < 1e-10 * states[4][1], "{last:?} {:?}", states[4]);
}

#[test]
fn what_makes_no_friction_is_refused() {
    let refused = |change: &dyn Fn(&mut FrictionDescription)| {
        let mut d = block(true, SPRING);
        change(&mut d.frictions[0]);
        Model::<SE2, 3, 2>::new(&d).unwrap_err().to_string()
    };
    let negative = refused(&|f| f.coefficient = -0.1);
    assert_eq!(negative, "frictions.floor.coefficient: found -0.1, must be a finite number not below zero");
    let unknown = refused(&|f| f.name = "wall".into());
    assert_eq!(unknown, "frictions.wall.name: there is no contact, foundation or obstacle of this name");
}
