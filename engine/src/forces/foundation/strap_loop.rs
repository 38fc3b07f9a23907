//! Straps that are sewn to a rod and loop around a link, along which they slide without friction:
//! ½ k (‖p − c(t)‖ − r(t) − S − ℓ₀)₊², with the point c(t) of the link's axis that is closest.

use super::super::contact::PlacedCone;
use super::super::differential::Differential;
use super::super::element::{ForceElement, ForceMemory, Switch, Velocities, VirtualMotion};
use super::super::magnitudes::Magnitudes;
use super::super::state::State;
use super::super::terms::Terms;
use super::attached::{self, relative};
use super::cone_contact::{Change, ConeCandidate, ConeContact, RADII, STIFFNESS, SURFACE};
use crate::geometry::add_radius_slope;
use crate::lie::LieGroup;
use crate::tree::{ModelError, Tree, finite, not_negative};
use serde::Deserialize;

/// A strap around a link.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StrapLoopDescription {
    /// Unique name.
    pub name: String,
    /// Three spheres: of a point of a rod, and at both ends of a link.
    pub spheres: String,
    /// Stiffness [N/m].
    pub stiffness: f64,
    /// Gap between rod and link up to which it is slack [m]; negative if it presses them together.
    pub rest_length: f64,
}

/// A strap around a link: its spheres, and parameters holding k and ℓ₀.
#[derive(Clone, Debug, PartialEq)]
struct StrapLoop {
    spheres: [usize; 3],
    stiffness: usize,
    rest_length: usize,
}

/// All straps around links.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StrapLoops(Vec<StrapLoop>);

impl StrapLoops {
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        straps: &[StrapLoopDescription],
    ) -> Result<Self, ModelError> {
        let mut built = vec![];
        for strap in straps {
            let field = |f: &str| format!("loops.{}.{f}", strap.name);
            let group = tree.sphere_group(&field("spheres"), &strap.spheres)?;
            not_negative(field("stiffness"), strap.stiffness)?;
            finite(field("rest_length"), &[strap.rest_length])?;
            let [p, a, b] = [0, 1, 2].map(|i| group.start + i);
            let frame = |sphere: usize| tree.spheres.get(sphere).map(|s| tree.points[s.point].frame);
            if group.len() != 3 || frame(a) != frame(b) {
                let problem = "expected a point of a rod and both ends of one link";
                return Err(ModelError::new(field("spheres"), problem));
            }
            tree.keep_jacobian(tree.points[tree.spheres[a].point].frame);
            let stiffness = tree.slot(format!("{}.stiffness", strap.name), "N/m", &[strap.stiffness]).start;
            let rest_length =
                tree.slot(format!("{}.rest_length", strap.name), "m", &[strap.rest_length]).start;
            built.push(StrapLoop { spheres: [p, a, b], stiffness, rest_length });
        }
        Ok(Self(built))
    }

    /// Tension of each.
    pub fn tensions<const P: usize>(&self, state: &[ConeContact<P>], out: &mut [f64]) {
        out.fill(0.0);
        state.iter().for_each(|contact| out[contact.foundation] = contact.tension());
    }

    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Adds a multiple of the change of the tension of one strap; a slack one has none.
    pub fn add_tension<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
        state: &[ConeContact<P>],
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        for contact in state.iter().filter(|contact| contact.foundation == index) {
            let change = |change: &Change<P>| weight * contact.change_of_tension(change);
            out.add_points(at.tree, self.0[index].spheres, attached::by_points(contact, change));
            self.0[index].add_explicit(at, change, &mut out.parameters);
        }
    }
}

impl StrapLoop {
    /// Adds the slopes by every parameter, frames and points held, of what changes with the strap in a
    /// given way.
    fn add_explicit<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        change: impl Fn(&Change<P>) -> f64,
        gradient: &mut [f64],
    ) {
        let slopes = attached::by_explicit(change);
        gradient[self.stiffness] += slopes[STIFFNESS[0]];
        gradient[self.rest_length] += slopes[SURFACE];
        for (sphere, i) in self.spheres.into_iter().zip([SURFACE, RADII[0], RADII[1]]) {
            add_radius_slope(at.tree, at.parameters(), at.tree.spheres[sphere].radius, slopes[i], gradient);
        }
    }

    /// The strap with its index, if it is taut.
    fn taut<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
    ) -> Option<ConeContact<P>> {
        let (candidate, stretch) = self.stretch(index, at);
        let [_, a, b] = self.spheres;
        let k = at.parameters()[self.stiffness];
        (stretch > 0.0).then(|| ConeContact::of_loop(&candidate, [a, b], k, stretch))
    }

    /// The point and its link, and by how much the strap is stretched.
    fn stretch<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
    ) -> (ConeCandidate<P>, f64) {
        let [first, a, b] = self.spheres;
        let [p, start, stop] = self.spheres.map(|sphere| at.centre(sphere));
        let radii = [a, b].map(|end| at.geometry.radii[end]);
        let surface = at.geometry.radii[first];
        let placed = PlacedCone::new([start, stop], radii);
        let found = placed.closest(p);
        let depth = surface + found.radius - found.distance;
        let stretch = -depth - at.parameters()[self.rest_length];
        let (axis, weight) = (placed.axis, 1.0);
        let candidate =
            ConeCandidate { foundation: index, first, cone: 0, weight, surface, radii, axis, depth, found };
        (candidate, stretch)
    }
}

impl<const P: usize> ForceMemory<P> for StrapLoops {
    type Design = ();
    /// The straps that are taut.
    type State = Vec<ConeContact<P>>;
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for StrapLoops {
    fn design(&self, _: &Tree<G, D, P>) {}

    fn state(&self, _: &Tree<G, D, P>) -> Vec<ConeContact<P>> {
        Vec::with_capacity(self.0.len())
    }

    fn is_admissible(&self, parameters: &[f64]) -> bool {
        self.0.iter().all(|strap| parameters[strap.stiffness] >= 0.0)
    }

    fn max_couplings(&self) -> usize {
        self.0.len()
    }

    fn has_switches(&self) -> bool {
        !self.0.is_empty()
    }

    fn for_each_switch(
        &self,
        at: &State<G, D, P>,
        _: &Vec<ConeContact<P>>,
        margin: f64,
        visit: &mut impl FnMut(Switch<P>),
    ) {
        for (index, strap) in self.0.iter().enumerate() {
            let (ConeCandidate { found, .. }, stretch) = strap.stretch(index, at);
            if stretch > -margin {
                visit(Switch {
                    points: strap.spheres.map(|sphere| at.tree.spheres[sphere].point),
                    t: found.t,
                    own: None,
                    carrier: None,
                    normal: -found.normal,
                    depth: stretch,
                    stiffness: at.parameters()[strap.stiffness],
                });
            }
        }
    }

    fn switched_on(&self, _: &State<G, D, P>, state: &Vec<ConeContact<P>>) -> usize {
        state.len()
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &mut Vec<ConeContact<P>>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        state.clear();
        state.extend(self.0.iter().enumerate().filter_map(|(index, strap)| strap.taut(index, at)));
        state.iter().for_each(|contact| attached::add_residual(at, contact, out));
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

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &Vec<ConeContact<P>>,
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        for contact in state {
            let velocity = relative(contact, at, motion);
            let change = |change: &Change<P>| velocity.dot(&contact.change_of_gradient(change));
            self.0[contact.foundation].add_explicit(at, change, gradient);
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
        *work += state
            .iter()
            .map(|contact| attached::geometric_work(at, contact, motion, velocities))
            .sum::<f64>();
    }
}
