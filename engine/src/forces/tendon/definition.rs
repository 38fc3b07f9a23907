//! Definition of tendons.

use super::curve::MuscleCurve;
use super::guide::GuideFriction;
use super::tension::Tension;
use super::{Leg, Tendon, Wrap};
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tolerances::UNIT_NORM;
use crate::tree::description::AttachmentDescription;
use crate::tree::{ModelError, Tree, finite, not_negative, positive};
use serde::Deserialize;

/// A sphere or an endless cylinder around which tendons pass, on a body or in the world.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WrapDescription {
    /// Unique name.
    pub name: String,
    /// Its centre.
    pub at: AttachmentDescription,
    /// Unit vector along a cylinder, in the frame that carries it; none for a sphere.
    #[serde(default)]
    pub axis: Option<[f64; 3]>,
    /// Radius [m].
    pub radius: f64,
}

/// A stage of a tendon's path.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum StageDescription {
    /// A point through which it passes.
    Point(AttachmentDescription),
    /// What it may touch between the points before and after.
    Wrap {
        /// Name of the wrap.
        name: String,
        /// A point on the side on which it passes; in the wrap, it passes inside.
        #[serde(default)]
        side: Option<AttachmentDescription>,
    },
    /// A new branch begins here, whose length counts by one part in so many.
    Branch(f64),
}

/// What a tendon's tension is.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum TensionDescription {
    /// That of a load input of the tendon's name [N].
    Cable {},
    /// Elastic: it only pulls.
    Spring {
        /// Stiffness beyond the toe [N/m].
        stiffness: f64,
        /// Longest length without tension [m].
        slack_length: f64,
        /// Strain over which the stiffness builds up.
        toe: f64,
    },
    /// A muscle in series with a tendon of constant length; a load input of its name is its activation.
    Muscle {
        /// Largest active force along the tendon [N].
        max_force: f64,
        /// Length of the fibres at which it has that [m].
        optimal_length: f64,
        /// Length of the tendon [m].
        tendon_slack_length: f64,
        /// Its curves.
        curve: MuscleCurve,
    },
}

/// A tendon across bodies.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TendonDescription {
    /// Unique name.
    pub name: String,
    /// Its path, from a point to a point.
    pub path: Vec<StageDescription>,
    /// Its tension.
    pub tension: TensionDescription,
    /// Friction at the points that it passes, of a path without wraps and branches.
    #[serde(default)]
    pub friction: Option<GuideDescription>,
}

/// Friction of a tendon in its guides.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GuideDescription {
    /// Coefficient of friction μ.
    pub coefficient: f64,
    /// Stiffness with which it gives at each guide before it slides [N/m].
    pub stiffness: f64,
}

impl<const P: usize> Wrap<P> {
    pub fn build<G: LieGroup<D, P>, const D: usize>(
        tree: &mut Tree<G, D, P>,
        wrap: &WrapDescription,
    ) -> Result<Self, ModelError> {
        let field = |f: &str| format!("wraps.{}.{f}", wrap.name);
        positive(field("radius"), wrap.radius)?;
        let axis = wrap.axis.map(|axis| Self::axis::<G, D>(&field("axis"), &axis)).transpose()?.flatten();
        let point = tree.attach(&field("at"), &wrap.at)?;
        let frame = tree.points[point].frame;
        tree.keep_jacobian(frame);
        let radius = tree.slot(format!("{}.radius", wrap.name), "m", &[wrap.radius]).start;
        Ok(Self { point, frame, axis, radius })
    }

    /// In the plane a cylinder is across it, which is a circle.
    fn axis<G: LieGroup<D, P>, const D: usize>(
        field: &str,
        axis: &[f64; 3],
    ) -> Result<Option<Vector<P>>, ModelError> {
        finite(field, axis)?;
        let norm = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (norm - 1.0).abs() > UNIT_NORM {
            return Err(ModelError::new(field, format!("found {axis:?}, must be a unit vector")));
        }
        if P == 2 {
            let across = axis[0] == 0.0 && axis[2] == 0.0;
            let problem = "a cylinder of a planar system is across the x–z plane";
            return if across { Ok(None) } else { Err(ModelError::new(field, problem)) };
        }
        Ok(G::point_from_spatial(axis))
    }
}

impl Tendon {
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        tendon: &TendonDescription,
        wraps: &[WrapDescription],
        built: &[Wrap<P>],
    ) -> Result<Self, ModelError> {
        let field = |f: &str| format!("tendons.{}.{f}", tendon.name);
        let mut legs: Vec<Leg> = vec![];
        let (mut last, mut wrap, mut divisor) = (None, None, 1.0);
        for (index, stage) in tendon.path.iter().enumerate() {
            let place = field(&format!("path[{index}]"));
            match stage {
                StageDescription::Point(at) => {
                    let point = tree.attach(&place, at)?;
                    tree.keep_jacobian(tree.points[point].frame);
                    if let Some(before) = last {
                        legs.push(Leg { points: [before, point], wrap: wrap.take(), divisor });
                    }
                    last = Some(point);
                }
                StageDescription::Wrap { name, side } => {
                    if last.is_none() || wrap.is_some() {
                        return Err(ModelError::new(place, "a wrap has a point before and after it"));
                    }
                    let found = wraps.iter().position(|wrap| wrap.name == *name);
                    let found =
                        found.ok_or_else(|| ModelError::new(&place, format!("no wrap is named `{name}`")))?;
                    let side = side.as_ref().map(|side| tree.attach(&format!("{place}.side"), side));
                    wrap = Some((found, side.transpose()?));
                }
                StageDescription::Branch(by) => {
                    if last.is_none() || wrap.is_some() {
                        return Err(ModelError::new(place, "a branch begins and ends with a point"));
                    }
                    divisor = positive(place, *by)?;
                    last = None;
                }
            }
        }
        if legs.is_empty() || wrap.is_some() || last.is_none() {
            return Err(ModelError::new(field("path"), "a path goes from a point to another one"));
        }
        let tension = Self::tension(tree, tendon)?;
        let mut frames: Vec<usize> = vec![];
        for leg in &legs {
            frames.extend(leg.points.map(|point| tree.points[point].frame));
            if let Some((wrap, _)) = leg.wrap {
                frames.push(built[wrap].frame);
            }
        }
        frames.retain(|frame| *frame != 0);
        frames.sort_unstable();
        frames.dedup();
        let friction = tendon.friction.map(|friction| Self::friction(tree, tendon, &friction)).transpose()?;
        Ok(Self { legs, frames, tension, friction })
    }

    /// Whether its parameters are physically meaningful.
    pub fn is_admissible(&self, parameters: &[f64]) -> bool {
        self.tension.is_admissible(parameters)
            && self.friction.is_none_or(|friction| parameters[friction.coefficient] >= 0.0)
    }

    fn friction<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        tendon: &TendonDescription,
        friction: &GuideDescription,
    ) -> Result<GuideFriction, ModelError> {
        let field = |f: &str| format!("tendons.{}.friction.{f}", tendon.name);
        not_negative(field("coefficient"), friction.coefficient)?;
        positive(field("stiffness"), friction.stiffness)?;
        if !tendon.path.iter().all(|stage| matches!(stage, StageDescription::Point(_))) {
            let problem = "acts at points: the path must have neither wraps nor branches";
            return Err(ModelError::new(format!("tendons.{}.friction", tendon.name), problem));
        }
        let slot = tree.slot(format!("{}.friction", tendon.name), "1", &[friction.coefficient]);
        Ok(GuideFriction { coefficient: slot.start, stiffness: friction.stiffness })
    }

    fn tension<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        tendon: &TendonDescription,
    ) -> Result<Tension, ModelError> {
        let name = &tendon.name;
        let field = |f: &str| format!("tendons.{name}.{f}");
        Ok(match tendon.tension {
            TensionDescription::Cable {} => Tension::Cable { input: tree.input(name) },
            TensionDescription::Spring { stiffness, slack_length, toe } => {
                not_negative(field("stiffness"), stiffness)?;
                positive(field("slack_length"), slack_length)?;
                positive(field("toe"), toe)?;
                Tension::Spring {
                    stiffness: tree.slot(format!("{name}.stiffness"), "N/m", &[stiffness]).start,
                    slack_length: tree.slot(format!("{name}.slack_length"), "m", &[slack_length]).start,
                    toe,
                }
            }
            TensionDescription::Muscle { max_force, optimal_length, tendon_slack_length, curve } => {
                not_negative(field("max_force"), max_force)?;
                positive(field("optimal_length"), optimal_length)?;
                finite(field("tendon_slack_length"), &[tendon_slack_length])?;
                if !curve.is_valid() {
                    return Err(ModelError::new(
                        field("curve"),
                        format!("found {curve:?}, which is no curve"),
                    ));
                }
                let input = tree.input(name);
                let mut slot =
                    |what: &str, unit, value| tree.slot(format!("{name}.{what}"), unit, &[value]).start;
                Tension::Muscle {
                    input,
                    max_force: slot("max_force", "N", max_force),
                    optimal_length: slot("optimal_length", "m", optimal_length),
                    tendon_slack_length: slot("tendon_slack_length", "m", tendon_slack_length),
                    curve,
                }
            }
        })
    }
}
