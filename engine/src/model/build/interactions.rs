//! Spheres, contacts, actuators, springs and point loads.

use super::super::error::{finite, not_negative, positive};
use super::super::points::{Place, Point, Sphere, SphereRadius};
use super::super::{
    Actuator, ActuatorDescription, ActuatorKind, AttachmentDescription, Contact, ContactDescription, Model,
    ModelError, RoundCone, Shape, SphereGroupDescription, Spring, SpringDescription, Station, Tendon, Wrench,
    WrenchDescription, WrenchFrame,
};
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::potential::enclosure;
use std::collections::HashMap;
use std::ops::Range;

type Groups = HashMap<String, Range<usize>>;

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Model<G, D, P> {
    pub(super) fn add_spheres(&mut self, groups: &[SphereGroupDescription]) -> Result<Groups, ModelError> {
        let mut ranges = Groups::new();
        for group in groups {
            let field = format!("spheres.{}", group.name);
            let start = self.spheres.len();
            for sphere in &group.spheres {
                let (frame, place) = self.locate(&field, &sphere.body, sphere.station)?;
                let radius = match (&self.body(&field, &sphere.body)?.1.shape, sphere.station) {
                    (Shape::Rod(r), Station::Point(k)) => {
                        SphereRadius::Parameter(self.rods[*r].radius.start + k)
                    }
                    _ => SphereRadius::Link(self.body(&field, &sphere.body)?.0, place),
                };
                self.spheres.push(Sphere { point: self.points.len(), radius });
                self.points.push(Point { frame, place, offset: Vector::ZERO });
            }
            if ranges.insert(group.name.clone(), start..self.spheres.len()).is_some() {
                return Err(ModelError::new(field, "two sphere groups have this name"));
            }
        }
        Ok(ranges)
    }

    pub(super) fn add_contact(
        &mut self,
        contact: &ContactDescription,
        groups: &Groups,
    ) -> Result<(), ModelError> {
        let field = |f: &str| format!("contacts.{}.{f}", contact.name);
        let range = |f: &str, name: &str| {
            let found = groups.get(name).cloned();
            found.ok_or_else(|| ModelError::new(field(f), format!("no sphere group is named `{name}`")))
        };
        let first = range("first", &contact.first)?;
        let second = range("second", &contact.second)?;
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
        let stiffness = self.slot(format!("{}.stiffness", contact.name), &[contact.stiffness]).start;
        for sphere in second.clone() {
            let frame = self.points[self.spheres[sphere].point].frame;
            self.keep_jacobian(frame);
        }
        let cones = self.cones(&field("cones"), contact, &second)?;
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
        let bodies = first.clone().map(|s| self.frames[self.points[self.spheres[s].point].frame].body);
        let lengths = bodies.filter(|_| contact.per_length).map(|b| match &self.bodies[b].shape {
            Shape::Rod(r) => self.rods[*r].length,
            Shape::Link(l) => l.length,
        });
        let (lengths, weights) = (lengths.collect(), contact.weights.clone());
        let skip = contact.skip;
        let start = self.contacts.last().map_or(0, |c| c.balls.end);
        let balls = start..start;
        let mut made = Contact { first, second, skip, tip, stiffness, cones, weights, lengths, balls };
        made.balls.end += enclosure::count(&made);
        self.contacts.push(made);
        Ok(())
    }

    fn cones(
        &self,
        field: &str,
        contact: &ContactDescription,
        second: &Range<usize>,
    ) -> Result<Vec<RoundCone>, ModelError> {
        let count = second.len();
        let mut cones = Vec::with_capacity(contact.cones.len());
        for (c, cone) in contact.cones.iter().enumerate() {
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

    pub(super) fn add_actuator(&mut self, actuator: &ActuatorDescription) -> Result<(), ModelError> {
        let field = |f: &str| format!("actuators.{}.{f}", actuator.name);
        let (_, body) = self.body(&field("rod"), &actuator.rod)?;
        let Shape::Rod(rod) = body.shape else {
            return Err(ModelError::new(field("rod"), format!("`{}` is not a rod", actuator.rod)));
        };
        let needed = self.rods[rod].x.len();
        for (what, list) in [("path", &actuator.path), ("path_slope", &actuator.path_slope)] {
            if list.len() != needed {
                let problem = format!("found {} values, the rod has {needed} sample points", list.len());
                return Err(ModelError::new(field(what), problem));
            }
            finite(field(what), list.as_flattened())?;
        }
        finite(field("lever"), &actuator.lever)?;
        let at = |g: usize| self.rods[rod].gauss[g].point;
        let tendon = (0..self.rods[rod].gauss.len())
            .map(|g| Tendon { offset: actuator.path[at(g)], slope: actuator.path_slope[at(g)] })
            .collect();
        let lever = self.slot(format!("{}.lever", actuator.name), &actuator.lever).start;
        let sign = if actuator.kind == ActuatorKind::Chamber { 1.0 } else { -1.0 };
        self.actuators.push(Actuator { rod, sign, lever, tendon });
        self.inputs.push(actuator.name.clone());
        Ok(())
    }

    pub(super) fn add_spring(&mut self, spring: &SpringDescription) -> Result<(), ModelError> {
        let field = |f: &str| format!("springs.{}.{f}", spring.name);
        not_negative(field("stiffness"), spring.stiffness)?;
        not_negative(field("rest_length"), spring.rest_length)?;
        let ends =
            [self.attach(&field("first"), &spring.first)?, self.attach(&field("second"), &spring.second)?];
        self.keep_jacobian(self.points[ends[1]].frame);
        let stiffness = self.slot(format!("{}.stiffness", spring.name), &[spring.stiffness]).start;
        let rest_length = self.slot(format!("{}.rest_length", spring.name), &[spring.rest_length]).start;
        self.springs.push(Spring { ends, stiffness, rest_length, slack: spring.slack });
        Ok(())
    }

    pub(super) fn add_wrench(&mut self, wrench: &WrenchDescription) -> Result<(), ModelError> {
        let field = |f: &str| format!("wrenches.{}.{f}", wrench.name);
        finite(field("force"), &wrench.force)?;
        finite(field("moment"), &wrench.moment)?;
        let point = self.attach(&field("at"), &wrench.at)?;
        let force = G::point_from_spatial(&wrench.force)
            .ok_or_else(|| ModelError::new(field("force"), "leaves the x–z plane of a planar system"))?;
        if P == 2 && (wrench.moment[0] != 0.0 || wrench.moment[2] != 0.0) {
            return Err(ModelError::new(field("moment"), "a planar system turns about y only"));
        }
        let input = wrench.input.then(|| {
            self.inputs.push(wrench.name.clone());
            self.inputs.len() - 1
        });
        let frame = self.points[point].frame;
        self.keep_jacobian(frame);
        let follower = wrench.frame == WrenchFrame::Body;
        self.wrenches.push(Wrench { point, force, moment: wrench.moment, follower, input, frame });
        Ok(())
    }

    /// Appends the point of an attachment.
    fn attach(&mut self, field: &str, at: &AttachmentDescription) -> Result<usize, ModelError> {
        let (frame, place, offset) = match at {
            AttachmentDescription::World { world } => (0, Place::Frame, world),
            AttachmentDescription::Body { body, station, offset } => {
                let (frame, place) = self.locate(field, body, *station)?;
                (frame, place, offset)
            }
        };
        finite(field, offset)?;
        let offset = G::point_from_spatial(offset)
            .ok_or_else(|| ModelError::new(field, "leaves the x–z plane of a planar system"))?;
        self.points.push(Point { frame, place, offset });
        Ok(self.points.len() - 1)
    }

    fn body(&self, field: &str, name: &str) -> Result<(usize, &super::super::Body<P>), ModelError> {
        let found = self.bodies.iter().enumerate().find(|(_, b)| b.name == name);
        found.ok_or_else(|| ModelError::new(field, format!("no body is named `{name}`")))
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
