//! Many designs at once: one path per design, in parallel, with results independent of the thread count.

use crate::equilibrium::{
    Cancel, Continuation, ContinuationOptions, Event, EventKind, PathSink, Stability, Status, StepReport,
    System,
};
use crate::lie::LieGroup;
use crate::model::Model;
use crate::sensitivity::{Adjoint, Regularity};
use rayon::prelude::*;

/// Designs that differ in some parameters, all taken along the same loads.
#[derive(Clone, Copy, Debug)]
pub struct Batch<'a> {
    /// The parameters common to all designs.
    pub base: &'a [f64],
    /// Indices of the parameters that vary.
    pub varied: &'a [usize],
    /// Their values, one row of `varied.len()` per design.
    pub values: &'a [f64],
    /// Number of designs (also when nothing varies).
    pub designs: usize,
    /// Loads, one row of `model.inputs().len()` per step; the path starts at the first.
    pub loads: &'a [f64],
    /// Number of load steps.
    pub steps: usize,
    /// The state that every path starts from; the reference state unless given.
    pub start: Option<&'a [f64]>,
    /// Parameters with respect to which the last step is differentiated; none: no derivatives.
    pub gradient: &'a [usize],
    /// If requested during the solve, ends it soon; steps that were not solved have [`Status::Cancelled`].
    pub cancel: Option<&'a dyn Cancel>,
}

/// Designs that a thread solves one after another: few enough to balance, and enough to share one
/// workspace.
const CHUNK: usize = 16;

impl Batch<'_> {
    /// Whether more than the calling thread would work on it.
    pub fn is_parallel(&self, threads: usize) -> bool {
        threads != 1 && self.designs > CHUNK
    }
}

/// What a batch returns: row-major arrays over (design, step).
#[derive(Clone, Debug, Default)]
pub struct BatchResult {
    /// States, `dof` numbers per step.
    pub q: Vec<f64>,
    /// Status codes.
    pub status: Vec<u8>,
    /// Iterations used.
    pub iterations: Vec<u32>,
    /// Largest residuals, as fractions of the forces that are their units.
    pub residual: Vec<f64>,
    /// Their bounds: the tolerance plus the rounding of the terms that balance.
    pub tolerance: Vec<f64>,
    /// [`Stability`] codes.
    pub stability: Vec<u8>,
    /// Π [J].
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
    /// Largest pressure on an elastic foundation [Pa].
    pub pressure: Vec<f64>,
    /// Volume of each pressurised cavity [m³].
    pub volume: Vec<f64>,
    /// Least and greatest stretch of the fibres of each material.
    pub stretch: Vec<f64>,
    /// Derivatives at the last step: per design, a row for every joint coordinate and one for the
    /// tip force, over the parameters asked for; NaN where there is no equilibrium.
    pub gradient: Vec<f64>,
    /// Their validity: [`Regularity`] codes.
    pub regularity: Vec<u8>,
    /// Events of all designs, in order.
    pub events: Vec<BatchEvent>,
    /// (design, step, coordinate) of free motions, in order.
    pub free: Vec<[usize; 3]>,
}

/// An event of one design.
#[derive(Clone, Debug)]
pub struct BatchEvent {
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

/// The rows of one design.
struct Row<'a> {
    design: usize,
    dof: usize,
    q: &'a mut [f64],
    status: &'a mut [u8],
    iterations: &'a mut [u32],
    residual: &'a mut [f64],
    tolerance: &'a mut [f64],
    stability: &'a mut [u8],
    energy: &'a mut [f64],
    pairs: &'a mut [u32],
    touching: &'a mut [u32],
    tip_force: &'a mut [f64],
    applied: &'a mut [f64],
    overlap: &'a mut [f64],
    pressure: &'a mut [f64],
    volume: &'a mut [f64],
    stretch: &'a mut [f64],
    gradient: &'a mut [f64],
    regularity: &'a mut u8,
    events: Vec<BatchEvent>,
    free: Vec<[usize; 3]>,
}

/// Row, with the workspace of the contact summary.
struct RowSink<'a, 'b, G, const D: usize, const P: usize> {
    row: &'b mut Row<'a>,
    model: &'b Model<G, D, P>,
    /// Present when derivatives are asked for.
    adjoint: Option<&'b mut Adjoint<D, P>>,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> PathSink<G, D, P> for RowSink<'_, '_, G, D, P> {
    fn step(&mut self, index: usize, report: StepReport, system: &System<G, D, P>) {
        let row = &mut *self.row;
        row.status[index] = report.status as u8;
        row.stability[index] = report.stability as u8;
        let design = row.design;
        row.free.extend(report.free.iter().map(|coordinate| [design, index, *coordinate]));
        row.iterations[index] = report.iterations as u32;
        if report.status.is_equilibrium() || report.status == Status::Stalled {
            row.residual[index] = report.accuracy.residual;
            row.tolerance[index] = report.accuracy.tolerance;
        }
        if !report.status.is_equilibrium() {
            return;
        }
        row.q[index * row.dof..(index + 1) * row.dof].copy_from_slice(report.q);
        row.energy[index] = system.data().potential(self.model);
        let contact = system.data().contact_summary(self.model);
        row.pairs[index] = contact.pairs;
        row.touching[index] = contact.touching;
        row.tip_force[index] = contact.tip_force;
        let load = system.applied_load();
        row.applied[index * load.len()..(index + 1) * load.len()].copy_from_slice(load);
        row.overlap[index] = contact.overlap;
        row.pressure[index] = contact.pressure;
        let (volumes, materials) = (self.model.pressure_count(), 2 * self.model.material_count());
        system.data().volumes(self.model, report.q, &mut row.volume[index * volumes..][..volumes]);
        system.data().stretches(self.model, report.q, &mut row.stretch[index * materials..][..materials]);
        let last = index + 1 == row.status.len();
        if let Some(adjoint) = self.adjoint.as_deref_mut().filter(|_| last) {
            adjoint.outputs(self.model, system, row.gradient);
            let snapped = !row.events.is_empty();
            *row.regularity = Regularity::of(self.model, system, report.status, snapped) as u8;
        }
    }

    fn event(&mut self, event: Event) {
        let (load, before, after) = (event.load.to_vec(), event.before.to_vec(), event.after.to_vec());
        let design = self.row.design;
        self.row.events.push(BatchEvent { design, step: event.step, kind: event.kind, load, before, after });
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Model<G, D, P> {
    /// Solves all designs of a batch on `threads` threads (0: all there are).
    ///
    /// Missing states and energies are NaN, missing contacts zero; the status gives the reason.
    ///
    /// # Panics
    /// If the lengths of the batch's arrays are inconsistent.
    pub fn solve_batch(&self, batch: Batch, options: ContinuationOptions, threads: usize) -> BatchResult {
        let (dof, steps, inputs) = (self.dof, batch.steps, self.inputs.len());
        assert_eq!(batch.base.len(), self.parameters.len(), "base parameters");
        assert_eq!(batch.values.len(), batch.designs * batch.varied.len(), "values");
        assert_eq!(batch.loads.len(), steps * inputs, "loads");
        assert!(batch.varied.iter().all(|i| *i < self.parameters.len()), "varied parameters");
        let loads: Vec<&[f64]> = (0..steps).map(|s| &batch.loads[s * inputs..(s + 1) * inputs]).collect();
        let count = batch.designs * steps;
        let differentiate = !batch.gradient.is_empty();
        let width = if differentiate { Adjoint::output_count(self) * batch.gradient.len() } else { 0 };
        let mut result = BatchResult {
            q: vec![f64::NAN; count * dof],
            status: vec![Status::InvalidDesign as u8; count],
            iterations: vec![0; count],
            residual: vec![f64::NAN; count],
            tolerance: vec![f64::NAN; count],
            stability: vec![Stability::Unknown as u8; count],
            energy: vec![f64::NAN; count],
            pairs: vec![0; count],
            touching: vec![0; count],
            tip_force: vec![0.0; count],
            applied: vec![f64::NAN; count * inputs],
            overlap: vec![0.0; count],
            pressure: vec![0.0; count],
            volume: vec![f64::NAN; count * self.pressure_count()],
            stretch: vec![f64::NAN; count * 2 * self.material_count()],
            gradient: vec![f64::NAN; batch.designs * width],
            regularity: vec![Regularity::NoEquilibrium as u8; batch.designs],
            events: vec![],
            free: vec![],
        };
        let widths = [dof, inputs, self.pressure_count(), 2 * self.material_count()];
        let mut rows = split_rows(&mut result, widths, steps, width);
        let solve = |rows: &mut [Row]| {
            let mut path = Continuation::new(self, options, batch.cancel);
            let mut parameters = batch.base.to_vec();
            let start = batch.start.map_or_else(|| vec![0.0; dof], <[f64]>::to_vec);
            let mut adjoint = differentiate.then(|| Adjoint::new(self, batch.gradient));
            for row in rows {
                if batch.cancel.is_some_and(Cancel::is_requested) {
                    row.status.fill(Status::Cancelled as u8);
                    continue;
                }
                let values = &batch.values[row.design * batch.varied.len()..][..batch.varied.len()];
                for (i, v) in batch.varied.iter().zip(values) {
                    parameters[*i] = *v;
                }
                if path.set_parameters(&parameters) {
                    let adjoint = adjoint.as_mut();
                    path.follow(&loads, &start, &mut RowSink { row, model: self, adjoint });
                }
            }
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        match batch.is_parallel(threads).then(|| pool.build().ok()).flatten() {
            Some(pool) => pool.install(|| rows.par_chunks_mut(CHUNK).for_each(solve)),
            None => solve(&mut rows),
        }
        let (events, free): (Vec<_>, Vec<_>) = rows.into_iter().map(|row| (row.events, row.free)).unzip();
        result.events = events.into_iter().flatten().collect();
        result.free = free.into_iter().flatten().collect();
        result
    }
}

/// Cuts the arrays into the rows of each design.
fn split_rows(
    result: &mut BatchResult,
    [dof, inputs, volumes, stretches]: [usize; 4],
    steps: usize,
    width: usize,
) -> Vec<Row<'_>> {
    fn cut<'a, T>(rest: &mut &'a mut [T], count: usize) -> &'a mut [T] {
        let (head, tail) = std::mem::take(rest).split_at_mut(count);
        *rest = tail;
        head
    }
    let BatchResult {
        q,
        status,
        iterations,
        residual,
        tolerance,
        stability,
        energy,
        pairs,
        touching,
        tip_force,
        applied,
        overlap,
        pressure,
        volume,
        stretch,
        gradient,
        regularity,
        ..
    } = result;
    let (mut q, mut status, mut iterations) = (&mut q[..], &mut status[..], &mut iterations[..]);
    let (mut residual, mut energy, mut pairs) = (&mut residual[..], &mut energy[..], &mut pairs[..]);
    let (mut touching, mut tip_force, mut gradient) =
        (&mut touching[..], &mut tip_force[..], &mut gradient[..]);
    let (mut applied, mut overlap, mut pressure) = (&mut applied[..], &mut overlap[..], &mut pressure[..]);
    let (mut volume, mut stretch) = (&mut volume[..], &mut stretch[..]);
    let (mut tolerance, mut stability) = (&mut tolerance[..], &mut stability[..]);
    let designs = regularity.iter_mut().enumerate();
    designs
        .map(|(design, regularity)| Row {
            design,
            dof,
            q: cut(&mut q, steps * dof),
            status: cut(&mut status, steps),
            iterations: cut(&mut iterations, steps),
            residual: cut(&mut residual, steps),
            tolerance: cut(&mut tolerance, steps),
            stability: cut(&mut stability, steps),
            energy: cut(&mut energy, steps),
            pairs: cut(&mut pairs, steps),
            touching: cut(&mut touching, steps),
            tip_force: cut(&mut tip_force, steps),
            applied: cut(&mut applied, steps * inputs),
            overlap: cut(&mut overlap, steps),
            pressure: cut(&mut pressure, steps),
            volume: cut(&mut volume, steps * volumes),
            stretch: cut(&mut stretch, steps * stretches),
            gradient: cut(&mut gradient, width),
            regularity,
            events: vec![],
            free: vec![],
        })
        .collect()
}
