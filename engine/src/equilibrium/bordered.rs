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

use super::system::System;
use super::vector::{dot, max_norm};
use crate::lie::LieGroup;
use nalgebra::{DMatrix, DVector, Dyn, LU, Schur, SymmetricEigen};

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

/// The solver; owns the bordered matrix and its factors.
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
    residual: DVector<f64>,
    matrix: DMatrix<f64>,
    lu: LU<f64, Dyn, Dyn>,
    step: DVector<f64>,
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
            residual: DVector::zeros(size),
            matrix: DMatrix::zeros(size, size),
            lu: DMatrix::zeros(0, 0).lu(),
            step: DVector::zeros(size),
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
        for _ in 0..=target.max_iterations {
            let size = self.evaluate(system, borders);
            if !size.is_finite() {
                return false;
            }
            self.factorise(system, borders);
            // If a step does not lower the residual, it may be rounding.
            let settled = length <= target.small_step && size > 0.5 * last;
            if self.has_converged(system, borders, size, target.tolerance, settled) {
                return true;
            }
            self.step.copy_from(&self.residual);
            self.step.neg_mut();
            self.pinned.iter().for_each(|c| self.step[*c] = 0.0);
            if !self.lu.solve_mut(&mut self.step) {
                return false;
            }
            length = max_norm(&self.step.as_slice()[..self.dof]);
            if !length.is_finite() {
                return false;
            }
            last = size;
            system.advance(&self.step.as_slice()[..self.dof]);
            let energy = system.unit_energy();
            for (i, border) in borders.iter().enumerate() {
                let unit = if matches!(border.multiplier, Multiplier::Reaction) { energy } else { 1.0 };
                self.multipliers[i] += unit * self.step[self.dof + i];
            }
        }
        false
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
        let held = max_norm(&self.residual.as_slice()[self.dof..]) <= tolerance;
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
        let n = self.dof;
        self.load.copy_from_slice(&self.base);
        for (border, mu) in borders.iter().zip(&self.multipliers) {
            if let Multiplier::Load(change) = border.multiplier {
                self.load.iter_mut().zip(change).for_each(|(u, d)| *u += mu * d);
            }
        }
        system.set_load(&self.load);
        let size = system.evaluate();
        if !size.is_finite() {
            return f64::NAN;
        }
        let mut reacts = false;
        self.residual.as_mut_slice()[..n].copy_from_slice(system.residual());
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
        let held = max_norm(&self.residual.as_slice()[n..]);
        held.max(if reacts { max_norm(&self.residual.as_slice()[..n]) } else { size })
    }

    /// Evaluates and factorises the bordered matrix, after residual and constraints.
    fn factorise<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        system: &mut System<G, D, P>,
        borders: &[Border],
    ) {
        let n = self.dof;
        system.evaluate_tangent();
        system.complete_tangent();
        let (energy, units, tangent) = (system.unit_energy(), system.units(), system.data().tangent());
        self.matrix.fill(0.0);
        // Columns of the matrix are contiguous; so are rows of the tangent.
        for (j, mut column) in self.matrix.column_iter_mut().take(n).enumerate() {
            let scale = units[j] / energy;
            let entries = tangent.iter().skip(j).step_by(n).zip(units);
            column.iter_mut().zip(entries).for_each(|(h, (t, u))| *h = t * u * scale);
        }
        for (k, border) in borders.iter().enumerate() {
            for (i, (c, u)) in self.gradients[k].iter().zip(units).enumerate() {
                self.matrix[(n + k, i)] = c * u;
            }
            self.matrix[(n + k, n + k)] = self.by_multiplier[k];
            match border.multiplier {
                Multiplier::Reaction => {
                    for (i, (c, u)) in self.gradients[k].iter().zip(units).enumerate() {
                        self.matrix[(i, n + k)] = c * u;
                    }
                    self.matrix[(n + k, n + k)] *= energy;
                    self.add_curvature(system, border.constraint, self.multipliers[k]);
                }
                Multiplier::Load(change) => {
                    let column = &mut self.probe[0];
                    system.load_gradient(change, column);
                    for (i, b) in column.iter().enumerate() {
                        self.matrix[(i, n + k)] = *b;
                    }
                }
            }
        }
        for &c in &self.pinned {
            self.matrix.row_mut(c).fill(0.0);
            self.matrix.column_mut(c).fill(0.0);
            self.matrix[(c, c)] = 1.0;
        }
        self.lu = self.matrix.clone().lu();
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
                self.matrix[(i, j)] += h * units[i] * units[j] / energy;
            }
        }
    }

    /// Solves with the bordered matrix, in place: dimensionless coordinates, then multipliers (a reaction
    /// in units of the reference energy). `false` where it is singular.
    pub fn solve_step(&self, b: &mut [f64]) -> bool {
        self.step_from(b, |lu, x| lu.solve_mut(x))
    }

    fn step_from(
        &self,
        b: &mut [f64],
        solve: impl Fn(&LU<f64, Dyn, Dyn>, &mut DVector<f64>) -> bool,
    ) -> bool {
        let mut x = DVector::from_column_slice(b);
        let solved = solve(&self.lu, &mut x);
        b.copy_from_slice(x.as_slice());
        solved && b.iter().all(|x| x.is_finite())
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
        let solved = self.step_from(&mut b, |lu, x| {
            // P A = L U, so Aᵀ = Uᵀ Lᵀ P.
            let (l, u) = (lu.l(), lu.u());
            let solved = u.tr_solve_upper_triangular_mut(x) && l.tr_solve_lower_triangular_mut(x);
            lu.p().inv_permute_rows(x);
            solved
        });
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
        let mut hessian = self.matrix.view((0, 0), (n, n)).into_owned();
        let mut held = 0;
        let reactions =
            borders.iter().enumerate().filter(|(_, b)| matches!(b.multiplier, Multiplier::Reaction));
        let mut normals: Vec<DVector<f64>> = reactions
            .map(|(k, _)| self.matrix.view((n + k, 0), (1, n)).transpose().column(0).into_owned())
            .collect();
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
