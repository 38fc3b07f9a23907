//! Step-size control between two listed loads.

use super::options::StepOptions;

/// Chooses sub-steps along one segment of the load, λ from 0 to 1.
#[derive(Clone, Debug)]
pub(super) struct StepControl {
    options: StepOptions,
    /// Smallest sub-step, except towards a predicted end of the branch.
    min_step: f64,
    /// Distance to a predicted end below which the prediction is taken for exact.
    end_distance: f64,
    /// The smallest λ that could not be reached in one sub-step.
    rejected: f64,
    /// The λ at which an end of the branch was last predicted, and its distance then.
    predicted_end: Option<(f64, f64)>,
    /// Number of consecutive ends of the branch with a negligible jump.
    negligible_jumps: usize,
    /// How often the smallest sub-step has been made smaller.
    refined: usize,
}

/// After this number of consecutive negligible jumps, ends of the branch are ignored until sub-steps grow.
const MAX_NEGLIGIBLE_JUMPS: usize = 3;

impl StepControl {
    pub fn new(options: StepOptions, min_step: f64, end_distance: f64) -> Self {
        let (rejected, predicted_end, negligible_jumps) = (f64::INFINITY, None, 0);
        let refined = 0;
        Self { options, min_step, end_distance, rejected, predicted_end, negligible_jumps, refined }
    }

    /// The λ to aim for.
    pub fn target(&self) -> f64 {
        self.rejected.min(1.0)
    }

    /// The end of the first sub-step to try from `lambda`, where the prediction is valid over `reach` and
    /// the branch is predicted to end after `to_end`.
    pub fn propose(&mut self, lambda: f64, reach: f64, to_end: f64) -> f64 {
        let target = self.target();
        let towards_end = self.step_towards_end(lambda, to_end);
        let min_step = if self.ignores_ends() { self.min_step } else { self.min_step.min(towards_end) };
        let mut h = (target - lambda).min(towards_end);
        while h > reach && h > min_step {
            h *= 0.5;
            self.rejected = lambda + 2.0 * h;
        }
        let h = h.max(min_step);
        if lambda + h < target { lambda + h } else { target }
    }

    /// Whether the branch is predicted to end so near that the prediction is exact.
    pub fn is_at_end(&self, to_end: f64) -> bool {
        to_end < self.end_distance
    }

    /// Records an end of the branch with a negligible jump.
    pub fn record_negligible_jump(&mut self) {
        self.negligible_jumps += 1;
    }

    /// Whether ends of the branch are ignored: with stiff contact, there may be one in every sub-step.
    pub fn ignores_ends(&self) -> bool {
        self.negligible_jumps >= MAX_NEGLIGIBLE_JUMPS
    }

    /// The end of a shorter sub-step than that to `next`, which failed; `None` if that was the smallest.
    pub fn shorten(&mut self, lambda: f64, next: f64) -> Option<f64> {
        if next - lambda <= self.options.min_step_margin * self.min_step {
            return None;
        }
        self.rejected = next;
        Some(lambda + (0.5 * (next - lambda)).max(self.min_step))
    }

    /// Allows sub-steps that are smaller by this factor, at most so often; `false` after that.
    pub fn refine(&mut self, factor: f64, most: usize) -> bool {
        let allowed = self.refined < most;
        if allowed {
            self.refined += 1;
            self.min_step *= factor;
        }
        allowed
    }

    /// Records that the sub-step to `next` succeeded.
    pub fn accept(&mut self, lambda: f64, next: f64) {
        if next - lambda > 4.0 * self.min_step {
            self.negligible_jumps = 0;
        }
        if next >= self.rejected {
            self.rejected = f64::INFINITY;
        }
    }

    /// Starts on another branch.
    pub fn restart(&mut self) {
        self.rejected = f64::INFINITY;
        self.predicted_end = None;
    }

    /// The sub-step from `lambda` towards an end of the branch predicted at this distance; infinite if none
    /// is predicted.
    ///
    /// The error of the prediction decreases with the square of the distance to a corner. The distance to a
    /// limit point is overestimated: it is extrapolated from two predictions.
    fn step_towards_end(&mut self, lambda: f64, distance: f64) -> f64 {
        let prediction = distance.is_finite().then_some((lambda, distance));
        match std::mem::replace(&mut self.predicted_end, prediction) {
            Some((at, before)) if distance < before => {
                let extrapolated = distance.min(distance * (lambda - at) / (before - distance));
                let error = (lambda + distance - at - before).abs() * (distance / before).powi(2);
                let margin = (self.options.end_margin * error).max(0.5 * self.end_distance);
                (extrapolated - margin).max(self.options.fraction_to_end * extrapolated)
            }
            _ => self.options.fraction_to_end * distance,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn control() -> StepControl {
        StepControl::new(StepOptions::default(), 0.01, 1e-5)
    }

    #[test]
    fn a_rejected_load_is_approached_by_halves_and_tried_again() {
        let mut control = control();
        assert_eq!(control.propose(0.0, 1.0, f64::INFINITY), 1.0);
        assert_eq!(control.shorten(0.0, 1.0), Some(0.5));
        control.accept(0.0, 0.5);
        assert_eq!(control.target(), 1.0);
        assert_eq!(control.propose(0.5, 0.3, f64::INFINITY), 0.75);
        control.accept(0.5, 0.75);
        assert_eq!(control.shorten(0.75, 0.764), None);
    }

    #[test]
    fn ends_of_a_branch_are_extrapolated() {
        let mut control = control();
        assert_eq!(control.propose(0.0, 1.0, 0.4), 0.75 * 0.4);
        // At 0 the distance was 0.4, at 0.3 it is 0.2: extrapolated, it vanishes after 0.2 · 0.3 / 0.2.
        assert_eq!(control.propose(0.3, 1.0, 0.2), 0.3 + 0.75 * 0.2);
        // Two predictions of the same end: the next sub-step leaves half of `end_distance`.
        assert_eq!(control.propose(0.45, 1.0, 0.05), 0.45 + (0.05 - 0.5e-5));
        control.restart();
        assert_eq!(control.propose(0.5, 1.0, 0.4), 0.5 + 0.75 * 0.4);
    }
}
