//! λᵀ ∂g/∂p for all wanted parameters at once.

use super::local::Thread;
use crate::data::Data;
use crate::equilibrium::System;
use crate::lie::LieGroup;
use crate::linalg::{LANES, Vector};
use crate::model::{Model, Shape};

/// Workspace of the sensitivities.
#[derive(Clone, Debug)]
pub struct Adjoint<const D: usize, const P: usize> {
    /// World twist of each frame under the virtual motion λ.
    pub(super) twist: Vec<Vector<D>>,
    /// Virtual velocity of each point.
    pub(super) velocity: Vec<Vector<P>>,
    /// λ in blocks of coordinates.
    pub(super) coordinates: Vec<Vector<LANES>>,
    /// Wrenches of an output on the frames.
    pub(super) wrench: Vec<Vector<D>>,
    /// Derivatives with respect to every parameter.
    pub(super) gradient: Vec<f64>,
    /// What every geometric parameter moves, whatever the output.
    pub(super) drifts: Vec<Drift<D, P>>,
    pub(super) threads: Vec<Thread>,
    /// Of every entry of the rods' stiffness: its part in K_ij, divided by S.
    pub(super) sections: Vec<f64>,
    /// ∂y/∂q of an output, then λ.
    lambda: Vec<f64>,
    wanted: Vec<usize>,
}

/// How frames and points move with a geometric parameter, the coordinates held.
#[derive(Clone, Debug)]
pub(super) struct Drift<const D: usize, const P: usize> {
    pub parameter: usize,
    pub kind: Geometric,
    /// World twist of each frame.
    pub twist: Vec<Vector<D>>,
    /// Velocity of each point.
    pub points: Vec<Vector<P>>,
}

/// What a geometric parameter changes.
#[derive(Clone, Copy, Debug)]
pub(super) enum Geometric {
    /// The length of a rod.
    RodLength(usize),
    /// The length of the link of a body.
    LinkLength(usize),
    /// A radius of the link of a body (moves its centroid): at the base or at the tip.
    LinkRadius(usize, bool),
    /// A component of a body's translation.
    Translation(usize, usize),
    /// A component of a body's rotation vector.
    Rotation(usize, usize),
}

impl<const D: usize, const P: usize> Adjoint<D, P> {
    /// A workspace for derivatives with respect to the parameters `wanted`.
    pub fn new<G: LieGroup<D, P>>(model: &Model<G, D, P>, wanted: &[usize]) -> Self {
        let mut mask = vec![false; model.parameters.len()];
        wanted.iter().for_each(|i| mask[*i] = true);
        let (frames, points) = (model.frames.len(), model.points.len());
        let mut drifts = vec![];
        let mut push = |parameter: usize, kind| {
            if mask[parameter] {
                let (twist, points) = (vec![Vector::ZERO; frames], vec![Vector::ZERO; points]);
                drifts.push(Drift { parameter, kind, twist, points });
            }
        };
        for (r, rod) in model.rods.iter().enumerate() {
            push(rod.length, Geometric::RodLength(r));
        }
        for (b, body) in model.bodies.iter().enumerate() {
            for k in 0..3 {
                push(body.translation.start + k, Geometric::Translation(b, k));
                push(body.rotation.start + k, Geometric::Rotation(b, k));
            }
            if let Shape::Link(link) = &body.shape {
                push(link.length, Geometric::LinkLength(b));
                push(link.radius_base, Geometric::LinkRadius(b, false));
                push(link.radius_tip, Geometric::LinkRadius(b, true));
            }
        }
        Self {
            twist: vec![Vector::ZERO; frames],
            velocity: vec![Vector::ZERO; points],
            coordinates: model.coordinate_blocks.zeros(),
            wrench: vec![Vector::ZERO; frames],
            gradient: vec![0.0; model.parameters.len()],
            drifts,
            threads: vec![],
            sections: vec![],
            lambda: vec![0.0; model.dof],
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

    /// Finds what all outputs share.
    fn prepare<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        q: &[f64],
        load: &[f64],
    ) {
        self.drifts.iter_mut().for_each(|drift| drift.update(model, data));
        self.update_threads(model, data, q, load);
        self.update_sections(model, data);
    }

    /// λᵀ ∂g/∂p with the drifts and threads at hand, into `self.gradient`.
    fn virtual_work<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        q: &[f64],
        load: &[f64],
        lambda: &[f64],
    ) {
        self.gradient.fill(0.0);
        self.move_frames(model, data, lambda);
        self.add_local(model, data, q, lambda);
        for m in 0..self.drifts.len() {
            let drift = &self.drifts[m];
            self.gradient[drift.parameter] += self.geometric_work(model, data, load, drift);
        }
    }

    /// Twists of the frames and velocities of the points under the virtual motion λ.
    fn move_frames<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        lambda: &[f64],
    ) {
        model.coordinate_blocks.gather(lambda, &mut self.coordinates);
        data.velocities(model, &self.coordinates, &mut self.twist, &mut self.velocity);
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
        for (output, row) in out.chunks_mut(self.wanted.len().max(1)).enumerate() {
            let explicit = output == model.joints.len();
            if explicit {
                if !self.tip_force_gradient(model, data, &mut lambda) {
                    row.fill(0.0);
                    continue;
                }
            } else {
                lambda.fill(0.0);
                lambda[model.joints[output].dof] = 1.0;
            }
            system.solve_transposed(&mut lambda);
            self.virtual_work(model, data, q, load, &lambda);
            self.gradient.iter_mut().for_each(|g| *g = -*g);
            if explicit {
                let mut gradient = std::mem::take(&mut self.gradient);
                self.add_tip_force_parameters(model, data, &mut gradient);
                self.gradient = gradient;
            }
            for (o, i) in row.iter_mut().zip(&self.wanted) {
                *o = self.gradient[*i];
            }
        }
        self.lambda = lambda;
    }
}
