//! The equations of equilibrium at one state of one design: residual, tangent and factor, in
//! dimensionless coordinates.

use super::budget::{Budget, Cancel};
use super::factor::Factor;
use super::neutral::NeutralMotions;
use super::options::ContinuationOptions;
use super::projection::Projection;
use super::sweep::Sweep;
use super::vector::dot;
use crate::Data;
use crate::forces::element::Velocities;
use crate::forces::magnitudes::Magnitudes;
use crate::forces::state::Law;
use crate::friction::RenewalWork;
use crate::lie::LieGroup;
use crate::model::Model;
use crate::tolerances::{MAX_DISPLACEMENT, MAX_ROTATION, MAX_ROUNDING, ROUNDING_FACTOR};
use crate::tree::Shape;

/// A model with a design, a load and a state, and the equations of equilibrium there.
///
/// Coordinates are made dimensionless by [`Units`](crate::units::Units). Steps, residuals and velocities
/// are in these units; each residual is weighted with the energy of its own coordinate.
#[derive(Clone, Debug)]
pub struct System<'m, G, const D: usize, const P: usize> {
    pub(super) model: &'m Model<G, D, P>,
    pub(super) data: Data<G, D, P>,
    /// Factor of the tangent.
    pub(super) factor: Factor<D>,
    pub(super) q: Vec<f64>,
    load: Vec<f64>,
    /// Actual size of one unit of each dimensionless coordinate.
    pub(super) unit: Vec<f64>,
    /// Dimensionless residual at the state evaluated last.
    pub(super) residual: Vec<f64>,
    /// Ratio of the unit of energy to the energy of each coordinate.
    weight: Vec<f64>,
    pub(super) magnitudes: Magnitudes<P>,
    accuracy: Accuracy,
    /// Number of contacts and slack springs that act where the tangent was evaluated.
    switched_on: usize,
    /// The state of the tangent, or that for which it stands.
    pub(super) tangent_state: Vec<f64>,
    /// Whether the tangent shows that this state is stable.
    pub(super) surely_stable: bool,
    /// Coordinates whose diagonal entry of the current tangent is zero to rounding.
    loose: Vec<usize>,
    /// Whether forces balance only up to rounding that is a large fraction of them.
    lost_in_rounding: bool,
    /// Coordinates that diverged in the last minimisation.
    diverged: Vec<usize>,
    /// Parameters of stiffnesses far above those of the structure, with their values and softer ones.
    stiff: Vec<(usize, [f64; 2])>,
    /// Multiple of the structure's stiffness above which a spring or contact is stiff.
    stiff_ratio: f64,
    /// Limits on the cost of the current load step.
    pub(super) budget: Budget<'m>,
    /// With ties, their factorised gradients at the state evaluated last.
    pub(super) projection: Projection,
    /// The conditions that were independent at the last equilibrium of a path; none before the first.
    pub(super) independent: Vec<usize>,
    /// The neutral motions that are known.
    pub(super) neutral: NeutralMotions,
    /// Whether ties act by penalties, with the reactions held, in place of exactly.
    pub(super) penalised: bool,
    /// Number of ties, the first ones, that act; all but while they are closed one after another.
    pub(super) acting: usize,
    /// In a singular configuration, the share of each condition in the combination that vanishes.
    weakest: Vec<f64>,
    /// The dimensionless gradient of Π on the motions that ties allow.
    pub(super) free_residual: Vec<f64>,
    /// What the reactions found last add to the energy, as the assembly has earlier ones.
    pub(super) reaction_energy: f64,
    pub(super) scratch: Vec<f64>,
    /// Of a model with bodies that may meet.
    pub(super) sweep: Option<Box<Sweep<G, D, P>>>,
    /// Of a model with friction.
    pub(super) renewal: Option<Box<RenewalWork<D, P>>>,
}

/// How well forces balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Largest residual, as a fraction of the force that is its unit.
    pub residual: f64,
    /// Its bound: the tolerance plus the rounding of the terms that balance.
    pub tolerance: f64,
}

impl<'m, G: LieGroup<D, P>, const D: usize, const P: usize> System<'m, G, D, P> {
    pub(super) fn new(model: &'m Model<G, D, P>, budget: Budget<'m>, stiff_ratio: f64) -> Self {
        let n = model.dof();
        let mut data = Data::new(model);
        data.control(model);
        let mut system = Self {
            model,
            data,
            factor: Factor::new(model),
            q: vec![0.0; n],
            load: vec![0.0; model.load_count()],
            unit: vec![0.0; n],
            residual: vec![0.0; n],
            weight: vec![1.0; n],
            magnitudes: Magnitudes::default(),
            accuracy: Accuracy { residual: f64::NAN, tolerance: f64::NAN },
            switched_on: 0,
            tangent_state: vec![0.0; n],
            surely_stable: false,
            loose: vec![],
            lost_in_rounding: false,
            diverged: vec![],
            stiff: vec![],
            stiff_ratio,
            budget,
            projection: Projection::default(),
            independent: vec![],
            neutral: NeutralMotions::default(),
            penalised: false,
            acting: model.tie_count(),
            weakest: vec![],
            free_residual: vec![],
            reaction_energy: 0.0,
            scratch: vec![],
            sweep: model.has_solids().then(|| Box::new(Sweep::new(model))),
            renewal: (model.friction_count() > 0).then(|| Box::new(RenewalWork::new(model))),
        };
        if let Some(closed) = system.load.get_mut(model.inputs().len()) {
            *closed = 1.0;
        }
        system.set_units();
        system
    }

    /// A system for equilibria that are known.
    pub(crate) fn of_known(model: &'m Model<G, D, P>, cancel: Option<&'m dyn Cancel>) -> Self {
        let options = ContinuationOptions::default();
        Self::new(model, Budget::new(&options, cancel), options.mixed.stiffness)
    }

    /// Goes to a known equilibrium under the loads that its inputs have there, and factorises its tangent;
    /// `false` if that cannot be.
    pub(crate) fn revisit(&mut self, q: &[f64], applied: &[f64]) -> bool {
        self.set_state(q);
        self.load[..applied.len()].copy_from_slice(applied);
        self.evaluate();
        if let Some(controls) = &self.data.controls {
            controls.set_points(&self.model.controls, &mut self.load);
        }
        let load = self.load.clone();
        self.measure_units(&[&load]);
        let finite = self.evaluate().is_finite();
        self.evaluate_tangent();
        self.complete_columns();
        let factorised = self.factorise_neutral();
        finite && (factorised || !self.is_conservative())
    }

    pub(crate) fn set_parameters(&mut self, parameters: &[f64]) {
        self.data.set_parameters(self.model, parameters);
        self.set_units();
    }

    fn set_units(&mut self) {
        let units = &self.data.design.units;
        let root = units.energy.sqrt();
        for (unit, scale) in self.unit.iter_mut().zip(&units.scale) {
            *unit = scale * root;
        }
        for (weight, own) in self.weight.iter_mut().zip(&units.own_energy) {
            *weight = units.energy / own;
        }
        self.find_stiff_terms();
    }

    fn find_stiff_terms(&mut self) {
        let parameters = &self.data.design.geometry.parameters;
        let lengths = self.model.bodies.iter().map(|body| match &body.shape {
            Shape::Rod(rod) => parameters[self.model.rods[*rod].length],
            Shape::Link(link) => parameters[link.length],
        });
        let length = lengths.fold(0.0, f64::max);
        let energy = self.data.design.units.own_energy.iter().copied().fold(0.0, f64::max);
        let limit = self.stiff_ratio * energy / (length * length);
        let stiff = &mut self.stiff;
        stiff.clear();
        self.model.forces.for_each_stiffness::<G, D>(parameters, &mut |slot, multiple| {
            if parameters[slot] * multiple > limit {
                stiff.push((slot, [parameters[slot], limit / multiple]));
            }
        });
    }

    /// Whether springs or contacts are far stiffer than the structure.
    pub(super) fn is_stiff(&self) -> bool {
        !self.stiff.is_empty()
    }

    /// Replaces these stiffnesses by softer ones.
    pub(super) fn soften(&mut self) {
        for (slot, [_, softer]) in &self.stiff {
            self.data.design.geometry.parameters[*slot] = *softer;
        }
    }

    /// Restores these stiffnesses.
    pub(super) fn harden(&mut self) {
        for (slot, [own, _]) in &self.stiff {
            self.data.design.geometry.parameters[*slot] = *own;
        }
    }

    /// Sets the units of coordinates without elasticity from the forces that act on them in the current
    /// state, under the first load and the largest load of each input.
    pub(super) fn measure_units(&mut self, loads: &[&[f64]]) {
        let Some(first) = loads.first().filter(|_| !self.data.design.units.all_elastic()) else { return };
        let n = self.q.len();
        let (mut curvature, mut force) = (vec![0.0f64; n], vec![0.0f64; n]);
        let largest = |input: usize| {
            loads.iter().copied().max_by(|a, b| a[input].abs().total_cmp(&b[input].abs())).unwrap_or(first)
        };
        for load in std::iter::once(*first).chain((0..first.len()).map(largest)) {
            self.data.evaluate(self.model, &self.q, load);
            self.data.magnitudes(self.model, &self.q, load, &mut self.magnitudes);
            for i in 0..n {
                curvature[i] = curvature[i].max(self.data.tangent()[i * n + i].abs());
                force[i] = force[i].max(self.magnitudes.coordinates[i]);
            }
        }
        let reach = self.data.spring_reach(self.model, &self.q);
        self.data.design.units.measure(self.model, &curvature, &force, &reach);
        self.set_units();
    }

    /// The model.
    pub fn model(&self) -> &'m Model<G, D, P> {
        self.model
    }

    /// The workspace, at the state evaluated last.
    pub fn data(&self) -> &Data<G, D, P> {
        &self.data
    }

    pub(super) fn data_mut(&mut self) -> &mut Data<G, D, P> {
        &mut self.data
    }

    /// The current load: that of each input and, with ties, the progress of closing them.
    pub(crate) fn load(&self) -> &[f64] {
        &self.load
    }

    /// The current load of each input.
    pub fn input_loads(&self) -> &[f64] {
        &self.load[..self.model.inputs().len()]
    }

    /// The current state.
    pub fn state(&self) -> &[f64] {
        &self.q
    }

    /// Dimensionless residual at the state evaluated last.
    pub(super) fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Actual size of one unit of each dimensionless coordinate.
    pub(super) fn units(&self) -> &[f64] {
        &self.unit
    }

    /// Energy in units of the reference energy.
    pub(super) fn unit_energy(&self) -> f64 {
        self.data.design.units.energy
    }

    /// Whether the forces derive from a potential.
    pub(super) fn is_conservative(&self) -> bool {
        self.factor.is_symmetric()
    }

    pub(super) fn set_state(&mut self, q: &[f64]) {
        self.q.copy_from_slice(q);
    }

    /// Whether some inputs are controlled by their conjugates.
    pub(super) fn is_controlled(&self) -> bool {
        self.data.controls.is_some()
    }

    /// Whether the conjugates of controlled inputs change with the state.
    pub(super) fn can_be_controlled(&self) -> bool {
        self.data.controls.as_ref().is_none_or(crate::control::Controls::act)
    }

    /// Difference between the listed and the actual changes of the conjugates at the state evaluated last,
    /// by input (zero for other inputs); returns the largest in dimensionless units.
    pub(super) fn gap(&self, target: &[f64], out: &mut [f64]) -> f64 {
        out.fill(0.0);
        let Some(controls) = &self.data.controls else { return 0.0 };
        let mut largest = 0.0f64;
        let changes = controls.change().iter().zip(controls.units());
        for (control, (change, unit)) in self.model.controls.iter().zip(changes) {
            out[control.input] = target[control.input] - change;
            largest = largest.max((out[control.input] / unit).abs());
        }
        largest
    }

    /// Difference between the set point w of each input and its conjugate; zero for other inputs.
    pub(super) fn lag(&self, out: &mut [f64]) {
        let load = &self.load;
        self.gap(load, out);
    }

    /// Whether the conjugates, within the tolerance, and the other loads equal the listed ones.
    pub(super) fn is_at(&self, target: &[f64], tolerance: f64) -> bool {
        let Some(controls) = &self.data.controls else { return self.load == target };
        let mut changes = controls.change().iter().zip(controls.units());
        (0..target.len()).all(|input| match self.model.controls.iter().any(|c| c.input == input) {
            true => changes.next().is_some_and(|(c, unit)| (target[input] - c).abs() <= tolerance * unit),
            false => self.load[input] == target[input],
        })
    }

    /// Second derivative of the energy with respect to the load along a rate, at a fixed state,
    /// dimensionless; it stems from the stiffness of the controls.
    pub(super) fn load_curvature(&self, rate: &[f64]) -> f64 {
        let stored = self.data.controls.as_ref().map(|c| c.curvature(&self.model.controls, rate));
        stored.map_or(0.0, |stored| stored / self.unit_energy())
    }

    /// Adds to the current load.
    pub(super) fn add_load(&mut self, change: &[f64]) {
        self.load.iter_mut().zip(change).for_each(|(u, d)| *u += d);
    }

    /// The load that each input has at the state evaluated last.
    pub(crate) fn applied_load(&self) -> &[f64] {
        let applied = self.data.controls.as_ref().map_or(&self.load[..], crate::control::Controls::applied);
        &applied[..self.model.inputs().len()]
    }

    /// Takes the share of each condition of ties in the combination that vanishes in a singular configuration.
    pub(super) fn set_weakest(&mut self, shares: Vec<f64>) {
        self.weakest = shares;
    }

    /// These shares.
    pub(super) fn weakest(&self) -> &[f64] {
        &self.weakest
    }

    /// Restores a state whose residual is known.
    pub(super) fn restore(&mut self, q: &[f64], residual: &[f64]) {
        self.q.copy_from_slice(q);
        self.residual.copy_from_slice(residual);
    }

    pub(super) fn set_load(&mut self, load: &[f64]) {
        self.load.copy_from_slice(load);
    }

    /// Sets the load `start + fraction · rate`.
    pub(super) fn set_load_between(&mut self, start: &[f64], rate: &[f64], fraction: f64) {
        for ((u, s), r) in self.load.iter_mut().zip(start).zip(rate) {
            *u = s + fraction * r;
        }
    }

    /// Moves the state by a dimensionless step.
    pub(super) fn advance(&mut self, step: &[f64]) {
        for ((q, s), u) in self.q.iter_mut().zip(step).zip(&self.unit) {
            *q += s * u;
        }
    }

    /// Moves to `start` plus a fraction of a dimensionless step.
    pub(super) fn advance_from(&mut self, start: &[f64], step: &[f64], fraction: f64) {
        for ((q, t), (s, u)) in self.q.iter_mut().zip(start).zip(step.iter().zip(&self.unit)) {
            *q = t + fraction * s * u;
        }
    }

    /// The dimensionless displacement from the state `start`.
    pub(super) fn displacement(&self, start: &[f64], out: &mut [f64]) {
        for (d, ((q, s), u)) in out.iter_mut().zip(self.q.iter().zip(start).zip(&self.unit)) {
            *d = (q - s) / u;
        }
    }

    /// Evaluates Π and the residual at the current state; returns the largest dimensionless
    /// residual, which is NaN or infinite where the energy is not defined.
    pub(super) fn evaluate(&mut self) -> f64 {
        self.data.evaluate_residual(self.model, &self.q, &self.load);
        let unit_energy = self.unit_energy();
        let gradient = self.data.residual().iter().zip(&self.unit);
        self.residual.iter_mut().zip(gradient).for_each(|(r, (g, unit))| *r = g * unit / unit_energy);
        if self.is_projected() {
            self.project_residual();
        }
        let mut largest = 0.0f64;
        for (r, weight) in self.residual.iter().zip(&self.weight) {
            let size = r.abs() * weight;
            // `max` would drop a NaN.
            largest = if size <= largest { largest } else { size };
        }
        if self.data.energy().is_finite() { largest } else { f64::NAN }
    }

    /// Evaluates the residual with stiff terms that have a kept force acting in both directions.
    pub(super) fn evaluate_two_sided(&mut self) -> f64 {
        self.data.law = Law::TwoSided;
        let size = self.evaluate();
        self.data.law = Law::Actual;
        size
    }

    /// Evaluates the tangent at the current state with the kept forces; counts as an iteration.
    pub(super) fn evaluate_tangent_with_kept_forces(&mut self) {
        self.data.law = Law::Kept;
        if !self.is_projected() {
            self.data.evaluate_residual(self.model, &self.q, &self.load);
        }
        self.evaluate_tangent();
        self.data.law = Law::Actual;
    }

    /// Stores the forces that stiff terms have after a motion of the points.
    pub(super) fn keep_forces(&mut self, motion: &Velocities<D, P>) {
        self.data.keep_forces(self.model, motion);
    }

    /// Evaluates the tangent at the current state, after its residual; counts as an iteration.
    pub(super) fn evaluate_tangent(&mut self) {
        if self.is_projected() {
            // With the reactions that were found from the residual.
            self.data.evaluate_residual(self.model, &self.q, &self.load);
            self.reaction_energy = 0.0;
        }
        self.data.evaluate_near_tangent(self.model, &self.q, &self.load);
        self.budget.count();
        self.tangent_state.copy_from_slice(&self.q);
        self.surely_stable = false;
        self.switched_on = self.data.switched_on(self.model, &self.q, &self.load);
        self.loose.clear();
        if self.is_projected() {
            self.factor.project(&self.data, Some(&self.projection));
            self.follow_neutral();
            return;
        }
        self.factor.project(&self.data, None);
        if !self.data.design.units.all_elastic() {
            self.find_loose_coordinates();
        }
    }

    /// Number of contacts and slack springs that act in the state whose tangent was evaluated last.
    pub(super) fn switched_on(&self) -> usize {
        self.switched_on
    }

    /// Whether as many of them act in the state evaluated last.
    pub(super) fn is_near_tangent(&self) -> bool {
        self.data.switched_on(self.model, &self.q, &self.load) == self.switched_on
    }

    /// Finds the coordinates whose stiffness is zero to the rounding of its terms.
    fn find_loose_coordinates(&mut self) {
        self.data.magnitudes(self.model, &self.q, &self.load, &mut self.magnitudes);
        let n = self.q.len();
        let tangent = self.data.tangent();
        for i in (0..n).filter(|i| !self.data.design.units.elastic[*i]) {
            let size = self.magnitudes.stiffness[i];
            if tangent[i * n + i].abs() <= ROUNDING_FACTOR * n as f64 * f64::EPSILON * size {
                self.loose.push(i);
            }
        }
    }

    /// Factorises the dimensionless tangent plus `shift`; `false` when it is not positive definite or,
    /// without a potential, when its determinant is negative. Without a shift, motions without stiffness
    /// are allowed; solutions then do not move along them.
    pub(super) fn factorise(&mut self, shift: f64) -> bool {
        let loose = shift == 0.0 && self.is_conservative() && !self.loose.is_empty();
        if self.factor.factorise(&self.data, shift) && !loose {
            return true;
        }
        let null = self.factor.null_pivot().filter(|_| shift == 0.0);
        if !loose && null.is_none() {
            return false;
        }
        self.data.complete_tangent(self.model);
        let first = if loose { &self.loose[..] } else { null.as_slice() };
        self.factor.factorise_semidefinite(&self.data, first, &self.magnitudes.stiffness)
    }

    /// Whether the current factor has free motions.
    pub(super) fn is_singular(&self) -> bool {
        self.factor.is_singular()
    }

    /// Whether a force acts along a free motion of the current factor.
    pub(super) fn pulls_free_motion(&mut self, tolerance: f64) -> bool {
        if self.factor.null_modes().is_empty() {
            return false;
        }
        self.data.magnitudes(self.model, &self.q, &self.load, &mut self.magnitudes);
        let (units, energy) = (&self.unit, self.unit_energy());
        self.factor.null_modes().iter().any(|mode| {
            let forces = self.magnitudes.coordinates.iter().zip(units).zip(mode);
            let size: f64 = forces.map(|((force, unit), z)| force * unit / energy * z.abs()).sum();
            dot(mode, &self.residual).abs() > (tolerance + ROUNDING_FACTOR * f64::EPSILON) * size
        })
    }

    /// Notes the coordinates of the free motions of the current factor along which a force acts.
    pub(super) fn note_free_motion(&mut self) {
        self.diverged = self.free_coordinates();
    }

    /// Free coordinates that the current factor holds fixed.
    pub(super) fn pinned(&self) -> &[usize] {
        self.factor.pinned()
    }

    /// Whether coordinates without elasticity have diverged from `start`.
    pub(super) fn has_diverged(&mut self, start: &[f64]) -> bool {
        let units = &self.data.design.units;
        let longest = self.model.forces.springs.longest(&self.data.design.geometry.parameters);
        self.diverged.clear();
        for (i, (q, s)) in self.q.iter().zip(start).enumerate().filter(|(i, _)| !units.elastic[*i]) {
            let limit = if units.is_length(i) {
                MAX_DISPLACEMENT * units.natural[i].max(longest)
            } else {
                MAX_ROTATION
            };
            if (q - s).abs() > limit {
                self.diverged.push(i);
            }
        }
        !self.diverged.is_empty()
    }

    /// The coordinates of the free motions, and those that diverged.
    pub(super) fn free_coordinates(&self) -> Vec<usize> {
        let mut free = self.diverged.clone();
        for mode in self.factor.null_modes() {
            let most = mode.iter().fold(0.0f64, |m, z| m.max(z.abs()));
            let joints: Vec<usize> = self.model.joints.iter().map(|joint| joint.dof).collect();
            let large = |i: &usize| mode[*i].abs() > 0.1 * most;
            let of_joints: Vec<usize> = joints.into_iter().filter(large).collect();
            let all = || (0..mode.len()).filter(large).collect();
            free.extend(if of_joints.is_empty() { all() } else { of_joints });
        }
        free.sort_unstable();
        free.dedup();
        free
    }

    /// Whether the state, whose largest residual is `size`, is an equilibrium: every elastic coordinate is
    /// within the tolerance of its solution, in its own unit, or the forces balance.
    pub(super) fn has_converged(&mut self, size: f64, tolerance: f64) -> bool {
        if !(size <= tolerance) {
            return false;
        }
        if self.is_projected() && !self.redundant_conditions_hold() {
            return false;
        }
        if self.data.design.units.all_elastic() {
            self.accuracy = Accuracy { residual: size, tolerance };
            return true;
        }
        self.is_balanced(tolerance)
    }

    /// Whether each residual is below the tolerance times the forces that act on its coordinate, up to the
    /// rounding of the terms that balance; needs the tangent of this state or of one nearby.
    pub(super) fn is_balanced(&mut self, tolerance: f64) -> bool {
        self.data.complete_tangent(self.model);
        self.data.magnitudes(self.model, &self.q, &self.load, &mut self.magnitudes);
        let n = self.q.len();
        let mut forces = std::mem::take(&mut self.scratch);
        forces.clear();
        forces.extend_from_slice(self.data.residual());
        let (mut worst, mut balanced, mut meaningless) = (0.0, true, false);
        if self.is_projected() {
            let energy = self.unit_energy();
            let free = self.free_residual.iter().zip(&self.unit);
            forces.iter_mut().zip(free).for_each(|(g, (r, unit))| *g = r * energy / unit);
            balanced = self.is_closed(tolerance) && self.redundant_conditions_hold();
        }
        self.accuracy = Accuracy { residual: 0.0, tolerance };
        let (units, tangent) = (&self.data.design.units, self.data.tangent());
        for (i, g) in forces.iter().enumerate() {
            let force = self.magnitudes.coordinates[i];
            // Coordinates, positions and distances are rounded too.
            let row = tangent[i * n..(i + 1) * n].iter().zip(&self.q);
            let terms: f64 = row.map(|(h, q)| (h * q).abs()).sum();
            let rounding = ROUNDING_FACTOR * f64::EPSILON * (terms + force + self.magnitudes.positions[i]);
            let shared = if self.has_ties() { self.shared_unit(i) } else { 0.0 };
            let unit = force.max(units.elastic_force(i)).max(shared);
            // A force that nothing opposes, as that of a limit which a joint returns to, has to vanish with the
            // distance: there it is negligible.
            let alone = g.abs() >= force && shared == 0.0;
            let reach = if alone { ROUNDING_FACTOR * f64::EPSILON * units.natural[i] } else { 0.0 };
            let allowed = tolerance * unit + rounding + reach * tangent[i * n + i].abs();
            if *g == 0.0 {
                continue;
            }
            let largest = unit.max(units.stiffness[i] * units.natural[i]);
            let (excess, share) = (g.abs() / allowed, rounding / (MAX_ROUNDING * largest));
            balanced &= excess <= 1.0;
            meaningless |= share > 1.0;
            let excess = excess.max(share);
            if excess > worst {
                worst = excess;
                self.accuracy = Accuracy { residual: g.abs() / largest, tolerance: allowed / largest };
            }
        }
        self.scratch = forces;
        self.lost_in_rounding = balanced && meaningless;
        balanced && !meaningless
    }

    /// Evaluates how well forces balance in the current state.
    pub(super) fn measure_accuracy(&mut self, tolerance: f64) {
        self.evaluate();
        self.data.evaluate_near_tangent(self.model, &self.q, &self.load);
        self.is_balanced(tolerance);
    }

    /// Whether forces balanced to rounding, but rounding is too large a fraction of them.
    pub(super) fn is_lost_in_rounding(&self) -> bool {
        self.lost_in_rounding
    }

    /// How well forces balance, as evaluated last.
    pub(super) fn accuracy(&self) -> Accuracy {
        self.accuracy
    }

    /// Solves in place with the current factor.
    pub(super) fn solve(&self, b: &mut [f64]) {
        self.factor.solve(b);
    }

    /// Solves in place with a triangular factor, as [`Factor::solve_lower`].
    pub(super) fn solve_lower(&self, b: &mut [f64]) {
        self.factor.solve_lower(b);
    }

    /// Exchanges the current factor with another one of this model.
    pub(super) fn swap_factor(&mut self, other: &mut Factor<D>) {
        std::mem::swap(&mut self.factor, other);
    }

    /// p = −r.
    pub(super) fn negative_residual(&self, step: &mut [f64]) {
        step.iter_mut().zip(&self.residual).for_each(|(s, r)| *s = -r);
    }

    /// p = −H⁻¹ r, with the current factor.
    pub(super) fn newton_step(&self, step: &mut [f64]) {
        self.negative_residual(step);
        self.factor.solve(step);
    }

    /// Change of the residual for the load rate `rate`, dimensionless.
    pub(super) fn load_gradient(&self, rate: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.data.add_load_gradient(self.model, &self.q, rate, out);
        let unit_energy = self.unit_energy();
        out.iter_mut().zip(&self.unit).for_each(|(v, unit)| *v *= unit / unit_energy);
        if self.is_projected() {
            self.project_load_gradient(rate, out);
        }
    }

    /// Solves with the transposed matrix, in place.
    pub(super) fn solve_transposed_dimensionless(&self, b: &mut [f64]) {
        self.factor.solve_transposed(b);
    }

    /// The dimensionless tangent at hand, row by row.
    pub(super) fn scaled_tangent(&mut self) -> Vec<f64> {
        if let Some(projected) = self.factor.projected() {
            return projected.free_matrix();
        }
        self.complete_tangent();
        let (tangent, scale) = (self.data.tangent(), &self.data.design.units.scale);
        let rows = tangent.chunks(scale.len()).zip(scale);
        rows.flat_map(|(row, s)| row.iter().zip(scale).map(move |(h, t)| h * s * t)).collect()
    }

    /// dq/dλ of the equilibrium for the load rate `rate`, dimensionless.
    ///
    /// Needs the factor of the tangent at the equilibrium evaluated last. Returns the largest rate of a
    /// residual.
    pub(super) fn velocity(&self, rate: &[f64], out: &mut [f64]) -> f64 {
        self.load_gradient(rate, out);
        let change = out.iter().zip(&self.weight).fold(0.0f64, |m, (b, weight)| m.max((b * weight).abs()));
        out.iter_mut().for_each(|v| *v = -*v);
        self.factor.solve(out);
        change
    }

    /// pᵀHp in units of the reference energy, by a product with the tangent; `work` is scratch.
    pub(super) fn curvature_along(&self, step: &[f64], work: &mut [f64]) -> f64 {
        let n = step.len();
        let tangent = self.data.tangent();
        for (w, (s, u)) in work.iter_mut().zip(step.iter().zip(&self.unit)) {
            *w = s * u;
        }
        let mut quadratic = 0.0;
        for i in 0..n {
            quadratic += dot(&tangent[i * n..(i + 1) * n], work) * work[i];
        }
        quadratic / self.unit_energy()
    }

    /// Smallest diagonal entry of the dimensionless tangent, and a bound on its eigenvalues: the largest
    /// absolute row sum, or for a chain the Frobenius norm.
    pub(super) fn tangent_bounds(&self) -> (f64, f64) {
        if let Some(projected) = self.factor.projected() {
            return projected.bounds();
        }
        let n = self.q.len();
        let (tangent, scale) = (self.data.tangent(), &self.data.design.units.scale);
        let diagonal = (0..n).map(|i| tangent[i * n + i] * scale[i] * scale[i]);
        let lowest = diagonal.fold(f64::INFINITY, f64::min);
        let row_sum = |i: usize| {
            let row = &tangent[i * n..(i + 1) * n];
            row.iter().zip(scale).map(|(h, s)| (h * s).abs()).sum::<f64>() * scale[i]
        };
        let norm = self.data.assembly.chain_norm(self.model, scale);
        (lowest, norm.unwrap_or_else(|| (0..n).map(row_sum).fold(0.0, f64::max)))
    }

    /// Completes a tangent of which only the part that its factorisation needs was evaluated.
    pub(super) fn complete_tangent(&mut self) {
        self.data.complete_tangent(self.model);
    }

    /// Computes the columns of the frames that the tangent did not need.
    pub(super) fn complete_columns(&mut self) {
        self.data.complete_columns(self.model);
    }
}
