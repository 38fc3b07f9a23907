//! Validity of derivatives.

use crate::data::Data;
use crate::equilibrium::System;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::Model;

/// Why an equilibrium may have no derivative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Regularity {
    /// The derivative is that of a smooth branch.
    Regular = 0,
    /// The state is not a stable equilibrium.
    NoEquilibrium = 1,
    /// The path snapped: the derivative holds on the final branch only.
    Snapped = 2,
    /// A contact is at the threshold of touching, or a sphere passes from the side of a round cone to
    /// its end: the derivative is one-sided.
    ContactThreshold = 3,
    /// The tangent is nearly singular: the state is about to snap.
    NearlySingular = 4,
    /// It is that of the largest of several numbers, and another one equals it.
    Tied = 5,
}

impl Regularity {
    /// All values, by code.
    pub const ALL: [Regularity; 6] = [
        Regularity::Regular,
        Regularity::NoEquilibrium,
        Regularity::Snapped,
        Regularity::ContactThreshold,
        Regularity::NearlySingular,
        Regularity::Tied,
    ];

    /// The name used in results.
    pub fn name(self) -> &'static str {
        match self {
            Regularity::Regular => "regular",
            Regularity::NoEquilibrium => "no-equilibrium",
            Regularity::Snapped => "snapped",
            Regularity::ContactThreshold => "contact-threshold",
            Regularity::NearlySingular => "nearly-singular",
            Regularity::Tied => "tied",
        }
    }
}

impl Regularity {
    /// The regularity of the system's current equilibrium, regardless of how it was reached.
    pub(crate) fn of<G: LieGroup<D, P>, const D: usize, const P: usize>(
        model: &Model<G, D, P>,
        system: &mut System<G, D, P>,
    ) -> Self {
        if system.is_nearly_singular() {
            Self::NearlySingular
        } else if at_threshold(model, system) {
            Self::ContactThreshold
        } else {
            Self::Regular
        }
    }
}

/// Whether a force is about to switch on or off at points that can move.
fn at_threshold<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    system: &System<G, D, P>,
) -> bool {
    let data = system.data();
    let moves = |points: &[usize], direction: &Vector<P>| {
        points.iter().any(|point| can_move(model, data, *point, direction))
    };
    model.forces.are_at_threshold(&data.state(model, system.state(), system.load()), &moves)
}

/// Whether any coordinate moves a point along `direction`: a sphere on a joint's axis does not move.
fn can_move<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
    point: usize,
    direction: &Vector<P>,
) -> bool {
    let wrench = G::point_jacobian(&data.kinematics.points[point]).transpose_times(direction);
    let mut f = data.design.geometry.frames[point];
    while f != 0 {
        let mut columns = data.assembly.columns(model, f);
        if columns.any(|(_, column)| wrench.dot(&column).abs() > 1e-12 * column.norm()) {
            return true;
        }
        f = model.frames[f].parent;
    }
    false
}
