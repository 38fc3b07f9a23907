//! λᵀ ∂g/∂p for all wanted parameters at once.

use super::design_velocity::DesignVelocity;
use super::held::HeldConjugates;
use super::output::Output;
use super::ties::TieSensitivities;
use crate::data::Data;
use crate::equilibrium::System;
use crate::forces::differential::Differential;
use crate::forces::element::{Velocities, VirtualMotion};
use crate::forces::friction::{Direction, FrictionSlopes};
use crate::forces::tendon::{GuideChange, GuideSlopes};
use crate::lie::LieGroup;
use crate::linalg::{LANES, Vector};
use crate::model::{Model, Sensitivities};

/// What later steps of a path have to do with a state: derivatives by its coordinates, by the world twist of frames
/// and by the place of points.
#[derive(Clone, Debug)]
pub(super) struct Carried<const D: usize, const P: usize> {
    pub coordinates: Vec<f64>,
    pub frames: Vec<(usize, Vector<D>)>,
    pub points: Vec<(usize, Vector<P>)>,
}

impl<const D: usize, const P: usize> Carried<D, P> {
    pub fn new(dof: usize) -> Self {
        Self { coordinates: vec![0.0; dof], frames: vec![], points: vec![] }
    }
}

/// Workspace of the sensitivities.
#[derive(Clone, Debug)]
pub struct Adjoint<const D: usize, const P: usize> {
    /// World twist of each frame under the virtual motion λ.
    twists: Vec<Vector<D>>,
    /// The same relative to the frame before.
    own: Vec<Vector<D>>,
    /// Virtual velocity of each point.
    points: Vec<Vector<P>>,
    /// λ in blocks of coordinates.
    blocks: Vec<Vector<LANES>>,
    /// Wrenches of an output on the frames.
    wrench: Vec<Vector<D>>,
    /// Derivatives with respect to every parameter.
    gradient: Vec<f64>,
    /// Design velocities of every geometric parameter, the same for all outputs.
    design_velocities: Vec<DesignVelocity<D, P>>,
    /// Quantities of the forces, the same for all outputs.
    forces: Sensitivities<P>,
    /// The constraints of controlled inputs, likewise.
    held: HeldConjugates,
    /// ∂g/∂u of each input, likewise.
    by_load: Vec<Vec<f64>>,
    /// The conditions of ties, likewise.
    ties: TieSensitivities<D, P>,
    outputs: Vec<Output>,
    /// What is differentiated.
    differential: Differential<D, P>,
    /// ∂y/∂q, then λ.
    lambda: Vec<f64>,
    wanted: Vec<usize>,
    is_wanted: Vec<bool>,
}

impl<const D: usize, const P: usize> Adjoint<D, P> {
    /// A workspace for derivatives with respect to the parameters `wanted`.
    pub fn new<G: LieGroup<D, P>>(model: &Model<G, D, P>, wanted: &[usize]) -> Self {
        let (frames, points) = (model.frames.len(), model.points.len());
        let mut is_wanted = vec![false; model.parameters().len()];
        wanted.iter().for_each(|parameter| is_wanted[*parameter] = true);
        Self {
            twists: vec![Vector::ZERO; frames],
            own: vec![Vector::ZERO; frames],
            points: vec![Vector::ZERO; points],
            blocks: model.coordinate_blocks.zeros(),
            wrench: vec![Vector::ZERO; frames],
            gradient: vec![0.0; model.parameters().len()],
            design_velocities: DesignVelocity::all(model, wanted),
            forces: Sensitivities::default(),
            held: HeldConjugates::default(),
            by_load: vec![vec![0.0; model.dof()]; model.inputs().len()],
            outputs: Output::all(model),
            ties: TieSensitivities::new(model, wanted),
            differential: Differential::new(
                model.dof(),
                model.parameters().len(),
                model.forces.ties.row_count(),
            ),
            lambda: vec![0.0; model.dof()],
            wanted: wanted.to_vec(),
            is_wanted,
        }
    }

    /// λᵀ ∂g/∂p at the state evaluated last, for every wanted parameter.
    ///
    /// `q`, `load` are those of the evaluation.
    pub fn virtual_work_gradient<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        q: &[f64],
        load: &[f64],
        lambda: &[f64],
    ) -> &[f64] {
        self.prepare(model, data, q, load);
        self.virtual_work(model, data, q, load, lambda);
        &self.gradient
    }

    /// Computes the quantities shared by all outputs.
    fn prepare<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        q: &[f64],
        load: &[f64],
    ) {
        self.design_velocities.iter_mut().for_each(|velocity| velocity.update(model, data));
        let at = data.state(model, q, load);
        let held = (&data.design.forces, &data.assembly.forces);
        model.forces.update_sensitivities(&at, held, &self.is_wanted, &mut self.forces);
    }

    /// λᵀ ∂g/∂p from the prepared quantities, into `self.gradient`.
    fn virtual_work<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        q: &[f64],
        load: &[f64],
        lambda: &[f64],
    ) {
        self.gradient.fill(0.0);
        if lambda.iter().all(|rate| *rate == 0.0) {
            self.twists.fill(Vector::ZERO);
            self.points.fill(Vector::ZERO);
            return;
        }
        model.coordinate_blocks.gather(lambda, &mut self.blocks);
        data.velocities(model, &self.blocks, &mut self.twists, &mut self.points);
        let velocities = Velocities { twists: &self.twists, points: &self.points };
        let motion = VirtualMotion { coordinates: lambda, velocities };
        let at = data.state(model, q, load);
        let held = (&data.design.forces, &data.assembly.forces);
        let parents = model.frames.iter().map(|frame| frame.parent);
        self.own
            .iter_mut()
            .zip(&self.twists)
            .zip(parents)
            .for_each(|((own, twist), parent)| *own = *twist - self.twists[parent]);
        model.forces.add_parameter_work(&at, held, &self.forces, &motion, &mut self.gradient);
        for design_velocity in self.design_velocities.iter().filter(|velocity| velocity.acts) {
            let forces = model.forces.geometric_work(&at, held, &motion, &design_velocity.velocities());
            let columns = design_velocity.column_work(model, data, &self.own, &self.blocks);
            self.gradient[design_velocity.parameter] += forces + columns;
        }
    }

    /// Prepares for [`Adjoint::differentiate`] at the equilibrium that the system is in.
    pub(super) fn visit<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>, system: &System<G, D, P>) {
        let data = system.data();
        self.prepare(model, data, system.state(), system.load());
        self.held = HeldConjugates::new(model, system);
        self.ties.visit(model, system);
        let mut rate = vec![0.0; self.by_load.len()];
        for (input, out) in self.by_load.iter_mut().enumerate() {
            out.fill(0.0);
            rate[input] = 1.0;
            data.add_load_gradient(model, system.state(), &rate, out);
            rate[input] = 0.0;
        }
    }

    /// Total derivatives of a sum of outputs, with a weight for each, by the wanted parameters and by the
    /// load of each input; of a controlled input that is its conjugate. Whether it has them both ways.
    pub(super) fn differentiate<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        system: &System<G, D, P>,
        weights: &[f64],
        by_parameters: &mut [f64],
        by_loads: &mut [f64],
    ) -> bool {
        self.differentiate_with(model, system, weights, None, by_parameters, by_loads)
    }

    /// The same of a sum to which later steps of a path add.
    pub(super) fn differentiate_with<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        system: &System<G, D, P>,
        weights: &[f64],
        later: Option<&Carried<D, P>>,
        by_parameters: &mut [f64],
        by_loads: &mut [f64],
    ) -> bool {
        let (data, q, load) = (system.data(), system.state(), system.load());
        let mut lambda = std::mem::take(&mut self.lambda);
        let applied = &weights[weights.len() - by_loads.len()..];
        self.differential.clear();
        for (output, weight) in self.outputs.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            output.add(model, data, [q, load], *weight, &mut self.differential);
        }
        if let Some(later) = later {
            let own = self.differential.coordinates.iter_mut();
            own.zip(&later.coordinates).for_each(|(slope, more)| *slope += more);
            self.differential.frames.extend_from_slice(&later.frames);
            self.differential.points.extend_from_slice(&later.points);
        }
        lambda.copy_from_slice(&self.differential.coordinates);
        self.wrench.fill(Vector::ZERO);
        for (point, slope) in &self.differential.points {
            let jacobian = G::point_jacobian(&data.kinematics.points[*point]);
            self.wrench[data.design.geometry.frames[*point]] += jacobian.transpose_times(slope);
        }
        for (frame, slope) in &self.differential.frames {
            self.wrench[*frame] += *slope;
        }
        data.assembly.add_forces(model, &mut self.wrench, &mut lambda);
        let mut reactions = self.differential.reactions.clone();
        system.solve_adjoint(&mut lambda, &mut reactions);
        let mut held = std::mem::take(&mut self.held);
        held.project(model, system, applied, &mut lambda, &mut reactions);
        self.virtual_work(model, data, q, load, &lambda);
        held.add_parameters(&mut self.gradient);
        self.ties.add_parameters(
            model,
            system,
            (&self.twists, &reactions),
            &self.design_velocities,
            &mut self.gradient,
        );
        for (total, explicit) in self.gradient.iter_mut().zip(&self.differential.parameters) {
            *total = explicit - *total;
        }
        for design_velocity in self.design_velocities.iter().filter(|velocity| velocity.acts) {
            let Velocities { twists, points } = design_velocity.velocities();
            let Differential { frames, points: moved, .. } = &self.differential;
            let turned: f64 = frames.iter().map(|(frame, slope)| slope.dot(&twists[*frame])).sum();
            let moved: f64 = moved.iter().map(|(point, slope)| slope.dot(&points[*point])).sum();
            self.gradient[design_velocity.parameter] += turned + moved;
        }
        for (out, parameter) in by_parameters.iter_mut().zip(&self.wanted) {
            *out = self.gradient[*parameter];
        }
        for ((out, direct), change) in by_loads.iter_mut().zip(applied).zip(&self.by_load) {
            *out = direct - change.iter().zip(&lambda).map(|(a, b)| a * b).sum::<f64>();
        }
        for (input, slope) in &self.differential.loads {
            by_loads[*input] += slope;
        }
        self.ties.add_loads(&reactions, by_loads);
        held.set_by_loads(model, by_loads);
        (self.held, self.lambda) = (held, lambda);
        !self.differential.tied
    }

    /// Velocities of everything under λ of what was differentiated last.
    pub(super) fn virtual_velocities(&self) -> Velocities<'_, D, P> {
        Velocities { twists: &self.twists, points: &self.points }
    }

    /// How points with friction change at the equilibrium visited last.
    pub(super) fn friction_slopes<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        out: &mut FrictionSlopes<P>,
    ) {
        let mut rates = vec![0.0; model.dof()];
        out.by_coordinates.clear();
        for j in 0..model.dof() {
            rates[j] = 1.0;
            model.coordinate_blocks.gather(&rates, &mut self.blocks);
            rates[j] = 0.0;
            data.velocities(model, &self.blocks, &mut self.twists, &mut self.points);
            let direction = Direction { velocities: self.virtual_velocities(), parameter: None };
            out.by_coordinates.push(data.friction_slope(model, &direction));
        }
        self.twists.fill(Vector::ZERO);
        self.points.fill(Vector::ZERO);
        out.by_parameters.clear();
        for parameter in &self.wanted {
            let geometric = self.design_velocities.iter().find(|each| each.parameter == *parameter);
            let velocities =
                geometric.map_or_else(|| self.virtual_velocities(), |velocity| velocity.velocities());
            let direction = Direction { velocities, parameter: Some(*parameter) };
            out.by_parameters.push(data.friction_slope(model, &direction));
        }
        out.by_start = data.friction_slopes_by_start(model);
    }

    /// How forces at guides of tendons change at the equilibrium visited last.
    pub(super) fn guide_slopes<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        system: &System<G, D, P>,
        out: &mut GuideSlopes,
    ) {
        *out = GuideSlopes::default();
        let (data, load) = (system.data(), system.load());
        let none = GuideChange::default();
        let guides = data.guide_slope(model, None, none, load).len();
        if guides == 0 {
            return;
        }
        let mut rates = vec![0.0; model.dof()];
        for j in 0..model.dof() {
            rates[j] = 1.0;
            model.coordinate_blocks.gather(&rates, &mut self.blocks);
            rates[j] = 0.0;
            data.velocities(model, &self.blocks, &mut self.twists, &mut self.points);
            out.by_coordinates.push(data.guide_slope(model, Some(&self.virtual_velocities()), none, load));
        }
        for parameter in &self.wanted {
            let geometric = self.design_velocities.iter().find(|each| each.parameter == *parameter);
            let velocities = geometric.map(|velocity| velocity.velocities());
            let change = GuideChange { parameter: Some(*parameter), ..none };
            out.by_parameters.push(data.guide_slope(model, velocities.as_ref(), change, load));
        }
        for input in 0..model.inputs().len() {
            let change = GuideChange { input: Some(input), ..none };
            out.by_loads.push(data.guide_slope(model, None, change, load));
        }
        for start in 0..guides {
            let change = GuideChange { start: Some(start), ..none };
            out.by_start.push(data.guide_slope(model, None, change, load));
        }
    }

    /// Prepares for [`Adjoint::add_place`] in the state evaluated last.
    pub(super) fn prepare_place<G: LieGroup<D, P>>(&mut self, model: &Model<G, D, P>, data: &Data<G, D, P>) {
        self.design_velocities.iter_mut().for_each(|velocity| velocity.update(model, data));
    }

    /// Adds the derivatives by the wanted parameters through the place of frames alone.
    pub(super) fn add_place(&self, later: &Carried<D, P>, by_parameters: &mut [f64]) {
        for velocity in &self.design_velocities {
            let Velocities { twists, points } = velocity.velocities();
            let turned: f64 = later.frames.iter().map(|(frame, slope)| slope.dot(&twists[*frame])).sum();
            let moved: f64 = later.points.iter().map(|(point, slope)| slope.dot(&points[*point])).sum();
            for (out, parameter) in by_parameters.iter_mut().zip(&self.wanted) {
                *out += if *parameter == velocity.parameter { turned + moved } else { 0.0 };
            }
        }
    }
}
