//! One branch followed by arc length, with a variable number of points.

use crate::equilibrium::{Cancel, Continuation, ContinuationOptions, Event, PathSink, StepReport, System};
use crate::lie::LieGroup;
use crate::model::Model;

/// The points of a branch: row-major arrays.
#[derive(Clone, Debug, Default)]
pub struct Branch {
    /// Load of each point.
    pub loads: Vec<f64>,
    /// State of each point.
    pub q: Vec<f64>,
    /// Status codes.
    pub status: Vec<u8>,
    /// Stability codes.
    pub stability: Vec<u8>,
    /// Point and coordinate of each free motion.
    pub free: Vec<[usize; 2]>,
    /// Iterations used.
    pub iterations: Vec<u32>,
    /// Largest residuals.
    pub residual: Vec<f64>,
    /// Bounds of the residuals.
    pub tolerance: Vec<f64>,
    /// Π [J].
    pub energy: Vec<f64>,
    /// Touching sphere pairs.
    pub pairs: Vec<u32>,
    /// Spheres of first groups that touch.
    pub touching: Vec<u32>,
    /// Resultant contact force on the tip [N].
    pub tip_force: Vec<f64>,
    /// Largest overlap of a contact [m].
    pub overlap: Vec<f64>,
    /// Largest pressure on an elastic foundation [Pa].
    pub pressure: Vec<f64>,
    /// Volume of each pressurised cavity [m³].
    pub volume: Vec<f64>,
    /// Least and greatest stretch of the fibres of each material.
    pub stretch: Vec<f64>,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> PathSink<G, D, P> for Branch {
    fn step(&mut self, index: usize, report: StepReport, system: &System<G, D, P>) {
        let found = report.status.is_equilibrium();
        let contact = if found { system.data().contact_summary(system.model()) } else { Default::default() };
        let number = |x: f64| if found { x } else { f64::NAN };
        self.loads.extend_from_slice(system.load());
        self.q.extend(report.q.iter().map(|x| number(*x)));
        self.status.push(report.status as u8);
        self.stability.push(report.stability as u8);
        self.free.extend(report.free.iter().map(|coordinate| [index, *coordinate]));
        self.iterations.push(report.iterations as u32);
        self.residual.push(number(report.accuracy.residual));
        self.tolerance.push(number(report.accuracy.tolerance));
        self.energy.push(number(system.data().energy()));
        self.pairs.push(contact.pairs);
        self.touching.push(contact.touching);
        self.tip_force.push(contact.tip_force);
        self.overlap.push(contact.overlap);
        self.pressure.push(contact.pressure);
        let model = system.model();
        let (volumes, stretches) = (self.volume.len(), self.stretch.len());
        self.volume.resize(volumes + model.pressure_count(), f64::NAN);
        self.stretch.resize(stretches + 2 * model.material_count(), f64::NAN);
        if found {
            system.data().volumes(model, report.q, &mut self.volume[volumes..]);
            system.data().stretches(model, report.q, &mut self.stretch[stretches..]);
        }
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
