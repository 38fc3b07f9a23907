//! Length of the sub-steps between two listed loads.

use super::options::StepOptions;

/// Chooses sub-steps along one segment of the load, λ from 0 to 1.
#[derive(Clone, Debug)]
pub(super) struct StepControl {
    options: StepOptions,
    /// The smallest sub-step, unless the end of the branch is nearer,
    smallest: f64,
    /// and how near that is met.
    nearest: f64,
    /// The nearest λ that could not be reached in one sub-step.
    rejected: f64,
    /// Where an end of the branch was last predicted, and how far ahead.
    predicted_end: Option<(f64, f64)>,
    /// Ends in a row behind which the state was no way off.
    negligible: usize,
}

/// So many, and ends are no longer looked for until sub-steps grow.
const ROUGH: usize = 3;

impl StepControl {
    pub fn new(options: StepOptions, smallest: f64, nearest: f64) -> Self {
        Self { options, smallest, nearest, rejected: f64::INFINITY, predicted_end: None, negligible: 0 }
    }

    /// The λ to go to, if it can be reached.
    pub fn target(&self) -> f64 {
        self.rejected.min(1.0)
    }

    /// The end of the first sub-step to try from `lambda`, when the prediction holds for `reach` and sees
    /// an end of the branch `to_end` ahead.
    pub fn propose(&mut self, lambda: f64, reach: f64, to_end: f64) -> f64 {
        let target = self.target();
        let short_of_end = self.short_of_end(lambda, to_end);
        let smallest = if self.is_rough() { self.smallest } else { self.smallest.min(short_of_end) };
        let mut h = (target - lambda).min(short_of_end);
        while h > reach && h > smallest {
            h *= 0.5;
            self.rejected = lambda + 2.0 * h;
        }
        let h = h.max(smallest);
        if lambda + h < target { lambda + h } else { target }
    }

    /// Whether the branch is predicted to end so near that the prediction is exact.
    pub fn is_at_end(&self, to_end: f64) -> bool {
        to_end < self.nearest
    }

    /// Behind an end of the branch the state was no way off.
    pub fn end_was_negligible(&mut self) {
        self.negligible += 1;
    }

    /// Whether branches end and begin again all the time, as with stiff contact.
    pub fn is_rough(&self) -> bool {
        self.negligible >= ROUGH
    }

    /// The end of a shorter sub-step than that to `next`; `None` where there is none.
    pub fn shorten(&mut self, lambda: f64, next: f64) -> Option<f64> {
        if next - lambda <= self.options.min_step_margin * self.smallest {
            return None;
        }
        self.rejected = next;
        Some(lambda + (0.5 * (next - lambda)).max(self.smallest))
    }

    /// The sub-step to `next` succeeded.
    pub fn accept(&mut self, lambda: f64, next: f64) {
        if next - lambda > 4.0 * self.smallest {
            self.negligible = 0;
        }
        if next >= self.rejected {
            self.rejected = f64::INFINITY;
        }
    }

    /// The state is on another branch now.
    pub fn restart(&mut self) {
        self.rejected = f64::INFINITY;
        self.predicted_end = None;
    }

    /// How far to go from `lambda` towards an end of the branch predicted at this distance; infinite where
    /// none is in sight.
    ///
    /// Towards a corner the prediction misses by the square of the distance. Towards a fold it lags behind:
    /// two of them are extrapolated.
    fn short_of_end(&mut self, lambda: f64, distance: f64) -> f64 {
        let seen = distance.is_finite().then_some((lambda, distance));
        match std::mem::replace(&mut self.predicted_end, seen) {
            Some((at, far)) if distance < far => {
                let extrapolated = distance.min(distance * (lambda - at) / (far - distance));
                let missed = (lambda + distance - at - far).abs() * (distance / far).powi(2);
                let left = (self.options.end_margin * missed).max(0.5 * self.nearest);
                (extrapolated - left).max(self.options.fraction_to_end * extrapolated)
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
        // 0.2 is seen from 0.3, 0.4 was seen from 0: at this rate it is reached after 0.2 · 0.3 / 0.2.
        assert_eq!(control.propose(0.3, 1.0, 0.2), 0.3 + 0.75 * 0.2);
        // And 0.05 from 0.45: after 0.05 · 0.15 / 0.15.
        // Both see the same end: the next sub-step goes all the way but for what counts as being there.
        assert_eq!(control.propose(0.45, 1.0, 0.05), 0.45 + (0.05 - 0.5e-5));
        control.restart();
        assert_eq!(control.propose(0.5, 1.0, 0.4), 0.5 + 0.75 * 0.4);
    }
}
