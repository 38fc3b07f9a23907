//! Friction of tendons in their guides, the points that they pass: elastic slip with memory.
//!
//! A tendon gives way at its first place, where it is pulled and where its elasticity is; from there on its length
//! does not change. So it slips through a guide as the length L beyond changes. With the tension T before the guide
//! and T + f beyond, for a tendon that turns there by the angle φ,
//!
//! ```text
//! f = k s  within  T (e^(−μφ) − 1) ≤ f ≤ T (e^(μφ) − 1),
//! ```
//!
//! the capstan equation where it slides. s is the elastic slip with which a step began plus the change of L since,
//! and f/k at its end. With the limits held each guide has a potential in a step, Huber's; they are renewed from the
//! state, from the first guide to the last.

use super::tension::Pull;
use super::{Leg, Tendon, Tendons};
use crate::forces::friction::FrictionForce;
use crate::forces::state::State;
use crate::forces::terms::{Coupling, FrameTerms};
use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};

/// Largest μφ; beyond it the exponential would overflow.
pub(super) const MOST_GRIP: f64 = 500.0;

/// Slip beyond the limit in a step, as a fraction of the elastic slip, from which on a tendon slides.
const SLIDING: f64 = 1e-3;

/// Distance from the limit, relative to it, at which a tendon may stick or slide.
const AT_LIMIT: f64 = 1e-7;

/// Friction of one tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GuideFriction {
    /// Parameter holding μ.
    pub coefficient: usize,
    /// k [N/m].
    pub stiffness: f64,
}

/// What is held of one guide in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guide {
    /// Length beyond it when the slip was `slip`.
    base: f64,
    slip: f64,
    /// Least and largest f.
    limits: [f64; 2],
}

/// A leg of a tendon with friction in a state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span<const P: usize> {
    pub length: f64,
    /// Unit vector from its second to its first point.
    pub along: Vector<P>,
    /// Length of all legs after it.
    pub beyond: f64,
    tension: f64,
    /// Change of the tension as this leg or one after it becomes longer.
    stiffness: f64,
}

/// The memory of a path, and what the residual left: legs and tensions of all tendons with friction in turn.
#[derive(Clone, Debug, Default)]
pub(crate) struct GuideMemory<const P: usize> {
    pub(super) held: Vec<Guide>,
    /// Energy dissipated before the step [J].
    dissipated: f64,
    spans: Vec<Span<P>>,
    pub(super) pulls: Vec<Pull>,
}

impl Guide {
    pub fn slip(&self, beyond: f64) -> f64 {
        self.slip + beyond - self.base
    }

    /// The force at a slip, and the limit, if it is there.
    pub fn at(&self, k: f64, slip: f64) -> (f64, Option<usize>) {
        let [least, largest] = self.limits;
        match k * slip {
            _ if largest <= 0.0 => (0.0, Some(1)), // slack
            elastic if elastic < least => (least, Some(0)),
            elastic if elastic > largest => (largest, Some(1)),
            elastic => (elastic, None),
        }
    }

    /// What is dissipated as the step ends.
    fn dissipation(&self, k: f64, slip: f64) -> f64 {
        match self.at(k, slip) {
            (force, Some(_)) => force * (slip - force / k),
            _ => 0.0,
        }
    }

    /// The potential.
    fn energy(&self, k: f64, slip: f64) -> f64 {
        let elastic = self.at(k, slip).0 / k;
        0.5 * k * elastic * elastic + self.dissipation(k, slip)
    }
}

/// Angle between two unit vectors.
pub(super) fn turn<const P: usize>(a: &Vector<P>, b: &Vector<P>) -> f64 {
    let cosine = a.dot(b);
    (*b - *a * cosine).norm().atan2(cosine)
}

impl<const P: usize> GuideMemory<P> {
    /// The legs of a tendon, and the index of its first guide; `index` counts those with friction.
    pub(super) fn of(&self, tendons: &Tendons<P>, index: usize) -> (&[Span<P>], usize) {
        let before: usize = tendons.rough().take(index).map(|(tendon, _)| tendon.legs.len()).sum();
        let count = tendons.rough().nth(index).map_or(0, |(tendon, _)| tendon.legs.len());
        (&self.spans[before..before + count], before - index)
    }

    /// Forgets the state evaluated last.
    pub(super) fn clear_state(&mut self) {
        self.spans.clear();
        self.pulls.clear();
    }

    /// Tension in a leg of a tendon with friction.
    pub(super) fn tension(&self, tendons: &Tendons<P>, index: usize, leg: usize) -> f64 {
        self.of(tendons, index).0[leg].tension
    }

    /// Largest tension and stiffness of a tendon with friction.
    pub(super) fn largest(&self, tendons: &Tendons<P>, index: usize) -> [f64; 2] {
        let largest = |[tension, stiffness]: [f64; 2], span: &Span<P>| {
            [tension.max(span.tension), stiffness.max(span.stiffness)]
        };
        self.of(tendons, index).0.iter().fold([0.0; 2], largest)
    }

    /// Visits each guide: its index, the stiffness of its friction, and its slip.
    fn for_each_guide(&self, tendons: &Tendons<P>, mut visit: impl FnMut(usize, f64, f64)) {
        if self.held.is_empty() {
            return;
        }
        let (mut span, mut guide) = (0, 0);
        for (tendon, friction) in tendons.rough() {
            for _ in 1..tendon.legs.len() {
                visit(guide, friction.stiffness, self.held[guide].slip(self.spans[span].beyond));
                (span, guide) = (span + 1, guide + 1);
            }
            span += 1;
        }
    }

    /// Lets no tendon slide until limits are renewed.
    pub fn stick(&mut self) {
        self.held.iter_mut().for_each(|guide| guide.limits = [f64::NEG_INFINITY, f64::INFINITY]);
    }

    /// The part of the potential that is not stored but dissipated as the step ends [J].
    pub fn dissipation(&self, tendons: &Tendons<P>) -> f64 {
        let mut sum = 0.0;
        self.for_each_guide(tendons, |i, k, slip| sum += self.held[i].dissipation(k, slip));
        sum
    }

    /// Energy dissipated up to the state evaluated last [J].
    pub fn dissipated(&self, tendons: &Tendons<P>) -> f64 {
        self.dissipated + self.dissipation(tendons)
    }

    /// Ends a step: gives up the slip beyond the limit, all but a small excess. The next one begins here.
    pub fn end_step(&mut self, tendons: &Tendons<P>, excess: f64) {
        self.dissipated = self.dissipated(tendons);
        let mut slips = vec![];
        self.for_each_guide(tendons, |i, k, slip| {
            slips.push(match self.held[i].at(k, slip) {
                (force, Some(_)) => force / k * (1.0 + excess),
                _ => slip,
            });
        });
        self.held.iter_mut().zip(slips).for_each(|(guide, slip)| guide.slip = slip);
        self.begin_step(tendons);
        self.dissipated -= self.dissipation(tendons);
    }

    /// Lets a step begin in the state evaluated last with the slips that guides have.
    pub fn begin_step(&mut self, tendons: &Tendons<P>) {
        let Self { held, spans, .. } = self;
        let mut guides = held.iter_mut();
        let mut first = 0;
        for (tendon, _) in tendons.rough() {
            let own = &spans[first..first + tendon.legs.len()];
            // Each leg but the last ends in a guide.
            own[1..].iter().zip(own).for_each(|(_, before)| {
                if let Some(guide) = guides.next() {
                    guide.base = before.beyond;
                }
            });
            first += own.len();
        }
    }

    /// Whether a tendon is at its limit in some guide.
    pub fn is_about_to_slide(&self, tendons: &Tendons<P>) -> bool {
        let mut found = false;
        self.for_each_guide(tendons, |i, k, slip| {
            let near = |limit: &f64| limit.abs() > 0.0 && (k * slip - limit).abs() < AT_LIMIT * limit.abs();
            found |= self.held[i].limits.iter().any(near);
        });
        found
    }
}

impl<const P: usize> Tendons<P> {
    /// The tendons with friction.
    pub(super) fn rough(&self) -> impl Iterator<Item = (&Tendon, GuideFriction)> {
        self.tendons.iter().filter_map(|tendon| Some((tendon, tendon.friction?)))
    }

    /// Number of tendons with friction.
    pub fn rough_count(&self) -> usize {
        self.rough().count()
    }

    /// Computes legs and tensions of a tendon with friction, after those before it, and adds energy and forces.
    pub(super) fn add_rough_residual<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        (tendon, friction): (&Tendon, GuideFriction),
        memory: &mut GuideMemory<P>,
        out: &mut FrameTerms<D>,
    ) {
        let GuideMemory { held, spans, pulls, .. } = memory;
        let (first, guides) = (spans.len(), spans.len() - pulls.len());
        for leg in &tendon.legs {
            let [a, b] = leg.points.map(|point| at.point(point));
            let (r, [beyond, tension, stiffness]) = (*a - *b, [0.0; 3]);
            let length = r.norm();
            let along = if length > 0.0 { r * (1.0 / length) } else { Vector::ZERO };
            spans.push(Span { length, along, beyond, tension, stiffness });
        }
        let own = &mut spans[first..];
        let mut beyond = 0.0;
        for span in own.iter_mut().rev() {
            span.beyond = beyond;
            beyond += span.length;
        }
        let pull = tendon.tension.at(at.parameters(), at.load, beyond);
        let Pull { energy, mut tension, mut stiffness } = pull;
        out.energy += energy;
        for (i, span) in own.iter_mut().enumerate() {
            (span.tension, span.stiffness) = (tension, stiffness);
            let leg = &tendon.legs[i];
            let frames = leg.points.map(|point| at.frame(point));
            if frames[0] != frames[1] {
                let force = span.along * tension;
                out.add_force::<G, P>(frames[0], at.point(leg.points[0]), &force);
                out.add_force::<G, P>(frames[1], at.point(leg.points[1]), &-force);
            }
            if let Some(guide) = held.get(guides + i).filter(|_| i + 1 < tendon.legs.len()) {
                let slip = guide.slip(span.beyond);
                let (force, limit) = guide.at(friction.stiffness, slip);
                out.energy += guide.energy(friction.stiffness, slip);
                tension += force;
                stiffness += if limit.is_none() { friction.stiffness } else { 0.0 };
            }
        }
        pulls.push(pull);
    }

    /// Renews the limits from the state evaluated last.
    pub fn renew_guides<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &mut GuideMemory<P>,
    ) {
        let GuideMemory { held, spans, pulls, .. } = memory;
        let fresh = held.is_empty();
        let (mut span, mut guide) = (0, 0);
        for ((tendon, friction), pull) in self.rough().zip(pulls.iter()) {
            let mu = at.parameters()[friction.coefficient];
            let mut tension = pull.tension.max(0.0);
            for _ in 1..tendon.legs.len() {
                let [before, after] = [&spans[span], &spans[span + 1]];
                if fresh {
                    held.push(Guide { base: before.beyond, slip: 0.0, limits: [0.0; 2] });
                }
                let grip = (mu * turn(&before.along, &after.along)).min(MOST_GRIP);
                let own = &mut held[guide];
                own.limits = [-grip, grip].map(|grip| tension * grip.exp_m1());
                tension += own.at(friction.stiffness, own.slip(before.beyond)).0;
                (span, guide) = (span + 1, guide + 1);
            }
            span += 1;
        }
    }

    /// The tangent of a tendon with friction, with the limits held.
    pub(super) fn add_rough_tangent<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        (index, tendon): (usize, &Tendon),
        memory: &GuideMemory<P>,
        out: &mut FrameTerms<D>,
    ) {
        let (spans, _) = memory.of(self, index);
        for (leg, span) in tendon.legs.iter().zip(spans) {
            if span.tension != 0.0 {
                self.add_curvature(at, leg, span.tension, out);
            }
        }
        if spans.last().is_none_or(|span| span.stiffness == 0.0) {
            return;
        }
        for (k, &row) in tendon.frames.iter().enumerate() {
            for &column in &tendon.frames[..=k] {
                let mut form = Matrix::<D, D>::ZERO;
                for (m, (leg, span)) in tendon.legs.iter().zip(spans).enumerate() {
                    let Some(own) = wrench_of_leg(at, leg, span, row) else { continue };
                    for (l, (other, there)) in tendon.legs.iter().zip(spans).enumerate() {
                        let stiffness = spans[m.min(l)].stiffness;
                        if let Some(wrench) = wrench_of_leg(at, other, there, column) {
                            form += own.outer(&(wrench * stiffness));
                        }
                    }
                }
                if row == column {
                    out.stiffness[row] += form;
                } else {
                    out.couplings.push(Coupling { row, column, form });
                }
            }
        }
    }

    /// The forces at guides in the state evaluated last; frictions are counted from `from`.
    pub fn guide_forces<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &GuideMemory<P>,
        from: usize,
    ) -> Vec<FrictionForce<P>> {
        let mut forces = vec![];
        if memory.held.is_empty() {
            return forces;
        }
        for (index, (tendon, friction)) in self.rough().enumerate() {
            let (spans, first) = memory.of(self, index);
            for i in 0..spans.len() - 1 {
                let (guide, k) = (&memory.held[first + i], friction.stiffness);
                let slip = guide.slip(spans[i].beyond);
                let (force, _) = guide.at(k, slip);
                let along = forwards(&spans[i..i + 2]);
                let limit = guide.limits[usize::from(slip > 0.0)].abs();
                forces.push(FrictionForce {
                    friction: from + index,
                    sphere: i,
                    other: 0,
                    place: *at.point(tendon.legs[i].points[1]),
                    force: along * force,
                    limit,
                    slip: along * (force / k),
                    slides: limit > 0.0 && k * slip.abs() > limit * (1.0 + SLIDING),
                });
            }
        }
        forces
    }

    /// Sets the slip of a guide that a path begins with, from one given in the world.
    pub fn set_guide_slip(&self, memory: &mut GuideMemory<P>, [index, i]: [usize; 2], slip: &Vector<P>) {
        if memory.held.is_empty() || index >= self.rough_count() {
            return;
        }
        let (spans, first) = memory.of(self, index);
        if i + 1 < spans.len() {
            let along = forwards(&spans[i..i + 2]).dot(slip);
            memory.held[first + i].slip = along;
        }
    }
}

/// Direction of a tendon in a guide between two legs, towards its last point.
fn forwards<const P: usize>(spans: &[Span<P>]) -> Vector<P> {
    let sum = spans[0].along + spans[1].along;
    let norm = sum.norm();
    // Where it turns back there is none; that of the leg before.
    if norm > 0.0 { sum * (-1.0 / norm) } else { -spans[0].along }
}

/// The gradient of the length of a leg by the world twist of a frame, if it moves it.
fn wrench_of_leg<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    leg: &Leg,
    span: &Span<P>,
    frame: usize,
) -> Option<Vector<D>> {
    let frames = leg.points.map(|point| at.frame(point));
    if frames[0] == frames[1] {
        return None;
    }
    let end = frames.iter().position(|own| *own == frame)?;
    let slope = if end == 0 { span.along } else { -span.along };
    Some(G::point_jacobian(at.point(leg.points[end])).transpose_times(&slope))
}
