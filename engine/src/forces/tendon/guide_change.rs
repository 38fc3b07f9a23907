//! How friction in guides changes to first order: with the state in which its limits were renewed, with parameters and
//! loads, and with what the step began with. Beside the tangent of the potential it has no potential.

use super::Tendons;
use super::guide::{GuideMemory, MOST_GRIP, Span, turn};
use crate::forces::element::Velocities;
use crate::forces::state::State;
use crate::lie::LieGroup;
use crate::linalg::Vector;

/// How the force at each guide changes to first order, of all tendons with friction in turn.
#[derive(Clone, Debug, Default)]
pub(crate) struct GuideSlopes {
    /// With each coordinate.
    pub by_coordinates: Vec<Vec<f64>>,
    /// With each wanted parameter.
    pub by_parameters: Vec<Vec<f64>>,
    /// With each load.
    pub by_loads: Vec<Vec<f64>>,
    /// With the slip with which each guide began, less the length beyond it then.
    pub by_start: Vec<Vec<f64>>,
}

/// What a force at a guide changes with, beside the places of points.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct GuideChange {
    /// A parameter that changes at the rate 1.
    pub parameter: Option<usize>,
    /// A load that does.
    pub input: Option<usize>,
    /// A guide whose slip at the beginning does.
    pub start: Option<usize>,
}

impl<const P: usize> Tendons<P> {
    /// The change of the force at each guide for a motion, with the limits following from the state.
    pub fn guide_changes<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &GuideMemory<P>,
        velocities: Option<&Velocities<D, P>>,
        change: GuideChange,
        out: &mut Vec<f64>,
    ) {
        out.clear();
        if memory.held.is_empty() {
            return;
        }
        for (index, ((tendon, friction), pull)) in self.rough().zip(&memory.pulls).enumerate() {
            let (spans, first) = memory.of(self, index);
            let rate = |m: usize| {
                let moved = |velocities: &Velocities<D, P>| {
                    let [a, b] = tendon.legs[m].points.map(|point| velocities.points[point]);
                    a - b
                };
                velocities.map_or(Vector::ZERO, moved)
            };
            let longer = |m: usize| spans[m].along.dot(&rate(m));
            let length = spans[0].length + spans[0].beyond;
            let mut beyond: f64 = (0..spans.len()).map(longer).sum();
            let mut pulled = pull.stiffness * beyond;
            if let Some(wanted) = change.parameter {
                tendon.tension.by_parameters(at.parameters(), at.load, length, |parameter, slope| {
                    pulled += if parameter == wanted { slope } else { 0.0 };
                });
            }
            if let Some(wanted) = change.input {
                let own = tendon.tension.by_input(at.parameters(), length);
                pulled += own.filter(|(input, _)| *input == wanted).map_or(0.0, |(_, slope)| slope);
            }
            let mu = at.parameters()[friction.coefficient];
            let steeper = if change.parameter == Some(friction.coefficient) { 1.0 } else { 0.0 };
            let mut tension = pull.tension.max(0.0);
            if pull.tension <= 0.0 {
                pulled = 0.0;
            }
            for i in 0..spans.len() - 1 {
                beyond -= longer(i);
                let guide = &memory.held[first + i];
                let (force, limit) = guide.at(friction.stiffness, guide.slip(spans[i].beyond));
                let slope = if let Some(side) = limit {
                    let sign = if side == 0 { -1.0 } else { 1.0 };
                    let angle = turn(&spans[i].along, &spans[i + 1].along);
                    let grip = sign * (mu * angle).min(MOST_GRIP);
                    let turned = steeper * angle + mu * turning(&spans[i..i + 2], [rate(i), rate(i + 1)]);
                    grip.exp_m1() * pulled + tension * grip.exp() * sign * turned
                } else {
                    let began = if change.start == Some(first + i) { 1.0 } else { 0.0 };
                    friction.stiffness * (beyond + began)
                };
                out.push(slope);
                pulled += slope;
                tension += force;
            }
        }
    }

    /// Adds the wrenches on frames by which friction changes beside its tangent in a step, for a motion in the state
    /// in which limits were renewed.
    pub fn add_guide_renewal<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        memory: &GuideMemory<P>,
        velocities: &Velocities<D, P>,
        work: &mut Vec<f64>,
        wrench: &mut [Vector<D>],
    ) {
        self.guide_changes(at, memory, Some(velocities), GuideChange::default(), work);
        if work.is_empty() {
            return;
        }
        for (index, (tendon, friction)) in self.rough().enumerate() {
            let (spans, first) = memory.of(self, index);
            let mut more = 0.0;
            for (m, (leg, span)) in tendon.legs.iter().zip(spans).enumerate() {
                let [a, b] = leg.points;
                if more != 0.0 {
                    let [p, q] = leg.points.map(|point| G::point_jacobian(at.point(point)));
                    wrench[at.frame(a)] += p.transpose_times(&(span.along * more));
                    wrench[at.frame(b)] -= q.transpose_times(&(span.along * more));
                }
                if m + 1 < spans.len() {
                    let guide = &memory.held[first + m];
                    let slides = guide.at(friction.stiffness, guide.slip(span.beyond)).1.is_some();
                    more += if slides { work[first + m] } else { 0.0 };
                }
            }
        }
    }

    /// Rate at which the length beyond each guide changes.
    pub fn guide_rates<const D: usize>(
        &self,
        memory: &GuideMemory<P>,
        velocities: &Velocities<D, P>,
        out: &mut Vec<f64>,
    ) {
        out.clear();
        for (index, (tendon, _)) in self.rough().enumerate() {
            let (spans, first) = memory.of(self, index);
            let mut beyond = 0.0;
            for (m, (leg, span)) in tendon.legs.iter().zip(spans).enumerate().rev() {
                if m + 1 < spans.len() {
                    out.resize(out.len().max(first + m + 1), 0.0);
                    out[first + m] = beyond;
                }
                let [a, b] = leg.points.map(|point| velocities.points[point]);
                beyond += span.along.dot(&(a - b));
            }
        }
    }

    /// Adds the slopes by points of Σ weight · the length beyond each guide.
    pub fn add_guide_lengths(
        &self,
        memory: &GuideMemory<P>,
        weights: &[f64],
        points: &mut Vec<(usize, Vector<P>)>,
    ) {
        if weights.is_empty() {
            return;
        }
        for (index, (tendon, _)) in self.rough().enumerate() {
            let (spans, first) = memory.of(self, index);
            let mut sum = 0.0;
            for (m, (leg, span)) in tendon.legs.iter().zip(spans).enumerate() {
                if sum != 0.0 {
                    points.push((leg.points[0], span.along * sum));
                    points.push((leg.points[1], span.along * -sum));
                }
                sum += if m + 1 < spans.len() { weights[first + m] } else { 0.0 };
            }
        }
    }

    /// Divides a number for each guide by the stiffness of its friction.
    pub fn by_guide_stiffness(&self, values: &mut [f64]) {
        let stiffness =
            self.rough().flat_map(|(tendon, friction)| vec![friction.stiffness; tendon.legs.len() - 1]);
        values.iter_mut().zip(stiffness).for_each(|(value, k)| *value /= k);
    }
}

/// Rate of the angle between two legs whose first points move as seen from their second ones.
fn turning<const P: usize>(spans: &[Span<P>], rates: [Vector<P>; 2]) -> f64 {
    let [a, b] = [spans[0].along, spans[1].along];
    let cosine = a.dot(&b);
    let sine = (b - a * cosine).norm();
    if sine == 0.0 {
        return 0.0; // straight: one-sided
    }
    let across = [(b - a * cosine) * (1.0 / spans[0].length), (a - b * cosine) * (1.0 / spans[1].length)];
    -(across[0].dot(&rates[0]) + across[1].dot(&rates[1])) / sine
}
