//! Options of the equilibrium solver, with their defaults and the range in which each may lie.
//!
//! The fields of [`ContinuationOptions`] itself are what a user may want to set for one solve; those
//! of the structs in it tune its parts. "Dimensionless" is in the units of [`System`](super::System):
//! one radian of the softest angular coordinate.

use super::option_info::{Interval, OptionError, OptionInfo, OptionValue};

/// Declares a struct of options from one line each: documentation, name, type, default and interval.
macro_rules! options {
    (
        $(#[$about:meta])*
        pub struct $name:ident {
            $($(#[doc = $doc:literal])+ $field:ident: $kind:ty = $default:expr, $interval:expr;)*
        }
        $(parts {
            $($(#[doc = $part_doc:literal])+ $part:ident: $part_type:ty;)+
        })?
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name {
            $($(#[doc = $doc])+ pub $field: $kind,)*
            $($($(#[doc = $part_doc])+ pub $part: $part_type,)+)?
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* $($($part: <$part_type>::default(),)+)? }
            }
        }

        impl $name {
            /// The options of this struct, without those of its parts.
            pub const INFO: &'static [OptionInfo] = &[$(OptionInfo {
                name: stringify!($field),
                doc: concat!($($doc),+),
                interval: $interval,
                integer: <$kind as OptionValue>::INTEGER,
            },)*];

            /// The options' values, in the order of `INFO`.
            pub fn values(&self) -> Vec<f64> {
                vec![$(OptionValue::to_f64(self.$field)),*]
            }

            /// Sets an option of this struct by name.
            ///
            /// # Errors
            /// If no option has this name or the value is out of range.
            pub fn set(&mut self, name: &str, value: f64) -> Result<(), OptionError> {
                let info = Self::INFO.iter().find(|info| info.name == name);
                info.ok_or_else(|| OptionError::unknown(name, Self::INFO))?.check(value)?;
                match name {
                    $(stringify!($field) => self.$field = OptionValue::from_f64(value),)*
                    _ => {}
                }
                Ok(())
            }

            /// Checks all values, including those of the parts.
            ///
            /// # Errors
            /// Names the first option that is out of range.
            pub fn validate(&self) -> Result<(), OptionError> {
                Self::INFO.iter().zip(self.values()).try_for_each(|(info, value)| info.check(value))?;
                $($(self.$part.validate()?;)+)?
                Ok(())
            }
        }
    };
}

options! {
    /// Options of following equilibria along the load.
    pub struct ContinuationOptions {
        /// Largest dimensionless residual of an equilibrium.
        tolerance: f64 = 1e-9, Interval::above(0.0).to(1.0);
        /// Iterations (tangents) allowed for one load step, all its sub-steps together.
        max_iterations: usize = 20_000, Interval::from(1.0).to(1e9);
        /// Seconds allowed for one load step; what is reached by then depends on the machine.
        max_seconds: f64 = f64::INFINITY, Interval::above(0.0).to(f64::INFINITY);
        /// Smallest sub-step along the load, as a fraction of the range of each input over the path.
        min_step: f64 = 1e-3, Interval::above(0.0).to(1.0);
        /// Longest predicted displacement of one sub-step (dimensionless norm over all coordinates).
        max_displacement: f64 = 30.0, Interval::above(0.0).to(1e6);
        /// The same for models with contact.
        max_displacement_with_contact: f64 = 4.0, Interval::above(0.0).to(1e6);
    }
    parts {
        /// Residual and tangent that suffice at the end of a sub-step.
        accuracy: AccuracyOptions;
        /// Length of the sub-steps.
        step: StepOptions;
        /// Prediction through changes of contact.
        predictor: PredictorOptions;
        /// Newton's method from the predicted state.
        corrector: CorrectorOptions;
        /// The test that predictor and corrector stayed on one branch.
        same_branch: SameBranchOptions;
        /// Where branches end.
        locate: LocateOptions;
        /// Jumps from the end of a branch.
        jump: JumpOptions;
        /// Where branches lose their stability.
        critical: CriticalOptions;
        /// Minimisation of the energy.
        trust_region: TrustRegionOptions;
        /// Newton's method for loads without a potential.
        damped_newton: DampedNewtonOptions;
        /// Continuation by arc length.
        arc_length: ArcLengthOptions;
        /// Newton's method with stiff forces as unknowns.
        mixed: MixedOptions;
        /// Newton and chord steps, wherever they are taken.
        newton: NewtonOptions;
    }
}

options! {
    /// Residual and tangent that suffice at the end of a sub-step.
    ///
    /// The tangent of the state before the last step may serve for the state after it, if that step left
    /// little of the residual: H⁻¹ times the difference of the two tangents has this size along the step.
    pub struct AccuracyOptions {
        /// Residual between the listed loads, as a share of the predicted displacement and of the change of
        /// the load,
        relative_residual: f64 = 0.03, Interval::from(0.0).to(1.0);
        /// as a smaller share where the branch is predicted to end,
        residual_near_end: f64 = 1e-4, Interval::from(0.0).to(1.0);
        /// and at most this (dimensionless).
        max_residual: f64 = 0.1, Interval::from(0.0).to(1.0);
        /// Share of the residual that the last step may leave for its tangent to be kept: between the
        /// listed loads,
        tangent_reuse: f64 = 0.3, Interval::from(0.0).to(1.0);
        /// after a jump between them,
        tangent_reuse_after_jump: f64 = 0.1, Interval::from(0.0).to(1.0);
        /// and at listed loads; at the last load the tangent is always that of the state itself.
        tangent_reuse_at_listed: f64 = 0.03, Interval::from(0.0).to(1.0);
    }
}

options! {
    /// Length of the sub-steps between two listed loads.
    pub struct StepOptions {
        /// Where the branch is predicted to end, the first sub-step covers this share of the distance,
        fraction_to_end: f64 = 0.75, Interval::above(0.0).to(1.0);
        /// and the next ones all but this multiple of the error to be expected of the prediction.
        end_margin: f64 = 3.0, Interval::from(1.0).to(100.0);
        /// A sub-step of at most this many smallest ones is not halved any more.
        min_step_margin: f64 = 1.5, Interval::from(1.0).to(10.0);
    }
}

options! {
    /// Where branches end. Lengths are dimensionless norms over all coordinates.
    pub struct LocateOptions {
        /// Accuracy of the load of a limit point, as a fraction of the range of each input over the path,
        located: f64 = 1e-8, Interval::above(0.0).to(1.0);
        /// the distance from which the end in a corner is where it is predicted, as such a fraction,
        end_distance: f64 = 3e-4, Interval::above(0.0).to(1.0);
        /// and how far behind the limit point the next equilibrium is sought.
        beyond: f64 = 1e-5, Interval::above(0.0).to(1.0);
        /// States found on the way to a limit point.
        max_points: usize = 30, Interval::from(1.0).to(1e3);
        /// Largest dimensionless residual of each,
        residual: f64 = 1e-8, Interval::from(0.0).to(1.0);
        /// and Newton steps for it.
        max_iterations: usize = 8, Interval::from(1.0).to(1e3);
        /// Displacement to the first of them, at most
        longest: f64 = 0.15, Interval::above(0.0).to(1e3);
        /// and at least;
        shortest: f64 = 1e-7, Interval::above(0.0).to(1.0);
        /// where none is found it is shortened to this share.
        shrinkage: f64 = 0.25, Interval::above(0.0).to(1.0);
        /// The equilibrium where the search begins is corrected by at most this.
        refinement: f64 = 0.05, Interval::from(0.0).to(1.0);
        /// A state may lie aside of the direction there by this share of the displacement,
        turn: f64 = 0.5, Interval::above(0.0).to(10.0);
        /// and if the displacement is shorter than this
        corner: f64 = 1e-3, Interval::from(0.0).to(1.0);
        /// by this multiple, as behind a corner.
        corner_turn: f64 = 10.0, Interval::above(0.0).to(1e3);
    }
}

options! {
    /// The predictor.
    pub struct PredictorOptions {
        /// Changes of contact that one prediction follows.
        max_contact_changes: usize = 5, Interval::from(0.0).to(1000.0);
        /// Pairs are watched that would meet within the sub-step at this multiple of their closing rate
        closing_rate_margin: f64 = 2.0, Interval::from(1.0).to(1e3);
        /// plus this share of the speed of the fastest point.
        point_speed_margin: f64 = 0.1, Interval::from(0.0).to(1e3);
        /// A curvature is taken over from the last sub-step if the displacement was missed by half the
        /// change of the velocity, to within this share of it,
        curvature_ratio: f64 = 0.25, Interval::from(0.0).to(0.5);
        /// in its direction (cosine of the angle between the two),
        curvature_cosine: f64 = 0.8, Interval::from(0.0).to(1.0);
        /// and the velocity changed by less than this share of itself.
        max_curvature: f64 = 0.3, Interval::from(0.0).to(10.0);
    }
}

options! {
    /// The corrector. Lengths of its steps are compared with the displacement predicted, by the largest
    /// coordinate.
    pub struct CorrectorOptions {
        /// Chord steps with the predicted tangent, before one is evaluated,
        max_predicted_chords: usize = 2, Interval::from(0.0).to(100.0);
        /// each of which must leave less than this share of the residual,
        predicted_chord_contraction: f64 = 0.3, Interval::from(0.0).to(1.0);
        /// and which together go no further than this share of the displacement predicted.
        predicted_chord_reach: f64 = 0.3, Interval::from(0.0).to(10.0);
        /// A chord step longer than this multiple of the displacement rejects the prediction.
        rejection_ratio: f64 = 0.7, Interval::from(0.0).to(100.0);
        /// With a residual below this, a stiffness that is negative by no more than it counts as zero.
        soft_residual: f64 = 1e-2, Interval::from(0.0).to(1.0);
        /// Newton steps: more are rarely needed unless another branch attracts.
        max_iterations: usize = 7, Interval::from(1.0).to(1e6);
        /// All corrections together may go this share of the displacement predicted,
        max_correction: f64 = 0.7, Interval::from(0.0).to(100.0);
        /// and this far (dimensionless) in any case.
        free_correction: f64 = 1e-3, Interval::from(0.0).to(10.0);
        /// No step may be longer than this multiple of the one before.
        max_step_growth: f64 = 2.0, Interval::from(1.0).to(1e3);
    }
}

options! {
    /// The test that a corrected state lies on the branch that was predicted: it is as predicted, or its
    /// displacement agrees with the velocities at both ends.
    pub struct SameBranchOptions {
        /// Share of the displacement by which the prediction may miss it.
        displacement_error: f64 = 0.3, Interval::from(0.0).to(10.0);
        /// Share of the velocity by which the prediction may miss it.
        velocity_error: f64 = 0.7, Interval::from(0.0).to(10.0);
        /// Largest change of the velocity times the sub-step (dimensionless): more could hide a jump.
        max_velocity_change: f64 = 2.5, Interval::from(0.0).to(1e3);
        /// The displacement may differ from the mean of both velocities by this share of their change,
        mean_velocity_error: f64 = 0.6, Interval::from(0.0).to(10.0);
        /// this share of their size,
        relative_error: f64 = 0.05, Interval::from(0.0).to(10.0);
        /// and this (dimensionless).
        absolute_error: f64 = 1e-9, Interval::from(0.0).to(1.0);
    }
}

options! {
    /// Jumps from the end of a branch to another equilibrium.
    pub struct JumpOptions {
        /// It is an event if the state moves (dimensionless) by more than this;
        min_displacement: f64 = 1e-3, Interval::from(0.0).to(10.0);
        /// and more energy is released than this, in its unit, and than where it is convex between both states;
        min_energy: f64 = 1e-11, Interval::from(0.0).to(1.0);
        /// where the end was not found, it moves by that and this multiple of what the velocities explain.
        speed_margin: f64 = 1.5, Interval::from(1.0).to(1e3);
        /// Where another branch crosses, it is a snap if at this share of the way behind the critical load
        earlier: f64 = 0.25, Interval::above(0.0).to(1.0);
        /// the state would have moved by at least this share of the displacement.
        constant_share: f64 = 0.8, Interval::above(0.0).to(1.0);
    }
}

options! {
    /// Where another branch crosses.
    pub struct CriticalOptions {
        /// Chord steps to the equilibrium where the search begins.
        refinements: usize = 3, Interval::from(0.0).to(100.0);
        /// Inverse iterations for the eigenvector of the lowest eigenvalue,
        inverse_iterations: usize = 8, Interval::from(1.0).to(1000.0);
        /// and iterations for that of the eigenvalue which vanishes first.
        power_iterations: usize = 20, Interval::from(0.0).to(1000.0);
        /// Displacement over which the change of the tangent is taken (dimensionless).
        difference: f64 = 1e-4, Interval::above(0.0).to(1.0);
        /// and largest share of the sub-step over which it is taken.
        step_share: f64 = 0.1, Interval::above(0.0).to(1.0);
    }
}

options! {
    /// Minimisation of the energy in a trust region. Radii are dimensionless.
    pub struct TrustRegionOptions {
        /// Radius of the first step.
        initial_radius: f64 = 1.0, Interval::above(0.0).to(1e3);
        /// Largest radius.
        max_radius: f64 = 8.0, Interval::above(0.0).to(1e3);
        /// Radius below which the iteration has stalled.
        min_radius: f64 = 1e-13, Interval::from(0.0).to(1.0);
        /// A step is accepted if it reaches this share of the decrease predicted.
        acceptance_ratio: f64 = 1e-4, Interval::from(0.0).to(0.5);
        /// Decreases below this share of the energy are lost in rounding: the residual decides.
        rounding: f64 = 1e-13, Interval::from(0.0).to(1e-3);
        /// The radius grows after a step that reaches this share of the decrease predicted
        good_ratio: f64 = 0.75, Interval::from(0.0).to(1.0);
        /// and is longer than this share of the radius,
        boundary_share: f64 = 0.8, Interval::from(0.0).to(1.0);
        /// by this factor.
        growth: f64 = 2.0, Interval::from(1.0).to(100.0);
        /// After a step that reaches less than this share, or is rejected, the radius becomes
        poor_ratio: f64 = 0.25, Interval::from(0.0).to(1.0);
        /// this share of the step's length.
        shrinkage: f64 = 0.4, Interval::above(0.0).to(1.0);
        /// After a rejected step shorter than this, rejected steps are improved before they are shortened:
        stiff_radius: f64 = 0.05, Interval::from(0.0).to(10.0);
        /// by so many corrections of second order, which follow the curved valley of a stiff energy,
        max_corrections: usize = 3, Interval::from(0.0).to(100.0);
        /// each of which is at most this share of the step,
        max_correction: f64 = 0.5, Interval::from(0.0).to(1.0);
        /// and by a line search of so many evaluations, as a contact closes on the way,
        max_line_search: usize = 40, Interval::from(0.0).to(1e3);
        /// to where the slope is this share of the decrease predicted.
        line_search_slope: f64 = 1e-2, Interval::from(0.0).to(1.0);
        /// Factorisations allowed for one step.
        max_factorizations: usize = 30, Interval::from(1.0).to(1000.0);
        /// A step's length may differ from the radius by this share of it.
        radius_slack: f64 = 0.25, Interval::above(0.0).to(1.0);
        /// First multiplier tried with an indefinite tangent, as a share of its upper bound.
        first_multiplier: f64 = 1e-2, Interval::above(0.0).to(1.0);
        /// The hard case is assumed where the bounds of the multiplier agree to this share.
        hard_case_gap: f64 = 1e-3, Interval::above(0.0).to(1.0);
        /// Steps in a row that a force may go along a motion that nothing holds.
        max_free_steps: usize = 8, Interval::from(1.0).to(1e6);
        /// Inverse iterations for the direction of negative curvature.
        inverse_iterations: usize = 4, Interval::from(1.0).to(1000.0);
    }
}

options! {
    /// Newton's method with halved steps.
    pub struct DampedNewtonOptions {
        /// Halvings of one step.
        max_halvings: usize = 30, Interval::from(0.0).to(1000.0);
        /// Longest step, by the largest coordinate (dimensionless).
        max_step: f64 = 1.0, Interval::above(0.0).to(1e3);
        /// Implicit steps of the overdamped motion from an unstable state,
        max_relaxation: usize = 1500, Interval::from(0.0).to(1e6);
        /// which begins this far from an equilibrium.
        perturbation: f64 = 1e-3, Interval::above(0.0).to(1.0);
    }
}

options! {
    /// Continuation by arc length.
    pub struct ArcLengthOptions {
        /// Residual (dimensionless) below which a start counts as an equilibrium, stable or not.
        start_residual: f64 = 1e-6, Interval::from(0.0).to(1.0);
        /// Forces may also balance to rounding where a step below this (dimensionless) lowers nothing.
        small_step: f64 = 1e-7, Interval::from(0.0).to(1e-3);
        /// Newton steps of one point.
        max_iterations: usize = 10, Interval::from(1.0).to(1e3);
        /// By how much the branch should turn on one step [rad],
        turn: f64 = 0.12, Interval::above(0.0).to(1.5);
        /// and by how much at most,
        max_turn: f64 = 0.35, Interval::above(0.0).to(3.2);
        /// unless the step is shorter than this share of the first: a corner.
        corner_step: f64 = 1e-3, Interval::from(0.0).to(1.0);
        /// A shorter step than this share of the first is not tried.
        min_step: f64 = 1e-7, Interval::above(0.0).to(1.0);
        /// The next point is at most this multiple of the step away.
        max_reach: f64 = 1.3, Interval::above(1.0).to(10.0);
        /// Points solved to locate a limit point,
        max_locating: usize = 20, Interval::from(1.0).to(1e3);
        /// to this share of the step.
        located: f64 = 1e-7, Interval::above(0.0).to(1.0);
    }
}

options! {
    /// Newton's method with stiff forces as unknowns.
    pub struct MixedOptions {
        /// A spring or contact is stiff if it stores more than this multiple of the energy unit when moved by
        /// the length of the longest body.
        stiffness: f64 = 1e6, Interval::above(0.0).to(1e300);
        /// Iterations,
        max_iterations: usize = 12, Interval::from(0.0).to(1000.0);
        /// until the residual of the energy itself is below this (dimensionless).
        residual: f64 = 0.1, Interval::above(0.0).to(10.0);
        /// From an equilibrium with softer terms they may go this far (dimensionless).
        reach: f64 = 0.3, Interval::above(0.0).to(10.0);
    }
}

options! {
    /// Newton and chord steps.
    pub struct NewtonOptions {
        /// A step below this (dimensionless) does not change the state any more.
        negligible_step: f64 = 1e-11, Interval::from(0.0).to(1e-3);
        /// Where a step is below this (dimensionless), what is left of the residual may be rounding:
        small_step: f64 = 1e-7, Interval::from(0.0).to(1.0);
        /// it is the best that can be had if a negligible step leaves more than this share of it.
        progress: f64 = 0.5, Interval::from(0.0).to(1.0);
        /// Chord steps are taken while each leaves less than this share of the residual
        chord_contraction: f64 = 0.1, Interval::from(0.0).to(1.0);
        /// and this many more at the same rate would reach the tolerance.
        max_chords_left: usize = 3, Interval::from(0.0).to(100.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_in_range_and_described() {
        let options = ContinuationOptions::default();
        assert_eq!(options.validate(), Ok(()));
        assert_eq!(options.values().len(), ContinuationOptions::INFO.len());
        assert!(ContinuationOptions::INFO.iter().all(|info| info.doc.len() > 20));
    }

    #[test]
    fn options_are_set_by_name() {
        let mut options = ContinuationOptions::default();
        options.set("max_iterations", 7.0).unwrap();
        options.set("min_step", 0.5).unwrap();
        assert_eq!((options.max_iterations, options.min_step), (7, 0.5));
        assert_eq!(options.tolerance, ContinuationOptions::default().tolerance);
    }

    #[test]
    fn what_is_wrong_is_said() {
        let mut options = ContinuationOptions::default();
        let mut said = |name: &str, value: f64| options.set(name, value).unwrap_err().to_string();
        assert_eq!(said("min_step", 0.0), "min_step is 0: it must be above 0 and at most 1");
        assert_eq!(said("tolerance", f64::NAN), "tolerance is NaN: it must be above 0 and at most 1");
        let whole = "max_iterations is 2.5: it must be a whole number from 1 to 1000000000";
        assert_eq!(said("max_iterations", 2.5), whole);
        assert!(said("max_steps", 1.0).starts_with("no solver option is named max_steps"));
        options.corrector.max_step_growth = 0.0;
        let problem = options.validate().unwrap_err().to_string();
        assert_eq!(problem, "max_step_growth is 0: it must be from 1 to 1000");
    }
}
