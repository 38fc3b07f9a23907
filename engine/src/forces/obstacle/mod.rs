//! Obstacles that spheres press on: ½ k max(d, 0)² with d = R − φ(x), for each sphere of radius R at x and
//! each surface, φ the distance from it. Bodies with a skin press on them at points along their length, with
//! the energy of an elastic foundation at this depth.
//!
//! An obstacle moves with the frame that carries it: what the sphere feels, the frame feels in the opposite
//! direction. A round cone, the convex hull of two spheres, is deepest in a plane at one of them; so its
//! spheres suffice there.

mod definition;
mod pressing;
mod skin;
mod surface;

pub use definition::ObstacleDescription;
pub use skin::ObstacleSkinDescription;
pub use surface::SurfaceDescription;

use super::crossing::{Crossing, Motion};
use super::differential::{Differential, Largest};
use super::element::{ContactForce, ForceElement, ForceMemory, Switch, Velocities, VirtualMotion};
use super::friction::{Direction, Pressed, PressedChange};
use super::magnitudes::Magnitudes;
use super::state::{Law, State};
use super::terms::Terms;
use crate::geometry::{add_radius_slope, radius_slope};
use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};
use crate::tolerances::SWITCHING_DISTANCE;
use crate::tree::{ModelError, Tree};
use definition::{Contact, Obstacle, Touchable};
use pressing::Pressing;
use surface::Slopes;

/// Depth, as a fraction of S, at which the stiffness of a closing skin is predicted.
const TYPICAL_DEPTH: f64 = 0.05;

/// All obstacles.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Obstacles<const P: usize>(Vec<Obstacle<P>>);

/// A sphere in an obstacle, or near it.
#[derive(Clone, Debug)]
pub(crate) struct Touch<const P: usize> {
    obstacle: usize,
    surface: usize,
    sphere: usize,
    skin: Option<usize>,
    depth: f64,
    pressing: Pressing,
    /// Unit vector out of the obstacle.
    normal: Vector<P>,
    /// Hessian of the distance, where it is not zero.
    curvature: Option<Matrix<P, P>>,
}

/// A kept force, with the indices of obstacle, surface and sphere.
type Kept = ([usize; 3], f64);

/// The spheres in contact.
#[derive(Clone, Debug)]
pub(crate) struct ObstacleState<const P: usize> {
    touching: Vec<Touch<P>>,
    kept: Vec<Kept>,
}

impl<const P: usize> Obstacles<P> {
    pub fn build<G: LieGroup<D, P>, const D: usize>(
        tree: &mut Tree<G, D, P>,
        obstacles: &[ObstacleDescription],
    ) -> Result<Self, ModelError> {
        obstacles.iter().map(|obstacle| Obstacle::build(tree, obstacle)).collect::<Result<_, _>>().map(Self)
    }

    /// Sum of the normal forces on each obstacle [N], from what the residual left.
    pub fn forces(&self, state: &ObstacleState<P>, out: &mut [f64]) {
        out.fill(0.0);
        state.touching.iter().for_each(|touch| out[touch.obstacle] += touch.pressing.force);
    }

    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Visits what presses on one of them; with a margin also spheres on springs that rest on it, at a gap below
    /// that, as if they were so deep.
    pub fn for_each_pressed<G: LieGroup<D, P>, const D: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
        state: &ObstacleState<P>,
        margin: f64,
        visit: &mut impl FnMut(Pressed<P>),
    ) {
        let mut press = |touch: &Touch<P>| {
            if touch.obstacle != index {
                return;
            }
            let (obstacle, point) = (&self.0[index], touch.point(at));
            if touch.skin.is_some() && touch.depth <= 0.0 {
                return;
            }
            let depth = if touch.skin.is_none() { touch.depth.max(margin) } else { touch.depth };
            let pressing = if depth > touch.depth {
                obstacle.pressing(at.parameters(), Contact { depth, ..touch.contact(at) })
            } else {
                touch.pressing
            };
            let inward = at.geometry.radii[touch.sphere] - 0.5 * touch.depth;
            visit(Pressed {
                sphere: touch.sphere,
                other: touch.surface,
                frames: [at.frame(point), obstacle.frame],
                place: *at.point(point) - touch.normal * inward,
                force: touch.normal * pressing.force,
                stiffness: pressing.stiffness,
                depth,
            });
        };
        if margin > 0.0 {
            self.for_each_near(at, margin, |_, touch| press(&touch));
        } else {
            state.touching.iter().for_each(press);
        }
    }

    /// Visits the changes of these, in the same order.
    pub fn for_each_pressed_change<G: LieGroup<D, P>, const D: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
        state: &ObstacleState<P>,
        direction: &Direction<D, P>,
        visit: &mut impl FnMut(PressedChange<P>),
    ) {
        for (obstacle, touch) in self.touching(state).filter(|(_, touch)| touch.obstacle == index) {
            let (point, n, velocities) = (touch.point(at), touch.normal, &direction.velocities);
            let radius = at.tree.spheres[touch.sphere].radius;
            let radius =
                direction.parameter.map_or(0.0, |slot| radius_slope(at.tree, at.parameters(), radius, slot));
            let surface = obstacle.surfaces[touch.surface].radius();
            let [grown, wider] = surface.map_or([0.0; 2], |(slot, by_radius)| {
                [by_radius, 1.0].map(|slope| slope * direction.of(slot))
            });
            let mut moved = obstacle.relative_velocity(at, velocities, point);
            obstacle.for_each_shift(at, touch, |slot, shift| moved += shift * direction.of(slot));
            let depth = radius - grown - n.dot(&moved);
            let mut normal = touch.curvature.map_or(Vector::ZERO, |curvature| curvature * moved);
            if obstacle.frame != 0 {
                normal += velocities.shifted::<G>(obstacle.frame, &n);
            }
            let [force, stiffness] = obstacle.change_of_pressing(
                at.parameters(),
                touch.contact(at),
                [depth, radius, wider],
                |slot| direction.of(slot),
            );
            let inward = at.geometry.radii[touch.sphere] - 0.5 * touch.depth;
            visit(PressedChange {
                place: velocities.points[point] - normal * inward - n * (radius - 0.5 * depth),
                force: n * force + normal * touch.pressing.force,
                stiffness,
                depth,
            });
        }
    }

    /// Largest pressure of a skin on one of them [Pa].
    pub fn largest_pressure(&self, state: &ObstacleState<P>) -> f64 {
        state.touching.iter().filter_map(|touch| touch.pressing.pressure).fold(0.0, f64::max)
    }

    /// Adds a multiple of the change of the largest pressure of a skin on one of them.
    pub fn add_pressure<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        state: &ObstacleState<P>,
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        let mut largest = Largest::new();
        for touch in &state.touching {
            if let Some(pressure) = touch.pressing.pressure {
                let is_same = |other: &&Touch<P>| {
                    (other.obstacle, other.sphere, other.surface)
                        == (touch.obstacle, touch.sphere, touch.surface)
                };
                largest.offer(pressure, touch, is_same);
            }
        }
        let Some(touch) = largest.place else { return };
        out.tied |= largest.tied;
        let obstacle = &self.0[touch.obstacle];
        let Some((slot, k)) = obstacle.foundation(at.parameters(), touch.contact(at)) else { return };
        let slope = k * weight;
        obstacle.add_sinking(at, touch, slope, out);
        out.parameters[slot] += weight * touch.depth;
        add_radius_slope(
            at.tree,
            at.parameters(),
            at.tree.spheres[touch.sphere].radius,
            slope,
            &mut out.parameters,
        );
        if let Some((slot, by_radius)) = obstacle.surfaces[touch.surface].radius() {
            out.parameters[slot] -= by_radius * slope;
        }
    }

    /// Adds a multiple of the change of the force on one of them.
    pub fn add_force<G: LieGroup<D, P>, const D: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
        state: &ObstacleState<P>,
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        let obstacle = &self.0[index];
        for touch in state.touching.iter().filter(|touch| touch.obstacle == index) {
            let slope = touch.pressing.stiffness * weight;
            obstacle.add_sinking(at, touch, slope, out);
            obstacle.add_slopes_at_depth(at, touch, weight, &mut out.parameters);
        }
    }

    /// Visits the spheres whose gap to a surface is below `margin`.
    #[inline]
    fn for_each_near<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        margin: f64,
        mut visit: impl FnMut(&Obstacle<P>, Touch<P>),
    ) {
        for (index, obstacle) in self.0.iter().enumerate() {
            let axes = obstacle.world_axes(at);
            let origin = obstacle.origin(at);
            for &each in &obstacle.spheres {
                let Touchable { sphere, skin } = each;
                let r = *at.centre(sphere) - origin;
                let place = Vector(std::array::from_fn(|i| axes[i].dot(&r)));
                let radius = at.geometry.radii[sphere];
                for (s, surface) in obstacle.surfaces.iter().enumerate() {
                    let depth = radius - surface.distance(at.parameters(), &place);
                    if depth > -margin {
                        let Slopes { normal, curvature } = surface.slopes(at.parameters(), &axes, &place);
                        let contact = Contact { each, surface: s, radius, depth };
                        let pressing = obstacle.pressing(at.parameters(), contact);
                        visit(
                            obstacle,
                            Touch {
                                obstacle: index,
                                surface: s,
                                sphere,
                                skin,
                                depth,
                                pressing,
                                normal,
                                curvature,
                            },
                        );
                    }
                }
            }
        }
    }

    /// The spheres in contact with their obstacle.
    fn touching<'a>(
        &'a self,
        state: &'a ObstacleState<P>,
    ) -> impl Iterator<Item = (&'a Obstacle<P>, &'a Touch<P>)> {
        state.touching.iter().map(|touch| (&self.0[touch.obstacle], touch))
    }
}

impl<const P: usize> Touch<P> {
    /// Whether a kept force is that of this sphere on this surface.
    fn has(&self, (of, _): &Kept) -> bool {
        *of == [self.obstacle, self.surface, self.sphere]
    }

    /// The sphere's point.
    fn point<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>) -> usize {
        at.tree.spheres[self.sphere].point
    }

    fn contact<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>) -> Contact {
        let each = Touchable { sphere: self.sphere, skin: self.skin };
        Contact { each, surface: self.surface, radius: at.geometry.radii[self.sphere], depth: self.depth }
    }

    /// Hessian of the energy by the sphere's place in the obstacle, of a curved surface.
    fn form(&self) -> Option<Matrix<P, P>> {
        let (curvature, Pressing { force, stiffness, .. }) = (self.curvature?, self.pressing);
        Some(self.normal.outer(&self.normal) * stiffness - curvature * force)
    }

    /// The change of the work of the force on a velocity as the sphere moves in the obstacle, its normal not
    /// turning with the obstacle.
    fn work_of_shift(&self, change: &Vector<P>, virtual_change: &Vector<P>) -> f64 {
        let n = &self.normal;
        let curved = self.curvature.map_or(0.0, |curvature| (curvature * *change).dot(virtual_change));
        let Pressing { force, stiffness, .. } = self.pressing;
        stiffness * n.dot(change) * n.dot(virtual_change) - force * curved
    }
}

impl<const P: usize> Obstacle<P> {
    #[inline]
    fn world_axes<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>) -> [Vector<P>; P] {
        self.axes.map(|axis| at.kinematics.pose[self.frame].rotate(&axis))
    }

    /// Its origin in the world.
    #[inline]
    fn origin<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>) -> Vector<P> {
        let offset = Vector(std::array::from_fn(|i| at.parameters()[self.offset + i]));
        *at.point(self.point) + at.kinematics.pose[self.frame].rotate(&offset)
    }

    /// A sphere's centre in the obstacle's axes.
    fn place<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        axes: &[Vector<P>; P],
        sphere: usize,
    ) -> Vector<P> {
        let r = *at.centre(sphere) - self.origin(at);
        Vector(std::array::from_fn(|i| axes[i].dot(&r)))
    }

    /// Adds a multiple of the change of the depth of a sphere, radii held.
    fn add_sinking<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        touch: &Touch<P>,
        slope: f64,
        out: &mut Differential<D, P>,
    ) {
        let point = touch.point(at);
        out.points.push((point, touch.normal * -slope));
        out.points.push((self.point, touch.normal * slope));
        if self.frame != 0 {
            let arm = *at.point(point) - *at.point(self.point);
            let turning = G::point_jacobian(&arm) - G::point_jacobian(&Vector::ZERO);
            out.frames.push((self.frame, turning.transpose_times(&(touch.normal * slope))));
        }
        self.for_each_shift(at, touch, |slot, shift| {
            out.parameters[slot] -= slope * touch.normal.dot(&shift);
        });
    }

    /// Visits the parameters by which a sphere's place relative to the surface shifts, with the derivative of
    /// that place.
    fn for_each_shift<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        touch: &Touch<P>,
        mut visit: impl FnMut(usize, Vector<P>),
    ) {
        let pose = &at.kinematics.pose[self.frame];
        (0..P).for_each(|i| visit(self.offset + i, -pose.rotate(&Vector::unit(i))));
        let axes = self.world_axes(at);
        let place = self.place(at, &axes, touch.sphere);
        for (i, slot, sign) in self.surfaces[touch.surface].faces(at.parameters(), &place) {
            visit(slot, axes[i] * -sign);
        }
    }

    /// Adds a multiple of the derivative of the force by every parameter, the place of the sphere held.
    fn add_slopes_at_depth<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        touch: &Touch<P>,
        factor: f64,
        out: &mut [f64],
    ) {
        let Touch { surface, sphere, pressing, .. } = *touch;
        let more = self.add_slopes(at.parameters(), touch.contact(at), factor, out);
        let slope = factor * pressing.stiffness + more.by_surface;
        add_radius_slope(at.tree, at.parameters(), at.tree.spheres[sphere].radius, slope, out);
        if let Some((slot, by_radius)) = self.surfaces[surface].radius() {
            out[slot] += more.by_radius - factor * by_radius * pressing.stiffness;
        }
    }

    /// Velocity with which the obstacle moves where a point of the tree is.
    fn velocity<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        velocities: &Velocities<D, P>,
        point: usize,
    ) -> Vector<P> {
        let arm = *at.point(point) - *at.point(self.point);
        velocities.points[self.point] + velocities.shifted::<G>(self.frame, &arm)
    }

    /// Velocity of a point of the tree as seen from the obstacle.
    fn relative_velocity<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        velocities: &Velocities<D, P>,
        point: usize,
    ) -> Vector<P> {
        let own = velocities.points[point];
        if self.frame == 0 { own } else { own - self.velocity(at, velocities, point) }
    }
}

impl<const P: usize> ForceMemory<P> for Obstacles<P> {
    type Design = ();
    type State = ObstacleState<P>;
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Obstacles<P> {
    fn design(&self, _: &Tree<G, D, P>) {}

    fn state(&self, _: &Tree<G, D, P>) -> ObstacleState<P> {
        let most = self.0.iter().map(|obstacle| obstacle.spheres.len() * obstacle.surfaces.len()).sum();
        ObstacleState { touching: Vec::with_capacity(most), kept: vec![] }
    }

    fn is_admissible(&self, parameters: &[f64]) -> bool {
        self.0.iter().all(|obstacle| obstacle.is_admissible(parameters))
    }

    fn max_couplings(&self) -> usize {
        let carried = self.0.iter().filter(|obstacle| obstacle.frame != 0);
        carried.map(|obstacle| obstacle.spheres.len() * obstacle.surfaces.len()).sum()
    }

    fn has_switches(&self) -> bool {
        !self.0.is_empty()
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &mut ObstacleState<P>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        let ObstacleState { touching, kept } = state;
        touching.clear();
        let margin = if at.law == Law::Actual { 0.0 } else { f64::INFINITY };
        self.for_each_near(at, margin, |obstacle, mut near| {
            if at.law != Law::Actual {
                let found = kept.iter().find(|kept| near.has(kept));
                if found.is_none() && near.depth <= 0.0 {
                    return;
                }
                if at.law == Law::Kept && near.skin.is_none() {
                    let k = at.parameters()[obstacle.stiffness];
                    near.depth = found.map_or(0.0, |kept| kept.1 / k);
                    near.pressing = Pressing::of_spring(k, near.depth);
                }
            }
            touching.push(near);
        });
        for (obstacle, touch) in self.touching(state) {
            let point = touch.point(at);
            out.energy += touch.pressing.energy;
            let force = touch.normal * -touch.pressing.force;
            out.add_force::<G, P>(at.frame(point), at.point(point), &force);
            if obstacle.frame != 0 {
                out.add_force::<G, P>(obstacle.frame, at.point(point), &-force);
            }
        }
    }

    fn add_tangent(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &ObstacleState<P>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        for (obstacle, touch) in self.touching(state) {
            let point = touch.point(at);
            let (frame, p, n) = (at.frame(point), at.point(point), &touch.normal);
            let jacobian = G::point_jacobian(p);
            let force = *n * -touch.pressing.force;
            let form = touch.form().map_or_else(
                || {
                    let row = jacobian.transpose_times(n);
                    row.outer(&row) * touch.pressing.stiffness
                },
                |form| jacobian.transpose() * (form * jacobian),
            );
            if obstacle.frame == 0 {
                out.stiffness[frame] += form;
                out.add_curvature::<G, P>(frame, p, &force);
            } else {
                out.add_carried::<G, P>([frame, obstacle.frame], p, &force, form);
            }
        }
    }

    fn for_each_stiffness(&self, _: &[f64], visit: &mut impl FnMut(usize, f64)) {
        let sprung = self.0.iter().filter(|obstacle| obstacle.has_springs());
        sprung.for_each(|obstacle| visit(obstacle.stiffness, 1.0));
    }

    fn keep(&self, at: &State<G, D, P>, motion: &Velocities<D, P>, state: &mut ObstacleState<P>) {
        let before = std::mem::take(&mut state.kept);
        self.for_each_near(at, f64::INFINITY, |obstacle, near| {
            let acts = near.skin.is_none() && (near.depth > 0.0 || before.iter().any(|kept| near.has(kept)));
            let moved = obstacle.relative_velocity(at, motion, near.point(at));
            let depth = near.depth - near.normal.dot(&moved);
            if acts && depth > 0.0 {
                let force = at.parameters()[obstacle.stiffness] * depth;
                state.kept.push(([near.obstacle, near.surface, near.sphere], force));
            }
        });
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, _: &(), state: &ObstacleState<P>, out: &mut Magnitudes<P>) {
        for (obstacle, touch) in self.touching(state) {
            let point = touch.point(at);
            let places =
                at.point(point).norm() + obstacle.origin(at).norm() + at.geometry.radii[touch.sphere];
            let Pressing { force, stiffness, .. } = touch.pressing;
            out.add_of_distance(at, point, force, [stiffness, places]);
            if obstacle.frame != 0 {
                out.add_of_distance_at(obstacle.frame, *at.point(point), force, [stiffness, places]);
            }
        }
    }

    fn for_each_switch(
        &self,
        at: &State<G, D, P>,
        _: &ObstacleState<P>,
        margin: f64,
        visit: &mut impl FnMut(Switch<P>),
    ) {
        self.for_each_near(at, margin, |obstacle, touch| {
            let point = touch.point(at);
            let contact = touch.contact(at);
            let depth = if touch.depth > 0.0 { touch.depth } else { TYPICAL_DEPTH * contact.radius };
            let expected = obstacle.pressing(at.parameters(), Contact { depth, ..contact });
            visit(Switch {
                points: [point, obstacle.point, obstacle.point],
                t: 0.0,
                own: None,
                carrier: (obstacle.frame != 0).then(|| (obstacle.frame, *at.point(point))),
                normal: touch.normal,
                depth: touch.depth,
                stiffness: expected.stiffness,
            });
        });
    }

    fn switched_on(&self, _: &State<G, D, P>, state: &ObstacleState<P>) -> usize {
        state.touching.len()
    }

    fn has_solids(&self) -> bool {
        !self.0.is_empty()
    }

    fn thinnest(&self, at: &State<G, D, P>) -> f64 {
        let each = self.0.iter().flat_map(|obstacle| {
            let radii = obstacle.spheres.iter().map(|each| at.geometry.radii[each.sphere]);
            let smallest = radii.fold(f64::INFINITY, f64::min);
            let own = obstacle.surfaces.iter().filter_map(|surface| surface.thickness(at.parameters()));
            own.map(move |own| if obstacle.frame == 0 { own + smallest } else { 0.0 })
        });
        each.fold(f64::INFINITY, f64::min)
    }

    fn for_each_crossing(&self, motion: &Motion<G, D, P>, visit: &mut impl FnMut(Crossing)) {
        let ends = motion.ends;
        let (p, units) = (ends[0].parameters(), std::array::from_fn(Vector::unit));
        for obstacle in &self.0 {
            let axes = ends.map(|at| obstacle.world_axes(at));
            for each in &obstacle.spheres {
                let radius = ends[0].geometry.radii[each.sphere] + motion.margin;
                let [before, after] = [0, 1].map(|i| obstacle.place(ends[i], &axes[i], each.sphere));
                for surface in &obstacle.surfaces {
                    let Some(thickness) = surface.thickness(p).map(|own| own + radius) else { continue };
                    let near = surface.distance(p, &before) < radius + (after - before).norm();
                    if near {
                        let depth = |place: &Vector<P>| {
                            let depth = radius - surface.distance(p, place);
                            (depth, surface.slopes(p, &units, place).normal)
                        };
                        let last = |end: &State<G, D, P>| {
                            obstacle.place(end, &obstacle.world_axes(end), each.sphere)
                        };
                        let found = motion.crossing(thickness, [before, after], depth, last);
                        found.into_iter().for_each(&mut *visit);
                    }
                }
            }
        }
    }

    fn at_threshold(&self, at: &State<G, D, P>, moves: &impl Fn(&[usize], &Vector<P>) -> bool) -> bool {
        let mut found = false;
        self.for_each_near(at, SWITCHING_DISTANCE * largest(&at.geometry.radii), |obstacle, touch| {
            let size = at.geometry.radii[touch.sphere];
            let points = [touch.point(at), obstacle.point];
            let points = if obstacle.frame == 0 { &points[..1] } else { &points };
            if touch.depth.abs() < SWITCHING_DISTANCE * size {
                // Skins touch smoothly.
                found |= touch.skin.is_none() && moves(points, &touch.normal);
            } else if touch.depth > 0.0 {
                let axes = obstacle.world_axes(at);
                let place = obstacle.place(at, &axes, touch.sphere);
                let mut seams = obstacle.surfaces[touch.surface].seams(at.parameters(), &place, size);
                found |= seams.any(|i| moves(points, &axes[i]));
            }
        });
        found
    }

    fn contact_forces(&self, at: &State<G, D, P>, state: &ObstacleState<P>, out: &mut Vec<ContactForce<P>>) {
        for touch in &state.touching {
            let inward = at.geometry.radii[touch.sphere] - 0.5 * touch.depth;
            out.push(ContactForce {
                first: touch.sphere,
                second: None,
                nearest: None,
                obstacle: Some(touch.obstacle),
                cone: false,
                force: touch.normal * touch.pressing.force,
                depth: touch.depth,
                pressure: touch.pressing.pressure,
                point: *at.point(touch.point(at)) - touch.normal * inward,
            });
        }
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &ObstacleState<P>,
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        for (obstacle, touch) in self.touching(state) {
            let moved = obstacle.relative_velocity(at, &motion.velocities, touch.point(at));
            obstacle.add_slopes_at_depth(at, touch, -touch.normal.dot(&moved), gradient);
            obstacle.for_each_shift(at, touch, |slot, shift| {
                gradient[slot] += touch.work_of_shift(&shift, &moved);
            });
        }
    }

    fn add_geometric_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &ObstacleState<P>,
        motion: &VirtualMotion<D, P>,
        velocities: &Velocities<D, P>,
        work: &mut f64,
    ) {
        for (obstacle, touch) in self.touching(state) {
            let (point, n) = (touch.point(at), &touch.normal);
            let own = &velocities.points[point];
            let change = obstacle.relative_velocity(at, velocities, point);
            let virtual_change = obstacle.relative_velocity(at, &motion.velocities, point);
            let mut turned = n.dot(&motion.velocities.shifted::<G>(at.frame(point), own));
            if obstacle.frame != 0 {
                turned -= n.dot(&motion.velocities.shifted::<G>(obstacle.frame, own));
                turned += velocities.shifted::<G>(obstacle.frame, n).dot(&virtual_change);
            }
            *work += touch.work_of_shift(&change, &virtual_change) - touch.pressing.force * turned;
        }
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}
