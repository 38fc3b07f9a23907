//! The six strain modes of a Cosserat rod.

use serde::Deserialize;

/// One component of the strain twist ξ, in the order [angular; linear].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Torsion about the tangent.
    TwistX,
    /// Bending about the local y axis.
    BendY,
    /// Bending about the local z axis.
    BendZ,
    /// Extension along the tangent.
    ExtendX,
    /// Shear along the local y axis.
    ShearY,
    /// Shear along the local z axis.
    ShearZ,
}

impl Mode {
    /// All modes, in the order of ξ.
    pub const ALL: [Mode; 6] =
        [Mode::TwistX, Mode::BendY, Mode::BendZ, Mode::ExtendX, Mode::ShearY, Mode::ShearZ];

    /// Position in ξ.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Curvatures and torsion, as opposed to extension and shear.
    pub fn is_angular(self) -> bool {
        self.index() < 3
    }

    /// The name used in model files and coordinate names.
    pub fn name(self) -> &'static str {
        ["twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z"][self.index()]
    }
}
