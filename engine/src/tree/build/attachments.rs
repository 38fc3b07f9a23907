//! Spheres on bodies and points of attachment.

use super::super::description::{AttachmentDescription, SphereGroupDescription, Station};
use super::super::{
    Between, Body, ModelError, Place, Point, Shape, Sphere, SphereRadius, Tree, finite, positive,
};
use crate::lie::LieGroup;
use crate::linalg::Vector;
use std::ops::Range;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Tree<G, D, P> {
    pub(super) fn add_spheres(&mut self, groups: &[SphereGroupDescription]) -> Result<(), ModelError> {
        for group in groups {
            let field = format!("spheres.{}", group.name);
            let start = self.spheres.len();
            for sphere in &group.spheres {
                let (frame, mut place) = self.locate(&field, &sphere.body, sphere.station)?;
                if let Place::Fraction(link, f) = place
                    && f > 0.0
                    && f < 1.0
                {
                    let name = format!("{}[{}].along", group.name, self.spheres.len() - start);
                    place = Place::Along(link, self.slot(name, "1", &[f]).start);
                }
                let radius = self.radius_at(&field, &sphere.body, sphere.station, place)?;
                self.spheres.push(Sphere { point: self.points.len(), radius });
                self.points.push(Point { frame, place, offset: None, surface: None });
            }
            if self.sphere_groups.iter().any(|(name, _)| *name == group.name) {
                return Err(ModelError::new(field, "two sphere groups have this name"));
            }
            self.sphere_groups.push((group.name.clone(), start..self.spheres.len()));
        }
        Ok(())
    }

    /// The spheres of a group.
    pub(crate) fn sphere_group(&self, field: &str, name: &str) -> Result<Range<usize>, ModelError> {
        let found = self.sphere_groups.iter().find(|(group, _)| group == name);
        let (_, range) =
            found.ok_or_else(|| ModelError::new(field, format!("no sphere group is named `{name}`")))?;
        Ok(range.clone())
    }

    /// Appends the point of an attachment.
    pub(crate) fn attach(&mut self, field: &str, at: &AttachmentDescription) -> Result<usize, ModelError> {
        let point = self.attach_without_offset(field, at)?;
        let (AttachmentDescription::World { world: offset } | AttachmentDescription::Body { offset, .. }) =
            at;
        self.points[point].offset = Some(self.offset_slot(field, offset)?);
        Ok(point)
    }

    /// The same at the station itself, or at the origin of the world.
    pub(crate) fn attach_without_offset(
        &mut self,
        field: &str,
        at: &AttachmentDescription,
    ) -> Result<usize, ModelError> {
        let point = match at {
            AttachmentDescription::World { .. } => {
                Point { frame: 0, place: Place::Frame, offset: None, surface: None }
            }
            AttachmentDescription::Body { body, station, surface, .. } => {
                let (frame, mut place) = self.locate(field, body, *station)?;
                if let Place::Fraction(link, f) = place {
                    place = Place::Along(link, self.slot(owned(field, "along"), "1", &[f]).start);
                }
                let direction = Self::local(field, surface)?;
                let radius = self.radius_at(field, body, *station, place)?;
                let surface = (direction != Vector::ZERO).then_some((radius, direction));
                Point { frame, place, offset: None, surface }
            }
        };
        self.points.push(point);
        Ok(self.points.len() - 1)
    }

    /// A vector in a local frame.
    fn local(field: &str, vector: &[f64; 3]) -> Result<Vector<P>, ModelError> {
        finite(field, vector)?;
        G::point_from_spatial(vector)
            .ok_or_else(|| ModelError::new(field, "leaves the x–z plane of a planar system"))
    }

    /// The parameters of the offset of an attachment.
    fn offset_slot(&mut self, field: &str, offset: &[f64; 3]) -> Result<usize, ModelError> {
        Self::local(field, offset)?;
        Ok(self.slot(owned(field, "offset"), "m", offset).start)
    }

    /// Appends the points of an attachment to a rod at a fraction of its length: one that the sample point
    /// before it carries, and one that the sample point after it carries.
    pub(crate) fn attach_between(
        &mut self,
        field: &str,
        at: &AttachmentDescription,
    ) -> Result<Option<([usize; 2], Between)>, ModelError> {
        let AttachmentDescription::Body { body, station: Station::Along(fraction), offset, surface } = at
        else {
            return Ok(None);
        };
        finite(field, &[*fraction])?;
        let rod = self.rod(field, body)?;
        let between = Between { rod, slot: self.slot(owned(field, "along"), "1", &[*fraction]).start };
        let (_, Body { base_frame, tip_frame, .. }) = self.body(field, body)?;
        let (frame, last) = (*base_frame, *tip_frame);
        let direction = Self::local(field, surface)?;
        let offset = Some(self.offset_slot(field, offset)?);
        let first = self.points.len();
        for side in [0, 1] {
            let surface =
                (direction != Vector::ZERO).then_some((SphereRadius::Between(between, side), direction));
            self.points.push(Point { frame, place: Place::Between(between, side), offset, surface });
        }
        self.keep_moving_jacobian(first + 1, last);
        Ok(Some(([first, first + 1], between)))
    }

    /// The radius of a body at a station, which is at this place.
    fn radius_at(
        &self,
        field: &str,
        name: &str,
        station: Station,
        place: Place,
    ) -> Result<SphereRadius, ModelError> {
        let (index, body) = self.body(field, name)?;
        Ok(match (&body.shape, station) {
            (Shape::Rod(r), Station::Point(k)) => SphereRadius::Parameter(self.rods[*r].radius.start + k),
            _ => SphereRadius::Link(index, place),
        })
    }

    pub(crate) fn body(&self, field: &str, name: &str) -> Result<(usize, &Body<P>), ModelError> {
        let found = self.bodies.iter().enumerate().find(|(_, b)| b.name == name);
        found.ok_or_else(|| ModelError::new(field, format!("no body is named `{name}`")))
    }

    /// The rod that is a body.
    pub(crate) fn rod(&self, field: &str, name: &str) -> Result<usize, ModelError> {
        match self.body(field, name)?.1.shape {
            Shape::Rod(rod) => Ok(rod),
            Shape::Link(_) => Err(ModelError::new(field, format!("`{name}` is not a rod"))),
        }
    }

    /// A coordinate of the joint that carries a body.
    pub(crate) fn joint_coordinate(
        &self,
        field: &str,
        body: &str,
        coordinate: &str,
    ) -> Result<usize, ModelError> {
        let name = format!("{body}.{coordinate}");
        let found = self.joints.iter().find(|joint| self.coordinates[joint.dof] == name);
        let missing = || ModelError::new(field, format!("no joint has the coordinate `{name}`"));
        found.map(|joint| joint.dof).ok_or_else(missing)
    }

    /// The frame and place of a station on a body.
    fn locate(&self, field: &str, name: &str, station: Station) -> Result<(usize, Place), ModelError> {
        let (index, body) = self.body(field, name)?;
        match (&body.shape, station) {
            (Shape::Rod(r), Station::Point(k)) => {
                let count = self.rods[*r].x.len();
                if k >= count {
                    let problem = format!("found point {k} on `{name}`, which has {count} sample points");
                    return Err(ModelError::new(field, problem));
                }
                Ok((body.base_frame + k, Place::Frame))
            }
            (Shape::Link(_), Station::Fraction(f)) => {
                positive(field, 1.0 + f)?;
                Ok((body.base_frame, Place::Fraction(index, f)))
            }
            (Shape::Link(_), Station::Centroid) => Ok((body.base_frame, Place::Centroid(index))),
            (Shape::Rod(_), _) => {
                Err(ModelError::new(field, format!("`{name}` is a rod: give a sample point")))
            }
            (Shape::Link(_), _) => {
                Err(ModelError::new(field, format!("`{name}` is a link: give a fraction or the centroid")))
            }
        }
    }
}

/// The name of a parameter of an attachment, given its field in the description, such as `springs.strap.first`.
fn owned(field: &str, what: &str) -> String {
    let owner = field.split_once('.').map_or(field, |(_, owner)| owner);
    format!("{owner}.{what}")
}
