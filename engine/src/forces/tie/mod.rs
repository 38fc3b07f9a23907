//! Ties: joints that close loops, as conditions c(q) = 0 with their reactions λ.
//!
//! Each condition is a function of the relative pose of two frames, the second one's and the target: the
//! first one's, moved by the driven motion and, while the loop is being closed, by what is left of the
//! opening. To second order in the world twists ζ of the frames,
//!
//! ```text
//! c = c₀ + w·(ζ_b − ζ_a) + ½ (ζ_b − ζ_a)ᵀ C (ζ_b − ζ_a) − ½ w·[ζ_a, ζ_b].
//! ```
//!
//! With reactions λ and penalties ρ they contribute −λ c + ½ ρ c² to Π; the solver finds the λ for which
//! c = 0 (`equilibrium/projection.rs`) and uses penalties only where it minimises the energy.

mod definition;
mod force;
mod reference;
mod sensitivity;
#[cfg(test)]
mod tests;

pub use definition::{TieDescription, TieDrive, TieKind};
pub(crate) use sensitivity::{ReferenceRates, TieOutput};

use super::state::State;
use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};
use std::ops::Range;

/// A scalar condition.
#[derive(Clone, Debug, PartialEq)]
enum Condition<const P: usize> {
    /// The second place has no displacement from the target along this direction, fixed in the target.
    Along(Vector<P>),
    /// A direction fixed in the target and one that turns with the second place are normal; both are those
    /// in the local frame of the first place in the reference state.
    About { fixed: Vector<P>, turned: Vector<P> },
}

/// A condition and the tie that it belongs to.
#[derive(Clone, Debug, PartialEq)]
struct Row<const P: usize> {
    tie: usize,
    condition: Condition<P>,
}

/// A relative motion that a load prescribes.
#[derive(Clone, Debug, PartialEq)]
struct Drive {
    input: usize,
    /// Its unit, a twist in the local frame of the first place, by strain mode.
    twist: [f64; 6],
    /// The condition whose reaction drives it.
    row: usize,
}

/// A joint that closes a loop.
#[derive(Clone, Debug, PartialEq)]
struct Tie<const P: usize> {
    name: String,
    points: [usize; 2],
    rows: Range<usize>,
    drive: Option<Drive>,
    /// Rotation vector of the second place.
    rotation: [f64; 3],
    /// The axis of a slider.
    along: Option<Vector<P>>,
}

/// All ties.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ties<const P: usize> {
    ties: Vec<Tie<P>>,
    rows: Vec<Row<P>>,
    /// Number of load inputs of the model; after these the loads have the progress of closing, all
    /// reactions and all penalties.
    inputs: usize,
}

/// A condition at a state.
#[derive(Clone, Debug)]
pub(crate) struct Value<const D: usize> {
    /// c.
    pub value: f64,
    /// w.
    pub slope: Vector<D>,
    /// C.
    pub curvature: Matrix<D, D>,
}

/// What ties derive from the parameters, and how they are opened.
#[derive(Clone, Debug)]
pub(crate) struct TieDesign<const P: usize> {
    /// The turned direction of each condition in the local frame of the second place.
    turned: Vec<Vector<P>>,
    /// Distance between the places of each slider along its axis in the reference state.
    shift: Vec<f64>,
    /// Twists from the closed target to the one where closing begins, and to the one where it ends, of each
    /// tie, by strain mode; the target moves along their mean.
    pub openings: Vec<[[f64; 6]; 2]>,
}

impl<const P: usize> Ties<P> {
    /// Number of ties.
    pub fn count(&self) -> usize {
        self.ties.len()
    }

    /// Number of conditions.
    pub fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// The tie of a condition, and whether that concerns an angle.
    pub fn row(&self, row: usize) -> (usize, bool) {
        (self.rows[row].tie, matches!(self.rows[row].condition, Condition::About { .. }))
    }

    /// The conditions of a tie; if it is driven, what drives it is the last one.
    pub fn rows(&self, tie: usize) -> Range<usize> {
        self.ties[tie].rows.clone()
    }

    /// Whether a load prescribes a motion of a tie.
    pub fn is_driven(&self, tie: usize) -> bool {
        self.ties[tie].drive.is_some()
    }

    /// The input of each driven motion, and whether it is a rotation.
    pub fn drives(&self) -> impl Iterator<Item = (usize, bool)> {
        let drives = self.ties.iter().filter_map(|tie| tie.drive.as_ref());
        drives.map(|drive| (drive.input, drive.twist[..3].iter().any(|x| *x != 0.0)))
    }

    /// Place of the progress of closing among the loads: 0 as it begins, 1 where it is done.
    pub fn progress(&self) -> usize {
        self.inputs
    }

    /// Places of the reactions among the loads.
    pub fn reactions(&self) -> Range<usize> {
        self.inputs + 1..self.inputs + 1 + self.rows.len()
    }

    /// Places of the penalties among the loads.
    pub fn penalties(&self) -> Range<usize> {
        let start = self.reactions().end;
        start..start + self.rows.len()
    }

    /// The frames of a condition.
    pub fn frames<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>, row: usize) -> [usize; 2] {
        self.ties[self.rows[row].tie].points.map(|point| at.frame(point))
    }

    /// The conditions of a tie.
    pub fn values<'a, G: LieGroup<D, P>, const D: usize>(
        &'a self,
        at: &'a State<G, D, P>,
        design: &'a TieDesign<P>,
        tie: usize,
    ) -> impl Iterator<Item = (usize, Value<D>)> + 'a {
        let Tie { points, rows, .. } = &self.ties[tie];
        let target = self.target(at, design, tie);
        let second = (at.frame(points[1]), *at.point(points[1]));
        rows.clone().map(move |row| {
            let value = match &self.rows[row].condition {
                Condition::Along(direction) => {
                    let a = target.rotate(direction);
                    let value = a.dot(&(second.1 - target.position()));
                    let slope = G::point_jacobian(&second.1).transpose_times(&a);
                    Value { value, slope, curvature: G::point_curvature(&second.1, &a) }
                }
                Condition::About { fixed, .. } => {
                    let a = target.rotate(fixed);
                    let b = at.kinematics.pose[second.0].rotate(&design.turned[row]);
                    let curvature = G::point_curvature(&b, &a) - G::point_curvature(&Vector::ZERO, &a);
                    Value { value: a.dot(&b), slope: moment_of::<G, D, P>(&b, &a), curvature }
                }
            };
            (row, value)
        })
    }

    /// The frame in which the target moves: that of the first place with the driven motion.
    fn driven_frame<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        design: &TieDesign<P>,
        tie: usize,
    ) -> G {
        let Tie { points, drive, along, .. } = &self.ties[tie];
        let first = self.first_frame(at, points[0], along.map(|axis| axis * design.shift[tie]));
        match drive {
            None => first,
            Some(drive) => {
                first.compose(&G::exponential(&(of_modes::<G, D, P>(&drive.twist) * at.load[drive.input])))
            }
        }
    }

    /// The pose of the first place.
    fn first_frame<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        point: usize,
        shift: Option<Vector<P>>,
    ) -> G {
        let local = at.geometry.points[point] + shift.unwrap_or(Vector::ZERO);
        let offset = G::from_spatial(&G::point_to_spatial(&local), &[0.0; 3]).unwrap_or(G::IDENTITY);
        at.kinematics.pose[at.frame(point)].compose(&offset)
    }

    /// The pose that the second place is tied to.
    fn target<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        design: &TieDesign<P>,
        tie: usize,
    ) -> G {
        let frame = self.driven_frame(at, design, tie);
        let opening = opening::<G, D, P>(&design.openings[tie], at.load[self.progress()]);
        if opening == Vector::ZERO { frame } else { frame.compose(&G::exponential(&opening)) }
    }

    /// World twist of the target with a change of the loads, the first place held.
    fn target_rate<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        design: &TieDesign<P>,
        tie: usize,
        change: &[f64],
    ) -> Vector<D> {
        let mut rate = Vector::ZERO;
        let frame = self.driven_frame(at, design, tie);
        if let Some(drive) = &self.ties[tie].drive {
            rate += frame.adjoint() * (of_modes::<G, D, P>(&drive.twist) * change[drive.input]);
        }
        let closing = change.get(self.progress()).copied().unwrap_or(0.0);
        if closing != 0.0 {
            let [from, to] = design.openings[tie].map(|modes| of_modes::<G, D, P>(&modes));
            let omega = opening::<G, D, P>(&design.openings[tie], at.load[self.progress()]);
            let stumpff = crate::lie::Stumpff::new(G::angle_squared(&omega));
            let motion = G::tangent(&omega, &stumpff) * ((to - from) * closing);
            rate += frame.compose(&G::exponential(&omega)).adjoint() * motion;
        }
        rate
    }

    /// Derivative of each condition along a change of the loads, at a fixed state.
    pub fn add_rates<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        design: &TieDesign<P>,
        change: &[f64],
        out: &mut [f64],
    ) {
        for tie in 0..self.ties.len() {
            let rate = self.target_rate(at, design, tie, change);
            if rate != Vector::ZERO {
                self.values(at, design, tie).for_each(|(row, value)| out[row] -= value.slope.dot(&rate));
            }
        }
    }

    /// The gap of each tie in this state: the largest violation of its conditions, as a length and as an
    /// angle.
    pub fn gaps<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        design: &TieDesign<P>,
        out: &mut [f64],
    ) {
        out.fill(0.0);
        for tie in 0..self.ties.len() {
            let mut squares = [0.0; 2];
            for (row, Value { value, .. }) in self.values(at, design, tie) {
                squares[usize::from(self.row(row).1)] += value * value;
            }
            out[2 * tie] = squares[0].sqrt();
            out[2 * tie + 1] = squares[1].sqrt().min(1.0).asin();
        }
    }

    /// What each tie does to its second place, [`TIE_NUMBERS`] numbers: the force on it in the world, the
    /// moment on it about its place, and the force or moment that drives it.
    pub fn loads<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        design: &TieDesign<P>,
        out: &mut [f64],
    ) {
        for (tie, out) in out.chunks_mut(TIE_NUMBERS).enumerate() {
            let mut wrench = Vector::ZERO;
            for (row, value) in self.values(at, design, tie) {
                wrench += value.slope * at.load[self.reactions().start + row];
            }
            let p = G::point_to_spatial(at.point(self.ties[tie].points[1]));
            out.fill(0.0);
            for (k, mode) in G::AXES.into_iter().enumerate() {
                out[if mode.is_angular() { 3 + mode.index() } else { mode.index() - 3 }] = wrench[k];
            }
            // From the moment about the origin.
            let f = [out[0], out[1], out[2]];
            let about = [p[1] * f[2] - p[2] * f[1], p[2] * f[0] - p[0] * f[2], p[0] * f[1] - p[1] * f[0]];
            out[3..6].iter_mut().zip(about).for_each(|(m, a)| *m -= a);
            out[6] = self.ties[tie].drive.as_ref().map_or(0.0, |d| at.load[self.reactions().start + d.row]);
        }
    }
}

/// Numbers of [`Ties::loads`] for each tie.
pub(crate) const TIE_NUMBERS: usize = 7;

/// Derivative by the world twist of the product of `fixed` with a direction that turns.
fn moment_of<G: LieGroup<D, P>, const D: usize, const P: usize>(
    turning: &Vector<P>,
    fixed: &Vector<P>,
) -> Vector<D> {
    (G::point_jacobian(turning) - G::point_jacobian(&Vector::ZERO)).transpose_times(fixed)
}

/// The rate of a direction that turns with a frame of this world twist.
fn turned_by<G: LieGroup<D, P>, const D: usize, const P: usize>(
    direction: &Vector<P>,
    twist: &Vector<D>,
) -> Vector<P> {
    (G::point_jacobian(direction) - G::point_jacobian(&Vector::ZERO)) * *twist
}

/// The twist with these components by strain mode.
fn of_modes<G: LieGroup<D, P>, const D: usize, const P: usize>(modes: &[f64; 6]) -> Vector<D> {
    let mut twist = Vector::ZERO;
    for (k, mode) in G::AXES.into_iter().enumerate() {
        twist[k] = modes[mode.index()];
    }
    twist
}

/// The twist from the closed target, after a part of closing.
fn opening<G: LieGroup<D, P>, const D: usize, const P: usize>(
    ends: &[[f64; 6]; 2],
    progress: f64,
) -> Vector<D> {
    let [from, to] = ends.map(|modes| of_modes::<G, D, P>(&modes));
    from * (1.0 - progress) + to * progress
}
