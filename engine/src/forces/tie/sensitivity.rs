//! How ties change with the parameters: through frames and points, and through the reference state.

use super::super::differential::Differential;
use super::super::element::Velocities;
use super::super::state::State;
use super::{Condition, TieDesign, Ties, moment_of, turned_by};
use crate::lie::LieGroup;
use crate::linalg::Vector;

/// A number that a tie gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TieOutput {
    /// The magnitude of the force.
    Force,
    /// The magnitude of the moment about the second place.
    Moment,
    /// The force or moment that drives it.
    Drive,
}

impl TieOutput {
    pub const ALL: [TieOutput; 3] = [TieOutput::Force, TieOutput::Moment, TieOutput::Drive];
}

/// What a parameter changes, besides frames and points.
#[derive(Clone, Debug)]
pub(crate) struct ReferenceRates<const P: usize> {
    turned: Vec<Vector<P>>,
    shift: Vec<f64>,
}

impl<const P: usize> Ties<P> {
    /// Rates of what is taken from the reference state, given that and the velocities there.
    pub fn reference_rates<G: LieGroup<D, P>, const D: usize>(
        &self,
        reference: &State<G, D, P>,
        velocities: &Velocities<D, P>,
    ) -> ReferenceRates<P> {
        let pose = |frame: usize| reference.kinematics.pose[frame];
        let turned = self.rows.iter().map(|row| {
            let Condition::About { turned, .. } = &row.condition else { return Vector::ZERO };
            let [a, b] = self.ties[row.tie].points.map(|point| reference.frame(point));
            let twist = velocities.twists[a] - velocities.twists[b];
            pose(b).inverse().rotate(&turned_by::<G, D, P>(&pose(a).rotate(turned), &twist))
        });
        let shift = self.ties.iter().map(|tie| {
            let [a, b] = tie.points;
            let Some(axis) = tie.along.map(|axis| pose(reference.frame(a)).rotate(&axis)) else { return 0.0 };
            let turned = turned_by::<G, D, P>(&axis, &velocities.twists[reference.frame(a)]);
            let apart = *reference.point(b) - *reference.point(a);
            turned.dot(&apart) + axis.dot(&(velocities.points[b] - velocities.points[a]))
        });
        ReferenceRates { turned: turned.collect(), shift: shift.collect() }
    }

    /// Σ ν ċ as a parameter changes, the coordinates held, and the change of the work of the reactions on a
    /// virtual motion that is due to the reference state.
    pub fn parameter_work<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        design: &TieDesign<P>,
        twists: &[Vector<D>],
        weights: &[f64],
        (velocities, rates): (&Velocities<D, P>, &ReferenceRates<P>),
    ) -> f64 {
        let mut work = 0.0;
        for (index, tie) in self.ties.iter().enumerate() {
            let target = self.target(at, design, index);
            let [first, second] = tie.points;
            let [a, b] = tie.points.map(|point| at.frame(point));
            let carried = |direction: &Vector<P>| turned_by::<G, D, P>(direction, &velocities.twists[a]);
            for row in tie.rows.clone() {
                let change = match &self.rows[row].condition {
                    Condition::Along(direction) => {
                        let direction = target.rotate(direction);
                        let from_first = target.position() - *at.point(first);
                        let along = tie.along.map(|axis| at.kinematics.pose[a].rotate(&axis));
                        let shift = along.map_or(Vector::ZERO, |axis| axis * rates.shift[index]);
                        let moved = velocities.points[first] + carried(&from_first) + shift;
                        carried(&direction).dot(&(*at.point(second) - target.position()))
                            + direction.dot(&(velocities.points[second] - moved))
                    }
                    Condition::About { fixed, .. } => {
                        let fixed = target.rotate(fixed);
                        let pose = at.kinematics.pose[b];
                        let turning = pose.rotate(&design.turned[row]);
                        let slid = pose.rotate(&rates.turned[row]);
                        let relative = twists[b] - twists[a];
                        let reaction = at.load[self.reactions().start + row];
                        work -= reaction * moment_of::<G, D, P>(&slid, &fixed).dot(&relative);
                        let rate = turned_by::<G, D, P>(&turning, &velocities.twists[b]) + slid;
                        carried(&fixed).dot(&turning) + fixed.dot(&rate)
                    }
                };
                work += weights[row] * change;
            }
        }
        work
    }

    /// Adds a multiple of the change of an output. The directions of the reactions of a closed tie are
    /// orthonormal.
    pub fn add_output<const D: usize>(
        &self,
        tie: usize,
        output: TieOutput,
        load: &[f64],
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        let reactions = &load[self.reactions()];
        if output == TieOutput::Drive {
            if let Some(drive) = &self.ties[tie].drive {
                out.reactions[drive.row] += weight;
            }
            return;
        }
        let moment = output == TieOutput::Moment;
        let rows = || self.ties[tie].rows.clone().filter(|row| self.row(*row).1 == moment);
        let size = rows().map(|row| reactions[row].powi(2)).sum::<f64>().sqrt();
        if size == 0.0 {
            // It has a corner there.
            out.tied |= rows().next().is_some();
            return;
        }
        rows().for_each(|row| out.reactions[row] += weight * reactions[row] / size);
    }
}
