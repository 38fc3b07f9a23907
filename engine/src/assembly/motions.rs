//! Per-frame motion terms: the residual by the principle of virtual work, Jacobian columns and the
//! curvature of each frame's motion.

use super::Assembly;
use crate::forces::state::State;
use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};

impl<const D: usize, const P: usize> Assembly<D, P> {
    /// Sums wrenches over all frames that each frame carries, w̄, and adds Sᵀ w̄ to the gradient, S =
    /// Ad T dΩ/dq being the columns of the frame's motion.
    pub(super) fn pull_back<G: LieGroup<D, P>>(
        &mut self,
        State { tree, geometry, kinematics, .. }: &State<G, D, P>,
    ) {
        self.pulled.fill(Vector::ZERO);
        for (f, frame) in tree.frames.iter().enumerate().skip(1).rev() {
            if !self.terms.frames.loaded[f] {
                continue;
            }
            let wrench = self.terms.frames.wrench[f];
            if frame.parent != 0 {
                self.terms.frames.loaded[frame.parent] = true;
                self.terms.frames.wrench[frame.parent] += wrench;
            }
            if frame.blocks.is_empty() {
                continue;
            }
            let body_wrench = G::operate_dual(&kinematics.pose[f].adjoint(), &wrench);
            let tangent = G::tangent(&kinematics.omega[f], &kinematics.stumpff[f]);
            let dual = G::operate_dual(&tangent, &body_wrench);
            self.duals[f] = [body_wrench, dual];
            let (a1, a2, _) = kinematics.motion_derivative(tree, f);
            let [one, two] = [a1, a2].map(|a| G::operate_dual(&a, &dual));
            let maps = &geometry.strain_maps[frame.blocks.clone()];
            for (pulled, [phi1, phi2]) in self.pulled[frame.coordinates.clone()].iter_mut().zip(maps) {
                *pulled += phi1.transpose_times(&one) + phi2.transpose_times(&two);
            }
        }
        tree.coordinate_blocks.scatter(&self.pulled, &mut self.terms.coordinates.gradient);
    }

    /// Expands the motions of all frames that carry a load or whose Jacobian is stored.
    pub(super) fn expand_motions<G: LieGroup<D, P>>(&mut self, at: &State<G, D, P>) {
        let State { tree, kinematics, .. } = at;
        for (f, frame) in tree.frames.iter().enumerate().skip(1) {
            let loaded = self.terms.frames.loaded[f];
            self.expanded[f] = loaded || tree.leads_to_kept[f];
            if frame.blocks.is_empty() || !self.expanded[f] {
                continue;
            }
            let commutator = self.expand_motion(at, f);
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
        State { tree, geometry, kinematics, .. }: &State<G, D, P>,
        f: usize,
    ) -> f64 {
        let (a1, a2, commutator) = kinematics.motion_derivative(tree, f);
        let tangent = G::tangent(&kinematics.omega[f], &kinematics.stumpff[f]);
        let operator = G::operate(&kinematics.pose[f].adjoint(), &tangent);
        for block in tree.frames[f].blocks.clone() {
            let [phi1, phi2] = &geometry.strain_maps[block];
            let motion = G::operate(&a1, phi1) + G::operate(&a2, phi2);
            self.motions[block] = motion;
            self.columns[block] = G::operate(&operator, &motion);
        }
        commutator
    }
}
