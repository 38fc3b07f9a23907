//! The first equilibrium under loads without a potential, by steps of these loads.
//!
//! The overdamped motion from the initial state may end in a cycle though there is a stable equilibrium. It is then
//! looked for on the branch that begins at a minimum of the energy without these loads.

use super::continuation::Continuation;
use super::status::Status;
use super::system::System;
use crate::lie::LieGroup;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Continuation<'_, G, D, P> {
    /// A stable equilibrium near the current state, in which a path begins.
    pub(super) fn find_first(&mut self, radius: f64, tangent_reuse: f64) -> Status {
        let start = self.system.state().to_vec();
        let found = self.find_stable(radius, tangent_reuse);
        let lost = matches!(found, Status::Stalled | Status::Diverged | Status::Unstable);
        if !lost || self.system.is_conservative() {
            return found;
        }
        let fallback = self.system.state().to_vec();
        self.system.set_state(&start);
        let loads = self.system.loads_without_potential();
        let stepped = self.find_by_load_steps(&loads, radius);
        self.system.scale_loads(&loads, 1.0);
        if matches!(stepped, Status::Converged | Status::Cancelled) {
            return stepped;
        }
        self.system.set_state(&fallback);
        self.system.evaluate();
        self.system.evaluate_tangent();
        self.system.factorise(0.0);
        found
    }

    /// Minimises the energy without these loads and adds them in parts, halved where Newton's method fails or
    /// stability is lost.
    fn find_by_load_steps(&mut self, loads: &[(usize, f64)], radius: f64) -> Status {
        let options = self.options.damped_newton;
        self.system.scale_loads(loads, 0.0);
        let mut general = None;
        self.system.factor.swap_general(&mut general);
        let mut status = self.find_stable(radius, 0.0);
        self.system.factor.swap_general(&mut general);
        let mut state = self.system.state().to_vec();
        let (mut share, mut part) = (0.0, options.first_part);
        for _ in 0..options.max_parts {
            if status != Status::Converged || share == 1.0 {
                return status;
            }
            let next = f64::min(share + part, 1.0);
            self.system.scale_loads(loads, next);
            if self.damped_newton.correct(&mut self.system, self.options.tolerance) {
                state.copy_from_slice(self.system.state());
                share = next;
                part *= 2.0;
            } else {
                self.system.set_state(&state);
                part *= 0.5;
                if let Some(exhausted) = self.system.budget.exhausted() {
                    status = exhausted;
                }
            }
        }
        if share == 1.0 { status } else { Status::Stalled }
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> System<'_, G, D, P> {
    /// The parameters of loads without a potential, and their values.
    fn loads_without_potential(&self) -> Vec<(usize, f64)> {
        let parameters = &self.data.design.geometry.parameters;
        let slots = self.model.forces.wrenches.without_potential::<P>();
        slots.map(|slot| (slot, parameters[slot])).collect()
    }

    /// Sets these to a share of their values.
    fn scale_loads(&mut self, loads: &[(usize, f64)], share: f64) {
        for (slot, value) in loads {
            self.data.design.geometry.parameters[*slot] = share * value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::ContinuationOptions;
    use crate::lie::SE2;
    use crate::model::{AttachmentDescription, Model, Station, WrenchDescription, WrenchFrame};
    use crate::systems::finger;

    #[test]
    fn load_steps_lead_to_the_equilibrium_of_all_loads() {
        let mut described = finger();
        described.wrenches.push(WrenchDescription {
            name: "push".into(),
            at: AttachmentDescription::Body {
                body: "exosuit".into(),
                station: Station::Point(20),
                offset: [0.0; 3],
                surface: [0.0; 3],
            },
            force: [0.0, 0.0, 0.2],
            moment: [0.0, 0.001, 0.0],
            frame: WrenchFrame::Body,
            input: false,
            turns: false,
        });
        let model = Model::<SE2, 3, 2>::new(&described).unwrap();
        let mut path = Continuation::<SE2, 3, 2>::new(&model, ContinuationOptions::default(), None);
        path.system.set_load(&[0.5]);
        assert_eq!(path.find_stable(1.0, 0.0), Status::Converged);
        let expected = path.system.state().to_vec();
        let loads = path.system.loads_without_potential();
        assert_eq!(
            loads.iter().map(|(_, value)| *value).collect::<Vec<_>>(),
            [0.0, 0.0, 0.2, 0.0, 0.001, 0.0]
        );
        path.system.set_state(&vec![0.0; model.dof()]);
        assert_eq!(path.find_by_load_steps(&loads, 1.0), Status::Converged);
        assert_eq!(path.system.loads_without_potential(), loads);
        assert!(!path.system.is_conservative());
        let difference = path.system.state().iter().zip(&expected).map(|(a, b)| (a - b).abs());
        assert!(difference.fold(0.0, f64::max) < 1e-6);
    }
}
