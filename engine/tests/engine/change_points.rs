//! Four-bar linkages at their change points, where all bars are in line and two motions cross: whatever the
//! steps and the size, the path ends there and never goes on along the other motion unnoticed.

use crate::systems::{body, empty, joint};
use flexor_engine::equilibrium::{ContinuationOptions, Status};
use flexor_engine::lie::SE2;
use flexor_engine::model::*;
use flexor_engine::{Batch, PathResults};

/// Numbers from 0 to 1 without a pattern (a linear congruential generator).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// Crank, coupler, rocker and ground with the angles of the first three in the reference state, measured
/// against the rotation of the motor.
fn linkage([a, b, c, d]: [f64; 4], angles: [f64; 3]) -> Description {
    let mut model = empty(true);
    let mut add =
        |name: &str, parent: Option<&str>, x: f64, turn: f64, length: f64, joint: JointDescription| {
            let link = LinkDescription { length, radius_base: 0.02 * d, radius_tip: 0.02 * d, density: 0.0 };
            let mut bar = body(name, parent, [x, 0.0, 0.0], joint, ShapeDescription::Link(link));
            bar.placement.rotation = [0.0, turn, 0.0];
            model.bodies.push(bar);
        };
    let sprung = |kind, stiffness: Vec<f64>| JointDescription { stiffness, ..joint(kind) };
    let [crank, coupler, rocker] = angles;
    add("crank", None, 0.0, -crank, a, sprung(JointKind::Free, vec![0.0; 3]));
    add("coupler", Some("crank"), 0.0, crank - coupler, b, sprung(JointKind::Revolute, vec![0.0]));
    add("rocker", None, d, -rocker, c, sprung(JointKind::Revolute, vec![0.05]));
    let on = |name: &str, fraction: f64| AttachmentDescription::Body {
        body: name.into(),
        station: Station::Fraction(fraction),
        offset: [0.0; 3],
        surface: [0.0; 3],
    };
    let tie = |name: &str, kind, first, second, drive| TieDescription {
        name: name.into(),
        kind,
        first,
        second,
        axis: [0.0, 1.0, 0.0],
        rotation: [0.0; 3],
        drive,
    };
    let ground = AttachmentDescription::World { world: [0.0; 3] };
    model.ties.push(tie("motor", TieKind::Hinge, ground, on("crank", 0.0), Some(TieDrive::Rotation)));
    model.ties.push(tie("loop", TieKind::Pin, on("coupler", 1.0), on("rocker", 1.0), None));
    model
}

/// Angles of coupler and rocker for one of the crank, the rocker's on one side.
fn closed([a, b, c, d]: [f64; 4], crank: f64, side: f64) -> [f64; 3] {
    let (x, z) = (a * crank.cos() - d, a * crank.sin());
    let diagonal = x.hypot(z);
    let cosine = (c * c + diagonal * diagonal - b * b) / (2.0 * c * diagonal);
    let rocker = z.atan2(x) + side * cosine.clamp(-1.0, 1.0).acos();
    let coupler = (c * rocker.sin() - z).atan2(c * rocker.cos() - x);
    [crank, coupler, rocker]
}

fn path(description: &Description, loads: &[f64]) -> PathResults {
    let model = Model::<SE2, 3, 2>::new(description).unwrap();
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
    model.solve_batch(batch, ContinuationOptions::default(), 1)
}

/// Lists of loads that cross a change point at `end` [rad]: regular ones, some around it, some very near it.
fn lists(end: f64, numbers: &mut Numbers) -> Vec<Vec<f64>> {
    let degree = 1f64.to_radians();
    let (off, near) = (numbers.between(1.0, 5.0) * degree, 10f64.powf(numbers.between(-4.0, -1.0)) * degree);
    let steps = |step: f64| {
        let count = (end / step).floor() as usize + 3;
        (0..count).map(|i| step * i as f64).collect::<Vec<_>>()
    };
    let around = (0..4).map(|i| end + degree * (4.0 * f64::from(i) - 10.0)).collect();
    vec![
        steps(4.0 * degree),
        vec![0.0, end - off, end + off],
        vec![0.0, end - near, end + near, end + off],
        vec![end - 10.0 * degree, end - off, end + 0.5 * off, end + 30.0 * degree],
        around,
    ]
}

fn stops_at_change_points(mut make: impl FnMut(&mut Numbers) -> ([f64; 4], [f64; 3], f64), seed: u64) {
    let mut numbers = Numbers(seed);
    for k in 0..CASES {
        let (bars, angles, end) = make(&mut numbers);
        let description = linkage(bars, angles);
        for loads in lists(end, &mut numbers) {
            let found = path(&description, &loads);
            let beyond = loads.iter().position(|load| *load > end).unwrap();
            let said = format!("{k}: {bars:?}, {end}, {loads:?}: {:?}", found.status);
            assert_eq!(found.status[beyond], Status::Singular as u8, "{said}");
            assert!(found.status[..beyond].iter().all(|s| *s == Status::Converged as u8), "{said}");
            let reached = found.applied[beyond];
            assert!((reached - end).abs() < 1e-4, "{said}: {reached}");
        }
    }
}

const CASES: usize = 5;

fn bars(numbers: &mut Numbers) -> (f64, f64, f64) {
    let size = 10f64.powf(numbers.between(-3.0, 3.0));
    let (x, y) = (numbers.between(0.2, 1.0), numbers.between(0.2, 1.0));
    let (short, long) = (x.min(y), x.max(y).max(x.min(y) + 0.05));
    (short, long, size)
}

#[test]
fn parallelograms_and_antiparallelograms_stop_at_their_change_points() {
    for crossed in [false, true] {
        let make = |numbers: &mut Numbers| {
            let (a, d, size) = bars(numbers);
            let crank = numbers.between(20.0, 120.0).to_radians();
            let bars = [a, d, a, d].map(|x| x * size);
            // tan of half the rocker's angle to that of the crank's.
            let ratio = if crossed { -(d + a) / (d - a) } else { 1.0 };
            let rocker = 2.0 * (ratio * (0.5 * crank).tan()).atan();
            let (x, z) = (d + a * (rocker.cos() - crank.cos()), a * (rocker.sin() - crank.sin()));
            (bars, [crank, z.atan2(x), rocker], crank)
        };
        stops_at_change_points(make, 1 + u64::from(crossed));
    }
}

#[test]
fn linkages_whose_bars_fit_on_one_another_stop_at_their_change_point() {
    let make = |numbers: &mut Numbers| {
        let (a, d, size) = bars(numbers);
        // The crank is in line with the ground beyond its joint: a + d = b + c.
        let b = numbers.between(a, d);
        let bars = [a, b, a + d - b, d];
        let turn = numbers.between(20.0, 100.0).to_radians();
        let side = if numbers.next() < 0.5 { 1.0 } else { -1.0 };
        let angles = closed(bars, turn - std::f64::consts::PI, side);
        (bars.map(|x| x * size), angles, turn)
    };
    stops_at_change_points(make, 3);
}
