//! One branch followed by arc length, with a variable number of points.

use crate::equilibrium::{Cancel, Continuation, ContinuationOptions, Event, PathSink, StepReport, System};
use crate::lie::LieGroup;
use crate::model::Model;
use crate::results::PathResults;

/// The points of a branch.
#[derive(Clone, Debug, Default)]
pub struct Branch {
    /// Load of each point, row by row.
    pub loads: Vec<f64>,
    /// Results of the points, as the steps of one design.
    pub results: PathResults,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> PathSink<G, D, P> for Branch {
    fn step(&mut self, index: usize, report: StepReport, system: &System<G, D, P>) {
        self.loads.extend_from_slice(system.input_loads());
        self.results.push([0, index], &report, system);
    }

    fn event(&mut self, _event: Event) {}
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Model<G, D, P> {
    /// Follows the branch from `start` at the first load to the last by arc length; `None` when the
    /// parameters are not admissible. Ends soon after `cancel` is requested.
    ///
    /// # Panics
    /// If an array has the wrong length.
    pub fn follow_branch(
        &self,
        parameters: &[f64],
        loads: &[&[f64]],
        start: &[f64],
        options: ContinuationOptions,
        cancel: Option<&dyn Cancel>,
    ) -> Option<Branch> {
        let mut path = Continuation::new(self, options, cancel);
        let mut branch = Branch::default();
        path.set_parameters(parameters).then(|| {
            path.follow_arc(loads, start, &mut branch);
            branch
        })
    }
}
