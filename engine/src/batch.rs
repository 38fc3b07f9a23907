//! Many designs at once: one path per design, in parallel, with results independent of the thread count.

use crate::equilibrium::{
    Cancel, Continuation, ContinuationOptions, Event, PathSink, Status, StepReport, System,
};
use crate::lie::LieGroup;
use crate::model::Model;
use crate::results::{PathFriction, PathResults};
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
    /// Loads, one row of `model.inputs().len()` per step, of all designs or of each; a path starts at its
    /// first.
    pub loads: &'a [f64],
    /// Number of load steps.
    pub steps: usize,
    /// The state that every path starts from; the reference state unless given.
    pub start: Option<&'a [f64]>,
    /// Slips with which points with friction start there; none has slipped if empty.
    pub slips: &'a [PathFriction],
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

/// The results of a batch, a chunk of designs each, without those of designs that were cancelled before they
/// began.
#[derive(Clone, Debug)]
pub struct Pieces {
    designs: usize,
    steps: usize,
    found: Vec<PathResults>,
}

/// Collects the results of consecutive designs.
struct BatchSink<'a> {
    results: &'a mut PathResults,
    design: usize,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> PathSink<G, D, P> for BatchSink<'_> {
    fn step(&mut self, index: usize, report: StepReport, system: &System<G, D, P>) {
        self.results.push([self.design, index], &report, system);
    }

    fn event(&mut self, event: Event) {
        self.results.push_event(self.design, &event);
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Model<G, D, P> {
    /// Solves all designs of a batch on `threads` threads (0: all there are).
    ///
    /// # Panics
    /// If the lengths of the batch's arrays are inconsistent.
    pub fn solve_batch(&self, batch: Batch, options: ContinuationOptions, threads: usize) -> PathResults {
        self.join(self.solve_in_pieces(batch, options, threads))
    }

    /// Solves a batch like [`Self::solve_batch`]; the results of a cancelled one need not be joined.
    ///
    /// # Panics
    /// If the lengths of the batch's arrays are inconsistent.
    pub fn solve_in_pieces(&self, batch: Batch, options: ContinuationOptions, threads: usize) -> Pieces {
        let (steps, inputs) = (batch.steps, self.inputs.len());
        assert_eq!(batch.base.len(), self.parameters.len(), "base parameters");
        assert_eq!(batch.values.len(), batch.designs * batch.varied.len(), "values");
        let own_loads = batch.loads.len() != steps * inputs;
        assert!(!own_loads || batch.loads.len() == batch.designs * steps * inputs, "loads");
        assert!(batch.varied.iter().all(|i| *i < self.parameters.len()), "varied parameters");
        let start = batch.start.map_or_else(|| vec![0.0; self.dof], <[f64]>::to_vec);
        let solve = |first: usize| {
            let mut path = Continuation::new(self, options, batch.cancel);
            path.start_with(batch.slips);
            let mut parameters = batch.base.to_vec();
            let last = (first + CHUNK).min(batch.designs);
            let mut results = PathResults::with_capacity(self, (last - first) * steps);
            for design in first..last {
                if batch.cancel.is_some_and(Cancel::is_requested) {
                    break;
                }
                let values = &batch.values[design * batch.varied.len()..][..batch.varied.len()];
                for (i, v) in batch.varied.iter().zip(values) {
                    parameters[*i] = *v;
                }
                if !path.set_parameters(&parameters) {
                    results.push_missing(self, Status::InvalidDesign, steps);
                    continue;
                }
                let first = if own_loads { design * steps } else { 0 };
                let loads = (first..first + steps).map(|s| &batch.loads[s * inputs..(s + 1) * inputs]);
                let loads: Vec<&[f64]> = loads.collect();
                path.follow(&loads, &start, &mut BatchSink { results: &mut results, design });
            }
            results
        };
        let first = |chunk: usize| chunk * CHUNK;
        let chunks = batch.designs.div_ceil(CHUNK);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let found: Vec<PathResults> = match batch.is_parallel(threads).then(|| pool.build().ok()).flatten() {
            Some(pool) => pool.install(|| (0..chunks).into_par_iter().map(first).map(solve).collect()),
            None => (0..chunks).map(first).map(solve).collect(),
        };
        Pieces { designs: batch.designs, steps, found }
    }

    /// Joins the results of a batch.
    pub fn join(&self, pieces: Pieces) -> PathResults {
        let Pieces { designs, steps, found } = pieces;
        let mut results = PathResults::with_capacity(self, designs * steps);
        for (chunk, each) in found.into_iter().enumerate() {
            results.extend(each);
            let solved = ((chunk + 1) * CHUNK).min(designs) * steps;
            results.push_missing(self, Status::Cancelled, solved - results.status.len());
        }
        results
    }
}
