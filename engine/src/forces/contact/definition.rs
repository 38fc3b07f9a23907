//! Definition of contacts: pairs of sphere groups with their stiffness.

use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tree::{ModelError, Shape, Sphere, Tree, not_negative};
use serde::Deserialize;
use std::ops::Range;

/// Contact (8) between two groups of spheres.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactDescription {
    /// Unique name.
    pub name: String,
    /// The first group, whose touching spheres are counted.
    pub first: String,
    /// The second group; the same as the first for self-contact.
    pub second: String,
    /// Contact stiffness k [N/m].
    pub stiffness: f64,
    /// For self-contact: pairs whose indices differ by less than this are left out.
    #[serde(default)]
    pub skip: usize,
    /// Indices in the first group that make up its tip.
    #[serde(default)]
    pub tip_spheres: Vec<usize>,
    /// Round cones that the second group's spheres span and the first group's spheres touch; none:
    /// they touch the spheres themselves.
    #[serde(default)]
    pub cones: Vec<RoundConeDescription>,
    /// Fraction of `stiffness` of each sphere of the first group; one for each if empty.
    #[serde(default)]
    pub weights: Vec<f64>,
    /// Whether `stiffness` is per length [N/m²] and each share times the length of the sphere's body.
    #[serde(default)]
    pub per_length: bool,
}

/// The convex hull of two spheres.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoundConeDescription {
    /// Indices in the second group of the spheres at its ends; twice the same for a sphere.
    pub ends: [usize; 2],
    /// Whether its first end is where the round cone before it ends.
    #[serde(default)]
    pub joined: bool,
}

/// Largest gap of a pair whose force is kept, as a fraction of the radius.
const KEPT_GAP: f64 = 0.5;

/// Contact between two groups of spheres.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Contact {
    /// Spheres of the first group.
    pub first: Range<usize>,
    /// Spheres of the second group.
    pub second: Range<usize>,
    /// For self-contact, the smallest index distance that counts.
    pub skip: usize,
    /// Which spheres of the first group form its tip.
    pub tip: Vec<bool>,
    /// Parameter holding k.
    pub stiffness: usize,
    /// Round cones that the first group touches in place of the second group's spheres.
    pub cones: Vec<RoundCone>,
    /// Fractions of k of the first group's spheres; one for each if empty.
    pub weights: Vec<f64>,
    /// Parameters holding the lengths that multiply the shares; empty when k is not per length.
    pub lengths: Vec<usize>,
    /// Bounding balls of blocks of the second group's spheres, if they are many.
    pub balls: Range<usize>,
}

/// The convex hull of two spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RoundCone {
    pub ends: [usize; 2],
    /// Whether its first end is that where the one before it ends.
    pub joined: bool,
}

impl Contact {
    /// Builds a contact, without bounding balls.
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        contact: &ContactDescription,
    ) -> Result<Self, ModelError> {
        let field = |f: &str| format!("contacts.{}.{f}", contact.name);
        let first = tree.sphere_group(&field("first"), &contact.first)?;
        let second = tree.sphere_group(&field("second"), &contact.second)?;
        not_negative(field("stiffness"), contact.stiffness)?;
        let mut tip = vec![false; first.len()];
        for &i in &contact.tip_spheres {
            let count = first.len();
            *tip.get_mut(i).ok_or_else(|| {
                ModelError::new(
                    field("tip_spheres"),
                    format!("found index {i}, the group has {count} spheres"),
                )
            })? = true;
        }
        let unit = if contact.per_length { "N/m^2" } else { "N/m" };
        let stiffness = tree.slot(format!("{}.stiffness", contact.name), unit, &[contact.stiffness]).start;
        for sphere in second.clone() {
            let frame = tree.points[tree.spheres[sphere].point].frame;
            tree.keep_jacobian(frame);
        }
        let cones = round_cones(&field("cones"), &contact.cones, &second)?;
        let (found, count) = (contact.weights.len(), first.len());
        if found != 0 && found != count {
            let problem = format!("found {found} values, the group has {count} spheres");
            return Err(ModelError::new(field("weights"), problem));
        }
        for weight in &contact.weights {
            not_negative(field("weights"), *weight)?;
        }
        if cones.is_empty() && (found != 0 || contact.per_length) {
            return Err(ModelError::new(field("weights"), "only contact with round cones is weighted"));
        }
        let bodies = first.clone().map(|s| tree.frames[tree.points[tree.spheres[s].point].frame].body);
        let lengths = bodies.filter(|_| contact.per_length).map(|b| match &tree.bodies[b].shape {
            Shape::Rod(r) => tree.rods[*r].length,
            Shape::Link(l) => l.length,
        });
        let (lengths, weights) = (lengths.collect(), contact.weights.clone());
        let skip = contact.skip;
        let balls = 0..0;
        Ok(Self { first, second, skip, tip, stiffness, cones, weights, lengths, balls })
    }

    /// Whether a group touches itself.
    pub fn is_self(&self) -> bool {
        self.first == self.second
    }

    /// The centres of the second group's spheres: these are points one after another.
    #[inline]
    pub fn second_centres<'a, const P: usize>(
        &self,
        spheres: &[Sphere],
        points: &'a [Vector<P>],
    ) -> &'a [Vector<P>] {
        let start = spheres.get(self.second.start).map_or(0, |s| s.point);
        &points[start..start + self.second.len()]
    }

    /// What multiplies k for a sphere of the first group.
    #[inline]
    pub fn weight(&self, parameters: &[f64], first: usize) -> f64 {
        let i = first - self.first.start;
        let share = self.weights.get(i).copied().unwrap_or(1.0);
        share * self.lengths.get(i).map_or(1.0, |l| parameters[*l])
    }

    /// Largest gap of a pair whose force is kept.
    pub fn reach(&self, radii: &[f64]) -> f64 {
        KEPT_GAP * radii[self.first.clone()].iter().copied().fold(0.0, f64::max)
    }

    /// Whether a sphere of the first group belongs to its tip.
    #[inline]
    pub fn is_tip(&self, first: usize) -> bool {
        self.tip[first - self.first.start]
    }

    /// Largest number of couplings that the contact can report at once.
    pub fn max_couplings(&self) -> usize {
        // A round cone couples three frames, and the sphere shared with the one before it two.
        let solids = if self.cones.is_empty() { self.second.len() } else { 4 * self.cones.len() };
        self.first.len() * solids
    }
}

/// The round cones that a group of spheres spans.
pub(crate) fn round_cones(
    field: &str,
    described: &[RoundConeDescription],
    second: &Range<usize>,
) -> Result<Vec<RoundCone>, ModelError> {
    let count = second.len();
    let mut cones = Vec::with_capacity(described.len());
    for (c, cone) in described.iter().enumerate() {
        if let Some(i) = cone.ends.iter().find(|i| **i >= count) {
            let problem = format!("found index {i}, the group has {count} spheres");
            return Err(ModelError::new(field, problem));
        }
        if cone.joined && c == 0 {
            return Err(ModelError::new(field, "the first one has none before it to be joined to"));
        }
        let ends = cone.ends.map(|i| second.start + i);
        cones.push(RoundCone { ends, joined: cone.joined });
    }
    Ok(cones)
}
