//! What a sphere feels in an obstacle.

/// Energy, force and stiffness at a depth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pressing {
    /// Energy [J].
    pub energy: f64,
    /// Force along the normal [N].
    pub force: f64,
    /// Its derivative by the depth [N/m].
    pub stiffness: f64,
    /// Pressure [Pa], of a skin.
    pub pressure: Option<f64>,
}

impl Pressing {
    /// That of a spring of stiffness k.
    pub fn of_spring(k: f64, depth: f64) -> Self {
        Self { energy: 0.5 * k * depth * depth, force: k * depth, stiffness: k, pressure: None }
    }
}

/// Derivatives of a force at a depth that is held.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Slopes {
    /// By the radius of the sphere.
    pub by_surface: f64,
    /// By that of the obstacle's surface.
    pub by_radius: f64,
}
