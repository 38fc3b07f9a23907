//! Parameters that move frames and points: lengths, radii of links, poses.
//!
//! λᵀg is the virtual work Σ F·v of the forces on the virtual velocities v of their points. With a
//! parameter the forces change because points move, the velocities because points move under a fixed
//! twist, and the twists because the columns S_i that compose them are transported.

use crate::data::Data;
use crate::forces::element::Velocities;
use crate::geometry::{link_fraction, link_fraction_slope, radius_between};
use crate::kinematics::strains;
use crate::lie::LieGroup;
use crate::linalg::{LANES, Vector};
use crate::model::Model;
use crate::tree::{Motion, Place, Point, Shape, SphereRadius};
use std::ops::Range;

/// The motion of frames and points with a geometric parameter at fixed coordinates.
#[derive(Clone, Debug)]
pub(super) struct DesignVelocity<const D: usize, const P: usize> {
    pub parameter: usize,
    kind: Geometric,
    /// Whether anything moves with it in this design.
    pub acts: bool,
    /// World twist of each frame.
    twists: Vec<Vector<D>>,
    /// Velocity of each point.
    points: Vec<Vector<P>>,
    /// What the twist of each frame relative to the one before works as the columns that make it are carried along.
    carried: Vec<Vector<D>>,
    /// What the strains at both points of each frame's Magnus step work as its own columns change; for the length and
    /// the reference strain of a rod.
    by_strain: Vec<[Vector<D>; 2]>,
}

/// The kind of a geometric parameter.
#[derive(Clone, Copy, Debug)]
enum Geometric {
    /// The length of a rod.
    RodLength(usize),
    /// The strain of a rod in the reference state along an axis.
    RodReference(usize, usize),
    /// The length of the link of a body.
    LinkLength(usize),
    /// A radius of the link of a body (moves its centroid): at the base or at the tip.
    LinkRadius(usize, bool),
    /// The radius of a rod at a point on whose surface something is attached.
    RodRadius(usize),
    /// The fraction of a link's or a rod's length at which something is attached.
    Along(usize),
    /// A component, along an axis in space, of the offset of points that these parameters hold.
    Offset(usize, usize),
    /// A component of a body's translation.
    Translation(usize, usize),
    /// A component of a body's rotation vector.
    Rotation(usize, usize),
}

impl<const D: usize, const P: usize> DesignVelocity<D, P> {
    /// Allocates for every geometric parameter in `wanted`.
    pub fn all<G: LieGroup<D, P>>(model: &Model<G, D, P>, wanted: &[usize]) -> Vec<Self> {
        let mut mask = vec![false; model.parameters().len()];
        wanted.iter().for_each(|i| mask[*i] = true);
        let (frames, points) = (model.frames.len(), model.points.len());
        let mut all = vec![];
        let mut push = |parameter: usize, kind| {
            if mask[parameter] {
                let [twists, carried] = [(); 2].map(|()| vec![Vector::ZERO; frames]);
                let points = vec![Vector::ZERO; points];
                let by_strain = vec![[Vector::ZERO; 2]; frames];
                all.push(Self { parameter, kind, acts: true, twists, points, carried, by_strain });
            }
        };
        for (r, rod) in model.rods.iter().enumerate() {
            push(rod.length, Geometric::RodLength(r));
            for (axis, mode) in G::AXES.into_iter().enumerate() {
                push(rod.reference_strain.start + mode.index(), Geometric::RodReference(r, axis));
            }
        }
        let mut surfaces: Vec<usize> = model.points.iter().flat_map(|p| rod_radii(model, p)).collect();
        surfaces.sort_unstable();
        surfaces.dedup();
        for radius in surfaces {
            push(radius, Geometric::RodRadius(radius));
        }
        for point in &model.points {
            match point.place {
                Place::Along(_, slot) => push(slot, Geometric::Along(slot)),
                Place::Between(between, 0) => push(between.slot, Geometric::Along(between.slot)),
                _ => {}
            }
        }
        let mut offsets: Vec<usize> = model.points.iter().filter_map(|point| point.offset).collect();
        offsets.dedup();
        for offset in offsets {
            (0..3).for_each(|k| push(offset + k, Geometric::Offset(offset, k)));
        }
        for (b, body) in model.bodies.iter().enumerate() {
            for k in 0..3 {
                push(body.translation.start + k, Geometric::Translation(b, k));
                push(body.rotation.start + k, Geometric::Rotation(b, k));
            }
            if let Shape::Link(link) = &body.shape {
                push(link.length, Geometric::LinkLength(b));
                push(link.radius_base, Geometric::LinkRadius(b, false));
                push(link.radius_tip, Geometric::LinkRadius(b, true));
            }
        }
        all
    }

    pub fn velocities(&self) -> Velocities<'_, D, P> {
        Velocities { twists: &self.twists, points: &self.points }
    }

    /// World twists of the frames and velocities of the points as the parameter changes.
    pub fn update<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>, data: &Data<G, D, P>) {
        let (kind, p) = (self.kind, &data.design.geometry.parameters);
        if let Geometric::RodRadius(radius) = kind {
            self.acts = model.points.iter().any(|point| holds_radius(model, p, point, radius));
            if !self.acts {
                // No frame moves with it.
                self.points.fill(Vector::ZERO);
                return;
            }
        }
        for (f, frame) in model.frames.iter().enumerate().skip(1) {
            self.twists[f] = self.twists[frame.parent] + own_twist(model, data, f, kind);
        }
        for (i, point) in model.points.iter().enumerate() {
            let (world, frame) = (&data.kinematics.points[i], data.design.geometry.frames[i]);
            let mut velocity = G::point_jacobian(world) * self.twists[frame];
            let along = match (point.place, kind) {
                (Place::Fraction(b, f), Geometric::LinkLength(body)) if b == body => f,
                (Place::Along(b, slot), Geometric::LinkLength(body)) if b == body => p[slot],
                (Place::Along(b, slot), Geometric::Along(moved)) if slot == moved => {
                    let Shape::Link(link) = &model.bodies[b].shape else { continue };
                    p[link.length]
                }
                (Place::Centroid(b), Geometric::LinkLength(body)) if b == body => {
                    link_fraction(&model.tree, p, point.place).1
                }
                (Place::Centroid(b), Geometric::LinkRadius(body, tip)) if b == body => {
                    let Shape::Link(link) = &model.bodies[b].shape else { continue };
                    link_fraction_slope(p, link, point.place)[usize::from(tip)] * p[link.length]
                }
                (Place::Between(between, side), Geometric::RodLength(rod)) if between.rod == rod => {
                    between.interval(&model.rods, p).arm(side)[0]
                }
                (Place::Between(between, side), Geometric::Along(moved)) if between.slot == moved => {
                    between.interval(&model.rods, p).arm(side)[1] * p[model.rods[between.rod].length]
                }
                _ => 0.0,
            };
            if along != 0.0 {
                velocity += data.kinematics.pose[frame].rotate(&Vector::unit(0)) * along;
            }
            if let Some((radius, direction)) = &point.surface {
                let rate = radius_rate(model, p, *radius, kind);
                velocity += data.kinematics.pose[frame].rotate(direction) * rate;
            }
            if let Geometric::Offset(slot, k) = kind
                && point.offset == Some(slot)
            {
                velocity += data.kinematics.pose[frame].rotate(&along_axis::<G, D, P>(k));
            }
            self.points[i] = velocity;
        }
        let forces = &data.assembly.terms.frames;
        for (f, frame) in model.frames.iter().enumerate().skip(1) {
            // Half of the frame's own twist: the other half is in the curvature of its exponential.
            let carrier = (self.twists[f] + self.twists[frame.parent]) * 0.5;
            let acts = !frame.columns.is_empty() && forces.loaded[f];
            self.carried[f] =
                if acts { G::ad(&carrier).transpose_times(&forces.wrench[f]) } else { Vector::ZERO };
            if self.strains_columns() {
                self.by_strain[f] = match frame.motion {
                    Motion::Strain(step) if acts => own_columns(model, data, (f, step), kind),
                    _ => [Vector::ZERO; 2],
                };
            }
        }
    }

    /// Whether the columns of a rod's frames themselves change.
    fn strains_columns(&self) -> bool {
        matches!(self.kind, Geometric::RodLength(_) | Geometric::RodReference(..))
    }

    /// Σ_i λ_i w̄_i·dS_i: the columns are carried by the frames before them, and on the rod whose length or
    /// reference strain changes they change themselves.
    ///
    /// The virtual motion is given by the twists of the frames relative to those before and the coordinates in blocks.
    pub fn column_work<G: LieGroup<D, P>>(
        &self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        own: &[Vector<D>],
        blocks: &[Vector<LANES>],
    ) -> f64 {
        let mut work = self.carried.iter().zip(own).map(|(wrench, twist)| wrench.dot(twist)).sum();
        if self.strains_columns() {
            for (f, duals) in
                self.by_strain.iter().enumerate().filter(|(_, duals)| **duals != [Vector::ZERO; 2])
            {
                let strain = strains(&model.tree, &data.design.geometry, f, blocks, Vector::ZERO);
                work += duals[0].dot(&strain[0]) + duals[1].dot(&strain[1]);
            }
        }
        work
    }
}

/// The parameters that may hold the radius of the rod on whose surface a point is.
fn rod_radii<G, const D: usize, const P: usize>(model: &Model<G, D, P>, point: &Point<P>) -> Range<usize> {
    match point.surface {
        Some((SphereRadius::Parameter(radius), _)) => radius..radius + 1,
        Some((SphereRadius::Between(between, _), _)) => model.rods[between.rod].radius.clone(),
        _ => 0..0,
    }
}

/// Whether this parameter holds the radius of the rod on whose surface a point is.
fn holds_radius<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    p: &[f64],
    point: &Point<P>,
    radius: usize,
) -> bool {
    match point.surface {
        Some((SphereRadius::Parameter(own), _)) => own == radius,
        Some((SphereRadius::Between(between, side), _)) => {
            radius_between(&model.tree, p, between, side) == radius
        }
        _ => false,
    }
}

/// The derivative of a radius with respect to a parameter.
fn radius_rate<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    p: &[f64],
    radius: SphereRadius,
    kind: Geometric,
) -> f64 {
    let wanted = match (radius, kind) {
        (SphereRadius::Parameter(k), Geometric::RodRadius(wanted)) if k == wanted => return 1.0,
        (SphereRadius::Between(between, side), Geometric::RodRadius(wanted)) => {
            return f64::from(radius_between(&model.tree, p, between, side) == wanted);
        }
        (SphereRadius::Link(b, _), Geometric::LinkRadius(body, tip)) if b == body => tip,
        (SphereRadius::Link(b, Place::Along(_, slot)), Geometric::Along(moved)) if slot == moved => {
            let Shape::Link(link) = &model.bodies[b].shape else { return 0.0 };
            return p[link.radius_tip] - p[link.radius_base];
        }
        _ => return 0.0,
    };
    let SphereRadius::Link(body, place) = radius else { return 0.0 };
    let Shape::Link(link) = &model.bodies[body].shape else { return 0.0 };
    let (_, f) = link_fraction(&model.tree, p, place);
    let taper = p[link.radius_tip] - p[link.radius_base];
    let moved = taper * link_fraction_slope(p, link, place)[usize::from(wanted)];
    if wanted { f + moved } else { 1.0 - f + moved }
}

/// The world twist that a parameter adds at frame `f` itself.
fn own_twist<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
    f: usize,
    kind: Geometric,
) -> Vector<D> {
    let frame = &model.frames[f];
    match (&frame.motion, kind) {
        (Motion::Strain(step), _) => {
            let Some([first, second]) = strain_change(model, data, *step, kind) else { return Vector::ZERO };
            let omega = &data.kinematics.omega[f];
            let tangent = G::tangent(omega, &data.kinematics.stumpff[f]);
            let (a1, a2, _) = data.kinematics.magnus_derivative(&model.tree, *step);
            data.kinematics.pose[f].adjoint() * (tangent * (a1 * first + a2 * second))
        }
        (Motion::Rigid(r), Geometric::LinkLength(b)) => match &model.bodies[b].shape {
            Shape::Link(link) if link.tip == *r => {
                let axis = data.kinematics.pose[f].rotate(&Vector::unit(0));
                translation_twist::<G, D, P>(&axis)
            }
            _ => Vector::ZERO,
        },
        (Motion::Rigid(r), Geometric::Translation(b, k)) if model.bodies[b].placement == *r => {
            let direction = along_axis::<G, D, P>(k);
            translation_twist::<G, D, P>(&data.kinematics.pose[frame.parent].rotate(&direction))
        }
        (Motion::Rigid(r), Geometric::Rotation(b, k)) if model.bodies[b].placement == *r => {
            let rotation = model.bodies[b].rotation.start;
            let mut omega = Vector::<D>::ZERO;
            let mut e = Vector::<D>::ZERO;
            for (i, mode) in crate::strain::Mode::ALL.into_iter().take(3).enumerate() {
                if let Some(axis) = G::axis(mode) {
                    omega[axis] = data.design.geometry.parameters[rotation + i];
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

/// The unit vector along an axis in space; none across the plane of a planar system.
fn along_axis<G: LieGroup<D, P>, const D: usize, const P: usize>(k: usize) -> Vector<P> {
    let mut e = [0.0; 3];
    e[k] = 1.0;
    G::point_from_spatial(&e).unwrap_or(Vector::ZERO)
}

/// A translation in the world as a twist.
fn translation_twist<G: LieGroup<D, P>, const D: usize, const P: usize>(direction: &Vector<P>) -> Vector<D> {
    // Moving the origin: the Jacobian of the point at the origin is [0 | 1].
    G::point_jacobian(&Vector::ZERO).transpose_times(direction)
}

/// The derivatives of the normalised strains at the two points of a Magnus step; none if they do not depend on
/// the parameter.
fn strain_change<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
    step: usize,
    kind: Geometric,
) -> Option<[Vector<D>; 2]> {
    let of_step = model.steps[step].rod;
    let p = &data.design.geometry.parameters;
    let rod = &model.rods[of_step];
    match kind {
        Geometric::RodLength(changed) if changed == of_step => {
            Some(data.kinematics.strain[step].map(|strain| {
                let mut d = Vector::ZERO;
                for (axis, mode) in G::AXES.into_iter().enumerate() {
                    let reference = p[rod.reference_strain.start + mode.index()];
                    d[axis] = if mode.is_angular() { reference } else { strain[axis] / p[rod.length] };
                }
                d
            }))
        }
        Geometric::RodReference(changed, axis) if changed == of_step => {
            Some([Vector::unit(axis) * p[rod.length]; 2])
        }
        _ => None,
    }
}

/// What virtual strains at both points of a step work by the second derivatives of its exponential and of its Ω, as a
/// parameter changes.
fn own_columns<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
    (f, step): (usize, usize),
    kind: Geometric,
) -> [Vector<D>; 2] {
    let Some(change) = strain_change(model, data, step, kind) else { return [Vector::ZERO; 2] };
    let length = data.design.geometry.parameters[model.rods[model.steps[step].rod].length];
    let (omega, stumpff) = (&data.kinematics.omega[f], &data.kinematics.stumpff[f]);
    let (a1, a2, commutator) = data.kinematics.magnus_derivative(&model.tree, step);
    let [body_wrench, on_omega] = data.assembly.duals[f];
    let curvature = G::tangent_curvature(omega, &body_wrench, stumpff);
    let curved = curvature.transpose_times(&(a1 * change[0] + a2 * change[1]));
    // κ ω̄·[δξ₁, ξ₂] and κ ω̄·[ξ₁, δξ₂], by ξ₂ and by ξ₁.
    let by_second = G::ad(&change[0]).transpose_times(&on_omega) * commutator;
    let by_first = G::ad(&change[1]).transpose_times(&on_omega) * -commutator;
    [(a1, by_first), (a2, by_second)].map(|(a, bracket)| {
        let mut explicit = a.transpose_times(&on_omega);
        for (axis, mode) in G::AXES.into_iter().enumerate() {
            // L scales the linear strains of the virtual motion.
            let scaled = matches!(kind, Geometric::RodLength(_)) && !mode.is_angular();
            explicit[axis] = if scaled { explicit[axis] / length } else { 0.0 };
        }
        a.transpose_times(&curved) + explicit + bracket
    })
}
