//! Conditions, forces and their derivatives of every kind of tie, against differences.

use super::{TieDescription, TieDrive, TieKind};
use crate::Data;
use crate::lie::{LieGroup, SE2, SE3};
use crate::model::{AttachmentDescription, Description, Model, Station};
use crate::strain::BasisKind;
use crate::trees::{SECTIONS, planar_tree, spatial_tree};

/// Weights of sixth-order differences.
const STENCIL: [(f64, f64); 6] =
    [(-1.0, -45.0), (1.0, 45.0), (-2.0, 9.0), (2.0, -9.0), (-3.0, -1.0), (3.0, 1.0)];

fn on(body: &str, station: Station, offset: [f64; 3]) -> AttachmentDescription {
    AttachmentDescription::Body { body: body.into(), station, offset, surface: [0.1, 0.0, 0.2] }
}

/// Ties of all kinds, driven or not, between a rod, a link and the world.
fn tied(mut d: Description, [rod, link]: [&str; 2], axis: [f64; 3], turns: [f64; 3]) -> Description {
    // Other forces have corners and steep derivatives.
    d.contacts.clear();
    d.springs.clear();
    d.bodies.iter_mut().for_each(|body| {
        body.joint.lower.fill(None);
        body.joint.upper.fill(None);
    });
    let planar = d.planar;
    let ground = AttachmentDescription::World { world: [0.05, 0.0, 0.02] };
    let rod_place = on(rod, Station::Point(3), [0.0, 0.0, 0.01]);
    let link_place = on(link, Station::Fraction(0.7), [0.004, 0.0, 0.01]);
    let every = [
        ("weld", TieKind::Weld, axis, None),
        ("turned", TieKind::Weld, turns, Some(TieDrive::Rotation)),
        ("pulled", TieKind::Pin, axis, Some(TieDrive::Displacement)),
        ("hinge", TieKind::Hinge, turns, None),
        ("motor", TieKind::Hinge, turns, Some(TieDrive::Rotation)),
        ("slider", TieKind::Slider, axis, None),
        ("piston", TieKind::Slider, axis, Some(TieDrive::Displacement)),
    ];
    for (i, (name, kind, axis, drive)) in every.into_iter().enumerate() {
        let second = if i % 2 == 0 { link_place.clone() } else { ground.clone() };
        let rotation = match kind {
            TieKind::Pin => [0.0; 3],
            _ if planar => [0.0, 0.3, 0.0],
            _ => [0.2, -0.1, 0.4],
        };
        let (name, first) = (name.into(), rod_place.clone());
        d.ties.push(TieDescription { name, kind, first, second, axis, rotation, drive });
    }
    d
}

fn spatial() -> Description {
    let d = spatial_tree([BasisKind::NodalLinear; 6], SECTIONS[0], 4, false);
    tied(d, ["arm", "ball"], [0.6, 0.0, 0.8], [0.0, 0.6, 0.8])
}

fn planar() -> Description {
    let d = planar_tree([BasisKind::NodalLinear; 3], SECTIONS[0], 4, false);
    tied(d, ["exosuit", "ph_2"], [0.6, 0.0, 0.8], [0.0, 1.0, 0.0])
}

fn size(v: &[f64]) -> f64 {
    v.iter().fold(0.0f64, |m, x| m.max(x.abs()))
}

/// A workspace with reactions and penalties, where ties are half closed, with a state and loads.
fn opened<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
) -> (Data<G, D, P>, Vec<f64>, Vec<f64>) {
    let ties = &model.forces.ties;
    let mut data = Data::new(model);
    let q: Vec<f64> = (0..model.dof()).map(|i| 0.2 * (1.3 * i as f64 + 1.0).sin()).collect();
    let mut load: Vec<f64> = (0..model.inputs().len()).map(|i| 0.3 + 0.1 * i as f64).collect();
    load.push(1.0);
    data.evaluate(model, &q, &load);
    let mut design = data.design.forces.ties.clone();
    let start: Vec<f64> = q.iter().map(|q| 0.5 * q).collect();
    data.evaluate(model, &start, &load);
    ties.open(&data.state(model, &start, &load), &mut design, 0..ties.count());
    data.design.forces.ties = design;
    *load.last_mut().unwrap() = 0.5;
    let conditions = data.ties.as_mut().unwrap();
    for (k, x) in conditions.numbers(ties.reactions()).iter_mut().enumerate() {
        *x = 2.0 * (1.9 * k as f64 + 0.4).sin();
    }
    conditions.numbers(ties.penalties()).iter_mut().enumerate().for_each(|(k, x)| *x = 3.0 + k as f64);
    (data, q, load)
}

fn check<G: LieGroup<D, P>, const D: usize, const P: usize>(d: &Description) {
    let model = Model::<G, D, P>::new(d).unwrap();
    assert_eq!(model.forces.ties.row_count(), if D == 3 { 18 } else { 37 });
    let (mut data, q, load) = opened(&model);
    let n = model.dof();
    data.evaluate(&model, &q, &load);
    data.update_ties(&model);
    let (residual, tangent) = (data.residual().to_vec(), data.tangent().to_vec());
    let conditions = data.ties.clone().unwrap();
    let gradients: Vec<&[f64]> = conditions.gradients().collect();
    let rows = gradients.len();
    let h = 1e-4;
    for j in 0..n {
        let (mut slope, mut column, mut rates) = (0.0, vec![0.0; n], vec![0.0; rows]);
        for (step, weight) in STENCIL {
            let mut moved = q.clone();
            moved[j] += step * h;
            data.evaluate_residual(&model, &moved, &load);
            data.update_ties(&model);
            slope += weight * data.energy() / (60.0 * h);
            column.iter_mut().zip(data.residual()).for_each(|(c, r)| *c += weight * r / (60.0 * h));
            let values = data.ties.as_ref().unwrap().values();
            rates.iter_mut().zip(values).for_each(|(c, v)| *c += weight * v / (60.0 * h));
        }
        assert!((slope - residual[j]).abs() < 1e-8 * size(&residual), "{j}: {slope} {}", residual[j]);
        for i in 0..n {
            let error = (column[i] - tangent[i * n + j]).abs();
            assert!(error < 1e-8 * size(&tangent), "{i}, {j}: {} {}", column[i], tangent[i * n + j]);
        }
        for (k, rate) in rates.iter().enumerate() {
            assert!((rate - gradients[k][j]).abs() < 1e-9, "condition {k}, {j}: {rate} {}", gradients[k][j]);
        }
    }
    // With the loads, and with the progress of closing.
    for input in 0..load.len() {
        let mut change = vec![0.0; load.len()];
        change[input] = 1.0;
        data.evaluate(&model, &q, &load);
        let mut exact = vec![0.0; n];
        data.add_load_gradient(&model, &q, &change, &mut exact);
        let mut exact_rates = vec![0.0; rows];
        let at = data.state(&model, &q, &load);
        model.forces.ties.add_rates(&at, &data.design.forces.ties, &change, &mut exact_rates);
        let (mut column, mut rates) = (vec![0.0; n], vec![0.0; rows]);
        for (step, weight) in STENCIL {
            let mut moved = load.clone();
            moved[input] += step * h;
            data.evaluate_residual(&model, &q, &moved);
            data.update_ties(&model);
            column.iter_mut().zip(data.residual()).for_each(|(c, r)| *c += weight * r / (60.0 * h));
            let values = data.ties.as_ref().unwrap().values();
            rates.iter_mut().zip(values).for_each(|(c, v)| *c += weight * v / (60.0 * h));
        }
        for (i, (c, e)) in column.iter().zip(&exact).enumerate() {
            assert!((c - e).abs() < 1e-8 * size(&exact).max(1.0), "load {input}, {i}: {c} {e}");
        }
        for (k, (c, e)) in rates.iter().zip(&exact_rates).enumerate() {
            assert!((c - e).abs() < 1e-9, "load {input}, condition {k}: {c} {e}");
        }
    }
}

#[test]
fn planar_ties_agree_with_differences() {
    check::<SE2, 3, 2>(&planar());
}

#[test]
fn spatial_ties_agree_with_differences() {
    check::<SE3, 6, 3>(&spatial());
}

/// Closing begins where the second places are, and ends with the rotation that was asked for.
fn closes<G: LieGroup<D, P>, const D: usize, const P: usize>(d: &Description) {
    let model = Model::<G, D, P>::new(d).unwrap();
    let ties = &model.forces.ties;
    let mut data = Data::new(&model);
    let q: Vec<f64> = (0..model.dof()).map(|i| 0.5 * (1.3 * i as f64 + 1.0).sin()).collect();
    let mut load = vec![0.0; model.inputs().len() + 1];
    data.evaluate(&model, &q, &load);
    let mut design = data.design.forces.ties.clone();
    ties.open(&data.state(&model, &q, &load), &mut design, 0..ties.count());
    let closed = data.design.forces.ties.clone();
    data.design.forces.ties = design;
    data.evaluate_residual(&model, &q, &load);
    data.update_ties(&model);
    let gap = size(data.ties.as_ref().unwrap().values());
    assert!(gap < 1e-12, "{gap}");
    // At the end the conditions are those of closed ties.
    *load.last_mut().unwrap() = 1.0;
    data.evaluate_residual(&model, &q, &load);
    data.update_ties(&model);
    let ended = data.ties.as_ref().unwrap().values().to_vec();
    data.design.forces.ties = closed;
    data.evaluate_residual(&model, &q, &load);
    data.update_ties(&model);
    for (a, b) in ended.iter().zip(data.ties.as_ref().unwrap().values()) {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    assert!(size(&ended) > 1e-3);
}

#[test]
fn closing_begins_where_places_are() {
    closes::<SE2, 3, 2>(&planar());
    closes::<SE3, 6, 3>(&spatial());
}
