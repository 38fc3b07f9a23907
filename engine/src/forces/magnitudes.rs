//! Magnitudes of the forces on each coordinate, before they cancel.

use super::state::State;
use crate::lie::LieGroup;
use crate::linalg::Vector;

/// Sums of magnitudes of generalised forces, the unit in which a residual is small or not.
///
/// A force f at a point counts as |f| times the speed of that point for a unit rate of the coordinate,
/// regardless of the angle between them, so that a straight column under an axial force has a unit too.
#[derive(Clone, Debug, Default)]
pub(crate) struct Magnitudes<const P: usize> {
    pub coordinates: Vec<f64>,
    /// Forces computed from positions in place of distances, to which rounding is relative.
    pub positions: Vec<f64>,
    /// Sums of magnitudes of stiffnesses, likewise.
    pub stiffness: Vec<f64>,
    /// (frame, world position, magnitudes of the force, of that with positions, of the stiffness).
    points: Vec<(usize, Vector<P>, [f64; 3])>,
    /// (frame, magnitude of the moment).
    moments: Vec<(usize, f64)>,
}

impl<const P: usize> Magnitudes<P> {
    pub fn clear(&mut self, dof: usize) {
        self.coordinates.clear();
        self.coordinates.resize(dof, 0.0);
        self.positions.clear();
        self.positions.resize(dof, 0.0);
        self.stiffness.clear();
        self.stiffness.resize(dof, 0.0);
        self.points.clear();
        self.moments.clear();
    }

    /// A generalised force on one coordinate.
    pub fn add(&mut self, coordinate: usize, force: f64) {
        self.coordinates[coordinate] += force.abs();
    }

    /// The forces of an entry K_ij, i ≤ j, of a stiffness.
    pub fn add_quadratic(&mut self, i: usize, j: usize, k: f64, q: &[f64]) {
        self.add(i, k * q[j]);
        if i != j {
            self.add(j, k * q[i]);
        }
    }

    /// A force of this magnitude at a point of the tree.
    pub fn add_at_point<G: LieGroup<D, P>, const D: usize>(
        &mut self,
        at: &State<G, D, P>,
        point: usize,
        force: f64,
    ) {
        self.add_at_place(at.frame(point), *at.point(point), force);
    }

    /// A force of this magnitude at a place that moves with a frame.
    pub fn add_at_place(&mut self, frame: usize, place: Vector<P>, force: f64) {
        self.points.push((frame, place, [force.abs(), 0.0, 0.0]));
    }

    /// A force at a point from a stiffness and a distance, the difference of positions of this size.
    pub fn add_of_distance<G: LieGroup<D, P>, const D: usize>(
        &mut self,
        at: &State<G, D, P>,
        point: usize,
        force: f64,
        [stiffness, positions]: [f64; 2],
    ) {
        self.add_of_distance_at(at.frame(point), *at.point(point), force, [stiffness, positions]);
    }

    /// The same at a place that moves with a frame.
    pub fn add_of_distance_at(
        &mut self,
        frame: usize,
        place: Vector<P>,
        force: f64,
        [stiffness, positions]: [f64; 2],
    ) {
        let magnitudes = [force.abs(), (stiffness * positions).abs(), stiffness.abs()];
        self.points.push((frame, place, magnitudes));
    }

    /// A moment of this magnitude on a frame.
    pub fn add_moment(&mut self, frame: usize, moment: f64) {
        self.moments.push((frame, moment.abs()));
    }

    /// Converts forces and moments on frames into generalised forces; `columns` visits the coordinates with
    /// the world columns of all motions that lead to a frame.
    pub fn project<G: LieGroup<D, P>, const D: usize>(
        &mut self,
        columns: impl Fn(usize, &mut dyn FnMut(usize, Vector<D>)),
    ) {
        let mut twists = vec![Vector::<D>::ZERO; self.coordinates.len()];
        let mut touched = vec![];
        let sum = |frame: usize, twists: &mut [Vector<D>], touched: &mut Vec<usize>| {
            for i in touched.drain(..) {
                twists[i] = Vector::ZERO;
            }
            columns(frame, &mut |i, column| {
                twists[i] += column;
                touched.push(i);
            });
            touched.sort_unstable();
            touched.dedup();
        };
        for (frame, point, [force, positions, stiffness]) in &self.points {
            sum(*frame, &mut twists, &mut touched);
            let jacobian = G::point_jacobian(point);
            for i in &touched {
                let speed = (jacobian * twists[*i]).norm();
                self.coordinates[*i] += force * speed;
                self.positions[*i] += positions * speed;
                self.stiffness[*i] += stiffness * speed * speed;
            }
        }
        for (frame, moment) in &self.moments {
            sum(*frame, &mut twists, &mut touched);
            for i in &touched {
                let angular = (0..D).filter(|axis| G::AXES[*axis].is_angular());
                let rate = angular.map(|axis| twists[*i][axis].powi(2)).sum::<f64>().sqrt();
                self.coordinates[*i] += moment * rate;
            }
        }
    }
}
