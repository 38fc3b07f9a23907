//! Friction in the workspace of one thread.

use crate::data::Data;
use crate::forces::element::Velocities;
use crate::forces::friction::{
    Direction, FrictionForce, FrictionMemory, FrictionSlopes, Frictions, PointAdjoint, PointChange,
    PointSlope, PressedChange,
};
use crate::forces::state::State;
use crate::lie::LieGroup;
use crate::linalg::{LANES, Vector};
use crate::model::Model;
use crate::results::PathFriction;

/// Gap below which bodies rest on each other, relative to the largest radius.
const RESTING: f64 = 1e-6;

/// Workspace of the tangent of a step in which friction is renewed.
#[derive(Clone, Debug)]
pub(crate) struct RenewalWork<const D: usize, const P: usize> {
    rates: Vec<f64>,
    blocks: Vec<Vector<LANES>>,
    twists: Vec<Vector<D>>,
    points: Vec<Vector<P>>,
    pressed: Vec<PressedChange<P>>,
    wrench: Vec<Vector<D>>,
    column: Vec<f64>,
}

impl<const D: usize, const P: usize> RenewalWork<D, P> {
    pub fn new<G: LieGroup<D, P>>(model: &Model<G, D, P>) -> Self {
        Self {
            rates: vec![0.0; model.dof],
            blocks: model.coordinate_blocks.zeros(),
            twists: vec![Vector::ZERO; model.frames.len()],
            points: vec![Vector::ZERO; model.points.len()],
            pressed: vec![],
            wrench: vec![Vector::ZERO; model.frames.len()],
            column: vec![0.0; model.dof],
        }
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Data<G, D, P> {
    /// What friction remembers of a path.
    pub(crate) fn friction_memory(&self) -> &FrictionMemory<P> {
        &self.assembly.forces.frictions
    }

    /// Replaces what friction remembers.
    pub(crate) fn recall_friction(&mut self, memory: FrictionMemory<P>) {
        self.assembly.forces.frictions = memory;
    }

    /// The state evaluated last, without coordinates and load, and what friction remembers.
    fn with_friction<R>(
        &mut self,
        model: &Model<G, D, P>,
        change: impl FnOnce(&Frictions, &State<G, D, P>, &mut FrictionMemory<P>) -> R,
    ) -> R {
        let Self { design, kinematics, assembly, law, .. } = self;
        let (tree, geometry) = (&model.tree, &design.geometry);
        let at = State { tree, geometry, kinematics, q: &[], load: &[], law: *law };
        change(&model.forces.frictions, &at, &mut assembly.forces.frictions)
    }

    /// Renews what friction holds in a step in the state evaluated last.
    pub(crate) fn renew_friction(&mut self, model: &Model<G, D, P>) {
        self.renew_friction_within(model, 0.0);
    }

    fn renew_friction_within(&mut self, model: &Model<G, D, P>, margin: f64) {
        let Self { design, kinematics, assembly, law, .. } = self;
        let (tree, geometry) = (&model.tree, &design.geometry);
        let at = State { tree, geometry, kinematics, q: &[], load: &[], law: *law };
        model.forces.renew_friction(&at, &mut assembly.forces, margin);
    }

    /// Lets all points at which bodies press or rest on each other in the state evaluated last stick until they
    /// are renewed.
    pub(crate) fn stick(&mut self, model: &Model<G, D, P>) {
        let largest = self.design.geometry.radii.iter().copied().fold(0.0, f64::max);
        self.renew_friction_within(model, RESTING * largest);
        self.with_friction(model, |frictions, _, memory| frictions.stick(memory));
    }

    /// Ends a step with friction in the state evaluated last: gives up the slip beyond the limit.
    pub(crate) fn end_friction_step(&mut self, model: &Model<G, D, P>, excess: f64) {
        self.with_friction(model, |frictions, at, memory| frictions.end_step(at, memory, excess));
    }

    /// Lets a step begin in the state evaluated last, in which friction was renewed, with these slips of points
    /// that touch; the others have not slipped.
    pub(crate) fn begin_friction_step(&mut self, model: &Model<G, D, P>, slips: &[PathFriction]) {
        self.with_friction(model, |frictions, at, memory| {
            for given in slips {
                if let Some(slip) = G::point_from_spatial(&given.slip) {
                    frictions.set_slip(at, memory, [given.friction, given.sphere, given.other], slip);
                }
            }
            frictions.begin_step(at, memory);
        });
    }

    /// Adds to the complete tangent, at a state with complete columns in which friction was renewed, what it lacks
    /// as the derivative of the residual with friction renewed in each state.
    pub(crate) fn add_renewal(&mut self, model: &Model<G, D, P>, work: &mut RenewalWork<D, P>) {
        let n = model.dof;
        for j in 0..n {
            work.rates.fill(0.0);
            work.rates[j] = 1.0;
            model.coordinate_blocks.gather(&work.rates, &mut work.blocks);
            self.velocities(model, &work.blocks, &mut work.twists, &mut work.points);
            let velocities = Velocities { twists: &work.twists, points: &work.points };
            let direction = Direction { velocities, parameter: None };
            let at = self.state(model, &[], &[]);
            model.forces.pressed_changes(&at, &self.assembly.forces, &direction, &mut work.pressed);
            work.wrench.fill(Vector::ZERO);
            let memory = &self.assembly.forces.frictions;
            model.forces.frictions.add_renewal(&at, memory, &velocities, &work.pressed, &mut work.wrench);
            work.column.fill(0.0);
            self.assembly.add_forces(model, &mut work.wrench, &mut work.column);
            for (row, change) in self.assembly.tangent.chunks_mut(n).zip(&work.column) {
                row[j] += change;
            }
        }
    }

    /// Whether points that pressed as the step began do not any more.
    pub(crate) fn has_opened(&self) -> bool {
        self.assembly.forces.frictions.has_opened()
    }

    /// Friction in the state evaluated last, as of the path that led there.
    pub fn friction_forces(&self, model: &Model<G, D, P>) -> Vec<FrictionForce<P>> {
        model.forces.frictions.forces(&self.state(model, &[], &[]), &self.assembly.forces.frictions)
    }

    /// Energy that friction dissipated along the path up to the state evaluated last [J].
    pub fn dissipated(&self, model: &Model<G, D, P>) -> f64 {
        model.forces.frictions.dissipated(&self.state(model, &[], &[]), &self.assembly.forces.frictions)
    }

    /// The part of the energy that friction dissipates as the step ends in the state evaluated last [J].
    pub(crate) fn dissipation(&self, model: &Model<G, D, P>) -> f64 {
        model.forces.frictions.dissipation(&self.state(model, &[], &[]), &self.assembly.forces.frictions)
    }

    /// How points with friction change in a direction, in the state in which it was renewed, evaluated last.
    pub(crate) fn friction_slope(
        &self,
        model: &Model<G, D, P>,
        direction: &Direction<D, P>,
    ) -> Vec<PointSlope<P>> {
        let (at, forces) = (self.state(model, &[], &[]), &self.assembly.forces);
        let mut pressed = vec![];
        model.forces.pressed_changes(&at, forces, direction, &mut pressed);
        model.forces.frictions.slopes(&at, &forces.frictions, direction, &pressed)
    }

    /// How they change with what they began the step with.
    pub(crate) fn friction_slopes_by_start(&self, model: &Model<G, D, P>) -> Vec<Vec<PointChange<P>>> {
        let at = self.state(model, &[], &[]);
        model.forces.frictions.slopes_by_start(&at, &self.assembly.forces.frictions)
    }

    /// Adds to a number's derivatives by parameters those through friction: by what points have at the end of the
    /// step, and by their forces, on a virtual motion.
    pub(crate) fn add_friction_slopes(
        &self,
        model: &Model<G, D, P>,
        slopes: &FrictionSlopes<P>,
        points: &[PointAdjoint<P>],
        motion: &Velocities<D, P>,
        out: &mut [f64],
    ) {
        let (at, memory) = (self.state(model, &[], &[]), &self.assembly.forces.frictions);
        Frictions::add_slopes(&at, memory, &slopes.by_parameters, points, motion, out);
    }

    /// The derivatives by what points had at the end of the step before; those by the place of frames there are
    /// appended as wrenches.
    pub(crate) fn pass_friction_on(
        &self,
        slopes: &FrictionSlopes<P>,
        (points, motion): (&[PointAdjoint<P>], &Velocities<D, P>),
        frames: &mut Vec<(usize, Vector<D>)>,
    ) -> Vec<PointAdjoint<P>> {
        Frictions::pass_on::<G, D, P>(&self.assembly.forces.frictions, slopes, points, motion, frames)
    }

    /// Whether some point is at its limit.
    pub(crate) fn is_about_to_slide(&self, model: &Model<G, D, P>) -> bool {
        Frictions::is_about_to_slide(&self.state(model, &[], &[]), &self.assembly.forces.frictions)
    }

    /// Whether a step began in the state evaluated last.
    pub(crate) fn begins_here(&self, model: &Model<G, D, P>, memory: &FrictionMemory<P>) -> bool {
        Frictions::begins_at(&self.state(model, &[], &[]), memory)
    }
}
