//! A strip of an elastic foundation: energy per length of an indentation that is a parabola across.
//!
//! With stiffness k_f of the foundation, relative curvature κ across and half-width b, at depth d: half
//! of the contact's width a = √(2d/κ), below b energy 8/15 k_f a d², beyond it
//! k_f (b d² − b³ d κ/3 + b⁵ κ²/20). It is twice continuously differentiable, also where d = 0.

/// Energy per length and stiffness of the foundation, and its derivatives.
#[derive(Clone, Copy, Debug)]
pub(in crate::forces) struct Strip {
    pub energy: f64,
    pub by_depth: f64,
    pub by_curvature: f64,
    pub by_width: f64,
    pub depth_depth: f64,
    pub depth_curvature: f64,
    pub depth_width: f64,
    pub curvature_curvature: f64,
    pub curvature_width: f64,
}

impl Strip {
    /// Of a spring that is stretched against the depth.
    #[inline]
    pub fn pulled(stretch: f64) -> Self {
        Self {
            energy: 0.5 * stretch * stretch,
            by_depth: -stretch,
            by_curvature: 0.0,
            by_width: 0.0,
            depth_depth: 1.0,
            depth_curvature: 0.0,
            depth_width: 0.0,
            curvature_curvature: 0.0,
            curvature_width: 0.0,
        }
    }

    /// Slopes of `depth_depth` by depth, curvature and half-width.
    pub fn slopes_of_stiffness(d: f64, kappa: f64, b: f64) -> [f64; 3] {
        let a = (2.0 * d / kappa).sqrt();
        if a < b { [a / d, -a / kappa, 0.0] } else { [0.0, 0.0, 2.0] }
    }

    /// At depth d ≥ 0, curvature κ > 0 and half-width b > 0.
    #[inline]
    pub fn new(d: f64, kappa: f64, b: f64) -> Self {
        let a = (2.0 * d / kappa).sqrt();
        if a < b {
            let energy = 8.0 / 15.0 * a * d * d;
            Self {
                energy,
                by_depth: 4.0 / 3.0 * a * d,
                by_curvature: -0.5 * energy / kappa,
                by_width: 0.0,
                depth_depth: 2.0 * a,
                depth_curvature: -2.0 / 3.0 * a * d / kappa,
                depth_width: 0.0,
                curvature_curvature: 0.75 * energy / (kappa * kappa),
                curvature_width: 0.0,
            }
        } else {
            // Depth at the edge.
            let edge = d - 0.5 * b * b * kappa;
            let cube = b * b * b;
            Self {
                energy: b * d * d - cube * d * kappa / 3.0 + cube * b * b * kappa * kappa / 20.0,
                by_depth: 2.0 * b * d - cube * kappa / 3.0,
                by_curvature: -cube * d / 3.0 + cube * b * b * kappa / 10.0,
                by_width: edge * edge,
                depth_depth: 2.0 * b,
                depth_curvature: -cube / 3.0,
                depth_width: 2.0 * edge,
                curvature_curvature: cube * b * b / 10.0,
                curvature_width: -b * b * edge,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against ∫ ½ (d − κ y²/2)₊² dy over the width, by the midpoint rule.
    #[test]
    fn energy_is_that_of_independent_springs() {
        for (d, kappa, b) in [(1e-3, 50.0, 8e-3), (1e-3, 10.0, 8e-3), (2e-3, 300.0, 5e-3)] {
            let count = 200_000;
            let h = 2.0 * b / f64::from(count);
            let spring = |i: i32| {
                let y = -b + (f64::from(i) + 0.5) * h;
                0.5 * (d - 0.5 * kappa * y * y).max(0.0).powi(2) * h
            };
            let sum: f64 = (0..count).map(spring).sum();
            let strip = Strip::new(d, kappa, b);
            assert!((strip.energy - sum).abs() < 1e-8 * sum, "{} {sum}", strip.energy);
        }
    }

    #[test]
    fn derivatives_are_those_of_the_energy() {
        for x in [[1e-3, 50.0, 8e-3], [1e-3, 10.0, 8e-3], [2e-3, 300.0, 5e-3]] {
            let at = |i: usize, step: f64| {
                let mut y = x;
                y[i] *= 1.0 + step;
                Strip::new(y[0], y[1], y[2])
            };
            let slope = |i: usize, of: fn(&Strip) -> f64| {
                let h = 1e-4;
                let twice = |h: f64| (of(&at(i, h)) - of(&at(i, -h))) / (2.0 * h * x[i]);
                (4.0 * twice(0.5 * h) - twice(h)) / 3.0
            };
            let s = at(0, 0.0);
            let [by_depth, by_curvature, by_width] = Strip::slopes_of_stiffness(x[0], x[1], x[2]);
            let pairs = [
                (by_depth, slope(0, |s| s.depth_depth)),
                (by_curvature, slope(1, |s| s.depth_depth)),
                (by_width, slope(2, |s| s.depth_depth)),
                (s.by_depth, slope(0, |s| s.energy)),
                (s.by_curvature, slope(1, |s| s.energy)),
                (s.by_width, slope(2, |s| s.energy)),
                (s.depth_depth, slope(0, |s| s.by_depth)),
                (s.depth_curvature, slope(1, |s| s.by_depth)),
                (s.depth_width, slope(2, |s| s.by_depth)),
                (s.curvature_curvature, slope(1, |s| s.by_curvature)),
                (s.curvature_width, slope(2, |s| s.by_curvature)),
            ];
            for (exact, difference) in pairs {
                assert!((exact - difference).abs() <= 1e-7 * exact.abs(), "{x:?}: {exact} {difference}");
            }
        }
    }

    #[test]
    fn narrow_and_full_width_meet_twice_differentiably() {
        let (kappa, b) = (20.0, 8e-3);
        let d = 0.5 * b * b * kappa;
        let [below, above] = [d * (1.0 - 1e-12), d * (1.0 + 1e-12)].map(|d| Strip::new(d, kappa, b));
        for of in [
            |s: &Strip| s.energy,
            |s: &Strip| s.by_depth,
            |s: &Strip| s.by_curvature,
            |s: &Strip| s.depth_depth,
            |s: &Strip| s.depth_curvature,
            |s: &Strip| s.curvature_curvature,
        ] {
            assert!((of(&below) - of(&above)).abs() < 1e-10 * of(&above).abs());
        }
    }
}
