//! Equilibrium under constraint equations: Newton's method on the bordered system.
//!
//! Each constraint adds one unknown multiplier μ and one equation c = 0 to the state:
//!
//! ```text
//! ∇Π(q; u) + Σ μ_i ∇c_i = 0,   c_i(q, μ_i) = 0.
//! ```
//!
//! Either the constraint acts on the state by its reaction μ ∇c, or μ is an unknown load,
//! u = u₀ + μ du, and c defines its target. The matrix of the Newton step is the
//! tangent bordered by the gradients; it is regular at limit points, where the tangent is not.

use super::bordered_matrix::BorderedMatrix;
use super::options::MixedOptions;
use super::point_motion::PointMotion;
use super::system::System;
use super::vector::{dot, max_norm};
use crate::lie::LieGroup;
use nalgebra::{DMatrix, DVector, Schur, SymmetricEigen};

/// An equation c(q, μ) = 0 between the state and its multiplier, of order one.
pub trait Constraint {
    /// c.
    fn value(&self, q: &[f64], multiplier: f64) -> f64;

    /// ∂c/∂q into `out`; returns ∂c/∂μ.
    fn gradient(&self, q: &[f64], multiplier: f64, out: &mut [f64]) -> f64;

    /// Adds `factor` (∂²c/∂q²) v to `out`; a linear constraint adds nothing.
    fn add_hessian_product(&self, _q: &[f64], _v: &[f64], _factor: f64, _out: &mut [f64]) {}
}

/// The meaning of a multiplier.
#[derive(Clone, Copy, Debug)]
pub enum Multiplier<'a> {
    /// The reaction μ ∇c that enforces the constraint.
    Reaction,
    /// A load that is not prescribed: μ times this change is added to the base load.
    Load(&'a [f64]),
}

/// A constraint with its multiplier.
#[derive(Clone, Copy)]
pub struct Border<'a> {
    /// The equation.
    pub constraint: &'a dyn Constraint,
    /// The meaning of its multiplier.
    pub multiplier: Multiplier<'a>,
}

/// Chord steps are taken while each leaves less than this fraction of the residual,
const CHORD_CONTRACTION: f64 = 0.1;
/// and only if at most this many more would reach the tolerance at the current rate.
const MAX_CHORDS_LEFT: i32 = 3;

/// Convergence criteria of the bordered Newton method.
#[derive(Clone, Copy, Debug)]
pub struct BorderedTarget {
    /// Largest dimensionless residual, and largest value of a constraint.
    pub tolerance: f64,
    /// Dimensionless step below which the residual is rounding if the step does not lower it.
    pub small_step: f64,
    /// Newton steps allowed.
    pub max_iterations: usize,
}

/// The solver; owns the bordered matrix with its factors.
#[derive(Clone, Debug)]
pub struct Bordered {
    dof: usize,
    /// The multipliers of the state found last.
    pub multipliers: Vec<f64>,
    /// Free coordinates, held fixed.
    pinned: Vec<usize>,
    /// Load without the multipliers.
    base: Vec<f64>,
    load: Vec<f64>,
    /// ∂c/∂q of each constraint, actual coordinates.
    gradients: Vec<Vec<f64>>,
    /// ∂c/∂μ of each.
    by_multiplier: Vec<f64>,
    residual: Vec<f64>,
    matrix: BorderedMatrix,
    step: Vec<f64>,
    probe: [Vec<f64>; 2],
}

impl Bordered {
    /// For `constraints` constraints on a state of `dof` coordinates under `inputs` loads.
    pub fn new(dof: usize, inputs: usize, constraints: usize) -> Self {
        let size = dof + constraints;
        Self {
            dof,
            multipliers: vec![0.0; constraints],
            pinned: vec![],
            base: vec![0.0; inputs],
            load: vec![0.0; inputs],
            gradients: vec![vec![0.0; dof]; constraints],
            by_multiplier: vec![0.0; constraints],
            residual: vec![0.0; size],
            matrix: BorderedMatrix::new(dof, constraints),
            step: vec![0.0; size],
            probe: [vec![0.0; dof], vec![0.0; dof]],
        }
    }

    /// The load that the multipliers are added to.
    pub fn set_base_load(&mut self, base: &[f64]) {
        self.base.copy_from_slice(base);
    }

    /// Sets the free coordinates that are held fixed.
    pub(super) fn pin(&mut self, coordinates: &[usize]) {
        self.pinned.extend_from_slice(coordinates);
    }

    /// Newton's method with full steps from the system's state and the current multipliers; whether it
    /// converged. Then tangent and factors are those of the state found.
    pub fn solve<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        borders: &[Border],
        target: BorderedTarget,
    ) -> bool {
        let (mut last, mut length) = (f64::INFINITY, f64::INFINITY);
        let mut size = self.evaluate(system, borders);
        for _ in 0..=target.max_iterations {
            if !size.is_finite() {
                return false;
            }
            self.factorise(system, borders);
            // If a step does not lower the residual, it may be rounding.
            let settled = length <= target.small_step && size > 0.5 * last;
            if self.has_converged(system, borders, size, target.tolerance, settled) {
                return true;
            }
            (last, length) = (size, self.advance(system, borders));
            if !length.is_finite() {
                return false;
            }
            size = self.evaluate(system, borders);
            // Chord steps, while the tangent hardly changes.
            let mut contraction = size / last;
            while size > target.tolerance
                && contraction < CHORD_CONTRACTION
                && size * contraction.powi(MAX_CHORDS_LEFT) <= target.tolerance
            {
                (last, length) = (size, self.advance(system, borders));
                size = self.evaluate(system, borders);
                contraction = size / last;
            }
        }
        false
    }

    /// Newton's method with the forces of stiff terms as unknowns too, as in [`super::mixed_newton`], from forces that
    /// are kept; whether it came so close that the method for the energy can take over.
    pub(super) fn approach<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        borders: &[Border],
        motion: &mut PointMotion<D, P>,
        options: MixedOptions,
    ) -> bool {
        for _ in 0..options.max_iterations {
            if !self.evaluate_by(system, borders, |system| system.evaluate_two_sided()).is_finite() {
                return false;
            }
            system.evaluate_tangent_with_kept_forces();
            self.assemble(system, borders);
            if !self.solve_for_step() {
                return false;
            }
            system.complete_columns();
            motion.update(system, &self.step[..self.dof]);
            system.keep_forces(&motion.velocities());
            if !self.take_step(system, borders).is_finite() {
                return false;
            }
            if self.evaluate(system, borders) <= options.residual {
                return true;
            }
        }
        false
    }

    /// Makes a step with the current factors; returns its length, which is not finite where they are singular.
    fn advance<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        borders: &[Border],
    ) -> f64 {
        if self.solve_for_step() { self.take_step(system, borders) } else { f64::INFINITY }
    }

    /// Finds the step to the zero of the linearised equations; `false` where the factors are singular.
    fn solve_for_step(&mut self) -> bool {
        self.step.iter_mut().zip(&self.residual).for_each(|(s, r)| *s = -r);
        self.pinned.iter().for_each(|c| self.step[*c] = 0.0);
        self.matrix.solve(&mut self.step)
    }

    /// Makes the step found; returns its length.
    fn take_step<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        borders: &[Border],
    ) -> f64 {
        let (state, multipliers) = self.step.split_at(self.dof);
        system.advance(state);
        let energy = system.unit_energy();
        for ((multiplier, step), border) in self.multipliers.iter_mut().zip(multipliers).zip(borders) {
            let unit = if matches!(border.multiplier, Multiplier::Reaction) { energy } else { 1.0 };
            *multiplier += unit * step;
        }
        max_norm(state)
    }

    /// Whether constraints hold and forces balance, the largest residual being `size`.
    fn has_converged<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        system: &mut System<G, D, P>,
        borders: &[Border],
        size: f64,
        tolerance: f64,
        settled: bool,
    ) -> bool {
        if borders.iter().any(|border| matches!(border.multiplier, Multiplier::Reaction)) {
            // With reactions the forces alone do not balance.
            return size <= tolerance || settled;
        }
        let held = max_norm(&self.residual[self.dof..]) <= tolerance;
        held && (system.has_converged(size, tolerance) || settled && system.is_balanced(tolerance))
    }

    /// Evaluates and factorises everything at the system's state and the current multipliers.
    pub fn visit<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        borders: &[Border],
    ) {
        self.evaluate(system, borders);
        self.factorise(system, borders);
    }

    /// Evaluates residual and constraints at the system's state; returns the largest of them.
    fn evaluate<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        borders: &[Border],
    ) -> f64 {
        self.evaluate_by(system, borders, |system| system.evaluate())
    }

    fn evaluate_by<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        borders: &[Border],
        evaluate: impl FnOnce(&mut System<G, D, P>) -> f64,
    ) -> f64 {
        let n = self.dof;
        self.load.copy_from_slice(&self.base);
        for (border, mu) in borders.iter().zip(&self.multipliers) {
            if let Multiplier::Load(change) = border.multiplier {
                self.load.iter_mut().zip(change).for_each(|(u, d)| *u += mu * d);
            }
        }
        system.set_load(&self.load);
        let size = evaluate(system);
        if !size.is_finite() {
            return f64::NAN;
        }
        let mut reacts = false;
        self.residual[..n].copy_from_slice(system.residual());
        for (i, border) in borders.iter().enumerate() {
            let mu = self.multipliers[i];
            self.residual[n + i] = border.constraint.value(system.state(), mu);
            let gradient = &mut self.gradients[i];
            self.by_multiplier[i] = border.constraint.gradient(system.state(), mu, gradient);
            if matches!(border.multiplier, Multiplier::Reaction) {
                reacts = true;
                let reaction = mu / system.unit_energy();
                for (r, (c, u)) in self.residual.iter_mut().zip(gradient.iter().zip(system.units())) {
                    *r += reaction * c * u;
                }
            }
        }
        let held = max_norm(&self.residual[n..]);
        held.max(if reacts { max_norm(&self.residual[..n]) } else { size })
    }

    /// Evaluates and factorises the bordered matrix, after residual and constraints.
    fn factorise<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        borders: &[Border],
    ) {
        system.evaluate_tangent();
        self.assemble(system, borders);
    }

    /// Assembles and factorises the bordered matrix from the tangent at hand.
    fn assemble<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        borders: &[Border],
    ) {
        let n = self.dof;
        system.complete_tangent();
        let (energy, units, tangent) = (system.unit_energy(), system.units(), system.data().tangent());
        if let Some(projected) = system.projected_matrix() {
            self.matrix.tangent = projected;
        } else {
            let rows = self.matrix.tangent.chunks_exact_mut(n.max(1)).zip(tangent.chunks_exact(n.max(1)));
            for ((row, source), unit) in rows.zip(units) {
                let scale = unit / energy;
                row.iter_mut().zip(source).zip(units).for_each(|((h, t), u)| *h = t * u * scale);
            }
        }
        for (k, border) in borders.iter().enumerate() {
            let matrix = &mut self.matrix;
            for (row, (c, u)) in matrix.rows[k].iter_mut().zip(self.gradients[k].iter().zip(units)) {
                *row = c * u;
            }
            matrix.corners[k] = self.by_multiplier[k];
            match border.multiplier {
                Multiplier::Reaction => {
                    matrix.columns[k].copy_from_slice(&matrix.rows[k]);
                    matrix.corners[k] *= energy;
                    self.add_curvature(system, border.constraint, self.multipliers[k]);
                }
                Multiplier::Load(change) => system.load_gradient(change, &mut matrix.columns[k]),
            }
        }
        self.pinned.iter().for_each(|c| self.matrix.pin(*c));
        self.matrix.factorise(system.is_conservative() && !system.is_projected());
    }

    /// Adds μ ∇²c to the tangent's part of the matrix.
    fn add_curvature<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &System<G, D, P>,
        constraint: &dyn Constraint,
        multiplier: f64,
    ) {
        let (energy, units) = (system.unit_energy(), system.units());
        let [unit_vector, product] = &mut self.probe;
        for j in 0..self.dof {
            unit_vector.fill(0.0);
            product.fill(0.0);
            unit_vector[j] = 1.0;
            constraint.add_hessian_product(system.state(), unit_vector, multiplier, product);
            for (i, h) in product.iter().enumerate() {
                self.matrix.tangent[i * self.dof + j] += h * units[i] * units[j] / energy;
            }
        }
    }

    /// Solves with the bordered matrix, in place: dimensionless coordinates, then multipliers (a reaction
    /// in units of the reference energy). `false` where it is singular.
    pub fn solve_step(&self, b: &mut [f64]) -> bool {
        self.matrix.solve(b)
    }

    /// The adjoint of an output y(q, μ): given ∂y/∂q and ∂y/∂μ, λ in actual coordinates and ν with
    ///
    /// ```text
    /// dy/dp = ∂y/∂p − λᵀ ∂g/∂p − νᵀ ∂c/∂p,
    /// ```
    ///
    /// at the state found last, in place. `false` where the bordered matrix is singular.
    pub fn solve_adjoint<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        system: &System<G, D, P>,
        borders: &[Border],
        by_state: &mut [f64],
        by_multiplier: &mut [f64],
    ) -> bool {
        let (n, energy, units) = (self.dof, system.unit_energy(), system.units());
        let reaction = |i: usize| matches!(borders[i].multiplier, Multiplier::Reaction);
        let mut b: Vec<f64> = by_state.iter().zip(units).map(|(y, u)| y * u).collect();
        b.extend(by_multiplier.iter().enumerate().map(|(i, y)| if reaction(i) { y * energy } else { *y }));
        let solved = self.matrix.solve_transposed(&mut b);
        for ((y, x), u) in by_state.iter_mut().zip(&b).zip(units) {
            *y = x * u / energy;
        }
        by_multiplier.copy_from_slice(&b[n..]);
        solved
    }

    /// Number of unstable directions of the state found last: negative eigenvalues of the tangent with
    /// the curvature of the constraints, on the motions that the reactions leave free. (Without a
    /// potential, eigenvalues with a negative real part.) An unknown load adds no stiffness:
    /// the count is that under its value.
    ///
    /// `None` where the eigenvalues cannot be found.
    pub fn negative_directions(&self, symmetric: bool, borders: &[Border]) -> Option<usize> {
        let n = self.dof;
        let mut hessian = DMatrix::from_row_slice(n, n, &self.matrix.tangent);
        let mut held = 0;
        let reactions =
            borders.iter().enumerate().filter(|(_, b)| matches!(b.multiplier, Multiplier::Reaction));
        let mut normals: Vec<DVector<f64>> =
            reactions.map(|(k, _)| DVector::from_column_slice(&self.matrix.rows[k])).collect();
        // Householder's reflections turn the gradients into the first axes, one after another.
        for k in 0..normals.len() {
            let mut mirror = normals[k].clone();
            mirror.rows_mut(0, held).fill(0.0);
            let length = mirror.norm();
            if length <= f64::EPSILON * normals[k].norm() * n as f64 {
                continue;
            }
            mirror[held] += length.copysign(mirror[held]);
            mirror.normalize_mut();
            for normal in &mut normals[k + 1..] {
                normal.axpy(-2.0 * mirror.dot(normal), &mirror, 1.0);
            }
            let left = mirror.transpose() * &hessian;
            hessian -= 2.0 * &mirror * left;
            let right = &hessian * &mirror;
            hessian -= 2.0 * right * mirror.transpose();
            held += 1;
        }
        let free = hessian.view((held, held), (n - held, n - held)).into_owned();
        if !free.iter().all(|x| x.is_finite()) {
            return None;
        }
        let sweeps = 60 * n.max(10);
        if symmetric {
            let found = SymmetricEigen::try_new(free, f64::EPSILON, sweeps)?;
            Some(found.eigenvalues.iter().filter(|e| **e < 0.0).count())
        } else {
            let found = Schur::try_new(free, f64::EPSILON, sweeps)?;
            Some(found.complex_eigenvalues().iter().filter(|e| e.re < 0.0).count())
        }
    }
}

impl std::fmt::Debug for Border<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Border").field("multiplier", &self.multiplier).finish_non_exhaustive()
    }
}

/// A hyperplane across the branch: n·(q − q₀) + n_μ (μ − μ₀) = distance.
#[derive(Clone, Debug, Default)]
pub struct Hyperplane {
    /// n.
    pub normal: Vec<f64>,
    /// n_μ.
    pub along_multiplier: f64,
    /// q₀.
    pub origin: Vec<f64>,
    /// μ₀.
    pub multiplier: f64,
    /// How far from the origin it lies.
    pub distance: f64,
}

impl Constraint for Hyperplane {
    fn value(&self, q: &[f64], multiplier: f64) -> f64 {
        let moved = self.normal.iter().zip(q.iter().zip(&self.origin)).map(|(n, (q, o))| n * (q - o));
        moved.sum::<f64>() + self.along_multiplier * (multiplier - self.multiplier) - self.distance
    }

    fn gradient(&self, _q: &[f64], _multiplier: f64, out: &mut [f64]) -> f64 {
        out.copy_from_slice(&self.normal);
        self.along_multiplier
    }
}

/// The multiplier has this value: an ordinary equilibrium at a given load.
#[derive(Clone, Copy, Debug)]
pub struct Prescribed(pub f64);

impl Constraint for Prescribed {
    fn value(&self, _q: &[f64], multiplier: f64) -> f64 {
        multiplier - self.0
    }

    fn gradient(&self, _q: &[f64], _multiplier: f64, out: &mut [f64]) -> f64 {
        out.fill(0.0);
        1.0
    }
}

/// Length of a vector of coordinates and a multiplier, the latter with a weight.
pub(super) fn weighted_dot(a: &[f64], b: &[f64], weight: f64) -> f64 {
    let n = a.len() - 1;
    dot(&a[..n], &b[..n]) + weight * weight * a[n] * b[n]
}
