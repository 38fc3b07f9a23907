//! The stability of an equilibrium, from the eigenvalues of its tangent or of one nearby that is stiff enough.

use super::system::System;
use super::vector::max_norm;
use crate::lie::LieGroup;
use crate::tolerances::{DRIFT_EIGENVALUE, OF_RESIDUAL, SINGULAR_PIVOTS, TANGENT_RATE, ZERO_EIGENVALUE};

/// Static stability of an equilibrium, from the eigenvalues of its dimensionless tangent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Stability {
    /// All eigenvalues have positive real parts.
    Stable = 0,
    /// Some eigenvalues are zero, to the accuracy of the state; the others have positive real parts.
    Neutral = 1,
    /// A real eigenvalue is negative: some motion grows.
    Unstable = 2,
    /// Without a potential: a complex pair has a negative real part, so that masses and damping decide.
    FlutterUndecided = 3,
    /// The eigenvalues were not found, or there is no equilibrium.
    Unknown = 4,
}

impl Stability {
    /// All values, by code.
    pub const ALL: [Stability; 5] = [
        Stability::Stable,
        Stability::Neutral,
        Stability::Unstable,
        Stability::FlutterUndecided,
        Stability::Unknown,
    ];

    /// The name used in results and records.
    pub fn name(self) -> &'static str {
        match self {
            Stability::Stable => "stable",
            Stability::Neutral => "neutral",
            Stability::Unstable => "unstable",
            Stability::FlutterUndecided => "flutter-undecided",
            Stability::Unknown => "unknown",
        }
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> System<'_, G, D, P> {
    /// Whether the current tangent, which is factorised, is so stiff that the state evaluated last, near its own, is
    /// stable, too; then it stands for that of this state.
    pub(super) fn shows_stability(&mut self) -> bool {
        if !self.is_conservative() {
            return true;
        }
        let moved = self.q.iter().zip(&self.tangent_state).zip(&self.unit);
        let distance = moved.map(|((q, t), unit)| ((q - t) / unit).powi(2)).sum::<f64>().sqrt();
        let rate = TANGENT_RATE * self.stiffest().max(1.0);
        let slack = rate * distance + self.negligible_stiffness();
        self.surely_stable = self.factor.exceeds(&self.data, slack);
        if self.surely_stable {
            self.tangent_state.copy_from_slice(&self.q);
        }
        self.surely_stable
    }

    /// The largest stiffness of a coordinate; with ties, a bound on it.
    fn stiffest(&self) -> f64 {
        if let Some(projected) = self.factor.projected() {
            return projected.bounds().1;
        }
        let (tangent, scale) = (self.data.tangent(), &self.data.design.units.scale);
        let diagonal = tangent.iter().step_by(scale.len() + 1).zip(scale);
        diagonal.map(|(h, s)| (h * s * s).abs()).fold(0.0, f64::max)
    }

    /// Stiffness that counts as zero: that of a motion along which the energy is constant is of the size of the
    /// residual.
    fn negligible_stiffness(&self) -> f64 {
        (ZERO_EIGENVALUE + OF_RESIDUAL * max_norm(&self.residual)).min(DRIFT_EIGENVALUE)
    }

    /// Factorises the tangent; stiffness that is negligible may be negative.
    pub(super) fn factorise_neutral(&mut self) -> bool {
        self.factorise(0.0) || self.factorise(self.negligible_stiffness())
    }

    /// Whether the current tangent, which is factorised, has lost static stability by more than `slack`.
    pub(super) fn is_lost(&mut self, slack: f64) -> bool {
        if self.is_conservative() {
            return false;
        }
        let lost = self.factor.stability(&self.data, slack) == Stability::Unstable;
        self.factorise(0.0);
        lost
    }

    /// Whether some motion has next to no stiffness in the current tangent; its factor is kept.
    pub(super) fn may_drift(&mut self) -> bool {
        let found = self.factor.stability(&self.data, DRIFT_EIGENVALUE);
        self.factorise(0.0);
        found == Stability::Neutral
    }

    /// Static stability of the state evaluated last; its factor is kept.
    pub(super) fn stability(&mut self) -> Stability {
        let conservative = self.is_conservative();
        if conservative && self.is_singular() {
            return Stability::Neutral;
        }
        if self.tangent_state != self.q {
            self.evaluate();
            self.evaluate_tangent();
            self.factorise_neutral();
        }
        let slack = self.negligible_stiffness();
        if conservative && (self.surely_stable || self.factor.exceeds(&self.data, slack)) {
            return if self.has_neutral() { Stability::Neutral } else { Stability::Stable };
        }
        let found = self.factor.stability(&self.data, slack);
        self.factorise_neutral();
        found
    }

    /// Whether the matrix of adjoints at the equilibrium evaluated last is singular but for rounding; the factor is kept.
    pub(crate) fn is_nearly_singular(&mut self) -> bool {
        match self.factor.pivot_ratio() {
            Some(ratio) => ratio < SINGULAR_PIVOTS,
            None => !self.factor.exceeds(&self.data, ZERO_EIGENVALUE),
        }
    }
}
