//! Solves end when they are asked to and when their time is up.

use crate::systems::finger;
use flexor_engine::equilibrium::{Cancel, ContinuationOptions, Status};
use flexor_engine::lie::SE2;
use flexor_engine::model::Model;
use flexor_engine::{Batch, PathResults};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

fn solve(designs: usize, options: ContinuationOptions, cancel: Option<&AtomicBool>) -> PathResults {
    let model = Model::<SE2, 3, 2>::new(&finger()).unwrap();
    let batch = Batch {
        base: model.parameters(),
        varied: &[],
        values: &[],
        designs,
        loads: &[0.0, 5.0],
        steps: 2,
        cancel: cancel.map(|flag| flag as &dyn Cancel),
        start: None,
        slips: &[],
    };
    model.solve_batch(batch, options, 2)
}

fn count(result: &PathResults, status: Status) -> usize {
    result.status.iter().filter(|code| **code == status as u8).count()
}

#[test]
fn a_batch_is_cancelled() {
    let cancel = AtomicBool::new(false);
    let result = std::thread::scope(|scope| {
        let batch = scope.spawn(|| solve(100_000, ContinuationOptions::default(), Some(&cancel)));
        std::thread::sleep(Duration::from_millis(50));
        let asked = Instant::now();
        cancel.store(true, Ordering::Relaxed);
        let result = batch.join().unwrap();
        assert!(asked.elapsed() < Duration::from_secs(5));
        result
    });
    assert!(count(&result, Status::Cancelled) > 100_000);
    let kinds = [Status::Converged, Status::Cancelled, Status::NotReached];
    assert_eq!(kinds.map(|kind| count(&result, kind)).iter().sum::<usize>(), 200_000);
}

#[test]
fn a_path_is_cancelled() {
    let model = Model::<SE2, 3, 2>::new(&finger()).unwrap();
    let cancel = AtomicBool::new(true);
    let q = vec![0.0; model.dof()];
    let loads: [&[f64]; 2] = [&[0.0], &[5.0]];
    let options = ContinuationOptions::default();
    let branch = model.follow_branch(model.parameters(), &loads, &q, options, Some(&cancel)).unwrap();
    assert_eq!(branch.results.status.last(), Some(&(Status::Cancelled as u8)));
}

#[test]
fn a_step_has_its_time() {
    let result = solve(1, ContinuationOptions { max_seconds: 1e-9, ..Default::default() }, None);
    assert_eq!(result.status, [Status::TimeLimit as u8, Status::NotReached as u8]);
    let result = solve(1, ContinuationOptions { max_seconds: 60.0, ..Default::default() }, None);
    assert_eq!(count(&result, Status::Converged), 2);
}
