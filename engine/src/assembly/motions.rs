//! What every frame's own motion makes of the wrench it carries: gradient, columns, curvature.

use super::Assembly;
use crate::design::Design;
use crate::kinematics::Kinematics;
use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};
use crate::model::Model;

impl<const D: usize, const P: usize> Assembly<D, P> {
    /// Sums wrenches over all frames that each frame carries, w̄, and adds Sᵀ w̄ to the gradient, S =
    /// Ad T dΩ/dq being the columns of the frame's motion.
    pub(super) fn pull_back<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        kinematics: &Kinematics<G, D, P>,
    ) {
        self.pulled.fill(Vector::ZERO);
        for (f, frame) in model.frames.iter().enumerate().skip(1).rev() {
            if !self.frames.loaded[f] {
                continue;
            }
            let wrench = self.frames.wrench[f];
            if frame.parent != 0 {
                self.frames.loaded[frame.parent] = true;
                self.frames.wrench[frame.parent] += wrench;
            }
            if frame.blocks.is_empty() {
                continue;
            }
            let body_wrench = kinematics.pose[f].adjoint().transpose_times(&wrench);
            let tangent = G::tangent(&kinematics.omega[f], &kinematics.stumpff[f]);
            let dual = tangent.transpose_times(&body_wrench);
            self.duals[f] = [body_wrench, dual];
            let (a1, a2, _) = kinematics.motion_derivative(model, f);
            let (one, two) = (a1.transpose_times(&dual), a2.transpose_times(&dual));
            let maps = &design.strain_maps[frame.blocks.clone()];
            for (pulled, [phi1, phi2]) in self.pulled[frame.coordinates.clone()].iter_mut().zip(maps) {
                *pulled += phi1.transpose_times(&one) + phi2.transpose_times(&two);
            }
        }
        model.coordinate_blocks.scatter(&self.pulled, &mut self.coordinates.gradient);
    }

    /// Expands the motions of all frames that carry something or are asked for their Jacobian.
    pub(super) fn expand_motions<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        kinematics: &Kinematics<G, D, P>,
    ) {
        for (f, frame) in model.frames.iter().enumerate().skip(1) {
            let loaded = self.frames.loaded[f];
            self.expanded[f] = loaded || model.leads_to_kept[f];
            if frame.blocks.is_empty() || !self.expanded[f] {
                continue;
            }
            let commutator = self.expand_motion(model, design, kinematics, f);
            if loaded {
                let [body_wrench, dual] = &self.duals[f];
                let (omega, stumpff) = (&kinematics.omega[f], &kinematics.stumpff[f]);
                self.curvature[f] = G::tangent_curvature(omega, body_wrench, stumpff) * 0.5;
                self.bracket[f] =
                    if commutator == 0.0 { Matrix::ZERO } else { G::bracket_form(dual) * commutator };
            }
        }
    }

    /// A frame's columns, as changes dΩ of its motion and as world columns S; returns κ.
    ///
    /// dΩ = A₁ dξ₁ + A₂ dξ₂ + κ [dξ₁, dξ₂], dξ = Φ dq, and S = Ad T dΩ.
    #[inline(always)]
    pub(super) fn expand_motion<G: LieGroup<D, P>>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        kinematics: &Kinematics<G, D, P>,
        f: usize,
    ) -> f64 {
        let (a1, a2, commutator) = kinematics.motion_derivative(model, f);
        let tangent = G::tangent(&kinematics.omega[f], &kinematics.stumpff[f]);
        let operator = kinematics.pose[f].adjoint() * tangent;
        for block in model.frames[f].blocks.clone() {
            let [phi1, phi2] = &design.strain_maps[block];
            let motion = a1 * *phi1 + a2 * *phi2;
            self.motions[block] = motion;
            self.columns[block] = operator * motion;
        }
        commutator
    }
}
