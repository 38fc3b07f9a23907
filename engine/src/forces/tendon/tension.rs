//! The tension of a tendon as a function of its length.

use super::curve::MuscleCurve;

/// What a tendon's tension depends on; numbers are indices of parameters, and of the load input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tension {
    Cable {
        input: usize,
    },
    Spring {
        stiffness: usize,
        slack_length: usize,
        toe: f64,
    },
    Muscle {
        input: usize,
        max_force: usize,
        optimal_length: usize,
        tendon_slack_length: usize,
        curve: MuscleCurve,
    },
}

/// The potential of a tendon, the tension that is its slope by the length, and the slope of that.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pull {
    pub energy: f64,
    pub tension: f64,
    pub stiffness: f64,
}

impl Tension {
    pub fn at(&self, p: &[f64], load: &[f64], length: f64) -> Pull {
        match *self {
            Self::Cable { input } => {
                Pull { energy: load[input] * length, tension: load[input], stiffness: 0.0 }
            }
            Self::Spring { stiffness, slack_length, toe } => {
                let (k, rest) = (p[stiffness], p[slack_length]);
                let (s, w) = (length - rest, toe * rest);
                if s <= 0.0 {
                    Pull { energy: 0.0, tension: 0.0, stiffness: 0.0 }
                } else if s <= w {
                    let tension = 0.5 * k * s * s / w;
                    Pull { energy: tension * s / 3.0, tension, stiffness: k * s / w }
                } else {
                    let energy = k * (0.5 * s * s - 0.5 * w * s + w * w / 6.0);
                    Pull { energy, tension: k * (s - 0.5 * w), stiffness: k }
                }
            }
            Self::Muscle { input, max_force, optimal_length, tendon_slack_length, curve } => {
                let (force, optimal, slack) = (p[max_force], p[optimal_length], p[tendon_slack_length]);
                let [active, passive] = curve.at((length - slack) / optimal);
                let [energy, tension, slope] =
                    [0, 1, 2].map(|i| force * (load[input] * active[i] + passive[i]));
                Pull { energy: energy * optimal, tension, stiffness: slope / optimal }
            }
        }
    }

    /// The load input with the derivative of the tension by it.
    pub fn by_input(&self, p: &[f64], length: f64) -> Option<(usize, f64)> {
        match *self {
            Self::Cable { input } => Some((input, 1.0)),
            Self::Spring { .. } => None,
            Self::Muscle { input, max_force, optimal_length, tendon_slack_length, curve } => {
                let [active, _] = curve.at((length - p[tendon_slack_length]) / p[optimal_length]);
                Some((input, p[max_force] * active[1]))
            }
        }
    }

    /// Visits the parameters with the derivative of the tension by each, the length held.
    pub fn by_parameters(&self, p: &[f64], load: &[f64], length: f64, mut visit: impl FnMut(usize, f64)) {
        match *self {
            Self::Cable { .. } => {}
            Self::Spring { stiffness, slack_length, toe } => {
                let (k, rest) = (p[stiffness], p[slack_length]);
                let (s, w) = (length - rest, toe * rest);
                if s > w {
                    visit(stiffness, s - 0.5 * w);
                    visit(slack_length, -k * (1.0 + 0.5 * toe));
                } else if s > 0.0 {
                    visit(stiffness, 0.5 * s * s / w);
                    visit(slack_length, -k * s / w * (1.0 + 0.5 * toe * s / w));
                }
            }
            Self::Muscle { input, max_force, optimal_length, tendon_slack_length, curve } => {
                let Pull { stiffness, .. } = self.at(p, load, length);
                let fibres = (length - p[tendon_slack_length]) / p[optimal_length];
                let [active, passive] = curve.at(fibres);
                visit(max_force, load[input] * active[1] + passive[1]);
                visit(optimal_length, -stiffness * fibres);
                visit(tendon_slack_length, -stiffness);
            }
        }
    }

    /// Whether its parameters are physically meaningful.
    pub fn is_admissible(&self, p: &[f64]) -> bool {
        match *self {
            Self::Cable { .. } => true,
            Self::Spring { stiffness, slack_length, .. } => p[stiffness] >= 0.0 && p[slack_length] > 0.0,
            Self::Muscle { max_force, optimal_length, .. } => p[max_force] >= 0.0 && p[optimal_length] > 0.0,
        }
    }
}
