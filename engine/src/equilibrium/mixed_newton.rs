//! Mixed Newton method: the forces of stiff springs and contacts are unknowns beside the coordinates.
//!
//! In Newton's method for the energy alone, a step p changes the distance d of a stiff term by a second-order
//! error |p|²/2R, with R the radius of curvature of its path. Multiplied by the stiffness k, this spurious
//! force limits the steps to √(R f/k), f being the actual force. Therefore the forces λ are unknowns as well,
//!
//! ```text
//! [ H(q, λ)    G  ] [ dq ]     [ g(q) + G λ ]
//! [   Gᵀ     −1/k ] [ dλ ] = − [  d − λ/k   ],
//! ```
//!
//! with G the gradients of the distances d. Elimination of dλ leaves (H + k G Gᵀ) dq = −(g + k d G) and
//! λ + dλ = k (d + Gᵀ dq): Newton's method for the energy, but with λ in place of k d in H. A contact is
//! active while λ > 0, regardless of the sign of d; contacts that close during the step become active.

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

/// Where an approximate solution ended.
pub(super) struct Approach {
    /// Largest residual.
    pub size: f64,
    /// Sum of the lengths of its steps.
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

    /// Initialises λ with the forces in the system's state.
    pub fn start<G: LieGroup<D, P>>(&mut self, system: &mut System<G, D, P>) {
        system.evaluate();
        self.motion.points.fill(Vector::ZERO);
        system.keep_forces(&self.motion.velocities());
    }

    /// Iterates from the system's state until Newton's method for the energy can take over; `None` if the steps
    /// add up to more than `reach` or a tangent is not positive definite.
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
            system.keep_forces(&self.motion.velocities());
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
