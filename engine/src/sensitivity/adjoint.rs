//! λᵀ ∂g/∂p for all wanted parameters at once.

use super::design_velocity::DesignVelocity;
use super::held::HeldConjugates;
use super::tip_force;
use crate::data::Data;
use crate::equilibrium::System;
use crate::forces::element::{Velocities, VirtualMotion};
use crate::lie::LieGroup;
use crate::linalg::{LANES, Vector};
use crate::model::{Model, Sensitivities};

/// Workspace of the sensitivities.
#[derive(Clone, Debug)]
pub struct Adjoint<const D: usize, const P: usize> {
    /// World twist of each frame under the virtual motion λ.
    twists: Vec<Vector<D>>,
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
    /// ∂y/∂q of an output, then λ.
    lambda: Vec<f64>,
    wanted: Vec<usize>,
}

impl<const D: usize, const P: usize> Adjoint<D, P> {
    /// A workspace for derivatives with respect to the parameters `wanted`.
    pub fn new<G: LieGroup<D, P>>(model: &Model<G, D, P>, wanted: &[usize]) -> Self {
        let (frames, points) = (model.frames.len(), model.points.len());
        Self {
            twists: vec![Vector::ZERO; frames],
            points: vec![Vector::ZERO; points],
            blocks: model.coordinate_blocks.zeros(),
            wrench: vec![Vector::ZERO; frames],
            gradient: vec![0.0; model.parameters().len()],
            design_velocities: DesignVelocity::all(model, wanted),
            forces: Sensitivities::default(),
            lambda: vec![0.0; model.dof()],
            wanted: wanted.to_vec(),
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
        model.forces.update_sensitivities(&at, &data.design.forces, &mut self.forces);
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
        model.coordinate_blocks.gather(lambda, &mut self.blocks);
        data.velocities(model, &self.blocks, &mut self.twists, &mut self.points);
        let velocities = Velocities { twists: &self.twists, points: &self.points };
        let motion = VirtualMotion { coordinates: lambda, velocities };
        let at = data.state(model, q, load);
        let held = (&data.design.forces, &data.assembly.forces);
        self.gradient.fill(0.0);
        model.forces.add_parameter_work(&at, held, &self.forces, &motion, &mut self.gradient);
        for design_velocity in &self.design_velocities {
            let forces = model.forces.geometric_work(&at, held, &motion, &design_velocity.velocities());
            let columns = design_velocity.column_work(model, data, &self.twists, &self.blocks);
            self.gradient[design_velocity.parameter] += forces + columns;
        }
    }

    /// Number of outputs of [`Adjoint::outputs`]: the joint coordinates, then the tip force.
    pub fn output_count<G: LieGroup<D, P>>(model: &Model<G, D, P>) -> usize {
        model.joints.len() + 1
    }

    /// Total derivatives of every joint coordinate and of the tip force with respect to the wanted
    /// parameters, row by row into `out`, at the equilibrium the system is in.
    ///
    /// The row of the tip force is zero while nothing touches the tip.
    pub fn outputs<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        system: &System<G, D, P>,
        out: &mut [f64],
    ) {
        let (data, q, load) = (system.data(), system.state(), system.load());
        let mut lambda = std::mem::take(&mut self.lambda);
        self.prepare(model, data, q, load);
        let mut held = HeldConjugates::new(model, system);
        for (output, row) in out.chunks_mut(self.wanted.len().max(1)).enumerate() {
            let explicit = output == model.joints.len();
            if explicit {
                if !tip_force::set_gradient(model, data, &mut self.wrench, &mut lambda) {
                    row.fill(0.0);
                    continue;
                }
            } else {
                lambda.fill(0.0);
                lambda[model.joints[output].dof] = 1.0;
            }
            system.solve_transposed(&mut lambda);
            held.project(system, &mut lambda);
            self.virtual_work(model, data, q, load, &lambda);
            held.add_parameters(&mut self.gradient);
            self.gradient.iter_mut().for_each(|g| *g = -*g);
            if explicit {
                tip_force::add_parameters(model, data, &self.design_velocities, &mut self.gradient);
            }
            for (o, i) in row.iter_mut().zip(&self.wanted) {
                *o = self.gradient[*i];
            }
        }
        self.lambda = lambda;
    }
}
