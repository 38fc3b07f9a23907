//! Tendons across bodies: V(ℓ), with ℓ the length of the shortest path through points and around wraps.
//!
//! A path is made of legs, each from a point to the next, straight or around a wrap between them. What the
//! ends of a leg around a wrap feel, the frame that carries the wrap feels in the opposite direction, at the
//! same places. Where a leg comes to touch a wrap its length and the forces are continuous and the tangent
//! jumps, as that of a contact does.

mod choice;
mod curve;
mod definition;
mod guide;
mod guide_change;
mod output;
mod tension;
#[cfg(test)]
mod tests;
mod wrap;

pub use curve::MuscleCurve;
pub use definition::{
    GuideDescription, StageDescription, TendonDescription, TensionDescription, WrapDescription,
};

use super::element::{ForceElement, ForceMemory, Velocities, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::state::State;
use super::terms::{Coupling, FrameTerms, Terms};
use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};
use crate::tree::{ModelError, Tree};
use guide::GuideFriction;
pub(crate) use guide::GuideMemory;
pub(crate) use guide_change::{GuideChange, GuideSlopes};
use tension::{Pull, Tension};
use wrap::{Around, Ends};

/// All tendons, and what they wrap around.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tendons<const P: usize> {
    tendons: Vec<Tendon>,
    wraps: Vec<Wrap<P>>,
}

/// A sphere, or a cylinder along `axis` in the frame that carries it.
#[derive(Clone, Debug, PartialEq)]
struct Wrap<const P: usize> {
    point: usize,
    frame: usize,
    axis: Option<Vector<P>>,
    /// Parameter holding the radius.
    radius: usize,
}

#[derive(Clone, Debug, PartialEq)]
struct Tendon {
    legs: Vec<Leg>,
    /// The frames that it pulls on, each once, without the world.
    frames: Vec<usize>,
    tension: Tension,
    friction: Option<GuideFriction>,
}

/// A part of a tendon, from a point to the next.
#[derive(Clone, Debug, PartialEq)]
struct Leg {
    points: [usize; 2],
    /// The wrap, and the point on the side on which it passes.
    wrap: Option<(usize, Option<usize>)>,
    /// Its length counts by one part in so many.
    divisor: f64,
}

/// The shape of a leg in a state.
#[allow(clippy::large_enum_variant)] // It lives on the stack, for one leg at a time.
#[derive(Clone, Copy, Debug)]
enum Course<const P: usize> {
    /// Straight, of this length and along this unit vector from the second to the first point.
    Free(f64, Vector<P>),
    Wrapped(Around<P>),
}

/// The gradient of a length by the place of something that moves with a frame.
struct Tug<const P: usize> {
    frame: usize,
    place: Vector<P>,
    slope: Vector<P>,
}

impl<const P: usize> Tendons<P> {
    pub fn build<G: LieGroup<D, P>, const D: usize>(
        tree: &mut Tree<G, D, P>,
        tendons: &[TendonDescription],
        wraps: &[WrapDescription],
    ) -> Result<Self, ModelError> {
        let built = wraps.iter().map(|wrap| Wrap::build(tree, wrap)).collect::<Result<Vec<_>, _>>()?;
        let all = tendons.iter().map(|tendon| Tendon::build(tree, tendon, wraps, &built));
        Ok(Self { tendons: all.collect::<Result<_, _>>()?, wraps: built })
    }

    pub fn count(&self) -> usize {
        self.tendons.len()
    }

    fn course<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>, leg: &Leg) -> Course<P> {
        let [a, b] = leg.points.map(|point| *at.point(point));
        if let Some((index, side)) = leg.wrap {
            let wrap = &self.wraps[index];
            let centre = *at.point(wrap.point);
            let ends = Ends {
                ends: [a - centre, b - centre],
                axis: wrap.axis.map(|axis| at.kinematics.pose[wrap.frame].rotate(&axis)),
                side: side.map(|side| *at.point(side) - centre),
                radius: at.parameters()[wrap.radius],
            };
            if let Some(around) = ends.around() {
                return Course::Wrapped(around);
            }
        }
        let r = a - b;
        let length = r.norm();
        // Coincident points have no direction, and no length to change to first order.
        Course::Free(length, if length > 0.0 { r * (1.0 / length) } else { Vector::ZERO })
    }

    fn length<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>, tendon: &Tendon) -> f64 {
        let part = |leg: &Leg| {
            let length = match self.course(at, leg) {
                Course::Free(length, _) => length,
                Course::Wrapped(around) => around.length,
            };
            length / leg.divisor
        };
        tendon.legs.iter().map(part).sum()
    }

    fn pull<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>, tendon: &Tendon) -> Pull {
        tendon.tension.at(at.parameters(), at.load, self.length(at, tendon))
    }

    /// Visits the gradient of a tendon's length by everything that it pulls on.
    fn for_each_tug<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        tendon: &Tendon,
        mut visit: impl FnMut(Tug<P>),
    ) {
        for leg in &tendon.legs {
            let share = 1.0 / leg.divisor;
            let frames = leg.points.map(|point| at.frame(point));
            let places = leg.points.map(|point| *at.point(point));
            match self.course(at, leg) {
                // Between points of one body nothing changes.
                Course::Free(..) if frames[0] == frames[1] => {}
                Course::Free(_, along) => {
                    visit(Tug { frame: frames[0], place: places[0], slope: along * share });
                    visit(Tug { frame: frames[1], place: places[1], slope: along * -share });
                }
                Course::Wrapped(around) => {
                    let Some((wrap, _)) = leg.wrap else { continue };
                    for i in 0..2 {
                        let slope = around.gradient[i] * share;
                        visit(Tug { frame: frames[i], place: places[i], slope });
                        visit(Tug { frame: self.wraps[wrap].frame, place: places[i], slope: -slope });
                    }
                }
            }
        }
    }

    /// The gradient of a tendon's length by the world twist of a frame.
    fn wrench<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        tendon: &Tendon,
        frame: usize,
    ) -> Vector<D> {
        let mut sum = Vector::ZERO;
        self.for_each_tug(at, tendon, |tug| {
            if tug.frame == frame {
                sum += G::point_jacobian(&tug.place).transpose_times(&tug.slope);
            }
        });
        sum
    }

    /// Velocity of a place that moves with a wrap.
    fn carried<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        wrap: usize,
        velocities: &Velocities<D, P>,
        place: &Vector<P>,
    ) -> Vector<P> {
        let Wrap { point, frame, .. } = self.wraps[wrap];
        let arm = *place - *at.point(point);
        velocities.points[point] + velocities.shifted::<G>(frame, &arm)
    }

    /// Velocities of both ends of a leg: around a wrap as seen from it, otherwise as they are.
    fn relative<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        leg: &Leg,
        wrapped: bool,
        velocities: &Velocities<D, P>,
    ) -> [Vector<P>; 2] {
        leg.points.map(|point| {
            let own = velocities.points[point];
            match leg.wrap.filter(|_| wrapped) {
                Some((wrap, _)) => own - self.carried(at, wrap, velocities, at.point(point)),
                None => own,
            }
        })
    }

    /// Rate of change of the length of a leg, by its divisor.
    fn rate<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        leg: &Leg,
        velocities: &Velocities<D, P>,
    ) -> f64 {
        let course = self.course(at, leg);
        let [a, b] = self.relative(at, leg, matches!(course, Course::Wrapped(_)), velocities);
        let rate = match course {
            Course::Free(_, along) => along.dot(&(a - b)),
            Course::Wrapped(around) => around.gradient[0].dot(&a) + around.gradient[1].dot(&b),
        };
        rate / leg.divisor
    }

    /// The tangent of `weight` times the length of a leg.
    fn add_curvature<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        leg: &Leg,
        weight: f64,
        out: &mut FrameTerms<D>,
    ) {
        let frames = leg.points.map(|point| at.frame(point));
        let places = leg.points.map(|point| at.point(point));
        match self.course(at, leg) {
            Course::Free(length, along) => {
                if frames[0] != frames[1] && length > 0.0 {
                    let hessian = [0.0, weight / length];
                    out.add_pair::<G, P>(frames, places, &(along * weight), &along, hessian);
                }
            }
            Course::Wrapped(around) => {
                let Some((wrap, _)) = leg.wrap else { return };
                let carrier = self.wraps[wrap].frame;
                let jacobians = places.map(|place| G::point_jacobian(place));
                let [first, mixed, second] = around.curvature().hessian;
                let form = |i: usize, hessian: Matrix<P, P>, j: usize| {
                    jacobians[i].transpose() * (hessian * jacobians[j]) * weight
                };
                let slopes = around.gradient.map(|slope| slope * weight);
                let own = [(0, first), (1, second)]
                    .map(|(i, hessian)| form(i, hessian, i) + G::point_curvature(places[i], &slopes[i]));
                let mixed = form(0, mixed, 1);
                for i in 0..2 {
                    out.stiffness[frames[i]] += own[i];
                }
                out.couplings.push(Coupling { row: frames[0], column: frames[1], form: mixed });
                if carrier != 0 {
                    // As for a point that is carried, and for both at once.
                    out.stiffness[carrier] += own[0] + own[1] + mixed + mixed.transpose();
                    for (i, mixed) in [(0, mixed), (1, mixed.transpose())] {
                        let bracket = G::bracket_form(&jacobians[i].transpose_times(&slopes[i]));
                        let form = bracket * 0.5 - own[i] - mixed;
                        out.couplings.push(Coupling { row: frames[i], column: carrier, form });
                    }
                }
            }
        }
    }
}

impl<const P: usize> ForceMemory<P> for Tendons<P> {
    type Design = ();
    /// Friction of tendons that have it.
    type State = GuideMemory<P>;
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Tendons<P> {
    fn design(&self, _: &Tree<G, D, P>) {}

    fn state(&self, _: &Tree<G, D, P>) -> GuideMemory<P> {
        GuideMemory::default()
    }

    fn is_admissible(&self, parameters: &[f64]) -> bool {
        self.wraps.iter().all(|wrap| parameters[wrap.radius] > 0.0)
            && self.tendons.iter().all(|tendon| tendon.is_admissible(parameters))
    }

    fn max_couplings(&self) -> usize {
        let of = |tendon: &Tendon| {
            let frames = tendon.frames.len();
            3 * tendon.legs.len() + frames * frames.saturating_sub(1) / 2
        };
        self.tendons.iter().map(of).sum()
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        _: &(),
        memory: &mut GuideMemory<P>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        memory.clear_state();
        for tendon in &self.tendons {
            if let Some(friction) = tendon.friction {
                self.add_rough_residual(at, (tendon, friction), memory, out);
                continue;
            }
            let pull = self.pull(at, tendon);
            out.energy += pull.energy;
            self.for_each_tug(at, tendon, |tug| {
                out.add_force::<G, P>(tug.frame, &tug.place, &(tug.slope * pull.tension));
            });
        }
    }

    fn add_tangent(
        &self,
        at: &State<G, D, P>,
        _: &(),
        memory: &GuideMemory<P>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        let mut rough = 0;
        for tendon in &self.tendons {
            if tendon.friction.is_some() {
                self.add_rough_tangent(at, (rough, tendon), memory, out);
                rough += 1;
                continue;
            }
            let pull = self.pull(at, tendon);
            if pull.tension != 0.0 {
                for leg in &tendon.legs {
                    self.add_curvature(at, leg, pull.tension / leg.divisor, out);
                }
            }
            if pull.stiffness == 0.0 {
                continue;
            }
            for (k, &row) in tendon.frames.iter().enumerate() {
                let scaled = self.wrench(at, tendon, row) * pull.stiffness;
                out.stiffness[row] += self.wrench(at, tendon, row).outer(&scaled);
                for &column in &tendon.frames[..k] {
                    let form = scaled.outer(&self.wrench(at, tendon, column));
                    out.couplings.push(Coupling { row, column, form });
                }
            }
        }
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, _: &(), memory: &GuideMemory<P>, out: &mut Magnitudes<P>) {
        let mut rough = 0;
        for tendon in &self.tendons {
            let Pull { mut tension, mut stiffness, .. } = self.pull(at, tendon);
            if tendon.friction.is_some() {
                [tension, stiffness] = memory.largest(self, rough);
                rough += 1;
            }
            self.for_each_tug(at, tendon, |Tug { frame, place, slope }| {
                let places = place.norm() * tendon.legs.len() as f64;
                let share = slope.norm();
                let of_distance = [stiffness * share, places];
                out.add_of_distance_at(frame, place, tension * share, of_distance);
            });
        }
    }

    fn add_load_derivative(
        &self,
        at: &State<G, D, P>,
        _: &(),
        change: &[f64],
        out: &mut [f64],
        project: &impl Fn(usize, &Vector<D>, &mut [f64]),
    ) {
        for tendon in &self.tendons {
            let length = self.length(at, tendon);
            let Some((input, slope)) = tendon.tension.by_input(at.parameters(), length) else { continue };
            if change[input] == 0.0 {
                continue;
            }
            for &frame in &tendon.frames {
                project(frame, &(self.wrench(at, tendon, frame) * (slope * change[input])), out);
            }
        }
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        _: &GuideMemory<P>,
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        for tendon in &self.tendons {
            let length = self.length(at, tendon);
            let Pull { tension, stiffness, .. } = tendon.tension.at(at.parameters(), at.load, length);
            let rate: f64 = tendon.legs.iter().map(|leg| self.rate(at, leg, &motion.velocities)).sum();
            tendon.tension.by_parameters(at.parameters(), at.load, length, |parameter, slope| {
                gradient[parameter] += slope * rate;
            });
            for leg in &tendon.legs {
                let (Some((wrap, _)), Course::Wrapped(around)) = (leg.wrap, self.course(at, leg)) else {
                    continue;
                };
                let moved = self.relative(at, leg, true, &motion.velocities);
                let curvature = around.curvature();
                let turned: f64 = (0..2).map(|i| curvature.gradient_by_radius[i].dot(&moved[i])).sum();
                let change = stiffness * around.by_radius * rate + tension * turned;
                gradient[self.wraps[wrap].radius] += change / leg.divisor;
            }
        }
    }

    fn add_geometric_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        memory: &GuideMemory<P>,
        motion: &VirtualMotion<D, P>,
        velocities: &Velocities<D, P>,
        work: &mut f64,
    ) {
        let virtual_motion = &motion.velocities;
        let mut rough = 0;
        for tendon in &self.tendons {
            let Pull { tension, stiffness, .. } = self.pull(at, tendon);
            let spans = tendon.friction.map(|_| {
                rough += 1;
                rough - 1
            });
            let rate = |velocities: &Velocities<D, P>| -> f64 {
                tendon.legs.iter().map(|leg| self.rate(at, leg, velocities)).sum()
            };
            *work += stiffness * rate(velocities) * rate(virtual_motion);
            for (index, leg) in tendon.legs.iter().enumerate() {
                let tension = spans.map_or(tension, |own| memory.tension(self, own, index));
                let course = self.course(at, leg);
                let wrapped = matches!(course, Course::Wrapped(_));
                let moved = self.relative(at, leg, wrapped, velocities);
                let wanted = self.relative(at, leg, wrapped, virtual_motion);
                let own = leg.points.map(|point| velocities.points[point]);
                let shifted = |i: usize| virtual_motion.shifted::<G>(at.frame(leg.points[i]), &own[i]);
                let change = match course {
                    Course::Free(length, along) => {
                        let [change, virtual_change] = [moved, wanted].map(|[a, b]| a - b);
                        let across = change - along * along.dot(&change);
                        let bent = if length > 0.0 { across.dot(&virtual_change) / length } else { 0.0 };
                        bent + along.dot(&(shifted(0) - shifted(1)))
                    }
                    Course::Wrapped(around) => {
                        let Some((wrap, _)) = leg.wrap else { continue };
                        let frame = self.wraps[wrap].frame;
                        let [first, mixed, second] = around.curvature().hessian;
                        let mut change = (first * moved[0] + mixed * moved[1]).dot(&wanted[0])
                            + (mixed.transpose_times(&moved[0]) + second * moved[1]).dot(&wanted[1]);
                        for i in 0..2 {
                            let slope = &around.gradient[i];
                            change += slope.dot(&(shifted(i) - virtual_motion.shifted::<G>(frame, &own[i])));
                            change += velocities.shifted::<G>(frame, slope).dot(&wanted[i]);
                        }
                        change
                    }
                };
                *work += tension / leg.divisor * change;
            }
        }
    }
}
