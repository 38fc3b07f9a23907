//! The predictor against equilibria found independently.

use super::vector::norm;
use super::{Continuation, ContinuationOptions, Status};
use crate::ContactForce;
use crate::lie::SE2;
use crate::model::Model;
use crate::model::{AttachmentDescription, SpringDescription, Station};
use crate::systems::finger;

type Planar<'m> = Continuation<'m, SE2, 3, 2>;

/// Finds an equilibrium at `load` near the current state; returns the contacts.
fn go_to(path: &mut Planar, load: f64) -> Vec<(usize, Option<[usize; 2]>)> {
    path.system.set_load(&[load]);
    assert_eq!(path.find_stable(0.1, 0.0), Status::Converged);
    path.system.velocity(&[1.0], &mut path.velocity[0]);
    let of = |force: ContactForce<2>| (force.first, force.second);
    path.system.data().contact_forces(path.system.model()).into_iter().map(of).collect()
}

fn predict(path: &mut Planar, h: f64) {
    path.predictor.predict(&mut path.system, &path.velocity[0], h, 4.0);
}

#[test]
fn the_velocity_behind_a_change_of_contact_is_predicted() {
    let model = Model::<SE2, 3, 2>::new(&finger()).unwrap();
    let mut path = Planar::new(&model, ContinuationOptions::default(), None);
    let (mut closed, mut opened) = (0, 0);
    let mut touching = go_to(&mut path, 0.0);
    for k in 1..=800 {
        let (mut low, mut high) = (0.01 * (k - 1) as f64, 0.01 * k as f64);
        let mut before = path.clone();
        let found = go_to(&mut path, high);
        let changed = touching.len().abs_diff(found.len());
        if changed == 1 {
            let mut after = path.clone();
            while high - low > 1e-7 {
                let middle = 0.5 * (low + high);
                let mut between = before.clone();
                if go_to(&mut between, middle) == touching {
                    (low, before) = (middle, between);
                } else {
                    (high, after) = (middle, between);
                }
            }
            let [old, new] = [&before, &after].map(|s| s.velocity[0].clone());
            let turn = old.iter().zip(&new).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            assert!(turn > 1e-3 * norm(&old), "the change shows");
            predict(&mut before, 1e-5);
            let ahead = &before.predictor;
            let changes = ahead.change_points();
            assert_eq!(changes.len(), 1, "one change at {low} N");
            assert!(changes[0] < 1e-6, "the change is {} N ahead", changes[0]);
            let expected: Vec<f64> = ahead.velocity(1e-5).collect();
            let error = expected.iter().zip(&new).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            assert!(error < 1e-3 * turn, "{error} of {turn} at {low} N");
            let mut moved = vec![0.0; model.dof()];
            ahead.displacement(1e-5, &mut moved);
            let short = changes[0];
            for ((m, v), w) in moved.iter().zip(&old).zip(&expected) {
                assert!((m - (short * v + (1e-5 - short) * w)).abs() < 1e-12);
            }
            if found.len() > touching.len() { closed += 1 } else { opened += 1 }
        }
        touching = found;
    }
    assert!(closed >= 2 && opened >= 1, "{closed} contacts closed, {opened} opened");
}

#[test]
fn a_slack_spring_that_becomes_taut_is_predicted_with_the_velocity_behind() {
    let mut described = finger();
    described.contacts.clear();
    described.springs.push(SpringDescription {
        name: "strap".into(),
        first: AttachmentDescription::Body {
            body: "exosuit".into(),
            station: Station::Point(20),
            offset: [0.0; 3],
            surface: [0.0; 3],
        },
        second: AttachmentDescription::World { world: [0.06, 0.0, 0.06] },
        stiffness: 3000.0,
        rest_length: 0.029,
        slack: true,
    });
    let model = Model::<SE2, 3, 2>::new(&described).unwrap();
    let mut path = Planar::new(&model, ContinuationOptions::default(), None);
    let tension = |path: &Planar| {
        let mut tension = [0.0];
        path.system.data().spring_tensions(&model, &mut tension);
        tension[0]
    };
    go_to(&mut path, 0.0);
    assert_eq!(tension(&path), 0.0);
    let mut before = path.clone();
    let (mut low, mut high) = (0.0, 5.0);
    let mut after = path.clone();
    while high - low > 1e-7 {
        let middle = 0.5 * (low + high);
        let mut between = before.clone();
        go_to(&mut between, middle);
        if tension(&between) == 0.0 {
            (low, before) = (middle, between);
        } else {
            (high, after) = (middle, between);
        }
    }
    assert!(0.0 < low && low < 4.9, "taut at {low} N");
    let [old, new] = [&before, &after].map(|s| s.velocity[0].clone());
    predict(&mut before, 1e-5);
    let changes = before.predictor.change_points();
    assert_eq!(changes.len(), 1);
    assert!(changes[0] < 1e-6, "taut after {} N", changes[0]);
    let expected: Vec<f64> = before.predictor.velocity(1e-5).collect();
    let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    assert!(apart(&expected, &new) < 1e-3 * apart(&old, &new), "{}", apart(&expected, &new));
}

#[test]
fn a_curvature_is_learnt_and_goes_on() {
    let model = Model::<SE2, 3, 2>::new(&finger()).unwrap();
    let mut path = Planar::new(&model, ContinuationOptions::default(), None);
    let h = 0.02;
    let (mut curved, mut straight, mut seen) = (0.0, 0.0, 0);
    let mut touching = go_to(&mut path, 0.0);
    let mut moved = vec![0.0; model.dof()];
    for k in 1..=400 {
        let start = path.system.state().to_vec();
        predict(&mut path, h);
        let found = go_to(&mut path, h * k as f64);
        path.system.displacement(&start, &mut moved);
        path.predictor.learn_curvature(h, &moved, &path.velocity[0]);
        let mut next = path.clone();
        let known = norm(path.predictor.curvature()) > 0.0;
        if go_to(&mut next, h * (k + 1) as f64) == found && found == touching && known {
            let mut ahead = path.clone();
            predict(&mut ahead, h);
            next.system.displacement(path.system.state(), &mut moved);
            let missed = |ahead: &Planar| {
                let mut predicted = vec![0.0; model.dof()];
                ahead.predictor.displacement(h, &mut predicted);
                moved.iter().zip(predicted).map(|(m, d)| (m - d).powi(2)).sum::<f64>().sqrt()
            };
            curved += missed(&ahead);
            ahead.predictor.rescale_curvature(0.0);
            straight += missed(&ahead);
            seen += 1;
        }
        touching = found;
    }
    assert!(seen > 200, "only {seen} steps are smooth");
    assert!(curved < 0.1 * straight, "{curved} of {straight}");
}
