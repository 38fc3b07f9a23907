//! Residuals and tip poses computed with the public MATLAB toolbox SoRoSim: ≤ 1e-9 relative.
//!
//! The toolbox's `Equilibrium` cuts exp(Ω̂) after Ω̂³/6 for θ ≤ 1e-2 (its forward kinematics does
//! not), which moves its residuals in contact by up to 4e-8 of the largest. The engine is therefore
//! compared twice: with the cut repeated, to 1e-9, and as it is, to 1e-7.

use crate::systems;
use crate::toolbox::Toolbox;
use flexor_engine::Data;
use flexor_engine::lie::{LieGroup, SE2, SE3};
use flexor_engine::model::{Description, Model};
use serde_json::Value;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn compare<G: LieGroup<D, P>, const D: usize, const P: usize>(
    description: &Description,
    file: &str,
    sign: f64,
    tip: &str,
) {
    let path = format!("{}/../tests/reference/{file}", env!("CARGO_MANIFEST_DIR"));
    let reference: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let model = Model::<G, D, P>::new(description).unwrap();
    let mut data = Data::new(&model);
    let cut_model = Model::<Toolbox<G>, D, P>::new(description).unwrap();
    let mut cut = Data::new(&cut_model);
    let tip = model.frame_names().iter().position(|n| n == tip).unwrap();
    let cases = reference["q"].as_array().unwrap().len();
    assert!(cases >= 6);
    for case in 0..cases {
        let q = numbers(&reference["q"][case]);
        let u = sign * reference["u"][case][0].as_f64().unwrap();
        data.evaluate(&model, &q, &[u]);
        let expected = numbers(&reference["residual"][case]);
        let size = expected.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        cut.evaluate(&cut_model, &q, &[u]);
        for (residual, tolerance) in [(cut.residual(), 1e-9), (data.residual(), 1e-7)] {
            for (i, (found, expected)) in residual.iter().zip(&expected).enumerate() {
                let error = (found - expected).abs();
                assert!(error <= tolerance * size, "{file} case {case} residual {i}: {found} {expected}");
            }
        }
        let pose = data.poses()[tip].to_homogeneous();
        let expected = numbers(&reference["rod_tip_g_colmajor3x4"][case]);
        for (m, expected) in expected.iter().enumerate() {
            let found = pose[m % 3][m / 3];
            assert!((found - expected).abs() <= 1e-9, "{file} case {case} pose {m}: {found} {expected}");
        }
        if let Some(pairs) = reference.get("touching_pairs") {
            assert_eq!(data.contact_forces(&model).len() as u64, pairs[case][0].as_u64().unwrap());
        }
    }
}

#[test]
fn planar_finger_and_exosuit() {
    compare::<SE2, 3, 2>(&systems::finger(), "sorosim_finger.json", 1.0, "exosuit[40]");
}

#[test]
fn planar_finger_and_exosuit_as_a_spatial_system() {
    let mut description = systems::finger();
    description.planar = false;
    compare::<SE3, 6, 3>(&description, "sorosim_finger.json", 1.0, "exosuit[40]");
}

#[test]
fn spatial_rod_with_tendon_and_gravity() {
    compare::<SE3, 6, 3>(&systems::tendon_rod(), "sorosim_spatial.json", -1.0, "arm[15]");
}
