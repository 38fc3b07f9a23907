//! Whether a derivative means anything.

use crate::data::Data;
use crate::equilibrium::{Status, System};
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::{Contact, Model};
use crate::potential::round_cone::{closest, counts};

/// Why an equilibrium may have no derivative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Regularity {
    /// The derivative is that of a smooth branch.
    Regular = 0,
    /// The state is not a stable equilibrium.
    NoEquilibrium = 1,
    /// The path snapped on the way: the derivative holds on the final branch only.
    Snapped = 2,
    /// A contact is at the threshold of touching, or a sphere passes from the side of a round cone to
    /// its end: the derivative is one-sided.
    ContactThreshold = 3,
    /// The tangent is nearly singular: the state is about to snap.
    NearlySingular = 4,
}

impl Regularity {
    /// All values, by code.
    pub const ALL: [Regularity; 5] = [
        Regularity::Regular,
        Regularity::NoEquilibrium,
        Regularity::Snapped,
        Regularity::ContactThreshold,
        Regularity::NearlySingular,
    ];

    /// The name used in results.
    pub fn name(self) -> &'static str {
        match self {
            Regularity::Regular => "regular",
            Regularity::NoEquilibrium => "no-equilibrium",
            Regularity::Snapped => "snapped",
            Regularity::ContactThreshold => "contact-threshold",
            Regularity::NearlySingular => "nearly-singular",
        }
    }
}

/// Ratio of pivots below which the tangent counts as singular.
const SINGULAR: f64 = 1e-9;
/// Gap below which a pair counts as being at the threshold, relative to the sum of its radii.
const THRESHOLD: f64 = 1e-7;

impl Regularity {
    /// Judges the equilibrium that the system is in.
    pub(crate) fn of<G: LieGroup<D, P>, const D: usize, const P: usize>(
        model: &Model<G, D, P>,
        system: &System<G, D, P>,
        status: Status,
        snapped: bool,
    ) -> Self {
        if status != Status::Converged {
            Self::NoEquilibrium
        } else if system.pivot_ratio() < SINGULAR {
            Self::NearlySingular
        } else if at_threshold(model, system.data()) {
            Self::ContactThreshold
        } else if snapped {
            Self::Snapped
        } else {
            Self::Regular
        }
    }
}

/// Whether any pair of spheres that can move against one another is just about to touch or to part.
fn at_threshold<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
) -> bool {
    let points = &data.kinematics.points;
    for contact in &model.contacts {
        if !contact.cones.is_empty() {
            if cone_at_threshold(model, data, contact) {
                return true;
            }
            continue;
        }
        for first in contact.first.clone() {
            let a = model.spheres[first].point;
            let start = if contact.is_self() { first + contact.skip.max(1) } else { contact.second.start };
            for second in start..contact.second.end {
                let b = model.spheres[second].point;
                let reach = data.design.radii[first] + data.design.radii[second];
                let r = points[a] - points[b];
                let distance = r.norm();
                if (distance - reach).abs() < THRESHOLD * reach && distance > 0.0 {
                    let n = r * (1.0 / distance);
                    if can_move(model, data, a, &n) || can_move(model, data, b, &n) {
                        return true;
                    }
                }
            }
        }
    }
    false
}

/// The same for spheres against round cones, and whether a sphere in contact is just about to pass
/// from a cone's side to its end.
fn cone_at_threshold<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
    contact: &Contact,
) -> bool {
    let (points, radii) = (&data.kinematics.points, &data.design.radii);
    for first in contact.first.clone() {
        if contact.weight(&data.design.parameters, first) == 0.0 {
            continue;
        }
        let p = model.spheres[first].point;
        for cone in contact.cones.iter().filter(|c| counts(contact, first, c)) {
            let [a, b] = cone.ends.map(|s| model.spheres[s].point);
            let found = closest(&points[p], [&points[a], &points[b]], cone.ends.map(|s| radii[s]));
            let reach = radii[first] + found.radius;
            let moves = |direction: &Vector<P>, touched: [bool; 2]| {
                can_move(model, data, p, direction)
                    || (touched[0] && can_move(model, data, a, direction))
                    || (touched[1] && can_move(model, data, b, direction))
            };
            let gap = found.distance - reach;
            if gap.abs() < THRESHOLD * reach && moves(&found.normal, [found.t < 1.0, found.t > 0.0]) {
                return true;
            }
            let passing = |t: f64| t.abs().min((t - 1.0).abs()) < THRESHOLD;
            if gap < 0.0 && found.unbounded.is_some_and(passing) {
                let axis = points[b] - points[a];
                if moves(&axis, [true; 2]) || moves(&found.normal, [true; 2]) {
                    return true;
                }
            }
        }
    }
    false
}

/// Whether any coordinate moves a point along `direction`: a sphere on a joint's axis does not move.
fn can_move<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
    point: usize,
    direction: &Vector<P>,
) -> bool {
    let wrench = G::point_jacobian(&data.kinematics.points[point]).transpose_times(direction);
    let mut f = model.points[point].frame;
    while f != 0 {
        let mut columns = data.assembly.columns(model, f);
        if columns.any(|(_, column)| wrench.dot(&column).abs() > 1e-12 * column.norm()) {
            return true;
        }
        f = model.frames[f].parent;
    }
    false
}
