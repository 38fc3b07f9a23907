//! What ties take from a state: orientations from the reference state, openings from where a path begins.

use super::super::state::{Law, State};
use super::{Condition, TieDesign, Ties};
use crate::geometry::Geometry;
use crate::kinematics::Kinematics;
use crate::lie::LieGroup;
use crate::tree::Tree;

impl<const P: usize> Ties<P> {
    /// Takes orientations, and distances along sliders, from the reference state of a design.
    pub(super) fn update_reference<G: LieGroup<D, P>, const D: usize>(
        &self,
        tree: &Tree<G, D, P>,
        geometry: &Geometry<G, D, P>,
        design: &mut TieDesign<P>,
    ) {
        let mut kinematics = Kinematics::new(tree);
        kinematics.update(tree, geometry, &vec![0.0; tree.dof]);
        let at = State { tree, geometry, kinematics: &kinematics, q: &[], load: &[], law: Law::Actual };
        for (turned, row) in design.turned.iter_mut().zip(&self.rows) {
            let [a, b] = self.ties[row.tie].points.map(|point| kinematics.pose[at.frame(point)]);
            if let Condition::About { turned: direction, .. } = &row.condition {
                *turned = b.inverse().rotate(&a.rotate(direction));
            }
        }
        for (shift, tie) in design.shift.iter_mut().zip(&self.ties) {
            let [a, b] = tie.points;
            let apart = *at.point(b) - *at.point(a);
            let axis = tie.along.map(|axis| kinematics.pose[at.frame(a)].rotate(&axis));
            *shift = axis.map_or(0.0, |axis| axis.dot(&apart));
        }
    }

    /// Closes all ties: the target has its own rotation and no opening.
    pub fn close(&self, design: &mut TieDesign<P>) {
        for (openings, tie) in design.openings.iter_mut().zip(&self.ties) {
            let mut closed = [0.0; 6];
            closed[..3].copy_from_slice(&tie.rotation);
            *openings = [closed; 2];
        }
    }

    /// Whether some tie turns the second place from where it is in the reference state.
    pub fn turn(&self) -> bool {
        self.ties.iter().any(|tie| tie.rotation != [0.0; 3])
    }

    /// Opens some ties as far as they are in this state: closing begins with the target where the second
    /// place is.
    pub fn open<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        design: &mut TieDesign<P>,
        ties: std::ops::Range<usize>,
    ) {
        for index in ties {
            let tie = &self.ties[index];
            let turns = tie.rows.clone().any(|row| self.row(row).1);
            let frame = self.driven_frame(at, design, index);
            let b = tie.points[1];
            // Axes of the second place's frame as they are in the reference state.
            let rotation = if turns { self.rotation(at, design, index, &frame) } else { [0.0; 3] };
            let position = G::point_to_spatial(&frame.inverse().act(at.point(b)));
            let end = if turns { tie.rotation } else { [0.0; 3] };
            let start = linear(&rotation, &position, [0.0; 3]);
            // What the end leaves undetermined is as at the start.
            let stop = linear(&end, &[0.0; 3], start);
            design.openings[index] = [[rotation, start], [end, stop]].map(|[angular, linear]| {
                let mut modes = [0.0; 6];
                modes[..3].copy_from_slice(&angular);
                modes[3..].copy_from_slice(&linear);
                modes
            });
        }
    }

    /// The rotation vector from a frame to the second place, as it is turned from the reference state.
    fn rotation<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        design: &TieDesign<P>,
        tie: usize,
        frame: &G,
    ) -> [f64; 3] {
        let Some(reference) = self.reference_rotation::<G, D>(design, tie) else { return [0.0; 3] };
        let pose = at.kinematics.pose[at.frame(self.ties[tie].points[1])];
        rotation_vector(frame.inverse().compose(&pose).compose(&reference).to_homogeneous())
    }

    /// The rotation from the second place's frame to that of the first in the reference state, from the
    /// directions that conditions turn.
    fn reference_rotation<G: LieGroup<D, P>, const D: usize>(
        &self,
        design: &TieDesign<P>,
        tie: usize,
    ) -> Option<G> {
        let mut pairs = vec![];
        for row in self.ties[tie].rows.clone() {
            if let Condition::About { turned, .. } = &self.rows[row].condition {
                pairs.push([G::point_to_spatial(turned), G::point_to_spatial(&design.turned[row])]);
            }
        }
        if P == 2 {
            pairs.push([[0.0, 1.0, 0.0]; 2]);
        }
        let [from, to] = *pairs.first()?;
        let other = pairs.iter().find(|[v, _]| norm(cross(from, *v)) > 0.5);
        // A hinge turns one direction only; about it any rotation will do.
        let [from2, to2] = other.copied().unwrap_or_else(|| [normal_to(from), normal_to(to)]);
        let [from3, to3] = [cross(from, from2), cross(to, to2)];
        // Columns of the matrix that takes each `from` to its `to`.
        let mut h = [[0.0; 4]; 4];
        for r in 0..3 {
            for c in 0..3 {
                h[r][c] = to[r] * from[c] + to2[r] * from2[c] + to3[r] * from3[c];
            }
        }
        G::from_spatial(&[0.0; 3], &rotation_vector(h))
    }
}

/// The linear part of a twist whose motion has this translation; where its rotation does not determine it,
/// `other` is taken.
fn linear(rotation: &[f64; 3], translation: &[f64; 3], other: [f64; 3]) -> [f64; 3] {
    // The translation is V v, with V = 1 along the axis and a scaled rotation across it.
    let angle = norm(*rotation);
    if angle == 0.0 {
        return *translation;
    }
    let axis = rotation.map(|x| x / angle);
    let (a, b) = (angle.sin() / angle, (1.0 - angle.cos()) / angle);
    let size = a * a + b * b;
    let along = |v: &[f64; 3]| (0..3).map(|i| v[i] * axis[i]).sum::<f64>();
    let (t, o) = (along(translation), along(&other));
    let turned = cross(axis, *translation);
    std::array::from_fn(|i| {
        let across = translation[i] - t * axis[i];
        let solved = if size > 1e-12 { (a * across - b * turned[i]) / size } else { other[i] - o * axis[i] };
        t * axis[i] + solved
    })
}

/// The rotation vector of a rotation matrix, of length π at most.
fn rotation_vector(h: [[f64; 4]; 4]) -> [f64; 3] {
    let sine = [h[2][1] - h[1][2], h[0][2] - h[2][0], h[1][0] - h[0][1]].map(|x| 0.5 * x);
    let cosine = 0.5 * (h[0][0] + h[1][1] + h[2][2] - 1.0);
    let size = norm(sine);
    let angle = size.atan2(cosine);
    if cosine > -0.9 {
        return if size > 0.0 { sine.map(|x| x * (angle / size)) } else { [0.0; 3] };
    }
    // Near half a turn the axis is that of the largest diagonal entry of n nᵀ.
    let k = (0..3).max_by(|i, j| h[*i][*i].total_cmp(&h[*j][*j])).unwrap_or(0);
    let column: [f64; 3] =
        std::array::from_fn(|i| 0.5 * (h[i][k] + h[k][i]) - if i == k { cosine } else { 0.0 });
    let length = norm(column);
    let sign = if (0..3).map(|i| column[i] * sine[i]).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
    column.map(|x| sign * angle * x / length)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn normal_to(v: [f64; 3]) -> [f64; 3] {
    let least = (0..3).min_by(|i, j| v[*i].abs().total_cmp(&v[*j].abs())).unwrap_or(0);
    let mut other = [0.0; 3];
    other[least] = 1.0;
    let found = cross(other, v);
    found.map(|x| x / norm(found))
}
