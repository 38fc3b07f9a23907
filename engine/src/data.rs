//! The workspace of one thread: a design, a state, and derived quantities.

use crate::assembly::Assembly;
use crate::control::Controls;
use crate::design::Design;
use crate::forces::contact::ContactSummary;
use crate::forces::crossing::{Crossing, Motion};
use crate::forces::element::{ContactForce, Switch, Velocities};
use crate::forces::magnitudes::Magnitudes;
use crate::forces::state::{Law, State};
use crate::kinematics::Kinematics;
use crate::lie::LieGroup;
use crate::linalg::{LANES, Vector};
use crate::model::Model;
use crate::ties::TieConditions;
use crate::tree::Shape;

/// Part of the natural unit of a coordinate over which motions are differenced.
const DIFFERENCE: f64 = 1e-6;

/// A reusable workspace; evaluating and solving allocate no memory.
#[derive(Clone, Debug)]
pub struct Data<G, const D: usize, const P: usize> {
    pub(crate) design: Design<G, D, P>,
    pub(crate) kinematics: Kinematics<G, D, P>,
    pub(crate) assembly: Assembly<D, P>,
    /// Present if the loads of controlled inputs are changes of their conjugates; otherwise they are
    /// forces.
    pub(crate) controls: Option<Controls>,
    /// Present if the model has ties.
    pub(crate) ties: Option<TieConditions>,
    /// Force law of stiff terms.
    pub(crate) law: Law,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Data<G, D, P> {
    /// A workspace for `model`, holding the model's own parameters and the unstrained state.
    pub fn new(model: &Model<G, D, P>) -> Self {
        Self {
            design: Design::new(model),
            kinematics: Kinematics::new(&model.tree),
            assembly: Assembly::new(model),
            law: Law::Actual,
            controls: None,
            ties: (model.tie_count() > 0).then(|| TieConditions::new(model)),
        }
    }

    /// Interprets the loads of controlled inputs as changes of their conjugates from now on.
    pub(crate) fn control(&mut self, model: &Model<G, D, P>) {
        self.controls = (!model.controls.is_empty()).then(|| Controls::new(model));
        self.update_controls(model);
    }

    fn update_controls(&mut self, model: &Model<G, D, P>) {
        if let Some(controls) = &mut self.controls {
            controls.update(model, &self.design, &self.kinematics);
        }
    }

    /// Sets the parameters, in the order of [`Model::layout`].
    ///
    /// # Panics
    /// If the length is not that of the model's parameters.
    pub fn set_parameters(&mut self, model: &Model<G, D, P>, parameters: &[f64]) {
        self.design.set_parameters(model, parameters);
        self.update_controls(model);
    }

    /// Computes energy, residual and tangent at the state `q` under `load`.
    pub fn evaluate(&mut self, model: &Model<G, D, P>, q: &[f64], load: &[f64]) {
        self.evaluate_residual(model, q, load);
        self.evaluate_tangent(model, q, load);
    }

    /// Computes energy and residual at the state `q` under `load`; the tangent is not updated.
    pub fn evaluate_residual(&mut self, model: &Model<G, D, P>, q: &[f64], load: &[f64]) {
        let Self { design, kinematics, assembly, law, controls, ties } = self;
        let law = *law;
        let (tree, geometry) = (&model.tree, &design.geometry);
        kinematics.update(tree, geometry, q);
        let load = controls.as_mut().map_or(load, |controls| controls.apply(model, design, q, load));
        let load = ties.as_mut().map_or(load, |ties| ties.apply(load));
        assembly.update_residual(model, design, &State { tree, geometry, kinematics, q, load, law });
        if let Some(controls) = controls {
            assembly.energy += controls.energy(&model.controls);
        }
    }

    /// Computes the tangent at the state of the last residual, given its coordinates and load again.
    pub fn evaluate_tangent(&mut self, model: &Model<G, D, P>, q: &[f64], load: &[f64]) {
        self.evaluate_near_tangent(model, q, load);
        self.complete_tangent(model);
    }

    /// As above, but of a tangent in chain form only the part that its factorisation needs.
    pub(crate) fn evaluate_near_tangent(&mut self, model: &Model<G, D, P>, q: &[f64], load: &[f64]) {
        let Self { design, kinematics, assembly, law, controls, ties } = self;
        let law = *law;
        let (tree, geometry) = (&model.tree, &design.geometry);
        let load = controls.as_ref().map_or(load, Controls::applied);
        let load = ties.as_ref().map_or(load, TieConditions::applied);
        assembly.update_tangent(model, design, &State { tree, geometry, kinematics, q, load, law });
        if let Some(controls) = controls {
            controls.update_gradient(model, design, kinematics, q);
            controls.add_tangent(&mut assembly.tangent);
        }
    }

    /// Completes such a tangent.
    pub(crate) fn complete_tangent(&mut self, model: &Model<G, D, P>) {
        self.assembly.complete_tangent(model);
    }

    /// Π [J] at the last state evaluated, without the work of non-conservative loads.
    pub fn energy(&self) -> f64 {
        self.assembly.energy
    }

    /// Π [J] at the last state evaluated, without the work of controlled inputs and what friction dissipates.
    pub(crate) fn potential(&self, model: &Model<G, D, P>) -> f64 {
        let stored = self.controls.as_ref().map_or(0.0, |controls| controls.stored(&model.controls));
        self.energy() - stored - self.dissipation(model)
    }

    /// The residual of (9), K q − B(q) u − F(q) = ∇Π, at the last state evaluated.
    pub fn residual(&self) -> &[f64] {
        &self.assembly.terms.coordinates.gradient
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
        model
            .spheres
            .iter()
            .zip(&self.design.geometry.radii)
            .map(|(s, r)| (self.kinematics.points[s.point], *r))
    }

    /// The last state evaluated, given its coordinates and load again.
    pub(crate) fn state<'a>(
        &'a self,
        model: &'a Model<G, D, P>,
        q: &'a [f64],
        load: &'a [f64],
    ) -> State<'a, G, D, P> {
        let (tree, geometry) = (&model.tree, &self.design.geometry);
        let load = self.controls.as_ref().map_or(load, Controls::applied);
        let load = self.ties.as_ref().map_or(load, TieConditions::applied);
        State { tree, geometry, kinematics: &self.kinematics, q, load, law: self.law }
    }

    /// What depends on where bodies are only, in these poses.
    fn placed<'a>(
        &'a self,
        model: &'a Model<G, D, P>,
        kinematics: &'a Kinematics<G, D, P>,
    ) -> State<'a, G, D, P> {
        let (tree, geometry, law) = (&model.tree, &self.design.geometry, self.law);
        State { tree, geometry, kinematics, q: &[], load: &[], law }
    }

    /// Magnitudes of the forces on each coordinate at the state whose tangent was evaluated last, given its
    /// coordinates and load again.
    pub(crate) fn magnitudes(
        &mut self,
        model: &Model<G, D, P>,
        q: &[f64],
        load: &[f64],
        out: &mut Magnitudes<P>,
    ) {
        self.complete_columns(model);
        out.clear(model.dof);
        let at = self.state(model, q, load);
        model.forces.add_magnitudes(&at, &self.design.forces, &self.assembly.forces, out);
        out.project::<G, D>(|mut frame, visit| {
            while frame != 0 {
                self.assembly.columns(model, frame).for_each(|(dof, column)| visit(dof, column));
                frame = model.frames[frame].parent;
            }
        });
    }

    /// Contact forces at the last state evaluated.
    pub fn contact_forces(&self, model: &Model<G, D, P>) -> Vec<ContactForce<P>> {
        model.forces.contact_forces(&self.state(model, &[], &[]), &self.assembly.forces)
    }

    /// Counts touching pairs and spheres and sums the force on the tip, without allocating.
    pub fn contact_summary(&self, model: &Model<G, D, P>) -> ContactSummary {
        self.summary_and_tip(model).0
    }

    /// Unit vector of the contact force on the tip, if something touches it.
    pub(crate) fn tip_direction(&self, model: &Model<G, D, P>) -> Option<Vector<P>> {
        let (summary, tip) = self.summary_and_tip(model);
        (summary.tip_force > 0.0).then(|| tip * (1.0 / summary.tip_force))
    }

    fn summary_and_tip(&self, model: &Model<G, D, P>) -> (ContactSummary, Vector<P>) {
        let (at, states) = (self.state(model, &[], &[]), &self.assembly.forces);
        let (mut summary, mut tip) = (ContactSummary::default(), Vector::ZERO);
        model.forces.contacts.summarise(&at, &states.contacts, &mut summary, &mut tip);
        model.forces.foundations.summarise(&at, &mut summary, &mut tip);
        summary.pressure = summary.pressure.max(model.forces.obstacles.largest_pressure(&states.obstacles));
        summary.tip_force = tip.norm();
        (summary, tip)
    }

    /// Evaluates the conditions of ties at the last state evaluated.
    pub(crate) fn update_ties(&mut self, model: &Model<G, D, P>) {
        if let Some(ties) = &mut self.ties {
            ties.update(model, &self.design, &self.kinematics);
        }
    }

    /// Takes the conditions of ties to another state and other applied loads, with kinematics and nothing else.
    pub(crate) fn move_ties(&mut self, model: &Model<G, D, P>, q: &[f64], applied: &[f64]) {
        let Self { design, kinematics, ties, .. } = self;
        kinematics.update(&model.tree, &design.geometry, q);
        if let Some(ties) = ties {
            ties.apply(applied);
            ties.update(model, design, kinematics);
        }
    }

    /// Length of each actuator's path [m] at the state `q`.
    pub fn actuator_lengths(&self, model: &Model<G, D, P>, q: &[f64]) -> Vec<f64> {
        model.forces.actuators.lengths(q, &self.design.forces.actuators)
    }

    /// Volume of each pressurised cavity [m³] at the state `q`.
    pub fn volumes(&self, model: &Model<G, D, P>, q: &[f64], out: &mut [f64]) {
        model.forces.pressures.volumes(q, &self.design.forces.pressures, out);
    }

    /// Tension of each spring [N] at the last state evaluated.
    pub fn spring_tensions(&self, model: &Model<G, D, P>, out: &mut [f64]) {
        model.forces.springs.tensions(&self.state(model, &[], &[]), out);
    }

    /// Length of each tendon [m] at the last state evaluated.
    pub fn tendon_lengths(&self, model: &Model<G, D, P>) -> Vec<f64> {
        model.forces.tendons.lengths(&self.state(model, &[], &[]))
    }

    /// Tension of each tendon [N] at the last state evaluated, given its load again.
    pub fn tendon_tensions(&self, model: &Model<G, D, P>, load: &[f64]) -> Vec<f64> {
        model.forces.tendons.tensions(&self.state(model, &[], load))
    }

    /// −∂ℓ/∂q of each tendon by each coordinate at the last state evaluated, row by row.
    pub fn tendon_arms(&self, model: &Model<G, D, P>) -> Vec<f64> {
        model.forces.tendons.arms(&self.state(model, &[], &[]))
    }

    /// Places along each tendon, branch by branch, at the last state evaluated.
    pub fn tendon_paths(&self, model: &Model<G, D, P>) -> Vec<Vec<Vec<Vector<P>>>> {
        model.forces.tendons.paths(&self.state(model, &[], &[]))
    }

    /// Tension of each strap around a link [N] at the last state evaluated.
    pub fn loop_tensions(&self, model: &Model<G, D, P>, out: &mut [f64]) {
        model.forces.loops.tensions(&self.assembly.forces.loops, out);
    }

    /// Sum of the normal forces on each obstacle [N] at the last state evaluated.
    pub fn obstacle_forces(&self, model: &Model<G, D, P>, out: &mut [f64]) {
        model.forces.obstacles.forces(&self.assembly.forces.obstacles, out);
    }

    /// Least and greatest stretch of the fibres of each material at the state `q`; NaN where there are
    /// none.
    pub fn stretches(&self, model: &Model<G, D, P>, q: &[f64], out: &mut [f64]) {
        out.fill(f64::NAN);
        let p = &self.design.geometry.parameters;
        model.forces.fibres.for_each_stretch(&model.tree, p, q, |m, _, stretch| {
            out[2 * m] = out[2 * m].min(stretch);
            out[2 * m + 1] = out[2 * m + 1].max(stretch);
        });
    }

    /// Angle between both ends of each rod at the state evaluated last, without allocating: in the plane with
    /// its sign, and in space at most π.
    pub fn rod_bending(&self, model: &Model<G, D, P>, out: &mut [f64]) {
        for (rod, out) in out.iter_mut().enumerate() {
            let Some([base, tip]) = rod_frames(model, rod) else { continue };
            let turning = |f: usize| {
                (0..D).find(|axis| G::AXES[*axis].is_angular()).map(|k| self.kinematics.omega[f][k])
            };
            *out = if P == 2 {
                (base + 1..=tip).filter_map(turning).sum()
            } else {
                let ([x, y, z], cos) = self.relative_rotation([base, tip]);
                (x * x + y * y + z * z).sqrt().atan2(cos)
            };
        }
    }

    /// The frames at both ends of a rod, and the twist of the tip, relative to the base, that its bending is
    /// the rate of; zero where the ends are parallel in space.
    pub(crate) fn rod_axis(&self, model: &Model<G, D, P>, rod: usize) -> ([usize; 2], Vector<D>) {
        let mut axis = Vector::ZERO;
        let Some(frames) = rod_frames(model, rod) else { return ([0; 2], axis) };
        let (sine, _) = self.relative_rotation(frames);
        let size = if P == 2 { 1.0 } else { sine.iter().map(|x| x * x).sum::<f64>().sqrt() };
        for (k, mode) in G::AXES.into_iter().enumerate().filter(|(_, mode)| mode.is_angular()) {
            let part = if P == 2 { 1.0 } else { sine[mode.index()] };
            axis[k] = if size > 0.0 { part / size } else { 0.0 };
        }
        (frames, axis)
    }

    /// sin θ n and cos θ of the rotation θ about n in the world that takes one frame to another.
    fn relative_rotation(&self, [base, tip]: [usize; 2]) -> ([f64; 3], f64) {
        let [a, b] = [base, tip].map(|frame| self.kinematics.pose[frame].to_homogeneous());
        let entry = |i: usize, j: usize| (0..3).map(|k| b[i][k] * a[j][k]).sum::<f64>();
        let sine = |i: usize, j: usize| 0.5 * (entry(i, j) - entry(j, i));
        ([sine(2, 1), sine(0, 2), sine(1, 0)], 0.5 * (entry(0, 0) + entry(1, 1) + entry(2, 2) - 1.0))
    }

    /// Frames of these fibres.
    pub fn stretch_frames(&self, model: &Model<G, D, P>, q: &[f64]) -> Vec<[Option<usize>; 2]> {
        let mut ends = vec![0.0; 2 * model.material_count()];
        self.stretches(model, q, &mut ends);
        let mut frames = vec![[None; 2]; model.material_count()];
        let p = &self.design.geometry.parameters;
        model.forces.fibres.for_each_stretch(&model.tree, p, q, |m, place, stretch| {
            let body = model.bodies.iter().find(|b| matches!(b.shape, Shape::Rod(r) if r == place.rod));
            for (end, frame) in frames[m].iter_mut().enumerate() {
                if frame.is_none() && stretch == ends[2 * m + end] {
                    *frame = body.map(|body| body.base_frame + place.point);
                }
            }
        });
        frames
    }

    /// Number of terms that are switched on at the last state evaluated, given its coordinates and load again.
    pub(crate) fn switched_on(&self, model: &Model<G, D, P>, q: &[f64], load: &[f64]) -> usize {
        model.forces.switched_on(&self.state(model, q, load), &self.assembly.forces)
    }

    /// Visits the terms that are switched on at the last state evaluated, or are within `margin` of
    /// switching on, given the state's coordinates and load again.
    pub(crate) fn for_each_switch(
        &self,
        model: &Model<G, D, P>,
        q: &[f64],
        load: &[f64],
        margin: f64,
        mut visit: impl FnMut(Switch<P>),
    ) {
        let at = self.state(model, q, load);
        model.forces.for_each_switch(&at, &self.assembly.forces, margin, &mut visit);
    }

    /// Whether a motion in which bodies turn by less than half a turn may lead one through another, between the
    /// states at which these poses are.
    pub(crate) fn may_cross(&self, model: &Model<G, D, P>, ends: [&Kinematics<G, D, P>; 2]) -> bool {
        let [from, to] = ends.map(|kinematics| self.placed(model, kinematics));
        model.forces.may_cross(&Motion { ends: [&from, &to], last: None, margin: 0.0 })
    }

    /// Smallest thickness of a body and what meets it; see `ForceElement::thinnest`.
    pub(crate) fn thinnest(&self, model: &Model<G, D, P>) -> f64 {
        model.forces.thinnest(&self.placed(model, &self.kinematics))
    }

    /// Visits what a straight motion of the coordinates leads through, between the states at which these poses
    /// are; `last`: where those that follow end; `margin`: by how much solids are larger than they are.
    pub(crate) fn for_each_crossing(
        &self,
        model: &Model<G, D, P>,
        ends: [&Kinematics<G, D, P>; 2],
        last: Option<&Kinematics<G, D, P>>,
        margin: f64,
        mut visit: impl FnMut(Crossing),
    ) {
        let [from, to] = ends.map(|kinematics| self.placed(model, kinematics));
        let last = last.map(|kinematics| self.placed(model, kinematics));
        let motion = Motion { ends: [&from, &to], last: last.as_ref(), margin };
        model.forces.for_each_crossing(&motion, &mut visit);
    }

    /// By how much each coordinate without elasticity moves until it has moved the ends of a spring as far as the
    /// spring is long at rest or in the state `q`; infinite for others.
    pub(crate) fn spring_reach(&self, model: &Model<G, D, P>, q: &[f64]) -> Vec<f64> {
        let mut reach = vec![f64::INFINITY; q.len()];
        if !model.has_springs() {
            return reach;
        }
        let (tree, geometry) = (&model.tree, &self.design.geometry);
        let mut moved = q.to_vec();
        let mut poses = [Kinematics::new(tree), Kinematics::new(tree)];
        poses[0].update(tree, geometry, q);
        for (i, reach) in reach.iter_mut().enumerate().filter(|(i, _)| !self.design.units.elastic[*i]) {
            let step = DIFFERENCE * self.design.units.natural[i];
            moved[i] += step;
            poses[1].update(tree, geometry, &moved);
            moved[i] = q[i];
            let [before, after] = poses.each_ref().map(|kinematics| self.placed(model, kinematics));
            *reach = step / model.forces.springs.largest_motion([&before, &after]);
        }
        reach
    }

    /// The largest motion of the ends of a spring between two states, relative to its length.
    pub(crate) fn spring_motion(&self, model: &Model<G, D, P>, states: [&[f64]; 2]) -> f64 {
        if !model.has_springs() {
            return 0.0;
        }
        let poses = states.map(|q| {
            let mut kinematics = Kinematics::new(&model.tree);
            kinematics.update(&model.tree, &self.design.geometry, q);
            kinematics
        });
        let [before, after] = poses.each_ref().map(|kinematics| self.placed(model, kinematics));
        model.forces.springs.largest_motion([&before, &after])
    }

    /// Stores the forces that springs and contacts have after a motion of the points from the state
    /// evaluated last, with distances to first order.
    pub(crate) fn keep_forces(&mut self, model: &Model<G, D, P>, motion: &Velocities<D, P>) {
        let Self { design, kinematics, assembly, law, .. } = self;
        let (tree, geometry) = (&model.tree, &design.geometry);
        let at = State { tree, geometry, kinematics, q: &[], load: &[], law: *law };
        model.forces.keep(&at, motion, &mut assembly.forces);
    }

    /// Computes the columns of all frames that the last tangent did not need.
    pub(crate) fn complete_columns(&mut self, model: &Model<G, D, P>) {
        let Self { design, kinematics, assembly, law, .. } = self;
        let law = *law;
        let (tree, geometry) = (&model.tree, &design.geometry);
        assembly.complete_columns(&State { tree, geometry, kinematics, q: &[], load: &[], law });
    }

    /// World twists of the frames and velocities of the points as the coordinates change at `rates`, in
    /// blocks; for unloaded frames, only after [`Data::complete_columns`].
    pub(crate) fn velocities(
        &self,
        model: &Model<G, D, P>,
        rates: &[Vector<LANES>],
        twists: &mut [Vector<D>],
        points: &mut [Vector<P>],
    ) {
        self.assembly.twists(model, rates, twists);
        let frames = &self.design.geometry.frames;
        for ((velocity, world), frame) in points.iter_mut().zip(&self.kinematics.points).zip(frames) {
            *velocity = G::point_jacobian(world) * twists[*frame];
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
        let at = self.state(model, q, &[]);
        let project = |frame: usize, wrench: &Vector<D>, out: &mut [f64]| {
            self.assembly.add_generalised_force(model, frame, wrench, out);
        };
        let mut add = |change: &[f64]| {
            model.forces.add_load_derivative(&at, &self.design.forces, change, out, &project);
        };
        match &self.controls {
            None => add(change),
            Some(controls) => controls.with_applied_rate(&model.controls, change, add),
        }
    }
}

/// The frames at the base and at the tip of a rod.
fn rod_frames<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    rod: usize,
) -> Option<[usize; 2]> {
    let body = model.bodies.iter().find(|body| matches!(body.shape, Shape::Rod(r) if r == rod))?;
    Some([body.base_frame, body.tip_frame])
}
