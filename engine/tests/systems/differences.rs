//! Derivatives of a system against sixth-order differences.

use flexor_engine::lie::LieGroup;
use flexor_engine::model::*;
use flexor_engine::sensitivity::{Adjoint, Derivatives, KnownEquilibria, output_groups};
use flexor_engine::{ContactForce, Data, PathResults};

/// Checks residual, tangent and virtual work of all parameters at a state of coordinates up to `size` in which
/// the contacts are `enough`; returns how many parameters it has checked.
pub fn derivatives<G: LieGroup<D, P>, const D: usize, const P: usize>(
    d: &Description,
    size: f64,
    enough: impl Fn(&[ContactForce<P>]) -> bool,
) -> usize {
    let model = Model::<G, D, P>::new(d).unwrap();
    let n = model.dof();
    let load = &vec![0.7; model.inputs().len()];
    let q: Vec<f64> = (0..n).map(|i| size * (1.3 * i as f64 + 1.0).sin()).collect();
    let lambda: Vec<f64> = (0..n).map(|i| (0.7 * i as f64 + 2.0).cos()).collect();
    let mut data = Data::new(&model);
    data.evaluate(&model, &q, load);
    assert!(enough(&data.contact_forces(&model)));
    let (residual, tangent) = (data.residual().to_vec(), data.tangent().to_vec());
    let h = 1e-4;
    let stencil = [(-1.0, -45.0), (1.0, 45.0), (-2.0, 9.0), (2.0, -9.0), (-3.0, -1.0), (3.0, 1.0)];
    let size = |v: &[f64]| v.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    for j in 0..n {
        let (mut slope, mut column) = (0.0, vec![0.0; n]);
        for (step, weight) in stencil {
            let mut moved = q.clone();
            moved[j] += step * h;
            data.evaluate_residual(&model, &moved, load);
            slope += weight * data.energy() / (60.0 * h);
            column.iter_mut().zip(data.residual()).for_each(|(c, r)| *c += weight * r / (60.0 * h));
        }
        assert!((slope - residual[j]).abs() < 1e-8 * size(&residual), "{j}: {slope} {}", residual[j]);
        for i in 0..n {
            let error = (column[i] - tangent[i * n + j]).abs();
            assert!(error < 1e-8 * size(&tangent), "{i}, {j}: {} {}", column[i], tangent[i * n + j]);
        }
    }
    let all: Vec<usize> = (0..model.parameters().len()).collect();
    let mut adjoint = Adjoint::new(&model, &all);
    data.evaluate(&model, &q, load);
    let exact = adjoint.virtual_work_gradient(&model, &data, &q, load, &lambda).to_vec();
    let mut checked = 0;
    for (name, range) in model.layout().iter() {
        for i in range.clone() {
            let component = i - range.start;
            let turns = name.ends_with("rotation");
            // A planar system has no third direction to move in.
            if D == 3 && (turns || name.ends_with("translation")) && (component == 1) != turns {
                continue;
            }
            let p = model.parameters();
            let h = 1e-4 * if p[i] == 0.0 { 0.1 } else { p[i].abs() };
            let mut difference = 0.0;
            for (step, weight) in stencil {
                let mut moved = p.to_vec();
                moved[i] += step * h;
                data.set_parameters(&model, &moved);
                data.evaluate_residual(&model, &q, load);
                let work: f64 = data.residual().iter().zip(&lambda).map(|(r, l)| r * l).sum();
                difference += weight * work / (60.0 * h);
            }
            let scale = 1e-8 * (size(&residual) / h).min(1e3) + 1e-7 * difference.abs();
            assert!((difference - exact[i]).abs() < scale, "{name}[{component}]: {difference} {}", exact[i]);
            checked += 1;
        }
    }
    checked
}

/// Derivatives of one output at the last equilibrium of a path.
pub fn of_output<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    base: &[f64],
    path: &PathResults,
    (group, index): (&str, usize),
    wanted: &[usize],
) -> Derivatives {
    let mut weights = vec![];
    for (name, count) in output_groups(model) {
        weights.extend((0..count).map(|i| if name == group && i == index { 1.0 } else { 0.0 }));
    }
    let q = &path.q[path.q.len() - model.dof()..];
    let applied = &path.applied[path.applied.len() - model.inputs().len()..];
    let (varied, values, designs, sums, cancel) = (&[], &[], &[0], &[0], None);
    let weights = &weights;
    let known = KnownEquilibria { base, varied, values, designs, q, applied, sums, weights, wanted, cancel };
    model.differentiate(known, 1)
}
