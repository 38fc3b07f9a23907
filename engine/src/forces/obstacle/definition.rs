//! Definition of obstacles.

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
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Obstacle<const P: usize> {
    pub spheres: Vec<usize>,
    /// The point of the tree at its origin.
    pub point: usize,
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
        positive(field("stiffness"), obstacle.stiffness)?;
        finite(field("rotation"), &obstacle.rotation)?;
        let turned = G::from_spatial(&[0.0; 3], &obstacle.rotation)
            .ok_or_else(|| ModelError::new(field("rotation"), "leaves the x–z plane of a planar system"))?;
        let mut spheres = vec![];
        for group in &obstacle.spheres {
            spheres.extend(tree.sphere_group(&field("spheres"), group)?);
        }
        let point = tree.attach(&field("at"), &obstacle.at)?;
        let frame = tree.points[point].frame;
        tree.keep_jacobian(frame);
        if spheres.iter().any(|sphere| frame != 0 && tree.points[tree.spheres[*sphere].point].frame == frame)
        {
            return Err(ModelError::new(field("spheres"), "a sphere moves with the obstacle"));
        }
        let stiffness = tree.slot(format!("{}.stiffness", obstacle.name), "N/m", &[obstacle.stiffness]).start;
        let mut surfaces = vec![];
        for surface in &obstacle.surfaces {
            surfaces.push(Self::surface(tree, &obstacle.name, surface)?);
        }
        let axes = std::array::from_fn(|i| turned.rotate(&Vector::unit(i)));
        Ok(Self { spheres, point, frame, axes, surfaces, stiffness })
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
                Ok(Surface::Rounded { half, radius, side: if *inside { -1.0 } else { 1.0 } })
            }
        }
    }

    /// Whether its parameters are physically meaningful.
    pub fn is_admissible(&self, parameters: &[f64]) -> bool {
        let radii = self.surfaces.iter().filter_map(Surface::radius);
        parameters[self.stiffness] >= 0.0 && radii.into_iter().all(|(radius, _)| parameters[radius] >= 0.0)
    }
}
