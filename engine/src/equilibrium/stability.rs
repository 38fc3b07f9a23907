//! The stability of an equilibrium.

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
