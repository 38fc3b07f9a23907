//! Inputs that are controlled by their conjugates: a pressure by the volume of its cavity, a chamber or a
//! cable by its length.
//!
//! The listed load of such an input is a change v of its conjugate c(q) from the reference state; the
//! load u required is found. The input acts through a stiffness ρ, like a syringe with a little air:
//!
//! ```text
//! ½ ρ (w − c)²,   u = ρ (w − c).
//! ```
//!
//! A minimum of this energy is an equilibrium under u, and w is chosen so that c = v; see
//! `equilibrium/controlled.rs`. The tangent H + ρ ∇c ∇cᵀ is that of the augmented Lagrangian: for a large ρ
//! it is positive definite where H is so on the motions that do not change c.

use crate::design::Design;
use crate::forces::element::ForceElement;
use crate::forces::pressure::Pressures;
use crate::forces::state::{Law, State};
use crate::geometry::Geometry;
use crate::kinematics::Kinematics;
use crate::lie::LieGroup;
use crate::model::{Description, Model, ModelError};
use crate::tree::Tree;
use std::cell::RefCell;

/// ρ, in units of the stiffness of the body itself. Equilibria do not depend on it.
const CONTROL_STIFFNESS: f64 = 1e3;

/// The conjugate of an input.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Conjugate {
    /// The length of an actuator's path.
    Length(usize),
    /// The volume of a cavity.
    Volume(usize),
}

/// An input that is controlled by its conjugate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Control {
    pub input: usize,
    conjugate: Conjugate,
}

impl Control {
    /// The controls of a description.
    pub fn all(description: &Description, inputs: &[String]) -> Result<Vec<Self>, ModelError> {
        let control = |name: &String| {
            let thread = description.actuators.iter().position(|each| &each.name == name);
            let pressure = description.pressures.iter().position(|each| &each.name == name);
            let conjugate = thread.map(Conjugate::Length).or(pressure.map(Conjugate::Volume));
            // An input that is shared has another name, and no conjugate of its own.
            match (inputs.iter().position(|input| input == name), conjugate) {
                (Some(input), Some(conjugate)) => Ok(Self { input, conjugate }),
                _ => {
                    let expected = "must be a chamber, a cable or a pressure with an input of its own";
                    Err(ModelError::new(format!("controls.{name}"), expected))
                }
            }
        };
        description.controls.iter().map(control).collect()
    }
}

/// The controls of a design in a state.
#[derive(Clone, Debug)]
pub(crate) struct Controls {
    dof: usize,
    /// ρ of each.
    stiffness: Vec<f64>,
    /// The change of each conjugate that stores one unit of energy.
    unit: Vec<f64>,
    /// Each conjugate in the reference state.
    reference: Vec<f64>,
    /// Change of each conjugate at the state evaluated last.
    change: Vec<f64>,
    /// ∇c of each, row by row.
    gradient: Vec<f64>,
    /// The loads of all inputs at the state evaluated last.
    applied: Vec<f64>,
    /// Scratch: a change of all loads, lengths of all actuators, the reference state.
    rate: RefCell<Vec<f64>>,
    lengths: Vec<f64>,
    zero: Vec<f64>,
}

impl Controls {
    pub fn new<G: LieGroup<D, P>, const D: usize, const P: usize>(model: &Model<G, D, P>) -> Self {
        let (n, inputs, count) = (model.dof(), model.load_count(), model.controls.len());
        Self {
            dof: n,
            stiffness: vec![0.0; count],
            unit: vec![0.0; count],
            reference: vec![0.0; count],
            change: vec![0.0; count],
            gradient: vec![0.0; count * n],
            applied: vec![0.0; inputs],
            rate: vec![0.0; inputs].into(),
            lengths: vec![0.0; model.forces.actuators.count()],
            zero: vec![0.0; n],
        }
    }

    /// For a new design.
    pub fn update<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        kinematics: &Kinematics<G, D, P>,
    ) {
        let zero = std::mem::take(&mut self.zero);
        self.reference.fill(0.0);
        self.update_change(model, design, &zero);
        for (k, control) in model.controls.iter().enumerate() {
            self.reference[k] = match control.conjugate {
                Conjugate::Length(_) => self.change[k],
                Conjugate::Volume(pressure) => Pressures::reference(pressure, &design.forces.pressures),
            };
        }
        self.update_gradient(model, design, kinematics, &zero);
        let units = &design.units;
        for (k, gradient) in self.gradient.chunks(self.dof).enumerate() {
            let held = gradient.iter().zip(&units.stiffness).filter(|(a, _)| **a != 0.0);
            let flexibility: f64 = held.map(|(a, stiffness)| a * a / stiffness).sum();
            self.stiffness[k] = CONTROL_STIFFNESS / flexibility;
            self.unit[k] = (units.energy * flexibility).sqrt();
        }
        self.zero = zero;
    }

    /// The loads for which controlled inputs have the given ones at the state evaluated last: their set
    /// points w.
    pub fn set_points(&self, controls: &[Control], loads: &mut [f64]) {
        for (k, control) in controls.iter().enumerate() {
            loads[control.input] = self.change[k] + loads[control.input] / self.stiffness[k];
        }
    }

    /// ρ of each.
    pub fn stiffness(&self) -> &[f64] {
        &self.stiffness
    }

    /// Whether every conjugate changes with the state, as it does unless a path is straight on the axis of
    /// a rod that does not stretch.
    pub fn act(&self) -> bool {
        self.stiffness.iter().all(|stiffness| stiffness.is_finite())
    }

    /// The loads at a state; for controlled inputs `load` holds the set points w.
    pub fn apply<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        q: &[f64],
        load: &[f64],
    ) -> &[f64] {
        self.update_change(model, design, q);
        self.applied[..load.len()].copy_from_slice(load);
        for (k, control) in model.controls.iter().enumerate() {
            self.applied[control.input] = self.stiffness[k] * (load[control.input] - self.change[k]);
        }
        &self.applied[..load.len()]
    }

    fn update_change<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        q: &[f64],
    ) {
        model.forces.actuators.conjugates(q, &design.forces.actuators, &mut self.lengths);
        for (k, control) in model.controls.iter().enumerate() {
            self.change[k] = match control.conjugate {
                Conjugate::Length(actuator) => self.lengths[actuator] - self.reference[k],
                // The constant is left out to reduce rounding.
                Conjugate::Volume(pressure) => {
                    model.forces.pressures.change_of_volume(pressure, q, &design.forces.pressures)
                }
            };
        }
    }

    /// ∇c at a state.
    pub fn update_gradient<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        kinematics: &Kinematics<G, D, P>,
        q: &[f64],
    ) {
        let at = State {
            tree: &model.tree,
            geometry: &design.geometry,
            kinematics,
            q,
            load: &[],
            law: Law::Actual,
        };
        self.gradient.fill(0.0);
        for (control, out) in model.controls.iter().zip(self.gradient.chunks_mut(self.dof)) {
            let rate = self.rate.get_mut();
            rate.fill(0.0);
            rate[control.input] = -1.0;
            let none = |_: usize, _: &_, _: &mut [f64]| {};
            model.forces.actuators.add_load_derivative(&at, &design.forces.actuators, rate, out, &none);
            model.forces.pressures.add_load_derivative(&at, &design.forces.pressures, rate, out, &none);
        }
    }

    /// Adds ρ ∇c ∇cᵀ.
    pub fn add_tangent(&self, tangent: &mut [f64]) {
        for (gradient, stiffness) in self.gradient.chunks(self.dof).zip(&self.stiffness) {
            for (row, a) in tangent.chunks_mut(self.dof).zip(gradient).filter(|(_, a)| **a != 0.0) {
                row.iter_mut().zip(gradient).for_each(|(t, b)| *t += stiffness * a * b);
            }
        }
    }

    /// Correction of the energy of the forces under the applied loads, which contains −u c for each.
    pub fn energy(&self, controls: &[Control]) -> f64 {
        self.stored(controls) + self.work(controls)
    }

    /// Σ ½ ρ (w − c)².
    pub fn stored(&self, controls: &[Control]) -> f64 {
        let each = controls.iter().zip(&self.stiffness);
        each.map(|(control, stiffness)| 0.5 * self.applied[control.input].powi(2) / stiffness).sum()
    }

    /// Σ u c, of the whole conjugates.
    fn work(&self, controls: &[Control]) -> f64 {
        let each = controls.iter().zip(self.reference.iter().zip(&self.change));
        each.map(|(control, (reference, change))| self.applied[control.input] * (reference + change)).sum()
    }

    /// Passes on the change of the loads at a fixed state due to a change of the set points w.
    pub fn with_applied_rate(&self, controls: &[Control], rate: &[f64], visit: impl FnOnce(&[f64])) {
        let mut applied = self.rate.borrow_mut();
        let applied = &mut applied[..rate.len()];
        applied.copy_from_slice(rate);
        for (control, stiffness) in controls.iter().zip(&self.stiffness) {
            applied[control.input] *= stiffness;
        }
        visit(applied);
    }

    /// Second derivative of the energy with the set points w along a rate, at a fixed state.
    pub fn curvature(&self, controls: &[Control], rate: &[f64]) -> f64 {
        let each = controls.iter().zip(&self.stiffness);
        each.map(|(control, stiffness)| stiffness * rate[control.input].powi(2)).sum()
    }

    /// The loads at the state evaluated last.
    pub fn applied(&self) -> &[f64] {
        &self.applied
    }

    /// How far each conjugate has changed from the reference state at the state evaluated last.
    pub fn change(&self) -> &[f64] {
        &self.change
    }

    /// The unit of change of each conjugate.
    pub fn units(&self) -> &[f64] {
        &self.unit
    }

    /// ∇c of each at the state whose tangent was evaluated last.
    pub fn gradients(&self) -> impl Iterator<Item = &[f64]> {
        self.gradient.chunks(self.dof)
    }
}

impl Control {
    /// Adds the derivative of the conjugate's change from the reference state with respect to the
    /// parameters, times `factor`, at fixed coordinates.
    pub fn add_parameters<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        model: &Model<G, D, P>,
        geometry: &Geometry<G, D, P>,
        q: &[f64],
        factor: f64,
        out: &mut [f64],
    ) {
        let tree: &Tree<G, D, P> = &model.tree;
        match self.conjugate {
            Conjugate::Length(actuator) => {
                let actuators = &model.forces.actuators;
                actuators.add_parameters_of_conjugate(actuator, tree, &geometry.parameters, q, factor, out);
                let zero = vec![0.0; q.len()];
                actuators.add_parameters_of_conjugate(
                    actuator,
                    tree,
                    &geometry.parameters,
                    &zero,
                    -factor,
                    out,
                );
            }
            Conjugate::Volume(pressure) => {
                model.forces.pressures.add_parameter_work_of(
                    pressure,
                    tree,
                    &geometry.parameters,
                    q,
                    factor,
                    out,
                );
            }
        }
    }
}
