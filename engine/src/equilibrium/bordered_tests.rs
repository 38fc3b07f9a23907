//! The bordered solver against prescribed loads, differences and a penalty.

use super::bordered::{Border, Bordered, BorderedTarget, Constraint, Multiplier};
use super::{Continuation, ContinuationOptions};
use crate::lie::SE2;
use crate::model::Model;
use crate::sensitivity::Adjoint;
use crate::systems::finger;
use nalgebra::{DMatrix, SymmetricEigen};

type Planar<'m> = Continuation<'m, SE2, 3, 2>;

const TARGET: BorderedTarget = BorderedTarget { tolerance: 1e-10, small_step: 1e-9, max_iterations: 60 };

/// One coordinate has a value.
struct Held(usize, f64);

impl Constraint for Held {
    fn value(&self, q: &[f64], _multiplier: f64) -> f64 {
        q[self.0] - self.1
    }

    fn gradient(&self, _q: &[f64], _multiplier: f64, out: &mut [f64]) -> f64 {
        out.fill(0.0);
        out[self.0] = 1.0;
        0.0
    }
}

/// The sum of squares of some coordinates has a value.
struct Sphere(Vec<usize>, f64);

impl Constraint for Sphere {
    fn value(&self, q: &[f64], _multiplier: f64) -> f64 {
        self.0.iter().map(|i| q[*i] * q[*i]).sum::<f64>() - self.1 * self.1
    }

    fn gradient(&self, q: &[f64], _multiplier: f64, out: &mut [f64]) -> f64 {
        out.fill(0.0);
        self.0.iter().for_each(|i| out[*i] = 2.0 * q[*i]);
        0.0
    }

    fn add_hessian_product(&self, _q: &[f64], v: &[f64], factor: f64, out: &mut [f64]) {
        self.0.iter().for_each(|i| out[*i] += 2.0 * factor * v[*i]);
    }
}

fn solver(model: &Model<SE2, 3, 2>) -> (Planar<'_>, Bordered) {
    let bordered = Bordered::new(model.dof(), 1, 1);
    (Planar::new(model, ContinuationOptions::default(), None), bordered)
}

/// A material, a joint, a contact and two lengths.
fn some_parameters(model: &Model<SE2, 3, 2>) -> Vec<usize> {
    let wanted = [
        "exosuit.young_modulus",
        "ph_2.joint_stiffness",
        "contact.stiffness",
        "exosuit.radius",
        "exosuit.length",
    ];
    // The first radius is an element's end, where nothing depends on it.
    let second = |range: std::ops::Range<usize>| range.start + 1.min(range.len() - 1);
    wanted.into_iter().map(|name| second(model.layout().get(name).unwrap())).collect()
}

#[test]
fn a_load_that_reaches_a_posture_is_found_with_its_derivatives() {
    let model = Model::<SE2, 3, 2>::new(&finger()).unwrap();
    let joint = model.joints[0].dof;
    let (mut path, mut bordered) = solver(&model);
    // The exosuit pushes the finger.
    path.system.set_load(&[6.0]);
    path.find_stable(1.0, 0.0);
    let (reached, exact) = (path.system.state()[joint], path.system.state().to_vec());

    let mut solve = |parameters: &[f64], bordered: &mut Bordered| {
        path.set_parameters(parameters);
        let held = Held(joint, reached);
        let border = Border { constraint: &held, multiplier: Multiplier::Load(&[1.0]) };
        let mut started = exact.clone();
        started[joint] *= 0.98;
        path.system.set_state(&started);
        bordered.multipliers[0] = 5.9;
        assert!(bordered.solve(&mut path.system, &[border], TARGET));
        let mut by_state = vec![0.0; model.dof()];
        // The output is the load.
        let mut by_multiplier = [1.0];
        assert!(bordered.solve_adjoint(&path.system, &[border], &mut by_state, &mut by_multiplier));
        let wanted = some_parameters(&model);
        let (system, load) = (&path.system, [bordered.multipliers[0]]);
        let mut adjoint = Adjoint::new(&model, &wanted);
        let work = adjoint.virtual_work_gradient(&model, system.data(), system.state(), &load, &by_state);
        let gradient: Vec<f64> = wanted.iter().map(|p| -work[*p]).collect();
        assert_eq!(bordered.negative_directions(true, &[border]), Some(0));
        (bordered.multipliers[0], system.state().to_vec(), gradient)
    };
    let base = model.parameters().to_vec();
    let (load, state, gradient) = solve(&base, &mut bordered);
    assert!((load - 6.0).abs() < 1e-7, "{load}");
    assert!(state.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-8));
    for (p, derivative) in some_parameters(&model).into_iter().zip(gradient) {
        let h = 1e-5 * base[p];
        let [up, down] = [h, -h].map(|h| {
            let mut varied = base.clone();
            varied[p] += h;
            solve(&varied, &mut bordered).0
        });
        let difference = (up - down) / (2.0 * h);
        assert!(
            (derivative - difference).abs() < 1e-5 * difference.abs().max(1e-9),
            "{derivative} {difference}"
        );
        assert!(difference != 0.0);
    }
}

#[test]
fn a_reaction_is_the_slope_of_the_energy() {
    let model = Model::<SE2, 3, 2>::new(&finger()).unwrap();
    let joints: Vec<usize> = model.joints.iter().map(|joint| joint.dof).collect();
    let (mut path, mut bordered) = solver(&model);
    path.system.set_load(&[6.0]);
    path.find_stable(1.0, 0.0);
    let start = path.system.state().to_vec();
    let radius = joints.iter().map(|j| start[*j].powi(2)).sum::<f64>().sqrt();
    let mut solve = |radius: f64| {
        let sphere = Sphere(joints.clone(), radius);
        let border = Border { constraint: &sphere, multiplier: Multiplier::Reaction };
        path.system.set_state(&start);
        bordered.multipliers[0] = 0.0;
        bordered.set_base_load(&[6.0]);
        assert!(bordered.solve(&mut path.system, &[border], TARGET));
        let negative = bordered.negative_directions(true, &[border]);
        (path.system.data().energy(), bordered.multipliers[0], negative)
    };
    let (_, none, _) = solve(radius);
    assert!(none.abs() < 1e-9, "nothing to hold: {none}");
    for stretched in [0.9, 1.1] {
        let (r, h) = (stretched * radius, 1e-5);
        let (_, reaction, negative) = solve(r);
        let slope = (solve(r + h).0 - solve(r - h).0) / (2.0 * h);
        // dΠ/dρ = μ ∂c/∂ρ = −2ρ μ.
        assert!((slope + 2.0 * r * reaction).abs() < 1e-6 * slope.abs(), "{slope} {reaction}");
        assert_eq!(negative, Some(0));
    }
}

#[test]
fn constrained_eigenvalues_have_the_signs_that_a_penalty_gives() {
    let model = Model::<SE2, 3, 2>::new(&finger()).unwrap();
    let joints: Vec<usize> = model.joints.iter().map(|joint| joint.dof).collect();
    let (mut path, mut bordered) = solver(&model);
    let n = model.dof();
    let mut seen = [false; 3];
    for k in 0..40 {
        let wave = |i: usize| 0.4 * ((i + 1) as f64 * (1.3 + 0.37 * k as f64)).sin();
        let q: Vec<f64> = (0..n).map(|i| if joints.contains(&i) { wave(i) } else { 0.1 * wave(i) }).collect();
        path.system.set_state(&q);
        let sphere = Sphere(joints.clone(), 0.5);
        let border = Border { constraint: &sphere, multiplier: Multiplier::Reaction };
        bordered.multipliers[0] = 0.1 * wave(k);
        bordered.set_base_load(&[1.0]);
        bordered.visit(&mut path.system, &[border]);
        let counted = bordered.negative_directions(true, &[border]).unwrap();

        let (units, energy) = (path.system.units(), path.system.unit_energy());
        let mut gradient = vec![0.0; n];
        sphere.gradient(&q, 0.0, &mut gradient);
        let tangent = path.system.data().tangent();
        let penalised = DMatrix::from_fn(n, n, |i, j| {
            let curvature = if i == j && joints.contains(&i) { 2.0 * bordered.multipliers[0] } else { 0.0 };
            let held = 1e9 * energy * gradient[i] * gradient[j];
            (tangent[i * n + j] + curvature + held) * units[i] * units[j] / energy
        });
        let eigenvalues = SymmetricEigen::new(penalised).eigenvalues;
        assert_eq!(counted, eigenvalues.iter().filter(|e| **e < 0.0).count(), "state {k}");
        seen[counted.min(2)] = true;
    }
    assert!(seen[0] && (seen[1] || seen[2]), "{seen:?}");
}
