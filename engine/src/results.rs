//! Results of paths, collected step by step into arrays.

use crate::equilibrium::{Event, EventKind, Stability, Status, StepReport, System};
use crate::forces::friction::FrictionForce;
use crate::forces::tie::TIE_NUMBERS;
use crate::lie::LieGroup;
use crate::model::Model;

/// Results of the steps of one or several designs: row-major arrays over (design, step).
///
/// Missing states, energies and depths of centrelines are NaN, missing contacts zero; the status gives the reason.
#[derive(Clone, Debug, Default)]
pub struct PathResults {
    /// States, `dof` numbers per step.
    pub q: Vec<f64>,
    /// Status codes.
    pub status: Vec<u8>,
    /// [`Stability`] codes.
    pub stability: Vec<u8>,
    /// Iterations used.
    pub iterations: Vec<u32>,
    /// Largest residuals, as fractions of the forces that are their units.
    pub residual: Vec<f64>,
    /// Their bounds: the tolerance plus the rounding of the terms that balance.
    pub tolerance: Vec<f64>,
    /// Π [J], without the work of controlled inputs.
    pub energy: Vec<f64>,
    /// Touching sphere pairs.
    pub pairs: Vec<u32>,
    /// Spheres of first groups that touch.
    pub touching: Vec<u32>,
    /// Resultant contact force on the tip [N].
    pub tip_force: Vec<f64>,
    /// Load of each input, as found for one that is controlled by its conjugate.
    pub applied: Vec<f64>,
    /// Largest overlap of a contact [m].
    pub overlap: Vec<f64>,
    /// How deep the centreline of a rod is at most in what it touches [m].
    pub centreline: Vec<f64>,
    /// Largest pressure on an elastic foundation [Pa].
    pub pressure: Vec<f64>,
    /// Volume of each pressurised cavity [m³].
    pub volume: Vec<f64>,
    /// Least and greatest stretch of the fibres of each material.
    pub stretch: Vec<f64>,
    /// Angle between both ends of each rod.
    pub rod_bending: Vec<f64>,
    /// Tension of each spring [N].
    pub spring_tension: Vec<f64>,
    /// Tension of each strap around a link [N].
    pub loop_tension: Vec<f64>,
    /// Sum of the normal forces on each obstacle [N].
    pub obstacle_force: Vec<f64>,
    /// What each tie does to its second place, seven numbers: force [N] and moment about the place [N·m] in
    /// the world, and the force or moment that drives it.
    pub ties: Vec<f64>,
    /// How far each tie is from being closed: a distance [m] and an angle [rad].
    pub tie_gaps: Vec<f64>,
    /// Number of redundant conditions of each tie.
    pub tie_redundancy: Vec<f64>,
    /// In a singular configuration, the share of each tie in what becomes dependent.
    pub tie_singularity: Vec<f64>,
    /// Energy that friction dissipated along the path [J].
    pub dissipated: Vec<f64>,
    /// Points with friction of all designs and steps, in order.
    pub frictions: Vec<PathFriction>,
    /// (design, step, coordinate) of free motions, in order.
    pub free: Vec<[usize; 3]>,
    /// Events of all designs, in order.
    pub events: Vec<PathEvent>,
}

/// A point with friction in one step of a design; vectors are in space.
#[derive(Clone, Copy, Debug)]
pub struct PathFriction {
    /// Index of the design.
    pub design: usize,
    /// Index of the load step.
    pub step: usize,
    /// Index of the friction in the model's description.
    pub friction: usize,
    /// The sphere of the first body.
    pub sphere: usize,
    /// What it rubs on: a body, or a surface of an obstacle.
    pub other: usize,
    /// Where [m].
    pub place: [f64; 3],
    /// Force on the first body [N].
    pub force: [f64; 3],
    /// Largest size of the force, μN [N].
    pub limit: f64,
    /// Elastic slip [m].
    pub slip: [f64; 3],
    /// Whether it slid in this step.
    pub slides: bool,
}

/// An event of one design.
#[derive(Clone, Debug)]
pub struct PathEvent {
    /// Index of the design.
    pub design: usize,
    /// Index of the load step being approached.
    pub step: usize,
    /// What happened.
    pub kind: EventKind,
    /// Load at which it happened.
    pub load: Vec<f64>,
    /// State before.
    pub before: Vec<f64>,
    /// State after.
    pub after: Vec<f64>,
}

impl PathResults {
    /// Appends a step of a design.
    pub(crate) fn push<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        [design, step]: [usize; 2],
        report: &StepReport,
        system: &System<G, D, P>,
    ) {
        let (model, data) = (system.model(), system.data());
        let row = self.status.len();
        self.push_missing(model, report.status, 1);
        self.stability[row] = report.stability as u8;
        self.iterations[row] = report.iterations as u32;
        self.free.extend(report.free.iter().map(|coordinate| [design, step, *coordinate]));
        let found = report.status.is_equilibrium();
        if found || report.status == Status::Stalled {
            self.residual[row] = report.accuracy.residual;
            self.tolerance[row] = report.accuracy.tolerance;
        }
        if report.status == Status::Singular {
            system.singular_shares(last(&mut self.tie_singularity, model.tie_count()));
        }
        if let Some(reached) = report.reached {
            last(&mut self.applied, reached.len()).copy_from_slice(reached);
        }
        if found || matches!(report.status, Status::NotClosed | Status::Stalled) {
            data.tie_gaps(model, last(&mut self.tie_gaps, 2 * model.tie_count()));
        }
        if !found {
            return;
        }
        if model.friction_count() > 0 {
            self.dissipated[row] = data.dissipated(model);
            self.frictions.extend(data.friction_forces(model).into_iter().map(|at| {
                let FrictionForce { friction, sphere, other, limit, slides, .. } = at;
                let [place, force, slip] = [at.place, at.force, at.slip].map(|v| G::point_to_spatial(&v));
                PathFriction { design, step, friction, sphere, other, place, force, limit, slip, slides }
            }));
        }
        let contact = data.contact_summary(model);
        self.energy[row] = data.potential(model);
        self.pairs[row] = contact.pairs;
        self.touching[row] = contact.touching;
        self.tip_force[row] = contact.tip_force;
        self.overlap[row] = contact.overlap;
        self.centreline[row] = contact.centreline.unwrap_or(f64::NAN);
        self.pressure[row] = contact.pressure;
        last(&mut self.q, report.q.len()).copy_from_slice(report.q);
        let applied = system.applied_load();
        last(&mut self.applied, applied.len()).copy_from_slice(applied);
        data.volumes(model, report.q, last(&mut self.volume, model.pressure_count()));
        data.rod_bending(model, last(&mut self.rod_bending, model.rods.len()));
        data.stretches(model, report.q, last(&mut self.stretch, 2 * model.material_count()));
        data.spring_tensions(model, last(&mut self.spring_tension, model.spring_count()));
        data.loop_tensions(model, last(&mut self.loop_tension, model.loop_count()));
        data.obstacle_forces(model, last(&mut self.obstacle_force, model.obstacle_count()));
        data.tie_loads(model, last(&mut self.ties, TIE_NUMBERS * model.tie_count()));
        system.count_redundant(last(&mut self.tie_redundancy, model.tie_count()));
    }

    /// Appends steps without equilibrium.
    pub(crate) fn push_missing<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        status: Status,
        steps: usize,
    ) {
        self.status.resize(self.status.len() + steps, status as u8);
        self.stability.resize(self.stability.len() + steps, Stability::Unknown as u8);
        for counts in [&mut self.iterations, &mut self.pairs, &mut self.touching] {
            counts.resize(counts.len() + steps, 0);
        }
        for zero in [&mut self.tip_force, &mut self.overlap, &mut self.pressure, &mut self.dissipated] {
            zero.resize(zero.len() + steps, 0.0);
        }
        for (values, width) in self.missing_as_nan(model) {
            values.resize(values.len() + steps * width, f64::NAN);
        }
    }

    /// Results with memory for so many steps.
    pub(crate) fn with_capacity<G: LieGroup<D, P>, const D: usize, const P: usize>(
        model: &Model<G, D, P>,
        steps: usize,
    ) -> Self {
        let mut results = Self::default();
        results.status.reserve_exact(steps);
        results.stability.reserve_exact(steps);
        for counts in [&mut results.iterations, &mut results.pairs, &mut results.touching] {
            counts.reserve_exact(steps);
        }
        let numbers =
            [&mut results.tip_force, &mut results.overlap, &mut results.pressure, &mut results.dissipated];
        for zero in numbers {
            zero.reserve_exact(steps);
        }
        for (values, width) in results.missing_as_nan(model) {
            values.reserve_exact(steps * width);
        }
        results
    }

    /// The arrays whose missing numbers are NaN, with the count of numbers per step.
    fn missing_as_nan<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
    ) -> [(&mut Vec<f64>, usize); 16] {
        [
            (&mut self.q, model.dof()),
            (&mut self.residual, 1),
            (&mut self.tolerance, 1),
            (&mut self.energy, 1),
            (&mut self.centreline, 1),
            (&mut self.applied, model.inputs().len()),
            (&mut self.volume, model.pressure_count()),
            (&mut self.rod_bending, model.rods.len()),
            (&mut self.stretch, 2 * model.material_count()),
            (&mut self.spring_tension, model.spring_count()),
            (&mut self.loop_tension, model.loop_count()),
            (&mut self.obstacle_force, model.obstacle_count()),
            (&mut self.ties, TIE_NUMBERS * model.tie_count()),
            (&mut self.tie_gaps, 2 * model.tie_count()),
            (&mut self.tie_redundancy, model.tie_count()),
            (&mut self.tie_singularity, model.tie_count()),
        ]
    }

    /// Appends an event of a design.
    pub(crate) fn push_event(&mut self, design: usize, event: &Event) {
        let (load, before, after) = (event.load.to_vec(), event.before.to_vec(), event.after.to_vec());
        self.events.push(PathEvent { design, step: event.step, kind: event.kind, load, before, after });
    }

    /// Appends the results of further designs.
    pub(crate) fn extend(&mut self, other: Self) {
        self.q.extend(other.q);
        self.status.extend(other.status);
        self.stability.extend(other.stability);
        self.iterations.extend(other.iterations);
        self.residual.extend(other.residual);
        self.tolerance.extend(other.tolerance);
        self.energy.extend(other.energy);
        self.pairs.extend(other.pairs);
        self.touching.extend(other.touching);
        self.tip_force.extend(other.tip_force);
        self.applied.extend(other.applied);
        self.overlap.extend(other.overlap);
        self.centreline.extend(other.centreline);
        self.pressure.extend(other.pressure);
        self.volume.extend(other.volume);
        self.rod_bending.extend(other.rod_bending);
        self.stretch.extend(other.stretch);
        self.spring_tension.extend(other.spring_tension);
        self.loop_tension.extend(other.loop_tension);
        self.obstacle_force.extend(other.obstacle_force);
        self.ties.extend(other.ties);
        self.tie_gaps.extend(other.tie_gaps);
        self.tie_redundancy.extend(other.tie_redundancy);
        self.tie_singularity.extend(other.tie_singularity);
        self.dissipated.extend(other.dissipated);
        self.frictions.extend(other.frictions);
        self.free.extend(other.free);
        self.events.extend(other.events);
    }
}

/// The last `count` numbers.
fn last(values: &mut [f64], count: usize) -> &mut [f64] {
    let start = values.len() - count;
    &mut values[start..]
}
