//! Definition of obstacles.

use super::pressing::{Pressing, Slopes};
use super::skin::{ObstacleSkinDescription, Pressed, Rounding, Skin};
use super::surface::{Surface, SurfaceDescription};
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tolerances::UNIT_NORM;
use crate::tree::description::AttachmentDescription;
use crate::tree::{ModelError, Tree, finite, not_negative, positive};
use serde::Deserialize;

/// Something solid that spheres press on, fixed to the world or to a body.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObstacleDescription {
    /// Unique name.
    pub name: String,
    /// The sphere groups.
    pub spheres: Vec<String>,
    /// Its origin.
    pub at: AttachmentDescription,
    /// Rotation vector of its axes relative to the world or the frame of the body [rad].
    pub rotation: [f64; 3],
    /// Its surfaces; each acts by itself.
    pub surfaces: Vec<SurfaceDescription>,
    /// Contact stiffness k of each sphere [N/m].
    pub stiffness: f64,
    /// Bodies that press on it with their skins.
    #[serde(default)]
    pub skins: Vec<ObstacleSkinDescription>,
}

impl ObstacleDescription {
    /// All sphere groups that may touch it.
    pub(crate) fn groups(&self) -> impl Iterator<Item = &String> {
        self.spheres.iter().chain(self.skins.iter().map(|skin| &skin.spheres))
    }
}

/// A sphere that may touch an obstacle, and the skin that it is a point of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Touchable {
    pub sphere: usize,
    pub skin: Option<usize>,
}

/// A sphere of this radius at a depth below a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    pub each: Touchable,
    pub surface: usize,
    pub radius: f64,
    pub depth: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Obstacle<const P: usize> {
    pub spheres: Vec<Touchable>,
    skins: Vec<Skin>,
    /// The point of the tree that carries it, without `offset`.
    pub point: usize,
    /// Parameters holding its origin relative to that point, in the frame that carries it.
    pub offset: usize,
    /// The frame that carries it; 0 for the world.
    pub frame: usize,
    /// Its axes in that frame.
    pub axes: [Vector<P>; P],
    pub surfaces: Vec<Surface<P>>,
    /// Parameter holding k.
    pub stiffness: usize,
}

impl<const P: usize> Obstacle<P> {
    pub fn build<G: LieGroup<D, P>, const D: usize>(
        tree: &mut Tree<G, D, P>,
        obstacle: &ObstacleDescription,
    ) -> Result<Self, ModelError> {
        let field = |f: &str| format!("obstacles.{}.{f}", obstacle.name);
        if obstacle.skins.is_empty() {
            positive(field("stiffness"), obstacle.stiffness)?;
        }
        not_negative(field("stiffness"), obstacle.stiffness)?;
        finite(field("rotation"), &obstacle.rotation)?;
        let turned = G::from_spatial(&[0.0; 3], &obstacle.rotation)
            .ok_or_else(|| ModelError::new(field("rotation"), "leaves the x–z plane of a planar system"))?;
        let mut spheres = vec![];
        for group in &obstacle.spheres {
            let found = tree.sphere_group(&field("spheres"), group)?;
            spheres.extend(found.map(|sphere| Touchable { sphere, skin: None }));
        }
        let mut skins = vec![];
        for skin in &obstacle.skins {
            let (skin, group) = Skin::build(tree, &obstacle.name, skin)?;
            let acting = group.filter(|sphere| skin.acts_at(*sphere));
            spheres.extend(acting.map(|sphere| Touchable { sphere, skin: Some(skins.len()) }));
            skins.push(skin);
        }
        let mut at = obstacle.at.clone();
        let place = match &mut at {
            AttachmentDescription::World { world } => world,
            AttachmentDescription::Body { offset, .. } => offset,
        };
        finite(field("at"), &*place)?;
        let offset = G::point_from_spatial(&std::mem::take(place))
            .ok_or_else(|| ModelError::new(field("at"), "leaves the x–z plane of a planar system"))?;
        let point = tree.attach_without_offset(&field("at"), &at)?;
        let offset = tree.slot(format!("{}.offset", obstacle.name), "m", &offset.0).start;
        let frame = tree.points[point].frame;
        tree.keep_jacobian(frame);
        let moves_with_it = |each: &Touchable| tree.points[tree.spheres[each.sphere].point].frame == frame;
        if frame != 0 && spheres.iter().any(moves_with_it) {
            return Err(ModelError::new(field("spheres"), "a sphere moves with the obstacle"));
        }
        let stiffness = tree.slot(format!("{}.stiffness", obstacle.name), "N/m", &[obstacle.stiffness]).start;
        let mut surfaces = vec![];
        for surface in &obstacle.surfaces {
            surfaces.push(Self::surface(tree, &obstacle.name, surface)?);
        }
        let axes = std::array::from_fn(|i| turned.rotate(&Vector::unit(i)));
        Ok(Self { spheres, skins, point, offset, frame, axes, surfaces, stiffness })
    }

    fn surface<G: LieGroup<D, P>, const D: usize>(
        tree: &mut Tree<G, D, P>,
        name: &str,
        surface: &SurfaceDescription,
    ) -> Result<Surface<P>, ModelError> {
        let field = |f: &str| format!("obstacles.{name}.{f}");
        match surface {
            SurfaceDescription::Plane { normal: given, distance } => {
                finite(field("normal"), given)?;
                finite(field("distance"), &[*distance])?;
                let normal = G::point_from_spatial(given).ok_or_else(|| {
                    ModelError::new(field("normal"), "leaves the x–z plane of a planar system")
                })?;
                if (normal.norm() - 1.0).abs() > UNIT_NORM {
                    let problem = format!("found {given:?}, must be a unit vector");
                    return Err(ModelError::new(field("normal"), problem));
                }
                Ok(Surface::Plane { normal, distance: *distance })
            }
            SurfaceDescription::Rounded { half: given, radius, inside } => {
                // Of a planar system's section with its plane.
                let axes: &[usize] = if P == 2 { &[0, 2] } else { &[0, 1, 2] };
                let mut half = Vector::ZERO;
                for (i, axis) in axes.iter().enumerate() {
                    half[i] = match given[*axis] {
                        None => f64::INFINITY,
                        Some(size) => not_negative(field("half"), size)?,
                    };
                }
                if (0..P).all(|i| half[i].is_infinite()) {
                    return Err(ModelError::new(field("half"), "endless along all axes"));
                }
                if half == Vector::ZERO {
                    positive(field("radius"), *radius)?;
                }
                not_negative(field("radius"), *radius)?;
                let radius = tree.slot(format!("{name}.radius"), "m", &[*radius]).start;
                // Where it is endless, no parameter says how long.
                let sizes = half.0.map(|size| if size.is_finite() { size } else { 0.0 });
                let sizes = tree.slot(format!("{name}.half"), "m", &sizes).start;
                let endless = half.0.map(f64::is_infinite);
                let side = if *inside { -1.0 } else { 1.0 };
                Ok(Surface::Rounded { endless, half: sizes, radius, side })
            }
        }
    }

    /// Whether its parameters are physically meaningful.
    pub fn is_admissible(&self, parameters: &[f64]) -> bool {
        parameters[self.stiffness] >= 0.0
            && self.skins.iter().all(|skin| skin.is_admissible(parameters))
            && self.surfaces.iter().all(|surface| surface.is_admissible(parameters))
    }

    /// Whether spheres press on it by springs.
    pub fn has_springs(&self) -> bool {
        self.spheres.iter().any(|each| each.skin.is_none())
    }

    /// What one of its spheres feels.
    #[inline]
    pub fn pressing(&self, parameters: &[f64], contact: Contact) -> Pressing {
        match contact.each.skin {
            None => Pressing::of_spring(parameters[self.stiffness], contact.depth),
            Some(skin) => self.skins[skin].pressing(parameters, self.pressed(parameters, contact)),
        }
    }

    /// The parameter that is the stiffness of the skin that a sphere is a point of, and its value.
    pub fn foundation(&self, parameters: &[f64], contact: Contact) -> Option<(usize, f64)> {
        contact.each.skin.map(|skin| self.skins[skin].foundation(parameters))
    }

    /// Adds a multiple of the derivative of its force by every parameter, the depth and the radii of sphere and
    /// surface held; returns those by these radii.
    pub fn add_slopes(&self, parameters: &[f64], contact: Contact, factor: f64, out: &mut [f64]) -> Slopes {
        let Some(skin) = contact.each.skin else {
            out[self.stiffness] += factor * contact.depth;
            return Slopes::default();
        };
        self.skins[skin].add_slopes(parameters, self.pressed(parameters, contact), factor, out)
    }

    /// Changes of the force and of its stiffness with those of the depth and of the radii of sphere and surface,
    /// and with parameters that change at given rates.
    pub fn change_of_pressing(
        &self,
        parameters: &[f64],
        contact: Contact,
        [depth, sphere, surface]: [f64; 3],
        rate: impl Fn(usize) -> f64,
    ) -> [f64; 2] {
        let Some(skin) = contact.each.skin else {
            let stiffness = rate(self.stiffness);
            return [stiffness * contact.depth + parameters[self.stiffness] * depth, stiffness];
        };
        let pressed = self.pressed(parameters, contact);
        self.skins[skin].change_of_pressing(parameters, pressed, [depth, sphere, surface], rate)
    }

    fn pressed(&self, parameters: &[f64], contact: Contact) -> Pressed {
        let Contact { each, surface, radius, depth } = contact;
        let rounding = self.rounding(parameters, surface);
        Pressed { sphere: each.sphere, surface: radius, rounding, depth }
    }

    fn rounding(&self, parameters: &[f64], surface: usize) -> Rounding {
        match &self.surfaces[surface] {
            Surface::Rounded { radius, side, .. } if parameters[*radius] > 0.0 => {
                Rounding { radius: parameters[*radius], side: *side }
            }
            _ => Rounding { radius: f64::INFINITY, side: 1.0 },
        }
    }
}
