//! Friction where bodies press on each other: elastic slip with memory.
//!
//! For one step of the load the normal forces, the planes of contact and the elastic slips with which it
//! begins are held, and friction has a potential, see [`law`]. They are renewed in the equilibrium found, and
//! the step is solved again, until that changes nothing; then slip beyond the limit is given up.
//!
//! This memory belongs to a path and is kept with the state of the forces; a model without a history has no
//! friction.

mod definition;
mod law;
mod point;
#[cfg(test)]
mod tests;

use definition::Friction;
pub use definition::FrictionDescription;
use law::Law;
pub(crate) use point::{FrictionPoint, Pressed};

use super::element::{ForceElement, ForceMemory, Switch, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::state::State;
use super::terms::Terms;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::description::Description;
use crate::tree::{ModelError, Tree};

/// What presses bodies on each other: the index of a contact, foundation or obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    Contact(usize),
    Foundation(usize),
    Obstacle(usize),
}

/// Friction in all contacts that have it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Frictions(Vec<Friction>);

/// The memory of a path.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrictionMemory<const P: usize> {
    pub points: Vec<FrictionPoint<P>>,
    /// Energy dissipated so far [J].
    pub dissipated: f64,
    /// What presses on each other in the state in which the points are renewed.
    pressed: Vec<(usize, Pressed<P>)>,
}

/// Slip beyond the limit in a step, as a fraction of the elastic slip, from which on a point slides.
const SLIDING: f64 = 1e-3;

/// Friction at one point of a state.
#[derive(Clone, Debug)]
pub struct FrictionForce<const P: usize> {
    /// Index of the friction in the model's description.
    pub friction: usize,
    /// The sphere of the first body.
    pub sphere: usize,
    /// What it rubs on: a body, or a surface of an obstacle.
    pub other: usize,
    /// Where [m].
    pub place: Vector<P>,
    /// Force on the first body [N].
    pub force: Vector<P>,
    /// Largest size of the force, μN [N].
    pub limit: f64,
    /// Elastic slip [m].
    pub slip: Vector<P>,
    /// Whether it slid in the step that led there.
    pub slides: bool,
}

impl Frictions {
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        model: &Description,
    ) -> Result<Self, ModelError> {
        let each = model.frictions.iter().map(|friction| Friction::build(tree, friction, model));
        each.collect::<Result<_, _>>().map(Self)
    }

    /// Number of contacts with friction.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// What presses the bodies of each on each other.
    pub fn sources(&self) -> impl Iterator<Item = Source> {
        self.0.iter().map(|friction| friction.source)
    }

    /// Renews normal forces and planes of contact in a state in which these bodies press on each other, listed
    /// with the index of the friction; a point that has not touched before has not slipped.
    pub fn renew<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &mut FrictionMemory<P>,
        list: impl FnOnce(&mut dyn FnMut(usize, Pressed<P>)),
    ) {
        let FrictionMemory { points, pressed, .. } = memory;
        pressed.clear();
        list(&mut |friction, new: Pressed<P>| {
            // A sphere may touch a body at several places, such as joined round cones.
            let same = |(of, each): &&mut (usize, Pressed<P>)| {
                *of == friction && each.sphere == new.sphere && each.other == new.other
            };
            match pressed.iter_mut().rev().find(same) {
                None => pressed.push((friction, new)),
                Some((_, each)) => {
                    if new.stiffness > each.stiffness {
                        (each.frames, each.place) = (new.frames, new.place);
                    }
                    each.force += new.force;
                    each.stiffness += new.stiffness;
                }
            }
        });
        points.iter_mut().for_each(|point| point.touches = false);
        pressed.retain(|(_, each)| each.force.norm() > 0.0 && each.stiffness > 0.0);
        let known = |(index, each): &(usize, Pressed<P>)| [*index, each.sphere, each.other];
        for each in pressed.iter() {
            if let Some(point) = points.iter_mut().find(|point| point.key == known(each)) {
                point.renew(at, &each.1, self.law(at, each));
            }
        }
        for each in pressed.iter() {
            let key = known(each);
            if points.iter().any(|point| point.key == key) {
                continue;
            }
            // A sphere that has passed on from one body to the next takes its slip with it.
            let left = |point: &&mut FrictionPoint<P>| !point.touches && point.key[..2] == key[..2];
            let law = self.law(at, each);
            match points.iter_mut().find(left) {
                Some(point) => {
                    point.renew(at, &each.1, law);
                    point.key = key;
                }
                None => points.push(FrictionPoint::new(at, key, &each.1, law)),
            }
        }
        points.iter_mut().filter(|point| !point.touches).for_each(|point| point.law.limit = 0.0);
    }

    /// The law of a point at which bodies press on each other.
    fn law<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        (index, pressed): &(usize, Pressed<P>),
    ) -> Law {
        let friction = &self.0[*index];
        Law {
            stiffness: friction.ratio * pressed.stiffness,
            limit: at.parameters()[friction.coefficient] * pressed.force.norm(),
        }
    }

    /// Ends a step: gives up the slip beyond the limit, and forgets the points that do not touch.
    pub fn give_up_slip<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &mut FrictionMemory<P>,
        excess: f64,
    ) {
        for point in &mut memory.points {
            let lost = point.law.dissipation(point.size(at));
            point.set_back(at, excess);
            memory.dissipated += lost - point.law.dissipation(point.slip.norm());
        }
        memory.points.retain(|point| point.touches);
    }

    /// Lets every point stick.
    pub fn stick<const P: usize>(&self, memory: &mut FrictionMemory<P>) {
        memory.points.iter_mut().for_each(|point| point.law.limit = f64::INFINITY);
    }

    /// The part of the potential that is not stored but dissipated as the step ends [J].
    pub fn dissipation<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &FrictionMemory<P>,
    ) -> f64 {
        memory.points.iter().map(|point| point.law.dissipation(point.size(at))).sum()
    }

    /// The forces in a state.
    pub fn forces<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &FrictionMemory<P>,
    ) -> Vec<FrictionForce<P>> {
        let touching = memory.points.iter().filter(|point| point.touches);
        let force = |point: &FrictionPoint<P>| {
            let [friction, sphere, other] = point.key;
            let now = point.at(at);
            let limit = point.law.limit;
            FrictionForce {
                friction,
                sphere,
                other,
                place: now.place,
                force: -now.gradient,
                limit,
                slip: point.law.returned(now.slip, 0.0),
                slides: point.law.stiffness * now.slip.norm() > limit * (1.0 + SLIDING),
            }
        };
        touching.map(force).collect()
    }
}

impl<const P: usize> ForceMemory<P> for Frictions {
    type Design = ();
    type State = FrictionMemory<P>;
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Frictions {
    fn design(&self, _: &Tree<G, D, P>) {}

    fn state(&self, _: &Tree<G, D, P>) -> FrictionMemory<P> {
        FrictionMemory::default()
    }

    fn is_admissible(&self, parameters: &[f64]) -> bool {
        self.0.iter().all(|friction| parameters[friction.coefficient] >= 0.0)
    }

    fn max_couplings(&self) -> usize {
        self.0.iter().map(|friction| friction.most).sum()
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        _: &(),
        memory: &mut FrictionMemory<P>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        for point in &memory.points {
            let now = point.at(at);
            let [first, second] = point.frames;
            out.energy += point.law.energy(now.slip.norm());
            out.add_force::<G, P>(first, &now.place, &now.gradient);
            if second != 0 {
                out.add_force::<G, P>(second, &now.place, &-now.gradient);
            }
        }
    }

    fn add_tangent(
        &self,
        at: &State<G, D, P>,
        _: &(),
        memory: &FrictionMemory<P>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        for point in &memory.points {
            let now = point.at(at);
            let jacobian = G::point_jacobian(&now.place);
            let form = jacobian.transpose() * (point.law.hessian(&now.slip, &now.normal) * jacobian);
            let [first, second] = point.frames;
            if second == 0 {
                out.stiffness[first] += form;
                out.add_curvature::<G, P>(first, &now.place, &now.gradient);
            } else {
                out.add_carried::<G, P>([first, second], &now.place, &now.gradient, form);
            }
        }
    }

    fn add_magnitudes(
        &self,
        at: &State<G, D, P>,
        _: &(),
        memory: &FrictionMemory<P>,
        out: &mut Magnitudes<P>,
    ) {
        for point in &memory.points {
            let now = point.at(at);
            let secant = point.law.secant(now.slip.norm());
            for frame in point.frames.into_iter().filter(|frame| *frame != 0) {
                out.add_of_distance_at(frame, now.place, now.gradient.norm(), [secant, now.place.norm()]);
            }
        }
    }

    /// A point that begins to slide loses its stiffness along the slip.
    fn for_each_switch(
        &self,
        at: &State<G, D, P>,
        memory: &FrictionMemory<P>,
        margin: f64,
        visit: &mut impl FnMut(Switch<P>),
    ) {
        for point in &memory.points {
            let now = point.at(at);
            let (size, Law { stiffness, limit }) = (now.slip.norm(), point.law);
            let depth = limit / stiffness - size;
            if depth > -margin && size > 0.0 && limit > 0.0 && limit.is_finite() {
                let [first, second] = point.frames;
                visit(Switch {
                    points: [0; 3],
                    t: 0.0,
                    own: Some(first),
                    carrier: Some((second, now.place)),
                    normal: now.slip * (1.0 / size),
                    depth,
                    stiffness,
                });
            }
        }
    }

    /// Not differentiated: derivatives along a path with friction depend on all its steps.
    fn add_parameter_work(
        &self,
        _: &State<G, D, P>,
        _: &(),
        _: &FrictionMemory<P>,
        _: &(),
        _: &VirtualMotion<D, P>,
        _: &mut [f64],
    ) {
    }
}
