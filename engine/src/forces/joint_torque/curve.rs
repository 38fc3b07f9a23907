//! Passive torque of a joint as a function of its coordinate: energy, torque, stiffness, and the derivatives
//! of the torque by the numbers of the curve.

use serde::Deserialize;

/// A torque m(θ) that resists θ; its energy is the integral of m from θ = 0.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum TorqueCurve {
    /// Two exponentials: `m = M₁ exp(r₁ (θ − θ₁)) − M₂ exp(−r₂ (θ − θ₂)) + M₀`.
    DoubleExponential {
        /// M₁, M₂ and M₀ [N·m or N].
        moments: [f64; 3],
        /// r₁ and r₂ [1/rad or 1/m].
        rates: [f64; 2],
        /// θ₁ and θ₂ [rad or m].
        angles: [f64; 2],
    },
    /// Cubic pieces between points, with the slope at each; linear beyond the first and the last.
    Table {
        /// Coordinates, increasing.
        angles: Vec<f64>,
        /// Torques there.
        torques: Vec<f64>,
        /// dm/dθ there.
        slopes: Vec<f64>,
    },
    /// Beyond an angle in one direction by s: `k s²/(2w)` up to s = w, and `k (s − w/2)` from there on.
    Threshold {
        /// The angle.
        angle: f64,
        /// k.
        stiffness: f64,
        /// w.
        width: f64,
        /// 1 if it acts above the angle, −1 if below.
        direction: f64,
    },
}

/// Energy, torque and stiffness of a curve at a coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Value {
    pub energy: f64,
    pub torque: f64,
    pub stiffness: f64,
}

/// The exponent beyond which an exponential is continued by its quadratic, so that a search that diverges
/// meets finite numbers.
const LARGEST_EXPONENT: f64 = 30.0;

/// exp, its derivative and its second derivative, continued.
fn exponential(x: f64) -> [f64; 3] {
    let over = (x - LARGEST_EXPONENT).max(0.0);
    let e = x.min(LARGEST_EXPONENT).exp();
    [e * (1.0 + over + 0.5 * over * over), e * (1.0 + over), e]
}

/// Polynomials of the cubic between two points in t ∈ [0, 1], for the values and slopes at both.
fn hermite(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [1.0 - 3.0 * t2 + 2.0 * t3, t - 2.0 * t2 + t3, 3.0 * t2 - 2.0 * t3, t3 - t2]
}

fn hermite_slope(t: f64) -> [f64; 4] {
    let t2 = t * t;
    [6.0 * (t2 - t), 1.0 - 4.0 * t + 3.0 * t2, 6.0 * (t - t2), 3.0 * t2 - 2.0 * t]
}

fn hermite_integral(t: f64) -> [f64; 4] {
    let (t2, t3, t4) = (t * t, t * t * t, t * t * t * t);
    [t - t3 + 0.5 * t4, 0.5 * t2 - 2.0 / 3.0 * t3 + 0.25 * t4, t3 - 0.5 * t4, 0.25 * t4 - t3 / 3.0]
}

impl TorqueCurve {
    /// The numbers that are parameters, by name and unit; units are those of an angle's joint.
    pub(super) fn numbers(&self) -> Vec<(&'static str, Option<&'static str>, Vec<f64>)> {
        match self {
            Self::DoubleExponential { moments, rates, angles } => vec![
                ("moments", None, moments.to_vec()),
                ("rates", None, rates.to_vec()),
                ("angles", None, angles.to_vec()),
            ],
            Self::Table { torques, slopes, .. } => {
                vec![("torques", None, torques.clone()), ("slopes", None, slopes.clone())]
            }
            Self::Threshold { angle, stiffness, width, .. } => vec![
                ("threshold", None, vec![*angle]),
                ("stiffness", None, vec![*stiffness]),
                ("width", None, vec![*width]),
            ],
        }
    }

    /// The curve without the numbers that are parameters: what it is whatever these are.
    pub(super) fn without_numbers(&self) -> Self {
        match self {
            Self::DoubleExponential { .. } => {
                Self::DoubleExponential { moments: [0.0; 3], rates: [0.0; 2], angles: [0.0; 2] }
            }
            Self::Table { angles, .. } => {
                Self::Table { angles: angles.clone(), torques: vec![], slopes: vec![] }
            }
            Self::Threshold { direction, .. } => {
                Self::Threshold { angle: 0.0, stiffness: 0.0, width: 0.0, direction: *direction }
            }
        }
    }

    /// Why the curve is none, if it is none.
    pub(super) fn problem(&self) -> Option<&'static str> {
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        match self {
            Self::DoubleExponential { moments, rates, angles } => {
                let sound = finite(moments) && finite(rates) && finite(angles);
                let sound = sound && moments[..2].iter().all(|m| *m >= 0.0) && rates.iter().all(|r| *r > 0.0);
                (!sound).then_some("needs finite numbers, moments that are not negative and positive rates")
            }
            Self::Table { angles, torques, slopes } => {
                let sound =
                    angles.len() >= 2 && torques.len() == angles.len() && slopes.len() == angles.len();
                let sound = sound && finite(angles) && finite(torques) && finite(slopes);
                let sound = sound && angles.windows(2).all(|pair| pair[0] < pair[1]);
                (!sound).then_some("needs two or more points with increasing angles, and finite numbers")
            }
            Self::Threshold { angle, stiffness, width, direction } => {
                let sound = finite(&[*angle, *stiffness]) && *stiffness >= 0.0 && *width > 0.0;
                let sound = sound && width.is_finite() && direction.abs() == 1.0;
                (!sound).then_some("needs a stiffness that is not negative, a positive width and a direction")
            }
        }
    }

    /// Whether parameters in the order of [`Self::numbers`] are admissible.
    pub(super) fn is_admissible(&self, p: &[f64]) -> bool {
        p.iter().all(|value| value.is_finite())
            && match self {
                Self::DoubleExponential { .. } => {
                    p[..2].iter().all(|m| *m >= 0.0) && p[3..5].iter().all(|rate| *rate > 0.0)
                }
                Self::Table { .. } => true,
                Self::Threshold { .. } => p[1] >= 0.0 && p[2] > 0.0,
            }
    }

    /// Energy, torque and stiffness at θ, for parameters in the order of [`Self::numbers`].
    pub(super) fn at(&self, p: &[f64], theta: f64) -> Value {
        let Value { energy, torque, stiffness } = self.value(p, theta);
        Value { energy: energy - self.value(p, 0.0).energy, torque, stiffness }
    }

    fn value(&self, p: &[f64], theta: f64) -> Value {
        match self {
            Self::DoubleExponential { .. } => {
                let [m1, m2, m0, r1, r2, t1, t2] = p[..7] else { return Value::default() };
                // The continued function is the energy, so that torque and stiffness are its derivatives.
                let (up, down) = (exponential(r1 * (theta - t1)), exponential(r2 * (t2 - theta)));
                Value {
                    energy: m1 / r1 * up[0] + m2 / r2 * down[0] + m0 * theta,
                    torque: m1 * up[1] - m2 * down[1] + m0,
                    stiffness: m1 * r1 * up[2] + m2 * r2 * down[2],
                }
            }
            Self::Table { angles, .. } => {
                let (torques, slopes) = p.split_at(angles.len());
                table(angles, torques, slopes, theta)
            }
            Self::Threshold { direction, .. } => {
                let (s, k, w) = (direction * (theta - p[0]), p[1], p[2]);
                if s <= 0.0 {
                    Value::default()
                } else if s <= w {
                    let (energy, torque) = (k * s.powi(3) / (6.0 * w), k * s * s / (2.0 * w));
                    Value { energy, torque: direction * torque, stiffness: k * s / w }
                } else {
                    let energy = k * (0.5 * s * s - 0.5 * w * s + w * w / 6.0);
                    Value { energy, torque: direction * k * (s - 0.5 * w), stiffness: k }
                }
            }
        }
    }

    /// Adds `factor` times the derivative of the torque at θ by each parameter.
    pub(super) fn add_slopes(&self, p: &[f64], theta: f64, factor: f64, out: &mut [f64]) {
        match self {
            Self::DoubleExponential { .. } => {
                let [m1, m2, _, r1, r2, t1, t2] = p[..7] else { return };
                let (up, down) = (exponential(r1 * (theta - t1)), exponential(r2 * (t2 - theta)));
                let slopes = [
                    up[1],
                    -down[1],
                    1.0,
                    m1 * up[2] * (theta - t1),
                    -m2 * down[2] * (t2 - theta),
                    -m1 * r1 * up[2],
                    -m2 * r2 * down[2],
                ];
                out.iter_mut().zip(slopes).for_each(|(out, slope)| *out += factor * slope);
            }
            Self::Table { angles, .. } => {
                let (n, last) = (angles.len(), angles.len() - 1);
                if theta < angles[0] || theta > angles[last] {
                    let end = if theta < angles[0] { 0 } else { last };
                    out[end] += factor;
                    out[n + end] += factor * (theta - angles[end]);
                    return;
                }
                let i = piece(angles, theta);
                let h = angles[i + 1] - angles[i];
                let [a, b, c, d] = hermite((theta - angles[i]) / h);
                out[i] += factor * a;
                out[i + 1] += factor * c;
                out[n + i] += factor * b * h;
                out[n + i + 1] += factor * d * h;
            }
            Self::Threshold { direction, .. } => {
                let (s, k, w) = (direction * (theta - p[0]), p[1], p[2]);
                let unit = self.value(&[p[0], 1.0, w], theta);
                let by_width = if s <= 0.0 { 0.0 } else { -0.5 * k * (s / w).min(1.0).powi(2) };
                out[0] -= factor * k * unit.stiffness;
                out[1] += factor * unit.torque;
                out[2] += factor * direction * by_width;
            }
        }
    }
}

/// The piece of a table that θ is in.
fn piece(angles: &[f64], theta: f64) -> usize {
    angles.partition_point(|angle| *angle <= theta).clamp(1, angles.len() - 1) - 1
}

fn table(angles: &[f64], torques: &[f64], slopes: &[f64], theta: f64) -> Value {
    let last = angles.len() - 1;
    let within = theta.clamp(angles[0], angles[last]);
    let i = piece(angles, within);
    let of = |i: usize| {
        let h = angles[i + 1] - angles[i];
        (h, [torques[i], h * slopes[i], torques[i + 1], h * slopes[i + 1]])
    };
    let dot = |a: [f64; 4], b: [f64; 4]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let whole: f64 = (0..i).map(of).map(|(h, values)| h * dot(hermite_integral(1.0), values)).sum();
    let (h, values) = of(i);
    let t = (within - angles[i]) / h;
    let inside = Value {
        energy: whole + h * dot(hermite_integral(t), values),
        torque: dot(hermite(t), values),
        stiffness: dot(hermite_slope(t), values) / h,
    };
    let beyond = theta - within;
    if beyond == 0.0 {
        return inside;
    }
    let slope = slopes[if beyond < 0.0 { 0 } else { last }];
    Value {
        energy: inside.energy + inside.torque * beyond + 0.5 * slope * beyond * beyond,
        torque: inside.torque + slope * beyond,
        stiffness: slope,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curves() -> [TorqueCurve; 4] {
        let threshold =
            |direction| TorqueCurve::Threshold { angle: 0.3, stiffness: 0.5, width: 0.1, direction };
        [
            TorqueCurve::DoubleExponential {
                moments: [0.02, 0.03, 0.001],
                rates: [4.0, 6.0],
                angles: [1.2, -0.2],
            },
            TorqueCurve::Table {
                angles: vec![-0.5, 0.0, 0.4, 1.5],
                torques: vec![-0.2, 0.01, 0.02, 0.3],
                slopes: vec![0.6, 0.05, 0.04, 0.5],
            },
            threshold(1.0),
            threshold(-1.0),
        ]
    }

    fn parameters(curve: &TorqueCurve) -> Vec<f64> {
        curve.numbers().into_iter().flat_map(|(_, _, values)| values).collect()
    }

    #[test]
    fn torque_and_stiffness_are_derivatives_of_the_energy() {
        for curve in curves() {
            let p = parameters(&curve);
            for step in -40..60 {
                let (theta, h) = (0.05 * f64::from(step) + 0.013, 1e-5);
                let [low, mid, high] = [theta - h, theta, theta + h].map(|t| curve.at(&p, t));
                let scale = 1.0 + mid.stiffness.abs();
                assert!((mid.torque - (high.energy - low.energy) / (2.0 * h)).abs() < 1e-7 * scale);
                assert!((mid.stiffness - (high.torque - low.torque) / (2.0 * h)).abs() < 1e-6 * scale);
            }
            assert_eq!(curve.at(&p, 0.0).energy, 0.0);
        }
    }

    #[test]
    fn derivatives_by_the_numbers_of_a_curve() {
        for curve in curves() {
            let p = parameters(&curve);
            for theta in [-0.9, -0.3, 0.1, 0.33, 0.7, 1.9] {
                let mut slopes = vec![0.0; p.len()];
                curve.add_slopes(&p, theta, 2.0, &mut slopes);
                for k in 0..p.len() {
                    let moved = |h: f64| {
                        let mut p = p.clone();
                        p[k] += h;
                        curve.at(&p, theta).torque
                    };
                    let expected = 2.0 * (moved(1e-6) - moved(-1e-6)) / 2e-6;
                    assert!((slopes[k] - expected).abs() < 1e-7 * (1.0 + expected.abs()), "{k} at {theta}");
                }
            }
        }
    }

    #[test]
    fn closed_forms() {
        let [exponentials, table, ..] = curves();
        let found = exponentials.at(&parameters(&exponentials), 1.2);
        let expected = 0.02 - 0.03 * (-6.0f64 * 1.4).exp() + 0.001;
        assert!((found.torque - expected).abs() < 1e-15);
        // At its points a table has the given torques and slopes.
        let found = table.at(&parameters(&table), 0.4);
        assert!((found.torque - 0.02).abs() < 1e-16 && (found.stiffness - 0.04).abs() < 1e-15);
        // Far away numbers stay finite.
        assert!(exponentials.at(&parameters(&exponentials), 1e3).energy.is_finite());
    }
}
