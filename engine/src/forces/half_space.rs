//! Fixed planes that spheres press on: ½ k max(d, 0)² with d = R − n·(p − o), for each sphere.
//!
//! A round cone, the convex hull of two spheres, is deepest in a plane at one of them; so spheres
//! suffice for groups of round cones, too.

use super::differential::Differential;
use super::element::{ContactForce, ForceElement, ForceMemory, Switch, Velocities, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::state::{Law, State};
use super::terms::Terms;
use crate::geometry::add_radius_slope;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tolerances::{SWITCHING_DISTANCE, UNIT_NORM};
use crate::tree::description::AttachmentDescription;
use crate::tree::{ModelError, Tree, finite, positive};
use serde::Deserialize;

/// A fixed plane and the sphere groups in contact with it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HalfSpaceDescription {
    /// Unique name.
    pub name: String,
    /// The sphere groups.
    pub spheres: Vec<String>,
    /// A point of the plane [m].
    pub point: [f64; 3],
    /// Unit vector out of the obstacle.
    pub normal: [f64; 3],
    /// Contact stiffness k of each sphere [N/m].
    pub stiffness: f64,
}

#[derive(Clone, Debug, PartialEq)]
struct HalfSpace<const P: usize> {
    spheres: Vec<usize>,
    /// A point of the tree, fixed in the world.
    point: usize,
    normal: Vector<P>,
    /// Parameter holding k.
    stiffness: usize,
}

/// All half-spaces.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HalfSpaces<const P: usize>(Vec<HalfSpace<P>>);

/// A sphere in a half-space.
#[derive(Clone, Debug)]
pub(crate) struct Pressed {
    half_space: usize,
    sphere: usize,
    depth: f64,
}

/// The spheres in contact.
#[derive(Clone, Debug)]
pub(crate) struct HalfSpaceState {
    pressed: Vec<Pressed>,
    /// The kept forces, with the indices of half-space and sphere.
    kept: Vec<(usize, usize, f64)>,
}

impl<const P: usize> HalfSpaces<P> {
    pub fn build<G: LieGroup<D, P>, const D: usize>(
        tree: &mut Tree<G, D, P>,
        half_spaces: &[HalfSpaceDescription],
    ) -> Result<Self, ModelError> {
        let mut built = vec![];
        for half_space in half_spaces {
            let field = |f: &str| format!("half_spaces.{}.{f}", half_space.name);
            positive(field("stiffness"), half_space.stiffness)?;
            finite(field("normal"), &half_space.normal)?;
            let normal = G::point_from_spatial(&half_space.normal)
                .ok_or_else(|| ModelError::new(field("normal"), "leaves the x–z plane of a planar system"))?;
            if (normal.norm() - 1.0).abs() > UNIT_NORM {
                let problem = format!("found {:?}, must be a unit vector", half_space.normal);
                return Err(ModelError::new(field("normal"), problem));
            }
            let mut spheres = vec![];
            for group in &half_space.spheres {
                spheres.extend(tree.sphere_group(&field("spheres"), group)?);
            }
            let world = AttachmentDescription::World { world: half_space.point };
            let point = tree.attach(&field("point"), &world)?;
            let stiffness =
                tree.slot(format!("{}.stiffness", half_space.name), "N/m", &[half_space.stiffness]).start;
            built.push(HalfSpace { spheres, point, normal, stiffness });
        }
        Ok(Self(built))
    }

    /// Force on each half-space along its normal [N], from what the residual left.
    pub fn forces<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        state: &HalfSpaceState,
    ) -> Vec<f64> {
        let mut forces = vec![0.0; self.0.len()];
        for Pressed { half_space, depth, .. } in &state.pressed {
            forces[*half_space] += at.parameters()[self.0[*half_space].stiffness] * depth;
        }
        forces
    }

    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Adds a multiple of the change of the force on one of them.
    pub fn add_force<G: LieGroup<D, P>, const D: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
        state: &HalfSpaceState,
        weight: f64,
        out: &mut Differential<P>,
    ) {
        let pressed = state.pressed.iter().filter(|pressed| pressed.half_space == index);
        for Pressed { sphere, depth, .. } in pressed {
            let HalfSpace { point, normal, stiffness, .. } = &self.0[index];
            let slope = at.parameters()[*stiffness] * weight;
            out.points.push((at.tree.spheres[*sphere].point, *normal * -slope));
            out.points.push((*point, *normal * slope));
            out.parameters[*stiffness] += depth * weight;
            out.add_radius(at.tree, at.parameters(), *sphere, slope);
        }
    }

    /// Visits the spheres whose gap to a half-space is below `margin`.
    #[inline]
    fn for_each_near<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        margin: f64,
        mut visit: impl FnMut(&HalfSpace<P>, Pressed),
    ) {
        for (index, half_space) in self.0.iter().enumerate() {
            for &sphere in &half_space.spheres {
                let depth = half_space.depth(at, sphere);
                if depth > -margin {
                    visit(half_space, Pressed { half_space: index, sphere, depth });
                }
            }
        }
    }

    /// The spheres in contact: half-space, its stiffness, sphere, point of the sphere and depth.
    fn pressed<'a, G: LieGroup<D, P>, const D: usize>(
        &'a self,
        at: &'a State<G, D, P>,
        pressed: &'a [Pressed],
    ) -> impl Iterator<Item = (&'a HalfSpace<P>, f64, usize, usize, f64)> {
        pressed.iter().map(|&Pressed { half_space, sphere, depth }| {
            let half_space = &self.0[half_space];
            let k = at.parameters()[half_space.stiffness];
            (half_space, k, sphere, at.tree.spheres[sphere].point, depth)
        })
    }
}

impl Pressed {
    /// Whether a kept force is that of this sphere.
    fn has(&self, (half_space, sphere, _): &(usize, usize, f64)) -> bool {
        self.half_space == *half_space && self.sphere == *sphere
    }
}

impl<const P: usize> HalfSpace<P> {
    #[inline]
    fn depth<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>, sphere: usize) -> f64 {
        let r = *at.point(at.tree.spheres[sphere].point) - *at.point(self.point);
        at.geometry.radii[sphere] - self.normal.dot(&r)
    }
}

impl<const P: usize> ForceMemory<P> for HalfSpaces<P> {
    type Design = ();
    type State = HalfSpaceState;
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for HalfSpaces<P> {
    fn design(&self, _: &Tree<G, D, P>) {}

    fn state(&self, _: &Tree<G, D, P>) -> HalfSpaceState {
        let most = self.0.iter().map(|half_space| half_space.spheres.len()).sum();
        HalfSpaceState { pressed: Vec::with_capacity(most), kept: vec![] }
    }

    fn is_admissible(&self, parameters: &[f64]) -> bool {
        self.0.iter().all(|half_space| parameters[half_space.stiffness] >= 0.0)
    }

    fn has_switches(&self) -> bool {
        !self.0.is_empty()
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &mut HalfSpaceState,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        let HalfSpaceState { pressed, kept } = state;
        pressed.clear();
        let margin = if at.law == Law::Actual { 0.0 } else { f64::INFINITY };
        self.for_each_near(at, margin, |half_space, mut near| {
            if at.law != Law::Actual {
                let found = kept.iter().find(|kept| near.has(kept));
                if found.is_none() && near.depth <= 0.0 {
                    return;
                }
                if at.law == Law::Kept {
                    near.depth = found.map_or(0.0, |kept| kept.2 / at.parameters()[half_space.stiffness]);
                }
            }
            pressed.push(near);
        });
        for (half_space, k, _, point, depth) in self.pressed(at, pressed) {
            out.energy += 0.5 * k * depth * depth;
            out.add_force::<G, P>(at.frame(point), at.point(point), &(half_space.normal * (-k * depth)));
        }
    }

    fn add_tangent(
        &self,
        at: &State<G, D, P>,
        _: &(),
        HalfSpaceState { pressed: state, .. }: &HalfSpaceState,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        for (half_space, k, _, point, depth) in self.pressed(at, state) {
            let (frame, p, n) = (at.frame(point), at.point(point), &half_space.normal);
            let row = G::point_jacobian(p).transpose_times(n);
            out.stiffness[frame] += row.outer(&row) * k;
            out.add_curvature::<G, P>(frame, p, &(*n * (-k * depth)));
        }
    }

    fn for_each_stiffness(&self, _: &[f64], visit: &mut impl FnMut(usize, f64)) {
        self.0.iter().for_each(|half_space| visit(half_space.stiffness, 1.0));
    }

    fn keep(&self, at: &State<G, D, P>, motion: &[Vector<P>], state: &mut HalfSpaceState) {
        let before = std::mem::take(&mut state.kept);
        self.for_each_near(at, f64::INFINITY, |half_space, near| {
            let acts = near.depth > 0.0 || before.iter().any(|kept| near.has(kept));
            let depth = near.depth - half_space.normal.dot(&motion[at.tree.spheres[near.sphere].point]);
            if acts && depth > 0.0 {
                let force = at.parameters()[half_space.stiffness] * depth;
                state.kept.push((near.half_space, near.sphere, force));
            }
        });
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, _: &(), state: &HalfSpaceState, out: &mut Magnitudes<P>) {
        for (half_space, k, sphere, point, depth) in self.pressed(at, &state.pressed) {
            let places =
                at.point(point).norm() + at.point(half_space.point).norm() + at.geometry.radii[sphere];
            out.add_of_distance(at, point, k * depth, [k, places]);
        }
    }

    fn for_each_switch(
        &self,
        at: &State<G, D, P>,
        _: &HalfSpaceState,
        margin: f64,
        visit: &mut impl FnMut(Switch<P>),
    ) {
        self.for_each_near(at, margin, |half_space, Pressed { sphere, depth, .. }| {
            visit(Switch {
                points: [at.tree.spheres[sphere].point, half_space.point, half_space.point],
                t: 0.0,
                normal: half_space.normal,
                depth,
                stiffness: at.parameters()[half_space.stiffness],
            });
        });
    }

    fn at_threshold(&self, at: &State<G, D, P>, moves: &impl Fn(&[usize], &Vector<P>) -> bool) -> bool {
        self.0.iter().any(|half_space| {
            half_space.spheres.iter().any(|&sphere| {
                half_space.depth(at, sphere).abs() < SWITCHING_DISTANCE * at.geometry.radii[sphere]
                    && moves(&[at.tree.spheres[sphere].point], &half_space.normal)
            })
        })
    }

    fn contact_forces(&self, at: &State<G, D, P>, state: &HalfSpaceState, out: &mut Vec<ContactForce<P>>) {
        for (half_space, k, first, point, depth) in self.pressed(at, &state.pressed) {
            let normal = half_space.normal;
            let inward = at.geometry.radii[first] - 0.5 * depth;
            out.push(ContactForce {
                first,
                second: None,
                nearest: None,
                cone: false,
                force: normal * (k * depth),
                depth,
                pressure: None,
                point: *at.point(point) - normal * inward,
            });
        }
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        HalfSpaceState { pressed: state, .. }: &HalfSpaceState,
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        for (half_space, k, sphere, point, depth) in self.pressed(at, state) {
            let closing = -half_space.normal.dot(&motion.velocities.points[point]);
            gradient[half_space.stiffness] += depth * closing;
            let radius = at.tree.spheres[sphere].radius;
            add_radius_slope(at.tree, at.parameters(), radius, k * closing, gradient);
        }
    }

    fn add_geometric_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        HalfSpaceState { pressed: state, .. }: &HalfSpaceState,
        motion: &VirtualMotion<D, P>,
        velocities: &Velocities<D, P>,
        work: &mut f64,
    ) {
        for (half_space, k, _, point, depth) in self.pressed(at, state) {
            let (n, velocity) = (&half_space.normal, &velocities.points[point]);
            let shifted = motion.velocities.shifted::<G>(at.frame(point), velocity);
            *work +=
                k * (n.dot(velocity) * n.dot(&motion.velocities.points[point]) - depth * n.dot(&shifted));
        }
    }
}
