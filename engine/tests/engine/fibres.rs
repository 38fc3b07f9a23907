//! Sections of fibres and pressures on random states: residual against differences of the energy, tangent
//! and derivatives with respect to every parameter against differences of the residual.

use crate::systems::{body, empty, joint, rod, strain};
use flexor_engine::Data;
use flexor_engine::lie::{LieGroup, SE2, SE3};
use flexor_engine::model::*;
use flexor_engine::sensitivity::Adjoint;
use flexor_engine::strain::{BasisKind, Intervals, Mode};
use proptest::prelude::*;

const STENCIL: [(f64, f64); 6] =
    [(-1.0, -45.0), (1.0, 45.0), (-2.0, 9.0), (2.0, -9.0), (-3.0, -1.0), (3.0, 1.0)];

fn materials() -> Vec<MaterialDescription> {
    let material = |name: &str, law, constants: &[f64], wound| MaterialDescription {
        name: name.into(),
        law,
        constants: constants.to_vec(),
        wound,
    };
    let mut all = vec![];
    for wound in [false, true] {
        let name = |law: &str| format!("{law}_{wound}");
        all.push(material(&name("linear"), Law::Linear, &[2e5, 0.4], wound));
        all.push(material(&name("neo"), Law::NeoHookean, &[1e5], wound));
        all.push(material(&name("yeoh"), Law::Yeoh, &[6e4, -3e3, 4e2], wound));
        all.push(material(&name("mooney"), Law::MooneyRivlin, &[4e4, 2e4], wound));
        all.push(material(&name("ogden"), Law::Ogden, &[5e4, 1.7, 2e4, -2.3], wound));
    }
    all
}

/// A rod with two sections of fibres of all materials, places and areas from `random`, under a pressure.
fn actuator(planar: bool, random: &[f64]) -> Description {
    let mut random = random.iter().cycle();
    let mut draw = |low: f64, high: f64| low + (high - low) * random.next().unwrap();
    let modes: &[Mode] = if planar { &[Mode::BendY, Mode::ExtendX, Mode::ShearZ] } else { &Mode::ALL };
    let modes = modes.iter().map(|mode| strain(*mode, BasisKind::NodalLinear)).collect();
    let mut arm = rod(0.12, [0.010, 0.008], modes, 2, 2);
    arm.section = Section::Fibres;
    arm.reference_strain[1] = 2.0;
    let mut d = empty(planar);
    d.gravity = [0.3, 0.0, -9.81];
    d.bodies.push(body("arm", None, [0.0; 3], joint(JointKind::Fixed), ShapeDescription::Rod(arm)));
    d.materials = materials();
    let mut section = || FibreSectionDescription {
        fibres: (0..23)
            .map(|k| FibreDescription {
                material: (7 * k) % d.materials.len(),
                y: if planar { [0.0; 2] } else { [draw(-2e-3, 2e-3), draw(-0.8, 0.8)] },
                z: [draw(-2e-3, 2e-3), draw(-0.8, 0.8)],
                area: [draw(1e-6, 5e-6), draw(0.0, 1e-3), draw(0.0, 0.1)],
                stretch: draw(0.9, 1.2),
                winding: [draw(4e-3, 5e-3), draw(0.5, 0.55), draw(4e-3, 5e-3), draw(0.4, 0.5)],
                centre: if planar {
                    [0.0, 0.0, draw(-2e-3, 2e-3), draw(-0.3, 0.3)]
                } else {
                    std::array::from_fn(|k| if k % 2 == 0 { draw(-2e-3, 2e-3) } else { draw(-0.3, 0.3) })
                },
            })
            .collect(),
        torsion: draw(0.5, 1.0),
        shear: [draw(0.5, 1.0), draw(0.5, 1.0)],
        rigidity: std::array::from_fn(|_| draw(0.0, 1e-3)),
        mass: {
            let centroid = [1.5e-3, -1e-3];
            let [a, b, c] = [draw(0.0, 0.1), draw(0.0, 1.0), draw(0.0, 10.0)];
            let [y, z] = centroid.map(|e| [a * e, b * e + 0.1 * a, c * e, 0.3 * c]);
            let y = if planar { [0.0; 4] } else { y };
            [a, b, c, y[0], y[1], y[2], y[3], z[0], z[1], z[2], z[3]]
        },
        clearances: vec![[-1e-3, 0.9]],
    };
    let sections = vec![section(), section()];
    d.fibres.push(FibreRodDescription { rod: "arm".into(), sections, of_gauss: vec![0, 0, 1, 0] });
    let mut moments = || {
        let mut c = std::array::from_fn(|k| 1e-3 * draw(-0.2, 1.0) * 100f64.powi((k as i32 - 3) % 4));
        c[..3].copy_from_slice(&[1e-5, 1e-3, 0.5]);
        if planar {
            c[3..7].fill(0.0);
        }
        c
    };
    d.pressures.push(PressureDescription {
        name: "air".into(),
        rod: "arm".into(),
        sections: vec![moments(), moments()],
        of_gauss: vec![1, 0, 0, 1],
        share: vec![1.0, 0.7, 1.0, 0.0],
        enclosed: vec![4e-7, 3e-7, 2e-7, 1e-7],
    });
    assert_eq!(Intervals { elements: 2, tip: 1 }.sample_points(2).len(), 7);
    d
}

fn size(v: &[f64]) -> f64 {
    v.iter().fold(0.0f64, |m, x| m.max(x.abs()))
}

fn check<G: LieGroup<D, P>, const D: usize, const P: usize>(
    random: &[f64],
    state: &[f64],
    pressure: f64,
) -> Result<(), TestCaseError> {
    let d = actuator(D == 3, random);
    let model = Model::<G, D, P>::new(&d).unwrap();
    prop_assert!(model.is_admissible(model.parameters()));
    let n = model.dof();
    let q: Vec<f64> = (0..n).map(|i| 0.3 * state[i % state.len()]).collect();
    let lambda: Vec<f64> = (0..n).map(|i| (0.7 * i as f64 + 2.0).cos()).collect();
    let mut data = Data::new(&model);
    data.evaluate(&model, &q, &[pressure]);
    prop_assert!(data.energy().is_finite());
    let (residual, tangent) = (data.residual().to_vec(), data.tangent().to_vec());
    let h = 1e-4;
    for j in 0..n {
        let (mut slope, mut column) = (0.0, vec![0.0; n]);
        for (step, weight) in STENCIL {
            let mut moved = q.clone();
            moved[j] += step * h;
            data.evaluate_residual(&model, &moved, &[pressure]);
            slope += weight * data.energy() / (60.0 * h);
            column.iter_mut().zip(data.residual()).for_each(|(c, r)| *c += weight * r / (60.0 * h));
        }
        prop_assert!((slope - residual[j]).abs() < 1e-8 * size(&residual), "{j}: {slope} {}", residual[j]);
        for i in 0..n {
            let error = (column[i] - tangent[i * n + j]).abs();
            prop_assert!(error < 1e-8 * size(&tangent), "{i}, {j}: {} {}", column[i], tangent[i * n + j]);
        }
    }
    let all: Vec<usize> = (0..model.parameters().len()).collect();
    let mut adjoint = Adjoint::new(&model, &all);
    data.evaluate(&model, &q, &[pressure]);
    let exact = adjoint.virtual_work_gradient(&model, &data, &q, &[pressure], &lambda).to_vec();
    let p = model.parameters();
    for (name, range) in model.layout().iter() {
        if name.ends_with("rotation") || name.ends_with("translation") {
            continue;
        }
        for i in range {
            let h = if p[i] == 0.0 { 1e-4 } else { 1e-4 * p[i].abs() };
            let mut difference = 0.0;
            for (step, weight) in STENCIL {
                let mut moved = p.to_vec();
                moved[i] += step * h;
                data.set_parameters(&model, &moved);
                data.evaluate_residual(&model, &q, &[pressure]);
                let work: f64 = data.residual().iter().zip(&lambda).map(|(r, l)| r * l).sum();
                difference += weight * work / (60.0 * h);
            }
            let allowed = 1e-6 * difference.abs() + 1e-11 * size(&residual) / h;
            let error = (difference - exact[i]).abs();
            prop_assert!(error <= allowed, "{name}[{i}]: {difference} {}", exact[i]);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn planar(
        random in prop::collection::vec(0.0..1.0f64, 311),
        state in prop::collection::vec(-1.0..1.0f64, 19),
        pressure in -1e4..5e4f64,
    ) {
        check::<SE2, 3, 2>(&random, &state, pressure)?;
    }

    #[test]
    fn spatial(
        random in prop::collection::vec(0.0..1.0f64, 311),
        state in prop::collection::vec(-1.0..1.0f64, 19),
        pressure in -1e4..5e4f64,
    ) {
        check::<SE3, 6, 3>(&random, &state, pressure)?;
    }
}

/// Where a fibre would have no length, there is no energy, so that no path leads there.
#[test]
fn a_fibre_cannot_vanish() {
    let d = actuator(true, &[0.3, 0.6, 0.1, 0.8]);
    let model = Model::<SE2, 3, 2>::new(&d).unwrap();
    let mut data = Data::new(&model);
    let bent = |angle: f64| vec![angle, angle, angle, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    data.evaluate_residual(&model, &bent(0.5), &[0.0]);
    assert!(data.energy().is_finite());
    data.evaluate_residual(&model, &bent(80.0), &[0.0]);
    assert!(data.energy().is_nan());
}

#[test]
fn designs_that_cannot_be_made_are_not_admissible() {
    let model = Model::<SE2, 3, 2>::new(&actuator(true, &[0.3, 0.6, 0.1, 0.8])).unwrap();
    let changed = |slot: &str, at: usize, value: f64| {
        let mut p = model.parameters().to_vec();
        p[model.layout().get(slot).unwrap().start + at] = value;
        model.is_admissible(&p)
    };
    assert!(changed("arm.clearances[0]", 0, -1e-3));
    assert!(!changed("arm.clearances[0]", 0, -2e-2));
    assert!(!changed("arm.fibres[0]", 4, -1.0));
    assert!(!changed("arm.fibres[0]", 7, 0.0));
    assert!(!changed("neo_true.constants", 0, -1.0));
    assert!(!changed("linear_true.constants", 1, 0.6));
}
