//! Poses of all frames by the recursion of the paper's (4): one motion per frame.

use crate::geometry::Geometry;
use crate::lie::{LieGroup, Stumpff};
use crate::linalg::{LANES, Matrix, Vector};
use crate::tree::{Motion, Tree};

/// √3/12: the commutator's factor in the 4th-order Magnus expansion at the Zanna points.
const ZANNA_COMMUTATOR: f64 = 0.144_337_567_297_406_44;

/// Poses of the frames and world positions of the points at a state.
#[derive(Clone, Debug)]
pub(crate) struct Kinematics<G, const D: usize, const P: usize> {
    pub pose: Vec<G>,
    /// Ω of each frame's motion; zero for rigid ones.
    pub omega: Vec<Vector<D>>,
    pub stumpff: Vec<Stumpff>,
    /// Normalised strains at the collocation points of each Magnus step.
    pub strain: Vec<[Vector<D>; 2]>,
    pub points: Vec<Vector<P>>,
    /// The coordinates in blocks.
    coordinates: Vec<Vector<LANES>>,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Kinematics<G, D, P> {
    pub fn new(tree: &Tree<G, D, P>) -> Self {
        let frames = tree.frames.len();
        Self {
            pose: vec![G::IDENTITY; frames],
            omega: vec![Vector::ZERO; frames],
            stumpff: vec![Stumpff::new(0.0); frames],
            strain: vec![[Vector::ZERO; 2]; tree.steps.len()],
            points: vec![Vector::ZERO; tree.points.len()],
            coordinates: tree.coordinate_blocks.zeros(),
        }
    }

    /// Takes over where frames and points are.
    pub fn copy_places(&mut self, other: &Self)
    where
        G: Copy,
    {
        self.pose.copy_from_slice(&other.pose);
        self.points.copy_from_slice(&other.points);
    }

    /// Computes all poses at the state `q`.
    pub fn update(&mut self, tree: &Tree<G, D, P>, geometry: &Geometry<G, D, P>, q: &[f64]) {
        tree.coordinate_blocks.gather(q, &mut self.coordinates);
        // All motions first, then their products: only the last loop is sequential.
        for (f, frame) in tree.frames.iter().enumerate().skip(1) {
            let omega = match &frame.motion {
                Motion::Rigid(_) => continue,
                Motion::Joint(columns) => {
                    let columns = &tree.joint_columns[columns.clone()];
                    columns.iter().fold(Vector::ZERO, |sum, c| sum + c.twist * q[c.dof])
                }
                Motion::Strain(step) => {
                    let start = geometry.rods[tree.steps[*step].rod].reference;
                    self.strain[*step] = strains(tree, geometry, f, &self.coordinates, start);
                    self.magnus(tree, *step)
                }
            };
            self.omega[f] = omega;
        }
        for (block, omegas) in self.stumpff.chunks_mut(LANES).zip(self.omega.chunks(LANES)) {
            let mut x = [0.0; LANES];
            x.iter_mut().zip(omegas).for_each(|(x, omega)| *x = G::angle_squared(omega));
            Stumpff::fill(block, x);
        }
        for (f, frame) in tree.frames.iter().enumerate().skip(1) {
            let parent = &self.pose[frame.parent];
            self.pose[f] = match &frame.motion {
                Motion::Rigid(i) => parent.compose(&geometry.rigid[*i]),
                _ => parent.compose(&G::exp(&self.omega[f], &self.stumpff[f])),
            };
        }
        for ((world, local), frame) in self.points.iter_mut().zip(&geometry.points).zip(&geometry.frames) {
            *world = self.pose[*frame].act(local);
        }
    }

    /// Ω of a Magnus step of order 2 or 4.
    #[inline]
    fn magnus(&self, tree: &Tree<G, D, P>, step: usize) -> Vector<D> {
        let magnus = &tree.steps[step];
        let [a, b] = self.strain[step];
        let h = magnus.h;
        if tree.rods[magnus.rod].magnus_order == 4 {
            (a + b) * (0.5 * h) + G::bracket(&a, &b) * (ZANNA_COMMUTATOR * h * h)
        } else {
            a * h
        }
    }

    /// `(A₁, A₂, κ)` of a frame's motion: of its Magnus step, or (1, 0, 0) where Ω is linear.
    #[inline(always)]
    pub fn motion_derivative(&self, tree: &Tree<G, D, P>, f: usize) -> (Matrix<D, D>, Matrix<D, D>, f64) {
        match tree.frames[f].motion {
            Motion::Strain(step) => self.magnus_derivative(tree, step),
            Motion::Joint(_) | Motion::Rigid(_) => (Matrix::diagonal(1.0), Matrix::ZERO, 0.0),
        }
    }

    /// `(A₁, A₂, κ)` with dΩ = A₁ dξ₁ + A₂ dξ₂ and κ [dξ₁, dξ₂] the second-order part of Ω.
    #[inline(always)]
    pub fn magnus_derivative(&self, tree: &Tree<G, D, P>, step: usize) -> (Matrix<D, D>, Matrix<D, D>, f64) {
        let magnus = &tree.steps[step];
        if tree.rods[magnus.rod].magnus_order == 4 {
            let [a, b] = &self.strain[step];
            let commutator = ZANNA_COMMUTATOR * magnus.h * magnus.h;
            let half = Matrix::diagonal(0.5 * magnus.h);
            (half - G::ad(b) * commutator, half + G::ad(a) * commutator, commutator)
        } else {
            (Matrix::diagonal(magnus.h), Matrix::ZERO, 0.0)
        }
    }

    /// Adds Jᵀw for a wrench on a frame, at the state of the last update.
    pub fn add_generalised_force(
        &self,
        tree: &Tree<G, D, P>,
        geometry: &Geometry<G, D, P>,
        frame: usize,
        wrench: &Vector<D>,
        out: &mut [f64],
    ) {
        let mut f = frame;
        while f != 0 {
            let frame = &tree.frames[f];
            if !frame.blocks.is_empty() {
                let body_wrench = G::operate_dual(&self.pose[f].adjoint(), wrench);
                let dual = G::operate_dual(&G::tangent(&self.omega[f], &self.stumpff[f]), &body_wrench);
                let (a1, a2, _) = self.motion_derivative(tree, f);
                let [one, two] = [a1, a2].map(|a| G::operate_dual(&a, &dual));
                let maps = &geometry.strain_maps[frame.blocks.clone()];
                let dofs = tree.column_dofs[frame.columns.clone()].chunks(LANES);
                for (dofs, [phi1, phi2]) in dofs.zip(maps) {
                    let pulled = phi1.transpose_times(&one) + phi2.transpose_times(&two);
                    dofs.iter().enumerate().for_each(|(lane, dof)| out[*dof] += pulled[lane]);
                }
            }
            f = frame.parent;
        }
    }

    /// Accumulated rotation of a planar frame, counting full turns.
    pub fn planar_angle(&self, tree: &Tree<G, D, P>, frame: usize) -> f64 {
        let mut angle = 0.0;
        let mut f = frame;
        while f != 0 {
            angle += match tree.frames[f].motion {
                Motion::Rigid(_) => 0.0,
                _ => self.omega[f][0],
            };
            f = tree.frames[f].parent;
        }
        angle
    }
}

/// Normalised strains at both collocation points of frame `f`'s Magnus step, `start` + Φ x, the
/// coordinates x in blocks.
#[inline(always)]
pub(crate) fn strains<G: LieGroup<D, P>, const D: usize, const P: usize>(
    tree: &Tree<G, D, P>,
    geometry: &Geometry<G, D, P>,
    f: usize,
    coordinates: &[Vector<LANES>],
    start: Vector<D>,
) -> [Vector<D>; 2] {
    let frame = &tree.frames[f];
    let [mut a, mut b] = [start; 2];
    let maps = &geometry.strain_maps[frame.blocks.clone()];
    for (x, [phi1, phi2]) in coordinates[frame.coordinates.clone()].iter().zip(maps) {
        a += *phi1 * *x;
        b += *phi2 * *x;
    }
    [a, b]
}
