//! Definition of elastic foundations between a rod and links.

use super::super::contact::RoundConeDescription;
use super::super::contact::{RoundCone, round_cones};
use crate::lie::LieGroup;
use crate::tree::{ModelError, Shape, SphereRadius, Tree, finite, not_negative, positive};
use serde::Deserialize;
use std::ops::Range;

/// Contact of a rod's skin with round links through the elastic foundation of both skins.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FoundationDescription {
    /// Unique name.
    pub name: String,
    /// Spheres of a rod, at the points at which the contact is integrated along it.
    pub first: String,
    /// Share of the rod's length of each of these; where it is zero, only overlap and pressure are
    /// reported.
    pub weights: Vec<f64>,
    /// Share of each of these that belongs to the tip.
    pub tip: Vec<f64>,
    /// Half-width of the underside at each: constant [m].
    pub half_width: Vec<f64>,
    /// The same: multiple of S.
    pub half_width_multiple: Vec<f64>,
    /// Curvature of the underside across, as a multiple of 1/S; 0 where it is flat.
    pub roundness: f64,
    /// How much higher the middle of a flat underside is than its edges [m].
    pub crown: f64,
    /// Spheres at the ends of the links.
    pub second: String,
    /// Stiffness k_f at each of these [Pa/m]; along a link it changes smoothly.
    pub stiffness: Vec<f64>,
    /// Round cones that the second group's spheres span.
    pub cones: Vec<RoundConeDescription>,
    /// cos² of the angle between the axes of rod and links, in the reference state.
    pub alignment: f64,
}

/// An elastic foundation: the places of its parameters, and its constants.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Foundation {
    pub first: Range<usize>,
    pub weights: Vec<f64>,
    /// Spheres of the first group whose weight is not zero.
    pub weighted: Vec<usize>,
    pub tip: Vec<f64>,
    pub roundness: f64,
    pub crown: f64,
    pub alignment: f64,
    pub second: Range<usize>,
    pub cones: Vec<RoundCone>,
    /// Parameters: S at each point, the rod's length, both parts of the half-widths, stiffness at each end.
    pub radii: Vec<usize>,
    pub length: usize,
    pub half_width: usize,
    pub half_width_multiple: usize,
    pub stiffness: usize,
}

impl Foundation {
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        d: &FoundationDescription,
    ) -> Result<Self, ModelError> {
        let field = |f: &str| format!("foundations.{}.{f}", d.name);
        let first = tree.sphere_group(&field("first"), &d.first)?;
        let second = tree.sphere_group(&field("second"), &d.second)?;
        let lists = [
            ("weights", &d.weights, &first),
            ("tip", &d.tip, &first),
            ("half_width", &d.half_width, &first),
            ("half_width_multiple", &d.half_width_multiple, &first),
            ("stiffness", &d.stiffness, &second),
        ];
        for (what, values, group) in lists {
            let (found, count) = (values.len(), group.len());
            if found != count {
                let problem = format!("found {found} values, the group has {count} spheres");
                return Err(ModelError::new(field(what), problem));
            }
            let signed = what.starts_with("half_width");
            values.iter().try_for_each(|x| {
                if signed { finite(field(what), &[*x]) } else { not_negative(field(what), *x).map(drop) }
            })?;
        }
        not_negative(field("roundness"), d.roundness)?;
        not_negative(field("alignment"), d.alignment)?;
        positive(field("roundness"), d.roundness + d.crown)?;
        finite(field("crown"), &[d.crown])?;
        let frame = |tree: &Tree<G, D, P>, sphere: usize| tree.points[tree.spheres[sphere].point].frame;
        let cones = round_cones(&field("cones"), &d.cones, &second)?;
        for cone in &cones {
            let [a, b] = cone.ends.map(|end| frame(tree, end));
            if a != b {
                return Err(ModelError::new(field("cones"), "the ends of a round cone must be on one link"));
            }
        }
        let bodies: Vec<usize> = first.clone().map(|s| tree.frames[frame(tree, s)].body).collect();
        let rod = bodies.first().map(|body| &tree.bodies[*body].shape);
        let Some(Shape::Rod(rod)) = rod.filter(|_| bodies.iter().all(|b| *b == bodies[0])) else {
            return Err(ModelError::new(field("first"), "the spheres must be those of one rod"));
        };
        let length = tree.rods[*rod].length;
        let radii = first.clone().filter_map(|s| match tree.spheres[s].radius {
            SphereRadius::Parameter(k) => Some(k),
            SphereRadius::Link(..) | SphereRadius::Between(..) => None,
        });
        let radii = radii.collect();
        for sphere in second.clone() {
            let frame = frame(tree, sphere);
            tree.keep_jacobian(frame);
        }
        let mut slot = |what: &str, unit: &'static str, values: &[f64]| {
            tree.slot(format!("{}.{what}", d.name), unit, values).start
        };
        let weighted = first.clone().zip(&d.weights).filter(|(_, weight)| **weight != 0.0);
        Ok(Self {
            weighted: weighted.map(|(sphere, _)| sphere).collect(),
            first,
            weights: d.weights.clone(),
            tip: d.tip.clone(),
            roundness: d.roundness,
            crown: d.crown,
            alignment: d.alignment,
            second,
            cones,
            radii,
            length,
            half_width: slot("half_width", "m", &d.half_width),
            half_width_multiple: slot("half_width_multiple", "1", &d.half_width_multiple),
            stiffness: slot("foundation", "Pa/m", &d.stiffness),
        })
    }

    /// Half-width at a point of the rod, constant and multiple of S.
    #[inline]
    pub fn width(&self, parameters: &[f64], point: usize) -> [f64; 2] {
        [self.half_width, self.half_width_multiple].map(|start| parameters[start + point])
    }

    /// Parameters holding the stiffness at both ends of a cone.
    #[inline]
    pub fn stiffness_at(&self, cone: &RoundCone) -> [usize; 2] {
        cone.ends.map(|end| self.stiffness + end - self.second.start)
    }

    /// Whether its parameters are physically meaningful.
    pub fn is_admissible(&self, parameters: &[f64]) -> bool {
        let stiffness = &parameters[self.stiffness..][..self.second.len()];
        let width = |(point, radius): (usize, &usize)| {
            let [constant, multiple] = self.width(parameters, point);
            constant + multiple * parameters[*radius]
        };
        stiffness.iter().all(|k| *k >= 0.0) && self.radii.iter().enumerate().map(width).all(|b| b > 0.0)
    }

    /// Largest number of couplings that it can report at once.
    pub fn max_couplings(&self) -> usize {
        self.first.len() * 2 * self.cones.len()
    }
}
