//! Derivatives at many known equilibria, in parallel, with results independent of the thread count.

use super::{Adjoint, Regularity};
use crate::equilibrium::{Cancel, System};
use crate::lie::LieGroup;
use crate::model::Model;
use rayon::prelude::*;

/// Equilibria of designs that differ in some parameters, and sums of their outputs.
#[derive(Clone, Copy, Debug)]
pub struct KnownEquilibria<'a> {
    /// The parameters common to all designs.
    pub base: &'a [f64],
    /// Indices of the parameters that vary.
    pub varied: &'a [usize],
    /// Their values, one row of `varied.len()` per design.
    pub values: &'a [f64],
    /// The design of each equilibrium.
    pub designs: &'a [usize],
    /// Their coordinates, row by row.
    pub q: &'a [f64],
    /// The loads that the inputs have there, row by row.
    pub applied: &'a [f64],
    /// The equilibrium of each sum, in increasing order.
    pub sums: &'a [usize],
    /// Its weights, a row over the [outputs](super::output_groups) for each.
    pub weights: &'a [f64],
    /// Parameters with respect to which they are differentiated.
    pub wanted: &'a [usize],
    /// If requested, ends it soon; what is missing is not a number.
    pub cancel: Option<&'a dyn Cancel>,
}

/// Smallest and largest number of equilibria that a thread visits one after another in one workspace, and the number of
/// such chunks beyond which they are not made smaller.
const CHUNK: [usize; 2] = [8, 64];
const CHUNKS: usize = 16;

impl KnownEquilibria<'_> {
    /// Whether more than the calling thread would work on them.
    pub fn is_parallel(&self, threads: usize) -> bool {
        threads != 1 && self.designs.len() > CHUNK[0]
    }
}

/// Total derivatives of sums of outputs along the branches of their equilibria.
#[derive(Clone, Debug, Default)]
pub struct Derivatives {
    /// By the wanted parameters, a row for each sum; NaN where there is none.
    pub by_parameters: Vec<f64>,
    /// By the load of each input or, if it is controlled, by its conjugate, likewise.
    pub by_loads: Vec<f64>,
    /// Codes of [`Regularity`], for each sum.
    pub regularity: Vec<u8>,
}

impl Derivatives {
    /// Sets a row to a combination of others; returns whether these have derivatives both ways.
    fn combine(&mut self, row: usize, mut parts: impl Iterator<Item = (usize, f64)> + Clone) -> bool {
        let rows = self.regularity.len();
        for all in [&mut self.by_parameters, &mut self.by_loads] {
            let width = all.len() / rows;
            all[row * width..(row + 1) * width].fill(0.0);
            for (part, factor) in parts.clone() {
                for k in 0..width {
                    all[row * width + k] += factor * all[part * width + k];
                }
            }
        }
        parts.all(|(part, _)| self.regularity[part] != Regularity::Tied as u8)
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Model<G, D, P> {
    /// Differentiates sums of outputs at known equilibria, on `threads` threads (0: all there are).
    ///
    /// # Panics
    /// If the lengths of the arrays are inconsistent.
    pub fn differentiate(&self, known: KnownEquilibria, threads: usize) -> Derivatives {
        let count = known.designs.len();
        assert_eq!(known.q.len(), count * self.dof(), "coordinates");
        assert_eq!(known.applied.len(), count * self.inputs().len(), "loads");
        assert!(known.sums.is_sorted() && known.sums.iter().all(|s| *s < count), "equilibria of the sums");
        let size = (count / CHUNKS).clamp(CHUNK[0], CHUNK[1]);
        let chunk =
            |index: usize| self.differentiate_chunk(&known, index * size..((index + 1) * size).min(count));
        let chunks = count.div_ceil(size);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let found: Vec<Derivatives> = match known.is_parallel(threads).then(|| pool.build().ok()).flatten() {
            Some(pool) => pool.install(|| (0..chunks).into_par_iter().map(chunk).collect()),
            None => (0..chunks).map(chunk).collect(),
        };
        let mut all = Derivatives::default();
        for each in found {
            all.by_parameters.extend(each.by_parameters);
            all.by_loads.extend(each.by_loads);
            all.regularity.extend(each.regularity);
        }
        all
    }

    fn differentiate_chunk(&self, known: &KnownEquilibria, range: std::ops::Range<usize>) -> Derivatives {
        let (n, inputs, width, varied) =
            (self.dof(), self.inputs().len(), known.wanted.len(), known.varied.len());
        let first = known.sums.partition_point(|equilibrium| *equilibrium < range.start);
        let last = known.sums.partition_point(|equilibrium| *equilibrium < range.end);
        let sums = first..last;
        let outputs = known.weights.len().checked_div(known.sums.len()).unwrap_or(0);
        let mut found = Derivatives {
            by_parameters: vec![f64::NAN; sums.len() * width],
            by_loads: vec![f64::NAN; sums.len() * inputs],
            regularity: vec![Regularity::NoEquilibrium as u8; sums.len()],
        };
        if sums.is_empty() {
            return found;
        }
        let mut system = System::of_known(self, known.cancel);
        let mut adjoint = Adjoint::new(self, known.wanted);
        let mut parameters = known.base.to_vec();
        let mut design = None;
        let mut next = sums.start;
        // The first sum at an equilibrium that is of an output alone, for each of these.
        let mut alone: Vec<Option<usize>> = vec![None; outputs];
        for equilibrium in range {
            if known.cancel.is_some_and(Cancel::is_requested) {
                break;
            }
            let end = next + known.sums[next..sums.end].partition_point(|e| *e == equilibrium);
            let own = std::mem::replace(&mut next, end)..end;
            if own.is_empty() {
                continue;
            }
            if design != Some(known.designs[equilibrium]) {
                let row = known.designs[equilibrium];
                for (i, v) in known.varied.iter().zip(&known.values[row * varied..(row + 1) * varied]) {
                    parameters[*i] = *v;
                }
                design = None;
                if !self.is_admissible(&parameters) {
                    continue;
                }
                system.set_parameters(&parameters);
                design = Some(row);
            }
            let q = &known.q[equilibrium * n..(equilibrium + 1) * n];
            if !system.revisit(q, &known.applied[equilibrium * inputs..(equilibrium + 1) * inputs]) {
                continue;
            }
            let regularity = Regularity::of(self, &mut system);
            adjoint.visit(self, &system);
            let weights = |sum: usize| &known.weights[sum * outputs..(sum + 1) * outputs];
            alone.fill(None);
            for sum in own {
                let row = sum - sums.start;
                let both_ways = match combination(weights(sum), &alone, weights) {
                    Some(parts) => {
                        found.combine(row, parts.iter().map(|(k, factor)| (k - sums.start, *factor)))
                    }
                    None => adjoint.differentiate(
                        self,
                        &system,
                        weights(sum),
                        &mut found.by_parameters[row * width..(row + 1) * width],
                        &mut found.by_loads[row * inputs..(row + 1) * inputs],
                    ),
                };
                let tied = regularity == Regularity::Regular && !both_ways;
                found.regularity[row] = if tied { Regularity::Tied } else { regularity } as u8;
                let mut used = (0..outputs).filter(|output| weights(sum)[*output] != 0.0);
                if let (Some(output), None) = (used.next(), used.next()) {
                    alone[output].get_or_insert(sum);
                }
            }
        }
        found
    }
}

/// Sums with their factors, each `alone` with an output, that add up to one; `None` if there are none.
fn combination<'a>(
    sum: &[f64],
    alone: &[Option<usize>],
    weights: impl Fn(usize) -> &'a [f64],
) -> Option<Vec<(usize, f64)>> {
    let used = sum.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
    used.map(|(output, weight)| alone[output].map(|k| (k, weight / weights(k)[output]))).collect()
}
