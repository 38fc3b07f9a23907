//! Contact of a rod with round links through the elastic foundation of their skins.
//!
//! The overlap of rod and link is taken up by their skins, as if these were independent springs. It is
//! integrated across in closed form and along the rod at points with weights.

mod attached;
mod definition;
mod strap_loop;
mod strip;
mod touch;

pub use definition::FoundationDescription;
pub use strap_loop::StrapLoopDescription;
pub(crate) use strap_loop::StrapLoops;

use super::contact::{Closest, ContactSummary, closest, direction, is_far};
use super::differential::{Depth, Differential, Largest};
use super::element::{ContactForce, ForceElement, ForceMemory, Switch, Velocities, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::state::State;
use super::terms::Terms;
use crate::geometry::add_radius_slope;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tolerances::{SAME_FORCE, SWITCHING_DISTANCE};
use crate::tree::{ModelError, Tree};
use attached::{points, relative};
use definition::Foundation;
use touch::{Change, Near, RADII, STIFFNESS, SURFACE, Touch, WIDTH};

/// All elastic foundations.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Foundations(Vec<Foundation>);

/// Depth, as a fraction of S, at which the stiffness of a closing contact is predicted.
const TYPICAL_DEPTH: f64 = 0.05;

impl Foundations {
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        foundations: &[FoundationDescription],
    ) -> Result<Self, ModelError> {
        foundations.iter().map(|d| Foundation::build(tree, d)).collect::<Result<_, _>>().map(Self)
    }

    /// Visits the round cones whose gap to a point with weight is below `margin` and, with negative
    /// weight, the spheres that two of these share.
    #[inline]
    fn for_each_near<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        margin: f64,
        mut visit: impl FnMut(Near<P>),
    ) {
        for index in 0..self.0.len() {
            self.0[index].weighted.iter().for_each(|first| self.near(at, index, *first, margin, &mut visit));
        }
    }

    /// Visits everything that touches, also at points without weight.
    fn for_each_touch<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        mut visit: impl FnMut(Touch<P>),
    ) {
        for (index, foundation) in self.0.iter().enumerate() {
            let mut visit = |near| visit(Touch::new(foundation, at.parameters(), &near));
            foundation.first.clone().for_each(|first| self.near(at, index, first, 0.0, &mut visit));
        }
    }

    /// Visits what is near one point.
    #[inline]
    fn near<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        index: usize,
        first: usize,
        margin: f64,
        visit: &mut impl FnMut(Near<P>),
    ) {
        let foundation = &self.0[index];
        let centre = |sphere: usize| at.point(at.tree.spheres[sphere].point);
        let (p, surface) = (centre(first), at.geometry.radii[first]);
        let weight = at.parameters()[foundation.length] * foundation.weights[first - foundation.first.start];
        for (c, cone) in foundation.cones.iter().enumerate() {
            let ends = cone.ends.map(centre);
            let radii = cone.ends.map(|end| at.geometry.radii[end]);
            if is_far(p, ends, surface + radii[0].max(radii[1]) + margin) {
                continue;
            }
            let axis = *ends[1] - *ends[0];
            let mut near = |weight, found: Closest<P>| {
                let depth = surface + found.radius - found.distance;
                if depth > -margin {
                    visit(Near {
                        foundation: index,
                        first,
                        cone: c,
                        weight,
                        surface,
                        radii,
                        axis,
                        depth,
                        found,
                    });
                }
            };
            near(weight, closest(p, ends, radii));
            if cone.joined && weight != 0.0 {
                let r = *p - *ends[0];
                let (normal, distance) = direction(r, r.norm(), radii[0]);
                let (across, radius) = (Vector::ZERO, radii[0]);
                near(
                    -weight,
                    Closest { t: 0.0, unbounded: None, normal, distance, across, slip: 0.0, radius },
                );
            }
        }
    }

    /// Adds to the summary, and to the force on the tip, without allocating.
    ///
    /// Points without weight only count for overlap and pressure.
    pub fn summarise<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        summary: &mut ContactSummary,
        tip: &mut Vector<P>,
    ) {
        let mut last = None;
        self.for_each_touch(at, |touch| {
            let this = Some((touch.foundation, touch.first));
            summary.pairs += u32::from(touch.weight > 0.0);
            summary.touching += u32::from(this != last && touch.weight != 0.0);
            last = this;
            summary.overlap = summary.overlap.max(touch.depth);
            summary.pressure = summary.pressure.max(touch.pressure());
            *tip += touch.gradient() * -self.tip_share(&touch);
        });
    }

    /// The share of a point that belongs to the tip.
    fn tip_share<const P: usize>(&self, touch: &Touch<P>) -> f64 {
        let foundation = &self.0[touch.foundation];
        foundation.tip[touch.first - foundation.first.start]
    }

    /// Visits the depths of everything that touches.
    pub fn for_each_depth<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        mut visit: impl FnMut(Depth<P>),
    ) {
        self.for_each_touch(at, |touch| visit(depth(&touch)));
    }

    /// Adds a multiple of the change of the largest pressure.
    pub fn add_pressure<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        let mut largest = Largest::new();
        self.for_each_touch(at, |touch| {
            let here = depth(&touch);
            largest.offer(touch.pressure(), touch, |other| depth(other).is_same(&here));
        });
        let Some(touch) = largest.place else { return };
        out.tied |= largest.tied;
        let change = |change: &Change<P>| weight * touch.change_of_pressure(change);
        out.add_points(at.tree, spheres(&touch), attached::by_points(&touch, change));
        self.add_explicit(at, &touch, change, &mut out.parameters);
    }

    /// Adds a multiple of the change of the force on the tip along a direction.
    pub fn add_tip_force<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        state: &[Touch<P>],
        direction: &Vector<P>,
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        for touch in state {
            let along = *direction * (-weight * self.tip_share(touch));
            if along != Vector::ZERO {
                let change = |change: &Change<P>| along.dot(&touch.change_of_gradient(change));
                out.add_points(at.tree, spheres(touch), attached::by_points(touch, change));
                self.add_work(at, touch, &along, &mut out.parameters);
            }
        }
    }

    /// Adds the change of the work of a touch's gradient on a velocity with every parameter, frames and
    /// points held.
    fn add_work<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        touch: &Touch<P>,
        velocity: &Vector<P>,
        gradient: &mut [f64],
    ) {
        let length = self.0[touch.foundation].length;
        gradient[length] += velocity.dot(&touch.gradient()) / at.parameters()[length];
        let change = |change: &Change<P>| velocity.dot(&touch.change_of_gradient(change));
        self.add_explicit(at, touch, change, gradient);
    }

    /// Adds the slopes by every parameter, frames, points and the rod's length held, of what changes with a
    /// touch in a given way.
    fn add_explicit<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        touch: &Touch<P>,
        change: impl Fn(&Change<P>) -> f64,
        gradient: &mut [f64],
    ) {
        let (p, tree) = (at.parameters(), at.tree);
        let foundation = &self.0[touch.foundation];
        let cone = &foundation.cones[touch.cone];
        let slope = |i: usize| attached::by_explicit(i, &change);
        for (sphere, i) in spheres(touch).into_iter().zip([SURFACE, RADII[0], RADII[1]]) {
            add_radius_slope(tree, p, tree.spheres[sphere].radius, slope(i), gradient);
        }
        for (slot, i) in foundation.stiffness_at(cone).into_iter().zip(STIFFNESS) {
            gradient[slot] += slope(i);
        }
        let point = touch.first - foundation.first.start;
        let by_width = slope(WIDTH);
        gradient[foundation.half_width + point] += by_width;
        gradient[foundation.half_width_multiple + point] += by_width * at.geometry.radii[touch.first];
    }
}

/// The spheres at p, a, b.
fn spheres<const P: usize>(touch: &Touch<P>) -> [usize; 3] {
    [touch.first, touch.ends[0], touch.ends[1]]
}

fn depth<const P: usize>(touch: &Touch<P>) -> Depth<P> {
    Depth { depth: touch.depth, spheres: spheres(touch), t: touch.t, normal: touch.normal }
}

impl<const P: usize> ForceMemory<P> for Foundations {
    type Design = ();
    /// What touches.
    type State = Vec<Touch<P>>;
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Foundations {
    fn design(&self, _: &Tree<G, D, P>) {}

    fn state(&self, _: &Tree<G, D, P>) -> Vec<Touch<P>> {
        Vec::with_capacity(self.0.iter().map(Foundation::max_couplings).sum())
    }

    fn is_admissible(&self, parameters: &[f64]) -> bool {
        self.0.iter().all(|foundation| foundation.is_admissible(parameters))
    }

    fn max_couplings(&self) -> usize {
        self.0.iter().map(Foundation::max_couplings).sum()
    }

    fn has_switches(&self) -> bool {
        !self.0.is_empty()
    }

    /// For the predictor, contacts that open and close with their current stiffness or, before they touch,
    /// with that at a typical depth.
    fn for_each_switch(
        &self,
        at: &State<G, D, P>,
        _: &Vec<Touch<P>>,
        margin: f64,
        visit: &mut impl FnMut(Switch<P>),
    ) {
        self.for_each_near(at, margin, |near| {
            let foundation = &self.0[near.foundation];
            let Near { first, depth, found, .. } = &near;
            let usual = TYPICAL_DEPTH * near.surface;
            let expected = Near { depth: if *depth > 0.0 { *depth } else { usual }, ..near.clone() };
            let touch = Touch::new(foundation, at.parameters(), &expected);
            let [a, b] = touch.ends;
            let spheres = match found.t {
                _ if found.slip > 0.0 => [*first, a, b],
                t if t < 0.5 => [*first, a, a],
                _ => [*first, b, b],
            };
            visit(Switch {
                points: spheres.map(|sphere| at.tree.spheres[sphere].point),
                t: found.t,
                normal: found.normal,
                depth: *depth,
                stiffness: touch.stiffness(),
            });
        });
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &mut Vec<Touch<P>>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        state.clear();
        self.for_each_near(at, 0.0, |near| {
            let touch = Touch::new(&self.0[near.foundation], at.parameters(), &near);
            attached::add_residual(at, &touch, out);
            state.push(touch);
        });
    }

    fn add_tangent(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &Vec<Touch<P>>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        state.iter().for_each(|touch| attached::add_tangent(at, touch, out));
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, _: &(), state: &Vec<Touch<P>>, out: &mut Magnitudes<P>) {
        state.iter().for_each(|touch| attached::add_magnitudes(at, touch, out));
    }

    /// Opening is smooth; where a point passes from a cone's side to its end the tangent jumps.
    fn at_threshold(&self, at: &State<G, D, P>, moves: &impl Fn(&[usize], &Vector<P>) -> bool) -> bool {
        let mut found = false;
        self.for_each_near(at, 0.0, |near| {
            let passing = |t: f64| t.abs().min((t - 1.0).abs()) < SWITCHING_DISTANCE;
            if near.found.unbounded.is_some_and(passing) {
                let [a, b] = self.0[near.foundation].cones[near.cone].ends;
                let points = [near.first, a, b].map(|sphere| at.tree.spheres[sphere].point);
                found |= moves(&points, &near.axis) || moves(&points, &near.found.normal);
            }
        });
        found
    }

    /// Contact of two joined round cones at their common sphere counts once.
    fn contact_forces(&self, at: &State<G, D, P>, _: &Vec<Touch<P>>, out: &mut Vec<ContactForce<P>>) {
        self.for_each_touch(at, |touch| {
            let force = -touch.gradient();
            let same = |f: &ContactForce<P>| {
                f.first == touch.first && (f.force + force).norm() <= SAME_FORCE * force.norm()
            };
            if let Some(i) = out.iter().rposition(same).filter(|_| touch.weight < 0.0) {
                out.remove(i);
                return;
            }
            let inward = at.geometry.radii[touch.first] - 0.5 * touch.depth;
            let [p, ..] = points(&touch, at.tree);
            out.push(ContactForce {
                first: touch.first,
                second: Some(touch.ends),
                nearest: Some(touch.ends[usize::from(touch.t >= 0.5)]),
                cone: true,
                force,
                depth: touch.depth,
                pressure: Some(touch.pressure()),
                point: *at.point(p) - touch.normal * inward,
            });
        });
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &Vec<Touch<P>>,
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        for touch in state {
            self.add_work(at, touch, &relative(touch, at, motion), gradient);
        }
    }

    fn add_geometric_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &Vec<Touch<P>>,
        motion: &VirtualMotion<D, P>,
        velocities: &Velocities<D, P>,
        work: &mut f64,
    ) {
        let each = |touch| attached::geometric_work(at, touch, motion, velocities);
        *work += state.iter().map(each).sum::<f64>();
    }
}
