//! Friction in the workspace of one thread.

use crate::data::Data;
use crate::forces::element::Velocities;
use crate::forces::friction::{
    Direction, FrictionForce, FrictionMemory, FrictionSlopes, Frictions, PointAdjoint, PointChange,
    PointSlope, PressedChange,
};
use crate::forces::state::State;
use crate::forces::tendon::{GuideChange, GuideMemory, GuideSlopes};
use crate::lie::LieGroup;
use crate::linalg::{LANES, Vector};
use crate::model::Model;
use crate::results::PathFriction;

/// Gap below which bodies rest on each other, relative to the largest radius.
const RESTING: f64 = 1e-6;

/// What friction remembers of a path: at contacts, and in the guides of tendons.
#[derive(Clone, Debug, Default)]
pub(crate) struct PathMemory<const P: usize> {
    contacts: FrictionMemory<P>,
    guides: GuideMemory<P>,
}

/// Workspace of the tangent of a step in which friction is renewed.
#[derive(Clone, Debug)]
pub(crate) struct RenewalWork<const D: usize, const P: usize> {
    rates: Vec<f64>,
    blocks: Vec<Vector<LANES>>,
    twists: Vec<Vector<D>>,
    points: Vec<Vector<P>>,
    pressed: Vec<PressedChange<P>>,
    guides: Vec<f64>,
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
            guides: vec![],
            wrench: vec![Vector::ZERO; model.frames.len()],
            column: vec![0.0; model.dof],
        }
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Data<G, D, P> {
    /// What friction remembers of a path.
    pub(crate) fn friction_memory(&self) -> PathMemory<P> {
        let forces = &self.assembly.forces;
        PathMemory { contacts: forces.frictions.clone(), guides: forces.tendons.clone() }
    }

    /// Replaces what friction remembers.
    pub(crate) fn recall_friction(&mut self, memory: PathMemory<P>) {
        let forces = &mut self.assembly.forces;
        (forces.frictions, forces.tendons) = (memory.contacts, memory.guides);
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
        model.forces.tendons.renew_guides(&at, &mut assembly.forces.tendons);
    }

    /// Lets all points at which bodies press or rest on each other in the state evaluated last, and tendons in their
    /// guides, stick until they are renewed.
    pub(crate) fn stick(&mut self, model: &Model<G, D, P>) {
        let largest = self.design.geometry.radii.iter().copied().fold(0.0, f64::max);
        self.renew_friction_within(model, RESTING * largest);
        self.with_friction(model, |frictions, _, memory| frictions.stick(memory));
        self.assembly.forces.tendons.stick();
    }

    /// Ends a step with friction in the state evaluated last: gives up the slip beyond the limit.
    pub(crate) fn end_friction_step(&mut self, model: &Model<G, D, P>, excess: f64) {
        self.with_friction(model, |frictions, at, memory| frictions.end_step(at, memory, excess));
        self.assembly.forces.tendons.end_step(&model.forces.tendons, excess);
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
        let (tendons, memory) = (&model.forces.tendons, &mut self.assembly.forces.tendons);
        let contacts = model.forces.frictions.count();
        for given in slips.iter().filter(|given| given.friction >= contacts) {
            if let Some(slip) = G::point_from_spatial(&given.slip) {
                tendons.set_guide_slip(memory, [given.friction - contacts, given.sphere], &slip);
            }
        }
        memory.begin_step(tendons);
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
            let memory = &self.assembly.forces.tendons;
            model.forces.tendons.add_guide_renewal(
                &at,
                memory,
                &velocities,
                &mut work.guides,
                &mut work.wrench,
            );
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
        let (at, forces) = (self.state(model, &[], &[]), &self.assembly.forces);
        let mut found = model.forces.frictions.forces(&at, &forces.frictions);
        let from = model.forces.frictions.count();
        found.extend(model.forces.tendons.guide_forces(&at, &forces.tendons, from));
        found
    }

    /// Energy that friction dissipated along the path up to the state evaluated last [J].
    pub fn dissipated(&self, model: &Model<G, D, P>) -> f64 {
        let (at, forces) = (self.state(model, &[], &[]), &self.assembly.forces);
        let contacts = model.forces.frictions.dissipated(&at, &forces.frictions);
        contacts + forces.tendons.dissipated(&model.forces.tendons)
    }

    /// The part of the energy that friction dissipates as the step ends in the state evaluated last [J].
    pub(crate) fn dissipation(&self, model: &Model<G, D, P>) -> f64 {
        let (at, forces) = (self.state(model, &[], &[]), &self.assembly.forces);
        let contacts = model.forces.frictions.dissipation(&at, &forces.frictions);
        contacts + forces.tendons.dissipation(&model.forces.tendons)
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
        let (at, forces) = (self.state(model, &[], &[]), &self.assembly.forces);
        Frictions::is_about_to_slide(&at, &forces.frictions)
            || forces.tendons.is_about_to_slide(&model.forces.tendons)
    }

    /// Whether a step began in the state evaluated last.
    pub(crate) fn begins_here(&self, model: &Model<G, D, P>, memory: &PathMemory<P>) -> bool {
        Frictions::begins_at(&self.state(model, &[], &[]), &memory.contacts)
    }

    /// How the forces at guides change, as points move and as something else changes.
    pub(crate) fn guide_slope(
        &self,
        model: &Model<G, D, P>,
        velocities: Option<&Velocities<D, P>>,
        change: GuideChange,
        load: &[f64],
    ) -> Vec<f64> {
        let mut out = vec![];
        let (at, memory) = (self.state(model, &[], load), &self.assembly.forces.tendons);
        model.forces.tendons.guide_changes(&at, memory, velocities, change, &mut out);
        out
    }

    /// Passes the derivatives of a number by what guides have at the end of a step on to the step before, and adds those
    /// by parameters and loads through their forces on a virtual motion.
    pub(crate) fn pass_guides_on(
        &self,
        model: &Model<G, D, P>,
        slopes: &GuideSlopes,
        by_slip: &[f64],
        motion: &Velocities<D, P>,
        (by_parameters, by_loads): (&mut [f64], &mut [f64]),
    ) -> Vec<f64> {
        let (tendons, memory) = (&model.forces.tendons, &self.assembly.forces.tendons);
        let mut weights = vec![];
        tendons.guide_rates(memory, motion, &mut weights);
        weights.iter_mut().for_each(|rate| *rate = -*rate);
        weights.iter_mut().zip(self.by_guide_force(model, by_slip)).for_each(|(weight, own)| *weight += own);
        let sum = |changes: &[f64]| changes.iter().zip(&weights).map(|(a, b)| a * b).sum::<f64>();
        by_parameters.iter_mut().zip(&slopes.by_parameters).for_each(|(out, changes)| *out += sum(changes));
        by_loads.iter_mut().zip(&slopes.by_loads).for_each(|(out, changes)| *out += sum(changes));
        slopes.by_start.iter().map(|changes| sum(changes)).collect()
    }

    /// Adds the derivatives by each coordinate of what guides have at the end of the step.
    pub(crate) fn add_guides_by_coordinates(
        &self,
        model: &Model<G, D, P>,
        slopes: &GuideSlopes,
        by_slip: &[f64],
        out: &mut [f64],
    ) {
        let weights = self.by_guide_force(model, by_slip);
        for (out, changes) in out.iter_mut().zip(&slopes.by_coordinates) {
            *out += changes.iter().zip(&weights).map(|(a, b)| a * b).sum::<f64>();
        }
    }

    /// Derivatives by the forces at guides, from those by the slips at the end of the step.
    fn by_guide_force(&self, model: &Model<G, D, P>, by_slip: &[f64]) -> Vec<f64> {
        let mut weights = by_slip.to_vec();
        model.forces.tendons.by_guide_stiffness(&mut weights);
        weights
    }

    /// Adds the slopes by points of what the next step begins with: of the length beyond each guide.
    pub(crate) fn add_guide_lengths(
        &self,
        model: &Model<G, D, P>,
        by_start: &[f64],
        points: &mut Vec<(usize, Vector<P>)>,
    ) {
        let less: Vec<f64> = by_start.iter().map(|slope| -slope).collect();
        model.forces.tendons.add_guide_lengths(&self.assembly.forces.tendons, &less, points);
    }
}
