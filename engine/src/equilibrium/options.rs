//! Options of the equilibrium solver, with their defaults and the range in which each may lie.
//!
//! The fields of [`ContinuationOptions`] itself are those that a user may want to set for a solve; the
//! nested structs tune its parts. Dimensionless quantities are in the units of
//! [`System`](super::System): one radian of the softest angular coordinate.

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
    /// Options for following equilibria along the load.
    pub struct ContinuationOptions {
        /// Largest dimensionless residual of a state that counts as an equilibrium.
        tolerance: f64 = 1e-9, Interval::above(0.0).to(1.0);
        /// Iterations (evaluations of the tangent) allowed for one load step, including all its sub-steps.
        max_iterations: usize = 20_000, Interval::from(1.0).to(1e9);
        /// Time allowed for one load step [s]. What is reached by then depends on the machine.
        max_seconds: f64 = f64::INFINITY, Interval::above(0.0).to(f64::INFINITY);
        /// Smallest sub-step of the load, as a fraction of the range of each input over the path.
        min_step: f64 = 1e-3, Interval::above(0.0).to(1.0);
        /// Longest predicted displacement of one sub-step (dimensionless norm over all coordinates).
        max_displacement: f64 = 30.0, Interval::above(0.0).to(1e6);
        /// Longest predicted displacement of one sub-step in models with contact, likewise.
        max_displacement_with_contact: f64 = 4.0, Interval::above(0.0).to(1e6);
        /// Longest predicted displacement of one sub-step in models with springs but no contact, likewise.
        max_displacement_with_springs: f64 = 1.0, Interval::above(0.0).to(1e6);
    }
    parts {
        /// Accuracy required of residual and tangent at the end of a sub-step.
        accuracy: AccuracyOptions;
        /// Length of the sub-steps.
        step: StepOptions;
        /// Prediction through changes of contact.
        predictor: PredictorOptions;
        /// Newton's method from the predicted state.
        corrector: CorrectorOptions;
        /// The test that predictor and corrector stayed on one branch.
        same_branch: SameBranchOptions;
        /// Location of the end of a branch.
        locate: LocateOptions;
        /// Jumps from the end of a branch.
        jump: JumpOptions;
        /// Location of the load at which stability is lost.
        critical: CriticalOptions;
        /// Minimisation of the energy.
        trust_region: TrustRegionOptions;
        /// Newton's method for loads without a potential.
        damped_newton: DampedNewtonOptions;
        /// Continuation by arc length.
        arc_length: ArcLengthOptions;
        /// Newton's method with stiff forces as unknowns.
        mixed: MixedOptions;
        /// Loads that are found from listed lengths and volumes.
        controlled: ControlledOptions;
        /// Closing of ties.
        closing: ClosingOptions;
        /// Normal forces of points with friction.
        friction: FrictionOptions;
        /// Newton and chord steps, common to all methods.
        newton: NewtonOptions;
    }
}

options! {
    /// Accuracy required of residual and tangent at the end of a sub-step.
    ///
    /// The tangent before the last step is reused after it if that step left little of the residual: the
    /// fraction left is the size of H⁻¹ times the difference of the two tangents along the step.
    pub struct AccuracyOptions {
        /// Largest residual between the listed loads, as a fraction of the predicted displacement and of
        /// the change of the load.
        relative_residual: f64 = 0.03, Interval::from(0.0).to(1.0);
        /// The same fraction where the branch is predicted to end.
        residual_near_end: f64 = 1e-4, Interval::from(0.0).to(1.0);
        /// Largest dimensionless residual between the listed loads.
        max_residual: f64 = 0.1, Interval::from(0.0).to(1.0);
        /// Between the listed loads, the tangent is reused if the last step left less than this fraction of
        /// the residual.
        tangent_reuse: f64 = 0.3, Interval::from(0.0).to(1.0);
        /// The same fraction after a jump between the listed loads.
        tangent_reuse_after_jump: f64 = 0.1, Interval::from(0.0).to(1.0);
        /// The same fraction at listed loads. At the last load the tangent is always evaluated at the final
        /// state.
        tangent_reuse_at_listed: f64 = 0.03, Interval::from(0.0).to(1.0);
    }
}

options! {
    /// Length of the sub-steps between two listed loads.
    pub struct StepOptions {
        /// Where the branch is predicted to end, the first sub-step covers this fraction of the distance.
        fraction_to_end: f64 = 0.75, Interval::above(0.0).to(1.0);
        /// Later sub-steps stop short of the predicted end by this multiple of the expected prediction
        /// error.
        end_margin: f64 = 3.0, Interval::from(1.0).to(100.0);
        /// Sub-steps of at most this multiple of the smallest one are not halved any further.
        min_step_margin: f64 = 1.5, Interval::from(1.0).to(10.0);
    }
}

options! {
    /// Location of the end of a branch. Lengths are dimensionless norms over all coordinates.
    pub struct LocateOptions {
        /// Accuracy of the load at a limit point, as a fraction of the range of each input over the path.
        located: f64 = 1e-8, Interval::above(0.0).to(1.0);
        /// Distance from which the end of a branch in a corner is where it is predicted, as the same
        /// fraction.
        end_distance: f64 = 3e-4, Interval::above(0.0).to(1.0);
        /// How far beyond the limit point the next equilibrium is sought, as the same fraction.
        beyond: f64 = 1e-5, Interval::above(0.0).to(1.0);
        /// Largest number of states computed on the way to a limit point.
        max_points: usize = 30, Interval::from(1.0).to(1e3);
        /// Largest dimensionless residual of each of these states.
        residual: f64 = 1e-8, Interval::from(0.0).to(1.0);
        /// Newton steps allowed for each of these states.
        max_iterations: usize = 8, Interval::from(1.0).to(1e3);
        /// A branch whose displacement over the segment is smaller is at rest.
        still: f64 = 1e-9, Interval::from(0.0).to(1.0);
        /// Largest displacement to the first of these states.
        longest: f64 = 0.15, Interval::above(0.0).to(1e3);
        /// Smallest displacement to the first of these states.
        shortest: f64 = 1e-7, Interval::above(0.0).to(1.0);
        /// Factor by which this displacement is reduced where no state is found.
        shrinkage: f64 = 0.25, Interval::above(0.0).to(1.0);
        /// Largest correction of the equilibrium from which the search starts.
        refinement: f64 = 0.15, Interval::from(0.0).to(1.0);
        /// Largest deviation of a state from the tangent direction, as a fraction of the displacement.
        turn: f64 = 0.5, Interval::above(0.0).to(10.0);
        /// Displacement below which `corner_turn` applies in place of `turn`.
        corner: f64 = 1e-3, Interval::from(0.0).to(1.0);
        /// Largest deviation of a state beyond a corner, as a multiple of the displacement.
        corner_turn: f64 = 10.0, Interval::above(0.0).to(1e3);
        /// How far the mean slope of the load between two states that are followed may lie outside of their own
        /// slopes, as a fraction of the larger one: between them the load would fall.
        slope_margin: f64 = 0.1, Interval::from(0.0).to(10.0);
    }
}

options! {
    /// The predictor.
    pub struct PredictorOptions {
        /// Largest number of contact changes that one prediction follows.
        max_contact_changes: usize = 5, Interval::from(0.0).to(1000.0);
        /// Pairs are monitored if they would meet within the sub-step at this multiple of their closing
        /// rate.
        closing_rate_margin: f64 = 2.0, Interval::from(1.0).to(1e3);
        /// Fraction of the speed of the fastest point that is added to this closing rate.
        point_speed_margin: f64 = 0.1, Interval::from(0.0).to(1e3);
        /// The curvature of the last sub-step is reused if its prediction missed the displacement by half
        /// the change of velocity, to within this fraction of that change.
        curvature_ratio: f64 = 0.25, Interval::from(0.0).to(0.5);
        /// Smallest cosine of the angle between these two vectors for the curvature to be reused.
        curvature_cosine: f64 = 0.8, Interval::from(0.0).to(1.0);
        /// Largest relative change of the velocity for the curvature to be reused.
        max_curvature: f64 = 0.3, Interval::from(0.0).to(10.0);
    }
}

options! {
    /// The corrector. The lengths of its steps are measured by their largest coordinate, as is the
    /// predicted displacement with which they are compared.
    pub struct CorrectorOptions {
        /// Largest number of chord steps with the predicted tangent before the tangent is evaluated.
        max_predicted_chords: usize = 2, Interval::from(0.0).to(100.0);
        /// Each of these chord steps must reduce the residual to less than this fraction.
        predicted_chord_contraction: f64 = 0.3, Interval::from(0.0).to(1.0);
        /// Largest displacement of these chord steps together, as a fraction of the predicted displacement.
        predicted_chord_reach: f64 = 0.3, Interval::from(0.0).to(10.0);
        /// A chord step longer than this multiple of the displacement rejects the prediction.
        rejection_ratio: f64 = 1.4, Interval::from(0.0).to(100.0);
        /// With a dimensionless residual below this, a negative stiffness of at most the same size counts
        /// as zero.
        soft_residual: f64 = 1e-2, Interval::from(0.0).to(1.0);
        /// Dimensionless residual of a state with a stiffness that counts as zero in this way: the stiffness is
        /// known as well.
        neutral_residual: f64 = 1e-7, Interval::from(0.0).to(1.0);
        /// Largest number of Newton steps; more are rarely needed unless another branch attracts.
        max_iterations: usize = 7, Interval::from(1.0).to(1e6);
        /// Largest correction in total, as a fraction of the predicted displacement.
        max_correction: f64 = 0.7, Interval::from(0.0).to(100.0);
        /// Dimensionless correction that is always allowed.
        free_correction: f64 = 1e-3, Interval::from(0.0).to(10.0);
        /// Largest ratio of the length of a step to that of the previous one.
        max_step_growth: f64 = 2.0, Interval::from(1.0).to(1e3);
    }
}

options! {
    /// The test that a corrected state lies on the predicted branch: it agrees with the prediction, or its
    /// displacement agrees with the velocities at both ends.
    pub struct SameBranchOptions {
        /// Largest relative error of the predicted displacement.
        displacement_error: f64 = 0.3, Interval::from(0.0).to(10.0);
        /// Largest relative error of the predicted velocity.
        velocity_error: f64 = 0.7, Interval::from(0.0).to(10.0);
        /// Largest change of the velocity times the sub-step (dimensionless): more could hide a jump.
        max_velocity_change: f64 = 2.5, Interval::from(0.0).to(1e3);
        /// Largest difference of the displacement from the mean of both velocities, as a fraction of their
        /// change.
        mean_velocity_error: f64 = 0.5, Interval::from(0.0).to(10.0);
        /// Term added to this difference: a fraction of the size of the velocities.
        relative_error: f64 = 0.05, Interval::from(0.0).to(10.0);
        /// Longest displacement (dimensionless norm) of which this is enough where contacts have opened or closed.
        longest_bend: f64 = 0.2, Interval::from(0.0).to(1e6);
        /// Term added to this difference (dimensionless).
        absolute_error: f64 = 1e-9, Interval::from(0.0).to(1.0);
    }
}

options! {
    /// Jumps from the end of a branch to another equilibrium.
    pub struct JumpOptions {
        /// Smallest dimensionless displacement of a jump that is reported as an event.
        min_displacement: f64 = 1e-3, Interval::from(0.0).to(10.0);
        /// Smallest energy released by such a jump, in units of energy; it must also exceed the energy
        /// released where the potential is convex between both states.
        min_energy: f64 = 1e-11, Interval::from(0.0).to(1.0);
        /// Where the end of the branch was not located, the displacement must also exceed this multiple of
        /// what the velocities explain.
        speed_margin: f64 = 1.5, Interval::from(1.0).to(1e3);
        /// Where another branch crosses, the displacement is compared with that at this fraction of the
        /// distance beyond the critical load.
        earlier: f64 = 0.25, Interval::above(0.0).to(1.0);
        /// Where the state found is far away, nearby states are sought from this dimensionless distance to
        /// both sides.
        departure: f64 = 1e-3, Interval::above(0.0).to(1.0);
        /// Such a state is on a branch that leaves continuously if it is nearer by this factor.
        nearness: f64 = 0.3, Interval::above(0.0).to(1.0);
        /// The crossing is a snap if the displacement there is at least this fraction of the full one.
        constant_share: f64 = 0.8, Interval::above(0.0).to(1.0);
    }
}

options! {
    /// Location of the load at which another branch crosses.
    pub struct CriticalOptions {
        /// Number of chord steps to the equilibrium from which the search starts.
        refinements: usize = 3, Interval::from(0.0).to(100.0);
        /// How often the load is extrapolated again from closer by.
        approaches: usize = 2, Interval::from(0.0).to(10.0);
        /// Number of inverse iterations for the eigenvector of the lowest eigenvalue.
        inverse_iterations: usize = 8, Interval::from(1.0).to(1000.0);
        /// Number of iterations for the eigenvector of the eigenvalue that vanishes first.
        power_iterations: usize = 20, Interval::from(0.0).to(1000.0);
        /// Dimensionless displacement over which the change of the tangent is taken.
        difference: f64 = 1e-4, Interval::above(0.0).to(1.0);
        /// Largest fraction of the sub-step over which the change of the tangent is taken.
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
        /// Smallest ratio of the actual to the predicted decrease of an accepted step.
        acceptance_ratio: f64 = 1e-4, Interval::from(0.0).to(0.5);
        /// Decreases below this fraction of the energy are lost in rounding: the residual decides instead.
        rounding: f64 = 1e-13, Interval::from(0.0).to(1e-3);
        /// Ratio of the actual to the predicted decrease from which the radius may grow.
        good_ratio: f64 = 0.75, Interval::from(0.0).to(1.0);
        /// The radius grows only after steps longer than this fraction of it.
        boundary_share: f64 = 0.8, Interval::from(0.0).to(1.0);
        /// Factor by which the radius grows.
        growth: f64 = 2.0, Interval::from(1.0).to(100.0);
        /// Ratio of the actual to the predicted decrease below which the radius shrinks.
        poor_ratio: f64 = 0.25, Interval::from(0.0).to(1.0);
        /// New radius after a poor or rejected step, as a fraction of the length of that step.
        shrinkage: f64 = 0.4, Interval::above(0.0).to(1.0);
        /// After a rejected step shorter than this, rejected steps are improved before they are shortened.
        stiff_radius: f64 = 0.05, Interval::from(0.0).to(10.0);
        /// Largest number of second-order corrections, which follow the curved valley of a stiff energy.
        max_corrections: usize = 3, Interval::from(0.0).to(100.0);
        /// Largest length of each of these corrections, as a fraction of the step.
        max_correction: f64 = 0.5, Interval::from(0.0).to(1.0);
        /// Largest number of evaluations of the line search that follows, for contacts that close on the
        /// way.
        max_line_search: usize = 40, Interval::from(0.0).to(1e3);
        /// The line search ends where the slope is this fraction of the predicted decrease.
        line_search_slope: f64 = 1e-2, Interval::from(0.0).to(1.0);
        /// Largest number of factorisations for one step.
        max_factorizations: usize = 30, Interval::from(1.0).to(1000.0);
        /// Largest relative difference between the length of a step and the radius.
        radius_slack: f64 = 0.25, Interval::above(0.0).to(1.0);
        /// First multiplier tried with an indefinite tangent, as a fraction of its upper bound.
        first_multiplier: f64 = 1e-2, Interval::above(0.0).to(1.0);
        /// The hard case is assumed where the bounds of the multiplier agree to this fraction.
        hard_case_gap: f64 = 1e-3, Interval::above(0.0).to(1.0);
        /// Largest number of consecutive steps along an unconstrained motion on which a force acts.
        max_free_steps: usize = 8, Interval::from(1.0).to(1e6);
        /// Number of inverse iterations for the direction of negative curvature.
        inverse_iterations: usize = 4, Interval::from(1.0).to(1000.0);
    }
}

options! {
    /// Newton's method with halved steps.
    pub struct DampedNewtonOptions {
        /// Largest number of halvings of one step.
        max_halvings: usize = 30, Interval::from(0.0).to(1000.0);
        /// Longest step, by the largest coordinate (dimensionless).
        max_step: f64 = 1.0, Interval::above(0.0).to(1e3);
        /// Largest number of steps.
        max_steps: usize = 2000, Interval::from(0.0).to(1e9);
        /// Largest number of steps after a part of the loads was added.
        max_correction: usize = 20, Interval::from(1.0).to(1e9);
        /// First part of the loads that is added to none.
        first_part: f64 = 0.25, Interval::above(0.0).to(1.0);
        /// Largest number of parts that are tried.
        max_parts: usize = 50, Interval::from(0.0).to(1e9);
        /// A halved step creeps if it lowers the residual by less than this fraction.
        progress: f64 = 1e-3, Interval::from(0.0).to(1.0);
        /// Largest number of consecutive steps that creep.
        max_creeping: usize = 10, Interval::from(0.0).to(1e9);
        /// Largest number of implicit steps of the overdamped motion from an unstable state.
        max_relaxation: usize = 1500, Interval::from(0.0).to(1e6);
        /// Largest number of consecutive steps of this motion without stiffness.
        max_free_steps: usize = 8, Interval::from(1.0).to(1e6);
        /// Distance from the unstable equilibrium at which this motion starts.
        perturbation: f64 = 1e-3, Interval::above(0.0).to(1.0);
    }
}

options! {
    /// Continuation by arc length.
    pub struct ArcLengthOptions {
        /// Dimensionless residual below which a start counts as an equilibrium, stable or not.
        start_residual: f64 = 1e-6, Interval::from(0.0).to(1.0);
        /// Dimensionless step below which forces may also balance to rounding, if the step lowers nothing.
        small_step: f64 = 1e-7, Interval::from(0.0).to(1e-3);
        /// Newton steps allowed for one point.
        max_iterations: usize = 10, Interval::from(1.0).to(1e3);
        /// Angle by which the branch should turn on one step [rad].
        turn: f64 = 0.12, Interval::above(0.0).to(1.5);
        /// Largest angle by which the branch may turn on one step [rad].
        max_turn: f64 = 0.35, Interval::above(0.0).to(3.2);
        /// Steps shorter than this fraction of the first may turn further: the branch has a corner there.
        corner_step: f64 = 1e-3, Interval::from(0.0).to(1.0);
        /// Shortest step, as a fraction of the first.
        min_step: f64 = 1e-7, Interval::above(0.0).to(1.0);
        /// Largest distance of the next point, as a multiple of the step.
        max_reach: f64 = 1.3, Interval::above(1.0).to(10.0);
        /// Largest number of points solved to locate a limit point.
        max_locating: usize = 20, Interval::from(1.0).to(1e3);
        /// Accuracy of a limit point, as a fraction of the step.
        located: f64 = 1e-7, Interval::above(0.0).to(1.0);
    }
}

options! {
    /// Newton's method with stiff forces as unknowns.
    pub struct MixedOptions {
        /// A spring or contact is stiff if it stores more than this multiple of the energy unit when moved
        /// by the length of the longest body.
        stiffness: f64 = 1e6, Interval::above(0.0).to(1e300);
        /// Largest number of iterations.
        max_iterations: usize = 12, Interval::from(0.0).to(1000.0);
        /// The iteration ends where the dimensionless residual of the energy itself is below this.
        residual: f64 = 0.1, Interval::above(0.0).to(10.0);
        /// Largest dimensionless displacement from an equilibrium with softened terms.
        reach: f64 = 0.3, Interval::above(0.0).to(10.0);
    }
}

options! {
    /// Loads that are found from listed lengths and volumes.
    pub struct ControlledOptions {
        /// Largest number of chord steps to a listed value; if more are needed the tangent is too far off.
        max_chords: usize = 12, Interval::from(1.0).to(1e3);
        /// Largest number of times that the branch is followed towards a listed value.
        max_rounds: usize = 20, Interval::from(1.0).to(1e3);
        /// Largest relative error of a length or volume where its residual is lost in rounding.
        rounding: f64 = 1e-6, Interval::from(0.0).to(1.0);
    }
}

options! {
    /// Equilibria with ties that are open, or nearly closed.
    pub struct ClosingOptions {
        /// Largest gap of a tie that is closed at once: relative to the longest body, or in radians.
        nearly_closed: f64 = 1e-2, Interval::from(0.0).to(1.0);
        /// Largest number of minimisations with ties as penalties.
        max_rounds: usize = 12, Interval::from(1.0).to(1e3);
        /// Dimensionless residual that ends one of them.
        residual: f64 = 1e-4, Interval::from(0.0).to(1.0);
        /// Largest number of iterations for closing several ties together.
        together: usize = 500, Interval::from(1.0).to(1e9);
        /// Residual between the listed loads, as a share of that allowed without ties.
        residual_share: f64 = 1e-2, Interval::from(0.0).to(1.0);
        /// Dimensionless displacement by which Newton's method may close ties then.
        reach: f64 = 1.0, Interval::from(0.0).to(1e3);
    }
}

options! {
    /// Steps with friction.
    pub struct FrictionOptions {
        /// Largest number of times that a structure gives way in a step of the load.
        max_rounds: usize = 60, Interval::from(1.0).to(1e6);
        /// Largest number of times that a step of the load is halved where friction does not settle.
        max_halvings_of_load: usize = 5, Interval::from(0.0).to(20.0);
        /// Largest number of Newton steps to an equilibrium with its own normal forces.
        max_iterations: usize = 30, Interval::from(1.0).to(1e6);
        /// Largest number of halvings of one of these steps.
        max_halvings: usize = 12, Interval::from(1.0).to(1e3);
        /// Initial radius of the trust region where Newton's method then fails.
        radius: f64 = 0.03, Interval::above(0.0).to(1e3);
    }
}

options! {
    /// Newton and chord steps.
    pub struct NewtonOptions {
        /// Dimensionless step below which a step does not change the state.
        negligible_step: f64 = 1e-11, Interval::from(0.0).to(1e-3);
        /// Dimensionless step below which the remaining residual may be rounding.
        small_step: f64 = 1e-7, Interval::from(0.0).to(1.0);
        /// The residual is rounding if a negligible step leaves more than this fraction of it.
        progress: f64 = 0.5, Interval::from(0.0).to(1.0);
        /// Chord steps are taken while each leaves less than this fraction of the residual.
        chord_contraction: f64 = 0.1, Interval::from(0.0).to(1.0);
        /// Chord steps are taken only if at most this many more would reach the tolerance at the current
        /// rate.
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
