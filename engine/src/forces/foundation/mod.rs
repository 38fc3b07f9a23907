//! Contact of a rod with round links on an elastic (Winkler) foundation: both skins deform like independent
//! springs. The pressure is integrated across the rod in closed form, and along it by quadrature.

mod attached;
mod cone_contact;
mod definition;
mod strap_loop;
mod strip;

pub use definition::FoundationDescription;
pub use strap_loop::StrapLoopDescription;
pub(crate) use strap_loop::StrapLoops;
pub(super) use strip::Strip;

use super::contact::{Closest, ContactSummary, MovingCone, PlacedCone, direction};
use super::crossing::{Crossing, Motion, thinnest_pair};
use super::differential::{Depth, Differential, Largest};
use super::element::{ContactForce, ForceElement, ForceMemory, Switch, Velocities, VirtualMotion};
use super::friction::{Direction, Pressed, PressedChange};
use super::magnitudes::Magnitudes;
use super::state::State;
use super::terms::Terms;
use crate::geometry::{add_radius_slope, radius_slope};
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tolerances::{SAME_FORCE, SWITCHING_DISTANCE};
use crate::tree::{ModelError, Tree};
use attached::{points, relative};
use cone_contact::{Change, ConeCandidate, ConeContact, RADII, STIFFNESS, SURFACE, WIDTH};
use definition::Foundation;

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
    fn for_each_candidate<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        margin: f64,
        mut visit: impl FnMut(ConeCandidate<P>),
    ) {
        for (index, foundation) in self.0.iter().enumerate() {
            for cone in 0..foundation.cones.len() {
                let placed = foundation.placed(at, cone);
                for first in &foundation.weighted {
                    foundation.candidates_at(at, *first, [index, cone], &placed, margin, &mut visit);
                }
            }
        }
    }

    /// Visits all contacts point by point, also at points without weight.
    fn for_each_contact<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        mut visit: impl FnMut(ConeContact<P>),
    ) {
        for (index, foundation) in self.0.iter().enumerate() {
            let mut visit = |candidate| visit(ConeContact::new(foundation, at.parameters(), &candidate));
            for first in foundation.first.clone() {
                for cone in 0..foundation.cones.len() {
                    let placed = foundation.placed(at, cone);
                    foundation.candidates_at(at, first, [index, cone], &placed, 0.0, &mut visit);
                }
            }
        }
    }

    /// Visits what presses on each other in one of them.
    pub fn for_each_pressed<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
        state: &[ConeContact<P>],
        visit: &mut impl FnMut(Pressed<P>),
    ) {
        for contact in state.iter().filter(|contact| contact.foundation == index) {
            let [p, a, _] = points(contact, at.tree);
            let second = at.frame(a);
            let inward = at.geometry.radii[contact.first] - 0.5 * contact.depth;
            visit(Pressed {
                sphere: contact.first,
                other: at.tree.frames[second].body,
                frames: [at.frame(p), second],
                place: *at.point(p) - contact.normal * inward,
                force: -contact.gradient(),
                stiffness: contact.stiffness(),
                depth: contact.depth,
            });
        }
    }

    /// Visits the changes of these, in the same order.
    pub fn for_each_pressed_change<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
        state: &[ConeContact<P>],
        direction: &Direction<D, P>,
        visit: &mut impl FnMut(PressedChange<P>),
    ) {
        let length = self.0[index].length;
        let scaled = direction.of(length) / at.parameters()[length];
        for contact in state.iter().filter(|contact| contact.foundation == index) {
            let motion = points(contact, at.tree).map(|point| direction.velocities.points[point]);
            let explicit = direction.parameter.map_or([0.0; 6], |slot| self.explicit(at, contact, slot));
            let change = Change { explicit, ..attached::moved(contact, &motion) };
            let (depth, normal) = (contact.change_of_depth(&change), contact.change_of_normal(&change));
            let inward = at.geometry.radii[contact.first] - 0.5 * contact.depth;
            visit(PressedChange {
                place: motion[0] - normal * inward - contact.normal * (explicit[SURFACE] - 0.5 * depth),
                force: -(contact.change_of_gradient(&change) + contact.gradient() * scaled),
                stiffness: contact.change_of_stiffness_of_point(&change) + contact.stiffness() * scaled,
                depth,
            });
        }
    }

    /// What changes with one parameter, frames, points and the rod's length held.
    fn explicit<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        contact: &ConeContact<P>,
        slot: usize,
    ) -> [f64; 6] {
        let (p, tree) = (at.parameters(), at.tree);
        let foundation = &self.0[contact.foundation];
        let mut explicit = [0.0; 6];
        for (sphere, i) in spheres(contact).into_iter().zip([SURFACE, RADII[0], RADII[1]]) {
            explicit[i] = radius_slope(tree, p, tree.spheres[sphere].radius, slot);
        }
        let is = |other: usize| if other == slot { 1.0 } else { 0.0 };
        for (own, i) in foundation.stiffness_at(&foundation.cones[contact.cone]).into_iter().zip(STIFFNESS) {
            explicit[i] = is(own);
        }
        let point = contact.first - foundation.first.start;
        explicit[WIDTH] = is(foundation.half_width + point)
            + is(foundation.half_width_multiple + point) * at.geometry.radii[contact.first];
        explicit
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
        self.for_each_contact(at, |contact| {
            let this = Some((contact.foundation, contact.first));
            summary.pairs += u32::from(contact.weight > 0.0);
            summary.touching += u32::from(this != last && contact.weight != 0.0);
            last = this;
            summary.add_overlap(at, contact.first, contact.depth);
            summary.pressure = summary.pressure.max(contact.pressure());
            *tip += contact.gradient() * -self.tip_share(&contact);
        });
    }

    /// The share of a point that belongs to the tip.
    fn tip_share<const P: usize>(&self, contact: &ConeContact<P>) -> f64 {
        let foundation = &self.0[contact.foundation];
        foundation.tip[contact.first - foundation.first.start]
    }

    /// Visits the depths of all contacts.
    pub fn for_each_depth<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        mut visit: impl FnMut(Depth<P>),
    ) {
        self.for_each_contact(at, |contact| visit(depth(&contact)));
    }

    /// The largest pressure [Pa].
    pub fn largest_pressure<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
    ) -> f64 {
        let mut largest = 0.0f64;
        self.for_each_contact(at, |contact| largest = largest.max(contact.pressure()));
        largest
    }

    /// Adds a multiple of the change of the largest pressure.
    pub fn add_pressure<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        let mut largest = Largest::new();
        self.for_each_contact(at, |contact| {
            let here = depth(&contact);
            largest.offer(contact.pressure(), contact, |other| depth(other).is_same(&here));
        });
        let Some(contact) = largest.place else { return };
        out.tied |= largest.tied;
        let change = |change: &Change<P>| weight * contact.change_of_pressure(change);
        out.add_points(at.tree, spheres(&contact), attached::by_points(&contact, change));
        self.add_explicit(at, &contact, attached::by_explicit(change), &mut out.parameters);
    }

    /// Adds a multiple of the change of the force on the tip along a direction.
    pub fn add_tip_force<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        state: &[ConeContact<P>],
        direction: &Vector<P>,
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        for contact in state {
            let along = *direction * (-weight * self.tip_share(contact));
            if along != Vector::ZERO {
                let change = |change: &Change<P>| along.dot(&contact.change_of_gradient(change));
                out.add_points(at.tree, spheres(contact), attached::by_points(contact, change));
                self.add_work(at, contact, &along, &mut out.parameters);
            }
        }
    }

    /// Adds the change of the work of a contact's gradient on a velocity with every parameter, frames and
    /// points held.
    fn add_work<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        contact: &ConeContact<P>,
        velocity: &Vector<P>,
        gradient: &mut [f64],
    ) {
        let slopes = attached::by_explicit(|change| contact.change_of_gradient(change));
        self.add_work_with(at, contact, &slopes, velocity, gradient);
    }

    /// The same, given the slopes of the contact's gradient by the quantities in [`Change::explicit`].
    fn add_work_with<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        contact: &ConeContact<P>,
        slopes: &[Vector<P>; 6],
        velocity: &Vector<P>,
        gradient: &mut [f64],
    ) {
        let length = self.0[contact.foundation].length;
        gradient[length] += velocity.dot(&contact.gradient()) / at.parameters()[length];
        self.add_explicit(at, contact, slopes.map(|slope| velocity.dot(&slope)), gradient);
    }

    /// Adds the slopes by every parameter, frames, points and the rod's length held, of what has these slopes by the
    /// quantities in [`Change::explicit`].
    fn add_explicit<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        contact: &ConeContact<P>,
        slopes: [f64; 6],
        gradient: &mut [f64],
    ) {
        let (p, tree) = (at.parameters(), at.tree);
        let foundation = &self.0[contact.foundation];
        let cone = &foundation.cones[contact.cone];
        for (sphere, i) in spheres(contact).into_iter().zip([SURFACE, RADII[0], RADII[1]]) {
            add_radius_slope(tree, p, tree.spheres[sphere].radius, slopes[i], gradient);
        }
        for (slot, i) in foundation.stiffness_at(cone).into_iter().zip(STIFFNESS) {
            gradient[slot] += slopes[i];
        }
        let point = contact.first - foundation.first.start;
        let by_width = slopes[WIDTH];
        gradient[foundation.half_width + point] += by_width;
        gradient[foundation.half_width_multiple + point] += by_width * at.geometry.radii[contact.first];
    }
}

impl Foundation {
    fn placed<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        cone: usize,
    ) -> PlacedCone<P> {
        let ends = self.cones[cone].ends;
        let centres = ends.map(|end| at.centre(end));
        PlacedCone::new(centres, ends.map(|end| at.geometry.radii[end]))
    }

    /// Visits the candidates at one point of the rod, for the foundation and the cone of these indices.
    #[inline]
    fn candidates_at<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        first: usize,
        [foundation, cone]: [usize; 2],
        placed: &PlacedCone<P>,
        margin: f64,
        visit: &mut impl FnMut(ConeCandidate<P>),
    ) {
        let (p, surface) = (at.centre(first), at.geometry.radii[first]);
        if placed.is_far(p, surface + margin) {
            return;
        }
        let weight = at.parameters()[self.length] * self.weights[first - self.first.start];
        let PlacedCone { axis, radii, .. } = *placed;
        let mut visit = |weight, found: Closest<P>| {
            let depth = surface + found.radius - found.distance;
            if depth > -margin {
                visit(ConeCandidate { foundation, first, cone, weight, surface, radii, axis, depth, found });
            }
        };
        visit(weight, placed.closest(p));
        if self.cones[cone].joined && weight != 0.0 {
            let r = *p - placed.start;
            let (normal, distance) = direction(r, r.norm(), radii[0]);
            let (across, radius) = (Vector::ZERO, radii[0]);
            visit(-weight, Closest { t: 0.0, unbounded: None, normal, distance, across, slip: 0.0, radius });
        }
    }
}

/// The spheres at p, a, b.
fn spheres<const P: usize>(contact: &ConeContact<P>) -> [usize; 3] {
    [contact.first, contact.ends[0], contact.ends[1]]
}

fn depth<const P: usize>(contact: &ConeContact<P>) -> Depth<P> {
    Depth { depth: contact.depth, spheres: spheres(contact), t: contact.t, normal: contact.normal }
}

impl<const P: usize> ForceMemory<P> for Foundations {
    type Design = ();
    /// The contacts.
    type State = Vec<ConeContact<P>>;
    type Sensitivity = Vec<[Vector<P>; 6]>;
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Foundations {
    fn design(&self, _: &Tree<G, D, P>) {}

    fn state(&self, _: &Tree<G, D, P>) -> Vec<ConeContact<P>> {
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

    /// A contact opens with its current stiffness, and closes with that at a typical depth.
    fn for_each_switch(
        &self,
        at: &State<G, D, P>,
        _: &Vec<ConeContact<P>>,
        margin: f64,
        visit: &mut impl FnMut(Switch<P>),
    ) {
        self.for_each_candidate(at, margin, |candidate| {
            let foundation = &self.0[candidate.foundation];
            let ConeCandidate { first, depth, found, .. } = &candidate;
            let usual = TYPICAL_DEPTH * candidate.surface;
            let expected =
                ConeCandidate { depth: if *depth > 0.0 { *depth } else { usual }, ..candidate.clone() };
            let contact = ConeContact::new(foundation, at.parameters(), &expected);
            let [a, b] = contact.ends;
            let spheres = match found.t {
                _ if found.slip > 0.0 => [*first, a, b],
                t if t < 0.5 => [*first, a, a],
                _ => [*first, b, b],
            };
            visit(Switch {
                points: spheres.map(|sphere| at.tree.spheres[sphere].point),
                t: found.t,
                own: None,
                carrier: None,
                normal: found.normal,
                depth: *depth,
                stiffness: contact.stiffness(),
            });
        });
    }

    fn switched_on(&self, _: &State<G, D, P>, state: &Vec<ConeContact<P>>) -> usize {
        state.len()
    }

    fn has_solids(&self) -> bool {
        !self.0.is_empty()
    }

    fn thinnest(&self, at: &State<G, D, P>) -> f64 {
        let pairs = self.0.iter().map(|foundation| [&foundation.first, &foundation.second]);
        pairs.map(|groups| thinnest_pair(at, groups)).fold(f64::INFINITY, f64::min)
    }

    fn for_each_crossing(&self, motion: &Motion<G, D, P>, visit: &mut impl FnMut(Crossing)) {
        let motion = &Motion { margin: 0.0, ..*motion };
        for foundation in &self.0 {
            for cone in &foundation.cones {
                let moving = MovingCone::new(motion, cone.ends);
                let crossings = foundation.weighted.iter().filter_map(|first| moving.crossing(*first));
                crossings.for_each(&mut *visit);
            }
        }
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &mut Vec<ConeContact<P>>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        state.clear();
        self.for_each_candidate(at, 0.0, |candidate| {
            let contact = ConeContact::new(&self.0[candidate.foundation], at.parameters(), &candidate);
            attached::add_residual(at, &contact, out);
            state.push(contact);
        });
    }

    fn add_tangent(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &Vec<ConeContact<P>>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        state.iter().for_each(|contact| attached::add_tangent(at, contact, out));
    }

    fn add_magnitudes(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &Vec<ConeContact<P>>,
        out: &mut Magnitudes<P>,
    ) {
        state.iter().for_each(|contact| attached::add_magnitudes(at, contact, out));
    }

    /// Opening is smooth; where a point passes from a cone's side to its end the tangent jumps.
    fn at_threshold(&self, at: &State<G, D, P>, moves: &impl Fn(&[usize], &Vector<P>) -> bool) -> bool {
        let mut found = false;
        self.for_each_candidate(at, 0.0, |candidate| {
            let passing = |t: f64| t.abs().min((t - 1.0).abs()) < SWITCHING_DISTANCE;
            if candidate.found.unbounded.is_some_and(passing) {
                let [a, b] = self.0[candidate.foundation].cones[candidate.cone].ends;
                let points = [candidate.first, a, b].map(|sphere| at.tree.spheres[sphere].point);
                found |= moves(&points, &candidate.axis) || moves(&points, &candidate.found.normal);
            }
        });
        found
    }

    /// Contact of two joined round cones at their common sphere counts once.
    fn contact_forces(&self, at: &State<G, D, P>, _: &Vec<ConeContact<P>>, out: &mut Vec<ContactForce<P>>) {
        self.for_each_contact(at, |contact| {
            let force = -contact.gradient();
            let same = |f: &ContactForce<P>| {
                f.first == contact.first && (f.force + force).norm() <= SAME_FORCE * force.norm()
            };
            if let Some(i) = out.iter().rposition(same).filter(|_| contact.weight < 0.0) {
                out.remove(i);
                return;
            }
            let inward = at.geometry.radii[contact.first] - 0.5 * contact.depth;
            let [p, ..] = points(&contact, at.tree);
            out.push(ContactForce {
                first: contact.first,
                second: Some(contact.ends),
                nearest: Some(contact.ends[usize::from(contact.t >= 0.5)]),
                obstacle: None,
                cone: true,
                force,
                depth: contact.depth,
                pressure: Some(contact.pressure()),
                point: *at.point(p) - contact.normal * inward,
            });
        });
    }

    fn update_sensitivity(
        &self,
        _: &State<G, D, P>,
        _: &(),
        state: &Vec<ConeContact<P>>,
        _: &[bool],
        slopes: &mut Vec<[Vector<P>; 6]>,
    ) {
        slopes.clear();
        slopes.extend(
            state.iter().map(|contact| attached::by_explicit(|change| contact.change_of_gradient(change))),
        );
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &Vec<ConeContact<P>>,
        slopes: &Vec<[Vector<P>; 6]>,
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        for (contact, slopes) in state.iter().zip(slopes) {
            self.add_work_with(at, contact, slopes, &relative(contact, at, motion), gradient);
        }
    }

    fn add_geometric_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &Vec<ConeContact<P>>,
        motion: &VirtualMotion<D, P>,
        velocities: &Velocities<D, P>,
        work: &mut f64,
    ) {
        let each = |contact| attached::geometric_work(at, contact, motion, velocities);
        *work += state.iter().map(each).sum::<f64>();
    }
}
