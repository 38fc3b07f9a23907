//! One design: everything that follows from a vector of parameters but not from the state.

use crate::lie::LieGroup;
use crate::linalg::{LANES, Matrix, Vector};
use crate::model::{Mass, Model, Motion, Place, Shape, SphereRadius};
use crate::section;
use crate::strain::Mode;

/// Quantities derived from the parameters, refilled in place for each design.
#[derive(Clone, Debug)]
pub(crate) struct Design<G, const D: usize, const P: usize> {
    pub parameters: Vec<f64>,
    /// Constant offsets between frames: placement and tip of each body.
    pub rigid: Vec<G>,
    pub rods: Vec<RodDesign<D>>,
    /// Φ: from a frame's coordinates to the strains at both collocation points of its motion, in
    /// blocks of columns; a joint's are its twists.
    pub strain_maps: Vec<[Matrix<D, LANES>; 2]>,
    /// Values of the rods' stiffness on `model.stiffness_pattern`.
    pub stiffness: Vec<f64>,
    pub threads: Vec<ThreadPoint>,
    pub thread_columns: Vec<ThreadColumn>,
    /// One for each pair of a point's columns, the first not before the second.
    pub thread_pairs: Vec<ThreadPair>,
    /// Local position of each point in its frame.
    pub points: Vec<Vector<P>>,
    /// Radius of each sphere.
    pub radii: Vec<f64>,
    pub volumes: Vec<f64>,
    pub masses: Vec<f64>,
    /// √K_ii-scaling: a coordinate times its scale has the elastic energy of one unit.
    pub scale: Vec<f64>,
    /// The smallest elastic stiffness of an angular coordinate [N·m/rad]: the unit of energy.
    pub reference_stiffness: f64,
}

/// Strain of a rod in normalised form: angular components times L, linear components times L.
#[derive(Clone, Debug)]
pub(crate) struct RodDesign<const D: usize> {
    /// From coordinate to normalised strain: 1 for L·κ, L for linear strains.
    pub axis_scale: Vector<D>,
    pub reference: Vector<D>,
}

/// Tangent of an actuator's path at a Gauss point: τ = base + Σ q_c size_c e_axis, dℓ = weight |τ|.
#[derive(Clone, Debug)]
pub(crate) struct ThreadPoint {
    pub base: [f64; 3],
    pub weight: f64,
    /// Ends of its columns in `thread_columns`, those along each axis; the first begin where the previous
    /// point's end.
    pub ends: [usize; 3],
}

#[derive(Clone, Debug)]
pub(crate) struct ThreadColumn {
    pub dof: usize,
    pub size: f64,
}

/// Inner product of two columns, and the entry of the tangent's half to which the pair adds.
#[derive(Clone, Debug)]
pub(crate) struct ThreadPair {
    pub entry: usize,
    pub product: f64,
    /// One half for a column with itself.
    pub share: f64,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Design<G, D, P> {
    pub fn new(model: &Model<G, D, P>) -> Self {
        let mut design = Self {
            parameters: model.parameters.clone(),
            rigid: vec![G::IDENTITY; 2 * model.bodies.len()],
            rods: vec![RodDesign { axis_scale: Vector::ZERO, reference: Vector::ZERO }; model.rods.len()],
            strain_maps: vec![[Matrix::ZERO; 2]; model.frames.last().map_or(0, |f| f.blocks.end)],
            stiffness: vec![0.0; model.stiffness_pattern.len()],
            threads: vec![],
            thread_columns: vec![],
            thread_pairs: vec![],
            points: vec![Vector::ZERO; model.points.len()],
            radii: vec![0.0; model.spheres.len()],
            volumes: vec![0.0; model.masses.len()],
            masses: vec![0.0; model.masses.len()],
            scale: vec![1.0; model.dof],
            reference_stiffness: 1.0,
        };
        design.update(model);
        design
    }

    /// Recomputes everything from `self.parameters`, without allocating.
    pub fn update(&mut self, model: &Model<G, D, P>) {
        self.place_bodies(model);
        self.stiffen_rods(model);
        self.map_strains(model);
        self.thread_actuators(model);
        self.place_points(model);
        self.weigh(model);
        self.set_scale(model);
    }

    fn place_bodies(&mut self, model: &Model<G, D, P>) {
        let p = &self.parameters;
        for body in &model.bodies {
            let three = |r: &std::ops::Range<usize>| [p[r.start], p[r.start + 1], p[r.start + 2]];
            let pose = G::from_spatial(&three(&body.translation), &three(&body.rotation));
            self.rigid[body.placement] = pose.unwrap_or(G::IDENTITY);
            if let Shape::Link(link) = &body.shape {
                let tip = G::from_spatial(&[p[link.length], 0.0, 0.0], &[0.0; 3]);
                self.rigid[link.tip] = tip.unwrap_or(G::IDENTITY);
            }
        }
    }

    fn stiffen_rods(&mut self, model: &Model<G, D, P>) {
        self.stiffness.fill(0.0);
        for (rod, out) in model.rods.iter().zip(&mut self.rods) {
            let p = &self.parameters;
            let length = p[rod.length];
            for (axis, mode) in G::AXES.into_iter().enumerate() {
                out.axis_scale[axis] = if mode.is_angular() { 1.0 } else { length };
                out.reference[axis] = length * rod.reference_strain[mode.index()];
            }
            let factors = section::factors(rod.section);
            for entry in &rod.entries {
                let radius = p[rod.radius.start + rod.gauss[entry.gauss].point];
                let mode = Mode::ALL[entry.mode];
                let modulus = section::modulus(mode, p[rod.young_modulus], p[rod.shear_modulus]);
                // q is L·κ or ε, so the energy density per unit X is EI q²/L or EA L q².
                let scale = if mode.is_angular() { 1.0 / length } else { length };
                let stiffness = modulus * factors[entry.mode] * radius.powi(section::power(mode)) * scale;
                self.stiffness[entry.entry] += stiffness * entry.value;
            }
        }
    }

    fn map_strains(&mut self, model: &Model<G, D, P>) {
        for frame in &model.frames {
            let maps = &mut self.strain_maps[frame.blocks.clone()];
            match &frame.motion {
                Motion::Rigid(_) => {}
                Motion::Joint(columns) => {
                    for (m, column) in model.joint_columns[columns.clone()].iter().enumerate() {
                        maps[m / LANES][0].set_column(m % LANES, &column.twist);
                    }
                }
                Motion::Strain(step) => {
                    let step = &model.steps[*step];
                    let scale = &self.rods[step.rod].axis_scale;
                    for (m, column) in model.strain_columns[step.columns.clone()].iter().enumerate() {
                        for (map, phi) in maps[m / LANES].iter_mut().zip(column.phi) {
                            map.0[column.axis][m % LANES] = phi * scale[column.axis];
                        }
                    }
                }
            }
        }
    }

    fn thread_actuators(&mut self, model: &Model<G, D, P>) {
        self.threads.clear();
        self.thread_columns.clear();
        self.thread_pairs.clear();
        for actuator in &model.actuators {
            let (p, rod) = (&self.parameters, &model.rods[actuator.rod]);
            let length = p[rod.length];
            for (tendon, gauss) in actuator.tendon.iter().zip(&rod.gauss) {
                let (s, slope) = (p[rod.radius.start + gauss.point], p[rod.slope.start + gauss.point]);
                let along = |i: usize, size: f64, fixed: [f64; 2]| fixed[i] + p[actuator.lever + i] * size;
                let d = [0, 1].map(|i| along(i, s, tendon.offset));
                let dd = [0, 1].map(|i| along(i, slope, tendon.slope));
                let mut base = [0.0, dd[0], dd[1]];
                for mode in Mode::ALL {
                    let arm = thread_arm(mode, d);
                    for i in 0..3 {
                        base[i] += length * rod.reference_strain[mode.index()] * arm[i];
                    }
                }
                let first = self.thread_columns.len();
                let mut ends = [0; 3];
                for (axis, end) in ends.iter_mut().enumerate() {
                    for &(dof, mode, phi) in &gauss.columns {
                        let mode = Mode::ALL[mode];
                        if acts_along(mode, axis) {
                            let scale = if mode.is_angular() { phi } else { phi * length };
                            let size = thread_arm(mode, d)[axis] * scale;
                            self.thread_columns.push(ThreadColumn { dof, size });
                        }
                    }
                    *end = self.thread_columns.len();
                }
                let columns = &self.thread_columns[first..];
                let axis = |m: usize| ends.iter().filter(|end| first + m >= **end).count();
                for (m, a) in columns.iter().enumerate() {
                    for (l, b) in columns[..=m].iter().enumerate() {
                        let entry = a.dof.max(b.dof) * model.dof + a.dof.min(b.dof);
                        let product = if axis(m) == axis(l) { a.size * b.size } else { 0.0 };
                        let share = if m == l { 0.5 } else { 1.0 };
                        self.thread_pairs.push(ThreadPair { entry, product, share });
                    }
                }
                self.threads.push(ThreadPoint { base, weight: gauss.weight, ends });
            }
        }
    }

    fn place_points(&mut self, model: &Model<G, D, P>) {
        for (local, point) in self.points.iter_mut().zip(&model.points) {
            *local = point.offset;
            let (body, fraction) = link_fraction(model, &self.parameters, point.place);
            if let Some(Shape::Link(link)) = body {
                local[0] += fraction * self.parameters[link.length];
            }
        }
        for (radius, sphere) in self.radii.iter_mut().zip(&model.spheres) {
            *radius = match sphere.radius {
                SphereRadius::Parameter(k) => self.parameters[k],
                SphereRadius::Link(body, place) => {
                    let (_, f) = link_fraction(model, &self.parameters, place);
                    let Shape::Link(link) = &model.bodies[body].shape else { continue };
                    let (a, b) = (self.parameters[link.radius_base], self.parameters[link.radius_tip]);
                    a + f * (b - a)
                }
            };
        }
    }

    fn weigh(&mut self, model: &Model<G, D, P>) {
        let p = &self.parameters;
        let values = self.masses.iter_mut().zip(&mut self.volumes);
        for ((m, volume), mass) in values.zip(&model.masses) {
            let density = match mass {
                Mass::Rod(_, r, g) => {
                    let (rod, gauss) = (&model.rods[*r], &model.rods[*r].gauss[*g]);
                    let area = section::factors(rod.section)[3] * p[rod.radius.start + gauss.point].powi(2);
                    *volume = area * p[rod.length] * gauss.weight;
                    p[rod.density]
                }
                Mass::Link(_, b) => {
                    let Shape::Link(link) = &model.bodies[*b].shape else { continue };
                    let (a, b) = (p[link.radius_base], p[link.radius_tip]);
                    *volume = std::f64::consts::PI / 3.0 * p[link.length] * (a * a + a * b + b * b);
                    p[link.density]
                }
            };
            *m = density * *volume;
        }
    }

    fn set_scale(&mut self, model: &Model<G, D, P>) {
        self.scale.fill(0.0);
        for (&(i, j), k) in model.stiffness_pattern.iter().zip(&self.stiffness) {
            if i == j {
                self.scale[i] += k;
            }
        }
        for joint in &model.joints {
            self.scale[joint.dof] += self.parameters[joint.stiffness];
        }
        let angular_rods = model.rods.iter().flat_map(|r| r.dofs.clone().zip(&r.angular));
        let angular_joints = model.joints.iter().map(|j| (j.dof, &j.joint.angular));
        let angular = angular_rods.chain(angular_joints).filter(|(_, angular)| **angular);
        let smallest = angular.map(|(i, _)| self.scale[i]).filter(|k| *k > 0.0).fold(f64::INFINITY, f64::min);
        self.reference_stiffness = if smallest.is_finite() { smallest } else { 1.0 };
        for k in &mut self.scale {
            // A coordinate without elasticity borrows the reference: only its scaling depends on it.
            *k = 1.0 / if *k > 0.0 { *k } else { self.reference_stiffness }.sqrt();
        }
    }
}

/// The link of a place and the fraction of its length, when it depends on a link.
pub(crate) fn link_fraction<'a, G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &'a Model<G, D, P>,
    parameters: &[f64],
    place: Place,
) -> (Option<&'a Shape>, f64) {
    match place {
        Place::Frame => (None, 0.0),
        Place::Fraction(body, f) => (Some(&model.bodies[body].shape), f),
        Place::Centroid(body) => {
            let shape = &model.bodies[body].shape;
            let Shape::Link(link) = shape else { return (None, 0.0) };
            let (a, b) = (parameters[link.radius_base], parameters[link.radius_tip]);
            let centroid = (a * a + 2.0 * a * b + 3.0 * b * b) / (4.0 * (a * a + a * b + b * b));
            (Some(shape), centroid)
        }
    }
}

#[inline]
pub(crate) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Whether [`thread_arm`] has a component along an axis.
fn acts_along(mode: Mode, axis: usize) -> bool {
    thread_arm(mode, [1.0; 2])[axis] != 0.0
}

/// Derivative of the path's tangent with respect to a strain component, at the offset `d = (y, z)`.
pub(crate) fn thread_arm(mode: Mode, d: [f64; 2]) -> [f64; 3] {
    match mode {
        Mode::TwistX => [0.0, -d[1], d[0]],
        Mode::BendY => [d[1], 0.0, 0.0],
        Mode::BendZ => [-d[0], 0.0, 0.0],
        Mode::ExtendX => [1.0, 0.0, 0.0],
        Mode::ShearY => [0.0, 1.0, 0.0],
        Mode::ShearZ => [0.0, 0.0, 1.0],
    }
}
