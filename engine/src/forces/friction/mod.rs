//! Friction where bodies press on each other: elastic slip with memory.
//!
//! With the normal forces and the planes of contact held, friction has a potential, see [`law`]. What is held
//! is renewed from the state, which depends on that state and on what the step began with only, not on what was
//! held before: a step is a system of equations, whose derivatives are in [`change`]. When it is solved, slip
//! beyond the limit is given up.
//!
//! This memory belongs to a path and is kept with the state of the forces; a model without a history has no
//! friction.

mod change;
mod definition;
mod history;
mod law;
mod point;
mod pressed;
mod start;
#[cfg(test)]
mod tests;

pub(crate) use change::PointChange;
use definition::Friction;
pub use definition::FrictionDescription;
pub(crate) use history::{FrictionSlopes, PointAdjoint, PointSlope};
use law::Law;
use point::{FrictionPoint, Key};
use pressed::Merged;
pub(crate) use pressed::{Direction, Pressed, PressedChange};
use start::{Begun, Start};

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
    /// What is held.
    points: Vec<FrictionPoint<P>>,
    /// What the step began with.
    start: Start<P>,
    /// Energy dissipated before it [J].
    dissipated: f64,
    /// What presses on each other in the state in which the points were renewed.
    pressed: Vec<Merged<P>>,
    /// The contacts of which these are made, in the order in which they are visited, with the index of theirs.
    contacts: Vec<(usize, Pressed<P>)>,
}

impl<const P: usize> FrictionMemory<P> {
    /// Indices of the slips with which the step began, of points that do not press any more.
    fn opened(&self) -> impl Iterator<Item = usize> {
        let kept = |index: usize| self.points.iter().any(|point| point.begun == Some(index));
        (0..self.start.points.len()).filter(move |index| !kept(*index))
    }

    /// Whether there are such points.
    pub fn has_opened(&self) -> bool {
        self.opened().next().is_some()
    }
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
    /// with the index of the friction.
    pub fn renew<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &mut FrictionMemory<P>,
        list: impl FnOnce(&mut dyn FnMut(usize, Pressed<P>)),
    ) {
        let FrictionMemory { points, start, pressed, contacts, .. } = memory;
        pressed.clear();
        contacts.clear();
        list(&mut |friction, new: Pressed<P>| {
            let same = |each: &Merged<P>| {
                each.friction == friction && (each.whole.sphere, each.whole.other) == (new.sphere, new.other)
            };
            let index = pressed.iter().rposition(same);
            match index {
                Some(index) => pressed[index].add(&new),
                None => pressed.push(Merged::new(friction, &new)),
            }
            contacts.push((index.unwrap_or(pressed.len() - 1), new));
        });
        if start.frames.is_empty() {
            start.place(at);
        }
        points.clear();
        let key = |each: &Merged<P>| [each.friction, each.whole.sphere, each.whole.other];
        let now = |wanted: Key| pressed.iter().any(|each| key(each) == wanted && each.presses());
        for (index, each) in pressed.iter().enumerate().filter(|(_, each)| each.presses()) {
            let own = key(each);
            let taken = |of: usize| points.iter().any(|point| point.begun == Some(of));
            let begun = start.points.iter().position(|begun| begun.key == own).or_else(|| {
                // A sphere that has passed on from one body to the next takes its slip with it.
                let left = |(of, begun): &(usize, &Begun<P>)| {
                    begun.key[..2] == own[..2] && !now(begun.key) && !taken(*of)
                };
                start.points.iter().enumerate().find(left).map(|(of, _)| of)
            });
            let law = self.law(at, each);
            points.push(FrictionPoint::new(at, (own, index), &each.whole, law, (start, begun)));
        }
    }

    /// The law of a point at which bodies press on each other.
    fn law<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        Merged { friction, whole, .. }: &Merged<P>,
    ) -> Law {
        let (ratio, coefficient) = self.0[*friction].constants(at.parameters());
        Law { stiffness: ratio * whole.stiffness, limit: coefficient * whole.force.norm() }
    }

    /// Ends a step: gives up the slip beyond the limit. The next one begins here.
    pub fn end_step<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &mut FrictionMemory<P>,
        excess: f64,
    ) {
        memory.dissipated = self.dissipated(at, memory);
        memory.points.iter_mut().for_each(|point| point.set_back(at, excess));
        self.begin_step(at, memory);
        // The slip just beyond the limit counts for what is yet to be dissipated.
        memory.dissipated -= self.dissipation(at, memory);
    }

    /// Lets a step begin in a state with the slips that points have in it.
    pub fn begin_step<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &mut FrictionMemory<P>,
    ) {
        let FrictionMemory { points, start, .. } = memory;
        start.place(at);
        start.points.clear();
        for (index, point) in points.iter_mut().enumerate() {
            start.points.push(point.begin());
            point.begun = Some(index);
        }
    }

    /// Sets the slip of a point that touches, given in the world.
    pub fn set_slip<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &mut FrictionMemory<P>,
        key: Key,
        slip: Vector<P>,
    ) {
        if let Some(point) = memory.points.iter_mut().find(|point| point.key == key) {
            point.set_slip(at, slip);
        }
    }

    /// Lets every point stick.
    pub fn stick<const P: usize>(&self, memory: &mut FrictionMemory<P>) {
        memory.points.iter_mut().for_each(|point| point.law.limit = f64::INFINITY);
    }

    /// Energy dissipated up to a state [J]: by slip beyond the limit, and by elastic slip that is lost as
    /// contacts become softer, stiffer, or open.
    pub fn dissipated<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &FrictionMemory<P>,
    ) -> f64 {
        let FrictionMemory { points, start, .. } = memory;
        let opened: f64 = memory.opened().map(|index| start.points[index].energy()).sum();
        let relaxed: f64 = points.iter().map(|point| point.relaxed(start)).sum();
        memory.dissipated + self.dissipation(at, memory) + relaxed + opened
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
        memory.points.iter().map(force).collect()
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
        self.0.iter().all(|friction| {
            let (ratio, coefficient) = friction.constants(parameters);
            ratio > 0.0 && coefficient >= 0.0
        })
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
