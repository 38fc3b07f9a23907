//! Results of following a path: states at the listed loads and events between them.

use super::stability::Stability;
use super::status::Status;
use super::system::{Accuracy, System};

/// What happened to a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum EventKind {
    /// The branch ended, and the system jumped to another equilibrium.
    Snap = 0,
    /// Another branch crosses, and the system follows it continuously.
    Bifurcation = 1,
}

impl EventKind {
    /// All kinds, by code.
    pub const ALL: [EventKind; 2] = [EventKind::Snap, EventKind::Bifurcation];

    /// The name used in results and records.
    pub fn name(self) -> &'static str {
        match self {
            EventKind::Snap => "snap",
            EventKind::Bifurcation => "bifurcation",
        }
    }
}

/// An event between two load steps.
#[derive(Clone, Debug)]
pub struct Event<'a> {
    /// Index of the load step being approached.
    pub step: usize,
    /// What happened.
    pub kind: EventKind,
    /// Load at which the branch lost its stability.
    pub load: &'a [f64],
    /// State before.
    pub before: &'a [f64],
    /// State after.
    pub after: &'a [f64],
}

/// The state at one of the listed loads.
#[derive(Clone, Copy, Debug)]
pub struct StepReport<'a> {
    /// How the step ended.
    pub status: Status,
    /// State; meaningful for equilibria only.
    pub q: &'a [f64],
    /// Iterations (evaluations of the tangent) used for this step.
    pub iterations: usize,
    /// Its static stability.
    pub stability: Stability,
    /// How well forces balance.
    pub accuracy: Accuracy,
    /// Where ties end the path, the load of the last equilibrium.
    pub reached: Option<&'a [f64]>,
    /// Coordinates of the free motions.
    pub free: &'a [usize],
}

/// Receives the results of a path as they are computed.
pub trait PathSink<G, const D: usize, const P: usize> {
    /// A listed load has been solved; the system is still in that state.
    fn step(&mut self, index: usize, report: StepReport, system: &System<G, D, P>);
    /// An event occurred between two listed loads.
    fn event(&mut self, event: Event);
}
