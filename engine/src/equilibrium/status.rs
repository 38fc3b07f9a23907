//! How the search for an equilibrium ended.

/// Every way a load step can end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// An equilibrium: the residual is below the tolerance.
    Converged = 0,
    /// An equilibrium from which some motion grows by itself, without a stable one to be found.
    Unstable = 1,
    /// The allowed number of iterations was used up.
    IterationLimit = 2,
    /// No step lowers the energy any more, yet the residual is above tolerance.
    Stalled = 3,
    /// The energy is not a finite number, or the state ran away.
    Diverged = 4,
    /// The parameters are not admissible: not finite, or a length, radius or modulus is not positive.
    InvalidDesign = 5,
    /// An earlier load step failed.
    NotReached = 6,
    /// A force acts on a motion that nothing holds.
    Unrestrained = 7,
    /// The allowed time was used up.
    TimeLimit = 8,
    /// The solve was asked to stop.
    Cancelled = 9,
}

impl Status {
    /// All statuses, by code.
    pub const ALL: [Status; 10] = [
        Status::Converged,
        Status::Unstable,
        Status::IterationLimit,
        Status::Stalled,
        Status::Diverged,
        Status::InvalidDesign,
        Status::NotReached,
        Status::Unrestrained,
        Status::TimeLimit,
        Status::Cancelled,
    ];

    /// The name used in results and records.
    pub fn name(self) -> &'static str {
        match self {
            Status::Converged => "converged",
            Status::Unstable => "unstable",
            Status::IterationLimit => "iteration-limit",
            Status::Stalled => "stalled",
            Status::Diverged => "diverged",
            Status::InvalidDesign => "invalid-design",
            Status::NotReached => "not-reached",
            Status::Unrestrained => "unrestrained",
            Status::TimeLimit => "time-limit",
            Status::Cancelled => "cancelled",
        }
    }

    /// Whether the state is an equilibrium.
    pub fn is_equilibrium(self) -> bool {
        matches!(self, Status::Converged | Status::Unstable)
    }
}
