//! The forces of ties, given their reactions and penalties.

use super::super::element::{ForceElement, ForceMemory, Velocities, VirtualMotion};
use super::super::magnitudes::Magnitudes;
use super::super::state::State;
use super::super::terms::{Coupling, Terms};
use super::{Condition, TieDesign, Ties, Value, moment_of, turned_by};
use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};
use crate::tree::Tree;

impl<const P: usize> Ties<P> {
    /// Reaction and penalty of a condition.
    fn law(&self, load: &[f64], row: usize) -> [f64; 2] {
        [load[self.reactions().start + row], load[self.penalties().start + row]]
    }

    /// The force of a condition along its slope.
    fn force<const D: usize>(&self, load: &[f64], row: usize, value: &Value<D>) -> f64 {
        let [reaction, penalty] = self.law(load, row);
        reaction - penalty * value.value
    }
}

impl<const P: usize> ForceMemory<P> for Ties<P> {
    type Design = TieDesign<P>;
    type State = ();
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Ties<P> {
    fn design(&self, _: &Tree<G, D, P>) -> TieDesign<P> {
        TieDesign {
            turned: vec![Vector::ZERO; self.rows.len()],
            shift: vec![0.0; self.ties.len()],
            openings: vec![[[0.0; 6]; 2]; self.ties.len()],
        }
    }

    fn state(&self, _: &Tree<G, D, P>) {}

    fn update_design(&self, tree: &Tree<G, D, P>, geometry: &Geometry<G, D, P>, design: &mut TieDesign<P>) {
        if !self.ties.is_empty() {
            self.update_reference(tree, geometry, design);
            self.close(design);
        }
    }

    fn max_couplings(&self) -> usize {
        self.ties.len()
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        design: &TieDesign<P>,
        _: &mut (),
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        for (index, tie) in self.ties.iter().enumerate() {
            let [a, b] = tie.points.map(|point| at.frame(point));
            for (row, value) in self.values(at, design, index) {
                let [reaction, penalty] = self.law(at.load, row);
                out.energy += (0.5 * penalty * value.value - reaction) * value.value;
                let wrench = value.slope * self.force(at.load, row, &value);
                out.wrench[a] += wrench;
                out.wrench[b] -= wrench;
            }
            (out.loaded[a], out.loaded[b]) = (true, true);
        }
    }

    fn add_tangent(
        &self,
        at: &State<G, D, P>,
        design: &TieDesign<P>,
        _: &(),
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        for (index, tie) in self.ties.iter().enumerate() {
            let [a, b] = tie.points.map(|point| at.frame(point));
            let (mut own, mut form) = (Matrix::ZERO, Matrix::ZERO);
            for (row, value) in self.values(at, design, index) {
                let force = self.force(at.load, row, &value);
                let stiff = value.slope.outer(&value.slope) * self.law(at.load, row)[1];
                own += stiff - value.curvature * force;
                form += (value.curvature + G::bracket_form(&value.slope) * 0.5) * force - stiff;
            }
            out.stiffness[a] += own;
            out.stiffness[b] += own;
            out.couplings.push(Coupling { row: a, column: b, form });
        }
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, design: &TieDesign<P>, _: &(), out: &mut Magnitudes<P>) {
        for (index, tie) in self.ties.iter().enumerate() {
            for (row, value) in self.values(at, design, index) {
                let force = self.force(at.load, row, &value);
                for point in tie.points {
                    match self.rows[row].condition {
                        Condition::Along(_) => out.add_at_point(at, point, force),
                        Condition::About { .. } => out.add_moment(at.frame(point), force),
                    }
                }
            }
        }
    }

    fn add_load_derivative(
        &self,
        at: &State<G, D, P>,
        design: &TieDesign<P>,
        change: &[f64],
        out: &mut [f64],
        project: &impl Fn(usize, &Vector<D>, &mut [f64]),
    ) {
        for (index, tie) in self.ties.iter().enumerate() {
            let rate = self.target_rate(at, design, index, change);
            if rate == Vector::ZERO {
                continue;
            }
            let [a, b] = tie.points.map(|point| at.frame(point));
            for (row, value) in self.values(at, design, index) {
                let [_, penalty] = self.law(at.load, row);
                let turned = (G::bracket_form(&value.slope) * 0.5 - value.curvature) * rate;
                let change = turned * self.force(at.load, row, &value)
                    + value.slope * (penalty * value.slope.dot(&rate));
                project(b, &-change, out);
                project(a, &change, out);
            }
        }
    }

    /// Parameters act through frames, points and the reference state; for the last see
    /// [`Ties::add_reference_work`].
    fn add_parameter_work(
        &self,
        _: &State<G, D, P>,
        _: &TieDesign<P>,
        _: &(),
        _: &(),
        _: &VirtualMotion<D, P>,
        _: &mut [f64],
    ) {
    }

    fn add_geometric_work(
        &self,
        at: &State<G, D, P>,
        design: &TieDesign<P>,
        _: &(),
        motion: &VirtualMotion<D, P>,
        velocities: &Velocities<D, P>,
        work: &mut f64,
    ) {
        for (index, tie) in self.ties.iter().enumerate() {
            let [a, b] = tie.points.map(|point| at.frame(point));
            let relative = motion.velocities.twists[b] - motion.velocities.twists[a];
            let target = self.target(at, design, index);
            let p = at.point(tie.points[1]);
            for (row, value) in self.values(at, design, index) {
                let change = match &self.rows[row].condition {
                    Condition::Along(direction) => {
                        let direction = target.rotate(direction);
                        let turned = turned_by::<G, D, P>(&direction, &velocities.twists[a]);
                        moment_of::<G, D, P>(&velocities.points[tie.points[1]], &direction)
                            + G::point_jacobian(p).transpose_times(&turned)
                    }
                    Condition::About { fixed, .. } => {
                        let fixed = target.rotate(fixed);
                        let turning = at.kinematics.pose[b].rotate(&design.turned[row]);
                        let [fixed_rate, turning_rate] = [
                            turned_by::<G, D, P>(&fixed, &velocities.twists[a]),
                            turned_by::<G, D, P>(&turning, &velocities.twists[b]),
                        ];
                        moment_of::<G, D, P>(&turning_rate, &fixed)
                            + moment_of::<G, D, P>(&turning, &fixed_rate)
                    }
                };
                *work -= self.force(at.load, row, &value) * change.dot(&relative);
            }
        }
    }
}
