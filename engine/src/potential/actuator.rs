//! Chambers and cables: −u ℓ(q), with ℓ the length of a path in the rod's cross-sections.
//!
//! The gradient of ℓ is the actuation matrix B(q) of (9): at each Gauss point the unit tangent
//! τ̂ of the path, τ = ξ_lin + ξ_ang × d + d′ in normalised strains.

use super::CoordinateTerms;
use crate::design::{Design, ThreadColumn, dot};
use crate::lie::LieGroup;
use crate::model::Model;

pub(crate) fn add<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    q: &[f64],
    load: &[f64],
    out: &mut CoordinateTerms,
) {
    let CoordinateTerms { energy, gradient, curvature, along, .. } = out;
    curvature.clear();
    along.clear();
    for_each_point(model, design, q, |actuator, weight, unit, norm, columns| {
        let tension = -model.actuators[actuator].sign * load[actuator] * weight;
        *energy += tension * norm;
        curvature.push(tension / norm);
        for (unit, columns) in unit.iter().zip(columns) {
            for column in columns {
                let along_column = unit * column.size;
                gradient[column.dof] += tension * along_column;
                along.push(along_column);
            }
        }
    });
}

/// The second derivative at the state that [`add`] saw last.
pub(crate) fn add_tangent<G: LieGroup<D, P>, const D: usize, const P: usize>(
    design: &Design<G, D, P>,
    out: &mut CoordinateTerms,
) {
    let CoordinateTerms { half_tangent, curvature, along, .. } = out;
    let mut pairs = design.thread_pairs.iter();
    let mut start = 0;
    for (thread, curvature) in design.threads.iter().zip(curvature) {
        let along = &along[start..thread.ends[2]];
        start = thread.ends[2];
        for (m, one) in along.iter().enumerate() {
            // (1 − τ̂τ̂ᵀ)/|τ|, projected on both columns.
            for (other, pair) in along.iter().zip(pairs.by_ref().take(m + 1)) {
                half_tangent[pair.entry] += *curvature * pair.share * (pair.product - one * other);
            }
        }
    }
}

/// Adds `−Σ_a du_a ∂ℓ_a/∂q` to `gradient`: how the residual changes with the load.
pub(crate) fn add_load_gradient<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    q: &[f64],
    change: &[f64],
    gradient: &mut [f64],
) {
    for_each_point(model, design, q, |actuator, weight, unit, _, columns| {
        let tension = -model.actuators[actuator].sign * change[actuator] * weight;
        for (unit, columns) in unit.iter().zip(columns) {
            for column in columns {
                gradient[column.dof] += tension * unit * column.size;
            }
        }
    });
}

/// Length of each actuator's path.
pub(crate) fn lengths<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    q: &[f64],
) -> Vec<f64> {
    let mut lengths = vec![0.0; model.actuators.len()];
    for_each_point(model, design, q, |actuator, weight, _, norm, _| lengths[actuator] += weight * norm);
    lengths
}

/// Visits each Gauss point of each actuator with (actuator, weight, τ̂, |τ|, columns along each axis).
#[inline]
fn for_each_point<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    q: &[f64],
    mut visit: impl FnMut(usize, f64, [f64; 3], f64, [&[ThreadColumn]; 3]),
) {
    let (mut point, mut start) = (0, 0);
    for (index, actuator) in model.actuators.iter().enumerate() {
        for thread in &design.threads[point..point + actuator.tendon.len()] {
            let columns =
                thread.ends.map(|end| &design.thread_columns[std::mem::replace(&mut start, end)..end]);
            let mut tau = thread.base;
            for (tau, columns) in tau.iter_mut().zip(columns) {
                columns.iter().for_each(|column| *tau += q[column.dof] * column.size);
            }
            // A path collapsed to a point has no direction; a tiny floor keeps the tangent finite.
            let norm = dot(&tau, &tau).sqrt().max(1e-9 * thread.base[0].abs());
            visit(index, thread.weight, tau.map(|t| t / norm), norm, columns);
        }
        point += actuator.tendon.len();
    }
}
