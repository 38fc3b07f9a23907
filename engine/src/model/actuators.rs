//! Thread-like actuators of the built model.

/// A chamber or cable: one load input acting along a path on one rod.
#[derive(Clone, Debug)]
pub(crate) struct Actuator {
    pub rod: usize,
    /// +1 when a positive input lengthens the path, −1 when it shortens it.
    pub sign: f64,
    /// Parameter holding the lever (y, z).
    pub lever: usize,
    /// One per Gauss point of the rod.
    pub tendon: Vec<Tendon>,
}

/// The fixed part of the path at a Gauss point.
#[derive(Clone, Debug)]
pub(crate) struct Tendon {
    pub offset: [f64; 2],
    pub slope: [f64; 2],
}
