//! Equilibria of the default design found with the public MATLAB toolbox SoRoSim: ≤ 1e-7 rad.

use crate::systems;
use flexor_engine::Batch;
use flexor_engine::equilibrium::{ContinuationOptions, Status};
use flexor_engine::lie::SE2;
use flexor_engine::model::Model;

#[test]
fn joint_angles_of_the_default_design() {
    let path = format!("{}/../tests/reference/sorosim_static.csv", env!("CARGO_MANIFEST_DIR"));
    let table: Vec<Vec<f64>> = std::fs::read_to_string(path)
        .unwrap()
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|x| x.parse().unwrap()).collect())
        .collect();
    let model = Model::<SE2, 3, 2>::new(&systems::finger()).unwrap();
    let loads: Vec<f64> = table.iter().map(|row| row[3]).collect();
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
    assert!(result.events.is_empty());
    for (step, row) in table.iter().enumerate() {
        assert_eq!(result.status[step], Status::Converged as u8);
        let q = &result.q[step * model.dof()..(step + 1) * model.dof()];
        for (found, expected) in q[22..].iter().zip(&row[4..7]) {
            assert!((found - expected).abs() < 1e-7, "{found} {expected} at {} N", row[3]);
        }
    }
    println!("{:?}", result.iterations);
}
