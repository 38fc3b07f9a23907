//! Derivatives with respect to every parameter of random systems, against differences.

use crate::systems::{body, empty, joint};
use crate::trees::{planar_trees, solids, spatial_trees};
use flexor_engine::Data;
use flexor_engine::lie::{LieGroup, SE2, SE3};
use flexor_engine::model::*;
use flexor_engine::sensitivity::Adjoint;
use proptest::prelude::*;

/// λᵀ ∂g/∂p at a held state against sixth-order differences of λᵀg.
fn check<G: LieGroup<D, P>, const D: usize, const P: usize>(
    description: &Description,
    state: &[f64],
    load: &[f64],
) -> Result<(), TestCaseError> {
    let model = Model::<G, D, P>::new(description).unwrap();
    let n = model.dof();
    let load = &load[..model.inputs().len()];
    let q: Vec<f64> = (0..n).map(|i| 0.25 * state[i % state.len()]).collect();
    let lambda: Vec<f64> = (0..n).map(|i| state[(7 * i + 3) % state.len()]).collect();
    let p = model.parameters().to_vec();
    let all: Vec<usize> = (0..p.len()).collect();
    let mut data = Data::new(&model);
    let mut adjoint = Adjoint::new(&model, &all);
    data.evaluate(&model, &q, load);
    let exact = adjoint.virtual_work_gradient(&model, &data, &q, load, &lambda).to_vec();
    let size = exact.iter().zip(&p).fold(0.0f64, |m, (g, p)| m.max((g * p).abs()));
    for (name, range) in model.layout().iter() {
        for i in range {
            // A planar system has no third direction to move in.
            let whole = model.layout().get(name).unwrap();
            if D == 3 && whole.len() == 3 {
                let along =
                    ["translation", "offset", "force", "gravity"].iter().any(|end| name.ends_with(end));
                let about = ["rotation", "moment"].iter().any(|end| name.ends_with(end));
                let across = i - whole.start == 1;
                if along && across || about && !across {
                    continue;
                }
            }
            let h = 1e-5 * if p[i] == 0.0 { 0.1 } else { p[i].abs() };
            let mut difference = 0.0;
            let mut touching = None;
            let mut smooth = true;
            for (step, weight) in [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)] {
                for sign in [-1.0, 1.0] {
                    let mut moved = p.clone();
                    moved[i] += sign * step * h;
                    data.set_parameters(&model, &moved);
                    data.evaluate(&model, &q, load);
                    let pairs: Vec<_> =
                        data.contact_forces(&model).iter().map(|t| (t.first, t.second)).collect();
                    smooth &= touching.replace(pairs.clone()).is_none_or(|t| t == pairs);
                    let work: f64 = data.residual().iter().zip(&lambda).map(|(r, l)| r * l).sum();
                    difference += sign * weight * work / (60.0 * h);
                }
            }
            let scale = size / if p[i] == 0.0 { 1.0 } else { p[i].abs() };
            let error = (difference - exact[i]).abs();
            prop_assert!(!smooth || error <= 1e-7 * scale, "{name}[{i}]: {difference} {}", exact[i]);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn spatial(
        state in prop::collection::vec(-1.0..1.0f64, 97),
        tree in spatial_trees(),
        load in prop::collection::vec(-1.0..2.0f64, 5),
    ) {
        check::<SE3, 6, 3>(&tree, &state, &load)?;
    }

    #[test]
    fn round_cones(state in prop::collection::vec(-1.0..1.0f64, 41)) {
        check::<SE3, 6, 3>(&solids(), &state, &[])?;
    }

    #[test]
    fn planar(
        state in prop::collection::vec(-1.0..1.0f64, 53),
        tree in planar_trees(),
        load in prop::collection::vec(-1.0..2.0f64, 5),
    ) {
        check::<SE2, 3, 2>(&tree, &state, &load)?;
    }
}

/// A spring of zero rest length pulls with −k r also where its ends coincide.
#[test]
fn spring_of_zero_rest_length_with_coincident_ends() {
    fn check<G: LieGroup<D, P>, const D: usize, const P: usize>() {
        let mut d = empty(D == 3);
        let link = LinkDescription { length: 0.1, radius_base: 0.01, radius_tip: 0.01, density: 0.0 };
        d.bodies.push(body("ball", None, [0.0; 3], joint(JointKind::Free), ShapeDescription::Link(link)));
        let station = Station::Fraction(1.0);
        d.springs.push(SpringDescription {
            name: "pull".into(),
            first: AttachmentDescription::Body {
                body: "ball".into(),
                station,
                offset: [0.0; 3],
                surface: [0.0; 3],
            },
            second: AttachmentDescription::World { world: [0.1, 0.0, 0.0] },
            stiffness: 50.0,
            rest_length: 0.0,
            slack: false,
        });
        let model = Model::<G, D, P>::new(&d).unwrap();
        let (length, translation) = (
            model.layout().get("ball.length").unwrap().start,
            model.layout().get("ball.translation").unwrap().start,
        );
        let q = vec![0.0; model.dof()];
        let x = model.coordinates().iter().position(|name| name == "ball.x").unwrap();
        let mut lambda = q.clone();
        lambda[x] = 1.0;
        let mut data = Data::new(&model);
        let mut adjoint = Adjoint::new(&model, &[length, translation]);
        data.evaluate(&model, &q, &[]);
        let exact = adjoint.virtual_work_gradient(&model, &data, &q, &[], &lambda).to_vec();
        for i in [length, translation] {
            let mut moved = model.parameters().to_vec();
            moved[i] += 1e-4;
            data.set_parameters(&model, &moved);
            data.evaluate(&model, &q, &[]);
            let difference = data.residual()[x] / 1e-4;
            assert!((difference - 50.0).abs() < 1e-9, "{difference}");
            assert!((exact[i] - difference).abs() < 1e-9, "{} {difference}", exact[i]);
        }
    }
    check::<SE2, 3, 2>();
    check::<SE3, 6, 3>();
}
