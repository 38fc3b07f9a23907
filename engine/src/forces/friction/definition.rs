//! Definition of friction.

use super::Source;
use crate::lie::LieGroup;
use crate::model::description::Description;
use crate::tree::{ModelError, Tree, not_negative, positive};
use serde::Deserialize;

/// Coulomb friction in a contact, a foundation or on an obstacle.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionDescription {
    /// Name of a contact, a foundation or an obstacle.
    pub name: String,
    /// Coefficient of friction μ.
    pub coefficient: f64,
    /// Tangential stiffness as a multiple of the normal stiffness of the contact.
    #[serde(default = "usual_ratio")]
    pub stiffness_ratio: f64,
}

/// Mindlin's 2(1 − ν)/(2 − ν) of bodies with Poisson's ratio ν = ½.
fn usual_ratio() -> f64 {
    2.0 / 3.0
}

/// Friction in one of the model's contacts.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Friction {
    pub source: Source,
    /// Parameter holding μ.
    pub coefficient: usize,
    /// Parameter holding the ratio of tangential to normal stiffness.
    pub ratio: usize,
    /// Largest number of points at once.
    pub most: usize,
}

impl Friction {
    /// The ratio and the coefficient.
    pub fn constants(&self, p: &[f64]) -> (f64, f64) {
        (p[self.ratio], p[self.coefficient])
    }

    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        friction: &FrictionDescription,
        model: &Description,
    ) -> Result<Self, ModelError> {
        let field = |f: &str| format!("frictions.{}.{f}", friction.name);
        not_negative(field("coefficient"), friction.coefficient)?;
        positive(field("stiffness_ratio"), friction.stiffness_ratio)?;
        let name = &friction.name;
        let contacts = model.contacts.iter().position(|each| each.name == *name).map(Source::Contact);
        let foundations =
            model.foundations.iter().position(|each| each.name == *name).map(Source::Foundation);
        let obstacles = model.obstacles.iter().position(|each| each.name == *name).map(Source::Obstacle);
        let source = contacts.or(foundations).or(obstacles).ok_or_else(|| {
            ModelError::new(field("name"), "there is no contact, foundation or obstacle of this name")
        })?;
        let count = |group: &String| tree.sphere_group(&field("name"), group).map(|spheres| spheres.len());
        let bodies = tree.bodies.len();
        let most = match source {
            Source::Contact(i) => count(&model.contacts[i].first)? * bodies,
            Source::Foundation(i) => count(&model.foundations[i].first)? * bodies,
            Source::Obstacle(i) => {
                let groups = model.obstacles[i].groups().map(count);
                groups.sum::<Result<usize, _>>()? * model.obstacles[i].surfaces.len()
            }
        };
        let mut slot = |what: &str, value: f64| tree.slot(format!("{name}.{what}"), "1", &[value]).start;
        let coefficient = slot("friction", friction.coefficient);
        let ratio = slot("friction_ratio", friction.stiffness_ratio);
        Ok(Self { source, coefficient, ratio, most })
    }
}
