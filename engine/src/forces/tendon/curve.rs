//! Force–length curves of muscles, isometric, of the normalised length of their fibres.

use serde::Deserialize;
use std::f64::consts::PI;

/// Active and passive force of a muscle, each by its largest active force.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum MuscleCurve {
    /// Thelen (2003): the active force is a Gaussian; the passive one exponential, his (3), which
    /// here vanishes at the length zero in place of one, so that it is smooth and never negative.
    Thelen {
        /// γ, the width of the active force.
        width: f64,
        /// k of the passive force.
        passive_shape: f64,
        /// ε₀, the strain at which the passive force is one.
        passive_strain: f64,
    },
    /// The muscle of the simulator MuJoCo: parabolas, joined with their slopes.
    Parabolic {
        /// Lengths between which there is active force, on both sides of one.
        lower: f64,
        /// The greater one.
        upper: f64,
        /// Passive force at `upper` by the largest active one.
        passive: f64,
    },
}

/// A curve at one length: its integral from a fixed length, its value and its slope.
type Values = [f64; 3];

impl MuscleCurve {
    /// Whether its numbers make a curve.
    pub(super) fn is_valid(&self) -> bool {
        match *self {
            Self::Thelen { width, passive_shape, passive_strain } => {
                [width, passive_shape, passive_strain].iter().all(|x| x.is_finite() && *x > 0.0)
            }
            Self::Parabolic { lower, upper, passive } => {
                lower < 1.0
                    && upper > 1.0
                    && passive >= 0.0
                    && [lower, upper, passive].iter().all(|x| x.is_finite())
            }
        }
    }

    /// The active and the passive curve at a length.
    pub(super) fn at(&self, length: f64) -> [Values; 2] {
        match *self {
            Self::Thelen { width, passive_shape, passive_strain } => {
                let (x, root) = (length - 1.0, width.sqrt());
                let bell = (-x * x / width).exp();
                let area = 0.5 * PI.sqrt() * root * error_function(x / root);
                let rate = passive_shape / passive_strain;
                let (at_zero, now) = ((-rate).exp(), (rate * x).exp());
                let scale = 1.0 / (passive_shape.exp() - at_zero);
                let passive =
                    [scale * (now / rate - at_zero * x), scale * (now - at_zero), scale * rate * now];
                [[area, bell, -2.0 * x / width * bell], passive]
            }
            Self::Parabolic { lower, upper, passive } => {
                [bump(length, lower, upper), growing(length, upper).map(|value| passive * value)]
            }
        }
    }
}

/// Zero up to `lower` and from `upper` on, one at one.
fn bump(length: f64, lower: f64, upper: f64) -> Values {
    // One half of it, of the half width w, at a distance from its middle: one minus a parabola, then a
    // parabola that ends with the slope zero. The integral is from the middle.
    let half = |x: f64, w: f64| {
        let (h, y) = (0.5 * w, x / (0.5 * w));
        if y <= 1.0 {
            [h * (y - y * y * y / 6.0), 1.0 - 0.5 * y * y, -y / h]
        } else if y < 2.0 {
            let z = 2.0 - y;
            [h * (1.0 - z * z * z / 6.0), 0.5 * z * z, -z / h]
        } else {
            [h, 0.0, 0.0]
        }
    };
    if length >= 1.0 {
        half(length - 1.0, upper - 1.0)
    } else {
        let [area, value, slope] = half(1.0 - length, 1.0 - lower);
        [-area, value, -slope]
    }
}

/// Zero up to one, then a parabola up to the middle of one and `upper`, then straight.
fn growing(length: f64, upper: f64) -> Values {
    let h = 0.5 * (upper - 1.0);
    let x = (length - 1.0) / h;
    if x <= 0.0 {
        [0.0; 3]
    } else if x <= 1.0 {
        [h * x * x * x / 6.0, 0.5 * x * x, x / h]
    } else {
        let beyond = x - 1.0;
        [h * (1.0 / 6.0 + 0.5 * beyond * (1.0 + beyond)), 0.5 + beyond, 1.0 / h]
    }
}

/// erf x = 2/√π e^(−x²) Σ 2ⁿ x²ⁿ⁺¹/(2n + 1)!!, a sum without cancellation.
fn error_function(x: f64) -> f64 {
    if x.abs() > 6.0 {
        return 1f64.copysign(x);
    }
    let (mut term, mut sum, mut odd) = (x, x, 1.0);
    while term.abs() > f64::EPSILON * 0.25 * sum.abs() {
        odd += 2.0;
        term *= 2.0 * x * x / odd;
        sum += term;
    }
    2.0 / PI.sqrt() * (-x * x).exp() * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVES: [MuscleCurve; 2] = [
        MuscleCurve::Thelen { width: 0.45, passive_shape: 5.0, passive_strain: 0.6 },
        MuscleCurve::Parabolic { lower: 0.5, upper: 1.6, passive: 1.3 },
    ];

    #[test]
    fn curves_are_derivatives_of_one_another() {
        let h = 1e-4;
        for curve in CURVES {
            for k in 0..200 {
                let x = 0.3 + 0.00787 * f64::from(k);
                let [before, here, after] = [x - h, x, x + h].map(|x| curve.at(x));
                for i in 0..2 {
                    for order in 0..2 {
                        let slope = (after[i][order] - before[i][order]) / (2.0 * h);
                        assert!((slope - here[i][order + 1]).abs() < 2e-4, "{curve:?} {x} {i} {order}");
                    }
                }
            }
        }
    }

    #[test]
    fn published_values() {
        for curve in CURVES {
            let [[_, active, slope], _] = curve.at(1.0);
            assert!((active - 1.0).abs() < 1e-15 && slope.abs() < 1e-15);
        }
        let [[_, active, _], _] = CURVES[0].at(1.3);
        assert!((active - (-0.2f64).exp()).abs() < 1e-15);
        let [_, [_, passive, _]] = CURVES[0].at(1.6);
        assert!((passive - 1.0).abs() < 1e-15);
        let [_, [_, passive, _]] = CURVES[1].at(1.6);
        assert!((passive - 1.3 * 1.5).abs() < 1e-12);
    }

    #[test]
    fn error_function_of_tables() {
        for (x, value) in
            [(0.5, 0.520_499_877_813_046_5), (2.0, 0.995_322_265_018_952_7), (-1.0, -0.842_700_792_949_714_9)]
        {
            assert!((error_function(x) - value).abs() < 1e-15);
        }
    }
}
