//! The description of ties and how they are built.

use super::{Condition, Drive, Row, Tie, Ties};
use crate::lie::LieGroup;
use crate::tree::description::AttachmentDescription;
use crate::tree::{ModelError, Point, Tree, finite};
use serde::Deserialize;

/// The kinds of tie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TieKind {
    /// No relative motion.
    Weld,
    /// Relative rotation only.
    Pin,
    /// Relative rotation about `axis` only.
    Hinge,
    /// Relative translation along `axis` only.
    Slider,
}

/// The relative motion that a load prescribes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TieDrive {
    /// Of the second place along `axis` [m].
    Displacement,
    /// Of the second place about `axis` [rad], over any number of turns.
    Rotation,
}

/// A tie between two places: a joint that closes a loop.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TieDescription {
    /// Unique name.
    pub name: String,
    /// What it prevents.
    pub kind: TieKind,
    /// One place, in whose local frame directions are fixed.
    pub first: AttachmentDescription,
    /// The other place.
    pub second: AttachmentDescription,
    /// Unit vector of the axis in the local frame of the first place.
    pub axis: [f64; 3],
    /// Rotation vector, in the same frame, by which the second place is turned from its orientation in the
    /// reference state [rad].
    #[serde(default)]
    pub rotation: [f64; 3],
    /// The relative motion that a load input of its name prescribes, if there is one.
    #[serde(default)]
    pub drive: Option<TieDrive>,
}

/// The normal of the plane of a planar system.
const NORMAL: [f64; 3] = [0.0, 1.0, 0.0];

impl<const P: usize> Ties<P> {
    pub fn build<G: LieGroup<D, P>, const D: usize>(
        tree: &mut Tree<G, D, P>,
        ties: &[TieDescription],
    ) -> Result<Self, ModelError> {
        let mut built = Self { ties: vec![], rows: vec![], inputs: 0 };
        for tie in ties {
            built.add(tree, tie)?;
        }
        built.inputs = tree.inputs.len();
        Ok(built)
    }

    fn add<G: LieGroup<D, P>, const D: usize>(
        &mut self,
        tree: &mut Tree<G, D, P>,
        tie: &TieDescription,
    ) -> Result<(), ModelError> {
        let field = |f: &str| format!("ties.{}.{f}", tie.name);
        finite(field("rotation"), &tie.rotation)?;
        if tie.kind == TieKind::Pin && tie.drive == Some(TieDrive::Rotation) {
            return Err(ModelError::new(field("drive"), "found rotation, but a pin holds no rotation"));
        }
        let axes = axes::<P>(tie).map_err(|problem| ModelError::new(field("axis"), problem))?;
        if P == 2 && (tie.rotation[0] != 0.0 || tie.rotation[2] != 0.0) {
            return Err(ModelError::new(field("rotation"), "a planar system turns about y only"));
        }
        let points = [tree.attach(&field("first"), &tie.first)?, tree.attach(&field("second"), &tie.second)?];
        if is_one_rigid_body(tree, points.map(|point| &tree.points[point])) {
            return Err(ModelError::new(field("second"), "found a place of the same rigid body as first"));
        }
        for point in points {
            tree.keep_jacobian(tree.points[point].frame);
        }
        let drive = tie.drive.map(|kind| {
            let twist = drive_twist(kind, &tie.axis);
            Drive { input: tree.input(&tie.name), twist, row: 0 }
        });
        let start = self.rows.len();
        let conditions = conditions::<G, D, P>(tie, &axes);
        self.rows.extend(conditions.into_iter().map(|condition| Row { tie: self.ties.len(), condition }));
        let rows = start..self.rows.len();
        // The driven condition is the last one.
        let drive = drive.map(|drive| Drive { row: rows.end - 1, ..drive });
        let slides = tie.kind == TieKind::Slider;
        let along = G::point_from_spatial(&tie.axis).filter(|_| slides);
        let turns = rows.clone().any(|row| self.row(row).1);
        let rotation = if turns { tie.rotation } else { [0.0; 3] };
        self.ties.push(Tie { name: tie.name.clone(), points, rows, drive, rotation, along });
        Ok(())
    }
}

/// Whether two points do not move relative to one another in any state.
fn is_one_rigid_body<G: LieGroup<D, P>, const D: usize, const P: usize>(
    tree: &Tree<G, D, P>,
    [a, b]: [&Point<P>; 2],
) -> bool {
    // A frame moves with the last frame before it that has coordinates of its own.
    let carrier = |mut frame: usize| {
        while frame != 0 && tree.frames[frame].columns.is_empty() {
            frame = tree.frames[frame].parent;
        }
        frame
    };
    carrier(a.frame) == carrier(b.frame)
}

/// An orthonormal basis with the axis first; in the plane, unless the axis is its normal, the third vector is
/// the normal.
fn axes<const P: usize>(tie: &TieDescription) -> Result<[[f64; 3]; 3], String> {
    let axis = tie.axis;
    let norm = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !((norm - 1.0).abs() <= crate::tolerances::UNIT_NORM) {
        return Err(format!("found {axis:?}, must be a unit vector"));
    }
    let turns = tie.kind == TieKind::Hinge || tie.drive == Some(TieDrive::Rotation);
    if P == 2 {
        let normal = axis[0] == 0.0 && axis[2] == 0.0;
        let needed = tie.kind == TieKind::Slider || tie.drive == Some(TieDrive::Displacement);
        if turns && !normal {
            return Err(format!("found {axis:?}, a planar system turns about y only"));
        }
        if needed && axis[1] != 0.0 {
            return Err(format!("found {axis:?}, must lie in the x–z plane of a planar system"));
        }
        let first = if normal { [1.0, 0.0, 0.0] } else { axis };
        return Ok([first, cross(NORMAL, first), NORMAL]);
    }
    // The coordinate axis that is most nearly normal to it.
    let least = (0..3).min_by(|i, j| axis[*i].abs().total_cmp(&axis[*j].abs())).unwrap_or(0);
    let mut other = [0.0; 3];
    other[least] = 1.0;
    let mut second = cross(other, axis);
    let length = second.iter().map(|x| x * x).sum::<f64>().sqrt();
    second.iter_mut().for_each(|x| *x /= length);
    Ok([axis, second, cross(axis, second)])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The driven motion as a twist in the local frame of the first place, by strain mode.
fn drive_twist(kind: TieDrive, axis: &[f64; 3]) -> [f64; 6] {
    let mut twist = [0.0; 6];
    let start = if kind == TieDrive::Rotation { 0 } else { 3 };
    twist[start..start + 3].copy_from_slice(axis);
    twist
}

/// The conditions of a tie, the driven one last.
fn conditions<G: LieGroup<D, P>, const D: usize, const P: usize>(
    tie: &TieDescription,
    axes: &[[f64; 3]; 3],
) -> Vec<Condition<P>> {
    let vector = |v: [f64; 3]| G::point_from_spatial(&v);
    let along = |i: usize| vector(axes[i]).map(Condition::Along);
    // Turned about one axis, a second one moves along or against the third.
    let about = |i: usize| {
        let (fixed, turned) = match i {
            _ if P == 2 => {
                ([if tie.axis == [0.0, -1.0, 0.0] { -1.0 } else { 1.0 }, 0.0, 0.0], [0.0, 0.0, 1.0])
            }
            0 => (axes[2], axes[1]),
            1 => (axes[2].map(|x| -x), axes[0]),
            _ => (axes[1], axes[0]),
        };
        Some(Condition::About { fixed: vector(fixed)?, turned: vector(turned)? })
    };
    let driven = tie.drive;
    let (translations, rotations): (&[usize], &[usize]) = match tie.kind {
        TieKind::Weld => (&[0, 1, 2], if P == 2 { &[2] } else { &[0, 1, 2] }),
        TieKind::Pin => (&[0, 1, 2], &[]),
        TieKind::Hinge => (&[0, 1, 2], if P == 2 { &[] } else { &[1, 2] }),
        TieKind::Slider => (&[1, 2], if P == 2 { &[2] } else { &[0, 1, 2] }),
    };
    let last = match driven {
        Some(TieDrive::Displacement) => along(0),
        Some(TieDrive::Rotation) => about(if P == 2 { 2 } else { 0 }),
        None => None,
    };
    let mut found: Vec<Condition<P>> = translations
        .iter()
        .filter_map(|i| along(*i))
        .chain(rotations.iter().filter_map(|i| about(*i)))
        .collect();
    if let Some(last) = last {
        found.retain(|condition| *condition != last);
        found.push(last);
    }
    found
}
