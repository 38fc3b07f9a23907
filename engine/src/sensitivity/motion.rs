//! Parameters that move frames and points: lengths, radii of links, poses.
//!
//! λᵀg is the virtual work Σ F·v of the forces on the virtual velocities v of their points. Along a
//! parameter the forces change because points drift, the velocities because points drift under a
//! fixed twist, and the twists because the columns S_i that make them up are carried along.

use super::adjoint::{Adjoint, Drift, Geometric};
use crate::data::Data;
use crate::kinematics::strains;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::{Link, Model, Motion, Place, Shape};
use crate::potential::wrench::world_wrench;

/// Derivative of a place's fraction with respect to the link's radii (base, tip).
pub(super) fn fraction_slope(p: &[f64], link: &Link, place: Place) -> [f64; 2] {
    let Place::Centroid(_) = place else { return [0.0; 2] };
    let (a, b) = (p[link.radius_base], p[link.radius_tip]);
    let (top, bottom) = (a * a + 2.0 * a * b + 3.0 * b * b, 4.0 * (a * a + a * b + b * b));
    let slope = |dt: f64, db: f64| (dt * bottom - top * db) / (bottom * bottom);
    [slope(2.0 * a + 2.0 * b, 4.0 * (2.0 * a + b)), slope(2.0 * a + 6.0 * b, 4.0 * (a + 2.0 * b))]
}

impl<const D: usize, const P: usize> Drift<D, P> {
    /// World twists of the frames and velocities of the points as the parameter changes.
    pub(super) fn update<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>, data: &Data<G, D, P>) {
        let kind = self.kind;
        for (f, frame) in model.frames.iter().enumerate().skip(1) {
            self.twist[f] = self.twist[frame.parent] + own_drift(model, data, f, kind);
        }
        let p = &data.design.parameters;
        for (i, point) in model.points.iter().enumerate() {
            let world = &data.kinematics.points[i];
            let mut drift = G::point_jacobian(world) * self.twist[point.frame];
            let along = match (point.place, kind) {
                (Place::Fraction(b, f), Geometric::LinkLength(body)) if b == body => f,
                (Place::Centroid(b), Geometric::LinkLength(body)) if b == body => {
                    crate::design::link_fraction(model, p, point.place).1
                }
                (Place::Centroid(b), Geometric::LinkRadius(body, tip)) if b == body => {
                    let Shape::Link(link) = &model.bodies[b].shape else { continue };
                    fraction_slope(p, link, point.place)[usize::from(tip)] * p[link.length]
                }
                _ => 0.0,
            };
            if along != 0.0 {
                drift += data.kinematics.pose[point.frame].rotate(&Vector::unit(0)) * along;
            }
            self.points[i] = drift;
        }
    }
}

impl<const D: usize, const P: usize> Adjoint<D, P> {
    /// The change of the virtual work along a drift.
    pub(super) fn geometric_work<G: LieGroup<D, P>>(
        &self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        load: &[f64],
        drift: &Drift<D, P>,
    ) -> f64 {
        self.force_work(model, data, load, drift) + self.column_work(model, data, drift)
    }

    /// Change of F·v with the twists of the virtual motion held.
    fn force_work<G: LieGroup<D, P>>(
        &self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        load: &[f64],
        drift: &Drift<D, P>,
    ) -> f64 {
        let p = &data.design.parameters;
        // A point's velocity under a fixed twist is affine in the point.
        let turned = |point: usize| {
            let twist = self.twist[model.points[point].frame];
            (G::point_jacobian(&drift.points[point]) - G::point_jacobian(&Vector::ZERO)) * twist
        };
        let mut touching = 0.0;
        let mut work = 0.0;
        let mut pair = |a: usize, b: usize, force: Vector<P>, change: Vector<P>| {
            work += change.dot(&(self.velocity[a] - self.velocity[b])) + force.dot(&(turned(a) - turned(b)));
        };
        for (_, k, t) in data.touching(model) {
            let (drift, velocity) = (t.motion(model, &drift.points), t.motion(model, &self.velocity));
            let change = t.closing(&drift) * t.closing(&velocity);
            let turned = t.points(model).map(turned);
            touching += k * (change + t.overlap * (t.curvature(&drift, &velocity) + t.closing(&turned)));
        }
        for spring in &model.springs {
            let [a, b] = spring.ends;
            let r = data.kinematics.points[a] - data.kinematics.points[b];
            let (k, rest, length) = (p[spring.stiffness], p[spring.rest_length], r.norm());
            if (spring.slack && length <= rest) || length == 0.0 {
                continue;
            }
            let n = r * (1.0 / length);
            let dr = drift.points[a] - drift.points[b];
            let along = n.dot(&dr);
            let change = n * along + (dr - n * along) * ((length - rest) / length);
            pair(a, b, n * (k * (length - rest)), change * k);
        }
        work += touching;
        for (mass, m) in model.masses.iter().zip(&data.design.masses) {
            work -= (model.gravity * *m).dot(&turned(mass.point()));
        }
        for wrench in &model.wrenches {
            let size = wrench.input.map_or(1.0, |i| load[i]);
            if wrench.follower {
                // The wrench is carried along with its frame; its point may slide along the body.
                let w = world_wrench(wrench, &data.design, &data.kinematics);
                let carried = G::ad(&drift.twist[wrench.frame]) * self.twist[wrench.frame];
                let (jacobian, p) = (G::point_jacobian, &data.kinematics.points[wrench.point]);
                let slide = drift.points[wrench.point] - jacobian(p) * drift.twist[wrench.frame];
                let turned = (jacobian(&slide) - jacobian(&Vector::ZERO)) * self.twist[wrench.frame];
                let force = data.kinematics.pose[wrench.frame].rotate(&wrench.force);
                work += size * (w.dot(&carried) - force.dot(&turned));
            } else {
                work -= size * wrench.force.dot(&turned(wrench.point));
            }
        }
        work
    }
}

/// The world twist that a parameter adds at frame `f` itself.
fn own_drift<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
    f: usize,
    kind: Geometric,
) -> Vector<D> {
    let frame = &model.frames[f];
    match (&frame.motion, kind) {
        (Motion::Strain(step), Geometric::RodLength(rod)) if model.steps[*step].rod == rod => {
            let omega = &data.kinematics.omega[f];
            let tangent = G::tangent(omega, &data.kinematics.stumpff[f]);
            data.kinematics.pose[f].adjoint() * (tangent * length_motion(model, data, *step).0)
        }
        (Motion::Rigid(r), Geometric::LinkLength(b)) => match &model.bodies[b].shape {
            Shape::Link(link) if link.tip == *r => {
                let axis = data.kinematics.pose[f].rotate(&Vector::unit(0));
                translation_twist::<G, D, P>(&axis)
            }
            _ => Vector::ZERO,
        },
        (Motion::Rigid(r), Geometric::Translation(b, k)) if model.bodies[b].placement == *r => {
            let mut e = [0.0; 3];
            e[k] = 1.0;
            let direction = G::point_from_spatial(&e).unwrap_or(Vector::ZERO);
            translation_twist::<G, D, P>(&data.kinematics.pose[frame.parent].rotate(&direction))
        }
        (Motion::Rigid(r), Geometric::Rotation(b, k)) if model.bodies[b].placement == *r => {
            let rotation = model.bodies[b].rotation.start;
            let mut omega = Vector::<D>::ZERO;
            let mut e = Vector::<D>::ZERO;
            for (i, mode) in crate::strain::Mode::ALL.into_iter().take(3).enumerate() {
                if let Some(axis) = G::axis(mode) {
                    omega[axis] = data.design.parameters[rotation + i];
                    e[axis] = if i == k { 1.0 } else { 0.0 };
                }
            }
            // A rotation vector turns about the placement's own origin: a pure body twist there.
            let c = crate::lie::Stumpff::new(G::angle_squared(&omega));
            data.kinematics.pose[f].adjoint() * (G::tangent(&omega, &c) * e)
        }
        _ => Vector::ZERO,
    }
}

/// A translation in the world as a twist.
fn translation_twist<G: LieGroup<D, P>, const D: usize, const P: usize>(direction: &Vector<P>) -> Vector<D> {
    // Moving the origin: the Jacobian of the point at the origin is [0 | 1].
    G::point_jacobian(&Vector::ZERO).transpose_times(direction)
}

/// dΩ/dL of a Magnus step and the normalised strains' own derivatives at its two points.
fn length_motion<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
    step: usize,
) -> (Vector<D>, [Vector<D>; 2]) {
    let magnus = &model.steps[step];
    let rod = &model.rods[magnus.rod];
    let length = data.design.parameters[rod.length];
    let (a1, a2, _) = data.kinematics.magnus_derivative(model, step);
    let change = data.kinematics.strain[step].map(|strain| {
        let mut d = Vector::ZERO;
        for (axis, mode) in G::AXES.into_iter().enumerate() {
            let m = mode.index();
            d[axis] = if mode.is_angular() { rod.reference_strain[m] } else { strain[axis] / length };
        }
        d
    });
    (a1 * change[0] + a2 * change[1], change)
}

impl<const D: usize, const P: usize> Adjoint<D, P> {
    /// Σ_i λ_i w̄_i·dS_i: the columns are carried by the frames before them, and on the rod whose length
    /// changes they change themselves.
    fn column_work<G: LieGroup<D, P>>(
        &self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        drift: &Drift<D, P>,
    ) -> f64 {
        let mut work = 0.0;
        for (f, frame) in model.frames.iter().enumerate().skip(1) {
            if frame.columns.is_empty() || !data.assembly.frames.loaded[f] {
                continue;
            }
            let wrench = &data.assembly.frames.wrench[f];
            let own = self.twist[f] - self.twist[frame.parent];
            // Half of the frame's own drift: the other half is in the curvature of its exponential.
            let carrier = (drift.twist[f] + drift.twist[frame.parent]) * 0.5;
            work += wrench.dot(&(G::ad(&carrier) * own));
            let Motion::Strain(step) = frame.motion else { continue };
            let Geometric::RodLength(rod) = drift.kind else { continue };
            if model.steps[step].rod == rod {
                work += self.length_column_work(model, data, f, step);
            }
        }
        work
    }

    /// The second derivatives of a step's exponential and of its Ω along (L, λ).
    fn length_column_work<G: LieGroup<D, P>>(
        &self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        f: usize,
        step: usize,
    ) -> f64 {
        let length = data.design.parameters[model.rods[model.steps[step].rod].length];
        let (omega, stumpff) = (&data.kinematics.omega[f], &data.kinematics.stumpff[f]);
        let (a1, a2, commutator) = data.kinematics.magnus_derivative(model, step);
        let (by_length, change) = length_motion(model, data, step);
        // Strains of the virtual motion, and their derivative with respect to L.
        let strain = strains(model, &data.design, f, &self.coordinates, Vector::ZERO);
        let strain_by_length = strain.map(|strain| {
            let mut change = Vector::ZERO;
            for (axis, _) in G::AXES.iter().enumerate().filter(|(_, mode)| !mode.is_angular()) {
                change[axis] = strain[axis] / length;
            }
            change
        });
        let virtual_omega = a1 * strain[0] + a2 * strain[1];
        let [body_wrench, on_omega] = data.assembly.duals[f];
        let curvature = G::tangent_curvature(omega, &body_wrench, stumpff);
        let explicit = a1 * strain_by_length[0] + a2 * strain_by_length[1];
        let bracket = (G::ad(&change[0]) * strain[1] + G::ad(&strain[0]) * change[1]) * commutator;
        by_length.dot(&(curvature * virtual_omega)) + on_omega.dot(&(explicit + bracket))
    }
}
