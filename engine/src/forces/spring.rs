//! Springs and straps between two points: ½ k (‖r‖ − ℓ₀)². The first end may be a place between two sample
//! points of a rod, which a share of each carries.

use super::differential::Differential;
use super::element::{ForceElement, ForceMemory, Switch, Velocities, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::state::{Law, State};
use super::terms::Terms;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tolerances::COINCIDENT;
use crate::tree::description::AttachmentDescription;
use crate::tree::{Between, ModelError, Tree, not_negative};
use serde::Deserialize;

/// A linear spring between two points; a strap when `slack`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpringDescription {
    /// Unique name.
    pub name: String,
    /// One end.
    pub first: AttachmentDescription,
    /// The other end.
    pub second: AttachmentDescription,
    /// Stiffness [N/m].
    pub stiffness: f64,
    /// Rest length [m].
    pub rest_length: f64,
    /// Whether it only pulls.
    #[serde(default)]
    pub slack: bool,
}

/// A linear spring between two points.
#[derive(Clone, Debug, PartialEq)]
struct Spring {
    ends: [usize; 2],
    /// The point that carries the rest of the first end, if that is between two sample points, and its place.
    between: Option<(usize, Between)>,
    /// Parameters holding k and ℓ₀.
    stiffness: usize,
    rest_length: usize,
    slack: bool,
}

/// All springs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Springs(Vec<Spring>);

/// The potential of a taut spring as a function of r, the vector between its ends.
struct Taut<const P: usize> {
    stretch: f64,
    energy: f64,
    /// Its gradient, the force on the second end.
    force: Vector<P>,
    /// Unit vector along r; arbitrary if the ends coincide.
    direction: Vector<P>,
    /// Second derivatives along and across it.
    hessian: [f64; 2],
}

impl<const P: usize> Taut<P> {
    /// The change of the force as r changes.
    fn change(&self, r: &Vector<P>) -> Vector<P> {
        let [normal, tangential] = self.hessian;
        let along = self.direction * self.direction.dot(r);
        along * normal + (*r - along) * tangential
    }
}

impl Springs {
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        springs: &[SpringDescription],
    ) -> Result<Self, ModelError> {
        let mut built = vec![];
        for spring in springs {
            let field = |f: &str| format!("springs.{}.{f}", spring.name);
            not_negative(field("stiffness"), spring.stiffness)?;
            not_negative(field("rest_length"), spring.rest_length)?;
            let moving = tree.attach_between(&field("first"), &spring.first)?;
            let first = match moving {
                Some(([first, _], _)) => first,
                None => tree.attach(&field("first"), &spring.first)?,
            };
            let ends = [first, tree.attach(&field("second"), &spring.second)?];
            let between = moving.map(|([_, after], place)| (after, place));
            tree.keep_jacobian(tree.points[ends[1]].frame);
            let stiffness = tree.slot(format!("{}.stiffness", spring.name), "N/m", &[spring.stiffness]).start;
            let rest_length =
                tree.slot(format!("{}.rest_length", spring.name), "m", &[spring.rest_length]).start;
            built.push(Spring { ends, between, stiffness, rest_length, slack: spring.slack });
        }
        Ok(Self(built))
    }

    /// Tension of each spring; negative where it pushes.
    pub fn tensions<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        out: &mut [f64],
    ) {
        for (spring, out) in self.0.iter().zip(out) {
            let taut = spring.taut(at, None);
            *out = taut.map_or(0.0, |taut| at.parameters()[spring.stiffness] * taut.stretch);
        }
    }

    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The largest rest length [m].
    pub fn longest(&self, parameters: &[f64]) -> f64 {
        self.0.iter().map(|spring| parameters[spring.rest_length]).fold(0.0, f64::max)
    }

    /// The largest motion of the ends of a spring relative to one another, as a fraction of its length at rest or
    /// before, whichever is larger. A pin, whose length at rest is zero, has no length to compare with.
    pub fn largest_motion<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        [before, after]: [&State<G, D, P>; 2],
    ) -> f64 {
        let long = self.0.iter().filter(|spring| after.parameters()[spring.rest_length] > 0.0);
        let motion = |spring: &Spring| {
            let [first, second] = spring.ends;
            let between = |at: &State<G, D, P>| *at.point(second) - *at.point(first);
            let length = after.parameters()[spring.rest_length].max(between(before).norm());
            (between(after) - between(before)).norm() / length
        };
        long.map(motion).fold(0.0, f64::max)
    }

    /// Adds a multiple of the change of the tension of one spring; a slack strap has none.
    pub fn add_tension<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        let spring = &self.0[index];
        let Some(Taut { stretch, direction, .. }) = spring.taut(at, None) else { return };
        let k = at.parameters()[spring.stiffness];
        spring.for_each_arm(at, |point, share| out.points.push((point, direction * (k * weight * share))));
        if let Some((slot, moved)) = spring.moved(at, |point| *at.point(point)) {
            out.parameters[slot] += k * weight * direction.dot(&moved);
        }
        out.parameters[spring.stiffness] += stretch * weight;
        out.parameters[spring.rest_length] -= k * weight;
    }

    /// The springs that are taut.
    fn taut<'a, G: LieGroup<D, P>, const D: usize, const P: usize>(
        &'a self,
        at: &'a State<G, D, P>,
        kept: &'a [Option<Vector<P>>],
    ) -> impl Iterator<Item = (&'a Spring, Taut<P>)> {
        self.0.iter().zip(kept).filter_map(|(spring, kept)| Some((spring, spring.taut(at, kept.as_ref())?)))
    }
}

impl Spring {
    /// Visits the points that r is a sum of, with their weights.
    #[inline]
    fn for_each_arm<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        mut visit: impl FnMut(usize, f64),
    ) {
        let [a, b] = self.ends;
        match self.between {
            None => visit(a, 1.0),
            Some((after, place)) => {
                let [share, _] = place.interval(&at.tree.rods, at.parameters()).share();
                visit(a, 1.0 - share);
                visit(after, share);
            }
        }
        visit(b, -1.0);
    }

    /// The sum of something over these points.
    #[inline]
    fn sum<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        of: impl Fn(usize) -> Vector<P>,
    ) -> Vector<P> {
        if self.between.is_none() {
            return of(self.ends[0]) - of(self.ends[1]);
        }
        let mut sum = Vector::ZERO;
        self.for_each_arm(at, |point, weight| sum += of(point) * weight);
        sum
    }

    /// The parameter of the place of the first end, and the derivative by it of such a sum, points held.
    fn moved<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        of: impl Fn(usize) -> Vector<P>,
    ) -> Option<(usize, Vector<P>)> {
        let (after, place) = self.between?;
        let [_, slope] = place.interval(&at.tree.rods, at.parameters()).share();
        Some((place.slot, (of(after) - of(self.ends[0])) * slope))
    }

    fn taut<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        kept: Option<&Vector<P>>,
    ) -> Option<Taut<P>> {
        let [k, rest] = [self.stiffness, self.rest_length].map(|i| at.parameters()[i]);
        let r = self.sum(at, |point| *at.point(point));
        let length = r.norm();
        let stretch = length - rest;
        let kept = kept.filter(|_| at.law != Law::Actual);
        if self.slack && stretch <= 0.0 && kept.is_none() {
            return None;
        }
        let energy = 0.5 * k * stretch * stretch;
        // Of coincident ends any direction is as good as another: they are pushed along one of them, and
        // the curvature across it is as negative as it is close by, so that they part where they can.
        let smallest = COINCIDENT * rest;
        let direction = if length == 0.0 { Vector::unit(P - 1) } else { r * (1.0 / length) };
        let kept = (at.law == Law::Kept).then(|| kept.copied().unwrap_or(Vector::ZERO));
        Some(if rest == 0.0 {
            // Isotropic: no direction is singled out.
            Taut { stretch, energy, force: kept.unwrap_or(r * k), direction, hessian: [k, k] }
        } else {
            let tension = kept.map_or(k * stretch, |force| force.dot(&direction));
            let hessian = [k, tension / length.max(smallest)];
            Taut { stretch, energy, force: direction * tension, direction, hessian }
        })
    }
}

impl<const P: usize> ForceMemory<P> for Springs {
    type Design = ();
    /// The kept force of each.
    type State = Vec<Option<Vector<P>>>;
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Springs {
    fn design(&self, _: &Tree<G, D, P>) {}

    fn state(&self, _: &Tree<G, D, P>) -> Vec<Option<Vector<P>>> {
        vec![None; self.0.len()]
    }

    fn is_admissible(&self, parameters: &[f64]) -> bool {
        self.0.iter().all(|s| {
            let on_rod = s.between.is_none_or(|(_, place)| (0.0..=1.0).contains(&parameters[place.slot]));
            on_rod && [s.stiffness, s.rest_length].iter().all(|i| parameters[*i] >= 0.0)
        })
    }

    fn max_couplings(&self) -> usize {
        self.0.iter().map(|spring| if spring.between.is_none() { 1 } else { 3 }).sum()
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        _: &(),
        kept: &mut Vec<Option<Vector<P>>>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        for (spring, taut) in self.taut(at, kept) {
            out.energy += taut.energy;
            spring.for_each_arm(at, |point, weight| {
                out.add_force::<G, P>(at.frame(point), at.point(point), &(taut.force * weight));
            });
        }
    }

    fn add_tangent(
        &self,
        at: &State<G, D, P>,
        _: &(),
        kept: &Vec<Option<Vector<P>>>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        for (spring, Taut { force, direction, hessian, .. }) in self.taut(at, kept) {
            if let Some((after, place)) = spring.between {
                let [share, _] = place.interval(&at.tree.rods, at.parameters()).share();
                let [a, b] = spring.ends;
                let arm = |point: usize, weight: f64| (at.frame(point), *at.point(point), weight);
                let arms = [arm(a, 1.0 - share), arm(after, share), arm(b, -1.0)];
                out.add_weighted::<G, P>(&arms, &force, &direction, hessian);
                continue;
            }
            let frames = spring.ends.map(|end| at.frame(end));
            out.add_pair::<G, P>(frames, spring.ends.map(|end| at.point(end)), &force, &direction, hessian);
        }
    }

    fn switched_on(&self, at: &State<G, D, P>, kept: &Vec<Option<Vector<P>>>) -> usize {
        self.taut(at, kept).count()
    }

    fn has_switches(&self) -> bool {
        self.0.iter().any(|spring| spring.slack)
    }

    fn for_each_switch(
        &self,
        at: &State<G, D, P>,
        _: &Vec<Option<Vector<P>>>,
        margin: f64,
        visit: &mut impl FnMut(Switch<P>),
    ) {
        for spring in self.0.iter().filter(|spring| spring.slack) {
            let [k, rest] = [spring.stiffness, spring.rest_length].map(|i| at.parameters()[i]);
            let [a, b] = spring.ends;
            let r = spring.sum(at, |point| *at.point(point));
            let length = r.norm();
            let depth = length - rest;
            if length > 0.0 && depth > -margin {
                let (points, t, sign) = match spring.between {
                    None => ([a, b, b], 0.0, -1.0),
                    Some((after, place)) => {
                        ([b, a, after], place.interval(&at.tree.rods, at.parameters()).share()[0], 1.0)
                    }
                };
                let normal = r * (sign / length);
                visit(Switch { points, t, own: None, carrier: None, normal, depth, stiffness: k });
            }
        }
    }

    fn for_each_stiffness(&self, _: &[f64], visit: &mut impl FnMut(usize, f64)) {
        self.0.iter().for_each(|spring| visit(spring.stiffness, 1.0));
    }

    fn keep(&self, at: &State<G, D, P>, motion: &Velocities<D, P>, kept: &mut Vec<Option<Vector<P>>>) {
        for (spring, kept) in self.0.iter().zip(kept) {
            let [k, rest] = [spring.stiffness, spring.rest_length].map(|i| at.parameters()[i]);
            let r = spring.sum(at, |point| *at.point(point));
            let (moved, length) = (r + spring.sum(at, |point| motion.points[point]), r.norm());
            let direction = r * (1.0 / length);
            let stretch = moved.dot(&direction) - rest;
            *kept = if rest == 0.0 {
                Some(moved * k)
            } else {
                (length > 0.0 && !(spring.slack && stretch <= 0.0)).then(|| direction * (k * stretch))
            };
        }
    }

    fn add_magnitudes(
        &self,
        at: &State<G, D, P>,
        _: &(),
        kept: &Vec<Option<Vector<P>>>,
        out: &mut Magnitudes<P>,
    ) {
        for (spring, taut) in self.taut(at, kept) {
            let [k, rest] = [spring.stiffness, spring.rest_length].map(|i| at.parameters()[i]);
            let [a, b] = spring.ends.map(|end| at.point(end).norm());
            let places = a + b + rest;
            spring.for_each_arm(at, |point, weight| {
                out.add_of_distance(at, point, taut.force.norm() * weight.abs(), [k, places]);
            });
        }
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        kept: &Vec<Option<Vector<P>>>,
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        for (spring, taut) in self.taut(at, kept) {
            let rate = spring.sum(at, |point| motion.velocities.points[point]);
            let extension = taut.direction.dot(&rate);
            if let Some((slot, moved)) = spring.moved(at, |point| *at.point(point)) {
                gradient[slot] += taut.change(&moved).dot(&rate);
                let carried = spring.moved(at, |point| motion.velocities.points[point]);
                gradient[slot] += carried.map_or(0.0, |(_, rate)| taut.force.dot(&rate));
            }
            gradient[spring.stiffness] += taut.stretch * extension;
            gradient[spring.rest_length] -= at.parameters()[spring.stiffness] * extension;
        }
    }

    fn add_geometric_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        kept: &Vec<Option<Vector<P>>>,
        motion: &VirtualMotion<D, P>,
        velocities: &Velocities<D, P>,
        work: &mut f64,
    ) {
        let VirtualMotion { velocities: virtual_motion, .. } = motion;
        for (spring, taut) in self.taut(at, kept) {
            let rate = spring.sum(at, |point| virtual_motion.points[point]);
            let moved = spring.sum(at, |point| velocities.points[point]);
            let shifted = spring
                .sum(at, |point| virtual_motion.shifted::<G>(at.frame(point), &velocities.points[point]));
            *work += taut.change(&moved).dot(&rate) + taut.force.dot(&shifted);
        }
    }
}
