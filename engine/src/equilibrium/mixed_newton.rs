//! Newton's method with the forces of stiff springs and contacts as unknowns.
//!
//! Over a step p a stiff term of stiffness k misses its distance by the curvature of its path, |p|²/2R, and
//! k times that is no force that acts: it would bend the tangent and stop Newton's method unless p were of the
//! size of √(R f/k). So forces λ are unknowns beside the coordinates,
//!
//! ```text
//! [ H(q, λ)    G  ] [ dq ]     [ g(q) + G λ ]
//! [   Gᵀ     −1/k ] [ dλ ] = − [  d − λ/k   ],
//! ```
//!
//! with G the gradients of the distances d. Eliminated, (H + k G Gᵀ) dq = −(g + k d G) and
//! λ + dλ = k (d + Gᵀ dq): Newton's method on the energy itself but for the λ in H. A contact acts as long as
//! its λ pushes, whatever the sign of its distance, and one that is met in between is added.

use super::options::{MixedOptions, NewtonOptions};
use super::point_motion::PointMotion;
use super::system::System;
use super::vector::max_norm;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::Model;

/// The method, with its memory.
#[derive(Clone, Debug)]
pub(super) struct MixedNewton<const D: usize, const P: usize> {
    options: MixedOptions,
    newton: NewtonOptions,
    step: Vec<f64>,
    motion: PointMotion<D, P>,
}

/// What an approach to an equilibrium has reached.
pub(super) struct Approach {
    /// Largest residual.
    pub size: f64,
    /// Sum of the steps' lengths.
    pub length: f64,
}

impl<const D: usize, const P: usize> MixedNewton<D, P> {
    pub fn new<G: LieGroup<D, P>>(
        model: &Model<G, D, P>,
        options: MixedOptions,
        newton: NewtonOptions,
    ) -> Self {
        Self { options, newton, step: vec![0.0; model.dof()], motion: PointMotion::new(model) }
    }

    /// Takes the forces of the system's state for the first λ.
    pub fn start<G: LieGroup<D, P>>(&mut self, system: &mut System<G, D, P>) {
        system.evaluate();
        self.motion.points.fill(Vector::ZERO);
        system.keep_forces(&self.motion.points);
    }

    /// Goes from the system's state to where Newton's method on the energy itself will do; `None` where that
    /// is not found within `reach`, or a tangent on the way is not positive definite.
    pub fn approach<G: LieGroup<D, P>>(
        &mut self,
        system: &mut System<G, D, P>,
        reach: f64,
    ) -> Option<Approach> {
        let (mut total, mut before) = (0.0, f64::INFINITY);
        for _ in 0..self.options.max_iterations {
            if !system.evaluate_two_sided().is_finite() {
                return None;
            }
            system.evaluate_tangent_with_kept_forces();
            if !system.factorise(0.0) {
                return None;
            }
            system.newton_step(&mut self.step);
            let length = max_norm(&self.step);
            total += length;
            if !(total <= reach) {
                return None;
            }
            system.complete_columns();
            self.motion.update(system, &self.step);
            system.keep_forces(&self.motion.points);
            system.advance(&self.step);
            let size = system.evaluate();
            let settled = length <= self.newton.small_step && !(size < self.newton.progress * before);
            if size <= self.options.residual || settled {
                return Some(Approach { size, length: total });
            }
            before = size;
        }
        None
    }
}
