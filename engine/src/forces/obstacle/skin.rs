//! Skins of bodies on obstacles: elastic foundations, integrated across a body in closed form and along it by
//! quadrature. A round end of a body is half of a sphere.

use super::super::foundation::Strip;
use super::pressing::{Pressing, Slopes};
use crate::lie::LieGroup;
use crate::tree::{ModelError, Shape, Tree, finite, not_negative, positive};
use serde::Deserialize;
use std::f64::consts::PI;
use std::ops::Range;

/// The skin of a body that touches an obstacle.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObstacleSkinDescription {
    /// Spheres of one body, at the points at which the contact is integrated along it.
    pub spheres: String,
    /// Share of the body's length of each of these.
    pub weights: Vec<f64>,
    /// Share of a whole sphere that the body ends in at each of these: one half at a round end.
    pub caps: Vec<f64>,
    /// Half-width of the body at each: constant [m].
    pub half_width: Vec<f64>,
    /// The same: multiple of S.
    pub half_width_multiple: Vec<f64>,
    /// Curvature of the body across, as a multiple of 1/S; 0 where it is flat.
    pub roundness: f64,
    /// How much higher the middle of a flat body is than its edges [m].
    pub crown: f64,
    /// Stiffness k_f of the skins of body and obstacle, one on the other [Pa/m].
    pub stiffness: f64,
    /// Share of the obstacle's curvature that is across the body.
    pub alignment: f64,
}

/// The same: the places of its parameters, and its constants.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Skin {
    first: usize,
    weights: Vec<f64>,
    caps: Vec<f64>,
    roundness: f64,
    crown: f64,
    alignment: f64,
    /// Parameters: the body's length, k_f, both parts of the half-widths.
    length: usize,
    stiffness: usize,
    half_width: usize,
    half_width_multiple: usize,
}

/// A point of a skin at a depth that is not negative.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pressed {
    pub sphere: usize,
    /// S.
    pub surface: f64,
    pub rounding: Rounding,
    pub depth: f64,
}

/// Curvature and radius of an obstacle's surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounding {
    /// Its radius; infinite for a plane.
    pub radius: f64,
    /// −1 if it is hollow, otherwise 1.
    pub side: f64,
}

impl Skin {
    /// Builds it; returns its spheres, too.
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        obstacle: &str,
        d: &ObstacleSkinDescription,
    ) -> Result<(Self, Range<usize>), ModelError> {
        let field = |f: &str| format!("obstacles.{obstacle}.skins.{}.{f}", d.spheres);
        let group = tree.sphere_group(&field("spheres"), &d.spheres)?;
        let lists = [
            ("weights", &d.weights),
            ("caps", &d.caps),
            ("half_width", &d.half_width),
            ("half_width_multiple", &d.half_width_multiple),
        ];
        for (what, values) in lists {
            let (found, count) = (values.len(), group.len());
            if found != count {
                let problem = format!("found {found} values, the group has {count} spheres");
                return Err(ModelError::new(field(what), problem));
            }
            finite(field(what), values)?;
        }
        for (what, value) in [("roundness", d.roundness), ("alignment", d.alignment)] {
            not_negative(field(what), value)?;
        }
        positive(field("roundness"), d.roundness + d.crown)?;
        finite(field("crown"), &[d.crown])?;
        not_negative(field("stiffness"), d.stiffness)?;
        let body_of = |sphere: usize| tree.frames[tree.points[tree.spheres[sphere].point].frame].body;
        let body = group.clone().next().map(body_of);
        let Some(body) = body.filter(|body| group.clone().all(|sphere| body_of(sphere) == *body)) else {
            return Err(ModelError::new(field("spheres"), "the spheres must be those of one body"));
        };
        let length = match &tree.bodies[body].shape {
            Shape::Rod(rod) => tree.rods[*rod].length,
            Shape::Link(link) => link.length,
        };
        let mut slot = |what: &str, unit: &'static str, values: &[f64]| {
            tree.slot(format!("{obstacle}.{}.{what}", d.spheres), unit, values).start
        };
        let skin = Self {
            first: group.start,
            weights: d.weights.clone(),
            caps: d.caps.clone(),
            roundness: d.roundness,
            crown: d.crown,
            alignment: d.alignment,
            length,
            stiffness: slot("foundation", "Pa/m", &[d.stiffness]),
            half_width: slot("half_width", "m", &d.half_width),
            half_width_multiple: slot("half_width_multiple", "1", &d.half_width_multiple),
        };
        Ok((skin, group))
    }

    /// Whether a sphere takes part.
    pub fn acts_at(&self, sphere: usize) -> bool {
        let point = sphere - self.first;
        self.weights[point] != 0.0 || self.caps[point] != 0.0
    }

    /// Whether its parameters are physically meaningful.
    pub fn is_admissible(&self, parameters: &[f64]) -> bool {
        parameters[self.stiffness] >= 0.0
    }

    /// The parameter that is its stiffness, and its value [Pa/m].
    pub fn foundation(&self, parameters: &[f64]) -> (usize, f64) {
        (self.stiffness, parameters[self.stiffness])
    }

    /// What a point of it feels.
    pub fn pressing(&self, p: &[f64], pressed: Pressed) -> Pressing {
        let Part { strip, weight, cap, round, .. } = self.part(p, pressed);
        let depth = pressed.depth;
        let k = p[self.stiffness];
        let weight = weight * p[self.length];
        let disc = cap * PI * depth / round;
        Pressing {
            energy: k * (weight * strip.energy + disc * depth * depth / 3.0),
            force: k * (weight * strip.by_depth + disc * depth),
            stiffness: k * (weight * strip.depth_depth + 2.0 * disc),
            pressure: Some(k * depth),
        }
    }

    /// Adds a multiple of the derivative of the force by every parameter, the depth and the radii of sphere and
    /// surface held; returns those by these radii.
    pub fn add_slopes(&self, p: &[f64], pressed: Pressed, factor: f64, out: &mut [f64]) -> Slopes {
        let Part { strip, weight, cap, round, width, multiple, curvature_shares, round_shares, .. } =
            self.part(p, pressed);
        let Pressed { sphere, surface, rounding, depth } = pressed;
        let (point, k, length) = (sphere - self.first, p[self.stiffness], p[self.length]);
        let end = cap * PI * depth * depth / round;
        out[self.stiffness] += factor * (weight * length * strip.by_depth + end);
        out[self.length] += factor * k * weight * strip.by_depth;
        let by_curvature = k * weight * length * strip.depth_curvature;
        let by_round = -k * end / round;
        let flatter = if self.is_flat() { -4.0 * self.crown / width.powi(3) } else { 0.0 };
        let by_width = k * weight * length * strip.depth_width + by_curvature * curvature_shares[0] * flatter;
        out[self.half_width + point] += factor * by_width;
        out[self.half_width_multiple + point] += factor * by_width * surface;
        let square = surface * surface;
        let by_surface = by_width * multiple
            - by_curvature * curvature_shares[0] * self.roundness / square
            - by_round * round_shares[0] / square;
        let turn = -rounding.side * self.alignment / (rounding.radius * rounding.radius);
        let by_radius = (by_curvature * curvature_shares[1] + by_round * round_shares[1]) * turn;
        Slopes { by_surface: factor * by_surface, by_radius: factor * by_radius }
    }

    /// Changes of the force and of its stiffness with those of the depth and of the radii of sphere and surface,
    /// and with parameters that change at given rates.
    pub fn change_of_pressing(
        &self,
        p: &[f64],
        pressed: Pressed,
        [sinking, swelling, widening]: [f64; 3],
        rate: impl Fn(usize) -> f64,
    ) -> [f64; 2] {
        let Part { strip, weight, cap, round, width, multiple, curvature, curvature_shares, round_shares } =
            self.part(p, pressed);
        let Pressed { sphere, surface, rounding, depth } = pressed;
        let (point, k, length) = (sphere - self.first, p[self.stiffness], weight * p[self.length]);
        let stiffer = rate(self.stiffness);
        let longer = weight * rate(self.length);
        let wider = rate(self.half_width + point)
            + rate(self.half_width_multiple + point) * surface
            + multiple * swelling;
        let own = if self.is_flat() {
            -4.0 * self.crown / width.powi(3) * wider
        } else {
            -self.roundness / (surface * surface) * swelling
        };
        let of_obstacle = -rounding.side * self.alignment / (rounding.radius * rounding.radius) * widening;
        let curved = curvature_shares[0] * own + curvature_shares[1] * of_obstacle;
        let of_end = round_shares[1] * of_obstacle - round_shares[0] * swelling / (surface * surface);
        let [by_depth, by_curvature, by_width] = Strip::slopes_of_stiffness(depth, curvature, width);
        let disc = cap * PI / round;
        let disc_change = -disc / round * of_end;
        let force = stiffer * (length * strip.by_depth + disc * depth * depth)
            + k * (longer * strip.by_depth
                + length
                    * (strip.depth_depth * sinking
                        + strip.depth_curvature * curved
                        + strip.depth_width * wider)
                + depth * (2.0 * disc * sinking + disc_change * depth));
        let stiffness = stiffer * (length * strip.depth_depth + 2.0 * disc * depth)
            + k * (longer * strip.depth_depth
                + length * (by_depth * sinking + by_curvature * curved + by_width * wider)
                + 2.0 * (disc * sinking + disc_change * depth));
        [force, stiffness]
    }

    fn is_flat(&self) -> bool {
        self.roundness == 0.0
    }

    fn part(&self, p: &[f64], Pressed { sphere, surface, rounding, depth }: Pressed) -> Part {
        let point = sphere - self.first;
        let multiple = p[self.half_width_multiple + point];
        let width = p[self.half_width + point] + multiple * surface;
        let of_obstacle = rounding.side * self.alignment / rounding.radius;
        let (curvature, curvature_shares) = relative(self.own_curvature(surface, width), of_obstacle);
        let (round, round_shares) = relative(1.0 / surface, of_obstacle);
        let strip = Strip::new(depth, curvature, width);
        let (weight, cap) = (self.weights[point], self.caps[point]);
        Part { strip, weight, cap, round, width, multiple, curvature, curvature_shares, round_shares }
    }

    /// Its own curvature across.
    fn own_curvature(&self, surface: f64, width: f64) -> f64 {
        if self.is_flat() { 2.0 * self.crown / (width * width) } else { self.roundness / surface }
    }
}

/// The least relative curvature of a body in a sleeve, as a fraction of its own: in one that is narrower than
/// the body the edges touch first.
const LEAST_SHARE: f64 = 1e-2;

/// The relative curvature of a body and an obstacle, with its derivatives by both.
fn relative(own: f64, of_obstacle: f64) -> (f64, [f64; 2]) {
    let sum = own + of_obstacle;
    if sum > LEAST_SHARE * own { (sum, [1.0, 1.0]) } else { (LEAST_SHARE * own, [LEAST_SHARE, 0.0]) }
}

/// A point of a body that is pressed.
struct Part {
    strip: Strip,
    weight: f64,
    cap: f64,
    /// Relative curvature at a round end.
    round: f64,
    width: f64,
    multiple: f64,
    /// Relative curvature across.
    curvature: f64,
    /// Derivatives of both relative curvatures by the body's own and by the obstacle's.
    curvature_shares: [f64; 2],
    round_shares: [f64; 2],
}
