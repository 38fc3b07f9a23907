//! Paths do not depend on loads that do nothing.

use crate::systems::{body, finger, joint, rod, strain};
use flexor_engine::equilibrium::{ContinuationOptions, Status};
use flexor_engine::lie::SE2;
use flexor_engine::model::*;
use flexor_engine::strain::{BasisKind, Mode};
use flexor_engine::{Batch, Data, PathResults};

/// The finger, with a second, unrelated rod and its chamber.
fn finger_and_brick() -> Description {
    let mut d = finger();
    let shape = rod(0.1, [0.05, 0.05], vec![strain(Mode::ExtendX, BasisKind::NodalLinear)], 1, 2);
    let points = shape.radius.len();
    let shape = ShapeDescription::Rod(RodDescription { young_modulus: 2e11, ..shape });
    d.bodies.push(body("brick", None, [-1.0, 0.0, 0.0], joint(JointKind::Fixed), shape));
    d.actuators.push(ActuatorDescription {
        name: "other".into(),
        rod: "brick".into(),
        path: vec![[0.0; 2]; points],
        path_slope: vec![[0.0; 2]; points],
        ..d.actuators[0].clone()
    });
    d
}

fn solve(model: &Model<SE2, 3, 2>, young_modulus: f64, held: f64) -> PathResults {
    let slot = model.layout().get("exosuit.young_modulus").unwrap();
    let loads: Vec<f64> = (0..=5).flat_map(|step| [f64::from(step), held]).collect();
    let batch = Batch {
        base: model.parameters(),
        varied: &[slot.start],
        values: &[young_modulus],
        designs: 1,
        loads: &loads,
        steps: 6,
        cancel: None,
        start: None,
        slips: &[],
    };
    model.solve_batch(batch, ContinuationOptions::default(), 1)
}

#[test]
fn what_another_input_is_held_at_changes_nothing() {
    let model = Model::<SE2, 3, 2>::new(&finger_and_brick()).unwrap();
    let n = finger_dof();
    let mut snaps = 0;
    for k in 0..8 {
        let young_modulus = 3e4 * 2f64.powi(k);
        let free = solve(&model, young_modulus, 0.0);
        assert!(free.status.iter().all(|s| *s == Status::Converged as u8));
        snaps += free.events.len();
        for held in [100.0, 1e4] {
            let other = solve(&model, young_modulus, held);
            assert_eq!(free.events.len(), other.events.len(), "E = {young_modulus}, held at {held}");
            for (a, b) in free.q.chunks(model.dof()).zip(other.q.chunks(model.dof())) {
                for (a, b) in a[..n].iter().zip(&b[..n]) {
                    assert!((a - b).abs() < 1e-9, "E = {young_modulus}, held at {held}: {a} {b}");
                }
            }
        }
    }
    assert!(snaps > 0, "some of the designs snap");
}

fn finger_dof() -> usize {
    Model::<SE2, 3, 2>::new(&finger()).unwrap().dof()
}

#[test]
fn one_input_drives_several_forces() {
    let separate = finger_and_brick();
    let mut shared = separate.clone();
    let drives = shared.actuators.iter().map(|actuator| actuator.name.clone()).collect();
    shared.shared_inputs.push(SharedInputDescription { name: "air".into(), drives });
    let [separate, shared] = [separate, shared].map(|d| Model::<SE2, 3, 2>::new(&d).unwrap());
    assert_eq!(shared.inputs(), ["air"]);
    let q: Vec<f64> = (0..shared.dof()).map(|i| 0.1 * (i as f64).sin()).collect();
    let [mut one, mut two] = [Data::new(&shared), Data::new(&separate)];
    one.evaluate(&shared, &q, &[3.0]);
    two.evaluate(&separate, &q, &[3.0, 3.0]);
    assert_eq!(one.residual(), two.residual());
    assert_eq!(one.tangent(), two.tangent());
    // One that holds a conjugate has an input of its own.
    let mut held = finger_and_brick();
    held.controls.push("other".into());
    assert!(Model::<SE2, 3, 2>::new(&held).is_ok());
    held.shared_inputs.push(SharedInputDescription { name: "air".into(), drives: vec!["other".into()] });
    assert!(Model::<SE2, 3, 2>::new(&held).is_err());
}
