//! The workspace of one thread: a design, a state, and what follows from them.

use crate::assembly::Assembly;
use crate::design::Design;
use crate::kinematics::Kinematics;
use crate::lie::LieGroup;
use crate::linalg::{LANES, Vector};
use crate::model::{Contact, Model};
use crate::potential;
use crate::potential::touch::Touch;

/// The contacts of a state, in brief.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactSummary {
    /// Touching pairs of a sphere with a sphere or round cone.
    pub pairs: u32,
    /// Spheres of the contacts' first groups that touch.
    pub touching: u32,
    /// Magnitude of the resultant contact force on the tip spheres [N].
    pub tip_force: f64,
}

/// One contact force.
#[derive(Clone, Debug)]
pub struct ContactForce<const P: usize> {
    /// The sphere of the first group.
    pub first: usize,
    /// The sphere that it touches, twice; or those at the ends of the round cone that it touches
    /// between them.
    pub second: [usize; 2],
    /// The one of these that is nearer.
    pub nearest: usize,
    /// Whether it touches a round cone.
    pub cone: bool,
    /// Force on the first [N].
    pub force: Vector<P>,
    /// Overlap d [m].
    pub depth: f64,
    /// Middle of the overlap [m].
    pub point: Vector<P>,
}

/// A reusable workspace; after it is made, evaluating and solving allocate nothing.
#[derive(Clone, Debug)]
pub struct Data<G, const D: usize, const P: usize> {
    pub(crate) design: Design<G, D, P>,
    pub(crate) kinematics: Kinematics<G, D, P>,
    pub(crate) assembly: Assembly<D, P>,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Data<G, D, P> {
    /// A workspace for `model`, holding the model's own parameters and the unstrained state.
    pub fn new(model: &Model<G, D, P>) -> Self {
        Self {
            design: Design::new(model),
            kinematics: Kinematics::new(model),
            assembly: Assembly::new(model),
        }
    }

    /// Takes over a vector of parameters, in the order of [`Model::layout`].
    ///
    /// # Panics
    /// If the length is not that of the model's parameters.
    pub fn set_parameters(&mut self, model: &Model<G, D, P>, parameters: &[f64]) {
        self.design.parameters.copy_from_slice(parameters);
        self.design.update(model);
    }

    /// Computes energy, residual and tangent at the state `q` under `load`.
    pub fn evaluate(&mut self, model: &Model<G, D, P>, q: &[f64], load: &[f64]) {
        self.evaluate_residual(model, q, load);
        self.evaluate_tangent(model, q, load);
    }

    /// Computes energy and residual at the state `q` under `load`; the tangent remains what it was.
    pub fn evaluate_residual(&mut self, model: &Model<G, D, P>, q: &[f64], load: &[f64]) {
        self.kinematics.update(model, &self.design, q);
        self.assembly.update_residual(model, &self.design, &self.kinematics, q, load);
    }

    /// Computes the tangent that goes with the last residual, given its state and load once more.
    pub fn evaluate_tangent(&mut self, model: &Model<G, D, P>, q: &[f64], load: &[f64]) {
        self.evaluate_near_tangent(model, q, load);
        self.complete_tangent(model);
    }

    /// The same, but of a tangent with the form of a chain only what its factorisation needs.
    pub(crate) fn evaluate_near_tangent(&mut self, model: &Model<G, D, P>, q: &[f64], load: &[f64]) {
        self.assembly.update_tangent(model, &self.design, &self.kinematics, q, load);
    }

    /// Completes it.
    pub(crate) fn complete_tangent(&mut self, model: &Model<G, D, P>) {
        self.assembly.complete_tangent(model);
    }

    /// Π [J] at the last state evaluated, without the work of non-conservative loads.
    pub fn energy(&self) -> f64 {
        self.assembly.energy
    }

    /// The residual of (9), K q − B(q) u − F(q) = ∇Π, at the last state evaluated.
    pub fn residual(&self) -> &[f64] {
        &self.assembly.coordinates.gradient
    }

    /// The derivative of the residual, row-major, at the last state whose tangent was evaluated.
    pub fn tangent(&self) -> &[f64] {
        &self.assembly.tangent
    }

    /// Pose of each frame at the last state evaluated.
    pub fn poses(&self) -> &[G] {
        &self.kinematics.pose
    }

    /// Homogeneous matrix of each frame at the last state evaluated.
    pub fn homogeneous_frames(&self) -> Vec<[[f64; 4]; 4]> {
        self.kinematics.pose.iter().map(G::to_homogeneous).collect()
    }

    /// Centre and radius of each sphere at the last state evaluated.
    pub fn spheres<'a>(&'a self, model: &'a Model<G, D, P>) -> impl Iterator<Item = (Vector<P>, f64)> + 'a {
        model.spheres.iter().zip(&self.design.radii).map(|(s, r)| (self.kinematics.points[s.point], *r))
    }

    /// Contact forces at the last state evaluated.
    ///
    /// Where two joined round cones are both touched at the sphere that they share, that counts once.
    pub fn touches(&self, model: &Model<G, D, P>) -> Vec<ContactForce<P>> {
        let mut forces: Vec<ContactForce<P>> = vec![];
        for (contact, k, t) in self.touching(model) {
            let force = t.normal * (k * t.overlap);
            let same =
                |f: &ContactForce<P>| f.first == t.first && (f.force + force).norm() <= 1e-9 * force.norm();
            let shared = forces.iter().rposition(same).filter(|_| t.weight < 0.0);
            if let Some(i) = shared {
                forces.remove(i);
                continue;
            }
            let inward = self.design.radii[t.first] - 0.5 * t.overlap;
            forces.push(ContactForce {
                first: t.first,
                second: t.second,
                cone: !contact.cones.is_empty(),
                nearest: t.second[usize::from(t.t >= 0.5)],
                force,
                depth: t.overlap,
                point: self.kinematics.points[model.spheres[t.first].point] - t.normal * inward,
            });
        }
        forces
    }

    /// What touches at the last state evaluated, with its contact and its stiffness k w.
    pub(crate) fn touching<'a>(
        &'a self,
        model: &'a Model<G, D, P>,
    ) -> impl Iterator<Item = (&'a Contact, f64, &'a Touch<P>)> {
        self.assembly.frames.touches.iter().map(|(contact, touch)| {
            let contact = &model.contacts[*contact];
            (contact, self.design.parameters[contact.stiffness] * touch.weight, touch)
        })
    }

    /// Counts touching pairs and spheres and sums the force on the tip, without allocating.
    pub fn contact_summary(&self, model: &Model<G, D, P>) -> ContactSummary {
        let mut summary = ContactSummary::default();
        let mut tip = Vector::<P>::ZERO;
        let mut last = None;
        for (contact, k, t) in self.touching(model) {
            let this = Some((std::ptr::from_ref(contact), t.first));
            summary.pairs += u32::from(t.weight > 0.0);
            summary.touching += u32::from(this != last);
            last = this;
            if contact.tip[t.first - contact.first.start] {
                tip += t.normal * (k * t.overlap);
            }
        }
        summary.tip_force = tip.norm();
        summary
    }

    /// Length of each actuator's path [m] at the state `q`.
    pub fn actuator_lengths(&self, model: &Model<G, D, P>, q: &[f64]) -> Vec<f64> {
        potential::actuator::lengths(model, &self.design, q)
    }

    /// Makes the columns of all frames available; those that the last tangent needed are of its state.
    pub(crate) fn complete_columns(&mut self, model: &Model<G, D, P>) {
        self.assembly.complete_columns(model, &self.design, &self.kinematics);
    }

    /// World twists of the frames and velocities of the points as the coordinates change at `rates`, in
    /// blocks; of what carries nothing, only after [`Data::complete_columns`].
    pub(crate) fn velocities(
        &self,
        model: &Model<G, D, P>,
        rates: &[Vector<LANES>],
        twists: &mut [Vector<D>],
        points: &mut [Vector<P>],
    ) {
        self.assembly.twists(model, rates, twists);
        for ((velocity, world), point) in points.iter_mut().zip(&self.kinematics.points).zip(&model.points) {
            *velocity = G::point_jacobian(world) * twists[point.frame];
        }
    }

    /// Adds the derivative of the residual along a change of load, at the state evaluated last.
    pub(crate) fn add_load_gradient(
        &self,
        model: &Model<G, D, P>,
        q: &[f64],
        change: &[f64],
        out: &mut [f64],
    ) {
        potential::actuator::add_load_gradient(model, &self.design, q, change, out);
        for wrench in &model.wrenches {
            let Some(input) = wrench.input else { continue };
            let w = potential::wrench::world_wrench(wrench, &self.design, &self.kinematics);
            self.assembly.add_generalised_force(model, wrench.frame, &(w * -change[input]), out);
        }
    }
}
