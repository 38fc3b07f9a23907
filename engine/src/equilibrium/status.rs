//! How the search for an equilibrium ended.

/// Every way a load step can end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// An equilibrium: the residual is below the tolerance.
    Converged = 0,
    /// An unstable equilibrium; no stable one was found.
    Unstable = 1,
    /// The limit on iterations was reached.
    IterationLimit = 2,
    /// No step lowers the energy any more, yet the residual is above tolerance.
    Stalled = 3,
    /// The energy is not a finite number, or the state diverged.
    Diverged = 4,
    /// The parameters are not admissible: not finite, or a length, radius or modulus is not positive.
    InvalidDesign = 5,
    /// An earlier load step failed.
    NotReached = 6,
    /// A force acts along a free motion, one without stiffness.
    Unrestrained = 7,
    /// The limit on time was reached.
    TimeLimit = 8,
    /// The solve was asked to stop.
    Cancelled = 9,
    /// Some tie could not be closed.
    NotClosed = 10,
    /// Conditions of ties depend on one another here, though not nearby: a singular configuration.
    Singular = 11,
    /// A branch that is followed by arc length closes on itself and never reaches the load.
    ClosedBranch = 12,
}

impl Status {
    /// All statuses, by code.
    pub const ALL: [Status; 13] = [
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
        Status::NotClosed,
        Status::Singular,
        Status::ClosedBranch,
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
            Status::NotClosed => "not-closed",
            Status::Singular => "singular",
            Status::ClosedBranch => "closed-branch",
        }
    }

    /// Whether the state is an equilibrium.
    pub fn is_equilibrium(self) -> bool {
        matches!(self, Status::Converged | Status::Unstable)
    }
}
