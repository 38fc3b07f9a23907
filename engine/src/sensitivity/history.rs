//! Derivatives of paths with friction, which depend on all steps that led to a state.
//!
//! A step is a system of equations R(q, m; p) = 0 in its state q and in what it begins with, m: where the bodies
//! were, the elastic slips, and the stiffnesses that these had. At its end the slips are known functions of q
//! and m. So a number is differentiated by going back along the steps: each has one adjoint of its tangent, with
//! friction renewed, and passes what depends on m on to the step before.

use super::{Adjoint, Carried, Regularity};
use crate::batch::Batch;
use crate::equilibrium::{Cancel, Continuation, ContinuationOptions, PathSink, StepReport, System};
use crate::equilibrium::{Event, FrictionSubstep, Status};
use crate::forces::friction::{FrictionSlopes, PointAdjoint};
use crate::forces::tendon::GuideSlopes;
use crate::friction::PathMemory;
use crate::lie::LieGroup;
use crate::model::Model;
use rayon::prelude::*;

/// A weighted sum of outputs in one step of a design, which belongs to one of several numbers.
#[derive(Clone, Copy, Debug)]
pub struct HistoryPart<'a> {
    /// Index of the design.
    pub design: usize,
    /// Index of the number.
    pub number: usize,
    /// Index of the load step.
    pub step: usize,
    /// Over the [outputs](super::output_groups).
    pub weights: &'a [f64],
}

/// Total derivatives of numbers of designs.
#[derive(Clone, Debug, Default)]
pub struct HistoryDerivatives {
    /// By the wanted parameters, for each design and number; NaN where there is none.
    pub by_parameters: Vec<f64>,
    /// By the loads of each step, likewise.
    pub by_loads: Vec<f64>,
    /// Codes of [`Regularity`], likewise.
    pub regularity: Vec<u8>,
}

/// A step of a path, or a part of one.
#[derive(Clone, Debug)]
struct Record<const P: usize> {
    /// Index of the listed load that it is at, or approaches.
    step: usize,
    /// How much of the way from the one before; 1 at it.
    share: f64,
    q: Vec<f64>,
    applied: Vec<f64>,
    memory: PathMemory<P>,
    /// Whether it is the state of the step before, held.
    held: bool,
}

/// Keeps the steps of a path up to the first that has no stable equilibrium.
struct Recorder<'a, const P: usize> {
    loads: &'a [&'a [f64]],
    records: Vec<Record<P>>,
    ended: bool,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> PathSink<G, D, P> for Recorder<'_, P> {
    fn step(&mut self, index: usize, report: StepReport, system: &System<G, D, P>) {
        self.ended |= report.status != Status::Converged;
        if !self.ended {
            self.records.push(Record {
                step: index,
                share: 1.0,
                q: report.q.to_vec(),
                applied: system.applied_load().to_vec(),
                memory: system.data().friction_memory(),
                held: index > 0 && self.loads[index] == self.loads[index - 1],
            });
        }
    }

    fn event(&mut self, _: Event) {}
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Model<G, D, P> {
    /// Differentiates `numbers` sums of outputs of each design of a batch, by the parameters `wanted`; the parts
    /// are those of the designs in increasing order.
    ///
    /// # Panics
    /// If the lengths of the arrays are inconsistent.
    pub fn differentiate_histories(
        &self,
        batch: Batch,
        options: ContinuationOptions,
        (numbers, parts): (usize, &[HistoryPart]),
        wanted: &[usize],
        threads: usize,
    ) -> HistoryDerivatives {
        assert!(parts.is_sorted_by_key(|part| part.design), "parts");
        let of = |design: usize| {
            let first = parts.partition_point(|part| part.design < design);
            &parts[first..parts.partition_point(|part| part.design <= design)]
        };
        let solve = |design| self.differentiate_history(&batch, options, design, numbers, of(design), wanted);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let parallel = threads != 1 && batch.designs > 1;
        let found: Vec<HistoryDerivatives> = match parallel.then(|| pool.build().ok()).flatten() {
            Some(pool) => pool.install(|| (0..batch.designs).into_par_iter().map(solve).collect()),
            None => (0..batch.designs).map(solve).collect(),
        };
        let mut all = HistoryDerivatives::default();
        for each in found {
            all.by_parameters.extend(each.by_parameters);
            all.by_loads.extend(each.by_loads);
            all.regularity.extend(each.regularity);
        }
        all
    }

    fn differentiate_history(
        &self,
        batch: &Batch,
        options: ContinuationOptions,
        design: usize,
        numbers: usize,
        parts: &[HistoryPart],
        wanted: &[usize],
    ) -> HistoryDerivatives {
        let (inputs, steps, width) = (self.inputs().len(), batch.steps, wanted.len());
        let mut found = HistoryDerivatives {
            by_parameters: vec![f64::NAN; numbers * width],
            by_loads: vec![f64::NAN; numbers * steps * inputs],
            regularity: vec![Regularity::NoEquilibrium as u8; numbers],
        };
        if batch.cancel.is_some_and(Cancel::is_requested) {
            return found;
        }
        let mut parameters = batch.base.to_vec();
        let values = &batch.values[design * batch.varied.len()..][..batch.varied.len()];
        batch.varied.iter().zip(values).for_each(|(i, v)| parameters[*i] = *v);
        let mut path = Continuation::new(self, options, batch.cancel);
        path.start_with(batch.slips);
        if !path.set_parameters(&parameters) {
            return found;
        }
        let own = batch.loads.len() != steps * inputs;
        let first = if own { design * steps } else { 0 };
        let loads: Vec<&[f64]> =
            (first..first + steps).map(|s| &batch.loads[s * inputs..(s + 1) * inputs]).collect();
        let start = batch.start.map_or_else(|| vec![0.0; self.dof], <[f64]>::to_vec);
        let mut recorder = Recorder { loads: &loads, records: vec![], ended: false };
        path.follow(&loads, &start, &mut recorder);
        let reached = recorder.records.len();
        for FrictionSubstep { step, share, q, applied, memory } in std::mem::take(&mut path.friction_substeps)
        {
            if let Some(place) =
                recorder.records.iter().position(|record| record.step == step && record.share == 1.0)
            {
                recorder.records.insert(place, Record { step, share, q, applied, memory, held: false });
            }
        }
        let mut system = System::of_known(self, batch.cancel);
        system.set_parameters(&parameters);
        let mut sweep = Sweep {
            model: self,
            records: &recorder.records,
            reached,
            adjoint: Adjoint::new(self, wanted),
            numbers: vec![None; numbers],
            slopes: FrictionSlopes::default(),
            guides: GuideSlopes::default(),
        };
        sweep.go_back(&mut system, parts, wanted, &mut found);
        sweep.arrive(&mut system, &start, &mut found);
        found
    }
}

/// What is known of a number while going back.
#[derive(Clone, Debug)]
struct Number<const D: usize, const P: usize> {
    carried: Carried<D, P>,
    /// The derivatives by what the points have at the end of the step.
    points: Vec<PointAdjoint<P>>,
    /// Those by the slip of each guide there, less the length beyond it.
    guides: Vec<f64>,
    regularity: Regularity,
}

/// Going back along the steps of a path.
struct Sweep<'a, G, const D: usize, const P: usize> {
    model: &'a Model<G, D, P>,
    records: &'a [Record<P>],
    /// Number of listed loads among them.
    reached: usize,
    adjoint: Adjoint<D, P>,
    /// Those that a later step has a part in.
    numbers: Vec<Option<Number<D, P>>>,
    slopes: FrictionSlopes<P>,
    guides: GuideSlopes,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Sweep<'_, G, D, P> {
    fn go_back(
        &mut self,
        system: &mut System<G, D, P>,
        parts: &[HistoryPart],
        wanted: &[usize],
        found: &mut HistoryDerivatives,
    ) {
        let (model, width) = (self.model, wanted.len());
        let inputs = model.inputs().len();
        let steps = found.by_loads.len().checked_div(self.numbers.len() * inputs).unwrap_or(0);
        let outputs: usize = super::output_groups(model).iter().map(|(_, count)| count).sum();
        let reached = |number: usize| {
            let own = || parts.iter().filter(move |part| part.number == number);
            own().next().is_some() && own().all(|part| part.step < self.reached)
        };
        let reached: Vec<bool> = (0..self.numbers.len()).map(reached).collect();
        let mut weights = vec![vec![0.0; outputs]; self.numbers.len()];
        let mut pending = vec![false; self.numbers.len()];
        let (mut gradient, mut by_loads) = (vec![0.0; width], vec![0.0; inputs]);
        for record in self.records.iter().rev() {
            let here =
                |part: &&HistoryPart| record.share == 1.0 && record.step == part.step && reached[part.number];
            for part in parts.iter().filter(here) {
                let own = &mut weights[part.number];
                own.iter_mut().zip(part.weights).for_each(|(w, more)| *w += more);
                pending[part.number] = true;
            }
            if record.held {
                continue;
            }
            for number in (0..self.numbers.len()).filter(|n| pending[*n]) {
                if self.numbers[number].is_none() {
                    let (carried, regularity) = (Carried::new(model.dof), Regularity::Regular);
                    self.numbers[number] =
                        Some(Number { carried, points: vec![], guides: vec![], regularity });
                    found.by_parameters[number * width..(number + 1) * width].fill(0.0);
                    found.by_loads[number * steps * inputs..(number + 1) * steps * inputs].fill(0.0);
                }
            }
            if self.numbers.iter().all(Option::is_none) {
                continue;
            }
            let known = system.revisit_step(&record.q, &record.applied, &record.memory);
            let regularity = match Regularity::of(model, system) {
                _ if !known => Regularity::NoEquilibrium,
                Regularity::Regular if system.data().is_about_to_slide(model) => Regularity::ContactThreshold,
                other => other,
            };
            self.adjoint.visit(model, system);
            self.adjoint.friction_slopes(model, system.data(), &mut self.slopes);
            self.adjoint.guide_slopes(model, system, &mut self.guides);
            for (n, number) in self.numbers.iter_mut().enumerate() {
                let Some(number) = number else { continue };
                number.carried.coordinates.fill(0.0);
                self.slopes.add_by_coordinates(&number.points, &mut number.carried.coordinates);
                let (data, coordinates) = (system.data(), &mut number.carried.coordinates);
                data.add_guides_by_coordinates(model, &self.guides, &number.guides, coordinates);
                number.carried.points.clear();
                data.add_guide_lengths(model, &number.guides, &mut number.carried.points);
                let both_ways = self.adjoint.differentiate_with(
                    model,
                    system,
                    &weights[n],
                    Some(&number.carried),
                    &mut gradient,
                    &mut by_loads,
                );
                weights[n].fill(0.0);
                let motion = self.adjoint.virtual_velocities();
                system.data().add_friction_slopes(
                    model,
                    &self.slopes,
                    &number.points,
                    &motion,
                    &mut gradient,
                );
                let found_there = (&mut gradient[..], &mut by_loads[..]);
                number.guides =
                    system.data().pass_guides_on(model, &self.guides, &number.guides, &motion, found_there);
                let own = &mut found.by_parameters[n * width..(n + 1) * width];
                own.iter_mut().zip(&gradient).for_each(|(total, more)| *total += more);
                let first = n * steps * inputs;
                for (step, share) in
                    [(record.step, record.share), (record.step.max(1) - 1, 1.0 - record.share)]
                {
                    let row = &mut found.by_loads[first + step * inputs..][..inputs];
                    row.iter_mut().zip(&by_loads).for_each(|(total, more)| *total += share * more);
                }
                number.carried.frames.clear();
                number.points = system.data().pass_friction_on(
                    &self.slopes,
                    (&number.points, &motion),
                    &mut number.carried.frames,
                );
                number.regularity = worse(number.regularity, regularity);
                if !both_ways {
                    number.regularity = worse(number.regularity, Regularity::Tied);
                }
            }
        }
    }

    /// Adds what the place of everything as the path begins has to do with it, and the verdicts.
    fn arrive(&mut self, system: &mut System<G, D, P>, start: &[f64], found: &mut HistoryDerivatives) {
        if self.numbers.iter().all(Option::is_none) {
            return;
        }
        let begins_there = system.revisit_start(start, &self.records[0].memory);
        let width = found.by_parameters.len() / self.numbers.len();
        self.adjoint.prepare_place(self.model, system.data());
        for (n, number) in self.numbers.iter_mut().enumerate() {
            let Some(number) = number else { continue };
            number.carried.points.clear();
            system.data().add_guide_lengths(self.model, &number.guides, &mut number.carried.points);
            let gradient = &mut found.by_parameters[n * width..(n + 1) * width];
            self.adjoint.add_place(&number.carried, gradient);
            let regularity = if begins_there { number.regularity } else { Regularity::NoEquilibrium };
            found.regularity[n] = regularity as u8;
            if regularity == Regularity::NoEquilibrium {
                gradient.fill(f64::NAN);
            }
        }
    }
}

/// The one of two verdicts that says less about a derivative.
fn worse(a: Regularity, b: Regularity) -> Regularity {
    let order = [
        Regularity::NoEquilibrium,
        Regularity::NearlySingular,
        Regularity::ContactThreshold,
        Regularity::Snapped,
        Regularity::Tied,
        Regularity::Regular,
    ];
    let place = |verdict: Regularity| order.iter().position(|each| *each == verdict);
    if place(a) <= place(b) { a } else { b }
}
