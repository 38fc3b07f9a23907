//! Loads without a potential: closed forms of cantilevers under end moments and follower forces.

use crate::systems::{body, empty, joint, rod, strain};
use flexor_engine::Batch;
use flexor_engine::equilibrium::{ContinuationOptions, Status};
use flexor_engine::lie::{LieGroup, SE2, SE3};
use flexor_engine::model::*;
use flexor_engine::strain::{BasisKind, Mode};

const LENGTH: f64 = 0.2;
const RADIUS: f64 = 0.005;
const YOUNG: f64 = 1e6;

fn bending_stiffness() -> f64 {
    YOUNG * std::f64::consts::PI / 4.0 * RADIUS.powi(4)
}

/// A clamped rod with a unit wrench at its tip as load input.
fn cantilever(planar: bool, force: [f64; 3], moment: [f64; 3], frame: WrenchFrame) -> Description {
    let modes = [Mode::BendY].map(|m| strain(m, BasisKind::NodalCubic)).to_vec();
    let mut beam = rod(LENGTH, [RADIUS, RADIUS], modes, 8, 4);
    beam.young_modulus = YOUNG;
    let tip = beam.radius.len() - 1;
    let mut d = empty(planar);
    d.bodies.push(body("beam", None, [0.0; 3], joint(JointKind::Fixed), ShapeDescription::Rod(beam)));
    let at = AttachmentDescription::Body {
        body: "beam".into(),
        station: Station::Point(tip),
        offset: [0.0; 3],
        surface: [0.0; 3],
    };
    d.wrenches.push(WrenchDescription {
        name: "tip".into(),
        at,
        force,
        moment,
        frame,
        input: true,
        turns: false,
    });
    d
}

fn solve<G: LieGroup<D, P>, const D: usize, const P: usize>(
    d: &Description,
    loads: &[f64],
) -> (Vec<f64>, usize) {
    let model = Model::<G, D, P>::new(d).unwrap();
    let batch = Batch {
        base: model.parameters(),
        varied: &[],
        values: &[],
        designs: 1,
        loads,
        steps: loads.len(),
        start: None,
        slips: &[],
        cancel: None,
    };
    let result = model.solve_batch(batch, ContinuationOptions::default(), 1);
    assert!(result.status.iter().all(|s| *s == Status::Converged as u8), "{:?}", result.status);
    let n = model.dof();
    (result.q[(loads.len() - 1) * n..].to_vec(), result.events.len())
}

/// An end moment M bends to the constant curvature M/EI, here a full circle.
#[test]
fn end_moment_closes_a_circle() {
    let full = 2.0 * std::f64::consts::PI * bending_stiffness() / LENGTH;
    let loads: Vec<f64> = (0..=4).map(|i| full * f64::from(i) / 4.0).collect();
    let moment = [0.0, 1.0, 0.0];
    for frame in [WrenchFrame::World, WrenchFrame::Body] {
        let planar = solve::<SE2, 3, 2>(&cantilever(true, [0.0; 3], moment, frame), &loads);
        let spatial = solve::<SE3, 6, 3>(&cantilever(false, [0.0; 3], moment, frame), &loads);
        for (q, events) in [planar, spatial] {
            assert_eq!(events, 0);
            for kappa in q {
                assert!((kappa - 2.0 * std::f64::consts::PI).abs() < 1e-7, "{kappa}");
            }
        }
    }
}

/// The same moment on a spatial rod with all six modes: the symmetric part of its tangent is
/// indefinite from half a turn on, yet no motion grows.
#[test]
fn end_moment_on_a_rod_with_all_modes() {
    let full = 2.0 * std::f64::consts::PI * bending_stiffness() / LENGTH;
    let loads: Vec<f64> = (0..=8).map(|i| full * f64::from(i) / 8.0).collect();
    let mut d = cantilever(false, [0.0; 3], [0.0, 1.0, 0.0], WrenchFrame::World);
    let ShapeDescription::Rod(beam) = &mut d.bodies[0].shape else { unreachable!() };
    beam.strain = Mode::ALL.map(|m| strain(m, BasisKind::NodalLinear)).to_vec();
    let (q, events) = solve::<SE3, 6, 3>(&d, &loads);
    assert_eq!(events, 0);
    for (i, kappa) in q.iter().enumerate() {
        let expected = if (9..18).contains(&i) { 2.0 * std::f64::consts::PI } else { 0.0 };
        assert!((kappa - expected).abs() < 1e-6, "{i}: {kappa}");
    }
}

/// A transverse follower force F: with s from the tip, EI θ'' = −F cos(θ_tip − θ), and the tip's
/// angle follows from an initial value problem that starts at the tip with θ' = 0.
#[test]
fn transverse_follower_force() {
    let force = 4.0 * bending_stiffness() / (LENGTH * LENGTH);
    let loads: Vec<f64> = (0..=5).map(|i| force * f64::from(i) / 5.0).collect();
    let d = cantilever(true, [0.0, 0.0, -1.0], [0.0; 3], WrenchFrame::Body);
    let (q, _) = solve::<SE2, 3, 2>(&d, &loads);
    // φ = θ_tip − θ(s): φ'' = (F/EI) cos φ, φ(0) = φ'(0) = 0; φ at the clamp is the tip's angle.
    let (mut phi, mut rate) = (0.0f64, 0.0f64);
    let steps = 20_000;
    let h = LENGTH / f64::from(steps);
    let c = force / bending_stiffness();
    for _ in 0..steps {
        // Leapfrog would do; classical Runge–Kutta leaves no doubt.
        let f = |p: f64, r: f64| (r, c * p.cos());
        let (a1, b1) = f(phi, rate);
        let (a2, b2) = f(phi + 0.5 * h * a1, rate + 0.5 * h * b1);
        let (a3, b3) = f(phi + 0.5 * h * a2, rate + 0.5 * h * b2);
        let (a4, b4) = f(phi + h * a3, rate + h * b3);
        phi += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        rate += h / 6.0 * (b1 + 2.0 * b2 + 2.0 * b3 + b4);
    }
    let model = Model::<SE2, 3, 2>::new(&d).unwrap();
    let mut data = flexor_engine::Data::new(&model);
    data.evaluate(&model, &q, &[force]);
    let pose = data.poses().last().unwrap().to_homogeneous();
    let angle = pose[0][2].atan2(pose[0][0]);
    assert!(phi > 1.0, "the test should bend the beam: {phi}");
    assert!((angle - phi).abs() < 1e-6, "{angle} {phi}");
}
