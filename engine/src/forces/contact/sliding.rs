//! The tangent of a sphere that slides along the side of a round cone as the points move.

use super::super::state::State;
use super::super::terms::{Coupling, FrameTerms};
use super::pair::ContactPair;
use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};

/// The contribution of one frame to a pair.
struct Side<const D: usize, const P: usize> {
    frame: usize,
    /// From its twist to the velocity of p relative to c(t).
    relative: Matrix<P, D>,
    /// From its twist to the rate of the derivative along t.
    slide: Vector<D>,
    curvature: Matrix<D, D>,
}

/// The second derivative of a pair that touches between the ends of a round cone: up to three frames, each
/// coupled with the others.
pub(crate) fn add_tangent<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    pair: &ContactPair<P>,
    k: f64,
    out: &mut FrameTerms<D>,
) {
    let n = &pair.normal;
    let force = *n * (-k * pair.overlap);
    let along = pair.across * (1.0 / pair.distance);
    let side = |point: usize, share: f64, turn: f64| {
        let p = at.point(point);
        let jacobian = G::point_jacobian(p);
        Side {
            frame: at.frame(point),
            relative: jacobian * share,
            slide: jacobian.transpose_times(&(*n * turn - along * share)),
            curvature: G::point_curvature(p, &(force * share)),
        }
    };
    let [p, a, b] = pair.points(at.tree);
    let mut sides = [side(p, 1.0, 0.0), side(a, pair.t - 1.0, 1.0), side(b, -pair.t, -1.0)];
    let mut count = 3;
    if sides[1].frame == sides[2].frame {
        // A rigid link: both ends have the same twist.
        let [_, a, b] = &mut sides;
        a.relative += b.relative;
        a.slide += b.slide;
        a.curvature += b.curvature;
        count = 2;
    }
    let tangential = -k * pair.overlap / pair.curvature_radius();
    let hessian = n.outer(n) * (k - tangential) + Matrix::diagonal(tangential);
    let slip = k * pair.overlap * pair.slip;
    for (i, side) in sides[..count].iter().enumerate() {
        let row = side.relative.transpose() * hessian;
        out.stiffness[side.frame] +=
            row * side.relative + side.slide.outer(&side.slide) * slip + side.curvature;
        for other in &sides[i + 1..count] {
            let form = row * other.relative + side.slide.outer(&other.slide) * slip;
            out.couplings.push(Coupling { row: side.frame, column: other.frame, form });
        }
    }
}
