//! Gauss–Legendre rules and the sample points of a rod.

/// Nodes and weights of the `n`-point Gauss–Legendre rule on [0, 1], nodes increasing.
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let mut rule: Vec<(f64, f64)> = (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (value, derivative) = legendre(n, x);
                slope = derivative;
                let step = value / derivative;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect();
    rule.sort_by(|a, b| a.0.total_cmp(&b.0));
    rule
}

/// `P_n(x)` and its derivative, by the three-term recurrence.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut current) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (previous, current) = (current, ((2.0 * k - 1.0) * x * current - (k - 1.0) * previous) / k);
    }
    (current, n as f64 * (x * current - previous) / (x * x - 1.0))
}

/// The intervals over which a rod is integrated: its elements, the last of which is divided into equal parts.
#[derive(Clone, Copy, Debug)]
pub struct Intervals {
    /// Number of elements.
    pub elements: usize,
    /// Number of parts of the last element.
    pub tip: usize,
}

impl Intervals {
    /// Their number; never zero.
    #[allow(clippy::len_without_is_empty)]
    pub fn len(&self) -> usize {
        self.elements - 1 + self.tip
    }

    /// The element that an interval belongs to.
    pub fn element(&self, interval: usize) -> usize {
        interval.min(self.elements - 1)
    }

    /// X at a fraction of an interval.
    pub fn at(&self, interval: usize, fraction: f64) -> f64 {
        let element = self.element(interval);
        let parts = if element + 1 == self.elements { self.tip } else { 1 };
        (element as f64 + ((interval - element) as f64 + fraction) / parts as f64) / self.elements as f64
    }

    /// How many of its length make up the rod.
    pub fn count(&self, interval: usize) -> f64 {
        let parts = if interval + 1 < self.elements { 1 } else { self.tip };
        (self.elements * parts) as f64
    }

    /// The points X ∈ [0, 1] at which a rod is sampled: ends and Gauss points of its intervals, increasing.
    ///
    /// These are the toolbox's "significant points"; point `i (G + 1)` is the start of interval `i` and
    /// `i (G + 1) + 1 + m` its `m`-th Gauss point.
    pub fn sample_points(&self, gauss_points: usize) -> Vec<f64> {
        let rule = gauss_legendre(gauss_points);
        let mut x = vec![0.0];
        for interval in 0..self.len() {
            x.extend(rule.iter().map(|(t, _)| self.at(interval, *t)));
            x.push(self.at(interval, 1.0));
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_of_the_tip_are_parts_of_the_last_element() {
        let intervals = Intervals { elements: 4, tip: 3 };
        let x = intervals.sample_points(2);
        assert_eq!(x.len(), 3 * intervals.len() + 1);
        assert!(x.windows(2).all(|x| x[0] < x[1]));
        let ends: Vec<f64> = x.iter().step_by(3).copied().collect();
        let expected = [0.0, 0.25, 0.5, 0.75, 0.75 + 0.25 / 3.0, 0.75 + 0.5 / 3.0, 1.0];
        assert!(ends.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-15), "{ends:?}");
        for (i, end) in ends.windows(2).enumerate() {
            assert!((end[1] - end[0] - 1.0 / intervals.count(i)).abs() < 1e-15);
            assert_eq!(intervals.element(i), i.min(3));
        }
    }

    #[test]
    fn integrates_polynomials_exactly() {
        for n in 1..=12 {
            let rule = gauss_legendre(n);
            for degree in 0..2 * n {
                let integral: f64 = rule.iter().map(|(x, w)| w * x.powi(degree as i32)).sum();
                assert!((integral - 1.0 / (degree as f64 + 1.0)).abs() < 1e-14, "n = {n}, degree {degree}");
            }
        }
    }
}
