//! Residual against differences of Π, tangent against differences of the residual, on random states
//! of systems that between them hold every potential, basis, section and joint.

use crate::systems::{finger, refined};
use crate::trees::{basis, planar_trees, solids, spatial_tree, spatial_trees, with_round_cones};
use flexor_engine::lie::{LieGroup, SE2, SE3};
use flexor_engine::linalg::Vector;
use flexor_engine::model::*;
use flexor_engine::{ContactForce, Data};
use proptest::prelude::*;

/// Step of the differences: small against the distance of overlapping sphere centres.
const STEP: f64 = 4e-6;

/// Sixth-order central differences of energy and residual along coordinate `j`.
///
/// `None` where a contact opens, closes or turns, or a strap becomes slack, within the stencil: the tangent jumps
/// there.
fn differences<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &mut Data<G, D, P>,
    q: &[f64],
    load: &[f64],
    j: usize,
) -> Option<(f64, Vec<f64>)> {
    let h = STEP;
    let mut energy = 0.0;
    let mut column = vec![0.0; q.len()];
    let (mut pairs, mut taut) = (None, None);
    let stencil = [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)];
    for (step, weight) in stencil.iter().flat_map(|(s, w)| [(-s, -w), (*s, *w)]) {
        let mut moved = q.to_vec();
        moved[j] += step * h;
        data.evaluate(model, &moved, load);
        let touching = data.contact_forces(model);
        if pairs.replace(touching.clone()).is_some_and(|p| !alike(&p, &touching)) {
            return None;
        }
        let mut tensions = vec![0.0; model.spring_count()];
        data.spring_tensions(model, &mut tensions);
        let pulling: Vec<bool> = tensions.iter().map(|tension| *tension != 0.0).collect();
        if taut.replace(pulling.clone()).is_some_and(|before| before != pulling) {
            return None;
        }
        energy += weight * data.energy() / (60.0 * h);
        for (c, r) in column.iter_mut().zip(data.residual()) {
            *c += weight * r / (60.0 * h);
        }
    }
    Some((energy, column))
}

/// The same pairs, pushed the same way: a sphere's centre may pass by a round cone's axis, too close
/// for differences.
fn alike<const P: usize>(one: &[ContactForce<P>], other: &[ContactForce<P>]) -> bool {
    let same = |(a, b): (&ContactForce<P>, &ContactForce<P>)| {
        (a.first, a.second) == (b.first, b.second)
            && a.force.dot(&b.force) >= 0.995 * a.force.norm() * b.force.norm()
    };
    one.len() == other.len() && one.iter().zip(other).all(same)
}

/// Where pieces of the torques of joints meet, whichever coordinate they act on.
fn pieces(description: &Description) -> impl Iterator<Item = f64> + '_ {
    let curves = description.joint_torques.iter().flat_map(|torque| match &torque.curve {
        TorqueCurve::Table { angles, .. } => angles.clone(),
        TorqueCurve::Threshold { angle, width, direction, .. } => vec![*angle, angle + direction * width],
        _ => vec![],
    });
    let limits = description.bodies.iter().map(|b| &b.joint).flat_map(|joint| {
        let ends = |limits: &[Option<f64>], width: f64| -> Vec<f64> {
            limits.iter().flatten().flat_map(|limit| [*limit, limit + width]).collect()
        };
        [ends(&joint.lower, -joint.limit_width), ends(&joint.upper, joint.limit_width)].concat()
    });
    curves.chain(limits)
}

/// Rounding of contact forces [N]: close to an axis, that of a sphere's centre turns the force.
fn rounding_of_contact<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
) -> f64 {
    let centres: Vec<Vector<P>> = data.spheres(model).map(|(centre, _)| centre).collect();
    let rounding = |contact: &ContactForce<P>| {
        let (centre, [start, end]) = (centres[contact.first], contact.second?.map(|k| centres[k]));
        let axis = end - start;
        let along = axis.dot(&(centre - start)) / axis.dot(&axis).max(f64::MIN_POSITIVE);
        let away = (centre - start - axis * along.clamp(0.0, 1.0)).norm();
        Some(contact.force.norm() * f64::EPSILON * centre.norm() / away)
    };
    data.contact_forces(model).iter().filter_map(rounding).sum()
}

fn check<G: LieGroup<D, P>, const D: usize, const P: usize>(
    description: &Description,
    state: &[f64],
    spread: f64,
    load: &[f64],
) -> Result<(), TestCaseError> {
    let model = Model::<G, D, P>::new(description).unwrap();
    let n = model.dof();
    let load = &load[..model.inputs().len()];
    let q: Vec<f64> = (0..n).map(|i| spread * state[i % state.len()]).collect();
    let mut data = Data::new(&model);
    data.evaluate(&model, &q, load);
    let (residual, tangent) = (data.residual().to_vec(), data.tangent().to_vec());
    let size = |v: &[f64]| v.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let of_contact = rounding_of_contact(&model, &data);
    let stiffest: Vec<f64> = tangent.chunks(n).map(size).collect();
    if model.is_conservative() {
        for i in 0..n {
            for j in 0..i {
                let (a, b) = (tangent[i * n + j], tangent[j * n + i]);
                prop_assert!((a - b).abs() <= 1e-12 * size(&tangent), "tangent not symmetric at {i}, {j}");
            }
        }
    }
    let mut checked = 0;
    for j in 0..n {
        // The third derivative jumps there: differences across are not that exact.
        if pieces(description).any(|end| (q[j] - end).abs() < 4.0 * STEP) {
            continue;
        }
        let Some((slope, difference)) = differences(&model, &mut data, &q, load, j) else { continue };
        checked += 1;
        if model.is_conservative() {
            let error = (slope - residual[j]).abs();
            let rounding = 1e-14 * data.energy().abs() / STEP;
            prop_assert!(error <= 1e-6 * size(&residual) + rounding, "residual {j}: {slope} {}", residual[j]);
        }
        let column: Vec<f64> = (0..n).map(|i| tangent[i * n + j]).collect();
        for i in 0..n {
            let error = (difference[i] - column[i]).abs();
            let rounding = (1e-14 * size(&residual) + 4e-15 * stiffest[i] + 2.0 * of_contact) / STEP;
            prop_assert!(
                error <= 1e-6 * size(&column) + rounding,
                "tangent {i}, {j}: {} {}",
                difference[i],
                column[i]
            );
        }
    }
    // So close to a change of contact that most stencils cross it: rare, or the test fails for want of states.
    prop_assume!(2 * checked > n);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// One that is assembled from node to node.
    #[test]
    fn long_rod(state in prop::collection::vec(-1.0..1.0f64, 113), load in -1.0..2.0f64) {
        check::<SE2, 3, 2>(&refined(finger(), 52), &state, 0.25, &[load])?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, max_global_rejects: 4, ..ProptestConfig::default() })]

    #[test]
    fn spatial(
        state in prop::collection::vec(-1.0..1.0f64, 97),
        tree in spatial_trees(),
        load in prop::collection::vec(-1.0..2.0f64, 5),
    ) {
        check::<SE3, 6, 3>(&tree, &state, 0.25, &load)?;
    }

    #[test]
    fn round_cones(state in prop::collection::vec(-1.0..1.0f64, 41)) {
        check::<SE3, 6, 3>(&solids(), &state, 0.25, &[])?;
    }

    #[test]
    fn planar(
        state in prop::collection::vec(-1.0..1.0f64, 53),
        tree in planar_trees(),
        load in prop::collection::vec(-1.0..2.0f64, 5),
    ) {
        check::<SE2, 3, 2>(&tree, &state, 0.25, &load)?;
    }

    /// The whole world moved rigidly: same energy, same residual.
    #[test]
    fn frame_invariance(
        state in prop::collection::vec(-1.0..1.0f64, 97),
        bases in prop::array::uniform6(basis()),
        turn in prop::array::uniform3(-2.0..2.0f64),
        shift in prop::array::uniform3(-1.0..1.0f64),
        cones: bool,
        load in prop::collection::vec(-1.0..2.0f64, 5),
    ) {
        let fixed = spatial_tree(bases, Section::Circular, 4, true);
        let fixed = if cones { with_round_cones(fixed) } else { fixed };
        let rotation = SE3::from_spatial(&shift, &turn).unwrap();
        let point = |p: [f64; 3]| rotation.act(&Vector(p)).0;
        let direction = |d: [f64; 3]| rotation.rotate(&Vector(d)).0;
        let mut moved = fixed.clone();
        moved.gravity = direction(fixed.gravity);
        for b in moved.bodies.iter_mut().filter(|b| b.parent.is_none()) {
            let place = SE3::from_spatial(&b.placement.translation, &b.placement.rotation).unwrap();
            b.placement.translation = point(b.placement.translation);
            b.placement.rotation = rotation_vector(&rotation.compose(&place).to_homogeneous());
        }
        for s in &mut moved.springs {
            for end in [&mut s.first, &mut s.second] {
                if let AttachmentDescription::World { world } = end {
                    *world = point(*world);
                }
            }
        }
        for w in moved.wrenches.iter_mut().filter(|w| w.frame == WrenchFrame::World) {
            w.force = direction(w.force);
            w.moment = direction(w.moment);
        }
        let evaluate = |d: &Description| {
            let model = Model::<SE3, 6, 3>::new(d).unwrap();
            let q: Vec<f64> = (0..model.dof()).map(|i| 0.25 * state[i % state.len()]).collect();
            let mut data = Data::new(&model);
            data.evaluate(&model, &q, &load[..model.inputs().len()]);
            (data.residual().to_vec(), data.tangent().to_vec())
        };
        let ((r, h), (moved_r, moved_h)) = (evaluate(&fixed), evaluate(&moved));
        for (a, b) in r.iter().zip(&moved_r).chain(h.iter().zip(&moved_h)) {
            prop_assert!((a - b).abs() <= 1e-9 * (1.0 + a.abs()), "{a} {b}");
        }
    }
}

/// The rotation vector of a homogeneous matrix, for angles below π.
fn rotation_vector(h: &[[f64; 4]; 4]) -> [f64; 3] {
    let axis = [h[2][1] - h[1][2], h[0][2] - h[2][0], h[1][0] - h[0][1]];
    let sine = 0.5 * axis.iter().map(|a| a * a).sum::<f64>().sqrt();
    let angle = sine.atan2(0.5 * (h[0][0] + h[1][1] + h[2][2] - 1.0));
    axis.map(|a| 0.5 * a * if sine > 1e-12 { angle / sine } else { 1.0 })
}
